"""Ropes and joints that are released."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.actions import ACTIONS, Action, ActionKeys, NamesOf
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.operations import RELEASE, RELEASE_JOINT

if TYPE_CHECKING:
    from heavylift.solver.scene.actions import Targets
    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["Release", "ReleaseJoint"]


@dataclass(frozen=True)
class Release(Action):
    """A rope lets go: from now on it does nothing, and what it had stored is lost."""

    rope: str

    @property
    def text(self) -> str:
        """Words for it."""
        return f"release of {self.rope!r}"

    def command(self) -> Command:
        """The rope lets go."""
        return Command(operation=RELEASE, actuates="rope", name=self.rope)

    def check(self, state: OperationState, key: str) -> None:
        """It holds until then."""
        place = f"{key}.release"
        state.rope(self.rope, place)
        if self.rope in state.loose:
            raise InputError(f"{self.rope!r} is not connected then", key=place, expected="a rope that is")
        state.loose.add(self.rope)


@dataclass(frozen=True)
class ReleaseJoint(Action):
    """A joint lets go: from now on its rows do nothing."""

    joint: str

    @property
    def text(self) -> str:
        """Words for it."""
        return f"release of joint {self.joint!r}"

    def command(self) -> Command:
        """Its rows do nothing."""
        return Command(operation=RELEASE_JOINT, actuates="joint", name=self.joint)

    def check(self, state: OperationState, key: str) -> None:
        """It is there still, and is rows alone."""
        state.joint(self.joint, f"{key}.release")
        state.loose.add(self.joint)


@ACTIONS.describe("release")
@dataclass(frozen=True)
class ReleaseKeys(ActionKeys):
    """Ropes and joints that are released."""

    ORDER: ClassVar[float] = 6

    release: Annotated[str, NamesOf("ropes", "rope or joint")]
    """Ropes and joints that are released."""

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:  # noqa: ARG003
        """By what each of them is."""
        known = [*targets.ropes, *targets.joints]
        names = targets.fitting("release", given.release, known, "rope or joint")
        return tuple(ReleaseJoint(name) if name in targets.joints else Release(name) for name in names)
