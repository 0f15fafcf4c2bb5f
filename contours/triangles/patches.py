"""Patches: contacts that lie together and push the same way share one stiffness, whatever the mesh makes of them.

How many features of two meshes touch gives no information on how stiff bodies are, so a stiffness belongs to a patch:
it is divided over its members, or given to those few that span it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.numerics.jit import in_python, kernel
from heavylift.numerics.vectors import Vector, cross, subtract

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["EXTREMES", "MEMORY", "PATCH_ANGLE", "extreme_points", "group_patches", "patch_scratch_size"]

PATCH_ANGLE = math.radians(18.0)
"""Between normals of one patch."""

EXTREMES = 4
"""Contacts that span a patch: a plane figure with more corners is hardly stiffer."""

MEMORY = 1.05
"""A contact that was kept before counts as this much further out, so that equal ones do not take turns."""

FLAT = 1e-6
"""Height over length below which a patch is a line; over the size of coordinates, below which it is a point."""


def patch_scratch_size(most: int) -> int:
    """Length of the scratch of `group_patches` and `extreme_points` for so many contacts."""
    return in_python(_slot_count)(most) + 2 * most


@kernel
def _slot_count(n: int) -> int:
    """Power of two above twice the number of contacts."""
    slots = 8
    while slots < 2 * n:
        slots *= 2
    return slots


@kernel(inline=True, internal=True)
def _slot(x: int, y: int, z: int, mask: int) -> int:
    """Place of a cell in the hash table (Teschner et al., "Optimized spatial hashing", 2003)."""
    return ((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) & mask


@kernel
def group_patches(
    n: int,
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    cosine: float,
    size: float,
    # scratch
    scratch: NDArray[np.int64],
    # out
    patch_of: NDArray[np.int64],
) -> int:
    """Group contacts by place and normal.

    Parameters
    ----------
    n
        Number of contacts.
    points, normals
        Of the contacts [m] and unit vectors, shape (>= n, 3).
    cosine
        Of the largest angle between the normals of a patch and that of its first contact.
    size
        Largest distance from the first contact of a patch [m], positive.
    scratch
        Shape (>= patch_scratch_size(n),).
    patch_of
        Written: patch of each contact, numbered in the order of their first contacts, shape (>= n,).

    Returns
    -------
    count
        Of patches.

    Notes
    -----
    A contact joins the nearest patch, by its first contact, that takes it, or begins one. First contacts of similar
    normals are more than `size` apart, so a cell of a grid of twice that size holds few of them, and a contact looks
    into eight cells: the work grows with the number of contacts only.
    """
    slots = _slot_count(n)
    mask = slots - 1
    following = slots  # next first contact in the same slot, for each patch
    leader = slots + n  # first contact of each patch
    for k in range(slots):
        scratch[k] = -1
    inverse = 0.5 / size
    surely = 0.25 * size * size  # no other first contact of this normal can be nearer
    count = 0
    for i in range(n):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        u, v, w = normals[i, 0], normals[i, 1], normals[i, 2]
        # the lowest of the two cells along each axis that are within reach
        lx = math.floor(x * inverse - 0.5)
        ly = math.floor(y * inverse - 0.5)
        lz = math.floor(z * inverse - 0.5)
        nearest = size * size
        patch = -1
        for cell in range(8):
            if nearest <= surely:
                break
            k = scratch[_slot(lx + (cell & 1), ly + ((cell >> 1) & 1), lz + (cell >> 2), mask)]
            while k >= 0:
                j = scratch[leader + k]
                dx, dy, dz = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
                square = dx * dx + dy * dy + dz * dz
                if square <= nearest and normals[j, 0] * u + normals[j, 1] * v + normals[j, 2] * w >= cosine:
                    # cells may share a slot: the same patch again is no harm
                    if patch < 0 or square < nearest or k < patch:
                        patch = k
                    nearest = square
                k = scratch[following + k]
        if patch < 0:
            patch = count
            count += 1
            own = _slot(math.floor(x * inverse), math.floor(y * inverse), math.floor(z * inverse), mask)
            scratch[leader + patch] = i
            scratch[following + patch] = scratch[own]
            scratch[own] = patch
        patch_of[i] = patch
    return count


@kernel
def extreme_points(
    n: int,
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    patch_of: NDArray[np.int64],
    count: int,
    active: NDArray[np.int64],
    # scratch
    scratch: NDArray[np.int64],
    # out
    chosen: NDArray[np.int64],
) -> None:
    """Keep at most four contacts of each patch, which span a large area in its plane.

    Parameters
    ----------
    n, points, normals, patch_of, count
        Contacts and their patches, see `group_patches`.
    active
        Not 0 for contacts that were kept before: these win unless another is 5 % further out, shape (>= n,).
    scratch
        Shape (>= patch_scratch_size(n),).
    chosen
        Written: contacts of each patch; -1 where it needs fewer than four, shape (>= count, 4).

    Notes
    -----
    First the contact farthest from the middle, then the one farthest from that, then the one farthest from the line
    through both, then the one that adds most to this triangle: four passes over the members of a patch.
    """
    # members of each patch one after another (counting sort)
    first = n
    for k in range(count + 1):
        scratch[first + k] = 0
    for i in range(n):
        scratch[first + patch_of[i] + 1] += 1
    for k in range(count):
        scratch[first + k + 1] += scratch[first + k]
    for i in range(n - 1, -1, -1):
        k = first + patch_of[i] + 1
        scratch[k] -= 1
        scratch[scratch[k]] = i
    # now place k + 1 holds the beginning of patch k
    for k in range(count):
        low = scratch[first + k + 1]
        high = scratch[first + k + 2] if k + 1 < count else n
        for c in range(EXTREMES):
            chosen[k, c] = -1
        x, y, z = 0.0, 0.0, 0.0
        for place in range(low, high):
            i = scratch[place]
            x += points[i, 0]
            y += points[i, 1]
            z += points[i, 2]
        share = 1.0 / (high - low)
        a, size = _farthest(points, active, scratch, low, high, x * share, y * share, z * share)
        chosen[k, 0] = a
        ax, ay, az = points[a, 0], points[a, 1], points[a, 2]
        b, square = _farthest(points, active, scratch, low, high, ax, ay, az)
        # coordinates are rounded: what is left of them at a point is no extent
        if b == a or square <= FLAT * FLAT * (size + 1e-6 * (ax * ax + ay * ay + az * az)):
            continue
        chosen[k, 1] = b
        nx, ny, nz = normals[a, 0], normals[a, 1], normals[a, 2]
        plane = (nx, ny, nz)
        beside = _beside(plane, points, a, b)
        c, area, side = -1, 0.0, 1.0
        for place in range(low, high):
            i = scratch[place]
            s = _twice_area(beside, points, a, i)
            score = abs(s) * (MEMORY if active[i] else 1.0)
            if score > area:
                c, area, side = i, score, s
        if area <= FLAT * square:
            continue
        chosen[k, 2] = c
        turn = -1.0 if side > 0.0 else 1.0
        beside_b, beside_c = _beside(plane, points, b, c), _beside(plane, points, c, a)
        d, area = -1, 0.0
        for place in range(low, high):
            i = scratch[place]
            s = turn * _twice_area(beside, points, a, i)
            s = max(s, turn * _twice_area(beside_b, points, b, i))
            s = max(s, turn * _twice_area(beside_c, points, c, i))
            score = s * (MEMORY if active[i] else 1.0)
            if score > area:
                d, area = i, score
        if area > FLAT * square:
            chosen[k, 3] = d


@kernel(inline=True, internal=True)
def _farthest(
    points: NDArray[np.float64],
    active: NDArray[np.int64],
    members: NDArray[np.int64],
    low: int,
    high: int,
    x: float,
    y: float,
    z: float,
) -> tuple[int, float]:
    """Member farthest from a place, and the square of its distance [m^2]."""
    best, most, square = members[low], -1.0, 0.0
    for place in range(low, high):
        i = members[place]
        dx, dy, dz = points[i, 0] - x, points[i, 1] - y, points[i, 2] - z
        s = dx * dx + dy * dy + dz * dz
        score = s * (MEMORY * MEMORY if active[i] else 1.0)
        if score > most:
            best, most, square = i, score, s
    return best, square


@kernel(inline=True, internal=True)
def _beside(n: Vector, points: NDArray[np.float64], a: int, b: int) -> Vector:
    """Vector in the patch plane whose product with ``x - a`` is twice the area [m^2] of the triangle a, b, x."""
    return cross(n, subtract(points[b], points[a]))


@kernel(inline=True, internal=True)
def _twice_area(beside: Vector, points: NDArray[np.float64], a: int, i: int) -> float:
    """Twice the area [m^2] of a triangle with the given side from a, signed."""
    return (
        beside[0] * (points[i, 0] - points[a, 0])
        + beside[1] * (points[i, 1] - points[a, 1])
        + beside[2] * (points[i, 2] - points[a, 2])
    )
