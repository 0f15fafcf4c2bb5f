"""Interfaces: places of a body that others are attached to by a force and a moment.

The motion of a place with reference point p is that of a group of nodes i with weights w, in the sense of least squares
(the interpolation of Nastran's RBE3, `heavylift.preprocess.structures.group_motion`). With the weighted centre c, the
arms r from it, W the sum of weights and J their moments of inertia, its transpose spreads a force F and a moment M at p
over the nodes, ``f = w (F / W + J^-1 (M + (p - c) x F) x r)``, and adds no stiffness. On a line of nodes, where J is
singular, rotations of the nodes join the fit. A rigid interface has the same motion of a group that does not deform
(RBE2).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.modal.bases import Basis, Loads, inner_modes
from heavylift.modal.constraints import following, free_dofs
from heavylift.modal.contact_vectors import face_rule
from heavylift.modal.flexibility import Flexibility, held_dofs
from heavylift.modal.place_rotation import place_rotation
from heavylift.modal.reduced import SAME_PLACE, Interface
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import one_blas_thread
from heavylift.preprocess.finite_elements.mesh import Mesh, find_place
from heavylift.preprocess.structures.group_motion import mean_motion

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.preprocess.finite_elements.model import FEModel

__all__ = [
    "DIRECTIONS",
    "Fit",
    "attachment_loads",
    "fit",
    "group_weights",
    "interface_of",
    "is_at",
    "outer_nodes",
    "place_fit",
    "refuse_coincident",
    "rigid_craig_bampton",
    "stiffened",
]

DIRECTIONS = ("force x", "force y", "force z", "moment x", "moment y", "moment z")
"""Of the six loads of an interface."""

_STIFF = 1e-12  # of the largest compliance of a place: along what holds it there is none
_RANK = 1e-9  # of the first pivot


class Fit(NamedTuple):
    """How the nodes of a group move a place, and bear its loads.

    Attributes
    ----------
    point
        Reference point [m], shape (3,).
    nodes
        Of the group, shape (m,).
    forces
        On the nodes from the six loads at the point (`DIRECTIONS`), shape (m, 3, 6).
    moments
        On the nodes from these, shape (m, 3, 6); zeros if rotations take no part.
    """

    point: NDArray[np.float64]
    nodes: NDArray[np.int64]
    forces: NDArray[np.float64]
    moments: NDArray[np.float64]


def fit(
    model: FEModel | ReducedBody,
    point: ArrayLike,
    nodes: Sequence[int] | NDArray[np.int64],
    weights: ArrayLike,
    *,
    source: object = "interface",
    key: str = "",
) -> Fit:
    """Motion of a place from that of a group of nodes.

    Parameters
    ----------
    model
        Whose nodes they are.
    point
        Reference point [m], shape (3,).
    nodes
        Group, without repetition.
    weights
        Not negative in sum, shape (m,); see `group_weights`.
    source, key
        For messages.

    Raises
    ------
    InputError
        A group that does not determine a rotation: one node without rotations, or nodes without them on a line.
    """
    p = np.asarray(point, dtype=np.float64)
    group = np.asarray(nodes, dtype=np.int64)
    w = np.asarray(weights, dtype=np.float64)
    turns = np.isin(group, model.rotating)
    forces, moments = mean_motion(p, model.nodes[group], w, turns, source=source, key=key)
    return Fit(p, group, forces, moments)


def place_fit(model: FEModel, point: ArrayLike, *, source: object = "interface", key: str = "point") -> Fit:
    """Motion of a point of an element: by its shape functions, and its rotation by those of its nodes or by a fit.

    Parameters
    ----------
    model
        With elements.
    point
        [m], shape (3,), on the body.
    source, key
        For messages.

    Raises
    ------
    InputError
        If the point is not on the body.

    Notes
    -----
    The rotation is that of the nodes where all of them have some, else see `heavylift.modal.place_rotation`.
    """
    nodes, weights = find_place(model.nodes, model.elements, point, source=source, key=key)
    nodes, weights = nodes[weights != 0.0], weights[weights != 0.0]
    place = weights @ model.nodes[nodes]
    if np.isin(nodes, model.rotating).all():
        around, turning = nodes, np.zeros((len(nodes), 3, 3))
        moments = weights[:, None, None] * np.eye(3)
    else:
        around, turning = place_rotation(model.nodes, model.elements, nodes, place)
        moments = np.zeros((0, 3, 3))
    group, position = np.unique(np.concatenate([nodes, around]), return_inverse=True)
    found = Fit(place, group, np.zeros((len(group), 3, 6)), np.zeros((len(group), 3, 6)))
    found.forces[position[: len(nodes)], :, :3] = weights[:, None, None] * np.eye(3)
    found.forces[position[len(nodes) :], :, 3:] = turning.transpose(0, 2, 1)
    if len(moments):
        found.moments[position[: len(nodes)], :, 3:] = moments
    return found


def attachment_loads(model: FEModel, found: Fit, name: str) -> Loads:
    """The six unit loads of an interface on all degrees of freedom, in the order of `DIRECTIONS`."""
    loads = np.zeros((model.dof_count, 6))
    for rows, values in _on_dofs(model, found):
        loads[rows] += values
    return Loads(loads, tuple(f"{name} {direction}" for direction in DIRECTIONS))


def interface_of(
    body: ReducedBody, found: Fit, origin: NDArray[np.float64], exact: NDArray[np.float64]
) -> Interface:
    """Interface of a reduced body.

    Parameters
    ----------
    body
        Reduced body.
    found
        Of the full model.
    origin
        Of the frame of the body, in that of the model [m].
    exact
        Displacements and rotations of the place under its six unit loads in the full model, those along the loads
        themselves, shape (6,).
    """
    motion = np.einsum("alk,mal->mk", found.forces, body.mode_shapes[:, found.nodes])
    if body.mode_rotations is not None:
        motion += np.einsum("alk,mal->mk", found.moments, body.mode_rotations[:, found.nodes])
    modal = np.sum(motion**2 / body.eigenvalues[:, None], axis=0)
    significant = exact > _STIFF * exact.max()
    share = float(np.min(modal[significant] / exact[significant], initial=1.0)) if significant.any() else 1.0
    return Interface(
        found.point - origin,
        motion[:, :3],
        motion[:, 3:],
        found.nodes,
        found.forces,
        found.moments,
        share,
    )


def is_at(found: Fit, point: ArrayLike, size: float) -> bool:
    """Whether a point is the reference point of an interface of a body of some size [m]."""
    return bool(np.linalg.norm(found.point - np.asarray(point)) <= SAME_PLACE * size)


def refuse_coincident(fits: Mapping[str, Fit], size: float) -> None:
    """Refuse two interfaces at one point, or of one group.

    Raises
    ------
    InputError
        With both names.
    """
    names = list(fits)
    for number, name in enumerate(names):
        for other in names[:number]:
            one, two = fits[name], fits[other]
            same = is_at(one, two.point, size)
            if same or np.array_equal(np.sort(one.nodes), np.sort(two.nodes)):
                what = "its reference point" if same else "its nodes"
                raise InputError(
                    f"has {what} in common with interface {other!r}",
                    source=name,
                    key="at" if same else "group",
                    expected="one interface a place, which any number of joints, ropes and sensors may name",
                )


# ---- groups and weights ----


def group_weights(model: FEModel, nodes: NDArray[np.int64]) -> NDArray[np.float64]:
    """Tributary measure of the nodes of a group: its share of area or length, or equal shares.

    Area is that of plates and of outer faces of solids: of those whose nodes are all in the group if they reach all of
    its nodes, else, of a group with a ragged border, of all around them. Where no face is in the group, as on a line of
    plating, length is that of edges with both ends in it, if they reach all of its nodes.

    Returns
    -------
    NDArray
        Shape (m,), sum 1.
    """
    inside = np.zeros(model.node_count, dtype=bool)
    inside[nodes] = True
    faces, edges = _faces(model), _edges(model)
    whole = [part[inside[part].all(axis=1)] for part in faces]
    chosen = [whole, faces] if any(len(part) for part in whole) else []
    for parts in (*chosen, [part[inside[part].all(axis=1)] for part in edges]):
        shares = np.zeros(model.node_count)
        reached = np.zeros(model.node_count, dtype=bool)
        for part in parts:
            reached[part] = True
            for column, values in zip(part.T, _measures(model.nodes, part).T, strict=True):
                np.add.at(shares, column, values)
        if reached[nodes].all() and shares[nodes].sum() > 0.0:
            return shares[nodes] / shares[nodes].sum()
    return np.full(len(nodes), 1.0 / len(nodes))


def outer_nodes(model: FEModel) -> NDArray[np.int64]:
    """Sorted nodes of plates, beams and outer faces of solids; all nodes if elements are not known."""
    parts = [*_faces(model), *_edges(model)]
    if not parts:
        return np.arange(model.node_count)
    return np.unique(np.concatenate([part.ravel() for part in parts]))


def _faces(model: FEModel) -> list[NDArray[np.int64]]:
    """Nodes of plates and of outer faces of solids, arrays (f, 3), (f, 4), (f, 6) or (f, 8)."""
    if model.mesh is not None:
        return [model.mesh.boundary_faces()]
    if model.structure is None:
        return []
    solids = [
        Mesh(model.nodes, part.elements, part.element_type).boundary_faces()
        for part in model.structure.solids
    ]
    return [*(part.elements for part in model.structure.shells), *solids]


def _edges(model: FEModel) -> list[NDArray[np.int64]]:
    """Edges of plates and beams, each once, arrays (e, 2)."""
    if model.structure is None:
        return []
    found = [part.elements for part in model.structure.beams]
    found += [
        np.stack([part.elements, np.roll(part.elements, -1, axis=1)], axis=2).reshape(-1, 2)
        for part in model.structure.shells
    ]
    if not found:
        return []
    once: NDArray[np.int64] = np.unique(np.sort(np.concatenate(found), axis=1), axis=0)
    return [once[once[:, 0] < once[:, 1]]]


def _measures(nodes: NDArray[np.float64], parts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Integrals of the shape functions over faces [m2] or edges [m], shape like `parts`."""
    width = parts.shape[1]
    x = nodes[parts]
    if width == 2:
        return np.repeat(0.5 * np.linalg.norm(x[:, 1] - x[:, 0], axis=1)[:, None], 2, axis=1)
    if width == 3:
        areas = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
        return np.repeat(areas[:, None] / 3.0, 3, axis=1)
    N, (along_a, along_b), rule = face_rule(width, 1)
    density = np.linalg.norm(np.cross(along_a @ x, along_b @ x), axis=2)
    return (rule * density) @ N


# ---- rigid interfaces ----


def stiffened(
    model: FEModel, fits: Mapping[str, Fit], *, fixed_nodes: Sequence[int] | NDArray[np.int64] = ()
) -> tuple[FEModel, dict[str, NDArray[np.int64]]]:
    """A model whose groups of nodes do not deform.

    Parameters
    ----------
    model
        Finite element model.
    fits
        By name, from `fit`.
    fixed_nodes
        Clamped nodes besides those of the model.

    Returns
    -------
    tuple
        The model, and for each interface six degrees of freedom of its group that all others of it follow.

    Raises
    ------
    InputError
        Groups with nodes that are held, that follow others, or that are in two of them.
    """
    from scipy.linalg import qr
    from scipy.sparse import csr_array, eye_array

    moving = free_dofs(model, held_dofs(model, fixed_nodes))
    is_free = np.zeros(model.dof_count, dtype=bool)
    is_free[moving.unknowns] = True
    taken: dict[int, str] = {}
    led = np.zeros(model.dof_count, dtype=bool)
    rows, columns, entries = [], [], []
    masters: dict[str, NDArray[np.int64]] = {}
    for name, found in fits.items():
        dofs = model.node_dofs(found.nodes)
        stuck = dofs[~is_free[dofs]]
        if stuck.size:
            raise InputError(
                f"node {model.dof_nodes[stuck[0]]} is held or follows others",
                source=name,
                key="kind",
                expected="kind 'average', or a group of nodes that are free to move with the interface",
            )
        both = [int(node) for node in found.nodes if int(node) in taken]
        if both:
            raise InputError(
                f"node {both[0]} belongs to interface {taken[both[0]]!r} too",
                source=name,
                key="group",
                expected="groups of rigid interfaces without common nodes",
            )
        taken |= dict.fromkeys((int(node) for node in found.nodes), name)
        moved = _rigid_rows(model, found.point, dofs)
        length = float(np.linalg.norm(np.ptp(model.nodes[found.nodes], axis=0))) or 1.0
        scaled = moved / np.repeat([1.0, length], 3)
        R, pivots = qr(scaled.T, mode="r", pivoting=True)
        if abs(R[5, 5]) <= _RANK * abs(R[0, 0]):
            raise InputError(
                "its group does not determine a rotation",
                source=name,
                key="group",
                expected="three nodes or more that are not on one line",
            )
        lead = np.sort(pivots[:6])
        weights = np.linalg.solve(moved[lead].T, moved.T).T  # all from the six
        follow = np.setdiff1d(np.arange(len(dofs)), lead)
        led[dofs[follow]] = True
        rows.append(np.repeat(dofs[follow], 6))
        columns.append(np.tile(dofs[lead], len(follow)))
        entries.append(weights[follow].ravel())
        masters[name] = dofs[lead]
    size = model.dof_count
    free = np.flatnonzero(~led)
    number = np.full(size, -1)
    number[free] = np.arange(len(free))
    shape = (size, len(free))
    own = csr_array(eye_array(size).tocsr()[:, free])
    others = csr_array(
        (np.concatenate(entries), (np.concatenate(rows), number[np.concatenate(columns)])), shape=shape
    )
    constraint = csr_array(own + others)
    before = following(model)
    if before is not None:
        constraint = csr_array(before @ constraint)
        constraint = csr_array(constraint[:, np.unique(constraint.indices)])
    constraint.eliminate_zeros()
    return replace(model, constraint=constraint), masters


@one_blas_thread
def rigid_craig_bampton(
    model: FEModel,
    fits: Mapping[str, Fit],
    masters: Mapping[str, NDArray[np.int64]],
    count: int,
    *,
    up_to: float | None = None,
    fixed_nodes: Sequence[int] | NDArray[np.int64] = (),
    backend: str = "auto",
) -> Basis:
    """Craig-Bampton basis of rigid interfaces: unit motions of each, and modes with all of them held.

    Parameters
    ----------
    model, masters
        From `stiffened`.
    fits
        By name.
    count
        Number of modes with the interfaces held; 0 for static condensation.
    up_to
        Only those up to this frequency [Hz].
    fixed_nodes
        Clamped nodes.
    backend
        Factorisation.

    Notes
    -----
    Craig and Bampton, "Coupling of substructures for dynamic analyses", AIAA J. 6 (1968). Interface motions have
    columns of 1 m and of 1 rad about the reference point. The six rigid motions of a free body are among their
    combinations.
    """
    boundary = np.concatenate(list(masters.values()))
    moving = free_dofs(model, held_dofs(model, fixed_nodes))
    vectors = np.zeros((model.dof_count, len(boundary)))
    labels: list[str] = []
    for number, (name, dofs) in enumerate(masters.items()):
        vectors[dofs, 6 * number : 6 * number + 6] = _rigid_rows(model, fits[name].point, dofs)
        labels += [f"interface {name} {word}" for word in _MOTIONS]
    vectors = moving.expanded(vectors)
    held = replace(model, fixed_dofs=np.union1d(model.fixed_dofs, boundary))
    inner = Flexibility(held, fixed_nodes, backend=backend)
    vectors += inner.solve(-(model.stiffness @ vectors))
    return Basis(vectors, tuple(labels)) + inner_modes(held, inner, count, up_to)


_MOTIONS = ("x", "y", "z", "turn x", "turn y", "turn z")


def _rigid_rows(model: FEModel, point: NDArray[np.float64], dofs: NDArray[np.int64]) -> NDArray[np.float64]:
    """Degrees of freedom from displacement and rotation of a rigid group at a point, shape (m, 6)."""
    axes = dofs % 3
    result = np.zeros((len(dofs), 6))
    turns = dofs >= 3 * model.node_count
    result[turns, 3 + axes[turns]] = 1.0
    shift = ~turns
    result[shift, axes[shift]] = 1.0
    arms = model.nodes[model.dof_nodes[dofs[shift]]] - point
    # u = Theta x arm: row k is (arm x e_k) . Theta
    result[shift, 3:] = np.cross(arms, np.eye(3)[axes[shift]])
    return result


def _on_dofs(model: FEModel, found: Fit) -> list[tuple[NDArray[np.int64], NDArray[np.float64]]]:
    """Degrees of freedom of a group with the loads on them, shape (3m, 6): displacements, then rotations if any."""
    parts = [((3 * found.nodes[:, None] + np.arange(3)).ravel(), found.forces.reshape(-1, 6))]
    first = model.rotation_dofs[found.nodes]
    turns = first >= 0
    if turns.any():
        parts.append(((first[turns, None] + np.arange(3)).ravel(), found.moments[turns].reshape(-1, 6)))
    return parts
