"""From a `RodBody` to numbers: checks, element data, material points.

The axis is that of a frame, cubic between its nodes. Directors d and e of the section, fixed in it, are linear between
the nodes. With ``r'`` and ``r''`` by the arc length of the reference, and values of the reference subtracted from all,
the strains of an element of the length L are::

    axial      (r'.r')/2                      at Gauss points          E A ds
    bending    r''.d,  r''.e                  at Gauss points          E I ds
    torsion    (e_1.d_2 - d_1.e_2) / 2 L      of the element           G J L / cos^2 of the twist of the reference
    section    d.d/2, e.e/2, d.e, r'.d, r'.e  at both nodes            E A L/2: sections stay what they are

The strain of torsion is the sine of the part of the rotation between the nodes that is about the axis, over L: bending
adds nothing to it. Directors have the inertia ``rho I`` each, which is that of the section about all its axes. Terms of
order twist^2/6 and angle^2/8 of an element are left out: a few elements a radian.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf import frame_packing
from heavylift.solver.bodies.ancf.frame_data import BENDING
from heavylift.solver.bodies.ancf.frame_packing import (
    ReferenceElement,
    element_lengths,
    gauss_points,
    hermite,
    load_element_data,
    references,
)
from heavylift.solver.bodies.ancf.rod_data import (
    AXIAL_STRAINS,
    BENDING_STRAINS,
    ROD_FRAME,
    ROD_LENGTH,
    ROD_STRAINS,
    STRAIN_LENGTH,
    STRAINS,
    TWIST,
    VECTORS,
    RodStrain,
    rod_data,
    strain_at,
)
from heavylift.solver.bodies.ancf.types import check_finite, check_supports
from heavylift.solver.scene.meshes import ROD_VECTORS, FollowerLoad, FrameSection, RodBody

__all__ = [
    "body_constants",
    "check_rod",
    "element_data",
    "element_lengths",
    "highest_frequency",
    "load_shape",
    "locate",
    "result_columns",
    "shape_values",
    "start_coordinates",
    "strain_counts",
]

UNIT = 1e-6
"""Largest error of the length of a unit normal, and of its right angle with the tangent."""

LARGEST_TWIST = 0.5
"""Of an element in the given shape [rad]."""

OF_AXIS = [0, 1, 4, 5]
"""Vectors of an element that make its axis."""


def body_constants(body: RodBody) -> NDArray[np.float64]:
    """None: all rods have one model."""
    del body
    return np.zeros(1)


def result_columns(body: RodBody) -> dict[str, tuple[str, ...]]:
    """Components of what is recorded of all elements."""
    found = frame_packing.result_columns(body)
    return found | {"twisting_moment": found["axial_force"]}


def start_coordinates(body: RodBody) -> NDArray[np.float64]:
    """Position, tangent and both directors of every node, shape (n, 4, 3)."""
    tangents = body.tangents / np.linalg.norm(body.tangents, axis=1, keepdims=True)
    normals = body.normals - np.sum(body.normals * tangents, axis=1, keepdims=True) * tangents
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return np.stack((body.nodes, tangents, normals, np.cross(tangents, normals)), axis=1)


def strain_counts(body: RodBody) -> NDArray[np.int64]:
    """Strains of every element, shape (e,)."""
    return np.full(len(body.elements), ROD_STRAINS, dtype=np.int64)


def element_data(body: RodBody) -> list[NDArray[np.float64]]:
    """Constants of every element."""
    start = start_coordinates(body)
    found = []
    for e, nodes in enumerate(body.elements):
        number = int(body.element_sections[e]) if len(body.element_sections) else 0
        strain = float(body.axial_strains[e]) if len(body.axial_strains) else 0.0
        found.append(
            _data(references(body)[e], start[nodes].reshape(VECTORS, 3), body.sections[number], strain)
        )
    return found


def load_shape(body: RodBody, element: int) -> NDArray[np.float64]:
    """Integral of the shape functions along the axis, shape (8,)."""
    found = np.zeros(VECTORS)
    found[OF_AXIS] = frame_packing.load_shape(body, element)
    return found


def shape_values(body: RodBody, element: int, local: tuple[float, ...], vector: int) -> NDArray[np.float64]:
    """Row of ``r``, ``r'``, d or e at ``(xi,)`` over the vectors of the element, shape (8,)."""
    found = np.zeros(VECTORS)
    if vector < 2:
        found[OF_AXIS] = frame_packing.shape_values(body, element, local, vector)
    else:
        found[vector], found[4 + vector] = 1.0 - local[0], local[0]
    return found


locate = frame_packing.locate


def _data(
    element: ReferenceElement, vectors: NDArray[np.float64], section: FrameSection, strain: float
) -> NDArray[np.float64]:
    """Constants of one element."""
    data = np.zeros(ROD_LENGTH)
    length = element.length
    own = rod_data(data, 0)
    xi, weights = gauss_points(16)
    lengths = weights * element.metric(xi)
    shape = np.zeros((len(xi), VECTORS))
    shape[:, OF_AXIS] = hermite(xi, length)
    own.mass[:] = section.density * section.area * np.einsum("g,ga,gb->ab", lengths, shape, shape)
    rotary = section.density * section.second_moment
    for director in (2, 3):
        row = _director(xi, director)
        own.mass[:] += rotary * np.einsum("g,ga,gb->ab", lengths, row, row)

    axial, bending = section.youngs_modulus * section.area, section.youngs_modulus * section.second_moment
    number = 0

    def put(
        stiffness: float, height: float, *terms: tuple[NDArray[np.float64], NDArray[np.float64]]
    ) -> RodStrain:
        nonlocal number
        one = strain_at(data, STRAINS + number * STRAIN_LENGTH)
        number += 1
        one.stiffness, one.height = stiffness, height
        for t, (u, w) in enumerate(terms):
            one.left[t], one.right[t] = u, w
            one.products[:] += np.outer(u, w) + np.outer(w, u)
            one.rest += float((u @ vectors) @ (w @ vectors))
        return one

    xi, weights = gauss_points(AXIAL_STRAINS)
    for x, ds in zip(xi, weights * element.metric(xi), strict=True):
        row = _on_axis(element.slopes(x))
        put(axial * ds, 1.0, (0.5 * row, row)).rest -= strain
    xi, weights = gauss_points(BENDING_STRAINS // 2)
    height = section.outer_fibre or float(np.sqrt(section.second_moment / section.area))
    for x, ds in zip(xi, weights * element.metric(xi), strict=True):
        row = _on_axis(element.second(x))
        for director in (2, 3):
            put(bending * ds, height, (row, _director(np.array([x]), director)[0]))
    assert number == TWIST
    d1, e1, d2, e2 = (np.eye(VECTORS)[k] for k in (2, 3, 6, 7))
    sine = 0.5 * (vectors[3] @ vectors[6] - vectors[2] @ vectors[7])
    stiffness = section.torsional_stiffness / (1.0 - sine**2)
    half = 0.5 / length
    put(stiffness * length, height, (half * e1, d2), (-half * d1, e2))
    own.torque = stiffness
    whole = 0.5 * axial * length
    for first in (0, 4):
        t, d, e = (np.eye(VECTORS)[first + k] for k in (1, 2, 3))
        for u, w in ((0.5 * d, d), (0.5 * e, e), (d, e), (t, d), (t, e)):
            put(whole, 1.0, (u, w))
    assert number == ROD_STRAINS
    data[ROD_FRAME : ROD_FRAME + BENDING] = load_element_data(element, section, strain)
    return data


def _on_axis(row: NDArray[np.float64]) -> NDArray[np.float64]:
    """A row of the axis over all vectors, shape (8,)."""
    found = np.zeros(VECTORS)
    found[OF_AXIS] = row
    return found


def _director(xi: NDArray[np.float64], director: int) -> NDArray[np.float64]:
    """Rows of a director over all vectors, shape (g, 8)."""
    found = np.zeros((len(xi), VECTORS))
    found[:, director], found[:, 4 + director] = 1.0 - xi, xi
    return found


def highest_frequency(body: RodBody) -> float:
    """Bound of its circular frequencies [1/s]: that of its stiffest element, unstressed."""
    start = start_coordinates(body)
    largest = 0.0
    for data, nodes in zip(element_data(body), body.elements, strict=True):
        x, own = start[nodes].reshape(VECTORS, 3), rod_data(data, 0)
        K = np.zeros((3 * VECTORS, 3 * VECTORS))
        for number in range(ROD_STRAINS):
            one = strain_at(data, STRAINS + number * STRAIN_LENGTH)
            g = (one.products @ x).ravel()
            K += one.stiffness * np.outer(g, g)
        inverse = np.linalg.inv(np.linalg.cholesky(own.mass))
        A = np.kron(inverse, np.eye(3))
        largest = max(largest, float(np.linalg.eigvalsh(A @ K @ A.T)[-1]))
    return float(np.sqrt(largest))


# ---- what is refused ----


def check_rod(body: RodBody) -> None:
    """Everything a user can get wrong in a frame with torsion.

    Raises
    ------
    InputError
        The first thing that is wrong.
    """
    frame_packing.check_line(body)
    check_supports(body, ROD_VECTORS)
    check_finite(body, "normals", np.asarray(body.normals), (len(body.nodes), 3))
    tangents = body.tangents / np.linalg.norm(body.tangents, axis=1, keepdims=True)
    off = np.abs(np.linalg.norm(body.normals, axis=1) - 1.0) + np.abs(np.sum(body.normals * tangents, axis=1))
    for n in np.flatnonzero(off > UNIT):
        raise InputError(
            f"{body.normals[n].tolist()}",
            source=body.name,
            key=f"normals[{n}]",
            expected="a unit vector square to the tangent there",
        )
    if body.model != "green-lagrange":
        raise InputError(
            f"{body.model!r}", source=body.name, key="model", expected="'green-lagrange' with torsion"
        )
    if body.elasticity == "explicit":
        raise InputError(
            "'explicit'", source=body.name, key="elasticity", expected="another one: its sections are stiff"
        )
    for i, section in enumerate(body.sections):
        for key in ("torsional_stiffness", "second_moment"):
            if not 0.0 < getattr(section, key) < np.inf:
                raise InputError(
                    f"{getattr(section, key)}",
                    source=body.name,
                    key=f"sections[{i}].{key}",
                    expected="a positive number with torsion",
                )
    for i, load in enumerate(body.loads):
        if isinstance(load, FollowerLoad):
            raise InputError(
                "a follower load",
                source=body.name,
                key=f"loads[{i}]",
                expected="dead loads, or forces on points in axes of the body; a frame without torsion takes followers",
            )
    start = start_coordinates(body)[body.elements]
    sine = 0.5 * np.sum(start[:, 0, 3] * start[:, 1, 2] - start[:, 0, 2] * start[:, 1, 3], axis=1)
    cosine = np.sum(start[:, 0, 2] * start[:, 1, 2], axis=1)
    for e in np.flatnonzero((np.abs(sine) > np.sin(LARGEST_TWIST)) | (cosine < 0.0)):
        raise InputError(
            f"an element that is twisted by {np.degrees(np.arctan2(sine[e], cosine[e])):.3g} deg",
            source=body.name,
            key=f"elements[{e}]",
            expected=f"{np.degrees(LARGEST_TWIST):.3g} deg at most: more elements",
        )
