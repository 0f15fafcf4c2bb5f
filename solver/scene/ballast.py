"""Descriptions of pumps between tanks and the sea, and of controllers that command them; SI units."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyPoint, Least, NameOf, Positive, Quantity, Shape
from heavylift.numerics.units import KINDS, Dimension, Kind
from heavylift.solver.scene.bodies import GROUND
from heavylift.solver.scene.descriptions import check_table, no_rows
from heavylift.solver.scene.outputs import Outputs, Part, Parts, channel, outputs
from heavylift.solver.scene.sea import AT_SEA

if TYPE_CHECKING:
    from heavylift.solver.scene.sea import Sea

__all__ = [
    "SEA",
    "Controller",
    "ControllerOutputs",
    "ControllerParts",
    "LevelPoint",
    "Pump",
    "PumpOutputs",
    "check_ballast",
]

SEA = "sea"
"""In place of the name of a tank, what a pump takes from or gives to."""

MASS_FLOW = KINDS.setdefault("mass flow", Kind("mass flow", "kg/s", Dimension(0, 1, -1))).name
"""Quantity that nothing else has."""

FASTEST = 1.0 / 3.0
"""Gain times all delays of a loop at most: beyond it a loop of first-order lags overshoots."""


@outputs
class PumpOutputs(Outputs):
    """What a pump records."""

    flow: float = channel(MASS_FLOW, "water that the pump moves to its target")
    command: float = channel(MASS_FLOW, "commanded flow")
    pumped: float = channel("mass", "net water that it has moved since the start")


@AT_SEA.describe("pumps")
@dataclass(frozen=True, eq=False, kw_only=True)
class Pump:
    """Pump between two tanks, or a tank and the sea."""

    SENTENCES: ClassVar = {"name": "Name; the first part of its channels."}
    CHANNELS: ClassVar = PumpOutputs.CHANNELS

    name: str
    source: Annotated[str, NameOf("tank")]
    """Tank that it takes water from, or ``"sea"``."""
    target: Annotated[str, NameOf("tank")]
    """Tank that it gives water to, or ``"sea"``."""
    rate: Annotated[float, Positive(MASS_FLOW)]
    """Flow at most [kg/s]."""
    reversible: bool = False
    """Whether it, or its valves, can move water from target to source as well."""
    lag: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time constant [s] with which its flow follows the command."""
    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """Of its plan [s], increasing; without one it stands still until a controller commands it."""
    rates: Annotated[NDArray[np.float64], Quantity(MASS_FLOW), Shape((None,))] = field(
        default_factory=no_rows
    )
    """Commanded flow from each time on [kg/s], nothing before the first; negative from target to source."""

    @staticmethod
    def check(spec: Any) -> None:
        """It goes from one place to another, and its plan is within its rate."""
        if spec.source == spec.target:
            raise InputError(f"{spec.source!r} is source and target", key="target", expected="two places")
        check_table("times", spec.times, "rates", spec.rates)
        for rate in spec.rates:
            if rate < 0.0 and not spec.reversible:
                raise InputError(
                    f"{rate:g} kg/s of a pump that is not reversible",
                    key="rates",
                    expected="0 or more, or reversible = true",
                )
            if abs(rate) > spec.rate * (1.0 + 1e-9):
                raise InputError(
                    f"{rate:g} kg/s of a pump of {spec.rate:g} kg/s",
                    key="rates",
                    expected="at most its 'rate'",
                )

    @property
    def tanks(self) -> tuple[str, ...]:
        """Names of the tanks at its ends."""
        return tuple(name for name in (self.source, self.target) if name != SEA)

    def plan(self) -> NDArray[np.float64]:
        """Rows of time [s], command [kg/s], flow [kg/s] and pumped mass [kg] there, from t = 0 on; shape (rows, 4).

        Between rows the flow is ``q = c + (q0 - c) exp(-(t - t0)/lag)``.
        """
        rows = [[0.0, 0.0, 0.0, 0.0]]
        for time, command in zip(self.times, self.rates, strict=True):
            if time <= 0.0:
                rows[0][1] = command
                continue
            t0, c, q0, moved = rows[-1]
            span, left = time - t0, q0 - c
            decay = np.exp(-span / self.lag) if self.lag else 0.0
            rows.append([time, command, c + left * decay, moved + c * span + left * self.lag * (1.0 - decay)])
        return np.array(rows, dtype=np.float64)


@AT_SEA.part
@dataclass(frozen=True, eq=False, kw_only=True)
class LevelPoint:
    """A point of a hull whose height a controller keeps."""

    point: Annotated[NDArray[np.float64], BodyPoint()]
    """In the coordinates of the geometry of the hull [m]."""
    height: Annotated[float, Quantity("length")]
    """That it is kept at [m]: in the world, or over the water at rest if `of` is ``"sea"``."""
    of: Annotated[str, NameOf("datum")] = GROUND
    """``"ground"``, for a quay; ``"sea"``, for a height that moves with the tide; or another hull, for a height over
    `beside` of it."""
    beside: Annotated[NDArray[np.float64] | None, Quantity("length"), Shape((3,))] = None
    """Point of the other hull, in the coordinates of its geometry [m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Another hull has a point."""
        if (spec.beside is None) != (spec.of in {GROUND, SEA}):
            problem = "no point of" if spec.beside is None else "a point of"
            raise InputError(f"{problem} {spec.of!r}", key="beside", expected="a point of the other hull")


@outputs
class ControllerParts(Parts):
    """Channels of each quantity that a controller keeps."""

    error: Part = channel("number", "controlled value less its target, filtered [m, rad]", None)


@outputs
class ControllerOutputs(Outputs):
    """What a controller records behind that."""

    share: float = channel(
        "number", "fraction of the required flow that the pumps can deliver, of the last sample"
    )


@AT_SEA.describe("controllers")
@dataclass(frozen=True, eq=False, kw_only=True)
class Controller:
    """What keeps a hull level by its pumps: it samples at intervals, and commands the pumps."""

    SENTENCES: ClassVar = {"name": "Name; the first part of its channels."}
    CHANNELS: ClassVar = (*ControllerParts.CHANNELS, *ControllerOutputs.CHANNELS)

    name: str
    hull: Annotated[str, NameOf("hull")]
    """Hull that it keeps."""
    pumps: Annotated[tuple[str, ...], NameOf("pump"), Least(1)]
    """Its pumps: all that are in its hands, each in those of one controller."""
    period: Annotated[float, Positive("time")] = 1.0
    """Between two samples [s]; commands of the pumps are constant in between. Whole steps."""
    gain: Annotated[float, Positive("rate")]
    """Rate at which an error is to vanish [1/s]: ``exp(-gain t)``."""
    filter: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time constant [s] of the two lags in series that filter its samples; 60 s suppress waves."""
    heel: Annotated[float | None, Quantity("angle")] = None
    """That is kept [rad], as `roll` of the hull."""
    trim: Annotated[float | None, Quantity("angle")] = None
    """That is kept [rad], as `pitch` of the hull: positive lowers the bow."""
    draft: Annotated[float | None, Quantity("length")] = None
    """That is kept [m]: depth of `draft_at` under the still water."""
    draft_at: Annotated[NDArray[np.float64] | None, BodyPoint()] = None
    """Point at which the draft is read, in the coordinates of the geometry [m]."""
    levels: tuple[LevelPoint, ...] = ()
    """Points whose heights are kept."""
    dead_band: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """Errors of drafts and heights that are left alone [m]."""
    dead_angle: Annotated[float, Quantity("angle", minimum=0.0, closed=True)] = 0.0
    """Errors of heel and trim that are left alone [rad]."""
    tide_ahead: bool = False
    """Pump ahead of the known tide, in addition to its errors: for heights over the ground."""

    @staticmethod
    def check(spec: Any) -> None:
        """It keeps something, once."""
        if (spec.draft is None) != (spec.draft_at is None):
            raise InputError("only one of them", key="draft", expected="'draft' and 'draft_at' together")
        kept = sum(one is not None for one in (spec.heel, spec.trim, spec.draft)) + len(spec.levels)
        if not kept:
            raise InputError("keeps nothing", expected="'heel', 'trim', 'draft' or 'levels'")
        if kept > 3:
            raise InputError(
                f"keeps {kept} of the three ways in which a hull can sink and tilt", expected="three at most"
            )

    @property
    def components(self) -> dict[str, tuple[str, ...]]:
        """Components of its channels."""
        named = [key for key in ("heel", "trim", "draft") if getattr(self, key) is not None]
        return {"error": (*named, *(f"level_{i + 1}" for i in range(len(self.levels))))}


def check_ballast(sea: Sea) -> None:
    """Refuse pumps and controllers that do not fit their tanks, hulls and each other.

    Raises
    ------
    InputError
        With the name of what is wrong.
    """
    tanks = {tank.name: tank for tank in sea.tanks}
    for tank in sea.tanks:
        full, (times, masses) = tank.capacity(sea.water), tank.schedule
        if masses.max() > full * (1.0 + 1e-9):
            row = int(np.argmax(masses > full * (1.0 + 1e-9)))
            when = f" at t = {times[row]:g} s" if len(times) > 1 else ""
            raise InputError(
                f"overflows: {masses[row]:.6g} kg{when}, it holds {full:.6g} kg",
                source=tank.name,
                key="mass" if tank.mass is not None else "masses",
                expected="no more than it holds",
            )
    for pump in sea.pumps:
        for key in ("source", "target"):
            name = getattr(pump, key)
            if name != SEA and name not in tanks:
                raise InputError(
                    f"there is no tank {name!r}",
                    source=pump.name,
                    key=key,
                    expected=f"{SEA!r}, or one of {', '.join(tanks) or 'no tanks'}",
                )
            if name != SEA and tanks[name].mass is None:
                raise InputError(
                    f"tank {name!r} follows a schedule",
                    source=pump.name,
                    key=key,
                    expected="a tank with 'mass', that at the start",
                )
    pumps, taken = {pump.name: pump for pump in sea.pumps}, dict[str, str]()
    for one in sea.controllers:
        _check_controller(one, sea, pumps, tanks, taken)


def _check_controller(
    one: Controller, sea: Sea, pumps: dict[str, Pump], tanks: dict[str, Any], taken: dict[str, str]
) -> None:
    """Its hull floats, its pumps are its own, and it is no faster than they allow."""
    hulls = [hull.body for hull in sea.hulls if hull.restoring is not None]
    places = [("hull", one.hull), *((f"levels.{i}.of", level.of) for i, level in enumerate(one.levels))]
    for key, name in places:
        if name not in hulls and not (key != "hull" and name in {GROUND, SEA}):
            raise InputError(
                f"there is no hull with buoyancy {name!r}",
                source=one.name,
                key=key,
                expected=f"one of {', '.join(hulls) or 'no hulls'}",
            )
        if key != "hull" and name == one.hull:
            raise InputError(
                f"{name!r} is the hull itself", source=one.name, key=key, expected="another hull"
            )
    for name in one.pumps:
        if name not in pumps:
            raise InputError(
                f"there is no pump {name!r}",
                source=one.name,
                key="pumps",
                expected=f"one of {', '.join(pumps) or 'no pumps'}",
            )
        if name in taken:
            raise InputError(
                f"pump {name!r} is in the hands of {taken[name]!r}", source=one.name, key="pumps",
                expected="each pump with one controller, once",
            )  # fmt: skip
        taken[name] = one.name
        if not any(tanks[tank].hull == one.hull for tank in pumps[name].tanks):
            raise InputError(
                f"pump {name!r} serves no tank of {one.hull!r}", source=one.name, key="pumps",
                expected="pumps of its hull",
            )  # fmt: skip
    lag = max(pumps[name].lag for name in one.pumps)
    check_gain(one, lag)


def check_gain(one: Any, lag: float) -> None:
    """Refuse a controller that is faster than the delays of its loop allow.

    Notes
    -----
    Delays are the lag of the slowest pump, the two lags of the filter, and half a period, for which a look is old in
    the mean. A loop of the gain K with the delay T is damped well below ``K T = 1/3``, and swings without end at pi/2.
    """
    delay = lag + 2.0 * one.filter + 0.5 * one.period
    if one.gain * delay > FASTEST * (1.0 + 1e-9):
        raise InputError(
            f"{one.gain:.4g} 1/s is faster than its pumps allow: the lag of {lag:g} s, the filter of 2 x {one.filter:g}"
            f" s and half the period of {one.period:g} s delay it by {delay:g} s",
            source=one.name,
            key="gain",
            expected=f"at most 1/(3 x {delay:g} s) = {FASTEST / delay:.4g} 1/s",
        )
