"""Flexible bodies that rest on each other: the sag and the force of beam theory, whatever the step."""

from __future__ import annotations

import pytest

from heavylift.pipeline import load_case, load_results, run_case

E, LENGTH, WIDTH, REACH, LOAD = 210e9, 1.0, 0.02, 0.95, 100.0
SAG = 0.5 * LOAD * REACH**3 / (3.0 * E * WIDTH**4 / 12.0)
"""``F a^3 / 3 E I`` of each of two equal cantilevers under half of the load."""


def beam(name: str, low: float) -> str:
    top = low + 20.0
    return f"""
[bodies.{name}]
type = "flexible"
material = {{ young_modulus = "210 GPa", poisson_ratio = 0.0, density = "7850 kg/m^3" }}
frame = {{ motion = "fixed" }}
[bodies.{name}.geometry]
type = "blocks"
add = [{{ name = "beam", from = [0, "-10 mm", "{low} mm"], to = ["1 m", "10 mm", "{top} mm"] }}]
groups = {{ root = {{ plane = "x", at = 0 }}, top = {{ face = "beam.z_max" }} }}
[bodies.{name}.mesh]
element = "hex8"
divisions = {{ x = [40], y = [4], z = [2] }}
[bodies.{name}.modes]
count = 6
clamp = ["root"]
static_points = [["0.95 m", 0, "{low} mm"], ["0.95 m", 0, "{top} mm"]]
static_directions = "z"
damping_ratio = 0.3
"""


CASE = (
    'title = "Two cantilevers on each other"\n'
    + beam("low", 0.0)
    + beam("up", 20.0)
    + """
[contours.face]
type = "surface"
body = "low"
face = { on = "top", from = ["0.7 m", "-10 mm", "20 mm"], to = ["1 m", "10 mm", "20 mm"] }
[[contacts]]
name = "touch"
law = "rigid"
between = ["up", "face"]
point = ["0.95 m", 0, "20 mm"]
[[forces]]
type = "point"
name = "push"
body = "up"
point = ["0.95 m", 0, "40 mm"]
force = [0, 0, "-100 N"]
[[sensors]]
name = "tip"
body = "low"
point = ["0.95 m", 0, "20 mm"]
[simulate]
start = "equilibrium"
duration = 0
"""
)


@pytest.mark.slow
def test_two_beams_share_a_load(tmp_path):
    """Without a step, with a long one and a short one: the step of the run is none of the rest."""
    (tmp_path / "case.toml").write_text(CASE)
    heights = []
    for change in ([], ["simulate.step=0.1"], ["simulate.step=1e-4"]):
        case = load_case(tmp_path, change)
        assert run_case(case, stages=("mesh", "modes", "simulate")).message == ""
        results = load_results(case)
        heights.append(float(results["tip.position"][0, 2]))
        assert float(results["touch.normal_force"][0]) == pytest.approx(0.5 * LOAD, rel=2e-3)
        assert abs(float(results["touch.gap"][0])) < 1e-8
    assert heights[0] == pytest.approx(WIDTH - SAG, abs=0.01 * SAG)
    assert heights[1:] == pytest.approx([heights[0]] * 2, abs=1e-12)
