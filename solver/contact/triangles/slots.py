"""Contacts between triangles come and go: what is carried of them, what follows from that, and how they are looked up.

What a contact is (the pair, the two features, the side) stands in its carried state, so a step that is taken back takes
new contacts with it, and a checkpoint holds all of them. Laws and sides of its rows follow from its pair. By their
features they are found in a table of chains, which is made anew for every search.
"""

from __future__ import annotations

from heavylift.contours.triangles.feature_gap import copy_pose
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Records, clear_record, copy_record
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.kind import RIGID, TRIANGLES, ContactRows, ContactState
from heavylift.solver.contact.triangles.facets import take_slots
from heavylift.solver.contact.triangles.interface import keep_found, place_surfaces
from heavylift.solver.contact.triangles.kind import SurfacePairs, contact_header, gone_contacts, placed_pose
from heavylift.solver.kinds import implement
from heavylift.solver.rows.structure import PRESCRIBED

__all__ = [
    "add_contact",
    "count_members",
    "enter",
    "fill_table",
    "header_row",
    "hold_contacts",
    "look_up",
    "put_placed",
    "restore_contacts",
    "surface_count",
]

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
    copy_pose(contacts.poses[pose_row], placed_pose(contacts.placed[surface], 0))


@kernel(internal=True)
def _set_count(contacts: ContactRows, count: int) -> None:
    """Of all contacts, those of contours included."""
    contacts.counts.total = count
    contact_header(contacts.placed[header_row(contacts)], 0).count = count - contacts.counts.of_contours


@kernel(internal=True)
def _assign(meshes: SurfacePairs, contacts: ContactRows, c: int) -> None:
    """Laws, values and sides of a contact from its pair."""
    pair = contacts.state[c].pair
    row, table = meshes.pairs[pair], contacts.table[c]
    table.contour, table.axes, table.shape_kind = row.poses[0], row.poses[1], TRIANGLES
    table.law, table.force_law, table.events = row.law, row.force_law, row.events
    table.sleepers[0], table.sleepers[1] = row.sleepers[0], row.sleepers[1]
    copy_record(contacts.values[c], meshes.pair_values[pair])
    contacts.values[c].stiffness *= contacts.state[c].share
    contacts.values[c].damping *= contacts.state[c].share
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
    clear_record(contacts.state[c])


@entry
def restore_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Number, sides and laws of the contacts from what is carried of them, after that has been changed."""
    for pair in range(meshes.pairs.shape[0]):
        meshes.pairs[pair].followed = False
    first = contacts.counts.of_contours
    before = contact_count(contacts)
    count = first + contact_header(contacts.placed[header_row(contacts)], 0).count
    contacts.counts.total = count
    for c in range(first, count):
        _assign(meshes, contacts, c)
    for c in range(count, before):
        _release(contacts, c)


@kernel(internal=True)
def count_members(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Contacts of each pair, in the order of their numbers: `SurfacePair.first_member` and what follows it."""
    for pair in range(meshes.pairs.shape[0]):
        one = meshes.pairs[pair]
        one.members, one.first_member, one.last_member = 0, -1, -1
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        _join(meshes, contacts.state[c].pair, c)


@kernel(inline=True, internal=True)
def _join(meshes: SurfacePairs, pair: int, c: int) -> None:
    """A contact becomes the last one of its pair."""
    one = meshes.pairs[pair]
    if one.members == 0:
        one.first_member = c
    else:
        meshes.next_member[one.last_member] = c
    meshes.next_member[c] = -1
    one.last_member = c
    one.members += 1


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
    _join(meshes, pair, c)
    take_slots(meshes, contacts, c)
    return c if contacts.state[c].slots[0] >= 0 else -1


@entry
def hold_contacts(
    meshes: SurfacePairs, contacts: ContactRows, held: Records[ContactState], count: int
) -> None:
    """Contacts with the features and sides of others, where there are none."""
    fill_table(meshes, contacts)
    count_members(meshes, contacts)
    for i in range(count):
        one = held[i]
        if look_up(meshes, contacts, one.pair, one.feature_kind, one.feature, one.other_feature) >= 0:
            continue
        c = add_contact(meshes, contacts, one.pair)
        if c < 0:
            return
        state = contacts.state[c]
        state.feature_kind, state.feature, state.other_feature = (
            one.feature_kind,
            one.feature,
            one.other_feature,
        )
        state.side, state.patch = one.side, one.patch
        enter(meshes, contacts, c)


@implement(keep_found, SurfacePairs)
@kernel(internal=True)
def keep_found_contacts(meshes: SurfacePairs, contacts: ContactRows, before: bool) -> None:
    """What was found in the step stands behind the contacts that were there before it."""
    first = contacts.counts.of_contours
    if before:
        for c in range(first, contact_count(contacts)):
            copy_record(meshes.kept[c], contacts.state[c])
        return
    carried = first + contact_header(contacts.placed[header_row(contacts)], 0).count
    for c in range(first, carried):
        if contacts.table[c].law == RIGID and not contacts.table[c].events:  # has a row now if it has come in
            contacts.state[c].sleep = min(contacts.state[c].sleep, meshes.kept[c].end_gap)
            contacts.state[c].hit = meshes.kept[c].hit
    for c in range(carried, contact_count(contacts)):
        state = contacts.state[c]
        copy_record(state, meshes.kept[c])
        state.gap, state.rate = state.start_gap, state.start_rate
        state.loss = state.step_loss = state.jump = state.kept = state.share = 0.0
    _set_count(contacts, contact_count(contacts))
    restore_contacts(meshes, contacts)


@kernel(internal=True)
def _drop_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Open contacts whose features are far from each other, or beside each other, go; the last one takes the place."""
    c = contacts.counts.of_contours
    while c < contact_count(contacts):
        state = contacts.state[c]
        state.hit = 0
        reach = FAR * meshes.pairs[state.pair].reach
        # what has borne in this step is recorded with it
        if state.closed or state.end_gap <= reach or state.normal_force > 0.0:
            c += 1
            continue
        gone = gone_contacts(contacts.placed[surface_count(contacts, meshes) + state.pair], 0)
        gone.impulse += state.impulse
        gone.impact_impulse += state.impact_impulse
        gone.loss += state.loss + max(state.step_loss, 0.0)
        gone.impacts += state.impacts
        gone.slip_path += state.slip_path
        last = contact_count(contacts) - 1
        if c != last:
            _move(contacts, last, c)
        _release(contacts, last)
        _set_count(contacts, last)


@kernel(internal=True)
def _move(contacts: ContactRows, source: int, target: int) -> None:
    """All numbers of a contact to another place."""
    copy_record(contacts.state[target], contacts.state[source])
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
    """The search of the next step begins where this one has ended, and so do its contacts, with their new shares."""
    first = contacts.poses.shape[0] - surface_count(contacts, meshes)
    for i in range(surface_count(contacts, meshes)):
        put_placed(contacts, i, first + i)
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        contacts.state[c].start_beside = contacts.state[c].beside
        contacts.state[c].start_rate = contacts.state[c].rate
    _drop_contacts(meshes, contacts)
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        _assign(meshes, contacts, c)


@kernel(inline=True, internal=True)
def _slot(meshes: SurfacePairs, pair: int, kind: int, feature: int, other: int) -> int:
    """Place of the first contact with such features (Teschner et al., 2003)."""
    mixed = (feature * 73856093) ^ (other * 19349663) ^ (kind * 83492791) ^ (pair * 26544357)
    return mixed & (meshes.slots.shape[0] - 1)


@kernel(internal=True)
def fill_table(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """All contacts that are there."""
    for i in range(meshes.entered[0]):
        meshes.slots[meshes.entered[1 + i]] = -1
    meshes.entered[0] = 0
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        enter(meshes, contacts, c)


@kernel(internal=True)
def enter(meshes: SurfacePairs, contacts: ContactRows, c: int) -> None:
    """One contact."""
    state = contacts.state[c]
    at = _slot(meshes, state.pair, state.feature_kind, state.feature, state.other_feature)
    meshes.chains[c] = meshes.slots[at]
    meshes.slots[at] = c
    meshes.entered[0] += 1
    meshes.entered[meshes.entered[0]] = at


@kernel(internal=True)
def look_up(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, kind: int, feature: int, other: int
) -> int:
    """The contact with these features, -1 if there is none."""
    c = int(meshes.slots[_slot(meshes, pair, kind, feature, other)])
    while c >= 0:
        state = contacts.state[c]
        same = state.feature_kind == kind and state.feature == feature and state.other_feature == other
        if same and state.pair == pair:
            return c
        c = int(meshes.chains[c])
    return c
