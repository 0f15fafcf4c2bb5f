"""Supports that hold single directions: symmetry planes, sliding edges, and what rigid motions they leave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.modal.bases import craig_bampton, eigenmode_basis
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduction import reduce_body
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.model import Material

STEEL = Material(young_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
SIZE = np.array([1.2, 0.7, 0.4])


def block(lower, divisions):
    mesh = mesh_blocks(
        [Box("block", tuple(lower), tuple(SIZE))],
        element_type="hex8",
        divisions={axis: (count,) for axis, count in zip("xyz", divisions, strict=True)},
    )
    return assemble(mesh, STEEL)


def held(model, directions):
    """The same model with nodes in coordinate planes held across them, e.g. ``{"x": "x"}`` for those at x = 0."""
    dofs = []
    for plane, axes in directions.items():
        nodes = np.flatnonzero(np.abs(model.nodes[:, "xyz".index(plane)]) < 1e-9)
        dofs += [3 * nodes + "xyz".index(axis) for axis in axes]
    return replace(model, fixed_dofs=np.concatenate(dofs))


@pytest.mark.parametrize("divisions", [(3, 2, 2), (8, 5, 3)], ids=["dense", "iterative"])
def test_an_eighth_with_symmetry_planes_has_the_symmetric_modes_of_the_whole(divisions):
    """The whole block on the mirrored mesh, free: each frequency of the eighth is one of it, to rounding."""
    eighth = held(block((0, 0, 0), divisions), {"x": "x", "y": "y", "z": "z"})
    whole = block(-SIZE, [2 * count for count in divisions])
    found = eigenmodes(eighth, 3)
    assert found.rigid_count == 0
    free = eigenmodes(whole, 40).frequencies
    for frequency in found.frequencies:
        assert np.abs(free / frequency - 1.0).min() < 1e-8
    # shapes do not leave their planes
    shapes = found.shapes.reshape(-1, 3, 3)
    for axis in range(3):
        assert not shapes[eighth.nodes[:, axis] == 0.0, axis].any()


@pytest.mark.parametrize(
    ("directions", "left"),
    [
        ({"x": "x"}, 3),
        ({"x": "x", "y": "y"}, 1),
        ({"x": "xyz"}, 0),
        ({"z": "xy"}, 3),
        ({"x": "x", "z": "xz"}, 1),
    ],
)
def test_held_directions_leave_the_rigid_motions_of_mechanics(directions, left):
    model = held(block((0, 0, 0), (4, 3, 2)), directions)
    flexibility = Flexibility(model)
    assert flexibility.rigid_count == left
    np.testing.assert_allclose(model.stiffness @ flexibility.rigid, 0.0, atol=1e-4)  # of 1e11 N/m
    assert not flexibility.rigid[model.fixed_dofs].any()


def test_whole_nodes_held_by_directions_are_clamped_nodes():
    model = block((0, 0, 0), (4, 3, 2))
    clamp = np.flatnonzero(model.nodes[:, 0] == 0.0)
    by_nodes = eigenmodes(model, 5, fixed_nodes=clamp)
    by_directions = eigenmodes(held(model, {"x": "xyz"}), 5)
    np.testing.assert_array_equal(by_nodes.eigenvalues, by_directions.eigenvalues)
    np.testing.assert_array_equal(by_nodes.shapes, by_directions.shapes)


def test_a_bar_between_sliding_planes_stretches_as_in_the_closed_form():
    """Held along x at one end and nothing else, pulled along x: u = F x / (E A), free of bending and contraction."""
    model = held(block((0, 0, 0), (4, 3, 2)), {"x": "x", "y": "y", "z": "z"})
    end = np.flatnonzero(np.abs(model.nodes[:, 0] - SIZE[0]) < 1e-9)
    area, pressure = SIZE[1] * SIZE[2], 1e6
    share = np.zeros(model.node_count)
    y, z = model.nodes[end, 1], model.nodes[end, 2]
    weight = [
        np.where(np.isclose(v % SIZE[k], 0.0) | np.isclose(v, SIZE[k]), 0.5, 1.0) for k, v in ((1, y), (2, z))
    ]
    share[end] = weight[0] * weight[1] * area / 6
    assert share.sum() == pytest.approx(area)
    forces = np.zeros(3 * model.node_count)
    forces[::3] = pressure * share
    u = Flexibility(model).solve(forces).reshape(-1, 3)
    expected = pressure / 2.1e11 * model.nodes * [1.0, -0.3, -0.3]
    np.testing.assert_allclose(u, expected, atol=1e-9 * np.abs(expected).max())


def test_reduced_body_keeps_its_directions_and_refuses_vectors_that_move_them():
    model = held(block((0, 0, 0), (4, 3, 2)), {"x": "x", "y": "y", "z": "z"})
    basis = eigenmode_basis(eigenmodes(model, 4))
    reduced = reduce_body(model, basis.vectors, basis.labels, mean_axis=False)
    np.testing.assert_allclose(reduced.frequencies, eigenmodes(model, 4).frequencies, rtol=1e-10)
    with pytest.raises(InputError, match="moves what is held"):
        reduce_body(model, np.ones((3 * model.node_count, 1)), ["a"], mean_axis=False)
    with pytest.raises(InputError, match="is held and an interface node"):
        craig_bampton(model, np.flatnonzero(model.nodes[:, 0] == 0.0), 2)
