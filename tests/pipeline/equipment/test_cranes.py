"""Falls and gantry cranes: stiffness, speeds and hook loads against closed forms, and what is refused."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.equipment.moves import speeds_of
from heavylift.solver.drive import pack_profile, profile_value
from heavylift.solver.scene.bodies import Profile

G = 9.81
CASES = Path(__file__).parents[3] / "cases"

FALLS = """
title = "Falls"

[gravity]
acceleration = [0, 0, -9.81]

[[falls]]
name = "hook"
crown = {{ body = "ground", point = [0, 0, 40] }}
parts = {parts}
sheave_radius = 0.5
drop = 40
block = {{ mass = {mass} }}
rope = {{ axial_stiffness = 256.5e6 }}
{more}

[simulate]
start = "equilibrium"
step = 0.01
output_interval = 0.1
duration = {duration}
"""


TWO_DRUMS = """drum = { body = "ground", point = [-6, 0, 40] }
other_drum = { body = "ground", point = [6, 0, 40] }
"""


def run(folder: Path, text: str):
    """Results of a case."""
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text)
    case = load_case(folder)
    run_case(case, stages=("mesh", "simulate"))
    return load_results(case, case.output_folder)


@pytest.mark.parametrize("parts", [2, 4, 12, 24])
def test_stiffness_of_falls(parts, tmp_path):
    heights, length = [], 0.0
    for mass in (100e3, 200e3):
        results = run(tmp_path / "falls", FALLS.format(parts=parts, mass=mass, more="", duration=0.1))
        heights.append(results["hook_block.position"][0][2])
        length = float(results["hook_rope.rest_length"].ravel()[0])
        assert float(results["hook_rope.tension"].ravel()[0]) == pytest.approx(mass * G / parts, rel=1e-5)
    # n^2 EA/(n H + l), with the arcs as the rest of the rope: half turns about n - 1 sheaves
    assert length == pytest.approx(parts * 40.0 + (parts - 1) * math.pi * 0.5, rel=1e-5)
    assert 100e3 * G / (heights[0] - heights[1]) == pytest.approx(parts**2 * 256.5e6 / length, rel=1e-3)


def test_a_drum_aside_and_the_speed_of_the_hook(tmp_path):
    more = """
drum = { body = "ground", point = [-6, 0, 40] }
along = [2, 0, 0]
moves = [{ start = 1, distance = 0.5, speed = 0.05, ramp = 2 }, { start = 13, distance = -0.2, speed = 0.1, ramp = 1 }]
"""
    results = run(tmp_path / "drum", FALLS.format(parts=4, mass=100e3, more=more, duration=17))
    # the lead touches the sheave where its tangent does, and leaves straight down: a wrap of pi/2 + asin(r/6)
    lead = math.sqrt(36.0 - 0.25) + 0.5 * (0.5 * math.pi + math.asin(0.5 / 6.0))
    length = results["hook_rope.rest_length"].ravel()
    assert length[0] == pytest.approx(4 * 40.0 + 3 * 0.5 * math.pi + lead, rel=1e-5)
    assert length[0] - length[-1] == pytest.approx(4 * 0.3, abs=1e-12)
    height = results["hook_block.position"][:, 2]
    assert (height[60] - height[40]) / 2.0 == pytest.approx(0.05, rel=5e-3)
    assert np.abs(results["hook_lead.lead_angle"]).max() < 1e-3


def lead_line_factors():
    """Rows of a table of the handbook's formula: 1/efficiency, parts, drum line over the load."""
    text = (Path(__file__).parent / "reeving_lead_line.csv").read_text()
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    return [(float(row["K"]), int(row["parts"]), float(row["lead_line_factor"])) for row in rows]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "parts", "expected"),
    [row for row in lead_line_factors() if row[:2] in {(1.02, 4), (1.04, 4), (1.09, 4), (1.04, 12)}],
)
@pytest.mark.parametrize("drum", ["drum", "other_drum"])
def test_the_drum_line_pulls_by_the_lead_line_factor(ratio, parts, expected, drum, tmp_path):
    more = f"""
efficiency = {1.0 / ratio}
{drum} = {{ body = "ground", point = [{-6 if drum == "drum" else 6}, 0, 40] }}
moves = [{{ start = 0.5, distance = 1, speed = 0.1, ramp = 2 }}]
"""
    text = FALLS.format(parts=parts, mass=100e3, more=more, duration=10)
    results = run(tmp_path / "lead", text.replace("256.5e6", "256.5e6, damping = 2e5"))
    tensions = results["hook_rope.segment_tension"][60:100]  # it hoists with a constant speed
    lead, others = (
        (tensions[:, 0], tensions[:, 1:]) if drum == "drum" else (tensions[:, -1], tensions[:, :-1])
    )
    assert lead / others.sum(axis=1) == pytest.approx(expected, rel=1e-6)
    assert lead.mean() / (100e3 * G) == pytest.approx(expected, rel=1e-3)


def test_two_drums_haul_in_together(tmp_path):
    results = run(tmp_path / "drums", FALLS.format(parts=4, mass=100e3, more=TWO_DRUMS, duration=0.1))
    lead = math.sqrt(36.0 - 0.25) + 0.5 * (0.5 * math.pi + math.asin(0.5 / 6.0))
    length = float(results["hook_rope.rest_length"].ravel()[0])
    assert length == pytest.approx(4 * 40.0 + 3 * 0.5 * math.pi + 2.0 * lead, rel=1e-5)
    assert float(results["hook_rope.tension"].ravel()[0]) == pytest.approx(25e3 * G, rel=1e-5)


def test_two_drums_haul_over_sheaves_that_rub(tmp_path):
    """Each carries half: parts from a drum to the middle have eta, eta^2 of its tension; the middle sheave rests."""
    eta = 0.95
    more = TWO_DRUMS + f"efficiency = {eta}\nmoves = [{{ start = 0.5, distance = 1, speed = 0.1, ramp = 2 }}]"
    text = FALLS.format(parts=4, mass=100e3, more=more, duration=9)
    results = run(tmp_path / "drums", text.replace("256.5e6", "256.5e6, damping = 2e5"))
    tensions = results["hook_rope.segment_tension"][60]  # it hoists with a constant speed
    np.testing.assert_allclose(tensions / tensions[0], [1, eta, eta**2, eta**2, eta, 1], rtol=1e-5)
    assert tensions[0] == pytest.approx(100e3 * G / (2.0 * (eta + eta**2)), rel=1e-3)
    speeds = results["hook_rope.sheave_speed"][60]
    np.testing.assert_allclose(speeds, [-0.2, -0.1, 0.0, 0.1, 0.2], atol=2e-4)


HAULED = """
title = "A rope over a yoke and a sheave, with two winches"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.load]
type = "rigid"
mass = "2 t"
inertia = [1e3, 1e3, 1e3]
frame = { motion = "free" }
initial = { position = [0.6, 0, 0] }

[[ropes]]
name = "rope"
axial_stiffness = "100 MN"
damping = "100 kN s/m"
tension = "9.81 kN"
path = [
    { body = "ground", point = [-6, 0, 10.3] },
    { body = "ground", point = [0, 0, 10], radius = 0.3, axis = [0, 1, 0], friction = 0.15 },
    { body = "load", point = [0, 0, 0], radius = 0.3, axis = [0, -1, 0], efficiency = 0.96 },
    { body = "ground", point = [0.9, 0, 10] },
]
winch = { times = [0, 1], speeds = [0, 0.2] }
other_winch = { times = [0, 1], speeds = [0, 0.05] }

[simulate]
step = 0.01
output_interval = 0.1
duration = 4
"""


def test_two_winches_and_a_yoke_in_a_case(tmp_path):
    results = run(tmp_path / "rope", HAULED)
    lead, first, second = results["rope.segment_tension"][-1]
    assert first / second == pytest.approx(1.0 / 0.96, rel=1e-9)  # the slower winch at the last end gives way
    assert lead / first == pytest.approx(math.exp(0.15 * math.pi / 2), rel=1e-6)
    assert first + second == pytest.approx(2e3 * G, rel=1e-5)
    assert results["load.velocity"][-1][2] == pytest.approx(0.125, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (("parts = 12", "parts = 5"), "falls.0.parts", "5 parts; expected an even number"),
        (("drop = 40", "drop = 0.8"), "falls.0.drop", "0.8 m with sheaves of 0.5 m"),
        (
            ("block =", "moves = [{ start = 0, distance = 39.5, speed = 1 }]\nblock ="),
            "falls.0.moves",
            "hoisted by 39.5 m",
        ),
        (
            ("block =", "moves = [{ start = 0, distance = 1, speed = 1 }]\nblock ="),
            "falls.0.moves.0.distance",
            "ramps of 5 s to 1 m/s take 5 m",
        ),
        (
            ("block =", 'drum = { body = "ground", point = [6, 0, 40] }\nblock ='),
            "falls.0.drum.point",
            "6 m from the crown along 'along'",
        ),
        (
            (
                "256.5e6 }",
                "256.5e6, fastest = 1.1 }\nmoves = [{ start = 0, distance = 1, speed = 0.1 }]",
            ),
            "falls.0.rope",
            "1.2 m/s, above the largest speed of the winch, 1.1 m/s",
        ),
        (
            ('"ground", point = [0, 0, 40]', '"jib", point = [0, 0, 40]'),
            "falls.0.crown.body",
            "'jib' does not exist",
        ),
    ],
)
def test_one_error_with_the_key_of_the_falls(change, key, words, tmp_path):
    text = FALLS.format(parts=12, mass=1e5, more="", duration=1)
    assert change[0] in text
    (tmp_path / "case.toml").write_text(text.replace(*change))
    with pytest.raises(InputError) as refused:
        load_case(tmp_path)
    (line,) = str(refused.value).splitlines()
    assert f"{key}: " in line
    assert words in line


def test_a_scenario_hoists_no_faster_than_the_winch_can(tmp_path):
    text = FALLS.format(parts=12, mass=1e5, more="", duration=1).replace("256.5e6", "256.5e6, fastest = 1.1")
    phase = """
[[scenario.phases]]
name = "up"
actions = [{{ hook = "hook", speed = {speed} }}]
until = {{ time = "1 s" }}
"""
    (tmp_path / "case.toml").write_text(text + phase.format(speed=0.1))
    with pytest.raises(InputError) as refused:
        load_case(tmp_path)
    (line,) = str(refused.value).splitlines()
    assert "scenario.phases.0.actions.0" in line
    assert "1.2 m/s, and the winch of 'hook_rope' has at most 1.1 m/s" in line
    (tmp_path / "case.toml").write_text(text + phase.format(speed=0.09))
    load_case(tmp_path)


def test_tables_of_moves():
    moves = [
        SimpleNamespace(start=2.0, distance=6.0, speed=0.3, ramp=5.0),
        SimpleNamespace(start=60.0, distance=-3.0, speed=0.5, ramp=6.0),  # ramps alone
    ]
    times = np.linspace(0.0, 90.0, 9001)
    speeds = np.interp(times, [2, 7, 22, 27], [0, 0.3, 0.3, 0]) + np.interp(times, [60, 66, 72], [0, -0.5, 0])
    gone = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(times))])
    drive = pack_profile(Profile(**{key: np.array(v) for key, v in speeds_of(moves).items()}))
    found = np.array([profile_value(drive, 0, t)[:2] for t in times])
    np.testing.assert_allclose(found, np.transpose([gone, speeds]), rtol=0.0, atol=1e-12)
    winch = speeds_of(moves, 12.0)
    assert np.allclose(np.interp(times, winch["times"], winch["speeds"]), 12.0 * speeds, atol=1e-12)


def statics():
    """Rows of the table of hook loads."""
    lines = (Path(__file__).parent / "gantry_hook_statics.csv").read_text().splitlines()
    return [row for row in csv.DictReader(line for line in lines if line[0] != "#") if row["x1"] == "8"]


@pytest.mark.slow
@pytest.mark.parametrize("row", statics(), ids=lambda row: f"{row['cx']},{row['cy']}")
def test_hook_loads_follow_from_moments(row, tmp_path):
    text = (CASES / "gantry_lift" / "case.toml").read_text()
    text = text[: text.index("[simulate]")].replace(
        'mass = "350 t"', f'mass = "350 t"\ncentre_of_mass = [{row["cx"]}, {row["cy"]}, 0]'
    )
    text += '[simulate]\nstart = "equilibrium"\nstep = 0.005\noutput_interval = 0.1\nduration = 0.1\n'
    results = run(tmp_path / "gantry", text)
    for hook in (1, 2, 3):
        lines = [float(results[f"loader_{hook}_line_{i}.tension"].ravel()[0]) for i in range(1, 6)]
        # falls stretch by centimetres: the block tilts by 1e-3, lines lean
        assert sum(lines) == pytest.approx(1e3 * float(row[f"F{hook}"]), rel=1e-3)
        assert lines == pytest.approx([sum(lines) / 5.0] * 5, rel=2e-3)


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (("parts = 12, moves", "parts = 11, moves"), "gantry_cranes.0.trolleys.0.hoists.0", "11 parts"),
        (
            ('distance = "6 m"', 'distance = "90 m"'),
            "gantry_cranes.0.trolleys.0.moves",
            "it comes 90 m from the middle",
        ),
        (('"25 m"', '"79 m"'), "gantry_cranes.0.trolleys.0.hoists.0.drop", "the hook comes 80.5 m below"),
        (('start = "62 s"', 'start = "22 s"'), "gantry_cranes.0.trolleys.0.hoists.0", "moves.1.start"),
        (('start = "62 s"', 'start = "20 s"'), "gantry_cranes.0.trolleys.0.hoists.0", "ends at 24 s"),
    ],
)
def test_errors_of_a_crane_stand_at_its_keys(change, key, words, tmp_path):
    text = (CASES / "gantry_lift" / "case.toml").read_text()
    text = text[: text.index("[simulate]")]
    assert change[0] in text
    (tmp_path / "case.toml").write_text(text.replace(*change))
    with pytest.raises(InputError) as refused:
        load_case(tmp_path)
    lines = str(refused.value).splitlines()
    assert f"{key}" in lines[0]
    assert words in lines[0]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            ("friction = 0.15", "friction = 0.15, efficiency = 0.9"),
            "path.1.friction: both 'friction' and 'efficiency'",
        ),
        (("10.3] }", "10.3], efficiency = 0.9 }"), "path.0.efficiency: an efficiency at an end"),
        (
            ("[0.9, 0, 10] }", "[0.9, 0, 10], friction = 0.1 }"),
            "path.3.friction: 'friction' without 'radius'",
        ),
        (("\nwinch =", "\n#"), "other_winch: 'other_winch' without 'winch'"),
        (("speeds = [0, 0.05]", "lengths = [9, 8]"), "other_winch.lengths: 'lengths' of one of two winches"),
    ],
)
def test_one_error_with_the_key_of_the_rope(change, words, tmp_path):
    assert change[0] in HAULED
    (tmp_path / "case.toml").write_text(HAULED.replace(*change))
    with pytest.raises(InputError) as refused:
        load_case(tmp_path)
    (line,) = str(refused.value).splitlines()
    assert f"ropes.0.{words}" in line
