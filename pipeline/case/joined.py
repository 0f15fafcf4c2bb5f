"""Which bodies joints hold together."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from heavylift.pipeline.case.case_file import Case

__all__ = ["joined_bodies", "joined_to_hull"]


def joined_bodies(
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


def joined_to_hull(case: Case, name: str) -> tuple[frozenset[str], frozenset[str]]:
    """The same of a hull of a case, which other hulls do not belong to."""
    free = {
        body
        for body, section in case.bodies.items()
        if section.type == "frame" or section.type == "shell" or section.frame.motion == "free"  # noqa: PLR1714
    }
    return joined_bodies(name, free, [joint.between for joint in case.joints], case.hulls)
