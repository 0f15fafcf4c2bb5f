"""Oil of groups that is lost, gas, cylinders of constant force, and groups that keep their oil exactly."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from vehicles import HEIGHT, MASS, OIL, TYRE, G, block, bump, groups_of, histories, scene, vehicle, yard

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.scenario.actions.fail import Fail
from heavylift.solver.scenario.actions.restore import Restore
from heavylift.solver.scene.bodies import Driven, Fixed, Profile
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.transport import BogieGroup, Levelling, PathLeg
from heavylift.solver.simulation import Simulation
from heavylift.solver.transport.decks import Deck
from heavylift.solver.transport.transporters import Transporters, _fit_group, _settle, _weigh

LOAD = MASS * G / 12


def pressed(times: list[float], rises: list[float], **of_group) -> Scene:
    """A block that is held, on a deck that rises and falls."""
    lift = Profile(times=np.array(times), values=np.array(rises), interpolation="monotone")
    barge = RigidBody("barge", 1e6, np.eye(3) * 1e8, motion=Driven(z=lift))
    groups = tuple(BogieGroup(group.name, group.bogies, load=LOAD, **of_group) for group in groups_of(4))
    transporter = vehicle(groups=groups, bogie_mass=0.0, accept_unstable=True)
    return scene(transporter, (yard(body="barge"),), bodies=(barge, block(motion=Fixed())))


def balance(found: dict[str, np.ndarray]) -> np.ndarray:
    """Energy stored, lost and put in [J]."""
    names = ("kinetic", "potential", "elastic", "dissipated")
    total = np.sum([found[f"energy.{name}"] for name in names], axis=0)
    return np.asarray(total - found["energy.drive_work"] - found["energy.external_work"])


def test_an_accumulator_follows_the_law_of_its_gas() -> None:
    """``F = F0 (1 - s / L)^-1.4`` over 0.2 m, with the tyre in series."""
    length = 0.6
    _, _, found = histories(pressed([0.0, 10.0], [0.0, 0.2], gas_length=length), 1e-2, 12.0, 20)
    force, stroke = found["spmt.wheel_load"][:, 0], found["spmt.stroke_of"][:, 0]
    np.testing.assert_allclose(force, LOAD * (1.0 - stroke / length) ** -1.4, rtol=1e-12)
    rise = found["barge.position"][:, 2]
    np.testing.assert_allclose(stroke, rise - (force - LOAD) / TYRE, atol=1e-6)
    assert force[-1] > 1.5 * LOAD


def test_a_relief_valve_lets_oil_go() -> None:
    """The force stays at that of the valve, and is lower on the way back, by what was lost; its work is booked."""
    top, relief = 0.1, 1.2 * LOAD
    made = pressed([0.0, 10.0, 20.0], [0.0, top, 0.07], oil_stiffness=OIL, relief_force=relief)
    _, times, found = histories(made, 5e-3, 24.0, 20)
    compliance = 1.0 / OIL + 1.0 / TYRE
    lost = top - (relief - LOAD) * compliance
    load = found["spmt.wheel_load"][:, 0]
    assert load.max() == pytest.approx(relief, rel=1e-12)
    assert load[-1] == pytest.approx(max(LOAD + (0.07 - lost) / compliance, 0.0), abs=2e-5 * LOAD)
    assert found["energy.dissipated"][-1] == pytest.approx(12.0 * relief * lost, rel=1e-4)
    drift = balance(found)
    np.testing.assert_allclose(drift, drift[0], atol=2e-4 * found["energy.dissipated"][-1])
    assert times[-1] == pytest.approx(24.0)


def test_leaks_let_the_body_sink() -> None:
    """By their speed, at the force that it weighs; its weight does the work that is lost.

    Pipes carry 20 N of the 141 kN while the cylinders move, so it is slower by 1.4e-4.
    """
    groups = tuple(replace(group, leak_speed=1e-3) for group in groups_of(4))
    transporter = vehicle(groups=groups, bogie_mass=0.0, line_damping=2e4, tyre_damping=1.5e5)
    _, times, found = histories(scene(transporter), 1e-2, 60.0, 100)
    np.testing.assert_allclose(found["spmt.heave"], -1e-3 * (1.0 - 1.4e-4) * times, atol=1e-5)
    assert found["energy.dissipated"][-1] == pytest.approx(MASS * G * 0.06, rel=1e-3)


@pytest.mark.parametrize("pipe", [0.0, 2e4])
def test_constant_force_is_none_of_the_deck(pipe) -> None:
    """Loads as at the start, strokes those of the deck, as in S18 4.4; energy as of a weight on a string."""
    made = pressed([0.0, 10.0, 20.0], [0.0, 0.2, -0.1], constant_force=True)
    made = replace(made, transporters=(replace(made.transporters[0], line_damping=pipe),))
    _, _, found = histories(made, 1e-2, 22.0, 20)
    if pipe == 0.0:
        np.testing.assert_allclose(found["spmt.wheel_load"], LOAD, rtol=1e-12)
    np.testing.assert_allclose(
        found["spmt.stroke_of"][-1], found["barge.position"][-1, 2], atol=1e-6 if pipe == 0.0 else 1e-4
    )
    drift = balance(found)
    np.testing.assert_allclose(drift, drift[0], atol=1e-6 * 12.0 * LOAD * 0.2)


def test_nothing_stands_on_constant_forces() -> None:
    """Refused with the growth of a tilt; and with oil beside it."""
    groups = tuple(BogieGroup(group.name, group.bogies, constant_force=True) for group in groups_of(4))
    with pytest.raises(InputError, match="cannot hold the body upright"):
        Simulation(scene(vehicle(groups=groups)), step=5e-3)
    groups = tuple(replace(group, constant_force=True) for group in groups_of(4))
    with pytest.raises(InputError, match="'oil_stiffness' and 'constant_force'"):
        Simulation(scene(vehicle(groups=groups)), step=5e-3)
    groups = tuple(replace(group, relief_force=0.9 * LOAD) for group in groups_of(4))
    with pytest.raises(InputError, match=r"relief_force: 141428 N of a cylinder of group 'group_1'"):
        Simulation(scene(vehicle(groups=groups)), step=5e-3)


def test_hard_groups_keep_the_sum_of_their_strokes() -> None:
    """T8: three groups of oil that hardly gives way over a bump, 1e-10 m; loads of a group stay equal."""
    groups = groups_of(3, oil=1e16)
    transporter = vehicle(groups=groups, travel_speed=0.2)
    _, _, found = histories(scene(transporter, (yard(), bump(4.5, 2.0, (0.2, 1.5)))), 5e-3, 45.0, 20)
    assert found["spmt.roll"].max() > 0.03
    strokes = found["spmt.stroke_of"]
    for first in (0, 4, 8):
        np.testing.assert_allclose(strokes[:, first : first + 4].sum(axis=1), 0.0, atol=1e-10)
        loads = found["spmt.wheel_load"][:, first : first + 4]
        np.testing.assert_allclose(loads, np.tile(loads[:, :1], (1, 4)), rtol=1e-12)


CANT = np.radians(2.0)
RISE = 1.45 * np.tan(CANT)
"""By which the left side of the road is higher, for wheels 1.45 m apart."""


def canted(**levelling) -> Scene:
    """R12 rolls onto a road whose left side rises by 2 degrees within 2 m."""
    left = Deck(
        name="left",
        sides=np.array([0.2, 5.0]),
        stations=np.array([4.0, 6.0, 60.0]),
        heights=np.array([1e-6, RISE, RISE]),
    )
    transporter = vehicle(
        bogie_mass=0.0,
        travel_speed=0.5,
        line_damping=1e5,
        tyre_damping=1e5,
        levelling=Levelling(**({"speed": 9.5e-3, "time_constant": 5.0} | levelling)),
    )
    return scene(transporter, (yard(), left))


def levelled(times: np.ndarray, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Roll and lift of the front left group of a vehicle always at rest, looked at every 0.1 s."""
    step, stiffness = 0.1, 12.0 / (1.0 / OIL + 1.0 / TYRE)
    lean_more = 1.0 / (1.0 - MASS * G * HEIGHT / (stiffness * 0.725**2))
    dip_more = 1.0 / (1.0 - MASS * G * HEIGHT / (stiffness * 2.1**2))
    x, y = np.array([2.1, 2.1, -2.1, -2.1]), np.array([0.725, -0.725, 0.725, -0.725])
    lift, rolls, lifts = np.zeros(4), [], []
    for time in times:
        lines = np.array([[3.5, 2.1, 0.7]] * 2 + [[-0.7, -2.1, -3.5]] * 2) + 0.5 * time
        road = np.interp(lines, [4.0, 6.0], [0.0, RISE]).mean(axis=1) * (y > 0.0)
        height = road + lift
        roll = (height @ y) / (y @ y) * lean_more
        pitch = -(height @ x) / (x @ x) * dip_more
        rolls.append(roll)
        lifts.append(lift[0])
        wanted = (pitch * x - roll * y) / 5.0
        lift = lift + step * wanted / max(1.0, np.abs(wanted).max() / speed)
    return np.array(rolls), np.array(lifts)


@pytest.mark.parametrize("speed", [9.5e-3, 2e-3])
def test_levelling_follows_a_cant_of_the_road(speed) -> None:
    """Against a plain loop of a vehicle that is always at rest; level after five time constants if pumps can."""
    made = canted(speed=speed)
    _, times, found = histories(made, 1e-2, 60.0, 10)
    rolls, lifts = levelled(times, speed)
    assert np.abs(found["spmt.roll"] - rolls).max() < 0.1 * np.abs(rolls).max()  # it swings at 0.5 Hz
    assert np.abs(found["spmt.levelled"][:, 0] - lifts).max() < 0.01 * np.abs(lifts).max()
    rates = np.diff(found["spmt.levelled"], axis=0) / 0.1
    assert np.abs(rates).max() <= speed * (1.0 + 1e-9)
    if speed > 5e-3:
        assert abs(found["spmt.roll"][times > 20.0 + 25.0]).max() < np.radians(0.02)
        np.testing.assert_allclose(found["spmt.levelled"][-1, 0], -0.5 * RISE, rtol=0.01)
    else:
        assert (np.abs(rates).max(axis=1) > 0.999 * speed).sum() > 80
    drift = balance(found)
    np.testing.assert_allclose(drift, drift[0], atol=1e-5 * MASS * G * RISE)


def test_levelling_leaves_small_tilts_alone_and_goes_on_from_a_checkpoint() -> None:
    """Within its dead angle nothing is pumped any more; a run that goes on is the same bit for bit."""
    made = canted(dead_angle=np.radians(0.5))
    whole, times, found = histories(made, 1e-2, 40.0, 10)
    last = found["spmt.levelled"][times > 38.0]
    assert np.ptp(last, axis=0).max() == 0.0
    assert np.radians(0.2) < abs(found["spmt.roll"][-1]) <= np.radians(0.5)
    first = Simulation(made, step=1e-2, integrator="dele2", record_every=10)
    first.advance(1000)
    second = Simulation(made, step=1e-2, integrator="dele2", record_every=10)
    second.restore(first.state())
    _, records = second.advance(3000)
    column = next(c.column for c in second.channels if c.name == "spmt.levelled")
    np.testing.assert_array_equal(records[-1, column : column + 4], found["spmt.levelled"][-1])
    assert whole.outcome.value == 0


def test_levelling_needs_oil() -> None:
    groups = tuple(BogieGroup(group.name, group.bogies, constant_force=True) for group in groups_of(4))
    made = scene(vehicle(groups=groups, accept_unstable=True, levelling=Levelling(speed=0.01)))
    with pytest.raises(InputError, match="'levelling' of constant forces"):
        Simulation(made, step=5e-3)


@kernel
def fit(kind, group, step, extra):  # type: ignore[no-untyped-def]
    kind.group_state[group].extra = extra
    _fit_group(kind, group, step)
    _settle(kind, group, step)


@kernel
def weigh(kind, group, step):  # type: ignore[no-untyped-def]
    _weigh(kind, group, step, kind.group_state[group].force)


@pytest.mark.parametrize("pipe", [0.0, 2e4])
def test_sums_of_a_group_tell_what_its_bogies_do(pipe) -> None:
    """A group whose bogies all move alike is fitted by their sums: loads, strokes and force are those of each of them.

    Until one comes to its stop, or leaves the road: then each has its own.
    """
    rng = np.random.default_rng(8)
    transporter = vehicle(line_damping=pipe, tyre_damping=0.5 * pipe, stroke_limits=np.array([-0.3, 0.3]))
    run = Simulation(scene(transporter), step=1e-2)
    run.advance(1)
    (kind,) = (one for one in run._layout.joints if isinstance(one, Transporters))
    group, state, bogies = kind.groups[0], kind.group_state[0], kind.bogie_state
    heights, rates = rng.uniform(-0.03, 0.04, group.count), rng.uniform(-0.01, 0.01, group.count)
    bogies["middle"][: group.count], bogies["growth"][: group.count] = heights, rates
    bogies["stroke"][: group.count] = heights + rng.uniform(-1e-3, 1e-3, group.count)
    state.strokes = state.drift = state.even = 0
    evens = []
    for extra in (0.0, 0.02, -0.03, 1.5, 45.0, -60.0, 0.0):
        fit(kind, 0, 1e-2, extra)
        evens.append(bool(state.even))
        found = {name: bogies[name][: group.count].copy() for name in ("mean", "end_stroke", "extra")}
        sums = state.total, state.loads, state.force
        weigh(kind, 0, 1e-2)
        for name, values in found.items():
            scale = {"mean": LOAD, "end_stroke": 0.1, "extra": 1.0}[name]
            np.testing.assert_allclose(values, bogies[name][: group.count], rtol=1e-11, atol=1e-11 * scale)
        np.testing.assert_allclose(sums[:2], (state.total, state.loads), rtol=1e-11, atol=1e-11)
        grown = state.total + 0.5 * (state.oil + state.next_oil)
        expected = max(group.start_force + group.stiffness * grown, 0.0)
        assert sums[2] == pytest.approx(expected, rel=1e-10, abs=1e-6)
        assert np.all((found["end_stroke"] >= -0.3) & (found["end_stroke"] <= 0.3))
    assert evens[:3] == [True] * 3
    assert pipe == 0.0 or not all(evens)  # without pipes all leave the road together


def plane_model(tau: float, pipe: float, rubber: float) -> np.ndarray:
    """Eigenvalues of the pitch of 321.853 t on eight lines of four bogies, front and rear, that turns about the road.

    Pitch, its rate, strokes of the lines, lift of the front; own equations, without looks: pumps follow the tilt.
    """
    x = -4.9 + 1.4 * np.arange(8)
    k, oil, weight = 3e6, 9.7e6, 321853.0 * 9.81
    J = 2.3e7 + 321853.0 * 6.3**2
    front = np.where(x > 0.0, 1.0, -1.0)
    A = np.zeros((11, 11))
    A[0, 1] = 1.0
    for i in range(8):
        row = np.zeros(11)
        row[2 + i] -= k
        row[0] -= k * x[i]
        row[1] -= rubber * x[i]
        row[2:10] -= oil / 4.0 * (front == front[i])
        row[10] += oil * front[i]
        A[2 + i] = row / (pipe + rubber)
    A[1, 0] += weight * 6.3 / J
    for i in range(8):
        load = rubber * A[2 + i]
        load[2 + i] += k
        load[0] += k * x[i]
        load[1] += rubber * x[i]
        A[1] -= 4.0 * x[i] * load / J
    A[10, 0] = 2.8 / tau
    return np.linalg.eigvals(A)


def levelled_vehicle(tau: float, *, period: float = 1e-3, **more) -> Scene:
    """The same vehicle on its path: four groups of eight bogies at the corners."""
    lines = -4.9 + 1.4 * np.arange(8)
    groups = tuple(
        BogieGroup(
            f"g{front}{left}",
            np.array([(x, s * y, 0.0) for x in lines if (x > 0.0) == front for y in (3.275, 4.725)]),
            oil_stiffness=9.7e6,
        )
        for front in (True, False)
        for left, s in ((True, 1.0), (False, -1.0))
    )
    body = RigidBody(
        "block", 321853.0, np.diag([1.6e7, 2.3e7, 2.8e7]), centre_of_mass=np.array([0.0, 0.0, 6.3])
    )
    given = {
        "tyre_damping": 15e3,
        "line_damping": 20e3,
        "bogie_mass": 0.0,
        "legs": (PathLeg(points=np.array([[20.0, 0.0]]), speed=0.1),),
        "levelling": Levelling(speed=9.5e-3, time_constant=tau, period=period),
    }
    return scene(vehicle(groups=groups, **(given | more)), (yard(),), body=body)


@pytest.mark.parametrize("tau", [2.0, 5.0, 7.0])
def test_levelling_that_drives_its_vehicle_is_refused_with_the_rate_of_growth(tau) -> None:
    """Against a model of its own of the pitch in the plane: +0.047 +- 3.94i 1/s at 5 s."""
    values = plane_model(tau, 20e3, 15e3)
    worst = values[np.argmax(values.real)]
    assert worst.real > 1e-3
    if tau == 5.0:
        assert (worst.real, abs(worst.imag)) == pytest.approx((0.047, 3.94), abs=5e-3)
    with pytest.raises(InputError, match="levelling drives what it is to calm") as caught:
        Simulation(levelled_vehicle(tau), 1e-2)
    told = re.search(r"exp\(t (\S+) 1/s\) at (\S+) rad/s", str(caught.value))
    assert float(told[1]) == pytest.approx(worst.real, rel=0.03, abs=3e-4)
    assert float(told[2]) == pytest.approx(abs(worst.imag), rel=5e-3)
    Simulation(levelled_vehicle(tau, accept_unstable=True), 1e-2)


def test_levelling_that_calms_its_vehicle_is_not_refused() -> None:
    """10 s, as the model of its own says; with dampers five times as strong 5 s too."""
    for tau, stronger in ((10.0, 1.0), (5.0, 5.0)):
        assert plane_model(tau, stronger * 20e3, stronger * 15e3).real.max() < 1e-9
        Simulation(levelled_vehicle(tau, tyre_damping=stronger * 15e3, line_damping=stronger * 20e3), 1e-2)


@pytest.mark.slow
@pytest.mark.parametrize(("tau", "grows"), [(5.0, True), (12.0, False)])
def test_the_rate_by_which_levelling_grows_is_that_of_a_run(tau, grows) -> None:
    """After a push: 40 s of pitch grow or fall as the eigenvalue says."""
    made = levelled_vehicle(tau, period=0.1, accept_unstable=True)
    (body,) = made.bodies
    pushed = replace(made, bodies=(replace(body, angular_velocity=np.array([0.0, 2e-4, 0.0])),))
    _, times, found = histories(pushed, 1e-2, 80.0, 5)
    pitch = np.abs(found["spmt.pitch"])
    first, last = pitch[(times > 20.0) & (times < 30.0)].max(), pitch[(times > 60.0) & (times < 70.0)].max()
    rate = math.log(last / first) / 40.0
    expected = plane_model(tau, 20e3, 15e3)
    swaying = expected[np.abs(expected.imag) > 1.0].real.max()
    assert rate == pytest.approx(swaying, abs=6e-3)
    assert (rate > 0.0) == grows


def test_levelling_that_fails_leaves_its_groups_where_they_are() -> None:
    """From when on nothing is lifted, until it works again; then it goes on to what is level."""
    still = lambda seconds, *actions: Phase(f"p{seconds}", actions, (Condition(None, seconds),))  # noqa: E731
    phases = (
        still(10.0),
        still(5.0, Fail("spmt", "levelling")),
        still(60.0, Restore("spmt", "levelling")),
    )
    made = replace(canted(speed=5e-3), scenario=Scenario(phases))
    run, times, found = histories(made, 2e-2, 60.0, 5)
    lifts = found["spmt.levelled"][:, 0]
    failed = (times > 10.0 + 1e-6) & (times < 15.0 + 1e-6)
    assert abs(lifts[failed][0]) > 1e-3
    np.testing.assert_allclose(lifts[failed], lifts[failed][0], atol=1e-12)
    assert abs(lifts[-1]) > 1.05 * abs(lifts[failed][0])
    plain = histories(canted(speed=5e-3), 2e-2, 9.0, 5)[2]["spmt.levelled"][:, 0]
    np.testing.assert_array_equal(lifts[: len(plain)], plain)
    assert run.outcome is Outcome.COMPLETED
