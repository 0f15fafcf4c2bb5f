"""Records of frames and shells: nodal vectors in world axes, stresses, energies and momenta."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross
from heavylift.solver.bodies.ancf.assembly import add_matrix_products
from heavylift.solver.bodies.ancf.elements import (
    find_strains,
    measure_drift,
    measure_strain_energy,
    record_elements,
)
from heavylift.solver.bodies.ancf.kind import Meshes
from heavylift.solver.bodies.ancf.substitution import node_span
from heavylift.solver.interface import (
    Sums,
    Workspace,
    add_totals,
    record,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.bodies import PointOutputs
from heavylift.solver.scene.meshes import DriftOutputs

__all__ = ["write_nodes"]

point_outputs, drift_outputs = outputs_at(PointOutputs), outputs_at(DriftOutputs)


@kernel(internal=True)
def write_nodes(kind: Meshes, body: int, nodal: Floats1, vector: int, origin: float, out: Floats1) -> None:
    """A vector of all nodes in world axes, shape (3 nodes,); `origin` times that of the body is added."""
    lanes = len(kind.shape[1])
    R = kind.body[body]
    first = kind.table[body].first_node
    for node in range(kind.table[body].node_count):
        place = (first + node) * lanes + 3 * vector
        for k in range(3):
            out[3 * node + k] = (
                R.rotation[k, 0] * nodal[place]
                + R.rotation[k, 1] * nodal[place + 1]
                + R.rotation[k, 2] * nodal[place + 2]
                + origin * R.origin[k]
            )


@kernel(internal=True)
def _write_sensors(kind: Meshes, row: NDArray[np.float64]) -> None:
    """Position and velocity of material points."""
    vectors = len(kind.shape[0]) // 3
    nodes = len(kind.ends)
    for sensor in range(kind.sensors.shape[0]):
        at_point = kind.sensors[sensor]
        element, shape = at_point.element, at_point.shape_values
        R, out = kind.body[at_point.body], point_outputs(row, at_point.column)
        for which in range(2):
            nodal, seen = kind.position, out.position
            if which == 1:
                nodal, seen = kind.velocity, out.velocity
            x = y = z = 0.0
            for i in range(nodes):
                for a in range(vectors):
                    at, value = (
                        kind.elements[element].nodes[i] + 3 * a,
                        kind.constants[shape + i * vectors + a],
                    )
                    x += value * nodal[at]
                    y += value * nodal[at + 1]
                    z += value * nodal[at + 2]
            for k in range(3):
                total = R.rotation[k, 0] * x + R.rotation[k, 1] * y + R.rotation[k, 2] * z
                seen[k] = total + (R.origin[k] if which == 0 else 0.0)


@implement(record, Meshes)
@kernel(internal=True)
def record_meshes(kind: Meshes, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Nodal vectors, velocities of the nodes, results of the elements, drift of the carried strains; sensors."""
    for body in range(kind.table.shape[0]):
        record_elements(kind, body, row)
        find_strains(kind, body, kind.position, kind.shape_strain)
        measure_drift(kind, body, kind.strain, kind.shape_strain)
        drift_outputs(row, kind.table[body].drift).strain_drift = kind.body[body].drift
    _write_sensors(kind, row)


@kernel(internal=True)
def _add_angular_momentum(kind: Meshes, body: int, out: Sums) -> None:
    """About the world origin: ``sum M_ab r_a x v_b`` in body axes, then with the origin of the body."""
    vectors = len(kind.shape[0]) // 3
    nodes = len(kind.ends)
    count = nodes * vectors
    q, v, R = kind.position, kind.velocity, kind.body[body]
    x = y = z = 0.0
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        M = kind.elements[e].data
        for i in range(count):
            a = kind.elements[e].nodes[i // vectors] + 3 * (i % vectors)
            for j in range(count):
                b, m = (
                    kind.elements[e].nodes[j // vectors] + 3 * (j % vectors),
                    kind.constants[M + i * count + j],
                )
                x += m * (q[a + 1] * v[b + 2] - q[a + 2] * v[b + 1])
                y += m * (q[a + 2] * v[b] - q[a] * v[b + 2])
                z += m * (q[a] * v[b + 1] - q[a + 1] * v[b])
    for k in range(3):
        out.angular_momentum[k] += R.rotation[k, 0] * x + R.rotation[k, 1] * y + R.rotation[k, 2] * z
    of_origin = cross(R.origin, (R.scratch[0, 0], R.scratch[0, 1], R.scratch[0, 2]))
    for k in range(3):
        out.angular_momentum[k] += of_origin[k]


@implement(add_totals, Meshes)
@kernel(internal=True, reassociate=True)
def add_mesh_totals(kind: Meshes, work: Workspace) -> None:
    """Energies with the carried strains, which are those of the shape where the scheme iterates."""
    lanes, rows = len(kind.shape[1]), len(kind.shape[0])
    sums = work.sums
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        R = kind.body[body]
        right, q, v, weight = kind.right_hand_side, kind.position, kind.velocity, kind.nodal_mass
        for i in range(first, last):
            right[i] = 0.0
        add_matrix_products(kind, body, v, 1.0, q, 0.0, right)
        kinetic = bending = 0.0
        for i in range(first, last):
            kinetic += right[i] * v[i]
            right[i] = 0.0
        add_matrix_products(kind, body, v, 0.0, q, 1.0, right)
        for i in range(first, last):
            bending += right[i] * q[i]
        R.elastic_energy = 0.5 * bending
        measure_strain_energy(kind, body, kind.strain)
        p1 = p2 = p3 = s1 = s2 = s3 = 0.0
        for node in range(first, last, lanes):
            for a in range(0, rows, 3):
                w = weight[node + a]
                p1 += w * v[node + a]
                p2 += w * v[node + a + 1]
                p3 += w * v[node + a + 2]
                s1 += w * q[node + a]
                s2 += w * q[node + a + 1]
                s3 += w * q[node + a + 2]
        sums.kinetic += 0.5 * kinetic
        sums.elastic += R.elastic_energy
        for k in range(3):
            p = R.rotation[k, 0] * p1 + R.rotation[k, 1] * p2 + R.rotation[k, 2] * p3
            s = R.rotation[k, 0] * s1 + R.rotation[k, 1] * s2 + R.rotation[k, 2] * s3
            R.scratch[0, k] = p
            sums.linear_momentum[k] += p
            sums.potential -= sums.gravity[k] * (s + R.mass * R.origin[k])
        _add_angular_momentum(kind, body, sums)
        sums.external_work += R.external_work
        sums.dissipated += R.dissipated_work
