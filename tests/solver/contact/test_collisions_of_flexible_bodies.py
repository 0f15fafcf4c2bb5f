"""Bodies with modes that touch with their own surface: statics, impacts, momentum, energy, friction, limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import solid_beams
from flexible_surfaces import HEIGHT, LENGTH, MASS, bar, beam_on_springs, flexible, plate, skin, touching
from mesh_contact_scenes import DOWN, G, run, turn
from test_collisions_of_meshes import plate as clamped_plate

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.surfaces.primitives import (
    box_surface,
    capsule_surface,
    plane_surface,
    sphere_surface,
)
from heavylift.preprocess.surfaces.triangle_surface import placed
from heavylift.solver.forces.point import PointForce
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import LinearLaw, RigidLaw
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

WEIGHT = MASS * G
FRICTION = 0.01
"""Keeps a bar from rolling off; more of it under its lower fibre would hold that together."""
FLOOR = {"floor": ("ground", plane_surface((20, 20)))}


def rollers(places: Any, radius: float = 0.05) -> dict[str, Any]:
    """Round bars across the bar, their tops at height 0."""
    bar_across = capsule_surface(radius, 0.3, (0.0, 1.0, 0.0))
    return {
        f"roller {i}": ("ground", placed(bar_across, position=[x, 0.0, -radius]))
        for i, x in enumerate(places, 1)
    }


def forces(found: Any, count: int) -> Any:
    """Vertical force of each collision on the bar at the end; those on rollers would roll off without friction."""
    return np.array([found[f"touch_{n}.force"][-1, 2] for n in range(1, count + 1)])


SUPPORTS = np.array([-1.5, 0.0, 1.5])
ON_SUPPORTS = tuple((x, y) for x in SUPPORTS for y in (-0.2, 0.0, 0.2))


def test_a_beam_lies_on_three_springs():
    """As its modes do on springs, and as a Timoshenko beam; the forces together are its weight.

    On finer meshes a support touches more nodes, which share its stiffness alike and dent the mesh each: with
    half the size forces are 0.6 % off the beam.
    """
    stiffness, reduced = 5e5, bar(6, ON_SUPPORTS)
    scene = touching(
        (flexible("bar", reduced, (0.0, 0.0, 0.5 * HEIGHT), 0.3),),
        rollers(SUPPORTS),
        LinearLaw(stiffness, 1e4),
        patch_size=1.0,
        friction=FRICTION,
    )
    found = forces(run(scene, 2e-3, 2.0), 3)
    assert np.isclose(found.sum(), WEIGHT, rtol=1e-9)
    expected = beam_on_springs(SUPPORTS, stiffness, WEIGHT / LENGTH)
    assert expected[1] / expected[0] > 1.08  # a stiff bar has equal forces
    np.testing.assert_allclose(found, expected, rtol=3e-3)
    A, rows = np.diag(np.append(0.0, reduced.eigenvalues)), []
    for x, y in ((x, y) for x in SUPPORTS for y in (-0.15, 0.15)):
        rows.append(np.append(1.0, reduced.shapes_at(*reduced.locate((x, y, -0.5 * HEIGHT)))[:, 2]))
        A += 0.5 * stiffness * np.outer(rows[-1], rows[-1])
    sunk = np.linalg.solve(A, np.append(WEIGHT, np.zeros(reduced.mode_count)))
    of_modes = 0.5 * stiffness * (np.array(rows) @ sunk).reshape(3, 2).sum(axis=1)
    np.testing.assert_allclose(found, of_modes, rtol=5e-4)


def test_a_beam_is_in_equilibrium_on_three_stiff_supports():
    """From the start, without compliance: forces are those of its modes held at the points that carry it."""
    narrow, reduced = box_surface((0.02, 0.6, 0.1)), bar(6, ON_SUPPORTS)
    blocks = {f"block {x}": ("ground", placed(narrow, position=[x, 0.0, -0.05])) for x in SUPPORTS}
    body = flexible("bar", reduced, (0.0, 0.0, 0.5 * HEIGHT), 0.05)
    run_ = run(
        touching((body,), blocks, RigidLaw(), friction=FRICTION),
        1e-3,
        2e-3,
        start="equilibrium",
        record_every=1,
    )
    found = forces(run_, 3)
    assert np.isclose(found.sum(), WEIGHT, rtol=1e-4)
    rows, owners = [], []
    for n, k in ((n, k) for n in (1, 2, 3) for k in range(1, 9)):
        if run_[f"touch_{n}.contact_{k}.force"][-1] > 0.0:
            x, y, _ = run_[f"touch_{n}.contact_{k}.point"][-1]
            at = reduced.locate((x, np.clip(y, -0.2, 0.2), -0.5 * HEIGHT))
            rows.append(np.concatenate([[1.0, x, y], reduced.shapes_at(*at)[:, 2]]))
            owners.append(n - 1)
    K, J = np.diag(np.concatenate([np.zeros(3), reduced.eigenvalues])), np.array(rows)
    load = np.concatenate([[-WEIGHT], np.zeros(len(K) - 1)])
    soft = -1e-15 * np.eye(len(J))  # redundant ones share
    solved = np.linalg.solve(np.block([[K, -J.T], [J, soft]]), np.concatenate([load, np.zeros(len(J))]))
    of_modes = np.bincount(owners, weights=solved[len(K) :], minlength=3)
    np.testing.assert_allclose(found, of_modes, rtol=5e-3)


def test_it_rests_on_a_floor_from_the_start():
    """With its whole underside, in all ways of the search for rest."""
    scene = touching(
        (flexible("bar", bar(), (0.0, 0.0, 0.5 * HEIGHT)),), FLOOR, RigidLaw(), friction=0.3, patch_size=0.6
    )
    found = run(scene, 1e-3, 5e-3, start="equilibrium", record_every=1)
    np.testing.assert_allclose(found["touch_1.normal_force"][1:], WEIGHT, rtol=1e-9)
    assert np.abs(found["bar.position"] - [0.0, 0.0, 0.5 * HEIGHT]).max() < 1e-9


def test_ends_lift_off_an_elastic_foundation():
    """A force in the middle of a beam on nine springs that do not pull."""
    places, stiffness, force = np.linspace(-1.8, 1.8, 9), 2e6, 30e3
    reduced = bar(6, tuple((x, y) for x in (*places[::2], 0.0) for y in (-0.2, 0.2)), divisions=(20, 2, 2))
    body = flexible("bar", reduced, (0.0, 0.0, 0.5 * HEIGHT), 0.3)
    scene = touching((body,), rollers(places), LinearLaw(stiffness, 1e4), patch_size=1.0, friction=FRICTION)
    press = PointForce("press", "bar", np.array([0.0, 0.0, 0.5 * HEIGHT]), force=np.array([0.0, 0.0, -force]))
    scene = Scene(
        bodies=scene.bodies,
        forces=(*scene.forces, press),
        surfaces=scene.surfaces,
        collisions=scene.collisions,
    )
    found = forces(run(scene, 2e-3, 2.0), 9)
    expected = beam_on_springs(places, stiffness, WEIGHT / LENGTH, force=force)
    assert np.count_nonzero(expected == 0.0) >= 2
    assert np.isclose(found.sum(), WEIGHT + force, rtol=1e-8)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=3e-2 * expected.max())


def test_a_cantilever_carries_a_box():
    """Its frame is fixed; it sinks by ``m g a^3 / (3 E I)`` and its own weight where the box sticks to it."""
    place, mass = 0.9, 2.0
    reduced = solid_beams.cantilever(20, 8, points=((place, 0.0, 0.5 * solid_beams.SIDE),))
    beam = solid_beams.beam(reduced, damping_ratio=np.full(reduced.mode_count, 0.1))
    box = RigidBody("box", mass, 1e-3 * np.eye(3), position=np.array([place, 0.0, 0.02]))
    scene = touching(
        (beam, box),
        {"box": ("box", box_surface((0.05, 0.04, 0.02)))},
        LinearLaw(1e7, 2e3),
        friction=0.5,
        patch_size=1.0,
    )
    found = run(scene, 2e-4, 1.5)
    line = solid_beams.DENSITY * solid_beams.SIDE**2 * G
    sunk = mass * G * place**3 / 3.0 + line * place**2 * (6.0 - 4.0 * place + place**2) / 24.0
    np.testing.assert_allclose(0.02 - found["box.position"][-1, 2], sunk / solid_beams.BENDING, rtol=1e-2)
    np.testing.assert_allclose(found["touch_1.normal_force"][-1], mass * G, rtol=1e-2)


@pytest.mark.slow
def test_a_flexible_body_lies_on_a_shell():
    """Each deforms in its own way: with modes, and with nodes."""
    body = flexible("bar", bar(4, size=(0.3, 0.2, 0.1), divisions=(3, 2, 2)), (0.0, 0.0, 0.062), 0.2)
    own, sheet = skin("bar", body.reduced), clamped_plate(0.0, clamped=True)
    scene = Scene(
        bodies=(body, sheet),
        forces=(Gravity(np.array(DOWN)),),
        surfaces=(CollisionSurface(name="sheet", body="plate", surface=None, facets=1), own),
        collisions=(
            Collision(name="touch", surfaces=("sheet", own.name), law=LinearLaw(1e5, 5e2), patch_size=1.0),
        ),
    )
    found = run(scene, 5e-4, 0.5)
    weight = body.reduced.integrals.mass * G
    np.testing.assert_allclose(found["touch.normal_force"][-1], weight, rtol=2e-2)
    assert found.drift < 1e-6


# ---- impacts ----


def ball(position: Any, speed: float, mass: float = 50.0, radius: float = 0.1) -> RigidBody:
    """Falls."""
    return RigidBody(
        "ball",
        mass,
        0.4 * mass * radius**2 * np.eye(3),
        position=np.array(position, dtype=float),
        velocity=np.array([0.0, 0.0, -speed]),
    )


def hit(law: Any, speed: float = 1.0, **more: Any) -> Scene:
    """A ball hits the middle of a bar that floats, at a node on its upper side."""
    body = flexible("bar", bar(6, ((0.0, 0.0),)), (0.0, 0.0, 0.0))
    other = ball((0.0, 0.0, 0.5 * HEIGHT + 0.101), speed)
    return touching(
        (body, other), {"round": ("ball", sphere_surface(0.1))}, law, gravity=(0.0, 0.0, 0.0), **more
    )


@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_impulse_of_an_impact_is_that_of_the_inertia_of_all_modes(restitution):
    """The first one: ``(1 + e) v / (1/m + 1/M + sum phi^2)`` with the shapes at the middle of the upper side."""
    scene = hit(RigidLaw(restitution))
    reduced = scene.bodies[0].reduced
    shapes = reduced.shapes_at(*reduced.locate((0.0, 0.0, 0.5 * HEIGHT)))[:, 2]
    found = run(scene, 1e-4, 1.1e-3, record_every=1)
    impulse = found["touch_1.impulse"]
    first = impulse[np.flatnonzero(impulse)[0]]
    inverse = 1.0 / 50.0 + 1.0 / reduced.integrals.mass + (shapes**2).sum()
    assert np.isclose(first, (1.0 + restitution) / inverse, rtol=1e-6 if restitution else 0.05)


def test_two_bars_keep_momentum_and_energy():
    """They hit each other askew and spinning, elastically: momentum to rounding, the rest by the square of the step."""
    first = flexible("low", bar(), (0.0, 0.0, 0.0), angular_velocity=np.array([0.3, -0.2, 0.5]))
    second = flexible(
        "high",
        bar(),
        (0.3, 0.1, 0.35),
        orientation=turn((0.2, 0.1, 1.0), 0.9),
        velocity=np.array([0.1, 0.0, -1.0]),
    )
    scene = touching((first, second), {}, LinearLaw(4e6), gravity=(0.0, 0.0, 0.0), friction=0.3)
    drifts = []
    for step in (1e-3, 2.5e-4):
        found = run(scene, step, 0.25)
        assert found["touch_1.normal_force"].max() > 1e3
        drift = {
            name: np.abs(found[name] - found[name][0]).max()
            for name in ("momentum.linear", "momentum.angular", "energy.balance")
        }
        assert drift["momentum.linear"] < 1e-12 * np.abs(found["momentum.linear"][0]).max() / step
        drifts.append((drift["momentum.angular"], drift["energy.balance"]))
    assert drifts[1][0] < 0.1 * drifts[0][0] < 1e-4
    assert drifts[1][1] < 0.1 * drifts[0][1] < 1e-2


def test_a_scene_turned_as_a_whole_stays_the_same():
    """Forces and heights do, to rounding."""
    axis = turn((0.3, -1.0, 0.4), 1.1)
    R = rotation_matrix(axis)
    body = flexible("bar", bar(), (0.0, 0.0, 0.5 * HEIGHT + 0.02), 0.05, velocity=np.array([0.4, 0.1, 0.0]))
    upright = touching((body,), FLOOR, LinearLaw(2e6, 2e3), friction=0.3, patch_size=10.0)
    turned = touching(
        (
            flexible(
                "bar",
                bar(),
                R @ body.position,
                0.05,
                orientation=axis,
                velocity=R @ body.velocity,
            ),
        ),
        {"floor": ("ground", placed(FLOOR["floor"][1], R))},
        LinearLaw(2e6, 2e3),
        gravity=R @ DOWN,
        friction=0.3,
        patch_size=10.0,
    )
    a, b = run(upright, 1e-3, 0.2), run(turned, 1e-3, 0.2)
    assert a["touch_1.normal_force"].max() > WEIGHT
    np.testing.assert_allclose(a["bar.position"] @ R.T, b["bar.position"], atol=1e-10)
    np.testing.assert_allclose(
        a["touch_1.normal_force"], b["touch_1.normal_force"], rtol=0.0, atol=1e-7 * WEIGHT
    )


def test_a_stiff_bar_moves_like_a_rigid_box():
    """On the same floor, tilted and spinning, by a compliant law with friction."""
    reduced = bar(3, young=1e6 * 2e9, divisions=(1, 1, 1))
    start = {
        "position": np.array([0.0, 0.0, 0.8]),
        "orientation": turn((0.4, 1.0, 0.1), 0.3),
        "velocity": np.array([0.5, 0.0, 0.0]),
        "angular_velocity": np.array([0.2, 0.1, 0.4]),
    }
    law = {"law": LinearLaw(1e6, 5e3), "friction": 0.4, "patch_size": 0.3}
    soft = touching((flexible("bar", reduced, **start),), FLOOR, **law)
    integrals = reduced.integrals
    inertia = np.trace(integrals.inertia_kl) * np.eye(3) - integrals.inertia_kl
    box = RigidBody("bar", integrals.mass, inertia, **start)
    hard = touching((box,), {}, **law)
    hard = Scene(
        bodies=hard.bodies,
        forces=hard.forces,
        surfaces=(
            soft.surfaces[0],
            CollisionSurface(name="skin of bar", body="bar", surface=soft.surfaces[1].surface),
        ),
        collisions=soft.collisions,
    )
    a, b = run(soft, 4e-4, 0.3), run(hard, 4e-4, 0.3)
    assert b["touch_1.normal_force"].max() > WEIGHT
    np.testing.assert_allclose(a["bar.position"], b["bar.position"], atol=1e-6)
    np.testing.assert_allclose(a["bar.orientation"], b["bar.orientation"], atol=1e-6)


def test_it_slides_and_stops_by_friction():
    """From 1 m/s after v^2 / (2 mu g), and stays there."""
    friction = 0.4
    body = flexible("bar", bar(), (0.0, 0.0, 0.5 * HEIGHT), 0.05, velocity=np.array([1.0, 0.0, 0.0]))
    found = run(touching((body,), FLOOR, RigidLaw(), friction=friction, patch_size=2.0), 1e-3, 0.4)
    across = np.linalg.norm(found["touch_1.force"][:, :2], axis=1)
    assert (across <= friction * found["touch_1.normal_force"] * (1.0 + 1e-9)).all()
    np.testing.assert_allclose(found["bar.position"][-1, 0], 1.0 / (2.0 * friction * G), rtol=2e-2)
    assert abs(found["bar.velocity"][-1, 0]) < 1e-9


# ---- what is formed, and when ----


def test_asking_for_the_clearance_changes_nothing():
    """It forms all points of a surface, where otherwise those stand that are near something."""
    body = flexible("bar", bar(), (0.0, 0.0, 0.3), 0.05, orientation=turn((0.1, 1.0, 0.0), 0.1))
    runs = [
        run(touching((body,), FLOOR, LinearLaw(2e6, 2e3), friction=0.3, clearance=asked), 1e-3, 0.3)
        for asked in (False, True)
    ]
    assert runs[0]["touch_1.contacts"].max() > 0
    for name in ("bar.position", "bar.modal_position", "touch_1.normal_force"):
        np.testing.assert_array_equal(runs[0][name], runs[1][name])
    height = 0.3 - 0.5 * HEIGHT * np.cos(0.1) - 0.5 * LENGTH * np.sin(0.1) * 0.995
    assert abs(runs[1]["touch_1.gap"][0] - height) < 2e-3


def test_a_run_that_is_continued_has_the_same_bits():
    """State is all there is: what is near is found again."""
    scene = touching(
        (flexible("bar", bar(), (0.0, 0.0, 0.5 * HEIGHT + 0.01), 0.05),),
        FLOOR,
        LinearLaw(2e6, 2e3),
        friction=0.3,
        patch_size=0.6,
    )
    whole = Simulation(scene, 1e-3)
    whole.advance(60)
    state = whole.state()
    _, expected = whole.advance(60)
    other = Simulation(scene, 1e-3)
    other.restore(state)
    _, found = other.advance(60)
    np.testing.assert_array_equal(found, expected)


def test_the_surface_of_tetrahedra_lies_on_a_floor_too():
    """Four triangles for each of their faces, through the nodes in the middle of its sides."""
    reduced = bar(3, divisions=(), element="tet10")
    body = flexible("bar", reduced, (0.0, 0.0, 0.5 * HEIGHT + 1e-3), 0.3)
    found = run(touching((body,), FLOOR, LinearLaw(2e6, 4e4), patch_size=2.0), 1e-3, 0.5)
    assert np.isclose(found["touch_1.normal_force"][-1], WEIGHT, rtol=1e-4)


# ---- plates ----


@pytest.mark.parametrize("offset", [0.0, 0.01])
def test_a_plate_of_shells_lies_on_both_of_its_sides(offset):
    """Its middle surface, moved by its offset from the nodes, is half of the thickness over the floor, and under it."""
    reduced = plate(0.05, offset)
    weight = reduced.integrals.mass * G
    for up, orientation in ((1.0, (1.0, 0.0, 0.0, 0.0)), (-1.0, (0.0, 1.0, 0.0, 0.0))):
        height = 0.025 - up * offset
        body = flexible("plate", reduced, (0.0, 0.0, height + 1e-3), 0.3, orientation=np.array(orientation))
        found = run(touching((body,), FLOOR, LinearLaw(2e6, 2e4), patch_size=10.0), 1e-3, 0.6)
        assert np.isclose(found["touch_1.normal_force"][-1], weight, rtol=1e-5)
        assert abs(found["plate.position"][-1, 2] - height) < 1e-3


def test_a_plate_of_shells_lies_on_three_springs():
    """As a thin beam does."""
    stiffness = 2e4
    body = flexible("plate", plate(0.05, modes=6, under=tuple(SUPPORTS)), (0.0, 0.0, 0.025), 0.3)
    scene = touching((body,), rollers(SUPPORTS), LinearLaw(stiffness, 1e3), patch_size=1.0, friction=FRICTION)
    found = forces(run(scene, 2e-3, 4.0), 3)
    weight = body.reduced.integrals.mass * G
    assert np.isclose(found.sum(), weight, rtol=1e-3)
    expected = beam_on_springs(SUPPORTS, stiffness, weight / LENGTH, height=0.05)
    np.testing.assert_allclose(found, expected, rtol=5e-3)


# ---- bad input ----


@pytest.mark.parametrize(
    ("change", "key"), [({"surface": None}, "surface"), ({"nodes": np.arange(3)}, "nodes")]
)
def test_triangles_and_nodes_belong_together(change, key):
    """Else nobody knows how the triangles deform."""
    own = skin("bar", bar())
    fields = {"name": own.name, "body": own.body, "surface": own.surface, "nodes": own.nodes, **change}
    scene = Scene(
        bodies=(flexible("bar", bar(), (0.0, 0.0, 1.0)),),
        forces=(Gravity(np.array(DOWN)),),
        surfaces=(
            CollisionSurface(name="floor", body="ground", surface=plane_surface((4, 4))),
            CollisionSurface(**fields),
        ),
        collisions=(Collision(name="touch", surfaces=("floor", own.name)),),
    )
    with pytest.raises(InputError, match=key):
        pack_scene(scene)
