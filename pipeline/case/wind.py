"""What a case file says of wind beside its numbers: the spectrum, of which a record as long as the run is made."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from functools import cache
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from heavylift.pipeline.case.described import Chosen, make_section
from heavylift.pipeline.case.fields import Section, UniqueName, reject
from heavylift.solver.scene.wind_loads import FLUIDS, WIND_SPECTRA

__all__ = ["Current", "Wind"]


class _FluidSection(Section):
    """What winds and currents have."""

    name: Annotated[UniqueName, Field(validate_default=True)] = ""
    """By which loads refer to it, and the first part of its channels."""


class _WindSection(_FluidSection):
    """How wind fluctuates."""

    spectrum: Annotated[Any, Chosen(WIND_SPECTRA)] | None = None
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
