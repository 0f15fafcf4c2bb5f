"""Contacts between triangles come and go: what is carried of them, and what follows from that.

What a contact is (the pair, the two features, the side) stands in its carried state, so a step that is taken back takes
new contacts with it, and a checkpoint holds all of them. Laws and sides of its rows follow from its pair.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import clear_record, copy_record
from heavylift.solver.contact.counts import contact_count, number_of, set_number
from heavylift.solver.contact.facet_interface import take_slots
from heavylift.solver.contact.kind import (
    AXES,
    BESIDE,
    CLOSED,
    CONTOUR,
    COUNT,
    DAMPING,
    END_GAP,
    EVENTS,
    FORCE_LAW,
    GAP,
    HIT,
    IMPACTS,
    IMPULSES,
    LAW,
    LOSS,
    OF_CONTOURS,
    PAIR,
    POINT_SLOT,
    RATE,
    SHAPE,
    SHARE,
    SLIP_PATH,
    START_BESIDE,
    START_GAP,
    START_RATE,
    STATE_WIDTH,
    STIFFNESS,
    TOUCH_DAMPING,
    TRIANGLES,
    VALUE_WIDTH,
    ContactRows,
)
from heavylift.solver.contact.mesh_interface import (
    drop_contacts,
    keep_found,
    place_surfaces,
    restore_contacts,
)
from heavylift.solver.contact.mesh_kind import SurfacePairs, contact_header, gone_contacts
from heavylift.solver.kinds import implement
from heavylift.solver.rows import PRESCRIBED

__all__ = ["add_contact", "header_row", "surface_count"]

FAR = 4.0
"""Reaches of the search at which an open contact goes."""


@kernel(inline=True, internal=True)
def surface_count(contacts: ContactRows, meshes: SurfacePairs) -> int:
    """Rows of `placed` that are poses."""
    return contacts.placed.shape[0] - 1 - meshes.pairs.shape[0]


@kernel(inline=True, internal=True)
def header_row(contacts: ContactRows) -> int:
    """Row of `placed` with the number of contacts."""
    return contacts.placed.shape[0] - 1


@kernel(internal=True)
def _set_count(contacts: ContactRows, count: int) -> None:
    """Of all contacts, those of contours included."""
    set_number(contacts, COUNT, count)
    contact_header(contacts.placed[header_row(contacts)], 0).count = count - number_of(contacts, OF_CONTOURS)


@kernel(internal=True)
def _assign(meshes: SurfacePairs, contacts: ContactRows, c: int) -> None:
    """Laws, values and sides of a contact from its pair."""
    pair = int(contacts.state[c, PAIR])
    row, table = meshes.pairs[pair], contacts.table[c]
    table[CONTOUR], table[AXES], table[SHAPE] = row.poses[0], row.poses[1], TRIANGLES
    table[LAW], table[FORCE_LAW], table[EVENTS] = row.law, row.force_law, row.events
    for k in range(VALUE_WIDTH):
        contacts.values[c, k] = meshes.pair_values[pair, k]
    contacts.values[c, STIFFNESS] *= contacts.state[c, SHARE]
    contacts.values[c, DAMPING] *= contacts.state[c, SHARE]
    for side in range(2):
        end, given = contacts.attachments[2 * c + side], meshes.sides[2 * pair + side]
        end.dof = given.dof
        end.width = given.width
        end.holder = given.holder


@kernel(internal=True)
def _release(contacts: ContactRows, c: int) -> None:
    """A place that no contact has: nothing hangs on it."""
    for side in range(2):
        end = contacts.attachments[2 * c + side]
        end.dof, end.width, end.holder = -1, 0, PRESCRIBED
    clear_record(contacts.rows[c])
    for k in range(STATE_WIDTH):
        contacts.state[c, k] = 0.0


@implement(restore_contacts, SurfacePairs)
@kernel(internal=True)
def restore_mesh_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """From the carried state, whoever has changed it."""
    first = number_of(contacts, OF_CONTOURS)
    before = contact_count(contacts)
    count = first + contact_header(contacts.placed[header_row(contacts)], 0).count
    set_number(contacts, COUNT, count)
    for c in range(first, count):
        _assign(meshes, contacts, c)
    for c in range(count, before):
        _release(contacts, c)


@kernel(internal=True)
def add_contact(meshes: SurfacePairs, contacts: ContactRows, pair: int) -> int:
    """A new contact of a pair, all zero; -1 if there is no place."""
    c = contact_count(contacts)
    if c >= contacts.table.shape[0]:
        return -1
    _release(contacts, c)
    contacts.state[c, PAIR] = pair
    contacts.state[c, TOUCH_DAMPING] = -1.0
    _assign(meshes, contacts, c)
    _set_count(contacts, c + 1)
    take_slots(meshes.facets, meshes, contacts, c)
    return c if contacts.state[c, POINT_SLOT] >= 0.0 else -1


@implement(keep_found, SurfacePairs)
@kernel(internal=True)
def keep_found_contacts(meshes: SurfacePairs, contacts: ContactRows, before: bool) -> None:
    """What was found in the step stands behind the contacts that were there before it."""
    first = number_of(contacts, OF_CONTOURS)
    if before:
        for c in range(first, contact_count(contacts)):
            for k in range(STATE_WIDTH):
                meshes.kept[c, k] = contacts.state[c, k]
        return
    carried = first + contact_header(contacts.placed[header_row(contacts)], 0).count
    for c in range(carried, contact_count(contacts)):
        for k in range(STATE_WIDTH):
            contacts.state[c, k] = meshes.kept[c, k]
        contacts.state[c, GAP], contacts.state[c, RATE] = (
            contacts.state[c, START_GAP],
            contacts.state[c, START_RATE],
        )
        contacts.state[c, LOSS] = contacts.state[c, SHARE] = 0.0
    _set_count(contacts, contact_count(contacts))


@implement(drop_contacts, SurfacePairs)
@kernel(internal=True)
def drop_mesh_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Open contacts whose features are far from each other, or beside each other, go; the last one takes the place."""
    c = number_of(contacts, OF_CONTOURS)
    while c < contact_count(contacts):
        state = contacts.state[c]
        state[HIT] = 0.0
        reach = FAR * meshes.pairs[int(state[PAIR])].reach
        if state[CLOSED] > 0.0 or state[END_GAP] <= reach:
            c += 1
            continue
        gone = gone_contacts(contacts.placed[surface_count(contacts, meshes) + int(state[PAIR])], 0)
        gone.impulse += state[IMPULSES]
        gone.loss += state[LOSS]
        gone.impacts += int(state[IMPACTS])
        gone.slip_path += state[SLIP_PATH]
        last = contact_count(contacts) - 1
        if c != last:
            _move(contacts, last, c)
            _assign(meshes, contacts, c)
        _release(contacts, last)
        _set_count(contacts, last)


@kernel(internal=True)
def _move(contacts: ContactRows, source: int, target: int) -> None:
    """All numbers of a contact to another place."""
    for k in range(STATE_WIDTH):
        contacts.state[target, k] = contacts.state[source, k]
    lanes = len(contacts.shape[1])
    copy_record(contacts.rows[target], contacts.rows[source])
    half = contacts.panels.shape[0] // 2
    for side in range(2):
        old = contacts.attachments[2 * source + side].panel
        new = contacts.attachments[2 * target + side].panel
        for k in range(contacts.attachments[2 * source + side].width * lanes):
            contacts.panels[new + k] = contacts.panels[old + k]
            contacts.panels[half + new + k] = contacts.panels[half + old + k]


@implement(place_surfaces, SurfacePairs)
@kernel(internal=True)
def place_mesh_surfaces(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """The search of the next step begins where this one has ended, and so do its contacts."""
    first = contacts.poses.shape[0] - surface_count(contacts, meshes)
    for i in range(surface_count(contacts, meshes)):
        for k in range(12):
            contacts.placed[i, k] = contacts.poses[first + i, k]
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        contacts.state[c, START_BESIDE] = contacts.state[c, BESIDE]
        contacts.state[c, START_RATE] = contacts.state[c, RATE]
