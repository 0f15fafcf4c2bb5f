"""Panels become meshes: plates, stiffeners along them, openings and lugs, cut where they meet.

Plates are polygons, or faces of a STEP file of surfaces. OpenCASCADE cuts all faces and stiffener lines along their
intersections, so that elements meet node on node. Fields with four sides are meshed with rows and columns of
quadrilaterals, the others with what gmsh recombines.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import chain, product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.memory import refuse_beyond_memory
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session
from heavylift.preprocess.structures.structure import Beams, Shells, Structure

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.preprocess.finite_elements.model import Material
    from heavylift.preprocess.structures.sections import BeamSection

__all__ = ["Lug", "Opening", "Plate", "Stiffener", "mesh_panels", "repeated"]

_LINE2, _TRI3, _QUAD4 = 1, 2, 3  # gmsh's numbers of element types
_FLAT = 1e-6  # of the largest extent: how far a corner may lie off the plane of a plate, a lug off its plate
_ALONG = 1e-3  # sine of the angle between a face and the plane that a plate asks for
_NO_MATCH = "Perfect Match failed"
_BLOSSOM, _SIMPLE = 1, 0  # gmsh's numbers of ways to make quadrilaterals of triangles
_QUARTER = 4  # elements around a quarter of an opening, at least
QUAD_BYTES, QUAD_SECONDS = 12e3, 60e-6
"""Of a quadrilateral, meshed and assembled."""


@dataclass(frozen=True, eq=False)
class Opening:
    """An opening in a plate: round, or oblong with round ends.

    Attributes
    ----------
    centre
        [m], shape (3,), in the plane of the plate.
    width, height
        Outer measures [m]; equal for a round one.
    direction
        Of the width, shape (3,); not needed for a round one.
    """

    centre: NDArray[np.float64]
    width: float
    height: float
    direction: NDArray[np.float64] | None = None


@dataclass(frozen=True, eq=False)
class Plate:
    """A plane plate: a polygon, or several of one property; or faces of a STEP file.

    Attributes
    ----------
    name
        Of the plate group.
    material, thickness
        Of the plate [m].
    polygons
        Corners [m], shape (m, 3), anticlockwise seen from the side of the normal.
    faces
        Labels of faces of the file, ``"face NUMBER"`` among them.
    across, at
        Or all faces of the file in planes across this unit vector, shape (3,), at some of the distances from the
        origin [m]; all distances if empty.
    offset
        From the nodes to the mid-surface along the normal [m].
    nonstructural_mass
        [kg/m2].
    openings
        Each lies in a plate of the group.
    """

    name: str
    material: Material
    thickness: float
    polygons: tuple[NDArray[np.float64], ...] = ()
    faces: tuple[str, ...] = ()
    across: NDArray[np.float64] | None = None
    at: tuple[float, ...] = ()
    offset: float = 0.0
    nonstructural_mass: float = 0.0
    openings: tuple[Opening, ...] = ()


@dataclass(frozen=True, eq=False)
class Stiffener:
    """Beams along lines, welded to a plate by their web or standing alone.

    Attributes
    ----------
    name
        Of the group.
    material, section
        Of the beams.
    lines
        Both ends [m], shape (2, 3) each.
    web
        Direction from the plate along the web, axis 2 of the section, shape (3,).
    plate
        Name of the plate that the lines lie in; empty for lines that stand alone, whose centroid is on the line.
    foot
        From the foot of the web, at the surface of the plate, to the centroid of the section, axes 2 and 3 [m].
    flange
        Direction of axis 3 of the section, shape (3,), to which flanges and bulbs point; None: that of the line turned
        to the web by the right hand.
    """

    name: str
    material: Material
    section: BeamSection
    lines: tuple[NDArray[np.float64], ...]
    web: NDArray[np.float64]
    plate: str = ""
    foot: tuple[float, float] = (0.0, 0.0)
    flange: NDArray[np.float64] | None = None


@dataclass(frozen=True, eq=False)
class Lug:
    """A plate with a pin hole that stands on another one, with brackets across it.

    Attributes
    ----------
    name
        Of the group of nodes at the edge of the hole, and of the plate group.
    material, thickness
        Of the lug [m].
    foot
        Middle of its foot on a plate [m], shape (3,).
    direction
        Along the foot, shape (3,).
    normal
        Away from the plate, shape (3,).
    length, height
        Of the foot, and of the centre of the hole above it [m].
    radius, hole
        Of the round end about the hole, and diameter of the hole [m].
    bracket
        Reach of the brackets to both sides across the lug [m]; 0 for none.
    """

    name: str
    material: Material
    thickness: float
    foot: NDArray[np.float64]
    direction: NDArray[np.float64]
    normal: NDArray[np.float64]
    length: float
    height: float
    radius: float
    hole: float
    bracket: float = 0.0


def repeated(
    points: ArrayLike, steps: Sequence[ArrayLike] = (), counts: Sequence[int] = ()
) -> tuple[NDArray[np.float64], ...]:
    """Points shifted by all sums of multiples 0 ... count - 1 of each step.

    Parameters
    ----------
    points
        [m], shape (m, 3).
    steps
        [m], shape (3,) each.
    counts
        How often, one a step.

    Examples
    --------
    >>> [line[0, 1] for line in repeated([[0, 0, 0], [1, 0, 0]], [[0, 0.5, 0], [0, 2, 0]], [2, 2])]
    [np.float64(0.0), np.float64(2.0), np.float64(0.5), np.float64(2.5)]
    """
    base = np.asarray(points, dtype=np.float64)
    shifts = [
        [k * np.asarray(step, dtype=np.float64) for k in range(n)]
        for step, n in zip(steps, counts, strict=True)
    ]
    return tuple(base + sum(shift, np.zeros(3)) for shift in product(*shifts))


def mesh_panels(
    plates: Sequence[Plate],
    stiffeners: Sequence[Stiffener] = (),
    lugs: Sequence[Lug] = (),
    *,
    size: float,
    file: str | Path | None = None,
    scale: float = 1.0,
    name: str = "panels",
) -> Structure:
    """Cut plates and stiffeners where they meet, and mesh them.

    Parameters
    ----------
    plates, stiffeners, lugs
        What the structure is made of; names are unique.
    size
        Edge length of the elements [m]; fields between lines have at least one.
    file
        STEP file of the faces that plates choose.
    scale
        Factor of its lengths: 1000 for one in metres whose header says millimetres.
    name
        For messages.

    Returns
    -------
    Structure
        Shells and beams with the names of what they are of; node groups with these names, of lugs the edge of the hole.

    Raises
    ------
    InputError
        Plates that are not plane, overlap, or choose faces that are not in the file; faces that no plate chooses;
        stiffeners and lugs on no plate, with their places.
    """
    if not (np.isfinite(size) and size > 0.0):
        raise InputError(f"{size!r}", source=name, key="size", expected="a positive length in m")
    _check_names(plates, stiffeners, lugs, name)
    everything: list[Any] = [*plates, *chain.from_iterable(_lug_plates(lug) for lug in lugs)]
    parts = (everything, stiffeners, lugs)
    try:
        return _meshed(*parts, size, file, scale, name, recombination=_BLOSSOM)
    except InputError as error:
        if _NO_MATCH not in error.problem:
            raise
    # triangles that cannot all be matched in pairs, which leaves a session of gmsh unusable: match most of them
    return _meshed(*parts, size, file, scale, name, recombination=_SIMPLE)


def _meshed(
    everything: Sequence[Any],
    stiffeners: Sequence[Stiffener],
    lugs: Sequence[Lug],
    size: float,
    file: str | Path | None,
    scale: float,
    name: str,
    *,
    recombination: int,
) -> Structure:
    with gmsh_session(name) as gmsh:
        # millimetres inside gmsh, whose tolerances are absolute and made for them
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.option.setNumber("Geometry.OCCImportLabels", 1)
        faces = _faces(gmsh, everything, file, scale, name)
        lines = _lines(gmsh, stiffeners)
        face_parts, line_parts = _cut(gmsh, faces, lines)
        owner = _owners(gmsh, faces, face_parts, everything, name)
        _refuse_loose_lines(gmsh, lines, line_parts, owner, stiffeners, everything, name)
        _refuse_lines_twice(gmsh, lines, line_parts, stiffeners, name)
        _estimate(gmsh, owner, size, name)
        _generate(gmsh, owner, everything, size, recombination)
        return _collect(gmsh, owner, lines, line_parts, everything, stiffeners, lugs, name)


def _check_names(
    plates: Sequence[Plate], stiffeners: Sequence[Stiffener], lugs: Sequence[Lug], name: str
) -> None:
    named: list[Any] = [*plates, *stiffeners, *lugs]
    names = [one.name for one in named]
    twice = next((one for one in names if names.count(one) > 1), None)
    if twice is not None:
        raise InputError(
            f"{twice!r} is given twice", source=name, expected="one plate, stiffener or lug a name"
        )
    known = [plate.name for plate in plates]
    for one in stiffeners:
        if one.plate and one.plate not in known:
            raise InputError(
                f"plate {one.plate!r} is unknown",
                source=name,
                key=f"stiffeners.{one.name}.plate",
                expected="one of " + ", ".join(map(repr, known)),
            )


# ---- geometry ----


def _frame(corners: NDArray[np.float64], source: str, key: str) -> NDArray[np.float64]:
    """Unit normal of a plane polygon by the right hand rule."""
    if corners.ndim != 2 or corners.shape[1:] != (3,) or len(corners) < 3 or not np.all(np.isfinite(corners)):
        raise InputError(
            f"corners {np.array2string(corners, threshold=12)}",
            source=source,
            key=key,
            expected="three or more points",
        )
    following = np.roll(corners, -1, axis=0)
    area = 0.5 * np.cross(corners - corners[0], following - corners[0]).sum(axis=0)
    length, size = float(np.linalg.norm(area)), float(np.ptp(corners, axis=0).max())
    if length <= _FLAT * size**2:
        raise InputError("its corners enclose no area", source=source, key=key, expected="a polygon")
    normal = area / length
    off = np.abs((corners - corners[0]) @ normal)
    if off.max() > _FLAT * size:
        at = ", ".join(f"{1e3 * x:.6g}" for x in corners[off.argmax()])
        raise InputError(
            f"corner ({at}) mm lies {1e3 * off.max():.6g} mm off the plane of the others",
            source=source,
            key=key,
            expected="a plane plate; bent ones in two",
        )
    return normal


def _polygon(gmsh: Any, corners: NDArray[np.float64]) -> int:
    """A plane face [mm]; its tag."""
    occ = gmsh.model.occ
    points = [occ.addPoint(*(1e3 * corner)) for corner in corners]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    tag: int = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    return tag


def _round_end(gmsh: Any, lug: Lug) -> int:
    """The face of a lug: foot, two flanks to the round end, and a pin hole."""
    occ = gmsh.model.occ
    d, n = _unit(lug.direction), _unit(lug.normal)
    centre = lug.foot + lug.height * n
    corners = [lug.foot + 0.5 * lug.length * d, centre + lug.radius * d]
    corners += [centre + lug.radius * n, centre - lug.radius * d, lug.foot - 0.5 * lug.length * d]
    a, b, top, c, e = (occ.addPoint(*(1e3 * corner)) for corner in corners)
    middle = occ.addPoint(*(1e3 * centre))
    edges = [occ.addLine(a, b), occ.addCircleArc(b, middle, top), occ.addCircleArc(top, middle, c)]
    edges += [occ.addLine(c, e), occ.addLine(e, a)]
    hole = _outline(gmsh, centre, 0.5 * lug.hole * d, 0.5 * lug.hole * n, np.zeros(3))
    tag: int = occ.addPlaneSurface([occ.addCurveLoop(edges), occ.addCurveLoop(hole)])
    return tag


def _outline(
    gmsh: Any,
    centre: NDArray[np.float64],
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    straight: NDArray[np.float64],
) -> list[int]:
    """Curves around an opening: quarters of a circle of radii `first` and `second`, pulled apart by +-`straight`."""
    occ = gmsh.model.occ
    curves, ends = [], []
    for side, turn in ((1.0, 1.0), (-1.0, -1.0)):
        middle = centre + side * straight
        points = [middle - turn * second, middle + turn * first, middle + turn * second]
        tags = [occ.addPoint(*(1e3 * p)) for p in (*points, middle)]
        curves.append(
            (occ.addCircleArc(tags[0], tags[3], tags[1]), occ.addCircleArc(tags[1], tags[3], tags[2]))
        )
        ends.append((tags[0], tags[2]))
    if np.any(straight):
        first_line, second_line = occ.addLine(ends[0][1], ends[1][0]), occ.addLine(ends[1][1], ends[0][0])
        return [*curves[0], first_line, *curves[1], second_line]
    return [*curves[0], *curves[1]]


def _cut_openings(gmsh: Any, tag: int, normal: NDArray[np.float64], openings: Sequence[Opening]) -> list[int]:
    """Faces that are left of one."""
    occ = gmsh.model.occ
    tools = []
    for one in openings:
        width, height = _axes_of(one, normal)
        high, wide = min(one.width, one.height), max(one.width, one.height)
        along = width if one.width >= one.height else height
        across = np.cross(normal, along)
        curves = _outline(
            gmsh, one.centre, 0.5 * high * along, 0.5 * high * across, 0.5 * (wide - high) * along
        )
        tools.append((2, occ.addPlaneSurface([occ.addCurveLoop(curves)])))
    left = occ.cut([(2, tag)], tools)[0]
    return [t for _, t in left]


def _faces(
    gmsh: Any, plates: Sequence[Any], file: str | Path | None, scale: float, name: str
) -> list[tuple[int, int]]:
    """Faces of all plates: number of the plate and tag."""
    found: list[tuple[int, int]] = []
    imported = _imported(gmsh, plates, file, scale, name) if file is not None else []
    for index, plate in enumerate(plates):
        if isinstance(plate, Lug):
            found.append((index, _round_end(gmsh, plate)))
            continue
        used = set()
        for polygon in plate.polygons:
            key = f"plates.{plate.name}"
            corners = np.asarray(polygon, dtype=np.float64)
            normal = _frame(corners, name, f"{key}.corners")
            size = float(np.ptp(corners, axis=0).max())
            inside = [
                k
                for k, one in enumerate(plate.openings)
                if abs((one.centre - corners[0]) @ normal) <= _FLAT * size
                and _contains(corners, normal, one.centre)
            ]
            for k in inside:
                _refuse_open_edge(
                    corners, normal, plate.openings[k], name, f"plates.{plate.name}.openings.{k}"
                )
            used |= set(inside)
            tags = [_polygon(gmsh, corners)]
            if inside:
                tags = _cut_openings(gmsh, tags[0], normal, [plate.openings[k] for k in inside])
            found += [(index, tag) for tag in tags]
        for k in range(len(plate.openings)):
            if k not in used and plate.polygons:
                at = ", ".join(f"{1e3 * x:.6g}" for x in plate.openings[k].centre)
                raise InputError(
                    f"its centre ({at}) mm lies on none of its plates",
                    source=name,
                    key=f"plates.{plate.name}.openings.{k}",
                    expected="a point of the plate",
                )
    return found + imported


def _axes_of(
    opening: Opening, normal: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions of the width and of the height of an opening in a plate."""
    given = np.cross(normal, _any_across(normal)) if opening.direction is None else opening.direction
    width = _unit(given - (given @ normal) * normal)
    return width, np.cross(normal, width)


def _refuse_open_edge(
    corners: NDArray[np.float64], normal: NDArray[np.float64], opening: Opening, name: str, key: str
) -> None:
    """An opening lies within its plate, edge included."""
    width, height = _axes_of(opening, normal)
    angles = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    small = 0.5 * min(opening.width, opening.height)
    for angle in angles:
        c, s = np.cos(angle), np.sin(angle)
        pull = (np.sign(c) * (0.5 * opening.width - small), np.sign(s) * (0.5 * opening.height - small))
        point = opening.centre + (small * c + pull[0]) * width + (small * s + pull[1]) * height
        if not _contains(corners, normal, point):
            at = ", ".join(f"{1e3 * x + 0.0:.6g}" for x in np.round(point, 9))
            raise InputError(
                f"it leaves the plate at ({at}) mm",
                source=name,
                key=key,
                expected="an opening within the plate; a notch is a corner of the polygon",
            )


def _contains(corners: NDArray[np.float64], normal: NDArray[np.float64], point: NDArray[np.float64]) -> bool:
    """Whether a point of the plane of a polygon lies inside of it: the angles of its edges add up to a full turn."""
    arms = corners - point
    following = np.roll(arms, -1, axis=0)
    sines = np.cross(arms, following) @ normal
    cosines = np.einsum("ij,ij->i", arms, following)
    return bool(abs(np.arctan2(sines, cosines).sum()) > np.pi)


def _imported(
    gmsh: Any, plates: Sequence[Any], file: str | Path, scale: float, name: str
) -> list[tuple[int, int]]:
    """Faces of a STEP file, with the plate that chooses each."""
    occ = gmsh.model.occ
    gmsh.option.setNumber("Geometry.OCCScaling", scale)
    occ.importShapes(str(file))
    gmsh.option.setNumber("Geometry.OCCScaling", 1.0)
    occ.synchronize()
    tags = [tag for _, tag in gmsh.model.getEntities(2)]
    if not tags:
        raise InputError("contains no surface", source=str(file), expected="a STEP file of surfaces")
    solids = len(gmsh.model.getEntities(3))
    if solids:
        raise InputError(
            f"contains {solids} solid(s)",
            source=str(file),
            expected="the surfaces of plates alone, without thickness; a body of geometry 'step' for solids",
        )
    box = np.array(gmsh.model.getBoundingBox(-1, -1)).reshape(2, 3)
    size = float(np.ptp(box, axis=0).max())
    normals, places, labels = {}, {}, {}
    for tag in tags:
        u, v = (0.5 * (a + b) for a, b in zip(*gmsh.model.getParametrizationBounds(2, tag), strict=True))
        normals[tag] = np.array(gmsh.model.getNormal(tag, [u, v]))
        places[tag] = np.array(gmsh.model.getValue(2, tag, [u, v]))
        label = gmsh.model.getEntityName(2, tag).rsplit("/", 1)[-1]
        labels[tag] = {f"face {tag}", label} - {""}
    owner: dict[int, int] = {}
    for index, plate in enumerate(plates):
        if isinstance(plate, Lug) or not (plate.faces or plate.across is not None):
            continue
        chosen = [tag for tag in tags if labels[tag] & set(plate.faces)]
        unknown = set(plate.faces) - set().union(*labels.values())
        if unknown:
            raise InputError(
                f"no face {min(unknown)!r} in {Path(file).name}",
                source=name,
                key=f"plates.{plate.name}.faces",
                expected="labels of its faces, or 'face 1' ... 'face " + f"{len(tags)}'",
            )
        if plate.across is not None:
            across = _unit(plate.across)
            for tag in tags:
                distance = 1e-3 * float(places[tag] @ across)
                if np.linalg.norm(np.cross(normals[tag], across)) <= _ALONG and (
                    not plate.at or min(abs(distance - at) for at in plate.at) <= _FLAT * 1e-3 * size
                ):
                    chosen.append(tag)
        if not chosen:
            raise InputError(
                f"no face of {Path(file).name} is of it",
                source=name,
                key=f"plates.{plate.name}",
                expected="faces in these planes; the file spans "
                + ", ".join(
                    f"{axis} {low:.6g} to {high:.6g}" for axis, low, high in zip("xyz", *box, strict=True)
                )
                + " mm (is its unit right?)",
            )
        for tag in chosen:
            if owner.setdefault(tag, index) != index:
                at = ", ".join(f"{x:.6g}" for x in places[tag])
                raise InputError(
                    f"face {tag} at ({at}) mm is of {plates[owner[tag]].name!r} too",
                    source=name,
                    key=f"plates.{plate.name}",
                    expected="one plate a face",
                )
    rest = [tag for tag in tags if tag not in owner]
    if rest:
        at = ", ".join(f"{x:.6g}" for x in places[rest[0]])
        n = ", ".join(f"{x:.3g}" for x in normals[rest[0]])
        raise InputError(
            f"{len(rest)} of {len(tags)} faces of {Path(file).name} are of no plate; face {rest[0]} at ({at}) mm, "
            f"normal ({n})",
            source=name,
            key="plates",
            expected="a plate with a thickness for each face",
        )
    return [(owner[tag], tag) for tag in tags]


def _lines(gmsh: Any, stiffeners: Sequence[Stiffener]) -> list[tuple[int, int]]:
    """Lines of all stiffeners: number of the stiffener and tag."""
    occ = gmsh.model.occ
    found = []
    for index, one in enumerate(stiffeners):
        for line in one.lines:
            a, b = (occ.addPoint(*(1e3 * np.asarray(end, dtype=np.float64))) for end in line)
            found.append((index, occ.addLine(a, b)))
    return found


def _cut(
    gmsh: Any, faces: Sequence[tuple[int, int]], lines: Sequence[tuple[int, int]]
) -> tuple[list[list[int]], list[list[int]]]:
    """Cut all faces and lines by each other; tags of the parts of each face and of each line."""
    objects = [(2, tag) for _, tag in faces]
    tools = [(1, tag) for _, tag in lines]
    if len(objects) + len(tools) == 1:  # nothing to cut
        gmsh.model.occ.synchronize()
        return [[objects[0][1]]], []
    _, parts = gmsh.model.occ.fragment(objects, tools)
    gmsh.model.occ.synchronize()
    found = [[tag for dim, tag in part if dim == 2] for part in parts[: len(objects)]]
    curves = [[tag for dim, tag in part if dim == 1] for part in parts[len(objects) :]]
    return found, curves


def _owners(
    gmsh: Any,
    faces: Sequence[tuple[int, int]],
    parts: Sequence[Sequence[int]],
    plates: Sequence[Any],
    name: str,
) -> dict[int, int]:
    """Plate of every face; refuses plates that lie on each other."""
    owner: dict[int, int] = {}
    for (index, _), own in zip(faces, parts, strict=True):
        for tag in own:
            if tag in owner:
                other = plates[owner[tag]].name
                box = np.round(gmsh.model.getBoundingBox(2, tag), 3).reshape(2, 3).mean(axis=0) + 0.0
                at = ", ".join(f"{x:.6g}" for x in box)
                raise InputError(
                    f"plates {other!r} and {plates[index].name!r} lie on each other around ({at}) mm",
                    source=name,
                    key=f"plates.{plates[index].name}",
                    expected="plates that meet in lines",
                )
            owner[tag] = index
    return owner


def _refuse_loose_lines(
    gmsh: Any,
    lines: Sequence[tuple[int, int]],
    parts: Sequence[Sequence[int]],
    owner: dict[int, int],
    stiffeners: Sequence[Stiffener],
    plates: Sequence[Any],
    name: str,
) -> None:
    """Stiffeners of a plate lie in it all along."""
    curves_of: dict[str, set[int]] = {}
    for tag, index in owner.items():
        boundary = {abs(t) for _, t in gmsh.model.getBoundary([(2, tag)], oriented=False)}
        embedded = {abs(t) for dim, t in gmsh.model.mesh.getEmbedded(2, tag) if dim == 1}
        curves_of.setdefault(plates[index].name, set()).update(boundary | embedded)
    for (index, _), own in zip(lines, parts, strict=True):
        plate = stiffeners[index].plate
        loose = [tag for tag in own if plate and tag not in curves_of.get(plate, set())]
        if loose:
            low, high = np.round(gmsh.model.getBoundingBox(1, loose[0]), 3).reshape(2, 3) + 0.0
            words = " to ".join("(" + ", ".join(f"{x:.6g}" for x in end) + ")" for end in (low, high))
            raise InputError(
                f"it leaves the plate {plate!r} between {words} mm",
                source=name,
                key=f"stiffeners.{stiffeners[index].name}",
                expected="lines in the plate, beside its openings",
            )


def _refuse_lines_twice(
    gmsh: Any,
    lines: Sequence[tuple[int, int]],
    parts: Sequence[Sequence[int]],
    stiffeners: Sequence[Stiffener],
    name: str,
) -> None:
    """No stiffener stands on another one, on the same side."""
    taken: dict[int, Stiffener] = {}
    for (index, _), own in zip(lines, parts, strict=True):
        one = stiffeners[index]
        for tag in own:
            other = taken.get(tag)
            if other is not None and _unit(other.web) @ _unit(one.web) > 0.0:
                middle = np.round(gmsh.model.getBoundingBox(1, tag), 3).reshape(2, 3).mean(axis=0) + 0.0
                at = ", ".join(f"{x:.6g}" for x in middle)
                raise InputError(
                    f"it lies on {other.name!r} around ({at}) mm",
                    source=name,
                    key=f"stiffeners.{one.name}",
                    expected="one stiffener on each side of a line",
                )
        taken.update(dict.fromkeys(own, one))


def _lug_plates(lug: Lug) -> Iterator[Lug | Plate]:
    """The lug itself, and its brackets as plates."""
    yield lug
    if lug.bracket:
        d, n = _unit(lug.direction), _unit(lug.normal)
        side = np.cross(n, d)
        corners = [lug.foot - lug.bracket * side, lug.foot + lug.bracket * side]
        tip = max(lug.height - 0.5 * lug.hole - 0.5 * (lug.radius - 0.5 * lug.hole), 0.3 * lug.height)
        corners += [
            lug.foot + tip * n + 0.2 * lug.bracket * side,
            lug.foot + tip * n - 0.2 * lug.bracket * side,
        ]
        yield Plate(f"{lug.name}_brackets", lug.material, lug.thickness, polygons=(np.array(corners),))


# ---- mesh ----


def _estimate(gmsh: Any, owner: dict[int, int], size: float, name: str) -> None:
    """Refuse a mesh for which there is no memory."""
    area = 1e-6 * sum(gmsh.model.occ.getMass(2, tag) for tag in owner)
    refuse_beyond_memory(
        area / size**2,
        "quadrilaterals",
        bytes_each=QUAD_BYTES,
        seconds_each=QUAD_SECONDS,
        source=name,
        key="size",
        remedy="a larger size",
    )


def _generate(
    gmsh: Any, owner: dict[int, int], plates: Sequence[Any], size: float, recombination: int
) -> None:
    """Quadrilaterals on all faces, with rows and columns where they have four sides; finer on lugs."""
    option = gmsh.option.setNumber
    option("Mesh.MeshSizeMin", 0.0)
    option("Mesh.MeshSizeMax", 1e3 * size)
    option("Mesh.MeshSizeFromPoints", 0)
    option("Mesh.ElementOrder", 1)
    option("Mesh.Algorithm", 8)  # frontal Delaunay for quadrilaterals
    option("Mesh.RecombinationAlgorithm", recombination)
    option("Mesh.RecombineAll", 1)
    sides = {tag: _four_sides(gmsh, tag) for tag in owner}
    sizes: dict[int, float] = {}
    for tag, index in owner.items():
        if isinstance(plates[index], Lug):
            rim = plates[index].radius - 0.5 * plates[index].hole
            for _, curve in gmsh.model.getBoundary([(2, tag)], oriented=False):
                sizes[abs(curve)] = min(size, rim)
    counts = _divisions(gmsh, [found for found in sides.values() if found], size, sizes)
    for curve, count in counts.items():
        gmsh.model.mesh.setTransfiniteCurve(curve, count + 1)
    for tag, found in sides.items():
        if found:
            gmsh.model.mesh.setTransfiniteSurface(tag)
            gmsh.model.mesh.setRecombine(2, tag)
    gmsh.model.mesh.generate(2)


def _four_sides(gmsh: Any, tag: int) -> list[int]:
    """Curves around a face of four sides in their order; empty for other faces, and those with lines within."""
    loop = [abs(t) for _, t in gmsh.model.getBoundary([(2, tag)], oriented=True)]
    if len(loop) != 4 or len(set(loop)) != 4 or gmsh.model.mesh.getEmbedded(2, tag):
        return []
    ends = [{t for _, t in gmsh.model.getBoundary([(1, curve)], oriented=False)} for curve in loop]
    # two closed loops, or curves that are not a ring
    if any(len(ends[k] & ends[(k + 1) % 4]) != 1 or ends[k] & ends[(k + 2) % 4] for k in range(4)):
        return []
    return loop


def _divisions(
    gmsh: Any, quadrangles: Sequence[Sequence[int]], size: float, sizes: dict[int, float]
) -> dict[int, int]:
    """Elements along every curve, some of a size of their own: as many on opposite sides of faces with rows."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    curves = [tag for _, tag in gmsh.model.getEntities(1)]
    number = {tag: k for k, tag in enumerate(curves)}
    pairs = [(number[one[k]], number[one[k + 2]]) for one in quadrangles for k in (0, 1)]
    rows, columns = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(curves), len(curves)))
    chains = connected_components(graph, directed=False)[1]
    wanted = np.empty(len(curves), dtype=np.int64)
    for k, tag in enumerate(curves):
        straight = gmsh.model.getType(1, tag) == "Line"
        wanted[k] = max(
            round(gmsh.model.occ.getMass(1, tag) / (1e3 * sizes.get(tag, size))), 1 if straight else _QUARTER
        )
    most = np.ones(chains.max(initial=-1) + 1, dtype=np.int64)
    np.maximum.at(most, chains, wanted)
    return {tag: int(most[chains[k]]) for tag, k in number.items()}


def _collect(
    gmsh: Any,
    owner: dict[int, int],
    lines: Sequence[tuple[int, int]],
    line_parts: Sequence[Sequence[int]],
    plates: Sequence[Any],
    stiffeners: Sequence[Stiffener],
    lugs: Sequence[Lug],
    name: str,
) -> Structure:
    """Nodes and elements of the mesh as parts of a structure."""
    tags, positions, _ = gmsh.model.mesh.getNodes()
    place = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(tags.size)
    points = 1e-3 * positions.reshape(-1, 3)

    found: dict[tuple[int, int], list[NDArray[np.int64]]] = {}
    for tag, index in owner.items():
        for kind, width in ((_QUAD4, 4), (_TRI3, 3)):
            elements = gmsh.model.mesh.getElementsByType(kind, tag)[1]
            if elements.size:
                own = place[elements.astype(np.int64)].reshape(-1, width)
                found.setdefault((index, width), []).append(_turned(points, own, plates[index]))
    beams: dict[int, list[NDArray[np.int64]]] = {}
    for (index, _), own_tags in zip(lines, line_parts, strict=True):
        start, end = (np.asarray(p, dtype=np.float64) for p in stiffeners[index].lines[0])
        for tag in own_tags:
            elements = gmsh.model.mesh.getElementsByType(_LINE2, tag)[1]
            own = place[elements.astype(np.int64)].reshape(-1, 2)
            backwards = (points[own[:, 1]] - points[own[:, 0]]) @ (end - start) < 0.0
            own[backwards] = own[backwards][:, ::-1]
            beams.setdefault(index, []).append(own)

    used = np.unique(
        np.concatenate([part.ravel() for part in chain.from_iterable([*found.values(), *beams.values()])])
    )
    new = np.full(len(points), -1, dtype=np.int64)
    new[used] = np.arange(used.size)
    groups: dict[str, NDArray[np.int64]] = {}
    shells = []
    for (index, _), parts in sorted(found.items()):
        plate, elements = plates[index], new[np.vstack(parts)]
        shells.append(
            Shells(
                name=plate.name,
                elements=elements,
                material=plate.material,
                thickness=plate.thickness,
                offset=getattr(plate, "offset", 0.0),
                nonstructural_mass=getattr(plate, "nonstructural_mass", 0.0),
            )
        )
        groups[plate.name] = np.union1d(groups.get(plate.name, np.empty(0, dtype=np.int64)), elements)
    rods = []
    thickness = {plate.name: plate.thickness for plate in plates}
    for index, parts in sorted(beams.items()):
        one, elements = stiffeners[index], new[np.vstack(parts)]
        groups[one.name] = np.unique(elements)
        middle = np.zeros((len(elements), 3))
        if one.plate:
            own = [part for part in shells if part.name == one.plate]
            middle = float(own[0].offset) * _plate_normal(one, elements, own, points[used], name)
        rods.append(_beams(one, elements, points[used], thickness.get(one.plate, 0.0), middle, name))
    for lug in lugs:
        centre = lug.foot + lug.height * _unit(lug.normal)
        own = groups[lug.name]
        _refuse_foot_in_the_air(lug, own, shells, points[used], name)
        distance = np.linalg.norm(points[used][own] - centre, axis=1)
        groups[f"{lug.name}_plate"] = own
        groups[lug.name] = own[np.abs(distance - 0.5 * lug.hole) <= 1e-6 * lug.hole]
    return Structure(
        nodes=points[used],
        shells=tuple(shells),
        beams=tuple(rods),
        node_groups=groups,
        name=name,
    )


def _refuse_foot_in_the_air(
    lug: Lug, own: NDArray[np.int64], shells: Sequence[Shells], points: NDArray[np.float64], name: str
) -> None:
    """All of the foot of a lug stands on other plates."""
    others = [part.elements.ravel() for part in shells if part.name not in {lug.name, f"{lug.name}_brackets"}]
    foot = own[np.abs((points[own] - lug.foot) @ _unit(lug.normal)) <= 1e-6 * lug.height]
    loose = np.setdiff1d(foot, np.concatenate([np.empty(0, dtype=np.int64), *others]))
    if loose.size or not foot.size:
        place = points[loose[0]] if loose.size else lug.foot
        at = ", ".join(f"{1e3 * x:.6g}" for x in lug.foot)
        where = ", ".join(f"{1e3 * x + 0.0:.6g}" for x in np.round(place, 9))
        all_of_it = "" if loose.size < foot.size else "its foot at (" + at + ") mm stands on no plate"
        raise InputError(
            all_of_it or f"its foot at ({at}) mm leaves the plates at ({where}) mm",
            source=name,
            key=f"lugs.{lug.name}",
            expected="a foot that lies in a plate",
        )


def _turned(points: NDArray[np.float64], elements: NDArray[np.int64], plate: Any) -> NDArray[np.int64]:
    """Elements with the normal of their plate: of its polygon, or the direction that its faces are chosen by."""
    if isinstance(plate, Lug):
        normal = np.cross(_unit(plate.direction), _unit(plate.normal))
    elif plate.polygons:
        normal = _frame(np.asarray(plate.polygons[0], dtype=np.float64), "", "")
    elif plate.across is not None:
        normal = _unit(plate.across)
    else:
        return elements  # as the face has it
    corners = points[elements]
    own = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    return np.where((own @ normal < 0.0)[:, None], elements[:, ::-1], elements)


def _plate_normal(
    one: Stiffener,
    elements: NDArray[np.int64],
    plates: Sequence[Shells],
    points: NDArray[np.float64],
    name: str,
) -> NDArray[np.float64]:
    """Unit normal of the plate along each beam of a stiffener, shape (ne, 3).

    Refuses a web that does not lead away from the plate: by 60 degrees or more from the normal.
    """
    normals = np.zeros((len(points), 3))
    for part in plates:
        x = points[part.elements]
        area = np.cross(x[:, 2] - x[:, 0], x[:, -1] - x[:, 1])
        for corner in range(part.elements.shape[1]):
            np.add.at(normals, part.elements[:, corner], area)
    found = normals[elements].sum(axis=1)
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    cosine = float(np.abs(found @ _unit(one.web)).min())
    if cosine < 0.5:
        raise InputError(
            f"its web is at {np.degrees(np.arccos(cosine)):.3g} deg to the normal of its plate",
            source=name,
            key=f"stiffeners.{one.name}.web",
            expected="a direction away from the plate",
        )
    return np.asarray(found)


def _beams(
    one: Stiffener,
    elements: NDArray[np.int64],
    points: NDArray[np.float64],
    thickness: float,
    middle: NDArray[np.float64],
    name: str,
) -> Beams:
    """Beams of a stiffener, its centroid off the middle of the plate by half of the thickness and its own height."""
    web = _unit(one.web)
    along = points[elements[:, 1]] - points[elements[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    if np.abs(along @ web).max() > 0.1:
        raise InputError(
            f"its web runs along it at {np.degrees(np.arccos(np.abs(along @ web).max())):.3g} deg",
            source=name,
            key=f"stiffeners.{one.name}.web",
            expected="a direction across the line",
        )
    third = np.cross(along, web)
    if one.flange is not None:
        turned = third @ one.flange < 0.0
        elements = np.where(turned[:, None], elements[:, ::-1], elements)
        along, third = (np.where(turned[:, None], -rows, rows) for rows in (along, third))
    second = np.cross(third, along)
    offset, section = np.zeros((len(elements), 3)), one.section
    if one.plate:
        section = replace(section, product=0.0)  # the plate keeps it from turning aside
        offset = middle + second * (0.5 * thickness + one.foot[0]) + third * one.foot[1]
    return Beams(
        name=one.name,
        elements=elements,
        material=one.material,
        section=section,
        orientation=web,
        offset_a=offset,
        offset_b=offset,
    )


def _unit(vector: ArrayLike) -> NDArray[np.float64]:
    given = np.asarray(vector, dtype=np.float64)
    unit: NDArray[np.float64] = given / np.linalg.norm(given)
    return unit


def _any_across(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """A unit vector that is not along another one."""
    return np.eye(3)[int(np.argmin(np.abs(normal)))]
