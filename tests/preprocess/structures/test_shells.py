"""Plates: patch tests, rigid motions of warped and offset elements, exact bending, masses."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.structure import Shells, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)

# MacNeal and Harder, Finite Elem. Anal. Des. 1 (1985) 3: rectangle with four inner nodes
PATCH = np.array(
    [[0, 0], [0.24, 0], [0.24, 0.12], [0, 0.12], [0.04, 0.02], [0.18, 0.03], [0.16, 0.08], [0.08, 0.08]]
)
QUADS = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]])
TRIANGLES = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])


def rigid_motions(model):
    """Six rigid motions of all degrees of freedom, shape (N, 6)."""
    n = model.node_count
    motions = np.zeros((model.dof_count, 6))
    for k in range(3):
        axis = np.eye(3)[k]
        motions[k : 3 * n : 3, k] = 1.0
        motions[: 3 * n, 3 + k] = np.cross(axis, model.nodes).ravel()
        motions[3 * n + k :: 3, 3 + k] = 1.0
    return motions


@pytest.mark.parametrize("elements", [QUADS, TRIANGLES], ids=["quadrilaterals", "triangles"])
@pytest.mark.parametrize("sort", ["membrane", "bending"])
def test_patch_of_distorted_elements_is_exact(elements, sort):
    """Linear in-plane motion, and constant curvature, of the edge pass to inner nodes without any error."""
    flat = np.column_stack([PATCH, np.zeros(8)])
    model = assemble_structure(Structure(flat @ TURN, shells=(Shells("p", elements, STEEL, 0.001),)))
    x, y = PATCH.T
    u, theta = np.zeros((8, 3)), np.zeros((8, 3))
    if sort == "membrane":
        u[:, 0], u[:, 1] = 1e-3 * (x + 0.5 * y), 1e-3 * (y + 0.5 * x)
    else:
        u[:, 2] = 0.5e-3 * (x**2 + x * y + y**2)
        theta[:, 0], theta[:, 1] = 0.5e-3 * (x + 2.0 * y), -0.5e-3 * (2.0 * x + y)
    exact = np.concatenate([(u @ TURN).ravel(), (theta @ TURN).ravel()])
    inner = np.concatenate([np.arange(12, 24), np.arange(36, 48)])
    outer = np.setdiff1d(np.arange(48), inner)
    K = model.stiffness.toarray()
    found = np.linalg.solve(K[np.ix_(inner, inner)], -K[np.ix_(inner, outer)] @ exact[outer])
    np.testing.assert_allclose(found, exact[inner], atol=1e-9 * np.abs(exact).max())
    # energy of the constant strain: (1, 1, 1) 1e-3, and curvatures 1e-3 (1, 1, 1) times t^2 / 12
    E, nu, t = 2.1e11, 0.3, 0.001
    strain = 1e-6 * (2.0 + 2.0 * nu + 0.5 * (1.0 - nu)) * E / (1.0 - nu**2)
    energy = 0.24 * 0.12 * t * strain * (1.0 if sort == "membrane" else t**2 / 12.0)
    full = exact.copy()
    full[inner] = found
    assert full @ K @ full == pytest.approx(energy, rel=1e-8)


@pytest.mark.parametrize("width", [4, 3])
def test_warped_and_offset_element_has_its_rigid_motions(width):
    corners = np.array([[0, 0, 0.2], [1.2, 0.1, -0.3], [1.1, 0.9, 0.25], [-0.1, 1.0, -0.1]])[:width]
    shells = Shells("p", np.arange(width)[None], STEEL, 0.05, offset=0.07)
    model = assemble_structure(Structure(corners @ TURN, shells=(shells,)))
    K = model.stiffness.toarray()
    values = np.linalg.eigvalsh(K)
    assert np.abs(K @ rigid_motions(model)).max() < 1e-14 * np.abs(K).max() * 2.0
    # a triangle by itself has one motion more without strain, which any neighbour stops
    assert np.sum(values < 1e-12 * values[-1]) == (6 if width == 4 else 7)


def test_two_triangles_have_no_further_motion():
    corners = np.array([[0, 0, 0.0], [1.2, 0.1, 0], [1.1, 0.9, 0.1], [-0.1, 1.0, 0]])
    shells = Shells("p", np.array([[0, 1, 2], [0, 2, 3]]), STEEL, 0.05)
    values = np.linalg.eigvalsh(assemble_structure(Structure(corners, shells=(shells,))).stiffness.toarray())
    assert np.sum(values < 1e-12 * values[-1]) == 6


@pytest.mark.parametrize("mass", ["lumped", "consistent"])
@pytest.mark.parametrize("width", [4, 3])
def test_mass_of_a_plate_has_its_totals(mass, width):
    """Mass, centre and inertia of an offset plate with non-structural mass; mass matrix and points agree."""
    a, b, t, offset, nsm, n = 2.0, 1.0, 0.1, 0.2, 300.0, 24
    s, r = np.meshgrid(np.linspace(0, a, n + 1), np.linspace(0, b, n + 1), indexing="ij")
    nodes = np.column_stack([s.ravel(), r.ravel(), np.zeros(s.size)])
    i = np.arange(s.size).reshape(s.shape)
    elements = np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], -1).reshape(-1, 4)
    if width == 3:
        elements = np.concatenate([elements[:, [0, 1, 2]], elements[:, [0, 2, 3]]])
    shells = Shells("p", elements, STEEL, t, offset=offset, nonstructural_mass=nsm)
    model = assemble_structure(Structure(nodes, shells=(shells,)), mass=mass)
    R = rigid_motions(model)
    M = R.T @ (model.mass @ R)
    plate = 7850.0 * t * a * b
    total = plate + nsm * a * b
    second = total * b**2 / 3.0
    # lumps at the nodes have 1 + 1/(2 n^2) of the second moment of a line about its end
    lump = 1.0 + 0.5 / n**2 if mass == "lumped" else 1.0
    assert model.total_mass == pytest.approx(total, rel=1e-12)
    assert M[0, 0] == pytest.approx(total, rel=1e-12)
    assert M[0, 4] == pytest.approx(total * offset, rel=1e-12)
    assert M[1, 5] == pytest.approx(total * a / 2.0, rel=1e-12)
    assert M[3, 3] == pytest.approx(
        second * lump + plate * t**2 / 12.0 + total * offset**2, rel=1e-9 if mass == "consistent" else 2e-3
    )
    points = model.points
    moved = (points.operator @ R).reshape(-1, 3, 6)
    spun = np.cross(np.eye(3)[None], points.positions[:, None])
    np.testing.assert_allclose(moved[:, :, 3:], spun.transpose(0, 2, 1), atol=1e-12)


def test_consistent_mass_of_a_rectangle_is_the_closed_one():
    """Bilinear N^T N of a rectangle: A/36 times (4, 2, 1, 2) from one node to the others."""
    nodes = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=float)
    t = 0.1
    structure = Structure(nodes, shells=(Shells("p", np.array([[0, 1, 2, 3]]), STEEL, t),))
    M = assemble_structure(structure, mass="consistent").mass.toarray()
    share = np.array([4, 2, 1, 2]) / 36.0 * 2.0 * 7850.0 * t
    np.testing.assert_allclose(M[0, [0, 3, 6, 9]], share, rtol=1e-12)
    np.testing.assert_allclose(M[12, [12, 15, 18, 21]], share * t**2 / 12.0, rtol=1e-12)
    np.testing.assert_allclose(M[13, [13, 16, 19, 22]], share * t**2 / 12.0, rtol=1e-12)
    assert np.abs(M[14]).max() == 0.0


def test_a_membrane_has_no_rotations_and_no_thickness_is_refused():
    nodes = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=float)
    corners = np.array([[0, 1, 2, 3]])
    with pytest.raises(InputError, match="nothing holds 4 nodes"):
        assemble_structure(Structure(nodes, shells=(Shells("web", corners, STEEL, 0.01, bends=False),)))
    for thickness in (0.0, -0.01, np.nan):
        with pytest.raises(InputError, match=r"plate 1 of web at .*positive thickness"):
            assemble_structure(Structure(nodes, shells=(Shells("web", corners, STEEL, thickness),)))


@pytest.mark.parametrize("width", [4, 3])
def test_stiffness_does_not_depend_on_the_first_node(width):
    corners = np.array([[0, 0, 0.1], [1.2, 0.1, -0.1], [1.1, 0.9, 0.2], [-0.1, 1.0, -0.1]])[:width]
    found = []
    for k in range(width):
        shells = Shells("p", np.roll(np.arange(width), k)[None], STEEL, 0.05, offset=0.02)
        found.append(assemble_structure(Structure(corners, shells=(shells,))).stiffness.toarray())
    for other in found[1:]:
        np.testing.assert_allclose(other, found[0], atol=1e-9 * np.abs(found[0]).max())


@pytest.mark.parametrize("width", [4, 3])
@pytest.mark.parametrize(("factor", "shear"), [(1.0, 5.0 / 6.0), (1.0, 0.0), (2.5, 0.5)])
def test_a_strip_bends_and_shears_as_a_beam_does(width, factor, shear):
    """F L^3 / (3 E I) + F L / (k G A) at nu = 0, with factors of bending and shear; 0 is none of its flexibility."""
    material = Material(2.1e11, 0.0, 7850.0)
    L, b, t, n = 1.0, 0.1, 0.3, 24
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, L, n + 1), [0.0, b], indexing="ij"))
    i = np.arange(x.size).reshape(n + 1, 2)
    elements = np.stack([i[:-1, 0], i[1:, 0], i[1:, 1], i[:-1, 1]], -1)
    if width == 3:
        elements = np.concatenate([elements[:, [0, 1, 2]], elements[:, [0, 2, 3]]])
    shells = Shells("p", elements, material, t, bending_factor=factor, shear_factor=shear)
    model = assemble_structure(Structure(np.column_stack([x, y, 0 * x]), shells=(shells,)))
    N = x.size
    load = np.zeros(model.dof_count)
    load[3 * i[-1] + 2] = 500.0
    held = np.concatenate([3 * i[0] + k for k in range(3)] + [3 * N + 3 * i[0] + k for k in range(3)])
    free = np.setdiff1d(np.arange(model.dof_count), held)
    K = model.stiffness.toarray()[np.ix_(free, free)]
    u = np.zeros(model.dof_count)
    u[free] = np.linalg.solve(K, load[free])
    bent = 1000.0 * L**3 / (3.0 * 2.1e11 * factor * b * t**3 / 12.0)
    sheared = 1000.0 * L / (shear * 1.05e11 * b * t) if shear else 0.0
    # triangles add a tenth of the square of their longest edge to that of the thickness, in the shear
    stabilised = 1.0 + 0.1 * ((L / n) ** 2 + b**2) / t**2 if width == 3 else 1.0
    assert u[3 * i[-1, 0] + 2] == pytest.approx(bent + sheared * stabilised, rel=4e-3)
