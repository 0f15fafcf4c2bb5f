"""What becomes of measured costs: the table of the documentation, recorded ratios, and what got worse since."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from peers_measure import Cost

__all__ = [
    "CHECKED",
    "DOCUMENT",
    "RECORDED",
    "ROWS",
    "Cell",
    "cells_of",
    "put_between",
    "read_recorded",
    "table_lines",
    "worse",
    "write_recorded",
]

DOCUMENT = Path(__file__).resolve().parents[1] / "docs" / "benchmarks.md"
RECORDED = Path(__file__).resolve().parent / "peers_recorded.json"
BEGIN, END = "<!-- peers: written by benchmarks/peers.py -->", "<!-- end of peers -->"
"""Lines of the document around the table."""

ROWS = {
    "A01": "A01 pendulum",
    "A02-1": "A02, 1 loop",
    "A02-10": "A02, 10 loops",
    "A02-40": "A02, 40 loops",
    "A03": "A03 squeezer",
    "A04-square": "A04 Bricard, square section",
    "A04-thin": "A04 Bricard, thin bars",
    "A05": "A05 stiff governor",
    "chain-10": "chain of 10",
    "chain-50": "chain of 50",
    "chain-200": "chain of 200",
}
"""Rows of the table: problem and words."""

CHECKED = ("A01", "A02-10", "A03", "A04-square", "chain-10")
"""Problems whose ratios are recorded: a tree of one body, many loops, one stiff loop, redundant rows, a long tree."""

ALLOWED = 1.25
"""Times the recorded ratio; beyond it something has become slow."""


@dataclass(frozen=True)
class Cell:
    """Cost of heavylift over that of the cheapest peer, for one problem and target error.

    Attributes
    ----------
    problem, target
        Name, and error [m].
    ratio
        heavylift over peer: below 1 heavylift is ahead.
    program, solver
        The peer.
    """

    problem: str
    target: float
    ratio: float
    program: str
    solver: str


def cells_of(studies: Iterable[Mapping[str, Any]]) -> list[Cell]:
    """Cells of measured problems; where one side has no cost there is none."""
    return [
        Cell(
            study["problem"],
            row["target"],
            row["heavylift"].seconds / row["peer"].seconds,
            row["peer"].program,
            row["peer"].solver,
        )
        for study in studies
        for row in study["costs"]
        if row["heavylift"] is not None and row["peer"] is not None
    ]


def _number(value: float) -> str:
    """Two digits, or all before the point."""
    return f"{value:.0f}" if value >= 99.5 else f"{value:.2g}"


def _costs(costs: Sequence[Cost | None]) -> str:
    """Milliseconds at the targets; what beats its target at the coarsest setting is an upper bound."""
    return " / ".join(
        "-" if cost is None else ("<= " if cost.bound else "") + _number(1e3 * cost.seconds) for cost in costs
    )


def table_lines(studies: Iterable[Mapping[str, Any]]) -> list[str]:
    """Table in Markdown: costs at the targets, and heavylift over the cheapest peer; bold where that is not below 1."""
    lines = ["| problem | heavylift | cheapest peer | heavylift / peer |", "|---|---|---|---|"]
    for study in studies:
        own = [row["heavylift"] for row in study["costs"]]
        peers = [row["peer"] for row in study["costs"]]
        ratios = []
        for one, other in zip(own, peers, strict=True):
            if one is None or other is None:
                ratios.append("-")
                continue
            text = _number(one.seconds / other.seconds)
            ratios.append(text if one.seconds < other.seconds else f"**{text}**")
        name = ROWS.get(study["problem"], study["problem"])
        lines.append(f"| {name} | {_costs(own)} | {_costs(peers)} | {' / '.join(ratios)} |")
    return lines


def put_between(text: str, lines: Sequence[str]) -> str:
    """A document with these lines between the marks, in place of what is there.

    Raises
    ------
    ValueError
        If the marks are not there, once each and in order.
    """
    head, begin, rest = text.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not begin or not end or BEGIN in rest or END in tail:
        raise ValueError(f"expected the lines {BEGIN!r} and {END!r}, once each")
    return "\n".join([head + begin, *lines, end + tail])


def write_recorded(path: Path, versions: Mapping[str, str], cells: Iterable[Cell]) -> None:
    """Ratios of the checked problems with the peers that were cheapest, as JSON."""
    kept = [vars(cell) | {"ratio": round(cell.ratio, 4)} for cell in cells if cell.problem in CHECKED]
    path.write_text(json.dumps({"versions": versions, "cells": kept}, indent=1) + "\n", encoding="utf-8")


def read_recorded(path: Path) -> tuple[dict[str, str], list[Cell]]:
    """Versions of the programs, and cells."""
    found = json.loads(path.read_text(encoding="utf-8"))
    return found["versions"], [Cell(**cell) for cell in found["cells"]]


def worse(recorded: Iterable[Cell], measured: Iterable[Cell]) -> list[tuple[Cell, float]]:
    """Recorded cells whose ratio has grown beyond what is allowed, with that of now; infinite if there is none now."""
    now = {(cell.problem, cell.target): cell.ratio for cell in measured}
    found = [(cell, now.get((cell.problem, cell.target), float("inf"))) for cell in recorded]
    return [(cell, ratio) for cell, ratio in found if not ratio <= ALLOWED * cell.ratio]
