"""First touch of a bunny that falls on its twin: how far it falls, and what the blow does, by comparing all with all.

    python make_reference.py        writes the tables and prints the key numbers

Both are `bunny.stl`; the lower one stands still, the upper one, turned, falls straight down. How far it can fall is
the least height, over all places that both cover, of one surface over the other: of points over triangles, and of edges
over edges where they cross seen from above. With the unit normal n there, r from the centre of mass to the place, the
velocity v0 down, no friction and no rebound,

    k = 1/m + (r x n) . J^-1 (r x n),      p = v0 n_z / k,      energy lost = (v0 n_z)^2 / (2 k)
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

HERE = Path(__file__).resolve().parent
GRAVITY = 9.81  # m/s^2
MASS, INERTIA = 1.0, (4e-3, 4e-3, 3e-3)  # kg, kg m^2
TWIN = np.array([0.0, 0.0, 0.106])  # m, place of the one that stands still
FALLING = np.array([0.03, 0.012, 0.5])  # m, where the other one begins
TURN = np.radians(150.0)  # about x
TIME_STEP = 1e-3  # s, of the records


class Touch(NamedTuple):
    """The first place that touches."""

    distance: float  # m of fall
    place: np.ndarray  # on the twin, in the world
    normal: np.ndarray  # up


def read_stl(path):
    """Corners of a binary STL file, shape (n, 3, 3)."""
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    return np.fromfile(path, row, offset=84)["corners"].astype(float)


def turned(points):
    """Turned about the axis x."""
    c, s = np.cos(TURN), np.sin(TURN)
    return points @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]).T


def over_triangles(points, triangles):
    """Height of points over triangles, shape (points, triangles); nan where they are beside."""
    a, b, c = (triangles[None, :, k] for k in range(3))
    p = points[:, None]

    def area(u, v, w):
        return (v[..., 0] - u[..., 0]) * (w[..., 1] - u[..., 1]) - (v[..., 1] - u[..., 1]) * (
            w[..., 0] - u[..., 0]
        )

    whole = area(a, b, c)
    weights = np.stack([area(p, b, c), area(a, p, c), area(a, b, p)]) / whole
    z = (weights * np.stack([a[..., 2], b[..., 2], c[..., 2]])).sum(axis=0)
    return np.where((weights >= 0.0).all(axis=0), p[..., 2] - z, np.nan)


def over_edges(upper, lower):
    """Height of edges over edges where they cross seen from above, else nan; and where on the lower edges, 0 to 1."""
    a, da = upper[:, None, 0], (upper[:, 1] - upper[:, 0])[:, None]
    b, db = lower[None, :, 0], (lower[:, 1] - lower[:, 0])[None]
    cross = da[..., 0] * db[..., 1] - da[..., 1] * db[..., 0]
    gap = b - a
    s = (gap[..., 0] * db[..., 1] - gap[..., 1] * db[..., 0]) / cross
    t = (gap[..., 0] * da[..., 1] - gap[..., 1] * da[..., 0]) / cross
    crossing = (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    height = (a[..., 2] + s * da[..., 2]) - (b[..., 2] + t * db[..., 2])
    return np.where(crossing, height, np.nan), t


def edges_of(triangles):
    """Edges of triangles, each once for every triangle, shape (3 n, 2, 3)."""
    return np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])


def first_touch():
    """First place that touches, and the least heights of the three kinds [m]."""
    bunny = read_stl(HERE / "bunny.stl")
    lower, upper = bunny + TWIN, turned(bunny) + FALLING
    found = []
    for moving, still, sign in ((upper, lower, 1.0), (lower, upper, -1.0)):
        points = np.unique(moving.reshape(-1, 3), axis=0)
        height = sign * over_triangles(points, still)
        i, j = np.unravel_index(np.nanargmin(np.where(height > 0.0, height, np.nan)), height.shape)
        corners = still[j]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        fall = height[i, j]
        place = points[i] - [0.0, 0.0, fall] if sign > 0.0 else points[i]
        found.append(Touch(float(fall), place, normal))
    above, below = edges_of(upper), edges_of(lower)
    height, along = over_edges(above, below)
    i, j = np.unravel_index(np.nanargmin(np.where(height > 0.0, height, np.nan)), height.shape)
    place = below[j, 0] + along[i, j] * (below[j, 1] - below[j, 0])
    normal = np.cross(above[i, 1] - above[i, 0], below[j, 1] - below[j, 0])
    found.append(Touch(float(height[i, j]), place, normal))
    touch = min(found)
    normal = touch.normal / np.linalg.norm(touch.normal)
    return touch._replace(normal=normal * np.sign(normal[2])), [one.distance for one in found]


def blow(touch):
    """Time of the touch [s], impulse [N s] and energy lost [J]."""
    speed = np.sqrt(2.0 * GRAVITY * touch.distance)
    arm = touch.place - (FALLING - [0.0, 0.0, touch.distance])
    axes = turned(np.eye(3))  # of the body, one a row
    moment = axes @ np.cross(arm, touch.normal)
    k = 1.0 / MASS + (moment**2 / np.array(INERTIA)).sum()
    closing = speed * touch.normal[2]
    return speed / GRAVITY, closing / k, closing**2 / (2.0 * k)


def references():
    """first_blow.csv: nothing, before and just after the first touch; after that the impulse goes on."""
    time = blow(first_touch()[0])[0]
    after = (np.floor(time / TIME_STEP) + 1.0) * TIME_STEP
    return {"first_blow.csv": np.array([[0.0, 0.0], [after, 0.0]])}


def main():
    """Write the table and print the numbers of the README."""
    for name, table in references().items():
        rows = ["time,value", *(",".join(f"{value:.15g}" for value in row) for row in table)]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    touch, distances = first_touch()
    time, impulse, lost = blow(touch)
    energy = MASS * GRAVITY * touch.distance
    sys.stdout.write(
        f"heights: point over triangle {distances[0]:.9f} m, triangle over point {distances[1]:.9f} m, "
        f"edge over edge {distances[2]:.9f} m\n"
        f"touch after {touch.distance:.9f} m and {time:.9f} s at {np.round(touch.place, 9)} m, normal "
        f"{np.round(touch.normal, 9)}\n"
        f"impulse {impulse:.9f} N s, energy lost {lost:.9f} J, {lost / energy:.9f} of {energy:.9f} J\n"
    )


if __name__ == "__main__":
    main()
