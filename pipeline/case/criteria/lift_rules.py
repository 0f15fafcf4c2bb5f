"""Closed forms of criteria of lifts, and the clauses that they come from with what is known of each clause.

The clauses are those of ``lift_clauses.csv``, the dynamic amplification factors those of ``daf_in_air.csv``: 0027/ND,
Guidelines for marine lifting and lowering operations, Rev 11.2 (2016), which DNV-ST-N001 has replaced. They were read
in public copies (status ``seen``), or are known values whose clause nobody has read (``memory``): before a report is
handed on they are to be confirmed in the standard that applies.
"""

from __future__ import annotations

import csv
import math
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "CLEARANCES",
    "LEAD",
    "OF_THE_CASE",
    "Clause",
    "bending_factor",
    "capacity_at",
    "clause",
    "sling_factor",
    "table_factor",
]

_FOLDER = Path(__file__).parent
_TON = 1000.0
CLEARANCES = {  # m
    "to_boom": (3.0, "clearance load to boom"),
    "under_load": (3.0, "clearance under load"),
    "near_final_place": (1.5, "clearance under load"),
    "on_barge": (5.0, "clearance on the barge"),
    "sideways": (3.0, "clearance horizontal"),
}
"""Least distances [m] by what they are of, and the names of their clauses."""
LEAD = math.radians(3.0)
"""Largest off-lead and side-lead where the crane's curve gives none [rad]: a choice, no clause."""


class Clause(NamedTuple):
    """Where a limit or a factor comes from, and what is known of it.

    Attributes
    ----------
    source
        Document and clause, or words of the case file.
    status
        ``"seen"``: read in a public copy; ``"seen in ..."``: read elsewhere; ``"memory"``: known value, clause not
        read; ``"assumption"``; ``"case file"``.
    """

    source: str
    status: str

    @property
    def text(self) -> str:
        """Source, marked unless a copy of the document or the case file says it."""
        if self.status in {"case file", self.source}:
            return self.source
        words = {"seen": "public copy", "memory": "NOT CONFIRMED: from memory", "assumption": "assumption"}
        return f"{self.source} [{words.get(self.status, f'NOT CONFIRMED: {self.status}')}]"


OF_THE_CASE = Clause("limit of the case file", "case file")
"""Of limits that the case file gives without a source."""


def _lines(name: str) -> list[str]:
    text = (_FOLDER / name).read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line and not line.startswith("#")]


@cache
def _clauses() -> dict[str, Clause]:
    rows = csv.DictReader(_lines("lift_clauses.csv"))
    return {row["quantity"]: Clause(row["source"], row["status"]) for row in rows}


def clause(quantity: str) -> Clause:
    """Clause by the name of its quantity in ``lift_clauses.csv``."""
    return _clauses()[quantity]


@cache
def _table() -> tuple[tuple[float, float, dict[str, float]], ...]:
    """Rows of the table of factors: above and up to which weight [t], and the factors."""
    found = []
    for row in csv.DictReader(_lines("daf_in_air.csv")):
        words = row.pop("W_t").replace("<=", "<").split("<")
        low, high = (words[0], words[-1]) if len(words) == 3 else (words[0].partition(">")[2], "inf")
        found.append((float(low), float(high), {key: float(value) for key, value in row.items()}))
    return tuple(found)


def table_factor(weight: float, operation: str, static_load: float | None = None) -> float:
    """Dynamic amplification factor in air of a lift by one crane, 0027/ND Table 5-1.

    Parameters
    ----------
    weight
        Gross weight [kg].
    operation
        ``"onshore"``, ``"inshore"`` or ``"offshore"``.
    static_load
        Static hook load SHL [kg]; the gross weight if absent.

    Raises
    ------
    InputError
        Of 3 t or less, for which the table has no value.
    """
    tons, shl = weight / _TON, (weight if static_load is None else static_load) / _TON
    if not tons > 3.0:
        raise InputError(
            f"no dynamic amplification factor for {tons:.4g} t",
            expected="more than 3 t, where the table begins, or 'maximum'",
        )
    if tons <= 100.0:
        root = math.sqrt(100.0 / shl)
        return {"onshore": 1.10, "inshore": 1.07 + 0.05 * root, "offshore": 1.0 + 0.25 * root}[operation]
    # the weight of a run is one of a class to its rounding: at a border the larger factor
    return next(row[operation] for _, high, row in _table() if tons <= high * (1.0 + 1e-6))


def bending_factor(ratio: float) -> float:
    """Factor for the bending of a wire rope, ``1 / (1 - 0.5 / sqrt(D/d))``, 0027/ND 7.8."""
    return 1.0 / (1.0 - 0.5 / math.sqrt(ratio))


def sling_factor(
    *,
    reduction: float,
    load: float = 1.3,
    consequence: float = 1.3,
    wear: float = 1.0,
    material: float = 1.5,
    twist: float = 1.0,
) -> float:
    """Safety factor of a sling on its minimum breaking load, 0027/ND 7.3.1.

    ``max(gamma_f gamma_c gamma_r gamma_w gamma_m gamma_tw, 2.3 gamma_r gamma_w gamma_tw)``, gamma_r (`reduction`) being
    the larger one of the factors for its ends and for its bending.
    """
    return reduction * wear * twist * max(load * consequence * material, 2.3)


def capacity_at(
    radii: Sequence[float], capacities: Sequence[float], radius: ArrayLike
) -> NDArray[np.float64]:
    """Capacity of a crane at some radii, linear between those of its curve; not a number outside."""
    found: NDArray[np.float64] = np.interp(
        np.asarray(radius, dtype=np.float64), radii, capacities, left=np.nan, right=np.nan
    )
    return found
