"""What a user says of waves: each kind is a file of `heavylift.solver.water.waves`, see `WAVES`. SI units, radians.

Directions are of propagation ("going to"), from world x, anticlockwise seen from above.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from annotated_types import Interval

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Positive, Quantity, TableFile
from heavylift.solver.scene.descriptions import Family, no_rows
from heavylift.solver.scene.wind_loads import Heading

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from heavylift.solver.water.waves.spectra import WaveSpectrum
    from heavylift.solver.water.waves.wave_trains import WaveTrains

__all__ = ["WAVES", "FromFile", "IrregularWaves", "Spreading", "WaveFile", "Waves"]

WAVES: Family[Any] = Family("waves", "heavylift.solver.water.waves")
"""Waves, by their types in a case file."""


@WAVES.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Waves(ABC):
    """What all waves have."""

    SIZE: ClassVar[tuple[str, str, str] | None] = None
    """Words for the height, and the keys of height and period, if its table has them."""

    direction: Annotated[float, Heading()] = 0.0
    """Where they go [rad], from world x, anticlockwise seen from above."""

    @abstractmethod
    def trains(self, depth: float, gravity: float) -> WaveTrains:
        """Components of the waves.

        Parameters
        ----------
        depth, gravity
            Of the water [m] (``inf`` for deep water), [m/s^2].
        """

    @classmethod
    def check_water(cls, spec: Any, depth: float, gravity: float) -> None:
        """Refuse heights and periods that no wave of this water has: most often a mix-up of units.

        Raises
        ------
        InputError
            With the key of the one to blame.
        """
        if cls.SIZE is None:
            return
        from heavylift.solver.water.waves.spectra import check_steepness

        what, *keys = cls.SIZE
        height, period = (getattr(spec, key) for key in keys)
        try:
            check_steepness(height, period, depth=depth, gravity=gravity, what=what)
        except InputError as error:
            key = keys[error.key == "period"]
            raise InputError(error.problem, key=key, expected=error.expected) from None

    @classmethod
    def summary(cls, spec: Any) -> tuple[float | None, float | None, list[str]]:
        """For the report: height [m], period [s], and what is worth a word besides."""
        height, period = (None, None) if cls.SIZE is None else (getattr(spec, key) for key in cls.SIZE[1:])
        words = [f"gamma {spec.gamma:g}"] if hasattr(spec, "gamma") else []
        spreading = getattr(spec, "spreading", None)
        if spreading is not None:
            words.append(f"cos^2s, s = {spreading.exponent:g}, {spreading.directions} directions")
        return height, period, [*words, *([spec.file] if hasattr(spec, "file") else [])]


@WAVES.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Spreading:
    """Directions of irregular waves about their mean: cos^2s of half the angle."""

    exponent: Annotated[float, Quantity("number", minimum=0.0, maximum=1000.0)]
    """s; 10 to 20 for wind sea, more for swell."""
    directions: Annotated[int, Interval(ge=1, le=1000)] = 10
    """Components in each frequency bin, each with a frequency and a direction of its own."""


@WAVES.part
@dataclass(frozen=True, eq=False, kw_only=True)
class IrregularWaves(Waves):
    """What waves of a spectrum have."""

    seed: Annotated[int, Interval(ge=0)]
    """Of the random numbers; the same seed gives the same waves."""
    count: Annotated[int, Interval(ge=10, le=100_000)] = 200
    """Frequency bins of equal width."""
    bins: Literal["random", "equal"] = "random"
    """``random``: one random frequency in each bin, no repetition; ``equal``: multiples of the bin width dw, repeated
    after 2 pi / dw."""
    amplitudes: Literal["deterministic", "rayleigh"] = "deterministic"
    """``deterministic``: each component has the energy of its bin; ``rayleigh``: at random about it, as in a Gaussian
    sea."""
    spreading: Spreading | None = None
    """All travel in the mean direction if absent."""
    frequency_range: Annotated[tuple[float, float] | None, Positive("angular velocity")] = None
    """Of the components [rad/s]; all but the lowest 0.05 % and the highest 0.5 % of the energy if absent."""

    @abstractmethod
    def spectrum(self) -> WaveSpectrum:
        """Spectrum of the elevation at a point."""

    @staticmethod
    def check(spec: Any) -> None:
        """The range increases."""
        span = spec.frequency_range
        if span is not None and span[1] <= span[0]:
            raise InputError(
                f"{span[0]:g} to {span[1]:g} rad/s",
                key="frequency_range",
                expected="the lower frequency first",
            )

    def trains(self, depth: float, gravity: float) -> WaveTrains:
        """Components of one realisation of the spectrum."""
        from heavylift.solver.water.waves.wave_trains import irregular_waves

        spreading = self.spreading
        return irregular_waves(
            self.spectrum(),
            seed=self.seed,
            direction=self.direction,
            count=self.count,
            bins=self.bins,
            amplitudes=self.amplitudes,
            spreading=None if spreading is None else spreading.exponent,
            directions=1 if spreading is None else spreading.directions,
            frequency_range=self.frequency_range,
            depth=depth,
            gravity=gravity,
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class FromFile:
    """Content of the file of two columns that a description names by its key ``file``.

    Attributes
    ----------
    header
        Names of the columns.
    places, values
        The columns, shape (n,).
    """

    header: tuple[str, ...] = ()
    places: NDArray[np.float64] = field(default_factory=no_rows)
    values: NDArray[np.float64] = field(default_factory=no_rows)


class WaveFile(TableFile):
    """Annotation of the name of such a file."""

    def arrays(self, name: str, header: Sequence[str], columns: Sequence[Sequence[float]]) -> dict[str, Any]:
        """Fields of the object."""
        return {"file": name, "header": tuple(header), **super().arrays(name, header, columns)}
