"""Records: the same in kernels and in Python, and nothing else is taken for one."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import pytest
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Reference, described
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import CompileError, entry
from heavylift.numerics.records import (
    LaneRecords,
    Lanes,
    Matrix3,
    Record,
    Records,
    Vector,
    clear_record,
    copy_record,
    filled,
    filled_rows,
    known_lanes,
    lane_records,
    record_at,
    records,
)


class Place(Record):
    position: Vector
    turned: bool
    depth: Annotated[NDArray[np.float64], (2,), "position"]


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
    made = records(Wide, [filled(Wide, value=1.5), filled(Wide, value=2.5)])
    np.testing.assert_array_equal(made["value"], [1.5, 2.5])
    assert isinstance(made[1], Wide)
    place = Place.one()
    place.depth[1] = 4.0
    np.testing.assert_array_equal(place.position, [0.0, 4.0, 0.0])


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
        place.depth[0] = 9.0
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


@entry
def store_a_view(group: Weights) -> None:
    group.weights[0].position = group.weights[1].position


@entry
def store_a_fraction(group: Weights) -> None:
    group.weights[0].count = group.weights[1].mass


@pytest.mark.parametrize("kernel_of", [store_a_view, store_a_fraction])
def test_what_does_not_fit_a_field_does_not_compile(kernel_of: Any) -> None:
    """A view would be written over it, a fraction cut."""
    with pytest.raises(CompileError, match="setattr"):
        kernel_of(weights())


def test_a_layout_names_the_object() -> None:
    """What kernels know of a record is part of what decides whether they are compiled anew."""
    text = described(Reference(Weights))
    assert "mass 32" in text
    assert "(3, 3)" in text


class Sides(Record):
    left: Lanes
    right: Lanes


class Known(Arrays):
    rows: known_lanes(Sides, 4)  # type: ignore[valid-type]


class Unknown(Arrays):
    rows: LaneRecords[Sides]


@kernel(internal=True)
def swap(rows: LaneRecords[Sides], place: int) -> None:
    row = rows[place]
    for r in range(row.left.shape[0]):
        row.left[r], row.right[r] = row.right[r], row.left[r]


@entry
def swap_known(group: Known, place: int) -> None:
    swap(group.rows, place)


@entry
def copy_and_clear(group: Known, weights: Records[Weight]) -> None:
    copy_record(group.rows[2], group.rows[0])
    clear_record(group.rows[0])
    copy_record(weights[1], weights[0])
    clear_record(weights[0])


def test_whole_records_are_copied_and_cleared() -> None:
    """With all their fields, and no neighbour."""
    rows, group = lane_records(Sides, 3, 4), weights()
    rows["left"], rows["right"] = 1.0, np.arange(12.0).reshape(3, 4)
    before = group.weights[0].words.copy()
    copy_and_clear(Known(rows), group.weights)
    np.testing.assert_array_equal(rows["right"], [[0.0] * 4, [4.0, 5.0, 6.0, 7.0], [0.0, 1.0, 2.0, 3.0]])
    np.testing.assert_array_equal(rows["left"], np.repeat([[0.0], [1.0], [1.0]], 4, axis=1))
    assert group.weights[1].words.tobytes() == before.tobytes()
    assert not group.weights[0].words.any()
    assert group.weights[2].mass == 7.0
    copy_record(group.weights[0], group.weights[2])
    assert group.weights[0].mass == 7.0
    clear_record(group.weights[2])
    assert group.weights[2].mass == 0.0


def test_records_are_filled_by_name() -> None:
    """In any order, without fields that span others; a forgotten or unknown name is told."""
    start = filled(Place, turned=True, position=(1.0, 2.0, 3.0))
    given: dict[str, Any] = {"mass": 2.0, "count": 5, "inertia": np.eye(3), "parts": (7, 8), "turned": False}
    rows = records(Weight, [filled(Weight, **given, start=start, position=(4.0, 5.0, 6.0)) for _ in range(2)])
    assert rows[1].count == 5
    assert rows[1].mass == 2.0
    np.testing.assert_array_equal(rows["position"], [[4.0, 5.0, 6.0]] * 2)
    np.testing.assert_array_equal(rows[1].depth, [4.0, 5.0])
    np.testing.assert_array_equal(rows[1].inertia, np.eye(3))
    np.testing.assert_array_equal(rows[1].parts, [7, 8])
    assert rows[1].start.turned
    np.testing.assert_array_equal(rows[1].start.position, [1.0, 2.0, 3.0])
    with pytest.raises(TypeError, match=r"Place without 'turned'"):
        filled(Place, position=(1.0, 2.0, 3.0))
    with pytest.raises(TypeError, match=r"Place with unknown 'depth', 'mass' and without 'position'"):
        filled(Place, turned=True, depth=(1.0, 2.0), mass=1.0)


def test_records_are_filled_by_columns() -> None:
    """As one by one; names and lengths must fit."""
    positions = np.arange(6.0).reshape(2, 3)
    rows = filled_rows(Place, turned=[True, False], position=positions)
    one_by_one = [filled(Place, turned=i == 0, position=positions[i]) for i in range(2)]
    assert rows.view(np.uint8).tobytes() == records(Place, one_by_one).view(np.uint8).tobytes()
    assert len(filled_rows(Wide, value=[])) == 0
    with pytest.raises(TypeError, match=r"Place without 'turned'"):
        filled_rows(Place, position=positions)
    with pytest.raises(ValueError, match=r"Place: columns of different lengths"):
        filled_rows(Place, position=positions, turned=[True])


def test_nothing_is_filled_by_position() -> None:
    """Neither a table, nor a record, nor one within another: a tuple in order of the fields is refused."""
    given: dict[str, Any] = {"mass": 2.0, "count": 5, "inertia": np.eye(3), "parts": (7, 8), "turned": False}
    with pytest.raises(TypeError, match=r"tuple in a table of Wide"):
        records(Wide, [(1.5,)])  # type: ignore[list-item]
    with pytest.raises(TypeError, match=r"Place in a table of Wide"):
        records(Wide, [Place.one()])  # type: ignore[list-item]
    with pytest.raises(TypeError, match=r"Weight\.start: tuple, expected a Place"):
        filled(Weight, **given, start=((1.0, 2.0, 3.0), True), position=(4.0, 5.0, 6.0))


@entry
def swap_unknown(group: Unknown, place: int) -> None:
    swap(group.rows, place)


@entry
def swap_last(group: Unknown) -> None:
    swap(group.rows, len(group.rows) - 1)


def test_records_of_lanes() -> None:
    """The same memory for kernels that know the lanes and for those that do not."""
    rows = lane_records(Sides, 3, 4)
    rows["left"] = np.arange(12.0).reshape(3, 4)
    swap_known(Known(rows), 1)
    np.testing.assert_array_equal(rows[1].right, [4.0, 5.0, 6.0, 7.0])
    np.testing.assert_array_equal(rows["left"][:, 0], [0.0, 0.0, 8.0])
    swap_unknown(Unknown(rows), 1)
    np.testing.assert_array_equal(rows["left"], np.arange(12.0).reshape(3, 4))
    swap_last(Unknown(rows))
    np.testing.assert_array_equal(rows["left"][:, 0], [0.0, 4.0, 0.0])
    with pytest.raises(TypeError, match="expected LaneRecords"):
        _ = Known(lane_records(Sides, 3, 2)).address
    with pytest.raises(TypeError, match="expected LaneRecords"):
        _ = Unknown(np.zeros(3)).address  # type: ignore[arg-type]
