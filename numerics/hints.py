"""What an annotation says, whichever way the version of Python or NumPy at hand writes it."""

from __future__ import annotations

from typing import Any, get_args, get_origin

__all__ = ["array_scalar", "unaliased"]


def unaliased(hint: Any) -> Any:
    """An annotation without the names that stand for it.

    From Python 3.12 on a type may have a name of its own (`typing.TypeAliasType`), which is neither the class nor the
    union that it stands for; ``numpy.typing.NDArray`` is one from NumPy 2.5 on. What is given in brackets takes the
    place of the parameters. Types within the brackets of other types keep their names.
    """
    while True:
        origin = get_origin(hint)
        alias = hint if origin is None else origin
        if isinstance(alias, type) or not hasattr(alias, "__value__"):
            return hint
        value, given = alias.__value__, get_args(hint)
        known = dict(zip(alias.__type_params__, given, strict=False))
        free = getattr(value, "__parameters__", ())
        hint = value[tuple(known.get(one, one) for one in free)] if free and known else value


def array_scalar(hint: Any) -> Any:
    """Type of the numbers of an array annotation, ``NDArray[scalar]``."""
    return get_args(get_args(unaliased(hint))[1])[0]
