"""Where a contact touches: the point of the contour, the normal, the gap, and its rows on both sides.

Everything happens in the axes of the contour, in which the control points of a rigid body stand still and those of a
flexible body are formed where they are needed.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import rotate, rotate_back
from heavylift.solver.contact.features import sample, touch, weigh
from heavylift.solver.contact.interface import put_contour_rows
from heavylift.solver.contact.kind import (
    AT_U,
    AT_V,
    CENTRE,
    CLOSED,
    CONTOUR,
    CONTROL_COUNT,
    DIRECTIONS,
    END_GAP,
    GAP,
    HAS_SLOPES,
    LEVER,
    LOST,
    NORMAL,
    NOT_A_NUMBER,
    OF_GROUND,
    OF_RIGID,
    ORIGIN,
    RESULT,
    SEARCH,
    SHAPE,
    TANGENT,
    TOUCHED,
    TRIANGLES,
    ContactRows,
    search_at,
)
from heavylift.solver.contact.mesh_interface import touch_triangles
from heavylift.solver.contact.slider_rows import put_slider_rows
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
    if contacts.table[c, SHAPE] == TRIANGLES:
        touch_triangles(contacts.meshes, contacts, bodies, c, work)
        return
    contour = contacts.table[c, CONTOUR]
    pose, scratch, state = contacts.poses[contour], contacts.scratch, contacts.state[c]
    marker = contacts.table[c, CENTRE]
    y1, y2, y3 = rotate_back(
        pose,
        work.markers[marker].point[0] - pose[ORIGIN],
        work.markers[marker].point[1] - pose[ORIGIN + 1],
        work.markers[marker].point[2] - pose[ORIGIN + 2],
    )
    if cold:
        sample(contacts.features, contacts, bodies, contour)
    scratch[HAS_SLOPES] = 0.0
    touch(contacts.features, contacts, bodies, c, cold, y1, y2, y3, work)
    result = search_at(scratch, RESULT)
    state[AT_U], state[AT_V] = result.u, result.v
    if state[CLOSED] == 0.0 and LOST <= state[SEARCH] <= NOT_A_NUMBER:
        state[END_GAP] = state[GAP]  # nothing is known of it
    contacts.places[CONTROL_COUNT] = 0
    if contacts.contours[contour].owner != OF_RIGID and contacts.contours[contour].owner != OF_GROUND:
        weigh(contacts.features, contacts, bodies, c, y1, y2, y3)
    s = rotate(pose, scratch[LEVER], scratch[LEVER + 1], scratch[LEVER + 2])
    for k in range(3):
        state[TOUCHED + k] = pose[ORIGIN + k] + s[k]
        state[NORMAL + k] = scratch[DIRECTIONS + k]
        state[TANGENT + k] = scratch[DIRECTIONS + 3 + k]
    put_contour_rows(bodies, contacts, c, contacts.places[CONTROL_COUNT])
    put_slider_rows(contacts, c, work)
