"""Bodies with modes of a case: from what the stages have made of their finite elements."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.frames import motion_of, start_of_frame
from heavylift.pipeline.case.interfaces import holding_joints
from heavylift.pipeline.results.model_io import read_header, read_reduced
from heavylift.solver.scene import scene as s
from heavylift.solver.scene.bodies import Body

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.reduced import ReducedBody
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.flexible_bodies import FlexibleBodySection, InitialSection
    from heavylift.pipeline.results.storage import OutputFolder

__all__ = [
    "assemble_body",
    "check_drawn_points",
    "check_points",
    "damping_ratios",
    "modal_coordinates",
    "start_body",
]


def assemble_body(
    case: Case, name: str, body: FlexibleBodySection, folder: OutputFolder
) -> tuple[s.FlexibleBody, NDArray[np.float64]]:
    """Body of a case, and the origin of its frame in the coordinates of its geometry [m]."""
    path = folder.reduced(name)
    reduced = read_reduced(path)
    origin = np.array(json.loads(read_header(path)["frame_origin"]))
    made = s.FlexibleBody(
        name=name,
        reduced=reduced,
        motion=motion_of(body.frame),
        modal_position=modal_coordinates(case, name, reduced, body.initial, "modal_position"),
        modal_velocity=modal_coordinates(case, name, reduced, body.initial, "modal_velocity"),
        damping_ratio=damping_ratios(case, name, body, reduced),
        **start_of_frame(body.initial, origin),
    )
    return made, origin


def damping_ratios(
    case: Case, name: str, body: FlexibleBodySection, reduced: ReducedBody
) -> NDArray[np.float64]:
    """Damping of the vectors of a basis, of critical, shape (nf,).

    Raises
    ------
    InputError
        Neither one number nor one a vector.
    """
    ratios = np.array(body.modes.damping_ratio)
    if len(ratios) not in {1, reduced.mode_count}:
        raise InputError(
            f"{len(ratios)} values",
            source=case.file,
            key=case.place(f"bodies.{name}.modes.damping_ratio"),
            expected=f"1 or {reduced.mode_count}, one a vector of the basis",
        )
    frequencies = np.sqrt(np.maximum(reduced.eigenvalues, 0.0))
    return ratios + 0.5 * body.modes.stiffness_damping * frequencies


def modal_coordinates(
    case: Case, name: str, reduced: ReducedBody, initial: InitialSection, key: str
) -> NDArray[np.float64]:
    """Initial modal coordinates or speeds for mass-normalised shapes, shape (nf,).

    With scaling ``unit_max`` the case gives the motion of the largest component of each shape; that
    component of the mass-normalised shape, sign included, converts it.
    """
    given: Sequence[float] = getattr(initial, key)
    if len(given) > reduced.mode_count:
        raise InputError(
            f"{len(given)} values",
            source=case.file,
            key=case.place(f"bodies.{name}.initial.{key}"),
            expected=f"at most {reduced.mode_count}, one a vector of the basis",
        )
    values = np.zeros(reduced.mode_count)
    values[: len(given)] = given
    if initial.modal_scaling == "unit_max":
        flat = reduced.mode_shapes.reshape(reduced.mode_count, -1)
        largest = np.take_along_axis(flat, np.abs(flat).argmax(axis=1)[:, np.newaxis], axis=1)[:, 0]
        values /= largest
    return values


def check_points(
    case: Case,
    body: s.FlexibleBody,
    origin: NDArray[np.float64],
    points: Sequence[tuple[str, ArrayLike]],
) -> None:
    """Points that it carries must lie on it; they and the origin in coordinates of the geometry [m]."""
    for key, point in points:
        body.reduced.point_at(np.asarray(point) - origin, source=case.file, key=key, origin=origin)


# ---- before the stages have run ----


@dataclass(frozen=True, eq=False)
class StartedBody(Body):
    """A flexible body as far as it is known before it has a mesh: where its frame is at the start."""

    name: str
    motion: Any
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]


def start_body(
    case: Case, name: str, body: FlexibleBodySection
) -> tuple[StartedBody, NDArray[np.float64]] | None:
    """Where it is at the start, and the origin of its frame; None if that is known with its mesh only."""
    if not holding_joints(case.joints, name):
        _check_numbers_of_modes(body)
    computed = getattr(body.frame, "origin", "geometry") == "centre_of_mass"
    if computed and (body.initial.position is not None or body.initial.orientation is not None):
        return None
    origin = np.zeros(3)
    start = start_of_frame(body.initial, origin)
    return StartedBody(name, motion_of(body.frame), start["position"], start["orientation"]), origin


def _check_numbers_of_modes(body: FlexibleBodySection) -> None:
    """Damping and initial motion of modes have no more entries than the basis has vectors."""
    count = body.vector_count
    if count is None:
        return
    if len(body.modes.damping_ratio) not in {1, count}:
        raise InputError(
            f"{len(body.modes.damping_ratio)} values",
            key="modes.damping_ratio",
            expected=f"1 or {count}, one a vector of the basis",
        )
    for key in ("modal_position", "modal_velocity"):
        values = getattr(body.initial, key)
        if len(values) > count:
            raise InputError(
                f"{len(values)} values",
                key=f"initial.{key}",
                expected=f"at most {count}, one a vector of the basis",
            )


def check_drawn_points(
    case: Case, section: FlexibleBodySection, _body: Any, points: Sequence[tuple[str, ArrayLike]]
) -> list[tuple[str, InputError]]:
    """Points farther from all blocks than from a mesh of them, with their keys; of blocks only, and no interfaces."""
    from heavylift.modal.reduced import SAME_PLACE
    from heavylift.preprocess.finite_elements.mesh import BESIDE

    geometry = section.geometry
    if geometry.type != "blocks":
        return []
    errors = []
    low, high = (np.array([getattr(block, side) for block in geometry.add]) for side in ("lower", "upper"))
    extent = float((high.max(axis=0) - low.min(axis=0)).max())
    references = [one.at for one in section.interfaces.values() if one.at is not None]
    for key, point in points:
        place = np.asarray(point, dtype=np.float64)
        if any(np.linalg.norm(place - reference) <= SAME_PLACE * extent for reference in references):
            continue
        distance = np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0.0), axis=1).min()
        if distance <= BESIDE * extent:
            continue
        words = ", ".join(f"{1e3 * value:.6g}" for value in place)
        error = InputError(
            f"point ({words}) mm is not on the body: it is {1e3 * distance:.6g} mm away from its blocks",
            source=case.file,
            key=key,
            expected=f"a point on the body, to {BESIDE:.0%} of its largest extent of {1e3 * extent:.6g} mm, in the "
            "coordinates of the geometry (are the units right?)",
        )
        errors.append((key, error))
    return errors
