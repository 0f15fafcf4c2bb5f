"""Models whose nodes have rotations, follow others, and carry masses beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array, lil_array

from heavylift.modal.bases import Loads, craig_bampton, eigenmode_basis, static_vectors
from heavylift.modal.constraints import free_dofs
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility, apply_mass, rigid_motions
from heavylift.modal.reduction import reduce_body
from heavylift.modal.statics import solve_static
from heavylift.numerics.outcome import InputError

LENGTH, SIDE, YOUNG, DENSITY = 2.0, 0.05, 2.1e11, 7850.0
SECOND = SIDE**4 / 12.0
SPEED = np.sqrt(YOUNG * SECOND / (DENSITY * SIDE**2)) / LENGTH**2 / (2.0 * np.pi)  # Hz: of (beta L)^2 = 1


def led(model, rows):
    """The model with rows of its constraint: dof -> {dof: factor}."""
    free = np.setdiff1d(np.arange(model.dof_count), list(rows))
    column = {int(dof): j for j, dof in enumerate(free)}
    T = lil_array((model.dof_count, len(free)))
    T[free, np.arange(len(free))] = 1.0
    for dof, factors in rows.items():
        for other, factor in factors.items():
            T[dof, column[other]] = factor
    return replace(model, constraint=csr_array(T))


def rigid_rows(model, node, followers):
    """Rows of nodes that follow another rigidly (RBE2)."""
    rows = {}
    n = model.node_count
    for other in followers:
        arm = model.nodes[other] - model.nodes[node]
        turned = np.cross(np.eye(3), arm)  # row k: e_k x arm
        for k in range(3):
            rows[3 * other + k] = {3 * node + k: 1.0} | {
                3 * (n + node) + axis: turned[axis, k] for axis in range(3) if turned[axis, k]
            }
            rows[3 * (n + other) + k] = {3 * (n + node) + k: 1.0}
    return rows


@pytest.mark.parametrize("count", [40, 90])  # dense and iterative
def test_beam_with_massless_rotations_meets_bernoulli(beam_chain, count):
    # a mass off the axis by next to nothing: without it nothing resists the roll of the free beam
    model = beam_chain(count, extra=[(0, 1e-6, (0.0, 0.1, 0.0))])
    clamped = eigenmodes(model, 6, fixed_nodes=[0])
    free = eigenmodes(model, 6)
    assert (clamped.backend == "dense") == (count == 40)
    assert free.rigid_count == 6
    for modes, roots in ((clamped, (1.875104, 4.694091, 7.854757)), (free, (4.730041, 7.853205, 10.995608))):
        expected = np.repeat(np.square(roots), 2) * SPEED
        # lumped masses: the error is of second order in the length of the elements
        np.testing.assert_allclose(modes.frequencies, expected, rtol=5e-3 * (40 / count) ** 2)
    motions = rigid_motions(model.nodes, model.rotating)
    momentum = motions.T @ apply_mass(model.mass, free.shapes)
    assert np.abs(momentum).max() < 1e-9


def test_rigid_motions_of_all_degrees_of_freedom_store_no_energy(beam_chain):
    model = beam_chain(10, rotary=True)
    motions = rigid_motions(model.nodes, model.rotating)
    forces = model.stiffness @ motions
    assert np.abs(forces).max() < 1e-9 * model.stiffness.diagonal().max()


def test_static_tip_loads_meet_closed_form(beam_chain):
    model = replace(beam_chain(8), fixed_nodes=np.array([0]))
    body = Flexibility(model)
    n, tip = model.node_count, model.node_count - 1
    force, moment = 800.0, 300.0
    loads = np.zeros(model.dof_count)
    loads[3 * tip + 2] = force
    loads[3 * (n + tip) + 1] = moment  # about y: turns x towards -z
    state = solve_static(body, loads, "tip")
    stiffness = YOUNG * SECOND
    deflection = force * LENGTH**3 / (3 * stiffness) - moment * LENGTH**2 / (2 * stiffness)
    turn = -force * LENGTH**2 / (2 * stiffness) + moment * LENGTH / stiffness
    assert state.displacements[tip, 2] == pytest.approx(deflection, rel=1e-9)
    assert state.rotations[tip, 1] == pytest.approx(turn, rel=1e-9)
    np.testing.assert_allclose(state.reaction, [0.0, 0.0, -force], atol=1e-8 * force)


def test_node_on_a_rigid_link_is_a_mass_beside_its_node(beam_chain):
    """A point of mass on a link against the same mass given as an offset of the node."""
    offset = np.array([0.02, 0.05, 0.3])
    direct = beam_chain(12, rotary=True, extra=[(12, 15.0, offset)])
    carried = beam_chain(13, rotary=True)  # one more node, which is moved to the mass
    plain = beam_chain(12, rotary=True)
    n = carried.node_count
    keep = np.r_[0 : 3 * (n - 1), 3 * n : 6 * n - 3]
    K = lil_array((6 * n, 6 * n))
    K[np.ix_(keep, keep)] = plain.stiffness.toarray()
    nodes = np.vstack([plain.nodes, plain.nodes[12] + offset])
    B = lil_array((3 * len(plain.points.masses) + 3, 6 * n))
    B[: 3 * len(plain.points.masses), keep] = plain.points.operator.toarray()
    B[-3:, 3 * (n - 1) : 3 * n] = np.eye(3)
    points = replace(
        plain.points,
        positions=np.vstack([plain.points.positions, nodes[-1]]),
        masses=np.append(plain.points.masses, 15.0),
        operator=csr_array(B),
    )
    linked = replace(carried, nodes=nodes, stiffness=csr_array(K), mass=points.matrix(), points=points)
    linked = led(linked, rigid_rows(linked, 12, [13]))
    for fixed in ([], [0]):
        one, other = (eigenmodes(model, 8, fixed_nodes=fixed) for model in (direct, linked))
        np.testing.assert_allclose(other.eigenvalues, one.eigenvalues, rtol=1e-9)
    bodies = [
        reduce_body(model, modes.shapes, [f"{k}" for k in range(8)], fixed_nodes=[0], mean_axis=False)
        for model, modes in ((direct, one), (linked, other))
    ]
    assert bodies[1].residuals.max() < 1e-7
    for key in ("mass", "first_moment", "inertia_kl"):
        np.testing.assert_allclose(
            getattr(bodies[1].integrals, key), getattr(bodies[0].integrals, key), rtol=1e-12, atol=1e-12
        )
    tip = bodies[1].mode_shapes[:, 13] - bodies[1].mode_shapes[:, 12]
    np.testing.assert_allclose(np.cross(bodies[1].mode_rotations[:, 12], offset), tip, atol=1e-12)


def test_shape_integrals_hold_rotary_inertia(beam_chain):
    model = beam_chain(20, rotary=True, extra=[(7, 12.0, (0.0, 0.1, -0.2))])
    modes = eigenmodes(model, 10)
    body = reduce_body(model, modes.shapes, [f"{k}" for k in range(10)], mean_axis=True, origin=(0.3, 0, 0))
    # kinetic energy of the modes is the sum over points, rotations included
    np.testing.assert_allclose(np.einsum("kkij->ij", body.integrals.mode_mode), np.eye(10), atol=1e-12)
    piece = DENSITY * SIDE**2 * LENGTH
    across = piece * SIDE**2 / 12.0
    assert body.integrals.mass == pytest.approx(piece + 12.0, rel=1e-12)
    assert body.integrals.inertia_kl[1, 1] == pytest.approx(across + 12.0 * 0.1**2, rel=1e-12)
    assert body.integrals.inertia_kl[1, 2] == pytest.approx(-12.0 * 0.1 * 0.2, rel=1e-12)
    x_mass = 7 * LENGTH / 20 - 0.3
    assert body.integrals.first_moment[0] == pytest.approx(piece * 0.7 + 12.0 * x_mass, rel=1e-12)
    np.testing.assert_allclose(body.integrals.modal_translation, 0.0, atol=1e-10)
    skew = body.integrals.position_mode - body.integrals.position_mode.transpose(1, 0, 2)
    np.testing.assert_allclose(skew, 0.0, atol=1e-10)


def test_held_node_that_follows_is_a_condition_on_those_it_follows(beam_chain):
    """Mean of two nodes held: the reaction is the multiplier of the condition."""
    model = beam_chain(6)
    n = model.node_count
    average = {3 * 3 + 2: {3 * 2 + 2: 0.5, 3 * 5 + 2: 0.5}}  # w of node 3 follows nodes 2 and 5
    averaged = led(model, average)
    held = replace(averaged, fixed_nodes=np.array([0]), fixed_dofs=np.array([3 * 3 + 2]))
    loads = np.zeros(model.dof_count)
    loads[3 * 6 + 2] = 100.0
    u = Flexibility(held).solve(loads)
    # the same by Lagrange multipliers on the full matrices
    K = model.stiffness.toarray()
    conditions = np.zeros((8, model.dof_count))
    for row, dof in enumerate([*range(3), *range(3 * n, 3 * n + 3), 3 * 3 + 2]):
        conditions[row, dof] = 1.0
    conditions[7, [3 * 2 + 2, 3 * 5 + 2]] = 0.5
    saddle = np.block([[K, conditions.T], [conditions, np.zeros((8, 8))]])
    expected = np.linalg.solve(saddle, np.append(loads, np.zeros(8)))[: model.dof_count]
    np.testing.assert_allclose(u, expected, atol=1e-9 * np.abs(expected).max())
    assert len(free_dofs(held, held.fixed_dofs).unknowns) == model.dof_count - 2


def test_tied_nodes_at_a_distance_do_not_turn_with_the_body(beam_chain):
    model = beam_chain(6, rotary=True)
    tie = {3 * 6 + 2: {3 * 2 + 2: 1.0}}
    assert Flexibility(led(model, tie)).rigid_count == 5  # it cannot turn about y


def test_craig_bampton_with_rotations_is_exact_for_interface_loads(beam_chain):
    model = beam_chain(12, rotary=True)
    basis = craig_bampton(model, [12, 6], 4, fixed_nodes=[0])
    assert basis.labels[3] == "interface node 12 x"
    assert basis.labels[6] == "interface node 6 turn x"
    body = reduce_body(model, basis.vectors, basis.labels, fixed_nodes=[0], mean_axis=False)
    assert body.mode_count == 12 + 4
    tip = body.mode_rotations[:, 12, 1]
    assert tip @ (tip / body.eigenvalues) == pytest.approx(LENGTH / (YOUNG * SECOND), rel=1e-9)
    free = craig_bampton(model, [0, 12], 4)
    body = reduce_body(model, free.vectors, free.labels, mean_axis=True)
    assert body.mode_count == 12 + 4 - 6


def test_interface_node_that_follows_is_refused(beam_chain):
    model = beam_chain(6)
    model = led(model, rigid_rows(model, 3, [4]))
    with pytest.raises(InputError, match="node 4 follows others and is an interface node"):
        craig_bampton(model, [0, 4], 2)


def test_reduced_statics_of_moments(beam_chain):
    model = beam_chain(10)
    body = Flexibility(model, [0])
    load = np.zeros((model.dof_count, 1))
    load[-1] = 1.0
    basis = eigenmode_basis(eigenmodes(model, 2, flexibility=body)) + static_vectors(
        body, Loads(load, ("moment",))
    )
    reduced = reduce_body(model, basis.vectors, basis.labels, fixed_nodes=[0], mean_axis=False)
    turn = reduced.mode_rotations[:, 10, 2]
    assert turn @ (turn / reduced.eigenvalues) == pytest.approx(LENGTH / (YOUNG * SECOND), rel=1e-9)


def test_rotations_without_mass_points_are_refused(beam_chain):
    model = beam_chain(4)
    with pytest.raises(InputError, match="5 nodes with rotations and a scalar mass matrix"):
        replace(model, points=None)
