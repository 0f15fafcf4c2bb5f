"""Inputs of a running simulation: what they are, what they are set to, and every check of a setting."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Literal, NoReturn

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.inputs.targets import BoundInputs, Target
    from heavylift.solver.scene.inputs import Interpolation

__all__ = ["InputPorts", "Port"]

CLOSE = 1e-9
"""Of a value, by which rounding may make a setting differ from where the input is, or from a limit; of a step, by which
it may make a time differ from the end of a step."""


@dataclass(frozen=True)
class Port:
    """An input of a simulation.

    Attributes
    ----------
    name
        Its name; what it is set to is recorded as ``NAME.value``.
    quantity, unit
        What it is, and its SI unit.
    sentence
        What it does, in words.
    interpolation
        ``"held"``: it jumps when it is set; ``"linear"``: it moves to what it is set to; ``"constant"``: it jumps, and
        takes no rate.
    smallest, largest
        Limits, infinite if there are none.
    """

    name: str
    quantity: str
    unit: str
    sentence: str
    interpolation: Interpolation | Literal["constant"]
    smallest: float
    largest: float


class InputPorts(Mapping[str, Port]):
    """Inputs of a simulation by name; empty without ``[[inputs]]``.

    Parameters
    ----------
    bound
        Inputs of the packed scene; None without.
    step
        Of the run [s].
    whole_steps
        Whether times are ends of steps: there is no tolerance.
    corners
        Times at which a step must end [s], with room at the end for two of each input.
    clock
        The present time [s].

    Attributes
    ----------
    heard
        How often an input was set.
    ends
        When an input can drive what it drives no more [s], and why; infinite if always.
    """

    def __init__(
        self,
        bound: BoundInputs | None,
        step: float,
        *,
        whole_steps: bool,
        corners: NDArray[np.float64],
        clock: Callable[[], float],
    ) -> None:
        self._clock = clock
        self._bound, self._step, self._whole, self._corners = bound, step, whole_steps, corners
        self._ports: dict[str, Port] = {}
        self._places: dict[str, int] = {}
        self.heard = 0
        self.ends = (math.inf, "")
        if bound is None:
            return
        self._fixed_corners = corners[np.isfinite(corners)].copy()
        self._state = [bound.kind.state[i] for i in range(len(bound.inputs))]
        self._ends = [(math.inf, "")] * len(bound.inputs)
        described = zip(bound.inputs, bound.targets, bound.records, strict=True)
        for i, (one, target, recorded) in enumerate(described):
            low, high = one.smallest, one.largest
            self._places[one.name] = i
            self._ports[one.name] = Port(
                one.name,
                recorded.quantity,
                recorded.unit,
                one.sentence,
                "constant" if target.steady else one.interpolation,
                max(target.lowest, -math.inf if low is None else low),
                min(target.highest, math.inf if high is None else high),
            )

    def __getitem__(self, name: str) -> Port:
        """The input with a name.

        Raises
        ------
        InputError
            If there is none; names the nearest.
        """
        port = self._ports.get(name) if isinstance(name, str) else None
        if port is None:
            near = get_close_matches(str(name), self._ports, 3, 0.4) or list(self._ports)[:10]
            raise InputError(
                f"{name!r} is no input",
                source="inputs",
                key=str(name),
                expected=f"one of: {', '.join(near)}" if near else "a case with [[inputs]]",
            )
        return port

    def __contains__(self, name: object) -> bool:
        """Whether there is such an input."""
        return name in self._ports

    def __iter__(self) -> Iterator[str]:
        """Names in the order of the case."""
        return iter(self._ports)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._ports)

    def parts(self, name: str) -> tuple[Any, Target, Any]:
        """Description, target and state of an input, to try what it does about a state that is put back afterwards.

        Raises
        ------
        InputError
            If there is no such input.
        """
        self[name]
        assert self._bound is not None
        place = self._places[name]
        return self._bound.inputs[place], self._bound.targets[place], self._state[place]

    def value(self, name: str) -> tuple[float, float]:
        """Value of an input now, and its rate [1/s].

        Raises
        ------
        InputError
            If there is no such input.
        """
        return self.at(name, self._clock())

    def at(self, name: str, time: float) -> tuple[float, float]:
        """Value and rate of an input at a time [s] behind its last setting.

        Raises
        ------
        InputError
            If there is no such input.
        """
        self[name]
        state = self._state[self._places[name]]
        since, until, rate = float(state.since), float(state.until), float(state.rate)
        value = float(state.value) + rate * (min(max(time, since), until) - since)
        return value, rate if since <= time < until else 0.0

    def begin(self) -> None:
        """Values at the start, once it is known; refuse a start that is none."""
        if self._bound is None:
            return
        for one, target, state in zip(self._bound.inputs, self._bound.targets, self._state, strict=True):
            value = target.start()
            if value is not None:
                state.value = value
            port = self._ports[one.name]
            if not port.smallest <= state.value <= port.largest:
                self._refuse(
                    one.name, f"{float(state.value):g} {port.unit} at the start", self._range(one.name)
                )
        self.refresh()

    def put(self, settings: Iterable[tuple[str, float, float, float]], time: float) -> bool:
        """Set inputs from a time on [s], all or none; see `heavylift.solver.simulation.Simulation.set_inputs`.

        Returns
        -------
        bool
            Whether anything has changed.

        Raises
        ------
        InputError
            If a setting makes no sense; then nothing is changed.
        """
        asked = [self._planned(*setting, time) for setting in settings]
        planned = [one for one in asked if one is not None]
        if self._bound is None or not planned:
            return False
        for place, value, rate, until, end in planned:
            state = self._state[place]
            self._bound.targets[place].put(time, value, rate, until)
            state.value, state.rate, state.since, state.until = value, rate, time, until
            self._ends[place] = end
            self.heard += 1
        self._derive()
        return True

    def _planned(
        self, name: str, value: float, rate: float, until: float, time: float
    ) -> tuple[int, float, float, float, tuple[float, str]] | None:
        """Place of an input, what it is set to, and its end, or None if it is so already; all checks of a setting."""
        port = self[name]
        assert self._bound is not None
        place = self._places[name]
        target = self._bound.targets[place]
        value, rate, until = self._numbers(name, value, rate, until, time)
        if rate == 0.0 and self.at(name, time) == (value, 0.0):
            return None  # it is so already
        stop = time if rate == 0.0 or math.isinf(until) else until
        if target.steady and rate != 0.0:
            self._refuse(name, f"a rate of {rate:g} {port.unit}/s", "rate 0: it holds what it is set to")
        if self._bound.inputs[place].MOVES:
            now = self.at(name, time)[0]
            if abs(value - now) > CLOSE * max(1.0, abs(now), abs(value)):
                self._refuse(
                    name,
                    f"{value:.9g} {port.unit} while it is at {now:.9g} {port.unit}, which would be a jump",
                    "the value where it is, and a rate that leads to another one",
                )
            if rate != 0.0 and stop > time:
                rate += (value - now) / (stop - time)
            value = now
        self._check_range(name, value, value + rate * (stop - time))
        if rate != 0.0 and math.isinf(until):
            bound = port.largest if rate > 0.0 else port.smallest
            if math.isfinite(bound):
                self._refuse(
                    name,
                    f"a rate of {rate:g} {port.unit}/s without end, which leads beyond {bound:g} {port.unit}",
                    "'until', a time at which it is within",
                )
        if self._whole and math.isfinite(until):
            count = until / self._step
            if abs(count - round(count)) > CLOSE * max(1.0, count):
                self._refuse(
                    name,
                    f"until {until:.9g} s, which is within a step of {self._step:g} s",
                    "a multiple of the step, or a run with a tolerance",
                )
        end = target.end(time, value, rate, until, self._step)
        if end[0] <= time or (end[0] < until < math.inf):
            self._refuse(
                name,
                f"{value:g} {port.unit} with a rate of {rate:g} {port.unit}/s:"
                f" {end[1]} at t = {max(end[0], time):.6g} s",
                "a value that leaves it room",
            )
        return place, value, rate, until, end

    def refresh(self) -> None:
        """Find again what follows from the settings, after a state was restored."""
        if self._bound is None:
            return
        for i, (target, state) in enumerate(zip(self._bound.targets, self._state, strict=True)):
            setting = float(state.value), float(state.rate), float(state.until)
            self._ends[i] = target.end(float(state.since), *setting, self._step)
        self._derive()

    def _derive(self) -> None:
        """The first end, and the corners."""
        self.ends = min(self._ends)
        if self._whole:  # all times are ends of steps
            return
        found = {float(one.until) for one in self._state if float(one.rate) != 0.0}
        found |= {end for end, _ in self._ends} | set(self._fixed_corners.tolist())
        corners = sorted(filter(math.isfinite, found))
        self._corners[: len(corners)] = corners
        self._corners[len(corners) :] = math.inf

    def _numbers(
        self, name: str, value: float, rate: float, until: float, time: float
    ) -> tuple[float, float, float]:
        """Three numbers that make sense."""
        if type(value) is type(rate) is type(until) is float and math.isfinite(value + rate) and until > time:
            return value, rate, until
        found = []
        for key, given in (("value", value), ("rate", rate), ("until", until)):
            try:
                number = math.nan if isinstance(given, str | bytes) else float(given)
            except OverflowError:
                self._refuse(name, f"{key} beyond 1e308", "a finite number")
            except (TypeError, ValueError):
                number = math.nan
            if math.isnan(number) or (math.isinf(number) and (key != "until" or number < 0.0)):
                self._refuse(name, f"{key} {given!r}", "a finite number")
            found.append(number)
        if found[2] <= time:
            self._refuse(name, f"until {found[2]:.9g} s, and it is t = {time:.9g} s", "a later time")
        return found[0], found[1], found[2]

    def _check_range(self, name: str, *values: float) -> None:
        """Within the limits, but for rounding."""
        port = self._ports[name]
        for value in values:
            slack = CLOSE * max(abs(value), 1e-300)
            if not port.smallest - slack <= value <= port.largest + slack:
                self._refuse(name, f"{value:.9g} {port.unit}", self._range(name))
            if not math.isfinite(value):
                self._refuse(name, f"a rate that leads to {value}", "finite values")

    def _range(self, name: str) -> str:
        """Limits of an input, in words."""
        port = self._ports[name]
        assert self._bound is not None
        target = self._bound.targets[self._places[name]]
        low, high = port.smallest, port.largest
        words = [f"{low:g} {port.unit} or more"] * math.isfinite(low)
        words += [f"at most {high:g} {port.unit}"] * math.isfinite(high)
        words += [target.why] * bool(target.why)
        return ", ".join(words) or "a finite number"

    def _refuse(self, name: str, problem: str, expected: str) -> NoReturn:
        raise InputError(problem, source="inputs", key=name, expected=expected)
