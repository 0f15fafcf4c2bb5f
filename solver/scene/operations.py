"""What the sequencer of a scenario can do for an action, by number: all that its kernels know of actions."""

from __future__ import annotations

__all__ = [
    "BRAKE",
    "CONNECT",
    "FAIL",
    "FOLLOW",
    "GO_BY",
    "GO_TO",
    "KEEP",
    "KEEP_LEVEL",
    "MOVES",
    "NOTHING",
    "RELEASE",
    "RELEASE_JOINT",
    "SPEED",
]

SPEED, GO_TO, GO_BY, FOLLOW, KEEP, KEEP_LEVEL, BRAKE, RELEASE, CONNECT, NOTHING, RELEASE_JOINT, FAIL = range(
    12
)
"""`SPEED`: come to a speed; `GO_TO`, `GO_BY`: to rest at a value, or after a distance; `FOLLOW`: copy another winch;
`KEEP`: stop and keep a tension; `KEEP_LEVEL`: keep a share of a load beside the rest; `BRAKE`: stop with the brake set,
or let it off; `RELEASE`, `CONNECT`: of a rope; `RELEASE_JOINT`; `FAIL`: stop, or be able to move again; `NOTHING`: a
line in the log."""

MOVES = (SPEED, GO_TO, GO_BY)
"""Operations after which an actuator moves as it was planned when they were done."""
