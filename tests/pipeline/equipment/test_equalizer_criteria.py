"""Criteria on equalizers: statics by hand, the same with pulleys and without their masses, and what is told."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.checks.hanging import hanging_warnings
from tests.pipeline.judged import judged_checks, judged_criteria

EA, DEPTH, RADIUS, BELOW = 6e8, 3.0, 0.4, 26.0
REACH = (2.4, 3.1, 3.1, 3.6)  # depths at which the lines reach their lugs
LOW, HIGH = 2.5, 3.5  # of the stops
ASIDE = 2.0  # by which the third lug is beside its guide

# outlets at 39.5 m, lugs at 13.5 m; line 1 is too long and slack at the upper stop, line 4 too short, at the lower one
CASE = """
title = "Four lines of different lengths"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.box]
type = "rigid"
mass = "300 t"
inertia = [3e6, 3e6, 5e6]
frame = {{ motion = "fixed" }}
initial = {{ position = [0, 0, 11] }}

[[equalizers]]
name = "loader"
{model}
hook = {{ body = "ground", point = [0, 0, 41] }}
sheave_radius = {radius}
part_length = {depth}
beam = {{ mass = "15 t" }}
travel = {{ up = 0.5, down = 0.5, {stops} at_stops = true }}
rope = {{ axial_stiffness = {EA} }}
line = {{ axial_stiffness = {EA} }}
lines = [
{lines}
]

[[rope_groups]]
name = "all"
ropes = ["{group}"]
breaking_load = "4 MN"

[[criteria]]
name = "sling"
type = "sling"
ropes = ["loader_*"]
breaking_load = "8 MN"
termination_factor = 1.25

[[criteria]]
name = "shackle"
type = "shackle"
ropes = ["loader_*"]
working_load_limit = "2 MN"

[[criteria]]
name = "slack"
type = "slack"
ropes = ["loader_*"]

[[criteria]]
name = "angle"
type = "sling_angle"
ropes = ["loader_*"]

[[criteria]]
name = "rope"
type = "limit"
quantity = "channel.loader_rope.tension.max"
maximum = "2 MN"
{more}

[simulate]
start = "equilibrium"
step = 0.01
output_interval = 0.01
duration = 0.05
"""


def lugs():
    """Lugs along the beam, and lengths of the lines that reach them at those depths."""
    guides = [1.6 * (i - 1.5) for i in range(4)]
    aside = [0.0, 0.0, ASIDE, 0.0]
    return [(x + a, math.hypot(BELOW - z, a)) for x, a, z in zip(guides, aside, REACH, strict=True)]


def by_hand():
    """Forces of the lines, and tension of the rope: pulleys 2 and 3 share, 1 and 4 are at their stops."""
    lengths = [length for _, length in lugs()]
    excess = LOW + REACH[1] + REACH[2] + HIGH - 4 * DEPTH
    whole = 8 * DEPTH + 7 * math.pi * RADIUS
    compliance = whole / (4 * EA)
    for k in (1, 2):
        cosine = (BELOW - REACH[k]) / lengths[k]
        compliance += lengths[k] / (EA * cosine**2)
    both = excess / compliance
    at_stop = EA / lengths[3] * (REACH[3] - HIGH)
    return [0.0, both, both * lengths[2] / (BELOW - REACH[2]), at_stop], 0.5 * both


def lift(folder: Path, model: str, more: str = "") -> Path:
    lines = "\n".join(
        f'    {{ body = "box", point = [{x}, 0, 2.5], length = {length!r} }},' for x, length in lugs()
    )
    light = model == "pulleys"
    text = CASE.format(
        model='pulley = { mass = "1 kg" }' if light else 'model = "massless"',
        stops="stiffness = 1e12," if light else "",
        group="loader_line_*" if light else "loader_rope",
        radius=RADIUS,
        depth=DEPTH,
        EA=EA,
        lines=lines,
        more=more,
    )
    folder.mkdir()
    (folder / "case.toml").write_text(text)
    return folder


@pytest.mark.parametrize("model", ["massless", "pulleys"])
def test_criteria_on_an_equalizer_judge_its_lines(model, tmp_path):
    """The same numbers with both models: those of statics by hand, and those of the group of ropes."""
    case = load_case(lift(tmp_path / "lift", model))
    run_case(case, stages=("simulate",))
    found = {one.name: one for one in judged_criteria(case, case.output_folder)}
    results = load_results(case, case.output_folder)
    forces, rope = by_hand()
    close = 1e-3 if model == "pulleys" else 1e-5
    assert forces[3] > forces[2] > forces[1] > 1.5 * rope > 0.0
    largest = max(forces)
    assert found["sling"].value == pytest.approx(largest, rel=close)
    assert found["sling"].utilisation == pytest.approx(largest / (8e6 / (1.25 * 1.3 * 1.3 * 1.5)), rel=close)
    assert not found["shackle"].passed
    assert found["shackle"].utilisation == pytest.approx(largest / 2e6, rel=close)
    assert not found["slack"].passed
    assert found["slack"].value == 0.0
    stretched = lugs()[2][1] * (1.0 + forces[2] / EA)
    assert found["angle"].value == pytest.approx(math.acos(ASIDE / stretched), abs=1e-4)
    assert found["rope"].value == pytest.approx(rope, rel=close)
    assert results["all.largest_tension"][0] == pytest.approx(largest, rel=close)
    assert results["all.smallest_tension"][0] == 0.0
    line = {"massless": "loader_rope line {}", "pulleys": "loader_line_{}"}[model]
    assert found["sling"].where == line.format(4)
    assert found["shackle"].where == line.format(4) + " (WLL)"
    assert found["slack"].where == line.format(1)
    assert found["angle"].where == line.format(3)
    assert found["angle"].note == f"never carries: {line.format(1)}"
    assert found["rope"].warns == (model == "massless")  # the tension of no line
    (told,) = hanging_warnings(case, results)
    assert told == (
        "'loader' does not share its load evenly: line 1 carries nothing all the time, pulley 1 is at its upper stop "
        "all the time, pulley 4 is at its lower stop all the time"
    )


@pytest.mark.parametrize("model", ["massless", "pulleys"])
def test_a_phase_that_waits_for_taut_ropes_waits_for_all_lines(model, tmp_path):
    """Line 1 never carries."""
    phases = '[scenario]\nphases = [{ name = "wait", until = { taut = ["loader_*"] } }]'
    case = load_case(lift(tmp_path / "lift", model, phases))
    run_case(case, stages=("simulate",))
    assert load_results(case, case.output_folder)["scenario.phase"][-1] == 1.0


def test_extremes_of_lines_are_those_of_all_steps(tmp_path):
    """Bit for bit those of a run that records every step."""
    found = {}
    for interval in (0.01, 0.05):
        folder = lift(tmp_path / f"every_{interval}", "massless")
        file = folder / "case.toml"
        text = file.read_text().replace('"fixed"', '"free"').replace("at_stops", "damping = 0, at_stops")
        text = text.replace("output_interval = 0.01", f"output_interval = {interval}")
        file.write_text(
            text.replace('start = "equilibrium"\n', "").replace("duration = 0.05", "duration = 0.5")
        )
        case = load_case(folder)
        run_case(case, stages=("simulate",))
        found[interval] = load_results(case, case.output_folder)
    every = np.asarray(found[0.01]["loader_rope.segment_tension"])
    for side, extreme in (("max", np.max), ("min", np.min)):
        coarse = np.asarray(found[0.05][f"loader_rope.segment_tension_{side}"])
        wanted = np.array([extreme(every[5 * k - 4 : 5 * k + 1], axis=0) for k in range(1, 11)])
        np.testing.assert_array_equal(coarse[1:], wanted)
    assert np.ptp(every[:, 3]) > 0.0


def test_a_load_that_rolls_to_another_rest_is_told(tmp_path):
    """One equalizer holds a load as one point does: a load drawn 8 deg off the vertical above its rest turns to it."""
    folder = tmp_path / "roll"
    folder.mkdir()
    (folder / "case.toml").write_text(
        """
title = "A load that is drawn askew"

[gravity]
acceleration = [0, 0, -10]

[bodies.load]
type = "rigid"
mass = 1000
centre_of_mass = [0.1405408347, 0, -1]
inertia = [100, 100, 100]
frame = { motion = "free" }

[[ropes]]
name = "sling"
axial_stiffness = 1e8
path = [{ body = "ground", point = [0, 0, 5] }, { body = "load", point = [0, 0, 0] }]

[simulate]
start = "equilibrium"
step = 0.01
output_interval = 0.01
duration = 0.01
"""
    )
    case = load_case(folder)
    run_case(case, stages=("simulate",))
    (told,) = hanging_warnings(case, load_results(case, case.output_folder))
    assert told == "at rest bodies are tilted against their initial positions: 'load' by 8 deg"


@pytest.mark.parametrize("model", ["massless", "pulleys"])
def test_a_check_on_the_rope_over_pulleys_says_what_it_does_not_see(model, tmp_path):
    """A limit on all tensions of the equalizer: without masses of pulleys its lines are no channels of their own."""
    more = '[[check]]\nid = "all"\nquantity = "channel.loader_*.tension.max"\nmaximum = "9 MN"\nsource = "a limit"\n'
    case = load_case(lift(tmp_path / "lift", model, more))
    run_case(case, stages=("simulate",))
    (check,) = judged_checks(case, case.output_folder)
    assert ("its lines have loader_rope.segment_tension" in check.note) == (model == "massless")
