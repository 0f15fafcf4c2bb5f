"""Hulls in a record: state, buoyancy, forces of waves and radiation; energies with those of the water."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import add, cross, rotate, scaled
from heavylift.solver.bodies.rigid.record import add_rigid_totals, record_rigid_bodies
from heavylift.solver.bodies.rigid.step import stage_at_state
from heavylift.solver.interface import (
    Workspace,
    add_totals,
    record,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.ballast import PumpOutputs
from heavylift.solver.scene.sea import HullOutputs, TankOutputs
from heavylift.solver.water.hulls.kind import (
    CLIPPED,
    LINEAR,
    Hulls,
    restore_at_rest,
)
from heavylift.solver.water.hulls.matrix import restore, restoring_potential
from heavylift.solver.water.hulls.parts import memory_now
from heavylift.solver.water.hulls.step import (
    find_waves,
    put_transform,
    to_hydrodynamic,
)
from heavylift.solver.water.hulls.tanks import fill_tanks, pump_at, put_level, put_tank_velocity

__all__: list[str] = []

hull_outputs, tank_outputs = outputs_at(HullOutputs), outputs_at(TankOutputs)
pump_outputs = outputs_at(PumpOutputs)


@kernel(internal=True)
def _set_stage(kind: Hulls, time: float) -> None:
    """The stage at the carried state, with the velocities of the reference points."""
    stage_at_state(kind)
    fill_tanks(kind, time)
    put_level(kind, time)
    for hull in range(kind.table.shape[0]):
        R = kind.frame[hull].mid_rotation
        stage, seen = kind.stage[hull], kind.state[hull].low_pass
        stage.place[0], stage.place[1], stage.heading = seen[0], seen[2], seen[4]
        put_transform(kind, hull, stage.heading, R, stage.transform)
        to_hydrodynamic(stage.transform, hull, kind.frame[hull].twist, kind.vectors.finish)
        for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
            put_tank_velocity(kind, hull, tank, R)


@implement(restore_at_rest, Hulls)
@kernel(internal=True)
def restore_hulls_at_rest(kind: Hulls) -> None:
    """With the tanks of that time, and its tide."""
    stage_at_state(kind)
    fill_tanks(kind, 0.0)
    put_level(kind, 0.0)
    for hull in range(kind.table.shape[0]):
        restore(kind, hull)


@implement(record, Hulls)
@kernel(internal=True)
def record_hulls(kind: Hulls, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Columns of a rigid body, then those of a hull."""
    record_rigid_bodies(kind, time, work, row)
    _set_stage(kind, time)
    find_waves(kind, time)
    vectors = kind.vectors
    for i in range(vectors.known.shape[0]):
        vectors.known[i] = 0.0
    memory_now(kind.radiation, vectors)
    for hull in range(kind.table.shape[0]):
        restore(kind, hull)
        out = hull_outputs(row, kind.hulls[hull].column)
        volume, x, y, z = _displaced(kind, hull)
        out.displaced_volume = volume
        out.buoyancy_centre[0], out.buoyancy_centre[1], out.buoyancy_centre[2] = x, y, z
        ballast = 0.0
        for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
            ballast += kind.tanks[tank].mass
        out.ballast = ballast
        out.wave_elevation = wave_elevation(kind, hull, time)
        for i in range(3):
            out.wave_force[i] = vectors.wave[6 * hull + i]
            out.wave_moment[i] = vectors.wave[6 * hull + 3 + i]
            out.radiation_force[i] = _radiated(kind, hull, i)
            out.radiation_moment[i] = _radiated(kind, hull, 3 + i)
        out.water_level = kind.water.level
    for t in range(kind.tanks.shape[0]):
        of_tank = tank_outputs(row, kind.tanks[t].column)
        of_tank.mass, of_tank.depth = kind.tanks[t].mass, kind.tanks[t].depth
    for p in range(kind.pumps.shape[0]):
        of_pump = pump_outputs(row, kind.pumps[p].column)
        of_pump.flow, of_pump.command, of_pump.pumped = pump_at(kind, p, time)


@kernel(internal=True)
def _radiated(kind: Hulls, hull: int, i: int) -> float:
    """Force of memory and damping on a hull along one of its hydrodynamic coordinates [N, N m]."""
    vectors, at = kind.vectors, 6 * hull + i
    force = vectors.known[at]
    for j in range(vectors.known.shape[0]):
        force -= kind.damping[at, j] * vectors.finish[j]
    return force - kind.hulls[hull].quadratic_damping[i] * abs(vectors.finish[at]) * vectors.finish[at]


@kernel(internal=True)
def wave_elevation(kind: Hulls, hull: int, time: float) -> float:
    """Of the undisturbed waves at the low-passed place of the reference point [m]."""
    x, y = kind.stage[hull].place[0], kind.stage[hull].place[1]
    total = 0.0
    for m in range(kind.gauge.shape[0]):
        wave = kind.gauge[m]
        total += wave.amplitude * math.cos(wave.kx * x + wave.ky * y - wave.omega * time - wave.phase)
    return total


@kernel(internal=True)
def _displaced(kind: Hulls, hull: int) -> tuple[float, float, float, float]:
    """Volume and its centre in the world; the place of the hull if there is none."""
    sort = kind.hulls[hull].restoring
    frame = kind.frame[hull]
    x, y, z = frame.position[0], frame.position[1], frame.position[2]
    if sort == CLIPPED:
        clip = kind.stage[hull].clip
        V = clip.volume
        if V > 0.0:
            return V, x + clip.moment[0] / V, y + clip.moment[1] / V, kind.water.level + clip.moment[2] / V
        return 0.0, x, y, z
    if sort == LINEAR:
        centre = kind.hulls[hull].buoyancy_centre
        b = rotate(kind.frame[hull].mid_rotation, centre)
        return kind.stage[hull].lift[2] / kind.water.weight, x + b[0], y + b[1], z + b[2]
    return 0.0, x, y, z


@implement(add_totals, Hulls)
@kernel(internal=True)
def add_hull_totals(kind: Hulls, work: Workspace) -> None:
    """Those of rigid bodies, ballast, kinetic energy of the added mass, potential of the buoyancy."""
    add_rigid_totals(kind, work)
    totals, vectors = work.sums, kind.vectors
    for i in range(vectors.known.shape[0]):
        for j in range(vectors.known.shape[0]):
            totals.kinetic += 0.5 * vectors.finish[i] * kind.added_mass[i, j] * vectors.finish[j]
    for hull in range(kind.table.shape[0]):
        totals.potential += restoring_potential(kind, hull)
        totals.external_work += kind.state[hull].supplied
        totals.dissipated += kind.state[hull].lost
        R = kind.frame[hull].mid_rotation
        for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
            m = kind.tanks[tank].mass
            arm = rotate(R, kind.tanks[tank].point)
            l = cross(add(kind.frame[hull].mid_position, arm), scaled(m, kind.tanks[tank].velocity))
            for k in range(3):
                totals.angular_momentum[k] += l[k]
                v = kind.tanks[tank].velocity[k]
                totals.kinetic += 0.5 * m * v * v
                totals.linear_momentum[k] += m * v
                totals.potential -= m * work.sums.gravity[k] * (kind.frame[hull].mid_position[k] + arm[k])
