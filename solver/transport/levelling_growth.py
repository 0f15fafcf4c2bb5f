"""Whether levelling calms the tilt of a vehicle, or drives it: its linear motion from one look to the next.

Pumps that lift groups by the tilt add up what they see. With the angle t of a body on springs, without dampers,

    t'' + w^2 (t + l) = 0 ,   l' = a t / T

has a root that falls with a/T and two that grow with about a/(2 T): so a vehicle has to be damped by more than that, or
the time constant T has to be long. Small motions q (heave, roll, pitch) as in
`heavylift.solver.transport.support_statics`, on bogies i with the stroke s_i, tyres k, c_t and pipes c_l, in groups
of n with oil of the stiffness n o and a lift u::

    z_i = J_i q ,   f_i = k (s_i - z_i) + c_t (s_i' - z_i') = - o (mean s - u) - c_l s_i'
    M q'' = diag(0, W h, W h) q + sum J_i^T f_i ,   u' = (x_k pitch - y_k roll) / T

with the speeds of the pumps held between two looks: eigenvalues are those of the map from one look to the next. What a
path drives along is held on the road, so it turns about the road, else about its centre of mass.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.transport.support_statics import SupportStatics

__all__ = ["LevelledBogies", "levelling_growth", "refuse_growing_levelling"]

GROWS = 1e-4
"""Rate [1/s] from which on a motion grows: in the hours of a move nothing comes of less."""

SLOWER = 1024.0
"""Times the time constant up to which one is looked for that is long enough."""


@dataclass(frozen=True, eq=False)
class LevelledBogies:
    """Bogies and groups below one body.

    Attributes
    ----------
    places
        Of the bogies from the centre of mass [m], x along the vehicle and y to the left, shape (n, 2).
    group
        Number of the group of each, shape (n,).
    tyre, rubber, pipe
        Of each: stiffness of its tyre [N/m], dampers of tyre and cylinder [N s/m], shape (n,).
    oil
        Of each group: force of a bogie by its stroke if all of the group move together [N/m], shape (g,).
    ahead, aside
        Middles of the groups from that of their vehicle [m], shape (g,).
    rate
        Of each group: one over the time constant [1/s], 0 of a vehicle without levelling, shape (g,).
    period
        Between two looks [s].
    held
        Whether it is held on the road.
    """

    places: NDArray[np.float64]
    group: NDArray[np.int64]
    tyre: NDArray[np.float64]
    rubber: NDArray[np.float64]
    pipe: NDArray[np.float64]
    oil: NDArray[np.float64]
    ahead: NDArray[np.float64]
    aside: NDArray[np.float64]
    rate: NDArray[np.float64]
    period: float
    held: bool


def _rates(stand: SupportStatics, bogies: LevelledBogies) -> NDArray[np.float64]:
    """Matrix of the rates of heave, roll, pitch, their rates, strokes with dampers, and lifts, by all of these."""
    n, groups = len(bogies.group), len(bogies.oil)
    damper = bogies.rubber + bogies.pipe
    damped = np.flatnonzero(damper > 0.0)
    size = 6 + len(damped) + groups
    lift = size - groups
    state = np.eye(size)
    J = np.column_stack([np.ones(n), bogies.places[:, 1], -bogies.places[:, 0]])
    rise, rise_rate = J @ state[:3], J @ state[3:6]
    stroke = np.zeros((n, size))
    stroke[damped] = state[6:lift]
    mean = np.zeros((groups, size))
    for g in range(groups):
        own = np.flatnonzero(bogies.group == g)
        k, o, u = bogies.tyre[own], bogies.oil[g], state[lift + g]
        if not damper[own[0]] > 0.0:  # strokes follow at once
            S = np.diag(k) + o / len(own)
            stroke[own] = np.linalg.solve(S, k[:, None] * rise[own] + o * u)
        mean[g] = stroke[own].mean(axis=0) - u
    cylinder = -bogies.oil[bogies.group, None] * mean[bogies.group]
    pressed = bogies.tyre[:, None] * (stroke - rise)
    force = pressed.copy()
    stroke_rate = np.zeros((n, size))
    c_t, c = bogies.rubber[damped, None], damper[damped, None]
    stroke_rate[damped] = (cylinder[damped] - pressed[damped] + c_t * rise_rate[damped]) / c
    force[damped] += c_t * (stroke_rate[damped] - rise_rate[damped])
    M = np.zeros((3, 3))
    M[0, 0], M[1:, 1:] = stand.mass, stand.inertia[:2, :2]
    if bogies.held:
        M[1:, 1:] += stand.mass * stand.height**2 * np.eye(2)
    tips = np.diag([0.0, 1.0, 1.0]) * stand.weight * stand.height
    A = np.zeros((size, size))
    A[:3] = state[3:6]
    A[3:6] = np.linalg.solve(M, tips @ state[:3] + J.T @ force)
    A[6:lift] = stroke_rate[damped]
    return A


def levelling_growth(stand: SupportStatics, bogies: LevelledBogies, slower: float = 1.0) -> complex:
    """Fastest growing motion [1/s]: rate, and angular frequency [rad/s]; below 0 where all calm down.

    Parameters
    ----------
    stand
        The body.
    bogies
        What it stands on.
    slower
        Times the time constants.
    """
    from scipy.linalg import expm

    A = _rates(stand, bogies)
    size, groups = len(A), len(bogies.oil)
    # speeds of the pumps go along as states that stay
    both = np.zeros((size + groups, size + groups))
    both[:size, :size] = A
    both[size - groups : size, size:] = np.eye(groups)
    step = expm(bogies.period * both)
    feedback = np.zeros((groups, size))
    feedback[:, 1], feedback[:, 2] = -bogies.rate / slower * bogies.aside, bogies.rate / slower * bogies.ahead
    values = np.linalg.eigvals(step[:size, :size] + step[:size, size:] @ feedback)
    grown = np.log(np.abs(values[np.abs(values) > 0.0])) / bogies.period
    turned = np.abs(np.angle(values[np.abs(values) > 0.0])) / bogies.period
    worst = int(np.argmax(grown))
    return complex(grown[worst], turned[worst])


def refuse_growing_levelling(stand: SupportStatics, bogies: LevelledBogies) -> None:
    """Refuse levelling that drives a motion of its vehicle.

    Raises
    ------
    InputError
        With the rate by which it grows, and the time constant from which on it does not.
    """
    if not bogies.rate.any():
        return
    found = levelling_growth(stand, bogies)
    if found.real <= GROWS:
        return
    low, high = 1.0, 2.0
    while high < SLOWER and levelling_growth(stand, bogies, high).real > GROWS:
        low, high = high, 2.0 * high
    calm = "more dampers: no time constant is long enough without"
    if high < SLOWER:
        while high > 1.05 * low:
            middle = math.sqrt(low * high)
            grows = levelling_growth(stand, bogies, middle).real > GROWS
            low, high = (middle, high) if grows else (low, middle)
        longest = high / float(bogies.rate[bogies.rate > 0.0].min())
        calm = f"a time constant of {longest:.2g} s or more, or larger 'tyre_damping' and 'line_damping'"
    raise InputError(
        f"levelling excites the motion to be damped: with a time constant of {1.0 / float(bogies.rate.max()):g} s tilts"
        f" grow by exp(t {found.real:.3g} 1/s) at {found.imag:.3g} rad/s",
        source=stand.name,
        key="levelling",
        expected=f"{calm}; or 'accept_unstable'",
    )
