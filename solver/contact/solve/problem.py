"""What all iterations on a problem of contacts share: rows in one width, diagonal, scales."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.laws.rows import RECORD, ROWS, solved_rows
from heavylift.solver.contact.layout import COMPLIANT, Marks, Problem, Work
from heavylift.solver.contact.solve.end_blocks import (
    CONTACT,
    factor_inverse_mass,
    solve_for_start,
    write_rows,
)
from heavylift.solver.contact.solve.envelope import find_reach, order_bodies
from heavylift.solver.contact.solve.system import COUPLING, SCRATCH, fill_gaps, spread
from heavylift.solver.contact.solve.twelve_rows import COLUMNS

__all__ = ["fill_rows", "make_work", "next_island", "prepare"]


def make_work(count: int, size: int) -> Work:
    """Room for some contacts on some velocities, or on that many rows."""
    of_contacts = {"diagonal": 2, "inverse": 2, "rows": ROWS, "records": RECORD, "N": CONTACT}
    of_rows = ("w", "w0", "dw", "best", "kept", "begin", "rough")
    of_velocities = ("z", "y", "x", "pivots", "active", "place", "reach", "y0")
    lengths = {name: width * count for name, width in of_contacts.items()}
    lengths |= dict.fromkeys(of_rows, 3 * count) | dict.fromkeys(of_velocities, size)
    lengths |= {"held": COUPLING * count + SCRATCH, "K": size * size, "A": size * size}
    lengths |= {"pair": COLUMNS, "sums": COLUMNS}
    return Work(**{name: np.zeros(length) for name, length in lengths.items()}, marks=Marks.one())


@kernel(internal=True)
def prepare(problem: Problem, work: Work) -> None:
    """Write what all iterations share: rows and their order, the diagonal of W, rates without impulses."""
    count, ends, size = problem.counts.number, problem.ends, problem.counts.size
    marks = work.marks
    marks.unit_mass, marks.near_diagonal, marks.in_order = False, False, False
    problem.counts.last = problem.counts.high = 0
    if ends.shape[0] > 0:
        for i in range(COLUMNS):
            work.sums[i] = 0.0
        head, past = problem.head, problem.past
        unit = factor_inverse_mass(count, ends, size, problem.B, head, past, work.K, work.pivots, work.active)
        if not unit:
            fill_gaps(size, problem.B, head, past)
        write_rows(
            count,
            ends,
            problem.blocks,
            size,
            work.K,
            work.pivots,
            unit,
            work.N,
            work.held[COUPLING * count :],
        )
        if unit:
            marks.unit_mass = True
            order_bodies(count, ends, size, work.place, work.A)
            find_reach(count, ends, size, work.place, work.reach)
            for i in range(size):
                work.x[i] = problem.start[i]
            solve_for_start(size, work.K, work.pivots, work.x)
            for i in range(size):
                work.y0[int(work.place[i])] = work.x[i]
            marks.in_order = _note_last(problem, work)
        else:
            for i in range(size):
                work.place[i] = i
                work.y0[i] = problem.start[i]
    _find_diagonal(problem, work)
    spread(count, ends, problem.blocks, size, problem.start, work.w0)
    _find_scale(problem, work)


@kernel(internal=True)
def _note_last(problem: Problem, work: Work) -> bool:
    """Last contact of each body; whether all velocities are in the order in which contacts touch them."""
    past, ends = 0, problem.ends
    for c in range(problem.counts.number):
        for end in range(2):
            first, width = ends[c, 2 * end], ends[c, 2 * end + 1]
            if width > 0:
                if first > past:
                    return False
                past = max(past, first + width)
                work.active[first] = c
    return past == problem.counts.size


@kernel(internal=True)
def next_island(problem: Problem, work: Work) -> bool:
    """Go on to the contacts that act on each other behind those that were solved last; false if there are none.

    Islands whose contacts stand in turn are taken as one, and all of them where velocities are in another order.
    """
    counts, ends = problem.counts, problem.ends
    counts.first, counts.low = counts.last, counts.high
    if counts.first >= counts.number:
        return False
    if not work.marks.in_order:
        counts.last, counts.high = counts.number, counts.size
    else:
        c = last = counts.first
        while c <= last:
            for end in range(2):
                first, width = ends[c, 2 * end], ends[c, 2 * end + 1]
                if width > 0:
                    last = max(last, int(work.active[first]))
                    counts.high = max(counts.high, first + width)
            c += 1
        counts.last = c
    return True


@kernel(internal=True)
def _find_scale(problem: Problem, work: Work) -> None:
    """What residuals are measured by."""
    marks = work.marks
    scale, free = problem.counts.least_rate, problem.counts.free_rate
    for c in range(problem.counts.number):
        i = 3 * c
        rate = max(abs(work.w0[i]), abs(work.w0[i + 1]), abs(work.w0[i + 2]))
        scale, free = max(scale, rate), max(free, rate)
        o = problem.parameters[c]  # what the step has given before counts like what is asked for now
        scale = max(scale, abs(o.offset[0]) * work.diagonal[2 * c])
        scale = max(scale, max(abs(o.offset[1]), abs(o.offset[2])) * work.diagonal[2 * c + 1])
    marks.scale, marks.free = scale, free


@kernel(internal=True, reassociate=True)
def _find_diagonal(problem: Problem, work: Work) -> None:
    """Write the diagonal of W of each contact, on coupled masses a bound of it from the diagonal of B."""
    count, ends, B, N = problem.counts.number, problem.ends, problem.B, work.N
    for c in range(count):
        n = t = 0.0
        if ends.shape[0] == 0:
            n = B[3 * c, 3 * c]
            t = B[3 * c + 1, 3 * c + 1] + B[3 * c + 2, 3 * c + 2]
        elif work.marks.unit_mass:
            o = CONTACT * c
            for j in range(COLUMNS):
                n += N[o + j] * N[o + j]
                t += N[o + COLUMNS + j] * N[o + COLUMNS + j] + N[o + 2 * COLUMNS + j] * N[o + 2 * COLUMNS + j]
        else:
            for end in range(2):
                first, o = ends[c, 2 * end], CONTACT * c + 6 * end
                for j in range(ends[c, 2 * end + 1]):
                    n0, n1, n2 = N[o + j], N[o + COLUMNS + j], N[o + 2 * COLUMNS + j]
                    n += n0 * n0 * B[first + j, first + j]
                    t += (n1 * n1 + n2 * n2) * B[first + j, first + j]
        t *= 0.5
        work.diagonal[2 * c] = n if n > 0.0 else 1.0
        work.diagonal[2 * c + 1] = t if t > 0.0 else 1.0


@kernel(internal=True)
def fill_rows(problem: Problem, work: Work, factor_of_diagonal: float, near: NDArray[np.float64]) -> None:
    """Write softness and target of all rows, with a further softness relative to the diagonal about impulses `near`."""
    parameters = problem.parameters
    for c in range(problem.counts.first, problem.counts.last):
        row = solved_rows(work.rows, ROWS * c)
        for i in range(3):
            more = factor_of_diagonal * work.diagonal[2 * c + min(i, 1)]
            S, b = parameters[c].softness[i], parameters[c].target[i]
            if i == 0 and problem.kinds[c].kind == COMPLIANT:
                S = b = 0.0
            row.softness[i] = S + more
            row.target[i] = b + (more * near[3 * c + i] if more > 0.0 else 0.0)
        work.inverse[2 * c] = 1.0 / (work.diagonal[2 * c] + row.softness[0])
        work.inverse[2 * c + 1] = 1.0 / (work.diagonal[2 * c + 1] + 0.5 * (row.softness[1] + row.softness[2]))
