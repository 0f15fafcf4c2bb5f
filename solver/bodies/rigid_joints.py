"""Joints on rigid bodies whose motion is prescribed: the work they cost the drive, and what holds the body."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.rigid import RigidBodies
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import Workspace, add_row_work, gather_reactions
from heavylift.solver.kinds import implement
from heavylift.solver.row_impulses import row_power
from heavylift.solver.rows import RowArrays

__all__: list[str] = []


@kernel(internal=True)
def _attached(kind: RigidBodies, system: RowArrays, attachment: int) -> int:
    """Row of the body that an attachment is on, -1 if it is not of this kind or not held."""
    dof = system.attachments[attachment].dof
    body = (dof - kind.table[0].dof) // 6
    if dof < kind.table[0].dof or body >= kind.table.shape[0] or kind.table[body].motion == FREE:
        return -1
    return body


@implement(add_row_work, RigidBodies)
@kernel(internal=True)
def add_row_work_of_rigid_bodies(
    kind: RigidBodies, weight: float, work: Workspace, system: RowArrays
) -> None:
    """A drive does the work that joints take out of its body."""
    for i in range(system.attachments.shape[0]):
        body = _attached(kind, system, i)
        if body >= 0 and kind.table[body].motion == DRIVEN:
            kind.frame[body].drive_work -= weight * row_power(system, i, work.velocity)


@implement(gather_reactions, RigidBodies)
@kernel(internal=True)
def gather_reactions_on_rigid_bodies(kind: RigidBodies, fresh: bool, system: RowArrays) -> None:
    """Forces ``G^T reaction`` on held bodies at the carried state."""
    lanes = system.lanes
    if fresh:
        for body in range(kind.table.shape[0]):
            for k in range(6):
                kind.frame[body].joint_force[k] = 0.0
    for i in range(system.attachments.shape[0]):
        body = _attached(kind, system, i)
        if body < 0:
            continue
        panel = system.attachments[i].panel
        reaction = system.rows[system.attachments[i].owner].reaction
        for k in range(6):
            for r in range(lanes):
                kind.frame[body].joint_force[k] += system.panels[panel + k * lanes + r] * reaction[r]
