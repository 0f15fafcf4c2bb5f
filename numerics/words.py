"""Words that a key may have: one `Literal` each, which case files, objects and checks share."""

from __future__ import annotations

from typing import Any, get_args

from heavylift.numerics.outcome import InputError

__all__ = ["check_word"]


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
