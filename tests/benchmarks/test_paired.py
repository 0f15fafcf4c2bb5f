"""What the comparison of two installations reads from the output of a benchmark."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

with pytest.MonkeyPatch.context() as patch:
    patch.syspath_prepend(Path(__file__).resolve().parents[2] / "benchmarks")
    p = importlib.import_module("paired")


def test_rows_are_named_by_their_words_and_counted():
    rows = p.rows_of("A02-1 5 modes  1.5 us/step <=2e-3\n2 sticks -1 us\n3 sticks 4 us\n")
    assert rows == {
        "A02-1 [1]": ("A02-1 # modes # us/step <=#", [5.0, 1.5, 2e-3]),
        " [1]": ("# sticks # us", [2.0, -1.0]),
        " [2]": ("# sticks # us", [3.0, 4.0]),
    }
    assert p.rows_of("A03 4.2! / 3.0 dele2").keys() == p.rows_of("A03 2.9 / 3.0 accurate").keys()


def test_times_are_ratios_and_results_are_told_where_they_differ():
    old = [[5.0, 2.0, 1e-9], [5.0, 4.0, 1e-9], [5.0, 3.0, 1e-9]]
    assert p.compared(old, old).startswith("1.000 (1.00..1.00)")
    slower = [[5.0, 2.2, 1e-9], [5.0, 4.4, 1e-9], [5.0, 3.6, 1e-9]]
    assert p.compared(old, slower) == "1.100 (1.10..1.20)!"
    noisy = [[5.0, 1.8, 1e-9], [5.0, 4.4, 1e-9], [5.0, 3.0, 1e-9]]
    assert p.compared(old, noisy) == "1.000 (0.90..1.10)"
    other = [[5.0, 2.0, 2e-9], [5.0, 4.0, 2e-9], [5.0, 3.0, 2e-9]]
    assert p.compared(old, other).endswith("1e-09 is 2e-09")
    assert p.label("# modes # us <=#", old + other) == "5 modes # us <=#"
