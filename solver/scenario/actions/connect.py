"""Ropes that are connected from now on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.actions import ACTIONS, Action, NamesOf
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.operations import CONNECT

if TYPE_CHECKING:
    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["Connect"]


@ACTIONS.describe("connect")
@dataclass(frozen=True)
class Connect(Action):
    """A rope that does nothing gets the length of its path, and some slack, and holds from now on."""

    ORDER: ClassVar[float] = 9

    connect: Annotated[str, NamesOf("ropes", "rope")]
    """Ropes that are connected from now on."""
    slack: Annotated[float, Quantity("length")] = 0.0
    """What a connected rope is longer than its path [m]; shorter by at most 2 % if negative."""

    @property
    def text(self) -> str:
        """Words for it."""
        return f"connection of {self.connect!r}"

    def command(self) -> Command:
        """The rope holds."""
        return Command(operation=CONNECT, actuates="rope", name=self.connect, value=self.slack)

    def check(self, state: OperationState, key: str) -> None:
        """It does not hold yet."""
        place = f"{key}.connect"
        state.rope(self.connect, place)
        if self.connect not in state.loose:
            raise InputError(
                f"{self.connect!r} is connected then",
                key=place,
                expected="a rope that was released, or is in 'prepared'",
            )
        state.loose.discard(self.connect)
