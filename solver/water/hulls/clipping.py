"""Water plane cut through a hull of triangles: submerged volume, its centre, the water plane and its moments.

"Integrated simulation ... (2018)", section 2.9.2.

The surface is clipped at the still water plane, triangle by triangle, so that volume and moments are exact for the
polyhedron. Buoyancy is then the gradient of a potential: no energy is made or lost over a closed path.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.arrays import Floats1, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records
from heavylift.numerics.records import Vector as VectorField
from heavylift.numerics.vectors import Vector, add, cross, dot, scaled, subtract

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Clip", "buoyancy_stiffness", "clip_surface", "clip_surface_now"]


class Clip(Record):
    """What is below the water plane, in axes parallel to those of the world.

    About the point of the water plane that is vertically above or below the origin of the body.

    Attributes
    ----------
    volume
        Submerged [m^3].
    moment
        First moments of the submerged volume [m^4]; z from the water plane, hence negative.
    plane_area
        Of the water plane [m^2].
    plane_x, plane_y
        Integrals of x and of y over the water plane [m^3].
    plane_xx, plane_yy, plane_xy
        Integrals of x^2, y^2 and x y over the water plane [m^4].
    wetted_area
        Of the surface below the water plane [m^2].
    crossing
        Number of triangles that the water plane cuts.
    """

    volume: float
    moment: VectorField
    plane_area: float
    plane_x: float
    plane_y: float
    plane_xx: float
    plane_yy: float
    plane_xy: float
    wetted_area: float
    crossing: int


Sums = tuple[float, Vector, float]


@kernel(inline=True, internal=True)
def triangle_sums(a: Vector, b: Vector, c: Vector) -> Sums:
    """6 volumes of the tetrahedron from the origin, 24 first moments of it, 2 areas of the triangle."""
    n = cross(subtract(b, a), subtract(c, a))
    volume = dot(a, n)
    return volume, scaled(volume, add(add(a, b), c)), math.sqrt(dot(n, n))


@kernel(internal=True)
def clip_surface(
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    rotation: NDArray[np.float64],
    height: float,
    placed: NDArray[np.float64],
    out: Clip,
) -> None:
    """Clip a surface at the water plane and integrate what is below.

    Parameters
    ----------
    points
        Vertices [m] in the axes of the body, shape (nv, 3).
    triangles
        Vertex numbers, anticlockwise seen from outside, shape (nt, 3). The part below the water must be closed;
        openings above it do no harm.
    rotation
        Body to world axes, row by row, shape (9,).
    height
        Of the origin of the body above the water plane [m].
    placed
        Scratch for the vertices in world directions, shape (nv, 3).
    out
        Written.

    Notes
    -----
    With the origin in the water plane the tetrahedra from the origin to the water plane have no volume, so the plane
    needs no triangles. Its boundary are the cuts, whence area and moments follow by Green's theorem. A vertex on the
    plane counts as above it, which is the limit of a hull that is raised a little; neighbours then always agree on
    their common edge. Submerged volume and first moments: Mirtich, "Fast and accurate computation of polyhedral mass
    properties", Journal of Graphics Tools 1(2) (1996), here by tetrahedra.
    """
    r0, r1, r2 = rotation[0], rotation[1], rotation[2]
    r3, r4, r5 = rotation[3], rotation[4], rotation[5]
    r6, r7, r8 = rotation[6], rotation[7], rotation[8]
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        placed[i, 0] = r0 * x + r1 * y + r2 * z
        placed[i, 1] = r3 * x + r4 * y + r5 * z
        placed[i, 2] = r6 * x + r7 * y + r8 * z + height
    volume = wetted = 0.0
    moment = (0.0, 0.0, 0.0)
    area = plane_x = plane_y = plane_xx = plane_yy = plane_xy = 0.0
    crossing = 0
    for k in range(triangles.shape[0]):
        i, j, m = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        az, bz, cz = placed[i, 2], placed[j, 2], placed[m, 2]
        wet_a, wet_b, wet_c = not az >= 0.0, not bz >= 0.0, not cz >= 0.0  # so is what is not a number
        if not (wet_a or wet_b or wet_c):
            continue
        whole = wet_a and wet_b and wet_c
        two = False
        if not whole:  # the vertex that is alone on its side of the plane becomes the first
            two = (wet_a and wet_b) or (wet_b and wet_c) or (wet_c and wet_a)
            if wet_b != two:
                i, j, m = j, m, i
                az, bz, cz = bz, cz, az
            elif wet_c != two:
                i, j, m = m, i, j
                az, bz, cz = cz, az, bz
        ax, ay = placed[i, 0], placed[i, 1]
        bx, by = placed[j, 0], placed[j, 1]
        cx, cy = placed[m, 0], placed[m, 1]
        if not whole:
            crossing += 1
            s, t = az / (az - bz), az / (az - cz)
            px, py = ax + s * (bx - ax), ay + s * (by - ay)
            qx, qy = ax + t * (cx - ax), ay + t * (cy - ay)
            if two:  # p b c here, p c q below
                v, first, w = triangle_sums((px, py, 0.0), (bx, by, bz), (cx, cy, cz))
                volume, wetted = volume + v, wetted + w
                moment = add(moment, first)
                cut = px * qy - qx * py
                ax, ay, az = px, py, 0.0
                bx, by, bz = cx, cy, cz
            else:
                cut = qx * py - px * qy
                bx, by, bz = px, py, 0.0
            cx, cy, cz = qx, qy, 0.0
            area += cut
            plane_x += cut * (px + qx)
            plane_y += cut * (py + qy)
            plane_xx += cut * (px * px + px * qx + qx * qx)
            plane_yy += cut * (py * py + py * qy + qy * qy)
            plane_xy += cut * (2.0 * (px * py + qx * qy) + px * qy + qx * py)
        v, first, w = triangle_sums((ax, ay, az), (bx, by, bz), (cx, cy, cz))
        volume, wetted = volume + v, wetted + w
        moment = add(moment, first)
    out.volume = volume / 6.0
    for k in range(3):
        out.moment[k] = moment[k] / 24.0
    out.plane_area = area / 2.0
    out.plane_x = plane_x / 6.0
    out.plane_y = plane_y / 6.0
    out.plane_xx = plane_xx / 12.0
    out.plane_yy = plane_yy / 12.0
    out.plane_xy = plane_xy / 24.0
    out.wetted_area = wetted / 2.0
    out.crossing = crossing


@entry
def clip_surface_now(
    points: Floats2,
    triangles: Ints2,
    rotation: Floats1,
    height: float,
    placed: Floats2,
    out: Records[Clip],
) -> None:
    """Call `clip_surface` from Python, with an array of one record."""
    clip_surface(points, triangles, rotation, height, placed, out[0])


def buoyancy_stiffness(clip: Clip, height: float, density: float, gravity: float) -> NDArray[np.float64]:
    """Tangent stiffness of buoyancy about the origin of the body, in axes parallel to those of the world.

    Parameters
    ----------
    clip
        Of `clip_surface`.
    height
        Of the origin of the body above the water plane [m].
    density, gravity
        Of the water [kg/m^3] and [m/s^2].

    Returns
    -------
    ndarray
        Shape (6, 6): minus the derivatives of force [N] and moment [N m] with respect to a shift [m] of the body and
        a small rotation [rad] of it about its origin, both in world directions.

    Notes
    -----
    The force is ``rho g (0, 0, V)``, its moment about the origin of the body ``rho g (Vy, -Vx, 0)``. A point of the
    water plane rises by ``dz + y rx - x ry`` and takes as much volume out of the water, and the volume that stays in
    moves by ``r x (x, y, z - h)``. With ``B = Vz - h V``, the first moment of volume about the origin of the body, and
    S and I the moments of the water plane, the rows of heave, roll and pitch are

        heave   rho g [ 0, 0,   A,      Sy,     -Sx,    0]
        roll    rho g [ 0, 0,  Sy, Iyy + B,    -Ixy,  -Vx]
        pitch   rho g [ 0, 0, -Sx,    -Ixy, Ixx + B,  -Vy]

    and the others are zero. The column of yaw turns the moment along with the body; it is what makes the matrix
    unsymmetric, and vanishes together with the weight in equilibrium. Weight has its own stiffness, about the centre of
    gravity.
    """
    vx, vy, vz = clip.moment
    a, sx, sy, ixy = clip.plane_area, clip.plane_x, clip.plane_y, clip.plane_xy
    b = vz - height * clip.volume
    k = np.zeros((6, 6))
    k[2, 2:5] = a, sy, -sx
    k[3, 2:] = sy, clip.plane_yy + b, -ixy, -vx
    k[4, 2:] = -sx, -ixy, clip.plane_xx + b, -vy
    return density * gravity * k
