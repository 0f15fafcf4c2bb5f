"""Exit codes on the pages are those of the program."""

from __future__ import annotations

import re

import pytest
from where import ROOT

from heavylift.numerics.outcome import Outcome

OF_THE_SHELL = {141}
"""SIGPIPE."""


def numbers(words: str) -> set[int]:
    """Of "3, 4, 8 to 14"."""
    found: set[int] = set()
    for first, last in re.findall(r"(\d+)(?: to (\d+))?", words):
        found |= set(range(int(first), int(last or first) + 1))
    return found


def table(page: str, column: int) -> list[tuple[str, set[int]]]:
    """Rows of tables with a column of exit codes: the other words, and the codes."""
    found, inside = [], False
    for line in (ROOT / page).read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            inside = False
        elif len(cells) > column and cells[column] == "exit code":
            inside = True
        elif inside and "---" not in line:
            found.append((" ".join(cells[:column] + cells[column + 1 :]), numbers(cells[column])))
    return found


def test_the_readme_names_every_code():
    told = set().union(*(codes for _, codes in table("README.md", 0)))
    assert told == {int(outcome) for outcome in Outcome} | OF_THE_SHELL


@pytest.mark.parametrize(
    ("page", "column", "expected"),
    [
        (
            "docs/scenarios.md",
            1,
            {
                "the last phase is done": Outcome.COMPLETED,
                "a limit is passed": Outcome.LIMIT_REACHED,
                "a phase takes longer": Outcome.TIMED_OUT,
                "a phase still waits": Outcome.PHASES_LEFT,
            },
        ),
        (
            "docs/reliability.md",
            1,
            {
                "a value is not finite": Outcome.NOT_FINITE,
                "the step is too large": Outcome.STEP_TOO_LARGE,
                "an iteration did not converge": Outcome.NOT_CONVERGED,
                "came apart": Outcome.NOT_CLOSED,
                "no step is small enough": Outcome.STEP_TOO_SMALL,
                "strains lost": Outcome.STRAINS_LOST,
                "too many contacts": Outcome.TOO_MANY_CONTACTS,
                "mooring line overstretched": Outcome.LINE_OVERSTRETCHED,
                "half of the energy": Outcome.ENERGY_NOT_KEPT,
                "outside the database": Outcome.OUTSIDE_DATABASE,
                "a limit is reached": Outcome.LIMIT_REACHED,
                "a phase takes too long": Outcome.TIMED_OUT,
                "phases are left": Outcome.PHASES_LEFT,
                "off the road": Outcome.OFF_ROAD,
                "modes left": Outcome.MODES_LEFT,
            },
        ),
    ],
)
def test_pages_say_what_ends_with_which_code(page, column, expected):
    rows = table(page, column)
    for words, outcome in expected.items():
        assert [codes for text, codes in rows if words in text] == [{int(outcome)}], words
    assert len(rows) == len(expected)


def test_the_page_of_transporters_has_the_codes_of_what_leaves_its_deck():
    codes = re.findall(r"exit code (\d+)", (ROOT / "docs/transport.md").read_text(encoding="utf-8"))
    assert {int(code) for code in codes} == {Outcome.OFF_ROAD, Outcome.NOT_CLOSED, Outcome.STEP_TOO_LARGE}
