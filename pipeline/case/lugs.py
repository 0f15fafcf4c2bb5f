"""Lugs of panels: what a document says of them before its tables are read."""

from __future__ import annotations

import math
from typing import Any

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, parse_quantity

__all__ = ["with_lug_interfaces"]


def with_lug_interfaces(document: dict[str, Any]) -> dict[str, Any]:
    """Document with an interface for each lug of panels: the edge of its pin hole, at the centre of the hole.

    Parameters
    ----------
    document
        As read from TOML, blocks written out; it is not changed. Interfaces that it has itself stay, and lugs that
        cannot be read have none: what is wrong with them is said where they are read.
    """
    bodies = document.get("bodies")
    if not isinstance(bodies, dict):
        return document
    found = {name: _with_interfaces(body) for name, body in bodies.items()}
    return (
        {**document, "bodies": found} if any(found[name] is not bodies[name] for name in bodies) else document
    )


def _with_interfaces(body: Any) -> Any:
    geometry = body.get("geometry") if isinstance(body, dict) else None
    lugs = geometry.get("lugs") if isinstance(geometry, dict) and geometry.get("type") == "panels" else None
    own = body.get("interfaces", {}) if isinstance(lugs, dict) else None
    if not isinstance(lugs, dict) or not isinstance(own, dict):
        return body
    made = {}
    for name, lug in lugs.items():
        try:
            made[name] = {"at": _eye(lug), "group": name}
        except (InputError, KeyError, TypeError, ValueError, ZeroDivisionError):
            continue
    return {**body, "interfaces": {**made, **own}} if made else body


def _eye(lug: dict[str, Any]) -> list[float]:
    """Centre of the pin hole of a lug [m]."""
    foot = [parse_quantity(value, KINDS["length"]) for value in lug["foot"]]
    normal = [parse_quantity(value, KINDS["number"]) for value in lug["normal"]]
    height = parse_quantity(lug["height"], KINDS["length"])
    length = math.hypot(*normal)
    return [a + height * n / length for a, n in zip(foot, normal, strict=True)]
