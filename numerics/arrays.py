"""Named groups of arrays that kernels take by their address.

A kernel that is handed a tuple of thirty arrays gets some two hundred numbers, in each call. A group of class
`Arrays` is handed over as one pointer to a block of words that never changes: for each field an address and the
lengths of an array, a number, or the address of another group. Kernels read ``group.field`` as Python does; the
compiler knows that the words are constant, so it loads each of them once.

Field types are annotations: ``float``, ``int``, ``bool``, one of the array types below, another class of `Arrays`, or
a `heavylift.solver.kinds.Table`. Class variables are constants that are known when a kernel is compiled.
"""

from __future__ import annotations

import importlib
import inspect
import operator
import re
import struct
import sys
import typing
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Self, dataclass_transform

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.hints import array_scalar
from heavylift.numerics.jit import when_compiling

__all__ = [
    "FLOAT",
    "INTEGER",
    "NOTHING",
    "TRUTH",
    "ArrayType",
    "Arrays",
    "Floats1",
    "Floats2",
    "Floats3",
    "Ints1",
    "Ints2",
    "KernelType",
    "NumberType",
    "Pointer",
    "Reference",
    "Words",
    "array_type",
    "declared_types",
    "described",
    "kernel_type",
    "number_as_word",
    "word_count",
]

when_compiling("heavylift.numerics.arrays_code")

Floats1 = Annotated[NDArray[np.float64], 1]
Floats2 = Annotated[NDArray[np.float64], 2]
Floats3 = Annotated[NDArray[np.float64], 3]
Ints1 = Annotated[NDArray[np.int64], 1]
Ints2 = Annotated[NDArray[np.int64], 2]


class KernelType:
    """What kernels see of a value. `heavylift.numerics.arrays_code.compiled_type` makes the compiler's type of it.

    Attributes
    ----------
    name
        For messages.
    """

    def __init__(self, name: str, *parts: object) -> None:
        self.name = name
        self._parts = type(self), *(parts or (name,))

    def __eq__(self, other: object) -> bool:
        """The same class, made of the same parts."""
        return isinstance(other, KernelType) and self._parts == other._parts

    def __hash__(self) -> int:
        """Of its class and parts."""
        return hash(self._parts)

    def __str__(self) -> str:
        """Its name."""
        return self.name

    __repr__ = __str__


class NumberType(KernelType):
    """A number or truth value of a NumPy type."""

    def __init__(self, dtype: Any) -> None:
        self.dtype = np.dtype(dtype)
        super().__init__(self.dtype.name)


class ArrayType(KernelType):
    """A contiguous array of numbers."""

    def __init__(self, dtype: Any, ndim: int) -> None:
        self.dtype, self.ndim = np.dtype(dtype), ndim
        super().__init__(f"array({self.dtype.name}, {ndim}d, C)")


FLOAT, INTEGER, TRUTH = NumberType(np.float64), NumberType(np.int64), NumberType(np.bool_)
NOTHING = KernelType("none")
"""What a kernel without a result returns."""


@dataclass_transform(frozen_default=True, eq_default=False)
class Arrays:
    """Base of all groups. A subclass lists its fields as a frozen dataclass does.

    Attributes
    ----------
    carried_fields
        Of kinds: fields that outlive a step, of records or numbers. A checkpoint keeps them.
    """

    _fields: typing.ClassVar[tuple[str, ...]] = ()
    carried_fields: typing.ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        """Make the constructor.

        Raises
        ------
        TypeError
            If there is no such field as one that is to outlive a step.
        """
        super().__init_subclass__()
        dataclass(frozen=True, eq=False)(cls)
        cls._fields = tuple(field.name for field in fields(cls))  # type: ignore[arg-type]
        unknown = set(cls.carried_fields) - set(cls._fields)
        if unknown:
            raise TypeError(f"{cls.__name__}: carried {sorted(unknown)}, expected some of {cls._fields}")

    def __iter__(self) -> Iterator[Any]:
        """Values of the fields, in order."""
        return (getattr(self, name) for name in self._fields)

    def _replace(self, **changes: Any) -> Self:
        """The same group with other values in some fields."""
        return replace(self, **changes)  # type: ignore[type-var]

    def __getstate__(self) -> dict[str, Any]:
        """A copy makes a block of its own."""
        return {name: getattr(self, name) for name in self._fields}

    @property
    def address(self) -> int:
        """Address of the block of words that kernels read; made at the first use.

        Raises
        ------
        TypeError
            If a value is not what its annotation says.
        """
        address: int | None = self.__dict__.get("_address")
        if address is None:
            block = np.array(self._words(), dtype=np.int64)
            address = int(block.ctypes.data)
            object.__setattr__(self, "_block", block)
            object.__setattr__(self, "_address", address)
        return address

    def _words(self) -> list[int]:
        words: list[int] = []
        for name, (of_type, _) in layout(type(self)).items():
            value = getattr(self, name)
            if isinstance(of_type, ArrayType):
                fits = (
                    isinstance(value, np.ndarray) and value.ndim == of_type.ndim and value.flags.c_contiguous
                )
                if not fits or value.dtype != of_type.dtype:
                    found = (
                        f"{value.dtype} {value.ndim}-d"
                        if isinstance(value, np.ndarray)
                        else type(value).__name__
                    )
                    raise TypeError(
                        f"{type(self).__name__}.{name}: {found}, expected a contiguous array {of_type}"
                    )
                words += [value.ctypes.data, *value.shape]
            elif isinstance(of_type, Pointer):
                held = of_type.accept(value, f"{type(self).__name__}.{name}")
                self.__dict__.setdefault("_held", []).append(held)
                words.append(held.address)
            elif isinstance(of_type, Words):
                words += of_type.words(value, f"{type(self).__name__}.{name}")
            else:
                words.append(number_as_word(of_type, value))
        return words


class Words(KernelType):
    """What is handed over as several words, and rebuilt from them.

    Attributes
    ----------
    word_count
        How many.
    words
        From a value and the words that name its place to its words; a TypeError if kernels would misread it.
    """

    word_count: typing.ClassVar[int]
    words: Callable[..., list[int]]


class Pointer(KernelType):
    """What is handed over by its address: it has an attribute `address`."""

    def accept(self, value: Any, where: str) -> Any:
        """What has the address: the value itself, or something that holds it.

        Raises
        ------
        TypeError
            If kernels would misread it; names the place and both types.
        """
        raise TypeError(f"{where}: {type(value).__name__}, expected {self}")


class Reference(Pointer):
    """A group of arrays."""

    def __init__(self, group: type[Arrays]) -> None:
        self.group = group
        super().__init__(f"{group.__module__}.{group.__qualname__}", group)

    def accept(self, value: Any, where: str) -> Any:
        """Only the class itself and its subclasses."""
        if not isinstance(value, self.group) or not begins_as(type(value), self.group):
            raise TypeError(f"{where}: {type(value).__name__}, expected {self.group.__name__}")
        return value


def _compare(group: Any, base: Any) -> bool:
    """Whether code for a class reads the block of another one rightly: a subclass whose fields keep their layouts."""
    if group is base:
        return True
    if not issubclass(group, base):
        return False
    own = layout(group)
    return all(
        own[name][1] == place and getattr(own[name][0], "read_as", own[name][0].__eq__)(of_type)
        for name, (of_type, place) in layout(base).items()
    )


begins_as: Callable[[Any, Any], bool] = cache(_compare)
"""As `_compare`."""


def number_as_word(of_type: Any, value: Any) -> int:
    """A number or truth value as the word that kernels read."""
    if of_type == FLOAT:
        return int(struct.unpack("q", struct.pack("d", value))[0])
    return int(bool(value)) if of_type == TRUTH else operator.index(value)


def array_type(annotation: Any) -> ArrayType | None:
    """Type of an array annotation of this module; None if it is none."""
    if typing.get_origin(annotation) is not Annotated:
        return None
    array, dimensions = typing.get_args(annotation)[:2]
    return ArrayType(array_scalar(array), dimensions)


_SIMPLE = {float: FLOAT, int: INTEGER, bool: TRUTH, None: NOTHING, type(None): NOTHING}


def kernel_type(annotation: Any) -> Any:
    """Type of the annotation of a field or parameter, as a `KernelType`.

    Raises
    ------
    TypeError
        If kernels know no such type.
    """
    if annotation in _SIMPLE:
        return _SIMPLE[annotation]
    found: Any = array_type(annotation)
    if found is None and isinstance(annotation, type):
        if issubclass(annotation, Arrays):
            found = Reference(annotation)
        elif hasattr(annotation, "kernel_type"):
            found = annotation.kernel_type()
    elif found is None and hasattr(annotation, "kernel_type"):
        found = annotation.kernel_type()
    if found is None:
        raise TypeError(f"{annotation!r}: expected a number, an array of known dimension, Arrays or a Table")
    return found


class _ImportedForTypes(dict[str, Any]):
    """Names that a module imports for the type checker alone: groups of arrays refer to each other in circles."""

    def __init__(self, module: Any) -> None:
        super().__init__()
        self._module = module

    def __missing__(self, name: str) -> Any:
        if name in vars(self._module):
            raise KeyError(name)  # a name of the module itself
        source = Path(self._module.__file__).read_text(encoding="utf-8")
        for where, names in re.findall(r"^ +from ([\w.]+) import (\([^)]*\)|[^\n]*)", source, re.MULTILINE):
            if re.search(rf"\b{name}\b", names):
                return getattr(importlib.import_module(where), name)
        raise KeyError(name)


_RESOLVED: dict[tuple[str, str], Any] = {}
"""What words mean in a module: hundreds of fields say the same few."""


def declared_types(owner: Any) -> dict[str, Any]:
    """Annotations of a class or function, resolved; also those whose names are imported for the type checker alone."""
    if not isinstance(owner, type):
        module = sys.modules[owner.__module__]
        names = _ImportedForTypes(module)
        return {
            name: eval(text, vars(module), names) if isinstance(text, str) else text  # noqa: S307  our own words
            for name, text in owner.__annotations__.items()
        }
    found: dict[str, Any] = {}
    for part in reversed(owner.__mro__):
        module = sys.modules[part.__module__]
        names = _ImportedForTypes(module)
        for name, text in inspect.get_annotations(part).items():
            if not isinstance(text, str):
                found[name] = text
                continue
            key = part.__module__, text
            if key not in _RESOLVED:
                _RESOLVED[key] = eval(text, vars(module), names)  # noqa: S307  our own words
            found[name] = _RESOLVED[key]
    return found


def _layout(group: Any) -> dict[str, tuple[Any, int]]:
    """Type and first word of each field."""
    hints = declared_types(group)
    made: dict[str, tuple[Any, int]] = {}
    place = 0
    for name in group._fields:
        try:
            of_type = kernel_type(hints[name])
        except TypeError as error:
            raise TypeError(f"{group.__name__}.{name}: {error}") from None
        made[name] = of_type, place
        place += word_count(of_type)
    return made


def word_count(of_type: Any) -> int:
    """Words that a value is handed over as."""
    if isinstance(of_type, ArrayType):
        return 1 + of_type.ndim
    return of_type.word_count if isinstance(of_type, Words) else 1


layout: Callable[[Any], dict[str, tuple[Any, int]]] = cache(_layout)
"""Type and first word of each field of a group of arrays, by name."""


@cache
def described(of_type: Any) -> str:
    """All that compiled code knows of a type: of a group its fields and where they are, and those of groups in it."""
    if not isinstance(of_type, Reference):
        return of_type.described() if hasattr(of_type, "described") else str(of_type)
    parts = [f"{name} {place} {described(one)}" for name, (one, place) in layout(of_type.group).items()]
    constants = [
        f"{name}={value!r}"
        for base in of_type.group.__mro__
        for name, value in vars(base).items()
        if isinstance(value, (bool, int, float, tuple)) and not name.startswith("_")
    ]
    return f"{of_type}({', '.join(parts + constants)})"
