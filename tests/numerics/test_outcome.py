"""Messages for people, exit codes for programs."""

from __future__ import annotations

import pytest

from heavylift.numerics.outcome import InputError, InputErrors, Outcome


def test_a_message_names_place_problem_and_remedy() -> None:
    error = InputError(
        "'steel' is not a number", source="case.toml", key="material.density", expected="a density [kg/m3]"
    )
    assert str(error) == ("case.toml: material.density: 'steel' is not a number; expected a density [kg/m3]")
    assert (error.source, error.key) == ("case.toml", "material.density")


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ({}, "wrong"),
        ({"source": "a"}, "a: wrong"),
        ({"key": "k"}, "k: wrong"),
        ({"expected": "right"}, "wrong; expected right"),
    ],
)
def test_what_is_not_known_leaves_no_trace(place: dict[str, str], message: str) -> None:
    assert str(InputError("wrong", **place)) == message


def test_input_errors_are_value_errors() -> None:
    with pytest.raises(ValueError, match="wrong"):
        raise InputError("wrong")


def test_several_errors_are_told_together() -> None:
    first, second = InputError("one", source="a"), InputError("two", expected="three")
    together = InputErrors([first, second])
    assert str(together) == "a: one\ntwo; expected three"
    assert together.errors == [first, second]
    assert isinstance(together, InputError)


def test_every_outcome_has_words_and_an_exit_code_of_its_own() -> None:
    assert (Outcome.COMPLETED, Outcome.CHECK_FAILED, Outcome.BAD_INPUT) == (0, 1, 2)
    assert len({outcome.text for outcome in Outcome}) == len(Outcome)
    assert all(0 <= outcome < 126 for outcome in Outcome)  # larger exit codes belong to the shell
    assert not Outcome.COMPLETED  # reads as "nothing went wrong"
