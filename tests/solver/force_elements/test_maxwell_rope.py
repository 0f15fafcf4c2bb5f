"""Maxwell ropes against closed forms: relaxation, creep, energy through slack and taut."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from law_scenes import DOWN, NONE, G, body, eye, run, wire

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.maxwell_rope import MaxwellRope, stretch_at_end
from heavylift.solver.integrate.choice import choose_integrator
from heavylift.solver.scenario.actions.winch import WinchHaul
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scenario import Condition, Phase, Scenario
from heavylift.solver.scene.scene import Fixed, RigidBody, Scene

STIFFNESS, VISCOSITY = 1e5, 4e5
RATE = STIFFNESS / VISCOSITY


def rope(*places: RopePoint, length: float | None = None, viscosity: float = VISCOSITY) -> MaxwellRope:
    return MaxwellRope(name="rope", path=places, stiffness=STIFFNESS, viscosity=viscosity, length=length)


def at(name: str, x: float, y: float, z: float, **more: object) -> RopePoint:
    return RopePoint(name, np.array([x, y, z]), **more)


def held(viscosity: float = VISCOSITY) -> Scene:
    """A rope of 9.9 m between places 10 m apart."""
    frame = RigidBody("frame", 10.0, np.eye(3), motion=Fixed(), position=np.zeros(3))
    return Scene(
        (frame,),
        ropes=(
            rope(at(GROUND, 0.0, 0.0, 10.0), at("frame", 0.0, 0.0, 0.0), length=9.9, viscosity=viscosity),
        ),
    )


def test_a_stretch_that_is_held_fades() -> None:
    """``T = k e exp(-k t/c)``, of second order in the step, and the damper takes what was stored."""
    errors = []
    for step in (0.1, 0.05):
        found = run(held(), step, 8.0)
        exact = STIFFNESS * 0.1 * np.exp(-RATE * found.times)
        errors.append(np.abs(found["rope.tension"] - exact).max() / exact[0])
        np.testing.assert_allclose(found["rope.creep"], 0.1 - found["rope.tension"] / STIFFNESS, atol=1e-13)
        assert found.balance < 1e-9
        assert found.simulation.periods == ""  # nothing swings on it
    assert errors[1] < 2e-5
    assert 3.8 < errors[0] / errors[1] < 4.2


@pytest.mark.parametrize("ratio", [3.0, 1e6])
def test_a_step_much_longer_than_the_relaxation_leaves_no_tension_and_no_slack(ratio: float) -> None:
    step = 0.1
    found = run(held(STIFFNESS * step / ratio), step, 2.0)
    assert np.all(found["rope.tension"] >= 0.0)
    assert np.all(np.diff(found["rope.tension"]) <= 0.0)
    assert found["rope.tension"][-1] < 1e-3
    np.testing.assert_allclose(found["rope.creep"][-1], 0.1, rtol=1e-9)


def test_under_a_weight_it_creeps_for_ever() -> None:
    """``p = m g t/c``; begun where it hangs on the spring, at the speed of the creep, nothing swings."""
    mass, length = 500.0, 10.0
    stretch, speed = mass * G / STIFFNESS, mass * G / VISCOSITY
    load = body("load", mass, [0.0, 0.0, -length - stretch], [0.0, 0.0, -speed])
    found = run(
        Scene(
            (load,),
            (DOWN,),
            ropes=(rope(at(GROUND, 0.0, 0.0, 0.0), at("load", 0.0, 0.0, 0.0), length=length),),
        ),
        0.01,
        20.0,
        record_every=100,
    )
    np.testing.assert_allclose(found["rope.tension"], mass * G, rtol=1e-11)
    np.testing.assert_allclose(found["rope.creep"], speed * found.times, atol=1e-11)
    np.testing.assert_allclose(found["rope.rest_length"], length + speed * found.times, rtol=1e-12)
    np.testing.assert_allclose(found["energy.dissipated"], mass * G * speed * found.times, atol=1e-7)
    assert np.abs(found["energy.drive_work"]).max() == 0.0
    assert found.balance < 1e-7


def test_over_a_pulley_each_side_gives_way_to_the_other() -> None:
    """Two loads of one weight on a rope over a pulley sink at half of its creep each."""
    mass, length = 200.0, 10.0 + math.pi * 0.5
    weight = mass * G
    stretch, speed = weight / STIFFNESS, weight / VISCOSITY
    z, v = -5.0 - 0.5 * stretch, [0.0, 0.0, -0.5 * speed]
    loads = (body("one", mass, [-0.5, 0.0, z], v), body("two", mass, [0.5, 0.0, z], v))
    over = at(GROUND, 0.0, 0.0, 0.0, radius=0.5, axis=np.array([0.0, 1.0, 0.0]))
    found = run(
        Scene(
            loads,
            (DOWN,),
            ropes=(rope(at("one", 0.0, 0.0, 0.0), over, at("two", 0.0, 0.0, 0.0), length=length),),
        ),
        0.01,
        10.0,
        record_every=100,
    )
    for name in ("one", "two"):
        np.testing.assert_allclose(found[f"{name}.position"][:, 2], z - 0.5 * speed * found.times, atol=1e-9)
    np.testing.assert_allclose(found["rope.segment_tension"], weight, rtol=1e-9)


def test_it_never_pushes_and_creeps_only_while_taut() -> None:
    """A load bounces on it, each time less high: slack and taut, with all energy accounted for."""
    load = body("load", 300.0, [0.0, 0.0, -8.0])
    found = run(
        Scene(
            (load,), (DOWN,), ropes=(rope(at(GROUND, 0.0, 0.0, 0.0), at("load", 0.0, 0.0, 0.0), length=10.0),)
        ),
        2e-3,
        8.0,
    )
    tension, creep = found["rope.tension"], found["rope.creep"]
    slack = tension == 0.0
    assert np.count_nonzero(np.diff(slack.astype(int)) == 1) >= 3
    assert tension.min() >= 0.0
    assert np.all(np.diff(creep) >= 0.0)
    inside = slack[:-1] & slack[1:]
    assert np.diff(creep)[inside].max() == 0.0
    # dp = T dt / c, by the trapezoidal rule of what is recorded
    taken = np.sum(0.5 * (tension[1:] + tension[:-1])) * 2e-3 / VISCOSITY
    np.testing.assert_allclose(creep[-1], taken, rtol=1e-4)
    assert found.balance < 1e-9 * found["energy.dissipated"][-1] + 1e-7


@pytest.mark.parametrize("seed", range(4))
def test_the_stretch_at_the_end_is_that_of_the_damper(seed: int) -> None:
    """``a - e1 = (h/c) T``, T the mean tension of the step: found by bisection, with its derivative."""
    rng = np.random.default_rng(seed)

    def energy(e: float) -> float:
        return 0.5 * max(0.0, e) ** 2

    def mean(e0: float, e1: float) -> float:
        return (energy(e1) - energy(e0)) / (e1 - e0) if e1 != e0 else max(0.0, e0)

    def solved(e0: float, way: float, b: float) -> float:
        a = e0 + way
        low, high = a - 4.0 * (1.0 + b) * (abs(e0) + abs(a)), a
        for _ in range(200):
            e1 = 0.5 * (low + high)
            low, high = (e1, high) if a - e1 > 2.0 * b * mean(e0, e1) else (low, e1)
        return max(low, a - max(e0, a, 0.0))

    for _ in range(200):
        e0, way, b = rng.normal(), rng.normal(), 10.0 ** rng.uniform(-3.0, 1.0)
        e1, slope = stretch_at_end.py_func(e0, way, b)
        assert e1 == pytest.approx(solved(e0, way, b), abs=1e-9)
        ahead, behind = (solved(e0, way + d, b) for d in (1e-5, -1e-5))
        assert slope == pytest.approx((ahead - behind) / 2e-5, abs=1e-4 * (1.0 + b) ** 2)


def test_only_the_default_integrator_serves_it() -> None:
    frame = body("load", 10.0, [0.0, 0.0, -5.0])
    scene = Scene((frame,), (NONE,), ropes=(rope(at(GROUND, 0.0, 0.0, 0.0), at("load", 0.0, 0.0, 0.0)),))
    with pytest.raises(InputError, match="'accurate', but maxwell 'rope' creeps, which its rows carry"):
        run(scene, 1e-3, 1e-2, "accurate", tolerance=1e-6)
    with pytest.raises(InputError, match="'thesis', but rope 'rope' can go slack"):
        run(scene, 1e-3, 1e-2, "thesis")
    assert choose_integrator(scene, 0.1)[0] == "dele2"


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ({"radius": 0.5, "axis": np.array([0.0, 1.0, 0.0])}, "path.0.radius: a pulley at an end"),
        (
            {"efficiency": 0.9},
            "path.0.efficiency: 'efficiency' in a rope of type 'maxwell'; expected type 'wire'",
        ),
    ],
)
def test_what_it_has_not_is_refused(key: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_object(rope(at(GROUND, 0.0, 0.0, 0.0, **key), at("load", 0.0, 0.0, 0.0)))


def beside_a_winch(*actions: object, prepared: tuple[str, ...] = ()) -> Scene:
    """A load on a wire rope, and one on a Maxwell rope beside it."""
    loads = body("load", 100.0, (0, 0, -10.0)), body("other", 100.0, (5.0, 0, -10.0))
    wire_rope = wire(eye(GROUND), eye("load"), name="wire", stiffness=1e7, damping=1e4)
    ropes = (wire_rope, rope(at(GROUND, 5.0, 0, 0), at("other", 0, 0, 0)))
    done = (Condition(None, 1.0),)
    return Scene(
        loads, (DOWN,), ropes=ropes, scenario=Scenario((Phase("up", tuple(actions), done),), prepared)
    )


def test_a_scenario_commands_wire_ropes_beside_it() -> None:
    """The winch hauls its length, and the other rope creeps as it does without a scenario."""
    operation = beside_a_winch(WinchHaul("wire", 0.5, 1.0, acceleration=4.0))
    found = run(operation, 1e-3, 1.0)
    assert found["wire.rest_length"][0] - found["wire.rest_length"][-1] == pytest.approx(0.5, abs=1e-12)
    alone = run(replace(operation, scenario=None), 1e-3, 1.0)
    np.testing.assert_allclose(found["rope.creep"], alone["rope.creep"], rtol=0, atol=1e-12)


def test_a_rope_that_creeps_is_not_prepared_and_not_commanded() -> None:
    for operation in (beside_a_winch(prepared=("rope",)), beside_a_winch(WinchHaul("rope", 0.5, 1.0))):
        with pytest.raises(
            InputError, match=r"'rope' is a rope of type 'maxwell'.*expected a rope of type 'wire'"
        ):
            run(operation, 1e-3, 0.1)
