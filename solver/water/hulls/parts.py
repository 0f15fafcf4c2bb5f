"""What a database brings to hulls: memory of radiated waves and forces of incoming ones, as parts of their kind.

A scene without waves, or without memory, has empty tables here, and runs nothing of them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records
from heavylift.solver.kinds import implement, optional
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

__all__ = [
    "DirectPart",
    "ExponentialPart",
    "SeriesPart",
    "SummedPart",
    "add_waves",
    "begin_memory",
    "keep_memory",
    "memory_now",
]


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
