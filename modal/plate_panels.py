"""Plate panels between stiffeners and other plates, and their elastic buckling by mean stresses.

A panel is a plane part of one property and thickness that no stiffener, other plate or edge divides. Its reference
stress is ``sigma_e = pi^2 E / (12 (1 - nu^2)) (t/b)^2`` with the sides a >= b; buckling stresses are ``k sigma_e`` with

* along a, over the width b: ``k = 8.4 / (psi + 1.1)`` for 0 <= psi <= 1, ``7.63 - psi (6.26 - 10 psi)`` for
  -1 <= psi < 0;
* across: ``k = (1 + b^2/a^2)^2 2.1 / (psi + 1.1)`` for 0 <= psi <= 1, below 0 that of 0, less than it would be;
* shear: ``k = 5.34 + 4 (b/a)^2``,

psi the ratio of the stresses at both edges, that of the larger compression below (simply supported edges; rules of
classification societies for hull structures, as those of Germanischer Lloyd). Where that is beyond half of the yield
strength it is ``f_y (1 - f_y / (4 k sigma_e))`` (Johnson and Ostenfeld), with ``f_y / sqrt(3)`` for shear. Together
``sigma_x / sigma_cx + sigma_y / sigma_cy + (tau / tau_c)^2`` of compression alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.preprocess.structures.stress import shell_stress

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.material import Material
    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.preprocess.structures.structure import Shells, Structure

__all__ = ["PlatePanels", "panel_use", "plate_panels"]

_PLANE = np.cos(np.radians(2.0))  # between normals of neighbours in one panel
_RECTANGLE = 0.85  # of the rectangle around it: what a panel fills at least


class PlatePanels(NamedTuple):
    """Rectangular panels of plates.

    Attributes
    ----------
    group
        Names of their properties.
    centre
        [m], shape (np, 3).
    length, width, thickness
        a >= b and t [m], shape (np,).
    modulus
        ``pi^2 E / (12 (1 - nu^2))`` [Pa], shape (np,).
    operator
        Mean of sigma_x along a, its slope over the width times b/2, mean of sigma_y, its slope over the length times
        a/2, mean of tau [Pa] from the degrees of freedom, sparse (5 np, N).
    others
        How many regions are no rectangles and are left out.
    """

    group: tuple[str, ...]
    centre: NDArray[np.float64]
    length: NDArray[np.float64]
    width: NDArray[np.float64]
    thickness: NDArray[np.float64]
    modulus: NDArray[np.float64]
    operator: csr_array
    others: int


def plate_panels(model: FEModel, names: Collection[str] | None = None) -> PlatePanels:
    """Panels of the plates of a structure, of some properties, or of all of them.

    Parameters
    ----------
    model
        Finite element model with its structure.
    names
        Of properties; all if None.
    """
    from scipy.sparse import csr_array, vstack

    structure = model.structure
    assert structure is not None
    borders = _borders(structure)
    parts: dict[tuple[str, Material], list[Shells]] = {}
    for shells in structure.shells:
        if len(shells.elements) and shells.stretches and (names is None or shells.name in names):
            parts.setdefault((shells.name, shells.material), []).append(shells)
    found = [_panels_of(model, structure, some, borders) for some in parts.values()]
    if not found:
        none = np.empty(0)
        return PlatePanels((), none.reshape(0, 3), none, none, none, none, csr_array((0, model.dof_count)), 0)
    return PlatePanels(
        group=tuple(name for one in found for name in one.group),
        centre=np.concatenate([one.centre for one in found]),
        length=np.concatenate([one.length for one in found]),
        width=np.concatenate([one.width for one in found]),
        thickness=np.concatenate([one.thickness for one in found]),
        modulus=np.concatenate([one.modulus for one in found]),
        operator=csr_array(vstack([one.operator for one in found], format="csr")),
        others=sum(one.others for one in found),
    )


def panel_use(
    panels: PlatePanels, stresses: NDArray[np.float64], strength: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Utilisation of panels by their buckling stresses, shape (records, np).

    Parameters
    ----------
    panels
        The panels.
    stresses
        What their operator gives, shape (records, np, 5) [Pa], tension positive.
    strength
        Yield strength of each [Pa], shape (np,); no numbers, or None, where it is not known: elastic buckling alone.
    """
    reference = panels.modulus * (panels.thickness / panels.width) ** 2
    slender = panels.width / panels.length
    yields = np.full(len(reference), np.nan) if strength is None else strength

    along, psi = _compression(stresses[..., 0], stresses[..., 1])
    low = np.maximum(psi, -1.0)
    k = np.where(psi >= 0.0, 8.4 / (np.maximum(psi, 0.0) + 1.1), 7.63 - low * (6.26 - 10.0 * low))
    used = along / _critical(k * reference, yields)
    across, psi = _compression(stresses[..., 2], stresses[..., 3])
    k = (1.0 + slender**2) ** 2 * 2.1 / (np.maximum(psi, 0.0) + 1.1)
    used = used + across / _critical(k * reference, yields)
    shear = _critical((5.34 + 4.0 * slender**2) * reference, yields / np.sqrt(3.0))
    return np.asarray(used + (stresses[..., 4] / shear) ** 2)


def _compression(
    mean: NDArray[np.float64], half: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Larger compression at two edges with ``mean + half`` and ``mean - half``, at least 0, and psi there."""
    first, second = -mean + np.abs(half), -mean - np.abs(half)
    pressed = np.maximum(first, 0.0)
    psi = np.divide(second, first, out=np.ones_like(first), where=first > 0.0)
    return pressed, np.clip(psi, -np.inf, 1.0)


def _critical(elastic: NDArray[np.float64], strength: NDArray[np.float64]) -> NDArray[np.float64]:
    """Elastic buckling stress, less where it is beyond half of the strength."""
    reduced = strength * (1.0 - strength / (4.0 * elastic))
    return np.where(elastic > 0.5 * strength, reduced, elastic)


def _borders(structure: Structure) -> NDArray[np.int64]:
    """Edges with a stiffener, or with other than two plates: keys ``lower node * n + higher node``, sorted."""
    keys = [_keys(structure, part.elements) for part in structure.shells]
    every, count = np.unique(
        np.concatenate([np.empty(0, dtype=np.int64), *(key.ravel() for key in keys)]), return_counts=True
    )
    lines = [_key(structure, part.elements[:, 0], part.elements[:, 1]) for part in structure.beams]
    return np.unique(np.concatenate([every[count != 2], *lines]))


def _key(structure: Structure, a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.asarray(np.minimum(a, b) * structure.node_count + np.maximum(a, b))


def _keys(structure: Structure, elements: NDArray[np.int64]) -> NDArray[np.int64]:
    """Keys of the edges of elements, shape (ne, corners)."""
    return _key(structure, elements, np.roll(elements, -1, axis=1))


class _Elements(NamedTuple):
    """Plate elements of one property, quadrilaterals and triangles.

    Attributes
    ----------
    owner, key, pair
        Of all edges: element (k,), key (k,), and nodes (k, 2).
    middle, area, thickness, axes
        Of the elements: means of the corners [m] (ne, 3), (ne,) [m2], (ne,) [m], (ne, 3, 3).
    membrane
        Stress at the centres, sparse (3 ne, N).
    """

    owner: NDArray[np.int64]
    key: NDArray[np.int64]
    pair: NDArray[np.int64]
    middle: NDArray[np.float64]
    area: NDArray[np.float64]
    thickness: NDArray[np.float64]
    axes: NDArray[np.float64]
    membrane: csr_array


def _elements(model: FEModel, structure: Structure, parts: Sequence[Shells]) -> _Elements:
    from scipy.sparse import csr_array, vstack

    owners, keys, pairs, middles, areas = [], [], [], [], []
    stresses = [shell_stress(structure, shells, model, at="centres") for shells in parts]
    first = 0
    for shells in parts:
        ne, width = shells.elements.shape
        owners.append(np.repeat(first + np.arange(ne), width))
        keys.append(_keys(structure, shells.elements).ravel())
        pairs.append(np.stack([shells.elements, np.roll(shells.elements, -1, axis=1)], axis=2).reshape(-1, 2))
        corners = structure.nodes[shells.elements]
        middles.append(corners.mean(axis=1))
        diagonal = corners[:, 3] - corners[:, 1] if width == 4 else corners[:, 2] - corners[:, 1]
        across = np.cross(corners[:, 2] - corners[:, 0], diagonal)
        areas.append(0.5 * np.linalg.norm(across, axis=1))
        first += ne
    return _Elements(
        np.concatenate(owners),
        np.concatenate(keys),
        np.concatenate(pairs),
        np.concatenate(middles),
        np.concatenate(areas),
        np.concatenate([one.thickness for one in stresses]),
        np.concatenate([one.axes for one in stresses]),
        csr_array(vstack([one.membrane for one in stresses], format="csr")),
    )


def _panels_of(
    model: FEModel, structure: Structure, parts: Sequence[Shells], borders: NDArray[np.int64]
) -> PlatePanels:
    """Panels of one property and material."""
    from scipy.sparse import coo_array, csr_array
    from scipy.sparse.csgraph import connected_components

    plates = _elements(model, structure, parts)
    ne, area, normal = len(plates.area), plates.area, plates.axes[:, 2]
    inner = ~np.isin(plates.key, borders)
    order = np.argsort(plates.key[inner], kind="stable")
    owner, key = plates.owner[inner][order], plates.key[inner][order]
    same = key[1:] == key[:-1]
    first, second = owner[:-1][same], owner[1:][same]
    plane = np.abs(np.einsum("pi,pi->p", normal[first], normal[second])) >= _PLANE
    plane &= plates.thickness[first] == plates.thickness[second]
    graph = coo_array((np.ones(int(plane.sum())), (first[plane], second[plane])), shape=(ne, ne))
    count, label = connected_components(graph, directed=False)

    outer = _outline(label, plates)
    centres, lengths, widths, thick, rows = [], [], [], [], []
    others = 0
    members = np.split(np.argsort(label, kind="stable"), np.cumsum(np.bincount(label, minlength=count))[:-1])
    for panel, own in enumerate(members):
        shape = _rectangle(structure.nodes, outer[panel], normal[own[0]], float(area[own].sum()))
        if shape is None:
            others += 1
            continue
        centre, axes, a, b = shape
        local = (plates.middle[own] - centre) @ axes.T
        c = plates.axes[own, 0] @ axes[0]
        s = plates.axes[own, 1] @ axes[0]
        w = area[own] / area[own].sum()
        turned = np.stack(
            [
                np.stack([c * c, s * s, 2.0 * c * s], axis=1),
                np.stack([s * s, c * c, -2.0 * c * s], axis=1),
                np.stack([-c * s, c * s, c * c - s * s], axis=1),
            ],
            axis=1,
        )
        # of a linear stress: slope by least squares over the coordinate, times half of the side
        y, x = local[:, 1] - w @ local[:, 1], local[:, 0] - w @ local[:, 0]
        over_y = w * y / max(float(w @ y**2), 1e-12 * b * b) * (0.5 * b)
        over_x = w * x / max(float(w @ x**2), 1e-12 * a * a) * (0.5 * a)
        weights = np.stack(
            [
                w[:, None] * turned[:, 0],
                over_y[:, None] * turned[:, 0],
                w[:, None] * turned[:, 1],
                over_x[:, None] * turned[:, 1],
                w[:, None] * turned[:, 2],
            ]
        )
        columns = (3 * own[:, None] + np.arange(3)).ravel()
        rows.append((weights.reshape(5, -1), columns))
        centres.append(centre)
        lengths.append(a)
        widths.append(b)
        thick.append(float(plates.thickness[own[0]]))
    combine = csr_array((0, 3 * ne))
    if rows:
        data = np.concatenate([values.ravel() for values, _ in rows])
        index = np.concatenate([np.tile(columns, 5) for _, columns in rows])
        starts = np.concatenate([[0], np.cumsum(np.repeat([len(columns) for _, columns in rows], 5))])
        combine = csr_array((data, index, starts), shape=(5 * len(rows), 3 * ne))
    E, nu = parts[0].material.young_modulus, parts[0].material.poisson_ratio
    return PlatePanels(
        group=(parts[0].name,) * len(rows),
        centre=np.array(centres).reshape(-1, 3),
        length=np.array(lengths),
        width=np.array(widths),
        thickness=np.array(thick),
        modulus=np.full(len(rows), np.pi**2 * E / (12.0 * (1.0 - nu**2))),
        operator=csr_array(combine @ plates.membrane),
        others=others,
    )


def _outline(label: NDArray[np.int64], plates: _Elements) -> list[NDArray[np.int64]]:
    """Edges of each region that only one of its elements has, as pairs of nodes (k, 2)."""
    region = label[plates.owner]
    _, which, count = np.unique(
        np.column_stack([region, plates.key]), axis=0, return_inverse=True, return_counts=True
    )
    alone = count[which.ravel()] == 1
    order = np.argsort(region[alone], kind="stable")
    ends = np.cumsum(np.bincount(region[alone], minlength=int(label.max(initial=-1)) + 1))
    return np.split(plates.pair[alone][order], ends[:-1])


def _rectangle(
    nodes: NDArray[np.float64], outline: NDArray[np.int64], normal: NDArray[np.float64], area: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float] | None:
    """Centre, axes (long, short, normal) and sides of the rectangle around a region; None if it does not fill it."""
    along = nodes[outline[:, 1]] - nodes[outline[:, 0]]
    along = along - (along @ normal)[:, None] * normal
    # directions of the edges count by their lengths, opposite and square ones as the same: four times their angle
    e1 = along[int(np.argmax(np.einsum("ki,ki->k", along, along)))]
    e1 = e1 / np.linalg.norm(e1)
    e2 = np.cross(normal, e1)
    z = (along @ e1) + 1j * (along @ e2)
    size = np.abs(z)
    turn = np.angle(np.sum(size * (z / np.where(size > 0.0, size, 1.0)) ** 4)) / 4.0
    first = np.cos(turn) * e1 + np.sin(turn) * e2
    second = np.cross(normal, first)
    local = nodes[np.unique(outline)] @ np.stack([first, second, normal]).T
    low, high = local.min(axis=0), local.max(axis=0)
    a, b = float(high[0] - low[0]), float(high[1] - low[1])
    if area < _RECTANGLE * a * b:
        return None
    centre = 0.5 * (low + high) @ np.stack([first, second, normal])
    if b > a:
        first, second, a, b = second, -first, b, a
    return centre, np.stack([first, second, normal]), a, b
