"""Rows on frames: which body an attachment is on, what rows cost a drive, and what holds a body."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.frames import FrameBodies
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import Workspace, add_row_work, gather_reactions
from heavylift.solver.kinds import implement
from heavylift.solver.row_impulses import row_power
from heavylift.solver.rows import FACTORED, PRESCRIBED, RowArrays

__all__ = ["attached_body", "body_with", "gather_reactions_on_frames", "held_body"]


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


@kernel(internal=True)
def held_body(kind: FrameBodies, system: RowArrays, attachment: int) -> int:
    """Row of the fixed or driven body that an attachment is on, -1 if there is none of this kind."""
    body = attached_body(kind, system, attachment)
    return -1 if body < 0 or kind.table[body].motion == FREE else body


@implement(add_row_work, FrameBodies)
@kernel(internal=True)
def add_row_work_of_frames(kind: FrameBodies, weight: float, work: Workspace, system: RowArrays) -> None:
    """A drive does the work that joints take out of its body."""
    if not kind.held:
        return
    for i in range(system.attachments.shape[0]):
        body = held_body(kind, system, i)
        if body >= 0 and kind.table[body].motion == DRIVEN:
            kind.frame[body].drive_work -= weight * row_power(system, i, work.velocity)


@implement(gather_reactions, FrameBodies)
@kernel(internal=True)
def gather_reactions_on_frames(kind: FrameBodies, fresh: bool, system: RowArrays) -> None:
    """Force and moment ``G^T reaction`` on held frames at the carried state."""
    if not kind.held:
        return
    lanes = system.lanes
    if fresh:
        for body in range(kind.table.shape[0]):
            for k in range(6):
                kind.frame[body].joint_force[k] = 0.0
    for i in range(system.attachments.shape[0]):
        body = held_body(kind, system, i)
        if body < 0:
            continue
        panel = system.attachments[i].panel
        reaction = system.rows[system.attachments[i].owner].reaction
        for k in range(6):
            force = 0.0
            for r in range(lanes):
                force += system.panels[panel + k * lanes + r] * reaction[r]
            kind.frame[body].joint_force[k] += force
