"""Frames and shells that collide with rigid bodies by their own surfaces: rest, static deflection, momentum, energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_scenes import DOWN, G, Run, run

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface, sphere_surface
from heavylift.solver.bodies.ancf.mesh_contour import facet_surface
from heavylift.solver.contact.triangles.kind import GoneContacts
from heavylift.solver.forces.point import PointForce
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import LinearLaw, RigidLaw
from heavylift.solver.scene.mesh_shapes import line, rectangle
from heavylift.solver.scene.meshes import FrameBody, FrameSection, ShellBody, ShellSection, Support
from heavylift.solver.scene.scene import Fixed, Gravity, RigidBody, Scene

LENGTH, WIDTH, THICKNESS, DENSITY = 1.0, 0.8, 0.02, 2700.0
PLATE_MASS = LENGTH * WIDTH * THICKNESS * DENSITY


def plate(height: float = 0.0, clamped: bool = False, **more: Any) -> ShellBody:
    """A plate of 4 by 4 elements about the origin."""
    mesh = rectangle(LENGTH, WIDTH, 4, 4)
    held = np.unique(np.concatenate(list(mesh.edges.values())))
    return ShellBody(
        name="plate",
        nodes=mesh.nodes - [0.5 * LENGTH, 0.5 * WIDTH, 0.0],
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(THICKNESS, DENSITY, 7e8, 0.3),),
        supports=(Support(held, {"position": "xyz", "slope_x": "xyz", "slope_y": "xyz", "twist": "xyz"}),)
        if clamped
        else (),
        position=np.array([0.0, 0.0, height]),
        **more,
    )


def rigid(name: str, mass: float, **more: Any) -> RigidBody:
    """A small body."""
    return RigidBody(name, mass, 0.01 * mass * np.eye(3), **more)


def collided(
    bodies: Any, surfaces: Any, law: Any, *, gravity: bool = True, facets: int = 1, **more: Any
) -> Scene:
    """Two bodies that touch; a surface of None is the own one."""
    sides = tuple(
        CollisionSurface(name=f"of {name}", body=name, surface=surface, facets=facets)
        for name, surface in surfaces.items()
    )
    return Scene(
        bodies=bodies,
        forces=(Gravity(DOWN),) if gravity else (),
        surfaces=sides,
        collisions=(Collision(name="touch", surfaces=(sides[0].name, sides[1].name), law=law, **more),),
    )


def beam(**more: Any) -> FrameBody:
    """A bar along x about the origin, 20 kg."""
    mesh = line([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 6)
    area = np.pi * 0.03**2
    return FrameBody(
        name="beam",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(FrameSection(10.0 / area, 2e9, area, area * 0.03**2 / 4.0),),
        **more,
    )


def test_surface_of_a_shell_is_its_shape():
    """Points of the plane at the corners of all facets, each once; area and rounding are those of the plate."""
    book = facet_surface(plate(), 3, "skin")
    points, triangles = book.surface.points, book.surface.triangles
    places = {tuple(p) for p in np.round(points[:, :2] * [12 / LENGTH, 12 / WIDTH], 9)}
    assert places == {(float(i), float(j)) for i in range(-6, 7) for j in range(-6, 7)}
    assert len(points) == 169
    u, v = (points[triangles[:, k]] - points[triangles[:, 0]] for k in (1, 2))
    assert np.isclose(0.5 * np.cross(u, v)[:, 2].sum(), LENGTH * WIDTH, rtol=1e-14)
    assert book.surface.radius == 0.5 * THICKNESS


def test_surface_of_a_frame_is_a_round_chain():
    """The axis in segments, and the radius of its round cross-section."""
    book = facet_surface(beam(), 2, "bar")
    points, rows = book.surface.points, book.surface.triangles
    assert np.array_equal(rows[:, 1], rows[:, 2])
    assert np.allclose(points[rows[:, 1], 0] - points[rows[:, 0], 0], 2.0 / 12, rtol=0.0, atol=1e-15)
    assert np.isclose(book.surface.radius, 0.03, rtol=1e-14)


@pytest.mark.parametrize(
    ("surface", "facets", "key"), [(plane_surface((1, 1)), 2, "surface"), (None, 0, "facets")]
)
def test_own_surface_is_asked_for(surface, facets, key):
    """Given triangles would not deform."""
    sides = (
        CollisionSurface(name="floor", body="ground", surface=plane_surface((4, 4))),
        CollisionSurface(name="skin", body="plate", surface=surface, facets=facets),
    )
    scene = Scene(
        bodies=(plate(0.1),),
        surfaces=sides,
        collisions=(Collision(name="touch", surfaces=("floor", "skin")),),
    )
    with pytest.raises(InputError, match=key):
        pack_scene(scene)


def fallen_flat(law: Any, step: float, patch_size: float) -> tuple[Run, float]:
    """The plate falls 1 cm onto a held body, flat, and lies there a second later; what shares have gained [J]."""
    body = plate(0.02, viscous_damping=20.0, stiffness_damping=2e-3)
    floor = rigid("floor", 1.0, motion=Fixed())
    surfaces = {"floor": plane_surface((4, 4)), "plate": None}
    found = run(collided((body, floor), surfaces, law, patch_size=patch_size), step, 1.0)
    if isinstance(law, RigidLaw):
        return found, 0.0
    (pair,) = found.simulation._layout.systems[1].placed[-2:-1].view(GoneContacts.layout)[:, 0]
    return found, max(-pair["jumps"], 0.0)


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("law", [LinearLaw(4e5, 4e3), RigidLaw(0.0)])
def test_plate_that_falls_flat_comes_to_rest(law):
    """Force = weight, all energy accounted for; the floor is a held body."""
    found, gained = fallen_flat(law, 1e-3, 0.5)
    weight = PLATE_MASS * G
    assert np.abs(found["plate.velocity"][-1, 2::3]).max() < 1e-6
    assert np.isclose(found["touch.normal_force"][-1], weight, rtol=1e-6)
    # an edge of the bent plate on the diagonal of the floor has a normal that is hardly tilted
    assert np.allclose(found["touch.force"][-1, :2], 0.0, atol=1e-4 * weight)
    assert found["plate.position"][-1, 2::3].min() > 0.5 * THICKNESS - 2e-3
    # a floor without compliance gains where it pushes nodes out that have come through; one with it lends energy while
    # others take their shares of the stiffness, and gets most of it back: neither is a negative loss
    balance, fallen = found["energy.balance"], weight * 0.01
    if isinstance(law, RigidLaw):
        assert found.drift < 1e-3 * fallen
        return
    assert abs(balance[-1] - balance[0] - gained) < 1e-5 * fallen


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_plate_that_falls_flat_on_contacts_of_their_own_stiffness_gains_nothing(step):
    """Where contacts share none, nothing is lent: the balance is kept in each step, whatever the step is."""
    found, gained = fallen_flat(LinearLaw(4e5, 4e3), step, 0.1)
    fallen = PLATE_MASS * G * 0.01
    assert gained == 0.0
    assert found.drift < 1e-8 * fallen
    assert np.isclose(found["touch.normal_force"][-1], PLATE_MASS * G, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_ball_at_rest_bends_a_clamped_plate_as_its_weight_does():
    """The same plate with a force in its middle, which knows nothing of contacts."""
    damped = {"viscous_damping": 15.0, "stiffness_damping": 2e-3}
    ball = rigid("ball", 5.0, position=np.array([0.0, 0.0, 0.5 * THICKNESS + 0.1 + 1e-3]))
    found = run(
        collided(
            (plate(clamped=True, **damped), ball),
            {"plate": None, "ball": sphere_surface(0.1)},
            LinearLaw(1e6, 2e3),
            facets=2,
        ),
        1e-3,
        1.5,
    )
    pushed = Scene(
        bodies=(plate(clamped=True, **damped),),
        forces=(
            Gravity(DOWN),
            PointForce("weight", "plate", np.zeros(3), np.zeros(1), np.array([[0.0, 0.0, -5.0 * G]])),
        ),
    )
    alone = run(pushed, 1e-3, 1.5)
    reference, sag = (one["plate.position"][-1, 2::3].min() for one in (alone, found))
    assert np.allclose(found["touch.force"][-1], [0.0, 0.0, 5.0 * G], rtol=1e-6, atol=1e-6)
    assert np.isclose(sag, reference, rtol=5e-4)
    depth = 5.0 * G / 1e6
    assert np.isclose(found["ball.position"][-1, 2], sag + 0.5 * THICKNESS + 0.1 - depth, atol=0.2 * depth)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_momentum_of_a_beam_and_a_box_stays():
    """A free beam hits the edge of a free box across, with friction: impulses are equal and opposite."""
    speed = np.array([0.4, 0.0, -2.0])
    box = rigid(
        "box",
        15.0,
        position=np.array([0.1, 0.0, -0.2]),
        orientation=np.array([np.cos(np.pi / 8), 0.0, np.sin(np.pi / 8), 0.0]),
    )
    top = 0.1 * np.sqrt(2.0)
    body = beam(position=np.array([0.0, 0.02, top - 0.2 + 0.03 + 5e-3]), velocity=speed)
    found = run(
        collided(
            (body, box),
            {"box": box_surface((0.2, 0.2, 0.2)), "beam": None},
            LinearLaw(2e5, 50.0),
            gravity=False,
            friction=0.4,
        ),
        2e-4,
        0.05,
    )
    start, end = found["momentum.linear"][0], found["momentum.linear"]
    assert np.allclose(start, 20.0 * speed, rtol=1e-12)
    assert found["touch.normal_force"].max() > 100.0
    assert found["touch.normal_force"][-1] == 0.0
    assert np.abs(end - start).max() < 1e-9 * np.linalg.norm(start)
    turning = found["momentum.angular"]
    assert np.abs(turning - turning[0]).max() < 1e-3 * 20.0 * 2.0 * 0.1
    assert found["box.velocity"][-1, 2] < -0.5
    assert found.drift < 1e-3 * 0.5 * 20.0 * speed @ speed
