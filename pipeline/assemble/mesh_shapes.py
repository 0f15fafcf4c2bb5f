"""From the geometries of frames and shells in a case to their meshes."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.mesh_geometry import counts_of
from heavylift.solver.scene import mesh_shapes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.mesh_geometry import FrameGeometry, MeshFiles, ShellGeometry
    from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh

__all__ = ["Place", "frame_mesh", "read_points", "shell_mesh"]


@dataclass(frozen=True)
class Place:
    """A body of a case, for errors: where something in it stands in the case file."""

    case: Case
    name: str

    def error(self, key: str, problem: str, expected: str) -> InputError:
        """An error at a key below the body."""
        place = self.case.place(f"bodies.{self.name}.{key}")
        return InputError(problem, source=self.case.file, key=place, expected=expected)


def frame_mesh(place: Place, geometry: FrameGeometry) -> FrameMesh:
    """Mesh of a line, arc or spline."""
    if geometry.type == "line":
        return mesh_shapes.line(geometry.start, geometry.end, geometry.elements)
    if geometry.type == "arc":
        normal: NDArray[np.float64] = np.array(geometry.normal) / np.linalg.norm(geometry.normal)
        reference = np.array(geometry.reference)
        first = reference - (normal @ reference) * normal
        return mesh_shapes.arc(
            geometry.centre,
            geometry.radius,
            geometry.first,
            geometry.last,
            geometry.elements,
            axes=(first, np.cross(normal, first)),
        )
    with _told(place):
        return mesh_shapes.spline(_points(place, geometry), geometry.elements)


def shell_mesh(place: Place, geometry: ShellGeometry) -> ShellMesh:
    """Mesh of a rectangle, quadrilateral or grid."""
    nx, ny = counts_of(geometry.elements)
    with _told(place):
        if geometry.type == "rectangle":
            return mesh_shapes.rectangle(*geometry.size, nx, ny)
        if geometry.type == "quadrilateral":
            return mesh_shapes.quadrilateral(geometry.corners, nx, ny)
        points = _points(place, geometry)
        if len(points) != (nx + 1) * (ny + 1):
            raise InputError(
                f"{len(points)} points for {nx} x {ny} elements",
                key="file",
                expected=f"{(nx + 1) * (ny + 1)}, one more than elements in each direction",
            )
        return mesh_shapes.grid(points.reshape(ny + 1, nx + 1, 3).swapaxes(0, 1))


@contextlib.contextmanager
def _told(place: Place) -> Iterator[None]:
    """Put the place in the case file into errors on a geometry."""
    try:
        yield
    except InputError as error:
        if error.source:
            raise
        geometry = place.case.meshes[place.name].geometry
        key = "corners" if geometry.type == "quadrilateral" and error.key == "points" else error.key
        raise place.error(f"geometry.{key}", error.problem, error.expected) from None


def _points(place: Place, geometry: MeshFiles) -> NDArray[np.float64]:
    """Points of a geometry, from its table or its file, shape (n, 3)."""
    if geometry.file is None:
        return np.array(geometry.points)
    return read_points(place.case.folder / geometry.file)


def read_points(file: Path) -> NDArray[np.float64]:
    """Points of a file of lines ``x,y,z`` [m], shape (n, 3); ``#`` begins a comment.

    Raises
    ------
    InputError
        If the file cannot be read, or a line is not three finite numbers.
    """
    rows = []
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(error), source=file, expected="a readable text file") from None
    for number, line in enumerate(lines, start=1):
        text = line.partition("#")[0].strip()
        if not text:
            continue
        try:
            row = [float(entry) for entry in text.split(",")]
        except ValueError:
            row = []
        if len(row) != 3 or not np.all(np.isfinite(row)):
            raise InputError(f"{line!r}", source=file, key=f"line {number}", expected="x,y,z in m")
        rows.append(row)
    return np.array(rows).reshape(-1, 3)
