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

The explicit scheme, the leapfrog, is stable while the step is below ``2/w``, w the highest circular frequency of the
tangent stiffness on the mass; with the share ``z`` of critical damping, whose force comes a stage late, below
``2/w (sqrt(1 + z^2) - z)``. The frequency comes from a power iteration ``x := M^-1 K x``, with ``K x`` as a
difference of internal forces. It approaches from below, and stiffness changes as a body moves: so `SHARE` of the limit
is allowed. The vector is kept, so that a few rounds now and then follow the motion.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.vectors import Vector, add, add_scaled, cross, dot, scaled, vector_at
from heavylift.solver.bodies.ancf.assembly import (
    add_matrix_products,
    clear_fixed,
    factor_set,
    start_step_matrix,
)
from heavylift.solver.bodies.ancf.elements import (
    add_elastic_forces,
    add_follower_load,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
    measure_drift,
    measure_strain_energy,
)
from heavylift.solver.bodies.ancf.frame_data import frame_follower
from heavylift.solver.bodies.ancf.kind import (
    DEAD_LOAD,
    ENERGY_MOMENTUM,
    EXPLICIT,
    FOLLOWER_ELEMENT,
    MASS_SET,
    POINT_MARKER,
    STEP_SET,
    TANGENT_MARKER,
    VECTOR_MARKER,
    Meshes,
    MeshNumbers,
)
from heavylift.solver.bodies.ancf.moving import release_points, write_free_points, write_points
from heavylift.solver.bodies.ancf.substitution import copy_strains, node_span, scatter_back, solve_forward
from heavylift.solver.interface import (
    FORCES,
    Workspace,
    advance,
    check,
    estimate_error,
    factor,
    fill_markers,
    finish,
    predict,
    start,
)
from heavylift.solver.kinds import implement
from heavylift.solver.ringing import alternating, steady_rate

__all__ = [
    "FIRST_ROUNDS",
    "SHARE",
    "add_gravity",
    "add_mesh_work",
    "base_value",
    "blame_element",
    "blame_largest",
    "find_drift",
    "find_step_limit",
    "follow_step_limit",
    "forget_mean_velocity",
    "gather_loads",
    "highest_frequency",
    "is_iterated",
    "solve_free",
    "start_power_iteration",
    "write_bases",
    "write_free_bases",
]


# ---- loads of a stage ----


@kernel(internal=True)
def _factor(kind: Meshes, load: int, time: float) -> float:
    """Factor of a load at a time, linear between the rows of its table."""
    table, count = kind.loads[load].table, kind.loads[load].table_length
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if kind.constants[table + middle] <= time:
            low = middle
        else:
            high = middle
    span = kind.constants[table + high] - kind.constants[table + low]
    part = min(max((time - kind.constants[table + low]) / span, 0.0), 1.0) if span > 0.0 else 0.0
    before, after = kind.constants[table + count + low], kind.constants[table + count + high]
    return before + part * (after - before)


@kernel(internal=True)
def _add_node_follower(kind: Meshes, q: Floats1, place: int, data: int, factor: float) -> None:
    """Force on a node of a frame, along its tangent and square to that and an axis."""
    slope = vector_at(q, place + 3)
    t = scaled(1.0 / math.sqrt(dot(slope, slope)), slope)
    given = frame_follower(kind.constants, data)
    normal, along = factor * given.normal, factor * given.tangential
    f = add_scaled(scaled(normal, cross(given.axis, t)), along, t)
    for k in range(3):
        kind.external_force[place + k] += f[k]


@kernel(internal=True)
def _add_marker_forces(kind: Meshes, work: Workspace) -> None:
    """Forces on markers to the bases: ``J^T f``, then from these to the nodes."""
    load = kind.external_force
    vectors = len(kind.shape[0]) // 3
    nodes = len(kind.ends)
    for base in range(kind.bases.shape[0]):
        place = kind.bases[base].place
        for k in range(3):
            load[place + k] = 0.0
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level != FORCES:
            continue
        number, body = kind.markers[marker].number, kind.markers[marker].body
        force, J = work.markers[number].force, work.jacobian[number]
        first = kind.table[body].first_base
        for i in range(kind.table[body].base_count):
            place = kind.bases[first + i].place
            for c in range(3):
                column = 3 * i + c
                load[place + c] += dot((J[0, column], J[1, column], J[2, column]), force)
    for base in range(kind.bases.shape[0]):
        element, shape = kind.bases[base].element, kind.bases[base].shape_values
        place = kind.bases[base].place
        f = vector_at(load, place)
        if f[0] == 0.0 and f[1] == 0.0 and f[2] == 0.0:
            continue
        for i in range(nodes):
            for a in range(vectors):
                at = kind.elements[element].nodes[i] + 3 * a
                value = kind.constants[shape + i * vectors + a]
                for k in range(3):
                    load[at + k] += value * f[k]
    for base in range(kind.bases.shape[0]):
        place = kind.bases[base].place
        for k in range(3):
            load[place + k] = 0.0


@kernel(internal=True)
def gather_loads(kind: Meshes, q: Floats1, work: Workspace) -> None:
    """External forces into `external_force`, at the time of the stage and some coordinates; without gravity."""
    lanes = len(kind.shape[1])
    load = kind.external_force
    for i in range(load.shape[0]):
        load[i] = 0.0
    for body in range(kind.table.shape[0]):
        first = kind.table[body].first_load
        table, factor = -1, 0.0
        for i in range(first, first + kind.table[body].load_count):
            data, place = kind.loads[i].data, kind.loads[i].place
            if kind.loads[i].table != table:
                table, factor = kind.loads[i].table, _factor(kind, i, kind.body[body].time)
            if kind.loads[i].type == DEAD_LOAD:
                begin = kind.table[body].first_node * lanes
                for j in range(kind.table[body].node_count * lanes):
                    load[begin + j] += factor * kind.constants[data + j]
            elif kind.loads[i].type == FOLLOWER_ELEMENT:
                add_follower_load(kind, body, q, place, load, data, factor)
            else:
                _add_node_follower(kind, q, place, data, factor)
    if kind.markers.shape[0] > 0:
        _add_marker_forces(kind, work)


# ---- what has failed ----


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
    nodes = len(kind.ends)
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


# ---- bases and markers ----


@kernel(internal=True)
def base_value(kind: Meshes, base: int, nodal: Floats1) -> Vector:
    """Value of a nodal vector at a base, body axes."""
    vectors = len(kind.shape[0]) // 3
    nodes = len(kind.ends)
    element, shape = kind.bases[base].element, kind.bases[base].shape_values
    x = y = z = 0.0
    for i in range(nodes):
        for a in range(vectors):
            at, value = kind.elements[element].nodes[i] + 3 * a, kind.constants[shape + i * vectors + a]
            x += value * nodal[at]
            y += value * nodal[at + 1]
            z += value * nodal[at + 2]
    return x, y, z


@kernel(internal=True)
def write_bases(kind: Meshes, nodal: Floats1, to: NDArray[np.float64]) -> None:
    """Values of a nodal vector at all bases and moving points into a vector of velocities of the scene."""
    for body in range(kind.table.shape[0]):
        dof, first = kind.table[body].dof, kind.table[body].first_base
        for i in range(kind.table[body].base_count):
            y = base_value(kind, first + i, nodal)
            to[dof + 3 * i], to[dof + 3 * i + 1], to[dof + 3 * i + 2] = y[0], y[1], y[2]
        write_points(kind.moving, kind, body, nodal, to)


@kernel(inline=True, internal=True)
def _to_world(numbers: MeshNumbers, a: Vector) -> Vector:
    R = numbers.rotation
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )


@kernel(internal=True)
def _put(out: NDArray[np.float64], value: Vector) -> None:
    out[0], out[1], out[2] = value[0], value[1], value[2]


@kernel(internal=True)
def _put_columns(J: NDArray[np.float64], column: int, R: NDArray[np.float64], M: NDArray[np.float64]) -> None:
    """``J[:, column ... column + 2] = R M``."""
    for k in range(3):
        for c in range(3):
            total = 0.0
            for l in range(3):
                total += R[k, l] * M[l, c]
            J[k, column + c] = total


@kernel(internal=True)
def _write_tangent(kind: Meshes, marker: int, work: Workspace) -> None:
    """Unit tangent ``s t/|t|``; its derivative by t is ``s (1 - u u^T) / |t|``."""
    body, base = kind.markers[marker].body, kind.markers[marker].base
    sense = kind.constants[kind.markers[marker].data]
    numbers, number = kind.body[body], kind.markers[marker].number
    t, rate = base_value(kind, base, kind.mid_position), base_value(kind, base, kind.mid_velocity)
    size = 1.0 / math.sqrt(dot(t, t))
    u = scaled(size, t)
    scale = sense * size
    _put(work.markers[number].point, _to_world(numbers, scaled(sense, u)))
    turned = scaled(scale, add_scaled(rate, -dot(u, rate), u))
    _put(work.markers[number].velocity, _to_world(numbers, turned))
    M = numbers.scratch
    for k in range(3):
        for c in range(3):
            M[k, c] = scale * ((1.0 if k == c else 0.0) - u[k] * u[c])
    _put_columns(work.jacobian[number], 3 * (base - kind.table[body].first_base), numbers.rotation, M)


@kernel(internal=True)
def _write_triad(kind: Meshes, marker: int, work: Workspace) -> None:
    """A direction ``d1 e1 + d2 e2 + d3 e3`` fixed in the triad of the slopes a and b.

    Notes
    -----
    ``e1 = a/|a|``, ``e3 = a x b/|a x b|``, ``e2 = e3 x e1``. The triad turns with ``w``: ``w.e3 = e2.a'/|a|``,
    ``w.e2 = -e3.a'/|a|``, ``w.e1 = (e3.b' - (b.e1) e3.a'/|a|)/(b.e2)``; so each component of ``w`` is linear in the
    rates of the slopes and the direction changes by ``w x d``.
    """
    body, base = kind.markers[marker].body, kind.markers[marker].base
    numbers, number = kind.body[body], kind.markers[marker].number
    data = kind.markers[marker].data
    d1, d2, d3 = vector_at(kind.constants, data)
    a, b = base_value(kind, base, kind.mid_position), base_value(kind, base + 1, kind.mid_position)
    ra, rb = base_value(kind, base, kind.mid_velocity), base_value(kind, base + 1, kind.mid_velocity)
    size = 1.0 / math.sqrt(dot(a, a))
    e1 = scaled(size, a)
    normal = cross(a, b)
    e3 = scaled(1.0 / math.sqrt(dot(normal, normal)), normal)
    e2 = cross(e3, e1)
    b1, b2 = dot(b, e1), 1.0 / dot(b, e2)
    direction = add_scaled(add_scaled(scaled(d1, e1), d2, e2), d3, e3)
    # w x d = (w.e1) (d2 e3 - d3 e2) + (w.e2) (d3 e1 - d1 e3) + (w.e3) (d1 e2 - d2 e1)
    M = numbers.scratch
    column = 3 * (base - kind.table[body].first_base)
    t1 = t2 = t3 = 0.0
    for which in range(2):
        for k in range(3):
            f1, f2, f3 = d2 * e3[k] - d3 * e2[k], d3 * e1[k] - d1 * e3[k], d1 * e2[k] - d2 * e1[k]
            for c in range(3):
                of_a = size * (-b1 * b2 * f1 * e3[c] - f2 * e3[c] + f3 * e2[c])
                M[k, c] = of_a if which == 0 else b2 * f1 * e3[c]
        rate = ra if which == 0 else rb
        t1 += M[0, 0] * rate[0] + M[0, 1] * rate[1] + M[0, 2] * rate[2]
        t2 += M[1, 0] * rate[0] + M[1, 1] * rate[1] + M[1, 2] * rate[2]
        t3 += M[2, 0] * rate[0] + M[2, 1] * rate[1] + M[2, 2] * rate[2]
        _put_columns(work.jacobian[number], column + 3 * which, numbers.rotation, M)
    _put(work.markers[number].point, _to_world(numbers, direction))
    _put(work.markers[number].velocity, _to_world(numbers, (t1, t2, t3)))


@kernel(internal=True)
def _write_markers(kind: Meshes, level: int, work: Workspace) -> None:
    """All markers that a level needs, at `mid_position` and `mid_velocity`."""
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level > level:
            continue
        which = kind.markers[marker].type
        if which in (POINT_MARKER, VECTOR_MARKER):
            body, base = kind.markers[marker].body, kind.markers[marker].base
            number, numbers = kind.markers[marker].number, kind.body[body]
            p = _to_world(numbers, base_value(kind, base, kind.mid_position))
            if which == POINT_MARKER:
                p = add(p, numbers.origin)
            _put(work.markers[number].point, p)
            _put(work.markers[number].velocity, _to_world(numbers, base_value(kind, base, kind.mid_velocity)))
            column = 3 * (base - kind.table[body].first_base)
            for k in range(3):
                for c in range(3):
                    work.jacobian[number, k, column + c] = numbers.rotation[k, c]
        elif which == TANGENT_MARKER:
            _write_tangent(kind, marker, work)
        else:
            _write_triad(kind, marker, work)


@implement(fill_markers, Meshes)
@kernel(internal=True)
def fill_mesh_markers(kind: Meshes, at_midpoint: bool, level: int, work: Workspace) -> None:
    """Markers from the bases; rows of other bases in the Jacobians stay zero."""
    if not at_midpoint:
        for i in range(kind.position.shape[0]):
            kind.mid_position[i] = kind.position[i]
            kind.mid_velocity[i] = kind.velocity[i]
    _write_markers(kind, level, work)


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


# ---- the stable step of the explicit scheme ----


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


# ---- the step ----
@kernel(internal=True)
def forget_mean_velocity(kind: Meshes, body: int) -> None:
    """After a jump of the velocities, and before the first step: nothing of them rings."""
    first, last = node_span(kind, body)
    kind.body[body].last_step = 0.0
    for i in range(first, last):
        kind.mean_velocity[i] = kind.velocity[i]
        kind.deviation[i] = kind.ringing[i] = 0.0


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


@kernel(inline=True, internal=True)
def _ringing_share(kind: Meshes, body: int) -> float:
    """Of the ringing, that midpoints are predicted without: all of it, or nothing while it hardly matters.

    Along end velocities as they are, errors of carried strains are differences of kinetic energies: they do not add
    up. The leapfrog of the explicit scheme goes on with its own velocities: it does not ring below its limit.
    """
    numbers = kind.body[body]
    matters = numbers.ringing > LEAST_RINGING * numbers.motion and kind.table[body].scheme != EXPLICIT
    return 1.0 if matters else 0.0


@implement(predict, Meshes)
@kernel(internal=True)
def predict_meshes(kind: Meshes, time: float, step: float) -> None:
    """Midpoint along straight lines, free of ringing; predicted midpoint velocity for rates of markers."""
    half = 0.5 * step
    q, v, ringing, mean = kind.position, kind.velocity, kind.ringing, kind.mean_velocity
    for body in range(kind.table.shape[0]):
        growth = _growth_to_middle(kind, body, step)
        # the leapfrog of the explicit scheme goes on with its own velocities: it does not ring below its limit
        without = _ringing_share(kind, body)
        first, last = node_span(kind, body)
        for i in range(first, last):
            ahead = v[i] - without * ringing[i]
            kind.mid_position[i] = q[i] + half * ahead
            kind.mid_velocity[i] = ahead + growth * (ahead - mean[i])
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
            # Newton's method asks for the tangent, and tense shells would need another matrix in every step
            shell = len(kind.shape[0]) > FRAME_ROWS
            geometric = half / delay if shell and is_iterated(kind, body) else 0.0
            add_stiffness(
                kind, body, kind.mid_position, kind.stage_strain, right, -half, half * delay, geometric
            )
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
    v, ringing, mean, found = kind.velocity, kind.ringing, kind.mean_velocity, kind.mid_velocity
    for body in range(kind.table.shape[0]):
        growth, without = _growth_to_middle(kind, body, step), _ringing_share(kind, body)
        first, last = node_span(kind, body)
        largest = 0.0
        for node in range(first, last, lanes):
            total = 0.0
            for k in range(node, node + 3):
                ahead = v[k] - without * ringing[k]
                total += (found[k] - ahead - growth * (ahead - mean[k])) ** 2
            largest = max(largest, total)
        error = step * math.sqrt(largest)
        if not error <= work.control.error:
            work.control.error = error
            work.status.body = kind.table[body].number


# ---- the end of the step ----


FRAME_ROWS = 6
"""Rows of a node of a frame: two vectors."""

LEAST_RINGING = 0.005
"""Energy of what rings over that of the motion, from which midpoints are predicted without it."""

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
def _find_ringing(kind: Meshes, body: int, step: float) -> None:
    """What of the end velocities changes its sign with every step, and its energy at the nodes."""
    v, middle, mean = kind.velocity, kind.mid_velocity, kind.mean_velocity
    deviation, ringing = kind.deviation, kind.ringing
    numbers = kind.body[body]
    part = step / (step + numbers.last_step)
    first, last = node_span(kind, body)
    for i in range(first, last):
        found = v[i] - steady_rate(middle[i], part * (middle[i] - mean[i]), v[i])
        ringing[i] = alternating(found, deviation[i])
        deviation[i], mean[i] = found, middle[i]
    numbers.last_step = step
    rings = motion = 0.0
    for node in range(first, last, len(kind.shape[1])):
        mass = 0.5 * kind.nodal_mass[node]
        for k in range(node, node + 3):
            rings += mass * ringing[k] ** 2
            motion += mass * (v[k] - ringing[k]) ** 2
    numbers.ringing += MEMORY * (rings - numbers.ringing)
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
        _find_ringing(kind, body, step)
        if scheme == EXPLICIT:
            find_strains(kind, body, kind.position, kind.strain)
        elif iterated:
            _advance_shape_strains(kind, body)
