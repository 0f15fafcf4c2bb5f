"""Section of a report on a lift: what hung on each hook, what lugs and ropes carried, angles and distances."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.checks.criteria import PHASE, phase_words
from heavylift.pipeline.pictures.plots import Series, history_plot
from heavylift.pipeline.report.document import Figure, Section, Table, Text
from heavylift.pipeline.report.operation import phase_bands
from heavylift.pipeline.results.signals import scaled_unit

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results

__all__ = ["lift_section"]

CURVES = 8
"""Of a chart."""


def lift_section(case: Case, results: Results | None, album: Album) -> list[Section]:
    """Tables and charts of what watches ropes and distances; nothing of a case in which nothing does."""
    watching = (case.hook_loads, case.lugs, case.rope_groups, case.leads)
    if results is None or not len(results.time) or not any(watching):
        return []
    lift = _Lift(case, results, album)
    items = [*lift.hooks(), *lift.groups(), *lift.lugs(), *lift.leads(), *lift.distances()]
    if not items:
        return []
    seen = "of all steps" if results.metadata.get("sees_every_step", False) else "of records"
    words = f"Largest and smallest values are those {seen} where the channel has them; times are of the next record."
    return [Section("Lift", (*items, Text(words)))]


class _Lift:
    """What the parts of the section are made from."""

    def __init__(self, case: Case, results: Results, album: Album) -> None:
        self.case, self.results, self.album = case, results, album
        self.has_phases = PHASE in results

    def named(self, table: str, channel: str) -> list[str]:
        """Entries of a table that the run has recorded."""
        return [one.name for one in getattr(self.case, table) if f"{one.name}.{channel}" in self.results]

    def extreme(self, channel: str, side: str) -> tuple[float, str]:
        """Largest (``"max"``), smallest (``"min"``) or value of largest amount (``"amount"``), and when."""
        if side == "amount":
            both = self.extreme(channel, "max"), self.extreme(channel, "min")
            return max(both, key=lambda one: abs(one[0]))
        values = self.results.extremes(channel, side)[0].reshape(len(self.results.time), -1)[:, 0]
        record = int(values.argmax() if side == "max" else values.argmin())
        when = f"{self.results.time[record]:.4g} s"
        if self.has_phases:
            phase = self.results[PHASE].reshape(len(self.results.time), -1)[record, 0]
            when += f", {phase_words(self.case, float(phase))}"
        return float(values[record]), when

    def mean(self, channel: str) -> float:
        """Over time."""
        time, values = self.results.time, self.results[channel].reshape(len(self.results.time), -1)[:, 0]
        if len(time) < 2:
            return float(values[0])
        return float(np.trapezoid(values, time) / (time[-1] - time[0]))

    def first(self, channel: str) -> float:
        """At the first record."""
        return float(self.results[channel].reshape(len(self.results.time), -1)[0, 0])

    def chart(self, channels: dict[str, str], unit: str, title: str, caption: str) -> list[Figure]:
        """Curves of channels by their labels, with the phases of the operation."""
        if len(self.results.time) < 2 or not channels:
            return []
        shown = dict(list(channels.items())[:CURVES])
        curves = [
            Series(label, self.results[channel].reshape(len(self.results.time), -1)[:, 0])
            for label, channel in shown.items()
        ]
        left = len(channels) - len(shown)
        caption += f" {left} more are left out." if left else ""
        content = history_plot(
            self.results.time, curves, title=title, unit=unit, bands=phase_bands(self.results)
        )
        return [Figure(self.album.add(f"lift_{title.replace(' ', '_').lower()}", content), caption)]

    def hooks(self) -> list[Table | Figure]:
        """Loads of the hooks."""
        names = self.named("hook_loads", "hook_load")
        if not names:
            return []
        unit = scaled_unit("N", [np.array([self.extreme(f"{name}.rope_load", "max")[0] for name in names])])
        rows = []
        for name in names:
            load = f"{name}.hook_load"
            (largest, when), (smallest, _) = self.extreme(load, "max"), self.extreme(load, "min")
            ropes, _ = self.extreme(f"{name}.rope_load", "max")
            mean = self.mean(load)
            numbers = (self.first(load), mean, largest, smallest, ropes)
            factor = f"{largest / mean:.3f}" if mean > 0.0 else "–"
            rows.append((name, *(f"{value / unit.divisor:.4g}" for value in numbers), factor, when))
        header = (
            "hook",
            "at the start",
            "mean",
            "largest",
            "smallest",
            "ropes carry",
            "largest/mean",
            "when",
        )
        table = Table(
            (*(f"{word} [{unit.text}]" if 0 < k < 6 else word for k, word in enumerate(header)),),
            tuple(rows),
            frozenset(range(1, 7)),
        )
        loads = {name: f"{name}.hook_load" for name in names}
        caption = "What hangs on each hook, without its block, by records; ropes carry the block, too."
        return [table, *self.chart(loads, "N", "Hook loads", caption)]

    def groups(self) -> list[Table | Figure]:
        """Ropes that share a load."""
        names = self.named("rope_groups", "total_tension")
        if not names:
            return []
        largest = {name: self.extreme(f"{name}.largest_tension", "max") for name in names}
        unit = scaled_unit("N", [np.array([value for value, _ in largest.values()])])
        rows = []
        for name in names:
            smallest, _ = self.extreme(f"{name}.smallest_tension", "min")
            spread, _ = self.extreme(f"{name}.spread", "max")
            used, _ = self.extreme(f"{name}.utilisation", "max")
            slack = float(self.results[f"{name}.slack_time"].ravel()[-1])
            rows.append(
                (
                    name,
                    f"{largest[name][0] / unit.divisor:.4g}",
                    f"{smallest / unit.divisor:.4g}",
                    f"{100.0 * spread:.3g} %",
                    f"{100.0 * used:.3g} %" if used else "–",
                    f"{slack:.3g} s",
                    largest[name][1],
                )
            )
        header = (
            "ropes",
            f"largest [{unit.text}]",
            f"smallest [{unit.text}]",
            "spread",
            "of the breaking load",
            "slack for",
            "largest when",
        )
        spreads = {name: f"{name}.spread" for name in names}
        caption = "Largest less smallest tension of each group over their mean, by records."
        chart = self.chart(spreads, "", "Spread of tensions", caption)
        return [Table(header, tuple(rows), frozenset(range(1, 6))), *chart]

    def lugs(self) -> list[Table | Figure]:
        """Forces on lugs."""
        names = self.named("lugs", "in_plane")
        if not names:
            return []
        ropes = {lug.name: lug.rope for lug in self.case.lugs}
        forces = [self.extreme(f"{name}.force", "max")[0] for name in names]
        unit = scaled_unit("N", [np.array(forces)])
        rows = []
        for name, force in zip(names, forces, strict=True):
            inside, when = self.extreme(f"{name}.in_plane", "max")
            across, _ = self.extreme(f"{name}.out_of_plane", "amount")
            angle, _ = self.extreme(f"{name}.angle", "amount")
            numbers = (f"{value / unit.divisor:.4g}" for value in (force, inside, across))
            rows.append((name, ropes[name], *numbers, f"{math.degrees(angle):.3g}", when))
        header = ("lug", "rope", "force", "in plane", "across", "angle [deg]", "in plane when")
        units = {2, 3, 4}
        heads = tuple(f"{word} [{unit.text}]" if k in units else word for k, word in enumerate(header))
        return [Table(heads, tuple(rows), frozenset(range(2, 6)))]

    def leads(self) -> list[Table | Figure]:
        """Angles of falls; by records."""
        names = self.named("leads", "lead_angle")
        if not names:
            return []
        rows = []
        for name in names:
            parts = [self.extreme(f"{name}.{part}", "amount")[0] for part in ("off_lead", "side_lead")]
            angle, when = self.extreme(f"{name}.lead_angle", "max")
            rows.append((name, *(f"{math.degrees(value):.3g}" for value in (*parts, angle)), when))
        header = (
            "lead",
            "in the plane of the sheaves [deg]",
            "across it [deg]",
            "largest angle [deg]",
            "when",
        )
        return [Table(header, tuple(rows), frozenset({1, 2, 3}))]

    def distances(self) -> list[Table | Figure]:
        """Smallest distances, tilts and radii of relative motions, and gaps of surfaces where they were measured."""
        rows, near = [], {}
        for name in self.named("relative_motions", "distance"):
            least, when = self.extreme(f"{name}.distance", "min")
            tilt, _ = self.extreme(f"{name}.tilt", "max")
            radii = [self.extreme(f"{name}.radius", side)[0] for side in ("min", "max")]
            near[name] = f"{name}.distance"
            rows.append(
                (
                    name,
                    f"{least:.4g}",
                    " to ".join(f"{r:.4g}" for r in radii),
                    f"{math.degrees(tilt):.3g}",
                    when,
                )
            )
        for name in self.case.collided:
            if f"{name}.gap" not in self.results or np.isnan(self.results[f"{name}.gap"]).any():
                continue  # nobody asked for it
            least, when = self.extreme(f"{name}.gap", "min")
            near[name] = f"{name}.gap"
            rows.append((name, f"{least:.4g}", "–", "–", when))
        if not rows:
            return []
        header = ("between", "smallest distance [m]", "radius [m]", "largest tilt [deg]", "smallest when")
        caption = "Distances of points, and gaps of surfaces, by records."
        chart = self.chart(near, "m", "Clearance", caption)
        return [Table(header, tuple(rows), frozenset({1, 2, 3})), *chart]
