"""Section of a report on FMUs: what they and the scene exchanged."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.pipeline.report.document import Section, Table
from heavylift.pipeline.results.words import number_words

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results

__all__ = ["fmu_sections"]


def fmu_sections(case: Case, results: Results | None) -> list[Section]:
    """Files, sample times and couplings, and the range of each value that was exchanged."""
    if not case.fmus:
        return []
    made = tuple((fmu.name, fmu.file, number_words(fmu.sample_time, "s"), fmu.coupling) for fmu in case.fmus)
    items = [Table(("FMU", "file", "sample time", "coupling"), made)]
    rows = []
    for fmu in case.fmus:
        for variable, channel in fmu.reads.items():
            rows.append((fmu.name, f"reads {variable}", channel, *_range(results, channel)))
        for variable, name in fmu.writes.items():
            rows.append((fmu.name, f"writes {variable}", name, *_range(results, f"{name}.value")))
    if rows:
        header = ("FMU", "variable", "channel or input", "smallest", "largest", "unit")
        items.append(Table(header, tuple(rows), frozenset({3, 4})))
    return [Section("FMUs", tuple(items))]


def _range(results: Results | None, channel: str) -> tuple[str, str, str]:
    """Smallest and largest value of the records, and the unit."""
    if results is None or not len(results.time):
        return "–", "–", ""
    owner, component = (channel, "") if channel in results else channel.rsplit(".", 1)
    info, values = results.channel(owner), results[owner].reshape(len(results.time), -1)
    column = values[:, info.components.index(component) if component else 0]
    return f"{column.min():.6g}", f"{column.max():.6g}", info.unit
