"""The table of a case file that says for which stages of an operation tanks are to be filled."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import Field, model_validator

from heavylift.pipeline.case.fields import (
    KnownHull,
    LengthVector,
    Positive,
    Quantity,
    Section,
    refuse_unknown,
    reject,
)

__all__ = ["BallastSection", "check_plan"]

Tilt = Annotated[float, Quantity("angle", minimum=-0.5, maximum=0.5)]
NoLessThanNothing = Annotated[float, Quantity("length", minimum=0.0, closed=True)]


class StageLoad(Section):
    """A load on the hull at a stage."""

    mass: Annotated[float, Positive("mass")]
    """[kg]."""
    point: LengthVector
    """Its centre, in the coordinates of the geometry of the hull [m]."""
    length: NoLessThanNothing = 0.0
    """Along the hull, over which it is spread evenly, for the girder [m]."""


class BallastStage(Section):
    """A moment of the operation: where its loads are, and how the hull is to lie."""

    name: str
    """Of its own."""
    loads: tuple[StageLoad, ...] = ()
    """On the hull, beside its own mass and what joints hold on it."""
    time: Annotated[float, Quantity("time", minimum=0.0, closed=True)] | None = None
    """[s]: with it the rates follow that pumps need from the stage before."""
    draft: Annotated[float, Positive("length")] | None = None
    """In place of that of [ballast]."""
    heel: Tilt | None = None
    """In place of that of [ballast]."""
    trim: Tilt | None = None
    """In place of that of [ballast]."""


class Lightship(Section):
    """How the mass of the hull is spread along it."""

    stations: Annotated[tuple[Annotated[float, Quantity("length")], ...], Field(min_length=2)]
    """x in the coordinates of the geometry [m], increasing."""
    weights: tuple[Annotated[float, Quantity("number", minimum=0.0, closed=True)], ...]
    """Relative weight a length at each, linear between; scaled to the mass."""

    @model_validator(mode="after")
    def _is_a_table(self) -> "Lightship":
        if len(self.weights) != len(self.stations):
            reject(
                f"{len(self.stations)} stations and {len(self.weights)} weights",
                "one a station",
                key="weights",
            )
        if any(b <= a for a, b in zip(self.stations[:-1], self.stations[1:], strict=True)):
            reject(f"{list(self.stations)}", "increasing stations", key="stations")
        if not any(self.weights):
            reject("no weight", "weights that are not all zero", key="weights")
        return self


class BallastSection(Section):
    """Stages for which `heavylift ballast` finds the fillings of tanks that pump least."""

    hull: KnownHull
    """Hull that is kept."""
    stages: Annotated[tuple[BallastStage, ...], Field(min_length=1)]
    """In order; the fillings of the tanks at the start are those before the first."""
    tanks: tuple[str, ...] = ()
    """That may be filled and emptied; all of the hull if absent. Others keep what is in them."""
    apart: tuple[str, ...] = ()
    """Bodies that joints hold on the hull and that are not counted: what of their weight it bears is among the loads
    of the stages, as half of a link beam."""
    draft: Annotated[float, Positive("length")] | None = None
    """Of the middle of the keel [m]; if absent that of the filling with the least pumping."""
    heel: Tilt = 0.0
    """Positive lifts the side of positive y [rad]."""
    trim: Tilt = 0.0
    """Positive lowers the end of positive x [rad]."""
    lightship: Lightship | None = None
    """Along the hull; if absent a trapezoid with the centre of mass of the hull."""


def check_plan(plan: BallastSection, tanks: Sequence[Any]) -> None:
    """Reject stages, tanks and hulls that do not fit together."""
    own = [tank.name for tank in tanks if tank.hull == plan.hull]
    if not own:
        reject(f"{plan.hull!r} has no tanks", "[[tanks]] of the hull", key="ballast.hull")
    for index, name in enumerate(plan.tanks):
        refuse_unknown("tank of the hull", name, own, key=f"ballast.tanks.{index}")
    if len(set(plan.tanks)) < len(plan.tanks):
        reject(f"{list(plan.tanks)}", "each tank once", key="ballast.tanks")
    names = [stage.name for stage in plan.stages]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        reject(f"two stages {twice!r}", "a name of its own for each", key="ballast.stages")
    last = -math.inf
    for index, stage in enumerate(plan.stages):
        if stage.time is not None:
            if stage.time <= last:
                reject(
                    f"{stage.time:g} s after a stage at {last:g} s", "increasing times",
                    key=f"ballast.stages.{index}.time",
                )  # fmt: skip
            last = stage.time
