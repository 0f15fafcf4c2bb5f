"""A run that takes what follows from its surfaces from the output folder has the bits of one that computes it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.contours.triangles import surface_pack
from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.solver.contact.triangles import outside

CASE = """title = "A tank lands on the floor"
[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[bodies.tank]
type = "rigid"
mass = "2 t"
inertia = [400, 500, 600]
frame = { motion = "free" }
initial = { position = [0, 0, 0.35], velocity = [0, 0.2, -1], angular_velocity = [0.1, 0, 0.05] }

[[surfaces]]
name = "plating"
body = "tank"
file = "tank.stl"
unit = "mm"

[[surfaces]]
name = "floor"
body = "ground"
shape = { type = "plane", size = [20, 10] }

[[collisions]]
name = "landing"
between = ["floor", "plating"]
law = "linear"
stiffness = "1 MN/m"
damping = "10 kN s/m"

[simulate]
step = "2 ms"
output_interval = "10 ms"
duration = "0.4 s"
"""


def records(folder: Path) -> dict[str, bytes]:
    results = load_results(folder)
    return {name: np.ascontiguousarray(results[name]).tobytes() for name in results}


def test_taken_from_the_folder_or_computed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder = tmp_path / "landing"
    folder.mkdir()
    (folder / "case.toml").write_text(CASE)
    shutil.copyfile(Path(__file__).parents[1] / "tank.stl", folder / "tank.stl")
    run_case(load_case(folder), out=tmp_path / "plain", stages=("simulate",))
    assert not (
        tmp_path / "plain" / "derived"
    ).exists()  # of a few triangles all is computed faster than read
    expected = records(tmp_path / "plain")
    assert np.ptp(load_results(tmp_path / "plain")["landing.normal_force"]) > 1e3

    made: list[str] = []
    for module, name in (
        (surface_pack, "find_seams"),
        (surface_pack, "_pack_one"),
        (outside, "_closed_parts"),
    ):
        monkeypatch.setattr(module, "WORTH_KEEPING", -1)
        monkeypatch.setattr(module, name, counted(getattr(module, name), made))
    out = folder / "out"

    def run(*force: str, **options: object) -> int:
        made.clear()
        run_case(load_case(folder), stages=("mesh", "simulate"), force=force, **options)  # type: ignore[arg-type]
        return len(made)

    first = run()
    assert first >= 3
    assert records(out) == expected
    assert run("simulate") == 0
    assert records(out) == expected
    for file in (out / "derived").iterdir():
        data = bytearray(file.read_bytes())
        data[len(data) // 2] ^= 1
        file.write_bytes(data)
    assert run("simulate") == first
    assert records(out) == expected
    assert run("simulate") == 0
    assert run("mesh", "simulate") == first
    assert records(out) == expected
    assert run(out=tmp_path / "again", reuse=(out,)) == 0
    assert records(tmp_path / "again") == expected
    folder = folder.rename(tmp_path / "moved")
    assert run("simulate") == 0
    assert records(folder / "out") == expected
    text = (folder / "tank.stl").read_text()
    assert "500" in text
    (folder / "tank.stl").write_text(text.replace("500", "501"))
    assert 0 < run() <= first  # the floor is as it was
    assert records(folder / "out") != expected
    shutil.rmtree(folder / "out" / "derived")
    (folder / "out" / "derived").symlink_to(tmp_path)
    with pytest.raises(InputError, match="is a link"):
        run("simulate")


def counted(make: object, made: list[str]) -> object:
    """The same function, by the same name, that says it was called."""

    def call(*inputs: object) -> object:
        made.append(make.__name__)  # type: ignore[attr-defined]
        return make(*inputs)  # type: ignore[operator]

    call.__module__, call.__name__, call.__qualname__ = make.__module__, make.__name__, make.__qualname__
    return call
