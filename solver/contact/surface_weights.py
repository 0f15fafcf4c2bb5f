"""Control points under a contact on a surface that deforms, and their weights."""

from __future__ import annotations

from heavylift.contours.evaluate import surface_weights
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.features import SurfaceWeights, weigh
from heavylift.solver.contact.kind import (
    CONTOUR,
    CONTROL_COUNT,
    EVALUATE,
    FOOTPRINT,
    LARGEST_CONTROLS,
    RESULT,
    WEIGHTS_AT,
    ContactRows,
    search_at,
)
from heavylift.solver.interface import Bodies
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(weigh, SurfaceWeights)
@kernel(internal=True)
def weigh_surface(
    feature: SurfaceWeights, contacts: ContactRows, bodies: Bodies, c: int, y1: float, y2: float, y3: float
) -> None:
    """Control points of the span, and their weights."""
    contour = contacts.table[c, CONTOUR]
    if contacts.contours[contour].dimension == 2 and contacts.values[c, FOOTPRINT] == 0.0:
        row, scratch = contacts.contours[contour], contacts.scratch
        result, evaluate = search_at(scratch, RESULT), scratch[EVALUATE:WEIGHTS_AT]
        weights = scratch[WEIGHTS_AT : WEIGHTS_AT + LARGEST_CONTROLS]
        knots = contacts.constants
        contacts.places[CONTROL_COUNT] = surface_weights(
            row, knots, knots, result.u, result.v, evaluate, contacts.places, weights
        )
