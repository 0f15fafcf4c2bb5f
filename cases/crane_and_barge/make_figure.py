"""A crane and its barge in two programs against one, over the time between exchanges: a table, and errors.png."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.coupled.coupling_file import load_coupling
from heavylift.pipeline.coupled.run import run_coupled
from heavylift.pipeline.log import Log

HERE = Path(__file__).parent
INTERVALS = (0.05, 0.025, 0.01, 0.005)
METHODS = ("sequential", "extrapolated", "iterated")
CHANNELS = (("crane", "load.position"), ("crane", "fall.tension"), ("barge", "tip.position"))


def errors(method, interval, whole, duration=None):
    """Largest deviations of the channels from those of one scene, by what they change there; NaN where refused.

    Parameters
    ----------
    method, interval
        Of the exchange; between exchanges [s].
    whole
        Results of the one scene.
    duration
        [s]; that of the case by default.
    """
    changes = {"method": method, "interval": interval} | ({} if duration is None else {"duration": duration})
    with tempfile.TemporaryDirectory() as out:
        try:
            run_coupled(load_coupling(HERE, changes), Path(out), Log(quiet=True))
        except ValueError as refused:  # not stable
            sys.stderr.write(f"{refused}\n")
            return [np.nan] * len(CHANNELS)
        found = {name: load_results(load_case(HERE / name), Path(out) / name) for name in ("crane", "barge")}
        return [
            np.abs(found[scene][name] - whole[name][: len(found[scene].time)]).max()
            / np.ptp(whole[name], axis=0).max()
            for scene, name in CHANNELS
        ]


def main():
    """Write both files."""
    with tempfile.TemporaryDirectory() as out:
        case = load_case(HERE)
        run_case(case, out=out, stages=("mesh", "modes", "simulate"))
        whole = load_results(case, out)
        found = {(m, h): errors(m, h, whole) for m in METHODS for h in INTERVALS}
    for (method, interval), row in found.items():
        sys.stdout.write(f"{interval:g} s, {method}: " + ", ".join(f"{e:.2e}" for e in row) + "\n")
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for method, marker in zip(METHODS, "sd^", strict=True):
        worst = [max(found[method, h]) for h in INTERVALS]
        axes.loglog(INTERVALS, worst, marker=marker, label=method)
    axes.axhline(1e-3, color="0.5", linestyle=":")
    axes.set_xticks(INTERVALS, [f"{1e3 * one:g}" for one in INTERVALS])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("time between exchanges [ms]")
    axes.set_ylabel("largest deviation over range in one scene")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.savefig(HERE / "errors.png", dpi=110)


if __name__ == "__main__":
    main()
