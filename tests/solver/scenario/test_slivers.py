"""Phases that end within a step, perhaps a millionth of it before its end: nothing that is recorded knows of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from heavylift.numerics.jit import kernel
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.integrate.lone_extremes import LoneExtremes
from heavylift.solver.ringing import steady_force as steady_force_kernel
from heavylift.solver.scenario.actions.release import Release
from heavylift.solver.scene.channels import Channel
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.sensors.hook_loads import HookLoad
from heavylift.solver.simulation import Simulation


@kernel
def steady_force(
    middle: float, slope: float, before: float, long_before: float, step: float, spacing: float
) -> float:
    return steady_force_kernel(middle, slope, before, long_before, step, spacing)


G, STEP, EVERY, STEPS = 9.81, 1e-2, 5, 400
BLOCK, LOAD = 2e3, 1e4
PARTS = (3e-6, 1e-3, 0.05, 0.999, 1.0 - 3e-6, 1e-14, 1.0 - 1e-14)
"""Of a step, at which phases end."""


def crane(*phases: Phase) -> Scene:
    """A hook block on a rope that is hauled in, 1 km from the origin, with a load on a sling below."""
    x, top = 1e3, 1e3
    at = {"block": np.array([x, 0.0, top - 20.0]), "load": np.array([x, 0.0, top - 25.0])}
    fall = Rope(
        name="fall",
        path=(RopePoint(GROUND, np.array([x, 0.0, top])), RopePoint("block", np.zeros(3))),
        axial_stiffness=4e7,
        damping=2e4,
        tension=(BLOCK + LOAD) * G,
        winch=Winch(times=np.array([0.0, 1.0, 3.0, 4.0]), speeds=np.array([0.0, 0.4, 0.4, 0.0])),
    )
    sling = Rope(
        name="sling",
        path=(RopePoint("block", np.zeros(3)), RopePoint("load", np.zeros(3))),
        axial_stiffness=2e7,
        damping=2e4,
        tension=LOAD * G,
    )
    bodies = tuple(
        RigidBody(name, mass, 1e3 * np.eye(3), position=at[name])
        for name, mass in (("block", BLOCK), ("load", LOAD))
    )
    return Scene(
        bodies,
        forces=(Gravity(np.array([0.0, 0.0, -G])), HookLoad(name="hook", body="block", ropes=("fall",))),
        ropes=(fall, sling),
        scenario=Scenario(phases) if phases else None,
    )


def histories(made: Scene, **options: Any) -> tuple[dict[str, np.ndarray], Simulation]:
    """Records by channel, and the run."""
    run = Simulation(made, options.pop("step", STEP), record_every=options.pop("every", EVERY), **options)
    _, records = run.advance(STEPS)
    return {c.name: records[:, c.column : c.column + len(c.components)] for c in run.channels}, run


def cut_phases(*actions: Any) -> tuple[Phase, ...]:
    """Phases that end at parts of steps, and do nothing; then one with actions."""
    ends = [(50 * (i + 1) + part) * STEP for i, part in enumerate(PARTS)]
    times = np.diff([0.0, *ends])
    waits = [Phase(f"p{i}", (), (Condition(None, float(time)),)) for i, time in enumerate(times)]
    return (*waits, Phase("last", actions))


def test_phases_that_do_nothing_change_nothing() -> None:
    """Every channel is that of the run without, to a thousandth of its range.

    Extremes to three hundredths: they are of the ends of steps, of which a period of this rope has twenty.
    """
    cut, run = histories(crane(*cut_phases()))
    plain, _ = histories(crane())
    assert len([line for line in run.operation.log if line.event == "done"]) == len(PARTS)
    for name, values in plain.items():
        if name.startswith(("monitor.", "momentum.")) or name.endswith((".drift", "energy.balance")):
            continue
        span = max(float(np.ptp(values)), 1e-6 * float(np.abs(values).max()), 1e-9)
        allowed = 3e-2 if name.endswith(("_max", "_min")) else 1e-3
        assert np.abs(cut[name] - values).max() < allowed * span, name
    assert run.warning == "" or "stand alone" not in run.warning


def test_a_hook_load_is_what_hangs_on_it_at_every_step() -> None:
    """Against the tension of the sling, a rope of its own, which no difference over a step is in."""
    for phases in ((), cut_phases()):
        found, _ = histories(crane(*phases))
        for side in ("", "_max", "_min"):
            np.testing.assert_allclose(
                found[f"hook.hook_load{side}"], found[f"sling.tension{side}"], rtol=2e-3
            )


@pytest.mark.parametrize("part", [0.0, 3e-6, 0.5, 1.0 - 3e-6])
def test_a_hook_load_jumps_to_nothing_when_the_load_is_released(part: float) -> None:
    """What is left on the hook is nothing: for a few steps to what its ropes change by in one, then exactly."""
    phases = (Phase("hold", (), (Condition(None, (100 + part) * STEP),)), Phase("off", (Release("sling"),)))
    found, _ = histories(crane(*phases), every=1)
    load = found["hook.hook_load_min"][:, 0]
    assert load[:99].min() > 0.9 * LOAD * G
    change = np.abs(np.diff(found["hook.rope_load"][100:, 0])).max()
    assert change < 0.4 * LOAD * G
    assert np.abs(found["hook.hook_load"][102:108, 0]).max() < change
    assert load[102:130].min() > -change
    assert np.abs(found["hook.hook_load"][110:125, 0]).max() < 0.01 * change


def test_a_sliver_does_not_shorten_the_steps_behind_it() -> None:
    """Steps that are made: those of the run, and two more for each phase at most; with steps that vary some more."""
    _, run = histories(crane(*cut_phases()))
    assert run._layout.work.control.step_count <= STEPS + 2 * len(PARTS)
    counts = []
    for phases in ((), cut_phases()):
        made = Simulation(crane(*phases), STEP * EVERY, tolerance=1e-6)
        made.advance(STEPS // EVERY)
        counts.append(made._layout.work.control.step_count)
    assert counts[1] <= counts[0] + 6 * len(PARTS)


def test_a_time_that_rounding_puts_behind_a_step_is_at_its_end() -> None:
    """171.6 s in steps of 10 ms: no step of a millionth."""
    phases = (Phase("a", (), (Condition(None, 0.3),)), Phase("b", (), (Condition(None, 0.4),)), Phase("c"))
    _, run = histories(crane(*phases))
    assert run._layout.work.control.step_count == STEPS


@pytest.mark.parametrize(
    "middles", [[0, 0, 0, 0, 1, 1, 1, 1], [0, 0, 0, 0, 7, 0, 0, 0], [2, 2, 2, 2, -1, -1, -1, -1]]
)
def test_a_force_that_jumps_is_not_carried_on_beyond_what_it_was(middles: list[int]) -> None:
    """Means of steps of a jump, and of an impulse: what is recorded at their ends lies between them."""
    m, h = np.array(middles, dtype=float), 0.1
    slopes = np.diff(m) / h
    for n in range(3, len(m)):
        found = steady_force(m[n], slopes[n - 1], slopes[n - 2], slopes[n - 3], h, h)
        assert m.min() - 1e-12 <= found <= m.max() + 1e-12


def test_extremes_that_stand_alone_where_a_step_was_a_sliver_are_told() -> None:
    """One of 300 among values that wave by 2; not where no phase ended within a step, nor beside such a wave."""
    channels = (Channel("hook.load_max", "N", ("",), 0, ""), Channel("hook.load", "N", ("",), 1, ""))
    wave = 10.0 + 2.0 * np.sin(np.arange(60.0))
    records = np.column_stack([wave, wave])
    records[40, 0] += 300.0
    sliver, whole = (40 * 5 + 2 + 1e-5) * STEP, (40 * 5 + 2) * STEP

    def told(rows: np.ndarray, time: float) -> str:
        first, second = LoneExtremes(channels), LoneExtremes(channels)
        first.add(rows[:25])
        second.state = first.state
        second.add(rows[25:])
        return second.warning([time], STEP, 5)

    words = told(records, sliver)
    assert "hook.load_max is 31" in words
    assert f"at {sliver:.9g} s" in words
    assert told(records, whole) == ""
    assert told(records, sliver + 50 * STEP) == ""
    assert told(np.column_stack([wave, wave]), sliver) == ""


def test_extremes_are_the_same_looked_at_one_by_one_or_at_once() -> None:
    """Distances that come one after the other among the largest, also those of rows at the joints of pieces."""
    channels = (Channel("hook.load_max", "N", ("x", "y"), 0, ""), Channel("hook.load_min", "N", ("",), 2, ""))
    records = np.random.default_rng(2).normal(size=(200, 3)) * np.geomspace(1.0, 5.0, 200)[:, None]
    together, single, pieces = (LoneExtremes(channels) for _ in range(3))
    together.add(records)
    for row in records:
        single.add(row[None])
        single.state  # noqa: B018  a look
    for first, last in ((0, 1), (1, 3), (3, 90), (90, 200)):
        pieces.add(records[first:last])
        other = LoneExtremes(channels)
        other.state = pieces.state
        pieces = other
    np.testing.assert_array_equal(single.state, together.state)
    np.testing.assert_array_equal(pieces.state, together.state)
    middle, beside = records[1:-1], (records[:-2], records[2:])
    peaks = (middle - beside[0]) * (middle - beside[1]) > 0.0
    lone = np.where(peaks, np.minimum(*(np.abs(middle - one) for one in beside)), 0.0)
    np.testing.assert_array_equal(together._largest, -np.sort(-lone, axis=0)[:4])


def test_what_stands_still_has_no_extremes_that_stand_alone() -> None:
    """Rounding beside another channel of the same unit that moves."""
    channels = (
        Channel("still.rate_max", "m/s", ("",), 0, ""),
        Channel("other.rate_max", "m/s", ("",), 1, ""),
    )
    wave = 10.0 + 2.0 * np.sin(np.arange(60.0))
    records = np.column_stack([1e-14 * np.sin(np.arange(60.0)), wave])
    records[40, 0] = 1.4e-12
    found = LoneExtremes(channels)
    found.add(records)
    again = LoneExtremes(channels)
    again.state = found.state
    assert again.warning([(40 * 5 + 2 + 1e-5) * STEP], STEP, 5) == ""
    records[40, 0] = 140.0
    found = LoneExtremes(channels)
    found.add(records)
    assert "still.rate_max" in found.warning([(40 * 5 + 2 + 1e-5) * STEP], STEP, 5)
