"""Roads as tables of heights in a case: what is no grid is told with the file or the key."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case

CASE = Path(__file__).resolve().parents[3] / "cases" / "spmt_warp"
FILE = 'grid = { file = "road.csv" }'
INLINE = """grid.stations = ["-20 m", "0 m", "20 m"]
grid.offsets = [-1.5, 1.5]
grid.heights = [[0, 0], ["0 mm", "0 mm"], ["-60 mm", "60 mm"]]
"""


def case_with(folder: Path, grid: str = FILE, road: str | None = None, *changes: tuple[str, str]):
    """The case with another table in its text, or another file."""
    text = (CASE / "case.toml").read_text(encoding="utf-8")
    for old, new in ((FILE, grid), *changes):
        assert old in text
        text = text.replace(old, new)
    (folder / "case.toml").write_text(text, encoding="utf-8")
    if road is None:
        shutil.copy(CASE / "road.csv", folder)
    else:
        (folder / "road.csv").write_text("station,offset,height\n" + road, encoding="utf-8")
    return load_case(folder)


@pytest.mark.parametrize(
    ("grid", "words"),
    [
        (FILE.replace("file", "fil"), r"decks\.0\.grid\.fil"),
        (FILE.replace("road", "rod"), r"decks\.0\.grid\.file.*rod\.csv"),
        (INLINE + 'grid.file = "road.csv"', r"grid\.file: both 'file' and 'stations'; expected a grid of heights"),
        (INLINE.replace('"0 m"', '"0 kg"'), r"grid\.stations\.1.*'0 kg'"),
        (INLINE.replace("-1.5", '"nan m"'), r"grid\.offsets\.0.*nan m"),
        (INLINE.replace('"0 m"', '"-20 m"'), r"grid\.stations\.1: -20 follows -20; expected stations that increase"),
        (INLINE.replace("[-1.5, 1.5]", "[1.5]"), "grid.offsets: 1 offsets; expected two or more"),
        (INLINE.replace("[0, 0], [", "["), "grid.heights: 2 rows of heights at 3 stations; expected a row for each"),
        (INLINE.replace("[0, 0]", "[0, 0, 0]"), r"grid\.heights\.0: 3 heights at 2 offsets; expected a height for"),
        ("sides = [-1, 1]\n" + INLINE, r"decks\.0\.sides: 'sides' of a deck with a 'grid'"),
        ("stations = [-20, 20]\nheights = [0, 0]\n" + INLINE, "stations: 'stations' and 'grid'; expected a profile"),
    ],
)  # fmt: skip
def test_what_is_no_grid_is_one_error_with_its_key(tmp_path, grid: str, words: str) -> None:
    """Before the run."""
    with pytest.raises(InputError, match=words) as error:
        case_with(tmp_path, grid)
    assert str(error.value).count("expected") == 1


@pytest.mark.parametrize(
    ("road", "words"),
    [
        (
            "0,0,0\n0,1,0\n1,0,0\n1,2,0\n",
            r"road\.csv: station 1 m has other offsets than the 2 of station 0 m",
        ),
        ("0,0,0\n0,1,0\n1,0,0\n", r"road\.csv: station 1 m has other offsets than the 2 of station 0 m"),
        ("0,1,0\n0,0,0\n1,1,0\n1,0,0\n", r"road\.csv: 0 follows 1; expected offsets that increase"),
        (
            "0,0,0\n0,1,0\n-1,0,0\n-1,1,0\n",
            r"road\.csv: line 4: -1 after 0; expected station that does not fall",
        ),
        ("0,0,0\n0,1,0\n0,2,0\n", r"road\.csv: 1 stations; expected two or more"),
        ("0,0,0\n0,1,nan\n1,0,0\n1,1,0\n", r"road\.csv: line 3: '0,1,nan'; expected 3 finite numbers"),
        ("0,0,0\n", r"road\.csv: 1 rows; expected at least 2"),
    ],
)
def test_a_file_that_is_no_grid_is_one_error_with_its_name(tmp_path, road: str, words: str) -> None:
    """With the line where there is one."""
    with pytest.raises(InputError, match=words) as error:
        case_with(tmp_path, FILE, road)
    assert str(error.value).count("expected") == 1


def test_a_table_in_the_case_and_its_file_are_one_road(tmp_path) -> None:
    """The same heights under all wheels."""
    short = (('duration = "80 s"', 'duration = "30 s"'),)
    roads = []
    lines = (CASE / "road.csv").read_text(encoding="utf-8").splitlines()[2:]
    x, y, h = np.array([list(map(float, line.split(","))) for line in lines]).T
    rows = h.reshape(41, 4).tolist()
    text = f"grid.stations = {x[::4].tolist()}\ngrid.offsets = {y[:4].tolist()}\ngrid.heights = {rows}"
    for name, grid in (("file", FILE), ("text", text)):
        (tmp_path / name).mkdir()
        case = case_with(tmp_path / name, grid, None, *short)
        run_case(case, stages=("simulate",))
        roads.append(load_results(tmp_path / name)["spmt.road_under"])
    assert roads[0].max() > 1e-3
    np.testing.assert_array_equal(*roads)


def test_a_table_as_spreadsheets_save_it_is_read(tmp_path) -> None:
    """With the mark of a byte order before its header."""
    road = (CASE / "road.csv").read_text(encoding="utf-8")
    case_with(tmp_path)
    (tmp_path / "road.csv").write_text(road, encoding="utf-8-sig")
    marked = load_case(tmp_path).decks[0].grid
    (tmp_path / "road.csv").write_text(road, encoding="utf-8")
    assert marked == load_case(tmp_path).decks[0].grid
