"""From the contours and contacts of a case to what the solver integrates.

Points of a case stand in coordinates of geometries or in the world at the start; the solver takes them in the frames
of the bodies. A contour of a flexible body is fitted through nodes of its mesh; its control points move with the modes.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.described import assemble, spec_of
from heavylift.pipeline.case.columns import read_points
from heavylift.pipeline.case.contours import BandContourSection, SurfaceContourSection
from heavylift.pipeline.case.places import located
from heavylift.pipeline.results.model_io import read_model
from heavylift.solver.scene import contacts as c

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.contours.splines.neutral import NeutralContour
    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.contours import (
        CircleSection,
        Contour,
        CurveSplineSection,
        FaceSection,
        SurfaceSplineSection,
    )
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene.scene import AnyBody, FlexibleBody

__all__ = ["assemble_contact", "assemble_contacts", "assemble_contours", "contour_nodes"]

CIRCLE_POINTS = 48
"""Points of a circle on a rigid body, if the case gives no number."""
ALONG = 1e-3
"""Sine of the angle to a curve below which a direction is not across it."""

_SOURCES = ("nodes", "face", "line", "points", "file", "circle", "spline")


def assemble_contours(
    case: Case, bodies: Sequence[AnyBody], sides: Mapping[str, Side], folder: OutputFolder
) -> tuple[c.Contour, ...]:
    """Contours of a case.

    Parameters
    ----------
    case
        The case.
    bodies
        Bodies of its scene.
    sides
        Where they are at the start, by name.
    folder
        Output folder: groups of nodes are read from the model of a body.

    Raises
    ------
    InputError
        Of nodes that make no line or grid, of points that fold or give no smooth curve, with the key in the case file.
    """
    from heavylift.contours.splines.kept import kept_check

    flexible: dict[str, Any] = {body.name: body for body in bodies if body.MODAL}
    found = []
    for name, section in case.contours.items():
        with _reported(case, name):
            body = flexible.get(section.body)
            if not _source(section):
                neutral = None
            elif section.spline is not None:
                neutral = _imported(name, section, sides[section.body])
            elif body is not None:
                neutral = _fitted_to_nodes(case, name, section, body, sides[section.body].origin, folder)
            else:
                points = _given_points(case, section)
                neutral = _fit(name, section, points - sides[section.body].origin, None)
            director = _director(section, neutral, bodies)
            if neutral is not None:
                nodes = None if body is None else body.reduced.nodes
                kept_check(neutral, flip=getattr(section, "flip", False), nodes=nodes, source=name)
        found.append(
            c.Contour(
                name=name,
                body=section.body,
                neutral=neutral,
                flip=getattr(section, "flip", False),
                radius=getattr(section, "radius", 0.0),
                width=getattr(section, "width", 0.0),
                director=director,
            )
        )
    return tuple(found)


def _director(
    section: Contour, neutral: NeutralContour | None, bodies: Sequence[AnyBody]
) -> NDArray[np.float64]:
    """Along the width of a band: its normal is this x tangent. Of a curve the first of two normals, zero if chosen."""
    if not isinstance(section, BandContourSection):
        return np.array(getattr(section, "normal", None) or (0.0, 0.0, 0.0))
    if section.across is not None:
        return np.array(section.across)
    assert section.normal is not None
    normal = np.array(section.normal)
    if neutral is None:
        frame: Any = next(body for body in bodies if body.name == section.body)
        tangent = frame.tangents[0]
    else:
        from heavylift.contours.splines.derivatives import evaluate_contour

        tangent = evaluate_contour(neutral, np.zeros((1, 1)))[0, 1]
    across: NDArray[np.float64] = np.cross(tangent, normal)
    length = float(np.linalg.norm(across))
    if length <= ALONG * float(np.linalg.norm(tangent) * np.linalg.norm(normal)):
        raise InputError(
            f"{list(section.normal)} is along the start of the curve",
            key="normal",
            expected="a direction across the curve",
        )
    return across / length


@contextlib.contextmanager
def _reported(case: Case, name: str) -> Iterator[None]:
    """Put the place in the case file into errors on the points of a contour."""
    try:
        yield
    except InputError as error:
        if error.source and str(case.folder) in str(error.source):
            raise
        section = case.contours[name]
        head = error.key.partition(".")[0]
        if section.spline is not None and head in {"degree", "knots", "control", "weights"}:
            key = f"spline.{error.key}"
        elif head in {"closed", "columns", "degree", "flip", "normal", *_SOURCES}:
            key = error.key
        else:
            key = _source(section)
        # "floor, first direction" says which of two
        direction = error.source.removeprefix(name).lstrip(", ")
        problem = f"{direction}: {error.problem}" if direction else error.problem
        place = case.place(f"contours.{name}.{key}".removesuffix("."))
        raise InputError(problem, source=case.file, key=place, expected=error.expected) from None


def _unstructured(case: Case, section: SurfaceContourSection) -> bool:
    """Whether the nodes of a face lie in no rows: those of tetrahedra."""
    body: Any = case.bodies[section.body]
    return body.geometry.type in {"blocks", "step"} and bool(body.mesh.element == "tet10")


def _source(section: Contour) -> str:
    """Key that says where the points of a contour come from; empty for the shape of a frame or shell itself."""
    return next((key for key in _SOURCES if getattr(section, key, None) is not None), "")


def _fit(
    name: str, section: Contour, points: NDArray[np.float64], shapes: NDArray[np.float64] | None
) -> NeutralContour:
    """Spline through points, shapes (k, 3) or (a, b, 3); `shapes` are their motions by the modes."""
    from heavylift.contours.splines.kept import kept_contour

    return kept_contour(
        points,
        degrees=section.degree if isinstance(section, SurfaceContourSection) else (section.degree,),
        closed=section.closed
        if isinstance(section, SurfaceContourSection)
        else (section.closed or section.circle is not None,),
        parametrisation=section.parametrisation,
        mode_shapes=shapes,
        source=name,
    )


def _fitted_to_nodes(
    case: Case,
    name: str,
    section: Contour,
    body: FlexibleBody,
    origin: NDArray[np.float64],
    folder: OutputFolder,
) -> NeutralContour:
    """Contour through nodes of a flexible body."""
    reduced = body.reduced
    # points in the case and in messages are in the coordinates of the geometry
    picked = contour_nodes(case, name, reduced.nodes + origin, folder)
    if isinstance(section, SurfaceContourSection) and picked.ndim == 1:
        from heavylift.contours.splines.kept_face import kept_face

        return kept_face(reduced.nodes, picked, reduced.mode_shapes, degrees=section.degree, source=name)
    return _fit(name, section, reduced.nodes[picked], reduced.mode_shapes[:, picked])


def contour_nodes(
    case: Case, name: str, nodes: NDArray[np.float64], folder: OutputFolder
) -> NDArray[np.int64]:
    """Nodes of a flexible body through which a contour goes.

    Parameters
    ----------
    case, name
        The case and the name of the contour.
    nodes
        Of its body, in the coordinates of the geometry [m], shape (n, 3).
    folder
        Output folder: groups of nodes are read from the model of the body.

    Returns
    -------
    NDArray
        Indices from 0, shape (k,) of a curve, (a, b) of a surface through rows and columns, (k,) of one that is fitted
        to the nodes of an unstructured face.

    Raises
    ------
    InputError
        Of nodes that are not there, or make no line or grid, with the key in the case file.
    """
    with _reported(case, name):
        return _picked_nodes(case, name, nodes, folder)


def _picked_nodes(
    case: Case, name: str, nodes: NDArray[np.float64], folder: OutputFolder
) -> NDArray[np.int64]:
    """See `contour_nodes`."""
    from heavylift.contours.splines.face_grid import circle_nodes, face_grid, line_nodes
    from heavylift.contours.splines.node_matrix import read_node_matrix, read_node_row

    section = case.contours[name]
    if isinstance(section, SurfaceContourSection):
        if section.nodes is not None:
            return read_node_matrix(case.folder / section.nodes, len(nodes))
        assert section.face is not None
        members = _members(name, section.face, section.body, nodes, folder)
        return members if _unstructured(case, section) else face_grid(nodes, members, source=name)
    if section.nodes is not None:
        return read_node_row(case.folder / section.nodes, len(nodes))
    if section.circle is not None:
        circle = section.circle
        return circle_nodes(nodes, np.array(circle.centre), np.array(circle.axis), circle.radius, source=name)
    assert section.line is not None
    return line_nodes(nodes, np.array(section.line.start), np.array(section.line.end), source=name)


def _members(
    name: str, face: FaceSection, body: str, nodes: NDArray[np.float64], folder: OutputFolder
) -> NDArray[np.int64]:
    """Nodes of a face, in any order."""
    from heavylift.contours.splines.face_grid import TOLERANCE, plane_nodes

    lower = None if face.lower is None else np.array(face.lower)
    upper = None if face.upper is None else np.array(face.upper)
    if face.on is None:
        assert face.plane is not None
        assert face.at is not None
        return plane_nodes(nodes, face.plane, face.at, lower=lower, upper=upper, source=name)
    groups = read_model(folder.model(body)).node_groups
    if face.on not in groups:
        known = ", ".join(sorted(groups)) or "none"
        raise InputError(
            f"group {face.on!r} does not exist", key="face.on", expected=f"a group of the geometry: {known}"
        )
    found = groups[face.on]
    if lower is not None and upper is not None:
        near = TOLERANCE * np.ptp(nodes, axis=0).max()
        inside = np.all((nodes[found] >= lower - near) & (nodes[found] <= upper + near), axis=1)
        found = found[inside]
    return found


def _given_points(case: Case, section: Contour) -> NDArray[np.float64]:
    """Points of a rigid body or the ground in the coordinates of its geometry, shape (k, 3) or (a, b, 3) [m]."""
    if section.file is not None:
        points = read_points(case.folder / section.file)
        if not isinstance(section, SurfaceContourSection):
            return points
        columns = section.columns or 1
        if len(points) % columns:
            raise InputError(
                f"{len(points)} points in {section.file}",
                key="columns",
                expected=f"rows of {columns} points, or another number of columns",
            )
        return points.reshape(-1, columns, 3)
    if section.points is not None:
        return np.array(section.points)
    circle: CircleSection | None = getattr(section, "circle", None)
    assert circle is not None
    z = np.array(circle.axis) / np.linalg.norm(circle.axis)
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    count = circle.points or CIRCLE_POINTS
    angles = 2.0 * np.pi * np.arange(count) / count
    round_it = np.outer(np.cos(angles), x) + np.outer(np.sin(angles), y)
    return np.array(circle.centre) + circle.radius * round_it


def _imported(name: str, section: Contour, side: Side) -> NeutralContour:
    """A spline of another program."""
    from heavylift.contours.splines.imported import imported_contour

    knots: list[tuple[float, ...]]
    degrees: tuple[int, ...]
    closed: tuple[bool, ...]
    if isinstance(section, SurfaceContourSection):
        spline: SurfaceSplineSection | CurveSplineSection | None = section.spline
        assert section.spline is not None
        knots, degrees, closed = list(section.spline.knots), section.spline.degree, section.closed
    else:
        spline = section.spline
        assert section.spline is not None
        knots, degrees, closed = [section.spline.knots], (section.spline.degree,), (section.closed,)
    assert spline is not None
    return imported_contour(
        [np.array(row) for row in knots],
        np.array(spline.control) - side.origin,
        degrees,
        weights=np.array(spline.weights) if spline.weights else None,
        closed=closed,
        source=name,
    )


def assemble_contacts(case: Case, sides: Mapping[str, Side]) -> tuple[c.Contact, ...]:
    """Contacts of a case; `sides` are the bodies where they are at the start, by name."""
    found = []
    for index, contact in enumerate(case.contacts):
        with located(case, f"contacts.{index}"):
            found.append(assemble_contact(contact, sides, case.folder))
    return tuple(found)


def assemble_contact(contact: Any, sides: Mapping[str, Side], folder: Path) -> c.Contact:
    """One of them, from its section; `folder` is that of the case."""
    side = sides[contact.between[0]]
    local = side.local(contact.point or (0.0, 0.0, 0.0))
    return c.Contact(
        name=contact.name,
        contour=contact.between[1],
        body=contact.between[0],
        point=local if contact.at is None else side.from_world(contact.at),
        shape=assemble(contact.shape, sides, folder),
        law=_law(contact),
        **spec_of(contact, c.Contact),
    )


def _law(contact: Any) -> c.ContactLaw:
    given = spec_of(contact, contact.DESCRIBED)
    if getattr(contact, "contact_modulus", None) is not None:
        # Hertz: a ball of radius R on a flat surface
        given["stiffness"] = 4.0 / 3.0 * contact.contact_modulus * float(np.sqrt(contact.shape.radius))
    law: c.ContactLaw = contact.DESCRIBED(**given)
    return law
