"""An audible signal, as a crane driver or a banksman gives it before a move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.actions import ACTIONS, Action

if TYPE_CHECKING:
    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["Horn"]


@ACTIONS.describe("horn")
@dataclass(frozen=True)
class Horn(Action):
    """A signal that is heard: a line in the log, and a tone in the page of a report."""

    horn: str
    """What the signal means, for the log and the page. Nothing moves by it."""
    pitch: Annotated[float, Quantity("frequency", minimum=50.0, maximum=5000.0, closed=True)] = 440.0
    """Frequency of the tone [Hz]."""

    def check(self, state: OperationState, key: str) -> None:
        """It means something."""
        del state
        if not self.horn.strip():
            raise InputError("no words", key=f"{key}.horn", expected="what the signal means")

    @property
    def text(self) -> str:
        """Words for it."""
        return f"horn: {self.horn}"

    def tone(self) -> float:
        """As it was given."""
        return self.pitch
