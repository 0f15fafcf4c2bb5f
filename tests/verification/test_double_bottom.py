"""A double bottom against an independent program: mass, natural frequencies, and a lift at four lines.

Numbers: a prototype in NumPy and SciPy with elements of the same formulation, other code and another eigensolver.
"""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal import interfaces
from heavylift.modal.bases import eigenmode_basis, static_vectors
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility, apply_mass
from heavylift.modal.reduction import reduce_body
from heavylift.preprocess.structures.assemble import assemble_structure
from tests.verification.double_bottom import double_bottom

LIFTED = ((2.0, -3.0), (10.0, -3.0), (10.0, 3.0), (2.0, 3.0))
FREQUENCIES = {
    1: (44.124, 61.125, 79.19, 88.706, 91.07, 91.222, 92.203, 92.611, 93.037, 93.299),
    3: (44.086, 60.684, 78.31, 79.421, 79.439, 79.879, 79.957, 80.107, 80.213, 80.492),
}
"""Hz, free, by elements in 0.5 m: twist, bending along, bending across, then panels."""


def free_body(n):
    model = assemble_structure(double_bottom(n))
    return model, Flexibility(model)


@pytest.fixture(scope="module")
def coarse():
    return free_body(1)


def check_frequencies(body, n):
    found = eigenmodes(body.model, 10, flexibility=body)
    np.testing.assert_allclose(found.frequencies, FREQUENCIES[n], rtol=2e-5)
    assert found.rigid_count == 6


def test_mass_and_centre(coarse):
    model, _ = coarse
    assert model.node_count == 1815
    assert model.total_mass == pytest.approx(119544.1217677, abs=1e-6)
    np.testing.assert_allclose(model.centre_of_mass, [6.00208503, 0.00300779737, 0.976452553], rtol=1e-8)


def test_natural_frequencies(coarse):
    check_frequencies(coarse[1], 1)


@pytest.mark.slow
def test_natural_frequencies_of_a_hundred_thousand_freedoms():
    model, body = free_body(3)
    assert model.dof_count == 107754
    check_frequencies(body, 3)


def test_lift_at_four_lines_by_attachment_modes_alone(coarse):
    """Weight needs no vector of its own, and interfaces at the lines of girders and floors carry the rest."""
    model, body = coarse
    groups, columns = [], []
    on_top = np.abs(model.nodes[:, 2] - 2.0) < 1e-9
    for x, y in LIFTED:
        arms = np.abs(model.nodes[:, :2] - [x, y])
        lines = on_top & (arms.min(axis=1) < 1e-9) & (arms.max(axis=1) < 0.5 + 1e-9)
        nodes = np.flatnonzero(lines)
        found = interfaces.fit(model, (x, y, 2.0), nodes, interfaces.group_weights(model, nodes))
        groups.append(found)
        columns.append(interfaces.attachment_loads(model, found, f"({x}, {y})"))
    basis = eigenmode_basis(eigenmodes(model, 3, flexibility=body))
    for loads in columns:
        basis += static_vectors(body, loads)
    reduced = reduce_body(model, basis.vectors, basis.labels, mean_axis=True)
    assert reduced.mode_count == 3 + 24
    places = [interfaces.interface_of(reduced, found, np.zeros(3), np.ones(6)) for found in groups]
    # unknowns: four forces, heave, roll and pitch of the frame; the places do not move up or down
    up = np.stack([place.displacement[:, 2] for place in places])  # (4, nf)
    rigid = np.stack([[1.0, place.point[1], -place.point[0]] for place in places])
    saddle = np.block([[(up / reduced.eigenvalues) @ up.T, rigid], [rigid.T, np.zeros((3, 3))]])
    weight = np.zeros((model.dof_count, 1))
    weight[2 : 3 * model.node_count : 3] = -9.80665
    pull = apply_mass(model.mass, weight)[:, 0]
    lift = np.zeros((model.dof_count, 3))  # heave, roll and pitch of the body
    lift[2 : 3 * model.node_count : 3] = np.column_stack(
        [np.ones(model.node_count), model.nodes[:, 1], -model.nodes[:, 0]]
    )
    lift[3 * model.node_count :: 3, 1] = lift[3 * model.node_count + 1 :: 3, 2] = 1.0
    total = pull @ lift
    solved = np.linalg.solve(saddle, np.concatenate([np.zeros(4), -total]))
    forces, frame = solved[:4], solved[4:]
    np.testing.assert_allclose(1e-3 * forces, [292.634, 292.942, 293.527, 293.224], rtol=1e-5)
    q = up.T @ forces / reduced.eigenvalues
    moved = reduced.displacement(q)[:, 2] + lift[2 : 3 * model.node_count : 3] @ frame
    for place, expected in (((6, 0, 2), -0.1214), ((6, -5, 2), -0.1065), ((0, -5, 2), -0.0336)):
        node = np.argmin(np.linalg.norm(model.nodes - place, axis=1))
        assert 1e3 * moved[node] == pytest.approx(expected, abs=6e-5)
    assert 0.5 * q @ (reduced.eigenvalues * q) == pytest.approx(40.6103, rel=1e-4)
