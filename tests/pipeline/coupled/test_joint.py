"""A joint that is cut: positions to one side, reactions to the other; one body in two programs."""

from __future__ import annotations

import math
import threading
from pathlib import Path

import pytest

import heavylift as hl
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.commands.couple import couple
from heavylift.pipeline.coupled.coupling_file import load_coupling
from heavylift.pipeline.coupled.run import CoupledScenes, run_coupled
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.storage import StopError

CASES = Path(__file__).parents[3] / "cases"
SIMULATE = "simulate = { step = 0.005, output_interval = 0.01, duration = 2 }\n"
TOLD = f"""
title = "What moves as it is told, with a mass"
bodies.part = {{ type = "rigid", mass = MASS, inertia = [1, 1, 1], frame = {{ motion = "driven" }} }}
inputs = [{{ type = "frame_speed", name = "speed", body = "part", axis = "x", interpolation = "linear" }}]
{SIMULATE}"""
TELLS = f"""
title = "A mass on a spring of 100 N/m, 0.1 m beside its place"
inputs = [{{ type = "force", name = "push", body = "cart", point = [0, 0, 0] }}]
forces = [{{ type = "joint_spring", name = "spring", joint = "rail", stiffness = 100 }}]
{SIMULATE}
[[joints]]
type = "slider"
name = "rail"
between = ["ground", "cart"]
points = [[0, 0, 0], [0, 0, 0]]
axis = [1, 0, 0]

[bodies.cart]
type = "rigid"
mass = 2
inertia = [1, 1, 1]
frame = {{ motion = "free" }}
initial = {{ position = [0.1, 0, 0] }}
"""
COUPLING = """
title = "One body in two programs"

[scenes]
told = { case = "told" }
tells = { case = "tells" }

[[links]]
output = "tells.cart.velocity.x"
input = "told.speed"

[[links]]
output = "told.part.reaction_force.x"
input = "tells.push"
factor = -1

[exchange]
interval = "10 ms"
"""


@pytest.fixture
def scenes(tmp_path):
    def make(mass):
        for name, text in (("told", TOLD.replace("MASS", str(mass))), ("tells", TELLS)):
            (tmp_path / name).mkdir(exist_ok=True)
            (tmp_path / name / "case.toml").write_text(text)
        (tmp_path / "coupling.toml").write_text(COUPLING)
        return tmp_path

    return make


@pytest.mark.parametrize("mass", [0.2, 2.0, 60.0])
def test_a_joint_is_one_body_whatever_the_masses(scenes, mass):
    """``x = 0.1 exp(-d t) cos(w t)``, ``w^2 = k / (m1 + m2)``; a plain repetition would diverge from m1 = m2 on.

    The inertia of what is told acts half an interval late, as a damper of ``m1 w^2 H/2``:
    ``d = m1 w^2 H / 4 (m1 + m2)``.
    """
    folder, worst = scenes(mass), 0.0
    with CoupledScenes(load_coupling(folder), folder / "out") as coupled:
        for k in range(200):
            coupled.master.step(0.01 * k, 0.01)
            t, square = 0.01 * (k + 1), 100.0 / (2.0 + mass)
            faded = math.exp(-mass * square * 0.01 * t / (4.0 * (2.0 + mass)))
            exact = 0.1 * faded * math.cos(math.sqrt(square) * t)
            worst = max(worst, abs(coupled.scenes["tells"]["cart.position.x"] - exact))
    assert worst < 7e-4
    assert coupled.stability.gain == pytest.approx(0.5 * mass / 2.0, rel=0.01)


@pytest.mark.parametrize(("mass", "stable"), [(0.2, True), (6.0, False)])
def test_without_repetition_the_masses_decide(scenes, mass, stable, tmp_path):
    coupling = load_coupling(scenes(mass), {"method": "sequential"})
    if stable:
        report = run_coupled(coupling, tmp_path / "out", Log(quiet=True))
        assert report.outcome is Outcome.COMPLETED
        assert report.stability.stable
        return
    with pytest.raises(InputError, match=r"unstable .* grow 3 times in each, .*; expected method 'iterated'"):
        run_coupled(coupling, tmp_path / "out", Log(quiet=True))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("told.speed", "told.sped", "'told' has no input 'sped'; expected one of its own: speed"),
        ("tells.cart.velocity.x", "tells.cart.velocity", "'tells' has no output 'cart.velocity'; expected"),
        (
            "tells.cart.velocity.x",
            "tells.cart.position.x",
            "is in m, and 'told.speed' in m/s; expected two ends",
        ),
        ("tells.cart.velocity.x", "told.part.velocity.x", "both ends are in 'told'; expected two scenes"),
        ("told.part.r", "tld.part.r", "there is no scene 'tld'; expected one of: told, tells"),
        (
            '"10 ms"',
            '"12 ms"',
            "0.012 s is 2.4 times the step of 'told', 0.005 s; expected a multiple of 0.005 s",
        ),
        ('"10 ms"', '"15 ms"', "2 s is 133.333 times the interval, 0.015 s; expected a multiple of 0.015 s"),
        ('"10 ms"', '"10 ms"\nduration = 3', "3 s, and 'told' ends at 2 s; expected at most 2 s"),
        ('"10 ms"', '"10 ms"\nmethod = "explicit"', "exchange.method"),
        ('tells = { case = "tells" }', "", "1 scenes; expected two or more"),
        ('case = "tells"', 'case = "tell"', "folder 'tell' does not exist"),
        ('case = "tells"', 'case = "tells", process = "served"', "no 'token_file' with process 'served'"),
        ('case = "tells"', 'case = "tells", process = "served", token_file = "none"', "none: No such file"),
        ('case = "tells"', 'case = "tells", set = ["simulate.step=0"]', "simulate.step"),
        ("factor = -1", 'factor = -1\noffset = "there"', "links.1.offset"),
    ],
)
def test_what_does_not_fit_is_refused(scenes, old, new, words):
    folder = scenes(1.0)
    file = folder / "coupling.toml"
    assert old in COUPLING
    file.write_text(COUPLING.replace(old, new, 1))
    with pytest.raises(InputError) as error:
        CoupledScenes(load_coupling(folder), folder / "out")
    assert words in str(error.value)


TURNING = f"""
title = "A body that turns faster and faster"
inputs = [{{ type = "force", name = "push", body = "cart", point = [0, 0, 0] }}]
{SIMULATE}
bodies.cart = {{ type = "rigid", mass = 2, inertia = [1, 1, 1], frame = {{ motion = "free" }} }}

[[forces]]
type = "point"
name = "turn"
body = "cart"
point = [0, 1, 0]
force = [900, 0, 0]
frame = "body"
"""


def test_a_scene_that_stops_ends_all_and_is_named(scenes):
    """1 rad in a step of 5 ms at 900 rad/s2 t: after 0.2 s, where the stability is still looked at."""
    folder = scenes(1.0)
    (folder / "tells" / "case.toml").write_text(TURNING)
    report = run_coupled(load_coupling(folder), folder / "out", Log(quiet=True))
    assert report.outcome is Outcome.STEP_TOO_LARGE
    assert report.message.startswith("tells: ")
    assert "'cart'" in report.message
    assert report.stability is None
    assert 0.1 < report.time < 0.4
    assert (folder / "out" / "coupling.json").is_file()


@pytest.mark.parametrize(("method", "doubts"), [("sequential", True), ("iterated", False)])
def test_a_long_interval_is_told(method, doubts, tmp_path):
    """A period of 0.47 s in intervals of 12.5 ms: what is held changes by ``w H`` = 17 % in one."""
    coupling = load_coupling(CASES / "coupled_masses", {"method": method})
    report = run_coupled(coupling, tmp_path, Log(quiet=True))
    assert ("in an exchange more than is told of it" in report.warning) == doubts
    assert (report.warning != "") == doubts


def test_a_scene_that_is_gone_while_it_is_looked_at_is_told(scenes, monkeypatch):
    """And the other one's process ends too."""
    coupling = scenes(1.0) / "coupling.toml"
    own = COUPLING.replace('case = "told"', 'case = "told", process = "own"')
    coupling.write_text(own.replace('case = "tells"', 'case = "tells", process = "own"'))
    opened = []

    def dies(self, interval):
        opened.extend(self.scenes.values())
        opened[1]._child.kill()
        return look(self, interval)

    look = CoupledScenes._stability
    monkeypatch.setattr(CoupledScenes, "_stability", dies)
    with pytest.raises(StopError, match="has closed the connection"):
        run_coupled(load_coupling(coupling), coupling.parent / "out", Log(quiet=True))
    assert [one._child.poll() is None for one in opened] == [False, False]


def test_a_speed_that_jumps_is_refused(scenes):
    folder = scenes(1.0)
    file = folder / "told" / "case.toml"
    file.write_text(file.read_text().replace(', interpolation = "linear"', ""))
    with pytest.raises(InputError, match=r"'told.speed' jumps at exchanges.*interpolation = \"linear\""):
        CoupledScenes(load_coupling(folder), folder / "out")


def test_a_scene_that_is_served_keeps_its_results_with_its_server(scenes, capsys):
    """Here are those of the other one, and its checks alone decide."""
    pytest.importorskip("msgpack")
    from heavylift.pipeline.exchange.server import Server, listening
    from heavylift.pipeline.exchange.service import Service

    folder = scenes(0.2)
    check = '[[check]]\nid = "rail"\nquantity = "channel.cart.position.y.end"\nmaximum = 0.1\nsource = "-"\n'
    for name in ("told", "tells"):
        file = folder / name / "case.toml"
        file.write_text(file.read_text() + check.replace("cart", "cart" if name == "tells" else "part"))
    listener, told = listening("127.0.0.1", 0), hl.Simulation(folder / "told")
    server = threading.Thread(target=Server(Service(told, "a-word"), listener).run)
    server.start()
    (folder / "token").write_text(f"127.0.0.1 {listener.getsockname()[1]} a-word\n")
    served = 'case = "told", process = "served", token_file = "token"'
    (folder / "coupling.toml").write_text(COUPLING.replace('case = "told"', served))
    try:
        assert couple(folder) == 0
    finally:
        server.join(20)
        listener.close()
    lines = capsys.readouterr().out
    assert "couple: told: its results are with its server" in lines
    assert "tells: completed" in lines
    assert told.time == pytest.approx(2.0)
    assert not (folder / "out" / "told").exists()
