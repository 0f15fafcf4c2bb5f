"""Tables of inputs in a case file: what they are read as, and what is wrong with them, by file, key and value."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.early_checks import scene_errors
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.report.connections import connection_tables
from heavylift.pipeline.results.storage import OutputFolder

CASE = """
title = "Driven"
gravity = { acceleration = [0, 0, -9.81] }

[bodies.load]
type = "rigid"
mass = "10 t"
centre_of_mass = [0, 0, 0]
inertia = ["10 t m^2", "10 t m^2", "10 t m^2"]
frame = { motion = "free" }

[bodies.mast]
type = "rigid"
mass = "1 t"
inertia = [1, 1, 1]
frame = { motion = "fixed" }

[[joints]]
name = "pin"
type = "hinge"
between = ["ground", "load"]
at = [0, 0, 0]
axis = [0, 1, 0]
DRIVE

[[ropes]]
name = "hoist"
axial_stiffness = "100 MN"
path = [{ body = "ground", point = [0, 0, "20 m"] }, { body = "load", point = ["1 m", 0, 0] }]

[[inputs]]
name = "haul"
type = "winch_speed"
rope = "hoist"
value = "-10 cm/s"

[simulate]
step = "10 ms"
output_interval = "0.1 s"
duration = "1 s"
"""


def case_with(folder: Path, more: str, drive: str = "") -> Path:
    """Folder of a case with more tables."""
    (folder / "case.toml").write_text(CASE.replace("DRIVE", drive) + more, encoding="utf-8")
    return folder


def table(of_type: str, *keys: str) -> str:
    return "\n".join(["[[inputs]]", 'name = "a"', f'type = "{of_type}"', *keys, ""])


PLACE = ('body = "load"', "point = [0, 0, 0]")
BAD = {
    "type": (table("forse"), r"inputs.1: type = 'forse'; expected one of 'drive_position', "),
    "unit": (
        table("force", *PLACE, 'value = "1 m"'),
        r"inputs.1.value: '1 m' is a length; expected a force \[N\]",
    ),
    "not a number": (table("force", *PLACE, "value = nan"), r"inputs.1.value: nan"),
    "unit of a joint": (
        table("joint_load", 'joint = "pin"', 'value = "1 kN"'),
        r"inputs.1.value: '1 kN' is a force",
    ),
    "body": (
        table("force", 'body = "lod"', "point = [0, 0, 0]"),
        r"inputs.1.body: body 'lod' does not exist",
    ),
    "direction": (
        table("moment", *PLACE, "direction = [0, 0, 0]"),
        r"inputs.1.direction: .*that is not zero",
    ),
    "rope": (
        table("winch_speed", 'rope = "hoistt"'),
        r"inputs.1.rope: 'hoistt' is no rope; did you mean 'hoist'",
    ),
    "twice": (table("winch_length", 'rope = "hoist"'), r"inputs.1.rope: 'haul' drives 'hoist' too"),
    "start of a length": (
        table("winch_length", 'rope = "hoist"', "value = 3"),
        r"inputs.1.value: unknown key",
    ),
    "no drive": (table("drive_speed", 'joint = "pin"'), r"inputs.1.joint: 'pin' is no drive"),
    "free frame": (
        table("frame_speed", 'body = "load"', 'axis = "x"'),
        r"inputs.1.body: 'load.x' is no drive",
    ),
    "axis": (
        table("frame_speed", 'body = "mast"', 'axis = "q"'),
        r"inputs.1.axis: 'q'; expected 'x', 'y' or 'z'",
    ),
    "tank": (table("tank_rate", 'tank = "x"'), r"inputs.1.tank: 'x' is no tank"),
    "controller": (
        table("tilt_target", 'controller = "x"', 'keeps = "heel"'),
        r"inputs.1.controller: 'x' is no",
    ),
    "wind": (table("fluid_speed"), r"inputs.1: wind or current 'wind' does not exist"),
    "name": (table("force", *PLACE).replace('"a"', '"load"'), r"inputs.1.name: 'load' occurs 2 times"),
    "range": (
        table("force", *PLACE, "smallest = 2", "largest = 1"),
        r"inputs.1.smallest: 2 is above 'largest', 1",
    ),
    "start": (
        table("force", *PLACE, "largest = -1"),
        r"inputs.1.value: 0 is above 'largest'; expected at most -1",
    ),
    "interpolation": (table("force", *PLACE, 'interpolation = "cubic"'), r"inputs.1.interpolation: 'cubic'"),
    "released joint": (
        table("joint_load", 'joint = "pin"')
        + '[[scenario.phases]]\nname = "p"\nactions = [{ release = "pin" }]\n',
        r"scenario.phases.0.actions.0.*: 'pin' has 'a' along it",
    ),
    "scenario": (
        '[[scenario.phases]]\nname = "p"\nactions = [{ winch = "hoist", speed = 0.1 }]\n',
        r"inputs.0.rope: 'hoist' is commanded by the scenario too",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_a_bad_table_is_one_line_with_its_key(what: str, tmp_path: Path) -> None:
    more, words = BAD[what]
    with pytest.raises(InputError, match=rf"case\.toml: {words}") as caught:
        load_case(case_with(tmp_path, more))
    assert "\n" not in str(caught.value)


def test_inputs_need_a_simulation(tmp_path: Path) -> None:
    text = CASE.replace("DRIVE", "").partition("[simulate]")[0]
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"inputs: needs a \[simulate\] section"):
        load_case(tmp_path)


def test_values_come_in_units_of_their_joints_and_points_in_frames(tmp_path: Path) -> None:
    more = table("drive_speed", 'joint = "pin"', 'value = "90 deg/s"', "largest = 7")
    case = load_case(case_with(tmp_path, more, "drive = { times = [0], speeds = [0] }"))
    assert scene_errors(case) == []
    scene = assemble_scene(case, OutputFolder(case.output_folder))
    haul, turn = scene.inputs
    assert (haul.start, haul.rope) == (-0.1, "hoist")
    np.testing.assert_allclose(turn.value, 0.5 * math.pi, rtol=1e-12)
    assert [case.quantity(f"channel.{name}.value.end").kind.unit for name in ("haul", "a")] == [
        "m/s",
        "rad/s",
    ]


def test_a_run_holds_the_start_values(tmp_path: Path) -> None:
    """The rope gets longer by 0.1 m in a second; the value is a channel, in the report too."""
    case = load_case(case_with(tmp_path, table("force", *PLACE, 'value = "2 kN"')))
    assert run_case(case, stages=("simulate",)).outcome is Outcome.COMPLETED
    results = load_results(case)
    length = results["hoist.rest_length"]
    np.testing.assert_allclose(length[-1] - length[0], 0.1, rtol=1e-9)
    np.testing.assert_array_equal(results["a.value"], 2000.0)
    rows = [row for made in connection_tables(case) if made.header[0] == "input" for row in made.rows]
    assert tuple(rows[0][:3]) == ("haul", "winch speed", "hoist")


def test_a_block_repeats_inputs(tmp_path: Path) -> None:
    more = """
[[repeat]]
count = 2
bodies = { "box_{i}" = { type = "rigid", mass = 1, inertia = [1, 1, 1], frame = { motion = "free" } } }
inputs = [{ name = "push_{i}", type = "force", body = "box_{i}", point = [0, 0, 0] }]
"""
    case = load_case(case_with(tmp_path, more))
    assert [(one.name, getattr(one, "body", "")) for one in case.inputs] == [
        ("haul", ""),
        ("push_0", "box_0"),
        ("push_1", "box_1"),
    ]
