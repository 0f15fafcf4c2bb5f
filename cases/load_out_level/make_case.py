"""Write case.toml: bogies, stages of the load for ``heavylift ballast``, and the plan of the pumps from it.

python make_case.py            the case without a plan, then ``heavylift ballast`` on it, then the case with the plan
"""

from __future__ import annotations

import csv
import tempfile
from pathlib import Path

import numpy as np

from heavylift.pipeline.commands.ballast import ballast_command
from heavylift.pipeline.log import Log

SPEED = 0.1 / 3.6
ROWS = (np.arange(18) - 8.5) * 1.4
BLOCK, LINK = 1891.6e3, 80e3
END, LENGTH = 48.75, 10.0
START, STAGE, DURATION = 26.0, 60.0, 1680.0
TANKS = (-39.0, -19.5, 0.0, 19.5, 39.0)
WATER = 992.0e3
"""In each tank at the start [kg], with which the barge, the block midships and half of the links float at 4.5 m."""
HULL = 1025.0 * 97.5 * 36.0 * 4.5 - 5.0 * WATER - BLOCK - 0.5 * LINK

HEAD = """title = "Load-out over the end of a barge: pumps keep its end level with the quay while the load leaves"
sources = [
    "Integrated simulation ... (2018), section 4.4, Tables 4-3 and 4-5: barge, block and transporters",
    "capacity.csv: quasi-static histories of an independent prototype, row 0.1 km/h, link of 10 m, 20,000 t/h",
]

# written by make_case.py

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[sea]
density = "1025 kg/m^3"

[bodies.barge]
type = "rigid"
mass = {hull}
inertia = ["1.5e9 kg m^2", "5.5e9 kg m^2", "5.5e9 kg m^2"]
frame = {{ motion = "free" }}

[[surfaces]]
name = "plating"
body = "barge"
shape = {{ type = "box", size = ["97.5 m", "36 m", "6 m"] }}
at = [0, 0, "-1.5 m"]

[hulls.barge]
surface = "plating"
damping = [1e6, 1e6, 2e7, 2e9, 1e10, 1e9]

# moored: it heaves, rolls and pitches
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
origin = [0, 0, "1.5 m"]
sides = ["-18 m", "18 m"]
stations = ["-48.75 m", "48.75 m"]
heights = [0, 0]

[[decks]]
name = "quay"
origin = [0, 0, "1.5 m"]
sides = ["-18 m", "18 m"]
stations = ["56.75 m", "160 m"]
heights = [0, 0]

[bodies.block]
type = "rigid"
mass = "1891.6 t"
inertia = ["6e8 kg m^2", "3e8 kg m^2", "6e8 kg m^2"]
centre_of_mass = [0, 0, "10 m"]
frame = {{ motion = "free" }}

[bodies.block.initial]
position = [{start}, 0, "1.5 m"]
velocity = [{speed}, 0, 0]

[[joints]]
type = "guide"
name = "path"
between = ["ground", "block"]
at = [{start}, 0, "1.5 m"]
axis = [0, 0, 1]
reference = [1, 0, 0]
speed = "0.1 km/h"

[[transporters]]
name = "spmt"
body = "block"
wheel_radius = "0.37 m"
tyre_stiffness = "3 MN/m"
tyre_damping = "15 kN s/m"
line_damping = "20 kN s/m"
stroke_limits = ["-0.35 m", "0.35 m"]
"""

TAIL = """
[[controllers]]
name = "level"
hull = "barge"
pumps = ["pump_1", "pump_2", "pump_3", "pump_4", "pump_5"]
period = "1 s"
gain = 0.0162                        # 1/(3 x 20.5 s): what the lag and the period allow
trim = 0
levels = [{ point = ["48.75 m", 0, "1.5 m"], height = "1.5 m" }]

[[sensors]]
name = "edge"
body = "barge"
point = ["48.75 m", 0, "1.5 m"]

[simulate]
step = "25 ms"
output_interval = "10 s"
duration = "DURATION s"

[report]
channels = ["edge.position", "tank_1.mass", "tank_5.mass", "pump_1.flow", "pump_5.flow", "level.error", "level.share"]

[[check]]
id = "edge_max"
quantity = "channel.edge.position.z.max"
reference = "1.6894 m"               # 1.5 m, and 0.1894 m of capacity.csv
tolerance = { absolute = "0.02 m" }
source = "capacity.csv: the end of the barge stands above the quay where pumps cannot follow"

[[check]]
id = "edge_max_lag"
quantity = "channel.edge.position.z.max"
reference = "1.7006 m"
tolerance = { absolute = "3 mm" }
source = "quasi_static.py: the same with pumps that lag by 20 s and the stages of the plan"

[[check]]
id = "edge_min_lag"
quantity = "channel.edge.position.z.min"
reference = "1.4877 m"
tolerance = { absolute = "2 mm" }
source = "quasi_static.py: the plan begins at once, the pumps do not"

[[check]]
id = "edge_min"
quantity = "channel.edge.position.z.min"
reference = "1.5 m"
tolerance = { absolute = "0.02 m" }
source = "capacity.csv: it never is below"

[[check]]
id = "edge_end"
quantity = "channel.edge.position.z.end"
reference = "1.5 m"
tolerance = { absolute = "5 mm" }
source = "level with the quay again"

[[check]]
id = "water"
quantity = "channel.barge.ballast.end"
reference = "WATER kg"
tolerance = { relative = 1e-3 }
source = "as much water as the load that is ashore"

[[check]]
id = "pump_rate"
quantity = "channel.pump_5.flow.max"
reference = "4000 t/h"
tolerance = { relative = 1e-3 }
source = "the pump under the quay gives all that it can: a fifth of 20,000 t/h"
"""


def loads(time: float) -> tuple[float, float]:
    """Mass on the barge [kg] and its first moment [kg m], with half of the links: rows on the link by their share."""
    x = START + SPEED * time + ROWS
    share = np.clip(1.0 - (x - END) / LENGTH, 0.0, 1.0)
    each = BLOCK / 18.0
    mass = float((each * share).sum()) + 0.5 * LINK
    return mass, float((each * share * np.minimum(x, END)).sum()) + 0.5 * LINK * END


def text(plan: list[tuple[list[float], list[float]]] | None) -> str:
    """The case, with the times and rates of each pump."""
    parts = [HEAD.format(hull=repr(HULL), speed=repr(SPEED), start=START)]
    for end, rows in (("front", range(9, 18)), ("rear", range(9))):
        for side, trains in (("left", (6.0, 14.0)), ("right", (-6.0, -14.0))):
            places = [
                [round(float(ROWS[i]), 6), y + d, 0.0] for i in rows for y in trains for d in (-0.725, 0.725)
            ]
            listed = ",\n    ".join(str(place) for place in places)
            parts.append(
                f'\n[[transporters.groups]]\nname = "{end}_{side}"\noil_stiffness = "9.7 MN/m"\n'
                f"bogies = [\n    {listed},\n]\n"
            )
    for name, y in (("port", 10), ("starboard", -10)):
        parts.append(
            f'\n[[link_beams]]\nname = "{name}"\nhinged_on = "barge"\nhinge = ["48.75 m", "{y} m", "1.5 m"]\n'
            f'rests_on = "ground"\nedge = ["56.75 m", "{y} m", "1.5 m"]\nlength = "10 m"\nbreadth = "12 m"\n'
            'mass = "40 t"\nstiffness = "50 MN/m"\ndamping = "1.5 MN s/m"\nlip = "40 mm"\n'
        )
    mass, moment = loads(0.0)
    start = WATER - np.array(TANKS) * moment / float(np.square(TANKS).sum())
    for i, x in enumerate(TANKS):
        parts.append(
            f'\n[[tanks]]\nname = "tank_{i + 1}"\nhull = "barge"\nfloor = ["{x} m", 0, "-4 m"]\n'
            f'size = ["19.5 m", "20 m", "5.4 m"]\nmass = {round(float(start[i]), 3)!r}\n'
        )
        parts.append(
            f'\n[[pumps]]\nname = "pump_{i + 1}"\nsource = "sea"\ntarget = "tank_{i + 1}"\nreversible = true\n'
            'rate = "4000 t/h"\nlag = "20 s"\n'
        )
        if plan is not None:
            times, rates = plan[i]
            parts.append(f"times = {times}\nrates = {rates}\n")
    parts.append('\n[ballast]\nhull = "barge"\ndraft = "4.5 m"\napart = ["port_plate", "starboard_plate"]\n')
    for time in np.arange(0.0, DURATION + 1.0, STAGE).tolist():
        mass, moment = loads(time)
        z = 11.5 if mass > 0.5 * LINK + 1.0 else 1.5
        parts.append(
            f'\n[[ballast.stages]]\nname = "{time:.0f} s"\ntime = {time}\n'
            f"loads = [{{ mass = {mass!r}, point = [{moment / mass!r}, 0, {z}] }}]\n"
        )
    end = str(sum(start) + BLOCK)
    parts.append(TAIL.replace("DURATION", f"{DURATION:g}").replace("WATER", end))
    return "".join(parts)


def main() -> None:
    """Plan, and write."""
    here = Path(__file__).parent
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.toml").write_text(text(None), encoding="utf-8")
        ballast_command(Path(folder), out=Path(folder) / "out", log=Log(quiet=True))
        with (Path(folder) / "out" / "ballast" / "barge_ballast.csv").open() as file:
            rows = list(csv.DictReader(file))
    rates = np.array([[float(row[f"tank_{i + 1}_rate_kg_s"]) for i in range(5)] for row in rows[1:]])
    # where one pump cannot follow, all give the same share
    rates /= np.maximum(1.0, np.abs(rates).max(axis=1) / (4000e3 / 3600.0))[:, None]
    times = [float(row["time_s"]) for row in rows]
    plan = [(times, [*np.round(rates[:, i], 3).tolist(), 0.0]) for i in range(5)]
    (here / "case.toml").write_text(text(plan), encoding="utf-8")


if __name__ == "__main__":
    main()
