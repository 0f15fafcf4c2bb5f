"""Points of structures at which stress is recovered: nodes and centres of plates, corners of the sections of beams.

*Plates*: stress of the membrane, ``D eps``, and of bending at the surface, ``t/2 D kappa``, by the strains of the
elements (with what they condense) at their integration points, extrapolated to the nodes, turned to common axes, and
averaged over the elements around a node that have one property, thickness and normal; never over a change of thickness
or material, nor over one of the normal by more than `LARGEST_TURN`. Top is the side of the normal.

*Beams*: normal stress ``N/A - M_3 y/I + M_2 z/I`` at the corners of the section at both ends, with the product of
inertia of the section; shear and torsion are left out. Not averaged.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.modal.stress_points import SURFACE, SolidPoints, StressPoints, solid_points
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.structures.assemble import shell_chunks
from heavylift.preprocess.structures.beam import beam_operators
from heavylift.preprocess.structures.shell_operators import BENDING, MEMBRANE, plane_stress

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.material import Material
    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.preprocess.structures.structure import Beams, Shells, Solids

__all__ = ["CENTRE", "LARGEST_TURN", "PLATE_SIDES", "structure_points"]

PLATE_SIDES = ("top", "bottom", "membrane", "bending")
"""Sides of plates at their nodes: the whole stress on both surfaces, and its parts."""
CENTRE = "centre"
"""Membrane stress at the centres of plate elements."""
LARGEST_TURN = np.radians(20.0)
"""Between normals of plates whose stresses are averaged [rad]."""

_SAME = 1e-6  # of a thickness


@dataclass(frozen=True, eq=False)
class LinearPoints(StressPoints):
    """Points whose stress is a sparse matrix times the degrees of freedom.

    Attributes
    ----------
    operator
        Rows by point, layer and component, sparse (m layers components, N).
    count
        Components of the stress of a layer.
    """

    operator: csr_array | None = None
    count: int = 3

    @property
    def components(self) -> int:  # type: ignore[override]
        """Three of a plate, in the axes of the point; the normal one of a beam."""
        return self.count

    def columns(self, shapes: NDArray[np.float64], part: Any) -> NDArray[np.float64]:
        """Rows of the points times the shapes."""
        layers, own = self.from_layers.shape[1], self.count
        points = np.arange(len(self))[part]
        rows = (points[:, np.newaxis] * layers * own + np.arange(layers * own)).ravel()
        assert self.operator is not None
        found = np.asarray(self.operator[rows] @ shapes)
        return found.reshape(len(points), layers, own, -1)


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

    shells: dict[str, list[Shells]] = {}
    for part in filter(chosen, structure.shells):
        shells.setdefault(part.name, []).append(part)
    found: list[StressPoints] = []
    for parts in shells.values():
        found += _plate_points(model, parts)
    found += [_beam_points(model, part) for part in filter(chosen, structure.beams)]
    found += [_points_of_solids(model, part) for part in filter(chosen, structure.solids)]
    return found


class _Corners(NamedTuple):
    """Corners of the plate elements of a property, element by element.

    Attributes
    ----------
    node, thickness, material
        Shape (k,).
    axes
        Of their elements, shape (k, 3, 3).
    """

    node: NDArray[np.int64]
    thickness: NDArray[np.float64]
    material: NDArray[np.int64]
    axes: NDArray[np.float64]


class _Centres(NamedTuple):
    """Centres of the plate elements of a property: place [m], one of their nodes, thickness [m] and axes."""

    positions: NDArray[np.float64]
    node: NDArray[np.int64]
    thickness: NDArray[np.float64]
    axes: NDArray[np.float64]


class _Averages(NamedTuple):
    """Points that corners are averaged to.

    Attributes
    ----------
    seeds
        Corner whose node, thickness and axes each point has, shape (m,).
    owner
        Point of each corner, shape (k,).
    members
        How many corners each point has, shape (m,).
    """

    seeds: NDArray[np.int64]
    owner: NDArray[np.int64]
    members: NDArray[np.int64]


def _plate_points(model: FEModel, parts: list[Shells]) -> list[StressPoints]:
    """Points of a property at its nodes, and at the centres of its elements."""
    from scipy.sparse import csr_array, vstack

    structure = model.structure
    assert structure is not None
    corners, centres = _corners(model, parts)
    averages = _averaged(corners)
    axes = corners.axes[averages.seeds]
    at_nodes: list[csr_array] = []
    at_centres: list[csr_array] = []
    first = 0
    for shells in parts:
        D = plane_stress(shells.material)
        for _, elements, operators, thickness, _ in shell_chunks(structure, shells):
            ne, width = elements.shape
            dofs = _element_dofs(model, elements)
            strain = operators.strain
            stress = np.zeros((ne, strain.shape[1], 2, 3, strain.shape[3]))
            if shells.stretches:
                stress[:, :, 0] = np.matmul(D, strain[:, :, MEMBRANE])
            if shells.bends:
                stress[:, :, 1] = np.matmul(D, strain[:, :, BENDING]) * (0.5 * thickness)[:, None, None, None]
            middle = stress[:, :, :1].mean(axis=1)
            at_centres.append(_sparse(np.arange(ne), middle, dofs, ne, model.dof_count))
            extrapolated = np.einsum("ap,eplcd->ealcd", np.linalg.inv(operators.shape), stress)
            owner = averages.owner[first : first + ne * width]
            rows = _turned(
                extrapolated.reshape(ne * width, 2, 3, -1),
                np.repeat(operators.axes, width, axis=0),
                axes[owner],
            )
            rows /= averages.members[owner, np.newaxis, np.newaxis, np.newaxis]
            points, places = np.unique(owner, return_inverse=True)
            # of the points that this chunk has corners of, in their order
            local = _sparse(
                places.ravel(), rows, np.repeat(dofs, width, axis=0), len(points), model.dof_count
            )
            at_nodes.append(_spread(local, points, len(axes)))
            first += ne * width
    node = corners.node[averages.seeds]
    name = parts[0].name
    return [
        LinearPoints(
            name=name,
            positions=model.nodes[node],
            nodes=node,
            thickness=corners.thickness[averages.seeds],
            sides=PLATE_SIDES,
            from_layers=np.array([[1.0, 1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]),
            total=np.array([True, True, False, False]),
            axes=axes,
            operator=sum(at_nodes[1:], start=at_nodes[0]),
        ),
        LinearPoints(
            name=name,
            positions=centres.positions,
            nodes=centres.node,
            thickness=centres.thickness,
            sides=(CENTRE,),
            total=np.zeros(1, dtype=bool),
            axes=centres.axes,
            operator=csr_array(vstack(at_centres, format="csr")),
        ),
    ]


def _corners(model: FEModel, parts: list[Shells]) -> tuple[_Corners, _Centres]:
    """Corners and centres of all elements of a property, in the order of `shell_chunks`."""
    structure = model.structure
    assert structure is not None
    known: list[Material] = []
    corners: list[_Corners] = []
    centres: list[_Centres] = []
    for shells in parts:
        if shells.material not in known:
            known.append(shells.material)
        material = known.index(shells.material)
        for _, elements, operators, thickness, _ in shell_chunks(structure, shells):
            ne, width = elements.shape
            corners.append(
                _Corners(
                    elements.ravel(),
                    np.repeat(thickness, width),
                    np.full(ne * width, material),
                    np.repeat(operators.axes, width, axis=0),
                )
            )
            middle = model.nodes[elements].mean(axis=1)
            centres.append(_Centres(middle, elements[:, 0], np.array(thickness), operators.axes))
    return (
        _Corners(*(np.concatenate(column) for column in zip(*corners, strict=True))),
        _Centres(*(np.concatenate(column) for column in zip(*centres, strict=True))),
    )


def _averaged(corners: _Corners) -> _Averages:
    """Points of corners that have one node, material and thickness, and normals that differ little from the first's."""
    node, axes = corners.node, corners.axes
    steps = np.round(np.log(corners.thickness) / _SAME).astype(np.int64)
    _, family = np.unique(np.column_stack([node, corners.material, steps]), axis=0, return_inverse=True)
    family = family.ravel()
    seed = np.full(len(node), -1, dtype=np.int64)
    while (left := np.flatnonzero(seed < 0)).size:
        first = np.full(int(family.max()) + 1, -1, dtype=np.int64)
        first[family[left[::-1]]] = left[::-1]
        chief = first[family[left]]
        near = np.einsum("ki,ki->k", axes[left, 2], axes[chief, 2]) >= np.cos(LARGEST_TURN)
        seed[left[near]] = chief[near]
    seeds, owner = np.unique(seed, return_inverse=True)
    return _Averages(seeds, owner.ravel(), np.bincount(owner.ravel()))


def _spread(rows: csr_array, points: NDArray[np.int64], count: int) -> csr_array:
    """Six rows of each of some points among those of all of them."""
    from scipy.sparse import csr_array

    lengths = np.zeros(6 * count, dtype=np.int64)
    lengths[(6 * points[:, np.newaxis] + np.arange(6)).ravel()] = np.diff(rows.indptr)
    starts = np.concatenate([[0], np.cumsum(lengths)])
    return csr_array((rows.data, rows.indices, starts), shape=(6 * count, rows.shape[1]))


def _turned(
    rows: NDArray[np.float64], axes: NDArray[np.float64], common: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Plane stresses (k, 2, 3, columns) along axes turned in the plane of each corner to those of its point."""
    along = common[:, 0] - np.einsum("ki,ki->k", common[:, 0], axes[:, 2])[:, None] * axes[:, 2]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    c = np.einsum("ki,ki->k", along, axes[:, 0])
    s = np.einsum("ki,ki->k", along, axes[:, 1])
    turn = np.stack(
        [
            np.stack([c * c, s * s, 2.0 * c * s], axis=1),
            np.stack([s * s, c * c, -2.0 * c * s], axis=1),
            np.stack([-c * s, c * s, c * c - s * s], axis=1),
        ],
        axis=1,
    )
    return np.matmul(turn[:, np.newaxis], rows)


def _element_dofs(model: FEModel, elements: NDArray[np.int64]) -> NDArray[np.int64]:
    """Degrees of freedom of elements, six a node, -1 where there is none, shape (ne, 6 nodes)."""
    ne, width = elements.shape
    dofs = np.empty((ne, width, 6), dtype=np.int64)
    dofs[..., :3] = 3 * elements[..., None] + np.arange(3)
    turns = model.rotation_dofs[elements]
    dofs[..., 3:] = np.where(turns[..., None] >= 0, turns[..., None] + np.arange(3), -1)
    return dofs.reshape(ne, 6 * width)


def _sparse(
    points: NDArray[np.int64], rows: NDArray[np.float64], dofs: NDArray[np.int64], count: int, size: int
) -> csr_array:
    """Rows (k, layers, components, columns) of some points as a sparse matrix (count layers components, size)."""
    from scipy.sparse import coo_array, csr_array

    k, layers, components, columns = rows.shape
    own = layers * components
    values = rows.reshape(k, own, columns)
    used = (values != 0.0) & (dofs >= 0)[:, np.newaxis]
    row = points[:, np.newaxis] * own + np.arange(own)
    row_index = np.broadcast_to(row[..., np.newaxis], values.shape)[used]
    column_index = np.broadcast_to(dofs[:, np.newaxis], values.shape)[used]
    return csr_array(coo_array((values[used], (row_index, column_index)), shape=(count * own, size)))


def _beam_points(model: FEModel, beams: Beams) -> StressPoints:
    """Corners of the section at both ends of each beam; its centroid if the section has no corners."""
    structure = model.structure
    assert structure is not None
    operators = beam_operators(structure.nodes, beams, source=structure.name or "structure")
    section = beams.section
    corners = section.corners if len(section.corners) else np.zeros((1, 2))
    ne, count = len(beams.elements), len(corners)
    forces = np.matmul(operators.local, operators.ends_from_nodes)
    # what acts on the face that looks along axis 1: at the second end the force of the end, at the first minus it
    faces = np.stack([-forces[:, :6], forces[:, 6:]], axis=1)  # (ne, 2, 6, 12)
    inertia = np.array(
        [[section.second_moment_1, section.product], [section.product, section.second_moment_2]]
    )
    # sigma = N/A + a y + b z with I (a, b) = (-M_3, M_2)
    weights = np.zeros((count, 6))
    weights[:, 0] = 1.0 / section.area
    slopes = np.linalg.solve(inertia, corners.T).T if len(section.corners) else np.zeros((1, 2))
    weights[:, 5], weights[:, 4] = -slopes[:, 0], slopes[:, 1]
    rows = np.einsum("cf,esfd->escd", weights, faces).reshape(ne * 2 * count, 1, 1, 12)
    dofs = np.repeat(_element_dofs(model, beams.elements), 2 * count, axis=0)
    points = np.arange(ne * 2 * count)
    across = np.einsum("ck,eki->eci", corners, operators.axes[:, 1:])
    positions = operators.ends[:, :, np.newaxis] + across[:, np.newaxis]
    return LinearPoints(
        name=beams.name,
        positions=positions.reshape(-1, 3),
        nodes=np.repeat(beams.elements.ravel(), count),
        thickness=np.full(len(points), np.nan),
        sides=(SURFACE,),
        axes=np.repeat(operators.axes, 2 * count, axis=0),
        operator=_sparse(points, rows, dofs, len(points), model.dof_count),
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
