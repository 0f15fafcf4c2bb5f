"""Mass matrix and velocity forces of one body against sums over its points."""

from __future__ import annotations

import numpy as np
import pytest
from point_masses import Cloud, System, make_cloud
from scenarios import start_of

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.floating_frame.inertia import (
    body_momenta,
    deformed_inertia,
    frame_velocity_forces,
    frame_velocity_from_momenta,
    quadratic_modal_force,
    stacked_products,
)
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies, product_columns, shape_of
from heavylift.solver.layout import pack_scene


@kernel
def inertia(kind, q, products, rate_products, qd, frame, I_tf):
    """Products of both vectors, then the inertia of the deformed body."""
    stacked_products(product_columns(kind, 0), q, qd, products, rate_products)
    deformed_inertia(shape_of(kind, 0), q, products, frame, I_tf)


@kernel
def velocity_forces(kind, q, products, rate_products, qd, frame, w, modal):
    """Velocity forces of the modal rows and of the frame rows."""
    shape = shape_of(kind, 0)
    quadratic_modal_force(shape, q, products, rate_products, (w[0], w[1], w[2]), modal)
    return frame_velocity_forces(shape, q, products, frame, (w[0], w[1], w[2]), qd)


@kernel
def momenta(kind, frame, I_tf, v, w, qd):
    """Momenta in body axes."""
    return body_momenta(shape_of(kind, 0), frame, I_tf, (v[0], v[1], v[2]), (w[0], w[1], w[2]), qd)


@kernel
def velocities(kind, frame, I_tf, p, l, qd):
    """Frame velocities from the momenta."""
    return frame_velocity_from_momenta(
        shape_of(kind, 0), frame, I_tf, (p[0], p[1], p[2]), (l[0], l[1], l[2]), qd
    )


class Body:
    """A cloud in body axes at a random state, and the same in the arrays of the kind."""

    def __init__(self, modes: int, rigid_part: float) -> None:
        self.cloud: Cloud = make_cloud(modes=modes, seed=30 + modes, rigid_part=rigid_part)
        layout = pack_scene(System(self.cloud, start_of(1, modes)).scene())
        self.kind: FloatingFrameBodies = layout.bodies[0]
        rng = np.random.default_rng(modes)
        self.q, self.qd = 0.1 * rng.normal(size=modes), rng.normal(size=modes)
        self.v, self.w = rng.normal(size=3), 5.0 * rng.normal(size=3)
        rows = len(self.kind.position_products)
        self.products, self.rate_products = np.empty(rows), np.empty(rows)
        self.frame, self.I_tf = self.kind.frame[0], np.empty((3, modes))
        inertia(self.kind, self.q, self.products, self.rate_products, self.qd, self.frame, self.I_tf)

    @property
    def mass_matrix(self) -> np.ndarray:
        """By sums over the points."""
        return self.cloud.mass_matrix(np.eye(3), self.q)


@pytest.fixture(params=[(0, 0.0), (1, 1.0), (3, 1.0), (4, 0.0), (7, 1.0), (12, 1.0)], ids=str)
def body(request: pytest.FixtureRequest) -> Body:
    return Body(*request.param)


def test_mass_matrix_of_the_deformed_body(body: Body) -> None:
    M = body.mass_matrix
    s, i = body.frame.first_moment, body.frame.inertia
    S_tilde = np.array([[0.0, -s[2], s[1]], [s[2], 0.0, -s[0]], [-s[1], s[0], 0.0]])
    np.testing.assert_allclose(M[:3, 3:6], -S_tilde, atol=1e-12)
    I_tt = np.array([[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]])
    np.testing.assert_allclose(M[3:6, 3:6], I_tt, atol=1e-12)
    np.testing.assert_allclose(M[3:6, 6:], body.I_tf, atol=1e-12)
    np.testing.assert_allclose(M[6:, 6:], np.eye(len(body.q)), atol=1e-12)


def test_momenta_and_back(body: Body) -> None:
    expected = body.mass_matrix[:6] @ np.concatenate([body.v, body.w, body.qd])
    p, l = momenta(body.kind, body.frame, body.I_tf, body.v, body.w, body.qd)
    np.testing.assert_allclose(np.concatenate([p, l]), expected, rtol=1e-12, atol=1e-12)
    v, w = velocities(body.kind, body.frame, body.I_tf, np.array(p), np.array(l), body.qd)
    np.testing.assert_allclose(v, body.v, rtol=1e-9)
    np.testing.assert_allclose(w, body.w, rtol=1e-9)


def test_velocity_forces(body: Body) -> None:
    """``-sum_j m_j J_j^T (quadratic acceleration of j)``, in body axes."""
    accelerations = body.cloud.quadratic_accelerations(np.eye(3), body.w, body.q, body.qd)
    J = body.cloud.jacobians(np.eye(3), body.q)
    expected = -np.einsum("j,jai,ja->i", body.cloud.masses, J, accelerations)
    modal = np.empty(len(body.q))
    force, moment = velocity_forces(
        body.kind, body.q, body.products, body.rate_products, body.qd, body.frame, body.w, modal
    )
    np.testing.assert_allclose(np.concatenate([force, moment, modal]), expected, rtol=1e-11, atol=1e-11)
