"""What drives something fails, at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.actions import ACTIONS, Action, ActionKeys, NamesOf
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.operation_state import known_thing
from heavylift.solver.scene.operations import FAIL

if TYPE_CHECKING:
    from heavylift.solver.scene.actions import Targets
    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["MACHINES", "Fail", "Sort", "check_machine", "machines_of"]

Sort = Literal["winch", "drive", "tank", "pump", "levelling"]
"""What of something fails: the winch of a rope, a drive, the pump of a tank, a pump, the levelling of a transporter."""
MACHINES: dict[str, str] = {
    "winch": "the winch of",
    "drive": "drive",
    "tank": "the pump of tank",
    "pump": "pump",
    "levelling": "the levelling of",
}
WORDS = "winch, hook, drive, tank, pump, controller or levelled transporter"


@dataclass(frozen=True)
class Fail(Action):
    """What drives something fails, at once: it stands where it is, held by its brake.

    Attributes
    ----------
    machine
        Name of the rope of a winch, of a drive, a tank, a pump or a transporter.
    sort
        What of it: its winch, its drive, the pump of the tank, the pump, the levelling of the transporter.
    """

    machine: str
    sort: Sort

    @property
    def text(self) -> str:
        """Words for it."""
        return f"failure of {MACHINES[self.sort]} {self.machine!r}"

    def command(self) -> Command:
        """It stops."""
        return Command(operation=FAIL, actuates=self.sort, name=self.machine, value=1.0)

    def check(self, state: OperationState, key: str) -> None:
        """It works until then; what follows it arrives nowhere."""
        name = self.machine
        check_machine(state, name, self.sort, f"{key}.fail")
        if name in state.failed:
            raise InputError(
                f"{name!r} has failed already then",
                key=f"{key}.fail",
                expected="'fail' first, then 'restore'",
            )
        state.failed.add(name)
        for known in (state.followed, state.levels, state.lengths):
            known.pop(name, None)
        state.planned[name], state.largest[name] = 0.0, (0.0, 0.0)
        followers = [one for one, leader in state.followed.items() if leader == name]
        state.arriving -= {name, *followers}


@ACTIONS.describe("fail")
@dataclass(frozen=True)
class FailKeys(ActionKeys):
    """What drives something fails, at once."""

    ORDER: ClassVar[float] = 7

    fail: Annotated[str, NamesOf("machines", WORDS)]
    """What drives something fails, at once: the winch of a rope or of a hook, a drive, the pump of a tank, a pump of a
    controller, a controller with all its pumps, the levelling of a transporter. Its brake holds it where it is."""

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:  # noqa: ARG003
        """One for each machine."""
        return tuple(Fail(*one) for one in machines_of("fail", given.fail, targets))


def machines_of(key: str, patterns: Any, targets: Targets) -> list[tuple[str, Any]]:
    """Names and sorts of all that a case calls by some names."""
    names = targets.fitting(key, patterns, list(targets.machines), WORDS)
    found = list(dict.fromkeys(one for name in names for one in targets.machines[name]))
    targets.move_together([name for name, sort in found if sort == "drive"], key)
    return found


def check_machine(state: OperationState, name: str, sort: str, key: str) -> None:
    """Something that can fail."""
    if sort == "winch":
        state.winch(name, key)
    elif sort == "drive":
        state.drive(name, key)
    elif sort == "tank":
        state.tank(name, key, expected="that pump, {}")
    else:
        reason = known_thing("pump or levelled transporter", name, state.movable.helpers, key)
        if reason:
            raise InputError(f"{name!r} {reason}", key=key, expected="a pump of a controller")
