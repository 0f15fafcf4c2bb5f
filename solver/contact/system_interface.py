"""What contacts ask of the joints, and what they alone do in a step: operations, all of them optional."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.solver.interface import Bodies, Joints, Systems, Workspace
from heavylift.solver.kinds import optional

__all__ = ["after_step", "before_advance", "follow", "go_back", "respond"]


@optional("contact")
def respond(systems: Systems, velocity: Floats1) -> None:
    """Rows of joints: change a velocity as their impulses do when something pushes, by the factor that is there."""


@optional("contact")
def follow(
    systems: Systems, joints: Joints, at_midpoint: bool, work: Workspace, time: float, step: float
) -> None:
    """Rows of joints: solve again after contacts have pushed; `control.changed` if laws have moved at the midpoint."""


@optional("contact")
def before_advance(systems: Systems, bodies: Bodies, work: Workspace, step: float) -> None:
    """Contacts: keep a copy of the state, to which an impact within the step goes back; how far bodies move."""


@optional("contact")
def go_back(systems: Systems) -> None:
    """Contacts: restore the copy of the state."""


@optional("contact")
def after_step(systems: Systems, bodies: Bodies, work: Workspace, step: float, whole: bool) -> None:
    """Contacts: forget accelerations after an impact; count impacts anew after a whole step."""
