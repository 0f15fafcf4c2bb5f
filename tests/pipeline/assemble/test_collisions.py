"""Surfaces of a case: made once, placed on their bodies, made again when their files change."""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.collisions import assemble_collisions, collision_notes
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.assemble.surfaces import read_surface_file, stored_surface
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.provenance import report_digest, simulate_digest, surface_digest
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.scene.contacts import HuntCrossleyLaw, LinearLaw, RigidLaw


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "collisions"
    folder.mkdir()
    here = Path(__file__).parents[1]
    shutil.copyfile(here / "collisions.toml", folder / "case.toml")
    shutil.copyfile(here / "tank.stl", folder / "tank.stl")
    return folder


def mesh(case, out, **options):
    """Lines that the mesh stage says, and its report."""
    stream = io.StringIO()
    report = run_case(case, out=out, stages=("mesh",), log=Log(stream=stream), **options)
    return stream.getvalue().splitlines(), report.stages[0]


def corners(surface):
    """Lowest and highest corner of the triangles."""
    return surface.bounds.round(12).tolist()


def test_the_mesh_stage_makes_surfaces_once(folder, tmp_path):
    case, out = load_case(folder), OutputFolder(tmp_path / "out")
    lines, stage = mesh(case, out.root)
    assert not stage.skipped
    assert any("plating: 10 triangles, 8 points, 4 open edges, 2 more are excluded" in line for line in lines)
    assert any("skin: round, radius 0.2 m" in line for line in lines)
    made = {name: out.surface(name).read_bytes() for name in ("plating", "floor", "bollard", "skin")}
    assert not out.surface("strand").exists()  # of a frame: its own shape
    lines, stage = mesh(case, out.root)
    assert stage.skipped
    assert sum("unchanged, skipped" in line for line in lines) == 4
    mesh(case, out.root, force=("mesh",))
    assert {name: out.surface(name).read_bytes() for name in made} == made  # to the last bit


def test_a_second_look_at_surfaces_imports_no_heavy_library(folder, tmp_path):
    mesh(load_case(folder), tmp_path / "out")
    code = (
        "import sys\n"
        "from heavylift.pipeline import load_case, run_case\n"
        f"report = run_case(load_case({str(folder)!r}), out={str(tmp_path / 'out')!r}, stages=['mesh'])\n"
        "assert report.stages[0].skipped\n"
        "heavy = {'numba', 'scipy', 'gmsh', 'trimesh', 'matplotlib', 'pint', 'h5py', 'meshio'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_a_changed_file_makes_its_surface_and_all_that_follows_stale(folder, tmp_path):
    case, out = load_case(folder), OutputFolder(tmp_path / "out")
    mesh(case, out.root)
    before = simulate_digest(case), report_digest(case, out)
    text = (folder / "tank.stl").read_text()
    (folder / "tank.stl").write_text(text.replace("-250", "-260"))
    assert simulate_digest(case) != before[0]
    assert report_digest(case, out) != before[1]
    lines, stage = mesh(case, out.root)
    assert not stage.skipped
    assert [line.split(":")[1].strip() for line in lines if "triangles" in line] == ["plating"]
    assert read_surface_file(out.surface("plating")).whole.bounds[0, 2] == pytest.approx(-0.16, abs=1e-15)


def test_a_damaged_file_is_made_anew_and_another_folder_lends_its_own(folder, tmp_path):
    case, out, other = load_case(folder), OutputFolder(tmp_path / "out"), tmp_path / "other"
    mesh(case, out.root)
    whole = out.surface("plating").read_bytes()
    out.surface("plating").write_bytes(whole[:100])
    with pytest.raises(InputError, match="is damaged"):
        read_surface_file(out.surface("plating"))
    lines, _ = mesh(case, other, reuse=[out.root])
    assert any("floor: unchanged, taken from" in line for line in lines)
    assert any("plating: 10 triangles" in line for line in lines)
    lines, _ = mesh(case, out.root)
    assert any("is damaged, read again" in line for line in lines)
    assert out.surface("plating").read_bytes() == whole


def test_what_is_stored_is_taken_only_if_it_is_of_the_same_inputs(folder, tmp_path):
    case, out = load_case(folder), OutputFolder(tmp_path / "out")
    mesh(case, out.root)
    larger = load_case(folder, ["surfaces.1.shape.size=[30, 10]"])
    assert corners(stored_surface(larger, 1, out).surface) == [[-15.0, -5.0, 0.0], [15.0, 5.0, 0.0]]
    assert corners(stored_surface(case, 1, out).surface) == [[-10.0, -5.0, 0.0], [10.0, 5.0, 0.0]]
    # the body that carries it moves it about, and changes none of its triangles
    assert surface_digest(case, case.surfaces[1]) == surface_digest(
        larger, larger.surfaces[1].model_copy(update={"shape": case.surfaces[1].shape})
    )


def test_surfaces_are_in_the_frames_of_their_bodies(folder):
    case = load_case(folder)
    scene = assemble_scene(case, OutputFolder(folder / "out"))
    found = {part.name: part for part in scene.surfaces}
    # a box of 2 m x 1 m x 0.5 m turned by 90 degrees about z, at the centre of mass, without its top
    assert corners(found["plating"].surface) == [[-0.5, -1.0, -0.25], [0.5, 1.0, 0.25]]
    assert len(found["plating"].surface.triangles) == 10
    assert corners(found["floor"].surface) == [[-10.0, -5.0, 0.0], [10.0, 5.0, 0.0]]
    assert corners(found["bollard"].surface) == [[1.8, -0.2, 0.0], [2.2, 0.2, 1.0]]
    assert found["skin"].surface.radius == 0.2
    assert (found["strand"].surface, found["strand"].facets, found["strand"].body) == (None, 3, "rope")


def test_rounding_keeps_the_size_of_boxes_and_thickens_planes(folder):
    case = load_case(
        folder,
        [
            "surfaces.1.radius=10 mm",
            'surfaces.2.shape={type="box", size=[1, 2, 3]}',
            "surfaces.2.at=[0, 0, 0]",
            "surfaces.2.radius=100 mm",
            'surfaces.3.shape={type="capsule", radius=0.1, length=1, axis=[2, 0, 0]}',
        ],
    )
    _, floor, box, capsule, _ = assemble_scene(case, OutputFolder(folder / "out")).surfaces
    assert corners(floor.surface) == [[-10.01, -5.01, -0.01], [10.01, 5.01, 0.01]]
    assert corners(box.surface) == [[-0.5, -1.0, -1.5], [0.5, 1.0, 1.5]]
    assert corners(capsule.surface) == [[-0.6, -0.1, -0.1], [0.6, 0.1, 0.1]]


def test_laws_are_those_of_contacts(folder):
    collisions = {part.name: part for part in assemble_collisions(load_case(folder))}
    landing, bump, fender, soft = (collisions[name] for name in ("landing", "bump_5", "fender", "soft"))
    assert landing.surfaces == ("floor", "plating")
    assert (landing.law, landing.friction) == (RigidLaw(0.5, 0.05, events=True), 0.3)
    assert bump.law == HuntCrossleyLaw(pytest.approx(1e3 * 1e-3**-1.5), 1.5, 0.8)
    assert (bump.surfaces, bump.recorded) == (("skin", "strand"), 2)
    assert (fender.law, fender.patch_size) == (LinearLaw(1e6, 1e4), 0.3)
    # tau = 1 ms (1 / 0.8 - 1) / 4
    assert soft.law.stiffness == pytest.approx(1e6, rel=1e-14)
    assert soft.law.damping == pytest.approx(1e6 * 1e-3 * 0.25 / 4.0, rel=1e-13)


def test_a_note_says_what_parameters_of_the_thesis_mean(folder):
    (note,) = collision_notes(load_case(folder))
    assert note.startswith("soft: epsilon = 1e-06 m/N is a spring of 1 MN/m a patch, whatever the step")
    assert "gamma = 0.8 is no restitution coefficient" in note
    assert "a damper of 62.5 N s/m" in note


def test_a_file_in_millimetres_is_noticed_with_its_box(folder, tmp_path):
    lines, _ = mesh(load_case(folder, ["surfaces.0.unit=m"]), tmp_path / "out")
    (line,) = [line for line in lines if "WARNING" in line and "plating is" in line and "bollard" in line]
    assert "is it in mm" in line
    assert "(-500, -1000, -249.9) to (500, 1000, 250.1) m" in line
    assert not any("WARNING" in line for line in mesh(load_case(folder), tmp_path / "right")[0])


def test_the_keeping_box_keeps_what_reaches_into_it(folder):
    box = "surfaces.0.exclude=[{centre=[0, 0, 0.35], size=[0.2, 0.2, 0.1], keep='inside'}]"
    surface = assemble_scene(load_case(folder, [box]), OutputFolder(folder / "out")).surfaces[0].surface
    # only the top reaches into a small box in its middle
    np.testing.assert_allclose(surface.points[:, 2], 0.25, atol=1e-12)
    assert len(surface.triangles) == 2
