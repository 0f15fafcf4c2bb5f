"""Rows of joints on frames and shells: through the bases, whose compliance the factor has left in their blocks."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
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
    """``X = C G^T`` with ``C = J A^-1 J^T``, minus the blocks of the bases."""
    lanes = system.lanes
    G, half = system.panels, system.panels.shape[0] // 2
    for i in range(system.attachments.shape[0]):
        body = attached_mesh(kind, system, i)
        if body < 0:
            continue
        panel, width = system.attachments[i].panel, system.attachments[i].width
        for r in range(width * lanes):
            G[half + panel + r] = 0.0
        which = kind.body[body].stage_set if at_midpoint else MASS_SET
        _add_compliance(kind, body, which, system, panel, 3 * kind.table[body].base_count)
        add_point_compliance(kind.moving, kind, body, which, system, i)


@kernel(internal=True)
def _add_compliance(kind: Meshes, body: int, which: int, system: RowArrays, panel: int, width: int) -> None:
    """Block by block; those off the diagonal serve both triangles.

    Notes
    -----
    Rows are on a few bases of the body, one node's as a rule, which follow each other: only the part of ``G`` between
    the first and the last coordinate that is not zero is multiplied. Without that the rows of n nodes cost n^3.
    """
    lanes = system.lanes
    G, half = system.panels, system.panels.shape[0] // 2
    first, last = 0, width
    while last > 0 and not _acts(G, panel + (last - 1) * lanes, lanes):
        last -= 1
    while first < last and not _acts(G, panel + first * lanes, lanes):
        first += 1
    rows, block_lanes = len(kind.shape[0]), len(kind.shape[1])
    begin = which * set_size(kind)
    for i in range(kind.base_blocks.shape[0]):
        block = kind.base_blocks[i]
        if block.body != body:
            continue
        row, column, place = rows * block.later, rows * block.earlier, begin + block.place
        height, length = min(rows, width - row), min(rows, width - column)
        for c in range(max(first - column, 0), min(last - column, length)):
            of = panel + (column + c) * lanes
            for k in range(height):
                value, to = kind.blocks[place + c * block_lanes + k], half + panel + (row + k) * lanes
                for r in range(lanes):
                    G[to + r] -= value * G[of + r]
        if row == column:
            continue
        for k in range(max(first - row, 0), min(last - row, height)):
            of = panel + (row + k) * lanes
            for c in range(length):
                value, to = kind.blocks[place + c * block_lanes + k], half + panel + (column + c) * lanes
                for r in range(lanes):
                    G[to + r] -= value * G[of + r]


@kernel(internal=True)
def _acts(G: Floats1, at: int, lanes: int) -> bool:
    """Whether any row of a panel acts on a coordinate."""
    for r in range(lanes):  # noqa: SIM110  kernels have no generators
        if G[at + r] != 0.0:
            return True
    return False


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
