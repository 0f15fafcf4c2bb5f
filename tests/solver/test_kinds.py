"""Generic functions: dispatch on the kinds of a tuple, in Python and in compiled code."""

from __future__ import annotations

from typing import Any, NamedTuple

import numba
import numpy as np
import pytest

from heavylift.numerics.jit import kernel
from heavylift.solver.kinds import generic, implement


class Weights(NamedTuple):
    mass: np.ndarray


class Springs(NamedTuple):
    stiffness: np.ndarray
    stretch: np.ndarray


class Ghosts(NamedTuple):
    mass: np.ndarray


@generic
def pull(kinds: Any, step: float, total: np.ndarray) -> None:
    """Add all forces times the step, and leave a trace of the order."""


@implement(pull, Weights)
@kernel
def pull_weights(kind: Weights, step: float, total: np.ndarray) -> None:
    for i in range(kind.mass.shape[0]):
        total[0] += step * 10.0 * kind.mass[i]
    total[1] = 10.0 * total[1] + 1.0


@implement(pull, Springs)
@kernel
def pull_springs(kind: Springs, step: float, total: np.ndarray) -> None:
    for i in range(kind.stiffness.shape[0]):
        total[0] += step * kind.stiffness[i] * kind.stretch[i]
    total[1] = 10.0 * total[1] + 2.0


@kernel
def pull_compiled(kinds: tuple[Any, ...], step: float, total: np.ndarray) -> None:
    pull(kinds, step, total)


WEIGHTS = Weights(np.array([1.0, 2.0]))
SPRINGS = Springs(np.array([4.0]), np.array([0.5]))


@pytest.mark.parametrize("call", [pull, pull_compiled], ids=["python", "compiled"])
@pytest.mark.parametrize(
    ("kinds", "expected"),
    [
        ((), [0.0, 0.0]),
        ((WEIGHTS,), [3.0, 1.0]),
        ((SPRINGS, WEIGHTS), [3.2, 21.0]),
        ((WEIGHTS, SPRINGS, WEIGHTS), [6.2, 121.0]),
    ],
)
def test_every_kind_is_served_in_order(call: Any, kinds: tuple[Any, ...], expected: list[float]) -> None:
    total = np.zeros(2)
    call(kinds, 0.1, total)
    np.testing.assert_allclose(total, expected)


def test_an_unknown_kind_is_named() -> None:
    with pytest.raises(TypeError, match="pull is not implemented for Ghosts"):
        pull((WEIGHTS, Ghosts(np.ones(1))), 0.1, np.zeros(2))


def test_an_unknown_kind_does_not_compile() -> None:
    if numba.config.DISABLE_JIT:
        pytest.skip("needs compiled kernels")
    with pytest.raises((TypeError, numba.TypingError), match="Ghosts"):
        pull_compiled((Ghosts(np.ones(1)),), 0.1, np.zeros(2))


def test_the_docstring_is_the_contract() -> None:
    assert pull.__name__ == "pull"
    assert "leave a trace" in (pull.__doc__ or "")
