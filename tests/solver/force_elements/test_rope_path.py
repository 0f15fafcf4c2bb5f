"""Length of rope paths: closed forms, and derivatives against differences for random paths with pulleys."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heavylift.numerics.records import records
from heavylift.solver.force_elements.rope_path import START_WRAP, PlaceGradient, RopePlace, path_length


def length_and_gradient(places: np.ndarray, wraps: np.ndarray) -> tuple[float, np.ndarray]:
    """Of places with rows of centre, axis and radius; the gradient by centre and axis."""
    path, gradient = records(RopePlace, len(places)), records(PlaceGradient, len(places))
    path.view(np.float64)[:] = places.ravel()
    found = path_length(path, gradient, wraps)
    return found, gradient.view(np.float64).reshape(-1, 6)


def length(places: np.ndarray, wraps: np.ndarray | None = None) -> float:
    wraps = np.full(len(places), START_WRAP) if wraps is None else wraps.copy()
    return length_and_gradient(places, wraps)[0]


def place(
    centre: tuple[float, float, float], radius: float = 0.0, axis: tuple[float, float, float] = (0, 0, 1)
) -> list[float]:
    return [*centre, *(np.array(axis) / np.linalg.norm(axis)), radius]


def test_half_a_turn_over_a_pulley() -> None:
    r = 0.4
    over = np.array([place((-r, -3.0, 0)), place((0, 0, 0), r, (0, 0, -1)), place((r, -5.0, 0))])
    assert length(over) == pytest.approx(3.0 + 5.0 + math.pi * r, rel=1e-14)


def test_open_and_crossed_belts() -> None:
    """Tangents of two circles: sqrt(d^2 - (r1 -+ r2)^2), and the arcs that belong to them."""
    d, r1, r2 = 4.0, 0.7, 0.3
    for sense in (1.0, -1.0):
        places = np.array(
            [
                place((r1, -3.0, 0)),
                place((0, 0, 0), r1, (0, 0, 1)),
                place((-d, 0, 0), r2, (0, 0, sense)),
                place((-d - sense * r2, -2.0, 0)),
            ]
        )
        gap = r1 - sense * r2
        straight = math.sqrt(d * d - gap * gap)
        lean = math.asin(gap / d)
        first = math.pi / 2 + lean
        second = math.pi / 2 - lean if sense > 0.0 else 1.5 * math.pi + lean
        expected = 3.0 + 2.0 + straight + r1 * first + r2 * second
        assert length(places) == pytest.approx(expected, rel=1e-12)


def test_a_neighbour_beside_the_plane_adds_its_distance_from_it() -> None:
    """From a pulley to a point beside its plane the straight part is sqrt(d^2 - r^2) with the whole distance d."""
    r, side = 0.5, 1.5
    flat = np.array([place((-r, -3.0, 0)), place((0, 0, 0), r, (0, 0, -1)), place((r, -4.0, 0))])
    beside = flat.copy()
    beside[2, 2] = side
    assert length(beside) - length(flat) == pytest.approx(math.hypot(4.0, side) - 4.0, rel=1e-12)


def test_tangents_of_tilted_pulleys_are_square_to_both_radii() -> None:
    """Moving a pulley along the straight part changes the length by that only: the rest of the force is lateral."""
    places = np.array(
        [
            place((0.5, -3.0, 0.2)),
            place((0, 0, 0), 0.5, (0.1, 0.2, -1)),
            place((5.0, 0.5, 1.0), 0.3, (0.3, -0.1, -1)),
            place((5.6, -4.0, 0.7)),
        ]
    )
    turned = places.copy()
    angle = 0.7
    R = np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1.0]])
    turned[:, :3], turned[:, 3:6] = places[:, :3] @ R.T + 7.0, places[:, 3:6] @ R.T
    assert length(turned) == pytest.approx(length(places), rel=1e-14)
    gradient = length_and_gradient(places, np.full(4, START_WRAP))[1]
    force, moment = (
        gradient[:, :3],
        np.cross(places[:, :3], gradient[:, :3]) + np.cross(places[:, 3:6], gradient[:, 3:]),
    )
    np.testing.assert_allclose(
        force.sum(axis=0), 0.0, atol=1e-14
    )  # a rope in space feels no force of its own
    np.testing.assert_allclose(moment.sum(axis=0), 0.0, atol=1e-13)


@pytest.mark.parametrize("seed", range(40))
def test_gradient_by_differences(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 8))
    places = np.zeros((count, 7))
    places[:, :3] = rng.normal(size=(count, 3)) * 3.0 + np.arange(count)[:, None] * np.array([7.0, 0.0, 0.0])
    axes = rng.normal(size=(count, 3))
    places[:, 3:6] = axes / np.linalg.norm(axes, axis=1)[:, None]
    places[1:-1, 6] = rng.uniform(0.1, 0.6, count - 2) * (rng.random(count - 2) < 0.8)
    wraps = np.full(count, START_WRAP)
    gradient = length_and_gradient(places, wraps)[1]
    d = 2e-6

    def difference(change: np.ndarray) -> float:
        ends = []
        for sign in (1.0, -1.0):
            moved = places + sign * d * change
            moved[:, 3:6] /= np.linalg.norm(moved[:, 3:6], axis=1)[:, None]
            ends.append(length(moved, wraps))
        return (ends[0] - ends[1]) / (2.0 * d)

    for _ in range(10):
        change = np.zeros_like(places)
        change[:, :3] = rng.normal(size=(count, 3))
        change[:, 3:6] = np.cross(places[:, 3:6], rng.normal(size=(count, 3)))
        assert difference(change) == pytest.approx(np.sum(gradient * change[:, :6]), rel=1e-7, abs=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_parallel_axes_are_the_limit_of_those_that_are_not(seed: int) -> None:
    """Pulleys with one axis, beside each other and of either sense: as with a tilt of 1e-12, by the general way."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 8))
    places = np.zeros((count, 7))
    places[:, :3] = rng.normal(size=(count, 3)) + np.arange(count)[:, None] * np.array([5.0, 0.0, 0.0])
    axis = rng.normal(size=3) * np.array([0.1, 1.0, 1.0])  # neighbours are outside of each other
    places[:, 3:6] = axis / np.linalg.norm(axis) * rng.choice([-1.0, 1.0], count)[:, None]
    places[1:-1, 6] = rng.uniform(0.1, 0.6, count - 2)
    tilted = places.copy()
    tilted[::2, 3:6] += 1e-12 * rng.normal(size=(len(tilted[::2]), 3))
    found = [length_and_gradient(path, np.full(count, START_WRAP)) for path in (places, tilted)]
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-11)
    np.testing.assert_allclose(found[0][1], found[1][1], atol=1e-10)


@pytest.mark.parametrize("seed", range(20))
def test_a_long_rope_is_the_sum_of_short_ones_between_eyes(seed: int) -> None:
    """Many parts are solved side by side, three are not: lengths, derivatives and wraps are the same."""
    rng = np.random.default_rng(seed)
    pieces = int(rng.integers(2, 9))
    count = 3 * pieces + 1
    places = np.zeros((count, 7))
    places[:, :3] = 2.0 * rng.normal(size=(count, 3)) + np.arange(count)[:, None] * np.array([9.0, 0.0, 0.0])
    tilt = rng.choice([1e-3, 0.1, 3.0])
    axes = np.array([0.0, 0.0, 1.0]) * rng.choice([-1.0, 1.0], count)[:, None] + tilt * rng.normal(
        size=(count, 3)
    )
    places[:, 3:6] = axes / np.linalg.norm(axes, axis=1)[:, None]
    places[:, 6] = rng.uniform(0.1, 0.7, count)
    places[::3, 6] = 0.0
    wraps = np.full(count, START_WRAP) + rng.choice([0.0, 2.0 * math.pi], count)
    apart = wraps.copy()
    length, gradient = length_and_gradient(places, wraps)
    total, by_place = 0.0, np.zeros_like(gradient)
    for first in range(0, count - 1, 3):
        piece = slice(first, first + 4)
        found = length_and_gradient(places[piece], apart[piece])
        total += found[0]
        by_place[piece] += found[1]
    assert length == pytest.approx(total, rel=1e-13)
    np.testing.assert_allclose(gradient, by_place, atol=1e-12)
    np.testing.assert_allclose(np.maximum(wraps, 0.0), np.maximum(apart, 0.0), atol=1e-12)


def test_a_fall_of_many_parts_between_blocks_with_one_axis_each() -> None:
    """n parts of sqrt(H^2 + s^2) from half turn to half turn, s aside and H apart."""
    r, H, s, count = 0.4, 20.0, 0.15, 17
    fall = [place((-r if count % 2 else r, -H, -s), 0.0)]
    fall += [place((0, 0.0 if k % 2 == 0 else -H, k * s), r, (0, 0, -1)) for k in range(count)]
    fall.append(place((r, -H if count % 2 else 0.0, count * s)))
    expected = (count + 1) * math.hypot(H, s) + count * math.pi * r
    assert length(np.array(fall)) == pytest.approx(expected, rel=1e-13)


def test_wrap_is_continuous_through_full_turns() -> None:
    """An end that circles the pulley winds the rope up: r times the angle."""
    r, R = 0.5, 3.0
    wraps = np.full(3, START_WRAP)
    lengths = []
    for angle in np.linspace(0.0, 5.0 * math.pi, 400):
        path = np.array(
            [
                place((-r, -3.0, 0)),
                place((0, 0, 0), r, (0, 0, -1)),
                place((R * math.sin(angle), R * math.cos(angle), 0)),
            ]
        )
        lengths.append(length_and_gradient(path, wraps)[0])
    assert lengths[-1] - lengths[0] == pytest.approx(5.0 * math.pi * r, rel=1e-12)
