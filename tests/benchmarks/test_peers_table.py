"""What becomes of the costs of the benchmark against peers: table, recorded ratios, and what is worse."""

from __future__ import annotations

import importlib
import math
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"

with pytest.MonkeyPatch.context() as patch:
    patch.syspath_prepend(BENCHMARKS)
    m = importlib.import_module("peers_measure")
    t = importlib.import_module("peers_table")


def study(name, *pairs):
    """Costs of heavylift and of a peer [s], each with whether it is a bound, at 1e-2, 1e-4, ..."""
    costs = [
        {
            "target": 10.0 ** (-2 - 2 * k),
            "heavylift": own and m.Cost(*own, "heavylift", "accurate"),
            "peer": peer and m.Cost(*peer, "Other", "RK4"),
        }
        for k, (own, peer) in enumerate(pairs)
    ]
    return {"problem": name, "costs": costs}


def test_table_says_who_is_ahead_and_what_is_a_bound():
    rows = t.table_lines(
        [
            study(
                "A01", ((2.5e-4, True), (1.25e-4, False)), ((0.04, False), (0.2, True)), ((1e-3, False), None)
            )
        ]
    )
    assert rows[2] == "| A01 pendulum | <= 0.25 / 40 / 1 | 0.12 / <= 200 / - | **2** / 0.2 / - |"
    assert [row.count("|") for row in rows] == [5, 5, 5]


def test_only_what_stands_between_the_marks_changes():
    text = f"before\n\n{t.BEGIN}\nold\nrows\n{t.END}\n\nafter\n"
    once = t.put_between(text, ["new"])
    assert once == f"before\n\n{t.BEGIN}\nnew\n{t.END}\n\nafter\n"
    assert t.put_between(once, ["new"]) == once
    for wrong in ("no marks", f"{t.END}\n{t.BEGIN}\n", text + text):
        with pytest.raises(ValueError, match="once each"):
            t.put_between(wrong, ["new"])


def test_document_has_its_place_for_the_table():
    text = t.DOCUMENT.read_text(encoding="utf-8")
    assert "| A05 stiff governor |" not in t.put_between(text, [])


def test_recorded_ratios_come_back(tmp_path):
    cells = t.cells_of(
        [
            study("A01", ((1.0, False), (2.0, False)), ((1.0, False), None)),
            study("A05", ((1.0, False), (1.0, False))),
        ]
    )
    t.write_recorded(tmp_path / "ratios.json", {"heavylift": "1"}, cells)
    versions, found = t.read_recorded(tmp_path / "ratios.json")
    assert versions == {"heavylift": "1"}
    assert found == [t.Cell("A01", 1e-2, 0.5, "Other", "RK4")], "A05 is not among the checked ones"


def test_a_quarter_more_is_worse_and_so_is_a_target_that_is_not_reached_any_more():
    cell = t.Cell("A01", 1e-2, 0.8, "Other", "RK4")
    recorded = [cell, t.Cell("A01", 1e-4, 0.8, "Other", "RK4"), t.Cell("A03", 1e-2, 0.5, "Other", "RK4")]
    measured = [t.Cell("A01", 1e-2, 0.99, "Other", "RK4"), t.Cell("A01", 1e-4, 1.01, "Third", "RK4")]
    assert t.worse(recorded, measured) == [(recorded[1], 1.01), (recorded[2], math.inf)]
    assert t.worse([cell], [t.Cell("A01", 1e-2, math.nan, "Other", "RK4")])[0][0] is cell


def test_what_is_checked_is_recorded():
    _, cells = t.read_recorded(t.RECORDED)
    assert {cell.problem for cell in cells} == set(t.CHECKED)
    assert all(cell.ratio > 0.0 for cell in cells)
