"""How many contacts there are, what they are called in messages, and what of steps is the same for all of them.

Contacts of contours are always there. Those between triangles come behind them and come and go.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.interface import Workspace

__all__ = ["block_of", "carried_on", "contact_count", "owner_of"]

FARTHEST = 0.75
"""Of the change from one step to the next; behind a step that an impact has cut to nothing more would be noise."""


@kernel(inline=True, internal=True)
def contact_count(contacts: ContactRows) -> int:
    """Contacts at present."""
    return contacts.counts.total


@kernel(inline=True, internal=True)
def owner_of(contacts: ContactRows, contact: int) -> int:
    """Number of what a contact belongs to: itself on a contour; pairs of surfaces come behind those."""
    of_contours = contacts.counts.of_contours
    if contact >= of_contours:
        contact = of_contours + contacts.state[contact].pair
    return contact


@kernel(inline=True, internal=True)
def block_of(contacts: ContactRows, contact: int) -> int:
    """Number of the name of a contact: those of joints come first, then of contacts, then of pairs of surfaces."""
    return contacts.counts.first_block + owner_of(contacts, contact)


@kernel(inline=True, internal=True)
def carried_on(step: float, work: Workspace) -> float:
    """Part of the change of a mean force from step to step that leads from the middle of this one to its end."""
    return min(step / (step + work.control.last_step), FARTHEST)
