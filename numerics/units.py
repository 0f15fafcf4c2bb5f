"""Quantities: numbers in SI, or strings with a unit such as ``"95 mm"``.

Common units are read from a small table, because importing pint costs as much time as
the rest of a command on an unchanged case; pint is asked only for names that the table
does not have. An angle counts as a dimension of its own, so that ``"50 Hz"`` is not
mistaken for ``"50 rad/s"``.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Any, NamedTuple

from heavylift.numerics.outcome import InputError

__all__ = [
    "KINDS",
    "Dimension",
    "Kind",
    "describe_dimension",
    "parse_quantity",
    "parse_unit",
    "with_article",
]


class Dimension(NamedTuple):
    """Exponents of metre, kilogram, second and radian."""

    length: float = 0.0
    mass: float = 0.0
    time: float = 0.0
    angle: float = 0.0

    def times(self, other: Dimension, power: float = 1.0) -> Dimension:
        """Dimension of a product ``self * other**power``."""
        return Dimension(*(a + power * b for a, b in zip(self, other, strict=True)))


class Kind(NamedTuple):
    """What a field of a case holds: a name for messages, the SI unit, the dimension."""

    name: str
    unit: str
    dimension: Dimension


KINDS = {
    kind.name: kind
    for kind in (
        Kind("number", "1", Dimension()),
        Kind("length", "m", Dimension(1)),
        Kind("volume", "m^3", Dimension(3)),
        Kind("mass", "kg", Dimension(0, 1)),
        Kind("time", "s", Dimension(0, 0, 1)),
        Kind("angle", "rad", Dimension(0, 0, 0, 1)),
        Kind("frequency", "Hz", Dimension(0, 0, -1)),
        Kind("velocity", "m/s", Dimension(1, 0, -1)),
        Kind("acceleration", "m/s^2", Dimension(1, 0, -2)),
        Kind("jerk", "m/s^3", Dimension(1, 0, -3)),
        Kind("angular velocity", "rad/s", Dimension(0, 0, -1, 1)),
        Kind("angular acceleration", "rad/s^2", Dimension(0, 0, -2, 1)),
        Kind("angular jerk", "rad/s^3", Dimension(0, 0, -3, 1)),
        Kind("density", "kg/m^3", Dimension(-3, 1)),
        Kind("mass per area", "kg/m^2", Dimension(-2, 1)),
        Kind("mass per length", "kg/m", Dimension(-1, 1)),
        Kind("pressure", "Pa", Dimension(-1, 1, -2)),
        Kind("force", "N", Dimension(1, 1, -2)),
        Kind("moment or energy", "N m", Dimension(2, 1, -2)),
        Kind("stiffness", "N/m", Dimension(0, 1, -2)),
        Kind("angular stiffness", "N m/rad", Dimension(2, 1, -2, -1)),
        Kind("damping", "N s/m", Dimension(0, 1, -1)),
        Kind("angular damping", "N m s/rad", Dimension(2, 1, -1, -1)),
        Kind("compliance", "m/N", Dimension(0, -1, 2)),
        Kind("angular compliance", "rad/(N m)", Dimension(-2, -1, 2, 1)),
        Kind("momentum", "kg m/s", Dimension(1, 1, -1)),
        Kind("angular momentum", "kg m^2/s", Dimension(2, 1, -1)),
        Kind("moment of inertia", "kg m^2", Dimension(2, 1)),
        Kind("modal coordinate", "m kg^0.5", Dimension(1, 0.5)),
        Kind("modal velocity", "m kg^0.5/s", Dimension(1, 0.5, -1)),
        Kind("area", "m^2", Dimension(2)),
        Kind("second moment of area", "m^4", Dimension(4)),
        Kind("rate", "1/s", Dimension(0, 0, -1)),
        Kind("force per length", "N/m", Dimension(0, 1, -2)),
        Kind("moment per length", "N m/m", Dimension(1, 1, -2)),
        Kind("slope per length", "1/m", Dimension(-1)),
    )
}
"""The kinds of quantity that cases and results use, by name."""

_PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}

_PREFIXED = {
    "m": (1.0, Dimension(1)),
    "g": (1e-3, Dimension(0, 1)),
    "s": (1.0, Dimension(0, 0, 1)),
    "N": (1.0, Dimension(1, 1, -2)),
    "Pa": (1.0, Dimension(-1, 1, -2)),
    "J": (1.0, Dimension(2, 1, -2)),
    "W": (1.0, Dimension(2, 1, -3)),
    "Hz": (1.0, Dimension(0, 0, -1)),
    "rad": (1.0, Dimension(0, 0, 0, 1)),
}

_MOMENTS = {"m": -3, "": 0, "k": 3, "M": 6, "G": 9}

_PLAIN = {
    "1": (1.0, Dimension()),
    "%": (1e-2, Dimension()),
    "percent": (1e-2, Dimension()),
    **dict.fromkeys(("t", "te", "ton", "tons", "tonne", "tonnes"), (1e3, Dimension(0, 1))),
    **dict.fromkeys(("tf", "tonf", "ton_force", "tonne_force"), (9806.65, Dimension(1, 1, -2))),
    **{f"{prefix}Nm": (10.0**power, Dimension(2, 1, -2)) for prefix, power in _MOMENTS.items()},
    "min": (60.0, Dimension(0, 0, 1)),
    "h": (3600.0, Dimension(0, 0, 1)),
    "bar": (1e5, Dimension(-1, 1, -2)),
    "deg": (math.pi / 180.0, Dimension(0, 0, 0, 1)),
    "degree": (math.pi / 180.0, Dimension(0, 0, 0, 1)),
    "rpm": (2.0 * math.pi / 60.0, Dimension(0, 0, -1, 1)),
    "knot": (1852.0 / 3600.0, Dimension(1, 0, -1)),
    "in": (0.0254, Dimension(1)),
    "inch": (0.0254, Dimension(1)),
    "ft": (0.3048, Dimension(1)),
    # of international feet; in pint before 0.26 of feet of the American survey, 2 millionths longer
    **dict.fromkeys(("fathom", "fathoms"), (6 * 0.3048, Dimension(1))),
    **dict.fromkeys(("chain", "chains"), (66 * 0.3048, Dimension(1))),
    **dict.fromkeys(("furlong", "furlongs"), (660 * 0.3048, Dimension(1))),
}

UNITS: dict[str, tuple[float, Dimension]] = _PLAIN | {
    prefix + name: (1.0 if prefix + name == "kg" else scale * factor, dimension)
    for name, (factor, dimension) in _PREFIXED.items()
    for prefix, scale in _PREFIXES.items()
}
"""Factor to SI and dimension of the units known without pint."""

_OF_COUNTRIES = {
    "ton": "ton or tonne (1000 kg), short_ton (2000 lb) or long_ton (2240 lb)",
    "metric_ton": "t",
    "force_ton": "ton_force (1000 kgf), or kip",
    "hundredweight": "short_hundredweight (100 lb) or long_hundredweight (112 lb)",
    "mile": "nautical_mile, or km",
    "gallon": "imperial_gallon, litre, or m^3",
    "quart": "imperial_quart, litre, or m^3",
    "pint": "imperial_pint, litre, or m^3",
    "fluid_ounce": "imperial_fluid_ounce, or m^3",
    "barrel": "oil_barrel, or m^3",
}
"""Units, by their names in pint, that differ between countries or trades, or read as something else with a prefix
(mt would be a kilogram): what to write in their place."""

LONGEST = 200
"""Characters of a quantity or unit; no sensible one has more."""

STEEPEST = 20.0
"""Largest exponent of a unit."""

LARGEST_LENGTH = 1e100
"""Of lengths and coordinates [m]: volumes of larger ones are beyond what a double holds."""

_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*\Z")
_TOKEN = re.compile(r"\s*(\*\*|[*/·^()]|[+-]?\d+\.?\d*|[^\W\d]\w*|%)")


def parse_quantity(value: object, kind: Kind) -> float:
    """SI value of a number or of a string with a unit.

    Parameters
    ----------
    value
        A number, taken in SI, or a string such as ``"7987 kg/m^3"``.
    kind
        What is expected; the unit must have its dimension.

    Raises
    ------
    InputError
        If the value is not a finite number, has an unknown unit or another dimension, or is a length beyond
        `LARGEST_LENGTH`.
    """
    expected = f"{with_article(kind.name)} [{kind.unit}]" if kind.name != "number" else "a number"
    if isinstance(value, str):
        number, unit = _split(value, expected)
        if not unit:
            if kind.dimension != Dimension():
                raise InputError(f"{value!r} has no unit", expected=f'{expected}, e.g. "{value} {kind.unit}"')
            unit = "1"
        factor, dimension = parse_unit(unit)
        if dimension != kind.dimension:
            raise InputError(f"{value!r} is {describe_dimension(dimension)}", expected=expected)
        number = _scaled(value, number, factor)
    elif isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"{value!r} is not a number", expected=expected)
    else:
        try:
            number = float(value)
        except OverflowError:  # an integer of some hundred digits
            number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{value!r} is not finite", expected=expected)
    if kind.dimension == KINDS["length"].dimension and abs(number) > LARGEST_LENGTH:
        raise InputError(f"{value!r} is too large", expected=f"{expected} up to {LARGEST_LENGTH:g} m")
    return number


def _scaled(text: str, number: float, factor: float) -> float:
    """``number * factor``, rounded once where the factor is 1 / integer: "0.2 us" is the double 2e-7."""
    inverse = round(1.0 / factor) if 0.0 < factor < 1.0 else 0
    if inverse == 0 or 1.0 / inverse != factor or not math.isfinite(number):
        return number * factor
    from fractions import Fraction

    return float(Fraction(_NUMBER.match(text)[1]) / inverse)  # type: ignore[index]


def _split(text: str, expected: str) -> tuple[float, str]:
    """Number and unit of a quantity string."""
    if len(text) > LONGEST:
        raise InputError(f"{text!r} has {len(text):,} characters", expected=expected)
    match = _NUMBER.match(text)
    if match is None:
        kind = (
            "is not finite"
            if text.strip().lower().split(" ")[0] in {"nan", "inf", "-inf"}
            else "is not a number"
        )
        raise InputError(f"{text!r} {kind}", expected=expected)
    return float(match[1]), match[2]


@cache
def parse_unit(text: str) -> tuple[float, Dimension]:
    """Factor to SI and dimension of a unit expression such as ``"kg/m^3"`` or ``"m kg^0.5/s"``.

    Products are written with a blank, ``*`` or ``·``; products and quotients are read from left to right.

    Raises
    ------
    InputError
        If a name is no unit, the expression is not well formed, or no number is left of its factor.
    """
    if len(text) > LONGEST:
        raise InputError(f"unit {text!r} has {len(text):,} characters", expected='a unit such as "kg/m^3"')
    tokens, position = [], 0
    while position < len(text.rstrip()):
        match = _TOKEN.match(text, position)
        if match is None:
            raise InputError(f"unit {text!r} is not understood", expected='a unit such as "kg/m^3"')
        tokens.append(match[1])
        position = match.end()
    try:
        result, rest = _product(tokens, text)
    except (OverflowError, ZeroDivisionError):  # "GPa^20 GPa^20", "1/nm^20/nm^20"
        result, rest = (math.inf, Dimension()), []
    if rest:
        raise InputError(f"unit {text!r} is not understood", expected="balanced parentheses")
    if not 0.0 < result[0] < math.inf:
        raise InputError(f"unit {text!r} is beyond all numbers", expected='a unit such as "kg/m^3"')
    return result


def _product(tokens: list[str], text: str) -> tuple[tuple[float, Dimension], list[str]]:
    """Read ``factor ((*|/|blank) factor)*`` and give what is left."""
    (factor, dimension), tokens = _power(tokens, text)
    while tokens and tokens[0] != ")":
        sign = -1.0 if tokens[0] == "/" else 1.0
        if tokens[0] in {"*", "/", "·"}:
            tokens = tokens[1:]
        (scale, other), tokens = _power(tokens, text)
        factor = factor * scale if sign > 0 else factor / scale
        dimension = dimension.times(other, sign)
    return (factor, dimension), tokens


def _power(tokens: list[str], text: str) -> tuple[tuple[float, Dimension], list[str]]:
    """Read ``name``, ``(product)`` or one of these with an exponent."""
    if not tokens:
        raise InputError(f"unit {text!r} ends too early", expected='a unit such as "kg/m^3"')
    if tokens[0] == "(":
        (factor, dimension), tokens = _product(tokens[1:], text)
        if not tokens:
            raise InputError(f"unit {text!r} is not understood", expected="balanced parentheses")
        tokens = tokens[1:]
    else:
        (factor, dimension), tokens = _named_unit(tokens[0], text), tokens[1:]
    if len(tokens) >= 2 and tokens[0] in {"^", "**"}:
        try:
            power = float(tokens[1])
        except ValueError:
            raise InputError(f"unit {text!r} is not understood", expected="a number as exponent") from None
        if not abs(power) <= STEEPEST:
            raise InputError(
                f"unit {text!r} has the exponent {tokens[1]}",
                expected=f"exponents from {-STEEPEST:g} to {STEEPEST:g}",
            )
        factor, dimension, tokens = factor**power, Dimension().times(dimension, power), tokens[2:]
    return (factor, dimension), tokens


def _named_unit(name: str, text: str) -> tuple[float, Dimension]:
    """Look a unit up in the table, and in pint if it is not there."""
    if name in UNITS:
        return UNITS[name]
    if not name[0].isalpha():
        raise InputError(f"unit {text!r} is not understood", expected='a unit such as "kg/m^3"')
    import pint

    try:
        base = _registry().Quantity(1.0, name).to_base_units()
    except (pint.errors.PintError, AttributeError, TypeError, ValueError):
        whole = "" if name == text else f" in {text!r}"
        raise InputError(f"{name!r}{whole} is not a unit", expected='a unit such as "kg/m^3"') from None
    # without prefix, if it can be read so; words of no dimension have no name
    prefix, unit, _ = min(_registry().parse_unit_name(name), default=("", "", ""))
    if unit in _OF_COUNTRIES and (unit != "metric_ton" or prefix) and not name.startswith(("short_", "US_")):
        raise InputError(f"{name!r} may mean several units", expected=_OF_COUNTRIES[unit])
    names = {"meter": 0, "kilogram": 1, "second": 2, "radian": 3}
    exponents = [0.0, 0.0, 0.0, 0.0]
    for unit, power in base.unit_items():
        if unit not in names:
            raise InputError(
                f"{name!r} is measured in {unit}", expected="a unit of length, mass, time and angle"
            )
        exponents[names[unit]] = float(power)
    if _registry().Quantity(0.0, name).to_base_units().magnitude != 0.0:
        raise InputError(f"{name!r} is logarithmic", expected="a unit of which a quantity is a multiple")
    return float(base.magnitude), Dimension(*exponents)


@cache
def _registry() -> Any:
    """The pint registry, made when a unit outside the table occurs."""
    import pint

    return pint.UnitRegistry()


def describe_dimension(dimension: Dimension) -> str:
    """Words for a dimension: ``"a time"``, or its SI unit if it has no name."""
    for kind in KINDS.values():
        if kind.dimension == dimension:
            return with_article(kind.name)
    symbols = ("m", "kg", "s", "rad")
    unit = " ".join(f"{s}^{p:g}" if p != 1 else s for s, p in zip(symbols, dimension, strict=True) if p)
    return f"a quantity in {unit}"


def with_article(noun: str) -> str:
    """The noun with its indefinite article."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
