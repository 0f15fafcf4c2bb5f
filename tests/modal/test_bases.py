"""Static, interface and Krylov vectors: what each of them makes exact."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal.bases import (
    Basis,
    craig_bampton,
    eigenmode_basis,
    moment_matching,
    patch_loads,
    place_loads,
    point_loads,
    static_vectors,
)
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility, apply_mass, rigid_motions
from heavylift.modal.reduction import ritz_vectors
from heavylift.numerics.outcome import InputError


def corner(model, x, y, z):
    return int(np.argmin(np.sum((model.nodes - [x, y, z]) ** 2, axis=1)))


@pytest.fixture
def clamped(any_beam):
    return Flexibility(any_beam, any_beam.node_groups["clamp"])


def test_static_vectors_solve_the_static_problem(any_beam, clamped, dense):
    loads = point_loads(any_beam, [corner(any_beam, 1, 0.1, 0.06)], "zx")
    assert loads.labels[0].endswith(" z")
    basis = static_vectors(clamped, loads)
    matrices = dense(any_beam, any_beam.node_groups["clamp"])
    expected = np.linalg.solve(matrices.K_free, loads.forces[matrices.rows])
    np.testing.assert_allclose(basis.vectors[matrices.rows], expected, atol=1e-10 * np.abs(expected).max())


def test_patch_load_is_the_weighted_sum_of_point_loads(brick_beam):
    nodes = brick_beam.node_groups["tip"][:4]
    weights = [1.0, 2.0, 3.0, 2.0]
    patch = patch_loads(brick_beam, nodes, "y", weights=weights, name="pad")
    points = point_loads(brick_beam, nodes, "y")
    np.testing.assert_allclose(patch.forces[:, 0], points.forces @ weights / 8.0, rtol=1e-14)
    assert patch.labels == ("pad y",)


def test_inertia_relief_balances_a_free_body(any_beam):
    body = Flexibility(any_beam)
    loads = point_loads(any_beam, [corner(any_beam, 0.5, 0.1, 0.0)])
    u = static_vectors(body, loads).vectors
    residual = loads.forces - any_beam.stiffness @ u  # must be the inertia of a rigid acceleration
    motions = rigid_motions(any_beam.nodes)
    inertia = apply_mass(any_beam.mass, motions)
    rigid = inertia @ np.linalg.solve(motions.T @ inertia, motions.T @ loads.forces)
    np.testing.assert_allclose(residual, rigid, atol=1e-7)
    assert np.abs(inertia.T @ u).max() < 1e-12 * np.abs(u).max() * any_beam.total_mass


def test_moments_of_the_transfer_function_match(any_beam, clamped):
    # b^T (K - w2 M)^-1 b = sum_j w2^j b^T (K^-1 M)^j K^-1 b: the first 2 m terms are exact
    loads = point_loads(any_beam, [corner(any_beam, 1, 0.1, 0.06)], "yz")
    order = 3
    basis = moment_matching(clamped, loads, order)
    np.testing.assert_allclose(
        basis.vectors.T @ apply_mass(any_beam.mass, basis.vectors), np.eye(2 * order), atol=1e-12
    )
    ritz = ritz_vectors(
        any_beam, basis.vectors, basis.labels, fixed_nodes=any_beam.node_groups["clamp"], mean_axis=False
    )
    x = clamped.solve(loads.forces)
    participation = ritz.shapes.T @ loads.forces
    for j in range(2 * order + 1):
        full = loads.forces.T @ x
        reduced = (participation.T / ritz.eigenvalues ** (j + 1)) @ participation
        error = np.abs(reduced - full).max() / np.abs(full).max()
        if j < 2 * order:
            assert error < 1e-10
        x = clamped.solve(apply_mass(any_beam.mass, x))
    # not exact for the full model everywhere: the highest Ritz values are not eigenvalues
    assert ritz.residuals.max() > 1e-3


def test_krylov_space_ends_when_nothing_new_comes(brick_beam):
    body = Flexibility(brick_beam, brick_beam.node_groups["clamp"])
    mode = eigenmodes(brick_beam, 1, flexibility=body)
    from heavylift.modal.bases import Loads

    basis = moment_matching(body, Loads(apply_mass(brick_beam.mass, mode.shapes), ("mode",)), 2)
    # an eigenvector load spans its own Krylov space, up to the residual of the mode
    other = basis.vectors[:, 1:]
    assert abs(basis.vectors[:, 0] @ apply_mass(brick_beam.mass, mode.shapes[:, 0])) == pytest.approx(
        1.0, abs=1e-10
    )
    assert other.shape[1] <= 1


@pytest.mark.parametrize("count", [0, 4])
def test_craig_bampton_is_exact_for_statics_at_the_interface(any_beam, clamped, count):
    fixed = any_beam.node_groups["clamp"]
    interface = [corner(any_beam, 1, 0, 0), corner(any_beam, 1, 0.1, 0.06), corner(any_beam, 0.5, 0.1, 0)]
    basis = craig_bampton(any_beam, interface, count, fixed_nodes=fixed)
    assert len(basis.labels) == 9 + count
    ritz = ritz_vectors(any_beam, basis.vectors, basis.labels, fixed_nodes=fixed, mean_axis=False)
    loads = point_loads(any_beam, interface).forces
    full = clamped.solve(loads)
    reduced = ritz.shapes @ ((ritz.shapes.T @ loads) / ritz.eigenvalues[:, None])
    # at the interface, and so everywhere: the load acts on the interface only
    np.testing.assert_allclose(reduced, full, atol=1e-9 * np.abs(full).max())


def test_craig_bampton_frequencies_are_upper_bounds_that_converge(brick_beam):
    fixed = brick_beam.node_groups["clamp"]
    exact = eigenmodes(brick_beam, 4, fixed_nodes=fixed).eigenvalues
    interface = brick_beam.node_groups["tip"][:3]
    errors = []
    for count in (2, 20):
        basis = craig_bampton(brick_beam, interface, count, fixed_nodes=fixed)
        ritz = ritz_vectors(brick_beam, basis.vectors, basis.labels, fixed_nodes=fixed, mean_axis=False)
        errors.append(ritz.eigenvalues[:4] / exact - 1.0)
    assert np.all(np.array(errors) > -1e-10)
    assert np.all(errors[1] < 1e-3)
    assert errors[1].max() < 0.1 * errors[0].max()


def test_craig_bampton_of_a_free_body_loses_its_rigid_motions(any_beam):
    interface = [corner(any_beam, 0, 0, 0), corner(any_beam, 1, 0.1, 0.06), corner(any_beam, 0.5, 0.1, 0)]
    basis = craig_bampton(any_beam, interface, 10)
    for mean_axis in (False, True):
        ritz = ritz_vectors(any_beam, basis.vectors, basis.labels, mean_axis=mean_axis)
        assert len(ritz.eigenvalues) == 19 - 6
        assert len(ritz.dropped) == 6
        exact = eigenmodes(any_beam, 1).eigenvalues
        assert exact[0] * (1 - 1e-9) <= ritz.eigenvalues[0] < 1.01 * exact[0]


def test_selection_by_number(brick_beam):
    modes = eigenmodes(brick_beam, 6)
    basis = eigenmode_basis(modes, [5, 2])
    assert basis.labels == ("eigenmode 5", "eigenmode 2")
    assert np.array_equal(basis.vectors, modes.shapes[:, [4, 1]])
    assert eigenmode_basis(modes).labels[-1] == "eigenmode 6"
    for selection, message in (
        ([7], "mode 7; expected a number from 1 to 6"),
        ([0], "mode 0;"),
        ([1, 2, 1], "mode 1 twice"),
    ):
        with pytest.raises(InputError, match=message):
            eigenmode_basis(modes, selection)
    with pytest.raises(InputError, match="no mode"):
        eigenmode_basis(modes, [])


def test_bad_loads_and_interfaces_are_named(brick_beam):
    tip = brick_beam.node_groups["tip"]
    clamp = brick_beam.node_groups["clamp"]
    with pytest.raises(InputError, match="directions 'xu'"):
        point_loads(brick_beam, tip, "xu")
    with pytest.raises(InputError, match="node 123456 does not exist"):
        point_loads(brick_beam, [123456])
    with pytest.raises(InputError, match="a node appears twice"):
        point_loads(brick_beam, [3, 3])
    with pytest.raises(InputError, match="no node; expected at least one"):
        patch_loads(brick_beam, [])
    with pytest.raises(InputError, match=r"weights .*expected 2 finite numbers"):
        patch_loads(brick_beam, tip[:2], weights=[1.0, -1.0])
    with pytest.raises(InputError, match="order 0"):
        moment_matching(Flexibility(brick_beam, clamp), point_loads(brick_beam, tip[:1]), 0)
    with pytest.raises(InputError, match="is held and an interface node"):
        craig_bampton(brick_beam, clamp[:1], 2, fixed_nodes=clamp)
    with pytest.raises(InputError, match=r"leave 3 rigid motion\(s\)"):
        craig_bampton(brick_beam, tip[:1], 2)


def test_bases_add_up():
    total = Basis(np.ones((6, 2)), ("a", "b")) + Basis(np.zeros((6, 1)), ("c",))
    assert total.vectors.shape == (6, 3)
    assert total.labels == ("a", "b", "c")


def test_a_load_between_nodes_is_that_of_its_point(beam_of_any_faces):
    """Shares of every kind of element have the resultant of the force, and its moment about the origin."""
    model = beam_of_any_faces
    points = np.array([[0.333, 0.02, 0.03], [0.71, 0.1, 0.011], [1.0, 0.047, 0.06]])
    loads = place_loads(model, points)
    assert loads.forces.shape == (3 * model.node_count, 9)
    assert loads.labels[3] == "point (710, 100, 11) mm x"
    for column, force in enumerate(loads.forces.T.reshape(9, -1, 3)):
        point, axis = points[column // 3], np.eye(3)[column % 3]
        np.testing.assert_allclose(force.sum(axis=0), axis, atol=1e-12)
        np.testing.assert_allclose(
            np.cross(model.nodes, force).sum(axis=0), np.cross(point, axis), atol=1e-10
        )
    twice = place_loads(model, [points[0], points[0]], "z")
    assert twice.forces.shape[1] == 1
    with pytest.raises(InputError, match=r"points\.1: point \(500, 50, 90\) mm is not on the body"):
        place_loads(model, [points[0], [0.5, 0.05, 0.09]])
