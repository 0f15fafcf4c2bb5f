"""Memory of radiated waves: both forms against quadrature, closed forms and a published decay."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.exponentials import fit_exponentials
from heavylift.preprocess.hydrodynamics.retardation import RetardationKernel, retardation_kernel
from heavylift.solver.carried import share_state
from heavylift.solver.water.hulls.memory import (
    DirectMemory,
    ExponentialMemory,
    advance_memory_direct,
    advance_memory_exponential,
    hold_integrals,
    memory_force_direct,
    memory_force_exponential,
    memory_force_now_direct,
    memory_force_now_exponential,
    prepare_memory_exponential,
)
from heavylift.solver.water.hulls.packing import pack_direct_memory, pack_exponential_memory

MARINE = Path(__file__).resolve().parents[2] / "reference_data" / "marine"

POLES = np.array([-0.3 + 1.1j, -0.5 + 0.4j, -0.8])
RESIDUES = np.array(
    [
        [[1.0 + 0.5j, 0.3], [0.3, 2.0 - 1.0j]],
        [[0.7, -0.2 + 0.1j], [-0.2 + 0.1j, 0.4]],
        [[-1.1, 0.5], [0.5, 0.9]],
    ]
)
DAMPING = np.array([[0.2, 0.05], [0.05, 0.1]])


@kernel
def integrals(real, imaginary, h):  # type: ignore[no-untyped-def]
    return hold_integrals(real, imaginary, h)


@kernel
def run_exponential(memory, begin, end, steps, known, middle, now):  # type: ignore[no-untyped-def]
    """Known part and whole force at the middle of each step, and the force at its end."""
    for k in range(len(steps)):
        prepare_memory_exponential(memory, steps[k])
        memory_force_exponential(memory, begin[k], known[k])
        for i in range(known.shape[1]):
            middle[k, i] = known[k, i]
            for j in range(known.shape[1]):
                middle[k, i] -= memory.implicit[i, j] * 0.5 * (begin[k, j] + end[k, j])
        advance_memory_exponential(memory, begin[k], end[k])
        memory_force_now_exponential(memory, end[k], now[k])


@kernel
def run_direct(memory, begin, end, steps, known, middle, now):  # type: ignore[no-untyped-def]
    for k in range(len(steps)):
        memory_force_direct(memory, begin[k], known[k])
        for i in range(known.shape[1]):
            middle[k, i] = known[k, i]
            for j in range(known.shape[1]):
                middle[k, i] -= memory.implicit[i, j] * 0.5 * (begin[k, j] + end[k, j])
        advance_memory_direct(memory, begin[k], end[k])
        memory_force_now_direct(memory, end[k], now[k])


@kernel
def decay_exponential(memory, mass, stiffness, h, z):  # type: ignore[no-untyped-def]
    """Implicit midpoint of (M + A) z'' = F - C z from rest at z[0]."""
    known, begin, end = np.zeros(1), np.zeros(1), np.zeros(1)
    for k in range(len(z) - 1):
        prepare_memory_exponential(memory, h)
        memory_force_exponential(memory, begin, known)
        left = 2.0 * mass / h + memory.implicit[0, 0] + 0.5 * stiffness * h
        middle = (2.0 * mass / h * begin[0] + known[0] - stiffness * z[k]) / left
        end[0] = 2.0 * middle - begin[0]
        z[k + 1] = z[k] + h * middle
        advance_memory_exponential(memory, begin, end)
        begin[0] = end[0]


@kernel
def decay_direct(memory, mass, stiffness, h, z):  # type: ignore[no-untyped-def]
    known, begin, end = np.zeros(1), np.zeros(1), np.zeros(1)
    for k in range(len(z) - 1):
        memory_force_direct(memory, begin, known)
        left = 2.0 * mass / h + memory.implicit[0, 0] + 0.5 * stiffness * h
        middle = (2.0 * mass / h * begin[0] + known[0] - stiffness * z[k]) / left
        end[0] = 2.0 * middle - begin[0]
        z[k + 1] = z[k] + h * middle
        advance_memory_direct(memory, begin, end)
        begin[0] = end[0]


def K(t: np.ndarray) -> np.ndarray:
    return np.tensordot(np.exp(np.outer(t, POLES)), RESIDUES, 1).real


def jumping(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Velocities at start and end of steps that do not fit together: something hits the hull each time."""
    rng = np.random.default_rng(7)
    return rng.normal(size=(count, 2)), rng.normal(size=(count, 2))


def forces(
    run: Any, memory: Any, begin: np.ndarray, end: np.ndarray, steps: np.ndarray
) -> tuple[np.ndarray, ...]:
    out = tuple(np.zeros_like(begin) for _ in range(3))
    run(memory, begin, end, steps, *out)
    return out


@pytest.mark.slow
@pytest.mark.parametrize("pole", [-0.3 + 1.1j, -2.0 + 0.0j, -0.01 + 6.0j])
def test_the_first_order_hold_is_exact(pole: complex) -> None:
    """Against quadrature, and for short steps against the first terms of the series."""
    for h in (0.02, 0.3, 0.9, 5.0):
        e, a, b = integrals(pole.real, pole.imag, h)
        assert e == pytest.approx(np.exp(pole * h), rel=1e-14)
        for value, weight in ((a, lambda t, h=h: 1.0 - t / h), (b, lambda t, h=h: t / h)):
            real = quad(lambda t, h=h, f=weight: (np.exp(pole * (h - t)) * f(t)).real, 0.0, h, epsabs=1e-14)[
                0
            ]
            imaginary = quad(
                lambda t, h=h, f=weight: (np.exp(pole * (h - t)) * f(t)).imag, 0.0, h, epsabs=1e-14
            )[0]
            assert abs(value - complex(real, imaginary)) < 1e-13
    h = 1e-7
    _, a, b = integrals(pole.real, pole.imag, h)
    assert abs(a / h - 0.5 - pole * h / 3.0) < 1e-13
    assert abs(b / h - 0.5 - pole * h / 6.0) < 1e-13


@pytest.mark.slow
def test_recursion_against_quadrature_over_uneven_steps() -> None:
    steps = np.array([0.1, 0.1, 0.37, 0.02, 1.3, 0.1])
    begin, end = jumping(len(steps))
    memory = pack_exponential_memory(POLES, RESIDUES, DAMPING)
    _, middle, now = forces(run_exponential, memory, begin, end, steps)
    times = np.append(0.0, np.cumsum(steps))

    def quadrature(t: float, last: int, part: float) -> np.ndarray:
        """Force at t, which lies at a part of the last step."""
        x, weights = np.polynomial.legendre.leggauss(20)
        total = np.zeros(2)
        for k in range(last + 1):
            share = part if k == last else 1.0
            s = 0.5 * (x + 1.0) * share
            u = begin[k] + np.outer(s, end[k] - begin[k])
            values = np.einsum("kij,kj->ki", K(t - times[k] - s * steps[k]), u)
            total -= 0.5 * share * steps[k] * weights @ values
        u = begin[last] + part * (end[last] - begin[last])
        return total - DAMPING @ u

    for k in range(len(steps)):
        np.testing.assert_allclose(middle[k], quadrature(times[k] + 0.5 * steps[k], k, 0.5), atol=1e-12)
        np.testing.assert_allclose(now[k], quadrature(times[k + 1], k, 1.0), atol=1e-12)


@pytest.mark.slow
def test_direct_and_recursive_memory_are_the_same() -> None:
    """Of a kernel that is a sum of exponentials, with velocities that jump, and longer than the ring."""
    count, h = 900, 0.1
    begin, end = jumping(count)
    steps = np.full(count, h)
    exponential = pack_exponential_memory(POLES, RESIDUES, DAMPING)
    direct = pack_direct_memory(K, h, 80.0, DAMPING)
    assert direct.middle.shape == (4, 2 * 800)
    one = forces(run_exponential, exponential, begin, end, steps)
    other = forces(run_direct, direct, begin, end, steps)
    np.testing.assert_allclose(direct.implicit, exponential.implicit, atol=1e-8)
    np.testing.assert_allclose(direct.explicit, exponential.explicit, atol=1e-8)
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a, b, atol=5e-8)


def test_second_order_for_a_smooth_velocity() -> None:
    """For u = sin w t, int_0^t exp(s (t - x)) exp(i w x) dx = (exp(i w t) - exp(s t)) / (i w - s)."""
    w, errors = 1.3, []
    for count in (100, 200, 400):
        h = 10.0 / count
        t = h * np.arange(count + 1)
        u = np.stack([np.sin(w * t), np.zeros(count + 1)], axis=1)
        memory = pack_exponential_memory(POLES, RESIDUES)
        _, middle, now = forces(run_exponential, memory, u[:-1], u[1:], np.full(count, h))

        def exact(t: np.ndarray) -> np.ndarray:
            rise = np.exp(1j * w * t)[:, None]
            fall = np.exp(-1j * w * t)[:, None]
            decay = np.exp(np.outer(t, POLES))
            z = ((rise - decay) / (1j * w - POLES) - (fall - decay) / (-1j * w - POLES)) / 2j
            return -np.tensordot(z, RESIDUES[:, :, 0], 1).real

        errors.append([np.abs(middle - exact(t[:-1] + 0.5 * h)).max(), np.abs(now - exact(t[1:])).max()])
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    np.testing.assert_allclose(ratios, 4.0, rtol=0.1)


def test_channels_that_are_zero_are_left_out() -> None:
    residues = np.zeros((3, 6, 6), dtype=complex)
    for i, j in ((0, 0), (0, 4), (4, 0), (4, 4), (2, 2)):
        residues[:, i, j] = 1.0
    memory = pack_exponential_memory(POLES, residues)
    assert memory.residues.shape == (5, 6)
    direct = pack_direct_memory(
        lambda t: np.tensordot(np.exp(np.outer(t, POLES)), residues, 1).real, 0.1, 5.0
    )
    np.testing.assert_array_equal(direct.channels, memory.channels)


@pytest.mark.parametrize("form", ["exponential", "direct"])
def test_a_copied_state_goes_on_bit_for_bit(form: str) -> None:
    """And a step of another length in between, taken back, leaves no trace."""
    run, memory = (
        (run_exponential, pack_exponential_memory(POLES, RESIDUES, DAMPING))
        if form == "exponential"
        else (run_direct, pack_direct_memory(K, 0.1, 8.0, DAMPING))
    )
    assert memory.carried_fields == ("state",)
    ((memory,),), carried = share_state(((memory,),))
    begin, end = jumping(300)
    steps = np.full(300, 0.1)
    forces(run, memory, begin[:100], end[:100], steps[:100])
    kept = carried.copy()
    first = forces(run, memory, begin[100:], end[100:], steps[100:])
    state = memory.state.copy()
    forces(run, memory, begin[:5], end[:5], np.full(5, 0.1 if form == "direct" else 0.013))
    carried[:] = kept
    again = forces(run, memory, begin[100:], end[100:], steps[100:])
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(memory.state, state)


def hemisphere_kernel() -> RetardationKernel:
    """Heave of a hemisphere of radius 5 m: Hulme's table as a spline, B / (rho V w) = 3 pi ka / 4 for long waves."""
    table = np.loadtxt(MARINE / "hemisphere_heave_hulme.csv", delimiter=",", skiprows=2)
    curve = CubicSpline(
        np.append(0.0, table[:, 0]), np.append(0.0, table[:, 2]), bc_type=((1, 0.75 * np.pi), "not-a-knot")
    )
    ka = 10.0 * np.linspace(0.0, 1.0, 400)[1:] ** 2
    w = np.sqrt(9.81 * ka / 5.0)
    return retardation_kernel(w, (1000.0 * 2.0 / 3.0 * np.pi * 5.0**3 * curve(ka) * w)[:, None, None])


MASS, STIFFNESS = 261800.0 + 130876.8, 770389.1


@pytest.mark.slow
def test_decay_of_a_sphere_against_another_program() -> None:
    """Reference: linear Cummins equation with WAMIT's damping, here Hulme's; 2 mm of 1 m are asked for."""
    reference = np.loadtxt(MARINE / "sphere_decay_linear_cummins.csv", delimiter=",", skiprows=2)
    response = hemisphere_kernel()
    h = 0.02
    z = np.ones(2001)
    decay_direct(pack_direct_memory(response, h, 30.0), MASS, STIFFNESS, h, z)
    assert np.abs(z[::5] - reference[:401, 1]).max() < 6e-4
    fit = fit_exponentials(response(0.1 * np.arange(401)), tolerance=2.6e-4)
    recursive = np.ones(2001)
    decay_exponential(pack_exponential_memory(fit.poles, fit.residues), MASS, STIFFNESS, h, recursive)
    assert np.abs(recursive - z).max() < 2e-4
    assert np.abs(recursive[::5] - reference[:401, 1]).max() < 6e-4
    coarse = np.ones(801)
    decay_exponential(pack_exponential_memory(fit.poles, fit.residues), MASS, STIFFNESS, 0.05, coarse)
    assert np.abs(coarse[::2] - reference[:401, 1]).max() < 2.5e-3


@pytest.mark.parametrize("h", [0.02, 0.1, 0.5, 1.0, 2.0])
def test_long_steps_are_stable(h: float) -> None:
    """Up to nearly half of the period of the sphere, 4.4 s."""
    fit = fit_exponentials(hemisphere_kernel()(0.1 * np.arange(401)))
    z = np.ones(4000)
    decay_exponential(pack_exponential_memory(fit.poles, fit.residues), MASS, STIFFNESS, h, z)
    assert np.abs(z).max() <= 1.0
    assert np.abs(z[-20:]).max() < 1e-4


def test_hulls_lose_energy_to_the_waves() -> None:
    """Of velocities of any frequencies a passive memory takes work, and returns next to none of it before."""
    fit = fit_exponentials(hemisphere_kernel()(0.1 * np.arange(401)), tolerance=1e-3)
    rng = np.random.default_rng(3)
    for h in (0.01, 0.05, 0.2, 0.5):
        for smooth in (1, 5, 40):
            u = np.convolve(rng.normal(size=2000), np.ones(smooth) / smooth, mode="same")[:, None]
            u[0] = u[-1] = 0.0
            memory = pack_exponential_memory(fit.poles, fit.residues)
            _, middle, _ = forces(run_exponential, memory, u[:-1], u[1:], np.full(1999, h))
            work = -h * np.cumsum(0.5 * (u[:-1] + u[1:]) * middle)
            assert work[-1] > 0.0
            assert work.min() > -1e-4 * work[-1]


@pytest.mark.parametrize(
    ("poles", "residues", "damping", "message"),
    [
        ([0.1 + 1j], np.ones((1, 1, 1)), None, "does not decay"),
        ([-0.1], np.ones((2, 1, 1)), None, r"\(1, n, n\)"),
        ([-0.1], np.full((1, 1, 1), np.nan), None, "not finite"),
        ([-0.1], np.ones((1, 2, 2)), np.ones((1, 1)), "damping"),
    ],
)
def test_bad_exponentials(poles: list[complex], residues: np.ndarray, damping: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        pack_exponential_memory(poles, residues, damping)


@pytest.mark.parametrize(("step", "duration"), [(0.0, 10.0), (-0.1, 10.0), (0.1, 0.05), (0.1, np.inf)])
def test_bad_direct_memory(step: float, duration: float) -> None:
    with pytest.raises(InputError, match="0 < step <= duration"):
        pack_direct_memory(K, step, duration)


def test_every_array_that_a_step_changes_is_carried_or_follows_from_the_step() -> None:
    begin, end = jumping(3)
    for run, memory, table in (
        (
            run_exponential,
            pack_exponential_memory(POLES, RESIDUES),
            {"decay", "of_start", "of_end", "halves", "step", "implicit", "explicit"},
        ),
        (run_direct, pack_direct_memory(K, 0.1, 8.0), set()),
    ):
        before = {name: getattr(memory, name).copy() for name in memory._fields}
        forces(run, memory, begin, end, np.full(3, 0.1))
        changed = {name for name in memory._fields if not np.array_equal(before[name], getattr(memory, name))}
        assert changed == {"state"} | table
    assert set(DirectMemory._fields) - set(ExponentialMemory._fields) == {"middle", "now"}
