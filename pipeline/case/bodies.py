"""Tables of a case file that describe bodies: inertia, frames, initial states, flexible and rigid bodies."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Generic, Literal, TypeVar

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, field_validator, model_validator

from heavylift.pipeline.case.fields import (
    AngularVelocityVector,
    Direction,
    LengthVector,
    Positive,
    Quantity,
    Section,
    VelocityVector,
    parse_list,
    quantity_schema,
    reject,
)
from heavylift.pipeline.case.geometry import Geometry, MaterialSection, MeshSection
from heavylift.pipeline.case.modes import ModesSection
from heavylift.solver.scene.bodies import Driven, Fixed, FlexibleBody, RigidBody

__all__ = [
    "AxisAngle",
    "DrivenFrame",
    "FixedFrame",
    "FlexibleBodySection",
    "Frame",
    "FreeFrame",
    "HarmonicSection",
    "Inertia",
    "InitialSection",
    "Matrix3",
    "ProfileSection",
    "RigidBodySection",
    "RigidInitialSection",
]

Row = tuple[float, float, float]
Matrix3 = tuple[Row, Row, Row]

_EXPECTED = "three principal values, or a symmetric 3 x 3 matrix, of a body that can exist"


def parse_inertia(value: Any) -> Matrix3:
    """Inertia tensor [kg m^2] about the centre of mass, body axes.

    Notes
    -----
    A mass distribution exists for a symmetric matrix J if and only if ``1/2 tr(J) I - J``, the second
    moments of the mass, is positive semi-definite: then the principal values are positive and none exceeds
    the sum of the other two. Sylvester's criterion on the principal minors decides both.
    """
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        reject(f"{value!r}", _EXPECTED)
    quantity = Quantity("moment of inertia")
    if all(isinstance(row, (list, tuple)) for row in value):
        if any(len(row) != 3 for row in value):
            reject(f"{value!r}", _EXPECTED)
        matrix = [parse_list(quantity, row, f"{i}.") for i, row in enumerate(value)]
    else:
        diagonal = parse_list(quantity, value)
        matrix = [[diagonal[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
    scale = max(abs(entry) for row in matrix for entry in row)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if abs(matrix[i][j] - matrix[j][i]) > 1e-9 * scale:
            reject(
                f"entries {i}{j} and {j}{i} differ: {matrix[i][j]:g} and {matrix[j][i]:g} kg m^2", _EXPECTED
            )
    if not _minors_positive(matrix, 0.0):
        reject(f"inertia {value!r} is not positive definite", _EXPECTED)
    trace = sum(matrix[i][i] for i in range(3))
    moments = [[(0.5 * trace if i == j else 0.0) - matrix[i][j] for j in range(3)] for i in range(3)]
    if not _minors_positive(moments, -1e-9):
        reject(f"in inertia {value!r} one principal value exceeds the sum of the others", _EXPECTED)
    return tuple(tuple(row) for row in matrix)  # type: ignore[return-value]


def _minors_positive(m: list[list[float]], tolerance: float) -> bool:
    """Whether all seven principal minors, relative to the trace, exceed a tolerance."""
    trace = sum(abs(m[i][i]) for i in range(3))
    if trace == 0.0 or not math.isfinite(trace):
        return False
    a = [[entry / trace for entry in row] for row in m]
    singles = [a[i][i] for i in range(3)]
    pairs = [a[i][i] * a[j][j] - a[i][j] * a[j][i] for i, j in ((0, 1), (0, 2), (1, 2))]
    determinant = (
        a[0][0] * pairs[2]
        - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
        + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
    )
    return all(minor > tolerance for minor in (*singles, *pairs, determinant))


_TRIPLE = {"type": "array", "items": quantity_schema(), "minItems": 3, "maxItems": 3}

Inertia = Annotated[
    Matrix3,
    BeforeValidator(parse_inertia),
    WithJsonSchema({"anyOf": [_TRIPLE, {"type": "array", "items": _TRIPLE, "minItems": 3, "maxItems": 3}]}),
]
"""Type of the field: validates to a 3 x 3 tuple [kg m^2]."""


T = TypeVar("T")
Length = Annotated[float, Quantity("length")]
Angle = Annotated[float, Quantity("angle")]


ModalValues = Annotated[
    tuple[float, ...], WithJsonSchema({"type": "array", "items": quantity_schema()}, mode="validation")
]
"""Numbers in SI or strings whose unit depends on the scaling of the mode shapes."""


class HarmonicSection(Section, Generic[T]):
    """``amplitude sin(2 pi frequency t + phase)``."""

    amplitude: T
    """Amplitude."""
    frequency: Annotated[float, Quantity("frequency", minimum=0.0, closed=True)]
    """Frequency [Hz]."""
    phase: Annotated[float, Quantity("angle")] = 0.0
    """Phase [rad]."""


class ProfileSection(Section, Generic[T]):
    """A function of time: a smooth curve through a table, plus harmonics; at rest before and after the table."""

    times: tuple[Annotated[float, Quantity("time")], ...] = ()
    """Times of the table [s], increasing."""
    values: tuple[T, ...] = ()
    """Values of the table."""
    harmonics: tuple[HarmonicSection[T], ...] = ()
    """Sine functions that are added."""

    @model_validator(mode="after")
    def _is_a_function(self) -> "ProfileSection[T]":
        if len(self.times) != len(self.values):
            reject(f"{len(self.times)} times and {len(self.values)} values", "one value a time")
        if len(self.times) == 1 or any(b <= a for a, b in pairwise(self.times)):
            reject(f"times {list(self.times)}", "none, or two and more that increase")
        if not self.times and not self.harmonics:
            reject("an empty profile", "'times' and 'values', or 'harmonics'")
        return self


class FreeFrame(Section):
    """The frame moves by the equations of motion."""

    motion: Literal["free"]
    origin: Literal["geometry", "centre_of_mass"] = "geometry"
    """Origin of the body frame: that of the geometry, or the centre of mass."""


class FixedFrame(Section):
    """The frame stays where it is; its reaction is recorded."""

    CHANNELS: ClassVar = Fixed.CHANNELS

    motion: Literal["fixed"]
    origin: Literal["geometry", "centre_of_mass"] = "geometry"
    """Origin of the body frame: that of the geometry, or the centre of mass."""


class DrivenFrame(Section):
    """The frame follows functions of time; its reaction and the work of the drive are recorded."""

    CHANNELS: ClassVar = Driven.CHANNELS

    motion: Literal["driven"]
    origin: Literal["geometry", "centre_of_mass"] = "geometry"
    """Origin of the body frame: that of the geometry, or the centre of mass."""
    x: ProfileSection[Length] | None = None
    """Displacement along the world's x axis [m]."""
    y: ProfileSection[Length] | None = None
    """Displacement along the world's y axis [m]."""
    z: ProfileSection[Length] | None = None
    """Displacement along the world's z axis [m]."""
    angle: ProfileSection[Angle] | None = None
    """Rotation [rad] about `axis` through `pivot`."""
    axis: Direction = (0.0, 0.0, 1.0)
    """World direction of the axis of rotation, any length."""
    pivot: LengthVector = (0.0, 0.0, 0.0)
    """World point on the axis of rotation [m]."""


Frame = Annotated[FreeFrame | FixedFrame | DrivenFrame, Field(discriminator="motion")]


class AxisAngle(Section):
    """A rotation about an axis."""

    axis: Direction
    """World direction of the axis, any length."""
    angle: Annotated[float, Quantity("angle")]
    """Angle of rotation [rad]."""


class RigidInitialSection(Section):
    """Initial state of the frame of a body."""

    position: LengthVector | None = None
    """World position of the frame origin [m]; by default where the geometry was drawn."""
    orientation: AxisAngle | None = None
    """Rotation from world to body axes; none by default."""
    velocity: VelocityVector | None = None
    """World velocity of the frame origin [m/s]; free frames only."""
    angular_velocity: AngularVelocityVector | None = None
    """Angular velocity in BODY axes [rad/s]; free frames only."""


class InitialSection(RigidInitialSection):
    """Initial state of a flexible body."""

    modal_scaling: Literal["unit_max", "mass"] = "unit_max"
    """``unit_max``: mode shapes with largest component 1, so that coordinates are lengths; ``mass``: modal mass 1."""
    modal_position: ModalValues = ()
    """Coordinates of the first vectors, in m (``unit_max``) or m kg^0.5 (``mass``); the others are zero."""
    modal_velocity: ModalValues = ()
    """Speeds of the first vectors, in m/s (``unit_max``) or m kg^0.5/s (``mass``); the others are zero."""

    @field_validator("modal_position", "modal_velocity", mode="before")
    @classmethod
    def _in_the_unit_of_the_scaling(cls, values: Any, info: ValidationInfo) -> Any:
        if not isinstance(values, (list, tuple)):
            reject(f"{values!r} is not a list", "a list of numbers or strings with a unit")
        by_mass = info.data.get("modal_scaling") == "mass"
        if info.field_name == "modal_position":
            kind = "modal coordinate" if by_mass else "length"
        else:
            kind = "modal velocity" if by_mass else "velocity"
        return parse_list(Quantity(kind), values)


class FlexibleBodySection(Section):
    """A body with a finite-element model that deforms."""

    CHANNELS: ClassVar = FlexibleBody.CHANNELS

    type: Literal["flexible"]
    geometry: Geometry
    """Shape, or matrices of another program."""
    material: MaterialSection | None = None
    """Material; needed unless the geometry is ``four_files``."""
    mesh: MeshSection = Field(default_factory=MeshSection)
    """Elements; for geometries that are meshed here."""
    modes: ModesSection
    """Reduction to mode shapes."""
    frame: Frame
    """How the body frame moves."""
    initial: InitialSection = Field(default_factory=InitialSection)
    """Initial state."""

    @model_validator(mode="after")
    def _fits(self) -> "FlexibleBodySection":
        given = self.geometry.type
        if given == "four_files" and self.material is not None:
            reject("'material' with geometry 'four_files'", "no material: the files hold the matrices")
        if given != "four_files" and self.material is None:
            reject("no 'material'", "young_modulus, poisson_ratio and density")
        if given == "four_files" and "mesh" in self.model_fields_set:
            reject("'mesh' with geometry 'four_files'", "no mesh section: the files hold the matrices")
        if given != "step" and self.mesh.curved:
            reject(f"'mesh.curved' with geometry {given!r}", "geometry 'step'")
        if given == "mesh" and self.mesh.model_fields_set - {"mass", "formulation", "element"}:
            keys = ", ".join(sorted(self.mesh.model_fields_set - {"mass", "formulation", "element"}))
            reject(
                f"'mesh' has {keys} with geometry 'mesh'",
                "only 'mass' and 'formulation': the file is the mesh",
            )
        if given != "blocks" and self.mesh.divisions:
            reject(f"'mesh.divisions' with geometry {given!r}", "geometry 'blocks'")
        if given == "step" and self.mesh.element != "tet10":
            reject("element 'hex8' with geometry 'step'", "element 'tet10'")
        if self.modes.basis == "stored" and given != "four_files":
            reject(
                f"basis 'stored' with geometry {given!r}", "geometry 'four_files', which brings mode shapes"
            )
        if self.frame.motion == "free" and self.modes.clamp:
            reject(
                f"{list(self.modes.clamp)} holds nodes of a body whose frame is free",
                "no clamp with a free frame (its modes are those of the free body; 'static_points' and "
                "'static_groups' add shapes under loads), or frame motion 'fixed' or 'driven'",
                key="modes.clamp",
            )
        count = self.modes.vector_count
        for key, given_count in (
            ("initial.modal_position", len(self.initial.modal_position)),
            ("initial.modal_velocity", len(self.initial.modal_velocity)),
        ):
            if count is not None and given_count > count:
                reject(f"{given_count} values", f"at most {count}, one a mode", key=key)
        if count is not None and len(self.modes.damping_ratio) not in {1, count}:
            reject(f"{len(self.modes.damping_ratio)} values", f"1 or {count}", key="modes.damping_ratio")
        _check_initial(self.frame, self.initial)
        return self


class RigidBodySection(Section):
    """A body that does not deform."""

    CHANNELS: ClassVar = RigidBody.CHANNELS

    type: Literal["rigid"]
    mass: Annotated[float, Positive("mass")]
    """Mass [kg]."""
    inertia: Inertia
    """About the centre of mass, body axes [kg m^2]: three principal values or a symmetric 3 x 3 matrix."""
    centre_of_mass: LengthVector = (0.0, 0.0, 0.0)
    """In the body frame [m]."""
    frame: Frame
    """How the body frame moves."""
    initial: RigidInitialSection = Field(default_factory=RigidInitialSection)
    """Initial state."""

    @model_validator(mode="after")
    def _fits(self) -> "RigidBodySection":
        _check_initial(self.frame, self.initial)
        return self


def _check_initial(frame: FreeFrame | FixedFrame | DrivenFrame, initial: RigidInitialSection) -> None:
    """Only a free frame has velocities of its own."""
    if frame.motion != "free":
        for key in ("velocity", "angular_velocity"):
            if getattr(initial, key) is not None:
                reject(f"with a {frame.motion} frame", "frame motion 'free'", key=f"initial.{key}")
