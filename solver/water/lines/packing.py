"""Mooring lines of a scene become one kind: markers, sections, the bottom below each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.records import records
from heavylift.solver.interface import FORCES
from heavylift.solver.water.lines.catenary import LineData, SectionData
from heavylift.solver.water.lines.catenary_line import pack_sections
from heavylift.solver.water.lines.mooring_lines import (
    MooringData,
    MooringLine,
    MooringLines,
    MooringOutputs,
    MooringScratch,
    MooringState,
)
from heavylift.solver.water.lines.placed_line import check_line, is_anchored, line_bottom, longest_span

if TYPE_CHECKING:
    from heavylift.solver.markers import MarkerBook
    from heavylift.solver.scene.outputs import Columns

__all__ = ["line_markers", "pack_mooring_lines"]


def line_markers(book: MarkerBook, lines: Sequence[MooringLine]) -> list[tuple[int, int]]:
    """Markers of anchor and fairlead of each line."""
    return [
        (book.point(line.body_a, line.point_a, FORCES), book.point(line.body_b, line.point_b, FORCES))
        for line in lines
    ]


def pack_mooring_lines(
    lines: Sequence[MooringLine],
    markers: Sequence[tuple[int, int]],
    columns: Sequence[Columns],
    places: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> MooringLines:
    """Make the kind.

    Parameters
    ----------
    lines
        The scene.
    markers
        Of anchor and fairlead, from `line_markers`.
    columns
        First record column of each line.
    places
        Anchor and fairlead of each line at the start, world [m], shape (3,) each.

    Raises
    ------
    InputError
        If a line is not a line, an end of it is below its seabed, both hang over that but not all of it sinks, or it is
        shorter than its span at the start.
    """
    packed = records(MooringData, len(lines))
    sections: list[Any] = []
    for row, line, (a, b), column, (anchor, fairlead) in zip(
        packed, lines, markers, columns, places, strict=True
    ):
        check_line(line, anchor, fairlead)
        rows, of_line = pack_sections(
            line.sections, line.clumps, on_seabed=line.seabed is not None, friction=line.friction
        )
        for name in LineData.fields_of:
            setattr(row, name, getattr(of_line[0], name))
        row.first = len(sections)
        row.anchor, row.fairlead, row.column = a, b, column.at(MooringOutputs)
        row.limit = longest_span(line)
        bottom = line_bottom(line, anchor)
        if bottom is not None:
            row.anchored = is_anchored(line, anchor, fairlead)
            row.over_bottom = not row.anchored or bottom.rise_x != 0.0 or bottom.rise_y != 0.0
            row.bottom, row.rise_x, row.rise_y = bottom
        sections.extend(rows)
    count = len(packed)
    return MooringLines(
        packed,
        records(SectionData, sections),
        records(MooringState, count),
        np.zeros((count, 9)),
        records(MooringScratch, count),
        np.zeros((0, 3)),
    )
