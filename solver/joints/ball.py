"""Ball joints: the points of both sides coincide; 3 rows: "Integrated simulation ... (2018)", eqs. 163-164."""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.connections import JOINTS, Joint

__all__ = ["Ball"]


@JOINTS.describe("ball")
@dataclass(frozen=True, eq=False, kw_only=True)
class Ball(Joint):
    """The two points coincide."""

    ROWS: ClassVar = (("point",),)
