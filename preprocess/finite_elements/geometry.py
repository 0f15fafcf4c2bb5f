"""Bodies from files: STEP solids meshed by gmsh, decks of other programs, and finished meshes read by meshio."""

from __future__ import annotations

import contextlib
import io
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.hdf5_files import check_hdf5, is_hdf5
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import DECK_SUFFIXES, Deck, ElementBlock
from heavylift.preprocess.finite_elements.deck_parts import loose_frame
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session, mesh_tetrahedra
from heavylift.preprocess.finite_elements.groups import NodeSelector, select_nodes
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.named_files import mesh_files
from heavylift.preprocess.finite_elements.refinement import CurveSize, curves_of_groups

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.refinement import Refinement

__all__ = [
    "MESH_SUFFIXES",
    "STEP_SUFFIXES",
    "existing_file",
    "read_deck",
    "read_mesh",
    "read_step",
    "read_with_meshio",
    "scaled_mesh",
]

STEP_SUFFIXES = (".step", ".stp")
MESH_SUFFIXES = (".bdf", ".cdb", ".fem", ".inp", ".med", ".msh", ".nas", ".unv", ".vtk", ".vtu", ".xdmf")

_SOLID_CELLS = {"hexahedron": "hex8", "hexahedron20": "hex20", "tetra10": "tet10"}
# cells that may accompany a solid: they only carry groups
_LOWER_CELLS = ("vertex", "line", "triangle", "quad")


def read_step(
    path: str | Path,
    *,
    size: float | None = None,
    curved: bool = False,
    groups: Sequence[NodeSelector] = (),
    refine: Sequence[Refinement] = (),
) -> Mesh:
    """Mesh the solids of a STEP file with quadratic tetrahedra.

    Parameters
    ----------
    path
        The file. Its length unit is read from its header; positions are in metres.
    size
        Target edge length [m]; default a twentieth of the largest extent.
    curved
        Whether middle nodes go onto curved faces. Default: straight edges, for which all inertia integrals
        of the mesh are exact; the volume then converges with the square of `size`, with curved edges
        faster.
    groups
        Node groups to name; faces are called by their label in the file or ``"face NUMBER"``.
    refine
        Smaller elements along the edges of groups.

    Returns
    -------
    Mesh
        Checked.

    Raises
    ------
    InputError
        A missing or unreadable file, no solid in it, a size that is not positive, elements turned inside
        out by curved edges, an empty group.
    """
    path = existing_file(path, "a STEP file")
    if size is not None and not (np.isfinite(size) and size > 0.0):
        raise InputError(f"{size!r}", source=path, key="size", expected="a positive length in m")
    with path.open("rb") as stream:  # OpenCASCADE would print its complaint on the terminal
        if b"ISO-10303-21" not in stream.read(256):
            raise InputError(
                "is not a STEP file", source=path, expected="a text file beginning with 'ISO-10303-21'"
            )
    with gmsh_session(str(path)) as gmsh:
        # millimetres inside gmsh, whose tolerances are absolute and made for them
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
        gmsh.option.setNumber("Geometry.OCCImportLabels", 1)
        gmsh.model.occ.importShapes(str(path))
        solids = gmsh.model.occ.getEntities(3)
        if not solids:
            raise InputError("contains no solid", source=path, expected="a STEP file with a closed solid")
        if len(solids) > 1:  # touching solids get common faces
            gmsh.model.occ.fragment(solids[:1], solids[1:])
        gmsh.model.occ.synchronize()
        box = np.array(gmsh.model.getBoundingBox(-1, -1))
        target = 0.05 * float((box[3:] - box[:3]).max()) if size is None else 1e3 * size
        tags_of: dict[str, list[int]] = {}
        for _, tag in gmsh.model.getEntities(2):
            label = gmsh.model.getEntityName(2, tag).rsplit("/", 1)[-1]
            for face in filter(None, (f"face {tag}", label)):
                tags_of.setdefault(face, []).append(tag)
        wishes = _curve_sizes(gmsh, groups, refine, tags_of, str(path)) if refine else []
        nodes, elements, face_nodes = mesh_tetrahedra(
            gmsh, target, source=str(path), curved=curved, refine=wishes
        )
    faces = {
        face: np.unique(np.concatenate([face_nodes[tag] for tag in tags])) for face, tags in tags_of.items()
    }
    mesh = Mesh(1e-3 * nodes, elements, "tet10", name=str(path)).check()
    return mesh.with_groups(select_nodes(mesh.nodes, groups, faces=faces, source=str(path)))


def _curve_sizes(
    gmsh: Any,
    groups: Sequence[NodeSelector],
    refine: Sequence[Refinement],
    tags_of: dict[str, list[int]],
    source: str,
) -> list[CurveSize]:
    """Curves and sizes of the refinements, in mm."""
    boxes = {tag: 1e-3 * np.array(gmsh.model.getBoundingBox(1, tag)) for _, tag in gmsh.model.getEntities(1)}
    face_curves = {
        face: [curve for tag in tags for _, curve in gmsh.model.getBoundary([(2, tag)], oriented=False)]
        for face, tags in tags_of.items()
    }
    found = curves_of_groups(boxes, refine, groups, face_curves, None, source)
    return [CurveSize(curves, 1e3 * item.size, item.growth) for curves, item in found]


def read_mesh(
    path: str | Path,
    *,
    length_unit: float = 1.0,
    groups: Sequence[NodeSelector] = (),
    elements: Sequence[str] = (),
    part: int | None = None,
    merge_nodes: float | None = None,
) -> Mesh:
    """Read a finished mesh of 8-node bricks, 20-node bricks or 10-node tetrahedra.

    Parameters
    ----------
    path
        A deck of Abaqus, CalculiX or Nastran, or any file of meshio: Gmsh, VTK, ...
    length_unit
        Metres per unit of the file.
    groups
        Node groups to name besides those of the file.
    elements, part, merge_nodes
        Which of several bodies, see `Deck.body`; `merge_nodes` in metres.

    Returns
    -------
    Mesh
        Checked. Node sets, cell sets, physical groups and point data of 0 and 1 become node groups. Nodes
        of no solid element (reference points, nodes of surface cells only) are left out.

    Raises
    ------
    InputError
        A missing or unreadable file, cells of other kinds, several kinds at once, several parts, an
        inverted or disconnected element, a length unit that is not positive, an empty group.
    """
    path = existing_file(path, "a mesh file")
    if not (np.isfinite(length_unit) and length_unit > 0.0):
        raise InputError(
            f"{length_unit!r}", source=path, key="length_unit", expected="a positive number of m per unit"
        )
    distance = None if merge_nodes is None else merge_nodes / length_unit
    body = read_deck(path).body(elements=elements, part=part, merge_nodes=distance)
    return scaled_mesh(body.mesh, length_unit, groups)


def scaled_mesh(mesh: Mesh, length_unit: float, groups: Sequence[NodeSelector] = ()) -> Mesh:
    """Mesh in metres, with more groups.

    Parameters
    ----------
    mesh
        In the unit of its file.
    length_unit
        Metres per unit of the file.
    groups
        Node groups to name besides those of the file, in metres.

    Raises
    ------
    InputError
        A group without nodes, an unknown set.
    """
    scaled = replace(mesh, nodes=length_unit * mesh.nodes)
    return scaled.with_groups(select_nodes(scaled.nodes, groups, faces=mesh.node_groups, source=mesh.name))


def read_deck(path: Path, root: Path | None = None) -> Deck:
    """Everything that a mesh file or a deck holds, in its units.

    Parameters
    ----------
    path
        The file, of one of `MESH_SUFFIXES`.
    root
        Folder that included files do not leave; by default that of the file.

    Raises
    ------
    InputError
        A missing or unreadable file.
    """
    existing_file(path, "a mesh file")
    with np.errstate(
        over="ignore", invalid="ignore"
    ):  # positions that are not finite are refused with the body
        return _read_deck(path, root)


def _read_deck(path: Path, root: Path | None) -> Deck:
    suffix = path.suffix.lower()
    if suffix == ".inp":
        from heavylift.preprocess.finite_elements.abaqus_deck import read_abaqus_deck

        return read_abaqus_deck(path, root)
    if suffix in DECK_SUFFIXES:
        from heavylift.preprocess.finite_elements.nastran_deck import read_nastran_deck

        return read_nastran_deck(path, root)
    if suffix == ".cdb":
        from heavylift.preprocess.finite_elements.ansys_deck import read_ansys_deck

        return read_ansys_deck(path)
    if suffix == ".unv":
        from heavylift.preprocess.finite_elements.universal_deck import read_universal_deck

        return read_universal_deck(path)
    return _deck_of_meshio(read_with_meshio(path), path)


def existing_file(path: str | Path, expected: str) -> Path:
    """Path of a file that is there.

    Parameters
    ----------
    path
        The file.
    expected
        What it should be, for the message, e.g. "a mesh file".

    Raises
    ------
    InputError
        The file does not exist, or is a folder.
    """
    path = Path(path)
    if not path.is_file():
        problem = "is a folder" if path.is_dir() else "does not exist"
        raise InputError(problem, source=path, expected=expected)
    return path


def read_with_meshio(path: Path) -> Any:
    """``meshio.Mesh`` of a file, of any format that meshio knows by its suffix.

    Parameters
    ----------
    path
        The file, which exists.

    Raises
    ------
    InputError
        The file cannot be read. The message holds what meshio would have printed.
    """
    import meshio

    if path.suffix.lower() == ".med":  # an HDF5 file
        check_hdf5(path, f"a {path.suffix} file meshio can read")
    if path.suffix.lower() == ".xdmf":
        for file in mesh_files(path, Path(path.resolve().anchor))[1:]:
            if is_hdf5(file):
                check_hdf5(file, "an HDF5 file with the numbers of the mesh")
    # meshio prints its complaint and may leave by SystemExit: keep both for the message
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            return meshio.read(path)
    except (SystemExit, Exception) as error:
        text = " ".join(printed.getvalue().split())
        if not isinstance(error, SystemExit):
            text = " ".join([text, " ".join(str(error).split()) or type(error).__name__]).strip()
        raise InputError(
            f"cannot be read as a mesh: {text}", source=path, expected=f"a {path.suffix} file meshio can read"
        ) from error


def _deck_of_meshio(raw: Any, path: Path) -> Deck:
    """Cells and groups of a file that meshio has read."""
    points = np.asarray(raw.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError("the points are not three-dimensional", source=path, expected="x, y, z a point")
    blocks = []
    start = 0
    for block in raw.cells:
        count = len(block.data)
        labels = np.arange(start + 1, start + count + 1)
        start += count
        if block.type in _SOLID_CELLS:
            nodes = np.asarray(block.data, dtype=np.int64)
            blocks.append(ElementBlock(block.type, _SOLID_CELLS[block.type], labels, nodes))
            continue
        remedy = (
            "10-node tetrahedra: 4-node ones lock; set the element order to 2 where the mesh is made"
            if block.type == "tetra"
            else "bricks (hexahedron, hexahedron20) or 10-node tetrahedra (tetra10)"
        )
        only_groups = block.type.startswith(_LOWER_CELLS)
        nothing = np.empty((count, 0), dtype=np.int64)
        words = "" if only_groups else "cells of type"
        blocks.append(ElementBlock(repr(block.type), "", labels, nothing, words, remedy, only_groups))
    index = np.full(start, -1, dtype=np.int64)
    return Deck(
        path,
        points,
        blocks,
        _file_groups(raw),
        _file_elements(raw),
        index,
        make_frame=lambda: loose_frame([(block.type, np.asarray(block.data)) for block in raw.cells]),
    )


def _file_elements(raw: Any) -> dict[str, NDArray[np.int64]]:
    """Sets of cells, numbered over all blocks."""
    starts = np.cumsum([0, *(len(block.data) for block in raw.cells)])
    sets: dict[str, NDArray[np.int64]] = {}
    for name, per_block in raw.cell_sets.items():
        if not name.startswith("gmsh:"):
            found = [
                start + np.asarray(members, dtype=np.int64)
                for start, members in zip(starts, per_block, strict=False)
                if members is not None
            ]
            sets[name] = np.concatenate([*found, np.empty(0, dtype=np.int64)])
    for name, per_block in _med_groups(raw).items():
        sets[name] = np.concatenate(
            [start + members for start, members in zip(starts, per_block, strict=False)]
        )
    for name, (number, dimension) in raw.field_data.items():
        found = [
            start + np.flatnonzero(np.asarray(numbers) == number)
            for start, block, numbers in zip(
                starts, raw.cells, raw.cell_data.get("gmsh:physical", []), strict=False
            )
            if block.dim == dimension
        ]
        if found and name not in sets:
            sets[name] = np.concatenate(found)
    return {name: members for name, members in sets.items() if members.size}


def _med_groups(raw: Any) -> dict[str, list[NDArray[np.int64]]]:
    """Cells of each block by the name of a group, of a MED file: cells have families, families have names."""
    found: dict[str, list[NDArray[np.int64]]] = {}
    families = raw.cell_data.get("cell_tags", [])
    for family, names in getattr(raw, "cell_tags", {}).items():
        for name in names:
            known = found.setdefault(name, [np.empty(0, dtype=np.int64) for _ in raw.cells])
            for k, tags in enumerate(families):
                known[k] = np.union1d(known[k], np.flatnonzero(np.asarray(tags) == family))
    return found


def _file_groups(raw: Any) -> dict[str, NDArray[np.int64]]:
    groups: dict[str, NDArray[np.int64]] = {}

    def extend(name: str, members: NDArray[np.int64]) -> None:
        groups[name] = np.union1d(groups.get(name, np.empty(0, dtype=np.int64)), members.ravel())

    for name, members in raw.point_sets.items():
        extend(name, np.asarray(members, dtype=np.int64))
    for name, per_block in raw.cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        for block, members in zip(raw.cells, per_block, strict=True):
            if members is not None and len(members):
                extend(name, np.asarray(block.data[np.asarray(members, dtype=np.int64)], dtype=np.int64))
    for name, per_block in _med_groups(raw).items():
        for block, members in zip(raw.cells, per_block, strict=True):
            if members.size:
                extend(name, np.asarray(block.data[members], dtype=np.int64))
    # format 2 of gmsh: numbers on the cells, names in a table of (number, dimension)
    for name, (number, dimension) in raw.field_data.items():
        for block, numbers in zip(raw.cells, raw.cell_data.get("gmsh:physical", []), strict=False):
            chosen = np.asarray(numbers) == number
            if block.dim == dimension and chosen.any():
                extend(name, np.asarray(block.data[chosen], dtype=np.int64))
    for name, values in raw.point_data.items():
        flags = np.asarray(values)
        if flags.ndim == 1 and flags.dtype.kind in "biu" and np.isin(flags, (0, 1)).all() and flags.any():
            extend(name, np.flatnonzero(flags))
    return groups
