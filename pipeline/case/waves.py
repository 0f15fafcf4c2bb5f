"""Tables of a case file that describe waves: regular ones, spectra, and measured elevations.

The solver takes components, which are made of them, of random numbers and of files; there is no object that has their
keys, so they are sections of the pipeline.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
    field_validator,
)
from pydantic_core import CoreSchema

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.columns import read_columns
from heavylift.pipeline.case.described import checked
from heavylift.pipeline.case.fields import CaseContext, InFolder, Positive, Quantity, Section, reject
from heavylift.solver.scene.wind_loads import check_heading

__all__ = [
    "ELEVATION_COLUMNS",
    "SPECTRUM_COLUMNS",
    "ElevationWaves",
    "Heading",
    "IrregularWaves",
    "JonswapWaves",
    "PiersonMoskowitzWaves",
    "RegularWaves",
    "SpectrumWaves",
    "SpreadingSection",
    "Waves",
    "check_wave",
    "one_or_many",
]

SPECTRUM_COLUMNS = (("omega", "density"), ("frequency", "density"))
"""Headers of a spectrum: [rad/s] and [m^2 s/rad], or [Hz] and [m^2/Hz]."""
ELEVATION_COLUMNS = (("time", "elevation"),)
"""Header of a record: [s] and [m]."""

_Length = Annotated[float, Positive("length")]
_Time = Annotated[float, Positive("time")]


def _turning(value: float) -> float:
    """An angle within a full turn."""
    checked(check_heading, value)
    return value


Heading = Annotated[float, Quantity("angle"), AfterValidator(_turning)]
"""A direction of propagation [rad]."""


class SpreadingSection(Section):
    """Directions of irregular waves about their mean: cos^2s of half the angle."""

    exponent: Annotated[float, Quantity("number", minimum=0.0, maximum=1000.0)]
    """s; 10 to 20 for wind sea, more for swell."""
    directions: Annotated[int, Field(ge=1, le=1000, strict=True)] = 10
    """Components in each frequency bin, each with a frequency and a direction of its own."""


class _WavesSection(Section):
    """What all waves have."""

    type: str
    """Where they come from."""
    direction: Heading = 0.0
    """Where they go [rad], from world x, anticlockwise seen from above."""


class RegularWaves(_WavesSection):
    """One sinusoidal wave."""

    type: Literal["regular"]
    height: _Length
    """Trough to crest [m], twice the amplitude."""
    period: _Time
    """[s]."""
    phase: Heading = 0.0
    """[rad] in `eta = height/2 cos(k (x cos(direction) + y sin(direction)) - omega t - phase)`: with 0 a crest is at
    the origin of the world at t = 0, with a quarter of a turn it was there a quarter of a period before."""


class IrregularWaves(_WavesSection):
    """What waves of a spectrum have."""

    seed: Annotated[int, Field(ge=0, strict=True)]
    """Of the random numbers; the same seed gives the same waves."""
    count: Annotated[int, Field(ge=10, le=100_000, strict=True)] = 200
    """Frequency bins of equal width."""
    bins: Literal["random", "equal"] = "random"
    """``random``: one random frequency in each bin, no repetition; ``equal``: multiples of the bin width dw, repeated
    after 2 pi / dw."""
    amplitudes: Literal["deterministic", "rayleigh"] = "deterministic"
    """``deterministic``: each component has the energy of its bin; ``rayleigh``: at random about it, as in a Gaussian
    sea."""
    spreading: SpreadingSection | None = None
    """All travel in the mean direction if absent."""
    frequency_range: (
        tuple[Annotated[float, Positive("angular velocity")], Annotated[float, Positive("angular velocity")]]
        | None
    ) = None
    """Of the components [rad/s]; all but the lowest 0.05 % and the highest 0.5 % of the energy if absent."""

    @field_validator("frequency_range")
    @classmethod
    def _increases(cls, value: tuple[float, float] | None) -> tuple[float, float] | None:
        if value is not None and value[1] <= value[0]:
            reject(f"{value[0]:g} to {value[1]:g} rad/s", "the lower frequency first")
        return value


class JonswapWaves(IrregularWaves):
    """Irregular waves of the JONSWAP spectrum."""

    type: Literal["jonswap"]
    significant_height: _Length
    """Hs [m]."""
    peak_period: _Time
    """Tp [s]."""
    gamma: Annotated[float, Quantity("number", minimum=1.0, maximum=10.0, closed=True)] = 3.3
    """Peakedness; 1 is Pierson-Moskowitz."""


class PiersonMoskowitzWaves(IrregularWaves):
    """Irregular waves of the Pierson-Moskowitz spectrum with two parameters (Bretschneider, ISSC)."""

    type: Literal["pierson-moskowitz"]
    significant_height: _Length
    """Hs [m]."""
    peak_period: _Time
    """Tp [s]."""


class SpectrumWaves(IrregularWaves):
    """Irregular waves of a spectrum in a file."""

    type: Literal["spectrum"]
    file: Annotated[str, InFolder()]
    """Comma-separated with the header ``omega,density`` [rad/s], [m^2 s/rad], or ``frequency,density`` [Hz],
    [m^2/Hz]."""

    @field_validator("file")
    @classmethod
    def _can_be_read(cls, value: str, info: ValidationInfo) -> str:
        return _readable(value, info, SPECTRUM_COLUMNS)


class ElevationWaves(_WavesSection):
    """Waves through an elevation that was measured at one place."""

    type: Literal["elevation"]
    file: Annotated[str, InFolder()]
    """Comma-separated with the header ``time,elevation``: equally spaced [s], and [m]."""
    place: tuple[Annotated[float, Quantity("length")], Annotated[float, Quantity("length")]] = (0.0, 0.0)
    """World x and y at which it was measured [m]."""
    frequency_range: (
        tuple[
            Annotated[float, Quantity("angular velocity", minimum=0.0, closed=True)],
            Annotated[float, Positive("angular velocity")],
        ]
        | None
    ) = None
    """Components outside [rad/s] are left out; none if absent."""

    @field_validator("file")
    @classmethod
    def _can_be_read(cls, value: str, info: ValidationInfo) -> str:
        return _readable(value, info, ELEVATION_COLUMNS)


Waves = Annotated[
    RegularWaves | JonswapWaves | PiersonMoskowitzWaves | SpectrumWaves | ElevationWaves,
    Field(discriminator="type"),
]


class one_or_many:  # noqa: N801  an annotation, used like a function
    """Annotation of a list of tables that may be written as a single table."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.no_info_before_validator_function(
            lambda value: [value] if isinstance(value, dict) else value, handler(source)
        )

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        many = handler(schema)
        return {"anyOf": [many["items"], many]} if "items" in many else many


def check_wave(waves: Any, depth: float, gravity: float, key: str) -> None:
    """Refuse heights and periods that no wave has: most often a mix-up of units.

    Parameters
    ----------
    waves
        A table of waves.
    depth, gravity
        [m] (infinite for deep water), [m/s^2].
    key
        Of the table, for the message.
    """
    from heavylift.solver.water.waves.spectra import check_steepness

    regular = isinstance(waves, RegularWaves)
    names = ("height", "period") if regular else ("significant_height", "peak_period")
    if not hasattr(waves, names[0]):
        return
    what = "wave height" if regular else "significant height"
    try:
        check_steepness(
            getattr(waves, names[0]), getattr(waves, names[1]), depth=depth, gravity=gravity, what=what
        )
    except InputError as error:
        guilty = names[1] if error.key == "period" else names[0]
        reject(error.problem, error.expected, key=f"{key}.{guilty}")


def _readable(value: str, info: ValidationInfo, headers: tuple[tuple[str, ...], ...]) -> str:
    """A file that can be read as columns; errors are reported with the key that names it."""
    context = CaseContext.of(info)
    if context is None:
        return value
    try:
        read_columns(context.folder / value, headers)
    except InputError as error:
        where = f"{value}: {error.key}: " if error.key else f"{value}: "
        reject(where + error.problem, error.expected)
    return value
