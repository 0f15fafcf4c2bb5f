"""How far a recorded channel is from a reference history."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.reference import read_reference

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.reference import ReferenceSection
    from heavylift.pipeline.results.histories import Results

__all__ = ["compared_histories", "deviation_history"]

_CLOSE = 1e-6  # of an output interval: a time of the file is that of a record


def compared_histories(
    case: Case, reference: ReferenceSection, results: Results
) -> tuple[NDArray[np.float64], tuple[str, ...], NDArray[np.float64], NDArray[np.float64]]:
    """A channel and its reference at the times of the reference.

    Returns
    -------
    times
        [s], shape (nt,).
    components
        Names of the columns.
    computed, expected
        In the unit of the channel, shape (nt, number of components); if changes are compared, both begin alike.

    Raises
    ------
    InputError
        If a component or a time of the file is not recorded, as in a run that ended early.
    """
    file = case.folder / reference.file
    history = read_reference(file, reference.components)
    recorded = results.components(reference.channel)
    alone = reference.components or ("value", reference.channel.rpartition(".")[2])
    chosen = []
    for name in history.columns:
        single = len(recorded) == 1 and name in alone
        if name not in recorded and not single:
            raise InputError(
                f"column {name!r} is no component of {reference.channel!r}",
                source=file,
                expected=f"some of: {', '.join(recorded)}",
            )
        chosen.append(0 if single else recorded.index(name))
    times = np.array(history.times)
    if len(results.time) < 2:
        raise InputError("fewer than two records", source=file, expected="a run over the whole history")
    interval = float(np.median(np.diff(results.time)))
    after = np.clip(np.searchsorted(results.time, times), 1, max(len(results.time) - 1, 1))
    nearest = after - (times - results.time[after - 1] < results.time[after] - times)
    missed = np.abs(results.time[nearest] - times) > _CLOSE * interval
    if missed.any():
        raise InputError(
            f"t = {times[missed][0]:.9g} s is not recorded; the records end at {results.time[-1]:.9g} s",
            source=file,
            expected="a run over the whole history",
        )
    computed = results[reference.channel].reshape(len(results.time), -1)[nearest][:, chosen]
    expected = np.column_stack([*history.columns.values()])
    if reference.changes:
        computed = computed - computed[0] + expected[0]
    return times, tuple(history.columns), computed, expected


def deviation_history(
    case: Case, reference: ReferenceSection, results: Results
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times [s] and distances of a channel from its reference, divided by the scale; both of shape (nt,)."""
    times, _, computed, expected = compared_histories(case, reference, results)
    return times, np.linalg.norm(computed - expected, axis=1) / (reference.scale or 1.0)
