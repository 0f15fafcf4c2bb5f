"""Warnings of how loads hang: lines of equalizers that carry nothing, pulleys at stops, bodies that tilt.

Everything is by the records of a run; of lines also by their smallest tensions over all steps.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.assemble.frames import start_of_frame
from heavylift.pipeline.case.rope_parts import words_of_inner_ropes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.histories import Results

__all__ = ["TILT", "hanging_warnings"]

TILT = math.radians(5.0)
"""Angle to the initial vertical from which on a body has rolled to another position of rest [rad]."""
CARRIES = 1e-3
"""Part of the largest force of all lines of an equalizer from which on it carries."""
AT_STOP = 1e-9
"""Part of its travel by which a pulley may be short of a stop that it is at."""
_NAMED = 4  # bodies of a sentence


def hanging_warnings(case: Case, results: Results) -> list[str]:
    """Sentences without a full stop; none if lines carry, pulleys are off their stops and bodies rest unturned."""
    if not len(results.time):
        return []
    return [*_equalizers(case, results), *_phases(case), *_tilted(case, results)]


def _phases(case: Case) -> list[str]:
    """Phases that wait for, or are limited by, the tension of a rope over pulleys."""
    if case.scenario is None:
        return []
    words = words_of_inner_ropes(case, str(case.scenario.model_dump()))
    return [f"conditions of phases use the rope over the pulleys, not the lines: {words}"] if words else []


def _equalizers(case: Case, results: Results) -> list[str]:
    found = []
    pulleys = {f"{one.name}_rope": one for one in case.equalizers}
    for rope in case.ropes:
        made = pulleys.get(rope.name)
        if rope.DESCRIBED.WORD == "equalized" and f"{rope.name}.stop" in results:
            least = results.extremes(f"{rope.name}.segment_tension", "min")[0]
            tensions, stops = results[f"{rope.name}.segment_tension"], results[f"{rope.name}.stop"]
        elif made is not None and f"{made.name}_guide_1.travel" in results:
            numbers = range(1, sum(line.count for line in made.lines) + 1)
            lines = [f"{made.name}_line_{k}.tension" for k in numbers]
            tensions = np.column_stack([results[line] for line in lines])
            least = np.column_stack([results.extremes(line, "min")[0] for line in lines])
            travel = np.column_stack([results[f"{made.name}_guide_{k}.travel"] for k in numbers])
            room = AT_STOP * (made.travel.up + made.travel.down)
            stops = 1.0 * (travel >= made.travel.down - room) - (travel <= -made.travel.up + room)
        else:
            continue
        words = _of_one(results.time, tensions, least, stops)
        name = rope.name if made is None else made.name
        found += [f"{name!r} does not share its load evenly: {words}"] if words else []
    return found


def _of_one(
    time: NDArray[np.float64],
    tensions: NDArray[np.float64],
    least: NDArray[np.float64],
    stops: NDArray[np.float64],
) -> str:
    """Lines that carry nothing while others do, and pulleys at stops; arrays of shape (nt, n)."""
    total = tensions.sum(axis=1)
    carries = total > CARRIES * total.max(initial=0.0)
    parts = []
    slack = ((least <= 0.0) & carries[:, np.newaxis]).T
    for number, records in enumerate(slack, 1):
        if records.any():
            parts.append(f"line {number} carries nothing {_span(time, records)}")
    for side, word in ((-1.0, "upper"), (1.0, "lower")):
        for number, records in enumerate(((stops == side) & carries[:, np.newaxis]).T, 1):
            if records.any():
                parts.append(f"pulley {number} is at its {word} stop {_span(time, records)}")
    return ", ".join(parts)


def _span(time: NDArray[np.float64], records: NDArray[np.bool_]) -> str:
    """When, of the records of a run."""
    if records.all():
        return "all the time"
    return f"at {np.count_nonzero(records):,} of {len(time):,} records from {time[records.argmax()]:.4g} s on"


def _tilted(case: Case, results: Results) -> list[str]:
    """Rigid bodies that an equilibrium has tilted from their initial positions."""
    if not case.begins_at_rest:
        return []
    up = np.array([0.0, 0.0, 1.0])
    if case.gravity is not None and any(case.gravity.acceleration):
        gravity = np.array(case.gravity.acceleration)
        up = -gravity / np.linalg.norm(gravity)
    angles = {
        name: _angle(
            start_of_frame(body.initial, np.zeros(3))["orientation"], results[f"{name}.orientation"][0], up
        )
        for name, body in case.bodies.items()
        if "bodies" in case.place(f"bodies.{name}").split(".")  # builders draw theirs as they can
        and not body.BODY.DEFORMS
        and body.frame.motion == "free"
    }
    rolled = sorted((name for name in angles if angles[name] > TILT), key=lambda name: -angles[name])
    if not rolled:
        return []
    words = ", ".join(f"{name!r} by {math.degrees(angles[name]):.3g} deg" for name in rolled[:_NAMED])
    more = f" and {len(rolled) - _NAMED} more" if len(rolled) > _NAMED else ""
    return [f"at rest bodies are tilted against their initial positions: {words}{more}"]


def _angle(drawn: NDArray[np.float64], rest: NDArray[np.float64], up: NDArray[np.float64]) -> float:
    """Angle between the vertical in the axes of a body initially and at rest [rad]."""
    a, b = (_vertical(q, up) for q in (drawn, rest))
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def _vertical(q: NDArray[np.float64], up: NDArray[np.float64]) -> NDArray[np.float64]:
    """Direction against gravity in the axes of a body of the orientation q, scalar first."""
    w, v = float(q[0]), -q[1:]
    return np.asarray(up + 2.0 * np.cross(v, np.cross(v, up) + w * up))
