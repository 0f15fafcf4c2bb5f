"""Hydrostatics of a rigid hull in still water: floating position, figures, righting arm over the angle of heel.

Weight and buoyancy both have a potential, so a floating position that lasts is a minimum of their sum. Newton's method
with the exact stiffness finds it in a few steps; where the stiffness is not positive it goes downhill. The righting arm
is that with free trim and constant displacement.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import records
from heavylift.solver.water.hulls.clipping import Clip, buoyancy_stiffness, clip_surface_now

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_surface import HullSurface

__all__ = [
    "FloatingHull",
    "FloatingPosition",
    "Pose",
    "RightingArmCurve",
    "Tank",
    "equilibrium",
    "figures_at",
    "righting_arm_curve",
    "settle",
    "up_direction",
]


# ---- the potential of a hull and its minimum ----


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
    given a small list or trim, and continues from there.
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


# ---- floating position and figures ----


@dataclass(frozen=True, eq=False)
class FloatingPosition:
    """Where a hull floats, and what holds it there.

    Lengths along the hull are in the axes of the body: x along, y across, z up; heights above the keel are measured
    along z from the lowest point of the hull.
    """

    pose: Pose
    """Height of the body's origin above the water [m], list and trim [rad]."""
    level: float
    """Height of the water in the world [m]."""
    mass: float
    """Displacement [kg], tanks included."""
    volume: float
    """Displaced volume [m^3]."""
    keel: float
    """Lowest z of the hull [m]."""
    marks: tuple[float, float]
    """Where the drafts aft and forward are read, x [m]."""
    draft: float
    """At the middle of the marks on the centre line [m], along z of the body from the keel."""
    draft_aft: float
    draft_forward: float
    """At the marks [m]."""
    freeboard: float
    """Height of the lowest point of the opening above the water [m]; infinite for a closed hull."""
    centre_of_gravity: NDArray[np.float64]
    """With tanks [m], shape (3,)."""
    centre_of_buoyancy: NDArray[np.float64]
    """[m], shape (3,)."""
    centre_of_flotation: NDArray[np.float64]
    """Of the water plane [m], shape (3,)."""
    waterplane_area: float
    """[m^2]."""
    wetted_area: float
    """[m^2]."""
    BM_T: float
    BM_L: float
    """Metacentric radii [m]: second moments of the water plane about the horizontal axes along and across through its
    centre, over the volume."""
    GM_T_loss: float
    GM_L_loss: float
    """What free surfaces of tanks take from the metacentric heights [m]: their moment over the displacement, times the
    cosine of list or trim."""
    GM_T: float
    GM_L: float
    """Metacentric heights [m]: ``BM`` less the height of the centre of gravity above that of buoyancy, less the free
    surface."""
    GM_T_upright: float
    """Without list and trim at the same displacement [m]; negative if the list is an angle of loll."""

    @property
    def KB(self) -> float:
        """Height of the centre of buoyancy above the keel [m]."""
        return float(self.centre_of_buoyancy[2]) - self.keel

    @property
    def KG(self) -> float:
        """Height of the centre of gravity above the keel [m], without free surfaces."""
        return float(self.centre_of_gravity[2]) - self.keel

    @property
    def LCB(self) -> float:
        """Place of the centre of buoyancy along the hull, x [m]."""
        return float(self.centre_of_buoyancy[0])

    @property
    def LCF(self) -> float:
        """Place of the centre of flotation along the hull, x [m]."""
        return float(self.centre_of_flotation[0])

    @property
    def trim_by_bow(self) -> float:
        """Draft forward less draft aft [m]."""
        return self.draft_forward - self.draft_aft

    @property
    def mass_per_immersion(self) -> float:
        """Mass that sinks the hull by a unit of length [kg/m]; the tonnes per centimetre are 1e-5 of it."""
        return self.mass / self.volume * self.waterplane_area

    @property
    def moment_to_trim(self) -> float:
        """Mass times lever that changes the trim between the marks [kg m/m]; per cm in t m it is 1e-5 of it."""
        return self.mass * self.GM_L / (self.marks[1] - self.marks[0])


def equilibrium(
    hull: HullSurface,
    mass: float,
    centre_of_gravity: Sequence[float] | NDArray[np.float64],
    *,
    density: float = 1025.0,
    gravity: float = 9.81,
    level: float = 0.0,
    tanks: Sequence[Tank] = (),
    marks: tuple[float, float] | None = None,
) -> FloatingPosition:
    """Find how a hull floats with its masses: height, list and trim without a heading.

    Parameters
    ----------
    hull
        Outside of the hull, of `heavylift.preprocess.hydrodynamics.hull_surface.check_hull`.
    mass
        Without tanks [kg].
    centre_of_gravity
        Without tanks, in the axes of the hull [m], shape (3,).
    density, gravity
        Of the water [kg/m^3], and [m/s^2].
    level
        Height of the still water in the world [m].
    tanks
        Their masses come on top.
    marks
        Where the drafts aft and forward are read, x [m]; default the ends of the hull.

    Raises
    ------
    InputError
        If the hull sinks, capsizes, or floats so that its opening is in the water; for bad numbers.

    Notes
    -----
    The position is one that lasts: where the hull is unstable upright, it is that of the angle of loll, to the side of
    positive list.
    """
    floating = FloatingHull(hull, mass, centre_of_gravity, density, gravity, tanks)
    if not math.isfinite(level):
        raise InputError(f"{level!r}", source=hull.name, key="level", expected="a height in m")
    low, high = hull.surface.bounds[:, 0]
    ends = (float(low), float(high)) if marks is None else marks
    if not (math.isfinite(ends[0]) and math.isfinite(ends[1]) and ends[0] < ends[1]):
        raise InputError(f"{marks!r}", source=hull.name, key="marks", expected="x aft below x forward, in m")
    start = floating.upright()
    upright = figures_at(floating, start, level, ends, math.nan)
    pose = settle(floating, start)
    dry = floating.rim_height(pose)
    if dry < 0.0:
        raise InputError(
            f"floods: at a list of {math.degrees(pose.list):.4g} and a trim of {math.degrees(pose.trim):.4g} degrees "
            f"the rim of its opening is {-dry:.4g} m under water",
            source=hull.name,
            key="mass",
            expected="a floating position with a dry rim, or a closed hull",
        )
    return figures_at(floating, pose, level, ends, upright.GM_T)


def figures_at(
    floating: FloatingHull, pose: Pose, level: float, marks: tuple[float, float], GM_T_upright: float
) -> FloatingPosition:
    """Hydrostatic figures of a hull in a given position.

    Parameters
    ----------
    floating
        Hull and masses.
    pose
        Position, not necessarily of equilibrium.
    level
        Height of the water [m].
    marks
        Where the drafts are read, x [m].
    GM_T_upright
        To be noted [m].
    """
    volume = floating.volume(pose)
    out, rotation = floating.out, pose.rotation
    # below or above the origin, on the water plane, world axes -> body axes
    origin = np.array([0.0, 0.0, -pose.height])
    buoyancy = rotation.T @ (out.moment / volume + origin)
    area = out.plane_area
    cx, cy = (out.plane_x / area, out.plane_y / area) if area > 0.0 else (0.0, 0.0)
    flotation = rotation.T @ (np.array([cx, cy, 0.0]) + origin)
    radius_T = (out.plane_yy - out.plane_y * cy) / volume
    radius_L = (out.plane_xx - out.plane_x * cx) / volume
    lever = float(rotation[2] @ (floating.centre_of_gravity - buoyancy))
    loss = floating.free_surface / floating.mass
    loss_T, loss_L = loss[0] * math.cos(pose.list), loss[1] * math.cos(pose.trim)
    keel = float(floating.hull.surface.bounds[0, 2])
    up = rotation[2]
    drafts = [
        -(pose.height + float(up[0]) * x) / float(up[2]) - keel for x in (*marks, 0.5 * (marks[0] + marks[1]))
    ]
    return FloatingPosition(
        pose=pose,
        level=level,
        mass=floating.mass,
        volume=float(out.volume),
        keel=keel,
        marks=marks,
        draft=drafts[2],
        draft_aft=drafts[0],
        draft_forward=drafts[1],
        freeboard=floating.rim_height(pose),
        centre_of_gravity=floating.centre_of_gravity,
        centre_of_buoyancy=buoyancy,
        centre_of_flotation=flotation,
        waterplane_area=float(area),
        wetted_area=float(out.wetted_area),
        BM_T=float(radius_T),
        BM_L=float(radius_L),
        GM_T_loss=float(loss_T),
        GM_L_loss=float(loss_L),
        GM_T=float(radius_T) - lever - float(loss_T),
        GM_L=float(radius_L) - lever - float(loss_L),
        GM_T_upright=GM_T_upright,
    )


# ---- righting arm ----


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
