"""Where a single frame or shell records its vectors and results."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.solver.bodies.ancf.packing import mesh_columns
from heavylift.solver.bodies.ancf.types import type_of
from heavylift.solver.recording import placed
from heavylift.solver.scene.outputs import Columns

if TYPE_CHECKING:
    from heavylift.solver.bodies.ancf.kind import Meshes
    from heavylift.solver.scene.meshes import MeshBody

__all__ = ["place_parts"]


def place_parts(kind: Meshes, body: MeshBody, first: int) -> dict[str, slice]:
    """Columns by channel, from a first one on, which the kind is told."""
    columns = Columns(first, [(name, len(parts)) for name, parts in mesh_columns(body).items()])
    kind.table["parts"][0] = placed(type_of(body).outputs, columns)
    found = {name: columns.of(name) for name in mesh_columns(body)}
    return {name: slice(part.first, part.first + part.size) for name, part in found.items()}
