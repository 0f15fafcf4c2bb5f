"""Righting arm of a hull over the angle of heel, with free trim and constant displacement."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.water.hulls.floating import FloatingHull, Pose, Tank, settle

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_surface import HullSurface

__all__ = ["RightingArmCurve", "righting_arm_curve"]

_ROOT = 1e-10  # rad
_ZERO = 1e-9  # arms of that part of the size are zero


@dataclass(frozen=True, eq=False)
class RightingArmCurve:
    """Righting arm over heel.

    Beyond the angle of flooding the values are not numbers: water would run into the hull.
    """

    angles: NDArray[np.float64]
    """Heel [rad] to the `side`, increasing, shape (n,)."""
    side: int
    """1 if heel is positive list, which lowers the side of negative y; -1 if it is negative list."""
    arms: NDArray[np.float64]
    """GZ [m]: horizontal distance of the lines of buoyancy and weight, positive if they turn the hull back from a
    positive heel; free surfaces included; shape (n,)."""
    trims: NDArray[np.float64]
    """[rad], shape (n,)."""
    heights: NDArray[np.float64]
    """Of the body's origin above the water [m], shape (n,)."""
    work: NDArray[np.float64]
    """Area under the curve [m rad] from the first stable angle, or from the first of all; shape (n,)."""
    equilibrium: float
    """First angle [rad] at which the hull is stable; not a number if there is none."""
    vanishing: float
    """Angle [rad] beyond `equilibrium` from which the hull does not come back; not a number if that is beyond the
    curve."""
    flooding: float
    """Angle [rad] at which the opening reaches the water; not a number if it does not."""
    largest_arm: float
    """[m], beyond `equilibrium`."""
    largest_angle: float
    """Of the largest arm [rad]."""

    @property
    def range(self) -> float:
        """Range of stability [rad]: from equilibrium to where stability vanishes, the hull floods or the curve ends."""
        ends = [angle for angle in (self.vanishing, self.flooding) if math.isfinite(angle)]
        return min(ends, default=float(self.angles[-1])) - self.equilibrium


class _Heeled:
    """Hull that trims and sinks as it likes at a given heel."""

    def __init__(self, floating: FloatingHull, side: int) -> None:
        self.floating = floating
        self.side = side
        self.base = floating.upright()
        """From where trim and height are sought; of several trims that last it decides which is found."""
        self.pose = self.base

    def arm(self, angle: float) -> float:
        """GZ [m] at a heel [rad]."""
        self.pose = settle(self.floating, self.base._replace(list=self.side * angle), heeled=True)
        _, force = self.floating.evaluate(self.pose)
        return -self.side * float(force[1]) / (self.floating.mass * self.floating.gravity)

    def energy(self) -> float:
        """Potential at the latest angle over the weight [m]."""
        return self.floating.evaluate(self.pose)[0] / (self.floating.mass * self.floating.gravity)

    def freeboard(self, angle: float) -> float:
        """Height of the rim above the water [m] at a heel [rad]."""
        self.arm(angle)
        return self.floating.rim_height(self.pose)


def righting_arm_curve(
    hull: HullSurface,
    mass: float,
    centre_of_gravity: Sequence[float] | NDArray[np.float64],
    angles: Sequence[float] | NDArray[np.float64],
    *,
    density: float = 1025.0,
    gravity: float = 9.81,
    tanks: Sequence[Tank] = (),
    side: int = 1,
) -> RightingArmCurve:
    """Heel a hull and find the moment that turns it back.

    Parameters
    ----------
    hull, mass, centre_of_gravity, density, gravity, tanks
        As of `heavylift.solver.water.hulls.hydrostatics.equilibrium`.
    angles
        Heel [rad], increasing, within 180 degrees to either side.
    side
        1 or -1: whether heel is measured as list or against it.

    Raises
    ------
    InputError
        If the hull sinks or finds no trim at an angle; for angles that do not increase.

    Notes
    -----
    The hull is heeled about its longitudinal axis, then trims about the horizontal axis across it until buoyancy and
    weight have no moment about that axis. The work of a heeling moment is then the change of the potential, from which
    `RightingArmCurve.work` comes without quadrature: the area under ``GZ cos(trim)``.
    """
    if side not in {1, -1}:
        raise InputError(f"{side!r}", source=hull.name, key="side", expected="1 or -1")
    heel = np.asarray(angles, dtype=np.float64)
    if (
        heel.ndim != 1
        or len(heel) < 2
        or not (np.isfinite(heel).all() and (np.diff(heel) > 0.0).all() and np.abs(heel).max() <= math.pi)
    ):
        raise InputError(
            f"{heel.tolist()!r}",
            source=hull.name,
            key="angles",
            expected="two or more increasing angles in rad, from -pi to pi",
        )
    heeled = _Heeled(FloatingHull(hull, mass, centre_of_gravity, density, gravity, tanks), side)
    rows = np.full((4, len(heel)), np.nan)
    outwards = int(np.abs(heel).argmin())
    flooding = _fill(heeled, heel, rows, range(outwards, len(heel)))
    if math.isfinite(rows[0, outwards]):
        _start_from(heeled, heel, rows, outwards)
        _fill(heeled, heel, rows, range(outwards - 1, -1, -1))
    return _curve(heeled, heel, rows, flooding)


def _fill(
    heeled: _Heeled, angles: NDArray[np.float64], rows: NDArray[np.float64], order: Sequence[int]
) -> float:
    """Fill arm, trim, height and energy in the given order until the hull floods; return the angle of that."""
    for n in order:
        angle = float(angles[n])
        arm = heeled.arm(angle)
        if heeled.floating.rim_height(heeled.pose) < 0.0:
            if heeled.freeboard(heeled.side * heeled.base.list) < 0.0:
                return angle
            return _root(heeled.freeboard, heeled.side * heeled.base.list, angle)
        rows[:, n] = arm, heeled.pose.trim, heeled.pose.height, heeled.energy()
        heeled.base = heeled.pose
    return math.nan


def _start_from(heeled: _Heeled, angles: NDArray[np.float64], rows: NDArray[np.float64], n: int) -> None:
    """Seek further positions from that of a row."""
    heeled.base = Pose(float(rows[2, n]), heeled.side * float(angles[n]), float(rows[1, n]))


def _root(function: Callable[[float], float], start: float, end: float) -> float:
    """Angle [rad] at which a function changes its sign between two angles."""
    from scipy.optimize import brentq

    return float(brentq(function, start, end, xtol=_ROOT))


def _zero_of_arm(heeled: _Heeled, angles: NDArray[np.float64], rows: NDArray[np.float64], n: int) -> float:
    """Angle [rad] at which the arm changes its sign between a row and the next."""
    # from the row nearer to upright, from which the other one was found
    _start_from(heeled, angles, rows, n if abs(angles[n]) <= abs(angles[n + 1]) else n + 1)
    return _root(heeled.arm, float(angles[n]), float(angles[n + 1]))


def _curve(
    heeled: _Heeled, angles: NDArray[np.float64], rows: NDArray[np.float64], flooding: float
) -> RightingArmCurve:
    """Find the particular angles and put the curve together."""
    known = np.flatnonzero(np.isfinite(rows[0]))
    if not known.size:
        raise InputError(
            f"floods at a heel of {math.degrees(flooding):.4g} degrees",
            source=heeled.floating.hull.name,
            key="angles",
            expected="an angle at which the rim of its opening is dry",
        )
    level = np.where(np.abs(rows[0, known]) <= _ZERO * heeled.floating.size, 0.0, rows[0, known])
    positive = level > 0.0
    stable, vanishing = math.nan, math.nan
    rising = np.flatnonzero(~positive[:-1] & positive[1:])
    if rising.size:
        n = rising[0]
        stable = float(angles[known[n]])
        if level[n] != 0.0:
            stable = _zero_of_arm(heeled, angles, rows, int(known[n]))
    first = int(rising[0]) + 1 if rising.size else 0
    falling = np.flatnonzero(positive[first:-1] & ~positive[first + 1 :]) + first
    last = len(level) - 1
    if falling.size:
        n = falling[0]
        vanishing = float(angles[known[n + 1]])
        if level[n + 1] != 0.0:
            vanishing = _zero_of_arm(heeled, angles, rows, int(known[n]))
        last = int(n)
    top = first + int(level[first : last + 1].argmax())
    _start_from(heeled, angles, rows, int(known[top]))
    ends = np.append(angles[known], flooding) if math.isfinite(flooding) else angles[known]
    best, largest = _largest(heeled, ends, top, float(level[top]))
    first = int(rising[0]) if rising.size else 0
    _start_from(heeled, angles, rows, int(known[first]))
    heeled.arm(stable if math.isfinite(stable) else float(angles[known[0]]))
    return RightingArmCurve(
        angles=angles,
        side=heeled.side,
        arms=rows[0],
        trims=rows[1],
        heights=rows[2],
        work=rows[3] - heeled.energy(),
        equilibrium=stable,
        vanishing=vanishing,
        flooding=flooding,
        largest_arm=largest,
        largest_angle=best,
    )


def _largest(heeled: _Heeled, angles: NDArray[np.float64], top: int, arm: float) -> tuple[float, float]:
    """Angle [rad] and value [m] of the largest arm between the neighbours of an angle that has a large one."""
    from scipy.optimize import minimize_scalar

    low, high = (float(angles[min(max(k, 0), len(angles) - 1)]) for k in (top - 1, top + 1))
    found = minimize_scalar(lambda angle: -heeled.arm(angle), bounds=(low, high), method="bounded")
    if -float(found.fun) > arm:
        return float(found.x), -float(found.fun)
    return float(angles[top]), arm
