"""Searches that know nothing begin at samples of the whole contour and end at the nearest of several minima."""

from __future__ import annotations

from heavylift.contours.splines.samples import sample_points
from heavylift.contours.splines.search_cold import closest_point_cold
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.interface import form_controls
from heavylift.solver.contact.kind import OF_GROUND, OF_RIGID, ContactRows
from heavylift.solver.contact.search.features import Deforming, touch
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__ = ["start_at_point"]


@implement(touch, Deforming)
@kernel(internal=True)
def sample_deforming(
    feature: Deforming,
    contacts: ContactRows,
    bodies: Bodies,
    c: int,
    cold: bool,
    y1: float,
    y2: float,
    y3: float,
    work: Workspace,
) -> None:
    """Before a cold search all control points, then the samples; those of rigid contours stand still."""
    if not cold:
        return
    contour = contacts.table[c].contour
    row, samples = contacts.contours[contour], contacts.samples
    if row.owner in (OF_RIGID, OF_GROUND):
        return
    form_controls(bodies, contacts, contour, 0, row.u.count - 1, 0, row.v.count - 1)
    sample_points(row, contacts.constants, contacts.net, samples, samples.grids[contour])


@kernel(internal=True)
def start_at_point(contacts: ContactRows, c: int, y1: float, y2: float, y3: float) -> None:
    """Nearest point of a curve or surface to a point in its axes [m], into the state of a contact."""
    contour = contacts.table[c].contour
    row, knots, net = contacts.contours[contour], contacts.constants, contacts.net
    samples, scratch, state = contacts.samples, contacts.scratch, contacts.state[c]
    result, evaluate, grid = scratch.result, scratch.evaluation, samples.grids[contour]
    closest_point_cold(row, knots, knots, net, (y1, y2, y3), samples, grid, evaluate, result)
    state.u, state.v = result.u, result.v
