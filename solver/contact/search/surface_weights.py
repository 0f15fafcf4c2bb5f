"""Control points under a contact on a surface that deforms, and their weights."""

from __future__ import annotations

from heavylift.contours.splines.evaluate import surface_weights
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.search.features import SurfaceWeights, weigh
from heavylift.solver.interface import Bodies
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(weigh, SurfaceWeights)
@kernel(internal=True)
def weigh_surface(
    feature: SurfaceWeights, contacts: ContactRows, bodies: Bodies, c: int, y1: float, y2: float, y3: float
) -> None:
    """Control points of the span, and their weights."""
    contour = contacts.table[c].contour
    if contacts.contours[contour].dimension == 2 and contacts.values[c].footprint == 0.0:
        row, scratch = contacts.contours[contour], contacts.scratch
        result, evaluate = scratch.result, scratch.evaluation
        knots = contacts.constants
        contacts.counts.controls = surface_weights(
            row, knots, knots, result.u, result.v, evaluate, contacts.places, scratch.weights
        )
