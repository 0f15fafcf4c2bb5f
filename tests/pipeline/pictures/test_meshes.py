"""Frames and shells in pictures: smooth shapes, stresses at the right places, honest labels."""

import io

import numpy as np
import pytest

from heavylift.numerics.rotation import quaternion_from_rotation_vector, rotation_matrix
from heavylift.pipeline.drawn.build import EXACT, Sources, draw_scene
from heavylift.pipeline.drawn.rods import shortest_tree
from heavylift.pipeline.drawn.ropes import rope_points
from heavylift.pipeline.drawn.skins import MeshRun, MeshSkin, rest_coordinates
from heavylift.pipeline.pictures.meshes import join
from heavylift.pipeline.pictures.render import Renderer, RenderingUnavailableError, rendering_backend
from heavylift.pipeline.pictures.scene import ScenePainter
from heavylift.pipeline.pictures.scene_view import SceneView
from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.joints.ball import Ball
from heavylift.solver.scene.connections import JointFrame, RopePoint
from heavylift.solver.scene.meshes import FrameBody, FrameSection, ShellBody, ShellSection
from heavylift.solver.scene.scene import RigidBody, Scene

E, NU, T = 2.1e11, 0.3, 0.01
LENGTH, WIDTH, BAR = 3.0, 2.0, 0.02


def plate(nx=12, ny=3):
    x, y = np.meshgrid(np.linspace(0, LENGTH, nx + 1), np.linspace(0, WIDTH, ny + 1), indexing="ij")
    nodes = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    ids = np.arange(len(nodes)).reshape(x.shape)
    corners = (ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:])
    elements = np.column_stack([corner.ravel() for corner in corners])
    return ShellBody(
        name="plate",
        nodes=nodes,
        slopes=np.tile(np.diag([1.0, 1.0, 0.0]), (len(nodes), 1, 1)),
        elements=elements,
        lengths=np.tile([LENGTH / nx, WIDTH / ny], (len(elements), 1)),
        sections=(ShellSection(T, 7850.0, E, NU),),
    )


def beam(count=16, diameter=BAR, **pose):
    nodes = np.zeros((count + 1, 3))
    nodes[:, 0] = np.linspace(0.0, LENGTH, count + 1)
    c = 0.5 * diameter
    return FrameBody(
        name="beam",
        nodes=nodes,
        tangents=np.tile([1.0, 0.0, 0.0], (count + 1, 1)),
        elements=np.column_stack([np.arange(count), np.arange(1, count + 1)]),
        sections=(FrameSection(7850.0, E, np.pi * c**2, np.pi * c**4 / 4, c),),
        model="exact",
        **pose,
    )


def rolled(body, angle):
    """Vectors of the nodes of a body along x, turned about y into an arc that rises."""
    if angle == 0.0:
        return rest_coordinates(body)
    x, y, _ = body.nodes.T
    t = x * angle / LENGTH
    zero = np.zeros_like(x)
    places = np.column_stack([LENGTH / angle * np.sin(t), y, LENGTH / angle * (1.0 - np.cos(t))])
    along = np.column_stack([np.cos(t), zero, np.sin(t)])
    if isinstance(body, FrameBody):
        return np.stack([places, along], axis=1)
    return np.stack([places, along, np.tile([0.0, 1.0, 0.0], (len(x), 1)), 0 * places], axis=1)


@pytest.fixture(scope="module")
def renderer():
    try:
        rendering_backend()
    except RenderingUnavailableError as error:
        pytest.skip(str(error))
    with Renderer() as drawer:
        yield drawer


def pixels(png):
    from PIL import Image

    with Image.open(io.BytesIO(png)) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def area(skin):
    corner = skin.points[skin.triangles]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    return 0.5 * np.linalg.norm(cross, axis=1).sum(), cross


def test_shell_is_a_smooth_cylinder_with_the_von_mises_stress_of_pure_bending():
    body, angle = plate(), 1.6 * np.pi
    radius = LENGTH / angle
    skin = MeshSkin(body).skin(rolled(body, angle))
    np.testing.assert_allclose(np.hypot(skin.points[:, 0], skin.points[:, 2] - radius), radius, rtol=2e-4)
    total, cross = area(skin)
    assert total == pytest.approx(LENGTH * WIDTH, rel=2e-3)  # 72 chords of a circle
    expected = E * T / (2 * radius * (1 - NU**2)) * np.sqrt(1 - NU + NU**2)
    np.testing.assert_allclose(skin.values, expected, rtol=0.02)
    assert skin.largest == skin.values.max()
    # triangles wind about the normals, which point to the axis
    at = skin.normals[skin.triangles[:, 0]]
    assert np.all(np.sum(cross * at, axis=1) > 0.0)
    inward = np.column_stack([-skin.points[:, 0], 0 * skin.points[:, 0], radius - skin.points[:, 2]])
    assert np.all(np.sum(inward * skin.normals, axis=1) > 0.999 * radius)


def test_border_of_a_shell_is_closed_and_sides_of_elements_are_counted():
    body = plate(4, 3)
    skin = MeshSkin(body).skin(rest_coordinates(body))
    ends = skin.points[skin.outline]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(2 * (LENGTH + WIDTH))
    ends = skin.points[skin.edges]
    every = 2 * (3 * LENGTH + 4 * WIDTH)  # four sides an element
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(every)


def test_tube_is_pulled_outside_and_pushed_inside_of_a_bend():
    body, angle = beam(32), 2 * np.pi
    radius = LENGTH / angle
    skin = MeshSkin(body).skin(rolled(body, angle))
    distance = np.hypot(skin.points[:, 0], skin.points[:, 2] - radius)
    bending = E * 0.5 * BAR / radius
    # stress of a fibre grows linearly with its distance from the axis of the bend
    np.testing.assert_allclose(skin.values, E * (distance - radius) / radius, atol=0.004 * bending)
    assert skin.largest == pytest.approx(bending, rel=0.004)
    assert distance.max() == pytest.approx(radius + 0.5 * BAR, rel=1e-4)
    assert area(skin)[0] > np.pi * BAR * LENGTH * 0.98


def test_tube_is_closed_and_faces_outwards():
    body = beam(1)
    turn = rotation_matrix(quaternion_from_rotation_vector([0.3, 1.9, -0.7]))
    skin = MeshSkin(body, widening=5.0).skin(rest_coordinates(body) @ turn.T)
    corner = skin.points[skin.triangles]
    volume = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() / 6.0
    round_bar = np.pi * (2.5 * BAR) ** 2 * LENGTH
    assert volume == pytest.approx(round_bar * 16 / (2 * np.pi) * np.sin(2 * np.pi / 16), rel=1e-9)


def test_larger_displacements_are_drawn_with_the_stress_of_the_true_ones():
    body = plate(4, 2)
    rest, now = rest_coordinates(body), rolled(body, 0.01)
    maker = MeshSkin(body)
    true, drawn = maker.skin(now), maker.skin(now, rest + 50.0 * (now - rest))
    start = maker.skin(rest).points
    np.testing.assert_allclose(drawn.points - start, 50.0 * (true.points - start), atol=1e-12)
    np.testing.assert_array_equal(drawn.values, true.values)
    both = join([true, maker.skin(rest)])
    assert both.largest == true.largest
    assert both.triangles.max() == len(both.points) - 1


def painter_of(renderer, bodies, motion, times, **options):
    runs = {body.name: MeshRun(body, lambda k, b=body: motion(b, times[k])) for body in bodies}
    return ScenePainter(renderer, runs, times, **options)


def test_plane_scene_is_seen_from_across_with_up_upwards(renderer):
    times = np.linspace(0.0, 1.0, 5)
    painter = painter_of(renderer, [beam()], rolled, times, up=(0.0, 0.0, 1.0))
    np.testing.assert_allclose(painter.view.right, [1.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(painter.view.up, [0.0, 0.0, 1.0], atol=1e-9)
    slanted = painter_of(renderer, [plate()], rolled, times)
    assert slanted.view.towards[2] > 0.2


def test_what_is_too_small_to_see_is_drawn_larger_and_said(renderer):
    times = np.array([0.0, 1.0])
    thin = painter_of(renderer, [beam(diameter=1e-3)], rolled, times)
    factor = thin.exaggeration.radius["beam"]
    assert factor in {10.0, 20.0, 50.0}
    assert f"radius × {factor:g}" in thin.exaggeration.words
    thick = painter_of(renderer, [beam(diameter=0.1)], rolled, times)
    assert thick.exaggeration.words == ""
    small = painter_of(renderer, [plate()], lambda b, t: rolled(b, 1e-3 * t), times)
    assert small.exaggeration.displacement == 200.0  # 1.5e-3 m drawn as at most a tenth of 3.6 m
    assert "displacement × 200" in small.exaggeration.words


def test_picture_says_time_largest_stress_and_scale(renderer, monkeypatch):
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    written = []
    for owner in (Figure, Axes):
        original = owner.text
        monkeypatch.setattr(
            owner,
            "text",
            lambda self, x, y, s, _original=original, **k: written.append(s) or _original(self, x, y, s, **k),
        )
    times = np.linspace(0.0, 2.0, 21)
    painter = painter_of(renderer, [plate(12, 2)], rolled, times, size=(900, 600))
    image = pixels(painter.picture(10, title="plate", note="half"))
    assert image.shape == (600, 900, 3)
    radius = LENGTH
    peak = E * T / (2 * radius * (1 - NU**2)) * np.sqrt(1 - NU + NU**2) / 1e6
    heading = next(text for text in written if text.startswith("t = "))
    assert heading.startswith("t = 1.0 s · half · largest ")
    assert float(heading.split("largest ")[1].split(" MPa")[0]) == pytest.approx(peak, rel=5e-3)
    assert "in plate, element" in heading
    assert any(text.endswith(" m") and float(text.split()[0]) <= 1.0 for text in written)
    # colours of the surface, and nothing touches the border of the image
    assert np.mean(np.ptp(image[84:566, :770], axis=2) > 60) > 0.05
    assert np.all(image[84:566, :8] > 240)


def test_scale_bar_has_the_length_it_says(renderer, monkeypatch):
    from heavylift.pipeline.pictures import scene as picture_scene

    bars = []
    monkeypatch.setattr(picture_scene, "add_scale_bar", lambda _axes, *numbers: bars.append(numbers))
    times = np.array([0.0, 1.0])
    painter = painter_of(renderer, [beam(diameter=0.06)], lambda b, _t: rolled(b, 1e-9), times, up=(0, 0, 1))
    image = pixels(painter.picture(0, title="straight"))[84:-34, :1070]
    length, width, unit = bars[0]
    columns = np.flatnonzero((image.min(axis=2) < 200).sum(axis=0) > 12)  # the tube, not the triad
    assert unit == "m"
    drawn = (columns.max() - columns.min() + 1) * length / width
    assert drawn == pytest.approx(LENGTH, rel=0.02)


def test_frames_beside_shells_share_their_scale_and_records_one_camera(renderer):
    times = np.linspace(0.0, 1.0, 9)
    painter = painter_of(renderer, [plate(6, 2), beam(6)], lambda b, t: rolled(b, 1.5 * t), times)
    scale = painter.scale(range(9))
    assert not scale.signed
    assert scale.limits[0] == 0.0
    assert scale.limits[1] * scale.divisor >= painter.scale([4]).limit * painter.scale([4]).divisor
    small = painter.resized(420, 320)
    first, second = (pixels(png) for png in small.images([0, 8], title="both"))
    assert first.shape == second.shape == (320, 420, 3)
    assert np.array_equal(first[90:, 300:], second[90:, 300:])  # the colour bar stands still
    assert not np.array_equal(first[90:280, :290], second[90:280, :290])
    tubes = painter_of(renderer, [beam(6)], lambda b, t: rolled(b, 1.5 * t), times).scale(range(9))
    assert tubes.signed
    assert tubes.limits[0] == -tubes.limits[1]


def test_ropes_joints_and_rigid_bodies_follow_the_meshes():
    frame = beam(8)
    turn = quaternion_from_rotation_vector([0.0, 0.0, 0.5 * np.pi])
    block = RigidBody("block", 1.0, np.eye(3), centre_of_mass=np.array([0.1, 0.0, 0.0]))
    end = np.array([LENGTH, 0.0, 0.0])
    scene = Scene(
        (frame, block),
        joints=(
            Ball(
                name="pin",
                body_a="beam",
                body_b="block",
                frame_a=JointFrame(end),
                frame_b=JointFrame(np.array([0.5, 0.0, 0.0])),
            ),
        ),
        ropes=(
            SpringRope(
                name="rope",
                path=(
                    RopePoint("beam", np.array([0.5 * LENGTH, 0.0, 0.0])),
                    RopePoint("ground", np.array([1.0, 2.0, 3.0])),
                ),
                length=1.0,
                stiffness=1.0,
            ),
        ),
    )
    state = rolled(frame, 1.0)

    class Recorded(dict):
        time = np.zeros(1)

    recorded = Recorded(
        {"block.position": np.array([[7.0, 8.0, 9.0]]), "block.orientation": np.array([turn])}
    )
    runs = {"beam": MeshRun(frame, lambda _record: state)}
    others = SceneView(draw_scene(scene, recorded, detail=EXACT, sources=Sources(runs=runs)))
    assert not others.empty
    seen = others.seen(0)
    rods, violation, rope = seen.lines
    ends = violation.points[violation.ends[0]]  # of the pin, whose sides are far apart
    np.testing.assert_allclose(rods.points, [[7.0, 8.1, 9.0], [7.0, 8.5, 9.0]], atol=1e-12)
    middle = LENGTH * np.array([np.sin(0.5), 0.0, 1.0 - np.cos(0.5)])
    np.testing.assert_allclose(rope.points, [middle, [1.0, 2.0, 3.0]], atol=1e-4)
    joint, centre = seen.marks
    tip = LENGTH * np.array([np.sin(1.0), 0.0, 1.0 - np.cos(1.0)])
    np.testing.assert_allclose(joint.points, [tip], atol=1e-9)
    np.testing.assert_allclose(ends, [tip, [7.0, 8.5, 9.0]], atol=1e-9)
    (box,) = seen.patches  # a cube: 1 kg, 1 kg m^2
    assert np.ptp(box.points, axis=0) == pytest.approx(3 * [np.sqrt(6.0)])
    np.testing.assert_allclose(centre.points, [[7.0, 8.1, 9.0]], atol=1e-12)


def test_rope_runs_along_tangents_and_about_its_pulleys():
    """A belt over two pulleys of different size: straight parts by Pythagoras, arcs by their angles."""
    y = np.array([0.0, 1.0, 0.0])
    r, R, L = 0.2, 0.5, 2.0
    bottom, top = np.zeros(3), np.array([L, 0.0, 0.0])
    # from below over both: about +y the rope goes from -x to +x on top
    start, end = np.array([-r, 0.0, -1.0]), np.array([L + R, 0.0, -3.0])
    centres = [place[np.newaxis] for place in (start, bottom, top, end)]
    line = np.concatenate(rope_points(centres, [0.0, r, R, 0.0], 4 * [y[np.newaxis]], arc=17), axis=1)[0]
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    lift = np.arcsin((R - r) / L)  # slope of the common tangent
    expected = 1.0 + r * (0.5 * np.pi - lift) + L * np.cos(lift) + R * (0.5 * np.pi + lift) + 3.0
    assert length == pytest.approx(expected, rel=1e-3)
    for centre, radius in ((bottom, r), (top, R)):
        assert np.linalg.norm(line - centre, axis=1).min() == pytest.approx(radius, rel=1e-9)
    straight = rope_points(centres[::3], [0.0, 0.0], 2 * [y[np.newaxis]], arc=17)
    np.testing.assert_array_equal(np.concatenate(straight, axis=1)[0], [start, end])


def test_shortest_tree_follows_a_rim():
    """A square of nine points on each side: the tree goes round along it, and never across."""
    side = np.linspace(-1.0, 1.0, 9)
    rim = np.array([[x, y, 0.0] for x in side for y in side if max(abs(x), abs(y)) == 1.0])
    pairs = shortest_tree(rim[np.random.default_rng(3).permutation(len(rim))])
    assert pairs.shape == (len(rim) - 1, 2)
    assert set(pairs.ravel()) == set(range(len(rim)))
    rim = rim[np.random.default_rng(3).permutation(len(rim))]
    np.testing.assert_allclose(np.linalg.norm(rim[pairs[:, 0]] - rim[pairs[:, 1]], axis=1), 0.25, atol=1e-12)
