"""Link beams: the share of a load that its hinge carries, lift-off, sliding with friction, what is refused or stops."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
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
    bearings = sum(results[f"{name}_end.force"] for name in ("port", "starboard"))
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
    # a row presses the bearings by (105.1 t g)^2 / 2 k: this goes to the wheels that roll down, and no step makes any
    stored = 18.0 * (ROW * G) ** 2 / (2.0 * 4e8)
    balance = results["energy.balance"]
    assert np.ptp(balance) < 2e-3 * stored
    # what the pier carries falls evenly with each row that is on the link: nothing leaves it at once
    pier = results["pier.reaction_force"][:, 2]
    carried = (loads * np.clip(1.0 - x / 10.0, 0.0, 1.0)).sum(axis=1) + 41e3 * G
    assert np.abs(pier - carried)[quiet].max() < 5e-3 * carried.max()
    assert np.ptp(pier) > 17.0 * ROW * G


def driven(text: str, **axes: str) -> str:
    """A scene whose pier moves by tables."""
    tables = ", ".join(f"{axis} = {{ {table}, interpolation = 'monotone' }}" for axis, table in axes.items())
    return text.replace('frame = { motion = "fixed" }', f'frame = {{ motion = "driven", {tables} }}')


def test_end_slides_with_friction(tmp_path: Path) -> None:
    """A pier that goes back and forth by 0.8 m: the end slides, with 0.2 of its load. No row is redundant."""
    text = put(SCENE + RUN, STEP=0.005, INTERVAL=0.1, DURATION=12)
    text = driven(text, x="times = [0, 2, 6, 10, 12], values = [0, 0, -0.8, 0, 0]")
    report, results = run(tmp_path, text)
    assert report.stages[-1].details["redundant"] == []
    t = results.time
    moving = (t > 3.0) & (t < 5.0)
    for name in ("port", "starboard"):
        force, friction = results[f"{name}_end.force"][moving], results[f"{name}_end.friction"][moving]
        np.testing.assert_allclose(
            friction[:, 0], 0.2 * force, rtol=1e-4
        )  # the link goes back: along the deck
        np.testing.assert_allclose(friction[:, 1], 0.0, atol=1.0)
        # moments about the hinge of a level link: m g L/2 = N L; friction acts along it, 20 mm below
        np.testing.assert_allclose(force, 20e3 * G / (1.0 + 0.2 * 0.002), rtol=1e-3)
        np.testing.assert_allclose(results[f"{name}_end.slip_path"][-1], 1.6, atol=0.002)
    work = 2.0 * 0.2 * 20e3 * G * 1.6
    dissipated, driven_by = results["energy.dissipated"], results["energy.drive_work"]
    i, k = np.searchsorted(t, (1.9, 10.5))
    assert dissipated[k] - dissipated[i] == pytest.approx(work, rel=2e-3)
    assert driven_by[k] - driven_by[i] == pytest.approx(work, rel=5e-3)
    assert np.ptp(results["energy.balance"]) < 1e-6 * work


def test_end_lifts_off_and_comes_back(tmp_path: Path) -> None:
    """The shelf under it falls by 0.5 m in 0.1 s. A bar on a hinge falls with 3 g/2 at its end, and is caught."""
    drop = "times = [0, 2, 2.1, 6], values = [0, 0, -0.5, -0.5]"
    text = put(SCENE + RUN, STEP=0.002, INTERVAL=0.01, DURATION=6)
    shelf = text[text.index("[bodies.pier]") : text.index("[[link_beams]]")].replace("pier", "shelf")
    text = text.replace("[[link_beams]]", driven(shelf, z=drop) + "[[link_beams]]", 1)
    text = text.replace('rests_on = "ground"', 'rests_on = "shelf"')
    report, results = run(tmp_path, text)
    assert report.stages[-1].outcome.value == 0
    t = results.time
    for name in ("port", "starboard"):
        gap, force = results[f"{name}_end.lift_off"], results[f"{name}_end.force"]
        free = (t > 2.105) & (t < 2.25)
        fallen = 0.75 * G * (t[free] - 2.0) ** 2
        np.testing.assert_allclose(gap[free], (0.5 - fallen)[:, None] * [1.0, 1.0], atol=6e-3)
        assert np.all(force[free] == 0.0)
        caught = t[t > 2.1][np.argmax(force[t > 2.1] > 0.0)]
        assert caught == pytest.approx(2.0 + np.sqrt(0.5 / (0.75 * G)), abs=0.012)
        assert results[f"{name}_end.force_max"].max() > 10.0 * 20e3 * G
        np.testing.assert_allclose(force[-1], 20e3 * G, rtol=5e-3)
        assert gap[-1] == pytest.approx(-0.5 * 20e3 * G / 1e8, rel=1e-2)
    balance = results["energy.balance"]
    assert np.ptp(balance) < 1e-6 * 2.0 * 40e3 * G * 0.25


@pytest.mark.parametrize("way", ["x", "y"])
def test_end_that_slides_off_its_deck_stops_the_run(tmp_path: Path, way: str) -> None:
    """2 m of it are on the deck; across it goes as far as it likes."""
    text = put(SCENE + RUN, STEP=0.01, INTERVAL=0.1, DURATION=8)
    text = driven(text, **{way: "times = [0, 1, 7, 8], values = [0, 0, -2.5, -2.5]"})
    report, _ = run(tmp_path, text)
    last = report.stages[-1]
    if way == "y":
        assert last.outcome is Outcome.COMPLETED
        return
    assert last.outcome is Outcome.NOT_CLOSED
    assert "_end': the " in last.message
    assert "end of its line has slid off the deck" in last.message


BARGE = """
title = "a row leaves a barge"
[gravity]
acceleration = [0, 0, -9.81]
[sea]
density = 1025
[bodies.barge]
type = "rigid"
mass = 16189.9e3
inertia = [1.5e9, 1.2e10, 1.2e10]
frame = { motion = "free" }
[[surfaces]]
name = "plating"
body = "barge"
shape = { type = "box", size = [97.5, 36, 8] }
at = [0, 0, -0.5]
[hulls.barge]
surface = "plating"
damping = [1e6, 1e6, 2e7, 5e9, 1e10, 1e9]
[[joints]]
type = "guide"
name = "mooring"
between = ["ground", "barge"]
at = [0, 0, 0]
axis = [0, 0, 1]
reference = [1, 0, 0]
[[decks]]
name = "deck"
body = "barge"
origin = [0, 0, 1.5]
sides = [-18, 18]
stations = [-48.75, 48.75]
heights = [0, 0]
[[decks]]
name = "quay"
origin = [0, 0, 1.5]
sides = [-18, 18]
stations = [FIRST, 100]
heights = [0, 0]
[bodies.row]
type = "rigid"
mass = "1 t"
inertia = [1e3, 1e3, 1e3]
[bodies.row.frame]
motion = "driven"
x = { times = [0, 60, 120, 260], values = [START, START, END, END], interpolation = "monotone" }
[[transporters]]
name = "spmt"
body = "row"
wheel_radius = "0.37 m"
tyre_stiffness = "3 MN/m"
tyre_damping = "15 kN s/m"
line_damping = "20 kN s/m"
accept_unstable = true
[[transporters.groups]]
name = "row"
constant_force = true
load = 128878.875
bogies = [[0, -14.725, 1.5], [0, -13.275, 1.5], [0, -6.725, 1.5], [0, -5.275, 1.5],
          [0, 5.275, 1.5], [0, 6.725, 1.5], [0, 13.275, 1.5], [0, 14.725, 1.5]]
[[sensors]]
name = "edge"
body = "barge"
point = [48.75, 0, 1.5]
[simulate]
step = 0.02
output_interval = 0.2
duration = 260
"""


@pytest.mark.slow
def test_row_leaves_a_barge_at_once_or_little_by_little(tmp_path: Path) -> None:
    """29 mm of sinkage and 89 mm of trim: the end of the barge jumps, or goes up evenly over a link of 10 m."""
    area, weight = 97.5 * 36.0, 16189.9e3
    metacentric = 97.5**3 * 36.0 / 12.0 / (area * 4.5) + 2.25 - 4.5  # the centre of mass is in the waterline
    jump = ROW / (1025.0 * area) + ROW * 48.75**2 / (weight * metacentric)
    assert jump == pytest.approx(0.118, abs=5e-4)
    links = ""
    for name, y in (("port", 10), ("starboard", -10)):
        links += (
            f'[[link_beams]]\nname = "{name}"\nhinged_on = "barge"\nhinge = [48.75, {y}, 1.5]\n'
            f'rests_on = "ground"\nedge = [56.75, {y}, 1.5]\nlength = 10\nbreadth = 12\nmass = "40 t"\n'
        )
    found = {}
    for kind, first, end, more in (("jump", 48.85, 8.0, ""), ("link", 56.75, 20.0, links)):
        folder = tmp_path / kind
        folder.mkdir()
        text = BARGE.replace("FIRST", str(first)).replace("END", str(48.75 + end)).replace("START", "47.75")
        text = text.replace("[[sensors]]", more + "[[sensors]]", 1)
        _, results = run(folder, text)
        t, z = results.time, results["edge.position"][:, 2]
        before, after = z[(t > 50.0) & (t < 60.0)].mean(), z[t > 240.0].mean()
        assert after - before == pytest.approx(jump, rel=0.02)
        found[kind] = np.abs(np.gradient(z, t))[t > 58.0].max()
    assert found["link"] < 0.15 * found["jump"]


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
