"""Fixed joints: the frames of both sides coincide; 6 rows.

"Integrated simulation ... (2018)", section 2.4.5, by direction cosines in place of angles.

::

    p_b - p_a = 0,    z_a . x_b = 0,    z_a . y_b = 0,    x_a . y_b = 0
"""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.connections import JOINTS, Joint

__all__ = ["FixedJoint"]


@JOINTS.describe("fixed")
@dataclass(frozen=True, eq=False, kw_only=True)
class FixedJoint(Joint):
    """The two sides move as one.

    A frame of ANCF elements keeps its tangent only, 5 rows: it has no torsion.
    """

    ROWS: ClassVar = (("point",), ("parallel", "z"), ("square", "x", "y"))
