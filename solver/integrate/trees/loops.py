"""Rows that hold trees together: joints that close loops, and joints of other types.

With the accelerations X that a unit force of each row gives, and rows G on bodies::

    S = G X,    ( S + delta D ) l = target - G a_0,    a = a_0 + X l

A force of a row goes inward through the articulated inertias, which are there, and its accelerations come outward. So
the mass matrix of the trees is never formed. Rows that follow from others, as those of plane loops of hinges, are left
out: in a pivoted factorization of S they leave nothing.
"""

from __future__ import annotations

from typing import Any

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
    "factor_loops",
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


@kernel(inline=True, internal=True)
def _exert(forest: Forest, row: LoopRow, side: int, body: int) -> tuple[Vector, Vector]:
    """Force and moment about the joint point of a unit of a row on one of its bodies, world axes."""
    if body < 0:
        return ZERO, ZERO
    system, one = forest.rows, forest.bodies[body]
    at, lanes = system.attachments[2 * row.block + side].panel + row.row, system.lanes
    G = system.panels
    force = (G[at], G[at + lanes], G[at + 2 * lanes])
    moment = rotate(one.R, (G[at + 3 * lanes], G[at + 4 * lanes], G[at + 5 * lanes]))
    return force, add(moment, cross(one.to_centre, force))


@kernel(inline=True, internal=True)
def _push(one: TreeBody, force: Any, moment: Any) -> None:
    """Take a force and a moment on a body as biases."""
    for k in range(3):
        one.row_moment[k] -= moment[k]
        one.row_force[k] -= force[k]


@kernel(inline=True, internal=True)
def _rest(one: TreeBody) -> None:
    """No force of a row."""
    put(one.row_moment, ZERO)
    put(one.row_force, ZERO)
    one.row_drive = 0.0


@kernel(internal=True)
def _answer(forest: Forest, row: LoopRow, out: int) -> None:
    """Accelerations of the coordinates by a unit force of a row: inward along its paths, outward over its trees."""
    for i in range(row.first, row.last):
        _rest(forest.bodies[i])
    for i in range(row.second, row.end):
        _rest(forest.bodies[i])
    if row.a >= 0:
        _push(forest.bodies[row.a], row.force_a, row.moment_a)
    if row.b >= 0:
        _push(forest.bodies[row.b], row.force_b, row.moment_b)
    for place in range(row.path, row.path_end):
        one = forest.bodies[forest.paths[place]]
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
    for i in range(row.second, row.end):
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
def row_rate(forest: Forest, row: LoopRow) -> float:
    """``G u`` of the velocities of the bodies as somebody has looked at them."""
    total = 0.0
    if row.a >= 0:
        one = forest.bodies[row.a]
        total += dot(row.force_a, one.velocity) + dot(row.moment_a, one.spin)
    if row.b >= 0:
        one = forest.bodies[row.b]
        total += dot(row.force_b, one.velocity) + dot(row.moment_b, one.spin)
    return total


@kernel(inline=True, internal=True)
def _free_acceleration(one: TreeBody, force: Any, moment: Any, gravity: Vector) -> float:
    """``G a`` of one side with the accelerations that the bodies have without the rows."""
    c, w = vector(one.to_centre), vector(one.spin)
    moved = add(add(one.a, gravity), cross(w, cross(w, c)))
    return dot(force, moved) + dot(moment, one.alpha)


@kernel(inline=True, internal=True)
def row_acceleration(forest: Forest, row: LoopRow, gravity: Vector) -> float:
    """``G a`` with the accelerations that the bodies have without the rows."""
    total = 0.0
    if row.a >= 0:
        total += _free_acceleration(forest.bodies[row.a], row.force_a, row.moment_a, gravity)
    if row.b >= 0:
        total += _free_acceleration(forest.bodies[row.b], row.force_b, row.moment_b, gravity)
    return total


@kernel(inline=True, internal=True)
def _moves(row: LoopRow, body: int) -> bool:
    """Whether a body is in a tree that a row moves."""
    return row.first <= body < row.last or row.second <= body < row.end


@kernel(internal=True)
def answer_rows(forest: Forest, of_all: bool) -> None:
    """X and S of the rows that are kept, or of all, in their order; S above its diagonal and below."""
    order, every, width = forest.order, forest.loops.shape[0], forest.velocities
    count = 0
    for i in range(every):
        row = forest.loops[i]
        if row.kept or of_all:
            order[count] = i
            count += 1
            force, moment = _exert(forest, row, 0, row.a)
            put(row.force_a, force)
            put(row.moment_a, moment)
            force, moment = _exert(forest, row, 1, row.b)
            put(row.force_b, force)
            put(row.moment_b, moment)
    order[every] = count
    values, S = forest.answers, every * width
    for i in range(count):
        row = forest.loops[order[i]]
        _answer(forest, row, i * width)
        for j in range(i, count):
            other = forest.loops[order[j]]
            total = 0.0
            if _moves(row, other.a):
                one = forest.bodies[other.a]
                total += dot(other.force_a, one.row_a) + dot(other.moment_a, one.row_alpha)
            if _moves(row, other.b):
                one = forest.bodies[other.b]
                total += dot(other.force_b, one.row_a) + dot(other.moment_b, one.row_alpha)
            values[S + i * count + j] = values[S + j * count + i] = total


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
def factor_loops(forest: Forest) -> None:
    """``L D L^T`` of the softened S, below its diagonal."""
    order, every = forest.order, forest.loops.shape[0]
    count, S, at = order[every], forest.answers, every * forest.velocities
    for i in range(count):
        row = forest.loops[order[i]]
        line = at + i * count
        row.own = S[line + i]
        for j in range(i):  # L D
            other = at + j * count
            total = S[line + j]
            for k in range(j):
                total -= S[line + k] * S[other + k]
            S[line + j] = total
        pivot = row.own + SOFTENING * forest.rows.rows[row.block].scale[row.row]
        for j in range(i):
            part = S[line + j] * forest.loops[order[j]].inverse
            pivot -= S[line + j] * part
            S[line + j] = part
        row.inverse = 1.0 / pivot


@kernel(internal=True)
def solve_loops(forest: Forest) -> None:
    """Forces of the rows that are kept from their targets, by the factor and a refinement by S."""
    order, every = forest.order, forest.loops.shape[0]
    count, S, at = order[every], forest.answers, every * forest.velocities
    for i in range(count):
        row = forest.loops[order[i]]
        row.pull, row.rest = 0.0, row.target
    for solution in range(SOLUTIONS):
        for i in range(count):
            row = forest.loops[order[i]]
            rest = row.rest
            if solution > 0:  # what is left, by S above its diagonal
                rest = row.target - row.own * row.pull
                for j in range(i):
                    rest -= S[at + j * count + i] * forest.loops[order[j]].pull
                for j in range(i + 1, count):
                    rest -= S[at + i * count + j] * forest.loops[order[j]].pull
            for j in range(i):
                rest -= S[at + i * count + j] * forest.loops[order[j]].rest
            row.rest = rest
        for i in range(count - 1, -1, -1):
            row = forest.loops[order[i]]
            rest = row.rest * row.inverse
            for j in range(i + 1, count):
                rest -= S[at + j * count + i] * forest.loops[order[j]].rest
            row.rest = rest
        for i in range(count):
            row = forest.loops[order[i]]
            row.pull += row.rest


@kernel(internal=True)
def add_answers(forest: Forest, values: Floats1, out: int) -> None:
    """``a += X l``."""
    order = forest.order
    for i in range(order[forest.loops.shape[0]]):
        row, line = forest.loops[order[i]], i * forest.velocities
        for k in range(forest.bodies[row.first].speed, _speed_at(forest, row.last)):
            values[out + k] += row.pull * forest.answers[line + k]
        if row.end > row.second:
            for k in range(forest.bodies[row.second].speed, _speed_at(forest, row.end)):
                values[out + k] += row.pull * forest.answers[line + k]


@kernel(inline=True, internal=True)
def _speed_at(forest: Forest, body: int) -> int:
    """Place of the velocities of a body, or behind those of the last one."""
    return forest.bodies[body].speed if body < forest.bodies.shape[0] else forest.velocities


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
