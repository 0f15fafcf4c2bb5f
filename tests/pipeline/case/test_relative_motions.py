"""Relative motions in case files: a pendulum seen from a tilted hull, a plate that bends, and what is refused."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.early_checks import scene_errors
from tests.pipeline.judged import judged_checks

HERE = Path(__file__).parents[1]
PLATE = """
title = "A plate bends like a beam"

[bodies.plate]
type = "shell"
geometry = { type = "rectangle", size = ["4 m", "2 m"], elements = [8, 2] }
section = { thickness = "20 mm", density = "7850 kg/m^3", young_modulus = "210 GPa", poisson_ratio = 0 }
supports = [{ edge = ["x_min"], fix = "clamped" }]
loads = [{ force = [0, 0, "-9.8 Pa"] }]

[bodies.post]
type = "rigid"
mass = 1
inertia = [1, 1, 1]
frame = { motion = "fixed" }
initial = { position = [1, 1, 0], orientation = { axis = [0, 0, 1], angle = "90 deg" } }

[[relative_motions]]
name = "end"
between = ["post", "plate"]
points = [[0, 0, 0], ["4 m", "1 m", 0]]

[simulate]
start = "equilibrium"
duration = 0
"""


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "relative"
    folder.mkdir()
    shutil.copyfile(HERE / "relative.toml", folder / "case.toml")
    return folder


def test_a_pendulum_seen_from_a_tilted_hull(folder):
    """By the angle q of its hinge it hangs ``q - 60 deg`` away from the axis of the hull, 2 m from the pivot."""
    case = load_case(folder)
    assert scene_errors(case) == []
    assert run_case(case).outcome is Outcome.COMPLETED
    checks = judged_checks(case, case.output_folder)
    assert [check.id for check in checks if not check.passed] == []
    results = load_results(case)
    turned = np.radians(-90.0 + 30.0) + results["pivot.angle"]
    seen = {name: results[f"bob_from_deck.{name}"] for name in ("position", "rotation", "tilt", "velocity")}
    expected = 2.0 * np.column_stack([-np.sin(turned), 0.0 * turned, -np.cos(turned)])
    np.testing.assert_allclose(seen["position"], expected, atol=1e-9)
    np.testing.assert_allclose(seen["tilt"], np.abs(turned), atol=1e-7)
    rate = results["bob_from_deck.angular_velocity"][:, 1]
    np.testing.assert_allclose(rate, results["pivot.angular_rate"], atol=1e-9)
    speeds = 2.0 * rate[:, None] * np.column_stack([-np.cos(turned), 0.0 * turned, np.sin(turned)])
    np.testing.assert_allclose(seen["velocity"], speeds, atol=1e-8)
    within = np.abs(turned) < np.radians(89.0)
    assert within.all()
    np.testing.assert_allclose(seen["rotation"][:, 1], turned, atol=1e-9)


def test_a_plate_turns_at_its_end(tmp_path):
    """Slope ``q l^3 / (6 D)`` and deflection ``q l^4 / (8 D)`` with ``D = E t^3 / 12``, in axes that stand across."""
    (tmp_path / "case.toml").write_text(PLATE)
    case = load_case(tmp_path)
    assert run_case(case).outcome is Outcome.COMPLETED
    results = load_results(case)
    D = 210e9 * 0.02**3 / 12.0
    slope, sag = 9.8 * 4.0**3 / (6.0 * D), 9.8 * 4.0**4 / (8.0 * D)
    x, y, z = results["end.position"][-1]
    assert (x, y) == pytest.approx((0.0, -3.0), abs=1e-5)
    assert z == pytest.approx(-sag, rel=1e-3)
    assert results["end.tilt"][-1] == pytest.approx(slope, rel=1e-3)
    roll, pitch, yaw = results["end.rotation"][-1]
    assert yaw == pytest.approx(-np.pi / 2.0, abs=1e-5)
    assert (roll, pitch) == pytest.approx((0.0, slope), abs=1e-5)


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        (
            'relative_motions.0.between=["hull", "hull"]',
            "relative_motions.0.between",
            "both sides are 'hull'",
        ),
        ('relative_motions.0.between=["hul", "bob"]', "relative_motions.0.between.0", "did you mean 'hull'"),
        (
            'sensors=[{name="bob_from_deck", body="bob", point=[0, 0, 0]}]',
            "relative_motions.0.name",
            "occurs 2 times",
        ),
        ("relative_motions.0.points=[[0, 0, 0]]", "relative_motions.0.points", "1 entries"),
        ('check.0.quantity="channel.bob_from_deck.tlt.max"', "check.0.quantity", "did you mean 'tilt'"),
        ('check.1.maximum="1 m"', "check.1.maximum", "is a length"),
    ],
)
def test_what_is_wrong_is_one_line(folder, override, key, words):
    with pytest.raises(InputError) as caught:
        load_case(folder, [override])
    (line,) = str(caught.value).splitlines()
    assert f": {key}: " in line
    assert words in line


def test_a_point_of_a_flexible_body_moves_and_its_axes_turn_with_it(small_case):
    """By the slope of the first mode of a cantilever in both planes, 1.37651 / L of its deflection."""
    text = (small_case / "case.toml").read_text()
    point = '["200 mm", "20 mm", "10 mm"]'
    text += (
        f'[[relative_motions]]\nname = "end"\nbetween = ["ground", "beam"]\npoints = [[0, 0, 0], {point}]\n'
    )
    (small_case / "case.toml").write_text(text)
    case = load_case(small_case, ["simulate.duration=1 ms"])
    assert run_case(case, stages=("mesh", "modes", "simulate")).outcome is Outcome.COMPLETED
    results = load_results(case)
    assert np.ptp(results["tip.position"], axis=0).max() > 1e-5
    for name in ("position", "velocity"):
        np.testing.assert_array_equal(results[f"end.{name}"], results[f"tip.{name}"])
    moved = results["tip.position"] - results["tip.position"][0]
    slope = 1.37651 / 0.2 * np.stack([-moved[:, 2], moved[:, 1]], axis=1)
    turned = results["end.rotation"][:, 1:]
    np.testing.assert_allclose(turned, slope, atol=0.03 * np.abs(slope).max())
    rate = np.gradient(turned, results.time, axis=0)
    np.testing.assert_allclose(
        results["end.angular_velocity"][1:-1, 1:], rate[1:-1], atol=0.01 * np.abs(rate).max()
    )


def test_a_frame_has_no_axes(tmp_path):
    text = PLATE.replace('type = "shell"', 'type = "frame"')
    text = text.replace(
        '"rectangle", size = ["4 m", "2 m"], elements = [8, 2]',
        '"line", start = [0, 0, 0], end = ["4 m", 0, 0], elements = 4',
    )
    text = (
        text.replace("9.8 Pa", "9.8 N/m")
        .replace('edge = ["x_min"]', 'at = "start"')
        .replace('thickness = "20 mm"', 'side = "9 cm"')
    )
    (tmp_path / "case.toml").write_text(text.replace(", poisson_ratio = 0", ""))
    with pytest.raises(InputError, match=r"relative_motions\.0\.between: 'plate' is a frame"):
        load_case(tmp_path)
