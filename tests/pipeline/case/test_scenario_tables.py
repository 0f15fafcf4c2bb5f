"""The scenario of a case file: what its words become, units, patterns, and what is refused where."""

# ruff: noqa: E501

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.case.case_file import Case
from heavylift.pipeline.commands.scenario import scenario_command
from heavylift.pipeline.log import Log
from heavylift.solver.scenario.actions.connect import Connect
from heavylift.solver.scenario.actions.drive import DriveSpeed, DriveTo
from heavylift.solver.scenario.actions.fail import Fail
from heavylift.solver.scenario.actions.release import Release
from heavylift.solver.scenario.actions.restore import Restore
from heavylift.solver.scenario.actions.winch import (
    WinchBrake,
    WinchFollow,
    WinchHaul,
    WinchLength,
    WinchLevel,
    WinchSpeed,
    WinchTension,
)
from heavylift.solver.scene.scenario import Condition
from heavylift.solver.scene.signals import Signal, Term

CASE = """
title = "Two falls, a trolley and a mast"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.trolley]
type = "rigid"
mass = 1000
inertia = [100, 100, 100]
frame = { motion = "fixed" }

[bodies.arm]
type = "rigid"
mass = 100
inertia = [10, 10, 10]
frame = { motion = "free" }
initial = { position = [0, 0, 5] }

[[joints]]
name = "mast"
type = "hinge"
between = ["ground", "arm"]
at = [0, 0, 5]
axis = [0, 0, 1]
drive = { times = [0], speeds = [0] }

[[repeat]]
count = 2

[[repeat.falls]]
name = "hook_{i + 1}"
crown = { body = "trolley", point = [0, "{4*i - 2} m", 0] }
parts = "{4 + 2*i}"
sheave_radius = 0.5
drop = 20
block = { mass = "20 t", hook_depth = 2 }
rope = { axial_stiffness = "256.5 MN", damping = "100 kN s/m", brake = "900 kN" }

[[ropes]]
name = "tag"
axial_stiffness = "1 MN"
length = "40 m"
path = [{ body = "ground", point = [10, 0, -20] }, { body = "hook_1_block", point = [0, 0, 0] }]

[simulate]
step = "10 ms"
output_interval = "50 ms"
duration = "30 s"
start = "equilibrium"

[scenario]
"""


def case(folder: Path, phases: str) -> Case:
    (folder / "case.toml").write_text(CASE + phases)
    return load_case(folder)


def acts(folder: Path, action: str) -> tuple[object, ...]:
    made = case(folder, f'[[scenario.phases]]\nname = "go"\nactions = [{action}]\n').operation
    assert made is not None
    return made.actions


def until(folder: Path, condition: str, actions: str = "") -> Condition:
    first = f'[[scenario.phases]]\nname = "go"\nactions = [{actions}]\nuntil = {condition}\n'
    made = case(folder, f'{first}[[scenario.phases]]\nname = "end"\n').operation
    assert made is not None
    return made.phases[0].until[0]


@pytest.mark.parametrize(
    ("action", "expected"),
    [
        ('{ winch = "tag", speed = "6 m/min", ramp = 2 }', [WinchSpeed("tag", 0.1, 2.0)]),
        (
            '{ winch = "tag", length = 30, speed = 0.1, acceleration = "0.1 m/s^2", jerk = 0.2 }',
            [WinchLength("tag", 30.0, 0.1, acceleration=0.1, jerk=0.2)],
        ),
        ('{ winch = "tag", distance = -2, speed = 0.1 }', [WinchHaul("tag", -2.0, 0.1)]),
        ('{ winch = "tag", follow = "hook_1_rope", ratio = 0.5 }', [WinchFollow("tag", "hook_1_rope", 0.5)]),
        ('{ winch = "hook_*_rope", brake = true }', [WinchBrake("hook_1_rope", on=True), WinchBrake("hook_2_rope", on=True)]),
        ('{ winch = "hook_1_rope", tension = "100 kN", speed = 0.2 }', [WinchTension("hook_1_rope", 1e5, 0.2)]),
        ('{ hook = "hook_*", speed = 0.05, ramp = 2 }', [WinchSpeed("hook_1_rope", 0.2, 2.0), WinchSpeed("hook_2_rope", pytest.approx(0.3), 2.0)]),
        (
            '{ hook = ["hook_2"], distance = "1 m", speed = 0.05, acceleration = 0.01 }',
            [WinchHaul("hook_2_rope", 6.0, pytest.approx(0.3), acceleration=pytest.approx(0.06))],
        ),
        (
            '{ hook = "hook_1", height = "-15 m", speed = 0.05 }',
            [WinchHaul("hook_1_rope", -13.0, 0.2, 0.0, Signal((Term("hook_1_block.position", "z"),)), 4.0)],
        ),
        (
            '{ hook = "hook_*", level = true, speed = 0.01 }',
            [WinchLevel("hook_1_rope", 0.25, 0.04, 0.05, 1), WinchLevel("hook_2_rope", 1 / 6, pytest.approx(0.06), 0.05, 1)],
        ),
        ('{ drive = "mast", speed = "3 deg/s", ramp = 1 }', [DriveSpeed("mast", pytest.approx(0.05235987756), 1.0)]),
        ('{ drive = "mast", position = "90 deg", speed = 0.1 }', [DriveTo("mast", pytest.approx(1.5707963268), 0.1)]),
        ('{ drive = "trolley.x", distance = "5 m", speed = "10 m/min" }', [DriveTo("trolley.x", 5.0, pytest.approx(1 / 6), 0.0, True)]),
        ('{ drive = "trolley.angle", speed = "1 rpm" }', [DriveSpeed("trolley.angle", pytest.approx(0.10471975512))]),
        (
            '{ fail = ["hook_*", "mast"] }, { restore = "hook_2" }',
            [Fail("hook_1_rope", "winch"), Fail("hook_2_rope", "winch"), Fail("mast", "drive"), Restore("hook_2_rope", "winch")],
        ),
        ('{ release = ["tag", "hook_2_rope"] }, { connect = "tag", slack = 1 }', [Release("tag"), Release("hook_2_rope"), Connect("tag", 1.0)]),
    ],
)  # fmt: skip
def test_actions(action: str, expected: list[object], tmp_path: Path) -> None:
    assert list(acts(tmp_path, action)) == expected


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        (
            '{ quantity = "sum(hook_*_rope.tension)", above = "0.9 W", of = ["hook_*_block"] }',
            Condition(
                Signal((Term("hook_1_rope.tension"), Term("hook_2_rope.tension")), "sum", "sum(hook_*_rope.tension)"),
                0.9,
                weight_of=("hook_1_block", "hook_2_block"),
            ),
        ),
        (
            '{ slack = "hook_*_rope", hold = 2 }',
            Condition(
                Signal((Term("hook_1_rope.tension"), Term("hook_2_rope.tension")), "largest", "largest(hook_*_rope).tension"),
                1.0, True, 2.0,
            ),
        ),
        (
            '{ taut = ["tag", "hook_1_rope"], above = "2 kN" }',
            Condition(Signal((Term("tag.tension"), Term("hook_1_rope.tension")), "smallest", "smallest(tag, hook_1_rope).tension"), 2e3),
        ),
        ('{ user = "continue" }', Condition(Signal((), "told"), 0.5)),
    ],
)  # fmt: skip
def test_conditions(condition: str, expected: Condition, tmp_path: Path) -> None:
    assert until(tmp_path, condition) == expected


def test_what_has_arrived_is_named_by_hooks_too(tmp_path: Path) -> None:
    found = until(
        tmp_path,
        '{ arrived = ["hook_*", "mast"] }',
        '{ hook = "hook_*", distance = 1, speed = 0.1 }, { drive = "mast", position = 1, speed = 0.1 }',
    )
    assert found.signal is not None
    assert [term.channel for term in found.signal.terms] == ["hook_1_rope", "hook_2_rope", "mast"]


@pytest.mark.parametrize(
    ("phase", "key", "words"),
    [
        ('actions = [{ winch = "tag" }]', "actions.0.speed", "a winch without 'speed'"),
        ('actions = [{ hook = "hook_3", speed = 1 }]', "actions.0.hook", "'hook_3' is no hook; did you mean"),
        ('actions = [{ winch = "crane_*", speed = 1 }]', "actions.0.winch", "'crane_*' is no rope"),
        ('actions = [{ note = "a" }, { winch = "tag", length = 9, speed = -1 }]', "actions.1.speed", "-1 m/s with a length"),
        ('actions = [{ winch = "tag", length = 9, distance = 1, speed = 1 }]', "actions.0.distance", "both 'length' and"),
        ('actions = [{ winch = "tag", speed = 1, jerk = 1 }]', "actions.0.jerk", "'jerk' without 'acceleration'"),
        ('actions = [{ winch = "tag", speed = 1, ramp = 1, acceleration = 1 }]', "actions.0.acceleration", "both 'ramp'"),
        ('actions = [{ drive = "mast", speed = "1 m/s" }]', "actions.0.speed", "'1 m/s'"),
        ('actions = [{ drive = "trolley.y", speed = "1 deg/s" }]', "actions.0.speed", "'1 deg/s'"),
        ('actions = [{ drive = ["mast", "trolley.y"], speed = 1 }]', "actions.0.speed", "drives that turn and drives"),
        ('actions = [{ drive = "arm.x", speed = 1 }]', "actions.0.drive", "'arm.x' is no drive"),
        ('actions = [{ tank = "aft", rate = 1 }]', "actions.0.tank", "'aft' is no tank"),
        ('actions = [{ tank = "aft", rate = "1 m/s" }]', "actions.0.rate", "'1 m/s'"),
        ('actions = [{ winch = "tag", brake = true }]', "actions.0.brake", "the winch of 'tag' has no brake"),
        ('actions = [{ winch = "tag", tension = 1, speed = 1 }]', "actions.0", "does not answer to its tension"),
        ('actions = [{ hook = "hook_1", level = true, speed = 1 }]', "actions.0.hook", "'hook_1' alone is level"),
        ('actions = [{ hook = "hook_*", brake = true }, { hook = "hook_2", speed = -0.1 }]', "actions.1.hook", "is set"),
        ('until = { quantity = "tag.tension", above = "0.9 W" }', "until.above", "'0.9 W' without 'of'"),
        ('until = { quantity = "tag.tension", above = 9, of = "arm" }', "until.above", "9 with 'of'"),
        ('until = { quantity = "tag.tension", above = "9 m" }', "until.above", "'9 m'"),
        ('until = { quantity = "tag.tensio", above = 9 }', "until.quantity", "tensio"),
        ('until = { quantity = "tog.tension", above = 9 }', "until.quantity", "'tog'"),
        ('until = { arrived = "hook_1" }', "until", "'hook_1_rope' has not been told to go anywhere"),
        ('actions = [{ winch = "tag", length = 30, speed = 1 }]\nuntil = { quantity = "tag.rest_length", below = 29 }', "until", "the winch of 'tag' stops at 30 m"),
        ('until = { slack = "rope_*" }', "until.slack", "'rope_*' is no rope"),
        ('until = { time = "40 s" }', "until", "it waits for 40 s, and the run takes 30 s"),
        ('until = { time = 1, user = "continue" }', "until.time", "beside another condition"),
        ('until = { taut = "tag", below = 1 }', "until.below", "'below' beside 'taut'"),
        ('actions = [{ release = "tag" }, { release = "tag" }]', "actions.1.release", "is not connected then"),
    ],
)  # fmt: skip
def test_refused(phase: str, key: str, words: str, tmp_path: Path) -> None:
    text = f'[[scenario.phases]]\nname = "go"\n{phase}\n[[scenario.phases]]\nname = "end"\n'
    if "until" not in phase:
        text = text.replace(phase, f"{phase}\nuntil = {{ time = 1 }}")
    with pytest.raises((InputError, InputErrors)) as error:
        case(tmp_path, text)
    assert words in str(error.value)
    assert f"scenario.phases.0.{key}" in str(error.value)


def test_hooks_and_a_trolley_move_as_they_are_told(tmp_path: Path) -> None:
    """Hooks of 4 and 6 parts rise by the same distance; the trolley, fixed until then, by the trapezoid."""
    made = case(
        tmp_path,
        """
[[scenario.phases]]
name = "up"
actions = [{ hook = "hook_*", distance = "2 m", speed = "0.2 m/s", ramp = "3 s" }]
until = { arrived = "hook_*" }

[[scenario.phases]]
name = "along"
actions = [
    { drive = "trolley.x", distance = "1 m", speed = "0.25 m/s", ramp = "2 s" },
    { hook = "hook_1", height = "-20 m", speed = "0.5 m/s", ramp = "1 s" },
]

[scenario.phases.until]
all = [
    { arrived = ["trolley.x", "hook_1"] },
    { quantity = "sum(hook_*_rope.tension)", above = "0.15 W", of = "hook_*_block" },
]
""",
    )
    run_case(made, stages=("mesh", "simulate"))
    results = load_results(made, made.output_folder)
    log = {line[1]: line[0] for line in results.metadata["scenario"]["log"] if line[2] == "done"}
    assert log["up"] == pytest.approx(2.0 / 0.2 + 3.0, abs=1e-6)
    t = results.time
    for hook in ("hook_1", "hook_2"):
        z = results[f"{hook}_block.position"][:, 2]
        risen = z[(t > 12.0) & (t < 13.0)][-1] - z[0]
        assert risen == pytest.approx(2.0, abs=0.01)
    z = results["hook_1_block.position"][:, 2]
    assert z[-1] == pytest.approx(-18.0, abs=0.01)
    assert results["trolley.position"][-1, 0] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(
    ("phase", "words"),
    [
        (
            'actions = [{ hook = "hook_2", distance = 19.5, speed = 1 }]\nuntil = { arrived = "hook_2" }',
            "phase 'go' hoists the block of 'hook_2', 20 m below its crown, by 19.5 m; expected less than 19 m",
        ),
        (
            'actions = [{ winch = "tag", speed = 5 }]\nuntil = { time = 10 }',
            "phase 'go' hauls in 50 m of 'tag' or more, which has 40 m",
        ),
        (
            'actions = [{ drive = "trolley.x", distance = 10, speed = 0.3 }]\nuntil = { arrived = "trolley.x" }',
            "phase 'go' ends at 33.3333 s at the earliest, and the run takes 30 s",
        ),
        (
            'actions = [{ hook = "hook_1", height = "-2.9 m", speed = 1 }]\nuntil = { time = 20 }',
            "phase 'go' hoists 'hook_1' to -2.9 m, and its crown stops it at -3 m; expected a hook below its crown",
        ),
    ],
)
def test_what_is_certain_to_go_wrong_is_refused_before_it_runs(
    phase: str, words: str, tmp_path: Path
) -> None:
    made = case(tmp_path, f'[[scenario.phases]]\nname = "go"\n{phase}\n[[scenario.phases]]\nname = "end"\n')
    with pytest.raises(InputError, match=words):
        run_case(made, stages=("mesh", "simulate"))


def test_a_dry_run_tells_ranges_and_limits(tmp_path: Path) -> None:
    """By the command: times that are known, how high hooks come, where a drive goes."""
    case(
        tmp_path,
        """
[[scenario.phases]]
name = "up"
actions = [{ hook = "hook_*", distance = "2 m", speed = "0.2 m/s", ramp = "3 s" }, { winch = "tag", follow = "hook_1_rope", ratio = -0.25 }]
until = { arrived = "hook_*" }

[[scenario.phases]]
name = "along"
actions = [{ drive = "trolley.x", position = "1 m", speed = "0.25 m/s", acceleration = "0.25 m/s^2", jerk = "1 m/s^3" }]
until = { arrived = "trolley.x" }
""",
    )
    log = Log(quiet=True)
    document, lines = scenario_command(tmp_path, log=log)
    up, along = document["phases"]
    assert up["takes_s"] == pytest.approx([13.0, 13.0])
    assert along["takes_s"] == pytest.approx([4.0 + 1.25, 4.0 + 1.25])
    start = document["start"]
    assert start["hook_2_rope"] - up["end"]["hook_2_rope"][0] == pytest.approx(12.0)
    assert up["end"]["tag"] == pytest.approx([42.0, 42.0])
    assert along["end"]["trolley.x"] == pytest.approx([1.0, 1.0])
    assert up["largest_speed"]["hook_1_rope"] == pytest.approx(0.8)
    (hook,) = (line for line in lines if line.startswith("hook_1_rope:"))
    assert "hook at most 2.000 m above its start, 18.000 m below its crown" in hook


GANTRY = """
title = "A gantry crane"

[gravity]
acceleration = [0, 0, -9.81]

[[gantry_cranes]]
name = "gantry"
span = 60
girder_height = 40
sheave_radius = 0.4
block = { mass = 2000 }
rope = { axial_stiffness = 1.5e8 }
trolleys = [{ position = -4, hoists = [{ drop = 25, parts = 4 }] }, { position = 4, hoists = [{ drop = 25, parts = 4 }] }]

[[scenario.phases]]
name = "go"
actions = [{ drive = NAMES, distance = 1, speed = 0.5 }]

[simulate]
step = 0.01
output_interval = 1
duration = 5
"""


def test_a_girder_travels_with_its_trolleys(tmp_path: Path) -> None:
    """Each has a drive of its own: an action that leaves one behind is refused."""
    file = tmp_path / "case.toml"
    for names, missing in (
        ('"gantry_girder.y"', "'gantry_girder.y' without 'gantry_trolley_1.y'"),
        ('["gantry_girder.y", "gantry_trolley_2.y"]', "'gantry_girder.y' without 'gantry_trolley_1.y'"),
        ('"gantry_trolley_2.y"', "'gantry_trolley_2.y' without 'gantry_girder.y'"),
        ('"gantry_girder.x"', "'gantry_girder.x' without 'gantry_trolley_1.x'"),
    ):
        file.write_text(GANTRY.replace("NAMES", names))
        with pytest.raises((InputError, InputErrors)) as refused:
            load_case(tmp_path)
        assert "scenario.phases.0.actions.0.drive" in str(refused.value)
        assert missing in str(refused.value)
    for names in ('["gantry_girder.y", "gantry_trolley_*.y"]', '"gantry_trolley_2.x"', '"gantry_*.y"'):
        file.write_text(GANTRY.replace("NAMES", names))
        load_case(tmp_path)


def test_a_trolley_stays_on_its_girder(tmp_path: Path) -> None:
    """What is certain is refused; what goes on until it is stopped ends the run at the end of the girder."""
    file = tmp_path / "case.toml"
    text = GANTRY.replace("NAMES", '"gantry_trolley_2.x"').replace(
        "speed = 0.5 }]", "speed = 20, ramp = 1 }]"
    )
    far = text.replace("distance = 1,", "distance = 26.5,")
    waits = '\nuntil = { arrived = "gantry_trolley_2.x" }\n[[scenario.phases]]\nname = "end"\n\n[simulate]'
    file.write_text(far.replace("\n[simulate]", waits))
    with pytest.raises(
        InputError, match=r"drives 'gantry_trolley_2' to 30\.5 m from the middle of a girder of 60 m"
    ):
        run_case(load_case(tmp_path), stages=("mesh", "simulate"))
    file.write_text(text.replace("distance = 1,", "distance = 26,").replace("\n[simulate]", waits))
    assert run_case(load_case(tmp_path), stages=("mesh", "simulate")).outcome is Outcome.COMPLETED
    for speed, way in (("20", 30.0), ("-30", -30.0)):
        file.write_text(text.replace("distance = 1, speed = 20", f"speed = {speed}"))
        made = load_case(tmp_path)
        report = run_case(made, stages=("mesh", "simulate"))
        assert report.outcome is Outcome.LIMIT_REACHED
        assert "way of 'gantry_trolley_2' from the middle of its girder" in report.stages[-1].message
        log = load_results(made, made.output_folder).metadata["scenario"]["log"]
        assert log[-1][4] == pytest.approx(way, abs=0.4)
