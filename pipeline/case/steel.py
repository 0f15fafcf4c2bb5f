"""Yield strength of structural steel by its grade and thickness."""

from __future__ import annotations

import csv
import math
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["STEEL_SOURCE", "steel_grades", "thickest", "yield_strengths"]

STEEL_SOURCE = "EN 10025-2:2004, table 7"
_FILE = Path(__file__).parent / "yield_strengths.csv"
_ROUND = 1e-6  # of a thickness: one of 16 mm that was computed is 16 mm


@cache
def _table() -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
    """Largest thicknesses of the columns [m], and strengths of the grades [Pa]; no number where there is none."""
    with _FILE.open(encoding="utf-8", newline="") as stream:
        head, *rows = csv.reader(line for line in stream if not line.startswith("#"))
    limits = 1e-3 * np.array([float(word) for word in head[1:]])
    return limits, {
        row[0]: 1e6 * np.array([float(word) if word else math.nan for word in row[1:]]) for row in rows
    }


def steel_grades() -> tuple[str, ...]:
    """Grades that are known."""
    return tuple(_table()[1])


def thickest(grade: str) -> float:
    """Largest thickness that a grade has a strength for [m]."""
    limits, rows = _table()
    return float(limits[np.isfinite(rows[grade])][-1])


def yield_strengths(grade: str, thickness: ArrayLike) -> NDArray[np.float64]:
    """Minimum yield strength [Pa] of plates of some thicknesses [m]; not a number beyond those of the grade."""
    limits, rows = _table()
    given = np.asarray(thickness, dtype=np.float64)
    column = np.searchsorted(limits * (1.0 + _ROUND), given)
    known = np.append(rows[grade], np.nan)[column]
    return np.where(np.isfinite(given), known, np.nan)
