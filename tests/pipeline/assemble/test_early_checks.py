"""What is refused before anything is computed: never what the whole scene takes, and still what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from heavylift.pipeline import load_case
from heavylift.pipeline.assemble import early_checks
from heavylift.pipeline.assemble.early_checks import scene_errors

CASES = Path(__file__).resolve().parents[3] / "cases"

BASE = """
title = "Something that takes time beside something that weighs"

[bodies.load]
type = "rigid"
mass = "60 t"
inertia = [1e6, 1e6, 1e6]
centre_of_mass = [0, 0, "2.4 m"]
frame = { motion = "free" }

[simulate]
step = "10 ms"
output_interval = "0.1 s"
duration = "1 s"
"""
GRAVITY = '[gravity]\nacceleration = [0, 0, "-9.81 m/s^2"]\n'

TAKES_TIME = {
    "surface of a file": """
[[surfaces]]
name = "plates"
body = "load"
file = "block.stl"
""",
    "solid": """
[bodies.beam]
type = "flexible"
frame = { motion = "fixed" }
initial = { position = [50, 0, 0] }
geometry = { type = "blocks", add = [{ name = "b", from = [0, 0, 0], to = [5, 1, 1] }] }
material = { young_modulus = "210 GPa", poisson_ratio = 0.3, density = "1000 kg/m^3" }
mesh = { size = "1 m" }
modes = { count = 4 }
""",
    "database": """
[sea]
[bodies.barge]
type = "rigid"
mass = "3690 t"
inertia = [1.3e8, 9.4e8, 9.9e8]
frame = { motion = "free" }
[[surfaces]]
name = "shell"
body = "barge"
shape = { type = "box", size = ["60 m", "20 m", "5 m"] }
[hulls.barge]
surface = "shell"
[databases.own]
compute = { panel_size = "5 m", frequencies = { first = 0.3, last = 1.2, count = 4 }, processes = 1 }
hulls = ["barge"]
""",
}

NEEDS_GRAVITY = {
    "falls": """
[[falls]]
name = "hook"
crown = { body = "ground", point = [0, 0, "60 m"] }
parts = 4
sheave_radius = "0.4 m"
drop = "20 m"
block = { mass = "6 t" }
rope = { axial_stiffness = "90 MN" }
""",
    "hook_loads": """
[[ropes]]
name = "sling"
axial_stiffness = "60 MN"
path = [{ body = "ground", point = [0, 0, 20] }, { body = "load", point = [0, 0, 5] }]
[[hook_loads]]
name = "hook"
body = "load"
ropes = ["sling"]
""",
    "gantry crane": """
[[gantry_cranes]]
name = "crane"
span = "60 m"
girder_height = "50 m"
sheave_radius = "0.4 m"
block = { mass = "5 t" }
rope = { axial_stiffness = "100 MN" }
trolleys = [{ hoists = [{ drop = "15 m", parts = 8 }] }]
""",
    "transporter": """
[[decks]]
name = "yard"
sides = ["-5 m", "5 m"]
stations = ["-20 m", "20 m"]
heights = [0, 0]
[[transporters]]
name = "spmt"
body = "load"
wheel_radius = "0.37 m"
tyre_stiffness = "3 MN/m"
line_damping = "20 kN s/m"
groups = [
    { name = "a", oil_stiffness = "9.7 MN/m", bogies = [[2, 1, 0]] },
    { name = "b", oil_stiffness = "9.7 MN/m", bogies = [[2, -1, 0]] },
    { name = "c", oil_stiffness = "9.7 MN/m", bogies = [[-2, 1, 0]] },
    { name = "d", oil_stiffness = "9.7 MN/m", bogies = [[-2, -1, 0]] },
]
""",
}


def errors_of(folder: Path, *parts: str) -> list[str]:
    (folder / "case.toml").write_text("".join((BASE, *parts)))
    (folder / "block.stl").write_text("solid\nendsolid\n")
    return [str(error) for error in scene_errors(load_case(folder))]


@pytest.mark.parametrize("slow_part", TAKES_TIME)
@pytest.mark.parametrize("part", NEEDS_GRAVITY)
def test_what_weighs_has_the_gravity_of_the_case(part, slow_part, tmp_path):
    assert errors_of(tmp_path, GRAVITY, NEEDS_GRAVITY[part], TAKES_TIME[slow_part]) == []


@pytest.mark.parametrize("part", ["falls", "hook_loads", "gantry crane"])
def test_a_case_without_gravity_is_refused_before_it_takes_time(part, tmp_path):
    (error,) = errors_of(tmp_path, NEEDS_GRAVITY[part], TAKES_TIME["solid"])
    assert "no weight without gravity; expected [gravity]" in error


def test_every_case_with_cranes_passes_as_if_it_took_time(monkeypatch):
    monkeypatch.setattr(early_checks, "_takes_time", lambda _case: True)
    for name in ("gantry_lift", "floating_crane_lift", "equalizer", "spmt_bump", "load_out_level"):
        assert scene_errors(load_case(CASES / name)) == [], name


@pytest.mark.slow
def test_every_case_passes_as_if_it_took_time(monkeypatch):
    """A part of a scene is refused for nothing that the whole of it has."""
    monkeypatch.setattr(early_checks, "_takes_time", lambda _case: True)
    for file in sorted(CASES.glob("*/case.toml")):
        assert scene_errors(load_case(file)) == [], file
