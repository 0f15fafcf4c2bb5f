"""Descriptions of contact: contours of bodies, what touches them, and by what law; SI units.

A *contour* is a spline surface or curve that moves with its body: a fit through nodes of a flexible body, the shape of
a frame or shell itself, or given points of a rigid body or the ground. A *contact* lets one point, ball, ring or convex
primitive of another body touch it.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyDirection, ByExponent, Positive, Quantity, Shape
from heavylift.solver.scene.descriptions import XYZ, Family
from heavylift.solver.scene.drawn import At, Element, Mark, Segments, Solid, Spline, Text
from heavylift.solver.scene.outlines import Outline, ball, bar, box, capsule, ring
from heavylift.solver.scene.outputs import Components, Outputs, channel, largest, outputs, smallest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from heavylift.contours.splines.neutral import NeutralContour

__all__ = [
    "COLLISION_LAWS",
    "CONTACT_LAWS",
    "CONTACT_SHAPES",
    "BilateralLaw",
    "BoxShape",
    "CapsuleShape",
    "CircleShape",
    "Contact",
    "ContactLaw",
    "ContactOutputs",
    "ContactPlace",
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
    "ThesisLaw",
    "Turn",
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

    def drawn(self) -> Iterable[Element]:
        """Its spline; the shape of a frame or shell is drawn by that."""
        if self.neutral is not None:
            yield Spline(name=self.name, role="contour", contour=self)


CONTACT_SHAPES: Family[Any] = Family("shape", "heavylift.solver.contact.search", alphabetical=False)
"""What touches, about a point of its body."""


@CONTACT_SHAPES.part
@dataclass(frozen=True, eq=False)
class Turn:
    """A rotation from the axes of the body to those of a shape."""

    axis: Annotated[NDArray[np.float64], BodyDirection()]
    """Direction in the coordinates of the body, any length."""
    angle: Annotated[float, Quantity("angle")]
    """Angle of rotation [rad]."""

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Axes of the shape as columns in those of its body, shape (3, 3)."""
        from heavylift.numerics.rotation import quaternion_from_rotation_vector, rotation_matrix

        axis = np.asarray(self.axis, dtype=np.float64)
        return rotation_matrix(quaternion_from_rotation_vector(self.angle * axis / np.linalg.norm(axis)))


def _axes(turned: Turn | None) -> NDArray[np.float64]:
    return np.eye(3) if turned is None else turned.matrix


def _check_rounding(rounding: float, size: float, what: str) -> None:
    """A core is left."""
    if rounding >= 0.5 * size:
        raise InputError(
            f"{rounding:g} m rounds all of the shape off",
            key="rounding",
            expected=f"less than {0.5 * size:g} m, half of its {what}",
        )


@CONTACT_SHAPES.describe("point")
@dataclass(frozen=True)
class PointShape:
    """The point itself."""

    @property
    def outline(self) -> Outline:
        """About its point, in the axes of the body."""
        return Outline(np.zeros((1, 3)))


@CONTACT_SHAPES.describe("sphere")
@dataclass(frozen=True)
class SphereShape:
    """A ball about the point."""

    radius: Annotated[float, Positive("length")]
    """[m]."""

    @property
    def outline(self) -> Outline:
        """About its point, in the axes of the body."""
        return ball(np.full(3, self.radius))


@CONTACT_SHAPES.describe("circle")
@dataclass(frozen=True, eq=False)
class CircleShape:
    """A thin ring, the rim of a disc or wheel, about the point."""

    radius: Annotated[float, Positive("length")]
    """[m]."""
    axis: Annotated[NDArray[np.float64], BodyDirection()]
    """Normal of its plane, in the coordinates of the body."""

    @property
    def outline(self) -> Outline:
        """About its point, in the axes of the body."""
        return ring(self.radius, self.axis)


@CONTACT_SHAPES.describe("ellipsoid")
@dataclass(frozen=True, eq=False)
class EllipsoidShape:
    """An ellipsoid about the point."""

    half_axes: Annotated[NDArray[np.float64], Positive("length"), Shape((3,))]
    """[m]."""
    turned: Turn | None = None
    """How its axes are turned from those of the body; not at all if absent."""

    @property
    def axes(self) -> NDArray[np.float64]:
        """Columns in those of the body, shape (3, 3)."""
        return _axes(self.turned)

    @property
    def outline(self) -> Outline:
        """About its point, in the axes of the body."""
        return ball(self.half_axes, self.axes)


@CONTACT_SHAPES.describe("box")
@dataclass(frozen=True, eq=False)
class BoxShape:
    """A box about the point, with rounded edges: on a sharp one the direction of a contact would jump."""

    size: Annotated[NDArray[np.float64], Positive("length"), Shape((3,))]
    """From face to face [m]."""
    rounding: Annotated[float, Positive("length")]
    """Radius of its edges and corners [m], below half of its smallest size; a contact stays defined until it is pressed
    in so deep."""
    turned: Turn | None = None
    """How its axes are turned from those of the body; not at all if absent."""

    @staticmethod
    def check(spec: Any) -> None:
        """A core is left."""
        _check_rounding(spec.rounding, min(spec.size), "smallest size")

    @property
    def core(self) -> NDArray[np.float64]:
        """Half lengths of what is rounded [m], shape (3,)."""
        half: NDArray[np.float64] = 0.5 * np.asarray(self.size, dtype=np.float64) - self.rounding
        return half

    @property
    def axes(self) -> NDArray[np.float64]:
        """Columns in those of the body, shape (3, 3)."""
        return _axes(self.turned)

    @property
    def outline(self) -> Outline:
        """About its point, in the axes of the body, with sharp edges."""
        return box(self.size, self.axes)


@CONTACT_SHAPES.describe("capsule")
@dataclass(frozen=True, eq=False)
class CapsuleShape:
    """A round bar with half balls as ends, about the point."""

    radius: Annotated[float, Positive("length")]
    """[m]."""
    length: Annotated[float, Positive("length")]
    """Of its straight part: from centre to centre of its ends [m]."""
    axis: Annotated[NDArray[np.float64], BodyDirection()]
    """In the coordinates of the body."""

    @property
    def outline(self) -> Outline:
        """About its point, in the axes of the body."""
        return capsule(self.radius, self.length, self.axis)


@CONTACT_SHAPES.describe("cylinder")
@dataclass(frozen=True, eq=False)
class CylinderShape:
    """A round bar with rounded rims, about the point."""

    radius: Annotated[float, Positive("length")]
    """[m]."""
    length: Annotated[float, Positive("length")]
    """From face to face [m]."""
    rounding: Annotated[float, Positive("length")]
    """Radius of its rims [m], below its radius and half of its length; a contact stays defined until it is pressed in
    so deep."""
    axis: Annotated[NDArray[np.float64], BodyDirection()]
    """In the coordinates of the body."""

    @staticmethod
    def check(spec: Any) -> None:
        """A core is left."""
        _check_rounding(spec.rounding, min(2.0 * spec.radius, spec.length), "diameter or length")

    @property
    def core(self) -> tuple[float, float]:
        """Radius and half length of what is rounded [m]."""
        return self.radius - self.rounding, 0.5 * self.length - self.rounding

    @property
    def outline(self) -> Outline:
        """About its point, in the axes of the body, with sharp rims."""
        return bar(self.radius, self.length, self.axis)


ContactShape = (
    PointShape | SphereShape | CircleShape | EllipsoidShape | BoxShape | CapsuleShape | CylinderShape
)


CONTACT_LAWS: Family[Any] = Family("law", "heavylift.solver.contact.laws", key="law", alphabetical=False)
"""Laws of contacts with contours."""
COLLISION_LAWS: Family[Any] = Family("law", "heavylift.solver.contact.laws", key="law", alphabetical=False)
"""Laws of collisions; a stiffness or damping is that of a patch, which its contacts share."""


@COLLISION_LAWS.describe("rigid")
@CONTACT_LAWS.describe("rigid")
@dataclass(frozen=True)
class RigidLaw:
    """Without compliance: contacts do not penetrate, impacts are instantaneous, and give impulses, not forces."""

    restitution: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 0.0
    """Velocity after an impact over that before it (Newton's), 0 to 1."""
    rest_speed: Annotated[float, Quantity("velocity", minimum=0.0, closed=True)] = 0.0
    """Approach [m/s] below which an impact has no restitution."""
    events: bool = True
    """Split the step where an impact happens; else impacts happen at ends of steps. Contacts of surfaces that could
    close within a step then are rows of that step: nothing passes through. So it is with a frame or shell without
    restitution."""


@CONTACT_LAWS.describe("bilateral")
@dataclass(frozen=True)
class BilateralLaw:
    """Never leaves the contour: a bead on a curve, a slider in a surface."""


@COLLISION_LAWS.describe("linear")
@CONTACT_LAWS.describe("linear")
@dataclass(frozen=True)
class LinearLaw:
    """A spring and a damper that never pull: ``F = k d + c d'``."""

    stiffness: Annotated[float, Positive("stiffness")]
    """[N/m]; of surfaces that of a patch, which its contacts share."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """[N s/m]; of surfaces that of a patch."""


@COLLISION_LAWS.describe("hertz")
@CONTACT_LAWS.describe("hertz")
@dataclass(frozen=True)
class HertzLaw:
    """Elastic and smooth bodies (Hertz): a force that grows with the depth to the power of 3/2."""

    stiffness: Annotated[float, ByExponent(1.5)]
    """[N/m^1.5], of a ball ``4/3 E* sqrt(R)``; of surfaces that of a patch, which its contacts share."""


@COLLISION_LAWS.describe("hunt-crossley")
@CONTACT_LAWS.describe("hunt-crossley")
@dataclass(frozen=True)
class HuntCrossleyLaw:
    """A force that grows with a power of the depth, and damping that gives a restitution (Hunt and Crossley).

    ``F = k d^n (1 + a d')`` with the damping a [s/m] that the speed of first touch needs.
    """

    stiffness: Annotated[float, ByExponent()]
    """[N/m^exponent]; of surfaces that of a patch, which its contacts share."""
    exponent: Annotated[float, Quantity("number", minimum=1.0, maximum=3.0, closed=True)] = 1.5
    """1.5 of Hertz, 1 linear."""
    restitution: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 1.0
    """Velocity after an impact over that before it, above 0 up to 1."""

    @staticmethod
    def check(spec: Any) -> None:
        """The damping is finite."""
        if spec.restitution == 0.0:
            raise InputError(
                "0 needs infinite damping", key="restitution", expected="above 0, or law 'rigid'"
            )


@COLLISION_LAWS.describe("thesis")
@dataclass(frozen=True)
class ThesisLaw:
    """The parameters of "Integrated simulation of ships and offshore structures (2018)": a spring and a damper."""

    epsilon: Annotated[float, Positive("compliance")]
    """Compliance [m/N]: a spring of 1 / epsilon, whatever the step."""
    gamma: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 1.0
    """Above 0 up to 1: damping, with a time constant of h (1 / gamma - 1) / 4 at the step h. No restitution."""

    @staticmethod
    def check(spec: Any) -> None:
        """The damping is finite."""
        if spec.gamma == 0.0:
            raise InputError("0 needs infinite damping", key="gamma", expected="above 0, up to 1")

    def time_constant(self, step: float) -> float:
        """Damping over stiffness [s] at a step [s]."""
        return 0.25 * step * (1.0 / self.gamma - 1.0)

    def at_step(self, step: float) -> LinearLaw:
        """Spring and damper that it means at a step [s].

        Equation (49) of section 2.6 softens a contact row by ``4 Gamma epsilon / h^2``, with
        ``Gamma = 1 / (1 + 4 tau / h)``: a spring of ``1 / epsilon`` and a damper of ``tau / epsilon``, with
        ``tau = h (1 / Gamma - 1) / 4``.
        """
        stiffness = 1.0 / self.epsilon
        return LinearLaw(stiffness, stiffness * self.time_constant(step))


ContactLaw = RigidLaw | LinearLaw | HertzLaw | HuntCrossleyLaw | BilateralLaw


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactPlace:
    """Where a contact is, and by what law.

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
    """

    name: str
    contour: str
    body: str
    point: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    shape: ContactShape = field(default_factory=PointShape)
    law: ContactLaw = field(default_factory=RigidLaw)

    def drawn(self) -> Iterable[Element]:
        """Its shape, a dot if that is a point."""
        at, outline = At(self.body, self.point), self.shape.outline
        if len(outline.triangles):
            yield Solid(
                name=self.name, role="touch", body=self.body, at=self.point, points=outline.points,
                triangles=outline.triangles,
            )  # fmt: skip
        elif len(outline.ends):
            yield Segments(name=self.name, role="touch", at=at, points=outline.points, ends=outline.ends)
        else:
            yield Mark(name=self.name, role="touch", at=at)
        yield Text(name=self.name, role="touch", at=at, text=f"{self.name} (contact)")


@outputs
class ContactOutputs(Outputs):
    """Of a contact with a contour."""

    gap: float = channel("length", "distance of what touches from the contour; negative inside")
    normal_force: float = channel("force", "force on what touches along the normal of the contour")
    friction_force: float = channel("force", "force across the normal of the contour, its amount")
    force: Components = channel("force", "force on what touches, world axes", XYZ)
    impulse: float = channel(
        "momentum", "sum of the impulses along the normal since the start, impacts included", unit="N s"
    )
    slip: float = channel("velocity", "speed at which what touches slides")
    slip_path: float = channel("length", "length of the path that it has slid")
    coordinate: Components = channel(
        "number", "parameters u and v of the touched point on the contour, 0 to 1", ("u", "v")
    )
    point: Components = channel("length", "touched point of the contour, in the world", XYZ)
    dissipated: float = channel(
        "moment or energy",
        "energy lost to impacts, damping and friction since the start, part of energy.dissipated",
        unit="J",
    )
    impacts: float = channel("number", "number of impacts since the start")
    normal_force_max: float = largest("force", "normal_force")
    normal_force_min: float = smallest("force", "normal_force")
    gap_min: float = smallest(
        "length", "gap", seen="at the ends of the steps in which it was near enough to be searched"
    )


@CONTACT_LAWS.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Contact(ContactPlace):
    """Something of a body that touches a contour of another."""

    CHANNELS: ClassVar = ContactOutputs.CHANNELS
    """What it records, in the order of its columns."""

    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.0
    """Coulomb's coefficient; 0 without."""
    footprint: Annotated[float, Positive("length"), Absent()] = 0.0
    """Radius [m] of a disc on the contour over which gap and force are spread with the weight (1 - r^2/R^2)^2."""
