"""The reduced flexible body: all that the simulation needs to know of a finite-element model."""

from __future__ import annotations

from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.modal.place_rotation import place_rotation
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.mesh import BESIDE, find_place

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.invariants import ShapeIntegrals
    from heavylift.modal.stiffening import Stiffening
    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.structures.structure import Structure

__all__ = ["EIGENMODE_RESIDUAL", "SAME_PLACE", "Interface", "PlaceMotion", "ReducedBody", "check_orthonormal"]

EIGENMODE_RESIDUAL = 1e-3
"""A vector with a smaller relative residual is an eigenmode of the full model."""


SAME_PLACE = 1e-6
"""Of the size of the body: how far a point may be from the reference point of an interface that it means."""

TURNED = 1e-3
"""Of the largest rotation that a mode could make: its largest displacement over the size of the body."""

LARGE_DEFLECTION = 0.1
"""Of the largest extent of a body: displacements beyond which a warning says that linear theory does not hold."""

_WEIGHTLESS = 1e-9  # shape function of a node that a place does not feel
_STILL = 1e-9  # of the largest displacement: of a node that is held

LARGEST_DEVIATION = 1e-6
"""Of the modal mass from the identity: what the equations of motion take for granted."""


def check_orthonormal(
    orthogonality: float, eigenvalues: NDArray[np.float64], source: str = "reduced body"
) -> None:
    """Refuse shapes whose modal mass is not the identity.

    Parameters
    ----------
    orthogonality
        Largest deviation of ``Phi^T M Phi`` from the identity.
    eigenvalues
        Of the modes [rad^2/s^2].
    source
        Named in the message.

    Raises
    ------
    InputError
        If the deviation exceeds `LARGEST_DEVIATION`, or a number is not finite.
    """
    if orthogonality <= LARGEST_DEVIATION and np.all(np.isfinite(eigenvalues)):
        return
    largest = float(np.sqrt(max(float(np.max(eigenvalues, initial=0.0)), 0.0)) / (2.0 * np.pi))
    raise InputError(
        f"the modal mass differs from the identity by {orthogonality:.3g}, with frequencies up to {largest:.3g} Hz",
        source=source,
        key="basis",
        expected=f"mass-orthonormal shapes, to {LARGEST_DEVIATION:g}: fewer vectors that are nearly combinations of "
        "each other (nodes of the interface, static points, stored shapes)",
    )


@dataclass(frozen=True, eq=False)
class Interface:
    """A place of a body that others are attached to: its displacement and its rotation are those of a group of nodes.

    Attributes
    ----------
    point
        Reference point in the body frame [m], shape (3,).
    displacement
        Of the point per unit modal coordinate [kg^-1/2], shape (nf, 3).
    rotation
        Of the place relative to the frame per unit modal coordinate [rad kg^-1/2 m^-1], shape (nf, 3).
    nodes
        Of the group, shape (m,).
    forces
        Loads on the nodes of the group from the force and the moment at the point, shape (m, 3, 6); transposed they are
        displacement and rotation of the place as a mean of those of the nodes.
    moments
        The same for the moments on the nodes, shape (m, 3, 6); zeros where nodes have no rotations.
    captured
        Smallest share of the static compliance of its six directions that the modes have; not a number if it was
        never compared with the full model.
    """

    point: NDArray[np.float64]
    displacement: NDArray[np.float64]
    rotation: NDArray[np.float64]
    nodes: NDArray[np.int64]
    forces: NDArray[np.float64]
    moments: NDArray[np.float64]
    captured: float = float("nan")


class PlaceMotion(NamedTuple):
    """How modes move and turn a place of a body.

    Attributes
    ----------
    point
        Undeformed, in the body frame [m], shape (3,).
    displacement
        Per unit modal coordinate [kg^-1/2], shape (nf, 3).
    rotation
        Relative to the frame, per unit modal coordinate [rad kg^-1/2 m^-1], shape (nf, 3); None if modes do not turn
        the place.
    """

    point: NDArray[np.float64]
    displacement: NDArray[np.float64]
    rotation: NDArray[np.float64] | None


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """A flexible body in modal coordinates: unit modal mass, diagonal modal stiffness.

    Attributes
    ----------
    nodes
        Undeformed nodes in the body frame [m], shape (n, 3).
    eigenvalues
        Diagonal of the modal stiffness [rad^2/s^2], shape (nf,), ascending; the modal mass is the identity.
    mode_shapes
        Displacements per unit modal coordinate [kg^-1/2], shape (nf, n, 3), C-contiguous.
    integrals
        Inertia shape integrals about the origin of the body frame.
    mean_axis
        Whether the shapes carry no linear and no angular momentum of the undeformed body:
        ``modal_translation = 0`` and ``Ibar_kl = Ibar_lk``.
    labels
        Where each vector comes from, e.g. ``"eigenmode 3"``; length nf.
    residuals
        ``||K phi - w2 M phi|| / (w2 ||M phi||)`` of each vector in the full model, shape (nf,).
        Small for eigenmodes; of order one, and no measure of accuracy, for vectors that a static,
        Krylov or component-mode basis adds: see `eigenmode_mask`.
    orthogonality
        Largest deviation of ``Phi^T M Phi`` from the identity.
    dropped
        Vectors that were asked for and add nothing to the others, with the reason.
    mesh
        Elements between the nodes, in the body frame; None if they are not known.
    continuum
        Whether it is a solid, whose places turn where it bends. A body of loose points has no directions but those of
        its frame.
    structure
        Plates, beams and solids between the nodes, in the body frame; None for bodies with a `mesh`, or with neither.
    mode_rotations
        Rotations of the nodes per unit modal coordinate [rad kg^-1/2 m^-1], shape (nf, n, 3), zero for nodes that have
        none; None if no node has any.
    rotating
        Sorted nodes that have rotations.
    interfaces
        Places that others are attached to, by name.
    stiffening
        What loads along the body do to the stiffness of its modes; None: nothing, as in linear theory.

    Raises
    ------
    InputError
        If the arrays do not fit together, or the shapes are not mass-orthonormal.
    """

    nodes: NDArray[np.float64]
    eigenvalues: NDArray[np.float64]
    mode_shapes: NDArray[np.float64]
    integrals: ShapeIntegrals
    mean_axis: bool
    labels: tuple[str, ...]
    residuals: NDArray[np.float64]
    orthogonality: float
    dropped: tuple[str, ...] = ()
    mesh: Mesh | None = None
    continuum: bool = True
    structure: Structure | None = None
    mode_rotations: NDArray[np.float64] | None = None
    rotating: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    interfaces: dict[str, Interface] = field(default_factory=dict)
    stiffening: Stiffening | None = None

    def __post_init__(self) -> None:
        n, nf = len(self.nodes), len(self.eigenvalues)
        expected = {
            "nodes": (n, 3),
            "eigenvalues": (nf,),
            "mode_shapes": (nf, n, 3),
            "residuals": (nf,),
        }
        for key, shape in expected.items():
            array = np.ascontiguousarray(getattr(self, key), dtype=np.float64)
            object.__setattr__(self, key, array)
            if array.shape != shape:
                raise InputError(
                    f"shape {array.shape}", source="reduced body", key=key, expected=f"shape {shape}"
                )
        if len(self.labels) != nf:
            raise InputError(
                f"{len(self.labels)} labels",
                source="reduced body",
                key="labels",
                expected=f"{nf}, one a vector",
            )
        if self.mesh is not None and self.mesh.node_count != n:
            raise InputError(
                f"{self.mesh.node_count} nodes",
                source="reduced body",
                key="mesh",
                expected=f"{n}, those of the body",
            )
        check_orthonormal(self.orthogonality, self.eigenvalues)

    @property
    def elements(self) -> Mesh | Structure | None:
        """What is between the nodes; None if that is not known."""
        return self.mesh if self.mesh is not None else self.structure

    @property
    def mode_count(self) -> int:
        """Number of modal coordinates nf."""
        return len(self.eigenvalues)

    @property
    def node_count(self) -> int:
        """Number of nodes n."""
        return len(self.nodes)

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Natural frequencies of the reduced body with its frame held [Hz], shape (nf,)."""
        return np.sqrt(np.maximum(self.eigenvalues, 0.0)) / (2.0 * np.pi)

    @property
    def eigenmode_mask(self) -> NDArray[np.bool_]:
        """Which vectors are eigenmodes of the full model: residual below `EIGENMODE_RESIDUAL`, shape (nf,)."""
        return self.residuals < EIGENMODE_RESIDUAL

    def displacement(self, modal_coordinates: ArrayLike) -> NDArray[np.float64]:
        """Displacements of all nodes in the body frame [m], shape (n, 3), for coordinates q [kg^1/2 m]."""
        q = np.asarray(modal_coordinates, dtype=np.float64)
        if q.shape != (self.mode_count,):
            raise InputError(
                f"modal coordinates of shape {q.shape}",
                source="reduced body",
                expected=f"shape ({self.mode_count},)",
            )
        return np.tensordot(q, self.mode_shapes, axes=1)

    def locate(
        self,
        point: ArrayLike,
        *,
        source: object = "reduced body",
        key: str = "point",
        origin: ArrayLike = (0.0, 0.0, 0.0),
        within: float = BESIDE,
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Nodes and weights of a place in the body frame [m]; the parameters are those of `find_place`.

        Of a body of loose points the nearest one is taken, however far it is.
        """
        within = within if self.continuum else np.inf
        return find_place(
            self.nodes, self.elements, point, source=source, key=key, origin=origin, within=within
        )

    def shapes_at(self, nodes: NDArray[np.int64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Displacement of a place per unit modal coordinate [kg^-1/2], shape (nf, 3)."""
        return np.einsum("a,mak->mk", weights, self.mode_shapes[:, nodes])

    def interface_at(self, place: ArrayLike | str) -> Interface | None:
        """The interface of a name, or the one whose reference point [m] a point is; None if there is none there.

        Raises
        ------
        InputError
            If no interface has the name.
        """
        if isinstance(place, str):
            if place not in self.interfaces:
                raise InputError(
                    f"no interface is called {place!r}",
                    source="reduced body",
                    expected=f"one of {', '.join(sorted(self.interfaces)) or 'none: it has no interfaces'}",
                )
            return self.interfaces[place]
        point = np.asarray(place, dtype=np.float64)
        near = SAME_PLACE * self.size if self.interfaces else 0.0
        beside = (one for one in self.interfaces.values() if np.linalg.norm(one.point - point) <= near)
        return next(beside, None)

    def point_at(
        self,
        place: ArrayLike | str,
        *,
        source: object = "reduced body",
        key: str = "point",
        origin: ArrayLike = (0.0, 0.0, 0.0),
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Undeformed point [m], and displacement per unit modal coordinate, of a place; see `motion_at`."""
        return self._displaced(self._found(place, source, key, origin))

    def motion_at(
        self,
        place: ArrayLike | str,
        *,
        source: object = "reduced body",
        key: str = "point",
        origin: ArrayLike = (0.0, 0.0, 0.0),
    ) -> PlaceMotion:
        """How modes move and turn a place: an interface by its name or its reference point, or any point of the mesh.

        Parameters
        ----------
        place
            Name of an interface, or a point in the body frame [m].
        source, key, origin
            For messages, as of `find_place`.

        Raises
        ------
        InputError
            If there is no such interface, or the point is not of the body.
        """
        found = self._found(place, source, key, origin)
        if not self.continuum or not self.mode_count:
            return PlaceMotion(*self._displaced(found), None)
        rotation = found.rotation if isinstance(found, Interface) else self.turn_at(*found)
        return PlaceMotion(*self._displaced(found), rotation if self.turns(rotation) else None)

    def _found(
        self, place: ArrayLike | str, source: object, key: str, origin: ArrayLike
    ) -> Interface | tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The interface at a place, or its nodes and weights."""
        interface = self.interface_at(place)
        if interface is not None:
            return interface
        return self.locate(place, source=source, key=key, origin=origin)

    def _displaced(
        self, found: Interface | tuple[NDArray[np.int64], NDArray[np.float64]]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Undeformed point, and displacement, of what `_found` finds."""
        if isinstance(found, Interface):
            return found.point, found.displacement
        nodes, weights = found
        return weights @ self.nodes[nodes], self.shapes_at(nodes, weights)

    def turn_at(self, nodes: NDArray[np.int64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rotation of a place relative to the frame, per unit modal coordinate [rad kg^-1/2 m^-1], shape (nf, 3).

        Notes
        -----
        That of the nodes, where all of them have rotations. Else that of the rigid motion that fits the displacements
        of the nodes around (`place_rotation`); none where the nodes at the place and three around it that are not on
        one line stand still.
        """
        at = nodes[np.abs(weights) > _WEIGHTLESS]
        if self.mode_rotations is not None and np.isin(at, self.rotating).all():
            return np.einsum("a,mak->mk", weights, self.mode_rotations[:, nodes])
        around, turning = place_rotation(self.nodes, self.elements, at, weights @ self.nodes[nodes])
        held = around[self._stands(around)]
        if (
            self._stands(at).all()
            and np.linalg.matrix_rank(_centred(self.nodes[held]), tol=1e-6 * self.size) >= 2
        ):
            return np.zeros((self.mode_count, 3))
        return np.einsum("akl,mal->mk", turning, self.mode_shapes[:, around])

    def lies_on_a_line(self, place: ArrayLike) -> bool:
        """Whether the nodes that make the rotation of a place [m] do; not of elements, nor at interfaces."""
        if not self.continuum or self.elements is not None or self.interface_at(place) is not None:
            return False
        nodes, weights = self.locate(place)
        around, _ = place_rotation(self.nodes, None, nodes, weights @ self.nodes[nodes])
        return bool(np.linalg.matrix_rank(_centred(self.nodes[around]), tol=1e-6 * self.size) < 2)

    def turns(self, rotation: NDArray[np.float64], direction: ArrayLike | None = None) -> bool:
        """Whether modes turn a place, or a unit direction there, by more than a thousandth of what they would at most.

        That is the largest displacement of a mode over the size of the body. A body of loose points has no directions
        but those of its frame.

        Parameters
        ----------
        rotation
            Of the place, shape (nf, 3).
        direction
            In the body frame; any if None.
        """
        if not self.continuum or not self.mode_count:
            return False
        moved = rotation if direction is None else np.cross(rotation, np.asarray(direction))
        turned = np.linalg.norm(moved, axis=1)
        largest = np.linalg.norm(self.mode_shapes, axis=2).max(axis=1)
        return bool(np.any(turned * self.size > TURNED * largest))

    def _stands(self, nodes: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Whether no mode moves some nodes, shape (m,)."""
        found: NDArray[np.bool_] = (
            np.abs(self.mode_shapes[:, nodes]).max(axis=(0, 2), initial=0.0) <= _STILL * self._largest
        )
        return found

    @cached_property
    def _largest(self) -> float:
        """Largest component of all mode shapes [kg^-1/2]."""
        return float(np.abs(self.mode_shapes).max(initial=0.0))

    @property
    def size(self) -> float:
        """Largest extent of the body [m]."""
        return float(np.ptp(self.nodes, axis=0).max())


def _centred(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Positions relative to their mean [m], shape (n, 3)."""
    return points - points.mean(axis=0) if len(points) else points.reshape(0, 3)
