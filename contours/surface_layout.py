"""Columns of packed triangle surfaces, of relative motions and of pair lists: what collision kernels read."""

from __future__ import annotations

__all__ = [
    "BOX_CENTRE",
    "BOX_HALF",
    "BOX_WIDTH",
    "CORNER_A",
    "CORNER_B",
    "CORNER_C",
    "EDGE_AB",
    "EDGE_BC",
    "EDGE_CA",
    "EDGE_END",
    "EDGE_START",
    "EDGE_TRIANGLE",
    "EDGE_WIDTH",
    "FIRST_EDGE",
    "FIRST_POINT",
    "FIRST_TRIANGLE",
    "FLAGS",
    "IS_FACE",
    "MOTION_P0",
    "MOTION_P1",
    "MOTION_R0",
    "MOTION_R1",
    "MOTION_WIDTH",
    "NODE_COUNT",
    "NODE_FIRST",
    "NODE_LEFT",
    "NODE_WIDTH",
    "OWNS_A",
    "OWNS_AB",
    "OWNS_B",
    "OWNS_BC",
    "OWNS_C",
    "OWNS_CA",
    "PAIR_CAPACITY",
    "PAIR_COUNT",
    "PAIR_FIRST",
    "PAIR_SURFACE_A",
    "PAIR_SURFACE_B",
    "PAIR_TRAVERSALS",
    "PAIR_WIDTH",
    "POINT_COUNT",
    "ROOT_NODE",
    "SURFACE",
    "SURFACE_WIDTH",
    "TRIANGLE_COUNT",
    "TRIANGLE_WIDTH",
]

# a triangle, integers: rows of its points, rows of its edges (-1: none), what it owns, its surface
CORNER_A, CORNER_B, CORNER_C, EDGE_AB, EDGE_BC, EDGE_CA, FLAGS, SURFACE = range(8)
TRIANGLE_WIDTH = 8

# bits of FLAGS: every point and every edge belongs to one triangle only, so that it is tested once; a lone point or
# segment is no face
OWNS_A, OWNS_B, OWNS_C, OWNS_AB, OWNS_BC, OWNS_CA, IS_FACE = (1 << bit for bit in range(7))

# an edge, integers: rows of its points, and of one triangle that has it
EDGE_START, EDGE_END, EDGE_TRIANGLE = range(3)
EDGE_WIDTH = 3

# a node of the tree, integers: its left child (the right one follows it; -1: a leaf), its triangles
NODE_LEFT, NODE_FIRST, NODE_COUNT = range(3)
NODE_WIDTH = 3

# a box along the axes of the body [m]: centre (3) and half lengths (3)
BOX_CENTRE, BOX_HALF = 0, 3
BOX_WIDTH = 6

# a surface, integers
FIRST_POINT, FIRST_TRIANGLE, FIRST_EDGE, ROOT_NODE, TRIANGLE_COUNT, POINT_COUNT = range(6)
SURFACE_WIDTH = 6

# motion of surface B in the axes of A over an interval: x_A = R x_B + p at its start and at its end, R row by row
MOTION_R0, MOTION_P0, MOTION_R1, MOTION_P1 = 0, 9, 12, 21
MOTION_WIDTH = 24

# a pair of surfaces, integers: the surfaces, the place of its list, the length of the list (-1: none is made yet), and
# how many times it was made
PAIR_SURFACE_A, PAIR_SURFACE_B, PAIR_FIRST, PAIR_CAPACITY, PAIR_COUNT, PAIR_TRAVERSALS = range(6)
PAIR_WIDTH = 6
