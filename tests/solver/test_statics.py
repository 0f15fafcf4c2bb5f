"""Static equilibrium against closed forms and the equations of statics solved by scipy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from point_masses import make_cloud
from scipy.optimize import root
from scipy.spatial.transform import Rotation
from start_scenes import DOWN, G, linkage, parallelograms, place, quaternion, rod, rows_of

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import JointSpring, Spring
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint
from heavylift.solver.scene.scene import Fixed, FlexibleBody, RigidBody, Scene
from heavylift.solver.statics.equilibrium import find_equilibrium
from heavylift.solver.statics.forces import StaticForces, act_between


def pendulum(angle: float) -> Scene:
    """A rod of 1 m from the origin, turned by an angle [rad] from hanging."""
    return linkage([(0, 0, 0), (np.sin(angle), -np.cos(angle), 0)], closed=False)


@pytest.mark.parametrize("degrees", [60.0, 179.0, 180.0])
def test_pendulum_hangs_down(degrees: float) -> None:
    """Also from upside down, where it is in balance but not stable; the hinge carries the weight."""
    rows = rows_of(pendulum(np.radians(degrees)))
    found = find_equilibrium(rows)
    assert found.residual < 1e-8
    assert found.stable is True
    assert place(rows, "r0") == pytest.approx([0.0, -0.5, 0.0], abs=1e-8)
    assert np.linalg.norm(rows.column("reaction")[:3]) == pytest.approx(G, rel=1e-9)
    assert rows.survey()[2] == pytest.approx(np.zeros(6), abs=1e-12)


def test_hanging_chain_of_two_pulled_aside() -> None:
    """Link i hangs at ``tan a = F / (weight below)``, its own weight by half."""
    pull = 7.0
    scene = linkage([(0, 0, 0), (1, 0, 0), (2, 0, 0)], closed=False)
    load = PointForce("pull", "r1", np.array([0.5, 0, 0]), np.zeros(1), np.array([[pull, 0.0, 0.0]]))
    rows = rows_of(replace(scene, forces=(DOWN, load)))
    assert find_equilibrium(rows).residual < 1e-8
    upper, lower = np.arctan2(pull, 1.5 * G), np.arctan2(pull, 0.5 * G)
    knee = np.array([np.sin(upper), -np.cos(upper), 0.0])
    tip = knee + np.array([np.sin(lower), -np.cos(lower), 0.0])
    assert place(rows, "r0") == pytest.approx(knee / 2.0, abs=1e-7)
    assert place(rows, "r1") == pytest.approx((knee + tip) / 2.0, abs=1e-7)


def catenary(count: int, span: float) -> tuple[np.ndarray, float, float]:
    """Ends of links of 1 m and 1 kg between two points at one height, and the force at the left end."""

    def angles(force: np.ndarray) -> np.ndarray:
        # at the middle of link i the chain pulls with H along and V less half of its weight across
        return np.arctan2(force[1] + G * (np.arange(count) + 0.5), force[0])

    def misses(force: np.ndarray) -> list[float]:
        a = angles(force)
        return [np.cos(a).sum() - span, np.sin(a).sum()]

    solution = root(misses, [0.5 * count * G, -0.5 * count * G], tol=1e-13)
    assert solution.success
    a = angles(solution.x)
    steps = np.column_stack([np.cos(a), np.sin(a), np.zeros(count)])
    return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]), *solution.x


def test_chain_between_two_points_hangs_in_the_discrete_catenary() -> None:
    """From a zigzag above its ends, 20 links over a span of 12 m."""
    count, span = 20, 12.0
    rise = np.sqrt(1.0 - (span / count) ** 2)
    rows = rows_of(linkage([(i * span / count, rise * (i % 2), 0) for i in range(count + 1)]))
    found = find_equilibrium(rows)
    assert found.residual < 1e-8
    assert found.stable is True
    ends, along, across = catenary(count, span)
    places = np.array([place(rows, f"r{i}") for i in range(count)])
    assert np.abs(places - (ends[1:] + ends[:-1]) / 2.0).max() < 1e-7
    first = rows.names.index("h0")
    on_rod = rows.column("reaction")[rows.block == first][:2]
    assert on_rod == pytest.approx([-along, -across], rel=1e-7)


def test_loops_with_redundant_rows_fall_to_their_lowest_position() -> None:
    rows = rows_of(parallelograms(3))
    found = find_equilibrium(rows)
    assert found.residual < 1e-8
    assert found.stable is True
    for k in range(4):
        assert place(rows, f"crank{k}") == pytest.approx([k, -0.5, 0.0], abs=1e-7)


def hung(length: float) -> Scene:
    """A hook on a spring and two ropes, one of them too long to carry, drawn well off its place."""
    hook = RigidBody("hook", 100.0, np.eye(3), position=np.array([1.5, -1.0, 0.4]))
    point = np.zeros(3)
    spring = Spring(
        name="spring", body_a=GROUND, point_a=np.array([3.0, 0.0, 0.0]), body_b="hook", point_b=point,
        length=2.0, stiffness=200.0,
    )  # fmt: skip

    def rope(name: str, x: float, free: float) -> Rope:
        path = (RopePoint(GROUND, np.array([x, 0.0, 0.0])), RopePoint("hook", point))
        return Rope(name=name, path=path, axial_stiffness=5e4, length=free, damping=10.0)

    return Scene((hook,), (DOWN, spring), (), (), (rope("short", 0.0, length), rope("long", -1.0, 6.0)))


def test_hook_on_a_spring_a_rope_and_a_slack_rope() -> None:
    length = 2.0

    def misses(x: np.ndarray) -> np.ndarray:
        p = np.array([x[0], x[1], 0.0])
        to_rope, to_spring = -p, np.array([3.0, 0.0, 0.0]) - p
        reach, stretch = np.linalg.norm(to_rope), np.linalg.norm(to_spring)
        tension, pull = 5e4 / length * (reach - length), 200.0 * (stretch - 2.0)
        force = tension * to_rope / reach + pull * to_spring / stretch
        return np.array([force[0], force[1] - 100.0 * G])

    expected = root(misses, [0.3, -2.0], tol=1e-13).x
    rows = rows_of(hung(length))
    found = find_equilibrium(rows)
    assert found.residual < 1e-8
    assert place(rows, "hook") == pytest.approx([*expected, 0.0], abs=1e-7)


def many_ropes(seed: int) -> tuple[Scene, np.ndarray, np.ndarray]:
    """A stone below 16 stiff ropes of all lengths, above all of them; ends of the ropes and their lengths."""
    rng = np.random.default_rng(seed)
    ends = np.column_stack([rng.uniform(-5, 5, 16), rng.uniform(2, 4, 16), rng.uniform(-5, 5, 16)])
    lengths = rng.uniform(9.0, 12.0, 16)
    ropes = tuple(
        Rope(
            name=f"rope{i}",
            path=(RopePoint(GROUND, end), RopePoint("stone", np.zeros(3))),
            axial_stiffness=1e8,
            length=float(length),
        )
        for i, (end, length) in enumerate(zip(ends, lengths, strict=True))
    )
    stone = RigidBody("stone", 100.0, np.eye(3), position=np.array([0.3, 0.5, -0.2]))
    return Scene((stone,), (DOWN,), (), (), ropes), ends, lengths


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_ropes_that_hang_slack_go_taut_on_the_way(seed: int) -> None:
    """All are slack at first, few at rest; each stretches by a millionth of its length only. Forces summed by hand."""
    scene, ends, lengths = many_ropes(seed)
    rows = rows_of(scene)
    found = find_equilibrium(rows)
    way = ends - place(rows, "stone")
    reach = np.linalg.norm(way, axis=1)
    tension = np.maximum(0.0, 1e8 * (reach / lengths - 1.0))
    assert 1 <= np.count_nonzero(tension) <= 4
    assert np.abs(tension @ (way / reach[:, None]) - [0.0, 100.0 * G, 0.0]).max() < 1e-3 * 100.0 * G
    assert found.residual < 1e-8
    assert found.iterations < 150


def test_stiffness_is_that_of_differences_body_by_body() -> None:
    """Bodies that are displaced together must not be taken for each other: a chain with a spring, ropes and a loop."""
    scene = hung(1.82)
    chain = linkage([(4, 0, 0), (5, -1, 0), (6, -1, 0), (7, 0, 0)])
    more = Rope(
        name="tie",
        path=(RopePoint("hook", np.zeros(3)), RopePoint("r1", np.zeros(3)), RopePoint(GROUND, np.array([9, 3, 0.0]))),
        axial_stiffness=1e4,
        length=9.2,
    )  # fmt: skip
    both = replace(
        scene, bodies=(*scene.bodies, *chain.bodies), joints=chain.joints, ropes=(*scene.ropes, more)
    )
    rows = rows_of(both)
    forces = StaticForces(rows)
    load, G, soft = forces.evaluate()
    reaction = forces.balance(load, G)[0]
    given = forces.one_sided(soft)
    assert np.count_nonzero(given.tension) >= 2
    K = forces.stiffness(reaction).toarray()
    kept = forces.stiffness(reaction + soft, given.row).toarray()
    before, step, count = rows.snapshot(), 1e-6, len(rows.inertia)
    expected = np.zeros((count, count))
    for k in rows.free:
        sides = []
        for sign in (step, -step):
            rows.move(sign * np.eye(count)[k])
            there, turned, _ = forces.evaluate()
            sides.append(there + turned.T @ reaction)
            rows.restore(before)
        expected[:, k] = (sides[1] - sides[0]) / (2.0 * step)
    expected = expected[np.ix_(rows.free, rows.free)]
    assert np.abs(K - expected).max() < 1e-6 * np.abs(expected).max()
    rows_of_taut = G[given.row][:, rows.free].toarray() * given.sense[:, None]
    taut = given.elongation > 0.0
    stretch = rows_of_taut[taut].T @ (given.stiffness[taut, None] * rows_of_taut[taut])
    assert np.abs(kept + stretch - expected).max() < 1e-6 * np.abs(expected).max()


def test_dense_and_sparse_matrices_find_the_same_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """Springs, ropes, a loop with redundant rows: whatever the size from which matrices are sparse."""
    chain = linkage([(4, 0, 0), (5, -1, 0), (6, -1, 0), (7, 0, 0)])
    scene = hung(1.82)
    both = replace(scene, bodies=(*scene.bodies, *chain.bodies), joints=chain.joints)
    found = []
    for small in (0, 10_000):
        monkeypatch.setattr("heavylift.solver.start.rows.SMALL", small)
        rows = rows_of(both)
        assert find_equilibrium(rows).residual < 1e-11
        found.append((rows.survey()[0], rows.column("reaction")))
    np.testing.assert_allclose(found[0][0], found[1][0], atol=1e-10)
    np.testing.assert_allclose(found[0][1], found[1][1], atol=1e-7)


def test_modes_of_a_fixed_flexible_body_sag() -> None:
    """``q = S^T R^T g / k`` with S the modal momenta: every mode for itself."""
    cloud = make_cloud(rigid_part=0.3)
    turn = Rotation.from_rotvec([0.3, -0.5, 0.8])
    body = FlexibleBody("beam", cloud.reduced(), motion=Fixed(), orientation=quaternion(turn))
    rows = rows_of(Scene((body,), (DOWN,)))
    find_equilibrium(rows)
    translation = np.einsum("n,mnk->mk", cloud.masses, cloud.shapes)
    expected = translation @ turn.inv().apply([0.0, -G, 0.0]) / cloud.stiffness
    assert rows.layout.bodies[0].modal_position == pytest.approx(expected, rel=1e-7)


def test_flexible_body_on_a_ball_joint_hangs_and_bends() -> None:
    """The deformed centre of mass hangs below the joint; weights and their reaction at one node bend the modes."""
    cloud, pinned = make_cloud(frequencies=(12.0, 40.0)), 3
    body = FlexibleBody(
        "load", cloud.reduced(), orientation=quaternion(Rotation.from_rotvec([0.3, -0.5, 0.8]))
    )
    world = Rotation.from_rotvec([0.3, -0.5, 0.8]).apply(cloud.nodes[pinned])
    pin = Ball(
        name="pin", body_a=GROUND, body_b="load", frame_a=JointFrame(world), frame_b=JointFrame(cloud.nodes[pinned])
    )  # fmt: skip
    rows = rows_of(Scene((body,), (DOWN,), (), (pin,)))
    found = find_equilibrium(rows)
    assert found.residual < 1e-8
    assert found.stable is True
    pose, q = rows.survey()[0][0, 1:], rows.layout.bodies[0].modal_position
    turn = Rotation.from_quat(pose[[4, 5, 6, 3]])
    points = pose[:3] + turn.apply(cloud.deformed(q))
    centre = cloud.masses @ points / cloud.masses.sum()
    assert points[pinned] == pytest.approx(world, abs=1e-9)
    assert (centre - world)[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-7)
    assert centre[1] < world[1]
    g = turn.inv().apply([0.0, -G, 0.0])
    loads = cloud.masses[:, None] * g
    loads[pinned] -= cloud.masses.sum() * g
    assert cloud.stiffness * q == pytest.approx(np.einsum("nk,mnk->m", loads, cloud.shapes), abs=1e-6)


def test_what_nothing_holds_is_named_with_its_force() -> None:
    body = replace(rod("stone", (0, 0, 0), (1, 0, 0), mass=3.0))
    with pytest.raises(InputError, match=r"nothing holds 29\.43 N on 'stone' along \(0, -1, 0\)"):
        find_equilibrium(rows_of(Scene((body,), (DOWN,))))


def test_what_only_watches_acts_between_no_bodies() -> None:
    """Else no two directions of a scene with shells are displaced together, and its statics cost 15 times as much."""
    from heavylift.solver.forces.gravity import UniformGravity
    from heavylift.solver.forces.spring import Springs
    from heavylift.solver.sensors.fleet_angles import FleetAngles
    from heavylift.solver.sensors.hook_loads import HookLoads
    from heavylift.solver.sensors.lugs import Lugs
    from heavylift.solver.sensors.rope_groups import RopeGroups

    watching = [kind.__new__(kind) for kind in (UniformGravity, HookLoads, FleetAngles, Lugs, RopeGroups)]
    assert not act_between(watching)
    assert act_between([*watching, Springs.__new__(Springs)])


def follower(spin_stiffness: float) -> Scene:
    """A carriage on a spring along y, on it a rotor on a spring about z, pushed along its own x with 200 N.

    With the travel y and the angle a: ``100 y = 200 sin a`` and ``spin_stiffness a = 0``.
    """
    along = JointFrame(np.zeros(3), np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]).T)
    start = np.array([0.0, 0.3, 0.0])
    bodies = (
        RigidBody("carriage", 2.0, np.eye(3), position=start),
        RigidBody(
            "rotor", 1.0, np.eye(3), position=start, orientation=quaternion(Rotation.from_euler("z", 0.4))
        ),
    )
    return Scene(
        bodies,
        (
            PointForce("push", "rotor", np.zeros(3), force=np.array([200.0, 0.0, 0.0]), frame="body"),
            JointSpring(name="rail_spring", joint="rail", stiffness=100.0),
            JointSpring(name="pin_spring", joint="pin", stiffness=spin_stiffness),
        ),
        joints=(
            Slider(name="rail", body_a=GROUND, body_b="carriage", frame_a=along, frame_b=along),
            Hinge(name="pin", body_a="carriage", body_b="rotor"),
        ),
    )


@pytest.mark.parametrize("spin_stiffness", [10.0, 1000.0])
def test_a_force_that_turns_with_its_body_is_no_mechanism(spin_stiffness: float) -> None:
    """``[[100, -200], [0, c]]`` has the eigenvalues 100 and c; its symmetric part is not positive for c < 100."""
    rows = rows_of(follower(spin_stiffness))
    found = find_equilibrium(rows)
    assert found.residual < 1e-8
    assert found.stable is True
    assert place(rows, "carriage") == pytest.approx(np.zeros(3), abs=1e-8)
