"""Second rates of directions on a mesh without accelerations of its bases, for joints that are differentiated twice.

Points and slopes are linear in the coordinates, so theirs are zero. With ``t`` a tangent and ``u = t/|t|``::

    u'' = -2 (u.t')/|t| u' - |u'|^2 u      at t'' = 0

A direction d fixed in the triad of two slopes a, b (see `heavylift.solver.bodies.ancf.stage`) turns with w, of
components p, q, r in the triad. With A_i, B_i the components of ``a'/|a|`` and ``b'``, and b_i those of b, at
``a'' = b'' = 0``::

    r = A_2,    r' = -p q - 2 r A_1          q = -A_3,    q' = p r - 2 q A_1
    p b_2 = B_3 + b_1 q,    p' b_2 = 2 q B_1 - 2 p B_2 + q r b_2 + p r b_1 + b_1 q'
    d'' = w' x d + w x (w x d),    w' = p' e_1 + q' e_2 + r' e_3
"""

from __future__ import annotations

import math
from typing import Any

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross
from heavylift.solver.bodies.ancf.kind import TANGENT_MARKER, TRIAD_MARKER, Meshes
from heavylift.solver.bodies.ancf.stage import base_value
from heavylift.solver.interface import Workspace

__all__ = ["write_second_rates"]

Vector = tuple[float, float, float]


@kernel(inline=True, internal=True)
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel(internal=True)
def _put(kind: Meshes, body: int, out: Any, x: Vector) -> None:
    """Into world axes."""
    R = kind.body[body].rotation
    for k in range(3):
        out.bias[k] = R[k, 0] * x[0] + R[k, 1] * x[1] + R[k, 2] * x[2]


@kernel(internal=True)
def _tangent(kind: Meshes, marker: int) -> Vector:
    base = kind.markers[marker].base
    sense = kind.constants[kind.markers[marker].data]
    t, w = base_value(kind, base, kind.mid_position), base_value(kind, base, kind.mid_velocity)
    size = 1.0 / math.sqrt(_dot(t, t))
    u = (size * t[0], size * t[1], size * t[2])
    along = _dot(u, w)
    turn = (size * (w[0] - along * u[0]), size * (w[1] - along * u[1]), size * (w[2] - along * u[2]))
    first, second = -2.0 * sense * along * size, -sense * _dot(turn, turn)
    return (
        first * turn[0] + second * u[0],
        first * turn[1] + second * u[1],
        first * turn[2] + second * u[2],
    )


@kernel(internal=True)
def _triad(kind: Meshes, marker: int) -> Vector:
    base, data = kind.markers[marker].base, kind.markers[marker].data
    d1, d2, d3 = kind.constants[data], kind.constants[data + 1], kind.constants[data + 2]
    a, b = base_value(kind, base, kind.mid_position), base_value(kind, base + 1, kind.mid_position)
    ra, rb = base_value(kind, base, kind.mid_velocity), base_value(kind, base + 1, kind.mid_velocity)
    size = 1.0 / math.sqrt(_dot(a, a))
    e1 = (size * a[0], size * a[1], size * a[2])
    n = cross(a, b)
    area = 1.0 / math.sqrt(_dot(n, n))
    e3 = (area * n[0], area * n[1], area * n[2])
    e2 = cross(e3, e1)
    b1, b2 = _dot(b, e1), _dot(b, e2)
    along = size * _dot(e1, ra)
    q, r = -size * _dot(e3, ra), size * _dot(e2, ra)
    p = (_dot(e3, rb) + b1 * q) / b2
    dr = -p * q - 2.0 * r * along
    dq = p * r - 2.0 * q * along
    dp = 2.0 * q * _dot(e1, rb) - 2.0 * p * _dot(e2, rb) + q * r * b2 + p * r * b1 + b1 * dq
    dp /= b2
    turn = cross((p, q, r), (d1, d2, d3))
    centripetal = cross((p, q, r), turn)
    change = cross((dp, dq, dr), (d1, d2, d3))
    c1, c2, c3 = change[0] + centripetal[0], change[1] + centripetal[1], change[2] + centripetal[2]
    return (
        c1 * e1[0] + c2 * e2[0] + c3 * e3[0],
        c1 * e1[1] + c2 * e2[1] + c3 * e3[1],
        c1 * e1[2] + c2 * e2[2] + c3 * e3[2],
    )


@kernel(internal=True)
def write_second_rates(kind: Meshes, level: int, work: Workspace) -> None:
    """Of all markers that a level needs, at `mid_position` and `mid_velocity`."""
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level > level:
            continue
        which, body = kind.markers[marker].type, kind.markers[marker].body
        out = work.markers[kind.markers[marker].number]
        if which == TANGENT_MARKER:
            _put(kind, body, out, _tangent(kind, marker))
        elif which == TRIAD_MARKER:
            _put(kind, body, out, _triad(kind, marker))
        else:
            _put(kind, body, out, (0.0, 0.0, 0.0))
