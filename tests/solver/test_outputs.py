"""Outputs by name: what a class of outputs says, where it lies in a record, and what is refused of it."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.recording import check_written, outputs_at, part, placed, unwritten, width_of
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.descriptions import XYZ, ChannelKind
from heavylift.solver.scene.outputs import (
    Components,
    Outputs,
    Part,
    Parts,
    channel,
    largest,
    nested,
    outputs,
    smallest,
)


@outputs
class PullOutputs(Outputs):
    """A force, as others nest it."""

    force: Components = channel("force", "force on it", XYZ)
    tension: float = channel("force", "size of the force")


@outputs
class LineOutputs(Outputs):
    """A line."""

    length: float = channel("length", "its length")
    pull: PullOutputs = nested(PullOutputs)
    length_max: float = largest("length", "length")
    length_min: float = smallest("length", "length")


@outputs
class StiffLineOutputs(LineOutputs):
    """A line with something more."""

    drift: float = channel("length", "its drift")


@outputs
class SegmentOutputs(Parts):
    """What the scene decides the number of."""

    segment_tension: Part = channel("force", "tension of each segment", None)
    sheave_state: Part = channel("number", "state of each sheave", None)


class LineEntry(Record):
    """Where a line records."""

    column: int
    count: int
    segments: SegmentOutputs


stiff_line_outputs = outputs_at(StiffLineOutputs)


class LinesOfTest(Arrays):
    """Lines of a test."""

    table: Records[LineEntry]


@entry
def write_lines(kind: LinesOfTest, row: Floats1) -> None:
    """Distinct numbers by the names of fields."""
    for i in range(kind.table.shape[0]):
        line = kind.table[i]
        out = stiff_line_outputs(row, line.column)
        out.drift = 100.0 * i + 1.0
        out.length = 100.0 * i + 2.0
        out.pull.tension = 100.0 * i + 3.0
        for k in range(3):
            out.pull.force[k] = 100.0 * i + 4.0 + k
        out.length_min, out.length_max = 100.0 * i + 8.0, 100.0 * i + 9.0
        lengths = part(row, line.segments.segment_tension)
        for k in range(lengths.shape[0]):
            lengths[k] = 100.0 * i + 10.0 + k
        states = part(row, line.segments.sheave_state)
        for k in range(states.shape[0]):
            states[k] = 100.0 * i + 20.0 + k


def test_channels_stand_in_the_order_of_fields() -> None:
    assert [one.name for one in StiffLineOutputs.CHANNELS] == [
        "length", "force", "tension", "length_max", "length_min", "drift",
    ]  # fmt: skip
    assert StiffLineOutputs.CHANNELS[1].components == XYZ
    assert width_of(StiffLineOutputs) == sum(len(one.columns()) for one in StiffLineOutputs.CHANNELS) == 8


def test_kernels_write_what_the_names_say() -> None:
    book = ChannelBook()
    first = book.add("before", PullOutputs.CHANNELS)
    assert (int(first), book.width) == (0, 4)
    kinds = (*LineOutputs.CHANNELS, *SegmentOutputs.CHANNELS, StiffLineOutputs.CHANNELS[-1])
    with pytest.raises(TypeError, match="'drift' does not follow"):
        ChannelBook().add("line", kinds, {"segment_tension": ("1",), "sheave_state": ()}).at(StiffLineOutputs)
    rows = []
    chosen = [(("1", "2", "3"), ("1", "2")), (("1",), ())]
    for i, (segments, sheaves) in enumerate(chosen):
        kinds = (*StiffLineOutputs.CHANNELS, *SegmentOutputs.CHANNELS)
        columns = book.add(f"line_{i}", kinds, {"segment_tension": segments, "sheave_state": sheaves})
        column, placed_segments = columns.at(StiffLineOutputs), placed(SegmentOutputs, columns)
        rows.append(filled(LineEntry, column=column, count=len(segments), segments=placed_segments))
    row = unwritten(book.width)
    write_lines(LinesOfTest(records(LineEntry, rows)), row)
    with pytest.raises(TypeError, match=r"no kernel writes 'before\.force', 'before\.tension'"):
        check_written(row, book.channels)
    values = {c.name: row[c.column : c.column + len(c.components)].tolist() for c in book.channels}
    for i, (segments, sheaves) in enumerate(chosen):
        base = 100.0 * i
        assert values[f"line_{i}.drift"] == [base + 1.0]
        assert values[f"line_{i}.length"] == [base + 2.0]
        assert values[f"line_{i}.tension"] == [base + 3.0]
        assert values[f"line_{i}.force"] == [base + 4.0, base + 5.0, base + 6.0]
        assert values[f"line_{i}.length_max"] == [base + 9.0]
        assert values[f"line_{i}.length_min"] == [base + 8.0]
        assert values[f"line_{i}.segment_tension"] == [base + 10.0 + k for k in range(len(segments))]
        assert values[f"line_{i}.sheave_state"] == [base + 20.0 + k for k in range(len(sheaves))]


def test_what_is_not_recorded_has_no_columns() -> None:
    columns = ChannelBook().add("line", SegmentOutputs.CHANNELS[:1], {"segment_tension": ("1", "2")})
    assert columns.at(LineOutputs) == -1
    where = placed(SegmentOutputs, columns)
    assert (where.segment_tension.first, where.segment_tension.size) == (0, 2)
    assert where.sheave_state.size == 0


def test_a_number_that_is_none_is_written_too() -> None:
    book = ChannelBook()
    book.add("line", [ChannelKind("length", "length", "its length")])
    row = unwritten(1)
    row[0] = np.nan
    check_written(row, book.channels)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ("a: float", "expected a channel with its quantity"),
        ("a: float = 1.0", "expected a channel with its quantity"),
        ('a: float = channel("length", "")', "and a sentence"),
        ('a: float = channel("no such thing", "it")', "expected a known quantity"),
        ('a: float = channel("force", "it", XYZ)', "expected Components"),
        ('a: Components = channel("force", "it")', "expected float"),
        ('parts: Part = channel("force", "it", None)', "expected Part, in a class of Parts"),
        ('length: float = channel("length", "again")', "stands twice"),
        (
            'a: float = largest("force", "tension")\n    tension_max: float = channel("force", "it")',
            "tension_max twice",
        ),
        ("a: LineOutputs = nested(PullOutputs)", "expected PullOutputs"),
        ("a: SegmentOutputs = nested(SegmentOutputs)", "SegmentOutputs has no fixed columns"),
        ('a = channel("force", "it")', "Wrong.a has no annotation"),
    ],
)
def test_what_is_no_declaration_is_refused(fields: str, words: str) -> None:
    text = f"from __future__ import annotations\n@outputs\nclass Wrong(LineOutputs):\n    {fields}\n"
    with pytest.raises(TypeError, match=words):
        exec(textwrap.dedent(text), {**globals(), "__name__": f"wrong_{abs(hash(fields))}"})  # noqa: S102


def test_one_base_lays_the_record_out() -> None:
    text = "@outputs\nclass Both(LineOutputs, PullOutputs):\n    pass\n"
    with pytest.raises(TypeError, match="several bases, expected one"):
        exec(text, {**globals(), "__name__": "wrong_bases"})  # noqa: S102
