"""Error of the coupled masses over the time between exchanges: a table, and errors.png.

The reference is the matrix exponential.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import expm

from heavylift.pipeline.coupled.coupling_file import load_coupling
from heavylift.pipeline.coupled.run import CoupledScenes

HERE = Path(__file__).parent
INTERVALS = (0.05, 0.025, 0.0125, 0.00625, 0.0025, 0.00125)
METHODS = ("held", "sequential", "extrapolated", "iterated")


def exact(time):
    """Displacements of both masses [m] at a time [s]."""
    m1, k1, m2, k2, k, c = 1000.0, 40e3, 500.0, 20e3, 60e3, 400.0
    rates = [
        [0, 1, 0, 0],
        [-(k1 + k) / m1, -c / m1, k / m1, c / m1],
        [0, 0, 0, 1],
        [k / m2, c / m2, -(k2 + k) / m2, -c / m2],
    ]
    return (expm(np.array(rates) * time) @ [0.1, 0.0, 0.0, 0.0])[[0, 2]]


def error(method, interval):
    """Largest error of both displacements at the exchanges [m]; not a number where the exchange is refused."""
    coupling = load_coupling(HERE, {"method": method, "interval": interval})
    worst = 0.0
    with tempfile.TemporaryDirectory() as out, CoupledScenes(coupling, Path(out)) as coupled:
        for k in range(round(coupled.duration / interval)):
            coupled.master.step(k * interval, interval)
            found = (
                coupled.scenes["first"]["m1.position.x"],
                coupled.scenes["second"]["m2.position.x"] - 10.0,
            )
            worst = max(worst, np.abs(found - exact((k + 1) * interval)).max())
    return worst


def table():
    """Errors [m], shape (intervals, methods)."""
    found = np.full((len(INTERVALS), len(METHODS)), np.nan)
    for i, interval in enumerate(INTERVALS):
        for j, method in enumerate(METHODS):
            try:
                found[i, j] = error(method, interval)
            except ValueError as refused:  # not stable
                sys.stderr.write(f"{refused}\n")
    return found


def main():
    """Write both files."""
    errors = table()
    for interval, row in zip(INTERVALS, errors, strict=True):
        sys.stdout.write(f"{interval:g} s: " + ", ".join(f"{e:.3e} m" for e in row) + "\n")
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for method, row, marker in zip(METHODS, errors.T, "osd^", strict=True):
        axes.loglog(INTERVALS, row, marker=marker, label=method)
    for order, at in ((1, 2e-3), (2, 1.5e-5)):
        slope = at * (np.array(INTERVALS[2:]) / INTERVALS[-1]) ** order
        axes.loglog(INTERVALS[2:], slope, color="0.5", linestyle=":", label=f"order {order}")
    axes.set_xticks(INTERVALS, [f"{1e3 * one:g}" for one in INTERVALS])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("time between exchanges [ms]")
    axes.set_ylabel("largest error of a displacement [m]")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.savefig(HERE / "errors.png", dpi=110)


if __name__ == "__main__":
    main()
