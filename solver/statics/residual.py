"""How much of the loads a scene at rest leaves, with the reactions of its rows as they are: no search, one look."""

from __future__ import annotations

import numpy as np

from heavylift.numerics.threads import one_blas_thread
from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.forces import StaticForces

__all__ = ["residual_at_rest"]


@one_blas_thread
def residual_at_rest(rows: StartRows) -> float:
    """Forces that joints and springs leave at the present position; what contacts bear is among what is left.

    Parameters
    ----------
    rows
        The scene; its rows have their reactions. Rows, markers and forces are written.

    Returns
    -------
    float
        Relative to the loads; 0 without any.
    """
    reaction = rows.column("reaction").copy()
    if any(kind.NODAL for kind in rows.layout.bodies):
        from heavylift.solver.statics.mesh_system import MeshSystem
        from heavylift.solver.statics.problem import measure

        return float(measure(MeshSystem(rows), 1.0, reaction[rows.rigid]).residual)
    forces = StaticForces(rows, dense=True)
    force, G, _ = forces.evaluate()
    rigid = rows.rigid
    force = force + G.T @ np.where(rigid, reaction, 0.0)
    force[rows.inertia == 0.0] = 0.0
    return forces.norm(force) / forces.weight if forces.weight > 0.0 else 0.0
