"""An action is one new file: case, schema, plan, run, checks, report and checkpoint know it, and nothing is edited."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

NUDGE = '''
    """Drives that move a little and say so."""

    from __future__ import annotations

    from dataclasses import dataclass
    from typing import TYPE_CHECKING, Annotated

    from heavylift.numerics.outcome import InputError
    from heavylift.numerics.quantity import Positive, Quantity
    from heavylift.solver.scene.actions import ACTIONS, Action, NamesOf
    from heavylift.solver.scene.commands import Command
    from heavylift.solver.scene.operations import GO_BY

    if TYPE_CHECKING:
        from heavylift.solver.scene.operation_state import OperationState


    @ACTIONS.describe("nudge")
    @dataclass(frozen=True)
    class Nudge(Action):
        """A drive moves by a step, with 0.1 m/s and at once."""

        nudge: Annotated[str, NamesOf("drives")]
        """Drives that move."""
        step: Annotated[float, Quantity("length")]
        """How far [m]."""
        loud: Annotated[float, Positive("frequency")] = 300.0
        """What is heard [Hz]."""

        @property
        def text(self) -> str:
            """Words for it."""
            return f"nudge of {self.nudge!r} by {self.step:g} m"

        def tone(self) -> float:
            """As given."""
            return self.loud

        def command(self) -> Command:
            """A move to rest."""
            return Command(operation=GO_BY, actuates="drive", name=self.nudge, value=self.step, speed=0.1)

        def check(self, state: OperationState, key: str) -> None:
            """A step, and not a journey."""
            state.drive(self.nudge, f"{key}.nudge")
            if abs(self.step) > 1.0:
                raise InputError(f"{self.step:g} m", key=f"{key}.step", expected="at most 1 m")
            state.arriving.add(self.nudge)
'''
CASE = """
title = "A trolley that is nudged"

[bodies.trolley]
type = "rigid"
mass = 1000
inertia = [100, 100, 100]
frame = { motion = "fixed" }

[bodies.other]
type = "rigid"
mass = 1000
inertia = [100, 100, 100]
frame = { motion = "fixed" }

[simulate]
step = "10 ms"
output_interval = "100 ms"
duration = "8 s"

[[scenario.phases]]
name = "nudge"
actions = [{ nudge = ["trolley.x", "other.y"], step = "0.5 m" }]
until = { arrived = ["trolley.x", "other.y"] }

[[scenario.phases]]
name = "back"
actions = [{ nudge = "trolley.x", step = "-20 cm", loud = "200 Hz" }]
until = { arrived = "trolley.x" }

[[check]]
id = "place"
quantity = "channel.trolley.position.x.end"
reference = "0.3 m"
tolerance = { absolute = 1e-9 }
source = "0.5 m - 0.2 m"
"""
PROGRAM = """
import sys
from pathlib import Path

import heavylift.solver.scenario.actions as package

folder = Path(sys.argv[1])
package.__path__.append(str(folder / "actions"))

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.case.case_file import load_case

case = load_case(folder / "case")
assert not {"numba", "scipy"} & set(sys.modules)
for wrong, message in (
    ("nudge = 'mast', step = 1", "actions.0.nudge: 'mast' is no drive; expected one of: trolley.x"),
    ("nudge = 'trolley.x', step = '1 kN'", "actions.0.step: '1 kN' is a force; expected a length [m]"),
    ("nudge = 'trolley.x', step = 2", "actions.0.step: 2 m; expected at most 1 m"),
    ("nudge = 'trolley.x'", "actions.0.step: 'nudge' without 'step'; expected 'step'"),
    ("nudge = 'trolley.x', step = 1, speed = 1", "actions.0.speed: 'speed' of 'nudge'; expected loud, step"),
    ("nudge = 'trolley.x', step = 1, note = 'a'", "'note' and 'nudge' in one action; expected one of 'winch', "),
):
    try:
        load_case(folder / "case", [f"scenario.phases.0.actions=[{{ {wrong} }}]"])
    except InputError as error:
        assert message in str(error), error
    else:
        raise AssertionError(wrong)

from heavylift.pipeline.case.schema import key_tables

tables = key_tables()
for line in (
    "| `nudge` | text or list of text | none | Drives that move. |",
    "| `step` | length [m] | none | How far [m]. |",
    "| `loud` | frequency [Hz] > 0 | `300.0` | What is heard [Hz]. |",
):
    assert line in tables, line

import numpy as np

from heavylift.pipeline.commands.scenario import scenario_command
from heavylift.pipeline.log import Log

document, lines = scenario_command(folder / "case", log=Log(quiet=True))
first, second = document["phases"]
assert np.allclose(first["takes_s"] + second["takes_s"], [5.0, 5.0, 2.0, 2.0]), (first, second)
assert [round(x, 12) for x in first["end"]["trolley.x"]] == [0.5, 0.5]
assert [round(x, 12) for x in second["end"]["trolley.x"]] == [0.3, 0.3], second
assert any("nudge of 'other.y' by 0.5 m" in line for line in lines)

from heavylift.pipeline import load_results, run_case
from heavylift.pipeline.checks.judge import judge
from heavylift.pipeline.stages import advance
from heavylift.solver.simulation import Simulation

report = run_case(case)
assert report.outcome is Outcome.COMPLETED, report.message
whole = load_results(case, case.output_folder)
place = np.interp(whole.time, [0.0, 5.0, 7.0, 8.0], [0.0, 0.5, 0.3, 0.3])
np.testing.assert_allclose(whole["trolley.position"][:, 0], place, atol=1e-9)
scenario = whole.metadata["scenario"]
assert scenario["tones"] == [[0.0, 300.0], [0.0, 300.0], [5.0, 200.0]], scenario
assert judge(case, case.output_folder, whole).passed
page = (case.output_folder / "report" / "report.html").read_text()
assert "nudge of &#x27;other.y&#x27; by 0.5 m" in page
assert '"tone":200.0' in page

# killed in the second phase, with a checkpoint every few steps, and run again
class Killed(BaseException):
    pass


kills, reached = True, []


def until_killed(simulation, steps):
    reached.append(simulation.step_index)
    if reached[-1] > 600 and kills:
        raise Killed
    return whole_advance(simulation, steps)


advance.FIRST_PIECE, advance.SEGMENT_SECONDS = 7, 0.0
advance.next_piece = lambda *_: 7
whole_advance, Simulation.advance = Simulation.advance, until_killed
try:
    run_case(case, stages=("simulate",), force=("simulate",))
except Killed:
    pass
else:
    raise AssertionError("not killed")
kills = False
reached.clear()
assert run_case(case, stages=("simulate",)).outcome is Outcome.COMPLETED
assert 600 < reached[0] < 610, reached[0]
again = load_results(case, case.output_folder)
assert again.metadata["scenario"] == scenario
for name in whole:
    np.testing.assert_array_equal(again[name], whole[name])
print("all")
"""
TWICE = """
import sys

import heavylift.solver.scenario.actions as package

package.__path__.append(sys.argv[1])

from heavylift.solver.scene.actions import ACTIONS

try:
    ACTIONS.kinds
except TypeError as error:
    print(error)
"""


def written(folder: Path, text: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "nudge.py").write_text(textwrap.dedent(text))
    return folder


def told(program: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", program, str(folder)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_a_new_action_is_one_new_file(tmp_path: Path) -> None:
    written(tmp_path / "actions", NUDGE)
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "case.toml").write_text(CASE)
    done = told(PROGRAM, tmp_path)
    assert done.stdout.strip().endswith("all"), done.stderr


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('describe("nudge")', 'describe("push")', "nudge.py, Nudge: an action 'push' has a key 'push'"),
        ("        step: Annotated", "        speed: Annotated", "Nudge: 'speed' is a key of"),
        (
            'step: Annotated[float, Quantity("length")]',
            "step: float",
            "Nudge.step: <class 'float'>, expected an",
        ),
    ],
)
def test_an_action_has_its_word_and_keys_of_its_own(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in NUDGE
    assert words in told(TWICE, written(tmp_path, NUDGE.replace(old, new))).stdout


def test_a_word_stands_for_one_action(tmp_path: Path) -> None:
    text = NUDGE.replace('describe("nudge")', 'describe("note")').replace(
        "nudge: Annotated", "note: Annotated"
    )
    message = told(TWICE, written(tmp_path, text)).stdout
    assert "nudge.py, Nudge: 'note' is the word of" in message
    assert "actions/note.py, Note" in message


def test_a_file_has_one_name(tmp_path: Path) -> None:
    (tmp_path / "note.py").write_text(textwrap.dedent(NUDGE))
    message = told(TWICE, tmp_path).stdout
    assert f"{tmp_path}/note.py: another file of this name is " in message
