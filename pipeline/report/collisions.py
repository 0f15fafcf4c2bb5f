"""Collisions of a case in a report: what happened at each, and which numbers are forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.pipeline.checks.collision_regime import (
    RESOLVED,
    effective_mass,
    mean_step,
    peak_estimate,
    regime,
)
from heavylift.pipeline.pictures.plots import Series, history_plot
from heavylift.pipeline.report.document import Figure, Section, Table, Text, short_table
from heavylift.pipeline.results.words import number_words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.collisions import Collision
    from heavylift.pipeline.checks.collision_regime import Regime
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["collision_sections"]

_PLOTS = 4  # collisions with plots of their own at most


NUMBERS = ("force", "impulse", "patch")
"""Channels of a recorded contact that are single numbers."""


class Recorded(NamedTuple):
    """One contact in a record: place [m], normal, normal force [N], impulse [N s], patch."""

    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    force: float
    impulse: float
    patch: float


class _Happened:
    """The records of one collision.

    Parameters
    ----------
    case, results
        The case and its time histories.
    name
        First part of its channels.
    """

    def __init__(self, case: Case, results: Results, name: str) -> None:
        self.case, self.results, self.name = case, results, name
        index, self.pair = case.collided[name]
        self.section: Collision = case.collisions[index]

    def history(self, kind: str) -> NDArray[np.float64]:
        """A channel that is one number, shape (nt,); zeros if it is not recorded."""
        name = f"{self.name}.{kind}"
        count = len(self.results.time)
        return self.results[name].reshape(count) if name in self.results else np.zeros(count)

    @property
    def rises(self) -> NDArray[np.float64]:
        """Impulse between a record and the one before [N s], shape (nt,)."""
        impulse = self.history("impulse")
        return np.diff(impulse, prepend=impulse[0])

    @property
    def peak(self) -> int:
        """Record of the largest force of a patch; of a rigid law, or without a force, of the largest impulse."""
        force = self.history("largest_force")
        if self.section.law != "rigid" and np.any(force > 0.0):
            return int(np.argmax(force))
        return int(np.argmax(self.rises))

    @property
    def regime(self) -> Regime | None:
        """How well the largest force is resolved; None of a rigid law, and without a force."""
        record = self.peak
        force = float(self.history("largest_force")[record])
        return regime(self.section, force, self.mass(record), mean_step(self.results, self.case))

    @property
    def resolved(self) -> bool:
        """Whether its forces are forces."""
        found = self.regime
        return found is not None and found.resolved is not False

    def mass(self, record: int) -> float | None:
        """Effective mass at the centre of the forces of the patch with the largest one, along their sum."""
        contacts = self._recorded(record)
        totals: dict[float, float] = {}
        for contact in contacts:
            totals[contact.patch] = totals.get(contact.patch, 0.0) + contact.force
        largest = max(totals, key=lambda patch: totals[patch], default=-1.0)
        members = [contact for contact in contacts if contact.patch == largest]
        return self._mass_at(record, members, [contact.force for contact in members])

    def impact_mass(self, record: int) -> float | None:
        """Effective mass at the centre of the impulses of all recorded contacts, along their sum."""
        contacts = self._recorded(record)
        return self._mass_at(record, contacts, [contact.impulse for contact in contacts])

    def _mass_at(self, record: int, contacts: list[Recorded], weights: list[float]) -> float | None:
        """Effective mass at the weighted centre of some contacts; of translation alone if none weighs."""
        total = sum((w * one.normal for w, one in zip(weights, contacts, strict=True)), np.zeros(3))
        moment = sum((w * one.point for w, one in zip(weights, contacts, strict=True)), np.zeros(3))
        length, weight = float(np.linalg.norm(total)), float(sum(weights))
        if weight <= 0.0 or length == 0.0:
            return effective_mass(self.case, self.results, self.pair, record)
        return effective_mass(self.case, self.results, self.pair, record, moment / weight, total / length)

    def _recorded(self, record: int) -> list[Recorded]:
        """Contacts in a record."""
        found = []
        for number in range(1, self.section.recorded + 1):
            prefix = f"{self.name}.contact_{number}"
            if f"{prefix}.normal" not in self.results:
                break
            values = [self.results[f"{prefix}.{kind}"][record] for kind in ("point", "normal")]
            numbers = [float(np.ravel(self.results[f"{prefix}.{kind}"][record])[0]) for kind in NUMBERS]
            if np.any(values[1]):
                found.append(Recorded(values[0], values[1], *numbers))
        return found

    def row(self) -> tuple[str, ...]:
        """Of the table of all collisions."""
        force, time = self.history("largest_force"), self.results.time
        record = self.peak
        depth = max(0.0, -float(self.history("gap").min()))
        return (
            self.name,
            " and ".join(self.pair),
            f"{self.history('impacts')[-1]:.0f}",
            number_words(float(self.history("impulse")[-1]), "N s"),
            f"{self.history('contacts').max():.0f} in {self.history('patches').max():.0f}",
            number_words(depth, "m") if depth == 0.0 or depth >= 1e-9 else "below 1 nm",
            self._force_words(float(force[record]), float(time[record])),
            number_words(float(self.history("normal_force")[-1]), "N"),
            number_words(float(self.history("dissipated")[-1]), "J"),
        )

    def _force_words(self, force: float, time: float) -> str:
        if self.section.law == "rigid":
            return "impulse only"
        if force <= 0.0:
            return "none recorded"
        words = f"{number_words(force, 'N')}, {number_words(time, 's')}"
        return words if self.resolved else "not resolved"

    def regime_row(self) -> tuple[str, ...] | None:
        """Of the table of what forces mean; None if no force acted."""
        record = self.peak
        if self.section.law == "rigid":
            return self._rigid_row()
        found = self.regime
        if found is None:
            return None
        known = found.mass is not None and found.phase is not None
        verdict = "not judged: the mass of a frame or shell at a point is not one number"
        if found.resolved is not None:
            steps = f"{found.steps:.3g} steps a pulse"
            verdict = (
                f"a force: {steps}{self._missed(found)}"
                if found.resolved
                else f"NO force: {steps}; only the impulse counts. A shorter step or a softer law resolves it."
            )
        return (
            self.name,
            f"{number_words(float(self.history('largest_force')[record]), 'N')}",
            number_words(found.stiffness, "N/m"),
            f"{found.mass:.6g} kg" if found.mass is not None else "–",
            number_words(found.step, "s"),
            f"{found.phase:.3g}" if known else "–",
            f"{found.restitution:.4g}" if found.restitution is not None else "–",
            verdict,
        )

    def _missed(self, found: Regime) -> str:
        """A word of records that are too far apart for the peak."""
        times = self.results.time
        interval = float(np.diff(times).max()) if len(times) > 1 else 0.0
        if interval <= 0.1 * found.steps * found.step:
            return ""
        return f"; records {number_words(interval, 's')} apart may miss its peak"

    def _rigid_row(self) -> tuple[str, ...] | None:
        rises = np.where(np.diff(self.history("impacts"), prepend=0.0) > 0.0, self.rises, 0.0)
        record = int(np.argmax(rises))
        if rises[record] <= 0.0:
            return None
        section, step = self.section, number_words(mean_step(self.results, self.case), "s")
        assert section.law == "rigid"
        mass = self.impact_mass(record)
        impulse = float(rises[record])
        when = number_words(float(self.results.time[record]), "s")
        verdict = f"rigid: impulse {number_words(impulse, 'N s')} up to {when}, whose force is not known"
        stiffness = "–"
        if section.peak_stiffness is not None and mass is not None:
            stiffness = number_words(section.peak_stiffness, "N/m")
            peak = peak_estimate(impulse, section.restitution, section.peak_stiffness, mass)
            verdict += (
                f"; with the given stiffness the peak is estimated as v sqrt(k m) = "
                f"{number_words(peak.force, 'N')}, from an approach of {number_words(peak.speed, 'm/s')}"
            )
        return (
            self.name,
            "–",
            stiffness,
            f"{mass:.6g} kg" if mass is not None else "–",
            step,
            "–",
            f"{section.restitution:.4g}",
            verdict,
        )

    def figures(self, album: Album) -> list[Figure]:
        """Timeline of the largest force, or of impulses between records if forces are none."""
        times, pair = self.results.time, " and ".join(self.pair)
        if self.resolved:
            series = [Series("largest of a patch", self.history("largest_force"))]
            total = self.history("normal_force")
            if np.any(np.abs(total - series[0].values) > 1e-9 * np.abs(total).max(initial=0.0)):
                series.append(Series("sum of all contacts", total))
            title, unit, words = f"{self.name}: normal force", "N", f"Normal force between {pair} over time."
        else:
            series = [Series("impulse", self.rises)]
            title, unit = f"{self.name}: impulse between records", "N s"
            words = f"Normal impulse between {pair} since the record before; steps of the integration may be shorter."
        content = history_plot(times, series, title=title, unit=unit)
        return [Figure(album.add(f"collision_{self.name}", content), words)]


def collision_sections(
    case: Case, stages: OutputFolder, results: Results | None, renderer: Renderer | None, album: Album
) -> list[Section]:
    """What happened at each collision, what its forces mean, pictures and timelines; nothing without records.

    Parameters
    ----------
    case, stages, results
        The case, its output folder, and its time histories if there are any.
    renderer
        Draws; None on a machine that cannot.
    album
        Takes pictures and plots.
    """
    if results is None or not len(results.time):
        return []
    found = [_Happened(case, results, name) for name in case.collided if f"{name}.impulse" in results]
    if not found:
        return []
    columns = (
        "collision",
        "between",
        "impacts",
        "total impulse",
        "most contacts in patches",
        "deepest penetration",
        "largest force of a patch",
        "force at the end",
        "dissipated",
    )
    items: list[Table | Figure | Text] = [
        short_table(columns, [entry.row() for entry in found], frozenset({2, 3, 4, 5, 6, 7, 8}))
    ]
    rows = [row for row in (entry.regime_row() for entry in found) if row is not None]
    if rows:
        header = ("collision", "force", "k", "m", "h", "omega h", "e", "what the force is")
        items.append(short_table(header, rows, frozenset({1, 2, 3, 4, 5, 6})))
        items.append(
            Text(
                f"A force over time has a meaning only if its pulse is resolved: omega h <= {RESOLVED:g} with "
                "omega = sqrt(k/m), k the stiffness of a patch at that force, m the effective mass of both bodies at "
                "that contact without joints, h the step; e is the restitution of the law. The impulse always has."
            )
        )
    if renderer is not None:
        from heavylift.pipeline.report.collision_pictures import collision_figures

        items += collision_figures(case, stages, results, renderer, album)
    if len(results.time) > 1:
        items += _timelines(found, results, album)
    return [Section("Collisions", tuple(items))]


def _timelines(found: list[_Happened], results: Results, album: Album) -> list[Figure | Text]:
    """Plots of the collisions with the largest impulses, and of the largest force of all."""
    items: list[Figure | Text] = []
    forces = [entry.history("largest_force") for entry in found if entry.resolved]
    if len(forces) > 1:
        content = history_plot(
            results.time,
            [Series("largest force", np.max(forces, axis=0))],
            title="Largest contact force of all collisions",
            unit="N",
        )
        words = "Largest force of a patch of all collisions whose forces are resolved, over time."
        items.append(Figure(album.add("collisions_force", content), words))
    touched = sorted(
        (entry for entry in found if entry.history("impulse")[-1] > 0.0),
        key=lambda entry: -float(entry.history("impulse")[-1]),
    )
    for entry in touched[:_PLOTS]:
        items += entry.figures(album)
    if len(touched) > _PLOTS:
        items.append(Text(f"Plots of the {_PLOTS} of {len(touched)} collisions with the largest impulses."))
    return items
