"""Compiled parts of the statics of scenes with meshes."""

from __future__ import annotations

from heavylift.numerics.objects import entry
from heavylift.solver.integrate.loop import evaluate_forces
from heavylift.solver.interface import FORCES, Bodies, Forces, Workspace

__all__ = ["evaluate_loads"]


@entry
def evaluate_loads(bodies: Bodies, forces: Forces, work: Workspace, time: float) -> None:
    """Markers and forces at the carried state."""
    evaluate_forces(bodies, forces, work, time, False, FORCES)
