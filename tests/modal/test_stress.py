"""Stress recovery: polynomial fields, rigid motion, beam bending."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal.bases import patch_loads, static_vectors
from heavylift.modal.flexibility import Flexibility, rigid_motions
from heavylift.modal.stress import nodal_gradients, stress_modes, von_mises
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import Material

STEEL = Material(2.1e11, 0.3, 7850.0)


def distorted(element_type):
    """Block with irregular elements, surface nodes too."""
    mesh = mesh_blocks([Box("b", (0, 0, 0), (1.0, 0.8, 0.6))], element_type=element_type, size=0.25)
    if element_type == "tet10":
        return mesh
    shift = np.random.default_rng(10).uniform(-0.02, 0.02, mesh.nodes.shape)
    return Mesh(mesh.nodes + shift, mesh.elements, element_type).check()


@pytest.mark.parametrize("element_type", ["tet10", "hex8"])
def test_constant_strain_is_exact(element_type):
    mesh = distorted(element_type)
    H = np.random.default_rng(11).uniform(-1e-3, 1e-3, (3, 3))  # du_i/dx_j
    stress = stress_modes(mesh, STEEL, (mesh.nodes @ H.T)[None])[0]
    strain = 0.5 * (H + H.T)
    tensor = STEEL.lame_lambda * np.trace(strain) * np.eye(3) + 2.0 * STEEL.shear_modulus * strain
    voigt = [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[1, 2], tensor[2, 0]]
    np.testing.assert_allclose(stress, np.tile(voigt, (mesh.node_count, 1)), atol=1e-9 * np.abs(voigt).max())
    deviator = tensor - np.trace(tensor) / 3.0 * np.eye(3)
    np.testing.assert_allclose(von_mises(stress), np.sqrt(1.5 * np.sum(deviator**2)), rtol=1e-9)


@pytest.mark.parametrize("element_type", ["tet10", "hex8"])
def test_rigid_motion_has_no_stress(element_type):
    mesh = distorted(element_type)
    shapes = rigid_motions(mesh.nodes).T.reshape(6, -1, 3)
    assert np.abs(stress_modes(mesh, STEEL, shapes)).max() < 1e-9 * STEEL.young_modulus


def test_quadratic_fields(with_middle_nodes):
    # exact at every node with quadratic tetrahedra, and with regular bricks, surfaces included
    rng = np.random.default_rng(12)
    Q = rng.standard_normal((3, 3))
    Q += Q.T
    bricks = mesh_blocks([Box("b", (0, 0, 0), (1, 1, 1))], element_type="hex8", size=0.4)
    for mesh in (
        distorted("tet10"),
        with_middle_nodes(bricks),
        mesh_blocks([Box("b", (0, 0, 0), (1, 1, 1))], element_type="hex8", size=0.25),
    ):
        field = 0.5 * np.einsum("ni,ij,nj->n", mesh.nodes, Q, mesh.nodes)
        computed = np.column_stack([gradient @ field for gradient in nodal_gradients(mesh)])
        np.testing.assert_allclose(computed, mesh.nodes @ Q, atol=1e-10)


@pytest.mark.parametrize("element_type", ["tet10", "hex8"])
def test_bending_stress_of_a_cantilever(element_type):
    L, h, b, F = 1.0, 0.1, 0.05, 1000.0
    mesh = mesh_blocks(
        [Box("beam", (0, 0, 0), (L, h, b))],
        element_type=element_type,
        size=0.025,
        groups=(OnPlane("clamp", "x", 0.0), OnPlane("tip", "x", L)),
    )
    model = assemble(mesh, STEEL)
    flexibility = Flexibility(model, mesh.node_groups["clamp"])
    u = F * static_vectors(flexibility, patch_loads(model, mesh.node_groups["tip"], "y")).vectors[:, 0]
    stress = stress_modes(mesh, STEEL, u.reshape(1, -1, 3))[0]
    middle = np.flatnonzero(np.abs(mesh.nodes[:, 0] - 0.5) < 0.11)  # far from support and load
    x, y = mesh.nodes[middle, 0], mesh.nodes[middle, 1]
    expected = -F * (L - x) * (y - h / 2) * 12.0 / (b * h**3)
    largest = F * 0.6 * 6.0 / (b * h**2)
    np.testing.assert_allclose(stress[middle, 0], expected, atol=0.02 * largest)
    on_top = middle[(y > h - 1e-9)]
    np.testing.assert_allclose(von_mises(stress[on_top]), np.abs(expected[y > h - 1e-9]), rtol=0.03)


def test_von_mises_of_simple_states():
    s = np.diag([7.0] * 6)
    np.testing.assert_allclose(von_mises(s), 7.0 * np.array([1, 1, 1, *[np.sqrt(3.0)] * 3]), rtol=1e-14)
    assert von_mises(np.array([5.0, 5.0, 5.0, 0, 0, 0])) == 0.0  # pressure
    assert von_mises(np.zeros((2, 4, 6))).shape == (2, 4)


def test_shapes_must_fit_the_mesh():
    mesh = distorted("hex8")
    with pytest.raises(InputError, match="expected shape"):
        stress_modes(mesh, STEEL, np.zeros((2, 5, 3)))
