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
mass leaps: a mode with stiffness k in the implicit rule and g beside it keeps areas, and is stable for h^2 g < 4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, rotate_back, scaled, subtract, vector, vector_at
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies
from heavylift.solver.drive import DRIVEN, FREE

__all__ = [
    "add_acceleration_forces",
    "add_quadratic_forces",
    "add_step_forces",
    "correct_inertia",
    "with_shortening",
]


@kernel(internal=True)
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
    modal_load = kind.modal_load[first : first + n]
    for k in range(6):
        s = factors[k]
        if s == 0.0:
            continue
        G = kind.constants[start + (1 + k) * n * n : start + (2 + k) * n * n]
        for i in range(n):
            product = 0.0
            for j in range(n):
                product += G[i * n + j] * q[j]
            modal_load[i] -= s * product


@kernel(internal=True)
def add_step_forces(
    kind: FloatingFrameBodies, body: int, step: float, gravity: NDArray[np.float64], q: NDArray[np.float64]
) -> None:
    """Those of a step whose velocities at both ends are known, with the rotation of the stage."""
    if kind.table[body].stiffening < 0 or kind.table[body].motion == FREE:
        return
    frame = kind.frame[body]
    a, b = scaled(-1.0, vector(gravity)), (0.0, 0.0, 0.0)
    if kind.table[body].motion == DRIVEN:
        rates = frame.drive_rates
        a = subtract(scaled(1.0 / step, subtract(vector(rates), vector(frame.velocity))), vector(gravity))
        b = scaled(1.0 / step, subtract(vector_at(rates, 3), vector(frame.spin)))
    add_acceleration_forces(kind, body, rotate_back(frame.mid_rotation, a), b, q)
