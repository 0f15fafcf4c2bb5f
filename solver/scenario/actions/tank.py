"""Pumps of tanks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.actions import ACTIONS, Action, NamesOf
from heavylift.solver.scene.ballast import MASS_FLOW
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.operations import GO_TO, SPEED

if TYPE_CHECKING:
    from collections.abc import Collection

    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["TankRate"]


@ACTIONS.describe("tank")
@dataclass(frozen=True)
class TankRate(Action):
    """The pump of a tank fills it, or empties it."""

    ORDER: ClassVar[float] = 4

    tank: Annotated[str, NamesOf("tanks")]
    """Tanks whose pumps run."""
    rate: Annotated[float, Quantity(MASS_FLOW)]
    """Of the pump [kg/s]: fills if positive, and stops when the tank is empty."""
    mass: Annotated[float | None, Quantity("mass", minimum=0.0, closed=True)] = None
    """At which the pump stops [kg]; the rate is positive then."""

    @classmethod
    def check_keys(cls, given: Any, keys: Collection[str]) -> None:  # noqa: ARG003
        """A rate whose sense is known."""
        if given.rate is None:
            raise InputError("a tank without 'rate'", expected="'rate' of its pump", key="rate")
        if given.mass is not None and not given.rate > 0.0:
            raise InputError(
                f"{given.rate:g} kg/s with a mass", expected="a positive rate: its sense follows", key="rate"
            )

    @property
    def text(self) -> str:
        """Words for it."""
        until = "" if self.mass is None else f" to {self.mass:g} kg"
        return f"pump of {self.tank!r} with {self.rate:g} kg/s{until}"

    def command(self) -> Command:
        """A rate at once, or a mass to come to."""
        if self.mass is None:
            return Command(operation=SPEED, actuates="tank", name=self.tank, value=self.rate)
        return Command(
            operation=GO_TO, actuates="tank", name=self.tank, value=self.mass, speed=abs(self.rate)
        )

    def check(self, state: OperationState, key: str) -> None:
        """Nothing else fills it, and the mass has room in it."""
        state.tank(self.tank, f"{key}.tank")
        room = state.movable.capacities.get(self.tank, math.inf)
        if self.mass is not None and self.mass > room * (1.0 + 1e-9):
            raise InputError(
                f"{self.mass:g} kg, and {self.tank!r} is full with {room:.6g} kg",
                key=f"{key}.mass",
                expected=f"at most {room:.6g} kg",
            )
        if self.mass is not None or self.rate < 0.0:
            state.arriving.add(self.tank)
