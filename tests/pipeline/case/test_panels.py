"""Panels in a case: keys, what is wrong with them, and lugs that are interfaces."""

from __future__ import annotations

import pytest

from heavylift.numerics.outcome import InputError, InputErrors, Outcome
from heavylift.pipeline import load_case, load_results, run_case

CASE = """
title = "A deck panel on four slings"
sources = ["statics"]

[gravity]
acceleration = [0, 0, -10]

[bodies.panel]
type = "flexible"
frame = { motion = "free" }
material = { young_modulus = "206 GPa", poisson_ratio = 0.3, density = "7850 kg/m^3" }
mesh = { size = "0.5 m" }
modes = { count = 4, damping_ratio = 0.02 }

[bodies.panel.geometry]
type = "panels"
plates.deck = { corners = [[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0]], thickness = "10 mm" }

[bodies.panel.geometry.stiffeners.bars]
plate = "deck"
line = [[0, 0.5, 0], [4, 0.5, 0]]
step = [0, 1, 0]
count = 3
section = { shape = "flat", height = "150 mm", thickness = "12 mm" }
web = [0, 0, -1]

[bodies.panel.geometry.lugs.lug_1]
foot = [1, 0.5, 0]
along = [1, 0, 0]
normal = [0, 0, 2]
thickness = "20 mm"
length = "0.3 m"
height = "150 mm"
radius = "80 mm"
hole = "60 mm"

[bodies.panel.geometry.lugs.lug_2]
foot = [3, 2.5, 0]
along = [1, 0, 0]
normal = [0, 0, 1]
thickness = "20 mm"
length = "0.3 m"
height = "150 mm"
radius = "80 mm"
hole = "60 mm"

[[ropes]]
name = "sling_1"
axial_stiffness = "10 MN"
path = [{ body = "ground", point = [1, 0.5, 5] }, { body = "panel", point = "lug_1" }]

[[ropes]]
name = "sling_2"
axial_stiffness = "10 MN"
path = [{ body = "ground", point = [3, 2.5, 5] }, { body = "panel", point = "lug_2" }]

[simulate]
start = "equilibrium"
step = "1 ms"
output_interval = "10 ms"
duration = "20 ms"
"""


def _case(folder, text=CASE):
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text)
    return load_case(folder)


def test_ropes_end_at_the_pin_holes_of_lugs(tmp_path):
    case = _case(tmp_path / "panel")
    lug = case.bodies["panel"].interfaces["lug_1"]
    assert lug.at == pytest.approx((1.0, 0.5, 0.15))
    assert lug.group == "lug_1"
    assert run_case(case, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
    results = load_results(case)
    plates = 0.01 * 12.0 + 3 * 4.0 * 0.15 * 0.012
    eye = 0.5 * (0.3 + 0.16) * 0.15 + 0.5 * 3.14159 * 0.08**2 - 3.14159 * 0.03**2
    weight = 7850.0 * (plates + 2 * 0.02 * eye) * 10.0
    # symmetric about its centre, so half of the weight each
    for sling in ("sling_1", "sling_2"):
        assert results[f"{sling}.tension"][-1] == pytest.approx(0.5 * weight, rel=1e-3)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('mesh = { size = "0.5 m" }', "", r"bodies\.panel\.mesh\.size: no 'mesh\.size'"),
        (
            'thickness = "10 mm" }',
            'thickness = "0 mm" }',
            r"bodies\.panel\.geometry\.plates\.deck\.thickness",
        ),
        (', thickness = "10 mm" }', " }", r"bodies\.panel\.geometry\.plates\.deck\.thickness: is missing"),
        ('plate = "deck"', 'plate = "dek"', r"geometry\.stiffeners\.bars\.plate: plate 'dek' is unknown"),
        ("count = 3", "count = [3, 2]", r"stiffeners\.bars\.count: 1 steps and 2 counts"),
        (
            'shape = "flat"',
            'shape = "tee"',
            r"section\.flange_thickness: .* missing or too many for shape 'tee'",
        ),
        (
            'hole = "60 mm"',
            'hole = "160 mm"',
            r"lugs\.lug_1\.hole: 0\.16 m; expected less than twice the radius",
        ),
        ('point = "lug_2"', 'point = "lug_3"', "'panel' has no interface 'lug_3'; did you mean 'lug_2'"),
        (
            "plates.deck = {",
            'plates.deck = { faces = ["top"], ',
            r"plates\.deck\.corners: both corners and faces",
        ),
        ('type = "panels"', 'type = "panels"\nfile = "deck.step"', r"geometry"),
    ],
)
def test_what_is_wrong_is_said_at_its_key(tmp_path, old, new, message):
    with pytest.raises(InputErrors, match=message):
        _case(tmp_path / "panel", CASE.replace(old, new, 1))


def test_a_material_that_does_not_exist_is_refused(tmp_path):
    case = _case(tmp_path / "panel", CASE.replace('"206 GPa"', "206000"))
    with pytest.raises(InputError, match=r"bodies\.panel\.material.*: E 206000 Pa with 7850 kg/m\^3"):
        run_case(case, stages=("mesh",))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "foot = [3, 2.5, 0]",
            "foot = [3, 2.5, 0.2]",
            r"lugs\.lug_2: its foot at \(3000, 2500, 200\) mm stands on no",
        ),
        (
            "line = [[0, 0.5, 0], [4, 0.5, 0]]",
            "line = [[0, 0.5, 0], [5, 0.5, 0]]",
            r"stiffeners\.bars: it leaves the",
        ),
        ("web = [0, 0, -1]", "web = [1, 0, 0]", r"stiffeners\.bars\.web: its web is at 90 deg"),
    ],
)
def test_what_does_not_fit_together_is_said_when_it_is_meshed(tmp_path, old, new, message):
    case = _case(tmp_path / "panel", CASE.replace(old, new, 1))
    with pytest.raises(InputError, match=r"bodies\.panel\.geometry\." + message):
        run_case(case, stages=("mesh",))
