"""Contacts between triangles come and go: what is carried of them, and what follows from that.

What a contact is (the pair, the two features, the side) stands in its carried state, so a step that is taken back takes
new contacts with it, and a checkpoint holds all of them. Laws and sides of its rows follow from its pair.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.facet_interface import take_slots
from heavylift.solver.contact.kind import (
    TRIANGLES,
    ContactRows,
    ContactState,
    pose_at,
    values_at,
)
from heavylift.solver.contact.mesh_interface import (
    drop_contacts,
    keep_found,
    place_surfaces,
    restore_contacts,
)
from heavylift.solver.contact.mesh_kind import (
    COUNT_AT,
    FIRST_POSE,
    GONE_IMPACTS,
    GONE_IMPULSE,
    GONE_LOSS,
    GONE_PATH,
    PAIR_EVENTS,
    PAIR_FORCE_LAW,
    PAIR_LAW,
    PAIR_REACH,
    SECOND_POSE,
    SIDE_DOF,
    SIDE_HOLDER,
    SIDE_WIDTH,
    SurfacePairs,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows import DOF, HOLDER, PANEL, PRESCRIBED, ROW_COLUMNS, WIDTH

__all__ = ["add_contact", "header_row", "put_placed", "surface_count"]

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


@kernel(inline=True, internal=True)
def put_placed(contacts: ContactRows, surface: int, pose_row: int) -> None:
    """The pose of a surface is carried."""
    pose, placed = contacts.poses[pose_row], pose_at(contacts.placed[surface], 0)
    for k in range(9):
        placed.rotation[k] = pose.rotation[k]
    for k in range(3):
        placed.origin[k] = pose.origin[k]


@kernel(inline=True, internal=True)
def _copy(source: ContactState, target: ContactState) -> None:
    """All that is carried of a contact."""
    given, out = source.words, target.words
    for k in range(out.shape[0]):
        out[k] = given[k]


@kernel(internal=True)
def _set_count(contacts: ContactRows, count: int) -> None:
    """Of all contacts, those of contours included."""
    contacts.counts.total = count
    contacts.placed[header_row(contacts), COUNT_AT] = count - contacts.counts.of_contours


@kernel(internal=True)
def _assign(meshes: SurfacePairs, contacts: ContactRows, c: int) -> None:
    """Laws, values and sides of a contact from its pair."""
    pair = contacts.state[c].pair
    row, table = meshes.pairs[pair], contacts.table[c]
    table.contour, table.axes, table.shape_kind = row[FIRST_POSE], row[SECOND_POSE], TRIANGLES
    table.law, table.force_law, table.events = row[PAIR_LAW], row[PAIR_FORCE_LAW], row[PAIR_EVENTS] > 0
    given, values = values_at(meshes.pair_values[pair], 0).words, contacts.values[c].words
    for k in range(values.shape[0]):
        values[k] = given[k]
    contacts.values[c].stiffness *= contacts.state[c].share
    contacts.values[c].damping *= contacts.state[c].share
    for side in range(2):
        end, sides = contacts.attachments[2 * c + side], meshes.sides[pair]
        end[DOF] = sides[3 * side + SIDE_DOF]
        end[WIDTH] = sides[3 * side + SIDE_WIDTH]
        end[HOLDER] = sides[3 * side + SIDE_HOLDER]


@kernel(internal=True)
def _release(contacts: ContactRows, c: int) -> None:
    """A place that no contact has: nothing hangs on it."""
    for side in range(2):
        end = contacts.attachments[2 * c + side]
        end[DOF], end[WIDTH], end[HOLDER] = -1, 0, PRESCRIBED
    lanes = len(contacts.shape[1])
    for k in range(ROW_COLUMNS * lanes):
        contacts.rows[c * ROW_COLUMNS * lanes + k] = 0.0
    state = contacts.state[c].words
    for k in range(state.shape[0]):
        state[k] = 0.0


@implement(restore_contacts, SurfacePairs)
@kernel(internal=True)
def restore_mesh_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """From the carried state, whoever has changed it."""
    first = contacts.counts.of_contours
    before = contact_count(contacts)
    count = first + int(contacts.placed[header_row(contacts), COUNT_AT])
    contacts.counts.total = count
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
    contacts.state[c].pair = pair
    contacts.state[c].touch_damping = -1.0
    _assign(meshes, contacts, c)
    _set_count(contacts, c + 1)
    take_slots(meshes.facets, meshes, contacts, c)
    return c if contacts.state[c].slots[0] >= 0 else -1


@implement(keep_found, SurfacePairs)
@kernel(internal=True)
def keep_found_contacts(meshes: SurfacePairs, contacts: ContactRows, before: bool) -> None:
    """What was found in the step stands behind the contacts that were there before it."""
    first = contacts.counts.of_contours
    if before:
        for c in range(first, contact_count(contacts)):
            _copy(contacts.state[c], meshes.kept[c])
        return
    carried = first + int(contacts.placed[header_row(contacts), COUNT_AT])
    for c in range(carried, contact_count(contacts)):
        _copy(meshes.kept[c], contacts.state[c])
        contacts.state[c].gap, contacts.state[c].rate = (
            contacts.state[c].start_gap,
            contacts.state[c].start_rate,
        )
        contacts.state[c].loss = contacts.state[c].share = 0.0
    _set_count(contacts, contact_count(contacts))


@implement(drop_contacts, SurfacePairs)
@kernel(internal=True)
def drop_mesh_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Open contacts whose features are far from each other, or beside each other, go; the last one takes the place."""
    c = contacts.counts.of_contours
    while c < contact_count(contacts):
        state = contacts.state[c]
        state.hit = 0
        reach = FAR * meshes.pair_values[state.pair, PAIR_REACH]
        if state.closed or state.end_gap <= reach:
            c += 1
            continue
        sums = contacts.placed[surface_count(contacts, meshes) + state.pair]
        sums[GONE_IMPULSE] += state.impulse
        sums[GONE_LOSS] += state.loss
        sums[GONE_IMPACTS] += state.impacts
        sums[GONE_PATH] += state.slip_path
        last = contact_count(contacts) - 1
        if c != last:
            _move(contacts, last, c)
            _assign(meshes, contacts, c)
        _release(contacts, last)
        _set_count(contacts, last)


@kernel(internal=True)
def _move(contacts: ContactRows, source: int, target: int) -> None:
    """All numbers of a contact to another place."""
    _copy(contacts.state[source], contacts.state[target])
    lanes = len(contacts.shape[1])
    width = ROW_COLUMNS * lanes
    for k in range(width):
        contacts.rows[target * width + k] = contacts.rows[source * width + k]
    half = contacts.panels.shape[0] // 2
    for side in range(2):
        old = contacts.attachments[2 * source + side, PANEL]
        new = contacts.attachments[2 * target + side, PANEL]
        for k in range(contacts.attachments[2 * source + side, WIDTH] * lanes):
            contacts.panels[new + k] = contacts.panels[old + k]
            contacts.panels[half + new + k] = contacts.panels[half + old + k]


@implement(place_surfaces, SurfacePairs)
@kernel(internal=True)
def place_mesh_surfaces(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """The search of the next step begins where this one has ended, and so do its contacts."""
    first = contacts.poses.shape[0] - surface_count(contacts, meshes)
    for i in range(surface_count(contacts, meshes)):
        put_placed(contacts, i, first + i)
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        contacts.state[c].start_beside = contacts.state[c].beside
        contacts.state[c].start_rate = contacts.state[c].rate
