"""The worked force of CONTRIBUTING.md is one new file that runs: nothing that exists is edited."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CASE = """
title = "A sled is stopped by oil"

[bodies.sled]
type = "rigid"
mass = "100 kg"
inertia = [10.0, 10.0, 10.0]
frame = { motion = "free" }
initial = { position = ["2 m", 0, 0], velocity = ["4 m/s", 0, 0] }

[[forces]]
type = "orifice"
name = "damper"
between = ["ground", "sled"]
points = [[0, 0, 0], [0, 0, 0]]
force = "1.6 kN"
speed = "4 m/s"

[simulate]
step = "1 ms"
output_interval = "10 ms"
duration = "2 s"
"""
PROGRAM = """
import sys
from pathlib import Path

import numpy as np

import heavylift.solver.force_elements as package

folder = Path(sys.argv[1])
package.__path__.append(str(folder / "force_elements"))

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.case_file import load_case

case = load_case(folder / "case")
assert not {"numba", "scipy"} & set(sys.modules)
try:
    load_case(folder / "case", ["forces.0.speed=2 m"])
except InputError as error:
    assert "forces.0.speed: '2 m' is a length; expected a velocity [m/s]" in str(error), error
else:
    raise AssertionError("a length is no speed")

from heavylift.pipeline.case.schema import key_tables

assert "| `speed` | velocity [m/s] > 0 |" in key_tables()
assert "| `NAME.resistance` | N |" in key_tables()

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.integrate.choice import choose_integrator
from heavylift.solver.layout import pack_scene
from heavylift.solver.simulation import Simulation

scene = assemble_scene(case, OutputFolder(folder / "out"))
assert choose_integrator(scene, 0.01) == (
    "dele2", "dele2, because orifice 'damper' is a row that is fitted by iteration"
)
for name in ("accurate", "thesis"):
    try:
        Simulation(scene, 1e-3, name)
    except InputError as error:
        assert f"{name!r}, but orifice 'damper' is a row" in str(error), error
    else:
        raise AssertionError(name)
    try:
        pack_scene(scene, name)
    except InputError as error:
        assert f"{name!r} with rows that are fitted to a law by iteration" in str(error), error
    else:
        raise AssertionError(name)

from heavylift.numerics.objects import build_unit
from heavylift.solver.kinds import kind_units

for unit in kind_units(sys.modules[type(scene.forces[0]).__module__].Orifices).values():
    build_unit(unit)  # processes that compile other kinds do not know the folder

run = Simulation(scene, 1e-3, record_every=10)
rows = run.advance(1000)[1]
state = run.state()
column = {channel.name: channel.column for channel in run.channels}
t = 0.01 * np.arange(1, 101)
c, m = 1600.0 / 4.0**2, 100.0
speed = 4.0 / (1.0 + c * 4.0 * t / m)  # m v' = -c v^2
np.testing.assert_allclose(rows[:, column["sled.velocity"]], speed, rtol=2e-5)
np.testing.assert_allclose(rows[:, column["damper.resistance"]], c * speed**2, rtol=1e-2)
np.testing.assert_allclose(rows[:, column["energy.dissipated"]], 0.5 * m * (16.0 - speed**2), rtol=1e-4)
assert np.abs(rows[:, column["energy.balance"]] - 800.0).max() < 1e-9

later = Simulation(scene, 1e-3, record_every=10)
later.restore(state)
np.testing.assert_array_equal(later.advance(500)[1], run.advance(500)[1])
print("all")
"""


def test_the_worked_force_of_the_guide_is_one_new_file_that_runs(tmp_path: Path) -> None:
    guide = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"```python\n(\"\"\"Orifice.*?)```", guide, re.DOTALL)
    for name, content in (("force_elements/orifice.py", text), ("case/case.toml", CASE)):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text(content, encoding="utf-8")
    program = [sys.executable, "-c", PROGRAM, str(tmp_path)]
    done = subprocess.run(program, capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "all", done.stderr
