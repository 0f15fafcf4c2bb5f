"""Which bodies joints hold together."""

from __future__ import annotations

from collections.abc import Collection, Iterable

__all__ = ["connected_bodies", "shared_bodies"]


def connected_bodies(
    name: str, free: Collection[str], pairs: Iterable[tuple[str, str]], apart: Collection[str] = ()
) -> tuple[frozenset[str], frozenset[str]]:
    """Free bodies that hang together with one by joints of any kind, and what holds these from beyond.

    Parameters
    ----------
    name
        Of the body.
    free
        Names of the bodies that move freely.
    pairs
        Both sides of each joint.
    apart
        Names of bodies that do not belong to it, though joints hold them: other hulls.

    Returns
    -------
    tuple
        Names, its own among them; names of other sides: the ground, prescribed bodies, bodies that stand apart.
    """
    group: set[str] = {name}
    beyond: set[str] = set()
    sides = [frozenset(pair) for pair in pairs]
    grew = True
    while grew:
        grew = False
        for pair in sides:
            known = {side for side in pair if side in free and (side == name or side not in apart)}
            if known & group:
                beyond |= pair - known
                grew |= not known <= group
                group |= known
    return frozenset(group), frozenset(beyond)


def shared_bodies(
    name: str, free: Collection[str], pairs: Iterable[tuple[str, str]], hulls: Collection[str]
) -> dict[str, tuple[str, ...]]:
    """Bodies that hang together with a hull and with others too, which carry a part of them: names of the others."""
    links = list(pairs)
    groups = {hull: connected_bodies(hull, free, links, hulls)[0] for hull in hulls}
    return {
        body: others
        for body in sorted(groups[name] - {name})
        if (others := tuple(hull for hull in hulls if hull != name and body in groups[hull]))
    }
