"""Kernels of hulls one by one: buoyancy and its potential by differences, transform by NumPy, filter by integration."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hull_shapes import outward_hull
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, LinearRestoring, Sea, Tank, Water
from heavylift.solver.water.hulls.kind import (
    Hulls,
)
from heavylift.solver.water.hulls.matrix import restore, restoring_potential
from heavylift.solver.water.hulls.step import filtered, hull_yaw, put_transform

G, RHO, LEVEL = 9.81, 1025.0, 0.7
REFERENCE_POINT = np.array([1.5, -0.7, 0.4])
CENTRE = np.array([0.4, -0.2, 0.6])
INERTIA = np.array([[9.0e5, 1.2e5, -0.8e5], [1.2e5, 2.5e6, 0.9e5], [-0.8e5, 0.9e5, 2.8e6]])
WATERPLANE = np.array([40.0, 15.0, -9.0, 330.0, 95.0, 21.0])
PLAIN, TANKED, LINEAR = range(3)


@kernel
def restore_at(kind, hull, position, R, out):  # type: ignore[no-untyped-def]
    """Force, moment, stiffness and potential at a pose."""
    for k in range(3):
        kind.frame[hull].mid_position[k] = position[k]
    for k in range(9):
        kind.frame[hull].mid_rotation[k] = R[k]
    restore(kind, hull)
    for k in range(6):
        out[k] = kind.stage[hull].lift[k]
        out[6 + k] = kind.stage[hull].stiffness[k]
    out[12] = restoring_potential(kind, hull)


@kernel
def transform_at(kind, hull, heading, R, near):  # type: ignore[no-untyped-def]
    put_transform(kind, hull, heading, R, kind.stage[hull].transform)
    return hull_yaw(kind, hull, R, near)


@kernel
def filter_after(value, rate, target, frequency, time):  # type: ignore[no-untyped-def]
    return filtered(value, rate, target, frequency, time)


def wedge() -> TriangleSurface:
    """A hull without any symmetry, 12 m long."""
    points = np.array(
        [
            [-6.0, -2.0, 2.1], [-6.2, 2.4, 1.9], [6.5, -1.6, 2.3], [6.0, 1.9, 2.6],
            [-5.0, -1.4, -1.6], [-5.4, 1.1, -1.4], [4.6, -0.9, -1.9], [4.9, 1.3, -1.2],
        ]
    )  # fmt: skip
    return TriangleSurface(points=points, triangles=outward_hull(points))


@cache
def kind() -> Hulls:
    """Three hulls in one kind: clipped, clipped with a tank, linear with a tank."""
    names = ("plain", "tanked", "linear")
    linear = LinearRestoring(
        volume=90.0,
        centre_of_buoyancy=np.array([0.3, 0.1, -0.9]),
        reference=np.array([0.2, -0.3, 0.5]),
        area=WATERPLANE[0],
        first_moments=tuple(WATERPLANE[1:3]),
        second_moments=tuple(WATERPLANE[3:]),
    )
    hulls = tuple(
        Hull(body=name, restoring=linear if name == "linear" else wedge(), reference=REFERENCE_POINT)
        for name in names
    )
    tanks = tuple(
        Tank(
            name=f"tank_{name}",
            hull=name,
            point=np.array([1.0, 0.2, 0.1]),
            mass=4e3,
            free_surface=(11.0, 23.0),
            density=1e3,
        )
        for name in names[1:]
    )
    bodies = tuple(
        RigidBody(name, 9e4, INERTIA, centre_of_mass=CENTRE, position=np.array([0.0, 40.0 * i, LEVEL]))
        for i, name in enumerate(names)
    )
    water = Water(density=RHO, gravity=G, level=LEVEL)
    scene = Scene(
        bodies, (Gravity(np.array([0.0, 0.0, -G])),), sea=Sea(water=water, hulls=hulls, tanks=tanks)
    )
    (found,) = pack_scene(scene).bodies
    return found


def axes() -> np.ndarray:
    """Columns: axes of the bodies in principal axes, as the kind has them."""
    x, y = kind().hulls[0].axis_x, kind().hulls[0].axis_y
    return np.column_stack([x, y, np.cross(x, y)])


def pose(height: float, tilt: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Place of the centre of mass, and the turn of the principal axes of a body that is turned by a vector."""
    turn = Rotation.from_rotvec(tilt).as_matrix()
    return np.array([3.0, -2.0, LEVEL + height]), turn @ axes().T


def evaluate(hull: int, position: np.ndarray, R: np.ndarray) -> np.ndarray:
    out = np.zeros(13)
    restore_at(kind(), hull, position, np.ascontiguousarray(R).ravel(), out)
    return out


POSES = [
    (0.3, (0.05, -0.08, 0.4)),
    (-0.9, (0.3, 0.2, -2.0)),
    (1.1, (-0.6, 0.35, 0.1)),
    (0.0, (2.2, 0.4, 0.0)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("height", "tilt"), POSES)
@pytest.mark.parametrize("hull", [PLAIN, TANKED, LINEAR])
def test_force_and_moment_are_the_gradient_of_the_potential(hull: int, height: float, tilt: tuple) -> None:
    """In the water, tilted, and nearly upside down; moments are those about the axes of the body."""
    x, R = pose(height, tilt)
    found, eps = evaluate(hull, x, R), 1e-4
    for k in range(3):
        step = np.eye(3)[k] * eps
        slope = (evaluate(hull, x + step, R)[12] - evaluate(hull, x - step, R)[12]) / (2.0 * eps)
        assert found[k] == pytest.approx(-slope, abs=0.02)
        ahead, back = (R @ Rotation.from_rotvec(sign * step).as_matrix() for sign in (1.0, -1.0))
        slope = (evaluate(hull, x, ahead)[12] - evaluate(hull, x, back)[12]) / (2.0 * eps)
        assert found[3 + k] == pytest.approx(-slope, abs=0.2)
    assert np.abs(found[3:6]).max() > 1e4


def stiffness_by_differences(hull: int, x: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Of the vertical force and the world moments x and y, for height and turns about the world axes x and y."""
    eps = 1e-5

    def force(z: float, turn: np.ndarray) -> np.ndarray:
        out_of = Rotation.from_rotvec(turn).as_matrix() @ R
        found = evaluate(hull, x + np.array([0.0, 0.0, z]), out_of)
        return np.append(found[2], (out_of @ found[3:6])[:2])

    columns = []
    for k in range(3):
        z, turn = (eps, np.zeros(3)) if k == 0 else (0.0, np.eye(3)[k - 1] * eps)
        columns.append((force(-z, -turn) - force(z, turn)) / (2.0 * eps))
    return np.column_stack(columns)


def stiffness(hull: int, x: np.ndarray, R: np.ndarray) -> np.ndarray:
    zz, zx, zy, xx, yy, xy = evaluate(hull, x, R)[6:12]
    return np.array([[zz, zx, zy], [zx, xx, xy], [zy, xy, yy]])


@pytest.mark.parametrize(("height", "tilt"), POSES)
def test_stiffness_of_a_clipped_hull_is_exact_at_every_pose(height: float, tilt: tuple) -> None:
    x, R = pose(height, tilt)
    K = stiffness(PLAIN, x, R)
    np.testing.assert_allclose(K, stiffness_by_differences(PLAIN, x, R), atol=1e-6 * np.abs(K).max())


@pytest.mark.parametrize("yaw", [0.0, 0.9, -2.4])
@pytest.mark.parametrize("hull", [TANKED, LINEAR])
def test_stiffness_with_tanks_and_of_a_float_plane_is_exact_upright(hull: int, yaw: float) -> None:
    """The float plane of the linear one is 0.1 m over its centre of mass: there it has no force of its own."""
    x, R = pose(0.1, (0.0, 0.0, yaw))
    K = stiffness(hull, x, R)
    np.testing.assert_allclose(K, stiffness_by_differences(hull, x, R), atol=1e-6 * np.abs(K).max())
    tilted = pose(0.1, (0.05, 0.02, yaw))
    K = stiffness(hull, *tilted)
    np.testing.assert_allclose(K, stiffness_by_differences(hull, *tilted), atol=0.01 * np.abs(K).max())


def test_free_surfaces_take_from_the_stiffness() -> None:
    """Second moments times density and g, nothing of heave."""
    x, R = pose(0.2, (0.0, 0.0, 0.0))
    np.testing.assert_allclose(
        stiffness(PLAIN, x, R) - stiffness(TANKED, x, R), np.diag([0.0, G * 1.1e4, G * 2.3e4]), atol=1e-3
    )


def test_force_of_a_float_plane_in_numbers() -> None:
    """Sum over the plane of rho g times depth, by the moments of the plane about its reference point."""
    x, R = pose(0.25, (0.0, 0.0, 0.0))
    A, Sx, Sy, Ixx, Iyy, Ixy = WATERPLANE
    up = 0.25 - (CENTRE[2] - 0.5)  # of the float plane over the water
    found = evaluate(LINEAR, x, R)
    assert found[2] == pytest.approx(RHO * G * (90.0 - A * up), rel=1e-12)
    arm_b, arm_p = np.array([0.3, 0.1]) - CENTRE[:2], np.array([0.2, -0.3]) - CENTRE[:2]
    lift = RHO * G * 90.0
    plane = -RHO * G * up * np.array([A * arm_p[0] + Sx, A * arm_p[1] + Sy])
    moment = np.array([lift * arm_b[1] + plane[1], -lift * arm_b[0] - plane[0], 0.0])
    np.testing.assert_allclose(R @ found[3:6], moment, atol=1e-6 * np.abs(moment).max())
    K = stiffness(LINEAR, *pose(CENTRE[2] - 0.5, (0.0, 0.0, 0.0)))
    px, py = arm_p
    about_centre = RHO * G * np.array([A, A * py + Sy, -(A * px + Sx)])
    np.testing.assert_allclose(K[0], about_centre, rtol=1e-12)
    sagging = lift * (-0.9 - CENTRE[2])
    xx = RHO * G * (Iyy + 2.0 * py * Sy + A * py * py) + sagging - G * 1.1e4
    yy = RHO * G * (Ixx + 2.0 * px * Sx + A * px * px) + sagging - G * 2.3e4
    xy = -RHO * G * (Ixy + px * Sy + py * Sx + A * px * py)
    np.testing.assert_allclose(K[1:, 1:], [[xx, xy], [xy, yy]], rtol=1e-10)


def test_transform_to_hydrodynamic_velocities() -> None:
    """Velocity of the reference point and spin, in axes that are turned by the heading alone."""
    rng = np.random.default_rng(5)
    r = axes() @ (REFERENCE_POINT - CENTRE)
    np.testing.assert_allclose(kind().hulls[PLAIN].reference, r, atol=1e-12)
    for heading in (0.0, 0.8, -2.9, 11.0):
        R = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
        U = rng.normal(size=6)
        transform_at(kind(), PLAIN, heading, R.ravel(), 0.0)
        T = kind().stage[PLAIN].transform
        back = Rotation.from_rotvec([0.0, 0.0, -heading]).as_matrix()
        point = back @ (U[:3] + R @ np.cross(U[3:], r))
        np.testing.assert_allclose(T @ U, np.append(point, back @ R @ U[3:]), atol=1e-12)


def test_heading_is_the_nearest_turn() -> None:
    for yaw in (0.0, 3.1, 3.2, -3.2, 6.4, 12.5, -9.0, 40.0):
        turn = Rotation.from_rotvec([0.0, 0.0, yaw]) * Rotation.from_rotvec([0.1, 0.0, 0.0])
        R = np.ascontiguousarray(turn.as_matrix() @ axes().T).ravel()
        for off in (-3.0, 0.0, 2.9):
            assert transform_at(kind(), PLAIN, 0.0, R, yaw + off) == pytest.approx(yaw, abs=1e-12)


@pytest.mark.parametrize("time", [0.05, 3.0, 400.0])
def test_filter_is_the_critically_damped_oscillator(time: float) -> None:
    value, rate, target, c = 2.0, -0.4, 5.0, 0.05
    exact = solve_ivp(
        lambda _, y: [y[1], c * c * (target - y[0]) - 2.0 * c * y[1]],
        (0.0, time), [value, rate], "DOP853", rtol=1e-12, atol=1e-13,
    ).y[:, -1]  # fmt: skip
    np.testing.assert_allclose(filter_after(value, rate, target, c, time), exact, atol=1e-10)


def test_steps_of_the_filter_compose() -> None:
    """Of a target that stays, many steps are one."""
    y, v = 1.0, 0.3
    for h in (0.1, 2.0, 0.03, 7.0):
        y, v = filter_after(y, v, -4.0, 0.2, h)
    np.testing.assert_allclose((y, v), filter_after(1.0, 0.3, -4.0, 0.2, 9.13), atol=1e-13)


@pytest.mark.parametrize(
    ("moments", "volume"),
    [([1.0, 0.0, 0.0, -1.0, 1.0, 0.0], 1.0), ([1.0, 5.0, 0.0, 1.0, 1.0, 0.0], 1.0), (WATERPLANE, 0.0)],
)
def test_moments_that_no_water_plane_has(moments: list[float], volume: float) -> None:
    """A negative second moment, first moments beyond what the second ones allow, no volume."""
    linear = LinearRestoring(
        volume=volume,
        centre_of_buoyancy=np.zeros(3),
        reference=np.zeros(3),
        area=moments[0],
        first_moments=tuple(moments[1:3]),
        second_moments=tuple(moments[3:]),
    )
    body = RigidBody("raft", 1.0, np.eye(3))
    sea = Sea(water=Water(gravity=G), hulls=(Hull(body="raft", restoring=linear),))
    with pytest.raises(InputError, match="water plane"):
        pack_scene(Scene((body,), (Gravity(np.array([0.0, 0.0, -G])),), sea=sea))
