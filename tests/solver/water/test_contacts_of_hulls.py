"""Contacts on hulls: what is hit is the mass of hull and water, of all hulls that share a database.

References are an impact of bodies with the full matrix of added mass, in NumPy, two hulls with databases of their own,
and the balances of momentum and energy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.surfaces.primitives import box_surface, sphere_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.contacts import Contact, Contour, LinearLaw, RigidLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, Radiation, Sea, Water
from heavylift.solver.simulation import Simulation

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]

Array = NDArray[np.float64]

LENGTH, BREADTH, HEIGHT, DRAFT = 40.0, 16.0, 5.0, 3.0
RHO, G = 1025.0, 9.81
MASS = RHO * LENGTH * BREADTH * DRAFT
INERTIA = MASS * np.diag([5.0, 11.0, 12.0]) ** 2
CENTRE = np.array([0.7, 0.0, 0.4])
REFERENCE = np.array([0.5, 0.0, 0.0])
AWAY = np.array([0.0, 20.0, 0.0])
DECK = HEIGHT - DRAFT
SIZE = 4.0
BOX = 0.1 * MASS
PLACE = np.array([6.0, 2.0, 0.0])
"""Of the box on the deck."""
CENTRE_OF_B = np.array([0.0, 0.0, CENTRE[2]]) - BOX / (MASS - BOX) * PLACE
"""With the box on it, "b" floats upright."""


def skin() -> TriangleSurface:
    box = box_surface((LENGTH, BREADTH, HEIGHT))
    return replace(box, points=box.points + np.array([0.0, 0.0, 0.5 * HEIGHT - DRAFT]))


def floating(name: str, place: Array, **values: Any) -> RigidBody:
    """A barge, whose centre of mass is above that of its buoyancy."""
    centre = {"centre_of_mass": np.array([0.0, 0.0, CENTRE[2]])}
    return RigidBody(name, **({"mass": MASS, "inertia": INERTIA, "position": place} | centre | values))


def added_mass(coupling: float, motions: Sequence[int] = range(6)) -> Array:
    """Of two hulls, positive definite, with terms between them and between some of their motions."""
    scale = np.sqrt(np.tile([MASS, MASS, MASS, *np.diag(INERTIA)], 2))
    shares = np.tile([0.1, 0.6, 1.2, 0.3, 0.9, 0.4], 2)
    rng = np.random.default_rng(3)
    both = rng.uniform(-0.1, 0.1, (12, 12))
    both += both.T
    coupled = np.isin(np.arange(12) % 6, motions)
    both *= np.outer(coupled, coupled)
    both[:6, 6:] *= coupling
    both[6:, :6] *= coupling
    A = scale[:, None] * (np.diag(shares) + 0.5 * both * np.sqrt(np.outer(shares, shares))) * scale
    assert np.linalg.eigvalsh(A).min() > 0.0
    return A


def database(A: Array, bodies: tuple[str, ...], points: Array) -> HydrodynamicDatabase:
    """The same added mass at all frequencies, no damping."""
    n, omega = len(A), np.linspace(0.1, 2.0, 20)
    return HydrodynamicDatabase(
        bodies=bodies,
        omega=omega,
        headings=np.deg2rad(np.arange(0.0, 181.0, 10.0)),
        added_mass=np.tile(A, (20, 1, 1)),
        damping=np.zeros((20, n, n)),
        added_mass_infinite=A,
        excitation=np.zeros((20, 19, n), dtype=np.complex128),
        reference_points=points,
        density=RHO,
        gravity=G,
        depth=np.inf,
        source="test",
        symmetric=True,
    )


def afloat(A: Array, *bodies: RigidBody, together: bool = True, **values: Any) -> Scene:
    """Two hulls, "a" and "b", and what touches them."""
    hulls = tuple(Hull(body=name, restoring=skin(), reference=REFERENCE) for name in "ab")
    points = np.array([REFERENCE, AWAY + REFERENCE])
    if together:
        found = (Radiation(bodies=("a", "b"), database=database(A, ("a", "b"), points), memory="none"),)
    else:
        found = tuple(
            Radiation(
                bodies=(name,),
                database=database(A[own, own], (name,), points[:1]),
                memory="none",
            )
            for name, own in (("a", slice(0, 6)), ("b", slice(6, 12)))
        )
    sea = Sea(water=Water(density=RHO, gravity=G), hulls=hulls, radiation=found)
    weight = Gravity(np.array([0.0, 0.0, -G]))
    return Scene(bodies=bodies, sea=sea, **({"forces": (weight,)} | values))


def surfaces(**skins: TriangleSurface) -> tuple[CollisionSurface, ...]:
    return tuple(CollisionSurface(name=name, body=name, surface=one) for name, one in skins.items())


class Found:
    """Records of a run, the start included."""

    def __init__(self, made: Scene, step: float, duration: float, **options: Any) -> None:
        simulation = Simulation(made, step, **options)
        self.times, first = np.zeros(1), simulation.record()
        self.records = first[None, :].copy()
        if duration > 0.0:
            times, records = simulation.advance(round(duration / step))
            assert simulation.outcome is Outcome.COMPLETED, simulation.message
            self.times = np.append(0.0, times)
            self.records = np.vstack([self.records, records])
        self.channels = {channel.name: channel for channel in simulation.channels}
        self.simulation = simulation

    def __getitem__(self, name: str) -> Array:
        channel = self.channels[name]
        found = self.records[:, channel.column : channel.column + len(channel.components)]
        return found[:, 0] if found.shape[1] == 1 else found


def cross_matrix(r: Array) -> Array:
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def mass_matrix(A: Array, bodies: list[RigidBody]) -> Array:
    """Of velocities of the centres of mass and angular velocities in the world; the first two bodies are hulls.

    The hulls head along x, so hydrodynamic velocities are those of the reference points, in the axes of the world.
    """
    n = 6 * len(bodies)
    M, T = np.zeros((n, n)), np.zeros((12, n))
    for i, body in enumerate(bodies):
        R, at = rotation_matrix(body.orientation), 6 * i
        M[at : at + 3, at : at + 3] = body.mass * np.eye(3)
        M[at + 3 : at + 6, at + 3 : at + 6] = R @ body.inertia @ R.T
        if i < 2:
            T[at : at + 6, at : at + 6] = np.eye(6)
            T[at : at + 3, at + 3 : at + 6] = -cross_matrix(R @ (REFERENCE - body.centre_of_mass))
    return M + T.T @ A @ T


def point_row(bodies: list[RigidBody], normal: Array, point: Array, first: int, second: int) -> Array:
    """Rate of the gap between two bodies at a point of the world, along the normal out of the first."""
    row = np.zeros(6 * len(bodies))
    for body, sign in ((first, -1.0), (second, 1.0)):
        one = bodies[body]
        arm = point - one.position - rotation_matrix(one.orientation) @ one.centre_of_mass
        row[6 * body : 6 * body + 6] = sign * np.concatenate([normal, np.cross(arm, normal)])
    return row


def velocities(bodies: list[RigidBody]) -> Array:
    """Of the centres of mass, and angular ones, in the world."""
    found = []
    for body in bodies:
        R = rotation_matrix(body.orientation)
        spin = R @ np.asarray(body.angular_velocity, dtype=float)
        found += [*(body.velocity + np.cross(spin, R @ body.centre_of_mass)), *spin]
    return np.array(found)


def found_velocities(found: Found, bodies: list[RigidBody], row: int = 0) -> Array:
    return velocities(
        [
            replace(
                body,
                orientation=found[f"{body.name}.orientation"][row],
                velocity=found[f"{body.name}.velocity"][row],
                angular_velocity=found[f"{body.name}.angular_velocity"][row],
            )
            for body in bodies
        ]
    )


def four_legs() -> TriangleSurface:
    """A table of the size of the box, which stands on sixteen corners."""
    leg = box_surface((0.5, 0.5, SIZE))
    corners = [np.array([x, y, 0.0]) for x in (-1.7, 1.7) for y in (-1.7, 1.7)]
    points = np.vstack([leg.points + corner for corner in corners])
    return TriangleSurface(points, np.vstack([leg.triangles + 8 * k for k in range(len(corners))]))


def boom(striker: int, contour: bool, e: float) -> tuple[Array, dict[str, Any]]:
    """A ball at the end of a boom of one hull touches the deck of the other: the point in the world, and the rest."""
    names, law = ("ab", "ba")[striker], RigidLaw(restitution=e)
    side = 1.0 if striker == 0 else -1.0
    tip = np.array([6.0, side * (AWAY[1] - 5.0), DECK + 1.0])
    point = striker * AWAY + tip - np.array([0.0, 0.0, 1.0])
    if contour:
        x, y = np.meshgrid(np.linspace(-20.0, 20.0, 6), np.linspace(-8.0, 8.0, 6), indexing="ij")
        deck = Contour(
            name="deck", body=names[1], neutral=neutral_surface(np.stack([x, y, 0.0 * x + DECK], -1))
        )
        hit = Contact(name="hit", contour="deck", body=names[0], point=tip, shape=SphereShape(1.0), law=law)
        return point, {"contours": (deck,), "contacts": (hit,)}
    ball = sphere_surface(1.0)
    skins = surfaces(**{names[1]: skin(), names[0]: replace(ball, points=ball.points + tip)})
    return point, {
        "surfaces": skins,
        "collisions": (Collision(name="hit", surfaces=(names[1], names[0]), law=law),),
    }


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("coupling", [0.0, 1.0])
@pytest.mark.parametrize("contour", [True, False])
@pytest.mark.parametrize("striker", [0, 1])
def test_two_hulls_hit_each_other_with_their_full_added_mass(
    striker: int, contour: bool, coupling: float, e: float
) -> None:
    A = added_mass(coupling)
    moving = {
        "velocity": np.array([0.0, 0.1, -0.3]),
        "angular_velocity": np.array([-0.02 if striker == 0 else 0.02, 0.01, 0.005]),
        "centre_of_mass": CENTRE,
    }
    bodies = [floating(name, i * AWAY, **(moving if i == striker else {})) for i, name in enumerate("ab")]
    point, touching = boom(striker, contour, e)
    found = Found(afloat(A, *bodies, **touching), 0.01, 0.0)
    M, before = mass_matrix(A, bodies), velocities(bodies)
    n = point_row(bodies, np.array([0.0, 0.0, 1.0]), point, 1 - striker, striker)
    approach = -(n @ before)
    assert approach > 0.1
    response = np.linalg.solve(M, n)
    effective = 1.0 / (n @ response)
    impulse = (1.0 + e) * effective * approach
    after = found_velocities(found, bodies)
    if not contour:
        np.testing.assert_allclose(found["hit.impact_impulse"][0], impulse, rtol=1e-8)
    np.testing.assert_allclose(after, before + response * impulse, atol=1e-8 * np.abs(before).max())
    np.testing.assert_allclose(n @ after, e * approach, atol=1e-8)
    energy = [0.5 * v @ M @ v for v in (before, after)]
    all_of_it = 0.5 * effective * approach**2
    np.testing.assert_allclose(energy[0] - energy[1], (1.0 - e * e) * all_of_it, atol=1e-7 * all_of_it)


@pytest.mark.parametrize("contour", [True, False])
def test_a_boom_on_a_joint_hits_as_one_that_is_part_of_its_hull(contour: bool) -> None:
    """What a contact feels goes through the joints of all hulls of a group."""
    A, share, place = added_mass(1.0), 0.02, np.array([6.0, 8.0, 4.0])
    whole = floating("a", np.zeros(3), velocity=np.array([0.0, 0.1, -0.3]), centre_of_mass=CENTRE)
    boom_inertia = 0.01 * INERTIA
    rest_centre = (CENTRE - share * place) / (1.0 - share)

    def away(r: Array) -> Array:
        return MASS * (r @ r * np.eye(3) - np.outer(r, r))

    rest_inertia = (
        INERTIA - boom_inertia - share * away(place - CENTRE) - (1.0 - share) * away(rest_centre - CENTRE)
    )
    rest = replace(whole, mass=(1.0 - share) * MASS, inertia=rest_inertia, centre_of_mass=rest_centre)
    arm = RigidBody("arm", share * MASS, boom_inertia, position=place, velocity=whole.velocity)
    weld = FixedJoint(
        name="weld", body_a="a", body_b="arm", frame_a=JointFrame(place), frame_b=JointFrame(np.zeros(3))
    )
    b, (_, one), (_, two) = floating("b", AWAY), boom(0, contour, 0.5), boom(0, contour, 0.5)
    if contour:
        (hit,) = two["contacts"]
        two["contacts"] = (replace(hit, body="arm", point=hit.point - place),)
    else:
        deck, ball = two["surfaces"]
        moved = replace(ball.surface, points=ball.surface.points - place)
        two["surfaces"] = (deck, replace(ball, body="arm", surface=moved))
    merged = Found(afloat(A, whole, b, **one), 0.01, 0.0)
    jointed = Found(afloat(A, rest, b, arm, joints=(weld,), **two), 0.01, 0.0)
    for name in "ab":
        for channel in ("velocity", "angular_velocity"):
            found, expected = (run[f"{name}.{channel}"][0] for run in (jointed, merged))
            # rows are soft by 1e-9 of what the light arm alone yields, hundreds of times what all of it does
            np.testing.assert_allclose(found, expected, atol=1e-7)
    assert np.abs(merged["a.velocity"][0] - whole.velocity).max() > 0.01


@pytest.mark.parametrize("together", [True, False])
@pytest.mark.parametrize("e", [0.0, 0.5])
def test_a_body_on_many_corners_hits_a_hull_that_gives_way(e: float, together: bool) -> None:
    """More contacts than are solved one by one; the hull is no wall, with or without others in its database."""
    A = added_mass(1.0 if together else 0.0)
    place = np.array([9.0, 4.0, 0.0])
    at, inertia = place + AWAY + np.array([0.0, 0.0, DECK + 0.5 * SIZE]), np.eye(3) * MASS * SIZE**2 / 6.0
    box = RigidBody("box", MASS, inertia, position=at, velocity=np.array([0.0, 0.0, -0.5]))
    bodies = [floating("a", np.zeros(3)), floating("b", AWAY), box]
    made = afloat(
        A,
        *bodies,
        together=together,
        surfaces=surfaces(b=skin(), box=four_legs()),
        collisions=(Collision(name="hit", surfaces=("b", "box"), law=RigidLaw(restitution=e)),),
    )
    found = Found(made, 0.01, 0.0)
    M, before, after = mass_matrix(A, bodies), velocities(bodies), found_velocities(found, bodies)
    z = np.array([0.0, 0.0, 1.0])
    corners = [place + AWAY + [x, y, DECK] for x in (-1.95, 1.95) for y in (-1.95, 1.95)]
    rows = np.array([point_row(bodies, z, corner, 1, 2) for corner in corners])
    np.testing.assert_allclose(rows @ after, -e * (rows @ before), atol=1e-7)
    # what the impulses are is open, as there are more than three; that there are such is not
    change = M @ (after - before)
    impulses = np.linalg.lstsq(rows.T, change, rcond=None)[0]
    np.testing.assert_allclose(rows.T @ impulses, change, atol=1e-7 * np.abs(change).max())
    np.testing.assert_allclose(impulses.sum(), found["hit.impact_impulse"][0], rtol=1e-8)


def lifted(A: Array, law: Any, **options: Any) -> Scene:
    """A box that rests on "b" off its middle, and is taken off by a force that grows to 1.2 times its weight."""
    b = floating("b", AWAY, mass=MASS - BOX, centre_of_mass=CENTRE_OF_B)
    place = AWAY + PLACE + np.array([0.0, 0.0, DECK + 0.5 * SIZE])
    box = RigidBody("box", BOX, np.eye(3) * BOX * SIZE**2 / 6.0, position=place)
    lift = PointForce(
        "lift",
        "box",
        np.zeros(3),
        times=np.array([1.0, 4.0]),
        forces=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.2 * BOX * G]]),
    )
    return afloat(
        A,
        floating("a", np.zeros(3)),
        b,
        box,
        forces=(Gravity(np.array([0.0, 0.0, -G])), lift),
        surfaces=surfaces(b=skin(), box=box_surface(SIZE)),
        collisions=(Collision(name="deck", surfaces=("b", "box"), law=law, friction=0.3),),
        **options,
    )


LAWS = {"rigid": RigidLaw(), "linear": LinearLaw(stiffness=2e8, damping=1e7)}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_lifting_off_a_hull_is_that_of_two_databases_where_hulls_do_not_feel_each_other(law: Any) -> None:
    A = added_mass(0.0)
    one, two = (Found(lifted(A, law, together=together), 0.02, 6.0) for together in (True, False))
    check_lift_off(one)
    for name, size in (("a", 1.0), ("b", 1.0), ("box", 1.0)):
        for channel in ("position", "orientation", "velocity", "angular_velocity"):
            x, y = one[f"{name}.{channel}"], two[f"{name}.{channel}"]
            np.testing.assert_allclose(x, y, atol=1e-9 * size)
    np.testing.assert_allclose(one["deck.force"], two["deck.force"], atol=1e-7 * BOX * G)


def test_a_saved_lift_goes_on_bit_for_bit() -> None:
    made = lifted(added_mass(1.0), RigidLaw())
    whole = Simulation(made, 0.02)
    _, expected = whole.advance(220)
    for cut in (30, 180):
        first = Simulation(made, 0.02)
        first.advance(cut)
        state = first.state()
        other = Simulation(made, 0.02)
        other.restore(state)
        np.testing.assert_array_equal(other.advance(220 - cut)[1], expected[cut:])


def check_lift_off(found: Found) -> None:
    """It rests at first with its weight, and is gone in the end."""
    first = found.times < 1.0
    np.testing.assert_allclose(found["deck.force"][first, 2][20:], BOX * G, rtol=0.02)
    assert found["box.position"][-1, 2] - found["b.position"][-1, 2] - DECK - 0.5 * SIZE > 0.2
    assert found["deck.contacts"][-1] == 0.0


def centre_velocity(found: Found, name: str, mass: float) -> Array:
    """Of the centre of mass, which is the origin but for the hulls."""
    centre = {"a": np.array([0.0, 0.0, CENTRE[2]]), "b": CENTRE_OF_B, "box": np.zeros(3)}[name]
    R = np.array([rotation_matrix(q) for q in found[f"{name}.orientation"]])
    return found[f"{name}.velocity"] + np.einsum(
        "tij,tj->ti", R, np.cross(found[f"{name}.angular_velocity"], centre)
    )


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_lifting_off_a_hull_moves_its_neighbour_and_keeps_the_balances(law: Any) -> None:
    """Vertical momentum of bodies and water, from buoyancy, weights and the lift; and energy."""
    A = added_mass(1.0, (2, 3, 4))  # heave, roll and pitch: none of the hulls turns away from x
    found = Found(lifted(A, law), 0.02, 6.0)
    check_lift_off(found)
    assert np.abs(found["a.velocity"][:, 2]).max() > 1e-3  # "a" is moved by the water alone
    check_momentum(found, A, {"a": MASS, "b": MASS - BOX, "box": BOX})
    balance = found["energy.balance"]
    assert np.abs(balance - balance[0]).max() < 1e-6 * BOX * G


def check_momentum(found: Found, A: Array, masses: dict[str, float]) -> None:
    """Heave, which is along the vertical of the world whatever the heading is; all of them head along x."""
    times = found.times
    u, force = np.zeros((len(times), 12)), np.interp(times, [1.0, 4.0], [0.0, 1.2 * BOX * G])
    momentum = np.zeros(len(times))
    for name, mass in masses.items():
        momentum += mass * centre_velocity(found, name, mass)[:, 2]
        force -= mass * G
    for i, name in enumerate("ab"):
        R = np.array([rotation_matrix(q) for q in found[f"{name}.orientation"]])
        assert np.abs(R[:, 1, 0]).max() < 2e-3
        spin = np.einsum("tij,tj->ti", R, found[f"{name}.angular_velocity"])
        u[:, 6 * i : 6 * i + 3] = found[f"{name}.velocity"] + np.cross(spin, R @ REFERENCE)
        u[:, 6 * i + 3 : 6 * i + 6] = spin
        force += RHO * G * found[f"{name}.displaced_volume"]
    momentum += (u @ A)[:, [2, 8]].sum(axis=1)
    given = np.append(0.0, np.cumsum(0.5 * np.diff(times) * (force[1:] + force[:-1])))
    scale = BOX * G
    np.testing.assert_allclose(momentum - momentum[0], given, atol=5e-6 * scale)


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_many_contacts_on_a_hull_are_solved_on_its_velocities(friction: float) -> None:
    """Six boxes slide on the deck of a barge with a list: as with a database that it shares with another one.

    A shared database, here without coupling, has its contacts solved on the matrix of the contacts themselves.
    """
    A = added_mass(0.0)
    start = np.array([np.cos(0.1), np.sin(0.1), 0.0, 0.0])
    turned = rotation_matrix(start)
    barge = floating("a", np.zeros(3), orientation=start, angular_velocity=np.array([-0.2, 0.03, 0.0]))
    boxes = [
        RigidBody(
            f"box_{i}",
            0.02 * MASS,
            0.02 * MASS * np.diag([1.0, 1.0, 0.7]),
            position=turned @ [4.0 * (i % 3) - 4.0, 4.0 * (i // 3) - 2.0, DECK + 1.0 + 1e-3 * i],
            orientation=start,
        )
        for i in range(6)
    ]
    touching = {
        "surfaces": surfaces(a=skin(), **{box.name: box_surface(2.0) for box in boxes}),
        "collisions": tuple(
            Collision(name=f"on_{box.name}", surfaces=("a", box.name), friction=friction, law=RigidLaw())
            for box in boxes
        ),
    }
    far = floating("b", AWAY)
    alone, shared = (
        Found(afloat(A, barge, far, *boxes, together=together, **touching), 0.02, 3.0)
        for together in (False, True)
    )
    systems = [found.simulation._layout.systems[1] for found in (alone, shared)]
    assert [bool(rows.counts.all_rigid) for rows in systems] == [True, False]
    assert np.linalg.norm(alone["box_5.position"][-1] - turned @ boxes[5].position) > 0.5
    assert sum(alone[f"on_{box.name}.contacts"][-1] for box in boxes) >= 18
    for name in ("a.position", "a.orientation", *(f"{box.name}.position" for box in boxes)):
        if friction == 0.0:
            np.testing.assert_allclose(alone[name][:50], shared[name][:50], rtol=0.0, atol=1e-8)
            np.testing.assert_allclose(alone[name], shared[name], rtol=0.0, atol=1e-6)
        else:
            # which of four corners bears and rubs is not unique: rounding decides, by the processor as soon as they
            # land (6e-6 m then, of the half metre that boxes slide); a wrong matrix is off by percents of that
            np.testing.assert_allclose(alone[name][:50], shared[name][:50], rtol=0.0, atol=5e-5)
