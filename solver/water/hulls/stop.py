"""Why a hull has left what its database covers, in words."""

from __future__ import annotations

import math

import numpy as np

from heavylift.solver.interface import Bodies

__all__ = ["left_because"]


def left_because(bodies: Bodies, number: int) -> tuple[str, str]:
    """What happened, and what may help.

    Parameters
    ----------
    bodies
        Kinds of a scene after a step that was refused.
    number
        Of the hull.
    """
    for kind in bodies:
        if "hulls" not in kind._fields:
            continue
        for row in np.flatnonzero(kind.table["number"] == number):
            volume, least = kind.stage[row].clip.volume, kind.hulls[row].least_volume
            if np.isnan(kind.vectors.wave[6 * row : 6 * row + 6]).any():
                turned = math.degrees(kind.stage[row].heading)
                return (
                    f"no wave force is known at a heading of {turned:.3g} deg at this time",
                    "a database with more headings, or a longer series of waves",
                )
            if least > 0.0 and volume < least:
                return (
                    f"it displaces {volume:.3g} m3 and is as good as out of the water",
                    "lower waves, the right mass, or no database for a hull that leaves the water",
                )
            if least > 0.0:
                return (
                    "it is wholly under water",
                    "lower waves, more freeboard or stability, the right mass, or no database for a hull that sinks",
                )
    return "", "a database that covers the motion"
