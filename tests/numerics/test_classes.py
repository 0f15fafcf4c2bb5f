"""Dataclasses whose methods are written late behave as those of the standard library."""

import copy
import dataclasses
import pickle
from dataclasses import FrozenInstanceError, field, fields, replace
from typing import Any, ClassVar

import pytest

from heavylift.numerics.classes import dataclass


def pair(decorate: Any) -> tuple[Any, Any]:
    """A base and a class made from it."""

    @decorate(frozen=True)
    class Part:
        """A part."""

        count: ClassVar[int] = 7
        name: str
        mass: float = 2.0
        tags: list[str] = field(default_factory=list, compare=False)

    @decorate(frozen=True, kw_only=True)
    class Beam(Part):
        length: float
        area: float = field(default=0.1, repr=False)
        volume: float = field(init=False)

        def __post_init__(self) -> None:
            object.__setattr__(self, "volume", self.length * self.area)

    return Part, Beam


def test_objects_are_as_those_of_the_standard_library() -> None:
    for own, other in zip(pair(dataclass), pair(dataclasses.dataclass), strict=True):
        told = []
        for cls in (own, other):
            more = {"length": 3.0} if cls.__name__ == "Beam" else {}
            one, two = cls("a", tags=["x"], **more), cls("a", 2.0, **more)
            assert one == two
            assert hash(one) == hash(two)
            assert one != replace(one, name="b")
            assert two.tags == []
            told.append(
                (
                    repr(one).rpartition("<locals>.")[2],
                    [(f.name, f.kw_only, f.init) for f in fields(cls)],
                    dataclasses.asdict(one),
                    cls.__match_args__,
                )
            )
            for act in (lambda: setattr(one, "mass", 1.0), lambda: delattr(one, "mass")):  # noqa: B023
                with pytest.raises(FrozenInstanceError, match="mass"):
                    act()
            with pytest.raises(TypeError, match=r"__init__\(\) missing .*'name'"):
                cls(**more)
            with pytest.raises(TypeError, match="unexpected keyword argument 'weight'"):
                cls("a", weight=1.0)
        assert told[0] == told[1]


@dataclass
class Tally:
    """Counts that change."""

    found: int = 0
    names: tuple[str, ...] = ()


@dataclass(eq=False)
class Thing:
    """Known by itself."""

    value: int


def test_classes_that_change_compare_by_value_and_have_no_hash() -> None:
    one = Tally(3)
    one.found += 1
    assert one == Tally(4)
    assert one != 4
    with pytest.raises(TypeError, match="unhashable"):
        hash(one)
    assert Thing(1) != Thing(1)
    assert len({Thing(1), Thing(1)}) == 2


def test_copies_are_made_before_the_first_object() -> None:
    """Without a constructor, as of a process that only reads what another has written."""
    made = copy.copy(pickle.loads(pickle.dumps(Tally(2, ("a",)))))  # noqa: S301
    assert made == Tally(2, ("a",))


def test_a_plain_frozen_class_can_be_made_from_one() -> None:
    part, _ = pair(dataclass)
    plain = dataclasses.dataclass(frozen=True)(
        type("Plain", (part,), {"__annotations__": {"depth": float}, "depth": 1.0})
    )
    assert plain("a").depth == 1.0
    with pytest.raises(TypeError, match="frozen"):
        dataclass(type("Loose", (part,), {}))


def test_a_parameter_that_is_no_field_is_refused() -> None:
    plain = type("Plain", (), {"__annotations__": {"scale": dataclasses.InitVar[float], "size": float}})
    with pytest.raises(TypeError, match=r"Plain\.scale: a parameter that is no field"):
        dataclass(plain)
