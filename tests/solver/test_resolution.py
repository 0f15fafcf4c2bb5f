"""Steps in a period of what moves: against the midpoint rule in closed form; what is told, and what is not."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.spring import Spring
from heavylift.solver.integrate.resolution import ENOUGH
from heavylift.solver.scene.bodies import Driven, Fixed, Harmonic, Profile
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.contacts import Contact, Contour, LinearLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Sea
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.waves.wave_trains import regular_wave

G, MASS = 9.81, 1e4
DOWN = Gravity(np.array([0.0, 0.0, -G]))


def load(*position: float, velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> RigidBody:
    return RigidBody("load", MASS, MASS * np.eye(3), position=np.array(position), velocity=np.array(velocity))


def on_rope(stiffness: float, body: RigidBody, length: float | None = 10.0) -> Scene:
    """A load on a rope of 10 m, or as drawn, from the origin."""
    path = (RopePoint(GROUND, np.zeros(3)), RopePoint("load", np.zeros(3)))
    rope = Rope(name="rope", path=path, axial_stiffness=10.0 * stiffness, length=length)
    return Scene((body,), (DOWN,), ropes=(rope,))


def ran(scene: Scene, step: float, steps: int, **options: object) -> Simulation:
    simulation = Simulation(scene, step, **options)
    simulation.record()
    simulation.advance(steps)
    return simulation


def counted(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    kind = next(kind for kind in simulation._layout.forces if type(kind).__name__ == "StepCounts")
    owner = np.zeros(len(kind.inertia), dtype=np.int64)
    return kind.of_bodies(owner, 1)


@pytest.mark.parametrize("steps", [5.0, 20.0, 60.0])
@pytest.mark.parametrize("periods", [20, 200])
def test_an_oscillation_has_as_many_steps_as_the_midpoint_rule_gives_it(steps: float, periods: int) -> None:
    """``tan(w' h/2) = w h/2``: the rule oscillates with w'. Beyond the first steps pairs are samples of the rest."""
    period = 0.5
    frequency, step = 2.0 * math.pi / period, period / steps
    spring = Spring(
        name="spring",
        body_a=GROUND,
        point_a=np.array([-5.0, 0.0, 0.0]),
        body_b="load",
        point_b=np.zeros(3),
        length=5.0,
        stiffness=MASS * frequency**2,
    )
    moving = load(0.0, 0.0, 0.0, velocity=(1.0, 0.0, 0.0))
    simulation = ran(Scene((moving,), (spring,)), step, round(periods * steps))
    expected = math.pi / math.atan(0.5 * frequency * step)
    found, energy = counted(simulation)
    assert found[0] == pytest.approx(expected, rel=0.02)
    assert energy[0] == pytest.approx(0.25 * MASS, rel=0.05)  # of the mean of the kinetic energy
    assert ("long for what moves: 'load'" in simulation.warning) == (expected < ENOUGH)


def test_what_bounces_within_a_few_steps_is_told_though_it_flies_in_many() -> None:
    """Taut for 0.03 s of 1.3 s: velocities have hundreds of steps in a period, the bounce has six."""
    scene = on_rope(1e8, load(0.0, 0.0, -8.0))
    coarse, fine = ran(scene, 1e-2, 2000), ran(scene, 1e-3, 20000)
    assert "taken up within a few steps by 'rope' with 6.3 steps" in coarse.warning
    assert "long for what moves" not in coarse.warning
    assert not fine.warning


@pytest.mark.parametrize("step", [0.01, 0.1])
def test_a_rope_that_only_carries_may_have_any_period(step: float) -> None:
    """At rest and hung up in its weight: five steps and half a step in its own period, and nothing to say."""
    stiffness = MASS * (2.0 * math.pi / 0.05) ** 2
    simulation = ran(on_rope(stiffness, load(0.0, 0.0, -10.0), None), step, 500, start="equilibrium")
    assert not simulation.warning
    assert "of 'rope' (0.05 s)" in simulation.periods
    assert simulation.periods.startswith(f"steps in a period: {0.05 / step:.2g} of")


def test_a_load_that_swings_on_a_stiff_rope_has_the_steps_of_its_swing() -> None:
    """Seven steps in the period of the rope, six hundred in that of the pendulum."""
    angle, stiffness = 0.3, MASS * (2.0 * math.pi / 0.07) ** 2
    stretched = 10.0 + MASS * G * math.cos(angle) / stiffness
    hung = load(stretched * math.sin(angle), 0.0, -stretched * math.cos(angle))
    simulation = ran(on_rope(stiffness, hung), 1e-2, 2000)
    assert not simulation.warning
    # the speed of a small swing is one oscillation, and across it there is a second one of twice the frequency
    assert counted(simulation)[0][0] == pytest.approx(2.0 * math.pi * math.sqrt(10.0 / G) / 1e-2, rel=0.1)


@pytest.mark.parametrize(("steps", "told"), [(5.0, True), (40.0, False)])
def test_a_compliant_contact_that_is_hit(steps: float, told: bool) -> None:
    radius, period, mass = 0.1, 0.02, 10.0
    grid = [*np.meshgrid(np.linspace(-2, 2, 5), np.linspace(-2, 2, 5), indexing="ij"), np.zeros((5, 5))]
    ball = RigidBody("ball", mass, np.eye(3), position=np.array([0.0, 0.0, radius + 0.5]))
    touch = Contact(
        name="touch",
        contour="floor",
        body="ball",
        shape=SphereShape(radius),
        law=LinearLaw(mass * (2.0 * math.pi / period) ** 2),
        friction=0.0,
    )
    floor = Contour(name="floor", body="ground", neutral=neutral_surface(np.stack(grid, axis=2)))
    scene = Scene((ball,), (DOWN,), contours=(floor,), contacts=(touch,))
    simulation = ran(scene, period / steps, round(1.0 / (period / steps)))
    assert ("'touch' with 5 steps" in simulation.warning) == told


def test_waves_are_among_the_periods() -> None:
    sea = Sea(waves=regular_wave(2.0, 8.0, 0.0))
    moving = load(0.0, 0.0, 0.0, velocity=(1.0, 0.0, 0.0))
    simulation = ran(Scene((moving,), (DOWN,), sea=sea), 0.5, 2)
    assert simulation.periods == "steps in a period: 16 of short waves (8 s)"


def test_a_restart_counts_the_same() -> None:
    scene = on_rope(1e6, load(0.0, 0.0, -8.0))
    whole, first, second = ran(scene, 0.1, 1000), ran(scene, 0.1, 530), Simulation(scene, 0.1)
    second.restore(first.state())
    second.advance(470)
    assert np.array_equal(counted(whole)[0], counted(second)[0])
    assert whole.warning == second.warning != ""


def test_steps_that_vary_are_not_counted() -> None:
    scene = on_rope(1e6, load(0.0, 0.0, -8.0))
    simulation = ran(scene, 0.1, 20, tolerance=1e-4)
    assert simulation.periods == ""
    assert "steps in a period" not in simulation.warning


@pytest.mark.parametrize(("steps", "told"), [(6.0, True), (60.0, False)])
def test_a_light_load_beside_a_ship_is_looked_at(steps: float, told: bool) -> None:
    """It has a ten thousandth of the energy of what moves slowly beside it, and a fifth of its speed."""
    ship = RigidBody(
        "ship",
        2e7,
        2e7 * np.eye(3),
        position=np.array([0.0, 50.0, 0.0]),
        velocity=np.array([2.0, 0.0, 0.0]),
    )
    frequency = 2.0 * math.pi / 0.5

    def spring(body: str, y: float, stiffness: float) -> Spring:
        return Spring(
            name=f"spring_{body}",
            body_a=GROUND,
            point_a=np.array([-20.0, y, 0.0]),
            body_b=body,
            point_b=np.zeros(3),
            stiffness=stiffness,
            length=20.0,
        )

    scene = Scene(
        (ship, load(0.0, 0.0, 0.0, velocity=(0.4, 0.0, 0.0))),
        (spring("ship", 50.0, 2e7 * 0.3**2), spring("load", 0.0, MASS * frequency**2)),
    )
    simulation = ran(scene, 0.5 / steps, int(20.0 * steps))
    assert ("'load'" in simulation.warning) is told
    assert "'ship'" not in simulation.warning


def over_a_sheave(period: float, efficiency: float = 0.98) -> Scene:
    """A hook that is driven up and down pulls a load over a sheave on the ground."""
    hook = RigidBody(
        "hook",
        10.0,
        np.eye(3),
        position=np.array([0.0, 0.0, -5.0]),
        motion=Driven(z=Profile(harmonics=(Harmonic(0.1, 1.0 / period),))),
    )
    path = (
        RopePoint("hook", np.zeros(3)),
        RopePoint(GROUND, np.array([0.5, 0.0, 0.0]), 0.5, np.array([0.0, 1.0, 0.0]), efficiency=efficiency),
        RopePoint("load", np.zeros(3)),
    )
    rope = Rope(name="rope", path=path, axial_stiffness=1e9, damping=1e7, tension=MASS * G)
    return Scene((load(1.0, 0.0, -5.0), hook), (DOWN,), ropes=(rope,))


@pytest.mark.parametrize(("steps", "told"), [(4, True), (8, True), (16, True), (40, False)])
def test_a_speed_over_sheaves_that_turns_within_a_few_steps_is_told(steps: int, told: bool) -> None:
    """``q = V cos w t``: ``sum (q_n - q_n-1)^2 / sum q_n^2 = 4 sin^2(pi/N)`` with N steps in a period."""
    simulation = ran(over_a_sheave(4.0), 4.0 / steps, 20 * steps)
    found = re.search(r"over sheaves with friction turns .*'rope' with ([\d.]+) steps", simulation.warning)
    assert (found is not None) == told
    if found:
        assert float(found[1]) == pytest.approx(steps, rel=0.1)


def test_sheaves_without_friction_and_ropes_at_rest_are_not_looked_at() -> None:
    assert "over sheaves" not in ran(over_a_sheave(4.0, 1.0), 0.5, 160).warning
    still = over_a_sheave(4.0)
    held = tuple(replace(one, motion=Fixed()) if one.name == "hook" else one for one in still.bodies)
    assert "over sheaves" not in ran(replace(still, bodies=held), 0.5, 160).warning


@pytest.mark.parametrize("drive", ["frame", "winch"])
@pytest.mark.parametrize(("step", "told"), [(0.15, "1.3"), (0.1, "2"), (0.05, None)])
def test_ramps_of_few_steps_are_told(drive: str, step: float, told: str | None) -> None:
    """0.2 s over the step; a jump is no ramp, and none is what the run does not come to."""
    times, speeds = np.array([0.0, 0.2, 1.0, 1.001, 10.0, 10.1]), np.array([0.0, 0.02, 0.02, 0.01, 0.01, 0.0])
    path = (RopePoint("hook", np.zeros(3)), RopePoint("load", np.zeros(3)))
    winch = Winch(times, speeds) if drive == "winch" else None
    rope = Rope(name="rope", path=path, axial_stiffness=1e7, damping=1e6, tension=MASS * G, winch=winch)
    motion = Driven(z=Profile(times=times, speeds=speeds)) if drive == "frame" else Fixed()
    hook = RigidBody("hook", 10.0, np.eye(3), motion=motion)
    simulation = ran(Scene((load(0.0, 0.0, -5.0), hook), (DOWN,), ropes=(rope,)), step, 40)
    name = "rope" if drive == "winch" else "hook"
    expected = f"by '{name}' with {told} steps in a ramp"
    assert (expected in simulation.warning) if told else ("steps in a ramp" not in simulation.warning)
