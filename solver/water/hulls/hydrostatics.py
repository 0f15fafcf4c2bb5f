"""Floating position of a hull in still water and its hydrostatic figures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.water.hulls.floating import FloatingHull, Pose, Tank, settle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.hull_surface import HullSurface

__all__ = ["FloatingPosition", "Tank", "equilibrium", "figures_at"]


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
