"""What a phase of an operation does when it begins: what all actions have in common, and where they register.

An action is one file in `heavylift.solver.scenario.actions`. Its class has the keys of the table in a case file, says
what it acts on, checks itself against what is so then (`check`), and says in one `Command` what an actuator gets. The
run packs the command as a record, and the kernels of `heavylift.solver.scenario.moves` plan a move from it and from
where the actuator is; what is planned before a run calls the same kernels with the same record.
"""

from __future__ import annotations

import importlib
import inspect
import math
import sys
from collections.abc import Mapping
from dataclasses import MISSING, field, fields
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple, TypeVar, get_args, get_origin

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import ByCoordinate, Quantity
from heavylift.solver.scene.commands import Command

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable

    from heavylift.solver.scene.operation_state import OperationState

__all__ = [
    "ACTIONS",
    "Action",
    "ActionKey",
    "ActionKeys",
    "Hook",
    "MotionKeys",
    "NamesOf",
    "Ramp",
    "SpeedKeys",
    "Targets",
]


class Hook(NamedTuple):
    """Of some falls: parts of rope that carry the block, and depth of the hook below its sheaves [m]."""

    parts: int
    depth: float


@dataclass(frozen=True, kw_only=True)
class Targets:
    """What a case has that an action can name.

    Attributes
    ----------
    ropes, tanks, drives
        Names of ropes of type wire, of tanks, and of drives.
    other_ropes
        Names of ropes of other types, which cannot be commanded; to say so.
    together
        By drive those that it does not move without: of a gantry crane, whose girder and trolleys are driven each.
    hooks
        Falls by name.
    paths
        Names of transporters with a path.
    joints
        Names.
    helpers
        Names of pumps and of levelled transporters, and which of both.
    controllers
        Pumps of each controller by its name.
    """

    ropes: tuple[str, ...] = ()
    tanks: tuple[str, ...] = ()
    drives: tuple[str, ...] = ()
    hooks: Mapping[str, Hook] = field(default_factory=dict)
    other_ropes: tuple[str, ...] = ()
    together: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    paths: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    helpers: Mapping[str, Literal["pump", "levelling"]] = field(default_factory=dict)
    controllers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def machines(self) -> dict[str, list[tuple[str, Any]]]:
        """What may fail, by the names that a user gives it: names and sorts of all that it is."""
        found: dict[str, list[tuple[str, Any]]] = {
            name: [(pump, "pump") for pump in pumps] for name, pumps in self.controllers.items()
        }
        found |= {name: [(name, sort)] for name, sort in self.helpers.items()}
        found |= {name: [(name, "tank")] for name in self.tanks}
        found |= {name: [(name, "drive")] for name in self.drives}
        found |= {name: [(self.rope_of(name), "winch")] for name in self.hooks}
        return found | {name: [(name, "winch")] for name in self.ropes}

    def fitting(self, key: str, patterns: Iterable[str], known: Iterable[str], what: str = "") -> list[str]:
        """Names that fit some patterns of a key, each once; a name without a pattern stands for itself.

        Parameters
        ----------
        key
            Of the patterns.
        patterns
            Names, or such with ``*``, ``?`` and ``[...]``.
        known
            Names that there are.
        what
            What they are of, in words, if not what the key is called.

        Raises
        ------
        InputError
            If nothing fits one of them.
        """
        found: dict[str, None] = {}
        known, what = list(known), what or key
        for pattern in patterns:
            fits = [name for name in known if fnmatchcase(name, pattern)]
            if not fits and what.startswith("rope") and pattern in self.other_ropes:
                fits = [pattern]
            if not fits:
                near = get_close_matches(pattern, known, 1)
                raise InputError(
                    f"{pattern!r} is no {what}" + (f"; did you mean {near[0]!r}?" if near else ""),
                    key=key,
                    expected=f"one of: {', '.join(known) or 'there are none'}",
                )
            found |= dict.fromkeys(fits)
        return list(found)

    def rope_of(self, hook: str) -> str:
        """Rope of some falls."""
        return f"{hook}_rope"

    def move_together(self, drives: Collection[str], key: str) -> None:
        """Refuse an action on a part of a crane whose other parts do not move, or stand, with it.

        Raises
        ------
        InputError
            With the key.
        """
        for name in drives:
            missing = [other for other in self.together.get(name, ()) if other not in drives]
            if missing:
                raise InputError(
                    f"{name!r} without {missing[0]!r}, which travels with it",
                    key=key,
                    expected=f"one action for all of: {', '.join([name, *self.together[name]])}",
                )


@dataclass(frozen=True)
class NamesOf:
    """Annotation of what an action acts on: a name, a pattern or a list in a case file, one name in an object.

    Attributes
    ----------
    what
        Field of `Targets` that has the names.
    words
        What these are, for messages, if not as the field without its plural.
    """

    what: str
    words: str = ""

    @property
    def called(self) -> str:
        """What these are."""
        return self.words or self.what.removesuffix("s")


class ActionKey(NamedTuple):
    """A key of the tables of actions.

    Attributes
    ----------
    name, hint, marks, default
        Name, type without annotations, annotations; and default, or `dataclasses.MISSING`.
    owner
        The class that declares it.
    """

    name: str
    hint: Any
    marks: tuple[Any, ...]
    default: Any
    owner: type

    def mark(self, kind: Any) -> Any:
        """Its annotation of a class, or None."""
        return next((mark for mark in self.marks if isinstance(mark, kind)), None)


class ActionKeys:
    """Keys of a table of a case file, of which the first is called as the action.

    A subclass is a frozen dataclass under `ACTIONS.describe`, its docstring the sentence of the action, with a
    sentence below each field.
    """

    WORD: ClassVar[str]
    FIELDS: ClassVar[tuple[ActionKey, ...]]
    ORDER: ClassVar[float] = math.inf
    """Place among the other actions in schema and messages; those without one follow by their words."""
    CALLED: ClassVar[Mapping[str, str]] = {}
    """Keys of errors of its objects, and what they are called in its table."""

    @classmethod
    def check_keys(cls, given: Any, keys: Collection[str]) -> None:  # noqa: ARG003
        """Compare keys of a table with each other; not on which things they act.

        Parameters
        ----------
        given
            Values of the table, as attributes: None where a key without default is absent.
        keys
            Those that the table has.

        Raises
        ------
        InputError
            With the key.
        """
        for key in cls.FIELDS[1:]:
            if key.default is MISSING and key.name not in keys:
                raise InputError(f"{cls.WORD!r} without {key.name!r}", key=key.name, expected=f"{key.name!r}")

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:
        """Actions of a table: one for each thing that is named.

        Parameters
        ----------
        given
            Values of the table, as attributes.
        targets
            What the case has.
        group
            A number of its own.

        Raises
        ------
        InputError
            If a name is that of nothing.
        """
        raise NotImplementedError(f"{cls.__qualname__} without 'made'")


class Action(ActionKeys):
    """Something that is done when a phase begins.

    A subclass that has the keys of a table itself is made from them as they are: with `NamesOf` at its first field one
    for each name.
    """

    @property
    def text(self) -> str:
        """Words for it in the log."""
        raise NotImplementedError(f"{type(self).__qualname__} without 'text'")

    def command(self) -> Command:
        """What an actuator gets; by itself an action is a line in the log alone."""
        return Command()

    def tone(self) -> float:
        """Frequency [Hz] that is heard where the page of a report plays past the action; 0 is none."""
        return 0.0

    def check(self, state: OperationState, key: str) -> None:
        """See that it finds what it needs, and change what is so after it.

        Parameters
        ----------
        state
            What is so as the action is done, as far as it is known before.
        key
            Of its table: ``"phases.0.actions.1"``.

        Raises
        ------
        InputError
            With the key.
        """

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:  # noqa: ARG003
        """As `ActionKeys.made`."""
        values = {
            key.name: getattr(given, key.name)
            for key in cls.FIELDS
            if key.default is MISSING or getattr(given, key.name) is not None
        }
        first = cls.FIELDS[0]
        mark = first.mark(NamesOf)
        if mark is None:
            return (cls(**values),)
        names = targets.fitting(first.name, values[first.name], getattr(targets, mark.what), mark.called)
        if mark.what == "drives":
            targets.move_together(names, first.name)
        return tuple(cls(**(values | {first.name: name})) for name in names)


@dataclass(frozen=True)
class Ramp(Action):
    """An action that changes a speed, and says how quickly.

    Attributes
    ----------
    ramp
        Of what derives from it: time that the change takes, or that from rest to the largest speed and back [s]; at
        once with 0.
    acceleration, jerk
        In place of it limits of the speed's rate of change, and of that of the acceleration; 0 is none.
    """

    acceleration: float = field(default=0.0, kw_only=True)
    jerk: float = field(default=0.0, kw_only=True)

    @property
    def in_ramp(self) -> str:
        """Words for the time."""
        ramp = self.limits["ramp"]
        return f" in {ramp:g} s" * bool(ramp)

    @property
    def limits(self) -> dict[str, Any]:
        """Fields of a command."""
        ramp = float(getattr(self, "ramp", 0.0))
        return {"ramp": ramp, "acceleration": self.acceleration, "jerk": self.jerk}


@dataclass(frozen=True, kw_only=True)
class SpeedKeys(ActionKeys):
    """Keys of all that come to a speed."""

    speed: Annotated[float | None, ByCoordinate(Quantity("angular velocity"), Quantity("velocity"))] = None
    """Of winch, hook, drive or transporter [m/s], [rad/s]; hauls in, or hoists, if positive. With a place to go to the
    largest one, as with `tension` and `level`."""
    ramp: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time in which the speed changes [s], with a constant acceleration; with a place to go to from rest to the
    speed."""
    acceleration: Annotated[
        float | None, ByCoordinate(Quantity("angular acceleration", 0.0), Quantity("acceleration", 0.0))
    ] = None
    """In place of `ramp`, of all changes of the speed [m/s^2], [rad/s^2]; of a hook that of the hook."""

    @staticmethod
    def check_limits(given: Any) -> None:
        """A time or an acceleration says how quickly a speed changes."""
        if given.ramp and given.acceleration is not None:
            raise InputError("both 'ramp' and 'acceleration'", expected="one of them", key="acceleration")


@dataclass(frozen=True, kw_only=True)
class MotionKeys(SpeedKeys):
    """Keys of all that go somewhere."""

    distance: Annotated[float | None, ByCoordinate(Quantity("angle"), Quantity("length"))] = None
    """How far it goes [m], [rad], and stops: hauls in or hoists if positive."""
    jerk: Annotated[float | None, ByCoordinate(Quantity("angular jerk", 0.0), Quantity("jerk", 0.0))] = None
    """Of all changes of the acceleration [m/s^3], [rad/s^3]."""

    TELLS: ClassVar[tuple[str, ...]]
    """Keys of which there is one, or else a speed alone."""

    @classmethod
    def check_keys(cls, given: Any, keys: Collection[str]) -> None:
        """One thing to do, with the keys that belong to it."""
        subject = cls.WORD
        commands = [key for key in cls.TELLS if getattr(given, key) is not None]
        if len(commands) > 1:
            raise InputError(
                f"both {commands[0]!r} and {commands[1]!r}", expected="one of them", key=commands[1]
            )
        command = commands[0] if commands else ""
        if command in {"brake", "follow"} or (command == "level" and given.level is False):
            odd = sorted(set(keys) - {subject, command} - ({"ratio"} if command == "follow" else set()))
            if odd:
                raise InputError(
                    f"{odd[0]!r} beside {command!r}", expected="an action of its own", key=odd[0]
                )
            return
        if given.speed is None:
            more = f"'speed', and one of {', '.join(map(repr, cls.TELLS))} if more is meant"
            raise InputError(f"a {subject} without 'speed'", expected=more, key="speed")
        if command and not given.speed > 0.0:
            unit = "" if subject == "drive" else " m/s"
            raise InputError(
                f"{given.speed:g}{unit} with a {command}",
                expected="a positive speed: its sense follows",
                key="speed",
            )
        if "ratio" in keys:
            raise InputError("'ratio' without 'follow'", expected="'follow', a rope to follow", key="ratio")
        if "dead_band" in keys and command not in {"tension", "level"}:
            raise InputError(
                "'dead_band' without 'tension' or 'level'", expected="one of them", key="dead_band"
            )
        ramps = sorted({"ramp", "acceleration", "jerk"} & set(keys))
        if ramps and command in {"tension", "level"}:
            raise InputError(f"{ramps[0]!r} beside {command!r}", expected="'speed' alone", key=ramps[0])
        cls.check_limits(given)
        if given.jerk is not None and given.acceleration is None:
            raise InputError("'jerk' without 'acceleration'", expected="'acceleration' as well", key="jerk")


K = TypeVar("K", bound=type[ActionKeys])


class _Family:
    """Actions by the words of case files: any that has a file in a package."""

    def __init__(self, package: str) -> None:
        self.package = package
        self._found: dict[str, type[ActionKeys]] = {}
        self._folders: set[str] = set()

    def describe(self, word: str) -> Callable[[K], K]:
        """Decorate the class with the keys of the table that has the key `word`.

        Raises
        ------
        TypeError
            If another one has the word, its first key is another one, or a key is that of another action, but not
            from the same class.
        """

        def register(described: K) -> K:
            other = self._found.get(word)
            if other is not None:
                raise TypeError(f"{_place(described)}: {word!r} is the word of {_place(other)}")
            found = _keys_of(described)
            first = next((key for key in found if key.name == word), None)
            if first is None:
                raise TypeError(f"{_place(described)}: an action {word!r} has a key {word!r}")
            described.WORD = word
            described.FIELDS = (first, *(key for key in found if key is not first))
            known = {key.name: key for one in self._found.values() for key in one.FIELDS}
            for key in described.FIELDS:
                same = known.get(key.name, key)
                if same.owner is not key.owner:
                    raise TypeError(
                        f"{_place(described)}: {key.name!r} is a key of {_place(same.owner)}, and not the same one"
                    )
            self._found[word] = described
            return described

        return register

    @property
    def kinds(self) -> dict[str, type[ActionKeys]]:
        """All by their words, in the order of schema and messages.

        All files of the package are read, also those in a folder that was added to its path.

        Raises
        ------
        TypeError
            If another file has the name of one of them.
        """
        for folder in importlib.import_module(self.package).__path__:
            if folder in self._folders:
                continue
            for file in sorted(Path(folder).glob("[!_]*.py")):
                module = importlib.import_module(f"{self.package}.{file.stem}")
                if Path(str(module.__file__)) != file:
                    raise TypeError(f"{file}: another file of this name is {module.__file__}")
            self._folders.add(folder)
        return dict(sorted(self._found.items(), key=lambda one: (one[1].ORDER, one[0])))


def _keys_of(described: type) -> list[ActionKey]:
    """Keys of a table.

    Raises
    ------
    TypeError
        If a number has no quantity.
    """
    found = []
    defaults = {one.name: one for one in fields(described)}
    for base in reversed(described.__mro__):
        for name, hint in _annotations(base).items():
            if name not in defaults or get_origin(hint) is ClassVar:
                continue
            inner, *marks = get_args(hint) if get_origin(hint) is Annotated else (hint,)
            if inner in (float, float | None) and not marks:
                raise TypeError(
                    f"{_place(described)}.{name}: {hint}, expected an annotation with its quantity"
                )
            found.append(ActionKey(name, inner, tuple(marks), defaults[name].default, base))
    return found


def _annotations(of: type) -> dict[str, Any]:
    return inspect.get_annotations(of, eval_str=True) if "__annotations__" in vars(of) else {}


def _place(of: type) -> str:
    return f"{sys.modules[of.__module__].__file__}, {of.__name__}"


ACTIONS = _Family("heavylift.solver.scenario.actions")
"""All actions."""
