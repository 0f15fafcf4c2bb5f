"""Hinges: the points and the z axes of both sides coincide; 5 rows.

"Integrated simulation ... (2018)", section 2.4.3, with two independent rows in place of the cross product
of the axes, whose three rows have rank two::

    p_b - p_a = 0,    z_a . x_b = 0,    z_a . y_b = 0
"""

from __future__ import annotations

from typing import Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.bodies import Profile
from heavylift.solver.scene.connections import (
    JOINTS,
    AngleOutputs,
    Joint,
    Limits,
    Place,
    ReactionOutputs,
)
from heavylift.solver.scene.outputs import Outputs, nested, outputs

__all__ = ["Hinge", "HingeOutputs"]


@outputs
class HingeOutputs(Outputs):
    """What a hinge records."""

    reaction: ReactionOutputs = nested(ReactionOutputs)
    turn: AngleOutputs = nested(AngleOutputs)


@JOINTS.describe("hinge")
@dataclass(frozen=True, eq=False, kw_only=True)
class Hinge(Joint):
    """The points and the axes coincide; b turns about the axis, by the angle.

    The angle turns x of a into x of b about z.
    """

    PLACE: ClassVar = Place.AXIS
    ROWS: ClassVar = (("point",), ("parallel", "z"))
    CHANNELS: ClassVar = HingeOutputs.CHANNELS
    COORDINATE: ClassVar = "angle"

    drive: Annotated[Profile | None, Quantity("angle")] = None
    """The angle as a function of time [rad]: one row more."""
    limits: Annotated[Limits | None, Quantity("angle")] = None
    """Stops of the angle."""
    friction: Annotated[float, Quantity("moment or energy", minimum=0.0, closed=True)] = 0.0
    """Dry friction [N m]."""

    @property
    def kind_module(self) -> str:
        """A drive has a file of its own."""
        return super().kind_module if self.drive is None else "heavylift.solver.joints.driven_hinge"

    @property
    def rotational(self) -> tuple[bool, ...]:
        """With the row of the drive."""
        return self.ROTATIONAL if self.drive is None else (*self.ROTATIONAL, True)
