"""Files that an input file names in turn and that are read with it: what a digest of it is made of, and where they lie.

* a deck includes files (`INCLUDE`, ``INPUT=``);
* an XDMF file leaves its numbers in HDF5 files;
* an HDF5 file, so also MED and netCDF-4, can lead to others by external links, raw files and virtual data sets.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as ET

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import DECK_SUFFIXES

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["mesh_files", "refuse_foreign_files"]

_INCLUDES = re.compile(
    r"""^\s*(?:\*\s*\w[\w ]*,.*?\bINPUT\s*=\s*"?([^",\r\n]+)|INCLUDE\s+['"]?([^'"\r\n]+))""",
    re.IGNORECASE | re.MULTILINE,
)
_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def mesh_files(path: Path, root: Path) -> list[Path]:
    """A mesh file and the files below `root` that it names: what a digest of it is made of."""
    found = [path]
    suffix = path.suffix.lower()
    top = root.resolve()
    if suffix == ".xdmf":
        for name in sorted(set(_data_files(path))):
            target = (path.resolve().parent / name).resolve()
            if target.is_relative_to(top) and target.is_file() and target not in found:
                found.append(target)
    if suffix not in DECK_SUFFIXES:
        return found
    for file in found:  # grows as it goes
        text = file.read_bytes().decode("utf-8", errors="replace")
        for names in _INCLUDES.findall(text):
            target = (path.parent / next(filter(None, names)).strip()).resolve()
            if target.is_relative_to(top) and target.is_file() and target not in found:
                found.append(target)
    return found


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
    """See that an HDF5 file holds all its data itself; other files are passed over."""
    if not _is_hdf5(path):
        return
    import h5py

    def look(group: Any, place: str, seen: set[Any]) -> None:
        for name in group:
            link = group.get(name, getlink=True)
            here = f"{place}/{name}"
            if isinstance(link, h5py.ExternalLink):
                _refuse(path, here, f"links to {link.filename!r}")
            if not isinstance(link, h5py.HardLink):
                continue
            item = group[name]
            if isinstance(item, h5py.Group):
                if item.id not in seen:  # groups can hold each other
                    seen.add(item.id)
                    look(item, here, seen)
            elif isinstance(item, h5py.Dataset):
                if item.external:
                    _refuse(path, here, f"has its data in {item.external[0][0]!r}")
                outside = (
                    [s.file_name for s in item.virtual_sources() if s.file_name != "."]
                    if item.is_virtual
                    else []
                )
                if outside:
                    _refuse(path, here, f"has its data in {outside[0]!r}")

    try:
        with h5py.File(path, "r") as file:
            look(file, "", {file.id})
    except InputError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, RecursionError):
        return  # a damaged file, of which its reader says so


def _refuse(path: Path, place: str, problem: str) -> None:
    raise InputError(problem, source=path, key=place, expected="an HDF5 file that holds all its data itself")


def _is_hdf5(path: Path) -> bool:
    """Whether the signature of HDF5 stands at one of the places where it may."""
    size, place = path.stat().st_size, 0
    with path.open("rb") as stream:
        while place + len(_SIGNATURE) <= size:
            stream.seek(place)
            if stream.read(len(_SIGNATURE)) == _SIGNATURE:
                return True
            place = max(512, 2 * place)
    return False
