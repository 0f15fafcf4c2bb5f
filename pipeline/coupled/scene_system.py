"""A scene as a system of a co-simulation, wherever it runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.coupling.master import moves
from heavylift.pipeline.results.storage import StopError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from heavylift.pipeline.exchange.client import RemoteSimulation
    from heavylift.pipeline.stepping.simulation import Simulation

__all__ = ["SceneSystem"]


class SceneSystem:
    """Gives a scene values and rates of its inputs, and reads outputs.

    An input that is a place or a length moves from where it is to what it is told of the end of the interval; one that
    takes no rate has the mean of the interval; any other one has the value, and changes at the rate, that it is told.

    Parameters
    ----------
    name, scene
        The scene, and its name in messages.
    outputs
        Names of what is read.
    """

    def __init__(self, name: str, scene: Simulation | RemoteSimulation, outputs: Sequence[str]) -> None:
        self.name, self.scene = name, scene
        self._outputs = tuple(outputs)
        self._moving = {n for n, info in scene.inputs.items() if moves(info.interpolation, info.unit)}
        self._constant = {n for n, info in scene.inputs.items() if info.interpolation == "constant"}
        self._told: dict[str, tuple[float, float]] = {}

    def set(self, values: Mapping[str, float], rates: Mapping[str, float]) -> None:
        """Inputs of the next interval."""
        self._told = {name: (value, rates[name]) for name, value in values.items()}

    def step(self, time: float, dt: float) -> None:
        """Advance by an interval [s]."""
        del time
        moves = {name: self._setting(name, *told, dt) for name, told in self._told.items()}
        try:
            self.scene.step(dt, moves, self._outputs)
        except StopError as error:
            raise StopError(error.outcome, f"{self.name}: {error}") from None
        except InputError as error:
            raise StopError(Outcome.BAD_INPUT, f"{self.name}: {error}") from None

    def _setting(self, name: str, value: float, rate: float, dt: float) -> float | tuple[float, float]:
        """What is set for an interval that begins with a value and has a rate."""
        if name in self._moving:
            return value + rate * dt
        if name in self._constant:
            return value + 0.5 * rate * dt
        return value, rate

    def outputs(self) -> dict[str, float]:
        """What was asked for, now."""
        return dict(zip(self._outputs, self.scene.get(self._outputs), strict=True))

    def save(self) -> Any:
        """The state now."""
        return self.scene.save()

    def restore(self, state: Any) -> None:
        """Go back to a state."""
        self.scene.restore(state)
