"""Tables of a case file that describe collisions: which surfaces may touch, and by what law."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from collections.abc import Collection, Mapping, Sequence
from functools import cache
from itertools import combinations
from typing import Annotated, Any

from pydantic import Field, ValidationInfo, field_validator, model_validator

from heavylift.pipeline.case.contacts import refuse_keys_of_others
from heavylift.pipeline.case.described import make_section
from heavylift.pipeline.case.fields import (
    GROUND,
    CaseContext,
    Positive,
    Section,
    UniqueName,
    refuse_unknown,
    reject,
)
from heavylift.solver.scene.collisions import Collision
from heavylift.solver.scene.contacts import COLLISION_LAWS, RigidLaw

__all__ = ["RECORDED", "YIELDING", "collision_pairs", "collision_section", "declared_collisions", "yields"]

RECORDED = Collision.recorded
"""Contacts that a collision records one by one, unless the case gives another number."""
YIELDING = frozenset({"frame", "shell", "flexible"})
"""Types of bodies that always give way to a force."""


def yields(body: Any) -> bool:
    """Whether a body, as read from TOML, gives way to a force: not the ground, nor what is fixed or driven."""
    if not isinstance(body, dict):
        return False
    frame, kind = body.get("frame"), body.get("type")
    return (isinstance(kind, str) and kind in YIELDING) or (
        isinstance(frame, dict) and frame.get("motion") == "free"
    )


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


class _CollisionPlace(Section):
    """Which surfaces may touch."""

    name: UniqueName
    """Name; the first part of its channels. With `among` those of the pairs are NAME_1, NAME_2, ..."""
    law: str
    """Force or impulse across each contact."""
    between: tuple[str, str] | None = None
    """Two surfaces that may touch; forces are recorded on the second."""
    among: Annotated[tuple[str, ...], Field(min_length=2, max_length=200)] | None = None
    """In place of `between`: all pairs of these surfaces that are not on one body, of which one can move."""

    @model_validator(mode="before")
    @classmethod
    def _has_the_keys_of_its_law(cls, value: Any) -> Any:
        refuse_keys_of_others(cls, value, COLLISION_LAWS, collision_section)
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
    def _has_a_pair(self: Any, info: ValidationInfo) -> Any:
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
            known = {a, b} <= {*context.names.bodies, GROUND}  # an unknown one is reported with the surface
            if known and a not in yielding and b not in yielding:
                reject(
                    f"neither {a!r} nor {b!r} can move",
                    "a body with a free frame, a flexible body, a frame or a shell on one side",
                    key="between",
                )
        elif not collision_pairs(self.name, None, self.among, surfaces, yielding):
            reject(
                "no pair of these surfaces is on two bodies of which one can move",
                "surfaces of several bodies, one of them flexible or with a free frame",
                key="among",
            )
        return self


class _RigidPlace(_CollisionPlace):
    """Of a law without compliance."""

    peak_stiffness: Annotated[float, Positive("stiffness")] | None = None
    """For the report alone: stiffness k [N/m] of what is hit, by which the peak force of an impact is estimated as
    ``v sqrt(k m)``."""


@cache
def collision_section(law: Any) -> Any:
    """Section of a collision by a law: its surfaces, what all collisions have, and the keys of the law."""
    base = make_section(Collision, _RigidPlace if law is RigidLaw else _CollisionPlace)
    return make_section(law, base)
