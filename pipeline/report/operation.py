"""Section of a report on the operation: its phases, when each began and why it ended, what was done and seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from heavylift.pipeline.report.document import Section, Table, Text

if TYPE_CHECKING:
    from heavylift.pipeline.results.histories import Results

__all__ = ["operation_log", "operation_section", "operation_tones", "phase_bands"]


def operation_log(results: Results | None) -> tuple[list[str], list[list[Any]]]:
    """Names of all phases, and lines of the log: time, phase, event, words and value."""
    metadata = {} if results is None else results.metadata.get("scenario") or {}
    return list(metadata.get("phases", [])), list(metadata.get("log", []))


def operation_tones(results: Results) -> list[tuple[float, float]]:
    """Time [s] and frequency [Hz] of all that was heard."""
    tones = (results.metadata.get("scenario") or {}).get("tones", [])
    return [(float(time), float(tone)) for time, tone in tones]


def phase_bands(results: Results) -> list[tuple[str, float, float]]:
    """Name, begin and end [s] of each phase of the first track that began; empty without a scenario."""
    names, log = operation_log(results)
    count = (results.metadata.get("scenario") or {}).get("first_track", len(names))
    return [band for band in _bands(results, log) if band[0] in names[:count]]


def _bands(results: Results, log: list[list[Any]]) -> list[tuple[str, float, float]]:
    """The same of all tracks."""
    begins = [(name, time) for time, name, event, *_ in log if event == "begins"]
    ends = {name: time for time, name, event, *_ in log if event == "done"}
    last = float(results.time[-1]) if len(results.time) else 0.0
    return [(name, begin, ends.get(name, last)) for name, begin in begins]


def operation_section(results: Results | None) -> list[Section]:
    """Phases of the scenario as a table, and limits that were passed."""
    names, log = operation_log(results)
    if results is None or not names:
        return []
    bands = {name: (begin, end) for name, begin, end in _bands(results, log)}
    done = {line[1]: line[3] for line in log if line[2] == "done"}
    stops = {line[1]: f"{line[2]}: {line[3]}".removesuffix(": ") for line in log if line[2].endswith("stop")}
    rows = []
    passed: list[bool | None] = []
    for number, name in enumerate(names, 1):
        actions = "; ".join(line[3] for line in log if line[1] == name and line[2] == "action")
        if name not in bands:
            rows.append((str(number), name, "", "", "", "did not begin"))
            passed.append(None)
            continue
        begin, end = bands[name]
        why = stops.get(name) or done.get(name, "end of the run")
        rows.append((str(number), name, f"{begin:.2f}", f"{end - begin:.2f}", actions, why))
        passed.append(False if name in stops else None)
    header = ("", "phase", "begins [s]", "lasts [s]", "actions", "ends with")
    items: list[Table | Text] = [Table(header, tuple(rows), frozenset({2, 3}), tuple(passed))]
    items += [
        Text(f"t = {time:.4g} s, phase {name!r}: {event}: {what} (it was {value:.6g}).", warning=True)
        for time, name, event, what, value in log
        if event.startswith("limit passed")
    ]
    return [Section("Operation", tuple(items))]
