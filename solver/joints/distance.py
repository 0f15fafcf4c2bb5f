"""Distance joints: the distance of the two points is kept, a weightless rod; 1 row.

::

    |p_b - p_a| - l = 0
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Positive
from heavylift.numerics.records import Records, filled, records
from heavylift.solver.interface import Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import JointEntry, JointPlace, entry_fields
from heavylift.solver.joints.reactions import clear_reaction, reaction_outputs, reactions
from heavylift.solver.joints.row_writing import (
    Vector,
    bias,
    difference,
    dot,
    minus,
    put_direction_row,
    rate,
    residuals,
    targets,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import JOINTS, Joint, Place

__all__ = ["Distance", "Distances", "pack"]


@JOINTS.describe("distance")
@dataclass(frozen=True, eq=False, kw_only=True)
class Distance(Joint):
    """The distance of the two points is kept."""

    PLACE: ClassVar = Place.APART
    ROTATIONAL: ClassVar = (False,)

    length: Annotated[float | None, Positive("length")] = None
    """Distance [m]; as at the start if absent."""


class DistanceEntry(JointEntry):
    """A distance joint, with the length that it keeps [m]."""

    length: float


class Distances(Arrays):
    """All distance joints of a scene."""

    table: Records[DistanceEntry]


def pack(joints: Sequence[Distance], places: Sequence[JointPlace], book: MarkerBook) -> Distances:
    """Make the kind.

    Raises
    ------
    InputError
        If a length is not positive, or the two points coincide at the start: a distance has no direction there.
    """
    rows = [
        filled(DistanceEntry, **entry_fields(book, joint, place), length=_length(joint, place))
        for joint, place in zip(joints, places, strict=True)
    ]
    return Distances(records(DistanceEntry, rows))


def _length(joint: Distance, place: JointPlace) -> float:
    """Length that is kept [m]."""
    given = joint.length
    if given is not None and not 0.0 < given < math.inf:
        raise InputError(
            f"length {given} m",
            source=joint.name,
            key="length",
            expected="a positive length; or a ball joint",
        )
    start = float(np.linalg.norm(place.frames[1].point - place.frames[0].point))
    if not start > 1e-9 * (given or 1.0):
        raise InputError(
            f"the points are {start:.3g} m apart at the start",
            source=joint.name,
            key="points",
            expected="points apart; or a ball joint",
        )
    return start if given is None else float(given)


@kernel(inline=True, internal=True)
def _line(work: Workspace, point_a: int, point_b: int) -> tuple[float, Vector]:
    """Distance [m] and unit direction from a to b."""
    r = difference(work, point_a, point_b)
    size = math.sqrt(dot(r, r))
    return size, (r[0] / size, r[1] / size, r[2] / size)


@implement(fill_rows, Distances)
@kernel(internal=True)
def fill_distance_rows(kind: Distances, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        size, e = _line(work, point_a, point_b)
        put_direction_row(system, 2 * block, 0, work, point_a, (-e[0], -e[1], -e[2]))
        put_direction_row(system, 2 * block + 1, 0, work, point_b, e)
        if with_residual:
            residuals(system, block)[0] = size - entry.length


@implement(fill_bias, Distances)
@kernel(internal=True)
def fill_distance_bias(kind: Distances, time: float, work: Workspace, system: RowArrays) -> None:
    """``gamma = e . b + (|r'|^2 - (e . r')^2) / |r|`` with the second rate b of ``r = p_b - p_a``."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        size, e = _line(work, point_a, point_b)
        moving = minus(rate(work, point_b), rate(work, point_a))
        along = dot(e, moving)
        across = dot(moving, moving) - along * along
        gamma = dot(e, minus(bias(work, point_b), bias(work, point_a))) + across / size
        targets(system, block)[0] = -gamma


@implement(record_joints, Distances)
@kernel(internal=True)
def record_distances(
    kind: Distances, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b: along the line, positive if it pushes."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, reaction_outputs(row, entry.column)
        _, e = _line(work, entry.point_a, entry.point_b)
        clear_reaction(out)
        force = reactions(system, block)[0]
        for k in range(3):
            out.reaction_force[k] = force * e[k]
