"""Points that move over a mesh: how contacts that slide see frames and shells.

A base is a node of the factor, so its place is fixed. A moving point is none: its velocity ``y' = J q'`` may belong to
another element at every stage. What rows need of it comes from forward substitution of three right-hand sides::

    Z = D^-1 L^-1 J^T,    J A^-1 J'^T = Z^T D Z',    J A^-1 r = Z^T D (D^-1 L^-1 r)

and the places of the bases are left with their coupling ``-J_b A^-1 J^T``. Impulses p add ``Z p`` to a right-hand
side before its back substitution. Only the columns between the touched element and the root of the elimination tree
take part (J. R. Gilbert and T. Peierls, SIAM J. Sci. Stat. Comput. 9, 1988).

A point that contacts have aimed lives until the stage ends. Others are nothing, and cost nothing. The functions here
run over `Meshes.moving`, which is empty in scenes without moving points.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import forward_pivot, subtract_forward
from heavylift.numerics.vectors import Vector
from heavylift.solver.bodies.ancf.assembly import set_size
from heavylift.solver.bodies.ancf.kind import Meshes, MovingPoints
from heavylift.solver.rows.structure import RowArrays

__all__ = [
    "add_point_compliance",
    "add_point_forces",
    "add_point_impulses",
    "body_with_points",
    "find_free_points",
    "forget_vectors",
    "point_response",
    "point_value",
    "prepare_points",
    "release_points",
    "vector_length",
    "write_free_points",
    "write_points",
]


@kernel(internal=True)
def body_with_points(kind: Meshes, dof: int) -> int:
    """Row of the body with moving points whose first velocity this is, -1 if it is not of this kind."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].dof == dof and kind.table[body].moving_count > 0:
            return body
    return -1


@kernel(internal=True)
def point_value(moving: MovingPoints, kind: Meshes, point: int, nodal: Floats1) -> Vector:
    """Value of a nodal vector at a point, body axes."""
    first = moving.points[point].first_entry
    x = y = z = 0.0
    for i in range(first, first + moving.points[point].entry_count):
        at, value = moving.entries[i], moving.factors[i]
        x += value * nodal[at]
        y += value * nodal[at + 1]
        z += value * nodal[at + 2]
    return x, y, z


@kernel(inline=True, internal=True)
def _place(kind: Meshes, body: int, slot: int) -> int:
    """Place of the three numbers of a moving point in a nodal vector."""
    return kind.bases[kind.table[body].first_base + kind.table[body].base_count + slot].place


@kernel(inline=True, internal=True)
def vector_length(kind: Meshes, body: int) -> int:
    """Numbers of one of the vectors of a point."""
    return (kind.table[body].node_count + kind.table[body].base_node_count) * len(kind.shape[1])


@kernel(internal=True)
def _clear(moving: MovingPoints, kind: Meshes, body: int, point: int) -> None:
    """Zeros where the vectors of a point are not zero."""
    lanes = len(kind.shape[1])
    length, first_node = vector_length(kind, body), kind.table[body].first_node
    path, begin = moving.points[point].path, moving.points[point].vectors
    for i in range(path, path + moving.points[point].path_count):
        at = begin + (kind.columns[moving.paths[i]].node - first_node) * lanes
        for k in range(3):
            for r in range(lanes):
                moving.vectors[at + k * length + r] = 0.0
    bases = begin + kind.table[body].node_count * lanes
    for k in range(3):
        for r in range(kind.table[body].base_node_count * lanes):
            moving.vectors[bases + k * length + r] = 0.0
    moving.points[point].path_count = 0


@kernel(internal=True)
def _find_vectors(moving: MovingPoints, kind: Meshes, body: int, point: int, which: int) -> None:
    """``Z = D^-1 L^-1 J^T`` with the factor of a set."""
    shape, columns, lower, Z = kind.shape, kind.columns, kind.lower, moving.vectors
    lanes, base = len(kind.shape[1]), which * set_size(kind)
    length = vector_length(kind, body)
    _clear(moving, kind, body, point)
    begin = moving.points[point].vectors - kind.table[body].first_node * lanes
    first, last = kind.table[body].last_column, kind.table[body].last_column
    entry = moving.points[point].first_entry
    for i in range(entry, entry + moving.points[point].entry_count):
        at = moving.entries[i]
        for k in range(3):
            Z[begin + k * length + at + k] = moving.factors[i] * kind.free[at + k]
        moving.marks[at // lanes] = 1
        first = min(first, moving.column_of[at // lanes])
    path = moving.points[point].path
    count = 0
    for column in range(first, last):
        node = columns[column].node
        if moving.marks[node] == 0:
            continue
        moving.marks[node] = 0
        moving.paths[path + count] = column
        count += 1
        pivot, at, below = columns[column].pivot, columns[column].first_lower, columns[column].lower_count
        z = begin + node * lanes
        for k in range(3):
            forward_pivot(shape, Z, z + k * length, kind.blocks, base + pivot)
        for l in range(at, at + below):
            to, block = begin + lower[l].node * lanes, base + lower[l].place
            moving.marks[lower[l].node] = 1
            for k in range(3):
                subtract_forward(shape, Z, to + k * length, kind.blocks, block, Z, z + k * length)
    moving.points[point].path_count = count


@kernel(internal=True)
def _find_compliance(moving: MovingPoints, kind: Meshes, body: int, i: int, j: int, which: int) -> None:
    """``Z_i^T D Z_j`` of two moving points of a body into both triangles."""
    rows, lanes, base = len(kind.shape[0]), len(kind.shape[1]), which * set_size(kind)
    length, width, Z = vector_length(kind, body), 3 * kind.table[body].moving_count, moving.vectors
    first, out = moving.bodies[body].first_point, moving.bodies[body].compliance
    shift = kind.table[body].first_node * lanes
    a, b = moving.points[first + i].vectors - shift, moving.points[first + j].vectors - shift
    path = moving.points[first + i].path
    c00 = c01 = c02 = c10 = c11 = c12 = c20 = c21 = c22 = 0.0
    for p in range(path, path + moving.points[first + i].path_count):
        column = moving.paths[p]
        at, pivot = kind.columns[column].node * lanes, base + kind.columns[column].pivot
        for r in range(rows):
            d = 1.0 / kind.blocks[pivot + r * (lanes + 1)]
            u, v = a + at + r, b + at + r
            x, y, z = Z[u] * d, Z[u + length] * d, Z[u + 2 * length] * d
            e, f, g = Z[v], Z[v + length], Z[v + 2 * length]
            c00 += x * e
            c01 += x * f
            c02 += x * g
            c10 += y * e
            c11 += y * f
            c12 += y * g
            c20 += z * e
            c21 += z * f
            c22 += z * g
    values = ((c00, c01, c02), (c10, c11, c12), (c20, c21, c22))
    for k in range(3):
        for l in range(3):
            moving.compliance[out + (3 * i + k) * width + 3 * j + l] = values[k][l]
            moving.compliance[out + (3 * j + l) * width + 3 * i + k] = values[k][l]


@kernel(internal=True)
def prepare_points(moving: MovingPoints, kind: Meshes, body: int, which: int) -> None:
    """Vectors and compliance of all living points of a body with the factor of a set, if they are not there yet."""
    first, count = moving.bodies[body].first_point, kind.table[body].moving_count
    found = False
    for i in range(first, first + count):
        if moving.points[i].live and moving.points[i].current_set != which:
            _find_vectors(moving, kind, body, i, which)
            moving.points[i].current_set = which
            moving.points[i].fresh = True
            found = True
    if not found:
        return
    for i in range(count):
        for j in range(i + 1):
            both = moving.points[first + i].live and moving.points[first + j].live
            if both and (moving.points[first + i].fresh or moving.points[first + j].fresh):
                _find_compliance(moving, kind, body, i, j, which)
    for i in range(first, first + count):
        moving.points[i].fresh = False


@kernel(internal=True)
def point_response(
    moving: MovingPoints, kind: Meshes, point: int, body: int, which: int, nodal: Floats1
) -> Vector:
    """``J A^-1 r``, with ``D^-1 L^-1 r`` in a nodal vector; vectors of the point are prepared."""
    rows, lanes, base = len(kind.shape[0]), len(kind.shape[1]), which * set_size(kind)
    length, Z = vector_length(kind, body), moving.vectors
    begin = moving.points[point].vectors - kind.table[body].first_node * lanes
    path = moving.points[point].path
    x = y = z = 0.0
    for p in range(path, path + moving.points[point].path_count):
        column = moving.paths[p]
        at, pivot = kind.columns[column].node * lanes, base + kind.columns[column].pivot
        for r in range(rows):
            value = nodal[at + r] / kind.blocks[pivot + r * (lanes + 1)]
            x += Z[begin + at + r] * value
            y += Z[begin + length + at + r] * value
            z += Z[begin + 2 * length + at + r] * value
    return x, y, z


# ---- what the step of a mesh calls: nothing for meshes without moving points ----


@kernel(internal=True)
def release_points(moving: MovingPoints, kind: Meshes, body: int) -> None:
    """A stage ends: what contacts touch is not known any more."""
    first = moving.bodies[body].first_point
    for i in range(first, first + kind.table[body].moving_count):
        moving.points[i].live = False
        moving.points[i].current_set = -1


@kernel(internal=True)
def forget_vectors(moving: MovingPoints, kind: Meshes, body: int) -> None:
    """A matrix has been factored anew."""
    first = moving.bodies[body].first_point
    for i in range(first, first + kind.table[body].moving_count):
        moving.points[i].current_set = -1


@kernel(internal=True)
def write_points(
    moving: MovingPoints, kind: Meshes, body: int, nodal: Floats1, to: NDArray[np.float64]
) -> None:
    """Values of a nodal vector behind those of the bases in a vector of velocities of the scene."""
    first = moving.bodies[body].first_point
    dof = kind.table[body].dof + 3 * kind.table[body].base_count
    for i in range(kind.table[body].moving_count):
        if moving.points[first + i].live:
            y = point_value(moving, kind, first + i, nodal)
            to[dof + 3 * i], to[dof + 3 * i + 1], to[dof + 3 * i + 2] = y[0], y[1], y[2]


@kernel(internal=True)
def find_free_points(moving: MovingPoints, kind: Meshes, body: int, which: int) -> None:
    """After forward substitution of `right_hand_side`: ``-J A^-1 r`` into the places of the points, as of bases."""
    first, right = moving.bodies[body].first_point, kind.right_hand_side
    prepare_points(moving, kind, body, which)
    for i in range(kind.table[body].moving_count):
        x = y = z = 0.0
        if moving.points[first + i].live:
            x, y, z = point_response(moving, kind, first + i, body, which, right)
        place = _place(kind, body, i)
        right[place], right[place + 1], right[place + 2] = -x, -y, -z


@kernel(internal=True)
def write_free_points(
    moving: MovingPoints, kind: Meshes, body: int, nodal: Floats1, start: float, to: NDArray[np.float64]
) -> None:
    """``start`` times values of a nodal vector, minus `right_hand_side` at the places of points, behind the bases."""
    first, right = moving.bodies[body].first_point, kind.right_hand_side
    dof = kind.table[body].dof + 3 * kind.table[body].base_count
    for i in range(kind.table[body].moving_count):
        place, at = _place(kind, body, i), dof + 3 * i
        x = y = z = 0.0
        if moving.points[first + i].live:
            x, y, z = point_value(moving, kind, first + i, nodal)
        to[at] = start * x - right[place]
        to[at + 1] = start * y - right[place + 1]
        to[at + 2] = start * z - right[place + 2]


@kernel(internal=True)
def add_point_forces(moving: MovingPoints, kind: Meshes, body: int, which: int) -> None:
    """``Z p`` to the forward-substituted `right_hand_side`, with minus the impulses p in the places of the points."""
    rows, lanes, right = len(kind.shape[0]), len(kind.shape[1]), kind.right_hand_side
    first, length, Z = moving.bodies[body].first_point, vector_length(kind, body), moving.vectors
    prepare_points(moving, kind, body, which)
    for i in range(kind.table[body].moving_count):
        place = _place(kind, body, i)
        x, y, z = right[place], right[place + 1], right[place + 2]
        if not moving.points[first + i].live or (x == 0.0 and y == 0.0 and z == 0.0):
            continue
        begin = moving.points[first + i].vectors - kind.table[body].first_node * lanes
        path = moving.points[first + i].path
        for p in range(path, path + moving.points[first + i].path_count):
            at = kind.columns[moving.paths[p]].node * lanes
            for r in range(at, at + rows):
                right[r] -= x * Z[begin + r] + y * Z[begin + length + r] + z * Z[begin + 2 * length + r]


@kernel(internal=True)
def add_point_impulses(moving: MovingPoints, kind: Meshes, body: int, nodal: Floats1) -> None:
    """``right_hand_side += J^T p``, with minus the impulses p in the places of the points of a nodal vector."""
    for i in range(kind.table[body].moving_count):
        point, place = moving.bodies[body].first_point + i, _place(kind, body, i)
        if not moving.points[point].live:
            continue
        first = moving.points[point].first_entry
        for e in range(first, first + moving.points[point].entry_count):
            at, value = moving.entries[e], moving.factors[e]
            for k in range(3):
                kind.right_hand_side[at + k] -= value * nodal[place + k]


@kernel(internal=True)
def add_point_compliance(
    moving: MovingPoints, kind: Meshes, body: int, which: int, system: RowArrays, attachment: int
) -> None:
    """The part of ``X = C G^T`` of an attachment that comes from the moving points: all but bases with bases."""
    lanes, block_lanes = system.lanes, len(kind.shape[1])
    G, half, panel = system.panels, system.panels.shape[0] // 2, system.attachments[attachment].panel
    bases, count = kind.table[body].base_count, kind.table[body].moving_count
    first, length = moving.bodies[body].first_point, vector_length(kind, body)
    shift, first_base = kind.table[body].first_node * block_lanes, kind.table[body].first_base
    prepare_points(moving, kind, body, which)
    for column in range(3 * (bases + count)):
        of = panel + column * lanes
        used = False
        for r in range(lanes):
            used = used or G[of + r] != 0.0
        slot, c = (column - 3 * bases) // 3, column % 3
        if not used or (column >= 3 * bases and not moving.points[first + slot].live):
            continue
        if column >= 3 * bases:
            begin = moving.points[first + slot].vectors + c * length - shift
            for base in range(bases):
                place = begin + kind.bases[first_base + base].place
                for k in range(3):
                    to = half + panel + (3 * base + k) * lanes
                    for r in range(lanes):
                        G[to + r] -= moving.vectors[place + k] * G[of + r]
        for other in range(count):
            if not moving.points[first + other].live:
                continue
            for k in range(3):
                to = half + panel + (3 * (bases + other) + k) * lanes
                if column >= 3 * bases:
                    at = moving.bodies[body].compliance + (3 * other + k) * 3 * count
                    value = moving.compliance[at + column - 3 * bases]
                else:
                    place = kind.bases[first_base + column // 3].place + c - shift
                    value = -moving.vectors[moving.points[first + other].vectors + k * length + place]
                for r in range(lanes):
                    G[to + r] += value * G[of + r]
