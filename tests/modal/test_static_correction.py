"""Static correction: what two modes leave out of the root moment of a cantilever, and loads that strain nothing."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility, apply_mass
from heavylift.modal.static_correction import inertia_fields, static_correction
from heavylift.modal.stress_points import solid_points
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import Material

LENGTH, SIDE, DEPTH = 1.0, 0.02, 0.03
STEEL = Material(2.1e11, 0.0, 7850.0)


@pytest.fixture(scope="module")
def bar():
    mesh = mesh_blocks(
        [Box("bar", (0, 0, 0), (LENGTH, SIDE, DEPTH))],
        element_type="hex8",
        divisions={"x": [80], "y": [2], "z": [2]},
        groups=(OnPlane("root", "x", 0.0), OnPlane("tip", "x", LENGTH)),
    )
    return assemble(mesh, STEEL)


@pytest.fixture(scope="module")
def cantilever(bar):
    """Flexibility, the first bending modes along y, and a tip force of 1 N."""
    flexibility = Flexibility(bar, bar.node_groups["root"])
    modes = eigenmodes(bar, 40, flexibility=flexibility)
    tip = bar.node_groups["tip"]
    force = np.zeros(3 * bar.node_count)
    force[3 * tip + 1] = 1.0 / len(tip)
    along_y = np.abs(force @ modes.shapes) > 1e-3
    return flexibility, modes.shapes[:, along_y], modes.eigenvalues[along_y], force


def root_stress(model, displacements):
    """Axial stress half an element from the clamp at the upper face, by the nodes of the first two layers."""
    x, y, _ = model.nodes.T
    nodes = np.flatnonzero((x < LENGTH / 79) & (y > SIDE - 1e-9))
    columns = solid_points(model.mesh, STEEL, nodes).columns(displacements[:, None], slice(None))
    return float(columns[:, 0, 0, 0].mean())


# of n bending modes the root moment is the sum of 4 (-1)^(k+1) / (beta_k L)^2 times that of the tip force: 1.138,
# 0.956, 1.008 for 1, 2, 5; half an element from the clamp the curvature of a mode is up to 1 % less
@pytest.mark.parametrize(("count", "excess"), [(1, 0.138), (2, -0.044), (5, 0.008)])
def test_root_moment_of_a_cantilever_from_a_few_modes_and_with_its_correction(bar, cantilever, count, excess):
    flexibility, vectors, eigenvalues, force = cantilever
    vectors, eigenvalues = vectors[:, :count], eigenvalues[:count]
    static = flexibility.solve(force)
    exact = root_stress(bar, static)
    assert exact == pytest.approx(-6.0 * (LENGTH - LENGTH / 160) / (DEPTH * SIDE**2), rel=0.01)  # M / W
    modal = vectors @ (vectors.T @ force / eigenvalues)
    assert root_stress(bar, modal) / exact - 1.0 == pytest.approx(excess, abs=0.01)
    correction = static_correction(flexibility, vectors, eigenvalues, force[:, None])
    assert root_stress(bar, modal + correction.shapes[:, 0]) == pytest.approx(exact, rel=1e-9)
    assert 0.0 < correction.missing[0] < 0.04


def test_a_force_at_half_the_first_frequency_is_followed_with_one_mode_and_the_correction(bar, cantilever):
    # the first mode has 1.101 of the root moment; with the correction the rest of its inertia is what is missing, 0.1 %
    flexibility, vectors, eigenvalues, force = cantilever
    whole = static_correction(flexibility, vectors, eigenvalues, force[:, None])
    square = 0.25 * eigenvalues[0]

    def answer(count):
        q = vectors[:, :count].T @ force / (eigenvalues[:count] - square)
        return vectors[:, :count] @ q

    exact = root_stress(bar, answer(len(eigenvalues)) + whole.shapes[:, 0])
    assert root_stress(bar, answer(1)) / exact == pytest.approx(1.101, abs=0.01)
    one = static_correction(flexibility, vectors[:, :1], eigenvalues[:1], force[:, None])
    assert root_stress(bar, answer(1) + one.shapes[:, 0]) / exact == pytest.approx(1.0, abs=0.007)


def test_a_basis_with_the_static_answer_needs_no_correction(bar, cantilever):
    flexibility, _, _, force = cantilever
    static = flexibility.solve(force)
    static /= np.sqrt(static @ apply_mass(bar.mass, static))
    eigenvalue = static @ (bar.stiffness @ static)
    correction = static_correction(flexibility, static[:, None], np.array([eigenvalue]), force[:, None])
    assert not correction.loads.size
    assert correction.missing[0] < 1e-9


def test_a_free_body_is_not_strained_by_fields_that_move_it_rigidly(bar):
    flexibility = Flexibility(bar)
    names, fields = inertia_fields(bar.nodes - bar.nodes.mean(axis=0), free=False)
    forces = apply_mass(bar.mass, fields.reshape(-1, len(names)))
    found = static_correction(flexibility, np.empty((3 * bar.node_count, 0)), np.empty(0), forces)
    moved = dict(zip(names, found.missing, strict=True))
    assert moved["x"] == moved["y"] == moved["z"] == 0.0
    assert moved["xx"] > 0.9
    # antisymmetric parts are rigid rotations: xy and -yx strain the body alike
    names_free, fields_free = inertia_fields(bar.nodes - bar.nodes.mean(axis=0), free=True)
    assert names_free == ("xx", "xy", "xz", "yy", "yz", "zz")
    both = flexibility.solve(forces[:, [names.index("xy"), names.index("yx")]])
    np.testing.assert_allclose(both[:, 0], both[:, 1], atol=1e-9 * np.abs(both).max())
    free = flexibility.solve(apply_mass(bar.mass, fields_free.reshape(-1, 6)))
    np.testing.assert_allclose(free[:, 1], both.sum(axis=1), atol=1e-9 * np.abs(both).max())
