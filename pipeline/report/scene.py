"""Section of a report with pictures of the scene of a run: frames and shells in motion, and all that is beside them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.log import Log
from heavylift.pipeline.page.scene import scene_up
from heavylift.pipeline.report.document import Figure, Section, Text
from heavylift.pipeline.results.mesh_motion import mesh_coordinates
from heavylift.pipeline.results.mesh_results import mesh_body
from heavylift.pipeline.results.words import number_words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.report import AnimationSection
    from heavylift.pipeline.pictures.attached import Others
    from heavylift.pipeline.pictures.meshes import MeshRun
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.pictures.scene import ScenePainter, SolidPainter
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.mesh_results import MeshShape
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["is_pictured", "mesh_run", "scene_others", "scene_painter", "scene_sections", "still_sections"]

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

    others = scene_others(case, stages, results, {}, {})
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


def _legend(case: Case, others: Others) -> list[str]:
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
        *["grey strips: decks · brown circles: wheels"] * bool(case.transporters),
        *["violet: contours · ochre: what touches · red: force on it"] * bool(case.contacts),
        *[f"dots: {' and '.join(marked)}"] * bool(marked),
    ]


def scene_painter(case: Case, stages: OutputFolder, results: Results, renderer: Renderer) -> ScenePainter:
    """Painter of the frames and shells of a run, and of whatever else the case has."""
    from heavylift.pipeline.pictures.meshes import MeshSkin
    from heavylift.pipeline.pictures.scene import ScenePainter

    side = case.report.shell_side
    runs = {name: mesh_run(shape, results) for name, shape in results.meshes.items()}
    skins = {name: MeshSkin(run.body, lengths=run.lengths, side=side) for name, run in runs.items()}
    return ScenePainter(
        renderer,
        runs,
        results.time,
        others=scene_others(case, stages, results, runs, skins),
        up=scene_up(case),
        side=side,
        skins=skins,
    )


def mesh_run(shape: MeshShape, results: Results) -> MeshRun:
    """A recorded frame or shell, as pictures need it."""
    from heavylift.pipeline.pictures.meshes import MeshRun

    def coordinates(record: int) -> NDArray[np.float64]:
        return mesh_coordinates(shape, results, slice(record, record + 1))[0]

    lengths = shape.lengths[:, 0] if shape.type == "frame" else None
    return MeshRun(mesh_body(shape), coordinates, lengths)


def scene_others(
    case: Case, stages: OutputFolder, results: Results, runs: dict[str, MeshRun], skins: dict[str, Any]
) -> Others | None:
    """What stands beside the meshes; nothing if the case has no more, or can no longer be put together."""
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
    if len(case.bodies) == len(runs) and not attached:
        return None
    from heavylift.pipeline.assemble.scene import assemble_scene
    from heavylift.pipeline.pictures.attached import Others
    from heavylift.pipeline.pictures.contacts import scene_size
    from heavylift.pipeline.pictures.outer_surface import Surface, surface_from_mesh
    from heavylift.pipeline.results.model_io import read_model

    try:
        scene = assemble_scene(case, stages)
        surfaces: dict[str, Surface] = {}
        for body in scene.bodies:
            if body.mesh_nodes is not None:
                model = read_model(stages.model(body.name))
                if model.mesh is not None:
                    surface = surface_from_mesh(model.mesh)
                    nodes = body.mesh_nodes[surface.node_indices]  # in the axes of its frame
                    surfaces[body.name] = Surface(
                        nodes,
                        surface.node_indices,
                        surface.triangles,
                        surface.element_edges,
                        surface.feature_edges,
                    )
    except InputError:
        return None
    if any(body.name not in runs for body in scene.bodies if body.name in case.meshes):
        return None

    def channel(name: str, record: int) -> NDArray[np.float64] | None:
        return np.atleast_1d(results[name][record]) if name in results else None

    forces = [
        results[f"{contact.name}.force"] for contact in case.contacts if f"{contact.name}.force" in results
    ]
    return Others(
        scene,
        skins,
        lambda name, record: runs[name].coordinates(record),
        channel,
        surfaces,
        peak=max(
            (float(np.linalg.norm(force.reshape(-1, 3), axis=1).max()) for force in forces), default=0.0
        ),
        size=scene_size(scene),
        times=results.time,
        water=case.sea is not None,
    )


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
