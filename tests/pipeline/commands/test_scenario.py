"""What is known of an operation before it runs: times and lengths against sums by hand."""

from __future__ import annotations

import math

import pytest

from heavylift.pipeline.assemble.operation_plan import plan
from heavylift.solver.scenario.actions.connect import Connect
from heavylift.solver.scenario.actions.release import Release
from heavylift.solver.scenario.actions.winch import WinchLength, WinchSpeed
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.signals import Signal, Term

ARRIVED = Condition(Signal((Term("fall"),), "arrived"), 0.0)
HEIGHT, LENGTH = Signal((Term("load.position", "z"),)), Signal((Term("fall.rest_length"),))


def planned(*phases: Phase) -> list[tuple[float, float, float, float]]:
    """Shortest and longest time, and length at the end, of each phase; the rope has 50 m at the start."""
    (found,) = plan(Scenario(phases), {"fall": 50.0, "other": 7.0})
    return [(one.takes.low, one.takes.high, one.values["fall"].low, one.values["fall"].high) for one in found]


def test_times_and_lengths_that_are_known() -> None:
    assert planned(
        Phase("up", (WinchSpeed("fall", 0.5, 2.0),), (Condition(None, 10.0),)),  # 0.5 (10 - 1) = 4.5 m
        Phase("to", until=(Condition(LENGTH, 40.0, below=True),)),  # 5.5 m more
        Phase("hold", (WinchSpeed("fall", 0.0, 2.0),), (Condition(None, 5.0),)),  # half a metre in the ramp
        Phase("down", (WinchLength("fall", 45.0, 0.2, 1.0),), (Condition(None, 60.0),)),
        Phase("rest", until=(Condition(None, 1.0), Condition(None, 3.0)), ends_with="any"),
    ) == [
        pytest.approx((10.0, 10.0, 45.5, 45.5)),
        pytest.approx((11.0, 11.0, 40.0, 40.0)),
        pytest.approx((5.0, 5.0, 39.5, 39.5)),
        pytest.approx((60.0, 60.0, 45.0, 45.0)),
        pytest.approx((1.0, 1.0, 45.0, 45.0)),
    ]


def test_what_waits_for_the_load_is_known_up_to_its_timeout() -> None:
    assert planned(
        Phase("up", (WinchSpeed("fall", 0.5),), (Condition(HEIGHT, 3.0, hold=2.0),), timeout=20.0),
        Phase("turn", (WinchSpeed("fall", -0.5, 4.0),), (Condition(None, 4.0),)),
        Phase("on", until=(Condition(HEIGHT, 1.0, below=True),)),
        Phase("to", (WinchLength("fall", 45.0, 0.2),), (Condition(None, 1.0), ARRIVED)),
    ) == [
        pytest.approx((2.0, 20.0, 40.0, 49.0)),
        pytest.approx((4.0, 4.0, 40.0, 49.0)),
        pytest.approx((0.0, math.inf, 40.0, math.inf)),
        pytest.approx((1.0, math.inf, 45.0, 45.0)),
    ]


def test_a_rope_that_is_connected_has_an_unknown_length() -> None:
    *_, last = planned(
        Phase("a", (Release("fall"), WinchSpeed("fall", 0.1)), (Condition(None, 1.0),)),
        Phase("b", (Connect("fall"),)),
    )
    assert last[2:] == (-math.inf, math.inf)
