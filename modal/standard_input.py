"""Standard input data (SID) of a flexible body, which other multibody programs take.

O. Wallrapp, "Standard input data of flexible members in multibody systems", in W. Schiehlen (ed.), Advanced Multibody
System Dynamics (1993), 445-450; R. Schwertassek and O. Wallrapp, "Dynamik flexibler Mehrkoerpersysteme" (1999), table
6.9. Quantities are series in the modal coordinates, ``m0 + sum_k m1[:, k, :] q_k``, in the equations of a body with
acceleration a and angular velocity w of its frame, in axes of the frame (``~`` makes the matrix of a vector product)::

    m a + mdCM~^T w' + Ct^T q'' + ...                            = forces
    mdCM~ a + J w' + Cr^T q'' + (sum_k Gr_k q'_k) w + w~ J w     = moments
    Ct a + Cr w' + Me q'' + (sum_k Ge_k q'_k) w + Oe W + Ke q + De q' = modal forces

    W = (w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3)

Geometric stiffness is part of these series: that of the inertia of accelerations in Ct and Cr, that of spin in Oe, and
that of forces and moments at a place in its phi and psi, with which they act on the modes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.modal.interfaces import DIRECTIONS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.modal.stiffening import Stiffening

__all__ = ["DIAGONAL", "FULL", "SYMMETRIC", "NodeData", "Series", "StandardInput", "standard_input"]

DIAGONAL, SYMMETRIC, FULL = 1, 2, 3
"""Structures of a matrix in the file."""

_SQUARES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
"""Products of angular velocities that the columns of Oe are for."""


class Series(NamedTuple):
    """A matrix that is linear in the modal coordinates.

    Attributes
    ----------
    m0
        At rest, shape (r, c).
    m1
        By modal coordinates, shape (r, nf, c); None if it is constant.
    structure
        `DIAGONAL`, `SYMMETRIC` or `FULL`.
    """

    m0: NDArray[np.float64]
    m1: NDArray[np.float64] | None = None
    structure: int = FULL


class NodeData(NamedTuple):
    """A place of the body that other programs attach to.

    Attributes
    ----------
    name
        Of the interface, or empty.
    origin
        Position [m], shape (3, 1) with its derivatives.
    phi, psi
        Displacement and rotation by modal coordinates, shape (3, nf), with their derivatives.
    orientation
        Axes of the place in those of the frame, columns, shape (3, 3) with their derivatives.
    """

    name: str
    origin: Series
    phi: Series
    psi: Series
    orientation: Series


class StandardInput(NamedTuple):
    """Standard input data; attributes have the names of the standard.

    Attributes
    ----------
    mass
        [kg].
    frequencies
        Of the vectors [Hz], shape (nf,).
    geometric
        Whether geometric stiffness is part of it.
    nodes
        Places.
    mdCM, J, Ct, Cr, Me, Gr, Ge, Oe, Ke, De
        See the equations above; blocks of Gr and Ge, three columns a vector, stand beside each other.
    """

    mass: float
    frequencies: NDArray[np.float64]
    geometric: bool
    nodes: tuple[NodeData, ...]
    mdCM: Series  # noqa: N815
    J: Series
    Ct: Series
    Cr: Series
    Me: Series
    Gr: Series
    Ge: Series
    Oe: Series
    Ke: Series
    De: Series


def standard_input(body: ReducedBody, damping_ratio: NDArray[np.float64]) -> StandardInput:
    """Standard input data of a body.

    Parameters
    ----------
    body
        Its interfaces become nodes; without any, all nodes do.
    damping_ratio
        Of critical, shape (nf,).

    Notes
    -----
    All follow from the shape integrals ``I_kl = int x_k x_l``, ``Ibar_kl,i = int x_k phi_l,i`` and
    ``S_kl,ij = int phi_k,i phi_l,j``: the moment of momentum of mode i is ``Cr_c,i = e_ckl (Ibar_kl,i + S_kl,ji q_j)``.
    """
    integrals = body.integrals
    nf = body.mode_count
    second, first, modal = integrals.inertia_kl, integrals.position_mode, integrals.mode_mode
    # of the series of second moments: int (x_k + phi_k q) (x_l + phi_l q), to first order
    rate = first + first.transpose(1, 0, 2)  # (k, l, i)
    unit = np.eye(3)
    J1 = np.einsum("kki->i", rate)[None, :, None] * unit[:, None, :] - rate.transpose(0, 2, 1)
    levi = _permutation()
    cross = np.einsum("ckl,klji->ijc", levi, modal)  # int (phi_j x phi_i)_c
    # int (x x (w x phi_i)) = (int x . phi_i  1 - int phi_i x^T) w, twice
    gyroscopic = 2.0 * (np.einsum("kki->i", first)[:, None, None] * unit - first.transpose(2, 1, 0))
    # phi . (w x (w x x)) = (phi . w)(x . w) - w^2 phi . x
    products = np.stack([_product(first, a, b) for a, b in _SQUARES], axis=1)  # (i, 6)
    modal_products = np.stack(
        [_product(modal, a, b) for a, b in _SQUARES], axis=2
    )  # (j of the position, i of the row, 6)
    centrifugal = modal_products.transpose(1, 0, 2)
    omega = np.sqrt(np.maximum(body.eigenvalues, 0.0))
    linear, angular, spin = _geometric(body.stiffening, nf)
    return StandardInput(
        mass=integrals.mass,
        frequencies=body.frequencies,
        geometric=body.stiffening is not None,
        nodes=_nodes(body),
        mdCM=Series(integrals.first_moment[:, None], integrals.modal_translation[:, :, None]),
        J=Series(np.trace(second) * unit - second, J1, SYMMETRIC),
        Ct=Series(integrals.modal_translation.T.copy(), linear),
        Cr=Series(np.einsum("ckl,kli->ic", levi, first), cross if angular is None else cross + angular),
        Me=Series(np.eye(nf), None, SYMMETRIC),
        Gr=Series(gyroscopic.transpose(1, 0, 2).reshape(3, 3 * nf)),
        Ge=Series(2.0 * cross.reshape(nf, 3 * nf)),
        Oe=Series(products, centrifugal if spin is None else centrifugal + spin),
        Ke=Series(np.diag(body.eigenvalues), None, SYMMETRIC),
        De=Series(np.diag(2.0 * damping_ratio * omega), None, SYMMETRIC),
    )


def _permutation() -> NDArray[np.float64]:
    """Sign of a permutation of the axes, shape (3, 3, 3)."""
    return np.stack([np.cross(np.eye(3)[k], np.eye(3)).T for k in range(3)], axis=1)


def _product(moments: NDArray[np.float64], a: int, b: int) -> NDArray[np.float64]:
    """Factor of w_a w_b in the integral of ``phi . (w x (w x x))`` from those of ``x_k phi_l``, shape (3, 3, ...)."""
    if a != b:
        return moments[a, b] + moments[b, a]
    return moments[a, a] - np.einsum("kk...->...", moments)


def _geometric(stiffening: Stiffening | None, count: int) -> tuple[NDArray[np.float64] | None, ...]:
    """Stiffness by accelerations, angular accelerations and products of angular velocities, arrays (nf, nf, c)."""
    if stiffening is None:
        return None, None, None
    spin = np.empty((count, count, 6))
    for column, (a, b) in enumerate(_SQUARES):
        w = np.eye(3)[a] + (np.eye(3)[b] if a != b else 0.0)
        spin[:, :, column] = stiffening.of_spin(w)
        if a != b:  # of the product alone
            spin[:, :, column] -= stiffening.of_spin(np.eye(3)[a]) + stiffening.of_spin(np.eye(3)[b])
    return stiffening.linear.transpose(1, 2, 0), stiffening.angular.transpose(1, 2, 0), spin


def _nodes(body: ReducedBody) -> tuple[NodeData, ...]:
    """Interfaces; all nodes of a body without any."""
    if body.interfaces:
        return tuple(
            _node(name, one.point, one.displacement, one.rotation, _of_loads(body.stiffening, name))
            for name, one in body.interfaces.items()
        )
    rotations = body.mode_rotations
    return tuple(
        _node(
            "",
            point,
            body.mode_shapes[:, node],
            body.turn_at(np.array([node]), np.ones(1)) if rotations is None else rotations[:, node],
        )
        for node, point in enumerate(body.nodes)
    )


def _of_loads(stiffening: Stiffening | None, name: str) -> NDArray[np.float64] | None:
    """What a place gets of its displacements by modal coordinates, so that its loads stiffen the body: (6, nf, nf)."""
    if stiffening is None:
        return None
    found = np.zeros((6, *stiffening.linear.shape[1:]))
    for label, stiffness in zip(stiffening.labels, stiffening.loads, strict=True):
        for direction, word in enumerate(DIRECTIONS):
            if label == f"{name} {word}":
                found[direction] = -stiffness
    return found


def _node(
    name: str,
    point: NDArray[np.float64],
    moved: NDArray[np.float64],
    turned: NDArray[np.float64],
    rates: NDArray[np.float64] | None = None,
) -> NodeData:
    """A place from its position, and its displacement and rotation by modal coordinates, shape (nf, 3)."""
    turning = np.cross(turned[:, None], np.eye(3)).transpose(2, 0, 1)  # column c: theta x e_c
    return NodeData(
        name,
        Series(point[:, None], moved.T[:, :, None]),
        Series(moved.T.copy(), None if rates is None else rates[:3]),
        Series(turned.T.copy(), None if rates is None else rates[3:]),
        Series(np.eye(3), turning),
    )
