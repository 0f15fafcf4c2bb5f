"""Irregular waves of the JONSWAP spectrum; its formula is in `spectra`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive, Quantity
from heavylift.solver.scene.waves import WAVES, IrregularWaves
from heavylift.solver.water.waves.spectra import jonswap

if TYPE_CHECKING:
    from heavylift.solver.water.waves.spectra import WaveSpectrum

__all__ = ["JonswapWaves"]


@WAVES.describe("jonswap")
@dataclass(frozen=True, eq=False, kw_only=True)
class JonswapWaves(IrregularWaves):
    """Irregular waves of the JONSWAP spectrum."""

    ORDER: ClassVar = 2
    SIZE: ClassVar = ("significant height", "significant_height", "peak_period")

    significant_height: Annotated[float, Positive("length")]
    """Hs [m]."""
    peak_period: Annotated[float, Positive("time")]
    """Tp [s]."""
    gamma: Annotated[float, Quantity("number", minimum=1.0, maximum=10.0, closed=True)] = 3.3
    """Peakedness; 1 is Pierson-Moskowitz."""

    def spectrum(self) -> WaveSpectrum:
        """Its spectrum."""
        return jonswap(self.significant_height, self.peak_period, self.gamma)
