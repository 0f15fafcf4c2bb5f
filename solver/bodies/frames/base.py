"""What rigid bodies, hulls and flexible bodies with modes have in common: a frame that moves, or is held.

The six velocities of a frame are the world velocity of its origin and the spin in its own axes. In the joints, in the
contacts and before time starts such a body is its frame; what bends, floats or has another origin for the user is
added by the kinds.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import in_python
from heavylift.numerics.records import Quaternion, Record, Records, Vector, Vector6
from heavylift.numerics.rotation import exponential_quaternion, quaternion_product
from heavylift.solver.drive import FREE
from heavylift.solver.interface import FORCES, BodyKind, Workspace
from heavylift.solver.markers import PackedMarker

__all__ = ["SLENDER", "Frame", "FrameBodies", "FrameIndex", "FrameMotion"]


SLENDER = 0.05
"""Smallest moment of inertia over the next one, below which a body is slender: where the coupler of a spatial four-bar
has this ratio, errors are 1 to 3 % larger without an axial momentum of its own, and grow with the inverse of it."""


class FrameIndex(Record):
    """Where a body is among the others.

    Attributes
    ----------
    dof
        First velocity; they grow with the rows.
    motion
        How the frame moves: `FREE`, `FIXED` or `DRIVEN`.
    drive
        Start of its drive in the constants.
    column, held
        First record column, and that of the reaction; -1 of a frame that moves freely.
    number
        Of the body in the scene.
    """

    dof: int
    motion: int
    drive: int
    column: int
    held: int
    number: int


class FrameMotion(Record):
    """Motion of a frame.

    Attributes
    ----------
    position, velocity, acceleration
        Of its origin, world axes [m, m/s, m/s2].
    orientation
        Unit quaternion.
    spin, spin_rate
        Angular velocity and acceleration in its own axes [rad/s, rad/s2].
    pose, twist
        Position and orientation; velocity and spin.
    """

    position: Vector
    orientation: Quaternion
    velocity: Vector
    spin: Vector
    acceleration: Vector
    spin_rate: Vector
    pose: Annotated[NDArray[np.float64], (7,), "position"]
    twist: Annotated[NDArray[np.float64], (6,), "velocity"]


class Frame(FrameMotion):
    """What is known of a body with a frame: its carried state and the scratch of a step.

    Attributes
    ----------
    angular_momentum
        About the origin of the frame, world axes [kg m2/s].
    external_work, drive_work
        Of forces and of the drive [J].
    mass
        [kg].
    reach
        A length [m] at which a spin counts as a velocity: what is attached, or the body, is not farther away.
    mid_position, mid_velocity, mid_spin, mid_rotation
        The stage in the middle of a step, or at the carried state; its velocity in world axes for rigid bodies, in body
        axes for flexible ones; rotation matrix, row by row.
    force, moment
        Resultant (world axes) and moment about the origin of the frame (its own axes) of all marker forces.
    wrench
        Force and moment.
    drive_pose, drive_rates
        Pose that a drive prescribes to the frame of the user; velocity, spin, acceleration and spin rate.
    mean_twist
        Mean velocity and spin of a driven frame over a step.
    """

    angular_momentum: Vector
    external_work: float
    drive_work: float
    mass: float
    reach: float
    mid_position: Vector
    mid_velocity: Vector
    mid_spin: Vector
    force: Vector
    moment: Vector
    wrench: Annotated[NDArray[np.float64], (6,), "force"]
    mid_rotation: Annotated[NDArray[np.float64], (9,)]
    drive_pose: Annotated[NDArray[np.float64], (7,)]
    drive_rates: Annotated[NDArray[np.float64], (12,)]
    mean_twist: Vector6


class FrameBodies(BodyKind):
    """Base of the kinds of bodies that have a frame.

    Attributes
    ----------
    largest_turn
        Of a body in one step [rad], above which a run stops.
    table, frame
        What is known of each.
    constants
        Drives, marker data and whatever else is of changing length.
    markers
        Points and directions that forces and joints act on.
    sensors
        Points that are recorded.
    driven
        Whether the frame of any is driven.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.bodies.frames.contours",
        "heavylift.solver.bodies.frames.motion",
    )

    FRAMES: ClassVar[bool] = True
    largest_turn: ClassVar[float]

    table: Records[FrameIndex]
    constants: Floats1
    frame: Records[Frame]
    markers: Records[PackedMarker]
    sensors: Records[PackedMarker]
    driven: bool

    def lengths(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Masses, and how far what is attached reaches."""
        return self.frame["mass"], self.frame["reach"]

    def _dofs(self) -> NDArray[np.int64]:
        """Places of the velocities of the frames, shape (bodies, 6)."""
        return self.table["dof"][:, None] + np.arange(6)

    def _free(self) -> NDArray[np.int64]:
        """Rows of the bodies whose frame is free."""
        return np.flatnonzero(self.table["motion"] == FREE)

    @abstractmethod
    def _inertia(self) -> NDArray[np.float64]:
        """Masses [kg] for the velocities of the frames, and inertias [kg m2] about their axes, shape (bodies, 6)."""

    def _windows(self) -> NDArray[np.int64]:
        """First velocity of the window that the markers of each body see, shape (bodies,)."""
        return self.table["dof"]

    def survey(
        self, places: NDArray[np.float64], inertia: NDArray[np.float64], velocity: NDArray[np.float64]
    ) -> None:
        """Origin and axes of the frames."""
        dofs, number = self._dofs(), self.table["number"]
        free = self.table["motion"][:, None] == FREE
        places[number, 0] = self.table["dof"]
        places[number, 1:] = self.frame["pose"]
        inertia[dofs] = np.where(free, self._inertia(), 0.0)
        velocity[dofs] = self.frame["twist"]

    def move(self, increment: NDArray[np.float64]) -> None:
        """``x += d``, ``R := R exp(t)`` of free frames."""
        free = self._free()
        if not free.size:
            return
        shift = increment[self._dofs()[free]]
        self.frame["position"][free] += shift[:, :3]
        orientation = self.frame["orientation"]
        for i in np.flatnonzero(shift[:, 3:].any(axis=1)):
            before = tuple(orientation[free[i]].tolist())
            after = in_python(quaternion_product)(
                before, in_python(exponential_quaternion)(*shift[i, 3:].tolist())
            )
            orientation[free[i]] = np.array(after) / math.hypot(*after)

    def poses(self) -> tuple[NDArray[np.float64], ...]:
        """Positions [m] and quaternions, copied; and what else `move` changes."""
        return np.array(self.frame["position"]), np.array(self.frame["orientation"])

    def put_increment(
        self,
        start: tuple[NDArray[np.float64], ...],
        end: tuple[NDArray[np.float64], ...],
        increment: NDArray[np.float64],
    ) -> None:
        """Write what `move` takes from some poses to others."""
        from scipy.spatial.transform import Rotation

        free = self._free()
        if free.size:
            before, after = (Rotation.from_quat(q[1][free], scalar_first=True) for q in (start, end))
            shift = np.column_stack([(end[0] - start[0])[free], (before.inv() * after).as_rotvec()])
            increment[self._dofs()[free]] = shift

    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """Of free frames."""
        free = self._free()
        self.frame["twist"][free] = velocity[self._dofs()[free]]
        self.frame["acceleration"][free] = 0.0
        self.frame["spin_rate"][free] = 0.0

    def collect_load(self, work: Workspace, load: NDArray[np.float64]) -> None:
        """``J^T f`` of the markers that forces act on, and ``m g``."""
        loaded = self.markers[self.markers["level"] == FORCES]
        loaded = loaded[work.markers["force"][loaded["number"]].any(axis=1)]
        jacobian, force = work.jacobian[loaded["number"]], work.markers["force"][loaded["number"]]
        width = jacobian.shape[2]
        wide = np.zeros(len(load) + width)  # windows of the last bodies are narrower than the widest
        places = self._windows()[loaded["body"]][:, None] + np.arange(width)
        np.add.at(wide, places, np.einsum("mkj,mk->mj", jacobian, force))
        load += wide[: len(load)]
        load[self._dofs()[:, :3]] += self.frame["mass"][:, None] * work.sums.gravity
