"""Begin a case: copy one of the commented cases that the package brings."""

from __future__ import annotations

import difflib
import tomllib
from importlib.resources import files
from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable
    from pathlib import Path

__all__ = ["new_case", "template_kinds"]

FILES = ("case.toml", "README.md")


def _templates() -> dict[str, Traversable]:
    """Folders of the cases to begin with, by kind."""
    folders = files("heavylift.pipeline.templates").iterdir()
    return {
        folder.name: folder
        for folder in sorted(folders, key=lambda f: f.name)
        if (folder / FILES[0]).is_file()
    }


def template_kinds() -> dict[str, str]:
    """Kinds of cases to begin with, and what each shows."""
    return {
        kind: tomllib.loads((folder / FILES[0]).read_text(encoding="utf-8"))["title"]
        for kind, folder in _templates().items()
    }


def new_case(kind: str, folder: Path) -> list[Path]:
    """Write the case of a kind into a folder that is new or empty; returns its files.

    Raises
    ------
    InputError
        If there is no such kind, or something is in the folder already.
    """
    templates = _templates()
    if kind not in templates:
        near = difflib.get_close_matches(kind, templates, n=1, cutoff=0.5)
        raise InputError(
            f"{kind!r}{f', perhaps {near[0]!r}' if near else ''}",
            source="new",
            key="kind",
            expected="one of " + ", ".join(templates),
        )
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(
            "is not empty" if folder.is_dir() else "is a file",
            source=folder,
            expected="a new or empty folder",
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in FILES:
            with replacing(folder / name) as temporary:
                temporary.write_bytes((templates[kind] / name).read_bytes())
    except OSError as error:
        raise InputError(
            str(error.strerror), source=folder, expected="a folder that can be written"
        ) from None
    return [folder / name for name in FILES]
