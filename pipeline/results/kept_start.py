"""The equilibrium that a simulation started from, kept for the next one of the same scene."""

from __future__ import annotations

import json
import zipfile
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.processors import processor_type
from heavylift.pipeline.results.provenance import source_digest, versions
from heavylift.pipeline.results.storage import digest_bytes, digest_json, replacing
from heavylift.solver.start.kept import FoundStart

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["KeptStart"]

FORMAT = "heavylift start 2"
PREFIX = "array."


class KeptStart:
    """A file with the last equilibrium that was found in an output folder.

    Parameters
    ----------
    file
        Replaced in one step.
    """

    def __init__(self, file: Path) -> None:
        self.file = file

    def read(self, digest: str) -> FoundStart | None:
        """What was found by the same program for the scene with this digest; None if it is another, or damaged."""
        try:
            with self.file.open("rb") as stream, np.load(stream, allow_pickle=False) as content:
                header = json.loads(str(content["header"]))
                if header["key"] != _key(digest):
                    return None
                arrays = {
                    name.removeprefix(PREFIX): content[name] for name in content.files if name != "header"
                }
            if header["checksum"] != _checksum(arrays) or any(a.dtype != np.uint8 for a in arrays.values()):
                return None
            return FoundStart(tuple(map(str, header["texts"])), float(header["residual"]), arrays)
        except (OSError, ValueError, KeyError, TypeError, EOFError, RuntimeError, zipfile.BadZipFile):
            return None

    def write(self, digest: str, found: FoundStart) -> None:
        """Keep a result in place of the one before."""
        header = {
            "key": _key(digest),
            "texts": found.texts,
            "residual": found.residual,
            "checksum": _checksum(found.arrays),
        }
        arrays = {f"{PREFIX}{name}": array for name, array in found.arrays.items()}
        with replacing(self.file) as temporary, temporary.open("wb") as stream:
            np.savez(stream, header=np.array(json.dumps(header)), **arrays)  # type: ignore[arg-type]


def _key(digest: str) -> str:
    """Digest of a scene with all of the program that a search runs, and what it runs on."""
    return digest_json([FORMAT, digest, source_digest("start"), versions("start"), processor_type()])


def _checksum(arrays: Mapping[str, NDArray[np.uint8]]) -> str:
    parts = [part for name in sorted(arrays) for part in (name.encode(), arrays[name].data)]
    return digest_bytes(*parts)
