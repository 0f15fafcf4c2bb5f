"""The C compiler of the system, for libraries of FMUs."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sysconfig
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError, in_one_line

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

__all__ = ["c_compiler", "compile_library"]

LONGEST = 300.0
"""Time [s] that the compiler has."""


def c_compiler() -> list[str]:
    """Command of the C compiler: ``cc``, or what the variable ``CC`` says.

    Raises
    ------
    InputError
        If there is none.
    """
    given = os.environ.get("CC") or "cc"
    words = shlex.split(given)
    if not words or shutil.which(words[0]) is None:
        raise InputError(
            f"no C compiler {given!r} is found",
            source="fmu",
            expected="one that is called 'cc' (Debian: apt install gcc), or its name in the variable CC",
        )
    return words


def compile_library(arguments: Sequence[str], library: Path, folder: Path) -> None:
    """Compile a shared library.

    Parameters
    ----------
    arguments
        Of the compiler: sources and options.
    library
        Where it goes.
    folder
        In which the compiler works.

    Raises
    ------
    InputError
        If there is no compiler, or it does not do it.
    """
    command = [*c_compiler(), "-shared", "-fPIC", "-O2", "-o", str(library), *arguments, "-lm"]
    try:
        done = subprocess.run(  # noqa: S603
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
            timeout=LONGEST,
            cwd=folder,
        )
        problem = "" if done.returncode == 0 else done.stderr.strip() or f"exit code {done.returncode}"
    except (OSError, subprocess.TimeoutExpired) as error:
        problem = str(error)
    if problem or not library.is_file():
        raise InputError(
            f"{command[0]} does not compile the library: {in_one_line(problem)}",
            source="fmu",
            expected=f"a C compiler for {sysconfig.get_platform()}, and sources that it takes",
        )
