"""The criterion of transporters, the angles at which they tip over, and the plan of a path in the report."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.checks.quantities import Quantities
from tests.pipeline.judged import judged_criteria

CASE = Path(__file__).resolve().parents[3] / "cases" / "spmt_steering" / "case.toml"


def written(folder: Path, *changes: tuple[str, str]) -> Path:
    """The case in a folder, without its checks and but for a few seconds, with some changes."""
    text = CASE.read_text(encoding="utf-8").partition("[[check]]")[0].replace('"210 s"', '"6 s"')
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return folder


def test_a_transporter_is_judged_by_what_it_tells_and_records(tmp_path) -> None:
    """Angles before the run, loads, strokes, drives; a limit beyond what it has fails, by that line alone."""
    folder = written(
        tmp_path / "spmt", ('transporter = "spmt"\n', 'transporter = "spmt"\ntipping = "6.6 deg"\n')
    )
    case = load_case(folder)
    assert run_case(case, stages=["simulate"]).outcome is Outcome.COMPLETED
    rows = judged_criteria(case, folder / "out")
    failed = [row.what for row in rows if not row.passed]
    assert failed == ["tilt at which it tips over, compliant groups"]
    assert len(rows) == 8
    values = {row.what: row.value for row in rows}
    assert values["tilt at which it tips over, rigid groups"] == pytest.approx(math.atan(0.725 / 3.579190751))
    assert Quantities(case, folder / "out").number("tipping.spmt.static") == rows[0].value
    # turning begins with its inertia about the middle and rolling, shared by eight bogies, by hand
    reach = math.hypot(3.5, 0.725)
    radii = [math.hypot(x, 0.725) for x in (3.5, 2.1, 0.7) for _ in range(4)]
    driven = [radii[i] for i in (0, 8, 0, 8, 8, 0, 8, 0)]
    needed = 6.0e6 * 0.05 / reach + 0.02 * (173e3 / 12 + 108.0) * 9.81 * sum(radii)
    drive = next(row for row in rows if "its drive can" in row.what)
    assert drive.value == pytest.approx(needed / sum(driven) / 30e3, rel=5e-3)
    assert drive.limit == 0.8
    assert json.dumps([row.row() for row in rows])


def test_tyres_that_slide_fail(tmp_path) -> None:
    """Friction of 0.0205 on a cant of 0.02: as it starts all of it is used, and never more."""
    text = (
        (CASE.parents[1] / "spmt_tyres" / "case.toml").read_text(encoding="utf-8").partition("[[check]]")[0]
    )
    for old, new in (('"130 s"', '"12 s"'), ('"60 s"', '"5 s"'), ("friction = 0.3", "friction = 0.0205")):
        text = text.replace(old, new)
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    case = load_case(tmp_path)
    run = run_case(case, stages=["simulate"])
    assert run.outcome is Outcome.COMPLETED
    (row,) = (row for row in judged_criteria(case, tmp_path / "out") if "friction allows" in row.what)
    assert row.value == pytest.approx(1.0, abs=1e-9)
    assert not row.passed


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('transporter = "spmt"', 'transporter = "smpt"'), "criteria.0.transporter"),
        (
            (
                "[[criteria]]",
                '[[check]]\nid = "a"\nquantity = "tipping.spmt.statik"\nmaximum = 1\n[[criteria]]',
            ),
            "statik",
        ),
        (('radius = "15 m"', 'radius = "17 m"'), "legs.2.radius: corners take 20.0"),
        (('steering_limit = "130 deg"', 'steering_limit = "60 deg"'), "bogie 1 would have to steer by"),
        (('turn = "90 deg"', 'turn = "90 m"'), "legs.0.turn"),
    ],
)
def test_bad_input_is_one_line(tmp_path, change, words) -> None:
    """With the key and what was expected."""
    folder = written(tmp_path / "spmt", change)
    with pytest.raises(InputError, match=re.escape(words)):
        run_case(load_case(folder), stages=["simulate"])
