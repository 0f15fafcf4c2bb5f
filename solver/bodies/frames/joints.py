"""Rows on frames: which body an attachment is on, and what rows cost a drive."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.frames.base import FrameBodies
from heavylift.solver.drive import DRIVEN
from heavylift.solver.interface import Workspace, add_row_work
from heavylift.solver.kinds import implement
from heavylift.solver.rows.impulses import row_power
from heavylift.solver.rows.structure import FACTORED, PRESCRIBED, RowArrays

__all__ = ["attached_body", "body_with"]


@kernel(inline=True, internal=True)
def body_with(kind: FrameBodies, dof: int) -> int:
    """Row of the body whose first velocity is `dof`, -1 if it is not of this kind."""
    low, high = 0, kind.table.shape[0] - 1
    while low < high:
        middle = (low + high + 1) // 2
        if kind.table[middle].dof <= dof:
            low = middle
        else:
            high = middle - 1
    return low if kind.table[low].dof == dof else -1


@kernel(internal=True)
def attached_body(kind: FrameBodies, system: RowArrays, attachment: int) -> int:
    """Row of the body that an attachment is on, -1 if that is not of this kind or has a diagonal mass."""
    holder = system.attachments[attachment].holder
    if holder != FACTORED and holder != PRESCRIBED:  # noqa: PLR1714  a set costs time here
        return -1
    return body_with(kind, system.attachments[attachment].dof)


@implement(add_row_work, FrameBodies)
@kernel(internal=True)
def add_row_work_of_frames(kind: FrameBodies, weight: float, work: Workspace, system: RowArrays) -> None:
    """A drive does the work that joints take out of its body."""
    if not kind.driven:
        return
    for i in range(system.attachments.shape[0]):
        body = attached_body(kind, system, i)
        if body >= 0 and kind.table[body].motion == DRIVEN:
            kind.frame[body].drive_work -= weight * row_power(system, i, work.velocity)
