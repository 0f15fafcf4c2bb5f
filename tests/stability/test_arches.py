"""Arches of loose voussoirs against the limit analysis of rigid blocks, which knows nothing of time."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq, linprog

from heavylift.preprocess.surfaces.primitives import plane_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.scene import RigidBody

sys.path.append(str(Path(__file__).resolve().parents[1] / "solver" / "contact"))
from mesh_contact_scenes import G, run, scene

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]

COUNT, RADIUS, DEPTH, DENSITY, FRICTION = 7, 1.0, 0.5, 2000.0, 0.9
Corners = NDArray[np.float64]


def voussoirs(thickness: float) -> list[Corners]:
    """Corners of the blocks of a semicircle of unit radius in x and z, counterclockwise from the right, (4, 2) each."""
    angles = np.linspace(0.0, np.pi, COUNT + 1)
    inner, outer = RADIUS - 0.5 * thickness, RADIUS + 0.5 * thickness
    found = []
    for a, b in pairwise(angles):
        u, v = np.array([np.cos(a), np.sin(a)]), np.array([np.cos(b), np.sin(b)])
        found.append(np.array([inner * u, outer * u, outer * v, inner * v]))
    return found


def area_and_centroid(corners: Corners) -> tuple[float, NDArray[np.float64]]:
    """Of a polygon, by its triangles."""
    x, y = corners.T
    cross = x * np.roll(y, -1) - np.roll(x, -1) * y
    area = 0.5 * cross.sum()
    return area, ((corners + np.roll(corners, -1, 0)) * cross[:, None]).sum(0) / (6.0 * area)


def least_push(thickness: float) -> float:
    """Largest value that the smallest normal force at a corner of a joint can have in equilibrium with the weights.

    Above zero the arch stands, below it cannot, since joints bear no tension: the theorems of limit analysis (J.
    Heyman, *The Stone Skeleton*, 1966; R. K. Livesley, Int. J. Numer. Methods Eng. 12 (1978)), a linear programme.
    """
    blocks = voussoirs(thickness)
    joints = COUNT + 1
    # unknowns: normal forces at the inner and outer corner of each joint, shear force of it, and the least push
    size = 3 * joints + 1
    A, b = np.zeros((3 * COUNT, size)), np.zeros(3 * COUNT)
    for i, corners in enumerate(blocks):
        area, centre = area_and_centroid(corners)
        b[3 * i + 1] = area  # forces hold it up, in units of density x depth x g
        for joint, (first, second), sign in ((i, (0, 1), 1.0), (i + 1, (3, 2), -1.0)):
            along = corners[second] - corners[first]
            along /= np.linalg.norm(along)
            normal = sign * np.array([-along[1], along[0]])  # into the block
            for k, corner in enumerate((first, second)):
                arm = corners[corner] - centre
                A[3 * i : 3 * i + 3, 3 * joint + k] = [*normal, arm[0] * normal[1] - arm[1] * normal[0]]
            shear, arm = sign * along, corners[first] - centre
            A[3 * i : 3 * i + 3, 3 * joint + 2] = [*shear, arm[0] * shear[1] - arm[1] * shear[0]]
    rows, limits = [], []
    for joint in range(joints):
        for k in range(2):  # normal forces are no smaller
            row = np.zeros(size)
            row[3 * joint + k], row[-1] = -1.0, 1.0
            rows.append(row)
        for sign in (-1.0, 1.0):  # friction
            row = np.zeros(size)
            row[3 * joint + 2], row[3 * joint : 3 * joint + 2] = sign, -FRICTION
            rows.append(row)
        limits += [0.0] * 4
    cost = np.zeros(size)
    cost[-1] = -1.0
    found = linprog(cost, A_ub=np.array(rows), b_ub=limits, A_eq=A, b_eq=b, bounds=[(None, None)] * size)
    assert found.success
    return float(found.x[-1])


def critical_thickness() -> float:
    return float(brentq(least_push, 0.05, 0.3, xtol=1e-12))


def block(name: str, corners: Corners) -> tuple[RigidBody, TriangleSurface]:
    """A voussoir as a body, and its skin of twelve triangles about its centroid."""
    area, centre = area_and_centroid(corners)
    flat = corners - centre
    points = np.array([[x, y, z] for y in (-0.5 * DEPTH, 0.5 * DEPTH) for x, z in flat])
    sides = [[i, (i + 1) % 4, 4 + (i + 1) % 4] for i in range(4)] + [
        [i, 4 + (i + 1) % 4, 4 + i] for i in range(4)
    ]
    triangles = [*sides, [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]
    # second moments of the quadrilateral: of two triangles, with their vertices a, b, c about the origin
    S = np.zeros((2, 2))
    for a, b, c in ((flat[0], flat[1], flat[2]), (flat[0], flat[2], flat[3])):
        part = 0.5 * float(np.linalg.det(np.array([b - a, c - a])))
        s = a + b + c
        S += part / 12.0 * (np.outer(a, a) + np.outer(b, b) + np.outer(c, c) + np.outer(s, s))
    mass = DENSITY * DEPTH * area
    second = np.zeros((3, 3))
    second[np.ix_([0, 2], [0, 2])] = DENSITY * DEPTH * S
    second[1, 1] = mass * DEPTH**2 / 12.0
    body = RigidBody(
        name=name,
        mass=mass,
        inertia=np.trace(second) * np.eye(3) - second,
        position=np.array([centre[0], 0.0, centre[1]]),
    )
    surface = TriangleSurface(points, np.array(triangles))
    return body, surface


def crown_drop(thickness: float, duration: float) -> float:
    """How far the keystone falls [m]."""
    bodies = [block(f"v{i}", corners) for i, corners in enumerate(voussoirs(thickness))]
    pairs = [(f"v{i}", f"v{i + 1}") for i in range(COUNT - 1)]
    pairs += [("floor", "v0"), ("floor", f"v{COUNT - 1}")]
    arch = scene(bodies, plane_surface(6.0), pairs, friction=FRICTION)
    found = run(arch, 1e-3, duration)
    assert found.drift < 1e-6 * found["energy.kinetic"].max() + 1e-9 * DENSITY * G
    keystone = found[f"v{COUNT // 2}.position"][:, 2]
    return float(keystone[0] - keystone[-1])


def test_limit_analysis_finds_the_known_thickness_of_many_voussoirs(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.1074 of the radius for a semicircle whose joints are radial (M. Milankovitch 1907; J. A. Ochsendorf 2006)."""
    monkeypatch.setattr(sys.modules[__name__], "COUNT", 200)
    assert critical_thickness() == pytest.approx(0.1074, abs=3e-4)


def test_an_arch_stands_above_its_critical_thickness_and_falls_below() -> None:
    critical = critical_thickness()
    assert abs(crown_drop(1.05 * critical, 1.0)) < 1e-7
    assert crown_drop(0.95 * critical, 1.0) > 0.2
    assert crown_drop(0.8 * critical, 0.6) > 0.2
