"""Turbulence of the NPD spectrum of ISO 19901-1; its formulae are in `spectrum`."""

from __future__ import annotations

from typing import Annotated

from annotated_types import Interval

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.solver.scene.wind_loads import WIND_SPECTRA, FluctuationRecord, fluctuation_record

__all__ = ["NpdTurbulence"]


@WIND_SPECTRA.describe("npd")
@dataclass(frozen=True, eq=False, kw_only=True)
class NpdTurbulence:
    """Fluctuation of the wind by the NPD spectrum of ISO 19901-1."""

    seed: Annotated[int, Interval(ge=0)]
    """Of the random numbers; the same seed gives the same wind."""
    count: Annotated[int, Interval(ge=10, le=100_000)] = 200
    """Components, equal in the logarithm of the frequency."""
    height: Annotated[float, Positive("length")] = 10.0
    """Above the water whose spectrum it is [m]: that of the loads."""
    step: Annotated[float, Positive("time")] = 0.1
    """Between the values of the record [s], which is as long as the simulation."""

    def record(self, speed: float, duration: float) -> FluctuationRecord:
        """Fluctuation over a simulation.

        Parameters
        ----------
        speed
            One-hour mean at 10 m [m/s].
        duration
            [s].
        """
        return fluctuation_record(
            speed, duration, seed=self.seed, height=self.height, step=self.step, count=self.count
        )
