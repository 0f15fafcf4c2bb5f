"""Equalizers against statics and modes of independent models, their stops, and what is refused."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.results.sinusoid import fit_sinusoid

WEIGHT = 300e3 * 9.81
LUGS = (-4.0, -2.0, 0.0, 2.0, 4.0)

FAR = "up = 2.5, down = 2.5"

LIFT = """
title = "An equalizer"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.box]
type = "rigid"
mass = "300 t"
inertia = [3.125e6, 3.125e6, 5e6]
frame = {{ motion = "{motion}" }}
initial = {{ position = [0, 0, {height}] }}

[[equalizers]]
name = "loader"
hook = {{ body = "ground", point = [0, 0, 41] }}
sheave_radius = 0.4
part_length = 3
beam = {{ mass = "15 t" }}
{model}
travel = {{ {travel} }}
rope = {{ axial_stiffness = 6e8 }}
line = {{ axial_stiffness = 6e8 }}
lines = [
{lines}
]
{more}

[simulate]
start = "equilibrium"
step = {step}
output_interval = {step}
duration = {duration}
"""


def lift(folder: Path, lengths, *, lugs=LUGS, height=9.2, pulley="1 t", travel="up = 2, down = 2", **more):
    """A case folder with a lift; lengths None are as drawn."""
    lines = "\n".join(
        f'    {{ body = "box", point = [{x}, 0, 2.5]{"" if length is None else f", length = {length}"} }},'
        for x, length in zip(lugs, lengths, strict=True)
    )
    model = 'model = "massless"' if pulley is None else f'pulley = {{ mass = "{pulley}" }}'
    given = {"motion": "free", "more": "", "step": 0.01, "duration": 0.01} | more
    folder.mkdir(exist_ok=True)
    text = LIFT.format(lines=lines, model=model, height=height, travel=travel, **given)
    (folder / "case.toml").write_text(text)
    return folder


def run(folder: Path):
    """Results of a case."""
    case = load_case(folder)
    run_case(case, stages=("simulate",))
    return load_results(case, case.output_folder)


def at_rest(results, name):
    return float(results[name].ravel()[0])


def statics():
    """Rows of the table of statics, by configuration."""
    lines = (Path(__file__).parent / "equalizer_statics.csv").read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@pytest.mark.slow
@pytest.mark.parametrize("row", statics(), ids=lambda row: row["config"])
def test_rests_as_the_minimum_of_the_energy(row, tmp_path):
    lengths = [float(row[f"l{i}"]) for i in range(1, 6)]
    height = 39.5 - 3.0 - sum(lengths) / 5 - 2.5 + 0.02
    results = run(
        lift(tmp_path / "lift", lengths, height=height, pulley=f"{row['pulley_kg']} kg", travel=FAR)
    )
    for i in range(1, 6):
        assert at_rest(results, f"loader_line_{i}.tension") == pytest.approx(
            1e3 * float(row[f"F{i}"]), rel=1e-5
        )
        assert results[f"loader_pulley_{i}.position"][0][2] == pytest.approx(float(row[f"z{i}"]), abs=1e-5)
    assert at_rest(results, "loader_rope.tension") == pytest.approx(1e3 * float(row["rope_T"]), rel=1e-5)
    assert results["box.position"][0][2] == pytest.approx(float(row["box_z"]), abs=1e-5)


@pytest.mark.parametrize(
    ("signs", "expected"), [((1, -1, 0, 0, 0), 161.514571), ((1, 1, 1, 1, 1), 562.650331)]
)
def test_pulleys_swing_on_their_lines_below_a_load_that_is_held(signs, expected, tmp_path):
    # equalizer_pulley_modes.csv: n - 1 times sqrt(k_l/m), and sqrt((k_l + 4 n k_r)/m); let go from a static push. Lines
    # are 1 cm too short, so that all stay taut
    push = "\n".join(
        f'[[forces]]\nname = "push_{i}"\nbody = "loader_pulley_{i}"\npoint = [0, 0, 0]\n'
        f"times = [0, 1e-6]\nforces = [[0, 0, {1e3 * sign}], [0, 0, 0]]"
        for i, sign in enumerate(signs, 1)
        if sign
    )
    lugs = (-3.2, -1.6, 0.0, 1.6, 3.2)
    given = {"motion": "fixed", "more": push, "step": 5e-5, "duration": 0.08}
    results = run(lift(tmp_path / "held", [22.99] * 5, lugs=lugs, height=11.0, **given))
    height = results["loader_pulley_1.position"][:, 2]
    assert 2.0 * math.pi * fit_sinusoid(results.time, height).frequency == pytest.approx(expected, rel=1e-3)


def test_a_line_that_holds_nothing_sends_its_pulley_to_the_upper_stop(tmp_path):
    folder = lift(
        tmp_path / "four",
        [24.0, 24.0, 24.0, 24.0, 60.0],
        height=9.2,
        travel="up = 2.9, down = 3, at_stops = true",
        more="\n".join(
            f'[[sensors]]\nname = "lug_{i}"\nbody = "box"\npoint = [{x}, 0, 2.5]'
            for i, x in enumerate(LUGS, 1)
        ),
    )
    file = folder / "case.toml"
    tilted = 'orientation = { axis = [0, -1, 0], angle = "10 deg" }'
    file.write_text(file.read_text().replace("[0, 0, 9.2]", f"[0.8, 0, 9.2], {tilted}"))
    results = run(folder)
    rope = at_rest(results, "loader_rope.tension")
    assert at_rest(results, "loader_line_5.tension") == 0.0
    # a quarter of the load a pulley, T = (F + m g)/2
    assert rope == pytest.approx(0.5 * (0.25 * WEIGHT + 9810.0), rel=1e-5)
    # the stop takes 2 T - m g, with its stiffness of 5e7 N/m
    assert at_rest(results, "loader_guide_5.travel") == pytest.approx(
        -2.9 - (2.0 * rope - 9810.0) / 5e7, abs=1e-5
    )
    # the centroid of the lugs is 1 m aside, 2.5 m above the centre of mass, and comes above it; lines lean a little
    ends = [results[f"lug_{i}.position"][0] for i in (1, 5)]
    tilt = math.atan2(ends[0][2] - ends[1][2], ends[1][0] - ends[0][0])
    assert tilt == pytest.approx(math.atan(1.0 / 2.5), rel=0.03)


CUT = """
[scenario]
at_end = "go_on"

[[scenario.phases]]
name = "hold"
until = {{ time = "1 s" }}

[[scenario.phases]]
name = "cut"
actions = [{{ release = "loader_line_{line}" }}]
until = {{ time = "1 s" }}

[[forces]]
name = "brake_x"
type = "spring"
between = ["ground", "box"]
points = [[-30, 0, 11.5], [-1, 0, 2.5]]
damping = 4e5

[[forces]]
name = "brake_y"
type = "spring"
between = ["ground", "box"]
points = [[-30, 0, 5], [-1, 0, -4]]
damping = 4e5
"""


@pytest.mark.slow
@pytest.mark.parametrize(("line", "aside"), [(3, 0.0), (2, 0.5)])
def test_four_lines_take_a_quarter_more_once_the_fifth_is_cut(line, aside, tmp_path):
    """Its pulley goes to the upper stop; the load swings and comes to rest below the centroid of the other lugs."""
    folder = lift(
        tmp_path / "cut",
        [24.0] * 5,
        height=8.1,
        travel="up = 2.5, down = 2.5, stiffness = 5e7, damping = 5e5",
        more=CUT.format(line=line),
        step=0.001,
        duration=80.0,
    )
    file = folder / "case.toml"
    file.write_text(
        file.read_text()
        .replace("output_interval = 0.001", "output_interval = 0.1")
        .replace("part_length = 3", "part_length = 5")
    )
    results = run(folder)
    assert results.outcome == "completed", results.metadata["message"]
    tensions = {i: results[f"loader_line_{i}.tension"].ravel() for i in range(1, 6)}
    assert all(np.isfinite(values).all() for values in tensions.values())
    before = [float(values[9]) for values in tensions.values()]
    after = [float(values[-1]) for i, values in tensions.items() if i != line]
    # of equal forces whose lines lean by some degrees, the sum of the vertical parts is the weight
    assert np.mean(after) == pytest.approx(1.25 * np.mean(before), rel=2e-3)
    assert tensions[line][-1] == 0.0
    assert results[f"loader_guide_{line}.travel"].ravel()[-1] < -2.4
    q = results["box.orientation"][-1]
    tilt = 2.0 * math.atan2(float(np.linalg.norm(q[1:])), float(q[0]))
    assert math.tan(tilt) == pytest.approx(aside / 2.5, rel=0.03, abs=2e-3)


def test_lines_without_length_are_as_drawn(tmp_path):
    results = run(lift(tmp_path / "drawn", [None] * 5, height=9.2, lugs=(-3.2, -1.6, 0.0, 1.6, 3.2)))
    # 39.5 - 3 - 11.7 m of line; the load sinks by the stretch of lines and rope
    assert at_rest(results, "loader_line_1.rest_length") == pytest.approx(24.8, abs=1e-12)
    F = 0.2 * WEIGHT
    sunk = F * 24.8 / 6e8 + 0.5 * (F + 9810.0) / 6e8 * (30.0 + 9.0 * math.pi * 0.4) / 10.0
    assert results["box.position"][0][2] == pytest.approx(9.2 - sunk, abs=1e-6)


@pytest.mark.parametrize("pulley", ["1 g", None])
def test_several_lines_lead_to_one_lug(pulley, tmp_path):
    folder = lift(tmp_path / "lugs", (26.0, 26.0), lugs=(-1.6, 1.6), height=8.0, pulley=pulley)
    file = folder / "case.toml"
    file.write_text(file.read_text().replace("length = 26.0", "length = 26, count = 2"))
    results = run(folder)
    # pulleys at -2.4, -0.8, 0.8, 2.4 m lean by 0.8 m, and carry a quarter each
    force = 0.25 * WEIGHT / math.sqrt(1.0 - (0.8 / 26.0) ** 2)
    if pulley is None:
        assert results["loader_rope.segment_tension"][0] == pytest.approx([force] * 4, rel=1e-5)
    else:
        lines = [at_rest(results, f"loader_line_{i}.tension") for i in range(1, 5)]
        assert lines == pytest.approx([force] * 4, rel=1e-5)


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        (
            (", 2.5]", ", -1]"),
            "equalizers.0.lines",
            "lugs lies 1 m below the centre of mass of 'box'",
        ),
        (("up = 2,", "up = 1,"), "equalizers.0.travel.up", "pulley 3 needs 1.2068 m"),
        (("down = 2", "down = 1.5"), "equalizers.0.travel.down", "pulley 1 needs 1.8"),
        (("up = 2,", "up = 3,"), "equalizers.0.travel.up", "pulleys would come through the fixed sheaves"),
        (("[-2.0, 0", "[-4.0, 0"), "equalizers.0.lines.1.point", "the lugs of lines 1 and 2 coincide"),
        (("9.2]", "7]"), "equalizers.0.lines", "the load is drawn 2.2068 m lower than its lines reach"),
        (("[4.0, 0,", "[40.0, 0,"), "equalizers.0.lines.4.length", "the lug is 36.8 m aside from the guide"),
        (("sheave_radius", "along = [1, 0, 1]\nsheave_radius"), "equalizers.0.along", "is not horizontal"),
        (
            ('"box", point = [0.0', '"bix", point = [0.0'),
            "equalizers.0.lines.2.body",
            "body 'bix' does not exist",
        ),
        (
            ('mass = "15 t"', 'mass = "15 t", inertia = [1, 1, 5]'),
            "equalizers.0.beam",
            "body 'loader_beam', inertia",
        ),
        (
            ("[-4.0, 0, 2.5], length = 23.0", "[-4.0, 0, 2.5], length = 1e308"),
            "equalizers.0.lines.0.length",
            "1e+308 is too large; expected a length [m] up to 1e+100 m",
        ),
        (('pulley = { mass = "1 t" }', ""), "equalizers.0.pulley", "is missing"),
        (("[-4.0, 0, 2.5]", "[-4.0, 0, 2.5], count = 0"), "equalizers.0.lines.0.count", "expected"),
    ],
)
def test_one_error_with_the_key_of_the_builder(change, key, words, tmp_path):
    folder = lift(tmp_path / "wrong", [23.0, 26.0, 26.0, 26.0, 23.0])
    file = folder / "case.toml"
    assert change[0] in file.read_text()
    file.write_text(file.read_text().replace(*change))
    with pytest.raises(InputError) as refused:
        load_case(folder)
    (line,) = str(refused.value).splitlines()
    assert f"{key}: " in line
    assert words in line


def test_a_name_that_is_taken(tmp_path):
    folder = lift(tmp_path / "twice", [23.0, 26.0, 26.0, 26.0, 23.0])
    file = folder / "case.toml"
    body = (
        '[bodies.loader_beam]\ntype = "rigid"\nmass = 1\ninertia = [1, 1, 1]\nframe = { motion = "free" }\n'
    )
    file.write_text(file.read_text().replace("[bodies.box]", f"{body}[bodies.box]"))
    with pytest.raises(
        InputError, match=r"equalizers\.0\.beam: the name 'loader_beam' that it gives is already that of"
    ):
        load_case(folder)


def test_repeated_equalizers_move_with_their_block(tmp_path):
    folder = lift(tmp_path / "repeated", [23.0, 26.0, 26.0, 26.0, 23.0])
    file = folder / "case.toml"
    text = file.read_text().replace(
        "[bodies.box]", '[[repeat]]\ncount = 2\nshift = [0, 20, 0]\n\n[repeat.bodies."box_{i}"]'
    )
    text = text.replace("[[equalizers]]", "[[repeat.equalizers]]").replace('"box"', '"box_{i}"')
    file.write_text(text.replace('"loader"', '"loader_{i}"'))
    case = load_case(folder)
    assert case.bodies["loader_1_pulley_1"].initial.position[1] == 20.0
    assert case.place("bodies.loader_1_pulley_1.mass") == "repeat.0.equalizers.0.pulley"
    file.write_text(file.read_text().replace("up = 2,", "up = 1,"))
    with pytest.raises(InputError, match=r"repeat.0.equalizers.0.travel.up: .* \(i = 0\)"):
        load_case(folder)


def test_an_extension_pulley_halves_the_force_of_its_line(tmp_path):
    folder = lift(tmp_path / "extended", [22.0, 24.0, 24.0, 24.0, 22.0], height=9.6)
    file = folder / "case.toml"
    text = file.read_text()
    for x in (-4.0, 4.0):
        text = text.replace(
            f"point = [{x}, 0, 2.5]", f"point = [{x}, -1.5, 2.5], other_point = [{x}, 1.5, 2.5]"
        )
    text = text.replace(
        "[simulate]", "[equalizers.extension]\nmass = 100\nradius = 0.3\nsling_length = 5\n[simulate]"
    )
    file.write_text(text)
    results = run(folder)
    line, sling = (at_rest(results, f"loader_{what}_1.tension") for what in ("line", "sling"))
    # the halves of the sling lean: from the lug 1.5 m aside up to the tangent of the pulley
    path = results["loader_extension_1.position"][0]
    lug = results["box.position"][0] + np.array([-4.0, -1.5, 2.5])
    d = math.hypot(path[1] - lug[1], path[2] - lug[2])
    lean = math.atan2(path[1] - lug[1], path[2] - lug[2]) - math.asin(0.3 / d)
    assert sling == pytest.approx(0.5 * (line - 981.0) / math.cos(lean), rel=2e-3)


def both_models(folder: Path, lengths, **given):
    """Results with pulleys of a gram, and without masses of pulleys; line forces and place of the box."""
    found = []
    for pulley in ("1 g", None):
        results = run(lift(folder, lengths, pulley=pulley, **given))
        lines = [at_rest(results, f"loader_line_{i}.tension") for i in range(1, 6)] if pulley else None
        found.append((lines or list(results["loader_rope.segment_tension"][0]), results))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("lengths", "height"), [((23, 26, 26, 26, 23), 9.2), ((23, 26, 26, 26, 24), 9.0)])
def test_without_masses_of_pulleys_lines_carry_the_same(lengths, height, tmp_path):
    (heavy, with_pulleys), (light, without) = both_models(
        tmp_path / "lift", lengths, height=height, travel=FAR
    )
    assert light == pytest.approx(heavy, rel=1e-5)
    assert without["box.position"][0] == pytest.approx(with_pulleys["box.position"][0], abs=1e-6)
    assert at_rest(without, "loader_rope.tension") == pytest.approx(0.1 * WEIGHT, rel=1e-9)


def test_without_masses_of_pulleys_two_at_their_stops_take_all(tmp_path):
    lugs = (-3.2, -1.6, 0.0, 1.6, 3.2)
    folder = lift(
        tmp_path / "stopped",
        (23, 26, 26, 26, 23),
        lugs=lugs,
        height=10.0,
        pulley=None,
        travel="up = 1, down = 1, at_stops = true",
    )
    results = run(folder)
    assert results["loader_rope.segment_tension"][0] == pytest.approx(
        [0.5 * WEIGHT, 0.0, 0.0, 0.0, 0.5 * WEIGHT], rel=1e-6
    )
    # 39.5 m less 4 m, 23 m with their stretch, and 2.5 m
    stretch = 0.5 * WEIGHT * 23.0 / 6e8
    assert results["box.position"][0][2] == pytest.approx(39.5 - 4.0 - 23.0 - stretch - 2.5, abs=1e-6)


def test_without_masses_of_pulleys_a_slack_line_is_left_out(tmp_path):
    travel = "up = 2.9, down = 3, at_stops = true"
    (heavy, _), (light, _) = both_models(tmp_path / "four", (24, 60, 24, 24, 24), height=10.0, travel=travel)
    assert light[1] == 0.0
    assert light == pytest.approx(heavy, rel=1e-5)


def swinging(tmp_path: Path, step: float):
    """A drop on a hook that swings, energy missed and energy lost at stops, relative to the largest that moved."""
    folder = lift(
        tmp_path / "drop",
        (23, 26, 26, 26, 23),
        height=9.7,
        pulley=None,
        travel="up = 1.25, down = 1.85",
        duration=6.0,
    )
    file = folder / "case.toml"
    text = file.read_text().replace('"equilibrium"', '"project"').replace("step = 0.01", f"step = {step}")
    text = text.replace("output_interval = 0.01", "output_interval = 0.05")
    text = text.replace(
        "position = [0, 0,",
        "velocity = [0.5, 0.4, 0], angular_velocity = [0.02, 0.05, 0.03], position = [0, 0,",
    )
    hook = """[bodies.hook]
type = "rigid"
mass = "5 t"
inertia = [1e4, 1e4, 1e4]
frame = { motion = "free" }
initial = { position = [0, 0, 42] }

[[joints]]
name = "shackle"
type = "ball"
between = ["ground", "hook"]
at = [0, 0, 45]

"""
    text = text.replace('{ body = "ground", point = [0, 0, 41] }', '{ body = "hook", point = [0, 0, -1] }')
    file.write_text(text.replace("[[equalizers]]", f"{hook}[[equalizers]]"))
    results = run(folder)
    assert results["loader_rope.tension"].min() == 0.0  # it was slack
    assert np.abs(results["hook.position"][:, 0]).max() > 0.1
    parts = ("kinetic", "potential", "elastic", "dissipated")
    energy = sum(results[f"energy.{part}"].ravel() for part in parts)
    moved = results["energy.kinetic"].max() + results["energy.elastic"].max()
    return np.abs(energy - energy[0]).max() / moved, results["energy.dissipated"].max() / moved


def test_energy_is_kept_through_slack_stops_and_a_hook_that_swings(tmp_path):
    """The guide turns with the hook, lines lean all ways: every derivative of the row counts in the balance."""
    missed, lost = np.transpose([swinging(tmp_path, step) for step in (0.01, 0.005)])
    assert missed[1] < 3e-4
    assert missed[1] < 0.25 * missed[0]  # of the step, of the third order; a wrong row would stay
    assert lost.max() < 0.02  # at stops


def test_lines_without_masses_of_pulleys_need_steps_that_know_stops(tmp_path):
    folder = lift(tmp_path / "accurate", (23, 26, 26, 26, 23), pulley=None)
    file = folder / "case.toml"
    file.write_text(file.read_text().replace("step = 0.01", 'integrator = "accurate"\ntolerance = 1e-6'))
    with pytest.raises(InputError, match="'accurate' with lines of one force"):
        run(folder)


DRIVEN = """
title = "Lugs that are driven"

[gravity]
acceleration = [0, 0, -9.81]

{bodies}

[[equalizers]]
name = "loader"
hook = {{ body = "ground", point = [0, 0, 41] }}
sheave_radius = 0.4
part_length = 3
beam = {{ mass = "15 t" }}
pulley = {{ mass = "10 kg" }}
travel = {{ up = 2, down = 2 }}
rope = {{ axial_stiffness = 6e8, damping = 2e5 }}
line = {{ axial_stiffness = 6e8, damping = 5e4 }}
efficiency = {efficiency}
lines = [
{lines}
]

[simulate]
start = "equilibrium"
step = 0.01
output_interval = 0.05
duration = 4
"""


def driven(folder: Path, speeds, efficiency):
    """A case folder whose lugs hang straight below the pulleys and go down at given speeds."""
    count = len(speeds)
    bodies, lines = [], []
    for i, speed in enumerate(speeds):
        x = 1.6 * (i - 0.5 * (count - 1))
        bodies.append(
            f'[bodies.lug_{i}]\ntype = "rigid"\nmass = 100\ninertia = [1, 1, 1]\n'
            f"initial = {{ position = [{x}, 0, 16.5] }}\n"
            f'frame = {{ motion = "driven", z = {{ times = [0, 0.2], speeds = [0, {-speed}] }} }}\n'
        )
        lines.append(f'    {{ body = "lug_{i}", point = [0, 0, 0], length = 19.98 }},')
    folder.mkdir()
    text = DRIVEN.format(bodies="\n".join(bodies), lines="\n".join(lines), efficiency=efficiency)
    (folder / "case.toml").write_text(text)
    return folder


def bounds():
    """Rows n, efficiency: largest and smallest line over their mean."""
    lines = (Path(__file__).parent / "equalizer_friction_bounds.csv").read_text().splitlines()
    table = [[float(x) for x in line.split(",")] for line in lines[3:]]
    return {(int(row[0]), row[1]): row[2:4] for row in table}


@pytest.mark.parametrize(("count", "efficiency"), [(5, 0.98), (5, 0.96), (3, 0.94)])
def test_rope_that_runs_one_way_makes_the_largest_spread(tmp_path, count, efficiency):
    """One outer line is lowered, the other raised: each line pulls eta^2 times the one before it."""
    speeds = np.zeros(count)
    speeds[[0, -1]] = 0.02, -0.02
    results = run(driven(tmp_path / "c", speeds, efficiency))
    T = np.asarray(results["loader_rope.segment_tension"])[-1]
    F = T[::2] + T[1::2]
    np.testing.assert_allclose(F[1:] / F[:-1], efficiency**2, rtol=1e-9)
    largest, smallest = bounds()[count, efficiency]
    assert F.max() / F.mean() == pytest.approx(largest, rel=1e-7)
    assert F.min() / F.mean() == pytest.approx(smallest, rel=1e-7)
    lines = np.array([results[f"loader_line_{i + 1}.tension"].ravel()[-1] for i in range(count)])
    np.testing.assert_allclose(lines, F + 10.0 * 9.81, rtol=1e-3)


def test_outer_lines_that_are_lowered_pull_most(tmp_path):
    """The rope runs from the middle pulley, on which it sticks, to both sides."""
    results = run(driven(tmp_path / "c", (0.03, -0.02, -0.02, -0.02, 0.03), 0.98))
    T = np.asarray(results["loader_rope.segment_tension"])[-1]
    F = T[::2] + T[1::2]
    np.testing.assert_allclose(F / F.mean(), (1.030, 0.990, 0.960, 0.990, 1.030), atol=1e-3)


@pytest.mark.parametrize("efficiency", [0.98, 0.9])
def test_lines_differ_by_no_more_than_friction_holds(tmp_path, efficiency):
    """A load that falls into its lines, through slack and taut, and hangs on: all pairs of parts are within eta."""
    folder = lift(
        tmp_path / "c", (23, 26, 26, 26, 23), height=9.25, duration=6.0, more=f"efficiency = {efficiency}"
    )
    text = (folder / "case.toml").read_text().replace(f"]\nefficiency = {efficiency}", "]")
    text = text.replace("part_length = 3", f"part_length = 3\nefficiency = {efficiency}")
    text = text.replace('start = "equilibrium"', 'start = "check"').replace("6e8 }", "6e8, damping = 1e5 }")
    (folder / "case.toml").write_text(text)
    results = run(folder)
    T = np.asarray(results["loader_rope.segment_tension"])
    q = np.asarray(results["loader_rope.sheave_speed"])
    assert len(T) == 601
    taut = T.min(axis=1) > 0.0
    assert (~taut).any()
    assert taut[-300:].all()
    ratio = T[taut, 1:] / T[taut, :-1]
    assert ratio.min() > efficiency * (1.0 - 1e-9)
    assert ratio.max() < (1.0 + 1e-9) / efficiency
    F = T[taut, ::2] + T[taut, 1::2]
    assert (F.min(axis=1) / F.max(axis=1)).min() > efficiency**8
    assert np.abs(q).max() > 0.01


@pytest.mark.slow
def test_a_load_that_hangs_keeps_all_tensions(tmp_path):
    """Friction leaves open how parts share what moves nothing: ten minutes at rest change no tension by 1e-6."""
    more = {"step": 0.01, "duration": 600.0}
    folder = lift(tmp_path / "c", (23, 26, 26, 26, 23), **more)
    text = (folder / "case.toml").read_text().replace("output_interval = 0.01", "output_interval = 1")
    (folder / "case.toml").write_text(text.replace("part_length = 3", "part_length = 3\nefficiency = 0.98"))
    results = run(folder)
    T = np.asarray(results["loader_rope.segment_tension"])[1:]
    assert np.ptp(T, axis=0).max() < 1e-6 * T.min()
    assert np.all(results["loader_rope.sheave_state"] == 0.0)
    assert np.ptp(results["loader_pulley_1.position"][1:], axis=0).max() < 1e-8


def massless(folder: Path, efficiency=None, **change):
    """The same case without masses of pulleys."""
    file = folder / "case.toml"
    text = file.read_text().replace('pulley = { mass = "10 kg" }', 'model = "massless"')
    if efficiency is not None:
        text = text.replace("part_length = 3", f"part_length = 3\nefficiency = {efficiency}")
    for old, new in change.items():
        assert old in text
        text = text.replace(old, new)
    file.write_text(text)
    return folder


@pytest.mark.parametrize(("count", "efficiency"), [(5, 0.98), (5, 0.96), (3, 0.94), (2, 0.96)])
def test_massless_pulleys_make_the_largest_spread(tmp_path, count, efficiency):
    speeds = np.zeros(count)
    speeds[[0, -1]] = 0.02, -0.02
    results = run(massless(driven(tmp_path / "c", speeds, efficiency)))
    F = results["loader_rope.segment_tension"][-1]
    np.testing.assert_allclose(F[1:] / F[:-1], efficiency**2, rtol=1e-9)
    largest, smallest = bounds()[count, efficiency]
    assert F.max() / F.mean() == pytest.approx(largest, rel=1e-7)
    assert F.min() / F.mean() == pytest.approx(smallest, rel=1e-7)
    # the larger part of the rope at the pulley with the largest force
    assert results["loader_rope.tension"].ravel()[-1] == pytest.approx(F.max() / (1.0 + efficiency), rel=1e-9)
    balance = results["energy.balance"].ravel()[1:]  # bodies begin to move in the first step
    assert np.ptp(balance) < 1e-9 * (F[0] + F[-1]) * 0.02 * 3.9  # what goes through the lines


def test_massless_pulleys_on_outer_lines_that_are_lowered(tmp_path):
    results = run(massless(driven(tmp_path / "c", (0.03, -0.02, -0.02, -0.02, 0.03), 0.98)))
    F = results["loader_rope.segment_tension"][-1]
    np.testing.assert_allclose(F / F.mean(), (1.030, 0.990, 0.960, 0.990, 1.030), atol=1e-3)
    np.testing.assert_allclose(F[1:3] / F[:2], (0.98**2, 2.0 * 0.98**2 / 1.98), rtol=1e-8)


@pytest.mark.parametrize("efficiency", [0.98, 0.94])
def test_massless_pulleys_are_the_limit_of_light_ones(tmp_path, efficiency):
    """Forces of lines with pulleys of 1 g. These have a rope whose longer parts count for more: lines move little."""
    folders = [driven(tmp_path / name, (0.002, 0.0, 0.001, -0.001, -0.002), efficiency) for name in "mp"]
    light = folders[1] / "case.toml"
    light.write_text(light.read_text().replace("10 kg", "1 g").replace("damping = 2e5", "damping = 0"))
    found, expected = run(massless(folders[0])), run(folders[1])
    F = found["loader_rope.segment_tension"]
    lines = np.stack([expected[f"loader_line_{i}.tension"].ravel() for i in range(1, 6)], axis=1)
    assert np.abs(F[-1] / lines[-1] - 1.0).max() < 1e-4
    assert F[-1].min() < 0.97 * F[-1].max()


@pytest.mark.parametrize("efficiency", [0.98, 0.9])
def test_massless_pulleys_hold_no_more_than_friction(tmp_path, efficiency):
    """A load that falls into its lines, through slack and taut, and hangs on."""
    folder = lift(
        tmp_path / "c",
        (23, 26, 26, 26, 23),
        lugs=(-3.2, -1.6, 0, 1.6, 3.2),
        height=9.25,
        pulley=None,
        duration=6.0,
    )
    change = {'start = "equilibrium"': 'start = "check"', "6e8 }": "6e8, damping = 1e5 }"}
    results = run(massless(folder, efficiency, **change))
    assert results.outcome == "completed"
    F = np.asarray(results["loader_rope.segment_tension"])
    taut = F.min(axis=1) > 0.0
    assert (~taut).any()
    assert taut[-300:].all()
    assert np.all(F[~taut] == 0.0)
    spread = F[taut].min(axis=1) / F[taut].max(axis=1)
    assert spread.min() > efficiency**8 * (1.0 - 1e-9)
    assert spread.min() < 0.97
    neighbours = F[taut, 1:] / F[taut, :-1]
    assert neighbours.min() > efficiency**2 * (1.0 - 1e-9)
    assert neighbours.max() < (1.0 + 1e-9) / efficiency**2
    # the load falls, and what lines, sheaves and the change of forces at slack take is booked
    assert np.ptp(results["energy.balance"]) < 1e-6 * results["energy.dissipated"].ravel()[-1]


@pytest.mark.slow
def test_a_load_that_hangs_on_massless_pulleys_keeps_all_forces(tmp_path):
    """Ten minutes at rest, with the forces that a fall into the lines has left, change none of them by 1e-6."""
    lugs = (-3.2, -1.6, 0, 1.6, 3.2)
    folder = lift(tmp_path / "c", (23, 26, 26, 26, 23), lugs=lugs, height=9.25, pulley=None, duration=660.0)
    change = {
        "output_interval = 0.01": "output_interval = 1",
        "6e8 }": "6e8, damping = 1e6 }",
        'start = "equilibrium"': 'start = "check"',
    }
    results = run(massless(folder, 0.96, **change))
    F = results["loader_rope.segment_tension"][60:]
    assert F[-1].max() / F[-1].min() > 1.01
    assert np.ptp(F, axis=0).max() < 1e-6 * F.min()


def test_four_lines_rub_past_a_massless_pulley_at_its_stop(tmp_path):
    """The middle line is too long: its pulley is at the upper stop, and the rope runs over it from line 2 to line 4."""
    lugs = (-3.2, -1.6, 0, 1.6, 3.2)
    folder = lift(tmp_path / "c", (24, 24, 29, 24, 24), lugs=lugs, height=9.9, pulley=None, duration=10.0)
    change = {
        "up = 2, down = 2": "up = 2, down = 2, at_stops = true",
        "6e8 }": "6e8, damping = 3e5 }",
        'start = "equilibrium"': 'start = "check"',
    }
    results = run(massless(folder, 0.96, **change))
    assert results.outcome == "completed"
    F = results["loader_rope.segment_tension"][-1]
    assert F[2] == 0.0
    assert F.sum() == pytest.approx(WEIGHT, rel=1e-4)
    assert F.min() < F.max()
    of_pair = F[[1, 4]] / F[[0, 3]]
    assert of_pair.min() > 0.96**2 * (1.0 - 1e-9)
    assert of_pair.max() < (1.0 + 1e-9) / 0.96**2
    assert np.ptp(results["energy.balance"]) < 1e-6 * results["energy.dissipated"].ravel()[-1]


def test_slings_over_extension_pulleys_share_by_their_efficiency(tmp_path):
    """Each lug has half of the line at rest; once the load rolls friction lets halves differ by eta at most."""
    folder = lift(tmp_path / "extended", [22.0, 24.0, 24.0, 24.0, 22.0], height=9.6, step=0.002, duration=0.6)
    file = folder / "case.toml"
    text = file.read_text()
    for x in (-4.0, 4.0):
        text = text.replace(
            f"point = [{x}, 0, 2.5]", f"point = [{x}, -1.5, 2.5], other_point = [{x}, 1.5, 2.5]"
        )
    text = text.replace("part_length = 3", "part_length = 3\nefficiency = 0.96")
    push = '[[forces]]\nname = "push"\nbody = "box"\npoint = [0, 0, -2.5]\n'
    push += "times = [0.1, 0.2]\nforces = [[0, 0, 0], [0, 2e4, 0]]\n"
    text = text.replace(
        "[simulate]", f"[equalizers.extension]\nmass = 100\nradius = 0.3\nsling_length = 5\n{push}[simulate]"
    )
    file.write_text(text)
    results = run(folder)
    T = np.asarray(results["loader_sling_1.segment_tension"])
    T = T[T.min(axis=1) > 0.0]
    ratio = T[:, 1] / T[:, 0]
    assert len(T) > 150
    assert ratio.min() > 0.96 * (1.0 - 1e-9)
    assert ratio.max() < (1.0 + 1e-9) / 0.96
    assert np.ptp(ratio) > 1e-4


PLATE = """
title = "A plate in rigid rims on three equalizers"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.plate]
type = "shell"
geometry = { type = "rectangle", size = [30, 20], elements = [4, 3] }
section = { thickness = 0.04246, density = 7850, young_modulus = 210e9, poisson_ratio = 0.3 }
damping = { stiffness = 0.02 }
initial = { position = [-15, -10, 0] }

[bodies.frame]
type = "rigid"
mass = 2e3
inertia = [66e3, 150e3, 216e3]
frame = { motion = "free" }
"""


@pytest.mark.slow
def test_a_plate_with_clamped_rims_comes_to_rest_on_three_equalizers(tmp_path):
    # moments about the centre of mass: a third at the edge, two thirds inside, and all lines of one the same
    text = PLATE
    for edge in ("x_min", "x_max", "y_min", "y_max"):
        text += f'[[joints]]\nname = "rim_{edge}"\ntype = "edge_clamp"\nbetween = ["plate", "frame"]\nedge = "{edge}"\n'
    for number, (body, x, y) in enumerate([("frame", 15, -5), ("frame", 15, 5), ("plate", -7.5, 0)], start=1):
        shift = (0, 0) if body == "frame" else (15, 10)
        lines = ", ".join(
            f'{{ body = "{body}", point = [{x + shift[0]}, {y + d + shift[1]}, 0] }}' for d in (-2, 0, 2)
        )
        text += f"""
[[equalizers]]
name = "loader_{number}"
model = "massless"
hook = {{ body = "ground", point = [{x}, {y}, 14] }}
along = [0, 1, 0]
sheave_radius = 0.5
part_length = 2.5
beam = {{ mass = 1e4 }}
travel = {{ up = 2, down = 2 }}
rope = {{ axial_stiffness = 6e8, damping = 1e5 }}
line = {{ axial_stiffness = 3e8, damping = 1e5 }}
lines = [{lines}]
"""
    text += '[simulate]\nstart = "equilibrium"\nstep = 0.02\noutput_interval = 0.1\nduration = 0.2\n'
    (tmp_path / "case.toml").write_text(text)
    results = run(tmp_path)
    loads = [results[f"loader_{i}_rope.segment_tension"].sum(axis=1) for i in (1, 2, 3)]
    whole = (600.0 * 0.04246 * 7850.0 + 2e3) * 9.81
    assert sum(load[0] for load in loads) == pytest.approx(whole, rel=2e-3)  # lines lean a little
    assert (loads[0] + loads[1])[0] / whole == pytest.approx(1.0 / 3.0, rel=5e-3)
    assert loads[0][0] == pytest.approx(loads[1][0], rel=1e-6)
    still = np.ptp(results["frame.position"], axis=0)
    assert still.max() < 1e-5
