"""A load along a frame that turns with it."""

from __future__ import annotations

from typing import Annotated, Any

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.mesh_loads import FRAME_LOADS, SpreadLoad, Turning
from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh
from heavylift.solver.scene.meshes import FollowerLoad

__all__ = ["LineFollower"]


@FRAME_LOADS.describe("follower")
@dataclass(frozen=True, eq=False, kw_only=True)
class LineFollower(SpreadLoad, Turning):
    """A load along a frame that turns with it."""

    normal: Annotated[float, Quantity("force per length")] = 0.0
    """Along ``axis x tangent`` [N/m]."""
    tangential: Annotated[float, Quantity("force per length")] = 0.0
    """Along the tangent [N/m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """It acts."""
        SpreadLoad.check(spec)
        Turning.check_load(spec)

    def load(self, mesh: FrameMesh | ShellMesh) -> FollowerLoad:
        """On its elements."""
        return FollowerLoad(
            normal=self.normal,
            tangential=self.tangential,
            axis=self.axis,
            elements=self.chosen(mesh),
            **self.table,
        )
