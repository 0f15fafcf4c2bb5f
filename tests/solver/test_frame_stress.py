"""Stresses of frames from the vectors of their nodes: closed forms, rigid motion, order."""

import numpy as np
import pytest

from heavylift.numerics.rotation import quaternion_from_rotation_vector, rotation_matrix
from heavylift.solver.bodies.ancf.stress import cubic_shapes, frame_lengths, frame_stresses
from heavylift.solver.scene.meshes import FrameBody, FrameSection

E, A, I, C = 2.1e11, 3e-4, 5e-9, 0.02
PLACES = np.linspace(0.0, 1.0, 5)


def straight(count=4, length=2.0, **changes):
    nodes = np.zeros((count + 1, 3))
    nodes[:, 0] = np.linspace(0.0, length, count + 1)
    elements = np.column_stack([np.arange(count), np.arange(1, count + 1)])
    given = {
        "name": "beam",
        "nodes": nodes,
        "tangents": np.tile([1.0, 0.0, 0.0], (count + 1, 1)),
        "elements": elements,
        "sections": (FrameSection(7850.0, E, A, I, C),),
    }
    return FrameBody(**(given | changes))


def arc(count, radius, angle):
    """Vectors of the nodes on an arc in the plane of x and z that begins along x and rises."""
    t = np.linspace(0.0, angle, count + 1)
    places = radius * np.column_stack([np.sin(t), 0 * t, 1.0 - np.cos(t)])
    return places, np.column_stack([np.cos(t), 0 * t, np.sin(t)])


def moved(coordinates):
    R = rotation_matrix(quaternion_from_rotation_vector([0.7, -1.9, 0.4]))
    out = coordinates @ R.T
    out[..., 0, :] += [3.0, -2.0, 5.0]
    return out


def test_shapes_are_dual_to_value_and_slope_and_derivatives_are_consistent():
    ends = cubic_shapes([0.0, 1.0])
    np.testing.assert_allclose(ends[0][:, [0, 2]], np.eye(2), atol=1e-15)
    np.testing.assert_allclose(ends[1][:, [1, 3]], np.eye(2), atol=1e-15)
    x, d = np.linspace(0.1, 0.9, 7), 1e-4
    for order in (0, 1):
        difference = (cubic_shapes(x + d)[order] - cubic_shapes(x - d)[order]) / (2 * d)
        np.testing.assert_allclose(difference, cubic_shapes(x)[order + 1], atol=1e-7)


@pytest.mark.parametrize(
    ("model", "strain"), [("exact", 0.25), ("green-lagrange", 0.5 * (1.25**2 - 1.0) * 1.25)]
)
def test_stretch_has_the_force_that_holds_it_in_any_attitude(model, strain):
    """Derivative of the energy EA e^2/2 by the length: EA e, times the stretch for the strain of Green-Lagrange."""
    body = straight(model=model)
    coordinates = 1.25 * np.stack([body.nodes, body.tangents], axis=1)
    found = frame_stresses(body, moved(coordinates), PLACES)
    np.testing.assert_allclose(found.axial_force, E * A * strain, rtol=1e-12)
    np.testing.assert_allclose(found.axial_stress, E * strain, rtol=1e-12)
    np.testing.assert_allclose(found.fibre_stress, 0.0, atol=1e-12 * E)


@pytest.mark.parametrize("model", ["exact", "green-lagrange"])
def test_rigid_motion_is_free_of_stress(model):
    nodes, tangents = arc(5, 2.0, 1.3) if model == "exact" else (straight(5).nodes, straight(5).tangents)
    body = straight(5, nodes=nodes, tangents=tangents, model=model)
    found = frame_stresses(body, moved(np.stack([nodes, tangents], axis=1)), PLACES)
    np.testing.assert_allclose(found.largest / E, 0.0, atol=1e-14)


def test_parabola_has_its_curvature_everywhere():
    """r = (s, 0, k s^2/2) is cubic: |r' x r''| / |r'|^2 = k / (1 + k^2 s^2), and Green-Lagrange strain k^2 s^2/2.

    Its force on the axis has the factor |r'| = sqrt(1 + k^2 s^2).
    """
    body, k = straight(3), 0.8
    s = body.nodes[:, 0]
    coordinates = np.stack(
        [
            np.column_stack([s, 0 * s, 0.5 * k * s**2]),
            np.column_stack([np.ones_like(s), 0 * s, k * s]),
        ],
        axis=1,
    )
    found = frame_stresses(body, coordinates, PLACES)
    at = found.places[..., 0]
    np.testing.assert_allclose(found.fibre_stress, E * C * k / (1 + k**2 * at**2), rtol=1e-12)
    stretch = np.sqrt(1.0 + k**2 * at**2)
    np.testing.assert_allclose(found.axial_stress, 0.5 * E * k**2 * at**2 * stretch, atol=1e-12 * E)
    # to the centre of curvature: up, and across the tangent
    assert np.all(found.bending[..., 2] > 0.0)
    np.testing.assert_allclose(np.sum(found.bending * found.tangents, axis=-1), 0.0, atol=1e-14)


def test_cantilever_rolled_into_a_circle_has_the_stress_of_bending_in_the_limit():
    """E c / R without axial force, for the model whose axis does not stretch; second order and better."""
    length, errors = 2.0, []
    radius = length / (2 * np.pi)
    for count in (12, 24):
        body = straight(count, length, model="exact")
        found = frame_stresses(body, np.stack(arc(count, radius, 2 * np.pi), axis=1), PLACES)
        errors.append(np.abs(found.fibre_stress / (E * C / radius) - 1.0).max())
    assert errors[1] < 0.006
    assert errors[0] / errors[1] > 3.8


def test_unloaded_arc_opened_to_a_straight_line_bears_its_curvature():
    radius, angle, count = 1.5, 1.0, 16
    nodes, tangents = arc(count, radius, angle)
    body = straight(count, nodes=nodes, tangents=tangents, model="exact")
    lengths = frame_lengths(nodes, tangents, body.elements)
    np.testing.assert_allclose(lengths, radius * angle / count, rtol=1e-7)
    line = np.zeros_like(nodes)
    line[:, 0] = np.concatenate([[0.0], np.cumsum(lengths)])
    found = frame_stresses(body, np.stack([line, np.tile([1.0, 0, 0], (count + 1, 1))], axis=1), PLACES)
    np.testing.assert_allclose(found.fibre_stress, E * C / radius, rtol=2e-3)


def test_fibre_that_bears_most_has_the_sign_of_the_axial_force_and_prestrain_counts():
    body = straight(2, axial_strains=np.array([1e-3, -2e-3]))
    found = frame_stresses(body, np.stack([body.nodes, body.tangents], axis=1), PLACES)
    np.testing.assert_allclose(found.axial_force[:, 0], [1e-3 * E * A, -2e-3 * E * A], rtol=1e-12)
    bent = frame_stresses(body, np.stack(arc(2, 40.0, 0.05), axis=1), PLACES)
    np.testing.assert_array_less(bent.largest[1], bent.axial_stress[1])
    np.testing.assert_array_less(bent.axial_stress[0], bent.largest[0])
    moment, arm = E * I / 40.0, C / I
    np.testing.assert_allclose(bent.fibre_stress, moment * arm, rtol=2e-3)


def test_records_are_evaluated_together():
    body = straight(3)
    one = np.stack(arc(3, 5.0, 0.4), axis=1)
    both = frame_stresses(body, np.stack([one, moved(one)]), PLACES)
    alone = frame_stresses(body, one, PLACES)
    np.testing.assert_allclose(both.largest[0], alone.largest, rtol=1e-13)
    np.testing.assert_allclose(both.largest[1], alone.largest, rtol=1e-9)
