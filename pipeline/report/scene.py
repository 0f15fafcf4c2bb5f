"""Section of a report with pictures of the scene of a run: frames and shells in motion, and all that is beside them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.drawn.build import mesh_run, scene_up
from heavylift.pipeline.log import Log
from heavylift.pipeline.report.document import Figure, Section, Text
from heavylift.pipeline.results.words import number_words

if TYPE_CHECKING:
    from collections.abc import Iterable

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.report import AnimationSection
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.pictures.scene import ScenePainter, SolidPainter
    from heavylift.pipeline.pictures.scene_view import SceneView
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["is_pictured", "scene_painter", "scene_sections", "scene_view", "still_sections"]

_STRESSES = {"frame": "axial_stress", "shell": "von_mises"}
_SMALL = (800, 560)  # pixels of an animation


def scene_sections(
    case: Case,
    stages: OutputFolder,
    results: Results | None,
    renderer: Renderer | None,
    album: Album,
    log: Log | None = None,
) -> list[Section]:
    """Pictures of the frames and shells of a run: last record, largest recorded stress, or the times the case asks for.

    Parameters
    ----------
    case, stages, results
        The case, its output folder, and its time histories if there are any.
    renderer
        Draws; None on a machine that cannot.
    album
        Takes the pictures.
    log
        Told how far an animation is.
    """
    animation = case.report.animation
    asked = animation is not None and animation.enabled
    if results is None or not results.meshes or not len(results.time):
        if results is not None and len(results.time) and is_pictured(case):
            return []  # see `still_sections`
        note = Text("No animation: there is no history of anything that could be drawn.", warning=True)
        return [Section("Frames and shells in motion", (note,))] if asked else []
    if renderer is None:
        return []
    painter = scene_painter(case, stages, results, renderer)
    items: list[Figure | Text] = []
    for order, (record, words) in enumerate(_instants(case, results), start=1):
        content = painter.picture(record, title=case.title, note=words)
        more = painter.exaggeration.words
        sentences = [
            f"Shape at {painter.when(record)}{f', {words}' if words else ''}",
            painter.details,
            "Grey: the unloaded shape",
            more[:1].upper() + more[1:],
        ]
        caption = " ".join(f"{sentence}." for sentence in sentences if sentence)
        items.append(Figure(album.add(f"scene_{order}", content), caption))
    if animation is not None and asked:
        items += _animation(case, animation, painter, results, album, log or Log(quiet=True))
    return [Section("Frames and shells in motion", tuple(items))]


def is_pictured(case: Case) -> bool:
    """Whether a scene has pictures at its start and end: one without frames and shells, which have stresses to show."""
    return bool(case.bodies) and not case.meshes


def still_sections(
    case: Case,
    stages: OutputFolder,
    results: Results | None,
    renderer: Renderer | None,
    album: Album,
    log: Log | None = None,
) -> list[Section]:
    """A scene without frames and shells as it began and as it ended; nothing if it can no longer be put together.

    Parameters
    ----------
    case, stages, results
        The case, its output folder, and its time histories if there are any.
    renderer
        Draws; None on a machine that cannot.
    album
        Takes the pictures.
    log
        Told how far an animation is.
    """
    if renderer is None or results is None or not len(results.time) or not is_pictured(case):
        return []
    from heavylift.pipeline.pictures.scene import SolidPainter

    others = scene_view(case, stages, results, _pictured(case, results))
    if others is None:
        return []
    painter = SolidPainter(
        renderer, others, results.time, words=" · ".join(_legend(case, others)), up=scene_up(case)
    )
    if painter.empty:
        return []
    found: list[Figure | Text] = []
    last = len(results.time) - 1
    instants = [(0, "scene_start", "At the start"), (last, "scene_end", "At the end")]
    if case.simulate is not None and case.simulate.duration == 0.0:
        instants = [(last, "scene", "At rest")]
    scale = ", true to scale" if others.factor == 1.0 else ""
    words = f" {painter.details}." if painter.details else ""
    for record, name, when in instants[: last + 1]:
        content = painter.picture(record, title=case.title, note=when)
        caption = f"The scene {when.lower()}{scale}.{words}"
        found.append(Figure(album.add(name, content), caption))
    if others.scattered:
        content = painter.close(last, title=case.title, note=f"The largest body {instants[-1][2].lower()}")
        found.append(Figure(album.add("scene_close", content), "The largest body of the scene."))
    if others.reaches_far:
        content = painter.moorings(last, title=case.title, note=f"Mooring lines {instants[-1][2].lower()}")
        found.append(Figure(album.add("scene_moorings", content), "Mooring lines, true to scale."))
    if case.report.animation is not None and case.report.animation.enabled:
        found += _animation(case, case.report.animation, painter, results, album, log or Log(quiet=True))
    return [Section("Scene", tuple(found))]


def _legend(case: Case, others: SceneView) -> list[str]:
    """What is drawn, of what there is and does not explain itself."""
    ropes = ["ropes"] * bool(case.ropes) + ["mooring lines"] * bool(case.lines)
    kinds = dict.fromkeys(force.type for force in case.forces if hasattr(force, "between"))
    springs = [f"{kind}s" for kind in kinds]
    marked = ["joints"] * bool(case.joints) + ["centres of mass"] * bool(others.centres)
    return [
        *[f"deformation × {others.factor:g}"] * (others.factor != 1.0),
        *["boxes: same mass and inertia"] * bool(others.boxes),
        *[f"brown: {' and '.join(ropes)}"] * bool(ropes),
        *[f"green: {' and '.join(springs)}"] * bool(springs),
        *["orange: fenders"] * bool(case.fenders),
        *["blue balls: water in tanks"] * bool(case.tanks),
        *["grey strips: decks · brown circles: wheels"] * bool(case.transporters),
        *["violet: contours · ochre: what touches · red: force on it"] * bool(case.contacts),
        *[f"dots: {' and '.join(marked)}"] * bool(marked),
    ]


def scene_painter(case: Case, stages: OutputFolder, results: Results, renderer: Renderer) -> ScenePainter:
    """Painter of the frames and shells of a run, and of whatever else the case has."""
    from heavylift.pipeline.drawn.skins import MeshSkin
    from heavylift.pipeline.pictures.scene import ScenePainter

    side = case.report.shell_side
    runs = {name: mesh_run(shape, results) for name, shape in results.meshes.items()}
    skins = {name: MeshSkin(run.body, lengths=run.lengths, side=side) for name, run in runs.items()}
    return ScenePainter(
        renderer,
        runs,
        results.time,
        others=_beside_meshes(case, stages, results),
        up=scene_up(case),
        side=side,
        skins=skins,
    )


def scene_view(
    case: Case, stages: OutputFolder, results: Results, records: Iterable[int]
) -> SceneView | None:
    """What is to be seen of a scene at some records; nothing if it can no longer be put together.

    Parameters
    ----------
    case, stages, results
        The case, its output folder and its time histories.
    records
        Those at which it is drawn; a few more are sampled for the view.
    """
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.pipeline.drawn.build import EXACT, case_scene
    from heavylift.pipeline.pictures.scene_view import SceneView, sampled_records

    chosen = np.union1d(sampled_records(len(results.time)), np.array(list(records), dtype=np.int64))
    try:
        scene = assemble_scene(case, stages)
        return SceneView(case_scene(case, stages, scene, results, detail=EXACT, records=chosen))
    except InputError:
        return None


def _beside_meshes(case: Case, stages: OutputFolder, results: Results) -> SceneView | None:
    """What stands beside frames and shells, and holds them; nothing if the case has no more."""
    attached = (
        case.joints
        or case.ropes
        or case.forces
        or case.contacts
        or case.surfaces
        or case.sea
        or case.lines
        or case.decks
    )
    if (len(case.bodies) == len(results.meshes) and not attached) or set(case.meshes) - set(results.meshes):
        return None
    return scene_view(case, stages, results, _pictured(case, results))


def _pictured(case: Case, results: Results) -> list[int]:
    """Records of all pictures of a scene and of its animation."""
    found = [0, len(results.time) - 1, *(record for record, _ in _instants(case, results))]
    if case.report.animation is not None and case.report.animation.enabled:
        from heavylift.pipeline.pictures.animation import evenly

        found += evenly(results.time, case.report.animation.frames)
    return found


def _instants(case: Case, results: Results) -> list[tuple[int, str]]:
    """Records that are pictured: the nearest to the times asked for, else of largest recorded stress, and the last."""
    if case.report.stress_times:
        nearest = {int(np.argmin(np.abs(results.time - time))) for time in case.report.stress_times}
        return [(record, "") for record in sorted(nearest)]
    last = len(results.time) - 1
    peaks = []
    for name, shape in results.meshes.items():
        channel = f"{name}.{_STRESSES[shape.type]}"
        if channel in results:
            history = np.abs(results[channel].reshape(len(results.time), -1)).max(axis=1)
            peaks.append((float(history.max()), int(np.argmax(history))))
    largest, record = max(peaks, default=(0.0, last))
    if record == last or largest == 0.0:
        return [(last, "end of the run" if last else "")]
    return [(record, "largest recorded stress"), (last, "end of the run")]


def _animation(
    case: Case,
    wanted: AnimationSection,
    painter: ScenePainter | SolidPainter,
    results: Results,
    album: Album,
    log: Log,
) -> list[Figure | Text]:
    """The moving picture, and a word if it could not have the format asked for."""
    from heavylift.pipeline.pictures.animation import choose_format, evenly, shown_seconds, write_animation

    if len(results.time) < 2:
        return [Text("No animation: the run has a single record.", warning=True)]
    records = evenly(results.time, wanted.frames)
    kind = choose_format(wanted.format)
    seconds = shown_seconds(results.time, wanted.duration)
    path = album.path("scene_animation", f".{kind}")
    images = painter.resized(*_SMALL).images(records, title=case.title)
    with log.progress("animation", len(records)) as progress:
        write_animation(path, images, count=len(records), seconds=seconds, progress=progress)
    log.say(f"report: animation of {len(records)} frames in {path}")
    span = float(results.time[-1] - results.time[0])
    caption = (
        f"{number_words(span, 's')} of simulated time in {number_words(seconds, 's')}, {len(records)} frames. "
        f"{painter.details}{'.' * bool(painter.details)}"
    )
    items: list[Figure | Text] = [Figure(album.take(path), caption)]
    if wanted.format not in {"auto", kind}:
        items.append(
            Text("MP4 needs the package imageio-ffmpeg, which is not installed: GIF instead.", warning=True)
        )
    return items
