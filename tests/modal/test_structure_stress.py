"""Stress of plates and beams at points: a clamped plate, a stiffened cantilever, rigid motions, solids among plates."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from heavylift.modal.flexibility import rigid_motions
from heavylift.modal.stress import stress_modes, von_mises
from heavylift.modal.stress_history import stress_at_records
from heavylift.modal.stress_points import largest_at_nodes
from heavylift.modal.structure_stress import structure_points
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.sections import BeamSection
from heavylift.preprocess.structures.structure import Beams, RigidLink, Shells, Solids, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)
TOP, BOTTOM, MEMBRANE, BENDING = range(4)


def grid(nx, ny):
    s, t = np.meshgrid(np.linspace(0.0, 1.0, nx + 1), np.linspace(0.0, 1.0, ny + 1), indexing="ij")
    index = np.arange(s.size).reshape(s.shape)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return np.column_stack([s.ravel(), t.ravel()]), quads.reshape(-1, 4)


def solved(model, held, load):
    free = np.setdiff1d(np.arange(model.dof_count), np.union1d(held, model.fixed_dofs))
    u = np.zeros(model.dof_count)
    u[free] = splu(model.stiffness[free][:, free].tocsc()).solve(load[free])
    return u


def all_dofs(model, nodes):
    return np.concatenate(
        [3 * nodes + k for k in range(3)] + [model.rotation_dofs[nodes] + k for k in range(3)]
    )


def at(points, u):
    """Layers (m, layers, components) and von Mises stress (m, sides) of displacements."""
    layers, mises = stress_at_records(points, u[:, np.newaxis], np.ones((1, 1)))
    return layers[0], mises[0]


def clamped_plate(n):
    """Moments of a clamped square plate under pressure over p a^2: in its middle, and in the middle of an edge."""
    a, t, pressure = 1.0, 0.01, 1.0e4
    p, quads = grid(n, n)
    nodes = np.column_stack([a * p, np.zeros(len(p))])
    model = assemble_structure(Structure(nodes, shells=(Shells("plate", quads, STEEL, t),)))
    edge = np.flatnonzero((p == 0.0).any(axis=1) | (p == 1.0).any(axis=1))
    load = np.zeros(model.dof_count)
    np.add.at(load, 3 * quads.ravel() + 2, -pressure * (a / n) ** 2 / 4.0)
    points, _ = structure_points(model)
    layers, _ = at(points, solved(model, all_dofs(model, edge), load))
    moment = layers[:, 1, 0] * t**2 / 6.0 / (pressure * a**2)
    places = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.0]])
    return [float(moment[(points.positions == place).all(axis=1)][0]) for place in places]


def test_a_clamped_plate_has_the_moments_of_its_table():
    # Timoshenko & Woinowsky-Krieger, Theory of Plates and Shells, table 35: 0.0231 p a^2 in the middle, where the top
    # is pressed, -0.0513 p a^2 in the middle of an edge. There the stress of an element is that of its centre, half an
    # element away: an error of first order
    coarse, fine = clamped_plate(16), clamped_plate(32)
    assert fine[0] == pytest.approx(-0.0231, rel=0.015)
    errors = [0.0513 - moments[1] for moments in (coarse, fine)]
    assert 1.7 < errors[0] / errors[1] < 2.3
    assert 2.0 * fine[1] - coarse[1] == pytest.approx(0.0513, rel=0.025)


def stiffened(nx=24):
    """A strip of 2 m x 0.2 m x 10 mm with a flat bar of 80 x 10 mm below its middle; constants of the section."""
    L, b, t, h, w = 2.0, 0.2, 0.01, 0.08, 0.01
    p, quads = grid(nx, 4)
    nodes = np.column_stack([L * p[:, 0], b * (p[:, 1] - 0.5), np.zeros(len(p))])
    line = np.flatnonzero(p[:, 1] == 0.5)
    offset = np.array([0.0, 0.0, -0.5 * (t + h)])
    bar = BeamSection(
        w * h, w * h**3 / 12.0, h * w**3 / 12.0, h * w**3 / 3.0,
        corners=np.array([[0.5 * h, 0.5 * w], [0.5 * h, -0.5 * w], [-0.5 * h, -0.5 * w], [-0.5 * h, 0.5 * w]]),
    )  # fmt: skip
    structure = Structure(
        nodes,
        shells=(Shells("strip", quads, Material(2.1e11, 0.0, 7850.0), t),),
        beams=(
            Beams(
                "bar", np.column_stack([line[:-1], line[1:]]), Material(2.1e11, 0.0, 7850.0), bar,
                np.array([0.0, 0.0, 1.0]), offset, offset,
            ),
        ),
    )  # fmt: skip
    area = b * t + w * h
    centroid = w * h * offset[2] / area
    second = b * t**3 / 12.0 + b * t * centroid**2 + w * h**3 / 12.0 + w * h * (offset[2] - centroid) ** 2
    return assemble_structure(structure), centroid, second, L


def test_a_stiffened_cantilever_has_m_y_over_i_at_the_corners_and_in_its_plate():
    model, centroid, second, L = stiffened()
    x = model.nodes[:, 0]
    load = np.zeros(model.dof_count)
    tip = np.flatnonzero(x == L)
    load[3 * tip + 2] = -1000.0 / len(tip)
    u = solved(model, all_dofs(model, np.flatnonzero(x == 0.0)), load)
    plate, centres, bar = structure_points(model)
    assert (plate.name, centres.name, bar.name) == ("strip", "strip", "bar")
    layers, mises = at(bar, u)
    np.testing.assert_array_equal(mises[:, 0], np.abs(layers[:, 0, 0]))
    # the normal force is constant along each bar, so the mean of both ends is the stress of its middle
    x, _, z = bar.positions.reshape(-1, 2, 4, 3).mean(axis=1).reshape(-1, 3).T
    found = layers[:, 0, 0].reshape(-1, 2, 4).mean(axis=1).ravel()
    expected = 1000.0 * (L - x) * (z - centroid) / second
    away = (x > 0.4) & (x < 1.6)
    assert z.min() == pytest.approx(-0.085)
    np.testing.assert_allclose(found[away], expected[away], atol=0.005 * np.abs(expected).max())
    layers, _ = at(centres, u)
    away = (centres.positions[:, 0] > 0.4) & (centres.positions[:, 0] < 1.6)
    expected = 1000.0 * (L - centres.positions[:, 0]) * (0.0 - centroid) / second
    np.testing.assert_allclose(layers[away, 0, 0], expected[away], rtol=0.01)


def test_rigid_motions_have_no_stress():
    model, *_ = stiffened(6)
    motions = rigid_motions(model.nodes, model.rotating)
    for points in structure_points(model):
        stress = points.columns(motions, slice(None))
        assert np.abs(stress).max() < 1e-9 * STEEL.young_modulus


def test_solids_among_plates_have_the_stress_of_their_nodes():
    mesh = mesh_blocks([Box("b", (0, 0, 0), (1.0, 0.5, 0.5))], element_type="hex8", size=0.25)
    top = np.array([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]])
    # the plate has the first nodes, so those of the solid are others than in its own mesh
    structure = Structure(
        np.concatenate([top, mesh.nodes]),
        shells=(Shells("plate", np.array([[0, 1, 2, 3]]), STEEL, 0.01),),
        solids=(Solids("block", mesh.elements + 4, "hex8", STEEL),),
        links=(RigidLink(0, np.array([4, 5, 6])),),
    )
    model = assemble_structure(structure)
    (block,) = structure_points(model, ["block"])
    u = np.random.default_rng(7).standard_normal(model.dof_count)
    expected = stress_modes(mesh, STEEL, u[: 3 * model.node_count].reshape(1, -1, 3)[:, 4:])[0]
    np.testing.assert_array_equal(block.nodes, 4 + np.arange(mesh.node_count))
    layers, _ = at(block, u)
    np.testing.assert_allclose(layers[:, 0], expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())
    # at the nodes of the body the largest of all that is there
    found = largest_at_nodes([block], [at(block, u)[1]], model.node_count)
    assert np.isnan(found[:4]).all()
    np.testing.assert_allclose(found[4:], von_mises(expected), rtol=1e-5)
