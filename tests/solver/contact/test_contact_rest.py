"""Rest of scenes with contacts, before time starts: penetrations, ropes that take a part, what nothing holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.scene.bodies import Driven, Harmonic, Profile
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.contacts import Contact, Contour, HertzLaw, LinearLaw, RigidLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G, MASS, RADIUS = 9.81, 100.0, 0.1
WEIGHT = Gravity(np.array([0.0, 0.0, -G]))
GRID = np.stack(
    [*np.meshgrid(np.linspace(-2, 2, 5), np.linspace(-2, 2, 5), indexing="ij"), np.zeros((5, 5))], axis=2
)
FLOOR = Contour(name="floor", body="ground", neutral=neutral_surface(GRID))


def ball(law: Any, **more: Any) -> Scene:
    """A ball 20 mm over a floor."""
    body = RigidBody("ball", MASS, 0.4 * MASS * RADIUS**2 * np.eye(3), position=np.array([0.0, 0.0, 0.12]))
    touch = Contact(
        name="touch", contour="floor", body="ball", shape=SphereShape(RADIUS), law=law, friction=0.3
    )
    return Scene(bodies=(body,), forces=(WEIGHT,), contours=(FLOOR,), contacts=(touch,), **more)


def rest(scene: Scene, duration: float = 0.1) -> tuple[dict[str, np.ndarray], Simulation]:
    simulation = Simulation(scene, 1e-3, record_every=1, start="equilibrium")
    row = simulation.record()
    rows = np.vstack([row, simulation.advance(round(duration / 1e-3))[1]])
    return {channel.name: rows[:, channel.column :] for channel in simulation.channels}, simulation


@pytest.mark.parametrize(
    ("law", "depth"),
    [
        (LinearLaw(1e6, 1e2), MASS * G / 1e6),
        (HertzLaw(1e8), (MASS * G / 1e8) ** (2.0 / 3.0)),
        (RigidLaw(0.3), 0.0),
    ],
)
def test_a_ball_rests_where_its_contact_carries_it(law: Any, depth: float) -> None:
    """And stays there; nothing of the way down is in what it records."""
    found, simulation = rest(ball(law))
    np.testing.assert_allclose(found["ball.position"][:, 2], RADIUS - depth, atol=2e-8)
    np.testing.assert_allclose(found["touch.normal_force"][1:, 0], MASS * G, rtol=1e-4)
    assert np.abs(found["touch.dissipated"][:, 0]).max() < 1e-6
    assert found["touch.impacts"][0, 0] == 0.0
    assert np.ptp(found["energy.balance"][:, 0]) < 1e-6
    assert "at rest with its contacts" in simulation.start_text
    assert simulation.time == pytest.approx(0.1)


@pytest.mark.parametrize("step", [10.0, 1e-2, 1e-6])
def test_the_rest_does_not_depend_on_the_step(step: float) -> None:
    """Nor on how strongly the contact is damped: what creeps has little energy long before it is at rest."""
    for damping in (1e2, 1e5):
        simulation = Simulation(ball(LinearLaw(1e6, damping)), step, start="equilibrium")
        row = simulation.record()
        place = next(channel.column for channel in simulation.channels if channel.name == "ball.position")
        assert row[place + 2] == pytest.approx(RADIUS - MASS * G / 1e6, abs=5e-4 * MASS * G / 1e6)
        assert "open" not in simulation.start_text
        assert not simulation.warning


def test_a_spring_and_a_soft_floor_share_a_load_without_gravity() -> None:
    """Each bears what its stiffness says, though no weight tells how long a step may be."""
    spring = Spring(
        name="spring",
        body_a=GROUND,
        point_a=np.array([0.0, 0.0, 1.12]),
        body_b="ball",
        point_b=np.zeros(3),
        stiffness=5e3,
        length=1.02,
    )
    scene = ball(LinearLaw(1e4, 1e2))
    push = PointForce("push", "ball", np.zeros(3), force=np.array([0.0, 0.0, -300.0]))
    scene = replace(scene, forces=(push, spring))
    found, _ = rest(scene, 0.01)
    # 300 = 5e3 (depth) + 1e4 depth, with the spring unstretched where the ball just touches
    np.testing.assert_allclose(found["ball.position"][0, 2], RADIUS - 300.0 / 1.5e4, atol=1e-6)


def test_friction_that_leaves_the_rest_open_is_told() -> None:
    """Dropped on a slope with friction, a box comes to lie at another place on every way to it."""
    tilted = Gravity(G * np.array([np.sin(0.2), 0.0, -np.cos(0.2)]))
    scene = replace(box_on_plane(RigidLaw()), forces=(tilted,))
    simulation = Simulation(scene, 1e-3, start="equilibrium")
    simulation.record()
    assert (
        "friction leaves the position of rest undetermined: two searches end with 'box'"
        in simulation.start_text
    )


def test_a_rope_takes_its_share_of_what_lies_on_the_floor() -> None:
    """Tension given: the rest is on the contact, and the length of the rope follows."""
    rope = Rope(
        name="hoist",
        path=(RopePoint(GROUND, np.array([0.0, 0.0, 10.12])), RopePoint("ball", np.zeros(3))),
        axial_stiffness=1e6,
        tension=0.4 * MASS * G,
    )
    found, _ = rest(ball(LinearLaw(1e6, 1e2), ropes=(rope,)))
    np.testing.assert_allclose(found["hoist.tension"][:, 0], 0.4 * MASS * G, rtol=2e-4)
    np.testing.assert_allclose(found["touch.normal_force"][:, 0], 0.6 * MASS * G, rtol=2e-4)
    np.testing.assert_allclose(found["ball.position"][:, 2], RADIUS - 0.6 * MASS * G / 1e6, atol=1e-7)


@pytest.mark.parametrize("step", [1e-3, 0.1])
@pytest.mark.parametrize("driven", ["winch", "frame", "harmonic"])
def test_drives_stand_where_they_are_at_the_beginning(driven: str, step: float) -> None:
    """A rope of stiffness k to a hook that sets off at once: ``k (10.12 m - z - 10.02 m) + c (R - z) = m g``."""
    rope, floor, length = 1e5, 1e6, 10.02
    profile = {
        "winch": None,
        "frame": Profile(times=np.array([0.0, 1.0, 2.0]), speeds=np.array([0.0, 1.0, 1.0])),
        "harmonic": Profile(harmonics=(Harmonic(0.05, 2.0, np.pi / 6.0),)),
    }[driven]
    height = 10.12 - (0.025 if driven == "harmonic" else 0.0)  # 0.05 m sin(30 degrees)
    hook = RigidBody("hook", 10.0, np.eye(3), position=np.array([0.0, 0.0, height]), motion=Driven(z=profile))
    hoist = Rope(
        name="hoist",
        path=(RopePoint("hook", np.zeros(3)), RopePoint("ball", np.zeros(3))),
        axial_stiffness=rope * length,
        length=length,
        winch=Winch(np.array([0.0, 1.0]), np.array([0.5, 0.5])) if driven == "winch" else None,
    )
    scene = ball(LinearLaw(floor, 1e2), ropes=(hoist,))
    simulation = Simulation(
        replace(scene, bodies=(*scene.bodies, hook)), step, record_every=1, start="equilibrium"
    )
    row = simulation.record()
    column = {channel.name: channel.column for channel in simulation.channels}
    z = (floor * RADIUS + rope * (10.12 - length) - MASS * G) / (floor + rope)
    assert row[column["ball.position"] + 2] == pytest.approx(z, abs=1e-7)
    assert row[column["hoist.tension"]] == pytest.approx(rope * (10.12 - length - z), rel=1e-4)
    simulation.advance(1)
    speeds = {"winch": 0.0, "frame": step, "harmonic": 0.2 * np.pi * np.cos(4.0 * np.pi * step + np.pi / 6.0)}
    speed = speeds[driven]
    assert simulation.record()[column["hook.velocity"] + 2] == pytest.approx(speed, abs=1e-12)


def box_on_plane(law: Any) -> Scene:
    """Held 30 mm over a plane, tilted by 3 degrees."""
    turn = np.array([np.cos(np.radians(1.5)), np.sin(np.radians(1.5)), 0.0, 0.0])
    inertia = MASS / 12.0 * np.diag([0.29, 1.04, 1.25])
    box = RigidBody("box", MASS, inertia, position=np.array([0.0, 0.0, 0.13]), orientation=turn)
    surfaces = (
        CollisionSurface(name="plane", body=GROUND, surface=plane_surface((4.0, 4.0))),
        CollisionSurface(name="skin", body="box", surface=box_surface((1.0, 0.5, 0.2))),
    )
    pair = Collision(name="fall", surfaces=("plane", "skin"), law=law, friction=0.5)
    return Scene(bodies=(box,), forces=(WEIGHT,), surfaces=surfaces, collisions=(pair,))


def test_a_tilted_box_settles_on_a_plane_of_triangles() -> None:
    """It lies flat, and its contacts bear its weight."""
    found, _ = rest(box_on_plane(RigidLaw()))
    np.testing.assert_allclose(found["fall.normal_force"][1:, 0], MASS * G, rtol=1e-6)
    np.testing.assert_allclose(found["box.position"][:, 2], 0.1, atol=1e-8)
    np.testing.assert_allclose(np.abs(found["box.orientation"][:, 0]), 1.0, atol=1e-9)
    assert np.ptp(found["box.position"][:, :3], axis=0).max() < 1e-9


def test_surfaces_that_would_cross_at_rest_are_refused() -> None:
    """Nobody could tell afterwards which side of each other they are on."""
    with pytest.raises(InputError, match=r"compliant collisions, .* law 'rigid'"):
        Simulation(box_on_plane(LinearLaw(4e6, 1e3)), 1e-3, start="equilibrium")


def test_what_nothing_holds_is_refused() -> None:
    """A ball beside the floor falls for ever."""
    scene = ball(LinearLaw(1e6))
    body = RigidBody("ball", MASS, np.eye(3), position=np.array([5.0, 0.0, 0.12]))
    simulation = Simulation(
        Scene(bodies=(body,), forces=(WEIGHT,), contours=(FLOOR,), contacts=scene.contacts),
        1e-3,
        start="equilibrium",
    )
    with pytest.raises(InputError, match="does not come to rest with its contacts"):
        simulation.record()


def test_a_settled_stack_makes_no_energy_that_is_worth_a_word() -> None:
    """Two boxes on a slope: 1e-5 J, or 6e-9 of what lifting them by their size would take."""
    length, mass, angle, half = 5.0, 10.0, 0.17, np.radians(0.7)
    turn = np.array([np.cos(half), np.sin(half), 0.0, 0.0])
    surfaces = [CollisionSurface(name="plane", body=GROUND, surface=plane_surface((200.0, 200.0)))]
    boxes, pairs = [], []
    for i in range(2):
        inertia = (1 + i) * mass * length**2 / 12.0 * np.diag([0.29, 1.04, 1.25])
        place = np.array([0.1 * i * length, 0.0, (0.1 + 0.05) * length + i * (0.2 + 0.05) * length])
        boxes.append(RigidBody(f"box_{i}", (1 + i) * mass, inertia, position=place, orientation=turn))
        skin = box_surface((length, 0.5 * length, 0.2 * length))
        surfaces.append(CollisionSurface(name=f"skin_{i}", body=f"box_{i}", surface=skin))
        below = "plane" if i == 0 else f"skin_{i - 1}"
        pairs.append(
            Collision(name=f"pair_{i}", surfaces=(below, f"skin_{i}"), law=RigidLaw(), friction=0.58)
        )
    slope = Gravity(G * np.array([np.sin(angle), 0.0, -np.cos(angle)]))
    scene = Scene(bodies=tuple(boxes), forces=(slope,), surfaces=tuple(surfaces), collisions=tuple(pairs))
    simulation = Simulation(scene, 0.011, start="equilibrium")
    simulation.record()
    simulation.advance(300)
    assert not simulation.warning
    assert simulation.energy_drift < 0.02
    assert simulation.verdict[1] == ""
