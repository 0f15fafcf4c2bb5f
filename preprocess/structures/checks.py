"""What a structure must be before it is assembled, and what its user is told of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.structures.constraints import node_words
from heavylift.preprocess.structures.places import distances_to_triangles
from heavylift.preprocess.structures.quadrilateral import corner_jacobians, facet_axes
from heavylift.preprocess.structures.triangle import triangle_axes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.structures.structure import Beams, Shells, Structure

__all__ = ["check_structure"]

TRIANGLE_SHARE = 0.05
"""Of all plates: more triangles are told of, as they are stiff where plates are curved and coarse."""
WARP = 0.05
"""Distance of the corners from the mean plane over the mean edge that is told of."""
ASPECT = 10.0
"""Longest over shortest edge of a plate that is told of."""
SHARPEST = np.radians(30.0)
"""Smallest angle at a corner of a quadrilateral that is told of [rad]."""
THICKEST = 0.5
"""Thickness over the size of the structure beyond which it is in other units than the nodes."""
SAME_PLACE = 1e-6
"""Of the size of the structure: nodes so near are at one place, and an edge lies on a plate."""

_PLACES = 3  # places that a sentence names


def check_structure(structure: Structure) -> tuple[str, ...]:
    """Refuse a structure that is no sound body, and return what is worth telling, one sentence each.

    Raises
    ------
    InputError
        No elements; plates that are flat, folded or inverted, with a node twice, or there twice; thickness in other
        units; nodes in nothing; parts that nothing joins; edges that end at one place with others and are not joined.

    Notes
    -----
    What links contradict, orientations of beams and thickness are checked where they are used, by `assemble_structure`.
    """
    if not structure.element_count:
        raise InputError(
            "has no plates, beams or solids", source=_source(structure), expected="at least one element"
        )
    notes: list[str] = []
    size = float(np.ptp(structure.nodes, axis=0).max())
    for part in structure.shells:
        if len(part.elements):
            _check_shapes(structure, part, size)
            notes += _shape_notes(structure, part)
    for kind, parts in (("plate", structure.shells), ("beam", structure.beams)):
        _refuse_twice(structure, kind, parts)
    joined = _labels(structure)
    _refuse_loose_nodes(structure)
    _refuse_parts(structure, joined, size)
    notes += _edge_notes(structure, size)
    notes += _normal_notes(structure)
    notes += _hinge_notes(structure)
    triangles = sum(len(part.elements) for part in structure.shells if part.elements.shape[1] == 3)
    plates = sum(len(part.elements) for part in structure.shells)
    if triangles > TRIANGLE_SHARE * plates:
        notes.append(
            f"{triangles / plates:.0%} of the plates are triangles, which are stiff on curved coarse meshes: "
            f"quadrilaterals with under {TRIANGLE_SHARE:.0%} of them are better"
        )
    return tuple(notes)


def _source(structure: Structure) -> str:
    return structure.name or "structure"


def _element_words(structure: Structure, kind: str, part: Shells | Beams, index: int) -> str:
    number = int(part.numbers[index]) if part.numbers.size else index + 1
    x, y, z = structure.nodes[part.elements[index]].mean(axis=0)
    return f"{kind} {number} of {part.name} at ({x:.6g}, {y:.6g}, {z:.6g}) m"


def _places(positions: NDArray[np.float64]) -> str:
    """Some places in words [m]."""
    words = ", ".join(f"({x:.6g}, {y:.6g}, {z:.6g})" for x, y, z in positions[:_PLACES])
    return f"at {words} m" + (f" and {len(positions) - _PLACES} more" if len(positions) > _PLACES else "")


def _check_shapes(structure: Structure, part: Shells, size: float) -> None:
    """Refuse plates with a node twice, folded, inverted or without area, and thickness in other units."""
    elements = part.elements
    ordered = np.sort(elements, axis=1)
    repeated = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
    if repeated.any():
        raise InputError(
            f"has a node twice ({int(repeated.sum())} such plates)",
            source=_source(structure),
            key=_element_words(structure, "plate", part, int(np.argmax(repeated))),
            expected="different nodes: a quadrilateral with two nodes in one is a triangle",
        )
    corners = structure.nodes[elements]
    with np.errstate(invalid="ignore", divide="ignore"):
        if elements.shape[1] == 4:
            area = corner_jacobians(corners)
            wrong = ~(area > 0.0).all(axis=1)
        else:
            wrong = ~np.isfinite(triangle_axes(corners)).all(axis=(1, 2))
    if wrong.any():
        raise InputError(
            f"has a Jacobian determinant that is not positive ({int(wrong.sum())} such plates)",
            source=_source(structure),
            key=_element_words(structure, "plate", part, int(np.argmax(wrong))),
            expected="convex plates with an area, their nodes in turn around them",
        )
    thickness = np.broadcast_to(np.asarray(part.thickness, dtype=np.float64), (len(elements),))
    thick = thickness > THICKEST * size
    if thick.any():
        raise InputError(
            f"is {thickness[thick][0]:g} m thick, the structure {size:g} m long",
            source=_source(structure),
            key=_element_words(structure, "plate", part, int(np.argmax(thick))),
            expected="thickness and nodes in the same unit",
        )


def _shape_notes(structure: Structure, part: Shells) -> list[str]:
    """Tell of warped, long and sharp plates."""
    corners = structure.nodes[part.elements]
    edges = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(edges, axis=2)
    found = [
        (
            "have edges longer than",
            f"{ASPECT:g} times others",
            length.max(axis=1) > ASPECT * length.min(axis=1),
        )
    ]
    if part.elements.shape[1] == 4:
        height = np.abs(
            np.einsum("ei,ei->e", corners[:, 0] - corners.mean(axis=1), facet_axes(corners)[:, 2])
        )
        found.append(
            ("are warped by more than", f"{WARP:.0%} of their edges", height > WARP * length.mean(axis=1))
        )
        along = edges / length[..., None]
        cosine = (-np.einsum("eki,eki->ek", along, np.roll(along, 1, axis=1))).max(axis=1)
        sharp = np.arccos(np.clip(cosine, -1.0, 1.0)) < SHARPEST
        found.append(("have corners sharper than", f"{np.degrees(SHARPEST):g} degrees", sharp))
    return [
        f"{int(which.sum())} plates of {part.name} {what} {limit}, {_places(corners[which].mean(axis=1))}"
        for what, limit, which in found
        if which.any()
    ]


def _refuse_twice(structure: Structure, kind: str, parts: Sequence[Shells | Beams]) -> None:
    """Refuse elements of one property between the same nodes."""
    for part in parts:
        _, first, count = np.unique(
            np.sort(part.elements, axis=1), axis=0, return_index=True, return_counts=True
        )
        if (count > 1).any():
            raise InputError(
                f"is there {int(count.max())} times ({int((count > 1).sum())} such {kind}s)",
                source=_source(structure),
                key=_element_words(structure, kind, part, int(first[np.argmax(count > 1)])),
                expected=f"every {kind} once",
            )


def _pairs(structure: Structure, *, links_only: bool = False) -> NDArray[np.int64]:
    """Pairs of nodes that an element, a link, an average or a tie joins, shape (m, 2)."""
    stars = [(link.node, link.dependent) for link in structure.links]
    stars += [(average.node, average.nodes) for average in structure.averages]
    found = [np.array([[tie.node, tie.dependent] for tie in structure.ties], dtype=np.int64).reshape(-1, 2)]
    found += [np.column_stack([np.full(len(ends), node), ends]) for node, ends in stars]
    if not links_only:
        chains = [part.elements for part in structure.shells]
        chains += [part.elements for part in structure.beams]
        chains += [part.elements for part in structure.solids]
        found += [
            np.column_stack([np.repeat(chain[:, 0], chain.shape[1] - 1), chain[:, 1:].ravel()])
            for chain in chains
        ]
    return np.concatenate(found)


def _labels(structure: Structure, *, links_only: bool = False) -> NDArray[np.int64]:
    """Part of every node, shape (n,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = _pairs(structure, links_only=links_only)
    n = structure.node_count
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _refuse_loose_nodes(structure: Structure) -> None:
    """Refuse nodes in nothing."""
    used = np.zeros(structure.node_count, dtype=bool)
    used[_pairs(structure).ravel()] = True
    if not used.all():
        raise InputError(
            f"is in no element and follows none ({int((~used).sum())} such nodes)",
            source=_source(structure),
            key=node_words(structure, int(np.argmin(used))),
            expected="every node in a plate, beam, solid, link, average or tie",
        )


def _refuse_parts(structure: Structure, label: NDArray[np.int64], size: float) -> None:
    """Refuse parts that nothing joins, with the place where the smallest comes next to the others."""
    from scipy.spatial import cKDTree

    count = np.bincount(label)
    if len(count) < 2:
        return
    inside = label == np.argmin(count)
    distance, _ = cKDTree(structure.nodes[~inside]).query(structure.nodes[inside])
    closest = int(np.argmin(distance))
    at = structure.nodes[inside][closest]
    touching = distance <= SAME_PLACE * size
    words = (
        f"touches the others with {int(touching.sum())} nodes of its own {_places(structure.nodes[inside][touching])}"
        if touching.any()
        else f"is {distance[closest]:.6g} m away from the others, nearest {_places(at[None])}"
    )
    raise InputError(
        f"falls into {len(count)} parts that nothing joins; the smallest, of {int(inside.sum())} nodes, {words}",
        source=_source(structure),
        key=node_words(structure, int(np.flatnonzero(inside)[closest])),
        expected="one body: common nodes where parts are welded, or links between them",
    )


def _free_edges(structure: Structure) -> NDArray[np.int64]:
    """Edges of plates that belong to one plate only, shape (m, 2)."""
    found = [
        np.stack([part.elements, np.roll(part.elements, -1, axis=1)], axis=2).reshape(-1, 2)
        for part in structure.shells
    ]
    edges = np.sort(np.concatenate([np.empty((0, 2), dtype=np.int64), *found]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return unique[count == 1]


def _edge_notes(structure: Structure, size: float) -> list[str]:
    """Refuse free edges at one place with other nodes; tell of those that lie on plates between their nodes."""
    from scipy.spatial import cKDTree

    edges = _free_edges(structure)
    nodes = np.unique(edges)
    if not len(nodes):
        return []
    joined = _labels(structure, links_only=True)
    tree = cKDTree(structure.nodes)
    near = np.unique(np.sort(tree.query_pairs(SAME_PLACE * size, output_type="ndarray"), axis=1), axis=0)
    apart = near[np.isin(near, nodes).any(axis=1) & (joined[near[:, 0]] != joined[near[:, 1]])]
    if len(apart):
        places = structure.nodes[apart[:, 0]]
        raise InputError(
            f"free edges are not joined to {len(apart)} nodes at their places, {_places(places)}",
            source=_source(structure),
            key=node_words(structure, int(apart[0, 0])),
            expected="one node where plates are welded, or a tie between the two",
        )
    lying = _on_other_plates(structure, nodes, size)
    if not len(lying):
        return []
    what = (
        f"{len(lying)} nodes of free edges lie on plates that have no node there and are not joined to them"
    )
    return [f"{what}, {_places(structure.nodes[lying])}"]


def _on_other_plates(structure: Structure, nodes: NDArray[np.int64], size: float) -> NDArray[np.int64]:
    """Which of some nodes lie on plates that they are no node of."""
    from scipy.spatial import cKDTree

    triangles = structure.boundary_triangles()
    corners = structure.nodes[triangles]
    middle = corners.mean(axis=1)
    reach = float(np.linalg.norm(corners - middle[:, None], axis=2).max()) + SAME_PLACE * size
    candidates = cKDTree(middle).query_ball_point(structure.nodes[nodes], reach)
    counts = np.array([len(found) for found in candidates])
    which = np.repeat(nodes, counts)
    of = np.concatenate([np.asarray(found, dtype=np.int64) for found in candidates])
    foreign = (triangles[of] != which[:, None]).all(axis=1)
    which, of = which[foreign], of[foreign]
    near = distances_to_triangles(corners[of], structure.nodes[which]) <= SAME_PLACE * size
    linked = np.unique(_pairs(structure, links_only=True))
    return np.setdiff1d(np.unique(which[near]), linked)


def _hinge_notes(structure: Structure) -> list[str]:
    """Tell of plates and beams on nodes of solids, which pass no moment on."""
    inside, turning = np.zeros((2, structure.node_count), dtype=bool)
    for solids in structure.solids:
        inside[solids.elements] = True
    for elements in [part.elements for part in structure.shells] + [
        part.elements for part in structure.beams
    ]:
        turning[elements] = True
    hinged = np.flatnonzero(inside & turning)
    if not len(hinged):
        return []
    what = f"{len(hinged)} nodes of plates or beams are nodes of solids, which have no rotations: no moment passes"
    return [f"{what}, {_places(structure.nodes[hinged])}; a rigid link or an average passes it on"]


def _normal_notes(structure: Structure) -> list[str]:
    """Tell of neighbours in one property whose normals point to different sides: their top and bottom are exchanged."""
    notes = []
    for part in structure.shells:
        start, end = part.elements.ravel(), np.roll(part.elements, -1, axis=1).ravel()
        # two plates that run along an edge in the same direction face different sides
        key = start * structure.node_count + end
        _, first, count = np.unique(key, return_index=True, return_counts=True)
        edge = np.minimum(start, end) * structure.node_count + np.maximum(start, end)
        _, index, uses = np.unique(edge, return_inverse=True, return_counts=True)
        total = uses[index]
        wrong = first[(count == 2) & (total[first] == 2)]
        if len(wrong):
            notes.append(
                f"normals of {len(wrong)} pairs of neighbours in {part.name} point to different sides, "
                f"{_places(structure.nodes[start[wrong]])}: top, bottom and offset are exchanged there"
            )
    return notes
