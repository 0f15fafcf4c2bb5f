"""Drives of joints and of frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import ByCoordinate, Quantity
from heavylift.solver.scene.actions import ACTIONS, Action, MotionKeys, NamesOf, Ramp
from heavylift.solver.scene.commands import Command
from heavylift.solver.scene.operations import GO_BY, GO_TO, SPEED

if TYPE_CHECKING:
    from heavylift.solver.scene.actions import Targets
    from heavylift.solver.scene.operation_state import OperationState

__all__ = ["DriveSpeed", "DriveTo"]


@dataclass(frozen=True)
class DriveSpeed(Ramp):
    """A drive comes to a speed.

    Attributes
    ----------
    drive
        Name of a joint with a drive, or of a body with an axis: ``"trolley.x"``, ``"mast.angle"``.
    speed
        [m/s] or [rad/s].
    """

    drive: str
    speed: float
    ramp: float = 0.0

    @property
    def text(self) -> str:
        """Words for it."""
        return f"drive of {self.drive!r} to {self.speed:g} /s{self.in_ramp}"

    def command(self) -> Command:
        """A speed."""
        return Command(operation=SPEED, actuates="drive", name=self.drive, value=self.speed, **self.limits)

    def check(self, state: OperationState, key: str) -> None:
        """The drive is a table alone."""
        state.drive(self.drive, f"{key}.drive")
        if self.speed == 0.0:
            state.arriving.add(self.drive)


@dataclass(frozen=True)
class DriveTo(Ramp):
    """A drive goes to a place, and stops there.

    Attributes
    ----------
    drive
        As of `DriveSpeed`.
    place
        Value of the coordinate of the joint, displacement or angle of the frame [m] or [rad].
    speed
        At most.
    by
        Whether the place is reckoned from where it is.
    """

    drive: str
    place: float
    speed: float
    ramp: float = 0.0
    by: bool = False

    @property
    def text(self) -> str:
        """Words for it."""
        return f"drive of {self.drive!r} {'by' if self.by else 'to'} {self.place:g} at {self.speed:g} /s"

    def command(self) -> Command:
        """A move to rest."""
        return Command(
            operation=GO_BY if self.by else GO_TO,
            actuates="drive",
            name=self.drive,
            value=self.place,
            speed=self.speed,
            **self.limits,
        )

    def check(self, state: OperationState, key: str) -> None:
        """The drive is a table alone."""
        state.drive(self.drive, f"{key}.drive")
        state.arriving.add(self.drive)


@ACTIONS.describe("drive")
@dataclass(frozen=True)
class DriveKeys(MotionKeys):
    """What joints and frames with a drive do."""

    ORDER: ClassVar[float] = 3
    TELLS: ClassVar[tuple[str, ...]] = ("position", "distance")

    drive: Annotated[str, NamesOf("drives")]
    """Joints with a drive, or bodies with an axis whose frame is driven or fixed: ``"trolley.x"``, ``"mast.angle"``."""
    position: Annotated[float | None, ByCoordinate(Quantity("angle"), Quantity("length"))] = None
    """Value of the coordinate of the joint, displacement or angle of the frame, where the drive stops [m], [rad]."""

    @classmethod
    def made(cls, given: Any, targets: Targets, group: int) -> tuple[Action, ...]:  # noqa: ARG003
        """A speed, or a place to go to."""
        drives = targets.fitting("drive", given.drive, targets.drives)
        targets.move_together(drives, "drive")
        limits = {"acceleration": given.acceleration or 0.0, "jerk": given.jerk or 0.0}
        place, by = (given.position, False) if given.distance is None else (given.distance, True)
        if place is None:
            return tuple(DriveSpeed(name, given.speed, given.ramp, **limits) for name in drives)
        return tuple(DriveTo(name, place, given.speed, given.ramp, by, **limits) for name in drives)
