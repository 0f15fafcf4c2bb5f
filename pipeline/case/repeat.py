"""Named numbers of a case, and blocks that stand for many bodies, joints, ropes, forces, contacts and so on.

A ``[[repeat]]`` block is written out before the case is checked: its tables are copied once for every index,
``{i}``, ``{i+1}`` and the like in their texts become numbers, and places in the world move by a shift. Errors
are reported at the place in the file that the user wrote.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import copy
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema, create_model

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.arithmetic import Numbers, filled, value_of
from heavylift.pipeline.case.fields import LengthVector, Section, reject
from heavylift.pipeline.case.tables import TABLES, Table, lengths

__all__ = ["Expansion", "Origin", "Parameters", "RepeatSection", "expand"]

INDEX = "i"
LIMIT = 100_000
"""Largest number of copies of one block."""
MOST_TABLES = 200_000
"""Tables that all blocks write together."""
MOST_VALUES = 10_000_000
"""Keys and values in them; a text counts once for each `PIECE` of it."""
PIECE = 50
PROSE = ("title", "sources", "source")
"""Keys whose texts may have braces that mean nothing."""

ParameterName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]


def _number(value: Any) -> Any:
    if not _is_number(value):
        reject(f"{value!r} is not a number", "a number without a unit")
    return value


Parameters = dict[ParameterName, Annotated[int | float, BeforeValidator(_number)]]
"""Named numbers of a case."""

_WHOLE = WithJsonSchema({"anyOf": [{"type": "integer", "minimum": 0}, {"type": "string"}]}, mode="validation")
_ANY_WHOLE = WithJsonSchema({"anyOf": [{"type": "integer"}, {"type": "string"}]}, mode="validation")


class _RepeatSection(Section):
    """Tables that are copied for ``i = first, ..., first + count - 1``; ``{i+1}`` in a text becomes a number."""

    count: Annotated[int, Field(ge=0, le=LIMIT, strict=True), _WHOLE]
    """Number of copies: an integer, or arithmetic of the parameters such as ``"n + 1"``."""
    first: Annotated[int, Field(strict=True), _ANY_WHOLE] = 0
    """The first index: an integer, or arithmetic of the parameters."""
    shift: LengthVector = (0.0, 0.0, 0.0)
    """Added i times to places in the world at the start [m]: positions of bodies, pivots of driven frames, ``at`` of
    joints and contacts, points and surfaces on the ground."""


if TYPE_CHECKING:
    RepeatSection = _RepeatSection
else:
    RepeatSection = create_model(
        "RepeatSection",
        __base__=_RepeatSection,
        __doc__=_RepeatSection.__doc__,
        **{key: table.repeated for key, table in TABLES.items()},
    )


@dataclass(frozen=True)
class Origin:
    """Where a table that was written out stands in the file: dotted key, and the index it was made for."""

    key: str
    index: int


@dataclass(frozen=True)
class Expansion:
    """A document whose blocks are written out.

    Attributes
    ----------
    document
        What is validated; ``repeat`` holds its counts and shifts as numbers.
    origins
        By dotted key of every table that was written out.
    errors
        What could not be written out.
    """

    document: dict[str, Any]
    origins: dict[str, Origin] = field(default_factory=dict)
    errors: tuple[InputError, ...] = ()

    def locate(self, key: str) -> tuple[str, int | None]:
        """Dotted key in the file of a dotted key in the document, and the index if it was repeated."""
        parts = key.split(".")
        for count in range(2, len(parts) + 1):
            origin = self.origins.get(".".join(parts[:count]))
            if origin is not None:
                return ".".join([origin.key, *parts[count:]]), origin.index
        return key, None

    def told(
        self, errors: Sequence[InputError], changed: Mapping[str, str] | None = None
    ) -> list[InputError]:
        """Errors at the places the user wrote, each place once.

        Parameters
        ----------
        errors
            Their keys are those of the document.
        changed
            Dotted keys that overrides set, with the text of the override, which is then the source.
        """
        found: dict[Any, InputError] = {}
        for error in errors:
            key, index = self.locate(error.key)
            override = next(
                (t for k, t in (changed or {}).items() if key == k or key.startswith(f"{k}.")), ""
            )
            found.setdefault(
                (key, error.problem) if index is None else key,
                InputError(
                    error.problem if index is None else f"{error.problem} ({INDEX} = {index})",
                    source=f"--set {override}" if override else error.source,
                    key=key,
                    expected=error.expected,
                ),
            )
        return list(found.values())


def expand(document: dict[str, Any], file: Path) -> Expansion:
    """Write the ``[[repeat]]`` blocks of a document out and put the ``[parameters]`` into its texts.

    Parameters
    ----------
    document
        As read from TOML, overrides applied; it is not changed.
    file
        Its file, for the messages.

    Notes
    -----
    What has another shape than the case file asks for is left as it is, for the validation to refuse.
    """
    numbers = document.get("parameters", {})
    blocks = document.get("repeat", [])
    if not isinstance(numbers, dict) or not isinstance(blocks, list):
        return Expansion(document)
    writer = _Writer(file, {key: value for key, value in numbers.items() if _is_number(value)})
    if len(writer.names) < len(numbers) or INDEX in numbers:
        problem = InputError(
            "is the index of a repeat block", source=file, key=f"parameters.{INDEX}", expected="another name"
        )
        return Expansion({**document, "repeat": []}, errors=(problem,) if INDEX in numbers else ())
    target: dict[str, Any] = {}
    for key, value in document.items():
        if key == "repeat":
            target[key] = []
        elif key == "parameters" or not numbers:
            target[key] = copy.deepcopy(value)
        else:
            target[key] = writer.fill(value, key, writer.names)
    plans = [writer.plan(target, block, f"repeat.{number}") for number, block in enumerate(blocks)]
    if writer.have_room(plans):
        for plan in filter(None, plans):
            writer.write_out(target, plan)
    if blocks:
        target.setdefault("bodies", {})  # which is reported as too few, not as a missing key
    return Expansion(target, writer.origins, tuple(writer.errors.values()))


def _size(shapes: Any) -> int:
    """Keys and values of tables within each other."""
    total, waiting = 0, [shapes]
    while waiting:
        node = waiting.pop()
        total += 1 + (len(node) // PIECE if isinstance(node, str) else 0)
        if isinstance(node, dict):
            waiting += [*node, *node.values()]
        elif isinstance(node, list):
            waiting += node
    return total


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


@dataclass(frozen=True)
class _Plan:
    """What a block will write: its key, its tables as they stand, the indices and the shift of the copies."""

    path: str
    shapes: Mapping[str, Any]
    indices: range
    shift: list[float] | None


class _Writer:
    """Copies tables with their texts filled in, and notes where they come from and what went wrong."""

    def __init__(self, file: Path, names: Numbers) -> None:
        self.file, self.names = file, dict(names)
        self.origins: dict[str, Origin] = {}
        self.errors: dict[str, InputError] = {}

    def fill(self, node: Any, key: str, names: Numbers) -> Any:
        """Copy of a value with numbers for what stands in braces in its texts and keys."""
        if isinstance(node, dict):
            return {
                str(self.fill(k, f"{key}.{k}", names)): self.fill(v, f"{key}.{k}", names)
                for k, v in node.items()
            }
        if isinstance(node, list):
            return [self.fill(entry, f"{key}.{index}", names) for index, entry in enumerate(node)]
        if not isinstance(node, str) or "{" not in node:
            return node
        try:
            return filled(node, names)
        except InputError as error:
            if not {part for part in key.split(".") if part in PROSE}:
                self.complain(error, key)
            return node

    def complain(self, error: InputError, key: str) -> None:
        """Note an error at its place, the first one of each place."""
        if key not in self.errors:
            self.errors[key] = InputError(error.problem, source=self.file, key=key, expected=error.expected)

    def plan(self, target: dict[str, Any], block: Any, path: str) -> _Plan | None:
        """What one block will write, with its own settings put into a document; None if it is unknown."""
        if not isinstance(block, dict):
            target["repeat"].append(block)
            return None
        settings = {
            key: self.fill(block[key], f"{path}.{key}", self.names) for key in block if key == "shift"
        }
        settings |= {
            key: self._whole(block[key], f"{path}.{key}") for key in ("count", "first") if key in block
        }
        rest = {key: value for key, value in block.items() if key not in {*TABLES, *settings}}
        shapes = {key: block[key] for key in TABLES if key in block}
        target["repeat"].append({**rest, **settings, **shapes})
        count, first = settings.get("count"), settings.get("first", 0)
        if (
            isinstance(count, bool)
            or not isinstance(count, int)
            or not isinstance(first, int)
            or count > LIMIT
        ):
            return None
        shift = lengths(settings.get("shift", [0.0, 0.0, 0.0]))
        return _Plan(path, shapes, range(first, first + count), shift)

    def have_room(self, plans: Sequence[_Plan | None]) -> bool:
        """Whether what all blocks write together is not too much; complains at the block with which it is."""
        tables = values = 0
        for plan in filter(None, plans):
            count = len(plan.indices)
            tables += count * sum(len(one) for one in plan.shapes.values() if isinstance(one, (dict, list)))
            values += count * _size(plan.shapes)
            for made, most, what in (
                (tables, MOST_TABLES, "tables"),
                (values, MOST_VALUES, "keys and values"),
            ):
                if made > most:
                    problem = f"with {count:,} copies the blocks make {made:,} {what} in all"
                    self.complain(InputError(problem, expected=f"at most {most:,}"), f"{plan.path}.count")
                    return False
        return True

    def write_out(self, target: dict[str, Any], plan: _Plan) -> None:
        """Add the tables of one block to a document."""
        for index in plan.indices:
            names = {**self.names, INDEX: index}
            move = (
                [index * entry for entry in plan.shift] if plan.shift and any(plan.shift) and index else None
            )
            for table in TABLES.values():
                self._entries(target, table, plan.shapes.get(table.key), plan.path, names, move)

    def _whole(self, value: Any, key: str) -> Any:
        """An integer, or a text that is arithmetic; what is neither is left for the validation."""
        if not isinstance(value, str):
            return value
        try:
            text = filled(value, self.names) if "{" in value else value
            return value_of(str(text), self.names)
        except InputError as error:
            self.complain(error, key)
            return 0

    def _entries(
        self,
        target: dict[str, Any],
        table: Table,
        templates: Any,
        path: str,
        names: Numbers,
        move: list[float] | None,
    ) -> None:
        """Add the entries of one table of a block for one index."""
        made: type[Any] = dict if table.by_name else list
        if not isinstance(templates, made) or not templates:
            return
        found: Any = target.setdefault(table.key, made())
        if not isinstance(found, made):
            return
        given = templates.items() if isinstance(templates, dict) else enumerate(templates)
        for template, content in given:
            place = f"{path}.{table.key}.{template}"
            name = str(self.fill(template, place, names)) if table.by_name else str(len(found))
            if table.by_name and name in found:
                before = self.origins.get(f"{table.key}.{name}")
                other = f"{before.key} ({INDEX} = {before.index})" if before else f"{table.key}.{name}"
                problem = f"{name!r} ({INDEX} = {names[INDEX]}) is already made by {other}"
                one = f"one {table.one} a name"
                expected = one if "{" in str(template) else f"a name with {{{INDEX}}}"
                self.complain(InputError(problem, expected=expected), place)
                continue
            entry = self.fill(content, place, names)
            if move is not None and table.move is not None and isinstance(entry, dict):
                try:
                    table.move(entry, move)
                except InputError as error:
                    self.complain(error, f"{place}.{error.key}")
            self.origins[f"{table.key}.{name}"] = Origin(place, int(names[INDEX]))
            if table.by_name:
                found[name] = entry
            else:
                found.append(entry)
