"""Points of structures at which stress is recovered: nodes and centres of plates, corners of the sections of beams.

Plates have their whole stress on both surfaces, and membrane and bending apart, at their nodes, averaged where
`heavylift.preprocess.structures.stress` does; at the centres of elements that of the membrane. Beams have the normal
stress at both ends, without shear and torsion.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.modal.stress_points import SURFACE, SolidPoints, StressPoints, solid_points
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.structures.stress import beam_stress, shell_stress

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.preprocess.structures.structure import Beams, Shells, Solids

__all__ = ["CENTRE", "PLATE_SIDES", "LinearPoints", "plate_rows", "structure_points"]

PLATE_SIDES = ("top", "bottom", "membrane", "bending")
"""Sides of plates at their nodes: the whole stress on both surfaces, and its parts."""
CENTRE = "centre"
"""Membrane stress at the centres of plate elements."""

_SQUARE = 0.1  # cosine between a direction and a plate


@dataclass(frozen=True, eq=False)
class LinearPoints(StressPoints):
    """Points whose stress is a sparse matrix times the degrees of freedom, one a layer.

    Attributes
    ----------
    layers
        Rows by point and component, sparse (m components, N).
    count
        Components of the stress of a layer.
    """

    layers: tuple[csr_array, ...] = ()
    count: int = 3

    @property
    def components(self) -> int:  # type: ignore[override]
        """Three of a plate, in the axes of the point; the normal one of a beam."""
        return self.count

    def columns(self, shapes: NDArray[np.float64], part: Any) -> NDArray[np.float64]:
        """Rows of the points times the shapes."""
        points = np.arange(len(self))[part]
        rows = (points[:, np.newaxis] * self.count + np.arange(self.count)).ravel()
        found = [
            np.asarray(layer[rows] @ shapes).reshape(len(points), self.count, -1) for layer in self.layers
        ]
        return np.stack(found, axis=1)


def structure_points(model: FEModel, names: Collection[str] | None = None) -> list[StressPoints]:
    """Points of the plates, beams and solids of a structure, by property.

    Parameters
    ----------
    model
        Finite element model with its structure.
    names
        Of properties; all if None.
    """
    structure = model.structure
    assert structure is not None

    def chosen(part: Shells | Beams | Solids) -> bool:
        return bool(len(part.elements)) and (names is None or part.name in names)

    found: list[StressPoints] = []
    for shells in filter(chosen, structure.shells):
        found += _plate_points(model, shells)
    found += [_beam_points(model, part) for part in filter(chosen, structure.beams)]
    found += [_points_of_solids(model, part) for part in filter(chosen, structure.solids)]
    return found


def _plate_points(model: FEModel, shells: Shells) -> list[LinearPoints]:
    """Points of a property at its nodes, and at the centres of its elements."""
    structure = model.structure
    assert structure is not None
    nodes, centres = (shell_stress(structure, shells, model, at=at) for at in ("nodes", "centres"))
    # what does not stretch or bend bears nothing by it
    membrane, bending = float(shells.stretches), float(shells.bends)
    return [
        LinearPoints(
            name=shells.name,
            positions=nodes.positions,
            nodes=nodes.nodes,
            thickness=nodes.thickness,
            sides=PLATE_SIDES,
            from_layers=np.array([[1.0, 1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]),
            total=np.array([True, True, False, False]),
            axes=nodes.axes,
            layers=(nodes.membrane * membrane, nodes.bending * bending),
        ),
        LinearPoints(
            name=shells.name,
            positions=centres.positions,
            nodes=shells.elements[centres.elements, 0],
            thickness=centres.thickness,
            sides=(CENTRE,),
            total=np.zeros(1, dtype=bool),
            axes=centres.axes,
            layers=(centres.membrane * membrane,),
        ),
    ]


def plate_rows(
    model: FEModel,
    nodes: NDArray[np.int64],
    weights: NDArray[np.float64],
    direction: NDArray[np.float64],
    side: str,
) -> NDArray[np.float64]:
    """Normal stress of a plate along a direction at a place, by the degrees of freedom of the model, shape (N,).

    Parameters
    ----------
    model
        Finite element model with its structure.
    nodes, weights
        Of the place: corners of one plate element, from `Structure.nearest_place`.
    direction
        Unit vector in the plate, shape (3,).
    side
        ``"top"`` or ``"bottom"``.

    Raises
    ------
    InputError
        If the place is on no plate, or the direction is square to it.
    """
    structure = model.structure
    assert structure is not None
    for shells in structure.shells:
        element = np.flatnonzero(np.isin(shells.elements, nodes).all(axis=1))
        if len(nodes) == shells.elements.shape[1] and element.size:
            break
    else:
        raise InputError("is on no plate", expected="a point on a plate")
    points, _ = _plate_points(model, shells)
    corners = model.nodes[shells.elements[element[0]]]
    normal = np.cross(corners[2] - corners[0], corners[-1] - corners[1])
    assert points.axes is not None
    found = np.zeros(model.dof_count)
    for node, weight in zip(nodes, weights, strict=True):
        own = np.flatnonzero(points.nodes == node)
        point = own[int(np.argmax(points.axes[own, 2] @ normal))]
        along = points.axes[point, :2] @ direction
        length = float(np.linalg.norm(along))
        if length < _SQUARE:
            raise InputError("is square to the plate", expected="a direction along the surface")
        c, s = along / length
        rows = np.array([c * c, s * s, 2.0 * c * s])
        for layer, sign in zip(points.layers, (1.0, 1.0 if side == "top" else -1.0), strict=True):
            found += sign * weight * (rows @ layer[3 * point : 3 * point + 3].toarray())
    return found


def _beam_points(model: FEModel, beams: Beams) -> StressPoints:
    """Corners of the section at both ends of each beam; its centroid if the section has no corners."""
    structure = model.structure
    assert structure is not None
    found = beam_stress(structure, beams, model)
    return LinearPoints(
        name=beams.name,
        positions=found.positions,
        nodes=found.nodes,
        thickness=np.full(len(found.nodes), np.nan),
        sides=(SURFACE,),
        layers=(found.normal,),
        count=1,
    )


@dataclass(frozen=True, eq=False)
class _PartOfSolids(SolidPoints):
    """Nodes of some solids of a structure."""

    own: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def columns(self, shapes: NDArray[np.float64], part: Any) -> NDArray[np.float64]:
        """As of a body that is these solids alone."""
        dofs = (3 * self.own[:, np.newaxis] + np.arange(3)).ravel()
        return super().columns(shapes[dofs], part)


def _points_of_solids(model: FEModel, solids: Solids) -> StressPoints:
    own, elements = np.unique(solids.elements, return_inverse=True)
    mesh = Mesh(model.nodes[own], elements.reshape(solids.elements.shape), solids.element_type)
    made = solid_points(mesh, solids.material, name=solids.name)
    return _PartOfSolids(
        name=made.name,
        positions=made.positions,
        nodes=own,
        thickness=made.thickness,
        gradients=made.gradients,
        elasticity=made.elasticity,
        own=own,
    )
