"""Buoyancy of hulls: force, moment, stiffness and potential, of a clipped surface or of a float plane.

Both derive from a potential: ``-rho g`` times the height moment of the submerged volume, or of a float plane
``rho g / 2 int z^2 dA`` with the height z of its points, plus that of the constant volume. Free surfaces of tanks take
from the stiffness of tilt as a negative float plane does.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import rotate, rotate_back
from heavylift.solver.marine.clipping import (
    PLANE_AREA,
    PLANE_X,
    PLANE_XX,
    PLANE_XY,
    PLANE_Y,
    PLANE_YY,
    VOLUME,
    VOLUME_X,
    VOLUME_Y,
    VOLUME_Z,
    clip_surface,
)
from heavylift.solver.marine.hulls import (
    AXIS_X,
    AXIS_Y,
    BUOYANCY,
    CLIP,
    CLIPPED,
    DISPLACED,
    FIRST_POINT,
    FIRST_TANK,
    FIRST_TRIANGLE,
    FLOAT_PLANE,
    LAST_POINT,
    LAST_TANK,
    LAST_TRIANGLE,
    LIFT,
    LINEAR,
    RESTORING,
    STIFFNESS,
    TANK_MASS,
    TANK_SURFACE,
    WATERPLANE,
    Hulls,
)

__all__ = ["restore", "restoring_potential"]


@kernel(internal=True)
def restore(kind: Hulls, hull: int) -> None:
    """Buoyancy at the stage of a hull, in its own coordinates, and its stiffness.

    Writes `LIFT`: world force and moment about the centre of mass in principal axes; `STIFFNESS`: against height and
    the world rotations x and y: zz, zx, zy, xx, yy, xy.
    """
    stage = kind.stage[hull]
    R = kind.frame[hull].mid_rotation
    height = kind.frame[hull].mid_position[2] - kind.water[2]
    weight = kind.water[0]
    sort = kind.hulls[hull, RESTORING]
    force = moment_x = moment_y = zz = zx = zy = xx = yy = xy = 0.0
    if sort == CLIPPED:
        a, b = kind.hulls[hull, FIRST_POINT], kind.hulls[hull, LAST_POINT]
        c, d = kind.hulls[hull, FIRST_TRIANGLE], kind.hulls[hull, LAST_TRIANGLE]
        clip = kind.stage[hull, CLIP : CLIP + 12]
        clip_surface(kind.points[a:b], kind.triangles[c:d], R, height, kind.placed[a:b], clip)
        force = weight * clip[VOLUME]
        moment_x, moment_y = weight * clip[VOLUME_Y], -weight * clip[VOLUME_X]
        lever = clip[VOLUME_Z] - height * clip[VOLUME]
        zz, zx, zy = weight * clip[PLANE_AREA], weight * clip[PLANE_Y], -weight * clip[PLANE_X]
        xx, yy = weight * (clip[PLANE_YY] + lever), weight * (clip[PLANE_XX] + lever)
        xy = -weight * clip[PLANE_XY]
    elif sort == LINEAR:
        data = kind.hull[hull]
        d1x, d1y, a = rotate(R, data[AXIS_X], data[AXIS_X + 1], data[AXIS_X + 2])
        d2x, d2y, b = rotate(R, data[AXIS_Y], data[AXIS_Y + 1], data[AXIS_Y + 2])
        px, py, pz = rotate(R, data[FLOAT_PLANE], data[FLOAT_PLANE + 1], data[FLOAT_PLANE + 2])
        bx, by, bz = rotate(R, data[BUOYANCY], data[BUOYANCY + 1], data[BUOYANCY + 2])
        A, Sx, Sy = data[WATERPLANE], data[WATERPLANE + 1], data[WATERPLANE + 2]
        Ixx, Iyy, Ixy = data[WATERPLANE + 3], data[WATERPLANE + 4], data[WATERPLANE + 5]
        z = height + pz
        f0 = -weight * (A * z + Sx * a + Sy * b)
        f1 = -weight * (Sx * z + Ixx * a + Ixy * b)
        f2 = -weight * (Sy * z + Ixy * a + Iyy * b)
        volume = weight * data[DISPLACED]
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
    if kind.hulls[hull, LAST_TANK] > kind.hulls[hull, FIRST_TANK]:
        about_x, about_y = _free_surfaces(kind, hull)
        data = kind.hull[hull]
        d1x, d1y, a = rotate(R, data[AXIS_X], data[AXIS_X + 1], data[AXIS_X + 2])
        d2x, d2y, b = rotate(R, data[AXIS_Y], data[AXIS_Y + 1], data[AXIS_Y + 2])
        f1, f2 = kind.water[1] * about_y * a, kind.water[1] * about_x * b
        moment_x += d1y * f1 + d2y * f2
        moment_y -= d1x * f1 + d2x * f2
        g1, g2 = kind.water[1] * about_y, kind.water[1] * about_x
        xx -= g1 * d1y * d1y + g2 * d2y * d2y
        yy -= g1 * d1x * d1x + g2 * d2x * d2x
        xy += g1 * d1x * d1y + g2 * d2x * d2y
    m1, m2, m3 = rotate_back(R, moment_x, moment_y, 0.0)
    stage[LIFT], stage[LIFT + 1], stage[LIFT + 2] = 0.0, 0.0, force
    stage[LIFT + 3], stage[LIFT + 4], stage[LIFT + 5] = m1, m2, m3
    stage[STIFFNESS], stage[STIFFNESS + 1], stage[STIFFNESS + 2] = zz, zx, zy
    stage[STIFFNESS + 3], stage[STIFFNESS + 4], stage[STIFFNESS + 5] = xx, yy, xy


@kernel(internal=True)
def _free_surfaces(kind: Hulls, hull: int) -> tuple[float, float]:
    """Sums over the tanks that hold water, about x and about y of the body [kg m2]."""
    about_x = about_y = 0.0
    for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
        if kind.tanks[tank, TANK_MASS] > 0.0:
            about_x += kind.tanks[tank, TANK_SURFACE]
            about_y += kind.tanks[tank, TANK_SURFACE + 1]
    return about_x, about_y


@kernel(internal=True)
def restoring_potential(kind: Hulls, hull: int) -> float:
    """Potential of the buoyancy at the stage [J], after `restore`."""
    R = kind.frame[hull].mid_rotation
    height = kind.frame[hull].mid_position[2] - kind.water[2]
    weight, data = kind.water[0], kind.hull[hull]
    sort = kind.hulls[hull, RESTORING]
    potential = 0.0
    _, _, a = rotate(R, data[AXIS_X], data[AXIS_X + 1], data[AXIS_X + 2])
    _, _, b = rotate(R, data[AXIS_Y], data[AXIS_Y + 1], data[AXIS_Y + 2])
    if sort == CLIPPED:
        potential = -weight * kind.stage[hull, CLIP + VOLUME_Z]
    elif sort == LINEAR:
        _, _, pz = rotate(R, data[FLOAT_PLANE], data[FLOAT_PLANE + 1], data[FLOAT_PLANE + 2])
        _, _, bz = rotate(R, data[BUOYANCY], data[BUOYANCY + 1], data[BUOYANCY + 2])
        A, Sx, Sy = data[WATERPLANE], data[WATERPLANE + 1], data[WATERPLANE + 2]
        Ixx, Iyy, Ixy = data[WATERPLANE + 3], data[WATERPLANE + 4], data[WATERPLANE + 5]
        z = height + pz
        potential = 0.5 * weight * (
            A * z * z + Ixx * a * a + Iyy * b * b + 2.0 * (Sx * z * a + Sy * z * b + Ixy * a * b)
        ) - weight * data[DISPLACED] * (height + bz)  # fmt: skip
    about_x, about_y = _free_surfaces(kind, hull)
    return potential - 0.5 * kind.water[1] * (about_y * a * a + about_x * b * b)
