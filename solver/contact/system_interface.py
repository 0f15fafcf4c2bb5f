"""What contacts ask of other systems of rows, and a step of contacts: verbs, all of them optional."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.solver.interface import Bodies, Joints, Systems, Workspace
from heavylift.solver.kinds import optional

__all__ = [
    "after_step",
    "before_advance",
    "close_start",
    "follow",
    "follow_end",
    "go_back",
    "locate_ends",
    "locate_start",
    "meet_again",
    "meet_contacts",
    "project_contacts",
    "respond",
]


@optional("contact")
def respond(systems: Systems, velocity: Floats1) -> None:
    """Rows of joints: change a velocity as their impulses do when something pushes, by the factor that is there."""


@optional("contact")
def follow(systems: Systems, joints: Joints, work: Workspace, time: float, step: float) -> None:
    """Rows of joints at the midpoint: solve again after contacts have pushed; `control.changed` if laws have moved."""


@optional("contact")
def follow_end(systems: Systems, work: Workspace) -> None:
    """Rows of joints at the end of the step: the same for the projection."""


@optional("contact")
def meet_contacts(
    systems: Systems,
    rows: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
    nominal: float,
) -> None:
    """Contacts: impulses at the midpoint, after the rows of the joints have been solved."""


@optional("contact")
def meet_again(
    systems: Systems, rows: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Contacts: the same with the factors that are there, after free velocities have changed."""


@optional("contact")
def before_advance(systems: Systems, bodies: Bodies, work: Workspace, step: float) -> None:
    """Contacts: keep a copy of the state, to which an impact within the step goes back; how far things move."""


@optional("contact")
def locate_start(systems: Systems, bodies: Bodies, work: Workspace, step: float) -> None:
    """Contacts, before time starts: where they touch, searched from everywhere."""


@optional("contact")
def close_start(systems: Systems, work: Workspace) -> None:
    """Contacts, before time starts: what the impacts at the start have closed."""


@optional("contact")
def locate_ends(systems: Systems, bodies: Bodies, work: Workspace, time: float, step: float) -> None:
    """Contacts: gaps at the end of the step; the time of the first impact in it."""


@optional("contact")
def project_contacts(
    systems: Systems, bodies: Bodies, rows: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Contacts: impacts, and the velocities of what stays closed, at the end of the step."""


@optional("contact")
def go_back(systems: Systems) -> None:
    """Contacts: restore the copy of the state."""


@optional("contact")
def after_step(systems: Systems, bodies: Bodies, work: Workspace, step: float, whole: bool) -> None:
    """Contacts: forget accelerations after an impact; count impacts anew after a whole step."""
