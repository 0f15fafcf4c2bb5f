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

from typing import Any, ClassVar

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.lanes import block_shape

__all__ = ["FrameMeshes", "Meshes", "MovingPoints", "ShellMeshes"]

# columns of `table`, by body
(
    NUMBER,  # of the body in the scene
    DOF,  # first velocity of its bases in the workspace
    COLUMN,  # first record column
    FIRST_NODE,  # of the nodes of the kind
    NODES,  # of the mesh
    BASE_NODES,  # nodes of the factor that hold its bases; they follow those of the mesh
    FIRST_ELEMENT,
    ELEMENTS,
    FIRST_COLUMN,  # of the factor
    LAST_COLUMN,  # behind its last; base nodes have none
    FIRST_BASE,
    BASES,
    FIRST_LOAD,
    LOADS,
    FIRST_STRAIN,  # in a row of `strains`
    STRAINS,
    SCHEME,  # how stress enters the step: below
    FIRST_CLEAR,  # of the blocks with fixed coordinates
    CLEARS,
    CONSTANTS,  # place of the model number and other data of all elements in `constants`
    FIRST_BLOCK,  # place of its first block in a set
    LAST_BLOCK,  # behind its last
    BASE_STEP,  # place in `constants` of the coefficient of the bending matrix in the constant part of the step matrix
    LAST_RESULT,  # record column of the drift, the last of the body
    WORK_PLACE,  # of the scratch of the factorisation in a set
    STATE_PLACE,  # of the kind in a state vector of the accurate integrator
    MOVING,  # points that move over the mesh; their rows of `bases` follow those of the bases
) = range(27)
TABLE_COLUMNS = 27

CARRIED, ENERGY_MOMENTUM, AUTO, EXPLICIT = range(4)
"""Values of `SCHEME`; `AUTO` becomes `ENERGY_MOMENTUM` in `body[CHANGED_OVER]`."""

# rows of `nodal`: carried coordinates and velocities first
(
    Q,  # coordinates
    V,  # velocities
    ACCELERATION,  # mean of the last step
    MID_Q,  # predicted midpoint, or the present state where forces are evaluated
    MID_V,  # velocities of the stage, then scratch of the projection
    RIGHT,  # right-hand side and solution of the stage
    LOAD,  # external forces of the stage: loads, gravity, forces on bases
    CHANGE_OF_V,  # of the velocities to the midpoint, in an iteration
    FREE,  # 1, or 0 for coordinates that are fixed
    WEIGHT,  # M times a unit acceleration along x, y, z: lies in the position vectors as one number a vector
    TRIAL,  # coordinates at the end of the step in an iteration
    FORWARD,  # right-hand side after forward substitution
) = range(12)
NODAL_ROWS = 12

# rows of `strains`: carried; of the shape, scratch, of the shape at the start of a step that iterates
STRAIN, SHAPE_STRAIN, OLD_STRAIN, START_STRAIN = range(4)
STRAIN_ROWS = 4

# columns of `body`, by body
(
    ROTATION,  # nine numbers: axes of the body as columns, by rows
    ORIGIN,  # three
    VISCOUS,
    STIFFNESS_DAMPING,
    DRIFT_TOLERANCE,
    DRIFT,  # largest distance of carried strains from those of the shape, of the last check
    DRIFT_ELEMENT,
    CHANGED_OVER,  # 1 once the energy-momentum scheme has taken over
    EXTERNAL,  # work of loads
    DISSIPATED_WORK,
    ELASTIC_ENERGY,  # of the last record
    MASS,
    STEP_LIMIT,  # of the explicit scheme [s]
    TIME,  # of the stage
    ITERATIONS,  # of the energy-momentum scheme, so far
    SIZE,  # largest extension [m]
    CHANGE,  # last change of an iteration
    CHANGE_TIME,  # when the energy-momentum scheme took over [s]
    BEFORE,  # the change before the last
    LARGEST_DRIFT,  # so far
    SCRATCH,  # nine numbers
) = (0, 9, *range(12, 31))
BODY_COLUMNS = 40

# columns of `elements`; nodes are offsets in a row of `nodal`
ELEMENT_NODES = 0  # four; frames use two
ELEMENT_DATA = 4  # place in `constants`: element matrices, then what the type of element needs
ELEMENT_STRAIN = 5  # place in a row of `strains`
ELEMENT_BLOCKS = 6  # place of a block of the factor and 1 if it is stored transposed, of each pair of nodes
FRAME_PAIRS = ((0, 0), (1, 0), (1, 1))
SHELL_PAIRS = ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2), (3, 3))
"""Pairs of nodes of an element, in the order of their blocks."""

# columns of `bases`: element, place of its shape values in `constants`, place of its three numbers in a row of `nodal`,
# places of the blocks that couple it with the nodes of the element; of a moving point its place alone, and element -1
BASE_ELEMENT, BASE_SHAPE, BASE_PLACE, BASE_BLOCKS = range(4)

# columns of `markers`: number in the workspace (or record column), body, base, type, place of its data, level
MARKER_NUMBER, MARKER_BODY, MARKER_BASE, MARKER_TYPE, MARKER_DATA, MARKER_LEVEL = range(6)
POINT_MARKER, TANGENT_MARKER, TRIAD_MARKER, VECTOR_MARKER = range(4)
"""Of a base; along a base; fixed in the triad of a base and the next one; a base itself."""

# columns of `loads`: type, place of its data in `constants`, place of the table of its factor (times, then factors) and
# the length of that, element or offset of a node
LOAD_TYPE, LOAD_DATA, LOAD_TABLE, LOAD_COUNT, LOAD_PLACE = range(5)
DEAD_LOAD, FOLLOWER_ELEMENT, FOLLOWER_NODE = range(3)

# sets of blocks in `blocks`
STEP_SET, MASS_SET, CONSTANT_SET = range(3)


# columns of `points` of the moving points
ENTRIES, ENTRY_COUNT, VECTORS, PATH, PATH_COUNT, LIVE, CURRENT, FRESH, POINT_COLUMNS = range(9)
"""First of its entries and their number; place of its three vectors; first of the columns of the factor in which these
are not zero, and their number; 1 between aiming and the end of the stage; set of blocks that the vectors belong to, -1
for none; 1 while its compliance is missing."""

# columns of `bodies` of the moving points
FIRST_POINT, COMPLIANCE, FIRST_CONTROL, MESH_COLUMNS = range(4)
"""First moving point; place of the matrix of all of them; first control point of the shape."""


class MovingPoints(Arrays):
    """Moving points of all frames or all shells of a scene.

    Attributes
    ----------
    bodies
        By body, see the columns; shape (bodies, 3).
    points
        By moving point, bodies in order, see the columns; shape (n, 8).
    entries, factors
        A point is a sum of nodal vectors: their places in a row of `nodal`, and factors.
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

    bodies: Ints2
    points: Ints2
    entries: Ints1
    factors: Floats1
    vectors: Floats1
    paths: Ints1
    compliance: Floats1
    column_of: Ints1
    marks: Ints1
    control_places: Ints2
    control_factors: Floats2


class Meshes(Arrays):
    """All frames, or all shells, of a scene.

    Attributes
    ----------
    table
        By body, see the columns; shape (bodies, 27).
    elements
        Shape (elements, 6 + 2 pairs).
    constants
        Data of elements, bases and loads, flat.
    body
        Numbers by body, shape (bodies, 40).
    nodal
        Vectors over all nodes and base nodes, and the moving points behind them; shape (12, places).
    strains
        Vectors over all strains, shape (4, strains).
    columns, lower, updates
        Structure of the factor: `heavylift.numerics.block_factor`.
    blocks
        Three sets of blocks: factor of the step matrix, factor of the mass matrix, constant part of the step
        matrix; flat.
    clears
        Place of a block of the pattern, 0 for a row, 1 for a lane, 2 for the diagonal, and which of them is fixed;
        shape (n, 3).
    base_blocks
        Body, later and earlier base node within the body, place of their block; shape (n, 4).
    bases, markers, sensors, loads
        See the columns.
    moving
        The moving points of all bodies.
    shape
        Block shape for `heavylift.numerics.lanes`, which is known when a kernel is compiled.
    """

    shape: ClassVar[Any]

    table: Ints2
    elements: Ints2
    constants: Floats1
    body: Floats2
    nodal: Floats2
    strains: Floats2
    columns: Ints2
    lower: Ints2
    updates: Ints1
    blocks: Floats1
    clears: Ints2
    base_blocks: Ints2
    bases: Ints2
    markers: Ints2
    sensors: Ints2
    loads: Ints2
    moving: MovingPoints


class FrameMeshes(Meshes):
    """All frames of a scene: 6 rows, 8 lanes: ``r``, ``r'``, two of padding in a row of `nodal`."""

    shape: ClassVar[Any] = block_shape(6)
    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.ancf.accurate",
        "heavylift.solver.bodies.ancf.advance",
        "heavylift.solver.bodies.ancf.at_rest",
        "heavylift.solver.bodies.ancf.contours",
        "heavylift.solver.bodies.ancf.elastic_forces",
        "heavylift.solver.bodies.ancf.energy_momentum",
        "heavylift.solver.bodies.ancf.facets",
        "heavylift.solver.bodies.ancf.frame_elements",
        "heavylift.solver.bodies.ancf.joints",
        "heavylift.solver.bodies.ancf.kind_configuration",
        "heavylift.solver.bodies.ancf.record",
        "heavylift.solver.bodies.ancf.stage",
        "heavylift.solver.bodies.ancf.step",
        "heavylift.solver.bodies.ancf.thesis",
    )


class ShellMeshes(Meshes):
    """All shells of a scene: 12 rows, 16 lanes: ``r``, ``r_x``, ``r_y``, ``r_xy``."""

    shape: ClassVar[Any] = block_shape(12)
    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.ancf.accurate",
        "heavylift.solver.bodies.ancf.advance",
        "heavylift.solver.bodies.ancf.at_rest",
        "heavylift.solver.bodies.ancf.contours",
        "heavylift.solver.bodies.ancf.elastic_forces",
        "heavylift.solver.bodies.ancf.energy_momentum",
        "heavylift.solver.bodies.ancf.facets",
        "heavylift.solver.bodies.ancf.joints",
        "heavylift.solver.bodies.ancf.kind_configuration",
        "heavylift.solver.bodies.ancf.record",
        "heavylift.solver.bodies.ancf.shell_elements",
        "heavylift.solver.bodies.ancf.stage",
        "heavylift.solver.bodies.ancf.step",
        "heavylift.solver.bodies.ancf.thesis",
    )
