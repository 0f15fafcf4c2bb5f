"""Link beams: the share of a load that its hinge carries, lift-off, sliding with friction, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case

G = 9.81
ROW = 105.1e3
"""Mass of a row of eight bogies [kg], every 1.4 m."""

SCENE = """
title = "links"
[gravity]
acceleration = [0, 0, -9.81]
[bodies.pier]
type = "rigid"
mass = "1 t"
inertia = [1e3, 1e3, 1e3]
frame = { motion = "PIER" }

[[link_beams]]
name = "port"
hinged_on = "pier"
hinge = [0, 10, 0]
rests_on = "ground"
edge = [8, 10, RISE]
length = LENGTH
breadth = "12 m"
mass = "40 t"

[[link_beams]]
name = "starboard"
hinged_on = "pier"
hinge = [0, -10, 0]
rests_on = "ground"
edge = [8, -10, RISE]
length = LENGTH
breadth = "12 m"
mass = "40 t"
"""

VEHICLE = """
[[decks]]
name = "pier_deck"
body = "pier"
sides = ["-20 m", "20 m"]
stations = [-60, 0]
heights = [0, 0]
[[decks]]
name = "quay"
sides = ["-20 m", "20 m"]
stations = [8, 80]
heights = [0, 0]
[bodies.block]
type = "rigid"
mass = "1891.8 t"
inertia = [6e8, 3e8, 6e8]
frame = { motion = "free" }
centre_of_mass = [0, 0, 10]
[bodies.block.initial]
position = [START, 0, 0]
velocity = [SPEED, 0, 0]
[[joints]]
type = "guide"
name = "path"
between = ["ground", "block"]
at = [START, 0, 0]
axis = [0, 0, 1]
reference = [1, 0, 0]
speed = SPEED
[[transporters]]
name = "spmt"
body = "block"
wheel_radius = "0.37 m"
tyre_stiffness = "3 MN/m"
tyre_damping = "15 kN s/m"
line_damping = "20 kN s/m"
"""

RUN = """
[simulate]
step = STEP
output_interval = INTERVAL
duration = DURATION
"""


def groups() -> str:
    """Four groups of nine rows and two trains each: R144."""
    text = ""
    for end, rows in (("front", range(9, 18)), ("rear", range(9))):
        for side, trains in (("left", (6.0, 14.0)), ("right", (-6.0, -14.0))):
            places = [[(i - 8.5) * 1.4, y + d, 0.0] for i in rows for y in trains for d in (-0.725, 0.725)]
            text += f'[[transporters.groups]]\nname = "{end}_{side}"\nbogies = {places}\noil_stiffness = "9.7 MN/m"\n'
    return text


def put(text: str, **values: Any) -> str:
    for key, value in ({"PIER": "fixed", "RISE": 0, "LENGTH": 10} | values).items():
        text = text.replace(key, str(value))
    return text


def run(folder: Path, text: str) -> Any:
    (folder / "case.toml").write_text(text, encoding="utf-8")
    case = load_case(folder)
    report = run_case(case, stages=("simulate",))
    return report, load_results(case, case.output_folder)


@pytest.mark.slow
def test_hinge_carries_what_is_left_of_each_row(tmp_path: Path) -> None:
    """18 rows of 105.1 t over two links of 10 m: ``sum f (1 - x/L)`` at every instant; 3.68 MN and 9.2 MN m."""
    speed, start = 0.25, -16.0
    text = put(
        SCENE + VEHICLE + groups() + RUN,
        START=start, SPEED=speed, STEP=0.02, INTERVAL=0.5, DURATION=170,
    )  # fmt: skip
    report, results = run(tmp_path, text)
    assert report.message == "" or report.outcome.value == 0, report.message
    t = results.time
    loads = results["spmt.wheel_load"]
    hinge = sum(results[f"{name}_hinge.reaction_force"][:, 2] for name in ("port", "starboard"))
    bearings = sum(
        results[f"{name}_{side}.normal_force"] for name in ("port", "starboard") for side in ("left", "right")
    )
    rows = [i for end in (range(9, 18), range(9)) for _ in range(2) for i in end for _ in range(4)]
    x = start + speed * t[:, None] + (np.array(rows) - 8.5) * 1.4
    on = (x > 0.0) & (x < 10.0)
    expected = (loads * np.where(on, 1.0 - x / 10.0, 0.0)).sum(axis=1) + 40e3 * G
    other = (loads * np.where(on, x / 10.0, 0.0)).sum(axis=1) + 40e3 * G
    at_end = ((x > 9.8) & (x < 10.2)).any(axis=1)  # wheels roll down the lip
    at_hinge = (np.abs(x) < 0.05).any(axis=1)  # where a row stands on either side
    quiet = ~(at_end | at_hinge | (t < 1.0))
    assert quiet.sum() > 100
    assert np.abs(hinge - expected)[quiet].max() < 5e-3 * expected.max()
    assert np.abs(bearings - other)[quiet].max() < 5e-3 * other.max()
    w = ROW / 1.4 * G
    assert 0.5 * w * 10.0 == pytest.approx(3.68e6, rel=1e-3)
    assert w * 100.0 / 8.0 == pytest.approx(9.20e6, rel=1e-3)
    full = (x.min(axis=1) < 0.0) & (x.max(axis=1) > 10.0)
    assert (hinge - 40e3 * G)[full].mean() == pytest.approx(3.68e6, rel=0.01)
    # what the pier carries falls evenly with each row that is on the link: nothing leaves it at once
    pier = results["pier.reaction_force"][:, 2]
    carried = (loads * np.clip(1.0 - x / 10.0, 0.0, 1.0)).sum(axis=1) + 41e3 * G
    assert np.abs(pier - carried)[quiet].max() < 5e-3 * carried.max()
    assert np.ptp(pier) > 17.0 * ROW * G


@pytest.mark.slow
def test_end_slides_with_friction(tmp_path: Path) -> None:
    """A pier that goes back and forth by 0.8 m: the end slides, with 0.2 of its load."""
    drive = (
        'frame = { motion = "driven", '
        'x = { times = [0, 2, 6, 10, 12], values = [0, 0, -0.8, 0, 0], interpolation = "monotone" } }'
    )
    text = put(SCENE + RUN, STEP=0.005, INTERVAL=0.1, DURATION=12).replace(
        'frame = { motion = "fixed" }', drive
    )
    _, results = run(tmp_path, text)
    t = results.time
    for name in ("port", "starboard"):
        normal = sum(results[f"{name}_{side}.normal_force"] for side in ("left", "right"))
        friction = sum(results[f"{name}_{side}.friction_force"] for side in ("left", "right"))
        moving = (t > 3.0) & (t < 5.0)
        np.testing.assert_allclose(friction[moving], 0.2 * normal[moving], rtol=1e-3)
        # moments about the hinge of a level link: m g L/2 = N L; friction acts along it
        np.testing.assert_allclose(normal[moving], 20e3 * G, rtol=5e-3)
    slid = results["port_left.slip_path"]
    assert slid[-1] == pytest.approx(1.6, abs=0.02)


def test_rise_at_the_start_is_met_by_its_end(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(put(SCENE, RISE=1), encoding="utf-8")
    case = load_case(tmp_path)
    body = case.bodies["port_plate"]
    angle = body.initial.orientation.angle
    assert angle == pytest.approx(np.arcsin(0.102))
    axis = np.array(body.initial.orientation.axis)
    end = 10.0 * (np.array([1, 0, 0]) * np.cos(angle) + np.cross(axis, [1, 0, 0]) * np.sin(angle))
    assert end[2] == pytest.approx(1.02)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"LENGTH": 6}, "a link beam of 6 m, which reaches 5.99997 m, over a gap of 8 m; expected .* than 8.00002 m"),
        ({"LENGTH": 8}, "over a gap of 8 m"),
        ({"RISE": 7}, "a rise of at most 30 deg"),
    ],
)  # fmt: skip
def test_refused(tmp_path: Path, change: dict[str, Any], words: str) -> None:
    (tmp_path / "case.toml").write_text(put(SCENE, **change), encoding="utf-8")
    with pytest.raises(InputError, match=words):
        load_case(tmp_path)
