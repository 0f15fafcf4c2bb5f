"""What a simulation has behind it: its records, and what its inputs were set to. States and copies share it.

A run is a function of its case and of what its inputs were set to. So the digest of all settings tells whether two
states have the same past.
"""

from __future__ import annotations

import hashlib
import struct
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

__all__ = ["InputChange", "Past"]


class InputChange(NamedTuple):
    """A row of the log of inputs.

    From a time [s] on an input has a value that changes at a rate, until a time [s].
    """

    time: float
    name: str
    value: float
    rate: float
    until: float


class _Records(NamedTuple):
    """Records of a piece, with those before it; the step at its end, their times [s], and their rows."""

    before: _Records | None
    step: int
    times: NDArray[Any]
    rows: NDArray[Any]


class _Change(NamedTuple):
    """A setting, with those before it, and the digest of all of them."""

    before: _Change | None
    row: InputChange
    digest: bytes


class Past(NamedTuple):
    """The past of a state; it never changes, what follows makes another one.

    Attributes
    ----------
    run
        Which simulation and its copies have it: the past of another one is of no use.
    keeps
        Whether records and settings are kept, or the digest of the settings alone.
    begin
        Step at which the records begin: later than 0 after a state of another process.
    root, driven
        Digest of the settings there, and of all settings; empty without any.
    records, changes
        The last ones of each.
    """

    run: object
    keeps: bool
    begin: int = 0
    root: bytes = b""
    driven: bytes = b""
    records: _Records | None = None
    changes: _Change | None = None

    def recorded(self, step: int, times: NDArray[Any], rows: NDArray[Any]) -> Past:
        """With records up to a step."""
        if not (self.keeps and len(rows)):
            return self
        return self._replace(records=_Records(self.records, step, times, rows))

    def changed(self, rows: Iterable[InputChange]) -> Past:
        """With further settings."""
        changes, driven = self.changes, self.driven
        for row in rows:
            numbers = struct.pack("<4d", row.time, *row[2:])
            driven = hashlib.blake2b(driven + numbers + row.name.encode(), digest_size=16).digest()
            if self.keeps:
                changes = _Change(changes, row, driven)
        return self._replace(changes=changes, driven=driven)

    def until(self, step: int, time: float, driven: bytes, tolerance: float) -> Past | None:
        """The part before a state that was driven so, at a step and its time [s]; None if that has another past."""
        if step < self.begin:
            return None
        changes = self.changes
        while changes is not None and changes.digest != driven:
            if changes.row.time < time - tolerance:  # here something else was set before it
                return None
            changes = changes.before
        if (self.root if changes is None else changes.digest) != driven:
            return None
        records = self.records
        while records is not None and records.step > step:
            kept = int((records.times < time + tolerance).sum())
            before = records.before
            records = _Records(before, step, records.times[:kept], records.rows[:kept]) if kept else before
        return self._replace(driven=driven, records=records, changes=changes)

    @property
    def pieces(self) -> list[tuple[NDArray[Any], NDArray[Any]]]:
        """Times [s] and rows of all records, in pieces."""
        found, last = [], self.records
        while last is not None:
            found.append((last.times, last.rows))
            last = last.before
        return found[::-1]

    @property
    def log(self) -> list[InputChange]:
        """All settings."""
        found, last = [], self.changes
        while last is not None:
            found.append(last.row)
            last = last.before
        return found[::-1]
