"""Borders that lie in other triangles: plates that abut, overlap and meet in T-junctions."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.triangles.seams import _covered, _planes, _touching, find_seams
from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface


def plate(x0: float, x1: float, y0: float = -1.0, y1: float = 1.0, z: float = 0.0) -> TriangleSurface:
    """A rectangle of two triangles."""
    points = np.array([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]])
    return TriangleSurface(points, np.array([[0, 1, 2], [0, 2, 3]]))


def inward(packed, a, b) -> np.ndarray:
    """Directions from the edge between two places into what covers its sides, each once."""
    ends = packed.points[packed.edges["ends"]]
    for e, (p, q) in enumerate(ends):
        if {tuple(p), tuple(q)} == {tuple(a), tuple(b)}:
            rows = packed.edge_inward[packed.edge_first[e] : packed.edge_first[e + 1]]
            return np.unique(rows.round(9) + 0.0, axis=0)
    raise AssertionError((a, b))


def test_plates_that_abut_are_neighbours_along_the_seam():
    packed = pack_surfaces([plate(0.0, 1.0), plate(1.0, 3.0)], ["deck", "deck"])
    found = inward(packed, (1.0, -1.0, 0.0), (1.0, 1.0, 0.0))
    assert found == pytest.approx(np.array([[-1.0, 0, 0], [1, 0, 0]]))
    assert len(inward(packed, (0.0, -1.0, 0.0), (0.0, 1.0, 0.0))) == 1  # the far border is one


def test_plates_of_two_bodies_are_not():
    for bodies in (None, ["deck", "hatch"]):
        packed = pack_surfaces([plate(0.0, 1.0), plate(1.0, 3.0)], bodies)
        assert len(inward(packed, (1.0, -1.0, 0.0), (1.0, 1.0, 0.0))) == 1


def test_nor_are_plates_with_a_step_or_a_gap():
    for other in (plate(1.0, 3.0, z=-1e-3), plate(1.001, 3.0)):
        packed = pack_surfaces([plate(0.0, 1.0), other], [0, 0])
        assert len(inward(packed, (1.0, -1.0, 0.0), (1.0, 1.0, 0.0))) == 1


def test_an_edge_is_covered_by_two_plates_together_and_by_one_alone_is_a_border():
    whole, low, high = plate(0.0, 1.0), plate(1.0, 2.0, -1.0, 0.2), plate(1.0, 2.0, 0.2, 1.0)
    edge = (1.0, -1.0, 0.0), (1.0, 1.0, 0.0)
    assert len(inward(pack_surfaces([whole, low, high], [0, 0, 0]), *edge)) == 2
    assert len(inward(pack_surfaces([whole, low], [0, 0]), *edge)) == 1
    # the T-junction: a corner of the small plates in the middle of the edge
    packed = pack_surfaces([whole, low, high], [0, 0, 0])
    corner = next(i for i, p in enumerate(packed.points) if tuple(p) == (1.0, 0.2, 0.0))
    near = packed.vertex_neighbours[packed.vertex_first[corner] : packed.vertex_first[corner + 1]]
    towards = packed.points[near] - packed.points[corner]
    assert towards[:, 0].min() < 0.0 < towards[:, 0].max()
    assert towards[:, 1].min() < 0.0 < towards[:, 1].max()


def test_a_border_within_another_plate_is_covered_on_both_sides():
    packed = pack_surfaces([plate(0.0, 1.2), plate(1.0, 3.0)], [0, 0])
    for x in (1.0, 1.2):
        assert len(inward(packed, (x, -1.0, 0.0), (x, 1.0, 0.0))) == 2


def test_a_plate_that_stands_on_another_is_its_neighbour_upwards():
    """The fillet of a stiffener: its foot pushes along no direction but away from both."""
    wall = TriangleSurface(
        np.array([[0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [0.5, -0.5, 1.0]]),
        np.array([[0, 1, 2], [0, 2, 3]]),
    )
    packed = pack_surfaces([plate(0.0, 1.0), wall], [0, 0])
    found = inward(packed, (0.5, -0.5, 0.0), (0.5, 0.5, 0.0))
    assert found == pytest.approx(np.array([[-1.0, 0, 0], [0, 0, 1], [1, 0, 0]]))


def test_any_winding_and_turn():
    rng = np.random.default_rng(5)
    for _ in range(20):
        q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        shift = 10.0 * rng.normal(size=3)
        parts = []
        for one in (plate(0.0, 1.0), plate(1.0, 3.0)):
            rows = np.array([t[::-1] if rng.random() < 0.5 else t for t in one.triangles])
            parts.append(TriangleSurface(one.points @ q.T + shift, rows))
        packed = pack_surfaces(parts, [0, 0])
        shared = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, 0.0]]) @ q.T + shift
        counts = []
        for e, ends in enumerate(packed.points[packed.edges["ends"]]):
            if all(np.linalg.norm(shared - p, axis=1).min() < 1e-9 for p in ends):
                rows = packed.edge_inward[packed.edge_first[e] : packed.edge_first[e + 1]]
                counts.append(np.ptp(rows @ q[:, 0]))
        assert counts == pytest.approx([2.0, 2.0])


def test_a_closed_surface_has_no_borders():
    one = box_surface(1.0)
    none = np.zeros(0, dtype=np.int64)
    normals = np.zeros((len(one.triangles), 3))
    seams = find_seams(one.points, one.triangles, normals, np.zeros((0, 2), dtype=np.int64), none)
    assert all(len(part) == 0 for part in seams)


def test_a_sheet_on_a_large_deck_is_no_part_of_it():
    """0.3 mm above a deck of 100 m, and 20 mm above one of 3 km."""
    for size, height in ((100.0, 3e-4), (3000.0, 0.02)):
        packed = pack_surfaces([plate(-size, size, -size, size), plate(0.0, 1.0, z=height)], [0, 0])
        assert len(inward(packed, (0.0, -1.0, height), (0.0, 1.0, height))) == 1


@pytest.mark.parametrize("spread", [0.0, 3.0])
def test_boxes_that_meet_are_all_found_once(spread: float) -> None:
    """Boxes of one size, and of sizes from 1 to a million, against every pair."""
    rng = np.random.default_rng(5)

    def boxes(count: int) -> tuple[np.ndarray, np.ndarray]:
        size = 0.5 * 10.0 ** rng.uniform(-spread, spread, (count, 1)) * rng.uniform(0.0, 1.0, (count, 3))
        middle = rng.uniform(-1.0, 1.0, (count, 3))
        return middle - 0.5 * size, middle + 0.5 * size

    lower, upper = boxes(300)
    face_lower, face_upper = boxes(400)
    found = np.column_stack(_touching(lower, upper, face_lower, face_upper))
    meet = np.all((lower[:, None] <= face_upper) & (upper[:, None] >= face_lower), axis=2)
    np.testing.assert_array_equal(found, np.argwhere(meet))
    assert len(found) > 100


def test_intervals_that_cover_an_edge_together():
    """Against one interval after another."""
    rng = np.random.default_rng(3)
    sizes = rng.integers(1, 9, 2000)
    group = np.repeat(np.arange(len(sizes)), sizes)
    low = rng.uniform(-0.2, 0.8, len(group))
    high = low + rng.uniform(0.0, 0.6, len(group))
    counts = rng.random(len(group)) < 0.9
    slack = np.repeat(rng.uniform(0.0, 0.1, len(sizes)), sizes)
    expected = []
    for one in range(len(sizes)):
        own = np.flatnonzero((group == one) & counts)
        reached, gap = slack[group == one][0], False
        for row in own[np.argsort(low[own])]:
            gap |= low[row] > reached
            reached = max(reached, high[row] + slack[row])
        expected.append(len(own) > 0 and not gap and reached >= 1.0)
    assert 100 < sum(expected) < 1900
    assert _covered(group, low, high, slack, counts).tolist() == expected


def test_planes_at_edges_one_after_another():
    """Two faces at an angle, two in a plane wound against each other, and a face that is not level with its edge."""
    across = np.array([[1.0, 0, 0], [0, 1.0, 0], [1.0, 0, 0], [-1.0, 1e-6, 0], [0.5, 0, 0], [0, 0.5, 0]])
    plane, sense = _planes(np.array([4, 4, 6, 6, 9, 9]), across)
    assert plane.tolist() == [0, 1, 2, 2, 3, 4]
    assert sense.tolist() == [1, 1, 1, -1, 1, 1]
