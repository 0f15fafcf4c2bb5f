"""What contacts ask of bodies: operations, all of them optional.

Contacts touch a frame or shell, which has a spline of its own shape, through *moving points*, three velocities each
behind those of the bases of the body, in the axes of its nodal coordinates: those of the body as it was placed, which
stand still. A vector v there is ``R v`` in the world, a point x is at ``R x + o``, with orientation and position of the
body.

An aim lasts for the stage: `factor` and `advance` forget it. So at each stage all contacts first say where they touch
(`put_contour_rows`), then the points get their velocities (`settle_points`), and only then rows are asked for rates.
"""

from __future__ import annotations

from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.interface import Bodies, Systems, Workspace
from heavylift.solver.kinds import optional

__all__ = [
    "bound_motion",
    "form_controls",
    "keep_places",
    "pose_contours",
    "put_contour_rows",
    "put_surface_rows",
    "settle_points",
]


@optional("contact")
def pose_contours(kinds: Bodies, at_midpoint: bool, contacts: ContactRows) -> None:
    """Bodies: rotation and origin of their contours at the stage, which the markers have been filled for.

    Points of surfaces of triangles that deform too; what follows from these the contacts find themselves.
    """


@optional("contact")
def form_controls(
    kinds: Bodies, contacts: ContactRows, contour: int, first_u: int, last_u: int, first_v: int, last_v: int
) -> None:
    """Bodies whose contours deform: control points of a window, both ends included, in the axes of the contour."""


@optional("contact")
def put_contour_rows(kinds: Bodies, contacts: ContactRows, contact: int, count: int) -> None:
    """Bodies: rows of a contact on the side of their contour, minus the rates of the touched point.

    The touched point is the weighted sum of `count` control points plus an offset; places and weights, directions of
    the rows, lever and slopes stand in the scratch arrays of the contacts.
    """


@optional("contact")
def bound_motion(kinds: Bodies, contacts: ContactRows, step: float, work: Workspace) -> None:
    """Bodies: how far any point of a contour moves in the step at the velocity of the stage, at most, into its pose."""


@optional("contact")
def keep_places(kinds: Bodies, contacts: ContactRows, back: bool) -> None:
    """Bodies: where those that sleep are, into `ContactRows.slept`, or back from there."""


@optional("contact")
def put_surface_rows(kinds: Bodies, contacts: ContactRows, contact: int, side: int, work: Workspace) -> None:
    """Bodies whose surface deforms: rows of a contact between triangles on one of its sides.

    The touched point is the sum of the points in `contacts.facets.corners` times `shares`; directions stand in the
    scratch of the contacts. A moving point is aimed at it, whose velocity at the carried state goes into the workspace,
    so that rates are known at once at the end of a step; `settle_points` finds those of the middle.
    """


@optional("contact")
def settle_points(kinds: Bodies, systems: Systems, at_midpoint: bool, work: Workspace) -> None:
    """Bodies: after points have been aimed, their velocities of the stage into the workspace.

    At the midpoint these are free velocities and what the impulses of the rows have added; at the end of the step
    those that `advance` has left, and likewise. Impulses are those in the rows of `systems`, where nothing may stand
    but what the velocities of the bases contain as well; with no systems there are none. What rows of joints on the
    mesh do to the points is found too: their ``X = A^-1 G^T``.
    """
