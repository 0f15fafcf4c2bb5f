"""All mistakes of a case are told in one go, before a stage takes its time."""

from __future__ import annotations

import pytest

SCENE = """
[bodies.crate]
type = "rigid"
mass = 2.0
inertia = [1, 1, 1]
frame = { motion = "free" }
initial = { position = ["200 mm", 0, "-1 m"] }

[bodies.cable]
type = "frame"
geometry = { type = "line", start = [0, 0, "1 m"], end = ["1 m", 0, "1 m"], elements = 4 }
section = { density = "5540 kg/m^3", young_modulus = "0.7 MPa", area = 1.8e-3, second_moment = 1.215e-8 }

[[joints]]
name = "pin"
type = "distance"
between = ["ground", "crate"]
points = [["200 mm", 0, "-1 m"], [0, 0, 0]]

[[joints]]
name = "cross"
type = "universal"
between = ["beam", "crate"]
at = ["200 mm", 0, 0]
axis = [1, 0, 0]
second_axis = [0, 1, 0]

[[ropes]]
name = "sling"
axial_stiffness = "1 MN"
path = [{ body = "beam", point = ["200 m", 0, 0] }, { body = "crate", point = [0, 0, 0] }]

[[sensors]]
name = "middle"
body = "cable"
point = ["0.5 m", "0.3 m", "1 m"]
"""


def test_errors_of_the_scene_come_together_before_the_mesh(heavylift, small_case, edit):
    """Of a joint, of points off a solid and off a cable: one line each, and no stage has run."""
    edit(small_case, ("[simulate]", SCENE + "\n[simulate]"), ('point = ["200 mm"', 'point = ["200 cm"'))
    result = heavylift("run", small_case)
    assert result.code == 2
    lines = result.error.splitlines()
    places = {line.removeprefix(f"{small_case / 'case.toml'}: ").partition(": ")[0] for line in lines}
    assert places == {"joints.0.points", "ropes.0.path.0.point", "sensors.0.point", "sensors.1.point"}
    assert all("expected" in line for line in lines)
    assert "mesh:" not in result.out
    assert not (small_case / "out").exists()


@pytest.mark.parametrize("command", ["mesh", "modes", "simulate", "verify"])
def test_every_command_that_computes_looks_first(heavylift, small_case, edit, command):
    edit(small_case, ('point = ["200 mm"', 'point = ["200 cm"'))
    result = heavylift(command, small_case)
    assert result.code == 2
    assert "sensors.0.point: point (2000, 20, 10) mm is not on the body" in result.error + result.out
    assert not (small_case / "out").exists()


def test_tables_that_do_not_fit_are_told_together(heavylift, small_case, edit):
    """A check of a mode that is not there, one of momentum, a history that is too short, and a sensor off its body."""
    (small_case / "tip.csv").write_text("time,x\n0,0\n0.01,1\n")
    edit(
        small_case,
        ("[report]", '[[reference]]\nname = "tip"\nchannel = "tip.position"\nfile = "tip.csv"\n\n[report]'),
        ('quantity = "ringdown.beam.1"', 'quantity = "ringdown.beam.7"'),
        ('point = ["200 mm"', 'point = ["200 cm"'),
        (
            'quantity = "mesh.beam.mass"\nreference = "0.312 kg"',
            'quantity = "drift.momentum"\nreference = 0.1',
        ),
    )
    result = heavylift("run", small_case)
    assert result.code == 2
    lines = result.error.splitlines()
    assert len(lines) == 4
    for line, words in zip(
        sorted(lines),
        (
            "check.0.quantity: 'drift.momentum': the fixed frame of 'beam' changes the momentum",
            "check.1.quantity: 'ringdown.beam.7' needs vector 7 of 3",
            "reference.0.file: tip.csv ends at 0.01 s, the simulation at 0.02 s",
            "sensors.0.point: point (2000, 20, 10) mm is not on the body",
        ),
        strict=True,
    ):
        assert f"{small_case / 'case.toml'}: {words}" in line


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("tip.positon", "did you mean 'position'?"),
        ("tap.position", "names 'tap', which does not exist; did you mean 'tip'?"),
        ("beam.tension", "expected a channel of 'beam': position"),
        ("energy.kinetc", "did you mean 'energy.kinetic'?"),
        ("tip", "is no channel; expected OWNER.CHANNEL"),
    ],
)
@pytest.mark.parametrize("key", ["channels", "spectra"])
def test_a_plot_of_what_is_not_recorded(heavylift, small_case, edit, key, name, words):
    edit(small_case, ("stress_modes = []", f'{key} = ["tip.position", "{name}"]'))
    result = heavylift("run", small_case)
    assert result.code == 2
    (line,) = result.error.splitlines()
    assert f"report.{key}.1: " in line
    assert words in line


@pytest.mark.parametrize(
    ("old", "key"),
    [('output_interval = "20 us"', "simulate.output_interval"), ("count = 3", "bodies.beam.modes.count")],
)
def test_what_has_a_default_is_not_missing(heavylift, small_case, edit, old, key):
    """Keys that must be given show no default: in the terminal, in docs/case_keys and in the JSON Schema."""
    edit(small_case, (old, ""))
    result = heavylift("run", small_case)
    assert result.code == 2
    assert f"{key}: is missing" in result.error
    shown = heavylift("schema", key.replace(".beam", "").rpartition(".")[0]).out
    (row,) = [line for line in shown.splitlines() if line.startswith(f"  {key.rpartition('.')[2]} ")]
    assert "default" not in row


def test_contacts_that_shall_start_at_rest(heavylift, small_case, edit):
    block = """
[bodies.ball]
type = "rigid"
mass = 1.0
inertia = [1, 1, 1]
frame = { motion = "free" }
initial = { position = [0, 0, "1 m"] }

[[surfaces]]
name = "floor"
body = "ground"
shape = { type = "plane", size = ["1 m", "1 m"] }

[[surfaces]]
name = "skin"
body = "ball"
shape = { type = "sphere", radius = "0.1 m" }

[[collisions]]
name = "bounce"
between = ["floor", "skin"]
law = "linear"
stiffness = "1 MN/m"
"""
    edit(small_case, ("[simulate]", block + '\n[simulate]\nstart = "equilibrium"'))
    result = heavylift("run", small_case)
    assert result.code == 2
    assert (
        "collisions.0.law: 'equilibrium' with law 'linear', by which surfaces cross at rest" in result.error
    )
    assert not (small_case / "out").exists()


def test_what_the_solver_refuses_of_rigid_parts_is_told_before_the_mesh(heavylift, small_case, edit):
    """A hinge whose two sides cannot move is no matter of the mesh of another body."""
    block = """
[bodies.wall]
type = "rigid"
mass = 1.0
inertia = [1, 1, 1]
frame = { motion = "fixed" }

[[joints]]
name = "pin"
type = "hinge"
between = ["ground", "wall"]
at = [0, 0, 0]
axis = [0, 0, 1]
"""
    edit(small_case, ("[simulate]", f"{block}\n[simulate]"))
    result = heavylift("run", small_case)
    assert result.code == 2
    (line,) = result.error.splitlines()
    assert f"{small_case / 'case.toml'}: joints.0.between: neither 'ground' nor 'wall' can move" in line
    assert not (small_case / "out").exists()


def test_a_line_on_a_bottom_that_is_not_there(heavylift, small_case, edit):
    """What does not fit and what cannot be put together therefore is one line."""
    line = """
[[lines]]
name = "bow"
between = ["ground", "beam"]
points = [[100, 0, -100], [0, 0, 0]]
on_seabed = true
fairlead_tension = "10 kN"
sections = [{ weight = "100 N/m" }]
"""
    for sea in ("", "[sea]\n"):
        edit(small_case, ("[simulate]", f"{sea}{line}\n[simulate]"))
        result = heavylift("run", small_case)
        assert result.code == 2
        (told,) = result.error.splitlines()
        assert "lines.0.on_seabed" in told
        edit(small_case, (f"{sea}{line}\n[simulate]", "[simulate]"))
