"""The table of a case file that describes the sea, and what must fit together in a case with one."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import field_validator, model_validator

from heavylift.pipeline.case_waves import Waves, check_wave, one_or_many
from heavylift.pipeline.case_wind import CurrentSection, WindSection
from heavylift.pipeline.fields import Positive, Quantity, Section, refuse_unknown, reject

if TYPE_CHECKING:
    from heavylift.pipeline.case import Case

__all__ = ["STANDARD_GRAVITY", "SeaSection", "check_sea", "has_sea", "sea_gravity"]

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
    waves: Annotated[tuple[Waves, ...], one_or_many()] = ()
    """A train of waves, or several that go through each other."""
    ramp: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time in which waves, wind and current grow from nothing at the start [s]."""
    excitation: Literal["summed", "series"] = "summed"
    """``summed``: every component of the waves at the low-passed place and heading of each hull; ``series``: at the
    place and heading of the start, tabulated once, which is faster."""
    wind: Annotated[tuple[WindSection, ...], one_or_many()] = ()
    """Wind; several with names of their own for loads that are far apart."""
    current: Annotated[tuple[CurrentSection, ...], one_or_many()] = ()
    """Current."""

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


def has_sea(case: "Case") -> bool:
    """Whether there is anything of water, air or mooring in a case."""
    return case.sea is not None or bool(case.lines or case.fenders)


def sea_gravity(case: "Case") -> float:
    """Gravity of the water [m/s^2]: its own, or that of the case."""
    if case.sea is not None and case.sea.gravity is not None:
        return case.sea.gravity
    if case.gravity is not None and any(case.gravity.acceleration):
        return math.hypot(*case.gravity.acceleration)
    return STANDARD_GRAVITY


def check_sea(case: "Case") -> None:
    """Reject what does not fit together."""
    tables = ("hulls", "databases", "tanks", "fluid_loads")
    given = next((key for key in tables if getattr(case, key)), None)
    if case.sea is None:
        if given is not None:
            reject(f"[{given}] without [sea]", "a [sea] table, which may be empty", key=given)
        first = next((i for i, line in enumerate(case.lines) if line.on_seabed), None)
        if first is not None:
            reject(
                "'on_seabed' without [sea]", "a depth in [sea], or 'seabed'", key=f"lines.{first}.on_seabed"
            )
        return
    for index, line in enumerate(case.lines):
        if line.on_seabed and case.sea.depth is None:
            reject(
                "'on_seabed' in deep water", "'depth' in [sea], or 'seabed'", key=f"lines.{index}.on_seabed"
            )
    if case.hulls:
        _check_weight(case)
        _check_hulls(case)
    _check_databases(case)
    if (
        case.sea.excitation == "series"
        and case.sea.waves
        and (case.simulate is None or not case.simulate.duration)
    ):
        reject("'series' without a duration to tabulate", "'summed', or a duration", key="sea.excitation")


def _check_weight(case: "Case") -> None:
    """Water and bodies have one weight, which points down."""
    assert case.sea is not None
    x, y, z = (0.0, 0.0, 0.0) if case.gravity is None else case.gravity.acceleration
    if x or y or z >= 0.0:
        problem = "no [gravity]" if case.gravity is None else f"{[x, y, z]} m/s^2"
        reject(f"{problem} in a case with hulls", "gravity along -z", key="gravity")
    own = case.sea.gravity
    if own is not None and abs(own + z) > SAME_GRAVITY * own:
        reject(
            f"{own:g} m/s^2, bodies have {-z:g} m/s^2", "the same, or no 'gravity' here", key="sea.gravity"
        )


def _check_hulls(case: "Case") -> None:
    """Surfaces of hulls are on their bodies."""
    owners = {surface.name: surface.body for surface in case.surfaces}
    for name, hull in case.hulls.items():
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


def _check_databases(case: "Case") -> None:
    """Every hull has one database at most; one that is computed has surfaces; steps are fixed for convolution."""
    taken: dict[str, str] = {}
    for name, database in case.databases.items():
        for index, hull in enumerate(database.hulls):
            if hull in taken:
                reject(
                    f"{hull!r} has a database already, {taken[hull]!r}",
                    "each hull in one database",
                    key=f"databases.{name}.hulls.{index}",
                )
            taken[hull] = name
            if database.compute is not None and case.hulls[hull].surface is None:
                reject(
                    f"{hull!r} has no surface to compute it from",
                    "'surface' of the hull, or a database in a file",
                    key=f"databases.{name}.compute",
                )
        if database.memory == "direct" and case.simulate is not None and case.simulate.step is None:
            reject(
                "'direct' without a fixed step",
                "'step' in [simulate], or 'exponentials'",
                key=f"databases.{name}.memory",
            )
