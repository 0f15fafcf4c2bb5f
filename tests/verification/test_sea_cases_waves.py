"""Cases of hulls in waves against the frequency domain and against spectra; ensembles where one record says little."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.commands.statistics import simulate_seeds
from heavylift.pipeline.commands.verify import verify_case
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.stages.stages import load_changed_case, run_case

if TYPE_CHECKING:
    from types import ModuleType

    from numpy.typing import NDArray

    from heavylift.pipeline.results.histories import Results

CASES = Path(__file__).resolve().parents[2] / "cases"
BARGE, SEA = CASES / "transport_barge", CASES / "irregular_sea"
WINDOW, TURNS = 700.0, {"head": 0.0, "quartering": 45.0, "direct": 45.0, "beam": 90.0}
SEEDS, RAMP = 20, 60.0
STATES = {"6.1 m": (), "1.65 m": ("sea.waves.significant_height=1.65", "sea.waves.peak_period=6.12")}
pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]


def reference_of(case: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"{case.name}_reference", case / "make_reference.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def simulated(case: Path, out: Path, *overrides: str) -> Results:
    changed = load_changed_case(case, overrides)
    assert run_case(changed, out=out, log=Log(quiet=True)).outcome is Outcome.COMPLETED
    return load_results(changed, out)


@pytest.mark.parametrize(
    ("case", "count"), [(BARGE, 24), (SEA, 4)], ids=lambda value: getattr(value, "name", None)
)
def test_case_meets_its_references(case: Path, count: int, tmp_path: Path) -> None:
    result = verify_case(case, out=tmp_path, overrides=(), force=True, log=Log(quiet=True))
    assert result.outcome is Outcome.COMPLETED, (
        result.message,
        [check for check in result.checks if not check.passed],
    )
    assert len(result.checks) == count


# ---- regular waves ----


def fitted_operators(results: Results, reference: ModuleType) -> dict[str, NDArray[np.complex128]]:
    """Complex amplitudes per metre of wave, shape (nw, 6), by least squares over one period of all waves."""
    omega, amplitude, phase = reference.waves()
    chosen = results.time >= WINDOW - 1e-6
    parts = amplitude * np.exp(-1j * (np.outer(results.time[chosen], omega) + phase))
    basis = np.hstack([parts.real, -parts.imag, np.ones((len(parts), 1))])
    found = {}
    for name, heading in TURNS.items():
        yaw = -np.deg2rad(heading)
        place, q = results[f"{name}.position"][chosen], results[f"{name}.orientation"][chosen]
        ahead = place[:, 0] * np.cos(yaw) + place[:, 1] * np.sin(yaw)
        aside = -place[:, 0] * np.sin(yaw) + place[:, 1] * np.cos(yaw)
        # conjugate of the turn at rest, times the orientation; small rotations are twice the vector part
        c, s = np.cos(0.5 * yaw), np.sin(0.5 * yaw)
        turns = 2.0 * np.column_stack(
            [c * q[:, 1] + s * q[:, 2], c * q[:, 2] - s * q[:, 1], c * q[:, 3] - s * q[:, 0]]
        )
        motion = np.column_stack([ahead - ahead.mean(), aside - aside.mean(), place[:, 2], turns])
        fit = np.linalg.lstsq(basis, motion, rcond=None)[0]
        found[name] = fit[: len(omega)] + 1j * fit[len(omega) : 2 * len(omega)]
    return found


def largest_errors(results: Results, reference: ModuleType) -> dict[str, tuple[float, float]]:
    """By barge: complex error over the largest operator of its coordinate, and over the operator itself above 20 %."""
    omega = reference.waves()[0]
    found = {}
    for name, measured in fitted_operators(results, reference).items():
        expected = reference.operators(omega, TURNS[name])
        largest = np.abs(expected).max(axis=0)
        moves = largest > 1e-6
        error = np.abs(measured - expected)[:, moves]
        size, largest = np.abs(expected)[:, moves], largest[moves]
        found[name] = (
            float((error / largest).max()),
            float((error / size)[size > 0.2 * largest].max()),
        )
    return found


@pytest.fixture(scope="module")
def steps(tmp_path_factory: pytest.TempPathFactory) -> dict[float, Results]:
    folder = tmp_path_factory.mktemp("transport_barge")
    return {
        step: simulated(BARGE, folder / f"{step:g}", f"simulate.step={step}")
        for step in (0.025, 0.05, 0.1, 0.2)
    }


def test_motions_in_regular_waves_are_those_of_the_frequency_domain_in_amplitude_and_phase(steps) -> None:
    for name, (of_largest, of_itself) in largest_errors(steps[0.05], reference_of(BARGE)).items():
        assert of_largest < 0.01, name
        assert of_itself < 0.01, name


def test_recursive_memory_moves_as_direct_convolution_does(steps) -> None:
    results = steps[0.05]
    found = fitted_operators(results, reference_of(BARGE))
    difference = np.abs(found["quartering"] - found["direct"]).max(axis=0)
    assert np.all(difference < 0.002 * np.abs(found["direct"]).max(axis=0))
    c = np.sqrt(0.5)  # along the axes of the barges: along y surge and sway nearly cancel
    turn = np.array([[c, c, 0.0], [-c, c, 0.0], [0.0, 0.0, 1.0]])
    for channel, axes in (("velocity", turn), ("angular_velocity", np.eye(3))):  # transients included
        recursive, direct = (results[f"{name}.{channel}"] @ axes for name in ("quartering", "direct"))
        rms = np.sqrt(np.mean((recursive - direct) ** 2, axis=0))
        assert np.all(rms < 0.002 * np.sqrt(np.mean(direct**2, axis=0)))


def test_the_error_of_the_step_is_of_second_order(steps) -> None:
    reference = reference_of(BARGE)
    found = {step: fitted_operators(results, reference) for step, results in steps.items()}
    for name in TURNS:
        coarse, middle, fine = (
            np.abs(found[a][name] - found[b][name]).max() for a, b in ((0.2, 0.1), (0.1, 0.05), (0.05, 0.025))
        )
        assert 3.5 < coarse / middle < 4.5, name
        assert 3.5 < middle / fine < 4.5, name


# ---- irregular waves and wind ----


def band_variances(time, values, bands) -> NDArray[np.float64]:
    """Variance of a record within bands [rad/s], by its periodogram under a Hann window; the first is that of all."""
    x = values - values.mean()
    window = np.hanning(len(x))
    power = np.abs(np.fft.rfft(window * x)) ** 2 * 2.0 / (len(x) * np.sum(window**2))
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(x), time[1] - time[0])
    parts = [power[(omega >= low) & (omega < high)].sum() for low, high in bands]
    return np.array([np.mean(x**2), *parts])


def expected_bands(state: str, quantity: str) -> tuple[list[tuple[float, float]], NDArray[np.float64]]:
    number = {"6.1 m": 1, "1.65 m": 3, "wind": 5}[state] + (quantity == "heave")
    rows = np.loadtxt(SEA / "bands.csv", delimiter=",", skiprows=1)
    rows = rows[rows[:, 0] == number]
    return [(low, high) for low, high in rows[1:, 1:3]], rows[:, 3]


def ensemble(out: Path, *overrides: str) -> list[Results]:
    case = load_changed_case(SEA, overrides)
    runs = simulate_seeds(case, out, SEA, overrides, SEEDS, load_results, Log(quiet=True))
    return [run.found for run in runs if run.found is not None]


@pytest.fixture(scope="module")
def ensembles(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Results]]:
    return {state: ensemble(tmp_path_factory.mktemp("sea"), *keys) for state, keys in STATES.items()}


def table(runs: list[Results], state: str, quantity: str) -> NDArray[np.float64]:
    """Rows of expected variance, mean over the runs, and standard error of that mean; whole, then band by band."""
    bands, expected = expected_bands(state, quantity)
    found = []
    for run in runs:
        chosen = run.time >= RAMP - 1e-6
        values = {
            "elevation": lambda run: run["barge.wave_elevation"],
            "heave": lambda run: run["barge.position"][:, 2],
            "speed": lambda run: run["wind.speed"],
        }[quantity](run)
        found.append(band_variances(run.time[chosen], values[chosen], bands))
    error = np.std(found, axis=0, ddof=1) / np.sqrt(len(found))
    return np.column_stack([expected, np.mean(found, axis=0), error])


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("quantity", ["elevation", "heave"])
def test_variance_over_twenty_seas_is_that_of_the_spectrum(ensembles, state: str, quantity: str) -> None:
    rows = table(ensembles[state], state, quantity)
    rows = rows[rows[:, 0] > 0.01 * rows[0, 0]]  # what leaks from the peak would drown the rest
    assert len(rows) >= 4
    assert np.all(np.abs(rows[:, 1] - rows[:, 0]) < 3.0 * rows[:, 2])
    assert np.all(rows[:, 2] < 0.1 * rows[:, 0])  # so that three errors mean something


@pytest.mark.parametrize("state", STATES)
def test_with_equal_energy_in_every_sea_the_variances_are_within_two_percent(
    state: str, tmp_path: Path
) -> None:
    runs = ensemble(tmp_path, *STATES[state], "sea.waves.amplitudes=deterministic", "sea.waves.count=200")
    for quantity in ("elevation", "heave"):
        expected, found, error = table(runs, state, quantity)[0]
        assert error < 0.005 * expected
        assert abs(found - expected) < 0.02 * expected


def test_variance_over_twenty_winds_is_that_of_the_spectrum(ensembles) -> None:
    rows = table(ensembles["6.1 m"], "wind", "speed")
    assert np.all(np.abs(rows[:, 1] - rows[:, 0]) < 3.0 * rows[:, 2])
    assert np.all(rows[:, 2] < 0.1 * rows[:, 0])


def test_the_same_seed_gives_the_same_bits(ensembles, tmp_path: Path) -> None:
    again = simulated(SEA, tmp_path, "sea.waves.seed=3", "sea.wind.spectrum.seed=1003")
    assert np.array_equal(again["barge.position"], ensembles["6.1 m"][2]["barge.position"])
    assert not np.array_equal(again["barge.position"], ensembles["6.1 m"][1]["barge.position"])
