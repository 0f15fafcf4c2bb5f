"""What contacts feel of each other: rates at all contacts by unit impulses at each, through bodies and joints."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.system_interface import respond
from heavylift.solver.interface import Systems
from heavylift.solver.rows.structure import (
    DIAGONAL,
    FACTORED,
)

__all__ = ["assemble_delassus", "contact_rates", "own_response", "push"]


@kernel(internal=True)
def push(
    contacts: ContactRows, contact: int, row: int, impulse: float, velocity: NDArray[np.float64]
) -> None:
    """``U += A^-1 n p`` of one row of a contact, bodies alone."""
    lanes = len(contacts.shape[1])
    half = contacts.panels.shape[0] // 2
    for i in (2 * contact, 2 * contact + 1):
        holder = contacts.attachments[i].holder
        if holder != DIAGONAL and holder != FACTORED:  # noqa: PLR1714  a set costs time here
            continue
        dof, at = contacts.attachments[i].dof, contacts.attachments[i].panel + row
        if holder == FACTORED:
            at += half
            for k in range(contacts.attachments[i].width):
                velocity[dof + k] += contacts.panels[at + k * lanes] * impulse
        else:
            for k in range(contacts.attachments[i].width):
                velocity[dof + k] += (
                    contacts.panels[at + k * lanes] * contacts.inverse_mass[dof + k] * impulse
                )


@kernel(internal=True)
def own_response(contacts: ContactRows, contact: int, row: int) -> float:
    """Rate of one row of a contact by a unit impulse on it, bodies alone."""
    lanes = len(contacts.shape[1])
    half = contacts.panels.shape[0] // 2
    total = 0.0
    for i in (2 * contact, 2 * contact + 1):
        holder = contacts.attachments[i].holder
        dof, at = contacts.attachments[i].dof, contacts.attachments[i].panel + row
        for k in range(contacts.attachments[i].width):
            if holder == FACTORED:
                total += contacts.panels[at + k * lanes] * contacts.panels[half + at + k * lanes]
            elif holder == DIAGONAL:
                pushed = contacts.panels[at + k * lanes] * contacts.inverse_mass[dof + k]
                total += contacts.panels[at + k * lanes] * pushed
    return total


@kernel(internal=True)
def contact_rates(
    contacts: ContactRows, contact: int, velocity: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Rates of the three rows of a contact."""
    lanes = len(contacts.shape[1])
    a = b = c = 0.0
    for i in (2 * contact, 2 * contact + 1):
        dof, panel = contacts.attachments[i].dof, contacts.attachments[i].panel
        for k in range(contacts.attachments[i].width):
            v = velocity[dof + k]
            at = panel + k * lanes
            a += contacts.panels[at] * v
            b += contacts.panels[at + 1] * v
            c += contacts.panels[at + 2] * v
    return a, b, c


@kernel(internal=True)
def assemble_delassus(
    contacts: ContactRows,
    systems: Systems,
    present: NDArray[np.int64],
    count: int,
    column: NDArray[np.float64],
) -> None:
    """``W = N (A^-1 - X S^-1 X^T) N^T`` of the contacts that are present, three rows each.

    Parameters
    ----------
    contacts, systems
        Contacts, and all systems of rows.
    present, count
        Numbers of the contacts that take part.
    column
        Scratch, as long as the velocities of the scene.
    """
    W = contacts.delassus
    for j in range(count):
        for r in range(3):
            for i in range(column.shape[0]):
                column[i] = 0.0
            push(contacts, present[j], r, 1.0, column)
            respond(systems, column)
            for i in range(count):
                a, b, c = contact_rates(contacts, present[i], column)
                W[3 * i, 3 * j + r] = a
                W[3 * i + 1, 3 * j + r] = b
                W[3 * i + 2, 3 * j + r] = c
