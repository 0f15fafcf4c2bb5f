"""Frames and shells in a second-order step: one linear solve with carried strains.

"Stress as multiplier": each strain at a Gauss point is a constraint with the compliance of the material, and its
value ``s`` is carried as joints carry their positions, in the notation of "Integrated simulation ... (2018)",
eq. 49::

    qm = q + h/2 v,   B = de/dq at qm
    ( M (1 + h/2 a) + (h^2/4 + h/2 b) (B^T C B + K_b) ) vb = M v + h/2 ( f - B^T C s - K_b q )  + G^T P
    q += h vb,   v := 2 vb - v,   s += h B vb

with viscous damping a and stiffness damping b. The matrix is positive definite in any state, the scheme is of second
order, and ``v^T M v/2 + s^T C s/2 + q^T K_b q/2 - f^T q`` is conserved. What drifts is the distance of s from
the strains of the shape; `heavylift.solver.bodies.ancf.energy_momentum` takes over where it matters.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.solver.bodies.ancf.assembly import (
    add_matrix_products,
    clear_fixed,
    factor_set,
    start_step_matrix,
)
from heavylift.solver.bodies.ancf.elements import (
    add_elastic_forces,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
)
from heavylift.solver.bodies.ancf.faults import blame_largest
from heavylift.solver.bodies.ancf.kind import (
    ENERGY_MOMENTUM,
    EXPLICIT,
    MASS_SET,
    STEP_SET,
    Meshes,
)
from heavylift.solver.bodies.ancf.loads import gather_loads
from heavylift.solver.bodies.ancf.moving import release_points, write_free_points
from heavylift.solver.bodies.ancf.stability import (
    FIRST_ROUNDS,
    find_step_limit,
    follow_step_limit,
    start_power_iteration,
)
from heavylift.solver.bodies.ancf.stage import base_value
from heavylift.solver.bodies.ancf.substitution import copy_strains, node_span, solve_forward
from heavylift.solver.interface import (
    Workspace,
    check,
    estimate_error,
    factor,
    finish,
    predict,
    start,
)
from heavylift.solver.kinds import implement

__all__ = ["add_gravity", "forget_mean_velocity", "is_iterated", "solve_free", "write_free_bases"]

NOT_FINITE, STEP_TOO_LARGE = int(Outcome.NOT_FINITE), int(Outcome.STEP_TOO_LARGE)


@kernel(inline=True, internal=True)
def is_iterated(kind: Meshes, body: int) -> bool:
    """Whether the energy-momentum scheme steps this body."""
    return kind.table[body].scheme == ENERGY_MOMENTUM or kind.body[body].changed_over


@kernel(internal=True)
def write_free_bases(kind: Meshes, body: int, nodal: Floats1, start: float, work: Workspace) -> None:
    """What bases and points do without joints, after `solve_forward`, plus `start` times some velocities."""
    dof, first = kind.table[body].dof, kind.table[body].first_base
    for i in range(kind.table[body].base_count):
        place = kind.bases[first + i].place
        y = base_value(kind, first + i, nodal)
        for k in range(3):
            work.velocity[dof + 3 * i + k] = start * y[k] - kind.right_hand_side[place + k]
    write_free_points(kind.moving, kind, body, nodal, start, work.velocity)


@kernel(internal=True)
def solve_free(kind: Meshes, body: int, work: Workspace) -> None:
    """Forward substitution of `right_hand_side`, which is kept for `complete`; what bases do without joints."""
    solve_forward(kind, body, kind.body[body].stage_set)
    first, last = node_span(kind, body)
    for i in range(first, last):
        kind.forward_solution[i] = kind.right_hand_side[i]
    write_free_bases(kind, body, kind.velocity, 1.0, work)
    kind.body[body].change = -1.0


@kernel(internal=True)
def add_gravity(kind: Meshes, body: int, work: Workspace, factor: float) -> None:
    """Weight into `right_hand_side`."""
    lanes, rows = len(kind.shape[1]), len(kind.shape[0])
    R = kind.body[body]
    g = work.sums
    first, last = node_span(kind, body)
    x = factor * (
        R.rotation[0, 0] * g.gravity[0] + R.rotation[1, 0] * g.gravity[1] + R.rotation[2, 0] * g.gravity[2]
    )
    y = factor * (
        R.rotation[0, 1] * g.gravity[0] + R.rotation[1, 1] * g.gravity[1] + R.rotation[2, 1] * g.gravity[2]
    )
    z = factor * (
        R.rotation[0, 2] * g.gravity[0] + R.rotation[1, 2] * g.gravity[1] + R.rotation[2, 2] * g.gravity[2]
    )
    right, weight = kind.right_hand_side, kind.nodal_mass
    for node in range(first, last, lanes):
        for a in range(0, rows, 3):
            right[node + a] += weight[node + a] * x
            right[node + a + 1] += weight[node + a] * y
            right[node + a + 2] += weight[node + a] * z


@kernel(internal=True)
def forget_mean_velocity(kind: Meshes, body: int) -> None:
    """After a jump of the velocities, and before the first step: they are steady as they are."""
    first, last = node_span(kind, body)
    kind.body[body].last_step = 0.0
    for i in range(first, last):
        kind.mean_velocity[i] = kind.steady_velocity[i] = kind.velocity[i]


@implement(start, Meshes)
@kernel(internal=True)
def start_meshes(kind: Meshes, time: float, work: Workspace) -> None:
    """Carried strains are those of the shape at the start; the explicit scheme learns what its steps may be."""
    for body in range(kind.table.shape[0]):
        forget_mean_velocity(kind, body)
        find_strains(kind, body, kind.position, kind.strain)
        if kind.table[body].scheme == EXPLICIT:
            start_power_iteration(kind, body)
            find_step_limit(kind, body, FIRST_ROUNDS)


@kernel(inline=True, internal=True)
def _growth_to_middle(kind: Meshes, body: int, step: float) -> float:
    """Half this step over half the last one, in which velocities have grown from mean to steady ones."""
    before = kind.body[body].last_step
    return step / before if before > 0.0 else 0.0


@implement(predict, Meshes)
@kernel(internal=True)
def predict_meshes(kind: Meshes, time: float, step: float) -> None:
    """Midpoint along straight lines, free of ringing; predicted midpoint velocity for rates of markers."""
    half = 0.5 * step
    q, steady, mean = kind.position, kind.steady_velocity, kind.mean_velocity
    for body in range(kind.table.shape[0]):
        growth = _growth_to_middle(kind, body, step)
        # the leapfrog of the explicit scheme goes on with its own velocities: it does not ring below its limit
        ahead = kind.velocity if kind.table[body].scheme == EXPLICIT else steady
        first, last = node_span(kind, body)
        for i in range(first, last):
            kind.mid_position[i] = q[i] + half * ahead[i]
            kind.mid_velocity[i] = steady[i] + growth * (steady[i] - mean[i])
        kind.body[body].time = time + half
        if kind.body[body].changed_over and kind.body[body].change_time >= time:
            kind.body[body].changed_over = False  # in a step that was taken back


@implement(factor, Meshes)
@kernel(internal=True)
def factor_meshes(kind: Meshes, step: float, work: Workspace) -> None:
    """Matrix and right-hand side of the stage, factor and forward substitution.

    Notes
    -----
    Solved for the change ``w = vb - v`` of the velocity: in stiff bodies the matrix is large against the mass, and its
    rounding times the whole velocity would lose energy steadily::

        A w = h/2 ( f - a M v - K_b (q + (h/2 + b) v) - B^T C (s + (h/2 + b) B v) ) + G^T P
    """
    half = 0.5 * step
    gather_loads(kind, kind.mid_position, work)
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        release_points(kind.moving, kind, body)
        right, load, ahead = kind.right_hand_side, kind.external_force, kind.trial_position
        for i in range(first, last):
            right[i] = half * load[i]
        add_gravity(kind, body, work, half)
        if kind.table[body].scheme == EXPLICIT:
            _add_explicit_forces(kind, body, half)
            kind.body[body].stage_set = MASS_SET
        else:
            viscous = kind.body[body].viscous_damping
            delay = half + kind.body[body].stiffness_damping
            for i in range(first, last):
                ahead[i] = kind.position[i] + delay * kind.velocity[i]
            add_matrix_products(kind, body, kind.velocity, -half * viscous, ahead, -half, right)
            copy_strains(kind, body, kind.strain, kind.stage_strain)
            add_strain_rates(kind, body, kind.mid_position, kind.velocity, kind.stage_strain, delay)
            start_step_matrix(kind, body, 1.0 + half * viscous, half * delay)
            add_stiffness(kind, body, kind.mid_position, kind.stage_strain, right, -half, half * delay, 0.0)
            clear_fixed(kind, body, STEP_SET)
            factor_set(kind, body, STEP_SET)
            kind.body[body].stage_set = STEP_SET
        solve_free(kind, body, work)


@kernel(internal=True)
def _add_explicit_forces(kind: Meshes, body: int, half: float) -> None:
    """Elastic and damping forces at the midpoint: the position form of the leapfrog."""
    viscous, stiff = kind.body[body].viscous_damping, kind.body[body].stiffness_damping
    speed, right = kind.mid_velocity, kind.right_hand_side
    add_elastic_forces(kind, body, kind.mid_position, right, -half)
    if viscous > 0.0 or stiff > 0.0:
        add_matrix_products(kind, body, speed, -half * viscous, speed, -half * stiff, right)
    if stiff > 0.0:
        first = kind.table[body].first_strain
        for i in range(first, first + kind.table[body].strain_count):
            kind.shape_strain[i] = 0.0
        add_strain_rates(kind, body, kind.mid_position, speed, kind.shape_strain, stiff)
        add_stress_forces(kind, body, kind.mid_position, kind.shape_strain, right, -half)


@implement(check, Meshes)
@kernel(internal=True, reassociate=True)
def check_meshes(kind: Meshes, step: float, work: Workspace) -> None:
    """Refuse what is not finite, and explicit steps beyond their limit."""
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        speed = kind.mid_velocity
        total = 0.0
        for i in range(first, last):
            total += abs(speed[i])
        if not math.isfinite(total):
            blame_largest(kind, body, kind.mid_velocity, NOT_FINITE, work)
        elif kind.table[body].scheme == EXPLICIT and step > follow_step_limit(kind, body, work):
            # where the fastest vibration is
            blame_largest(kind, body, kind.trial_position, STEP_TOO_LARGE, work)


@implement(finish, Meshes)
@kernel(internal=True)
def finish_meshes(kind: Meshes, step: float, work: Workspace) -> None:
    """Nothing is left to do."""


@implement(estimate_error, Meshes)
@kernel(internal=True)
def estimate_mesh_error(kind: Meshes, step: float, work: Workspace) -> None:
    """Largest distance of a midpoint velocity from its prediction, as a displacement [m] over the step."""
    lanes = len(kind.shape[1])
    steady, mean, found = kind.steady_velocity, kind.mean_velocity, kind.mid_velocity
    for body in range(kind.table.shape[0]):
        growth = _growth_to_middle(kind, body, step)
        first, last = node_span(kind, body)
        largest = 0.0
        for node in range(first, last, lanes):
            total = 0.0
            for k in range(node, node + 3):
                total += (found[k] - steady[k] - growth * (steady[k] - mean[k])) ** 2
            largest = max(largest, total)
        error = step * math.sqrt(largest)
        if not error <= work.control.error:
            work.control.error = error
            work.status.body = kind.table[body].number
