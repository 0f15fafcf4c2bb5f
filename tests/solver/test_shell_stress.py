"""Stresses of shells from the vectors of their nodes: closed forms on square and distorted elements, order."""

import numpy as np
import pytest

from heavylift.numerics.rotation import quaternion_from_rotation_vector, rotation_matrix
from heavylift.solver.bodies.ancf.stress import shell_coordinates, shell_stresses, von_mises
from heavylift.solver.scene.meshes import ShellBody, ShellSection

E, NU, T = 7e10, 0.3, 0.004
GRID = np.linspace(0.0, 1.0, 5)
PLANE = E / (1.0 - NU**2)
SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.2], [0.0, 1.2]])
DISTORTED = np.array([[0.0, 0.0], [2.0, 0.3], [1.7, 1.5], [-0.4, 1.1]])
R = rotation_matrix(quaternion_from_rotation_vector([0.7, -1.9, 0.4]))


def element(corners, lengths=(1.7, 0.9)):
    """One element whose parameter lines are straight, in a plane that is not level."""
    p, (a, b) = np.pad(corners, ((0, 0), (0, 1))), lengths
    bottom, top, left, right = p[1] - p[0], p[2] - p[3], p[3] - p[0], p[2] - p[1]
    twist = (top - bottom) / (a * b)
    slopes = np.array(
        [
            [bottom / a, left / b, twist],
            [bottom / a, right / b, twist],
            [top / a, right / b, twist],
            [top / a, left / b, twist],
        ]
    )
    return ShellBody(
        name="plate",
        nodes=p @ R.T + [1.0, 2.0, 3.0],
        slopes=slopes @ R.T,
        elements=np.array([[0, 1, 2, 3]]),
        lengths=np.array([lengths]),
        sections=(ShellSection(T, 2700.0, E, NU),),
    )


def mapped(body, value, gradient, hessian):
    """Vectors of the nodes of r(X): with the flat coordinates X = (x, y) of the unloaded shape in its plane."""
    flat = (body.nodes - [1.0, 2.0, 3.0]) @ R
    slopes = body.slopes @ R
    out = []
    for x, (x_1, x_2, x_12) in zip(flat[:, :2], slopes[:, :, :2], strict=True):
        D, H = gradient(x), hessian(x)
        out.append([value(x), D @ x_1, D @ x_2, np.einsum("kij,i,j->k", H, x_1, x_2) + D @ x_12])
    return np.array(out)


def bent(body, H):
    """The surface over the plane with the height x^T H x / 2, which all elements represent exactly."""

    def value(x):
        return np.array([*x, 0.5 * x @ H @ x])

    def gradient(x):
        return np.vstack([np.eye(2), H @ x])

    def hessian(_x):
        return np.array([np.zeros((2, 2)), np.zeros((2, 2)), H])

    return mapped(body, value, gradient, hessian)


def rolled(body, angle):
    """A plate of the length of x turned about y into a cylinder."""
    x, y, _ = body.nodes.T
    radius = x.max() / angle
    t = x / radius
    zero = np.zeros_like(x)
    places = np.column_stack([radius * np.sin(t), y, radius * (1.0 - np.cos(t))])
    along = np.column_stack([np.cos(t), zero, np.sin(t)])
    across = np.tile([0.0, 1.0, 0.0], (len(x), 1))
    return np.stack([places, along, across, np.zeros_like(places)], axis=1), radius


def strip(count):
    x, y = np.meshgrid(np.linspace(0.0, 3.0, count + 1), [0.0, 0.5, 1.0], indexing="ij")
    nodes = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    ids = np.arange(len(nodes)).reshape(x.shape)
    elements = np.column_stack(
        [ids[:-1, :-1].ravel(), ids[1:, :-1].ravel(), ids[1:, 1:].ravel(), ids[:-1, 1:].ravel()]
    )
    return ShellBody(
        name="strip",
        nodes=nodes,
        slopes=np.tile(np.diag([1.0, 1.0, 0.0]), (len(nodes), 1, 1)),
        elements=elements,
        lengths=np.tile([3.0 / count, 0.5], (len(elements), 1)),
        sections=(ShellSection(T, 2700.0, E, NU),),
    )


@pytest.mark.parametrize("corners", [SQUARE, DISTORTED])
def test_rigid_motion_is_free_of_stress(corners):
    body = element(corners)
    turn = rotation_matrix(quaternion_from_rotation_vector([2.0, 0.3, -1.0]))
    coordinates = shell_coordinates(body) @ turn.T
    coordinates[:, 0] += [5.0, -1.0, 2.0]
    for state in (shell_coordinates(body), coordinates):
        found = shell_stresses(body, state, GRID, GRID)
        np.testing.assert_allclose(found.von_mises() / E, 0.0, atol=1e-14)


@pytest.mark.parametrize("corners", [SQUARE, DISTORTED])
def test_homogeneous_deformation_has_the_von_mises_stress_of_its_green_strain(corners):
    body = element(corners)
    F = np.array([[1.02, 0.03], [-0.01, 0.99], [0.005, 0.04]])
    state = mapped(body, lambda x: F @ x, lambda _: F, lambda _: np.zeros((3, 2, 2)))
    strain = 0.5 * (F.T @ F - np.eye(2))
    stress = PLANE * (1.0 - NU) * strain + PLANE * NU * np.trace(strain) * np.eye(2)
    # von Mises through the deviator of the whole tensor: independent of the formula for plane stress
    whole = np.pad(stress, ((0, 1), (0, 1)))
    deviator = whole - np.trace(whole) / 3.0 * np.eye(3)
    expected = np.sqrt(1.5 * np.sum(deviator**2))
    found = shell_stresses(body, state, GRID, GRID)
    for side in ("top", "middle", "bottom", "largest"):
        np.testing.assert_allclose(found.von_mises(side), expected, rtol=1e-10)


@pytest.mark.parametrize("corners", [SQUARE, DISTORTED])
@pytest.mark.parametrize(
    "H", [np.diag([0.3, 0.0]), np.diag([0.2, -0.4]), np.array([[0.1, 0.25], [0.25, 0.0]])]
)
def test_quadratic_surface_has_its_curvature_at_every_place(corners, H):
    """Height w = x^T H x / 2: n.r_xx = H / sqrt(1 + |grad w|^2), Green-Lagrange strain grad w grad w^T / 2."""
    body = element(corners)
    found = shell_stresses(body, bent(body, H), GRID, GRID)
    gradient = found.places[..., :2] @ H
    slope = np.sqrt(1.0 + np.sum(gradient**2, axis=-1))
    curvature = H / slope[..., np.newaxis, np.newaxis]
    membrane = 0.5 * gradient[..., :, np.newaxis] * gradient[..., np.newaxis, :]
    for side, z in (("top", T / 2), ("middle", 0.0), ("bottom", -T / 2)):
        e = membrane - z * curvature
        trace = np.trace(e, axis1=-2, axis2=-1)[..., np.newaxis, np.newaxis]
        s = PLANE * ((1.0 - NU) * e + NU * trace * np.eye(2))
        plane = np.stack([s[..., 0, 0], s[..., 1, 1], s[..., 0, 1]], axis=-1)
        expected = von_mises(plane)
        np.testing.assert_allclose(found.von_mises(side), expected, atol=1e-10 * expected.max() + 1e-3)


def test_top_of_a_plate_that_bends_upwards_is_compressed():
    body = element(SQUARE)
    found = shell_stresses(body, bent(body, np.diag([0.3, 0.0])), [0.0], [0.0])
    np.testing.assert_allclose(found.normals[0, 0, 0], [0.0, 0.0, 1.0], atol=1e-12)
    expected = -PLANE * 0.5 * T * 0.3 * np.array([1.0, NU, 0.0])
    np.testing.assert_allclose(found.bending[0, 0, 0], expected, atol=1e-9 * abs(expected[0]))


def test_cylinder_has_the_von_mises_stress_of_pure_bending_in_the_limit():
    errors = []
    for count in (8, 16):
        body = strip(count)
        state, radius = rolled(body, 2 * np.pi)
        found = shell_stresses(body, state, [0.0, 0.5, 1.0], [0.0, 0.5, 1.0])
        expected = PLANE * T / (2 * radius) * np.sqrt(1 - NU + NU**2)
        errors.append(np.abs(von_mises(found.bending) / expected - 1.0).max())
        distance = np.linalg.norm(found.places[..., [0, 2]] - [0.0, radius], axis=-1)
    assert errors[1] < 0.02
    assert errors[0] / errors[1] > 3.7  # second order
    np.testing.assert_allclose(distance, radius, rtol=1e-4)


def test_records_are_evaluated_together_and_sections_belong_to_elements():
    body = strip(4)
    thick = ShellSection(3 * T, 2700.0, E, NU)
    which = np.arange(len(body.elements)) % 2
    mixed = ShellBody(**{**body.__dict__, "sections": (*body.sections, thick), "element_sections": which})
    state, _ = rolled(body, 1.0)
    plain = shell_stresses(body, np.stack([shell_coordinates(body), state]), GRID, GRID)
    other = shell_stresses(mixed, state, GRID, GRID)
    assert np.all(plain.von_mises()[0] == 0.0)
    ratio = np.where(which == 1, 3.0, 1.0)[:, np.newaxis, np.newaxis, np.newaxis]
    np.testing.assert_allclose(other.bending, ratio * plain.bending[1], rtol=1e-12, atol=1e-3)
