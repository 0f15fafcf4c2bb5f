"""The interactive page: a header and a block of numbers from the scene, the records, the checks and the operation."""

from __future__ import annotations

from dataclasses import field
from html import escape
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.pipeline.drawn.lines import coil
from heavylift.pipeline.drawn.roles import FORCE_COLOUR
from heavylift.pipeline.drawn.scene import POSES, SHAPES, TOUCHES, DrawnScene
from heavylift.pipeline.page.channels import pack_channels
from heavylift.pipeline.page.packing import Block, page_parts
from heavylift.pipeline.pictures.camera import plane_view
from heavylift.pipeline.pictures.drawings import BANDED, colours
from heavylift.pipeline.pictures.meshes import stress_scale
from heavylift.solver.scene.outlines import box_corners

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.drawn.scene import Line, Surface
    from heavylift.pipeline.pictures.meshes import Scale
    from heavylift.pipeline.results.histories import Results

__all__ = ["Judged", "PageContent", "drawn_header", "page_content", "page_html"]

_FAR_APART = 0.03  # size of the largest body beside the scene below which only labels show where bodies are
_CHANNELS = 6  # curves that are plotted at first, at most
_STEPS = (0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)


@dataclass(frozen=True)
class Judged:
    """A criterion or check as a row that leads to where it governs.

    Attributes
    ----------
    name, value, limit, used, where, result
        Words of the row.
    passed
        None if it could not be evaluated.
    time
        When it governs [s]; None of what has no time.
    series
        Channel and component that it is about; None if it is not about one.
    places
        Names of what it is about, the most likely one first.
    bound
        Limit in SI that is drawn into the plot of the channel, with its side.
    """

    name: str
    value: str
    limit: str
    used: str
    where: str
    result: str
    passed: bool | None
    time: float | None = None
    series: tuple[str, str] | None = None
    places: tuple[str, ...] = ()
    bound: tuple[tuple[str, float], ...] = ()


@dataclass
class PageContent:
    """Header and numbers of a page."""

    header: dict[str, Any]
    block: Block = field(default_factory=Block)


def page_content(
    case: Case,
    drawn: DrawnScene | None,
    results: Results | None,
    *,
    verdict: tuple[str, bool | None] = ("", None),
    judged: Sequence[Judged] = (),
    phases: Sequence[tuple[str, float, float]] = (),
    events: Sequence[tuple[float, str]] = (),
    tones: Sequence[tuple[float, float]] = (),
    notes: Sequence[str] = (),
    descriptions: Mapping[str, str] | None = None,
    labelled: bool = False,
    live: str = "",
    version_of_data: int = 0,
) -> PageContent:
    """All that a page shows.

    Parameters
    ----------
    case
        The case.
    drawn
        What is drawn; None if it can no longer be put together.
    results
        Time histories; None before a run.
    verdict
        Its text and whether it passed.
    judged
        Criteria and checks.
    phases
        Name, begin and end [s].
    events
        Time [s] and words.
    tones
        Time [s] and frequency [Hz] of what is heard, if a reader turns the sound on.
    notes
        What else is to be known, warnings first.
    descriptions
        Of channels, by name.
    labelled
        Whether names are written into the scene from the start.
    live
        Word that the page must say to stop the run; empty of a finished one.
    version_of_data
        By which a page notices new records.
    """
    block = Block()
    shown = drawn if drawn is not None else DrawnScene([np.zeros(1)] * 4, np.array([0.0, 0.0, 1.0]))
    timelines = [block.add(times, "f8") for times in shown.times]
    remarks = [*notes, *shown.notes]
    channels: list[dict[str, Any]] = []
    if results is not None and len(results.time):
        channels, more, words = pack_channels(results, block, descriptions or {})
        for channel in channels:
            channel["timeline"] += len(timelines)
        timelines += more
        remarks += words
        begin, end = float(results.time[0]), float(results.time[-1])
    else:
        begin = end = 0.0
    axis = "xyz"[int(np.argmax(np.abs(shown.up)))]
    header: dict[str, Any] = {
        "title": case.title,
        "case": case.name,
        "program": f"heavylift {version('heavylift')}",
        "verdict": {"text": verdict[0], "passed": verdict[1]},
        "begin": begin,
        "end": end,
        "timelines": timelines,
        "up": {"axis": axis, "vector": [float(v) for v in shown.up]},
        "view": [float(v) for v in _view(shown)],
        "box": {"low": shown.view_box[0].tolist(), "high": shown.view_box[1].tolist()},
        "size": shown.view_size,
        "radius": min(2.0e-3 * shown.view_size, 0.02 * shown.largest),
        **drawn_header(shown, block),
        "channels": channels,
        "plotted": [list(one) for one in _plotted(case, channels, judged)],
        "limits": _limits(judged, channels),
        "checks": [_row(one, channels) for one in judged],
        "phases": [list(phase) for phase in phases],
        "events": [{"time": time, "text": text} for time, text in sorted(events, key=lambda one: one[0])],
        "tones": [{"time": time, "tone": tone} for time, tone in sorted(tones)],
        "notes": remarks,
        "labelled": labelled or shown.largest < _FAR_APART * shown.view_size,
        "live": live,
        "version": version_of_data,
    }
    return PageContent(header, block)


def page_html(content: PageContent, below: str = "") -> str:
    """One HTML file with the page alone; `below` is HTML that stands under it."""
    style, body = page_parts(content.header, content.block)
    title = escape(str(content.header["title"]))
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<link rel="icon" href="data:,">\n'
        f"<title>{title}</title>\n"
        f"<style>\nbody {{ margin: 0; }}\n{style}\n</style>\n</head>\n<body>\n{body}\n{below}\n</body>\n</html>\n"
    )


def _view(drawn: DrawnScene) -> NDArray[np.float64]:
    """Direction towards the observer: across a scene that is plane, else from above and one side."""
    # all corners of the boxes: lowest and highest ones alone may lie in a plane that nothing else lies in
    across = plane_view(np.concatenate([box_corners(box) for box in drawn.reached]), drawn.up, flat=1e-3)
    if across is not None:
        return np.array(across.towards)
    if drawn.up[1] != 0.0:
        return np.array([0.45, 0.36 * drawn.up[1], 0.8])
    if drawn.up[0] != 0.0:
        return np.array([0.36 * drawn.up[0], 0.55, 0.75])
    return np.array([0.55, -0.75, 0.36 * drawn.up[2]])


def _stress_colours(drawn: DrawnScene) -> Scale | None:
    """Colours that suit the stresses of all surfaces; None if there are none."""
    parts = [one.stress for one in drawn.surfaces if one.stress is not None]
    if not parts:
        return None
    values = np.concatenate([part[np.isfinite(part)].ravel() for part in parts])
    few = values[:: 1 + len(values) // 2_000_000]
    return stress_scale(few, float(np.abs(values).max(initial=0.0)), signed=drawn.signed)


def _unit_coil() -> NDArray[np.float64]:
    """Points of a coil of length and radius one along z, shape (n, 3)."""
    points, _ = coil(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.125)
    return points * np.array([8.0, 8.0, 1.0])


def drawn_header(drawn: DrawnScene, block: Block) -> dict[str, Any]:
    """What is drawn, as the script of the page has it; its numbers go into the block."""
    scale = _stress_colours(drawn)
    table = None
    if scale is not None:
        low, high = scale.limits
        table = _table(scale.colours)
        title = "axial stress N/A ± M c/I" if drawn.signed else "von Mises stress"
        parts = [one.stress for one in drawn.surfaces if one.stress is not None]
        largest = max(float(np.abs(part[np.isfinite(part)]).max(initial=0.0)) for part in parts)
        stress = {
            "low": low,
            "high": high,
            "largest": largest / scale.divisor,
            "unit": scale.unit,
            "title": title,
            "table": table,
        }
    bodies = []
    for pose in drawn.poses:
        own: dict[str, Any] = {"name": pose.name, "centre": pose.centre.tolist()}
        if len(pose.position) == 1 or not (
            np.ptp(pose.position, axis=0).any() or np.ptp(pose.orientation, axis=0).any()
        ):
            own["fixed"] = [*pose.position[0].tolist(), *pose.orientation[0].tolist()]
        else:
            own |= {
                "timeline": POSES,
                "position": block.add(pose.position),
                "orientation": block.add(pose.orientation),
            }
        bodies.append(own)
    tensions = [
        float(line.tension[np.isfinite(line.tension)].max(initial=0.0))
        for line in drawn.lines
        if line.tension is not None
    ]
    largest = max(tensions, default=0.0)
    lengths = [float(np.linalg.norm(one.force, axis=2).max()) for one in drawn.arrows]
    return {
        "bodies": bodies,
        "surfaces": [_surface(one, block, scale) for one in drawn.solids],
        "lines": [_line(one, block, tense=largest > 0.0) for one in drawn.lines],
        "arrows": [
            {
                "name": one.name,
                "group": "contact forces",
                "timeline": TOUCHES,
                "place": block.quantised(one.place),
                "force": block.quantised(one.force),
                "longest": 0.2 * drawn.view_size,
                "largest": max(lengths),
                "colour": FORCE_COLOUR,
            }
            for one in drawn.arrows
        ],
        "water": _water(drawn, block),
        "stress": None if scale is None else stress,
        "tension": {"largest": largest, "table": _table(colours(BANDED, 256))} if largest > 0.0 else None,
        "labels": [
            {"name": one.name, "body": one.body, "point": one.point.tolist(), "text": one.text}
            for one in drawn.labels
        ],
        "scale": drawn.scale,
        "scales": sorted({*_STEPS, drawn.scale})
        if any(one.modes is not None or one.shapes is not None for one in drawn.surfaces)
        else [1.0],
    }


def _table(bands: Sequence[str]) -> list[list[int]]:
    """256 colours from those of equal bands, each red, green and blue."""
    chosen = [bands[min(k * len(bands) // 256, len(bands) - 1)] for k in range(256)]
    return [[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in chosen]


def _surface(one: Surface, block: Block, scale: Scale | None) -> dict[str, Any]:
    found: dict[str, Any] = {
        "name": one.name,
        "group": one.group,
        "body": one.body,
        "points": block.add(one.points),
        "triangles": block.add(one.triangles, "i4"),
        "colour": one.colour,
        "opacity": one.opacity,
    }
    if one.edges is not None and len(one.edges):
        found["edges"] = block.add(one.edges, "i4")
    if one.coarse is not None:
        found["coarse"] = block.add(one.coarse, "i4")
    if one.modes is not None and one.amplitudes is not None:
        found |= {"modes": block.add(one.modes), "amplitudes": block.add(one.amplitudes), "timeline": POSES}
    elif one.shapes is not None:
        found |= {"shapes": block.quantised(one.shapes), "timeline": SHAPES}
    if one.stress is not None and scale is not None:
        low, high = (limit * scale.divisor for limit in scale.limits)
        values = one.stress if scale.signed else np.abs(one.stress)
        codes = np.clip(np.nan_to_num((values - low) / (high - low)) * 255.0, 0.0, 255.0)
        found |= {"stress": block.add(np.round(codes), "u1"), "stressTimeline": SHAPES}
    if one.anchor is not None:
        found["anchor"] = list(one.anchor)
    if one.at is not None:
        found["at"] = one.at.tolist()
    if one.offset is not None:
        found |= {"offset": block.quantised(one.offset), "offsetTimeline": POSES}
    if one.size is not None:
        found |= {"size": block.add(one.size), "sizeTimeline": POSES}
    return found


def _line(one: Line, block: Block, *, tense: bool) -> dict[str, Any]:
    found: dict[str, Any] = {
        "name": one.name,
        "group": one.group,
        "colour": one.colour,
        "radius": one.radius,
        "on": block.add(one.on, "i4"),
    }
    found["local"] = block.quantised(one.local) if one.local.ndim == 3 else block.add(one.local)
    if one.local.ndim == 3:
        found["timeline"] = one.timeline
    if one.surface is not None and one.vertex is not None:
        found |= {"surface": block.add(one.surface, "i4"), "vertex": block.add(one.vertex, "i4")}
    if one.coiled:
        found["coil"] = block.add(_unit_coil())
    if not one.radius:
        found["ends"] = block.add(one.segments, "i4")
    if one.tension is not None and tense:
        found |= {"tension": block.add(one.tension), "tensionTimeline": POSES}
    if one.loose is not None:
        found |= {"loose": block.add(one.loose.astype(np.uint8), "u1"), "looseTimeline": POSES}
    return found


def _water(drawn: DrawnScene, block: Block) -> dict[str, Any] | None:
    water = drawn.water
    if water is None:
        return None
    waves = None if water.waves is None else {key: block.add(part) for key, part in water.waves.items()}
    # few components can have many cells
    cells = 1 if waves is None else 72 if len(water.waves["kx"]) < 50 else 44  # type: ignore[index]
    return {
        "low": water.low[:2].tolist(),
        "high": water.high[:2].tolist(),
        "level": water.level,
        "waves": waves,
        "cells": [cells, cells],
    }


def _column(channels: Sequence[dict[str, Any]], series: tuple[str, str]) -> tuple[str, int] | None:
    """Channel and number of a component in the page; the first one of one that is not there."""
    for channel in channels:
        if channel["name"] == series[0]:
            components = channel["components"]
            return channel["name"], components.index(series[1]) if series[1] in components else 0
    return None


def _row(one: Judged, channels: Sequence[dict[str, Any]]) -> dict[str, Any]:
    series = None if one.series is None else _column(channels, one.series)
    return {
        "name": one.name,
        "value": one.value,
        "limit": one.limit,
        "used": one.used,
        "where": one.where,
        "result": one.result,
        "passed": one.passed,
        "time": one.time,
        "series": None if series is None else list(series),
        "places": list(one.places),
    }


def _limits(judged: Sequence[Judged], channels: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    found = []
    for one in judged:
        if one.series is None:
            continue
        channel, component = one.series
        found_in = next((each for each in channels if each["name"] == channel), None)
        if found_in is None:
            continue
        several = len(found_in["components"]) > 1
        label = f"{channel}.{component}" if several and component in found_in["components"] else channel
        found += [
            {"series": label, "value": value, "side": side, "name": one.name} for side, value in one.bound
        ]
    return found


def _plotted(
    case: Case, channels: Sequence[dict[str, Any]], judged: Sequence[Judged]
) -> list[tuple[str, int]]:
    """Channels that are plotted at first: those of the report, tensions, what checks are about, where bodies are."""
    by_name = {channel["name"]: channel for channel in channels}
    wanted: list[tuple[str, int]] = []
    for name in case.report.channels:
        if name in by_name:
            wanted += [(name, column) for column in range(min(3, len(by_name[name]["components"])))]
    wanted += [(name, 0) for name in by_name if name.endswith(".tension")][:4]
    for one in judged:
        column = None if one.series is None else _column(channels, one.series)
        if column is not None:
            wanted.append(column)
    for name in by_name:
        if name.endswith((".modal_position", ".von_mises", ".axial_stress")):
            wanted.append((name, 0))
    places = [
        name for name in by_name if name.endswith(".position") and len(by_name[name]["components"]) == 3
    ]
    wanted += [(name, k) for name in places for k in range(3)]
    return list(dict.fromkeys(wanted))[:_CHANNELS]
