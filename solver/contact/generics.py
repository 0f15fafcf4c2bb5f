"""What contacts ask of bodies and of other systems of rows: verbs, all of them optional."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.interface import Bodies, Joints, Systems, Workspace
from heavylift.solver.kinds import optional

__all__ = [
    "after_step",
    "before_advance",
    "bound_motion",
    "close_start",
    "follow",
    "follow_end",
    "forget_accelerations",
    "form_controls",
    "go_back",
    "locate_ends",
    "locate_start",
    "meet_again",
    "meet_contacts",
    "pose_contours",
    "project_contacts",
    "put_contour_rows",
    "respond",
]


# ---- of bodies ----


@optional
def pose_contours(kinds: Bodies, at_midpoint: bool, contacts: ContactRows) -> None:
    """Bodies: rotation and origin of their contours at the stage, which the markers have been filled for."""


@optional
def form_controls(
    kinds: Bodies, contacts: ContactRows, contour: int, first_u: int, last_u: int, first_v: int, last_v: int
) -> None:
    """Bodies whose contours deform: control points of a window, both ends included, in the axes of the contour."""


@optional
def put_contour_rows(kinds: Bodies, contacts: ContactRows, contact: int, count: int) -> None:
    """Bodies: rows of a contact on the side of their contour, minus the rates of the touched point.

    The touched point is the weighted sum of `count` control points plus an offset; places and weights, directions of
    the rows, lever and slopes stand in the scratch arrays of the contacts.
    """


@optional
def bound_motion(kinds: Bodies, contacts: ContactRows, step: float, work: Workspace) -> None:
    """Bodies: how far any point of a contour moves in the step at the velocity of the stage, at most, into its pose."""


@optional
def forget_accelerations(kinds: Bodies) -> None:
    """Bodies: after an impact the differences of the last step say nothing of the next."""


# ---- of systems of rows ----


@optional
def respond(systems: Systems, velocity: Floats1) -> None:
    """Rows of joints: change a velocity as their impulses do when something pushes, by the factor that is there."""


@optional
def follow(systems: Systems, joints: Joints, work: Workspace, time: float, step: float) -> None:
    """Rows of joints at the midpoint: solve again after contacts have pushed; `CHANGED` if laws have moved."""


@optional
def follow_end(systems: Systems, work: Workspace) -> None:
    """Rows of joints at the end of the step: the same for the projection."""


@optional
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


@optional
def meet_again(
    systems: Systems, rows: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Contacts: the same with the factors that are there, after free velocities have changed."""


@optional
def before_advance(systems: Systems, bodies: Bodies, work: Workspace, step: float) -> None:
    """Contacts: keep a copy of the state, to which an impact within the step goes back; how far things move."""


@optional
def locate_start(systems: Systems, bodies: Bodies, work: Workspace, step: float) -> None:
    """Contacts, before time starts: where they touch, searched from everywhere."""


@optional
def close_start(systems: Systems, work: Workspace) -> None:
    """Contacts, before time starts: what the impacts at the start have closed."""


@optional
def locate_ends(systems: Systems, bodies: Bodies, work: Workspace, time: float, step: float) -> None:
    """Contacts: gaps at the end of the step; the time of the first impact in it."""


@optional
def project_contacts(
    systems: Systems, bodies: Bodies, rows: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Contacts: impacts, and the velocities of what stays closed, at the end of the step."""


@optional
def go_back(systems: Systems) -> None:
    """Contacts: restore the copy of the state."""


@optional
def after_step(systems: Systems, bodies: Bodies, work: Workspace, step: float, whole: bool) -> None:
    """Contacts: forget accelerations after an impact; count impacts anew after a whole step."""
