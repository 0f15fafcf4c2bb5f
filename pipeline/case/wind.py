"""What a case file says of wind beside its numbers: the spectrum, of which a record as long as the run is made."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from functools import cache
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from heavylift.pipeline.case.described import Chosen, make_section
from heavylift.pipeline.case.fields import Positive, Section, UniqueName, reject
from heavylift.solver.scene.wind_loads import FLUIDS

__all__ = ["Current", "TurbulenceSection", "Wind"]


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


class _FluidSection(Section):
    """What winds and currents have."""

    name: Annotated[UniqueName, Field(validate_default=True)] = ""
    """By which loads refer to it, and the first part of its channels."""


class _WindSection(_FluidSection):
    """How wind fluctuates."""

    spectrum: TurbulenceSection | None = None
    """Fluctuation about the mean; none if absent."""

    @model_validator(mode="after")
    def _fluctuates_once(self) -> Self:
        if self.spectrum is not None and getattr(self, "gust", None) is not None:
            reject(
                "both 'gust' and 'spectrum'", "a constant gust, or a fluctuation about the mean", key="gust"
            )
        return self


@cache
def fluid_section(described: Any) -> type[Section]:
    """Section of a wind or a current, which have a name if none is given."""
    base = _WindSection if described.WORD == "wind" else _FluidSection
    name = (Annotated[UniqueName, Field(validate_default=True)], described.WORD)
    return make_section(described, base, changed={"name": name})


Wind = Annotated[Any, Chosen(FLUIDS, fluid_section, word="wind")]
Current = Annotated[Any, Chosen(FLUIDS, fluid_section, word="current")]
