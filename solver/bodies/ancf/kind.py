"""The kinds of bodies made of ANCF elements: where everything is in their arrays.

Frames and shells differ in their elements only. Coordinates are those of the nodes, in the axes of the body as
it was placed, which stand still::

    M q'' + Q(q) = f,    M constant,    Q = B(q)^T C e(q) + K_b q

with strains ``e`` at Gauss points and a constant bending matrix ``K_b`` (zero for the exact frame, whose
curvatures are strains too). The step matrix ``M + h^2/4 (B^T C B + K_b)`` has blocks of whole nodes.

Joints, forces and ropes see a body through its *bases*: vectors at material points (position, slopes)
that are linear in the coordinates, ``y = J q``. Bases are nodes of the factor too, never eliminated: the Schur
complement ``-J A^-1 J^T`` that is left in their blocks is all that joints need to know of the body, and
``y'`` are its velocities in the workspace of the scene. Contacts touch points that move over the mesh, whose velocities
follow: `heavylift.solver.bodies.ancf.moving`.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.block_pattern import FactorColumn, LowerBlock
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.records import Matrix3, Record, Records, Vector, records
from heavylift.solver.combination import padded
from heavylift.solver.drive import FREE
from heavylift.solver.interface import Bodies, BodyKind, Coordinates, Workspace
from heavylift.solver.kinds import optional
from heavylift.solver.scene.meshes import FrameMeshOutputs, RodMeshOutputs, ShellMeshOutputs

__all__ = [
    "BaseBlock",
    "FixedCoordinate",
    "FrameMeshes",
    "FramePlaces",
    "MeshBase",
    "MeshElement",
    "MeshLoad",
    "MeshMarker",
    "MeshNumbers",
    "MeshPlaces",
    "MeshSensor",
    "Meshes",
    "MovingPoint",
    "MovingPoints",
    "PointsOfBody",
    "RodMeshes",
    "RodPlaces",
    "ShellMeshElement",
    "ShellMeshes",
    "ShellPlaces",
    "read_bases",
    "spread_base",
]

CARRIED, ENERGY_MOMENTUM, AUTO, EXPLICIT = range(4)
"""Values of `scheme`; `AUTO` becomes `ENERGY_MOMENTUM` when a body has `changed_over`."""

NODAL_VECTORS = (
    "position",
    "velocity",
    "mean_velocity",
    "deviation",
    "ringing",
    "mid_position",
    "mid_velocity",
    "right_hand_side",
    "external_force",
    "velocity_change",
    "free",
    "nodal_mass",
    "trial_position",
    "forward_solution",
)
"""Fields of `Meshes` over all nodes and base nodes, and the moving points behind them."""

STRAIN_VECTORS = ("strain", "shape_strain", "stage_strain", "start_strain")
"""Fields of `Meshes` over all strains."""

FRAME_PAIRS = ((0, 0), (1, 0), (1, 1))
SHELL_PAIRS = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2), (3, 3))
"""Pairs of nodes of an element, in the order of their blocks."""

CLEAR_ROW, CLEAR_LANE, CLEAR_DIAGONAL = range(3)
"""What of a block a fixed coordinate clears; the diagonal becomes 1."""

POINT_MARKER, TANGENT_MARKER, TRIAD_MARKER, VECTOR_MARKER = range(4)
"""Of a base; along a base; fixed in the triad of a base and the next one; a base itself."""

DEAD_LOAD, FOLLOWER_ELEMENT, FOLLOWER_NODE = range(3)

# sets of blocks in `blocks`
STEP_SET, MASS_SET, CONSTANT_SET = range(3)


class MeshPlaces(Record):
    """Where the parts of a body are in the arrays of its kind, and how many.

    Attributes
    ----------
    number
        Of the body in the scene.
    dof
        First velocity of its bases in the workspace.
    drift
        Record column of the drift.
    first_node, node_count, base_node_count
        Nodes of the mesh, and nodes of the factor that hold its bases; they follow those of the mesh.
    first_element, element_count, first_base, base_count, first_load, load_count
        Rows of the body.
    first_column, last_column
        First column of the factor, and the one behind its last; base nodes have none.
    first_strain, strain_count
        In a vector of strains.
    scheme
        How stress enters the step: `CARRIED` and the others.
    first_clear, clear_count
        Of the blocks with fixed coordinates.
    constants
        Place of the model number and other data of all elements in `constants`.
    first_block, last_block
        Place of its first block in a set, and the place behind its last.
    base_step
        Place in `constants` of the coefficient of the bending matrix in the constant part of the step matrix.
    work_place
        Of the scratch of the factorisation in a set.
    state_place
        Of the kind in a state vector of the accurate integrator.
    moving_count
        Points that move over the mesh; their rows of `bases` follow those of the bases.
    """

    number: int
    dof: int
    drift: int
    first_node: int
    node_count: int
    base_node_count: int
    first_element: int
    element_count: int
    first_column: int
    last_column: int
    first_base: int
    base_count: int
    first_load: int
    load_count: int
    first_strain: int
    strain_count: int
    scheme: int
    first_clear: int
    clear_count: int
    constants: int
    first_block: int
    last_block: int
    base_step: int
    work_place: int
    state_place: int
    moving_count: int


class FramePlaces(MeshPlaces):
    """Of a frame.

    Attributes
    ----------
    parts
        What is recorded of its nodes and elements.
    """

    parts: FrameMeshOutputs


class RodPlaces(MeshPlaces):
    """Of a rod.

    Attributes
    ----------
    parts
        What is recorded of its nodes and elements.
    """

    parts: RodMeshOutputs


class ShellPlaces(MeshPlaces):
    """Of a shell.

    Attributes
    ----------
    parts
        What is recorded of its nodes and elements.
    """

    parts: ShellMeshOutputs


class MeshNumbers(Record, whole_lines=True):
    """Numbers of a body.

    Attributes
    ----------
    rotation, origin
        Axes of the body as columns, and its origin [m].
    viscous_damping, stiffness_damping
        Of the body [1/s] and [s].
    drift_tolerance, drift, drift_element, largest_drift
        Largest distance of carried strains from those of the shape: allowed, of the last check with the element where
        it is, so far [1].
    strained, strain_level, largest_share
        Largest strain of the shape at the last check, lately, and the largest part of it that a drift has been [1].
    changed_over, change_time
        Whether the energy-momentum scheme has taken over, and when [s].
    external_work, dissipated_work
        Of loads, and lost in dampers [J].
    elastic_energy
        Of the last record [J].
    mass, size
        In all [kg], and largest extension [m].
    step_limit
        Of the explicit scheme [s].
    time
        Of the stage [s].
    stage_set
        Set of blocks whose factor the stage is solved with.
    last_step
        Length of the last step [s]; 0 if velocities have jumped since, or before the first one.
    ringing, motion
        Kinetic energy of the ringing and of the motion at the ends of steps, means over some fifty of them [J].
    largest_ringing, largest_motion
        Largest of these so far [J].
    iterations, change, change_before
        Of the energy-momentum scheme: rounds in the step, last change [m] and the one before; a negative change before
        the first round.
    scratch
        For any use.
    """

    rotation: Matrix3
    origin: Vector
    viscous_damping: float
    stiffness_damping: float
    drift_tolerance: float
    drift: float
    drift_element: int
    changed_over: bool
    external_work: float
    dissipated_work: float
    elastic_energy: float
    mass: float
    step_limit: float
    time: float
    stage_set: int
    iterations: int
    size: float
    change: float
    change_time: float
    change_before: float
    largest_drift: float
    strained: float
    strain_level: float
    largest_share: float
    last_step: float
    ringing: float
    motion: float
    largest_ringing: float
    largest_motion: float
    scratch: Matrix3


class MeshElement(Record):
    """An element of a frame, and what those of shells begin with.

    Attributes
    ----------
    nodes
        Offsets in a nodal vector; frames use two.
    data
        Place in `constants`: element matrices, then what the type of element needs.
    strain
        Place in a vector of strains.
    blocks
        Place of a block of the factor, and 1 if it is stored transposed, of each pair of nodes.
    """

    nodes: Annotated[NDArray[np.int64], (4,)]
    data: int
    strain: int
    blocks: Annotated[NDArray[np.int64], (3, 2)]


class ShellMeshElement(MeshElement):
    """An element of a shell: it has more pairs of nodes."""

    blocks: Annotated[NDArray[np.int64], (10, 2)]


class MeshBase(Record):
    """A base of a body, or a moving point.

    Attributes
    ----------
    element
        Where it is; -1 of a moving point, of which the place alone is known.
    shape_values
        Place of its shape values in `constants`.
    place
        Of its three numbers in a nodal vector.
    blocks
        Places of the blocks that couple it with the nodes of the element.
    """

    element: int
    shape_values: int
    place: int
    blocks: Annotated[NDArray[np.int64], (4,)]


class MeshMarker(Record):
    """A marker: number in the workspace, row of its body, base, type, place of its data in `constants`, level."""

    number: int
    body: int
    base: int
    type: int
    data: int
    level: int


class MeshSensor(Record):
    """A material point whose motion is recorded.

    Attributes
    ----------
    column
        First record column.
    body, element
        Row of its body, and its element.
    shape_values
        Their place in `constants`.
    """

    column: int
    body: int
    element: int
    shape_values: int


class MeshLoad(Record):
    """A load.

    Attributes
    ----------
    type
        `DEAD_LOAD`, `FOLLOWER_ELEMENT` or `FOLLOWER_NODE`.
    data
        Its place in `constants`.
    table, table_length
        Place there of the table of its factor, times, then factors, and their number.
    place
        Element or offset of a node.
    """

    type: int
    data: int
    table: int
    table_length: int
    place: int


class FixedCoordinate(Record):
    """A fixed coordinate in a block: place of the block, `CLEAR_ROW` or another, and which row, lane or entry."""

    block: int
    part: int
    index: int


class BaseBlock(Record):
    """Block of two base nodes: row of the body, later and earlier node counted within the body, place."""

    body: int
    later: int
    earlier: int
    place: int


class MovingPoint(Record):
    """A point that moves over a mesh.

    Attributes
    ----------
    first_entry, entry_count
        Of its entries.
    vectors
        Place of its three vectors.
    path, path_count
        First of the columns of the factor in which these are not zero, and their number.
    live
        Between aiming and the end of the stage.
    current_set
        Set of blocks that the vectors belong to, -1 for none.
    fresh
        While its compliance is missing.
    """

    first_entry: int
    entry_count: int
    vectors: int
    path: int
    path_count: int
    live: bool
    current_set: int
    fresh: bool


class PointsOfBody(Record):
    """First moving point of a body, place of the matrix of all of them, first control point of its shape."""

    first_point: int
    compliance: int
    first_control: int


class MovingPoints(Arrays):
    """Moving points of all frames or all shells of a scene.

    Attributes
    ----------
    bodies
        By body.
    points
        Bodies in order.
    entries, factors
        A point is a sum of nodal vectors: their places in a nodal vector, and factors.
    vectors
        ``Z``: three vectors over the nodes and base nodes of the body, of each point; flat.
    paths
        Columns of the factor, flat.
    compliance
        ``J A^-1 J^T`` of all points of a body, by rows, of each body; flat.
    column_of
        Column of each node, -1 of base nodes.
    marks
        Scratch, 1 for nodes that the substitution has reached.
    control_places, control_factors
        A control point of the shape of a mesh is a sum of nodal vectors; shapes (controls, 4).
    """

    bodies: Records[PointsOfBody]
    points: Records[MovingPoint]
    entries: Ints1
    factors: Floats1
    vectors: Floats1
    paths: Ints1
    compliance: Floats1
    column_of: Ints1
    marks: Ints1
    control_places: Ints2
    control_factors: Floats2


class Meshes(BodyKind):
    """All frames, or all shells, of a scene.

    Attributes
    ----------
    table
        Where things are, by body.
    elements
        Bodies in order.
    constants
        Data of elements, bases and loads, flat.
    body
        Numbers by body.
    position, velocity
        Nodal vectors, as all others to `forward_solution`: over all nodes and base nodes, and the moving points behind
        them. Carried coordinates and their rates.
    mean_velocity, deviation, ringing
        Of the last step: mean rates of the coordinates; distance of the velocities at its end from those that the mean
        rates extend to; the part of this that changes its sign with every step (`heavylift.solver.ringing`).
    mid_position
        Predicted midpoint, or the present state where forces are evaluated.
    mid_velocity
        Velocities of the stage, then scratch of the projection.
    right_hand_side
        Of the stage, and its solution.
    external_force
        Of the stage: loads, gravity, forces on bases.
    velocity_change
        To the midpoint, in an iteration.
    free
        1, or 0 for coordinates that are fixed.
    nodal_mass
        M times a unit acceleration along x, y, z: lies in the position vectors as one number a vector.
    trial_position
        Coordinates at the end of the step in an iteration; the vector of the power iteration in explicit schemes.
    forward_solution
        Right-hand side after forward substitution.
    strain
        Carried, of all elements, as all other strains.
    shape_strain
        Of the shape, scratch.
    stage_strain
        Whose stress acts in the stage.
    start_strain
        Of the shape at the start of a step that iterates.
    columns, lower, updates
        Structure of the factor: `heavylift.numerics.block_factor`.
    blocks
        Three sets of blocks: factor of the step matrix, factor of the mass matrix, constant part of the step
        matrix; flat.
    clears
        Fixed coordinates in the blocks of the pattern, bodies in order.
    base_blocks
        Of all pairs of base nodes of a body.
    bases, markers, sensors, loads
        Bodies in order; markers by level.
    moving
        The moving points of all bodies.
    shape, ends
        Block shape for `heavylift.numerics.lanes`, and as many entries as an element has nodes, which are known when a
        kernel is compiled.
    """

    NODAL: ClassVar[bool] = True
    shape: ClassVar[Any]
    ends: ClassVar[Any]
    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.ancf.accurate",
        "heavylift.solver.bodies.ancf.at_rest",
        "heavylift.solver.bodies.ancf.contours",
        "heavylift.solver.bodies.ancf.energy_momentum",
        "heavylift.solver.bodies.ancf.joints",
        "heavylift.solver.bodies.ancf.record",
        "heavylift.solver.bodies.ancf.step",
        "heavylift.solver.bodies.ancf.thesis",
    )

    carried_fields: ClassVar[tuple[str, ...]] = (
        "body",
        "position",
        "velocity",
        "mean_velocity",
        "deviation",
        "ringing",
        "trial_position",
        "strain",
    )

    table: Records[MeshPlaces]
    elements: Records[MeshElement]
    constants: Floats1
    body: Records[MeshNumbers]
    position: Floats1
    velocity: Floats1
    mean_velocity: Floats1
    deviation: Floats1
    ringing: Floats1
    mid_position: Floats1
    mid_velocity: Floats1
    right_hand_side: Floats1
    external_force: Floats1
    velocity_change: Floats1
    free: Floats1
    nodal_mass: Floats1
    trial_position: Floats1
    forward_solution: Floats1
    strain: Floats1
    shape_strain: Floats1
    stage_strain: Floats1
    start_strain: Floats1
    columns: Records[FactorColumn]
    lower: Records[LowerBlock]
    updates: Ints1
    blocks: Floats1
    clears: Records[FixedCoordinate]
    base_blocks: Records[BaseBlock]
    bases: Records[MeshBase]
    markers: Records[MeshMarker]
    sensors: Records[MeshSensor]
    loads: Records[MeshLoad]
    moving: MovingPoints

    def lengths(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Masses and largest extensions."""
        return self.body["mass"], self.body["size"]

    @property
    def hidden_coordinates(self) -> int:
        """Free ones of the nodes beyond those of the bases."""
        return int(self.free.sum()) - 3 * int(self.table["base_count"].sum())

    def _nodes(self, body: int) -> slice:
        """Places of the nodes of a body."""
        lanes = len(self.shape[1])
        first = int(self.table[body].first_node) * lanes
        return slice(first, first + int(self.table[body].node_count) * lanes)

    def _spread(self, body: int, wanted: NDArray[np.float64]) -> NDArray[np.float64]:
        """Motion of all nodes that gives the bases what is wanted, flat over their places.

        By ``E = M^-1 J^T (J M^-1 J^T)^+``: of all motions that do so the one with the least kinetic energy.
        """
        count = len(wanted)
        own = self._nodes(body)
        first = int(self.table[body].first_base)
        places = np.add.outer(self.bases["place"][first : first + count // 3], np.arange(3)).ravel()
        right = self.right_hand_side
        motions = np.zeros((count, own.stop - own.start))
        compliance = np.zeros((count, count))
        for i in range(count):
            right[own] = 0.0
            right[places] = 0.0
            right[places[i]] = -1.0
            spread_base(self, body)
            motions[i] = right[own]
            read_bases(self, body, self.right_hand_side, compliance[i])
        size = np.sqrt(np.diag(compliance))
        size[size == 0.0] = 1.0
        weights = np.linalg.pinv(compliance / np.outer(size, size), rcond=1e-11, hermitian=True) @ (
            wanted / size
        )
        return (weights / size) @ motions

    def survey(
        self, places: NDArray[np.float64], inertia: NDArray[np.float64], velocity: NDArray[np.float64]
    ) -> None:
        """Centre of mass and mean velocity of the body; its mass for each velocity of a base."""
        for body, line in enumerate(self.table):
            own = self._nodes(body)
            lanes, numbers = len(self.shape[1]), self.body[body]
            rotation = numbers.rotation
            rows = [
                nodal[own].reshape(-1, lanes)[:, : len(self.shape[0])].reshape(-1, 3)
                for nodal in (self.nodal_mass, self.position)
            ]
            centre = (rows[0] * rows[1]).sum(axis=0) / numbers.mass
            places[line.number, 0] = line.dof
            places[line.number, 1:4] = numbers.origin + rotation @ centre
            places[line.number, 4:] = 1.0, 0.0, 0.0, 0.0
            count = 3 * int(line.base_count)
            inertia[line.dof : line.dof + count] = numbers.mass
            read_bases(self, body, self.velocity, velocity[line.dof : line.dof + count])

    def move(self, increment: NDArray[np.float64]) -> None:
        """Displace the bases, and all nodes with them."""
        for body, line in enumerate(self.table):
            wanted = increment[line.dof : line.dof + 3 * line.base_count]
            if np.any(wanted):
                self.position[self._nodes(body)] += self._spread(body, wanted)

    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """Velocities of the bases; the other nodes change as little as possible."""
        for body, line in enumerate(self.table):
            count = 3 * int(line.base_count)
            own, before = self._nodes(body), np.zeros(count)
            read_bases(self, body, self.velocity, before)
            change = velocity[line.dof : line.dof + count] - before
            if np.any(change):
                self.velocity[own] += self._spread(body, change)
            self.mean_velocity[own] = self.velocity[own]
            self.deviation[own] = self.ringing[own] = 0.0
            self.body[body].last_step = 0.0

    def collect_load(self, work: Workspace, load: NDArray[np.float64]) -> None:
        """Nothing: equilibrium of a mesh is found with all its coordinates, not with its bases."""

    def place_coordinates(self, place: int) -> tuple[Records[Coordinates], int]:
        """Coordinates in a state vector of the accurate integrator, from a place on, and the place behind them.

        Nodal vectors of the kind stand there as they are, coordinates, then velocities.
        """
        place, count, lanes = padded(place), len(self.position), len(self.shape[1])
        table, found = self.table, records(Coordinates, len(self.table))
        table["state_place"] = place
        found["number"], found["motion"], found["reach"] = table["number"], FREE, self.body["size"]
        found["place"] = place + lanes * table["first_node"]
        found["velocity"] = found["place"] + count
        found["count"], found["stride"] = lanes * table["node_count"], lanes
        return found, place + 2 * count

    def write_state(self, values: Floats1) -> None:
        """Carried state into a state vector; velocities of the bases follow from it."""
        place, count = self.table[0].state_place, len(self.position)
        values[place : place + count] = self.position
        values[place + count : place + 2 * count] = self.velocity


@optional("rest")
def read_bases(kinds: Bodies, body: int, nodal: Floats1, out: Floats1) -> None:
    """Values of a nodal vector at the bases of a body, body axes, shape (3 bases,): `survey` calls it."""


@optional("rest")
def spread_base(kinds: Bodies, body: int) -> None:
    """`right_hand_side`, with minus the impulses in the places of the bases, becomes velocities of nodes."""


class FrameMeshes(Meshes):
    """All frames of a scene: 6 rows, 8 lanes: ``r``, ``r'``, two of padding in a nodal vector."""

    table: Records[FramePlaces]

    shape: ClassVar[Any] = block_shape(6)
    ends: ClassVar[Any] = (0, 0)
    kernel_modules: ClassVar[tuple[str, ...]] = (
        *Meshes.kernel_modules,
        "heavylift.solver.bodies.ancf.frame_elements",
    )


class RodMeshes(Meshes):
    """All rods of a scene: 12 rows, 16 lanes: ``r``, ``r'``, and two directors of the section."""

    table: Records[RodPlaces]

    shape: ClassVar[Any] = block_shape(12)
    ends: ClassVar[Any] = (0, 0)
    kernel_modules: ClassVar[tuple[str, ...]] = (
        *Meshes.kernel_modules,
        "heavylift.solver.bodies.ancf.rod_elements",
    )


class ShellMeshes(Meshes):
    """All shells of a scene: 12 rows, 16 lanes: ``r``, ``r_x``, ``r_y``, ``r_xy``."""

    table: Records[ShellPlaces]
    elements: Records[ShellMeshElement]

    shape: ClassVar[Any] = block_shape(12)
    ends: ClassVar[Any] = (0, 0, 0, 0)
    kernel_modules: ClassVar[tuple[str, ...]] = (
        *Meshes.kernel_modules,
        "heavylift.solver.bodies.ancf.shell_elements",
    )
