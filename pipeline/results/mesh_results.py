"""Shapes of frames and shells beside their time histories: what pictures and tables need of a mesh."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.pipeline.results.model_io import replacing_hdf5

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.solver.scene.meshes import FrameBody, ShellBody

__all__ = [
    "MeshShape",
    "mesh_body",
    "mesh_shape",
    "read_meshes",
    "save_meshes",
    "write_meshes",
]

GROUP = "bodies"
"""Group of a result file with a group a frame or shell."""

_ARRAYS = (
    "nodes",
    "elements",
    "vectors",
    "lengths",
    "element_sections",
    "sections",
    "axial_strains",
    "fixed",
    "position",
    "orientation",
)
_TEXTS = ("type", "model", "elasticity")
_COLUMNS = {
    "frame": ("density", "youngs_modulus", "area", "second_moment", "outer_fibre"),
    "shell": ("thickness", "density", "youngs_modulus", "poissons_ratio"),
}


@dataclass(frozen=True, eq=False)
class MeshShape:
    """A frame or shell in its initial shape, unloaded; points and vectors in the frame of the body.

    Attributes
    ----------
    name, type
        Of the body.
    nodes
        Positions [m], shape (n, 3).
    elements
        Nodes of each, shape (e, 2) of a frame, (e, 4) of a shell.
    vectors
        Derivatives of the position at the nodes: the tangent of a frame, shape (n, 1, 3); the slopes along x and y
        of the mesh [1] and the twist [1/m] of a shell, shape (n, 3, 3).
    lengths
        Of the elements [m]: shape (e, 1) of a frame; along x and y, shape (e, 2), of a shell.
    section_columns, sections
        Names of the numbers of a section; the sections in SI, shape (s, columns).
    element_sections
        Row of the section of each element, shape (e,).
    axial_strains
        Of the elements of a frame in this shape, zero without pre-stress, shape (e,); of a shell empty.
    fixed
        1 where a coordinate of a node is held, shape (n, 1 + vectors, 3): position first.
    position, orientation
        Of the frame of the body in the world [m], unit quaternion; it stands still.
    model, elasticity
        Strain measure of a frame, empty for a shell; how stress enters the step.
    """

    name: str
    type: Literal["frame", "shell"]
    nodes: NDArray[np.float64]
    elements: NDArray[np.int64]
    vectors: NDArray[np.float64]
    lengths: NDArray[np.float64]
    section_columns: tuple[str, ...]
    sections: NDArray[np.float64]
    element_sections: NDArray[np.int64]
    axial_strains: NDArray[np.float64]
    fixed: NDArray[np.uint8]
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    model: str = ""
    elasticity: str = ""

    def section(self, column: str) -> NDArray[np.float64]:
        """One number of the section of each element, e.g. ``"thickness"``, shape (e,)."""
        values: NDArray[np.float64] = self.sections[self.element_sections, self.section_columns.index(column)]
        return values

    def world_nodes(self) -> NDArray[np.float64]:
        """Positions of the nodes in the world [m], shape (n, 3)."""
        from heavylift.numerics.rotation import rotation_matrix

        points: NDArray[np.float64] = self.position + self.nodes @ rotation_matrix(self.orientation).T
        return points


def mesh_shape(body: Any) -> MeshShape:
    """Shape of a body of a scene."""
    kind, names = body.NOUN, body.VECTORS
    fixed = np.zeros((len(body.nodes), len(names), 3), dtype=np.uint8)
    for support in body.supports:
        for vector, axes in support.fixed.items():
            for axis in axes:
                fixed[support.nodes, names.index(vector), "xyz".index(axis)] = 1
    count = len(body.elements)
    chosen = body.element_sections if len(body.element_sections) else np.zeros(count, dtype=np.int64)
    return MeshShape(
        name=body.name,
        type=kind,
        nodes=np.asarray(body.nodes, dtype=np.float64),
        elements=np.asarray(body.elements, dtype=np.int64),
        vectors=body.slopes_of_nodes,
        lengths=body.lengths_of_elements,
        section_columns=_COLUMNS[kind],
        sections=np.array(
            [[getattr(section, column) for column in _COLUMNS[kind]] for section in body.sections]
        ),
        element_sections=np.asarray(chosen, dtype=np.int64),
        axial_strains=_prestrain(body),
        fixed=fixed,
        position=np.asarray(body.position, dtype=np.float64),
        orientation=np.asarray(body.orientation, dtype=np.float64),
        model=getattr(body, "model", ""),
        elasticity=body.elasticity,
    )


def mesh_body(shape: MeshShape) -> FrameBody | ShellBody:
    """The body whose shape was stored; supports and loads are not part of it."""
    from heavylift.solver.scene.meshes import FrameBody, FrameSection, RodBody, ShellBody, ShellSection

    rows = [dict(zip(shape.section_columns, row.tolist(), strict=True)) for row in shape.sections]
    common: dict[str, Any] = {
        "name": shape.name,
        "nodes": shape.nodes,
        "elements": shape.elements,
        "element_sections": shape.element_sections,
        "position": shape.position,
        "orientation": shape.orientation,
    }
    if shape.type == "shell":
        sections = tuple(ShellSection(**row) for row in rows)
        return ShellBody(slopes=shape.vectors, lengths=shape.lengths, sections=sections, **common)
    common |= {
        "tangents": shape.vectors[:, 0],
        "sections": tuple(FrameSection(**row) for row in rows),
        "model": "exact" if shape.model == "exact" else "green-lagrange",
        "axial_strains": shape.axial_strains,
    }
    if shape.vectors.shape[1] > 1:  # tangents, and directors of the sections
        return RodBody(normals=shape.vectors[:, 1], **common)
    return FrameBody(**common)


def _prestrain(body: FrameBody | ShellBody) -> NDArray[np.float64]:
    strains: NDArray[np.float64] = getattr(body, "axial_strains", np.zeros(0))
    whole = hasattr(body, "axial_strains") and not len(strains)
    return np.zeros(len(body.elements)) if whole else np.asarray(strains, dtype=np.float64)


def write_meshes(file: Any, shapes: Iterable[MeshShape]) -> None:
    """Write shapes into an open HDF5 file, a group each; nothing if there are none."""
    for shape in shapes:
        group = file.create_group(f"{GROUP}/{shape.name}")
        for key in _TEXTS:
            group.attrs[key] = getattr(shape, key)
        for key in _ARRAYS:
            group.create_dataset(key, data=getattr(shape, key))
        group["sections"].attrs["columns"] = json.dumps(shape.section_columns)


def save_meshes(path: Path, shapes: Sequence[MeshShape]) -> None:
    """Write a file of shapes alone, for a simulation that may not end; removes it if there are none."""
    if not shapes:
        path.unlink(missing_ok=True)
        return
    with replacing_hdf5(path) as file:
        write_meshes(file, shapes)


def read_meshes(file: Mapping[str, Any]) -> dict[str, MeshShape]:
    """Shapes in an open HDF5 file, by name."""
    found = {}
    for name, group in file[GROUP].items() if GROUP in file else ():
        found[name] = MeshShape(
            name=name,
            section_columns=tuple(json.loads(group["sections"].attrs["columns"])),
            **{key: str(group.attrs[key]) for key in _TEXTS},  # type: ignore[arg-type]
            **{key: group[key][:] for key in _ARRAYS},
        )
    return found
