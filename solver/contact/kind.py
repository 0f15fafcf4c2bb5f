"""The kind of contacts between contours and what touches them: a system of rows of its own beside that of the joints.

Each contact has three rows on two sides, the contour and the body that touches it: the rate of the gap along the normal
of the contour, and the two rates across it. Of a bead on a curve the first two rows are along normals of the curve, and
the third is along it. What bodies need for rows (attachments, panels, row data) has the names and the layout of the
system of the joints, so they serve both with the same functions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.splines.convex import Primitive
from heavylift.contours.splines.packed_contour import PackedContour
from heavylift.contours.splines.samples import Samples
from heavylift.contours.splines.search_step import ContourSearch
from heavylift.contours.triangles.surface_layout import RelativePose
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1, Ints2
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.records import Matrix3, Quaternion, Record, Records, Vector, Vector6
from heavylift.solver.contact.layout import Problem, RowKind, RowParameters, Solution
from heavylift.solver.contact.triangles.facet_kind import FacetSurfaces
from heavylift.solver.contact.triangles.modal_kind import ModalSurfaces
from heavylift.solver.extremes import Extremes, Store
from heavylift.solver.kinds import Table
from heavylift.solver.rows.structure import RowArrays

if TYPE_CHECKING:
    from heavylift.solver.contact.solve.newton import ContactSolvers

__all__ = [
    "Colliding",
    "ContactContour",
    "ContactEntry",
    "ContactRows",
    "ContactState",
    "ContactValues",
    "ContourPose",
    "Counts",
    "Events",
    "Features",
    "HeldContact",
    "Reduced",
    "Scratch",
    "Sleeper",
    "Slept",
    "StoodPair",
    "Tally",
]

POINT, CIRCLE, CONVEX, TRIANGLES = range(4)
"""What touches: a point or ball, a ring, another convex primitive, another surface of triangles."""

RIGID, BILATERAL, CURVE, COMPLIANT = range(4)
"""Laws: unilateral, a slider in a surface, a bead on a curve, a force law."""

FOUND, LOST, NOT_A_NUMBER, TOO_DEEP = 0, 2, 3, 4
"""How a search ended: well; without converging or at something that is not finite, which are statuses of the
searches; the contour has reached the core of a primitive."""


NO_PLACE, PRESSED_IN, NO_IMPULSES, NO_END = range(4)
"""Why contacts end a run: a closed one was not found on its contour; it is deeper inside than its rounding; impulses
that obey all laws were not found; contacts and laws of ropes and stops moved each other without end."""


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


OF_GROUND, OF_RIGID, OF_MODES, OF_MESH, OF_FACETS, OF_MODAL_FACETS = range(6)

LARGEST_CONTROLS = 1024
"""Control points under a footprint, and under a point."""

EVALUATION_ROOM = 904
"""Numbers of the scratch of evaluation and search."""

NEVER_MOVES = -1
"""In place of a body that may sleep: the ground, or a fixed one."""

DENSE = 4
"""Contacts up to which their own matrix is formed where all bodies are rigid."""


class ContactEntry(Record):
    """What a contact is made of.

    Attributes
    ----------
    contour
        Row of the contour.
    shape_kind
        What touches: `POINT`, `CIRCLE`, `CONVEX` or `TRIANGLES`.
    law, force_law
        `RIGID`, `BILATERAL`, `CURVE` or `COMPLIANT`; force law of a compliant contact.
    centre, axes
        Markers of its point and of three directions, -1 without. Of triangles `axes` is the row of the pose of the
        second surface.
    column
        First record column.
    events
        Whether steps are split at impacts.
    slot
        Number of its moving point on a mesh.
    primitive_kind
        Kind of a convex primitive.
    sleepers
        Of both sides: 1 + its row in `ContactRows.sleepers`, `NEVER_MOVES`, or 0 of what neither sleeps nor stands.
    """

    contour: int
    shape_kind: int
    law: int
    centre: int
    axes: int
    column: int
    force_law: int
    events: bool
    slot: int
    primitive_kind: int
    sleepers: Annotated[NDArray[np.int64], (2,)]


class ContactValues(Record):
    """Constants of a contact.

    Attributes
    ----------
    friction, restitution, rest_speed
        Coulomb's coefficient; coefficient of restitution, and speed below which there is none [m/s].
    stiffness, exponent, damping
        Of the force law.
    radius, footprint
        Of a ball [m]; of the disc over which gap and force are means [m].
    extent
        Largest distance of the shape from its point [m].
    length_scale
        Length that makes gaps small or large [m].
    inverse_mass
        Characteristic inverse mass [1/kg].
    primitive
        A convex primitive in the frame of its body.
    """

    friction: float
    restitution: float
    rest_speed: float
    stiffness: float
    exponent: float
    damping: float
    radius: float
    footprint: float
    extent: float
    length_scale: float
    inverse_mass: float
    primitive: Primitive


class ContactState(Record):
    """What a contact carries.

    Attributes
    ----------
    u, v
        Coordinates of the touched point.
    gap, second_gap, rate
        Gap at the end of the last step [m], along both normals of a curve, and its rate [m/s].
    closed
        Whether it is closed.
    sleep, shift
        Distance that the gap can close before a search is due, negative before the first one; that by which it can have
        closed in the last step [m].
    slip
        Elastic slip along both tangents [m].
    normal, tangent
        Normal and first tangent in the world.
    force, touched
        Force on what touches [N]; touched point [m].
    impulse, impact_impulse, loss, impacts
        Sum of normal impulses [N s], and of those of impacts alone; energy lost [J]; number of impacts.
    step_loss, jump
        Energy lost in the step, as long as it can be taken back [J]; what compliant contacts between triangles have
        stored less because of other features or shares than those of the step before.
    kept
        Stored in the elastic slip [J].
    slip_path, slip_speed
        Of the slip [m], [m/s].
    normal_force, friction_force
        At the end of the last step [N].
    touch_damping
        Damping of Hunt and Crossley that belongs to the present touch, negative before it is known.
    changed
        Whether it has borne in this step and not in the one before, or the other way round.
    warm_start
        Impulses of the last step, which start the next iteration [N s].
    middle_force, window
        Forces of the three rows in the middle of the last step [N], without those of blows; and the time over which
        they are a mean [s]: of a step that was cut about that of a whole one, but since the last blow.
    new, near, present
        Whether it closes at the end of this step; whether it was near at its beginning; whether it takes part in the
        present stage.
    end_gap, second_end_gap
        Gaps at the end of this step [m]; the second one of a ring is an angle [rad].
    search, failures
        How the last search ended: `FOUND`, `TOO_DEEP` or a status of the searches; searches so far that found nothing.
    recent_impacts
        Impacts since the last whole step.
    pair, patch, share
        Of contacts between triangles: pair of surfaces, patch or -1, and part of the stiffness of the patch.
    feature_kind, feature, other_feature
        Kind of the two features and their numbers.
    side, hit
        Side that they were on when they were last apart, 1 or -1; 1 if their paths meet in this step, else 0
        or, where nobody knows from which side it came, -1.
    beside, start_beside
        Distance beside them [m], now and when this step began.
    start_gap, start_rate
        Gap at the start of the step they were found in [m]; rate of the gap when this step began [m/s].
    step_impulse
        Normal impulse of the last step [N s].
    joined
        Whether it has begun to rest in this step because one beside it has gone.
    has_left
        Whether it had slid off its features at the end of the last step.
    slots
        Numbers of its moving points on both bodies, if they deform; the first one -1 where there was none left.
    timed, paced, mean_rate, growth
        Of a compliant contact: whether it took part in the last step, and in the one before; mean rate of its gap in
        the last step [m/s], and what it grows by in half a step.
    located
        Of contours: whether the gap at the end of the last step was searched for; else it is larger than the recorded
        value.
    passed
        Part of this step after which a gap that is open at both of its ends has been smallest, if it may have closed in
        between; else 0.
    forces, gaps
        Extremes of the normal force and of the gap.
    store
        Of a compliant contact on a contour: its energy from step to step.
    """

    u: float
    v: float
    gap: float
    second_gap: float
    closed: bool
    rate: float
    sleep: float
    shift: float
    slip: Annotated[NDArray[np.float64], (2,)]
    normal: Vector
    tangent: Vector
    force: Vector
    touched: Vector
    impulse: float
    impact_impulse: float
    loss: float
    step_loss: float
    jump: float
    kept: float
    impacts: int
    slip_path: float
    slip_speed: float
    normal_force: float
    friction_force: float
    touch_damping: float
    warm_start: Vector
    middle_force: Vector
    window: float
    changed: bool
    new: bool
    near: bool
    present: bool
    end_gap: float
    second_end_gap: float
    search: int
    failures: int
    recent_impacts: int
    pair: int
    feature_kind: int
    feature: int
    other_feature: int
    side: float
    hit: int
    beside: float
    start_gap: float
    patch: int
    share: float
    step_impulse: float
    has_left: bool
    joined: bool
    start_beside: float
    start_rate: float
    slots: Annotated[NDArray[np.int64], (2,)]
    timed: bool
    paced: bool
    mean_rate: float
    growth: float
    located: bool
    passed: float
    forces: Extremes
    gaps: Extremes
    store: Store


class ContourPose(RelativePose):
    """Axes of a contour at the stage, and what is constant in them.

    Attributes
    ----------
    reach, step_shift
        Largest distance of a control point from the origin, and how far one moves in the step at most [m].
    director, radius, width
        Of derived contours: direction across a band, radius and width [m].
    """

    reach: float
    step_shift: float
    director: Vector
    radius: float
    width: float


class Scratch(Record):
    """What is known of the one contact that is being located.

    Attributes
    ----------
    result, evaluation
        The search; scratch of evaluation and search.
    directions
        Of the three rows, in the world.
    lever
        Touched point in the axes of the contour [m].
    slopes, has_slopes
        Factors of the rates of its tangent in the three rows, and whether there are any.
    arm
        From the point of the shape to where it touches, in the world [m].
    primitive
        A convex primitive in the axes of the contour.
    weights, slope_weights
        Weights of control points in the touched point, and in its tangent.
    dense, single
        Of a footprint: weights of all control points, and those of one of its points.
    """

    result: ContourSearch
    directions: Matrix3
    lever: Vector
    slopes: Matrix3
    has_slopes: bool
    arm: Vector
    primitive: Primitive
    evaluation: Annotated[NDArray[np.float64], (EVALUATION_ROOM,)]
    weights: Annotated[NDArray[np.float64], (LARGEST_CONTROLS,)]
    slope_weights: Annotated[NDArray[np.float64], (LARGEST_CONTROLS,)]
    dense: Annotated[NDArray[np.float64], (LARGEST_CONTROLS,)]
    single: Annotated[NDArray[np.float64], (LARGEST_CONTROLS,)]


class Counts(Record):
    """How many there are, and where.

    Attributes
    ----------
    present
        Contacts that take part.
    first_block
        First block of the contacts.
    total, of_contours
        Contacts that there are at present, and those of contours.
    controls
        Control points under the contact that is being located, whose numbers stand in `places`.
    all_rigid
        Whether nothing that is touched has more than six velocities, see `moves_rigidly`.
    """

    present: int
    first_block: int
    total: int
    of_contours: int
    controls: int
    all_rigid: bool


class Events(Record):
    """Impacts within a step.

    Attributes
    ----------
    low, low_gap, high, high_gap, high_rate
        Bracket of the time of an impact [s] with gaps [m], and the rate at its end [m/s].
    watched
        Contact that it is for, -1 without.
    joins
        Contact that joins the closed ones when the step is repeated, -1 without.
    impact
        Whether there was an impact in the step.
    residual, rounds
        Largest residual and number of iterations of the solver in the last step.
    nominal_step, longest_step, part
        Length of whole steps, and of the step that an impact was first seen in [s]; length of this step over that of a
        whole one.
    free_rate
        Largest rate of a contact without impulses in this step, as it would be after a whole one [m/s].
    splits
        Trials since the last whole step.
    effort
        Of the solver since the last whole step, in iterations of a single contact.
    exhausted
        Whether the rest of the whole step continues without impacts of its own.
    rough, roughest
        Solutions of this step that were accepted although the solver found none of its accuracy, and their largest
        residual: counted when the step stands.
    known
        Contacts before the search of the step.
    uncut
        Whether the step is a whole one, without an impact within.
    stopping_work
        Work of rows that look ahead in the middle of the step [J].
    struck
        Whether something hits at the end of the step: what its impulse does to others is no force.
    time
        End of the step [s].
    failure
        Why the last step that failed did: `NO_PLACE`, `PRESSED_IN`, `NO_IMPULSES` or `NO_END`.
    """

    low: float
    low_gap: float
    high: float
    high_gap: float
    high_rate: float
    watched: int
    joins: int
    impact: bool
    residual: float
    rounds: int
    nominal_step: float
    longest_step: float
    part: float
    free_rate: float
    splits: int
    effort: float
    exhausted: bool
    rough: int
    roughest: float
    known: int
    uncut: bool
    stopping_work: float
    struck: bool
    time: float
    failure: int


class Tally(Record):
    """Counts of accepted steps since the start; carried, so that a continued run reports those of all of it.

    Attributes
    ----------
    exhausted_steps
        Whole steps whose rest was taken without impacts of its own.
    rough, roughest, roughest_time
        Solutions that were accepted although the solver found none of its accuracy, their largest residual, and the end
        of its step [s].
    deepest
        Largest depth of a closed contact without compliance at the end of a step, over its size.
    """

    exhausted_steps: int
    rough: int
    roughest: float
    roughest_time: float
    deepest: float


class StoodPair(Record):
    """Where a pair of surfaces has stood when it was searched as a whole, see `triangles.standing`; carried.

    Attributes
    ----------
    pose, far
        Its pose, and how far that search reached [m].
    mark
        Tells the contacts that it had; 0 if it did not stand, or the search has changed them.
    still
        Steps since then, in a row, in which it has moved by no more than `STILL` and kept its contacts: 0 while it
        moves. This says that a pair has not moved; its bodies may move together.
    """

    pose: RelativePose
    far: float
    mark: int
    still: int


class Sleeper(Record):
    """A free rigid body in contacts between surfaces, which may sleep, see `solve.asleep`.

    Attributes
    ----------
    dof, pose, size
        Its first velocity, row of the pose of a surface of it, and largest distance on that from its origin [m].
    allowed
        Whether it may: no joint, rope or other kind of contact has it.
    load
        Its accelerations in this step without contacts [m/s2, rad/s2].
    balanced
        Whether contacts bear that.
    group, blocked
        A body of those that touch each other, and whether that group cannot sleep, while islands are found.
    """

    dof: int
    pose: int
    size: float
    allowed: bool
    load: Vector6
    balanced: bool
    group: int
    blocked: bool


class Slept(Record):
    """What is carried of a body that may sleep.

    Attributes
    ----------
    pose, load, still
        Pose and load that it has had for so many whole steps in a row.
    island
        0 while it is awake, else the number of its island, from 1 on.
    position, orientation
        Of its frame while it sleeps.
    """

    pose: RelativePose
    load: Vector6
    still: int
    island: int
    position: Vector
    orientation: Quaternion


class HeldContact(Record):
    """Of a contact when a step began: whether it was at rest, and the sum of its impulses [N s]."""

    rests: bool
    impulse: float


class Features(Table):
    """What kinds of contact a scene has."""


class Colliding(Table):
    """Pairs of surfaces of triangles, a kind or none."""


class Reduced(Arrays):
    """Problem of contacts between rigid bodies, for the solver; columns are velocities of touched bodies.

    Attributes
    ----------
    problem
        What the solver gets, of the arrays that follow.
    ends, blocks
        Of each contact that takes part, shapes (nc, 4) and (nc, 36).
    matrix
        B, shape (n, n).
    start, found
        Velocities without and with impulses, shape (n,).
    columns, velocities
        Column of each velocity of the scene, -1 if it is not touched; velocity of each column.
    units
        Of each velocity that a body begins with whose mass is no diagonal: its first attachment to unit rows, whose
        panels through the inverse mass are the columns of that, three each; else -1.
    joined
        Of each velocity that a body begins with: 1 if rows of joints or ropes reach it, so that it feels others.
    of_bodies, of_contacts
        Scratch of islands, two rows each: by velocity and by contact.
    """

    problem: Problem
    ends: Ints2
    blocks: Floats2
    matrix: Floats2
    start: Floats1
    found: Floats1
    columns: Ints1
    velocities: Ints1
    units: Ints1
    joined: Ints1
    of_bodies: Ints2
    of_contacts: Ints2


class ContactRows(RowArrays):
    """All contacts of a scene.

    Attributes
    ----------
    features
        What kinds of contact there are.
    lanes, attachments, panels, rows, inverse_mass
        As in the system of joints; block c and its attachments 2 c (contour) and 2 c + 1 (what touches) belong to
        contact c. Impulses push what touches along the normal. Behind them is a block without impulses, whose
        attachments have unit rows, see `Reduced.units`.
    table, values, state
        Of each contact.
    contours
        All contours.
    poses
        Of the contours.
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
        Its part for each of them.
    rates
        Rates without contact, impulses and rates for the solver, shape (3, 3 nc).
    column
        Scratch, as long as the velocities of the scene.
    scratch, shapes, places
        Numbers and places that live within one call: of the contact that is being located, its mode shapes and their
        derivatives, and the numbers of control points.
    counts, present, joining
        How many there are; numbers of those that take part; 1 for each that joins those that are closed.
    control
        Of events.
    tally
        What is reported at the end of a run, one row.
    islands, island_loss
        Number of the island of each contact with a contour, then of each pair of surfaces: bodies that contacts, joints
        and ropes of the scene can connect; of each island the energy that its contacts without compliance have lost in
        the step [J].
    solvers, dense, solution
        What solves them, the problem on the matrix of the rows, and how that ended.
    reduced
        What the solver needs on the velocities of the touched bodies, if all of them are rigid.
    meshes
        Pairs of surfaces of triangles: one kind or none; their contacts come behind those of contours.
    facets, modal
        Of those surfaces the ones that deform: with the nodes of a frame or shell, and with the modes of a body.
    placed
        Of those pairs, carried: poses of the surfaces at the end of the last step; sums over contacts that are gone;
        number of contacts. Shape (n, 12).
    stood
        Where those pairs have stood still.
    sleepers, slept
        Bodies that may sleep, and what is carried of each.
    held, carried, saved
        What is kept of contacts apart; all that a step changes in the scene, as one array, and its copy.
    """

    shape: ClassVar[Any] = block_shape(3)
    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.contact.solve.impacts",
        "heavylift.solver.contact.solve.events",
        "heavylift.solver.contact.search.contact_kinematics",
        "heavylift.solver.contact.record",
        "heavylift.solver.contact.solve.stage",
    )

    carried_fields: ClassVar[tuple[str, ...]] = (
        "tally",
        "rows",
        "state",
        "placed",
        "stood",
        "slept",
    )

    features: Features
    table: Records[ContactEntry]
    values: Records[ContactValues]
    state: Records[ContactState]
    contours: Records[ContactContour]
    poses: Records[ContourPose]
    constants: Floats1
    net: Floats2
    samples: Samples
    delassus: Floats2
    laws: Records[RowParameters]
    kinds: Records[RowKind]
    rates: Floats2
    column: Floats1
    scratch: Scratch
    shapes: Floats1
    places: Ints1
    counts: Counts
    present: Ints1
    joining: Ints1
    control: Events
    tally: Records[Tally]
    islands: Ints1
    island_loss: Floats1
    solvers: ContactSolvers
    dense: Problem
    solution: Solution
    reduced: Reduced
    meshes: Colliding
    facets: FacetSurfaces
    modal: ModalSurfaces
    placed: Floats2
    stood: Records[StoodPair]
    sleepers: Records[Sleeper]
    slept: Records[Slept]
    held: Records[HeldContact]
    carried: Floats1
    saved: Floats1
