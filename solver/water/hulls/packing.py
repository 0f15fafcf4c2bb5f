"""Hulls of a scene become arrays: surfaces, tanks, groups, start state; memory and waves of their databases."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled, filled_rows, records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.numerics.small import aligned
from heavylift.solver.bodies.rigid.kind import RigidFrame
from heavylift.solver.bodies.rigid.packing import pack_rigid_bodies
from heavylift.solver.body_places import BodyPlaces
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.scene.ballast import PumpOutputs
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.sea import (
    FloatingBody,
    HullOutputs,
    LinearRestoring,
    Radiation,
    Sea,
    Tank,
    TankOutputs,
    Water,
)
from heavylift.solver.water.hulls.clipping import Clip, clip_surface_now
from heavylift.solver.water.hulls.database_fit import check_databases
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
    Parts,
    PumpData,
    PumpRow,
    StillWater,
    TankData,
    TankLevel,
    TankRow,
    TideRow,
    WaveComponent,
)
from heavylift.solver.water.hulls.memory import (
    PIECE,
    DirectMemory,
    ExponentialMemory,
)
from heavylift.solver.water.hulls.parts import (
    DirectPart,
    ExponentialPart,
    SeriesPart,
    SummedPart,
)

if TYPE_CHECKING:
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

__all__ = [
    "check_series",
    "pack_direct_memory",
    "pack_exponential_memory",
    "pack_hulls",
    "pack_parts",
]


LEAST_SHARE = 0.02
"""Of the whole volume of a hull, that it must displace while a database is to hold."""


def pack(bodies: Sequence[FloatingBody], places: BodyPlaces) -> Hulls:
    """Make the kind of the hulls of a scene, see `pack_hulls`."""
    afloat = places.sea
    assert afloat is not None
    return pack_hulls(
        bodies,
        places.number,
        places.dofs[0],
        places.columns,
        places.markers,
        places.sensors,
        sea=afloat.sea,
        tangents=afloat.tangents,
        rate_tangents=afloat.rate_tangents,
        line_ends=afloat.line_ends,
        step=afloat.step,
        notes=afloat.notes,
        columns=afloat.columns,
    )


def pack_hulls(
    bodies: Sequence[FloatingBody],
    first_number: int,
    first_dof: int,
    in_record: Sequence[Columns],
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
    *,
    sea: Sea,
    tangents: NDArray[np.float64],
    rate_tangents: NDArray[np.float64],
    line_ends: Sequence[tuple[str, int, int]],
    step: float,
    notes: list[str],
    columns: Mapping[str, Columns],
) -> Hulls:
    """Make the kind from the scene.

    Parameters
    ----------
    bodies
        Interacting ones follow each other.
    first_number, first_dof, in_record, markers, sensors
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
    columns
        First record columns of tanks and pumps, by name.

    Raises
    ------
    InputError
        If a hull leaks, a reference point or float plane does not fit, or a database does not.
    """
    rigid = pack_rigid_bodies(bodies, first_number, first_dof, in_record, markers, sensors)
    names = [body.name for body in bodies]
    count = len(bodies)
    groups: list[tuple[str, ...]] = list(dict.fromkeys(body.group for body in bodies))
    group_rows, first_matrix = [], 0
    for group in groups:
        first = names.index(group[0])
        group_rows.append(
            filled(HullGroup, first=first, count=len(group), dof=first_dof + 6 * first, matrix=first_matrix)
        )
        first_matrix += 3 * (6 * len(group)) ** 2
    rows = records(HullData, count)
    damping = np.zeros((6 * count, 6 * count))
    surfaces = _Surfaces()
    tanks = sea.tanks_of(bodies)
    for row, body in enumerate(bodies):
        rows[row].group = groups.index(body.group)
        rows[row].offset = 6 * body.group.index(body.name)
        of_body = [i for i, tank in enumerate(tanks) if tank.hull == body.name]
        rows[row].first_tank = of_body[0] if of_body else 0
        rows[row].last_tank = of_body[-1] + 1 if of_body else 0
        axes = rotation_matrix(rigid.frame[row].axes).T  # body to principal
        centre = rigid.frame[row].centre
        _fill_hull(rows[row], body, axes, centre, surfaces)
        at = slice(6 * row, 6 * row + 6)
        damping[at, at] = body.hull.damping
        rows[row].quadratic_damping[:] = body.hull.quadratic_damping
        rows[row].cut_off = body.hull.low_pass
        rows[row].column = in_record[row].at(HullOutputs)
    tank_data, levels, tank_rows = _pack_tanks(tanks, names, rigid.frame, sea.water, columns)
    pumps, pump_rows = _pack_pumps(sea, tanks, columns)
    notes += check_databases(bodies, sea)
    for entry in sea.radiation:
        for name in entry.bodies:
            _cover(rows[names.index(name)], surfaces)

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
        tanks=tank_data,
        tank_levels=levels,
        tank_rows=tank_rows,
        pumps=pumps,
        pump_rows=pump_rows,
        tide=_pack_tide(sea.water),
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


def _cover(hull: HullData, surfaces: _Surfaces) -> None:
    """A database holds as long as its hull floats."""
    hull.radiates = True
    if hull.restoring != CLIPPED:
        return
    points = surfaces.all_points[hull.first_point : hull.last_point]
    triangles = surfaces.all_triangles[hull.first_triangle : hull.last_triangle]
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
    tanks: Sequence[Tank],
    names: Sequence[str],
    frame: Records[RigidFrame],
    water: Water,
    columns: Mapping[str, Columns],
) -> tuple[Records[TankData], Records[TankLevel], Records[TankRow]]:
    """Tanks, the rows of their schedules and of their shapes."""
    levels: list[TankLevel] = []
    shapes: list[TankRow] = []
    rows = records(TankData, len(tanks))
    for row, tank in zip(rows, tanks, strict=True):
        times, masses = tank.schedule
        row.hull, row.first, row.count = names.index(tank.hull), len(levels), len(times)
        axes, centre = rotation_matrix(frame[row.hull].axes).T, frame[row.hull].centre
        shape = tank.shape(water)
        row.first_row, row.rows, row.capacity = len(shapes), len(shape), tank.capacity(water)
        row.column = columns[tank.name].at(TankOutputs)
        shapes += [
            filled(TankRow, mass=mass, centre=axes @ (np.array(place) - centre), surface=about, depth=depth)
            for mass, *place, about, depth in (
                (line[0], *line[1:4], line[4:6], line[6]) for line in shape.tolist()
            )
        ]
        point, row.free_surface[:], row.depth = tank.contents(tank.start_mass, water)
        row.point[:] = axes @ (point - centre)
        row.mass = tank.start_mass
        levels.extend(filled_rows(TankLevel, time=times, mass=masses))
    return rows, records(TankLevel, levels), records(TankRow, shapes)


def _pack_pumps(
    sea: Sea, tanks: Sequence[Tank], columns: Mapping[str, Columns]
) -> tuple[Records[PumpData], Records[PumpRow]]:
    """Pumps with the rows of their commands; one for a pump that a controller commands."""
    places = {tank.name: i for i, tank in enumerate(tanks)}
    controlled = {name for one in sea.controllers for name in one.pumps}
    rows: list[PumpRow] = []
    pumps = records(PumpData, len(sea.pumps))
    for data, pump in zip(pumps, sea.pumps, strict=True):
        plan = pump.plan()[: 1 if pump.name in controlled else None]
        data.source, data.target = places.get(pump.source, -1), places.get(pump.target, -1)
        data.first, data.count = len(rows), len(plan)
        data.lag, data.most, data.least = pump.lag, pump.rate, -pump.rate if pump.reversible else 0.0
        data.column = columns[pump.name].at(PumpOutputs)
        time, command, flow, pumped = plan.T
        rows.extend(filled_rows(PumpRow, time=time, command=command, flow=flow, pumped=pumped))
    return pumps, records(PumpRow, rows)


def _pack_tide(water: Water) -> Records[TideRow]:
    """Levels of the still water."""
    tide = water.tide
    if tide is None:
        return records(TideRow, 0)
    rise = np.asarray(tide.levels) - tide.at_start
    return filled_rows(TideRow, time=tide.times, level=water.level + rise)


def _line_ends(names: Sequence[str], ends: Sequence[tuple[str, int, int]]) -> Records[LineEnd]:
    """Hull, marker, line and the other end of each end of a line on a hull, -1 if that is on no hull."""
    rows = []
    for i, (name, marker, line) in enumerate(ends):
        others = [j for j, end in enumerate(ends) if end[2] == line and j != i]
        other = others[0] if others else -1
        rows.append(filled(LineEnd, hull=names.index(name), marker=marker, line=line, other=other))
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
    return filled_rows(WaveComponent, omega=w.omega, kx=kx, ky=ky, phase=w.phase, amplitude=w.amplitude)


# ---- what a database brings: memory and waves ----


SERIES_MOVED, SERIES_TURNED = 0.05, np.radians(0.1)
"""How far a start may move hulls whose wave forces are tabulated: metres and radians."""


def pack_parts(
    bodies: Sequence[FloatingBody], sea: Sea, step: float, notes: list[str]
) -> tuple[NDArray[np.float64], Parts, Parts, NDArray[np.float64]]:
    """Added mass of all hulls, memory and excitation of each database, and the states of the memories, flat.

    Raises
    ------
    InputError
        If a database does not cover the waves.
    """
    names = [body.name for body in bodies]
    added_mass = np.zeros((6 * len(names), 6 * len(names)))
    memories: list[Any] = []
    excitations: list[Any] = []
    for radiation in sea.radiation:
        first = names.index(radiation.bodies[0])
        at = slice(6 * first, 6 * (first + len(radiation.bodies)))
        added_mass[at, at] = _consistent_added_mass(radiation.database)
        if radiation.memory != "none":
            memories.append(_memory(radiation, 6 * first, step, notes))
        if sea.waves is not None:
            excitations.append(_excitation(radiation, bodies, first, sea))
    states = [np.ravel(part.memory.state) for part in memories]
    return added_mass, Parts(memories), Parts(excitations), np.concatenate([np.zeros(0), *states])


def _consistent_added_mass(database: HydrodynamicDatabase) -> NDArray[np.float64]:
    """Added mass at infinite frequency with which the memory returns that of the database at wave frequencies.

    Notes
    -----
    Panel codes give that at infinite frequency with the error of their mesh, 3 to 5 % for a barge of 648 panels,
    which Ogilvie's relation does not share: motions in waves then differ by a tenth of that of the mass. A value of
    the database that is far from the relation is refused.
    """
    from heavylift.preprocess.hydrodynamics.database import mass_scales
    from heavylift.preprocess.hydrodynamics.repairs import FELT_MASS
    from heavylift.preprocess.hydrodynamics.retardation import consistent_added_mass

    return consistent_added_mass(
        database.omega,
        database.added_mass,
        database.damping,
        database.added_mass_infinite,
        least=FELT_MASS * mass_scales(database),
        source=database.source,
    )


def _memory(radiation: Radiation, first: int, step: float, notes: list[str]) -> ExponentialPart | DirectPart:
    from heavylift.preprocess.hydrodynamics.memory_fit import database_memory, fit_memory

    database = radiation.database
    place = np.array([first], dtype=np.int64)
    if radiation.memory == "direct":
        if not step > 0.0:
            raise InputError(
                "direct convolution without a fixed step",
                source=database.source,
                key="memory",
                expected="a fixed step, and nothing that takes steps back; or 'exponentials'",
            )
        kernel_of_time, length = database_memory(database, radiation.memory_length)
        return DirectPart(place, pack_direct_memory(kernel_of_time, step, length))
    fit = radiation.fit or fit_memory(database, radiation.memory_length, tolerance=radiation.fit_error)
    if fit.warning:
        notes.append(fit.warning)
    return ExponentialPart(place, pack_exponential_memory(fit.poles, fit.residues, fit.damping))


def _excitation(
    radiation: Radiation, bodies: Sequence[FloatingBody], first: int, sea: Sea
) -> SummedPart | SeriesPart:
    from heavylift.solver.water.waves.excitation_packing import pack_series, pack_summed

    assert sea.waves is not None
    hulls = bodies[first : first + len(radiation.bodies)]
    places = np.zeros((len(hulls), 3))
    for row, body in enumerate(hulls):
        R = rotation_matrix(body.orientation)
        places[row, :2] = (body.position + R @ body.hull.reference)[:2]
        places[row, 2] = np.arctan2(R[1, 0], R[0, 0])
    number = np.array([first], dtype=np.int64)
    if sea.excitation == "series":
        series = pack_series(
            sea.waves,
            radiation.database,
            places=places,
            duration=sea.duration,
            ramp=sea.ramp,
            with_drift=radiation.drift,
        )
        return SeriesPart(number, places, series)
    summed = pack_summed(
        sea.waves, radiation.database, yaws=places[:, 2], ramp=sea.ramp, with_drift=radiation.drift
    )
    return SummedPart(number, np.zeros((len(hulls), 3)), summed)


def check_series(bodies: Iterable[Any]) -> None:
    """Refuse a series of wave forces for a place that hulls have been moved from before the start.

    Raises
    ------
    InputError
        Names how far.
    """
    for kind in bodies:
        for part in getattr(kind, "excitation", ()):
            if not isinstance(part, SeriesPart):
                continue
            for i, held in enumerate(part.held):
                moved = kind.state[int(part.first[0]) + i].low_pass[::2] - held
                if np.abs(moved[:2]).max() > SERIES_MOVED or abs(moved[2]) > SERIES_TURNED:
                    raise InputError(
                        f"the start moves a hull by {np.linalg.norm(moved[:2]):.3g} m and"
                        f" {np.degrees(moved[2]):.3g} deg",
                        source="sea",
                        key="excitation",
                        expected="'summed', or a start at the place that the series of waves is made for",
                    )


def pack_exponential_memory(
    poles: ArrayLike, residues: ArrayLike, damping: ArrayLike | None = None
) -> ExponentialMemory:
    """Arrays of a sum of exponentials, at rest.

    Parameters
    ----------
    poles
        s_p [1/s], complex, shape (P,), one of each conjugate pair, real parts negative.
    residues
        Complex, shape (P, n, n). Entries that are zero for all poles cost nothing.
    damping
        Real, shape (n, n); default none.

    Raises
    ------
    InputError
        If shapes do not fit, a number is not finite, or a pole does not decay.
    """
    s = np.atleast_1d(np.asarray(poles, dtype=np.complex128))
    R = np.asarray(residues, dtype=np.complex128)
    if R.ndim != 3 or R.shape[0] != len(s) or R.shape[1] != R.shape[2]:
        raise InputError(
            f"shape {R.shape}",
            source="memory",
            key="residues",
            expected=f"({len(s)}, n, n) for {len(s)} poles",
        )
    n = R.shape[1]
    D = np.zeros((n, n)) if damping is None else np.array(damping, dtype=np.float64)
    if D.shape != (n, n):
        raise InputError(f"shape {D.shape}", source="memory", key="damping", expected=f"({n}, {n})")
    if not (np.isfinite(s).all() and np.isfinite(R).all() and np.isfinite(D).all()):
        raise InputError("a value is not finite", source="memory", key="poles, residues, damping")
    if not (s.real < 0.0).all():
        worst = s[np.argmax(s.real)]
        raise InputError(
            f"{worst:.4g} 1/s does not decay", source="memory", key="poles", expected="negative real parts"
        )
    channels = np.ascontiguousarray(np.argwhere((R != 0.0).any(axis=0)).reshape(-1, 2), dtype=np.int64)
    of_channels = R[:, channels[:, 0], channels[:, 1]].T
    return ExponentialMemory(
        poles=_copied(np.concatenate([s.real, s.imag])),
        channels=channels,
        residues=_copied(np.hstack([of_channels.real, -of_channels.imag])),
        damping=_copied(D),
        state=_copied(np.zeros((n, 2 * len(s)))),
        decay=aligned((2 * len(s),)),
        of_start=aligned((2 * len(s),)),
        of_end=aligned((2 * len(s),)),
        halves=aligned((len(channels), 2 * len(s))),
        step=np.array([-1.0]),
        implicit=_copied(D),
        explicit=_copied(np.zeros((n, n))),
    )


def pack_direct_memory(
    response: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    step: float,
    duration: float,
    damping: ArrayLike | None = None,
) -> DirectMemory:
    """Arrays of a direct convolution, at rest.

    Parameters
    ----------
    response
        K(t): times [s], shape (m,), to kernels, shape (m, n, n).
    step
        Length of every step [s].
    duration
        How far back the memory reaches [s]; rounded up to whole steps.
    damping
        Real, shape (n, n); default none.

    Raises
    ------
    InputError
        If the step or the duration is not positive, or the kernel is not finite.

    Notes
    -----
    The weights of a step are int K(t) f(t) dt with f linear from one velocity to the other, by Simpson's rule: of
    fourth order in a length that is far below any period of the kernel.
    """
    if not (np.isfinite(step) and np.isfinite(duration) and 0.0 < step <= duration):
        raise InputError(
            f"step {step} s, duration {duration} s",
            source="memory",
            key="step",
            expected="0 < step <= duration",
        )
    taps = int(np.ceil(duration / step - 1e-9))
    samples = 4 * int(np.ceil(0.25 * step / PIECE - 1e-9))
    per_half = samples // 2
    times = step / samples * np.arange(taps * samples + per_half + 1, dtype=np.float64)
    K = np.asarray(response(times), dtype=np.float64)
    n = K.shape[-1]
    if K.shape != (len(times), n, n) or not np.isfinite(K).all():
        raise InputError(f"shape {K.shape}", source="memory", key="kernel", expected="finite, (times, n, n)")
    D = np.zeros((n, n)) if damping is None else np.array(damping, dtype=np.float64)
    first, part = _simpson(per_half, 0.5 * step)
    half = K[: per_half + 1]
    near = np.tensordot(first * (1.0 - part), half, 1)
    explicit = np.tensordot(first * part, half, 1)
    channels = np.ascontiguousarray(np.argwhere((K != 0.0).any(axis=0)).reshape(-1, 2), dtype=np.int64)
    series = np.ascontiguousarray(K[:, channels[:, 0], channels[:, 1]].T)
    whole, part = _simpson(samples, step)
    weights = []
    for offset in (per_half, 0):
        pieces = np.stack(
            [series[:, offset + k : offset + k + taps * samples : samples] for k in range(samples + 1)],
            axis=2,
        )
        both = np.empty((len(channels), 2 * taps))
        both[:, 0::2] = pieces @ (whole * part)  # the start of a step is the end of the interval of age
        both[:, 1::2] = pieces @ (whole * (1.0 - part))
        weights.append(_copied(both))
    return DirectMemory(
        channels=channels,
        middle=weights[0],
        now=weights[1],
        damping=_copied(D),
        state=_copied(np.zeros(1 + 2 * n * taps)),
        step=np.array([float(step)]),
        implicit=_copied(near + D),
        explicit=_copied(explicit),
    )


def _simpson(pieces: int, length: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weights of Simpson's rule over an interval, and how far along it their points are."""
    weights = np.ones(pieces + 1)
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    return weights * (length / pieces / 3.0), np.linspace(0.0, 1.0, pieces + 1)


def _copied(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """A copy that begins at a cache line."""
    out = aligned(values.shape)
    out[...] = values
    return out
