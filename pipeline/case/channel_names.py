"""Names of channels that stand for more than one: patterns of owners, and combinations of channels.

=====================================  ====================================================================
``sling_*.tension``                    of every owner whose name fits: ``*`` any letters, ``?`` one, ``[1-3]``
                                       one of these, ``[!x]`` one that is not
``difference(a.tension, b.tension)``   the first channel less the second one
``ratio(a.tension, b.tension)``        the first by the second, a number; at records where the second is zero it
                                       has no value
``sum(a.tension, b.tension, ...)``     of two or more channels; of all that fit where a pattern stands in it
=====================================  ====================================================================

Terms are channels, components of channels (``hook.position.z``) or combinations. They have one unit, and components of
the same names: the combination has them too. A pattern outside of ``sum`` makes a combination for each owner that fits,
so ``ratio(sling_*.tension, sum(sling_*.tension))`` are the shares of all slings.
"""

from __future__ import annotations

from difflib import get_close_matches
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, NamedTuple

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, Kind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

__all__ = [
    "Combination",
    "combination_of",
    "combined_kind",
    "fitting",
    "is_pattern",
    "patterns_in",
    "split_name",
    "substituted",
]

FUNCTIONS = {
    "difference": "two channels",
    "ratio": "two channels",
    "sum": "two channels or more, or a pattern",
}
"""Functions of channels, and what they take."""
_NEAR = 3  # names of a message at most


class Combination(NamedTuple):
    """A function of channels.

    Attributes
    ----------
    function
        ``difference``, ``ratio`` or ``sum``.
    terms
        Names of channels, with a component or without, and combinations, as they are written.
    """

    function: str
    terms: tuple[str, ...]


def _split(text: str, at: str) -> list[str]:
    """Parts of a text between separators outside of parentheses and brackets."""
    if not any(letter in text for letter in "()[]"):
        return text.split(at)
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "([") - (letter in ")]")
        if letter == at and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return parts


def split_name(name: str) -> list[str]:
    """Parts of a name between its dots; a combination is one part."""
    return _split(name, ".")


def combination_of(name: str) -> Combination | None:
    """Take a combination apart; None of a name that is none.

    Raises
    ------
    InputError
        If its function is unknown, a parenthesis is missing, or it has another number of terms.
    """
    function, opened, inside = name.strip().partition("(")
    if not opened:
        return None
    function = function.strip()
    if function not in FUNCTIONS:
        near = get_close_matches(function, FUNCTIONS, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise InputError(f"{name!r}: {function!r} is no function of channels{hint}", expected=_forms())
    if not inside.endswith(")") or inside.count("(") + 1 != inside.count(")"):
        raise InputError(f"{name!r}: parentheses do not fit", expected=_forms())
    terms = tuple(term.strip() for term in _split(inside[:-1], ","))
    several = len(terms) >= 2 or is_pattern(terms[0])
    if "" in terms or not (several if function == "sum" else len(terms) == 2):
        count = 0 if terms == ("",) else len(terms)
        raise InputError(f"{name!r} has {count} terms", expected=f"{function} of {FUNCTIONS[function]}")
    return Combination(function, terms)


def _forms() -> str:
    return (
        "difference(A, B), ratio(A, B) or sum(A, B, ...) of channels, e.g. difference(a.tension, b.tension)"
    )


def combined_kind(name: str, function: str, kinds: Sequence[Kind]) -> Kind:
    """Kind of a combination from those of its terms.

    Raises
    ------
    InputError
        If their dimensions differ.
    """
    for kind in kinds[1:]:
        if kind.dimension != kinds[0].dimension:
            raise InputError(
                f"{name!r} combines {kinds[0].unit} with {kind.unit}", expected="channels of one unit"
            )
    return KINDS["number"] if function == "ratio" else kinds[0]


def is_pattern(text: str) -> bool:
    """Whether a name has letters that stand for others."""
    return any(letter in text for letter in "*?[")


def patterns_in(name: str) -> list[str]:
    """Patterns of owners in the name of a channel, each once; those in a sum are part of it."""
    combination = combination_of(split_name(name)[0])
    if combination is None:
        owner = split_name(name)[0]
        return [owner] if is_pattern(owner) else []
    if combination.function == "sum":
        return []
    return list(dict.fromkeys(pattern for term in combination.terms for pattern in patterns_in(term)))


def substituted(name: str, pattern: str, owner: str) -> str:
    """The name of a channel with an owner in place of a pattern, but for those in sums."""
    first, *rest = split_name(name)
    combination = combination_of(first)
    if combination is None:
        return ".".join([owner if first == pattern else first, *rest])
    if combination.function != "sum":
        terms = ", ".join(substituted(term, pattern, owner) for term in combination.terms)
        first = f"{combination.function}({terms})"
    return ".".join([first, *rest])


def fitting(
    text: str, pattern: str, owners: Iterable[str], check: Callable[[str], object]
) -> tuple[str, ...]:
    """Owners whose names fit a pattern and that `check` lets pass.

    Raises
    ------
    InputError
        If there are none: the nearest names, or what `check` says of the first one that fits.
    """
    owners = list(dict.fromkeys(owners))
    found, first = [], None
    for owner in (owner for owner in owners if fnmatchcase(owner, pattern)):
        try:
            check(owner)
        except InputError as error:
            first = first or error
        else:
            found.append(owner)
    if first is not None and not found:
        raise first
    if not found:
        plain = "".join(letter for letter in pattern if letter not in "*?[]!")
        near = get_close_matches(plain, owners, _NEAR, 0.5) or owners[:_NEAR]
        raise InputError(
            f"{text!r}: no name fits {pattern!r}",
            expected=f"a pattern of names; the nearest are: {', '.join(near) or 'none'}",
        )
    return tuple(found)
