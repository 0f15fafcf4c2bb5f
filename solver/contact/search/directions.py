"""Directions of the rows of a contact, and control points of a span: what all searches share."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross, rotate
from heavylift.solver.contact.interface import form_controls
from heavylift.solver.contact.kind import OF_GROUND, OF_RIGID, ContactRows
from heavylift.solver.interface import Bodies

__all__ = ["form_span", "put_ball", "put_directions"]


@kernel(internal=True)
def form_span(contacts: ContactRows, bodies: Bodies, contour: int, span_u: int, span_v: int) -> None:
    """Control points of one span in both directions."""
    row = contacts.contours[contour]
    if row.owner not in (OF_RIGID, OF_GROUND):
        form_controls(bodies, contacts, contour, span_u - row.u.degree, span_u, span_v - row.v.degree, span_v)


@kernel(internal=True)
def put_directions(
    contacts: ContactRows, contour: int, n1: float, n2: float, n3: float, t1: float, t2: float, t3: float
) -> None:
    """Normal, first tangent and ``n x t`` in the world, from unit vectors in the axes of the contour."""
    pose, scratch = contacts.poses[contour], contacts.scratch
    s1, s2, s3 = cross((n1, n2, n3), (t1, t2, t3))
    a, b, d = (
        rotate(pose.rotation, (n1, n2, n3)),
        rotate(pose.rotation, (t1, t2, t3)),
        rotate(pose.rotation, (s1, s2, s3)),
    )
    for k in range(3):
        scratch.directions[0, k] = a[k]
        scratch.directions[1, k] = b[k]
        scratch.directions[2, k] = d[k]


@kernel(internal=True)
def put_ball(contacts: ContactRows, contour: int, length: float, n1: float, n2: float, n3: float) -> None:
    """Arm of a point or ball: from its centre against the normal to the contour, so that forces on both meet."""
    a = rotate(contacts.poses[contour].rotation, (n1, n2, n3))
    for k in range(3):
        contacts.scratch.arm[k] = -length * a[k]
