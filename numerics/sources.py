"""Which sources compiled code depends on: a module and all that it imports when it is imported.

Compiled code is kept under names that hold a digest of these sources. Numba itself looks only at the file that a
function is written in, so after an edit its callers in other files would keep the old physics (numba issue 1833).
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import sys
import tempfile
import time
from functools import cache
from pathlib import Path

__all__ = [
    "cache_root",
    "closure",
    "closure_digest",
    "distrusted",
    "edited_since_start",
    "made_folder",
    "say",
]

STARTED = time.time()
"""When this process began to import kernels."""

PACKAGE = Path(__file__).resolve().parent.parent
"""Folder that holds the folders of the sources."""

IMPORT = re.compile(
    r"^(?:from (heavylift[\w.]*) import (\([^)]*\)|[^\n(]*)|import (heavylift[\w.]*)"
    r"|when_compiling\(\"(heavylift[\w.]*)\"\))",
    re.MULTILINE,
)
"""An import at the top level of a module, or what the compiler imports for it (`heavylift.numerics.jit`).

Those within functions and for type checkers do not count.
"""


def cache_root() -> Path:
    """Folder of all compiled code: ``HEAVYLIFT_CACHE_DIR``, or one in the user's cache folder."""
    chosen = os.environ.get("HEAVYLIFT_CACHE_DIR")
    if chosen:
        return Path(chosen)
    base = os.environ.get("XDG_CACHE_HOME")
    try:
        return (Path(base) if base else Path.home() / ".cache") / "heavylift"
    except RuntimeError:  # a user without a home, as in some containers
        return Path(tempfile.gettempdir()) / f"heavylift-{os.getuid()}"


def distrusted(*places: Path) -> str:
    """Why compiled code in folders and files below the cache root is not loaded: others could have put it there.

    Trusted is what belongs to this user or root and what no other may write to. A group without other members is no
    other, as on systems where each user has a group of the same name and files are made writable for the group.

    Returns
    -------
    str
        The reason with the way out; empty if there is none, or nothing is there.
    """
    if not hasattr(os, "geteuid"):  # a system whose files have no such owners
        return ""
    for place in (cache_root(), *places):
        try:
            status = place.stat()
        except OSError:  # it is not there, or reported where it is written
            continue
        if status.st_uid not in {0, os.geteuid()}:
            return (
                f"{place} belongs to {_user(status.st_uid)}; set HEAVYLIFT_CACHE_DIR to a folder of your own"
            )
        # in a folder as /tmp nobody can replace what is not his own
        shared = place not in places and bool(status.st_mode & stat.S_ISVTX)
        others = status.st_mode & stat.S_IWOTH
        group = status.st_mode & stat.S_IWGRP and not _is_own_group(status.st_gid, status.st_uid)
        if (others or group) and not shared:
            return f"other users may write to {place}; remove it, or set HEAVYLIFT_CACHE_DIR to a folder of your own"
    return ""


def _user(number: int) -> str:
    """A user for a person."""
    import pwd

    try:
        return f"user {pwd.getpwuid(number).pw_name}"
    except KeyError:
        return f"user {number}"


@cache
def _is_own_group(group: int, user: int) -> bool:
    """Whether a group is that of a user alone: of the same name, and without other members."""
    import grp
    import pwd

    try:
        of_group, name = grp.getgrgid(group), pwd.getpwuid(user).pw_name
    except KeyError:  # as in containers whose user stands in no list
        return False
    return of_group.gr_name == name and set(of_group.gr_mem) <= {name}


def made_folder(folder: Path) -> Path:
    """A folder below the cache root, made if it is not there: no other user may write to it, whatever the umask."""
    root = cache_root()
    root.parent.mkdir(parents=True, exist_ok=True)
    for place in dict.fromkeys((root, folder)):
        place.mkdir(mode=0o755, exist_ok=True)
    return folder


@cache
def say(text: str) -> None:
    """Tell a person something that no result depends on; once."""
    from heavylift.numerics.outcome import visible  # no kernel depends on it

    print(visible(f"heavylift: {text}"), file=sys.stderr)  # noqa: T201


def _file(module: str) -> Path:
    if not module.startswith("heavylift."):
        return Path(str(sys.modules[module].__file__))
    path = PACKAGE.joinpath(*module.split(".")[1:])
    if path.is_dir():
        return path / "__init__.py"
    path = path.with_suffix(".py")
    # a folder elsewhere may be on the path of a package
    elsewhere = None if path.is_file() else getattr(sys.modules.get(module), "__file__", None)
    return path if elsewhere is None else Path(elsewhere)


@cache
def _source(module: str) -> tuple[bytes, tuple[str, ...]]:
    """Digest of the content of a module, and the modules of this package that it imports."""
    file = _file(module)
    if not file.is_file():  # words of another text, or a namespace
        return bytes(32), ()
    content = file.read_bytes()
    found: list[str] = []
    for whole, names, plain, taught in IMPORT.findall(content.decode()):
        found.append(whole or plain or taught)
        folder = PACKAGE.joinpath(*whole.split(".")[1:])
        parts = re.findall(r"(\w+)(?: as \w+)?", names)
        found += [f"{whole}.{name}" for name in parts if (folder / f"{name}.py").is_file()]
    return hashlib.blake2b(content, digest_size=32).digest(), tuple(found)


@cache
def closure(modules: tuple[str, ...]) -> tuple[str, ...]:
    """Modules with all that they import, sorted."""
    seen: set[str] = set()
    waiting = list(modules)
    while waiting:
        module = waiting.pop()
        if module not in seen and module != "heavylift":
            seen.add(module)
            waiting += _source(module)[1]
    return tuple(sorted(seen))


@cache
def closure_digest(modules: tuple[str, ...], more: bytes = b"") -> str:
    """Hexadecimal digest of the names and contents of modules and all that they import, and of more words."""
    digest = hashlib.blake2b(more, digest_size=12)
    for module in closure(modules):
        digest.update(f"{module}\n".encode())
        digest.update(_source(module)[0])
    return digest.hexdigest()


def edited_since_start(modules: tuple[str, ...]) -> bool:
    """Whether a source of the closure may be newer than what this process has imported.

    What is compiled then is the old code, and must not be kept under the name of the new.
    """
    files = (_file(module) for module in closure(modules))
    return any(file.is_file() and file.stat().st_mtime > STARTED for file in files)
