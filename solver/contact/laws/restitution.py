"""Restitution that makes no energy.

Newton's law, an end velocity of ``-e`` times the approach, may give bodies more energy than they had: with friction
where slip stops or turns in the impact (T. R. Kane and D. A. Levinson, *Dynamics: Theory and Applications*, 1985,
section 5.8), and where a row has stopped the approach at another place than the rebound begins. Then all coefficients
of the impact are reduced by one factor, so far that it keeps the energy.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.solve.stage import present_at, solve_present
from heavylift.solver.interface import Workspace

__all__ = ["bound_restitution"]

ROUNDING = 1e-9
"""Of the work that goes both ways: a gain below is none."""

TRIALS = 6
"""Of the factor, after which there is no restitution."""


@kernel(internal=True)
def bound_restitution(contacts: ContactRows, count: int, work: Workspace) -> bool:
    """Solve again with less restitution if the impulses have done work; false if none are found.

    Parameters
    ----------
    contacts, count
        Solved, and how many take part.
    work
        Velocities after the impulses.
    """
    bounces = False
    for j in range(count):
        bounces = bounces or (contacts.state[present_at(contacts, j)].new and contacts.laws[j].wanted > 0.0)
    if not bounces:
        return True
    gain, scale = _gain(contacts, count)
    if gain <= ROUNDING * scale:
        return True
    if not _solve_with(contacts, count, 0.0, work):
        return False
    plastic = _gain(contacts, count)[0]
    if not plastic < 0.0:
        return True
    factor = plastic / (plastic - gain)  # of a parabola the root lies beyond that of its chord
    for _ in range(TRIALS):
        if not _solve_with(contacts, count, factor, work):
            return False
        gain, scale = _gain(contacts, count)
        if gain <= ROUNDING * scale:
            return True
        factor *= 0.8
    return _solve_with(contacts, count, 0.0, work)


@kernel(internal=True)
def _gain(contacts: ContactRows, count: int) -> tuple[float, float]:
    """Work of the impulses of the step that stop and push back [J], and of all of it the sum of magnitudes."""
    free, p, w = contacts.rates[0], contacts.rates[1], contacts.rates[2]
    total = contacts.control.stopping_work
    scale = abs(total)
    for i in range(3 * count):
        part = 0.5 * p[i] * (free[i] + w[i])
        total += part
        scale += abs(p[i]) * (abs(free[i]) + abs(w[i]))
    return total, scale


@kernel(internal=True)
def _solve_with(contacts: ContactRows, count: int, factor: float, work: Workspace) -> bool:
    """Impulses with all restitution reduced."""
    for j in range(count):
        if contacts.state[present_at(contacts, j)].new:
            contacts.laws[j].target[0] = factor * contacts.laws[j].wanted
    return bool(solve_present(contacts, count, work))
