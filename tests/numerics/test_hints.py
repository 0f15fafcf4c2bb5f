"""Annotations mean the same whichever way Python and NumPy write them."""

from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_origin

import numpy as np
import pytest
from numpy.typing import NDArray
from typing_extensions import TypeAliasType

from heavylift.numerics.arrays import Arrays, ArrayType, kernel_type
from heavylift.numerics.hints import array_scalar, unaliased
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.numerics.records import Record
from heavylift.pipeline.case.described import make_section
from heavylift.pipeline.case.fields import Section
from heavylift.solver.scene.descriptions import Family

T = TypeVar("T", bound=np.generic)
Named = TypeAliasType("Named", np.ndarray[Any, np.dtype[T]], type_params=(T,))
"""An array as NumPy 2.5 declares ``NDArray`` on Python 3.12 and later."""
Again = TypeAliasType("Again", Named[np.float64])
Choice = TypeAliasType("Choice", "float | None")


@pytest.mark.parametrize("hint", [NDArray[np.float64], Named[np.float64], Again])
def test_an_array_is_one_under_any_name(hint: Any) -> None:
    assert get_origin(unaliased(hint)) is np.ndarray
    assert array_scalar(hint) is np.float64


def test_names_that_stand_for_nothing_else_stay() -> None:
    for hint in (float, int | None, tuple[int, ...], Annotated[float, 1], None, np.ndarray, Section):
        assert unaliased(hint) is hint
    assert array_scalar(Named[np.int64]) is np.int64


def test_kernels_see_an_array_of_the_same_type() -> None:
    assert kernel_type(Annotated[Named[np.int64], 2]) == ArrayType(np.int64, 2)

    class Row(Record):
        """A row."""

        x: Annotated[Named[np.float64], (3,)]

    assert Row.layout["x"] == np.dtype((np.float64, (3,)))


def test_fields_of_a_group_are_those_of_its_class() -> None:
    class Values(Arrays):
        """A group."""

        values: Annotated[Named[np.float64], 1]
        count: int

    assert Values(np.arange(3.0), 3).values.tolist() == [0.0, 1.0, 2.0]


HINTS = (NDArray[np.float64], Named[np.float64], NDArray[np.float64] | None, Named[np.float64] | None)


@pytest.mark.parametrize("hint", HINTS)
def test_a_key_of_a_case_is_a_list_of_numbers_in_units(hint: Any) -> None:
    family: Family[Any] = Family("thing", "heavylift.solver.joints")

    @family.describe("thing")
    @dataclass(frozen=True)
    class Thing:
        """A thing."""

        times: Annotated[hint, Quantity("time"), Shape((None,))]
        """When."""

    section = make_section(Thing, Section)
    assert section.model_validate({"type": "thing", "times": ["1 min", 2.0]}).times == (60.0, 2.0)
