"""The table of a case file that describes the sea, and what must fit together in a case with one."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import field_validator, model_validator

from heavylift.pipeline.case.described import Chosen
from heavylift.pipeline.case.fields import Positive, Quantity, Section, refuse_unknown, reject
from heavylift.pipeline.case.hulls import DatabaseSection
from heavylift.pipeline.case.simulate import SimulateSection
from heavylift.pipeline.case.surfaces import SurfaceSection
from heavylift.pipeline.case.waves import WaveSection, check_wave, one_or_many
from heavylift.pipeline.case.wind import Current, Wind
from heavylift.solver.scene.sea import AT_SEA, Excitation

__all__ = ["STANDARD_GRAVITY", "SeaSection", "check_sea"]

STANDARD_GRAVITY = 9.80665
"""[m/s^2], of water in a case without gravity."""

SAME_GRAVITY = 2e-3
"""Relative, between the weight of bodies and that of water: 9.81 and 9.80665 are the same."""


class SeaSection(Section):
    """Water, and what moves in it and above it."""

    density: Annotated[float, Quantity("density", minimum=500.0, maximum=2000.0)] = 1025.0
    """Of the water [kg/m^3]."""
    gravity: Annotated[float, Quantity("acceleration", minimum=5.0, maximum=20.0)] | None = None
    """[m/s^2]; that of [gravity] if absent."""
    level: Annotated[float, Quantity("length")] = 0.0
    """Height of the still water in the world [m]."""
    depth: Annotated[float, Positive("length")] | None = None
    """[m]; deep water if absent."""
    waves: Annotated[tuple[WaveSection, ...], one_or_many()] = ()
    """A train of waves, or several that go through each other."""
    ramp: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time in which waves, wind and current grow from nothing at the start [s]."""
    excitation: Excitation = "summed"
    """``summed``: every component of the waves at the low-passed place and heading of each hull; ``series``: at the
    place and heading of the start, tabulated once, which is faster."""
    wind: Annotated[tuple[Wind, ...], one_or_many()] = ()
    """Wind; several with names of their own for loads that are far apart."""
    current: Annotated[tuple[Current, ...], one_or_many()] = ()
    """Current."""
    tide: Annotated[Any, Chosen(AT_SEA, word="tide")] | None = None
    """Rise and fall of the still water."""

    @property
    def water_depth(self) -> float:
        """[m]; infinite for deep water."""
        return math.inf if self.depth is None else self.depth

    @field_validator("depth")
    @classmethod
    def _is_a_sea(cls, value: float | None) -> float | None:
        if value is not None and value > 12_000.0:
            reject(f"{value:g} m", "at most 12000 m; no 'depth' for deep water")
        return value

    @model_validator(mode="after")
    def _waves_do_not_break(self) -> "SeaSection":
        gravity = self.gravity or STANDARD_GRAVITY
        for index, waves in enumerate(self.waves):
            key = "waves" if len(self.waves) == 1 else f"waves.{index}"
            check_wave(waves, self.water_depth, gravity, key)
        return self


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
