"""Inputs against closed forms, and against the same motion written as tables."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from input_scenes import GRAVITY, LOAD, MASS, column, driven, hoist
from scipy.linalg import expm

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.inputs.force import ForceInput
from heavylift.solver.inputs.joint_load import JointLoadInput
from heavylift.solver.inputs.moment import MomentInput
from heavylift.solver.inputs.winches import WinchLengthInput, WinchSpeedInput
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import JointFrame, RopePoint, Winch
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

PUSH = ForceInput(name="push", body="load", point=np.zeros(3))


@pytest.mark.parametrize("integrator", ["dele2", "accurate", "thesis"])
def test_a_force_moves_a_mass_as_newton_says(integrator: str) -> None:
    """Constant, reversed, then growing until it is held: x = 1, 2 and 2 + 1/12 + 1/2 m."""
    simulation = Simulation(Scene((LOAD,), inputs=(PUSH,)), 0.1, integrator)
    settings = {0: ("push", 4.0), 10: ("push", -4.0), 20: ("push", 0.0, 1.0, 3.0)}
    records = driven(simulation, settings, 40)
    x, value = column(simulation, "load.position", records)[:, 0], column(simulation, "push.value", records)
    exact = 1e-12 if integrator == "accurate" else 1e-3
    np.testing.assert_allclose(x[[19, 39]], [2.0, 2.0 + 1.0 / 12.0 + 0.5], rtol=exact)
    np.testing.assert_allclose(value[[9, 19, 24, 29, 39]], [4.0, -4.0, 0.5, 1.0, 1.0], rtol=1e-12)
    assert simulation.inputs.value("push") == (1.0, 0.0)


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_force_has_the_bits_of_a_table(frame: Any) -> None:
    """Off the centre of mass, so that the body turns."""
    point, direction = np.array([0.1, 0.2, -0.1]), np.array([0.0, 2.0, 0.0])
    table = PointForce(name="push", body="load", point=point, force=np.array([0.0, 3.0, 0.0]), frame=frame)
    given = replace(PUSH, point=point, direction=direction, frame=frame, value=3.0)
    one = Simulation(Scene((LOAD,), (table,)), 0.01)
    other = Simulation(Scene((LOAD,), inputs=(given,)), 0.01)
    found, expected = other.advance(50)[1], one.advance(50)[1]
    for name in ("load.position", "load.orientation"):
        np.testing.assert_array_equal(column(other, name, found), column(one, name, expected))
    assert abs(column(one, "load.orientation", expected)[-1, 3]) > 1e-2


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_moment_turns_a_body_about_a_principal_axis(integrator: str, frame: Any) -> None:
    """phi = M t^2 / (2 I), and its centre of mass stays where it is."""
    turn = MomentInput(name="turn", body="load", point=np.array([0.3, 0.1, 0.2]), frame=frame)
    simulation = Simulation(Scene((LOAD,), inputs=(turn,)), 0.01, integrator)
    simulation.set_input("turn", 0.2)
    records = simulation.advance(100)[1]
    q = column(simulation, "load.orientation", records)[-1]
    np.testing.assert_allclose(2.0 * math.atan2(q[3], q[0]), 0.2 / (2.0 * 0.5), rtol=1e-6)
    np.testing.assert_allclose(column(simulation, "load.position", records)[-1], 0.0, atol=1e-12)


def test_a_load_along_a_joint_acts_as_a_motor() -> None:
    """On a pendulum, with the bits of a motor; its work is that of an outer force."""
    hinge = Hinge(
        name="pin", body_a="ground", body_b="load",
        frame_a=JointFrame(axes=np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]).T),
        frame_b=JointFrame(np.array([0.5, 0.0, 0.0]), np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]).T),
    )  # fmt: skip
    body = replace(LOAD, position=np.array([-0.5, 0.0, 0.0]))
    one = Simulation(Scene((body,), (JointMotor(name="m", joint="pin", load=1.5),), joints=(hinge,)), 0.01)
    other = Simulation(Scene((body,), joints=(hinge,), inputs=(JointLoadInput(name="m", joint="pin"),)), 0.01)
    other.set_input("m", 1.5)
    expected, found = one.advance(50)[1], other.advance(50)[1]
    angle = column(other, "pin.angle", found)
    np.testing.assert_array_equal(angle, column(one, "pin.angle", expected))
    np.testing.assert_allclose(
        column(other, "energy.external_work", found), 1.5 * angle, rtol=1e-9, atol=1e-12
    )
    assert other.inputs["m"].quantity == "moment or energy"


TIMES, SPEEDS = np.array([0.0, 0.2, 0.5, 0.8]), np.array([0.0, 0.5, 0.5, -0.1])
RAMPS = {
    0: ("haul", 0.0, 0.5 / 0.2, 0.2),
    20: ("haul", 0.5),
    50: ("haul", 0.5, -0.6 / 0.3, 0.8),
}


def rubbing(winch: Winch | None = None, **more: Any) -> Scene:
    """The same over a place that rubs."""
    made = hoist(winch, **more)
    (rope,) = made.ropes
    over = RopePoint("ground", np.array([0.0, 0.0, 5.0]), efficiency=0.9)
    return replace(made, ropes=(replace(rope, path=(rope.path[0], over, rope.path[1])),))


@pytest.mark.parametrize("scene", [hoist, rubbing])
def test_a_winch_speed_has_the_bits_of_a_table(scene: Any, tmp_path: Path) -> None:
    """But for the rounding of a rate; and a state in the middle goes on elsewhere."""
    driving = scene(inputs=(WinchSpeedInput(name="haul", rope="hoist"),))
    one = Simulation(scene(Winch(times=TIMES, speeds=SPEEDS)), 0.01)
    other, third = Simulation(driving, 0.01), Simulation(driving, 0.01)
    expected, found = one.advance(100)[1], driven(other, RAMPS, 70)
    third.set_input("haul", -1.0)
    third.advance(2)
    third.restore(other.state())
    rest = third.advance(30)[1]
    np.testing.assert_array_equal(rest, other.advance(30)[1])
    found = np.concatenate([found, rest])
    for name in ("hoist.tension", "hoist.rest_length", "load.position", "energy.drive_work"):
        np.testing.assert_allclose(column(other, name, found), column(one, name, expected), rtol=1e-9)
    assert column(other, "load.position", found)[-1, 2] > 0.15


def test_the_accurate_integrator_takes_back_what_it_found_behind_a_record() -> None:
    """It is ahead of its records, where an input is set; its error stays that of its tolerance."""
    one = Simulation(hoist(Winch(times=TIMES, speeds=SPEEDS)), 0.01, "accurate", tolerance=1e-9)
    other = Simulation(
        hoist(inputs=(WinchSpeedInput(name="haul", rope="hoist"),)), 0.01, "accurate", tolerance=1e-9
    )
    expected, found = one.advance(100)[1], driven(other, RAMPS, 100)
    for name in ("load.position", "energy.drive_work"):
        np.testing.assert_allclose(
            column(other, name, found), column(one, name, expected), rtol=1e-7, atol=1e-9
        )


def test_a_length_of_a_rope_moves_and_is_held() -> None:
    simulation = Simulation(hoist(inputs=(WinchLengthInput(name="length", rope="hoist"),)), 0.01)
    assert simulation.inputs["length"].interpolation == "linear"
    simulation.set_input("length", 10.0, -2.0, 0.5)
    records = simulation.advance(100)[1]
    rest, value = (
        column(simulation, "hoist.rest_length", records),
        column(simulation, "length.value", records),
    )
    np.testing.assert_allclose(rest[[24, 49, 99]], [9.5, 9.0, 9.0], rtol=1e-12)
    np.testing.assert_allclose(value, rest, rtol=1e-12)


def test_many_settings_of_a_length_do_not_drift() -> None:
    """To the last bit what the input says, after a thousand of them."""
    simulation = Simulation(hoist(inputs=(WinchLengthInput(name="length", rope="hoist"),)), 0.001)
    for index in range(1000):
        now = simulation.inputs.value("length")[0]
        simulation.set_input("length", now, math.sin(index), simulation.time + 0.001)
        records = simulation.advance(1)[1]
    rest, value = (column(simulation, name, records)[0] for name in ("hoist.rest_length", "length.value"))
    assert abs(rest - value) <= 2.0 * np.spacing(value)


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_run_ends_before_a_rope_is_used_up(integrator: str) -> None:
    """Two steps before; what was computed stays, and nothing can be set behind it."""
    scene = hoist(inputs=(WinchSpeedInput(name="haul", rope="hoist", value=4.0),))
    simulation = Simulation(scene, 0.01, integrator)
    times, records = simulation.advance(1000)
    assert simulation.outcome is Outcome.LIMIT_REACHED
    np.testing.assert_allclose(times[-1], 10.0 / 4.0 - 2 * 0.01, rtol=1e-12)
    assert np.all(np.isfinite(records))
    assert simulation.message == "stopped at t = 2.48 s: the winch of 'hoist' has hauled in the whole rope"
    with pytest.raises(InputError, match="the run has ended"):
        simulation.set_input("haul", 0.0)


def test_no_step_of_the_accurate_integrator_goes_beyond_the_end_of_a_rope() -> None:
    """With a rope that is slack its steps are long, and there is no rope behind them."""
    simulation = Simulation(
        hoist(inputs=(WinchSpeedInput(name="haul", rope="hoist"), PUSH)), 0.02, "accurate"
    )
    simulation.set_input("haul", 12.0)
    simulation.advance(10)
    simulation.set_input("push", 1e-3)
    _, records = simulation.advance(100)
    assert simulation.outcome is Outcome.LIMIT_REACHED
    assert np.all(np.isfinite(records))


STIFFNESS, OMEGA, END = 800.0, 3.0, 1.6
"""Of a spring between the mass and the ground [N/m]; of a force sin(omega t) [rad/s]; and the end [s]."""


def exact_end() -> float:
    """x of the mass on its spring under sin(omega t), from rest, by the exponential of its system."""
    A = np.zeros((4, 4))
    A[0, 1], A[1, 0], A[1, 2], A[2, 3], A[3, 2] = 1.0, -STIFFNESS / MASS, 1.0 / MASS, OMEGA, -OMEGA
    return float((expm(A * END) @ [0.0, 0.0, 0.0, 1.0])[0])


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
@pytest.mark.parametrize(("linear", "order"), [(False, 1.0), (True, 2.0)])
def test_the_order_of_inputs_that_are_held_or_linear(integrator: str, linear: bool, order: float) -> None:
    """Of exchange steps of 80, 40 and 20 ms: errors of the interpolation of the force, whatever integrates."""
    spring = Spring(
        name="spring", body_a="ground", point_a=np.array([-5.0, 0.0, 0.0]), body_b="load", point_b=np.zeros(3),
        stiffness=STIFFNESS, length=5.0,
    )  # fmt: skip
    errors = []
    for exchange in (0.08, 0.04, 0.02):
        step = exchange if integrator == "accurate" else 0.0005
        simulation = Simulation(Scene((LOAD,), (spring,), inputs=(PUSH,)), step, integrator)
        for k in range(round(END / exchange)):
            now, then = (math.sin(OMEGA * exchange * i) for i in (k, k + 1))
            if linear:
                simulation.set_input("push", now, (then - now) / exchange, (k + 1) * exchange)
            else:
                simulation.set_input("push", now)
            simulation.advance(round(exchange / step))
        errors.append(abs(column(simulation, "load.position", simulation.record()[None])[0, 0] - exact_end()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, order, atol=0.2)


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_state_goes_on_elsewhere_with_its_inputs(integrator: str, tmp_path: Path) -> None:
    """Through a file, in the middle of a ramp, while other inputs were set where it is restored."""
    scene = hoist(inputs=(WinchSpeedInput(name="haul", rope="hoist"), PUSH))

    def begun() -> Simulation:
        simulation = Simulation(scene, 0.01, integrator)
        simulation.set_input("push", 1.0, 10.0, 0.3)
        simulation.set_input("haul", 0.1, 1.0, 0.25)
        simulation.advance(20)
        return simulation

    first = begun()
    np.savez(tmp_path / "state.npz", **first.state())
    expected = driven(first, {3: ("push", -2.0)}, 20)
    with np.load(tmp_path / "state.npz") as saved:
        state = dict(saved)
    other = Simulation(scene, 0.01, integrator)
    other.set_input("haul", -0.3)
    other.set_input("push", 7.0)
    other.advance(35)
    other.restore(state)
    assert other.inputs.value("push") == pytest.approx((3.0, 10.0))
    np.testing.assert_array_equal(driven(other, {3: ("push", -2.0)}, 20), expected)


ELSEWHERE = """
import sys
import numpy as np
sys.path.insert(0, sys.argv[1])
from input_scenes import hoist
from heavylift.solver.inputs.winches import WinchSpeedInput
from heavylift.solver.simulation import Simulation
simulation = Simulation(hoist(inputs=(WinchSpeedInput(name="haul", rope="hoist"),)), 0.01, sys.argv[2])
with np.load("state.npz") as saved:
    simulation.restore(dict(saved))
np.save("records.npy", simulation.advance(20)[1])
"""


@pytest.mark.slow
@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_state_goes_on_in_another_process(integrator: str, tmp_path: Path) -> None:
    """In the middle of a ramp of a winch that this process set."""
    simulation = Simulation(hoist(inputs=(WinchSpeedInput(name="haul", rope="hoist"),)), 0.01, integrator)
    simulation.advance(3)
    simulation.set_input("haul", 0.1, 1.0, 0.15)
    simulation.advance(7)
    np.savez(tmp_path / "state.npz", **simulation.state())
    folder = str(Path(__file__).resolve().parents[1])
    subprocess.run([sys.executable, "-c", ELSEWHERE, folder, integrator], cwd=tmp_path, check=True)
    np.testing.assert_array_equal(np.load(tmp_path / "records.npy"), simulation.advance(20)[1])


def test_a_step_with_a_tolerance_ends_where_an_input_stops_to_change() -> None:
    """Within an output interval: its error is no larger than where that is a record."""
    scene = Scene((LOAD,), inputs=(PUSH,))
    found = Simulation(scene, 0.1, tolerance=1e-10)
    found.set_input("push", 0.0, 1.0, 0.2345)
    x = column(found, "load.position", found.advance(5)[1])[-1, 0]
    u = 0.2345
    exact = u**3 / 6.0 + (0.5 - u) * u**2 / 2.0 + u * (0.5 - u) ** 2 / 2.0
    np.testing.assert_allclose(x, exact / MASS, rtol=1e-6)
    fixed = Simulation(scene, 0.1)
    with pytest.raises(InputError, match=r"until 0.2345 s, which is within a step of 0.1 s"):
        fixed.set_input("push", 0.0, 1.0, 0.2345)


LIMITED = (
    replace(PUSH, smallest=-5.0, largest=5.0),
    WinchLengthInput(name="length", rope="hoist", smallest=2.0),
)
BAD: tuple[tuple[tuple[Any, ...], str], ...] = (
    (("pusch", 1.0), r"inputs: pusch: 'pusch' is no input; expected one of: push"),
    (("push", math.nan), r"inputs: push: value nan; expected a finite number"),
    (("push", math.inf), r"value inf"),
    (("push", "a lot"), r"value 'a lot'"),
    (("push", None), r"value None"),
    (("push", "1.0"), r"value '1.0'; expected a finite number"),
    (("push", 10**5000), r"value beyond 1e308; expected a finite number"),
    (("push", [1.0, 2.0]), r"value \[1.0, 2.0\]"),
    ((["push"], 1.0), r"'push'.* is no input"),
    (("push", 1.0, math.nan, 1.0), r"rate nan"),
    (("push", 1.0, 1.0, -math.inf), r"until -inf"),
    (("push", 1.0, 0.0, 0.1), r"until 0.1 s, and it is t = 0.1 s; expected a later time"),
    (("push", 6.0), r"6 N; expected -5 N or more, at most 5 N"),
    (("push", 1.0, 10.0, 0.6), r"6 N; expected"),
    (("push", 1.0, 10.0), r"a rate of 10 N/s without end, which leads beyond 5 N; expected 'until'"),
    (("length", 9.0), r"9 m while it is at 10 m, which would be a jump"),
    (("length", 10.0, -1.0, 9.1), r"1 m; expected 2 m or more, a rope has a length"),
    (("length", 10.0, -1.0), r"leads beyond 2 m"),
)


@pytest.mark.parametrize(("setting", "words"), BAD, ids=[str(place) for place in range(len(BAD))])
def test_a_bad_setting_is_refused_and_changes_nothing(setting: tuple[Any, ...], words: str) -> None:
    simulation = Simulation(hoist(inputs=LIMITED), 0.1)
    simulation.set_input("push", 2.0)
    simulation.advance(1)
    before = simulation.state()
    with pytest.raises(InputError, match=words):
        simulation.set_input(*setting)
    for key, value in simulation.state().items():
        np.testing.assert_array_equal(value, before[key])


def test_a_scene_without_inputs_has_none() -> None:
    simulation = Simulation(Scene((LOAD,)), 0.1)
    assert not simulation.inputs
    with pytest.raises(InputError, match=r"'push' is no input; expected a case with \[\[inputs\]\]"):
        simulation.set_input("push", 1.0)


def test_a_run_that_fails_goes_back_with_the_inputs_that_acted() -> None:
    """A force without end breaks a run some calls after it was set; the last good state is that of a shorter run."""
    off = replace(PUSH, point=np.array([0.0, 0.3, 0.0]))
    simulation, other = (Simulation(Scene((LOAD,), inputs=(off,)), 0.01) for _ in range(2))
    for one in (simulation, other):
        one.advance(5)
        one.set_input("push", 10.0, 2e4)
    while simulation.outcome is Outcome.COMPLETED:
        simulation.advance(3)
    assert 10 < simulation.step_index < 1000
    other.advance(simulation.step_index - other.step_index)
    np.testing.assert_array_equal(simulation.record(), other.record())
    assert simulation.inputs.value("push") == other.inputs.value("push")


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
def test_a_setting_that_changes_nothing_has_no_effect(integrator: str) -> None:
    """The same value again, at each of many records."""
    simulations = [Simulation(Scene((LOAD,), (GRAVITY,), inputs=(PUSH,)), 0.01, integrator) for _ in range(2)]
    once = driven(simulations[0], {0: ("push", 3.0)}, 30)
    again = driven(simulations[1], dict.fromkeys(range(30), ("push", 3.0)), 30)
    np.testing.assert_array_equal(again, once)


def test_several_inputs_are_set_all_or_none() -> None:
    simulation = Simulation(hoist(inputs=LIMITED), 0.1)
    simulation.warm_up()
    before = simulation.state()
    with pytest.raises(InputError, match="would be a jump"):
        simulation.set_inputs([("push", 3.0, 0.0, math.inf), ("length", 5.0, 0.0, math.inf)])
    for key, value in simulation.state().items():
        np.testing.assert_array_equal(value, before[key])
