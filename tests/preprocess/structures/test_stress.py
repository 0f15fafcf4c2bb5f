"""Stress of plates and beams: constant states, bending, common axes, no averages across jumps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.stress import beam_stress, shell_stress
from heavylift.preprocess.structures.structure import Beams, Shells, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)
E, NU = 2.1e11, 0.3
QUADS = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]])
PATCH = np.array([[0, 0], [2.4, 0], [2.4, 1.2], [0, 1.2], [0.4, 0.2], [1.8, 0.3], [1.6, 0.8], [0.8, 0.8]])


@pytest.mark.parametrize(
    "elements", [QUADS, np.concatenate([QUADS[:, :3], QUADS[:, [0, 2, 3]]])], ids=["quads", "triangles"]
)
@pytest.mark.parametrize("at", ["nodes", "centres"])
def test_constant_strain_and_curvature_have_their_stress_in_axes_of_the_structure(elements, at):
    """In a plane that is turned about y, with an offset: axis 1 of the stress is the x axis laid into it."""
    a = np.radians(35.0)
    plane = np.array(
        [[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]]
    )  # rows: axes 1, 2, normal
    local = np.column_stack([PATCH, np.zeros(8)])
    # elements start anywhere: their own axes differ
    rolled = np.array([np.roll(row, k) for k, row in enumerate(elements)])
    shells = Shells("p", rolled, STEEL, 0.02, offset=0.03)
    structure = Structure(local @ plane, shells=(shells,))
    model = assemble_structure(structure)
    x, y = PATCH.T
    e, k = np.array([1e-4, -2e-4, 3e-4]), np.array([2e-3, 1e-3, -1e-3])
    theta = np.column_stack(
        [-(k[1] * y + 0.5 * k[2] * x), k[0] * x + 0.5 * k[2] * y, np.zeros(8)]
    )  # beta = (ty, -tx)
    w = -(0.5 * k[0] * x**2 + 0.5 * k[1] * y**2 + 0.5 * k[2] * x * y)
    # the strain of the mid-surface, 0.03 above the nodes, is e: that of the nodes is less by 0.03 k
    n = e - 0.03 * k
    u = np.column_stack([n[0] * x + 0.5 * n[2] * y, n[1] * y + 0.5 * n[2] * x, w])
    full = np.concatenate([(u @ plane).ravel(), (theta @ plane).ravel()])
    found = shell_stress(structure, shells, model, at=at)
    D = E / (1 - NU**2) * np.array([[1, NU, 0], [NU, 1, 0], [0, 0, 0.5 * (1 - NU)]])
    membrane = (found.membrane @ full).reshape(-1, 3)
    bending = (found.bending @ full).reshape(-1, 3)
    np.testing.assert_allclose(membrane, np.tile(D @ e, (len(membrane), 1)), rtol=1e-8)
    np.testing.assert_allclose(bending, np.tile(0.01 * D @ k, (len(bending), 1)), rtol=1e-8)
    assert len(membrane) == (8 if at == "nodes" else len(elements))
    np.testing.assert_allclose((found.positions @ plane.T)[:, 2], 0.03, atol=1e-12)


@pytest.mark.parametrize("n", [2, 8])
def test_le2_bent_arc_has_its_surface_stress(n):
    """NAFEMS LE2, case 1: arc of 30 degrees, R 1 m, t 10 mm, edge moment 1 kN m/m: 6 M / t^2 = 60 MPa outside."""
    angle, z = (
        x.ravel() for x in np.meshgrid(np.linspace(-15, 15, n + 1), np.linspace(0, 0.5, n + 1), indexing="ij")
    )
    a = np.radians(angle)
    nodes = np.column_stack([np.sin(a), np.cos(a), -z])
    i = np.arange(len(a)).reshape(n + 1, n + 1)
    quads = np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], -1).reshape(-1, 4)
    shells = Shells("p", quads, STEEL, 0.01)
    structure = Structure(nodes, shells=(shells,))
    model = assemble_structure(structure)
    N = len(a)
    load = np.zeros(model.dof_count)
    loaded = i[-1]
    share = np.full(n + 1, 1000.0 * 0.5 / n)
    share[[0, -1]] *= 0.5
    load[3 * N + 3 * loaded + 2] = share  # about z
    held = [3 * i[0] + k for k in range(3)] + [3 * N + 3 * i[0] + k for k in range(3)]
    held += [3 * np.arange(N) + 2, 3 * N + 3 * np.arange(N), 3 * N + 3 * np.arange(N) + 1]  # plane strain
    free = np.setdiff1d(np.arange(model.dof_count), np.concatenate(held))
    u = np.zeros(model.dof_count)
    u[free] = spsolve(model.stiffness[free][:, free].tocsc(), load[free])
    stress = shell_stress(structure, shells, model)
    membrane, bending = ((matrix @ u).reshape(-1, 3) for matrix in (stress.membrane, stress.bending))
    outward = np.sign(stress.axes[:, 2, 1])
    # x laid into the plate runs along the arc
    np.testing.assert_allclose(outward * bending[:, 0], -60e6, rtol=1e-4)
    assert np.abs(membrane[:, 0]).max() < 1e-3 * 60e6


def test_no_average_across_thickness_edges_or_turned_normals():
    """A row of plates: equal, thicker, folded by 90 degrees, and with the normal the other way."""
    x = np.array([0, 1, 2, 3, 3, 3.0])
    z = np.array([0, 0, 0, 0, 1, 2.0])
    nodes = np.concatenate([np.column_stack([x, np.full(6, y), z]) for y in (0.0, 1.0)])
    quads = np.array([[k, k + 1, k + 7, k + 6] for k in range(5)])
    quads[4] = quads[4][::-1]
    thickness = np.array([0.01, 0.01, 0.02, 0.02, 0.02])
    shells = Shells("p", quads, STEEL, thickness)
    structure = Structure(nodes, shells=(shells,))
    found = shell_stress(structure, shells, assemble_structure(structure))
    # along one edge: ends once, between equal plates once, everywhere else twice
    count = np.bincount(found.nodes, minlength=12)
    assert count.tolist() == [1, 1, 2, 2, 2, 1] * 2
    assert sorted(found.thickness[found.nodes == 2]) == [0.01, 0.02]


def test_beams_have_the_stress_of_bending_theory_at_their_corners():
    """Cantilever of an angle: N/A, unsymmetric bending by tip forces, mean shear in the web, forces on sections."""
    section = profile("angle", height=0.2, thickness=0.01, width=0.09, flange_thickness=0.014).section
    L, F = 2.0, np.array([1000.0, 200.0, -300.0])
    beams = Beams("b", np.array([[0, 1], [1, 2]]), STEEL, section, np.array([0, 1.0, 0]))
    structure = Structure(np.array([[0, 0, 0], [0.5 * L, 0, 0], [L, 0, 0]]), beams=(beams,))
    model = assemble_structure(structure)
    load = np.zeros(18)
    load[6:9] = F
    free = np.concatenate([np.arange(3, 9), np.arange(12, 18)])
    u = np.zeros(18)
    u[free] = np.linalg.solve(model.stiffness.toarray()[np.ix_(free, free)], load[free])
    found = beam_stress(structure, beams, model)
    forces = (found.forces @ u).reshape(2, 2, 6)
    for beam, end, x in ((0, 0, 0.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 2.0)):
        arm = L - x
        np.testing.assert_allclose(forces[beam, end], [*F, 0, -F[2] * arm, F[1] * arm], atol=1e-6 * 600)
    I = np.array([[section.second_moment_1, section.product], [section.product, section.second_moment_2]])
    x, y, z = found.positions.T
    # strain e - y v'' - z w'' with E I (v'', w'') = (F_y, F_z)(L - x)
    bent = np.linalg.solve(E * I, F[1:, None] * (L - x))
    expected = F[0] / section.area - E * (y * bent[0] + z * bent[1])
    np.testing.assert_allclose(found.normal @ u, expected, rtol=1e-8, atol=1.0)
    np.testing.assert_allclose(found.shear @ u, F[1] / section.shear_area_1, rtol=1e-8)
    assert np.ptp(found.normal @ u) > 1e7
