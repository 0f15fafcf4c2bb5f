"""Criteria of three lifts, from run to verdict, against hand calculations with the clauses, to three digits."""

from __future__ import annotations

import math

import pytest

from heavylift.pipeline import load_case, run_case
from tests.pipeline.judged import judged_criteria

G = 9.81
HEAD = """
title = "A lift by hand"

[gravity]
acceleration = [0, 0, -9.81]

[simulate]
start = "equilibrium"
step = 0.005
output_interval = 0.05
duration = 0
"""

BLOCK = """
[bodies.load]
type = "rigid"
mass = "{tons} t"
inertia = [2e7, 3e7, 4e7]
centre_of_mass = [{aside}, 0, 0]
frame = {{ motion = "free" }}
"""


def criteria(folder, text):
    """Lines of the criteria of a case, by name and what they are; the first ones of a name by that alone."""
    (folder / "case.toml").write_text(HEAD + text)
    case = load_case(folder)
    report = run_case(case, stages=("mesh", "simulate"))
    assert report.outcome.name == "COMPLETED", report.message
    found = {}
    for line in judged_criteria(case, case.output_folder):
        found.setdefault(line.name, []).append(line)
    return found


def same(value):
    return pytest.approx(value, rel=1e-3)


ONE_HOOK = """
[[falls]]
name = "crane"
crown = { body = "ground", point = [0, 0, 39.5] }
parts = 12
sheave_radius = 0.5
drop = 30
block = { mass = "10 t", hook_depth = 1.5 }
rope = { axial_stiffness = 1e10 }

[[repeat]]
count = 4

[[repeat.ropes]]
name = "sling_{i}"
axial_stiffness = 1e10
path = [
    { body = "crane_block", point = [0, 0, -1.5] },
    { body = "load", point = ["{6 - 12*(i % 2)}", "{4.5 - 9*(i // 2)}", 0] },
]

[[repeat.lugs]]
name = "lug_{i}"
body = "load"
rope = "sling_{i}"
normal = ["{4.5 - 9*(i // 2)}", "{12*(i % 2) - 6}", 0]

[[lugs]]
name = "turned"
body = "load"
rope = "sling_0"
normal = [0, 1, 0]

[[criteria]]
name = "crane"
type = "crane"
load = "crane.rope_load"
curve = { radius = [15, 25], capacity = ["600 t", "450 t"] }
radius = 20
dynamic_factor = 1.05
static_at = "start"

[[criteria]]
name = "sling"
type = "sling"
ropes = ["sling_*"]
breaking_load = "600 t"
termination_factor = 1.25
dynamic_factor = 1.05
static_at = "start"
skew_factor = 1.25

[[criteria]]
name = "shackle"
type = "shackle"
ropes = ["sling_*"]
working_load_limit = "200 t"
breaking_load = "800 t"
dynamic_factor = 1.05
static_at = "start"
skew_factor = 1.25

[[criteria]]
name = "lug"
type = "lug"
lugs = ["lug_*"]
in_plane = "200 t"
out_of_plane = "6 t"
dynamic_factor = 1.05
static_at = "start"
skew_factor = 1.25
yaw_factor = 1.05

[[criteria]]
name = "turned_lug"
type = "lug"
lugs = ["turned"]
out_of_plane = "100 t"

[[criteria]]
name = "angle"
type = "sling_angle"
ropes = ["sling_*"]

[[criteria]]
name = "factor"
type = "dynamic_factor"
load = "crane.hook_load"
operation = "onshore"
static_at = "start"
"""


@pytest.mark.slow
def test_a_block_of_400_t_on_four_slings_of_one_hook(tmp_path):
    """Hook 8 m above lugs at (6, 4.5): slings of sqrt(6^2 + 4.5^2 + 8^2) = 10.966 m, a quarter of the weight each."""
    found = criteria(tmp_path, BLOCK.format(tons=400, aside=0) + ONE_HOOK)
    (crane,) = found["crane"]
    # SHL with the block 410 t, DHL 430.5 t; between 600 and 450 t at 20 m: 525 t
    assert (crane.value, crane.limit) == (same(410e3 * G * 1.05), same(525e3 * G))
    assert crane.utilisation == same(0.82)
    force = 100e3 * G * math.sqrt(120.25) / 8.0
    (sling,) = found["sling"]
    # max(1.3 x 1.3 x 1.25 x 1.5, 2.3 x 1.25) = 3.169
    assert (sling.value, sling.limit) == (same(force * 1.05 * 1.25), same(600e3 * G / 3.16875))
    assert (sling.utilisation, sling.passed) == (same(0.9502), True)
    (shackle,) = found["shackle"]
    # WLL x DAF = 210 t, MBL / 3 = 266.7 t
    assert (shackle.value, shackle.limit) == (same(force * 1.3125), same(210e3 * G))
    angle, inside, across = found["lug"]
    point = force * 1.05 * 1.25 * 1.05  # share x DAF x SKL x yaw
    assert angle.value == pytest.approx(0.0, abs=1e-4)
    assert (inside.value, inside.utilisation) == (same(point), same(point / (200e3 * G)))
    assert across.value == same(0.03 * point)
    angle, across = found["turned_lug"]
    assert math.degrees(angle.value) == same(math.degrees(math.asin(4.5 / math.sqrt(120.25))))
    assert (angle.passed, across.value) == (False, same(force * 4.5 / math.sqrt(120.25)))
    (angle,) = found["angle"]
    assert math.degrees(angle.value) == same(math.degrees(math.atan2(8.0, 7.5)))
    (factor,) = found["factor"]
    assert (factor.value, factor.limit) == (same(1.0), 1.05)  # of 300 to 1000 t onshore


TWO_HOOKS = """
[[ropes]]
name = "fore"
axial_stiffness = 1e12
path = [{ body = "ground", point = [10, 0, 50] }, { body = "load", point = [10, 0, 5] }]

[[ropes]]
name = "aft"
axial_stiffness = 1e12
path = [{ body = "ground", point = [-10, 0, 50] }, { body = "load", point = [-10, 0, 5] }]

[[relative_motions]]
name = "to_boom"
between = ["ground", "load"]
points = [[12, 0, 25], [14, 0, 5]]

[[relative_motions]]
name = "reach"
between = ["ground", "load"]
points = [[-30, 10, 0], [10, 0, 5]]

[[criteria]]
name = "fore_hook"
type = "crane"
load = "fore.tension"
additional = "40 t"
curve = { radius = [30, 50], capacity = ["1200 t", "900 t"] }
radius_channel = "reach.radius"
dynamic_factor = 1.08
static_at = "start"

[[criteria]]
name = "slings"
type = "sling"
ropes = ["fore", "aft"]
breaking_load = "4000 t"
termination_factor = 1.0
bending_ratio = 16
material_factor = 1.35
wear_factor = 1.1
dynamic_factor = 1.08
static_at = "end"
yaw_factor = 1.05

[[criteria]]
name = "clear"
type = "clearance"
distance = "to_boom.distance"
place = "to_boom"

[[criteria]]
name = "level"
type = "tilt"
body = "load"
maximum = "3 deg"

[[criteria]]
name = "taut"
type = "slack"
ropes = ["fore", "aft"]

[[criteria]]
name = "factor"
type = "dynamic_factor"
load = "sum(*.tension)"
operation = "inshore"
static_load = "1200 t"
"""


def test_a_module_of_1200_t_on_two_hooks(tmp_path):
    """The centre of mass 2 m ahead of the middle of hooks 20 m apart: 0.6 and 0.4 of the weight."""
    found = criteria(tmp_path, BLOCK.format(tons=1200, aside=2) + TWO_HOOKS)
    hook, radius = found["fore_hook"]
    at = math.hypot(40.0, 10.0)
    capacity = 1200.0 - 300.0 * (at - 30.0) / 20.0
    assert (hook.value, hook.limit) == (same((720e3 + 40e3) * G * 1.08), same(capacity * 1e3 * G))
    assert hook.utilisation == same(760.0 * 1.08 / capacity)
    assert radius.value == same(at)
    (sling,) = found["slings"]
    reduction = 1.0 / (1.0 - 0.5 / 4.0)  # D/d = 16: 1.143, and a socket
    factor = max(1.3 * 1.3 * reduction * 1.1 * 1.35, 2.3 * reduction * 1.1)
    assert (sling.value, sling.limit) == (same(720e3 * G * 1.08 * 1.05), same(4000e3 * G / factor))
    assert sling.where.startswith("fore")
    (clear,) = found["clear"]
    assert (clear.value, clear.limit) == (same(math.hypot(2.0, 20.0)), 3.0)
    (level,) = found["level"]
    assert level.value < 1e-3
    (taut,) = found["taut"]
    assert (taut.value, taut.where) == (same(480e3 * G), "aft")
    (factor,) = found["factor"]
    assert (factor.value, factor.limit) == (same(1.0), 1.08)  # of 1000 to 2500 t inshore


EQUALIZED = """
[[equalizers]]
name = "loader"
hook = { body = "ground", point = [0, 0, 41] }
sheave_radius = 0.4
part_length = 3
beam = { mass = "15 t" }
pulley = { mass = "1 t" }
travel = { up = 2, down = 2 }
rope = { axial_stiffness = 6e8 }
line = { axial_stiffness = 6e8 }
lines = [
    { body = "load", point = [-3.2, 0, 2.5], length = 24 },
    { body = "load", point = [-1.6, 0, 2.5], length = 24 },
    { body = "load", point = [0, 0, 2.5], length = 24 },
    { body = "load", point = [1.6, 0, 2.5], length = 24 },
    { body = "load", point = [3.2, 0, 2.5], length = 24 },
]

[[rope_groups]]
name = "lines"
ropes = ["loader_line_*"]
breaking_load = "2.5 MN"

[[criteria]]
name = "line"
type = "sling"
ropes = ["loader_line_*"]
breaking_load = "2.5 MN"
termination_factor = 1.1
bending_ratio = 18
dynamic_factor = 1.25
static_at = "start"

[[criteria]]
name = "rope"
type = "sling"
ropes = ["loader_rope"]
breaking_load = "1.6 MN"
termination_factor = 1.0
material_factor = 1.0

[[criteria]]
name = "used"
type = "limit"
quantity = "channel.lines.utilisation.max"
maximum = 0.3

[[criteria]]
name = "spread"
type = "limit"
quantity = "channel.lines.spread.max"
maximum = 0.02

[[criteria]]
name = "factor"
type = "dynamic_factor"
load = "lines.total_tension"
operation = "offshore"
static_at = "start"
"""


@pytest.mark.slow
def test_a_box_of_300_t_on_an_equalizer(tmp_path):
    """Five equal lines: 588.6 kN each, the rope half of one and of its pulley."""
    text = BLOCK.format(tons=300, aside=0).replace("[2e7, 3e7, 4e7]", "[3e6, 3e6, 5e6]")
    text += "[bodies.load.initial]\nposition = [0, 0, 10]\n"
    found = criteria(tmp_path, text + EQUALIZED)
    (line,) = found["line"]
    reduction = 1.0 / (1.0 - 0.5 / math.sqrt(18.0))
    assert reduction == same(1.1336)
    assert (line.value, line.limit) == (same(588.6e3 * 1.25), same(2.5e6 / (1.3 * 1.3 * reduction * 1.5)))
    assert line.utilisation == same(0.8457)
    (rope,) = found["rope"]
    assert (rope.value, rope.limit) == (
        same(0.5 * (588.6e3 + 9.81e3)),
        same(1.6e6 / 2.3),
    )  # 1.69 is less than 2.3
    assert found["used"][0].value == same(588.6 / 2500.0)
    assert found["spread"][0].value == pytest.approx(0.0, abs=1e-4)
    (factor,) = found["factor"]
    assert (factor.value, factor.limit) == (same(1.0), 1.25)  # of 100 to 300 t offshore
