"""Contours and triangles on hulls that touch something: they stand still in principal axes, as of any rigid body."""

from __future__ import annotations

from heavylift.solver.bodies.rigid_contours import (
    bound_rigid_motion,
    forget_rigid_accelerations,
    pose_rigid_contours,
    put_rigid_contour_rows,
)
from heavylift.solver.contact.interface import (
    bound_motion,
    forget_accelerations,
    pose_contours,
    put_contour_rows,
)
from heavylift.solver.kinds import implement
from heavylift.solver.marine.hulls import Hulls

__all__: list[str] = []

implement(pose_contours, Hulls)(pose_rigid_contours)
implement(put_contour_rows, Hulls)(put_rigid_contour_rows)
implement(bound_motion, Hulls)(bound_rigid_motion)
implement(forget_accelerations, Hulls)(forget_rigid_accelerations)
