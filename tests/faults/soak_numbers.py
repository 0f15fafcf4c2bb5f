"""Numbers at the ends of what a machine holds, in every numeric key of the case files of this project, to the loader.

In the place of each number of a case stands in turn the smallest and a small denormal one, a negative zero, one whose
square and one whose inverse is not finite, the largest one, and what is no number; with a unit where the number had
one. Ways to end are counted as in `soak_mutants`: a number may be right, or be refused in one line with its place.
"""

from __future__ import annotations

import copy
import random
import re
import tempfile
import tomllib
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from soak_mutants import _lines, _loaded, _mutated_folder, _places, sources

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["VALUES", "numbers_of", "run"]

VALUES = ("5e-324", "1e-310", "-0.0", "1e-200", "1e-300", "1e200", "1e300", "1.7e308", "nan", "inf", "-inf")
_NUMBER = re.compile(r"\s*[+-]?\d[\d._]*(?:[eE][+-]?\d+)?(\s+\S.*)?$")


def numbers_of(document: Any) -> list[tuple[Any, Any]]:
    """Containers and keys of all numbers of a document."""
    return [
        (holder, key)
        for holder, key in _places(document)
        if (isinstance(holder[key], (int, float)) and not isinstance(holder[key], bool))
        or (isinstance(holder[key], str) and _NUMBER.match(holder[key]))
    ]


def run(count: int, seed: int, tell: Callable[[str], object] = print) -> Counter[str]:
    """Give the loader cases with one extreme number each; see the top of the file."""
    counts: Counter[str] = Counter()
    known = sources()
    documents = {source: tomllib.loads((source / "case.toml").read_text("utf-8")) for source in known}
    with tempfile.TemporaryDirectory() as top:
        for number in range(count):
            rng = random.Random(f"{seed} numbers {number}")  # noqa: S311
            source = rng.choice(known)
            document = copy.deepcopy(documents[source])
            found = numbers_of(document)
            holder, key = rng.choice(found)
            before, value = holder[key], rng.choice(VALUES)
            unit = (_NUMBER.match(before)[1] or "") if isinstance(before, str) else ""
            holder[key] = f"{value}{unit}" if isinstance(before, str) else float(value)
            text = "\n".join(_lines(document)) + "\n"
            how, words = _loaded(_mutated_folder(Path(top), source, text))
            counts[how] += 1
            if how in {"failures", "slow"}:
                told = f"{before!r} of {key!r} becomes {holder[key]!r}"
                tell(f"numbers {how}: {number} of seed {seed}, {source.name}: {told}: {words[-700:]}")
    return counts
