"""Object files: whole or compiled again, whatever happened to them; right results in any case."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

from heavylift.numerics import objects, sources
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Reference, described
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import Unit, build_unit, entry, load_unit
from heavylift.solver import compiling
from heavylift.solver.forces.gravity import UniformGravity
from heavylift.solver.forces.point import PointForces
from heavylift.solver.joints.row_joints import RowJoints

compiled_only = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")

PROGRAM = """
import json, sys, time
import numpy as np
from heavylift.numerics import objects, sources
from heavylift.solver.forces.gravity import UniformGravity
from heavylift.solver.interface import Forces, Workspace, add_forces
work = Workspace.empty(6, 0)
add_forces(Forces((UniformGravity(np.array([0.0, 0.0, -9.81])),)), 0.0, work)
print(json.dumps([list(work.sums.gravity), sum(unit.seconds > 0.0 for unit in objects.compiled_units().values())]))
"""


def run(cache: Path, **environment: str) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM],
        env=os.environ | {"HEAVYLIFT_CACHE_DIR": str(cache), **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def result(process: subprocess.Popen) -> tuple[int, str]:
    """Units that were compiled, and what was said; the field of gravity is right whatever happened."""
    out, spec = process.communicate(timeout=120)
    assert process.returncode == 0, spec
    field, count = json.loads(out)
    assert field == [0.0, 0.0, -9.81]
    return count, spec


@pytest.mark.slow
@compiled_only
def test_what_is_compiled_is_loaded_and_what_is_not_whole_is_compiled_again(tmp_path: Path) -> None:
    assert result(run(tmp_path)) == (1, "")
    assert result(run(tmp_path)) == (0, "")
    (file,) = (tmp_path / "objects").glob("*.o")
    whole = file.read_bytes()
    file.write_bytes(whole[:200] + b"?" + whole[201:])
    assert result(run(tmp_path)) == (1, "")
    assert len(file.read_bytes()) == len(whole)
    assert result(run(tmp_path)) == (0, "")


@compiled_only
def test_any_file_that_is_not_whole_is_compiled_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path))
    unit = weighted_sum.unit

    def seconds() -> float:
        """Of compiling, in a process that does not know the unit yet."""
        monkeypatch.setattr(objects, "_LOADED", {})
        return load_unit(unit).seconds

    assert seconds() > 0.0
    assert seconds() == 0.0
    (file,) = (tmp_path / "objects").glob("*.o")
    whole = file.read_bytes()
    for broken in (whole[:-7], whole[:20], b"", whole[:200] + b"?" + whole[201:], b"another file"):
        file.write_bytes(broken)
        assert seconds() > 0.0
        assert len(file.read_bytes()) == len(whole)
        assert seconds() == 0.0


@pytest.mark.slow
@compiled_only
def test_two_processes_compile_the_same_at_once(tmp_path: Path) -> None:
    for count, spec in [result(process) for process in [run(tmp_path) for _ in range(3)]]:
        assert count in {0, 1}
        assert spec == ""
    assert result(run(tmp_path)) == (0, "")
    assert len(list((tmp_path / "objects").iterdir())) == 1  # no temporary file is left


@pytest.mark.slow
@compiled_only
def test_a_folder_that_cannot_be_written_costs_one_line(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    for _ in range(2):
        count, spec = result(run(blocked))
        assert count == 1
        assert spec.count("\n") == 1
        assert f"compiled kernels cannot be kept in {blocked}" in spec


@pytest.mark.slow
@compiled_only
def test_code_for_another_processor_is_not_loaded(tmp_path: Path) -> None:
    other = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    assert result(run(tmp_path)) == (1, "")
    assert result(run(tmp_path, **other)) == (1, "")
    assert result(run(tmp_path, **other)) == (0, "")
    assert result(run(tmp_path)) == (0, "")
    assert len(list((tmp_path / "objects").iterdir())) == 2


@entry
def weighted_sum(values: Floats1, weights: Floats2, row: int, factor: float, negative: bool) -> float:
    total = 0.0
    for i in range(values.shape[0]):
        total += factor * values[i] * weights[row, i]
    return -total if negative else total


def test_python_calls_an_entry_with_numbers_and_arrays() -> None:
    weights = np.arange(6.0).reshape(2, 3)
    assert weighted_sum(np.ones(3), weights, 1, 0.5, False) == 6.0
    assert weighted_sum(np.ones(3), weights, 1, 0.5, True) == -6.0


@compiled_only
def test_an_entry_refuses_what_it_would_misread() -> None:
    with pytest.raises(TypeError, match="array of shape"):
        weighted_sum(np.ones(6)[::2], np.ones((2, 3)), 0, 1.0, False)
    with pytest.raises(TypeError, match="array of shape"):
        weighted_sum(np.ones(3), np.ones(3), 0, 1.0, False)
    with pytest.raises(TypeError, match="float32 array"):
        weighted_sum(np.ones(3, dtype=np.float32), np.ones((2, 3)), 0, 1.0, False)
    with pytest.raises(TypeError, match="4 arguments, expected 5"):
        weighted_sum(np.ones(3), np.ones((2, 3)), 0, 1.0)


BOUNDS = """
import numpy as np
from heavylift.numerics.arrays import Floats1
from heavylift.numerics.objects import entry

@entry
def overrun(values: Floats1, place: int) -> float:
    values[place] = 1.0
    return 2.0
"""


@pytest.mark.slow
@compiled_only
def test_an_index_out_of_bounds_is_told_where_bounds_are_checked(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(BOUNDS + "print(overrun(np.zeros(2), 1))\noverrun(np.zeros(2), 5)\n")
    done = subprocess.run(
        [sys.executable, "program.py"],
        cwd=tmp_path,
        env=os.environ | {"HEAVYLIFT_CACHE_DIR": str(tmp_path / "cache"), "NUMBA_BOUNDSCHECK": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "2.0\n"
    assert "RuntimeError: __main__.overrun ended with an error" in done.stderr


@kernel
def made(count):
    return np.zeros(count)


@entry
def sum_of_made(count: int) -> float:
    total = 0.0
    for value in made(count):
        total += value
    return total


@compiled_only
def test_a_kernel_that_allocates_is_refused_before_it_is_loaded() -> None:
    """Loading it would end the process."""
    with pytest.raises(
        objects.CompileError, match=r"sum_of_made: a kernel makes, reshapes or returns arrays: NRT_"
    ):
        sum_of_made(3)


@compiled_only
def test_what_was_edited_while_a_process_runs_is_not_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path))
    build_unit(weighted_sum.unit)
    assert len(list((tmp_path / "objects").glob("*.o"))) == 1
    for file in (tmp_path / "objects").iterdir():
        file.unlink()
    monkeypatch.setattr(
        sources, "STARTED", Path(__file__).stat().st_mtime - 1.0
    )  # as if this file were younger
    build_unit(weighted_sum.unit)
    assert not list((tmp_path / "objects").iterdir())


@pytest.mark.slow
@compiled_only
def test_processes_compile_and_a_dead_one_leaves_its_work_to_us(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path))
    kinds: tuple[Any, ...] = (UniformGravity, RowJoints, PointForces)
    units = [compiling.unit_of(kind.__module__, kind.__name__, "step") for kind in kinds]
    files = {f"{unit.name}-" for unit in units}
    for program in (sys.executable, "/bin/false"):
        monkeypatch.setattr(sys, "executable", program)
        done: dict[str, float] = {}
        compiling.compile_units(units, done.__setitem__)
        in_memory = set(objects.compiled_units())
        assert set(done) | in_memory >= {kind.__name__ for kind in kinds}
        for file in (tmp_path / "objects").iterdir():
            assert any(file.name.startswith(name) for name in files)
            file.unlink()


@compiled_only
def test_units_of_old_sources_go_after_a_while(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path))
    unit: Unit = weighted_sum.unit
    folder = tmp_path / "objects"
    folder.mkdir()
    for age in range(objects.KEPT_OBJECTS + 2):
        old = folder / f"{unit.name}-{age}.o"
        old.write_bytes(b"")
        os.utime(old, (1e9 - age, 1e9 - age))
    (folder / "another.unit-1.o").write_bytes(b"")
    assert build_unit(unit) > 0.0
    kept = {path.name for path in folder.iterdir()}
    assert {f"{unit.name}-{age}.o" for age in range(objects.KEPT_OBJECTS)} < kept
    assert "another.unit-1.o" in kept
    assert len(kept) == objects.KEPT_OBJECTS + 2
    assert load_unit(unit).addresses.keys() == unit.entries.keys()


class Pair(Arrays):
    """Two numbers."""

    first: Floats1
    second: float


class Swapped(Arrays):
    """The same in another order."""

    second: float
    first: Floats1


def test_the_name_of_an_object_holds_the_layout_of_what_it_is_handed() -> None:
    names = {described(Reference(group)).replace(group.__qualname__, "") for group in (Pair, Swapped)}
    assert len(names) == 2
    (types_of,) = (types_of for _, types_of, _ in weighted_sum.unit.entries.values())
    other = replace(
        weighted_sum.unit, entries={"f": (weighted_sum.kernel, (*types_of, Reference(Pair)), None)}
    )
    assert objects._place(other) != objects._place(weighted_sum.unit)


@compiled_only
def test_settings_that_nobody_changed_are_the_same_with_and_without_the_compiler() -> None:
    """Else an object that was made with it would not be found without it."""
    from heavylift.numerics.jit import with_compiler

    usual = all(not name.startswith("NUMBA_") for name in os.environ)
    assert (with_compiler().settings() == objects.USUAL) or not usual


@compiled_only
def test_what_an_object_needs_of_the_compiler_is_given_before_it_is_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(objects, "_LOADED", {})
    names, _, code = objects._compile(weighted_sum.unit).partition(b"\0")
    asked: list[bool] = []
    helpers = objects.with_compiler()
    monkeypatch.setattr(helpers, "give_helpers", lambda: asked.append(True))
    for more, count in ((b"", 0), (b"\nnumba_is_unknown_here", 1)):
        asked.clear()
        assert objects._load(names + more + b"\0" + code, weighted_sum.unit)
        assert len(asked) == count
