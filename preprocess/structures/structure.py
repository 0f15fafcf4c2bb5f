"""What a block is made of: plates, stiffeners, solids, masses and rigid elements between nodes.

Readers of decks, CAD surfaces and the builder of panels make a `Structure`; one assembly makes a finite element
model of it. All in SI units, in one frame.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.structures.places import nearest_place, surface_faces, surface_triangles

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.material import Material
    from heavylift.preprocess.structures.sections import BeamSection

__all__ = ["Average", "Beams", "PointMass", "RigidLink", "Shells", "Solids", "Structure", "Tie"]


@dataclass(frozen=True, eq=False)
class Shells:
    """Plates of one property: quadrilaterals or triangles.

    Attributes
    ----------
    name
        Of the property: a plate group of the report.
    elements
        Zero-based nodes, anticlockwise seen from the side of the normal, shape (ne, 4) or (ne, 3).
    material
        Of the plate.
    thickness
        [m], shape (ne,), or one number for all.
    offset
        From the nodes to the mid-surface along the normal [m], shape (ne,), or one number for all.
    nonstructural_mass
        [kg/m2].
    bends, stretches
        Whether the plate has bending and membrane stiffness.
    bending_factor
        Ratio of the bending stiffness to that of a homogeneous plate, ``12 I / t^3``.
    shear_factor
        Ratio of the thickness that carries transverse shear; 0 for none of its flexibility.
    numbers
        Of the elements in their file; empty if they have none.
    """

    name: str
    elements: NDArray[np.int64]
    material: Material
    thickness: NDArray[np.float64] | float
    offset: NDArray[np.float64] | float = 0.0
    nonstructural_mass: float = 0.0
    bends: bool = True
    stretches: bool = True
    bending_factor: float = 1.0
    shear_factor: float = 5.0 / 6.0
    numbers: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Beams:
    """Straight Timoshenko beams of one section.

    Attributes
    ----------
    name
        Of the property.
    elements
        Zero-based nodes, shape (ne, 2).
    material
        Of the beam.
    section
        Area, second moments, torsion and shear, and the outline for stress.
    orientation
        A vector in plane 1, which the first second moment bends in, shape (ne, 3) or (3,); not along the beam.
    offset_a, offset_b
        From the nodes to the centroid of the section at both ends [m], shape (ne, 3) or (3,), axes of the structure.
    released
        Degrees of freedom that an end does not pass on (u, v, w, turns about axes 1, 2, 3 of the beam; first end,
        then the second), shape (ne, 12) or (12,).
    numbers
        Of the elements in their file; empty if they have none.
    """

    name: str
    elements: NDArray[np.int64]
    material: Material
    section: BeamSection
    orientation: NDArray[np.float64]
    offset_a: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    offset_b: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    released: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(12, dtype=bool))
    numbers: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Solids:
    """Solid elements of one type and material, between nodes of the structure.

    Attributes
    ----------
    name
        Of the property.
    elements
        Zero-based nodes in the order of VTK, shape (ne, nodes of an element).
    element_type
        ``"hex8"``, ``"hex20"`` or ``"tet10"``.
    material
        Of the solid.
    numbers
        Of the elements in their file; empty if they have none.
    """

    name: str
    elements: NDArray[np.int64]
    element_type: str
    material: Material
    numbers: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class PointMass:
    """A rigid mass that a node carries.

    Attributes
    ----------
    node
        Zero-based.
    mass
        [kg].
    offset
        From the node to its centre [m], shape (3,).
    inertia
        About its centre [kg m2], shape (3, 3); products with the sign of the tensor.
    name
        For messages.
    """

    node: int
    mass: float
    offset: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    inertia: NDArray[np.float64] = field(default_factory=lambda: np.zeros((3, 3)))
    name: str = ""


@dataclass(frozen=True, eq=False)
class RigidLink:
    """Nodes that follow the rigid motion of one node (RBE2, kinematic coupling, MPC BEAM).

    Attributes
    ----------
    node
        Whose three displacements and three rotations the others follow.
    dependent
        Zero-based nodes, shape (m,).
    components
        Which of u, v, w and the three rotations of the dependent nodes follow, shape (6,).
    name
        For messages.
    """

    node: int
    dependent: NDArray[np.int64]
    components: NDArray[np.bool_] = field(default_factory=lambda: np.ones(6, dtype=bool))
    name: str = ""


@dataclass(frozen=True, eq=False)
class Average:
    """A node whose motion is the weighted mean of others (RBE3, distributing coupling).

    Attributes
    ----------
    node
        That follows.
    nodes
        Whose motion is averaged, shape (m,).
    weights
        Positive, shape (m,).
    components
        Which of u, v, w and the rotations of `node` follow, shape (6,).
    name
        For messages.
    """

    node: int
    nodes: NDArray[np.int64]
    weights: NDArray[np.float64]
    components: NDArray[np.bool_] = field(default_factory=lambda: np.ones(6, dtype=bool))
    name: str = ""


@dataclass(frozen=True, eq=False)
class Tie:
    """Two nodes with equal displacements and rotations, or some of them.

    Attributes
    ----------
    node, dependent
        Zero-based; the second moves as the first does.
    components
        Which of u, v, w and the three rotations are equal, shape (6,).
    name
        For messages.
    """

    node: int
    dependent: int
    components: NDArray[np.bool_] = field(default_factory=lambda: np.ones(6, dtype=bool))
    name: str = ""


@dataclass(frozen=True, eq=False)
class Structure:
    """Nodes, and all that is between them.

    Attributes
    ----------
    nodes
        Positions [m], shape (n, 3).
    shells, beams, solids, masses, links, averages, ties
        Parts of it.
    node_groups
        Named, sorted node indices.
    numbers
        Of the nodes in their file; empty if they have none.
    name
        Where it comes from, for messages.
    notes
        What its reader found, chose and left out, one sentence each.

    Raises
    ------
    InputError
        Positions that are not finite, nodes that do not exist.
    """

    nodes: NDArray[np.float64]
    shells: tuple[Shells, ...] = ()
    beams: tuple[Beams, ...] = ()
    solids: tuple[Solids, ...] = ()
    masses: tuple[PointMass, ...] = ()
    links: tuple[RigidLink, ...] = ()
    averages: tuple[Average, ...] = ()
    ties: tuple[Tie, ...] = ()
    node_groups: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    numbers: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    name: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", np.ascontiguousarray(self.nodes, dtype=np.float64))
        source = self.name or "structure"
        if self.nodes.ndim != 2 or self.nodes.shape[1] != 3 or not np.all(np.isfinite(self.nodes)):
            raise InputError(
                f"array of shape {self.nodes.shape}",
                source=source,
                key="nodes",
                expected="finite positions of shape (n, 3)",
            )
        used = [("shells", part.name, part.elements) for part in self.shells]
        used += [("beams", part.name, part.elements) for part in self.beams]
        used += [("solids", part.name, part.elements) for part in self.solids]
        used += [("links", link.name, np.append(link.dependent, link.node)) for link in self.links]
        used += [("averages", one.name, np.append(one.nodes, one.node)) for one in self.averages]
        used += [("ties", tie.name, np.array([tie.node, tie.dependent])) for tie in self.ties]
        used += [("masses", mass.name, np.array([mass.node])) for mass in self.masses]
        used += [("node_groups", name, nodes) for name, nodes in self.node_groups.items()]
        for kind, name, nodes in used:
            wrong = nodes[(nodes < 0) | (nodes >= len(self.nodes))]
            if wrong.size:
                raise InputError(
                    f"node index {wrong.ravel()[0]}",
                    source=source,
                    key=f"{kind} {name}".strip(),
                    expected=f"zero-based indices below the node count {len(self.nodes)}",
                )

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def element_count(self) -> int:
        """Number of shells, beams and solids."""
        parts: tuple[Shells | Beams | Solids, ...] = (*self.shells, *self.beams, *self.solids)
        return sum(len(part.elements) for part in parts)

    def nearest_place(
        self, point: NDArray[np.float64]
    ) -> tuple[NDArray[np.int64], NDArray[np.float64], float]:
        """Nodes and weights at the place of the structure nearest to a point, and its distance [m].

        Plates and beams count where their nodes are, whatever their offset.
        """
        return nearest_place(
            self.nodes,
            [part.elements for part in self.shells],
            [part.elements for part in self.beams],
            [(part.element_type, part.elements) for part in self.solids],
            point,
        )

    def boundary_faces(self) -> NDArray[np.int64]:
        """Plates, and outer faces of eight-node bricks, shape (nf, 4).

        Plates are wound about their normals, triangles with their last node twice; faces of bricks outwards.
        """
        return surface_faces(
            self.nodes,
            [part.elements for part in self.shells],
            [part.elements for part in self.solids if part.element_type == "hex8"],
        )

    def boundary_triangles(self) -> NDArray[np.int64]:
        """Triangles of the surface, shape (nt, 3): plates once, about their normals, and outer faces of solids."""
        return surface_triangles(
            self.nodes,
            [part.elements for part in self.shells],
            [(part.element_type, part.elements) for part in self.solids],
        )
