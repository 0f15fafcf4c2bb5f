"""From a `FrameBody` to numbers: checks, element data, material points.

The reference shape of an element is cubic Hermite through two nodes with unit tangents,
``X(xi) = S1 X_1 + S2 t_1 + S3 X_2 + S4 t_2`` with ``S2, S4`` proportional to the length l, which is that of the curve.
Its parameter is not quite its arc length: derivatives by that use the metric ``J = |X_xi|``, which is l at the nodes.
Mass, bending and everything that kernels take from `constants` are made here, on the reference shape.
"""

from __future__ import annotations

from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.frame_data import (
    AXIAL,
    AXIAL_POINTS,
    BENDING,
    BENDING_POINTS,
    EXACT,
    EXACT_LENGTH,
    GREEN_LAGRANGE,
    STRESS_PLACES,
    AxialPoint,
    BendingPoint,
    frame_data,
)
from heavylift.solver.bodies.ancf.types import check_finite, check_load, check_numbers, check_supports
from heavylift.solver.scene.meshes import FRAME_VECTORS, FrameBody, FrameSection, RodBody

__all__ = [
    "ReferenceElement",
    "body_constants",
    "check_frame",
    "check_line",
    "element_data",
    "element_lengths",
    "gauss_points",
    "hermite",
    "load_element_data",
    "load_shape",
    "locate",
    "reference_element",
    "references",
    "result_columns",
    "shape_values",
    "start_coordinates",
    "strain_counts",
]


# ---- the reference shape ----


STRAIGHT = 1e-6
"""Largest angle between tangent and chord of an element that counts as straight [rad]."""


EXPONENTS = np.arange(4)
CUBICS = np.zeros((3, 4, 4))
"""Coefficients of 1, xi, xi^2, xi^3 in the shape functions of an element of length 1, by derivative."""
CUBICS[0] = [[1, 0, 0, 0], [0, 1, 0, 0], [-3, -2, 3, -1], [2, 1, -2, 1]]
CUBICS[1, :3] = CUBICS[0, 1:] * np.array([[1], [2], [3]])
CUBICS[2, :3] = CUBICS[1, 1:] * np.array([[1], [2], [3]])

LENGTH_POINTS = 24
"""Gauss points of the length of a curve: 15 digits up to half a turn."""


@cache
def gauss_points(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and weights on [0, 1], shape (count,) each."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def hermite(xi: NDArray[np.float64] | float, length: float, derivative: int = 0) -> NDArray[np.float64]:
    """Shape functions or their derivatives by ``xi``, shape (..., 4): of r, r' of the first node and of the second."""
    powers = np.asarray(xi, dtype=np.float64)[..., None] ** EXPONENTS
    return powers @ CUBICS[derivative] * np.array([1.0, length, 1.0, length])


@dataclass(frozen=True, eq=False)
class ReferenceElement:
    """An element before it is deformed.

    Attributes
    ----------
    length
        Of its axis [m].
    vectors
        Position and tangent of the first and the second node, shape (4, 3).
    straight
        Whether it is.
    """

    length: float
    vectors: NDArray[np.float64]
    straight: bool

    def points(self, xi: NDArray[np.float64] | float, derivative: int = 0) -> NDArray[np.float64]:
        """Positions [m] or their derivatives by ``xi``, shape (..., 3)."""
        return hermite(xi, self.length, derivative) @ self.vectors

    def metric(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """``J = ds / dxi`` [m]."""
        if self.straight:
            return np.full(np.shape(xi), self.length)
        return np.linalg.norm(self.points(xi, 1), axis=-1)

    def slopes(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Rows of ``r'`` by arc length, shape (..., 4)."""
        return hermite(xi, self.length, 1) / self.metric(xi)[..., None]

    def second(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Rows of ``r''`` by arc length, shape (..., 4): ``r_xixi / J^2 - r_xi J_xi / J^3``."""
        metric = self.metric(xi)[..., None]
        rows = hermite(xi, self.length, 2) / metric**2
        if self.straight:
            return rows
        first, second = self.points(xi, 1), self.points(xi, 2)
        rate = np.sum(first * second, axis=-1, keepdims=True) / metric
        return rows - hermite(xi, self.length, 1) * rate / metric**3

    def curvature(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """``|X' x X''|`` [1/m]."""
        if self.straight:
            return np.zeros(np.shape(xi))
        return np.linalg.norm(
            np.cross(self.slopes(xi) @ self.vectors, self.second(xi) @ self.vectors), axis=-1
        )


def reference_element(vectors: NDArray[np.float64]) -> ReferenceElement | None:
    """Element through two nodes, or None if no curve of a sensible length has these tangents.

    Parameters
    ----------
    vectors
        Position and unit tangent of the first and the second node, shape (4, 3).
    """
    chord = vectors[2] - vectors[0]
    length = float(np.linalg.norm(chord))
    if not 0.0 < length < np.inf:
        return None
    direction = chord / length
    if max(np.linalg.norm(vectors[1] - direction), np.linalg.norm(vectors[3] - direction)) < STRAIGHT:
        # equal elements get equal lengths, whatever their nodes are rounded to
        return ReferenceElement(float(f"{length:.13g}"), vectors, straight=True)
    xi, weights = gauss_points(LENGTH_POINTS)
    rows = hermite(xi, 1.0, 1)
    fixed, slopes = rows[:, ::2] @ vectors[::2], rows[:, 1::2] @ vectors[1::2]
    shortest, change = length, np.inf
    for _ in range(20):  # Newton for the length of the curve that it makes
        rates = fixed + length * slopes
        speeds = np.linalg.norm(rates, axis=1)
        gain = weights @ (np.sum(rates * slopes, axis=1) / speeds)
        change = (weights @ speeds - length) / (1.0 - gain)
        length += change
        if abs(change) <= 1e-15 * length:
            break
    usable = abs(change) < 1e-12 * length and 0.999 * shortest < length < 2.0 * shortest
    if not usable or np.min(speeds) < 0.3 * length:  # folded, or turned back
        return None
    return ReferenceElement(length, vectors, straight=False)


# ---- what packing asks of frames ----


UNIT = 1e-6
"""Largest error of the length of a unit tangent."""

PAIRS = np.array([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]).T
"""aa, ab, ac, bb, bc, cc."""


def body_constants(body: FrameBody) -> NDArray[np.float64]:
    """The number of the model."""
    return np.array([float(EXACT if body.model == "exact" else GREEN_LAGRANGE)])


def result_columns(body: FrameBody) -> dict[str, tuple[str, ...]]:
    """Components of what is recorded of all elements; of moments at the first and second node of each."""
    each = tuple(str(e) for e in range(len(body.elements)))
    ends = tuple(f"{e}.{end}" for e in each for end in ("first", "second"))
    return {"axial_force": each, "bending_moment": ends, "axial_stress": each}


def start_coordinates(body: FrameBody) -> NDArray[np.float64]:
    """Position and tangent of every node, shape (n, 2, 3)."""
    tangents = body.tangents / np.linalg.norm(body.tangents, axis=1, keepdims=True)
    return np.stack((body.nodes, tangents), axis=1)


def strain_counts(body: FrameBody) -> NDArray[np.int64]:
    """Strains of every element, shape (e,)."""
    if body.model != "exact":
        return np.full(len(body.elements), AXIAL_POINTS, dtype=np.int64)
    straight = np.array([element.straight for element in references(body)])
    return AXIAL_POINTS + BENDING_POINTS * np.where(straight, 3, 1)


def element_data(body: FrameBody) -> list[NDArray[np.float64]]:
    """Constants of every element; equal elements share one array."""
    known: dict[tuple[int, float, float], NDArray[np.float64]] = {}
    found = []
    for e, element in enumerate(references(body)):
        number = int(body.element_sections[e]) if len(body.element_sections) else 0
        strain = float(body.axial_strains[e]) if len(body.axial_strains) else 0.0
        if not element.straight:
            found.append(_data(element, body.sections[number], strain, body.model == "exact"))
            continue
        key = (number, element.length, strain)
        if key not in known:
            known[key] = _data(element, body.sections[number], strain, body.model == "exact")
        found.append(known[key])
    return found


def element_lengths(body: FrameBody) -> NDArray[np.float64]:
    """Lengths of the axes of all elements, unloaded [m], shape (e,)."""
    return np.array([element.length for element in references(body)])


def load_shape(body: FrameBody, element: int) -> NDArray[np.float64]:
    """Integral of the shape functions along the axis [m] (of slopes: [m2]), shape (4,)."""
    reference = references(body)[element]
    xi, weights = gauss_points(16)
    return (weights * reference.metric(xi)) @ hermite(xi, reference.length)


def shape_values(body: FrameBody, element: int, local: tuple[float, ...], vector: int) -> NDArray[np.float64]:
    """Row of ``r`` (vector 0) or ``r'`` (1) at ``(xi,)``, in [0, 1], over the vectors of the element, shape (4,)."""
    reference = references(body)[element]
    return hermite(local[0], reference.length) if vector == 0 else reference.slopes(local[0])


def locate(body: FrameBody, point: NDArray[np.float64], source: str, key: str) -> tuple[int, tuple[float]]:
    """Element and ``(xi,)`` of a point of the unloaded axis, given in the frame of the body.

    Raises
    ------
    InputError
        If the point is farther from the axis than 1e-6 of the size of the mesh.
    """
    point = np.asarray(point, dtype=np.float64)
    size = float(np.max(np.ptp(body.nodes, axis=0)))
    best, place = np.inf, (0, 0.0)
    first, second = body.nodes[body.elements[:, 0]], body.nodes[body.elements[:, 1]]
    # an element lies within its length of its nodes: look at the near ones only, nearest first
    lower = np.maximum(
        np.minimum(np.linalg.norm(point - first, axis=1), np.linalg.norm(point - second, axis=1))
        - 2.0 * np.linalg.norm(second - first, axis=1),
        0.0,
    )
    for e in np.argsort(lower, kind="stable"):
        if lower[e] > best:
            break
        distance, xi = _nearest(references(body)[e], point)
        if distance < best - 1e-12 * size:
            best, place = distance, (int(e), xi)
    if not best <= 1e-6 * size:
        raise InputError(
            f"the point {point.tolist()} is {best:.3g} m from the axis",
            source=source,
            key=key,
            expected=f"a point of the unloaded axis of {body.name!r}, in its frame",
        )
    return place[0], (place[1],)


def _nearest(element: ReferenceElement, point: NDArray[np.float64]) -> tuple[float, float]:
    """Distance [m] and ``xi`` of the nearest point of an element."""
    if element.straight:
        chord = element.vectors[2] - element.vectors[0]
        xi = float(np.clip((point - element.vectors[0]) @ chord / (chord @ chord), 0.0, 1.0))
    else:
        grid = np.linspace(0.0, 1.0, 33)
        xi = float(grid[np.argmin(np.linalg.norm(element.points(grid) - point, axis=1))])
        for _ in range(20):
            gap, first, second = element.points(xi) - point, element.points(xi, 1), element.points(xi, 2)
            slope = first @ first + gap @ second
            if slope <= 0.0:  # far away, where no answer is needed
                break
            last, xi = xi, float(np.clip(xi - gap @ first / slope, 0.0, 1.0))
            if abs(xi - last) < 1e-15:
                break
    for end in (0.0, 1.0):
        if abs(xi - end) < 1e-9:
            xi = end
    return float(np.linalg.norm(element.points(xi) - point)), xi


@lru_cache(maxsize=16)
def references(body: FrameBody) -> tuple[ReferenceElement, ...]:
    """All elements before they are deformed."""
    vectors = start_coordinates(body)[body.elements].reshape(-1, 4, 3)
    found = []
    for e, nodes in enumerate(body.elements):
        element = reference_element(vectors[e])
        bent = body.model != "exact" and not isinstance(body, RodBody)
        if element is None or (bent and not element.straight):
            wanted = "tangents along the line from its first to its second node"
            raise InputError(
                f"the element between nodes {nodes.tolist()} is "
                + ("turned back" if element is None else "not straight"),
                source=body.name,
                key=f"elements[{e}]",
                expected=f"{wanted} (of a curve: model 'exact')",
            )
        found.append(element)
    return tuple(found)


def load_element_data(element: ReferenceElement, section: FrameSection, strain: float) -> NDArray[np.float64]:
    """Constants of one element of a frame with strains of Green-Lagrange, shape (BENDING,)."""
    return _data(element, section, strain, exact=False)


def _data(
    element: ReferenceElement, section: FrameSection, strain: float, exact: bool
) -> NDArray[np.float64]:
    """Constants of one element, as `frame_data` lists them."""
    data = np.zeros(EXACT_LENGTH if exact else BENDING)
    axial, bending = section.youngs_modulus * section.area, section.youngs_modulus * section.second_moment
    xi, weights = gauss_points(4 if element.straight else 16)  # of the straight one exact: degree 6
    lengths, shape = weights * element.metric(xi), hermite(xi, element.length)
    mass = section.density * section.area * np.einsum("g,ga,gb->ab", lengths, shape, shape)
    numbers = frame_data(data, 0)
    numbers.mass[:] = mass
    if not exact:
        second = element.second(xi)
        numbers.bending[:] = bending * np.einsum("g,ga,gb->ab", lengths, second, second)
    numbers.axial_stiffness, numbers.bending_stiffness, numbers.area = axial, bending, section.area
    numbers.stress = section.outer_fibre / section.second_moment if section.second_moment > 0.0 else 0.0
    numbers.height = section.outer_fibre or np.sqrt(section.second_moment / section.area)
    numbers.curved, numbers.initial_strain = not element.straight, strain
    places = np.linspace(0.0, 1.0, STRESS_PLACES)
    numbers.first[:] = element.slopes(places)[:, [2, 1, 3]]
    numbers.second[:] = element.second(places)[:, [2, 1, 3]]
    numbers.curvature[:] = element.curvature(places)

    xi, weights = gauss_points(AXIAL_POINTS)
    lengths = weights * element.metric(xi)
    shape = element.slopes(xi)[:, [2, 1, 3]]
    products = shape[:, PAIRS[0]] * shape[:, PAIRS[1]]
    stiffness = axial * lengths
    points = data[AXIAL:BENDING].view(AxialPoint.layout)
    points["stiffness"], points["first"] = stiffness, shape
    points["products"] = stiffness[:, None] * products
    points["loads"] = lengths[:, None] * hermite(xi, element.length)

    if exact:
        xi, weights = gauss_points(BENDING_POINTS)
        stiffness = bending * weights * element.metric(xi)
        a, b = element.slopes(xi)[:, [2, 1, 3]], element.second(xi)[:, [2, 1, 3]]
        i, j = PAIRS
        mixed = [1, 2, 4]  # ab, ac, bc
        products = np.hstack(
            (a[:, i] * a[:, j], b[:, i] * b[:, j], a[:, i] * b[:, j], b[:, i[mixed]] * a[:, j[mixed]])
        )
        points = data[BENDING:].view(BendingPoint.layout)
        points["stiffness"], points["curvature"] = stiffness, element.curvature(xi)
        points["first"], points["second"] = a, b
        points["products"] = stiffness[:, None] * products
    return data


# ---- what is refused ----


def check_frame(body: FrameBody) -> None:
    """Everything a user can get wrong in a frame.

    Raises
    ------
    InputError
        The first thing that is wrong: shapes, sections, elements, supports, loads.
    """
    check_line(body)
    references(body)
    check_supports(body, FRAME_VECTORS)


def check_line(body: FrameBody) -> None:
    """What frames with and without torsion have in common: shapes, sections, elements, loads."""
    nodes, elements = np.asarray(body.nodes), np.asarray(body.elements)
    check_finite(body, "nodes", nodes, (len(nodes), 3))
    check_finite(body, "tangents", np.asarray(body.tangents), (len(nodes), 3))
    if elements.ndim != 2 or elements.shape[1] != 2 or not len(elements):
        raise InputError(
            f"shape {elements.shape}", source=body.name, key="elements", expected="shape (e, 2), one or more"
        )
    check_numbers(body, "elements", elements, len(nodes), "node")
    if body.model not in ("green-lagrange", "exact"):
        raise InputError(
            f"{body.model!r}", source=body.name, key="model", expected="'green-lagrange' or 'exact'"
        )
    unused = np.setdiff1d(np.arange(len(nodes)), elements)
    if len(unused):
        raise InputError(
            f"node {unused[0]} belongs to no element",
            source=body.name,
            key=f"nodes[{unused[0]}]",
            expected="nodes of elements only",
        )
    lengths = np.linalg.norm(body.tangents, axis=1)
    for n in np.flatnonzero(np.abs(lengths - 1.0) > UNIT):
        raise InputError(
            f"{body.tangents[n].tolist()} has the length {lengths[n]:.9g}",
            source=body.name,
            key=f"tangents[{n}]",
            expected="a unit vector",
        )
    if len(body.element_sections):
        check_finite(body, "element_sections", np.asarray(body.element_sections), (len(elements),))
        check_numbers(
            body, "element_sections", np.asarray(body.element_sections), len(body.sections), "section"
        )
    if not body.sections:
        raise InputError("none", source=body.name, key="sections", expected="one or more")
    for i, section in enumerate(body.sections):
        _check_section(body, i, section)
    if len(body.axial_strains):
        check_finite(body, "axial_strains", np.asarray(body.axial_strains), (len(elements),))
        if np.any(np.asarray(body.axial_strains) <= -0.5):
            raise InputError(
                f"{np.min(body.axial_strains)}",
                source=body.name,
                key="axial_strains",
                expected="more than -0.5",
            )
    for e in range(len(elements)):
        if elements[e, 0] == elements[e, 1] or np.array_equal(nodes[elements[e, 0]], nodes[elements[e, 1]]):
            raise InputError(
                f"the length between nodes {elements[e].tolist()} is zero",
                source=body.name,
                key=f"elements[{e}]",
                expected="two nodes at different places",
            )
    for i, load in enumerate(body.loads):
        check_load(body, i, load)


def _check_section(body: FrameBody, number: int, section: FrameSection) -> None:
    for key in ("density", "youngs_modulus", "area"):
        if not 0.0 < getattr(section, key) < np.inf:
            raise InputError(
                f"{getattr(section, key)}",
                source=body.name,
                key=f"sections[{number}].{key}",
                expected="a positive number",
            )
    for key in ("second_moment", "outer_fibre"):
        if not 0.0 <= getattr(section, key) < np.inf:
            raise InputError(
                f"{getattr(section, key)}",
                source=body.name,
                key=f"sections[{number}].{key}",
                expected="0 or more",
            )
