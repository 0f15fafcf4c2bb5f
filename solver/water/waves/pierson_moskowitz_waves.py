"""Irregular waves of the Pierson-Moskowitz spectrum; its formula is in `spectra`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.solver.scene.waves import WAVES, IrregularWaves
from heavylift.solver.water.waves.spectra import pierson_moskowitz

if TYPE_CHECKING:
    from heavylift.solver.water.waves.spectra import WaveSpectrum

__all__ = ["PiersonMoskowitzWaves"]


@WAVES.describe("pierson-moskowitz")
@dataclass(frozen=True, eq=False, kw_only=True)
class PiersonMoskowitzWaves(IrregularWaves):
    """Irregular waves of the Pierson-Moskowitz spectrum with two parameters (Bretschneider, ISSC)."""

    ORDER: ClassVar = 3
    SIZE: ClassVar = ("significant height", "significant_height", "peak_period")

    significant_height: Annotated[float, Positive("length")]
    """Hs [m]."""
    peak_period: Annotated[float, Positive("time")]
    """Tp [s]."""

    def spectrum(self) -> WaveSpectrum:
        """Its spectrum."""
        return pierson_moskowitz(self.significant_height, self.peak_period)
