"""Rows of a contact on the side of its contour: what all bodies with a frame share."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import rotate_back
from heavylift.solver.contact.kind import CONTOUR, DIRECTIONS, LEVER, ContactRows
from heavylift.solver.rows import PANEL

__all__ = ["put_frame_rows"]


@kernel(internal=True)
def put_frame_rows(contacts: ContactRows, contact: int) -> None:
    """``-d . [1, -R c~]`` of the three directions d: velocity of the frame in the world, spin in its own axes."""
    lanes = len(contacts.shape[1])
    panel = contacts.attachments[2 * contact, PANEL]
    scratch = contacts.scratch
    pose = contacts.poses[contacts.table[contact, CONTOUR]]
    c1, c2, c3 = scratch[LEVER], scratch[LEVER + 1], scratch[LEVER + 2]
    for r in range(3):
        at = DIRECTIONS + 3 * r
        d1, d2, d3 = scratch[at], scratch[at + 1], scratch[at + 2]
        e1, e2, e3 = rotate_back(pose, d1, d2, d3)
        contacts.panels[panel + r] = -d1
        contacts.panels[panel + lanes + r] = -d2
        contacts.panels[panel + 2 * lanes + r] = -d3
        contacts.panels[panel + 3 * lanes + r] = c3 * e2 - c2 * e3
        contacts.panels[panel + 4 * lanes + r] = c1 * e3 - c3 * e1
        contacts.panels[panel + 5 * lanes + r] = c2 * e1 - c1 * e2
