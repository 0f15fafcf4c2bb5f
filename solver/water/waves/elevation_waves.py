"""Waves through an elevation that was measured at one place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive, Quantity
from heavylift.solver.scene.waves import WAVES, FromFile, WaveFile, Waves
from heavylift.solver.water.waves.wave_trains import measured_waves

if TYPE_CHECKING:
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = ["ElevationWaves"]


@WAVES.describe("elevation")
@dataclass(frozen=True, eq=False, kw_only=True)
class ElevationWaves(FromFile, Waves):
    """Waves through an elevation that was measured at one place."""

    ORDER: ClassVar = 5

    file: Annotated[str, WaveFile((("time", "elevation"),), ("places", "values"))]
    """Comma-separated with the header ``time,elevation``: equally spaced [s], and [m]."""
    place: Annotated[tuple[float, float], Quantity("length")] = (0.0, 0.0)
    """World x and y at which it was measured [m]."""
    frequency_range: (
        tuple[
            Annotated[float, Quantity("angular velocity", minimum=0.0, closed=True)],
            Annotated[float, Positive("angular velocity")],
        ]
        | None
    ) = None
    """Components outside [rad/s] are left out; none if absent."""

    def trains(self, depth: float, gravity: float) -> WaveTrains:
        """Components of the record."""
        return measured_waves(
            self.places,
            self.values,
            direction=self.direction,
            place=self.place,
            frequency_range=self.frequency_range,
            depth=depth,
            gravity=gravity,
            name=self.file,
        )
