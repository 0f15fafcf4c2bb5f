"""A point or ball on a surface: search, gap, rows, and the control points under it."""

from __future__ import annotations

import math

from heavylift.contours.splines.search import closest_on_surface, set_window
from heavylift.contours.splines.search_step import BORDER, NEED_SPAN, start_search
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross
from heavylift.solver.contact.kind import BILATERAL, POINT, ContactRows
from heavylift.solver.contact.search.directions import form_span, put_ball, put_directions
from heavylift.solver.contact.search.features import Surfaces, touch
from heavylift.solver.contact.search.search_end import note_search
from heavylift.solver.contact.search.search_start import start_at_point
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []

OFF = 1e-7
"""Distance beside the patch relative to the size of the contact, from which on a contact is beyond its border."""


@implement(touch, Surfaces)
@kernel(internal=True)
def touch_surface(
    feature: Surfaces,
    contacts: ContactRows,
    bodies: Bodies,
    c: int,
    cold: bool,
    y1: float,
    y2: float,
    y3: float,
    work: Workspace,
) -> None:
    """Beyond the border a ball touches the edge, and a point nothing."""
    contour = contacts.table[c].contour
    if contacts.table[c].shape_kind == POINT and contacts.contours[contour].dimension == 2:
        if cold:
            start_at_point(contacts, c, y1, y2, y3)
        status = _find_point(contacts, bodies, contour, contacts.state[c].u, contacts.state[c].v, y1, y2, y3)
        note_search(contacts, c, status)
        _put_touch(contacts, c, y1, y2, y3)


@kernel(internal=True)
def _find_point(
    contacts: ContactRows, bodies: Bodies, contour: int, u: float, v: float, y1: float, y2: float, y3: float
) -> int:
    """Nearest point; control points are formed span by span as the search asks for them."""
    row, scratch = contacts.contours[contour], contacts.scratch
    result, evaluate = scratch.result, scratch.evaluation
    knots, net = contacts.constants, contacts.net
    set_window(row, knots, u, v, result)
    start_search(row, u, v, result)
    status = NEED_SPAN
    while status == NEED_SPAN:
        form_span(contacts, bodies, contour, result.span_u, result.span_v)
        status = closest_on_surface(row, knots, knots, net, (y1, y2, y3), evaluate, result)
    return status


@kernel(internal=True)
def _put_touch(contacts: ContactRows, c: int, y1: float, y2: float, y3: float) -> None:
    """Gap, directions, lever and arm from the nearest point."""
    contour = contacts.table[c].contour
    scratch, state = contacts.scratch, contacts.state[c]
    result = scratch.result
    s, along, across = result.position, result.tangent_u, result.tangent_v
    n1, n2, n3 = cross(along, across)
    size = contacts.contours[contour].flip / math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
    n1, n2, n3 = size * n1, size * n2, size * n3
    d1, d2, d3 = y1 - s[0], y2 - s[1], y3 - s[2]
    gap = n1 * d1 + n2 * d2 + n3 * d3
    radius = contacts.values[c].radius
    if result.flags & BORDER and contacts.table[c].law != BILATERAL:
        distance = math.sqrt(d1 * d1 + d2 * d2 + d3 * d3)
        beside = math.sqrt(max(0.0, distance * distance - gap * gap))
        if beside > OFF * contacts.values[c].length_scale:
            gap = distance
            if radius > 0.0:
                n1, n2, n3 = d1 / distance, d2 / distance, d3 / distance
    state.end_gap, state.second_end_gap = gap - radius, 0.0
    a = 1.0 / math.sqrt(along[0] ** 2 + along[1] ** 2 + along[2] ** 2)
    t1, t2, t3 = a * along[0], a * along[1], a * along[2]
    share = t1 * n1 + t2 * n2 + t3 * n3
    if share != 0.0:
        if abs(share) > 0.9:  # at an edge the normal may lie along the first direction
            a = 1.0 / math.sqrt(across[0] ** 2 + across[1] ** 2 + across[2] ** 2)
            t1, t2, t3 = a * across[0], a * across[1], a * across[2]
            share = t1 * n1 + t2 * n2 + t3 * n3
        t1, t2, t3 = t1 - share * n1, t2 - share * n2, t3 - share * n3
        a = 1.0 / math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
        t1, t2, t3 = a * t1, a * t2, a * t3
    put_directions(contacts, contour, n1, n2, n3, t1, t2, t3)
    put_ball(contacts, contour, gap, n1, n2, n3)
    for k in range(3):
        scratch.lever[k] = s[k]
