"""Geometric stiffness of plates and beams: Euler's columns, plates, strings, and motions that store nothing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.geometric import geometric_stiffness
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.structure import Beams, Shells, Solids, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)
E, NU = STEEL.young_modulus, STEEL.poisson_ratio
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)


def buckling(K, Kg, count=1):
    """Lowest factors lambda of K phi = -lambda K_g phi."""
    highest = eigh(-Kg, K, eigvals_only=True, subset_by_index=[len(K) - count, len(K) - 1])
    return 1.0 / highest[::-1]


def cantilever(count, length=2.0):
    section = profile("flat", height=0.06, thickness=0.02).section
    nodes = np.column_stack([np.linspace(0.0, length, count + 1), np.zeros((count + 1, 2))]) @ TURN
    elements = np.column_stack([np.arange(count), np.arange(1, count + 1)])
    structure = Structure(nodes, beams=(Beams("b", elements, STEEL, section, np.array([0.0, 1, 0]) @ TURN),))
    model = assemble_structure(structure)
    n = model.node_count
    free = np.setdiff1d(np.arange(model.dof_count), [0, 1, 2, 3 * n, 3 * n + 1, 3 * n + 2])
    return structure, model, free, section


def test_a_column_buckles_in_both_planes():
    """pi^2 E I / (4 L^2) about the weak and the strong axis; slender, so that shear takes 0.01 %."""
    structure, model, free, section = cantilever(8)
    n = model.node_count
    load = np.zeros(model.dof_count)
    load[3 * n - 3 : 3 * n] = [-1.0, 0, 0] @ TURN
    u = np.zeros(model.dof_count)
    K = model.stiffness.toarray()[np.ix_(free, free)]
    u[free] = np.linalg.solve(K, load[free])
    Kg = geometric_stiffness(structure, model, u).toarray()
    np.testing.assert_allclose(Kg, Kg.T, atol=1e-9 * np.abs(Kg).max())
    found = buckling(K, Kg[np.ix_(free, free)], 2)
    I = np.array(
        [section.second_moment_2, 9.0 * section.second_moment_2]
    )  # second half wave of the weak plane, or
    assert section.second_moment_1 == pytest.approx(I[1])  # the strong plane: both nine times the first
    np.testing.assert_allclose(found, np.pi**2 * E * I / 16.0, rtol=2e-3)
    assert found[0] == pytest.approx(np.pi**2 * E * I[0] / 16.0, rel=2e-4)


@pytest.mark.parametrize("width", [4, 3, 2])
def test_tension_stiffens_as_a_string_does(width):
    """A strip under the stress s: transverse motion linear along it stores s A slope^2 L / 2, and a shift nothing."""
    slope, stress = 0.02, 3e6
    if width == 2:
        structure, model, _, section = cantilever(3)
        area, length = section.area, 2.0
    else:
        nodes = np.array([[0, 0, 0.0], [2, 0, 0], [2, 0.5, 0], [0, 0.5, 0], [0.9, 0.2, 0]])
        elements = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
        if width == 4:
            nodes = np.array([[0, 0, 0.0], [2, 0, 0], [2, 0.5, 0], [0, 0.5, 0], [0.9, 0.0, 0], [1.1, 0.5, 0]])
            elements = np.array([[0, 4, 5, 3], [4, 1, 2, 5]])
        area, length = 0.5 * 0.01, 2.0
        structure = Structure(nodes @ TURN, shells=(Shells("p", elements, STEEL, 0.01, offset=0.1),))
        model = assemble_structure(structure)
    n = model.node_count
    at = model.nodes @ TURN.T
    u = np.zeros(model.dof_count)
    strain = stress / E
    u[: 3 * n] = (np.column_stack([at[:, 0], -NU * at[:, 1], np.zeros(n)]) * strain @ TURN).ravel()
    Kg = geometric_stiffness(structure, model, u)
    turn = np.zeros(model.dof_count)  # rigid rotation about axis 2
    turn[: 3 * n] = (np.column_stack([np.zeros(n), np.zeros(n), -at[:, 0]]) * slope @ TURN).ravel()
    turn[3 * n :] = np.tile([0, slope, 0] @ TURN, n)
    # the rotation carries the offset of the plate with it: the mid-surface turns too
    energy = stress * area * length * slope**2
    assert turn @ (Kg @ turn) == pytest.approx(energy, rel=1e-9)
    shift = np.zeros(model.dof_count)
    shift[: 3 * n] = np.tile([1.0, 2.0, 3.0], n)
    assert np.abs(Kg @ shift).max() < 1e-9 * np.abs(Kg).max()


@pytest.mark.parametrize(
    ("ratio", "n", "exact", "independent"),
    [(1.0, 8, 4.0, 4.082), (1.0, 16, 4.0, 4.013), (1.4, 16, 4.4702, 4.489), (2.0, 16, 4.0, 4.015)],
)
def test_simply_supported_plate_buckles_as_a_thin_one(ratio, n, exact, independent):
    """k = sigma 12 (1 - nu^2) b^2 / (pi^2 E t^2) = min (m b/a + a/(m b))^2 (Timoshenko and Gere), from above.

    n elements across; the other numbers are of an independent program.
    """
    t, along = 0.01, round(n * ratio)
    assert exact == pytest.approx(min((m / ratio + ratio / m) ** 2 for m in (1, 2, 3)), rel=1e-4)
    s, r = (
        x.ravel()
        for x in np.meshgrid(np.linspace(0, ratio, along + 1), np.linspace(0, 1, n + 1), indexing="ij")
    )
    i = np.arange(s.size).reshape(along + 1, n + 1)
    quads = np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], -1).reshape(-1, 4)
    structure = Structure(np.column_stack([s, r, 0 * s]), shells=(Shells("p", quads, STEEL, t),))
    model = assemble_structure(structure)
    N = len(s)
    u = np.zeros(model.dof_count)
    u[: 3 * N] = np.column_stack([-s, NU * r, 0 * s]).ravel() / E  # sigma_x = -1
    edge = (s < 1e-9) | (s > ratio - 1e-9) | (r < 1e-9) | (r > 1 - 1e-9)
    bending = np.concatenate(
        [3 * np.arange(N)[~edge] + 2, 3 * N + 3 * np.arange(N), 3 * N + 3 * np.arange(N) + 1]
    )
    K = model.stiffness.toarray()[np.ix_(bending, bending)]
    Kg = geometric_stiffness(structure, model, u).toarray()[np.ix_(bending, bending)]
    k = buckling(K, Kg)[0] * 12.0 * (1.0 - NU**2) / (np.pi**2 * E * t**2)
    assert k == pytest.approx(independent, rel=1e-3)
    assert exact < k < exact * (1.0 + 1.5 / n**2 + 0.001)


def test_displacements_that_do_not_fit_are_refused():
    structure, model, _, _ = cantilever(1)
    for wrong in (np.zeros(6), np.full(12, np.nan)):
        with pytest.raises(InputError, match="12 finite numbers"):
            geometric_stiffness(structure, model, wrong)


def test_solids_of_a_structure_stiffen_as_those_of_a_mesh_do():
    """A bar of bricks between two beams: a rotation stores s A slope^2 L / 2 in it, beams add theirs."""
    x = np.linspace(0, 2, 3)
    nodes = np.array([[a, b, c] for a in x for b, c in ((0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1))])
    bricks = np.array([[k, k + 4, k + 5, k + 1, k + 3, k + 7, k + 6, k + 2] for k in (0, 4)])
    section = profile("round", diameter=0.02).section
    beams = Beams("b", np.array([[0, 4], [4, 8]]), STEEL, section, np.array([0, 0, 1.0]))
    structure = Structure(nodes, beams=(beams,), solids=(Solids("s", bricks, "hex8", STEEL),))
    model = assemble_structure(structure)
    n, strain = model.node_count, 1e-4
    u = np.zeros(model.dof_count)
    u[: 3 * n] = (nodes * strain * [1.0, -NU, -NU]).ravel()
    turn = np.zeros(model.dof_count)
    turn[1 : 3 * n : 3] = nodes[:, 0]
    turn[3 * n + 2 :: 3] = 1.0
    Kg = geometric_stiffness(structure, model, u)
    # across, 1; along, nothing: the brick moves along y only
    assert turn @ (Kg @ turn) == pytest.approx(strain * E * (0.01 + section.area) * 2.0, rel=1e-9)
