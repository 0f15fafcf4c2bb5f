"""Contacts between triangles at the end of a step: found anew, followed, handed over, chosen.

The search begins at the poses of the last end and goes to those of this one. What it finds is looked up among the
contacts that are there; what is new becomes one if its patch needs it. A contact that slides over the border of its
face continues with the face that was found beyond it.
"""

from __future__ import annotations

import math

from heavylift.contours.triangles.feature_gap import EDGE_EDGE, FACE_VERTEX, VERTEX_FACE, copy_pose
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.vectors import add_scaled, dot, subtract
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.kind import COMPLIANT, RIGID, ContactRows
from heavylift.solver.contact.solve.asleep import both_rest, rests
from heavylift.solver.contact.solve.delassus import contact_rates
from heavylift.solver.contact.triangles.facets import refit_facets
from heavylift.solver.contact.triangles.feature_search import find_features, way_of
from heavylift.solver.contact.triangles.interface import search_surfaces
from heavylift.solver.contact.triangles.kind import SurfacePairs, placed_pose
from heavylift.solver.contact.triangles.load_transfer import book_jump, goes_on, pass_on, turn_memory
from heavylift.solver.contact.triangles.material import settle_by_material
from heavylift.solver.contact.triangles.modal_facets import follow_modes, place_near
from heavylift.solver.contact.triangles.narrow_phase import narrow_phase_mesh, relative_pose
from heavylift.solver.contact.triangles.patches import (
    choose_contacts,
    patch_count,
    share_stiffness,
    sort_found,
)
from heavylift.solver.contact.triangles.sides import (
    ABOUT_NOTHING,
    deepest_of,
    evaluate,
    gap_at_start,
    holds,
    settle_sides,
)
from heavylift.solver.contact.triangles.slots import (
    add_contact,
    count_members,
    enter,
    fill_table,
    look_up,
    put_placed,
    surface_count,
)
from heavylift.solver.contact.triangles.standing import contacts_mark, count_still, note_standing, stands
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []

AHEAD = 4.0
"""Motions of a step within which the next one needs a contact."""

ALONE = 1.0 / 3.0
"""Of the ways of both surfaces in a step: what they go relative to each other at least in the next one, as what makes
them move together may stop one of them. With three of these ways one meets the other where it stands."""

NEAR_ENOUGH = 1e-7
"""Of the size of the smaller surface: what is nearer counts as near, however slow it is."""

DEEPER = 4.0
"""Depths of the contacts that are there, to which is looked for what one slides on to, and for what is deeper."""

FAR_AWAY = 1e3
"""Sizes and reaches from which a contact goes."""

AT_START = 1e-4
"""Of the size: what is less deep inside at the start is pushed out."""

GRAZED = 1e-9
"""Of the size: what passes by less deep inside has not touched."""

TOO_MANY_CONTACTS = int(Outcome.TOO_MANY_CONTACTS)


@implement(search_surfaces, SurfacePairs)
@kernel(internal=True)
def search_mesh_surfaces(
    meshes: SurfacePairs, contacts: ContactRows, bodies: Bodies, work: Workspace, step: float, first: bool
) -> None:
    """All pairs, from the poses that are carried to those of the stage; at the start what is a little inside too."""
    first_row = contacts.poses.shape[0] - surface_count(contacts, meshes)
    if first:
        for i in range(surface_count(contacts, meshes)):
            put_placed(contacts, i, first_row + i)
            contacts.poses[first_row + i].step_shift = 0.0
    refit_facets(contacts, meshes.surfaces)
    follow_modes(meshes, contacts, first)
    fill_table(meshes, contacts)
    count_members(meshes, contacts)
    for pair in range(meshes.pairs.shape[0]):
        asleep = _rests(meshes, contacts, pair)
        if asleep and meshes.pairs[pair].followed and not meshes.pairs[pair].measured:
            continue
        a, b = meshes.pairs[pair].poses[0], meshes.pairs[pair].poses[1]
        motion = meshes.motions[pair]
        first_placed, second_placed = contacts.placed[a - first_row], contacts.placed[b - first_row]
        relative_pose(placed_pose(first_placed, 0), placed_pose(second_placed, 0), motion.start)
        relative_pose(contacts.poses[a], contacts.poses[b], motion.end)
        copy_pose(motion.end, meshes.relative[pair])
        if meshes.pairs[pair].deforms:  # its points are those of the end, so paths give no information
            copy_pose(motion.end, motion.start)
        if asleep:
            if not meshes.pairs[pair].followed:
                meshes.pairs[pair].reach = NEAR_ENOUGH * meshes.pair_values[pair].length_scale
                _follow_contacts(meshes, contacts, bodies, pair, False, 0.0, work)
                meshes.pairs[pair].followed = True
            continue
        meshes.pairs[pair].followed = False
        moved = contacts.poses[a].step_shift + contacts.poses[b].step_shift
        _search_pair(meshes, contacts, bodies, pair, moved, step, first, work)
    _finish_contacts(meshes, contacts)
    for pair in range(meshes.pairs.shape[0]):
        if meshes.pairs[pair].law == COMPLIANT and meshes.pairs[pair].members > 0:
            share_stiffness(meshes, contacts, pair, meshes.pairs[pair].patches, meshes.pairs[pair].reach)
    if first:
        _begin_contacts(meshes, contacts, work, step)


@kernel(inline=True, internal=True)
def _rests(meshes: SurfacePairs, contacts: ContactRows, pair: int) -> bool:
    """Whether both surfaces of a pair are asleep, or one of them and the other never moves."""
    return both_rest(contacts, meshes.pairs[pair].sleepers[0], meshes.pairs[pair].sleepers[1])


@kernel(internal=True)
def _begin_contacts(meshes: SurfacePairs, contacts: ContactRows, work: Workspace, step: float) -> None:
    """State of what is near at the start."""
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        state = contacts.state[c]
        state.gap = state.end_gap
        state.rate = contact_rates(contacts, c, work.velocity)[0]
        state.start_beside, state.start_rate = state.beside, state.rate
        size = meshes.pair_values[state.pair].length_scale
        state.shift = step * abs(state.rate) + AT_START * size


@kernel(internal=True)
def _search_pair(
    meshes: SurfacePairs,
    contacts: ContactRows,
    bodies: Bodies,
    pair: int,
    moved: float,
    step: float,
    first: bool,
    work: Workspace,
) -> None:
    """Search, look up, hand over, add."""
    size = meshes.pair_values[pair].length_scale
    early = meshes.pairs[pair].law != RIGID or not meshes.pairs[pair].events
    early = early or meshes.pairs[pair].deforms
    way, unsplit = moved, meshes.pairs[pair].law == RIGID and not meshes.pairs[pair].events
    if unsplit and moved > 0.0 and not meshes.pairs[pair].deforms:
        way_of(meshes.searches, pair, meshes.motions[pair])
        way = min(moved, max(meshes.counts.way, ALONE * moved))
    reach = (AT_START if first else NEAR_ENOUGH) * size + (AHEAD * way if early else 0.0)
    meshes.pairs[pair].reach = reach
    depth = DEEPER * deepest_of(meshes, contacts, pair)
    standing = meshes.pairs[pair].keeps and not first
    mark = contacts_mark(meshes, contacts, pair) if standing else 0
    if standing and stands(meshes, contacts, pair, reach + depth, mark):
        _follow_contacts(meshes, contacts, bodies, pair, unsplit, way, work)
        if contacts_mark(meshes, contacts, pair) == mark:
            meshes.pairs[pair].patches = patch_count(meshes, contacts, pair)
            count_still(contacts, pair)
            return
    method = meshes.pairs[pair].method
    place_near(meshes, contacts, pair, meshes.motions[pair], reach + depth)
    find_features(meshes.searches, pair, meshes.motions[pair], reach, depth, method)
    count = meshes.counts.count
    if count < 0:
        _stop(contacts, pair, work)
        return
    lost = _follow_contacts(meshes, contacts, bodies, pair, unsplit, way, work)
    lost -= _stay_on(meshes, contacts, pair, count)
    sort_found(meshes, count)
    settle_sides(meshes, contacts, pair, count, first)
    settle_by_material(meshes, contacts, pair, count)
    patches = choose_contacts(meshes, contacts, pair, count, 0.5 * reach if unsplit else -math.inf)
    for i in range(count):
        found = meshes.found.contacts[i]
        kind, feature, other = found.kind, found.first, found.second
        c = look_up(meshes, contacts, pair, kind, feature, other)
        if c >= 0:
            # it knows its side, which the sign of a distance near zero does not tell
            contacts.state[c].hit = found.hit
            contacts.state[c].passed = _passing_time(meshes, pair, i)[0]
            continue
        if meshes.keeps[i] < 0 and _passing_time(meshes, pair, i)[0] > 0.0:
            meshes.keeps[i] = 0
        if meshes.keeps[i] < 0 or (lost > 0 and _hand_over(meshes, contacts, bodies, pair, i, moved, work)):
            continue
        if not _add(meshes, contacts, bodies, pair, i, way, step, work):
            _stop(contacts, pair, work)
            return
    meshes.pairs[pair].patches = patches
    if standing:
        note_standing(meshes, contacts, pair, reach + depth, mark, contacts_mark(meshes, contacts, pair))


@kernel(internal=True)
def _passing_time(meshes: SurfacePairs, pair: int, i: int) -> tuple[float, float]:
    """`passed` of what was found, and the way by which its gap begins to change in the step [m].

    Gaps of faces and crossing edges have a side. Those of round edges and corners have none: what has gone through them
    is apart again.
    """
    found, touch = meshes.found.contacts[i], meshes.touch
    if found.hit <= 0 or found.kind in (VERTEX_FACE, FACE_VERTEX, EDGE_EDGE) or found.gap <= 0.0:
        return 0.0, 0.0
    evaluate(meshes, pair, i, meshes.relative[pair], found.side)
    end = subtract(touch.point_b, touch.point_a)
    evaluate(meshes, pair, i, meshes.motions[pair].start, found.side)
    moved = subtract(end, subtract(touch.point_b, touch.point_a))
    approach, square = dot(touch.normal, moved), dot(moved, moved)
    if approach >= 0.0:
        return 0.0, 0.0
    t = 1.0 - dot(end, moved) / square
    if not 0.0 < t < 1.0:
        return 0.0, 0.0
    nearest = add_scaled(end, t - 1.0, moved)
    inside = meshes.pairs[pair].radii - math.sqrt(dot(nearest, nearest))
    return (t, approach) if inside > GRAZED * meshes.pair_values[pair].length_scale else (0.0, 0.0)


@kernel(internal=True)
def _stop(contacts: ContactRows, pair: int, work: Workspace) -> None:
    """More contacts than there are places for."""
    work.status.outcome = TOO_MANY_CONTACTS
    work.status.block = contacts.counts.first_block + contacts.counts.of_contours + pair


@kernel(internal=True)
def _follow_contacts(
    meshes: SurfacePairs,
    contacts: ContactRows,
    bodies: Bodies,
    pair: int,
    unsplit: bool,
    way: float,
    work: Workspace,
) -> int:
    """Gaps and rows of the contacts of a pair; how many of the closed ones have left their face or edges."""
    lost, c = 0, meshes.pairs[pair].first_member
    while c >= 0:
        state = contacts.state[c]
        narrow_phase_mesh(meshes, contacts, bodies, c, work)
        state.hit, state.passed = 0, 0.0
        if unsplit:
            state.shift = way
        if holds(contacts, c) and state.beside > meshes.pairs[pair].border:
            lost += 1
        c = meshes.next_member[c]
    return lost


@kernel(internal=True)
def _stay_on(meshes: SurfacePairs, contacts: ContactRows, pair: int, count: int) -> int:
    """Contacts beside their features that the search still finds there are on them; how many of those that hold.

    What a search counts as inside grows with the face. On the seam of two faces in one plane it finds one contact, and
    a contact that had left one face would go without the other one taking over.
    """
    staying, border = 0, meshes.pairs[pair].border
    for i in range(count):
        found = meshes.found.contacts[i]
        c = look_up(meshes, contacts, pair, found.kind, found.first, found.second)
        if c >= 0 and found.hit >= 0 and contacts.state[c].beside > border:
            contacts.state[c].beside = border
            if holds(contacts, c):
                staying += 1
    return staying


@kernel(internal=True)
def _hand_over(
    meshes: SurfacePairs,
    contacts: ContactRows,
    bodies: Bodies,
    pair: int,
    i: int,
    moved: float,
    work: Workspace,
) -> bool:
    """A contact that holds and has left its face or edge continues with what was found there, its memory kept."""
    c, side = goes_on(meshes, contacts, pair, i, moved)
    if c < 0:
        return False
    state = contacts.state[c]
    state.feature, state.other_feature = meshes.found.contacts[i].first, meshes.found.contacts[i].second
    state.side, state.patch = side, meshes.keeps[i]
    gap, t1, t2, t3 = state.end_gap, state.tangent[0], state.tangent[1], state.tangent[2]
    narrow_phase_mesh(meshes, contacts, bodies, c, work)
    turn_memory(contacts, c, t1, t2, t3)
    book_jump(contacts, c, gap)
    return True


@kernel(internal=True)
def _add(
    meshes: SurfacePairs,
    contacts: ContactRows,
    bodies: Bodies,
    pair: int,
    i: int,
    moved: float,
    step: float,
    work: Workspace,
) -> bool:
    """A new contact; false if there is no place for it."""
    found, side = meshes.found.contacts[i], meshes.found.contacts[i].side
    start = gap_at_start(meshes, pair, i)
    beside = meshes.touch.beyond
    if meshes.pairs[pair].members >= meshes.pairs[pair].most:
        return False
    c = add_contact(meshes, contacts, pair)
    if c < 0:
        return False
    state = contacts.state[c]
    state.feature_kind, state.feature, state.other_feature = (found.kind, found.first, found.second)
    state.side, state.start_gap, state.gap = side, start, start
    state.shift = moved  # or it would take part one step late
    state.hit, state.patch = found.hit, meshes.keeps[i]
    state.window = contacts.control.nominal_step  # it has borne nothing
    narrow_phase_mesh(meshes, contacts, bodies, c, work)
    # the rate at the start of the step, of a gap that is a parabola
    rate = contact_rates(contacts, c, work.velocity)[0]
    if meshes.pairs[pair].deforms:
        state.start_gap = state.gap = state.end_gap - step * rate
        state.rate = state.start_rate = rate
    else:
        state.rate = state.start_rate = 2.0 * (state.end_gap - start) / step - rate
    passed, approach = _passing_time(meshes, pair, i)
    if passed > 0.0:
        state.passed, state.rate, state.start_rate = passed, approach / step, approach / step
    state.start_beside = beside
    enter(meshes, contacts, c)
    return True


@kernel(internal=True)
def _finish_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """What lies beside its face or edges and has not come through them does not touch."""
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        if rests(contacts, c):
            continue
        state = contacts.state[c]
        size = meshes.pair_values[state.pair].length_scale
        nothing = ABOUT_NOTHING * size
        beside = state.beside > meshes.pairs[state.pair].border
        # from one side to the other in a step without a hit: round the border
        gone_round = state.gap > nothing and state.end_gap < -nothing and not holds(contacts, c)
        gone_round = gone_round and not meshes.pairs[state.pair].deforms
        if (beside or gone_round) and state.hit == 0:
            gap = state.end_gap
            if not holds(contacts, c):  # goes; if it comes back, it is found with the side it comes from
                state.patch = -1
                state.end_gap = FAR_AWAY * (size + meshes.pairs[state.pair].reach)
            elif state.has_left:  # no new contact beyond the border took it over for a whole step
                if state.closed:
                    pass_on(meshes, contacts, c)
                state.end_gap = max(state.end_gap, size)
            book_jump(contacts, c, gap)  # what it has stored is lost
        state.has_left = beside
        state.sleep = state.end_gap
