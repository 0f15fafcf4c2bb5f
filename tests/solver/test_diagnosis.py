"""Degrees of freedom, redundant joints and free motions of linkages whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest
from point_masses import make_cloud
from scipy.sparse import csr_array
from start_scenes import DOWN, bricard, joint, linkage, parallelograms, rod, rows_of

from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.scene import Fixed, FlexibleBody, Free, RigidBody, Scene
from heavylift.solver.start.diagnosis import Diagnosis, block_rank, body_graph, diagnose


def found(scene: Scene) -> Diagnosis:
    return diagnose(rows_of(scene))


def test_pendulum_turns_about_its_hinge() -> None:
    result = found(linkage([(1, 2, 0), (2, 2, 0)], closed=False))
    assert (result.degrees_of_freedom, result.row_count, result.rank) == (1, 5, 5)
    assert result.redundant == ()
    assert result.free_motions == ("'r0' can turn about z through (1, 2, 0) m, at joint 'h0'",)


def test_open_chain_is_free_at_every_joint() -> None:
    result = found(linkage([(i, 0, 0) for i in range(5)], closed=False))
    assert result.degrees_of_freedom == 4
    assert result.redundant == ()
    assert result.free_motions[1] == (
        "'r1' (and 2 bodies on it) can turn about z through (1, 0, 0) m relative to 'r0', at joint 'h1'"
    )


def test_door_on_two_hinges() -> None:
    """The second hinge adds five rows and no constraint."""
    door = rod("door", (0, 0, 0), (1, 0, 0))
    hinges = (joint(Hinge, "upper", None, door, (0, 0, 1)), joint(Hinge, "lower", None, door, (0, 0, -1)))
    result = found(Scene((door,), (DOWN,), (), hinges))
    assert (result.degrees_of_freedom, result.rank) == (1, 5)
    (sentence,) = result.redundant
    assert "'upper' and 'lower'" in sentence
    assert "5 rows too many" in sentence
    assert "turn about z through (0, 0, 0) m" in result.free_motions[0]


@pytest.mark.parametrize("loops", [1, 3])
def test_parallelograms_are_redundant_by_three_rows_a_loop(loops: int) -> None:
    """A planar loop of four hinges in space: 3 rows too many; all cranks turn together."""
    result = found(parallelograms(loops))
    assert result.degrees_of_freedom == 1
    assert result.row_count - result.rank == 3 * loops
    assert len(result.redundant) == loops
    for k, sentence in enumerate(result.redundant):
        assert all(f"'{name}'" in sentence for name in (f"foot{k}", f"left{k}", f"right{k}", f"foot{k + 1}"))
        assert "3 rows too many: " in sentence
    assert result.singular is False
    assert "'crank0' turns about z through (0, 0, 0) m" in result.free_motions[0]
    assert "'bar0' moves along x" in result.free_motions[0]


def test_many_loops_are_counted_by_blocks() -> None:
    """Far above what is decomposed at once."""
    result = found(parallelograms(60))
    assert result.degrees_of_freedom == 1
    assert result.row_count - result.rank == 180
    assert len(result.redundant) == 60


def test_bricard_moves_against_the_count() -> None:
    """Five bodies and six hinges: 30 - 30 = 0 by Gruebler's count; it moves, because one row depends on others."""
    result = found(bricard())
    assert (result.degrees_of_freedom, result.row_count, result.rank) == (1, 30, 29)
    assert "1 row too many" in result.redundant[0]
    assert result.singular is False


def test_stretched_links_are_free_at_first_sight_only() -> None:
    """Two links in line between two hinges: planar loop (3 redundant rows), and one more in this position."""
    result = found(linkage([(0, 0, 0), (1, 0, 0), (2, 0, 0)]))
    assert result.degrees_of_freedom == 1
    assert result.row_count - result.rank == 4
    assert result.singular is True
    assert "in this position only" in result.redundant[0]


def test_buckled_links_are_rigid() -> None:
    result = found(linkage([(0, 0, 0), (1, 0.3, 0), (2, 0, 0)]))
    assert result.degrees_of_freedom == 0
    assert result.row_count - result.rank == 3
    assert result.free_motions == ()


def test_duplicated_joint_on_bodies_in_flight() -> None:
    """A ball beside a fixed joint; what is left is one free body."""
    a, b = rod("a", (0, 0, 0), (1, 0, 0)), rod("b", (1, 0, 0), (2, 0, 0))
    joints = (joint(FixedJoint, "weld", a, b, (1, 0, 0)), joint(Ball, "pin", a, b, (1, 0.2, 0)))
    result = found(Scene((a, b), (DOWN,), (), joints))
    assert result.degrees_of_freedom == 6
    assert result.row_count - result.rank == 3
    assert "'weld'" in result.redundant[0]
    assert "3 rows too many" in result.redundant[0]
    assert result.free_motions == ("'a' and 'b' hang together, and no joint holds them to anything else",)


@pytest.mark.parametrize("motion", [Fixed(), Free()])
@pytest.mark.parametrize(("kind", "rows"), [(FixedJoint, 6), (Ball, 3)])
def test_weight_on_a_body_with_modes(motion: Fixed | Free, kind: type, rows: int) -> None:
    """As many motions as modes and velocities less the rows; those of a group in flight as a whole are not its own."""
    cloud = make_cloud(modes=8)
    node = np.argmax(cloud.nodes[:, 0])
    bar = FlexibleBody("bar", cloud.reduced(), motion=motion)
    weight = RigidBody("weight", 2.0, 0.01 * np.eye(3), position=cloud.nodes[node])
    frames = {"frame_a": JointFrame(cloud.nodes[node]), "frame_b": JointFrame(np.zeros(3))}
    result = found(
        Scene((bar, weight), (DOWN,), (), (kind(name="bolt", body_a="bar", body_b="weight", **frames),))
    )
    own = 8 + 6 - rows
    in_flight = isinstance(motion, Free)
    assert result.degrees_of_freedom == own + 6 * in_flight
    assert result.redundant == ()
    expected = (f"'bar' and 'weight' have {own} motions of their own, in which 'bar' and 'weight' move",)
    if in_flight:
        expected += ("'bar' and 'weight' hang together, and no joint holds them to anything else",)
    assert result.free_motions == expected
    assert result.singular is False


def test_block_rank_agrees_with_the_singular_values() -> None:
    """Random sparse rows on 40 bodies, some of them sums of others."""
    random = np.random.default_rng(3)
    bodies = 40
    matrix = np.zeros((0, 6 * bodies))
    for _ in range(45):
        a, b = random.choice(bodies, 2, replace=False)
        rows = np.zeros((4, 6 * bodies))
        rows[:3, 6 * a : 6 * a + 6] = random.normal(size=(3, 6))
        rows[:3, 6 * b : 6 * b + 6] = random.normal(size=(3, 6))
        rows[3] = random.normal(size=3) @ rows[:3]
        matrix = np.vstack([matrix, rows])
    matrix /= np.linalg.norm(matrix, axis=1)[:, None]
    owner = np.repeat(np.arange(bodies), 6)
    expected = np.linalg.matrix_rank(matrix)
    assert expected < len(matrix)
    assert block_rank(csr_array(matrix), owner, 1e-9) == expected


def test_graph_cuts_bridges_and_keeps_loops() -> None:
    """Ground - 0 - 1 - 2 - 0 (a loop of three), 2 - 3 a bridge, 4 alone."""
    sides = np.array([[-1, 0], [0, 1], [1, 2], [2, 0], [3, 2]])
    graph = body_graph(5, sides, np.zeros(5, dtype=bool))
    assert {pair.bodies for pair in graph.bridges} == {(5, 0), (2, 3)}
    (core,) = graph.cores
    assert sorted(core.bodies) == [0, 1, 2]
    assert not core.grounded
    assert [len(loop) for loop in core.loops] == [3]
    assert graph.floating == ((4,),)
