"""Unstretched lengths of ropes from tensions that are given for the place of rest.

The lengths l are found by Broyden's method ("good" update, Math. Comp. 19, 1965) on the tensions T(l) of the
equilibrium, each search for which begins where the last one ended. The first guess of the derivatives is that of ropes
whose ends stand still, ``dT/dl = -EA s / l^2``: it is too steep where the ends give way, so first steps are too short
rather than too long.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.forces import STEP
from heavylift.solver.statics.rows_at_rest import fill_at_rest

__all__ = ["FITTED_WITH_CONTACTS", "fit_start_tensions"]

FITTED = 1e-8
FITTED_WITH_CONTACTS = 1e-4
"""Miss of a tension relative to the largest that counts as fitted: contacts come to rest less exactly."""

SEARCHES = 60

STALLED = 12
"""Searches without a tenth less of the miss, or of the bracket of a single rope, after which nothing is expected of
more."""

LONGEST_CHANGE, GROWTH = 0.1, 3.0
"""Of a length in one round, relative to it, and to the change before: a load that hangs free has its weight in the rope
whatever the length, until it is set down."""


NO_RESPONSE = 1e-6
"""Of tensions to a change of lengths, relative to that of ropes with ends that stand still: nothing is learnt."""


def fit_start_tensions(
    rows: StartRows, search: Callable[[StartRows], Any], text: str, fitted: float = FITTED
) -> str:
    """Change the lengths of ropes until the equilibrium has the tensions that are given.

    Parameters
    ----------
    rows
        The scene, in an equilibrium.
    search
        Finds the equilibrium from where the scene is.
    text
        Message of the first search.
    fitted
        Miss of a tension relative to the largest that counts as fitted.

    Returns
    -------
    str
        Message of the last search, and the lengths.

    Raises
    ------
    InputError
        If no lengths give the tensions: together they do not carry the loads.
    """
    layout = rows.layout
    kinds = [kind for kind in (*layout.joints, *layout.forces) if hasattr(kind, "tension_at_rest")]
    ropes = [(kind, int(number)) for kind in kinds for number in kind.given]
    wanted = np.array([kind.table[number].wanted for kind, number in ropes])
    lengths = np.array([kind.table[number].start_length for kind, number in ropes])

    def tensions() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        fill_at_rest(
            layout.bodies, layout.forces, layout.joints, layout.systems, layout.work, rows.time, STEP
        )
        found = [kind.tension_at_rest(number) for kind, number in ropes]
        return np.array([t for t, _ in found]), np.array([slope for _, slope in found])

    found, slopes = tensions()
    inverse = np.diag(-1.0 / slopes)
    least, since, searches, longest = np.inf, 0, 0, LONGEST_CHANGE
    too_short, too_long, width = 0.0, np.inf, np.inf  # of a single rope
    while searches < SEARCHES and since < STALLED:
        searches += 1
        miss = wanted - found
        nearer = np.abs(miss).max() < 0.9 * least or too_long - too_short < 0.9 * width
        since, width = (0 if nearer else since + 1), too_long - too_short
        least = min(least, float(np.abs(miss).max()))
        if np.abs(miss).max() <= fitted * wanted.max():
            words = ", ".join(f"{length:.6g} m" for length in lengths)
            return f"{text}; unstretched lengths of ropes with a given tension: {words}"
        if len(ropes) == 1:
            too_short = max(too_short, lengths[0]) if miss[0] < 0.0 else too_short
            too_long = min(too_long, lengths[0]) if miss[0] > 0.0 else too_long
        change = inverse @ miss
        size = float(np.abs(change / lengths).max())
        change *= min(1.0, longest / size) if size > 0.0 else 1.0
        if len(ropes) == 1 and not too_short < lengths[0] + change[0] < too_long:
            farther = lengths[0] * (1.0 + longest if miss[0] < 0.0 else 1.0 - longest)
            change[0] = (0.5 * (too_short + too_long) if np.isfinite(too_long) else farther) - lengths[0]
        longest = min(LONGEST_CHANGE, GROWTH * float(np.abs(change / lengths).max()))
        lengths = lengths + change
        for (kind, number), length in zip(ropes, lengths, strict=True):
            kind.put_length(number, float(length))
        text = search(rows).text
        before, (found, _) = found, tensions()
        response = inverse @ (found - before)
        along = float(change @ response)
        if abs(along) > NO_RESPONSE * float(change @ change):
            inverse += np.outer(change - response, change @ inverse) / along
        else:
            inverse *= GROWTH
    worst = int(np.argmax(np.abs(wanted - found)))
    kind, number = ropes[worst]
    block = kind.table[number].block
    raise InputError(
        f"{wanted[worst]:.6g} N is given, and {found[worst]:.6g} N is left at rest after {searches} searches",
        source=layout.block_names[block] if block >= 0 else "simulation",
        key="tension",
        expected="tensions of ropes that together carry the loads at rest; give one of them a 'length'",
    )
