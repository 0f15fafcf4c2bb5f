"""HDF5 files that others have written, or that a disk has damaged: read, or refused in one line.

The library that reads them is in C: a damaged file can let it read for ever, or end the process. So a file from outside
is read first by a process of its own, with limits of time and memory; that costs a tenth of a second. The same process
sees whether the file leads to other files. What the library says of the rest comes as errors of many types.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from heavylift.numerics.children import NEUTRAL_FOLDER, module_folders, python_command
from heavylift.numerics.memory import amount_of_bytes, available_memory
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    import h5py

__all__ = ["HOLDS_ALL", "check_hdf5", "is_hdf5", "opened_hdf5", "outside_of_hdf5", "reported_of_file"]

SIGNATURE = b"\x89HDF\r\n\x1a\n"

HOLDS_ALL = "an HDF5 file that holds all its data itself"
"""What is expected of one that leads to other files."""

SECONDS = 20.0
"""For a file from outside, and a second for each `BYTES_A_SECOND` of it besides."""
BYTES_A_SECOND = 20e6

SURVEY = """
import json, sys
sys.path[:] = json.loads(sys.argv[3])
import contextlib
import h5py
with contextlib.suppress(ImportError, OSError, ValueError):
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (int(float(sys.argv[2])) + 2**31,) * 2)
found = {"bytes": 0.0, "largest": ["", 0.0]}
limit = float(sys.argv[2])
def fails(name, error):
    print(json.dumps({"key": name, "problem": f"{type(error).__name__}: {error}"}))
    sys.exit(0)
def outside(file):
    waiting, seen = [("", file)], set()
    while waiting:
        place, group = waiting.pop()
        for name in group:
            link = group.get(name, getlink=True)
            here = f"{place}/{name}"
            if isinstance(link, h5py.ExternalLink):
                return here, f"links to {link.filename!r}"
            if not isinstance(link, h5py.HardLink):
                continue
            item = group[name]
            if isinstance(item, h5py.Group):  # groups can hold each other
                address = h5py.h5o.get_info(item.id).addr
                if address not in seen:
                    seen.add(address)
                    waiting.append((here, item))
            elif isinstance(item, h5py.Dataset):
                named = [part[0] for part in item.external or ()]
                if item.is_virtual:
                    named += [part.file_name for part in item.virtual_sources() if part.file_name != "."]
                if named:
                    return here, f"has its data in {named[0]!r}"
    return None
def look(name, item):
    try:
        for key in item.attrs:
            item.attrs[key]
        if isinstance(item, h5py.Dataset):
            size = float(item.dtype.itemsize)
            for length in item.shape or ():
                size *= length
            found["bytes"] += size
            if size > found["largest"][1]:
                found["largest"] = [name, size]
            if found["bytes"] <= limit:
                item[()]
    except Exception as error:
        fails(name, error)
name = "/"
try:
    with h5py.File(sys.argv[1], "r") as file:
        leads = outside(file)  # before anything of it is read
        if leads:
            print(json.dumps({"key": leads[0], "problem": leads[1], "outside": True}))
            sys.exit(0)
        look("/", file)
        file.visititems(look)
except Exception as error:
    fails("", error)
print(json.dumps(found))
"""
"""Reads all that is in a file, once, and says as JSON how much that is, what cannot be read, or where it leads."""


class _Problem(NamedTuple):
    """What is wrong with a file."""

    key: str
    words: str
    outside: bool = False  # it leads to another file


def is_hdf5(path: Path) -> bool:
    """Whether the signature of HDF5 stands at one of the places where it may; the library is not asked."""
    size, place = path.stat().st_size, 0
    with path.open("rb") as stream:
        while place + len(SIGNATURE) <= size:
            stream.seek(place)
            if stream.read(len(SIGNATURE)) == SIGNATURE:
                return True
            place = max(512, 2 * place)
    return False


def check_hdf5(path: Path, expected: str) -> None:
    """Refuse a file that leads to others, or whose reading fails, crashes, or takes more memory or time than there is.

    Parameters
    ----------
    path
        A file that is there.
    expected
        What it should be, for the error.

    Raises
    ------
    InputError
        With the name of the data set, as far as it is known.
    """
    problem = _problem(path)
    if problem is not None:
        wanted = HOLDS_ALL if problem.outside else expected
        raise InputError(problem.words, source=path, key=problem.key, expected=wanted)


def outside_of_hdf5(path: Path) -> tuple[str, str] | None:
    """Where an HDF5 file leads to another file, and how; None if it does not, or if it cannot be read.

    Parameters
    ----------
    path
        A file that is there.
    """
    problem = _problem(path)
    return (problem.key, problem.words) if problem is not None and problem.outside else None


def _problem(path: Path) -> _Problem | None:
    status = path.stat()
    return _survey(str(path.absolute()), status.st_size, status.st_mtime_ns)


@cache
def _survey(path: str, size: int, _changed: int) -> _Problem | None:
    """What is wrong with a file; None if it can be read."""
    limit, seconds = available_memory(), SECONDS + size / BYTES_A_SECOND
    command = python_command("-c", SURVEY, path, str(limit), json.dumps(module_folders()))
    try:
        ended = subprocess.run(  # noqa: S603  Python itself, with a program of ours
            command,
            cwd=NEUTRAL_FOLDER,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return _Problem("", f"is damaged: it cannot be read within {seconds:.0f} s")
    if ended.returncode < 0:
        return _Problem("", "is damaged: the library that reads it crashes")
    try:
        found = json.loads(ended.stdout)
    except ValueError:  # the process could not begin, or was short of memory
        words = (ended.stderr.strip().splitlines() or ["it gives no reason"])[-1]
        return _Problem("", f"is damaged: it cannot be read: {words}")
    if "outside" in found:
        return _Problem(found["key"], found["problem"], outside=True)
    if "problem" in found:
        return _Problem(found["key"], f"is damaged: {found['problem']}")
    if found["bytes"] > limit:
        name, largest = found["largest"]
        words = f"has {amount_of_bytes(largest)} of {amount_of_bytes(found['bytes'])} in the file"
        return _Problem(name, words)
    return None


@contextlib.contextmanager
def opened_hdf5(path: Path, expected: str, *, foreign: bool = False) -> Iterator[h5py.File]:
    """Open an HDF5 file for reading, and say of all that fails where it stands.

    Parameters
    ----------
    path, expected
        As of `check_hdf5`.
    foreign
        Whether the file comes from outside, and is looked through first.

    Raises
    ------
    InputError
        The file does not exist or is damaged, or what is read of it is something else than was expected.
    """
    import h5py

    if foreign:
        check_hdf5(path, expected)
    with reported_of_file(path, expected), h5py.File(path, "r") as file:
        yield file


@contextlib.contextmanager
def reported_of_file(path: Path, expected: str) -> Iterator[None]:
    """Say of whatever a library raises while a file is read that the file is at fault."""
    try:
        yield
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError("does not exist", source=path, expected=expected) from None
    except MemoryError as error:
        raise InputError(
            f"has more in it than there is memory: {error}", source=path, expected=expected
        ) from error
    except Exception as error:  # errors of any type, as the library feels
        raise InputError(f"is damaged: {_words(error)}", source=path, expected=expected) from error


def _words(error: Any) -> str:
    """What a library says, without the name of the function in C that says it."""
    text = " ".join(str(error.args[0] if error.args else error).split())
    for begin in ("Unable to synchronously open file ", "Unable to open file "):
        text = text.removeprefix(begin)
    return text.strip("()'\" ") or type(error).__name__
