"""Surfaces from files: triangles by trimesh, finished meshes by meshio, faces of CAD geometry meshed by gmsh."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.foreign_files import converter_words
from heavylift.numerics.memory import refuse_beyond_memory
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import READ_SUFFIXES
from heavylift.preprocess.finite_elements.geometry import (
    MESH_SUFFIXES,
    STEP_SUFFIXES,
    existing_file,
    read_deck,
    read_with_meshio,
)
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session
from heavylift.preprocess.finite_elements.reference_elements import FACE_CORNER_COUNT, FACE_TRIANGLES, FACES
from heavylift.preprocess.surfaces.triangle_surface import checked_arrays

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["SURFACE_SUFFIXES", "RawTriangles", "read_triangles"]

_TRIMESH_SUFFIXES = (".stl", ".obj", ".ply")
_WITH_UNIT = (*STEP_SUFFIXES, ".iges", ".igs")  # carry their unit of length
_CAD_SUFFIXES = (*_WITH_UNIT, ".brep")
SURFACE_SUFFIXES = (*_TRIMESH_SUFFIXES, *_CAD_SUFFIXES, *MESH_SUFFIXES)

TRIANGLES = 2.3
"""Triangles of equal sides in the square of their edge length."""
TRIANGLE_BYTES, TRIANGLE_SECONDS = 1e3, 20e-6
"""Of a triangle that gmsh makes."""
_TRI3 = 2  # gmsh's number of the 3-node triangle
# flat pieces of the faces of meshes; a middle node stands between the corners of its edge
_PIECES = {
    "triangle": np.array([[0, 1, 2]]),
    "triangle6": np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]),
    "quad8": np.array([[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7]]),
    "quad9": np.array(
        [[0, 4, 8], [4, 1, 8], [1, 5, 8], [5, 2, 8], [2, 6, 8], [6, 3, 8], [3, 7, 8], [7, 0, 8]]
    ),
}
_QUADS = {"quad": [0, 1, 2, 3], "quad8": [4, 5, 6, 7]}  # four nodes, cut along the shorter diagonal
_SOLIDS = {"hexahedron": "hex8", "hexahedron20": "hex20", "tetra": "tet4", "tetra10": "tet10"}


class RawTriangles(NamedTuple):
    """Triangles as they stand in a file: not welded, nothing dropped."""

    points: NDArray[np.float64]  # (n, 3), m
    triangles: NDArray[np.int64]  # (m, 3)


def read_triangles(
    path: str | Path, *, scale: float | None = None, size: float | None = None
) -> RawTriangles:
    """Read the triangles of a file, by its suffix.

    Parameters
    ----------
    path
        STL, OBJ, PLY; STEP, IGES, BREP; or a mesh of Gmsh, VTK, Abaqus, Nastran, ... Of a mesh the triangles and
        quadrilaterals are taken, quadrilaterals cut along their shorter diagonal and faces with middle nodes
        through these; if it has none, the outer faces of its bricks or tetrahedra.
    scale
        Metres per unit of the file, e.g. 1e-3 for mm; default 1. Not for STEP and IGES, which carry their unit.
    size
        Target edge length of the triangles on CAD geometry [m]; default a twentieth of the largest extent. For
        CAD only.

    Raises
    ------
    InputError
        A missing or unreadable file, an unknown suffix, an option that does not fit the kind of file or is not
        positive, no triangle, coordinates that are not finite, numbers of points that do not exist.
    """
    path = existing_file(path, "a file with a surface")
    suffix = path.suffix.lower()
    if suffix not in SURFACE_SUFFIXES:
        raise InputError(
            f"suffix {path.suffix!r} is unknown",
            source=path,
            expected="triangles, CAD geometry or a mesh: "
            + " ".join(SURFACE_SUFFIXES)
            + converter_words(path),
        )
    for key, value in (("scale", scale), ("size", size)):
        if value is not None and not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{value!r}", source=path, key=key, expected="a positive number")
    if scale is not None and suffix in _WITH_UNIT:
        raise InputError(
            f"{scale!r}", source=path, key="scale", expected="no scale: the file carries its own unit"
        )
    if size is not None and suffix not in _CAD_SUFFIXES:
        raise InputError(f"{size!r}", source=path, key="size", expected="no size: the file is meshed already")
    unit = 1.0 if scale is None else scale
    if suffix in _CAD_SUFFIXES:
        points, triangles = _mesh_faces(path, suffix, unit, size)
    elif suffix in _TRIMESH_SUFFIXES:
        points, triangles = _trimesh_read(path, unit)
    else:
        points, triangles = _faces_of_mesh(path, unit)
    return RawTriangles(*checked_arrays(points, triangles, path))


def _trimesh_read(path: Path, unit: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    import trimesh

    # what trimesh has to say about materials and headers is of no use here
    logger = logging.getLogger("trimesh")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        scene = trimesh.load_scene(path, process=False, maintain_order=True, skip_materials=True)
        parts = [part for part in scene.dump() if isinstance(part, trimesh.Trimesh)]
    except Exception as error:  # each reader raises errors of its own
        text = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"cannot be read: {text}", source=path, expected=f"a {path.suffix} file with triangles"
        ) from error
    finally:
        logger.setLevel(level)
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    if not any(len(part.faces) for part in parts):
        raise InputError("contains no triangle", source=path, expected="at least one triangle")
    points = np.vstack([np.asarray(part.vertices, dtype=np.float64) for part in parts])
    triangles = np.vstack(
        [np.asarray(part.faces, dtype=np.int64) + at for part, at in zip(parts, first[:-1], strict=True)]
    )
    return unit * points, triangles


def _faces_of_mesh(path: Path, unit: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    points, blocks = _cells_of(path)
    if points.ndim != 2 or points.shape[1] not in {2, 3}:
        raise InputError("the points are not three-dimensional", source=path, expected="x, y, z a point")
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    found = []
    for kind, cells in blocks:
        if kind in _PIECES:
            found.append(cells[:, _PIECES[kind]].reshape(-1, 3))
        if kind in _QUADS:
            found.append(_cut(points, _checked_numbers(cells, len(points), path)[:, _QUADS[kind]]))
    if not found:
        found = [_outer_faces(cells, _SOLIDS[kind]) for kind, cells in blocks if kind in _SOLIDS]
    if not found:
        have = ", ".join(sorted({kind for kind, _ in blocks})) or "no cell"
        raise InputError(
            f"contains no face (but {have})",
            source=path,
            expected="triangles, quadrilaterals, bricks or tetrahedra",
        )
    return unit * points, np.vstack(found)


def _cells_of(path: Path) -> tuple[NDArray[np.float64], list[tuple[str, NDArray[np.int64]]]]:
    """Points of a mesh and its cells by meshio's types."""
    if path.suffix.lower() in READ_SUFFIXES:
        deck = read_deck(path)
        return deck.points, [(block.shape or block.name, block.nodes) for block in deck.blocks]
    raw = read_with_meshio(path)
    blocks = [(block.type, np.asarray(block.data, dtype=np.int64)) for block in raw.cells]
    return np.asarray(raw.points, dtype=np.float64), blocks


def _checked_numbers(cells: NDArray[np.int64], count: int, source: object) -> NDArray[np.int64]:
    """Numbers of points, which must exist."""
    if cells.size and (cells.min() < 0 or cells.max() >= count):
        bad = int(cells.min()) if cells.min() < 0 else int(cells.max())
        raise InputError(
            f"a cell names point {bad}", source=source, expected=f"numbers from 0 to {count - 1}"
        )
    return cells


def _outer_faces(cells: NDArray[np.int64], kind: str) -> NDArray[np.int64]:
    """Triangles on the faces that belong to one element only, shape (nt, 3)."""
    if kind == "tet4":
        faces, count, pieces = FACES["tet10"][:, :3], 3, np.array([[0, 1, 2]])
    else:
        faces, count, pieces = FACES[kind], FACE_CORNER_COUNT[kind], FACE_TRIANGLES[kind]
    rows = cells[:, faces].reshape(-1, faces.shape[1])
    # three corners identify a face, of a brick too: two faces of a mesh share two corners at most
    keys = np.sort(rows[:, :count], axis=1)[:, :3]
    _, face_of, times = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    outer = rows[times[face_of.ravel()] == 1]
    return outer[:, pieces].reshape(-1, 3)


def _cut(points: NDArray[np.float64], quads: NDArray[np.int64]) -> NDArray[np.int64]:
    """Two triangles for each quadrilateral, cut along the shorter diagonal, which keeps a warped one convex."""
    corners = points[quads]
    turned = ((corners[:, 3] - corners[:, 1]) ** 2).sum(axis=1) < ((corners[:, 2] - corners[:, 0]) ** 2).sum(
        axis=1
    )
    quads = np.where(turned[:, None], np.roll(quads, -1, axis=1), quads)
    return quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def _mesh_faces(
    path: Path, suffix: str, unit: float, size: float | None
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangles on all faces of CAD geometry, solid or not."""
    with path.open("rb") as stream:  # OpenCASCADE would print its complaint on the terminal
        head = stream.read(256)
    if suffix in STEP_SUFFIXES and b"ISO-10303-21" not in head:
        raise InputError(
            "is not a STEP file", source=path, expected="a text file beginning with 'ISO-10303-21'"
        )
    if suffix == ".brep" and b"DBRep_DrawableShape" not in head and b"CASCADE Topology" not in head:
        raise InputError(
            "is not a BREP file", source=path, expected="a text file beginning with 'DBRep_DrawableShape'"
        )
    if suffix in {".iges", ".igs"} and head[72:73] != b"S":
        raise InputError("is not an IGES file", source=path, expected="lines with 'S' in column 73 on top")
    to_metres = unit
    with gmsh_session(str(path)) as gmsh:
        if suffix in _WITH_UNIT:
            # millimetres inside gmsh, whose tolerances are absolute and made for them
            gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
            to_metres = 1e-3
        gmsh.model.occ.importShapes(str(path))
        if not gmsh.model.occ.getEntities(2):
            raise InputError("contains no face", source=path, expected="solids or faces")
        gmsh.model.occ.synchronize()
        box = np.array(gmsh.model.getBoundingBox(-1, -1))
        target = 0.05 * float((box[3:] - box[:3]).max()) if size is None else size / to_metres
        refuse_beyond_memory(
            TRIANGLES
            * sum(gmsh.model.occ.getMass(2, tag) for _, tag in gmsh.model.getEntities(2))
            / max(target, 1e-60) ** 2,
            "triangles",
            bytes_each=TRIANGLE_BYTES,
            seconds_each=TRIANGLE_SECONDS,
            source=path,
            key="size",
            remedy="a larger size",
        )
        points, triangles = _triangulate(gmsh, target)
    return to_metres * points, triangles


def _triangulate(gmsh: Any, size: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.0)
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)  # frontal Delaunay
    gmsh.option.setNumber("Mesh.ElementOrder", 1)
    gmsh.model.mesh.generate(2)
    tags, positions, _ = gmsh.model.mesh.getNodes()
    _, connectivity = gmsh.model.mesh.getElementsByType(_TRI3)
    place = np.full(int(tags.max(initial=0)) + 1, -1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(tags.size)
    return positions.reshape(-1, 3), place[connectivity.astype(np.int64)].reshape(-1, 3)
