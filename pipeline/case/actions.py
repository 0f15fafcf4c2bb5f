"""The table of an action in a case file: the keys of all actions, each of which has a file of its own."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import re
from collections.abc import Callable, Iterable
from dataclasses import MISSING
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, cast

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationInfo,
    WithJsonSchema,
    create_model,
    field_validator,
    model_validator,
)

from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import ByCoordinate, NameOf, Quantity
from heavylift.pipeline.case.channel_kinds import joint_coordinate
from heavylift.pipeline.case.fields import AnyOf, CaseContext, Name, Section, as_list, quantity_schema, reject
from heavylift.solver.scene.actions import ACTIONS, Action, ActionKey, ActionKeys, NamesOf, Targets

__all__ = ["ActionSection", "ActionTable", "Names", "Value"]

Value = Annotated[float, WithJsonSchema(quantity_schema(), mode="validation")]
"""A quantity whose kind depends on another key."""

_PATTERN = re.compile(r"[A-Za-z*?\[][A-Za-z0-9_*?!\[\].-]*")


def _pattern(name: str) -> str:
    if not _PATTERN.fullmatch(name) or len(name) > 120:
        reject(f"{name!r} is no name", "a name, or a pattern such as 'fall_*'")
    return name


Names = Annotated[
    tuple[Annotated[str, AfterValidator(_pattern)], ...],
    Field(min_length=1),
    BeforeValidator(as_list),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}, mode="validation"
    ),
]
"""A name, a pattern of names, or several."""


class ActionTable(Section):
    """What tables of all actions have in common: one action, with the keys that belong to it."""

    KINDS: ClassVar[tuple[type[ActionKeys], ...]] = ()

    @property
    def kind(self) -> type[ActionKeys]:
        """Which action it is."""
        return next(kind for kind in self.KINDS if getattr(self, kind.WORD) is not None)

    @model_validator(mode="after")
    def _is_one_action(self) -> "ActionTable":
        given = [kind.WORD for kind in self.KINDS if getattr(self, kind.WORD) is not None]
        if len(given) != 1:
            problem = f"{' and '.join(map(repr, given))} in one action" if given else "no action"
            reject(problem, f"one of {', '.join(repr(kind.WORD) for kind in self.KINDS)}")
        kind = self.kind
        own = {key.name for key in kind.FIELDS} - {kind.WORD}
        odd = sorted(self.model_fields_set - {kind.WORD} - own)
        if odd:
            reject(f"{odd[0]!r} of {kind.WORD!r}", f"{', '.join(sorted(own)) or 'no other key'}", key=odd[0])
        try:
            kind.check_keys(self, frozenset(self.model_fields_set))
        except InputError as error:
            reject(error.problem, error.expected, key=error.key)
        return self

    def made(self, targets: Targets, group: int) -> tuple[Action, ...]:
        """For the solver: one for each thing that is named; `group` is a number of its own.

        Raises
        ------
        InputError
            If a name is that of nothing.
        """
        return self.kind.made(self, targets, group)


def _unit_of_what_moves(kinds: Iterable[type[ActionKeys]], keys: Iterable[ActionKey]) -> Callable[..., Any]:
    """Validator of speeds and the like, in units of what an action acts on."""
    drives = [kind.WORD for kind in kinds if getattr(kind.FIELDS[0].mark(NamesOf), "what", "") == "drives"]
    marks = {key.name: key.mark(ByCoordinate) for key in keys}

    def parse(_section: Any, value: Any, info: ValidationInfo) -> Any:
        if value is None:
            return None
        mark = marks[str(info.field_name)]
        names = next((info.data[word] for word in drives if info.data.get(word)), None)
        turns = _turns(names, CaseContext.of(info))
        if turns is None:
            return AnyOf(mark.travel, mark.angle).parse(value)
        return (mark.angle if turns else mark.travel).validate(value)

    return parse


def _turns(drives: Iterable[str] | None, context: CaseContext | None) -> bool | None:
    """Whether some drives turn; None if that is not known. What is no drive moves along."""
    if drives is None:
        return False
    joints = {} if context is None else context.names.joints
    found = set()
    for pattern in drives:
        if "." in pattern:
            found.add(pattern.endswith(".angle"))
            continue
        found |= {
            joint_coordinate(of_type) == "angle"
            for name, of_type in joints.items()
            if fnmatchcase(name, pattern)
        }
    if len(found) == 2:
        reject("drives that turn and drives that move along", "an action for each sort")
    return found.pop() if found else None


def _type(key: ActionKey) -> Any:
    """Type of a key, without what is absent."""
    if key.mark(NamesOf):
        return Names
    if key.mark(NameOf):
        return Name
    if key.mark(ByCoordinate):
        return Value
    quantity = key.mark(Quantity)
    return key.hint if quantity is None else Annotated[float, quantity]


def _section() -> type[ActionTable]:
    kinds = tuple(ACTIONS.kinds.values())
    first = {kind.FIELDS[0].name: kind.FIELDS[0] for kind in kinds}
    keys = first | {key.name: key for kind in kinds for key in kind.FIELDS if key.name not in first}
    own: dict[str, Any] = {}
    for name, key in keys.items():
        absent = key.default in (None, MISSING)
        own[name] = (_type(key) | None, None) if absent else (_type(key), key.default)
    moving = [key for key in keys.values() if key.mark(ByCoordinate)]
    unit = field_validator(*(key.name for key in moving), mode="before", check_fields=False)
    made = create_model(
        "ActionSection",
        __base__=ActionTable,
        __module__=__name__,
        __doc__="What happens when a phase begins: what is told to a winch, hook, drive, tank, path; release, "
        "connection, note.",
        __validators__={"unit": unit(cast("Any", classmethod(_unit_of_what_moves(kinds, moving))))},
        **own,
    )
    made.KINDS = kinds
    return made


if TYPE_CHECKING:
    ActionSection = ActionTable
else:
    ActionSection = _section()
    """Table of any action."""
