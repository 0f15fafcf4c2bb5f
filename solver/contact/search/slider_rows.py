"""Rows of a contact on the side of what touches: a point of a body, from a marker and three directions of that body."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.interface import Workspace

__all__ = ["put_slider_rows"]


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
