"""When a surface counts as one that has not moved."""

from __future__ import annotations

from heavylift.contours.triangles.surface_layout import RelativePose
from heavylift.numerics.jit import kernel

__all__ = ["STILL", "is_at"]

STILL = 1e-10
"""Of a size: what is moved or turned by less has not moved."""


@kernel(inline=True, internal=True)
def is_at(pose: RelativePose, place: RelativePose, size: float) -> bool:
    """Whether a pose is within `STILL` of another one."""
    moved = turned = 0.0
    for k in range(3):
        moved = max(moved, abs(pose.origin[k] - place.origin[k]))
    for k in range(9):
        turned = max(turned, abs(pose.rotation[k] - place.rotation[k]))
    return moved <= STILL * size and turned <= STILL
