"""Whether an exchange between systems is stable, told before the run from how each of them answers to pulses.

For small deviations a system that is told ``v + r t`` over each interval H answers at the end of the interval n with::

    y_n = sum_k ( P_(n-k) v_k + R_(n-k) r_k )

P_j and R_j are its answers, j intervals later, to a value, and to a rate, that is 1 over one interval and 0 over all
others. They are measured: one run over some intervals for each input, from the present state, to which the system goes
back. With what a method tells of the others (`heavylift.pipeline.coupling.master`) the answers of all systems make a
recursion of the deviations of what is exchanged. It grows, where the exchange is unstable. What is small against its
interval, as a mass that hangs on a force that comes too late, grows within a few exchanges; what the scenes do by
themselves in longer times, as a pendulum that is upside down, is seen as well and has the same rate in seconds with any
interval.

The *loop gain* is the square of the spectral radius of ``R_1 / H`` of all systems together: how much of what one is
told of the end of an interval comes back to it from the others. Repetitions that put in what has come out would
converge if it is less than one; `Master` measures the loop, and needs no such thing. For a joint that gives speeds
to one side, and reactions to the other, it is half the mass of the first over that of the second, whatever the
interval is, and without repetition deviations grow by the ratio of the masses (C. Gomes et al., "Co-simulation: a
survey", ACM Computing Surveys 51, 2018, section 4.3).
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.coupling.master import Link, Method, System

__all__ = ["EXCHANGES", "GROWS", "ExchangeStability", "exchange_stability"]

EXCHANGES = 60
"""Intervals over which answers are measured."""
GROWS = 1.001
"""Growth of deviations in an exchange that is told."""
GROWING = 1.02
"""Growth of deviations in an exchange that is no rounding and no slow motion of the scenes."""
DELAYS = 4
"""Times in a row of a recursion that is fitted."""
NOISE = 1e-6
"""Of the largest singular value, below which a history has nothing to tell."""
SHOWN = 0.5
"""Part of the growth of a root that histories show, between the phases of an oscillation."""
PULSE = 1e-4
"""Size of a pulse, relative to the values of its link."""


@dataclass(frozen=True)
class ExchangeStability:
    """What was found of an exchange.

    Attributes
    ----------
    interval
        Between exchanges [s].
    growth
        Factor by which deviations grow in an exchange, at the end of those that were looked at; below one if they fade.
    gain
        Loop gain.
    """

    interval: float
    growth: float
    gain: float

    @property
    def stable(self) -> bool:
        """Whether deviations do not grow."""
        return self.growth <= GROWING

    @property
    def text(self) -> str:
        """In words."""
        words = f"loop gain {self.gain:.3g}"
        if self.stable:
            slow = f"deviations grow {self.growth:.4f} times in each, " if self.growth > GROWS else ""
            return f"stable with {self.interval:g} s between exchanges, {slow}{words}"
        return (
            f"unstable with {self.interval:g} s between exchanges: deviations grow {self.growth:.3g} times in each, "
            + words
        )


class _Answers:
    """Answers of all systems to pulses on their inputs, over some intervals; shapes (intervals, links, links)."""

    def __init__(self, links: Sequence[Link], count: int) -> None:
        self.values = np.zeros((count, len(links), len(links)))
        self.rates = np.zeros_like(self.values)


def _answers(
    systems: Mapping[str, System],
    links: Sequence[Link],
    time: float,
    dt: float,
    count: int,
    sizes: Mapping[int, float] | None,
) -> _Answers:
    """Measure them, one system after the other."""
    found = _Answers(links, count)
    told = {name: system.outputs() for name, system in systems.items()}
    start = [link.told(told[link.source]) for link in links]
    for name, system in systems.items():
        into = [k for k, link in enumerate(links) if link.target == name]
        out = [k for k, link in enumerate(links) if link.source == name]
        if not into or not out:
            continue
        saved = system.save()
        base = {links[k].input: start[k] for k in into}
        still = dict.fromkeys(base, 0.0)
        run = partial(_run, system, saved, time, dt, count, base, still, [links[k] for k in out])
        rest = run({}, {})
        for k in into:
            own = links[k].input
            size = (sizes or {}).get(k, PULSE * max(abs(start[k]), 1.0))
            found.values[:, out, k] = (run({own: size}, {}) - rest) / size
            found.rates[:, out, k] = (run({}, {own: size / dt}) - rest) / (size / dt)
        system.restore(saved)
    return found


def _run(
    system: System,
    saved: object,
    time: float,
    dt: float,
    count: int,
    base: Mapping[str, float],
    still: Mapping[str, float],
    out: Sequence[Link],
    value: Mapping[str, float],
    rate: Mapping[str, float],
) -> NDArray[np.float64]:
    """What the links of a system carry at the ends of some intervals, if the first has another value or rate."""
    system.restore(saved)
    seen = []
    for n in range(count):
        more = (value, rate) if n == 0 else ({}, {})
        system.set(
            {name: x + more[0].get(name, 0.0) for name, x in base.items()},
            {name: x + more[1].get(name, 0.0) for name, x in still.items()},
        )
        system.step(time + n * dt, dt)
        told = system.outputs()
        seen.append([link.told(told) for link in out])
    return np.array(seen)


def exchange_stability(
    systems: Mapping[str, System],
    links: Sequence[Link],
    method: Method,
    time: float,
    dt: float,
    *,
    sizes: Mapping[int, float] | None = None,
    count: int = EXCHANGES,
) -> ExchangeStability:
    """How deviations of what is exchanged grow, from the present state of the systems.

    Parameters
    ----------
    systems, links, method
        As of `heavylift.pipeline.coupling.master.Master`.
    time, dt
        Now, and between exchanges [s].
    sizes
        Of the pulses, by number of the link; a ten-thousandth of what it carries, or of its unit, by default.
    count
        Exchanges that are looked at.

    Returns
    -------
    ExchangeStability
        The systems are in the state in which they were.
    """
    answers = _answers(systems, links, time, dt, count, sizes)
    gain = float(np.abs(np.linalg.eigvals(answers.rates[0] / dt)).max(initial=0.0)) ** 2
    order = list(systems)
    ends = [(order.index(link.source), order.index(link.target)) for link in links]
    seen = [_deviations(answers, method, dt, start, ends) for start in np.eye(len(links))]
    return ExchangeStability(dt, _largest_root(seen), gain)


def _deviations(
    answers: _Answers,
    method: Method,
    dt: float,
    start: NDArray[np.float64],
    ends: Sequence[tuple[int, int]],
) -> NDArray[np.float64]:
    """What follows from a deviation of what the links carry at the beginning; shape (intervals + 1, links)."""
    count, size = len(answers.values), len(start)
    seen = np.zeros((count + 1, size))
    values, rates = np.zeros((count, size)), np.zeros((count, size))
    seen[0] = start
    loop = answers.rates[0] / dt
    for n in range(count):
        values[n] = seen[n]
        if method == "extrapolated" and n:
            rates[n] = (seen[n] - seen[n - 1]) / dt
        past = slice(None, n + 1)
        # what all did up to now, and the values of the beginning of this interval, make of its end
        known = np.einsum("kij,kj->i", answers.values[n::-1], values[past])
        known += np.einsum("kij,kj->i", answers.rates[n::-1], rates[past])
        if method == "iterated":  # the end is what was told of it
            seen[n + 1] = np.linalg.solve(np.eye(size) - loop, known - loop @ seen[n])
            rates[n] = (seen[n + 1] - seen[n]) / dt
        elif method == "sequential":  # those before have given their new outputs already
            for own in range(1 + max(source for source, _ in ends)):
                late = [k for k, (source, target) in enumerate(ends) if target == own and source < own]
                mine = [k for k, (source, _) in enumerate(ends) if source == own]
                known[mine] += (answers.values[0][:, late] @ (known[late] - values[n, late]))[mine]
                values[n, late] = known[late]
            seen[n + 1] = known
        else:
            seen[n + 1] = known
    return seen


def _largest_root(histories: Sequence[NDArray[np.float64]]) -> float:
    """Largest factor of the recursion that all histories follow, each of shape (times, links).

    The recursion of a few times is fitted to all of them (P. J. Schmid, "Dynamic mode decomposition of numerical and
    experimental data", Journal of Fluid Mechanics 656, 2010); of what is smaller than rounding nothing is asked.
    """
    whole = np.array(histories)
    if not np.isfinite(whole).all():
        return math.inf
    scale = np.abs(whole).max(axis=(0, 1))
    whole = whole[:, :, scale > 0.0] / scale[scale > 0.0]
    if whole.size == 0:
        return 0.0
    before, after = [], []
    for history in whole:
        sizes = np.abs(history).max(axis=1)
        grown = np.maximum.accumulate(sizes[::-1])[::-1]
        for n in range(len(history) - DELAYS):
            if grown[n] > 0.0:  # each weighs the same, however far it has grown or faded
                before.append(history[n : n + DELAYS].ravel() / grown[n])
                after.append(history[n + 1 : n + 1 + DELAYS].ravel() / grown[n])
    x, y = np.array(before).T, np.array(after).T
    u, s, vt = np.linalg.svd(x, full_matrices=False)
    rank = int(np.count_nonzero(s > NOISE * s[0]))
    roots = np.linalg.eigvals((u[:, :rank].T @ y @ vt[:rank].T) / s[:rank])
    largest = float(np.abs(roots).max(initial=0.0))
    seen = _amplification(whole)
    # a root beyond one that is rounding shows in no history
    return largest if largest <= 1.0 or seen - 1.0 > SHOWN * (largest - 1.0) else max(1.0, seen)


def _amplification(whole: NDArray[np.float64]) -> float:
    """Growth in an exchange over and above that of a power of time, as of a place that drifts.

    What grows as a power gains the same factor in each doubling of time; what grows in each exchange by the factor r
    gains ``r^(N/4)`` more from N/2 to N than from N/4 to N/2.
    """
    count = whole.shape[1]
    sizes = np.abs(whole).max(axis=2)
    parts = [(count // 8, count // 4), (count // 4, count // 2), (count // 2, count)]
    first, second, third = (np.maximum(sizes[:, a:b].max(axis=1), 1e-300) for a, b in parts)
    gained = (third / second) / np.maximum(second / first, 1.0)
    return float(gained.max() ** (4.0 / count))
