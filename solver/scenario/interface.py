"""What a scenario asks of a step: operations, all of them optional, so a scene without one runs loops over nothing."""

from __future__ import annotations

from heavylift.solver.interface import Bodies, Forces, Joints, Systems, Workspace
from heavylift.solver.kinds import optional

__all__ = ["SCENARIO", "direct", "keep_state", "take_back"]

SCENARIO = "scenario"
"""Group of these operations."""


@optional(SCENARIO)
def keep_state(kinds: Forces) -> None:
    """Scenarios: copy what the step is about to change, where no contacts do."""


@optional(SCENARIO)
def direct(
    kinds: Forces,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
    step: float,
    recorded: bool,
) -> None:
    """Scenarios: look at a step from `time` on that stands, and act at its end.

    `work.control.split` is set where something has to be done within the step: then all of it is taken back and
    repeated up to there. Where a record is written next, `work.status.outcome` may end the run.
    """


@optional(SCENARIO)
def take_back(kinds: Forces) -> None:
    """Scenarios: restore the copy."""
