"""Universal joints: the points of both sides coincide, and z of a stays perpendicular to z of b; 4 rows.

"Integrated simulation ... (2018)", section 2.4.2: a ball joint and ``z_a . z_b = 0``.
"""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.connections import JOINTS, Joint, Place

__all__ = ["Universal"]


@JOINTS.describe("universal")
@dataclass(frozen=True, eq=False, kw_only=True)
class Universal(Joint):
    """The points coincide, and the axis of a stays perpendicular to the axis of b."""

    PLACE: ClassVar = Place.CROSS
    ROWS: ClassVar = (("point",), ("square", "z", "z"))
