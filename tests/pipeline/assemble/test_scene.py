"""Points of forces, sensors and static loads lie on the body they name; errors name the key of the case file."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder

PUSH = "forces=[{{name='push', body='beam', point={}, force=[1, 0, 0]}}]"


@pytest.fixture(scope="module")
def reduced(tmp_path_factory):
    """Case folder whose mesh and modes are made."""
    import shutil

    folder = tmp_path_factory.mktemp("small_beam")
    shutil.copyfile(Path(__file__).parents[1] / "small_beam.toml", folder / "case.toml")
    run_case(load_case(folder), stages=("mesh", "modes"))
    return folder


# the bar is 200 mm x 20 mm x 10 mm with bricks of 25 mm x 20 mm x 10 mm
@pytest.mark.parametrize("point", ["[0.2, 0.02, 0.01]", "['187.5 mm', '10 mm', '5 mm']", "[0.2019, 0.01, 0]"])
@pytest.mark.parametrize("key", ["sensors.0.point", "forces.0.point"])
def test_points_between_the_nodes_are_on_the_body(reduced, key, point):
    override = f"{key}={point}" if key.startswith("sensors") else PUSH.format(point)
    scene = assemble_scene(load_case(reduced, [override]), OutputFolder(reduced / "out"))
    assert len(scene.sensors) == 1


@pytest.mark.parametrize("key", ["sensors.0.point", "forces.0.point"])
def test_a_point_off_the_body_is_refused(reduced, key):
    point = "[0.3, 0.02, 0.01]"
    override = f"{key}={point}" if key.startswith("sensors") else PUSH.format(point)
    with pytest.raises(InputError) as caught:
        assemble_scene(load_case(reduced, [override]), OutputFolder(reduced / "out"))
    assert caught.value.key == key
    assert caught.value.source == str(reduced / "case.toml")
    assert "(300, 20, 10) mm" in caught.value.problem
    assert "(200, 20, 10) mm, is 100 mm away" in caught.value.problem
    assert "a point on the body" in caught.value.expected
    assert "units" in caught.value.expected


def test_points_are_measured_from_the_geometry_not_from_the_frame(reduced, tmp_path):
    free = ("bodies.beam.frame={motion='free', origin='centre_of_mass'}", "bodies.beam.modes.clamp=[]")
    run_case(load_case(reduced, free), out=tmp_path, stages=("mesh", "modes"))
    assemble_scene(load_case(reduced, free), OutputFolder(tmp_path))
    with pytest.raises(InputError, match=r"sensors\.0\.point"):
        assemble_scene(
            load_case(reduced, [*free, "sensors.0.point=[-0.1, -0.01, -0.005]"]), OutputFolder(tmp_path)
        )


def errors(folder, *overrides):
    with pytest.raises(InputError) as caught:
        run_case(load_case(folder, overrides), stages=("mesh", "modes"))
    return str(caught.value)


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        ("bodies.beam.modes.count=97", "modes.count", "97 modes requested; expected 1 to 96"),
        (
            "bodies.beam.geometry.groups={root={plane='x', at=0}, left={plane='x', at='3 mm'}}",
            "geometry.groups.left",
            "no node at x = 0.003 m",
        ),
        (
            "bodies.beam.modes.static_points=[[0.2, 0, 0], [2, 0, 0]]",
            "modes.static_points.1",
            "point (2000, 0, 0) mm",
        ),
        ("bodies.beam.mesh.divisions.x=[4, 4]", "mesh.divisions.x", ""),
    ],
)
def test_errors_of_the_stages_name_the_key_of_the_case(small_case, override, key, words):
    text = errors(small_case, override)
    assert text.startswith(f"{small_case / 'case.toml'}: bodies.beam.{key}: {words}"), text
    assert not re.search(r"beam: (beam|finite)", text)


def test_a_mesh_size_that_leaves_one_reduced_brick_is_refused(small_case):
    mesh = "{{element='hex8', formulation='{}', size='10 mm'}}"
    text = errors(small_case, "bodies.beam.mesh=" + mesh.format("reduced"))
    assert "bodies.beam.mesh.divisions.z: one brick with reduced integration" in text
    run_case(
        load_case(small_case, ["bodies.beam.mesh=" + mesh.format("incompatible")]), stages=("mesh", "modes")
    )


def test_a_scene_imports_only_what_it_has(tmp_path):
    """A load on a rope: no contours, surfaces, meshes or water, no files of units, pictures or results."""
    case = Path(__file__).parents[3] / "cases" / "hoist"
    code = (
        "import sys\n"
        "from heavylift.pipeline import load_case\n"
        "from heavylift.pipeline.assemble.scene import assemble_scene\n"
        "from heavylift.pipeline.results.storage import OutputFolder\n"
        "from pathlib import Path\n"
        f"assemble_scene(load_case({str(case)!r}), OutputFolder(Path({str(tmp_path)!r})))\n"
        "parts = ('collisions', 'contacts', 'databases', 'edges', 'hulls', 'lines', 'meshes', 'sea', 'surfaces')\n"
        "unwanted = {'heavylift.pipeline.assemble_' + part for part in parts}\n"
        "unwanted |= {'h5py', 'matplotlib', 'pint', 'pyvista', 'scipy.optimize', 'scipy.sparse', 'trimesh'}\n"
        "print(sorted(unwanted & set(sys.modules)))\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_an_initial_orientation_turns_what_is_fixed_to_the_body(tmp_path):
    # a quarter about z takes x of the body to y of the world, as the channel says with its matrix from body to world
    (tmp_path / "case.toml").write_text(
        """title = "turned"
[bodies.box]
type = "rigid"
mass = 1
inertia = [1, 1, 1]
frame = { motion = "free" }
initial = { orientation = { axis = [0, 0, 1], angle = "90 deg" } }
[[sensors]]
name = "tip"
body = "box"
point = [1, 0, 0]
[simulate]
step = 0.1
output_interval = 0.1
duration = 0.1
"""
    )
    run_case(load_case(tmp_path), stages=("simulate",))
    found = load_results(tmp_path)
    np.testing.assert_allclose(found["tip.position"][0], [0.0, 1.0, 0.0], atol=1e-15)
    R = rotation_matrix(found["box.orientation"][0])
    np.testing.assert_allclose(R @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15)
