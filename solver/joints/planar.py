"""Planar joints: the point of b stays in the plane of x and y of a, and the z axes are parallel; 3 rows.

::

    z_a . (p_b - p_a) = 0,    z_a . x_b = 0,    z_a . y_b = 0
"""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.connections import JOINTS, Joint, Place

__all__ = ["Planar"]


@JOINTS.describe("planar")
@dataclass(frozen=True, eq=False, kw_only=True)
class Planar(Joint):
    """The point of b stays in the plane across the axis of a, and the axes are parallel."""

    PLACE: ClassVar = Place.AXIS
    ROWS: ClassVar = (("travel", "z"), ("parallel", "z"))
