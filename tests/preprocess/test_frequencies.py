"""Natural frequencies of the complex beam against published values and an independent program (docs/sources.md)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import eigsh

from heavylift.preprocess.finite_elements.blocks import mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.refinement import RE_ENTRANT, Refinement

# Deformable bodies ... sliding contacts (2014), section 5.1, ABAQUS column
PUBLISHED = [534.37, 1071.7, 2271.4, 3099.5, 6346.2]
# independent program, incompatible modes, same mesh
INCOMPATIBLE = [627.689241, 1257.839217, 3185.832579, 3622.453516, 7546.636534]
# independent program, quadratic tetrahedra, 537 120 degrees of freedom
CONVERGED = [622.966274, 1241.970364, 3145.630972, 3572.924596, 7237.814591]
# the same, 13 815 degrees of freedom, consistent and lumped
COARSE = {
    "consistent": [624.674568, 1246.500331, 3176.204856, 3590.024767, 7322.953192],
    "lumped": [624.507027, 1246.09644, 3153.902486, 3585.403549, 7309.664241],
}


def _frequencies(model):
    free = np.setdiff1d(np.arange(model.node_count), model.node_groups["clamp"])
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    K, M = model.stiffness.tocsc()[dofs][:, dofs], model.full_mass().tocsc()[dofs][:, dofs]
    start = np.random.default_rng(0).standard_normal(len(dofs))
    return np.sqrt(np.sort(eigsh(K, 5, M, sigma=0.0, return_eigenvectors=False, v0=start))) / (2 * np.pi)


def test_reduced_bricks_reproduce_the_published_frequencies(thesis_mesh, steel):
    assert (thesis_mesh.node_count, thesis_mesh.element_count) == (374, 178)
    assert thesis_mesh.node_groups["clamp"].size == 15
    model = assemble(thesis_mesh, steel, formulation="reduced", mass="lumped")
    np.testing.assert_allclose(_frequencies(model), PUBLISHED, rtol=2e-5)


def test_incompatible_bricks_agree_with_a_prototype(thesis_mesh, steel):
    model = assemble(thesis_mesh, steel, formulation="incompatible", mass="lumped")
    np.testing.assert_allclose(_frequencies(model), INCOMPATIBLE, rtol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_tetrahedra_agree_with_a_prototype_on_a_mesh_of_that_size(complex_beam, steel, mass):
    mesh = mesh_blocks(complex_beam.add, complex_beam.cut, size=4e-3, groups=complex_beam.groups)
    assert 3 * mesh.node_count == pytest.approx(13_815, rel=0.02)
    # another mesh of the same size: the discretisation errors, up to 1 %, agree to a tenth
    np.testing.assert_allclose(_frequencies(assemble(mesh, steel, mass=mass)), COARSE[mass], rtol=1e-3)


@pytest.mark.slow
def test_a_graded_mesh_is_within_three_per_mille(complex_beam, steel):
    """Of 537 120 degrees of freedom, with a tenth of them; an even mesh needs three times more."""
    mesh = mesh_blocks(
        complex_beam.add,
        complex_beam.cut,
        size=3e-3,
        groups=complex_beam.groups,
        refine=[Refinement(RE_ENTRANT, 1e-3), Refinement("clamp", 1e-3)],
    )
    assert 3 * mesh.node_count < 45_000
    np.testing.assert_allclose(_frequencies(assemble(mesh, steel)), CONVERGED, rtol=3e-3)


@pytest.mark.slow
def test_tetrahedra_converge_from_above(complex_beam, steel):
    """Consistent mass and conforming elements bound frequencies from above (Rayleigh)."""
    errors = []
    for size in (9e-3, 5e-3, 3e-3):
        mesh = mesh_blocks(complex_beam.add, complex_beam.cut, size=size, groups=complex_beam.groups)
        errors.append(_frequencies(assemble(mesh, steel)) / CONVERGED - 1.0)
    errors = np.array(errors)
    assert (errors > 0).all()
    assert (np.diff(errors, axis=0) < 0).all()
    assert errors[-1].max() < 0.01
