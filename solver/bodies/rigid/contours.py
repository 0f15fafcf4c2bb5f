"""Impacts of rigid bodies: what the step before says of the next one."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.rigid.kind import RigidFrames
from heavylift.solver.contact.interface import forget_accelerations
from heavylift.solver.drive import FREE
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(forget_accelerations, RigidFrames)
@kernel(internal=True)
def forget_rigid_accelerations(kind: RigidFrames) -> None:
    """Of the frame; that of its spin is Euler's of a body without moments, which the middle of the next step needs."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        w1, w2, w3 = frame.spin[0], frame.spin[1], frame.spin[2]
        i1, i2, i3 = frame.principal_inertia[0], frame.principal_inertia[1], frame.principal_inertia[2]
        for k in range(3):
            frame.acceleration[k] = 0.0
        frame.spin_rate[0] = (i2 - i3) / i1 * w2 * w3
        frame.spin_rate[1] = (i3 - i1) / i2 * w3 * w1
        frame.spin_rate[2] = (i1 - i2) / i3 * w1 * w2
