"""Where a step of a mesh has failed: the element, for the message."""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.kind import Meshes
from heavylift.solver.interface import Workspace

__all__ = ["blame_element", "blame_largest"]


@kernel(internal=True)
def blame_element(kind: Meshes, body: int, element: int, outcome: int, work: Workspace) -> None:
    """Stop with an outcome; an element of a body stands in the status as minus its number, less one."""
    work.status.outcome = outcome
    work.status.body = kind.table[body].number
    work.status.block = -1 - element


@kernel(internal=True)
def blame_largest(kind: Meshes, body: int, nodal: Floats1, outcome: int, work: Workspace) -> None:
    """Stop; to blame is the first element with a number that is not finite, or that with the largest displacement."""
    vectors = len(kind.shape[0]) // 3
    nodes = 2 if vectors == 2 else 4
    first = kind.table[body].first_element
    worst, largest = 0, -1.0
    for element in range(kind.table[body].element_count):
        total = 0.0
        for i in range(nodes):
            place = kind.elements[first + element].nodes[i]
            for k in range(3 * vectors):
                size = abs(nodal[place + k])
                if k < 3 or not math.isfinite(size):
                    total += size
        if not math.isfinite(total):
            worst = element
            break
        if total > largest:
            worst, largest = element, total
    blame_element(kind, body, worst, outcome, work)
