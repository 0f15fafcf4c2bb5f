"""Mooring lines as forces on two bodies: catenaries in the vertical plane of their ends, with stiffness and energy."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.connections import GROUND
from heavylift.solver.interface import (
    FORCES,
    Workspace,
    add_forces,
    begin_record,
    record_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.marine.catenary import (
    BRANCH,
    FAILED,
    HORIZONTAL,
    STATE_WIDTH,
    STIFFNESS,
    TOTAL_LENGTH,
    TOTAL_WEIGHT,
    VERTICAL,
    read_ends,
    solve_line,
)
from heavylift.solver.marine.catenary_line import pack_sections
from heavylift.solver.marine.moorings import MooringLine, check_sections
from heavylift.solver.markers import MarkerBook

__all__ = [
    "EXTRA",
    "LINE_CHANNELS",
    "LINE_OVERSTRETCHED",
    "MooringLines",
    "line_markers",
    "pack_mooring_lines",
]

LINE_CHANNELS = (
    ("tension", "N", ("tension",)),
    ("anchor_tension", "N", ("anchor_tension",)),
    ("horizontal_tension", "N", ("horizontal_tension",)),
    ("seabed_length", "m", ("seabed_length",)),
)
"""Channels of a line: at the fairlead, at the anchor, horizontal at the fairlead, unstretched length on the seabed."""

LINE_OVERSTRETCHED = int(Outcome.LINE_OVERSTRETCHED)
"""Outcome of a step in which a line is stretched beyond its limit, or has no equilibrium."""

START_STRAIN = 0.05
"""By which a line may be stretched at the start: more is most often a wrong length."""

MARKER_A, MARKER_B, COLUMN = range(3)
START_ENERGY, STARTED, EXTRA = STATE_WIDTH, STATE_WIDTH + 1, STATE_WIDTH + 2
"""Places of the state behind those of `solve_line`; a force that is held on the fairlead beside the catenary's [N]."""
ANCHOR_TOLERANCE = 0.01
"""Of the length: how far from the seabed an anchor may be given."""
LEAST_SPAN = 1e-7
"""Of the length: horizontal distance of the ends below which a line hangs straight down."""


class MooringLines(Arrays):
    """All mooring lines of a scene.

    Attributes
    ----------
    ends
        Marker of the anchor, marker of the fairlead, first record column; shape (n, 3).
    table, line, sections
        As in `heavylift.solver.marine.catenary.solve_line`.
    limits
        Distance of the ends [m] that overstretches the line, shape (n,).
    state
        Last solution, energy at the start [J], 1 once that is known, and a force [N] that acts on the fairlead beside
        that of the catenary, world axes: zero, unless a model of dynamic lines writes it; shape (n, 14).
    tangents
        Stiffness of the force on the fairlead against its displacement relative to the anchor [N/m], world axes,
        row by row, symmetric and positive semidefinite, at the last evaluation; shape (n, 9).
    scratch
        Lower end, length on the seabed and energy for a record, and the solution that the steps go on from, shape
        (n, 4 + the width of a solution).
    """

    ends: Ints2
    table: Ints2
    line: Floats2
    sections: Floats2
    limits: Floats1
    state: Floats2
    tangents: Floats2
    scratch: Floats2


def line_markers(book: MarkerBook, lines: Sequence[MooringLine]) -> list[tuple[int, int]]:
    """Markers of anchor and fairlead of each line."""
    return [
        (book.point(line.body_a, line.point_a, FORCES), book.point(line.body_b, line.point_b, FORCES))
        for line in lines
    ]


def pack_mooring_lines(
    lines: Sequence[MooringLine],
    markers: Sequence[tuple[int, int]],
    columns: Sequence[int],
    places: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> MooringLines:
    """Make the kind.

    Parameters
    ----------
    lines
        What the user said.
    markers
        Of anchor and fairlead, from `line_markers`.
    columns
        First record column of each line.
    places
        Anchor and fairlead of each line at the start, world [m], shape (3,) each.

    Raises
    ------
    InputError
        If a line is not a line, its anchor is not fixed to the seabed that it has, its fairlead is below that, or it
        is shorter than its span at the start.
    """
    ends, table, numbers, sections, limits = [], [], [], [], []
    first = 0
    for line, (a, b), column, (anchor, fairlead) in zip(lines, markers, columns, places, strict=True):
        check_sections(line.sections, line.clumps, friction=line.friction, source=line.name)
        _check_seabed(line, anchor, fairlead)
        rows, tail, values = pack_sections(
            line.sections, line.clumps, on_seabed=line.seabed is not None, friction=line.friction
        )
        limits.append(_check_span(line, float(values[0]), float(values[2]), anchor, fairlead))
        ends.append((a, b, column))
        table.append((first, len(rows), tail))
        numbers.append(values)
        sections.append(rows)
        first += len(rows)
    count = len(ends)
    return MooringLines(
        np.array(ends, dtype=np.int64).reshape(-1, 3),
        np.array(table, dtype=np.int64).reshape(-1, 3),
        np.array(numbers).reshape(-1, 4),
        np.vstack([np.zeros((0, 4)), *sections]),
        np.array(limits),
        np.zeros((count, STATE_WIDTH + 5)),
        np.zeros((count, 9)),
        np.zeros((count, 4 + STATE_WIDTH)),
    )


def _check_seabed(line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64]) -> None:
    """Refuse a seabed that the line does not begin on."""
    if line.seabed is None:
        return
    length = sum(section.length for section in line.sections)
    if line.body_a != GROUND or abs(anchor[2] - line.seabed) > ANCHOR_TOLERANCE * length:
        raise InputError(
            f"the anchor is on {line.body_a!r} at height {anchor[2]:g} m, the seabed at {line.seabed:g} m",
            source=line.name,
            key="seabed",
            expected="an anchor on the ground at the height of the seabed, or no seabed for this line",
        )
    if fairlead[2] < anchor[2]:
        raise InputError(
            f"the fairlead starts at height {fairlead[2]:g} m, below the anchor at {anchor[2]:g} m",
            source=line.name,
            key="point_b",
            expected="a fairlead above the seabed",
        )


def _check_span(
    line: MooringLine,
    length: float,
    stretch: float,
    anchor: NDArray[np.float64],
    fairlead: NDArray[np.float64],
) -> float:
    """Distance of the ends that is too much for the line; refuse a line that begins beyond it."""
    if not line.strain_limit > 0.0:
        raise InputError(
            f"strain_limit is {line.strain_limit:g}",
            source=line.name,
            key="strain_limit",
            expected="a positive strain, e.g. 0.1",
        )
    span = float(np.linalg.norm(np.asarray(fairlead) - np.asarray(anchor)))
    limit = length * (1.0 + line.strain_limit) if stretch > 0.0 else length
    if not span < min(limit, length * (1.0 + START_STRAIN)):
        raise InputError(
            f"the line of {length:g} m is shorter than its span of {span:g} m",
            source=line.name,
            key="sections",
            expected=f"a length of {span:g} m or more, from the anchor to the fairlead; a stretch of"
            f" {min(START_STRAIN, line.strain_limit):.3g} at the start is taken",
        )
    return limit


@kernel(internal=True)
def _hang(kind: MooringLines, i: int, work: Workspace) -> tuple[float, float, float]:
    """Solve a line for its ends; direction of its plane, and its span [m], not less than a hanging one has."""
    a, b = kind.ends[i, MARKER_A], kind.ends[i, MARKER_B]
    x = work.markers[b].point[0] - work.markers[a].point[0]
    y = work.markers[b].point[1] - work.markers[a].point[1]
    z = work.markers[b].point[2] - work.markers[a].point[2]
    span = math.sqrt(x * x + y * y)
    solve_line(kind.sections, kind.table, kind.line, i, span, z, kind.state)
    bad = not (span * span + z * z < kind.limits[i] * kind.limits[i]) or kind.state[i, BRANCH] == FAILED
    if bad and work.status.outcome == 0:
        work.status.outcome, work.status.body = LINE_OVERSTRETCHED, i
    span = max(span, LEAST_SPAN * kind.line[i, TOTAL_LENGTH])
    return x / span, y / span, span


@implement(add_forces, MooringLines)
@kernel(internal=True)
def add_mooring_lines(kind: MooringLines, time: float, work: Workspace) -> None:
    """Forces on both ends, and the stiffness of each line.

    Notes
    -----
    With the horizontal direction e from anchor to fairlead, t across it and z up, the stiffness is

        kxx e e^T + (kxz + kzx)/2 (e z^T + z e^T) + kzz z z^T + (H/x) t t^T.

    Only friction of the seabed makes the 2x2 part unsymmetric, and could make the symmetric part indefinite; then
    the coupling is reduced until that is singular.
    """
    for i in range(kind.ends.shape[0]):
        a, b = kind.ends[i, MARKER_A], kind.ends[i, MARKER_B]
        ex, ey, span = _hang(kind, i, work)
        H, V = kind.state[i, HORIZONTAL], kind.state[i, VERTICAL]
        work.markers[b].force[0] -= H * ex
        work.markers[b].force[1] -= H * ey
        work.markers[b].force[2] -= V
        for k in range(3):
            work.markers[b].force[k] += kind.state[i, EXTRA + k]
        if (
            kind.table[i, 2] == kind.table[i, 1]
        ):  # the lower end of a line on the seabed is an anchor in the ground
            work.markers[a].force[0] += H * ex
            work.markers[a].force[1] += H * ey
            work.markers[a].force[2] += V - kind.line[i, TOTAL_WEIGHT]
        kxx, kzz = kind.state[i, STIFFNESS], kind.state[i, STIFFNESS + 3]
        kxz = 0.5 * (kind.state[i, STIFFNESS + 1] + kind.state[i, STIFFNESS + 2])
        bound = math.sqrt(max(kxx * kzz, 0.0))
        kxz = min(max(kxz, -bound), bound)
        across = H / span
        if ex * ex + ey * ey < 0.5:  # straight down: no direction of its own
            ex, ey, kxx, kxz = 1.0, 0.0, across, 0.0
        kind.tangents[i, 0] = kxx * ex * ex + across * ey * ey
        kind.tangents[i, 1] = kind.tangents[i, 3] = (kxx - across) * ex * ey
        kind.tangents[i, 2] = kind.tangents[i, 6] = kxz * ex
        kind.tangents[i, 4] = kxx * ey * ey + across * ex * ex
        kind.tangents[i, 5] = kind.tangents[i, 7] = kxz * ey
        kind.tangents[i, 8] = kzz


@implement(begin_record, MooringLines)
@kernel(internal=True)
def begin_line_records(kind: MooringLines) -> None:
    """Steps go on from what they found themselves: a record does not change the run, not in its last bits."""
    for i in range(kind.ends.shape[0]):
        for k in range(STATE_WIDTH):
            kind.scratch[i, 4 + k] = kind.state[i, k]


@implement(record_forces, MooringLines)
@kernel(internal=True)
def record_mooring_lines(kind: MooringLines, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Tensions, length on the seabed; the energy of the lines moves from the work of outer forces to its own.

    Forces were added at the same state just before. What the held force does, and what friction of the seabed takes,
    stays in that work.
    """
    for i in range(kind.ends.shape[0]):
        a, b, column = kind.ends[i, MARKER_A], kind.ends[i, MARKER_B], kind.ends[i, COLUMN]
        H, V = kind.state[i, HORIZONTAL], kind.state[i, VERTICAL]
        read_ends(kind.sections, kind.table, kind.line, i, kind.state, kind.scratch)
        low_h, low_v = kind.scratch[i, 0], kind.scratch[i, 1]
        x = work.markers[b].point[0] - work.markers[a].point[0]
        y = work.markers[b].point[1] - work.markers[a].point[1]
        share = H / max(math.sqrt(x * x + y * y), LEAST_SPAN * kind.line[i, TOTAL_LENGTH])
        x, y, z = (
            share * x - kind.state[i, EXTRA],
            share * y - kind.state[i, EXTRA + 1],
            V - kind.state[i, EXTRA + 2],
        )
        row[column] = math.sqrt(x * x + y * y + z * z)
        row[column + 1] = math.sqrt(low_h * low_h + low_v * low_v)
        row[column + 2] = H
        row[column + 3] = kind.scratch[i, 2]
        energy = kind.scratch[i, 3] + kind.line[i, TOTAL_WEIGHT] * work.markers[a].point[2]
        if kind.state[i, STARTED] == 0.0:
            kind.state[i, START_ENERGY], kind.state[i, STARTED] = energy, 1.0
        work.sums.elastic += energy - kind.state[i, START_ENERGY]
        work.sums.external_work += energy - kind.state[i, START_ENERGY]
        for k in range(STATE_WIDTH):
            kind.state[i, k] = kind.scratch[i, 4 + k]
