"""Words that a key may have: one `Literal` each, which case files, objects and checks share."""

from __future__ import annotations

from difflib import SequenceMatcher, get_close_matches
from typing import TYPE_CHECKING, Any, get_args

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["check_word", "nearest"]

_ALIKE = 0.6
"""Of two words that may be one with a slip, as `difflib` measures it."""
_ONE_WORD = 0.9
"""The same of words that are not parted alike."""


def nearest(word: str, known: Iterable[str]) -> str:
    """The known word that somebody may have meant; ``""`` if none is near.

    A word with a part too many is meant without it (``linear_velocity``: ``velocity``). Words whose parts differ in
    more than a slip are others, however many letters they share (``linear_velocity``, ``angular_velocity``).
    """
    words, parts = list(known), word.split("_")
    near = get_close_matches(word, words, 5, _ALIKE)
    for one in near:
        others = one.split("_")
        pairs = zip(parts, others, strict=True) if len(others) == len(parts) else [(word, one)]
        least = _ALIKE if len(others) == len(parts) else _ONE_WORD
        if all(SequenceMatcher(None, a, b).ratio() >= least for a, b in pairs):
            return one
    inside = [one for one in words if set(one.split("_")) < set(parts)]
    return max(inside, key=len, default="")


def check_word(word: str, words: Any, *, source: object, key: str) -> None:
    """Refuse what is none of the words of a `Literal`.

    Raises
    ------
    InputError
        Names them all.
    """
    known = get_args(words)
    if word not in known:
        words_known = f"{', '.join(known[:-1])} or {known[-1]}"
        raise InputError(repr(word), source=str(source), key=key, expected=words_known)
