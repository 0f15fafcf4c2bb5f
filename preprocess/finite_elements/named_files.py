"""Files that an input file names in turn and that are read with it: what a digest of it is made of, and where they lie.

* a deck includes files (`INCLUDE`, ``INPUT=``);
* an XDMF file leaves its numbers in HDF5 files;
* an HDF5 file, so also MED and netCDF-4, can lead to others by external links, raw files and virtual data sets.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from heavylift.numerics.hdf5_files import HOLDS_ALL, is_hdf5, outside_of_hdf5
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import DECK_SUFFIXES

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["mesh_files", "refuse_foreign_files"]

_INCLUDES = re.compile(
    r"""\bINPUT[ \t]*=[ \t]*"?([^",\r\n]+)|^[ \t]*INCLUDE[ \t]+['"]?([^'"\r\n]+)""",
    re.IGNORECASE | re.MULTILINE,
)
_KEYWORD = re.compile(r"[ \t]*\*([\w \t]*)")


def mesh_files(path: Path, root: Path) -> list[Path]:
    """A mesh file and the files below `root` that it names: what a digest of it is made of."""
    found = {path: None}
    suffix = path.suffix.lower()
    top = root.resolve()
    if suffix == ".xdmf":
        for name in sorted(set(_data_files(path))):
            target = (path.resolve().parent / name).resolve()
            if target.is_relative_to(top) and target.is_file():
                found[target] = None
    if suffix not in DECK_SUFFIXES:
        return list(found)
    waiting = [path]
    while waiting:
        for name in dict.fromkeys(_included_names(waiting.pop())):
            target = (path.parent / name).resolve()
            if target.is_relative_to(top) and target.is_file() and target not in found:
                found[target] = None
                waiting.append(target)
    return list(found)


def _included_names(file: Path) -> Iterator[str]:
    """Names of files that a deck takes as its own text; one too many does no harm."""
    data = file.read_bytes()
    if data.isascii():
        capitals = data.upper()
        if b"INPUT" not in capitals and b"INCLUDE" not in capitals:
            return  # as most decks, and it may be large
    # most files that are looked at are no decks, and the module of decks takes its time
    from heavylift.preprocess.finite_elements.abaqus_deck import INPUT_IS_DATA

    text = data.decode("utf-8", errors="replace")
    for match in _INCLUDES.finditer(text):
        keyword = _KEYWORD.match(text, text.rfind("\n", 0, match.start()) + 1) if match[1] else None
        if keyword is None or "".join(keyword[1].split()).upper() in {"INCLUDE", *INPUT_IS_DATA}:
            yield (match[1] or match[2]).strip()


def refuse_foreign_files(path: Path, root: Path) -> None:
    """See that what an XDMF or HDF5 file names is a file below `root`; decks are looked at by their readers.

    Parameters
    ----------
    path
        A file below `root`.
    root
        Folder that is not left, also not through links.

    Raises
    ------
    InputError
        A file that is not below `root` or no file; data that an XDMF file leaves in raw files, which are looked for
        where the program was started; an HDF5 file that leads to any other file.
    """
    if path.suffix.lower() == ".xdmf":
        for name in sorted(set(_data_files(path))):
            target = (path.resolve().parent / name).resolve()
            if not target.is_relative_to(root.resolve()):
                raise InputError(
                    f"names {name!r}, which leaves the case folder",
                    source=path,
                    expected="HDF5 files inside the case folder",
                )
            if not target.is_file():
                raise InputError(
                    f"names {name!r}, which is no file",
                    source=path,
                    expected="HDF5 files inside the case folder",
                )
            _refuse_links(target)
    _refuse_links(path)


def _data_files(path: Path) -> Iterator[str]:
    """Names of the HDF5 files of an XDMF file; one that is no XML has none, and its reader says so."""
    try:
        tree = ET.parse(path)  # noqa: S314  (entities are bounded by expat, external ones not followed)
    except (ET.ParseError, OSError, ValueError):
        return
    for item in tree.iter():
        if item.tag.rpartition("}")[2] != "DataItem":
            continue
        form, text = item.get("Format", "").lower(), (item.text or "").strip()
        if form == "hdf":
            yield text.partition(":")[0]
        elif form == "binary":
            raise InputError(
                f"leaves its data in the raw file {text!r}",
                source=path,
                expected="data in the file itself or in HDF5 files",
            )


def _refuse_links(path: Path) -> None:
    """See that an HDF5 file holds all its data itself; other files, and damaged ones, are left to their readers."""
    leads = outside_of_hdf5(path) if is_hdf5(path) else None
    if leads is not None:
        raise InputError(leads[1], source=path, key=leads[0], expected=HOLDS_ALL)
