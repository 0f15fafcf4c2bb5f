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
    row, samples, net = contacts.contours[contour], contacts.samples, contacts.net
    if row.owner in (OF_RIGID, OF_GROUND):
        return
    form_controls(bodies, contacts, contour, 0, row.u.count - 1, 0, row.v.count - 1)
    grid = samples.grids[contour]
    i, j, at = grid.first_u, grid.first_v, grid.points
    m, n = i + grid.count_u, j + grid.count_v
    samples.reach[contour] = sample_points(
        row,
        contacts.constants,
        net,
        samples.first[i:m],
        samples.first[j:n],
        samples.basis[i:m],
        samples.basis[j:n],
        samples.across,
        samples.points[at : at + 3],
    )


@kernel(internal=True)
def start_at_point(contacts: ContactRows, c: int, y1: float, y2: float, y3: float) -> None:
    """Nearest point of a curve or surface to a point in its axes [m], into the state of a contact."""
    contour = contacts.table[c].contour
    samples, scratch, state = contacts.samples, contacts.scratch, contacts.state[c]
    result, evaluate = scratch.result, scratch.evaluation
    grid = samples.grids[contour]
    i, j, at = grid.first_u, grid.first_v, grid.points
    closest_point_cold(
        contacts.contours[contour],
        contacts.constants,
        contacts.constants,
        contacts.net,
        y1,
        y2,
        y3,
        samples.parameters[i : i + grid.count_u],
        samples.parameters[j : j + grid.count_v],
        samples.points[at : at + 3],
        samples.reach[contour],
        0.0,
        samples.distances,
        evaluate,
        result,
    )
    state.u, state.v = result.u, result.v
