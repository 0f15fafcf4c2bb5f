"""Matrices of the frequency domain from a scene: closed forms of a box, springs by their energy, joints by merging."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import quaternion_from_rotation_vector
from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.force_elements.maxwell_rope import MaxwellRope
from heavylift.solver.forces.spring import Spring
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, Radiation, Sea, Tank, Water
from heavylift.solver.water.hulls.frequency_domain import motion_operators, natural_modes
from heavylift.solver.water.hulls.linearise import hull_transform, joined_database, linear_group, linearise

if TYPE_CHECKING:
    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

FILE = Path(__file__).parents[3] / "cases" / "transport_barge" / "barge.nc"
LENGTH, BREADTH, HEIGHT, DRAFT, KG = 97.5, 36.0, 9.0, 4.5, 2.0  # KG above the water
G = 9.81


@cache
def database() -> HydrodynamicDatabase:
    return read_netcdf(FILE)


MASS = LENGTH * BREADTH * DRAFT * 1025.0
INERTIA = np.diag([MASS * (0.35 * BREADTH) ** 2, MASS * (0.25 * LENGTH) ** 2, MASS * (0.26 * LENGTH) ** 2])


def barge_scene(*, heave: float = 0.0, yaw: float = 0.0, **sea) -> Scene:
    """The origin of the body is the centre of the box, which floats in the middle of its height."""
    body = RigidBody(
        "barge",
        MASS,
        INERTIA,
        centre_of_mass=np.array([0.0, 0.0, KG]),
        position=np.array([3.0, -2.0, heave]),
        orientation=quaternion_from_rotation_vector(np.array([0.0, 0.0, yaw])),
    )
    hull = Hull(body="barge", restoring=box_surface((LENGTH, BREADTH, HEIGHT)))
    return Scene(
        bodies=(body,),
        forces=(Gravity(np.array([0.0, 0.0, -G])),),
        sea=Sea(
            water=Water(gravity=G),
            hulls=(hull,),
            radiation=(Radiation(bodies=("barge",), database=database()),),
            **sea,
        ),
    )


def box_stiffness() -> np.ndarray:
    """Water plane, volume and weight about the centre of the water plane."""
    rho = 1025.0
    C = np.zeros((6, 6))
    C[2, 2] = rho * G * LENGTH * BREADTH
    moment = MASS * G * (-0.5 * DRAFT - KG)
    C[3, 3] = rho * G * LENGTH * BREADTH**3 / 12.0 + moment
    C[4, 4] = rho * G * BREADTH * LENGTH**3 / 12.0 + moment
    return C


def box_mass(mass: float, inertia: np.ndarray, z: float) -> np.ndarray:
    M = np.diag([mass, mass, mass, *(np.diag(inertia) + np.array([mass * z * z, mass * z * z, 0.0]))])
    M[0, 4] = M[4, 0] = mass * z
    M[1, 3] = M[3, 1] = -mass * z
    return M


def by_hand(mass: np.ndarray, stiffness: np.ndarray, heading_index: int) -> np.ndarray:
    """Motions per metre at the frequencies of the database, shape (nw, 6); A and B are symmetric in theory."""
    base = database()
    found = []
    for k, w in enumerate(base.omega):
        A, B = (0.5 * (one[k] + one[k].T) for one in (base.added_mass, base.damping))
        Z = -w * w * (mass + A) - 1j * w * B + stiffness
        found.append(np.linalg.solve(Z, base.excitation[k, heading_index]))
    return np.array(found)


def test_velocities_of_the_reference_point_are_those_of_a_rigid_body() -> None:
    R = Rotation.from_rotvec([0.3, -0.2, 0.9]).as_matrix()
    reference, heading = np.array([4.0, -1.0, 2.5]), 0.8
    v, spin = np.array([0.4, 1.1, -0.3]), np.array([0.2, -0.5, 0.7])
    u = hull_transform(R, reference, heading) @ np.concatenate([v, spin])
    back = Rotation.from_rotvec([0.0, 0.0, -heading]).as_matrix()
    omega = R @ spin
    assert u[:3] == pytest.approx(back @ (v + np.cross(omega, R @ reference)), abs=1e-14)
    assert u[3:] == pytest.approx(back @ omega, abs=1e-14)


def radiation() -> Radiation:
    return Radiation(bodies=("barge",), database=database())


def test_a_hull_elsewhere_has_the_database_it_was_given() -> None:
    joined = joined_database(
        (radiation(),),
        ("barge", "crane"),
        np.array([0.7, 0.7]),
        np.array([[30.0, 5.0, 1.0], [0.0, 0.0, 9.0]]),
        level=1.0,
    )
    base = database()
    count = len(base.headings)
    assert joined.bodies == ("barge", "crane")
    assert joined.headings[:count] == pytest.approx(base.headings)
    assert joined.reference_points[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    np.testing.assert_array_equal(joined.added_mass[:, :6, :6], base.added_mass)
    np.testing.assert_array_equal(joined.damping[:, :6, :6], base.damping)
    size = np.abs(base.excitation).max(axis=(0, 1))
    assert np.abs(joined.excitation[:, :count, :6] - base.excitation).max(axis=(0, 1)) == pytest.approx(
        0.0 * size, abs=1e-12 * size.max()
    )
    assert not joined.added_mass[:, 6:].any()
    assert not joined.excitation[:, :, 6:].any()


def test_a_turned_hull_elsewhere_feels_the_same_wave_from_another_side() -> None:
    base = database()
    headings = np.array([0.2, 0.2 + np.deg2rad(30.0)])
    points = np.array([[10.0, 0.0, 0.0], [70.0, -40.0, 0.0]])
    two = (Radiation(bodies=("one",), database=base), Radiation(bodies=("two",), database=base))
    joined = joined_database(two, ("one", "two"), headings, points)
    beta = int(np.argmin(np.abs(joined.headings - np.deg2rad(80.0))))
    fifty = int(np.argmin(np.abs(base.headings - np.deg2rad(50.0))))
    k = base.omega**2 / base.gravity
    # the wave travels at 80 degrees from the first hull: phase at the second by its distance along the world direction
    world = headings[0] + np.deg2rad(80.0)
    along = (points[1] - points[0])[:2] @ [np.cos(world), np.sin(world)]
    expected = base.excitation[:, fifty] * np.exp(1j * k * along)[:, None]
    size = np.abs(expected).max()
    assert np.abs(joined.excitation[:, beta, 6:] - expected).max() < 1e-9 * size
    own = base.excitation[:, int(np.argmin(np.abs(base.headings - joined.headings[beta])))]
    assert np.abs(joined.excitation[:, beta, :6] - own).max() < 1e-9 * size


def test_a_scene_without_databases_is_refused() -> None:
    scene = barge_scene()
    assert scene.sea is not None
    with pytest.raises(InputError, match="no databases"):
        linearise(replace(scene, sea=replace(scene.sea, radiation=())))
    with pytest.raises(InputError, match="no hulls"):
        linearise(replace(scene, sea=None))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_free_box_has_the_stiffness_of_its_water_plane_and_the_motions_of_its_database() -> None:
    linear = linearise(barge_scene(heave=0.03, yaw=0.4))
    C = box_stiffness()
    rough = 1e-7 * np.sqrt(np.outer(np.diag(C) + C[2, 2], np.diag(C) + C[2, 2]))
    assert np.all(np.abs(linear.stiffness - C) <= rough)
    assert linear.mass == pytest.approx(box_mass(MASS, INERTIA, KG), rel=1e-9, abs=1e-6 * MASS)
    assert linear.points[0] == pytest.approx([3.0, -2.0, 0.0], abs=1e-9)
    assert linear.headings[0] == pytest.approx(0.4, abs=1e-9)
    assert linear.asymmetry < 1e-8
    hulls = linear_group(barge_scene(), linear)
    base = database()
    heading = 4  # 40 degrees
    operators = motion_operators(hulls, headings=[base.headings[heading]])
    expected = by_hand(box_mass(MASS, INERTIA, KG), C, heading)
    assert np.abs(operators.motion[:, 0] - expected).max() < 1e-6 * np.abs(expected).max()
    # heave: no coupling with anything at all for a box that is symmetric fore and aft
    period = next(mode.period for mode in natural_modes(hulls) if mode.coordinate == 2)
    w = 2.0 * np.pi / period
    A33 = np.interp(w, base.omega, base.added_mass[:, 2, 2])
    assert w**2 * (MASS + A33) == pytest.approx(C[2, 2], rel=2e-3)  # the table is interpolated linearly here


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_ballast_has_mass_and_its_free_surface_takes_from_the_restoring() -> None:
    tank = Tank(
        name="ballast",
        hull="barge",
        point=np.array([0.0, 0.0, -3.0]),
        times=np.array([0.0, 100.0]),
        masses=np.array([2e5, 9e5]),
        free_surface=(4e3, 7e3),
        density=1e3,
    )
    plain, filled = linearise(barge_scene()), linearise(barge_scene(tanks=(tank,)))
    change = filled.mass - plain.mass
    sunk = 2e5 / (1025.0 * LENGTH * BREADTH)  # its reference point goes down with the hull
    assert change[:3, :3] == pytest.approx(2e5 * np.eye(3), abs=1e-3)
    assert change[0, 4] == pytest.approx(-3.0 * 2e5, rel=1e-6)
    # moments about the reference point: buoyancy at half the draft, the weight of the water 3 m below it
    draft = DRAFT + sunk
    about = -sunk  # height of the reference point
    buoyancy = (MASS + 2e5) * G * (-0.5 * draft - about)
    before = MASS * G * (-0.5 * DRAFT)
    expected = buoyancy - before + 3.0 * 2e5 * G - G * np.array([4e6, 7e6])
    lever = np.diag(filled.stiffness - plain.stiffness)[3:5]
    assert lever == pytest.approx(expected, rel=1e-4)


def spring_energy(
    q: np.ndarray, anchors: np.ndarray, ends: np.ndarray, lengths: np.ndarray, k: float
) -> float:
    moved = q[:3] + Rotation.from_rotvec(q[3:]).apply(ends)
    return float(np.sum(0.5 * k * (np.linalg.norm(moved - anchors, axis=1) - lengths) ** 2))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_springs_add_the_second_derivative_of_their_energy() -> None:
    ends = np.array([[48.0, 10.0, 0.0], [48.0, -10.0, 0.0], [-48.0, 10.0, 0.0], [-48.0, -10.0, 0.0]])
    away = ends + np.array([[60.0, 25.0, 0.0], [60.0, -25.0, 0.0], [-60.0, 25.0, 0.0], [-60.0, -25.0, 0.0]])
    k, c = 4e5, 3e4
    lengths = np.full(4, 60.0)  # stretched by 5 m: pretension
    shift = np.array([3.0, -2.0, 0.0])
    springs = tuple(
        Spring(
            name=f"s{i}", body_a=GROUND, point_a=away[i] + shift, body_b="barge", point_b=ends[i],
            length=60.0, stiffness=k, damping=c,
        )
        for i in range(4)
    )  # fmt: skip
    scene = barge_scene()
    linear = linearise(replace(scene, forces=(*scene.forces, *springs)))
    H, step = np.zeros((6, 6)), np.array([1e-3] * 3 + [1e-4] * 3)
    for i in range(6):
        for j in range(6):
            for si in (1.0, -1.0):
                for sj in (1.0, -1.0):
                    q = np.zeros(6)
                    q[i] += si * step[i]
                    q[j] += sj * step[j]
                    H[i, j] += si * sj * spring_energy(q, away, ends, lengths, k) / (4.0 * step[i] * step[j])
    difference = linear.stiffness - box_stiffness() - H
    size = np.sqrt(np.diag(H) + np.diag(box_stiffness()))
    assert np.all(np.abs(difference) < 1e-6 * np.outer(size, size))
    n = (away - ends) / np.linalg.norm(away - ends, axis=1)[:, None]
    rows = np.hstack([n, np.cross(ends, n)])
    assert linear.damping == pytest.approx(c * rows.T @ rows, rel=1e-5, abs=1e-3 * c)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_load_that_is_fixed_to_the_hull_moves_with_it_as_one_body() -> None:
    load_mass, inertia = 3e5, np.diag([4e6, 5e6, 6e6])
    arm = np.array([12.0, 0.0, 7.0])
    scene = barge_scene()
    barge = scene.bodies[0]
    load = RigidBody("load", load_mass, inertia, position=np.asarray(barge.position) + arm)
    fixed = FixedJoint(
        name="seafastening",
        body_a="barge",
        body_b="load",
        frame_a=JointFrame(point=arm),
        frame_b=JointFrame(point=np.zeros(3)),
    )
    apart = replace(scene, bodies=(barge, load), joints=(fixed,))
    centre = (MASS * np.array([0.0, 0.0, KG]) + load_mass * arm) / (MASS + load_mass)
    total = np.zeros((3, 3))
    for mass, own, place in ((MASS, INERTIA, np.array([0.0, 0.0, KG])), (load_mass, inertia, arm)):
        r = place - centre
        total += own + mass * (r @ r * np.eye(3) - np.outer(r, r))
    merged = replace(
        scene, bodies=(replace(barge, mass=MASS + load_mass, inertia=total, centre_of_mass=centre),)
    )
    one, two = linearise(merged), linearise(apart)
    assert two.bodies == ("barge", "load")
    assert two.jacobian.shape == (6, 12)
    headings = [0.0, np.deg2rad(60.0)]
    whole = motion_operators(linear_group(merged, one), headings=headings)
    parts = motion_operators(linear_group(apart, two), headings=headings)
    largest = np.abs(whole.motion).max(axis=(0, 1))
    assert np.abs(parts.motion[..., :6] - whole.motion).max(axis=(0, 1)) == pytest.approx(
        np.zeros(6), abs=1e-5 * largest.max()
    )
    # the joint carries the load: its force makes the acceleration
    force = parts.constraint_force @ two.jacobian[:, 6:9]
    acceleration = -((parts.omega**2)[:, None, None]) * parts.motion[..., 6:9]
    size = np.abs(load_mass * acceleration).max()
    assert np.abs(force - load_mass * acceleration).max() < 1e-6 * size


def test_a_rope_that_creeps_has_no_stiffness_for_all_frequencies() -> None:
    scene = barge_scene()
    places = RopePoint(GROUND, np.array([3.0, -2.0, 50.0])), RopePoint("barge", np.zeros(3))
    rope = MaxwellRope(name="strap", path=places, stiffness=1e6, viscosity=1e7)
    with pytest.raises(InputError, match="'strap' creeps: its stiffness depends on the frequency"):
        linearise(replace(scene, ropes=(rope,)))
