"""A rope that a phase of another track lets go hangs loose on the page from then on."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.report.interactive import recorded_scene

CASE = """
title = "Two loads, one of which a track of its own lets go"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.one]
type = "rigid"
mass = "2 t"
inertia = [500, 500, 500]
frame = { motion = "free" }
initial = { position = [0, 0, -2] }

[bodies.two]
type = "rigid"
mass = "2 t"
inertia = [500, 500, 500]
frame = { motion = "free" }
initial = { position = [5, 0, -2] }

[[ropes]]
name = "left"
axial_stiffness = "1 MN"
path = [{ body = "ground", point = [0, 0, 0] }, { body = "one", point = [0, 0, 0] }]

[[ropes]]
name = "right"
axial_stiffness = "1 MN"
path = [{ body = "ground", point = [5, 0, 0] }, { body = "two", point = [0, 0, 0] }]

[[scenario.phases]]
name = "hold"

[[scenario.tracks]]
name = "other"

[[scenario.tracks.phases]]
name = "wait"
until = { time = "0.5 s" }

[[scenario.tracks.phases]]
name = "drop"
actions = [{ release = "right" }]

[simulate]
step = "10 ms"
output_interval = "50 ms"
duration = "1 s"
"""


def test_a_track_lets_a_rope_go(tmp_path: Path) -> None:
    """Half a second after the start, while the phase of the first track goes on."""
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path)
    run_case(case, stages=("simulate",))
    motion, why = recorded_scene(case, case.output_folder, load_results(tmp_path))
    assert motion is not None, why
    lines = {line.name: line for line in motion.lines}
    assert lines["left"].loose is None
    np.testing.assert_array_equal(lines["right"].loose, motion.times[0] >= 0.5 - 1e-9)
