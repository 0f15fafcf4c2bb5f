"""Tables of a case file that describe collisions: which surfaces may touch, and by what law."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import combinations
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from heavylift.pipeline.case.contacts import PowerStiffness, contact_stiffness
from heavylift.pipeline.case.fields import (
    GROUND,
    CaseContext,
    Positive,
    Quantity,
    Section,
    UniqueName,
    refuse_unknown,
    reject,
)
from heavylift.solver.scene import collisions as solver

__all__ = [
    "RECORDED",
    "YIELDING",
    "Collision",
    "CollisionSection",
    "HertzCollisionSection",
    "HuntCrossleyCollisionSection",
    "LinearCollisionSection",
    "RigidCollisionSection",
    "ThesisCollisionSection",
    "ThesisNumbers",
    "collision_pairs",
    "declared_collisions",
    "thesis_numbers",
    "yields",
]

RECORDED = 8
"""Contacts that a collision records one by one, unless the case says another number."""
YIELDING = frozenset({"frame", "shell"})
"""Types of bodies that always give way to a force."""


def yields(body: Any) -> bool:
    """Whether a body, as read from TOML, gives way to a force: not the ground, nor what is fixed or driven."""
    if not isinstance(body, dict):
        return False
    frame = body.get("frame")
    return body.get("type") in YIELDING or (isinstance(frame, dict) and frame.get("motion") == "free")


def collision_pairs(
    name: str,
    between: Sequence[str] | None,
    among: Sequence[str] | None,
    surfaces: Mapping[str, str],
    yielding: Collection[str],
) -> dict[str, tuple[str, str]]:
    """Pairs of surfaces of one table of collision, by the names of their channels.

    Parameters
    ----------
    name
        Of the table: of the one pair of `between`; those of `among` are NAME_1, NAME_2, ...
    between, among
        As in the case file.
    surfaces
        Body of each surface.
    yielding
        Bodies that give way to forces.

    Notes
    -----
    Of surfaces `among` each other, pairs on one body and pairs of which neither gives way are left out.
    """
    if among is None:
        return {} if between is None or len(between) != 2 else {name: (between[0], between[1])}
    found = [
        (a, b)
        for a, b in combinations(among, 2)
        if surfaces.get(a) != surfaces.get(b) and {surfaces.get(a), surfaces.get(b)} & set(yielding)
    ]
    return {f"{name}_{number}": pair for number, pair in enumerate(found, start=1)}


def declared_collisions(
    rows: Sequence[tuple[str, Mapping[str, Any]]], surfaces: Mapping[str, str], yielding: Collection[str]
) -> list[tuple[str, str, int]]:
    """Collisions that tables as read from TOML declare, whatever else may be wrong with them.

    Returns
    -------
    list
        Of each the name of its table, the first part of its channels, and how many contacts it records one by one.
    """
    found: list[tuple[str, str, int]] = []
    for name, row in rows:
        between, among = _texts(row.get("between")), _texts(row.get("among"))
        recorded = row.get("recorded", RECORDED)
        if isinstance(recorded, bool) or not isinstance(recorded, int):
            recorded = RECORDED
        pairs = {}
        if between is None or among is None:
            pairs = collision_pairs(name, between, among, surfaces, yielding)
        found += [(name, pair, recorded) for pair in list(pairs) or [name]]
    return found


def _texts(value: Any) -> list[str] | None:
    """A list of texts, or None if that is not what is given."""
    return value if isinstance(value, list) and all(isinstance(entry, str) for entry in value) else None


_LAWS_OF = {
    "restitution": ("rigid", "hunt-crossley"),
    "rest_speed": ("rigid",),
    "events": ("rigid",),
    "peak_stiffness": ("rigid",),
    "stiffness": ("linear", "hertz", "hunt-crossley"),
    "damping": ("linear",),
    "exponent": ("hunt-crossley",),
    "epsilon": ("thesis",),
    "gamma": ("thesis",),
}
"""Keys of laws, and which laws have them."""

_LAWS = ("rigid", "linear", "hertz", "hunt-crossley", "thesis")


class CollisionSection(Section):
    """What all collisions have."""

    CHANNELS: ClassVar = solver.Collision.CHANNELS

    name: UniqueName
    """Name; the first part of its channels. With `among` those of the pairs are NAME_1, NAME_2, ..."""
    law: str
    """Force or impulse across each contact."""
    between: tuple[str, str] | None = None
    """Two surfaces that may touch; forces are recorded on the second."""
    among: Annotated[tuple[str, ...], Field(min_length=2, max_length=200)] | None = None
    """In place of `between`: all pairs of these surfaces that are not on one body, and of which one gives way."""
    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.0
    """Coulomb's coefficient; 0 without."""
    method: Literal["swept", "position-difference"] = "swept"
    """``swept``: certified tests of the paths within a step; ``position-difference``: as in the thesis, which misses
    collisions; for comparison."""
    patch_angle: Annotated[float, Quantity("angle", minimum=0.0, maximum=math.pi)] = math.radians(18.0)
    """Contacts belong to one patch if their normals differ by less [rad]."""
    patch_size: Annotated[float, Positive("length")] | None = None
    """And lie within this distance [m]; a tenth of the smaller surface if absent."""
    most_contacts: Annotated[int, Field(ge=1, le=100_000, strict=True)] = 512
    """At once; if there are more, the simulation stops."""
    recorded: Annotated[int, Field(ge=0, le=1000, strict=True)] = RECORDED
    """Contacts recorded one by one, those with the largest forces."""
    clearance: Annotated[bool, Field(strict=True)] = False
    """Record the distance of the surfaces in `gap` while they are far apart too; it costs a search for each record."""

    @model_validator(mode="before")
    @classmethod
    def _has_the_keys_of_its_law(cls, value: Any) -> Any:
        law = value.get("law") if isinstance(value, dict) else None
        for key, laws in _LAWS_OF.items():
            if law in _LAWS and key in value and law not in laws:
                owners = " or ".join(repr(name) for name in laws)
                reject(f"{key!r} with law {law!r}", f"law {owners}, or no {key!r}", key=key)
        return value

    @field_validator("between", "among")
    @classmethod
    def _are_surfaces(cls, value: tuple[str, ...] | None, info: ValidationInfo) -> tuple[str, ...] | None:
        context = CaseContext.of(info)
        if context is None or value is None:
            return value
        for index, name in enumerate(value):
            if name in value[:index]:
                reject(f"{name!r} twice", "different surfaces", key=str(index))
            if name in context.names.bodies and name not in context.names.surfaces:
                own = sorted(s for s, body in context.names.surfaces.items() if body == name)
                has = f"one of its surfaces: {', '.join(own)}" if own else "a [[surfaces]] table of this body"
                reject(f"{name!r} is a body, not a surface", has, key=str(index))
            refuse_unknown("surface", name, context.names.surfaces, key=str(index))
        return value

    @model_validator(mode="after")
    def _has_a_pair(self, info: ValidationInfo) -> Self:
        if (self.between is None) == (self.among is None):
            problem = "neither 'between' nor 'among'" if self.among is None else "both 'between' and 'among'"
            reject(problem, "'between' two surfaces, or 'among' several")
        if self.recorded > self.most_contacts:
            reject(
                f"{self.recorded} of {self.most_contacts} contacts",
                "no more than 'most_contacts'",
                key="recorded",
            )
        context = CaseContext.of(info)
        if context is None:
            return self
        surfaces, yielding = context.names.surfaces, context.names.yielding
        if self.between is not None:
            a, b = (surfaces[name] for name in self.between)
            if a == b:
                reject(
                    f"{self.between[0]!r} and {self.between[1]!r} are both surfaces of {a!r}",
                    "surfaces of two bodies",
                    key="between",
                )
            known = {a, b} <= {*context.names.bodies, GROUND}  # an unknown one is told of the surface
            if known and a not in yielding and b not in yielding:
                reject(
                    f"neither {a!r} nor {b!r} can give way",
                    "a body with a free frame, a frame or a shell on one side",
                    key="between",
                )
        elif not collision_pairs(self.name, None, self.among, surfaces, yielding):
            reject(
                "no pair of these surfaces is on two bodies of which one can give way",
                "surfaces of several bodies, one of them with a free frame",
                key="among",
            )
        return self


class RigidCollisionSection(CollisionSection):
    """Without compliance: surfaces do not enter each other, impacts are at once, and tell impulses, not forces."""

    law: Literal["rigid"]
    restitution: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 0.0
    """Velocity after an impact over that before it, 0 to 1."""
    rest_speed: Annotated[float, Quantity("velocity", minimum=0.0, closed=True)] = 0.0
    """Approach [m/s] below which an impact has no restitution."""
    events: Annotated[bool, Field(strict=True)] = True
    """Split the step where an impact happens; else impacts happen at ends of steps."""
    peak_stiffness: Annotated[float, Positive("stiffness")] | None = None
    """For the report alone: stiffness k [N/m] of what is hit, by which the peak force of an impact is estimated as
    ``v sqrt(k m)``."""


class LinearCollisionSection(CollisionSection):
    """A spring and a damper that never pull; the contacts of a patch share them."""

    law: Literal["linear"]
    stiffness: Annotated[float, Positive("stiffness")]
    """Of a patch [N/m]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Of a patch [N s/m]."""


class HertzCollisionSection(CollisionSection):
    """Elastic and smooth bodies (Hertz): a force that grows with the depth to the power of 3/2."""

    law: Literal["hertz"]
    stiffness: PowerStiffness
    """Of a patch [N/m^1.5]."""

    @field_validator("stiffness", mode="before")
    @classmethod
    def _in_its_unit(cls, value: Any) -> Any:
        return contact_stiffness(value, 1.5)


class HuntCrossleyCollisionSection(CollisionSection):
    """A force that grows with a power of the depth, and damping that gives a restitution (Hunt and Crossley)."""

    law: Literal["hunt-crossley"]
    exponent: Annotated[float, Quantity("number", minimum=1.0, maximum=3.0, closed=True)] = 1.5
    """1.5 of Hertz, 1 linear."""
    stiffness: PowerStiffness
    """Of a patch [N/m^exponent]."""
    restitution: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 1.0
    """Velocity after an impact over that before it, above 0 up to 1."""

    @field_validator("stiffness", mode="before")
    @classmethod
    def _in_its_unit(cls, value: Any, info: ValidationInfo) -> Any:
        # an exponent that is wrong is told by itself
        return contact_stiffness(value, info.data["exponent"]) if "exponent" in info.data else 1.0

    @field_validator("restitution")
    @classmethod
    def _bounces(cls, value: float) -> float:
        if value == 0.0:
            reject("0 needs infinite damping", "above 0, or law 'rigid'")
        return value


class ThesisCollisionSection(CollisionSection):
    """The parameters of "Integrated simulation of ships and offshore structures (2018)": a spring and a damper."""

    law: Literal["thesis"]
    epsilon: Annotated[float, Positive("compliance")]
    """Compliance [m/N]: a spring of 1 / epsilon, whatever the step."""
    gamma: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 1.0
    """Above 0 up to 1: damping, with a time constant of h (1 / gamma - 1) / 4 at the step h. No restitution."""

    @field_validator("gamma")
    @classmethod
    def _is_positive(cls, value: float) -> float:
        if value == 0.0:
            reject("0 needs infinite damping", "above 0, up to 1")
        return value


Collision = Annotated[
    RigidCollisionSection
    | LinearCollisionSection
    | HertzCollisionSection
    | HuntCrossleyCollisionSection
    | ThesisCollisionSection,
    Field(discriminator="law"),
]


class ThesisNumbers(NamedTuple):
    """What the parameters of a law ``"thesis"`` mean."""

    stiffness: float
    """[N/m]."""
    time_constant: float
    """Damping over stiffness [s]."""
    damping: float
    """[N s/m]."""


def thesis_numbers(section: ThesisCollisionSection, step: float) -> ThesisNumbers:
    """Spring and damper of a law ``"thesis"`` at a step [s].

    Parameters
    ----------
    section
        With the compliance ``epsilon`` [m/N] and the number ``gamma``, above 0 up to 1.
    step
        [s].

    Notes
    -----
    Equation (49) of section 2.6 softens a contact row by ``4 Gamma epsilon / h^2`` with
    ``Gamma = 1 / (1 + 4 tau / h)``: a spring of ``1 / epsilon`` and a damper of ``tau / epsilon``, with
    ``tau = h (1 / Gamma - 1) / 4``.
    """
    stiffness = 1.0 / section.epsilon
    time_constant = 0.25 * step * (1.0 / section.gamma - 1.0)
    return ThesisNumbers(stiffness, time_constant, stiffness * time_constant)
