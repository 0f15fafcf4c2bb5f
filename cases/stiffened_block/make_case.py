"""Writes block.step and case.toml: surfaces of a double bottom, moves of hooks and trolley that turn it by 90 degrees.

    python make_case.py

Lugs A and B in the frame of the block, at (x, z) from its centre of mass. With the angle th by which A rises, their
distances from the centre along and above are

    X = x cos th - z sin th,        Z = x sin th + z cos th

Falls hang vertically where the trolleys stand X_A and X_B from the centre, so in equilibrium hooks A carry the share
-X_B/(X_A - X_B) of the weight. Hooks and trolley go from one angle to the next in equal times with equal ramps, on
chords of the arcs between. Hooks A rise by what both pairs of ropes stretch besides, as load goes from B to A.
"""

from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np

HERE = Path(__file__).resolve().parent

LENGTH, WIDTH, HEIGHT, BAY = 12.0, 10.0, 2.0, 2.0  # m
ABOVE = 10.0  # m, keel of the block above the rails at the start
GIRDER = 45.0  # m, crowns of the falls above the rails
DEPTH = 1.5  # m, of a hook below its sheaves
SLING = 6.0  # m, from hooks A to their lugs
HOOK_B = 26.0  # m, height of hooks B at the start
PART = 2.5  # m, from a hook B to the beam of its equalizer
EYE = 0.30  # m, of lugs
LUG_A, LUG_B = (LENGTH + EYE, 0.7), (2.0, HEIGHT + EYE)  # m, x and z of the pin holes
CENTRE = (5.999, 0.980)  # m, of mass, for the moves alone
WEIGHT, FALL, LINE = (
    1.178e6,
    150e6,
    200e6,
)  # N, of the block; stiffness of ropes of falls, of slings and lines
FIRST, STAGE, HOLD, RAMP, STAGES = 5.0, 22.0, 6.0, 8.0, 6  # s, and number of stages


def turned(th: float) -> tuple[float, float]:
    """Distances of the lugs from each other along and above at an angle."""
    dx, dz = LUG_A[0] - LUG_B[0], LUG_A[1] - LUG_B[1]
    return dx * np.cos(th) - dz * np.sin(th), dx * np.sin(th) + dz * np.cos(th)


def stretch(th: float) -> float:
    """What is lost of the height between A and B by the stretch of falls, slings and lines at an angle [m]."""
    a, b = (np.array(lug) - CENTRE for lug in (LUG_A, LUG_B))
    at = [x * np.cos(th) - z * np.sin(th) for x, z in (a, b)]
    share = -at[1] / (at[0] - at[1])
    rise = turned(th)[1] - turned(0.0)[1]
    fall_a = GIRDER - DEPTH - (ABOVE + LUG_A[1] + SLING) - rise
    fall_b = GIRDER - DEPTH - HOOK_B
    line = HOOK_B - PART - ABOVE - LUG_B[1]
    soft_a = fall_a / (8 * FALL) + SLING / LINE
    soft_b = fall_b / (8 * FALL) + line / (2 * LINE)
    return 0.5 * WEIGHT * (share * soft_a - (1.0 - share) * soft_b)


def moves() -> tuple[list[str], list[str]]:
    """Of hooks A and of their trolley, as tables."""
    hooks, trolley = [], []
    for k in range(STAGES):
        ends = [0.5 * np.pi * (k + i) / STAGES for i in (0, 1)]
        a, b = (np.add(turned(th), (0.0, stretch(th))) for th in ends)
        start = FIRST + k * (STAGE + HOLD)
        for rows, way in ((hooks, b[1] - a[1]), (trolley, b[0] - a[0])):
            speed = abs(way) / (STAGE - RAMP)
            places = f'start = "{start:g} s", distance = "{way:.6f} m"'
            rows.append(f'{{ {places}, speed = "{speed:.6f} m/s", ramp = "{RAMP:g} s" }}')
    return hooks, trolley


def listed(rows: list[str], indent: str) -> str:
    """Rows of a list, one a line."""
    return "[\n" + "".join(f"{indent}    {row},\n" for row in rows) + indent + "]"


def lug(
    name: str, foot: tuple[float, float, float], normal: tuple[int, int, int], along: tuple[int, int, int]
) -> str:
    """Table of a lug."""
    at = ", ".join(f'"{value:g} m"' if value else "0" for value in foot)
    return f"""
[bodies.block.geometry.lugs.{name}]
foot = [{at}]
normal = {list(normal)}
along = {list(along)}
thickness = "50 mm"
length = "0.6 m"
height = "{EYE:g} m"
radius = "0.16 m"
hole = "0.12 m"
bracket = "0.3 m"
"""


def write_case() -> None:
    """The case file."""
    hooks, trolley = moves()
    drop_a = GIRDER - DEPTH - (ABOVE + LUG_A[1] + SLING)
    drop_b = GIRDER - DEPTH - HOOK_B
    lugs = "".join(
        lug(f"a_{i}", (LENGTH, y, LUG_A[1]), (1, 0, 0), (0, 0, 1)) for i, y in enumerate((-3.0, 3.0), 1)
    )
    lugs += "".join(
        lug(f"b_{i}", (LUG_B[0], y, HEIGHT), (0, 0, 1), (1, 0, 0))
        for i, y in enumerate((-3.0, -1.0, 1.0, 3.0), 1)
    )
    a_hoists = "".join(
        f"""
[[gantry_cranes.trolleys.hoists]]
at = [0, "{y:g} m"]
drop = "{drop_a:g} m"
parts = 8
moves = {listed(hooks, "")}
"""
        for y in (-3.0, 3.0)
    )
    b_hoists = ", ".join(f'{{ at = [0, "{y:g} m"], drop = "{drop_b:g} m", parts = 8 }}' for y in (-2.0, 2.0))
    slings = "".join(
        f"""
[[ropes]]
name = "sling_{i}"
axial_stiffness = "200 MN"
damping = "200 kN s/m"
length = "{SLING:g} m"
path = [{{ body = "crane_hook_1_{i}_block", point = [0, 0, "-{DEPTH:g} m"] }}, {{ body = "block", point = "a_{i}" }}]
"""
        for i in (1, 2)
    )
    loaders = "".join(
        f"""
[[equalizers]]
name = "loader_{i}"
hook = {{ body = "crane_hook_2_{i}_block", point = [0, 0, "-{DEPTH:g} m"] }}
along = [0, 1, 0]
sheave_radius = "0.4 m"
part_length = "{PART:g} m"
beam = {{ mass = "2 t" }}
pulley = {{ mass = "400 kg" }}
travel = {{ up = "0.5 m", down = "0.5 m", damping = "200 kN s/m" }}
rope = {{ axial_stiffness = "300 MN", damping = "100 kN s/m" }}
line = {{ axial_stiffness = "200 MN", damping = "100 kN s/m" }}
lines = [{{ body = "block", point = "b_{2 * i - 1}" }}, {{ body = "block", point = "b_{2 * i}" }}]
"""
        for i in (1, 2)
    )
    text = (HERE / "parts.toml").read_text(encoding="utf-8")
    values = {
        "LUGS": lugs,
        "HOISTS_A": a_hoists,
        "HOISTS_B": b_hoists,
        "SLINGS": slings,
        "LOADERS": loaders,
        "TROLLEY_MOVES": listed(trolley, ""),
        "ABOVE": f"{ABOVE:g}",
        "GIRDER": f"{GIRDER:g}",
        "DEPTH": f"{DEPTH:g}",
        "X_A": f"{LUG_A[0]:g}",
        "X_B": f"{LUG_B[0]:g}",
        "SPAN": f"{LUG_A[0] - LUG_B[0]:g}",
    }
    for key, value in values.items():
        text = text.replace(f"<{key}>", value)
    (HERE / "case.toml").write_text(text.replace("\n\n\n", "\n\n"), encoding="utf-8")


def write_step() -> None:
    """The surfaces of the plates, in mm."""
    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ

    def rectangle(corner, first, second):
        points = [
            np.array(corner),
            np.array(corner) + first,
            np.array(corner) + first + second,
            np.array(corner) + second,
        ]
        tags = [occ.addPoint(*(1e3 * p)) for p in points]
        lines = [occ.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1], strict=True)]
        occ.addPlaneSurface([occ.addCurveLoop(lines)])

    x, y, z = np.diag([LENGTH, WIDTH, HEIGHT])
    low = (0.0, -WIDTH / 2, 0.0)
    rectangle(low, y, x)
    rectangle((0.0, -WIDTH / 2, HEIGHT), x, y)
    for at in np.arange(-WIDTH / 2, WIDTH / 2 + 0.1, BAY):
        rectangle((0.0, at, 0.0), x, z)
    for at in np.arange(0.0, LENGTH + 0.1, BAY):
        rectangle((at, -WIDTH / 2, 0.0), y, z)
    occ.synchronize()
    gmsh.write(str(HERE / "block.step"))
    gmsh.finalize()


if __name__ == "__main__":
    write_case()
    write_step()
