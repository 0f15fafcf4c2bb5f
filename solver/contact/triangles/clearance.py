"""Clearance of surfaces that are out of reach of each other: only of pairs of which somebody asks for it.

A record measures it. At the end of a step it is measured where it could be below what is known since the last record:
points move no farther than the way of both surfaces, and that is taken from the distance that was found last.
"""

from __future__ import annotations

import math

import numpy as np

from heavylift.contours.triangles.clearance import WaitingNodes, clearance, clearance_stack_size
from heavylift.contours.triangles.surface_layout import RelativePose
from heavylift.contours.triangles.surface_pack import CollisionSurfaces
from heavylift.numerics.arrays import Arrays, Floats1, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, records
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.interface import record_clearance, watch_clearance
from heavylift.solver.contact.triangles.kind import SurfacePairs, gone_contacts, placed_pose
from heavylift.solver.contact.triangles.modal_facets import make_whole, modal_row
from heavylift.solver.contact.triangles.narrow_phase import relative_pose
from heavylift.solver.contact.triangles.slots import surface_count
from heavylift.solver.extremes import note_value
from heavylift.solver.kinds import implement
from heavylift.solver.scene.collisions import CollisionOutputs

__all__ = ["Clearances", "make_clearances"]

ABOVE = 1.1
"""A guess of the next clearance, relative to the last one: what is too small costs a second search."""


class Clearances(Arrays):
    """Which pairs are measured, and scratch.

    Attributes
    ----------
    wanted
        1 for each pair whose clearance is recorded, shape (np,).
    last, moved
        Clearance of each pair when it was measured last, infinite before; way of its surfaces since then [m].
    stack, found, pose
        Scratch.
    """

    wanted: Ints1
    last: Floats1
    moved: Floats1
    stack: Records[WaitingNodes]
    found: Floats1
    pose: RelativePose


def make_clearances(surfaces: CollisionSurfaces, wanted: list[bool]) -> list[Clearances]:
    """The kind, if a pair asks for it."""
    if not any(wanted):
        return []
    return [
        Clearances(
            wanted=np.array(wanted, dtype=np.int64),
            last=np.full(len(wanted), math.inf),
            moved=np.zeros(len(wanted)),
            stack=records(WaitingNodes, clearance_stack_size(surfaces)),
            found=np.zeros(6),
            pose=RelativePose.one(),
        )
    ]


@kernel(internal=True)
def _place_pair(meshes: SurfacePairs, contacts: ContactRows, pair: int) -> None:
    """Points of a surface that deforms with modes, all of them."""
    for side in range(2):
        row = modal_row(meshes, contacts, pair, side)
        if row >= 0:
            make_whole(contacts.modal, meshes.surfaces, row)


@implement(record_clearance, Clearances)
@kernel(internal=True)
def record_mesh_clearance(
    clearances: Clearances,
    meshes: SurfacePairs,
    contacts: ContactRows,
    pair: int,
    out: CollisionOutputs,
) -> None:
    """At the end of the last step; a pair that has contacts in reach has its gap already."""
    if clearances.wanted[pair] == 0 or out.gap < meshes.pairs[pair].reach:
        return
    first_row = contacts.poses.shape[0] - surface_count(contacts, meshes)
    a, b = meshes.pairs[pair].poses[0] - first_row, meshes.pairs[pair].poses[1] - first_row
    first, second = placed_pose(contacts.placed[a], 0), placed_pose(contacts.placed[b], 0)
    relative_pose(first, second, clearances.pose)
    _place_pair(meshes, contacts, pair)
    out.gap = clearances.last[pair] = clearance(
        meshes.surfaces,
        meshes.pairs[pair].surfaces[0],
        meshes.pairs[pair].surfaces[1],
        clearances.pose,
        ABOVE * clearances.last[pair],
        clearances.stack,
        clearances.found,
    )
    clearances.moved[pair] = 0.0


@implement(watch_clearance, Clearances)
@kernel(internal=True)
def watch_mesh_clearance(
    clearances: Clearances, meshes: SurfacePairs, contacts: ContactRows, pair: int, interval: int
) -> None:
    """At the end of a step that stands, before its poses are taken over."""
    if clearances.wanted[pair] == 0:
        return
    one = meshes.pairs[pair]
    clearances.moved[pair] += (
        contacts.poses[one.poses[0]].step_shift + contacts.poses[one.poses[1]].step_shift
    )
    if one.gap < one.reach:  # its contacts know it
        return
    gaps = gone_contacts(contacts.placed[surface_count(contacts, meshes) + pair], 0).gaps
    nearest = clearances.last[pair] - clearances.moved[pair]
    if gaps.interval == interval and clearances.last[pair] < math.inf and nearest >= gaps.lowest:
        return
    _place_pair(meshes, contacts, pair)
    found = clearance(
        meshes.surfaces,
        one.surfaces[0],
        one.surfaces[1],
        meshes.relative[pair],
        clearances.last[pair] + clearances.moved[pair],
        clearances.stack,
        clearances.found,
    )
    note_value(gaps, interval, found)
    clearances.last[pair], clearances.moved[pair] = found, 0.0
