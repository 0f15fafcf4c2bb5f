"""Frames and shells side by side: what their packing modules offer under common names."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from heavylift.solver.bodies.ancf.kind import (
    FRAME_PAIRS,
    SHELL_PAIRS,
    FrameMeshes,
    MeshElement,
    Meshes,
    ShellMeshElement,
    ShellMeshes,
)
from heavylift.solver.scene.meshes import FRAME_VECTORS, SHELL_VECTORS, FrameBody, MeshBody

__all__ = ["MeshType", "type_of"]


@dataclass(frozen=True)
class MeshType:
    """A type of mesh: its kind, its elements, nodal vectors, pairs of nodes, functions of its packing module."""

    kind: type[Meshes]
    element: type[MeshElement]
    vectors: tuple[str, ...]
    nodes_per_element: int
    pairs: tuple[tuple[int, int], ...]
    check: Callable[[Any], None]
    element_data: Callable[[Any], Any]
    strain_counts: Callable[[Any], Any]
    start_coordinates: Callable[[Any], Any]
    locate: Callable[[Any, Any, str, str], tuple[int, tuple[float, ...]]]
    shape_values: Callable[[Any, int, tuple[float, ...], int], Any]
    load_shape: Callable[[Any, int], Any]
    body_constants: Callable[[Any], Any]
    result_columns: Callable[[Any], dict[str, tuple[str, ...]]]

    @property
    def rows(self) -> int:
        """Coordinates of a node."""
        return 3 * len(self.vectors)


def type_of(body: MeshBody) -> MeshType:
    """The type of a body; imports what serves it."""
    name = "frame" if isinstance(body, FrameBody) else "shell"
    module = importlib.import_module(f"heavylift.solver.bodies.ancf.{name}_packing")
    frame = name == "frame"
    return MeshType(
        kind=FrameMeshes if frame else ShellMeshes,
        element=MeshElement if frame else ShellMeshElement,
        vectors=FRAME_VECTORS if frame else SHELL_VECTORS,
        nodes_per_element=2 if frame else 4,
        pairs=FRAME_PAIRS if frame else SHELL_PAIRS,
        check=getattr(module, f"check_{name}"),
        element_data=module.element_data,
        strain_counts=module.strain_counts,
        start_coordinates=module.start_coordinates,
        locate=module.locate,
        shape_values=module.shape_values,
        load_shape=module.load_shape,
        body_constants=module.body_constants,
        result_columns=module.result_columns,
    )
