"""From the hulls of a case to the panels and headings that a hydrodynamic database is computed from."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.hulls import frame_origin, hull_surface, upright_position
from heavylift.pipeline.assemble.scene import assemble_rigid
from heavylift.pipeline.assemble.water import water_of
from heavylift.preprocess.hydrodynamics.bem import BemInputs
from heavylift.preprocess.hydrodynamics.hull_panels import (
    HullPanels,
    box_panels,
    hydrostatics,
    surface_panels,
)
from heavylift.preprocess.surfaces.refinement import refined_triangles
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.hulls import ComputeSection, DatabaseSection
    from heavylift.pipeline.case.surfaces import SurfaceSection
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["bem_inputs"]

PARALLEL = math.radians(0.5)
"""Between headings of hulls that share a database [rad]."""
SAME_PLACE = 1e-6
"""Of the extent: how far the mirror image of a corner may be from another corner."""


def bem_inputs(case: Case, section: DatabaseSection, folder: OutputFolder) -> BemInputs:
    """What a database is computed from.

    The axes of the database are those of the first hull at the start, its origin above or below that of its frame.
    Every hull lies upright as deep as it floats by itself, with its tanks, where it is at the start.

    Raises
    ------
    InputError
        If a hull does not float upright, several do not head the same way, or hulls that are said to be symmetric are
        not.
    """
    assert section.compute is not None
    compute, water = section.compute, water_of(case)
    places = {name: _place(case, name) for name in section.hulls}
    origin, heading = places[section.hulls[0]]
    turn = np.array([[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]])
    hulls, references = [], []
    for index, name in enumerate(section.hulls):
        place, own = places[name]
        off = math.remainder(own - heading, 2.0 * math.pi)
        if abs(off) > PARALLEL:
            raise InputError(
                f"{name!r} heads {math.degrees(off):.4g} degrees off {section.hulls[0]!r}",
                key=f"hulls.{index}",
                expected="hulls of one database that head the same way at the start",
            )
        x, y = (float(value) for value in turn @ (place - origin))
        height = upright_position(case, name, folder).pose.height
        hulls.append(_panels(case, name, compute, folder, height).translated(x, y, name=name))
        reference = np.array(case.hulls[name].reference) - frame_origin(case, name)
        references.append(reference + np.array([x, y, height]))
    if compute.symmetric:
        for hull in hulls:
            _check_symmetry(hull)
    headings = compute.headings or _headings(compute)
    steps = compute.frequencies
    return BemInputs(
        hulls=tuple(hulls),
        omega=np.linspace(steps.first, steps.last, steps.count),
        headings=np.array(headings),
        reference_points=np.array(references),
        density=water.density,
        gravity=water.gravity,
        depth=water.depth,
        symmetric=compute.symmetric,
        lid=compute.lid,
        only_at_headings=bool(compute.headings),
    )


def _place(case: Case, name: str) -> tuple[NDArray[np.float64], float]:
    """Horizontal place of the frame of a hull at the start [m], shape (2,), and its heading [rad]."""
    from heavylift.numerics.rotation import rotation_matrix

    body = case.bodies[name]
    assert body.type == "rigid"
    rigid, _ = assemble_rigid(name, body)
    R = rotation_matrix(rigid.orientation)
    return rigid.position[:2], math.atan2(R[1, 0], R[0, 0])


def _panels(
    case: Case, name: str, compute: ComputeSection, folder: OutputFolder, height: float
) -> HullPanels:
    """Wetted panels of a hull whose frame is at a height above the water [m]."""
    surface = next(entry for entry in case.surfaces if entry.name == case.hulls[name].surface)
    origin = frame_origin(case, name)
    size = _plain_box(surface)
    if size is not None:
        length, breadth, depth = size
        x, y, z = (float(value) for value in np.array(surface.at) - origin)
        draft = 0.5 * depth - z - height
        return box_panels(length, breadth, draft, compute.panel_size, name=name).translated(x, y)
    wetted = surface_panels(hull_surface(case, name, folder), level=-height, name=name)
    if compute.symmetric:
        return _mirrored(wetted, compute.panel_size)
    points, triangles = refined_triangles(wetted.points, wetted.triangles, compute.panel_size, name=name)
    return _panels_of(points, triangles, name)


def _mirrored(wetted: HullPanels, size: float) -> HullPanels:
    """Refined panels of a hull that is symmetric about its plane y = 0: those of one half, and their mirror image."""
    # the half of negative y: with y as the height, what is below the water
    turned = TriangleSurface(
        np.ascontiguousarray(wetted.points[:, [2, 0, 1]]), wetted.triangles, name=wetted.name
    )
    half = surface_panels(turned, name=wetted.name)
    points, triangles = refined_triangles(half.points[:, [1, 2, 0]], half.triangles, size, name=wetted.name)
    sides = [
        hydrostatics(panels, 1.0, 1.0, np.zeros(3)) for panels in (wetted, _panels_of(points, triangles, ""))
    ]
    extent = float(np.ptp(wetted.points, axis=0).max())
    if (
        abs(2.0 * sides[1].volume - sides[0].volume) > SAME_PLACE * sides[0].volume
        or abs(float(sides[0].centre_of_buoyancy[1])) > SAME_PLACE * extent
    ):
        raise _not_symmetric(wetted.name, "unequal halves")
    middle = np.abs(points[:, 1]) <= SAME_PLACE * extent
    points[middle, 1] = 0.0
    image = np.arange(len(points))
    image[~middle] = len(points) + np.arange(np.count_nonzero(~middle))
    others = points[~middle] * np.array([1.0, -1.0, 1.0])
    both = np.concatenate(
        [triangles, image[triangles[:, [1, 0, 2]]]]
    )  # the last corner, which repeats, stays
    return _panels_of(np.concatenate([points, others]), both, wetted.name)


def _panels_of(points: NDArray[np.float64], triangles: NDArray[np.int64], name: str) -> HullPanels:
    return HullPanels(points, np.column_stack([triangles, triangles[:, 2]]), name)


def _not_symmetric(name: str, what: str) -> InputError:
    return InputError(
        f"{name!r} has {what}",
        key="compute.symmetric",
        expected="hulls that are symmetric about y = 0 of the first one, or 'symmetric = false'",
    )


def _plain_box(surface: SurfaceSection) -> tuple[float, float, float] | None:
    """Size of a surface that is a box along the axes of its body, which has panels of four corners; else None."""
    shape = surface.shape
    whole = not surface.exclude and surface.radius == 0.0 and surface.turned is None
    return shape.size if whole and shape is not None and shape.type == "box" else None


def _headings(compute: ComputeSection) -> NDArray[np.float64]:
    """Equal steps over half a turn, or over a whole one."""
    whole = math.pi if compute.symmetric else 2.0 * math.pi
    count = math.ceil(whole / compute.heading_step - 1e-9)
    return np.linspace(0.0, whole, count + 1)[: None if compute.symmetric else -1]


def _check_symmetry(hull: HullPanels) -> None:
    """Every corner has its mirror image."""
    scale = SAME_PLACE * float(np.ptp(hull.points, axis=0).max())
    corners = {tuple(row) for row in np.round(hull.points / scale).astype(np.int64).tolist()}
    for x, y, z in corners:
        near = ((x + i, -y + j, z + k) for i in (0, -1, 1) for j in (0, -1, 1) for k in (0, -1, 1))
        if not any(corner in corners for corner in near):
            raise _not_symmetric(hull.name, f"a corner at y = {y * scale:.4g} m without its mirror image")
