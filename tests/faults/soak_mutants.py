"""Mutants of the case files of this project, and hostile files beside them, to the loader and to simulations.

Each mutant is a case file of `cases/` or of `heavylift new` in which one to three things are changed: a value becomes
one of another type, unit, sign or size, a key is renamed, dropped or written twice, a table becomes a list, a name
becomes that of something else, lines are swapped, characters are garbled. Of the ways in which a command may end these
are counted:

* ``ok``: the mutant is as good as the case;
* ``refused``: one line or more with file and key, exit code 2;
* ``stopped``: the run said by itself why it ended, with an exit code of its own;
* ``slow``: not done within the seconds it has (a simulation may take long, a loader may not);
* ``failures``: anything else, as an error without a file, one that is no `InputError`, or a crash.
"""

from __future__ import annotations

import contextlib
import copy
import hashlib
import math
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import tomllib
import traceback
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["mutant", "run", "run_hostile", "run_loader", "run_simulations"]

TREE = Path(__file__).resolve().parents[2]
LOADER_SECONDS, SIMULATION_SECONDS = 20.0, 20.0
STOPPED = {3, 4, 5, *range(8, 21)}

VALUES: tuple[Any, ...] = (
    0, -1, 1, 2, 10**9, 2**63 - 1, 2**63, -(2**31), 0.0, -0.0, -1.0, 1e-300, 5e-324, 1e300, 1e9, 1e-9, math.nan,
    math.inf, -math.inf, "", " ", "nan", "inf", "0", "1", "-1 m", "1 m", "0 m", "1 nm", "1e9 m", "1 kg", "1 s", "1 N",
    "1 Pa", "3 deg", "1 km^400", "1 degC", "{i}", "{n+1}", "ground", "energy", "x" * 3000, "\u00e9", "\n", "a.b",
    "../x", "/", "*", "none", "free", "fixed", "auto", True, False, [], {}, [[]], [{}], [0, 0, 0], [0.0, 0.0, 1.0],
    [1, 2], ["1 m"] * 3, [1] * 40, {"type": "x"}, {"a": {"b": [1]}}, "channel.a.b.max", [math.nan] * 3,
    ["ground", "ground"],
)  # fmt: skip


def sources() -> list[Path]:
    """Folders of the cases that are mutated, small first."""
    found = [file.parent for file in (TREE / "cases").glob("*/case.toml")]
    found += [file.parent for file in (TREE / "pipeline" / "templates").glob("*/case.toml")]
    return sorted(found)


def mutant(source: Path, rng: random.Random) -> str:
    """Text of a case file with some mistakes."""
    text = (source / "case.toml").read_text(encoding="utf-8")
    if rng.random() < 0.2:
        return _garbled(text, rng)
    document = tomllib.loads(text)
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        _mutate(document, rng)
    return "\n".join(_lines(document)) + "\n"


def _garbled(text: str, rng: random.Random) -> str:
    """Text with characters flipped, lines swapped, dropped or doubled."""
    lines = text.splitlines()
    for _ in range(rng.randint(1, 3)):
        at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
        match rng.randrange(5):
            case 0:
                lines[at], lines[other] = lines[other], lines[at]
            case 1:
                lines[at] = lines[other]
            case 2:
                lines.insert(at, lines[other])
            case 3 if lines[at]:
                k = rng.randrange(len(lines[at]))
                lines[at] = lines[at][:k] + rng.choice("\"'[]{}=.,#\\\t\0\u00e9 09-e") + lines[at][k + 1 :]
            case _:
                del lines[at]
        if not lines:
            return ""
    return "\n".join(lines) + "\n"


def _places(node: Any) -> Iterator[tuple[Any, Any]]:
    """Every container of a document with each of its keys."""
    if isinstance(node, (dict, list)):
        keys = list(node) if isinstance(node, dict) else range(len(node))
        for key in keys:
            yield node, key
            yield from _places(node[key])


def _mutate(document: dict[str, Any], rng: random.Random) -> None:
    """One mistake somewhere in a document."""
    places = list(_places(document))
    if not places:
        return
    holder, key = rng.choice(places)
    value = holder[key]
    match rng.randrange(12):
        case 0 if isinstance(holder, dict):
            holder[f"{key}s"] = holder.pop(key)
        case 1:
            del holder[key]
        case 2 if isinstance(holder, list):
            holder.append(copy.deepcopy(value))
        case 3:
            other, there = rng.choice(places)
            with contextlib.suppress(KeyError, IndexError):
                taken = copy.deepcopy(other[there])
                holder[key] = taken
        case 4:
            holder[key] = [value]
        case 5 if isinstance(value, list):
            rng.shuffle(value)
        case 6 if isinstance(value, (int, float)) and not isinstance(value, bool):
            holder[key] = rng.choice([-value, 1e3 * value, 1e-3 * value, 1e9 * value, 0, value + 1])
        case 7 if isinstance(value, str) and " " in value:
            number, _, unit = value.partition(" ")
            choices = [
                f"-{value}",
                f"0 {unit}",
                f"1e9 {unit}",
                f"1e-9 {unit}",
                number,
                f"{value}^2",
                f"{number} m",
            ]
            holder[key] = rng.choice(choices)
        case 8 if isinstance(value, str):
            texts = [str(box[k]) for box, k in places if isinstance(box[k], str)]
            holder[key] = rng.choice(texts)
        case _:
            holder[key] = copy.deepcopy(rng.choice(VALUES))


def _lines(document: dict[str, Any]) -> Iterator[str]:
    """A document as TOML, every table on one line."""
    for key, value in document.items():
        yield f"{_quoted(str(key))} = {_toml(value)}"


def _quoted(text: str) -> str:
    """A basic string of TOML."""
    escapes = {'"': '\\"', "\\": "\\\\"}
    return '"' + "".join(escapes.get(c, c if c.isprintable() else f"\\u{ord(c):04x}") for c in text) + '"'


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_quoted(str(key))} = {_toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return _quoted(value) if isinstance(value, str) else repr(value)


class _SlowError(BaseException):
    """The time is over."""


@contextlib.contextmanager
def _within(seconds: float) -> Iterator[None]:
    """Raise if something takes longer."""

    def over(_number: int, _frame: Any) -> None:
        raise _SlowError

    before = signal.signal(signal.SIGALRM, over)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _mutated_folder(top: Path, source: Path, text: str) -> Path:
    """A copy of a case, without its outputs, with another case file."""
    folder = top / source.name
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(source, folder, ignore=shutil.ignore_patterns("out", "out-*"))
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return folder


def _loaded(folder: Path) -> tuple[str, str]:
    """How the loader, with all its checks before the first stage, ends, and what it says."""
    from heavylift.numerics.outcome import InputError, InputErrors
    from heavylift.pipeline.assemble.early_checks import scene_errors
    from heavylift.pipeline.stages.stages import load_changed_case

    try:
        with _within(LOADER_SECONDS):
            errors = scene_errors(load_changed_case(folder))
    except _SlowError:
        return "slow", ""
    except InputError as error:
        return _told(error)
    except Exception:  # noqa: BLE001  what is looked for
        return "failures", traceback.format_exc()
    return _told(InputErrors(errors)) if errors else ("ok", "")


def _told(error: Any) -> tuple[str, str]:
    """A refusal is one line for each mistake, each with its place."""
    from heavylift.numerics.outcome import InputErrors

    parts = error.errors if isinstance(error, InputErrors) else [error]
    for part in parts:
        if "\n" in str(part) or not part.source or not part.problem or not (part.key or part.expected):
            return "failures", f"no place, or no line: {part}"
    return "refused", str(error)


def run_loader(count: int, seed: int, tell: Callable[[str], object] = print) -> Counter[str]:
    """Mutants to the loader and all checks before the first stage; see the top of the file."""
    counts: Counter[str] = Counter()
    known = sources()
    with tempfile.TemporaryDirectory() as top:
        for number in range(count):
            rng = random.Random(f"{seed} {number}")  # noqa: S311
            source = rng.choice(known)
            text = mutant(source, rng)
            folder = _mutated_folder(Path(top), source, text)
            how, words = _loaded(folder)
            counts[how] += 1
            if how in {"failures", "slow"}:
                tell(f"loader {how}: mutant {number} of seed {seed}, {source.name}: {words}")
    return counts


def run_simulations(count: int, seed: int, tell: Callable[[str], object] = print) -> Counter[str]:
    """Mutants that the loader accepts, simulated for a moment in processes of their own."""
    counts: Counter[str] = Counter()
    known = sources()
    number = done = 0
    with tempfile.TemporaryDirectory() as top:
        while done < count:
            number += 1
            rng = random.Random(f"{seed} simulated {number}")  # noqa: S311
            source = rng.choice(known)
            folder = _mutated_folder(Path(top), source, mutant(source, rng))
            if _loaded(folder)[0] != "ok":
                continue
            done += 1
            how, words = _simulated(folder)
            counts[how] += 1
            if how == "failures":
                tell(f"simulation: mutant {number} of seed {seed}, {source.name}: {words}")
    return counts


def _simulated(folder: Path) -> tuple[str, str]:
    """How a simulation ends."""
    code = "from heavylift.pipeline.commands.start import main; main()"
    command = [sys.executable, "-c", code, "simulate", str(folder), "--quiet"]
    try:
        ended = subprocess.run(
            command, capture_output=True, text=True, timeout=SIMULATION_SECONDS, check=False, cwd=folder
        )
    except subprocess.TimeoutExpired:
        return "slow", ""
    words = ended.stderr.strip()
    if "Traceback" in words or "Warning" in words or ended.returncode < 0 or ended.returncode in {1, 70, 71}:
        files = [file.read_text() for file in folder.glob("heavylift-fault-*.txt")]
        return "failures", "\n".join([str(ended.returncode), words, *files])
    if ended.returncode == 0:
        return ("ok", "") if _all_finite(folder) else ("failures", "a record is not finite")
    if not words:
        return "failures", f"exit code {ended.returncode} without a word"
    if ended.returncode in STOPPED:
        return "stopped", words
    return ("refused", words) if ended.returncode == 2 else ("failures", f"{ended.returncode}: {words}")


def _all_finite(folder: Path) -> bool:
    """Whether no record of a run that completed is infinite; a number that does not exist is NaN by intent."""
    import numpy as np

    from heavylift.pipeline import load_results

    results = load_results(folder)
    return not any(np.isinf(results[name]).any() for name in results)


def _flipped(content: bytes, rng: random.Random) -> bytes:
    """A file that is cut, or has other bits or bytes."""
    found = bytearray(content)
    match rng.randrange(5):
        case 0:
            return content[: rng.randrange(len(content))]
        case 1:
            for _ in range(rng.choice([1, 2, 8, 64])):
                found[rng.randrange(len(found))] ^= 1 << rng.randrange(8)
        case 2:  # where the tables of the file are
            for _ in range(rng.choice([1, 2, 8])):
                found[rng.randrange(min(len(found), 8000))] = rng.choice([0, 255, 127, rng.randrange(256)])
        case 3:
            at, length = rng.randrange(len(found)), rng.choice([4, 64, 512])
            found[at : at + length] = bytes([rng.choice([0, 255])]) * len(found[at : at + length])
        case _:
            at, other, length = rng.randrange(len(found)), rng.randrange(len(found)), rng.choice([8, 64, 512])
            found[at : at + length] = found[other : other + length]
    return bytes(found)


def _of_other_types(path: Path, rng: random.Random) -> None:
    """An HDF5 file with something of another type, shape or place."""
    import h5py
    import numpy as np

    with h5py.File(path, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        name = rng.choice(names)
        shape = getattr(file[name], "shape", None) or (1,)
        makes: list[dict[str, Any]] = [
            {"data": "text"},
            {"data": np.array([b"a", b"b"])},
            {"data": np.zeros(shape, dtype=[("x", "f8"), ("y", "i4")])},
            {"data": np.zeros(shape, dtype=complex)},
            {"data": np.full(shape, rng.choice([math.nan, math.inf, -1.0, 0.0, 1e300]))},
            {"data": np.zeros([max(1, length + rng.choice([-1, 0, 1])) for length in shape])},
            {"data": h5py.Empty("f8")},
            {"shape": (10**6, 10**6), "dtype": "f8", "chunks": (100, 100)},
            {"shape": (10**12,), "dtype": "f8", "chunks": (1000,)},
        ]
        links = [
            h5py.SoftLink(f"/{name}"),
            h5py.ExternalLink(path, f"/{name}"),
            h5py.ExternalLink("/dev/zero", "/x"),
        ]
        made = rng.choice([*makes, *links, None, "group", "top", "attribute"])
        keys = list(file[name].attrs)
        if made == "attribute":
            if keys:
                file[name].attrs[rng.choice(keys)] = rng.choice(
                    [b"\xff", 1.5, np.array([1, 2]), "{", "null", "x"]
                )
            return
        del file[name]
        match made:
            case None:
                return
            case "group":
                file.create_group(name)
            case "top":
                file[name] = file["/"]
            case dict():
                file.create_dataset(name, **made)
            case _:
                file[name] = made


def _readers(top: Path) -> dict[str, tuple[Path, Callable[[Path], object]]]:
    """Sound files of each kind, and what reads them."""
    from heavylift.numerics import objects
    from heavylift.pipeline import load_case, load_results, run_case
    from heavylift.pipeline.results.model_io import read_header, read_model, read_reduced
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_digest, read_netcdf

    folder = top / "beam"
    folder.mkdir()
    shutil.copyfile(TREE / "tests" / "pipeline" / "small_beam.toml", folder / "case.toml")
    case = load_case(folder, ("simulate.duration=1 ms",))
    run_case(case, stages=("mesh", "modes", "simulate"))
    database = TREE / "cases" / "transport_barge" / "barge.nc"
    out = folder / "out"

    def histories(path: Path) -> object:
        results = load_results(path)
        return [results[name] for name in results], results.meshes

    def again(path: Path) -> object:
        shutil.copyfile(path, out / "simulate" / "manifest.json")
        return run_case(case, stages=("mesh", "modes", "simulate"))

    def restarted(path: Path) -> object:
        shutil.copyfile(path, out / "mesh" / "manifest.json")
        return run_case(case, stages=("mesh", "modes", "simulate"))

    whole = top / "Unit.o"
    content = bytes(range(256)) * 40
    whole.write_bytes(objects.MAGIC + hashlib.blake2b(content, digest_size=32).digest() + content)
    return {
        "database": (database, read_netcdf),
        "digest": (database, read_digest),
        "model": (out / "mesh" / "beam.h5", read_model),
        "reduced": (out / "modes" / "beam.h5", read_reduced),
        "header": (out / "modes" / "beam.h5", read_header),
        "histories": (out / "simulate" / "results.h5", histories),
        "manifest": (out / "simulate" / "manifest.json", again),
        "mesh manifest": (out / "mesh" / "manifest.json", restarted),
        "kernel": (whole, objects._read),
    }


def run_hostile(count: int, seed: int, tell: Callable[[str], object] = print) -> Counter[str]:
    """Files that are cut, flipped or of other types to what reads them, each in a process of its own."""
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        readers = _readers(top)
        for number in range(count):
            rng = random.Random(f"{seed} hostile {number}")  # noqa: S311
            kind = rng.choice(list(readers))
            sound, read = readers[kind]
            path = top / f"hostile{sound.suffix}"
            path.write_bytes(_flipped(sound.read_bytes(), rng))
            if sound.suffix in {".h5", ".nc"} and rng.random() < 0.5:
                shutil.copyfile(sound, path)
                _of_other_types(path, rng)
            how, words = _read_apart(lambda read=read, path=path: read(path))  # type: ignore[misc]
            counts[how] += 1
            if how == "failures":
                tell(f"hostile: file {number} of seed {seed}, {kind}: {words}")
    return counts


def _read_apart(read: Callable[[], object]) -> tuple[str, str]:
    """How reading ends in a process of its own, which may crash or hang."""
    from heavylift.numerics.outcome import InputError

    told, tells = os.pipe()
    child = os.fork()
    if child == 0:
        how = ("ok", "")
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(60)
        try:
            read()
        except InputError as error:
            how = _told(error)
        except BaseException:  # noqa: BLE001  what is looked for
            how = "failures", traceback.format_exc()
        finally:
            os.write(tells, "\n".join(how)[:60000].encode("utf-8", "replace"))
            os._exit(0)
    os.close(tells)
    with os.fdopen(told, "rb") as stream:
        words = stream.read().decode("utf-8", "replace")
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status):
        return "failures", f"ended by {signal.Signals(os.WTERMSIG(status)).name}"
    how, _, rest = words.partition("\n")
    return how, rest


def run(count: int, seed: int) -> dict[str, int]:
    """`count` mutants to the loader, a twentieth of them simulated, and a tenth as many hostile files.

    Returns
    -------
    dict
        Counts by what was done and how it ended; ``failures`` is the sum of all that may not happen.
    """
    parts = {
        "loader": run_loader(count, seed),
        "simulation": run_simulations(max(count // 20, 1), seed),
        "hostile file": run_hostile(max(count // 10, 1), seed),
    }
    found: dict[str, int] = {}
    for part, counts in parts.items():
        found |= {f"{part} {how}": number for how, number in sorted(counts.items()) if how != "failures"}
    found["failures"] = sum(counts["failures"] for counts in parts.values())
    found["failures"] += parts["loader"]["slow"]
    return found
