"""Straight parts of the ropes of a case, and what they carry as it is judged."""

from __future__ import annotations

import re
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["has_lines", "parts_to", "straight_parts", "tensions_of", "words_of_inner_ropes"]


def straight_parts(rope: Any) -> list[tuple[int, int]]:
    """Places of a path, from 0 on, between which a rope has its straight parts; of lines of one force the lines."""
    last = len(rope.path) - 1
    return [(k, k + 1) for k in range(0, last, 2 if has_lines(rope) else 1)]


def parts_to(case: Any, rope: str, body: str) -> list[tuple[int, int]]:
    """Straight parts of a rope that lead to a body from another one: their numbers, and 1 or -1 of those from it."""
    found = next(one for one in case.ropes if one.name == rope)
    ends = [(found.path[a].body == body, found.path[b].body == body) for a, b in straight_parts(found)]
    return [(k, 1 if last else -1) for k, (first, last) in enumerate(ends) if first != last]


def has_lines(rope: Any) -> bool:
    """Whether a rope of a case is lines of one force, whose own tension is that of the rope over their pulleys."""
    return bool(rope.DESCRIBED.WORD == "equalized")


def tensions_of(case: Any, names: Sequence[str], *, least: bool = False) -> dict[str, str]:
    """What ropes carry, as it is judged: what it is, and its channel.

    A rope carries the tension of that part which has the largest one, ``{"sling": "sling.tension"}``. Of lines of one
    force each line is judged, ``{"loader_rope line 2": "loader_rope.segment_tension.2"}``: their own tension is that of
    the rope over their pulleys. Of the `least` that is carried, parts of ropes over places with an efficiency are
    judged each, and the rope over the pulleys beside its lines.
    """
    ropes = {rope.name: rope for rope in case.ropes}
    found: dict[str, str] = {}
    for name in names:
        rope, word = ropes.get(name), ""
        if rope is not None and has_lines(rope):
            word = "line"
        elif rope is not None and least and any(stop.efficiency < 1.0 for stop in rope.path):
            word = "part"
        if not word or (least and word == "line"):
            found[name] = f"{name}.tension"
        if rope is not None and word:
            count = len(straight_parts(rope))
            found |= {f"{name} {word} {k}": f"{name}.segment_tension.{k}" for k in range(1, count + 1)}
    return found


def _ropes_over_pulleys(case: Any, text: str) -> list[str]:
    """Ropes of lines of one force whose own tension a channel, or a combination of channels, takes."""
    owners = re.findall(r"([^\s(),.]+)\.tension(?:_max|_min)?(?![\w])", text)
    return [
        rope.name
        for rope in case.ropes
        if has_lines(rope) and any(fnmatchcase(rope.name, one) for one in owners)
    ]


def words_of_inner_ropes(case: Any, text: str) -> str:
    """That a quantity is the tension of a rope over pulleys, not that of the lines below them; empty if it is not."""
    return "; ".join(
        f"the tension of {name!r} is that of the rope over its pulleys, its lines have {name}.segment_tension"
        for name in _ropes_over_pulleys(case, text)
    )
