"""Entry points from Python to the narrow phase of collision, and small surfaces for its tests."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.contours.triangles.feature_gap import FeatureTouch, contact_gap, feature_gap
from heavylift.contours.triangles.feature_pairs import SWEPT, contacts_of_pairs, find_contacts
from heavylift.contours.triangles.feature_report import ContactList, make_contact_list
from heavylift.contours.triangles.pair_list import PairLists, make_pair_lists
from heavylift.contours.triangles.pair_search import refresh_pairs
from heavylift.contours.triangles.surface_layout import RelativeMotion, RelativePose
from heavylift.contours.triangles.surface_pack import CollisionSurfaces, pack_surfaces
from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import record_at, records
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


motion_at = record_at(RelativeMotion)
pose_at = record_at(RelativePose)


@entry
def gap_kernel(
    surfaces: CollisionSurfaces,
    kind: int,
    feature_a: int,
    feature_b: int,
    radius: float,
    side: float,
    pose: Floats1,
    at: int,
    out: FeatureTouch,
) -> float:
    return feature_gap(surfaces, kind, feature_a, feature_b, radius, side, pose_at(pose, at), out)


@kernel
def gaps_kernel(surfaces, contacts, radius, pose, repeats, out):
    """Gaps of all contacts, many times: for clocks."""
    total = 0.0
    for _ in range(repeats):
        for k in range(contacts.shape[0]):
            found = contacts[k]
            total += contact_gap(
                surfaces, found.kind, found.first, found.second, radius, found.side, pose_at(pose, 0), out
            )
    return total


@entry
def contacts_kernel(
    surfaces: CollisionSurfaces,
    lists: PairLists,
    pair: int,
    motion: Floats1,
    reach: float,
    method: int,
    judged: bool,
    out: ContactList,
) -> int:
    """Contacts; not judged, all that the swept tests report."""
    if judged:
        return find_contacts(surfaces, lists, pair, motion_at(motion, 0), reach, 0.0, method, out)
    count = refresh_pairs(surfaces, lists, pair, motion_at(motion, 0), reach)
    if count <= 0:
        return count
    listed = lists.table[pair]
    return contacts_of_pairs(
        surfaces,
        listed.surface_a,
        listed.surface_b,
        lists.pairs[listed.first : listed.first + count],
        motion_at(motion, 0),
        reach,
        0.0,
        method,
        False,
        out,
    )


class Contacts(NamedTuple):
    """Contacts of an interval, as they are at its end."""

    kinds: NDArray[np.int64]
    features: NDArray[np.int64]  # of A and of B
    hit: NDArray[np.bool_]
    times: NDArray[np.float64]
    sides: NDArray[np.float64]
    gaps: NDArray[np.float64]
    normals: NDArray[np.float64]
    points_a: NDArray[np.float64]
    points_b: NDArray[np.float64]


def poses(R0: ArrayLike, p0: ArrayLike, R1: ArrayLike | None = None, p1: ArrayLike | None = None) -> Any:
    """Motion of B in the axes of A from two poses; without the second, rest."""
    R1 = R0 if R1 is None else R1
    p1 = p0 if p1 is None else p1
    return np.concatenate([np.ravel(R0), np.ravel(p0), np.ravel(R1), np.ravel(p1)]).astype(np.float64)


def contacts_of(
    surfaces: CollisionSurfaces, motion: NDArray[np.float64], reach: float = 0.0, method: int = SWEPT
) -> Contacts:
    """Contacts of surfaces 0 and 1."""
    out = make_contact_list(8192)
    lists = make_pair_lists(surfaces, [(0, 1)])
    count = contacts_kernel(surfaces, lists, 0, motion, reach, method, True, out)
    assert count >= 0
    found = out.contacts[:count]
    geometry = records(FeatureTouch, count)
    for k in range(count):
        gap = gap_kernel(
            surfaces,
            found[k].kind,
            found[k].first,
            found[k].second,
            surfaces.radii[:2].sum(),
            found[k].side,
            motion,
            12,
            geometry[k],
        )
        assert gap == found[k].gap or abs(gap - found[k].gap) < 1e-9
    return Contacts(
        found["kind"],
        np.column_stack([found["first"], found["second"]]),
        found["hit"] == 1,
        found["time"],
        found["side"],
        found["gap"],
        geometry["normal"],
        geometry["point_a"],
        geometry["point_b"],
    )


def hits_of(
    surfaces: CollisionSurfaces, motion: NDArray[np.float64], method: int = SWEPT
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Kinds and times of all hits of the swept tests."""
    out = make_contact_list(8192)
    lists = make_pair_lists(surfaces, [(0, 1)])
    count = contacts_kernel(surfaces, lists, 0, motion, 0.0, method, False, out)
    assert count >= 0
    return out.contacts["kind"][:count], out.contacts["time"][:count]


def box(x: float, y: float, z: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points and twelve triangles of a box around the origin."""
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return signs * np.array([x, y, z]) / 2.0, np.array(triangles)


def plate(x: float, y: float, nx: int, ny: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points and triangles of a rectangle in the plane z = 0 around the origin."""
    i, j = np.meshgrid(np.arange(nx + 1), np.arange(ny + 1), indexing="ij")
    points = np.stack([x * (i / nx - 0.5), y * (j / ny - 0.5), 0.0 * i], axis=-1).reshape(-1, 3)
    corner = (np.arange(nx)[:, None] * (ny + 1) + np.arange(ny)).ravel()
    a, b, c, d = corner, corner + ny + 1, corner + ny + 2, corner + 1
    return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def surface(
    shape: tuple[NDArray[np.float64], NDArray[np.int64]],
    rng: np.random.Generator | None = None,
    radius: float = 0.0,
) -> TriangleSurface:
    """Surface of a shape; with a generator of random numbers, some of its triangles turned over."""
    points, triangles = shape
    if rng is not None:
        turned = rng.random(len(triangles)) < 0.4
        triangles = np.where(turned[:, None], triangles[:, ::-1], triangles)
    return TriangleSurface(points, triangles, radius=radius)


def packed(a: TriangleSurface, b: TriangleSurface) -> CollisionSurfaces:
    """Surfaces 0 and 1 of a scene."""
    return pack_surfaces([a, b])
