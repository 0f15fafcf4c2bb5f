"""What one waits for: the time to the first step, the first compilation of everything, and that after an edit.

    python benchmarks/startup.py                # all three parts, some minutes
    python benchmarks/startup.py scenes         # four scenes whose kinds are compiled, put together as never before
    python benchmarks/startup.py units          # every unit compiled by itself into an empty folder, two at a time
    python benchmarks/startup.py edit           # a comment in one file of one joint: what is compiled anew

*Scenes* and *edit* use kernels that *units* has compiled; without it they first compile what is missing in the folder
of `HEAVYLIFT_CACHE_DIR` or ``--cache``. A scene is one command ``heavylift simulate`` with one step, from the start of
the process to its end, so writing the results is part of it. The first run is the one that counts: it also compiles the
kernels of the preparation that belong to no unit, if this scene is the first that needs them; the second run shows what
is left then. At last all scenes run in turn with ``python -c 'import numba'``, some rounds, and the CPU times of whole
processes stand beside each other: medians, and ratios. Modules have their bytecode, as those of an installed program.
A mark (!) stands where a limit is exceeded.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from installed import environment

if TYPE_CHECKING:
    from heavylift.numerics.objects import Unit

CASES = Path(__file__).resolve().parent.parent / "cases"

SCENE_LIMIT = 1.0
"""Wall time [s] of a process that makes one step."""
FIRST_RATIO, RATIO = 2.0, 3.0
"""CPU time of such a process, of the first scene and of all, in that of a process that imports Numba."""
ROUNDS = 7
UNIT_LIMIT, ALL_LIMIT = 12.0, 150.0
"""CPU time of the first compilation of a unit, and wall time of that of all on two cores [s]."""
PROCESSES = 2
LARGEST = 12
"""Units that are listed."""
PARTS = ["units", "scenes", "edit"]
EDITED = "solver/force_elements/wire_rope.py"

HINGE = """
[bodies.arm]
type = "rigid"
mass = "10 t"
inertia = ["1e4 kg m^2", "1e4 kg m^2", "1e4 kg m^2"]
frame = { motion = "free" }
initial = { position = ["20 m", 0, 0] }

[[joints]]
name = "pin"
type = "hinge"
between = ["ground", "arm"]
at = ["18 m", 0, 0]
axis = [0, 1, 0]
"""

BARGE = """
title = "A barge on two catenaries with a box on a rope"

[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]

[sea]
density = "1025 kg/m^3"

[bodies.barge]
type = "rigid"
mass = "16190 t"
inertia = ["2570e6 kg m^2", "9619e6 kg m^2", "9619e6 kg m^2"]
centre_of_mass = [0, 0, "1.5 m"]
frame = { motion = "free" }

[[surfaces]]
name = "plating"
body = "barge"
shape = { type = "box", size = ["97.5 m", "36 m", "6 m"] }
at = [0, 0, "-1.5 m"]

[hulls.barge]
surface = "plating"

[[lines]]
name = "bow"
between = ["ground", "barge"]
points = [[700, 0, -100], [48.75, 0, 1.5]]
seabed = "-100 m"
sections = [{ length = "680 m", weight = "1200 N/m", axial_stiffness = "600 MN" }]

[[lines]]
name = "stern"
between = ["ground", "barge"]
points = [[-700, 0, -100], [-48.75, 0, 1.5]]
seabed = "-100 m"
sections = [{ length = "680 m", weight = "1200 N/m", axial_stiffness = "600 MN" }]

[bodies.box]
type = "rigid"
mass = "20 t"
inertia = ["3e4 kg m^2", "3e4 kg m^2", "3e4 kg m^2"]
frame = { motion = "free" }
initial = { position = ["60 m", 0, "10 m"] }

[[ropes]]
name = "hook"
axial_stiffness = "50 MN"
path = [{ body = "barge", point = ["60 m", 0, "30 m"] }, { body = "box", point = [0, 0, "1 m"] }]
"""

CONTACT = """
[[surfaces]]
name = "skin"
body = "plate"

[[surfaces]]
name = "floor"
body = "ground"
shape = { type = "plane", size = ["10 m", "10 m"] }
at = [0, 0, "-1 m"]

[[collisions]]
name = "landing"
between = ["floor", "skin"]
law = "linear"
stiffness = "1 MN/m"
"""

ONE_STEP = """
[simulate]
step = "10 ms"
output_interval = "10 ms"
duration = "10 ms"
"""

DROPPED = re.compile(r"\[+(simulate|report|converge|reference|check)\b")


@dataclass(frozen=True)
class Scene:
    """Bodies of a case that is there, none if empty, and what is added to them."""

    name: str
    case: str
    text: str


SCENES = (
    Scene("hoist and a hinge", "hoist", HINGE),
    Scene("boxes on inclines", "incline", ""),
    Scene("barge, catenaries, box on a rope", "", BARGE),
    Scene("shell on ropes, contact", "thin_plate_lift", CONTACT),
)


@dataclass(frozen=True)
class Cost:
    """Of a process: wall and CPU time [s], and what it printed."""

    wall: float
    cpu: float
    printed: str


def run(command: list[str], cache: Path, package: Path | None = None) -> Cost:
    """Run a process to its end with a folder of compiled kernels, and perhaps with other sources.

    Raises
    ------
    RuntimeError
        If it fails, with what it said.
    """
    variables = {"HEAVYLIFT_CACHE_DIR": str(cache)} | (
        {} if package is None else {"PYTHONPATH": str(package)}
    )
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    done = subprocess.run(command, env=environment(**variables), capture_output=True, text=True, check=False)
    wall = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stdout}{done.stderr}")
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Cost(wall, cpu, done.stdout)


def simulate(folder: Path, cache: Path, package: Path | None = None) -> Cost:
    """One step of a case, as its user would run it."""
    command = [sys.executable, "-P", "-c", "from heavylift.pipeline.commands.start import main; main()"]
    return run([*command, "simulate", str(folder), "--force", "--json"], cache, package)


def write_case(scene: Scene, root: Path) -> Path:
    """The case folder of a scene that makes one step."""
    folder = root / re.sub(r"\W+", "_", scene.name)
    folder.mkdir()
    text = scene.text
    if scene.case:
        whole = (CASES / scene.case / "case.toml").read_text(encoding="utf-8")
        sections = re.split(r"^(?=\[)", whole, flags=re.MULTILINE)
        text = "".join(section for section in sections if not DROPPED.match(section)) + text
    (folder / "case.toml").write_text(text + ONE_STEP, encoding="utf-8")
    return folder


def mark(value: float, limit: float) -> str:
    """Said of what is above its limit."""
    return "!" if value > limit else " "


# ---- units ----


def missing() -> list[Unit]:
    """Units without an object file."""
    from heavylift.solver.compiling import all_units, missing_units

    return missing_units([unit for units in all_units().values() for unit in units])


def compile_missing() -> tuple[dict[str, float], float]:
    """Compile every unit that has no object file: CPU times by name, and the wall time [s]."""
    from heavylift.solver.compiling import compile_units

    begin, costs = time.perf_counter(), dict[str, float]()
    compile_units(missing(), costs.__setitem__, PROCESSES)
    return costs, time.perf_counter() - begin


def print_units(seconds: dict[str, float], wall: float) -> None:
    """The largest units, and all of them."""
    print(f"first compilation of {len(seconds)} units into an empty folder     CPU s   limit")
    for name, cost in sorted(seconds.items(), key=lambda item: -item[1])[:LARGEST]:
        print(f"  {name:50s} {cost:8.2f}{mark(cost, UNIT_LIMIT)} {UNIT_LIMIT:6.0f}")
    print(f"  {'sum':50s} {sum(seconds.values()):8.2f}")
    print(f"  {f'wall time, {PROCESSES} processes':50s} {wall:8.2f}{mark(wall, ALL_LIMIT)} {ALL_LIMIT:6.0f}")


# ---- scenes ----


def measure_scenes(cache: Path, root: Path) -> None:
    """One step of each scene, twice."""
    print("one step, from the start of the process      wall s  limit   CPU s  compile or load s   start s")
    folders = {scene.name: write_case(scene, root) for scene in SCENES}
    for scene in SCENES:
        folder = folders[scene.name]
        for words in ("", "again"):
            before = compiled_files(cache)
            cost = simulate(folder, cache)
            told = json.loads(cost.printed)
            print(
                f"  {words or scene.name:40s} {cost.wall:8.2f}{mark(cost.wall, SCENE_LIMIT)} {SCENE_LIMIT:5.0f}"
                f" {cost.cpu:8.2f} {told['compile_s']:18.2f} {told['start_s']:9.2f}"
                f"   {what_is_new(before, compiled_files(cache))}",
                flush=True,
            )

    beside_numba(cache, folders)


def beside_numba(cache: Path, folders: dict[str, Path]) -> None:
    """CPU times of one step of each scene and of an import of Numba, in turn."""
    numba = [sys.executable, "-P", "-c", "import numba"]
    run(numba, cache)
    rounds = [
        (run(numba, cache).cpu, *(simulate(folder, cache).cpu for folder in folders.values()))
        for _ in range(ROUNDS)
    ]
    basis, *costs = (statistics.median(each) for each in zip(*rounds, strict=True))
    print(f"CPU time of whole processes in turn, medians of {ROUNDS}     CPU s   ratio  limit")
    print(f"  {'import numba':50s} {basis:8.3f} {1.0:7.2f}")
    for number, (name, cost) in enumerate(zip(folders, costs, strict=True)):
        limit = FIRST_RATIO if number == 0 else RATIO
        print(f"  {name:50s} {cost:8.3f} {cost / basis:7.2f}{mark(cost / basis, limit)} {limit:5.0f}")


def compiled_files(cache: Path) -> set[Path]:
    """Object files of units, and what Numba keeps of the kernels of the preparation."""
    return {*cache.glob("objects/*.o"), *cache.glob("kernels-*/**/*.nbc")}


def what_is_new(before: set[Path], after: set[Path]) -> str:
    """Units, by name, and number of other kernels that were compiled."""
    units = sorted(path.stem.rpartition("-")[0] for path in after - before if path.suffix == ".o")
    others = sum(path.suffix == ".nbc" for path in after - before)
    words = [f"units compiled: {', '.join(units)}"] if units else []
    words += [f"other kernels compiled: {others}"] if others else []
    return "; ".join(words)


# ---- edits ----


def measure_edit(cache: Path, root: Path) -> None:
    """A line more in one file of a copy of the sources: what a scene compiles, and what all units would."""
    import heavylift

    copy, stale = root / "copy", []
    leave = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(heavylift.__path__[0]), copy / "heavylift", ignore=leave)
    folder = write_case(replace(SCENES[0], name="edit"), root)
    print("a comment at the end of a file               wall s   CPU s")
    for words in ("copied sources", "the same again", f"{EDITED} edited", "the same again"):
        if words.endswith("edited"):
            with (copy / "heavylift" / EDITED).open("a", encoding="utf-8") as file:
                file.write("# edited\n")
            stale = json.loads(run([sys.executable, __file__, "--missing"], cache, copy).printed)
        files = compiled_files(cache)
        cost = simulate(folder, cache, copy)
        new = what_is_new(files, compiled_files(cache))
        print(f"  {words:40s} {cost.wall:8.2f} {cost.cpu:7.2f}    {new}", flush=True)
    print(
        f"  units without an object file after the edit, limit 1: {len(stale)}{mark(len(stale), 1)} {stale}"
    )


def main() -> None:
    """Parts that are asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", nargs="*", help=f"of {', '.join(PARTS)}; all if none is named")
    parser.add_argument("--missing", action="store_true", help=argparse.SUPPRESS)  # of other sources
    parser.add_argument("--cache", type=Path, help="folder of compiled kernels for scenes and edit")
    options = parser.parse_args()
    if not set(options.part) <= set(PARTS):
        parser.error(f"{' '.join(options.part)}: expected {', '.join(PARTS)}")
    if options.missing:
        print(json.dumps([unit.name for unit in missing()]))
        return
    from heavylift.numerics.sources import cache_root

    parts = options.part or PARTS
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        if "units" in parts:
            options.cache = root / "cache"
        if options.cache:
            os.environ["HEAVYLIFT_CACHE_DIR"] = str(options.cache)  # before heavylift.solver is imported
        cache = cache_root()
        costs, wall = compile_missing()
        if "units" in parts:
            print_units(costs, wall)
        if "scenes" in parts:
            measure_scenes(cache, root)
        if "edit" in parts:
            measure_edit(cache, root)


if __name__ == "__main__":
    main()
