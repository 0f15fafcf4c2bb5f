"""What a database brings to hulls: memory of radiated waves and forces of incoming ones, as parts of their kind.

A scene without waves, or without memory, has empty tables here, and runs nothing of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.kinds import implement, optional
from heavylift.solver.water.hulls.checks import check_places
from heavylift.solver.water.hulls.kind import (
    HullStage,
    HullVectors,
    Parts,
)
from heavylift.solver.water.hulls.memory import (
    DirectMemory,
    ExponentialMemory,
    advance_memory_direct,
    advance_memory_exponential,
    memory_force_direct,
    memory_force_exponential,
    memory_force_now_direct,
    memory_force_now_exponential,
    prepare_memory_exponential,
)
from heavylift.solver.water.waves.excitation import (
    SeriesExcitation,
    SummedExcitation,
    interpolate_series,
    sum_excitation,
)

if TYPE_CHECKING:
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.solver.scene.sea import FloatingBody, Radiation, Sea

__all__ = [
    "DirectPart",
    "ExponentialPart",
    "SeriesPart",
    "SummedPart",
    "add_waves",
    "begin_memory",
    "check_series",
    "keep_memory",
    "memory_now",
    "pack_parts",
]

FIT_STEP, SHORTEST_FIT, SHORTEST_MEMORY = 0.1, 60.0, 40.0
"""Of the samples that exponentials are fitted to [s], how far these reach at least, and direct convolution does [s]."""

SERIES_MOVED, SERIES_TURNED = 0.05, np.radians(0.1)
"""How far a start may move hulls whose wave forces are tabulated: metres and radians."""


class ExponentialPart(Arrays):
    """Recursive memory of the hulls of a database: first coordinate, shape (1,), and its arrays."""

    first: Ints1
    memory: ExponentialMemory


class DirectPart(Arrays):
    """Memory of the hulls of a database by convolution: first coordinate, shape (1,), and its arrays."""

    first: Ints1
    memory: DirectMemory


class SummedPart(Arrays):
    """Forces of waves on moving hulls: first hull, shape (1,); places, shape (N, 3); their arrays."""

    first: Ints1
    place: Floats2
    excitation: SummedExcitation


class SeriesPart(Arrays):
    """Tabulated forces of waves: first hull, shape (1,); places and headings they hold for, (N, 3); their arrays."""

    first: Ints1
    held: Floats2
    excitation: SeriesExcitation


@optional()
def begin_memory(parts: Parts, step: float, implicit: Floats2, vectors: HullVectors) -> None:
    """Memory: its force at the middle of the step, without the part of the velocity there, and that part."""


@optional()
def keep_memory(parts: Parts, vectors: HullVectors) -> None:
    """Memory: to the end of the step."""


@optional("record")
def memory_now(parts: Parts, vectors: HullVectors) -> None:
    """Memory: its force at the carried state and the velocities in `finish`."""


@optional()
def add_waves(parts: Parts, time: float, stage: Records[HullStage], vectors: HullVectors) -> None:
    """Waves: their forces at a time, at the places and headings of the stage."""


@implement(begin_memory, ExponentialPart)
@kernel(internal=True)
def begin_exponential(
    part: ExponentialPart, step: float, implicit: NDArray[np.float64], vectors: HullVectors
) -> None:
    """Coefficients are made anew when the step changes."""
    prepare_memory_exponential(part.memory, step)
    _put_implicit(part.first[0], part.memory.implicit, implicit)
    first = part.first[0]
    last = first + part.memory.damping.shape[0]
    memory_force_exponential(part.memory, vectors.start[first:last], vectors.known[first:last])


@implement(begin_memory, DirectPart)
@kernel(internal=True)
def begin_direct(part: DirectPart, step: float, implicit: NDArray[np.float64], vectors: HullVectors) -> None:
    """Weights hold for one length of step."""
    _put_implicit(part.first[0], part.memory.implicit, implicit)
    first = part.first[0]
    last = first + part.memory.damping.shape[0]
    memory_force_direct(part.memory, vectors.start[first:last], vectors.known[first:last])


@kernel(internal=True)
def _put_implicit(first: int, block: NDArray[np.float64], implicit: NDArray[np.float64]) -> None:
    """The block of one database."""
    for i in range(block.shape[0]):
        for j in range(block.shape[0]):
            implicit[first + i, first + j] = block[i, j]


@implement(keep_memory, ExponentialPart)
@kernel(internal=True)
def keep_exponential(part: ExponentialPart, vectors: HullVectors) -> None:
    """Velocities are linear between start and end."""
    first = part.first[0]
    last = first + part.memory.damping.shape[0]
    advance_memory_exponential(part.memory, vectors.start[first:last], vectors.finish[first:last])


@implement(keep_memory, DirectPart)
@kernel(internal=True)
def keep_direct(part: DirectPart, vectors: HullVectors) -> None:
    """Velocities are linear between start and end."""
    first = part.first[0]
    last = first + part.memory.damping.shape[0]
    advance_memory_direct(part.memory, vectors.start[first:last], vectors.finish[first:last])


@implement(memory_now, ExponentialPart)
@kernel(internal=True)
def exponential_now(part: ExponentialPart, vectors: HullVectors) -> None:
    """At the carried state."""
    first = part.first[0]
    last = first + part.memory.damping.shape[0]
    memory_force_now_exponential(part.memory, vectors.finish[first:last], vectors.known[first:last])


@implement(memory_now, DirectPart)
@kernel(internal=True)
def direct_now(part: DirectPart, vectors: HullVectors) -> None:
    """At the carried state."""
    first = part.first[0]
    last = first + part.memory.damping.shape[0]
    memory_force_now_direct(part.memory, vectors.finish[first:last], vectors.known[first:last])


@implement(add_waves, SummedPart)
@kernel(internal=True)
def add_summed_waves(part: SummedPart, time: float, stage: Records[HullStage], vectors: HullVectors) -> None:
    """Every component at the low-passed places."""
    first, count = part.first[0], part.place.shape[0]
    for hull in range(count):
        part.place[hull, 0] = stage[first + hull].place[0]
        part.place[hull, 1] = stage[first + hull].place[1]
        part.place[hull, 2] = stage[first + hull].heading
    sum_excitation(part.excitation, time, part.place, vectors.wave[6 * first : 6 * (first + count)])


@implement(add_waves, SeriesPart)
@kernel(internal=True)
def add_series_waves(part: SeriesPart, time: float, stage: Records[HullStage], vectors: HullVectors) -> None:
    """Interpolated."""
    first = 6 * part.first[0]
    count = part.excitation.values.shape[1]
    interpolate_series(part.excitation, time, vectors.wave[first : first + count])


def pack_parts(
    bodies: Sequence[FloatingBody], sea: Sea, step: float, notes: list[str]
) -> tuple[NDArray[np.float64], Parts, Parts, NDArray[np.float64]]:
    """Added mass of all hulls, memory and excitation of each database, and the states of the memories, flat.

    Raises
    ------
    InputError
        If a database belongs to other water, or does not cover the waves.
    """
    names = [body.name for body in bodies]
    added_mass = np.zeros((6 * len(names), 6 * len(names)))
    memories: list[Any] = []
    excitations: list[Any] = []
    for radiation in sea.radiation:
        first = names.index(radiation.bodies[0])
        _check_water(radiation, sea)
        check_places(radiation, bodies[first : first + len(radiation.bodies)])
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
    from heavylift.preprocess.hydrodynamics.retardation import check_infinite_added_mass, infinite_added_mass

    w, A, B = database.omega, database.added_mass, database.damping
    check_infinite_added_mass(w, A, B, database.added_mass_infinite, source=database.source)
    consistent = infinite_added_mass(w, A, B, source=database.source)[0]
    return np.asarray(0.5 * (consistent + consistent.T))


def _memory(radiation: Radiation, first: int, step: float, notes: list[str]) -> ExponentialPart | DirectPart:
    from heavylift.preprocess.hydrodynamics.retardation import memory_length, retardation_kernel

    database = radiation.database
    kernel_of_time = retardation_kernel(database.omega, database.damping, source=database.source)
    length = radiation.memory_length or max(memory_length(kernel_of_time), SHORTEST_MEMORY)
    place = np.array([first], dtype=np.int64)
    if radiation.memory == "direct":
        from heavylift.solver.water.hulls.memory import pack_direct_memory

        if not step > 0.0:
            raise InputError(
                "direct convolution without a fixed step",
                source=database.source,
                key="memory",
                expected="a fixed step, and nothing that takes steps back; or 'exponentials'",
            )
        return DirectPart(place, pack_direct_memory(kernel_of_time, step, length))
    from heavylift.preprocess.hydrodynamics.exponentials import fit_exponentials
    from heavylift.solver.water.hulls.memory import pack_exponential_memory

    times = np.arange(0.0, max(length, SHORTEST_FIT), FIT_STEP)
    fit = fit_exponentials(
        kernel_of_time(times), FIT_STEP, tolerance=radiation.fit_error, source=database.source
    )
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


def _check_water(radiation: Radiation, sea: Sea) -> None:
    """A database was computed for a water, which must be that of the scene."""
    database, water = radiation.database, sea.water
    same = np.isclose(database.density, water.density, rtol=0.01) and np.isclose(
        database.gravity, water.gravity, rtol=5e-3
    )
    depths = 1.0 / np.array([database.depth, water.depth])
    if not (same and abs(depths[0] - depths[1]) <= 0.05 * max(depths)):
        raise InputError(
            f"density {database.density:g} kg/m3, gravity {database.gravity:g} m/s2, depth {database.depth:g} m",
            source=database.source,
            key="density, gravity, depth",
            expected=f"those of the sea: {water.density:g}, {water.gravity:g}, {water.depth:g}",
        )


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
