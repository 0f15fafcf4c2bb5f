"""The measure of the energy drift, and what becomes of a run by it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.solver.integrate.run_watch import RunWatch
from heavylift.solver.scene.channels import ChannelBook, EnergyOutputs

BOOK = ChannelBook()
BOOK.add("energy", EnergyOutputs.CHANNELS)
CHANNELS, COLUMNS = BOOK.channels, BOOK.width
PLACE = {channel.name.removeprefix("energy."): channel.column for channel in CHANNELS}


def records(**energies: list[float]) -> np.ndarray:
    """Records with some energies [J]; the balance is their sum, and what it is told to be off by."""
    error = np.array(energies.pop("error"))
    rows = np.zeros((len(error), COLUMNS))
    for name, values in energies.items():
        rows[:, PLACE[name]] = values
    sign = {"external_work": -1.0, "drive_work": -1.0}
    rows[:, PLACE["balance"]] = error + sum(
        sign.get(name, 1.0) * np.array(values) for name, values in energies.items()
    )
    return rows


def watched(rows: np.ndarray, **options: float) -> RunWatch:
    watch = RunWatch(CHANNELS, **options)
    for row in rows:
        watch.add(row[None])
    return watch


@pytest.mark.parametrize(
    ("energies", "turned"),
    [
        ({"kinetic": [0.0, 50.0, 0.0], "potential": [100.0, 50.0, 100.0]}, 50.0),
        ({"drive_work": [0.0, 300.0, 600.0], "potential": [0.0, 300.0, 600.0]}, 600.0),
        (
            {"kinetic": [10.0, 5.0, 0.0], "dissipated": [0.0, 30.0, 60.0], "drive_work": [0.0, 25.0, 50.0]},
            60.0,
        ),
        (
            {
                "potential": [0.0, 40.0, 80.0],
                "external_work": [0.0, 30.0, 60.0],
                "elastic": [20.0, 10.0, 0.0],
            },
            20.0,
        ),
    ],
)
def test_the_drift_is_that_of_the_energy_turned_over(energies: dict[str, list[float]], turned: float) -> None:
    """A load that is raised slowly turns over the work of its winch, not its kinetic energy."""
    watch = watched(records(error=[0.0, 0.3, -0.6], **energies))
    assert watch.scale == pytest.approx(turned)
    assert watch.drift == pytest.approx(0.6 / turned)


def test_what_rests_has_no_drift() -> None:
    """Contacts lift 1e4 kg of 10 m by 1e-9 of that: 1e-3 J of energies that are zero."""
    watch = watched(records(error=[0.0, 1e-3], potential=[5e6, 5e6]), size=10.0, weight=1e6, touches=True)
    assert watch.drift < 0.01
    assert not watch.warning
    assert watch.verdict == (Outcome.COMPLETED, "")


@pytest.mark.parametrize(
    ("error", "warns", "outcome"),
    [
        (0.01, False, Outcome.COMPLETED),
        (0.03, True, Outcome.COMPLETED),
        (-0.4, True, Outcome.COMPLETED),
        (0.6, True, Outcome.ENERGY_NOT_KEPT),
        (-0.6, True, Outcome.ENERGY_NOT_KEPT),
        (78.0, True, Outcome.ENERGY_NOT_KEPT),
    ],
)
def test_a_verdict_follows_from_the_drift(error: float, warns: bool, outcome: Outcome) -> None:
    watch = watched(records(error=[0.0, 10.0 * error, 0.0], kinetic=[10.0, 10.0, 10.0]))
    assert watch.drift == pytest.approx(abs(error))
    assert bool(watch.warning) == warns
    assert watch.verdict[0] is outcome
    assert (watch.warning in watch.verdict[1]) or not watch.verdict[1]


def test_energies_that_are_no_numbers_are_an_outcome() -> None:
    rows = records(error=[0.0, 0.0, 0.0], kinetic=[1.0, math.inf, 1.0])
    watch = watched(rows)
    assert math.isnan(watch.drift)
    assert watch.verdict[0] is Outcome.NOT_FINITE
    other = RunWatch(CHANNELS)
    other.state = watch.state
    assert other.verdict == watch.verdict


def test_rows_that_are_no_numbers_are_left_out_whatever_comes_with_them() -> None:
    """Looked at one by one, or all at once."""
    rows = records(error=[0.0, 0.1, 0.2, 0.5], kinetic=[1.0, math.nan, 1.5, 3.0])
    single, asked, together = RunWatch(CHANNELS), RunWatch(CHANNELS), watched(rows)
    for number, row in enumerate(rows):
        single.add(row[None])
        asked.add(row[None])
        assert asked.finite == (number < 1)
        assert single.begun
        single.state  # noqa: B018  a look
    np.testing.assert_array_equal(single.state, together.state)
    np.testing.assert_array_equal(asked.state, together.state)
    assert not together.finite
    assert (together.gain, together.kinetic) == (2.5, 3.0)  # of a balance from 1 to 3.5 J


def test_a_continuation_judges_the_same() -> None:
    rows = records(error=[0.0, 0.1, 0.7], kinetic=[1.0, 0.5, 0.0], potential=[0.0, 0.5, 1.0])
    whole, first, second = watched(rows), watched(rows[:2]), RunWatch(CHANNELS)
    second.state = first.state
    second.add(rows[2:])
    assert second.state == pytest.approx(whole.state)
    assert second.verdict == whole.verdict


def test_a_kept_balance_does_not_save_what_no_body_can_do() -> None:
    """An unstable blade takes all of its energy from its drive: 1 kg with 1e30 J would outrun light."""
    rows = records(kinetic=[0.0, 10.0, 1e30], drive_work=[0.0, 10.0, 1e30], error=[0.0, 0.0, 1e21])
    watch = watched(rows, mass=1.0)
    assert watch.drift < 1e-8
    outcome, message = watch.verdict
    assert outcome is Outcome.ENERGY_NOT_KEPT
    assert "1e+30 J of kinetic energy" in message
    other = RunWatch(CHANNELS, mass=1.0)
    other.state = watch.state
    assert other.verdict == (outcome, message)
    orbit = records(kinetic=[0.0, 0.5 * 3e4**2], drive_work=[0.0, 0.5 * 3e4**2], error=[0.0, 0.0])
    assert watched(orbit, mass=1.0).verdict[0] is Outcome.COMPLETED
