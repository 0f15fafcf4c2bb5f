"""Memory of radiated waves: time of a step and error of both forms, and what fitting the exponentials costs.

Run with ``python benchmarks/radiation_memory.py``. Times are medians of CPU time on one thread; a step is the force at
its middle and the advance to its end. Errors are those of the force of the box barge of 97.5 x 36 m that moves in all
its coordinates with a period of 7 s and decays, relative to the largest, against a convolution with steps of 0.005 s.
"""

from __future__ import annotations

import statistics
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.jit import kernel
from heavylift.preprocess.hydrodynamics.exponentials import ExponentialKernel, fit_exponentials
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
from heavylift.preprocess.hydrodynamics.retardation import (
    RetardationKernel,
    channel_scales,
    retardation_kernel,
)
from heavylift.solver.water.hulls.memory import (
    advance_memory_direct,
    advance_memory_exponential,
    memory_force_direct,
    memory_force_exponential,
    memory_force_now_direct,
    memory_force_now_exponential,
    prepare_memory_exponential,
)
from heavylift.solver.water.hulls.packing import pack_direct_memory, pack_exponential_memory

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

DATABASES = (("cases/transport_barge/barge.nc", "6 x 6"), ("cases/two_barges/two_barges.nc", "12 x 12"))
STEPS = 20000
SECONDS = 0.5  # of one measurement


@kernel
def exponential_steps(memory, u, h, changing, count, out):  # type: ignore[no-untyped-def]
    last = u.shape[0] - 1
    for k in range(count):
        prepare_memory_exponential(memory, h * (1.0 + changing * (k & 1)))
        memory_force_exponential(memory, u[k % last], out)
        advance_memory_exponential(memory, u[k % last], u[k % last + 1])


@kernel
def direct_steps(memory, u, count, out):  # type: ignore[no-untyped-def]
    last = u.shape[0] - 1
    for k in range(count):
        memory_force_direct(memory, u[k % last], out)
        advance_memory_direct(memory, u[k % last], u[k % last + 1])


@kernel
def exponential_history(memory, u, h, out):  # type: ignore[no-untyped-def]
    for k in range(u.shape[0] - 1):
        prepare_memory_exponential(memory, h)
        advance_memory_exponential(memory, u[k], u[k + 1])
        memory_force_now_exponential(memory, u[k + 1], out[k + 1])


@kernel
def direct_history(memory, u, out):  # type: ignore[no-untyped-def]
    for k in range(u.shape[0] - 1):
        advance_memory_direct(memory, u[k], u[k + 1])
        memory_force_now_direct(memory, u[k + 1], out[k + 1])


def measured(run: Callable[..., object], *arguments: Any) -> float:
    """Median CPU time of a step [us]."""
    run(*arguments)
    times: list[float] = []
    end = time.perf_counter() + SECONDS
    while time.perf_counter() < end or len(times) < 3:
        begin = time.thread_time()
        run(*arguments)
        times.append((time.thread_time() - begin) / STEPS)
    return 1e6 * statistics.median(times)


def all_channels(fit: ExponentialKernel) -> NDArray[np.complex128]:
    """Residues with no entry that can be left out."""
    return np.where(fit.residues == 0.0, 1e-300, fit.residues)


def step_times(name: str, response: RetardationKernel, fit: ExponentialKernel) -> None:
    """Print the times of a step."""
    n = fit.damping.shape[0]
    u = np.random.default_rng(1).normal(size=(33, n))
    out = np.zeros(n)
    for label, residues in (("", fit.residues), (", no channel zero", all_channels(fit))):
        memory = pack_exponential_memory(fit.poles, residues)
        for text, changing in (("", 0.0), (", every step another length", 0.1)):
            took = measured(exponential_steps, memory, u, 0.05, changing, STEPS, out)
            print(
                f"{name}  {fit.pole_count} poles, {len(memory.channels)} channels{label}{text}: {took:.2f} us"
            )
    zero = fit.residues.any(axis=0)
    for taps in (300, 1200):
        direct = pack_direct_memory(lambda t: np.where(zero, response(t), 0.0), 0.05, 0.05 * taps)
        took = measured(direct_steps, direct, u, STEPS, out)
        print(f"{name}  direct, {taps} steps, {len(direct.channels)} channels: {took:.2f} us")
        if n == 6:
            direct = pack_direct_memory(lambda t: response(t) + 1e-300, 0.05, 0.05 * taps)
            took = measured(direct_steps, direct, u, STEPS, out)
            print(f"{name}  direct, {taps} steps, {len(direct.channels)} channels: {took:.2f} us")


def history(h: float, n: int, scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """Velocities over 60 s, of comparable size in all coordinates."""
    t = h * np.arange(round(60.0 / h) + 1)
    phases = np.arange(n)
    return np.sin(2.0 * np.pi / 7.0 * t[:, None] + phases) * np.exp(-0.02 * t[:, None]) / scale


def errors(response: RetardationKernel, fits: list[ExponentialKernel]) -> None:
    """Print the errors of the force over the steps."""
    n = len(response.powers)
    scale = channel_scales(response(0.1 * np.arange(400)))
    u = history(0.005, n, scale)
    exact = np.zeros_like(u)
    direct_history(pack_direct_memory(response, 0.005, 60.0), u, exact)
    largest = np.abs(exact / scale).max()
    for h in (0.2, 0.1, 0.05, 0.02):
        u = history(h, n, scale)
        every = round(h / 0.005)

        def error(out: NDArray[np.float64], every: int = every) -> float:
            return float(np.abs((out - exact[::every]) / scale).max() / largest)

        out = np.zeros_like(u)
        direct_history(pack_direct_memory(response, h, 60.0), u, out)
        parts = [f"direct {error(out):.1e}"]
        for fit in fits:
            out = np.zeros_like(u)
            exponential_history(pack_exponential_memory(fit.poles, fit.residues), u, h, out)
            parts.append(f"{fit.pole_count} poles {error(out):.1e}")
        print(f"step {h:4.2f} s: error of the force: {', '.join(parts)}")


def main() -> None:
    """Print all tables."""
    for path, name in DATABASES:
        database = read_netcdf(path)
        response = retardation_kernel(database.omega, database.damping, source=database.source)
        samples = response(0.1 * np.arange(401))
        fits = []
        for tolerance in (0.02, 0.01, 0.005):
            begin = time.process_time()
            fit = fit_exponentials(samples, tolerance=tolerance)
            took = time.process_time() - begin
            fits.append(fit)
            print(
                f"{name}  fit to {tolerance:.1%}: {fit.pole_count} poles, error {fit.error:.2%}, "
                f"changed by {fit.change:.2%} to be passive, {took:.2f} s"
            )
        step_times(name, response, fits[-1])
        if name == "6 x 6":
            errors(response, fits)


if __name__ == "__main__":
    main()
