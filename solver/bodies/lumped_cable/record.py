"""What cables of lumped masses record: nodes, tensions, energies and momenta."""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector
from heavylift.solver.bodies.lumped_cable.kind import CableData, LumpedCables
from heavylift.solver.bodies.lumped_cable.lumped_cable import LumpedCableOutputs
from heavylift.solver.bodies.lumped_cable.step import elongation_force
from heavylift.solver.interface import Workspace, add_totals, record
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at, part
from heavylift.solver.scene.bodies import PointOutputs

__all__: list[str] = []

cable_outputs, point_outputs = outputs_at(LumpedCableOutputs), outputs_at(PointOutputs)


@kernel(internal=True)
def _stretch(kind: LumpedCables, node: int) -> tuple[float, float]:
    """Length of the segment behind a node [m], and its rate [m/s]."""
    square = turning = 0.0
    for k in range(3):
        r = kind.position[node + 1, k] - kind.position[node, k]
        square += r * r
        turning += r * (kind.velocity[node + 1, k] - kind.velocity[node, k])
    length = math.sqrt(square)
    return length, turning / length


@kernel(internal=True)
def _tension(cable: CableData, stretch: tuple[float, float]) -> float:
    """Of a segment: elastic, and of its damper while it carries."""
    length, rate = stretch
    carries = cable.pushes or length > cable.rest_length
    return elongation_force(cable, length) + (cable.damping * rate if carries else 0.0)


@implement(record, LumpedCables)
@kernel(internal=True)
def record_cables(kind: LumpedCables, time: float, work: Workspace, row: Floats1) -> None:
    """Nodes, segments, the cable as a whole; sensors."""
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        first, last = cable.first_node, cable.first_node + cable.node_count - 1
        position, velocity = part(row, cable.parts.position), part(row, cable.parts.velocity)
        tension = part(row, cable.parts.segment_tension)
        out = cable_outputs(row, cable.column)
        for i in range(cable.node_count):
            for k in range(3):
                position[3 * i + k] = kind.position[first + i, k]
                velocity[3 * i + k] = kind.velocity[first + i, k]
        whole, largest = 0.0, -math.inf
        for i in range(cable.node_count - 1):
            stretch = _stretch(kind, first + i)
            tension[i] = _tension(cable, stretch)
            whole += stretch[0]
            largest = max(largest, tension[i])
        for k in range(3):
            out.start_position[k] = kind.position[first, k]
            out.end_position[k] = kind.position[last, k]
        out.stretched_length = whole
        out.largest_tension = largest
    for i in range(kind.sensors.shape[0]):
        sensor = kind.sensors[i]
        node, share = int(kind.constants[sensor.data]), kind.constants[sensor.data + 1]
        seen = point_outputs(row, sensor.number)
        for k in range(3):
            seen.position[k] = (1.0 - share) * kind.position[node, k] + share * kind.position[node + 1, k]
            seen.velocity[k] = (1.0 - share) * kind.velocity[node, k] + share * kind.velocity[node + 1, k]


@kernel(inline=True, internal=True)
def _place(kind: LumpedCables, node: int) -> Vector:
    return kind.position[node, 0], kind.position[node, 1], kind.position[node, 2]


@implement(add_totals, LumpedCables)
@kernel(internal=True)
def add_cable_totals(kind: LumpedCables, work: Workspace) -> None:
    """Energies and momenta of nodes and segments."""
    totals = work.sums
    for body in range(kind.table.shape[0]):
        cable = kind.table[body]
        for i in range(cable.node_count):
            node = cable.first_node + i
            m, x = kind.mass[node], _place(kind, node)
            p = m * kind.velocity[node, 0], m * kind.velocity[node, 1], m * kind.velocity[node, 2]
            for k in range(3):
                totals.kinetic += 0.5 * p[k] * kind.velocity[node, k]
                totals.potential -= m * totals.gravity[k] * x[k]
                totals.linear_momentum[k] += p[k]
            totals.angular_momentum[0] += x[1] * p[2] - x[2] * p[1]
            totals.angular_momentum[1] += x[2] * p[0] - x[0] * p[2]
            totals.angular_momentum[2] += x[0] * p[1] - x[1] * p[0]
        for i in range(cable.node_count - 1):
            length = _stretch(kind, cable.first_node + i)[0]
            totals.elastic += 0.5 * elongation_force(cable, length) * (length - cable.rest_length)
        totals.external_work += cable.external_work
        totals.dissipated += cable.dissipated_work
