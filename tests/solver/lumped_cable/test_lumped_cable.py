"""Cables of lumped masses against closed forms: catenary, bar, hanging chain, folded chain."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import j0, jn_zeros

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.bodies.lumped_cable.lumped_cable import LumpedCable
from heavylift.solver.forces.tugger import Tugger
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G = 9.81
WEIGHT = (Gravity(np.array([0.0, 0.0, -G])),)


def pin(point: np.ndarray, name: str = "pin", body: str = "cable") -> Ball:
    """A ball joint of a point of the cable, which is drawn in the world, with the ground."""
    at = JointFrame(np.asarray(point, dtype=np.float64))
    return Ball(name=name, body_a=GROUND, body_b=body, frame_a=at, frame_b=at)


def cable(points: np.ndarray, segments: int, **keys) -> LumpedCable:
    """A cable of 1 kg."""
    given = {"mass": 1.0, "axial_stiffness": 1e5, **keys}
    return LumpedCable(name="cable", points=np.asarray(points, dtype=np.float64), segments=segments, **given)


def columns(run: Simulation) -> dict[str, int]:
    """First column of each channel."""
    found: dict[str, int] = {}
    for channel in run.channels:
        found.setdefault(channel.name, channel.column)
    return found


def test_sag_of_a_catenary_converges_with_the_square_of_the_segment() -> None:
    """An elastic catenary of half the length a and weight w has half the span ``H a/EA + H/w asinh(w a/H)``.

    From this the horizontal force H, and the sag ``w a^2/(2 EA) + H/w (sqrt(1 + (w a/H)^2) - 1)`` (H. M. Irvine, Cable
    Structures, 1981, section 1.3).
    """
    span, length, stiffness = 2.0, 2.6, 1e4
    a, w = 0.5 * length, G / length
    H = brentq(lambda H: H * a / stiffness + H / w * np.arcsinh(w * a / H) - 0.5 * span, 0.1, 100.0)
    sag = w * a * a / (2.0 * stiffness) + H / w * (np.hypot(1.0, w * a / H) - 1.0)
    errors = []
    drop = 0.5 * np.sqrt(length**2 - span**2)
    line = np.array([[0.0, 0.0, 0.0], [0.5 * span, 0.0, -drop], [span, 0.0, 0.0]])
    for segments in (8, 16, 32):
        body = cable(line, segments, axial_stiffness=stiffness)
        scene = Scene((body,), WEIGHT, joints=(pin(line[0]), pin(line[2], "other")))
        run = Simulation(scene, step=1e-3, integrator="dele2", start="equilibrium")
        record = run.record()
        errors.append(-record[columns(run)["cable.position"] + 3 * (segments // 2) + 2] - sag)
    orders = np.log2(np.abs(np.array(errors[:-1]) / np.array(errors[1:])))
    np.testing.assert_allclose(orders, 2.0, atol=0.1)
    assert abs(errors[-1]) < 1e-3 * sag


@pytest.mark.parametrize("mode", [1, 3])
def test_a_bar_with_a_free_end_vibrates_as_its_masses_do(mode: int) -> None:
    """``w = 2 sqrt(k/m) sin((2j-1) pi/(4 n))``, and the step turns the phase by ``2 atan(w h/2)``: to rounding."""
    segments, step, steps = 12, 1e-4, 400
    body = cable([[0, 0, 0], [1.0, 0, 0]], segments, carries="both", axial_stiffness=1e4)
    k, m = body.axial_stiffness * segments, body.mass / segments
    phase = (2 * mode - 1) * np.pi / (4 * segments)
    w = 2.0 * np.sqrt(k / m) * np.sin(phase)
    run = Simulation(Scene((body,), joints=(pin(np.zeros(3)),)), step=step, integrator="dele2")
    kind = run._layout.bodies[0]
    shape = 1e-2 * np.sin(2.0 * phase * np.arange(segments + 1))
    kind.velocity[:, 0] = shape
    records = run.advance(steps)[1]
    tip = records[:, columns(run)["cable.end_position"]] - 1.0
    turned = 2.0 * np.arctan(0.5 * w * step) * np.arange(1, steps + 1)
    np.testing.assert_allclose(tip, shape[-1] / w * np.sin(turned), atol=1e-8 * abs(shape[-1]) / w)


def _crossings(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    at = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    return times[at] + (times[at + 1] - times[at]) * values[at] / (values[at] - values[at + 1])


def _hanging(segments: int, mode: int) -> tuple[LumpedCable, np.ndarray]:
    """A chain along ``J0(j0n sqrt(s/L))``, s the height above its free end, and its nodes."""
    heights = np.linspace(1.0, 0.0, segments + 1)
    root = jn_zeros(0, mode)[-1]
    nodes = np.column_stack([1e-4 * j0(root * np.sqrt(heights)), 0.0 * heights, heights - 1.0])
    nodes[0, 0] = 0.0
    return cable(nodes, segments, axial_stiffness=1e7), nodes


def test_a_hanging_chain_swings_with_the_zero_of_bessels_function() -> None:
    """``w = j01/2 sqrt(g/L)`` (D. Bernoulli 1732), with the square of the length of a segment."""
    wanted = 0.5 * jn_zeros(0, 1)[0] * np.sqrt(G)
    errors = [_swing(*_hanging(segments, 1), 1) / wanted - 1.0 for segments in (20, 40)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)
    assert abs(errors[1]) < 2e-4


def test_the_second_swing_of_a_hanging_chain_has_the_second_zero() -> None:
    """``w = j02/2 sqrt(g/L)``; the shape of a continuum is that of its masses with a little of the others."""
    wanted = 0.5 * jn_zeros(0, 2)[1] * np.sqrt(G)
    assert _swing(*_hanging(40, 2), 2) == pytest.approx(wanted, rel=2e-4)


def _swing(body: LumpedCable, nodes: np.ndarray, mode: int) -> float:
    """Circular frequency of the free end from its first and third passage through the vertical."""
    run = Simulation(Scene((body,), WEIGHT, joints=(pin(nodes[0]),)), step=5e-4, integrator="dele2")
    times, records = run.advance(5000 // mode)
    tip = records[:, columns(run)["cable.end_position"]]
    found = _crossings(np.asarray(times), tip)
    return 2.0 * np.pi / float(found[2] - found[0])


def test_a_folded_chain_falls_faster_than_free_and_keeps_its_energy() -> None:
    """``v^2 = g x (2 L - x)/(L - x)`` of the end that is let go (Calkin and March, Am. J. Phys. 57, 1989)."""
    length, segments, gap = 1.0, 120, 0.01
    fold = 0.5 * (length - gap)
    line = [[0, 0, 0], [0, 0, -fold], [gap, 0, -fold], [gap, 0, 0]]
    body = cable(line, segments, axial_stiffness=2e4)
    run = Simulation(
        Scene((body,), WEIGHT, joints=(pin(np.zeros(3)),)), step=2e-4, integrator="dele2", record_every=10
    )
    times, records = run.advance(1800)
    at = columns(run)
    fallen = -records[:, at["cable.end_position"] + 2]
    reached = 0.7 * length
    time = np.interp(reached, fallen, np.asarray(times))
    wanted = quad(lambda x: np.sqrt((length - x) / (G * x * (2.0 * length - x))), 0.0, reached)[0]
    free = np.sqrt(2.0 * reached / G)
    assert time == pytest.approx(wanted, rel=0.01)
    assert wanted < 0.96 * free
    energy = sum(records[:, at[f"energy.{part}"]] for part in ("kinetic", "elastic", "potential"))
    assert np.ptp(energy) < 1e-9 * G * length


def test_a_slack_cable_neither_pulls_nor_pushes() -> None:
    """Two masses that fly towards each other and past, until the cable stops them and turns them round."""
    body = LumpedCable(
        name="cable", points=np.array([[0, 0, 0], [1.0, 0, 0]]), segments=1, mass=2.0, axial_stiffness=1e4
    )
    run = Simulation(Scene((body,)), step=1e-3, integrator="dele2")
    kind = run._layout.bodies[0]
    kind.velocity[0, 0], kind.velocity[1, 0] = 1.0, -1.0
    records = run.advance(1200)[1]
    at = columns(run)
    speed = records[:, at["cable.velocity"]]
    np.testing.assert_allclose(
        speed[:950], 1.0, rtol=1e-12
    )  # slack, and through each other, till 1 m apart again
    assert np.all(records[:950, at["cable.segment_tension"]] == 0.0)
    np.testing.assert_allclose(speed[-1], -1.0, rtol=1e-9)  # turned round by a spring that keeps its energy


def test_a_damped_cable_loses_what_it_says() -> None:
    """Energy and losses add up to rounding."""
    body = cable([[0, 0, 0], [1.0, 0, 0]], 10, axial_stiffness=1e3, damping_time=2e-3)
    run = Simulation(Scene((body,), WEIGHT, joints=(pin(np.zeros(3)),)), step=1e-3, integrator="dele2")
    records = run.advance(800)[1]
    at = columns(run)
    energy = sum(records[:, at[f"energy.{part}"]] for part in ("kinetic", "elastic", "potential"))
    lost = records[:, at["energy.dissipated"]]
    np.testing.assert_allclose(energy + lost, 0.0, atol=1e-9 * G)
    assert lost[-1] > 1e-3 * G


def test_a_load_on_its_end_is_in_its_tension() -> None:
    """At rest segment i carries the load and the masses below it."""
    segments, load = 5, 7.0
    body = cable([[0, 0, 0], [0, 0, -1.0]], segments, axial_stiffness=1e4)
    block = RigidBody("block", load, np.eye(3), position=np.array([0.0, 0.0, -1.0]))
    end = JointFrame(np.array([0.0, 0.0, -1.0]))
    hook = Ball(name="hook", body_a="cable", body_b="block", frame_a=end, frame_b=JointFrame(np.zeros(3)))
    scene = Scene((body, block), WEIGHT, joints=(pin(np.zeros(3)), hook))
    run = Simulation(scene, step=1e-3, integrator="dele2", start="equilibrium")
    record, at = run.record(), columns(run)
    tension = record[at["cable.segment_tension"] : at["cable.segment_tension"] + segments]
    below = load + 1.0 - (np.arange(segments) + 0.5) / segments
    np.testing.assert_allclose(tension, below * G, rtol=1e-9)
    np.testing.assert_allclose(record[at["cable.largest_tension"]], tension[0])


def test_a_force_between_two_nodes_is_shared() -> None:
    """A pull at a quarter of a segment, of a cable that flies freely, moves its centre as one mass."""
    body = cable([[0, 0, 0], [1.0, 0, 0]], 2)
    pull = Tugger(
        name="pull",
        body_a=GROUND,
        point_a=np.array([0.125, 0.0, 1e6]),
        body_b="cable",
        point_b=np.array([0.125, 0.0, 0.0]),
        tension=3.0,
    )
    run = Simulation(Scene((body,), (pull,)), step=1e-3, integrator="dele2")
    records, at = run.advance(10)[1], columns(run)
    np.testing.assert_allclose(records[-1, at["momentum.linear"] + 2], 3.0 * 0.01, rtol=1e-9)
    speed = records[-1, at["cable.velocity"] + 2 : at["cable.velocity"] + 9 : 3]
    np.testing.assert_allclose(speed, 0.03 * np.array([0.75 / 0.25, 0.25 / 0.5, 0.0]), atol=1e-7)


def test_a_run_that_is_continued_is_bitwise_that_which_was_not() -> None:
    """All that is carried is in the state."""

    def make() -> Simulation:
        body = cable([[0, 0, 0], [0.6, 0, 0], [0.6, 0.4, 0]], 8, damping_time=1e-4)
        return Simulation(
            Scene((body,), WEIGHT, joints=(pin(np.zeros(3)),)), step=1e-3, integrator="dele2", tolerance=1e-5
        )

    whole = make()
    expected = whole.advance(60)[1][30:]
    first = make()
    first.advance(30)
    second = make()
    second.restore(first.state())
    np.testing.assert_array_equal(second.advance(30)[1], expected)


def test_a_fixed_joint_is_refused_with_the_reason() -> None:
    """No direction is known on a line of masses."""
    at = JointFrame(np.zeros(3))
    clamp = FixedJoint(name="clamp", body_a=GROUND, body_b="cable", frame_a=at, frame_b=at)
    with pytest.raises(InputError, match="a direction on 'cable'") as refused:
        Simulation(Scene((cable([[0, 0, 0], [1, 0, 0]], 3),), joints=(clamp,)), step=1e-3, integrator="dele2")
    assert "ball joints" in refused.value.expected


@pytest.mark.parametrize(
    ("keys", "key"),
    [({"segments": 0}, "segments"), ({"points": [[0, 0, 0]]}, "points"), ({"mass": 0.0}, "mass")],
)
def test_what_is_no_cable_names_its_key(keys, key) -> None:
    """Also of an object that was not made from a case."""
    given = {"points": [[0, 0, 0], [1, 0, 0]], "segments": 3, **keys}
    body = cable(given.pop("points"), given.pop("segments"), **given)
    with pytest.raises(InputError) as refused:
        Simulation(Scene((body,)), step=1e-3, integrator="dele2")
    assert refused.value.key == key
    assert refused.value.source == "cable"


def test_integrators_that_do_not_iterate_refuse_it() -> None:
    """With the name of the cable."""
    for integrator in ("accurate", "thesis"):
        with pytest.raises(InputError, match="the step of the cable 'cable' is iterated"):
            Simulation(Scene((cable([[0, 0, 0], [1, 0, 0]], 3),)), step=1e-3, integrator=integrator)


def test_a_search_for_equilibrium_with_contacts_is_refused() -> None:
    """The search meets contacts by frames of bodies, which a cable has not."""
    ball = RigidBody("ball", 1.0, np.eye(3), position=np.array([3.0, 0.0, 0.5]))
    floor = CollisionSurface(name="floor", body=GROUND, surface=box_surface((4.0, 4.0, 0.5)))
    shape = CollisionSurface(name="round", body="ball", surface=box_surface((0.5, 0.5, 0.5)))
    scene = Scene(
        (cable([[0, 0, 0], [0, 0, -2.0]], 4), ball),
        WEIGHT,
        joints=(pin(np.zeros(3)),),
        surfaces=(floor, shape),
        collisions=(Collision(name="landing", surfaces=("round", "floor")),),
    )
    with pytest.raises(InputError, match="contacts and bodies without a frame: frames, shells or cables"):
        Simulation(scene, 1e-3, "dele2", start="equilibrium")
