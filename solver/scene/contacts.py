"""What a user says of contact: contours of bodies, what touches them, and by what law; SI units.

A *contour* is a spline surface or curve that moves with its body: a fit through nodes of a flexible body, the shape of
a frame or shell itself, or given points of a rigid body or the ground. A *contact* lets one point, ball, ring or convex
primitive of another body touch it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from heavylift.solver.scene.descriptions import XYZ, ChannelKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.neutral import NeutralContour

__all__ = [
    "BilateralLaw",
    "BoxShape",
    "CapsuleShape",
    "CircleShape",
    "Contact",
    "ContactLaw",
    "ContactShape",
    "Contour",
    "CylinderShape",
    "EllipsoidShape",
    "HertzLaw",
    "HuntCrossleyLaw",
    "LinearLaw",
    "PointShape",
    "RigidLaw",
    "SphereShape",
]


@dataclass(frozen=True, eq=False, kw_only=True)
class Contour:
    """A contour of a body.

    Attributes
    ----------
    name, body
        Its own name and that of its body, `GROUND` for one that stands still in the world.
    neutral
        The spline, its control points linear in the coordinates of the body; None for the shape of a frame or shell
        itself.
    flip
        Turn the normal round: it is ``S_u x S_v`` of a surface, and must point out of the material.
    radius
        Of a cylinder about a curve [m]; 0 for the curve itself.
    width
        Of a band along a curve [m], across its normal; 0 for none.
    director
        Direction in the body frame, shape (3,): along the width of a band, whose normal is ``director x tangent``; of a
        curve that something slides along, where the first of its two normals begins.
    """

    name: str
    body: str
    neutral: NeutralContour | None = None
    flip: bool = False
    radius: float = 0.0
    width: float = 0.0
    director: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class PointShape:
    """A material point."""


@dataclass(frozen=True)
class SphereShape:
    """A ball about the point: radius [m]."""

    radius: float


@dataclass(frozen=True, eq=False)
class CircleShape:
    """A thin ring about the point: radius [m] and axis in the body frame, shape (3,)."""

    radius: float
    axis: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class EllipsoidShape:
    """An ellipsoid about the point: half axes [m], shape (3,), along columns of `axes` in the body frame."""

    half_axes: NDArray[np.float64]
    axes: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True, eq=False)
class BoxShape:
    """A box about the point with rounded edges: half lengths of its core [m], radius of the rounding [m], axes."""

    half_lengths: NDArray[np.float64]
    radius: float
    axes: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True, eq=False)
class CapsuleShape:
    """A segment about the point with a radius [m]: half length [m] and direction in the body frame, shape (3,)."""

    radius: float
    half_length: float
    axis: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CylinderShape:
    """A cylinder about the point with rounded rims: radius and half length of its core, rounding [m], axis."""

    radius: float
    half_length: float
    rounding: float
    axis: NDArray[np.float64]


ContactShape = (
    PointShape | SphereShape | CircleShape | EllipsoidShape | BoxShape | CapsuleShape | CylinderShape
)


@dataclass(frozen=True)
class RigidLaw:
    """Unilateral and without compliance.

    Attributes
    ----------
    restitution
        Newton's: velocity after an impact over that before it, 0 to 1.
    rest_speed
        Approach [m/s] below which an impact has no restitution.
    """

    restitution: float = 0.0
    rest_speed: float = 0.0


@dataclass(frozen=True)
class LinearLaw:
    """``F = k d + c d'``, never pulling: stiffness [N/m], damping [N s/m]."""

    stiffness: float
    damping: float = 0.0


@dataclass(frozen=True)
class HertzLaw:
    """``F = k d^(3/2)``: stiffness [N/m^(3/2)], of a ball ``4/3 E* sqrt(R)``."""

    stiffness: float


@dataclass(frozen=True)
class HuntCrossleyLaw:
    """``F = k d^n (1 + a d')`` with the damping a [s/m] that gives a restitution at the speed of first touch.

    Attributes
    ----------
    stiffness
        [N/m^exponent].
    exponent
        1.5 of Hertz, 1 linear.
    restitution
        Above 0, up to 1.
    """

    stiffness: float
    exponent: float = 1.5
    restitution: float = 1.0


@dataclass(frozen=True)
class BilateralLaw:
    """Never leaves the contour: a bead on a curve, a slider in a surface."""


ContactLaw = RigidLaw | LinearLaw | HertzLaw | HuntCrossleyLaw | BilateralLaw


@dataclass(frozen=True, eq=False, kw_only=True)
class Contact:
    """Something of a body that touches a contour of another.

    Attributes
    ----------
    name
        Prefix of its channels.
    contour
        Name of the contour.
    body, point
        Whose point [m], in the frame of that body, shape (3,), carries the shape.
    shape
        What touches.
    law
        Force or impulse across the contact.
    friction
        Coulomb's coefficient; 0 without.
    footprint
        Radius [m] of a disc over which gap and force are averaged with the weight ``(1 - r^2/R^2)^2``; 0 for a point.
    events
        Split the step at impacts of a rigid law; else impacts happen at ends of steps.
    """

    CHANNELS: ClassVar = (
        ChannelKind("gap", "length", "distance of what touches from the contour; negative inside"),
        ChannelKind("normal_force", "force", "force on what touches along the normal of the contour"),
        ChannelKind("friction_force", "force", "force across the normal of the contour, its amount"),
        ChannelKind("force", "force", "force on what touches, world axes", XYZ),
        ChannelKind(
            "impulse",
            "momentum",
            "sum of the impulses along the normal since the start, impacts included",
            unit="N s",
        ),
        ChannelKind("slip", "velocity", "speed at which what touches slides"),
        ChannelKind("slip_path", "length", "length of the path that it has slid"),
        ChannelKind(
            "coordinate",
            "number",
            "parameters u and v of the touched point on the contour, 0 to 1",
            ("u", "v"),
        ),
        ChannelKind("point", "length", "touched point of the contour, in the world", XYZ),
        ChannelKind(
            "dissipated",
            "moment or energy",
            "energy lost to impacts, damping and friction since the start, part of energy.dissipated",
            unit="J",
        ),
        ChannelKind("impacts", "number", "number of impacts since the start"),
    )
    """What it records, in the order of its columns."""

    name: str
    contour: str
    body: str
    point: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    shape: ContactShape = field(default_factory=PointShape)
    law: ContactLaw = field(default_factory=RigidLaw)
    friction: float = 0.0
    footprint: float = 0.0
    events: bool = True
