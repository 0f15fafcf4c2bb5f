"""Sets of deformation shapes a body may be reduced to: eigenmodes, static, interface and Krylov vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.modal.constraints import free_dofs
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility, apply_mass, held_dofs, held_nodes
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.threads import one_blas_thread
from heavylift.preprocess.finite_elements.mesh import find_place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.modal.eigen import Modes
    from heavylift.preprocess.finite_elements.model import FEModel

    Nodes = Sequence[int] | NDArray[np.int64]

__all__ = [
    "Basis",
    "Loads",
    "craig_bampton",
    "eigenmode_basis",
    "inner_modes",
    "moment_matching",
    "patch_loads",
    "place_loads",
    "point_loads",
    "static_vectors",
]

_AXES = "xyz"
_DEPENDENT = 1e-8  # part of a Krylov vector's length that must be new


@dataclass(frozen=True, eq=False)
class Basis:
    """Displacement vectors with names; neither normalised nor independent yet. Bases add up by ``+``.

    Attributes
    ----------
    vectors
        Node-major, shape (N, nv); the scale does not matter.
    labels
        Where each vector comes from, length nv.
    """

    vectors: NDArray[np.float64]
    labels: tuple[str, ...]

    def __add__(self, other: Basis) -> Basis:
        return Basis(np.hstack([self.vectors, other.vectors]), self.labels + other.labels)


class Loads(NamedTuple):
    """Load vectors [N], node-major, shape (N, m), and their names."""

    forces: NDArray[np.float64]
    labels: tuple[str, ...]


def point_loads(model: FEModel, nodes: Nodes, directions: str = "xyz") -> Loads:
    """Unit forces at nodes, each in each of the directions (a string of x, y and z).

    Raises
    ------
    InputError
        For an unknown direction, no node, or a node outside the model.
    """
    chosen = _checked_nodes(model, nodes, "nodes")
    axes = _checked_axes(directions)
    forces = np.zeros((model.dof_count, len(chosen) * len(axes)))
    rows = (3 * chosen[:, None] + axes).ravel()
    forces[rows, np.arange(len(rows))] = 1.0
    return Loads(forces, tuple(f"node {node} {_AXES[axis]}" for node in chosen for axis in axes))


def place_loads(
    model: FEModel,
    points: Sequence[Sequence[float]] | NDArray[np.float64],
    directions: str = "xyz",
    *,
    key: str = "points",
) -> Loads:
    """Unit forces at points of the body [m], each in each of the directions, shared among the nodes of an element.

    Shares are the shape functions at the point, as for a force on the body there. Points that act on the same nodes
    alike count once.

    Raises
    ------
    InputError
        For an unknown direction, or a point that is not on the body, with the key and its number.
    """
    axes = _checked_axes(directions)
    places: dict[tuple[Any, ...], str] = {}
    source = model.name or "finite element model"
    for index, point in enumerate(points):
        nodes, weights = find_place(model.nodes, model.elements, point, source=source, key=f"{key}.{index}")
        at = ", ".join(f"{1e3 * float(x):.6g}" for x in point)
        name = f"node {nodes[0]}" if len(nodes) == 1 else f"point ({at}) mm"
        places.setdefault((tuple(nodes), tuple(np.round(weights, 9))), name)
    forces = np.zeros((model.dof_count, len(places) * len(axes)))
    column = 0
    for nodes, weights in places:
        for axis in axes:
            forces[3 * np.array(nodes) + axis, column] = weights
            column += 1
    return Loads(forces, tuple(f"{name} {_AXES[axis]}" for name in places.values() for axis in axes))


def patch_loads(
    model: FEModel,
    nodes: Nodes,
    directions: str = "xyz",
    *,
    weights: Sequence[float] | NDArray[np.float64] | None = None,
    name: str = "patch",
) -> Loads:
    """Unit forces distributed over a patch of nodes, one for each direction.

    Parameters
    ----------
    model
        Finite element model.
    nodes
        Nodes of the patch.
    directions
        Some of x, y, z.
    weights
        Share of each node; scaled to the sum 1. None: equal shares.
    name
        For the labels.

    Raises
    ------
    InputError
        As `point_loads`; or weights of the wrong number, not finite, or with sum zero.
    """
    chosen = _checked_nodes(model, nodes, "nodes")
    axes = _checked_axes(directions)
    share = np.ones(len(chosen)) if weights is None else np.asarray(weights, dtype=np.float64)
    if (
        share.shape != chosen.shape
        or not np.all(np.isfinite(share))
        or abs(share.sum()) <= 1e-12 * np.abs(share).sum()
    ):
        raise InputError(
            f"weights {np.array2string(share, threshold=6)}",
            source=name,
            key="weights",
            expected=f"{len(chosen)} finite numbers, one a node, with a sum other than zero",
        )
    forces = np.zeros((model.dof_count, len(axes)))
    for column, axis in enumerate(axes):
        forces[3 * chosen + axis, column] = share / share.sum()
    return Loads(forces, tuple(f"{name} {_AXES[axis]}" for axis in axes))


def eigenmode_basis(modes: Modes, selection: Sequence[int] | None = None) -> Basis:
    """Eigenmodes, all or those with the given numbers, counted from 1 without the rigid ones.

    Raises
    ------
    InputError
        For a number outside 1 ... nf, or one that appears twice.
    """
    count = len(modes.eigenvalues)
    numbers = list(range(1, count + 1)) if selection is None else [int(number) for number in selection]
    for place, number in enumerate(numbers):
        if not 1 <= number <= count:
            raise InputError(
                f"mode {number}", source="modes", key="selection", expected=f"a number from 1 to {count}"
            )
        if number in numbers[:place]:
            raise InputError(
                f"mode {number} twice", source="modes", key="selection", expected="every mode once"
            )
    if not numbers:
        raise InputError("no mode", source="modes", key="selection", expected=f"numbers from 1 to {count}")
    columns = np.array(numbers) - 1
    return Basis(modes.shapes[:, columns], tuple(f"eigenmode {number}" for number in numbers))


@one_blas_thread
def static_vectors(flexibility: Flexibility, loads: Loads) -> Basis:
    """Deflections ``K^-1 b`` under constant loads, which eigenmodes alone approach only slowly.

    A free body deflects under the load and the inertia forces of its rigid acceleration (inertia relief).
    """
    return Basis(flexibility.solve(loads.forces), tuple(f"static {label}" for label in loads.labels))


@one_blas_thread
def moment_matching(flexibility: Flexibility, loads: Loads, order: int) -> Basis:
    """Block Krylov vectors ``K^-1 b, K^-1 M K^-1 b, ...`` of some loads, made mass-orthonormal.

    Parameters
    ----------
    flexibility
        Factorised stiffness.
    loads
        Load vectors b.
    order
        Number of blocks, at least 1. The transfer function ``b^T (K - w2 M)^-1 b`` of the reduced
        body then has the exact first ``2 order`` derivatives with respect to w2 at zero.

    Raises
    ------
    InputError
        If `order` is not positive.

    Notes
    -----
    Su and Craig, "Krylov model reduction algorithm for undamped structural dynamics systems",
    J. Guidance 14 (1991). Vectors that are in the space already are left out.
    """
    if order < 1:
        raise InputError(f"order {order}", source="moment matching", key="order", expected="at least 1")
    mass = flexibility.model.mass
    kept: list[NDArray[np.float64]] = []
    weighted: list[NDArray[np.float64]] = []
    labels: list[str] = []
    source = loads.forces
    names = loads.labels
    for block in range(order):
        images = flexibility.solve(source)
        found, found_names = [], []
        for column, name in enumerate(names):
            vector = images[:, column]
            length = np.sqrt(vector @ apply_mass(mass, vector))
            for _ in range(2):
                for other, other_mass in zip(kept, weighted, strict=True):
                    vector = vector - other * (other_mass @ vector)
            inertia = apply_mass(mass, vector)
            rest = np.sqrt(max(float(vector @ inertia), 0.0))
            if rest <= _DEPENDENT * length:
                continue
            kept.append(vector / rest)
            weighted.append(inertia / rest)
            found.append(weighted[-1])
            found_names.append(name)
            labels.append(f"Krylov {block + 1} {name}")
        if not found:
            break
        source, names = np.column_stack(found), tuple(found_names)
    return Basis(np.column_stack(kept) if kept else np.zeros((flexibility.model.dof_count, 0)), tuple(labels))


@one_blas_thread
def craig_bampton(
    model: FEModel,
    interface: Nodes,
    count: int,
    *,
    up_to: float | None = None,
    fixed_nodes: Nodes = (),
    backend: str = "auto",
) -> Basis:
    """Craig-Bampton basis: interface displacements one by one, and modes with the interface held.

    Parameters
    ----------
    model
        Finite element model.
    interface
        Nodes where other bodies are attached.
    count
        Number of fixed-interface modes; 0 for static (Guyan) condensation.
    up_to
        Only those up to this frequency [Hz].
    fixed_nodes
        Clamped nodes.
    backend
        Factorisation.

    Raises
    ------
    InputError
        If an interface node is held, or held and interface nodes together do not hold the body.

    Notes
    -----
    Craig and Bampton, "Coupling of substructures for dynamic analyses", AIAA J. 6 (1968). Constraint
    modes ``[1; -K_ii^-1 K_ib]`` make every static response to interface loads exact. The rigid motions
    of a free body are among their combinations; `heavylift.modal.reduction.reduce_body` takes them out.
    """
    boundary = _checked_nodes(model, interface, "interface")
    clamped = held_nodes(model, fixed_nodes)
    both = np.intersect1d(boundary, model.dof_nodes[held_dofs(model, clamped)])
    if both.size:
        raise InputError(
            f"node {both[0]} is held and an interface node",
            source=model.name or "finite element model",
            key="interface",
            expected="free nodes",
        )
    inner = Flexibility(model, np.union1d(clamped, boundary), backend=backend)
    if inner.rigid_count:
        raise InputError(
            f"held and interface nodes leave {inner.rigid_count} rigid motion(s)",
            source=model.name or "finite element model",
            key="interface",
            expected="at least three nodes that are not on one line",
        )
    rows = model.node_dofs(boundary)
    moved = free_dofs(model, held_dofs(model, clamped))
    led = np.setdiff1d(rows, moved.unknowns)
    if led.size:
        raise InputError(
            f"node {model.dof_nodes[led[0]]} follows others and is an interface node",
            source=model.name or "finite element model",
            key="interface",
            expected="nodes that move by themselves, such as those that it follows",
        )
    vectors = np.zeros((model.dof_count, len(rows)))
    vectors[rows, np.arange(len(rows))] = 1.0
    vectors = moved.expanded(vectors)
    inner_part = inner.solve(-(model.stiffness @ vectors))
    vectors += inner_part
    basis = Basis(vectors, tuple(f"interface node {node} {axis}" for node, axis in _named(model, rows)))
    return basis + inner_modes(model, inner, count, up_to)


def inner_modes(model: FEModel, inner: Flexibility, count: int, up_to: float | None) -> Basis:
    """Modes with the interfaces held, some number of them or up to a frequency [Hz]; perhaps none."""
    if not count and up_to is None:
        return Basis(np.empty((model.dof_count, 0)), ())
    modes = eigenmodes(model, count, up_to=up_to, flexibility=inner)
    names = tuple(f"fixed-interface mode {k + 1}" for k in range(len(modes.eigenvalues)))
    return Basis(modes.shapes, names)


def _named(model: FEModel, dofs: NDArray[np.int64]) -> list[tuple[int, str]]:
    """Node and axis of degrees of freedom; ``"x"`` of a displacement, ``"turn x"`` of a rotation."""
    turns = dofs >= 3 * model.node_count
    return [
        (int(node), ("turn " if turn else "") + _AXES[dof % 3])
        for node, dof, turn in zip(model.dof_nodes[dofs], dofs, turns, strict=True)
    ]


def _checked_nodes(model: FEModel, nodes: Nodes, key: str) -> NDArray[np.int64]:
    chosen = np.asarray(nodes, dtype=np.int64).ravel()
    source = model.name or "finite element model"
    if not chosen.size:
        raise InputError("no node", source=source, key=key, expected="at least one node")
    wrong = chosen[(chosen < 0) | (chosen >= model.node_count)]
    if wrong.size:
        raise InputError(
            f"node {wrong[0]} does not exist", source=source, key=key, expected=f"0 to {model.node_count - 1}"
        )
    if len(np.unique(chosen)) < len(chosen):
        raise InputError("a node appears twice", source=source, key=key, expected="every node once")
    return chosen


def _checked_axes(directions: str) -> NDArray[np.int64]:
    if (
        not directions
        or any(axis not in _AXES for axis in directions)
        or len(set(directions)) < len(directions)
    ):
        raise InputError(f"directions {directions!r}", source="load", expected="some of the letters x, y, z")
    return np.array([_AXES.index(axis) for axis in directions])
