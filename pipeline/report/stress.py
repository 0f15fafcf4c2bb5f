"""Section of a report on the stress of a flexible body over the run: groups, hot spots, pictures of the largest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.checks.body_stress import CENTRE_SIDE, body_stress
from heavylift.pipeline.checks.stresses import nodal_stresses
from heavylift.pipeline.report.document import Figure, Table, Text
from heavylift.pipeline.results.model_io import read_model, read_reduced
from heavylift.pipeline.results.signals import scaled_unit
from heavylift.pipeline.results.words import numbers_words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.pictures.bodies import Painter
    from heavylift.pipeline.report.document import Album, Facts
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.pipeline.results.stress_io import BodyStress, PanelStress

    Item = Text | Facts | Table | Figure

__all__ = ["stress_of_run"]

_WORDS = {
    "": "whole stress",
    "bending": "bending alone",
    CENTRE_SIDE: "membrane, centres of elements",
}
"""What is told of a group, by side."""


def stress_of_run(
    case: Case,
    name: str,
    stages: OutputFolder,
    results: Results,
    painter: Painter | None,
    album: Album,
    log: Log | None = None,
) -> tuple[BodyStress | None, list[Item]]:
    """Stress of a body with a table ``stress``, and what the report says of it; None where it cannot be computed.

    Parameters
    ----------
    case, name
        The case, and the name of the body.
    stages, results
        Output folder and time histories.
    painter
        Draws the body; None on a machine that cannot.
    album
        Takes the pictures.
    log
        Told how far it is.
    """
    try:
        stress = body_stress(case, name, stages, results, log)
    except InputError as error:
        return None, [Text(f"No stress: {error}", warning=True)]
    items: list[Item] = [_group_table(stress)]
    if stress.hot_spots:
        items.append(_hot_spot_table(stress))
    if stress.panels is not None and stress.panels.group:
        items.append(_panel_table(stress, stress.panels))
    items += [Text(note) for note in stress.notes]
    if painter is not None:
        items += _figures(name, stages, results, stress, painter, album)
    return stress, items


def _group_table(stress: BodyStress) -> Table:
    """Largest von Mises stress of each group over the run, its place and time, and how much of the strength is used."""
    rows = []
    for group in stress.groups.values():
        sides = (
            ["", *(side for side in group.sides if side in _WORDS)]
            if group.total.any()
            else list(group.sides)
        )
        for side in sides:
            value, record, place = group.extreme(side)
            strength, used = "–", "–"
            if group.strength.size and side in {"", CENTRE_SIDE}:
                low, high = 1e-6 * group.strength
                strength = f"{low:.4g}" if np.isclose(low, high) else f"{low:.4g} to {high:.4g}"
                used = f"{100.0 * group.extreme(side, used=True)[0]:.3g} %"
            rows.append(
                (
                    group.name,
                    _WORDS.get(side, side),
                    f"{1e-6 * value:.4g}",
                    numbers_words(place.tolist(), "m"),
                    f"{stress.times[record]:.6g}",
                    strength,
                    used,
                )
            )
    columns = ("group", "stress", "von Mises [MPa]", "at", "time [s]", "f_y / gamma_M [MPa]", "used")
    return Table(columns, tuple(rows), frozenset({2, 4, 5, 6}))


def _hot_spot_table(stress: BodyStress) -> Table:
    """Largest and smallest structural stress at each weld toe."""
    rows = []
    for name, history in stress.hot_spots.items():
        high, low = int(history.argmax()), int(history.argmin())
        rows.append(
            (
                name,
                f"{1e-6 * history[high]:.4g}",
                f"{stress.times[high]:.6g}",
                f"{1e-6 * history[low]:.4g}",
                f"{stress.times[low]:.6g}",
                f"{1e-6 * (history[high] - history[low]):.4g}",
            )
        )
    columns = ("hot spot", "largest [MPa]", "time [s]", "smallest [MPa]", "time [s]", "range [MPa]")
    return Table(columns, tuple(rows), frozenset({1, 2, 3, 4, 5}))


def _panel_table(stress: BodyStress, panels: PanelStress) -> Table:
    """The panel of each group that is used most by buckling."""
    rows = []
    for name in dict.fromkeys(panels.group):
        own = panels.of(name)
        record, column = np.unravel_index(int(panels.use[:, own].argmax()), (len(stress.times), len(own)))
        panel = own[column]
        sides = [1e3 * float(one[panel]) for one in (panels.length, panels.width, panels.thickness)]
        along, across, shear = 1e-6 * panels.stress[record, panel]
        rows.append(
            (
                name,
                str(len(own)),
                f"{sides[0]:.4g} × {sides[1]:.4g} × {sides[2]:.3g} mm",
                numbers_words(panels.centre[panel].tolist(), "m"),
                f"{along:.4g}, {across:.4g}, {shear:.4g}",
                f"{stress.times[record]:.6g}",
                f"{100.0 * panels.use[record, panel]:.3g} %",
            )
        )
    columns = (
        "group",
        "panels",
        "used most: a × b × t",
        "centre",
        "mean σ along a, across, τ [MPa]",
        "time [s]",
        "used by buckling",
    )
    return Table(columns, tuple(rows), frozenset({1, 5, 6}))


def _figures(
    name: str,
    stages: OutputFolder,
    results: Results,
    stress: BodyStress,
    painter: Painter,
    album: Album,
) -> list[Item]:
    """The deformed body at the time of the largest stress, and the largest stress of every node over the run."""
    whole = [group for group in stress.groups.values() if group.total.any()]
    if not whole:
        return []
    worst = max(whole, key=lambda group: group.extreme()[0])
    _, record, _ = worst.extreme()
    model, reduced = read_model(stages.model(name)), read_reduced(stages.reduced(name))
    q = results[f"{name}.modal_position"].reshape(len(results.time), -1)[record]
    moved: NDArray[np.float64] = np.tensordot(q, reduced.mode_shapes, axes=1)
    turned = None if reduced.mode_rotations is None else np.tensordot(q, reduced.mode_rotations, axes=1)
    if stress.loads.shape[1]:
        moved, turned = stress.corrected(record, moved, turned, reduced.rotating)
    envelope = np.full(model.node_count, np.nan)
    for part in stress.parts:
        if part.total.any():
            np.fmax.at(envelope, part.nodes, part.largest[:, part.total].max(axis=1))
    now = np.where(np.isnan(envelope), np.nan, nodal_stresses(model, [moved], [turned])[0])
    unit = scaled_unit("s", [results.time[[record]]])
    when = f"t = {results.time[record] / unit.divisor:.6g} {unit.text}"
    figures: list[Item] = []
    for file, values, title, caption in (
        (f"{name}_stress_largest", now, f"{name}: largest stress of the run, {when}",
         f"Von Mises stress in {name} at {when}, when it is largest, in {worst.name}; body frame."),
        (f"{name}_stress_envelope", envelope, f"{name}: envelope of the run",
         f"Largest von Mises stress of each node of {name} over the run, on the shape at {when}."),
    ):  # fmt: skip
        figures.append(Figure(album.add(file, painter.stress(moved, values, title=title)), caption))
    return figures
