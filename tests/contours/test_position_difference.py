"""The position difference method: right where it is exact, wrong where it is known to be."""

from __future__ import annotations

import numpy as np
import pytest
from random_motions import KINDS, random_pairs

from heavylift.contours.triangles.position_difference import (
    EDGE_CASES,
    FACE_SWEEPS,
    FACE_SWEEPS_START,
    VERTEX_CASES,
    VERTEX_MOVES,
    VERTEX_MOVES_START,
    difference_pairs,
    to_axes,
)
from heavylift.numerics.outcome import InputError

FACE = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], dtype=float)


def difference(points, cases, edges=False):
    hits = np.zeros(len(points), dtype=np.bool_)
    difference_pairs(np.ascontiguousarray(points, dtype=float).reshape(len(points), 24), edges, cases, hits)
    return hits


def pair(path, shift=(0, 0, 0)):
    """A vertex on a path, and the face, which moves by a shift."""
    return np.array([path, *([corner, corner + np.array(shift)] for corner in FACE)], dtype=float)[None]


def cases_that_hold(points):
    return [
        bool(difference(points, one)[0])
        for one in (VERTEX_MOVES, FACE_SWEEPS, VERTEX_MOVES_START, FACE_SWEEPS_START)
    ]


def test_each_case_sees_the_motion_it_is_made_for():
    # the vertex moves through the face, which stands still: both cases with the path
    assert cases_that_hold(pair([[1, 1, 1], [1, 1, -1]])) == [True, False, True, False]
    # the face rises over the vertex: both cases with the prism
    assert cases_that_hold(pair([[1, 1, 1], [1, 1, 1]], (0, 0, 2))) == [False, True, False, True]
    # beside the face: none
    assert cases_that_hold(pair([[3, 3, 1], [3, 3, -1]])) == [False] * 4


def test_a_contact_that_all_cases_miss():
    """Vertex and face both move sideways by five widths of the face: it depends on the observer."""
    alone = pair([[1, 1, 1], [1, 1, -1]])
    shared = np.zeros((4, 2, 3))
    shared[:, 1] = [20, 0, 0]
    assert difference(alone, VERTEX_CASES)[0]
    assert not difference(alone + shared, VERTEX_CASES)[0]
    identity = np.broadcast_to(np.eye(3), (1, 2, 3, 3))
    seen = to_axes((alone + shared).reshape(1, 24), identity, shared[:1, :])
    assert difference(seen, VERTEX_CASES)[0]


def test_a_contact_that_it_invents():
    """The vertex crosses the place where the face was, which has left by then."""
    points = pair([[1, 1, 1], [1, 1, -1]], (0, 0, -10))
    assert difference(points, VERTEX_CASES)[0]


def test_edges():
    edge = np.array([[[0, -2, 0]] * 2, [[0, 2, 0]] * 2])
    moving = np.array([[[-2, 0, 1], [-2, 0, -1]], [[2, 0, 1], [2, 0, -1]]])
    points = np.concatenate((edge, moving))[None]
    assert difference(points, EDGE_CASES, edges=True)[0]
    assert not difference(
        points + np.array([0, 0, 3])[None] * (np.arange(4) < 2)[:, None, None], EDGE_CASES, True
    )[0]
    shared = np.array([[0, 0, 0], [20, 0, 0]])
    assert not difference(points + shared, EDGE_CASES, edges=True)[0]


def test_axes_of_the_wrong_shape():
    with pytest.raises(InputError, match=r"to_axes: origins: shape \(3,\)"):
        to_axes(np.zeros((1, 24)), np.zeros((1, 2, 3, 3)), np.zeros(3))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_it_misses_and_invents_contacts(kind):
    """Of 1e5 random pairs, against exact arithmetic: share of true contacts missed, false ones for each true one."""
    cases = EDGE_CASES if kind == "edges" else VERTEX_CASES
    bounds = {
        "rigid": ((0.05, 0.15), (0.5, 1.2)) if kind == "edges" else ((0.10, 0.20), (1.0, 2.5)),
        "common": ((0.20, 0.45), (1.5, 3.0)) if kind == "edges" else ((0.30, 0.60), (2.5, 5.0)),
    }
    for regime, ((least, most), (fewest, largest)) in bounds.items():
        pairs = random_pairs(kind, regime, 100_000, seed=51)
        truth, _ = pairs.truth()
        hits = difference(pairs.world(), cases, kind == "edges")
        assert least < (truth & ~hits).sum() / truth.sum() < most
        assert fewest < (hits & ~truth).sum() / truth.sum() < largest
        seen = difference(to_axes(pairs.world(), pairs.rotations, pairs.origins), cases, kind == "edges")
        assert (truth & ~seen).sum() < 0.1 * truth.sum()
        assert (seen & ~truth).sum() < 0.5 * truth.sum()
