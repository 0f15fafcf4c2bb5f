"""Makes the kind of hulls from what a user says: surfaces and points in principal axes, tanks, databases."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.rigid.kind import RigidFrame
from heavylift.solver.bodies.rigid.packing import pack_rigid_bodies
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.scene.channels import channel_width
from heavylift.solver.scene.sea import FloatingBody, LinearRestoring, Radiation, Sea, Tank
from heavylift.solver.water.hulls.checks import check_hull_numbers, check_tank, check_volume
from heavylift.solver.water.hulls.clipping import Clip, clip_surface_now
from heavylift.solver.water.hulls.kind import (
    CLIPPED,
    LINEAR,
    HullData,
    HullGroup,
    Hulls,
    HullStage,
    HullState,
    HullVectors,
    LineEnd,
    StillWater,
    TankData,
    TankLevel,
    WaveComponent,
)

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
    rigid.table["column"] = first_column + np.arange(count) * channel_width(FloatingBody.CHANNELS)
    groups: list[tuple[str, ...]] = list(dict.fromkeys(body.group for body in bodies))
    group_rows, first_matrix = [], 0
    for group in groups:
        first = names.index(group[0])
        group_rows.append((first, len(group), first_dof + 6 * first, first_matrix))
        first_matrix += 3 * (6 * len(group)) ** 2
    rows = records(HullData, count)
    damping = np.zeros((6 * count, 6 * count))
    surfaces = _Surfaces()
    tanks = [tank for name in names for tank in sea.tanks if tank.body == name]
    for row, body in enumerate(bodies):
        rows[row].group = groups.index(body.group)
        rows[row].offset = 6 * body.group.index(body.name)
        of_body = [i for i, tank in enumerate(tanks) if tank.body == body.name]
        rows[row].first_tank = of_body[0] if of_body else 0
        rows[row].last_tank = of_body[-1] + 1 if of_body else 0
        axes = rotation_matrix(rigid.frame[row].axes).T  # body to principal
        centre = rigid.frame[row].centre
        check_hull_numbers(body.hull)
        _fill_hull(rows[row], body, axes, centre, surfaces)
        at = slice(6 * row, 6 * row + 6)
        damping[at, at] = body.hull.damping
        rows[row].quadratic_damping[:] = body.hull.quadratic_damping
        rows[row].cut_off = body.hull.low_pass
    tank_rows, levels = _pack_tanks(tanks, names, rigid.frame)
    for entry in sea.radiation:
        for place, name in enumerate(entry.bodies):
            _cover(entry, place, names.index(name), bodies, rows, surfaces, rigid.frame)
    from heavylift.solver.water.hulls.parts import pack_parts

    added_mass, radiation, excitation, part_state = pack_parts(bodies, sea, step, notes)
    kind = Hulls(
        table=rigid.table,
        constants=rigid.constants,
        frame=rigid.frame,
        markers=rigid.markers,
        sensors=rigid.sensors,
        driven=rigid.driven,
        hulls=rows,
        groups=records(HullGroup, group_rows),
        water=_still_water(sea),
        stage=records(HullStage, count),
        points=surfaces.all_points,
        triangles=surfaces.all_triangles,
        placed=np.zeros((len(surfaces.all_points), 3)),
        added_mass=added_mass,
        damping=damping,
        implicit=np.zeros((6 * count, 6 * count)),
        vectors=HullVectors.empty(6 * count),
        matrices=np.zeros(first_matrix),
        tanks=tank_rows,
        tank_levels=levels,
        tangents=tangents,
        rate_tangents=rate_tangents,
        line_ends=_line_ends(names, line_ends),
        state=records(HullState, count),
        memory_state=part_state,
        radiation=radiation,
        excitation=excitation,
        gauge=_gauge(sea),
    )
    kind.start_filters()
    return kind.sharing_state()


def _cover(
    radiation: Radiation,
    place: int,
    row: int,
    bodies: Sequence[FloatingBody],
    rows: Records[HullData],
    surfaces: _Surfaces,
    frame: Records[RigidFrame],
) -> None:
    """What a hull displaces must fit its database, at the reference point and as long as it floats."""
    hull = rows[row]
    if hull.restoring != CLIPPED:
        return
    points = surfaces.all_points[hull.first_point : hull.last_point]
    triangles = surfaces.all_triangles[hull.first_triangle : hull.last_triangle]
    axes = rotation_matrix(frame[row].axes)
    check_volume(radiation, place, bodies[row], points, triangles, axes, hull.reference)
    out, deep = records(Clip, 1), -2.0 * float(np.abs(points).max())
    clip_surface_now(points, triangles, np.eye(3).ravel(), deep * 2.0, np.zeros_like(points), out)
    hull.least_volume = LEAST_SHARE * out[0].volume


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
    data: HullData,
    body: FloatingBody,
    axes: NDArray[np.float64],
    centre: NDArray[np.float64],
    surfaces: _Surfaces,
) -> None:
    """Points in principal axes through the centre of mass, and what buoyancy needs."""
    hull = body.hull
    data.reference[:] = axes @ (np.asarray(hull.reference, dtype=np.float64) - centre)
    data.axis_x[:] = axes[:, 0]
    data.axis_y[:] = axes[:, 1]
    if isinstance(hull.restoring, LinearRestoring):
        linear = hull.restoring
        data.restoring = LINEAR
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
        data.buoyancy_centre[:] = axes @ (np.asarray(linear.centre_of_buoyancy) - centre)
        data.float_plane[:] = axes @ (np.asarray(linear.reference) - centre)
        data.waterplane[:] = linear.waterplane
        data.displaced_volume = linear.volume
    elif hull.restoring is not None:
        from heavylift.preprocess.hydrodynamics.hull_surface import check_hull

        welded = check_hull(hull.restoring, open_deck=hull.open_deck).surface
        data.restoring = CLIPPED
        points = (welded.points - centre) @ axes.T
        data.first_point, data.last_point, data.first_triangle, data.last_triangle = surfaces.add(
            points, welded.triangles
        )


def _pack_tanks(
    tanks: Sequence[Tank], names: Sequence[str], frame: Records[RigidFrame]
) -> tuple[Records[TankData], Records[TankLevel]]:
    """Tanks, and the rows of their schedules."""
    levels: list[tuple[float, float]] = []
    rows = records(TankData, len(tanks))
    for row, tank in zip(rows, tanks, strict=True):
        check_tank(tank)
        times, masses = np.atleast_1d(tank.times).astype(float), np.atleast_1d(tank.masses).astype(float)
        row.hull, row.first, row.count = names.index(tank.body), len(levels), len(times)
        axes = rotation_matrix(frame[row.hull].axes).T
        row.point[:] = axes @ (np.asarray(tank.point) - frame[row.hull].centre)
        row.free_surface[:] = tank.free_surface
        row.mass = np.interp(0.0, times, masses)
        levels.extend(zip(times, masses, strict=True))
    return rows, records(TankLevel, levels)


def _line_ends(names: Sequence[str], ends: Sequence[tuple[str, int, int]]) -> Records[LineEnd]:
    """Hull, marker, line and the other end of each end of a line on a hull, -1 if that is on no hull."""
    rows = []
    for i, (name, marker, line) in enumerate(ends):
        others = [j for j, end in enumerate(ends) if end[2] == line and j != i]
        rows.append((names.index(name), marker, line, others[0] if others else -1))
    return records(LineEnd, rows)


def _still_water(sea: Sea) -> StillWater:
    """Its numbers."""
    water = StillWater.one()
    water.weight, water.gravity = sea.water.density * sea.water.gravity, sea.water.gravity
    water.level = sea.water.level
    return water


def _gauge(sea: Sea) -> Records[WaveComponent]:
    """Components of the waves."""
    if sea.waves is None:
        return records(WaveComponent, 0)
    w = sea.waves
    kx, ky = w.wavenumber * np.cos(w.direction), w.wavenumber * np.sin(w.direction)
    return records(WaveComponent, zip(w.omega, kx, ky, w.phase, w.amplitude, strict=True))
