"""Pages of the keys of a case file, written into a folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.schema import key_pages
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["write_pages"]


def write_pages(folder: Path) -> None:
    """Write a page for each table of a case and an index, ``README.md``; each is replaced in one step.

    Raises
    ------
    InputError
        If the folder cannot be made or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in key_pages().items():
            with replacing(folder / name) as temporary:
                temporary.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(
            str(error), source="schema", key="--out", expected="a folder to write into"
        ) from None
