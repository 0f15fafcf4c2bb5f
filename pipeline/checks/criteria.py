"""Criteria of a case after its run: value, utilisation, margin, when and where each governs, and what it comes from.

Everything is taken from the records of a run, at once for all times; forces by their extremes over all steps where the
run has them. A simulated quantity replaces a factor, never both: a force is the largest one of the run, which has its
dynamics, or the one at rest times a factor, and each result lists its factors and where each of them is.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.rotation import turned_by
from heavylift.pipeline.case.criteria.base import phase_names
from heavylift.pipeline.case.criteria.places import sensor_at
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import GROUND
from heavylift.pipeline.case.rope_parts import straight_parts, tensions_of, words_of_inner_ropes
from heavylift.pipeline.results.rope_lines import rope_tangents

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria.base import CriterionSection
    from heavylift.pipeline.case.criteria.results import CriterionResult
    from heavylift.pipeline.checks.quantities import Quantities
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.stress_io import BodyStress

__all__ = ["PHASE", "RecordedRun", "evaluate_criterion", "phase_words"]

PHASE = "scenario.phase"
"""Channel with the number of the phase of an operation, if the run has one."""
_TOUCH = 1e-9  # of a time: a record at the end of a span belongs to it


class RecordedRun(Run):
    """Records of a run within the time of a criterion.

    Parameters
    ----------
    case, quantities
        The case, and its quantities.
    criterion
        The criterion.
    """

    def __init__(self, case: Case, quantities: Quantities, criterion: CriterionSection) -> None:
        self.case, self.quantities, self.criterion = case, quantities, criterion
        self.results: Results = quantities.results
        time = self.results.time
        slack = _TOUCH * max(1.0, float(np.abs(time).max(initial=0.0)))
        first = -math.inf if criterion.after is None else criterion.after - slack
        last = math.inf if criterion.until is None else criterion.until + slack
        self.inside = (time >= first) & (time <= last) & self._in_phases(criterion.phases)
        if not self.inside.any():
            raise self.error(
                "there is no record within its time", "'after', 'until' and 'phases' within the records"
            )
        self.times: NDArray[np.float64] = time[self.inside]
        before = np.concatenate([[True], self.inside[:-1]])
        # records whose neighbour before does not belong to the criterion
        self.entered: NDArray[np.bool_] = ~before[self.inside]
        # and those whose whole interval is before its time; one in which a phase begins counts for that phase
        self.begins = np.isclose(self.times, criterion.after or -math.inf, rtol=0.0, atol=slack)

    def _in_phases(self, wanted: Sequence[str]) -> NDArray[np.bool_]:
        """Records in some phases of the operation; all if none is named."""
        if not wanted:
            return np.ones(len(self.results.time), dtype=np.bool_)
        if PHASE not in self.results:
            raise self.error(f"the run has no {PHASE!r}", "a run with phases, or no 'phases'")
        names = phase_names(self.case)
        numbers = [number for number, name in enumerate(names, 1) if name in wanted]
        phases = self.results[PHASE].reshape(len(self.results.time), -1)[:, 0]
        return np.isin(phases, numbers)

    def history(self, name: str, side: str = "end") -> NDArray[np.float64]:
        """Records of a channel or stress, ``"channel.fall.tension"``, or their extremes since the record before."""
        values = self.quantities.history(f"{name}.{side}")
        found: NDArray[np.float64] = values[self.inside].copy()
        if side in {"max", "min", "absolute"} and self.begins.any():
            ends = self.quantities.history(f"{name}.end")[self.inside][self.begins]
            found[self.begins] = np.abs(ends) if side == "absolute" else ends
        return np.abs(found) if side == "absolute" else found

    def seen(self, names: Sequence[str], side: str) -> str:
        """Of how many steps or records extremes are; records if they differ."""
        words = [self.quantities.seen(f"{name}.{side}").partition(" of ")[2] for name in names]
        least = min((word for word in words if word), key=lambda word: "steps" in word, default=self.records)
        if self.inside.all() or "steps" not in least:
            return least if self.inside.all() else self.records
        near = " where it was near enough to be searched" * ("near enough" in least)
        return f"the steps of {self.records}{near}"

    def stress(self, body: str) -> BodyStress:
        """Stress of a flexible body with a table ``stress``, over the whole run."""
        return self.quantities.body_stress(body)

    def at_rest(self, name: str) -> float:
        """Value of a channel at the time at which the criterion takes it to be at rest."""
        when = self.criterion.static_at
        if isinstance(when, float):
            if when > self.results.time[-1] + _TOUCH * when:
                raise self.error(
                    f"the records end at {self.results.time[-1]:.9g} s",
                    f"a run beyond 'static_at', {when:.9g} s",
                )
            whole = self.quantities.history(f"{name}.end")
            return float(np.interp(when, self.results.time, whole))
        values = self.history(name)
        steps = self.steps
        if when == "mean" and steps.any():
            return float(np.sum(0.5 * (values[1:] + values[:-1]) * steps) / np.sum(steps))
        return float(values[-1] if when == "end" else values[0])

    def turned(self, body: str, vector: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """A vector in the axes of a body in those of the world, shape (nt, 3)."""
        if body == GROUND:
            return np.tile(np.array(vector, dtype=np.float64), (len(self.times), 1))
        return turned_by(self.results[f"{body}.orientation"][self.inside], vector)

    def place(self, body: str, point: Sequence[float]) -> NDArray[np.float64]:
        """Where a point of a body is in the world [m], shape (nt, 3)."""
        given = np.array(point, dtype=np.float64)
        if body == GROUND:
            return np.tile(given, (len(self.times), 1))
        section: Any = self.case.bodies[body]
        if section.BODY.DEFORMS:
            sensor = sensor_at(self.case, body, point)
            return np.asarray(self.results[f"{sensor}.position"][self.inside])
        given = given - np.array(section.drawn_origin)
        position = self.results[f"{body}.position"][self.inside]
        return np.asarray(position + self.turned(body, given))

    def parts(self, name: str) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
        """Beginnings and ends of the straight parts of a rope in the world [m], each of shape (nt, 3).

        Lines of one force begin at their pulleys, which slide below the outlets along their guides; they stretch.
        """
        rope: Any = next(one for one in self.case.ropes if one.name == name)
        centres = [self.place(stop.body, stop.point) for stop in rope.path]
        pieces = straight_parts(rope)
        if hasattr(rope, "lengths"):
            down = self.turned(rope.path[0].body, np.array(rope.direction) / np.linalg.norm(rope.direction))
            begins = []
            tensions = tensions_of(self.case, [name]).values()
            for (a, b), unstretched, told in zip(pieces, rope.lengths, tensions, strict=True):
                strain = self.history(f"channel.{told}") / rope.line_stiffness
                length = unstretched * (1.0 + strain[:, np.newaxis])
                w = centres[b] - centres[a]
                aside = w - np.sum(w * down, axis=1, keepdims=True) * down
                square = length**2 - np.sum(aside**2, axis=1, keepdims=True)
                begins.append(centres[b] - aside - np.sqrt(np.maximum(0.0, square)) * down)
            return begins, [centres[b] for _, b in pieces]
        axes = []
        for stop in rope.path:
            axis = np.array([0.0, 0.0, 1.0] if stop.axis is None else stop.axis, dtype=np.float64)
            owner = stop.body if stop.radius > 0.0 else GROUND
            axes.append(self.turned(owner, axis / np.linalg.norm(axis)))
        arrive, leave = rope_tangents(centres, [stop.radius for stop in rope.path], axes)
        return [leave[a] for a, _ in pieces], [arrive[b] for _, b in pieces]

    def phase(self, time: float | None) -> str:
        """Phase of the operation at a time; empty if the run does not know."""
        if time is None or PHASE not in self.results:
            return ""
        record = min(int(np.searchsorted(self.results.time, time - _TOUCH)), len(self.results.time) - 1)
        number = self.results[PHASE].reshape(len(self.results.time), -1)[record, 0]
        return phase_words(self.case, float(number))

    def over_time(self, values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times of all records [s], and values within the time of the criterion, elsewhere no numbers."""
        found = np.full(len(self.results.time), np.nan)
        found[self.inside] = values
        return self.results.time, found

    @property
    def metadata(self) -> Mapping[str, Any]:
        """Summary of the run by itself."""
        return self.results.metadata

    def number(self, text: str) -> float:
        """Value of a quantity of checks, whatever the time of the criterion."""
        return self.quantities.number(text)

    def statistic(self, word: str, values: NDArray[np.float64]) -> Any:
        """A statistic of checks, ``"rms"``, of a history."""
        return self.quantities.statistic(word, values, self.times)


def phase_words(case: Case, number: float) -> str:
    """Name of the phase of an operation with a number from 1, as in the case file; else its number."""
    names = phase_names(case)
    if names and number > len(names):
        return "the end, after all phases"
    return names[int(number) - 1] if names and number >= 1.0 else f"phase {number:g}"


def evaluate_criterion(
    case: Case, quantities: Quantities, criterion: CriterionSection
) -> list[CriterionResult]:
    """Lines of one criterion."""
    found = criterion.judge(RecordedRun(case, quantities, criterion))
    words = words_of_inner_ropes(case, criterion.channel_text)
    if not words:
        return found
    return [
        replace(one, note="; ".join(filter(None, (one.note, words))), warns=one.warns or one.passed)
        for one in found
    ]
