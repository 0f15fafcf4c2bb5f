"""Contacts between rigid bodies and hulls are solved on the velocities of those: many contacts, few unknowns.

``y = y0 + B N^T p`` on the velocities y of the bodies that are touched, where ``B = A^-1 - X S^-1 X^T`` is what they
feel of each other through joints and ropes. The matrix of the contacts themselves is never formed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.solve.newton import solve_contacts
from heavylift.solver.contact.system_interface import respond
from heavylift.solver.interface import Systems

__all__ = ["assemble_reduced", "solve_reduced", "sort_by_islands"]


@kernel(internal=True)
def sort_by_islands(contacts: ContactRows, count: int) -> None:
    """Contacts that take part and act on each other stand together, in their order; not where joints connect bodies."""
    reduced = contacts.reduced
    root, head = reduced.of_bodies[0], reduced.of_bodies[1]
    following, ordered = reduced.of_contacts[0], reduced.of_contacts[1]
    for j in range(count):
        for side in range(2):
            end = contacts.attachments[2 * contacts.present[j] + side]
            if end.width > 0:
                if reduced.joined[end.dof] > 0:
                    return
                root[end.dof], head[end.dof] = end.dof, -1
    for j in range(count):
        first = contacts.attachments[2 * contacts.present[j]]
        second = contacts.attachments[2 * contacts.present[j] + 1]
        if first.width > 0 and second.width > 0:
            a, b = _first_of(root, first.dof), _first_of(root, second.dof)
            root[max(a, b)] = min(a, b)
    filled = 0
    for j in range(count - 1, -1, -1):
        dof = _moving(contacts, contacts.present[j])
        if dof >= 0:
            a = _first_of(root, dof)
            following[j], head[a] = head[a], j
    for j in range(count):
        dof = _moving(contacts, contacts.present[j])
        if dof < 0:
            ordered[filled] = contacts.present[j]
            filled += 1
            continue
        a = _first_of(root, dof)
        k, head[a] = head[a], -1
        while k >= 0:
            ordered[filled] = contacts.present[k]
            filled += 1
            k = following[k]
    for j in range(count):
        contacts.present[j] = ordered[j]


@kernel(inline=True, internal=True)
def _moving(contacts: ContactRows, c: int) -> int:
    """First velocity of a body that a contact touches, -1 if neither moves."""
    first, second = contacts.attachments[2 * c], contacts.attachments[2 * c + 1]
    if first.width > 0:
        return first.dof
    return second.dof if second.width > 0 else -1


@kernel(inline=True, internal=True)
def _first_of(root: NDArray[np.int64], dof: int) -> int:
    """What stands for all that is connected with a body, as far as it is known."""
    while root[dof] != dof:
        root[dof] = root[root[dof]]
        dof = root[dof]
    return dof


@kernel(internal=True)
def assemble_reduced(contacts: ContactRows, systems: Systems, count: int) -> None:
    """Columns, blocks and matrix for the contacts that take part."""
    reduced = contacts.reduced
    head, past = reduced.problem.head, reduced.problem.past
    for j in range(reduced.problem.counts.size):
        reduced.columns[reduced.velocities[j]] = -1
    size = 0
    lanes, half = len(contacts.shape[1]), contacts.panels.shape[0] // 2
    for j in range(count):
        c = contacts.present[j]
        for side in range(2):
            i = 2 * c + side
            dof, width = contacts.attachments[i].dof, contacts.attachments[i].width
            reduced.ends[j, 2 * side + 1] = width
            if width == 0:
                reduced.ends[j, 2 * side] = 0
                continue
            if reduced.columns[dof] < 0:
                for k in range(width):
                    reduced.columns[dof + k] = size + k
                    reduced.velocities[size + k] = dof + k
                    head[size + k], past[size + k] = size, size + width
                size += width
            reduced.ends[j, 2 * side] = reduced.columns[dof]
            panel = contacts.attachments[i].panel
            for r in range(3):
                for k in range(width):
                    reduced.blocks[j, 18 * side + 6 * r + k] = contacts.panels[panel + k * lanes + r]
    reduced.problem.counts.size = size
    for j in range(size):
        if reduced.joined[reduced.velocities[head[j]]] > 0:
            head[j], past[j] = 0, size
    column = contacts.column
    for j in range(size):
        dof = reduced.velocities[j]
        first = reduced.units[dof - j % 6]
        if past[j] - head[j] < size:
            _fill_block(contacts, j, size)
            continue
        if first < 0 and contacts.inverse_mass[dof] == 0.0:  # its motion is prescribed
            for i in range(size):
                reduced.matrix[i, j] = 0.0
            continue
        for i in range(column.shape[0]):
            column[i] = 0.0
        if first < 0:
            column[dof] = contacts.inverse_mass[dof]
        else:
            at = half + contacts.attachments[first + j % 6 // 3].panel + j % 3
            for k in range(6):
                column[dof - j % 6 + k] = contacts.panels[at + k * lanes]
        respond(systems, column)
        for i in range(size):
            reduced.matrix[i, j] = column[reduced.velocities[i]]


@kernel(internal=True)
def _fill_block(contacts: ContactRows, j: int, size: int) -> None:
    """Column of B of a body that no rows reach: its own inverse mass, and nothing of those that feel all others."""
    reduced = contacts.reduced
    head, past, dof = reduced.problem.head, reduced.problem.past, reduced.velocities[j]
    first = reduced.units[dof - j % 6]
    for i in range(0, size, 6):
        if past[i] - head[i] == size:
            for k in range(i, i + 6):
                reduced.matrix[k, j] = 0.0
    lanes, half = len(contacts.shape[1]), contacts.panels.shape[0] // 2
    at = half + contacts.attachments[first + j % 6 // 3].panel + j % 3 if first >= 0 else 0
    for i in range(head[j], past[j]):
        value = contacts.inverse_mass[dof] if i == j else 0.0
        reduced.matrix[i, j] = value if first < 0 else contacts.panels[at + (i - head[j]) * lanes]


@kernel(internal=True)
def solve_reduced(contacts: ContactRows, count: int, velocity: NDArray[np.float64]) -> None:
    """Impulses into the second row of `contacts.rates`, rates without and with them into the first and third.

    How it ended is in `contacts.solution`.
    """
    reduced, free, w = contacts.reduced, contacts.rates[0], contacts.rates[2]
    size = reduced.problem.counts.size
    for i in range(size):
        reduced.found[i] = 0.0
    for j in range(count):
        for side in range(2):
            at, width = reduced.ends[j, 2 * side], reduced.ends[j, 2 * side + 1]
            for r in range(3):
                for k in range(width):
                    reduced.found[at + k] += reduced.blocks[j, 18 * side + 6 * r + k] * w[3 * j + r]
    for i in range(size):
        total = velocity[reduced.velocities[i]]
        for k in range(reduced.problem.head[i], reduced.problem.past[i]):
            total -= reduced.matrix[i, k] * reduced.found[k]
        reduced.start[i] = total
    reduced.problem.counts.number = count
    solve_contacts(contacts.solvers, reduced.problem)
    for j in range(count):
        for r in range(3):
            total = 0.0
            for side in range(2):
                at, width = reduced.ends[j, 2 * side], reduced.ends[j, 2 * side + 1]
                for k in range(width):
                    total += reduced.blocks[j, 18 * side + 6 * r + k] * reduced.found[at + k]
            w[3 * j + r] = total
            total = 0.0
            for side in range(2):
                at, width = reduced.ends[j, 2 * side], reduced.ends[j, 2 * side + 1]
                for k in range(width):
                    total += reduced.blocks[j, 18 * side + 6 * r + k] * reduced.start[at + k]
            free[3 * j + r] = total
