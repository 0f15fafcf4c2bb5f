"""Error of the tagline controller over its sample time, against reference.csv: a table, and errors.png."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from heavylift.pipeline import load_results, run_case
from heavylift.pipeline.stages.stages import load_changed_case

HERE = Path(__file__).parent
SAMPLES = (0.4, 0.2, 0.1, 0.05, 0.025)
COUPLINGS = ("sequential", "iterated")


def error(coupling, sample):
    """Largest error of the position [m] with a coupling and a sample time [s]."""
    exact = np.loadtxt(HERE / "reference.csv", delimiter=",", skiprows=1)[:, 1:]
    changes = (f"fmus.0.coupling={coupling}", f"fmus.0.sample_time={sample}", "simulate.step=2.5 ms")
    case = load_changed_case(HERE, changes)
    with tempfile.TemporaryDirectory() as out:
        run_case(case, out=out, stages=("simulate",))
        return np.abs(load_results(case, out)["module.position"] - exact).max()


def main():
    """Write both."""
    table = np.array([[error(coupling, sample) for coupling in COUPLINGS] for sample in SAMPLES])
    for sample, row in zip(SAMPLES, table, strict=True):
        sys.stdout.write(f"{sample:g} s: " + ", ".join(f"{e:.3e} m" for e in row) + "\n")
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for coupling, row, marker in zip(COUPLINGS, table.T, "s^", strict=True):
        axes.loglog(SAMPLES, row, marker=marker, label=coupling)
    axes.set_xticks(SAMPLES, [f"{1e3 * one:g}" for one in SAMPLES])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("sample time of the controller [ms]")
    axes.set_ylabel("largest error of the position [m]")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.savefig(HERE / "errors.png", dpi=110)


if __name__ == "__main__":
    main()
