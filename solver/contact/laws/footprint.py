"""Contact through a small disc: gap and force are means over it with the weight ``(1 - r^2/R^2)^2``.

A point force has no finite displacement on a continuum, and none that is one number for a fine mesh. A disc has,
and the mean over it is again a weighted sum of few control points.
"""

from __future__ import annotations

import math

from heavylift.contours.splines.basis import find_span, wrap
from heavylift.contours.splines.evaluate import surface_weights
from heavylift.contours.splines.search_step import BORDER
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate_back
from heavylift.solver.contact.interface import form_controls
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.search.features import Footprints, weigh
from heavylift.solver.interface import Bodies
from heavylift.solver.kinds import implement

__all__: list[str] = []

ANGLES = 12

# Gauss points of s = r^2/R^2 in [0, 1]; with (1 - s)^2 their weights integrate it times polynomials up to degree three
GAUSS = (0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15))
SHARES = (5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0)


@implement(weigh, Footprints)
@kernel(internal=True)
def weigh_footprint(
    feature: Footprints, contacts: ContactRows, bodies: Bodies, c: int, y1: float, y2: float, y3: float
) -> None:
    """Control points under the disc about the touched point, and their weights; lever and gap become means."""
    if contacts.values[c].footprint == 0.0:
        return
    contour = contacts.table[c].contour
    row, scratch, places = contacts.contours[contour], contacts.scratch, contacts.places
    result, evaluate = scratch.result, scratch.evaluation
    dense, single = scratch.dense, scratch.single
    along, beside = result.tangent_u, result.tangent_v
    total = row.u.count * row.v.count
    for i in range(total):
        dense[i] = 0.0
    a = along[0] ** 2 + along[1] ** 2 + along[2] ** 2
    d = beside[0] ** 2 + beside[1] ** 2 + beside[2] ** 2
    b = along[0] * beside[0] + along[1] * beside[1] + along[2] * beside[2]
    radius, size = contacts.values[c].footprint, math.sqrt(a)
    across = math.sqrt(max(d - b * b / a, 1e-300))
    low_u, high_u, low_v, high_v = 2.0, -2.0, 2.0, -2.0
    whole = 0.0
    for i in range(3):
        whole += ANGLES * SHARES[i] * (1.0 - GAUSS[i]) ** 2
    for i in range(3):
        r = radius * math.sqrt(GAUSS[i])
        share = SHARES[i] * (1.0 - GAUSS[i]) ** 2 / whole
        for k in range(ANGLES):
            angle = 2.0 * math.pi * (k + 0.5) / ANGLES
            # along S_u and perpendicular to it in the tangent plane
            x, y = r * math.cos(angle), r * math.sin(angle)
            dv = y / across
            du = x / size - b / a * dv
            u, v = wrap(result.u + du, row.u.closed), wrap(result.v + dv, row.v.closed)
            low_u, high_u, low_v, high_v = min(low_u, u), max(high_u, u), min(low_v, v), max(high_v, v)
            count = surface_weights(
                row, contacts.constants, contacts.constants, u, v, evaluate, places, single
            )
            for j in range(count):
                dense[places[j]] += share * single[j]
    _form_window(contacts, bodies, contour, low_u, high_u, low_v, high_v)
    p1 = p2 = p3 = 0.0
    count = 0
    for i in range(total):
        w = dense[i]
        if w != 0.0:
            scratch.weights[count], places[count] = w, i
            p1 += w * contacts.net[row.first_control + i, 0]
            p2 += w * contacts.net[row.first_control + i, 1]
            p3 += w * contacts.net[row.first_control + i, 2]
            count += 1
    scratch.lever[0], scratch.lever[1], scratch.lever[2] = p1, p2, p3
    n1, n2, n3 = rotate_back(
        contacts.poses[contour].rotation,
        scratch.directions[0],
    )
    if result.flags & BORDER == 0:  # beyond it the distance from the edge stands
        gap = n1 * (y1 - p1) + n2 * (y2 - p2) + n3 * (y3 - p3)
        contacts.state[c].end_gap = gap - contacts.values[c].radius
    contacts.counts.controls = count


@kernel(internal=True)
def _form_window(
    contacts: ContactRows,
    bodies: Bodies,
    contour: int,
    low_u: float,
    high_u: float,
    low_v: float,
    high_v: float,
) -> None:
    """Control points of a range of parameters; all of them where it goes over a seam."""
    row, knots = contacts.contours[contour], contacts.constants
    p, q = row.u.degree, row.v.degree
    functions_u = row.u.count + row.u.closed * p
    functions_v = row.v.count + row.v.closed * q
    first_u, last_u, first_v, last_v = 0, row.u.count - 1, 0, row.v.count - 1
    if not row.u.closed or high_u - low_u < 0.5:
        first_u = find_span(knots, row.u.first_knot, p, functions_u, low_u) - p
        last_u = find_span(knots, row.u.first_knot, p, functions_u, high_u)
    if not row.v.closed or high_v - low_v < 0.5:
        first_v = find_span(knots, row.v.first_knot, q, functions_v, low_v) - q
        last_v = find_span(knots, row.v.first_knot, q, functions_v, high_v)
    form_controls(bodies, contacts, contour, first_u, last_u, first_v, last_v)
