"""A hull floats with what joints hold on it, in `hydrostatics`, in checks, and where its database is computed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.hulls import bem_inputs, linear_restoring, resting_position
from heavylift.pipeline.assemble.loading import case_loading, scene_loading
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.commands.cli import app
from heavylift.pipeline.results.provenance import database_digest
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.preprocess.hydrodynamics.hull_panels import hydrostatics
from heavylift.solver.joints.ball import Ball
from heavylift.solver.scene.scene import RigidBody, Scene

L, B, D, RHO = 40.0, 16.0, 5.0, 1025.0
HULL, BOOM, MAST = 1.2e6, 4.0e4, 7800.0 * 4.0 * 1.0 * 1.0
ALL = HULL + BOOM + MAST
TRIMMED = -(BOOM * 12.0 + MAST * 2.0) / HULL
"""Where the barge has its own centre of mass, so that all of it floats upright."""

CASE = f"""
title = "A barge with a boom and a mast"

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[bodies.barge]
type = "rigid"
mass = "{HULL / 1e3!r} t"
inertia = ["4e7 kg m^2", "1.6e8 kg m^2", "1.9e8 kg m^2"]
centre_of_mass = [{TRIMMED!r}, 0, 0]
frame = {{ motion = "free" }}

[bodies.boom]
type = "rigid"
mass = "{BOOM / 1e3!r} t"
inertia = ["1e5 kg m^2", "2e6 kg m^2", "2e6 kg m^2"]
centre_of_mass = [12, 0, 6]
frame = {{ motion = "free", origin = "centre_of_mass" }}

[bodies.mast]
type = "flexible"
frame = {{ motion = "free" }}
material = {{ young_modulus = "210 GPa", poisson_ratio = 0.3, density = "7800 kg/m^3" }}
geometry = {{ type = "blocks", add = [{{ name = "bar", from = [1.5, -0.5, 3], to = [2.5, 0.5, 7] }}] }}
mesh = {{ element = "hex8", divisions = {{ x = [1], y = [1], z = [4] }}, mass = "lumped" }}
modes = {{ count = 2 }}

[[joints]]
name = "heel"
type = "fixed"
between = ["barge", "boom"]
at = [4, 0, 4]

[[joints]]
name = "step"
type = "fixed"
between = ["mast", "boom"]
points = [[1.5, -0.5, 3], [1.5, -0.5, 3]]

[[surfaces]]
name = "skin"
body = "barge"
shape = {{ type = "box", size = ["{L} m", "{B} m", "{D} m"] }}

[hulls.barge]
surface = "skin"

[sea]
density = "{RHO} kg/m^3"

[databases.water]
hulls = ["barge"]
compute = {{ panel_size = 5, symmetric = true, frequencies = {{ first = 0.4, last = 0.8, count = 3 }} }}

[simulate]
step = "0.1 s"
output_interval = "0.5 s"
duration = "1 s"
"""

MESH_ONLY = ["databases="]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("loading") / "barge"
    made.mkdir()
    (made / "case.toml").write_text(CASE)
    assert run_case(load_case(made, MESH_ONLY), stages=("mesh", "modes")).message == ""
    return made


def test_masses_before_there_is_a_scene_are_those_of_the_scene(folder: Path) -> None:
    case, out = load_case(folder, MESH_ONLY), OutputFolder(folder / "out")
    found = case_loading(case, "barge", out)
    assert found.bodies == ("boom", "mast")
    assert found.left_out == ()
    assert found.mass == pytest.approx(ALL, rel=1e-12)
    np.testing.assert_allclose(found.centre, [0.0, 0.0, (BOOM * 6.0 + MAST * 5.0) / ALL], atol=1e-12)
    scene = scene_loading(assemble_scene(case, out), ("barge",), "barge")
    assert scene.mass == pytest.approx(found.mass, rel=1e-12)
    np.testing.assert_allclose(scene.centre, found.centre, atol=1e-12)


def test_a_body_that_begins_elsewhere_is_counted_there(folder: Path) -> None:
    moved = ["bodies.boom.initial={position = [12, 3, 6]}", *MESH_ONLY]
    found = case_loading(load_case(folder, moved), "barge", OutputFolder(folder / "out"))
    np.testing.assert_allclose(found.centre[:2], [0.0, BOOM * 3.0 / ALL], atol=1e-12)


def test_panels_lie_as_deep_as_the_loaded_hull_floats(folder: Path) -> None:
    case, out = load_case(folder), OutputFolder(folder / "out")
    position = resting_position(case, "barge", out)
    assert position.mass == pytest.approx(ALL, rel=1e-12)
    assert max(abs(position.pose.trim), abs(position.pose.list)) < 1e-9
    inputs = bem_inputs(case, case.databases["water"], out)
    still = hydrostatics(inputs.hulls[0], RHO, 9.81, inputs.reference_points[0])
    assert still.volume == pytest.approx(ALL / RHO, rel=1e-9)
    linear = linear_restoring(case, "barge", out)
    assert linear.volume == pytest.approx(ALL / RHO, rel=1e-9)


@pytest.mark.slow
def test_hydrostatics_counts_the_same(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert (
        app(["hydrostatics", str(folder), "--set", MESH_ONLY[0], "--json"], result_action="return_value") == 0
    )
    (hull,) = json.loads(capsys.readouterr().out)["hulls"]
    assert hull["carries"] == ["boom", "mast"]
    case, out = load_case(folder), OutputFolder(folder / "out")
    position = resting_position(case, "barge", out)
    for name in ("displacement", "draft", "GM_T", "GM_L"):
        found = position.mass if name == "displacement" else getattr(position, name)
        assert hull["figures"][name] == pytest.approx(found, rel=1e-9)


def test_a_list_is_told_with_what_is_counted(folder: Path) -> None:
    aside = ["bodies.boom.centre_of_mass=[12, 3, 6]", "joints.1.between=['mast', 'ground']"]
    case = load_case(folder, aside)
    with pytest.raises(InputError, match=r"list of -?[0-9.]+ and a trim .*, carrying boom") as caught:
        bem_inputs(case, case.databases["water"], OutputFolder(folder / "out"))
    assert "what joints hold on it" in caught.value.expected


def test_a_database_depends_on_what_the_hull_carries(folder: Path) -> None:
    def digest(*overrides: str) -> str:
        case = load_case(folder, overrides)
        return database_digest(case, case.databases["water"])

    assert digest() == digest("bodies.boom.inertia=[2e5, 3e6, 3e6]")
    assert digest() != digest("bodies.boom.mass=41000")
    assert digest() != digest("bodies.mast.material.density=7900")
    assert digest() != digest("joints.0.between=['ground', 'boom']")


def test_what_two_hulls_carry_together_is_counted_on_neither() -> None:
    """How they share it is not known before the equilibrium; a boom on one of them counts on that one."""
    frame = np.eye(3)
    bodies = tuple(
        RigidBody(name, mass, frame, position=np.array([x, 0.0, 0.0]))
        for name, mass, x in (("a", 1e6, 0.0), ("b", 2e6, 50.0), ("bridge", 3e5, 25.0), ("boom", 1e5, 0.0))
    )
    pairs = (("a", "bridge"), ("bridge", "b"), ("boom", "b"))
    joints = tuple(Ball(name=f"{one}_{two}", body_a=one, body_b=two) for one, two in pairs)
    scene = Scene(bodies=bodies, joints=joints)
    a, b = (scene_loading(scene, ("a", "b"), name) for name in ("a", "b"))
    assert (a.mass, a.bodies) == (1e6, ())
    assert (b.mass, b.bodies) == (2.1e6, ("boom",))
    assert a.left_out == ("bridge ('b' carries a part of it)", "joints to b")
    assert b.left_out[0] == "bridge ('a' carries a part of it)"


def test_what_hangs_on_ropes_keeps_a_hull_level(folder: Path) -> None:
    aft = f"bodies.barge.centre_of_mass=[{TRIMMED - 1.0!r}, 0, 0]"  # against 1.2e5 kg at 10 m
    out = OutputFolder(folder / "out")
    with pytest.raises(InputError, match=r"a hull that floats upright.*'hanging'"):
        linear_restoring(load_case(folder, [aft, *MESH_ONLY]), "barge", out)
    hung = "hulls.barge.hanging={mass = 1.2e5, point = [10, 0, 12]}"
    linear = linear_restoring(load_case(folder, [aft, hung, *MESH_ONLY]), "barge", out)
    assert linear.volume == pytest.approx((ALL + 1.2e5) / RHO, rel=1e-9)


LINK = """
[[link_beams]]
name = "ramp"
hinged_on = "barge"
hinge = [20, 0, 2.5]
rests_on = "RESTS"
edge = [28, 0, 2.5]
length = "10 m"
breadth = "4 m"
mass = "40 t"
"""

OTHER = """
[bodies.other]
type = "rigid"
mass = "1000 t"
inertia = [1e7, 1e7, 1e7]
frame = { motion = "free" }
initial = { position = [48, 0, 0] }
[[surfaces]]
name = "other_skin"
body = "other"
shape = { type = "box", size = [40, 16, 5] }
[hulls.other]
surface = "other_skin"
"""


@pytest.mark.parametrize("rests_on", ["ground", "other"])
def test_a_link_beam_is_carried_by_both_that_it_lies_on(
    tmp_path: Path, rests_on: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Half at the hinge, half at the bearing: of a plate of 10 m whose shoe is 20 mm lower than its hinge."""
    link = LINK.replace("RESTS", rests_on)
    if rests_on == "other":
        link = OTHER + link.replace("[28, 0, 2.5]", "[-20, 0, 2.5]")
    text = CASE[: CASE.index("[databases.water]")] + link
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    case = load_case(tmp_path)
    folder = OutputFolder(tmp_path / "out")
    run_case(case, stages=("mesh", "modes"))
    scene = assemble_scene(case, folder)
    hulls = ["barge", "other"] if rests_on == "other" else ["barge"]
    for loading in (scene_loading(scene, hulls, "barge"), case_loading(case, "barge", folder)):
        assert loading.bodies == ("boom", "mast", "ramp_plate")
        mass, place = loading.parts["ramp_plate"]
        reach = np.sqrt(100.0 - 0.02**2)
        assert mass == pytest.approx(20e3, rel=1e-5)
        np.testing.assert_allclose(place, [20.0, 0.0, 2.5], atol=1e-12)
        assert loading.mass == pytest.approx(ALL + 20e3)
        assert loading.centre[0] == pytest.approx(20e3 * 20.0 / (ALL + 20e3), abs=1e-5)
    if rests_on == "other":
        for loading in (scene_loading(scene, hulls, "other"), case_loading(case, "other", folder)):
            mass, place = loading.parts["ramp_plate"]
            assert mass == pytest.approx(20e3, rel=1e-5)
            np.testing.assert_allclose(place, [20.0 + reach - 48.0, 0.0, 2.5], atol=1e-4)
            assert loading.mass == pytest.approx(1020e3)
    with_water = text + CASE[CASE.index("[databases.water]") :]
    (tmp_path / "case.toml").write_text(with_water, encoding="utf-8")
    digests = set()
    for edge in (["link_beams.0.mass='40 t'"], ["link_beams.0.mass='50 t'"], ["link_beams.0.lip='30 mm'"]):
        changed = load_case(tmp_path, edge)
        digests.add(database_digest(changed, changed.databases["water"]))
    assert len(digests) == 3
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    capsys.readouterr()
    assert app(["hydrostatics", str(tmp_path), "--json"], result_action="return_value") == 0
    report = json.loads(capsys.readouterr().out)["hulls"][0]
    assert report["parts"] == {"ramp_plate": pytest.approx(20e3, rel=1e-5)}
    assert not any("bearing" in words or "ramp" in words for words in report["left_out"])
