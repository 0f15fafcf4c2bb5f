"""Neutral contours: splines through points of a body, control points linear in its modal coordinates.

"Deformable bodies with complex geometries ... sliding contacts" (2014), section 4.4.1.

``P(q) = N^-1 (x + Phi q)``: with parameters from the undeformed shape the matrix N is constant, so that position,
tangents, velocity and Jacobian of a contour follow from a few control points, and nothing is fitted again in a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.interpolation import (
    Parametrisation,
    control_points,
    interpolation_space,
    parameters_along,
    parameters_averaged,
)
from heavylift.contours.splines.packed_contour import PackedContour
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.contours.splines.spaces import SplineSpace
    from heavylift.numerics.records import Records

__all__ = ["NeutralContour", "neutral_curve", "neutral_surface", "packed"]


@dataclass(frozen=True, eq=False)
class NeutralContour:
    """A spline curve or surface that moves with a body.

    Attributes
    ----------
    spaces
        One of a curve, two of a surface.
    control
        Undeformed control points in the body frame [m], shape (n, 3): row by row, the second direction running faster.
    modal
        Their derivatives by the modal coordinates, shape (nf, n, 3); (0, n, 3) of a rigid body.
    weights
        Rational weights, shape (n,); (0,) of a polynomial contour.

    Raises
    ------
    InputError
        Arrays that do not fit together, or values that are not finite, or weights that are not positive.
    """

    spaces: tuple[SplineSpace, ...]
    control: NDArray[np.float64]
    modal: NDArray[np.float64]
    weights: NDArray[np.float64]

    def __post_init__(self) -> None:
        if len(self.spaces) not in {1, 2}:
            raise InputError(f"{len(self.spaces)} directions of a contour", expected="1 or 2")
        n = int(np.prod(self.counts))
        weighted = np.size(self.weights) > 0
        expected = {
            "control": (n, 3),
            "modal": (len(self.modal), n, 3),
            "weights": (n,) if weighted else (0,),
        }
        for key, shape in expected.items():
            array = np.ascontiguousarray(getattr(self, key), dtype=np.float64)
            if array.shape != shape:
                raise InputError(f"shape {array.shape}", source="contour", key=key, expected=f"shape {shape}")
            if not np.all(np.isfinite(array)):
                raise InputError(
                    "holds a value that is not finite", source="contour", key=key, expected="numbers"
                )
            object.__setattr__(self, key, array)
        if weighted and np.min(self.weights) <= 0.0:
            raise InputError(
                f"{np.min(self.weights):g}", source="contour", key="weights", expected="positive weights"
            )

    @property
    def counts(self) -> tuple[int, ...]:
        """Control points of every direction."""
        return tuple(space.count for space in self.spaces)

    @property
    def is_surface(self) -> bool:
        """Whether it has two directions."""
        return len(self.spaces) == 2

    def deformed(self, coordinates: NDArray[np.float64]) -> NeutralContour:
        """The contour as a rigid one in the shape of some modal coordinates.

        Parameters
        ----------
        coordinates
            Shape (nf,).
        """
        control = self.control + np.tensordot(coordinates, self.modal, axes=1)
        return NeutralContour(self.spaces, control, np.zeros((0, *control.shape)), self.weights)


def _shapes(
    mode_shapes: NDArray[np.float64] | None, points: NDArray[np.float64], source: str
) -> NDArray[np.float64]:
    """Points followed by mode shapes, shape (1 + nf, ...): all are fitted with the same matrix."""
    if not np.all(np.isfinite(points)):
        raise InputError("a point has a coordinate that is not finite", source=source, expected="numbers [m]")
    if mode_shapes is None:
        return points[None]
    shapes = np.asarray(mode_shapes, dtype=np.float64)
    if shapes.shape[1:] != points.shape:
        raise InputError(
            f"mode shapes of shape {shapes.shape}",
            source=source,
            expected=f"shape (modes, {', '.join(map(str, points.shape))})",
        )
    return np.concatenate([points[None], shapes])


def neutral_curve(
    points: NDArray[np.float64],
    *,
    degree: int = 3,
    closed: bool = False,
    parametrisation: Parametrisation = "chord",
    mode_shapes: NDArray[np.float64] | None = None,
    source: str = "contour",
) -> NeutralContour:
    """Curve through points of a body.

    Parameters
    ----------
    points
        Undeformed, in order, body frame [m], shape (k, 3).
    degree
        Of the spline; a contour that something slides along needs 3.
    closed
        The first point follows upon the last; it does not stand again at the end.
    parametrisation
        Parameters of the points: by ``"chord"`` length, its root (``"centripetal"``) or ``"uniform"``.
    mode_shapes
        Displacements of the points per unit modal coordinate, shape (nf, k, 3); none of a rigid body.
    source
        Name of the contour, for messages.

    Returns
    -------
    NeutralContour
        Passes exactly through the points of any deformed shape.

    Raises
    ------
    InputError
        Arrays of other shapes, too few points, neighbours in one place.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"points of shape {points.shape}", source=source, expected="shape (k, 3)")
    shapes = _shapes(mode_shapes, points, source)
    parameters = parameters_along(points, parametrisation, closed, source)
    space, parameters = interpolation_space(parameters, degree, closed, source)
    control = control_points(space, parameters, shapes, 1, source)
    return NeutralContour((space,), control[0], control[1:], np.empty(0))


def neutral_surface(
    points: NDArray[np.float64],
    *,
    degrees: tuple[int, int] = (3, 3),
    closed: tuple[bool, bool] = (False, False),
    parametrisation: Parametrisation = "chord",
    mode_shapes: NDArray[np.float64] | None = None,
    source: str = "contour",
) -> NeutralContour:
    """Surface through a grid of points of a body.

    Parameters
    ----------
    points
        Undeformed, body frame [m], shape (a, b, 3); the normal is (first direction) x (second direction).
    degrees, closed
        Of both directions; see `neutral_curve`.
    parametrisation
        See `neutral_curve`; parameters are averaged over rows and over columns.
    mode_shapes
        Displacements of the points per unit modal coordinate, shape (nf, a, b, 3); none of a rigid body.
    source
        Name of the contour, for messages.

    Returns
    -------
    NeutralContour
        Passes exactly through the points of any deformed shape.

    Raises
    ------
    InputError
        Arrays of other shapes, too few points, lines of points on each other.
    """
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 3 or points.shape[2] != 3:
        raise InputError(f"points of shape {points.shape}", source=source, expected="shape (a, b, 3)")
    control = _shapes(mode_shapes, points, source)
    spaces = []
    for axis, lines in enumerate((points.transpose(1, 0, 2), points)):
        where = f"{source}, {('first', 'second')[axis]} direction"
        # too few points are the plainer mistake
        if points.shape[axis] <= degrees[axis]:
            interpolation_space(np.linspace(0.0, 1.0, points.shape[axis]), degrees[axis], closed[axis], where)
        parameters = parameters_averaged(lines, parametrisation, closed[axis], where)
        space, parameters = interpolation_space(parameters, degrees[axis], closed[axis], where)
        control = control_points(space, parameters, control, 1 + axis, where)
        spaces.append(space)
    flat = control.reshape(len(control), -1, 3)
    return NeutralContour(tuple(spaces), flat[0], flat[1:], np.empty(0))


def packed(
    contours: Sequence[NeutralContour],
) -> tuple[Records[PackedContour], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Contours as arrays for kernels.

    Parameters
    ----------
    contours
        Any number.

    Returns
    -------
    tuple
        Records of the contours, shape (n,); knots of all; rational weights of those that
        have any; undeformed control points of all [m], shape (points, 3).
    """
    table = records(PackedContour, len(contours))
    knots: list[NDArray[np.float64]] = []
    weights: list[NDArray[np.float64]] = []
    knot_count = weight_count = point_count = 0
    for row, contour in zip(table, contours, strict=True):
        for direction, space in zip((row.u, row.v), contour.spaces, strict=False):
            direction.degree, direction.count, direction.closed = space.degree, space.count, space.closed
            direction.first_knot = knot_count
            knots.append(space.knots)
            knot_count += space.knots.size
        if not contour.is_surface:
            row.v.count, row.v.first_knot = 1, knot_count
        row.first_control = point_count
        row.first_weight = weight_count if contour.weights.size else -1
        weights.append(contour.weights)
        weight_count += contour.weights.size
        point_count += len(contour.control)
    net = np.concatenate([np.zeros((0, 3)), *(contour.control for contour in contours)])
    return table, np.concatenate([np.empty(0), *knots]), np.concatenate([np.empty(0), *weights]), net
