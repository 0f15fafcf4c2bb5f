"""Rigid links, averages, ties and rigid masses: closed forms, chains, and what contradicts itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.group_motion import mean_motion
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.structure import (
    Average,
    Beams,
    PointMass,
    RigidLink,
    Shells,
    Solids,
    Structure,
    Tie,
)

STEEL = Material(2.1e11, 0.3, 7850.0)
RNG = np.random.default_rng(5)
BRICK = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)
BAR = profile("flat", height=0.2, thickness=0.02).section


def rigid(points):
    """Displacements of points in a rigid motion about the origin, and its rotation."""
    u, theta = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.4, -0.3])
    return u + np.cross(theta, points), theta


def test_mean_of_a_rigid_motion_is_the_motion():
    positions, weights = RNG.normal(size=(7, 3)), RNG.uniform(0.5, 2.0, 7)
    point = np.array([3.0, 1.0, -2.0])
    forces, moments = mean_motion(point, positions, weights, np.zeros(7, dtype=bool))
    moved, theta = rigid(positions)
    found = np.einsum("mki,mk->i", forces, moved)
    np.testing.assert_allclose(found, np.concatenate([rigid(point)[0], theta]), atol=1e-12)
    assert not moments.any()


def test_loads_of_an_average_balance_those_at_its_point():
    positions, weights = RNG.normal(size=(5, 3)), RNG.uniform(0.5, 2.0, 5)
    point = np.array([1.0, 2.0, 0.5])
    forces, _ = mean_motion(point, positions, weights, np.zeros(5, dtype=bool))
    load = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    shares = forces @ load
    np.testing.assert_allclose(shares.sum(axis=0), load[:3], atol=1e-12)
    np.testing.assert_allclose(np.cross(positions - point, shares).sum(axis=0), load[3:], atol=1e-12)


def test_a_line_of_nodes_turns_as_its_nodes_do():
    """About the line the mean of the rotations; across it what the displacements say."""
    positions = np.column_stack([np.linspace(0.0, 2.0, 4), np.zeros((4, 2))])
    forces, moments = mean_motion(np.zeros(3), positions, np.ones(4), np.ones(4, dtype=bool))
    moved, theta = rigid(positions)
    found = np.einsum("mki,mk->i", forces, moved) + np.einsum("mki,k->i", moments, theta)
    np.testing.assert_allclose(found, np.concatenate([[0.3, -0.2, 0.5], theta]), atol=1e-12)
    turn = np.einsum("mki,mk->i", moments, np.tile([1.0, 0.0, 0.0], (4, 1)))
    assert turn[3] == pytest.approx(1.0)
    with pytest.raises(InputError, match="4 nodes without rotations on one line"):
        mean_motion(np.zeros(3), positions, np.ones(4), np.zeros(4, dtype=bool), key="lug")
    with pytest.raises(InputError, match="one node without rotations"):
        mean_motion(np.zeros(3), positions[:1], np.ones(1), np.zeros(1, dtype=bool), key="lug")
    with pytest.raises(InputError, match="weights of sum 0"):
        mean_motion(np.zeros(3), positions, np.array([1.0, 1.0, -1.0, -1.0]), np.ones(4, dtype=bool))


def brick_with(nodes, **parts):
    """A brick, and further nodes."""
    return Structure(
        np.concatenate([BRICK, np.atleast_2d(nodes)]),
        solids=(Solids("s", np.arange(8)[None], "hex8", STEEL),),
        **parts,
    )


def rigid_motions(model):
    n = model.node_count
    motions = np.zeros((model.dof_count, 6))
    for k in range(3):
        motions[k : 3 * n : 3, k] = 1.0
        motions[: 3 * n, 3 + k] = np.cross(np.eye(3)[k], model.nodes).ravel()
        motions[3 * n + k :: 3, 3 + k] = 1.0
    return motions


def test_chains_follow_rigid_motions_and_leave_six_of_them():
    """A beam on a node that averages the top of a brick, a rigid link from its end, a tie, a mass with inertia."""
    nodes = np.array([[0.5, 0.5, 1.2], [0.5, 0.5, 2.0], [0.9, 0.5, 2.2], [0.9, 0.5, 2.2]])
    structure = brick_with(
        nodes,
        averages=(Average(8, np.array([4, 5, 6, 7]), np.array([1.0, 2.0, 1.0, 1.0])),),
        beams=(Beams("b", np.array([[8, 9]]), STEEL, BAR, np.array([1.0, 0, 0])),),
        links=(RigidLink(9, np.array([10])),),
        ties=(Tie(10, 11),),
        masses=(PointMass(11, 100.0, np.array([0.1, 0, 0]), np.diag([3.0, 4.0, 5.0])),),
    )
    model = assemble_structure(structure)
    T = model.constraint
    assert T.shape == (3 * (12 + len(model.rotating)), 24 + 6)
    K = (T.T @ model.stiffness @ T).toarray()
    values = np.linalg.eigvalsh(K)
    assert np.sum(values < 1e-12 * values[-1]) == 6
    # rigid motions satisfy all constraints: they follow from the free ones
    R = rigid_motions(model)
    free = [
        int(np.flatnonzero((T[:, [k]].toarray().ravel() == 1.0) & (np.diff(T.indptr) == 1))[0])
        for k in range(30)
    ]
    np.testing.assert_allclose(T @ R[free], R, atol=1e-12)
    M = R.T @ model.mass @ R
    line = 7850.0 * BAR.area * 0.8
    assert M[2, 2] == pytest.approx(7850.0 + line + 100.0, rel=1e-12)


def test_inertia_of_a_rigid_mass_is_exact():
    """Also with products, without mass, and where no real body has such an inertia."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    plate = Shells("p", np.array([[0, 1, 2, 3]]), STEEL, 0.01)
    bare = assemble_structure(Structure(corners, shells=(plate,)))
    J = np.array([[5.0, -0.6, 0.2], [-0.6, 4.0, 0.1], [0.2, 0.1, 3.0]])
    o = np.array([0.1, -0.2, 0.3])
    S = np.array([[0, -o[2], o[1]], [o[2], 0, -o[0]], [-o[1], o[0], 0]])
    for mass, inertia in ((100.0, J), (0.0, J), (1.0, np.diag([0.0, 0.0, 7.0])), (50.0, np.zeros((3, 3)))):
        one = PointMass(2, mass, o, inertia)
        model = assemble_structure(Structure(corners, shells=(plate,), masses=(one,)))
        added = (model.mass - bare.mass).toarray()
        at = np.array([6, 7, 8, 18, 19, 20])
        expected = np.block([[mass * np.eye(3), -mass * S], [mass * S, inertia - mass * S @ S]])
        np.testing.assert_allclose(added[np.ix_(at, at)], expected, atol=1e-9)
        assert model.total_mass == pytest.approx(bare.total_mass + mass, rel=1e-12)


def test_ties_join_plates_as_common_nodes_do():
    """Two plates with their own nodes along a common edge, tied, are the plate with common ones."""
    x = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]], float)
    nodes = np.column_stack([x, np.zeros(6)])
    whole = Structure(nodes, shells=(Shells("p", np.array([[0, 1, 2, 3], [1, 4, 5, 2]]), STEEL, 0.01),))
    apart = Structure(
        np.concatenate([nodes, nodes[[1, 2]]]),
        shells=(Shells("p", np.array([[0, 1, 2, 3], [6, 4, 5, 7]]), STEEL, 0.01),),
        ties=(Tie(1, 6), Tie(2, 7)),
    )
    K = assemble_structure(whole).stiffness.toarray()
    model = assemble_structure(apart)
    T = model.constraint
    assert T.shape == (48, 36)
    np.testing.assert_allclose((T.T @ model.stiffness @ T).toarray(), K, atol=1e-9 * np.abs(K).max())


def test_contradictions_are_refused():
    node = np.array([0.5, 0.5, 2.0])
    twice = brick_with(
        node, links=(RigidLink(8, np.array([4, 5, 6, 7]), name="a"), RigidLink(0, np.array([4]), name="b"))
    )
    with pytest.raises(
        InputError, match=r"node 5 at \(0, 0, 1\) m follows in two ways, by rigid link a and by rigid link b"
    ):
        assemble_structure(twice)
    weightless = Average(8, np.array([4, 5, 6, 7]), np.array([1.0, 1.0, 1.0, 0.0]), name="lug")
    with pytest.raises(InputError, match="average lug: weight 0; expected positive weights"):
        assemble_structure(brick_with(node, averages=(weightless,)))
    loop = brick_with(np.empty((0, 3)), ties=(Tie(1, 2, name="a"), Tie(2, 3, name="b"), Tie(3, 1, name="c")))
    with pytest.raises(InputError, match="follow themselves through tie a and tie b and tie c"):
        assemble_structure(loop)
    with pytest.raises(InputError, match=r"node 9 at .* is in no element and follows none"):
        assemble_structure(brick_with(node))
    # an inertia on a node of a solid turns freely
    turning = brick_with(node, ties=(Tie(0, 8),), masses=(PointMass(1, 1.0, inertia=np.eye(3)),))
    with pytest.raises(InputError, match=r"node 2 at .* turns freely"):
        assemble_structure(turning)
    with pytest.raises(InputError, match="'lumped', 'consistent'"):
        assemble_structure(replace(turning, masses=()), mass="row_sum")


@pytest.mark.parametrize("mass", ["lumped", "consistent"])
def test_solids_of_a_structure_are_those_of_a_mesh(mass):
    from heavylift.preprocess.finite_elements.elasticity import assemble
    from heavylift.preprocess.finite_elements.mesh import Mesh

    structure = Structure(BRICK * [1, 2, 3], solids=(Solids("s", np.arange(8)[None], "hex8", STEEL),))
    found = assemble_structure(structure, mass=mass)
    mesh = assemble(Mesh(structure.nodes, structure.solids[0].elements, "hex8"), STEEL, mass=mass)
    np.testing.assert_allclose(found.stiffness.toarray(), mesh.stiffness.toarray(), rtol=1e-12)
    np.testing.assert_allclose(found.mass.toarray(), mesh.full_mass().toarray(), rtol=1e-9, atol=1e-9)


def test_a_link_to_a_line_of_solid_nodes_turns_about_it_and_is_refused():
    """Along an axis of the structure the rotation is held and told; about an inclined line it is refused."""
    along = brick_with(np.array([0.5, 0.0, 1.0]), links=(RigidLink(8, np.array([4, 5])),))
    model = assemble_structure(along)
    assert model.fixed_dofs.tolist() == [27]
    assert model.notes[-1].startswith("1 rotations of 1 nodes are held")
    inclined = brick_with(np.array([0.5, 0.5, 1.0]), links=(RigidLink(8, np.array([4, 6])),))
    with pytest.raises(
        InputError, match=r"node 9 at \(0.5, 0.5, 1\) m: turns freely about the axis \(-?0.707, -?0.707, "
    ):
        assemble_structure(inclined)
    three = brick_with(np.array([0.5, 0.5, 1.0]), links=(RigidLink(8, np.array([4, 6, 7])),))
    assert assemble_structure(three).fixed_dofs.size == 0
