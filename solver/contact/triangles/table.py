"""Contacts between triangles are looked up by their features: a table of chains, made anew for every search."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.kind import SurfacePairs

__all__ = ["enter", "fill_table", "look_up"]


@kernel(inline=True, internal=True)
def _slot(meshes: SurfacePairs, pair: int, kind: int, feature: int, other: int) -> int:
    """Place of the first contact with such features (Teschner et al., 2003)."""
    mixed = (feature * 73856093) ^ (other * 19349663) ^ (kind * 83492791) ^ (pair * 26544357)
    return mixed & (meshes.slots.shape[0] - 1)


@kernel(internal=True)
def fill_table(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """All contacts that are there."""
    for i in range(meshes.slots.shape[0]):
        meshes.slots[i] = -1
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        enter(meshes, contacts, c)


@kernel(internal=True)
def enter(meshes: SurfacePairs, contacts: ContactRows, c: int) -> None:
    """One contact."""
    state = contacts.state[c]
    at = _slot(meshes, state.pair, state.feature_kind, state.feature, state.other_feature)
    meshes.chains[c] = meshes.slots[at]
    meshes.slots[at] = c


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
