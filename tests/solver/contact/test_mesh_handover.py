"""Contacts between triangles that go on with other features: where they do, and what it costs."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.triangles.feature_gap import EDGE_EDGE
from heavylift.numerics.jit import kernel
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.contact import kind
from heavylift.solver.contact.triangles.load_transfer import book_jump, goes_on
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import LinearLaw
from heavylift.solver.scene.scene import RigidBody, Scene

DEPTH, BEYOND = 1e-3, 1e-6
STIFFNESS = 4e5
RAIL = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
BARS = np.array(
    [
        [[0.2, -1.0, -DEPTH], [0.2, -BEYOND, -DEPTH]],  # ends a little before the rail
        [[0.2, -BEYOND, -DEPTH], [0.4, 1.0, -DEPTH]],  # goes on from there
        [[0.2, -1.0, -DEPTH], [-0.6, 1.0, -2.0 * DEPTH]],  # begins where the first one does
    ]
)
"""Segments across the rail; normals up, so they are as deep inside as they are low."""


@kernel
def follow_kernel(meshes, contacts, i, moved):
    return goes_on(meshes, contacts, 0, i, moved)


@kernel
def book_kernel(contacts, gap):
    book_jump(contacts, 0, gap)


@kernel
def count_kernel(contacts, count):
    contacts.counts.total = count


def rows(surfaces, segments: np.ndarray) -> list[int]:
    """Numbers of segments among the edges of all surfaces."""
    found = []
    for segment in segments:
        ends = surfaces.points[surfaces.edges["ends"]]
        same = np.abs(ends - segment).max(axis=(1, 2)) < 1e-12
        same |= np.abs(ends[:, ::-1] - segment).max(axis=(1, 2)) < 1e-12
        found.append(int(np.flatnonzero(same)[0]))
    return found


def upwards(surfaces, first: int, second: int) -> float:
    """Side with which the common normal of two edges points up."""
    a, b = (np.diff(surfaces.points[surfaces.edges[e].ends], axis=0)[0] for e in (first, second))
    return float(np.sign(np.cross(a, b)[2]))


@pytest.fixture
def touched():
    """A compliant contact of the rail and the first bar, which has left the bar; the other two were found."""
    points = BARS.reshape(-1, 3)
    bars = TriangleSurface(points, np.array([[0, 1, 1], [2, 3, 3], [4, 5, 5]]), 1e-4, "bars")
    rail = TriangleSurface(RAIL, np.array([[0, 1, 1]]), 1e-4, "rail")
    scene = Scene(
        bodies=(RigidBody("comb", 1.0, np.eye(3)),),
        surfaces=(
            CollisionSurface(name="rail", body="ground", surface=rail),
            CollisionSurface(name="bars", body="comb", surface=bars),
        ),
        collisions=(Collision(name="touch", surfaces=("rail", "bars"), law=LinearLaw(STIFFNESS)),),
    )
    contacts = pack_scene(scene).systems[1]
    (meshes,) = contacts.meshes
    count_kernel(contacts, 1)
    first_pose = contacts.poses[meshes.pairs[0].poses[0]]
    for pose in (first_pose, meshes.relative[0]):
        pose.rotation[:], pose.origin[:] = np.eye(3).ravel(), 0.0
    (rail_edge,) = rows(meshes.surfaces, RAIL[None])
    edges = rows(meshes.surfaces, BARS)
    for i, edge in enumerate(edges[1:]):
        found = meshes.found.contacts[i]
        found.kind, found.first, found.second = EDGE_EDGE, rail_edge, edge
        found.side = upwards(meshes.surfaces, rail_edge, edge)
    state = contacts.state[0]
    state.feature_kind, state.feature, state.other_feature = EDGE_EDGE, rail_edge, edges[0]
    state.side = upwards(meshes.surfaces, rail_edge, edges[0])
    state.gap = state.end_gap = -DEPTH
    state.beside, state.present = BEYOND, True
    state.normal[:] = 0.0, 0.0, 1.0
    state.touched[:] = 0.2, 0.0, -0.5 * DEPTH
    contacts.table[0].law, contacts.table[0].force_law = (kind.COMPLIANT, meshes.pairs[0].force_law)
    contacts.values[0] = meshes.pair_values[0]
    pair = meshes.pairs[0]
    pair.members, pair.first_member, pair.last_member = 1, 0, 0
    return meshes, contacts


@pytest.mark.slow
@pytest.mark.parametrize("turned", [1.0, -1.0])
def test_a_contact_goes_on_with_the_neighbour_beyond_its_border(touched, turned):
    """On the side it was on, whichever side was found."""
    meshes, contacts = touched
    side = meshes.found.contacts[0].side
    meshes.found.contacts[0].side = turned * side
    assert follow_kernel(meshes, contacts, 0, 1e-6) == (0, side)


def test_a_contact_does_not_go_on_where_another_one_touches(touched):
    """The third bar lies across the same rail, but 0.4 m away and 0.5 mm deeper."""
    meshes, contacts = touched
    crossing = BARS[2, 0] + 0.5 * (BARS[2, 1] - BARS[2, 0])
    assert np.allclose(crossing, [-0.2, 0.0, -1.5 * DEPTH])
    assert follow_kernel(meshes, contacts, 1, 1e-6)[0] == -1
    # in a step in which it may have gone so far it may have come there
    assert follow_kernel(meshes, contacts, 1, 0.4)[0] == 0


def test_a_contact_that_has_not_left_stays(touched):
    """And one that does not hold has no memory to hand over."""
    meshes, contacts = touched
    contacts.state[0].beside = 0.0
    assert follow_kernel(meshes, contacts, 0, 1e-6)[0] == -1
    contacts.state[0].beside, contacts.state[0].gap = BEYOND, DEPTH
    assert follow_kernel(meshes, contacts, 0, 1e-6)[0] == -1


@pytest.mark.parametrize(("present", "share"), [(True, 1.0), (False, 0.0)])
def test_a_jump_of_the_gap_costs_the_difference_of_the_stored_energies(touched, present, share):
    """``k d^2 / 2`` before and after; what took no part in the step has not stored it."""
    _, contacts = touched
    state = contacts.state[0]
    state.present = present
    book_kernel(contacts, -3.0 * DEPTH)
    lost = share * 0.5 * STIFFNESS * (9.0 - 1.0) * DEPTH**2
    assert np.isclose(state.jump, lost, rtol=1e-14, atol=0.0)
    state.end_gap = 1.0
    book_kernel(contacts, -DEPTH)
    assert np.isclose(state.jump, lost + share * 0.5 * STIFFNESS * DEPTH**2, rtol=1e-14, atol=0.0)
