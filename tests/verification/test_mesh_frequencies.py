"""Natural frequencies of slender beams and thin plates from the matrices of frames and shells, and from a motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.polynomial import Polynomial, legendre
from scipy.linalg import eigh

from heavylift.solver.bodies.ancf import frame_packing, shell_packing
from heavylift.solver.scene.mesh_shapes import line, rectangle
from heavylift.solver.scene.meshes import FrameBody, FrameSection, ShellBody, ShellSection, Support
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from heavylift.solver.scene.meshes import MeshBody

STEEL, DENSITY = 2.1e11, 7850.0
LENGTH, AREA, SECOND_MOMENT = 2.0, 1e-4, 8e-10
SIDE, THICKNESS, POISSON = 1.5, 0.01, 0.3

# wave numbers times length: roots of sin x = 0, cos x cosh x = 1, cos x cosh x = -1
BEAMS = {
    "hinged": np.pi * np.arange(1, 6),
    "clamped": np.array([4.730040744863, 7.853204624096, 10.995607838002, 14.137165491257, 17.278759657399]),
    "cantilever": np.array(
        [1.875104068712, 4.694091132974, 7.854757438238, 10.995540734875, 14.137168391046]
    ),
}


def beam(**more: object) -> FrameBody:
    """Twenty elements along x."""
    mesh = line((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0), 20)
    section = FrameSection(DENSITY, STEEL, AREA, SECOND_MOMENT)
    return FrameBody(
        name="beam",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(section,),
        **more,
    )


def plate() -> tuple[ShellBody, dict[str, np.ndarray]]:
    """Ten elements by ten, and its edges."""
    mesh = rectangle(SIDE, SIDE, 10, 10)
    section = ShellSection(THICKNESS, DENSITY, STEEL, POISSON)
    body = ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(section,),
    )
    return body, mesh.edges


def frequencies(body: MeshBody, fixed: np.ndarray | list[int], count: int) -> np.ndarray:
    """Lowest circular frequencies across the flat shape, where nothing stretches: with the bending matrix alone."""
    packing = frame_packing if isinstance(body, FrameBody) else shell_packing
    vectors = 2 if isinstance(body, FrameBody) else 4
    size = vectors * len(body.nodes)
    M, K = np.zeros((size, size)), np.zeros((size, size))
    for data, nodes in zip(packing.element_data(body), body.elements, strict=True):
        places = (vectors * nodes[:, np.newaxis] + np.arange(vectors)).ravel()
        n = len(places)
        M[np.ix_(places, places)] += np.reshape(data[: n * n], (n, n))
        K[np.ix_(places, places)] += np.reshape(data[n * n : 2 * n * n], (n, n))
    free = np.setdiff1d(np.arange(size), fixed)
    squares = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(np.maximum(squares[:count], 0.0))


@pytest.mark.parametrize("support", BEAMS)
def test_beams_have_the_frequencies_of_euler_and_bernoulli(support: str) -> None:
    fixed = {"hinged": [0, 40], "clamped": [0, 1, 40, 41], "cantilever": [0, 1]}[support]
    expected = (BEAMS[support] / LENGTH) ** 2 * np.sqrt(STEEL * SECOND_MOMENT / (DENSITY * AREA))
    np.testing.assert_allclose(frequencies(beam(), fixed, 5), expected, rtol=4e-4)


def test_roots_of_beams_solve_their_equations() -> None:
    for support, sign in (("clamped", 1.0), ("cantilever", -1.0)):
        x = BEAMS[support]
        np.testing.assert_allclose(np.cos(x) - sign / np.cosh(x), 0.0, atol=1e-11)


def plate_unit() -> float:
    """``sqrt(D / rho h) / a^2``."""
    rigidity = STEEL * THICKNESS**3 / 12.0 / (1.0 - POISSON**2)
    return float(np.sqrt(rigidity / (DENSITY * THICKNESS)) / SIDE**2)


def test_hinged_plate_has_the_frequencies_of_navier() -> None:
    body, edges = plate()
    fixed = [4 * n + v for name, nodes in edges.items() for n in nodes for v in (0, 2 if "x_" in name else 1)]
    waves = [i * i + j * j for i in range(1, 6) for j in range(1, 6)]
    expected = np.pi**2 * np.sort(waves)[:8] * plate_unit()
    np.testing.assert_allclose(frequencies(body, np.unique(fixed), 8), expected, rtol=6e-4)


def clamped_plate(count: int) -> np.ndarray:
    """``w a^2 sqrt(rho h / D)`` of a clamped square plate: method of Ritz with 12 polynomials along each side."""
    shapes = [
        Polynomial([1.0, 0.0, -1.0]) ** 2 * Polynomial(legendre.leg2poly(np.eye(k + 1)[k])) for k in range(12)
    ]

    def products(order: int) -> np.ndarray:
        rates = [shape.deriv(order) if order else shape for shape in shapes]
        integrals = [[(a * b).integ() for b in rates] for a in rates]
        return np.array([[p(1.0) - p(-1.0) for p in row] for row in integrals])

    flat, slope, bend = products(0), products(1), products(2)
    K = np.kron(bend, flat) + np.kron(flat, bend) + 2.0 * np.kron(slope, slope)
    return 4.0 * np.sqrt(eigh(K, np.kron(flat, flat), eigvals_only=True)[:count])


def test_clamped_plate_has_the_frequencies_of_the_literature() -> None:
    """Against the method of Ritz, and Ritz series of beam functions in A. W. Leissa, J. Sound Vib. 31, 1973, p. 257."""
    body, edges = plate()
    fixed = [4 * n + v for nodes in edges.values() for n in nodes for v in range(4)]
    found = frequencies(body, fixed, 6) / plate_unit()
    np.testing.assert_allclose(found[:5], clamped_plate(5), rtol=1e-3)
    np.testing.assert_allclose(found, [35.992, 73.413, 73.413, 108.27, 131.64, 132.24], rtol=1e-3)


def test_bending_matrices_know_no_other_free_motions_than_those_of_a_rigid_line_and_plane() -> None:
    """Position and slopes of the middle surface: two across a beam, three across a plate."""
    for body, count in ((beam(), 2), (plate()[0], 3)):
        found = frequencies(body, [], count + 1)
        assert np.all(found[:count] < 1e-3 * found[count])


@pytest.mark.parametrize("elasticity", ["carried", "energy-momentum"])
def test_released_beam_swings_with_its_first_frequency(elasticity: str) -> None:
    """A weightless hinged beam that gravity takes hold of: its first mode moves as ``c (1 - cos w t)``."""
    supports = (Support(np.array([0]), {"position": "xyz"}), Support(np.array([20]), {"position": "yz"}))
    body = beam(supports=supports, elasticity=elasticity)
    small = 1e-3  # m/s2: deflections of 1e-6 of the length
    omega = (np.pi / LENGTH) ** 2 * np.sqrt(STEEL * SECOND_MOMENT / (DENSITY * AREA))
    step = 2.0 * np.pi / omega / 250.0
    simulation = Simulation(Scene((body,), (Gravity(np.array([0.0, 0.0, -small])),)), step)
    times, rows = simulation.advance(2500)
    column = next(c.column for c in simulation.channels if c.name == "beam.position")
    z = rows[:, column + 2 : column + 63 : 3]
    mode = (
        z @ np.sin(np.pi * body.nodes[:, 0] / LENGTH) / 10.0
    )  # of all half waves of 20 parts the first alone
    swing = 4.0 * small / np.pi / omega**2
    error = mode + swing * (1.0 - np.cos(omega * times))
    first = np.flatnonzero(np.diff(np.sign(mode + swing)) != 0)
    crossings = times[first] - (mode + swing)[first] * step / np.diff(mode)[first]
    half_period = np.polyfit(np.arange(len(crossings)), crossings, 1)[0]
    assert np.pi / half_period == pytest.approx(omega, rel=1e-3)
    assert np.abs(error).max() < 1e-2 * swing  # ten periods, a phase error of 5e-5 each
