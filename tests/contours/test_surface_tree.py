"""Trees of boxes: every triangle once, tight boxes, and the split with the smallest cost."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.triangles.surface_layout import TreeNode
from heavylift.contours.triangles.surface_tree import LEAF_TRIANGLES, build_tree, tree_depth
from heavylift.numerics.records import filled_rows


def soup(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(count, 1, 3)) * [5.0, 1.0, 0.2] + 0.3 * rng.normal(size=(count, 3, 3))
    return corners.min(axis=1), corners.max(axis=1)


def flat_soup(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles in one plane: boxes without height."""
    lower, upper = soup(count, 3)
    lower[:, 2] = upper[:, 2] = 0.0
    return lower, upper


def points_in_one_place(count: int) -> tuple[np.ndarray, np.ndarray]:
    place = np.full((count, 3), 2.5)
    return place, place.copy()


SOUPS = {
    "one": soup(1, 0),
    "leaf": soup(LEAF_TRIANGLES, 1),
    "some": soup(9, 2),
    "many": soup(3000, 3),
    "flat": flat_soup(500),
    "one place": points_in_one_place(100),
}


@pytest.mark.parametrize("boxes", SOUPS.values(), ids=SOUPS)
def test_each_triangle_is_in_one_leaf_and_all_boxes_are_tight(boxes):
    lower, upper = boxes
    tree = build_tree(lower, upper)
    assert sorted(tree.order) == list(range(len(lower)))
    covered = np.zeros(len(lower), dtype=int)
    for node, row in enumerate(tree.nodes):
        rows = slice(row.first, row.first + row.count)
        inside = tree.order[rows]
        box = tree.boxes[node]
        np.testing.assert_allclose(box.centre - box.half, lower[inside].min(axis=0), atol=1e-14)
        np.testing.assert_allclose(box.centre + box.half, upper[inside].max(axis=0), atol=1e-14)
        left = row.left
        if left < 0:
            assert 1 <= row.count <= LEAF_TRIANGLES
            covered[rows] += 1
        else:
            assert left > node
            halves = tree.nodes[[left, left + 1]]
            assert halves[0].first == row.first
            assert halves[1].first == halves[0].first + halves[0].count
            assert halves["count"].sum() == row.count
    assert (covered == 1).all()
    assert tree.nodes[0].count == len(lower)


def cheapest(lower: np.ndarray, upper: np.ndarray, inside: np.ndarray) -> float:
    """Smallest sum of area x number over all places along all axes, each computed by itself."""

    def half_area(rows: np.ndarray) -> float:
        x, y, z = upper[rows].max(axis=0) - lower[rows].min(axis=0)
        return x * y + y * z + z * x

    costs = []
    for axis in range(3):
        rows = inside[np.argsort((lower + upper)[inside, axis], kind="stable")]
        costs += [
            k * half_area(rows[:k]) + (len(rows) - k) * half_area(rows[k:]) for k in range(1, len(rows))
        ]
    return min(costs)


def test_every_split_is_the_cheapest_one():
    lower, upper = soup(200, 5)
    tree = build_tree(lower, upper)
    for row in tree.nodes:
        left = row.left
        if left >= 0:
            inside = tree.order[row.first : row.first + row.count]
            cost = 0.0
            for child in (left, left + 1):
                x, y, z = 2.0 * tree.boxes[child].half
                cost += tree.nodes[child].count * (x * y + y * z + z * x)
            # edge lengths have a small share of the cost, for boxes without area
            assert cost <= cheapest(lower, upper, np.sort(inside)) * (1.0 + 1e-3)


def test_triangles_in_one_place_make_a_flat_tree():
    tree = build_tree(*points_in_one_place(1024))
    assert tree_depth(tree.nodes) == 8  # halves down to 8 of 1024: 7 splits


def test_depth_is_that_of_the_longest_branch():
    # 0 has children 1 and 2; 2 has 3 and 4
    nodes = filled_rows(TreeNode, left=[1, -1, 3, -1, -1], first=[0, 0, 8, 8, 16], count=[30, 8, 16, 8, 8])
    assert tree_depth(nodes) == 3
    assert tree_depth(nodes, 2) == 2
    assert tree_depth(nodes, 4) == 1
