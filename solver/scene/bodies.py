"""Descriptions of bodies: how a frame moves, rigid bodies and flexible ones with modes; SI units."""

from __future__ import annotations

import importlib
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
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
from heavylift.solver.scene.drawn import At, Element, Mark, ModalShape, Solid
from heavylift.solver.scene.outlines import inertia_box
from heavylift.solver.scene.outputs import Components, Outputs, Part, Parts, channel, outputs
from heavylift.solver.scene.speed_profiles import check_speeds

if TYPE_CHECKING:
    from collections.abc import Iterable

    from heavylift.modal.reduced import ReducedBody

__all__ = [
    "BODIES",
    "GROUND",
    "MOTIONS",
    "Body",
    "Driven",
    "Fixed",
    "FlexibleBody",
    "FrameOutputs",
    "Free",
    "Harmonic",
    "HeldOutputs",
    "ModalOutputs",
    "Motion",
    "Placed",
    "PointOutputs",
    "Profile",
    "RigidBody",
    "Started",
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
BODIES: Family[Any] = Family("body", "heavylift.solver.scene", "heavylift.solver.bodies.*")
"""Bodies that are given by numbers alone, by their types in a case file."""

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
    """Of the table: `smooth` has no jumps of the acceleration and may overshoot the values of two neighbours, which the
    run reports; `monotone` never overshoots, and its acceleration jumps."""
    speeds: Annotated[NDArray[np.float64], SPEED, Shape((None,))] = field(default_factory=no_rows)
    """In place of `values`: linear between the times, held before the first and after the last; with `acceleration`
    targets, to which a drive, at rest at first, begins to change at the times."""
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

Holder = Literal["diagonal", "factored", "prescribed"]
"""What rows find of the mass of a body: reciprocals, a factor of its own, or nothing that moves."""


class Body:
    """What a scene asks of a body, whatever it is. A class of bodies says what differs from the answers here.

    Attributes
    ----------
    KIND_MODULE
        Module whose ``pack(bodies, places)`` makes the kind of all bodies of this class
        (`heavylift.solver.body_places`); it is imported when a scene has one. Mesh data and whatever else needs
        kernels is asked of it too.
    ORDER
        Kinds are in the order of this number in a scene.
    NOUN
        What it is called in messages.
    DEFORMS
        Whether it is anything but rigid.
    MODAL
        Whether stages compute modes of a finite element model for it.
    CONTOURS
        How points of a contour on it move: with the frame, with modes too, or with nodes; empty if it carries none.
    SHAPE
        What it is by itself, whose tangents and edges joints hold, and which contacts touch; empty of a solid.
    SEEN_AT_POINTS
        Whether its velocities in the workspace are those of the material points that are in use, three each.
    HAS_AXES
        Whether directions at a point of it are known, not only its tangent.
    ITERATES
        Whether its step is iterated, and may be halved where that fails.
    FLOATS
        Whether it is a hull.
    """

    KIND_MODULE: ClassVar[str]
    ORDER: ClassVar[int] = 100
    NOUN: ClassVar[str] = "body"
    DEFORMS: ClassVar[bool] = True
    MODAL: ClassVar[bool] = False
    CONTOURS: ClassVar[Literal["", "rigid", "modes", "nodes"]] = ""
    SHAPE: ClassVar[Literal["", "curve", "surface"]] = ""
    SEEN_AT_POINTS: ClassVar[bool] = False
    HAS_AXES: ClassVar[bool] = True
    ITERATES: ClassVar[bool] = False
    FLOATS: ClassVar[bool] = False

    CHANNELS: ClassVar[tuple[ChannelKind, ...]]
    """What it records, in the order of its columns."""

    if TYPE_CHECKING:  # dataclasses and properties have them in their own ways

        @property
        def name(self) -> str:
            """Prefix of its channels."""
            ...

        @property
        def motion(self) -> Motion:
            """How its frame moves."""
            ...

        @property
        def position(self) -> NDArray[np.float64]:
            """Origin of its axes at the start [m], world."""
            ...

        @property
        def orientation(self) -> NDArray[np.float64]:
            """Unit quaternion of its axes at the start, scalar first."""
            ...

    @property
    def kind_module(self) -> Any:
        """The module that packs it."""
        return importlib.import_module(self.KIND_MODULE)

    @property
    def place_in_kind(self) -> int:
        """Bodies of a kind are in the order of this, then in that of the scene."""
        return 0

    @property
    def group_names(self) -> tuple[str, ...]:
        """Names of the bodies that are one body to joints, in order; empty of one that stands alone."""
        return ()

    @property
    def mode_count(self) -> int:
        """Modal coordinates."""
        return 0

    def velocity_count(self, points: int) -> int:  # noqa: ARG002  of classes that are seen at points
        """Velocities in the workspace, with a number of material points in use."""
        return 6 + self.mode_count

    @property
    def holder(self) -> Holder:
        """What rows find of its mass."""
        return "factored"

    @property
    def inverse_masses(self) -> NDArray[np.float64] | None:
        """Reciprocals of a diagonal mass matrix [1/kg, 1/(kg m2)], in the axes of the kind; None of any other one."""
        return None

    def inverse_scales(self) -> tuple[float, float]:
        """Inverse mass [1/kg] and smallest inverse inertia [1/(kg m2)]; zero for prescribed motion."""
        raise NotImplementedError

    @property
    def mass_properties(self) -> tuple[float, NDArray[np.float64], NDArray[np.float64]] | None:
        """Mass [kg], its centre [m] and inertia about it [kg m2] in axes of the body, of the shape it was given.

        None of a body without such a shape: its weight is then given otherwise.
        """
        return None

    @property
    def mesh_nodes(self) -> NDArray[np.float64] | None:
        """Nodes [m], shape (n, 3), to which points on it are attached; None if any point is one of it."""
        return None

    def nearest(
        self,
        point: NDArray[np.float64],
        *,
        source: str,  # noqa: ARG002  of classes that refuse
        key: str,  # noqa: ARG002
    ) -> NDArray[np.float64]:
        """Material point [m] next to a place, however far; `source` and `key` are for messages."""
        return np.asarray(point, dtype=np.float64)

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """Components of channels that have as many as it has modes, nodes or elements."""
        return {}

    @property
    def times(self) -> list[float]:
        """Times [s] at which what acts on it jumps or has a corner."""
        return []

    @property
    def highest_rate(self) -> float:
        """Bound of the rate of its fastest vibration [1/s] of which an explicit integrator knows; 0 of none."""
        return 0.0

    def refusal(self, integrator: str, *, jointed: bool) -> str:  # noqa: ARG002  of classes that refuse
        """Why an integrator cannot serve it, in a scene with joints or without, as words; empty if it can."""
        return ""

    def start_shapes(self) -> dict[str, tuple[int, ...]]:
        """Refuse what cannot be packed; shapes of its start values by key."""
        return {"position": (3,), "orientation": (4,), "velocity": (3,), "angular_velocity": (3,)}

    def drawn(self) -> Iterable[Element]:
        """What it looks like, see `heavylift.solver.scene.drawn`; nothing unless a class says so."""
        return ()

    def contour_frame(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Origin [m] and axes, as columns, of what the solver measures a contour in, in the frame of the body."""
        return np.zeros(3), np.eye(3)


@dataclass(frozen=True, eq=False, kw_only=True)
class Started(Body):
    """Where a body starts.

    Attributes
    ----------
    position, orientation
        Frame origin [m], world; unit quaternion (scalar first).
    velocity, angular_velocity
        Of the frame: world axes [m/s]; **body** axes [rad/s]. For free frames only: others move as their
        motion says.
    """

    position: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    orientation: NDArray[np.float64] = field(default_factory=_upright)
    velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))
    angular_velocity: NDArray[np.float64] = field(default_factory=lambda: _zeros(3))


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed(Started):
    """What bodies with a frame have.

    Attributes
    ----------
    motion
        How the frame moves.
    """

    motion: Motion = field(default_factory=Free)


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

    KIND_MODULE: ClassVar = "heavylift.solver.bodies.floating_frame.packing"
    ORDER: ClassVar = 1
    NOUN: ClassVar = "flexible body"
    MODAL: ClassVar = True
    CONTOURS: ClassVar = "modes"
    CHANNELS: ClassVar = (*FrameOutputs.CHANNELS, *ModalOutputs.CHANNELS)
    """What it records, in the order of its columns."""

    name: str
    reduced: ReducedBody
    modal_position: NDArray[np.float64] = field(default_factory=no_rows, kw_only=True)
    modal_velocity: NDArray[np.float64] = field(default_factory=no_rows, kw_only=True)
    damping_ratio: NDArray[np.float64] = field(default_factory=no_rows, kw_only=True)

    @property
    def place_in_kind(self) -> int:
        """Those with a fixed frame come last."""
        return int(isinstance(self.motion, Fixed))

    @property
    def mode_count(self) -> int:
        """Modal coordinates."""
        return self.reduced.mode_count

    def inverse_scales(self) -> tuple[float, float]:
        """Of the shape without modes."""
        integrals = self.reduced.integrals
        largest = float(np.linalg.eigvalsh(integrals.inertia_kl)[1:].sum())
        held = not isinstance(self.motion, Free) and self.reduced.mode_count == 0
        return (0.0, 0.0) if held else (1.0 / integrals.mass, 1.0 / largest)

    @property
    def mass_properties(self) -> tuple[float, NDArray[np.float64], NDArray[np.float64]] | None:
        """Of the shape without modes."""
        integrals = self.reduced.integrals
        mass, centre = float(integrals.mass), integrals.first_moment / integrals.mass
        second = integrals.inertia_kl - mass * np.outer(centre, centre)
        return mass, centre, np.trace(second) * np.eye(3) - second

    @property
    def mesh_nodes(self) -> NDArray[np.float64] | None:
        """Of the finite-element model."""
        return self.reduced.nodes

    def nearest(self, point: NDArray[np.float64], *, source: str, key: str) -> NDArray[np.float64]:
        """On the finite-element model."""
        found, weights = self.reduced.locate(point, source=source, key=key, within=np.inf)
        return np.asarray(weights @ self.reduced.nodes[found])

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """By number of the mode."""
        modes = tuple(str(i + 1) for i in range(self.mode_count))
        return {"modal_position": modes, "modal_velocity": modes}

    def refusal(self, integrator: str, *, jointed: bool) -> str:
        """The accurate integrator knows no modes, the thesis none in joints."""
        if integrator == "accurate":
            return f"body {self.name!r} is flexible"
        if integrator == "thesis" and jointed:
            return f"joints hold the flexible body {self.name!r}"
        return ""

    def start_shapes(self) -> dict[str, tuple[int, ...]]:
        """Modal values are as many as modes, or none."""
        keys = ("modal_position", "modal_velocity", "damping_ratio")
        modal = {key: (self.mode_count,) for key in keys if np.size(getattr(self, key))}
        return {**super().start_shapes(), **modal}

    def drawn(self) -> Iterable[Element]:
        """The surface of its mesh, deformed by its modes."""
        yield ModalShape(
            name=self.name,
            role="body",
            nodes=self.reduced.nodes,
            shapes=self.reduced.mode_shapes,
            amplitudes=f"{self.name}.modal_position",
            start=self.modal_position,
        )


@BODIES.describe("rigid")
@dataclass(frozen=True, eq=False)
class RigidBody(Placed):
    """A body that does not deform."""

    KIND_MODULE: ClassVar[str] = "heavylift.solver.bodies.rigid.packing"
    ORDER: ClassVar[int] = 2
    NOUN: ClassVar[str] = "rigid body"
    DEFORMS: ClassVar[bool] = False
    CONTOURS: ClassVar = "rigid"
    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = FrameOutputs.CHANNELS
    """What it records, in the order of its columns."""

    name: str
    mass: Annotated[float, Positive("mass")]
    """Mass [kg]."""
    inertia: Annotated[NDArray[np.float64], Quantity("moment of inertia"), Square(3)]
    """About the centre of mass, body axes [kg m^2]: three principal values or a symmetric 3 x 3 matrix."""
    centre_of_mass: Annotated[NDArray[np.float64], BodyPoint()] = field(default_factory=lambda: _zeros(3))
    """In the coordinates of the geometry [m]."""

    def drawn(self) -> Iterable[Element]:
        """Its centre of mass; a box of the same mass and inertia, if it has no surface."""
        box = inertia_box(self.mass, self.inertia, self.centre_of_mass)
        yield Solid(name=self.name, role="box", body=self.name, points=box.points, triangles=box.triangles)
        yield Mark(name=self.name, role="centre", at=At(self.name, self.centre_of_mass))

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

    @property
    def holder(self) -> Holder:
        """Its mass matrix is diagonal in principal axes."""
        return "diagonal" if isinstance(self.motion, Free) else "prescribed"

    @property
    def inverse_masses(self) -> NDArray[np.float64] | None:
        """In principal axes."""
        if not isinstance(self.motion, Free):
            return None
        return np.concatenate([np.full(3, 1.0 / self.mass), 1.0 / np.linalg.eigvalsh(self.inertia)])

    def inverse_scales(self) -> tuple[float, float]:
        """Nothing of a prescribed motion."""
        if not isinstance(self.motion, Free):
            return 0.0, 0.0
        return 1.0 / self.mass, 1.0 / float(np.linalg.eigvalsh(self.inertia)[2])

    @property
    def mass_properties(self) -> tuple[float, NDArray[np.float64], NDArray[np.float64]] | None:
        """As given."""
        return self.mass, np.asarray(self.centre_of_mass), np.asarray(self.inertia)

    def contour_frame(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Centre of mass and principal axes."""
        packing = importlib.import_module(RigidBody.KIND_MODULE)
        found: tuple[NDArray[np.float64], NDArray[np.float64]] = packing.principal_frame(self)
        return found
