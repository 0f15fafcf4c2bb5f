"""The shape of a mesh as contacts search it: a spline, knots and control points; or triangles, sums of nodal vectors.

A cubic element of length l between two nodes with positions r and slopes r' is the Bezier curve with the control points
``r_0, r_0 + l/3 r_0', r_1 - l/3 r_1', r_1``. With the lengths of the elements as parameter the slope does not jump at a
node, so a knot twice at each node is enough: the position of an inner node lies between its neighbours on the line that
they make, and is no control point of its own (L. Piegl and W. Tiller, "The NURBS Book", section 5.4). A shell is the
tensor product, with ``r + a/3 r_x + b/3 r_y + a b/9 r_xy`` and the like.

Of triangles, a shell is its middle surface with half of its thickness as rounding; a frame is a chain of lone segments
along its axis, round, with a cross-section of the same area.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.bodies.ancf.types import type_of
from heavylift.solver.scene.meshes import FrameBody, MeshBody, ShellBody

if TYPE_CHECKING:
    from collections.abc import Hashable

    from heavylift.contours.splines.spaces import SplineSpace

__all__ = [
    "ControlVectors",
    "FacetBook",
    "MeshContour",
    "control_vectors",
    "facet_surface",
    "mesh_contour",
    "start_control",
]


# ---- the spline ----


DEGREE = 3

SAME = 1e-9
"""Relative difference of lengths that count as equal."""


@dataclass(frozen=True, eq=False)
class ControlVectors:
    """What the control points of the shape of a mesh are made of.

    Attributes
    ----------
    knots
        Of one direction (frame) or two (shell); the domain is [0, 1].
    counts
        Control points of each direction.
    closed
        Whether the mesh is a ring; shells are open.
    vectors
        Numbers of nodal vectors, ``node vectors_per_node + vector``; shape (n, 4), row-major, second direction fastest.
    factors
        Their factors, 0 where there are fewer than four; shape (n, 4).
    lengths
        Of the elements along each direction [m].
    elements
        Numbers of the elements in the order of the knots, shape (e,) or (a, b).
    """

    knots: tuple[NDArray[np.float64], ...]
    counts: tuple[int, ...]
    closed: bool
    vectors: NDArray[np.int64]
    factors: NDArray[np.float64]
    lengths: tuple[NDArray[np.float64], ...]
    elements: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class MeshContour:
    """The shape of a mesh as a spline.

    Attributes
    ----------
    spaces
        One of a frame, two of a shell.
    vectors, factors
        As in `ControlVectors`.
    """

    spaces: tuple[SplineSpace, ...]
    vectors: NDArray[np.int64]
    factors: NDArray[np.float64]


def mesh_contour(body: MeshBody) -> MeshContour:
    """The shape of a frame or shell as a cubic spline curve or surface.

    Parameters
    ----------
    body
        A frame whose elements follow one another, open or in a ring, or a shell of a times b elements. The normal of a
        shell is ``r_x x r_y``.

    Raises
    ------
    InputError
        If the elements do not make one line, or one rectangle.
    """
    from heavylift.contours.splines.spaces import SplineSpace

    made = control_vectors(body)
    spaces = tuple(
        SplineSpace(degree=DEGREE, knots=knots, count=count, closed=made.closed)
        for knots, count in zip(made.knots, made.counts, strict=True)
    )
    return MeshContour(spaces, made.vectors, made.factors)


def start_control(body: MeshBody, contour: MeshContour) -> NDArray[np.float64]:
    """Control points of the unloaded shape in the frame of the body [m], shape (n, 3)."""
    from heavylift.solver.bodies.ancf.types import type_of

    start = np.asarray(type_of(body).start_coordinates(body), dtype=np.float64).reshape(-1, 3)
    return np.asarray(np.einsum("nk,nkx->nx", contour.factors, start[contour.vectors]))


def control_vectors(body: MeshBody) -> ControlVectors:
    """Knots, and the nodal vectors that control points are made of; parameters and errors as of `mesh_contour`."""
    if isinstance(body, FrameBody):
        return _of_frame(body)
    assert isinstance(body, ShellBody)
    return _of_shell(body)


def _refuse(body: MeshBody, problem: str, expected: str) -> InputError:
    return InputError(problem, source=body.name, key="elements", expected=expected)


def _direction(
    lengths: NDArray[np.float64], closed: bool
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Knots; node (counted along the direction) and factor of the slope of each control point."""
    count = len(lengths)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    ends /= ends[-1]
    third = lengths / DEGREE
    if closed:
        inner = np.repeat(ends[:-1], 2)
        around = np.concatenate([inner - 1.0, inner, inner + 1.0, inner + 2.0])
        first = 2 * count - 2  # the last node before the seam comes twice before it
        knots = around[first : first + 2 * count + 2 * DEGREE + 1]
        node = np.repeat(np.arange(count), 2)
        factor = np.stack([-np.roll(third, 1), third], axis=1).ravel()
        return knots, node, factor
    knots = np.concatenate([np.zeros(2), np.repeat(ends, 2), np.ones(2)])
    node = np.repeat(np.arange(count + 1), 2)
    before, after = np.concatenate([[0.0], third]), np.concatenate([third, [0.0]])
    return knots, node, np.stack([-before, after], axis=1).ravel()


def _of_frame(body: FrameBody) -> ControlVectors:
    from heavylift.solver.bodies.ancf.frame_packing import element_lengths

    order, closed = _chain(body)
    lengths = element_lengths(body)[order]
    knots, place, factor = _direction(lengths, closed)
    nodes = body.elements[order, 0]
    if not closed:
        nodes = np.concatenate([nodes, body.elements[order[-1:], 1]])
    vectors = np.zeros((len(place), 4), dtype=np.int64)
    factors = np.zeros((len(place), 4))
    vectors[:, 0], factors[:, 0] = 2 * nodes[place], 1.0
    vectors[:, 1:] = 2 * nodes[place][:, None] + 1
    factors[:, 1] = factor
    return ControlVectors((knots,), (len(place),), closed, vectors, factors, (lengths,), order)


def _chain(body: FrameBody) -> tuple[NDArray[np.int64], bool]:
    """Elements in their order along the line, and whether it is a ring."""
    elements = np.asarray(body.elements, dtype=np.int64)
    expected = "elements that follow one another along one line, each from its first node to its second"
    for column, word in ((0, "begin"), (1, "end")):
        numbers, counts = np.unique(elements[:, column], return_counts=True)
        if np.any(counts > 1):
            raise _refuse(
                body, f"{counts.max()} elements {word} at node {numbers[counts.argmax()]}", expected
            )
    following = dict(zip(elements[:, 0].tolist(), range(len(elements)), strict=True))
    starts = np.setdiff1d(elements[:, 0], elements[:, 1])
    order = [following[int(starts[0])] if len(starts) else 0]
    while len(order) <= len(elements):
        node = int(elements[order[-1], 1])
        if node not in following or following[node] == order[0]:
            break
        order.append(following[node])
    if len(order) != len(elements):
        raise _refuse(
            body, f"{len(order)} of {len(elements)} elements make a line, the others another", expected
        )
    return np.array(order, dtype=np.int64), len(starts) == 0


def _of_shell(body: ShellBody) -> ControlVectors:
    elements, nodes = _grid(body)
    lengths = np.asarray(body.lengths, dtype=np.float64)[elements]
    along_x, along_y = lengths[:, 0, 0], lengths[0, :, 1]
    odd = np.argwhere(
        (np.abs(lengths[..., 0] - along_x[:, None]) > SAME * along_x[:, None])
        | (np.abs(lengths[..., 1] - along_y) > SAME * along_y)
    )
    if len(odd):
        number = int(elements[tuple(odd[0])])
        raise InputError(
            f"{body.lengths[number].tolist()}",
            source=body.name,
            key=f"lengths[{number}]",
            expected="one length for each row and each column of elements, if something slides on the shell",
        )
    knots_x, place_x, factor_x = _direction(along_x, closed=False)
    knots_y, place_y, factor_y = _direction(along_y, closed=False)
    first = 4 * nodes[place_x[:, None], place_y[None, :]]
    a, b = np.broadcast_arrays(factor_x[:, None], factor_y[None, :])
    factors = np.stack([np.ones_like(a), a, b, a * b], axis=-1).reshape(-1, 4)
    vectors = (first[..., None] + np.arange(4)).reshape(-1, 4)
    counts = (len(place_x), len(place_y))
    return ControlVectors((knots_x, knots_y), counts, False, vectors, factors, (along_x, along_y), elements)


def _grid(body: ShellBody) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Elements of a rectangle by rows and columns, shape (a, b), and its nodes, shape (a + 1, b + 1)."""
    corners = np.asarray(body.elements, dtype=np.int64)
    expected = "a times b elements in rows and columns, if something slides on the shell"
    right: dict[tuple[int, int], int] = {}
    up: dict[tuple[int, int], int] = {}
    for number, (n0, n1, _, n3) in enumerate(corners.tolist()):
        for known, edge in ((right, (n0, n3)), (up, (n0, n1))):
            if edge in known:
                raise _refuse(body, f"elements {known[edge]} and {number} overlap", expected)
            known[edge] = number
    taken = {(n1, n2) for _, n1, n2, _ in corners.tolist()}
    below = {(n3, n2) for _, _, n2, n3 in corners.tolist()}
    firsts = [
        e
        for e, (n0, n1, _, n3) in enumerate(corners.tolist())
        if (n0, n3) not in taken and (n0, n1) not in below
    ]
    if len(firsts) != 1:
        raise _refuse(body, f"{len(firsts)} corners at which rows and columns begin", expected)
    columns: list[list[int]] = []
    start: int | None = firsts[0]
    seen: set[int] = set()
    while start is not None and start not in seen:
        column: list[int] = []
        element: int | None = start
        while element is not None and element not in seen:
            seen.add(element)
            column.append(element)
            element = up.get((int(corners[element, 3]), int(corners[element, 2])))
        columns.append(column)
        start = right.get((int(corners[start, 1]), int(corners[start, 2])))
    shape = {len(column) for column in columns}
    if len(shape) != 1 or len(seen) != len(corners):
        raise _refuse(body, f"{len(corners)} elements that make no rectangle", expected)
    grid = np.array(columns, dtype=np.int64)
    a, b = grid.shape
    nodes = np.full((a + 1, b + 1), -1, dtype=np.int64)
    for (di, dj), corner in zip(((0, 0), (1, 0), (1, 1), (0, 1)), range(4), strict=True):
        part = nodes[di : di + a, dj : dj + b]
        met = corners[grid, corner]
        if np.any((part >= 0) & (part != met)):
            raise _refuse(body, "rows and columns do not meet in common nodes", expected)
        part[...] = met
    if len(np.unique(nodes)) != nodes.size:
        raise _refuse(body, "a row or column of elements is closed to a ring", expected)
    return grid, nodes


# ---- the triangles ----


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
        triangles = _segments(elements, facets, point)
        radius = max(math.sqrt(section.area / math.pi) for section in _sections(body))
    else:
        assert isinstance(body, ShellBody)
        triangles = _halves(elements, facets, point)
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


def _segments(elements: NDArray[np.int64], facets: int, point: Any) -> NDArray[np.int64]:
    """Segments of a frame, each a triangle that repeats its second point."""
    rows = []
    for e, (a, b) in enumerate(elements.tolist()):
        along = [
            point(e, a if i == 0 else b if i == facets else (e, i), (i / facets,)) for i in range(facets + 1)
        ]
        rows += [(p, q, q) for p, q in pairwise(along)]
    return np.array(rows, dtype=np.int64)


def _halves(elements: NDArray[np.int64], facets: int, point: Any) -> NDArray[np.int64]:
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
