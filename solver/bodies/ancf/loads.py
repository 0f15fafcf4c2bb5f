"""External forces of a stage on a mesh: its own loads and the forces on its bases."""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.elements import add_follower_load
from heavylift.solver.bodies.ancf.frame_data import frame_follower
from heavylift.solver.bodies.ancf.kind import DEAD_LOAD, FOLLOWER_ELEMENT, Meshes
from heavylift.solver.interface import FORCES, Workspace

__all__ = ["gather_loads"]


@kernel(internal=True)
def _factor(kind: Meshes, load: int, time: float) -> float:
    """Factor of a load at a time, linear between the rows of its table."""
    table, count = kind.loads[load].table, kind.loads[load].table_length
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if kind.constants[table + middle] <= time:
            low = middle
        else:
            high = middle
    span = kind.constants[table + high] - kind.constants[table + low]
    part = min(max((time - kind.constants[table + low]) / span, 0.0), 1.0) if span > 0.0 else 0.0
    before, after = kind.constants[table + count + low], kind.constants[table + count + high]
    return before + part * (after - before)


@kernel(internal=True)
def _add_node_follower(kind: Meshes, q: Floats1, place: int, data: int, factor: float) -> None:
    """Force on a node of a frame, along its tangent and square to that and an axis."""
    t1, t2, t3 = q[place + 3], q[place + 4], q[place + 5]
    size = 1.0 / math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    t1, t2, t3 = size * t1, size * t2, size * t3
    given = frame_follower(kind.constants, data)
    normal, along = factor * given.normal, factor * given.tangential
    a1, a2, a3 = given.axis[0], given.axis[1], given.axis[2]
    load = kind.external_force
    load[place] += normal * (a2 * t3 - a3 * t2) + along * t1
    load[place + 1] += normal * (a3 * t1 - a1 * t3) + along * t2
    load[place + 2] += normal * (a1 * t2 - a2 * t1) + along * t3


@kernel(internal=True)
def _add_marker_forces(kind: Meshes, work: Workspace) -> None:
    """Forces on markers to the bases: ``J^T f``, then from these to the nodes."""
    load = kind.external_force
    vectors = len(kind.shape[0]) // 3
    nodes = 2 if vectors == 2 else 4
    for base in range(kind.bases.shape[0]):
        place = kind.bases[base].place
        for k in range(3):
            load[place + k] = 0.0
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level != FORCES:
            continue
        number, body = kind.markers[marker].number, kind.markers[marker].body
        force, J = work.markers[number], work.jacobian[number]
        first = kind.table[body].first_base
        for i in range(kind.table[body].base_count):
            place = kind.bases[first + i].place
            for c in range(3):
                column = 3 * i + c
                load[place + c] += (
                    J[0, column] * force.force[0]
                    + J[1, column] * force.force[1]
                    + J[2, column] * force.force[2]
                )
    for base in range(kind.bases.shape[0]):
        element, shape = kind.bases[base].element, kind.bases[base].shape_values
        place = kind.bases[base].place
        f1, f2, f3 = load[place], load[place + 1], load[place + 2]
        if f1 == 0.0 and f2 == 0.0 and f3 == 0.0:
            continue
        for i in range(nodes):
            for a in range(vectors):
                at = kind.elements[element].nodes[i] + 3 * a
                value = kind.constants[shape + i * vectors + a]
                load[at] += value * f1
                load[at + 1] += value * f2
                load[at + 2] += value * f3
    for base in range(kind.bases.shape[0]):
        place = kind.bases[base].place
        for k in range(3):
            load[place + k] = 0.0


@kernel(internal=True)
def gather_loads(kind: Meshes, q: Floats1, work: Workspace) -> None:
    """External forces into `external_force`, at the time of the stage and some coordinates; without gravity."""
    lanes = len(kind.shape[1])
    load = kind.external_force
    for i in range(load.shape[0]):
        load[i] = 0.0
    for body in range(kind.table.shape[0]):
        first = kind.table[body].first_load
        table, factor = -1, 0.0
        for i in range(first, first + kind.table[body].load_count):
            data, place = kind.loads[i].data, kind.loads[i].place
            if kind.loads[i].table != table:
                table, factor = kind.loads[i].table, _factor(kind, i, kind.body[body].time)
            if kind.loads[i].type == DEAD_LOAD:
                begin = kind.table[body].first_node * lanes
                for j in range(kind.table[body].node_count * lanes):
                    load[begin + j] += factor * kind.constants[data + j]
            elif kind.loads[i].type == FOLLOWER_ELEMENT:
                add_follower_load(kind, body, q, place, load, data, factor)
            else:
                _add_node_follower(kind, q, place, data, factor)
    if kind.markers.shape[0] > 0:
        _add_marker_forces(kind, work)
