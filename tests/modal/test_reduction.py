"""The Ritz step, mean-axis shapes and the reduced body; the authors' data of the 2014 thesis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from heavylift.modal.bases import craig_bampton, eigenmode_basis, moment_matching, point_loads, static_vectors
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility, apply_mass, rigid_motions
from heavylift.modal.reduction import mean_axis, reduce_body, ritz_vectors
from heavylift.numerics.outcome import InputError


@pytest.fixture
def clamp(any_beam):
    return any_beam.node_groups["clamp"]


@pytest.fixture
def clamp_of_bricks(brick_beam):
    return brick_beam.node_groups["clamp"]


def test_eigenmodes_stay_eigenmodes(any_beam, clamp):
    modes = eigenmodes(any_beam, 8, fixed_nodes=clamp)
    basis = eigenmode_basis(modes, [3, 1, 6])
    body = reduce_body(any_beam, basis.vectors * 17.0, basis.labels, fixed_nodes=clamp, mean_axis=False)
    assert body.labels == ("eigenmode 1", "eigenmode 3", "eigenmode 6")
    assert body.dropped == ()
    np.testing.assert_allclose(body.eigenvalues, modes.eigenvalues[[0, 2, 5]], rtol=1e-9)
    np.testing.assert_allclose(body.frequencies, modes.frequencies[[0, 2, 5]], rtol=1e-9)
    shapes = modes.shapes[:, [0, 2, 5]].T.reshape(3, -1, 3)
    np.testing.assert_allclose(body.mode_shapes, shapes, atol=1e-5 * np.abs(shapes).max())
    assert body.residuals.max() < 1e-5
    assert body.mode_shapes.flags.c_contiguous


@pytest.fixture
def mixed(any_beam, clamp):
    """Eigenmodes, static and Krylov vectors together; the first Krylov vector repeats the static one."""
    flexibility = Flexibility(any_beam, clamp)
    loads = point_loads(any_beam, any_beam.node_groups["tip"][:1], "y")
    return (
        eigenmode_basis(eigenmodes(any_beam, 6, flexibility=flexibility))
        + static_vectors(flexibility, loads)
        + moment_matching(flexibility, loads, 2)
    )


@pytest.mark.parametrize("mean", [False, True])
def test_a_mixed_basis_gives_unit_mass_and_diagonal_stiffness(any_beam, clamp, mixed, mean):
    body = reduce_body(any_beam, mixed.vectors, mixed.labels, fixed_nodes=clamp, mean_axis=mean)
    phi = body.mode_shapes.reshape(body.mode_count, -1).T
    np.testing.assert_allclose(phi.T @ apply_mass(any_beam.mass, phi), np.eye(body.mode_count), atol=1e-12)
    assert body.orthogonality < 1e-12
    # the rigid part has no strain, so K sees the same vectors with it and without it
    K = phi.T @ (any_beam.stiffness @ phi)
    np.testing.assert_allclose(K, np.diag(body.eigenvalues), atol=1e-8 * body.eigenvalues[-1])
    assert np.all(np.diff(body.eigenvalues) >= 0.0)
    assert len(body.dropped) == 1
    assert "Krylov 1" in body.dropped[0]
    assert "combination" in body.dropped[0]
    assert len(set(body.labels)) == body.mode_count == 8


def test_a_mixture_does_not_bear_the_name_of_one_vector(any_beam, clamp):
    modes = eigenmodes(any_beam, 4, fixed_nodes=clamp)
    phi = modes.shapes
    # the Ritz step finds modes 1 and 3 in two equal mixtures of them, mode 4 in itself with a little of mode 2
    vectors = np.column_stack([phi[:, 0] + phi[:, 2], phi[:, 0] - phi[:, 2], phi[:, 3] + 0.1 * phi[:, 1]])
    body = reduce_body(any_beam, vectors, ["sum", "difference", "fourth"], fixed_nodes=clamp, mean_axis=False)
    assert body.labels == ("Ritz vector 1", "Ritz vector 2", "fourth")
    # 0.8 and 0.6 of a vector are a mixture too, although one part is larger
    vectors = np.column_stack([0.8 * phi[:, 0] + 0.6 * phi[:, 2], 0.6 * phi[:, 0] - 0.8 * phi[:, 2]])
    body = reduce_body(any_beam, vectors, ["a", "b"], fixed_nodes=clamp, mean_axis=False)
    assert body.labels == ("Ritz vector 1", "Ritz vector 2")


def test_eigenmodes_keep_their_names_beside_static_vectors(any_beam, clamp, mixed):
    body = reduce_body(any_beam, mixed.vectors, mixed.labels, fixed_nodes=clamp, mean_axis=False)
    assert body.labels[:6] == tuple(f"eigenmode {k + 1}" for k in range(6))
    assert body.eigenmode_mask[:6].all()
    assert not body.eigenmode_mask[-1]


def test_names_of_a_multiple_eigenvalue_are_kept():
    # two equal springs: the Ritz step may turn the pair of vectors by any angle
    turned = np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    from heavylift.modal.reduction import _matched

    names = _matched(turned, np.array([4.0, 4.0, 9.0]), [0, 1, 2], ["a", "b", "c"])
    assert sorted(names[:2]) == ["a", "b"]
    assert names[2] == "c"
    apart = _matched(turned, np.array([4.0, 5.0, 9.0]), [0, 1, 2], ["a", "b", "c"])
    assert apart == ("Ritz vector 1", "Ritz vector 2", "c")


def test_mean_axis_shapes_have_no_momentum(any_beam, clamp, mixed):
    body = reduce_body(
        any_beam, mixed.vectors, mixed.labels, fixed_nodes=clamp, origin=(0.4, -0.3, 0.2), mean_axis=True
    )
    m = body.integrals.mass
    assert np.abs(body.integrals.modal_translation).max() < 1e-12 * np.sqrt(m)
    # I_tf at q = 0 is the antisymmetric part of Ibar
    antisymmetric = body.integrals.position_mode - body.integrals.position_mode.transpose(1, 0, 2)
    assert np.abs(antisymmetric).max() < 1e-12 * np.sqrt(m)
    np.testing.assert_allclose(body.integrals.first_moment / m, [0.1, 0.35, -0.17], atol=1e-12)


def test_mean_axis_of_cantilever_modes_tends_to_free_modes(brick_beam):
    # the cantilever modes are a complete basis of deformations: with the frame set free by the
    # mean-axis step the frequencies fall to those of the free body, from above
    fixed = brick_beam.node_groups["clamp"]
    exact = eigenmodes(brick_beam, 4).eigenvalues
    errors = []
    for count in (10, 100):
        modes = eigenmodes(brick_beam, count, fixed_nodes=fixed)
        ritz = ritz_vectors(brick_beam, modes.shapes, ["m"] * count, fixed_nodes=fixed, mean_axis=True)
        errors.append(ritz.eigenvalues[:4] / exact - 1.0)
    assert np.all(np.array(errors) > 0.0)
    assert np.all(errors[1] < 0.1 * errors[0])
    assert np.all(errors[1] < 5e-3)


def test_mean_axis_keeps_strains(any_beam):
    vectors = np.random.default_rng(8).standard_normal((3 * any_beam.node_count, 2))
    moved = mean_axis(any_beam, vectors)
    difference = vectors - moved
    motions = rigid_motions(any_beam.nodes)
    part = np.linalg.lstsq(motions, difference, rcond=None)[0]
    np.testing.assert_allclose(motions @ part, difference, atol=1e-12)
    assert np.abs(motions.T @ apply_mass(any_beam.mass, moved)).max() < 1e-10


@pytest.mark.parametrize("mean", [False, True])
@pytest.mark.parametrize("faces", [("clamp", "tip"), ("tip",)])
def test_a_free_body_loses_six_rigid_motions_whatever_its_interface(any_beam, faces, mean):
    interface = np.unique(np.concatenate([any_beam.node_groups[face] for face in faces]))
    basis = craig_bampton(any_beam, interface, 5)
    K = basis.vectors.T @ (any_beam.stiffness @ basis.vectors)
    M = basis.vectors.T @ apply_mass(any_beam.mass, basis.vectors)
    exact = eigh(0.5 * (K + K.T), 0.5 * (M + M.T), eigvals_only=True)[6:]  # of the untouched set of vectors
    body = reduce_body(any_beam, basis.vectors, basis.labels, mean_axis=mean)
    assert body.mode_count == len(basis.labels) - 6 == len(exact)
    assert len(body.dropped) == 6
    assert body.orthogonality < 1e-12
    np.testing.assert_allclose(body.eigenvalues, exact, rtol=1e-7, atol=1e-12 * exact[-1])


def test_nearly_dependent_vectors_make_no_mode_of_rounding(brick_beam, clamp_of_bricks):
    """The chain of differences shrinks by 30 with each vector: one by one they look new for longer than they are."""
    shapes = eigenmodes(brick_beam, 3, fixed_nodes=clamp_of_bricks).shapes
    generator = np.random.default_rng(5)
    chain = [shapes[:, 0]]
    for k in range(1, 8):
        chain.append(chain[-1] + 30.0**-k * shapes @ generator.standard_normal(3))
    vectors = np.column_stack(chain)
    labels = [f"v{k}" for k in range(8)]
    body = reduce_body(brick_beam, vectors, labels, fixed_nodes=clamp_of_bricks, mean_axis=False)
    exact = eigenmodes(brick_beam, 3, fixed_nodes=clamp_of_bricks).eigenvalues
    assert body.mode_count == 3
    np.testing.assert_allclose(body.eigenvalues, exact, rtol=1e-4)


def test_shapes_without_unit_mass_are_refused(any_beam, clamp, mixed):
    body = reduce_body(any_beam, mixed.vectors, mixed.labels, fixed_nodes=clamp, mean_axis=False)
    with pytest.raises(InputError, match=r"modal mass differs from the identity by 0\.888"):
        replace(body, orthogonality=0.888)
    with pytest.raises(InputError, match="modal mass"):
        replace(body, orthogonality=np.nan)


def test_rigid_motions_are_dropped_with_a_record(brick_beam):
    modes = eigenmodes(brick_beam, 3)
    vectors = np.hstack([rigid_motions(brick_beam.nodes), modes.shapes])
    labels = [f"rigid {k}" for k in range(6)] + ["a", "b", "c"]
    for mean in (True, False):
        body = reduce_body(brick_beam, vectors, labels, mean_axis=mean)
        assert body.labels == ("a", "b", "c")
        assert len(body.dropped) == 6
        assert all("rigid motion" in text for text in body.dropped)
        np.testing.assert_allclose(body.eigenvalues, modes.eigenvalues, rtol=1e-9)
    with pytest.raises(InputError, match="no vector deforms the body"):
        reduce_body(brick_beam, vectors[:, :6], labels[:6], mean_axis=True)


def test_bad_input_is_named(brick_beam):
    fixed = brick_beam.node_groups["clamp"]
    vectors = np.ones((3 * brick_beam.node_count, 2))
    with pytest.raises(InputError, match="2\\) with 1 labels"):
        reduce_body(brick_beam, vectors, ["a"], mean_axis=True)
    with pytest.raises(InputError, match="moves what is held"):
        reduce_body(brick_beam, vectors, ["a", "b"], fixed_nodes=fixed, mean_axis=True)
    with pytest.raises(InputError, match="origin"):
        reduce_body(brick_beam, vectors, ["a", "b"], origin=(0, 0, np.nan), mean_axis=True)


def test_complex_beam_of_the_thesis(mbsim_data):
    from heavylift.preprocess.finite_elements.exchange import read_four_files

    data = read_four_files(
        mbsim_data / "complex_beam", length_unit=1e-3, mass_factor=1e-9, stiffness_factor=1e-3
    )
    # "Deformable bodies ... sliding contacts" (2014), table 5.1: ABAQUS; 5 digits are printed
    modes = eigenmodes(data.model, 5)
    np.testing.assert_allclose(modes.frequencies, [534.37, 1071.7, 2271.4, 3099.5, 6346.2], rtol=2e-5)
    assert modes.rigid_count == 0
    body = reduce_body(data.model, data.modes, [f"stored mode {k + 1}" for k in range(5)], mean_axis=False)
    np.testing.assert_allclose(body.frequencies, [534.437, 1071.747, 2271.472, 3099.504, 6346.244], atol=6e-4)
    assert body.labels[0] == "stored mode 1"
    assert np.all(body.frequencies >= modes.frequencies)


def test_sliding_beam_of_the_thesis(mbsim_data):
    from heavylift.preprocess.finite_elements.exchange import read_four_files

    data = read_four_files(
        mbsim_data / "sliding_beam", length_unit=1e-3, mass_factor=1e3, stiffness_factor=1e3
    )
    modes = eigenmodes(data.model, 3)
    assert modes.frequencies[0] == pytest.approx(0.726, abs=5e-4)
    body = reduce_body(data.model, data.modes, [f"mode {k + 1}" for k in range(100)], mean_axis=False)
    # four digits of a stored mode: a thousandth of its energy is noise in stiff directions
    assert modes.frequencies[0] <= body.frequencies[0] < 1.006 * modes.frequencies[0]
    free = reduce_body(data.model, data.modes, [f"mode {k + 1}" for k in range(100)], mean_axis=True)
    assert np.abs(free.integrals.modal_translation).max() < 1e-12
