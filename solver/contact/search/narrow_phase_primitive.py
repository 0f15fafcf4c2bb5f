"""A convex primitive on a surface: the deepest or nearest pair of points."""

from __future__ import annotations

from heavylift.contours.splines.search import set_window
from heavylift.contours.splines.search_shape import closest_shape_cold, closest_shape_on_surface, shape_gap
from heavylift.contours.splines.search_step import BORDER, CONVERGED, DEEP, NEED_SPAN, start_search
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import CONVEX, TOO_DEEP, ContactRows
from heavylift.solver.contact.search.directions import form_span
from heavylift.solver.contact.search.features import Primitives, touch
from heavylift.solver.contact.search.search_end import note_search
from heavylift.solver.contact.search.shape_rows import place_shape, put_touch
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(touch, Primitives)
@kernel(internal=True)
def touch_primitive(
    feature: Primitives,
    contacts: ContactRows,
    bodies: Bodies,
    c: int,
    cold: bool,
    y1: float,
    y2: float,
    y3: float,
    work: Workspace,
) -> None:
    """The normal is the direction from the contour to the primitive, as long as its middle is on the outer side."""
    contour = contacts.table[c].contour
    if contacts.table[c].shape_kind != CONVEX:
        return
    row, scratch, state = contacts.contours[contour], contacts.scratch, contacts.state[c]
    result, evaluate = scratch.result, scratch.evaluation
    knots, net = contacts.constants, contacts.net
    kind, shape = contacts.table[c].primitive_kind, scratch.primitive
    place_shape(contacts, c, y1, y2, y3, work)
    if cold:
        samples = contacts.samples
        closest_shape_cold(
            row, knots, knots, net, kind, shape, samples, samples.grids[contour], evaluate, result
        )
        state.u, state.v = result.u, result.v
    u, v = state.u, state.v
    set_window(row, knots, u, v, result)
    start_search(row, u, v, result)
    status = NEED_SPAN
    while status == NEED_SPAN:
        form_span(contacts, bodies, contour, result.span_u, result.span_v)
        status = closest_shape_on_surface(row, knots, knots, net, kind, shape, evaluate, result)
    note_search(contacts, c, status)
    gap, m1, m2, m3, x1, x2, x3, side = shape_gap(kind, shape, result)
    flags = result.flags
    if status == CONVERGED and flags & DEEP:
        state.search = TOO_DEEP
    if side * row.flip > 0.0 and flags & BORDER == 0:  # its middle has gone through
        gap, m1, m2, m3 = -(gap + contacts.values[c].extent), -m1, -m2, -m3
    state.end_gap, state.second_end_gap = gap, 0.0
    put_touch(contacts, c, -m1, -m2, -m3, x1 - y1, x2 - y2, x3 - y3)
