"""Hydrostatics of one hull as files: floating position, righting arms, a plot, and a table for a person."""

from __future__ import annotations

import csv
import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.pipeline.pictures.hull_plots import righting_arm_plot
from heavylift.pipeline.results.storage import replacing, write_json
from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
from heavylift.preprocess.surfaces.touching_faces import touching_area
from heavylift.solver.water.hulls.hydrostatics import (
    FloatingPosition,
    RightingArmCurve,
    equilibrium,
    righting_arm_curve,
)

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.water.hulls.hydrostatics import Tank

__all__ = ["HydrostaticsReport", "hydrostatics_lines", "hydrostatics_report"]

DEFAULT_ANGLES = np.radians(np.arange(0.0, 80.5, 1.0))
"""Heel [rad] of the curve if none is given."""

_LEVEL = 1e-9  # rad: less list is none
_NOISE = 1e-9  # smaller numbers are written as zero for a person
_ROWS = 16  # of righting arms for a person


@dataclass(frozen=True, eq=False)
class HydrostaticsReport:
    """What `hydrostatics_report` found and wrote."""

    name: str
    position: FloatingPosition
    curve: RightingArmCurve
    figures: dict[str, float | None]
    """By name, SI units and radians; None for what does not exist. The content of ``hydrostatics.json``."""
    files: tuple[Path, ...]


def hydrostatics_report(
    name: str,
    surface: TriangleSurface,
    mass: float,
    centre_of_gravity: Sequence[float],
    folder: Path,
    *,
    density: float = 1025.0,
    gravity: float = 9.81,
    level: float = 0.0,
    tanks: Sequence[Tank] = (),
    open_deck: float | None = None,
    marks: tuple[float, float] | None = None,
    angles: Sequence[float] | None = None,
    key: str = "surface",
) -> HydrostaticsReport:
    """Float a hull, heel it, and write what comes out.

    Parameters
    ----------
    name
        Of the hull; begins the names of the files.
    surface
        Outside of the hull in its axes [m], x ahead, y to port, z up.
    mass, centre_of_gravity
        Without tanks [kg], [m].
    folder
        For the files; made if absent.
    density, gravity, level
        Of the water [kg/m^3], [m/s^2], and the height of its surface in the world [m].
    tanks
        On top of the mass.
    open_deck
        See `heavylift.preprocess.hydrodynamics.hull_surface.check_hull`.
    marks
        Where drafts are read, x [m]; default the ends of the hull.
    angles
        Heel [rad] of the curve, increasing; measured to the side to which the hull lists. Default 0 to 80 degrees.
    key
        What messages call the surface.

    Returns
    -------
    HydrostaticsReport
        With the files ``NAME_hydrostatics.json``, ``NAME_hydrostatics.csv``, ``NAME_righting_arms.csv``,
        ``NAME_righting_arms.png``.

    Raises
    ------
    InputError
        If the surface is no hull, or does not float.
    """
    hull = check_hull(surface, open_deck=open_deck, key=key)
    position = equilibrium(
        hull,
        mass,
        centre_of_gravity,
        density=density,
        gravity=gravity,
        level=level,
        tanks=tanks,
        marks=marks,
    )
    curve = righting_arm_curve(
        hull,
        mass,
        centre_of_gravity,
        DEFAULT_ANGLES if angles is None else np.asarray(angles),
        density=density,
        gravity=gravity,
        tanks=tanks,
        side=-1 if position.pose.list < -_LEVEL else 1,
    )
    figures = _figures(position, curve)
    if touching_area(surface) > 0.0:
        figures["wetted_area"] = None  # faces between parts are dry
    paths = (
        folder / f"{name}_hydrostatics.json",
        folder / f"{name}_hydrostatics.csv",
        folder / f"{name}_righting_arms.csv",
        folder / f"{name}_righting_arms.png",
    )
    water = {"density": density, "gravity": gravity, "level": level}
    loads = [
        {
            "name": tank.name,
            "mass": tank.mass,
            "point": list(tank.point),
            "free_surface": list(tank.free_surface),
        }
        for tank in tanks
    ]
    write_json(paths[0], {"name": name, "water": water, "tanks": loads, "figures": figures})
    units = {label: unit for label, (_, unit, _) in _FIGURES.items()}
    rows = [[label, "" if value is None else repr(value), units[label]] for label, value in figures.items()]
    _write_csv(paths[1], ["quantity", "value", "unit"], rows)
    table = np.column_stack([curve.angles, curve.arms, curve.work, curve.trims, curve.heights])
    _write_csv(
        paths[2],
        ["heel_rad", "GZ_m", "area_m_rad", "trim_rad", "origin_height_m"],
        [[repr(value) if math.isfinite(value) else "" for value in row] for row in table.tolist()],
    )
    with replacing(paths[3]) as temporary:
        temporary.write_bytes(righting_arm_plot(f"{name}: righting arm", curve, position))
    return HydrostaticsReport(name, position, curve, figures, paths)


_FIGURES: dict[str, tuple[str, str, float]] = {
    # name: words, unit, factor to the unit in which a person reads it (see _READ_IN)
    "displacement": ("displacement", "kg", 1e-3),
    "volume": ("displaced volume", "m^3", 1.0),
    "draft": ("draft amidships", "m", 1.0),
    "draft_aft": ("draft aft", "m", 1.0),
    "draft_forward": ("draft forward", "m", 1.0),
    "trim_by_bow": ("trim by the bow", "m", 1.0),
    "trim": ("trim angle", "rad", 180.0 / math.pi),
    "list": ("list", "rad", 180.0 / math.pi),
    "origin_z": ("origin of the hull, z in the world", "m", 1.0),
    "freeboard": ("rim of the opening above water", "m", 1.0),
    "KB": ("centre of buoyancy above keel, KB", "m", 1.0),
    "LCB": ("centre of buoyancy, x (LCB)", "m", 1.0),
    "TCB": ("centre of buoyancy, y", "m", 1.0),
    "KG": ("centre of gravity above keel, KG", "m", 1.0),
    "LCG": ("centre of gravity, x", "m", 1.0),
    "TCG": ("centre of gravity, y", "m", 1.0),
    "BM_T": ("transverse metacentric radius, BM", "m", 1.0),
    "BM_L": ("longitudinal metacentric radius", "m", 1.0),
    "GM_T": ("transverse metacentric height, GM", "m", 1.0),
    "GM_L": ("longitudinal metacentric height", "m", 1.0),
    "GM_T_loss": ("free surfaces reduce GM by", "m", 1.0),
    "GM_L_loss": ("free surfaces reduce longitudinal GM by", "m", 1.0),
    "GM_T_upright": ("GM without list and trim", "m", 1.0),
    "waterplane_area": ("area of the water plane", "m^2", 1.0),
    "LCF": ("centre of flotation, x (LCF)", "m", 1.0),
    "wetted_area": ("wetted area", "m^2", 1.0),
    "mass_per_immersion": ("immersion", "kg/m", 1e-5),
    "moment_to_trim": ("moment to change trim", "kg", 1e-5),
    "equilibrium_angle": ("curve: stable at", "rad", 180.0 / math.pi),
    "largest_arm": ("curve: largest GZ", "m", 1.0),
    "largest_arm_angle": ("curve: at", "rad", 180.0 / math.pi),
    "vanishing_angle": ("curve: stability vanishes at", "rad", 180.0 / math.pi),
    "flooding_angle": ("curve: opening floods at", "rad", 180.0 / math.pi),
    "range": ("curve: range of stability", "rad", 180.0 / math.pi),
    "area_30": ("curve: area up to 30 degrees", "m rad", 1.0),
    "area_40": ("curve: area up to 40 degrees", "m rad", 1.0),
}

_READ_IN = {"kg": "t", "rad": "deg", "kg/m": "t/cm"}


def _figures(position: FloatingPosition, curve: RightingArmCurve) -> dict[str, float | None]:
    """Collect the figures in the order of `_FIGURES`, in SI units."""
    values = {
        "displacement": position.mass,
        "trim": position.pose.trim,
        "list": position.pose.list,
        "origin_z": position.level + position.pose.height,
        "TCB": position.centre_of_buoyancy[1],
        "LCG": position.centre_of_gravity[0],
        "TCG": position.centre_of_gravity[1],
        "equilibrium_angle": curve.equilibrium,
        "largest_arm": curve.largest_arm,
        "largest_arm_angle": curve.largest_angle,
        "vanishing_angle": curve.vanishing,
        "flooding_angle": curve.flooding,
        "range": curve.range,
        "area_30": _area(curve, math.radians(30.0)),
        "area_40": _area(curve, math.radians(40.0)),
    }
    found = {
        label: float(values[label] if label in values else getattr(position, label)) for label in _FIGURES
    }
    return {label: value if math.isfinite(value) else None for label, value in found.items()}


def _area(curve: RightingArmCurve, angle: float) -> float:
    """Area [m rad] under the curve from equilibrium to an angle [rad], by cubic interpolation of the work."""
    from scipy.interpolate import CubicHermiteSpline

    known = np.isfinite(curve.arms)
    angles = curve.angles[known]
    if len(angles) < 2 or not angles[0] <= angle <= angles[-1]:
        return math.nan
    slope = curve.arms[known] * np.cos(curve.trims[known])
    return float(CubicHermiteSpline(angles, curve.work[known], slope)(angle))


def hydrostatics_lines(report: HydrostaticsReport) -> list[str]:
    """Table of the figures and of the righting arms, with the units in which they are read."""
    lines = [f"{report.name}: hydrostatics", ""]
    for label, (words, unit, factor) in _FIGURES.items():
        value = report.figures[label]
        if value is not None:
            read = "t m/cm" if label == "moment_to_trim" else _READ_IN.get(unit, unit)
            shown = value * factor if abs(value) > _NOISE else 0.0
            lines.append(f"  {words:<42s}{shown:>14.6g}  {read}")
        elif label == "wetted_area":
            lines.append(f"  {words:<42s}{'–':>14s}  its parts touch: faces between them are dry")
    lines += ["", f"  {'heel [deg]':>10s}{'GZ [m]':>12s}{'area [m rad]':>14s}{'trim [deg]':>12s}"]
    curve = report.curve
    rows = np.column_stack([np.degrees(curve.angles), curve.arms, curve.work, np.degrees(curve.trims)])
    rows = rows[np.isfinite(curve.arms)]
    rows[np.abs(rows) < _NOISE] = 0.0
    every = max(1, round(len(rows) / _ROWS))
    for angle, arm, work, trim in rows[::every]:
        lines.append(f"  {angle:>10.4g}{arm:>12.5f}{work:>14.5f}{trim:>12.4f}")
    return [*lines, "", *(f"  written: {path}" for path in report.files)]


def _write_csv(path: Path, header: list[str], rows: list[list[str]]) -> None:
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(rows)
