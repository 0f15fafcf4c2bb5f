"""The kind of hulls: rigid bodies that float, with the mass of the water that they carry along.

Bodies are kept as in `heavylift.solver.bodies.rigid`: centre of mass and principal axes. Added mass, memory and
waves belong to hydrodynamic coordinates, surge to yaw at a reference point in axes that follow the heading. With
their velocities ``u = T(q) U`` the step of "Integrated simulation ... (2018)", eq. 49, in the middle of the step is::

    ( M + T^T (A_inf + h/2 (B + D)) T + h^2/4 K ) Ub = M U + T^T A_inf u + h/2 ( Q + h/2 K U + T^T (F_w - F_m) )

with the memory force ``F_m + B u`` of Cummins' equation and the stiffness K of buoyancy and lines: added mass larger
than the mass, and steps that are long for the hydrostatics, do no harm. Hulls that interact share one matrix, and
joints see them as one body with 6 N velocities.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.rigid import AXES, CENTRE, COLUMN, ORIENTATION, POSITION, pack_rigid_bodies
from heavylift.solver.marine.clipping import CLIP_WIDTH, clip_surface_now
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.seas import FloatingBody, LinearRestoring, Sea, Tank

__all__ = ["Hulls", "pack_hulls"]

# columns of `hulls`
GROUP, OFFSET, RESTORING, FIRST_POINT, LAST_POINT, FIRST_TRIANGLE, LAST_TRIANGLE, FIRST_TANK, LAST_TANK = (
    range(9)
)
HULL_COLUMNS = 9
UNDER_WATER, CLIPPED, LINEAR = range(3)
"""Values of `RESTORING`."""

# columns of `groups`: first hull, number of hulls, first velocity, first number of its matrices
FIRST, COUNT, GROUP_DOF, MATRIX = range(4)

# columns of `hull`: reference point, x and y axes of the body, in principal axes; linear restoring; damping
REFERENCE, AXIS_X, AXIS_Y, BUOYANCY, FLOAT_PLANE, WATERPLANE, DISPLACED = 0, 3, 6, 9, 12, 15, 21
QUADRATIC, CUT_OFF = 22, 28
HULL_WIDTH = 32

# columns of `stage`, scratch of a step: T of the middle and of the end, heading and place that the waves see, clip,
# displacement to the pose of the stage in coordinates of the body, buoyancy in them, its stiffness (z, x, y), rotation
# at the start or end, predicted displacement, at which lines were evaluated; place and heading of the middle
TRANSFORM, END_TRANSFORM, HEADING, PLACE, CLIP, PREDICTED, LIFT, STIFFNESS, ROTATION, FORESEEN, TARGET = (
    0, 36, 72, 73, 75, 75 + CLIP_WIDTH, 81 + CLIP_WIDTH, 87 + CLIP_WIDTH, 93 + CLIP_WIDTH, 102 + CLIP_WIDTH,
    108 + CLIP_WIDTH,
)  # fmt: skip
STAGE_WIDTH = 128

# rows of `vectors`: velocities in hydrodynamic coordinates at start, middle and end of the step; memory force without
# the part of the middle velocity; force of the waves; of memory and damping; right-hand side of the step, its change,
# scratch; velocities at the start as the mass of the water needs them; what is known of those of the middle
START, MIDDLE, FINISH, KNOWN, WAVE, RADIATED, LOAD, CHANGE, SCRATCH, LEAD, SPEED = range(11)
VECTORS = 11

# columns of `state` for each hull: low-passed x, y, heading and rates; energy dissipated; work of waves and ballast;
# by how much twice the velocities of the middle exceed the sum of those of both ends, over the square of the step
LOW_PASS, LOST, SUPPLIED, LAG = 0, 6, 7, 8
STATE_WIDTH = 14

# columns of `tanks`: point in principal axes, mass, velocity, free surfaces, velocity at the start that its mass needs
TANK_POINT, TANK_MASS, TANK_VELOCITY, TANK_SURFACE, TANK_START = 0, 3, 4, 7, 9
TANK_WIDTH = 12


class Hulls(NamedTuple):
    """All hulls of a scene; columns are named at the top of this file.

    Attributes
    ----------
    table, constants, frame, markers, sensors
        As in the kind of rigid bodies.
    hulls, groups
        Where the data of each hull and of each group of interacting hulls are; shapes (nb, 9), (ng, 4).
    water
        Density times gravity [N/m3], gravity [m/s2], level [m]; shape (3,).
    hull, stage
        Constants and scratch of each hull, shapes (nb, 32), (nb, 128).
    points, triangles, placed
        Surfaces in principal axes through the centres of mass, and their vertices in world directions.
    added_mass, damping, implicit
        At infinite frequency; constant; of the memory at the velocity of the middle: shapes (6 nb, 6 nb).
    vectors
        Forces and velocities in hydrodynamic coordinates, shape (11, 6 nb).
    matrices
        Of each group: factor of the step, factor of its end or matrix of the corrected middle, matrix of the step;
        flat.
    tank_table, tank_times, tanks
        Hull, first row and rows of the schedule; schedule: time [s], mass [kg]; what the step needs of each.
    tangents, rate_tangents, line_ends
        Stiffness and damping matrices of lines and fenders, shared with them, shapes (n, 9); hull, marker and line of
        each end.
    state
        Carried, flat: `STATE_WIDTH` numbers a hull, the lag of the velocity of each tank (3), the states of the parts.
    radiation, excitation
        Parts that a database brings; empty tuples without one.
    gauge
        Undisturbed waves, for records: omega, kx, ky, phase, amplitude; shape (5, m).
    """

    table: NDArray[np.int64]
    constants: NDArray[np.float64]
    frame: NDArray[np.float64]
    markers: NDArray[np.int64]
    sensors: NDArray[np.int64]
    hulls: NDArray[np.int64]
    groups: NDArray[np.int64]
    water: NDArray[np.float64]
    hull: NDArray[np.float64]
    stage: NDArray[np.float64]
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    placed: NDArray[np.float64]
    added_mass: NDArray[np.float64]
    damping: NDArray[np.float64]
    implicit: NDArray[np.float64]
    vectors: NDArray[np.float64]
    matrices: NDArray[np.float64]
    tank_table: NDArray[np.int64]
    tank_times: NDArray[np.float64]
    tanks: NDArray[np.float64]
    tangents: NDArray[np.float64]
    rate_tangents: NDArray[np.float64]
    line_ends: NDArray[np.int64]
    state: NDArray[np.float64]
    radiation: Any
    excitation: Any
    gauge: NDArray[np.float64]

    def sharing_state(self) -> Hulls:
        """The same with the states of its parts as views of its own, which has been replaced."""
        from heavylift.solver.marine.hull_parts import share_part_states

        return share_part_states(self)


def pack_hulls(
    bodies: Sequence[FloatingBody],
    first_number: int,
    first_dof: int,
    first_column: int,
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
    *,
    sea: Sea,
    tangents: NDArray[np.float64],
    rate_tangents: NDArray[np.float64],
    line_ends: Sequence[tuple[str, int, int]],
    step: float,
    notes: list[str],
) -> Hulls:
    """Make the kind from what the user said.

    Parameters
    ----------
    bodies
        Interacting ones follow each other.
    first_number, first_dof, first_column, markers, sensors
        As of other bodies.
    sea
        Water, databases, waves, tanks.
    tangents, rate_tangents
        Arrays in which lines and fenders leave their stiffness and damping, shapes (n, 9).
    line_ends
        Body, marker and row of `tangents` of each end of a line that is on a hull.
    step
        Length of all steps [s], 0 if they vary.
    notes
        Receives what the user should know.

    Raises
    ------
    InputError
        If a hull leaks, a reference point or float plane does not fit, or a database does not.
    """
    rigid = pack_rigid_bodies(bodies, first_number, first_dof, first_column, markers, sensors)
    names = [body.name for body in bodies]
    count = len(bodies)
    rigid.table[:, COLUMN] = first_column + np.arange(count) * _record_width()
    groups: list[tuple[str, ...]] = list(dict.fromkeys(body.group for body in bodies))
    group_rows, first_matrix = [], 0
    for group in groups:
        first = names.index(group[0])
        group_rows.append((first, len(group), first_dof + 6 * first, first_matrix))
        first_matrix += 3 * (6 * len(group)) ** 2
    rows = np.zeros((count, HULL_COLUMNS), dtype=np.int64)
    data = np.zeros((count, HULL_WIDTH))
    damping = np.zeros((6 * count, 6 * count))
    surfaces = _Surfaces()
    tanks = [tank for name in names for tank in sea.tanks if tank.body == name]
    for row, body in enumerate(bodies):
        rows[row, GROUP] = groups.index(body.group)
        rows[row, OFFSET] = 6 * body.group.index(body.name)
        of_body = [i for i, tank in enumerate(tanks) if tank.body == body.name]
        rows[row, FIRST_TANK] = of_body[0] if of_body else 0
        rows[row, LAST_TANK] = of_body[-1] + 1 if of_body else 0
        axes = rotation_matrix(rigid.frame[row, AXES : AXES + 4]).T  # body to principal
        centre = rigid.frame[row, CENTRE : CENTRE + 3]
        _fill_hull(data[row], rows[row], body, axes, centre, surfaces)
        at = slice(6 * row, 6 * row + 6)
        damping[at, at] = _damping(body)
        data[row, QUADRATIC : QUADRATIC + 6] = body.hull.quadratic_damping
        if not body.hull.low_pass > 0.0:
            raise InputError(
                f"{body.hull.low_pass} rad/s",
                source=body.name,
                key="low_pass",
                expected="a positive frequency",
            )
        data[row, CUT_OFF] = body.hull.low_pass
    schedule, tank_rows, tank_data = _pack_tanks(tanks, names, rigid.frame)
    from heavylift.solver.marine.hull_parts import pack_parts

    added_mass, radiation, excitation, part_state = pack_parts(bodies, sea, step, notes)
    kind = Hulls(
        *rigid,
        hulls=rows,
        groups=np.array(group_rows, dtype=np.int64),
        water=np.array([sea.water.density * sea.water.gravity, sea.water.gravity, sea.water.level]),
        hull=data,
        stage=np.zeros((count, STAGE_WIDTH)),
        points=surfaces.all_points,
        triangles=surfaces.all_triangles,
        placed=np.zeros((len(surfaces.all_points), 3)),
        added_mass=added_mass,
        damping=damping,
        implicit=np.zeros((6 * count, 6 * count)),
        vectors=np.zeros((VECTORS, 6 * count)),
        matrices=np.zeros(first_matrix),
        tank_table=tank_rows,
        tank_times=schedule,
        tanks=tank_data,
        tangents=tangents,
        rate_tangents=rate_tangents,
        line_ends=np.array(
            [(names.index(name), marker, line) for name, marker, line in line_ends], dtype=np.int64
        ).reshape(-1, 3),
        state=np.concatenate([np.zeros(STATE_WIDTH * count + 3 * len(tanks)), part_state]),
        radiation=radiation,
        excitation=excitation,
        gauge=_gauge(sea),
    )
    _start_filters(kind)
    return kind.sharing_state()


def _record_width() -> int:
    from heavylift.solver.marine.hull_channels import record_width

    return record_width()


class _Surfaces:
    """Triangles of all hulls, one after another."""

    def __init__(self) -> None:
        self._points: list[NDArray[np.float64]] = [np.zeros((0, 3))]
        self._triangles: list[NDArray[np.int64]] = [np.zeros((0, 3), dtype=np.int64)]

    def add(self, points: NDArray[np.float64], triangles: NDArray[np.int64]) -> tuple[int, int, int, int]:
        """First and last rows of points and triangles of a new one."""
        point, triangle = sum(map(len, self._points)), sum(map(len, self._triangles))
        self._points.append(points)
        self._triangles.append(triangles)
        return point, point + len(points), triangle, triangle + len(triangles)

    @property
    def all_points(self) -> NDArray[np.float64]:
        return np.ascontiguousarray(np.vstack(self._points))

    @property
    def all_triangles(self) -> NDArray[np.int64]:
        """Vertex numbers count from the first point of each hull."""
        return np.ascontiguousarray(np.vstack(self._triangles))


def _fill_hull(
    data: NDArray[np.float64],
    row: NDArray[np.int64],
    body: FloatingBody,
    axes: NDArray[np.float64],
    centre: NDArray[np.float64],
    surfaces: _Surfaces,
) -> None:
    """Points in principal axes through the centre of mass, and what buoyancy needs."""
    hull = body.hull
    data[REFERENCE : REFERENCE + 3] = axes @ (np.asarray(hull.reference, dtype=np.float64) - centre)
    data[AXIS_X : AXIS_X + 3] = axes[:, 0]
    data[AXIS_Y : AXIS_Y + 3] = axes[:, 1]
    if isinstance(hull.restoring, LinearRestoring):
        linear = hull.restoring
        row[RESTORING] = LINEAR
        A, Sx, Sy, Ixx, Iyy, Ixy = linear.waterplane
        W = np.array([[A, Sx, Sy], [Sx, Ixx, Ixy], [Sy, Ixy, Iyy]])
        if not (linear.volume > 0.0 and np.all(np.linalg.eigvalsh(W) >= -1e-9 * np.abs(W).max())):
            raise InputError(
                f"volume {linear.volume} m3, water plane {np.asarray(linear.waterplane).tolist()}",
                source=body.name,
                key="restoring",
                expected="a positive volume, and area and moments that a water plane can have",
            )
        data[BUOYANCY : BUOYANCY + 3] = axes @ (np.asarray(linear.centre_of_buoyancy) - centre)
        data[FLOAT_PLANE : FLOAT_PLANE + 3] = axes @ (np.asarray(linear.reference) - centre)
        data[WATERPLANE : WATERPLANE + 6] = linear.waterplane
        data[DISPLACED] = linear.volume
    elif hull.restoring is not None:
        from heavylift.preprocess.hull_surface import check_hull

        welded = check_hull(hull.restoring, open_deck=hull.open_deck).surface
        row[RESTORING] = CLIPPED
        points = (welded.points - centre) @ axes.T
        row[FIRST_POINT : LAST_TRIANGLE + 1] = surfaces.add(points, welded.triangles)


def _damping(body: FloatingBody) -> NDArray[np.float64]:
    """Of the user, which must not drive the hull."""
    D = np.asarray(body.hull.damping, dtype=np.float64)
    quadratic = np.asarray(body.hull.quadratic_damping, dtype=np.float64)
    good = D.shape == (6, 6) and quadratic.shape == (6,) and bool(np.all(quadratic >= 0.0))
    if not (good and np.linalg.eigvalsh(0.5 * (D + D.T))[0] >= -1e-9 * np.abs(D).max()):
        raise InputError(
            f"{D.tolist()}, {quadratic.tolist()}",
            source=body.name,
            key="damping",
            expected="a 6x6 matrix that dissipates in every direction, and six quadratic terms of 0 or more",
        )
    return D


def _pack_tanks(
    tanks: Sequence[Tank], names: Sequence[str], frame: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Schedules, their places, and the numbers of each tank."""
    schedule, table = [np.zeros((0, 2))], []
    data = np.zeros((len(tanks), TANK_WIDTH))
    first = 0
    for i, tank in enumerate(tanks):
        times, masses = np.atleast_1d(tank.times).astype(float), np.atleast_1d(tank.masses).astype(float)
        good = times.ndim == 1 and times.shape == masses.shape and len(times) > 0
        if not (
            good and np.all(np.diff(times) > 0.0) and np.all(masses >= 0.0) and np.all(np.isfinite(masses))
        ):
            raise InputError(
                f"times {times.tolist()}, masses {masses.tolist()}",
                source=tank.name,
                key="masses",
                expected="increasing times with one mass of 0 or more each",
            )
        body = names.index(tank.body)
        axes = rotation_matrix(frame[body, AXES : AXES + 4]).T
        data[i, TANK_POINT : TANK_POINT + 3] = axes @ (
            np.asarray(tank.point) - frame[body, CENTRE : CENTRE + 3]
        )
        data[i, TANK_SURFACE : TANK_SURFACE + 2] = tank.free_surface
        data[i, TANK_MASS] = np.interp(0.0, times, masses)
        table.append((body, first, len(times)))
        schedule.append(np.column_stack([times, masses]))
        first += len(times)
    return np.vstack(schedule), np.array(table, dtype=np.int64).reshape(-1, 3), data


def _start_filters(kind: Hulls) -> None:
    """Position and heading that the waves see start at those of the hulls."""
    for row in range(len(kind.table)):
        R = rotation_matrix(kind.frame[row, ORIENTATION : ORIENTATION + 4])
        place = kind.frame[row, POSITION : POSITION + 3] + R @ kind.hull[row, REFERENCE : REFERENCE + 3]
        forward = R @ kind.hull[row, AXIS_X : AXIS_X + 3]
        at = STATE_WIDTH * row + LOW_PASS
        kind.state[at : at + 6] = place[0], 0.0, place[1], 0.0, np.arctan2(forward[1], forward[0]), 0.0


def _gauge(sea: Sea) -> NDArray[np.float64]:
    """Components of the waves."""
    if sea.waves is None:
        return np.zeros((5, 0))
    w = sea.waves
    kx, ky = w.wavenumber * np.cos(w.direction), w.wavenumber * np.sin(w.direction)
    return np.ascontiguousarray(np.stack([w.omega, kx, ky, w.phase, w.amplitude]))


def displaced_now(kind: Hulls, row: int) -> NDArray[np.float64]:
    """Clip of a hull at its present pose, for statics and reports, shape (12,)."""
    out = np.zeros(CLIP_WIDTH)
    a, b, c, d = kind.hulls[row, FIRST_POINT : LAST_TRIANGLE + 1]
    R = rotation_matrix(kind.frame[row, ORIENTATION : ORIENTATION + 4])
    height = kind.frame[row, POSITION + 2] - kind.water[2]
    clip_surface_now(kind.points[a:b], kind.triangles[c:d], np.ravel(R), height, kind.placed[a:b], out)
    return out
