"""Surfaces through the nodes of faces, made once for the same nodes: see `heavylift.numerics.derived`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.contours.splines.face_fit import fitted_surface
from heavylift.contours.splines.kept import ContourArrays
from heavylift.numerics.derived import derived

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.splines.neutral import NeutralContour

__all__ = ["kept_face"]


def kept_face(
    nodes: NDArray[np.float64],
    picked: NDArray[np.int64],
    mode_shapes: NDArray[np.float64],
    *,
    degrees: tuple[int, int],
    source: str,
) -> NeutralContour:
    """A surface through the nodes of a face; as `fitted_surface`."""
    return derived(ContourArrays, _of_face, nodes, picked, mode_shapes, degrees, source).made()


def _of_face(
    nodes: NDArray[np.float64],
    picked: NDArray[np.int64],
    mode_shapes: NDArray[np.float64],
    degrees: tuple[int, int],
    source: str,
) -> ContourArrays:
    return ContourArrays.of(
        fitted_surface(nodes, picked, mode_shapes, degrees=degrees, source=source).contour
    )
