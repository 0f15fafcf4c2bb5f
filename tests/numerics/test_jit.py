"""The kernel cache must never load code that an edit made stale."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import numba
import numpy as np
import pytest

from heavylift.numerics import jit, jit_code, sources
from heavylift.numerics.jit import kernel
from heavylift.numerics.jit_code import KEPT_CACHES, cache_folder
from heavylift.numerics.sources import closure, closure_digest

if TYPE_CHECKING:
    from pathlib import Path

compiled_only = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")

CALLEE = """
from {decorator_module} import {decorator}

@{decorator_call}
def gravity(mass):
    return mass * {value}
"""

CALLER = """
from {decorator_module} import {decorator}
from heavylift.{folder}.callee import gravity

@{decorator_call}
def weight(mass):
    return gravity(mass) + 0.0
"""

PROGRAM = """
import json, os, sys
os.environ["NUMBA_CACHE_DIR"] = sys.argv[1]  # of the control experiment
from heavylift.solver.caller import weight
from heavylift.plain.caller import weight as plain_weight
import heavylift.numerics.jit_code as jit
result = [[f(2.0), sum(f.stats.cache_hits.values())] for f in (weight, plain_weight)]
print(json.dumps([*result, str(jit.cache_folder("heavylift.solver.caller"))]))
"""


class Package:
    """A package of two kernels with our decorator and, for control, two with Numba's own cache."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.caches = folder / "caches"
        numerics = folder / "heavylift" / "numerics"
        numerics.mkdir(parents=True)
        (folder / "heavylift" / "__init__.py").write_text(
            ""
        )  # else an installed package would be found first
        for module in (jit, jit_code, sources):
            shutil.copy(str(module.__file__), numerics)
        (folder / "program.py").write_text(PROGRAM)
        self.variants = {
            "solver": {
                "folder": "solver",
                "decorator_module": "heavylift.numerics.jit",
                "decorator": "kernel",
                "decorator_call": "kernel",
            },
            "plain": {
                "folder": "plain",
                "decorator_module": "numba",
                "decorator": "njit",
                "decorator_call": "njit(cache=True)",
            },
        }
        for name, variant in self.variants.items():
            (folder / "heavylift" / name).mkdir()
            (folder / "heavylift" / name / "caller.py").write_text(CALLER.format(**variant))
        self.edit(9.81)

    def edit(self, value: float) -> None:
        """Change the callees only."""
        for name, variant in self.variants.items():
            text = CALLEE.format(value=value, **variant)
            (self.folder / "heavylift" / name / "callee.py").write_text(text)

    def run(self, caches: Path | None = None) -> list:
        """Results and cache hits of both callers in a new process, and its cache folder."""
        environment = os.environ | {
            "PYTHONPATH": str(self.folder),
            "HEAVYLIFT_CACHE_DIR": str(caches or self.caches),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        done = subprocess.run(
            [sys.executable, "program.py", str(self.folder / "plain_cache")],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        return json.loads(done.stdout)


@pytest.fixture
def package(tmp_path: Path) -> Package:
    return Package(tmp_path)


@compiled_only
def test_an_edited_callee_changes_its_caller_in_another_file(package: Package) -> None:
    first, plain, folder = package.run()
    assert first == [19.62, 0]
    assert plain == [19.62, 0]
    assert folder.startswith(str(package.caches))

    again, plain, _ = package.run()  # both load what they compiled
    assert again == [19.62, 1]
    assert plain == [19.62, 1]

    package.edit(1.62)
    edited, plain, other_folder = package.run()
    assert edited == [3.24, 0]
    assert plain == [19.62, 1], "control: Numba's own cache is expected to be stale here"
    assert other_folder != folder


@compiled_only
def test_a_cache_that_cannot_be_written_stops_nothing_and_leaves_nothing_behind(package: Package) -> None:
    blocked = package.folder / "file"
    blocked.write_text("")
    assert package.run(blocked / "below")[0] == [19.62, 0]
    package.edit(1.62)
    assert package.run(blocked / "below")[0] == [3.24, 0]
    # Numba's second choice would be beside the sources, where the caller of an edited callee is stale
    assert not list((package.folder / "heavylift" / "solver").rglob("*.nbi"))


@pytest.fixture
def modules(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of its own in place of ours: what kernels import, and how."""
    folder = tmp_path / "solver"
    (folder / "bodies").mkdir(parents=True)
    (folder / "bodies" / "rigid.py").write_text("x = 1\n")
    (folder / "rope.py").write_text(
        "from typing import TYPE_CHECKING\n"
        "from heavylift.solver.bodies import (\n    rigid,  # a module\n)\n"
        "if TYPE_CHECKING:\n    from heavylift.solver.other import Z\n"
        "def f():\n    import heavylift.solver.other\n"
    )
    (folder / "other.py").write_text("import heavylift.solver.rope\n")
    monkeypatch.setattr(sources, "PACKAGE", tmp_path)
    for one in (sources._source, closure, closure_digest):
        one.cache_clear()
    yield folder
    monkeypatch.undo()
    for one in (sources._source, closure, closure_digest):
        one.cache_clear()


def digest_now(module: str) -> str:
    for one in (sources._source, closure, closure_digest):
        one.cache_clear()
    return closure_digest((module,))


def test_a_closure_holds_what_is_imported_with_the_module(modules: Path) -> None:
    rope = ("heavylift.solver.bodies", "heavylift.solver.bodies.rigid", "heavylift.solver.rope")
    (modules / "bodies" / "__init__.py").write_text("")
    assert closure(("heavylift.solver.rope",)) == rope
    assert closure(("heavylift.solver.other",)) == tuple(sorted([*rope, "heavylift.solver.other"]))


def test_digest_follows_the_sources_of_the_closure_and_no_others(modules: Path) -> None:
    (modules / "bodies" / "__init__.py").write_text("")
    first = digest_now("heavylift.solver.rope")
    (modules / "other.py").write_text("import heavylift.solver.rope\n# edited\n")
    assert digest_now("heavylift.solver.rope") == first
    (modules / "bodies" / "rigid.py").write_text("x = 2\n")
    assert digest_now("heavylift.solver.rope") != first


def test_outdated_caches_go_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HEAVYLIFT_CACHE_DIR", str(tmp_path))
    module, prefix = "heavylift.numerics.small", "kernels-numerics.small-"
    (tmp_path / "my results").mkdir()
    (tmp_path / f"{prefix}file").write_text("not a folder")
    (tmp_path / "kernels-numerics.rotation-1").mkdir()
    for age in range(KEPT_CACHES + 3):
        old = tmp_path / f"{prefix}{age}"
        old.mkdir()
        os.utime(old, (1e9 - age, 1e9 - age))
    current = cache_folder.__wrapped__(module)
    kept = {path.name for path in tmp_path.iterdir()}
    others = {"my results", f"{prefix}file", "kernels-numerics.rotation-1"}
    assert kept == {current.name, *others, *(f"{prefix}{i}" for i in range(KEPT_CACHES))}
    assert cache_folder.__wrapped__(module) == current


@kernel
def has_nan(x: np.ndarray) -> bool:
    found = False
    for value in x:
        found = found or np.isnan(value)
    return found


@kernel(reassociate=True)
def total(x: np.ndarray) -> float:
    result = 0.0
    for value in x:
        result += value
    return result


@kernel
def quotient(a: float, b: float) -> float:
    return a / b


def test_nan_and_infinity_stay_visible() -> None:
    x = np.ones(100)
    assert not has_nan(x)
    x[57] = np.nan
    assert has_nan(x)
    assert np.isnan(total(x))
    x[57] = np.inf
    assert total(x) == np.inf


@compiled_only
def test_division_by_zero_follows_ieee_and_never_raises() -> None:
    assert quotient(1.0, 0.0) == np.inf
    assert np.isnan(quotient(0.0, 0.0))


def test_decorated_functions_keep_name_and_docstring() -> None:
    @kernel(internal=True, inline=True)
    def area(a: float) -> float:
        """Square of an edge."""
        return a * a

    assert (area.__name__, area.__doc__) == ("area", "Square of an edge.")


def test_decorating_leaves_numba_configuration_alone() -> None:
    before = numba.config.CACHE_DIR
    kernel(lambda x: x)
    assert before == numba.config.CACHE_DIR


def test_only_modules_of_the_compiler_import_it_and_each_counts_as_a_source() -> None:
    rooms = [
        sources.PACKAGE / room
        for room in ("numerics", "preprocess", "modal", "contours", "solver", "pipeline")
    ]
    files = [file for room in rooms for file in sorted(room.rglob("*.py"))]
    text = {file: file.read_text(encoding="utf-8") for file in files}
    importers = {
        file.stem for file in files if re.search(r"^(import|from) numba\b", text[file], re.MULTILINE)
    }
    assert importers == {"arrays_code", "jit_code", "kinds_code", "objects_code", "records_code"}
    named = {
        name: file
        for file in files
        for name in re.findall(r'^when_compiling\("heavylift\.([\w.]+)"\)', text[file], re.MULTILINE)
    }
    assert {name.rpartition(".")[2] for name in named} == importers
    rope = closure(("heavylift.solver.force_elements.wire_rope",))
    assert {f"heavylift.{name}" for name in named} <= set(rope)


@compiled_only
def test_a_kernel_is_compiled_when_it_is_called_and_the_compiler_is_imported_then(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from heavylift.numerics.rotation import quaternion_product as product\n"
        "assert 'numba' not in sys.modules\n"
        "assert product((0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0)) == (0.0, 0.0, 0.0, 1.0)\n"
        "print('numba' in sys.modules)\n"
        "from heavylift.numerics.records import Record, records\n"  # the compiler learns of them later
        "from heavylift.numerics.jit import kernel\n"
        "class Level(Record):\n"
        "    height: float\n"
        "first = kernel(lambda levels: levels[1].height)\n"
        "product((0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))\n"
        "levels = records(Level, 2)\n"
        "levels['height'] = 3.0, 4.0\n"
        "print(first(levels))\n"
    )
    (tmp_path / "program.py").write_text(program)
    command = [sys.executable, str(tmp_path / "program.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout == "True\n4.0\n"


def test_what_an_intrinsic_imports_where_it_writes_is_among_the_sources_of_its_module() -> None:
    """Object files are named by these: an edit of a module that they miss would leave the old code in use."""
    found = 0
    for file in sorted(sources.PACKAGE.rglob("*.py")):
        text = file.read_text()
        inner = re.findall(r"^ +from (heavylift\.[\w.]+) import", text, re.MULTILINE)
        if "\n@intrinsic\n" in text and inner:
            module = ".".join(("heavylift", *file.relative_to(sources.PACKAGE).with_suffix("").parts))
            assert set(inner) <= set(sources.closure((module,))), module
            found += 1
    assert found
