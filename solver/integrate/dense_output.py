"""States between the steps: Hermite interpolation over the ends of steps, without evaluations of its own.

A configuration is known at the ends of steps with its rate and its second rate. The polynomial through four of
them is of degree 11: in the middle interval it is far more accurate than the steps are, and errors of the ends are
not amplified, which they are in the last interval if the steps grow; so records lag one step behind. With
``u = t - t_i`` and ``d_j = t_i - t_j`` the weights of node i are::

    l = product over j of (1 + u/d_j)^3,      1/l = 1 + c_1 u + c_2 u^2 + ...
    l (1 + c_1 u + c_2 u^2),   l u (1 + c_1 u),   l u^2/2

of value, rate and second rate: J. Stoer and R. Bulirsch, "Introduction to Numerical Analysis", section 2.1.5.
Quadratures, of which the rate alone is known, are interpolated to degree 7. Ends that lie too near to each other
would amplify errors, so some of them are passed over.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel

__all__ = ["choose_nodes", "node_weights", "quadrature_weights"]

NEAREST = 0.4
"""Smallest distance of a further node, relative to the interval that holds the time."""

Weights = tuple[float, float, float, float, float, float]


@kernel(internal=True)
def choose_nodes(
    time: float, times: NDArray[np.float64], newest: int, filled: int
) -> tuple[int, int, int, int, int]:
    """Places of the ends of the interval that holds a time and of two further nodes, and how many were found.

    Parameters
    ----------
    time
        Not later than the newest node [s].
    times
        Of the nodes, a ring.
    newest, filled
        Place of the newest node and how many are in use, 2 or more.
    """
    slots = times.shape[0]
    after = 0  # nodes are counted from the newest one backwards
    while after + 2 < filled and times[(newest - after - 1) % slots] >= time:
        after += 1
    a, b = (newest - after - 1) % slots, (newest - after) % slots
    distance = NEAREST * (times[b] - times[a])
    later, earlier = after, after + 1
    first, second = _further(times, newest, after, -1, -1, distance), -1
    if first >= 0:
        later = (newest - first) % slots
    second = _further(times, newest, after + 1, 1, filled, distance)
    if second >= 0:
        earlier = (newest - second) % slots
    if first < 0 <= second:
        second = _further(times, newest, earlier, 1, filled, distance)
        first = (newest - earlier) % slots
    elif second < 0 <= first:
        second = _further(times, newest, later, -1, -1, distance)
    if first < 0:
        return a, b, a, a, 2
    if second < 0:
        return a, b, first, a, 3
    return a, b, first, second, 4


@kernel(internal=True)
def _further(times: NDArray[np.float64], newest: int, start: int, way: int, end: int, distance: float) -> int:
    """Place of the next node on one way, counted backwards, that is not too near to the start; -1 if there is none."""
    slots = times.shape[0]
    i = start + way
    while i != end:
        place = (newest - i) % slots
        if abs(times[place] - times[(newest - start) % slots]) >= distance:
            return place
        i += way
    return -1


@kernel(internal=True)
def node_weights(time: float, own: float, others: tuple[float, float, float], count: int) -> Weights:
    """Weights of value, rate and second rate at a node, and the derivatives of these weights.

    Parameters
    ----------
    time
        Where to interpolate [s].
    own
        Time of the node.
    others
        Times of the other nodes, those in use first.
    count
        Nodes in use, with this one.
    """
    u = time - own
    l, dl = 1.0, 0.0
    c1, c2 = 0.0, 0.0
    for i in range(count - 1):
        a = 1.0 / (own - others[i])
        A = 1.0 + a * u
        dl = dl * A * A * A + 3.0 * a * l * A * A
        l *= A * A * A
        c2 += -3.0 * a * c1 + 6.0 * a * a
        c1 -= 3.0 * a
    zeroth, zeroth_rate = 1.0 + u * (c1 + u * c2), c1 + 2.0 * u * c2
    first, first_rate = u * (1.0 + c1 * u), 1.0 + 2.0 * c1 * u
    return (
        l * zeroth,
        l * first,
        0.5 * l * u * u,
        dl * zeroth + l * zeroth_rate,
        dl * first + l * first_rate,
        0.5 * dl * u * u + l * u,
    )


@kernel(internal=True)
def quadrature_weights(
    time: float, own: float, others: tuple[float, float, float], count: int
) -> tuple[float, float]:
    """Weights of value and rate at a node, if the second rate is not known; parameters as of `node_weights`."""
    u = time - own
    l, c = 1.0, 0.0
    for i in range(count - 1):
        a = 1.0 / (own - others[i])
        l *= (1.0 + a * u) ** 2
        c -= 2.0 * a
    return l * (1.0 + c * u), l * u
