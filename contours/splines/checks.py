"""What a contour must be for something to touch it: smooth, unfolded, with its normal out of the material.

The side of a surface on which the material is follows from the other nodes of the body.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.derivatives import evaluate_contour, sample_grid
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.neutral import NeutralContour

__all__ = [
    "SMALLEST_DEGREE",
    "check_contour",
    "check_degree",
    "check_folding",
    "check_kinks",
    "check_outward",
    "inward_share",
]

SMALLEST_DEGREE = 3
"""Of a contour that something touches: curvature is continuous from degree 3 on."""

PER_PIECE = 4
"""Samples of a polynomial piece in each direction."""

VANISHING = 1e-9
"""Of the largest value on the contour: a tangent or normal that is none."""

LARGEST_KINK = 1e-6
"""Sine of the angle between the tangents on both sides of a knot."""

MOST_SAMPLES = 400
"""Points at which the side of the material is looked for."""

CLEARLY_SMALLER = 1.5
"""Ratio of the largest empty balls on both sides from which the smaller one tells the material."""


def check_contour(
    contour: NeutralContour,
    *,
    flip: bool = False,
    interior: NDArray[np.float64] | None = None,
    nodes: NDArray[np.float64] | None = None,
    source: str = "contour",
) -> None:
    """All checks of a contact contour in its undeformed shape.

    Parameters
    ----------
    contour
        A curve or surface.
    flip
        The normal of a surface is ``S_v x S_u``.
    interior
        A point within the material, body frame [m], shape (3,).
    nodes
        Of the body [m], shape (n, 3), to find out where the material is.
    source
        Name of the contour, for messages.

    Raises
    ------
    InputError
        The first check that fails.
    """
    check_degree(contour, source)
    check_kinks(contour, source)
    check_folding(contour, source)
    if contour.is_surface and (interior is not None or nodes is not None):
        check_outward(contour, flip=flip, interior=interior, nodes=nodes, source=source)


def check_degree(contour: NeutralContour, source: str = "contour") -> None:
    """Refuse a degree below 3: its curvature jumps at every knot.

    Raises
    ------
    InputError
        Names the degree.
    """
    for axis, space in enumerate(contour.spaces):
        if space.degree < SMALLEST_DEGREE:
            raise InputError(
                f"degree {space.degree}{_direction(contour, axis)}: a body that slides along it gets an impulse at"
                " every knot",
                source=source,
                key="degree",
                expected=f"at least {SMALLEST_DEGREE} for a contact contour",
            )


def check_kinks(contour: NeutralContour, source: str = "contour") -> None:
    """Refuse a contour that bends sharply at a knot which stands as often as the degree, as imported ones may.

    Raises
    ------
    InputError
        Names the parameter.
    """
    for axis, space in enumerate(contour.spaces):
        inside = space.knots[1:-1] if space.closed else space.knots[space.degree + 1 : -space.degree - 1]
        values, times = np.unique(inside[(inside >= 0.0) & (inside < 1.0)], return_counts=True)
        for knot in values[times >= space.degree]:
            across = [other.samples(PER_PIECE) for k, other in enumerate(contour.spaces) if k != axis]
            rows = across[0] if across else np.zeros(1)
            at = np.zeros((2, len(rows), len(contour.spaces)))
            at[0, :, axis] = (1.0 if knot == 0.0 else knot) - 1e-14
            at[1, :, axis] = knot
            if across:
                at[:, :, 1 - axis] = rows
            values_at = evaluate_contour(contour, at.reshape(-1, len(contour.spaces)))
            tangents = values_at.reshape(2, len(rows), 6, 3)[:, :, 1 + axis]
            before, after = (side / np.linalg.norm(side, axis=1, keepdims=True) for side in tangents)
            sine = np.linalg.norm(np.cross(before, after), axis=1)
            sine = np.where(np.sum(before * after, axis=1) < 0.0, 1.0, sine)
            if np.max(sine) > LARGEST_KINK:
                raise InputError(
                    f"has a kink of {np.degrees(np.arcsin(min(np.max(sine), 1.0))):.3g} degrees at parameter {knot:g}"
                    f"{_direction(contour, axis)}",
                    source=source,
                    expected="a smooth contour; split it there into two",
                )


def check_folding(
    contour: NeutralContour, source: str = "contour", coordinates: NDArray[np.float64] | None = None
) -> None:
    """Refuse a contour that folds upon itself: its normal vanishes, or turns by more than 90 degrees between samples.

    Parameters
    ----------
    contour
        A curve, whose tangent is looked at in place of the normal, or a surface.
    source
        Name of the contour, for messages.
    coordinates
        Modal coordinates; the undeformed shape if absent.

    Raises
    ------
    InputError
        Names the parameters.
    """
    parameters, values = sample_grid(contour, PER_PIECE, coordinates)
    if contour.is_surface:
        words = "normal"
        vectors = np.cross(values[..., 1, :], values[..., 2, :])
        # lengths of the tangents, so that long thin pieces are no fold
        scale = np.linalg.norm(values[..., 1, :], axis=-1) * np.linalg.norm(values[..., 2, :], axis=-1)
        scale = np.maximum(scale, np.max(scale) * VANISHING)
    else:
        words = "tangent"
        vectors = values[..., 1, :]
        scale = np.full(vectors.shape[:-1], np.max(np.linalg.norm(vectors, axis=-1)))
    lengths = np.linalg.norm(vectors, axis=-1)
    vanishing = np.argwhere(lengths <= VANISHING * scale)
    if len(vanishing):
        raise InputError(
            f"its {words} vanishes at {_at(parameters[tuple(vanishing[0])])}: the points lie on each other there, "
            f"or in the order of a fold",
            source=source,
            expected="points in the order in which they lie on the body",
        )
    units = vectors / lengths[..., None]
    for axis, space in enumerate(contour.spaces):
        following = np.roll(units, -1, axis=axis)
        turned = np.sum(units * following, axis=-1) < 0.0
        if not space.closed:
            turned = np.delete(turned, -1, axis=axis)
        bad = np.argwhere(turned)
        if len(bad):
            raise InputError(
                f"folds upon itself: its {words} turns by more than 90 degrees{_direction(contour, axis)} after "
                f"{_at(parameters[tuple(bad[0])])}",
                source=source,
                expected="points in the order in which they lie on the body, or more of them in a sharp bend",
            )


def check_outward(
    contour: NeutralContour,
    *,
    flip: bool = False,
    interior: NDArray[np.float64] | None = None,
    nodes: NDArray[np.float64] | None = None,
    source: str = "contour",
) -> None:
    """Refuse a surface whose normal points into the material.

    Parameters
    ----------
    contour
        A surface.
    flip
        The normal is ``S_v x S_u``.
    interior
        A point within the material [m], shape (3,): seen from the nearest sample it must lie behind the surface.
    nodes
        Of the body [m], shape (n, 3): most samples must have the nearest material behind them. Not asked if the
        interior point is given.
    source
        Name of the contour, for messages.

    Raises
    ------
    InputError
        Says so, and offers the flip.
    """
    _, values = sample_grid(contour, PER_PIECE)
    values = values.reshape(-1, 6, 3)
    points = values[:, 0]
    normals = np.cross(values[:, 1], values[:, 2])
    normals *= (-1.0 if flip else 1.0) / np.linalg.norm(normals, axis=1, keepdims=True)
    if interior is not None:
        way = np.asarray(interior, dtype=np.float64) - points
        nearest = int(np.argmin(np.linalg.norm(way, axis=1)))
        inward = float(np.dot(way[nearest], normals[nearest])) > 0.0
        words = f"towards the point {np.asarray(interior).tolist()} m within it"
    elif nodes is not None:
        some = slice(None, None, max(1, len(points) // MOST_SAMPLES))
        out, into = inward_share(points[some], normals[some], nodes)
        inward = into > out
        words = f"at {100.0 * into:.0f} % of its samples"
    else:
        return
    if inward:
        raise InputError(
            f"its normal points into the body, {words}",
            source=source,
            key="flip",
            expected=f"flip = {'false' if flip else 'true'}, or rows in the opposite order",
        )


def _direction(contour: NeutralContour, axis: int) -> str:
    """Words for one of two directions."""
    return f" in the {('first', 'second')[axis]} direction" if contour.is_surface else ""


def _at(parameters: NDArray[np.float64]) -> str:
    return ", ".join(f"{name} = {value:.4g}" for name, value in zip("uv", parameters, strict=False))


def inward_share(
    points: NDArray[np.float64], normals: NDArray[np.float64], nodes: NDArray[np.float64]
) -> tuple[float, float]:
    """Shares of points of a surface whose normal points out of, and into, the material.

    At every point a ball that touches the surface there grows on either side until it meets a node: one of diameter
    ``r^2 / h`` meets a node at the distance r and the height h. In the material it meets one soon, outside late (of a
    hollow, on its other side) or never. A point with balls of about one size has no say.

    Parameters
    ----------
    points, normals
        Of the surface, shape (k, 3) [m] and unit vectors.
    nodes
        Of the body, shape (n, 3).

    Returns
    -------
    tuple
        Outward and inward share; what is missing to 1 is undecided.
    """
    outward = inward = 0
    for point, normal in zip(points, normals, strict=True):
        way = nodes - point
        square = np.sum(way * way, axis=1)
        away = square > 0.0
        # inverse diameters: finite for nodes in the tangent plane
        height = (way[away] @ normal) / square[away]
        before = np.max(height, initial=0.0)
        behind = -np.min(height, initial=0.0)
        if behind > CLEARLY_SMALLER * before:
            outward += 1
        elif before > CLEARLY_SMALLER * behind:
            inward += 1
    return outward / len(points), inward / len(points)
