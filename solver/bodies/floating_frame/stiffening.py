"""Geometric stiffening of floating frames: corrections of the inertia integrals, and forces on the modes.

With ``E_kl``, ``G_k`` and the angular velocity w of `heavylift.modal.stiffening`: what bends is nearer to the axis, so
that the second moments of the deformed body are smaller by ``q^T E_kl q``. Those that the packed shapes have as
matrices ``S_kl`` are corrected there when the body is packed; the third diagonal one follows from unit modal mass, and
what this lacks is the trace ``E = E_11 + E_22 + E_33``::

    I_11, I_22  -=  q . E q,      Q_f  -=  (w_1^2 + w_2^2) E q

Momenta and energy of the frame are those of the corrected inertia: nothing is booked. The forces

    Q_f  -=  sum_k s_k G_k q

of accelerations of a frame that is held, minus gravity, act on the modes beside those of markers, so that
their work is part of the work from outside. All are evaluated at the middle of a step, as forces of springs by which a
mass leaps: a mode with stiffness k in the implicit rule and g beside it keeps areas, and is stable for h^2 g < 4. A
step that may be longer is halved, as one whose laws do not agree.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, rotate_back, scaled, subtract, vector, vector_at
from heavylift.solver.bodies.floating_frame.inertia import body_momenta
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies, shape_of
from heavylift.solver.drive import DRIVEN, FREE

__all__ = [
    "add_acceleration_forces",
    "add_load_forces",
    "add_quadratic_forces",
    "add_step_forces",
    "correct_inertia",
    "keep_unforced",
    "take_row_loads",
    "with_shortening",
]


@kernel(reassociate=True, internal=True)
def correct_inertia(kind: FloatingFrameBodies, body: int, q: NDArray[np.float64]) -> None:
    """What the trace does to the inertia that was just evaluated; ``E q`` stays for the quadratic forces."""
    start = kind.table[body].stiffening
    if start < 0:
        return
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    frame, shortened = kind.frame[body], kind.shortened[first : first + n]
    E = kind.constants[start : start + n * n]
    total = 0.0
    for i in range(n):
        product = 0.0
        for j in range(n):
            product += E[i * n + j] * q[j]
        shortened[i] = product
        total += product * q[i]
    frame.inertia[0] -= total
    frame.inertia[1] -= total


@kernel(internal=True)
def add_quadratic_forces(kind: FloatingFrameBodies, body: int, w: Vector) -> None:
    """Part of the trace in the centrifugal force, at the position of the last `correct_inertia`."""
    if kind.table[body].stiffening < 0:
        return
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    square = w[0] * w[0] + w[1] * w[1]
    for i in range(first, first + n):
        kind.quadratic_force[i] -= square * kind.shortened[i]


@kernel(internal=True)
def with_shortening(
    kind: FloatingFrameBodies, body: int, w: Vector, rates: NDArray[np.float64], moment: Vector
) -> Vector:
    """Moment of the velocity forces with the part of the trace, ``+ 2 (w_1, w_2, 0) q . E qd``."""
    if kind.table[body].stiffening < 0:
        return moment
    first = kind.table[body].first_mode
    total = 0.0
    for i in range(kind.table[body].mode_count):
        total += kind.shortened[first + i] * rates[i]
    return add_scaled(moment, 2.0 * total, (w[0], w[1], 0.0))


@kernel(inline=True, internal=True)
def _norms(kind: FloatingFrameBodies, body: int) -> int:
    """Place of the norms of the matrices of a body in the constants."""
    n = kind.table[body].mode_count
    return kind.table[body].stiffening + (7 + kind.table[body].load_count) * n * n


@kernel(internal=True)
def add_acceleration_forces(
    kind: FloatingFrameBodies, body: int, a: Vector, b: Vector, q: NDArray[np.float64]
) -> None:
    """Forces of the acceleration of the frame, minus gravity, and of its angular acceleration, body axes."""
    start = kind.table[body].stiffening
    if start < 0 or kind.table[body].motion == FREE:
        return
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    factors = (b[0], b[1], b[2], a[0], a[1], a[2])
    norms = _norms(kind, body)
    modal_load = kind.modal_load[first : first + n]
    for k in range(6):
        s = factors[k]
        if s == 0.0:
            continue
        kind.frame[body].stiffening_rate += abs(s) * kind.constants[norms + 1 + k]
        G = kind.constants[start + (1 + k) * n * n : start + (2 + k) * n * n]
        _add_softening(G, s, q, modal_load)


@kernel(reassociate=True, internal=True)
def _add_softening(
    G: NDArray[np.float64], s: float, q: NDArray[np.float64], modal_load: NDArray[np.float64]
) -> None:
    """``Q -= s G q`` of a matrix (n n,)."""
    n = q.shape[0]
    for i in range(n):
        product = 0.0
        for j in range(n):
            product += G[i * n + j] * q[j]
        modal_load[i] -= s * product


@kernel(internal=True)
def add_load_forces(kind: FloatingFrameBodies, body: int, q: NDArray[np.float64]) -> None:
    """Forces of the loads at places: those of markers that were just gathered, and those of joints before."""
    entry = kind.table[body]
    m = entry.load_count
    if m == 0:
        return
    n, first = entry.mode_count, entry.first_mode
    frame = kind.frame[body]
    force = rotate_back(frame.mid_rotation, vector(frame.force))
    modal_load = kind.modal_load[first : first + n]
    factors = kind.unforced[6 * body + first : 6 * body + first + 6 + n]
    # what acts must stay as it is while it is looked at
    for k in range(3):
        factors[k], factors[3 + k] = force[k], frame.moment[k]
    for i in range(n):
        factors[6 + i] = modal_load[i]
    for load in range(m):
        s = kind.row_loads[0, entry.first_load + load]
        s += _load_factor(kind, entry.load_start + load * (6 + n), factors)
        if s != 0.0:
            frame.stiffening_rate += abs(s) * kind.constants[_norms(kind, body) + 7 + load]
            at = entry.stiffening + (7 + load) * n * n
            _add_softening(kind.constants[at : at + n * n], s, q, modal_load)


@kernel(reassociate=True, internal=True)
def _load_factor(kind: FloatingFrameBodies, at: int, forces: NDArray[np.float64]) -> float:
    """One of the loads in some generalised forces, axes of the frame."""
    total = 0.0
    for k in range(forces.shape[0]):
        total += kind.constants[at + k] * forces[k]
    return total


@kernel(internal=True)
def keep_unforced(kind: FloatingFrameBodies, body: int, velocity: NDArray[np.float64], sign: float) -> None:
    """Keep a velocity of the stage, shape (6 + n,); with a sign add it to what is kept: the change of a second pass."""
    if kind.table[body].load_count == 0:
        return
    at = 6 * body + kind.table[body].first_mode
    for k in range(velocity.shape[0]):
        kept = 0.0 if sign == 0.0 else kind.unforced[at + k]
        kind.unforced[at + k] = kept + (velocity[k] if sign == 0.0 else sign * velocity[k])


@kernel(internal=True)
def take_row_loads(kind: FloatingFrameBodies, body: int, step: float, velocity: NDArray[np.float64]) -> None:
    """Loads at places from what joints have changed of the velocity of the stage, by the matrix of the step.

    Their mean over two steps is what stiffens: reactions of rigid joints may alternate from step to step.
    """
    entry = kind.table[body]
    if entry.load_count == 0:
        return
    n, first = entry.mode_count, entry.first_mode
    frame = kind.frame[body]
    change = kind.unforced[6 * body + first : 6 * body + first + 6 + n]
    for k in range(6 + n):
        change[k] = (velocity[k] - change[k]) * 2.0 / step
    coupling = kind.coupling[:, first : first + n]
    v, w = rotate_back(frame.mid_rotation, vector(change)), vector_at(change, 3)
    if entry.motion == FREE:
        p, l = body_momenta(shape_of(kind, body), frame, coupling, v, w, change[6:])
        for k in range(3):
            change[k], change[3 + k] = p[k], l[k]
        for i in range(n):
            change[6 + i] /= kind.inverse_diagonal[first + i]
            for k in range(3):
                change[6 + i] += kind.translation[k, first + i] * v[k] + coupling[k, i] * w[k]
    else:
        for i in range(n):
            change[6 + i] /= kind.inverse_diagonal[first + i]
    for load in range(entry.load_count):
        s = _load_factor(kind, entry.load_start + load * (6 + n), change)
        at = entry.first_load + load
        kind.row_loads[0, at] = 0.5 * (s + kind.row_loads[1, at])
        kind.row_loads[1, at] = s


@kernel(internal=True)
def add_step_forces(
    kind: FloatingFrameBodies, body: int, step: float, gravity: NDArray[np.float64], q: NDArray[np.float64]
) -> None:
    """Forces of loads at places, and of a step whose velocities at both ends are known, in the pose of the stage."""
    if kind.table[body].stiffening < 0:
        return
    frame = kind.frame[body]
    w = frame.mid_spin
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    frame.stiffening_rate = square * kind.constants[_norms(kind, body)]
    add_load_forces(kind, body, q)
    if kind.table[body].motion == FREE:
        return
    a, b = scaled(-1.0, vector(gravity)), (0.0, 0.0, 0.0)
    if kind.table[body].motion == DRIVEN:
        rates = frame.drive_rates
        a = subtract(scaled(1.0 / step, subtract(vector(rates), vector(frame.velocity))), vector(gravity))
        b = scaled(1.0 / step, subtract(vector_at(rates, 3), vector(frame.spin)))
    add_acceleration_forces(kind, body, rotate_back(frame.mid_rotation, a), b, q)
