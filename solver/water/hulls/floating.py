"""Potential of a rigid hull in still water, its derivatives, and the position where it is lowest.

Weight and buoyancy both have a potential, so a floating position that lasts is a minimum of their sum. Newton's method
with the exact stiffness finds it in a few steps; where the stiffness is not positive it goes downhill.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.solver.water.hulls.clipping import (
    Clip,
    buoyancy_stiffness,
    clip_surface_now,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_surface import HullSurface

__all__ = ["FloatingHull", "Pose", "Tank", "settle", "up_direction"]

_STEPS = 200
_LARGEST_TURN = 0.15  # rad in a step
_LARGEST_HEAVE = 0.1  # of the size, in a step
_SMALL = 1e-11  # step of the size and in rad, at which it is over
_ROUNDING = 1e-15  # of the weight times the size: smaller moments are none
_TRUSTED = 1e-6  # below it, differences of the potential are rounding
_NUDGE = 0.02  # of an unstable position
_TINY = 1e-9  # relative stiffness below which a position is not stable


@dataclass(frozen=True)
class Tank:
    """Liquid in a tank, as a point mass with a free surface.

    Parameters
    ----------
    mass
        [kg].
    point
        Centre of the liquid with the hull upright [m], in the axes of the body.
    free_surface
        Density of the liquid times the second moments of its surface [kg m], about its longitudinal and its transverse
        axis: ``rho l b^3 / 12`` and ``rho b l^3 / 12`` of a rectangular tank of the length l and the breadth b; zero
        for a full or an empty one.
    name
        For messages.
    """

    mass: float
    point: tuple[float, float, float]
    free_surface: tuple[float, float] = (0.0, 0.0)
    name: str = "tank"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mass) and self.mass >= 0.0):
            raise InputError(
                f"{self.mass!r}", source=self.name, key="mass", expected="a mass in kg, zero or more"
            )
        if len(self.point) != 3 or not all(math.isfinite(x) for x in self.point):
            raise InputError(
                f"{self.point!r}", source=self.name, key="point", expected="three coordinates in m"
            )
        if len(self.free_surface) != 2 or not all(math.isfinite(x) and x >= 0.0 for x in self.free_surface):
            raise InputError(
                f"{self.free_surface!r}",
                source=self.name,
                key="free_surface",
                expected="two numbers in kg m, zero or more",
            )


class Pose(NamedTuple):
    """How a hull lies, but for its place and its heading.

    Its axes are turned by the list about the longitudinal axis, then by the trim about the transverse one.
    """

    height: float
    """Of the origin of the body above the water [m]."""
    list: float
    """[rad] about the axis x; positive lifts the side of positive y, port if x points ahead and z up."""
    trim: float
    """[rad] about the axis y; positive lowers the end of positive x, the bow."""

    @property
    def rotation(self) -> NDArray[np.float64]:
        """Body axes to world axes without a heading, shape (3, 3)."""
        cl, sl, ct, st = math.cos(self.list), math.sin(self.list), math.cos(self.trim), math.sin(self.trim)
        return np.array([[ct, st * sl, st * cl], [0.0, cl, -sl], [-st, ct * sl, ct * cl]])


def up_direction(pose: Pose) -> NDArray[np.float64]:
    """Upwards direction of the world in the axes of the body, shape (3,)."""
    return pose.rotation[2]


class FloatingHull:
    """Hull with its masses in still water.

    Parameters
    ----------
    hull
        Outside of the hull.
    mass
        Without tanks [kg].
    centre_of_gravity
        Without tanks, in the axes of the body [m], shape (3,).
    density, gravity
        Of the water [kg/m^3], and [m/s^2].
    tanks
        Their masses come on top.

    Attributes
    ----------
    mass, centre_of_gravity
        With tanks [kg], [m].
    free_surface
        Sum over the tanks [kg m], about the longitudinal and the transverse axis.
    size
        Largest extent [m].
    out
        Integrals of the latest evaluation, see `heavylift.solver.water.hulls.clipping`.

    Raises
    ------
    InputError
        For a mass, density or gravity that is not positive, a centre of gravity that is not finite.

    Notes
    -----
    Liquid that runs to the lower side acts as if the centre of gravity were higher by the free surface over the mass:
    its moment at the angle of heel phi is ``g i sin(phi)``, and likewise about the transverse axis. That metacentric
    heights and righting arms are to be corrected for it: IMO, *International Code on Intact Stability* 2008, part B,
    3.1.1.
    """

    def __init__(
        self,
        hull: HullSurface,
        mass: float,
        centre_of_gravity: Sequence[float] | NDArray[np.float64],
        density: float,
        gravity: float,
        tanks: Sequence[Tank] = (),
    ) -> None:
        for key, value, unit in (
            ("mass", mass, "kg"),
            ("density", density, "kg/m3"),
            ("gravity", gravity, "m/s2"),
        ):
            if not (math.isfinite(value) and value > 0.0):
                raise InputError(
                    f"{value!r}", source=hull.name, key=key, expected=f"a positive number in {unit}"
                )
        centre = np.asarray(centre_of_gravity, dtype=np.float64)
        if centre.shape != (3,) or not np.isfinite(centre).all():
            raise InputError(
                f"{centre_of_gravity!r}",
                source=hull.name,
                key="centre_of_gravity",
                expected="three coordinates in m",
            )
        self.hull = hull
        self.density, self.gravity = float(density), float(gravity)
        self.mass = float(mass) + sum(tank.mass for tank in tanks)
        moment = mass * centre + sum((tank.mass * np.array(tank.point) for tank in tanks), np.zeros(3))
        self.centre_of_gravity = moment / self.mass
        self.free_surface = np.array([tank.free_surface for tank in tanks]).reshape(-1, 2).sum(axis=0)
        self.size = float(np.ptp(hull.surface.bounds, axis=0).max())
        self._clips = records(Clip, 1)
        self.out = self._clips[0]
        self._placed = np.zeros_like(hull.covered.points)

    def volume(self, pose: Pose) -> float:
        """Submerged volume [m^3]; fills `out`."""
        surface = self.hull.covered
        clip_surface_now(
            surface.points, surface.triangles, pose.rotation.ravel(), pose.height, self._placed, self._clips
        )
        return float(self.out.volume)

    def evaluate(self, pose: Pose) -> tuple[float, NDArray[np.float64]]:
        """Potential [J] and force [N] along z, moments [N m] about x and y of the world at the body's origin.

        The force has the shape (3,).
        """
        self.volume(pose)
        weight = self.mass * self.gravity
        buoyancy = self.density * self.gravity
        x, y, z = pose.rotation @ self.centre_of_gravity
        volume, (moment_x, moment_y, moment_z) = self.out.volume, self.out.moment.tolist()
        energy = weight * (z + pose.height) - buoyancy * moment_z
        free_energy, free_moment = self._free_surface(pose)
        force = np.array([
            buoyancy * volume - weight,
            buoyancy * moment_y - weight * y + free_moment[0],
            -buoyancy * moment_x + weight * x + free_moment[1],
        ])  # fmt: skip
        return energy + free_energy, force

    def stiffness(self, pose: Pose) -> NDArray[np.float64]:
        """Minus the derivatives of the force at the pose that was evaluated last, shape (3, 3)."""
        buoyancy = buoyancy_stiffness(self.out, pose.height, self.density, self.gravity)[2:5, 2:5]
        lift = self.mass * self.gravity * float(pose.rotation[2] @ self.centre_of_gravity)
        return buoyancy - np.diag([0.0, lift, lift]) + self._free_surface_stiffness(pose)

    def _free_surface(self, pose: Pose) -> tuple[float, NDArray[np.float64]]:
        """Potential [J] and moments about x and y of the world [N m] of liquid that runs to the lower side."""
        if not self.free_surface.any():
            return 0.0, np.zeros(2)
        rotation = pose.rotation
        nx, ny, _ = rotation[2]
        cy, cx = math.sqrt(max(1.0 - nx * nx, 1e-12)), math.sqrt(max(1.0 - ny * ny, 1e-12))
        along, across = self.gravity * self.free_surface
        gradient = rotation @ np.array([-across * nx / cy, -along * ny / cx, 0.0])
        return along * cx + across * cy, np.array([-gradient[1], gradient[0]])

    def _free_surface_stiffness(self, pose: Pose) -> NDArray[np.float64]:
        """By central differences; shape (3, 3), symmetric."""
        result = np.zeros((3, 3))
        if self.free_surface.any():
            for axis in (0, 1):
                step = np.zeros(2)
                step[axis] = 1e-6
                ahead = self._free_surface(turned(pose, step))[1]
                back = self._free_surface(turned(pose, -step))[1]
                result[1:, 1 + axis] = (back - ahead) / 2e-6
        return 0.5 * (result + result.T)

    def upright(self) -> Pose:
        """Pose without list and trim that displaces the mass, found by bisection.

        Raises
        ------
        InputError
            If the hull sinks, or its opening floods before it displaces its mass.
        """
        low, high = self.hull.surface.bounds[:, 2].tolist()
        need = self.mass / self.density
        top = high if self.hull.is_closed else float(self.hull.rim[:, 2].min())
        most = self.volume(Pose(-top, 0.0, 0.0))
        if not need < most:
            until = (
                "fully submerged" if self.hull.is_closed else f"submerged to its open deck at z = {top:.6g} m"
            )
            raise InputError(
                f"sinks: its mass of {self.mass:.6g} kg is {need:.6g} m3 of water, it displaces {most:.6g} m3 {until}",
                source=self.hull.name,
                key="mass",
                expected=f"less than {self.density * most:.6g} kg, tanks included",
            )
        for _ in range(60):
            middle = 0.5 * (low + top)
            if self.volume(Pose(-middle, 0.0, 0.0)) < need:
                low = middle
            else:
                top = middle
        return Pose(-0.5 * (low + top), 0.0, 0.0)

    def rim_height(self, pose: Pose) -> float:
        """Height of the lowest point of the opening above the water [m]; infinite if there is none."""
        if self.hull.is_closed:
            return math.inf
        return float((self.hull.rim @ pose.rotation[2]).min()) + pose.height


def turned(pose: Pose, turn: NDArray[np.float64]) -> Pose:
    """Pose after a rotation [rad] about the axes x and y of the world, shape (2,)."""
    rx, ry = float(turn[0]), float(turn[1])
    angle = math.hypot(rx, ry)
    if angle == 0.0:
        return pose
    # the new upwards direction in body axes is that which the rotation takes to e_z
    sine = math.sin(angle) / angle
    nx, ny, nz = pose.rotation.T @ np.array([-ry * sine, rx * sine, math.cos(angle)])
    return Pose(pose.height, math.atan2(ny, nz), math.asin(min(max(-nx, -1.0), 1.0)))


def settle(floating: FloatingHull, start: Pose, *, heeled: bool = False) -> Pose:
    """Find the position at which the potential is lowest, downhill from a start.

    Parameters
    ----------
    floating
        Hull and masses; `FloatingHull.out` is that of the result afterwards.
    start
        Where to begin.
    heeled
        Keep the list as it is, and look for height and trim only.

    Raises
    ------
    InputError
        If the hull turns over on the way, or no position is found.

    Notes
    -----
    Newton's method on the gradient, with eigenvalues of the stiffness replaced by their absolute values, a largest
    step, and bisection of the step while the potential does not fall (Nocedal and Wright, *Numerical Optimization*,
    2006, section 3.4). At a position that is not stable, as upright with a negative metacentric height, the hull is
    given a small list or trim, and goes on from there.
    """
    free = np.array([0, 2] if heeled else [0, 1, 2])
    scale = np.array([floating.size, 1.0, 1.0])[free]
    rounding = _ROUNDING * floating.mass * floating.gravity * floating.size
    pose = start
    energy, force = floating.evaluate(pose)
    for _ in range(_STEPS):
        stiffness = floating.stiffness(pose)[np.ix_(free, free)]
        scaled = 0.5 * (stiffness + stiffness.T) * np.outer(scale, scale)
        values, vectors = np.linalg.eigh(scaled)
        largest = float(np.abs(values).max())
        if not largest > 0.0:
            break
        bent = np.maximum(np.abs(values), 1e-8 * largest)
        along = vectors.T @ (force[free] * scale)
        step = vectors @ (along / bent)
        if np.abs(step).max() < _SMALL or np.abs(force[free] * scale).max() < rounding:
            if values[0] > -_TINY * largest:
                return pose
            away = vectors[:, 0]
            step = _NUDGE * away * (1.0 if away[np.abs(away).argmax()] >= 0.0 else -1.0)
            pose = _moved(floating, pose, step, free)
            energy, force = floating.evaluate(pose)
            continue
        limits = np.array([_LARGEST_HEAVE, _LARGEST_TURN, _LARGEST_TURN])[free]
        step /= max(1.0, float((np.abs(step) / limits).max()))
        while True:
            trial = _moved(floating, pose, step, free)
            trial_energy, trial_force = floating.evaluate(trial)
            if trial_energy <= energy or np.abs(step).max() < _TRUSTED:
                break
            step *= 0.5
        pose, energy, force = trial, trial_energy, trial_force
        if not heeled and up_direction(pose)[2] <= 0.0:
            raise InputError(
                "capsizes: there is no stable position within 90 degrees of upright",
                source=floating.hull.name,
                key="centre_of_gravity",
                expected="a lower centre of gravity, or one closer to the middle",
            )
    raise InputError(
        f"no floating position found in {_STEPS} steps; the last had a list of {math.degrees(pose.list):.3g} and a "
        f"trim of {math.degrees(pose.trim):.3g} degrees",
        source=floating.hull.name,
        key="mass",
        expected="a hull that floats stably with its mass and centre of gravity",
    )


def _moved(floating: FloatingHull, pose: Pose, step: NDArray[np.float64], free: NDArray[np.int64]) -> Pose:
    """Pose after a scaled step of those of heave, roll and pitch that are free."""
    whole = np.zeros(3)
    whole[free] = step
    height = pose.height + floating.size * float(whole[0])
    if len(free) == 2:
        return Pose(height, pose.list, pose.trim + float(whole[2]))
    return turned(pose._replace(height=height), whole[1:])
