"""Every extreme, criterion and summary a second way, from the records of every step.

A run that records each of its steps knows all that a coarser one must have seen: its largest values within an interval
are the channels `..._max` and `..._min` of the other. What criteria say is computed again from positions, directions
and stiffnesses alone, and statistics from their definitions.
"""

from __future__ import annotations

import math
import re
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

sys.path.append(str(Path(__file__).resolve().parent))
import changed_scenes as changed
from test_invariance import SCENES, document_of

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.results.statistics import record_statistics
from tests.pipeline.judged import judged_criteria

G = 9.81
EVERY = 20
"""Steps between the records of the coarse run."""

ELSEWHERE = {
    "gap": "far from touching a gap is not searched for in every step",
    "uncut": "an impulse over a part of a step is no force",
}


def recorded(
    name: str, folder: Path, every: int, duration: float, change: Any = None
) -> tuple[Any, Any, list[Any]]:
    """Case, results and lines of criteria of a scene that is recorded every so many steps."""
    document, file = document_of(SCENES[name])
    if change is not None:
        change(document)
    step = changed._number(document["simulate"]["step"], "time")
    document["simulate"] |= {"output_interval": every * step, "duration": duration}
    case = load_case(changed.written(document, folder, file))
    report = run_case(case, stages=("mesh", "modes", "simulate"))
    assert report.outcome in {Outcome.COMPLETED, Outcome.PHASES_LEFT}, report.message
    return case, load_results(case), judged_criteria(case, report.folder.root) if case.criteria else []


DURATIONS = {
    "lift": 2.0, "hoist": 4.0, "tugger": 1.0, "joints": 0.9, "pulleys": 0.4, "equalizer": 1.0, "gantry": 3.0,
    "load-out": 5.0, "bumpy road": 1.0, "rocking": 0.4, "phases": 30.0, "crane afloat": 2.0,
}  # fmt: skip
OF_WHEELS = {"load": "wheel_load", "stroke": "stroke_of"}
"""Channels of all wheels, whose extremes are one number."""
QUICK = ("lift", "tugger", "hoist")


def unlike(channel: str, results: Any) -> str:
    """Why an extreme need not be that of the records of all steps; empty if it must."""
    owner, _, part = channel.rpartition(".")
    if part == "gap":
        return ELSEWHERE["gap"]
    if part == "normal_force" and f"{owner}.impacts" in results and results[f"{owner}.impacts"][-1] > 0:
        return ELSEWHERE["uncut"]
    return ""


def intervals_with_a_cut_step(fine: Any) -> np.ndarray:
    """Intervals of the coarse run in which a phase begins: its step ends at that instant, which no record has."""
    if "scenario.phase" not in fine:
        return np.zeros((len(fine.time) - 1) // EVERY, bool)
    changes = np.diff(np.asarray(fine["scenario.phase"]).ravel()) != 0
    return changes.reshape(-1, EVERY).any(axis=1)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in DURATIONS]
)
def test_extremes_are_those_of_all_steps(name, tmp_path):
    duration = DURATIONS[name]
    _, coarse, _ = recorded(name, tmp_path / "coarse", EVERY, duration)
    _, fine, _ = recorded(name, tmp_path / "fine", 1, duration)
    assert len(fine.time) == EVERY * (len(coarse.time) - 1) + 1
    compared = 0
    for channel in coarse.names:
        found = re.fullmatch(r"(.*)_(max|min)", channel)
        if found is None:
            continue
        owner, _, part = found[1].rpartition(".")
        of = f"{owner}.{OF_WHEELS.get(part, part)}"
        if of not in fine or unlike(of, fine):
            continue
        values = np.asarray(fine[of]).reshape(len(fine.time), -1)
        steps = values[1:].reshape(len(coarse.time) - 1, EVERY, -1)
        of_steps = steps.max(axis=1) if found[2] == "max" else steps.min(axis=1)
        kept = np.asarray(coarse[channel]).reshape(len(coarse.time), -1)[1:]
        if kept.shape[1] < of_steps.shape[1]:  # one number of several parts
            of_steps = (of_steps.max if found[2] == "max" else of_steps.min)(axis=1, keepdims=True)
        near = 1e-9 * max(1.0, float(np.abs(values).max()))
        cut = intervals_with_a_cut_step(fine)
        np.testing.assert_allclose(kept[~cut], of_steps[~cut], rtol=1e-9, atol=near, err_msg=channel)
        sign = 1.0 if found[2] == "max" else -1.0
        assert np.all(sign * (kept[cut] - of_steps[cut]) >= -near), channel
        if np.any(cut) and kept.shape == of_steps.shape:  # what single steps saw, their parts with them
            seen = sign * np.asarray(fine[channel]).reshape(len(fine.time), -1)[1:]
            seen = sign * seen.reshape(len(coarse.time) - 1, EVERY, -1).max(axis=1)
            np.testing.assert_allclose(kept[cut], seen[cut], rtol=1e-9, atol=near, err_msg=channel)
        compared += 1
    assert compared or name in {"tugger", "joints"}


def world(results: Any, body: str, point: Any) -> np.ndarray:
    """Places of a point of a body at all records."""
    if body == "ground":
        return np.broadcast_to(np.asarray(point, float), (len(results.time), 3))
    turned = Rotation.from_quat(results[f"{body}.orientation"], scalar_first=True)
    return results[f"{body}.position"] + turned.apply(np.asarray(point, float))


CORNERS = {
    f"sling_{k + 1}": np.array([x, y, 2.0]) for k, (x, y) in enumerate([(5, 3), (-5, 3), (-5, -3), (5, -3)])
}


def askew(document: Any) -> None:
    """A load off its centre, slings without dampers and with lugs, all criteria on them."""
    document["bodies"]["module"]["centre_of_mass"] = ["0.8 m", "-0.4 m", 0]
    lugs = []
    for rope in document["ropes"]:
        rope.pop("damping", None)
        if rope["name"] in CORNERS:
            lugs.append(
                {"name": f"eye_{rope['name']}", "body": "module", "rope": rope["name"], "normal": [3, -5, 0]}
            )
    document["lugs"] = lugs
    document["hook_loads"] = [{"name": "hanging", "body": "hook", "ropes": ["hoist"]}]
    document["criteria"] += [
        {"name": "eyes", "type": "lug", "lugs": [one["name"] for one in lugs], "maximum_angle": "40 deg",
         "in_plane": "60 t", "out_of_plane": "30 t"},
        {"name": "height", "type": "limit", "quantity": "channel.module.position.z.max", "maximum": "10 m",
         "source": "here"},
    ]  # fmt: skip


def test_criteria_of_slings_from_positions_alone(tmp_path):
    _, _, lines = recorded("lift", tmp_path / "coarse", EVERY, 3.0, askew)
    _, fine, every = recorded("lift", tmp_path / "fine", 1, 3.0, askew)
    ways = {
        name: world(fine, "module", lug) - world(fine, "hook", [0, 0, 0]) for name, lug in CORNERS.items()
    }
    tension, rise, across, inside, angle = {}, {}, {}, {}, {}
    turned = Rotation.from_quat(fine["module.orientation"], scalar_first=True)
    normal = turned.apply(np.array([3.0, -5.0, 0.0]) / math.hypot(3.0, 5.0))
    for name, way in ways.items():
        length = np.linalg.norm(way, axis=1)
        drawn = np.linalg.norm(CORNERS[name] + [0.0, 0.0, 2.0 - 14.0])
        tension[name] = np.maximum(0.0, 100e6 * (length / drawn - 1.0))
        rise[name] = np.arcsin(np.abs(way[:, 2]) / length)
        pull = -tension[name][:, None] * way / length[:, None]
        across[name] = np.abs((pull * normal).sum(axis=1))
        inside[name] = np.sqrt(np.maximum(tension[name] ** 2 - across[name] ** 2, 0.0))
        angle[name] = np.where(
            tension[name] > 0.0, np.arcsin(np.abs((way * normal).sum(axis=1)) / length), 0.0
        )
    upright = turned.apply([0.0, 0.0, 1.0])[:, 2]
    most = {what: max(float(one.max()) for one in values.values()) for what, values in
            {"tension": tension, "across": across, "inside": inside, "angle": angle}.items()}  # fmt: skip
    least_rise = min(float(np.where(tension[name] > 0.0, rise[name], math.inf).min()) for name in ways)
    expected = {
        "slings 0": most["tension"],
        "angles 0": least_rise,
        "shackles 0": most["tension"],
        "taut 0": min(float(one.min()) for one in tension.values()),
        "level 0": float(np.arccos(np.clip(upright, -1.0, 1.0)).max()),
        "eyes 0": most["angle"],
        "eyes 1": most["inside"],
        "eyes 2": most["across"],
        "height 0": float(fine["module.position"][:, 2].max()),
    }
    seen: dict[str, int] = {}
    for coarse_line, line in zip(lines, every, strict=True):
        number = seen.setdefault(line.name, 0)
        seen[line.name] += 1
        wanted = expected.pop(f"{line.name} {number}", None)
        if wanted is None:
            continue
        tolerance = 1e-6 * (most["tension"] if line.unit == "N" else 1.0)
        assert abs(line.value - wanted) <= tolerance, (line.name, number, line.value, wanted)
        if line.name not in {"angles", "level", "height"}:  # those are of records
            assert abs(coarse_line.value - wanted) <= tolerance, (
                line.name,
                number,
                coarse_line.value,
                wanted,
            )
    assert not expected, f"no line of {expected}"
    # what hangs on the hook, without the hook
    height = world(fine, "module", [0.8, -0.4, 0.0])[:, 2]
    hanging = 100e3 * (G + np.gradient(np.gradient(height, fine.time), fine.time))
    inner = slice(5, -5)
    np.testing.assert_allclose(fine["hanging.hook_load"][inner], hanging[inner], rtol=2e-3)


def test_crane_of_a_hoist_from_positions_alone(tmp_path):
    _, fine, lines = recorded("hoist", tmp_path / "fine", 1, 6.0)
    radius = 36.0  # the tip stays where it is
    capacity = np.interp(radius, [20.0, 30.0, 40.0, 50.0], [2000e3, 1600e3, 1200e3, 900e3]) * G
    tension = fine["fall.tension"]
    crane = next(line for line in lines if line.type == "crane")
    assert crane.limit == pytest.approx(capacity, rel=1e-12)
    assert crane.value == pytest.approx(2.0 * tension.max() + 40e3 * G, rel=1e-9)
    rope = next(line for line in lines if line.type == "sling")
    assert rope.value == pytest.approx(tension.max(), rel=1e-12)
    factor = next(line for line in lines if line.type == "dynamic_factor")
    assert factor.value == pytest.approx(2.0 * tension.max() / (1000e3 * G), rel=1e-9)


def test_statistics_by_their_definitions():
    rng = np.random.default_rng(7)
    times = np.cumsum(rng.uniform(0.05, 0.15, 4000))
    values = 3.0 + 2.0 * np.sin(times) + 0.7 * np.sin(2.3 * times + 1.0)
    found = record_statistics(times, values)
    widths = np.gradient(times)  # half of the way to each neighbour
    widths[0], widths[-1] = 0.5 * (times[1] - times[0]), 0.5 * (times[-1] - times[-2])
    mean = float((widths * values).sum() / widths.sum())
    deviation = float(np.sqrt((widths * (values - mean) ** 2).sum() / widths.sum()))
    assert found.mean == pytest.approx(mean, abs=2e-3)
    assert found.standard_deviation == pytest.approx(deviation, rel=2e-3)
    assert (found.minimum, found.maximum) == (values.min(), values.max())
    assert found.significant_by_deviation == pytest.approx(4.0 * found.standard_deviation, rel=1e-12)
    up = np.flatnonzero((values[:-1] < found.mean) & (values[1:] >= found.mean))
    ranges = [np.ptp(values[a + 1 : b + 1]) for a, b in pairwise(up)]
    assert found.cycles == len(ranges)
    highest = sorted(ranges)[-max(1, round(len(ranges) / 3)) :]
    assert found.largest_range == pytest.approx(max(ranges), rel=1e-9)
    assert found.significant_by_cycles == pytest.approx(float(np.mean(highest)), rel=5e-3)
