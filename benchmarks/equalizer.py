"""Times of a step of a load on one equalizer, with pulleys as bodies and without their masses, each also with friction.

    python benchmarks/equalizer.py

The first lift of `cases/equalizer` for 20 s at 5 ms from rest, five times each: median of CPU time a step.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path

from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.simulation import Simulation

CASE = Path(__file__).resolve().parents[1] / "cases" / "equalizer" / "case.toml"
STEP, STEPS, TIMES = 5e-3, 4000, 5
PULLEY = 'pulley = { mass = "1 t" }'


def step_time(text: str) -> float:
    """Median CPU time of a step [us]."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.toml").write_text(text, encoding="utf-8")
        case = load_case(folder)
        scene = assemble_scene(case, OutputFolder(case.output_folder))
    found = []
    for _ in range(TIMES):
        run = Simulation(scene, step=STEP, record_every=10, start="equilibrium")
        run.advance(10)  # the place of rest is found before the first step
        begin = time.process_time()
        run.advance(STEPS)
        found.append(1e6 * (time.process_time() - begin) / STEPS)
    return statistics.median(found)


def main() -> None:
    """Print both."""
    text = CASE.read_text(encoding="utf-8")
    text = text[: text.index("# the same lines")]
    for name, model in (("pulleys as bodies", PULLEY), ("no mass of pulleys", 'model = "massless"')):
        for efficiency in (1.0, 0.98):
            made = text.replace(PULLEY, f"{model}\nefficiency = {efficiency}")
            print(f"{name:18} efficiency {efficiency:4} {step_time(made):6.1f} us a step")


if __name__ == "__main__":
    main()
