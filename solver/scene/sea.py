"""What a user says of the sea: water, hulls that float, hydrodynamic databases, waves, wind, lines; SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from heavylift.solver.scene.bodies import RigidBody
from heavylift.solver.scene.descriptions import XYZ, ChannelKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.scene.wind_loads import (
        CurrentField,
        FluidLoad,
        WindField,
    )
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = ["FloatingBody", "Hull", "LinearRestoring", "Radiation", "Sea", "Tank", "Water"]


@dataclass(frozen=True)
class Water:
    """Still water.

    Attributes
    ----------
    density, gravity
        [kg/m3], [m/s2].
    level
        Height of the still water plane in the world [m].
    depth
        [m]; infinite for deep water.
    """

    density: float = 1025.0
    gravity: float = 9.80665
    level: float = 0.0
    depth: float = math.inf


@dataclass(frozen=True, eq=False)
class LinearRestoring:
    """Buoyancy for small motions about a float plane: a constant volume, and the moments of the water plane.

    Attributes
    ----------
    volume
        Displaced at rest [m3].
    centre_of_buoyancy
        In the body frame [m], shape (3,): the constant buoyancy acts there.
    reference
        Point of the body frame [m], shape (3,), that lies in the water plane at rest; the moments are about it.
    waterplane
        A, Sx, Sy, Ixx, Iyy, Ixy: area [m2], and integrals of x, y [m3], x^2, y^2, x y [m4] in the axes of the body.

    Notes
    -----
    Weight acts at the centre of mass of the body, so its terms (-m g z_G in roll and pitch) are not part of this.
    Forces derive from the potential ``rho g / 2 int (height of the float plane)^2 dA`` plus that of the volume.
    """

    volume: float
    centre_of_buoyancy: NDArray[np.float64]
    reference: NDArray[np.float64]
    waterplane: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Hull:
    """A rigid body that floats.

    Attributes
    ----------
    body
        Name of a free rigid body. Channels of the hull go under it: ``body.buoyancy`` ...
    restoring
        A closed surface in the frame of the body, clipped at the water level at every instant; or `LinearRestoring`;
        or None for a body under water whose weight is given as it weighs there. Never two of them.
    reference
        Point of the body frame [m], shape (3,), to which `damping` and the database refer.
    damping, quadratic_damping
        Shape (6, 6) and (6,) in surge ... yaw at the reference point, heading axes: ``D u + q |u| u`` of the
        velocity over ground, beside what the database has, for viscous effects [N s/m, N s, N m s]; q the same per
        velocity.
    low_pass
        Cut-off of the filter of position and heading that the waves see [rad/s]; well below the waves.
    open_deck
        Height in the frame of the body [m] from which on the surface may be open; right while all of that is dry.
    """

    CHANNELS: ClassVar = (
        ChannelKind("displaced_volume", "volume", "volume of the water that the hull displaces"),
        ChannelKind("buoyancy_centre", "length", "centre of that volume, in the world", XYZ),
        ChannelKind("ballast", "mass", "mass of the water in the tanks of the hull"),
        ChannelKind(
            "wave_elevation",
            "length",
            "elevation of the undisturbed waves at the low-passed place of the reference point",
        ),
        ChannelKind("wave_force", "force", "force of the waves, heading axes", XYZ),
        ChannelKind(
            "wave_moment",
            "moment or energy",
            "moment of the waves about the reference point, heading axes",
            XYZ,
        ),
        ChannelKind(
            "radiation_force",
            "force",
            "force of memory and damping, without added mass, heading axes",
            XYZ,
        ),
        ChannelKind(
            "radiation_moment",
            "moment or energy",
            "moment of memory and damping about the reference point, heading axes",
            XYZ,
        ),
    )
    """What it records behind the channels of its body, in the order of its columns."""

    body: str
    restoring: TriangleSurface | LinearRestoring | None
    reference: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    damping: NDArray[np.float64] = field(default_factory=lambda: np.zeros((6, 6)))
    quadratic_damping: NDArray[np.float64] = field(default_factory=lambda: np.zeros(6))
    low_pass: float = 0.05
    open_deck: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Radiation:
    """Waves that hulls make and feel, from a database of one hull or of several that interact.

    Attributes
    ----------
    bodies
        Names of hulls in the order of the database, whose reference points are those of the hulls.
    database
        Added mass, damping and excitation.
    memory
        ``"exponentials"``: recursive, fast, passive; ``"direct"``: convolution over past velocities, the reference,
        for fixed steps; ``"none"``: added mass at infinite frequency and excitation only.
    memory_length
        Of the direct convolution [s], and of the samples that exponentials are fitted to, which reach 60 s at least;
        None: until the kernel has decayed to 1 %, 40 to 60 s.
    fit_error
        Of the kernel relative to its largest value, that the exponentials may have.
    drift
        Whether mean drift forces of the database act (slow part by Newman's approximation).
    """

    bodies: tuple[str, ...]
    database: HydrodynamicDatabase
    memory: Literal["exponentials", "direct", "none"] = "exponentials"
    memory_length: float | None = None
    fit_error: float = 1e-3
    drift: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Tank:
    """Ballast water as a point mass that follows a filling schedule.

    Attributes
    ----------
    name, body
        Its own name and that of a hull.
    point
        Centre of the water in the body frame [m], shape (3,).
    times, masses
        Schedule [s], [kg], linear in between and held at the ends. Water comes and goes with the velocity of the hull.
    free_surface
        Second moment of its free surface times the density of its water, about x and about y of the body [kg m2],
        shape (2,): takes from the restoring of roll and pitch for small angles.
    """

    name: str
    body: str
    point: NDArray[np.float64]
    times: NDArray[np.float64]
    masses: NDArray[np.float64]
    free_surface: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Sea:
    """All that water and air do in a scene.

    Attributes
    ----------
    water
        Still water.
    hulls, radiation, tanks
        What floats.
    waves
        Trains of waves, or None.
    ramp
        Time in which waves, wind and current grow from nothing at the start [s].
    at_rest
        Whether wind and current have their full strength from the start, as a start in equilibrium needs them: only
        waves grow then. A simulation that starts at rest sets it.
    excitation
        ``"summed"``: every component at the low-passed place and heading of each hull; ``"series"``: once for the
        place and heading at the start, tabulated over `duration`, which is faster.
    duration
        Length of the tabulated series [s].
    fields, loads
        Wind and current, and the elements on bodies that feel them.
    lines, fenders
        Catenaries and one-sided springs.
    """

    water: Water = field(default_factory=Water)
    hulls: tuple[Hull, ...] = ()
    radiation: tuple[Radiation, ...] = ()
    tanks: tuple[Tank, ...] = ()
    waves: WaveTrains | None = None
    ramp: float = 0.0
    at_rest: bool = False
    excitation: Literal["summed", "series"] = "summed"
    duration: float = 0.0
    fields: tuple[WindField | CurrentField, ...] = ()
    loads: tuple[FluidLoad, ...] = ()
    lines: tuple[Any, ...] = ()
    fenders: tuple[Any, ...] = ()


@dataclass(frozen=True, eq=False)
class FloatingBody(RigidBody):
    """A rigid body of a scene that a hull makes float, with its place among those it interacts with.

    Attributes
    ----------
    hull
        What floats.
    group
        Names of all hulls whose velocities are coupled by water, in order.
    """

    CHANNELS: ClassVar = (*RigidBody.CHANNELS, *Hull.CHANNELS)

    hull: Hull = field(default_factory=lambda: Hull(body="", restoring=None))
    group: tuple[str, ...] = ()
