"""The outer surface of a flexible body of a case in collisions: its triangles, a run, and what is shown of it."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.report.collisions import touching_surfaces
from heavylift.pipeline.results.storage import OutputFolder

CASE = """
title = "A slab on a block"

[gravity]
acceleration = [0, 0, "-10 m/s^2"]

[bodies.slab]
type = "flexible"
material = { young_modulus = "2 GPa", poisson_ratio = 0, density = "2000 kg/m^3" }
frame = { motion = "free", origin = "centre_of_mass" }
mesh = { element = "hex8", divisions = { x = [4], y = [2], z = [1] } }
modes = { count = 2, damping_ratio = 0.3 }
geometry = { type = "blocks", add = [{ name = "bar", from = [0, 0, 0], to = [2, 1, 0.2] }] }

[[surfaces]]
name = "underside"
body = "slab"
exclude = [{ centre = [1, 0.5, 0], size = [3, 2, 0.1], keep = "inside" }]

[[surfaces]]
name = "block"
body = "ground"
shape = { type = "box", size = [1, 0.6, 0.4] }
at = [1, 0.5, -0.2]

[[collisions]]
name = "touch"
between = ["block", "underside"]
law = "linear"
stiffness = "10 MN/m"
damping = "100 kN s/m"
patch_size = "5 m"

[simulate]
step = "1 ms"
output_interval = "10 ms"
duration = "0.3 s"
"""


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    return load_case(tmp_path)


def test_its_triangles_are_those_of_its_nodes(case, tmp_path):
    """In the frame of the body; those that do not reach into the box are left out, and so are their nodes."""
    folder = OutputFolder(tmp_path / "out")
    run_case(case, out=folder.root, stages=("mesh", "modes"))
    scene = assemble_scene(case, folder)
    (own,) = (one for one in scene.surfaces if one.name == "underside")
    reduced = scene.bodies[0].reduced
    np.testing.assert_array_equal(own.surface.points, reduced.nodes[own.nodes])
    low, high = own.surface.bounds
    np.testing.assert_allclose([low, high], [[-1.0, -0.5, -0.1], [1.0, 0.5, 0.1]], atol=1e-12)
    corners = own.surface.points[own.surface.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    under = normals[:, 2] < 0.0
    np.testing.assert_allclose(-0.5 * normals[under, 2].sum(), 2.0)
    assert not (normals[:, 2] > 0.0).any()


def test_it_runs_continues_and_is_shown(case, tmp_path):
    """The weight is carried; a picture has the deformed triangles where the body is."""
    folder = OutputFolder(tmp_path / "out")
    run_case(case, out=folder.root, stages=("mesh", "modes", "simulate"))
    results = load_results(case, folder.root)
    assert results["touch.force"][-1, 2] == pytest.approx(8000.0, rel=1e-3)
    seen = touching_surfaces(case, folder, results, "touch", -1)
    points = seen.surfaces[1].points
    assert points[:, 2].min() == pytest.approx(-8e-4, abs=2e-4)
    assert len(seen.places) >= 3
    again = load_case(tmp_path, ["simulate.duration=0.35 s"])
    run_case(again, out=folder.root, stages=("mesh", "modes", "simulate"))
    assert load_results(again, folder.root).time[-1] == pytest.approx(0.35)


def test_boxes_that_leave_nothing_are_refused(case, tmp_path):
    """With the key of the surface."""
    folder = OutputFolder(tmp_path / "out")
    run_case(case, out=folder.root, stages=("mesh", "modes"))
    empty = load_case(tmp_path, ["surfaces.0.exclude.0.centre=[50, 0, 0]"])
    with pytest.raises(InputError) as caught:
        assemble_scene(empty, folder)
    assert "surfaces.0.exclude" in str(caught.value)
