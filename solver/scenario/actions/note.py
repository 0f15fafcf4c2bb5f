"""A line in the log."""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.actions import ACTIONS, Action

__all__ = ["Note"]


@ACTIONS.describe("note")
@dataclass(frozen=True)
class Note(Action):
    """A line in the log."""

    ORDER: ClassVar[float] = 10

    note: str
    """Words for the log."""

    @property
    def text(self) -> str:
        """The words."""
        return self.note
