"""Geometric stiffness of solids: uniform stress, bending stress of bricks, rigid motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.geometric import geometric_stiffness, point_stress
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.finite_elements.reference_elements import REFERENCE_NODES

SIZE = (0.8, 0.5, 0.3)
VOLUME = float(np.prod(SIZE))
STEEL = Material(2.1e11, 0.3, 7850.0)


def solid(element: str) -> Mesh:
    """A block of a few elements, bricks with their inner nodes out of place; of 20 nodes a single one."""
    if element == "hex20":
        nodes = 0.5 * (REFERENCE_NODES["hex20"] + 1.0) * SIZE
        nodes[:, 0] += 0.1 * nodes[:, 1]  # a parallelepiped of the same volume
        return Mesh(nodes, np.arange(20)[None], "hex20")
    size = {"size": 0.2} if element == "tet10" else {"divisions": {"x": [3], "y": [2], "z": [2]}}
    mesh = mesh_blocks([Box("block", (0.0, 0.0, 0.0), SIZE)], element_type=element, **size)
    inner = ((mesh.nodes > 1e-9) & (mesh.nodes < np.array(SIZE) - 1e-9)).all(axis=1)
    if element == "tet10":
        return mesh
    moved = mesh.nodes + 0.03 * np.random.default_rng(3).standard_normal(mesh.nodes.shape) * inner[:, None]
    return replace(mesh, nodes=moved)


@pytest.mark.parametrize(
    ("element", "formulation"),
    [
        ("hex8", "incompatible"),
        ("hex8", "full"),
        ("hex8", "reduced"),
        ("tet10", None),
        ("hex20", "full"),
        ("hex20", "reduced"),
    ],
)
def test_uniform_stress_does_its_work_on_the_square_of_any_uniform_gradient(
    element: str, formulation: str | None
) -> None:
    """``u^T K_g u = V s_kl A_ik A_il`` for ``u = A x``, and nothing for a translation."""
    mesh = solid(element)
    rng = np.random.default_rng(5)
    H, A = 1e-3 * rng.standard_normal((3, 3)), rng.standard_normal((3, 3))
    strain = 0.5 * (H + H.T)
    stress = 2.0 * STEEL.shear_modulus * strain + STEEL.lame_lambda * np.trace(strain) * np.eye(3)
    S = geometric_stiffness(mesh, STEEL, mesh.nodes @ H.T, formulation=formulation)
    u = mesh.nodes @ A.T
    expected = VOLUME * np.einsum("kl,ik,il->", stress, A, A)
    assert np.einsum("ai,ab,bi->", u, S.toarray(), u) == pytest.approx(expected, rel=1e-10)
    assert np.abs(S @ np.ones(mesh.node_count)).max() < 1e-10 * np.abs(S.data).max()
    assert abs(S - S.T).max() < 1e-12 * np.abs(S.data).max()


def test_one_brick_through_a_bent_beam_has_its_linear_stress() -> None:
    """Pure bending, exact with incompatible modes: ``s_xx = E k z``; without them half the shear would be false."""
    nu, curvature = 0.3, 1e-3
    mesh = mesh_blocks(
        [Box("beam", (0.0, -0.05, -0.05), (1.0, 0.05, 0.05))],
        element_type="hex8",
        divisions={"x": [5], "y": [1], "z": [1]},
    )
    x, y, z = mesh.nodes.T
    u = curvature * np.column_stack([x * z, -nu * y * z, -0.5 * (x**2 + nu * (z**2 - y**2))])
    stress, gradients, _ = point_stress(mesh, STEEL, u)
    heights = mesh.nodes[mesh.elements][:, :, 2]
    at = 0.05 / np.sqrt(3.0) * np.sign(REFERENCE_NODES["hex8"][:, 2])
    assert np.abs(heights).max() == pytest.approx(0.05)
    expected = np.zeros_like(stress)
    expected[..., 0, 0] = STEEL.young_modulus * curvature * at
    np.testing.assert_allclose(stress, expected, atol=1e-9 * STEEL.young_modulus * curvature)
    assert gradients.shape == (5, 8, 8, 3)


def test_bricks_with_the_alphas_have_the_forces_of_their_stiffness() -> None:
    """``int B^T s dV = K u`` of distorted bricks and any displacement."""
    mesh = solid("hex8")
    u = 1e-3 * np.random.default_rng(8).standard_normal(mesh.nodes.shape)
    stress, G, weight = point_stress(mesh, STEEL, u, formulation="incompatible")
    forces = np.zeros_like(u)
    np.add.at(forces, mesh.elements, np.einsum("eq,eqkl,eqIl->eIk", weight, stress, G))
    expected = assemble(mesh, STEEL).stiffness @ u.ravel()
    np.testing.assert_allclose(forces.ravel(), expected, atol=1e-11 * np.abs(expected).max())


def test_displacements_of_another_mesh_are_refused() -> None:
    """By their shape."""
    mesh = solid("hex8")
    with pytest.raises(InputError, match=f"shape \\({mesh.node_count}, 3\\)"):
        geometric_stiffness(mesh, STEEL, np.zeros((4, 3)))
