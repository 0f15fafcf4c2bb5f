"""Floating cranes: force and rate of the stay, heights of hooks, slewing, against hand calculations."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case

G = 9.81
CASES = Path(__file__).parents[3] / "cases"

CRANE = """
title = "A boom of 180 m on a hull that stands still"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.hull]
type = "rigid"
mass = 2e7
inertia = [1e9, 1e9, 1e9]
frame = {{ motion = "fixed" }}
initial = {{ position = [10, 20, 5], orientation = {{ axis = [0, 0, 1], angle = "{heading} deg" }} }}

[[floating_cranes]]
name = "crane"
hull = "hull"
hinge = [50, 0, 10]
boom = {{ length = 180, angle = "{angle} deg", mass = {mass} }}
sheave_radius = 0.5
block = {{ mass = 1e6 }}
rope = {{ axial_stiffness = 1e12, damping = 1e7 }}
hooks = [{{ drop = 40, parts = 12{hook} }}]
{more}

[simulate]
start = "equilibrium"
step = 0.02
output_interval = 0.1
duration = {duration}
"""

STAY = "stay = { head = [10, 0, 90], parts = 8, rope = { axial_stiffness = 1e12, damping = 1e7 } }\n"
LUFFING = 'luffing = [{ start = 1, angle = "-10 deg", speed = "1 deg/s", ramp = 2 }]\n'


def text(angle=60, *, mass=10.0, more=STAY, hook="", heading=0.0, duration=0.1):
    """A case."""
    return CRANE.format(angle=angle, mass=mass, more=more, hook=hook, heading=heading, duration=duration)


def run(folder, case_text):
    """Results of a case."""
    (folder / "case.toml").write_text(case_text)
    case = load_case(folder)
    run_case(case, stages=("mesh", "simulate"))
    return load_results(case, case.output_folder)


def arm(angle):
    """Of the stay about the hinge [m]: head of the stay 40 m behind and 80 m above it."""
    tip = 180.0 * np.array([math.cos(angle), math.sin(angle)])
    stay = np.array([-40.0, 80.0]) - tip
    return float(tip[0] * stay[1] - tip[1] * stay[0]) / float(np.linalg.norm(stay))


# by hand, of a boom without weight
@pytest.mark.parametrize(
    ("angle", "share", "lever"),
    [(50, 1.3011, 88.9), (60, 1.0083, 89.3), (70, 0.7116, 86.5), (80, 0.3929, 79.5)],
)
def test_force_of_the_stay(angle, share, lever, tmp_path):
    results = run(tmp_path, text(angle))
    force = 8.0 * float(results["crane_stay.tension"].ravel()[0])
    assert force / (1e6 * G) == pytest.approx(share, abs=1e-4)
    assert arm(math.radians(angle)) == pytest.approx(lever, abs=0.05)


def test_weight_of_the_boom_and_a_hull_that_heads_elsewhere(tmp_path):
    results = run(tmp_path, text(60, mass=2e6, heading=35.0))
    force = 8.0 * float(results["crane_stay.tension"].ravel()[0])
    assert force == pytest.approx((1e6 * G * 90.0 + 2e6 * G * 45.0) / arm(math.radians(60.0)), rel=1e-4)
    ahead = np.array([math.cos(math.radians(35.0)), math.sin(math.radians(35.0))])
    block = results["crane_hook_1_block.position"][0]
    assert block[:2] == pytest.approx(np.array([10.0, 20.0]) + 140.0 * ahead, abs=0.02)
    assert block[2] == pytest.approx(5.0 + 10.0 + 180.0 * math.sin(math.radians(60.0)) - 40.0, abs=0.02)


@pytest.mark.parametrize("own", [False, True])
def test_tensions_at_the_start_and_the_number_of_a_hook(tmp_path, own):
    angle = math.radians(60.0)
    stay = 1e6 * G * 90.0 / arm(angle) / 8.0
    needed = 1e6 * G / 12.0
    hook = f", number = 5, tension = {needed}" if own else ", number = 5"
    soft = text(60, hook=hook).replace('start = "equilibrium"', 'start = "check"')
    soft = soft.replace(
        "axial_stiffness = 1e12, damping = 1e7 } }", f"axial_stiffness = 1e8, tension = {stay} }} }}"
    )
    soft = soft.replace(
        "axial_stiffness = 1e12, damping = 1e7 }",
        f"axial_stiffness = 1e8, tension = {0.5 * needed if own else needed} }}",
    )
    results = run(tmp_path, soft)
    place = results["crane_hook_5_block.position"]
    drawn = [10.0 + 50.0 + 90.0, 20.0, 5.0 + 10.0 + 180.0 * math.sin(angle) - 40.0]
    # without the tensions it would fall by g t^2/2 = 5 cm meanwhile
    assert place[0] == pytest.approx(drawn, abs=1e-9)
    assert place[-1] == pytest.approx(drawn, abs=2e-4)


def falls(results):
    """Of the hook from the head of the boom, and height of that above the hinge [m], by the recorded angle."""
    angle = math.radians(60.0) + results["crane_hinge.angle"].ravel()
    head = 180.0 * np.column_stack([np.cos(angle), np.zeros(len(angle)), np.sin(angle)])
    places = results["crane_hook_1_block.position"] - np.array([60.0, 20.0, 15.0])
    return np.linalg.norm(places - head, axis=1), head[:, 2]


def test_luffing_by_the_stay(tmp_path):
    results = run(tmp_path, text(60, more=STAY + LUFFING, mass=1e6, duration=20))
    angle = results["crane_hinge.angle"].ravel()
    assert math.degrees(angle[-1] - angle[0]) == pytest.approx(-10.0, abs=2e-3)
    length = results["crane_stay.rest_length"].ravel()
    # d(stay)/d(th) = -arm: in the middle of the way
    i = int(np.argmin(np.abs(angle - math.radians(-5.0))))
    slope = (length[i + 5] - length[i - 5]) / (angle[i + 5] - angle[i - 5]) / 8.0
    assert slope == pytest.approx(-arm(math.radians(60.0) + angle[i]), rel=1e-3)
    # the hook swings 40 m below the head of the boom
    away, _ = falls(results)
    assert away == pytest.approx(np.full(len(away), 40.0), abs=1e-3)


# a lead to a drum on deck wraps less about its sheave: a fifth of its radius, 8 mm at the hook
@pytest.mark.slow
@pytest.mark.parametrize("winch", ["", ", winch = [-20, 0, 2]", ", winch = [-20, 6, 2]"])
@pytest.mark.parametrize("stay", ["", STAY])
def test_level_luffing(winch, stay, tmp_path):
    results = run(
        tmp_path, text(60, more=f"{stay}{LUFFING}level = true\n", hook=winch, mass=1e6, duration=20)
    )
    # a hook that hangs still keeps its height if the falls grow as the head rises: it goes down by 18 m here
    away, height = falls(results)
    assert height[0] - height[-1] == pytest.approx(
        180.0 * (math.sin(math.pi / 3) - math.sin(math.pi / 3.6)), abs=5e-3
    )
    assert away - away[0] == pytest.approx(height - height[0], abs=1e-3)


def test_slewing_with_a_drive(tmp_path):
    slew = "[floating_cranes.slewing]\ncentre = [40, 0, 8]\nmass = 1e6\n"
    slew += 'moves = [{ start = 0.5, angle = "6 deg", speed = "0.5 deg/s", ramp = 4 }]\n'
    results = run(tmp_path, text(60, more=slew, mass=1e6, duration=18))
    boom = results["crane_boom.position"][-1]
    turn = math.radians(6.0)
    assert boom == pytest.approx(
        [10.0 + 40.0 + 10.0 * math.cos(turn), 20.0 + 10.0 * math.sin(turn), 15.0], abs=1e-5
    )


def test_a_scenario_slews_and_luffs(tmp_path):
    """Drives that stand until they are told: the tip goes round by 6 degrees, and then up by 4."""
    more = "driven = true\n[floating_cranes.slewing]\ncentre = [40, 0, 8]\nmass = 1e6\ndriven = true\n"
    more += """
[[scenario.phases]]
name = "slew"
actions = [{ drive = "crane_slewing", position = "6 deg", speed = "0.5 deg/s", ramp = 4 }]
until = { arrived = "crane_slewing" }

[[scenario.phases]]
name = "luff"
actions = [{ drive = "crane_hinge", distance = "4 deg", speed = "0.5 deg/s", ramp = 4 }]
"""
    results = run(tmp_path, text(60, more=more, mass=1e6, duration=30))
    turn, up = math.radians(6.0), math.radians(64.0)
    foot = [10.0 + 40.0 + 10.0 * math.cos(turn), 20.0 + 10.0 * math.sin(turn), 15.0]
    assert results["crane_boom.position"][-1] == pytest.approx(foot, abs=1e-5)
    w, x, y, z = results["crane_boom.orientation"][-1]
    along = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)]
    expected = [math.cos(up) * math.cos(turn), math.cos(up) * math.sin(turn), math.sin(up)]
    assert along == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (('"-10 deg"', '"-70 deg"'), "floating_cranes.0.luffing", "the boom comes to -10 degrees"),
        (('"-10 deg"', '"-1 deg"'), "floating_cranes.0.luffing.0.angle", "ramps of 2 s"),
        (
            ("head = [10, 0, 90]", "head = [200, 0, 90]"),
            "floating_cranes.0.stay.head",
            "does not pull the boom",
        ),
        (('hull = "hull"', 'hull = "ship"'), "floating_cranes.0.hull", "'ship' does not exist"),
        (("parts = 12", "parts = 5"), "floating_cranes.0.hooks.0", "5 parts"),
        (("drop = 40", "drop = 18"), "floating_cranes.0.hooks.0.drop", "comes down by 17.9966 m"),
        (
            ("mass = 10.0", "mass = 1e6, centre = 200"),
            "floating_cranes.0.boom.centre",
            "200 m from the hinge",
        ),
        (("parts = 12", "parts = 12, winch = [200, 0, 2]"), "floating_cranes.0.hooks.0", "from the crown"),
        (("level = true", "driven = true"), "floating_cranes.0.driven", "that a stay holds"),
        ((LUFFING, ""), "floating_cranes.0.level", "no 'luffing'"),
    ],
)
def test_errors_stand_at_the_keys_of_the_crane(change, key, words, tmp_path):
    whole = text(60, more=STAY + LUFFING + "level = true\n")
    assert change[0] in whole
    (tmp_path / "case.toml").write_text(whole.replace(*change))
    with pytest.raises(InputError) as refused:
        load_case(tmp_path)
    lines = str(refused.value).splitlines()
    assert f"{key}" in lines[0]
    assert words in lines[0]


@pytest.mark.slow
def test_hooks_share_a_load_that_is_aside_by_moments(tmp_path):
    """Four hooks 16 m apart along and across on a load whose centre of mass is 0.5 m ahead and 0.4 m to the left.

    They are once indeterminate: the moments are those of what hangs on all of them.
    """
    for name in ("case.toml", "crane.nc"):
        shutil.copy(CASES / "floating_crane_lift" / name, tmp_path)
    text = (tmp_path / "case.toml").read_text()
    text = text.replace('mass = "1000 t"', 'mass = "1000 t"\ncentre_of_mass = ["0.5 m", "0.4 m", 0]', 1)
    text = text.replace('duration = "120 s"', "duration = 0")
    text = text[: text.index("[[criteria]]")]
    results = run(tmp_path, text)
    load = np.array([results[f"crane_hook_{i}.hook_load"].ravel()[0] for i in range(1, 5)])
    places = np.array([results[f"crane_hook_{i}_block.position"][0] for i in range(1, 5)])
    centre = results["block.position"][0]
    weight = 1040e3 * G  # with the equalizers
    assert load.sum() == pytest.approx(weight, rel=1e-3)
    from scipy.spatial.transform import Rotation

    q = results["block.orientation"][0][[1, 2, 3, 0]]
    centre = centre + Rotation.from_quat(q).apply([0.5, 0.4, 0.0])
    moment = load @ (places[:, :2] - centre[:2])
    # of ropes that lean, horizontal forces of the lines have levers too; that is what half a percent is for
    assert np.abs(moment).max() < 0.005 * weight * 8.0
    assert np.ptp(load) > 0.05 * load.mean()


@pytest.mark.slow
@pytest.mark.parametrize("model", ["massless", pytest.param("pulleys", marks=pytest.mark.slow)])
def test_rest_of_a_hull_off_its_trim(model, tmp_path):
    folder = tmp_path / "lift"
    shutil.copytree(CASES / "floating_crane_lift", folder, ignore=shutil.ignore_patterns("out"))
    lift = (folder / "case.toml").read_text()
    lift = lift[: lift.index("[report]")].replace('"-43.03520296 m"', '"-3.2 m"')
    if model == "pulleys":
        lift = lift.replace('model = "massless"', 'pulley = { mass = "10 kg" }')
    results = run(folder, lift.replace('duration = "120 s"', 'duration = "0.1 s"'))
    ropes = [12.0 * float(results[f"crane_hook_{i}_rope.tension"].ravel()[0]) for i in range(1, 5)]
    assert sum(ropes) == pytest.approx(1200e3 * G, rel=2e-3)
    of_line = "loader_{}_rope.segment_tension" if model == "massless" else "loader_{}_line_{}.tension"
    lines = np.array(
        [[np.ravel(results[of_line.format(i, j)])[0 if model == "pulleys" else j - 1] for j in range(1, 6)]
         for i in range(1, 5)]
    )  # fmt: skip
    assert lines.mean() == pytest.approx(1000e3 * G / 20.0, rel=2e-3)
    assert np.abs(lines / lines.mean(axis=1, keepdims=True) - 1.0).max() < 5e-3
    # moment of the moved ballast over rho g I + displacement x z_B - weights x their heights
    stiffness = 1025.0 * G * 5102166.667 - 18152.75e3 * G * 1.75
    heights = 11600e3 * 7.0 + 900e3 * 57.5 + 1200e3 * 102.9 - 4452.75e3 * 1.0
    trim = 4452.75e3 * G * (43.035 - 3.2) / (stiffness - G * heights)
    q = results["hull.orientation"][0]
    assert 2.0 * math.asin(float(np.linalg.norm(q[1:]))) == pytest.approx(trim, rel=0.03)
