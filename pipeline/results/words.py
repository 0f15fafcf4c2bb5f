"""Numbers and functions of time as words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.results.signals import scaled_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["number_words", "numbers_words", "profile_words", "range_words"]

_SHOWN = 12  # numbers of a list at most


def number_words(value: float, unit: str) -> str:
    """A number with a prefix of its unit that suits it."""
    scaled = scaled_unit(unit, [np.array([value])])
    return f"{value / scaled.divisor:.6g} {scaled.text}".strip()


def numbers_words(values: Sequence[float], unit: str) -> str:
    """Components in brackets with one unit."""
    scaled = scaled_unit(unit, [np.array(values, dtype=float)])
    shown = ", ".join(f"{value / scaled.divisor + 0.0:.6g}" for value in values[:_SHOWN])
    more = f", … {len(values) - _SHOWN} more" if len(values) > _SHOWN else ""
    return f"({shown}{more}) {scaled.text}".strip()


def range_words(values: Sequence[float], unit: str) -> str:
    """Smallest and largest of some numbers with one unit."""
    scaled = scaled_unit(unit, [np.array(values, dtype=float)])
    return f"{min(values) / scaled.divisor:.6g} to {max(values) / scaled.divisor:.6g} {scaled.text}".strip()


def profile_words(profile: Any, unit: str) -> str:
    """A function of time: ranges of its table, and its harmonics."""
    parts = []
    if profile.times and profile.speeds:
        # speeds are of the unit of the value a second
        ranges = f"{range_words(profile.times, 's')}: {range_words(profile.speeds, f'{unit}/s')}"
        limits = [("acceleration", profile.acceleration, "s^2"), ("jerk", profile.jerk, "s^3")]
        phrases = [f", {name} {number_words(v, f'{unit}/{per}')}" for name, v, per in limits if v is not None]
        parts.append(f"{len(profile.times)} speeds, {ranges}{''.join(phrases)}")
    elif profile.times:
        ranges = f"{range_words(profile.times, 's')}: {range_words(profile.values, unit)}"
        parts.append(f"table of {len(profile.times)} points, {ranges}")
    parts += [
        f"{number_words(h.amplitude, unit)} sine at {number_words(h.frequency, 'Hz')}, phase {h.phase:.6g} rad"
        for h in profile.harmonics
    ]
    return " + ".join(parts)
