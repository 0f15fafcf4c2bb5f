"""Tables of a case file that describe wind, current, and what they push on."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, ValidationInfo, model_validator

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.columns import read_columns
from heavylift.pipeline.case.fields import (
    BodyName,
    CaseContext,
    Direction,
    InFolder,
    LengthVector,
    Positive,
    Quantity,
    Section,
    UniqueName,
    refuse_unknown,
    reject,
)
from heavylift.pipeline.case.waves import Heading
from heavylift.solver.scene.wind_loads import CoefficientLoad, CurrentField, DragElement, WindField

__all__ = [
    "COEFFICIENT_COLUMNS",
    "CoefficientLoadSection",
    "CurrentProfileSection",
    "CurrentSection",
    "DragElementSection",
    "DragLoadSection",
    "FluidLoad",
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


def _known_fluid(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context:
        refuse_unknown("wind or current", name, context.names.fluids)
    return name


class _FluidLoadSection(Section):
    """What all loads of wind and current have."""

    type: str
    """How the force is found."""
    name: UniqueName
    """Name; the first part of its channels."""
    body: BodyName
    """Body that is pushed on."""
    fluid: Annotated[str, AfterValidator(_known_fluid), Field(validate_default=True)] = "wind"
    """Name of the wind or current."""
    axis: Direction = (1.0, 0.0, 0.0)
    """Direction of the body that is its heading, in its coordinates."""


class CoefficientLoadSection(_FluidLoadSection):
    """Horizontal force and yaw moment on a whole body, by coefficients over the direction of the relative flow."""

    CHANNELS: ClassVar = CoefficientLoad.CHANNELS

    type: Literal["coefficients"]
    point: LengthVector
    """Centre of pressure, in the coordinates of the geometry [m]."""
    file: Annotated[str, InFolder()] | None = None
    """Comma-separated with the header ``angle,cx,cy,cn`` (rad) or ``angle_deg,cx,cy,cn``."""
    angles: tuple[Annotated[float, Quantity("angle")], ...] = ()
    """In place of `file`: directions in which the fluid goes past the body [rad], from its heading, anticlockwise: 0
    comes from astern, 180 degrees is a head wind."""
    cx: tuple[_Number, ...] = ()
    """Coefficients of the force ahead, one an angle."""
    cy: tuple[_Number, ...] = ()
    """Of the force to port."""
    cn: tuple[_Number, ...] = ()
    """Of the yaw moment, anticlockwise; it refers to the side area and the length."""
    area_x: _Area
    """Frontal area [m^2]."""
    area_y: _Area
    """Side area [m^2]."""
    length: _Length
    """That of the moment [m]."""
    symmetric: Annotated[bool, Field(strict=True)] = False
    """The table covers 0 to 180 degrees, and the other side is its mirror image."""

    @model_validator(mode="after")
    def _has_one_table(self, info: ValidationInfo) -> Self:
        inline = bool(self.angles or self.cx or self.cy or self.cn)
        if inline == (self.file is not None):
            problem = "both 'file' and 'angles'" if inline else "neither 'file' nor 'angles'"
            reject(problem, "a table of coefficients in one of them")
        if inline:
            counts = {len(self.angles), len(self.cx), len(self.cy), len(self.cn)}
            if len(counts) != 1 or any(b <= a for a, b in pairwise(self.angles)):
                reject(
                    f"{len(self.angles)} angles, {len(self.cx)}, {len(self.cy)} and {len(self.cn)} coefficients",
                    "increasing angles, with one cx, cy and cn each",
                    key="angles",
                )
            if max(map(abs, self.angles)) > 2.0 * math.pi + 1e-9:
                reject(f"{max(self.angles):g} rad", 'a full turn at most; degrees as "30 deg"', key="angles")
        context = CaseContext.of(info)
        if self.file is not None and context is not None:
            try:
                read_columns(context.folder / self.file, COEFFICIENT_COLUMNS)
            except InputError as error:
                where = f"{self.file}: {error.key}: " if error.key else f"{self.file}: "
                reject(where + error.problem, error.expected, key="file")
        return self


class DragElementSection(Section):
    """A piece of a body at its own height."""

    point: LengthVector
    """Its centre, in the coordinates of the geometry [m]."""
    area: _Area | None = None
    """Seen from all sides the same [m^2]."""
    areas: tuple[_Area, _Area, _Area] | None = None
    """In place of `area`, those of a box seen along the heading, across it and from above [m^2]."""
    coefficient: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 1.0
    """Shape coefficient C: the force is ``rho C A |V| V / 2`` along the relative flow."""
    vertical: Annotated[bool, Field(strict=True)] = False
    """Whether the vertical part of the relative velocity counts as well."""
    extent: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """Height of the piece [m]: of one that the water cuts, the part on its own side counts."""

    @model_validator(mode="after")
    def _has_one_area(self) -> Self:
        if (self.area is None) == (self.areas is None):
            problem = "neither 'area' nor 'areas'" if self.area is None else "both 'area' and 'areas'"
            reject(problem, "one of them")
        return self


class DragLoadSection(_FluidLoadSection):
    """Drag on the pieces of a body, each at its own height."""

    CHANNELS: ClassVar = DragElement.CHANNELS

    type: Literal["drag"]
    elements: Annotated[tuple[DragElementSection, ...], Field(min_length=1)]
    """The pieces; their forces are recorded as a sum."""


FluidLoad = Annotated[CoefficientLoadSection | DragLoadSection, Field(discriminator="type")]
