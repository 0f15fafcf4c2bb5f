"""Hulls in a record: state, buoyancy, forces of waves and radiation; energies with those of the water."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import cross, rotate
from heavylift.solver.bodies.rigid_record import add_rigid_totals, record_rigid_bodies
from heavylift.solver.bodies.rigid_stage import stage_at_state, stage_rotation
from heavylift.solver.interface import (
    Workspace,
    add_totals,
    record,
)
from heavylift.solver.kinds import implement
from heavylift.solver.marine.clipping import VOLUME, VOLUME_X, VOLUME_Y, VOLUME_Z
from heavylift.solver.marine.hull_parts import memory_now
from heavylift.solver.marine.hull_restoring import restore, restoring_potential
from heavylift.solver.marine.hull_stage import (
    fill_tanks,
    find_waves,
    put_tank_velocity,
    put_transform,
    to_hydrodynamic,
)
from heavylift.solver.marine.hulls import (
    BUOYANCY,
    CLIP,
    CLIPPED,
    FINISH,
    FIRST_TANK,
    HEADING,
    KNOWN,
    LAST_TANK,
    LIFT,
    LINEAR,
    LOST,
    LOW_PASS,
    PLACE,
    QUADRATIC,
    RESTORING,
    STATE_WIDTH,
    SUPPLIED,
    TANK_MASS,
    TANK_POINT,
    TANK_VELOCITY,
    TRANSFORM,
    WAVE,
    Hulls,
)

__all__: list[str] = []


@kernel(internal=True)
def _set_stage(kind: Hulls, time: float) -> None:
    """The stage at the carried state, with the velocities of the reference points."""
    stage_at_state(kind)
    fill_tanks(kind, time)
    for hull in range(kind.table.shape[0]):
        R = stage_rotation(kind, hull)
        at = STATE_WIDTH * hull + LOW_PASS
        stage = kind.stage[hull]
        stage[PLACE], stage[PLACE + 1], stage[HEADING] = (
            kind.state[at],
            kind.state[at + 2],
            kind.state[at + 4],
        )
        put_transform(kind, hull, TRANSFORM, stage[HEADING], R)
        to_hydrodynamic(kind, hull, TRANSFORM, FINISH, kind.frame[hull].twist)
        for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
            put_tank_velocity(kind, hull, tank, R)


@implement(record, Hulls)
@kernel(internal=True)
def record_hulls(kind: Hulls, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Columns of a rigid body, then `HULL_CHANNELS`."""
    record_rigid_bodies(kind, time, work, row)
    _set_stage(kind, time)
    find_waves(kind, time)
    vectors = kind.vectors
    for i in range(vectors.shape[1]):
        vectors[KNOWN, i] = 0.0
    memory_now(kind.radiation, vectors)
    for hull in range(kind.table.shape[0]):
        restore(kind, hull)
        out = kind.table[hull].column + 13
        volume, x, y, z = _displaced(kind, hull)
        row[out], row[out + 1], row[out + 2], row[out + 3] = volume, x, y, z
        ballast = 0.0
        for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
            ballast += kind.tanks[tank, TANK_MASS]
        row[out + 4] = ballast
        row[out + 5] = wave_elevation(kind, hull, time)
        for i in range(6):
            at = 6 * hull + i
            row[out + 6 + i] = vectors[WAVE, at]
            force = vectors[KNOWN, at]
            for j in range(vectors.shape[1]):
                force -= kind.damping[at, j] * vectors[FINISH, j]
            force -= kind.hull[hull, QUADRATIC + i] * abs(vectors[FINISH, at]) * vectors[FINISH, at]
            row[out + 12 + i] = force


@kernel(internal=True)
def wave_elevation(kind: Hulls, hull: int, time: float) -> float:
    """Of the undisturbed waves at the low-passed place of the reference point [m]."""
    x, y = kind.stage[hull, PLACE], kind.stage[hull, PLACE + 1]
    gauge, total = kind.gauge, 0.0
    for m in range(gauge.shape[1]):
        total += gauge[4, m] * math.cos(gauge[1, m] * x + gauge[2, m] * y - gauge[0, m] * time - gauge[3, m])
    return total


@kernel(internal=True)
def _displaced(kind: Hulls, hull: int) -> tuple[float, float, float, float]:
    """Volume and its centre in the world; the place of the hull if there is none."""
    sort = kind.hulls[hull, RESTORING]
    frame = kind.frame[hull]
    x, y, z = frame.position[0], frame.position[1], frame.position[2]
    if sort == CLIPPED:
        clip = kind.stage[hull, CLIP : CLIP + 12]
        V = clip[VOLUME]
        if V > 0.0:
            return V, x + clip[VOLUME_X] / V, y + clip[VOLUME_Y] / V, kind.water[2] + clip[VOLUME_Z] / V
        return 0.0, x, y, z
    if sort == LINEAR:
        data = kind.hull[hull]
        b = rotate(stage_rotation(kind, hull), data[BUOYANCY], data[BUOYANCY + 1], data[BUOYANCY + 2])
        return kind.stage[hull, LIFT + 2] / kind.water[0], x + b[0], y + b[1], z + b[2]
    return 0.0, x, y, z


@implement(add_totals, Hulls)
@kernel(internal=True)
def add_hull_totals(kind: Hulls, work: Workspace) -> None:
    """Those of rigid bodies, ballast, kinetic energy of the added mass, potential of the buoyancy."""
    add_rigid_totals(kind, work)
    totals, vectors = work.sums, kind.vectors
    for i in range(vectors.shape[1]):
        for j in range(vectors.shape[1]):
            totals.kinetic += 0.5 * vectors[FINISH, i] * kind.added_mass[i, j] * vectors[FINISH, j]
    for hull in range(kind.table.shape[0]):
        totals.potential += restoring_potential(kind, hull)
        totals.external_work += kind.state[STATE_WIDTH * hull + SUPPLIED]
        totals.dissipated += kind.state[STATE_WIDTH * hull + LOST]
        R = stage_rotation(kind, hull)
        for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
            m = kind.tanks[tank, TANK_MASS]
            arm = rotate(
                R,
                kind.tanks[tank, TANK_POINT],
                kind.tanks[tank, TANK_POINT + 1],
                kind.tanks[tank, TANK_POINT + 2],
            )
            l1, l2, l3 = cross(
                kind.frame[hull].mid_position[0] + arm[0],
                kind.frame[hull].mid_position[1] + arm[1],
                kind.frame[hull].mid_position[2] + arm[2],
                m * kind.tanks[tank, TANK_VELOCITY],
                m * kind.tanks[tank, TANK_VELOCITY + 1],
                m * kind.tanks[tank, TANK_VELOCITY + 2],
            )
            totals.angular_momentum[0] += l1
            totals.angular_momentum[1] += l2
            totals.angular_momentum[2] += l3
            for k in range(3):
                v = kind.tanks[tank, TANK_VELOCITY + k]
                totals.kinetic += 0.5 * m * v * v
                totals.linear_momentum[k] += m * v
                totals.potential -= m * work.sums.gravity[k] * (kind.frame[hull].mid_position[k] + arm[k])
