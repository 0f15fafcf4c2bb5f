"""Which surfaces of a case may touch each other: the pairs that a table of collision stands for, and their names."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

__all__ = ["RECORDED", "YIELDING", "collision_pairs", "declared_collisions", "yields"]

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
