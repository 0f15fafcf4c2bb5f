"""The master of a co-simulation: systems that advance by themselves exchange outputs and inputs at given times.

Over an interval H between two exchanges no system knows the inputs that the others will give it. What it is told
instead decides on the order of the error:

``held``
    Outputs of the others at the beginning of the interval, constant: order 1.
``sequential``
    The same, but systems advance one after the other, and later ones get the new outputs: order 1.
``extrapolated``
    Outputs at the beginning, and their rate over the interval before: order 2, if all that is exchanged is
    extrapolated, in both directions.
``iterated``
    Linear between the outputs at the beginning and those at the end; the interval is repeated until what the systems
    were told of its end is what they give there: order 2. Their state must be saved and restored.

A constant misses a smooth input by O(H), a linear polynomial by O(H^2) (Busch, "Continuous approximation techniques for
co-simulation methods", ZAMM 96, 2016). All but ``iterated`` are explicit: stable up to some interval only.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Protocol

import numpy as np

from heavylift.numerics.outcome import Outcome
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["Link", "Master", "Method", "System", "moves"]

Method = Literal["held", "sequential", "extrapolated", "iterated"]
"""How systems are told what the others do within an interval."""

TOLERANCE = 1e-9
"""Of an iterated exchange, relative to the largest value that a link has had."""
MOST_ITERATIONS = 60
"""Of one interval."""
SLOW = 0.05
"""Of the misfit before, from which on a repetition brings too little: then it is measured again how ends depend."""
MOST_MEASURED = 4
"""Times in one interval."""
SINGULAR = 1e-9
"""Of the largest singular value, below which a loop of links has no solution."""
PULSE = 1e-5
"""Of the largest value of a link, by which it is changed for that."""


def moves(interpolation: str, unit: str) -> bool:
    """Whether an input of a scene goes from where it is to what it is told of the end of an interval.

    Places, lengths and speeds that are linear do; a force or moment begins an interval with what it is told, whatever
    acted before: nothing is lost by its jump.
    """
    return interpolation == "linear" and unit not in {"N", "N m"}


class System(Protocol):
    """What a master advances."""

    def set(self, values: Mapping[str, float], rates: Mapping[str, float]) -> None:
        """Inputs from the present time on: values there, and rates [unit/s] until the end of the next step."""

    def step(self, time: float, dt: float) -> None:
        """Advance from a time by an interval [s]."""

    def outputs(self) -> Mapping[str, float]:
        """Outputs at the present time."""

    def save(self) -> Any:
        """The present state, which `restore` takes as often as it is needed."""

    def restore(self, state: Any) -> None:
        """Go back to a state."""


class Link(NamedTuple):
    """An output of one system that is an input of another one.

    Attributes
    ----------
    source, output
        Name of a system, and of its output.
    target, input
        Name of a system, and of its input.
    factor, offset
        ``input = factor * output + offset``.
    """

    source: str
    output: str
    target: str
    input: str
    factor: float = 1.0
    offset: float = 0.0

    def told(self, outputs: Mapping[str, float]) -> float:
        """The input, of the outputs of the source."""
        return self.factor * outputs[self.output] + self.offset


class Master:
    """Advances coupled systems from exchange to exchange.

    Parameters
    ----------
    systems
        By name; ``sequential`` and ``iterated`` advance them in this order.
    links
        What they exchange.
    method
        See the table above.
    tolerance, most
        Of ``iterated``: largest misfit of what is exchanged, relative to the largest value of its link so far, and
        number of repetitions of an interval.

    Attributes
    ----------
    links
        What is exchanged.
    iterations
        How often intervals were made, if they are iterated.

    Examples
    --------
    A tank that empties through a valve, x' = -q, and a valve that lets q = 0.5 x through:

    >>> class Tank:
    ...     x, q, rate = 1.0, 0.0, 0.0
    ...     def set(self, values, rates):
    ...         self.q, self.rate = values["q"], rates["q"]
    ...     def step(self, time, dt):
    ...         self.x -= self.q * dt + 0.5 * self.rate * dt**2
    ...     def outputs(self):
    ...         return {"x": self.x}
    ...     def save(self):
    ...         return self.x
    ...     def restore(self, state):
    ...         self.x = state
    >>> class Valve:
    ...     q, rate = 0.5, 0.0
    ...     def set(self, values, rates):
    ...         self.q, self.rate = 0.5 * values["x"], 0.5 * rates["x"]
    ...     def step(self, time, dt):
    ...         self.q += self.rate * dt
    ...     def outputs(self):
    ...         return {"q": self.q}
    ...     def save(self):
    ...         return self.q
    ...     def restore(self, state):
    ...         self.q = state
    >>> tank = Tank()
    >>> links = [Link("tank", "x", "valve", "x"), Link("valve", "q", "tank", "q")]
    >>> master = Master({"tank": tank, "valve": Valve()}, links, "iterated")
    >>> for k in range(100):
    ...     master.step(0.02 * k, 0.02)
    >>> print(f"{tank.x:.5f}")  # exp(-1) = 0.36788
    0.36788
    """

    def __init__(
        self,
        systems: Mapping[str, System],
        links: Sequence[Link],
        method: Method,
        *,
        tolerance: float = TOLERANCE,
        most: int = MOST_ITERATIONS,
    ) -> None:
        self._systems = dict(systems)
        self.links = tuple(links)
        self._into = {name: [k for k, link in enumerate(links) if link.target == name] for name in systems}
        self._from = {name: [k for k, link in enumerate(links) if link.source == name] for name in systems}
        self.method: Method = method
        self._tolerance, self._most = tolerance, most
        self._largest = [0.0] * len(self.links)
        self._rates = [0.0] * len(self.links)
        self._chord: list[list[float]] = []
        self._missed = [0.0] * len(self.links)
        self.iterations = 0

    @property
    def memory(self) -> list[float]:
        """What the master carries from interval to interval: largest values of links, their rates, and its chord."""
        return [*self._largest, *self._rates, *(number for row in self._chord for number in row)]

    @memory.setter
    def memory(self, numbers: Sequence[float]) -> None:
        count = len(self.links)
        self._largest, self._rates = list(numbers[:count]), list(numbers[count : 2 * count])
        rest = list(numbers[2 * count :])
        self._chord = [rest[i : i + count] for i in range(0, len(rest), count)]

    @property
    def misses(self) -> list[float]:
        """By how much what was told of ends was off at most, relative to the largest value of each link."""
        return [miss / (size or miss or 1.0) for miss, size in zip(self._missed, self._largest, strict=True)]

    def step(self, time: float, dt: float) -> None:
        """Advance all systems by an interval.

        Parameters
        ----------
        time
            Its beginning [s], where all systems are.
        dt
            [s].

        Raises
        ------
        StopError
            If an iterated exchange does not come to an end, with `Outcome.NOT_CONVERGED`.
        """
        now = [0.0] * len(self.links)
        for name in self._systems:
            self._read(name, now)
        if self.method == "iterated":
            self._iterate(time, dt, now)
        elif self.method == "sequential":
            latest = list(now)
            for name, system in self._systems.items():
                self._tell(name, latest, [0.0] * len(now))
                system.step(time, dt)
                self._read(name, latest)
            self._compare(now, latest, 0.0)
        else:
            for name in self._systems:
                self._tell(name, now, self._rates)
            for system in self._systems.values():
                system.step(time, dt)
            after = list(now)
            for name in self._systems:
                self._read(name, after)
            if self.method == "held" or any(self._rates):  # nothing is known of the first rates
                self._compare(now, after, dt)
            if self.method == "extrapolated":
                self._rates = [(b - a) / dt for a, b in zip(now, after, strict=True)]

    def _compare(self, now: list[float], after: list[float], dt: float) -> None:
        """See how far the ends of an interval are from what was told of them."""
        for k, (a, b) in enumerate(zip(now, after, strict=True)):
            self._largest[k] = max(self._largest[k], abs(a), abs(b))
            self._missed[k] = max(self._missed[k], abs(b - a - self._rates[k] * dt))

    def _iterate(self, time: float, dt: float, now: list[float]) -> None:
        """Repeat an interval until its end is what the systems were told of it; the first guess goes on as before."""
        saved = {name: system.save() for name, system in self._systems.items()}
        told = [value + rate * dt for value, rate in zip(now, self._rates, strict=True)]
        before, measured = math.inf, 0
        for count in range(self._most):
            ends = list(told)
            for name in self._systems:
                self._try(name, time, dt, now, told, ends, saved[name] if count else None)
            self.iterations += 1
            misfit, worst = self._misfit(now, told, ends)
            if misfit <= self._tolerance:
                self._largest = [max(map(abs, both)) for both in zip(self._largest, now, ends, strict=True)]
                self._rates = [(b - a) / dt for a, b in zip(now, ends, strict=True)]
                return
            before, slow = misfit, misfit > SLOW * before
            if not self._chord or (slow and measured < MOST_MEASURED):
                self._measure(time, dt, now, told, ends, saved)
                measured, before = measured + 1, math.inf
            misses = [b - a for a, b in zip(told, ends, strict=True)]
            told = [
                value + sum(c * miss for c, miss in zip(row, misses, strict=True))
                for value, row in zip(told, self._chord, strict=True)
            ]
        link = self.links[worst]
        raise StopError(
            Outcome.NOT_CONVERGED,
            f"t = {time:.9g} s: what {link.source!r} gives to {link.target!r} ({link.output} to {link.input}) still "
            f"changes by {misfit:.1e} of its largest value after {self._most} repetitions of {dt:g} s; shorter "
            "intervals between exchanges help",
        )

    def _try(
        self,
        name: str,
        time: float,
        dt: float,
        now: Sequence[float],
        told: Sequence[float],
        ends: list[float],
        state: Any,
    ) -> None:
        """Advance a system that was told of the end of the interval, from a state; what it gives there."""
        system = self._systems[name]
        if state is not None:
            system.restore(state)
        self._tell(name, now, [(b - a) / dt for a, b in zip(now, told, strict=True)])
        system.step(time, dt)
        self._read(name, ends)

    def _misfit(self, now: list[float], told: list[float], ends: list[float]) -> tuple[float, int]:
        """Of the link that fits worst: how far it is off, relative to its largest value, and its number."""
        misfit, worst = 0.0, 0
        for k, (first, a, b) in enumerate(zip(now, told, ends, strict=True)):
            miss, size = abs(b - a), max(self._largest[k], abs(first), abs(b))
            if miss > misfit * size:
                misfit, worst = miss / (size or miss), k
        return misfit, worst

    def _measure(
        self,
        time: float,
        dt: float,
        now: list[float],
        told: list[float],
        ends: list[float],
        saved: Mapping[str, Any],
    ) -> None:
        """How a misfit is to be taken back: ``(1 - M)^-1`` of what the ends become by what is told of them."""
        from scipy.linalg import matrix_balance

        count = len(told)
        loop = np.zeros((count, count))
        for k, link in enumerate(self.links):
            size = PULSE * max(self._largest[k], abs(told[k])) or PULSE
            changed, found = list(told), list(ends)
            changed[k] += size
            self._try(link.target, time, dt, now, changed, found, saved[link.target])
            for i in self._from[link.target]:
                loop[i, k] = (found[i] - ends[i]) / size
        # in units that make its entries alike, small singular values tell of a loop without a solution
        balanced, (sizes, _) = matrix_balance(loop, permute=False, separate=True)
        chord = np.linalg.pinv(np.eye(count) - balanced, rcond=SINGULAR)
        self._chord = (chord * sizes[:, None] / sizes).tolist()

    def _read(self, name: str, values: list[float]) -> None:
        """Put the outputs of a system to its links.

        Raises
        ------
        StopError
            If one is no finite number.
        """
        if not self._from[name]:
            return
        found = self._systems[name].outputs()
        for k in self._from[name]:
            link = self.links[k]
            value = link.told(found)
            if not math.isfinite(value):
                raise StopError(Outcome.NOT_FINITE, f"output {link.output!r} of {name!r} is {value}")
            values[k] = value

    def _tell(self, name: str, values: Sequence[float], rates: Sequence[float]) -> None:
        """Set the inputs of a system."""
        links = self.links
        self._systems[name].set(
            {links[k].input: values[k] for k in self._into[name]},
            {links[k].input: rates[k] for k in self._into[name]},
        )
