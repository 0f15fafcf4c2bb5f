"""Named numbers of a case, and blocks that stand for many bodies, joints, ropes, forces, contacts and so on.

A ``[[repeat]]`` block is written out before the case is checked: its tables are copied once for every index,
``{i}``, ``{i+1}`` and the like in their texts become numbers, and places in the world move by a shift. Errors
are told at the place in the file that the user wrote.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import contextlib
import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, parse_quantity
from heavylift.pipeline.case.arithmetic import Numbers, filled, value_of
from heavylift.pipeline.case.channel_kinds import NAMED_LISTS as LISTS
from heavylift.pipeline.case.fields import GROUND, LengthVector, Section, reject

__all__ = ["Expansion", "Origin", "Parameters", "RepeatSection", "expand"]

INDEX = "i"
LIMIT = 100_000
"""Largest number of copies of one block."""
TABLES = ("bodies", "contours", "hulls", "databases")
_SINGULAR = {"bodies": "body", "contours": "contour", "hulls": "hull", "databases": "database"}
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


class RepeatSection(Section):
    """Tables that are copied for ``i = first, ..., first + count - 1``; ``{i+1}`` in a text becomes a number."""

    count: Annotated[int, Field(ge=0, le=LIMIT, strict=True), _WHOLE]
    """Number of copies: an integer, or arithmetic of the parameters such as ``"n + 1"``."""
    first: Annotated[int, Field(strict=True), _ANY_WHOLE] = 0
    """The first index: an integer, or arithmetic of the parameters."""
    shift: LengthVector = (0.0, 0.0, 0.0)
    """Added i times to places in the world at the start [m]: positions of bodies, pivots of driven frames, ``at`` of
    joints and contacts, points and surfaces on the ground."""
    bodies: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Bodies by name, as in the case."""
    joints: tuple[dict[str, Any], ...] = ()
    """Joints, as in the case."""
    ropes: tuple[dict[str, Any], ...] = ()
    """Ropes, as in the case."""
    forces: tuple[dict[str, Any], ...] = ()
    """Forces, as in the case."""
    sensors: tuple[dict[str, Any], ...] = ()
    """Sensors, as in the case."""
    contours: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Contours by name, as in the case."""
    contacts: tuple[dict[str, Any], ...] = ()
    """Contacts, as in the case."""
    surfaces: tuple[dict[str, Any], ...] = ()
    """Surfaces, as in the case."""
    collisions: tuple[dict[str, Any], ...] = ()
    """Collisions, as in the case."""
    hulls: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Hulls by name, as in the case."""
    databases: dict[str, dict[str, Any]] = Field(default_factory=dict)
    """Databases by name, as in the case."""
    tanks: tuple[dict[str, Any], ...] = ()
    """Tanks, as in the case."""
    fluid_loads: tuple[dict[str, Any], ...] = ()
    """Loads of wind and current, as in the case."""
    lines: tuple[dict[str, Any], ...] = ()
    """Mooring lines, as in the case."""
    fenders: tuple[dict[str, Any], ...] = ()
    """Fenders, as in the case."""


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
    for number, block in enumerate(blocks):
        writer.write_out(target, block, f"repeat.{number}")
    return Expansion(target, writer.origins, tuple({error.key: error for error in writer.errors}.values()))


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


class _Writer:
    """Copies tables with their texts filled in, and notes where they come from and what went wrong."""

    def __init__(self, file: Path, names: Numbers) -> None:
        self.file, self.names = file, dict(names)
        self.origins: dict[str, Origin] = {}
        self.errors: list[InputError] = []

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
        if all(other.key != key for other in self.errors):
            self.errors.append(InputError(error.problem, source=self.file, key=key, expected=error.expected))

    def write_out(self, target: dict[str, Any], block: Any, path: str) -> None:
        """Add the tables of one block to a document."""
        if not isinstance(block, dict):
            target["repeat"].append(block)
            return
        settings = {
            key: self.fill(block[key], f"{path}.{key}", self.names) for key in block if key == "shift"
        }
        settings |= {
            key: self._whole(block[key], f"{path}.{key}") for key in ("count", "first") if key in block
        }
        rest = {key: value for key, value in block.items() if key not in {*TABLES, *LISTS, *settings}}
        shapes = {key: block[key] for key in (*TABLES, *LISTS) if key in block}
        target["repeat"].append({**rest, **settings, **shapes})
        count, first = settings.get("count"), settings.get("first", 0)
        if (
            isinstance(count, bool)
            or not isinstance(count, int)
            or not isinstance(first, int)
            or count > LIMIT
        ):
            return
        shift = _lengths(settings.get("shift", [0.0, 0.0, 0.0]))
        for index in range(first, first + count):
            names = {**self.names, INDEX: index}
            move = [index * entry for entry in shift] if shift else None
            for section in TABLES:
                self._tables(target, section, block, path, names, move if move and any(move) else None)
            for section in LISTS:
                self._entries(target, section, block, path, names, move if move and any(move) else None)

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

    def _tables(
        self,
        target: dict[str, Any],
        section: str,
        block: Any,
        path: str,
        names: Numbers,
        move: list[float] | None,
    ) -> None:
        templates = block.get(section, {})
        found = target.setdefault(section, {}) if templates or section == "bodies" else None
        if not isinstance(templates, dict) or not isinstance(found, dict):
            return
        for template, body in templates.items():
            place = f"{path}.{section}.{template}"
            name = str(self.fill(template, place, names))
            if name in found:
                before = self.origins.get(f"{section}.{name}")
                other = f"{before.key} ({INDEX} = {before.index})" if before else f"{section}.{name}"
                problem = f"{name!r} ({INDEX} = {names[INDEX]}) is already made by {other}"
                one = f"one {_SINGULAR[section]} a name"
                expected = one if "{" in template else f"a name with {{{INDEX}}}"
                self.complain(InputError(problem, expected=expected), place)
                continue
            entry = self.fill(body, place, names)
            if move is not None and isinstance(entry, dict):
                if section == "bodies":
                    self._move_body(entry, move, place)
                elif entry.get("body") == GROUND:
                    _move_contour(entry, move)
            found[name] = entry
            self.origins[f"{section}.{name}"] = Origin(place, int(names[INDEX]))

    def _entries(
        self,
        target: dict[str, Any],
        section: str,
        block: Any,
        path: str,
        names: Numbers,
        move: list[float] | None,
    ) -> None:
        templates = block.get(section, [])
        if not templates or not isinstance(templates, list):
            return
        found = target.setdefault(section, [])
        if not isinstance(found, list):
            return
        for number, template in enumerate(templates):
            place = f"{path}.{section}.{number}"
            entry = self.fill(template, place, names)
            if move is not None and isinstance(entry, dict):
                if section == "surfaces":
                    _move_surface(entry, move)
                else:
                    _move_entry(entry, move)
            self.origins[f"{section}.{len(found)}"] = Origin(place, int(names[INDEX]))
            found.append(entry)

    def _move_body(self, body: dict[str, Any], move: list[float], place: str) -> None:
        """Move where a body starts; without a position that is where its geometry was drawn."""
        frame, initial = body.get("frame"), body.setdefault("initial", {})
        if not isinstance(initial, dict):
            return
        given = initial.get("position")
        if given is None and isinstance(frame, dict) and frame.get("origin") == "centre_of_mass":
            given = body.get("centre_of_mass") if body.get("type") == "rigid" else None
            if given is None:
                problem = "is missing, and the frame starts at a centre of mass that is computed"
                expected = "a position [m] for the body to be shifted from"
                self.complain(InputError(problem, expected=expected), f"{place}.initial.position")
                return
        initial["position"] = _moved([0.0, 0.0, 0.0] if given is None else given, move)
        if isinstance(frame, dict) and "angle" in frame:
            frame["pivot"] = _moved(frame.get("pivot", [0.0, 0.0, 0.0]), move)


def _move_entry(entry: dict[str, Any], move: list[float]) -> None:
    """Move the places in the world of a joint, rope, spring, contact."""
    if "at" in entry:
        entry["at"] = _moved(entry["at"], move)
    sides, points = entry.get("between"), entry.get("points")
    if isinstance(sides, list) and isinstance(points, list):
        entry["points"] = [
            _moved(point, move) if side == GROUND else point
            for side, point in zip(sides, points, strict=False)
        ] + points[len(sides) :]
    path = entry.get("path")
    for stop in path if isinstance(path, list) else ():
        if isinstance(stop, dict) and stop.get("body") == GROUND and "point" in stop:
            stop["point"] = _moved(stop["point"], move)


def _move_surface(entry: dict[str, Any], move: list[float]) -> None:
    """Move a surface of the ground, and the boxes that exclude its triangles; those of bodies move with them."""
    if entry.get("body") != GROUND:
        return
    entry["at"] = _moved(entry.get("at", [0.0, 0.0, 0.0]), move)
    boxes = entry.get("exclude")
    for box in boxes if isinstance(boxes, list) else ():
        if isinstance(box, dict) and "centre" in box:
            box["centre"] = _moved(box["centre"], move)


def _move_contour(entry: dict[str, Any], move: list[float]) -> None:
    """Move the points of a contour of the ground; those in a file stay where they are."""
    if "points" in entry:
        entry["points"] = _moved_all(entry["points"], move)
    for key, name in (("circle", "centre"), ("spline", "control")):
        table = entry.get(key)
        if isinstance(table, dict):
            table[name] = _moved_all(table.get(name, [0.0, 0.0, 0.0]), move)


def _moved_all(points: Any, move: list[float]) -> Any:
    """A point, or lists of points, moved."""
    if isinstance(points, list) and points and isinstance(points[0], list):
        return [_moved_all(point, move) for point in points]
    return _moved(points, move)


def _moved(point: Any, move: list[float]) -> Any:
    """A point in SI, moved; left alone if it is none, for the validation to refuse."""
    given = _lengths(point)
    return point if given is None else [a + b for a, b in zip(given, move, strict=True)]


def _lengths(values: Any) -> list[float] | None:
    """Three lengths [m], or None if that is not what is given."""
    if isinstance(values, list) and len(values) == 3:
        with contextlib.suppress(InputError):
            return [parse_quantity(value, KINDS["length"]) for value in values]
    return None
