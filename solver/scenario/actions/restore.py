"""What has failed works again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scenario.actions.fail import MACHINES, WORDS, Sort, check_machine, machines_of
from heavylift.solver.scene.actions import ACTIONS, Action, ActionKeys, NamesOf
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.operations import FAIL

if TYPE_CHECKING:
    from heavylift.solver.scene.actions import Targets
    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["Restore"]


@dataclass(frozen=True)
class Restore(Action):
    """A failed actuator works again: it stays at rest until a command, or the next sample of its controller.

    Attributes
    ----------
    machine, sort
        As of `Fail`.
    """

    machine: str
    sort: Sort

    @property
    def text(self) -> str:
        """Words for it."""
        return f"{MACHINES[self.sort]} {self.machine!r} works again"

    def command(self) -> Command:
        """It may move."""
        return Command(operation=FAIL, actuates=self.sort, name=self.machine)

    def check(self, state: OperationState, key: str) -> None:
        """It has failed until then."""
        check_machine(state, self.machine, self.sort, f"{key}.restore")
        if self.machine not in state.failed:
            raise InputError(
                f"{self.machine!r} has not failed then",
                key=f"{key}.restore",
                expected="'fail' first, then 'restore'",
            )
        state.failed.discard(self.machine)


@ACTIONS.describe("restore")
@dataclass(frozen=True)
class RestoreKeys(ActionKeys):
    """What has failed works again."""

    ORDER: ClassVar[float] = 8

    restore: Annotated[str, NamesOf("machines", WORDS)]
    """A failed actuator works again: it stays at rest until a command, or the next sample of its controller."""

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:  # noqa: ARG003
        """One for each machine."""
        return tuple(Restore(*one) for one in machines_of("restore", given.restore, targets))
