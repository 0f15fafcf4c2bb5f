"""Stiffening of modes by inertia and weight: closed forms of beams, full models, blades that turn."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.linalg

from heavylift.modal.bases import eigenmode_basis, place_loads
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduced import ReducedBody
from heavylift.modal.reduction import reduce_body
from heavylift.modal.stiffening import Stiffening
from heavylift.modal.stress_stiffness import inertia_stiffening, stress_stiffness, with_loads
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import FEModel, Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.structure import Beams, Shells, Solids, Structure

SIDE, YOUNG, DENSITY = 0.01, 210e9, 7850.0
BENDING, LINE = YOUNG * SIDE**4 / 12.0, DENSITY * SIDE**2


@cache
def blade(elements: int = 40) -> FEModel:
    """One metre of square steel bar along x; group ``root``."""
    half = 0.5 * SIDE
    mesh = mesh_blocks(
        [Box("blade", (0.0, -half, -half), (1.0, half, half))],
        element_type="hex8",
        divisions={"x": [elements], "y": [2], "z": [2]},
        groups=(OnPlane("root", "x", 0.0),),
    )
    return assemble(mesh, Material(YOUNG, 0.0, DENSITY))


@cache
def stiffened(
    count: int = 10, *, free: bool = False, origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> tuple[ReducedBody, Stiffening]:
    """A blade, held at its root or free."""
    model = blade()
    held = np.empty(0, dtype=np.int64) if free else model.node_groups["root"]
    flexibility = Flexibility(model, held)
    basis = eigenmode_basis(eigenmodes(model, count, flexibility=flexibility))
    reduced = reduce_body(model, basis.vectors, basis.labels, fixed_nodes=held, origin=origin, mean_axis=free)
    return reduced, inertia_stiffening(flexibility, reduced, stress_stiffness(model))


def frequencies(reduced: ReducedBody, stiffening: Stiffening, spin: float) -> np.ndarray:
    """Of small motions [Hz] in a frame that turns about z, with spin softening and Coriolis forces."""
    S = reduced.integrals.mode_mode
    w = np.array([0.0, 0.0, spin])
    K = np.diag(reduced.eigenvalues) + stiffening.of_spin(w) - spin**2 * (S[0, 0] + S[1, 1])
    n = len(K)
    coriolis = 2.0 * spin * (S[0, 1] - S[1, 0])
    values = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-K, coriolis]]))
    return np.sort(values.imag[values.imag > 0.0])[:2] / (2.0 * np.pi)


@pytest.mark.parametrize(
    ("spin", "count", "in_plane", "flap"),
    [
        (25.0, 10, 8.5332, 9.4153),
        (25.0, 4, 8.5362, 9.4180),
        (100.0, 10, 10.457, 19.043),
        (100.0, 20, 10.454, 19.042),
    ],
)
def test_a_blade_that_turns(spin: float, count: int, in_plane: float, flap: float) -> None:
    """Frequencies of an independent prototype, and of a beam in a rotating frame with its axial force."""
    found = frequencies(*stiffened(count), spin)
    np.testing.assert_allclose(found, [in_plane, flap], rtol=1e-3 if count > 4 else 2e-3)


def test_the_first_mode_of_a_cantilever_has_the_southwell_number() -> None:
    """``K = 1/2 int (L^2 - x^2) phi'^2 dx / int phi^2 dx`` = 1.193 of the clamped-free beam, either way it bends."""
    b = 1.8751040687119611
    x = np.linspace(0.0, 1.0, 20001)
    ratio = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    phi = np.cosh(b * x) - np.cos(b * x) - ratio * (np.sinh(b * x) - np.sin(b * x))
    slope = b * (np.sinh(b * x) + np.sin(b * x) - ratio * (np.cosh(b * x) - np.cos(b * x)))
    expected = 0.5 * np.trapezoid((1.0 - x**2) * slope**2, x) / np.trapezoid(phi**2, x)
    assert expected == pytest.approx(1.193, abs=1e-3)
    _, stiffening = stiffened()
    np.testing.assert_allclose(np.linalg.eigvalsh(stiffening.second_moments[0][:2, :2]), expected, rtol=2e-3)


def test_a_column_buckles_under_its_own_weight() -> None:
    """Greenhill: ``rho A g L^3 / E I = 7.8373``; gravity is an acceleration of the frame the other way."""
    reduced, stiffening = stiffened(12)
    # standing upwards along x: gravity -g e_x, acceleration minus gravity +g e_x
    K, G = np.diag(reduced.eigenvalues), stiffening.linear[0]
    values = np.linalg.eigvals(np.linalg.solve(K, -G)).real
    assert 1.0 / values.max() * LINE / BENDING == pytest.approx(7.8373, rel=2e-3)


def test_angular_acceleration_of_a_blade_beside_the_axis_pulls_along_it() -> None:
    """At a distance R across, ``-alpha e_z x R e_y`` is the field of a linear acceleration by ``-alpha R e_x``."""
    offset = 0.7
    reduced, stiffening = stiffened(4, origin=(0.0, -offset, 0.0))
    flap = np.abs(reduced.mode_shapes[:, :, 2]).max(axis=1) > np.abs(reduced.mode_shapes[:, :, 1]).max(axis=1)
    G = stiffening.angular[2] + offset * stiffening.linear[0]
    scale = offset * np.abs(stiffening.linear[0]).max()
    assert np.abs(np.diag(G)).max() < 1e-6 * scale
    assert flap.sum() == 2


def test_a_free_bar_has_the_frequencies_of_its_full_model_in_a_rotating_frame() -> None:
    """Tension ``1/2 rho A W^2 (l^2 - x^2)`` from its middle: across the plane a beam with this axial force."""
    spin = 100.0
    reduced, stiffening = stiffened(12, free=True, origin=(0.5, 0.0, 0.0))
    K = np.diag(reduced.eigenvalues) + stiffening.of_spin(np.array([0.0, 0.0, spin]))
    S = reduced.integrals.mode_mode
    found = np.sqrt(np.sort(np.linalg.eigvalsh(K - spin**2 * (S[0, 0] + S[1, 1])))) / (2.0 * np.pi)
    across = rotating_beam(spin, free=True)
    within = np.sqrt(across**2 - (spin / (2.0 * np.pi)) ** 2)
    np.testing.assert_allclose(np.sort([within, across]), found[:2], rtol=1e-3)
    assert np.abs(stiffening.linear).max() < 1e-9 * np.abs(stiffening.second_moments).max()
    assert np.abs(stiffening.angular).max() < 1e-9 * np.abs(stiffening.second_moments).max()


def rotating_beam(spin: float, *, free: bool, elements: int = 80) -> float:
    """Lowest elastic frequency across the plane [Hz] of an Euler beam of cubic elements, with its own tension.

    Clamped at the axis, or free and turning about its middle. In the plane the square of the spin is less.
    """
    h, n = 1.0 / elements, 2 * (elements + 1)
    x = np.arange(elements + 1) * h
    halves = (  # upper triangles of bending, mass and tension
        (BENDING / h**3, [12, 6 * h, -12, 6 * h, 4 * h * h, -6 * h, 2 * h * h, 12, -6 * h, 4 * h * h]),
        (
            LINE * h / 420.0,
            [156, 22 * h, 54, -13 * h, 4 * h * h, 13 * h, -3 * h * h, 156, -22 * h, 4 * h * h],
        ),
        (1.0 / (30.0 * h), [36, 3 * h, -36, 3 * h, 4 * h * h, -3 * h, -h * h, 36, -3 * h, 4 * h * h]),
    )
    small = []
    for scale, upper in halves:
        matrix = np.zeros((4, 4))
        matrix[np.triu_indices(4)] = upper
        small.append(scale * (matrix + matrix.T - np.diag(np.diag(matrix))))
    K, M = np.zeros((n, n)), np.zeros((n, n))
    for e in range(elements):
        at, middle = slice(2 * e, 2 * e + 4), x[e] + 0.5 * h
        square = 0.25 - (middle - 0.5) ** 2 if free else 1.0 - middle**2
        tension = 0.5 * LINE * spin**2 * (square - h * h / 12.0)
        K[at, at] += small[0] + tension * small[2]
        M[at, at] += small[1]
    if not free:
        values = scipy.linalg.eigh(K[2:, 2:], M[2:, 2:], eigvals_only=True)
        return float(np.sqrt(values[0]) / (2.0 * np.pi))
    # moving and turning as a whole is the part of the frame
    rigid = np.zeros((n, 2))
    rigid[::2, 0], rigid[::2, 1], rigid[1::2, 1] = 1.0, x - 0.5, 1.0
    Z = scipy.linalg.null_space(rigid.T @ M)
    values = scipy.linalg.eigh(Z.T @ K @ Z, Z.T @ M @ Z, eigvals_only=True)
    return float(np.sqrt(values[0]) / (2.0 * np.pi))


@pytest.mark.parametrize(("spin", "in_plane", "across"), [(25.0, 8.5332, 9.4152), (100.0, 10.4543, 19.0419)])
def test_references_of_the_rotating_blade(spin: float, in_plane: float, across: float) -> None:
    """Numbers of the case; and the published 13.1702 at a spin of 12 (Wright and others, 1982)."""
    found = rotating_beam(spin, free=False)
    assert found == pytest.approx(across, rel=5e-5)
    assert np.sqrt(found**2 - (spin / (2.0 * np.pi)) ** 2) == pytest.approx(in_plane, rel=1e-4)
    unit = np.sqrt(BENDING / LINE)
    assert rotating_beam(12.0 * unit, free=False) == pytest.approx(13.1702 * unit / (2.0 * np.pi), rel=5e-5)


def test_a_free_bar_that_is_pulled_at_one_end_has_a_tension_that_falls_to_the_other() -> None:
    """``T = F x / L`` as it accelerates; ``int T phi'^2 dx`` of the first free mode, which its symmetry halves."""
    reduced, stiffening = stiffened(8, free=True, origin=(0.5, 0.0, 0.0))
    loads = place_loads(blade(), [(1.0, 0.0, 0.0)])
    found = with_loads(
        stiffening,
        Flexibility(blade()),
        reduced,
        stress_stiffness(blade()),
        loads,
        np.array([[0.5, 0.0, 0.0]]),
    )
    b = 4.730040744862704
    x = np.linspace(0.0, 1.0, 20001)
    ratio = (np.cosh(b) - np.cos(b)) / (np.sinh(b) - np.sin(b))
    phi = np.cosh(b * x) + np.cos(b * x) - ratio * (np.sinh(b * x) + np.sin(b * x))
    slope = b * (np.sinh(b * x) - np.sin(b * x) - ratio * (np.cosh(b * x) + np.cos(b * x)))
    expected = np.trapezoid(x * slope**2, x) / (LINE * np.trapezoid(phi**2, x))
    assert expected == pytest.approx(
        0.5 * np.trapezoid(slope**2, x) / (LINE * np.trapezoid(phi**2, x)), rel=1e-6
    )
    assert found.labels[0].endswith("x")
    np.testing.assert_allclose(np.linalg.eigvalsh(found.loads[0][:2, :2]), expected, rtol=3e-3)
    np.testing.assert_allclose(found.generalised[0, :6], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(found.generalised[1, :6], [0.0, 1.0, 0.0, 0.0, 0.0, 0.5], atol=1e-12)


def test_loads_on_what_is_held_stiffen_nothing() -> None:
    """They press on the support: left out by name."""
    reduced, stiffening = stiffened(4)
    model = blade()
    flexibility = Flexibility(model, model.node_groups["root"])
    loads = place_loads(model, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)])
    places = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    found = with_loads(stiffening, flexibility, reduced, stress_stiffness(model), loads, places)
    assert len(loads.labels) == 6
    assert found.labels == loads.labels[3:]
    assert found.loads.shape == (3, 4, 4)


def structure_blade(kind: str) -> Structure:
    """The blade of beams, of plates, or of bricks in two parts."""
    n = 40
    x = np.linspace(0.0, 1.0, n + 1)
    steel = Material(YOUNG, 0.0, DENSITY)
    if kind == "beams":
        nodes = np.column_stack([x, np.zeros((n + 1, 2))])
        elements = np.column_stack([np.arange(n), np.arange(1, n + 1)])
        section = profile("flat", height=SIDE, thickness=SIDE).section
        return Structure(nodes, beams=(Beams("b", elements, steel, section, np.array([0.0, 1.0, 0.0])),))
    if kind == "plates":
        nodes = np.array([[one, side, 0.0] for one in x for side in (-0.5 * SIDE, 0.5 * SIDE)])
        first = 2 * np.arange(n)
        elements = np.column_stack([first, first + 2, first + 3, first + 1])
        return Structure(nodes, shells=(Shells("p", elements, steel, SIDE),))
    mesh = blade().mesh
    assert mesh is not None
    inner = mesh.nodes[mesh.elements][:, :, 0].mean(axis=1) < 0.5
    parts = (mesh.elements[inner], mesh.elements[~inner])
    return Structure(
        mesh.nodes, solids=tuple(Solids(f"s{k}", part, "hex8", steel) for k, part in enumerate(parts))
    )


@pytest.mark.parametrize("kind", ["beams", "plates", "solids"])
def test_a_blade_of_plates_or_beams_that_turns(kind: str) -> None:
    """As one of bricks: its mass, its stress and its rotations are those of the structure."""
    structure = structure_blade(kind)
    model = assemble_structure(structure)
    held = np.flatnonzero(model.nodes[:, 0] < 1e-9)
    flexibility = Flexibility(model, held)
    basis = eigenmode_basis(eigenmodes(model, 14, flexibility=flexibility))
    reduced = reduce_body(model, basis.vectors, basis.labels, fixed_nodes=held, mean_axis=False)
    stiffening = inertia_stiffening(flexibility, reduced, stress_stiffness(model))
    found = frequencies(reduced, stiffening, 25.0)
    np.testing.assert_allclose(found, [8.5332, 9.4153], rtol=2e-3)
    assert found[1] ** 2 - found[0] ** 2 == pytest.approx((25.0 / (2.0 * np.pi)) ** 2, rel=2e-2)


def test_bodies_whose_stress_is_not_known_are_refused() -> None:
    """Matrices without elements, and several materials."""
    for bare, word in (
        (replace(blade(), mesh=None), "no elements"),
        (replace(blade(), material=None), "materials"),
    ):
        with pytest.raises(InputError, match=word):
            stress_stiffness(bare)
