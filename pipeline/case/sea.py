"""The table of a case file that describes the sea."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from typing import Annotated, Any

from pydantic import field_validator, model_validator

from heavylift.pipeline.case.described import Chosen
from heavylift.pipeline.case.fields import Positive, Quantity, Section, reject
from heavylift.pipeline.case.waves import WaveSection, check_wave, one_or_many
from heavylift.pipeline.case.wind import Current, Wind
from heavylift.solver.scene.sea import AT_SEA, Excitation

__all__ = ["STANDARD_GRAVITY", "SeaSection"]

STANDARD_GRAVITY = 9.80665
"""[m/s^2], of water in a case without gravity."""


class SeaSection(Section):
    """Water, and what moves in it and above it."""

    density: Annotated[float, Quantity("density", minimum=500.0, maximum=2000.0)] = 1025.0
    """Of the water [kg/m^3]."""
    gravity: Annotated[float, Quantity("acceleration", minimum=5.0, maximum=20.0)] | None = None
    """[m/s^2]; that of [gravity] if absent."""
    level: Annotated[float, Quantity("length")] = 0.0
    """Height of the still water in the world [m]."""
    depth: Annotated[float, Positive("length")] | None = None
    """[m]; deep water if absent."""
    waves: Annotated[tuple[WaveSection, ...], one_or_many()] = ()
    """A train of waves, or several that go through each other."""
    ramp: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time in which waves, wind and current grow from nothing at the start [s]."""
    excitation: Excitation = "summed"
    """``summed``: every component of the waves at the low-passed place and heading of each hull; ``series``: at the
    place and heading of the start, tabulated once, which is faster."""
    wind: Annotated[tuple[Wind, ...], one_or_many()] = ()
    """Wind; several with names of their own for loads that are far apart."""
    current: Annotated[tuple[Current, ...], one_or_many()] = ()
    """Current."""
    tide: Annotated[Any, Chosen(AT_SEA, word="tide")] | None = None
    """Rise and fall of the still water."""

    @property
    def water_depth(self) -> float:
        """[m]; infinite for deep water."""
        return math.inf if self.depth is None else self.depth

    @field_validator("depth")
    @classmethod
    def _is_a_sea(cls, value: float | None) -> float | None:
        if value is not None and value > 12_000.0:
            reject(f"{value:g} m", "at most 12000 m; no 'depth' for deep water")
        return value

    @model_validator(mode="after")
    def _waves_do_not_break(self) -> "SeaSection":
        gravity = self.gravity or STANDARD_GRAVITY
        for index, waves in enumerate(self.waves):
            key = "waves" if len(self.waves) == 1 else f"waves.{index}"
            check_wave(waves, self.water_depth, gravity, key)
        return self
