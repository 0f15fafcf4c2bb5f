"""Pictures of mooring lines: polylines where lines hang, and panels that show them."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from heavylift.pipeline.drawn.hanging import hanging_line
from heavylift.pipeline.pictures.mooring_lines import profile_picture
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.moorings import LineSection, SeabedSlope
from heavylift.solver.water.lines.catenary_line import solve_catenary
from heavylift.solver.water.lines.mooring_lines import MooringLine

ANCHOR = np.array([-120.0, 60.0, -50.0])
CHAIN_AND_WIRE = (LineSection(150.0, 900.0, 4e8), LineSection(80.0, 250.0, 3e8))


def mooring(name: str, **more: Any) -> MooringLine:
    given: dict[str, Any] = {"sections": CHAIN_AND_WIRE, "seabed": -50.0, "clumps": (5e3,)}
    return MooringLine(
        name=name, body_a=GROUND, point_a=ANCHOR, body_b="barge", point_b=np.zeros(3), **(given | more)
    )


def test_polyline_is_the_line() -> None:
    fairlead = np.array([60.0, -20.0, 1.0])
    drawn = hanging_line(mooring("bow"), ANCHOR, fairlead, points=200)
    assert drawn.points[0] == pytest.approx(ANCHOR)
    assert drawn.points[-1] == pytest.approx(fairlead, abs=1e-7)
    r = fairlead - ANCHOR
    across = np.array([-r[1], r[0], 0.0]) / math.hypot(r[0], r[1])
    assert np.abs((drawn.points - ANCHOR) @ across).max() < 1e-9
    length = np.linalg.norm(np.diff(drawn.points, axis=0), axis=1).sum()
    assert length == pytest.approx(230.0, rel=1e-3)  # stretch
    assert drawn.points[:, 2].min() == pytest.approx(-50.0)
    line = solve_catenary(CHAIN_AND_WIRE, math.hypot(r[0], r[1]), r[2], clumps=(5e3,))
    assert drawn.profile.tension[-1] == pytest.approx(line.tension)
    assert drawn.profile.s[drawn.joints] == pytest.approx([150.0])


def test_a_slack_line_ends_where_it_is_held() -> None:
    fairlead = ANCHOR + np.array([30.0, 0.0, 45.0])
    drawn = hanging_line(mooring("slack"), ANCHOR, fairlead)
    assert drawn.points[-1] == pytest.approx(fairlead, abs=1e-6)
    assert drawn.catenary.horizontal == 0.0
    assert np.all(np.isfinite(drawn.points))


SAND = [0xD9, 0xC9, 0xA3]


def sand(picture: bytes) -> np.ndarray:
    """Where a picture shows the bottom."""
    pixels = np.array(Image.open(io.BytesIO(picture)).convert("RGB")).astype(int)
    return np.asarray(np.abs(pixels - SAND).max(axis=2) < 8)


@pytest.mark.slow
def test_the_bottom_slopes_under_its_line() -> None:
    """A polyline that follows the plane where it lies, and sand that rises to the right as the bottom does."""
    fairlead = ANCHOR + np.array([175.0, 0.0, 70.0])
    rising, flat = (
        hanging_line(mooring("bow", seabed_slope=SeabedSlope(math.radians(angle), math.pi)), ANCHOR, fairlead)
        for angle in (8.0, 0.0)
    )
    x, z = rising.points[:, 0] - ANCHOR[0], rising.points[:, 2] - ANCHOR[2]
    above = z - math.tan(math.radians(8.0)) * x
    assert above.min() > -1e-9
    lying = rising.profile.s < rising.catenary.on_seabed
    assert np.abs(above[lying]).max() < 1e-6
    assert lying.sum() > 20
    assert rising.points[-1] == pytest.approx(fairlead, abs=1e-9)
    columns = {}
    for name, drawn in (("rising", rising), ("flat", flat)):
        shown = sand(profile_picture([drawn])).sum(axis=0)
        first, *_, last = np.flatnonzero(shown > 5)
        quarter = (last - first) // 4
        columns[name] = shown[first + quarter], shown[last - quarter]
    assert columns["rising"][1] > 1.3 * columns["rising"][0]
    assert columns["flat"][1] == pytest.approx(columns["flat"][0], abs=4)


def test_a_line_between_two_hulls_is_drawn_to_both() -> None:
    stern, fairlead = np.array([-90.0, 0.0, -3.0]), np.array([55.0, 0.0, 2.0])
    drawn = hanging_line(replace(mooring("tow", friction=0.3), body_a="tug"), stern, fairlead)
    assert drawn.points[0] == pytest.approx(stern, abs=1e-7)
    assert drawn.points[-1] == pytest.approx(fairlead, abs=1e-9)
    assert drawn.points[:, 2].min() == pytest.approx(-50.0, abs=1e-7)
    assert drawn.profile.tension[0] == pytest.approx(drawn.catenary.anchor_tension, rel=1e-6)


@pytest.mark.slow
def test_picture_has_a_panel_for_each_line() -> None:
    hawser = mooring("hawser", sections=(LineSection(70.0, 60.0, 5e6),), seabed=None, clumps=())
    lines = [
        hanging_line(mooring("bow"), ANCHOR, np.array([60.0, -20.0, 1.0])),
        hanging_line(mooring("slack $1"), ANCHOR, ANCHOR + np.array([30.0, 0.0, 45.0])),
        hanging_line(hawser, np.array([0.0, 0.0, 4.0]), np.array([66.0, 10.0, 7.0])),
    ]
    one, three = (
        Image.open(io.BytesIO(profile_picture(some, level=0.0, title="Lines of $a$ barge")))
        for some in (lines[:1], lines)
    )
    assert three.width == one.width
    assert three.height > 2 * one.height
    assert 0.005 < sand(profile_picture(lines, level=0.0)).mean() < 0.2
