"""Whether a run keeps its balance of energy and its joints closed: what steps gain, lose or open is told."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.scene.channels import Channel

__all__ = ["RunWatch"]

LARGEST_CHANGE = 0.02
"""Of the energy balance, relative to the largest kinetic and elastic energy, that is worth a warning: it holds what
dampers, friction and drives take and give, so what it gains or loses is made by the steps."""

LARGEST_OPENING = 1e-5
"""Violation [m or rad] of a rigid row of a joint that is worth a warning: errors of the motion are some thirty times
that where light bodies carry heavy ones."""

LARGEST_SHARE = 1e-6
"""The same, of the length of the largest body."""

SMALLEST_ENERGY, ROUNDING = 1e-9, 1e-9
"""Least scale of the energy [J], and relative to the largest potential energy."""

GAPS = 2e-8
"""Least scale of the energy relative to weights times sizes of all bodies: gaps are found to 1e-10 of the size, so what
is at rest may rise or sink by that in the first step."""


class RunWatch:
    """Largest gain and loss of the energy balance since the first record, and largest opening of a joint.

    Parameters
    ----------
    channels
        Of the records.
    size
        Length of the largest body [m].
    weight
        Of all bodies, each times its size [J].
    remedy
        What may help beside a smaller step or tolerance, as words that go on a sentence.

    Attributes
    ----------
    gain, loss, scale
        [J]; the scale is the largest sum of kinetic and elastic energy, with a floor: what rounding does to scenes
        at rest is not worth a word.
    opening
        [m or rad].
    """

    def __init__(
        self, channels: Sequence[Channel], size: float = 0.0, weight: float = 0.0, remedy: str = ""
    ) -> None:
        self._column = {channel.name: channel.column for channel in channels}
        self._first: float | None = None
        self.gain = self.loss = self.scale = self.opening = 0.0
        self._remedy = remedy
        self._floor = SMALLEST_ENERGY + GAPS * weight
        self._allowed = max(LARGEST_OPENING, LARGEST_SHARE * size)

    @property
    def begun(self) -> bool:
        """Whether it has seen the first record, to which it compares the others."""
        return self._first is not None

    @property
    def state(self) -> NDArray[np.float64]:
        """What a continuation needs, shape (5,)."""
        first = np.nan if self._first is None else self._first
        return np.array([first, self.gain, self.loss, self.scale, self.opening])

    @state.setter
    def state(self, values: NDArray[np.float64]) -> None:
        first, self.gain, self.loss, self.scale, self.opening = (float(value) for value in values)
        self._first = None if np.isnan(first) else first

    def add(self, records: NDArray[np.float64]) -> None:
        """Look at more records, shape (rows, columns)."""

        def energy(name: str) -> NDArray[np.float64]:
            values: NDArray[np.float64] = records[:, self._column[f"energy.{name}"]]
            return values

        if "monitor.violation" in self._column and len(records):
            self.opening = max(self.opening, float(records[:, self._column["monitor.violation"]].max()))
        balance = energy("balance")
        if not len(balance) or not np.all(np.isfinite(balance)):
            return
        self._first = float(balance[0]) if self._first is None else self._first
        self.gain = max(self.gain, float(balance.max()) - self._first)
        self.loss = max(self.loss, self._first - float(balance.min()))
        floor = self._floor + ROUNDING * float(np.abs(energy("potential")).max())
        self.scale = max(self.scale, float((energy("kinetic") + energy("elastic")).max()), floor)

    @property
    def warning(self) -> str:
        """A sentence if the balance gained or lost too much, or a joint opened, else empty."""
        opened = ""
        if self.opening > self._allowed:
            opened = (
                f"a joint was open by {self.opening:.3g} m or rad (monitor.violation), more than {self._allowed:g}:"
                " its bodies turn too far in a step, or are too light for what they carry; take a smaller step, or"
                " integrator 'accurate'"
            )
        grown, lost = self.gain > LARGEST_CHANGE * self.scale, self.loss > LARGEST_CHANGE * self.scale
        if not grown and not lost:
            return opened
        parts = []
        if grown:
            parts.append(
                f"energy grew by {self.gain:.3g} J ({self.gain / self.scale:.1%}) beyond the work done"
            )
        if lost:
            parts.append(
                f"{self.loss:.3g} J of energy ({self.loss / self.scale:.1%}) were lost that nothing dissipates"
            )
        cure = f"a smaller step or tolerance{self._remedy}"
        return f"{' and '.join(parts)}, of the largest kinetic and elastic energy: take {cure}" + (
            f"; {opened}" if opened else ""
        )
