"""Tables of a case file that describe bodies: where they start, and what they are if numbers say it all.

Initial states are sections of the pipeline: a rotation in a case is a quaternion of an object, and what is left out is
the position of the geometry. Bodies that are meshed have modules of their own, which are imported if a case has one.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import importlib
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from heavylift.pipeline.case.described import Chosen, make_section
from heavylift.pipeline.case.fields import (
    AngularVelocityVector,
    Direction,
    LengthVector,
    Quantity,
    Section,
    VelocityVector,
    reject,
)
from heavylift.solver.scene.bodies import BODIES, MOTIONS, Body, Placed, RigidBody

__all__ = [
    "BODY_SECTIONS",
    "AxisAngle",
    "BodySection",
    "BodyTable",
    "Frame",
    "RigidBodySection",
    "RigidInitialSection",
    "body_section",
    "check_initial",
]


class _FrameSection(Section):
    """Keys of every frame."""

    origin: Literal["geometry", "centre_of_mass"] = "geometry"
    """Origin of the body frame: that of the geometry, or the centre of mass."""


@cache
def frame_section(described: Any) -> type[Section]:
    """Section of a motion of a frame."""
    return make_section(described, _FrameSection)


Frame = Annotated[Any, Chosen(MOTIONS, frame_section)]


class AxisAngle(Section):
    """A rotation about an axis."""

    axis: Direction
    """World direction of the axis, any length."""
    angle: Annotated[float, Quantity("angle")]
    """Angle of rotation [rad]."""


class RigidInitialSection(Section):
    """Initial state of the frame of a body."""

    position: LengthVector | None = None
    """World position of the frame origin [m]; by default that of the geometry."""
    orientation: AxisAngle | None = None
    """Turns the axes of the world into those of the body, and what is fixed to it with them; none by default."""
    velocity: VelocityVector | None = None
    """World velocity of the frame origin [m/s]; free frames only."""
    angular_velocity: AngularVelocityVector | None = None
    """Angular velocity in BODY axes [rad/s]; free frames only."""


class BodySection(Section):
    """What a case asks of a body, whatever it is.

    Attributes
    ----------
    BODY
        Class of the body of a scene, which answers for it.
    ASSEMBLED_BY
        Module with ``assemble_body``, ``start_body``, ``check_points`` and ``check_drawn_points``, as
        `heavylift.pipeline.assemble.frames` has them.
    """

    BODY: ClassVar[type[Body]]
    ASSEMBLED_BY: ClassVar[str] = "heavylift.pipeline.assemble.frames"

    @property
    def assembly(self) -> Any:
        """The module that makes the body of a scene from it."""
        return importlib.import_module(self.ASSEMBLED_BY)

    @property
    def has_frame(self) -> bool:
        """Whether it has a frame, which may be held or driven, as its key ``frame`` says."""
        return "frame" in type(self).model_fields

    @property
    def is_free(self) -> bool:
        """Whether it moves by the equations of motion."""
        frame = getattr(self, "frame", None)
        return frame is None or bool(frame.motion == "free")

    @property
    def drawn_origin(self) -> tuple[float, float, float]:
        """Origin of the frame in the coordinates of the geometry [m], of a body that is given in numbers."""
        frame = getattr(self, "frame", None)
        if frame is None or frame.origin == "geometry":
            return 0.0, 0.0, 0.0
        return tuple(getattr(self, "centre_of_mass", (0.0, 0.0, 0.0)))

    @property
    def has_inertia(self) -> bool:
        """Whether its mass and inertia are keys of it."""
        return {"mass", "inertia"} <= set(type(self).model_fields)


if TYPE_CHECKING:

    class _Numbers(BodySection):
        def __getattr__(self, key: str) -> Any: ...
else:
    _Numbers = make_section(RigidBody, BodySection)


class RigidBodySection(_Numbers):
    """A body that does not deform."""

    BODY: ClassVar = RigidBody

    type: Literal["rigid"]
    frame: Frame
    """How the body frame moves."""
    initial: RigidInitialSection = Field(default_factory=RigidInitialSection)
    """Initial state."""

    @model_validator(mode="after")
    def _fits(self) -> "RigidBodySection":
        check_initial(self.frame, self.initial)
        return self


def check_initial(frame: Any, initial: RigidInitialSection) -> None:
    """Only a free frame has velocities of its own."""
    if frame.motion != "free":
        for key in ("velocity", "angular_velocity"):
            if getattr(initial, key) is not None:
                reject(f"with a {frame.motion} frame", "frame motion 'free'", key=f"initial.{key}")


class _StartedSection(BodySection):
    """A body without a frame of its own."""

    initial: RigidInitialSection = Field(default_factory=RigidInitialSection)
    """Initial state: place of the body, and its motion as a rigid body."""


class _PlacedSection(BodySection):
    """A body with a frame."""

    frame: Frame
    """How the body frame moves."""
    initial: RigidInitialSection = Field(default_factory=RigidInitialSection)
    """Initial state."""

    @model_validator(mode="after")
    def _starts(self) -> "_PlacedSection":
        check_initial(self.frame, self.initial)
        return self


@cache
def body_section(described: Any) -> type[BodySection]:
    """Section of a body that is given in numbers alone."""
    if described is RigidBody:
        found: Any = RigidBodySection
        return found
    base = _PlacedSection if issubclass(described, Placed) else _StartedSection
    made: Any = make_section(described, base)
    made.BODY = described
    section: type[BodySection] = made
    return section


class _BodySections:
    """Sections of bodies by their types: those of shapes and meshes, then all that are given in numbers alone."""

    name, key, default = "body", "type", ""
    _own: ClassVar[dict[str, tuple[str, str]]] = {
        "flexible": ("flexible_bodies", "FlexibleBodySection"),
        "rigid": ("bodies", "RigidBodySection"),
        "frame": ("meshes", "FrameBodySection"),
        "rod": ("meshes", "RodBodySection"),
        "shell": ("meshes", "ShellBodySection"),
    }

    @property
    def words(self) -> tuple[str, ...]:
        """All types."""
        return (*self._own, *(word for word in BODIES.words if word not in self._own))

    def get(self, word: str) -> type[BodySection] | None:
        """Section of a type; None if there is none."""
        if word in self._own:
            module, name = self._own[word]
            found: type[BodySection] = getattr(
                importlib.import_module(f"heavylift.pipeline.case.{module}"), name
            )
            return found
        described: Any = BODIES.get(word)
        return None if described is None else body_section(described)


BODY_SECTIONS = _BodySections()
BodyTable = Annotated[Any, Chosen(BODY_SECTIONS, lambda section: section)]
