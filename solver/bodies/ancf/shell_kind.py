"""The kind of shells, complete: importing this registers all its kernels."""

from __future__ import annotations

import heavylift.solver.bodies.ancf.advance
import heavylift.solver.bodies.ancf.energy_momentum
import heavylift.solver.bodies.ancf.joints
import heavylift.solver.bodies.ancf.record
import heavylift.solver.bodies.ancf.shell_elements
import heavylift.solver.bodies.ancf.stage
import heavylift.solver.bodies.ancf.step
import heavylift.solver.bodies.ancf.thesis  # noqa: F401
from heavylift.solver.bodies.ancf.kind import ShellMeshes

__all__ = ["ShellMeshes"]
