"""Motions of lifts against closed forms: double pendulums, loads off the floor, yaw, swing, a line that is cut."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.results.sinusoid import fit_sinusoid
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G = 9.81
HERE = Path(__file__).parent
STIFF = 1e13


def rows(name):
    lines = (HERE / name).read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def at(body, *point):
    return RopePoint(body, np.array(point, dtype=np.float64))


def rope(name, a, b, tension):
    return Rope(name=name, path=(a, b), axial_stiffness=STIFF, tension=tension)


def run(folder: Path, text: str):
    """Results of a case."""
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text)
    case = load_case(folder)
    report = run_case(case, stages=("mesh", "simulate"))
    assert report.outcome.name == "COMPLETED", report.message
    return load_results(case, case.output_folder)


@pytest.mark.parametrize("mode", [0, 1])
@pytest.mark.parametrize("row", rows("double_pendulum.csv"), ids=lambda row: row["name"])
def test_a_hook_between_falls_and_slings_is_a_double_pendulum(row, mode):
    """Small swings in each mode of two point masses; the reference is the closed form of the small oscillation."""
    m1, m2, l1, l2 = (float(row[key]) for key in ("m1_kg", "m2_kg", "l1_m", "l2_m"))
    expected = float(row[f"w{mode + 1}_rad_s"])
    # of the sideways places of both, from their heights: M x'' + K x = 0
    stiffness = np.array([[(m1 + m2) / l1 + m2 / l2, -m2 / l2], [-m2 / l2, m2 / l2]]) * G
    w2, modes = np.linalg.eig(np.diag([1.0 / m1, 1.0 / m2]) @ stiffness)
    order = np.argsort(w2)
    shape = modes[:, order[mode]]
    start = 1e-3 * l2 * shape / np.abs(shape).max()
    drops = math.sqrt(l1**2 - start[0] ** 2), math.sqrt(l2**2 - (start[1] - start[0]) ** 2)
    places = np.array([start[0], 0.0, -drops[0]]), np.array([start[1], 0.0, -drops[0] - drops[1]])
    bodies = tuple(
        RigidBody(name, m, m * np.eye(3), position=place)
        for name, m, place in zip(("hook", "load"), (m1, m2), places, strict=True)
    )
    ropes = (
        rope("falls", at(GROUND, 0, 0, 0), at("hook", 0, 0, 0), (m1 + m2) * G),
        rope("slings", at("hook", 0, 0, 0), at("load", 0, 0, 0), m2 * G),
    )
    step = 2.0 * math.pi / expected / 1000.0
    scene = Scene(bodies, forces=(Gravity(np.array([0.0, 0.0, -G])),), ropes=ropes)
    simulation = Simulation(scene, step=step, record_every=5)
    times, records = simulation.advance(3000)
    column = {c.name: c.column for c in simulation.channels}
    swing = records[:, column["load.position"]]
    assert fit_sinusoid(times, swing).frequency * 2.0 * math.pi == pytest.approx(expected, rel=1e-4)
    hook = records[:, column["hook.position"]]
    assert np.dot(hook, swing) / np.dot(swing, swing) == pytest.approx(shape[0] / shape[1], rel=2e-3)


LIFT_OFF = """
title = "A load off a hard floor"

[gravity]
acceleration = [0, 0, -9.81]

[bodies.load]
type = "rigid"
mass = {mass}
inertia = [1e6, 1e6, 1e6]
frame = {{ motion = "free" }}
initial = {{ position = [0, 0, -5] }}

[[falls]]
name = "crane"
crown = {{ body = "ground", point = [0, 0, {drop}] }}
drum = {{ body = "ground", point = [-2, 0, {drum}] }}
parts = {parts}
sheave_radius = 0.5
drop = {drop}
block = {{ mass = 5, hook_depth = 1 }}
rope = {{ axial_stiffness = 256.5e6 }}
winch = {{ times = [0], speeds = [{speed}] }}

[[ropes]]
name = "sling"
axial_stiffness = 1e12
path = [{{ body = "crane_block", point = [0, 0, -1] }}, {{ body = "load", point = [0, 0, 0] }}]

[[joints]]
name = "floor"
type = "slider"
between = ["ground", "load"]
at = [0, 0, -5]
axis = [0, 0, 1]
limits = {{ lower = {sunk}, stiffness = 1e12, damping = 1e7 }}

[simulate]
step = 0.0005
output_interval = 0.01
duration = {duration}
"""


@pytest.mark.slow
@pytest.mark.parametrize("row", rows("lift_off.csv"), ids=lambda row: row["case"])
def test_amplification_of_falls_that_lift_off_a_hard_floor(row, tmp_path):
    """Undamped, without ramp: DAF = 1 + v sqrt(k M)/(M g), v that of the hook, k that of n parts and their lead."""
    hooks, parts, speed = int(row["hooks"]), int(row["parts"]), float(row["v_m_s"])
    mass, drop = float(row["M_kg"]) / hooks, float(row["H_m"])
    arcs = 0.5 * math.pi * (parts - 0.5)  # of sheaves of 0.5 m; the drum is as far as the rest of 60 m
    case = LIFT_OFF.format(
        mass=mass,
        drop=drop,
        parts=parts,
        drum=drop - (60.0 - arcs),
        speed=parts * speed,
        sunk=mass * G / 1e12,  # it stands on its stop
        duration=math.ceil(100 * (float(row["s_from_first_tension_to_lift_off"]) + 0.8 * float(row["T_s"])))
        / 100,
    )
    results = run(tmp_path / "off", case)
    daf = results["crane.hook_load_max"].max() / (mass * G)
    assert daf == pytest.approx(float(row["DAF"]), rel=0.01)
    length = float(results["crane_rope.rest_length"].ravel()[0])
    assert length == pytest.approx(parts * drop + 60.0, rel=5e-3)
    stiffness = parts**2 * 256.5e6 / length
    assert daf == pytest.approx(1.0 + speed * math.sqrt(stiffness * mass) / (mass * G), rel=2e-3)
    lifted = np.flatnonzero(results["floor.travel"].ravel() > 1e-4)[0]
    assert results.time[lifted] == pytest.approx(mass * G / (stiffness * speed), abs=0.06)


def test_yaw_of_a_block_on_three_falls():
    """Moment of parallel falls sum F a^2/h: 11.6 MN m on the block of the gantry, 15.4 s."""
    hooks = np.array([[8.0, 6.0], [8.0, -6.0], [-16.0, 0.0]])
    mass, high = 350e3, 45.0
    inertia = mass / 12.0 * np.array([23.0**2 + 11.0**2, 43.0**2 + 11.0**2, 43.0**2 + 23.0**2])
    stiffness = mass * G / 3.0 * np.sum(hooks**2) / high
    expected = 2.0 * math.pi * math.sqrt(inertia[2] / stiffness)
    assert stiffness == pytest.approx(11.6e6, rel=2e-3)
    assert expected == pytest.approx(15.4, abs=0.05)
    block = RigidBody("block", mass, np.diag(inertia), angular_velocity=np.array([0.0, 0.0, 1e-3]))
    # above the centre of mass: the block does not tilt
    ropes = tuple(
        rope(f"falls_{k}", at(GROUND, x, y, high + 5.0), at("block", x, y, 5.0), mass * G / 3.0)
        for k, (x, y) in enumerate(hooks)
    )
    scene = Scene((block,), forces=(Gravity(np.array([0.0, 0.0, -G])),), ropes=ropes)
    simulation = Simulation(scene, step=0.02, record_every=5)
    times, records = simulation.advance(2500)
    column = {c.name: c.column for c in simulation.channels}["block.angular_velocity"]
    assert 1.0 / fit_sinusoid(times, records[:, column + 2]).frequency == pytest.approx(expected, rel=1e-3)


SWING = """
title = "A hook under a trolley that starts"

[gravity]
acceleration = [0, 0, -9.81]

[[gantry_cranes]]
name = "crane"
span = 100
girder_height = 60
sheave_radius = 0.4
block = {{ mass = 50e3, hook_depth = 1.5 }}
rope = {{ axial_stiffness = 1e11 }}

[[gantry_cranes.trolleys]]
position = -20
moves = [{{ start = 1, distance = 40, speed = {speed}, ramp = {ramp} }}]
hoists = [{{ drop = 40, parts = 2 }}]

[simulate]
start = "equilibrium"
step = 0.01
output_interval = 0.05
duration = {duration}
"""


def test_a_trolley_leaves_the_swing_of_its_ramp(tmp_path):
    """2 (a/g) l |sin(w t/2)| after a ramp of t seconds to the acceleration a; none if t is the period."""
    period = None
    for ramp in (3.0, 9.0):
        acceleration = 0.05
        text = SWING.format(speed=acceleration * ramp, ramp=ramp, duration=1.0 + ramp + 14.0)
        results = run(tmp_path / f"ramp_{ramp:g}", text)
        hook = results["crane_hook_1_1_block.position"]
        trolley = results["crane_trolley_1.position"]
        away = hook[:, 0] - trolley[:, 0]
        drop = float(trolley[0, 2] - hook[0, 2])
        after = results.time > 1.0 + ramp + 0.5
        fit = fit_sinusoid(results.time[after], away[after])
        w = 2.0 * math.pi * fit.frequency
        period = 2.0 * math.pi / w
        # the frequency gives the length of the pendulum, which the parts, apart from each other, hardly change
        length = G / w**2
        assert length == pytest.approx(drop, rel=0.05)
        expected = 2.0 * acceleration / G * length * abs(math.sin(0.5 * w * ramp))
        swing = math.sqrt(2.0) * float(np.std(away[after][: round(period / 0.05)]))
        assert swing == pytest.approx(expected, rel=0.02)
    text = SWING.format(speed=0.05 * period, ramp=period, duration=math.ceil(period) + 15.0)
    results = run(tmp_path / "whole", text)
    away = (results["crane_hook_1_1_block.position"] - results["crane_trolley_1.position"])[:, 0]
    after = results.time > 1.0 + period + 0.5
    assert np.ptp(away[after]) < 0.02 * 4.0 * 0.05 / G * 40.0
