"""Kill runs of five kinds of cases at random instants, start them again, and compare what they leave bit for bit.

A kill is SIGKILL, either after a random time of what the whole run takes, or before a random one of the operations by
which it opens, renames or removes files: those are rare, and their order is what a restart relies on. Runs write their
checkpoints as always, or after every thirtieth part of their steps. One to five kills hit the same folder, in runs of
all stages or of those up to the simulation; then the run is left alone. What is compared is every number in every file
of meshes, modes, surfaces, databases and time histories; beyond that no temporary file and no segment may be left, and
a further run finds everything unchanged.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from heavylift.pipeline.results.histories import numbers_on_disk
from heavylift.pipeline.results.storage import OutputFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

PIPELINE = Path(__file__).resolve().parents[1] / "pipeline"

CASES: dict[str, tuple[str, ...]] = {
    "small_beam": (),
    "linkage": ("simulate.duration=40 s",),
    "collisions": ("simulate.duration=1 s",),
    "frame_and_shell": (),
    "sea": ("simulate.step=2 ms", "simulate.output_interval=100 ms"),
}
"""A modal body; joints and ropes; triangles that touch; frames and a shell; a hull with a database, in waves."""

FRAME_AND_SHELL = """
title = "Cantilever and plate"
[gravity]
acceleration = [0, 0, "-9.81 m/s^2"]
[bodies.beam]
type = "frame"
geometry = { type = "line", start = [0, 0, 0], end = ["10 m", 0, 0], elements = 4 }
section = { density = 1000, young_modulus = "1 GPa", diameter = "1 m" }
supports = [{ at = "start", fix = "clamped" }]
[bodies.plate]
type = "shell"
geometry = { type = "rectangle", size = ["4 m", "2 m"], elements = [4, 2] }
section = { thickness = "20 mm", density = "7850 kg/m^3", young_modulus = "210 GPa", poisson_ratio = 0.3 }
supports = [{ edge = ["x_min"], fix = "clamped" }]
initial = { position = [0, 0, "3 m"] }
[simulate]
step = "1 ms"
output_interval = "10 ms"
duration = "6 s"
"""

NOT_COMPARED = {"cpu_s", "start_s", "overrides"}
"""Attributes of results that tell of the run and not of the case."""
MOST_KILLS = 5
"""Of one folder."""
WHOLE_RUNS = 0.1
"""Part of the folders whose runs end with the report, which takes longer than all the rest."""


class Reference(NamedTuple):
    """An undisturbed run of a case."""

    case: Path
    overrides: tuple[str, ...]
    content: dict[str, Any]
    seconds: dict[str, float]
    operations: dict[str, int]
    steps: int
    codes: dict[str, int]
    """With which each command ends: a report tells of checks that fail, a simulation does not."""


def run(count: int, seed: int) -> dict[str, int]:
    """Kill `count` runs; see `heavylift`'s soak program."""
    generator = random.Random(seed)  # noqa: S311
    counts = dict.fromkeys(
        ("kills", "by time", "by file operation", "ended before", "folders", "failures"), 0
    )
    counts |= dict.fromkeys(
        (f"killed in {stage}" for stage in ("start", "mesh", "modes", "simulate", "report")), 0
    )
    for module in ("case.case_file", "commands.cli", "report.report", "stages.simulate"):
        importlib.import_module(f"heavylift.pipeline.{module}")  # once, and not in each process
    importlib.import_module("heavylift.solver.simulation")
    counts["last runs that found checkpoints"] = 0
    with tempfile.TemporaryDirectory() as place:
        references = [_reference(Path(place), name) for name in CASES]
        while counts["kills"] < count:
            reference = references[counts["folders"] % len(references)]
            _torment(reference, generator, counts, count)
            sys.stdout.write(f"{counts['kills']} kills, {counts['failures']} failures\n")
            sys.stdout.flush()
    return counts


def _torment(reference: Reference, generator: random.Random, counts: dict[str, int], count: int) -> None:
    """Some kills in one folder, and the comparison."""
    out = reference.case / "out"
    shutil.rmtree(out, ignore_errors=True)
    command = "run" if generator.random() < WHOLE_RUNS else "simulate"
    counts["folders"] += 1
    history = [reference.case.name, command]
    for _ in range(generator.randint(1, MOST_KILLS)):
        if counts["kills"] == count:
            break
        often = generator.random() < 0.7
        by_time = generator.random() < 0.5
        after = generator.uniform(0.0, reference.seconds[command]) if by_time else None
        operation = None if by_time else generator.randint(1, reference.operations[command])
        history.append(f"{'often' if often else 'seldom'} {after if by_time else operation}")
        code = _command(reference, command, often=often, seconds=after, operation=operation)
        if code == -signal.SIGKILL:
            counts["kills"] += 1
            counts["by time" if by_time else "by file operation"] += 1
            counts[f"killed in {_stage_reached(out)}"] += 1
        else:
            counts["ended before"] += 1
            if code != reference.codes[command]:
                _fail(counts, history, f"a run that was not killed ended with {code}")
    counts["last runs that found checkpoints"] += bool(numbers_on_disk(OutputFolder(out).segments))
    code = _command(reference, command, often=False)
    if code != reference.codes[command]:
        _fail(counts, history, f"the last run ended with {code}")
        return
    for problem in _differences(reference.content, content(out)):
        _fail(counts, history, problem)
    left = [path for path in out.rglob("*") if path.suffix == ".tmp" or path.name.startswith("segment")]
    if left:
        _fail(counts, history, f"left: {', '.join(str(path.relative_to(out)) for path in left)}")
    before = _identities(out)
    if _command(reference, command, often=False) != reference.codes[command] or _identities(out) != before:
        _fail(counts, history, "a further run made files anew")


def _fail(counts: dict[str, int], history: list[str], problem: str) -> None:
    counts["failures"] += 1
    sys.stdout.write(f"{'; '.join(history)}: {problem}\n")


def _stage_reached(out: Path) -> str:
    """The stage whose files are the last there."""
    for stage in ("report", "simulate", "modes", "mesh"):
        if (out / stage).is_dir():
            return stage
    return "start"


def _reference(place: Path, name: str) -> Reference:
    """A case and its undisturbed run in a process like those that are killed."""
    folder = place / name
    folder.mkdir()
    if name == "frame_and_shell":
        (folder / "case.toml").write_text(FRAME_AND_SHELL)
    else:
        shutil.copyfile(PIPELINE / f"{name}.toml", folder / "case.toml")
    if name == "collisions":
        shutil.copyfile(PIPELINE / "tank.stl", folder / "tank.stl")
    if name == "sea":
        for part in (PIPELINE.parents[1] / "cases" / "irregular_sea").iterdir():
            if part.suffix in {".toml", ".nc", ".csv"}:
                shutil.copyfile(part, folder / part.name)
    made = Reference(folder, CASES[name], {}, {}, {}, 1, {})
    seconds, operations, codes = {}, {}, {}
    # once here, so that what the processes below import and compile is there already
    _call(made, "simulate")
    for command in ("simulate", "run"):
        shutil.rmtree(folder / "out")
        noted = place / f"{name}.operations"
        begin = time.monotonic()
        codes[command] = _command(made, command, often=False, note=noted)
        seconds[command] = time.monotonic() - begin
        operations[command] = int(noted.read_text())
    from heavylift.pipeline import load_results

    results = load_results(folder)
    assert len(results.time) > 50, (name, results.outcome, results.metadata["message"])
    steps = int(results.metadata["steps"])
    sys.stdout.write(
        f"{name}: {steps} steps; {', '.join(f'{c} {seconds[c]:.1f} s, {operations[c]} operations' for c in seconds)}\n"
    )
    sys.stdout.flush()
    return made._replace(
        content=content(folder / "out"), seconds=seconds, operations=operations, steps=steps, codes=codes
    )


def _command(
    reference: Reference,
    command: str,
    *,
    often: bool,
    seconds: float | None = None,
    operation: int | None = None,
    note: Path | None = None,
) -> int:
    """Run a command in a process of its own; its exit code, or minus the signal that ended it.

    Parameters
    ----------
    reference
        The case.
    command
        ``"simulate"`` or ``"run"``.
    often
        Whether checkpoints are written after every thirtieth part of the steps.
    seconds, operation
        When it is killed; None if not.
    note
        File for the number of operations.
    """
    child = os.fork()
    if child == 0:
        code = 120
        try:
            code = _in_child(reference, command, often=often, operation=operation, note=note)
        finally:
            os._exit(code)
    if seconds is not None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            found, status = os.waitpid(child, os.WNOHANG)
            if found:
                return os.waitstatus_to_exitcode(status)
            time.sleep(0.001)
        os.kill(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _call(reference: Reference, command: str) -> int:
    """The command line, in this process."""
    from heavylift.pipeline.commands.cli import app

    tokens = [command, str(reference.case), "--quiet"]
    for text in reference.overrides:
        tokens += ["--set", text]
    return int(app(tokens, result_action="return_value"))


def _in_child(
    reference: Reference, command: str, *, often: bool, operation: int | None, note: Path | None
) -> int:
    from heavylift.pipeline.stages import advance

    silent = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silent, 1)
    os.dup2(silent, 2)
    if often:
        piece = max(1, reference.steps // 30)
        advance.SEGMENT_SECONDS = 0.0
        advance.FIRST_PIECE = piece
        advance.next_piece = lambda *_arguments: piece
    with _watched(reference.case / "out", operation) as seen:
        code = _call(reference, command)
    if note is not None:
        note.write_text(str(len(seen)))
    return code


@contextlib.contextmanager
def _watched(out: Path, operation: int | None) -> Iterator[list[str]]:
    """Count what is done with files below a folder, and end the process before a certain one."""
    seen: list[str] = []
    top = f"{out}{os.sep}"
    events = {"open", "os.rename", "os.remove", "os.rmdir", "os.mkdir", "os.truncate"}

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event in events and str(arguments[0]).startswith(top):
            seen.append(event)
            if len(seen) == operation:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)
    yield seen


def content(out: Path) -> dict[str, Any]:
    """All numbers and texts in the files of the stages, by file and place."""
    found: dict[str, Any] = {}
    folder = OutputFolder(out)
    for path in sorted([*folder.stage("mesh").glob("*"), *folder.stage("modes").glob("*"), folder.results]):
        name = str(path.relative_to(out))
        if path.suffix in {".h5", ".nc"}:
            with h5py.File(path) as file:
                for key, value in file.attrs.items():
                    if key not in NOT_COMPARED:
                        found[f"{name}: {key}"] = _bytes(value)
                file.visititems(_collector(found, name))
        elif path.suffix == ".npz":
            with np.load(path, allow_pickle=False) as file:
                found |= {f"{name}: {key}": _bytes(file[key]) for key in file.files}
        elif path.suffix == ".vtu":
            found[name] = path.read_bytes()
    return found


def _collector(found: dict[str, Any], name: str) -> Callable[[str, Any], None]:
    def collect(place: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            found[f"{name}: {place}"] = _bytes(item[()])

    return collect


def _bytes(value: Any) -> tuple[str, tuple[int, ...], Any]:
    array = np.asarray(value)
    return str(array.dtype), array.shape, array.tolist() if array.dtype == object else array.tobytes()


def _differences(expected: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """What is not the same, in words."""
    return [
        f"{key} is {'not there' if key not in found else 'new' if key not in expected else 'not the same'}"
        for key in sorted(expected.keys() | found.keys())
        if key not in found or key not in expected or found[key] != expected[key]
    ]


def _identities(out: Path) -> dict[str, tuple[int, int]]:
    """Size and time of the last change of all files but the lock."""
    return {
        str(path): (path.stat().st_size, path.stat().st_mtime_ns)
        for path in out.rglob("*")
        if path.is_file() and path.name != ".lock"
    }
