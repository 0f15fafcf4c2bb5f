"""Clearance of surfaces that are out of reach of each other, for the record: only where it is asked for."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.clearance import clearance, clearance_stack_size
from heavylift.contours.surface_pack import CollisionSurfaces
from heavylift.numerics.arrays import Arrays, Floats1, Ints1
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows, pose_at
from heavylift.solver.contact.mesh_interface import record_clearance
from heavylift.solver.contact.mesh_kind import (
    FIRST,
    FIRST_POSE,
    PAIR_REACH,
    SECOND,
    SECOND_POSE,
    SurfacePairs,
)
from heavylift.solver.contact.mesh_slots import surface_count
from heavylift.solver.contact.mesh_touch import relative_pose
from heavylift.solver.kinds import implement

__all__ = ["Clearances", "make_clearances"]

ABOVE = 1.1
"""A guess of the next clearance, relative to the last one: what is too small costs a second search."""


class Clearances(Arrays):
    """Which pairs are measured, and scratch.

    Attributes
    ----------
    wanted
        1 for each pair whose clearance is recorded, shape (np,).
    last
        Clearance of each pair when it was measured last [m].
    stack, found, pose
        Scratch.
    """

    wanted: Ints1
    last: Floats1
    stack: Floats1
    found: Floats1
    pose: Floats1


def make_clearances(surfaces: CollisionSurfaces, wanted: list[bool]) -> list[Clearances]:
    """The kind, if a pair asks for it."""
    if not any(wanted):
        return []
    return [
        Clearances(
            wanted=np.array(wanted, dtype=np.int64),
            last=np.full(len(wanted), math.inf),
            stack=np.zeros(int(clearance_stack_size(surfaces))),
            found=np.zeros(6),
            pose=np.zeros(12),
        )
    ]


@implement(record_clearance, Clearances)
@kernel(internal=True)
def record_mesh_clearance(
    clearances: Clearances,
    meshes: SurfacePairs,
    contacts: ContactRows,
    pair: int,
    row: NDArray[np.float64],
    at: int,
) -> None:
    """At the end of the last step; a pair that has contacts in reach has its gap already."""
    if clearances.wanted[pair] == 0 or row[at] < meshes.pair_values[pair, PAIR_REACH]:
        return
    first_row = contacts.poses.shape[0] - surface_count(contacts, meshes)
    a, b = meshes.pairs[pair, FIRST_POSE] - first_row, meshes.pairs[pair, SECOND_POSE] - first_row
    first, second = pose_at(contacts.placed[a], 0), pose_at(contacts.placed[b], 0)
    relative_pose(first, second, pose_at(clearances.pose, 0))
    row[at] = clearances.last[pair] = clearance(
        meshes.surfaces,
        meshes.pairs[pair, FIRST],
        meshes.pairs[pair, SECOND],
        clearances.pose,
        0,
        ABOVE * clearances.last[pair],
        clearances.stack,
        clearances.found,
    )
