"""What a step of the explicit scheme of frames and shells may be.

The leapfrog is stable while the step is below ``2/w``, w the highest circular frequency of the tangent stiffness on
the mass; with the share ``z`` of critical damping, whose force comes a stage late, below
``2/w (sqrt(1 + z^2) - z)``. The frequency comes from a power iteration ``x := M^-1 K x``, with ``K x`` as a
difference of internal forces. It approaches from below, and stiffness changes as a body moves: so `SHARE` of the limit
is allowed. The vector is kept, so that a few rounds now and then follow the motion.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.elements import add_elastic_forces
from heavylift.solver.bodies.ancf.kind import MASS_SET, Meshes
from heavylift.solver.bodies.ancf.substitution import node_span, scatter_back, solve_forward
from heavylift.solver.interface import Workspace

__all__ = [
    "FIRST_ROUNDS",
    "SHARE",
    "find_step_limit",
    "follow_step_limit",
    "highest_frequency",
    "start_power_iteration",
]

SHARE = 0.7
"""Of the limit of stability, that a step may be."""

FIRST_ROUNDS, ROUNDS = 200, 5
EVERY = 50
"""Steps between two rounds of the iteration."""

DIFFERENCE = 1e-7
"""Displacement that the difference of forces is taken over, relative to the smaller of the body and 1 m."""


@kernel(internal=True)
def _write_elastic_forces(kind: Meshes, body: int, q: Floats1, force: Floats1) -> None:
    """``force = B^T C e(q) + K_b q``."""
    first, last = node_span(kind, body)
    for i in range(first, last):
        force[i] = 0.0
    add_elastic_forces(kind, body, q, force, 1.0)


@kernel(internal=True)
def start_power_iteration(kind: Meshes, body: int) -> None:
    """A vector without structure into `trial_position`, which bodies of the explicit scheme do not need otherwise."""
    first, last = node_span(kind, body)
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    for i in range(first, last):
        part = golden * (i - first + 1)
        kind.trial_position[i] = kind.free[i] * (part - math.floor(part) - 0.5)


@kernel(internal=True, reassociate=True)
def highest_frequency(kind: Meshes, body: int, rounds: int) -> float:
    """Highest circular frequency [1/s] at the carried coordinates, by some rounds from the vector in `trial_position`.

    `right_hand_side`, `forward_solution` and `velocity_change` are scratch.
    """
    first, last = node_span(kind, body)
    x, moved, right, rest = (
        kind.trial_position,
        kind.forward_solution,
        kind.right_hand_side,
        kind.velocity_change,
    )
    q, free = kind.position, kind.free
    _write_elastic_forces(kind, body, q, rest)
    square = 0.0
    for _ in range(rounds):
        largest = 0.0
        for i in range(first, last):
            largest = max(largest, abs(x[i]))
        if not largest > 0.0:
            return 0.0
        length = DIFFERENCE * min(kind.body[body].size, 1.0) / largest
        for i in range(first, last):
            moved[i] = q[i] + length * x[i]
        _write_elastic_forces(kind, body, moved, right)
        for i in range(first, last):
            moved[i] = (right[i] - rest[i]) / length * free[i]  # K x
        for i in range(first, last):
            right[i] = moved[i]
        solve_forward(kind, body, MASS_SET)
        scatter_back(kind, body, MASS_SET)
        total = 0.0
        for i in range(first, last):
            total += right[i] * moved[i]
        if not total > 0.0:
            return 0.0
        norm = math.sqrt(total)  # of M^-1 K x, with x of length 1 in the norm of M
        square = norm
        for i in range(first, last):
            x[i] = right[i] / norm
    return math.sqrt(square)


@kernel(internal=True)
def find_step_limit(kind: Meshes, body: int, rounds: int) -> None:
    """Largest step that is allowed, into the numbers of the body."""
    frequency = highest_frequency(kind, body, rounds)
    kind.body[body].step_limit = math.inf
    if frequency > 0.0:
        # damping forces take the velocity extrapolated from the step before, which doubles their part in the limit
        damping = kind.body[body].stiffness_damping * frequency + kind.body[body].viscous_damping / frequency
        part = math.sqrt(1.0 + damping * damping) - damping
        kind.body[body].step_limit = SHARE * 2.0 / frequency * part


@kernel(internal=True)
def follow_step_limit(kind: Meshes, body: int, work: Workspace) -> float:
    """Largest step that is allowed [s], looked at again every now and then."""
    if int(work.control.step_count) % EVERY == EVERY - 1:
        find_step_limit(kind, body, ROUNDS)
    return kind.body[body].step_limit
