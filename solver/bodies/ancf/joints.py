"""Rows of joints on frames and shells: through the bases, whose compliance the factor has left in their blocks."""

from __future__ import annotations

from typing import Any

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import LANES_1, LANES_2, LANES_4, LANES_8, subtract_multiples
from heavylift.solver.bodies.ancf.assembly import set_size
from heavylift.solver.bodies.ancf.kind import MASS_SET, Meshes
from heavylift.solver.bodies.ancf.moving import add_point_compliance
from heavylift.solver.bodies.ancf.step import is_iterated, write_bases
from heavylift.solver.bodies.ancf.substitution import node_span, scatter_back
from heavylift.solver.interface import (
    Systems,
    Workspace,
    apply_inverse,
    complete,
    end_velocity,
    row_arrays,
    set_velocity,
    write_velocity,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows.structure import (
    FACTORED,
    RowArrays,
)

__all__ = ["collect_impulses", "take_impulses"]


@kernel(internal=True)
def attached_mesh(kind: Meshes, system: RowArrays, attachment: int) -> int:
    """Row of the body that an attachment is on, -1 if that is not of this kind. Velocities grow with the rows."""
    if system.attachments[attachment].holder != FACTORED or system.attachments[attachment].width == 0:
        return -1
    dof = system.attachments[attachment].dof
    for body in range(kind.table.shape[0]):
        if kind.table[body].dof == dof and kind.table[body].base_count + kind.table[body].moving_count > 0:
            return body
    return -1


@implement(apply_inverse, Meshes)
@kernel(internal=True)
def apply_inverse_of_meshes(kind: Meshes, at_midpoint: bool, system: RowArrays) -> None:
    """``X = C G^T`` with ``C = J A^-1 J^T``, minus the blocks of the bases; and where G is other than zero."""
    for i in range(system.attachments.shape[0]):
        body = attached_mesh(kind, system, i)
        if body < 0:
            continue
        _find_range(system, i)
        which = kind.body[body].stage_set if at_midpoint else MASS_SET
        if system.lanes == 1:
            _put_compliance(LANES_1, kind, body, which, system, i)
        elif system.lanes == 2:
            _put_compliance(LANES_2, kind, body, which, system, i)
        elif system.lanes == 4:
            _put_compliance(LANES_4, kind, body, which, system, i)
        else:
            _put_compliance(LANES_8, kind, body, which, system, i)
        add_point_compliance(kind.moving, kind, body, which, system, i)


@kernel(internal=True)
def _find_range(system: RowArrays, attachment: int) -> None:
    """From the first to the last coordinate that the rows act on.

    Notes
    -----
    Rows are on a few bases of the body, one node's as a rule, which follow each other: only that part of ``G`` is
    multiplied. Without that the rows of n nodes cost n^3.
    """
    side, lanes = system.attachments[attachment], system.lanes
    first, last = 0, side.width
    while last > 0 and not _acts(system.panels, side.panel + (last - 1) * lanes, lanes):
        last -= 1
    while first < last and not _acts(system.panels, side.panel + first * lanes, lanes):
        first += 1
    side.first, side.count = first, last - first


@kernel(internal=True)
def _acts(G: Floats1, at: int, lanes: int) -> bool:
    """Whether any row of a panel acts on a coordinate."""
    for r in range(lanes):  # noqa: SIM110  kernels have no generators
        if G[at + r] != 0.0:
            return True
    return False


@kernel(internal=True)
def _put_compliance(
    shape: Any, kind: Meshes, body: int, which: int, system: RowArrays, attachment: int
) -> None:
    """Block by block of the bases; those off the diagonal serve both triangles."""
    G, lanes, side = system.panels, len(shape[1]), system.attachments[attachment]
    rows, block_lanes, width = len(kind.shape[0]), len(kind.shape[1]), 3 * kind.table[body].base_count
    panel, out, begin = side.panel, G.shape[0] // 2 + side.panel, which * set_size(kind)
    first, last = side.first, min(side.first + side.count, width)
    for r in range(side.width * lanes):
        G[out + r] = 0.0
    for i in range(kind.base_blocks.shape[0]):
        block = kind.base_blocks[i]
        if block.body != body:
            continue
        row, column, place = rows * block.later, rows * block.earlier, begin + block.place
        height, length = min(rows, width - row), min(rows, width - column)
        c, count = max(first - column, 0), min(last - column, length) - max(first - column, 0)
        if count > 0:
            of, at = panel + (column + c) * lanes, place + c * block_lanes
            for k in range(height):
                subtract_multiples(
                    shape, G, out + (row + k) * lanes, G, of, kind.blocks, at + k, block_lanes, count
                )
        k, count = max(first - row, 0), min(last - row, height) - max(first - row, 0)
        if row != column and count > 0:
            of, at = panel + (row + k) * lanes, place + k
            for c in range(length):
                subtract_multiples(
                    shape, G, out + (column + c) * lanes, G, of, kind.blocks, at + c * block_lanes, 1, count
                )


@kernel(internal=True)
def collect_impulses(system: RowArrays, body_kind: Meshes, nodal: Floats1) -> None:
    """Subtract ``G^T`` times the impulses of a system from the places of the bases in a nodal vector."""
    lanes = system.lanes
    for i in range(system.attachments.shape[0]):
        body = attached_mesh(body_kind, system, i)
        if body < 0:
            continue
        panel, first = system.attachments[i].panel, body_kind.table[body].first_base
        impulse = system.rows[system.attachments[i].owner].impulse
        pushes = False
        for r in range(lanes):
            pushes = pushes or impulse[r] != 0.0
        if not pushes:  # most contacts that there may be
            continue
        for base in range(body_kind.table[body].base_count + body_kind.table[body].moving_count):
            place = body_kind.bases[first + base].place
            for k in range(3):
                total = 0.0
                for r in range(lanes):
                    total += system.panels[panel + (3 * base + k) * lanes + r] * impulse[r]
                nodal[place + k] -= total


@kernel(internal=True)
def take_impulses(kind: Meshes, systems: Systems, nodal: Floats1) -> None:
    """Minus the impulses of all rows in the places of bases and moving points, as `scatter_back` takes them."""
    for base in range(kind.bases.shape[0]):
        place = kind.bases[base].place
        for k in range(3):
            nodal[place + k] = 0.0
    for i in range(row_arrays(systems)):
        collect_impulses(row_arrays(systems, i), kind, nodal)


@implement(complete, Meshes)
@kernel(internal=True)
def complete_meshes(kind: Meshes, systems: Systems, at_midpoint: bool, step: float, work: Workspace) -> None:
    """Back substitution with the impulses of the rows; bodies that iterate have gone further already."""
    take_impulses(kind, systems, kind.right_hand_side)
    right = kind.right_hand_side
    for body in range(kind.table.shape[0]):
        first, last = node_span(kind, body)
        if at_midpoint:
            if is_iterated(kind, body) and kind.body[body].change >= 0.0:
                continue
            for i in range(first, last):
                right[i] = kind.forward_solution[i]
            scatter_back(kind, body, kind.body[body].stage_set)
            for i in range(first, last):
                kind.mid_velocity[i] = kind.velocity[i] + right[i]
        elif kind.table[body].base_node_count + kind.table[body].moving_count > 0:
            for i in range(first, last):
                right[i] = 0.0
            scatter_back(kind, body, MASS_SET)
            for i in range(first, last):
                kind.velocity[i] += right[i]


@implement(end_velocity, Meshes)
@kernel(internal=True)
def end_velocity_of_meshes(kind: Meshes, step: float, work: Workspace) -> None:
    """Those that `advance` has found."""
    write_bases(kind, kind.velocity, work.velocity)


@implement(write_velocity, Meshes)
@kernel(internal=True)
def write_velocity_of_meshes(kind: Meshes, work: Workspace) -> None:
    """Of bases and moving points."""
    write_bases(kind, kind.velocity, work.velocity)


@implement(set_velocity, Meshes)
@kernel(internal=True)
def set_velocity_of_meshes(kind: Meshes, step: float, work: Workspace) -> None:
    """`complete` has set them."""
