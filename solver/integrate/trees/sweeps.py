"""The articulated-body recursion in world axes: R. Featherstone, "Rigid Body Dynamics Algorithms", chapter 7.

Every wrench of a body is taken about its joint point, so an inertia goes to the parent by a shift alone: no 6 x 6
matrix is turned. With angular acceleration ``alpha`` and acceleration ``a`` of the joint point a body and all that
hangs on it need the moment and the force::

    n = A alpha + B a + p_n,    f = B^T alpha + M a + p_f

The joint passes what does not move its coordinates; those are eliminated, and the rest is what the parent carries.
Gravity is an acceleration of the ground.
"""

from __future__ import annotations

import math
from typing import Any

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import quaternion_product
from heavylift.numerics.vectors import (
    Three,
    Vector,
    add,
    add_scaled,
    cross,
    dot,
    rotate,
    rotate_back,
    scaled,
    subtract,
    vector,
    vector_at,
)
from heavylift.solver.integrate.trees.forest import (
    BALL,
    DISTANCE,
    FIXED,
    FLOATING,
    HINGE,
    SLIDER,
    Forest,
    TreeBody,
)

__all__ = [
    "ZERO",
    "accelerate",
    "direction_of",
    "gather_inward",
    "joint_wrench",
    "own_quaternion",
    "pose_outward",
    "put",
    "see_bodies",
]

Six = tuple[float, float, float, float, float, float]
Nine = tuple[float, float, float, float, float, float, float, float, float]

UNIT = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
ZERO = (0.0, 0.0, 0.0)
NOTHING = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel(inline=True, internal=True)
def six(a: Any) -> Six:
    """The six numbers of a symmetric matrix."""
    return a[0], a[1], a[2], a[3], a[4], a[5]


@kernel(inline=True, internal=True)
def nine(a: Any) -> Nine:
    """The nine numbers of a matrix."""
    return a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8]


@kernel(inline=True, internal=True)
def put(to: Any, a: Any) -> None:
    """Three numbers into a field."""
    to[0], to[1], to[2] = a[0], a[1], a[2]


@kernel(inline=True, internal=True)
def times(S: Any, v: Three) -> Vector:
    """Symmetric matrix by a vector."""
    return (
        S[0] * v[0] + S[1] * v[1] + S[2] * v[2],
        S[1] * v[0] + S[3] * v[1] + S[4] * v[2],
        S[2] * v[0] + S[4] * v[1] + S[5] * v[2],
    )


@kernel(inline=True, internal=True)
def inverse_of(S: Six) -> Six:
    """Inverse of a symmetric matrix."""
    a, b, c = S[3] * S[5] - S[4] * S[4], S[2] * S[4] - S[1] * S[5], S[1] * S[4] - S[2] * S[3]
    d = 1.0 / (S[0] * a + S[1] * b + S[2] * c)
    return (
        a * d,
        b * d,
        c * d,
        (S[0] * S[5] - S[2] * S[2]) * d,
        (S[1] * S[2] - S[0] * S[4]) * d,
        (S[0] * S[3] - S[1] * S[1]) * d,
    )


@kernel(inline=True, internal=True)
def own_quaternion(values: Floats1, place: int) -> tuple[float, float, float, float]:
    """Quaternion in a state vector, at unit length."""
    q0, q1, q2, q3 = values[place], values[place + 1], values[place + 2], values[place + 3]
    s = 1.0 / math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
    return s * q0, s * q1, s * q2, s * q3


@kernel(inline=True, internal=True)
def direction_of(values: Floats1, place: int, speed: int) -> tuple[Vector, Vector]:
    """Direction in a state vector at unit length, and its rate, which is across it."""
    e, rate = vector_at(values, place), vector_at(values, speed)
    e = scaled(1.0 / math.sqrt(dot(e, e)), e)
    return e, add_scaled(rate, -dot(e, rate), e)


@kernel(inline=True, internal=True)
def rotation_of(q: tuple[float, float, float, float]) -> Nine:
    """Rotation matrix of a unit quaternion, row by row."""
    q0, q1, q2, q3 = q
    return (
        1.0 - 2.0 * (q2 * q2 + q3 * q3),
        2.0 * (q1 * q2 - q0 * q3),
        2.0 * (q1 * q3 + q0 * q2),
        2.0 * (q1 * q2 + q0 * q3),
        1.0 - 2.0 * (q1 * q1 + q3 * q3),
        2.0 * (q2 * q3 - q0 * q1),
        2.0 * (q1 * q3 - q0 * q2),
        2.0 * (q2 * q3 + q0 * q1),
        1.0 - 2.0 * (q1 * q1 + q2 * q2),
    )


@kernel(inline=True, internal=True)
def pose_outward(forest: Forest, values: Floats1, at: int) -> None:
    """Rotations, arms and spins; each body's own inertia and bias about its joint point."""
    places = at + forest.velocities
    for i in range(forest.bodies.shape[0]):  # all together: calls of functions wait for no other body here
        one = forest.bodies[i]
        if one.joint == HINGE:
            half = 0.5 * values[places + one.place]
            one.cosine, one.sine = math.cos(half), math.sin(half)
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        joint, place, speed = one.joint, places + one.place, at + one.speed
        P, w, base = UNIT, ZERO, (1.0, 0.0, 0.0, 0.0)
        if one.parent >= 0:
            above = forest.bodies[one.parent]
            P, w, base = nine(above.R), vector(above.spin), (above.q[0], above.q[1], above.q[2], above.q[3])
        r = vector(one.offset)
        if joint == SLIDER:
            r = add_scaled(r, values[place], one.axis)
        r = rotate(P, r)
        shifting = cross(w, cross(w, r))
        turning = ZERO
        if joint <= FIXED:
            q = base
            if one.turned:
                q = quaternion_product(q, (one.turn[0], one.turn[1], one.turn[2], one.turn[3]))
            if joint == HINGE:
                sine = one.sine
                turn = (one.cosine, sine * one.axis[0], sine * one.axis[1], sine * one.axis[2])
                q = quaternion_product(q, turn)
        elif joint == BALL:
            q = own_quaternion(values, place)
        else:
            q = own_quaternion(values, place + 3)
        R = rotation_of(q)
        if joint == HINGE:
            along, rate = rotate(R, one.axis), values[speed]
            turning = scaled(rate, cross(w, along))
            w = add_scaled(w, rate, along)
            put(one.along, along)
        elif joint == SLIDER:
            along = rotate(P, one.axis)
            shifting = add_scaled(shifting, 2.0 * values[speed], cross(w, along))
            put(one.along, along)
        elif joint == BALL:
            w = rotate(R, vector_at(values, speed))
        elif joint >= FLOATING:
            w = rotate(R, vector_at(values, speed + 3))
        if joint == DISTANCE:
            along, rates = direction_of(values, place, speed)
            put(one.along, along)
            put(one.moving, rates)
        for k in range(9):
            one.R[k] = R[k]
        one.q[0], one.q[1], one.q[2], one.q[3] = q
        put(one.arm, r)
        put(one.spin, w)
        put(one.turning, turning)
        put(one.shifting, shifting)
        if one.alone:
            I, spin = one.inertia, vector_at(values, speed if joint == BALL else speed + 3)
            gyroscopic = cross(spin, (I[0] * spin[0], I[1] * spin[1], I[2] * spin[2]))
            put(one.moment, rotate(R, gyroscopic))
            put(one.force, ZERO)
            continue
        m, c = one.mass, rotate(R, one.centre)
        put(one.to_centre, c)
        jx, jy, jz = one.inertia[0], one.inertia[1], one.inertia[2]
        cc = dot(c, c)
        A = (
            jx * R[0] * R[0] + jy * R[1] * R[1] + jz * R[2] * R[2] + m * (cc - c[0] * c[0]),
            jx * R[0] * R[3] + jy * R[1] * R[4] + jz * R[2] * R[5] - m * c[0] * c[1],
            jx * R[0] * R[6] + jy * R[1] * R[7] + jz * R[2] * R[8] - m * c[0] * c[2],
            jx * R[3] * R[3] + jy * R[4] * R[4] + jz * R[5] * R[5] + m * (cc - c[1] * c[1]),
            jx * R[3] * R[6] + jy * R[4] * R[7] + jz * R[5] * R[8] - m * c[1] * c[2],
            jx * R[6] * R[6] + jy * R[7] * R[7] + jz * R[8] * R[8] + m * (cc - c[2] * c[2]),
        )
        h = scaled(m, c)
        B = (0.0, -h[2], h[1], h[2], 0.0, -h[0], -h[1], h[0], 0.0)  # B x = h x x
        M = (m, 0.0, 0.0, m, 0.0, m)
        for k in range(6):
            one.A[k] = A[k]
            one.M[k] = M[k]
        for k in range(9):
            one.B[k] = B[k]
        put(one.moment, cross(w, times(A, w)))
        put(one.force, cross(w, cross(w, h)))


@kernel(internal=True)
def see_bodies(forest: Forest, values: Floats1, at: int) -> None:
    """Poses and velocities of all bodies as their kind reads them."""
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        place, speed = at + forest.velocities + one.place, at + one.speed
        x, v, w = ZERO, ZERO, ZERO
        if one.parent >= 0:
            above = forest.bodies[one.parent]
            x, v, w = vector(above.position), vector(above.velocity), vector(above.spin)
        x = add(x, one.arm)
        v = add(v, cross(w, one.arm))
        if one.joint == SLIDER:
            v = add_scaled(v, values[speed], one.along)
        elif one.joint == DISTANCE:
            x = add_scaled(x, one.length, one.along)
            v = add_scaled(v, one.length, one.moving)
        elif one.joint == FLOATING:  # its joint point is where the parent would be
            c = vector(one.to_centre)
            x = subtract(vector_at(values, place), c)
            v = subtract(vector_at(values, speed), cross(one.spin, c))
        put(one.position, x)
        put(one.velocity, v)
        x = add(x, one.to_centre)
        v = add(v, cross(one.spin, one.to_centre))
        w = rotate_back(one.R, one.spin)
        poses, pose, dof = forest.poses, one.pose, one.dof
        for k in range(3):
            poses[pose + k], poses[dof + k], poses[dof + 3 + k] = x[k], v[k], w[k]
        for k in range(4):
            poses[pose + 3 + k] = one.q[k]


@kernel(inline=True, internal=True)
def gather_inward(forest: Forest) -> None:
    """Articulated inertias and biases, leaves first; each joint is eliminated, and the rest goes to the parent."""
    for i in range(forest.bodies.shape[0] - 1, -1, -1):
        one = forest.bodies[i]
        joint = one.joint
        A, B, M = six(one.A), nine(one.B), six(one.M)
        n, f = vector(one.moment), vector(one.force)
        if one.alone:
            m = one.mass
            put(one.hinge_force, f)
            if joint == FLOATING:
                continue
            M = (m, 0.0, 0.0, m, 0.0, m)
            if joint == DISTANCE:
                s, moving = vector(one.along), vector(one.moving)
                one.compliance = m
                one.drive = dot(s, f) / m - one.length * dot(moving, moving)
                M, f = _along(m, s), scaled(m * one.drive, s)
            if one.parent < 0:
                continue
            f = add(f, times(M, one.shifting))
            A, B, n = NOTHING, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), ZERO
        elif joint <= SLIDER:
            s = vector(one.along)
            if joint == HINGE:
                ua, ul = times(A, s), rotate_back(B, s)
                d = 1.0 / dot(s, ua)
                u = -dot(s, n)
            else:
                ua, ul = rotate(B, s), times(M, s)
                d = 1.0 / dot(s, ul)
                u = -dot(s, f)
            put(one.hinge_moment, ua)
            put(one.hinge_force, ul)
            one.compliance, one.drive = d, u
            if one.parent < 0:
                continue
            da, dl = scaled(d, ua), scaled(d, ul)
            A = (
                A[0] - da[0] * ua[0],
                A[1] - da[0] * ua[1],
                A[2] - da[0] * ua[2],
                A[3] - da[1] * ua[1],
                A[4] - da[1] * ua[2],
                A[5] - da[2] * ua[2],
            )
            B = (
                B[0] - da[0] * ul[0],
                B[1] - da[0] * ul[1],
                B[2] - da[0] * ul[2],
                B[3] - da[1] * ul[0],
                B[4] - da[1] * ul[1],
                B[5] - da[1] * ul[2],
                B[6] - da[2] * ul[0],
                B[7] - da[2] * ul[1],
                B[8] - da[2] * ul[2],
            )
            M = (
                M[0] - dl[0] * ul[0],
                M[1] - dl[0] * ul[1],
                M[2] - dl[0] * ul[2],
                M[3] - dl[1] * ul[1],
                M[4] - dl[1] * ul[2],
                M[5] - dl[2] * ul[2],
            )
            b, g = vector(one.turning), vector(one.shifting)
            f = add(add(add_scaled(f, u, dl), rotate_back(B, b)), times(M, g))
            n = add(add(add_scaled(n, u, da), times(A, b)), rotate(B, g))
        elif joint == FIXED:
            if one.parent < 0:
                continue
            g = vector(one.shifting)
            f, n = add(f, times(M, g)), add(n, rotate(B, g))
        else:
            # the joint passes no moment: alpha = -A^-1 (B a + n)
            inverse = inverse_of(A)
            c0 = times(inverse, (B[0], B[3], B[6]))
            c1 = times(inverse, (B[1], B[4], B[7]))
            c2 = times(inverse, (B[2], B[5], B[8]))
            for k in range(6):
                one.inverse[k] = inverse[k]
            M = (
                M[0] - (B[0] * c0[0] + B[3] * c0[1] + B[6] * c0[2]),
                M[1] - (B[0] * c1[0] + B[3] * c1[1] + B[6] * c1[2]),
                M[2] - (B[0] * c2[0] + B[3] * c2[1] + B[6] * c2[2]),
                M[3] - (B[1] * c1[0] + B[4] * c1[1] + B[7] * c1[2]),
                M[4] - (B[1] * c2[0] + B[4] * c2[1] + B[7] * c2[2]),
                M[5] - (B[2] * c2[0] + B[5] * c2[1] + B[8] * c2[2]),
            )
            f = subtract(f, (dot(c0, n), dot(c1, n), dot(c2, n)))
            if joint >= FLOATING:
                inverse = inverse_of(M)
                for k in range(6):
                    one.inverse_mass[k] = inverse[k]
                put(one.hinge_force, f)
            if joint == DISTANCE:
                # f = l e with e . a = e . a_0 - L |e'|^2
                s, moving = vector(one.along), vector(one.moving)
                push = times(inverse, s)
                d = 1.0 / dot(s, push)
                u = dot(push, f) - one.length * dot(moving, moving)
                one.compliance, one.drive = d, u
                M, f = _along(d, s), scaled(d * u, s)
            if one.parent < 0:
                continue
            f = add(f, times(M, one.shifting))
            A, B, n = NOTHING, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), ZERO
        _hand_over(forest.bodies[one.parent], vector(one.arm), A, B, M, n, f)


@kernel(inline=True, internal=True)
def _along(m: float, s: Vector) -> Six:
    """``m s s^T``."""
    t = scaled(m, s)
    return t[0] * s[0], t[0] * s[1], t[0] * s[2], t[1] * s[1], t[1] * s[2], t[2] * s[2]


@kernel(inline=True, internal=True)
def _hand_over(to: TreeBody, r: Vector, A: Six, B: Nine, M: Six, n: Vector, f: Vector) -> None:
    """Inertia and bias about a point that is `r` away: ``B' = B + r x M``, ``A' = A + r x B^T - B' r x``."""
    x, y, z = r
    E = (
        B[0] + y * M[2] - z * M[1],
        B[1] + y * M[4] - z * M[3],
        B[2] + y * M[5] - z * M[4],
        B[3] + z * M[0] - x * M[2],
        B[4] + z * M[1] - x * M[4],
        B[5] + z * M[2] - x * M[5],
        B[6] + x * M[1] - y * M[0],
        B[7] + x * M[3] - y * M[1],
        B[8] + x * M[4] - y * M[2],
    )
    to.A[0] += A[0] + (y * B[2] - z * B[1]) - (E[1] * z - E[2] * y)
    to.A[1] += A[1] + (y * B[5] - z * B[4]) - (E[2] * x - E[0] * z)
    to.A[2] += A[2] + (y * B[8] - z * B[7]) - (E[0] * y - E[1] * x)
    to.A[3] += A[3] + (z * B[3] - x * B[5]) - (E[5] * x - E[3] * z)
    to.A[4] += A[4] + (z * B[6] - x * B[8]) - (E[3] * y - E[4] * x)
    to.A[5] += A[5] + (x * B[7] - y * B[6]) - (E[6] * y - E[7] * x)
    for k in range(9):
        to.B[k] += E[k]
    for k in range(6):
        to.M[k] += M[k]
    n = add(n, cross(r, f))
    for k in range(3):
        to.moment[k] += n[k]
        to.force[k] += f[k]


@kernel(inline=True, internal=True)
def _moved(one: TreeBody, force: Vector) -> Vector:
    """Acceleration of the joint point of a body that turns freely about it."""
    if one.alone:
        return scaled(1.0 / one.mass, force)
    return times(one.inverse_mass, force)


@kernel(inline=True, internal=True)
def accelerate(forest: Forest, gravity: Vector, values: Floats1, out: int) -> None:
    """Accelerations of the coordinates into a state vector, root first; those of bodies are without gravity."""
    ground = scaled(-1.0, gravity)
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        joint, speed = one.joint, out + one.speed
        alpha, a = ZERO, ground
        if one.parent >= 0:
            above = forest.bodies[one.parent]
            alpha, a = vector(above.alpha), vector(above.a)
        a = add(add(a, cross(alpha, one.arm)), one.shifting)
        if joint == FLOATING:
            a = scaled(-1.0, _moved(one, vector(one.hinge_force)))
        elif joint == DISTANCE:
            before = a
            pull = one.compliance * (one.drive + dot(one.along, a))
            a = _moved(one, add_scaled(scaled(-1.0, one.hinge_force), pull, one.along))
            bend = scaled(1.0 / one.length, subtract(a, before))
            for k in range(3):
                values[speed + k] = bend[k]
        if joint >= BALL:
            if one.alone:
                n, I = rotate_back(one.R, one.moment), one.inertia
                spin_rate = (-n[0] / I[0], -n[1] / I[1], -n[2] / I[2])
            else:
                alpha = scaled(-1.0, times(one.inverse, add(rotate(one.B, a), one.moment)))
                spin_rate = rotate_back(one.R, alpha)
            if joint == FLOATING:
                w, c = vector(one.spin), vector(one.to_centre)
                centre = add(add(add(a, cross(alpha, c)), cross(w, cross(w, c))), gravity)
                for k in range(3):
                    values[speed + k] = centre[k]
            if joint != BALL:
                speed += 3
            for k in range(3):
                values[speed + k] = spin_rate[k]
        else:
            alpha = add(alpha, one.turning)
            if joint != FIXED:
                acceleration = one.compliance * (
                    one.drive - dot(one.hinge_moment, alpha) - dot(one.hinge_force, a)
                )
                values[speed] = acceleration
                if joint == HINGE:
                    alpha = add_scaled(alpha, acceleration, one.along)
                else:
                    a = add_scaled(a, acceleration, one.along)
        put(one.alpha, alpha)
        put(one.a, a)


@kernel(inline=True, internal=True)
def joint_wrench(one: TreeBody) -> tuple[Vector, Vector]:
    """Moment about the joint point and force that the joint exerts on its body, world axes, as last accelerated."""
    if one.alone:
        return ZERO, add_scaled(one.force, one.mass, one.a)
    moment = add(add(times(one.A, one.alpha), rotate(one.B, one.a)), one.moment)
    force = add(add(rotate_back(one.B, one.alpha), times(one.M, one.a)), one.force)
    return moment, force
