"""Shell elements: forces are gradients, rigid motion costs nothing, patch tests, against the oracle in NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from shell_oracle import Element
from shell_scenes import (
    STEEL,
    add_both,
    add_forces,
    add_rates,
    distorted_element,
    drift,
    element,
    energy,
    find,
    follow,
    pack,
    put,
    rotation,
    shell,
    stiffness,
    taken,
)

from heavylift.solver.bodies.ancf.kind import ShellMeshes
from heavylift.solver.bodies.ancf.shell_packing import (
    element_data,
    shape_values,
    start_coordinates,
)
from heavylift.solver.scene.mesh_shapes import ShellMesh, grid, quadrilateral, rectangle

if TYPE_CHECKING:
    from collections.abc import Callable

    from heavylift.solver.scene.meshes import ShellBody


def one_rectangle(**more: object) -> ShellBody:
    return shell(rectangle(1.3, 0.8, 1, 1), **more)


BODIES = {"rectangle": one_rectangle, "distorted": distorted_element}


@pytest.fixture(params=list(BODIES))
def body(request: pytest.FixtureRequest) -> ShellBody:
    return BODIES[request.param]()


def deformed(body: ShellBody, amount: float = 0.3, seed: int = 1) -> np.ndarray:
    start = start_coordinates(body)
    return start + amount * np.random.default_rng(seed).normal(size=start.shape)


def energy_at(kind: ShellMeshes, coordinates: np.ndarray) -> float:
    put(kind.trial_position, coordinates)
    find(kind, 0, kind.trial_position, kind.stage_strain)
    kind.body[0].elastic_energy = 0.0
    energy(kind, 0, kind.stage_strain)
    return float(kind.body[0].elastic_energy)


def forces_at(kind: ShellMeshes, coordinates: np.ndarray) -> np.ndarray:
    put(kind.trial_position, coordinates)
    find(kind, 0, kind.trial_position, kind.stage_strain)
    kind.external_force[:] = 0.0
    add_forces(kind, 0, kind.trial_position, kind.stage_strain, kind.external_force, 1.0)
    return taken(kind.external_force)


def tangent_at(kind: ShellMeshes, coordinates: np.ndarray, geometric: float = 1.0) -> np.ndarray:
    put(kind.trial_position, coordinates)
    find(kind, 0, kind.trial_position, kind.stage_strain)
    kind.blocks[:] = 0.0
    add_both(kind, 0, kind.trial_position, kind.stage_strain, kind.external_force, 1.0, 1.0, geometric)
    return stiffness(kind)


def difference(
    function: Callable[[np.ndarray], Any], coordinates: np.ndarray, direction: np.ndarray, h: float = 1e-2
) -> Any:
    """Central difference of a polynomial of degree 4 at most along a direction; exact but for rounding."""
    one = (function(coordinates + h * direction) - function(coordinates - h * direction)) / (2.0 * h)
    two = (function(coordinates + 2 * h * direction) - function(coordinates - 2 * h * direction)) / (4.0 * h)
    return (4.0 * one - two) / 3.0


def test_forces_are_the_gradient_of_the_energy(body: ShellBody) -> None:
    kind, q = pack([body]), deformed(body)
    forces = forces_at(kind, q)
    rng = np.random.default_rng(2)
    for _ in range(10):
        v = rng.normal(size=q.shape)
        expected = difference(lambda x: energy_at(kind, x), q, v)
        assert np.sum(forces * v) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("gauss_points", [3, 5, 7])
def test_the_stiffness_is_the_derivative_of_the_forces(gauss_points: int) -> None:
    body = distorted_element(gauss_points=gauss_points)
    kind, q = pack([body], swaps=4), deformed(body)
    tangent = tangent_at(kind, q)
    np.testing.assert_allclose(tangent, tangent.T, atol=1e-12 * np.abs(tangent).max())
    rng = np.random.default_rng(3)
    for _ in range(5):
        v = rng.normal(size=q.shape)
        expected = difference(lambda x: forces_at(kind, x), q, v).ravel()
        np.testing.assert_allclose(
            tangent @ v.ravel(), expected, rtol=0.0, atol=1e-9 * np.abs(expected).max()
        )


def test_without_its_geometric_part_the_stiffness_is_that_of_the_strains(body: ShellBody) -> None:
    # e^T D e/2 of the rates e = B v is v^T B^T D B v/2
    kind, q = pack([body]), deformed(body)
    material = tangent_at(kind, q, geometric=0.0)
    v = np.random.default_rng(4).normal(size=q.shape)
    put(kind.velocity, v)
    kind.strain[:] = 0.0
    add_rates(kind, 0, kind.trial_position, kind.velocity, kind.strain, 2.0)
    kind.body[0].elastic_energy = 0.0
    energy(kind, 0, kind.strain)
    assert 0.5 * v.ravel() @ material @ v.ravel() == pytest.approx(
        kind.body[0].elastic_energy / 4.0, rel=1e-12
    )


def test_the_geometric_part_belongs_to_the_given_strains(body: ShellBody) -> None:
    # forces of given strains are linear in q through B; their derivative is the geometric part alone
    kind, q = pack([body]), deformed(body)
    kind.strain[:] = np.random.default_rng(5).normal(size=kind.strain.shape[0])
    kind.strain.reshape(-1, 8)[:, body.gauss_points :] = 0.0

    def forces(x: np.ndarray) -> np.ndarray:
        put(kind.trial_position, x)
        kind.external_force[:] = 0.0
        add_forces(kind, 0, kind.trial_position, kind.strain, kind.external_force, 1.0)
        return taken(kind.external_force).ravel()

    v = np.random.default_rng(6).normal(size=q.shape)
    put(kind.trial_position, q)
    parts = []
    for geometric in (0.0, 1.0):
        kind.blocks[:] = 0.0
        add_both(kind, 0, kind.trial_position, kind.strain, kind.external_force, 1.0, 0.25, geometric)
        parts.append(stiffness(kind))
    expected = (forces(q + v) - forces(q - v)) / 2.0
    np.testing.assert_allclose(
        4.0 * (parts[1] - parts[0]) @ v.ravel(), expected, atol=1e-10 * np.abs(expected).max()
    )


def test_strain_rates_are_derivatives_of_strains(body: ShellBody) -> None:
    kind, q = pack([body]), deformed(body)
    v = np.random.default_rng(7).normal(size=q.shape)

    def strains(x: np.ndarray) -> np.ndarray:
        put(kind.trial_position, x)
        find(kind, 0, kind.trial_position, kind.stage_strain)
        return kind.stage_strain.copy()

    expected = (strains(q + v) - strains(q - v)) / 2.0  # exact: strains are quadratic
    put(kind.trial_position, q)
    put(kind.velocity, v)
    kind.strain[:] = 1.0
    add_rates(kind, 0, kind.trial_position, kind.velocity, kind.strain, 0.5)
    np.testing.assert_allclose(kind.strain - 1.0, 0.5 * expected, atol=1e-13 * np.abs(expected).max())


def test_both_in_one_pass_adds_the_same_forces(body: ShellBody) -> None:
    kind, q = pack([body]), deformed(body)
    forces = forces_at(kind, q)
    kind.external_force[:] = 0.0
    add_both(kind, 0, kind.trial_position, kind.stage_strain, kind.external_force, -3.0, 1.0, 1.0)
    np.testing.assert_allclose(taken(kind.external_force), -3.0 * forces, rtol=1e-13)


@pytest.mark.slow
def test_kernels_agree_with_the_oracle(body: ShellBody) -> None:
    kind, q, oracle = pack([body], swaps=2), deformed(body), Element(body, 0)
    own = body.elements[0]
    assert energy_at(kind, q) == pytest.approx(oracle.energy(q[own]).real, rel=1e-13)
    expected = oracle.forces(q[own])
    np.testing.assert_allclose(forces_at(kind, q)[own].ravel(), expected, atol=1e-12 * np.abs(expected).max())
    tangent = tangent_at(kind, q).reshape(4, 12, 4, 12)[own][:, :, own].reshape(48, 48)
    expected = oracle.tangent(q[own])
    np.testing.assert_allclose(tangent, expected, atol=1e-11 * np.abs(expected).max())


def bending_forces(body: ShellBody, coordinates: np.ndarray) -> np.ndarray:
    out = np.zeros_like(coordinates)
    for data, own in zip(element_data(body), body.elements, strict=True):
        K = data[256:512].reshape(16, 16)
        out[own] += (K @ coordinates[own].reshape(16, 3)).reshape(4, 4, 3)
    return out


def test_rigid_motion_neither_strains_nor_bends(body: ShellBody) -> None:
    kind = pack([body])
    moved = start_coordinates(body) @ rotation().T
    moved[:, 0] += [5.0, -7.0, 2.0]
    put(kind.trial_position, moved)
    find(kind, 0, kind.trial_position, kind.stage_strain)
    assert np.abs(kind.stage_strain).max() < 1e-14
    scale = np.abs(element_data(body)[0][256:512]).max()
    assert np.abs(bending_forces(body, moved)).max() < 1e-13 * scale


def test_a_free_element_has_six_motions_without_energy(body: ShellBody) -> None:
    kind, start = pack([body]), start_coordinates(body)
    K = tangent_at(kind, start)
    for data, own in zip(element_data(body), body.elements, strict=True):
        scalar = data[256:512].reshape(16, 16)
        full = np.kron(scalar, np.eye(3))
        places = (12 * own[:, np.newaxis] + np.arange(12)).ravel()
        K[np.ix_(places, places)] += full
    # in units of the mass, so that all coordinates count alike
    mass = np.kron(element_data(body)[0][:256].reshape(16, 16), np.eye(3))
    places = (12 * body.elements[0][:, np.newaxis] + np.arange(12)).ravel()
    factor = np.linalg.inv(np.linalg.cholesky(mass))
    values = np.linalg.eigvalsh(factor @ K[np.ix_(places, places)] @ factor.T)
    assert np.all(np.abs(values[:6]) < 1e-11 * values[-1])
    assert values[6] > 1e-7 * values[-1]


def wavy_mesh() -> ShellMesh:
    """3 x 3 elements between curved lines, all of different shape."""
    rng = np.random.default_rng(9)
    points = np.zeros((4, 4, 3))
    points[..., :2] = np.stack(
        np.meshgrid(np.linspace(0, 1.5, 4), np.linspace(0, 1.2, 4), indexing="ij"), axis=-1
    )
    points[..., :2] += 0.06 * rng.normal(size=(4, 4, 2))
    return grid(points)


def test_constant_membrane_strain_keeps_a_distorted_mesh_in_equilibrium() -> None:
    body = shell(wavy_mesh(), gauss_points=7)
    kind, start = pack([body]), start_coordinates(body)
    stretch = np.array([[1.02, 0.015, 0.0], [0.005, 0.98, 0.0], [0.0, 0.0, 1.0]])
    turn = rotation()
    forces = forces_at(kind, start @ (turn @ stretch).T)
    on_edge = np.zeros(len(body.nodes), dtype=bool)
    for nodes in wavy_mesh().edges.values():
        on_edge[nodes] = True
    assert on_edge.sum() == 12
    assert np.abs(forces[~on_edge]).max() < 1e-6 * np.abs(forces[on_edge]).max()  # 7 points: nearly exact
    # the energy of the whole is that of the constant strain
    E = 0.5 * (stretch.T @ stretch - np.eye(3))[:2, :2]
    C = STEEL.youngs_modulus / (1.0 - 0.3**2)
    density = 0.5 * C * (E[0, 0] ** 2 + E[1, 1] ** 2 + 0.6 * E[0, 0] * E[1, 1] + 1.4 * E[0, 1] ** 2)
    area = sum(element_data(body)[e][:256].reshape(16, 16)[::4, ::4].sum() for e in range(9)) / 78.5
    assert energy_at(kind, start @ stretch.T) == pytest.approx(density * area * STEEL.thickness, rel=1e-8)


def test_constant_curvature_keeps_a_rectangular_mesh_in_equilibrium() -> None:
    mesh = rectangle(1.5, 1.2, 3, 3)
    body = shell(mesh)
    x, y = mesh.nodes[:, 0], mesh.nodes[:, 1]
    kxx, kyy, kxy = 0.3, -0.2, 0.5
    w = start_coordinates(body)
    w[:, 0, 2] = 0.5 * kxx * x**2 + 0.5 * kyy * y**2 + kxy * x * y
    w[:, 1, 2], w[:, 2, 2], w[:, 3, 2] = kxx * x + kxy * y, kyy * y + kxy * x, kxy
    forces = bending_forces(body, w)[..., 2]
    inner = np.setdiff1d(np.arange(16), np.concatenate(list(mesh.edges.values())))
    assert len(inner) == 4
    assert np.abs(forces[inner]).max() < 1e-11 * np.abs(forces).max()
    D = STEEL.youngs_modulus * STEEL.thickness**3 / (12.0 * (1.0 - 0.09))
    density = 0.5 * D * (kxx**2 + kyy**2 + 0.6 * kxx * kyy + 1.4 * kxy**2)
    assert 0.5 * np.sum(forces * w[..., 2]) == pytest.approx(density * 1.8, rel=1e-11)


def test_constant_curvature_is_right_on_distorted_elements_too() -> None:
    # moving the element along its normal by a quadratic field, whose derivatives by lengths of the mesh follow from
    # the chain rule; the field is in the shape functions only where lines are straight, as here
    mesh = quadrilateral([[0, 0, 0], [1.4, 0.1, 0], [1.2, 0.9, 0], [-0.2, 0.7, 0]], 2, 2)
    body = shell(mesh)
    H = np.array([[0.3, 0.5], [0.5, -0.2]])
    X = start_coordinates(body)[..., :2]
    q = start_coordinates(body)
    q[:, 0, 2] = 0.5 * np.einsum("ni,ij,nj->n", X[:, 0], H, X[:, 0])
    q[:, 1, 2] = np.einsum("ni,ij,nj->n", X[:, 1], H, X[:, 0])
    q[:, 2, 2] = np.einsum("ni,ij,nj->n", X[:, 2], H, X[:, 0])
    q[:, 3, 2] = np.einsum("ni,ij,nj->n", X[:, 3], H, X[:, 0]) + np.einsum("ni,ij,nj->n", X[:, 1], H, X[:, 2])
    forces = bending_forces(body, q)[..., 2]
    D = STEEL.youngs_modulus * STEEL.thickness**3 / (12.0 * (1.0 - 0.09))
    density = 0.5 * D * (H[0, 0] ** 2 + H[1, 1] ** 2 + 0.6 * H[0, 0] * H[1, 1] + 1.4 * H[0, 1] ** 2)
    (x, y) = mesh.nodes[mesh.corners, :2].T
    area = 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1)))
    assert 0.5 * np.sum(forces * q[..., 2]) == pytest.approx(density * area, rel=1e-10)


def test_the_resultant_of_pressure_is_that_of_the_present_boundary(body: ShellBody) -> None:
    # the resultant of a pressure is p times the vector area, which by Stokes' theorem needs the boundary only
    kind, q = pack([body]), deformed(body, 0.1)
    put(kind.trial_position, q)
    kind.external_force[:] = 0.0
    pressure = kind.constants[0]  # any number of the constants
    follow(kind, 0, kind.trial_position, 0, kind.external_force, 0, 3.0)
    got = taken(kind.external_force)[:, 0].sum(axis=0)
    own, (a, b) = q[body.elements[0]].reshape(16, 3), body.lengths[0]
    points, weights = np.polynomial.legendre.leggauss(4)  # r x dr is of degree 5 along a side
    area = np.zeros(3)
    for p, w in zip(0.5 + 0.5 * points, 0.5 * weights, strict=True):
        for place, vector, way in (((p, 0.0), 1, a), ((1.0, p), 2, b), ((p, 1.0), 1, -a), ((0.0, p), 2, -b)):
            r, slope = (shape_values(body, 0, place, c) @ own for c in (0, vector))
            area += 0.5 * w * way * np.cross(r, slope)
    np.testing.assert_allclose(got, 3.0 * pressure * area, rtol=0.0, atol=1e-12 * np.abs(got).max())


def test_pressure_does_the_work_of_the_swept_volume() -> None:
    body = one_rectangle()
    kind, q = pack([body]), deformed(body, 0.1)
    v = np.random.default_rng(10).normal(size=q.shape)
    put(kind.trial_position, q)
    kind.external_force[:] = 0.0
    follow(kind, 0, kind.trial_position, 0, kind.external_force, 0, 1.0 / kind.constants[0])
    at, weights = np.polynomial.legendre.leggauss(7)
    expected = 0.0
    for x, wx in zip(0.5 + 0.5 * at, 0.5 * weights, strict=True):
        for y, wy in zip(0.5 + 0.5 * at, 0.5 * weights, strict=True):
            own = q[body.elements[0]].reshape(16, 3)
            r_x, r_y = (shape_values(body, 0, (x, y), c) @ own for c in (1, 2))
            speed = shape_values(body, 0, (x, y), 0) @ v[body.elements[0]].reshape(16, 3)
            expected += wx * wy * 1.3 * 0.8 * np.cross(r_x, r_y) @ speed
    assert np.sum(taken(kind.external_force) * v) == pytest.approx(expected, rel=1e-7)  # 5 points against 7


def test_drift_is_the_largest_difference_as_a_strain() -> None:
    mesh = rectangle(2.0, 3.0, 2, 3)
    body = shell(mesh)
    kind, start = pack([body]), start_coordinates(body)
    stretched = start.copy()
    stretched[..., 0] *= 1.01
    put(kind.trial_position, start)
    find(kind, 0, kind.trial_position, kind.strain)
    put(kind.trial_position, stretched)
    find(kind, 0, kind.trial_position, kind.shape_strain)
    drift(kind, 0, kind.strain, kind.shape_strain)
    assert kind.body[0].drift == pytest.approx(0.5 * (1.01**2 - 1.0), rel=1e-12)
    moved = start.copy()
    moved[mesh.corners[2], 0, 1] += 0.02
    put(kind.trial_position, moved)
    find(kind, 0, kind.trial_position, kind.shape_strain)
    drift(kind, 0, kind.strain, kind.shape_strain)
    assert mesh.corners[2] in body.elements[int(kind.body[0].drift_element)]
    assert kind.body[0].drift > 0.01
    kind.strain[26] = np.nan  # a number that is lost must not look like none
    drift(kind, 0, kind.strain, kind.shape_strain)
    assert np.isnan(kind.body[0].drift)


def test_bodies_of_one_kind_keep_apart() -> None:
    bodies = [one_rectangle(), distorted_element(gauss_points=4)]
    both = pack(bodies)
    both.strain[:] = 7.0
    put(both.trial_position, np.concatenate([deformed(bodies[0]), deformed(bodies[1])]))
    find(both, 1, both.trial_position, both.strain)
    assert np.all(both.strain[: both.elements[1].strain] == 7.0)
    both.external_force[:] = 0.0
    add_forces(both, 1, both.trial_position, both.strain, both.external_force, 1.0)
    assert not taken(both.external_force)[:4].any()
    alone = pack([bodies[1]])
    np.testing.assert_array_equal(taken(both.external_force)[4:], forces_at(alone, deformed(bodies[1])))


def test_elements_of_any_lengths_see_the_same_shape() -> None:
    # half the length and twice the slopes are the same element
    body = distorted_element()
    vectors = start_coordinates(body).copy()
    vectors[:, 1:3] *= 2.0
    vectors[:, 3] *= 4.0
    same = element(vectors, tuple(body.lengths[0] / 2.0))
    q = deformed(body)
    scaled = q.copy()
    scaled[:, 1:3] *= 2.0
    scaled[:, 3] *= 4.0
    kind, other = pack([body]), pack([same])
    assert energy_at(other, scaled) == pytest.approx(energy_at(kind, q), rel=1e-12)
    np.testing.assert_allclose(forces_at(other, scaled)[:, 0], forces_at(kind, q)[:, 0], rtol=1e-9)
