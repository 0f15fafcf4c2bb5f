"""A force on one node of a frame that turns with it."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from annotated_types import Interval

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.mesh_loads import FRAME_LOADS, MeshLoad, Turning
from heavylift.solver.scene.mesh_shapes import FrameMesh, ShellMesh
from heavylift.solver.scene.meshes import FollowerLoad

__all__ = ["FollowerForce"]


@FRAME_LOADS.describe("follower_force")
@dataclass(frozen=True, eq=False, kw_only=True)
class FollowerForce(MeshLoad, Turning):
    """A force on one node of a frame that turns with it."""

    at: Literal["start", "end"] | None = None
    """The end it acts on."""
    node: Annotated[int | None, Interval(ge=0)] = None
    """In place of `at`, the number of a node, from 0."""
    normal: Annotated[float, Quantity("force")] = 0.0
    """Along ``axis x tangent`` [N]."""
    tangential: Annotated[float, Quantity("force")] = 0.0
    """Along the tangent [N]."""

    @staticmethod
    def check(spec: Any) -> None:
        """It acts on one node."""
        MeshLoad.check(spec)
        Turning.check_load(spec)
        if (spec.at is None) == (spec.node is None):
            problem = "both 'at' and 'node'" if spec.at else "neither 'at' nor 'node'"
            raise InputError(problem, expected="one of them")

    def load(self, mesh: FrameMesh | ShellMesh) -> FollowerLoad:
        """On its node."""
        last = len(mesh.nodes) - 1
        node = {"start": 0, "end": last}[self.at] if self.at is not None else self.node
        if node is not None and node > last:
            expected = f"a number from 0 to {last}"
            raise InputError(f"there is no node {node}", key="node", expected=expected)
        return FollowerLoad(
            normal=self.normal, tangential=self.tangential, axis=self.axis, node=node, **self.table
        )
