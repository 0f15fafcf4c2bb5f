"""Records: the same in kernels and in Python, and nothing else is taken for one."""

from __future__ import annotations

from typing import Annotated

import numpy as np
import pytest
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Reference, described
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Matrix3, Record, Records, Vector, record_at, records


class Place(Record):
    position: Vector
    turned: bool


class Weight(Place):
    mass: float
    count: int
    inertia: Matrix3
    start: Place
    parts: Annotated[NDArray[np.int64], (2,)]


class Wide(Record, whole_lines=True):
    value: float


class Weights(Arrays):
    weights: Records[Weight]
    heaviest: Weight
    numbers: Floats1


@kernel(internal=True)
def add_count(place: Place, by: float) -> None:
    place.position[2] += by
    place.turned = not place.turned


@entry
def change(group: Weights, by: float) -> float:
    total = 0.0
    for i in range(group.weights.shape[0]):
        weight = group.weights[i]
        weight.mass += by * i
        weight.count = weight.count + 1
        weight.inertia[1, 2] = weight.mass
        weight.start.position[1] = 2.0 * by
        weight.parts[1] -= 3
        add_count(weight, by)
        add_count(weight.start, -by)
        total += weight.mass
    part = group.weights[1:]
    for i in range(len(part)):
        total += part[i].mass
    group.heaviest.mass = group.weights[group.weights.size - 1].mass
    return total


def in_numpy(group: Weights, by: float) -> float:
    rows = group.weights
    rows["mass"] += by * np.arange(len(rows))
    rows["count"] += 1
    rows["inertia"][:, 1, 2] = rows["mass"]
    rows["start"]["position"][:, 1] = 2.0 * by
    rows["parts"][:, 1] -= 3
    rows["position"][:, 2] += by
    rows["turned"] = ~rows["turned"]
    rows["start"]["position"][:, 2] -= by
    rows["start"]["turned"] = ~rows["start"]["turned"]
    group.heaviest.mass = rows["mass"][-1]
    return float(rows["mass"].sum() + rows["mass"][1:].sum())


def weights() -> Weights:
    made = Weights(records(Weight, 3), Weight.one(), np.zeros(3))
    made.weights["mass"] = [1.0, 5.0, 7.0]
    made.weights["turned"] = [True, False, True]
    return made


def test_kernels_and_numpy_see_the_same() -> None:
    """Fields of a base, of a record in a record, truth values, matrices, parts of an array of records."""
    compiled, plain, python = weights(), weights(), weights()
    total = change(compiled, 0.5)
    assert total == in_numpy(plain, 0.5)
    assert compiled.weights.view(np.uint8).tobytes() == plain.weights.view(np.uint8).tobytes()
    assert compiled.heaviest.mass == plain.heaviest.mass == 8.0
    weight = python.weights[1]
    weight.mass += 0.5
    weight.position[2] += 0.5
    weight.start.position[1] = 1.0
    assert python.weights["mass"][1] == compiled.weights[1].mass
    assert python.weights["start"]["position"][1, 1] == compiled.weights[1].start.position[1]


def test_memory() -> None:
    """Records fill words, or lines if they are to; arrays of them begin at a line."""
    assert Place.layout.itemsize == 32
    assert Weight.layout.itemsize == 32 + 8 + 8 + 72 + 32 + 16
    assert Wide.layout.itemsize == 64
    assert records(Wide, 3).ctypes.data % 64 == 0
    made = records(Place, [((1.0, 2.0, 3.0), True), ((0.0, 0.0, 0.0), False)])
    np.testing.assert_array_equal(made["position"][0], [1.0, 2.0, 3.0])
    assert made[0].turned
    assert isinstance(made[1], Place)


@entry
def copy_first(group: Weights) -> None:
    source, target = group.weights[0].words, group.heaviest.words
    for k in range(target.shape[0]):
        target[k] = source[k]


def test_words_of_a_record_in_kernels() -> None:
    """All of it, copied together."""
    group = weights()
    group.weights[0].start.position[1] = 3.0
    copy_first(group)
    assert group.heaviest.tobytes() == group.weights[0].tobytes()
    assert group.heaviest.turned


@kernel
def second_mass(rows: Records[Weight]) -> float:
    return rows[1].mass


def test_plain_kernels_take_them() -> None:
    """Types are found from values, too."""
    assert second_mass(weights().weights) == 5.0


PLACE_AT = record_at(Place)


@entry
def sum_of_places(values: Floats1, count: int) -> float:
    total = 0.0
    for i in range(count):
        place = PLACE_AT(values, 1 + 4 * i)
        total += place.position[1]
        place.position[0] = 9.0
    return total


def test_records_in_flat_arrays() -> None:
    """Data of changing length hold records at any place."""
    values = np.arange(9.0)
    assert sum_of_places(values, 2) == 2.0 + 6.0
    assert values[1] == values[5] == 9.0
    PLACE_AT(values, 5).position[2] = -1.0
    assert values[7] == -1.0


def test_other_arrays_are_refused() -> None:
    """A kernel never reads one record as another."""
    with pytest.raises(TypeError, match=r"Weights.weights: Place 1-d, expected a contiguous array of Weight"):
        _ = Weights(records(Place, 2), Weight.one(), np.zeros(1)).address  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"Weights.heaviest: Place, expected Weight"):
        _ = Weights(records(Weight, 2), Place.one(), np.zeros(1)).address  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"Weights.weights: ndarray|float64"):
        _ = Weights(np.zeros(2), Weight.one(), np.zeros(1)).address  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"Bad.name: .*expected a number"):
        type("Bad", (Record,), {"__annotations__": {"name": "str"}, "__module__": __name__})


def test_a_layout_names_the_object() -> None:
    """What kernels know of a record is part of what decides whether they are compiled anew."""
    text = described(Reference(Weights))
    assert "mass 32" in text
    assert "(3, 3)" in text
