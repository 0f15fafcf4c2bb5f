"""Swept tests against exact arithmetic: no contact is missed, and nothing apart is called a contact."""

from __future__ import annotations

import numpy as np
import pytest
from exact_collision import edges_meet, origin_meets_triangle
from random_motions import FIXED_POINTS, KINDS, LATTICE, REGIMES, exact, random_pairs, swept

FINE = 2**10
"""Halvings with which times are checked: to 1e-3 x the shortest motions that random hits have."""


def check(kind, fixed, moving, scale=LATTICE, offset=0.0):
    """Compare with exact arithmetic; return truth, hits, times."""
    truth, _ = exact(kind, fixed, moving)
    hits, times = swept(kind, arguments(kind, fixed, moving) * scale + offset)
    assert not (truth & ~hits).any()
    return truth, hits, times


def arguments(kind, fixed, moving):
    count = len(fixed)
    parts = (fixed.reshape(count, -1), moving.reshape(count, -1))
    return np.concatenate(parts[::-1] if kind == "vertex-face" else parts, axis=1).astype(float)


def lattice_points(kind, count, reach, seed):
    """Random points with coordinates of a few integers: everything that can be degenerate is."""
    random = np.random.default_rng(seed)
    k = FIXED_POINTS[kind]
    fixed = random.integers(-reach, reach + 1, (count, k, 3))
    return fixed, random.integers(-reach, reach + 1, (count, 4 - k, 2, 3))


# --- the oracle itself -------------------------------------------------------------------------------------------


def test_the_oracle_agrees_with_contacts_known_by_construction():
    corners = np.array([[0, 0, 0], [8, 0, 0], [0, 8, 0]])
    for x, z0, z1, contact in (
        ((2, 2), 4, -4, True),
        ((4, 4), 4, -4, True),  # through an edge
        ((8, 0), 5, -3, True),  # through a corner
        ((5, 4), 4, -4, False),
        ((2, 2), 4, 1, False),
        ((2, 2), 4, 0, True),  # ends on the face
        ((2, 2), 0, 3, True),
    ):
        path = np.array([[*x, z0], [*x, z1]])
        found, _ = origin_meets_triangle((corners[:, None] - path)[None])
        assert found[0] == contact
    # cubic with an irrational root: corner c falls as the others rise, 2 t^3 - 1 changes its sign once
    for height, contact in ((1, True), (-1, False)):
        moving = np.array(
            [[[-4, -4, 1], [-4, -4, -2]], [[4, -4, 1], [4, -4, -2]], [[0, 6, 1], [0, 6, -height]]]
        )
        found, _ = origin_meets_triangle(moving[None])
        assert found[0] or not contact
    # edges that cross, miss by one unit at the end, and lie in one line
    for p, q, contact in (
        (([3, -2, 1], [3, -2, -1]), ([3, 2, 1], [3, 2, -1]), True),
        (([6, -2, 1], [6, -2, -1]), ([6, 2, 1], [6, 2, -1]), False),
        (([7, 0, 0], [5, 0, 0]), ([9, 0, 0], [9, 0, 0]), True),
        (([7, 0, 0], [6, 0, 0]), ([9, 0, 0], [9, 0, 0]), False),
    ):
        found, _ = edges_meet(np.array([[([5, 0, 0], [5, 0, 0]), p, q]]))
        assert found[0] == contact


def test_the_oracle_agrees_with_dense_sampling():
    random = np.random.default_rng(5)
    corners = random.integers(-4, 5, (100, 3, 2, 3))
    corners[:, :, 1] = -corners[:, :, 0] + random.integers(-1, 2, (100, 3, 3))
    truth, _ = origin_meets_triangle(corners)
    least = np.full(100, np.inf)
    weights = np.array([(i, j, 24 - i - j) for i in range(25) for j in range(25 - i)]) / 24
    for t in np.linspace(0.0, 1.0, 201):
        at = (1 - t) * corners[:, :, 0] + t * corners[:, :, 1]
        least = np.minimum(least, np.linalg.norm(np.einsum("wc,nck->nwk", weights, at), axis=2).min(axis=1))
    assert (least[truth] < 0.4).all()
    assert 10 < truth.sum() < 90
    assert truth[least < 1e-9].all()


# --- random pairs ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("regime", REGIMES)
def test_random_pairs(kind, regime):
    pairs = random_pairs(kind, regime, 3000, seed=11)
    truth, hits, _ = check(kind, pairs.fixed, pairs.moving)
    assert truth.sum() > 40
    assert (hits & ~truth).sum() <= 1


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("regime", REGIMES)
def test_many_random_pairs(kind, regime):
    pairs = random_pairs(kind, regime, 100_000, seed=12)
    truth, hits, _ = check(kind, pairs.fixed, pairs.moving)
    assert truth.sum() > 1500
    assert (hits & ~truth).sum() <= 10


@pytest.mark.parametrize("kind", KINDS)
def test_times_are_those_of_the_first_contact(kind):
    pairs = random_pairs(kind, "rigid", 6000, seed=13)
    truth, _, times = check(kind, pairs.fixed, pairs.moving)
    assert (times[~truth] == 1.0).all()
    fixed = pairs.fixed[truth] * FINE
    start = pairs.moving[truth][:, :, :1] * FINE
    whole = (pairs.moving[truth] * FINE)[:, :, 1:] - start
    for shift, contact in ((-2, False), (2, True)):
        steps = np.clip(np.floor(times[truth] * FINE).astype(int) + shift, 0, FINE)[:, None, None, None]
        moving = np.concatenate((start, start + whole // FINE * steps), axis=2)
        found, _ = exact(kind, fixed, moving)
        sure = steps[:, 0, 0, 0] > 0 if not contact else np.ones(len(found), dtype=bool)
        assert (found[sure] == contact).all()


# --- degenerate families -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("reach", "scale", "offset"), [
    (1, 1.0, 0.0), (2, 1.0, 0.0), (4, 1.0, 0.0),
    (2, 2.0**-20, 0.0),  # features of a micrometre
    (2, 2.0**-3, 2.0**14),  # 16 km from the origin
    (3, 2.0**-10, -(2.0**14)),
    (2, 2.0**20, 0.0),
])  # fmt: skip
def test_small_integers(kind, reach, scale, offset):
    """Coplanar, parallel, touching, sliding, zero-length, folding: one in five pairs is degenerate."""
    fixed, moving = lattice_points(kind, 300, reach, seed=reach)
    truth, hits, _ = check(kind, fixed, moving, scale, offset)
    assert truth.sum() > 5
    assert (hits == truth).all()


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("reach", [1, 2, 3, 6])
def test_many_small_integers(kind, reach):
    fixed, moving = lattice_points(kind, {1: 5_000, 2: 15_000}.get(reach, 40_000), reach, seed=20 + reach)
    truth, hits, _ = check(kind, fixed, moving)
    assert (hits & ~truth).sum() <= 4


@pytest.mark.parametrize("kind", KINDS)
def test_motion_within_a_plane(kind):
    random = np.random.default_rng(31)
    k = FIXED_POINTS[kind]
    axes = random.integers(-9, 10, (200, 2, 3))
    fixed = np.einsum("nkj,njc->nkc", random.integers(-9, 10, (200, k, 2)), axes)
    moving = np.einsum("nktj,njc->nktc", random.integers(-9, 10, (200, 4 - k, 2, 2)), axes)
    truth, hits, _ = check(kind, fixed, moving, scale=2.0**-7)
    assert 30 < truth.sum() < 190
    assert (hits == truth).all()


def test_sliding_in_the_plane_of_the_face():
    """A vertex slides past a face, in its plane, along an edge, at a known distance from it."""
    corners = np.array([[0, 0, 0], [2**20, 0, 0], [0, 2**20, 0]])
    for gap in (0, 1, 2, 1000, 2**18):
        path = np.array([[-(2**19), -gap, 0], [2**21, -gap, 0]])
        truth, hits, _ = check("vertex-face", corners[None], path[None, None])
        assert truth[0] == hits[0] == (gap == 0)


def test_parallel_edges():
    """Parallel throughout, one passing the other at a known distance, or meeting it side by side."""
    random = np.random.default_rng(32)
    d = random.integers(-50, 51, (100, 1, 3))
    fixed = np.concatenate((np.zeros_like(d), 20 * d), axis=1)
    along = random.integers(-60, 61, (100, 2, 2, 1)) * d[:, None]
    side = random.integers(-200, 201, (100, 1, 1, 3)) * np.array([1, -1]).reshape(1, 1, 2, 1)
    side[::2, :, 1] = side[::2, :, 0]  # every second one stays beside
    truth, hits, _ = check("edges", fixed, along + side, scale=2.0**-10)
    assert 10 < truth.sum() < 90
    assert (hits == truth).all()


@pytest.mark.parametrize("kind", KINDS)
def test_touching_at_the_start_is_a_contact_at_time_zero(kind):
    random = np.random.default_rng(33)
    weights = random.integers(0, 9, (1000, 2))
    weights = weights[weights.sum(axis=1) <= 8]
    count = len(weights)
    fixed = 8 * random.integers(-100, 101, (count, FIXED_POINTS[kind], 3))
    moving = 8 * random.integers(-100, 101, (count, 4 - FIXED_POINTS[kind], 2, 3))
    u, v = weights[:, :1], weights[:, 1:]
    if kind == "vertex-face":
        a, b, c = fixed.transpose(1, 0, 2)
        moving[:, 0, 0] = a + (u * (b - a) + v * (c - a)) // 8
    elif kind == "face-vertex":
        a, b, c = moving[:, :, 0].transpose(1, 0, 2)
        fixed[:, 0] = a + (u * (b - a) + v * (c - a)) // 8
    else:
        shift = fixed[:, 0] + u * (fixed[:, 1] - fixed[:, 0]) // 8
        shift -= moving[:, 0, 0] + v * (moving[:, 1, 0] - moving[:, 0, 0]) // 8
        moving += shift[:, None, None]
    _, hits, times = check(kind, fixed, moving, scale=2.0**-8)
    assert hits.all()
    assert (times == 0.0).all()


# --- near grazing, truth known by construction ------------------------------------------------------------------


def invertible(random, count):
    """Integer matrices: linear maps keep contacts and separations."""
    maps = random.integers(-4, 5, (count, 3, 3))
    return maps[np.abs(np.linalg.det(maps)) > 0.5]


@pytest.mark.slow
@pytest.mark.parametrize("gap", [-1, 0, 1])
def test_a_path_past_the_edge_of_a_face(gap):
    """The path crosses the plane of the face on an edge, or by one unit of the lattice inside or outside."""
    random = np.random.default_rng(34)
    maps = invertible(random, 1200)
    count = len(maps)
    size = 2**15
    corners = np.array([[0, 0, 0], [size, 0, 0], [0, size, 0]])
    place = np.stack(
        (random.integers(1, size, count), np.full(count, -gap), np.zeros(count, dtype=int)), axis=1
    )
    lift = random.integers(-size, size, (count, 3))
    lift[:, 2] |= 1
    path = np.stack((place + 3 * lift, place - 5 * lift), axis=1)[:, None]
    moved = np.einsum("nij,nktj->nkti", maps, path)
    fixed = np.einsum("nij,kj->nki", maps, corners)
    for kind, still, moving in (
        ("vertex-face", fixed, moved),
        ("face-vertex", moved[:, :, 0], fixed[:, :, None] - moved + moved[:, :, :1]),
    ):
        truth, hits, _ = check(kind, still, moving)
        assert (truth == (gap <= 0)).all()
        assert (hits == truth).all()


@pytest.mark.parametrize("gap", [-3, -2, -1, 0, 1, 2, 3])
def test_edges_that_graze(gap):
    """A turning edge whose coplanarity polynomial is gap - k s^2, s = t - 1/2: contact only if the gap is not negative.

    In units of the size the moving edge goes from (x, -1 + s, -k s + gap) to (x, 1 + s, k s + gap), past the x axis.
    """
    random = np.random.default_rng(35)
    maps = invertible(random, 600)
    count = len(maps)
    size = 2**16
    zero = np.zeros(count, dtype=int)
    turn = random.integers(1, 6, count)
    at = random.integers(-size // 2, size // 2, count)
    fixed = np.broadcast_to([[-2 * size, 0, 0], [2 * size, 0, 0]], (count, 2, 3))
    moving = np.empty((count, 2, 2, 3), dtype=int)
    for end, y in ((0, -size), (1, size)):
        for time, s in ((0, -size // 2), (1, size // 2)):
            height = (s if end else -s) * turn + gap
            moving[:, end, time] = np.stack((at + 7 * end, zero + y + s, height), axis=1)
    truth, hits, times = check(
        "edges", np.einsum("nij,nkj->nki", maps, fixed), np.einsum("nij,nktj->nkti", maps, moving)
    )
    assert (truth == (gap >= 0)).all()
    assert (hits == truth).all()
    s = np.sqrt(max(gap, 0) / size / turn)
    np.testing.assert_allclose(times[hits], (0.5 - s)[hits], atol=1e-3)


@pytest.mark.parametrize("gap", [-1, 0, 1, 2])
@pytest.mark.parametrize("kind", ["edges", "face-vertex"])
def test_edges_that_turn_within_a_plane(kind, gap):
    """A turning edge passes the origin at gap + k s^2, s = t - 1/2, in a plane: contact unless the gap is positive.

    In units of the size it goes from (-1 + s, k s + gap) to (1 + s, -k s + gap), above an edge that hangs from the
    origin, or as the lower edge of a triangle above the origin.
    """
    random = np.random.default_rng(37)
    maps = invertible(random, 120)
    count = len(maps)
    size = 2**16
    turn = random.integers(1, 4, count)
    moving = np.zeros((count, 2 if kind == "edges" else 3, 2, 3), dtype=int)
    fixed = np.zeros((count, 2 if kind == "edges" else 1, 3), dtype=int)
    for time, s in ((0, -size // 2), (1, size // 2)):
        moving[:, 0, time, 0], moving[:, 0, time, 1] = s - size, turn * s + gap
        moving[:, 1, time, 0], moving[:, 1, time, 1] = s + size, -turn * s + gap
        if kind == "face-vertex":
            moving[:, 2, time, 0], moving[:, 2, time, 1] = s, 5 * size
    fixed[:, 1:, 1] = -size
    truth, hits, _ = check(
        kind, np.einsum("nij,nkj->nki", maps, fixed), np.einsum("nij,nktj->nkti", maps, moving)
    )
    assert (truth == (gap <= 0)).all()
    assert (hits == truth).all()


def test_what_comes_within_the_tolerance_is_a_contact():
    """An edge passes the end of another by 2^-40 and 2^-24 of its length."""
    rows = np.array([
        (0, 0, 0, 1, 0, 0, 1 + gap, -1, 1, 1 + gap, -1, -1, 1 + gap, 1, 1, 1 + gap, 1, -1)
        for gap in (2.0**-40, 2.0**-24)
    ])  # fmt: skip
    hits, _ = swept("edges", rows)
    assert hits.tolist() == [True, False]


@pytest.mark.parametrize("start", [-1e-12, 1e-12])
@pytest.mark.parametrize("end", [-0.1, 0.1])
def test_a_start_within_the_rounding_of_coordinates_is_a_contact(start, end):
    """4 km from the origin positions are known to 5e-13 m: the side of the face is not."""
    corners = (4000.0, 4000.0, 4000.0, 4001.0, 4000.0, 4000.0, 4000.0, 4001.0, 4000.0)
    x = (4000.25, 4000.25, 4000.0)
    hits, times = swept("vertex-face", np.array([(*x[:2], x[2] + start, *x[:2], x[2] + end, *corners)]))
    assert hits[0]
    assert times[0] < 1e-10
    moving = np.array(corners).reshape(3, 1, 3) - [[0, 0, start], [0, 0, end]]
    hits, times = swept("face-vertex", np.concatenate((x, moving.ravel()))[None])
    assert hits[0]
    assert times[0] < 1e-10
    edge = (4000.0, 4000.0, 4000.0, 4001.0, 4000.0, 4000.0)
    ends = [(4000.5, y, 4000.0 + z) for y in (3999.0, 4001.0) for z in (start, end)]
    hits, times = swept("edges", np.concatenate((edge, np.ravel(ends)))[None])
    assert hits[0]
    assert times[0] < 1e-10


def test_thin_triangles():
    """Faces ten thousand times as long as high, crossed inside and outside by a tenth of the height."""
    random = np.random.default_rng(36)
    maps = invertible(random, 1000)
    count = len(maps)
    length, height = 2**19, 60
    corners = np.array([[0, 0, 0], [length, 0, 0], [length // 2, height, 0]])
    x = random.integers(length // 4, 3 * length // 4, count)
    top = height * np.minimum(x, length - x) // (length // 2)
    y = np.where(np.arange(count) % 2 == 0, top - 6, top + 6)
    lift = random.integers(1, 2**10, (count, 3))
    place = np.stack((x, y, np.zeros(count, dtype=int)), axis=1)
    path = np.stack((place + lift, place - lift), axis=1)[:, None]
    fixed = np.einsum("nij,kj->nki", maps, corners)
    moved = np.einsum("nij,nktj->nkti", maps, path)
    truth, hits, _ = check("vertex-face", fixed, moved)
    assert (truth == (np.arange(count) % 2 == 0)).all()
    assert (hits == truth).all()
