"""How many contacts there are, how many of them take part, and what they are called in messages.

Contacts of contours are always there. Those between triangles come behind them and come and go.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows

__all__ = ["block_of", "contact_count", "owner_of"]


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
