"""Whether a run keeps its balance of energy and its joints closed: gains, losses and openings are reported."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import Outcome
from heavylift.solver.integrate.kept_columns import KeptColumns
from heavylift.solver.scene.channels import Channel

__all__ = ["STATE", "RunWatch"]

STATE = 8
"""Numbers that a continuation needs."""

LARGEST_CHANGE = 0.02
"""Of the energy balance, relative to the energy turned over, that is worth a warning: it holds what dampers, friction
and drives take and give, so what it gains or loses is made by the steps."""

LARGEST_DRIFT = 0.5
"""The same beyond which a run fails."""

FASTEST = 1e5
"""Mean speed of all bodies [m/s] beyond which no balance says anything: an unstable model takes from its drives what it
gains, and its balance is kept to the last."""

LARGEST_OPENING = 1e-5
"""Violation [m or rad] of a rigid row of a joint that is worth a warning: errors of the motion are some thirty times
that where light bodies carry heavy ones."""

LARGEST_SHARE = 1e-6
"""The same, of the length of the largest body."""

SMALLEST_ENERGY, ROUNDING = 1e-9, 1e-9
"""Least scale of the energy [J], and relative to the largest potential energy."""

FREE, TOUCHING = 2e-8, 5e-6
"""Least scale of the energy relative to weights times sizes of all bodies, without and with contacts: what stands on
others is at rest to some 1e-8 of its size, since gaps are found to 1e-10 and balances of force are not exact."""


VIOLATION = "monitor.violation"
"""Channel of the opening."""


def _of_all(name: str) -> bool:
    """Whether a channel is a sum over all bodies."""
    return name.startswith(("energy.", "momentum."))


class RunWatch:
    """Largest gain and loss of the energy balance since the first record, and largest opening of a joint.

    The measure of both is the energy that was turned over: the largest of the kinetic and elastic energy, of the works
    of drives, of what was dissipated, and of what gravity and other forces from outside gave together.

    Parameters
    ----------
    channels
        Of the records.
    size
        Length of the largest body [m].
    weight
        Of all bodies, each times its size [J].
    touches
        Whether bodies touch.
    mass
        Of all bodies [kg].
    remedy
        What may help beside a smaller step or tolerance, as words that continue a sentence.

    Attributes
    ----------
    gain, loss, scale
        [J]; the scale is the energy turned over, with a floor: what rounding does to scenes at rest is not worth a
        word.
    opening
        [m or rad].
    kinetic
        Largest kinetic energy [J].
    finite
        Whether energies and momenta of all records are numbers.
    begun
        Whether it has the first record, to which it compares the others.
    """

    def __init__(
        self,
        channels: Sequence[Channel],
        size: float = 0.0,
        weight: float = 0.0,
        remedy: str = "",
        *,
        touches: bool = False,
        mass: float = 0.0,
    ) -> None:
        seen = [c for c in channels if _of_all(c.name)] + [c for c in channels if c.name == VIOLATION]
        columns = [(c.name, c.column + i) for c in seen for i in range(len(c.components))]
        self._place = {name: place for place, (name, _) in enumerate(columns)}
        self._sums = sum(_of_all(name) for name, _ in columns)
        self._waiting = KeptColumns(np.array([column for _, column in columns], dtype=np.int64))
        self.begun = False
        self._first: float | None = None
        self._given = 0.0
        self._gain = self._loss = self._scale = self._opening = self._kinetic = 0.0
        self._mass = mass
        self._finite = True
        self._remedy = remedy
        self.floor = SMALLEST_ENERGY + (TOUCHING if touches else FREE) * weight
        self._allowed = max(LARGEST_OPENING, LARGEST_SHARE * size)

    @property
    def gain(self) -> float:
        """[J]."""
        self._look()
        return self._gain

    @property
    def loss(self) -> float:
        """[J]."""
        self._look()
        return self._loss

    @property
    def scale(self) -> float:
        """[J]."""
        self._look()
        return self._scale

    @property
    def opening(self) -> float:
        """[m or rad]."""
        self._look()
        return self._opening

    @property
    def kinetic(self) -> float:
        """Largest kinetic energy [J]."""
        self._look()
        return self._kinetic

    @property
    def finite(self) -> bool:
        """Whether energies and momenta of all records are numbers."""
        if self._finite:
            self._finite = all(np.isfinite(rows[:, : self._sums]).all() for rows in self._waiting.news())
        return self._finite

    @property
    def state(self) -> NDArray[np.float64]:
        """What a continuation needs, shape (`STATE`,)."""
        self._look()
        first = np.nan if self._first is None else self._first
        sums = (self._given, self._gain, self._loss, self._scale, self._opening, self._kinetic)
        return np.array([first, *sums, float(self._finite)])

    @state.setter
    def state(self, values: NDArray[np.float64]) -> None:
        self._waiting.forget()
        first, self._given, self._gain, self._loss, self._scale, self._opening, self._kinetic, finite = map(
            float, values
        )
        self._first, self._finite = None if np.isnan(first) else first, bool(finite)
        self.begun = self._first is not None

    def add(self, records: NDArray[np.float64]) -> None:
        """Take more records, shape (rows, columns); they are looked at when someone asks."""
        self.begun |= len(records) > 0
        self._waiting.add(records)
        if self._waiting.full:
            self._look()

    def _look(self) -> None:
        rows = self._waiting.take()

        def energy(name: str) -> NDArray[np.float64]:
            place = self._place.get(f"energy.{name}")  # results may have been recorded in part
            return np.zeros(len(rows)) if place is None else rows[:, place]

        if not len(rows):
            return
        if VIOLATION in self._place:
            # what is no number is passed over, however many rows are looked at together
            self._opening = float(np.fmax.reduce(rows[:, self._place[VIOLATION]], initial=self._opening))
        known = np.isfinite(rows[:, : self._sums]).all(axis=1)
        if not known.all():
            self._finite = False
            rows = rows[known]
            if not len(rows):
                return
        balance, given = energy("balance"), energy("potential") - energy("external_work")
        if self._first is None:
            self._first, self._given = float(balance[0]), float(given[0])
        self._gain = max(self._gain, float(balance.max()) - self._first)
        self._loss = max(self._loss, self._first - float(balance.min()))
        turned = (
            energy("kinetic") + energy("elastic"),
            energy("drive_work"),
            energy("dissipated"),
            given - self._given,
        )
        self._kinetic = max(self._kinetic, float(energy("kinetic").max()))
        floor = self.floor + ROUNDING * float(np.abs(energy("potential")).max())
        self._scale = max(self._scale, floor, *(float(np.abs(values).max()) for values in turned))

    @property
    def drift(self) -> float:
        """Largest change of the balance over the energy turned over; not a number where records have none."""
        if not self.finite:
            return math.nan
        return max(self.gain, self.loss) / self.scale if self.scale > 0.0 else 0.0

    @property
    def verdict(self) -> tuple[Outcome, str]:
        """Whether the energy balance of a completed run is credible, and why not."""
        if not self.finite:
            return Outcome.NOT_FINITE, (
                f"{Outcome.NOT_FINITE.text} in energies or momenta of records; try a smaller step, or loads and initial"
                " values of a sensible size"
            )
        if self._mass > 0.0 and self.kinetic > 0.5 * self._mass * FASTEST**2:
            return Outcome.ENERGY_NOT_KEPT, (
                f"energy balance not credible: {self.kinetic:.3g} J of kinetic energy would move all bodies with "
                f"{math.sqrt(2.0 * self.kinetic / self._mass):.3g} m/s; the balance is kept, as drives and loads give "
                "whatever an unstable model takes: look for what has no stiffness, or for a drive that never ends"
            )
        if self.drift > LARGEST_DRIFT:
            return Outcome.ENERGY_NOT_KEPT, f"{Outcome.ENERGY_NOT_KEPT.text}: {self.warning}"
        return Outcome.COMPLETED, ""

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
        return f"{' and '.join(parts)}, of the energy that was turned over: take {cure}" + (
            f"; {opened}" if opened else ""
        )
