"""Uniform gravity: a field that bodies feel on their mass, not a marker force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.interface import (
    Workspace,
    add_forces,
)
from heavylift.solver.kinds import implement

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext
    from heavylift.solver.scene.scene import Gravity

__all__ = ["UniformGravity", "pack"]


class UniformGravity(Arrays):
    """Acceleration [m/s2], world axes, shape (3,): the sum of all entries of the scene."""

    acceleration: Floats1


def pack(entries: Sequence[Gravity], context: PackingContext) -> None:
    """Make the kind from the entries of a scene."""
    context.add_forces(
        UniformGravity(np.sum([entry.acceleration for entry in entries], axis=0, dtype=np.float64))
    )


@implement(add_forces, UniformGravity)
@kernel(internal=True)
def add_gravity(kind: UniformGravity, time: float, work: Workspace) -> None:
    """Add the acceleration to the field."""
    for k in range(3):
        work.sums.gravity[k] += kind.acceleration[k]
