"""A criterion is one new file: case, schema, judgement and report know it, and nothing that exists is edited."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from pathlib import Path

OFFSET = '''
    """How far a body is from where it was to be."""

    from collections.abc import Sequence
    from typing import Annotated, Any, Literal

    import numpy as np

    from heavylift.pipeline.case.criteria.base import CriterionSection
    from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE
    from heavylift.pipeline.case.criteria.results import CriterionResult, CurveFigure, Series
    from heavylift.pipeline.case.criteria.run import Run
    from heavylift.pipeline.case.fields import BodyName, Positive, reject


    class OffsetCriterion(CriterionSection):
        """Distance of the origin of a body from that of the world, at any height."""

        type: Literal["offset"]
        body: BodyName
        """Body that is watched."""
        maximum: Annotated[float, Positive("length")]
        """Largest distance [m]."""

        def check_case(self, case: Any, key: str) -> None:
            """Bodies of finite elements have no place of their own."""
            super().check_case(case, key)
            if case.bodies[self.body].type != "rigid":
                reject(f"{self.body!r} is not rigid", "a rigid body", key=f"{key}.body")

        def judge(self, run: Run) -> list[CriterionResult]:
            """Largest distance."""
            series = [Series(self.body, self._distance(run), self.maximum)]
            return [run.result("distance from the origin", "m", series, (OF_THE_CASE,), seen=run.records)]

        def figures(self, run: Run, lines: Sequence[CriterionResult]) -> list[CurveFigure]:
            """Distance over height."""
            (line,) = lines
            height = run.place(self.body, (0.0, 0.0, 0.0)) @ run.up
            return [
                CurveFigure(
                    name=f"offset_{self.name}", title="Offset", caption="Distance over height", line=line,
                    place="height [m]", value="distance", limit="largest", unit="m",
                    curve=((-1.0, 1.0), (self.maximum, self.maximum)), values=(height, self._distance(run)),
                )
            ]

        def _distance(self, run: Run) -> Any:
            place = run.place(self.body, (0.0, 0.0, 0.0))
            return np.linalg.norm(place - np.outer(place @ run.up, run.up), axis=1)
'''
TABLE = """
[[criteria]]
name = "on_spot"
type = "offset"
body = "load"
maximum = "2 m"
"""
PROGRAM = """
import sys
from pathlib import Path

import heavylift.pipeline.case.criteria as package

folder = Path(sys.argv[1])
package.__path__.append(str(folder / "criteria"))

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.case_file import load_case

case = load_case(folder / "case")
assert not {"numba", "scipy"} & set(sys.modules)
assert case.criteria[0].maximum == 2.0
for wrong, message in (
    ("criteria.0.maximum=2 kN", "criteria.0.maximum: '2 kN' is a force; expected a length [m]"),
    ("criteria.0.body=lode", "criteria.0.body: body 'lode' does not exist"),
    ("criteria.0.after=2 s", "criteria.0.after: 2 s; expected a time within the run, up to 1 s"),
    ("criteria.0.maximal=1", "criteria.0.maximal does not exist; did you mean 'maximum'?"),
    ("criteria.0.type=off", "expected one of 'crane', 'sling', 'sling_angle', 'shackle', "),
    ("criteria.0.type=off", "'limit', 'offset', 'spread'"),
):
    try:
        load_case(folder / "case", [wrong])
    except InputError as error:
        assert message in str(error), error
    else:
        raise AssertionError(wrong)

from heavylift.pipeline.case.schema import key_tables, section_tables

tables = key_tables()
for line in (
    '## criteria, type = "offset"',
    "Distance of the origin of a body from that of the world, at any height.",
    "| `maximum` | length [m] > 0 |  | Largest distance [m]. |",
    "| `after` | time [s] >= 0 | none | Only from this time of the run on [s]; from its start if absent. |",
):
    assert line in tables, line
assert "Body that is watched." in section_tables("criteria.offset", 100)

import numpy as np

from heavylift.pipeline.checks.judge import judge, judging_stages
from heavylift.pipeline.results.histories import ChannelInfo, Results

assert judging_stages(case) == ("mesh", "modes", "simulate")
times = np.linspace(0.0, 1.0, 11)
columns = {
    "load.position": np.column_stack([3.0 * times, 4.0 * times, times]),
    "load.orientation": np.tile([1.0, 0.0, 0.0, 0.0], (11, 1)),
}
infos = {
    "load.position": ChannelInfo("load.position", "m", ("x", "y", "z"), 0),
    "load.orientation": ChannelInfo("load.orientation", "1", ("q0", "q1", "q2", "q3"), 3),
}
results = Results(Path("results.h5"), times, infos, columns, {"outcome": "completed"})
judged = judge(case, folder / "out", results)
(line,) = judged.criteria
assert (round(line.value, 12), line.time, line.where, line.passed) == (5.0, 1.0, "load", False)
assert not judged.passed

from heavylift.pipeline.report.criteria import criteria_section
from heavylift.pipeline.report.document import Album, Figure

(folder / "report").mkdir()
(section,) = criteria_section(case, folder / "out", results, judged.criteria, {}, Album(folder / "report"))
assert section.items[0].rows[0][0] == "on_spot: distance from the origin"
captions = [item.caption for item in section.items if isinstance(item, Figure)]
assert captions[0] == "Distance over height; largest utilisation 250.0 %.", captions
assert (folder / "report" / "offset_on_spot.png").is_file()
print("all")
"""
TWICE = """
import sys

import heavylift.pipeline.case.criteria as package

package.__path__.append(sys.argv[1])

from heavylift.pipeline.case.criteria_table import criterion_kinds

try:
    criterion_kinds()
except TypeError as error:
    print(error)
"""


def run(program: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program, str(folder)], capture_output=True, text=True, check=False
    )


def test_a_new_criterion_is_one_new_file(tmp_path: Path) -> None:
    text = (Path(__file__).parents[1] / "slings.toml").read_text().replace("duration = 0", "duration = 1")
    for name, content in (("criteria/offset.py", textwrap.dedent(OFFSET)), ("case/case.toml", text + TABLE)):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(content)
    done = run(PROGRAM, tmp_path)
    assert done.stdout.strip() == "all", done.stderr


def test_a_word_stands_for_one_criterion(tmp_path: Path) -> None:
    (tmp_path / "wind.py").write_text(textwrap.dedent(OFFSET).replace('"offset"', '"tilt"'))
    message = run(TWICE, tmp_path).stdout
    assert f"{tmp_path}/wind.py, OffsetCriterion: 'tilt' is the word of" in message
    assert "criteria/tilt.py, TiltCriterion" in message


def test_a_file_has_one_name(tmp_path: Path) -> None:
    (tmp_path / "tilt.py").write_text(textwrap.dedent(OFFSET))
    message = run(TWICE, tmp_path).stdout
    assert f"{tmp_path}/tilt.py: another file of this name is " in message
    assert "criteria/tilt.py" in message


def test_a_criterion_says_its_word_and_how_it_is_judged(tmp_path: Path) -> None:
    for change in (
        ("    type: Literal[", "    kind: Literal["),
        ("    def judge(", "    def judged("),
        ('"offset"', '"offset", "away"'),
    ):
        (tmp_path / "offset.py").write_text(textwrap.dedent(OFFSET).replace(*change))
        assert (
            "OffsetCriterion: a kind of criteria has a key 'type' with one word"
            in run(TWICE, tmp_path).stdout
        )
