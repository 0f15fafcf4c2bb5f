"""Steps of cables of lumped masses: energy and momentum, Newton's method with a block tridiagonal matrix."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.vectors import Vector
from heavylift.solver.bodies.lumped_cable.kind import CableData, LumpedCables
from heavylift.solver.interface import (
    FORCES,
    ROWS,
    Bodies,
    Joints,
    Systems,
    Workspace,
    advance,
    apply_inverse,
    check,
    end_velocity,
    estimate_error,
    factor,
    fill_markers,
    finish,
    forget_accelerations,
    iterate,
    predict,
    refactor_rows,
    row_arrays,
    set_velocity,
    solve_again,
    start,
    write_velocity,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows.structure import FACTORED, RowArrays

__all__ = ["elongation_force", "gather_loads"]

CONVERGED, NEARLY = 1e-14, 1e-9
"""Displacement in the last round, relative to the length of a cable: small enough, or if rounding allows no less."""

SLOW, STALLED = 0.1, 0.3
"""Ratio of two changes above which the matrix is made again, and above which rounding is the limit."""

MOST_ROUNDS = 60
NOT_CONVERGED, NOT_FINITE = int(Outcome.NOT_CONVERGED), int(Outcome.NOT_FINITE)


# ---- a segment in a step ----


@kernel(inline=True, internal=True)
def elongation_force(cable: CableData, length: float) -> float:
    """``W'(l)`` [N]."""
    stretch = length - cable.rest_length
    return cable.stiffness * stretch if cable.pushes or stretch > 0.0 else 0.0


@kernel(internal=True)
def _mean_tension(cable: CableData, l0: float, l1: float, step: float) -> tuple[float, float, float]:
    """Tension T in a step from one length to another one, its derivative by the second one, its damping part.

    Notes
    -----
    With ``a, b`` the elongations, not below 0 if it does not push, ``T = k/2 (a + b) (b - a)/(l1 - l0)``: the last
    factor is the share of the step in which a segment carries.
    """
    k, L = cable.stiffness, cable.rest_length
    a, b = l0 - L, l1 - L
    share, slope = 1.0, 0.5 * k
    if not cable.pushes:
        if a <= 0.0 and b <= 0.0:
            return 0.0, 0.0, 0.0
        if a <= 0.0 or b <= 0.0:
            a, b = max(a, 0.0), max(b, 0.0)
            share = (b - a) / (l1 - l0)
            slope = (k * b - 0.5 * k * (a + b) * share) / (l1 - l0)
    damping = share * cable.damping * (l1 - l0) / step
    return 0.5 * k * (a + b) * share + damping, slope + share * cable.damping / step, damping


@kernel(inline=True, internal=True)
def _chord(kind: LumpedCables, node: int) -> Vector:
    """From a node to the next one, at the start of the step."""
    q = kind.position
    return q[node + 1, 0] - q[node, 0], q[node + 1, 1] - q[node, 1], q[node + 1, 2] - q[node, 2]


@kernel(inline=True, internal=True)
def _moved(r: Vector, work: Workspace, dof: int, step: float) -> Vector:
    """A chord at the end of the step, by the velocities of the stage."""
    v = work.velocity
    return (
        r[0] + step * (v[dof + 3] - v[dof]),
        r[1] + step * (v[dof + 4] - v[dof + 1]),
        r[2] + step * (v[dof + 5] - v[dof + 2]),
    )


@kernel(inline=True, internal=True)
def _size(r: Vector) -> float:
    return math.sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2])


# ---- loads ----


@kernel(internal=True)
def gather_loads(kind: LumpedCables, work: Workspace) -> None:
    """Forces on markers, without weight, into `load`."""
    for node in range(kind.load.shape[0]):
        for k in range(3):
            kind.load[node, k] = 0.0
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level != FORCES:
            continue
        number, data = kind.markers[marker].number, kind.markers[marker].data
        node, share = int(kind.constants[data]), kind.constants[data + 1]
        force = work.markers[number].force
        for k in range(3):
            kind.load[node, k] += (1.0 - share) * force[k]
            kind.load[node + 1, k] += share * force[k]


# ---- the balance of momentum, its matrix and factor ----


@kernel(internal=True)
def _write_residual(kind: LumpedCables, body: int, step: float, work: Workspace) -> None:
    """``M (v - vb) + h/2 (f + m g + sum T m)`` into `right`."""
    cable = kind.table[body]
    first, count = cable.first_node, cable.node_count
    for i in range(count):
        node, dof = first + i, cable.dof + 3 * i
        m = kind.mass[node]
        for k in range(3):
            change = m * (kind.velocity[node, k] - work.velocity[dof + k])
            kind.right[node, k] = change + 0.5 * step * (kind.load[node, k] + m * work.sums.gravity[k])
    for i in range(count - 1):
        node = first + i
        r0 = _chord(kind, node)
        r1 = _moved(r0, work, cable.dof + 3 * i, step)
        l0, l1 = _size(r0), _size(r1)
        T = _mean_tension(cable, l0, l1, step)[0]
        for k in range(3):
            pull = 0.5 * step * T * (r0[k] + r1[k]) / (l0 + l1)
            kind.right[node, k] += pull
            kind.right[node + 1, k] -= pull


@kernel(internal=True)
def _add_impulses(kind: LumpedCables, systems: Systems, body: int) -> None:
    """``right += G^T P`` of all rows."""
    cable = kind.table[body]
    for i in range(row_arrays(systems)):
        _add_impulses_of(kind, row_arrays(systems, i), cable)


@kernel(internal=True)
def _add_impulses_of(kind: LumpedCables, system: RowArrays, cable: CableData) -> None:
    lanes = system.lanes
    for i in range(system.attachments.shape[0]):
        if system.attachments[i].holder != FACTORED or system.attachments[i].dof != cable.dof:
            continue
        panel, impulse = system.attachments[i].panel, system.rows[system.attachments[i].owner].impulse
        for node in range(cable.node_count):
            for k in range(3):
                total = 0.0
                for r in range(lanes):
                    total += system.panels[panel + (3 * node + k) * lanes + r] * impulse[r]
                kind.right[cable.first_node + node, k] += total


@kernel(internal=True)
def _factor(kind: LumpedCables, body: int, step: float, work: Workspace) -> None:
    """Blocks of ``M + h^2/2 K``, K by the chords at the end of the step, and their factor, from the first node on."""
    cable = kind.table[body]
    first, count = cable.first_node, cable.node_count
    for i in range(count):
        for j in range(9):
            kind.diagonal[first + i, j] = kind.mass[first + i] if j % 4 == 0 else 0.0
            kind.coupling[first + i, j] = 0.0
    for i in range(count - 1):
        node = first + i
        r0 = _chord(kind, node)
        r1 = _moved(r0, work, cable.dof + 3 * i, step)
        l0, l1 = _size(r0), _size(r1)
        T, slope, _ = _mean_tension(cable, l0, l1, step)
        across = max(T, 0.0) / (l0 + l1)
        for k in range(3):
            mk = (r0[k] + r1[k]) / (l0 + l1)
            for c in range(3):
                mc = (r0[c] + r1[c]) / (l0 + l1)
                part = 0.5 * step * step * ((slope - across) * mk * mc + (across if k == c else 0.0))
                kind.diagonal[node, 3 * k + c] += part
                kind.diagonal[node + 1, 3 * k + c] += part
                kind.coupling[node, 3 * k + c] = -part
    for i in range(count):
        node = first + i
        if i > 0:
            _eliminate(kind, node)
        _invert(kind, node)


@kernel(internal=True)
def _eliminate(kind: LumpedCables, node: int) -> None:
    """``D -= E^T D^-1 E`` with the block before."""
    D, E = kind.diagonal[node - 1], kind.coupling[node - 1]
    for c in range(3):
        x = D[0] * E[c] + D[1] * E[3 + c] + D[2] * E[6 + c]
        y = D[3] * E[c] + D[4] * E[3 + c] + D[5] * E[6 + c]
        z = D[6] * E[c] + D[7] * E[3 + c] + D[8] * E[6 + c]
        for k in range(3):
            kind.diagonal[node, 3 * k + c] -= E[k] * x + E[3 + k] * y + E[6 + k] * z


@kernel(internal=True)
def _invert(kind: LumpedCables, node: int) -> None:
    """A symmetric block becomes its inverse, by its adjugate."""
    D = kind.diagonal[node]
    a, b, c, d, e, f = D[0], D[1], D[2], D[4], D[5], D[8]
    A, B, C = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * A + b * B + c * C
    E, F, G = a * f - c * c, b * c - a * e, a * d - b * b
    D[0], D[4], D[8] = A / det, E / det, G / det
    D[1] = D[3] = B / det
    D[2] = D[6] = C / det
    D[5] = D[7] = F / det


@kernel(internal=True)
def _solve(kind: LumpedCables, body: int) -> None:
    """`right` becomes the solution."""
    first, count = kind.table[body].first_node, kind.table[body].node_count
    for i in range(1, count):
        node = first + i
        D, E, b = kind.diagonal[node - 1], kind.coupling[node - 1], kind.right[node - 1]
        x = D[0] * b[0] + D[1] * b[1] + D[2] * b[2]
        y = D[3] * b[0] + D[4] * b[1] + D[5] * b[2]
        z = D[6] * b[0] + D[7] * b[1] + D[8] * b[2]
        for k in range(3):
            kind.right[node, k] -= E[k] * x + E[3 + k] * y + E[6 + k] * z
    for i in range(count - 1, -1, -1):
        node = first + i
        D, b = kind.diagonal[node], kind.right[node]
        b0, b1, b2 = b[0], b[1], b[2]
        if i < count - 1:
            E, after = kind.coupling[node], kind.right[node + 1]
            b0 -= E[0] * after[0] + E[1] * after[1] + E[2] * after[2]
            b1 -= E[3] * after[0] + E[4] * after[1] + E[5] * after[2]
            b2 -= E[6] * after[0] + E[7] * after[1] + E[8] * after[2]
        b[0] = D[0] * b0 + D[1] * b1 + D[2] * b2
        b[1] = D[3] * b0 + D[4] * b1 + D[5] * b2
        b[2] = D[6] * b0 + D[7] * b1 + D[8] * b2


@kernel(internal=True)
def _take_change(kind: LumpedCables, body: int, work: Workspace) -> float:
    """Add the solution to the velocities of the stage; the root of the sum of its squares."""
    cable = kind.table[body]
    total = 0.0
    for i in range(cable.node_count):
        for k in range(3):
            found = kind.right[cable.first_node + i, k]
            work.velocity[cable.dof + 3 * i + k] += found
            total += found * found
    return math.sqrt(total)


# ---- operations of a step ----


@implement(start, LumpedCables)
@kernel(internal=True)
def start_cables(kind: LumpedCables, time: float, work: Workspace) -> None:
    """Jacobians of the markers, which never change."""
    for marker in range(kind.markers.shape[0]):
        body, data = kind.markers[marker].body, kind.markers[marker].data
        node, share = int(kind.constants[data]) - kind.table[body].first_node, kind.constants[data + 1]
        for k in range(3):
            work.jacobian[kind.markers[marker].number, k, 3 * node + k] = 1.0 - share
            work.jacobian[kind.markers[marker].number, k, 3 * node + 3 + k] = share


@implement(predict, LumpedCables)
@kernel(internal=True)
def predict_cables(kind: LumpedCables, time: float, step: float) -> None:
    """Midpoint along straight lines: velocities that ring mislead nothing else, since the step is iterated."""
    for node in range(kind.position.shape[0]):
        for k in range(3):
            kind.mid_position[node, k] = kind.position[node, k] + 0.5 * step * kind.velocity[node, k]


@implement(fill_markers, LumpedCables)
@kernel(internal=True)
def fill_cable_markers(kind: LumpedCables, at_midpoint: bool, level: int, work: Workspace) -> None:
    """Points between two nodes, and their rates."""
    q = kind.mid_position if at_midpoint else kind.position
    for marker in range(kind.markers.shape[0]):
        serves = kind.markers[marker].level
        if serves > level:
            break  # they are in this order
        number, data = kind.markers[marker].number, kind.markers[marker].data
        node, share = int(kind.constants[data]), kind.constants[data + 1]
        out, v = work.markers[number], kind.velocity
        for k in range(3):
            out.point[k] = (1.0 - share) * q[node, k] + share * q[node + 1, k]
        if serves == ROWS:
            continue
        for k in range(3):
            out.velocity[k] = (1.0 - share) * v[node, k] + share * v[node + 1, k]


@implement(factor, LumpedCables)
@kernel(internal=True)
def factor_cables(kind: LumpedCables, step: float, work: Workspace) -> None:
    """The first round of Newton's method, from the velocities at the start of the step."""
    gather_loads(kind, work)
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        for i in range(cable.node_count):
            for k in range(3):
                work.velocity[cable.dof + 3 * i + k] = kind.velocity[cable.first_node + i, k]
        _factor(kind, body, step, work)
        _write_residual(kind, body, step, work)
        _solve(kind, body)
        _take_change(kind, body, work)
        cable.change, cable.change_before, cable.rounds = -1.0, 1e300, 0


@kernel(internal=True)
def _keep(kind: LumpedCables, work: Workspace, step: float) -> None:
    """Velocities of the stage, and the midpoint that follows from them."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        for i in range(cable.node_count):
            node = cable.first_node + i
            for k in range(3):
                kind.kept[node, k] = work.velocity[cable.dof + 3 * i + k]
                kind.mid_position[node, k] = kind.position[node, k] + 0.5 * step * kind.kept[node, k]


@kernel(internal=True)
def _put_back(kind: LumpedCables, work: Workspace) -> None:
    """Velocities of the stage as they were kept."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        for i in range(cable.node_count):
            for k in range(3):
                work.velocity[cable.dof + 3 * i + k] = kind.kept[cable.first_node + i, k]


@implement(iterate, LumpedCables)
@kernel(internal=True)
def iterate_cables(
    kind: LumpedCables,
    bodies: Bodies,
    systems: Systems,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """A round of Newton's method for all cables with their joints."""
    slow, done = False, True
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        slow = slow or (cable.rounds > 0 and cable.change > SLOW * cable.change_before)
    _keep(kind, work, step)
    if slow:
        for body in range(kind.table.shape[0]):
            _factor(kind, body, step, work)
        refactor_rows(systems, bodies, joints, work)
        _put_back(kind, work)  # impulses act in the residual
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        _write_residual(kind, body, step, work)
        _add_impulses(kind, systems, body)
        _solve(kind, body)
        cable.change_before = cable.change if cable.rounds > 0 else 1e300
        cable.change = step * _take_change(kind, body, work)
        cable.rounds += 1
        stalled = cable.change > STALLED * cable.change_before
        if cable.change <= CONVERGED * cable.size or (stalled and cable.change <= NEARLY * cable.size):
            continue
        done = False
        if cable.rounds > MOST_ROUNDS or not math.isfinite(cable.change):
            work.status.outcome = NOT_CONVERGED
            work.status.body = cable.number
    solve_again(systems, systems, joints, work, time, step)
    if not done:
        work.control.changed += 1


@implement(check, LumpedCables)
@kernel(internal=True)
def check_cables(kind: LumpedCables, step: float, work: Workspace) -> None:
    """Refuse what is not finite."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        total = 0.0
        for i in range(cable.dof, cable.dof + 3 * cable.node_count):
            total += abs(work.velocity[i])
        if not math.isfinite(total):
            work.status.outcome = NOT_FINITE
            work.status.body = cable.number


@implement(estimate_error, LumpedCables)
@kernel(internal=True)
def estimate_cable_error(kind: LumpedCables, step: float, work: Workspace) -> None:
    """Largest distance of a velocity of the stage from its prediction, as a displacement [m] over the step."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        largest = 0.0
        for i in range(cable.node_count):
            total = 0.0
            for k in range(3):
                node = cable.first_node + i
                ahead = kind.velocity[node, k] + 0.5 * step * kind.acceleration[node, k]
                total += (work.velocity[cable.dof + 3 * i + k] - ahead) ** 2
            largest = max(largest, total)
        error = step * math.sqrt(largest)
        if not error <= work.control.error:
            work.control.error = error
            work.status.body = cable.number


@implement(advance, LumpedCables)
@kernel(internal=True)
def advance_cables(kind: LumpedCables, time: float, step: float, work: Workspace) -> None:
    """``q += h vb``, ``v := 2 vb - v``; work of the loads, losses of the dampers."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        first = cable.first_node
        lost = external = 0.0
        for i in range(cable.node_count - 1):
            r0 = _chord(kind, first + i)
            l0, l1 = _size(r0), _size(_moved(r0, work, cable.dof + 3 * i, step))
            lost += _mean_tension(cable, l0, l1, step)[2] * (l1 - l0)
        for i in range(cable.node_count):
            node = first + i
            for k in range(3):
                middle = work.velocity[cable.dof + 3 * i + k]
                external += kind.load[node, k] * middle
                kind.position[node, k] += step * middle
                kind.acceleration[node, k] = 2.0 * (middle - kind.velocity[node, k]) / step
                kind.velocity[node, k] = 2.0 * middle - kind.velocity[node, k]
        cable.external_work += step * external
        cable.dissipated_work += lost


@implement(finish, LumpedCables)
@kernel(internal=True)
def finish_cables(kind: LumpedCables, step: float, work: Workspace) -> None:
    """Nothing is left to do."""


@implement(forget_accelerations, LumpedCables)
@kernel(internal=True)
def forget_cable_accelerations(kind: LumpedCables) -> None:
    """Of the nodes."""
    for node in range(kind.acceleration.shape[0]):
        for k in range(3):
            kind.acceleration[node, k] = 0.0


# ---- rows ----


@implement(apply_inverse, LumpedCables)
@kernel(internal=True)
def apply_inverse_of_cables(kind: LumpedCables, at_midpoint: bool, system: RowArrays) -> None:
    """Row by row with the factor of the stage; at the end of the step with the masses."""
    half, lanes = system.panels.shape[0] // 2, system.lanes
    for i in range(system.attachments.shape[0]):
        if system.attachments[i].holder != FACTORED:
            continue
        for body in range(kind.table.shape[0]):
            cable = kind.table[body]
            if cable.dof != system.attachments[i].dof:
                continue
            panel = system.attachments[i].panel
            for r in range(lanes):
                for node in range(cable.node_count):
                    for k in range(3):
                        kind.right[cable.first_node + node, k] = system.panels[
                            panel + (3 * node + k) * lanes + r
                        ]
                if at_midpoint:
                    _solve(kind, body)
                else:
                    for node in range(cable.first_node, cable.first_node + cable.node_count):
                        for k in range(3):
                            kind.right[node, k] /= kind.mass[node]
                for node in range(cable.node_count):
                    for k in range(3):
                        at = half + panel + (3 * node + k) * lanes + r
                        system.panels[at] = kind.right[cable.first_node + node, k]


@implement(write_velocity, LumpedCables)
@kernel(internal=True)
def write_cable_velocity(kind: LumpedCables, work: Workspace) -> None:
    """Of the nodes."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        for i in range(cable.node_count):
            for k in range(3):
                work.velocity[cable.dof + 3 * i + k] = kind.velocity[cable.first_node + i, k]


@implement(end_velocity, LumpedCables)
@kernel(internal=True)
def end_velocity_of_cables(kind: LumpedCables, step: float, work: Workspace) -> None:
    """Those that `advance` has found."""
    write_cable_velocity(kind, work)


@implement(set_velocity, LumpedCables)
@kernel(internal=True)
def set_velocity_of_cables(kind: LumpedCables, step: float, work: Workspace) -> None:
    """Projected velocities."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        for i in range(cable.node_count):
            node = cable.first_node + i
            for k in range(3):
                projected = work.velocity[cable.dof + 3 * i + k]
                kind.acceleration[node, k] += (projected - kind.velocity[node, k]) / step
                kind.velocity[node, k] = projected
