"""Field types of case files: quantities with units, names, and paths that stay in the case folder."""

from __future__ import annotations

import contextlib
import math
from dataclasses import field
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NoReturn

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    StringConstraints,
    ValidationInfo,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Positive, Quantity, quantity_schema
from heavylift.numerics.units import KINDS, parse_quantity
from heavylift.pipeline.case.channel_kinds import RESERVED_NAMES, Declared
from heavylift.pipeline.case.channel_names import is_pattern
from heavylift.pipeline.case.quantity_names import channel_kind, channel_members, parse_quantity_name

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from heavylift.solver.scene.descriptions import ChannelKind

__all__ = [
    "GROUND",
    "TAG",
    "AccelerationVector",
    "AngularVelocityVector",
    "AnyOf",
    "BodyName",
    "BodyPlace",
    "CaseContext",
    "CheckId",
    "Direction",
    "ForceVector",
    "GroupName",
    "HullName",
    "InFolder",
    "KnownHull",
    "LengthVector",
    "MomentVector",
    "Name",
    "NoDefault",
    "NodeNumber",
    "NumberVector",
    "Positive",
    "Quantity",
    "QuantityString",
    "RecordedChannel",
    "RecordedChannels",
    "ReferenceName",
    "Section",
    "SideName",
    "UniqueName",
    "VelocityVector",
    "as_list",
    "files_read",
    "parse_list",
    "quantity_schema",
    "refuse_unknown",
    "reject",
    "type_tag",
]

GROUND = "ground"
"""Name of the world as a side of a joint, spring or rope."""
TAG = "type "
"""Beginning of the tags that `type_tag` gives."""
LONGEST_DIRECTION = 1e100
"""Length of a direction, which is divided by it; its inverse is the shortest."""
_SHOWN = 20  # names of a list in a message at most


class Section(BaseModel):
    """Base of every table of a case file: unknown keys are errors, values never change.

    A table is made ready for validation only when it is needed, those of a case all at once with it.
    """

    model_config: ClassVar[ConfigDict] = ConfigDict(
        extra="forbid", frozen=True, strict=False, allow_inf_nan=False, defer_build=True
    )
    CHANNELS: ClassVar[Sequence[ChannelKind]] = ()
    """What is recorded of that which a table describes."""


@dataclass(frozen=True)
class CaseContext:
    """What field validators may know of the rest of the case: its folder and the names it declares."""

    folder: Path
    names: Declared = field(default_factory=Declared)

    @staticmethod
    def of(info: ValidationInfo) -> CaseContext | None:
        """Context of a validation, if there is one."""
        return info.context if isinstance(info.context, CaseContext) else None


def reject(problem: str, expected: str, *, key: str = "", kind: str = "case") -> NoReturn:
    """Raise a validation error that `heavylift.pipeline.case.errors` turns into an `InputError`.

    Parameters
    ----------
    problem, expected
        What is wrong, and what would have been right.
    key
        Dotted key below the validated table, if one key of it is to blame.
    kind
        ``"case"``, or ``"repeated"`` for a name that occurs again: reported for its last occurrence only.
    """
    raise PydanticCustomError(kind, "{problem}", {"problem": problem, "expected": expected, "key": key})


def as_list(value: Any) -> Any:
    """A single name as a list of one."""
    return [value] if isinstance(value, str) else value


def type_tag(value: object, default: str) -> str:
    """Tag of a union member by its ``type``: set apart by a word, because a type may be called like a key."""
    given = value.get("type", default) if isinstance(value, dict) else getattr(value, "type", default)
    return f"{TAG}{given}"


@dataclass(frozen=True)
class AnyOf:
    """Annotation of a number in SI, or a string with a unit of one of two kinds; validates to the SI number."""

    first: Quantity
    second: Quantity

    def parse(self, value: object) -> float:
        """SI number of an input value; the error of one that fits neither quantity names the first."""
        if isinstance(value, str):
            with contextlib.suppress(InputError):
                parse_quantity(value, KINDS[self.second.kind])
                return self.second.validate(value)
        return self.first.validate(value)

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return self.first.__get_pydantic_json_schema__(schema, handler)


def parse_list(quantity: Quantity, values: Sequence[object], key: str = "") -> list[float]:
    """SI numbers of a list.

    Raises
    ------
    InputError
        If one is wrong, with its index behind `key`.
    """
    found = []
    for index, value in enumerate(values):
        try:
            found.append(quantity.parse(value))
        except InputError as error:
            raise InputError(error.problem, key=f"{key}{index}", expected=error.expected) from None
    return found


_Length = Annotated[float, Quantity("length")]
_Number = Annotated[float, Quantity("number")]
_Velocity = Annotated[float, Quantity("velocity")]
_AngularVelocity = Annotated[float, Quantity("angular velocity")]
_Acceleration = Annotated[float, Quantity("acceleration")]
_Force = Annotated[float, Quantity("force")]
_Moment = Annotated[float, Quantity("moment or energy")]
LengthVector = tuple[_Length, _Length, _Length]
"""Three quantities of kind length."""


class _OrInterface:
    """Tells editors that the name of an interface may stand in place of a point, which is there before validation."""

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        return {"anyOf": [handler(core), {"type": "string", "minLength": 1}]}


BodyPlace = Annotated[LengthVector, _OrInterface()]
"""A point of a body, or in a case file the name of an interface of it."""
NumberVector = tuple[_Number, _Number, _Number]
"""Three quantities of kind number."""
VelocityVector = tuple[_Velocity, _Velocity, _Velocity]
"""Three quantities of kind velocity."""
AngularVelocityVector = tuple[_AngularVelocity, _AngularVelocity, _AngularVelocity]
"""Three quantities of kind angular velocity."""
AccelerationVector = tuple[_Acceleration, _Acceleration, _Acceleration]
"""Three quantities of kind acceleration."""
ForceVector = tuple[_Force, _Force, _Force]
"""Three quantities of kind force."""
MomentVector = tuple[_Moment, _Moment, _Moment]
"""Three quantities of kind moment."""

Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_-]*$", max_length=60)]
"""Name of a body, group, joint, rope, force or sensor; without dots, because channel names are dotted paths."""
NodeNumber = Annotated[int, Field(ge=0, strict=True)]
"""Number of a node of a frame or shell."""
GroupName = Annotated[str, StringConstraints(min_length=1, max_length=200)]
"""Name of a group of nodes, of the case or as its file has it: ``"SET1 4"``, ``"PSHELL 3"``."""


def _unreserved(name: str, info: ValidationInfo) -> str:
    """Names share one space, because they are the first parts of channel names."""
    context = CaseContext.of(info)
    if name in RESERVED_NAMES:
        what = "the world" if name == GROUND else "a channel of the whole scene"
        reject(f"{name!r} is the name of {what}", "another name")
    if context and context.names.names[name] > 1 and name in context.names.fluids:
        unnamed = name in {"wind", "current"}
        explained = ", which is called so unless it has a 'name' of its own" if unnamed else ""
        reject(
            f"{name!r} is the name of a wind or current of the sea{explained}",
            f"another name, or a 'name' in [sea.{name}]" if unnamed else "another name",
            kind="repeated",
        )
    if context and context.names.names[name] > 1:
        reject(
            f"{name!r} occurs {context.names.names[name]} times",
            "one body, joint, rope, force, sensor, relative motion, surface, collision, contour or contact a name",
            kind="repeated",
        )
    return name


def refuse_unknown(what: str, name: str, names: Collection[str], *, key: str = "") -> None:
    """Reject a name that is not among those known, with the nearest one as a hint; `key` as in `reject`."""
    if name not in names:
        known = sorted(names)
        near = get_close_matches(name, known, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        more = f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else ""
        reject(
            f"{what} {name!r} does not exist{hint}",
            f"one of: {', '.join(known[:_SHOWN]) or 'none'}{more}",
            key=key,
        )


def _known_body(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context:
        refuse_unknown("body", name, context.names.bodies)
    return name


def _known_side(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context and name != GROUND:
        refuse_unknown("body", name, context.names.bodies)
    return name


def _known_hull(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context:
        refuse_unknown("hull", name, context.names.hulls)
    return name


def _floats(name: str, info: ValidationInfo) -> str:
    """Only free rigid bodies float."""
    context = CaseContext.of(info)
    if context is None:
        return name
    refuse_unknown("body", name, context.names.bodies)
    kind = context.names.body_types.get(name, "")
    if kind != "rigid":
        reject(f"{name!r} is a {kind} body", "the name of a rigid body")
    if name not in context.names.yielding:
        reject(
            f"the frame of {name!r} is not free", "frame motion 'free'; a fixed joint to the ground holds it"
        )
    return name


def _nonzero(axis: tuple[float, float, float]) -> tuple[float, float, float]:
    """Refuse a direction of no length, or whose length is no number that can be squared."""
    if not any(axis):
        reject("a direction of length zero", "three numbers that are not all zero")
    length = math.hypot(*axis)
    if not 1.0 / LONGEST_DIRECTION <= length <= LONGEST_DIRECTION:
        reject(f"a direction of length {length:.3g}", "three numbers of about 1")
    return axis


def _unique_check(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context and context.names.check_ids[name] > 1:
        reject(f"{name!r} occurs {context.names.check_ids[name]} times", "one check an id", kind="repeated")
    return name


def _unique_reference(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context and context.names.reference_names[name] > 1:
        times = context.names.reference_names[name]
        reject(f"{name!r} occurs {times} times", "one reference a name", kind="repeated")
    return name


def _quantity_string(text: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    try:
        quantity = parse_quantity_name(text, None if context is None else context.names)
    except InputError as error:
        reject(error.problem, error.expected)
    owners = {} if context is None else context.names.names
    if owners and quantity.owner and quantity.owner not in owners:
        near = get_close_matches(quantity.owner, owners, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        reject(
            f"{text!r} names {quantity.owner!r}, which does not exist{hint}", f"one of: {', '.join(owners)}"
        )
    return text


def _recorded_channel(name: str, info: ValidationInfo) -> str:
    """A channel that a simulation of the case records, or a combination of such channels."""
    context = CaseContext.of(info)
    names = None if context is None else context.names
    if "(" not in name:
        owner, dot, last = name.partition(".")
        number = last.rpartition(".")[0]  # of a node of an edge, or a contact of a collision
        if not dot or (number and not (number.isdecimal() or number.startswith("contact_"))):
            reject(f"{name!r} is no channel", "OWNER.CHANNEL, e.g. 'tip.position'")
        if names is not None and owner not in {*names.names, *SCENE_OWNERS}:
            near = get_close_matches(owner, names.names, 1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            reject(
                f"{name!r} names {owner!r}, which does not exist{hint}",
                f"one of: {', '.join(names.names)}",
            )
    try:
        channel_kind(name, name, names)
    except InputError as error:
        reject(error.problem.replace("quantity", "channel"), error.expected)
    return name


def _fitting_channels(name: str, info: ValidationInfo) -> str:
    """A channel, or a pattern of channels."""
    context = CaseContext.of(info)
    if context is None or not is_pattern(name):
        return _recorded_channel(name, info)
    try:
        members = channel_members(name, context.names)
    except InputError as error:
        reject(error.problem.replace("quantity", "channel"), error.expected)
    for member in members:
        _recorded_channel(member, info)
    return name


def _all_fitting(given: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
    """The channels that some names and patterns stand for, each once."""
    context = CaseContext.of(info)
    if context is None:
        return given
    names = context.names
    return tuple(dict.fromkeys(one for name in given for one in channel_members(name, names)))


class NoDefault:
    """Annotation of a value that must be given where it counts; what stands for it elsewhere is shown nowhere."""


SCENE_OWNERS = ("energy", "momentum", "monitor", "scenario")
"""First parts of the channels of the whole scene."""
RecordedChannel = Annotated[str, AfterValidator(_recorded_channel)]
"""Name of a recorded channel, ``OWNER.CHANNEL``, or a combination of channels."""
RecordedChannels = Annotated[
    tuple[Annotated[str, AfterValidator(_fitting_channels)], ...], AfterValidator(_all_fitting)
]
"""Names of recorded channels, and patterns; validates to all that they stand for."""
UniqueName = Annotated[Name, AfterValidator(_unreserved)]
"""Name of a body, joint, rope, force, sensor, surface, collision, contour or contact that no other one has."""
BodyName = Annotated[str, AfterValidator(_known_body)]
"""Name of a body that the case has."""
SideName = Annotated[str, AfterValidator(_known_side)]
"""Name of a body that the case has, or of the world."""
KnownHull = Annotated[str, AfterValidator(_known_hull)]
"""Name of a hull that the case has."""
HullName = Annotated[str, AfterValidator(_floats)]
"""Name of a rigid body that floats."""
ReferenceName = Annotated[Name, AfterValidator(_unique_reference)]
"""Name of a reference history that no other one has."""
Direction = Annotated[NumberVector, AfterValidator(_nonzero)]
"""Three numbers that are not all zero."""
CheckId = Annotated[
    str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_.-]*$"), AfterValidator(_unique_check)
]
"""Id of a check that no other one has."""
QuantityString = Annotated[str, AfterValidator(_quantity_string)]
"""Name of a computed quantity, see `heavylift.pipeline.case.quantity_names`."""


LARGEST_INPUT = 4 * 2**30
"""Bytes of an input file."""

_NEIGHBOURS = (".1", ".3", ".8", ".9", ".hst", ".sti", ".mas", ".dof")
"""Endings of files that are read because one of the same name is: numeric files of WAMIT, matrices of CalculiX."""


def files_read(path: Path) -> Iterator[Path]:
    """Files that are read for one that a case names: those of a folder, or itself and what is beside it."""
    if path.is_dir():
        yield from sorted(path.glob("*.dat"))
    else:
        yield from (path, *_neighbours(path))


def _neighbours(path: Path) -> Iterator[Path]:
    """Files beside an input that are read with it, if they are there."""
    for base in {path.name, path.stem}:
        for ending in _NEIGHBOURS:
            other = path.with_name(base + ending)
            if other != path and (other.exists() or other.is_symlink()):
                yield other


def _refuse_outside(path: Path, root: Path, value: str) -> None:
    """See that a file that exists lies below the case folder, is a file, and names none that does not."""
    from heavylift.preprocess.finite_elements.named_files import refuse_foreign_files

    target = path.resolve()
    shown = value if path.name == Path(value).name else f"{value} with {path.name}"
    if not target.is_relative_to(root):
        reject(f"{shown!r} leaves the case folder", "files inside the case folder, also through links")
    if not target.is_file():
        reject(f"{shown!r} is no file", "a file in the case folder")
    if target.stat().st_size > LARGEST_INPUT:
        size = target.stat().st_size / 2**30
        reject(f"{shown!r} has {size:.1f} GiB", f"at most {LARGEST_INPUT // 2**30} GiB")
    try:
        refuse_foreign_files(path, root)
    except InputError as error:
        where = f"{shown}: {error.key}" if error.key else shown
        reject(f"{where}: {error.problem}", error.expected)


class InFolder:
    """Annotation of a path below the case folder that must exist; validates to the relative path."""

    def __init__(self, *, folder: bool = False) -> None:
        self.folder = folder

    def parse(self, value: object, info: core_schema.ValidationInfo) -> str:
        """Check that a path exists and stays in the case folder, also through links."""
        what = "folder" if self.folder else "file"
        if not isinstance(value, str) or not value.strip():
            reject(f"{value!r} is not a path", f"the name of a {what} in the case folder")
        context = info.context
        if not isinstance(context, CaseContext):
            return value
        root = context.folder.resolve()
        try:
            target = (root / value).resolve()
            there = target.is_dir() if self.folder else target.is_file()
        except (OSError, ValueError, RuntimeError) as error:  # too long, a NUL, a loop of links
            problem = getattr(error, "strerror", None) or str(error).partition(" from ")[0].lower()
            reject(f"{value!r} is not a path: {problem}", f"the name of a {what} in the case folder")
        if Path(value).is_absolute() or not target.is_relative_to(root):
            reject(f"{value!r} leaves the case folder", f"a relative path of a {what} inside the case folder")
        if not there:
            odd = target.exists() and not (target.is_dir() or target.is_file())
            reject(
                f"{value!r} is no file" if odd else f"{what} {value!r} does not exist",
                f"a {what} in the case folder",
            )
        path = context.folder / value
        for part in files_read(path):
            _refuse_outside(part, root, value)
        return value

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, _handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        what = "folder" if self.folder else "file"
        return {"type": "string", "description": f"path of a {what}, relative to the case folder"}
