"""Room for the contacts of many collisions: those with the usual number share what there is."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.solver.contact.triangles.packing import LEAST_SHARE, MOST_AT_ALL, _share_room
from heavylift.solver.scene.collisions import Collision

USUAL = Collision.most_contacts


@pytest.mark.parametrize("surfaces", [2, 20, 21, 22, 60, 79])
def test_all_pairs_of_many_surfaces_fit(surfaces: int) -> None:
    most = np.full(surfaces * (surfaces - 1) // 2, USUAL)
    _share_room(most)
    assert most.sum() <= MOST_AT_ALL
    assert most.min() == most.max() >= LEAST_SHARE
    assert (most[0] == USUAL) == (USUAL * len(most) <= MOST_AT_ALL)


def test_numbers_that_were_said_stay() -> None:
    most = np.array([8192, 64, *[USUAL] * 300])
    _share_room(most)
    assert most[:2].tolist() == [8192, 64]
    assert most.sum() <= MOST_AT_ALL
    assert most[-1] == (MOST_AT_ALL - 8256) // 300


def test_too_little_for_each_is_left_for_a_refusal() -> None:
    most = np.full(MOST_AT_ALL // LEAST_SHARE + 1, USUAL)
    _share_room(most)
    assert most.sum() > MOST_AT_ALL
