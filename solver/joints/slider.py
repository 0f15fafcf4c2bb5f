"""Sliders: the point of b slides along z of a without turning; 5 rows.

"Integrated simulation ... (2018)", section 2.4.4, with independent rows in place of cross products::

    x_a . (p_b - p_a) = 0,  y_a . (p_b - p_a) = 0,  z_a . x_b = 0,  z_a . y_b = 0,  x_a . y_b = 0
"""

from __future__ import annotations

from typing import Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.bodies import Profile
from heavylift.solver.scene.connections import JOINTS, Joint, Limits, Place
from heavylift.solver.scene.sliding_joints import SlidingOutputs

__all__ = ["Slider"]


@JOINTS.describe("slider")
@dataclass(frozen=True, eq=False, kw_only=True)
class Slider(Joint):
    """The point of b slides along the axis without turning, by the travel."""

    PLACE: ClassVar = Place.AXIS
    ROWS: ClassVar = (("travel", "x"), ("travel", "y"), ("parallel", "z"), ("square", "x", "y"))
    CHANNELS: ClassVar = SlidingOutputs.CHANNELS
    COORDINATE: ClassVar = "travel"

    drive: Annotated[Profile | None, Quantity("length")] = None
    """The travel as a function of time [m]: one row more."""
    limits: Annotated[Limits | None, Quantity("length")] = None
    """Stops of the travel."""
    friction: Annotated[float, Quantity("force", minimum=0.0, closed=True)] = 0.0
    """Dry friction [N]."""

    @property
    def kind_module(self) -> str:
        """A drive has a file of its own."""
        return super().kind_module if self.drive is None else "heavylift.solver.joints.driven_slider"

    @property
    def rotational(self) -> tuple[bool, ...]:
        """With the row of the drive."""
        return self.ROTATIONAL if self.drive is None else (*self.ROTATIONAL, False)
