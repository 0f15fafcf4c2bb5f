"""CPU time of wave excitation: sums over components, interpolated series, and their preparation.

Run with ``python benchmarks/excitation.py``. Times are medians on one thread; the coefficients are closed forms, which
cost what those of a panel code do.
"""

from __future__ import annotations

import statistics
import time
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.jit import kernel
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.solver.water.waves.excitation import interpolate_series, sum_excitation
from heavylift.solver.water.waves.excitation_packing import pack_series, pack_summed
from heavylift.solver.water.waves.spectra import jonswap
from heavylift.solver.water.waves.wave_trains import irregular_waves

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from heavylift.solver.water.waves.wave_trains import WaveTrains

CALLS = 5000
REPEATS = 15


@kernel
def sums(excitation, place, out, count):  # type: ignore[no-untyped-def]
    """Hulls that turn a little in every call, so that nothing can be kept."""
    for n in range(count):
        for hull in range(place.shape[0]):
            place[hull, 2] = 0.1 + 1e-5 * n
        sum_excitation(excitation, 0.05 * n, place, out)


@kernel
def interpolations(excitation, out, count):  # type: ignore[no-untyped-def]
    for n in range(count):
        interpolate_series(excitation, 0.05 * n, out)


def database(hulls: int) -> HydrodynamicDatabase:
    omega = np.linspace(0.1, 3.2, 60)
    headings = np.deg2rad(np.arange(0.0, 360.0, 10.0))
    n = 6 * hulls
    w, beta = np.meshgrid(omega, headings, indexing="ij")
    force = np.stack(
        [1e6 * np.exp(-(w**2)) * np.cos(beta - 0.3 * j) * np.exp(0.2j * w * j) for j in range(n)], -1
    )
    return HydrodynamicDatabase(
        bodies=tuple(f"hull {i}" for i in range(hulls)),
        omega=omega,
        headings=headings,
        added_mass=np.tile(1e6 * np.eye(n), (60, 1, 1)),
        damping=np.tile(1e5 * np.eye(n), (60, 1, 1)),
        added_mass_infinite=1e6 * np.eye(n),
        excitation=force,
        reference_points=np.array([[80.0 * i, 0.0, 0.0] for i in range(hulls)]),
        density=1025.0,
        gravity=9.81,
        depth=np.inf,
        source="closed form",
        drift=np.abs(force) * 1e-2,
    )


def median_seconds(run: Callable[..., object], *arguments: object, repeats: int = REPEATS) -> float:
    run(*arguments)
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        run(*arguments)
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def hour(trains: WaveTrains, coefficients: HydrodynamicDatabase, place: NDArray[np.float64]) -> object:
    return pack_series(trains, coefficients, places=place, duration=3600.0)


def main() -> None:
    spectrum = jonswap(1.65, 6.12)
    limits = (0.6, 3.2)
    long_crested = irregular_waves(spectrum, seed=1, frequency_range=limits)
    short_crested = irregular_waves(spectrum, seed=1, frequency_range=limits, spreading=8.0)
    for hulls in (1, 2):
        coefficients = database(hulls)
        place, out = np.zeros((hulls, 3)), np.zeros(6 * hulls)
        for words, trains, drift in (
            ("one direction", long_crested, False),
            ("spread", short_crested, False),
            ("spread, with drift", short_crested, True),
        ):
            packed = pack_summed(trains, coefficients, yaws=np.zeros(hulls), with_drift=drift)
            seconds = median_seconds(sums, packed, place, out, CALLS) / CALLS
            print(f"sum of 200 components, {6 * hulls:2d} coordinates, {words:20s} {1e6 * seconds:9.3f} us")
        series = pack_series(long_crested, coefficients, places=place, duration=3600.0)
        seconds = median_seconds(interpolations, series, out, 70_000) / 70_000
        print(
            f"interpolated series,   {6 * hulls:2d} coordinates                      {1e6 * seconds:9.3f} us"
        )
        seconds = median_seconds(hour, long_crested, coefficients, place, repeats=5)
        step = 1.0 / series.rate
        print(
            f"series of one hour,    {6 * hulls:2d} coordinates, every {step:.3g} s          {seconds:9.3f} s"
        )


if __name__ == "__main__":
    main()
