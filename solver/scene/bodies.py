"""What a user says of bodies: how a frame moves, rigid bodies and flexible ones with modes; SI units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.descriptions import XYZ, ChannelKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.modal.reduced import ReducedBody

__all__ = [
    "FRAME_CHANNELS",
    "GROUND",
    "POINT_CHANNELS",
    "Driven",
    "Fixed",
    "FlexibleBody",
    "Free",
    "Harmonic",
    "Motion",
    "Profile",
    "RigidBody",
]

GROUND = "ground"
"""Name of the world as a side of a joint, rope or spring; no body may take it."""

POSITION = ChannelKind("position", "length", "position in the world", XYZ)
VELOCITY = ChannelKind("velocity", "velocity", "velocity in world axes", XYZ)
POINT_CHANNELS = (POSITION, VELOCITY)
"""What is recorded of a material point."""
FRAME_CHANNELS = (
    POSITION,
    ChannelKind(
        "orientation",
        "number",
        "unit quaternion from body to world axes, scalar first",
        ("q0", "q1", "q2", "q3"),
    ),
    VELOCITY,
    ChannelKind("angular_velocity", "angular velocity", "angular velocity in body axes", XYZ),
)
"""What is recorded of the frame of a body."""
HELD_CHANNELS = (
    ChannelKind("reaction_force", "force", "force that holds or drives the frame, world axes", XYZ),
    ChannelKind(
        "reaction_moment", "moment or energy", "moment that holds or drives the frame, world axes", XYZ
    ),
)
"""What is recorded of a frame that does not move freely, behind what its body records."""


def _zeros(count: int) -> NDArray[np.float64]:
    return np.zeros(count)


def _upright() -> NDArray[np.float64]:
    return np.array([1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class Harmonic:
    """``amplitude sin(2 pi frequency t + phase)``: amplitude [m] or [rad], frequency [Hz], phase [rad]."""

    amplitude: float
    frequency: float
    phase: float = 0.0


@dataclass(frozen=True, eq=False)
class Profile:
    """A function of time: a C2 spline through a table, held at its ends, plus harmonics.

    Attributes
    ----------
    times, values
        Table [s], [m] or [rad], equal lengths, 0 or at least 2; the spline starts and ends at rest.
    harmonics
        Added to the table.

    Raises
    ------
    InputError
        If the table has one row, unequal lengths, or times that do not increase.
    """

    times: NDArray[np.float64] = field(default_factory=lambda: _zeros(0))
    values: NDArray[np.float64] = field(default_factory=lambda: _zeros(0))
    harmonics: tuple[Harmonic, ...] = ()

    def __post_init__(self) -> None:
        times, values = np.asarray(self.times, dtype=np.float64), np.asarray(self.values, dtype=np.float64)
        good = times.ndim == 1 and times.shape == values.shape and len(times) != 1
        if not (good and np.all(np.diff(times) > 0.0) and np.all(np.isfinite(values))):
            raise InputError(
                f"table of {times.shape} times and {values.shape} values",
                source="profile",
                expected="no row, or two and more rows with increasing times",
            )


@dataclass(frozen=True)
class Free:
    """The frame moves by the equations of motion."""

    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = ()
    """What bodies that move so record behind their own channels."""


@dataclass(frozen=True)
class Fixed:
    """The frame stays where it starts; its reaction is recorded."""

    CHANNELS: ClassVar = HELD_CHANNELS


@dataclass(frozen=True, eq=False)
class Driven:
    """The frame follows functions of time; its reaction and the work of the drive are recorded.

    Attributes
    ----------
    translation
        Displacements along the world axes [m].
    angle
        Rotation [rad] about `axis` through `pivot`.
    axis, pivot
        World direction (any length) and world point [m].
    """

    CHANNELS: ClassVar = HELD_CHANNELS

    translation: tuple[Profile | None, Profile | None, Profile | None] = (None, None, None)
    angle: Profile | None = None
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    pivot: tuple[float, float, float] = (0.0, 0.0, 0.0)


Motion = Free | Fixed | Driven


@dataclass(frozen=True, eq=False)
class FlexibleBody:
    """A floating-frame body: reference frame plus mass-normalised modal coordinates.

    Attributes
    ----------
    name
        Prefix of its channels.
    reduced
        Mode shapes, stiffness and inertia integrals in the body frame.
    motion
        How the frame moves.
    position, orientation
        Frame origin [m], world; unit quaternion (scalar first).
    velocity, angular_velocity
        Of the frame: world axes [m/s]; **body** axes [rad/s]. For free frames only: others move as their
        motion says.
    modal_position, modal_velocity
        Shape (nf,) [m kg^0.5], [m kg^0.5/s]; zero if empty.
    damping_ratio
        Of critical, per mode, shape (nf,); zero if empty.
    """

    CHANNELS: ClassVar = (
        *FRAME_CHANNELS,
        ChannelKind(
            "modal_position", "modal coordinate", "coordinates of the mass-normalised mode shapes", None
        ),
        ChannelKind("modal_velocity", "modal velocity", "speeds of the mass-normalised mode shapes", None),
    )
    """What it records, in the order of its columns; one a mode."""

    name: str
    reduced: ReducedBody
    motion: Motion = field(default_factory=Free)
    position: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    orientation: NDArray[np.float64] = field(default_factory=_upright)
    velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    angular_velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    modal_position: NDArray[np.float64] = field(default_factory=lambda: _zeros(0))
    modal_velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(0))
    damping_ratio: NDArray[np.float64] = field(default_factory=lambda: _zeros(0))


@dataclass(frozen=True, eq=False)
class RigidBody:
    """A rigid body.

    Attributes
    ----------
    name
        Prefix of its channels.
    mass
        [kg].
    inertia
        About the centre of mass, body axes [kg m2], shape (3, 3).
    centre_of_mass
        In the body frame [m], shape (3,).
    motion, position, orientation, velocity, angular_velocity
        As in `FlexibleBody`, of the body frame.
    """

    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = FRAME_CHANNELS
    """What it records, in the order of its columns."""

    name: str
    mass: float
    inertia: NDArray[np.float64]
    centre_of_mass: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    motion: Motion = field(default_factory=Free)
    position: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    orientation: NDArray[np.float64] = field(default_factory=_upright)
    velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    angular_velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
