"""A double-bottom block of 119.5 t, 12 x 10 x 2 m, from its deck: mass, frequencies, lift, stress, buckling.

The numbers are of an independent program (NumPy and SciPy alone) on the same deck with 0.25 m elements; the deck is
beside the other public data of the project.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator, eigs

from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.preprocess.finite_elements.deck_structure import structure_of
from heavylift.preprocess.finite_elements.geometry import read_deck
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.geometric import geometric_stiffness
from heavylift.preprocess.structures.stress import shell_stress

pytestmark = pytest.mark.slow

STEP = 0.25  # of its mesh [m]


@pytest.fixture(scope="module")
def block():
    folder = os.environ.get("HEAVYLIFT_BLOCK_MODELS", "")
    path = Path(folder) / "block.bdf"
    if not path.is_file():
        pytest.skip(f"no reference block at {path}; set HEAVYLIFT_BLOCK_MODELS")
    structure = structure_of(read_deck(path))
    model = assemble_structure(structure)
    assert model.node_count == 7791
    return structure, model, Flexibility(model)


def test_mass_centre_and_inertia(block):
    _, model, _ = block
    points = model.points
    total = points.masses.sum()
    centre = points.masses @ points.positions / total
    arms = points.positions - centre
    second = np.einsum("p,pi,pj->ij", points.masses, arms, arms)
    inertia = np.linalg.eigvalsh(np.trace(second) * np.eye(3) - second)
    assert total == pytest.approx(119544.1217677, rel=1e-9)
    assert centre == pytest.approx([6.00208503, 0.00300779, 0.97645285], abs=1e-6)
    assert inertia == pytest.approx([1.15623e6, 1.61015e6, 2.59812e6], rel=1e-5)


def test_free_frequencies(block):
    """Twist, bending along and across, then a crowd of panels."""
    _, model, flexibility = block
    found = eigenmodes(model, 10, flexibility=flexibility).frequencies
    expected = [44.034, 60.806, 78.650, 81.236, 81.261, 81.723, 81.877, 82.112, 82.171, 82.496]
    np.testing.assert_allclose(found, expected, rtol=1e-4)


def test_lift_at_four_points(block):
    """Held along z by means over lines of girder and floor, 0.5 m to each side; forces, deflections, energy, stress."""
    structure, model, flexibility = block
    nodes = model.nodes

    def node(*place):
        return int(np.argmin(np.linalg.norm(nodes - place, axis=1)))

    points = model.points
    weight = points.operator.T @ (
        np.repeat(points.masses, 3) * np.tile([0.0, 0.0, -9.80665], len(points.masses))
    )
    holds = np.zeros((model.dof_count, 7))
    for k, (x, y) in enumerate([(2, -3), (10, -3), (10, 3), (2, 3)]):
        # trapezoids along both lines, a third of them in all at the crossing
        shares: dict[int, float] = {}
        for axis in (0, 1):
            for step in range(-2, 3):
                place = np.array([x, y, 2.0])
                place[axis] += step * STEP
                at = node(*place)
                shares[at] = shares.get(at, 0.0) + (0.5 if abs(step) == 2 else 1.0) / 8.0
        for at, share in shares.items():
            holds[3 * at + 2, k] = share
            for column, axis in {0: ((4, 0), (5, 1)), 1: ((6, 1),)}.get(
                k, ()
            ):  # along x and y, without forces
                holds[3 * at + axis, column] = share
    R = flexibility.rigid
    moved = np.column_stack([flexibility.solve(column) for column in np.column_stack([weight, holds]).T])
    # what the forces and the rigid motion are: means are zero, forces balance
    A = np.block([[holds.T @ moved[:, 1:], holds.T @ R], [R.T @ holds, np.zeros((6, 6))]])
    solution = np.linalg.solve(A, -np.concatenate([holds.T @ moved[:, 0], R.T @ weight]))
    u = moved[:, 0] + moved[:, 1:] @ solution[:7] + R @ solution[7:]
    np.testing.assert_allclose(solution[:4], 1e3 * np.array([292.635, 292.941, 293.528, 293.223]), rtol=1e-5)
    sunk = [1e3 * u[3 * node(*place) + 2] for place in ((6, 0, 2), (6, -5, 2), (0, -5, 2), (0, 0, 2))]
    np.testing.assert_allclose(sunk, [-0.1250, -0.1101, -0.0365, -0.0505], atol=1e-4)
    assert 0.5 * u @ (model.stiffness @ u) == pytest.approx(42.75605, rel=1e-5)
    largest = {}
    for shells in structure.shells:
        xx, yy, xy = (shell_stress(structure, shells, model, at="centres").membrane @ u).reshape(-1, 3).T
        largest[shells.name] = 1e-6 * np.sqrt(xx**2 - xx * yy + yy**2 + 3.0 * xy**2).max()
    assert largest["PSHELL 3"] == pytest.approx(7.1, abs=0.05)  # girders
    assert largest["PSHELL 4"] == pytest.approx(7.1, abs=0.05)  # floors

    # lowest buckling factor, of a girder web beside a lift point; two elements a half wave, so within 2 %
    geometric = geometric_stiffness(structure, model, u)
    size = model.stiffness.shape
    softened = LinearOperator(size, matvec=lambda x: -flexibility.solve(geometric @ x), dtype=float)
    start = flexibility.solve(np.random.default_rng(0).normal(size=size[0]))
    highest = eigs(softened, 1, which="LR", v0=start, return_eigenvectors=False, tol=1e-5)
    assert 1.0 / highest.real[0] == pytest.approx(1059.7, rel=0.02)
