"""Writes tank.stl, hold.stl and the six cases wave_1/case.toml, ..., with the clearance that linear theory expects.

    python make_case.py

Both models are outer plates, chocks and guides of `cases/tank_in_hull`, by its generator, the guides 1.2 m off.

Reference: crane in waves with the data of barge.nc, its hooks and tank as double pendulums that also turn about the
vertical. With the six motions xi of the hull about the middle of its water plane, hooks and lugs at y_1 and y_2 across,
turned by p_1 and p_2, and exp(-i w t),

    [-w^2 (M + A) - i w (B + D) + C] xi + J^T k_1 (J xi - y_1) + K_1 (yaw - p_1) = X
    J xi = sway + x_t yaw - z_t roll
    k_1 = (m_1 + m_2) g/l_1,   k_2 = m_2 g/l_2,   K = 2 a^2 k  for falls at +-a across and along

Falls at +-a keep the lugs parallel to the crane: the tank rolls and pitches with it about its lugs, its centre is at
y_2 + h roll. Hooks and tank follow the tip up and down. Motions along x are left out: beam waves do not excite them.
"""

from __future__ import annotations

import csv
import importlib.util
import sys
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np
from scipy.interpolate import CubicSpline

HERE = Path(__file__).resolve().parent

DENSITY, GRAVITY = 1025.0, 9.81
LENGTH, BREADTH, DRAFT = 97.5, 36.0, 4.5
VOLUME = LENGTH * BREADTH * DRAFT
TANK, HOOKS = 1.6e6, 4 * 40e3  # kg
FALL, SLING = 20.0, 20.0  # m, at the end: l = 40 m
TIP = np.array([78.0, 0.0, 58.0])  # m
ARM = 8.0  # m, hooks about the tip in x and y
LOWERED, SPEED = 1.0, 0.05  # m, m/s
ABOVE = 2.0  # m, bottom of the tank over the chocks at the end
HEIGHT = 3.0  # m, centre of mass of the crane over the water, with its boom
GYRADII = (14.0, 30.0, 30.0)  # m
HULL = DENSITY * VOLUME - TANK - HOOKS
CENTRE = -(TANK + HOOKS) * TIP[0] / HULL  # counter-ballast: on an even keel with its load
DAMPING = (1.2e6, 2.3e6, 0.0, 1.0e8, 0.0, 2.2e9)  # linear; of roll about 5 % of critical
SPRING, SPAN = 150e3, 40.0  # N/m, m: four mooring springs
CLEARANCE = 1.2  # m
SIZE = np.array([24.0, 28.0, 16.0])
EDGES = (-9.4, 9.4)  # m, along the tank: of the outermost guides
GUIDED = -3.0  # m, height of the guides over the centre of the tank at the end


def generator():
    """make_models.py of cases/tank_in_hull."""
    file = HERE.parent / "tank_in_hull" / "make_models.py"
    spec = importlib.util.spec_from_file_location("make_models_tank_in_hull", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def make_models():
    """Write both models."""
    models = generator()
    tank, hold = models.Soup(), models.Soup()
    ends = (-12.0, 12.0)
    for a, b in pairwise(models.mirrored(models.TANK_SECTION)):
        tank.extrude(a, b, ends, (6, 4))
    for x in ends:
        for (ya, za), (yb, zb) in pairwise(models.TANK_SECTION[1:5]):
            tank.patch((x, -ya, za), (x, ya, za), (x, yb, zb), (x, -yb, zb), (4, 2))
    starboard = [np.array(p) * (-1.0, 1.0) for p in models.INNER_HULL[::-1]]
    for a, b in pairwise(starboard + [np.array(p) for p in models.INNER_HULL[1:]]):
        hold.extrude(a, b, (-16.0, 16.0), (4, 2))
    for x, y in models.CHOCKS:
        hold.open_box((x, y, models.SUPPORT_LEVEL), (0.275, 0, 0), (0, 0.425, 0), (0, 0, -0.9))
    for x, side in models.GUIDES:
        face = 0.5 * SIZE[1] + CLEARANCE
        hold.open_box((x, side * face, -1.0), (0.3, 0, 0), (0, 0, 0.4 * side), (0, (15.403 - face) * side, 0))
    for name, soup, seed in (("tank", tank, 24), ("hold", hold, 32)):
        triangles = soup.triangles(seed=seed)
        models.write_stl(HERE / f"{name}.stl", triangles)
        sys.stdout.write(f"{name}.stl: {len(triangles)} triangles\n")


def waves():
    """Periods [s] and heights [m] of Table 4-1."""
    lines = [line for line in (HERE / "waves.csv").read_text().splitlines() if not line.startswith("#")]
    return [(float(row["period_s"]), float(row["height_m"])) for row in csv.DictReader(lines)]


def response(period):
    """Motions of the crane (6,), hooks and tank across, per metre of amplitude, in a wave from abeam (towards +y)."""
    w = 2.0 * np.pi / period
    with h5py.File(HERE / "barge.nc") as file:
        omega, headings = file["omega"][:], np.rad2deg(file["wave_direction"][:])
        real, imaginary = file["excitation_force"][:]
        at = int(np.argmin(np.abs(headings - 90.0)))

        def between(table):
            return CubicSpline(omega, table)(w)

        A, B = between(file["added_mass"][:]), between(file["radiation_damping"][:])
        X = between(real[:, at]) + 1j * between(imaginary[:, at])
    A, B = 0.5 * (A + A.T), 0.5 * (B + B.T)
    c = np.array([CENTRE, 0.0, HEIGHT])
    S = np.array([[0, -c[2], c[1]], [c[2], 0, -c[0]], [-c[1], c[0], 0]])
    M = np.zeros((10, 10))
    M[:3, :3] = HULL * np.eye(3)
    M[:3, 3:6], M[3:6, :3] = -HULL * S, HULL * S
    M[3:6, 3:6] = HULL * (np.diag(np.square(GYRADII)) + S.T @ S)
    sway, heave, roll, pitch, yaw, hooks, tank, hooks_yaw, tank_yaw = np.eye(10)[1:]
    up = heave - TIP[0] * pitch
    M += (TANK + HOOKS) * np.outer(up, up)
    M[6, 6], M[8, 8] = HOOKS, HOOKS * 2.0 * ARM**2
    M[9, 9] = TANK * (SIZE[0] ** 2 + SIZE[1] ** 2) / 12.0
    centre_of_tank = tank + 0.5 * SIZE[2] * roll  # across, from that of the lugs
    M += TANK * np.outer(centre_of_tank, centre_of_tank)
    M[3, 3] += TANK * (SIZE[1] ** 2 + SIZE[2] ** 2) / 12.0
    M[4, 4] += TANK * (SIZE[0] ** 2 + SIZE[2] ** 2) / 12.0
    C = np.zeros((10, 10))
    weight = DENSITY * GRAVITY * VOLUME
    moment = -0.5 * DRAFT * weight - HEIGHT * HULL * GRAVITY - TIP[2] * (TANK + HOOKS) * GRAVITY
    moment += 0.5 * SIZE[2] * TANK * GRAVITY  # the tank turns with the crane about its lugs
    C[2, 2] = DENSITY * GRAVITY * LENGTH * BREADTH
    C[3, 3] = DENSITY * GRAVITY * LENGTH * BREADTH**3 / 12.0 + moment
    C[4, 4] = DENSITY * GRAVITY * BREADTH * LENGTH**3 / 12.0 + moment
    C[1, 1], C[0, 0], C[5, 5] = 2 * SPRING, 2 * SPRING, 2 * SPRING * SPAN**2
    k_1, k_2 = (TANK + HOOKS) * GRAVITY / FALL, TANK * GRAVITY / SLING
    tip = sway - TIP[2] * roll + TIP[0] * yaw
    for k, upper, lower in ((k_1, tip, hooks), (k_2, hooks, tank)):
        C += k * np.outer(upper - lower, upper - lower)
    for k, upper, lower in ((k_1, yaw, hooks_yaw), (k_2, hooks_yaw, tank_yaw)):
        C += k * 2.0 * ARM**2 * np.outer(upper - lower, upper - lower)
    Z = np.zeros((10, 10), dtype=complex)
    Z[:6, :6] = -(w**2) * A - 1j * w * (B + np.diag(DAMPING))
    Z += C - w**2 * M
    motions = np.linalg.solve(Z, np.concatenate([X, np.zeros(4)]))
    return np.append(motions, centre_of_tank @ motions)


def reach(motions):
    """How far the sides of the tank get at its guides (m): by its centre, roll and yaw."""
    return max(abs(motions[-1] + x * motions[9] - GUIDED * motions[3]) for x in EDGES)


def scene(name, x_0, held):
    """A crane with its tank, at x_0; over the hold, or over nothing."""
    hook_z = TIP[2] - (FALL - LOWERED)
    tank_z = hook_z - SLING - 0.5 * SIZE[2]
    inertia = TANK * (np.sum(SIZE**2) - SIZE**2) / 12.0
    own = HULL * np.square(GYRADII)
    text = f"""
[bodies.crane_{name}]
type = "rigid"
mass = {HULL:.9g}
inertia = [{own[0]:.9g}, {own[1]:.9g}, {own[2]:.9g}]
centre_of_mass = [{CENTRE:.9g}, 0, {HEIGHT}]
frame = {{ motion = "free" }}
initial = {{ position = [{x_0}, 0, 0] }}

[[surfaces]]
name = "plating_{name}"
body = "crane_{name}"
shape = {{ type = "box", size = ["97.5 m", "36 m", "7.5 m"] }}
at = [0, 0, "-0.75 m"]

[hulls.crane_{name}]
surface = "plating_{name}"
restoring = "clipped"
damping = [{", ".join(f"{d:g}" for d in DAMPING)}]

[databases.crane_{name}]
file = "barge.nc"
hulls = ["crane_{name}"]
memory_length = "60 s"
"""
    springs = (("bow", 0.0, (1, 0)), ("stern", 0.0, (-1, 0)), ("fore", SPAN, (0, 1)), ("aft", -SPAN, (0, 1)))
    for spring, x, (i, j) in springs:
        text += f"""
[[forces]]
name = "{spring}_{name}"
type = "spring"
between = ["ground", "crane_{name}"]
points = [[{x_0 + x + 1000 * i}, {1000 * j}, 0], [{x}, 0, 0]]
stiffness = "150 kN/m"
"""
    text += f"""
[bodies.tank_{name}]
type = "rigid"
mass = {TANK}
inertia = [{inertia[0]:.9g}, {inertia[1]:.9g}, {inertia[2]:.9g}]
frame = {{ motion = "free" }}
initial = {{ position = [{x_0 + TIP[0]}, 0, {tank_z}] }}

[[surfaces]]
name = "tank_plating_{name}"
body = "tank_{name}"
file = "tank.stl"
"""
    if held:
        text += f"""
[[surfaces]]
name = "hold"
body = "ground"
file = "hold.stl"
at = [{x_0 + TIP[0]}, 0, {tank_z - LOWERED - ABOVE}]

[[collisions]]
name = "guides"
between = ["hold", "tank_plating_{name}"]
law = "rigid"
friction = 0.3
patch_size = "1.2 m"
clearance = true
"""
    places = (("fore_port", 1, 1), ("fore_starboard", 1, -1), ("aft_port", -1, 1), ("aft_starboard", -1, -1))
    for place, i, j in places:
        x, y = i * ARM, j * ARM
        text += f"""
[bodies.hook_{place}_{name}]
type = "rigid"
mass = "40 t"
inertia = ["20 t m^2", "20 t m^2", "20 t m^2"]
frame = {{ motion = "free" }}
initial = {{ position = [{x_0 + TIP[0] + x}, {y}, {hook_z}] }}

[[ropes]]
name = "fall_{place}_{name}"
axial_stiffness = "2 GN"
damping = "500 kN s/m"
path = [
    {{ body = "crane_{name}", point = [{TIP[0] + x}, {y}, {TIP[2]}] }},
    {{ body = "hook_{place}_{name}", point = [0, 0, 0] }},
]
winch = {{ times = ["2 s", "{2 + LOWERED / SPEED} s"], speeds = ["{-SPEED} m/s", 0], acceleration = "0.025 m/s^2" }}

[[ropes]]
name = "sling_{place}_{name}"
axial_stiffness = "2 GN"
damping = "500 kN s/m"
path = [
    {{ body = "hook_{place}_{name}", point = [0, 0, 0] }},
    {{ body = "tank_{name}", point = [{x}, {y}, {0.5 * SIZE[2]}] }},
]
"""
    return text


def case_text(number, period, height):
    """One wave: the crane at the hold, and the same one without it."""
    motions = 0.5 * height * response(period)
    free, aside = abs(motions[-1]), reach(motions)
    touches = aside > CLEARANCE
    text = f"""title = "LPG tank lowered into a hold, wave {number}: {period:g} s, {height:g} m, from abeam"
sources = [
    "Integrated simulation ... (2018), section 4.2, Table 4-1",
    "linear theory: make_case.py, which writes this file",
]

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[sea]
density = "1025 kg/m^3"
ramp = "100 s"
waves = {{ type = "regular", height = "{height} m", period = "{period} s", direction = "90 deg" }}

# crane of 97.5 x 36 m, with boom and counter-ballast; its load hangs ahead of the bow
{scene("erects", 0.0, held=True)}
# the same without a hold: how the tank would swing
{scene("swings", 3000.0, held=False)}
[simulate]
start = "equilibrium"
step = "20 ms"
output_interval = "0.2 s"
duration = "300 s"

[report]
channels = [
    "tank_erects.position", "tank_swings.position", "crane_erects.position", "guides.gap_min", "guides.impacts",
    "guides.impact_impulse", "fall_*_erects.tension",
]
"""
    text += f"""
[[check]]
id = "contact_{number}"
quantity = "channel.guides.impacts.end"
{"minimum = 1" if touches else "maximum = 0"}
source = "linear theory: the sides of the tank alone get {aside:.3f} m aside, and the clearance is {CLEARANCE} m"

[[check]]
id = "gap_min_{number}"
quantity = "channel.guides.gap_min.min"
reference = "{max(0.0, CLEARANCE - aside):.4f} m"
tolerance = {{ absolute = "{1e-6 if touches else 0.03} m" }}
source = "{"touches, and nothing passes through" if touches else "clearance less the reach of linear theory"}"

[[check]]
id = "swing_{number}"
quantity = "channel.tank_swings.position.y.max"
reference = "{free:.4f} m"
tolerance = {{ relative = 0.06 }}
source = "linear theory, steady; the largest of the run has what is left of its beginning"

[[check]]
id = "energy_drift"
quantity = "drift.energy"
reference = 0.0
tolerance = {{ absolute = 1e-3 }}
source = "energy balance with waves, winches, damping and impacts"
"""
    return text


def main() -> None:
    """Write all."""
    make_models()
    for number, (period, height) in enumerate(waves(), start=1):
        motions = 0.5 * height * response(period)
        r = np.abs(motions)
        sys.stdout.write(
            f"{number}: sway {r[1]:.3f} heave {r[2]:.3f} roll {np.rad2deg(r[3]):.3f} deg, tank {r[-1]:.3f} m, "
            f"at its guides {reach(motions):.3f} m\n"
        )
        (HERE / f"wave_{number}.toml").write_text(case_text(number, period, height), encoding="utf-8")


if __name__ == "__main__":
    main()
