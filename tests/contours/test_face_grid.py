"""Faces, lines and circles of nodes of a mesh: order, outward normal, what is no grid."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.splines.checks import check_outward
from heavylift.contours.splines.face_grid import circle_nodes, face_grid, line_nodes, plane_nodes
from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import InputError


def block(shape=(6, 5, 4), size=(1.0, 0.6, 0.3), seed=0) -> np.ndarray:
    """Nodes of a block of bricks in any order, uneven in x."""
    axes = [np.linspace(0.0, 1.0, n) for n in shape]
    axes[0] = axes[0] ** 1.3
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3) * np.array(size)
    return np.random.default_rng(seed).permutation(nodes)


TURN = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]


@pytest.mark.parametrize("turn", [np.eye(3), TURN])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("end", [0, 1])
def test_every_face_of_a_block_is_a_grid_with_its_normal_out(axis: int, end: int, turn: np.ndarray) -> None:
    size = np.array([1.0, 0.6, 0.3])
    straight = block()
    members = plane_nodes(straight, "xyz"[axis], end * size[axis])
    nodes = straight @ turn.T
    grid = face_grid(nodes, members)
    assert sorted(grid.shape) == sorted(np.delete([6, 5, 4], axis))
    assert sorted(grid.ravel()) == sorted(members)
    normal = np.cross(nodes[grid[-1, 0]] - nodes[grid[0, 0]], nodes[grid[0, -1]] - nodes[grid[0, 0]])
    outward = turn[:, axis] * (2 * end - 1)
    assert normal / np.linalg.norm(normal) == pytest.approx(outward, abs=1e-12)
    # rows and columns are straight and in order
    steps = np.diff(nodes[grid], axis=1) @ (nodes[grid[0, -1]] - nodes[grid[0, 0]])
    assert np.min(steps) > 0.0
    surface = neutral_surface(nodes[grid])
    check_outward(surface, nodes=nodes)
    check_outward(surface, interior=nodes.mean(axis=0))


def test_a_given_direction_decides_on_an_inner_plane() -> None:
    nodes = block((6, 5, 5))
    members = plane_nodes(nodes, "z", 0.15)
    with pytest.raises(InputError, match=r"material on both sides of the face"):
        face_grid(nodes, members)
    grid = face_grid(nodes, members, outward=np.array([0.0, 0.0, -1.0]))
    assert np.cross(nodes[grid[-1, 0]] - nodes[grid[0, 0]], nodes[grid[0, -1]] - nodes[grid[0, 0]])[2] < 0.0
    with pytest.raises(InputError, match=r"lies in the face"):
        face_grid(nodes, members, outward=np.array([1.0, 0.0, 0.0]))


def test_a_part_of_a_face() -> None:
    nodes = block()
    members = plane_nodes(nodes, "z", 0.3, lower=np.array([0.0, 0.1, 0.0]), upper=np.array([0.6, 0.5, 0.3]))
    grid = face_grid(nodes, members)
    inside = (np.linspace(0.0, 1.0, 6) ** 1.3 <= 0.6).sum()
    assert grid.shape == (inside, 3)


def test_what_is_no_grid() -> None:
    nodes = block()
    members = plane_nodes(nodes, "z", 0.3)
    with pytest.raises(
        InputError, match=r"29 nodes at 6 by 5 different coordinates, 1 places of the grid without"
    ):
        face_grid(nodes, members[1:])
    moved = nodes.copy()
    moved[members[3], 0] += 0.003
    with pytest.raises(InputError, match=r"lid: the nodes of the face make no grid: 30 nodes at 7 by 5"):
        face_grid(moved, members, source="lid")
    moved = nodes.copy()
    moved[members[3], 2] += 0.003
    with pytest.raises(InputError, match=f"not in one plane: node {members[3] + 1} lies 0.00[0-9]+ m off"):
        face_grid(moved, members)
    with pytest.raises(InputError, match=r"3 nodes on the face"):
        face_grid(nodes, members[:3])
    with pytest.raises(InputError, match=r"lie on a line"):
        face_grid(nodes, line_nodes(nodes, np.zeros(3), np.array([1.0, 0.0, 0.0])))
    doubled = np.concatenate([nodes, nodes[members[:1]]])
    with pytest.raises(InputError, match=r"several in one place"):
        face_grid(doubled, np.append(members, len(nodes)))


def test_planes_without_nodes_name_the_nearest() -> None:
    with pytest.raises(InputError, match=r"no node has z = 0.29 m; expected .* nearest is z = 0.3 m"):
        plane_nodes(block(), "z", 0.29)
    with pytest.raises(InputError, match=r"no node lies between"):
        plane_nodes(block(), "z", 0.3, lower=np.array([2.0, 0, 0]), upper=np.array([3.0, 1, 1]))


def test_nodes_of_a_line_are_in_its_order() -> None:
    nodes = block()
    there = line_nodes(nodes, np.array([1.0, 0.6, 0.0]), np.array([0.0, 0.6, 0.0]))
    assert nodes[there][:, 0] == pytest.approx(np.linspace(1.0, 0.0, 6) ** 1.3)
    back = line_nodes(nodes, np.array([-1.0, 0.6, 0.0]), np.array([1.0, 0.6, 0.0]))
    assert back.tolist() == there[::-1].tolist()
    with pytest.raises(
        InputError, match=r"no node on the line .*; the nearest, node \d+, lies 0.05 m beside it"
    ):
        line_nodes(nodes, np.array([0.0, 0.65, 0.0]), np.array([1.0, 0.65, 0.0]))
    with pytest.raises(InputError, match=r"one node on the line"):
        line_nodes(nodes, np.array([0.0, 0.0, 0.0]), np.array([0.01, 0.0, 0.0]))
    with pytest.raises(InputError, match=r"both ends"):
        line_nodes(nodes, np.zeros(3), np.zeros(3))


def test_nodes_of_a_circle_go_round_its_axis() -> None:
    angle = 2.0 * np.pi * np.arange(16) / 16
    rings = [r * np.column_stack([0.0 * angle, np.cos(angle), np.sin(angle)]) for r in (0.8, 1.0)]
    nodes = np.random.default_rng(3).permutation(np.concatenate(rings)) + np.array([5.0, 0.0, 0.0])
    centre = np.array([5.0, 0.0, 0.0])
    around = circle_nodes(nodes, centre, np.array([2.0, 0.0, 0.0]), 1.0)
    assert around.size == 16
    ways = nodes[around] - centre
    assert np.linalg.norm(ways, axis=1) == pytest.approx(np.ones(16))
    assert np.cross(ways, np.roll(ways, -1, axis=0))[:, 0] == pytest.approx(
        np.sin(2 * np.pi / 16) * np.ones(16)
    )
    with pytest.raises(InputError, match=r"0 nodes on the circle; the nearest other one, node"):
        circle_nodes(nodes, centre, np.array([1.0, 0.0, 0.0]), 0.9)
    half = nodes[nodes[:, 2] > -1e-9]
    with pytest.raises(InputError, match=r"leave 180 degrees of it without a node"):
        circle_nodes(half, centre, np.array([1.0, 0.0, 0.0]), 1.0)
