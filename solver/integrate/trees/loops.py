"""Rows that hold trees together: joints that close loops, and joints of other types.

With the accelerations X that a unit force of each row gives, and rows G on bodies::

    S = G X,    ( S + delta D ) l = target - G a_0,    a = a_0 + X l

A force of a row goes inward through the articulated inertias, which are there, and its accelerations come outward. So
the mass matrix of the trees is never formed. Rows that follow from others, as those of plane loops of hinges, are left
out: in a pivoted factorization of S they leave nothing.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import rotate_by_exponential
from heavylift.numerics.vectors import (
    Vector,
    add,
    add_scaled,
    cross,
    dot,
    rotate,
    rotate_back,
    scaled,
    subtract,
    vector,
    vector_at,
)
from heavylift.solver.integrate.trees.forest import (
    BALL,
    DISTANCE,
    FIXED,
    FLOATING,
    HINGE,
    SLIDER,
    Forest,
    LoopRow,
    TreeBody,
)
from heavylift.solver.integrate.trees.sweeps import ZERO, own_quaternion, put, times

__all__ = [
    "add_answers",
    "answer_rows",
    "choose_rows",
    "move_coordinates",
    "row_acceleration",
    "row_rate",
    "solve_loops",
]

SOFTENING, SOLUTIONS = 1e-8, 2
"""Softness of rows relative to their characteristic inverse mass, and solutions of one system: the second sees hardly
anything of the softness. With 1e-13 single passes through singular positions changed the energy by a thousandth."""

DEPENDENT = 1e-9
"""What a row that follows from others leaves of itself in the factorization."""


@kernel(internal=True)
def _push(forest: Forest, row: LoopRow, side: int, body: int) -> None:
    """Force and moment of a row on one of its bodies, as biases."""
    if body < 0:
        return
    system, one = forest.rows, forest.bodies[body]
    at, lanes = system.attachments[2 * row.block + side].panel + row.row, system.lanes
    G = system.panels
    force = (G[at], G[at + lanes], G[at + 2 * lanes])
    moment = rotate(one.R, (G[at + 3 * lanes], G[at + 4 * lanes], G[at + 5 * lanes]))
    moment = add(moment, cross(one.to_centre, force))
    for k in range(3):
        one.row_moment[k] -= moment[k]
        one.row_force[k] -= force[k]


@kernel(internal=True)
def _answer(forest: Forest, row: LoopRow, out: int) -> None:
    """Accelerations of the coordinates by a unit force of a row."""
    for i in range(row.first, row.last):
        put(forest.bodies[i].row_moment, ZERO)
        put(forest.bodies[i].row_force, ZERO)
    _push(forest, row, 0, row.a)
    _push(forest, row, 1, row.b)
    for i in range(row.last - 1, row.first - 1, -1):
        one = forest.bodies[i]
        joint, n, f = one.joint, vector(one.row_moment), vector(one.row_force)
        if joint <= SLIDER:
            u = -dot(one.along, n) if joint == HINGE else -dot(one.along, f)
            one.row_drive = u
            n = add_scaled(n, u * one.compliance, one.hinge_moment)
            f = add_scaled(f, u * one.compliance, one.hinge_force)
        elif joint >= BALL:
            f = subtract(f, rotate_back(one.B, times(one.inverse, n)))
            n = ZERO
            put(one.row_force, f)
            if joint == DISTANCE:
                u = dot(times(one.inverse_mass, one.along), f)
                one.row_drive = u
                f = scaled(u * one.compliance, one.along)
        if one.parent >= 0:
            above = forest.bodies[one.parent]
            n = add(n, cross(one.arm, f))
            for k in range(3):
                above.row_moment[k] += n[k]
                above.row_force[k] += f[k]
    values = forest.answers
    for i in range(row.first, row.last):
        _accelerate(forest, forest.bodies[i], values, out)


@kernel(inline=True, internal=True)
def _accelerate(forest: Forest, one: TreeBody, values: Floats1, out: int) -> None:
    """Accelerations of a body by the force of a row."""
    joint, speed = one.joint, out + one.speed
    alpha, a = ZERO, ZERO
    if one.parent >= 0:
        above = forest.bodies[one.parent]
        alpha, a = vector(above.row_alpha), vector(above.row_a)
        a = add(a, cross(alpha, one.arm))
    if joint >= BALL:
        if joint == FLOATING:
            a = scaled(-1.0, times(one.inverse_mass, one.row_force))
        elif joint == DISTANCE:
            pull = one.compliance * (one.row_drive + dot(one.along, a))
            after = times(one.inverse_mass, add_scaled(scaled(-1.0, one.row_force), pull, one.along))
            for k in range(3):
                values[speed + k] = (after[k] - a[k]) / one.length
            a = after
        alpha = scaled(-1.0, times(one.inverse, add(rotate(one.B, a), one.row_moment)))
        if joint == FLOATING:
            centre = add(a, cross(alpha, one.to_centre))
            for k in range(3):
                values[speed + k] = centre[k]
        turned = rotate_back(one.R, alpha)
        if joint != BALL:
            speed += 3
        for k in range(3):
            values[speed + k] = turned[k]
    elif joint != FIXED:
        rate = one.compliance * (one.row_drive - dot(one.hinge_moment, alpha) - dot(one.hinge_force, a))
        values[speed] = rate
        if joint == HINGE:
            alpha = add_scaled(alpha, rate, one.along)
        else:
            a = add_scaled(a, rate, one.along)
    put(one.row_alpha, alpha)
    put(one.row_a, a)


@kernel(inline=True, internal=True)
def _along_row(forest: Forest, row: LoopRow, side: int, centre: Vector, turn: Vector) -> float:
    """``G u`` of one side: velocity of the centre of mass in world axes and spin in principal axes."""
    system = forest.rows
    at, lanes = system.attachments[2 * row.block + side].panel + row.row, system.lanes
    total = 0.0
    for k in range(3):
        total += system.panels[at + k * lanes] * centre[k] + system.panels[at + (3 + k) * lanes] * turn[k]
    return total


@kernel(inline=True, internal=True)
def row_rate(forest: Forest, row: LoopRow) -> float:
    """``G u`` of the velocities of the bodies as their kind reads them."""
    total = 0.0
    if row.a >= 0:
        dof = forest.bodies[row.a].dof
        total += _along_row(forest, row, 0, vector_at(forest.poses, dof), vector_at(forest.poses, dof + 3))
    if row.b >= 0:
        dof = forest.bodies[row.b].dof
        total += _along_row(forest, row, 1, vector_at(forest.poses, dof), vector_at(forest.poses, dof + 3))
    return total


@kernel(inline=True, internal=True)
def _side_answer(forest: Forest, row: LoopRow, side: int, body: int, first: int, last: int) -> float:
    """``G X`` of one side, of the accelerations of a row in a range of bodies."""
    if body < first or body >= last:
        return 0.0
    one = forest.bodies[body]
    centre = add(vector(one.row_a), cross(one.row_alpha, one.to_centre))
    return _along_row(forest, row, side, centre, rotate_back(one.R, one.row_alpha))


@kernel(internal=True)
def row_acceleration(forest: Forest, row: LoopRow, side: int, body: int, gravity: Vector) -> float:
    """``G a`` of one side with the accelerations that the bodies have without the rows."""
    if body < 0:
        return 0.0
    one = forest.bodies[body]
    c, w = vector(one.to_centre), vector(one.spin)
    centre = add(add(one.a, gravity), add(cross(one.alpha, c), cross(w, cross(w, c))))
    return _along_row(forest, row, side, centre, rotate_back(one.R, one.alpha))


@kernel(internal=True)
def answer_rows(forest: Forest, of_all: bool) -> None:
    """X and S of the rows that are kept, or of all."""
    count, width = forest.loops.shape[0], forest.velocities
    S = count * width
    for i in range(count):
        row = forest.loops[i]
        if not (row.kept or of_all):
            continue
        _answer(forest, row, i * width)
        for j in range(count):
            other = forest.loops[j]
            if other.kept or of_all:
                forest.answers[S + i * count + j] = _side_answer(
                    forest, other, 0, other.a, row.first, row.last
                ) + _side_answer(forest, other, 1, other.b, row.first, row.last)


@kernel(internal=True)
def choose_rows(forest: Forest) -> None:
    """Keep the rows that leave most of themselves, one after the other, until the rest follows from them."""
    answer_rows(forest, True)
    count = forest.loops.shape[0]
    S, at, G = forest.answers, count * forest.velocities, forest.rows.rows
    for i in range(count):
        forest.loops[i].kept = 0
    for _ in range(count):
        best, most = -1, DEPENDENT
        for i in range(count):
            row = forest.loops[i]
            share = S[at + i * count + i] / G[row.block].scale[row.row]
            if not row.kept and share > most:
                best, most = i, share
        if best < 0:
            return
        forest.loops[best].kept = 1
        for i in range(count):
            if forest.loops[i].kept:
                continue
            factor = S[at + i * count + best] / S[at + best * count + best]
            for j in range(count):
                if not forest.loops[j].kept:
                    S[at + i * count + j] -= factor * S[at + best * count + j]


@kernel(internal=True)
def solve_loops(forest: Forest) -> None:
    """Forces of the rows that are kept from their targets, by ``L D L^T`` of the softened S and a refinement by S."""
    count = forest.loops.shape[0]
    S, at, G = forest.answers, count * forest.velocities, forest.rows.rows
    for i in range(count):
        row = forest.loops[i]
        row.pull = 0.0
        if not row.kept:
            continue
        place = at + i * count
        row.own = S[place + i]
        for j in range(i + 1):
            if not forest.loops[j].kept:
                continue
            total = S[place + j]
            for k in range(j):
                if forest.loops[k].kept:
                    total -= S[place + k] * S[at + j * count + k] * S[at + k * count + k]
            if j == i:
                S[place + j] = total + SOFTENING * G[row.block].scale[row.row]
            else:
                S[place + j] = total / S[at + j * count + j]
    for _ in range(SOLUTIONS):
        for i in range(count):  # what is left, by S above its diagonal
            row = forest.loops[i]
            if not row.kept:
                continue
            rest = row.target - row.own * row.pull
            for j in range(count):
                other = forest.loops[j]
                if other.kept and j != i:
                    rest -= S[at + min(i, j) * count + max(i, j)] * other.pull
            row.rest = rest
        _substitute(forest, S, at)
        for i in range(count):
            if forest.loops[i].kept:
                forest.loops[i].pull += forest.loops[i].rest


@kernel(internal=True)
def _substitute(forest: Forest, S: Floats1, at: int) -> None:
    """``rest := ( L D L^T )^-1 rest``."""
    count = forest.loops.shape[0]
    for i in range(count):
        row = forest.loops[i]
        if row.kept:
            for j in range(i):
                if forest.loops[j].kept:
                    row.rest -= S[at + i * count + j] * forest.loops[j].rest
    for i in range(count - 1, -1, -1):
        row = forest.loops[i]
        if row.kept:
            row.rest /= S[at + i * count + i]
            for j in range(i + 1, count):
                if forest.loops[j].kept:
                    row.rest -= S[at + j * count + i] * forest.loops[j].rest


@kernel(internal=True)
def add_answers(forest: Forest, values: Floats1, out: int) -> None:
    """``a += X l``."""
    for i in range(forest.loops.shape[0]):
        row = forest.loops[i]
        if not row.kept:
            continue
        begin, end = forest.bodies[row.first].speed, forest.velocities
        if row.last < forest.bodies.shape[0]:
            end = forest.bodies[row.last].speed
        for k in range(begin, end):
            values[out + k] += row.pull * forest.answers[i * forest.velocities + k]


@kernel(internal=True)
def move_coordinates(forest: Forest, values: Floats1, at: int, move: Floats1, by: int) -> None:
    """Displace along the velocities of the coordinates."""
    for i in range(forest.bodies.shape[0]):
        one = forest.bodies[i]
        place, speed = at + forest.velocities + one.place, by + one.speed
        if one.joint <= SLIDER:
            values[place] += move[speed]
        elif one.joint >= BALL:
            if one.joint != BALL:
                for k in range(3):
                    values[place + k] += move[speed + k]
                place, speed = place + 3, speed + 3
            q = rotate_by_exponential(
                own_quaternion(values, place), move[speed], move[speed + 1], move[speed + 2]
            )
            values[place], values[place + 1], values[place + 2], values[place + 3] = q
