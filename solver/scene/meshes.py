"""Descriptions of slender and thin bodies that deform at will: frames and shells of ANCF elements.

Coordinates of a node are its position and slopes of the reference shape, all in one frame that stands still:
that of the body as it was placed. Strains are those of Green-Lagrange, so displacements and rotations
are unlimited: "Integrated simulation ... (2018)", sections 2.2 and 2.3.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from dataclasses import field
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.bodies import Body, Free
from heavylift.solver.scene.drawn import Element, Skin
from heavylift.solver.scene.mesh_rates import highest_frame_frequency, highest_shell_frequency
from heavylift.solver.scene.outputs import Outputs, Part, Parts, channel, outputs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.scene.descriptions import ChannelKind

__all__ = [
    "FRAME_VECTORS",
    "ROD_VECTORS",
    "SHELL_VECTORS",
    "DistributedLoad",
    "DriftOutputs",
    "Elasticity",
    "FollowerLoad",
    "FrameBody",
    "FrameMeshOutputs",
    "FrameModel",
    "FrameSection",
    "MeshBody",
    "RodBody",
    "RodMeshOutputs",
    "ShellBody",
    "ShellMeshOutputs",
    "ShellSection",
    "ShellSide",
    "Support",
]

FRAME_VECTORS = ("position", "tangent")
"""Vectors of a node of a frame: ``r`` [m] and ``r'`` [1]."""

ROD_VECTORS = ("position", "tangent", "normal", "binormal")
"""Vectors of a node of a rod: ``r`` [m], ``r'`` [1], and two directors of its section [1]."""

SHELL_VECTORS = ("position", "slope_x", "slope_y", "twist")
"""Vectors of a node of a shell: ``r`` [m], ``r_x``, ``r_y`` [1] and ``r_xy`` [1/m]."""

Elasticity = Literal["auto", "carried", "energy-momentum", "explicit"]
"""How stress enters a step."""

FrameModel = Literal["green-lagrange", "exact"]
"""What strains of a frame are."""

ShellSide = Literal["largest", "top", "middle", "bottom"]
"""Of a shell, whose stress is meant; the largest of the other three."""

NODE_POSITION = channel("length", "position of every node in the world", None)
NODE_VELOCITY = channel("velocity", "velocity of every node in world axes", None)
NODE_TANGENT = channel("number", "derivative of the position of every node by the length, world axes", None)
ELEMENT_TENSION = channel("force", "tension in the middle of every element", None)
END_MOMENTS = channel("moment or energy", "bending moment at both ends of every element", None)
FIBRE_STRESS = channel(
    "pressure",
    "stress of largest amount of the outermost fibres of every element, N/A ± M c/I, of 13 places along it",
    None,
)


@outputs
class FrameMeshOutputs(Parts):
    """Of a frame: vectors of all nodes, then results of all elements."""

    position: Part = NODE_POSITION
    tangent: Part = NODE_TANGENT
    velocity: Part = NODE_VELOCITY
    axial_force: Part = ELEMENT_TENSION
    bending_moment: Part = END_MOMENTS
    axial_stress: Part = FIBRE_STRESS


@outputs
class RodMeshOutputs(Parts):
    """Of a frame with torsion: vectors of all nodes, then results of all elements."""

    position: Part = NODE_POSITION
    tangent: Part = NODE_TANGENT
    normal: Part = channel("number", "first director of the section at every node, world axes", None)
    velocity: Part = NODE_VELOCITY
    axial_force: Part = ELEMENT_TENSION
    twisting_moment: Part = channel("moment or energy", "moment about the axis of every element", None)
    bending_moment: Part = END_MOMENTS
    axial_stress: Part = FIBRE_STRESS


@outputs
class ShellMeshOutputs(Parts):
    """Of a shell: vectors of all nodes, then results of all elements."""

    position: Part = NODE_POSITION
    slope_x: Part = channel(
        "number",
        "derivative of the position of every node by the length along x of the mesh, world axes",
        None,
    )
    slope_y: Part = channel(
        "number",
        "derivative of the position of every node by the length along y of the mesh, world axes",
        None,
    )
    twist: Part = channel(
        "slope per length", "derivative of the position of every node by both lengths, world axes", None
    )
    velocity: Part = NODE_VELOCITY
    membrane_force: Part = channel(
        "force per length", "force in the plane by the length, in the middle of every element", None
    )
    bending_moment: Part = channel(
        "moment per length",
        "bending moment by the length, in the middle of every element",
        None,
        by_owner=True,
    )
    von_mises: Part = channel(
        "pressure",
        "von Mises stress of top, middle and bottom of every element: the largest of a grid of 7 x 7 places, sides "
        "and corners included; elements are not averaged",
        None,
    )


@outputs
class DriftOutputs(Outputs):
    """Of a frame or shell, behind the results of its elements."""

    strain_drift: float = channel("number", "largest distance of carried strains from those of the shape")


def _zeros(count: int) -> NDArray[np.float64]:
    return np.zeros(count)


def _upright() -> NDArray[np.float64]:
    return np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class FrameSection:
    """Cross-section and material of a frame: bending is the same about all axes; only rods resist torsion.

    Attributes
    ----------
    density, youngs_modulus
        [kg/m3], [Pa].
    area, second_moment
        [m2], [m4].
    outer_fibre
        Distance of the outermost fibre from the axis [m], for stresses.
    torsional_stiffness
        ``G J`` [N m2], of rods.
    """

    density: float
    youngs_modulus: float
    area: float
    second_moment: float
    outer_fibre: float = 0.0
    torsional_stiffness: float = 0.0


@dataclass(frozen=True)
class ShellSection:
    """Thickness and material of a shell: [m], [kg/m3], [Pa], 1."""

    thickness: float
    density: float
    youngs_modulus: float
    poissons_ratio: float = 0.0


@dataclass(frozen=True, eq=False)
class Support:
    """Coordinates of nodes that do not move.

    Attributes
    ----------
    nodes
        Their numbers, shape (n,).
    fixed
        Which axes of the body, ``"x"``, ``"xz"``, ..., by vector: `FRAME_VECTORS` or `SHELL_VECTORS`.
    """

    nodes: NDArray[np.int64]
    fixed: Mapping[str, str]


@dataclass(frozen=True, eq=False)
class DistributedLoad:
    """A load that keeps its direction.

    Attributes
    ----------
    load
        World axes, shape (3,): [N/m] on a frame, [N/m2] of the undeformed area of a shell.
    elements
        Numbers of the elements; all if None.
    times, factors
        Table over time [s] by which the load is multiplied, linear in between and constant beyond.
    """

    load: NDArray[np.float64]
    elements: NDArray[np.int64] | None = None
    times: NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))
    factors: NDArray[np.float64] = field(default_factory=lambda: np.ones(1))


@dataclass(frozen=True, eq=False)
class FollowerLoad:
    """A load that turns with the body.

    Attributes
    ----------
    normal
        Shell: pressure along the present normal ``r_x x r_y`` [Pa]. Frame: along ``axis x tangent`` [N/m].
    tangential
        Frame: along the tangent [N/m].
    axis
        Frame: world direction, any length, shape (3,).
    node
        Frame: the load acts on this node alone [N] in place of all elements.
    elements, times, factors
        As in `DistributedLoad`.
    """

    normal: float = 0.0
    tangential: float = 0.0
    axis: NDArray[np.float64] = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    node: int | None = None
    elements: NDArray[np.int64] | None = None
    times: NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))
    factors: NDArray[np.float64] = field(default_factory=lambda: np.ones(1))


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshBody(Body):
    """What frames and shells have in common.

    Attributes
    ----------
    name
        Prefix of its channels.
    nodes
        Positions in the frame of the body, unloaded [m], shape (n, 3).
    supports, loads
        What holds it, what acts on it beside gravity and point forces.
    position, orientation
        Of the frame of the body: origin in the world [m], unit quaternion (scalar first).
    velocity, angular_velocity
        Of its motion at the start as a rigid body: of the frame origin in world axes [m/s], body axes [rad/s].
    viscous_damping
        Force per mass and velocity [1/s].
    stiffness_damping
        Stress per stress rate [s]: damping is this times the stiffness.
    elasticity
        How stress enters the step: ``"carried"`` carries strains and solves once (linearly implicit, conserves
        an energy); ``"energy-momentum"`` iterates (J. C. Simo and N. Tarnow, Z. angew. Math. Phys. 43, 1992);
        ``"auto"`` is the first until carried strains drift too far, then the second; ``"explicit"`` takes
        forces at the midpoint, within its stability limit.
    drift_tolerance
        Distance of carried strains from those of the shape at which ``"auto"`` changes over [1].
    """

    VECTORS: ClassVar[tuple[str, ...]]
    """Names of the vectors of a node."""
    KIND_MODULE: ClassVar = "heavylift.solver.bodies.ancf.packing"
    CONTOURS: ClassVar[Literal["", "rigid", "modes", "nodes"]] = "nodes"
    SEEN_AT_POINTS: ClassVar = True
    ITERATES: ClassVar = True
    CHANNELS: ClassVar[tuple[ChannelKind, ...]]
    """What it records, in the order of its columns: vectors of all nodes, then results of all elements."""

    name: str
    nodes: NDArray[np.float64]
    supports: tuple[Support, ...] = ()
    loads: tuple[DistributedLoad | FollowerLoad, ...] = ()
    position: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    orientation: NDArray[np.float64] = field(default_factory=_upright)
    velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    angular_velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    viscous_damping: float = 0.0
    stiffness_damping: float = 0.0
    elasticity: Elasticity = "auto"
    drift_tolerance: float = 1e-3

    @property
    def motion(self) -> Free:
        """Always free: supports, not motions, hold it."""
        return Free()

    def velocity_count(self, points: int) -> int:
        """Three for each of its bases and moving points."""
        return 3 * points

    def inverse_scales(self) -> tuple[float, float]:
        """Of the given shape."""
        mass, inertia = self.kind_module.mass_and_inertia(self)
        return 1.0 / mass, 1.0 / inertia

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """By node and axis, or by element."""
        found: dict[str, tuple[str, ...]] = self.kind_module.mesh_columns(self)
        return found

    @property
    def times(self) -> list[float]:
        """Rows of the tables of its loads."""
        return [time for load in self.loads for time in np.ravel(load.times)]

    @property
    def slopes_of_nodes(self) -> NDArray[np.float64]:
        """Vectors of its nodes but their positions, in its axes, shape (n, vectors - 1, 3)."""
        raise NotImplementedError

    @property
    def lengths_of_elements(self) -> NDArray[np.float64]:
        """Of each, along it or along its sides [m], shape (e, 1 or 2)."""
        raise NotImplementedError

    @property
    def highest_frequency(self) -> float:
        """Bound of its circular frequencies [1/s], as it is placed and not stressed."""
        raise NotImplementedError

    @property
    def highest_rate(self) -> float:
        """Bound of the highest rate [1/s]: circular frequency, or rate of what damping takes away fastest."""
        frequency = self.highest_frequency
        return max(frequency, self.viscous_damping + self.stiffness_damping * frequency**2)

    def start_shapes(self) -> dict[str, tuple[int, ...]]:
        """The mesh is one of its type."""
        self.kind_module.check_mesh(self)
        return super().start_shapes()

    def drawn(self) -> Iterable[Element]:
        """Its skin with the stresses of its elements."""
        yield Skin(name=self.name, role="body", body=self)


@dataclass(frozen=True, eq=False, kw_only=True)
class FrameBody(MeshBody):
    """Cubic elements along lines.

    Without torsion a curved frame carries loads in its own plane only.

    Attributes
    ----------
    tangents
        Unit tangents at the nodes, shape (n, 3).
    elements
        First and second node of each, shape (e, 2).
    sections, element_sections
        Sections, and the number of that of each element, shape (e,); the first for all if empty.
    model
        ``"green-lagrange"``: axial strain of Green-Lagrange and bending by ``r''``; straight elements.
        ``"exact"``: ``|r'| - 1`` and the material curvature; elements may be curved.
    axial_strains
        Strain of each element in the given shape, which pre-stresses it, shape (e,); none if empty.
    """

    ORDER: ClassVar = 4
    NOUN: ClassVar = "frame"
    VECTORS: ClassVar[tuple[str, ...]] = FRAME_VECTORS
    SHAPE: ClassVar = "curve"
    HAS_AXES: ClassVar = False
    CHANNELS: ClassVar = (*FrameMeshOutputs.CHANNELS, *DriftOutputs.CHANNELS)

    tangents: NDArray[np.float64]
    elements: NDArray[np.int64]
    sections: tuple[FrameSection, ...]
    element_sections: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    model: FrameModel = "green-lagrange"
    axial_strains: NDArray[np.float64] = field(default_factory=lambda: _zeros(0))

    @property
    def slopes_of_nodes(self) -> NDArray[np.float64]:
        """Tangents."""
        return self.tangents[:, np.newaxis, :]

    @property
    def lengths_of_elements(self) -> NDArray[np.float64]:
        """Along their curves."""
        stress = importlib.import_module("heavylift.solver.bodies.ancf.stress")
        return np.asarray(stress.frame_lengths(self.nodes, self.tangents, self.elements))[:, np.newaxis]

    @property
    def highest_frequency(self) -> float:
        """Of its stiffest element."""
        return highest_frame_frequency(self.nodes, self.elements, self.sections, self.element_sections)


@dataclass(frozen=True, eq=False, kw_only=True)
class RodBody(FrameBody):
    """A frame that twists: its sections have directors, torsional stiffness and rotary inertia.

    Its model is ``"green-lagrange"``; elements may be curved, and twisted in the given shape.

    Attributes
    ----------
    normals
        First director of the section at the nodes, unit vectors square to the tangents, shape (n, 3); the second one is
        tangent x normal.
    """

    ORDER: ClassVar = 6
    VECTORS: ClassVar[tuple[str, ...]] = ROD_VECTORS
    HAS_AXES: ClassVar = True
    CONTOURS: ClassVar = ""
    CHANNELS: ClassVar = (*RodMeshOutputs.CHANNELS, *DriftOutputs.CHANNELS)

    normals: NDArray[np.float64]

    @property
    def slopes_of_nodes(self) -> NDArray[np.float64]:
        """Tangents and directors."""
        return np.stack([self.tangents, self.normals, np.cross(self.tangents, self.normals)], axis=1)

    @property
    def highest_frequency(self) -> float:
        """Of its stiffest element."""
        packing = importlib.import_module("heavylift.solver.bodies.ancf.rod_packing")
        return float(packing.highest_frequency(self))

    def refusal(self, integrator: str, *, jointed: bool) -> str:  # noqa: ARG002  the same with joints
        """Its sections vibrate far too fast for explicit schemes."""
        if integrator == "dele2":
            return ""
        return f"the sections of {self.name!r} are stiff, which takes an implicit integrator"


@dataclass(frozen=True, eq=False, kw_only=True)
class ShellBody(MeshBody):
    """Bicubic elements on quadrilaterals of a flat surface.

    Attributes
    ----------
    slopes
        ``r_x``, ``r_y`` and ``r_xy`` at the nodes, shape (n, 3, 3): derivatives of the position by lengths along
        the two directions of the mesh. They need not be unit vectors or perpendicular to each other.
    elements
        Nodes of each: origin, along x, opposite, along y; shape (e, 4).
    lengths
        Of each element along x and y [m], which the slopes refer to, shape (e, 2). Elements that share an
        edge along x have the same length along x, and so for y.
    sections, element_sections
        Sections, and the number of that of each element, shape (e,); the first for all if empty.
    gauss_points
        For membrane strains, along each direction, 3 to 7.
    """

    ORDER: ClassVar = 5
    NOUN: ClassVar = "shell"
    VECTORS: ClassVar = SHELL_VECTORS
    SHAPE: ClassVar = "surface"
    CHANNELS: ClassVar = (*ShellMeshOutputs.CHANNELS, *DriftOutputs.CHANNELS)

    slopes: NDArray[np.float64]
    elements: NDArray[np.int64]
    lengths: NDArray[np.float64]
    sections: tuple[ShellSection, ...]
    element_sections: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    gauss_points: int = 5

    @property
    def slopes_of_nodes(self) -> NDArray[np.float64]:
        """Along both sides, and twist."""
        return self.slopes

    @property
    def lengths_of_elements(self) -> NDArray[np.float64]:
        """Along their sides."""
        return self.lengths

    @property
    def highest_frequency(self) -> float:
        """Of its stiffest element."""
        return highest_shell_frequency(self.lengths, self.sections, self.element_sections)
