"""Where a search begins that knows nothing: the nearest of samples over the whole contour."""

from __future__ import annotations

import math
from typing import Any

from heavylift.contours.evaluate import curve_point, surface_point
from heavylift.contours.layout import CLOSED_U, CLOSED_V, COUNT_U, COUNT_V, DEGREE_U, DEGREE_V
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.generics import form_controls
from heavylift.solver.contact.kind import (
    AT_U,
    AT_V,
    CONTOUR,
    DIMENSION,
    EVALUATE,
    LEVER,
    OF_GROUND,
    OF_RIGID,
    OWNER,
    RESULT,
    RESULT_END,
    WEIGHTS_AT,
    ContactRows,
)

__all__ = ["find_start"]

A_SPAN = 3
"""Samples a span."""


@kernel(internal=True)
def find_start(contacts: ContactRows, bodies: Any, c: int, y1: float, y2: float, y3: float) -> None:
    """Write the parameters of the nearest sample into the state of a contact."""
    contour = contacts.table[c, CONTOUR]
    row, scratch = contacts.contours[contour], contacts.scratch
    result, evaluate = scratch[RESULT:RESULT_END], scratch[EVALUATE:WEIGHTS_AT]
    if row[OWNER] != OF_RIGID and row[OWNER] != OF_GROUND:
        form_controls(bodies, contacts, contour, 0, row[COUNT_U] - 1, 0, row[COUNT_V] - 1)
    knots, net = contacts.constants, contacts.net
    spans_u = row[COUNT_U] - (0 if row[CLOSED_U] else row[DEGREE_U])
    spans_v = row[COUNT_V] - (0 if row[CLOSED_V] else row[DEGREE_V])
    count_u, count_v = A_SPAN * spans_u, A_SPAN * spans_v
    if row[DIMENSION] == 1:
        count_v = 1
    best = math.inf
    for i in range(count_u):
        u = (i + 0.5) / count_u
        for j in range(count_v):
            v = (j + 0.5) / count_v
            if row[DIMENSION] == 2:
                surface_point(row, knots, knots, net, u, v, evaluate, result)
            else:
                v = 0.0
                curve_point(row, knots, knots, net, u, evaluate, result)
            distance = (result[0] - y1) ** 2 + (result[1] - y2) ** 2 + (result[2] - y3) ** 2
            if distance < best:
                best = distance
                contacts.state[c, AT_U], contacts.state[c, AT_V] = u, v
                for k in range(3):
                    scratch[LEVER + k] = result[k]
