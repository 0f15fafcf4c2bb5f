"""``heavylift hydrostatics``: how the hulls of a case float, and their righting arms."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.loading import Loading, pulling, scene_loading, sides_of
from heavylift.pipeline.commands.scene import choose_hulls, load_sea_case
from heavylift.solver.scene.sea import LinearRestoring

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.commands.scene import SeaCase
    from heavylift.pipeline.log import Log
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.scene.sea import Hull, Sea

__all__ = ["hull_loading", "hydrostatics_command", "linear_figures"]


def hydrostatics_command(
    path: Path,
    *,
    out: Path | None = None,
    overrides: Sequence[str] = (),
    hulls: Sequence[str] = (),
    log: Log,
) -> tuple[dict[str, Any], list[str]]:
    """Float the hulls of a case and write ``hydrostatics/``.

    Returns
    -------
    tuple
        Document of all hulls, and the tables for a person.

    Raises
    ------
    InputError
        If the case has no hulls, or none of those that were asked for has a surface or a float plane.
    """
    from heavylift.pipeline.assemble.hulls import frame_origin, liquid_at_start
    from heavylift.pipeline.stages.hydrostatics import hydrostatics_lines, hydrostatics_report
    from heavylift.pipeline.stages.lock import locked
    from heavylift.preprocess.surfaces.triangle_surface import placed

    found = load_sea_case(path, out=out, overrides=overrides, log=log)
    sea, water = found.sea, found.sea.water
    folder = found.folder.stage("hydrostatics")
    chosen = [hull for hull in choose_hulls(found, hulls) if hull.restoring is not None]
    if not chosen:
        raise InputError(
            "no hull with buoyancy",
            source=found.case.file,
            key="hulls",
            expected="a hull with a surface or a float plane",
        )
    entries: list[dict[str, Any]] = []
    lines: list[str] = []
    with locked(found.folder.root):
        for hull in chosen:
            # a person reads places in the coordinates of the geometry
            origin = frame_origin(found.case, hull.body)
            loading = hull_loading(found.scene, sea, hull.body)
            tanks = [liquid_at_start(tank, water, origin) for tank in sea.tanks if tank.hull == hull.body]
            entry: dict[str, Any] = {
                "hull": hull.body,
                "carries": list(loading.bodies),
                "parts": {name: mass for name, (mass, _) in loading.parts.items()},
                "left_out": list(loading.left_out),
                "tanks": [{"name": tank.name, "mass": tank.mass} for tank in tanks],
            }
            surface = _surface(found, hull)
            if surface is None:
                assert isinstance(hull.restoring, LinearRestoring)
                buoyancy = hull.restoring.centre_of_buoyancy + origin
                figures = linear_figures(
                    hull.restoring, buoyancy, loading.centre + origin, loading.mass, tanks, water.density
                )
                entry |= {"restoring": "linear", "figures": figures, "files": []}
                lines += [f"{hull.body}: float plane (linear restoring), no righting arms", ""]
                lines += [f"  {name:<42s}{value:>14.6g}  {_UNITS[name]}" for name, value in figures.items()]
            else:
                # a free surface without water is none
                full = [tank for tank in tanks if tank.mass > 0.0]
                report = hydrostatics_report(
                    hull.body,
                    placed(surface, position=origin),
                    loading.mass,
                    (loading.centre + origin).tolist(),
                    folder,
                    density=water.density,
                    gravity=water.gravity,
                    level=water.level,
                    tanks=full,
                    open_deck=None if hull.open_deck is None else hull.open_deck + float(origin[2]),
                    key=f"surface of hull {hull.body}",
                )
                entry |= {
                    "restoring": "surface",
                    "figures": report.figures,
                    "files": [str(file) for file in report.files],
                }
                lines += hydrostatics_lines(report)
            lines += ["", *_words(entry), ""]
            entries.append(entry)
    return {"case": found.case.name, "hulls": entries}, lines[:-1]


def hull_loading(scene: Scene, sea: Sea, name: str) -> Loading:
    """What a hull carries at the start; what hangs on ropes or springs, lines and fenders is named in `left_out`."""
    found = scene_loading(scene, [hull.body for hull in sea.hulls], name)
    left = [*found.left_out]
    left += [f"line {line.name}" for line in sea.lines if name in (line.body_a, line.body_b)]
    left += [f"fender {one.name}" for one in sea.fenders if name in (one.body_a, one.body_b)]
    left += _ropes(scene, {name, *found.bodies})
    return replace(found, left_out=tuple(left))


def linear_figures(
    restoring: LinearRestoring,
    buoyancy: NDArray[np.float64],
    gravity_centre: NDArray[np.float64],
    mass: float,
    tanks: Sequence[Any],
    density: float,
) -> dict[str, float]:
    """Displacement and metacentric heights of a float plane [kg], [m^3], [m^2], [m].

    Parameters
    ----------
    restoring
        Volume and moments of the float plane.
    buoyancy, gravity_centre
        Centres of buoyancy, and of gravity without tanks [m], shape (3,), in the axes of the points of tanks.
    mass
        Without tanks [kg].
    tanks
        With mass, point and free surface, none if empty.
    density
        Of the water [kg/m^3].
    """
    moment = mass * gravity_centre + sum((tank.mass * np.asarray(tank.point) for tank in tanks), np.zeros(3))
    mass = mass + sum(tank.mass for tank in tanks)
    centre = moment / mass
    A, Sx, Sy, Ixx, Iyy, _ = restoring.waterplane
    volume = restoring.volume
    # moments of the water plane about the axes through its centre; x x is what resists trim
    lost = [sum(tank.free_surface[k] for tank in tanks) / (density * volume) for k in (0, 1)]
    arm = float(centre[2] - buoyancy[2])
    about_x, about_y = Iyy - Sy * Sy / A, Ixx - Sx * Sx / A
    return {
        "mass": mass,
        "displacement": density * volume,
        "volume": volume,
        "waterplane_area": float(A),
        "BM_T": float(about_x) / volume,
        "BM_L": float(about_y) / volume,
        "KG_above_buoyancy": arm,
        "GM_T": float(about_x) / volume - arm - lost[0],
        "GM_L": float(about_y) / volume - arm - lost[1],
    }


def _surface(found: SeaCase, hull: Hull) -> TriangleSurface | None:
    """In the frame of the body: also that of a hull whose linear restoring was made from one; None without one."""
    if not isinstance(hull.restoring, LinearRestoring):
        return hull.restoring
    if found.case.hulls[hull.body].surface is None:
        return None
    from heavylift.pipeline.assemble.hulls import hull_surface

    return hull_surface(found.case, hull.body, found.folder)


_UNITS = {
    "mass": "kg",
    "displacement": "kg",
    "volume": "m^3",
    "waterplane_area": "m^2",
    "BM_T": "m",
    "BM_L": "m",
    "KG_above_buoyancy": "m",
    "GM_T": "m",
    "GM_L": "m",
}


def _ropes(scene: Scene, group: set[str]) -> list[str]:
    """Ropes, springs and other forces between these bodies and others; none that only watches or only rests."""
    found = []
    for one in pulling(scene):
        sides = sides_of(one)
        if sides & group and sides - group:
            word = (
                "rope" if hasattr(one, "path") else str(getattr(type(one), "WORD", "force")).replace("_", " ")
            )
            found.append(f"{word} {one.name}")
    return found


def _words(entry: dict[str, Any]) -> list[str]:
    """What was counted and what was not."""
    lines = []
    if entry["carries"]:
        parts = {name: f" ({mass * 1e-3:.6g} t of it)" for name, mass in entry["parts"].items()}
        lines.append(f"  carries: {', '.join(name + parts.get(name, '') for name in entry['carries'])}")
    if entry["tanks"]:
        tanks = ", ".join(f"{tank['name']} {tank['mass'] * 1e-3:.6g} t" for tank in entry["tanks"])
        lines.append(f"  tanks: {tanks}")
    if entry["left_out"]:
        lines.append(f"  not counted: {', '.join(entry['left_out'])}")
    return lines
