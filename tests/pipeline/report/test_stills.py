"""Pictures of scenes without frames and shells: hulls and water, boxes of inertia, ropes, moorings, what is around."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.commands.new_case import new_case
from heavylift.pipeline.drawn.build import EXACT, Sources, draw_scene
from heavylift.pipeline.pictures.contacts import touch_picture
from heavylift.pipeline.pictures.parts import Seen
from heavylift.pipeline.pictures.render import Drawing, Lines, Patch
from heavylift.pipeline.pictures.scene import SolidPainter
from heavylift.pipeline.pictures.scene_view import SceneView
from heavylift.pipeline.report.scene import is_pictured, scene_view
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.sea import Sea, Water
from heavylift.solver.water.waves.spectra import jonswap
from heavylift.solver.water.waves.wave_trains import irregular_waves


class Recorded(dict):
    """Channels of a run of two records."""

    time = np.array([0.0, 2.0])
    meshes: ClassVar = {}


def others(kind, tmp_path, results=None, more=""):
    """What is drawn of a case to begin with."""
    new_case(kind, tmp_path / kind)
    if more:
        file = tmp_path / kind / "case.toml"
        file.write_text(file.read_text() + more)
    case = load_case(tmp_path / kind)
    assert is_pictured(case)
    return scene_view(case, OutputFolder(case.output_folder), results or Recorded(), [0])


def seen(kind, tmp_path, results=None):
    """The same at its start."""
    return others(kind, tmp_path, results).seen(0)


def sizes(patches):
    return sorted(tuple(np.round(np.ptp(patch.points, axis=0), 9)) for patch in patches)


def test_a_hull_is_seen_although_nothing_collides_with_it(tmp_path):
    """Plating of 100 x 30 x 8 m, half a metre above where it floats, and its cargo on deck."""
    patches = seen("barge", tmp_path).patches
    assert sizes(patches) == [(10.0, 10.0, 4.0), (100.0, 30.0, 8.0)]
    lowest = min(patch.points[:, 2].min() for patch in patches)
    assert lowest == pytest.approx(0.5 - 4.0)


def test_ropes_run_from_lug_to_hook(tmp_path):
    """Four slings of sqrt(5^2 + 3^2 + 10^2) m and 26 m of hoist rope."""
    found = seen("lift", tmp_path)
    lengths = sorted(
        float(np.linalg.norm(np.diff(line.points, axis=0), axis=1).sum())
        for line in found.lines
        if line.colour == "#7a4a12"
    )
    assert lengths == pytest.approx([np.sqrt(134.0)] * 4 + [26.0])
    hook = 3 * (round(np.sqrt(6.0), 9),)  # 5 t with 5 t m^2 about each axis, as a cube
    assert sizes(found.patches) == [hook, (12.0, 8.0, 4.0)]


def test_ground_is_drawn_around_bodies_and_not_looked_at(tmp_path):
    """A ramp of 8 m is drawn as far as a crate of 1 m slides, half of the diagonal of its box more on each side."""
    moved = Recorded({"crate.position": np.array([[-1.7, 0.0, 1.15], [1.14, 0.0, 0.12]])})
    for number, results in enumerate((None, moved)):
        (tmp_path / str(number)).mkdir()
        found = seen("contact", tmp_path / str(number), results)
        (crate,) = found.patches
        (ramp,) = found.around
        assert len(found.points) < len(crate.points) + len(ramp.points) + 10
        slid = crate.points + np.array([2.84 * number, 0.0, -1.03 * number])
        corners = np.concatenate([crate.points, slid])
        low, high = corners.min(axis=0), corners.max(axis=0)
        margin = 0.5 * np.linalg.norm(high - low) + 1e-9
        assert np.all((ramp.points >= low - margin) & (ramp.points <= high + margin))
        assert np.ptp(ramp.points[:, 0]) > 1.5 * np.ptp(crate.points[:, 0])


MOORING = """
[[lines]]
name = "bow"
between = ["ground", "barge"]
points = [[-700, 0, -100], [-50, 0, 4]]
seabed = -100
sections = [{ length = 680, weight = 1000, axial_stiffness = 1e9 }]

[[fenders]]
name = "quay"
between = ["ground", "barge"]
points = [[0, 16, 2], [0, 15, 2]]
direction = [0, -1, 0]
stiffness = 1e6
"""


def test_moorings_are_catenaries_that_a_picture_does_not_look_at(tmp_path):
    """A line of 680 m from an anchor at 100 m of depth, beside a barge of 100 m: some of it lies on the bottom."""
    found = others("barge", tmp_path, more=MOORING)
    near, far = found.seen(0), found.moorings(0)
    assert near.points[:, 0].min() > -60.0
    assert far.points[:, 0].min() == pytest.approx(-700.0)
    assert found.reaches_far
    line = max(far.lines, key=lambda part: np.ptp(part.points[:, 0]))
    lying = line.points[np.abs(line.points[:, 2] + 100.0) < 1e-9]
    assert 100.0 < np.ptp(lying[:, 0]) < 600.0
    assert np.linalg.norm(np.diff(line.points, axis=0), axis=1).sum() == pytest.approx(680.0, rel=1e-3)
    fender = min(near.patches, key=lambda part: np.ptp(part.points[:, 1]))
    assert fender.points[:, 1].min() == pytest.approx(16.0)  # its face is at its tip, all else on the quay
    water = min((part for part in near.around if isinstance(part, Patch)), key=lambda part: part.opacity)
    np.testing.assert_allclose(water.points[:, 2], 0.0)
    assert water.points[:, 0].min() < -100.0


def test_waves_on_a_grid_are_those_of_the_sea():
    waves = irregular_waves(jonswap(3.0, 9.0), direction=0.7, seed=4, count=30, spreading=4.0, directions=5)
    x, y = np.linspace(-80.0, 90.0, 7), np.linspace(-40.0, 30.0, 5)
    expected = waves.elevation(*np.meshgrid(x, y, indexing="ij"), 12.5)
    sea = Sea(water=Water(), waves=waves)
    water = draw_scene(
        Scene((RigidBody("buoy", 1.0, np.eye(3)),), sea=sea), sources=Sources(water=True)
    ).water
    np.testing.assert_allclose(water.elevations(x, y, 12.5), expected, atol=1e-12)


def test_what_hides_other_bodies_is_seen_through():
    """A block of 10 kg whose inertia is that of a cube of 2 m stands 0.5 m from another one; not one 5 m away."""
    for place, opacity in ((0.5, 0.3), (5.0, 1.0)):
        bodies = (
            RigidBody("large", 10.0, 20.0 / 3.0 * np.eye(3)),
            RigidBody("small", 1.0, 1e-3 * np.eye(3), position=np.array([place, 0.0, 0.0])),
        )
        found = SceneView(draw_scene(Scene(bodies), detail=EXACT)).seen(0)
        assert sizes(found.patches)[-1] == (2.0, 2.0, 2.0)
        assert [patch.opacity for patch in found.patches] == [opacity, opacity]


class Sketch:
    """Takes what would be drawn."""

    def __init__(self):
        self.drawings: list[Drawing] = []

    def render(self, drawing, _camera, size):
        self.drawings.append(drawing)
        return np.full((size[1], size[0], 3), 255, dtype=np.uint8)


def test_a_mechanism_of_lines_alone_has_a_picture():
    rod = Lines(np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 1]]), np.array([[0, 1], [1, 2]]))
    sketch = Sketch()
    assert touch_picture(sketch, Seen((rod,)), title="rods")[:8] == b"\x89PNG\r\n\x1a\n"
    assert touch_picture(sketch, Seen(), title="nothing") is None
    (drawing,) = sketch.drawings
    assert len(drawing.points) == 1  # without triangles points are drawn: not every corner of a line


def test_corners_of_a_box_are_outlined(tmp_path):
    """Twelve edges of a box, and not the diagonals of its faces."""
    sketch = Sketch()
    patch = seen("lift", tmp_path).patches[0]
    touch_picture(sketch, Seen(patches=(patch,)), title="box")
    (outline,) = sketch.drawings[0].lines
    lengths = np.linalg.norm(np.diff(outline.points[outline.ends], axis=1)[:, 0], axis=1)
    assert sorted(np.round(lengths, 9)) == [4.0] * 4 + [8.0] * 4 + [12.0] * 4


def test_pictures_of_a_run_have_one_camera():
    """A weight that falls 5 m stays within the picture and gets lower in it, and the view does not move."""
    line = Lines(np.array([[0.0, 0, 0], [1, 0, 1]]), np.array([[0, 1]]))

    class Falling:
        def seen(self, record, *, around=True):
            water = (Patch(9.0 * line.points, np.array([[0, 1, 2]])),) if around else ()
            return Seen((Lines(line.points - [0.0, 0.0, 5.0 * record], line.ends),), around=water)

    class Watching(Sketch):
        def __init__(self):
            super().__init__()
            self.cameras = []

        def render(self, drawing, camera, size):
            self.cameras.append(camera)
            return super().render(drawing, camera, size)

    sketch = Watching()
    painter = SolidPainter(sketch, Falling(), np.array([0.0, 1.0]), words="", up=(0.0, 0.0, 1.0))
    assert not painter.empty
    assert all(png[:4] == b"\x89PNG" for png in painter.resized(400, 300).images([0, 1], title="falls"))
    first, second = (
        camera.project(drawing.lines[0].points)
        for camera, drawing in zip(sketch.cameras, sketch.drawings, strict=True)
    )
    assert np.all((first[:, :2] > 0.0) & (first[:, :2] < 1.0))
    assert np.all((second[:, :2] > 0.0) & (second[:, :2] < 1.0))
    assert second[0, 1] < first[0, 1]
    assert sketch.cameras[0] is sketch.cameras[1]


def test_scattered_bodies_have_a_picture_of_the_largest_one():
    """Two cubes of 2 m and one of 4 m that stand 300 m apart: the large one fills a picture, with its own scale."""
    bodies = tuple(
        RigidBody(name, 6.0, side**2 * np.eye(3), position=np.array([300.0 * number, 0.0, 0.0]))
        for number, (name, side) in enumerate((("a", 2.0), ("b", 4.0), ("c", 2.0)))
    )
    found = SceneView(draw_scene(Scene(bodies), detail=EXACT))
    assert found.scattered
    np.testing.assert_allclose(found.largest(0).points.mean(axis=0), [300.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(np.ptp(found.largest(0).points, axis=0), 4.0)
    near = Scene(tuple(replace(body, position=0.01 * body.position) for body in bodies))
    assert not SceneView(draw_scene(near, detail=EXACT)).scattered
