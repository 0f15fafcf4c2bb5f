"""Starts that do not fit their joints: refused with names, or closed with the smallest displacement."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from start_scenes import (
    DOWN,
    bricard,
    joint,
    linkage,
    parallelograms,
    place,
    rod,
    rows_of,
    shaken,
    velocity,
)

from heavylift.numerics.outcome import InputError
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.scene import Scene
from heavylift.solver.start.consistent_start import check_start, project_start


def test_closed_start_passes_and_nothing_moves() -> None:
    rows = rows_of(parallelograms(2))
    before = rows.survey()[0]
    report = check_start(rows)
    assert report.violation < 1e-14
    assert report.text == ""
    assert np.array_equal(rows.survey()[0], before)


def test_open_joint_is_named_with_its_gap_and_the_remedy() -> None:
    """A link pulled 2 mm out of its first hinge along itself opens both of its hinges by as much."""
    scene = linkage([(0, 0, 0), (1, 0, 0), (2, 0, 0)], closed=False)
    first, second = scene.bodies
    scene = replace(scene, bodies=(replace(first, position=first.position + np.array([2e-3, 0, 0])), second))
    with pytest.raises(InputError) as error:
        check_start(rows_of(scene))
    text = str(error.value)
    assert set(re.findall(r"'(h\d)' by 0.002 m", text)) == {"h0", "h1"}
    assert 'start = "project"' in text


def test_a_turned_link_is_open_by_an_angle() -> None:
    scene = linkage([(0, 0, 0), (1, 0, 0)], closed=False)
    body = scene.bodies[0]
    turned = rod("r0", (0.5 - 0.5 * np.cos(0.01), 0, 0.005), (0.5 + 0.5 * np.cos(0.01), 0, -0.005))
    with pytest.raises(InputError, match=r"'h0' by 0\.0\d+ rad"):
        check_start(rows_of(replace(scene, bodies=(replace(body, orientation=turned.orientation),))))


def test_a_gap_is_closed_by_the_smallest_displacement() -> None:
    """A gap e across a rod at its end: the point closes by e, shared as 1/m and a^2/I between shift and turn."""
    gap, mass, arm = 1e-5, 1.0, 0.5
    inertia = mass / 12.0
    scene = linkage([(0, 0, 0), (1, 0, 0)], closed=False)
    body = scene.bodies[0]
    rows = rows_of(replace(scene, bodies=(replace(body, position=body.position + np.array([0, gap, 0])),)))
    report = project_start(rows)
    share = (1.0 / mass) / (1.0 / mass + arm**2 / inertia)
    assert place(rows, "r0")[1] == pytest.approx(gap * (1.0 - share), rel=1e-6)
    assert report.moved == pytest.approx(gap * share, rel=1e-6)
    assert report.turned == pytest.approx(gap * arm / inertia / (1.0 / mass + arm**2 / inertia), rel=1e-3)
    rows.fill()
    assert np.abs(rows.residual).max() < 1e-11


def test_velocities_take_the_impulse_of_the_joint() -> None:
    """A rod in flight that is caught at its end: ``w = m v a / (I + m a^2)``."""
    speed, arm = 2.0, 0.5
    scene = linkage([(0, 0, 0), (1, 0, 0)], closed=False)
    body = replace(scene.bodies[0], velocity=np.array([0.3, speed, 0.0]))
    rows = rows_of(replace(scene, bodies=(body,)))
    report = check_start(rows)
    spin = speed * arm / (1.0 / 12.0 + arm**2)
    found = velocity(rows, "r0")
    assert found[:3] == pytest.approx([0.0, arm * spin, 0.0], abs=1e-12)
    assert np.linalg.norm(found[3:]) == pytest.approx(spin, rel=1e-12)
    assert "'h0'" in report.text
    assert "'r0' changed by" in report.text


@pytest.mark.parametrize(
    "scene", [parallelograms(1), parallelograms(12), bricard()], ids=["four-bar", "twelve", "bricard"]
)
@pytest.mark.parametrize("amount", [0.01, 0.15])
def test_loops_with_redundant_rows_close_from_a_distance(scene: Scene, amount: float) -> None:
    for seed in range(3):
        rows = rows_of(shaken(scene, amount, seed))
        report = project_start(rows)
        assert report.violation > amount
        rows.fill()
        assert np.abs(rows.residual).max() < 1e-10
        assert np.abs(rows.jacobian() @ rows.survey()[2]).max() < 1e-10


def test_loop_that_is_too_long_says_which_joints_stay_open() -> None:
    """Two links of 1 m cannot span 2.5 m."""
    first, second = rod("r0", (0, 0, 0), (1, 0, 0)), rod("r1", (1, 0, 0), (2, 0, 0))
    scene = Scene(
        (first, replace(second, position=second.position + np.array([0.5, 0, 0]))),
        (DOWN,),
        (),
        (
            joint(Hinge, "left", None, first, (0, 0, 0)),
            joint(Hinge, "middle", first, second, (1, 0, 0)),
            replace(
                joint(Hinge, "right", second, None, (2, 0, 0)),
                frame_b=joint(Hinge, "end", None, None, (2.5, 0, 0)).frame_b,
            ),
        ),
    )
    with pytest.raises(InputError, match="cannot be closed together") as error:
        project_start(rows_of(scene))
    assert {"left", "middle", "right"} & set(re.findall(r"'(\w+)' by", str(error.value)))
