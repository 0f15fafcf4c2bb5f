"""What needs more memory than there is, or no sensible time, is told before it is made."""

from __future__ import annotations

import time

import pytest

from heavylift.numerics import memory
from heavylift.numerics.memory import amount_of_bytes, available_memory, span_of_time
from heavylift.numerics.outcome import InputError, Outcome

DIVISIONS = "divisions = { x = [8], y = [1], z = [1] }"
TETRAHEDRA = (('element = "hex8"', 'element = "tet10"'), ('mass = "lumped"', ""))


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        (
            [(DIVISIONS, "divisions = { x = [1000000000], y = [1], z = [1] }")],
            "mesh.divisions.x",
            "1e+09 bricks",
        ),
        ([(DIVISIONS, 'size = "1 nm"')], "mesh.size", "bricks"),
        ([(DIVISIONS, "size = 1e-320")], "mesh.size", "bricks"),
        ([(DIVISIONS, 'size = "1 nm"'), *TETRAHEDRA], "mesh.size", "tetrahedra"),
        ([(DIVISIONS, "size = 1e-320"), *TETRAHEDRA], "mesh.size", "tetrahedra"),
        (
            [(DIVISIONS, 'size = "5 mm"\nrefine = [{ at = "root", size = "1e-9 nm" }]'), *TETRAHEDRA],
            "mesh.refine",
            "tetrahedra",
        ),
    ],
)
def test_elements_for_which_there_is_no_memory(heavylift, small_case, edit, changes, key, words):
    edit(small_case, *changes)
    begin = time.monotonic()
    result = heavylift("mesh", small_case)
    assert time.monotonic() - begin < 5.0
    assert result.code == Outcome.BAD_INPUT
    (line,) = result.error.splitlines()
    assert f"case.toml: bodies.beam.{key}: about" in line
    assert words in line
    assert "of memory and" in line
    assert "are available" in line


FRAME = """
title = "Wire"
[bodies.wire]
type = "{type}"
geometry = {geometry}
{section}
"""
BEAM = """
[bodies.wire.section]
youngs_modulus = "210 GPa"
density = "7800 kg/m^3"
area = "1 cm^2"
second_moment = "1 cm^4"
"""


@pytest.mark.parametrize(
    ("kind", "geometry"),
    [
        ("frame", '{ type = "line", start = [0, 0, 0], end = [1, 0, 0], elements = 1000000000 }'),
        ("shell", '{ type = "rectangle", size = [1, 1], elements = [100000, 100000] }'),
    ],
)
def test_frames_and_shells_for_which_there_is_no_memory(tmp_path, kind, geometry):
    import tomllib
    from types import SimpleNamespace

    from pydantic import TypeAdapter

    from heavylift.pipeline.assemble.meshes import Place, frame_mesh, shell_mesh
    from heavylift.pipeline.case.meshes import FrameGeometry, ShellGeometry

    section = tomllib.loads(f"geometry = {geometry}")["geometry"]
    spec = TypeAdapter(FrameGeometry if kind == "frame" else ShellGeometry).validate_python(section)
    case = SimpleNamespace(file=tmp_path / "case.toml", place=lambda key: key)
    make = frame_mesh if kind == "frame" else shell_mesh
    with pytest.raises(
        InputError, match=r"bodies\.wire\.geometry\.elements: about 1e\+(09|10) elements, which take"
    ):
        make(Place(case, "wire"), spec)


def test_what_fits_is_made_and_what_is_just_too_much_is_not(monkeypatch, heavylift, small_case, edit):
    """The limit is that of the memory of the machine: eight bricks need 64 kB."""
    assert available_memory() > 2**20
    monkeypatch.setattr(memory, "available_memory", lambda: 8 * 8e3)
    assert heavylift("mesh", small_case, "--quiet").code == 0
    monkeypatch.setattr(memory, "available_memory", lambda: 7.9 * 8e3)
    assert heavylift("mesh", small_case, "--quiet", "--force").code == Outcome.BAD_INPUT


def test_a_container_has_less_than_the_machine(monkeypatch, tmp_path):
    (tmp_path / "memory.max").write_text("1000000\n")
    (tmp_path / "memory.current").write_text("400000\n")
    monkeypatch.setattr(memory, "CONTAINER", tmp_path)
    assert available_memory() == 600000.0
    (tmp_path / "memory.max").write_text("max\n")
    assert available_memory() > 1e8


def test_the_estimate_of_tetrahedra_is_of_the_right_size():
    from heavylift.preprocess.finite_elements import gmsh_session
    from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
    from heavylift.preprocess.finite_elements.refinement import Refinement

    cube = [Box("cube", (0, 0, 0), (1, 1, 1))]
    count = len(mesh_blocks(cube, size=0.1).elements)
    assert pytest.approx(count, rel=0.3) == gmsh_session.TETRAHEDRA / 0.1**3
    notch = [Box("notch", (0.5, 0.5, -1), (2, 2, 2))]
    edge = [Refinement("re-entrant edges", 0.01, 0.5)]
    count = len(mesh_blocks(cube, notch, size=0.2, refine=edge).elements)
    assert pytest.approx(count, rel=0.5) == gmsh_session.ALONG_CURVE / 0.5**2 / 0.01


def test_amounts_in_words():
    assert [amount_of_bytes(v) for v in (0, 999, 8.2e9, 3e14, 1e40)] == [
        "0 B",
        "999 B",
        "8.2 GB",
        "300 TB",
        "1.0e+25 PB",
    ]
    assert [span_of_time(v) for v in (0.4, 90, 7200, 1e6, 1e30)] == [
        "0.4 s",
        "1.5 min",
        "2 h",
        "12 days",
        "3e+22 years",
    ]


def test_histories_that_no_disk_holds(heavylift, small_case):
    """A microsecond too few in an interval: told before the first step, and nothing of an older run is touched."""
    changes = ("--set", "simulate.output_interval=1 us", "--set", "simulate.duration=10000 days")
    begin = time.monotonic()
    result = heavylift("simulate", small_case, *changes, "--quiet")
    assert time.monotonic() - begin < 20.0
    assert result.code == Outcome.BAD_INPUT
    (line,) = result.error.splitlines()
    assert "simulate.output_interval: 864,000,000,000,001 records of" in line
    assert "are free" in line
    assert not (small_case / "out" / "simulate").exists()
