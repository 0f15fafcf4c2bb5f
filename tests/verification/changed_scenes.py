"""The same scene said otherwise: turned, moved, renamed, in another order, in other units, twice.

Each function takes a document as read from TOML, with its blocks written out, and returns another one that says the
same mechanics. `differences` runs over two results and tells how far each channel is from what it must be.
"""

from __future__ import annotations

import copy
import json
import math
import re
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.units import KINDS, parse_quantity
from heavylift.pipeline.case.tables import TABLES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.results.histories import Results

Document = dict[str, Any]
UP = np.array([0.0, 0.0, 1.0])


def about_vertical(angle: float) -> NDArray[np.float64]:
    """Matrix of a turn about the vertical [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _number(value: Any, kind: str) -> float:
    return float(value) if isinstance(value, (int, float)) else parse_quantity(value, KINDS[kind])


def _turned_vector(values: Any, R: NDArray[np.float64], kind: str) -> list[float]:
    return (R @ [_number(value, kind) for value in values]).tolist()


def _turn(entry: Any, key: str, R: NDArray[np.float64], kind: str = "number", absent: Any = None) -> None:
    """Turn a vector of a table in place; `absent` is what a missing one means, None that it stays missing."""
    given = entry.get(key, absent)
    if given is not None:
        entry[key] = (
            _turned_vector(given, R, kind) if kind != "number" else (R @ np.array(given, float)).tolist()
        )


def _turn_orientation(entry: Document, key: str, R: NDArray[np.float64]) -> None:
    """Turn what an axis and an angle turn: R after that."""
    from scipy.spatial.transform import Rotation

    given = entry.get(key)
    old = Rotation.identity()
    if given:
        axis = np.array(given["axis"], float)
        old = Rotation.from_rotvec(_number(given["angle"], "angle") * axis / np.linalg.norm(axis))
    new = (Rotation.from_matrix(R) * old).as_rotvec()
    angle = float(np.linalg.norm(new))
    entry[key] = {"axis": (new / angle).tolist() if angle else [0.0, 0.0, 1.0], "angle": angle}


def _turn_sides(entry: Document, R: NDArray[np.float64], *points: str) -> None:
    for key in ("at", *points):
        _turn(entry, key, R, "length")
    for key in ("axis", "second_axis", "slide_axis", "reference"):
        _turn(entry, key, R)
    sides = entry.get("between", ())
    for key, kind in (("points", "length"), ("axes", "number")):
        if key in entry:
            entry[key] = [
                _turned_vector(one, R, kind) if side == "ground" else one
                for side, one in zip(sides, entry[key], strict=True)
            ]


def _turn_place(place: Any, R: NDArray[np.float64]) -> None:
    if isinstance(place, dict) and place.get("body") == "ground":
        _turn(place, "point", R, "length")
        _turn(place, "axis", R)


def _each_place(value: Any, change: Callable[[Document], None]) -> None:
    """Change every table with a body and a point in a value."""
    if isinstance(value, dict) and {"body", "point"} <= set(value):
        change(value)
    elif isinstance(value, (dict, list)):
        for entry in value.values() if isinstance(value, dict) else value:
            _each_place(entry, change)


def _turn_body(body: Document, R: NDArray[np.float64]) -> None:
    if body["type"] in {"frame", "shell"}:
        raise NotImplementedError("points of meshes of frames and shells")
    frame, initial = body.get("frame", {}), body.setdefault("initial", {})
    _turn(initial, "position", R, "length")
    _turn_orientation(initial, "orientation", R)
    _turn(initial, "velocity", R, "velocity")
    _turn(frame, "axis", R)
    _turn(frame, "pivot", R, "length")
    if {"x", "y"} & set(frame):
        raise NotImplementedError("displacements along axes of the world")


def _turn_direction(entry: Document, R: NDArray[np.float64]) -> None:
    """Turn the direction of waves, wind or current [rad]."""
    angle = math.atan2(R[1, 0], R[0, 0])
    entry["direction"] = _number(entry.get("direction", 0.0), "angle") + angle


def turned(document: Document, R: NDArray[np.float64]) -> Document:
    """The scene turned about a vertical axis through the origin of the world.

    Raises
    ------
    NotImplementedError
        If a key knows axes of the world only, with its words.
    """
    made = copy.deepcopy(document)
    _turn(made.get("gravity", {}), "acceleration", R, "acceleration")
    for body in made["bodies"].values():
        _turn_body(body, R)
    for criterion in made.get("criteria", ()):
        _each_place(criterion, lambda place: _turn_place(place, R))
    for key in ("joints", "lines", "fenders", "relative_motions", "leads", "contacts"):
        for entry in made.get(key, ()):
            _turn_sides(entry, R)
    for entry in made.get("forces", ()):
        if "between" in entry:
            _turn_sides(entry, R)
        if entry.get("frame", "world") == "world" and "forces" in entry:
            entry["forces"] = [_turned_vector(one, R, "force") for one in entry["forces"]]
            entry.update(
                {"moments": [_turned_vector(one, R, "moment") for one in entry["moments"]]}
                if "moments" in entry
                else {}
            )
    for rope in made.get("ropes", ()):
        for stop in rope.get("path", ()):
            _turn_place(stop, R)
    for key in ("falls", "equalizers", "spreaders"):
        for entry in made.get(key, ()):
            for place in ("hook", "crown", "drum", "other_drum"):
                _turn_place(entry.get(place), R)
            _turn(entry, "along", R, absent=[1.0, 0.0, 0.0])
    for link in made.get("link_beams", ()):
        _turn(link, "along", R, absent=[1.0, 0.0, 0.0])
        if link.get("rests_on") == "ground":
            _turn(link, "edge", R, "length")
    for deck in made.get("decks", ()):
        if deck.get("body", "ground") == "ground":
            _turn(deck, "origin", R, "length")
            _turn(deck, "direction", R, absent=[1.0, 0.0, 0.0])
    for surface in made.get("surfaces", ()):
        if surface.get("body") == "ground":
            _turn(surface, "at", R, "length", absent=[0.0, 0.0, 0.0])
            _turn_orientation(surface, "turned", R)
    for contour in made.get("contours", {}).values():
        if contour.get("body") == "ground":
            raise NotImplementedError("contours of the ground")
    if made.get("gantry_cranes"):
        raise NotImplementedError("girders along x")
    sea = made.get("sea", {})
    for key in ("waves", "wind", "current"):
        for entry in sea[key] if isinstance(sea.get(key), list) else [sea[key]] if key in sea else []:
            _turn_direction(entry, R)
    return made


def _move_place(place: Document, by: list[float]) -> None:
    if place["body"] == "ground":
        place["point"] = [_number(a, "length") + b for a, b in zip(place["point"], by, strict=True)]


def moved(document: Document, by: list[float]) -> Document:
    """The scene at another place [m]; what moves along with it is what the shift of a block moves."""
    made = copy.deepcopy(document)
    for key, table in TABLES.items():
        entries = made.get(key, {})
        for entry in entries.values() if isinstance(entries, dict) and table.by_name else entries:
            if table.move is not None and isinstance(entry, dict):
                table.move(entry, by)
    for criterion in made.get("criteria", ()):
        _each_place(criterion, lambda place: _move_place(place, by))
    return made


NAMED = tuple(TABLES)
NOT_NAMES = {
    "type",
    "motion",
    "origin",
    "title",
    "sources",
    "source",
    "file",
    "frame",
    "law",
    "start",
    "integrator",
    "note",
}
"""Keys whose texts are words of the language, not names."""


def _with_names(value: Any, change: Callable[[str], str], key: str = "") -> Any:
    if isinstance(value, dict):
        by_name = key in TABLES and TABLES[key].by_name
        return {
            change(name) if by_name else name: _with_names(entry, change, "" if by_name else name)
            for name, entry in value.items()
        }
    if isinstance(value, list):
        return [_with_names(entry, change, key) for entry in value]
    return change(value) if isinstance(value, str) and key not in NOT_NAMES else value


def declared_names(document: Document) -> list[str]:
    """Names that the tables of a scene give, longest first."""
    found: set[str] = set()
    for key, table in TABLES.items():
        entries = document.get(key, {})
        names = entries if table.by_name else [one.get("name") for one in entries]
        found |= {name for name in names if isinstance(name, str)}
    return sorted(found, key=len, reverse=True)


def renamed(document: Document, prefix: str) -> tuple[Document, Callable[[str], str]]:
    """The scene with other names, whose order in the alphabet is the reverse; and what becomes of a name."""
    names = declared_names(document)
    count = len(names)
    new = {name: f"{prefix}{count - place:03d}_{name}" for place, name in enumerate(sorted(names))}
    words = re.compile(
        r"(?<![A-Za-z0-9_])(" + "|".join(re.escape(name) for name in names) + r")(?=[^A-Za-z0-9]|$)"
    )

    def change(text: str) -> str:
        return words.sub(lambda match: new[match[1]], text)

    made = _with_names(copy.deepcopy(document), change)
    return made, change


def reordered(document: Document) -> Document:
    """The scene with the entries of all its tables in the reverse order."""
    made = copy.deepcopy(document)
    for key, table in TABLES.items():
        entries = made.get(key)
        if entries and table.by_name:
            made[key] = dict(reversed(entries.items()))
        elif isinstance(entries, list):
            made[key] = entries[::-1]
    return made


OTHERS = {
    "m": ("mm", 1e3),
    "N": ("kN", 1e-3),
    "kN": ("N", 1e3),
    "MN": ("kN", 1e3),
    "s": ("ms", 1e3),
    "ms": ("s", 1e-3),
    "t": ("kg", 1e3),
    "kg": ("t", 1e-3),
    "deg": ("rad", math.pi / 180.0),
    "mm": ("m", 1e-3),
    "cm": ("m", 1e-2),
}
_TEXT = re.compile(r"^\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?) ([A-Za-z]+)$")


def in_other_units(document: Any, key: str = "") -> Any:
    """The scene with its quantities in other units, where a text has a plain one."""
    if isinstance(document, dict):
        return {name: in_other_units(value, name) for name, value in document.items()}
    if isinstance(document, list):
        return [in_other_units(value, key) for value in document]
    match = _TEXT.match(document) if isinstance(document, str) and key not in NOT_NAMES else None
    if match is None or match[2] not in OTHERS:
        return document
    unit, factor = OTHERS[match[2]]
    return f"{float(match[1]) * factor!r} {unit}"


def doubled(document: Document, by: list[float]) -> tuple[Document, Callable[[str], str]]:
    """The scene and the same beside it, with other names; and what the names of the second are."""
    second, change = renamed(moved(document, by), "q")
    made = copy.deepcopy(document)
    for key, table in TABLES.items():
        if key in second and table.by_name:
            made[key] = {**made[key], **second[key]}
        elif key in second and isinstance(second[key], list):
            made[key] = [*made[key], *second[key]]
    return made, change


def toml_text(document: Mapping[str, Any]) -> str:
    """TOML of a document."""

    def value(one: Any) -> str:
        if isinstance(one, dict):
            return "{" + ", ".join(f"{json.dumps(key)} = {value(entry)}" for key, entry in one.items()) + "}"
        if isinstance(one, (list, tuple)):
            return "[" + ", ".join(value(entry) for entry in one) + "]"
        if isinstance(one, bool):
            return "true" if one else "false"
        return json.dumps(one) if isinstance(one, str) else repr(one)

    return "\n".join(f"{json.dumps(key)} = {value(entry)}" for key, entry in document.items()) + "\n"


class Difference(NamedTuple):
    """How far a channel is from what it must be, relative to its range in the run."""

    channel: str
    error: float


ARMS = {"rad/s": ("m/s", -1), "rad": ("", 0), "N m": ("N", 1), "kg m^2/s": ("kg m/s", 1)}
"""Units with those that are on an arm, and the power of the arm: moments of forces, velocities of turns."""
LEAST = 1e-2
"""Least range of a channel, of the largest of all that have its unit."""


def ranges(results: Results, move: NDArray[np.float64] | None = None) -> dict[str, float]:
    """Range of each channel: its largest amount, at least a hundredth of the largest in its unit.

    What is zero but for rounding has no range of its own; the largest moment is at least that of the largest force on
    the size of the scene, and so on.
    """
    own, units = {}, {}
    for channel in results.names:
        values = np.abs(results[channel])
        own[channel] = float(values[np.isfinite(values)].max(initial=0.0))
        unit = results.unit(channel)
        units[unit] = max(units.get(unit, 0.0), own[channel])
    places = [
        results[one].reshape(len(results.time), -1, 3) for one in results.names if one.endswith(".position")
    ]
    spread = np.concatenate([one.reshape(-1, 3) for one in places]) if places else np.zeros((1, 3))
    arm = max(1.0, float(np.ptp(spread, axis=0).max()))
    far = arm + float(np.abs(spread).max()) + float(np.abs(np.zeros(3) if move is None else move).max())
    speed = units.get("m/s", 0.0)
    units["kg m/s"] = max(units.get("kg m/s", 0.0), own.get("energy.kinetic", 0.0) / (speed or 1.0))
    for unit, (other, power) in ARMS.items():
        units[unit] = max(units.get(unit, 0.0), units.get(other, 0.0) * arm**power if other else 1.0)
    own["momentum.angular"] = max(own.get("momentum.angular", 0.0), units["kg m/s"] * far)  # about the origin
    return {
        channel: max(value, LEAST * units[results.unit(channel)]) or 1.0
        for channel, value in own.items()
        if channel in results
    }


def changed_owner(channel: str, name: Callable[[str], str]) -> str:
    """A channel whose owner has another name."""
    owner, dot, rest = channel.partition(".")
    return name(owner) + dot + rest


WHOLE = ("energy.", "momentum.", "monitor.")
"""Channels of the whole scene."""


def differences(
    one: Results,
    other: Results,
    *,
    name: Callable[[str], str] = lambda text: text,
    R: NDArray[np.float64] | None = None,
    move: NDArray[np.float64] | None = None,
    copies: int = 1,
) -> Iterator[Difference]:
    """Compare all channels of a run with those of the same scene said otherwise.

    A channel follows if it is the same, or, as a vector of the world, turned; a place in the world is moved, too.
    Energies and momenta of several copies are as many times those of one; what has a zero that is chosen is compared
    from its start on.

    Raises
    ------
    AssertionError
        If the records are not at the same times, or a channel is missing.
    """
    from scipy.spatial.transform import Rotation

    np.testing.assert_allclose(one.time, other.time, rtol=1e-12, atol=1e-9)
    R, move = np.eye(3) if R is None else R, np.zeros(3) if move is None else move
    scales = ranges(one, move)
    for channel in one.names:
        same = channel if channel.startswith(WHOLE) else changed_owner(channel, name)
        assert same in other, f"{same} is missing"
        a, b = np.asarray(one[channel]), np.asarray(other[same])
        assert a.shape == b.shape, channel
        if channel.startswith("monitor."):
            continue
        expected = [a]
        if channel in {"energy.potential", "energy.balance"}:
            a, b = a - a[0], b - b[0]
            expected = [copies * a]
        elif channel == "momentum.angular":
            if copies > 1:
                continue
            expected = [a @ R.T + np.cross(move, one["momentum.linear"] @ R.T)]
        elif channel.startswith(WHOLE):
            expected = [copies * a] if a.ndim == 1 else [copies * a @ R.T]
        elif channel.endswith(".direction"):  # of wind and current, from x of the world
            expected = [a + math.atan2(R[1, 0], R[0, 0])]
        elif channel.endswith(".orientation"):
            turn = Rotation.from_matrix(R)
            made = (turn * Rotation.from_quat(a, scalar_first=True)).as_quat(scalar_first=True)
            expected = [made * np.sign((made * b).sum(axis=1))[:, None]]
        elif a.ndim == 2 and a.shape[1] % 3 == 0:
            vectors = a.reshape(len(a), -1, 3)
            expected += [(vectors @ R.T).reshape(a.shape)]
            if one.unit(channel) == "m":
                expected += [(vectors @ R.T + move).reshape(a.shape)]
        errors = np.full(len(a), math.inf)
        for wanted in expected:
            finite = np.isfinite(wanted) & np.isfinite(b)
            alike = np.isfinite(wanted) == np.isfinite(b)
            off = np.where(alike, np.where(finite, np.abs(wanted - b), 0.0), math.inf)
            errors = np.minimum(errors, off.reshape(len(a), -1).max(axis=1))
        yield Difference(channel, float(errors.max(initial=0.0)) / scales[channel])


def written(document: Document, folder: Path, file: Path) -> Path:
    """A case folder with the other files of a case and a changed document."""
    import shutil

    shutil.copytree(file.parent, folder, ignore=shutil.ignore_patterns("out", "*.py", "README.md"))
    (folder / "case.toml").write_text(toml_text(document))
    return folder


__all__ = [
    "Difference",
    "about_vertical",
    "declared_names",
    "differences",
    "doubled",
    "in_other_units",
    "moved",
    "renamed",
    "reordered",
    "toml_text",
    "turned",
    "written",
]
