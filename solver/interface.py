"""What every kind offers to the step: tables of kinds, the operations they know, and the shared workspace.

Coordinates of a body are its velocities ``U``: of a rigid frame the world velocity of the frame
origin and the body-axis angular velocity, then the flexible coordinates. A *marker* is a vector
attached to a body, a material point or a direction; forces act on markers and never see what
kind of body is behind them.
"""

from __future__ import annotations

from abc import ABCMeta, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats3
from heavylift.numerics.records import Record, Records, Vector, records
from heavylift.solver.kinds import Members, Table, generic, optional
from heavylift.solver.rows.structure import RowArrays, RowSystem

__all__ = [
    "ACCELERATIONS",
    "FORCES",
    "RECORD",
    "ROWS",
    "STIFFENED",
    "Bodies",
    "BodyKind",
    "Control",
    "Coordinates",
    "Forces",
    "Joints",
    "Marker",
    "Status",
    "Sums",
    "Systems",
    "Workspace",
    "add_forces",
    "add_row_work",
    "add_totals",
    "advance",
    "apply_inverse",
    "begin_record",
    "begin_stage",
    "check",
    "close_step",
    "complete",
    "complete_accelerations",
    "correct",
    "end_rows",
    "end_velocity",
    "estimate_error",
    "factor",
    "fill_bias",
    "fill_markers",
    "fill_rows",
    "finish",
    "forget_accelerations",
    "free_acceleration",
    "hold_turns",
    "iterate",
    "joint_rows",
    "predict",
    "record",
    "record_forces",
    "record_joints",
    "record_rows",
    "refactor_rows",
    "relinearise",
    "row_arrays",
    "set_targets",
    "set_velocity",
    "solve_again",
    "solve_end",
    "solve_midpoint",
    "start",
    "store_state",
    "thesis_advance",
    "thesis_velocity",
    "update_rows",
    "watch_forces",
    "watch_joints",
    "watch_motions",
    "write_velocity",
]

STIFFENED = -(2**40)
"""Block of a step that is too long for what loads do to the stiffness of a body with modes."""

ROWS, FORCES, RECORD, ACCELERATIONS = range(4)
"""What markers are filled for: rows only; forces too; records too; all of it, with rates and second rates."""

NO_CORNERS = np.zeros(0)


class BodyKind(Arrays, metaclass=ABCMeta):
    """Base of all kinds of bodies: what Python asks of them before time starts.

    Vectors are those of the whole scene, of which a kind reads and writes the places of its bodies. After a change of
    poses or velocities `start` completes the state.

    Attributes
    ----------
    FRAMES
        Whether each body has a frame with a spin, whose six velocities come first.
    NODAL
        Whether rows see its bodies through bases, and statics by all coordinates of their nodes.
    FLOATS
        Whether its bodies are hulls.
    """

    FRAMES: ClassVar[bool] = False
    NODAL: ClassVar[bool] = False
    FLOATS: ClassVar[bool] = False

    @abstractmethod
    def lengths(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Masses of the bodies [kg], and how far they reach, or extend [m]."""

    def straighten(self) -> None:
        """Take midpoints along straight lines, if they lie on arcs otherwise."""

    @property
    def hidden_coordinates(self) -> int:
        """How many coordinates can move without being seen by a velocity in the workspace."""
        return 0

    @abstractmethod
    def survey(
        self, places: NDArray[np.float64], inertia: NDArray[np.float64], velocity: NDArray[np.float64]
    ) -> None:
        """Write where the bodies are, how heavy and how fast.

        Parameters
        ----------
        places
            By number of the body, shape (bodies, 8): its first velocity, the point [m] whose velocity that is, and the
            quaternion of the axes of its spin.
        inertia
            By velocity, shape (dof_count,): a characteristic mass [kg, kg m2, 1], 0 if it is prescribed.
        velocity
            Carried velocities [m/s, rad/s, modal], shape (dof_count,).
        """

    @abstractmethod
    def move(self, increment: NDArray[np.float64]) -> None:
        """Displace along the exponential map by velocity coordinates [m, rad, modal], shape (dof_count,)."""

    @abstractmethod
    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """Take velocities [m/s, rad/s, modal], shape (dof_count,), and forget accelerations."""

    @abstractmethod
    def collect_load(self, work: Workspace, load: NDArray[np.float64]) -> None:
        """Add gravity, forces of the markers and own elasticity at rest [N, N m, modal], shape (dof_count,)."""


class Bodies(Table):
    """Kinds of bodies of a scene."""

    members: ClassVar[type] = BodyKind


class Forces(Table):
    """Kinds of forces of a scene."""


class Joints(Table):
    """Kinds of joints and laws of a scene: what writes rows."""


class Systems(Table):
    """Systems of rows of a scene: that of the joints, that of the contacts, what an integrator carries."""


row_arrays, joint_rows = Members(Systems, RowArrays), Members(Systems, RowSystem)
"""All systems with rows in a table, and those of joints."""


class Status(Record):
    """How a step ended: an `Outcome`, and the number of the body or block of rows that it concerns."""

    outcome: int
    body: int
    block: int


class Control(Record):
    """Step control; carried.

    Attributes
    ----------
    next_step, last_step
        Step that is tried next, and the last one [s].
    error, pose_error
        Estimated errors of points [m], and of orientations as a speed [m/s].
    step_count
        Steps done.
    changed
        Laws that moved in the last round of an iteration, and bodies that corrected their velocities or iterate.
    corner
        Number of the next corner.
    split
        Shorter step [s] that an impact asks for, or 0.
    interval
        Number of the interval between two records that the step belongs to, from 1 on.
    """

    next_step: float
    last_step: float
    error: float
    step_count: int
    changed: int
    corner: int
    pose_error: float
    split: float
    interval: int


class Marker(Record):
    """A vector attached to a body, in world axes.

    Attributes
    ----------
    point
        Position [m] or unit direction.
    velocity
        Its rate at the predicted midpoint velocity.
    force
        Force on it [N].
    bias
        Its second rate without accelerations of the body.
    """

    point: Vector
    velocity: Vector
    force: Vector
    bias: Vector


class Coordinates(Record):
    """Coordinates of a body in a state vector of the accurate integrator, which follow its velocities.

    They are a pose, or nodal vectors. A pose has seven numbers, position and quaternion, and six velocities, those of
    the position and the spin in the axes of the quaternion. Nodal vectors have as many velocities as numbers. Kinds
    that the integrator serves say them by `place_coordinates`, and their values at the start by `write_state`.

    Attributes
    ----------
    number, motion
        Of the body; and whether it is `FREE`, `FIXED` or `DRIVEN`.
    place, velocity
        In a state vector, of the coordinates and of their velocities.
    count, stride
        Numbers of nodal vectors, 0 of a pose; from one node to the next. A node begins with its position.
    reach
        Of a pose: distance of what is attached [m]; else extension of the body.
    """

    number: int
    motion: int
    place: int
    velocity: int
    count: int
    stride: int
    reach: float


class Sums(Record):
    """What concerns all bodies: acceleration of gravity [m/s2], energies [J], momenta about the world origin.

    The energies and momenta of a record stand in this order. At the end the largest distance of a carried elongation
    from the geometry [m, rad], of a record too.
    """

    gravity: Vector
    kinetic: float
    elastic: float
    potential: float
    external_work: float
    drive_work: float
    dissipated: float
    linear_momentum: Vector
    angular_momentum: Vector
    drift: float


class Workspace(Arrays):
    """Arrays shared by all kinds during a step, made once a scene.

    Attributes
    ----------
    velocity
        Generalised velocities of the stage, of all bodies [m/s, rad/s, modal], shape (dof_count,).
    markers
        All markers. Rates and forces of those that serve joints only are not kept.
    jacobian
        Derivatives of the vectors by the velocities of their own body, shape (marker_count, 3, widest
        window).
    sums, control, status
        See there.
    corners
        Times at which an adaptive step must end [s].
    row_force
        Forces ``G^T reaction`` of the rows on all bodies but free rigid ones, by velocity [N, N m, modal], shape
        (dof_count,); set while a record is written, for reactions of held bodies.
    """

    velocity: Floats1
    markers: Records[Marker]
    jacobian: Floats3
    sums: Sums
    control: Control
    corners: Floats1
    status: Status
    row_force: Floats1

    @classmethod
    def empty(
        cls, velocities: int, markers: int, window: int = 6, corners: Floats1 = NO_CORNERS
    ) -> Workspace:
        """All zeros, for some velocities and markers, with the widest window of velocities of a body."""
        return cls(
            velocity=np.zeros(velocities),
            markers=records(Marker, markers),
            jacobian=np.zeros((markers, 3, window)),
            sums=Sums.one(),
            control=Control.one(),
            corners=corners,
            status=Status.one(),
            row_force=np.zeros(velocities),
        )


@generic("record")
def start(kinds: Bodies, time: float, work: Workspace) -> None:
    """Bodies: complete the start state: driven frames, products, momenta."""


@generic()
def predict(kinds: Bodies, time: float, step: float) -> None:
    """Bodies: midpoint configuration and predicted midpoint velocity from the carried state."""


@generic()
def fill_markers(kinds: Bodies, at_midpoint: bool, level: int, work: Workspace) -> None:
    """Bodies: vectors, rates and Jacobian windows of the markers that a level needs, at midpoint or carried state."""


@generic()
def add_forces(kinds: Forces, time: float, work: Workspace) -> None:
    """Forces: add marker forces and gravity at a time [s] to the workspace."""


@generic()
def factor(kinds: Bodies, step: float, work: Workspace) -> None:
    """Bodies: gather forces, factor the own step matrix, write the velocity of the stage."""


@optional()
def correct(kinds: Bodies, step: float, work: Workspace) -> None:
    """Bodies with quadratic velocity forces: re-evaluate these at the velocity found, solve with the same factor.

    Counted in `control.changed` if velocities have changed: then rows are solved again.
    """


@optional()
def solve_again(
    kinds: Systems, all_systems: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Rows: once more with the factors of the midpoint, after free velocities have changed."""


@optional()
def complete(kinds: Bodies, systems: Systems, at_midpoint: bool, step: float, work: Workspace) -> None:
    """Bodies that rows see through bases: all their velocities, once the impulses of the rows are known.

    Those of the midpoint, or in the first-order scheme what stands for them; or the change by a projection at the end.
    """


@optional()
def iterate(
    kinds: Bodies, bodies: Bodies, systems: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Bodies with nonlinear stress: a round of an iteration of the midpoint, counted in `control.changed`."""


@optional()
def refactor_rows(kinds: Systems, bodies: Bodies, joints: Joints, work: Workspace) -> None:
    """Rows: markers, rows and factor of the midpoint again, after the midpoint or a matrix of a body has changed."""


@generic()
def check(kinds: Bodies, step: float, work: Workspace) -> None:
    """Bodies: refuse a velocity that is not finite or turns too far in a step, before any state is changed."""


@generic()
def advance(kinds: Bodies, time: float, step: float, work: Workspace) -> None:
    """Bodies: configuration and momenta to the end of the step, work of the forces."""


@generic("thesis")
def write_velocity(kinds: Bodies, work: Workspace) -> None:
    """Bodies: velocities of the carried state into the workspace."""


@optional()
def estimate_error(kinds: Bodies, step: float, work: Workspace) -> None:
    """Bodies: raise `work.control.error` to how far [m] the midpoint velocity leads from its prediction."""


@generic()
def end_velocity(kinds: Bodies, step: float, work: Workspace) -> None:
    """Bodies: write the velocities at the end of the step, before the projection, into the workspace."""


@generic()
def set_velocity(kinds: Bodies, step: float, work: Workspace) -> None:
    """Bodies: take the projected velocities; momenta follow them."""


@optional()
def apply_inverse(kinds: Bodies, at_midpoint: bool, system: RowArrays) -> None:
    """Bodies with a factor of their own: ``X = A^-1 G^T`` of their attachments, A of the stage or M at the end."""


@optional()
def add_row_work(kinds: Bodies, weight: float, work: Workspace, system: RowArrays) -> None:
    """Bodies with drives: work of the impulses of the rows, times a weight, on the prescribed velocities."""


@generic()
def fill_rows(kinds: Joints, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Joints: rows from the markers; residuals of the position if asked for."""


@optional()
def set_targets(
    kinds: Joints, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Joints that are driven or compliant in their own way: targets and softness of their rows."""


@optional()
def relinearise(kinds: Joints, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Laws (ropes, stops, friction): fit rows to the velocity found; count in `control.changed` if they move."""


@optional("accurate")
def fill_bias(kinds: Joints, time: float, work: Workspace, system: RowArrays) -> None:
    """Joints: targets of their rows as accelerations: ``G a = -gamma``, from rates and second rates of the markers."""


@optional()
def update_rows(kinds: Joints, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Joints with a memory: what they carry over the step, from the midpoint velocity."""


@optional()
def watch_joints(kinds: Joints, work: Workspace, system: RowArrays) -> None:
    """Joints: forces at the end of a step that stands, by the rows and velocities there; their extremes."""


@generic("record")
def record_joints(kinds: Joints, time: float, work: Workspace, system: RowArrays, row: Floats1) -> None:
    """Joints: reactions, angles, travels into their columns of a record; energies into the totals."""


@generic()
def finish(kinds: Bodies, step: float, work: Workspace) -> None:
    """Bodies: end velocities and accelerations from the momenta."""


@optional("thesis")
def thesis_velocity(kinds: Bodies, time: float, step: float, work: Workspace) -> None:
    """Bodies: end velocity of the first-order scheme from forces at the start of the step."""


@optional("thesis")
def thesis_advance(kinds: Bodies, time: float, step: float, work: Workspace) -> None:
    """Bodies: configuration by the end velocity."""


@generic("record")
def record(kinds: Bodies, time: float, work: Workspace, row: Floats1) -> None:
    """Bodies: write the carried state, reactions and sensors into their columns of a record."""


@optional()
def watch_forces(kinds: Forces, work: Workspace) -> None:
    """Forces: when a step stands, extremes since the last record of what they were in its middle."""


@optional()
def watch_motions(kinds: Forces, bodies: Bodies, work: Workspace) -> None:
    """What only watches: extremes since the last record of what is seen at the end of a step that stands."""


@optional("record")
def begin_record(kinds: Forces) -> None:
    """Forces that begin an iteration with its last result: keep that, for `record_forces` to put back."""


@optional("record")
def record_forces(kinds: Forces, time: float, work: Workspace, row: Floats1) -> None:
    """Forces with channels: write what they are at the carried state into their columns of a record; energies too."""


@generic("record")
def add_totals(kinds: Bodies, work: Workspace) -> None:
    """Bodies: add energies, works and momenta of the carried state to the totals."""


@optional("contact")
def forget_accelerations(kinds: Bodies) -> None:
    """Bodies: after an impact the differences of the last step give no information on the next."""


# ---- of systems of rows, in the order of a step: joints are served first, contacts ask them to respond ----


@optional()
def solve_midpoint(
    kinds: Systems,
    all_systems: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
    nominal: float,
) -> None:
    """Rows: velocities of the midpoint from free ones; the factor stays for `solve_again`.

    Positions are corrected over the nominal step, of which the step may be a part.
    """


@optional()
def end_rows(
    kinds: Systems, bodies: Bodies, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Rows: what they carry over the step; end velocities, markers there, gaps there.

    `work.control.split` is set where contacts find an impact within the step: then all of it has to be taken back.
    """


@optional()
def solve_end(
    kinds: Systems,
    all_systems: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """Rows: project the velocities at the end of the step onto the rigid rows there, and onto what is closed; impacts.

    `work.control.split` is set where impulses are not found: then all of the step has to be taken back.
    """


@optional()
def close_step(
    kinds: Systems, all_systems: Systems, bodies: Bodies, joints: Joints, work: Workspace, step: float
) -> None:
    """Rows: the projected velocities to the bodies; reactions; extremes since the last record. The step stands."""


@optional("record")
def record_rows(
    kinds: Systems, bodies: Bodies, joints: Joints, work: Workspace, time: float, row: Floats1
) -> None:
    """Rows: find them at the carried state, where an integrator need not have left them, and record them.

    Joints go into their columns, monitors into the last of them, energies into the totals, and forces to the bodies
    that are held.
    """


# ---- of the accurate integrator, whose state is a vector: velocities, then configurations, then works ----


@optional("accurate")
def begin_stage(kinds: Bodies, time: float, values: Floats1, at: int, work: Workspace) -> None:
    """Bodies: take the state vector at `at`, and fill the markers with rates and second rates.

    Prescribed motion is written into the state vector.
    """


@optional("accurate")
def hold_turns(kinds: Forces, back: bool) -> None:
    """Forces that count turns by what they were evaluated at last: keep them for a state that stands, or go back to it.

    The stages of a step that is rejected may be anywhere.
    """


@optional("accurate")
def free_acceleration(kinds: Bodies, values: Floats1, at: int, work: Workspace) -> None:
    """Bodies: accelerations without joints into `work.velocity`, powers [W] of loads and drives into `work.sums`."""


@optional("accurate")
def complete_accelerations(
    kinds: Bodies, systems: Systems, with_forces: bool, values: Floats1, rate: int
) -> None:
    """Bodies that rows see through bases: changes of all velocities by impulses, and by forces, into a state vector."""


@optional("accurate")
def store_state(kinds: Bodies, time: float, values: Floats1, at: int, work: Workspace) -> None:
    """Bodies: carried state from the state vector at `at`, prescribed motion as it is at a time."""
