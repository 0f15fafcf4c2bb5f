"""The kind of contacts between contours and what touches them: a system of rows of its own beside that of the joints.

Each contact has three rows on two sides, the contour and the body that touches it: the rate of the gap along the normal
of the contour, and the two rates across it. Of a bead on a curve the first two rows are along normals of the curve, and
the third is along it. What bodies need for rows (attachments, panels, row data) has the names and the layout of the
system of the joints, so they serve both with the same functions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from heavylift.contours.packed_contour import PackedContour
from heavylift.contours.search_step import ContourSearch
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.records import Records, record_at
from heavylift.solver.kinds import Table
from heavylift.solver.rows import RowArrays

if TYPE_CHECKING:
    from heavylift.solver.contact.newton import ContactSolvers

__all__ = ["Colliding", "ContactContour", "ContactRows", "Features", "Reduced", "Samples", "search_at"]

# columns of `table`: a row is a contact
CONTOUR, SHAPE, LAW, CENTRE, AXES, COLUMN, FORCE_LAW, EVENTS, SLOT, PRIMITIVE_KIND, TABLE_WIDTH = range(11)
"""Row of the contour; what touches; law; markers of its point and of three directions (-1 without); first record
column; force law of a compliant contact; 1 to split steps at impacts; number of its moving point on a mesh; kind
of a convex primitive."""

POINT, CIRCLE, CONVEX, TRIANGLES = range(4)
"""What touches: a point or ball, a ring, another convex primitive, another surface of triangles."""

RIGID, BILATERAL, CURVE, COMPLIANT = range(4)
"""Laws: unilateral, a slider in a surface, a bead on a curve, a force law."""

# columns of `values`: constants of a contact
(
    FRICTION,
    RESTITUTION,
    REST_SPEED,
    STIFFNESS,
    EXPONENT,
    DAMPING,
    RADIUS,
    FOOTPRINT,
    EXTENT,
    SIZE,
    INVERSE_MASS,
) = range(11)
PRIMITIVE = 11
"""Coefficient; restitution; speed below which there is none [m/s]; of the force law; radius of a ball [m]; of the
footprint [m]; largest distance of the shape from its point [m]; length that makes gaps small or large [m];
characteristic inverse mass [1/kg]; then the numbers of a primitive."""

VALUE_WIDTH = 32

# columns of `state`: what a contact carries
AT_U, AT_V, GAP, GAP_2, CLOSED, RATE, SLEEP, SHIFT, SLIP = range(9)
"""Coordinates of the touched point; gap at the end of the last step [m], along both normals of a curve; 1 while closed;
rate of the gap there [m/s]; distance that the gap can close before a search is due, negative before the first one;
that by which it can have closed in the last step; elastic slip along both tangents [m]."""

NORMAL, TANGENT, FORCE, TOUCHED = 10, 13, 16, 19
"""Normal and first tangent in the world; force on what touches [N]; touched point [m]."""

IMPULSES, LOSS, IMPACTS, SLIP_PATH, SLIP_SPEED, NORMAL_FORCE, FRICTION_FORCE = range(22, 29)
"""Sum of normal impulses [N s]; energy lost [J]; impacts; path [m] and speed [m/s] of the slip; forces [N]."""

TOUCH_DAMPING, WARM, MIDDLE_FORCE, NEW, PRESENT = 29, 30, 33, 36, 37
END_GAP, END_GAP_2, SEARCH, FAILED, RECENT = 38, 39, 40, 41, 42
"""Damping of Hunt and Crossley that belongs to the present touch; impulses of the last step, which start the next
iteration; forces of the three rows in the middle of the last step [N]; 1 if it closes at the end of this step; 1
if it takes part in the present stage; gaps at the end of this step; how the last search ended; searches so far that
found nothing; impacts since the last whole step."""

(
    PAIR,
    FEATURES,
    FEATURE,
    OTHER_FEATURE,
    SIDE,
    HIT,
    BESIDE,
    START_GAP,
    PATCH,
    SHARE,
    STEP_IMPULSE,
    LEFT,
    START_BESIDE,
    START_RATE,
    POINT_SLOT,
) = range(43, 58)
STATE_WIDTH = POINT_SLOT + 2
"""Of contacts between triangles: pair of surfaces, kind of the two features and their numbers, side they were on when
they were last apart, 1 if their paths meet in this step; distance beside them [m]; gap at the start of the step they
were found in [m]; patch; part of its stiffness; normal impulse of the last step [N s]; 1 if it had slid off
its features at the end of the last step; distance beside them [m] and rate of the gap [m/s] when this one began;
numbers of its moving points on both bodies, if they deform."""

FOUND, LOST, NOT_A_NUMBER, TOO_DEEP = 0, 2, 3, 4
"""How a search ended: well; without converging or at something that is not finite, which are statuses of the
searches; the contour has reached the core of a primitive."""


class ContactContour(PackedContour):
    """A contour on a body.

    Attributes
    ----------
    owner
        Kind of its body.
    dof
        First velocity; -1 on the ground.
    controls
        Place of the data of its control points in `constants`. Of flexible bodies the largest displacements of a
        control point by each mode follow them.
    dimension
        1 of curves, 2 of surfaces.
    flip
        -1 if the normal is turned round, else 1.
    body
        Number of the body; -1 of the ground.
    """

    owner: int
    dof: int
    controls: int
    dimension: int
    flip: int
    body: int


OF_GROUND, OF_RIGID, OF_MODES, OF_MESH, OF_FACETS = range(5)

# columns of `poses`: of the axes of each contour
ROTATION, ORIGIN, REACH, STEP_SHIFT, DIRECTOR, RADIUS_OF, WIDTH_OF, POSE_WIDTH = 0, 9, 12, 13, 14, 17, 18, 20
"""Rotation matrix and origin at the stage; largest distance of a control point from the origin [m], and how far
one moves in the step at most; constants of derived contours: direction across a band, radius and width [m]."""

# places in `scratch`
RESULT, DIRECTIONS, LEVER, SLOPES, HAS_SLOPES, ARM, SHAPE_ROW, EVALUATE = (
    0,
    72,
    81,
    84,
    93,
    94,
    97,
    120,
)
"""A search, see `search_at`; directions of the three rows in the world; touched point in the axes of the contour;
factors of the rates of its tangent in the rows, and whether there are any; from the point of the shape to where it
touches, in the world; row of a primitive; scratch of evaluation and search."""

search_at = record_at(ContourSearch)
"""The search of the contact at hand, in `scratch` at RESULT."""

LARGEST_CONTROLS = 1024
"""Control points under a footprint, and under a point."""

# places behind the list of the contacts that take part: how many they are, first block of the contacts, contacts that
# there are at present, those of contours, whether all of them are between rigid bodies; then 1 for each that joins
# those that are closed
PRESENT_COUNT, FIRST_BLOCK, COUNT, OF_CONTOURS, ALL_RIGID, PLACES_BEHIND = range(6)

CONTROL_COUNT = LARGEST_CONTROLS - 1
"""Place of their number in `places`, which begins with their numbers."""

WEIGHTS_AT = 1024
"""Weights of control points in the touched point, then in its tangent."""

SHAPES = WEIGHTS_AT + 3 * LARGEST_CONTROLS
"""Mode shapes at the touched point, and their derivatives; from here on as long as the scene needs."""

# columns of `grids` of the samples
U_AT, U_COUNT, V_AT, V_COUNT, POINTS_AT, GRID_COLUMNS = range(6)
"""First sample in u and in v, and how many; first row of the positions of the samples."""

# columns of `control`
LOW, LOW_GAP, HIGH, HIGH_GAP, HIGH_RATE, WATCHED, JOINS = range(7)
IMPACT, RESIDUAL, ROUNDS, NOMINAL, LONGEST, SPLITS, KNOWN, STOPPING, CONTROL_WIDTH = range(7, 16)
"""Bracket of the time of an impact with gaps, and the rate at its end; contact
it is for, -1 without; contact that joins the closed ones when the step is repeated, -1 without; 1 after an impact;
largest residual and number of iterations of the solver in the last step; length of whole steps [s]; length of the
step that an impact was first seen in [s]; trials since the last whole step; contacts before its search;
work of rows that look ahead in the middle of the step [J]."""


DENSE = 4
"""Contacts up to which their own matrix is formed where all bodies are rigid."""


class Features(Table):
    """What kinds of contact a scene has."""


class Colliding(Table):
    """Pairs of surfaces of triangles, a kind or none."""


class Samples(Arrays):
    """A grid of points on every contour, from which a search begins when nothing is known.

    Attributes
    ----------
    grids
        Of each contour, shape (n, 5).
    parameters, first, basis
        Of all grids one after another, u before v: parameter, first function that is not zero, values of the functions,
        shapes (a,), (a,) and (a, LARGEST_DEGREE + 1).
    reach
        Of a sample of each contour [m], shape (n,).
    points
        Positions [m], three rows a contour as wide as the largest grid. Contours that deform share the first three.
    across, distances, angles
        Scratch of the searches.
    """

    grids: Ints2
    parameters: Floats1
    first: Ints1
    basis: Floats2
    reach: Floats1
    points: Floats2
    across: Floats2
    distances: Floats1
    angles: Floats1


class Reduced(Arrays):
    """What the solver is told of contacts between rigid bodies; columns are velocities of touched bodies.

    Attributes
    ----------
    ends, blocks
        Of each contact that takes part, shapes (nc, 4) and (nc, 36), see `solve_contacts_reduced`.
    matrix
        B, shape (n, n).
    start, found
        Velocities without and with impulses, shape (n,).
    columns, velocities
        Column of each velocity of the scene, -1 if it is not touched; velocity of each column.
    numbers
        How many columns there are.
    """

    ends: Ints2
    blocks: Floats2
    matrix: Floats2
    start: Floats1
    found: Floats1
    columns: Ints1
    velocities: Ints1
    numbers: Ints1


class ContactRows(RowArrays):
    """All contacts of a scene; columns are named at the top of this file.

    Attributes
    ----------
    features
        What kinds of contact there are.
    lanes, attachments, panels, rows, inverse_mass
        As in the system of joints; block c and its attachments 2 c (contour) and 2 c + 1 (what touches) belong to
        contact c. Impulses push what touches along the normal.
    table, values, state
        Of each contact, shapes (nc, 10), (nc, 32), (nc, 59).
    contours
        All contours, shape (n,).
    poses
        Shape (n, 20).
    constants
        Knots, rational weights, and what control points are made of: of a flexible body position [m] and mode shapes,
        3 + 3 nf numbers a point, component by component; flat.
    net
        Control points of the stage in the axes of their contours [m], shape (all points, 3).
    samples
        Where searches begin.
    delassus
        Rates by impulses of the contacts that are present, shape (3 nc, 3 nc).
    laws, kinds
        What the solver is told of each of them, shapes (nc, 16) and (nc, 2).
    rates
        Rates without contact, impulses and rates for the solver, shape (3, 3 nc).
    column
        Scratch, as long as the velocities of the scene.
    scratch, places, workspace
        Numbers and places that live within one call.
    control
        Of events, shape (16,).
    solvers, solution
        What solves them, and how that ended: status, iterations, residual, shape (3,).
    reduced
        What the solver needs on the velocities of the touched bodies, if all of them are rigid.
    meshes
        Pairs of surfaces of triangles: one kind or none; their contacts come behind those of contours.
    placed
        Of those pairs, carried: poses of the surfaces at the end of the last step; sums over contacts that are gone;
        number of contacts. Shape (n, 12).
    carried, saved
        All that a step changes in the scene, as one array, and its copy.
    """

    shape: ClassVar[Any] = block_shape(3)
    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.contact.ends",
        "heavylift.solver.contact.events",
        "heavylift.solver.contact.locate",
        "heavylift.solver.contact.record",
        "heavylift.solver.contact.stage",
        "heavylift.solver.contact.start",
    )

    features: Features
    table: Ints2
    values: Floats2
    state: Floats2
    contours: Records[ContactContour]
    poses: Floats2
    constants: Floats1
    net: Floats2
    samples: Samples
    delassus: Floats2
    laws: Floats2
    kinds: Ints2
    rates: Floats2
    column: Floats1
    scratch: Floats1
    places: Ints1
    workspace: Floats1
    control: Floats1
    solvers: ContactSolvers
    solution: Floats1
    reduced: Reduced
    meshes: Colliding
    placed: Floats2
    carried: Floats1
    saved: Floats1
