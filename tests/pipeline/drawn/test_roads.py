"""Strips of decks and wheels in pictures stand where they are."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.pipeline.drawn.build import EXACT, draw_scene
from heavylift.pipeline.drawn.moments import Moment
from heavylift.pipeline.pictures.scene_view import SceneView
from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.transport import BogieGroup, HeightGrid
from heavylift.solver.transport.decks import Deck, grid_heights
from heavylift.solver.transport.transporters import Transporter


def recorded(channels):
    """Channels of one record."""

    class Recorded(dict):
        time = np.zeros(1)

    return Recorded(channels)


def test_a_strip_has_the_area_of_its_profile_by_its_width() -> None:
    """A step and a slope, along y of a body, upwards its x."""
    deck = Deck(
        name="d",
        body="barge",
        origin=np.array([1.0, 2.0, 3.0]),
        direction=np.array([0.0, 1.0, 0.0]),
        normal=np.array([1.0, 0.0, 0.0]),
        sides=np.array([-2.0, 1.0]),
        stations=np.array([0.0, 3.0, 3.0, 7.0]),
        heights=np.array([0.0, 0.0, 1.0, 4.0]),
    )
    (strip,) = deck.drawn()
    body, points, triangles = strip.body, strip.points, strip.triangles
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    assert body == "barge"
    assert area == pytest.approx(3.0 * (3.0 + 1.0 + 5.0))
    np.testing.assert_allclose(points.min(axis=0), [1.0, 2.0, 3.0 - 2.0])
    np.testing.assert_allclose(points.max(axis=0), [5.0, 9.0, 3.0 + 1.0])


def test_a_grid_is_drawn_as_the_triangles_on_which_wheels_roll() -> None:
    """Each point of each triangle is at the height that a wheel without radius has there, between corners too."""
    rng = np.random.default_rng(1)
    grid = HeightGrid(
        stations=np.array([0.0, 1.0, 1.5, 4.0]),
        offsets=np.array([-1.0, 0.0, 3.0]),
        heights=rng.random((4, 3)),
    )
    (strip,) = Deck(name="d", grid=grid, origin=np.array([1.0, 2.0, 3.0])).drawn()
    points, triangles = strip.points, strip.triangles
    assert len(triangles) == 4 * 3 * 2
    for share in ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.3, 0.5]):
        x, y, z = np.einsum("k,nkj->jn", share, points[triangles] - [1.0, 2.0, 3.0])
        np.testing.assert_allclose(grid_heights(grid, 0.0, x, y), z, atol=1e-14)
    corners = points[triangles][:, :, :2]
    edges = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
    assert area.sum() == pytest.approx(4.0 * 4.0)


def test_a_wheel_stands_on_its_place_by_its_radius_and_stroke() -> None:
    """Upwards across the direction in which it goes."""
    group = BogieGroup("g", np.array([[1.0, 2.0, 0.0], [-1.0, 2.0, 0.0]]), oil_stiffness=1.0)
    vehicle = Transporter(name="v", body="b", groups=(group,), wheel_radius=0.4, tyre_stiffness=1.0)
    bodies = (RigidBody("b", 1.0, np.eye(3)),)
    results = recorded({"v.stroke_of": np.array([[0.0, 0.1]])})
    drawn = draw_scene(Scene(bodies, transporters=(vehicle,)), results)
    centres = [Moment(drawn, pose=0).point(disc) for disc in drawn.discs]
    np.testing.assert_allclose(centres, [[1.0, 2.0, 0.4], [-1.0, 2.0, 0.5]])


def test_no_rod_leads_to_what_is_attached_to_a_deck() -> None:
    """From the centre of mass of a barge, over its deck, only to the top of a mast; ropes lead to both."""
    quay = np.array([0.0, 9.0, 1.0])
    places = np.array([[5.0, 0.0, 1.0], [5.0, 0.0, 12.0]])
    ropes = tuple(
        SpringRope(
            name=f"rope_{i}",
            path=(RopePoint("barge", at), RopePoint(GROUND, quay)),
            length=1.0,
            stiffness=1.0,
        )
        for i, at in enumerate(places)
    )
    centre = np.array([0.0, 0.0, 4.0])
    barge = RigidBody("barge", 1.0, np.eye(3), centre_of_mass=centre)
    deck = Deck(
        name="d",
        body="barge",
        origin=np.array([0.0, 0.0, 1.0]),
        sides=np.array([-2.0, 2.0]),
        stations=np.array([-5.0, 5.0]),
        heights=np.zeros(2),
    )
    pose = {"barge.position": np.zeros((1, 3)), "barge.orientation": np.array([[1.0, 0.0, 0.0, 0.0]])}
    for decks, ends in (((deck,), places[1:]), ((), places)):
        scene = Scene((barge,), ropes=ropes, decks=decks)
        rods, *drawn = SceneView(draw_scene(scene, recorded(pose), detail=EXACT)).seen(0).lines
        np.testing.assert_allclose(rods.points[rods.ends], [[centre, end] for end in ends])
        assert len(drawn) == 2
