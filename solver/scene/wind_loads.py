"""Descriptions of wind and current: how the air and the water move, and what they push on. SI units, radians.

A *field* is a fluid that moves, on one side of the still water; *loads* are pieces of bodies in one of the fields.
Directions are of propagation ("going to"), from world x, anticlockwise seen from above. Loads with the same name
share their channels, which hold their sum.

Notes
-----
"Integrated simulation ... ships and offshore structures" (2018), section 2.9.3 and 2.9.4, eqs. (225) to (228). These
take the wind speed instead of the relative one and give no moments about the horizontal axes; here forces depend on
the relative velocity and act at the centre of pressure, so that roll and pitch moments follow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import field
from numbers import Real
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, BodyDirection, Least, NameOf, Quantity, Shape
from heavylift.solver.scene.descriptions import XYZ, ChannelKind, Family, check_table
from heavylift.solver.scene.outputs import Components, Outputs, channel, outputs
from heavylift.solver.water.wind.spectrum import (
    HIGHEST_FREQUENCY,
    HOUR,
    LARGEST_CURRENT,
    LARGEST_WIND,
    LOWEST_FREQUENCY,
    POWER_EXPONENT,
    REFERENCE_HEIGHT,
    check_speed,
    wind_components,
    wind_record,
)

__all__ = [
    "AIR_DENSITY",
    "FLUIDS",
    "FLUID_LOADS",
    "CurrentField",
    "CurrentOutputs",
    "CurrentProfile",
    "DragElement",
    "FluctuationRecord",
    "FluidField",
    "FluidLoad",
    "LoadOutputs",
    "Veering",
    "WindField",
    "WindOutputs",
    "check_heading",
    "fluctuation_record",
    "fluctuation_records",
]

AIR_DENSITY = 1.225
"""[kg/m3]."""
FULL_TURN = 6.2831853072
"""[rad], rounded up."""

GOES = "direction in which wind or current flows, from world x, anticlockwise"

Array = NDArray[np.float64]


def _ahead() -> Array:
    return np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class FluctuationRecord:
    """Fluctuation of a wind speed about its mean, the same at all places.

    Attributes
    ----------
    step
        Between values [s]; the first is at time zero, and the ends hold beyond.
    values
        [m/s], shape (n,).
    seed
        Of the random numbers, None for a measured record.
    """

    step: float
    values: Array
    seed: int | None = None

    @property
    def duration(self) -> float:
        """Time of the last value [s]."""
        return self.step * (len(self.values) - 1)


def fluctuation_record(
    speed: float,
    duration: float,
    *,
    seed: int,
    height: float = REFERENCE_HEIGHT,
    step: float = 0.1,
    count: int = 200,
    lowest: float = LOWEST_FREQUENCY,
    highest: float = HIGHEST_FREQUENCY,
) -> FluctuationRecord:
    """Record of the NPD spectrum of ISO 19901-1 at one height [m]; otherwise as `fluctuation_records`.

    Notes
    -----
    One record for all loads makes forces on a large structure too high rather than too low: by the coherence of the
    standard, 10 m/s at points 20 m apart, sideways or in height, fluctuate with a correlation of 0.3 to 0.4.
    """
    points = np.array([[0.0, 0.0, height]])
    return fluctuation_records(
        speed, duration, points, seed=seed, step=step, count=count, lowest=lowest, highest=highest
    )[0]


def fluctuation_records(
    speed: float,
    duration: float,
    points: Array,
    *,
    seed: int,
    step: float = 0.1,
    count: int = 200,
    lowest: float = LOWEST_FREQUENCY,
    highest: float = HIGHEST_FREQUENCY,
) -> tuple[FluctuationRecord, ...]:
    """Records of the NPD spectrum at several points with the coherence of ISO 19901-1, for a wind field at each.

    Parameters
    ----------
    speed
        One-hour mean at 10 m [m/s].
    duration
        Of the simulation [s].
    points
        Along the wind, across it, height above the water [m]; shape (points, 3).
    seed, count, lowest, highest
        As in `heavylift.solver.water.wind.spectrum.wind_components`.
    step
        Between values [s]. Cubic interpolation of 0.1 s is exact to 1.5e-4 of the standard deviation.

    Raises
    ------
    InputError
        If the step is too long for the highest frequency, or an argument makes no sense.
    """
    if not 0.0 < duration < np.inf:
        raise InputError(
            f"duration {duration:g} s", source="wind", key="duration", expected="a positive time"
        )
    components = wind_components(speed, points, seed=seed, count=count, lowest=lowest, highest=highest)
    longest = 0.2 / highest
    if not 0.0 < step <= longest:
        raise InputError(
            f"step {step:g} s",
            source="wind",
            key="step",
            expected=f"at most {longest:g} s: 5 values a period",
        )
    times = step * np.arange(int(np.ceil(duration / step)) + 3)
    return tuple(
        FluctuationRecord(step, wind_record(components, times, point), seed)
        for point in range(len(components.amplitudes))
    )


FLUIDS: Family[Any] = Family("table", "heavylift.solver.scene", typed=False)
"""Winds and currents, by the keys of a case file in which they stand."""

WIND_SPECTRA: Family[Any] = Family("spectrum", "heavylift.solver.water.wind", default="npd")
"""Spectra of wind, by their types in a case file: each has ``record(speed, duration)``."""


def check_heading(angle: float) -> None:
    """Refuse a direction beyond a full turn: in radians, a larger one is meant as degrees.

    Raises
    ------
    InputError
        If it is.
    """
    if abs(angle) > FULL_TURN:
        degrees = float(np.degrees(angle))
        if abs(degrees - round(degrees, 3)) <= 1e-9 * abs(degrees):  # given in degrees
            raise InputError(
                f"{degrees:.9g} deg is more than a turn",
                expected=f'-360 to 360 deg; the same way is "{degrees % 360.0:.9g} deg"',
            )
        raise InputError(
            f"{angle:g} rad is more than a turn",
            expected=f'-2 pi to 2 pi rad; in degrees "{math.fmod(angle, 360.0):g} deg"',
        )


@dataclass(frozen=True)
class _Heading(Quantity):
    """An angle within a turn."""

    def parse(self, value: object) -> float:
        """SI number of an input value."""
        angle = super().parse(value)
        check_heading(angle)
        return angle


def Heading() -> Quantity:
    """A direction of propagation [rad]: an angle within a turn."""
    return _Heading("angle")


@FLUIDS.part
@dataclass(frozen=True, eq=False)
class Veering:
    """A direction that changes in time, linear between."""

    times: Annotated[Array, Quantity("time"), Shape((None,)), Least(2)]
    """[s], increasing."""
    angles: Annotated[Array, Quantity("angle"), Shape((None,)), Least(2)]
    """Direction of the flow [rad]."""

    @staticmethod
    def check(spec: Any) -> None:
        """An angle a time."""
        check_table("times", spec.times, "angles", spec.angles, shortest=2)


@FLUIDS.part
@dataclass(frozen=True, eq=False)
class CurrentProfile:
    """A current over the depth, linear between, held beyond."""

    depths: Annotated[Array, Quantity("length", minimum=0.0, closed=True), Shape((None,)), Least(2)]
    """Below the still water [m], increasing."""
    speeds: Annotated[Array, Quantity("velocity", minimum=0.0, closed=True), Shape((None,)), Least(2)]
    """[m/s]."""

    @staticmethod
    def check(spec: Any) -> None:
        """A speed a depth."""
        check_table("depths", spec.depths, "speeds", spec.speeds, shortest=2)
        for speed in spec.speeds:
            check_speed(speed, source="", key="speeds", largest=LARGEST_CURRENT)


@dataclass(frozen=True, eq=False, kw_only=True)
class Fluctuating:
    """What is made of a spectrum of `WIND_SPECTRA`, which a case file gives.

    Attributes
    ----------
    fluctuation
        Turbulence that is added to the mean at all heights.
    """

    fluctuation: FluctuationRecord | None = None


@outputs
class WindOutputs(Outputs):
    """What a wind records."""

    speed: float = channel("velocity", "speed of the wind at 10 m above the still water")
    direction: float = channel("angle", GOES)


@FLUIDS.describe("wind")
@dataclass(frozen=True, eq=False, kw_only=True)
class WindField(Fluctuating):
    """Wind above the still water."""

    CHANNELS: ClassVar = WindOutputs.CHANNELS

    name: str = "wind"
    speed: Annotated[float, Quantity("velocity", minimum=0.0, closed=True)]
    """Mean at 10 m above the water [m/s]."""
    averaging_time: Annotated[float, Quantity("time", minimum=0.0)] = HOUR
    """Over which the speed is a mean [s], up to an hour; converted to the one-hour mean by ISO 19901-1."""
    direction: Annotated[float | Veering, Quantity("angle")] = 0.0
    """Direction in which the wind blows [rad], from world x, anticlockwise seen from above; or a table over time."""
    profile: Literal["log", "power", "uniform"] = "log"
    """``log``: ISO 19901-1; ``power``: with an exponent of 0.11; ``uniform``: the same at all heights."""
    exponent: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0), Absent()] = POWER_EXPONENT
    """Of the profile ``power``; 0.11 if absent."""
    gust: Annotated[float | None, Quantity("time", minimum=0.0)] = None
    """Averaging time [s] of a constant gust in place of the one-hour mean."""
    density: Annotated[float, Quantity("density", minimum=0.5, maximum=2.0)] = AIR_DENSITY
    """Of the air [kg/m^3]."""

    @staticmethod
    def check(spec: Any) -> None:
        """A speed and a direction that are no slip of units, times up to an hour, an exponent where it counts."""
        _check_flow(spec, LARGEST_WIND)
        for key in ("averaging_time", "gust"):
            value = getattr(spec, key)
            if value is not None and value > HOUR:
                raise InputError(f"{value:g} s", key=key, expected="a time up to an hour [s]")
        if spec.exponent is not None and spec.profile != "power":
            raise InputError(
                f"'exponent' with profile {spec.profile!r}",
                key="exponent",
                expected="profile 'power', or no 'exponent'",
            )


@outputs
class CurrentOutputs(Outputs):
    """What a current records."""

    speed: float = channel("velocity", "speed of the current at the still water")
    direction: float = channel("angle", GOES)


@FLUIDS.describe("current")
@dataclass(frozen=True, eq=False, kw_only=True)
class CurrentField:
    """Current below the still water."""

    CHANNELS: ClassVar = CurrentOutputs.CHANNELS

    name: str = "current"
    speed: Annotated[float | CurrentProfile, Quantity("velocity", minimum=0.0, closed=True)]
    """The same at all depths [m/s], or a table over the depth."""
    direction: Annotated[float | Veering, Quantity("angle")] = 0.0
    """Direction in which the water flows [rad], from world x, anticlockwise seen from above; or a table over time."""

    @staticmethod
    def check(spec: Any) -> None:
        """A speed and a direction that are no slip of units."""
        _check_flow(spec, LARGEST_CURRENT)


def _check_flow(spec: Any, largest: float) -> None:
    """Speed and direction, as far as they are numbers."""
    if isinstance(spec.speed, Real):
        check_speed(float(spec.speed), source="", key="speed", largest=largest)
    if isinstance(spec.direction, Real):
        try:
            check_heading(float(spec.direction))
        except InputError as error:
            raise InputError(error.problem, key="direction", expected=error.expected) from None


@outputs
class LoadOutputs(Outputs):
    """What is recorded of all loads of a name."""

    force: Components = channel("force", "sum of the forces of the pieces of this name, world axes", XYZ)


@dataclass(frozen=True, eq=False, kw_only=True)
class FluidLoad:
    """What all loads of wind and current have. Each type is a subclass in a file of `heavylift.solver.water.wind`.

    Attributes
    ----------
    name
        Prefix of its channels; loads with the same name share them.
    """

    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = LoadOutputs.CHANNELS

    name: str
    body: Annotated[str, NameOf("body")]
    """Body that is pushed on."""
    fluid: Annotated[str, NameOf("fluid")] = "wind"
    """Name of the wind or current."""
    axis: Annotated[Array, BodyDirection()] = field(default_factory=_ahead)
    """Direction of the body that is its heading, in its coordinates."""

    def pieces(self) -> Sequence[FluidLoad]:
        """What it is for the solver: itself, if it is packed as it stands, or elements."""
        return (self,)


@dataclass(frozen=True, eq=False, kw_only=True)
class DragElement(FluidLoad):
    """Drag on a piece of a body along the relative flow at its own height: ``rho C A |V| V / 2``.

    Attributes
    ----------
    point
        Centre of the piece in the body frame [m], shape (3,): its height is that of the fluid velocity.
    area
        Seen from all sides the same [m2]; or areas (A_x, A_y, A_z) of a box seen along the heading, across it and
        from above, whose projection along the relative flow counts.
    coefficient
        Shape coefficient C.
    vertical
        Whether the vertical part of the relative velocity counts as well.
    extent
        Height of the piece [m]: of one that the water level cuts, only the part on its own side counts, with the
        speed at the middle of that part. With 0 it counts whole or not at all.
    """

    point: Array
    area: float | tuple[float, float, float]
    coefficient: float = 1.0
    vertical: bool = False
    extent: float = 0.0


FLUID_LOADS: Family[FluidLoad] = Family("load", "heavylift.solver.water.wind")
"""All loads of wind and current, by their types in a case file."""

FluidField = WindField | CurrentField
