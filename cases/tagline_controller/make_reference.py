"""Reference of the tagline: a mass on an elastic rope in a plane, with the law of the controller at every instant.

With the length l of the rope, its unit vector e towards the hook and the speed l' of its length,

    m r'' = m g + N e + (gust + force) ex,   N = max(0, EA (l - L) / L + c l'),   force = -K x - D x'  within the limit

    python make_reference.py        writes reference.csv beside itself
    python make_reference.py --errors   writes errors.csv and errors.png: errors over the sample time
"""

from __future__ import annotations

import csv
import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

HERE = Path(__file__).parent
MASS, GRAVITY = 100e3, 9.81
LENGTH, STIFFNESS, ROPE_DAMPING = 25.0, 80e6, 200e3
SPRING, DAMPING, LIMIT = 2e4, 6e4, 1e5
TIMES = 0.1 * np.arange(401)
SAMPLES = (0.4, 0.2, 0.1, 0.05, 0.025)

Array = NDArray[np.float64]


def rates(time: float, state: Array) -> list[float]:
    """Velocities and accelerations of the module in x and z."""
    x, z, u, w = state
    length = float(np.hypot(x, z))
    stretching = (x * u + z * w) / length
    pull = max(0.0, STIFFNESS * (length - LENGTH) / LENGTH + ROPE_DAMPING * stretching)
    gust = float(np.interp(time, [0.0, 0.5, 2.5, 3.0], [0.0, 50e3, 50e3, 0.0]))
    force = float(np.clip(-SPRING * x - DAMPING * u, -LIMIT, LIMIT))
    return [u, w, (gust + force - pull * x / length) / MASS, -pull * z / length / MASS - GRAVITY]


def positions() -> Array:
    """Of the module [m] at the sample times, shape (times, 3); pieces end where the gust has corners."""
    state = np.array([0.0, -LENGTH * (1.0 + MASS * GRAVITY / STIFFNESS), 0.0, 0.0])
    found = [state[[0, 1]]]
    for begin, end in zip((0, 5, 25, 30), (5, 25, 30, 400), strict=True):
        piece = TIMES[begin : end + 1]
        done = solve_ivp(
            rates, (piece[0], piece[-1]), state, "DOP853", t_eval=piece, rtol=1e-12, atol=1e-12, max_step=0.02
        )
        found += list(done.y.T[1:, :2])
        state = done.y[:, -1]
    x, z = np.array(found).T
    return np.column_stack([x, np.zeros_like(x), z])


def errors(coupling: str, sample: float, exact: Array) -> float:
    """Largest error of the position [m] of the case with a coupling and a sample time [s]."""
    from heavylift.pipeline import load_results, run_case
    from heavylift.pipeline.stages.stages import load_changed_case

    changes = (f"fmus.0.coupling={coupling}", f"fmus.0.sample_time={sample}", "simulate.step=2.5 ms")
    case = load_changed_case(HERE, changes)
    with tempfile.TemporaryDirectory() as out:
        run_case(case, out=out, stages=("simulate",))
        return float(np.abs(load_results(case, out)["module.position"] - exact).max())


def write_errors() -> None:
    """A table and a picture of errors over the sample time."""
    exact, couplings = positions(), ("sequential", "iterated")
    table = [[errors(coupling, sample, exact) for coupling in couplings] for sample in SAMPLES]
    with (HERE / "errors.csv").open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(["sample time [s]", *(f"{coupling} [m]" for coupling in couplings)])
        rows.writerows([s, *(f"{e:.3e}" for e in row)] for s, row in zip(SAMPLES, table, strict=True))
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for coupling, row, marker in zip(couplings, np.transpose(table), "s^", strict=True):
        axes.loglog(SAMPLES, row, marker=marker, label=coupling)
    axes.set_xlabel("sample time of the controller [s]")
    axes.set_ylabel("largest error of the position [m]")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.savefig(HERE / "errors.png", dpi=110)


def main() -> None:
    """Write the reference, or errors."""
    if "--errors" in sys.argv[1:]:
        write_errors()
        return
    with (HERE / "reference.csv").open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(["time", "x", "y", "z"])
        rows.writerows(
            [f"{t:.1f}", *(f"{v:.9f}" for v in row)] for t, row in zip(TIMES, positions(), strict=True)
        )


if __name__ == "__main__":
    main()
