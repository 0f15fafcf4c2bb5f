"""A computed database that cannot be one is kept and told by frequency; its good part is not computed again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.hulls import database_manifest, stored_database
from heavylift.pipeline.log import Log
from heavylift.pipeline.report.sea import sea_sections
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.preprocess.hydrodynamics import bem
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

pytest.importorskip("capytaine")

CASE = """
title = "A small barge"

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[bodies.barge]
type = "rigid"
mass = "600 t"
inertia = ["1e7 kg m^2", "2e7 kg m^2", "2e7 kg m^2"]
centre_of_mass = [0, 0, 0]
frame = { motion = "free" }

[[surfaces]]
name = "skin"
body = "barge"
shape = { type = "box", size = ["20 m", "10 m", "5 m"] }

[hulls.barge]
surface = "skin"

[sea]
density = "1025 kg/m^3"

[databases.water]
hulls = ["barge"]
memory = "none"

[databases.water.compute]
panel_size = 4
symmetric = true
processes = 1
frequencies = { first = 0.4, last = 1.2, count = 9 }

[simulate]
step = "0.1 s"
output_interval = "0.5 s"
duration = "1 s"
"""
BAD, SHARE = 3, 0.25
OMEGA = 0.4 + 0.1 * BAD


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "barge"
    made.mkdir()
    (made / "case.toml").write_text(CASE)
    return made


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Frequencies that were solved; at one of them surge and pitch are not reciprocal."""
    done: list[float] = []
    solve = bem._solve

    def wrong(body: Any, sea: Any, number: int, omega: float) -> Any:
        task = solve(body, sea, number, omega)
        done.append(omega)
        if omega == pytest.approx(OMEGA):
            task.added_mass[0, 4] += SHARE * task.added_mass[4, 4] / 5.0
        return task

    monkeypatch.setattr(bem, "_solve", wrong)
    return done


class Heard(Log):
    """What was said."""

    def __init__(self) -> None:
        super().__init__(quiet=True)
        self.lines: list[str] = []

    def say(self, text: str) -> None:
        self.lines.append(text)


def refuse(folder: Path, log: Log, *overrides: str) -> InputError:
    with pytest.raises(InputError) as caught:
        run_case(load_case(folder, overrides), stages=("mesh",), log=log)
    return caught.value


@pytest.mark.slow
def test_what_was_computed_is_kept_and_told(folder: Path, solved: list[float]) -> None:
    log = Heard()
    error = refuse(folder, log)
    assert len(solved) == 10
    out = OutputFolder(folder / "out")
    assert "0.7 rad/s: added_mass of surge and pitch differs by" in error.problem
    assert error.key == "databases.water.compute"
    for words in ("panel_size", "leave_out = [0.7]", "within 10%"):
        assert words in error.expected
    assert "lid" not in error.expected
    assert [line for line in log.lines if "REFUSED: 0.7 rad/s" in line]
    assert [line for line in log.lines if str(out.refused_database("water")) in line]
    # all of it is there, but nothing takes it for a database
    kept = read_netcdf(out.refused_database("water"), checked=False)
    assert len(kept.omega) == 9
    assert not out.database("water").is_file()
    assert database_manifest(out) == {}
    case = load_case(folder)
    with pytest.raises(InputError, match="has not been computed"):
        stored_database(case, "water", out)
    told = json.loads(out.refused_database("water").with_suffix(".json").read_text())
    (fault,) = told["faults"]
    assert (fault["matrix"], sorted(fault["entries"])) == ("added_mass", [0, 4])
    assert fault["omega"] == pytest.approx(OMEGA)
    matrix = kept.added_mass[BAD]
    assert abs(matrix[0, 4] - matrix[4, 0]) > 0.0
    (section,) = sea_sections(case, out, None)
    texts = " ".join(getattr(item, "text", "") for item in section.items)
    assert "is refused: 0.7 rad/s" in texts
    assert "leave_out" in texts


@pytest.mark.slow
def test_the_same_again_is_told_without_computing(folder: Path, solved: list[float]) -> None:
    first = refuse(folder, Log(quiet=True))
    solved.clear()
    again = refuse(folder, Log(quiet=True))
    assert solved == []
    assert (again.problem, again.expected) == (first.problem, first.expected)


@pytest.mark.slow
def test_the_other_frequencies_are_taken_from_what_was_kept(folder: Path, solved: list[float]) -> None:
    refuse(folder, Log(quiet=True))
    solved.clear()
    leave_out = "databases.water.leave_out=[0.7]"
    case = load_case(folder, [leave_out])
    out = run_case(case, stages=("mesh",)).folder
    assert solved == []
    found, kept = (
        stored_database(case, "water", out),
        read_netcdf(out.refused_database("water"), checked=False),
    )
    np.testing.assert_allclose(found.omega, [0.4, 0.5, 0.6, 0.8, 0.9, 1.0, 1.1, 1.2], rtol=1e-12)
    for key in ("added_mass", "excitation"):
        np.testing.assert_array_equal(getattr(found, key), np.delete(getattr(kept, key), BAD, axis=0))
    own = [np.diagonal(values, axis1=1, axis2=2) for values in (found.damping, kept.damping)]
    np.testing.assert_allclose(own[0], np.maximum(np.delete(own[1], BAD, axis=0), 0.0), rtol=1e-12)
    assert found.source.startswith("Capytaine")
    (section,) = sea_sections(case, out, None)
    assert "refused" not in " ".join(getattr(item, "text", "") for item in section.items)
    # other panels are another database
    with pytest.raises(InputError):
        run_case(load_case(folder, ["databases.water.compute.panel_size=5"]), stages=("mesh",))
    assert len(solved) == 10


@pytest.mark.slow
def test_a_range_above_or_below_is_proposed_where_it_ends(folder: Path, solved: list[float]) -> None:
    error = refuse(
        folder, Log(quiet=True), "databases.water.compute.frequencies={first = 0.4, last = 0.7, count = 4}"
    )
    assert "'frequency_range = [0.4, 0.6]'" in error.expected
    # the words of the message do it, and nothing is computed again
    solved.clear()
    told = "databases.water.frequency_range=[0.4, 0.6]"
    frequencies = "databases.water.compute.frequencies={first = 0.4, last = 0.7, count = 4}"
    out = run_case(load_case(folder, [frequencies, told]), stages=("mesh",)).folder
    assert solved == []
    stored = stored_database(load_case(folder, [frequencies, told]), "water", out)
    np.testing.assert_allclose(stored.omega, [0.4, 0.5, 0.6], rtol=1e-12)


@pytest.mark.slow
def test_what_is_tolerated_is_repaired_and_told(folder: Path, solved: list[float]) -> None:
    refuse(folder, Log(quiet=True))
    solved.clear()
    log, wider = Heard(), "databases.water.tolerance=0.2"
    case = load_case(folder, [wider])
    out = run_case(case, stages=("mesh",), log=log).folder
    assert solved == []
    (line,) = [line for line in log.lines if "REPAIRED: added mass of surge-pitch unsymmetric by" in line]
    assert "at 0.7 rad/s: symmetrised" in line
    stored = stored_database(case, "water", out)
    np.testing.assert_array_equal(stored.added_mass, np.swapaxes(stored.added_mass, 1, 2))
    (section,) = sea_sections(case, out, None)
    assert "water was repaired: added mass of surge-pitch" in " ".join(
        getattr(item, "text", "") for item in section.items
    )
    with pytest.raises(InputError, match="nothing is repaired"):
        load_case(folder, [wider, "databases.water.symmetrise=false"])


@pytest.mark.parametrize(
    ("wanted", "words"), [("[2.0]", "0.4 to 1.2 rad/s"), ("[0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]", "3 or more")]
)
def test_what_cannot_be_left_out(folder: Path, wanted: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        load_case(folder, [f"databases.water.leave_out={wanted}"])
