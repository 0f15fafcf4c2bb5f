"""A problem of contacts, its workspace, and what all iterations share: rows in one width, diagonal, scales."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel, view
from heavylift.numerics.records import Record, Records, record_at
from heavylift.solver.contact.contact_rows import ROWS, solved_rows
from heavylift.solver.contact.end_blocks import CONTACT, factor_inverse_mass, solve_for_start, write_rows
from heavylift.solver.contact.envelope import find_reach, order_bodies
from heavylift.solver.contact.layout import COMPLIANT, RowKind, RowParameters
from heavylift.solver.contact.system import COUPLING, SCRATCH, spread
from heavylift.solver.contact.twelve import COLUMNS

__all__ = [
    "Marks",
    "Problem",
    "Work",
    "divide",
    "fill_rows",
    "prepare",
    "workspace_length",
]


class Marks(Record):
    """Marks of a problem.

    Attributes
    ----------
    unit_mass
        Whether masses are in the rows.
    near_diagonal
        Whether the factors are those without exchange of rows.
    scale
        Largest rate without impulses or by what the step has given before [m/s].
    """

    unit_mass: bool
    near_diagonal: bool
    scale: float


MARKS = Marks.layout.itemsize // 8
"""Numbers of them in the workspace."""

marks_at = record_at(Marks)


class Problem(NamedTuple):
    """Contacts and what they touch; arrays as in the entry points."""

    number: int
    kinds: Records[RowKind]
    parameters: Records[RowParameters]
    ends: NDArray[np.int64]
    blocks: NDArray[np.float64]
    size: int
    start: NDArray[np.float64]
    B: NDArray[np.float64]


class Work(NamedTuple):
    """Parts of the workspace."""

    diagonal: NDArray[np.float64]  # (2 count,): W of the normal, mean of the tangents
    inverse: NDArray[np.float64]  # (2 count,): r of the laws
    rows: NDArray[np.float64]  # (6 count,)
    records: NDArray[np.float64]  # (10 count,)
    held: NDArray[np.float64]  # (7 count + SCRATCH,)
    w0: NDArray[np.float64]  # (3 count,)
    w: NDArray[np.float64]  # (3 count,)
    dw: NDArray[np.float64]  # (3 count,)
    best: NDArray[np.float64]  # (3 count,)
    kept: NDArray[np.float64]  # (3 count,)
    begin: NDArray[np.float64]  # (3 count,)
    z: NDArray[np.float64]  # (size,)
    y: NDArray[np.float64]  # (size,)
    x: NDArray[np.float64]  # (size,)
    pivots: NDArray[np.float64]  # (size,)
    active: NDArray[np.float64]  # (size,)
    K: NDArray[np.float64]  # (size^2,)
    A: NDArray[np.float64]  # (size^2,)
    N: NDArray[np.float64]  # (CONTACT count,): rows in twelve columns, see `end_blocks`
    place: NDArray[np.float64]  # (size,): of velocities in z, y, x, K and A
    reach: NDArray[np.float64]  # (size,)
    y0: NDArray[
        np.float64
    ]  # (size,): velocities without impulses, in their places, of a unit mass if that is in N
    pair: NDArray[np.float64]  # (COLUMNS,): velocities of the ends of a contact
    sums: NDArray[np.float64]  # (COLUMNS,): what acts on them; zeros between calls
    marks: Marks


@kernel
def workspace_length(count: int, size: int) -> int:
    """Numbers that the solver needs as workspace.

    Parameters
    ----------
    count
        Contacts.
    size
        Touched velocities, or rows.
    """
    return (45 + CONTACT) * count + SCRATCH + 8 * size + 2 * size * size + 2 * COLUMNS + MARKS


@view
def divide(problem: Problem, workspace: NDArray[np.float64]) -> Work:
    """Parts of the workspace."""
    n, m = problem.number, problem.size
    held = 38 * n
    vectors = held + COUPLING * n + SCRATCH
    squares = vectors + 5 * m
    rows = squares + 2 * m * m
    places = rows + CONTACT * n
    pairs = places + 3 * m
    marks = pairs + 2 * COLUMNS
    return Work(
        workspace[: 2 * n],
        workspace[2 * n : 4 * n],
        workspace[4 * n : 10 * n],
        workspace[10 * n : 20 * n],
        workspace[held:vectors],
        workspace[20 * n : 23 * n],
        workspace[23 * n : 26 * n],
        workspace[26 * n : 29 * n],
        workspace[29 * n : 32 * n],
        workspace[32 * n : 35 * n],
        workspace[35 * n : 38 * n],
        workspace[vectors : vectors + m],
        workspace[vectors + m : vectors + 2 * m],
        workspace[vectors + 2 * m : vectors + 3 * m],
        workspace[vectors + 3 * m : vectors + 4 * m],
        workspace[vectors + 4 * m : squares],
        workspace[squares : squares + m * m],
        workspace[squares + m * m : rows],
        workspace[rows:places],
        workspace[places : places + m],
        workspace[places + m : places + 2 * m],
        workspace[places + 2 * m : pairs],
        workspace[pairs : pairs + COLUMNS],
        workspace[pairs + COLUMNS : marks],
        marks_at(workspace, marks),
    )


@kernel(internal=True)
def prepare(problem: Problem, work: Work) -> None:
    """Write what all iterations share: rows and their order, the diagonal of W, rates without impulses."""
    count, ends, size = problem.number, problem.ends, problem.size
    marks = work.marks
    marks.unit_mass, marks.near_diagonal, marks.scale = False, False, 0.0
    if ends.shape[0] > 0:
        for i in range(COLUMNS):
            work.sums[i] = 0.0
        unit = factor_inverse_mass(count, ends, size, problem.B, work.K, work.pivots, work.active)
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
        else:
            for i in range(size):
                work.place[i] = i
                work.y0[i] = problem.start[i]
    _find_diagonal(problem, work)
    spread(count, ends, problem.blocks, size, problem.start, work.w0)
    scale = 0.0
    for c in range(count):
        i = 3 * c
        scale = max(scale, abs(work.w0[i]), abs(work.w0[i + 1]), abs(work.w0[i + 2]))
        o = problem.parameters[c]  # what the step has given before counts like what is asked for now
        scale = max(scale, abs(o.offset[0]) * work.diagonal[2 * c])
        scale = max(scale, max(abs(o.offset[1]), abs(o.offset[2])) * work.diagonal[2 * c + 1])
    marks.scale = scale


@kernel(internal=True, reassociate=True)
def _find_diagonal(problem: Problem, work: Work) -> None:
    """Write the diagonal of W of each contact, on coupled masses a bound of it from the diagonal of B."""
    count, ends, B, N = problem.number, problem.ends, problem.B, work.N
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
    for c in range(problem.number):
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
