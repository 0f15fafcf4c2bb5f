"""Round shapes that fly through each other between the ends of a step; plates without thickness that come and go."""

from __future__ import annotations

import numpy as np
import pytest
from mesh_contact_scenes import MASS, G, ball, body, run, scene, turn

from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.surfaces.primitives import (
    box_surface,
    capsule_surface,
    cylinder_surface,
    plane_surface,
    sphere_surface,
)
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.forces.point import PointForce
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import LinearLaw, RigidLaw
from heavylift.solver.scene.scene import RigidBody, Scene

NOTHING = (0.0, 0.0, 0.0)
RADIUS = 0.1


@pytest.mark.parametrize("way", [0.45, 1.2, 2.6])
@pytest.mark.parametrize("phase", np.linspace(0.0, 0.9, 10))
def test_balls_do_not_fly_through_each_other(way: float, phase: float) -> None:
    """Both free, offset, elastic: the part of the relative velocity along the line of centres is turned round."""
    step, offset, speed = 0.02, 0.06, way / 0.02
    first = ball("a", (-0.5 - phase * way, offset, 0.0), RADIUS, velocity=(0.6 * speed, 0.0, 0.0))
    second = ball("b", NOTHING, RADIUS, mass=2.0 * MASS, velocity=(-0.4 * speed, 0.0, 0.0))
    skins = sphere_surface(RADIUS)
    found = run(
        scene(
            [(first, skins), (second, skins)],
            pairs=[("a", "b")],
            gravity=NOTHING,
            law=RigidLaw(restitution=1.0),
        ),
        step,
        0.1,
    )
    sine = offset / (2.0 * RADIUS)
    normal = np.array([-np.sqrt(1.0 - sine**2), sine, 0.0])  # from b to a
    impulse = 2.0 * speed * -normal[0] / (1.0 / MASS + 0.5 / MASS)
    assert found["a-b.impacts"][-1] == 1.0
    np.testing.assert_allclose(
        found["a.velocity"][-1], [0.6 * speed, 0, 0] + impulse / MASS * normal, atol=1e-6 * speed
    )
    np.testing.assert_allclose(
        found["b.velocity"][-1], [-0.4 * speed, 0, 0] - impulse / MASS / 2.0 * normal, atol=1e-6 * speed
    )


SHAPES = {
    "ball": sphere_surface(RADIUS),
    "capsule": capsule_surface(RADIUS, 0.4, (0.0, 1.0, 0.0)),
    "box": box_surface((0.2, 0.3, 0.2)),
    "rounded box": box_surface((0.2, 0.3, 0.2), 0.03),
    "cylinder": cylinder_surface(RADIUS, 0.4, (0.0, 1.0, 0.0), sides=12),
}


@pytest.mark.parametrize("second", SHAPES)
@pytest.mark.parametrize("first", SHAPES)
def test_no_shape_flies_through_another(first: str, second: str) -> None:
    """Turned anyhow, with ways of up to ten times their size in a step: they hit, and keep energy and momenta.

    Both middles pass within the inner spheres, so they cannot pass by each other.
    """
    rng = np.random.default_rng(5)
    for way in (0.3, 0.7, 1.3, 2.6):
        a, b = (turn(rng.normal(size=3), rng.uniform(0.0, 3.0)) for _ in range(2))
        place = (-0.6 - rng.random() * way, *rng.uniform(-0.1, 0.1, 2))
        one = body("a", place, inertia=(200, 150, 250), velocity=(0.7, 0, 0), orientation=a)
        other = body("b", inertia=(150, 200, 170), velocity=(-0.3, 0, 0), orientation=b)
        found = run(
            scene(
                [(one, SHAPES[first]), (other, SHAPES[second])],
                pairs=[("a", "b")],
                gravity=NOTHING,
                law=RigidLaw(restitution=1.0),
            ),
            way,
            4.0 * way,
        )
        assert found["a-b.impacts"][-1] >= 1.0
        assert found["energy.kinetic"][-1] == pytest.approx(found["energy.kinetic"][0], rel=1e-6)
        for momentum in ("momentum.linear", "momentum.angular"):
            np.testing.assert_allclose(found[momentum][-1], found[momentum][0], atol=1e-9)


def loose_plate() -> TriangleSurface:
    """Four triangles, wound anyhow."""
    points = np.array([[x, y, 0.0] for x in (-0.6, 0.0, 0.6) for y in (-0.4, 0.4)])
    return TriangleSurface(points, np.array([[0, 2, 3], [3, 1, 0], [2, 4, 5], [5, 3, 2]]), 0.0, "plate")


@pytest.mark.parametrize("turned", [0.0, 0.9])
@pytest.mark.parametrize("law", [LinearLaw(3e5, 2e3), RigidLaw()], ids=["linear", "rigid"])
@pytest.mark.parametrize("deck", ["plate", "box"])
@pytest.mark.parametrize("seed", range(4))
def test_a_plate_that_comes_and_goes_is_never_pulled(
    deck: str, law: object, turned: float, seed: int
) -> None:
    """Pressed and lifted at its corners on a deck that moves and turns: forces point out of the deck, as its points do.

    Neither side is enclosed where the deck is a plate; right is what the geometry says, not what contacts remember.
    """
    rng = np.random.default_rng(seed)
    axis = turn((1.0, 2.0, 0.5), turned)
    R, speed = rotation_matrix(axis), np.array([0.2, -0.1, 0.3])
    floor = plane_surface((12.0, 12.0))
    if deck == "box":
        cube = box_surface((12.0, 12.0, 2.0))
        floor = TriangleSurface(cube.points - [0.0, 0.0, 1.0], cube.triangles, 0.0, "deck")
    times = 0.4 * np.arange(9)
    pushes = tuple(
        PointForce(
            f"push {k}",
            "plate",
            np.array(point),
            times,
            np.outer(rng.uniform(-1.2, 0.6, len(times)) * MASS * G, R[:, 2]),
        )
        for k, point in enumerate([(-0.6, -0.4, 0.0), (0.6, -0.4, 0.0), (0.6, 0.4, 0.0)])
    )
    built = Scene(
        bodies=(
            RigidBody(
                "deck",
                1e4,
                1e4 * np.eye(3),
                orientation=axis,
                velocity=R @ speed,
                angular_velocity=R @ speed / 10.0,
            ),
            RigidBody(
                "plate",
                MASS,
                np.diag([10.0, 12.0, 20.0]),
                position=R @ [0.1, 0.2, 0.02],
                orientation=axis,
                velocity=R @ speed,
            ),
        ),
        forces=pushes,
        surfaces=(
            CollisionSurface(name="deck", body="deck", surface=floor),
            CollisionSurface(name="plate", body="plate", surface=loose_plate()),
        ),
        collisions=(Collision(name="touch", surfaces=("deck", "plate"), law=law),),
    )
    found = run(built, 0.004, 3.0)
    assert found["touch.normal_force"].max() > 0.5 * MASS * G
    for i in range(0, len(found.times), 2):
        A, B = (rotation_matrix(found[f"{name}.orientation"][i]) for name in ("deck", "plate"))
        out = found["touch.force"][i] @ A[:, 2]
        assert out >= -1e-6 * MASS * G
        assert out == pytest.approx(found["touch.normal_force"][i], abs=1e-6 * out + 1e-3)
        points = (found["plate.position"][i] + loose_plate().points @ B.T - found["deck.position"][i]) @ A
        if np.abs(points[:, :2]).max() > 6.0:
            break
        assert points[:, 2].min() > -0.1
