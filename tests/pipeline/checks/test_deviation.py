"""The deviation from a reference history: largest distance, or mean square, over the components that the file has."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.checks.deviation import deviation_history
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.results.histories import ChannelInfo, Results

TIMES = 0.01 * np.arange(101)
CIRCLE = np.column_stack([np.cos(TIMES), np.sin(TIMES), 2.0 * TIMES])


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "linkage"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "linkage.toml", folder / "case.toml")
    return folder


def write(folder, columns, every=10):
    names = "time," + ",".join(columns)
    rows = np.column_stack([TIMES, *columns.values()])[::every]
    lines = ["# made for tests", names, *(",".join(map(repr, row.tolist())) for row in rows)]
    (folder / "history.csv").write_text("\n".join(lines) + "\n")


def results_of(channels):
    infos, columns, column = {}, {}, 0
    for name, values in channels.items():
        parts = ("x", "y", "z") if values.ndim == 2 else (name.partition(".")[2],)
        infos[name] = ChannelInfo(name, "m", parts, column)
        columns[name] = values.reshape(len(values), -1)
        column += len(parts)
    return Results(Path("results.h5"), TIMES[: len(next(iter(columns.values())))], infos, columns, {})


def evaluate(folder, results, *overrides, channel="hook.position", quantity="deviation.hook"):
    reference = f'reference=[{{name="hook", channel="{channel}", file="history.csv"}}]'
    case = load_case(folder, [reference, *overrides])
    quantities = Quantities(case, folder / "out")
    quantities.__dict__["results"] = results
    return case, quantities.number(quantity)


def test_a_history_shifted_in_space_is_off_by_the_shift(folder):
    off = CIRCLE + np.array([3e-3, 0, -4e-3])
    write(folder, {"x": off[:, 0], "y": off[:, 1], "z": off[:, 2]})
    results = results_of({"hook.position": CIRCLE})
    case, value = evaluate(folder, results)
    assert value == pytest.approx(5e-3, rel=1e-12)
    assert case.quantity("deviation.hook").kind.unit == "m"
    case, value = evaluate(folder, results, 'reference.0.scale="10 mm"')
    assert value == pytest.approx(0.5, rel=1e-12)
    assert case.quantity("deviation.hook").kind.unit == "1"


def test_components_that_the_file_has_not_are_not_compared(folder):
    write(folder, {"y": CIRCLE[:, 1], "x": CIRCLE[:, 0] + 1e-3})
    assert evaluate(folder, results_of({"hook.position": CIRCLE}))[1] == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.parametrize("column", ["angle", "value"])
def test_a_channel_of_numbers(folder, column):
    write(folder, {column: TIMES**2})
    _, value = evaluate(folder, results_of({"foot.angle": TIMES**2 + 1e-4 * TIMES}), channel="foot.angle")
    assert value == pytest.approx(1e-4, rel=1e-9)


def test_the_instant_of_the_largest_deviation(folder):
    bump = CIRCLE.copy()
    bump[40, 1] += 1e-2
    write(folder, {"y": CIRCLE[:, 1]})
    case, _ = evaluate(folder, results_of({"hook.position": CIRCLE}))
    times, distances = deviation_history(case, case.reference[0], results_of({"hook.position": bump}))
    assert times[np.argmax(distances)] == pytest.approx(0.4)
    assert len(times) == 11


def test_root_mean_square_over_the_times_of_the_file(folder):
    bump = CIRCLE.copy()
    bump[40, 1] += 1e-2
    bump[60, 2] -= 2e-2
    write(folder, {"x": CIRCLE[:, 0], "y": CIRCLE[:, 1], "z": CIRCLE[:, 2]})  # 11 of 101 times
    case, value = evaluate(folder, results_of({"hook.position": bump}), quantity="deviation.hook.rms")
    assert value == pytest.approx(np.sqrt((1e-4 + 4e-4) / 11), rel=1e-12)
    assert case.quantity("deviation.hook.rms").kind.unit == "m"
    with pytest.raises(InputError, match=r"deviation\.NAME or deviation\.NAME\.rms"):
        case.quantity("deviation.hook.mean")


def test_a_history_of_a_part_of_the_run(folder):
    """What happens before and after its times does not count."""
    bump = CIRCLE.copy()
    bump[[20, 40, 80], 1] += [4e-2, 1e-2, 3e-2]
    write(folder, {"y": CIRCLE[:, 1]})
    path = folder / "history.csv"
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:2], *lines[5:9]]) + "\n")  # 0.3 s to 0.6 s
    results = results_of({"hook.position": bump})
    _, value = evaluate(folder, results, 'reference.0.until="600 ms"')
    assert value == pytest.approx(1e-2, rel=1e-9)


def test_changes_alone(folder):
    off = CIRCLE + np.array([3e-3, 0, -4e-3])
    write(folder, {"x": off[:, 0], "y": off[:, 1], "z": off[:, 2]})
    drifting = CIRCLE + 1e-3 * TIMES[:, None]
    _, value = evaluate(folder, results_of({"hook.position": drifting}), "reference.0.changes=true")
    assert value == pytest.approx(np.sqrt(3.0) * 1e-3, rel=1e-9)


def test_length_and_rate_of_a_vector(folder):
    write(folder, {"y": CIRCLE[:, 1]})
    path = np.column_stack([3.0 * TIMES, np.zeros_like(TIMES), 4.0 * TIMES**2])
    results = results_of({"hook.position": path})
    case, value = evaluate(folder, results, quantity="channel.hook.position.norm.rate")
    assert value == pytest.approx(5.0, rel=1e-12)
    assert case.quantity("channel.hook.position.norm.rate").kind.unit == "m/s"
    assert case.quantity("channel.hook.velocity.x.rate").kind.unit == "m/s^2"
    assert evaluate(folder, results, quantity="channel.hook.position.norm.max")[1] == pytest.approx(5.0)
    with pytest.raises(InputError, match=r"'energy\.balance' has no 'rate'"):
        case.quantity("channel.energy.balance.rate")


def test_a_run_that_ended_early_has_no_deviation(folder):
    write(folder, {"y": CIRCLE[:, 1]})
    with pytest.raises(InputError, match=r"t = 0\.6 s is not recorded; the records end at 0\.5 s"):
        evaluate(folder, results_of({"hook.position": CIRCLE[:51]}))
