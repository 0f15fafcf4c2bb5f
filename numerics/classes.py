"""Dataclasses whose methods are written at their first use.

`dataclasses.dataclass` writes and compiles about five functions for every class, half a millisecond. A start imports
some hundreds of classes and makes objects of a few, so that was a fifth of the time to the first step. Here a class
gets its constructor when it makes its first object, and its other methods are functions that all classes share. What
`dataclasses` knows of a class (`fields`, `replace`, `asdict`, classes made from it) stays.
"""

from __future__ import annotations

import dataclasses
import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import MISSING, FrozenInstanceError, fields
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(
        cls: type | None = None, /, *, frozen: bool = False, eq: bool = True, kw_only: bool = False
    ):
        """As `dataclasses.dataclass` with these options."""

        def made(one: type) -> type:
            return _made(one, frozen=frozen, eq=eq, kw_only=kw_only)

        return made if cls is None else made(cls)


def _made(cls: Any, *, frozen: bool, eq: bool, kw_only: bool) -> type:
    """A class with its fields found and its methods put in."""
    if not cls.__doc__:
        cls.__doc__ = cls.__name__  # else its signature is made for it
    with _not_frozen(cls, frozen=frozen):
        dataclasses.dataclass(init=False, repr=False, eq=False, kw_only=kw_only)(cls)
    cls.__dataclass_params__.frozen, cls.__dataclass_params__.eq = frozen, eq
    for name, one in vars(cls)["__dataclass_fields__"].items():
        if str(one.type).removeprefix("dataclasses.").startswith("InitVar"):  # `fields` has none of them
            raise TypeError(f"{cls.__name__}.{name}: a parameter that is no field is not passed on")
    own, known = vars(cls), fields(cls)
    has_hash = own.get("__hash__") is not None
    methods: dict[str, Any] = {"__init__": _constructor(cls), "__repr__": _shown(known)}
    if frozen:
        methods |= _refusals(cls, known)
    if eq:
        methods["__eq__"] = _equality(known)
    for name, method in methods.items():
        if name in {"__setattr__", "__delattr__"} and name in own:
            raise TypeError(f"{cls.__name__}.{name}: a frozen class has none of its own")
        if name not in own:
            _put(cls, name, method)
    if eq and not has_hash:
        _put(cls, "__hash__", _hash(known) if frozen else None)
    made: type = cls
    return made


def _put(cls: Any, name: str, method: Any) -> None:
    """Make a function a method of a class."""
    if method is not None:
        method.__name__, method.__qualname__ = name, f"{cls.__qualname__}.{name}"
        method.__module__ = cls.__module__
    setattr(cls, name, method)


@contextmanager
def _not_frozen(cls: Any, *, frozen: bool) -> Iterator[None]:
    """See that a class is as frozen as its bases, and let `dataclasses` write no methods that refuse changes.

    Raises
    ------
    TypeError
        If one can be changed and the other cannot.
    """
    params = [
        vars(base)["__dataclass_params__"] for base in cls.__mro__[1:] if "__dataclass_params__" in vars(base)
    ]
    if any(one.frozen is not frozen for one in params):
        raise TypeError(f"{cls.__name__}: a frozen class and one that is not cannot be made from each other")
    for one in params:
        one.frozen = False
    try:
        yield
    finally:
        for one in params:
            one.frozen = frozen


def _constructor(cls: Any) -> Any:
    """Constructor that writes the true one and takes its place."""

    def construct(self: Any, *values: Any, **named: Any) -> None:
        true = _written(cls)
        if vars(cls).get("__init__") is construct:
            cls.__init__ = true
        true(self, *values, **named)

    return construct


_FACTORY = object()
"""Default of a parameter whose value is made anew for each object."""


def _written(cls: Any) -> Callable[..., None]:
    """The constructor of a class, from its fields."""
    space: dict[str, Any] = {"__set": object.__setattr__, "__factory": _FACTORY}
    positional, named, lines = ["__self"], list[str](), list[str]()
    for one in fields(cls):
        name = one.name
        if one.init:
            if one.default is not MISSING:
                space[f"__default_{name}"] = one.default
                text = f"{name}=__default_{name}"
            else:
                text = name if one.default_factory is MISSING else f"{name}=__factory"
            (named if one.kw_only else positional).append(text)
        value = name
        if one.default_factory is not MISSING:
            space[f"__make_{name}"] = one.default_factory
            made = f"__make_{name}()"
            value = f"{made} if {name} is __factory else {name}" if one.init else made
        elif not one.init:
            continue
        lines.append(
            f"__set(__self, {name!r}, {value})"
            if cls.__dataclass_params__.frozen
            else f"__self.{name} = {value}"
        )
    if hasattr(cls, "__post_init__"):
        lines.append("__self.__post_init__()")
    parameters = ", ".join([*positional, *(["*", *named] if named else [])])
    body = "\n    ".join(lines or ["pass"])
    exec(f"def __init__({parameters}):\n    {body}\n", space)  # noqa: S102  names of fields
    made_of: Callable[..., None] = space["__init__"]
    made_of.__qualname__ = f"{cls.__qualname__}.__init__"
    made_of.__module__ = cls.__module__
    made_of.__annotations__ = {one.name: one.type for one in fields(cls) if one.init} | {"return": None}
    return made_of


def _shown(known: tuple[Any, ...]) -> Any:
    names = [one.name for one in known if one.repr]

    @recursive_repr()
    def shown(self: Any) -> str:
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    return shown


def _refusals(cls: Any, known: tuple[Any, ...]) -> dict[str, Any]:
    """What refuses changes to fields, and to all else unless a class made from this one allows it."""
    names = frozenset(one.name for one in known)

    def put(self: Any, name: str, value: Any) -> None:
        if type(self) is cls or name in names:
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        super(cls, self).__setattr__(name, value)

    def drop(self: Any, name: str) -> None:
        if type(self) is cls or name in names:
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        super(cls, self).__delattr__(name)

    return {"__setattr__": put, "__delattr__": drop}


def _values(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """Function that reads fields of an object as a tuple."""
    if len(names) > 1:
        return operator.attrgetter(*names)
    return lambda one: tuple(getattr(one, name) for name in names)


def _equality(known: tuple[Any, ...]) -> Any:
    values = _values([one.name for one in known if one.compare])

    def equal(self: Any, other: object) -> Any:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    return equal


def _hash(known: tuple[Any, ...]) -> Any:
    values = _values([one.name for one in known if (one.compare if one.hash is None else one.hash)])

    def hashed(self: Any) -> int:
        return hash(values(self))

    return hashed
