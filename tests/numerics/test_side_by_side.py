"""Parts in several processes: results, errors and their order are those of one process, and no process is left."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from functools import partial

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.numerics.processors import PROCESSES
from heavylift.numerics.side_by_side import SideBySide
from heavylift.pipeline import load_case, run_case


@pytest.fixture(autouse=True)
def two(monkeypatch):
    monkeypatch.setenv(PROCESSES, "2")


def number(value, seconds=0.0):
    time.sleep(seconds)
    return value, os.getpid()


def test_results_come_in_order_from_other_processes():
    both = multiprocessing.get_context("fork").Barrier(2)

    def meets(value):
        both.wait(60.0)  # the first two parts are made at the same time, however busy the machine is
        return number(value, 0.1 if value == 0 else 0.0)

    parts = [lambda i=i: meets(i) if i < 2 else number(i) for i in range(5)]
    with SideBySide(parts) as processes:
        found = list(processes.results())
    assert [value for value, _ in found] == list(range(5))
    makers = {maker for _, maker in found}
    assert len(makers) == 2
    assert os.getpid() not in makers
    for maker in makers:
        with pytest.raises(ProcessLookupError):
            os.kill(maker, 0)


def test_a_part_that_fails_fails_here_in_its_place():
    def wrong():
        raise InputError("7", source="file", key="a.b", expected="8")

    with SideBySide([lambda: number(0), wrong, lambda: number(2)]) as processes:
        results = processes.results()
        assert next(results)[0] == 0
        with pytest.raises(InputError) as error:
            next(results)
    assert str(error.value) == "file: a.b: 7; expected 8"


def test_what_a_process_that_was_killed_has_not_made_is_made_here():
    here = os.getpid()

    def die():
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return number(1)

    with SideBySide([lambda: number(0), die, die, lambda: number(3)]) as processes:
        found = list(processes.results())
    assert [value for value, _ in found] == [0, 1, 1, 3]
    assert found[1][1] == here


def test_whoever_stops_waiting_leaves_no_process():
    makers = []

    def stopped():
        with SideBySide([partial(number, i, 60.0 * i) for i in (0, 1, 1)]) as processes:
            processes.begin(2)
            makers.extend(processes._processes)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stopped()
    assert len(makers) == 2
    for maker in makers:
        with pytest.raises(ProcessLookupError):
            os.kill(maker, 0)


def test_a_copy_makes_no_copies():
    def inner():
        with SideBySide([lambda: number(0), lambda: number(1)]) as processes:
            return processes.count

    with SideBySide([inner, inner]) as processes:
        assert processes.count == 2
        assert list(processes.results()) == [1, 1]


def test_the_number_of_processes_is_checked(monkeypatch):
    monkeypatch.setenv(PROCESSES, "two")
    with pytest.raises(InputError, match="HEAVYLIFT_PROCESSES: 'two'; expected 1 or more"):
        SideBySide([number, number])


BODIES = "\n".join(
    f"""[bodies.{name}]
type = "flexible"
geometry = {{ type = "blocks", add = [{{ name = "bar", from = [0, 0, 0], to = [1, 0.1, 0.1] }}] }}
material = {{ density = 7850, young_modulus = "{modulus} GPa", poisson_ratio = 0.3 }}
mesh = {{ size = "10 cm", element = "tet10" }}
frame = {{ motion = "free" }}
modes = {{ count = 3 }}"""
    for name, modulus in (("soft", 1), ("steel", 210), ("hard", 400))
)


def test_bodies_are_the_same_and_told_in_the_same_order(tmp_path, monkeypatch, capsys):
    from heavylift.pipeline.log import Log

    (tmp_path / "case.toml").write_text(f'title = "Bars"\n{BODIES}\n')
    files, said = [], []
    for count in ("1", "2"):
        monkeypatch.setenv(PROCESSES, count)
        out = tmp_path / count
        run_case(load_case(tmp_path), out=out, stages=("mesh", "modes"), log=Log())
        files.append({p.relative_to(out): p.read_bytes() for p in out.rglob("*.h5")})
        said.append([line.rpartition(";")[0] for line in capsys.readouterr().out.splitlines()])
    assert files[0] == files[1]
    assert len(files[0]) == 6
    assert said[0] == said[1]


def test_surfaces_are_the_same_and_told_in_the_same_order(tmp_path, monkeypatch, capsys):
    """Two files and a shape; then one file has no triangles, which is told as by one process."""
    import trimesh

    from heavylift.pipeline.log import Log

    text = 'title = "Surfaces"\n'
    for name in ("ball", "egg", "box"):
        text += f'[bodies.{name}]\ntype = "rigid"\nmass = 10\ninertia = [1, 1, 1]\nframe = {{ motion = "free" }}\n'
        shape = (
            'shape = { type = "box", size = [1, 1, 1] }'
            if name == "box"
            else f'file = "{name}.stl"\nunit = "m"'
        )
        text += f'[[surfaces]]\nname = "skin_{name}"\nbody = "{name}"\n{shape}\n'
    (tmp_path / "case.toml").write_text(text)
    for name, fineness in (("ball", 3), ("egg", 2)):
        trimesh.creation.icosphere(fineness).export(tmp_path / f"{name}.stl")

    def run(count):
        monkeypatch.setenv(PROCESSES, count)
        out = tmp_path / count
        run_case(load_case(tmp_path), out=out, stages=("mesh",), log=Log(), force=("mesh",))
        return {p.relative_to(out): p.read_bytes() for p in out.rglob("*.npz")}

    files, said = [], []
    for count in ("1", "2"):
        files.append(run(count))
        said.append([line.rpartition(";")[0] for line in capsys.readouterr().out.splitlines()])
    assert files[0] == files[1]
    assert len(files[0]) == 3
    assert said[0] == said[1]
    (tmp_path / "egg.stl").write_text("solid egg\nendsolid egg\n")
    errors = []
    for count in ("1", "2"):
        with pytest.raises(InputError, match=r"egg\.stl") as error:
            run(count)
        errors.append(str(error.value))
    assert errors[0] == errors[1]
