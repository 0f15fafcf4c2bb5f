"""From the hulls of a case to what the solver integrates, and to panels for a database."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.surfaces import stored_surface
from heavylift.pipeline.assemble.water import water_of
from heavylift.pipeline.case.places import located
from heavylift.solver.scene import sea as seas

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.hulls import HullSection
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.preprocess.hydrodynamics.hull_panels import PanelHydrostatics
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    from heavylift.solver.water.hulls.hydrostatics import FloatingPosition, Tank

__all__ = [
    "assemble_hulls",
    "frame_origin",
    "hull_surface",
    "hull_tanks",
    "linear_from_panels",
    "linear_restoring",
    "resting_position",
    "upright_position",
]

LEVEL = 2e-3
"""List or trim [rad] at rest, beyond which a hull is not upright."""


def assemble_hulls(case: Case, sides: Mapping[str, Side], folder: OutputFolder) -> tuple[seas.Hull, ...]:
    """Hulls of a case in the frames of their bodies.

    Raises
    ------
    InputError
        If a surface is no hull, or linear restoring is asked for and the hull does not rest upright.
    """
    found = []
    for name, section in case.hulls.items():
        side = sides[name]
        with located(case, f"hulls.{name}"):
            found.append(
                seas.Hull(
                    body=name,
                    restoring=_restoring(case, name, section, folder),
                    reference=side.local(section.reference),
                    damping=np.zeros((6, 6)) if section.damping is None else np.array(section.damping),
                    quadratic_damping=np.array(section.quadratic_damping, dtype=float),
                    low_pass=section.low_pass,
                    open_deck=None
                    if section.open_deck is None
                    else section.open_deck - float(side.origin[2]),
                )
            )
    return tuple(found)


def frame_origin(case: Case, name: str) -> NDArray[np.float64]:
    """Origin of the frame of a rigid body in the coordinates of its geometry [m]."""
    body = case.bodies[name]
    assert body.type == "rigid"
    return np.array(body.centre_of_mass) if body.frame.origin == "centre_of_mass" else np.zeros(3)


def hull_surface(case: Case, name: str, folder: OutputFolder) -> TriangleSurface:
    """Surface of a hull in the frame of its body."""
    from heavylift.preprocess.surfaces.triangle_surface import placed

    wanted = case.hulls[name].surface
    index = next(i for i, surface in enumerate(case.surfaces) if surface.name == wanted)
    surface = stored_surface(case, index, folder).surface
    return placed(surface, position=-frame_origin(case, name))


def hull_tanks(case: Case, name: str) -> tuple[Tank, ...]:
    """Tanks of a hull as they are at the start, in the frame of its body."""
    from heavylift.solver.water.hulls.hydrostatics import Tank

    origin, found = frame_origin(case, name), []
    for tank in case.tanks:
        if tank.hull != name:
            continue
        density = water_of(case).density if tank.density is None else tank.density
        mass = tank.mass if tank.mass is not None else float(np.interp(0.0, tank.times, tank.masses))
        x, y, z = (float(value) for value in np.array(tank.point) - origin)
        wet = density if mass > 0.0 else 0.0
        surface = (wet * tank.free_surface[0], wet * tank.free_surface[1])
        found.append(Tank(mass, (x, y, z), surface, tank.name))
    return tuple(found)


def resting_position(case: Case, name: str, folder: OutputFolder) -> FloatingPosition:
    """How a hull floats by itself, with its tanks, without waves and lines.

    Raises
    ------
    InputError
        If its surface is no hull, or it does not float.
    """
    from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
    from heavylift.solver.water.hulls.hydrostatics import equilibrium

    section, body, origin = case.hulls[name], case.bodies[name], frame_origin(case, name)
    assert body.type == "rigid"
    deck = None if section.open_deck is None else section.open_deck - float(origin[2])
    hull = check_hull(hull_surface(case, name, folder), open_deck=deck)
    water = water_of(case)
    return equilibrium(
        hull,
        body.mass,
        np.array(body.centre_of_mass) - origin,
        density=water.density,
        gravity=water.gravity,
        level=water.level,
        tanks=hull_tanks(case, name),
    )


def upright_position(case: Case, name: str, folder: OutputFolder) -> FloatingPosition:
    """The same of a hull that floats upright.

    Raises
    ------
    InputError
        If it has a list or a trim.
    """
    position = resting_position(case, name, folder)
    pose = position.pose
    if max(abs(pose.list), abs(pose.trim)) > LEVEL:
        raise InputError(
            f"{name!r} floats with a list of {math.degrees(pose.list):.3g} and a trim of "
            f"{math.degrees(pose.trim):.3g} degrees",
            key="surface",
            expected="a hull that floats upright with its masses and tanks",
        )
    return position


def _restoring(
    case: Case, name: str, section: HullSection, folder: OutputFolder
) -> TriangleSurface | seas.LinearRestoring | None:
    if section.kind == "none":
        return None
    if section.kind == "clipped":
        return hull_surface(case, name, folder)
    if section.linear is None:
        return linear_restoring(case, name, folder)
    origin, linear = frame_origin(case, name), section.linear
    moments = [linear.area, *linear.first_moments, *linear.second_moments]
    return seas.LinearRestoring(
        volume=linear.volume,
        centre_of_buoyancy=np.array(linear.centre_of_buoyancy) - origin,
        reference=np.array(linear.reference) - origin,
        waterplane=np.array(moments, dtype=float),
    )


def linear_restoring(case: Case, name: str, folder: OutputFolder) -> seas.LinearRestoring:
    """Linear restoring of the surface of a hull about the place where it rests upright."""
    from heavylift.preprocess.hydrodynamics.hull_panels import hydrostatics, surface_panels

    height = upright_position(case, name, folder).pose.height
    panels = surface_panels(hull_surface(case, name, folder), level=-height, name=name)
    return linear_from_panels(hydrostatics(panels, 1.0, 1.0, np.zeros(3)), -height)


def linear_from_panels(still: PanelHydrostatics, level: float) -> seas.LinearRestoring:
    """Moments of the water plane from a stiffness about the origin of the water plane, with rho g = 1.

    Parameters
    ----------
    still
        Of panels whose z is measured from the water, about their origin.
    level
        Height of the water in the frame of the body [m].
    """
    C, V, centre = still.stiffness, still.volume, still.centre_of_buoyancy
    lever = V * centre[2]
    # C33 = A, C34 = Sy, C35 = -Sx, C44 = Iyy + V z_B, C55 = Ixx + V z_B, C45 = -Ixy
    moments: Sequence[float] = [C[2, 2], -C[2, 4], C[2, 3], C[4, 4] - lever, C[3, 3] - lever, -C[3, 4]]
    shift = np.array([0.0, 0.0, level])
    return seas.LinearRestoring(
        volume=float(V), centre_of_buoyancy=centre + shift, reference=shift, waterplane=np.array(moments)
    )
