"""Writes case.toml, those of the shells and tables: moves of winches and trolleys, closed form of the shares.

    python make_case.py

Lugs a_u and a_l from the centre of mass along the plate and h above it. The hooks move so that, with the angle th,

    z_u - z_l = (a_u + a_l) sin th(t),        x_u - x_l = (a_u + a_l) cos th(t)

and falls stay vertical. Moments about the centre of mass then give the share of the upper falls,
(a_l + h tan th)/(a_u + a_l): 1/3 for 15 and 7.5 m in the plane of the plate, 1/2 + h tan th/(2 a) for lugs at +-a. All
moves go from rest to rest: the published scenario says nothing of speeds.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

HERE = Path(__file__).resolve().parent

RAMP, HOLD = (
    12.0,
    3.0,
)  # s: to these speeds, about a period of the hooks, so that they do not swing; between moves
UPPER, LOWER = 15.0, 7.5  # m, lugs of the plate from its centre of mass
TOGETHER_SPEED = 0.6  # m/s: all hooks at first
LINES = (-4.0, -2.0, 0.0, 2.0, 4.0)  # m, of a block loader
INSIDE = (-5.0, -2.5, 0.0, 2.5, 5.0)  # m, of that inside of the shells: nodes of their meshes
RIMS = 1.0  # t
FIRST = 2.0  # s, begin of the first move
PAID_OUT, PAID_OUT_SPEED = 1.0, 0.1  # of the lower hook, once the plate is upright
CROWN = 62.0  # m, height of the axes of the crowns
DURATION, SHELL_DURATION = 300.0, 200.0

BLOCK_ARM, BLOCK_HEIGHT = 15.0, 3.0  # m, lugs of the rigid block
BLOCK_ANGLES = np.deg2rad([0.0, 15.0, 30.0, 45.0, 60.0, 75.0])
BLOCK_SPEED, BLOCK_ACCELERATION = 0.5, 0.1  # of each fall [m/s, m/s^2]
BLOCK_FALL = 40.0  # m, at the start
LAST = (0.02, 0.003, 0.1)  # m/s: lower fall on from 75 degrees, before and while it becomes slack, and beyond
SLOWLY = 0.08  # m, before it is slack
SLACK = np.arctan2(BLOCK_ARM, BLOCK_HEIGHT)


def trapezoid(t, start, distance, speed, ramp):
    """Way at the times t of a move from rest to rest, as that of winches."""
    speed = min(speed, distance / ramp)
    whole = distance / speed + ramp
    t = np.clip(t - start, 0.0, whole)
    up, down = np.clip(t, 0.0, ramp), np.clip(whole - t, 0.0, ramp)
    middle = np.clip(t - ramp, 0.0, whole - 2.0 * ramp)
    return 0.5 * speed / ramp * (up**2 + ramp**2 - down**2) + speed * middle


def duration(distance, speed, ramp):
    """Of a move [s]."""
    return distance / min(speed, distance / ramp) + ramp


class TurnOver(NamedTuple):
    """A plate is hoisted by `together` [m], and turned by hooks to `angles` [deg], at `speeds` of the upper ones."""

    together: float
    angles: tuple[float, ...]
    speeds: tuple[float, ...]
    level: float = 0.0  # m: the lower hook is hoisted so much more at first, since its ropes stretch more

    def moves(self):
        """Moves (start, distance, speed) of upper and lower hooks, and the times of the angles at rest."""
        start = FIRST
        upper = [(start, self.together, TOGETHER_SPEED)]
        lower = [(start, self.together + self.level, TOGETHER_SPEED)]
        start += duration(self.together, TOGETHER_SPEED, RAMP) + HOLD
        rests = [start - 0.5 * HOLD]
        for step, speed in zip(np.diff(np.sin(np.deg2rad(self.angles))), self.speeds, strict=True):
            upper.append((start, UPPER * step, speed))
            lower.append((start, -LOWER * step, speed * LOWER / UPPER))
            start += duration(UPPER * step, speed, RAMP) + HOLD
            rests.append(start - 0.5 * HOLD)
        lower.append((start, -PAID_OUT, PAID_OUT_SPEED))
        return upper, lower, np.round(np.array(rests) * 2.0) / 2.0  # times that are recorded

    def angle(self, t):
        """Angle of the plate at the times t [rad]."""
        upper, lower, _ = self.moves()
        turned = way(t, upper[1:]) - way(t, lower[1:-1])
        return np.arcsin(np.clip(turned / (UPPER + LOWER), 0.0, 1.0))


RIGID = TurnOver(15.0, (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 90.0), (0.3, 0.3, 0.3, 0.3, 0.3, 0.1, 0.01))
SHELL = TurnOver(3.0, (0.0, 30.0, 60.0, 75.0, 85.0, 90.0), (0.4, 0.4, 0.2, 0.1, 0.01), 0.033)


def way(t, moves):
    """Of a hook at the times t [m], upwards."""
    return sum(np.sign(d) * trapezoid(t, start, abs(d), speed, RAMP) for start, d, speed in moves)


def thin_plate():
    """The plate as a rigid body without thickness, on three hooks with a block loader each."""
    text = """
[bodies.plate]
type = "rigid"
mass = "200 t"
inertia = ["6666.7 t m^2", "15000 t m^2", "21666.7 t m^2"]
frame = { motion = "free" }

[[surfaces]]
name = "plate_sides"
body = "plate"
shape = { type = "plane", size = ["30 m", "20 m"] }

[[relative_motions]]
name = "plate_angle"
between = ["ground", "plate"]
points = [[0, 0, 0], [0, 0, 0]]
"""
    return text + gantry(RIGID, "plate", "plate", [(-LOWER, d) for d in LINES], LOADER)


def gantry(turn, edge, inside, lugs, model):
    """Trolleys, hooks and block loaders that turn a plate over: lugs at its edge, and inside of it."""
    upper, lower, _ = turn.moves()
    text = trolley("upper", UPPER, 0.0, turn.angle)
    text += trolley("lower", -LOWER, 0.0, turn.angle)
    for number, side in enumerate((-5.0, 5.0), start=1):
        text += falls(f"edge_{number}", "upper", side, 16.0, upper)
        text += loader(f"loader_{number}", edge, f"edge_{number}", [(UPPER, side + d) for d in LINES], model)
    text += falls("inner", "lower", 0.0, 16.0, lower)
    return text + loader("loader_3", inside, "inner", lugs, model)


PLATES = {
    "steel": ("42.46 mm", "7850 kg/m^3", "42.46 mm of steel"),
    "thin": ("5 mm", "66666.7 kg/m^3", "5 mm with the density that makes 200 t"),
}
MESHES = {"": (6, 4), "_12x8": (12, 8)}
"""Elements, by what their files are called after the plate."""


def shell(name, elements):
    """The plate as a shell in rigid rims, turned over."""
    thickness, density, _ = PLATES[name]
    # waves of a tense plate cross so small an element in less than a step: strains that are carried leave the shape
    scheme = 'elasticity = "energy-momentum"\n' if elements != MESHES[""] else ""
    text = f"""
[bodies.plate]
type = "shell"
geometry = {{ type = "rectangle", size = ["30 m", "20 m"], elements = [{elements[0]}, {elements[1]}] }}
section = {{ thickness = "{thickness}", density = "{density}", young_modulus = "210 GPa", poisson_ratio = 0.3 }}
damping = {{ stiffness = "20 ms" }}
{scheme}initial = {{ position = ["-15 m", "-10 m", 0] }}

# a beam along the upper edge, and a rail along each side
[bodies.rims]
type = "rigid"
mass = "{RIMS:g} t"
inertia = ["60 t m^2", "100 t m^2", "160 t m^2"]
frame = {{ motion = "free" }}

[[surfaces]]
name = "beam_sides"
body = "rims"
shape = {{ type = "box", size = ["0.5 m", "20 m", "0.5 m"] }}
at = ["15 m", 0, 0]

[[joints]]
name = "beam"
type = "edge_hinge"
between = ["plate", "rims"]
edge = "x_max"

# the edges at the sides are held across the rail all along, and slide in it
[[repeat]]
count = {2 * elements[0]}

[[repeat.joints]]
name = "rail_{{i}}"
type = "cylindrical"
between = ["rims", "plate"]
at = ["{{-15 + {30.0 / elements[0]:g}*(i // 2)}} m", "{{-10 + 20*(i % 2)}} m", 0]
axis = [1, 0, 0]

[[relative_motions]]
name = "plate_angle"
between = ["ground", "rims"]
points = [[0, 0, 0], [0, 0, 0]]
"""
    lugs = [(15.0 - LOWER, 10.0 + d) for d in INSIDE]
    return text + gantry(SHELL, "rims", "plate", lugs, MASSLESS)


def hanging(name, y):
    """The plate as a shell that hangs upright on its clamped edge."""
    thickness, density, _ = PLATES[name]
    return f"""
[bodies.{name}]
type = "shell"
geometry = {{ type = "rectangle", size = ["30 m", "20 m"], elements = [6, 4] }}
section = {{ thickness = "{thickness}", density = "{density}", young_modulus = "210 GPa", poisson_ratio = 0.0 }}
damping = {{ stiffness = "20 ms" }}
supports = [{{ edge = "x_min", fix = "clamped" }}]
initial = {{ position = [0, "{y} m", "50 m"], orientation = {{ axis = [0, 1, 0], angle = "90 deg" }} }}
"""


def block_moves():
    """Times and ways of both falls, the times of BLOCK_ANGLES at rest, and that of the last move."""
    times, ways, rests, start = [0.0], [0.0], [0.5 * FIRST], FIRST
    for step in BLOCK_ARM * np.diff(np.sin(BLOCK_ANGLES)):
        times.append(start)
        ways.append(ways[-1] + step)
        top = min(BLOCK_SPEED, np.sqrt(step * BLOCK_ACCELERATION))
        start += step / top + top / BLOCK_ACCELERATION + HOLD
        rests.append(start - 0.5 * HOLD)
    return np.array(times), np.array(ways), np.round(np.array(rests) * 2.0) / 2.0, start


def block_last():
    """Targets of the lower fall from 75 degrees on until it is slack: times and speeds."""
    start = block_moves()[3]
    near = 2.0 * BLOCK_ARM * (np.sin(SLACK) - np.sin(BLOCK_ANGLES[-1])) - SLOWLY
    times = start + np.cumsum([0.0, near / LAST[0], (SLOWLY + 0.02) / LAST[1], 0.3 / LAST[2]])
    return times, np.array([-LAST[0], -LAST[1], -LAST[2], 0.0])


def block_angle(t):
    """Angle of the block at the times t [rad] until its lower fall is slack."""
    times, ways, _, _ = block_moves()
    moves = zip(times[1:], np.diff(ways), strict=True)
    both = 2.0 * sum(block_way(t, start, d) for start, d in moves)
    at, speeds = block_last()
    both = both - np.interp(t, at, np.concatenate([[0.0], np.cumsum(np.diff(at) * speeds[:-1])]))
    return np.arcsin(np.clip(both / (2.0 * BLOCK_ARM), 0.0, np.sin(SLACK)))


def block_way(t, start, distance):
    """Of a fall of the block in a move [m]."""
    top = min(BLOCK_SPEED, np.sqrt(distance * BLOCK_ACCELERATION))
    return trapezoid(t, start, distance, top, top / BLOCK_ACCELERATION)


def numbers(values, digits=6):
    """A list of TOML."""
    return "[" + ", ".join(f"{round(float(v), digits):.{digits}g}" for v in values) + "]"


def trolley(name, arm, y, angle, height=0.0):
    """A body without weight in the balance, driven along x so that it stays above lugs at the distance `arm`."""
    times = np.linspace(0.0, DURATION, round(DURATION) + 1)
    return f"""
[bodies.{name}]
type = "rigid"
mass = "20 t"
inertia = ["20 t m^2", "20 t m^2", "20 t m^2"]
initial = {{ position = [{arm}, "{y} m", "{CROWN} m"] }}

[bodies.{name}.frame]
motion = "driven"

[bodies.{name}.frame.x]
times = {numbers(times)}
values = {numbers(arm * (np.cos(angle(times)) - 1.0) - height * np.sin(angle(times)))}
interpolation = "monotone"
"""


def moves_toml(moves):
    """Of falls."""
    rows = [
        f'    {{ start = "{t:.6f} s", distance = "{d:.9f} m", speed = "{v:.9f} m/s", ramp = "{r:g} s" }},'
        for t, d, v, r in ((t, d, min(v, (1.0 - 1e-6) * abs(d) / RAMP), RAMP) for t, d, v in moves)
    ]
    return "[\n" + "\n".join(rows) + "\n]"


LOADER = """pulley = { mass = "800 kg" }
travel = { up = "2 m", down = "2 m", damping = "500 kN s/m" }
"""
MASSLESS = """model = "massless"
travel = { up = "2 m", down = "2 m" }
"""


def loader(name, plate, hook, lugs, model):
    """An equalizer with five lines."""
    lines = "\n".join(f'    {{ body = "{plate}", point = ["{x} m", "{y} m", 0] }},' for x, y in lugs)
    return f"""
[[equalizers]]
name = "{name}"
hook = {{ body = "{hook}_block", point = [0, 0, "-1.5 m"] }}
along = [0, 1, 0]
sheave_radius = "0.5 m"
part_length = "2.5 m"
beam = {{ mass = "10 t" }}
{model}rope = {{ axial_stiffness = "600 MN", damping = "100 kN s/m" }}
line = {{ axial_stiffness = "300 MN", damping = "100 kN s/m" }}
lines = [
{lines}
]
"""


def falls(name, carrier, y, hook_height, moves):
    """A hook on eight parts."""
    return f"""
[[falls]]
name = "{name}"
crown = {{ body = "{carrier}", point = [0, "{y} m", 0] }}
along = [0, 1, 0]
parts = 8
sheave_radius = "0.5 m"
drop = "{CROWN - hook_height} m"
block = {{ mass = "15 t" }}
rope = {{ axial_stiffness = "256.5 MN", damping = "100 kN s/m" }}
moves = {moves_toml(moves)}
"""


def block():
    """The rigid block on two falls."""
    times, ways, _, _ = block_moves()
    text = f"""
[bodies.block]
type = "rigid"
mass = "200 t"
inertia = ["6667 t m^2", "15000 t m^2", "21667 t m^2"]
frame = {{ motion = "free" }}
initial = {{ position = [0, "-60 m", "{CROWN - BLOCK_FALL - BLOCK_HEIGHT} m"] }}

[[surfaces]]
name = "block_sides"
body = "block"
shape = {{ type = "box", size = ["30 m", "20 m", "6 m"] }}

[[relative_motions]]
name = "block_angle"
between = ["ground", "block"]
points = [[0, 0, 0], [0, 0, 0]]
"""
    for name, arm, sign in (("upper", BLOCK_ARM, 1.0), ("lower", -BLOCK_ARM, -1.0)):
        at, speeds = [], []
        for start, step in zip(times[1:], np.diff(ways), strict=True):
            top = min(BLOCK_SPEED, (1.0 - 1e-6) * np.sqrt(step * BLOCK_ACCELERATION))
            at += [start, start + step / top]
            speeds += [sign * top, 0.0]
        if name == "lower":
            more, targets = block_last()
            at, speeds = [*at, *more], [*speeds, *targets]
        text += trolley(f"block_{name}", arm, -60.0, block_angle, BLOCK_HEIGHT)
        text += f"""
[[ropes]]
name = "block_{name}_fall"
axial_stiffness = "20 GN"
damping = "3 MN s/m"
path = [
    {{ body = "block_{name}", point = [0, 0, 0] }},
    {{ body = "block", point = ["{arm} m", 0, "{BLOCK_HEIGHT} m"] }},
]
winch = {{ times = {numbers(at, 9)}, speeds = {numbers(speeds, 9)}, acceleration = {BLOCK_ACCELERATION} }}
"""
    return text


HEAD = """title = "A plate of 200 t is turned over on three block loaders, and a rigid block on two falls"
sources = [
    "Integrated simulation ... (2018), section 4.3.1: plate of 30 x 20 m and 200 t, three block loaders, gantry crane",
    "moments about the centre of mass: make_case.py, which writes this file",
]

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

# --- the plate as a rigid body in a plane, on three falls with a block loader each; trolleys keep the falls vertical
"""

CHECKS = """
[[sensors]]
name = "top_of_steel"
body = "steel"
point = [0, "10 m", 0]

[[sensors]]
name = "top_of_thin"
body = "thin"
point = [0, "10 m", 0]

[[reference]]
name = "edge_share"
channel = "ratio(sum(loader_[12]_line_*.tension), sum(loader_*_line_*.tension))"
file = "edge_share.csv"
until = "EDGE s"

[[reference]]
name = "block_share"
channel = "ratio(block_upper_fall.tension, sum(block_*_fall.tension))"
file = "block_share.csv"
until = "BLOCK s"

[simulate]
start = "equilibrium"
step = "20 ms"
output_interval = "0.5 s"
duration = "DURATION s"

[report]
channels = [
    "plate_angle.tilt", "sum(loader_1_line_*.tension)", "sum(loader_2_line_*.tension)", "sum(loader_3_line_*.tension)",
    "ratio(sum(loader_[12]_line_*.tension), sum(loader_*_line_*.tension))",
    "block_angle.tilt", "block_upper_fall.tension", "block_lower_fall.tension",
]

[[check]]
id = "edge_share"
quantity = "deviation.edge_share"
reference = 0.0
tolerance = { absolute = 1.5e-3 }
source = "a_l/(a_u + a_l) = 1/3 at rest at 0, 15, 30, 45 and 60 degrees: lugs in the plane of the centre of mass"

[[check]]
id = "edge_share_least"
quantity = "channel.ratio(sum(loader_[12]_line_*.tension), sum(loader_*_line_*.tension)).min"
reference = 0.3333333
tolerance = { relative = 0.03 }
source = "1/3 until the plate is upright; with an angle, hooks that swing count by its tangent"

[[check]]
id = "upright"
quantity = "channel.ratio(sum(loader_[12]_line_*.tension), sum(loader_*_line_*.tension)).end"
reference = 1.0
tolerance = { absolute = 1e-12 }
source = "the inner loader is slack"

[[check]]
id = "plate_angle"
quantity = "channel.plate_angle.tilt.end"
reference = "90 deg"
tolerance = { absolute = "0.5 deg" }
source = "hangs on lugs in its plane"

[[check]]
id = "loader_spread"
quantity = "channel.ratio(loader_1_line_*.tension, sum(loader_1_line_*.tension)).max"
reference = 0.2
tolerance = { relative = 2e-3 }
source = "one rope over all five pulleys"

[[check]]
id = "block_shares"
quantity = "deviation.block_share"
reference = 0.0
tolerance = { absolute = 2e-3 }
source = "1/2 + h tan th/(2 a) at rest at 0, 15, 30, 45, 60 and 75 degrees"

[[check]]
id = "slack_angle"
quantity = "channel.block_angle.tilt.end"
reference = "78.690068 deg"
tolerance = { absolute = "0.05 deg" }
source = "tan th = a/h: the lower fall is slack, and the centre of mass below the upper lug"

[[check]]
id = "slack_fall"
quantity = "channel.block_lower_fall.tension.end"
reference = "0 N"
tolerance = { absolute = 1e-9 }
source = "beyond the slack angle"

[[check]]
id = "mean_stress_steel"
quantity = "stress.top_of_steel.middle.xx.end"
reference = "2.3104 MPa"
tolerance = { relative = 1e-3 }
source = "200 t g/(20 m x 42.46 mm) at the edge on which it hangs"

[[check]]
id = "mean_stress_thin"
quantity = "stress.top_of_thin.middle.xx.end"
reference = "19.62 MPa"
tolerance = { relative = 1e-3 }
source = "200 t g/(20 m x 5 mm) at the edge on which it hangs"

[[check]]
id = "energy_drift"
quantity = "drift.energy"
reference = 0.0
tolerance = { absolute = 1e-6 }
source = "energy balance with the work of winches and trolleys, and what ropes and plates damp"
""".replace("DURATION", f"{DURATION:g}")


SHELL_HEAD = """title = "A plate of 200 t (WORDS) is turned over on three block loaders, as a shell in rigid rims"
sources = [
    "Integrated simulation ... (2018), section 4.3.1: plate of 30 x 20 m and 200 t, three block loaders, gantry crane",
    "balance of forces and moments: make_case.py, which writes this file",
]

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]
"""


def shell_end(name, elements):
    """What is computed and checked of a shell."""
    share = "ratio(sum(loader_[12]_rope.tension), sum(loader_?_rope.tension))"
    at_rest = SHELL.moves()[2]
    thickness = float(PLATES[name][0].removesuffix(" mm"))
    density = float(PLATES[name][1].removesuffix(" kg/m^3"))
    text = f"""
[simulate]
start = "equilibrium"
step = "20 ms"
output_interval = "0.5 s"
duration = "{SHELL_DURATION:g} s"

[report]
channels = [
    "plate_angle.tilt", "plate.von_mises", "loader_?_rope.tension", "{share}",
]

[[check]]
id = "edge_share"
quantity = "channel.{share}.mean"
reference = 0.3333333
tolerance = {{ relative = 5e-3 }}
until = "{at_rest[0]:g} s"
source = "a_l/(a_u + a_l) = 1/3: moments about the centre of mass of plate and rims, while it lies"

[[check]]
id = "upright"
quantity = "channel.{share}.end"
reference = 1.0
tolerance = {{ absolute = 1e-12 }}
source = "the inner loader is slack"

[[check]]
id = "plate_angle"
quantity = "channel.plate_angle.tilt.end"
reference = "90 deg"
tolerance = {{ absolute = "0.5 deg" }}
source = "hangs on lugs in its plane"
"""
    # away from the beam and from the free edge, nearest to 12.5, 17.5 and 22.5 m; elements of a row follow each other
    for number, place in enumerate((12.5, 17.5, 22.5), start=3):
        row = int(place * elements[0] / 30.0)
        above = (row + 0.5) * 30.0 / elements[0]
        force = density * thickness * 1e-3 * 9.81 * above
        text += f"""
[[check]]
id = "membrane_stress_{number}"
quantity = "channel.plate.membrane_force.{row * elements[1] + elements[1] // 4}.xx.end"
reference = "{force:.8g} N/m"
tolerance = {{ relative = 0.02 }}
source = "weight of the {above:g} m below: {force / thickness * 1e-3:.4g} MPa; 200 t g/(20 m t) for all 30 m"
"""
    return (
        text
        + """
[[check]]
id = "energy_drift"
quantity = "drift.energy"
reference = 0.0
tolerance = { absolute = 1e-6 }
source = "energy balance with the work of winches and trolleys, and what ropes and plate damp"
"""
    )


def references():
    """Times and shares of the edge hooks of the plate and of the upper fall of the block, by file."""
    rests = RIGID.moves()[2][:5]
    edge = np.column_stack([np.concatenate([[0.0], rests]), np.full(6, LOWER / (UPPER + LOWER))])
    shares = 0.5 + BLOCK_HEIGHT * np.tan(BLOCK_ANGLES) / (2.0 * BLOCK_ARM)
    return {"edge_share.csv": edge, "block_share.csv": np.column_stack([block_moves()[2], shares])}


def shell_case(name, elements):
    """A file of one of the shells."""
    return SHELL_HEAD.replace("WORDS", PLATES[name][2]) + shell(name, elements) + shell_end(name, elements)


def main() -> None:
    """Write the cases and both tables."""
    for name in PLATES:
        for word, elements in MESHES.items():
            (HERE / f"{name}{word}.toml").write_text(shell_case(name, elements), encoding="utf-8")
    text = HEAD + thin_plate()
    text += "\n# --- the rigid block: lugs 3 m above its centre of mass, two falls" + block()
    text += (
        "\n# --- the plate upright, as shells: 42.46 mm of steel, and 5 mm with the density that makes 200 t"
    )
    text += hanging("steel", 60.0)
    text += hanging("thin", 90.0) + CHECKS
    rests = RIGID.moves()[2][:5]
    text = text.replace("EDGE", f"{rests[-1]:.9g}").replace("BLOCK", f"{block_moves()[2][-1]:.9g}")
    (HERE / "case.toml").write_text(text, encoding="utf-8")
    for name, table in references().items():
        np.savetxt(HERE / name, table, "%.9g", ",", header="time,value", comments="")


if __name__ == "__main__":
    main()
