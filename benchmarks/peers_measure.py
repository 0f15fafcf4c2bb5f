"""Measuring programs against each other: errors, interleaved CPU times, cost of a target error."""

from __future__ import annotations

import gc
import math
import statistics
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

__all__ = [
    "SAMPLES",
    "Cost",
    "History",
    "Ladder",
    "Measured",
    "Reference",
    "Run",
    "at_samples",
    "cheapest",
    "climb",
    "cost_of",
    "largest_error",
    "measure",
    "ratio_text",
]

SAMPLES = 101
"""Instants of a reference, both ends included."""
LONGEST = 2.0
"""CPU time after which a ladder is not climbed further [s]."""
SPAN = 0.01
"""CPU time that the repetitions of a run fill in each round [s]."""


@dataclass(frozen=True, eq=False)
class History:
    """Path of the marked point: times [s], shape (n,); positions [m] and velocities [m/s], shape (n, 3).

    Velocities are needed only where the times are not those of the reference.
    """

    times: NDArray[np.float64]
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64] | None = None


@dataclass(frozen=True, eq=False)
class Reference:
    """What errors are measured against.

    Attributes
    ----------
    times, positions
        [s], shape (n,); [m], shape (n, number of components).
    components
        Which of x, y, z (0, 1, 2) are compared.
    scale
        Length that divides the error [m].
    """

    times: NDArray[np.float64]
    positions: NDArray[np.float64]
    components: tuple[int, ...]
    scale: float = 1.0


class Run(Protocol):
    """One setting of one solver on one problem, its model built."""

    setting: str

    def history(self) -> History:
        """Path of the marked point, from a run that is not timed."""
        ...

    def reset(self) -> None:
        """Return to the start; not timed."""
        ...

    def go(self) -> None:
        """Integrate from start to end; timed."""
        ...


@dataclass(frozen=True)
class Ladder:
    """Settings of one solver from cheap to dear; each entry builds its model when it is called."""

    program: str
    solver: str
    builders: tuple[Callable[[], Run], ...]


@dataclass
class Measured:
    """A run that was made: its error, and the CPU time of each repetition [s]."""

    program: str
    solver: str
    run: Run
    error: float
    seconds: list[float] = field(default_factory=list)

    @property
    def cost(self) -> float:
        """Median CPU time [s]; not a number if it was not timed."""
        return statistics.median(self.seconds) if self.seconds else math.nan


@dataclass(frozen=True)
class Cost:
    """CPU time for a target error [s], and whether it is only an upper bound."""

    seconds: float
    bound: bool
    program: str
    solver: str


def at_samples(history: History, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Positions at some times by cubic Hermite interpolation, shape (n, 3).

    Where the times of the history are the wanted ones these are its positions themselves.

    Raises
    ------
    ValueError
        If the history does not reach over the times, or needs velocities and has none.
    """
    t, x, v = history.times, history.positions, history.velocities
    if t.shape == times.shape and np.allclose(t, times, rtol=0.0, atol=1e-9 * times[-1]):
        return x
    if v is None or abs(t[0] - times[0]) + abs(t[-1] - times[-1]) > 1e-9 * times[-1]:
        raise ValueError("the history does not fit the samples")
    i = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    h = (t[i + 1] - t[i])[:, np.newaxis]
    s = (times - t[i])[:, np.newaxis] / h
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * x[i]
        + s * (1.0 - s) ** 2 * h * v[i]
        + s**2 * (3.0 - 2.0 * s) * x[i + 1]
        - s**2 * (1.0 - s) * h * v[i + 1]
    )


def largest_error(history: History, reference: Reference) -> float:
    """Largest distance from the reference over its samples, divided by its scale; infinite if not finite."""
    if not (np.all(np.isfinite(history.positions)) and np.all(np.isfinite(history.times))):
        return math.inf
    try:
        positions = at_samples(history, reference.times)[:, list(reference.components)]
    except ValueError:
        return math.inf
    return float(np.linalg.norm(positions - reference.positions, axis=1).max()) / reference.scale


def climb(ladder: Ladder, reference: Reference, target: float) -> list[Measured]:
    """Make the runs of a ladder until one reaches the target error or takes too long; one that fails is left out."""
    made = []
    for build in ladder.builders:
        run = build()
        begin = time.process_time()
        try:
            error = largest_error(run.history(), reference)
        except (ArithmeticError, RuntimeError, ValueError):  # how programs say that they did not get through
            error = math.inf
        else:
            if math.isfinite(error):
                made.append(Measured(ladder.program, ladder.solver, run, error))
        if error <= target or time.process_time() - begin > LONGEST:
            break
    return made


def _needed(made: Sequence[Measured], targets: Sequence[float]) -> list[Measured]:
    """The runs of a ladder on both sides of each target, and its best one."""
    numbers = {min(range(len(made)), key=lambda i: made[i].error)} if made else set()
    for target in targets:
        first = next((i for i, row in enumerate(made) if row.error <= target), None)
        if first is not None:
            numbers |= {first, max(first - 1, 0)}
    return [made[i] for i in sorted(numbers)]


def measure(
    ladders: Sequence[Ladder],
    reference: Reference,
    targets: Sequence[float],
    rounds: int,
    log: Callable[[str], None] = lambda _: None,
) -> list[list[Measured]]:
    """Errors and CPU times of several solvers on one problem.

    The timed runs go round robin through all programs, so that noise of the machine hits all alike.

    Returns
    -------
    list of list
        Timed runs of each ladder, from cheap to dear.
    """
    rows = []
    for ladder in ladders:
        rows.append(_needed(climb(ladder, reference, min(targets)), targets))
        log(f"{ladder.program} {ladder.solver}: " + ", ".join(f"{row.error:.1e}" for row in rows[-1]))
    turns = [
        row
        for number in range(max(map(len, rows), default=0))
        for made in rows
        for row in made[number : number + 1]
    ]
    collecting = gc.isenabled()
    gc.disable()
    try:
        for _ in range(rounds):
            for row in turns:
                _time(row)
    finally:
        if collecting:
            gc.enable()
    return rows


def _time(row: Measured) -> None:
    """Repeat a run for a while."""
    spent = 0.0
    while spent < SPAN:
        row.run.reset()
        begin = time.process_time()
        row.run.go()
        row.seconds.append(time.process_time() - begin)
        spent += row.seconds[-1]


def cost_of(made: Sequence[Measured], target: float) -> Cost | None:
    """CPU time for a target error, by log-log interpolation between the first run that meets it and the one before.

    Where a later run is cheaper, as it may be with step size control, that one counts.

    Returns
    -------
    Cost or None
        An upper bound if a run is taken that beats the target; None if none does.
    """
    met = [number for number, row in enumerate(made) if row.error <= target]
    if not met:
        return None
    best = min((made[number] for number in met), key=lambda row: row.cost)
    cost = Cost(best.cost, True, best.program, best.solver)
    if met[0] > 0:
        before, row = made[met[0] - 1], made[met[0]]
        share = math.log(before.error / target) / math.log(before.error / max(row.error, 1e-300))
        seconds = before.cost * (row.cost / before.cost) ** share
        if seconds <= cost.seconds:
            cost = Cost(seconds, False, row.program, row.solver)
    return cost


def cheapest(rows: Sequence[Sequence[Measured]], target: float) -> Cost | None:
    """The cheapest of several ladders for a target error."""
    costs = [cost for cost in (cost_of(made, target) for made in rows) if cost is not None]
    return min(costs, key=lambda cost: cost.seconds, default=None)


def ratio_text(own: Cost | None, peer: Cost | None) -> str:
    """How many times the peer's cost is ours; signs say which side is only an upper bound."""
    if own is None or peer is None:
        return "-"
    sign = {(False, False): "", (False, True): "<=", (True, False): ">=", (True, True): "~"}
    return f"{sign[own.bound, peer.bound]}{peer.seconds / own.seconds:.3g}"
