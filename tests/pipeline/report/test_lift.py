"""The section of a report on a lift: its tables against hand calculations, its charts, its phases."""

from __future__ import annotations

import math

import pytest

from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.report.document import Album, Figure, Table
from heavylift.pipeline.report.lift import lift_section

LIFT = """
title = "A load on three slings that is hoisted in two phases"

[gravity]
acceleration = [0, 0, -10]

[bodies.load]
type = "rigid"
mass = "3 t"
inertia = [4000, 4000, 4000]
frame = { motion = "free" }

[[falls]]
name = "crane"
crown = { body = "ground", point = [0, 0, 27] }
parts = 4
sheave_radius = 0.4
drop = 20
block = { mass = 500, hook_depth = 1 }
rope = { axial_stiffness = 1e10, damping = 1e5 }

[[repeat]]
count = 3

[[repeat.ropes]]
name = "sling_{i}"
axial_stiffness = 1e9
damping = 1e5
path = [{ body = "crane_block", point = [0, 0, -1] }, { body = "load", point = ["{3*(i - 1)}", "{(i % 2)*4 - 2}", 0] }]

[[repeat.lugs]]
name = "lug_{i}"
body = "load"
rope = "sling_{i}"
normal = [0, 1, 0]

[[rope_groups]]
name = "slings"
ropes = ["sling_*"]
breaking_load = "20 kN"

[[relative_motions]]
name = "to_boom"
between = ["ground", "load"]
points = [[3, 4, 27], [0, 0, 0]]

[scenario]

[[scenario.phases]]
name = "wait"
until = { time = "0.5 s" }

[[scenario.phases]]
name = "hoist"
actions = [{ winch = "crane_rope", speed = "0.4 m/s", ramp = "0.2 s" }]
until = { time = "0.5 s" }

[simulate]
start = "equilibrium"
step = 0.005
output_interval = 0.05
duration = 2
"""


@pytest.fixture(scope="module")
def lift(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lift")
    (folder / "case.toml").write_text(LIFT)
    case = load_case(folder)
    run_case(case, stages=("simulate",))
    (folder / "report").mkdir()
    results = load_results(case, case.output_folder)
    return results, lift_section(case, results, Album(folder / "report"))


def tables(section):
    return {item.header[0]: item for item in section.items if isinstance(item, Table)}


@pytest.mark.slow
def test_what_hangs_on_the_hook_and_in_the_slings(lift):
    """Slings to (-3, -2), (0, 2), (3, -2), 6 m below: half of 30 kN on the middle one, a quarter on the others."""
    results, (section,) = lift
    found = tables(section)
    name, start, _mean, largest, _smallest, ropes, _factor, when = found["hook"].rows[0]
    assert (name, float(start)) == ("crane", pytest.approx(30.0, rel=1e-3))
    assert found["hook"].header[1] == "at the start [kN]"
    assert float(largest) == pytest.approx(results["crane.hook_load_max"].max() / 1e3, rel=1e-3)
    assert float(largest) > 30.1
    assert float(ropes) > float(largest)  # the block hangs on them, too
    assert when.endswith(", hoist")
    forces = {row[0]: [float(value) for value in row[2:6]] for row in found["lug"].rows}
    middle = 15.0 * math.sqrt(40.0) / 6.0
    assert results["lug_1.force"].ravel()[0] / 1e3 == pytest.approx(middle, rel=1e-3)
    assert forces["lug_1"][3] == pytest.approx(-math.degrees(math.asin(2.0 / math.sqrt(40.0))), rel=5e-3)
    assert forces["lug_0"][3] == pytest.approx(math.degrees(math.asin(2.0 / 7.0)), rel=5e-3)
    assert forces["lug_0"][0] ** 2 == pytest.approx(
        forces["lug_0"][1] ** 2 + forces["lug_0"][2] ** 2, rel=2e-3
    )
    (group,) = found["ropes"].rows
    assert float(group[1]) == pytest.approx(forces["lug_1"][0], rel=1e-3)
    assert group[4] == f"{100.0 * results['slings.utilisation_max'].max():.3g} %"
    assert group[5] == "0 s"
    distance, radius = found["between"].rows[0][1:3]
    assert float(distance) < math.hypot(3.0, 4.0, 27.0)
    assert radius == "5 to 5"


def test_its_charts_and_what_has_nothing_to_tell(lift):
    _, (section,) = lift
    figures = [item.file for item in section.items if isinstance(item, Figure)]
    assert figures == ["lift_hook_loads.png", "lift_spread_of_tensions.png", "lift_clearance.png"]


def test_a_case_that_lifts_nothing_has_no_such_section(tmp_path):
    text = LIFT[: LIFT.index("[[falls]]")] + LIFT[LIFT.index("[simulate]") :]
    (tmp_path / "case.toml").write_text(
        text.replace('start = "equilibrium"', "").replace("duration = 2", "duration = 0.1")
    )
    case = load_case(tmp_path)
    run_case(case, stages=("simulate",))
    assert lift_section(case, load_results(case, case.output_folder), Album(tmp_path)) == []
    assert lift_section(case, None, Album(tmp_path)) == []
