"""Rows that hold trees together: joints that close loops, and joints of other types.

With rows G on bodies and the mass matrix M of the coordinates, that is never formed::

    S = G M^-1 G^T,    ( S + delta D ) l = target - G a_0,    a = a_0 + M^-1 G^T l

The articulated inertias are its factors: a force of a row goes inward, and leaves at each joint the part u that moves
its coordinates. With the inverse d of what moves there, S is the sum of ``u d u^T`` over the joints, and what all
forces leave together comes outward as accelerations. Rows that follow from others, as those of plane loops of hinges,
are left out: in a pivoted factorization of S they leave nothing.
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


@kernel(internal=True)
def _leave(forest: Forest, body: int, first: int, last: int) -> None:
    """Take forces of rows of one joint on a body inward, and add what they leave to the answers.

    Rows go side by side: each by itself would wait for its own results.
    """
    values, order, width = forest.answers, forest.order, forest.velocities
    weighted = forest.loops.shape[0] * width
    while body >= 0:
        one = forest.bodies[body]
        body = one.parent
        for i in range(first, last):
            row = forest.loops[order[i]]
            line = i * width + one.speed
            n, f = _pass_on(one, vector(row.moment), vector(row.force), values, line, weighted + line)
            if body >= 0:
                put(row.moment, add(n, cross(one.arm, f)))
                put(row.force, f)


@kernel(inline=True, internal=True)
def _pass_on(
    one: TreeBody, n: Vector, f: Vector, values: Floats1, line: int, by: int
) -> tuple[Vector, Vector]:
    """What a joint passes on of a moment and a force on its body; u and d u of its coordinates to the answers."""
    joint = one.joint
    if joint <= SLIDER:
        u = -dot(one.along, n) if joint == HINGE else -dot(one.along, f)
        part = u * one.compliance
        values[line] += u
        values[by] += part
        return add_scaled(n, part, one.hinge_moment), add_scaled(f, part, one.hinge_force)
    if joint == FIXED:
        return n, f
    turned = times(one.inverse, n)
    f = subtract(f, rotate_back(one.B, turned))
    if joint != BALL:
        moved = times(one.inverse_mass, f)
        passed = f
        if joint == DISTANCE:
            part = one.compliance * dot(one.along, moved)
            moved = add_scaled(moved, -part, times(one.inverse_mass, one.along))
            passed = scaled(part, one.along)
        for k in range(3):
            values[line + k] += f[k]
            values[by + k] += moved[k]
        f, line, by = passed, line + 3, by + 3
    for k in range(3):
        values[line + k] += n[k]
        values[by + k] += turned[k]
    return ZERO, f


@kernel(inline=True, internal=True)
def _accelerate(forest: Forest, one: TreeBody, u: int, values: Floats1, out: int) -> None:
    """Add the accelerations of a body by what forces of rows leave at its joint, which stands in the answers."""
    joint, speed, left = one.joint, out + one.speed, forest.answers
    u += one.speed
    alpha, a = ZERO, ZERO
    if one.parent >= 0:
        above = forest.bodies[one.parent]
        alpha, a = vector(above.row_alpha), vector(above.row_a)
        a = add(a, cross(alpha, one.arm))
    if joint >= BALL:
        if joint == FLOATING:
            a = scaled(-1.0, times(one.inverse_mass, vector_at(left, u)))
        elif joint == DISTANCE:
            f = vector_at(left, u)
            drive = dot(one.along, times(one.inverse_mass, f))
            pull = one.compliance * (drive + dot(one.along, a))
            after = times(one.inverse_mass, add_scaled(scaled(-1.0, f), pull, one.along))
            for k in range(3):
                values[speed + k] += (after[k] - a[k]) / one.length
            a = after
        if joint != BALL:
            u += 3
        alpha = scaled(-1.0, times(one.inverse, add(rotate(one.B, a), vector_at(left, u))))
        if joint == FLOATING:
            centre = add(a, cross(alpha, one.to_centre))
            for k in range(3):
                values[speed + k] += centre[k]
        turned = rotate_back(one.R, alpha)
        if joint != BALL:
            speed += 3
        for k in range(3):
            values[speed + k] += turned[k]
    elif joint != FIXED:
        rate = one.compliance * (left[u] - dot(one.hinge_moment, alpha) - dot(one.hinge_force, a))
        values[speed] += rate
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
def _in_tree(row: LoopRow, first: int) -> bool:
    """Whether a row moves the tree whose velocities begin at a place."""
    return row.first == first or row.second == first  # noqa: PLR1714  a set costs time here


@kernel(internal=True)
def answer_rows(forest: Forest, of_all: bool) -> None:
    """What the rows that are kept, or all, leave at the joints, in their order, and S above its diagonal and below."""
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
    values, weighted, S = forest.answers, every * width, 2 * every * width
    for k in range(count * width):
        values[k] = values[weighted + k] = 0.0
    first = 0
    while first < count:
        row = forest.loops[order[first]]
        last = first + 1
        while last < count and forest.loops[order[last]].block == row.block:
            last += 1
        for i in range(first, last):
            one = forest.loops[order[i]]
            put(one.moment, scaled(-1.0, one.moment_a))
            put(one.force, scaled(-1.0, one.force_a))
        _leave(forest, row.a, first, last)
        for i in range(first, last):
            one = forest.loops[order[i]]
            put(one.moment, scaled(-1.0, one.moment_b))
            put(one.force, scaled(-1.0, one.force_b))
        _leave(forest, row.b, first, last)
        first = last
    for i in range(count):
        row, by = forest.loops[order[i]], weighted + i * width
        first, last, second, end = row.first, row.last, row.second, row.end
        for j in range(i + 1):
            other, total, line = forest.loops[order[j]], 0.0, j * width
            if _in_tree(other, first):
                for k in range(first, last):
                    total += values[line + k] * values[by + k]
            if end > second and _in_tree(other, second):
                for k in range(second, end):
                    total += values[line + k] * values[by + k]
            values[S + i * count + j] = values[S + j * count + i] = total


@kernel(internal=True)
def choose_rows(forest: Forest) -> None:
    """Keep the rows that leave most of themselves, one after the other, until the rest follows from them."""
    answer_rows(forest, True)
    count = forest.loops.shape[0]
    S, at, G = forest.answers, 2 * count * forest.velocities, forest.rows.rows
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
    count, S, at = order[every], forest.answers, 2 * every * forest.velocities
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
    count, S, at = order[every], forest.answers, 2 * every * forest.velocities
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
    """``a += M^-1 G^T l``: what all forces leave together, outward."""
    order, every, width = forest.order, forest.loops.shape[0], forest.velocities
    left = forest.answers
    together = every * (2 * width + every)
    for k in range(width):
        left[together + k] = 0.0
    for i in range(order[every]):
        pull = forest.loops[order[i]].pull
        for k in range(width):
            left[together + k] += pull * left[i * width + k]
    for i in range(forest.bodies.shape[0]):
        _accelerate(forest, forest.bodies[i], together, values, out)


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
