"""Where a contact touches: the point of the contour, the normal, the gap, and its rows on both sides.

Everything happens in the axes of the contour, in which the control points of a rigid body stand still and those of a
flexible body are formed where they are needed. Rows on the side of what touches, a point of a body, come from a marker
and three directions of that body.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate, rotate_back, subtract
from heavylift.solver.contact.interface import put_contour_rows
from heavylift.solver.contact.kind import LOST, NOT_A_NUMBER, OF_GROUND, OF_RIGID, TRIANGLES, ContactRows
from heavylift.solver.contact.search.features import touch, weigh
from heavylift.solver.contact.triangles.interface import touch_triangles
from heavylift.solver.interface import Bodies, Workspace

__all__ = ["locate"]


@kernel(internal=True)
def locate(contacts: ContactRows, bodies: Bodies, c: int, cold: bool, work: Workspace) -> None:
    """Search, then gap, touched point and rows of a contact at the stage.

    Parameters
    ----------
    contacts, bodies, work
        Posed contours, bodies, filled markers.
    c
        The contact.
    cold
        Search from everywhere, not from the last place.
    """
    if contacts.table[c].shape_kind == TRIANGLES:
        touch_triangles(contacts.meshes, contacts, bodies, c, work)
        return
    contour = contacts.table[c].contour
    pose, scratch, state = contacts.poses[contour], contacts.scratch, contacts.state[c]
    marker = contacts.table[c].centre
    y1, y2, y3 = rotate_back(
        pose.rotation,
        subtract(work.markers[marker].point, pose.origin),
    )
    scratch.has_slopes = False
    touch(contacts.features, contacts, bodies, c, cold, y1, y2, y3, work)
    result = scratch.result
    state.u, state.v = result.u, result.v
    if not state.closed and LOST <= state.search <= NOT_A_NUMBER:
        state.end_gap = state.gap  # nothing is known of it
    contacts.counts.controls = 0
    if contacts.contours[contour].owner != OF_RIGID and contacts.contours[contour].owner != OF_GROUND:
        weigh(contacts.features, contacts, bodies, c, y1, y2, y3)
    s = rotate(pose.rotation, scratch.lever)
    for k in range(3):
        state.touched[k] = pose.origin[k] + s[k]
        state.normal[k] = scratch.directions[0, k]
        state.tangent[k] = scratch.directions[1, k]
    put_contour_rows(bodies, contacts, c, contacts.counts.controls)
    put_slider_rows(contacts, c, work)


@kernel(internal=True)
def put_slider_rows(contacts: ContactRows, contact: int, work: Workspace) -> None:
    """``d . J`` of the touching point: that of the marker, and of the arm to it, which turns with the directions.

    Notes
    -----
    An arm a that stands still in a body is ``sum (a . e_k) e_k`` over its three directions, so
    ``J = J_point + sum (a . e_k) J_k`` for any kind of body.
    """
    lanes = len(contacts.shape[1])
    panel, width = contacts.attachments[2 * contact + 1].panel, contacts.attachments[2 * contact + 1].width
    scratch = contacts.scratch
    marker, first_axis = contacts.table[contact].centre, contacts.table[contact].axes
    J = work.jacobian[marker]
    for r in range(3):
        d1, d2, d3 = scratch.directions[r, 0], scratch.directions[r, 1], scratch.directions[r, 2]
        for i in range(width):
            contacts.panels[panel + i * lanes + r] = d1 * J[0, i] + d2 * J[1, i] + d3 * J[2, i]
    if first_axis < 0:
        return
    for m in range(first_axis, first_axis + 3):
        share = 0.0
        for k in range(3):
            share += scratch.arm[k] * work.markers[m].point[k]
        if share == 0.0:
            continue
        T = work.jacobian[m]
        for r in range(3):
            d = scratch.directions[r]
            d1, d2, d3 = share * d[0], share * d[1], share * d[2]
            for i in range(width):
                contacts.panels[panel + i * lanes + r] += d1 * T[0, i] + d2 * T[1, i] + d3 * T[2, i]
