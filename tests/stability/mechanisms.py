"""Mechanisms that stability is tested on, and what they should do, from formulations of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from heavylift.numerics.rotation import quaternion_product, rotation_matrix
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame, RopePoint, axes_about
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene, Sensor

STANDARD_GRAVITY = 9.81
DOWN = Gravity(np.array([0.0, -STANDARD_GRAVITY, 0.0]))
Z = np.array([0.0, 0.0, 1.0])


def rod(name: str, start, end, mass: float = 1.0, width: float = 0.02, **initial) -> RigidBody:
    """A square rod between two points, its frame at the centre and along the world axes."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(end - start))
    along = np.outer(end - start, end - start) / length**2
    across = mass * (length**2 + width**2) / 12.0
    inertia = across * (np.eye(3) - along) + mass * width**2 / 6.0 * along
    return RigidBody(name, mass, inertia, position=0.5 * (start + end), **initial)


def hinge(name: str, a: RigidBody | None, b: RigidBody | None, at, axis=Z) -> Hinge:
    """A hinge at a world point of bodies that lie along the world axes."""
    frames = []
    for body in (a, b):
        origin = np.zeros(3) if body is None else body.position
        frames.append(
            JointFrame(np.asarray(at, dtype=float) - origin, axes_about(np.asarray(axis, dtype=float)))
        )
    return Hinge(
        name=name,
        body_a=a.name if a else GROUND,
        body_b=b.name if b else GROUND,
        frame_a=frames[0],
        frame_b=frames[1],
    )


def chain(masses) -> Scene:
    """Rods of 1 m in a row, hinged, released from the horizontal."""
    rods = [rod(f"link {i}", (i, 0, 0), (i + 1, 0, 0), mass) for i, mass in enumerate(masses)]
    joints = [hinge(f"hinge {i}", rods[i - 1] if i else None, rods[i], (i, 0, 0)) for i in range(len(rods))]
    tip = Sensor("tip", rods[-1].name, np.array([0.5, 0.0, 0.0]))
    return Scene(tuple(rods), (DOWN,), (tip,), tuple(joints))


def chain_tip(masses, times, width: float = 0.02):
    """Tip of `chain` from the equations in absolute angles, DOP853; shape (times, 2)."""
    m = np.asarray(masses, dtype=float)
    n = len(m)
    inertia = m * (1.0 + width**2) / 12.0
    beyond = np.array([m[i + 1 :].sum() for i in range(n)])
    A = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            k = max(i, j)
            A[i, j] = beyond[k] + (0.25 * m[i] + inertia[i] if i == j else 0.5 * m[k])
    weight = STANDARD_GRAVITY * (beyond + 0.5 * m)

    def rate(_, y):
        angle, spin = y[:n], y[n:]
        difference = angle[:, None] - angle[None, :]
        right = -(A * np.sin(difference)) @ spin**2 - weight * np.cos(angle)
        return np.r_[spin, np.linalg.solve(A * np.cos(difference), right)]

    found = solve_ivp(rate, (0.0, times[-1]), np.zeros(2 * n), "DOP853", times, rtol=1e-12, atol=1e-12)
    angles = found.y[:n].T
    return np.column_stack([np.cos(angles).sum(axis=1), np.sin(angles).sum(axis=1)])


def four_bars(loops: int) -> Scene:
    """N square loops of rods of 1 m and 1 kg: IFToMM benchmark A02. Its cranks pass through singular positions."""
    cranks = [
        rod(f"crank {i}", (i, 0, 0), (i, 1, 0), velocity=np.array([0.5, 0.0, 0.0]), angular_velocity=-Z)
        for i in range(loops + 1)
    ]
    couplers = [
        rod(f"coupler {i}", (i, 1, 0), (i + 1, 1, 0), velocity=np.array([1.0, 0.0, 0.0]))
        for i in range(loops)
    ]
    joints = [hinge(f"foot {i}", None, crank, (i, 0, 0)) for i, crank in enumerate(cranks)]
    for i, coupler in enumerate(couplers):
        joints.append(hinge(f"left {i}", cranks[i], coupler, (i, 1, 0)))
        joints.append(hinge(f"right {i}", cranks[i + 1], coupler, (i + 1, 1, 0)))
    tip = Sensor("tip", "crank 0", np.array([0.0, 0.5, 0.0]))
    return Scene((*cranks, *couplers), (DOWN,), (tip,), tuple(joints))


def four_bar_tip(loops: int, times, width: float = 0.02):
    """Tip of the first crank from the equation of one angle; shape (times, 2)."""
    inertia = (loops + 1) * (1.0 / 3.0 + width**2 / 12.0) + loops
    moment = STANDARD_GRAVITY * ((loops + 1) / 2.0 + loops)
    found = solve_ivp(
        lambda _, y: [y[1], moment / inertia * np.sin(y[0])],
        (0.0, times[-1]),
        [0.0, 1.0],
        "DOP853",
        times,
        rtol=1e-12,
        atol=1e-12,
    )
    return np.column_stack([np.sin(found.y[0]), np.cos(found.y[0])])


BRICARD_POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1.0]])
BRICARD_AXES = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0.0]])


def bricard() -> Scene:
    """Six hinges that leave one freedom although a count of rows says none: IFToMM benchmark A04."""
    P = BRICARD_POINTS
    rods = [rod(f"rod {i}", P[i], P[i + 1], width=0.1) for i in range(5)]
    joints = [
        hinge(f"hinge {i}", rods[i - 1] if i else None, rods[i] if i < 5 else None, P[i], BRICARD_AXES[i])
        for i in range(6)
    ]
    return Scene(tuple(rods), (DOWN,), (Sensor("tip", "rod 2", 0.5 * (P[3] - P[2])),), tuple(joints))


def hanging_load(mass: float, length: float, stiffness: float, angle: float) -> tuple[Scene, np.ndarray]:
    """A load on a rope from the origin, at rest aside, with the stretch that its weight along the rope needs."""
    stretch = mass * STANDARD_GRAVITY * np.cos(angle) * length / stiffness
    start = (length + stretch) * np.array([np.sin(angle), -np.cos(angle), 0.0])
    load = RigidBody("load", mass, np.eye(3) * 0.1 * mass, position=start)
    path = (RopePoint(GROUND, np.zeros(3)), RopePoint("load", np.zeros(3)))
    rope = Rope(name="rope", path=path, axial_stiffness=stiffness, length=length)
    tip = Sensor("tip", "load", np.zeros(3))
    return Scene((load,), (DOWN,), (tip,), (), (rope,)), start


def hanging_load_path(mass: float, length: float, stiffness: float, start, times):
    """Path of `hanging_load` by an implicit Runge-Kutta method in polar coordinates; shape (times, 2)."""

    def rate(_, y):
        r, angle, speed, spin = y
        tension = max(0.0, stiffness * (r - length) / length)
        outward = r * spin**2 + STANDARD_GRAVITY * np.cos(angle) - tension / mass
        return [speed, spin, outward, (-STANDARD_GRAVITY * np.sin(angle) - 2.0 * speed * spin) / r]

    def derivatives(_, y):
        # differences of the tension of a stiff rope are rounding alone, and the method takes tiny steps
        r, angle, speed, spin = y
        slope = stiffness / length / mass if r > length else 0.0
        down, aside = STANDARD_GRAVITY * np.cos(angle), STANDARD_GRAVITY * np.sin(angle)
        return [
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [spin**2 - slope, -aside, 0.0, 2.0 * r * spin],
            [(aside + 2.0 * speed * spin) / r**2, -down / r, -2.0 * spin / r, -2.0 * speed / r],
        ]

    begin = [float(np.hypot(start[0], start[1])), float(np.arctan2(start[0], -start[1])), 0.0, 0.0]
    tolerance = [1e-10, 1e-10, 1e-8, 1e-10]
    found = solve_ivp(
        rate, (0.0, times[-1]), begin, "Radau", times, rtol=1e-9, atol=tolerance, jac=derivatives
    )
    r, angle = found.y[0], found.y[1]
    return np.column_stack([r * np.sin(angle), -r * np.cos(angle)])


def dropped_load(mass: float, stiffness: float, drop: float) -> Scene:
    """A load that falls by `drop` before its rope of 10 m and the stiffness [N/m] is taut."""
    length = 10.0
    load = RigidBody("load", mass, np.eye(3) * mass)
    anchor = RopePoint(GROUND, np.array([0.0, length - drop, 0.0]))
    path = (anchor, RopePoint("load", np.zeros(3)))
    rope = Rope(name="rope", path=path, axial_stiffness=stiffness * length, length=length)
    return Scene((load,), (DOWN,), (), (), (rope,))


def moved(scene: Scene, shift, quaternion) -> Scene:
    """The same scene elsewhere: bodies, ground sides of joints and gravity shifted [m] and turned."""
    R, q = rotation_matrix(quaternion), tuple(quaternion)
    bodies = tuple(
        replace(
            body,
            position=R @ body.position + shift,
            orientation=np.array(quaternion_product(q, tuple(body.orientation))),
            velocity=R @ body.velocity,
        )
        for body in scene.bodies
    )
    forces = tuple(
        replace(force, acceleration=R @ force.acceleration) if isinstance(force, Gravity) else force
        for force in scene.forces
    )

    def side(body: str, frame: JointFrame) -> JointFrame:
        return JointFrame(R @ frame.point + shift, R @ frame.axes) if body == GROUND else frame

    joints: list[Joint] = [
        replace(joint, frame_a=side(joint.body_a, joint.frame_a), frame_b=side(joint.body_b, joint.frame_b))
        for joint in scene.joints
    ]
    return replace(scene, bodies=bodies, forces=forces, joints=tuple(joints))
