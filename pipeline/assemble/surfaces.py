"""Surfaces of triangles of a case: read or made, placed on their bodies, cleaned, stored, and read again.

Triangles are stored in the coordinates of the geometry of their body, those of the ground in the world; excluded ones
too, for pictures.
"""

from __future__ import annotations

import contextlib
import json
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.hdf5_files import reported_of_file
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.case.places import located
from heavylift.pipeline.results.provenance import surface_digest
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.contours.triangles.body_surface import BodySurface
    from heavylift.modal.reduced import ReducedBody
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.surfaces import SurfaceSection
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = [
    "StoredSurface",
    "magnitude_warnings",
    "make_surface",
    "own_surface",
    "read_surface_file",
    "stored_surface",
    "write_surface_file",
]

_SCALES = {"m": 1.0, "mm": 1e-3}
_COUNTS = ("points", "triangles", "edges", "open_edges", "junction_edges", "reversed_triangles", "watertight")


class StoredSurface(NamedTuple):
    """A surface of a case.

    Attributes
    ----------
    whole
        Cleaned triangles, with those that are excluded.
    kept
        Whether a triangle takes part, shape (nt,).
    report
        Counts and sizes as plain values: of the triangles that take part, and how many are excluded.
    digest
        Of all that it was made from.
    """

    whole: TriangleSurface
    kept: NDArray[np.bool_]
    report: dict[str, Any]
    digest: str

    @property
    def surface(self) -> TriangleSurface:
        """The triangles that take part."""
        from heavylift.preprocess.surfaces.triangle_surface import with_triangles

        return self.whole if self.kept.all() else with_triangles(self.whole, self.whole.triangles[self.kept])


def make_surface(case: Case, index: int) -> StoredSurface:
    """Read or make the triangles of a surface of a case.

    Parameters
    ----------
    case, index
        The case and the number of the surface; not that of a body that deforms.

    Raises
    ------
    InputError
        Of a file that cannot be read or has no triangle with an area, of values that are not finite, of boxes that
        exclude everything; with the key in the case file.
    """
    from heavylift.preprocess.surfaces.report import report_surface
    from heavylift.preprocess.surfaces.triangle_surface import clean, placed

    section = case.surfaces[index]
    dropped = None
    with located(case, f"surfaces.{index}"):
        if section.file is not None:
            from heavylift.preprocess.surfaces.files import read_triangles

            with _of_file(section.file):
                scale = None if section.unit is None else _SCALES[section.unit]
                raw = read_triangles(case.folder / section.file, scale=scale, size=section.size)
                made, dropped = clean(raw.points, raw.triangles, radius=section.radius, name=section.name)
        else:
            made = assemble(section.shape, {}, case.folder).surface(section.radius, section.name)
        whole = placed(made, turned(section.turned), section.at)
        kept = _kept(section, whole, case.folder)
    stored = StoredSurface(whole, kept, {}, surface_digest(case, section))
    about = report_surface(stored.surface, dropped)
    report: dict[str, Any] = {key: getattr(about, key) for key in _COUNTS}
    report |= {"excluded": int(np.count_nonzero(~kept)), "area": about.area, "radius": about.radius}
    report["bounds"] = about.bounds.tolist()
    if dropped is not None:
        report["dropped"] = dropped._asdict()
    return stored._replace(report=report)


def own_surface(
    section: SurfaceSection, reduced: ReducedBody, origin: NDArray[np.float64], folder: Path
) -> BodySurface:
    """Triangles of a body with modes that take part, in its frame, and their nodes.

    Parameters
    ----------
    section
        Of the surface.
    reduced, origin
        The body, and the origin of its frame in the coordinates of its geometry [m].
    folder
        Of the case.

    Raises
    ------
    InputError
        If nothing is known of its elements, or boxes exclude everything.
    """
    from heavylift.contours.triangles.body_surface import body_surface
    from heavylift.preprocess.surfaces.triangle_surface import placed

    def chosen(surface: TriangleSurface) -> NDArray[np.bool_]:
        return _kept(section, placed(surface, position=origin), folder)

    return body_surface(reduced, section.name, chosen=chosen if section.exclude else None)


def write_surface_file(path: Path, stored: StoredSurface) -> None:
    """Write a surface as NumPy archive; the same surface gives the same bytes.

    Parameters
    ----------
    path
        Replaced in one step.
    stored
        The surface.
    """
    about = json.dumps({"report": stored.report, "digest": stored.digest, "name": stored.whole.name})
    with replacing(path) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(
            stream,
            points=stored.whole.points,
            triangles=stored.whole.triangles,
            kept=stored.kept,
            radius=np.array(stored.whole.radius),
            about=np.array(about),
        )


def read_surface_file(path: Path) -> StoredSurface:
    """Read a surface that `write_surface_file` wrote.

    Raises
    ------
    InputError
        If the file is absent or damaged.
    """
    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

    expected = "a whole surface; make it with `heavylift mesh CASE --force`"
    with (
        reported_of_file(path, expected),
        path.open("rb") as stream,
        np.load(stream, allow_pickle=False) as content,
    ):
        about = json.loads(str(content["about"]))
        whole = TriangleSurface(
            content["points"], content["triangles"], float(content["radius"]), str(about["name"])
        )
        return StoredSurface(whole, content["kept"], about["report"], str(about["digest"]))


def stored_surface(case: Case, index: int, folder: OutputFolder) -> StoredSurface:
    """Surface of a case as its output folder has it; made anew if it is absent, damaged or of other inputs."""
    section = case.surfaces[index]
    try:
        stored = read_surface_file(folder.surface(section.name))
    except InputError:
        return make_surface(case, index)
    return stored if stored.digest == surface_digest(case, section) else make_surface(case, index)


def turned(turn: Any) -> NDArray[np.float64]:
    """Rotation, shape (3, 3), of what is turned from the axes of its body."""
    return np.eye(3) if turn is None else turn.DESCRIBED(turn.axis, turn.angle).matrix


def _kept(section: SurfaceSection, whole: TriangleSurface, folder: Path) -> NDArray[np.bool_]:
    """Which triangles take part."""
    from heavylift.preprocess.surfaces.exclusion import exclude

    boxes = [assemble(box, {}, folder).box for box in section.exclude]
    try:
        _, excluded = exclude(whole, boxes)
    except InputError as error:
        raise InputError(
            error.problem,
            key="exclude",
            expected='boxes in the coordinates of the geometry that leave a triangle; keep = "outside" excludes what '
            'lies in a box, keep = "inside" what lies outside of it',
        ) from None
    return ~excluded


@contextlib.contextmanager
def _of_file(file: str) -> Iterator[None]:
    """Say of errors in a file that it is the file of a surface."""
    try:
        yield
    except InputError as error:
        place = f"{file}: {error.key}: " if error.key else f"{file}: "
        raise InputError(place + error.problem, key="file", expected=error.expected) from None


def magnitude_warnings(case: Case, surfaces: dict[str, StoredSurface]) -> list[str]:
    """What looks like a file in millimetres: against the body of a surface, and against others; each once."""
    from heavylift.preprocess.surfaces.report import check_against_body, check_magnitudes

    found: dict[str, None] = {}
    for section in case.surfaces:
        body = case.bodies.get(section.body)
        if section.name in surfaces and body is not None and body.has_inertia:
            inertia = np.asarray(body.inertia, dtype=np.float64)
            moments = inertia if inertia.ndim == 1 else np.diagonal(inertia)
            gyration = math.sqrt(max(float(moments.max()), 0.0) / body.mass)
            text = check_against_body(section.name, surfaces[section.name].surface, section.body, gyration)
            if text:
                found[text] = None
    for _, (a, b) in case.collided.values():
        if a in surfaces and b in surfaces:
            text = check_magnitudes(a, surfaces[a].surface, b, surfaces[b].surface)
            if text:
                found[text] = None
    return list(found)
