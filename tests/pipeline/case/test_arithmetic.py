"""Arithmetic of a case: exactly the operations it names, and no code."""

from __future__ import annotations

import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.arithmetic import filled, value_of


@pytest.mark.parametrize(
    ("text", "value"),
    [("n + 1", 5), ("2*(n - 1)/3", 2), ("-n % 3", 2), ("n // 3", 1), ("7/2", 3.5), ("1e-3*n", 0.004)],
)
def test_values(text, value):
    assert value_of(text, {"n": 4}) == value
    assert type(value_of(text, {"n": 4})) is type(value)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "n +",
        "n.real",
        "abs(n)",
        "[n]",
        "n if n else 1",
        "True",
        "'a'",
        "n ** 9",
        "9" * 400,
        "1e308*10",
        "m",
        "1j",
    ],
)
def test_anything_else_is_refused(text):
    with pytest.raises(InputError):
        value_of(text, {"n": 4})


def test_texts_keep_what_is_not_in_braces():
    assert filled("crank_{i-1}, crank_{i+1}", {"i": 3}) == "crank_2, crank_4"
    assert filled("{0.1*i} m", {"i": 3}) == "0.3 m"
    assert filled("{i}", {"i": 3}) == 3
    assert filled("none", {}) == "none"
