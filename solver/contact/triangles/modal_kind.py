"""Surfaces whose triangles deform with the modes of their body: what their points are made of, and which are in use.

A point is ``X + Phi q`` with constant X and Phi. Most of a surface is far from everything that it could touch, so its
points are not formed in every step: trees hold for coordinates of an earlier time, and how far points can have moved
since then,

    max_i |Phi_i (q - q_0)|  <=  sum_k |q_k - q_0k| max_i |Phi_ik| ,

counts as their travel (`heavylift.contours.triangles.pair_list`). Only what stands on the lists of near triangles is
formed, and the whole surface only when such a list has to be made anew.
"""

from __future__ import annotations

import numpy as np

from heavylift.contours.triangles.pair_list import PairLists
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1
from heavylift.numerics.records import Record, Records, records

__all__ = ["ModalSurface", "ModalSurfaces"]


class ModalSurface(Record):
    """A surface.

    Attributes
    ----------
    surface
        Its number.
    dof
        First velocity of its body.
    pose
        Row of its pose, and of its contour.
    modes
        Of its body.
    shapes
        Place of its first point in `ModalSurfaces.shapes`.
    first_coordinate
        Place of its first modal coordinate in `coordinates`, `placed` and `largest`.
    first_point, points
        Its first row in the points of all surfaces, and how many it has.
    first_needed, needed
        Its points that are needed, in `needed`: counted within the surface.
    first_triangle, triangles
        Its triangles that are needed, in `triangles`.
    first_edge, edges
        Its edges that are needed, in `edges`.
    whole
        Whether all that follows from its points holds for the present coordinates.
    solid
        Whether its triangles are faces of solid elements, wound so that their normals lead out of the material.
    """

    surface: int
    dof: int
    pose: int
    modes: int
    shapes: int
    first_coordinate: int
    first_point: int
    points: int
    first_needed: int
    needed: int
    first_triangle: int
    triangles: int
    first_edge: int
    edges: int
    whole: bool
    solid: bool


class ModalState(Record):
    """Of all these surfaces.

    Attributes
    ----------
    traversals
        How often lists of triangles had been made when what is needed was found.
    mark
        What marks points, triangles and edges that are needed.
    """

    traversals: int
    mark: int


class ModalSurfaces(Arrays):
    """Surfaces on bodies with modes; none, in most scenes.

    Attributes
    ----------
    rows
        The surfaces.
    row_of, row_of_surface
        Row by pose and by number of the surface, -1 of those that are none of these.
    shapes
        Of each point its undeformed place [m], then its mode shapes component by component, 3 + 3 nf numbers.
    coordinates, placed
        Modal coordinates of the stage, which the bodies write, and those of the last search.
    largest
        Of each mode its largest displacement on the surface.
    everything
        0, 1, 2, ...: the numbers of all points of a surface.
    needed, triangles, edges
        What is near others.
    point_marks, triangle_marks, edge_marks
        What stands in these.
    outward, edge_outward
        Way out of the material at points and edges of all surfaces, undeformed, shapes (n, 3) and (ne, 3).
    half_depths
        Half of the thickness of the elements below each point [m], infinite where that is not known.
    lists
        Of near triangles, those of all pairs of surfaces.
    state
        Of all.
    """

    rows: Records[ModalSurface]
    row_of: Ints1
    row_of_surface: Ints1
    shapes: Floats1
    coordinates: Floats1
    placed: Floats1
    largest: Floats1
    everything: Ints1
    needed: Ints1
    triangles: Ints1
    edges: Ints1
    point_marks: Ints1
    triangle_marks: Ints1
    edge_marks: Ints1
    outward: Floats2
    edge_outward: Floats2
    half_depths: Floats1
    lists: PairLists
    state: ModalState

    @classmethod
    def none(cls) -> ModalSurfaces:
        """Of scenes without."""
        from heavylift.contours.triangles.pair_list import make_pair_lists
        from heavylift.contours.triangles.surface_pack import pack_surfaces

        numbers, floats = np.zeros(0, dtype=np.int64), np.zeros(0)
        return cls(
            rows=records(ModalSurface, 0),
            row_of=numbers,
            row_of_surface=numbers,
            shapes=floats,
            coordinates=floats,
            placed=floats,
            largest=floats,
            everything=numbers,
            needed=numbers,
            triangles=numbers,
            edges=numbers,
            point_marks=numbers,
            triangle_marks=numbers,
            edge_marks=numbers,
            outward=np.zeros((0, 3)),
            edge_outward=np.zeros((0, 3)),
            half_depths=floats,
            lists=make_pair_lists(pack_surfaces([]), []),
            state=ModalState.one(),
        )
