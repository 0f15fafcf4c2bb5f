"""Inputs as a linearisation sees them: columns of B and D, and states of what speeds drive.

A force, moment or wind is one column. A speed of a winch or drive has two, its value and its rate, and its integral is
a state, the place of what it drives: ``place' = speed``. An unstretched length has two columns, value and rate.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from heavylift.solver.simulation import Simulation

__all__ = ["Drivers"]

SMALL = 1e-3
"""Of the weight, of gravity: forces and accelerations of the difference quotients."""

SLOW = 1e-4
"""Speeds of them [m/s] a metre of the scene, [rad/s]; angles [rad] and speeds of winds, relative to these."""


class _Driven(NamedTuple):
    """An input: name, target, its state, whether it is a speed, a length, and its value and rate."""

    name: str
    target: Any
    state: Any
    speeds: bool
    length: bool
    value: float
    rate: float


class Drivers:
    """Inputs of a simulation that has not been changed yet.

    Parameters
    ----------
    simulation
        With its inputs.
    names
        Those that are wanted; all that can be served if None.

    Attributes
    ----------
    columns, units
        Names and SI units of the columns of B and D.
    places, place_units
        Names and SI units of the states.
    left_out
        Names of inputs that have no columns, when all are wanted.

    Raises
    ------
    InputError
        If a wanted input is unknown or cannot be served.
    """

    def __init__(self, simulation: Simulation, names: Sequence[str] | None) -> None:
        self._time = simulation.time
        self.columns: list[str] = []
        self.units: list[str] = []
        self.places: list[str] = []
        self.place_units: list[str] = []
        self.left_out: list[str] = []
        self._driven: list[_Driven] = []
        self._column: list[tuple[int, bool]] = []
        self._quantity: list[str] = []
        self._acts: list[bool] = []
        for name in simulation.inputs if names is None else names:
            one, target, state = simulation.inputs.parts(name)
            reason = _refusal(one)
            if reason and names is None:
                self.left_out.append(name)
                continue
            if reason:
                raise InputError(
                    f"{name!r} {reason}",
                    source="linearisation",
                    key="inputs",
                    expected="forces, moments, winds, speeds of winches and drives, lengths of ropes",
                )
            self._add(simulation, name, one, target, state)

    def _add(self, simulation: Simulation, name: str, one: Any, target: Any, state: Any) -> None:
        port = simulation.inputs[name]
        kinematic = one.DRIVES in ("winch", "drive")
        value, rate = simulation.inputs.value(name)
        number = len(self._driven)
        speeds = kinematic and not one.MOVES
        self._driven.append(_Driven(name, target, state, speeds, kinematic and one.MOVES, value, rate))
        self._quantity.append(port.quantity)
        self._acts.append(bool(one.ACTS))
        self.columns.append(name)
        self.units.append(port.unit)
        self._column.append((number, False))
        if kinematic:
            self.columns.append(f"{name}.rate")
            self.units.append(_per_second(port.unit))
            self._column.append((number, True))
        if speeds:
            self.places.append(f"{name}.place")
            self.place_units.append(port.unit.removesuffix("/s"))

    def steps(self, weight: float, size: float) -> NDArray[np.float64]:
        """Of the difference quotients by the columns, in a scene of a weight [N] and a size [m]."""
        found = []
        for number, is_rate in self._column:
            quantity, value = self._quantity[number], abs(self._driven[number].value)
            if self._acts[number]:
                found.append(SMALL * weight * (1.0 if quantity == "force" else size))
            elif "ang" in quantity:
                found.append(SLOW)
            else:
                found.append(SLOW * max(size if self._driven[number].target else 1.0, value))
            if is_rate:
                found[-1] *= 1.0 / SLOW * SMALL
        return np.array(found)

    def place_steps(self, difference: float, size: float) -> NDArray[np.float64]:
        """Of those by the places."""
        return difference * np.array([size if unit == "m" else 1.0 for unit in self.place_units])

    def act(self, places: NDArray[np.float64], u: NDArray[np.float64]) -> None:
        """Displace what speeds drive, and set inputs, by deviations."""
        time, at = self._time, 0
        values, rates = np.zeros(len(self._driven)), np.zeros(len(self._driven))
        for (number, is_rate), amount in zip(self._column, u, strict=True):
            (rates if is_rate else values)[number] += amount
        for number, one in enumerate(self._driven):
            if one.speeds:
                if places[at]:
                    one.target.displace(time, float(places[at]))
                at += 1
            value, rate = float(values[number]), float(rates[number])
            if one.length and value:
                one.target.displace(time, -value)
            if value or rate:
                state = one.state
                state.value, state.rate, state.since = one.value + value, one.rate + rate, time
                state.until = math.inf
                one.target.put(time, one.value + value, one.rate + rate, math.inf)

    def speeds(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates of the places by deviations of the inputs."""
        values = {
            number: amount for (number, is_rate), amount in zip(self._column, u, strict=True) if not is_rate
        }
        return np.array([values[number] for number, one in enumerate(self._driven) if one.speeds])


def _refusal(one: Any) -> str:
    """Why an input has no columns, in words; empty if it has."""
    if one.DRIVES == "tank":
        return "fills a tank, whose water is no state here"
    if one.DRIVES == "controller":
        return "is a set point of a controller, whose pumps have no linear motion"
    if one.DRIVES == "drive" and one.MOVES:
        return "is a place of a drive, whose speed jumps when it is set: take its speed"
    return ""


def _per_second(unit: str) -> str:
    return f"{unit[:-2]}/s2" if unit.endswith("/s") else f"{unit}/s"
