"""What finds the features of two surfaces of triangles that meet in a step, compiled by itself."""

from __future__ import annotations

from heavylift.contours.triangles.feature_pairs import find_contacts
from heavylift.contours.triangles.feature_report import ContactList
from heavylift.contours.triangles.pair_list import PairLists
from heavylift.contours.triangles.pair_search import longest_way
from heavylift.contours.triangles.surface_layout import RelativeMotion
from heavylift.contours.triangles.surface_pack import CollisionSurfaces
from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record
from heavylift.solver.kinds import Table, generic, implement

__all__ = ["FeatureSearch", "FeatureSearches", "FoundCount", "find_features", "way_of"]


class FoundCount(Record):
    """How many features a search has found; below 0 if there was no room for them. Longest way in a motion [m]."""

    count: int
    way: float


class FeatureSearches(Table):
    """What finds the features of a scene that meet: one kind."""


class FeatureSearch(Arrays):
    """Swept tests of what is near.

    Attributes
    ----------
    surfaces, lists
        Packed triangles with their trees, and lists of triangles that are near each other.
    found, counts
        What the last search has found, and how many.
    """

    surfaces: CollisionSurfaces
    lists: PairLists
    found: ContactList
    counts: FoundCount


@generic("search")
def find_features(
    searches: FeatureSearches, pair: int, motion: RelativeMotion, reach: float, depth: float, method: int
) -> None:
    """Features of a pair that meet in a motion or are within reach [m] at its end, or pressed in by a depth [m]."""


@generic("search")
def way_of(searches: FeatureSearches, pair: int, motion: RelativeMotion) -> None:
    """How far points of the surfaces of a pair go relative to each other in a motion, into `FoundCount.way`."""


@implement(way_of, FeatureSearch)
@kernel(internal=True)
def way_of_points(search: FeatureSearch, pair: int, motion: RelativeMotion) -> None:
    """By `longest_way`."""
    search.counts.way = longest_way(search.surfaces, search.lists, pair, motion)


@implement(find_features, FeatureSearch)
@kernel(internal=True)
def find_swept_features(
    search: FeatureSearch, pair: int, motion: RelativeMotion, reach: float, depth: float, method: int
) -> None:
    """By `find_contacts`."""
    search.counts.count = find_contacts(
        search.surfaces, search.lists, pair, motion, reach, depth, method, search.found
    )
