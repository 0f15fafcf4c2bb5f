"""The system of rows of a scene with springs and laws: the blocks of its joints, then one block for each of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.rows.structure import (
    DIAGONAL,
    HUB,
    PRESCRIBED,
    Attachment,
    RowSystem,
    pack_rows,
)

__all__ = ["ElementBlock", "extend_system"]

GROUND_SIDE = Attachment(-1, -1, 0, PRESCRIBED)


@dataclass(frozen=True)
class ElementBlock:
    """Rows of one force element on any number of bodies.

    Attributes
    ----------
    name
        Of what it belongs to, for messages.
    sides
        Its bodies, each once; the ground need not be there.
    scale
        Characteristic inverse mass [1/kg] or [1/(kg m2)].
    compliance, relaxation
        Of a spring: the inverse of its stiffness, damping over stiffness [s]. A law fits its row itself; its
        compliance says only that the row is not rigid.
    rows
        How many, on the same bodies.
    vectors
        Of each row the vector whose component it is, see `heavylift.solver.rows.structure.Row`; none if empty.
    fitted
        Whether the rows are fitted to a law by iteration.
    """

    name: str
    sides: tuple[Attachment, ...]
    scale: float
    compliance: float = 1.0
    relaxation: float = 0.0
    rows: int = 1
    vectors: tuple[int, ...] = ()
    fitted: bool = True

    @property
    def block_count(self) -> int:
        """Blocks of two sides that it takes."""
        return max(1, (len(self.sides) + 1) // 2)


def extend_system(
    joints: RowSystem | None,
    blocks: Sequence[ElementBlock],
    inverse_mass: NDArray[np.float64],
    monitor: int,
) -> RowSystem:
    """Lay out the rows of joints and of what follows them in one system.

    Parameters
    ----------
    joints
        System of the joints alone; None without joints.
    blocks
        Rows that follow.
    inverse_mass, monitor
        As in `RowSystem`.
    """
    counts: list[int] = []
    scales: list[NDArray[np.float64]] = []
    sides: list[tuple[Attachment, Attachment]] = []
    owners: list[int] = []
    if joints is not None:
        for i, rows in enumerate(joints.rows[: len(joints.attachments) // 2]):
            used = int(np.count_nonzero(rows.scale))
            counts.append(used)
            scales.append(rows.scale[:used].copy())
            sides.append((_side(joints, 2 * i), _side(joints, 2 * i + 1)))
            owners.append(i)
    starts = []
    for block in blocks:
        starts.append(len(counts))
        ends = [Attachment(end.dof, end.dof, end.width, end.holder) for end in block.sides]
        ends += [GROUND_SIDE] * (2 * block.block_count - len(ends))
        for part in range(block.block_count):  # sides beyond the second are those of blocks without rows
            counts.append(block.rows if part == 0 else 0)
            scales.append(np.full(counts[-1], block.scale if block.scale > 0.0 else 1.0))
            sides.append((ends[2 * part], ends[2 * part + 1]))
            owners.append(starts[-1])
    made = pack_rows(counts, sides, scales, inverse_mass, monitor, owners)
    if joints is not None:
        width, blocks_before = min(joints.lanes, made.lanes), len(joints.attachments) // 2
        for name in ("compliance", "relaxation", "stiffness", "rigid", "vector"):
            made.rows[name][:blocks_before, :width] = joints.rows[name][:blocks_before, :width]
    for start, block in zip(starts, blocks, strict=True):
        made.rows[start].compliance[: block.rows] = block.compliance
        made.rows[start].relaxation[: block.rows] = block.relaxation
        made.rows[start].vector[: len(block.vectors)] = block.vectors
    return made._replace(laws=any(block.fitted for block in blocks))


def _side(system: RowSystem, i: int) -> Attachment:
    """A side of a block as it was given, but for the number of the body: its first velocity tells it as well."""
    side = system.attachments[i]
    holder = DIAGONAL if side.holder == HUB else int(side.holder)
    return Attachment(int(side.dof), int(side.dof), int(side.width), holder)
