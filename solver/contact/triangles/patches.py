"""Which of the contacts that were found take part: every patch has few, and they share its stiffness.

How many features touch is a matter of the meshes. Those that span a patch carry it; one that is deeper than they are,
as on curved surfaces, takes part too.
"""

from __future__ import annotations

import math

from heavylift.contours.triangles.feature_gap import feature_gap
from heavylift.contours.triangles.feature_report import UNKNOWN, FoundContact
from heavylift.contours.triangles.patches import EXTREMES, extreme_points, group_patches
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.laws.normal_force import stored_energy
from heavylift.solver.contact.triangles.kind import (
    SurfacePairs,
)
from heavylift.solver.contact.triangles.slots import look_up

__all__ = ["choose_contacts", "patch_count", "share_stiffness", "sort_found"]

DEEPER = 1e-9
"""Of the size: what is deeper than those that span its patch by less does not count."""

DEEPER_ON_MESHES = 1e-2
"""The same of the roundings where a surface deforms: all points of a sheet that lies on something are about as deep."""


@kernel(inline=True, internal=True)
def _comes_before(meshes: SurfacePairs, i: int, kind: int, feature: int, other: int) -> bool:
    """Whether found features stand before others in the order of their numbers."""
    found = meshes.found.contacts[i]
    if found.kind != kind:
        return bool(found.kind < kind)
    if found.first != feature:
        return bool(found.first < feature)
    return bool(found.second < other)


@kernel(inline=True, internal=True)
def _put(
    to: FoundContact, kind: int, first: int, second: int, hit: int, time: float, side: float, gap: float
) -> None:
    """Write all fields."""
    to.kind, to.first, to.second, to.hit = kind, first, second, hit
    to.time, to.side, to.gap = time, side, gap


@kernel(internal=True)
def sort_found(meshes: SurfacePairs, count: int) -> None:
    """By features (Shell's method): a search finds them in an order that depends on when its list was made."""
    found = meshes.found.contacts
    distance = 1
    while distance < count // 3:
        distance = 3 * distance + 1
    while distance > 0:
        for i in range(distance, count):
            one = found[i]
            kind, first, second, hit = one.kind, one.first, one.second, one.hit
            time, side, gap = one.time, one.side, one.gap
            k = i
            while k >= distance and not _comes_before(meshes, k - distance, kind, first, second):
                one = found[k - distance]
                _put(found[k], one.kind, one.first, one.second, one.hit, one.time, one.side, one.gap)
                k -= distance
            _put(found[k], kind, first, second, hit, time, side, gap)
        distance //= 3


@kernel(internal=True)
def _put_item(
    meshes: SurfacePairs, pair: int, n: int, kind: int, feature: int, other: int, side: float, owner: int
) -> None:
    """Place, normal and gap of a contact, or of what may become one, for the grouping."""
    touch = meshes.touch
    meshes.depths[n] = feature_gap(
        meshes.surfaces,
        kind,
        feature,
        other,
        meshes.pairs[pair].radii,
        side,
        meshes.relative[pair],
        touch,
    )
    for k in range(3):
        meshes.points[n, k] = 0.5 * (touch.point_a[k] + touch.point_b[k])
        meshes.normals[n, k] = touch.normal[k]
    meshes.owners[n] = owner


@kernel(internal=True)
def choose_contacts(meshes: SurfacePairs, contacts: ContactRows, pair: int, count: int, ahead: float) -> int:
    """Group contacts and what was found beside them into patches; returns the number of patches.

    Contacts get the number of their patch. Of what was found, those that span a patch are to become contacts, and those
    nearer than `ahead` [m] that are nearer than all that span it: steps that are not split stop them too.
    """
    n, size = 0, meshes.pair_values[pair].length_scale
    c = meshes.pairs[pair].first_member
    while c >= 0:
        state = contacts.state[c]
        if state.beside > meshes.pairs[pair].border:
            state.patch = -1  # at this place what was found beside it counts
        else:
            kind, feature, other = state.feature_kind, state.feature, state.other_feature
            _put_item(meshes, pair, n, kind, feature, other, state.side, c)
            meshes.active[n] = 1
            n += 1
        c = meshes.next_member[c]
    for i in range(count):
        found = meshes.found.contacts[i]
        kind, feature, other = found.kind, found.first, found.second
        meshes.keeps[i] = -1
        if found.hit != UNKNOWN and look_up(meshes, contacts, pair, kind, feature, other) < 0:
            _put_item(meshes, pair, n, kind, feature, other, meshes.found.contacts[i].side, i)
            meshes.active[n] = 0
            n += 1
    patches = group_patches(
        n,
        meshes.points,
        meshes.normals,
        meshes.pairs[pair].patch_cosine,
        meshes.pairs[pair].patch_size,
        meshes.grid,
        meshes.patch_of,
    )
    extreme_points(
        n,
        meshes.points,
        meshes.normals,
        meshes.patch_of,
        patches,
        meshes.active,
        meshes.grid,
        meshes.chosen,
    )
    deeper = DEEPER * size
    if meshes.pairs[pair].deforms:
        deeper = max(deeper, DEEPER_ON_MESHES * meshes.pairs[pair].radii)
    _mark_chosen(meshes, contacts, n, patches, deeper, ahead)
    return patches


@kernel(internal=True)
def _mark_chosen(
    meshes: SurfacePairs, contacts: ContactRows, n: int, patches: int, deeper: float, ahead: float
) -> None:
    """Those that span their patch, and the deepest one if it is deeper than they are."""
    for k in range(patches):
        meshes.sums[k] = math.inf
        for e in range(EXTREMES):
            i = meshes.chosen[k, e]
            if i >= 0:
                if meshes.active[i] == 0:
                    meshes.keeps[meshes.owners[i]] = k
                meshes.sums[k] = min(meshes.sums[k], meshes.depths[i])
        meshes.chosen[k, 0] = -1
    for i in range(n):
        k = meshes.patch_of[i]
        if meshes.active[i] == 0 and meshes.depths[i] < min(meshes.sums[k] - deeper, ahead):
            meshes.keeps[meshes.owners[i]] = k
    for i in range(n):
        k = meshes.patch_of[i]
        if meshes.active[i] > 0:
            contacts.state[meshes.owners[i]].patch = k
        if meshes.depths[i] < min(meshes.sums[k], 0.0) - deeper:
            meshes.sums[k] = meshes.depths[i]
            meshes.chosen[k, 0] = i
    for k in range(patches):
        i = meshes.chosen[k, 0]
        if i >= 0 and meshes.active[i] == 0:
            meshes.keeps[meshes.owners[i]] = k


@kernel(internal=True)
def patch_count(meshes: SurfacePairs, contacts: ContactRows, pair: int) -> int:
    """Patches that the contacts of a pair are in."""
    highest, c = -1, meshes.pairs[pair].first_member
    while c >= 0:
        highest = max(highest, contacts.state[c].patch)
        c = meshes.next_member[c]
    return highest + 1


@kernel(inline=True, internal=True)
def _weight(gap: float, reach: float) -> float:
    """1 of what touches, 0 of what is out of reach."""
    return min(max(1.0 - gap / reach, 0.0), 1.0)


@kernel(internal=True)
def share_stiffness(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, patches: int, reach: float
) -> None:
    """Contacts that touch share the stiffness of their patch equally; one that comes near takes its share by and by.

    So forces do not jump when it touches. What the others have stored more or less by that is booked as a jump, and so
    is what is stored by one that did not take part in the step.
    """
    for k in range(patches):
        meshes.sums[k] = 0.0
    c = meshes.pairs[pair].first_member
    while c >= 0:
        state = contacts.state[c]
        if state.patch >= 0:
            meshes.sums[state.patch] += _weight(state.end_gap, reach)
        c = meshes.next_member[c]
    stiffness, following = meshes.pair_values[pair].stiffness, meshes.pairs[pair].first_member
    while following >= 0:
        c = following
        following = meshes.next_member[c]
        state, values = contacts.state[c], contacts.values[c]
        before = values.stiffness
        if state.patch >= 0 and meshes.sums[state.patch] > 0.0:
            state.share = _weight(state.end_gap, reach) / meshes.sums[state.patch]
        values.stiffness = state.share * stiffness
        values.damping = state.share * meshes.pair_values[pair].damping
        law, exponent, depth = contacts.table[c].force_law, values.exponent, -state.end_gap
        paid = depth if state.present else -state.gap
        state.jump += stored_energy(law, before, exponent, paid)
        state.jump -= stored_energy(law, values.stiffness, exponent, depth)
