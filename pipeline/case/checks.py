"""Tables of a case file that judge results: checks against references, and convergence studies."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from heavylift.pipeline.case.fields import (
    CaseContext,
    CheckId,
    Quantity,
    QuantityString,
    Section,
    quantity_schema,
    reject,
)
from heavylift.pipeline.case.quantity_names import parse_quantity_name

__all__ = [
    "CheckSection",
    "ConvergeSection",
    "QuantityReference",
    "RunReference",
    "SeriesSection",
    "ToleranceSection",
    "quantity_in_unit",
]


def _not_blank(text: str) -> str:
    if not text.strip():
        reject(f"{text!r} has no meaning", "where the reference comes from")
    return text


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


def quantity_in_unit(info: ValidationInfo, value: Any, minimum: float | None = None) -> Any:
    """SI number of a value that has the dimension of the quantity of a section; zero if that is not known."""
    quantity, context = info.data.get("quantity"), CaseContext.of(info)
    if quantity is None:
        return 0.0
    kind = parse_quantity_name(quantity, None if context is None else context.names).kind
    return Quantity(kind.name, minimum=minimum).parse(value)


def _members(quantity: str | None, info: ValidationInfo) -> tuple[tuple[str, str], ...]:
    """Members of a group; none of a quantity that is no group, or wrong."""
    context = CaseContext.of(info)
    if quantity is None or context is None:
        return ()
    return parse_quantity_name(quantity, context.names).members


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


_LIMITS = ("maximum", "minimum")
_WITH_REFERENCE = ("reference", "tolerance", "source")
_OF_RECORDS = ("channel", "stress")
_Time = Annotated[float, Quantity("time", minimum=0.0, closed=True)]
_Limit = Annotated[float, WithJsonSchema(quantity_schema(), mode="validation")]


class CheckSection(Section):
    """One number of the results against a reference, or within limits; of a group the worst one counts."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": list(_WITH_REFERENCE)},
                {"anyOf": [{"required": [side]} for side in _LIMITS]},
            ],
            "dependentSchemas": {
                side: {"not": {"anyOf": [{"required": [key]} for key in _WITH_REFERENCE[:2]]}}
                for side in _LIMITS
            },
        }
    )

    id: CheckId
    """Unique in the case."""
    quantity: QuantityString
    """What is computed; with a pattern in place of an owner, of all that fit: ``channel.sling_*.tension.max``."""
    reference: Reference | None = None
    """Number in SI, string with a unit, or ``{ quantity = ... }``; of a group the member farthest from it counts."""
    tolerance: ToleranceSection | None = None
    """Largest error that passes; needed with a reference."""
    maximum: _Limit | None = None
    """In place of a reference: largest value that passes, in the unit of the quantity."""
    minimum: _Limit | None = None
    """In place of a reference, or beside `maximum`: smallest value that passes."""
    after: _Time | None = None
    """Only records from this time of the run on [s] count for the statistic of a channel or a stress, and for that of
    a reference that is a quantity; from its start if absent."""
    until: _Time | None = None
    """Only records up to this time [s]; to the end if absent."""
    source: Annotated[str, AfterValidator(_not_blank), Field(json_schema_extra={"pattern": r"\S"})] | None = (
        None
    )
    """Where the reference or limit comes from; needed with a reference."""

    @field_validator("reference", mode="before")
    @classmethod
    def _has_the_unit_of_the_quantity(cls, value: Any, info: ValidationInfo) -> Any:
        return value if isinstance(value, dict) or value is None else quantity_in_unit(info, value)

    @field_validator("tolerance", mode="before")
    @classmethod
    def _tolerance_has_the_unit(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, dict) and "absolute" in value:
            return value | {"absolute": quantity_in_unit(info, value["absolute"], 0.0)}
        return value

    @field_validator("maximum", "minimum", mode="before")
    @classmethod
    def _limits_have_the_unit(cls, value: Any, info: ValidationInfo) -> Any:
        return None if value is None else quantity_in_unit(info, value)

    @model_validator(mode="after")
    def _a_reference_or_limits(self) -> "CheckSection":
        limits = [side for side in _LIMITS if getattr(self, side) is not None]
        given = [key for key in _WITH_REFERENCE[:2] if getattr(self, key) is not None]
        if limits and given:
            reject(
                f"both {given[0]!r} and {limits[0]!r}",
                "'reference' with 'tolerance', or 'maximum' or 'minimum'",
                key=limits[0],
            )
        if not limits and not given:
            expected = "'reference' with 'tolerance' and 'source', or 'maximum' or 'minimum'"
            reject("has neither a reference nor a limit", expected)
        if given:
            missing = next((key for key in _WITH_REFERENCE if getattr(self, key) is None), None)
            if missing is not None:
                reject("is missing", "a value: needed with a reference", key=missing)
        if self.maximum is not None and self.minimum is not None and self.minimum >= self.maximum:
            reject(f"{self.minimum:g} is not below the maximum, {self.maximum:g}", "less", key="minimum")
        return self

    @model_validator(mode="after")
    def _relative_to_something(self) -> "CheckSection":
        if self.tolerance is not None and self.tolerance.relative is not None and self.reference == 0.0:
            reject("a relative tolerance about a reference of 0", "tolerance = { absolute = ... }")
        _refuse_itself(self.quantity, self.reference)
        return self

    @model_validator(mode="after")
    def _has_a_span(self) -> "CheckSection":
        given = next((key for key in ("after", "until") if getattr(self, key) is not None), None)
        if given is not None and self.quantity.partition(".")[0] not in _OF_RECORDS:
            reject(f"a time with {self.quantity!r}", "a statistic of a channel or a stress", key=given)
        if self.until is not None and self.until <= (self.after or 0.0):
            reject(f"{self.until:g} s is not later than 'after'", "a later time", key="until")
        return self

    @field_validator("reference")
    @classmethod
    def _is_one_number(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, QuantityReference):
            count = len(_members(value.quantity, info))
            if count:
                reject(f"{value.quantity!r} is of {count} items", "one number", key="quantity")
        return value


class SeriesSection(Section):
    """One curve of a study of several: some keys of the case are set, then one parameter takes its values."""

    name: Annotated[str, Field(min_length=1, max_length=60)]
    """What the curve is called."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Keys of the case (dotted paths) and their values; the empty text removes a key."""
    parameter: str
    """Dotted path of a key, e.g. ``"simulate.step"``."""
    values: Annotated[tuple[Any, ...], Field(min_length=1)]
    """Values of the parameter, coarse to fine."""


class ConvergeSection(Section):
    """A convergence study: the case is run for several values of one parameter, or of one in each of several series."""

    model_config = ConfigDict(
        json_schema_extra={"oneOf": [{"required": ["parameter", "values"]}, {"required": ["series"]}]}
    )

    parameter: str | None = None
    """Dotted path of a key, e.g. ``"simulate.step"``."""
    values: Annotated[tuple[Any, ...], Field(min_length=2)] | None = None
    """Values of the parameter, coarse to fine."""
    quantity: QuantityString
    """What is computed; of a channel without component, the whole vector; with a pattern, one component a name."""
    reference: StudyReference
    """Exact value, ``{ quantity = ... }`` of the same run, or ``{ run = VALUE }``: the same quantity of a run with
    this (finer) value of the parameter."""
    relative: bool = True
    """Whether the error is divided by the norm of the reference."""
    runs: Annotated[int, Field(ge=1, le=100, strict=True)] = 1
    """How often each simulation is run; the median of the CPU times counts."""
    series: tuple[SeriesSection, ...] = ()
    """In place of parameter and values: several series, compared by their errors and CPU times."""

    @field_validator("reference", mode="before")
    @classmethod
    def _has_the_unit_of_the_quantity(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, dict):
            return value
        count = len(_members(info.data.get("quantity"), info))
        if count:
            reject(f"one value for a quantity of {count} items", "another quantity, or a run, as reference")
        return quantity_in_unit(info, value)

    @model_validator(mode="after")
    def _can_fail(self) -> "ConvergeSection":
        _refuse_itself(self.quantity, self.reference)
        return self

    @model_validator(mode="after")
    def _varies_something(self) -> "ConvergeSection":
        if self.series:
            if self.parameter is not None or self.values is not None:
                reject("both 'series' and 'parameter' or 'values'", "'series', or 'parameter' and 'values'")
            if isinstance(self.reference, RunReference):
                reject("another run with 'series'", "a value, or another quantity", key="reference")
            names = [series.name for series in self.series]
            for index, name in enumerate(names):
                if name in names[:index]:
                    reject(f"{name!r} is used before", "one series a name", key=f"series.{index}.name")
        elif self.parameter is None or self.values is None:
            missing = "parameter" if self.parameter is None else "values"
            reject("is missing", "'parameter' and 'values', or 'series'", key=missing)
        elif self.relative and self.reference == 0.0:
            reject("a relative error about a reference of 0", "relative = false", key="relative")
        return self
