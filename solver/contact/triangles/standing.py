"""Pairs of surfaces that stand still: what a search of theirs has found is what another one would find.

A search is a function of the motion of its pair, of how far it reaches, and of the contacts that are there. A pair
stands while both ends of a step are within `STILL` of where a whole search has found it standing, and while reach and
contacts are those of that search: it made none of them and changed none, so no other one would. Then only gaps and rows
follow the poses. The pose of the whole search stays the measure, so what creeps is searched when it has crept so far.
Features that come near within that way are met late by it, which is below what gaps are found to.

Nothing stands whose points move of themselves, that has slid off a face, or whose contacts come and go.
"""

from __future__ import annotations

from heavylift.contours.triangles.feature_gap import copy_pose
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.kind import SurfacePairs
from heavylift.solver.contact.triangles.sides import holds
from heavylift.solver.contact.triangles.still import STILL, is_at

__all__ = ["STILL", "contacts_mark", "count_still", "note_standing", "stands"]


@kernel(internal=True)
def contacts_mark(meshes: SurfacePairs, contacts: ContactRows, pair: int) -> int:
    """A number that tells the contacts of a pair, in their order, from others; never 0.

    What a search reads of a contact is in it: features, side and patch, and whether it holds. Those that lie beside
    their features have none, 0: what they become is decided anew in each step.
    """
    mark, border = 1, meshes.pairs[pair].border
    c = meshes.pairs[pair].first_member
    while c >= 0:
        state = contacts.state[c]
        if state.beside > border or state.has_left or state.passed != 0.0:
            return 0
        one = (
            (state.feature + 1) * 73856093
            + (state.other_feature + 1) * 19349663
            + state.feature_kind * 83492791
        )
        one += (state.patch + 2) * 32452843
        if state.side > 0.0:
            one += 15485863
        if holds(contacts, c):
            one += 49979687
        # modulo a prime below 2^31, so that no product is longer than a word
        mark = (mark * 1000003 + one % 2147483647) % 2147483647
        c = meshes.next_member[c]
    return mark + 1


@kernel(internal=True)
def stands(meshes: SurfacePairs, contacts: ContactRows, pair: int, far: float, mark: int) -> bool:
    """Whether a pair stands where a whole search has found it standing, with these contacts.

    Parameters
    ----------
    meshes, contacts, pair
        The pair, its motion in `meshes.motions`.
    far
        How far its search would reach [m].
    mark
        From `contacts_mark`.
    """
    stood, size, motion = contacts.stood[pair], meshes.pair_values[pair].length_scale, meshes.motions[pair]
    if mark == 0 or stood.mark != mark or not abs(far - stood.far) <= STILL * size:
        return False
    return is_at(motion.start, stood.pose, size) and is_at(motion.end, stood.pose, size)


@kernel(internal=True)
def note_standing(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, far: float, before: int, after: int
) -> None:
    """After a whole search: where the pair stands, if it does and the search has changed none of its contacts.

    Parameters
    ----------
    meshes, contacts, pair, far
        As of `stands`.
    before, after
        `contacts_mark` before and after the search.
    """
    stood, size, motion = contacts.stood[pair], meshes.pair_values[pair].length_scale, meshes.motions[pair]
    stood.mark, stood.still = 0, 0
    if before == 0 or before != after or not is_at(motion.start, motion.end, size):
        return
    stood.mark, stood.far = after, far
    copy_pose(motion.end, stood.pose)


@kernel(inline=True, internal=True)
def count_still(contacts: ContactRows, pair: int) -> None:
    """One more step in which the pair has stood."""
    contacts.stood[pair].still += 1
