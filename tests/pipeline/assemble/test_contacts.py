"""Contours and contacts arrive in body frames: splines go through their points and move with the modes."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import BSpline

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.scene import contacts as c

HERE = Path(__file__).parents[1]


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "contacts"
    folder.mkdir()
    shutil.copyfile(HERE / "contacts.toml", folder / "case.toml")
    return folder


def scene_of(folder, *overrides):
    return assemble_scene(load_case(folder, overrides), OutputFolder(folder / "out"))


def contour_of(scene, name):
    return next(contour for contour in scene.contours if contour.name == name)


def curve(neutral, parameters, values=None):
    """Points on a curve by scipy, shape (k, ...); of the control points, or other values of them."""
    (space,) = neutral.spaces
    owners = np.arange(space.functions) % space.count
    values = neutral.control if values is None else values
    return BSpline(space.knots, values[owners], space.degree)(parameters)


def surface(neutral, u, v, values=None):
    """Points on a grid of parameters by scipy, shape (a, b, ...)."""
    values = neutral.control if values is None else values
    grid = values.reshape(*neutral.counts, *values.shape[1:])
    for axis, (space, at) in enumerate(zip(neutral.spaces, (u, v), strict=True)):
        owners = np.arange(space.functions) % space.count
        grid = BSpline(space.knots, np.take(grid, owners, axis=axis), space.degree, axis=axis)(at)
    return grid


def test_a_surface_goes_through_its_points_and_a_flat_one_is_flat(folder):
    floor = contour_of(scene_of(folder), "floor")
    assert (floor.body, floor.flip, floor.radius, floor.width) == ("ground", False, 0.0, 0.0)
    u = np.array([0.0, 1 / 3, 2 / 3, 1.0])
    expected = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), [0.0], indexing="ij"), axis=-1)[:, :, 0]
    np.testing.assert_allclose(surface(floor.neutral, u, u), expected, atol=1e-13)
    np.testing.assert_allclose(surface(floor.neutral, [0.23], [0.71])[0, 0], [0.69, 2.13, 0.0], atol=1e-13)


def test_a_circle_is_round_to_the_fourth_order_of_its_points(folder):
    angles = np.linspace(0.0, 1.0, 1201)
    for count in (12, 24, 48):
        rail = contour_of(scene_of(folder, f"contours.rail.circle.points={count}"), "rail")
        assert rail.neutral.spaces[0].closed
        points = curve(rail.neutral, angles) - [0.0, 0.0, 1.0]
        np.testing.assert_allclose(points[:, 2], 0.0, atol=1e-14)
        error = np.abs(np.hypot(points[:, 0], points[:, 1]) / 0.5 - 1.0).max()
        assert 3.9 < error * count**4 < 4.5
        # anticlockwise about its axis: the area is positive
        assert np.sum(np.cross(points[:-1], points[1:])[:, 2]) == pytest.approx(2.0 * np.pi * 0.25, rel=1e-3)


def test_points_of_a_rigid_body_are_in_coordinates_of_its_geometry(folder):
    skid = contour_of(scene_of(folder), "skid")
    assert skid.neutral.spaces[0].degree == 4
    # along the width, so that this x tangent is the normal: points and normal are in the x-z plane
    np.testing.assert_allclose(skid.director, [0.0, 1.0, 0.0], atol=1e-15)
    assert skid.width == 0.05
    # the frame of the block is 100 mm above the origin of its geometry
    np.testing.assert_allclose(skid.neutral.control[0], [-0.2, 0.0, -0.1], atol=1e-15)
    np.testing.assert_allclose(skid.neutral.control[-1], [0.2, 0.0, -0.08], atol=1e-15)
    assert skid.neutral.modal.shape == (0, 5, 3)


def test_a_band_is_told_by_its_width_or_by_its_normal_at_the_start(folder):
    # the frame goes along x: its normal z is (across -y) x (tangent x)
    band = ["contours.cable.radius=", "contours.cable.type=band", "contours.cable.width=10 mm"]
    change = [*band, "contacts.2.shape.radius=1 mm"]
    told = contour_of(scene_of(folder, *change, "contours.cable.normal=[0.3, 0, 2]"), "cable")
    np.testing.assert_allclose(told.director, [0.0, -1.0, 0.0], atol=1e-15)
    across = contour_of(
        scene_of(folder, *change, "contours.cable.across=[0, 3, 0]", "contours.cable.flip=true"), "cable"
    )
    np.testing.assert_allclose(across.director, [0.0, 3.0, 0.0])
    assert across.flip
    with pytest.raises(InputError, match=r"contours\.cable\.normal: \[1\.0, 0\.0, 0\.0\] is along the start"):
        scene_of(folder, *change, "contours.cable.normal=[1, 0, 0]")


def test_points_of_a_file_are_those_of_the_case_file(folder):
    rows = ["# a comment", *(f"{i}, {j}, 0" for i in range(4) for j in range(4))]
    (folder / "floor.csv").write_text("\n".join(rows))
    change = ["contours.floor.points=", "contours.floor.file=floor.csv", "contours.floor.columns=4"]
    drawn, read = (contour_of(scene_of(folder, *more), "floor") for more in ([], change))
    np.testing.assert_array_equal(drawn.neutral.control, read.neutral.control)


def test_frames_and_shells_are_contours_themselves(folder):
    scene = scene_of(folder)
    cable, tray = contour_of(scene, "cable"), contour_of(scene, "tray")
    assert cable.neutral is None
    assert tray.neutral is None
    assert (cable.radius, tray.flip) == (0.01, True)


def test_an_imported_spline_keeps_its_shape_on_a_domain_from_0_to_1(folder):
    # a quarter of a circle: the rational parabola of weight cos 45 degrees, raised to degree 3
    root = math.sqrt(2.0)
    weight, y = (1.0 + root) / 3.0, root / (1.0 + root)
    spline = (
        f"{{degree=3, knots=[2, 2, 2, 2, 4, 4, 4, 4], weights=[1, {weight}, {weight}, 1], "
        f"control=[[1, 0, 0], [1, '{1e3 * y!r} mm', 0], [{y!r}, 1, 0], [0, 1, 0]]}}"
    )
    rail = contour_of(scene_of(folder, "contours.rail.circle=", f"contours.rail.spline={spline}"), "rail")
    (space,) = rail.neutral.spaces
    np.testing.assert_array_equal(space.knots, [0, 0, 0, 0, 1, 1, 1, 1])
    at = np.linspace(0.0, 1.0, 21)
    weighted = curve(rail.neutral, at, rail.neutral.control * rail.neutral.weights[:, None])
    points = weighted / curve(rail.neutral, at, rail.neutral.weights)[:, None]
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), 1.0, atol=1e-14)


def test_laws_and_shapes_arrive_with_their_numbers(folder):
    landing, bead, squeeze, pad, foot = scene_of(folder).contacts
    assert landing.law == c.RigidLaw(restitution=0.5, rest_speed=1e-3)
    assert landing.shape == c.SphereShape(0.1)
    assert (landing.body, landing.contour, landing.friction, landing.law.events) == (
        "ball",
        "floor",
        0.3,
        True,
    )
    assert bead.law == c.BilateralLaw()
    # Hertz, a ball on a flat: 4/3 E* sqrt(R)
    assert squeeze.law.stiffness == pytest.approx(4.0 / 3.0 * 1e7 * np.sqrt(0.1), rel=1e-14)
    assert pad.law == c.HuntCrossleyLaw(stiffness=1e3 * 1e-3**-1.5, exponent=1.5, restitution=0.8)
    # a box of 100 x 60 x 20 mm whose edges are rounded by 2 mm
    np.testing.assert_allclose(pad.shape.core, [0.048, 0.028, 0.008], atol=1e-16)
    assert pad.shape.rounding == 0.002
    assert foot.law == c.LinearLaw(stiffness=1e6, damping=10.0)
    assert foot.footprint == 0.0


@pytest.mark.parametrize(
    ("shape", "key", "expected"),
    [
        (
            '{type="cylinder", radius="50 mm", length="1 m", rounding="5 mm", axis=[0, 3, 4]}',
            "core",
            [0.045, 0.495],
        ),
        ('{type="capsule", radius="50 mm", length="1 m", axis=[0, 0, 2]}', "length", 1.0),
        ('{type="circle", radius="50 mm", axis=[2, 0, 0]}', "axis", [2, 0, 0]),
        ('{type="ellipsoid", half_axes=[1, 2, 3]}', "axes", np.eye(3)),
        (
            '{type="ellipsoid", half_axes=[1, 2, 3], turned={axis=[0, 0, 1], angle="90 deg"}}',
            "axes",
            [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
        ),
    ],
)
def test_sizes_of_shapes_are_from_face_to_face(folder, shape, key, expected):
    landing = scene_of(folder, f"contacts.0.shape={shape}").contacts[0]
    np.testing.assert_allclose(getattr(landing.shape, key), expected, atol=1e-15)


def test_a_place_in_the_world_and_on_the_body_are_the_same_place(folder):
    bead = scene_of(folder).contacts[1]
    # the ball is at (0.5, 0.5, 1), turned by 90 degrees about z: the point below it along -y is on its -x axis
    np.testing.assert_allclose(bead.point, [-0.5, 0.0, 0.0], atol=1e-15)
    pad = scene_of(folder).contacts[3]
    np.testing.assert_allclose(pad.point, [0.0, 0.0, -0.09], atol=1e-15)
    moved = scene_of(folder, "contacts.1.at=", "contacts.1.point=['-500 mm', 0, 0]")
    np.testing.assert_allclose(moved.contacts[1].point, bead.point, atol=1e-15)


@pytest.fixture(scope="module")
def beam(tmp_path_factory):
    """Folder with a flexible bar of 8 x 2 x 3 bricks whose mesh and modes are made."""
    folder = tmp_path_factory.mktemp("bar")
    text = (HERE / "small_beam.toml").read_text()
    text = text.replace("x = [8], y = [1], z = [1]", "x = [8], y = [3], z = [3]")
    text = text.replace(
        'root = { plane = "x", at = "0 mm" }',
        'root = { plane = "x", at = "0 mm" }\ntop = { face = "bar.z_max" }',
    )
    text = text.replace('motion = "fixed"', 'motion = "fixed"\norigin = "centre_of_mass"')
    (folder / "case.toml").write_text(text + CONTOURS)
    run_case(load_case(folder), stages=("mesh", "modes"))
    return folder


CONTOURS = """
[contours.top]
body = "beam"
type = "surface"
face = { on = "top" }

[contours.part]
body = "beam"
type = "surface"
face = { plane = "z", at = "10 mm", from = [0, 0, 0], to = ["100 mm", "20 mm", "10 mm"] }

[contours.edge]
body = "beam"
type = "curve"
line = { from = [0, 0, 0], to = ["200 mm", 0, 0] }
"""


def test_a_contour_of_a_flexible_body_goes_through_nodes_and_moves_with_the_modes(beam):
    scene = scene_of(beam)
    reduced = scene.bodies[0].reduced
    top = contour_of(scene, "top").neutral
    assert sorted(top.counts) == [4, 9]
    u = v = np.linspace(0.0, 1.0, 31)
    points = surface(top, u, v)
    np.testing.assert_allclose(points[..., 2], 0.005, atol=1e-15)  # the frame is at the centre of mass
    corner = np.argmin(np.linalg.norm(reduced.nodes - points[0, 0], axis=1))
    np.testing.assert_allclose(reduced.nodes[corner], points[0, 0], atol=1e-15)
    for mode, shape in enumerate(reduced.mode_shapes):
        moved = surface(top, [0.0, 1.0], [0.0, 1.0], top.modal[mode])
        np.testing.assert_allclose(moved[0, 0], shape[corner], atol=1e-12 * np.abs(shape).max())
    # the normal is (first direction) x (second direction) and points out of the material
    assert np.cross(points[1, 0] - points[0, 0], points[0, 1] - points[0, 0])[2] > 0.0


def test_a_box_takes_a_part_of_a_face(beam):
    scene = scene_of(beam)
    part = surface(contour_of(scene, "part").neutral, [0.0, 1.0], [0.0, 1.0]).reshape(-1, 3)
    np.testing.assert_allclose(np.ptp(part, axis=0), [0.1, 0.02, 0.0], atol=1e-15)


def test_nodes_of_a_file_are_those_of_a_line(beam):
    nodes = scene_of(beam).bodies[0].reduced.nodes + np.array([0.1, 0.01, 0.005])
    on_edge = [int(np.argmin(np.linalg.norm(nodes - [x, 0, 0], axis=1))) for x in np.linspace(0, 0.2, 9)]
    (beam / "edge.txt").write_text("[" + ";".join(str(node + 1) for node in on_edge) + "]")
    change = ["contours.edge.line=", "contours.edge.nodes=edge.txt"]
    drawn, read = (contour_of(scene_of(beam, *more), "edge").neutral for more in ([], change))
    np.testing.assert_array_equal(drawn.control, read.control)
    np.testing.assert_array_equal(drawn.modal, read.modal)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["contours.top.flip=true"], "contours.top.flip: its normal points into the body.*flip = false"),
        (["contours.top.face.on=tip"], "contours.top.face.on: group 'tip' does not exist; .*root, top"),
        (
            ["contours.top.face.on=root", "contours.top.degree=4"],
            "contours.top.face: .*4 points for degree 4",
        ),
        (["contours.part.face.at=9 mm"], "contours.part.face: no node has z = 0.009 m; .*0.01 m"),
        (["contours.part.face.to=[0.04, 0.02, 0.01]"], "contours.part.face: .*2 points for degree 3"),
        (["contours.edge.line.to=[0.2, 0.001, 0]"], "contours.edge.line: one node on the line"),
        (["contours.edge.line.to=[0.2, 0, 0.001]"], "contours.edge.line: one node on the line"),
        (
            ["contours.edge.line=", "contours.edge.circle={axis=[0, 0, 1], radius='1 m'}"],
            "contours.edge.circle: 0 nodes on the circle",
        ),
        (
            ["contours.edge.line=", "contours.edge.circle={axis=[1, 0, 0], radius=1, points=9}"],
            "contours.edge.circle.points: 'points' of a circle through nodes",
        ),
    ],
)
def test_nodes_that_make_no_contour_are_told_at_their_key(beam, overrides, message):
    with pytest.raises(InputError, match=message):
        scene_of(beam, *overrides)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        ("[1,2,3,4;5,6,7]", "row"),
        ("[1,2,3,3]", "row 1, column 4: node 3 stands here again"),
        ("[1,2,3,4000]", "row 1, column 4"),
        ("[1,2,,4]", "row 1, column 3: a node is missing"),
    ],
)
def test_a_wrong_node_matrix_is_told_with_file_and_place(beam, matrix, message):
    (beam / "wrong.txt").write_text(matrix)
    with pytest.raises(InputError, match=f"wrong.txt.*{message}"):
        scene_of(beam, "contours.edge.line=", "contours.edge.nodes=wrong.txt")
