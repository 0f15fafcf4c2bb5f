"""Write the reference values of this case, without any triangle or clipping code of the package.

    python cases/box_hydrostatics/make_reference.py

Positions: the wet part of the box is the intersection of seven half spaces, whose corners Qhull finds (vertices of the
dual hull); volume and centre are those of the tetrahedra of its convex hull. Righting arms: the section of the box is
clipped as a polygon, its height found by Brent's method.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
from scipy.optimize import brentq
from scipy.spatial import ConvexHull, HalfspaceIntersection

SIZE = np.array([97.5, 36.0, 6.0])
POSITIONS = (
    (-1.5, 0, 0),
    (-1.5, 5, 0),
    (-1.5, 0, 1),
    (-1.5, 5, 1),
    (-1.5, 10, 0),
    (-2.5, 10, 2),
    (0.0, 15, 3),
)
DRAFT, RISE = 4.5, 2.0
HERE = Path(__file__).resolve().parent


def wet_part(height, roll, pitch):
    """Volume [m^3], its centre [m] from the water plane above the centre of the box, area of the water plane [m^2]."""
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    rotation = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ np.array(
        [[1, 0, 0], [0, cr, -sr], [0, sr, cr]]
    )
    centre = np.array([0.0, 0.0, height])
    planes = [
        [*(s * rotation[:, k]), -s * rotation[:, k] @ centre - 0.5 * SIZE[k]]
        for k in range(3)
        for s in (1, -1)
    ]
    planes.append([0.0, 0.0, 1.0, 0.0])
    corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * SIZE @ rotation.T + centre
    low = corners[corners[:, 2].argmin()]
    inside = low + 0.02 * (centre - low)
    points = HalfspaceIntersection(np.array(planes), inside).intersections
    hull = ConvexHull(points)
    tip = points.mean(axis=0)
    volume, moment = 0.0, np.zeros(3)
    for a, b, c in points[hull.simplices]:
        part = abs(np.linalg.det([a - tip, b - tip, c - tip])) / 6.0
        volume += part
        moment += part * (a + b + c + tip) / 4.0
    top = points[np.abs(points[:, 2]) < 1e-9][:, :2]
    return volume, moment / volume, ConvexHull(top).volume


def righting_arm(angle):
    """GZ [m] of the box at a draft of 4.5 m, its centre of gravity 2 m above its middle."""
    breadth, depth = SIZE[1], SIZE[2]
    section = 0.5 * np.array([[-breadth, -depth], [breadth, -depth], [breadth, depth], [-breadth, depth]])
    c, s = math.cos(angle), math.sin(angle)
    corners = section @ np.array([[c, s], [-s, c]])

    def wet(height):
        polygon = []
        for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            a, b = p[1] + height, q[1] + height
            if a < 0.0:
                polygon.append(p)
            if (a < 0.0) != (b < 0.0):
                polygon.append(p + a / (a - b) * (q - p))
        if len(polygon) < 3:
            return 0.0, 0.0
        p = np.array(polygon)
        q = np.roll(p, -1, axis=0)
        cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
        return 0.5 * cross.sum(), cross @ (p[:, 0] + q[:, 0]) / 6.0

    height = brentq(lambda h: wet(h)[0] - breadth * DRAFT, -breadth, breadth, xtol=1e-14)
    area, moment = wet(height)
    return -(moment / area + RISE * s)


def write(name, comment, header, rows):
    """Rows as comma-separated columns under a comment and a header."""
    with (HERE / name).open("w", newline="", encoding="utf-8") as stream:
        stream.write(f"# {comment}\n")
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(rows)


def references():
    """Both tables by name of their files."""
    positions = []
    for height, roll, pitch in POSITIONS:
        volume, centre, area = wet_part(height, math.radians(roll), math.radians(pitch))
        positions.append([height, roll, pitch, volume, *centre, area])
    arms = [[heel, righting_arm(math.radians(heel))] for heel in range(0, 82, 2)]
    return {"positions.csv": np.array(positions), "righting_arms.csv": np.array(arms)}


def main():
    """Write both tables."""
    tables = references()
    write(
        "positions.csv",
        "Box 97.5 x 36 x 6 m about its centre; rotation Ry(pitch) Rx(roll); make_reference.py: half spaces, Qhull",
        ["z_centre_m", "roll_deg", "pitch_deg", "volume_m3", "xB_m", "yB_m", "zB_m", "waterplane_area_m2"],
        [
            [f"{x:g}" for x in row[:3]] + [f"{x + 0.0:.9f}" for x in row[3:]]
            for row in tables["positions.csv"]
        ],
    )
    write(
        "righting_arms.csv",
        "The same box, 4.5 m draft, KG 5 m: righting arm over heel; make_reference.py: polygon of the section",
        ["heel_deg", "GZ_m"],
        [[f"{heel:g}", f"{arm + 0.0:.12f}"] for heel, arm in tables["righting_arms.csv"]],
    )
    vanishing = brentq(righting_arm, 0.5, 1.4, xtol=1e-14)
    print(f"stability vanishes at {math.degrees(vanishing):.9f} degrees = {vanishing:.12f} rad")  # noqa: T201


if __name__ == "__main__":
    main()
