"""A pressure on a shell, along its normal as it turns."""

from __future__ import annotations

from typing import Annotated

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.mesh_loads import SHELL_LOADS, SpreadLoad
from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh
from heavylift.solver.scene.meshes import FollowerLoad

__all__ = ["PressureLoad"]


@SHELL_LOADS.describe("pressure")
@dataclass(frozen=True, eq=False, kw_only=True)
class PressureLoad(SpreadLoad):
    """A pressure on a shell, along its normal as it turns."""

    pressure: Annotated[float, Quantity("pressure")]
    """[Pa]; along ``r_x x r_y``, which is z of a rectangle."""

    def load(self, mesh: FrameMesh | ShellMesh) -> FollowerLoad:
        """On its elements."""
        return FollowerLoad(normal=self.pressure, elements=self.chosen(mesh), **self.table)
