"""Where the nodes of frames and shells are in a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.mesh_results import MeshShape

__all__ = ["mesh_coordinates"]


def mesh_coordinates(shape: MeshShape, results: Results, records: slice) -> NDArray[np.float64]:
    """Vectors of the nodes at some records in world axes, shape (records, n, 2 or 4, 3)."""
    from heavylift.solver.scene.meshes import FRAME_VECTORS, SHELL_VECTORS

    vectors = FRAME_VECTORS if shape.type == "frame" else SHELL_VECTORS
    parts = [results[f"{shape.name}.{vector}"][records] for vector in vectors]
    return np.stack([part.reshape(len(part), len(shape.nodes), 3) for part in parts], axis=2)
