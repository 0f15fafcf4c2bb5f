"""Points and directions on flexible bodies: vectors, rates, Jacobian windows, generalised forces, sensors.

A point is the nearest node of the finite-element model and moves with its displacement. A direction turns with
the frame only: a joint on a flexible body follows the displacement of its node, but not the rotation of the
surface there relative to the frame.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross, rotate
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies
from heavylift.solver.bodies.frames.motion import add_wrench, write_point
from heavylift.solver.interface import (
    ROWS,
    Workspace,
)

__all__ = ["add_joint_forces", "gather_marker_forces", "write_markers", "write_sensor"]


@kernel(internal=True)
def write_markers(kind: FloatingFrameBodies, level: int, work: Workspace) -> None:
    """Write vectors, rates and Jacobian windows ``[1, -R u~, R Phi]`` of all markers at the stage."""
    for marker in range(kind.markers.shape[0]):
        packed = kind.markers[marker]
        number, body, start, serves = packed.number, packed.body, packed.data, packed.level
        direction = packed.direction
        if serves > level:
            continue
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        data = kind.constants[start:]
        frame = kind.frame[body]
        R = frame.mid_rotation
        modes = slice(first, first + n)
        mid_modal_position = kind.mid_modal_position[modes]
        mid_modal_velocity = kind.mid_modal_velocity[modes]
        u1, u2, u3 = data[0], data[1], data[2]
        d1 = d2 = d3 = 0.0
        jacobian = work.jacobian[number]
        if not direction:
            for i in range(n):
                q, qd = mid_modal_position[i], mid_modal_velocity[i]
                phi1, phi2, phi3 = data[3 + i], data[3 + n + i], data[3 + 2 * n + i]
                u1 += phi1 * q
                u2 += phi2 * q
                u3 += phi3 * q
                d1 += phi1 * qd
                d2 += phi2 * qd
                d3 += phi3 * qd
                for k in range(3):
                    jacobian[k, 6 + i] = R[3 * k] * phi1 + R[3 * k + 1] * phi2 + R[3 * k + 2] * phi3
        else:
            for i in range(6, 6 + n):
                jacobian[0, i] = jacobian[1, i] = jacobian[2, i] = 0.0
        w1, w2, w3 = frame.mid_spin[0], frame.mid_spin[1], frame.mid_spin[2]
        c1, c2, c3 = cross((w1, w2, w3), (u1, u2, u3))
        point = rotate(R, (u1, u2, u3))
        if not direction:
            rate = rotate(
                R,
                (
                    frame.mid_velocity[0] + c1 + d1,
                    frame.mid_velocity[1] + c2 + d2,
                    frame.mid_velocity[2] + c3 + d3,
                ),
            )
        else:
            rate = rotate(R, (c1, c2, c3))
        for k in range(3):
            work.markers[number].point[k] = point[k] + (frame.mid_position[k] if not direction else 0.0)
            work.markers[number].velocity[k] = rate[k]
            for j in range(3):
                jacobian[k, j] = 1.0 if (j == k and not direction) else 0.0
            jacobian[k, 3] = R[3 * k + 2] * u2 - R[3 * k + 1] * u3
            jacobian[k, 4] = R[3 * k] * u3 - R[3 * k + 2] * u1
            jacobian[k, 5] = R[3 * k + 1] * u1 - R[3 * k] * u2


@kernel(internal=True)
def gather_marker_forces(kind: FloatingFrameBodies, work: Workspace) -> None:
    """Generalised forces ``J^T f`` of all markers, into the stages of their bodies."""
    for body in range(kind.table.shape[0]):
        for j in range(6):
            kind.frame[body].wrench[j] = 0.0
    for i in range(kind.modal_position.shape[0]):
        kind.modal_load[i] = 0.0
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level == ROWS:
            continue
        number, body = kind.markers[marker].number, kind.markers[marker].body
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        f1, f2, f3 = (
            work.markers[number].force[0],
            work.markers[number].force[1],
            work.markers[number].force[2],
        )
        jacobian = work.jacobian[number]
        modes = slice(first, first + n)
        modal_load = kind.modal_load[modes]
        add_wrench(kind.frame[body], jacobian, 0, work.markers[number].force)
        for i in range(n):
            modal_load[i] += jacobian[0, 6 + i] * f1 + jacobian[1, 6 + i] * f2 + jacobian[2, 6 + i] * f3


@kernel(internal=True)
def add_joint_forces(kind: FloatingFrameBodies, body: int, work: Workspace) -> None:
    """Add to the gathered forces those of the rows at the carried state."""
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    for j in range(6):
        kind.frame[body].wrench[j] += work.row_force[dof + j]
    for i in range(n):
        kind.modal_load[first + i] += work.row_force[dof + 6 + i]


@kernel(reassociate=True, internal=True)
def write_sensor(kind: FloatingFrameBodies, sensor: int, row: NDArray[np.float64]) -> None:
    """World position and velocity of a sensor point; the stage holds the carried state."""
    column, body, start = kind.sensors[sensor].number, kind.sensors[sensor].body, kind.sensors[sensor].data
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    data = kind.constants[start:]
    frame = kind.frame[body]
    modes = slice(first, first + n)
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    u1, u2, u3 = data[0], data[1], data[2]
    d1 = d2 = d3 = 0.0
    for i in range(n):
        q, qd = modal_position[i], modal_velocity[i]
        u1 += data[3 + i] * q
        u2 += data[3 + n + i] * q
        u3 += data[3 + 2 * n + i] * q
        d1 += data[3 + i] * qd
        d2 += data[3 + n + i] * qd
        d3 += data[3 + 2 * n + i] * qd
    write_point(frame, (u1, u2, u3), (d1, d2, d3), row, column)
