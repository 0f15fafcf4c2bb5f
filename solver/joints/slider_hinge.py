"""Slider hinges: the point of b slides along a direction e of a, and b turns about z of a; 4 rows.

"Integrated simulation ... (2018)", section 2.4.6, with independent rows in place of cross products.

A cylindrical joint is the slider hinge that slides along its own z axis, so this file describes both. With
two directions m, n of a, perpendicular to e and to each other::

    m . (p_b - p_a) = 0,    n . (p_b - p_a) = 0,    z_a . x_b = 0,    z_a . y_b = 0
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import WorldDirection
from heavylift.solver.scene.connections import JOINTS
from heavylift.solver.scene.sliding_joints import SlidesAndTurns

__all__ = ["Cylindrical", "SliderHinge"]


@JOINTS.describe("slider_hinge")
@dataclass(frozen=True, eq=False, kw_only=True)
class SliderHinge(SlidesAndTurns):
    """The point of b slides along one axis of a, and b turns about another."""

    slide_axis: Annotated[NDArray[np.float64], WorldDirection()]
    """World direction of the travel at the start, any length; `axis` is that of the turn."""

    @property
    def travel_axis(self) -> NDArray[np.float64]:
        """The slide axis."""
        return self.slide_axis


@JOINTS.describe("cylindrical")
@dataclass(frozen=True, eq=False, kw_only=True)
class Cylindrical(SlidesAndTurns):
    """The point of b slides along the axis, and b turns about it."""
