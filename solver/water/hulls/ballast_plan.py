"""Fillings of tanks for the stages of an operation, and the hull girder in still water; plain NumPy.

At each stage the hull is to lie with a given heel and trim, and a given draft if there is one. Weight, buoyancy and
free surfaces give three equations for the masses m of the tanks, linear but for the centres of water in tanks of odd
shapes, so Newton's method on them ends in a few rounds. Of all fillings that fulfil them the one is taken that pumps
least after the stage before,

    min |m - m_before|^2 ,     A m = b ,     0 <= m <= capacity

whose solution is ``m = clip(m_before + A^T y, 0, capacity)`` with the multipliers y of the equations: a monotone
equation ``A m(y) = b`` in three unknowns at most (Boyd and Vandenberghe, *Convex Optimization*, 2004, section 5.5.3).

The girder is a beam on which weights and buoyancy act along x: shear force is the integral of buoyancy less weight
from aft, positive if it lifts the part aft of a section, bending moment that of the shear force, positive if the hull
sags. Areas of sections under water follow from the triangles of the hull by ``A = int (depth) dy`` along the outline,
which needs no cap at the water plane.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.solver.water.hulls.hydrostatics import (
    FloatingHull,
    FloatingPosition,
    Pose,
    Tank,
    equilibrium,
    up_direction,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_surface import HullSurface
    from heavylift.solver.scene import sea as seas

__all__ = ["Girder", "Load", "Stage", "StagePlan", "Weight", "girder", "least_change", "plan_stages"]

ROUNDS = 100

UNABLE = 1e-9
"""Of a lever of the size of the hull: tanks nearer to an axis have no moment about it."""

RIDGE = 1e-10
"""Of the trace of A A^T, where too few tanks are free to say all multipliers."""

LONGEST = 1e12
"""Of a Newton step, that is gone along it."""
SMALL = 1e-12
"""Of the weight, and of the weight times the size: forces and moments that are none."""

STATIONS = 240
"""Least number of pieces of a girder, beside the corners of the hull and the ends of weights."""

GAUSS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Load:
    """Load on a hull: mass [kg], centre [m], shape (3,), length along x over which it is spread evenly [m]."""

    mass: float
    point: tuple[float, float, float]
    length: float = 0.0


@dataclass(frozen=True)
class Stage:
    """A moment of an operation.

    Attributes
    ----------
    name
        Of its own.
    loads
        On the hull, beside its own mass and what joints hold on it.
    heel, trim
        List and trim that the hull is to have [rad].
    draft
        Of the middle of its keel [m]; None: as deep as the water that is least pumped makes it.
    time
        [s]; None if it does not matter.
    """

    name: str
    loads: tuple[Load, ...] = ()
    heel: float = 0.0
    trim: float = 0.0
    draft: float | None = None
    time: float | None = None


@dataclass(frozen=True, eq=False)
class StagePlan:
    """A stage with its fillings [kg], and how the hull floats with them."""

    stage: Stage
    masses: NDArray[np.float64]
    liquids: tuple[Tank, ...]
    position: FloatingPosition


def least_change(
    A: NDArray[np.float64],
    b: NDArray[np.float64],
    before: NDArray[np.float64],
    high: NDArray[np.float64],
) -> NDArray[np.float64] | None:
    """Nearest of all m with ``A m = b`` and ``0 <= m <= high``; None if there is none.

    Parameters
    ----------
    A, b
        Equations, shapes (k, n) and (k,).
    before
        What it is to be near to, shape (n,).
    high
        Shape (n,), infinite ones allowed.
    """
    from scipy.optimize import linprog

    scale = np.linalg.norm(A, axis=1)
    scale[scale == 0.0] = 1.0
    A, b = A / scale[:, None], b / scale
    size = max(float(np.abs(before).max()), float(np.abs(b).max()), 1.0)
    bounds = [(0.0, None if math.isinf(one) else one / size) for one in high]
    if linprog(np.zeros(len(before)), A_eq=A, b_eq=b / size, bounds=bounds).status != 0:
        return None
    y = np.zeros(len(b))
    ridge = RIDGE * np.trace(A @ A.T) * np.eye(len(b))

    def missed(at: NDArray[np.float64]) -> NDArray[np.float64]:
        return b - A @ np.clip(before + A.T @ at, 0.0, high)

    for _ in range(ROUNDS):
        slope = missed(y)
        if np.abs(slope).max(initial=0.0) <= 1e-15 * size:
            break
        m = before + A.T @ y
        inner = A[:, (m > 0.0) & (m < high)]
        step = np.linalg.solve(inner @ inner.T + ridge, slope)
        # the multipliers make a concave function largest; along the step its slope falls through zero somewhere
        low, far = 0.0, 1.0
        while missed(y + far * step) @ step > 0.0 and far < LONGEST:
            low, far = far, 4.0 * far
        if low > 0.0 or missed(y + step) @ step < -1e-12 * abs(slope @ step):
            for _ in range(100):
                middle = 0.5 * (low + far)
                low, far = (middle, far) if missed(y + middle * step) @ step > 0.0 else (low, middle)
        y = y + far * step
    return np.clip(before + A.T @ y, 0.0, high)


def plan_stages(
    hull: HullSurface,
    mass: float,
    centre: NDArray[np.float64],
    tanks: Sequence[seas.Tank],
    stages: Sequence[Stage],
    water: seas.Water,
    offset: NDArray[np.float64],
) -> list[StagePlan]:
    """Fillings for some stages.

    Parameters
    ----------
    hull, mass, centre
        Outside of the hull, its mass [kg] and centre of mass [m] without tanks and loads.
    tanks
        In its frame; the fillings at the start are those before the first stage.
    stages
        In order.
    water
        Still water.
    offset
        From the frame of the tanks to the axes of the hull [m], shape (3,).

    Raises
    ------
    InputError
        If no filling holds the hull as it should lie, or it does not float upright.
    """
    before = np.array([tank.start_mass for tank in tanks])
    found = []
    for stage in stages:
        masses, liquids = _fill(hull, mass, centre, tanks, stage, water, offset, before)
        load, at = _with_loads(mass, centre, stage)
        position = equilibrium(
            hull, load, at, density=water.density, gravity=water.gravity, level=water.level, tanks=liquids
        )
        if abs(position.pose.trim - stage.trim) + abs(position.pose.list - stage.heel) > 1e-6:
            raise InputError(
                f"stage {stage.name!r}: the hull does not stay at a heel of {math.degrees(stage.heel):.4g} and a trim"
                f" of {math.degrees(stage.trim):.4g} deg, it moves to {math.degrees(position.pose.list):.4g} and"
                f" {math.degrees(position.pose.trim):.4g} deg",
                source=hull.name,
                key="tanks",
                expected="metacentric heights above 0",
            )
        found.append(StagePlan(stage, masses, liquids, position))
        before = masses
    return found


def _with_loads(mass: float, centre: NDArray[np.float64], stage: Stage) -> tuple[float, NDArray[np.float64]]:
    """Mass and centre of a hull with the loads of a stage."""
    whole = mass + sum(load.mass for load in stage.loads)
    moment = mass * np.asarray(centre) + sum(
        (load.mass * np.array(load.point) for load in stage.loads), np.zeros(3)
    )
    return whole, moment / whole


def _liquids(
    tanks: Sequence[seas.Tank], masses: NDArray[np.float64], water: seas.Water, offset: NDArray[np.float64]
) -> tuple[Tank, ...]:
    """What is in the tanks."""
    found = []
    for tank, mass in zip(tanks, masses.tolist(), strict=True):
        point, surface, _ = tank.contents(mass, water)
        x, y, z = (point + offset).tolist()
        found.append(Tank(mass, (x, y, z), surface, tank.name))
    return tuple(found)


def _fill(
    hull: HullSurface,
    mass: float,
    centre: NDArray[np.float64],
    tanks: Sequence[seas.Tank],
    stage: Stage,
    water: seas.Water,
    offset: NDArray[np.float64],
    before: NDArray[np.float64],
) -> tuple[NDArray[np.float64], tuple[Tank, ...]]:
    """Newton's method on the equilibrium at the heel, trim and draft of a stage."""
    load, at = _with_loads(mass, centre, stage)
    high = np.array([tank.capacity(water) for tank in tanks])
    masses, settled = before, False
    for _ in range(ROUNDS):
        liquids = _liquids(tanks, masses, water, offset)
        floating = FloatingHull(hull, load, at, water.density, water.gravity, liquids)
        pose = _pose(floating, stage)
        _, force = floating.evaluate(pose)
        weight = floating.mass * water.gravity
        left = np.abs(force) / (weight * np.array([1.0, floating.size, floating.size]))
        if left.max() < SMALL or settled:
            return masses, liquids
        places = np.array([liquid.point for liquid in liquids]) @ pose.rotation.T
        out = floating.out
        lever = np.zeros(2)
        rows = [np.full(len(tanks), -water.gravity)]
        if stage.draft is None:  # it sinks by what is added, about the centre of the water plane
            lever = np.array([out.plane_x, out.plane_y]) / out.plane_area
            rows, force = [], force[1:]
        rows.append(-water.gravity * (places[:, 1] - lever[1]))
        rows.append(water.gravity * (places[:, 0] - lever[0]))
        A = np.array(rows)
        # tanks on the middle line have nothing to do with a heel, and need not where none is missing
        able = np.linalg.norm(A, axis=1) > UNABLE * water.gravity * floating.size
        idle = np.abs(force)[~able] <= UNABLE * weight * floating.size
        A, lacks = A[able], (A @ masses - force)[able]
        nearest = least_change(A, lacks, before, high) if idle.all() and able.any() else None
        if nearest is None:
            draft = "" if stage.draft is None else f", a draft of {stage.draft:g} m"
            raise InputError(
                f"stage {stage.name!r}: no filling of {', '.join(tank.name for tank in tanks)} holds the hull at a heel"
                f" of {math.degrees(stage.heel):.4g} deg, a trim of {math.degrees(stage.trim):.4g} deg{draft}; it lacks"
                f" {force[0] / water.gravity * 1e-3:.5g} {'t m' if stage.draft is None else 't'} with the water before"
                " it",
                source=hull.name,
                key="tanks",
                expected="more or larger tanks, or another draft",
            )
        settled = not able.all() and np.abs(nearest - masses).max() <= SMALL * floating.mass
        masses = nearest
    raise InputError(
        f"stage {stage.name!r}: no filling found in {ROUNDS} rounds",
        source=hull.name,
        key="tanks",
        expected="tanks whose centres vary smoothly with their water",
    )


def _pose(floating: FloatingHull, stage: Stage) -> Pose:
    """With the heel and trim of a stage, as deep as it says, or as its mass is."""
    pose = Pose(0.0, stage.heel, stage.trim)
    low, high = floating.hull.surface.bounds
    keel = np.array([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]])
    if stage.draft is not None:
        return pose._replace(height=-stage.draft - float(up_direction(pose) @ keel))
    need = floating.mass / floating.density
    top = float(np.abs(floating.hull.surface.bounds).max()) * 2.0
    deep, dry = -top, top
    if floating.volume(pose._replace(height=deep)) < need:
        raise InputError(
            f"stage {stage.name!r}: it sinks with {floating.mass:.6g} kg",
            source=floating.hull.name,
            key="mass",
            expected="less load or water",
        )
    height = 0.5 * (deep + dry)
    for _ in range(200):
        height = 0.5 * (deep + dry)
        if floating.volume(pose._replace(height=height)) < need:
            dry = height
        else:
            deep = height
        if dry - deep < 1e-15 * top:
            break
    return pose._replace(height=height)


# ---- the girder ----


@dataclass(frozen=True)
class Weight:
    """Weight along a hull: mass [kg], from and to [m] (a point if both are the same), height of its centre [m].

    `slope` is the change of its mass a length from end to end, over its mean, of a trapezoid.
    """

    mass: float
    start: float
    end: float
    height: float = 0.0
    slope: float = 0.0


@dataclass(frozen=True, eq=False)
class Girder:
    """Shear force [N] and bending moment [N m] at stations [m]; what is left at the end, over weight and length."""

    stations: NDArray[np.float64]
    shear: NDArray[np.float64]
    bending: NDArray[np.float64]
    closure: tuple[float, float]


def girder(
    hull: HullSurface, pose: Pose, weights: Sequence[Weight], density: float, gravity: float
) -> Girder:
    """Shear force and bending moment of a hull in still water.

    Parameters
    ----------
    hull
        Outside of the hull, in its axes.
    pose
        How it lies.
    weights
        All of them.
    density, gravity
        Of the water [kg/m^3], and [m/s^2].
    """
    points = hull.covered.points
    low, high = points[:, 0].min(), points[:, 0].max()
    ends = [x for weight in weights for x in (weight.start, weight.end)]
    first, last = min(low, *ends), max(high, *ends)
    nodes = np.unique(
        np.round(np.concatenate([np.linspace(first, last, STATIONS + 1), points[:, 0], ends]), 9)
    )
    tilt = math.tan(pose.trim)
    spots, parts = 0.5 * (GAUSS[0] + 1.0), 0.5 * GAUSS[1]
    stations, shear, bending = [nodes[0]], [0.0], [0.0]
    lift = moment = 0.0
    for a, b in pairwise(nodes):
        h = b - a
        area, first_moment = _sections(hull, pose, a + h * spots)
        q = density * gravity * area
        moment += lift * h + h * h * float((parts * (1.0 - spots)) @ q)
        moment -= tilt * density * gravity * h * float(parts @ first_moment)
        lift += h * float(parts @ q)
        carried, levered = _weights(weights, b, gravity, tilt)
        stations.append(b)
        shear.append(lift - carried)
        bending.append(moment - levered)
        jump = gravity * sum(one.mass for one in weights if one.start == one.end == b)
        if jump:  # before and behind a point
            shear.insert(-1, shear[-1] + jump)
            stations.insert(-1, b)
            bending.insert(-1, bending[-1] - tilt * gravity * sum(
                one.mass * one.height for one in weights if one.start == one.end == b
            ))  # fmt: skip
    weight = gravity * sum(one.mass for one in weights)
    closure = shear[-1] / weight, bending[-1] / (weight * (last - first))
    return Girder(np.array(stations), np.array(shear), np.array(bending), closure)


def _weights(weights: Sequence[Weight], x: float, gravity: float, tilt: float) -> tuple[float, float]:
    """Weight aft of a station [N], and its moment about it, with that of its height on a slope [N m]."""
    force = moment = 0.0
    for one in weights:
        length = one.end - one.start
        if length <= 0.0:
            part, lever = (1.0, x - one.start) if x >= one.start else (0.0, 0.0)
        else:
            s = min(max((x - one.start) / length, 0.0), 1.0)
            # mass a length: (1 + slope (t - 1/2)) over the mean, t along it
            part = s + 0.5 * one.slope * (s * s - s)
            lever = length * (0.5 * s * s + one.slope * (s**3 / 6.0 - 0.25 * s * s)) + part * max(
                x - one.end, 0.0
            )
        force += gravity * one.mass * part
        moment += gravity * one.mass * (lever - tilt * one.height * part)
    return force, moment


def _sections(
    hull: HullSurface, pose: Pose, stations: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Areas under water [m^2] of sections across a hull, and their first moments of z in its axes [m^3]."""
    surface = hull.covered
    corners = surface.points[surface.triangles]  # triangle, corner, axis
    up = up_direction(pose)
    areas, moments = np.zeros(len(stations)), np.zeros(len(stations))
    low, high = corners[:, :, 0].min(axis=1), corners[:, :, 0].max(axis=1)
    for i, x in enumerate(stations):
        cut = corners[(low < x) & (x < high)]
        if not len(cut):
            continue
        y, z = _outline(cut, x)
        level = -(pose.height + up[0] * x + up[1] * y) / up[2]
        depth = level - z
        wet, dry = depth > 0.0, depth <= 0.0
        for a, b in ((0, 1), (1, 0)):  # the dry end of a piece moves to the water plane
            mixed = wet[:, a] & dry[:, b]
            part = depth[mixed, a] / (depth[mixed, a] - depth[mixed, b])
            y[mixed, b] = y[mixed, a] + part * (y[mixed, b] - y[mixed, a])
            depth[mixed, b] = 0.0
        kept = wet.any(axis=1)
        width = y[kept, 1] - y[kept, 0]
        d0, d1 = depth[kept, 0], depth[kept, 1]
        areas[i] = float((0.5 * (d0 + d1) * width).sum())
        # int z dA = int (level d - d^2/2) dy, with the level of the middle
        middle = -(pose.height + up[0] * x) / up[2]
        squares = (d0 * d0 + d0 * d1 + d1 * d1) / 3.0
        moments[i] = middle * areas[i] - 0.5 * float((squares * width).sum())
    return areas, moments


def _outline(cut: NDArray[np.float64], x: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pieces of the outline of a section: y and z of both ends, with the inside on one hand; shapes (n, 2)."""
    side = cut[:, :, 0] > x
    alone = np.where(side.sum(axis=1) == 1, side.argmax(axis=1), (~side).argmax(axis=1))
    rows = np.arange(len(cut))
    a, b, c = cut[rows, alone], cut[rows, (alone + 1) % 3], cut[rows, (alone + 2) % 3]
    ends = []
    for other in (b, c):
        part = ((x - a[:, 0]) / (other[:, 0] - a[:, 0]))[:, None]
        ends.append(a + part * (other - a))
    forward = side[rows, alone]
    first = np.where(forward[:, None], ends[0], ends[1])
    second = np.where(forward[:, None], ends[1], ends[0])
    pieces = np.stack([first, second], axis=1)
    return pieces[:, :, 1].copy(), pieces[:, :, 2].copy()
