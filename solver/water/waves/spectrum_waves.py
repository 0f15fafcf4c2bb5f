"""Irregular waves of a spectrum in a file."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.waves import WAVES, FromFile, IrregularWaves, WaveFile
from heavylift.solver.water.waves.spectra import tabulated_spectrum

if TYPE_CHECKING:
    from heavylift.solver.water.waves.spectra import WaveSpectrum

__all__ = ["SpectrumWaves"]


@WAVES.describe("spectrum")
@dataclass(frozen=True, eq=False, kw_only=True)
class SpectrumWaves(FromFile, IrregularWaves):
    """Irregular waves of a spectrum in a file."""

    ORDER: ClassVar = 4

    file: Annotated[str, WaveFile((("omega", "density"), ("frequency", "density")), ("places", "values"))]
    """Comma-separated with the header ``omega,density`` [rad/s], [m^2 s/rad], or ``frequency,density`` [Hz],
    [m^2/Hz]."""

    def spectrum(self) -> WaveSpectrum:
        """Its spectrum over the circular frequency."""
        turn = 2.0 * math.pi if self.header[0] == "frequency" else 1.0
        return tabulated_spectrum(turn * self.places, self.values / turn, name=self.file)
