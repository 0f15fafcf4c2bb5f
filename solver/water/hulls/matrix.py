"""Matrix and right-hand side of the step of hulls: masses, stiffness of buoyancy and lines, momenta and forces.

Buoyancy is that of a clipped surface or of a float plane: force, moment, stiffness and potential. Both derive from a
potential: ``-rho g`` times the height moment of the submerged volume, or of a float plane
``rho g / 2 int z^2 dA`` with the height z of its points, plus that of the constant volume. Free surfaces of tanks take
from the stiffness of tilt as a negative float plane does.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import (
    Vector,
    add_scaled,
    cross,
    rotate,
    rotate_back,
    scaled,
    vector,
    vector_at,
)
from heavylift.solver.bodies.rigid.step import axial_momentum_at_middle
from heavylift.solver.interface import Workspace
from heavylift.solver.water.hulls.clipping import clip_surface
from heavylift.solver.water.hulls.kind import CLIPPED, LINEAR, Hulls

__all__ = [
    "assemble",
    "assemble_mass",
    "moved_on",
    "restore",
    "restoring_potential",
]


Six = tuple[float, float, float, float, float, float]
"""Displacement [m] and small rotation [rad] of a hull, or other six numbers."""


# ---- buoyancy ----


@kernel(internal=True)
def restore(kind: Hulls, hull: int) -> None:
    """Buoyancy at the stage of a hull, in its own coordinates, and its stiffness.

    Writes `lift`: world force and moment about the centre of mass in principal axes; `stiffness`: against height and
    the world rotations x and y: zz, zx, zy, xx, yy, xy.
    """
    stage, data = kind.stage[hull], kind.hulls[hull]
    R = kind.frame[hull].mid_rotation
    height = kind.frame[hull].mid_position[2] - kind.water.level
    weight = kind.water.weight
    sort = data.restoring
    force = moment_x = moment_y = zz = zx = zy = xx = yy = xy = 0.0
    if sort == CLIPPED:
        clip = stage.clip
        points = kind.points[data.first_point : data.last_point]
        triangles = kind.triangles[data.first_triangle : data.last_triangle]
        placed = kind.placed[data.first_point : data.last_point]
        clip_surface(points, triangles, R, height, placed, clip)
        force = weight * clip.volume
        moment_x, moment_y = weight * clip.moment[1], -weight * clip.moment[0]
        lever = clip.moment[2] - height * clip.volume
        zz, zx, zy = weight * clip.plane_area, weight * clip.plane_y, -weight * clip.plane_x
        xx, yy = weight * (clip.plane_yy + lever), weight * (clip.plane_xx + lever)
        xy = -weight * clip.plane_xy
    elif sort == LINEAR:
        d1x, d1y, a = rotate(R, data.axis_x)
        d2x, d2y, b = rotate(R, data.axis_y)
        px, py, pz = rotate(R, data.float_plane)
        bx, by, bz = rotate(R, data.buoyancy_centre)
        A, Sx, Sy = data.waterplane[0], data.waterplane[1], data.waterplane[2]
        Ixx, Iyy, Ixy = data.waterplane[3], data.waterplane[4], data.waterplane[5]
        z = height + pz
        f0 = -weight * (A * z + Sx * a + Sy * b)
        f1 = -weight * (Sx * z + Ixx * a + Ixy * b)
        f2 = -weight * (Sy * z + Ixy * a + Iyy * b)
        volume = weight * data.displaced_volume
        force = volume + f0
        moment_x = by * volume + py * f0 + d1y * f1 + d2y * f2
        moment_y = -bx * volume - px * f0 - d1x * f1 - d2x * f2
        # the heights change by dz + (theta x r)_z: gradients (1, y, -x)
        zz = weight * A
        zx = weight * (A * py + Sx * d1y + Sy * d2y)
        zy = -weight * (A * px + Sx * d1x + Sy * d2x)
        xx = weight * (
            A * py * py + Ixx * d1y * d1y + Iyy * d2y * d2y
            + 2.0 * (Sx * py * d1y + Sy * py * d2y + Ixy * d1y * d2y)
        ) + volume * bz  # fmt: skip
        yy = weight * (
            A * px * px + Ixx * d1x * d1x + Iyy * d2x * d2x
            + 2.0 * (Sx * px * d1x + Sy * px * d2x + Ixy * d1x * d2x)
        ) + volume * bz  # fmt: skip
        xy = -weight * (
            A * px * py + Ixx * d1x * d1y + Iyy * d2x * d2y
            + Sx * (px * d1y + d1x * py) + Sy * (px * d2y + d2x * py) + Ixy * (d1x * d2y + d2x * d1y)
        )  # fmt: skip
    if data.last_tank > data.first_tank:
        about_x, about_y = _free_surfaces(kind, hull)
        d1x, d1y, a = rotate(R, data.axis_x)
        d2x, d2y, b = rotate(R, data.axis_y)
        f1, f2 = kind.water.gravity * about_y * a, kind.water.gravity * about_x * b
        moment_x += d1y * f1 + d2y * f2
        moment_y -= d1x * f1 + d2x * f2
        g1, g2 = kind.water.gravity * about_y, kind.water.gravity * about_x
        xx -= g1 * d1y * d1y + g2 * d2y * d2y
        yy -= g1 * d1x * d1x + g2 * d2x * d2x
        xy += g1 * d1x * d1y + g2 * d2x * d2y
    m1, m2, m3 = rotate_back(R, (moment_x, moment_y, 0.0))
    stage.lift[0], stage.lift[1], stage.lift[2] = 0.0, 0.0, force
    stage.lift[3], stage.lift[4], stage.lift[5] = m1, m2, m3
    stage.stiffness[0], stage.stiffness[1], stage.stiffness[2] = zz, zx, zy
    stage.stiffness[3], stage.stiffness[4], stage.stiffness[5] = xx, yy, xy


@kernel(internal=True)
def _free_surfaces(kind: Hulls, hull: int) -> tuple[float, float]:
    """Sums over the tanks, about x and about y of the body [kg m2]."""
    about_x = about_y = 0.0
    for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
        about_x += kind.tanks[tank].free_surface[0]
        about_y += kind.tanks[tank].free_surface[1]
    return about_x, about_y


@kernel(internal=True)
def restoring_potential(kind: Hulls, hull: int) -> float:
    """Potential of the buoyancy at the stage [J], after `restore`."""
    R = kind.frame[hull].mid_rotation
    height = kind.frame[hull].mid_position[2] - kind.water.level
    weight, data = kind.water.weight, kind.hulls[hull]
    sort = kind.hulls[hull].restoring
    potential = 0.0
    _, _, a = rotate(R, data.axis_x)
    _, _, b = rotate(R, data.axis_y)
    if sort == CLIPPED:
        potential = -weight * kind.stage[hull].clip.moment[2]
    elif sort == LINEAR:
        _, _, pz = rotate(R, data.float_plane)
        _, _, bz = rotate(R, data.buoyancy_centre)
        A, Sx, Sy = data.waterplane[0], data.waterplane[1], data.waterplane[2]
        Ixx, Iyy, Ixy = data.waterplane[3], data.waterplane[4], data.waterplane[5]
        z = height + pz
        potential = 0.5 * weight * (
            A * z * z + Ixx * a * a + Iyy * b * b + 2.0 * (Sx * z * a + Sy * z * b + Ixy * a * b)
        ) - weight * data.displaced_volume * (height + bz)  # fmt: skip
    about_x, about_y = _free_surfaces(kind, hull)
    return potential - 0.5 * kind.water.gravity * (about_y * a * a + about_x * b * b)


# ---- the matrix ----


@kernel(internal=True)
def assemble_mass(kind: Hulls, group: int, base: int, at_end: bool, step: float) -> None:
    """Mass with that of the water, ``M + T^T (A_inf + h/2 (B + D)) T``, into the lower triangle of a matrix of a group.

    At the end of a step the mass alone, with the rotation that stands there (in `stage`, see `put_end`).
    """
    first, count = kind.groups[group].first, kind.groups[group].count
    n = 6 * count
    matrix = kind.matrices
    half = 0.0 if at_end else 0.5 * step
    for i in range(n * n):
        matrix[base + i] = 0.0
    for p in range(count):
        for q in range(p + 1):
            left, right = first + p, first + q
            T_left = kind.stage[left].end_transform if at_end else kind.stage[left].transform
            T_right = kind.stage[right].end_transform if at_end else kind.stage[right].transform
            for i in range(6):
                row = 6 * left + i
                h = _row_of_mass(kind, row, 6 * right, half)
                drag = 0.0
                if p == q:
                    drag = half * kind.hulls[left].quadratic_damping[i] * abs(kind.vectors.speed[row])
                for j in range(6):
                    # rows of H T, then T^T of them
                    total = drag * T_right[i, j]
                    total += h[0] * T_right[0, j] + h[1] * T_right[1, j] + h[2] * T_right[2, j]
                    total += h[3] * T_right[3, j] + h[4] * T_right[4, j] + h[5] * T_right[5, j]
                    for k in range(j if p == q else 0, 6):
                        matrix[base + (6 * p + k) * n + 6 * q + j] += T_left[i, k] * total
    for p in range(count):
        hull = first + p
        frame = kind.frame[hull]
        for k in range(3):
            matrix[base + (6 * p + k) * (n + 1)] += frame.mass
            matrix[base + (6 * p + 3 + k) * (n + 1)] += frame.principal_inertia[k]
        for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
            _add_tank_mass(kind, hull, tank, base + 6 * p * (n + 1), n, at_end)


@kernel(internal=True)
def _row_of_mass(kind: Hulls, row: int, first: int, half: float) -> Six:
    """Six numbers of a row of ``A_inf + h/2 (B + D)``."""
    A, B, D = kind.added_mass[row], kind.implicit[row], kind.damping[row]
    return (
        A[first] + half * (B[first] + D[first]),
        A[first + 1] + half * (B[first + 1] + D[first + 1]),
        A[first + 2] + half * (B[first + 2] + D[first + 2]),
        A[first + 3] + half * (B[first + 3] + D[first + 3]),
        A[first + 4] + half * (B[first + 4] + D[first + 4]),
        A[first + 5] + half * (B[first + 5] + D[first + 5]),
    )


@kernel(internal=True)
def _add_tank_mass(kind: Hulls, hull: int, tank: int, base: int, n: int, at_end: bool) -> None:
    """``m [1, -R r~]^T [1, -R r~]``, lower triangle."""
    m = kind.tanks[tank].mass
    r1, r2, r3 = vector(kind.tanks[tank].point)
    R = kind.stage[hull].rotation if at_end else kind.frame[hull].mid_rotation
    matrix = kind.matrices
    for k in range(3):
        matrix[base + k * (n + 1)] += m
        a, b, c = R[3 * k], R[3 * k + 1], R[3 * k + 2]
        matrix[base + 3 * n + k] += m * (c * r2 - b * r3)
        matrix[base + 4 * n + k] += m * (a * r3 - c * r1)
        matrix[base + 5 * n + k] += m * (b * r1 - a * r2)
    matrix[base + 3 * n + 3] += m * (r2 * r2 + r3 * r3)
    matrix[base + 4 * n + 4] += m * (r3 * r3 + r1 * r1)
    matrix[base + 5 * n + 5] += m * (r1 * r1 + r2 * r2)
    matrix[base + 4 * n + 3] -= m * r1 * r2
    matrix[base + 5 * n + 3] -= m * r1 * r3
    matrix[base + 5 * n + 4] -= m * r2 * r3


@kernel(internal=True)
def _add_stiffness(kind: Hulls, hull: int, base: int, n: int, step: float) -> None:
    """``h^2/4 K`` of the buoyancy, and ``h/2 K`` times the predicted displacement to the right-hand side."""
    stage = kind.stage[hull]
    R = kind.frame[hull].mid_rotation
    zz, zx, zy = stage.stiffness[0], stage.stiffness[1], stage.stiffness[2]
    xx, yy, xy = stage.stiffness[3], stage.stiffness[4], stage.stiffness[5]
    quarter = 0.25 * step * step
    d = stage.predicted[2]
    ahead = zz * d
    out = 6 * hull
    for i in range(3):
        spin = stage.predicted[3 + i]
        lift = zx * R[i] + zy * R[3 + i]
        ahead += lift * spin
        kind.vectors.load[out + 3 + i] += 0.5 * step * lift * d
        kind.matrices[base + (3 + i) * n + 2] += quarter * lift
        for j in range(3):
            tilt = xx * R[i] * R[j] + yy * R[3 + i] * R[3 + j] + xy * (R[i] * R[3 + j] + R[3 + i] * R[j])
            kind.vectors.load[out + 3 + i] += 0.5 * step * tilt * stage.predicted[3 + j]
            if j <= i:
                kind.matrices[base + (3 + i) * n + 3 + j] += quarter * tilt
    kind.matrices[base + 2 * n + 2] += quarter * zz
    kind.vectors.load[out + 2] += 0.5 * step * ahead


@kernel(internal=True)
def line_force(
    kind: Hulls,
    work: Workspace,
    end: int,
    step: float,
    d: Six,
) -> Vector:
    """``(K + 2/h D) J d`` of one end of a line and a displacement of its hull.

    Notes
    -----
    A displacement d of the middle of the step belongs to a velocity 2/h d, as both begin with those of the start.
    """
    at = kind.line_ends[end]
    hull, marker, line = at.hull, at.marker, at.line
    offset = kind.hulls[hull].offset
    J, K, D = work.jacobian[marker], kind.tangents[line], kind.rate_tangents[line]
    x = d[0] + J[0, offset + 3] * d[3] + J[0, offset + 4] * d[4] + J[0, offset + 5] * d[5]
    y = d[1] + J[1, offset + 3] * d[3] + J[1, offset + 4] * d[4] + J[1, offset + 5] * d[5]
    z = d[2] + J[2, offset + 3] * d[3] + J[2, offset + 4] * d[4] + J[2, offset + 5] * d[5]
    rate = 2.0 / step
    return (
        (K[0] + rate * D[0]) * x + (K[1] + rate * D[1]) * y + (K[2] + rate * D[2]) * z,
        (K[3] + rate * D[3]) * x + (K[4] + rate * D[4]) * y + (K[5] + rate * D[5]) * z,
        (K[6] + rate * D[6]) * x + (K[7] + rate * D[7]) * y + (K[8] + rate * D[8]) * z,
    )


@kernel(internal=True)
def _add_line(kind: Hulls, work: Workspace, end: int, base: int, n: int, step: float, again: bool) -> None:
    """``h^2/4 J^T K J`` of one end, and ``h/2 J^T K J`` times the predicted displacement.

    With velocities that were found before, also what the other end of the line, on another hull, has moved since.
    """
    hull, marker = kind.line_ends[end].hull, kind.line_ends[end].marker
    J, offset = work.jacobian[marker], kind.hulls[hull].offset
    quarter = 0.25 * step * step
    foreseen = kind.stage[hull].foreseen
    for column in range(7):
        if column < 6:
            d = (
                1.0 * (column == 0), 1.0 * (column == 1), 1.0 * (column == 2),
                1.0 * (column == 3), 1.0 * (column == 4), 1.0 * (column == 5),
            )  # fmt: skip
        else:
            d = (foreseen[0], foreseen[1], foreseen[2], foreseen[3], foreseen[4], foreseen[5])
        f = line_force(kind, work, end, step, d)
        for i in range(6):
            value = J[0, offset + i] * f[0] + J[1, offset + i] * f[1] + J[2, offset + i] * f[2]
            if column == 6:
                kind.vectors.load[6 * hull + i] += 0.5 * step * value
            elif column <= i:
                kind.matrices[base + i * n + column] += quarter * value
    other = kind.line_ends[end].other
    if again and other >= 0:
        x, y, z = moved_on(kind, work, other, step)
        for i in range(6):
            kind.vectors.load[6 * hull + i] += (
                0.5 * step * (J[0, offset + i] * x + J[1, offset + i] * y + J[2, offset + i] * z)
            )


@kernel(internal=True)
def moved_on(kind: Hulls, work: Workspace, end: int, step: float) -> Vector:
    """``(K + 2/h D)`` times how far the middle of one end, as found, lies from where the line was evaluated [N]."""
    hull = kind.line_ends[end].hull
    dof, d, half = kind.table[hull].dof, kind.stage[hull].foreseen, 0.5 * step
    U = work.velocity[dof : dof + 6]
    moved = (
        half * U[0] - d[0], half * U[1] - d[1], half * U[2] - d[2],
        half * U[3] - d[3], half * U[4] - d[4], half * U[5] - d[5],
    )  # fmt: skip
    return line_force(kind, work, end, step, moved)


@kernel(internal=True)
def _load_hull(kind: Hulls, hull: int, step: float, work: Workspace, again: bool) -> None:
    """Momentum of body, ballast and water at the start, half impulses of forces of markers, waves and weight."""
    frame, vectors = kind.frame[hull], kind.vectors
    h, R, out = step, kind.frame[hull].mid_rotation, 6 * hull
    L = rotate_back(R, frame.angular_momentum)
    if frame.slender:
        spin = vector_at(work.velocity, kind.table[hull].dof + 3) if again else vector(frame.mid_spin)
        L = axial_momentum_at_middle(frame, spin, h), L[1], L[2]
    for k in range(3):
        vectors.load[out + k] = frame.mass * (frame.velocity[k] + 0.5 * h * work.sums.gravity[k])
        vectors.load[out + 3 + k] = L[k]
    for k in range(6):
        vectors.load[out + k] += 0.5 * h * frame.wrench[k]
    for i in range(6):
        force = 0.5 * h * (vectors.wave[out + i] + vectors.known[out + i])
        for j in range(kind.added_mass.shape[1]):
            force += kind.added_mass[out + i, j] * vectors.lead[j]
        for k in range(6):
            vectors.load[out + k] += kind.stage[hull].transform[i, k] * force
    for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
        m = kind.tanks[tank].mass
        f = scaled(m, add_scaled(kind.tanks[tank].start_velocity, 0.5 * h, work.sums.gravity))
        moment = cross(kind.tanks[tank].point, rotate_back(R, f))
        for k in range(3):
            vectors.load[out + k] += f[k]
            vectors.load[out + 3 + k] += moment[k]


@kernel(internal=True)
def assemble(kind: Hulls, group: int, base: int, step: float, work: Workspace, again: bool) -> None:
    """Matrix and right-hand side of a group at the pose of the stage."""
    first, count = kind.groups[group].first, kind.groups[group].count
    n = 6 * count
    for p in range(count):
        _load_hull(kind, first + p, step, work, again)
    assemble_mass(kind, group, base, False, step)
    for p in range(count):
        restore(kind, first + p)
        for i in range(6):
            kind.vectors.load[6 * (first + p) + i] += 0.5 * step * kind.stage[first + p].lift[i]
        _add_stiffness(kind, first + p, base + 6 * p * (n + 1), n, step)
    for end in range(kind.line_ends.shape[0]):
        p = kind.line_ends[end].hull - first
        if 0 <= p < count:
            _add_line(kind, work, end, base + 6 * p * (n + 1), n, step, again)
