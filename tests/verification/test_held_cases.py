"""Flexible beams that fixed joints build in, without interfaces of their own, against closed forms."""

from __future__ import annotations

import pytest

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, load_results, run_case

BEAM = """
[bodies.beam]
type = "flexible"
material = {{ young_modulus = "210 GPa", poisson_ratio = 0.0, density = "{density} kg/m^3" }}
frame = {{ motion = "{motion}" }}
mesh = {{ element = "hex8", divisions = {{ x = [40], y = [2], z = [2] }} }}

[bodies.beam.geometry]
type = "blocks"
add = [{{ name = "beam", from = [0, "-10 mm", "-10 mm"], to = ["1 m", "10 mm", "10 mm"] }}]
groups = {{ root = {{ plane = "x", at = 0 }}, tip = {{ plane = "x", at = "1 m" }} }}

[[sensors]]
name = "tip"
body = "beam"
point = ["1 m", 0, 0]
"""

HEAD = """
title = "A beam that a joint builds in"

[gravity]
acceleration = [0, 0, -9.81]

[simulate]
start = "equilibrium"
duration = 0
"""

STIFFNESS, LENGTH = 210e9 * 0.02**4 / 12.0, 1.0


def _results(folder, text):
    (folder / "case.toml").write_text(HEAD + text)
    case = load_case(folder)
    assert run_case(case, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
    return load_results(case)


@pytest.mark.parametrize("static", ["", 'static_groups = ["tip"]'])
def test_an_arm_that_is_built_in_at_the_tip_bends_a_cantilever(tmp_path, static):
    results = _results(
        tmp_path,
        BEAM.format(density=1, motion="fixed")
        + f"""
[bodies.beam.modes]
count = 10
clamp = ["root"]
{static}

[bodies.arm]
type = "rigid"
mass = "2 kg"
inertia = [1e-3, 1e-3, 1e-3]
centre_of_mass = ["0.5 m", 0, 0]
frame = {{ motion = "free" }}
initial = {{ position = ["1 m", 0, 0] }}

[[joints]]
type = "fixed"
name = "built_in"
between = ["beam", "arm"]
at = ["1 m", 0, 0]

[[sensors]]
name = "load"
body = "arm"
point = ["0.5 m", 0, 0]
""",
    )
    force, arm = 2.0 * 9.81, 0.5
    tip = -force * (LENGTH**3 / 3.0 + arm * LENGTH**2 / 2.0) / STIFFNESS
    load = tip - arm * force * (LENGTH**2 / 2.0 + arm * LENGTH) / STIFFNESS
    assert results["tip.position"][-1, 2] == pytest.approx(tip, rel=1e-3)
    assert results["load.position"][-1, 2] == pytest.approx(load, rel=1e-3)
    assert abs(results["built_in.reaction_moment"][-1, 1]) == pytest.approx(force * arm, rel=1e-3)


def test_what_pulls_at_plates_has_its_static_vectors(tmp_path):
    """A strip that hangs on two ropes at bare points and bears a force between: the deflection of statics."""
    results = _results(
        tmp_path,
        """
[bodies.strip]
type = "flexible"
material = { young_modulus = "210 GPa", poisson_ratio = 0.0, density = "7850 kg/m^3" }
frame = { motion = "free" }
mesh = { size = "50 mm" }
modes = { count = 2, damping_ratio = 0.1 }

[bodies.strip.geometry]
type = "panels"
plates.strip = { thickness = "10 mm", corners = [[0, -0.05, 0], [2, -0.05, 0], [2, 0.05, 0], [0, 0.05, 0]] }

[[forces]]
name = "load"
body = "strip"
point = [1, 0, 0]
force = [0, 0, -100]

[[ropes]]
name = "left"
axial_stiffness = "1 GN"
length = "5 m"
path = [{ body = "ground", point = [0, 0, 5] }, { body = "strip", point = [0, 0, 0] }]

[[ropes]]
name = "right"
axial_stiffness = "1 GN"
length = "5 m"
path = [{ body = "ground", point = [2, 0, 5] }, { body = "strip", point = [2, 0, 0] }]

[[sensors]]
name = "middle"
body = "strip"
point = [1, 0, 0]

[[sensors]]
name = "end"
body = "strip"
point = [0, 0, 0]
""",
    )
    sag = (results["end.position"] - results["middle.position"])[-1, 2]
    stiffness, weight = 210e9 * 0.1 * 0.01**3 / 12.0, 7850.0 * 0.1 * 0.01 * 9.81
    wanted = (100.0 * 2.0**3 / 48.0 + 5.0 * weight * 2.0**4 / 384.0) / stiffness
    assert sag == pytest.approx(wanted, rel=3e-3)


@pytest.mark.parametrize("static", ["", 'static_groups = ["root", "tip"]'])
def test_a_free_beam_built_into_the_ground_sags_as_a_cantilever(tmp_path, static):
    results = _results(
        tmp_path,
        BEAM.format(density=7850, motion="free")
        + f"""
[bodies.beam.modes]
count = 20
{static}

[[joints]]
type = "fixed"
name = "built_in"
between = ["ground", "beam"]
at = [0, 0, 0]
""",
    )
    weight = 7850.0 * 0.02**2 * 9.81
    assert results["tip.position"][-1, 2] == pytest.approx(-weight * LENGTH**4 / 8.0 / STIFFNESS, rel=1e-3)
    assert abs(results["built_in.reaction_moment"][-1, 1]) == pytest.approx(0.5 * weight, rel=1e-3)


def test_joints_that_hold_all_modes_are_told():
    """Three modes of a cantilever whose tip a ball joint holds: they leave it no deformation."""
    from heavylift.solver.bodies.floating_frame.held_chords import tell_few_modes
    from heavylift.solver.joints.ball import Ball
    from heavylift.solver.scene.connections import GROUND, JointFrame
    from tests.solver.solid_beams import beam, cantilever

    for count, words in ((3, ["leave it no deformation"]), (8, [])):
        body = beam(cantilever(modes=count))
        tip = body.reduced.nodes[body.reduced.nodes[:, 0].argmax()]
        joint = Ball(
            name="prop", body_a=GROUND, body_b=body.name, frame_a=JointFrame(tip), frame_b=JointFrame(tip)
        )
        found = tell_few_modes([body], [joint])
        assert len(found) == len(words)
        assert all(word in one for word, one in zip(words, found, strict=True))


def test_a_pressure_on_two_plates_does_not_load_what_is_between_them(tmp_path):
    """Webs one element high between two decks of 2 x 1 m, and 1 kPa along y on both decks."""
    (tmp_path / "case.toml").write_text(
        """
title = "Two decks and webs between them"

[bodies.box]
type = "flexible"
material = { young_modulus = "210 GPa", poisson_ratio = 0.3, density = "7850 kg/m^3" }
frame = { motion = "fixed" }
mesh = { size = "0.5 m" }
modes = { count = 3, clamp = ["root"] }
static = [{ name = "load", loads = [{ on = ["deck", "low"], traction = [0, "1 kPa", 0] }] }]

[bodies.box.geometry]
type = "panels"
groups = { root = { plane = "x", at = 0 } }

[bodies.box.geometry.plates]
deck = { thickness = "10 mm", corners = [[0, 0, 0.5], [2, 0, 0.5], [2, 1, 0.5], [0, 1, 0.5]] }
low = { thickness = "10 mm", corners = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]] }
webs = { thickness = "10 mm", corners = [[0, 0, 0], [2, 0, 0], [2, 0, 0.5], [0, 0, 0.5]], step = [0, 1, 0], count = 2 }
"""
    )
    case = load_case(tmp_path)
    assert run_case(case, stages=("mesh", "modes")).outcome is Outcome.COMPLETED
    from heavylift.pipeline.results.model_io import read_states
    from heavylift.pipeline.results.storage import OutputFolder

    state = read_states(OutputFolder(case.output_folder).reduced("box"))["load"]
    assert state.reaction[1] == pytest.approx(-1e3 * 2 * 2.0 * 1.0, rel=1e-9)
