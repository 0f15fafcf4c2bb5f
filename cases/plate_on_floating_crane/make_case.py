"""Writes steel_0.toml ... thin_90.toml: the plate of either thickness on a floating crane, waves from three sides.

    python make_case.py

Crane and database are those of `cases/floating_crane_lift`, the ballast is for 400 t with hooks and loaders.
"""

from __future__ import annotations

from pathlib import Path

HERE = Path(__file__).resolve().parent

PLATES = {
    "steel": ("42.46 mm", "7850 kg/m^3", "42.46 mm of steel"),
    "thin": ("5 mm", "66666.7 kg/m^3", "5 mm with 200 t"),
}
HEADINGS = (0, 45, 90)
LUGS_X, LUG_Y = (1.5, 4.5, 7.5, 10.5, 13.5), 5.0  # m, of a quarter of the plate
HOOK_X, TIP_X = 7.5, 102.5  # m
LOAD, DISPLACED, HULL, BOOM = 400.0, 1.025 * 17710.0, 11600.0, 900.0  # t
BALLAST = DISPLACED - LOAD - HULL - BOOM
PLACE = -(TIP_X * LOAD + 76.25 * BOOM) / BALLAST  # on an even keel
DURATION, RAMP = 80, 30  # s
LINE, PART = 12.0, 2.0  # m
PLATE_Z = 50.93  # m, where lines of 12 m reach
DAF = f"""
[[check]]
id = "daf"
quantity = "channel.sum(crane_hook_*_rope.tension).max"
maximum = "{1.1 * LOAD * 9.81 / 12.0:.6g} kN"
source = "1.1: what a sound plate may add; a factor of 1.5 asks for 5 m/s^2 of the tip of the crane"
"""
QUARTERS = ((1, 1), (1, -1), (-1, 1), (-1, -1))


def case_text(plate: str, heading: int) -> str:
    """One file."""
    thickness, density, words = PLATES[plate]
    weight = (LOAD - 200.0 + 600.0 * float(thickness.split()[0]) * float(density.split()[0]) * 1e-6) * 9.81
    title = f"A plate of 30 x 20 m and 200 t ({words}) on a floating crane, waves of 1 m, 10 s, from {heading} degrees"
    text = f"""title = "{title}"
sources = [
    "Integrated simulation ... (2018), section 4.3.2, Table 4-2",
    "crane and crane.nc of cases/floating_crane_lift; make_case.py, which writes this file",
]

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[sea]
density = "1025 kg/m^3"
ramp = "{RAMP} s"
waves = {{ type = "regular", height = "1 m", period = "10 s", direction = "{heading} deg" }}

[bodies.hull]
type = "rigid"
mass = "{HULL:g} t"
inertia = ["2.2e9 kg m^2", "1.0e10 kg m^2", "1.1e10 kg m^2"]
centre_of_mass = [0, 0, "7 m"]
frame = {{ motion = "free" }}
initial = {{ position = [0, 0, 0] }}

[hulls.hull]
damping = [1.2e6, 2.3e6, 0.0, 2e8, 0.0, 2.2e9]

[hulls.hull.linear]
volume = "17710 m^3"
centre_of_buoyancy = [0, 0, "-1.75 m"]
reference = [0, 0, 0]
area = "5060 m^2"
second_moments = ["5102166.667 m^4", "892246.667 m^4", 0]

[databases.hull]
file = "crane.nc"
hulls = ["hull"]
memory_length = "60 s"

[[tanks]]
name = "counter_ballast"
hull = "hull"
point = ["{PLACE:.8f} m", 0, "-1 m"]
mass = "{BALLAST:.6g} t"

[[repeat]]
count = 4

[[repeat.forces]]
name = "mooring_{{i}}"
type = "spring"
between = ["ground", "hull"]
points = [
    ["{{155 - 310*(i // 2)}} m", "{{123 - 246*(i % 2)}} m", 0],
    ["{{55 - 110*(i // 2)}} m", "{{23 - 46*(i % 2)}} m", 0],
]
stiffness = "150 kN/m"

[[floating_cranes]]
name = "crane"
hull = "hull"
hinge = ["50 m", 0, "12 m"]
boom = {{ length = "105 m", angle = "60 deg", mass = "900 t", width = "20 m" }}
stay = {{ head = ["10 m", 0, "62 m"], parts = 24, rope = {{ axial_stiffness = "256.5 MN", damping = "5 kN s/m" }} }}
sheave_radius = "0.5 m"
block = {{ mass = "40 t" }}
rope = {{ axial_stiffness = "256.5 MN", damping = "5 kN s/m" }}
hooks = [
"""
    for i, j in QUARTERS:
        text += f'    {{ at = ["{HOOK_X * i} m", "{LUG_Y * j} m"], drop = "35 m", parts = 12 }},\n'
    text += f"""
]

[bodies.plate]
type = "shell"
geometry = {{ type = "rectangle", size = ["30 m", "20 m"], elements = [6, 4] }}
section = {{ thickness = "{thickness}", density = "{density}", young_modulus = "210 GPa", poisson_ratio = 0.3 }}
damping = {{ stiffness = "20 ms" }}
initial = {{ position = ["{TIP_X - 15.0} m", "-10 m", "{PLATE_Z} m"] }}
"""
    for number, (i, j) in enumerate(QUARTERS, start=1):
        text += f"""
[[equalizers]]
name = "loader_{number}"
model = "massless"
hook = {{ body = "crane_hook_{number}_block", point = [0, 0, "-1.5 m"] }}
sheave_radius = "0.75 m"
part_length = "{PART:g} m"
beam = {{ mass = "10 t" }}
travel = {{ up = "1 m", down = "1 m" }}
rope = {{ axial_stiffness = "600 MN", damping = "50 kN s/m" }}
line = {{ axial_stiffness = "300 MN", damping = "50 kN s/m" }}
lines = [
"""
        for x in LUGS_X if i > 0 else LUGS_X[::-1]:
            point = f'["{15.0 + i * x} m", "{10.0 + j * LUG_Y} m", 0]'
            text += f'    {{ body = "plate", point = {point}, length = "{LINE:g} m" }},\n'
        text += "]\n"
    daf = DAF if plate == "steel" else ""
    return (
        text
        + f"""
[simulate]
start = "equilibrium"
step = "20 ms"
output_interval = "0.2 s"
duration = "{DURATION} s"

[report]
channels = [
    "sum(crane_hook_*_rope.tension)", "crane_hook_*_rope.tension", "loader_*_rope.tension", "plate.von_mises",
    "hull.position",
]

[[check]]
id = "hook_sum_mean"
quantity = "channel.sum(crane_hook_?.rope_load).mean"
reference = "{weight:.7g} kN"
tolerance = {{ relative = 1e-4 }}
after = "40.1 s"
source = "weight of plate, blocks and loaders: over whole periods their momentum gains nothing"

[[check]]
id = "lines_at_rest"
quantity = "channel.sum(loader_*_rope.tension).mean"
reference = "{(weight - (LOAD - 200.0) * 9.81) / 10.0:.7g} kN"
tolerance = {{ relative = 1e-4 }}
until = "0.1 s"
source = "the plate on 20 lines, half of each in the rope of an equalizer, of which there are four"
{daf}
[[check]]
id = "energy_drift"
quantity = "drift.energy"
reference = 0.0
tolerance = {{ absolute = 1e-4 }}
source = "energy balance with waves, damping and what the plate damps"
"""
    )


def main() -> None:
    """Write all."""
    for plate in PLATES:
        for heading in HEADINGS:
            text = case_text(plate, heading)
            (HERE / f"{plate}_{heading}.toml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
