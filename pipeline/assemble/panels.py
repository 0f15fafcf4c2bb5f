"""From the tables of panels of a case to a structure of shells and beams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection
    from heavylift.pipeline.case.geometry import MaterialSection
    from heavylift.pipeline.case.panels import OpeningSection, PanelsGeometry
    from heavylift.preprocess.finite_elements.material import Material
    from heavylift.preprocess.structures.panels import Opening
    from heavylift.preprocess.structures.structure import Structure

__all__ = ["part_material", "structure_of_panels"]


def part_material(body: FlexibleBodySection, own: MaterialSection | None, name: str, key: str) -> Material:
    """Material of a part: what it gives itself, the rest as of its body.

    Raises
    ------
    InputError
        What neither gives, and a material that does not exist, with the name of the body and the key.
    """
    from heavylift.preprocess.finite_elements.material import DENSITY_LIMIT, WAVE_SPEEDS, Material

    given = {**(body.material.given() if body.material else {}), **(own.given() if own else {})}
    missing = [word for word in ("young_modulus", "poisson_ratio", "density") if word not in given]
    if missing:
        raise InputError(
            f"no {missing[0]!r}",
            source=name,
            key=key,
            expected="young_modulus, poisson_ratio and density",
        )
    made = Material(**given)
    speed = (made.young_modulus / made.density) ** 0.5
    if not WAVE_SPEEDS[0] <= speed <= WAVE_SPEEDS[1] or made.density > DENSITY_LIMIT:
        raise InputError(
            f"E {made.young_modulus:.6g} Pa with {made.density:.6g} kg/m^3, where waves run at {speed:.3g} m/s",
            source=name,
            key=key,
            expected="a material that exists; steel has 2.1e11 Pa, 7850 kg/m^3 and 5172 m/s",
        )
    return made


def structure_of_panels(
    case: Case, name: str, body: FlexibleBodySection, geometry: PanelsGeometry
) -> Structure:
    """Mesh of the plates, stiffeners and lugs of a body."""
    from heavylift.preprocess.structures.panels import Lug, Plate, Stiffener, mesh_panels, repeated
    from heavylift.preprocess.structures.sections import profile

    def material(own: MaterialSection | None) -> Material:
        return part_material(body, own, name, "material")

    plates = [
        Plate(
            key,
            material(one.material),
            one.thickness,
            polygons=repeated(one.corners, one.step, one.count) if one.corners else (),
            faces=one.faces,
            across=None if one.across is None else np.array(one.across),
            at=one.at,
            offset=one.offset,
            nonstructural_mass=one.nonstructural_mass,
            openings=tuple(hole for opening in one.openings for hole in _openings(opening)),
        )
        for key, one in geometry.plates.items()
    ]
    stiffeners = []
    for key, beam in geometry.stiffeners.items():
        section, foot = profile(beam.section.shape, **beam.section.measures())
        stiffeners.append(
            Stiffener(
                key,
                material(beam.material),
                section,
                repeated(beam.line, beam.step, beam.count),
                np.array(beam.web),
                plate=beam.plate or "",
                foot=foot,
                flange=None if beam.flange is None else np.array(beam.flange),
            )
        )
    lugs = [
        Lug(
            key,
            material(lug.material),
            lug.thickness,
            np.array(lug.foot),
            np.array(lug.along),
            np.array(lug.normal),
            length=lug.length,
            height=lug.height,
            radius=lug.radius,
            hole=lug.hole,
            bracket=lug.bracket or 0.0,
        )
        for key, lug in geometry.lugs.items()
    ]
    assert body.mesh.size is not None
    file = None if geometry.file is None else case.folder / geometry.file
    return mesh_panels(
        plates, stiffeners, lugs, size=body.mesh.size, file=file, scale=geometry.scale, name=name
    )


def _openings(one: OpeningSection) -> list[Opening]:
    from heavylift.preprocess.structures.panels import Opening, repeated

    width, height = (one.diameter or one.width, one.diameter or one.height)
    assert width is not None
    assert height is not None
    direction = None if one.direction is None else np.array(one.direction)
    return [
        Opening(points[0], width, height, direction) for points in repeated([one.centre], one.step, one.count)
    ]
