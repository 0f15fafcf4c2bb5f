"""The kind of hulls: rigid bodies that float, with the mass of the water that they carry along.

Bodies are kept as in `heavylift.solver.bodies.rigid.kind`: centre of mass and principal axes. Added mass, memory and
waves belong to hydrodynamic coordinates, surge to yaw at a reference point in axes that follow the heading. With
their velocities ``u = T(q) U`` the step of "Integrated simulation ... (2018)", eq. 49, in the middle of the step is::

    ( M + T^T (A_inf + h/2 (B + D)) T + h^2/4 K ) Ub = M U + T^T A_inf u + h/2 ( Q + h/2 K U + T^T (F_w - F_m) )

with the memory force ``F_m + B u`` of Cummins' equation and the stiffness K of buoyancy and lines: added mass larger
than the mass, and steps that are long for the hydrostatics, do no harm. Hulls that interact share one matrix, and
joints see them as one body with 6 N velocities.
"""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.records import Matrix6, Record, Records, Vector, Vector6
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.rigid.kind import RigidFrames
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import Table, optional
from heavylift.solver.water.hulls.clipping import Clip

__all__ = [
    "CLIPPED",
    "LINEAR",
    "HullData",
    "HullGroup",
    "HullStage",
    "HullState",
    "HullVectors",
    "Hulls",
    "LineEnd",
    "Parts",
    "PumpData",
    "PumpRow",
    "StillWater",
    "TankData",
    "TankLevel",
    "TankRow",
    "TideRow",
    "WaveComponent",
    "restore_at_rest",
]

UNDER_WATER, CLIPPED, LINEAR = range(3)
"""Values of `HullData.restoring`."""

Flat9 = Annotated[NDArray[np.float64], (9,)]
Pair = Annotated[NDArray[np.float64], (2,)]


class HullData(Record):
    """Constants of a hull; vectors in principal axes.

    Attributes
    ----------
    group, offset
        Of interacting hulls; where its velocities begin among theirs.
    restoring
        How it floats.
    first_point, last_point, first_triangle, last_triangle
        Rows of its surface.
    first_tank, last_tank
        Rows of its tanks.
    reference
        Reference point from the centre of mass [m].
    axis_x, axis_y
        Unit vectors of the axes of the body.
    buoyancy_centre, float_plane, waterplane, displaced_volume
        Of a linear one: centre of buoyancy and reference point of the float plane from the centre of mass [m]; area,
        first moments x, y and second moments xx, yy, xy of the plane [m2, m3, m4]; volume [m3].
    quadratic_damping
        Force over the square of each velocity, in hydrodynamic coordinates.
    cut_off
        Frequency of the filter through which the waves see it [rad/s].
    least_volume
        Displaced volume [m3] below which its database does not hold; 0 if it has none.
    radiates
        Whether it has a database.
    column
        First record column of what it records behind its body.
    """

    group: int
    offset: int
    restoring: int
    first_point: int
    last_point: int
    first_triangle: int
    last_triangle: int
    first_tank: int
    last_tank: int
    reference: Vector
    axis_x: Vector
    axis_y: Vector
    buoyancy_centre: Vector
    float_plane: Vector
    waterplane: Vector6
    displaced_volume: float
    quadratic_damping: Vector6
    cut_off: float
    least_volume: float
    radiates: bool
    column: int


class HullGroup(Record):
    """Interacting hulls: the first of them, how many, their first velocity, first number of their matrices."""

    first: int
    count: int
    dof: int
    matrix: int


class HullStage(Record, whole_lines=True):
    """Scratch of a step of a hull.

    Attributes
    ----------
    transform, end_transform
        T of the middle and of the end of the step.
    heading, place
        That the waves see [rad], [m].
    clip
        What of it is under water.
    predicted
        Displacement to the pose of the stage in coordinates of the body [m, rad].
    lift
        Buoyancy in these coordinates [N, N m].
    stiffness
        Of the buoyancy against height and the world rotations x and y: zz, zx, zy, xx, yy, xy.
    rotation
        Of the principal axes at the start or end, row by row.
    foreseen
        The predicted displacement at which lines were evaluated [m, rad].
    target
        Place [m] and heading [rad] of the middle, which the filter follows.
    turned
        Energy of the water by the turn of its axes before the step [J].
    """

    transform: Matrix6
    end_transform: Matrix6
    heading: float
    place: Pair
    clip: Clip
    predicted: Vector6
    lift: Vector6
    stiffness: Vector6
    rotation: Flat9
    foreseen: Vector6
    target: Vector
    turned: float


class HullState(Record):
    """What a hull carries beside its frame.

    Attributes
    ----------
    low_pass
        Low-passed x, y [m] and heading [rad] of the reference point, each followed by its rate.
    lost, supplied
        Energy dissipated; work of waves and ballast [J].
    lag
        By how much twice the velocities of the middle exceed the sum of those of both ends, over the square of the
        step, in hydrodynamic coordinates.
    yaw
        Heading with all its turns [rad].
    tipped
        1 less the cosine of the largest tilt so far.
    """

    low_pass: Vector6
    lost: float
    supplied: float
    lag: Vector6
    yaw: float
    tipped: float


class TankData(Record):
    """A tank.

    Attributes
    ----------
    hull
        That it is in.
    first, count
        Rows of its schedule.
    point
        Centre of its water, in principal axes [m].
    mass
        In the middle of the step, or at the carried state [kg].
    velocity
        Of the water in it [m/s].
    free_surface
        Density times second moments about x and y of the body, with as much water as there is [kg m].
    start_velocity
        At the start, as its mass needs it; after that the one of the middle [m/s].
    lag
        As that of a hull, of the velocity; carried.
    depth
        Of the water [m].
    first_row, rows
        Of its shape; one if its centre stays.
    capacity
        Mass of the full tank [kg], infinite of a point mass.
    column
        First record column.
    """

    hull: int
    first: int
    count: int
    point: Vector
    mass: float
    velocity: Vector
    free_surface: Pair
    start_velocity: Vector
    lag: Vector
    depth: float
    first_row: int
    rows: int
    capacity: float
    column: int


class TankLevel(Record):
    """Row of a schedule: time [s] and mass [kg]."""

    time: float
    mass: float


class TankRow(Record):
    """Row of the shape of a tank: mass [kg], centre in principal axes [m], surface [kg m], depth [m]."""

    mass: float
    centre: Vector
    surface: Pair
    depth: float


class PumpData(Record):
    """A pump: tanks at its ends, -1 for the sea; rows of its plan; lag [s]; flows at most; column; if it failed."""

    source: int
    target: int
    first: int
    count: int
    lag: float
    most: float
    least: float
    column: int
    failed: bool


class PumpRow(Record):
    """From a time on [s], the command of a pump [kg/s], with its flow [kg/s] and the mass moved [kg] then."""

    time: float
    command: float
    flow: float
    pumped: float


class TideRow(Record):
    """Row of the tide: time [s], level of the still water [m]."""

    time: float
    level: float


class LineEnd(Record):
    """End of a line or fender on a hull: hull, marker, row of the tangents, the other end on a hull or -1."""

    hull: int
    marker: int
    line: int
    other: int


class StillWater(Record):
    """Density times gravity [N/m3], gravity [m/s2], height of the surface [m]."""

    weight: float
    gravity: float
    level: float


class WaveComponent(Record):
    """Of the undisturbed waves: circular frequency [rad/s], wave number along x and y [1/m], phase, amplitude [m]."""

    omega: float
    kx: float
    ky: float
    phase: float
    amplitude: float


class HullVectors(Arrays):
    """Forces and velocities of all hulls in hydrodynamic coordinates, each of shape (6 nb,).

    Attributes
    ----------
    start, middle, finish
        Velocities in the step.
    known
        Memory force without the part of the velocity of the middle.
    wave, radiated
        Force of the waves; of memory and damping.
    load, change, scratch
        Right-hand side of the step in coordinates of the bodies, its change, scratch.
    lead
        Velocities at the start as the mass of the water needs them.
    speed
        What is known of those of the middle.
    """

    start: Floats1
    middle: Floats1
    finish: Floats1
    known: Floats1
    wave: Floats1
    radiated: Floats1
    load: Floats1
    change: Floats1
    scratch: Floats1
    lead: Floats1
    speed: Floats1

    @classmethod
    def empty(cls, size: int) -> HullVectors:
        """All zeros."""
        return cls(*(np.zeros(size) for _ in cls._fields))


class Parts(Table):
    """What a database brings: memories, or excitations, of hulls."""


@optional("rest")
def restore_at_rest(kinds: Bodies) -> None:
    """Buoyancy and ballast at the carried state and at the start of time, for what Python asks before it."""


class Hulls(RigidFrames):
    """All hulls of a scene.

    Attributes
    ----------
    hulls, groups
        Constants of each hull and of each group of interacting hulls.
    water
        Still water.
    stage
        Scratch of each hull.
    points, triangles, placed
        Surfaces in principal axes through the centres of mass, and their vertices in world directions.
    added_mass, damping, implicit
        At infinite frequency; constant; of the memory at the velocity of the middle: shapes (6 nb, 6 nb).
    vectors
        Forces and velocities in hydrodynamic coordinates.
    matrices
        Of each group: inverse of that of the step, of that of its end or the matrix of the corrected middle, matrix of
        the step; flat.
    tanks, tank_levels, tank_rows
        Tanks; rows of their schedules and of their shapes.
    pumps, pump_rows, tide
        Pumps, and their commands, which are carried: the commander of one writes its rows; levels of the still water.
    tangents, rate_tangents, line_ends
        Stiffness and damping matrices of lines and fenders, shared with them, shapes (n, 9); their ends.
    state
        Carried, of each hull.
    memory_state
        Carried, the states of the parts one after another.
    radiation, excitation
        Parts that a database brings; empty without one.
    gauge
        Undisturbed waves, for records.
    """

    FLOATS: ClassVar[bool] = True
    kernel_modules: ClassVar[tuple[str, ...]] = (
        *RigidFrames.kernel_modules,
        "heavylift.solver.water.hulls.record",
        "heavylift.solver.water.hulls.step",
    )

    carried_fields: ClassVar[tuple[str, ...]] = (
        "frame",
        "state",
        "placed",
        "tanks",
        "pump_rows",
        "memory_state",
    )

    hulls: Records[HullData]
    groups: Records[HullGroup]
    water: StillWater
    stage: Records[HullStage]
    points: Floats2
    triangles: Ints2
    placed: Floats2
    added_mass: Floats2
    damping: Floats2
    implicit: Floats2
    vectors: HullVectors
    matrices: Floats1
    tanks: Records[TankData]
    tank_levels: Records[TankLevel]
    tank_rows: Records[TankRow]
    pumps: Records[PumpData]
    pump_rows: Records[PumpRow]
    tide: Records[TideRow]
    tangents: Floats2
    rate_tangents: Floats2
    line_ends: Records[LineEnd]
    state: Records[HullState]
    memory_state: Floats1
    radiation: Parts
    excitation: Parts
    gauge: Records[WaveComponent]

    def sharing_state(self) -> Hulls:
        """The same with the states of its parts as views of its own, which has been replaced."""
        at = 0
        parts = []
        for part in self.radiation:
            old = part.memory.state
            view = self.memory_state[at : at + old.size].reshape(old.shape)
            parts.append(part._replace(memory=part.memory._replace(state=view)))
            at += old.size
        return self._replace(radiation=Parts(parts))

    def start_filters(self) -> None:
        """Position and heading that the waves see start at those of the hulls."""
        for frame, hull, state in zip(self.frame, self.hulls, self.state, strict=True):
            R = rotation_matrix(frame.orientation)
            place = frame.position + R @ hull.reference
            forward = R @ hull.axis_x
            heading = np.arctan2(forward[1], forward[0])
            state.low_pass[:] = place[0], 0.0, place[1], 0.0, heading, 0.0
            state.yaw = heading

    def _windows(self) -> NDArray[np.int64]:
        """Markers see all velocities of a group."""
        return super()._windows() - self.hulls["offset"]

    def move(self, increment: NDArray[np.float64]) -> None:
        """The waves see the hulls where they are."""
        super().move(increment)
        self.start_filters()

    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """The waves see the hulls where they are."""
        super().put_velocity(velocity)
        self.start_filters()

    def collect_load(self, work: Workspace, load: NDArray[np.float64]) -> None:
        """Forces of the markers, weight of bodies and ballast, buoyancy."""
        restore_at_rest(self)
        super().collect_load(work, load)
        dofs = self._dofs()
        load[dofs] += self.stage["lift"]
        for tank in self.tanks:
            body, weight = tank.hull, tank.mass * work.sums.gravity
            R = rotation_matrix(self.frame[body].orientation)
            load[dofs[body, :3]] += weight
            load[dofs[body, 3:]] += np.cross(tank.point, R.T @ weight)
