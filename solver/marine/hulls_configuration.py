"""Hulls before time starts: poses, velocities and forces at rest as vectors of the whole scene, in Python."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.objects import entry
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.bodies.rigid_configuration import (
    move_rigid_bodies,
    put_rigid_velocity,
    survey_rigid_bodies,
)
from heavylift.solver.bodies.rigid_stage import stage_at_state
from heavylift.solver.interface import (
    FORCES,
    Workspace,
    collect_load,
    move,
    put_velocity,
    survey,
)
from heavylift.solver.kinds import implement
from heavylift.solver.marine.hull_restoring import restore
from heavylift.solver.marine.hull_stage import fill_tanks
from heavylift.solver.marine.hulls import Hulls, start_filters

__all__: list[str] = []

implement(survey, Hulls)(survey_rigid_bodies)


@implement(move, Hulls)
def move_hulls(kind: Hulls, increment: NDArray[np.float64]) -> None:
    """As rigid bodies; the waves see them where they are."""
    move_rigid_bodies(kind, increment)
    start_filters(kind)


@implement(put_velocity, Hulls)
def put_hull_velocity(kind: Hulls, velocity: NDArray[np.float64]) -> None:
    """As rigid bodies; the waves see them where they are."""
    put_rigid_velocity(kind, velocity)
    start_filters(kind)


@entry
def restore_at_rest(kind: Hulls) -> None:
    """Buoyancy and ballast at the carried state and at the start of time."""
    stage_at_state(kind)
    fill_tanks(kind, 0.0)
    for hull in range(kind.table.shape[0]):
        restore(kind, hull)


@implement(collect_load, Hulls)
def collect_hull_load(kind: Hulls, work: Workspace, load: NDArray[np.float64]) -> None:
    """``J^T f`` of the markers that forces act on, buoyancy, weight of body and ballast."""
    restore_at_rest(kind)
    dofs = kind.table["dof"][:, None] + np.arange(6)
    for marker in kind.markers:
        if marker.level == FORCES:
            number, body = marker.number, marker.body
            at = kind.hulls[body].offset
            J = work.jacobian[number][:, at : at + 6]
            load[dofs[body]] += J.T @ work.markers[number].force
    load[dofs] += kind.stage["lift"]
    gravity = work.sums.gravity
    load[dofs[:, :3]] += kind.frame["mass"][:, None] * gravity
    for tank in kind.tanks:
        body, weight = tank.hull, tank.mass * gravity
        R = rotation_matrix(kind.frame[body].orientation)
        load[dofs[body, :3]] += weight
        load[dofs[body, 3:]] += np.cross(tank.point, R.T @ weight)
