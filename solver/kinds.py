"""Operations, and tables of the kinds that know them: a scene is data.

A *kind* is a class of `Arrays` for all components of one type. An *operation* is a function of which every kind brings
its own version (`implement`). What a kind does is compiled once, into an object file of its own. A scene is a
`Table`: for each operation a list of pairs, the address of a compiled function and that of the arrays that it
serves. A call of an operation on a table is a loop over such a list, so a scene executes only what it contains, and
nothing is compiled for it.

A call of an operation on a single kind, or a tuple of some, whose classes are known when the caller is compiled, is
a direct call.
"""

from __future__ import annotations

import ctypes
import importlib
import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, update_wrapper
from typing import Any, ClassVar, Self, TypeVar, cast, overload

import llvmlite.binding as llvm
import numpy as np

from heavylift.numerics.arrays import (
    NOTHING,
    Arrays,
    Pointer,
    Reference,
    declared_types,
    kernel_type,
    layout,
)
from heavylift.numerics.jit import Kernel, in_python, when_compiling
from heavylift.numerics.objects import TROUBLES, Unit, load_unit, native_function
from heavylift.numerics.objects import signature as declared_signature

__all__ = [
    "STEP",
    "KindOperation",
    "Members",
    "Table",
    "generic",
    "implement",
    "kind_units",
    "kinds_with_operations",
    "method",
    "optional",
    "tables_in",
]

when_compiling("heavylift.solver.kinds_code")

F = TypeVar("F", bound=Callable[..., Any])

WORD_BYTES = 8

STEP = "step"
"""Group of the operations that all scenes need."""


class Table(Sequence[Any]):
    """Kinds that are served together; a subclass says which operations it knows: those whose first parameter it is.

    Attributes
    ----------
    members
        Base of the kinds that it takes.

    Raises
    ------
    TypeError
        If a kind is not made from that base.
    """

    operations: ClassVar[list[Any]] = []
    members: ClassVar[type] = object

    def __init_subclass__(cls) -> None:
        """Every class of tables has operations of its own."""
        cls.operations = []

    def __init__(self, kinds: Iterable[Any] = (), groups: Iterable[str] | None = None) -> None:
        self.kinds = tuple(kinds)
        for kind in self.kinds:
            if not isinstance(kind, self.members):
                raise TypeError(
                    f"{type(kind).__name__} among {type(self).__name__}: expected a {self.members.__name__}"
                )
        self.groups = None if groups is None else frozenset(groups)
        self._place = 0
        self._kept: list[Any] = []
        self._known = -1

    @classmethod
    def kernel_type(cls) -> TableType:
        """Type in kernels."""
        return TableType(cls)

    @overload
    def __getitem__(self, place: int) -> Any: ...

    @overload
    def __getitem__(self, place: slice) -> Self: ...

    def __getitem__(self, place: int | slice) -> Any:
        """A kind, or a table of some."""
        if isinstance(place, slice):
            return type(self)(self.kinds[place], self.groups)
        return self.kinds[place]

    def __len__(self) -> int:
        """Number of kinds."""
        return len(self.kinds)

    def __iter__(self) -> Iterator[Any]:
        """Kinds in order."""
        return iter(self.kinds)

    def need(self, group: str) -> None:
        """Serve the operations of one more group from now on."""
        if self.groups is not None and group not in self.groups:
            self.groups |= {group}
            self._known = -1

    def units(self) -> list[Unit]:
        """What has to be compiled for its kinds, and for those in tables that they hold."""
        found: dict[str, Unit] = {}
        for kind in self.kinds:
            for group, unit in kind_units(type(kind)).items():
                if self.groups is None or group in self.groups:
                    found[unit.name] = unit
            found |= {unit.name: unit for table in tables_in(kind) for unit in table.units()}
        return list(found.values())

    @property
    def address(self) -> int:
        """Address of the lists that kernels walk. What the kinds need is compiled or loaded first.

        Raises
        ------
        TypeError
            If a kind lacks an operation that it must have.
        """
        if self._known != len(
            self.operations
        ):  # a module that declares operations may have been imported meanwhile
            lists = []
            for operation in self.operations:
                served = [kind for kind in self.kinds if operation.serves(type(kind))]
                if isinstance(operation, Members):
                    lists.append([word for kind in served for word in (0, kind.address)])
                elif self.groups is None or operation.group in self.groups:
                    lists.append(
                        [word for kind in served for word in (operation.address(type(kind)), kind.address)]
                    )
                else:
                    lists.append(
                        [word for kind in served[:1] for word in (_refusal(operation.name), kind.address)]
                    )
            memory = np.zeros(2 * len(lists) + sum(map(len, lists)), dtype=np.int64)
            place = 2 * len(lists)
            for i, pairs in enumerate(lists):
                memory[place : place + len(pairs)] = pairs
                memory[2 * i] = memory.ctypes.data + WORD_BYTES * place
                place += len(pairs)
                memory[2 * i + 1] = memory.ctypes.data + WORD_BYTES * place
            self._kept.append(memory)  # a group of arrays, or a call, may hold the address of an older one
            self._place, self._known = int(memory.ctypes.data), len(self.operations)
        return self._place


def tables_in(group: Arrays) -> list[Table]:
    """Tables that a group of arrays holds, also in groups that it holds."""
    found: list[Table] = []
    for name, (of_type, _) in layout(type(group)).items():
        value = getattr(group, name)
        if isinstance(of_type, TableType):
            found.append(of_type.accept(value, name))
        elif isinstance(of_type, Reference):
            found += tables_in(value)
    return found


_REFUSALS: dict[str, Any] = {}


def _refusal(name: str) -> int:
    """Address of a function that refuses an operation of a group which a table does not serve."""
    if name not in _REFUSALS:

        def refuse() -> None:
            TROUBLES.append(f"{name} was called on a table that does not serve its group of operations")

        _REFUSALS[name] = ctypes.CFUNCTYPE(None)(refuse)
    return int(ctypes.cast(_REFUSALS[name], ctypes.c_void_p).value or 0)


class TableType(Pointer):
    """A table."""

    def __init__(self, table: type[Table]) -> None:
        self.table = table
        super().__init__(f"{table.__module__}.{table.__qualname__}", table)

    def accept(self, value: Any, where: str) -> Any:
        """A table of the class; kinds of a tuple become one."""
        if isinstance(value, tuple):
            return self.table(value)
        if not isinstance(value, self.table):
            raise TypeError(f"{where}: {type(value).__name__}, expected {self.table.__name__}")
        return value


NO_KINDS = "heavylift.nothing"
"""Symbol of an empty table."""
_NOTHING = np.zeros(1024, dtype=np.int64)
llvm.add_symbol(NO_KINDS, _NOTHING.ctypes.data)


class KindOperation:
    """What `generic` and `optional` make of a declaration; see there."""

    def __init__(self, contract: Callable[..., None], *, needed: bool, group: str) -> None:
        update_wrapper(self, contract)
        self.contract, self.needed, self.group = contract, needed, group
        self.name = contract.__name__
        self.implementations: dict[type, Callable[..., Any]] = {}
        self._native: dict[type, Callable[..., Any]] = {}
        self._slot = np.zeros(1, dtype=np.int64)
        self.table = table = self._table()
        if table is not None:
            self._slot[0] = 2 * len(table.operations)
            table.operations.append(self)
        self.symbol = f"heavylift.slot.{contract.__module__.removeprefix('heavylift.')}.{self.name}"
        llvm.add_symbol(self.symbol, self._slot.ctypes.data)

    def _table(self) -> type[Table] | None:
        """Class of tables of the first parameter; None for operations that serve single kinds only."""
        first = next(iter(inspect.signature(self.contract).parameters.values())).annotation
        found = self.contract.__globals__.get(first) if isinstance(first, str) else first
        if found is None:
            raise TypeError(
                f"{self.contract.__module__}.{self.name}: {first!r} is not known when the operation is declared"
            )
        return found if isinstance(found, type) and issubclass(found, Table) else None

    @property
    def parameters(self) -> tuple[Any, ...]:
        """Types of all parameters but the first.

        Raises
        ------
        TypeError
            Names the operation and the parameter.
        """
        return _parameters(self)

    def chosen(self, kind: type) -> Callable[..., Any] | None:
        """Version of a kind, or of a base of it; None if it has none.

        Raises
        ------
        TypeError
            If it must have one.
        """
        import_kernels(kind)
        for base in kind.__mro__:
            if base in self.implementations:
                return self.implementations[base]
        if self.needed:
            raise TypeError(f"{self.name} is not implemented for {kind.__name__}")
        return None

    def serves(self, kind: type) -> bool:
        """Whether a kind has a version for kernels."""
        return isinstance(self.chosen(kind), Kernel)

    def address(self, kind: type) -> int:
        """Address of the compiled version of a kind."""
        return load_unit(kind_units(kind)[self.group]).addresses[_symbol(kind, self)]

    def __call__(self, kinds: Any, *arguments: Any) -> None:
        """Serve the kinds of a table or a tuple, or a single kind, from Python."""
        for kind in (kinds,) if isinstance(kinds, Arrays) else kinds:
            function = self.chosen(type(kind))
            if isinstance(function, Kernel):
                native = self._native.get(type(kind))
                if native is None:
                    types_of = (Reference(type(kind)), *self.parameters)
                    native = native_function(self.address(type(kind)), types_of, NOTHING)
                    self._native[type(kind)] = native
                native(kind, *arguments)
            elif function is not None:
                function(kind, *arguments)


class Members:
    """Those kinds of a table whose class has a given base, for kernels that read what all of them begin with.

    In kernels ``members(table)`` is their number, and ``members(table, i)`` one of them.
    """

    def __init__(self, table: type[Table], base: type) -> None:
        self.base = base
        self.table, self._slot = table, np.array([2 * len(table.operations)], dtype=np.int64)
        table.operations.append(self)
        self.symbol = f"heavylift.members.{table.__name__}.{base.__name__}"
        llvm.add_symbol(self.symbol, self._slot.ctypes.data)

    def serves(self, kind: type) -> bool:
        """Whether a kind is one of them."""
        return issubclass(kind, self.base)

    def __call__(self, table: Table, place: int | None = None) -> Any:
        """The same in Python."""
        found = [kind for kind in table if isinstance(kind, self.base)]
        return len(found) if place is None else found[place]


@cache
def _parameters(operation: KindOperation) -> tuple[Any, ...]:
    hints = declared_types(operation.contract)
    made = []
    for name in list(inspect.signature(operation.contract).parameters)[1:]:
        try:
            made.append(kernel_type(hints[name]))
        except (KeyError, TypeError) as error:
            raise TypeError(f"{operation.contract.__module__}.{operation.name}, {name}: {error}") from None
    return tuple(made)


def optional(group: str = STEP) -> Callable[[Callable[..., None]], KindOperation]:
    """As `generic`, but kinds that do not implement the operation are passed over."""
    return lambda contract: KindOperation(contract, needed=False, group=group)


def generic(group: str = STEP) -> Callable[[Callable[..., None]], KindOperation]:
    """Turn a documented signature into an operation.

    Parameters
    ----------
    group
        Operations of one group are compiled together: those that every step needs, those that contacts ask for,
        those of one integrator. A table serves the groups that it is made for.

    Returns
    -------
    callable
        Takes a function whose docstring says what implementations have to do. Its first parameter is a class of
        tables, in whose place implementations take one kind; the annotations of the others are types of
        `heavylift.numerics.arrays`. Its body is not used. The `KindOperation` that it returns can be called from
        kernels and from plain Python; a kind without an implementation that is put into a table is a `TypeError`.
    """
    return lambda contract: KindOperation(contract, needed=True, group=group)


def implement(operation: KindOperation, kind: type) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Register a kernel as the version of an operation for one kind.

    Parameters
    ----------
    operation
        Made by `generic` or `optional`.
    kind
        The class of arrays.

    Raises
    ------
    TypeError
        If the kernel has another number of parameters than the operation.
    """

    def register(function: Callable[..., Any]) -> Callable[..., Any]:
        if kind in operation.implementations:
            raise TypeError(
                f"{operation.name} of {kind.__name__} is there already: {operation.implementations[kind].__name__}"
            )
        own = inspect.signature(in_python(function)).parameters
        if len(own) != len(inspect.signature(operation.contract).parameters):
            raise TypeError(f"{function.__name__} takes {len(own)} arguments, {operation.name} has others")
        operation.implementations[kind] = function
        _OPERATIONS_OF.setdefault(kind, []).append(operation)
        return function

    return register


_OPERATIONS_OF: dict[type, list[KindOperation]] = {}
_METHODS_OF: dict[type, list[Method]] = {}
_KINDS: dict[str, type] = {}


class Method:
    """What `method` makes of a kernel; see there."""

    def __init__(self, function: Any, group: str) -> None:
        update_wrapper(self, function)
        self.kernel, self.group, self.name = function, group, function.__name__
        self._native: dict[type, Callable[..., Any]] = {}
        (of, *_), _ = declared_signature(in_python(function))
        _METHODS_OF.setdefault(of.group, []).append(self)

    def __call__(self, kind: Any, *arguments: Any) -> Any:
        """Serve one kind from Python."""
        if not isinstance(self.kernel, Kernel):
            return self.kernel(kind, *arguments)
        if type(kind) not in self._native:
            unit, symbol = kind_units(type(kind))[self.group], _symbol(type(kind), self)
            _, parameters, result = unit.entries[symbol]
            self._native[type(kind)] = native_function(load_unit(unit).addresses[symbol], parameters, result)
        return self._native[type(kind)](kind, *arguments)


def method(group: str) -> Callable[[F], F]:
    """Let Python call a kernel on a single kind, before time starts: no operation, for no kernel and no table knows it.

    Parameters
    ----------
    group
        It is compiled with the operations of this group of its kind.

    Returns
    -------
    callable
        Takes a kernel with annotations of all types, the first of them the class of the kind or a base of some.
    """
    return lambda function: cast("Any", Method(function, group))


@cache
def import_kernels(kind: Any) -> None:
    """Import the modules that hold the versions of a kind.

    Raises
    ------
    TypeError
        If it lacks an operation that kinds of its tables must have, or another kind of the package has its name.
    """
    for module in getattr(kind, "kernel_modules", ()):
        importlib.import_module(module)
    known = [operation for base in kind.__mro__ for operation in _OPERATIONS_OF.get(base, ())]
    for table in {operation.table for operation in known if operation.table is not None}:
        for operation in table.operations:
            if isinstance(operation, KindOperation) and operation.needed and operation not in known:
                raise TypeError(f"{operation.name} is not implemented for {kind.__name__}")
    if _KINDS.setdefault(_name(kind), kind) is not kind:
        where = f"in {kind.__module__} and {_KINDS[_name(kind)].__module__}"
        raise TypeError(f"two kinds have the name {kind.__name__}: {where}")


def _name(kind: type) -> str:
    """Name of a kind: of those of the package each is the only one of its name."""
    return kind.__name__ if kind.__module__.startswith("heavylift.") else f"{kind.__module__}.{kind.__name__}"


def _symbol(kind: type, operation: KindOperation | Method) -> str:
    return f"{_name(kind)}.{operation.name}"


def kinds_with_operations() -> list[type]:
    """Kinds of the package that have versions of operations, of the imported modules; bases of kinds are none."""
    found = {kind: None for base in _OPERATIONS_OF for kind in _final(base)}
    return [kind for kind in found if kind.__module__.startswith("heavylift.")]


def _final(base: type) -> list[type]:
    """Classes that are made from one, itself included, and that no other one is made from."""
    own: list[type] = base.__subclasses__()
    return [kind for one in own for kind in _final(one)] if own else [base]


def _kind_units(kind: Any) -> dict[str, Unit]:
    """What is compiled of a kind, by group of operations."""
    import_kernels(kind)
    entries: dict[str, dict[str, Any]] = {}
    modules: dict[str, set[str]] = {}
    direct = {
        kind.__module__
    }  # of versions that the others call, through modules that only declare operations
    for base in reversed(kind.__mro__):
        for operation in _OPERATIONS_OF.get(base, ()):
            function = operation.chosen(kind)
            if not isinstance(function, Kernel):
                continue
            if not operation.table is not None:
                direct.add(function.py_func.__module__)
                continue
            types_of = (Reference(kind), *operation.parameters)
            entries.setdefault(operation.group, {})[_symbol(kind, operation)] = function, types_of, NOTHING
            modules.setdefault(operation.group, set()).add(function.py_func.__module__)
        for called in _METHODS_OF.get(base, ()):
            if isinstance(called.kernel, Kernel):
                (_, *parameters), result = declared_signature(called.kernel.py_func)
                entry = called.kernel, (Reference(kind), *parameters), result
                entries.setdefault(called.group, {})[_symbol(kind, called)] = entry
                modules.setdefault(called.group, set()).add(called.kernel.py_func.__module__)
    return {
        group: Unit(
            _name(kind) if group == STEP else f"{_name(kind)}.{group}",
            own,
            tuple(sorted(modules[group] | direct)),
            (kind.__module__, kind.__name__, group),
        )
        for group, own in entries.items()
    }


kind_units: Callable[[Any], dict[str, Unit]] = cache(_kind_units)
"""What is compiled of a kind, by group of operations."""
