"""Descriptions of bodies: how a frame moves, rigid bodies and flexible ones with modes; SI units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import (
    BodyPoint,
    ByCoordinate,
    Positive,
    Quantity,
    Shape,
    Square,
    WorldDirection,
)
from heavylift.solver.scene.descriptions import XYZ, ChannelKind, Family, check_table, no_rows
from heavylift.solver.scene.outputs import Components, Outputs, Part, Parts, channel, outputs
from heavylift.solver.scene.speed_profiles import check_speeds

if TYPE_CHECKING:
    from heavylift.modal.reduced import ReducedBody

__all__ = [
    "BODIES",
    "GROUND",
    "MOTIONS",
    "Driven",
    "Fixed",
    "FlexibleBody",
    "FrameOutputs",
    "Free",
    "Harmonic",
    "HeldOutputs",
    "ModalOutputs",
    "Motion",
    "PointOutputs",
    "Profile",
    "RigidBody",
]

GROUND = "ground"
"""Name of the world as a side of a joint, rope or spring; no body may take it."""

POSITION = channel("length", "position in the world", XYZ)
VELOCITY = channel("velocity", "velocity in world axes", XYZ)


@outputs
class PointOutputs(Outputs):
    """Of a material point."""

    position: Components = POSITION
    velocity: Components = VELOCITY


@outputs
class FrameOutputs(Outputs):
    """Of the frame of a body."""

    position: Components = POSITION
    orientation: Components = channel(
        "number", "unit quaternion from body to world axes, scalar first", ("q0", "q1", "q2", "q3")
    )
    velocity: Components = VELOCITY
    angular_velocity: Components = channel("angular velocity", "angular velocity in body axes", XYZ)


@outputs
class ModalOutputs(Parts):
    """Of the modes of a body, one component each."""

    modal_position: Part = channel("modal coordinate", "coordinates of the mass-normalised mode shapes", None)
    modal_velocity: Part = channel("modal velocity", "speeds of the mass-normalised mode shapes", None)


@outputs
class HeldOutputs(Outputs):
    """Of a frame that does not move freely, behind what its body records."""

    reaction_force: Components = channel("force", "force that holds or drives the frame, world axes", XYZ)
    reaction_moment: Components = channel(
        "moment or energy", "moment that holds or drives the frame, world axes", XYZ
    )


def _zeros(count: int) -> NDArray[np.float64]:
    return np.zeros(count)


def _upright() -> NDArray[np.float64]:
    return np.array([1.0, 0.0, 0.0, 0.0])


MOTIONS: Family[Any] = Family("frame", "heavylift.solver.scene", key="motion", alphabetical=False)
"""How a frame moves, by the motions of a case file."""
BODIES: Family[Any] = Family("body", "heavylift.solver.scene")
"""Bodies that are said in numbers alone, by their types in a case file."""

ANGLE_OR_LENGTH = ByCoordinate(Quantity("angle"), Quantity("length"))
SPEED = ByCoordinate(Quantity("angular velocity"), Quantity("velocity"))
ACCELERATION = ByCoordinate(
    Quantity("angular acceleration", minimum=0.0), Quantity("acceleration", minimum=0.0)
)
JERK = ByCoordinate(Quantity("angular jerk", minimum=0.0), Quantity("jerk", minimum=0.0))


@MOTIONS.part
@dataclass(frozen=True)
class Harmonic:
    """``amplitude sin(2 pi frequency t + phase)``."""

    amplitude: Annotated[float, ANGLE_OR_LENGTH]
    """Amplitude."""
    frequency: Annotated[float, Quantity("frequency", minimum=0.0, closed=True)]
    """Frequency [Hz]."""
    phase: Annotated[float, Quantity("angle")] = 0.0
    """Phase [rad]."""


@MOTIONS.part
@dataclass(frozen=True, eq=False)
class Profile:
    """A function of time: a smooth curve through a table, or speeds, plus harmonics.

    A table is at rest before and after its times; speeds begin from 0 at the start.
    """

    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """Times of the table [s], increasing."""
    values: Annotated[NDArray[np.float64], ANGLE_OR_LENGTH, Shape((None,))] = field(default_factory=no_rows)
    """Values of the table."""
    harmonics: tuple[Harmonic, ...] = ()
    """Sine functions that are added."""
    interpolation: Literal["smooth", "monotone"] = "smooth"
    """Of the table: `smooth` has no jumps of the acceleration and may leave the values of two neighbours, which the run
    tells; `monotone` never leaves them, and has none of the speed only."""
    speeds: Annotated[NDArray[np.float64], SPEED, Shape((None,))] = field(default_factory=no_rows)
    """In place of `values`: linear between the times, held before the first and after the last; with `acceleration`
    targets, to which a drive that stands at first begins to change at the times."""
    acceleration: Annotated[float | None, ACCELERATION] = None
    """Of all changes of the speed."""
    jerk: Annotated[float | None, JERK] = None
    """Of all changes of the acceleration, which jumps without."""

    @staticmethod
    def check(spec: Any) -> None:
        """Something is a function, by values or by speeds."""
        if len(spec.speeds):
            if len(spec.values):
                raise InputError("both 'values' and 'speeds'", key="speeds", expected="one of them")
            check_table("times", spec.times, "speeds", spec.speeds)
        else:
            check_table("times", spec.times, "values", spec.values, shortest=2)
        if not len(spec.times) and not spec.harmonics:
            raise InputError("an empty profile", expected="'times' and 'values' or 'speeds', or 'harmonics'")
        if spec.interpolation == "monotone" and not len(spec.values):
            raise InputError(
                "'monotone' without 'values'", key="interpolation", expected="'times' and 'values'"
            )
        check_speeds(spec)


@MOTIONS.describe("free")
@dataclass(frozen=True)
class Free:
    """The frame moves by the equations of motion."""

    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = ()
    """What bodies that move so record behind their own channels."""


@MOTIONS.describe("fixed")
@dataclass(frozen=True)
class Fixed:
    """The frame stays where it is; its reaction is recorded."""

    CHANNELS: ClassVar = HeldOutputs.CHANNELS


@MOTIONS.describe("driven")
@dataclass(frozen=True, eq=False, kw_only=True)
class Driven:
    """The frame follows functions of time; its reaction and the work of the drive are recorded."""

    CHANNELS: ClassVar = HeldOutputs.CHANNELS

    x: Annotated[Profile | None, Quantity("length")] = None
    """Displacement along the world's x axis [m]."""
    y: Annotated[Profile | None, Quantity("length")] = None
    """Displacement along the world's y axis [m]."""
    z: Annotated[Profile | None, Quantity("length")] = None
    """Displacement along the world's z axis [m]."""
    angle: Annotated[Profile | None, Quantity("angle")] = None
    """Rotation [rad] about `axis` through `pivot`."""
    axis: Annotated[tuple[float, float, float], WorldDirection()] = (0.0, 0.0, 1.0)
    """World direction of the axis of rotation, any length."""
    pivot: Annotated[tuple[float, float, float], Quantity("length")] = (0.0, 0.0, 0.0)
    """World point on the axis of rotation [m]."""

    @property
    def profiles(self) -> tuple[Profile | None, Profile | None, Profile | None, Profile | None]:
        """Displacements along the world axes [m], and the angle [rad]."""
        return self.x, self.y, self.z, self.angle


Motion = Free | Fixed | Driven


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """What bodies with a frame have: how it moves, and where it starts.

    Attributes
    ----------
    motion
        How the frame moves.
    position, orientation
        Frame origin [m], world; unit quaternion (scalar first).
    velocity, angular_velocity
        Of the frame: world axes [m/s]; **body** axes [rad/s]. For free frames only: others move as their
        motion says.
    """

    motion: Motion = field(default_factory=Free)
    position: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    orientation: NDArray[np.float64] = field(default_factory=_upright)
    velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    angular_velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))


@dataclass(frozen=True, eq=False)
class FlexibleBody(Placed):
    """A floating-frame body: reference frame plus mass-normalised modal coordinates.

    Attributes
    ----------
    name
        Prefix of its channels.
    reduced
        Mode shapes, stiffness and inertia integrals in the body frame.
    modal_position, modal_velocity
        Shape (nf,) [m kg^0.5], [m kg^0.5/s]; zero if empty.
    damping_ratio
        Of critical, per mode, shape (nf,); zero if empty.
    """

    CHANNELS: ClassVar = (*FrameOutputs.CHANNELS, *ModalOutputs.CHANNELS)
    """What it records, in the order of its columns."""

    name: str
    reduced: ReducedBody
    modal_position: NDArray[np.float64] = field(default_factory=no_rows, kw_only=True)
    modal_velocity: NDArray[np.float64] = field(default_factory=no_rows, kw_only=True)
    damping_ratio: NDArray[np.float64] = field(default_factory=no_rows, kw_only=True)


@BODIES.describe("rigid")
@dataclass(frozen=True, eq=False)
class RigidBody(Placed):
    """A body that does not deform."""

    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = FrameOutputs.CHANNELS
    """What it records, in the order of its columns."""

    name: str
    mass: Annotated[float, Positive("mass")]
    """Mass [kg]."""
    inertia: Annotated[NDArray[np.float64], Quantity("moment of inertia"), Square(3)]
    """About the centre of mass, body axes [kg m^2]: three principal values or a symmetric 3 x 3 matrix."""
    centre_of_mass: Annotated[NDArray[np.float64], BodyPoint()] = field(default_factory=lambda: _zeros(3))
    """In the coordinates of the geometry [m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """A mass distribution has this inertia: no principal value exceeds the sum of the other two.

        Then ``1/2 tr(J) I - J``, the second moments of the mass, is positive semi-definite.
        """
        J = np.array(spec.inertia, dtype=np.float64)
        expected = "three principal values, or a symmetric 3 x 3 matrix, of a body that can exist"
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if abs(J[i, j] - J[j, i]) > 1e-9 * np.abs(J).max():
                problem = f"entries {i}{j} and {j}{i} differ: {J[i, j]:g} and {J[j, i]:g} kg m^2"
                raise InputError(problem, key="inertia", expected=expected)
        principal = np.linalg.eigvalsh(J)
        if not principal[0] > 0.0:
            raise InputError(
                f"inertia {J.tolist()} is not positive definite", key="inertia", expected=expected
            )
        if principal[2] - principal[1] - principal[0] > 2e-9 * principal.sum():
            problem = f"in inertia {J.tolist()} one principal value exceeds the sum of the others"
            raise InputError(problem, key="inertia", expected=expected)
