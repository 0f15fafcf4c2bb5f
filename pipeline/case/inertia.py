"""Inertia of a rigid body in a case file: three principal values or a symmetric matrix."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from heavylift.pipeline.case.fields import Quantity, quantity_schema, reject

__all__ = ["Inertia", "Matrix3"]

Row = tuple[float, float, float]
Matrix3 = tuple[Row, Row, Row]

_EXPECTED = "three principal values, or a symmetric 3 x 3 matrix, of a body that can exist"


def parse_inertia(value: Any) -> Matrix3:
    """Inertia tensor [kg m^2] about the centre of mass, body axes.

    Notes
    -----
    A mass distribution exists for a symmetric matrix J if and only if ``1/2 tr(J) I - J``, the second
    moments of the mass, is positive semi-definite: then the principal values are positive and none exceeds
    the sum of the other two. Sylvester's criterion on the principal minors decides both.
    """
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        reject(f"{value!r}", _EXPECTED)
    quantity = Quantity("moment of inertia")
    if all(isinstance(row, (list, tuple)) for row in value):
        if any(len(row) != 3 for row in value):
            reject(f"{value!r}", _EXPECTED)
        matrix = [[quantity.parse(entry) for entry in row] for row in value]
    else:
        diagonal = [quantity.parse(entry) for entry in value]
        matrix = [[diagonal[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
    scale = max(abs(entry) for row in matrix for entry in row)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if abs(matrix[i][j] - matrix[j][i]) > 1e-9 * scale:
            reject(
                f"entries {i}{j} and {j}{i} differ: {matrix[i][j]:g} and {matrix[j][i]:g} kg m^2", _EXPECTED
            )
    if not _minors_positive(matrix, 0.0):
        reject(f"inertia {value!r} is not positive definite", _EXPECTED)
    trace = sum(matrix[i][i] for i in range(3))
    moments = [[(0.5 * trace if i == j else 0.0) - matrix[i][j] for j in range(3)] for i in range(3)]
    if not _minors_positive(moments, -1e-9):
        reject(f"in inertia {value!r} one principal value exceeds the sum of the others", _EXPECTED)
    return tuple(tuple(row) for row in matrix)  # type: ignore[return-value]


def _minors_positive(m: list[list[float]], tolerance: float) -> bool:
    """Whether all seven principal minors, relative to the trace, exceed a tolerance."""
    trace = sum(abs(m[i][i]) for i in range(3))
    if trace == 0.0 or not math.isfinite(trace):
        return False
    a = [[entry / trace for entry in row] for row in m]
    singles = [a[i][i] for i in range(3)]
    pairs = [a[i][i] * a[j][j] - a[i][j] * a[j][i] for i, j in ((0, 1), (0, 2), (1, 2))]
    determinant = (
        a[0][0] * pairs[2]
        - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
        + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
    )
    return all(minor > tolerance for minor in (*singles, *pairs, determinant))


_TRIPLE = {"type": "array", "items": quantity_schema(), "minItems": 3, "maxItems": 3}

Inertia = Annotated[
    Matrix3,
    BeforeValidator(parse_inertia),
    WithJsonSchema({"anyOf": [_TRIPLE, {"type": "array", "items": _TRIPLE, "minItems": 3, "maxItems": 3}]}),
]
"""Type of the field: validates to a 3 x 3 tuple [kg m^2]."""
