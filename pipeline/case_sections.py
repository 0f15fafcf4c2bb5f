"""Tables of a case file besides the bodies: loads, sensors, simulation, report, checks, convergence."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from heavylift.pipeline.fields import (
    AccelerationVector,
    BodyName,
    CheckId,
    ForceVector,
    LengthVector,
    Positive,
    Quantity,
    QuantityString,
    Section,
    UniqueName,
    quantity_schema,
    reject,
)
from heavylift.pipeline.quantity_names import parse_quantity_name

__all__ = [
    "CheckSection",
    "ConvergeSection",
    "GravitySection",
    "PointForceSection",
    "QuantityReference",
    "ReportSection",
    "RunReference",
    "SensorSection",
    "SimulateSection",
    "ToleranceSection",
]

Index = Annotated[int, Field(ge=1, strict=True)]
Time = Annotated[float, Quantity("time", minimum=0.0, closed=True)]


def _not_blank(text: str) -> str:
    if not text.strip():
        reject(f"{text!r} says nothing", "where the reference comes from")
    return text


class GravitySection(Section):
    """Uniform gravity."""

    acceleration: AccelerationVector
    """World axes [m/s^2]."""


class PointForceSection(Section):
    """A force on a material point, constant or from a table over time."""

    type: Literal["point"] = "point"
    name: UniqueName
    """Its name."""
    body: BodyName
    """Body that is loaded."""
    point: LengthVector
    """Loaded point in the coordinates of the geometry [m]; of a flexible body the nearest node."""
    force: ForceVector | None = None
    """A constant force [N]."""
    times: tuple[Annotated[float, Quantity("time")], ...] = ()
    """Times of the table [s], increasing."""
    forces: tuple[ForceVector, ...] = ()
    """Forces of the table [N], linear in between, constant before and after."""
    frame: Literal["world", "body"] = "world"
    """Axes of the force: of the world, or of the body frame."""

    @model_validator(mode="after")
    def _is_a_function(self) -> "PointForceSection":
        if (self.force is None) == (not self.times and not self.forces):
            reject("not exactly one of 'force' and a table", "'force', or 'times' and 'forces'")
        if len(self.times) != len(self.forces):
            reject(f"{len(self.times)} times and {len(self.forces)} forces", "one force a time")
        if any(b <= a for a, b in pairwise(self.times)):
            reject(f"times {list(self.times)}", "increasing times")
        return self


class SensorSection(Section):
    """A material point whose position and velocity are recorded."""

    name: UniqueName
    """Name; its channels are ``NAME.position`` and ``NAME.velocity``."""
    body: BodyName
    """Body that carries it."""
    point: LengthVector
    """Point in the coordinates of the geometry [m]; of a flexible body the nearest node."""


class SimulateSection(Section):
    """Time integration."""

    integrator: Literal["dele2", "thesis"] = "dele2"
    """``dele2``: second order, the default; ``thesis``: first order, as published."""
    step: Annotated[float, Positive("time")]
    """Time step [s]."""
    output_interval: Annotated[float, Positive("time")]
    """Time between recorded states [s], a multiple of the step."""
    duration: Annotated[float, Positive("time")]
    """Simulated time [s], a multiple of the output interval."""

    @field_validator("output_interval", "duration")
    @classmethod
    def _is_a_multiple(cls, value: float, info: ValidationInfo) -> float:
        key = "step" if info.field_name == "output_interval" else "output_interval"
        unit = info.data.get(key)
        if unit is not None and _multiple(value, unit) is None:
            reject(
                f"{value:.12g} s is {value / unit:.9g} times {key} = {unit:.12g} s", f"a multiple of {key}"
            )
        return value

    @property
    def record_every(self) -> int:
        """Steps between recorded states."""
        return _multiple(self.output_interval, self.step) or 1

    @property
    def step_count(self) -> int:
        """Steps of the whole simulation."""
        return (_multiple(self.duration, self.output_interval) or 1) * self.record_every


def _multiple(value: float, unit: float) -> int | None:
    """Which whole multiple of a unit a value is; None if it is none, to 1e-6 of a unit."""
    ratio = value / unit
    count = round(ratio)
    return count if count >= 1 and abs(ratio - count) <= 1e-6 * max(1.0, 1e-6 * count) else None


class ReportSection(Section):
    """Pictures and plots of the report."""

    modes: tuple[Index, ...] = (1, 2, 3, 4, 5)
    """Mode shapes that are pictured; those that the body does not have are left out."""
    stress_modes: tuple[Index, ...] = (1,)
    """Modes whose von Mises stress is pictured."""
    stress_times: tuple[Time, ...] = ()
    """Times [s] whose von Mises stress is pictured; the one of largest elastic energy if empty."""
    deformation: Annotated[float, Positive("number")] = 0.1
    """Largest displacement drawn in pictures of mode shapes, relative to the size of the body."""
    channels: tuple[str, ...] = ()
    """Channels plotted over time; a choice is made if empty."""
    spectra: tuple[str, ...] = ()
    """Channels whose amplitude spectra are plotted; the modal positions if empty."""


class QuantityReference(Section):
    """A reference that is itself computed."""

    quantity: QuantityString
    """Name of the quantity."""


class RunReference(Section):
    """A reference that is the same quantity of another run."""

    run: Any
    """Value of the parameter in the run that serves as reference."""


class ToleranceSection(Section):
    """Largest error that passes; exactly one of the two."""

    relative: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] | None = None
    """Error divided by the absolute value of the reference, below 1: zero itself would pass with 1."""
    absolute: (
        Annotated[float, WithJsonSchema(quantity_schema(exclusiveMinimum=0.0), mode="validation")] | None
    ) = None
    """Error in the unit of the quantity: a number in SI, or a string with a unit."""

    @model_validator(mode="after")
    def _exactly_one(self) -> "ToleranceSection":
        if (self.relative is None) == (self.absolute is None):
            reject("not exactly one of 'relative' and 'absolute'", "one of them, positive")
        return self


def _in_unit_of(quantity: str | None, value: Any, minimum: float | None = None) -> Any:
    """SI number of a value that has the dimension of a quantity; left alone if the quantity is not known."""
    if quantity is None:
        return 0.0
    return Quantity(parse_quantity_name(quantity).kind.name, minimum=minimum).parse(value)


def _reference_kind(value: Any) -> str:
    """Tell references that are tables from plain values."""
    if isinstance(value, QuantityReference) or (isinstance(value, dict) and "run" not in value):
        return "another quantity"
    return "another run" if isinstance(value, (RunReference, dict)) else "value"


Value = Annotated[float, Tag("value"), WithJsonSchema(quantity_schema(), mode="validation")]
Reference = Annotated[
    Value | Annotated[QuantityReference, Tag("another quantity")],
    Discriminator(_reference_kind),
]
StudyReference = Annotated[
    Value
    | Annotated[QuantityReference, Tag("another quantity")]
    | Annotated[RunReference, Tag("another run")],
    Discriminator(_reference_kind),
]


def _refuse_itself(quantity: str, reference: Any) -> None:
    """A quantity that is compared with itself agrees whatever its value is."""
    if isinstance(reference, QuantityReference) and reference.quantity == quantity:
        reject(
            f"{quantity!r} is compared with itself", "a value, or another quantity", key="reference.quantity"
        )


class CheckSection(Section):
    """One number of the results against a reference."""

    id: CheckId
    """Unique in the case."""
    quantity: QuantityString
    """What is computed."""
    reference: Reference
    """Number in SI, string with a unit, or ``{ quantity = ... }``."""
    tolerance: ToleranceSection
    """Largest error that passes."""
    source: Annotated[str, AfterValidator(_not_blank), Field(json_schema_extra={"pattern": r"\S"})]
    """Where the reference comes from."""

    @field_validator("reference", mode="before")
    @classmethod
    def _has_the_unit_of_the_quantity(cls, value: Any, info: ValidationInfo) -> Any:
        return value if isinstance(value, dict) else _in_unit_of(info.data.get("quantity"), value)

    @field_validator("tolerance", mode="before")
    @classmethod
    def _tolerance_has_the_unit(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, dict) and "absolute" in value:
            return value | {"absolute": _in_unit_of(info.data.get("quantity"), value["absolute"], 0.0)}
        return value

    @model_validator(mode="after")
    def _relative_to_something(self) -> "CheckSection":
        if self.tolerance.relative is not None and self.reference == 0.0:
            reject("a relative tolerance about a reference of 0", "tolerance = { absolute = ... }")
        _refuse_itself(self.quantity, self.reference)
        return self


class ConvergeSection(Section):
    """A convergence study: the case is run for several values of one parameter."""

    parameter: str
    """Dotted path of a key, e.g. ``"simulate.step"``."""
    values: Annotated[tuple[Any, ...], Field(min_length=2)]
    """Values of the parameter, coarse to fine."""
    quantity: QuantityString
    """What is computed; of a channel without component, the whole vector."""
    reference: StudyReference
    """Exact value, ``{ quantity = ... }`` of the same run, or ``{ run = VALUE }``: the same quantity of a run with
    this (finer) value of the parameter."""
    relative: bool = True
    """Whether the error is divided by the norm of the reference."""

    @field_validator("reference", mode="before")
    @classmethod
    def _has_the_unit_of_the_quantity(cls, value: Any, info: ValidationInfo) -> Any:
        return value if isinstance(value, dict) else _in_unit_of(info.data.get("quantity"), value)

    @model_validator(mode="after")
    def _can_fail(self) -> "ConvergeSection":
        _refuse_itself(self.quantity, self.reference)
        return self
