"""Buoyancy of hulls: force, moment, stiffness and potential, of a clipped surface or of a float plane.

Both derive from a potential: ``-rho g`` times the height moment of the submerged volume, or of a float plane
``rho g / 2 int z^2 dA`` with the height z of its points, plus that of the constant volume. Free surfaces of tanks take
from the stiffness of tilt as a negative float plane does.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate, rotate_back
from heavylift.solver.water.hulls.clipping import (
    clip_surface,
)
from heavylift.solver.water.hulls.kind import (
    CLIPPED,
    LINEAR,
    Hulls,
)

__all__ = ["restore", "restoring_potential"]


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
    """Sums over the tanks that hold water, about x and about y of the body [kg m2]."""
    about_x = about_y = 0.0
    for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
        if kind.tanks[tank].mass > 0.0:
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
