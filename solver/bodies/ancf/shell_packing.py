"""Shells become numbers for the compiled elements; material points of shells."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.shell_checks import check_shell
from heavylift.solver.bodies.ancf.shell_data import STRAINS_PER_LINE, tables
from heavylift.solver.bodies.ancf.shell_reference import (
    FlatShape,
    element_blocks,
    flat_shape,
    load_integrals,
    shapes,
    vector_scales,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.scene.meshes import ShellBody

__all__ = [
    "body_constants",
    "check_shell",
    "element_data",
    "load_shape",
    "locate",
    "result_columns",
    "shape_values",
    "start_coordinates",
    "strain_counts",
]

FOUND = 1e-6
"""Largest distance of a material point from the mesh, by the size of the mesh."""

NEWTON_STEPS = 40


def element_data(body: ShellBody) -> list[NDArray[np.float64]]:
    """Mass matrix, bending matrix and numbers of each element; equal elements share one array."""
    return element_blocks(body)


def body_constants(body: ShellBody) -> NDArray[np.float64]:
    """Functions at the Gauss points."""
    return tables(body.gauss_points)


def strain_counts(body: ShellBody) -> NDArray[np.int64]:
    """Places of strains of each element: eight lanes of three strains for each line of Gauss points."""
    return np.full(len(body.elements), STRAINS_PER_LINE * body.gauss_points, dtype=np.int64)


def start_coordinates(body: ShellBody) -> NDArray[np.float64]:
    """``r``, ``r_x``, ``r_y`` and ``r_xy`` of the nodes of the unloaded shape, shape (n, 4, 3)."""
    return np.concatenate([body.nodes[:, np.newaxis], body.slopes], axis=1)


def shape_values(body: ShellBody, element: int, local: tuple[float, ...], vector: int) -> NDArray[np.float64]:
    """Share of each nodal vector of an element in a vector at a point of it, shape (16,).

    Parameters
    ----------
    body, element
        The shell, number of its element.
    local
        Place along its two directions, from 0 to 1.
    vector
        0: position, 1: ``r_x``, 2: ``r_y``, 3: ``r_xy``.
    """
    along_x, along_y = ((0, 0), (1, 0), (0, 1), (1, 1))[vector]
    a, b = body.lengths[element]
    values = _unit_shapes(local[0], local[1], along_x, along_y)
    return values * vector_scales(body.lengths[element : element + 1])[0] / (a**along_x * b**along_y)


@lru_cache(maxsize=4096)
def _unit_shapes(xi: float, eta: float, along_xi: int, along_eta: int) -> NDArray[np.float64]:
    """`shapes` at one point; surfaces ask for the same ones in each element."""
    values = shapes(np.array([xi]), np.array([eta]), along_xi, along_eta)[0]
    values.flags.writeable = False
    return values


def load_shape(body: ShellBody, element: int) -> NDArray[np.float64]:
    """``int S dA`` over the unloaded area of an element, shape (16,)."""
    return load_integrals(body)[element]


def locate(
    body: ShellBody, point: NDArray[np.float64], source: str, key: str
) -> tuple[int, tuple[float, float]]:
    """The element at a point of the unloaded shape, and the place on it.

    Parameters
    ----------
    body
        The shell.
    point
        In its frame [m], shape (3,).
    source, key
        What to call the point in an error.

    Raises
    ------
    InputError
        If the point is farther from the shell than a millionth of its size.
    """
    point = np.asarray(point, dtype=np.float64)
    shape = flat_shape(body)
    relative = np.einsum("ek,eak->ea", point - shape.origins, shape.axes)
    middle = np.array([0.5])
    centres = np.einsum("n,enx->ex", shapes(middle, middle, 0, 0)[0], shape.vectors)
    offsets = np.hypot(np.linalg.norm(relative[:, :2] - centres, axis=1), relative[:, 2])
    size = float(np.linalg.norm(np.ptp(body.nodes, axis=0)))
    reach = body.lengths.max() + np.linalg.norm(np.ptp(shape.vectors[:, ::4], axis=1), axis=1).max()
    best = (np.inf, 0, (0.0, 0.0))
    for element in np.argsort(offsets, kind="stable"):
        if not offsets[element] <= offsets.min() + reach:
            break
        local = _inverse(shape, int(element), relative[element, :2])
        at = shapes(local[:1], local[1:], 0, 0)[0] @ shape.vectors[element]
        distance = float(np.hypot(np.linalg.norm(relative[element, :2] - at), relative[element, 2]))
        if distance < best[0]:
            best = (distance, int(element), (float(local[0]), float(local[1])))
        if distance <= 1e-3 * FOUND * size:
            break
    if not best[0] <= FOUND * size:
        raise InputError(
            f"the point {np.round(point, 9).tolist()} is {best[0]:.6g} m away from the shell {body.name!r}",
            source=source,
            key=key,
            expected=f"a point of its middle surface, to {FOUND * size:.3g} m",
        )
    return best[1], best[2]


def _inverse(shape: FlatShape, element: int, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Place of a point of the plane on an element, by Newton's method from its centre; the nearest if outside."""
    vectors = shape.vectors[element]
    local = np.array([0.5, 0.5])
    for _ in range(NEWTON_STEPS):
        x, y = local[:1], local[1:]
        rest = point - shapes(x, y, 0, 0)[0] @ vectors
        J = np.stack([shapes(x, y, 1, 0)[0] @ vectors, shapes(x, y, 0, 1)[0] @ vectors], axis=1)
        step = np.linalg.lstsq(J, rest, rcond=None)[0]
        before, local = local, np.clip(local + step, -0.25, 1.25)
        if np.all(np.abs(local - before) <= 1e-14):
            break
    return np.clip(local, 0.0, 1.0)


def result_columns(body: ShellBody) -> dict[str, tuple[str, ...]]:
    """Components of what is recorded of all elements, at their centres.

    Axes are those of the surface, the first along the lines of the mesh direction x; moments are those of
    curvatures along ``n = r_x x r_y``, whose side is the top.
    """
    elements = range(len(body.elements))
    parts = tuple(f"{e}.{axes}" for e in elements for axes in ("xx", "yy", "xy"))
    sides = tuple(f"{e}.{side}" for e in elements for side in ("top", "middle", "bottom"))
    return {"membrane_force": parts, "bending_moment": parts, "von_mises": sides}
