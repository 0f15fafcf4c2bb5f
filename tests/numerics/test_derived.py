"""Results that are kept: the same bits, computed once, and computed again when anything they depend on is another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest

from heavylift.contours.triangles.surface_layout import Edge
from heavylift.numerics import derived as module
from heavylift.numerics.derived import derived, keeping
from heavylift.numerics.records import records


class Memory:
    """A store in memory."""

    versions = "numpy 2"

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}
        self.refused: list[str] = []

    def read(self, name: str) -> bytes | None:
        return self.files.get(name)

    def write(self, name: str, data: bytes) -> None:
        self.files[name] = data

    def refuse(self, name: str) -> None:
        self.refused.append(name)


class Made(NamedTuple):
    values: np.ndarray
    rows: np.ndarray
    none: np.ndarray
    flat: float
    count: int
    text: str
    absent: None


CALLS: list[int] = []


def make(points: np.ndarray, factor: object = 1.0) -> Made:
    CALLS.append(1)
    edges = records(Edge, 3)
    edges["ends"] = [[1, 2], [3, 4], [5, -6]]
    return Made(-points, edges, np.zeros((0, 3), dtype=np.int32), 0.1 + 0.2, -(2**60), "ä", None)


def make_object(points: np.ndarray) -> Made:
    return Made(np.array([None]), points, points, 0.0, 0, "", None)


@pytest.fixture(autouse=True)
def _count() -> None:
    CALLS.clear()


POINTS = np.array([[0.1, -0.0, np.nan], [np.inf, 5e-324, 1.0]])


def same(one: Made, other: Made) -> bool:
    arrays = ((a, b) for a, b in zip(one, other, strict=True) if isinstance(a, np.ndarray))
    return one[3:] == other[3:] and all(
        a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes() for a, b in arrays
    )


def test_without_a_store_it_is_the_call():
    assert same(derived(Made, make, POINTS, rows=(Edge,)), make(POINTS))
    assert len(CALLS) == 2


def test_computed_once_and_read_back_bit_for_bit():
    store = Memory()
    with keeping(store):
        first = derived(Made, make, POINTS, rows=(Edge,))
        again = derived(Made, make, POINTS.copy(), rows=(Edge,))
    assert len(CALLS) == 1
    assert same(first, again)
    assert type(again.rows[0]) is Edge  # kernels read records of their class, at a cache line
    assert again.rows.ctypes.data % 64 == 0
    again.values[0, 0] = 7.0  # memory of its own
    with keeping(store):
        assert same(derived(Made, make, POINTS, rows=(Edge,)), first)


def test_every_input_counts():
    last_bit = POINTS.copy()
    last_bit[1, 2] = np.nextafter(1.0, 2.0)
    inputs = [
        (POINTS,),
        (last_bit,),
        (POINTS.reshape(3, 2),),
        (POINTS.view(np.int64),),
        (POINTS, 1),
        (POINTS, 1.0),
        (POINTS, True),
        (POINTS, "1"),
        (POINTS, None),
        (POINTS, (1, (2, 3))),
        (POINTS, ((1, 2), 3)),
    ]
    store = Memory()
    with keeping(store):
        for given in inputs:
            derived(Made, make, *given, rows=(Edge,))
    assert len(CALLS) == len(store.files) == len(inputs)


def test_other_sources_and_versions_are_other_results(monkeypatch: pytest.MonkeyPatch):
    store = Memory()
    with keeping(store):
        derived(Made, make, POINTS, rows=(Edge,))
        store.versions = "numpy 3"
        derived(Made, make, POINTS, rows=(Edge,))
        monkeypatch.setattr(module, "closure_digest", lambda _: "edited")
        derived(Made, make, POINTS, rows=(Edge,))
        assert len(CALLS) == 3
        monkeypatch.setattr(module, "edited_since_start", lambda _: True)
        store.versions = "numpy 4"
        derived(Made, make, POINTS, rows=(Edge,))
    assert len(store.files) == 3  # what was imported before an edit is not kept under its name


def test_a_damaged_file_is_told_and_made_anew():
    store = Memory()
    with keeping(store):
        first = derived(Made, make, POINTS, rows=(Edge,))
        ((name, whole),) = store.files.items()
        damaged = [whole[:-1], whole + b"\0", b"", whole[:30], b"x" * len(whole)]
        rng = np.random.default_rng(1)
        for place in (0, len(whole) - 1, *rng.integers(0, len(whole), 50)):
            wrong = bytearray(whole)
            wrong[place] ^= 1 << int(rng.integers(8))
            damaged.append(bytes(wrong))
        for data in damaged:
            store.files[name] = data
            assert same(derived(Made, make, POINTS, rows=(Edge,)), first)
            assert store.files[name] == whole
    assert store.refused == [name] * len(damaged)


def test_what_cannot_be_kept_is_a_mistake_of_the_caller():
    with keeping(Memory()):
        with pytest.raises(TypeError, match="dict among the arguments"):
            derived(Made, make, POINTS, {})
        with pytest.raises(TypeError, match="objects among the arguments"):
            derived(Made, make, np.array([None]))
        with pytest.raises(TypeError, match="records of Edge"):
            derived(Made, make, POINTS)
        with pytest.raises(TypeError, match="objects in a result"):
            derived(Made, make_object, POINTS)


@dataclass(frozen=True)
class Sea:
    omega: np.ndarray
    depth: float


def test_a_dataclass_counts_by_its_fields():
    store = Memory()
    with keeping(store):
        for depth in (10.0, 10.0, 20.0):
            derived(Made, make, POINTS, (Sea(POINTS, depth),), rows=(Edge,))
    assert len(CALLS) == 2
