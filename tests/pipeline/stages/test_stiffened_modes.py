"""Bodies of a case that stiffen: what the modes stage writes, what forces at interfaces do, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.results.model_io import read_reduced
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import run_case

E, SIDE = 2.1e11, 0.02
CRITICAL = np.pi**2 * E * SIDE**4 / 12.0 / 4.0

CASE = f"""
title = "A column with a load across"

[bodies.column]
type = "flexible"
material = {{ young_modulus = {E}, poisson_ratio = 0, density = 7850 }}
mesh = {{ element = "hex8", divisions = {{ x = [20], y = [2], z = [2] }} }}
modes = {{ count = 4, clamp = ["root"], stiffening = true }}
frame = {{ motion = "fixed" }}
interfaces = {{ TIP = {{ group = "tip", at = [1, 0, 0] }} }}

[bodies.column.geometry]
type = "blocks"
add = [{{ name = "bar", from = [0, {-SIDE / 2}, {-SIDE / 2}], to = [1, {SIDE / 2}, {SIDE / 2}] }}]
groups = {{ root = {{ plane = "x", at = 0 }}, tip = {{ plane = "x", at = 1 }} }}

[[forces]]
name = "along"
type = "point"
body = "column"
point = "TIP"
times = [0]
forces = [[{-0.5 * CRITICAL}, 0, 1]]

[[sensors]]
name = "end"
body = "column"
point = "TIP"

[simulate]
start = "equilibrium"
step = "0.1 ms"
output_interval = "10 ms"
duration = "20 ms"
"""


def test_a_load_along_a_column_at_an_interface(tmp_path):
    """``F L^3 (tan u - u) / E I u^3`` with ``u = pi/2 sqrt(P/P_c)``: about twice the deflection at half of the load."""
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path)
    report = run_case(case, stages=("mesh", "modes", "simulate"))
    assert report.outcome is Outcome.COMPLETED
    reduced = read_reduced(OutputFolder(case.output_folder).reduced("column"))
    stiffening = reduced.stiffening
    assert stiffening is not None
    assert stiffening.labels[0].startswith("TIP")
    assert stiffening.loads.shape == (6, reduced.mode_count, reduced.mode_count)
    np.testing.assert_allclose(stiffening.places, [[1.0, 0.0, 0.0]], atol=1e-12)
    u = 0.5 * np.pi * np.sqrt(0.5)
    expected = (np.tan(u) - u) / u**3 / (E * SIDE**4 / 12.0)
    quantities = Quantities(case, case.output_folder)
    for statistic in ("min", "max"):
        found = quantities.number(f"channel.end.position.z.{statistic}")
        assert found == pytest.approx(expected, rel=5e-3)
    assert quantities.number("drift.energy") < 1e-6


def test_a_force_at_a_place_that_is_not_known_is_refused(tmp_path):
    """With the body, the point and the keys that help."""
    (tmp_path / "case.toml").write_text(CASE)
    case = load_case(tmp_path, ["forces.0.point=[0.5, 0, 0]"])
    with pytest.raises(InputError) as caught:
        run_case(case, stages=("mesh", "modes", "simulate"))
    for word in ("bodies.column.modes.stiffening", "(500, 0, 0) mm", "'modes.static_points'"):
        assert word in str(caught.value)
