"""How many contacts there are, how many of them take part, and what they are called in messages.

Contacts of contours are always there. Those between triangles come behind them and come and go.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import (
    COUNT,
    FIRST_BLOCK,
    LARGEST_CONTROLS,
    OF_CONTOURS,
    PAIR,
    ContactRows,
)

__all__ = ["block_of", "contact_count", "number_of", "set_number"]


@kernel(inline=True, internal=True)
def number_of(contacts: ContactRows, what: int) -> int:
    """One of the numbers behind the list of the contacts that take part."""
    return contacts.places[LARGEST_CONTROLS + contacts.table.shape[0] + what]


@kernel(inline=True, internal=True)
def set_number(contacts: ContactRows, what: int, value: int) -> None:
    """Change one of them."""
    contacts.places[LARGEST_CONTROLS + contacts.table.shape[0] + what] = value


@kernel(inline=True, internal=True)
def contact_count(contacts: ContactRows) -> int:
    """Contacts at present."""
    return contacts.places[LARGEST_CONTROLS + contacts.table.shape[0] + COUNT]


@kernel(inline=True, internal=True)
def block_of(contacts: ContactRows, contact: int) -> int:
    """Number of the name of a contact: those of joints come first, then of contacts, then of pairs of surfaces."""
    of_contours = number_of(contacts, OF_CONTOURS)
    if contact >= of_contours:
        contact = of_contours + int(contacts.state[contact, PAIR])
    return number_of(contacts, FIRST_BLOCK) + contact
