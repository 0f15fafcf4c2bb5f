"""What an action gives to an actuator, in words; a record of numbers is made of it for the run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.operations import NOTHING

if TYPE_CHECKING:
    from heavylift.solver.scene.signals import Signal

__all__ = ["Command"]


@dataclass(frozen=True, kw_only=True)
class Command:
    """What the sequencer does for an action.

    Attributes
    ----------
    operation
        One of `heavylift.solver.scene.operations`.
    actuates
        What sort of thing the name is of: a winch, called by its rope; a rope without its winch; ...; or nothing. The
        value of a winch is the length that is hauled in [m], but for `GO_TO` the unstretched length of the rope; that
        of a drive its coordinate [m], [rad]; of a tank the mass in it [kg]; of a path the distance along it [m].
    name
        Of the rope, drive, tank, transporter, joint or machine.
    value
        `SPEED`: per second; `GO_TO`: value at the end; `GO_BY`: by how much; `KEEP`: tension [N]; `KEEP_LEVEL`: share,
        0 ends it; `BRAKE`, `FAIL`: 1 on, 0 off; `CONNECT`: slack [m].
    speed
        Largest one of a move, or with which a tension or a level is kept.
    ramp
        Time in which the speed changes, or reaches the largest one, [s]; 0 if the limits below say it.
    acceleration, jerk
        Limits; 0 is none.
    leader, ratio
        `FOLLOW`: rope of the winch that is copied, and length per length of that. A path without `SPEED` continues as
        planned.
    signal, parts
        `GO_BY`: in place of the distance what the signal is below the value, times the parts.
    dead_band
        `KEEP`, `KEEP_LEVEL`: part by which it may be off.
    group
        `KEEP_LEVEL`: number of the group.
    """

    operation: int = NOTHING
    actuates: Literal["", "winch", "rope", "drive", "tank", "path", "joint", "pump", "levelling"] = ""
    name: str = ""
    value: float = 0.0
    speed: float = 0.0
    ramp: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0
    leader: str = ""
    ratio: float = 0.0
    signal: Signal | None = None
    parts: float = 1.0
    dead_band: float = 0.0
    group: int = -1
