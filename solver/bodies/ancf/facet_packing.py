"""The own surface of a frame or shell as triangles whose points are sums of nodal vectors.

A shell is its middle surface with half of its thickness as rounding; a frame is a chain of lone segments along its
axis, round, with a cross-section of the same area.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.bodies.ancf.types import type_of
from heavylift.solver.scene.meshes import FrameBody, MeshBody, ShellBody

if TYPE_CHECKING:
    from collections.abc import Hashable

__all__ = ["FacetBook", "facet_surface"]


@dataclass(frozen=True, eq=False)
class FacetBook:
    """A surface that deforms.

    Attributes
    ----------
    surface
        Triangles of the unloaded shape, in the frame of the body.
    counts
        Nodal vectors of each point, shape (n,).
    entries, factors
        Their places behind the first node of the body, and factors; points one after another.
    """

    surface: TriangleSurface
    counts: NDArray[np.int64]
    entries: NDArray[np.int64]
    factors: NDArray[np.float64]


def facet_surface(body: MeshBody, facets: int, name: str) -> FacetBook:
    """Surface of a frame or shell.

    Parameters
    ----------
    body
        Checked.
    facets
        Along each side of an element.
    name
        Of the surface.
    """
    from heavylift.numerics.lanes import block_shape

    of_type = type_of(body)
    lanes, per_node = len(block_shape(of_type.rows)[1]), len(of_type.vectors)
    places: dict[Hashable, int] = {}
    shapes: list[tuple[NDArray[np.int64], NDArray[np.float64]]] = []
    elements = np.asarray(body.elements, dtype=np.int64)  # type: ignore[attr-defined]

    def point(element: int, key: Hashable, local: tuple[float, ...]) -> int:
        """Number of a material point, which several elements may share."""
        if key not in places:
            places[key] = len(shapes)
            values = np.asarray(of_type.shape_values(body, element, local, 0))
            nodes = elements[element]
            vectors = (nodes[:, None] * per_node + np.arange(per_node)).ravel()
            used = values != 0.0
            shapes.append((vectors[used], values[used]))
        return places[key]

    if isinstance(body, FrameBody):
        triangles = _chain(elements, facets, point)
        radius = max(math.sqrt(section.area / math.pi) for section in _sections(body))
    else:
        assert isinstance(body, ShellBody)
        triangles = _grid(elements, facets, point)
        radius = 0.5 * max(section.thickness for section in _sections(body))
    start = np.asarray(of_type.start_coordinates(body), dtype=np.float64).reshape(-1, 3)
    points = np.array([factors @ start[vectors] for vectors, factors in shapes])
    vectors = np.concatenate([vectors for vectors, _ in shapes])
    return FacetBook(
        surface=TriangleSurface(points, triangles, radius, name),
        counts=np.array([len(vectors) for vectors, _ in shapes], dtype=np.int64),
        entries=vectors // per_node * lanes + 3 * (vectors % per_node),
        factors=np.concatenate([factors for _, factors in shapes]),
    )


def _sections(body: Any) -> list[Any]:
    """Sections that elements have."""
    numbers = np.unique(body.element_sections) if len(body.element_sections) else [0]
    return [body.sections[int(i)] for i in numbers]


def _chain(elements: NDArray[np.int64], facets: int, point: Any) -> NDArray[np.int64]:
    """Segments of a frame, each a triangle that repeats its second point."""
    rows = []
    for e, (a, b) in enumerate(elements.tolist()):
        along = [
            point(e, a if i == 0 else b if i == facets else (e, i), (i / facets,)) for i in range(facets + 1)
        ]
        rows += [(p, q, q) for p, q in pairwise(along)]
    return np.array(rows, dtype=np.int64)


def _grid(elements: NDArray[np.int64], facets: int, point: Any) -> NDArray[np.int64]:
    """Triangles of a shell; diagonals of neighbouring squares are mirrored, so that none is preferred."""
    rows = []
    for e, corners in enumerate(elements.tolist()):
        grid = np.zeros((facets + 1, facets + 1), dtype=np.int64)
        for i in range(facets + 1):
            for j in range(facets + 1):
                key = _key(e, corners, i, j, facets)
                grid[i, j] = point(e, key, (i / facets, j / facets))
        for i in range(facets):
            for j in range(facets):
                a, b, c, d = grid[i, j], grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]
                rows += [(a, b, c), (a, c, d)] if (i + j) % 2 == 0 else [(a, b, d), (b, c, d)]
    return np.array(rows, dtype=np.int64)


def _key(e: int, corners: list[int], i: int, j: int, facets: int) -> Hashable:
    """What names a place of an element for its neighbours too: a node, a place between two, or its own."""
    if i in {0, facets} and j in {0, facets}:
        return corners[(0, 3)[j > 0] if i == 0 else (1, 2)[j > 0]]
    for side, at, (first, last) in (
        (j == 0, i, (0, 1)),
        (i == facets, j, (1, 2)),
        (j == facets, i, (3, 2)),
        (i == 0, j, (0, 3)),
    ):
        if side:
            a, b = corners[first], corners[last]
            return (a, b, at, facets) if a < b else (b, a, facets - at, facets)
    return e, i, j
