"""The tables of a case file that make up its scene: one entry a table, over which all goes that concerns every table.

An entry is a field of `SceneTables` with a `Table` in its annotation. Blocks that repeat tables, the names and channels
that a document declares, places in messages, digests and the outer forces of a scene follow from it.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import contextlib
import inspect
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args, get_origin

from pydantic import Field, create_model

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyPoint, InWorld
from heavylift.numerics.units import KINDS, parse_quantity
from heavylift.pipeline.case.bodies import BODY_SECTIONS, BodyTable, RigidBodySection
from heavylift.pipeline.case.channel_kinds import MESH_TYPES, Declared, all_channels, joint_coordinate
from heavylift.pipeline.case.collisions import collision_section, declared_collisions, yields
from heavylift.pipeline.case.contacts import contact_section
from heavylift.pipeline.case.described import Chosen, Later
from heavylift.pipeline.case.errors import chosen_in, is_chosen, sections_in
from heavylift.pipeline.case.fields import GROUND, AccelerationVector, HullName, Name, Section, UniqueName
from heavylift.pipeline.case.joints import Joint
from heavylift.pipeline.equipment.builders import BUILDERS, EQUIPMENT
from heavylift.solver.scene.bodies import Fixed, Free
from heavylift.solver.scene.collisions import Collision
from heavylift.solver.scene.connections import FORCES, MEASURES, ROPES
from heavylift.solver.scene.contacts import COLLISION_LAWS, CONTACT_LAWS, Contact
from heavylift.solver.scene.descriptions import (
    ChannelKind,
    described_fields,
    is_described,
    recorded_channels,
)
from heavylift.solver.scene.moorings import MOORINGS
from heavylift.solver.scene.scene import SENSORS
from heavylift.solver.scene.sea import AT_SEA
from heavylift.solver.scene.transport import TRANSPORT
from heavylift.solver.scene.wind_loads import FLUID_LOADS, WindField

__all__ = ["TABLES", "SceneTables", "Table", "declared", "lengths"]

_HERE = "heavylift.pipeline.case"

Vector = list[float]
Row = Mapping[str, Any]


# what is moved in the world


def _move_body(body: dict[str, Any], move: Vector) -> None:
    """Move where a body starts; without a position that of its geometry."""
    frame, initial = body.get("frame"), body.setdefault("initial", {})
    if not isinstance(initial, dict):
        return
    given = initial.get("position")
    if given is None and isinstance(frame, dict) and frame.get("origin") == "centre_of_mass":
        given = body.get("centre_of_mass") if body.get("type") == "rigid" else None
        if given is None:
            raise InputError(
                "is missing, and the frame starts at a centre of mass that is computed",
                key="initial.position",
                expected="a position [m] for the body to be shifted from",
            )
    initial["position"] = _moved([0.0, 0.0, 0.0] if given is None else given, move)
    if isinstance(frame, dict) and "angle" in frame:
        frame["pivot"] = _moved(frame.get("pivot", [0.0, 0.0, 0.0]), move)


def _move_sides(entry: dict[str, Any], move: Vector) -> None:
    """Move the places in the world of what is between bodies, and its points on the ground."""
    if "at" in entry:
        entry["at"] = _moved(entry["at"], move)
    sides, points = entry.get("between"), entry.get("points")
    if isinstance(sides, list) and isinstance(points, list):
        entry["points"] = [
            _moved(point, move) if side == GROUND else point
            for side, point in zip(sides, points, strict=False)
        ] + points[len(sides) :]


def _move_path(entry: dict[str, Any], move: Vector) -> None:
    """Move the points of a rope on the ground."""
    path = entry.get("path")
    for stop in path if isinstance(path, list) else ():
        if isinstance(stop, dict) and stop.get("body") == GROUND and "point" in stop:
            stop["point"] = _moved(stop["point"], move)


def _move_described(described: Any, entry: dict[str, Any], move: Vector) -> None:
    """Move the places in the world and on the ground that a description says a table has, and those of its parts."""
    for field in described_fields(described):
        mark = field.mark((BodyPoint, InWorld))
        on_ground = isinstance(mark, BodyPoint) and entry.get(mark.of or "body") == GROUND
        if isinstance(mark, InWorld) and isinstance(field.default, tuple):
            entry.setdefault(field.name, list(field.default))
        if (on_ground or isinstance(mark, InWorld)) and field.name in entry:
            entry[field.name] = _moved(entry[field.name], move)
        given = entry.get(field.name)
        for part in given if isinstance(given, list) else [given]:
            if isinstance(part, dict):
                for inner in filter(is_described, (field.hint, *get_args(field.hint))):
                    _move_described(inner, part, move)


def _move_deck(entry: dict[str, Any], move: Vector) -> None:
    """Move a deck of the ground."""
    if entry.get("body", GROUND) == GROUND:
        entry["origin"] = _moved(entry.get("origin", [0.0, 0.0, 0.0]), move)


def _move_surface(entry: dict[str, Any], move: Vector) -> None:
    """Move a surface of the ground, and the boxes that exclude its triangles; those of bodies move with them."""
    if entry.get("body") != GROUND:
        return
    entry["at"] = _moved(entry.get("at", [0.0, 0.0, 0.0]), move)
    boxes = entry.get("exclude")
    for box in boxes if isinstance(boxes, list) else ():
        if isinstance(box, dict) and "centre" in box:
            box["centre"] = _moved(box["centre"], move)


def _move_contour(entry: dict[str, Any], move: Vector) -> None:
    """Move the points of a contour of the ground; those in a file stay where they are."""
    if entry.get("body") != GROUND:
        return
    if "points" in entry:
        entry["points"] = _moved_all(entry["points"], move)
    for key, name in (("circle", "centre"), ("spline", "control")):
        table = entry.get(key)
        if isinstance(table, dict):
            table[name] = _moved_all(table.get(name, [0.0, 0.0, 0.0]), move)


def _moved_all(points: Any, move: Vector) -> Any:
    """A point, or lists of points, moved."""
    if isinstance(points, list) and points and isinstance(points[0], list):
        return [_moved_all(point, move) for point in points]
    return _moved(points, move)


def _moved(point: Any, move: Vector) -> Any:
    """A point in SI, moved; left alone if it is none, for the validation to refuse."""
    given = lengths(point)
    return point if given is None else [a + b for a, b in zip(given, move, strict=True)]


def lengths(values: Any) -> Vector | None:
    """Three lengths [m], or None if that is not what is given."""
    if isinstance(values, list) and len(values) == 3:
        with contextlib.suppress(InputError):
            return [parse_quantity(value, KINDS["length"]) for value in values]
    return None


# what is recorded of an entry, as read from TOML


def _of_body(row: Row) -> tuple[ChannelKind, ...]:
    section, frame = BODY_SECTIONS.get(str(row.get("type"))) or RigidBodySection, row.get("frame")
    free = "frame" not in section.model_fields or (isinstance(frame, dict) and frame.get("motion") == "free")
    return (*section.CHANNELS, *(Free if free else Fixed).CHANNELS)


# what acts on a scene from outside


def _is_held(body: Any, _case: Any) -> bool:
    return not body.is_free


def _on_ground(entry: Any, _case: Any) -> bool:
    return GROUND in getattr(entry, "between", ())


def _rope_on_ground(rope: Any, _case: Any) -> bool:
    return any(stop.body == GROUND for stop in rope.path)


def _on_ground_deck(_transporter: Any, case: Any) -> bool:
    return any(deck.body == GROUND for deck in case.decks)


def _on_contour_of_ground(contact: Any, case: Any) -> bool:
    return bool(case.contours[contact.between[1]].body == GROUND)


def _pairs_with_ground(collision: Any, case: Any) -> list[str]:
    ground = {surface.name for surface in case.surfaces if surface.body == GROUND}
    pairs = {
        name: pair for name, (index, pair) in case.collided.items() if case.collisions[index] is collision
    }
    return [name for name, pair in pairs.items() if ground & set(pair)]


@dataclass(frozen=True)
class Table:
    """Annotation of a table of a case.

    Attributes
    ----------
    words, one
        What its entries are, at the beginning of a sentence; and one of them.
    names
        Whether its entries have names of their own, first parts of channels that no other entry has; names of
        ``"bodies"``, beside whose channels stand theirs; or names that stand ``"apart"``.
    records
        Channels of an entry, or what says them of an entry as read from TOML; if absent, those of the description or
        section that an entry chooses.
    move
        Moves the places in the world that an entry as read from TOML says, by a vector [m] in the world.
    is_outer
        Whether an entry of a case acts from outside: changes the momentum of the scene; or names of its parts that do.
    key, by_name, chosen, annotation
        Its key; whether it holds its entries by name, or is a list; what chooses their description, or the annotation
        with sections that they may be.
    """

    words: str
    one: str
    names: Literal["own", "bodies", "apart"] = "own"
    records: tuple[ChannelKind, ...] | Callable[[Row], tuple[ChannelKind, ...]] | None = None
    move: Callable[[dict[str, Any], Vector], None] | None = None
    is_outer: Callable[[Any, Any], bool | list[str]] = lambda entry, case: False  # noqa: ARG005
    key: str = ""
    by_name: bool = False
    chosen: Chosen | None = None
    annotation: Any = None

    @property
    def repeated(self) -> tuple[Any, Any]:
        """Type and default of its key in a block that repeats tables."""
        if self.by_name:
            words = f"{self.words} by name, as in the case."
            return dict[str, dict[str, Any]], Field(default_factory=dict, description=words)
        return tuple[dict[str, Any], ...], Field((), description=f"{self.words}, as in the case.")

    def written(self, document: Mapping[str, Any]) -> Iterator[tuple[str, Row]]:
        """Entries of a document as read from TOML that have a name; of one that is no table, an empty one."""
        entries: Any = document.get(self.key)
        if self.by_name and isinstance(entries, dict):
            for name, row in entries.items():
                yield name, row if isinstance(row, dict) else {}
        elif not self.by_name:
            yield from _named(entries)

    def entries(self, case: "SceneTables") -> Iterator[tuple[str, str, Any]]:
        """Entries of a case: dotted key, name, and section."""
        found: Any = getattr(case, self.key)
        if self.by_name:
            yield from ((f"{self.key}.{name}", name, entry) for name, entry in found.items())
        else:
            yield from ((f"{self.key}.{index}", entry.name, entry) for index, entry in enumerate(found))

    def outer(self, case: "SceneTables") -> Iterator[tuple[str, Any]]:
        """What of a case acts from outside: names, and sections."""
        for _, name, entry in self.entries(case):
            found = self.is_outer(entry, case)
            for part in found if isinstance(found, list) else [name] * found:
                yield part, entry

    def channels(self, row: Row, joints: Mapping[str, str]) -> dict[str, str]:
        """Last parts of the channels of an entry as read from TOML, and their kinds; of a type that is unknown all.

        `joints` are the types of the joints by name.
        """
        own, records = None, self.records
        if records is not None:
            own = records if isinstance(records, tuple) else records(row)
        elif self.chosen is not None:
            described = self.chosen.described(row)
            along = joint_coordinate(joints.get(str(row.get("joint")), ""), row.get("coordinate")) or "angle"
            own = None if described is None else recorded_channels(described, along)
        else:
            sections: tuple[Any, ...] = tuple(sections_in(self.annotation))
            of_type = [section for section in sections if is_chosen(section, row)]
            alike = {section.CHANNELS for section in of_type or sections}
            own = alike.pop() if len(alike) == 1 else None
        return all_channels() if own is None else _quantities(own)


class GravitySection(Section):
    """Uniform gravity."""

    acceleration: AccelerationVector
    """World axes [m/s^2]."""


class _Structure(Section):
    """Tables before those of equipment."""

    bodies: Annotated[
        dict[UniqueName, BodyTable],
        Field(min_length=1),
        Table("Bodies", "body", records=_of_body, move=_move_body, is_outer=_is_held),
    ]
    """Bodies by name."""
    gravity: GravitySection | None = None
    """Uniform gravity; none if absent."""
    joints: Annotated[
        tuple[Joint, ...],
        Table("Joints", "joint", move=_move_sides, is_outer=_on_ground),
    ] = ()
    """Joints between two bodies, or a body and the ground."""
    ropes: Annotated[
        tuple[Annotated[Any, Chosen(ROPES)], ...],
        Table("Ropes", "rope", move=_move_path, is_outer=_rope_on_ground),
    ] = ()
    """Ropes."""


def _equipment_table(word: str) -> tuple[Any, Any]:
    """Type and default of the table of a builder, whose words follow from its word, its class and its docstring."""
    described = BUILDERS[word]
    title = word.replace("_", " ").capitalize()
    one = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", described.__name__).lower()
    table = Table(
        title,
        one,
        "own" if described.OWN_NAME else "apart",
        records=(),
        move=partial(_move_described, described),
    )
    sentence = str(inspect.getdoc(described))
    words = f"{title}: {sentence[0].lower()}{sentence[1:]}"
    tables = tuple[Annotated[Any, Chosen(EQUIPMENT, word=word)], ...]
    return Annotated[tables, table], Field((), description=words)


if TYPE_CHECKING:

    class _EquippedScene(_Structure):
        gantry_cranes: tuple[Any, ...]
        falls: tuple[Any, ...]
        equalizers: tuple[Any, ...]
else:
    _EquippedScene = create_model(
        "_EquippedScene",
        __base__=_Structure,
        __module__=__name__,
        **{word: _equipment_table(word) for word in BUILDERS},
    )


def _hull_section(described: Any) -> type[Section]:
    from heavylift.pipeline.case.hulls import hull_section

    return hull_section(described)


class SceneTables(_EquippedScene):
    """What a case says of its scene."""

    forces: Annotated[
        tuple[Annotated[Any, Chosen(FORCES)], ...],
        Table(
            "Forces",
            "force",
            move=_move_sides,
            is_outer=lambda force, case: hasattr(force, "body") or _on_ground(force, case),
        ),
    ] = ()
    """Applied forces, springs, motors."""
    contours: Annotated[
        dict[UniqueName, Annotated[Any, Later(f"{_HERE}.contours", "Contour")]],
        Table("Contours", "contour", move=_move_contour),
    ] = Field(default_factory=dict)
    """Curves and surfaces of bodies that something may touch, by name."""
    contacts: Annotated[
        tuple[Annotated[Any, Chosen(CONTACT_LAWS, contact_section)], ...],
        Table(
            "Contacts",
            "contact",
            records=Contact.CHANNELS,
            move=_move_sides,
            is_outer=_on_contour_of_ground,
        ),
    ] = ()
    """What touches contours, and by what law."""
    surfaces: Annotated[
        tuple[Annotated[Any, Later(f"{_HERE}.surfaces", "SurfaceSection")], ...],
        Table("Surfaces", "surface", move=_move_surface),
    ] = ()
    """Triangles of bodies that may touch those of others: CAD files and simple shapes."""
    collisions: Annotated[
        tuple[Annotated[Any, Chosen(COLLISION_LAWS, collision_section)], ...],
        Table("Collisions", "collision", records=(), is_outer=_pairs_with_ground),
    ] = ()
    """Which surfaces may touch, and by what law."""
    sea: Annotated[Any, Later(f"{_HERE}.sea", "SeaSection")] | None = None
    """Water, waves, wind and current."""
    hulls: Annotated[
        dict[HullName, Annotated[Any, Chosen(AT_SEA, _hull_section, word="hulls")]],
        Table("Hulls", "hull", "bodies", is_outer=lambda _hull, _case: True),
    ] = Field(default_factory=dict)
    """What floats, by the names of rigid bodies."""
    databases: Annotated[
        dict[Name, Annotated[Any, Later(f"{_HERE}.hulls", "DatabaseSection")]],
        Table("Databases", "database", "apart"),
    ] = Field(default_factory=dict)
    """Added mass, damping and excitation of hulls, by names of their own."""
    tanks: Annotated[tuple[Annotated[Any, Chosen(AT_SEA, word="tanks")], ...], Table("Tanks", "tank")] = ()
    """Ballast water in hulls."""
    pumps: Annotated[tuple[Annotated[Any, Chosen(AT_SEA, word="pumps")], ...], Table("Pumps", "pump")] = ()
    """What moves the water of tanks."""
    controllers: Annotated[
        tuple[Annotated[Any, Chosen(AT_SEA, word="controllers")], ...], Table("Controllers", "controller")
    ] = ()
    """What keeps hulls level by pumps."""
    fluid_loads: Annotated[
        tuple[Annotated[Any, Chosen(FLUID_LOADS)], ...],
        Table(
            "Loads of wind and current",
            "load",
            is_outer=lambda _load, _case: True,
        ),
    ] = ()
    """What wind and current push on."""
    lines: Annotated[
        tuple[Annotated[Any, Chosen(MOORINGS, word="lines")], ...],
        Table(
            "Mooring lines",
            "line",
            move=_move_sides,
            is_outer=_on_ground,
        ),
    ] = ()
    """Mooring lines that hang by their weight."""
    fenders: Annotated[
        tuple[Annotated[Any, Chosen(MOORINGS, word="fenders")], ...],
        Table("Fenders", "fender", move=_move_sides, is_outer=_on_ground),
    ] = ()
    """One-sided springs between bodies."""
    decks: Annotated[
        tuple[Annotated[Any, Chosen(TRANSPORT, word="decks")], ...],
        Table("Decks", "deck", "apart", move=_move_deck),
    ] = ()
    """Pieces of a road."""
    transporters: Annotated[
        tuple[Annotated[Any, Chosen(TRANSPORT, word="transporters")], ...],
        Table("Transporters", "transporter", is_outer=_on_ground_deck),
    ] = ()
    """Bodies on bogies that roll over all decks."""
    sensors: Annotated[
        tuple[Annotated[Any, Chosen(SENSORS, word="sensors")], ...], Table("Sensors", "sensor")
    ] = ()
    """Material points whose motion is recorded."""
    relative_motions: Annotated[
        tuple[Annotated[Any, Chosen(MEASURES, word="relative_motions")], ...],
        Table("Relative motions", "relative motion", move=_move_sides),
    ] = ()
    """Motions of points of bodies in the axes of other bodies."""
    leads: Annotated[
        tuple[Annotated[Any, Chosen(MEASURES, word="leads")], ...],
        Table("Fleet angles", "lead", move=_move_sides),
    ] = ()
    """Angles of ropes against where they should point."""
    lugs: Annotated[
        tuple[Annotated[Any, Chosen(MEASURES, word="lugs")], ...],
        Table("Lugs", "lug"),
    ] = ()
    """Forces of ropes on lugs, in the plane of the eye and across it."""
    hook_loads: Annotated[
        tuple[Annotated[Any, Chosen(MEASURES, word="hook_loads")], ...],
        Table("Hook loads", "hook load"),
    ] = ()
    """What hangs on bodies that ropes carry."""
    rope_groups: Annotated[
        tuple[Annotated[Any, Chosen(MEASURES, word="rope_groups")], ...],
        Table("Rope groups", "rope group"),
    ] = ()
    """Tensions of ropes that share a load."""
    fmus: Annotated[
        tuple[Annotated[Any, Later(f"{_HERE}.fmus", "FmuSection")], ...], Table("FMUs", "FMU", "apart")
    ] = ()
    """Functional mock-up units that run beside the scene."""
    scenario: Annotated[Any, Later(f"{_HERE}.scenario", "ScenarioSection")] | None = None
    """Phases of an operation."""


TABLES: Mapping[str, Table] = {
    key: replace(
        mark,
        key=key,
        by_name=get_origin(field.annotation) is dict,
        chosen=chosen_in(field.annotation),
        annotation=field.annotation,
    )
    for key, field in SceneTables.model_fields.items()
    for mark in field.metadata
    if isinstance(mark, Table)
}
"""By key, in the order of the case file."""


def declared(document: Mapping[str, Any]) -> Declared:
    """Collect the names of a document as read from TOML, blocks written out."""
    rows = {key: list(table.written(document)) for key, table in TABLES.items()}
    bodies, contours = dict(rows["bodies"]), dict(rows["contours"])
    joints: dict[str, str] = {}
    for name, row in rows["joints"]:
        joints.setdefault(name, str(row.get("type")))  # of a name that occurs again the first one counts
    channels: dict[str, Mapping[str, str]] = {}
    for key, table in TABLES.items():
        if table.names == "own":
            channels |= {name: table.channels(row, joints) for name, row in rows[key]}
        elif table.names == "bodies":
            beside = {name: table.channels(row, joints) for name, row in rows[key] if name in bodies}
            channels |= {name: {**channels[name], **own} for name, own in beside.items()}
    surfaces = {name: str(row.get("body")) for name, row in rows["surfaces"]}
    yielding = frozenset(name for name, body in bodies.items() if yields(body))
    collided = declared_collisions(rows["collisions"], surfaces, yielding)
    channels |= {pair: _quantities(Collision.CHANNELS) for _, pair, _ in collided}
    fluids = _fluids(document)
    channels |= dict.fromkeys(fluids, _quantities(WindField.CHANNELS))  # a current has the same
    types = {name: str(body.get("type")) for name, body in bodies.items() if body}
    references, checks = list(_named(document.get("reference"))), list(_named(document.get("check"), "id"))
    own = [(table.by_name, key) for key, table in TABLES.items() if table.names == "own"]
    return Declared(
        names=Counter(
            [name for by_name, key in own if by_name for name, _ in rows[key]]
            + [*(pair for name, pair, _ in collided if pair != name), *fluids]
            + [name for by_name, key in own if not by_name for name, _ in rows[key]]
        ),
        bodies=frozenset(bodies),
        body_types=types,
        contours={
            name: (str(row.get("type")), str(row.get("body"))) if row else ("", "")
            for name, row in contours.items()
        },
        surfaces=surfaces,
        yielding=yielding,
        collisions={pair: recorded for _, pair, recorded in collided},
        meshes=frozenset(name for name, kind in types.items() if kind in MESH_TYPES),
        shells=frozenset(name for name, kind in types.items() if kind == "shell"),
        joints=joints,
        hulls=frozenset(name for name, _ in rows["hulls"] if name in bodies),
        fluids=frozenset(fluids),
        lines=frozenset(name for name, _ in rows["lines"]),
        transporters=frozenset(name for name, _ in rows["transporters"]),
        sensors={name: str(row.get("body")) for name, row in rows["sensors"]},
        channels=channels,
        references={
            name: (str(row.get("channel")), row.get("scale") is not None) for name, row in references
        },
        checks={name: str(row.get("quantity", "")) for name, row in checks if "reference" in row},
        reference_names=Counter(name for name, _ in references),
        check_ids=Counter(name for name, _ in checks),
    )


def _named(rows: Any, name: str = "name") -> Iterator[tuple[str, dict[str, Any]]]:
    """Entries of a list of tables that have a name."""
    for row in rows if isinstance(rows, list) else ():
        if isinstance(row, dict) and isinstance(row.get(name), str):
            yield row[name], row


def _fluids(document: Mapping[str, Any]) -> list[str]:
    """Names of winds and currents, as often as they occur; a table alone may have none of its own."""
    sea = document.get("sea")
    found = []
    for kind in ("wind", "current"):
        rows = sea.get(kind, []) if isinstance(sea, dict) else []
        for row in [rows] if isinstance(rows, dict) else rows if isinstance(rows, list) else []:
            name = row.get("name", kind) if isinstance(row, dict) else None
            found += [name] if isinstance(name, str) else []
    return found


def _quantities(channels: Iterable[ChannelKind]) -> dict[str, str]:
    """Last parts of channels, and their quantities."""
    return {channel.name: channel.quantity for channel in channels}
