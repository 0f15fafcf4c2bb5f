"""What nothing can touch: low degrees, kinks, folds, normals into the body."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.splines.checks import (
    check_contour,
    check_degree,
    check_folding,
    check_kinks,
    check_outward,
)
from heavylift.contours.splines.imported import imported_contour
from heavylift.contours.splines.neutral import neutral_curve, neutral_surface
from heavylift.numerics.outcome import InputError


def tube(inner: bool = False, count: int = 16, radius: float = 0.5) -> np.ndarray:
    """Rings of points on a cylinder about x."""
    angle = 2.0 * np.pi * np.arange(count) / count
    x = np.linspace(0.0, 2.0, 7)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * radius
    points = np.concatenate(
        [np.tile(x[None, :, None], (count, 1, 1)), np.tile(ring[:, None], (1, 7, 1))], axis=-1
    )
    return points[::-1] if inner else points


def test_sound_contours_pass() -> None:
    surface = neutral_surface(tube(), closed=(True, False))
    check_contour(surface, interior=np.array([1.0, 0.0, 0.0]))
    angle = np.linspace(0.0, 1.9 * np.pi, 20)
    check_contour(neutral_curve(np.column_stack([np.cos(angle), np.sin(angle), angle])))


def test_degree_below_three() -> None:
    with pytest.raises(InputError, match=r"degree 2 in the second direction.*expected at least 3"):
        check_degree(neutral_surface(tube(), degrees=(3, 2), closed=(True, False)))
    with pytest.raises(InputError, match=r"ring: degree: degree 2: a body that slides along it"):
        check_contour(neutral_curve(tube()[:, 0], degree=2, closed=True), source="ring")


def test_kink_at_a_knot_of_full_multiplicity() -> None:
    knots = np.array([0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2], float)
    net = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0], [5, 0, 0], [6, 0, 0]], float)
    check_kinks(imported_contour([knots], net, [3]))
    net[4:, 1] = [1.0, 2.0, 3.0]
    with pytest.raises(InputError, match=r"has a kink of 45 degrees at parameter 0.5"):
        check_kinks(imported_contour([knots], net, [3]))
    lines = np.stack([net, *(net + np.array([0, 0, z]) for z in (1, 2, 3))])
    across = np.array([0, 0, 0, 0, 1, 1, 1, 1], float)
    with pytest.raises(InputError, match=r"kink of 45 degrees at parameter 0.5 in the second direction"):
        check_kinks(imported_contour([across, knots], lines, [3, 3]))


def test_a_drop_closed_at_its_tip_has_a_kink_there() -> None:
    knots = np.array([0, 0, 0, 0, 1, 2, 2, 2, 2], float)
    net = np.array([[0, 0, 0], [1, 1, 0], [3, 0, 0], [1, -1, 0], [0, 0, 0]], float)
    check_kinks(imported_contour([knots], net, [3]))
    with pytest.raises(InputError, match=r"kink of 90 degrees at parameter 0"):
        check_kinks(imported_contour([knots], net, [3], closed=[True]))


def test_folded_surface() -> None:
    flat = np.stack(np.meshgrid(np.arange(6.0), np.arange(5.0), [0.0], indexing="ij"), axis=-1)[:, :, 0]
    check_folding(neutral_surface(flat))
    swapped = flat[[0, 1, 3, 2, 4, 5]]
    with pytest.raises(
        InputError, match=r"folds upon itself: its normal turns by more than 90 degrees in the first"
    ):
        check_folding(neutral_surface(swapped, source="deck"), "deck")
    crossed = flat.copy()
    crossed[3] = crossed[3, ::-1]
    with pytest.raises(InputError, match=r"folds upon itself|vanishes"):
        check_folding(neutral_surface(crossed))


def test_pole_of_a_surface_has_no_normal() -> None:
    cap = tube()[:, :, [1, 2, 0]] * np.linspace(0.0, 1.0, 7)[None, :, None]
    with pytest.raises(InputError, match=r"its normal vanishes at u = 0, v = 0"):
        check_folding(neutral_surface(cap, closed=(True, False)))


def test_curve_that_turns_back() -> None:
    line = np.column_stack([[0.0, 1.0, 2.0, 3.0, 2.0, 1.0], np.zeros(6), np.zeros(6)])
    with pytest.raises(InputError, match=r"its tangent (turns by more than 90|vanishes)"):
        check_folding(neutral_curve(line, parametrisation="uniform"))


def test_a_sound_shape_folds_when_its_modes_are_large() -> None:
    flat = np.stack(np.meshgrid(np.arange(6.0), np.arange(5.0), [0.0], indexing="ij"), axis=-1)[:, :, 0]
    shape = np.zeros((1, 6, 5, 3))
    shape[0, 3, :, 0] = -1.0
    surface = neutral_surface(flat, mode_shapes=shape)
    check_folding(surface, coordinates=np.array([0.2]))
    with pytest.raises(InputError, match=r"folds upon itself"):
        check_folding(surface, coordinates=np.array([2.5]))


def thick_tube() -> np.ndarray:
    return np.concatenate([tube(radius=r).reshape(-1, 3) for r in (0.5, 0.4, 0.3)])


@pytest.mark.parametrize(("radius", "reverse"), [(0.5, False), (0.3, True)])
def test_normals_of_a_pipe_outside_and_inside(radius: float, reverse: bool) -> None:
    # the material of the inner surface lies around it, so that the middle of the pipe is no interior point
    points = tube(reverse, radius=radius)
    right = neutral_surface(points, closed=(True, False))
    wrong = neutral_surface(points[::-1], closed=(True, False))
    check_outward(right, nodes=thick_tube())
    check_outward(wrong, nodes=thick_tube(), flip=True)
    with pytest.raises(
        InputError, match=r"flip: its normal points into the body, at 1?\d\d % of .* flip = true"
    ):
        check_outward(wrong, nodes=thick_tube())
    with pytest.raises(InputError, match=r"flip = false"):
        check_outward(right, nodes=thick_tube(), flip=True)
    with pytest.raises(InputError, match=r"into the body, towards the point \[1.0, 0.4, 0.0\] m within it"):
        check_outward(wrong, interior=np.array([1.0, 0.4, 0.0]))
