"""The stress that checks name is the one that pictures show, and both are those of mechanics."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.pipeline import load_case
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.drawn.build import mesh_run
from heavylift.pipeline.drawn.skins import MeshSkin
from heavylift.pipeline.results.histories import load_results
from heavylift.pipeline.results.model_io import read_model, read_reduced
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import run_case

E, RHO, G = 2.1e11, 7850.0, 9.81
LENGTH, WIDTH, THICKNESS = 2.0, 0.5, 0.05

CASE = f"""
title = "Cantilevers under their weight"
gravity = {{ acceleration = [0, 0, {-G}] }}

[bodies.strip]
type = "shell"
geometry = {{ type = "rectangle", size = [{LENGTH}, {WIDTH}], elements = [4, 1] }}
section = {{ thickness = {THICKNESS}, density = {RHO}, young_modulus = {E}, poisson_ratio = 0 }}
supports = [{{ edge = "x_min", fix = "clamped" }}]

[bodies.beam]
type = "frame"
geometry = {{ type = "line", start = [0, 0, 0], end = [{LENGTH}, 0, 0], elements = 4 }}
section = {{ density = {RHO}, young_modulus = {E}, side = {THICKNESS} }}
supports = [{{ at = "start", fix = "clamped" }}]

[bodies.bar]
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = 0, density = {RHO} }}
mesh = {{ element = "hex8", divisions = {{ x = [40], y = [2], z = [2] }} }}
modes = {{ count = 12, clamp = ["root"], static_groups = ["all"], static_directions = "z" }}
frame = {{ motion = "fixed" }}

[bodies.bar.geometry]
type = "blocks"
add = [{{ name = "bar", from = [0, 0, 0], to = [{LENGTH}, {THICKNESS}, {THICKNESS}] }}]
groups = {{ root = {{ plane = "x", at = 0 }}, all = {{ from = [0.01, 0, 0], to = [{LENGTH}, 1, 1] }} }}

[[sensors]]
name = "clamp"
body = "strip"
point = [0, {WIDTH / 2}, 0]

[[sensors]]
name = "half"
body = "strip"
point = [{LENGTH / 2}, {WIDTH / 2}, 0]

[[sensors]]
name = "root"
body = "beam"
point = [0, 0, 0]

[[sensors]]
name = "fibre"
body = "bar"
point = [{LENGTH / 2}, {THICKNESS / 3}, {THICKNESS}]

[simulate]
start = "equilibrium"
duration = 0
"""


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cantilevers")
    (folder / "case.toml").write_text(CASE)
    case = load_case(folder)
    assert run_case(case, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
    return case


@pytest.fixture(scope="module")
def quantities(case):
    return Quantities(case, case.output_folder)


def bending_stress(x, element=0.0):
    """6 M/(b t^2) of a rectangular section of any width, M = q (L - x)^2/2; a cubic element has q h^2/12 less."""
    moment = RHO * G * THICKNESS * (0.5 * (LENGTH - x) ** 2 - element**2 / 12.0)
    return 6.0 * moment / THICKNESS**2


def test_largest_stress_of_a_clamped_strip_is_that_of_its_clamp(quantities):
    clamp = bending_stress(0.0, LENGTH / 4)
    assert quantities.number("channel.strip.von_mises.largest.max") == pytest.approx(clamp, rel=2e-3)
    assert quantities.number("stress.clamp.von_mises.end") == pytest.approx(clamp, rel=2e-3)
    # bent downwards: the top is in tension; a fibre in the middle of the first element would be 23 % below
    assert quantities.number("stress.clamp.top.xx.end") == pytest.approx(clamp, rel=2e-3)
    assert quantities.number("stress.clamp.bottom.xx.end") == pytest.approx(-clamp, rel=2e-3)
    half = bending_stress(LENGTH / 2, LENGTH / 4)
    assert quantities.number("stress.half.top.xx.end") == pytest.approx(half, rel=5e-3)
    assert abs(quantities.number("stress.half.top.yy.end")) < 1e-3 * half


def test_largest_stress_of_a_clamped_frame_is_that_of_its_clamp(quantities):
    clamp = bending_stress(0.0, LENGTH / 4)
    assert abs(quantities.number("channel.beam.axial_stress.norm.end")) > 0.0
    largest = max(
        abs(quantities.number(f"channel.beam.axial_stress.{word}.end")) for word in ("largest", "smallest")
    )
    assert largest == pytest.approx(clamp, rel=2e-3)
    assert abs(quantities.number("stress.root.largest.end")) == pytest.approx(clamp, rel=2e-3)
    assert abs(quantities.number("stress.root.axial.end")) < 1e-3 * clamp


def test_pictures_of_meshes_show_the_recorded_stress(case, quantities):
    results = load_results(case)
    for name, channel in (("strip", "von_mises"), ("beam", "axial_stress")):
        run = mesh_run(results.meshes[name], results)
        skin = MeshSkin(run.body, lengths=run.lengths).skin(run.coordinates(0))
        recorded = [
            quantities.number(f"channel.{name}.{channel}.{word}.end") for word in ("largest", "smallest")
        ]
        assert abs(skin.largest) == pytest.approx(max(map(abs, recorded)), rel=1e-9)


def test_stress_of_a_solid_is_that_of_bending_and_of_its_picture(case, quantities):
    from heavylift.modal.stress import stress_modes, von_mises

    half = bending_stress(LENGTH / 2)
    assert quantities.number("stress.fibre.xx.end") == pytest.approx(half, rel=0.01)
    assert quantities.number("stress.fibre.von_mises.end") == pytest.approx(half, rel=0.01)
    assert abs(quantities.number("stress.fibre.zz.end")) < 0.01 * half
    # as the report draws it
    folder, results = OutputFolder(case.output_folder), load_results(case)
    model, reduced = read_model(folder.model("bar")), read_reduced(folder.reduced("bar"))
    shape = np.tensordot(np.atleast_1d(results["bar.modal_position"][0]), reduced.mode_shapes, axes=1)
    drawn = von_mises(stress_modes(model.mesh, model.material, shape[np.newaxis]))
    assert quantities.number("stress.bar.von_mises.max") == pytest.approx(drawn.max(), rel=1e-9)
    assert quantities.number("stress.bar.von_mises.max") == pytest.approx(bending_stress(0.0), rel=0.05)


@pytest.mark.parametrize(
    ("quantity", "message"),
    [
        ("stress.clamp.zz.end", "did you mean 'top.xx'|of 'clamp' on 'strip' one of"),
        ("stress.fibre.top.xx.end", "of 'fibre' on 'bar' one of: von_mises, xx"),
        ("stress.strip.von_mises.end", "channel.NAME.von_mises.largest.max"),
        ("stress.nothing.xx.end", "nothing"),
        ("stress.fibre.xx.rate", "STATISTIC"),
        ("stress.fibre", "STATISTIC"),
    ],
)
def test_what_has_no_stress_is_refused_with_what_there_is(tmp_path, quantity, message):
    check = f'[[check]]\nid = "a"\nquantity = "{quantity}"\nreference = 0\n'
    check += 'tolerance = { absolute = 1 }\nsource = "b"\n'
    (tmp_path / "case.toml").write_text(CASE + check)
    with pytest.raises(InputErrors, match=message):
        load_case(tmp_path)


def test_a_sensor_away_from_a_body_is_refused(case):
    moved = case.model_copy(
        update={
            "sensors": tuple(
                one.__class__(**{**one.__dict__, "point": (0.0, 0.0, 1.0)}) if one.name == "fibre" else one
                for one in case.sensors
            )
        }
    )
    with pytest.raises(InputError, match="is not on the body"):
        Quantities(moved, case.output_folder).number("stress.fibre.xx.end")
