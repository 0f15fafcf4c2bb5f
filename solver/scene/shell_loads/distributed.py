"""A load on a shell that keeps its direction."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.solver.scene.mesh_loads import SHELL_LOADS, SpreadLoad
from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh
from heavylift.solver.scene.meshes import DistributedLoad

__all__ = ["AreaLoad"]


@SHELL_LOADS.describe("distributed")
@dataclass(frozen=True, eq=False, kw_only=True)
class AreaLoad(SpreadLoad):
    """A load on a shell that keeps its direction."""

    force: Annotated[NDArray[np.float64], Quantity("pressure"), Shape((3,))]
    """World axes, a square metre of the unloaded area [N/m^2]."""

    def load(self, mesh: FrameMesh | ShellMesh) -> DistributedLoad:
        """On its elements."""
        return DistributedLoad(self.force, elements=self.chosen(mesh), **self.table)
