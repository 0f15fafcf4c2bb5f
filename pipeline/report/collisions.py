"""Collisions in a report: surfaces, contacts, impulses, and pictures of what touches."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.assemble.collisions import collision_notes
from heavylift.pipeline.assemble.surfaces import own_surface, stored_surface
from heavylift.pipeline.case.fields import GROUND
from heavylift.pipeline.checks.collision_regime import (
    RESOLVED,
    effective_mass,
    mean_step,
    peak_estimate,
    regime,
)
from heavylift.pipeline.pictures.collisions import Touching, TouchingSurface, collision_picture
from heavylift.pipeline.pictures.plots import Series, history_plot
from heavylift.pipeline.report.contacts import law_words
from heavylift.pipeline.report.document import Figure, Section, Table, Text, short_table
from heavylift.pipeline.results.words import number_words, numbers_words
from heavylift.solver.scene.outlines import surface_triangles

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.assemble.surfaces import StoredSurface
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.checks.collision_regime import Regime
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = [
    "collision_figures",
    "collision_sections",
    "collision_tables",
    "surface_sections",
    "touching_surfaces",
]


def collision_tables(case: Case) -> list[Table | Text]:
    """Tables of the surfaces and collisions of a case, and what thesis parameters mean; none of what it has not."""
    items: list[Table | Text] = []
    if case.surfaces:
        rows = [_surface_row(case, surface) for surface in case.surfaces]
        items.append(short_table(("surface", "body", "triangles from", "besides"), rows))
    if case.collisions:
        header = ("collision", "between", "law", "besides")
        items.append(short_table(header, [_collision_row(section) for section in case.collisions]))
    items += [Text(f"Parameters of the thesis, {note}.") for note in collision_notes(case)]
    return items


def _surface_row(case: Case, surface: Any) -> tuple[str, ...]:
    words = []
    if any(surface.at):
        words.append(f"at {numbers_words(surface.at, 'm')}")
    if surface.turned is not None:
        words.append(
            f"turned by {surface.turned.angle:.6g} rad about {numbers_words(surface.turned.axis, '')}"
        )
    if surface.radius:
        words.append(f"rounded by {number_words(surface.radius, 'm')}")
    words += [
        f"{'without what lies in' if box.keep == 'outside' else 'only what reaches into'} a box of "
        f"{numbers_words(box.size, 'm')} about {numbers_words(box.centre, 'm')}"
        for box in surface.exclude
    ]
    return (surface.name, surface.body, _source(case, surface), "; ".join(words))


def _source(case: Case, surface: Any) -> str:
    if surface.file is not None:
        unit = f", in {surface.unit}" if surface.unit else ""
        return f"{surface.file}{unit}"
    if surface.shape is None:
        modal = case.bodies[surface.body].BODY.MODAL
        return "own surface" + ("" if modal else f", {surface.facets or 2} facets a side of an element")
    shape = surface.shape
    size = getattr(shape, "size", None)
    if size is not None:
        return f"{shape.type} {numbers_words(size, 'm')}"
    lengths = [key for key in ("radius", "length") if hasattr(shape, key)]
    return shape.type + "".join(f", {key} {number_words(getattr(shape, key), 'm')}" for key in lengths)


def _collision_row(section: Any) -> tuple[str, ...]:
    words = [f"friction {section.friction:g}"] if section.friction else []
    if section.law == "rigid":
        words.append("impacts split the step" if section.events else "impacts at ends of steps")
    if section.method != "swept":
        words.append(f"found by {section.method.replace('-', ' ')}, which misses some")
    where = " and ".join(section.between) if section.between else f"all of {', '.join(section.among)}"
    return (section.name, where, law_words(section, " of a patch"), "; ".join(words))


def surface_sections(case: Case, stages: OutputFolder) -> list[Section]:
    """What the mesh stage found of the surfaces, and warnings of sizes; nothing of what has not been made."""
    from heavylift.pipeline.assemble.surfaces import magnitude_warnings, read_surface_file

    found: dict[str, StoredSurface] = {}
    for surface in case.surfaces:
        try:
            found[surface.name] = read_surface_file(stages.surface(surface.name))
        except InputError:
            continue
    if not found:
        return []
    header = (
        "surface",
        "triangles",
        "points",
        "open edges",
        "edges of 3 and more",
        "wound against neighbours",
        "watertight",
        "excluded",
        "welded, dropped",
        "box",
    )
    rows = [_found_row(name, stored.report) for name, stored in found.items()]
    text = (
        "Collision takes surfaces as they are: open edges, edges of several plates and windings make no difference "
        "to it. Hulls must be closed where they are under water."
    )
    warnings = [
        Text(f"Is the unit right? {warning}", warning=True) for warning in magnitude_warnings(case, found)
    ]
    return [
        Section("Surfaces", (short_table(header, rows, frozenset({1, 2, 3, 4, 5, 7})), Text(text), *warnings))
    ]


def _found_row(name: str, report: dict[str, Any]) -> tuple[str, ...]:
    low, high = np.array(report["bounds"])
    dropped = report.get("dropped")
    words = "–"
    if dropped is not None:
        gone = dropped["degenerate"] + dropped["duplicate"]
        words = f"{dropped['welded']} points, {gone} triangles"
    box = f"{numbers_words(low.tolist(), 'm')} to {numbers_words(high.tolist(), 'm')}"
    if not report["edges"]:
        return (name, "–", "–", "–", "–", "–", "round", "0", words, box)
    return (
        name,
        str(report["triangles"]),
        str(report["points"]),
        str(report["open_edges"]),
        str(report["junction_edges"]),
        str(report["reversed_triangles"]),
        "yes" if report["watertight"] else "no",
        str(report["excluded"]),
        words,
        box,
    )


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
        self.section: Any = case.collisions[index]

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
        depth = max(0.0, -float(np.fmin.reduce(self.history("gap"), initial=0.0)))
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
        # not those of the impulse: a body at rest would hit with its weight times the interval
        rises = np.diff(self.history("impact_impulse"), prepend=0.0)
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


_PICTURES = 4  # at most, without times that the case asks for


def collision_figures(
    case: Case, stages: OutputFolder, results: Results, renderer: Renderer, album: Album
) -> list[Figure]:
    """Pictures of the collisions of a run: each at its largest force or impulse, or at the times the case asks for.

    Parameters
    ----------
    case, stages, results
        The case, its output folder, its time histories.
    renderer
        Draws.
    album
        Takes the pictures.
    """
    up = None
    if case.gravity is not None and any(case.gravity.acceleration):
        up = -np.array(case.gravity.acceleration)
    found = []
    for name, record in _instants(case, results):
        seen = touching_surfaces(case, stages, results, name, record)
        if seen is None:
            continue
        when = number_words(float(results.time[record]), "s")
        count = len(seen.places)
        touching = f"{count} recorded contact{'' if count == 1 else 's'}" if count else "no contact"
        first, second = (surface.label for surface in seen.surfaces)
        kind, unit = _measure(case, name)
        words = f"red: {kind} on {second}"
        note = f"t = {when} · {first} and {second} · {touching}"
        content = collision_picture(
            renderer, seen, title=f"{case.title}: {name}", note=note, words=words, up=up
        )
        if content is None:
            continue
        largest = number_words(_largest(case, results, name), unit)
        caption = f"{name}: {first} and {second} at {when}, {touching}, true to scale."
        if count:
            caption += f" Red: {kind} on {second}; the longest arrow of the run is {largest}."
        if any(len(surface.excluded) for surface in seen.surfaces):
            caption += " Grey: excluded triangles."
        found.append(Figure(album.add(f"collision_{name}_picture", content), caption))
    return found


def _instants(case: Case, results: Results) -> list[tuple[str, int]]:
    """Collisions and records that are pictured, those with the largest impulses first."""
    impulses = {
        name: results[f"{name}.impulse"].reshape(-1) for name in case.collided if f"{name}.impulse" in results
    }
    order = sorted(impulses, key=lambda name: -float(impulses[name][-1]))
    if case.report.collision_times:
        records = sorted({int(np.argmin(np.abs(results.time - t))) for t in case.report.collision_times})
        return [(name, record) for record in records for name in order[:_PICTURES]]
    chosen = []
    for name in order[:_PICTURES]:
        history = results[f"{name}.largest_force"].reshape(-1) if f"{name}.largest_force" in results else None
        rigid = case.collisions[case.collided[name][0]].law == "rigid"
        if rigid or history is None or not np.any(history):
            history = np.diff(impulses[name], prepend=impulses[name][0])
        if np.any(history > 0.0):
            record = int(np.argmax(history))
            touching = (
                results[f"{name}.contacts"].reshape(-1) > 0.0 if f"{name}.contacts" in results else None
            )
            if touching is not None and np.any(touching & (history > 0.0)) and not touching[record]:
                # what has bounced off within the step has left no contact to be seen
                record = int(np.argmax(np.where(touching, history, -1.0)))
            chosen.append((name, record))
    return chosen


def _measure(case: Case, name: str) -> tuple[str, str]:
    """What arrows are: a force, or of a rigid law an impulse; and its unit."""
    rigid = case.collisions[case.collided[name][0]].law == "rigid"
    return ("impulse of the step", "N s") if rigid else ("normal force", "N")


def _contact_channels(case: Case, results: Results, name: str) -> list[str]:
    """First parts of the channels of the recorded contacts of a collision."""
    count = case.collisions[case.collided[name][0]].recorded
    parts = [f"{name}.contact_{number}" for number in range(1, count + 1)]
    kinds = ("point", "normal", "force", "impulse")
    return [part for part in parts if all(f"{part}.{kind}" in results for kind in kinds)]


def _largest(case: Case, results: Results, name: str) -> float:
    """Largest force or impulse of a contact in the run."""
    kind = "impulse" if _measure(case, name)[1] == "N s" else "force"
    return max(
        (float(results[f"{part}.{kind}"].max()) for part in _contact_channels(case, results, name)),
        default=0.0,
    )


def touching_surfaces(
    case: Case, stages: OutputFolder, results: Results, name: str, record: int
) -> Touching | None:
    """Both surfaces of a collision at a record, with its recorded contacts.

    Returns
    -------
    Touching or None
        None if a surface or the pose of its body is not known.
    """
    index = {surface.name: number for number, surface in enumerate(case.surfaces)}
    pair = case.collided[name][1]
    try:
        first, second = (_surface(case, stages, results, index[surface], record) for surface in pair)
    except InputError:
        return None
    if first is None or second is None:
        return None
    kind = "impulse" if _measure(case, name)[1] == "N s" else "force"
    largest = _largest(case, results, name)
    places, arrows = [], []
    for part in _contact_channels(case, results, name):
        if f"{part}.patch" in results and results[f"{part}.patch"][record] < 0.0:
            continue
        normal = results[f"{part}.normal"][record]
        if not np.any(normal):
            continue
        places.append(results[f"{part}.point"][record])
        arrows.append(normal * float(results[f"{part}.{kind}"][record]) / (largest or 1.0))
    return Touching(
        (first, second),
        np.array(places, dtype=np.float64).reshape(-1, 3),
        np.array(arrows, dtype=np.float64).reshape(-1, 3),
    )


def _surface(
    case: Case, stages: OutputFolder, results: Results, index: int, record: int
) -> TouchingSurface | None:
    """A surface at a record, world axes; None if the pose of its body is not recorded."""
    section = case.surfaces[index]
    if section.body in case.meshes:
        return _own_surface(results, section.name, section.body, record)
    if section.body != GROUND and case.bodies[section.body].BODY.MODAL:
        return _modal_surface(case, stages, results, section, record)
    stored = stored_surface(case, index, stages)
    points, faces, source = surface_triangles(stored.whole)
    kept = stored.kept[source]
    if section.body != GROUND:
        pose = _pose(case, results, section.body, record)
        if pose is None:
            return None
        origin, R = pose
        points = origin + points @ R.T
    return TouchingSurface(points, faces[kept], faces[~kept], section.name)


def _modal_surface(
    case: Case, stages: OutputFolder, results: Results, section: Any, record: int
) -> TouchingSurface | None:
    """Outer surface of a body with modes, deformed by them."""
    from heavylift.contours.triangles.body_surface import point_shapes
    from heavylift.pipeline.results.model_io import read_header, read_reduced

    channels = [f"{section.body}.{kind}" for kind in ("position", "orientation", "modal_position")]
    if any(channel not in results for channel in channels):
        return None
    path = stages.reduced(section.body)
    reduced, origin = read_reduced(path), np.array(json.loads(read_header(path)["frame_origin"]))
    surface, nodes = own_surface(section, reduced, origin, case.folder)
    position, orientation, q = (results[channel][record] for channel in channels)
    inside = surface.points + np.tensordot(
        np.atleast_1d(q), point_shapes(reduced, nodes, surface.points), axes=1
    )
    points = position + inside @ rotation_matrix(orientation).T
    return TouchingSurface(points, surface.triangles, np.empty((0, 3), dtype=np.int64), section.name)


def _pose(
    case: Case, results: Results, name: str, record: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Where the origin of the geometry of a rigid body is in the world, and the rotation to world axes."""
    body = case.bodies[name]
    channels = (f"{name}.position", f"{name}.orientation")
    if body.BODY.DEFORMS or any(channel not in results for channel in channels):
        return None
    position, R = results[channels[0]][record], rotation_matrix(results[channels[1]][record])
    position = position - R @ np.array(body.drawn_origin)
    return position, R


def _own_surface(results: Results, name: str, body: str, record: int) -> TouchingSurface | None:
    """Skin of a frame or shell as pictures have it."""
    from heavylift.pipeline.drawn.build import mesh_run
    from heavylift.pipeline.drawn.skins import MeshSkin

    if body not in results.meshes:
        return None
    run = mesh_run(results.meshes[body], results)
    skin = MeshSkin(run.body, lengths=run.lengths).skin(run.coordinates(record))
    return TouchingSurface(skin.points, skin.triangles, np.empty((0, 3), dtype=np.int64), name)
