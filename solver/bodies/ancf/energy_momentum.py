"""The energy-momentum scheme for frames and shells, solved by Newton's method inside the step.

J. C. Simo and N. Tarnow, Z. angew. Math. Phys. 43 (1992): stresses are the mean of those at both ends, their
directions those of the midpoint::

    M vb + h/2 ( B(qm)^T C (s_n + s_{n+1})/2 + K_b qm ) = M v + h/2 f + G^T P,    qm = q + h/2 vb
    s_{n+1} = s_n + e(q_{n+1}) - e(q_n)

which conserves energy and momenta exactly, whatever the quadrature, for strains that are quadratic in q; for others
B(qm) gives way to a discrete gradient (`heavylift.solver.bodies.ancf.frame_exact`), and so they do. Damping
by stiffness takes the rate ``(e_{n+1} - e_n)/h``. The matrix of the carried strains is the first
approximation of the tangent; it is made again, with the stress in it, while the iteration is slow.

A body that carries strains changes over when these drift too far from the shape. What they have drifted stays as a
strain at rest, so that nothing is kicked, and decays slowly: the body follows it without stress.
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
from heavylift.solver.bodies.ancf.elements import add_mean_stress_forces, add_stiffness, find_strains
from heavylift.solver.bodies.ancf.joints import take_impulses
from heavylift.solver.bodies.ancf.kind import AUTO, EXPLICIT, STEP_SET, Meshes
from heavylift.solver.bodies.ancf.moving import add_point_impulses, forget_vectors
from heavylift.solver.bodies.ancf.step import (
    add_gravity,
    blame_element,
    blame_largest,
    find_drift,
    is_iterated,
    write_free_bases,
)
from heavylift.solver.bodies.ancf.substitution import node_span, scatter_back, solve_forward
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Systems,
    Workspace,
    iterate,
    refactor_rows,
    solve_again,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []

CONVERGED, NEARLY = 1e-14, 1e-9
"""Displacement in the last round, relative to the size of the body: small enough, or if rounding allows no less."""

SLOW = 0.1
"""Ratio of two changes above which the matrix is made again."""

STALLED = 0.3
"""Ratio of two changes above which a nearly converged iteration is at the limit of rounding."""

MOST_ROUNDS = 60
NOT_CONVERGED, STRAINS_LOST = int(Outcome.NOT_CONVERGED), int(Outcome.STRAINS_LOST)

LARGEST_SHARE = 0.05
"""Drift of carried strains over the largest strain of the body lately from which they are given up."""

LEAST_DRIFT = 1e-3
"""Drift in units of the allowed one that is none, however small the strains are."""

FORGOTTEN = 1.0 / 256.0
"""Part of the largest strain that is forgotten in a step: what vibrates passes through none."""

LOST = 1.0
"""Distance of carried strains from those of the shape with which they have nothing to do with it any more."""


@kernel(internal=True)
def _average_strains(kind: Meshes, body: int, step: float) -> None:
    """Strains whose stress acts in the step, into `stage_strain`: the mean of both ends, and the rate if damped."""
    find_strains(kind, body, kind.trial_position, kind.shape_strain)
    part = 0.5 + kind.body[body].stiffness_damping / step
    first = kind.table[body].first_strain
    for i in range(first, first + kind.table[body].strain_count):
        change = kind.shape_strain[i] - kind.start_strain[i]
        kind.stage_strain[i] = kind.strain[i] + part * change


@kernel(internal=True)
def _add_base_impulses(kind: Meshes, body: int, nodal: Floats1) -> None:
    """``right_hand_side += J^T P``, with minus P at the places of bases and moving points of a nodal vector."""
    vectors = len(kind.shape[0]) // 3
    nodes = len(kind.ends)
    first = kind.table[body].first_base
    for base in range(first, first + kind.table[body].base_count):
        element, shape = kind.bases[base].element, kind.bases[base].shape_values
        place = kind.bases[base].place
        for i in range(nodes):
            for a in range(vectors):
                at, value = kind.elements[element].nodes[i] + 3 * a, kind.constants[shape + i * vectors + a]
                for k in range(3):
                    kind.right_hand_side[at + k] -= value * nodal[place + k]
    add_point_impulses(kind.moving, kind, body, nodal)


@kernel(internal=True)
def _write_residual(kind: Meshes, body: int, step: float, work: Workspace) -> None:
    """What the balance of momentum of the step lacks, into `right_hand_side`; impulses stand in `trial_position`."""
    half = 0.5 * step
    first, last = node_span(kind, body)
    right, viscous = kind.right_hand_side, 1.0 + half * kind.body[body].viscous_damping
    for i in range(first, last):
        kind.mid_position[i] = kind.position[i] + half * kind.mid_velocity[i]
        kind.trial_position[i] = kind.position[i] + step * kind.mid_velocity[i]
        kind.velocity_change[i] = kind.velocity[i] - viscous * kind.mid_velocity[i]
        right[i] = half * kind.external_force[i]
    add_gravity(kind, body, work, half)
    add_matrix_products(kind, body, kind.velocity_change, 1.0, kind.mid_position, -half, right)
    stiff = kind.body[body].stiffness_damping
    if stiff > 0.0:
        add_matrix_products(kind, body, kind.mid_velocity, 0.0, kind.mid_velocity, -half * stiff, right)
    _average_strains(kind, body, step)
    add_mean_stress_forces(kind, body, right, -half)
    _add_base_impulses(kind, body, kind.trial_position)


@kernel(internal=True)
def _refactor(kind: Meshes, body: int, step: float) -> None:
    """The matrix at the present midpoint, with the stress in it. `right_hand_side` is scratch."""
    half = 0.5 * step
    viscous = 1.0 + half * kind.body[body].viscous_damping
    stiff = half * (half + kind.body[body].stiffness_damping)
    start_step_matrix(kind, body, viscous, stiff)
    geometric = half * half / stiff
    add_stiffness(
        kind, body, kind.mid_position, kind.stage_strain, kind.right_hand_side, 0.0, stiff, geometric
    )
    clear_fixed(kind, body, STEP_SET)
    factor_set(kind, body, STEP_SET)
    forget_vectors(kind.moving, kind, body)


@kernel(internal=True)
def _watch_drift(kind: Meshes, body: int, time: float, step: float, work: Workspace) -> None:
    """Once a step: change over from carried strains to those of the shape when they are too far apart, or stop."""
    if is_iterated(kind, body) or kind.table[body].scheme == EXPLICIT or kind.body[body].change >= 0.0:
        return
    find_drift(kind, body, step)
    kind.body[body].change = 0.0
    drift, allowed = kind.body[body].drift, kind.body[body].drift_tolerance
    kind.body[body].largest_drift = max(drift, kind.body[body].largest_drift)
    level = max(kind.body[body].strained, (1.0 - FORGOTTEN) * kind.body[body].strain_level)
    kind.body[body].strain_level = level
    if drift > LEAST_DRIFT * allowed:  # then there are strains, too
        kind.body[body].largest_share = max(kind.body[body].largest_share, drift / max(level, drift))
        allowed = min(allowed, max(LARGEST_SHARE * level, LEAST_DRIFT * allowed))
    if kind.table[body].scheme == AUTO and not drift <= allowed:
        kind.body[body].changed_over = True
        kind.body[body].change_time = time
        kind.body[body].change = -1.0
    elif not drift <= LOST and math.isfinite(drift):  # what is not finite is found by `check`
        blame_element(kind, body, kind.body[body].drift_element, STRAINS_LOST, work)


@implement(iterate, Meshes)
@kernel(internal=True)
def iterate_meshes(
    kind: Meshes, bodies: Bodies, systems: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """One round of Newton's method for each body of this scheme, with its joints."""
    for body in range(kind.table.shape[0]):
        _watch_drift(kind, body, time, step, work)
        if not is_iterated(kind, body):
            continue
        before = kind.body[body].change
        if before < 0.0:
            kind.body[body].iterations = 0
            find_strains(kind, body, kind.position, kind.start_strain)
        kind.body[body].iterations += 1
        take_impulses(kind, systems, kind.trial_position)
        _write_residual(kind, body, step, work)
        slow = (
            kind.body[body].iterations > 2 and kind.body[body].change > SLOW * kind.body[body].change_before
        )
        if slow:
            _refactor(kind, body, step)
        # rows of joints were made at the predicted midpoint, which in soft bodies is far from the true one
        count = kind.table[body].base_count + kind.table[body].moving_count
        jointed = count > 0 and (slow or kind.body[body].iterations == 1)
        if jointed:
            refactor_rows(systems, bodies, joints, work)
            take_impulses(kind, systems, kind.trial_position)
        if slow or jointed:
            _write_residual(kind, body, step, work)
        solve_forward(kind, body, STEP_SET)
        write_free_bases(kind, body, kind.mid_velocity, 1.0, work)
        solve_again(systems, systems, joints, work, time, step)
        take_impulses(kind, systems, kind.right_hand_side)
        first_base = kind.table[body].first_base
        for base in range(first_base, first_base + count):
            place = kind.bases[base].place
            for k in range(3):
                kind.right_hand_side[place + k] -= kind.trial_position[place + k]
        scatter_back(kind, body, STEP_SET)
        first, last = node_span(kind, body)
        change = 0.0
        for i in range(first, last):
            kind.mid_velocity[i] += kind.right_hand_side[i]
            change += kind.right_hand_side[i] ** 2
        change = step * math.sqrt(change)
        kind.body[body].change_before = before if before >= 0.0 else 1e300
        kind.body[body].change = change
        size, stalled = kind.body[body].size, change > STALLED * kind.body[body].change_before
        if change > CONVERGED * size and not (stalled and change <= NEARLY * size):
            work.control.changed += 1
            if kind.body[body].iterations > MOST_ROUNDS:
                blame_largest(kind, body, kind.right_hand_side, NOT_CONVERGED, work)
