"""A thin ring on a surface: the point of the ring with the least gap."""

from __future__ import annotations

import math

from heavylift.contours.splines.search import set_window, signed_gap
from heavylift.contours.splines.search_circle import ring_cold, ring_on_surface, ring_point, start_ring
from heavylift.contours.splines.search_step import BORDER, CONVERGED, NEED_SPAN
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import CIRCLE, ContactRows
from heavylift.solver.contact.search.directions import form_span
from heavylift.solver.contact.search.features import Rings, touch
from heavylift.solver.contact.search.search_end import note_search
from heavylift.solver.contact.search.shape_rows import place_shape, put_touch
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []

OFF = 1e-7
"""Distance beside the patch relative to the size of the ring, from which on it passes beyond the border."""


@implement(touch, Rings)
@kernel(internal=True)
def touch_ring(
    feature: Rings,
    contacts: ContactRows,
    bodies: Bodies,
    c: int,
    cold: bool,
    y1: float,
    y2: float,
    y3: float,
    work: Workspace,
) -> None:
    """The angle on the ring is carried as the second gap of the contact."""
    contour = contacts.table[c].contour
    if contacts.table[c].shape_kind != CIRCLE:
        return
    row, scratch, state = contacts.contours[contour], contacts.scratch, contacts.state[c]
    result, evaluate = scratch.result, scratch.evaluation
    knots, net = contacts.constants, contacts.net
    shape = scratch.primitive
    place_shape(contacts, c, y1, y2, y3, work)
    if cold:
        samples = contacts.samples
        ring_cold(row, knots, knots, net, shape, samples, samples.grids[contour], evaluate, result)
        state.u, state.v, state.second_end_gap = result.u, result.v, result.ring.angle
    u, v = state.u, state.v
    set_window(row, knots, u, v, result)
    start_ring(row, u, v, state.second_end_gap, result)
    status = NEED_SPAN
    while status == NEED_SPAN:
        form_span(contacts, bodies, contour, result.span_u, result.span_v)
        status = ring_on_surface(row, knots, knots, net, shape, evaluate, result)
    note_search(contacts, c, status)
    if status != CONVERGED:
        result.ring.angle = state.second_end_gap
    r1, r2, r3, _, _, _ = ring_point(shape, result.ring.angle)
    gap, n1, n2, n3 = signed_gap(y1 + r1, y2 + r2, y3 + r3, result)
    flip, rounding = row.flip, shape.radius
    n1, n2, n3 = flip * n1, flip * n2, flip * n3
    gap *= flip
    if result.flags & BORDER:
        distance = math.sqrt(result.squared_distance)
        if distance * distance - gap * gap > (OFF * contacts.values[c].length_scale) ** 2:
            gap = distance
    state.end_gap, state.second_end_gap = gap - rounding, result.ring.angle
    put_touch(contacts, c, n1, n2, n3, r1 - rounding * n1, r2 - rounding * n2, r3 - rounding * n3)
