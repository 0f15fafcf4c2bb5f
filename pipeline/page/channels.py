"""Channels of a run as the interactive page plots them: all of them, thinned so that no extreme is lost."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from heavylift.pipeline.page.packing import Block
    from heavylift.pipeline.results.histories import Results

__all__ = ["pack_channels"]

BYTES = 9_000_000
"""Of all channels, before compression."""
LEAST = 200
"""Intervals of a thinned channel at least."""
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
        Channels, whose ``timeline`` counts from 0 among the timelines returned, timelines, and notes.
    """
    notes: list[str] = []
    count = len(results.time)
    shown = {name: _shown(results, name) for name in results}
    many = [name for name in shown if len(results.components(name)) > MANY]
    columns = sum(values.shape[1] for values, _ in shown.values())
    if many:
        notes.append(
            f"Of {len(many)} channels with more than {MANY} components, as the nodes of a mesh, the smallest and the "
            "largest of all components are plotted."
        )
    buckets = count
    if 4 * count * columns > budget:
        buckets = max(LEAST, min(budget // (8 * max(columns, 1)), count // 2))
        if 8 * buckets * columns > 2 * budget:  # even so few intervals are too much: fewer channels
            kept = max(1, 2 * budget // (8 * buckets))
            total, few = 0, {}
            for name, (values, components) in shown.items():
                total += values.shape[1]
                if total <= kept:
                    few[name] = (values, components)
            notes.append(
                f"{len(shown) - len(few):,} of {len(shown):,} channels are not in this page; results.h5 has them."
            )
            shown = few
        notes.append(
            f"Plotted channels have the smallest and the largest value of each of {buckets:,} intervals of "
            f"{count:,} records."
        )
    ranged = buckets < count
    edges = np.linspace(0, count, buckets + 1).round().astype(np.int64) if ranged else np.arange(count + 1)
    starts = edges[:-1]
    times = 0.5 * (results.time[starts] + results.time[edges[1:] - 1]) if ranged else results.time
    if ranged:  # the ends of the run are ends of the curves
        times[0], times[-1] = results.time[0], results.time[-1]
    packed = []
    for name, (values, components) in shown.items():
        unit, shown_values = results.unit(name), values
        if ranged:
            with np.errstate(invalid="ignore"):
                low = np.fmin.reduceat(values, starts, axis=0)
                high = np.fmax.reduceat(values, starts, axis=0)
            shown_values = np.stack([low, high], axis=2)
        packed.append(
            {
                "name": name,
                "unit": "" if unit == "1" else unit,
                "components": list(components),
                "timeline": 0,
                "ranged": ranged,
                "values": block.add(shown_values),
                "description": descriptions.get(name, ""),
            }
        )
    return packed, [block.add(times)], notes


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
