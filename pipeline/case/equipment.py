"""Builders of equipment write their bodies, joints and ropes into a document before it is checked.

They see the document as blocks have left it, in the order of `BUILDERS` and of the file. What one writes, others may
hang on: one that hangs on something that is not there yet waits for it. Errors in generated entries are reported at the
key of the builder.
"""

from __future__ import annotations

import contextlib
import math
from dataclasses import field
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.bodies import AxisAngle
from heavylift.pipeline.case.described import section_of
from heavylift.pipeline.case.fields import GROUND, LengthVector
from heavylift.pipeline.case.tables import TABLES
from heavylift.pipeline.equipment.builders import BUILDERS
from heavylift.pipeline.equipment.parts import Made
from heavylift.solver.scene.connections import MEASURES
from heavylift.solver.scene.scene import SENSORS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.equipment.parts import Part

__all__ = ["BuiltPart", "Equipped", "equip"]


@dataclass(frozen=True)
class BuiltPart:
    """Where an entry that a builder wrote comes from: dotted key of the builder, and what it is."""

    key: str
    what: str


@dataclass
class Equipped:
    """A document with what its builders wrote.

    Attributes
    ----------
    document
        What is validated.
    built
        By dotted key of every entry that was written.
    errors
        What could not be built.
    """

    document: dict[str, Any]
    built: dict[str, BuiltPart] = field(default_factory=dict)
    errors: list[InputError] = field(default_factory=list)

    def locate(self, key: str) -> tuple[str, str]:
        """Dotted key of what the user wrote, and, if a builder wrote something for it, what that is."""
        parts = key.split(".")
        for count in range(2, len(parts) + 1):
            part = self.built.get(".".join(parts[:count]))
            if part is not None:
                outer = self.locate(part.key)[0]  # of a builder that another one wrote
                return outer, f"{part.what}, {'.'.join(parts[count:])}".removesuffix(", ")
        return key, ""

    def builders(self, key: str) -> set[str]:
        """Tables of the builder with a dotted key, and of those that wrote it."""
        found, part = {key.partition(".")[0]}, self.built.get(key)
        return found | self.builders(".".join(part.key.split(".")[:2])) if part else found

    def told(self, errors: Sequence[InputError]) -> list[InputError]:
        """Errors at the keys of builders, with what they wrote."""
        found = []
        for error in errors:
            key, what = self.locate(error.key)
            problem = f"{error.problem} ({what})" if what else error.problem
            found.append(InputError(problem, source=error.source, key=key, expected=error.expected))
        return found


class _Unknown(Exception):
    """Something a builder refers to is missing or wrong, which is reported with that entry."""


def equip(document: dict[str, Any], file: Path) -> Equipped:
    """Add what the builders of a document write.

    Parameters
    ----------
    document
        As read from TOML, blocks written out; it is not changed.
    file
        Its file, for the messages.

    Notes
    -----
    A builder whose own table is wrong writes nothing: its errors are reported when all is validated.
    """
    found = Equipped(document)
    if not any(isinstance(document.get(key), list) and document[key] for key in BUILDERS):
        return found
    found.document = {
        key: value.copy() if isinstance(value, (dict, list)) else value for key, value in document.items()
    }
    done: set[str] = set()
    while True:
        count = len(done)
        for table, described in BUILDERS.items():
            rows = found.document.get(table, [])
            for index, row in enumerate(rows if isinstance(rows, list) else ()):
                key = f"{table}.{index}"
                if key not in done:
                    with contextlib.suppress(_Unknown):  # perhaps something that is written later
                        _write(found, described, key, row, file)
                        done.add(key)
        if len(done) == count:
            return found


def _write(found: Equipped, described: Any, key: str, row: Any, file: Path) -> None:
    """Add what a builder writes, or what is wrong with it."""
    try:
        made = _build(described, section_of(described).model_validate(row), _Places(found.document))
    except ValidationError:
        return
    except InputError as error:
        place = f"{key}.{error.key}".removesuffix(".")
        told = InputError(error.problem, source=file, key=place, expected=error.expected)
        found.errors += found.told([told])
        return
    written_by = found.builders(key)
    for part in made.parts:
        if part.table not in TABLES:
            raise TypeError(f"{described.__qualname__} writes {part.table!r}, which is no table of a scene")
        if part.table in written_by:
            raise TypeError(f"{described.__qualname__} writes {part.table!r}, of which it is written itself")
        _put(found, part, f"{key}.{part.key}".removesuffix("."), file)


def _build(described: Any, spec: Any, places: _Places) -> Made:
    """What a builder writes, all of it in finite numbers."""
    made = Made()
    huge = InputError("some of its parts would be at no finite place", expected="lengths of a sensible size")
    try:
        with np.errstate(all="ignore"):
            described.build(spec, places, made)
    except (OverflowError, ZeroDivisionError):
        raise huge from None
    if not all(_is_finite(part.entry) for part in made.parts):
        raise huge
    return made


def _is_finite(node: Any) -> bool:
    """Whether all numbers in an entry are finite."""
    if isinstance(node, dict):
        return all(map(_is_finite, node.values()))
    if isinstance(node, (list, tuple)):
        return all(map(_is_finite, node))
    return not isinstance(node, float) or math.isfinite(node)


def _put(found: Equipped, part: Part, key: str, file: Path) -> None:
    """Add an entry that a builder wrote."""
    by_name = TABLES[part.table].by_name
    empty: Any = {} if by_name else []
    entries: Any = found.document.setdefault(part.table, empty)
    if not isinstance(entries, type(empty)):
        return  # which is reported when all is validated
    if by_name and part.name in entries:
        before = found.built.get(f"{part.table}.{part.name}")
        other = before.key if before else f"{part.table}.{part.name}"
        problem = f"the name {part.name!r} that it gives is already that of {other}"
        found.errors.append(InputError(problem, source=file, key=key, expected="another 'name'"))
        return
    place = f"{part.table}.{part.name if by_name else len(entries)}"
    found.built[place] = BuiltPart(key, f"{TABLES[part.table].one} {part.name!r}")
    if by_name:
        entries[part.name] = part.entry
    else:
        entries.append(part.entry)


class _Places:
    """Where the bodies of a document are at the start, as far as it says so."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self._document = document

    def world(self, body: str, point: ArrayLike) -> NDArray[np.float64]:
        """Place in the world [m] of a point of a body, or of the ground."""
        place: NDArray[np.float64] = np.asarray(point, dtype=np.float64)
        if body == GROUND:
            return place
        position, rotation, origin = self._pose(body)
        return np.asarray(position + rotation @ (place - origin))

    def local(self, body: str, point: ArrayLike) -> NDArray[np.float64]:
        """Point of a body [m], or of the ground, at a place in the world."""
        place: NDArray[np.float64] = np.asarray(point, dtype=np.float64)
        if body == GROUND:
            return place
        position, rotation, origin = self._pose(body)
        return np.asarray(origin + rotation.T @ (place - position))

    def centre_of_mass(self, body: str) -> NDArray[np.float64] | None:
        """Centre of mass of a rigid body in the world [m]; None of others."""
        row = self._row(body)
        if row.get("type") != "rigid":
            return None
        return self.world(body, _lengths(row.get("centre_of_mass", (0.0, 0.0, 0.0))))

    def has_steps(self) -> bool:
        """Whether the case is simulated with `dele2`, of which measures follow the steps."""
        simulate = self._document.get("simulate")
        return not isinstance(simulate, dict) or simulate.get("integrator", "dele2") == "dele2"

    def hangs_alone(self, body: str) -> bool:
        """Whether a body is free, and nothing is on it: nor in a builder but one, nor in another table."""
        row = self._row(body)
        frame = row.get("frame")
        if not isinstance(frame, dict) or frame.get("motion") != "free":
            return False
        if self._document.get("collisions"):
            return False
        builders, hulls = 0, self._document.get("hulls")
        for key, rows in self._document.items():
            if key in BUILDERS:
                builders += sum(_names(one, body) for one in (rows if isinstance(rows, list) else []))
            elif not _watches(key) and _names({**rows, body: None} if key == "bodies" else rows, body):
                return False
        if isinstance(hulls, dict) and body in hulls:
            return False
        return builders == 1

    def _row(self, body: str) -> Mapping[str, Any]:
        rows = self._document.get("bodies")
        row = rows.get(body) if isinstance(rows, dict) else None
        if not isinstance(row, dict):
            raise _Unknown
        return row

    def _pose(self, body: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Position and rotation of the frame of a body, and its origin in coordinates of the geometry [m]."""
        row = self._row(body)
        frame, initial = row.get("frame"), row.get("initial", {})
        if not isinstance(initial, dict):
            raise _Unknown
        origin = np.zeros(3)
        turned = initial.get("position") is not None or initial.get("orientation") is not None
        if isinstance(frame, dict) and frame.get("origin") == "centre_of_mass" and turned:
            if row.get("type") != "rigid":
                raise InputError(
                    f"{body!r} begins at a centre of mass that is computed later",
                    expected="a body whose frame has the origin of its geometry",
                )
            origin = _lengths(row.get("centre_of_mass", (0.0, 0.0, 0.0)))
        position = _lengths(initial["position"]) if initial.get("position") is not None else origin
        rotation = np.eye(3)
        if initial.get("orientation") is not None:
            turn = _valid(AxisAngle, initial["orientation"])
            n = np.array(turn.axis) / np.linalg.norm(turn.axis)
            cross = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
            rotation = np.eye(3) + np.sin(turn.angle) * cross + (1.0 - np.cos(turn.angle)) * cross @ cross
        return position, rotation, origin


_PASSIVE = frozenset({"gravity", "surfaces", "report", "check", "reference", "simulate"})
"""Tables of what holds nothing, beside those of what only watches."""


def _watches(key: str) -> bool:
    """Whether what stands in a table of a document holds nothing."""
    chosen = TABLES[key].chosen if key in TABLES else None
    return key in _PASSIVE or (chosen is not None and chosen.family in (MEASURES, SENSORS))


def _names(node: Any, body: str) -> bool:
    """Whether a body is named anywhere in what a document says."""
    if isinstance(node, dict):
        return any(_names(value, body) for value in node.values())
    if isinstance(node, list):
        return any(_names(value, body) for value in node)
    return bool(node == body)


@cache
def _adapter(of: Any) -> TypeAdapter[Any]:
    """What validates a type; made once, since that takes longer than what it does."""
    return TypeAdapter(of)


def _valid(of: Any, value: Any) -> Any:
    with contextlib.suppress(ValidationError):
        return _adapter(of).validate_python(value)
    raise _Unknown


def _lengths(value: Any) -> NDArray[np.float64]:
    return np.array(_valid(LengthVector, value))
