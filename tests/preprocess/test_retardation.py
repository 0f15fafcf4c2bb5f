"""Retardation kernels against closed forms, quadrature and Hulme's hemisphere."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.retardation import (
    channel_scales,
    check_infinite_added_mass,
    exponential_integral,
    infinite_added_mass,
    memory_length,
    ogilvie_deviation,
    retardation_kernel,
)

MARINE = Path(__file__).resolve().parents[1] / "reference_data" / "marine"
A, B = 0.4, 1.1  # decay and frequency of the closed form [1/s]


def closed_kernel(t: np.ndarray) -> np.ndarray:
    """exp(-A t) (cos B t - A/B sin B t), which has no damping at zero frequency."""
    return np.exp(-A * t) * (np.cos(B * t) - A / B * np.sin(B * t))


def closed_transform(w: np.ndarray) -> np.ndarray:
    """int K exp(-i w t) dt of it."""
    return 0.5 * ((1.0 + 1j * A / B) / (1j * w + A - 1j * B) + (1.0 - 1j * A / B) / (1j * w + A + 1j * B))


def closed_damping(count: int, highest: float) -> tuple[np.ndarray, np.ndarray]:
    w = np.linspace(0.0, highest, count + 1)[1:]
    return w, closed_transform(w).real[:, None, None]


def test_closed_form_in_second_order() -> None:
    t = np.linspace(0.0, 25.0, 400)
    errors = []
    for count in (200, 400):
        w, damping = closed_damping(count, 20.0)
        kernel = retardation_kernel(w, damping)
        assert kernel.powers[0] == 2.0  # K' (0) is not zero: the damping ends as 2 A / w^2
        errors.append(np.abs(kernel(t)[:, 0, 0] - closed_kernel(t)).max())
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


def test_without_its_tail_the_same_kernel_rings() -> None:
    w, damping = closed_damping(400, 20.0)
    t = np.linspace(0.0, 25.0, 400)
    kernel = retardation_kernel(w, damping)
    cut = retardation_kernel(np.append(w, 20.0 + 1e-9), np.concatenate([damping, np.zeros((1, 1, 1))]))
    with_tail, without = (np.abs(k(t)[:, 0, 0] - closed_kernel(t)).max() for k in (kernel, cut))
    assert without > 20.0 * with_tail


def test_piecewise_linear_damping_is_integrated_exactly() -> None:
    w = np.array([0.3, 0.5, 1.3, 2.0])
    values = np.array([0.2, 1.0, 0.4, 0.0])
    kernel = retardation_kernel(w, values[:, None, None])
    for t in (0.0, 1e-9, 1e-3, 0.7, 5.0, 40.0, 300.0):

        def integrand(x: float, t: float = t) -> float:
            return float(np.interp(x, np.append(0.0, w), np.append(0.0, values)) * np.cos(x * t))

        edges = [0.0, *w]
        parts = [quad(integrand, a, b, epsabs=1e-13, limit=500)[0] for a, b in pairwise(edges)]
        assert kernel([t])[0, 0, 0] == pytest.approx(2.0 / np.pi * sum(parts), abs=1e-12)


@pytest.mark.parametrize("power", [2.0, 2.5, 4.0, 5.5, 7.0])
def test_integrals_of_the_tail(power: float) -> None:
    """On the path s = 1 + i y the integrand decays, and any quadrature is exact."""
    for x in (0.01, 0.5, 4.0, 11.99, 12.01, 60.0, 2000.0):

        def integrand(y: float, x: float = x) -> complex:
            return 1j * np.exp(1j * x - y) * (1.0 + 1j * y / x) ** -power / x

        real = quad(lambda y: integrand(y).real, 0.0, np.inf, epsabs=1e-13, limit=500)[0]
        imaginary = quad(lambda y: integrand(y).imag, 0.0, np.inf, epsabs=1e-13, limit=500)[0]
        assert abs(exponential_integral(power, np.array([x]))[0] - complex(real, imaginary)) < 1e-10
    assert exponential_integral(power, np.zeros(1))[0] == pytest.approx(1.0 / (power - 1.0))


def test_a_tail_starts_where_the_data_end_and_stays_positive() -> None:
    w = np.linspace(0.1, 3.0, 30)
    root = np.stack([w**2 / (1 + w**3), 0.6 * w**2 / (1 + w**4)], axis=1)  # end as w^-1 and w^-2, squared
    damping = np.einsum("ki,kj->kij", root, root)
    kernel = retardation_kernel(w, damping)
    np.testing.assert_array_equal(kernel.powers, [2.0, 4.0])
    np.testing.assert_allclose(kernel.damping_at([3.0 + 1e-12])[0], damping[-1], rtol=1e-9)
    np.testing.assert_allclose(kernel.damping_at(w), damping, rtol=1e-12)
    assert np.linalg.eigvalsh(kernel.damping_at(np.linspace(0.01, 30.0, 300))).min() > -1e-12


def test_the_unsymmetric_part_is_dropped() -> None:
    w, damping = closed_damping(100, 10.0)
    full = damping * np.array([[1.0, 0.5], [0.3, 1.0]])
    K = retardation_kernel(w, full)([0.0, 1.0])
    np.testing.assert_array_equal(K, K.transpose(0, 2, 1))
    np.testing.assert_allclose(K[:, 0, 1], 0.4 * K[:, 0, 0])


def test_added_mass_at_infinity_of_the_closed_form() -> None:
    """A(w) - A_inf = Im K(i w) / w for any kernel."""
    w, damping = closed_damping(800, 20.0)
    added = 3.0 + (closed_transform(w).imag / w)[:, None, None]
    value, spread = infinite_added_mass(w, added, damping)
    assert value[0, 0] == pytest.approx(3.0, rel=1e-4)
    assert spread[0, 0] < 1e-4
    assert check_infinite_added_mass(w, added, damping, [[3.0]]) < 1e-4


def hulme() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequency, added mass and damping of a heaving hemisphere, radius 5 m, in units of rho V."""
    table = np.loadtxt(MARINE / "hemisphere_heave_hulme.csv", delimiter=",", skiprows=2)
    w = np.sqrt(9.81 * table[:, 0] / 5.0)
    return w, table[:, 1][:, None, None], (table[:, 2] * w)[:, None, None]


def test_added_mass_at_infinity_of_a_hemisphere() -> None:
    """Hulme, J. Fluid Mech. 121 (1982): half of the displaced mass; only A and B at finite frequencies are used."""
    value, spread = infinite_added_mass(*hulme())
    assert value[0, 0] == pytest.approx(0.5, rel=3e-3)
    assert spread[0, 0] < 2e-3


def test_added_mass_at_infinity_of_a_box_barge() -> None:
    """Against the boundary element solution at infinity; the table ends at 2 rad/s, where surge is far from zero."""
    table = np.genfromtxt(MARINE / "tb_box_barge_bem.csv", delimiter=",", names=True, skip_header=1)
    n = 6
    added, damping = np.zeros((20, n, n)), np.zeros((20, n, n))
    for i in range(n):
        added[:, i, i], damping[:, i, i] = table[f"A{i + 1}{i + 1}"][:-1], table[f"B{i + 1}{i + 1}"][:-1]
    infinite = np.diag([table[f"A{i + 1}{i + 1}"][-1] for i in range(n)])
    deviation = np.diag(ogilvie_deviation(table["omega_rad_s"][:-1], added, damping, infinite))
    assert (deviation[[2, 3, 4]] < 5e-3).all()
    assert (deviation < 0.06).all()


@pytest.mark.parametrize("given", [[[0.0]], [[np.nan]], [[0.83]], np.zeros((2, 2))])
def test_added_mass_at_infinity_that_is_missing_or_wrong(given: object) -> None:
    """0.83 is the hemisphere's limit at zero frequency."""
    with pytest.raises(InputError, match=r"base\.nc: A_inf: (missing|entry \(1, 1\) = 0.83 is off by)"):
        check_infinite_added_mass(*hulme(), given, source="base.nc")


def test_memory_length_is_where_the_kernel_has_decayed() -> None:
    w, damping = closed_damping(800, 20.0)
    length = memory_length(retardation_kernel(w, damping), tolerance=0.01)
    t = np.arange(0.0, 60.0, 0.01)
    K = np.abs(closed_kernel(t))
    assert t[K > 0.01][-1] == pytest.approx(length, abs=0.2)


def test_scales_are_those_of_the_coordinates_or_what_is_felt() -> None:
    K = np.zeros((3, 3, 3))
    K[0] = [[4.0, 0.003, 1.0], [0.003, 1.0, 0.0], [1.0, 0.0, 9.0]]
    np.testing.assert_array_equal(channel_scales(K), [2.0, 1.0, 3.0])
    np.testing.assert_array_equal(channel_scales(K, [0.1, 5.0, 0.1]), [2.0, 5.0, 3.0])


@pytest.mark.parametrize(
    ("omega", "damping", "message"),
    [
        ([1.0, 0.5, 2.0], np.ones((3, 1, 1)), "increasing"),
        ([0.5, 1.0, 2.0], np.ones((2, 1, 1)), r"\(3, n, n\)"),
        ([0.5, 1.0], np.ones((2, 1, 1)), "three frequencies"),
        ([0.5, 1.0, 2.0], np.full((3, 1, 1), np.nan), "not finite"),
        ([-0.5, 1.0, 2.0], np.ones((3, 1, 1)), "positive"),
    ],
)
def test_bad_damping(omega: list[float], damping: np.ndarray, message: str) -> None:
    with pytest.raises(InputError, match=message):
        retardation_kernel(omega, damping, source="base.nc")
