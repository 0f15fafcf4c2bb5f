"""The folder in which a command is called may hold a case from someone else: nothing in it runs.

The command itself begins with the folder of its script in place of the current one. What is left are processes that
it, or a library, starts, and libraries that read a file of settings from the current folder while they load: in that of
Matplotlib before 3.10 stands code, in that of Numba a folder of compiled code.
"""

from __future__ import annotations

import contextlib
import os
import sys
from importlib.machinery import PathFinder
from typing import TYPE_CHECKING, Any

from heavylift.numerics.children import NEUTRAL_FOLDER

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from importlib.machinery import ModuleSpec

__all__ = ["distrust_current_folder"]

READ_SETTINGS = frozenset({"matplotlib", "numba"})
"""Libraries that read settings from the current folder while they load."""


def distrust_current_folder() -> None:
    """Let nothing that this process imports, and no Python that it starts, take code from the current folder."""
    os.environ["PYTHONSAFEPATH"] = "1"  # what libraries start; our own children get it from `python_command`
    sys.path[:] = [path for path in sys.path if path]
    if not any(isinstance(finder, _LoadedElsewhere) for finder in sys.meta_path):
        sys.meta_path.insert(0, _LoadedElsewhere())


class _LoadedElsewhere:
    """Loads libraries that read settings in a folder where there are none."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: Any = None
    ) -> ModuleSpec | None:
        """The module as it would be found otherwise, if it is one of them."""
        if name not in READ_SETTINGS:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def load_elsewhere(module: Any) -> None:
                with _neutral_folder():
                    load(module)
                if name == "numba":  # which looks for them again whenever it compiles
                    module.config._config_fname = os.devnull  # noqa: SLF001

            spec.loader.exec_module = load_elsewhere  # type: ignore[method-assign]
        return spec


@contextlib.contextmanager
def _neutral_folder() -> Iterator[None]:
    """Stand in another folder for a while; a current folder that is gone holds no settings.

    One that does not let itself be listed may hold files that can be read all the same.
    """
    try:
        here = os.open(".", getattr(os, "O_PATH", os.O_RDONLY) | getattr(os, "O_CLOEXEC", 0))
    except OSError:
        yield
        return
    try:
        os.chdir(NEUTRAL_FOLDER)
        yield
    finally:
        os.fchdir(here)
        os.close(here)
