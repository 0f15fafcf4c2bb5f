"""The end of a step of frames and shells: coordinates, strains, works."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.assembly import add_matrix_products
from heavylift.solver.bodies.ancf.elements import (
    add_strain_rates,
    add_stress_forces,
    find_strains,
    measure_drift,
    measure_strain_energy,
)
from heavylift.solver.bodies.ancf.kind import EXPLICIT, Meshes
from heavylift.solver.bodies.ancf.moving import release_points
from heavylift.solver.bodies.ancf.step import is_iterated
from heavylift.solver.bodies.ancf.substitution import copy_strains, node_span
from heavylift.solver.interface import Workspace, advance
from heavylift.solver.kinds import implement
from heavylift.solver.ringing import steady_rate

__all__ = ["add_mesh_work", "find_drift"]

MEMORY = 1.0 / 64.0
"""Weight of a step in the mean energy of what rings: a single impact is none."""

DECAY = 1.0 / 256.0
"""Part of an old drift that a step takes away: slow against everything that a step resolves."""


@kernel(internal=True)
def find_drift(kind: Meshes, body: int, step: float) -> None:
    """Strains at the end of the step if they are carried, into `stage_strain`, and their distance from the shape."""
    first, last = node_span(kind, body)
    for i in range(first, last):
        kind.trial_position[i] = kind.position[i] + step * kind.mid_velocity[i]
    copy_strains(kind, body, kind.strain, kind.stage_strain)
    add_strain_rates(kind, body, kind.mid_position, kind.mid_velocity, kind.stage_strain, step)
    find_strains(kind, body, kind.trial_position, kind.shape_strain)
    measure_drift(kind, body, kind.stage_strain, kind.shape_strain)


@kernel(internal=True, reassociate=True)
def add_mesh_work(kind: Meshes, body: int, step: float, iterated: bool) -> None:
    """Work of the loads and losses in the dampers, with the velocities of the stage.

    Where the step is iterated the rate of a strain is its change: ``B`` of the midpoint is not, if strains are not
    quadratic in the coordinates.
    """
    first, last = node_span(kind, body)
    speed, load, right = kind.mid_velocity, kind.external_force, kind.right_hand_side
    external = 0.0
    for i in range(first, last):
        external += load[i] * speed[i]
    kind.body[body].external_work += step * external
    viscous, stiff = kind.body[body].viscous_damping, kind.body[body].stiffness_damping
    if viscous == 0.0 and stiff == 0.0:
        return
    for i in range(first, last):
        right[i] = 0.0
    add_matrix_products(kind, body, speed, viscous, speed, stiff, right)
    lost = 0.0
    begin = kind.table[body].first_strain
    if stiff > 0.0 and iterated:
        for i in range(begin, begin + kind.table[body].strain_count):
            kind.shape_strain[i] -= kind.start_strain[i]
        kind.body[body].elastic_energy = 0.0
        measure_strain_energy(kind, body, kind.shape_strain)
        lost = 2.0 * stiff * kind.body[body].elastic_energy / (step * step)
    elif stiff > 0.0:
        for i in range(begin, begin + kind.table[body].strain_count):
            kind.shape_strain[i] = 0.0
        add_strain_rates(kind, body, kind.mid_position, speed, kind.shape_strain, stiff)
        add_stress_forces(kind, body, kind.mid_position, kind.shape_strain, right, 1.0)
    for i in range(first, last):
        lost += right[i] * speed[i]
    kind.body[body].dissipated_work += step * lost


@kernel(internal=True)
def _advance_shape_strains(kind: Meshes, body: int) -> None:
    """``s += e(q_{n+1}) - e(q_n)``; what is left of an earlier drift decays.

    Notes
    -----
    Without a change-over the strains are those of the shape: they are taken from it, so that rounding does not add up.
    """
    find_strains(kind, body, kind.position, kind.shape_strain)
    first = kind.table[body].first_strain
    keep = 1.0 - DECAY if kind.body[body].changed_over else 0.0
    for i in range(first, first + kind.table[body].strain_count):
        offset = kind.strain[i] - kind.start_strain[i]
        kind.strain[i] = kind.shape_strain[i] + keep * offset


@kernel(internal=True)
def _find_steady_velocity(kind: Meshes, body: int, step: float) -> None:
    """End velocities without ringing, and the energy of what rings at the nodes."""
    v, middle, mean, steady = kind.velocity, kind.mid_velocity, kind.mean_velocity, kind.steady_velocity
    numbers = kind.body[body]
    part = step / (step + numbers.last_step)
    first, last = node_span(kind, body)
    for i in range(first, last):
        steady[i] = steady_rate(middle[i], part * (middle[i] - mean[i]), v[i])
        mean[i] = middle[i]
    numbers.last_step = step
    ringing = motion = 0.0
    for node in range(first, last, len(kind.shape[1])):
        mass = 0.5 * kind.nodal_mass[node]
        for k in range(node, node + 3):
            ringing += mass * (v[k] - steady[k]) ** 2
            motion += mass * steady[k] ** 2
    numbers.ringing += MEMORY * (ringing - numbers.ringing)
    numbers.motion += MEMORY * (motion - numbers.motion)
    numbers.largest_ringing = max(numbers.largest_ringing, numbers.ringing)
    numbers.largest_motion = max(numbers.largest_motion, numbers.motion)


@implement(advance, Meshes)
@kernel(internal=True)
def advance_meshes(kind: Meshes, time: float, step: float, work: Workspace) -> None:
    """``q += h vb``, ``v := 2 vb - v``, strains."""
    q, v, middle = kind.position, kind.velocity, kind.mid_velocity
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        iterated, scheme = is_iterated(kind, body), kind.table[body].scheme
        release_points(kind.moving, kind, body)
        add_mesh_work(kind, body, step, iterated)
        if not iterated and scheme != EXPLICIT:
            # not those of the drift: joints to bodies that iterate have changed the velocities since
            add_strain_rates(kind, body, kind.mid_position, middle, kind.strain, step)
        for i in range(first, last):
            q[i] += step * middle[i]
            v[i] = 2.0 * middle[i] - v[i]
        _find_steady_velocity(kind, body, step)
        if scheme == EXPLICIT:
            find_strains(kind, body, kind.position, kind.strain)
        elif iterated:
            _advance_shape_strains(kind, body)
