"""Exclusion boxes: parts of a surface that take no part in collision.

Source: *Integrated simulation ... ships and offshore structures* (2018), section 2.6.1 (3). Overlap of triangle and
box by separating axes: Akenine-Moeller, Fast 3D triangle-box overlap testing, J. Graphics Tools 6 (2001).
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface, with_triangles

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["ExclusionBox", "exclude"]

_NEAR = 1e-9  # of the longest side of a box: what lies in its faces counts as inside


@dataclass(frozen=True, eq=False)
class ExclusionBox:
    """A box fixed to the body, and on which side of it triangles are excluded.

    Parameters
    ----------
    centre
        [m], shape (3,), in the axes of the body.
    size
        Whole lengths of the sides [m], shape (3,); infinite ones are allowed.
    axes
        Directions of the sides as columns, shape (3, 3), orthonormal; default those of the body.
    inside
        True: triangles that lie wholly inside the box are excluded. False: the box says what is to stay, and
        triangles that lie wholly outside are excluded. Either way a triangle that the surface of the box cuts
        stays, so that no contact is lost that was not meant to be.

    Raises
    ------
    InputError
        For a size that is not positive, axes that are not orthonormal, numbers that are not finite.
    """

    centre: NDArray[np.float64]
    size: NDArray[np.float64]
    axes: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    inside: bool = True

    def __post_init__(self) -> None:
        for name, shape in (("centre", (3,)), ("size", (3,)), ("axes", (3, 3))):
            value = np.array(getattr(self, name), dtype=np.float64)
            if value.shape != shape or np.isnan(value).any() or (name != "size" and np.isinf(value).any()):
                raise InputError(
                    f"{value.tolist()}",
                    source="exclusion box",
                    key=name,
                    expected=f"numbers, shape {shape}",
                )
            object.__setattr__(self, name, value)
        if not (self.size > 0.0).all():
            raise InputError(
                f"{self.size.tolist()}",
                source="exclusion box",
                key="size",
                expected="three positive lengths in m",
            )
        if np.abs(self.axes.T @ self.axes - np.eye(3)).max() > 1e-9:
            raise InputError(
                f"{self.axes.tolist()}",
                source="exclusion box",
                key="axes",
                expected="orthonormal columns",
            )


def exclude(
    surface: TriangleSurface, boxes: Sequence[ExclusionBox]
) -> tuple[TriangleSurface, NDArray[np.bool_]]:
    """Take triangles out of a surface.

    A triangle is excluded if it lies wholly in one of the boxes with ``inside = True``, or if there are boxes with
    ``inside = False`` and it lies wholly outside of every one of them: several of these add up to what stays. The
    rounding of a surface is not looked at, only its triangles, points and segments.

    Parameters
    ----------
    surface
        In the axes of its body.
    boxes
        Any number.

    Returns
    -------
    tuple
        The surface of the triangles that stay; and which triangles of `surface` are excluded, shape (nt,).

    Raises
    ------
    InputError
        If nothing is left.
    """
    excluded = np.zeros(len(surface.triangles), dtype=np.bool_)
    keepers = [box for box in boxes if not box.inside]
    for box in boxes:
        if box.inside:
            excluded |= _wholly_inside(surface, box)
    if keepers:
        excluded |= ~np.any([_touches(surface, box) for box in keepers], axis=0)
    if excluded.all():
        low, high = ([float(f"{value:.6g}") for value in corner] for corner in surface.bounds)
        raise InputError(
            f"all {excluded.size} triangles are excluded, the surface reaches from {low} to {high} m",
            source=surface.name or "surface",
            key="exclusion boxes",
            expected="boxes in m and in the axes of the body that leave at least one triangle; "
            "`inside = true` excludes what lies in a box, `inside = false` what lies outside",
        )
    if not excluded.any():
        return surface, excluded
    return with_triangles(surface, surface.triangles[~excluded]), excluded


def _half(box: ExclusionBox, near: float) -> NDArray[np.float64]:
    """Half lengths with a tolerance, shape (3,)."""
    finite = box.size[np.isfinite(box.size)]
    return 0.5 * box.size + near * (finite.max() if finite.size else 1.0)


def _wholly_inside(surface: TriangleSurface, box: ExclusionBox) -> NDArray[np.bool_]:
    local = (surface.points - box.centre) @ box.axes
    within: NDArray[np.bool_] = np.all(np.abs(local) <= _half(box, _NEAR), axis=1)
    return np.all(within[surface.triangles], axis=1)


def _touches(surface: TriangleSurface, box: ExclusionBox) -> NDArray[np.bool_]:
    """Whether each triangle has a point in common with the box, by the 13 axes that can separate them."""
    corners = ((surface.points - box.centre) @ box.axes)[surface.triangles]
    # no triangle reaches beyond this, so that an infinite side may end there (0 times infinity is no number)
    far = 2.0 * np.abs(corners).max() + 1.0
    half = np.minimum(_half(box, _NEAR), far)
    sides = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(sides[:, 0], sides[:, 1])
    axes = [np.broadcast_to(unit, normals.shape) for unit in np.eye(3)]
    axes.append(normals)
    axes.extend(np.cross(unit, sides[:, k]) for unit in np.eye(3) for k in range(3))
    apart = np.zeros(len(corners), dtype=np.bool_)
    for axis in axes:
        shadow = np.einsum("tij,tj->ti", corners, axis)
        reach = np.abs(axis) @ half
        apart |= (shadow.min(axis=1) > reach) | (shadow.max(axis=1) < -reach)
    return np.asarray(~apart)
