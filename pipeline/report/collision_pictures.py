"""Pictures of colliding surfaces for the report: which collision at which time, and where everything is then."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.assemble.surfaces import stored_surface
from heavylift.pipeline.case.fields import GROUND
from heavylift.pipeline.pictures.collisions import Touching, TouchingSurface, collision_picture
from heavylift.pipeline.pictures.triangles import drawn_triangles
from heavylift.pipeline.report.document import Figure
from heavylift.pipeline.results.words import number_words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.pictures.render import Renderer
    from heavylift.pipeline.report.document import Album
    from heavylift.pipeline.results.histories import Results
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = ["collision_figures", "touching_surfaces"]

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
    stored = stored_surface(case, index, stages)
    points, faces, source = drawn_triangles(stored.whole)
    kept = stored.kept[source]
    if section.body != GROUND:
        pose = _pose(case, results, section.body, record)
        if pose is None:
            return None
        origin, R = pose
        points = origin + points @ R.T
    return TouchingSurface(points, faces[kept], faces[~kept], section.name)


def _pose(
    case: Case, results: Results, name: str, record: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Where the origin of the geometry of a rigid body is in the world, and the rotation to world axes."""
    body = case.bodies[name]
    channels = (f"{name}.position", f"{name}.orientation")
    if body.type != "rigid" or any(channel not in results for channel in channels):
        return None
    position, R = results[channels[0]][record], rotation_matrix(results[channels[1]][record])
    if body.frame.origin == "centre_of_mass":
        position = position - R @ np.array(body.centre_of_mass)
    return position, R


def _own_surface(results: Results, name: str, body: str, record: int) -> TouchingSurface | None:
    """Skin of a frame or shell as pictures have it."""
    from heavylift.pipeline.pictures.meshes import MeshSkin
    from heavylift.pipeline.report.scene import mesh_run

    if body not in results.meshes:
        return None
    run = mesh_run(results.meshes[body], results)
    skin = MeshSkin(run.body, lengths=run.lengths).skin(run.coordinates(record))
    return TouchingSurface(skin.points, skin.triangles, np.empty((0, 3), dtype=np.int64), name)
