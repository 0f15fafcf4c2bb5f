"""Standard input data against sums over the masses of a body that is deformed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.modal.bases import eigenmode_basis
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.reduced import Interface
from heavylift.modal.reduction import reduce_body
from heavylift.modal.standard_input import standard_input
from heavylift.modal.stiffening import Stiffening


@pytest.fixture(scope="module")
def body_and_masses(brick_beam):
    modes = eigenmodes(brick_beam, 5)
    basis = eigenmode_basis(modes)
    body = reduce_body(brick_beam, basis.vectors, basis.labels, mean_axis=True, origin=(0.2, -0.1, 0.3))
    return body, brick_beam.mass.diagonal()


def value(series, q):
    """Of a series at modal coordinates."""
    return series.m0 if series.m1 is None else series.m0 + np.einsum("rkc,k->rc", series.m1, q)


class Motion:
    """Some motion of the frame and the modes, and the inertia forces of all nodes."""

    def __init__(self, body, masses, scale):
        rng = np.random.default_rng(4)
        self.q, self.qd = (scale * rng.standard_normal(5) for _ in range(2))
        self.qdd = 1e-3 * rng.standard_normal(5)
        self.a, self.w, self.wd = rng.standard_normal((3, 3))
        self.positions = body.nodes + body.displacement(self.q)
        acceleration = (
            self.a
            + np.cross(self.wd, self.positions)
            + np.cross(self.w, np.cross(self.w, self.positions))
            + 2.0 * np.cross(self.w, body.displacement(self.qd))
            + body.displacement(self.qdd)
        )
        self.inertial = masses[:, None] * acceleration


def test_modal_and_total_forces_of_any_motion(body_and_masses):
    body, masses = body_and_masses
    data = standard_input(body, np.full(5, 0.02))
    moved = Motion(body, masses, 1e-3)
    a, w, wd = moved.a, moved.w, moved.wd
    squares = np.array([w[0] ** 2, w[1] ** 2, w[2] ** 2, w[0] * w[1], w[1] * w[2], w[0] * w[2]])
    modal = (
        value(data.Ct, moved.q) @ a
        + value(data.Cr, moved.q) @ wd
        + data.Me.m0 @ moved.qdd
        + np.einsum("ijc,j->ic", data.Ge.m0.reshape(5, 5, 3), moved.qd) @ w
        + value(data.Oe, moved.q) @ squares
    )
    np.testing.assert_allclose(modal, np.einsum("mak,ak->m", body.mode_shapes, moved.inertial), rtol=1e-9)
    first = value(data.mdCM, moved.q)[:, 0]
    force = (
        data.mass * a
        + np.cross(wd, first)
        + np.cross(w, np.cross(w, first))
        + 2.0 * np.cross(w, data.Ct.m0.T @ moved.qd)
        + data.Ct.m0.T @ moved.qdd
    )
    np.testing.assert_allclose(force, moved.inertial.sum(axis=0), rtol=1e-9)


def test_moments_of_any_motion_are_of_first_order(body_and_masses):
    body, masses = body_and_masses
    data = standard_input(body, np.full(5, 0.02))
    errors = []
    for scale in (1e-2, 1e-3):
        moved = Motion(body, masses, scale)
        w = moved.w
        J, first = value(data.J, moved.q), value(data.mdCM, moved.q)[:, 0]
        moment = np.cross(first, moved.a) + J @ moved.wd + np.cross(w, J @ w)
        moment += value(data.Cr, moved.q).T @ moved.qdd
        moment += np.einsum("cjd,j->cd", data.Gr.m0.reshape(3, 5, 3), moved.qd) @ w
        exact = np.cross(moved.positions, moved.inertial).sum(axis=0)
        errors.append(np.abs(moment - exact).max() / np.abs(exact).max())
    assert errors[1] < 1e-6
    assert errors[0] / errors[1] == pytest.approx(100.0, rel=0.05)


def test_stiffness_and_damping_are_modal(body_and_masses):
    body, _ = body_and_masses
    data = standard_input(body, np.full(5, 0.02))
    np.testing.assert_allclose(np.diag(data.Ke.m0), body.eigenvalues)
    np.testing.assert_allclose(np.diag(data.De.m0), 0.04 * np.sqrt(body.eigenvalues))


def test_nodes_move_and_turn_with_the_modes(body_and_masses):
    body, _ = body_and_masses
    data = standard_input(body, np.zeros(5))
    assert len(data.nodes) == body.node_count
    q = 1e-3 * np.arange(5)
    for node in (0, 17):
        place = value(data.nodes[node].origin, q)[:, 0]
        np.testing.assert_allclose(place, body.nodes[node] + body.displacement(q)[node])
        turn = data.nodes[node].psi.m0 @ q
        axes = value(data.nodes[node].orientation, q)
        np.testing.assert_allclose(axes, np.eye(3) + np.cross(turn, np.eye(3)).T, atol=1e-12)


def test_geometric_stiffness_is_part_of_the_series(body_and_masses):
    """Modal forces of accelerations, of spin and of loads at an interface change by stiffness times coordinates."""
    body, _ = body_and_masses
    rng = np.random.default_rng(9)

    def symmetric(*shape):
        found = rng.standard_normal((*shape, 5, 5))
        return found + np.swapaxes(found, -1, -2)

    stiffening = Stiffening(
        symmetric(6),
        symmetric(3),
        symmetric(3),
        labels=("LUG force y", "LUG moment z", "point x"),
        loads=symmetric(3),
    )
    lug = Interface(
        np.ones(3), *rng.standard_normal((2, 5, 3)), np.array([0]), np.zeros((1, 3, 6)), np.zeros((1, 3, 6))
    )
    plain = standard_input(replace(body, interfaces={"LUG": lug}), np.zeros(5))
    data = standard_input(replace(body, interfaces={"LUG": lug}, stiffening=stiffening), np.zeros(5))
    assert data.geometric
    assert not plain.geometric
    q, a, w, wd, force, moment = (
        rng.standard_normal(5),
        *rng.standard_normal((5, 3)),
    )
    squares = np.array([w[0] ** 2, w[1] ** 2, w[2] ** 2, w[0] * w[1], w[1] * w[2], w[0] * w[2]])
    for key, by, stiffness in (
        ("Ct", a, np.tensordot(a, stiffening.linear, axes=1)),
        ("Cr", wd, np.tensordot(wd, stiffening.angular, axes=1)),
        ("Oe", squares, stiffening.of_spin(w)),
    ):
        change = (value(getattr(data, key), q) - value(getattr(plain, key), q)) @ by
        np.testing.assert_allclose(change, stiffness @ q, err_msg=key)
    acting = value(data.nodes[0].phi, q).T @ force + value(data.nodes[0].psi, q).T @ moment
    before = plain.nodes[0].phi.m0.T @ force + plain.nodes[0].psi.m0.T @ moment
    by_loads = force[1] * stiffening.loads[0] + moment[2] * stiffening.loads[1]
    np.testing.assert_allclose(acting - before, -by_loads @ q)
