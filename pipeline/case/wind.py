"""Tables of a case file that describe wind and current."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from heavylift.pipeline.case.fields import (
    Positive,
    Quantity,
    Section,
    UniqueName,
    reject,
)
from heavylift.pipeline.case.waves import Heading
from heavylift.solver.scene.wind_loads import CurrentField, WindField

__all__ = [
    "CurrentProfileSection",
    "CurrentSection",
    "TurbulenceSection",
    "VeeringSection",
    "WindSection",
]

COEFFICIENT_COLUMNS = (("angle", "cx", "cy", "cn"), ("angle_deg", "cx", "cy", "cn"))
"""Headers of a table of coefficients: angles in rad, or in degrees."""

LARGEST_CURRENT = 10.0
LARGEST_WIND = 75.0
"""Speeds [m/s] beyond which a number is taken for a slip of units."""

_KNOT = 1852.0 / 3600.0
_Number = Annotated[float, Quantity("number")]
_Time = Annotated[float, Quantity("time")]
_Length = Annotated[float, Positive("length")]
_Area = Annotated[float, Quantity("area", minimum=0.0, closed=True)]


def _is_no_slip(value: float, largest: float) -> float:
    """A speed [m/s] that can be one."""
    if value > largest:
        hint = f'; in knots "{value:g} knot" is {value * _KNOT:.4g} m/s'
        reject(f"{value:g} m/s", f"a speed from 0 to {largest:g} m/s{hint}")
    return value


_WindSpeed = Annotated[
    float,
    Quantity("velocity", minimum=0.0, closed=True),
    AfterValidator(lambda v: _is_no_slip(v, LARGEST_WIND)),
]
_CurrentSpeed = Annotated[
    float,
    Quantity("velocity", minimum=0.0, closed=True),
    AfterValidator(lambda v: _is_no_slip(v, LARGEST_CURRENT)),
]


def _increasing(values: tuple[float, ...], other: int, what: str, expected: str) -> None:
    """Refuse a table that is none."""
    if len(values) != other or any(b <= a for a, b in pairwise(values)):
        reject(f"{len(values)} {what}, {other} values", expected)


class VeeringSection(Section):
    """A direction that changes in time, linear between."""

    times: Annotated[tuple[_Time, ...], Field(min_length=2)]
    """[s], increasing."""
    angles: Annotated[tuple[Annotated[float, Quantity("angle")], ...], Field(min_length=2)]
    """Where the fluid goes [rad]."""

    @model_validator(mode="after")
    def _is_a_table(self) -> Self:
        _increasing(self.times, len(self.angles), "times", "increasing times, one angle each")
        return self


class CurrentProfileSection(Section):
    """A current over the depth, linear between, held beyond."""

    depths: Annotated[
        tuple[Annotated[float, Quantity("length", minimum=0.0, closed=True)], ...], Field(min_length=2)
    ]
    """Below the still water [m], increasing."""
    speeds: Annotated[tuple[_CurrentSpeed, ...], Field(min_length=2)]
    """[m/s]."""

    @model_validator(mode="after")
    def _is_a_table(self) -> Self:
        _increasing(self.depths, len(self.speeds), "depths", "increasing depths, one speed each")
        return self


def _form(value: Any) -> str:
    return "a table" if isinstance(value, (dict, Section)) else "a number"


Veering = Annotated[
    Annotated[Heading, Tag("a number")] | Annotated[VeeringSection, Tag("a table")], Discriminator(_form)
]
"""A direction of propagation [rad], or a table of it over time."""


class TurbulenceSection(Section):
    """Fluctuation of the wind by the NPD spectrum of ISO 19901-1."""

    seed: Annotated[int, Field(ge=0, strict=True)]
    """Of the random numbers; the same seed gives the same wind."""
    count: Annotated[int, Field(ge=10, le=100_000, strict=True)] = 200
    """Components, equal in the logarithm of the frequency."""
    height: Annotated[float, Positive("length")] = 10.0
    """Above the water whose spectrum it is [m]: that of the loads."""
    step: Annotated[float, Positive("time")] = 0.1
    """Between the values of the record [s], which is as long as the simulation."""


class WindSection(Section):
    """Wind above the still water."""

    CHANNELS: ClassVar = WindField.CHANNELS

    name: Annotated[UniqueName, Field(validate_default=True)] = "wind"
    """By which loads refer to it, and the first part of its channels."""
    speed: _WindSpeed
    """Mean at 10 m above the water [m/s]."""
    averaging_time: Annotated[float, Quantity("time", minimum=0.0)] = 3600.0
    """Over which the speed is a mean [s], up to an hour; converted to the one-hour mean by ISO 19901-1."""
    direction: Veering = 0.0
    """Where the wind goes [rad], from world x, anticlockwise seen from above; or a table over time."""
    profile: Literal["log", "power", "uniform"] = "log"
    """``log``: ISO 19901-1; ``power``: with an exponent of 0.11; ``uniform``: the same at all heights."""
    exponent: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] | None = None
    """Of the profile ``power``; 0.11 if absent."""
    gust: Annotated[float, Quantity("time", minimum=0.0)] | None = None
    """Averaging time [s] of a constant gust in place of the one-hour mean."""
    spectrum: TurbulenceSection | None = None
    """Fluctuation about the mean; none if absent."""
    density: Annotated[float, Quantity("density", minimum=0.5, maximum=2.0)] = 1.225
    """Of the air [kg/m^3]."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        for key in ("averaging_time", "gust"):
            value = getattr(self, key)
            if value is not None and value > 3600.0:
                reject(f"{value:g} s", "a time up to an hour [s]", key=key)
        if self.gust is not None and self.spectrum is not None:
            reject(
                "both 'gust' and 'spectrum'", "a constant gust, or a fluctuation about the mean", key="gust"
            )
        if self.exponent is not None and self.profile != "power":
            reject(
                f"'exponent' with profile {self.profile!r}",
                "profile 'power', or no 'exponent'",
                key="exponent",
            )
        return self


class CurrentSection(Section):
    """Current below the still water."""

    CHANNELS: ClassVar = CurrentField.CHANNELS

    name: Annotated[UniqueName, Field(validate_default=True)] = "current"
    """By which loads refer to it, and the first part of its channels."""
    speed: Annotated[
        Annotated[_CurrentSpeed, Tag("a number")] | Annotated[CurrentProfileSection, Tag("a table")],
        Discriminator(_form),
    ]
    """The same at all depths [m/s], or a table over the depth."""
    direction: Veering = 0.0
    """Where the water goes [rad], from world x, anticlockwise seen from above; or a table over time."""
