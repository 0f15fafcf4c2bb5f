"""Bad scenarios: one clear error each before anything runs, and runs that do not come to their end."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.report.operation import operation_section


@pytest.fixture
def phases(tmp_path):
    folder = tmp_path / "phases"
    folder.mkdir()
    shutil.copyfile(Path(__file__).parents[1] / "pipeline" / "phases.toml", folder / "case.toml")
    return folder


UNTIL, DONE = "scenario.phases.0.until", "scenario.phases.0.actions.0"


@pytest.mark.parametrize(
    ("override", "key", "problem", "expected"),
    [
        (f'{UNTIL}.quantity="lod.position.z"', f"{UNTIL}.quantity", "names 'lod', which does not exist", "load"),
        (f'{UNTIL}.quantity="load.positon.z"', f"{UNTIL}.quantity", "did you mean 'position'", "position"),
        (f'{UNTIL}.quantity="load.position"', f"{UNTIL}.quantity", "has 3 components", "x, y, z; or largest"),
        (f'{UNTIL}.quantity="load"', f"{UNTIL}.quantity", "'load' is unknown", "load.position.z"),
        (f'{UNTIL}.quantity="*.tension"', f"{UNTIL}.quantity", "stands for several channels", "sum"),
        (f'{UNTIL}.quantity="ratio(fall.tension, stay.tension)"', f"{UNTIL}.quantity", "is a ratio", "sums"),
        (f'{UNTIL}.above="9 kN"', f"{UNTIL}.above", "kN", "length"),
        (f'{UNTIL}.below="1 m"', UNTIL, "both 'above' and 'below'", "one of them"),
        (f"{UNTIL}.above=", UNTIL, "neither 'above' nor 'below'", "one of them"),
        (f'{UNTIL}.time="1 s"', f"{UNTIL}.time", "beside another condition", "'all' or 'any'"),
        (f"{UNTIL}={{}}", UNTIL, "neither 'quantity' nor 'time'", "one of them"),
        ('scenario.phases.0={name="hoist"}', "scenario.phases.0", "can never end", "'until'"),
        ('scenario.phases.2.name="hold"', "scenario.phases.2.name", "'hold' is the name of two phases", "own"),
        (f'{DONE}.winch="fal"', f"{DONE}.winch", "did you mean 'fall'", "one of: fall"),
        (f'{DONE}.winch="stay"', f"{DONE}.winch", "of type 'spring'", "'wire'"),
        (f"{DONE}.speed=", f"{DONE}.speed", "a winch without 'speed'", "'length'"),
        (f'{DONE}.release="fall"', DONE, "'winch' and 'release' in one action", "one of 'winch'"),
        (f'{DONE}={{release="fall", slack="1 m"}}', f"{DONE}.slack", "'slack' of 'release'", "no other key"),
        (f'{DONE}={{winch="fall", speed="-1 m/s", length="9 m"}}', f"{DONE}.speed", "-1 m/s with a length", "positive"),
        (f'{DONE}={{winch="fall", speed="1 m/s", length="0 m"}}', f"{DONE}.length", "0", "> 0"),
        (f'{DONE}={{connect="fall"}}', f"{DONE}.connect", "'fall' is connected then", "'prepared'"),
        ('scenario.prepared=["fall"]', "scenario.phases.2.actions.0.release", "is not connected then", "that is"),
        ('simulate.integrator="thesis"', "simulate.integrator", "'thesis' with a scenario", "'dele2'"),
        ('sensors=[{name="scenario", body="load", point=[0, 0, 0]}]', "sensors.0.name", "the whole scene", "another"),
        ("scenario.phases=[]", "scenario.phases", "", "at least 1"),
    ],
)  # fmt: skip
def test_refused_with_key_and_remedy(phases, override, key, problem, expected):
    with pytest.raises(InputError) as caught:
        load_case(phases, (override,))
    first = str(caught.value).splitlines()[0]
    assert f": {key}: " in first
    assert problem in first
    assert expected in first.partition("expected")[2]


def test_over_before_it_begins(phases):
    with pytest.raises(InputError, match=r"'hoist' is over before it begins: load\.position\.z above -11"):
        run_case(load_case(phases, (f'{UNTIL}.above="-11 m"',)), stages=("simulate",))


def test_an_operation_that_comes_to_its_end(phases, heavylift):
    """The log is with the results, the run ends with its last phase, and the command plans what the run did."""
    done = heavylift("simulate", phases)
    assert done.code == 0
    results = load_results(phases)
    spec = results.metadata["scenario"]
    assert spec["phases"] == ["hoist", "hold", "drop"]
    ends = {name: time for time, name, event, *_ in spec["log"] if event == "done"}
    assert ends["drop"] == pytest.approx(ends["hold"] + 0.5, abs=1e-9)
    assert results.time[-1] == pytest.approx(np.ceil(ends["drop"] * 10.0) / 10.0)
    assert results["scenario.phase"][-1] == 4
    assert "drop: action: release of 'fall'" in done.error + done.out
    (section,) = operation_section(results)
    (table,) = section.items
    assert [row[1] for row in table.rows] == spec["phases"]
    assert float(table.rows[2][2]) == pytest.approx(ends["hold"], abs=0.005)
    planned = json.loads(heavylift("scenario", phases, "--json").out)
    assert [phase["name"] for phase in planned["phases"]] == spec["phases"]
    hold = planned["phases"][1]
    assert hold["takes_s"][0] == 1.0
    low, high = planned["phases"][0]["end"]["fall"]
    assert low <= float(results["fall.rest_length"][results.time < ends["hoist"]][-1]) <= high


@pytest.mark.parametrize(
    ("overrides", "outcome", "words"),
    [
        (('scenario.phases.0.limits.0.below="100 kN"',), Outcome.LIMIT_REACHED, "phase 'hoist': sum(*.tension) below"),
        (('scenario.phases.0.timeout.after="0.5 s"',), Outcome.TIMED_OUT, "phase 'hoist' after 0.5"),
        (('simulate.duration="2 s"',), Outcome.PHASES_LEFT, "phase 'hold', number 2 of 3, still waits for"),
    ],
)  # fmt: skip
def test_an_operation_that_does_not(phases, heavylift, overrides, outcome, words):
    """An exit code of its own, results and a report up to there, and the same again when it is asked again."""
    options = [token for one in overrides for token in ("--set", one)]
    first = heavylift("simulate", phases, *options)
    assert first.code == outcome
    assert words in first.error + first.out
    results = load_results(phases)
    assert len(results.time) >= 2
    assert results.metadata["outcome"] == outcome.name.lower()
    again = heavylift("simulate", phases, *options)
    assert again.code == outcome
    assert "unchanged" in again.error + again.out


def test_an_interrupted_operation_goes_on(phases, monkeypatch):
    """Pieces of a few steps, each with a checkpoint, make the same results."""
    from heavylift.pipeline.stages import advance

    run_case(load_case(phases), stages=("simulate",))
    whole = load_results(phases)
    monkeypatch.setattr(advance, "FIRST_PIECE", 7)
    monkeypatch.setattr(advance, "next_piece", lambda *_: 7)
    monkeypatch.setattr(advance, "SEGMENT_SECONDS", 0.0)
    run_case(load_case(phases), stages=("simulate",), force=("simulate",))
    pieces = load_results(phases)
    assert pieces.metadata["scenario"] == whole.metadata["scenario"]
    np.testing.assert_array_equal(pieces.time, whole.time)
    for name in whole:
        np.testing.assert_array_equal(pieces[name], whole[name])
