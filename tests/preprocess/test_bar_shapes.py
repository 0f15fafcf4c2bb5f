"""Sections of named shapes against constants by hand and against an integration over their area."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.preprocess.structures.bar_shapes import BAR_SHAPES, ROUND_SHAPES, shape_section

# dimensions of each shape, its area, I1 = integral of y^2, I2 = integral of z^2 about the centroid, by hand
BY_HAND = {
    "BAR": ((2.0, 6.0), 12.0, 2.0 * 6.0**3 / 12, 6.0 * 2.0**3 / 12),
    "BOX": ((4.0, 6.0, 0.5, 0.25), 24.0 - 3.5 * 5.0, (4 * 6**3 - 3.5 * 5**3) / 12, (6 * 4**3 - 5 * 3.5**3) / 12),
    "BOX1": ((4.0, 6.0, 0.5, 0.5, 0.25, 0.25), 6.5, (4 * 6**3 - 3.5 * 5**3) / 12, (6 * 4**3 - 5 * 3.5**3) / 12),
    "I": ((10.0, 6.0, 6.0, 1.0, 1.0, 1.0), 20.0, (6 * 10**3 - 5 * 8**3) / 12, (2 * 6**3 + 8) / 12),
    "I1": ((5.0, 1.0, 8.0, 10.0), 20.0, (6 * 10**3 - 5 * 8**3) / 12, (2 * 6**3 + 8) / 12),
    "CHAN": ((4.0, 10.0, 1.0, 1.0), 16.0, (4 * 10**3 - 3 * 8**3) / 12, None),
    "CHAN1": ((3.0, 1.0, 8.0, 10.0), 16.0, (4 * 10**3 - 3 * 8**3) / 12, None),
    "CHAN2": ((1.0, 1.0, 4.0, 10.0), 16.0, None, (4 * 10**3 - 3 * 8**3) / 12),
    "Z": ((3.0, 1.0, 8.0, 10.0), 16.0, (4 * 10**3 - 3 * 8**3) / 12, 2 * (4**3 / 12 + 4 * 1.5**2) + 8 / 12),
    "CROSS": ((6.0, 1.0, 9.0, 1.0), 15.0, (9**3 + 6) / 12, (9 + 7**3 - 1) / 12),
    "H": ((6.0, 2.0, 9.0, 1.0), 24.0, (2 * 9**3 + 6) / 12, (6**3 + 9 * (8**3 - 6**3)) / 12),
    # 10 x 2 flange on a web 8 x 1: centroid (20 x 9 + 8 x 4)/28 above the foot
    "T": ((10.0, 10.0, 2.0, 1.0), 28.0, 10 * 8 / 12 + 20 * (9 - 212 / 28) ** 2 + 8**3 / 12 + 8 * (212 / 28 - 4) ** 2,
          (2 * 10**3 + 8) / 12),
    "T2": ((10.0, 10.0, 2.0, 1.0), 28.0, 10 * 8 / 12 + 20 * (9 - 212 / 28) ** 2 + 8**3 / 12
           + 8 * (212 / 28 - 4) ** 2, (2 * 10**3 + 8) / 12),
    "T1": ((10.0, 8.0, 2.0, 1.0), 28.0, (2 * 10**3 + 8) / 12, 10 * 8 / 12 + 20 * (9 - 212 / 28) ** 2 + 8**3 / 12
           + 8 * (212 / 28 - 4) ** 2),
    # 6 x 1 foot, 1 x 9 upright: centroid 3.5 up, 1.5 across
    "L": ((6.0, 10.0, 1.0, 1.0), 15.0, 6 / 12 + 6 * 3.0**2 + 9**3 / 12 + 9 * 2.0**2,
          6**3 / 12 + 6 * 1.5**2 + 9 / 12 + 9 * 1.0**2),
    # height 5, thickness 1, top 6, brims of 2
    "HAT": ((5.0, 1.0, 6.0, 2.0), 6.0 + 6.0 + 6.0, 6 / 12 + 6 * 2**2 + 2 * 3**3 / 12 + 6 / 12 + 6 * 2**2,
            6**3 / 12 + 2 * (3 / 12 + 3 * 2.5**2) + 2 * (27 / 12 + 3 * 3.5**2)),
}  # fmt: skip


@pytest.mark.parametrize("shape", BAR_SHAPES)
def test_area_and_second_moments_of_a_shape(shape):
    dimensions, area, second_1, second_2 = BY_HAND[shape]
    section = shape_section(shape, dimensions)
    assert section.area == pytest.approx(area, rel=1e-12)
    if second_1 is not None:
        assert section.second_moment_1 == pytest.approx(second_1, rel=1e-12)
    if second_2 is not None:
        assert section.second_moment_2 == pytest.approx(second_2, rel=1e-12)


@pytest.mark.parametrize("shape", BAR_SHAPES)
def test_rectangles_of_a_shape_do_not_overlap(shape):
    """A count of points in the union gives the area that the sum of rectangles has."""
    y0, y1, z0, z1 = np.array(BAR_SHAPES[shape].rectangles(*BY_HAND[shape][0])).T
    step = 0.125
    y, z = (np.arange(low.min(), high.max(), step) + step / 2 for low, high in ((y0, y1), (z0, z1)))
    inside = np.zeros((y.size, z.size), dtype=bool)
    for a, b, c, d in zip(y0, y1, z0, z1, strict=True):
        inside |= ((y > a) & (y < b))[:, None] & ((z > c) & (z < d))[None, :]
    assert inside.sum() * step**2 == pytest.approx(shape_section(shape, BY_HAND[shape][0]).area, rel=1e-12)


def test_product_of_an_angle_and_of_a_z():
    # L 6 x 10 x 1: foot (0.5, 3), upright (5.5, 0.5)
    angle = shape_section("L", (6.0, 10.0, 1.0, 1.0))
    y, z = (6 * 0.5 + 9 * 5.5) / 15, (6 * 3.0 + 9 * 0.5) / 15
    assert angle.product == pytest.approx(6 * (0.5 - y) * (3 - z) + 9 * (5.5 - y) * (0.5 - z), rel=1e-12)
    # flanges 4 x 1 at y = -+4.5, z = -+1.5
    assert shape_section("Z", (3.0, 1.0, 8.0, 10.0)).product == pytest.approx(2 * 4 * 4.5 * 1.5, rel=1e-12)


def test_torsion_and_shear():
    # flat bar 150 x 12: h t^3/3 (1 - 0.63 t/h); the term of fourth order is 3e-6
    flat = shape_section("BAR", (0.012, 0.15))
    assert flat.torsion == pytest.approx(0.15 * 0.012**3 / 3 * (1 - 0.63 * 0.08), rel=1e-5)
    assert flat.shear_area_1 == pytest.approx(5 / 6 * 0.15 * 0.012)
    # thin box: 4 A^2 / sum(l/t)
    box = shape_section("BOX", (1.0, 2.0, 0.02, 0.01))
    inside = 0.99 * 1.98
    assert box.torsion == pytest.approx(4 * inside**2 / (2 * 0.99 / 0.02 + 2 * 1.98 / 0.01), rel=1e-12)
    assert shape_section("T", (10.0, 10.0, 2.0, 1.0)).torsion == pytest.approx((10 * 8 + 8 * 1) / 3)


def test_shear_centres():
    # T: middle of the flange; channel 4 x 10 x 1: e = 3 b^2 t/(h t + 6 b t) outside the web
    tee = shape_section("T", (10.0, 10.0, 2.0, 1.0))
    assert tee.shear_centre == pytest.approx((9 - 212 / 28, 0.0))
    channel = shape_section("CHAN", (4.0, 10.0, 1.0, 1.0))
    centroid = (8 * 2.0 + 8 * 0.5) / 16
    assert channel.shear_centre[1] == pytest.approx(0.5 - 3 * 3.5**2 / (9 + 6 * 3.5) - centroid)
    assert shape_section("CHAN", (4.0, 10.0, 1.0, 1.0), shear_centre=False).shear_centre == (0.0, 0.0)


def test_round_shapes():
    rod = shape_section("ROD", (0.5,))
    assert (rod.area, rod.second_moment_1, rod.torsion) == pytest.approx(
        (np.pi / 4, np.pi / 64, np.pi / 32), rel=1e-14
    )
    tubes = [shape_section("TUBE", (0.5, 0.4)), shape_section("TUBE2", (0.5, 0.1))]
    for tube in tubes:
        assert tube.area == pytest.approx(np.pi * 0.09, rel=1e-12)
        assert tube.torsion == pytest.approx(np.pi / 2 * (0.5**4 - 0.4**4), rel=1e-12)
    assert set(ROUND_SHAPES) == {"ROD", "TUBE", "TUBE2"}


@pytest.mark.parametrize(
    ("shape", "dimensions"),
    [("BOX", (1.0, 2.0, 0.6, 0.6)), ("TUBE", (0.4, 0.5)), ("T", (1.0, 1.0, 2.0, 0.1))],
)
def test_walls_thicker_than_the_shape_are_refused(shape, dimensions):
    with pytest.raises(ValueError, match=r"wall|radii"):
        shape_section(shape, dimensions)
