"""Regular waves: one sinusoidal component, ``eta = H/2 cos(k . x - omega t - eps)``, ``omega^2 = g k tanh(k h)``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.solver.scene.waves import WAVES, Waves
from heavylift.solver.scene.wind_loads import Heading
from heavylift.solver.water.waves.wave_trains import regular_wave

if TYPE_CHECKING:
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = ["RegularWaves"]


@WAVES.describe("regular")
@dataclass(frozen=True, eq=False, kw_only=True)
class RegularWaves(Waves):
    """One sinusoidal wave."""

    ORDER: ClassVar = 1
    SIZE: ClassVar = ("wave height", "height", "period")

    height: Annotated[float, Positive("length")]
    """Trough to crest [m], twice the amplitude."""
    period: Annotated[float, Positive("time")]
    """[s]."""
    phase: Annotated[float, Heading()] = 0.0
    """[rad] in `eta = height/2 cos(k (x cos(direction) + y sin(direction)) - omega t - phase)`: with 0 a crest is at
    the origin of the world at t = 0, with a quarter of a turn it was there a quarter of a period before."""

    def trains(self, depth: float, gravity: float) -> WaveTrains:
        """The one component."""
        return regular_wave(
            self.height, self.period, self.direction, phase=self.phase, depth=depth, gravity=gravity
        )
