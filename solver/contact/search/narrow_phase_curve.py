"""A bead on a curve, or a point or ball on a cylinder or band about it."""

from __future__ import annotations

import math

from heavylift.contours.splines.evaluate import curve_point, curve_weights
from heavylift.contours.splines.search import closest_on_curve, set_window
from heavylift.contours.splines.search_step import CONVERGED, NEED_SPAN, start_search
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross, rotate_back
from heavylift.solver.contact.kind import CURVE, FOUND, ContactRows
from heavylift.solver.contact.search.directions import form_span, put_ball, put_directions
from heavylift.solver.contact.search.features import Curves, touch, weigh
from heavylift.solver.contact.search.search_start import start_at_point
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []

OFF = 1e-7
"""Distance beyond an end relative to the size of the contact, from which on a contact with a band is off it."""


@implement(touch, Curves)
@kernel(internal=True)
def touch_curve(
    feature: Curves,
    contacts: ContactRows,
    bodies: Bodies,
    c: int,
    cold: bool,
    y1: float,
    y2: float,
    y3: float,
    work: Workspace,
) -> None:
    """Nearest point of the curve, then what is about it."""
    contour = contacts.table[c].contour
    if contacts.contours[contour].dimension == 1:
        if cold:
            start_at_point(contacts, c, y1, y2, y3)
        status = _find_point(contacts, bodies, contour, contacts.state[c].u, y1, y2, y3)
        contacts.state[c].search = FOUND if status == CONVERGED else status
        if status != CONVERGED:
            _keep_place(contacts, c)
        _put_touch(contacts, c, y1, y2, y3)


@implement(weigh, Curves)
@kernel(internal=True)
def weigh_curve(
    feature: Curves, contacts: ContactRows, bodies: Bodies, c: int, y1: float, y2: float, y3: float
) -> None:
    """Control points of the span, their weights in the point, and in the tangent if the offset turns with it."""
    contour = contacts.table[c].contour
    if contacts.contours[contour].dimension != 1:
        return
    row, scratch = contacts.contours[contour], contacts.scratch
    result, evaluate = scratch.result, scratch.evaluation
    weights = scratch.weights
    knots = contacts.constants
    count = curve_weights(row, knots, knots, result.u, evaluate, contacts.places, weights)
    if scratch.has_slopes:
        stride = row.u.degree + 1
        for i in range(count):
            scratch.slope_weights[i] = weights[stride + i]
    contacts.counts.controls = count


@kernel(internal=True)
def _find_point(
    contacts: ContactRows, bodies: Bodies, contour: int, u: float, y1: float, y2: float, y3: float
) -> int:
    """Nearest point; control points are formed span by span as the search asks for them."""
    row, scratch = contacts.contours[contour], contacts.scratch
    result, evaluate = scratch.result, scratch.evaluation
    knots, net = contacts.constants, contacts.net
    set_window(row, knots, u, 0.0, result)
    start_search(row, u, 0.0, result)
    status = NEED_SPAN
    while status == NEED_SPAN:
        form_span(contacts, bodies, contour, result.span_u, 0)
        status = closest_on_curve(row, knots, knots, net, (y1, y2, y3), evaluate, result)
    return status


@kernel(internal=True)
def _keep_place(contacts: ContactRows, c: int) -> None:
    """The last place, after a search that found nothing."""
    scratch, u, knots = contacts.scratch, contacts.state[c].u, contacts.constants
    result, evaluate = scratch.result, scratch.evaluation
    row = contacts.contours[contacts.table[c].contour]
    curve_point(row, knots, knots, contacts.net, u, evaluate, result)
    result.u, result.v = u, 0.0


@kernel(internal=True)
def _put_touch(contacts: ContactRows, c: int, y1: float, y2: float, y3: float) -> None:
    """Gaps, directions, lever and arm from the nearest point."""
    contour = contacts.table[c].contour
    pose, scratch, state = contacts.poses[contour], contacts.scratch, contacts.state[c]
    result = scratch.result
    s, along = result.position, result.tangent_u
    speed = math.sqrt(along[0] ** 2 + along[1] ** 2 + along[2] ** 2)
    t1, t2, t3 = along[0] / speed, along[1] / speed, along[2] / speed
    d1, d2, d3 = y1 - s[0], y2 - s[1], y3 - s[2]
    radius = contacts.values[c].radius
    o1 = o2 = o3 = 0.0
    if contacts.table[c].law == CURVE:
        # normals that turn with the curve and not about it: those of the last time, squared to the tangent
        n1, n2, n3 = rotate_back(pose.rotation, state.normal)
        share = n1 * t1 + n2 * t2 + n3 * t3
        n1, n2, n3 = n1 - share * t1, n2 - share * t2, n3 - share * t3
        size = math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
        if size < 1e-3:  # a bead placed where the first guess lies along the curve
            n1, n2, n3 = cross((t1, t2, t3), (t2, t3, -t1))
            size = math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
        n1, n2, n3 = n1 / size, n2 / size, n3 / size
        b1, b2, b3 = cross((t1, t2, t3), (n1, n2, n3))
        state.end_gap = n1 * d1 + n2 * d2 + n3 * d3
        state.second_end_gap = b1 * d1 + b2 * d2 + b3 * d3
        put_directions(contacts, contour, n1, n2, n3, b1, b2, b3)  # the third is n x b = t
        for k in range(3):
            scratch.arm[k] = 0.0
    elif pose.width > 0.0:
        # the director lies along the width; the normal is perpendicular to it and to the curve
        n1, n2, n3 = cross(pose.director, (t1, t2, t3))
        size = contacts.contours[contour].flip / math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
        n1, n2, n3 = size * n1, size * n2, size * n3
        b1, b2, b3 = cross((t1, t2, t3), (n1, n2, n3))
        across = b1 * d1 + b2 * d2 + b3 * d3
        o1, o2, o3 = across * b1, across * b2, across * b3
        gap = n1 * d1 + n2 * d2 + n3 * d3 - radius
        ends = d1 * t1 + d2 * t2 + d3 * t3
        beside = max(abs(across) - 0.5 * pose.width, abs(ends) - OFF * contacts.values[c].length_scale)
        state.end_gap = max(gap, beside) if beside > 0.0 else gap
        put_directions(contacts, contour, n1, n2, n3, t1, t2, t3)
        put_ball(contacts, contour, gap + radius, n1, n2, n3)
    else:
        distance = math.sqrt(d1 * d1 + d2 * d2 + d3 * d3)
        if distance > 1e-12 * contacts.values[c].length_scale:
            n1, n2, n3 = d1 / distance, d2 / distance, d3 / distance
        else:
            n1, n2, n3 = rotate_back(pose.rotation, state.normal)
        share = n1 * t1 + n2 * t2 + n3 * t3
        o1, o2, o3 = pose.radius * n1, pose.radius * n2, pose.radius * n3
        state.end_gap = distance - pose.radius - radius
        f1, f2, f3 = t1 - share * n1, t2 - share * n2, t3 - share * n3  # at an end the normal leans forward
        size = math.sqrt(f1 * f1 + f2 * f2 + f3 * f3)
        if size > 1e-6:
            put_directions(contacts, contour, n1, n2, n3, f1 / size, f2 / size, f3 / size)
        else:
            g1, g2, g3 = rotate_back(pose.rotation, state.tangent)
            put_directions(contacts, contour, n1, n2, n3, g1, g2, g3)
        put_ball(contacts, contour, distance - pose.radius, n1, n2, n3)
    scratch.lever[0], scratch.lever[1], scratch.lever[2] = (s[0] + o1, s[1] + o2, s[2] + o3)
    if o1 != 0.0 or o2 != 0.0 or o3 != 0.0:
        _put_slopes(contacts, contour, o1, o2, o3, t1, t2, t3, speed)


@kernel(internal=True)
def _put_slopes(
    contacts: ContactRows,
    contour: int,
    o1: float,
    o2: float,
    o3: float,
    t1: float,
    t2: float,
    t3: float,
    speed: float,
) -> None:
    """What an offset from the curve adds to the rows: sections turn with the tangent, not about it.

    Notes
    -----
    The section turns with ``w = t x s_u' / |s_u|``, so a row along d gains ``d . (w x o) = ((o x d) x t) . s_u' /
    |s_u|``.
    """
    pose, scratch = contacts.poses[contour], contacts.scratch
    scratch.has_slopes = True
    for r in range(3):
        d = scratch.directions[r]
        d1, d2, d3 = rotate_back(pose.rotation, d)
        a1, a2, a3 = cross((o1, o2, o3), (d1, d2, d3))
        e1, e2, e3 = cross((a1, a2, a3), (t1, t2, t3))
        scratch.slopes[r, 0] = e1 / speed
        scratch.slopes[r, 1] = e2 / speed
        scratch.slopes[r, 2] = e3 / speed
