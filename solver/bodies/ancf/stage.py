"""Bases and markers of a mesh at a stage: what the workspace of the scene sees of it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.kind import (
    POINT_MARKER,
    TANGENT_MARKER,
    VECTOR_MARKER,
    Meshes,
    MeshNumbers,
)
from heavylift.solver.bodies.ancf.moving import write_points
from heavylift.solver.interface import Workspace, fill_markers
from heavylift.solver.kinds import implement

__all__ = ["base_value", "write_bases"]

Vector = tuple[float, float, float]


@kernel(internal=True)
def base_value(kind: Meshes, base: int, nodal: Floats1) -> Vector:
    """Value of a nodal vector at a base, body axes."""
    vectors = len(kind.shape[0]) // 3
    nodes = 2 if vectors == 2 else 4
    element, shape = kind.bases[base].element, kind.bases[base].shape_values
    x = y = z = 0.0
    for i in range(nodes):
        for a in range(vectors):
            at, value = kind.elements[element].nodes[i] + 3 * a, kind.constants[shape + i * vectors + a]
            x += value * nodal[at]
            y += value * nodal[at + 1]
            z += value * nodal[at + 2]
    return x, y, z


@kernel(internal=True)
def write_bases(kind: Meshes, nodal: Floats1, to: NDArray[np.float64]) -> None:
    """Values of a nodal vector at all bases and moving points into a vector of velocities of the scene."""
    for body in range(kind.table.shape[0]):
        dof, first = kind.table[body].dof, kind.table[body].first_base
        for i in range(kind.table[body].base_count):
            y = base_value(kind, first + i, nodal)
            to[dof + 3 * i], to[dof + 3 * i + 1], to[dof + 3 * i + 2] = y[0], y[1], y[2]
        write_points(kind.moving, kind, body, nodal, to)


@kernel(inline=True, internal=True)
def _to_world(numbers: MeshNumbers, a: Vector) -> Vector:
    R = numbers.rotation
    return (
        R[0, 0] * a[0] + R[0, 1] * a[1] + R[0, 2] * a[2],
        R[1, 0] * a[0] + R[1, 1] * a[1] + R[1, 2] * a[2],
        R[2, 0] * a[0] + R[2, 1] * a[1] + R[2, 2] * a[2],
    )


@kernel(internal=True)
def _put(out: NDArray[np.float64], value: Vector) -> None:
    out[0], out[1], out[2] = value[0], value[1], value[2]


@kernel(internal=True)
def _put_columns(J: NDArray[np.float64], column: int, R: NDArray[np.float64], M: NDArray[np.float64]) -> None:
    """``J[:, column ... column + 2] = R M``."""
    for k in range(3):
        for c in range(3):
            total = 0.0
            for l in range(3):
                total += R[k, l] * M[l, c]
            J[k, column + c] = total


@kernel(internal=True)
def _write_tangent(kind: Meshes, marker: int, work: Workspace) -> None:
    """Unit tangent ``s t/|t|``; its derivative by t is ``s (1 - u u^T) / |t|``."""
    body, base = kind.markers[marker].body, kind.markers[marker].base
    sense = kind.constants[kind.markers[marker].data]
    numbers, number = kind.body[body], kind.markers[marker].number
    t, rate = base_value(kind, base, kind.mid_position), base_value(kind, base, kind.mid_velocity)
    size = 1.0 / math.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
    u = (size * t[0], size * t[1], size * t[2])
    along = u[0] * rate[0] + u[1] * rate[1] + u[2] * rate[2]
    scale = sense * size
    _put(work.markers[number].point, _to_world(numbers, (sense * u[0], sense * u[1], sense * u[2])))
    turned = (
        scale * (rate[0] - along * u[0]),
        scale * (rate[1] - along * u[1]),
        scale * (rate[2] - along * u[2]),
    )
    _put(work.markers[number].velocity, _to_world(numbers, turned))
    M = numbers.scratch
    for k in range(3):
        for c in range(3):
            M[k, c] = scale * ((1.0 if k == c else 0.0) - u[k] * u[c])
    _put_columns(work.jacobian[number], 3 * (base - kind.table[body].first_base), numbers.rotation, M)


@kernel(internal=True)
def _write_triad(kind: Meshes, marker: int, work: Workspace) -> None:
    """A direction ``d1 e1 + d2 e2 + d3 e3`` fixed in the triad of the slopes a and b.

    Notes
    -----
    ``e1 = a/|a|``, ``e3 = a x b/|a x b|``, ``e2 = e3 x e1``. The triad turns with ``w``: ``w.e3 = e2.a'/|a|``,
    ``w.e2 = -e3.a'/|a|``, ``w.e1 = (e3.b' - (b.e1) e3.a'/|a|)/(b.e2)``; so each component of ``w`` is linear in the
    rates of the slopes and the direction changes by ``w x d``.
    """
    body, base = kind.markers[marker].body, kind.markers[marker].base
    numbers, number = kind.body[body], kind.markers[marker].number
    data = kind.markers[marker].data
    d1, d2, d3 = kind.constants[data], kind.constants[data + 1], kind.constants[data + 2]
    a, b = base_value(kind, base, kind.mid_position), base_value(kind, base + 1, kind.mid_position)
    ra, rb = base_value(kind, base, kind.mid_velocity), base_value(kind, base + 1, kind.mid_velocity)
    size = 1.0 / math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    e1 = (size * a[0], size * a[1], size * a[2])
    n1, n2, n3 = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    area = 1.0 / math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
    e3 = (area * n1, area * n2, area * n3)
    e2 = (e3[1] * e1[2] - e3[2] * e1[1], e3[2] * e1[0] - e3[0] * e1[2], e3[0] * e1[1] - e3[1] * e1[0])
    b1 = b[0] * e1[0] + b[1] * e1[1] + b[2] * e1[2]
    b2 = 1.0 / (b[0] * e2[0] + b[1] * e2[1] + b[2] * e2[2])
    direction = (
        d1 * e1[0] + d2 * e2[0] + d3 * e3[0],
        d1 * e1[1] + d2 * e2[1] + d3 * e3[1],
        d1 * e1[2] + d2 * e2[2] + d3 * e3[2],
    )
    # w x d = (w.e1) (d2 e3 - d3 e2) + (w.e2) (d3 e1 - d1 e3) + (w.e3) (d1 e2 - d2 e1)
    M = numbers.scratch
    column = 3 * (base - kind.table[body].first_base)
    t1 = t2 = t3 = 0.0
    for which in range(2):
        for k in range(3):
            f1, f2, f3 = d2 * e3[k] - d3 * e2[k], d3 * e1[k] - d1 * e3[k], d1 * e2[k] - d2 * e1[k]
            for c in range(3):
                of_a = size * (-b1 * b2 * f1 * e3[c] - f2 * e3[c] + f3 * e2[c])
                M[k, c] = of_a if which == 0 else b2 * f1 * e3[c]
        rate = ra if which == 0 else rb
        t1 += M[0, 0] * rate[0] + M[0, 1] * rate[1] + M[0, 2] * rate[2]
        t2 += M[1, 0] * rate[0] + M[1, 1] * rate[1] + M[1, 2] * rate[2]
        t3 += M[2, 0] * rate[0] + M[2, 1] * rate[1] + M[2, 2] * rate[2]
        _put_columns(work.jacobian[number], column + 3 * which, numbers.rotation, M)
    _put(work.markers[number].point, _to_world(numbers, direction))
    _put(work.markers[number].velocity, _to_world(numbers, (t1, t2, t3)))


@kernel(internal=True)
def _write_markers(kind: Meshes, level: int, work: Workspace) -> None:
    """All markers that a level needs, at `mid_position` and `mid_velocity`."""
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level > level:
            continue
        which = kind.markers[marker].type
        if which in (POINT_MARKER, VECTOR_MARKER):
            body, base = kind.markers[marker].body, kind.markers[marker].base
            number, numbers = kind.markers[marker].number, kind.body[body]
            p = _to_world(numbers, base_value(kind, base, kind.mid_position))
            if which == POINT_MARKER:
                p = (p[0] + numbers.origin[0], p[1] + numbers.origin[1], p[2] + numbers.origin[2])
            _put(work.markers[number].point, p)
            _put(work.markers[number].velocity, _to_world(numbers, base_value(kind, base, kind.mid_velocity)))
            column = 3 * (base - kind.table[body].first_base)
            for k in range(3):
                for c in range(3):
                    work.jacobian[number, k, column + c] = numbers.rotation[k, c]
        elif which == TANGENT_MARKER:
            _write_tangent(kind, marker, work)
        else:
            _write_triad(kind, marker, work)


@implement(fill_markers, Meshes)
@kernel(internal=True)
def fill_mesh_markers(kind: Meshes, at_midpoint: bool, level: int, work: Workspace) -> None:
    """Markers from the bases; rows of other bases in the Jacobians stay zero."""
    if not at_midpoint:
        for i in range(kind.position.shape[0]):
            kind.mid_position[i] = kind.position[i]
            kind.mid_velocity[i] = kind.velocity[i]
    _write_markers(kind, level, work)


__all__ += ["fill_mesh_markers"]
