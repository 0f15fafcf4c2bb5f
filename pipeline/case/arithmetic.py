"""Arithmetic of the named numbers of a case: counts such as ``"n + 1"``, texts such as ``"crank_{i-1}"``."""

from __future__ import annotations

import ast
import operator
import re
from collections.abc import Callable, Mapping
from difflib import get_close_matches

from heavylift.numerics.outcome import InputError

__all__ = ["Numbers", "filled", "value_of"]

Number = int | float
Numbers = Mapping[str, Number]
"""Values by name."""

PLACEHOLDER = re.compile(r"\{([^{}]*)\}")
LARGEST = 1e15
"""Results beyond this are refused; whole numbers below it are exact as floats."""

_BINARY: dict[type[ast.operator], Callable[[Number, Number], Number]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_UNARY: dict[type[ast.unaryop], Callable[[Number], Number]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}


def value_of(text: str, names: Numbers) -> Number:
    """Value of an arithmetic expression: numbers, names, ``+ - * / // %`` and parentheses.

    Parameters
    ----------
    text
        E.g. ``"2*n + 1"``.
    names
        What names stand for.

    Raises
    ------
    InputError
        If it is no such expression, a name is unknown, or the value is not finite. A whole value is an integer.
    """
    try:
        tree = ast.parse(text.strip(), mode="eval")
        value = _value(tree.body, names)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{text!r} is not arithmetic", expected=_expected(names)) from None
    except OverflowError:
        raise InputError(f"{text!r} is too large", expected=f"a number up to {LARGEST:g}") from None
    except ZeroDivisionError:
        raise InputError(f"{text!r} divides by zero", expected="a finite number") from None
    if not abs(value) <= LARGEST:
        raise InputError(f"{text!r} is too large", expected=f"a number up to {LARGEST:g}")
    return int(value) if value == int(value) else value


def _value(node: ast.expr, names: Numbers) -> Number:
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as value):
            return value
        case ast.Name(id=name):
            if name in names:
                return names[name]
            near = get_close_matches(name, names, 1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise InputError(f"{name!r} is not known{hint}", expected=_expected(names))
        case ast.UnaryOp(op=sign, operand=operand) if type(sign) in _UNARY:
            return _UNARY[type(sign)](_value(operand, names))
        case ast.BinOp(left=left, op=sign, right=right) if type(sign) in _BINARY:
            return _BINARY[type(sign)](_value(left, names), _value(right, names))
    raise ValueError(ast.dump(node))


def _expected(names: Numbers) -> str:
    known = ", ".join(names) or "none"
    return f"numbers, names ({known}), + - * / // % and parentheses"


def filled(text: str, names: Numbers) -> str | Number:
    """Text with every ``{expression}`` replaced by its value; the number itself if there is nothing else.

    Examples
    --------
    >>> filled("crank_{i-1}", {"i": 3})
    'crank_2'
    >>> filled("{0.5*i} m", {"i": 3})
    '1.5 m'
    >>> filled("{n}", {"n": 3})
    3

    Raises
    ------
    InputError
        As `value_of`.
    """
    whole = PLACEHOLDER.fullmatch(text.strip())
    if whole:
        return value_of(whole[1], names)
    return PLACEHOLDER.sub(lambda match: format(value_of(match[1], names), ".15g"), text)
