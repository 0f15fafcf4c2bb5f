"""Makes the kind of hulls from what a user says: surfaces and points in principal axes, tanks, databases."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.rigid import RigidFrame, pack_rigid_bodies
from heavylift.solver.marine.clipping import CLIP_WIDTH, VOLUME, clip_surface_now
from heavylift.solver.marine.hull_checks import check_hull_numbers, check_tank, check_volume
from heavylift.solver.marine.hulls import (
    AXIS_X,
    AXIS_Y,
    BUOYANCY,
    CLIPPED,
    CUT_OFF,
    DISPLACED,
    FIRST_POINT,
    FIRST_TANK,
    FLOAT_PLANE,
    GROUP,
    HULL_COLUMNS,
    HULL_WIDTH,
    LAST_TANK,
    LAST_TRIANGLE,
    LEAST_VOLUME,
    LINEAR,
    OFFSET,
    QUADRATIC,
    REFERENCE,
    RESTORING,
    STAGE_WIDTH,
    STATE_WIDTH,
    TANK_MASS,
    TANK_POINT,
    TANK_SURFACE,
    TANK_WIDTH,
    VECTORS,
    WATERPLANE,
    Hulls,
    start_filters,
)
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.seas import FloatingBody, LinearRestoring, Radiation, Sea, Tank

__all__ = ["pack_hulls"]

LEAST_SHARE = 0.02
"""Of the whole volume of a hull, that it must displace while a database is to hold."""


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
    rigid.table["column"] = first_column + np.arange(count) * _record_width()
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
        axes = rotation_matrix(rigid.frame[row].axes).T  # body to principal
        centre = rigid.frame[row].centre
        check_hull_numbers(body.hull)
        _fill_hull(data[row], rows[row], body, axes, centre, surfaces)
        at = slice(6 * row, 6 * row + 6)
        damping[at, at] = body.hull.damping
        data[row, QUADRATIC : QUADRATIC + 6] = body.hull.quadratic_damping
        data[row, CUT_OFF] = body.hull.low_pass
    schedule, tank_rows, tank_data = _pack_tanks(tanks, names, rigid.frame)
    for entry in sea.radiation:
        for place, name in enumerate(entry.bodies):
            _cover(entry, place, names.index(name), bodies, rows, data, surfaces, rigid.frame)
    from heavylift.solver.marine.hull_parts import pack_parts

    added_mass, radiation, excitation, part_state = pack_parts(bodies, sea, step, notes)
    kind = Hulls(
        table=rigid.table,
        constants=rigid.constants,
        frame=rigid.frame,
        markers=rigid.markers,
        sensors=rigid.sensors,
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
        line_ends=_line_ends(names, line_ends),
        state=np.concatenate([np.zeros(STATE_WIDTH * count + 3 * len(tanks)), part_state]),
        radiation=radiation,
        excitation=excitation,
        gauge=_gauge(sea),
    )
    start_filters(kind)
    return kind.sharing_state()


def _cover(
    radiation: Radiation,
    place: int,
    row: int,
    bodies: Sequence[FloatingBody],
    rows: NDArray[np.int64],
    data: NDArray[np.float64],
    surfaces: _Surfaces,
    frame: Records[RigidFrame],
) -> None:
    """What a hull displaces must fit its database, at the reference point and as long as it floats."""
    if rows[row, RESTORING] != CLIPPED:
        return
    first, last, triangle, end = rows[row, FIRST_POINT : LAST_TRIANGLE + 1]
    points, triangles = surfaces.all_points[first:last], surfaces.all_triangles[triangle:end]
    axes = rotation_matrix(frame[row].axes)
    check_volume(radiation, place, bodies[row], points, triangles, axes, data[row, REFERENCE : REFERENCE + 3])
    out, deep = np.zeros(CLIP_WIDTH), -2.0 * float(np.abs(points).max())
    clip_surface_now(points, triangles, np.eye(3).ravel(), deep * 2.0, np.zeros_like(points), out)
    data[row, LEAST_VOLUME] = LEAST_SHARE * out[VOLUME]


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
        for key in ("centre_of_buoyancy", "reference", "waterplane"):
            given = np.asarray(getattr(linear, key), dtype=np.float64)
            size = 6 if key == "waterplane" else 3
            if given.shape != (size,) or not np.all(np.isfinite(given)):
                raise InputError(
                    f"{given.tolist()}", source=body.name, key=key, expected=f"{size} finite numbers"
                )
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


def _pack_tanks(
    tanks: Sequence[Tank], names: Sequence[str], frame: Records[RigidFrame]
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Schedules, their places, and the numbers of each tank."""
    schedule, table = [np.zeros((0, 2))], []
    data = np.zeros((len(tanks), TANK_WIDTH))
    first = 0
    for i, tank in enumerate(tanks):
        check_tank(tank)
        times, masses = np.atleast_1d(tank.times).astype(float), np.atleast_1d(tank.masses).astype(float)
        body = names.index(tank.body)
        axes = rotation_matrix(frame[body].axes).T
        data[i, TANK_POINT : TANK_POINT + 3] = axes @ (np.asarray(tank.point) - frame[body].centre)
        data[i, TANK_SURFACE : TANK_SURFACE + 2] = tank.free_surface
        data[i, TANK_MASS] = np.interp(0.0, times, masses)
        table.append((body, first, len(times)))
        schedule.append(np.column_stack([times, masses]))
        first += len(times)
    return np.vstack(schedule), np.array(table, dtype=np.int64).reshape(-1, 3), data


def _line_ends(names: Sequence[str], ends: Sequence[tuple[str, int, int]]) -> NDArray[np.int64]:
    """Hull, marker, line and the other end of each end of a line on a hull, -1 if that is on no hull."""
    rows = []
    for i, (name, marker, line) in enumerate(ends):
        others = [j for j, end in enumerate(ends) if end[2] == line and j != i]
        rows.append((names.index(name), marker, line, others[0] if others else -1))
    return np.array(rows, dtype=np.int64).reshape(-1, 4)


def _gauge(sea: Sea) -> NDArray[np.float64]:
    """Components of the waves."""
    if sea.waves is None:
        return np.zeros((5, 0))
    w = sea.waves
    kx, ky = w.wavenumber * np.cos(w.direction), w.wavenumber * np.sin(w.direction)
    return np.ascontiguousarray(np.stack([w.omega, kx, ky, w.phase, w.amplitude]))
