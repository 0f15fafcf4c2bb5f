"""What must fit together in a case with a sea, or without one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from heavylift.pipeline.case.fields import refuse_unknown, reject

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from heavylift.pipeline.case.hulls import DatabaseSection
    from heavylift.pipeline.case.sea import SeaSection
    from heavylift.pipeline.case.simulate import SimulateSection
    from heavylift.pipeline.case.surfaces import SurfaceSection

__all__ = ["check_sea"]

SAME_GRAVITY = 2e-3
"""Relative, between the weight of bodies and that of water: 9.81 and 9.80665 are the same."""


def check_sea(
    sea: SeaSection | None,
    *,
    gravity: Any,
    simulate: SimulateSection | None,
    surfaces: Sequence[SurfaceSection],
    hulls: Mapping[str, Any],
    databases: Mapping[str, DatabaseSection],
    tanks: Sequence[Any],
    pumps: Sequence[Any],
    controllers: Sequence[Any],
    fluid_loads: Sequence[Any],
    lines: Sequence[Any],
) -> None:
    """Reject tables of a case that do not fit together."""
    tables = {
        "hulls": hulls,
        "databases": databases,
        "tanks": tanks,
        "pumps": pumps,
        "controllers": controllers,
        "fluid_loads": fluid_loads,
    }
    given = next((key for key, table in tables.items() if table), None)
    if sea is None:
        if given is not None:
            reject(f"[{given}] without [sea]", "a [sea] table, which may be empty", key=given)
        first = next((i for i, line in enumerate(lines) if line.on_seabed), None)
        if first is not None:
            reject(
                "'on_seabed' without [sea]", "a depth in [sea], or 'seabed'", key=f"lines.{first}.on_seabed"
            )
        return
    for index, line in enumerate(lines):
        if line.on_seabed and sea.depth is None:
            reject(
                "'on_seabed' in deep water", "'depth' in [sea], or 'seabed'", key=f"lines.{index}.on_seabed"
            )
    if hulls:
        _check_weight(sea.gravity, gravity)
        _check_hulls(hulls, surfaces)
    _check_databases(databases, hulls, simulate)
    if sea.excitation == "series" and sea.waves and (simulate is None or not simulate.duration):
        reject("'series' without a duration to tabulate", "'summed', or a duration", key="sea.excitation")


def _check_weight(own: float | None, gravity: Any) -> None:
    """Water and bodies have one weight, which points down."""
    x, y, z = (0.0, 0.0, 0.0) if gravity is None else gravity.acceleration
    if x or y or z >= 0.0:
        problem = "no [gravity]" if gravity is None else f"{[x, y, z]} m/s^2"
        reject(f"{problem} in a case with hulls", "gravity along -z", key="gravity")
    if own is not None and abs(own + z) > SAME_GRAVITY * own:
        reject(
            f"{own:g} m/s^2, bodies have {-z:g} m/s^2", "the same, or no 'gravity' here", key="sea.gravity"
        )


def _check_hulls(hulls: Mapping[str, Any], surfaces: Sequence[SurfaceSection]) -> None:
    """Surfaces of hulls are on their bodies."""
    owners = {surface.name: surface.body for surface in surfaces}
    for name, hull in hulls.items():
        if hull.surface is None:
            continue
        own = [surface for surface, body in owners.items() if body == name]
        refuse_unknown("surface", hull.surface, owners, key=f"hulls.{name}.surface")
        if hull.surface not in own:
            reject(
                f"{hull.surface!r} is a surface of {owners[hull.surface]!r}",
                f"one of {name!r}: {', '.join(own) or 'none'}",
                key=f"hulls.{name}.surface",
            )


def _check_databases(
    databases: Mapping[str, DatabaseSection],
    hulls: Mapping[str, Any],
    simulate: SimulateSection | None,
) -> None:
    """Every hull has one database at most; one that is computed has surfaces; steps are fixed for convolution."""
    taken: dict[str, str] = {}
    for name, database in databases.items():
        for index, hull in enumerate(database.hulls):
            if hull in taken:
                reject(
                    f"{hull!r} has a database already, {taken[hull]!r}",
                    "each hull in one database",
                    key=f"databases.{name}.hulls.{index}",
                )
            taken[hull] = name
            if database.compute is not None and hulls[hull].surface is None:
                reject(
                    f"{hull!r} has no surface to compute it from",
                    "'surface' of the hull, or a database in a file",
                    key=f"databases.{name}.compute",
                )
        if database.memory == "direct" and simulate is not None and simulate.step is None:
            reject(
                "'direct' without a fixed step",
                "'step' in [simulate], or 'exponentials'",
                key=f"databases.{name}.memory",
            )
