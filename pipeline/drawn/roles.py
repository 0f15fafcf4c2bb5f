"""What a role looks like: its group, its colour, and its width in pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from heavylift.solver.scene.drawn import Drawn

__all__ = ["BODY_COLOURS", "FORCE_COLOUR", "ROLES", "WATER_COLOUR", "Look"]


class Look(NamedTuple):
    """How a role is drawn.

    Attributes
    ----------
    group
        What is shown and hidden together in the page.
    colour
        Of its surfaces and lines; bodies have `BODY_COLOURS` in the page.
    width, dot
        Of its lines and dots in pictures [pixels].
    """

    group: str
    colour: str
    width: float = 1.5
    dot: float = 8.0


_STEEL = "#5b6b7c"
ROLES: dict[Drawn, Look] = {
    "axes": Look("joint axes", "#1d2733"),
    "body": Look("bodies", "#b8c4d0"),
    "box": Look("bodies", "#b8c4d0"),
    "centre": Look("centres of mass", _STEEL, dot=14.0),
    "contour": Look("contact surfaces", "#8e3b9c", 2.5),
    "deck": Look("ground", "#e4e7ea"),
    "fender": Look("fenders", "#ef8a17"),
    "ground": Look("ground", "#e4e7ea"),
    "hull": Look("bodies", "#b8c4d0"),
    "joint": Look("joints", "#1d2733"),
    "mooring": Look("mooring lines", "#a0522d", 2.5),
    "rod": Look("rods", _STEEL, 4.0),
    "rope": Look("ropes", "#7a4a12", 2.5),
    "seabed": Look("ground", "#d9c9a3"),
    "sheave": Look("ropes", "#4a5560"),
    "spring": Look("forces", "#2e7d32", 2.0),
    "tank": Look("tanks", "#3a7bb0"),
    "touch": Look("contact surfaces", "#c9a227", 3.0, 12.0),
    "wheel": Look("transporters", "#4a5560"),
}
BODY_COLOURS = ("#9fb6cc", "#d3b98a", "#a9c3a4", "#c4a9bf", "#b7bcc4", "#d2a79a", "#93bfc0", "#c9c391")
"""One body after the other in the page."""
FORCE_COLOUR, WATER_COLOUR = "#c62828", "#4d8fc4"
