"""What is refused of a shell before it becomes numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.mesh_checks import check_load, check_numbers, check_supports
from heavylift.solver.bodies.ancf.shell_data import gauss_rule
from heavylift.solver.bodies.ancf.shell_reference import FlatShape, flat_shape, grid, section_numbers, shapes
from heavylift.solver.scene.meshes import SHELL_VECTORS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.scene.meshes import ShellBody

__all__ = ["check_shell"]

FLAT = 1e-6
"""Largest distance of an unloaded element from its plane, by its length."""

SQUASHED = 1e-6
"""Smallest area of the map of an element at a point, by its lengths."""

SAME = 1e-9
"""Relative difference of lengths that count as equal."""

GAUSS_POINTS = (3, 7)


def check_shell(body: ShellBody) -> None:
    """Refuse a shell that cannot be packed.

    Raises
    ------
    InputError
        Names the body, the key with the number of the element, node or section, the value and what was expected.
    """
    _check_arrays(body)
    _check_sections(body)
    check_supports(body, SHELL_VECTORS)
    for number, load in enumerate(body.loads):
        check_load(body, number, load)
    _check_edges(body)
    _check_shape(body)


def _fail(body: ShellBody, key: str, problem: str, expected: str) -> None:
    raise InputError(problem, source=body.name, key=key, expected=expected)


def _check_arrays(body: ShellBody) -> None:
    n, e = len(body.nodes), len(body.elements)
    if n == 0 or e == 0:
        _fail(body, "elements", f"{n} nodes and {e} elements", "one element or more")
    wanted: list[tuple[str, Any, tuple[int, ...]]] = [
        ("nodes", body.nodes, (n, 3)),
        ("slopes", body.slopes, (n, 3, 3)),
        ("elements", body.elements, (e, 4)),
        ("lengths", body.lengths, (e, 2)),
    ]
    for key, values, shape in wanted:
        array = np.asarray(values)
        if array.shape != shape:
            _fail(body, key, f"shape {array.shape}", f"{shape}")
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            _fail(body, f"{key}[{bad[0][0]}]", f"{array[tuple(bad[0])]}", "finite numbers")
    if np.asarray(body.elements).dtype.kind not in "iu":
        _fail(body, "elements", f"numbers of type {np.asarray(body.elements).dtype}", "whole numbers")
    for number, nodes in enumerate(body.elements):
        if not (np.all(nodes >= 0) and np.all(nodes < n)):
            _fail(body, f"elements[{number}]", f"nodes {nodes.tolist()}", f"numbers from 0 to {n - 1}")
        if len(set(nodes.tolist())) < 4:
            _fail(body, f"elements[{number}]", f"nodes {nodes.tolist()}", "four different nodes")
    loose = np.setdiff1d(np.arange(n), body.elements)
    if len(loose):
        _fail(body, f"nodes[{loose[0]}]", "it belongs to no element", "nodes of elements only")
    short = np.flatnonzero(~np.all(body.lengths > 0.0, axis=1))
    if len(short):
        _fail(body, f"lengths[{short[0]}]", f"{body.lengths[short[0]].tolist()}", "positive lengths")
    low, high = GAUSS_POINTS
    if not isinstance(body.gauss_points, int) or body.gauss_points not in range(low, high + 1):
        _fail(body, "gauss_points", f"{body.gauss_points}", f"a whole number from {low} to {high}")


def _check_sections(body: ShellBody) -> None:
    if not body.sections:
        _fail(body, "sections", "there are none", "one section or more")
    for number, section in enumerate(body.sections):
        key = f"sections[{number}]"
        for name in ("thickness", "density", "youngs_modulus"):
            value = getattr(section, name)
            if not 0.0 < value < np.inf:
                _fail(body, f"{key}.{name}", f"{value}", "a positive number")
        if not -1.0 < section.poissons_ratio < 0.5:
            _fail(
                body, f"{key}.poissons_ratio", f"{section.poissons_ratio}", "more than -1 and less than 0.5"
            )
    given = len(body.element_sections)
    if given not in (0, len(body.elements)):
        _fail(
            body,
            "element_sections",
            f"{given} numbers",
            f"one for each of {len(body.elements)} elements, or none",
        )
    if given:
        check_numbers(
            body, "element_sections", np.asarray(body.element_sections), len(body.sections), "section"
        )
    numbers = section_numbers(body)
    bad = np.flatnonzero((numbers < 0) | (numbers >= len(body.sections)))
    if len(bad):
        last = len(body.sections) - 1
        _fail(body, f"element_sections[{bad[0]}]", f"{numbers[bad[0]]}", f"a number from 0 to {last}")


def _check_edges(body: ShellBody) -> None:
    """Slopes of a node serve all its elements, so edges in common have one direction and length."""
    known: dict[tuple[int, int], tuple[int, int, float]] = {}
    for number, ((n0, n1, n2, n3), (a, b)) in enumerate(
        zip(body.elements.tolist(), body.lengths.tolist(), strict=True)
    ):
        for start, end, direction, length in ((n0, n1, 0, a), (n3, n2, 0, a), (n0, n3, 1, b), (n1, n2, 1, b)):
            other, along, before = known.setdefault((start, end), (number, direction, length))
            if (end, start) in known:
                other, along, _ = known[end, start]
                along = 1 - direction  # runs the other way: as wrong as another direction
            if along != direction:
                _fail(
                    body,
                    f"elements[{number}]",
                    f"its edge of nodes {start} and {end} runs otherwise in element {other}",
                    "the same direction and sense of the mesh on both sides",
                )
            if abs(length - before) > SAME * before:
                _fail(
                    body,
                    f"lengths[{number}]",
                    f"{length} m on the edge of nodes {start} and {end}, {before} m in element {other}",
                    "the same length on both sides: the slopes of the nodes refer to it",
                )


def _check_shape(body: ShellBody) -> None:
    shape = flat_shape(body)
    size = body.lengths.max(axis=1)
    smallest = _smallest_areas(shape, body.gauss_points) / body.lengths.prod(axis=1)
    inverted = np.flatnonzero(~(smallest > SQUASHED))
    if len(inverted):
        first = inverted[0]
        _fail(
            body,
            f"elements[{first}]",
            f"it is inverted or has no area somewhere: {smallest[first]:.3g} of its lengths",
            "nodes in the order origin, along x, opposite, along y, corners below 180 degrees, slopes that fit",
        )
    bent = np.flatnonzero(~(shape.off_plane <= FLAT * size))
    if len(bent):
        first = bent[0]
        _fail(
            body,
            f"elements[{first}]",
            f"it is not flat: {shape.off_plane[first]:.3g} m off its plane",
            "nodes and slopes of an unloaded element in one plane",
        )


def _smallest_areas(shape: FlatShape, gauss_points: int) -> NDArray[np.float64]:
    """Smallest area of the map from the unit square, at Gauss points and corners, shape (e,)."""
    points = np.concatenate([gauss_rule(gauss_points)[0], gauss_rule(8)[0], [0.0, 1.0]])
    xi, eta = grid(points)
    X_1 = np.einsum("pn,enx->epx", shapes(xi, eta, 1, 0), shape.vectors)
    X_2 = np.einsum("pn,enx->epx", shapes(xi, eta, 0, 1), shape.vectors)
    return (X_1[..., 0] * X_2[..., 1] - X_1[..., 1] * X_2[..., 0]).min(axis=1)
