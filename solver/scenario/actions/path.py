"""Transporters on their paths."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.actions import ACTIONS, Action, NamesOf, Ramp, SpeedKeys
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.operation_state import known_thing
from heavylift.solver.scene.operations import GO_TO, SPEED

if TYPE_CHECKING:
    from collections.abc import Collection

    from heavylift.solver.scene.actions import Targets
    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["PathGoOn", "PathSpeed"]


@dataclass(frozen=True)
class PathSpeed(Ramp):
    """A transporter goes along its path at a speed to the end of the leg on which it is, and stops there.

    Attributes
    ----------
    path
        Name of the transporter.
    speed
        [m/s]; 0 stops it where it is.
    """

    path: str
    speed: float
    ramp: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        if self.speed == 0.0:
            return f"{self.path!r} stops on its path{self.in_ramp}"
        return f"{self.path!r} along its leg at {self.speed:g} m/s{self.in_ramp}"

    def command(self) -> Command:
        """A speed up to the end of its leg."""
        return Command(operation=SPEED, actuates="path", name=self.path, value=self.speed, **self.limits)

    def check(self, state: OperationState, key: str) -> None:
        """Its drive can do the speed."""
        vehicle = _vehicle(state, self.path, key)
        if vehicle.drive is None or not len(vehicle.drive.speeds):
            return
        fastest = max(leg.speed for leg in vehicle.legs)
        if self.speed > fastest * (1.0 + 1e-12):
            raise InputError(
                f"{self.speed:g} m/s, and the drives of {self.path!r} are planned for {fastest:g} m/s",
                key=f"{key}.speed",
                expected="at most the speed of its fastest leg, or a drive without 'speeds'",
            )


@dataclass(frozen=True)
class PathGoOn(Action):
    """A transporter continues along its path, this leg and all others as they are planned."""

    path: str

    @property
    def text(self) -> str:
        """Words for it."""
        return f"{self.path!r} continues along its path"

    def command(self) -> Command:
        """The end of its path."""
        return Command(operation=GO_TO, actuates="path", name=self.path)

    def check(self, state: OperationState, key: str) -> None:
        """It has a plan."""
        _vehicle(state, self.path, key)


def _vehicle(state: OperationState, name: str, key: str) -> Any:
    """One whose plan waits for nothing else; it arrives somewhere."""
    vehicle = known_thing("transporter with 'legs'", name, state.movable.vehicles, f"{key}.path")
    if vehicle.tyres is not None:
        raise InputError(
            f"{name!r} has 'tyres', and its plan waits for its drives",
            key=f"{key}.path",
            expected="a transporter without 'tyres'",
        )
    state.arriving.add(name)
    return vehicle


@ACTIONS.describe("path")
@dataclass(frozen=True)
class PathKeys(SpeedKeys):
    """What transporters do on their paths."""

    ORDER: ClassVar[float] = 5

    path: Annotated[str, NamesOf("paths")]
    """Transporters with `legs`: with a `speed` they go to the end of the leg on which they are, or stop if it is 0."""
    planned: Literal[True] | None = None
    """A transporter continues: this leg and all others as planned."""

    @classmethod
    def check_keys(cls, given: Any, keys: Collection[str]) -> None:
        """A speed, or as planned."""
        if (given.speed is None) == (given.planned is None):
            problem = "both 'speed' and 'planned'" if given.planned else "a path without 'speed'"
            raise InputError(
                problem, expected="'speed', 0 to stop, or 'planned = true' to continue", key="speed"
            )
        if given.planned:
            odd = sorted(set(keys) - {"path", "planned"})
            if odd:
                raise InputError(
                    f"{odd[0]!r} beside 'planned'", expected="the values of the legs", key=odd[0]
                )
        elif given.speed < 0.0:
            raise InputError(
                f"{given.speed:g} m/s", expected="a speed of 0 or more: it moves along its path", key="speed"
            )
        cls.check_limits(given)

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:  # noqa: ARG003
        """One for each transporter."""
        names = targets.fitting("path", given.path, targets.paths, "transporter with 'legs'")
        if given.planned:
            return tuple(PathGoOn(name) for name in names)
        acceleration = given.acceleration or 0.0
        return tuple(PathSpeed(name, given.speed, given.ramp, acceleration=acceleration) for name in names)
