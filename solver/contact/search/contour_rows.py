"""Rows of a contact on the side of its contour: what all bodies with a frame share.

"Deformable bodies with complex geometries ... sliding contacts" (2014), section 3.1.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate_back
from heavylift.solver.contact.kind import OF_RIGID, ContactRows

__all__ = ["put_frame_rows", "put_pose_rows"]


@kernel(internal=True)
def put_frame_rows(contacts: ContactRows, contact: int) -> None:
    """Of the contour, whose touched point recedes."""
    put_pose_rows(contacts, 2 * contact, contacts.table[contact].contour, -1.0)


@kernel(internal=True)
def put_pose_rows(contacts: ContactRows, attachment: int, pose_row: int, sign: float) -> None:
    """``sign d . [1, -R c~]`` of the three directions d at the lever c: velocity of the frame, own spin.

    On a hull that interacts with others rows run over the velocities of all of them, and the frame has six of these.
    """
    width = contacts.attachments[attachment].width
    if width == 0:
        return
    lanes = len(contacts.shape[1])
    panel = contacts.attachments[attachment].panel
    if width > 6 and contacts.contours[pose_row].owner == OF_RIGID:
        for i in range(width * lanes):
            contacts.panels[panel + i] = 0.0
        panel += lanes * (contacts.contours[pose_row].dof - contacts.attachments[attachment].dof)
    scratch = contacts.scratch
    pose = contacts.poses[pose_row]
    c1, c2, c3 = sign * scratch.lever[0], sign * scratch.lever[1], sign * scratch.lever[2]
    for r in range(3):
        d1, d2, d3 = scratch.directions[r, 0], scratch.directions[r, 1], scratch.directions[r, 2]
        e1, e2, e3 = rotate_back(pose.rotation, (d1, d2, d3))
        contacts.panels[panel + r] = sign * d1
        contacts.panels[panel + lanes + r] = sign * d2
        contacts.panels[panel + 2 * lanes + r] = sign * d3
        contacts.panels[panel + 3 * lanes + r] = c2 * e3 - c3 * e2
        contacts.panels[panel + 4 * lanes + r] = c3 * e1 - c1 * e3
        contacts.panels[panel + 5 * lanes + r] = c1 * e2 - c2 * e1
