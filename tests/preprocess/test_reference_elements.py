"""Shape functions: partition of unity, interpolation, gradients; the volume rule."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.preprocess.finite_elements import reference_elements as reference

KINDS = ("hex8", "hex20", "tet10")


def _points(kind, count=7):
    points = np.random.default_rng(0).uniform(0.02, 0.3, (count, 3))
    return points if kind == "tet10" else 4.0 * points - 0.6


@pytest.mark.parametrize("kind", KINDS)
def test_shape_function_is_one_at_its_node_and_zero_at_the_others(kind):
    N = reference.shape_functions(kind, reference.REFERENCE_NODES[kind])
    np.testing.assert_allclose(N, np.eye(reference.NODE_COUNT[kind]), atol=1e-15)


@pytest.mark.parametrize("kind", KINDS)
def test_constant_and_linear_fields_are_reproduced(kind):
    points = _points(kind)
    N = reference.shape_functions(kind, points)
    np.testing.assert_allclose(N.sum(axis=1), 1.0, atol=1e-15)
    np.testing.assert_allclose(N @ reference.REFERENCE_NODES[kind], points, atol=1e-15)


@pytest.mark.parametrize("kind", KINDS)
def test_gradients_are_the_derivatives(kind):
    points = _points(kind)
    step = 1e-6
    gradients = reference.shape_gradients(kind, points)
    for k in range(3):
        e = step * np.eye(3)[k]
        difference = reference.shape_functions(kind, points + e) - reference.shape_functions(kind, points - e)
        np.testing.assert_allclose(gradients[:, :, k], difference / (2 * step), atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_volume_rule_is_exact_for_a_curved_element(kind):
    # the divergence theorem on finely sampled faces would only be approximate; a tensor Gauss rule of high
    # order (collapsed onto the tetrahedron) is an independent exact integral
    g, w = np.polynomial.legendre.leggauss(6)
    if kind != "tet10":
        fine = np.stack(np.meshgrid(g, g, g, indexing="ij"), axis=-1).reshape(-1, 3)
        weights = np.einsum("i,j,k->ijk", w, w, w).ravel()
    else:
        u, wu = 0.5 * (g + 1.0), 0.5 * w
        a, b, c = (v.ravel() for v in np.meshgrid(u, u, u, indexing="ij"))
        fine = np.column_stack([a, b * (1 - a), c * (1 - a) * (1 - b)])
        weights = np.einsum("i,j,k->ijk", wu, wu, wu).ravel() * (1 - a) ** 2 * (1 - b)
    corners = reference.REFERENCE_NODES[kind] + np.random.default_rng(3).uniform(
        -0.1, 0.1, (reference.NODE_COUNT[kind], 3)
    )

    def integral(points, weights):
        J = reference.jacobians(corners[None], reference.shape_gradients(kind, points))[0]
        return weights @ np.linalg.det(J)

    assert integral(*reference.volume_rule(kind)) == pytest.approx(integral(fine, weights), rel=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_faces_point_outwards_and_close(kind):
    nodes = reference.REFERENCE_NODES[kind]
    triangles = reference.FACES[kind][:, reference.FACE_TRIANGLES[kind]].reshape(-1, 3)
    p, q, r = (nodes[triangles[:, k]] for k in range(3))
    areas = np.cross(q - p, r - p)
    np.testing.assert_allclose(areas.sum(axis=0), 0.0, atol=1e-15)
    outward = np.einsum("ij,ij->i", areas, (p + q + r) / 3 - nodes.mean(axis=0))
    assert (outward > 0).all()
