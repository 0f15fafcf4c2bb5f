"""Channels of a run as the interactive page plots them: all of them, thinned so that no extreme is lost."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from heavylift.pipeline.page.packing import Block
    from heavylift.pipeline.results.histories import Results

__all__ = ["pack_channels"]

BYTES = 12_000_000
"""Of all channels, before compression."""
LEAST = 20
"""Intervals of a thinned channel at least, however many channels there are."""
_SINGLE = re.compile(r"\.contact_\d+\.")
MANY = 64
"""Components of a channel above which the smallest and the largest of them are plotted."""


def pack_channels(
    results: Results, block: Block, descriptions: Mapping[str, str], *, budget: int = BYTES
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[str]]:
    """Channels in the header of a page, the timelines that they need, and words on what was left out.

    Parameters
    ----------
    results
        Time histories; what is not finite is a gap in a curve.
    block
        Takes the numbers.
    descriptions
        What each channel is, by its name.
    budget
        Bytes of all channels; with more, every channel is given by its smallest and largest value in each of some
        intervals of time.

    Returns
    -------
    tuple
        Channels in the order of the records, whose ``timeline`` counts from 0 among the timelines returned; these;
        and notes.
    """
    notes: list[str] = []
    shown = {name: _shown(results, name) for name in results}
    many = sum(len(results.components(name)) > MANY for name in shown)
    if many:
        notes.append(
            f"Of {many} channels with more than {MANY} components, as the nodes of a mesh, the smallest and the "
            "largest of all components are plotted."
        )
    # what single contacts do is much and seldom looked at: it does not take the place of the rest
    single = {name for name in shown if _SINGLE.search(name)}
    packed: list[dict[str, Any]] = []
    timelines: list[dict[str, Any]] = []
    spent = block.size
    for names, share, what in (
        ([name for name in shown if name not in single], 0.75 if single else 1.0, "Plotted channels"),
        ([name for name in shown if name in single], 1.0, "Channels of single contacts"),
    ):
        if not names:
            continue
        left = share * budget - (block.size - spent)
        times, starts = _intervals(results, sum(shown[name][0].shape[1] for name in names), left)
        if starts is not None:
            notes.append(
                f"{what} have the smallest and the largest value of each of {len(starts):,} intervals of "
                f"{len(results.time):,} records."
            )
        for name in names:
            values, components = shown[name]
            unit = results.unit(name)
            packed.append(
                {
                    "name": name,
                    "unit": "" if unit == "1" else unit,
                    "components": list(components),
                    "timeline": len(timelines),
                    "ranged": starts is not None,
                    "values": block.add(values if starts is None else _ranges(values, starts)),
                    "description": descriptions.get(name, ""),
                }
            )
        timelines.append(block.add(times, "f8"))
    order = {name: number for number, name in enumerate(shown)}
    return sorted(packed, key=lambda one: order[one["name"]]), timelines, notes


def _intervals(
    results: Results, columns: int, budget: float
) -> tuple[NDArray[np.float64], NDArray[np.int64] | None]:
    """Times of the plotted points, and the records at which intervals begin; None if all records are plotted."""
    count = len(results.time)
    if 4 * count * columns <= budget or count <= 2 * LEAST:
        return results.time, None
    number = int(np.clip(budget // (8 * columns), LEAST, count // 2))
    edges = np.linspace(0, count, number + 1).round().astype(np.int64)
    times = 0.5 * (results.time[edges[:-1]] + results.time[edges[1:] - 1])
    times[0], times[-1] = results.time[0], results.time[-1]  # the ends of the run are ends of the curves
    return times, edges[:-1]


def _ranges(values: NDArray[np.float64], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Smallest and largest value of each column in each interval, shape (intervals, columns, 2)."""
    with np.errstate(invalid="ignore"):
        low, high = (part.reduceat(values, starts, axis=0) for part in (np.fmin, np.fmax))
    return np.stack([low, high], axis=2)


def _shown(results: Results, name: str) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Columns of a channel that are plotted, shape (nr, c), and their names."""
    values = results[name].reshape(len(results.time), -1)
    components = results.components(name)
    if len(components) <= MANY:
        return values, components
    with np.errstate(invalid="ignore"):
        return np.column_stack([np.fmin.reduce(values, axis=1), np.fmax.reduce(values, axis=1)]), (
            "smallest",
            "largest",
        )
