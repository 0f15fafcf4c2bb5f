"""Contours of a scene, packed: splines, what their control points are made of, where they are carried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.splines.modal_sums import modal_data
from heavylift.contours.splines.neutral import NeutralContour, packed
from heavylift.contours.splines.packed_contour import PackedContour
from heavylift.contours.splines.sample_packing import pack_samples
from heavylift.contours.splines.samples import Samples
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, records
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.contact.checks import check_about_curve
from heavylift.solver.contact.kind import (
    OF_GROUND,
    OF_MESH,
    OF_MODES,
    OF_RIGID,
    ContactContour,
    ContourPose,
)
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.contacts import Contour
from heavylift.solver.scene.scene import Scene

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import AnyBody

__all__ = ["PackedContours", "pack_contours"]

OWNERS = {"rigid": OF_RIGID, "modes": OF_MODES, "nodes": OF_MESH}
"""How points of a contour move with a body, as kernels know it."""


@dataclass(frozen=True, eq=False)
class PackedContours:
    """Arrays of `ContactRows`, and what contacts on the contours need to know of them.

    Attributes
    ----------
    rows, poses, constants, net, samples
        As in `ContactRows`.
    sizes
        Largest extension of each contour [m].
    is_curve
        Whether each is a curve.
    mode_counts
        Modes of the bodies of the contours.
    start_normals
        Two directions across each curve, in the world at the start, shape (2, 3): first guess of the normals of a bead.
    """

    rows: Records[ContactContour]
    poses: Records[ContourPose]
    constants: NDArray[np.float64]
    net: NDArray[np.float64]
    samples: Samples
    sizes: list[float]
    is_curve: list[bool]
    mode_counts: list[int]
    start_normals: list[NDArray[np.float64]]


def pack_contours(scene: Scene, ordered: Sequence[AnyBody], dofs: Mapping[str, int]) -> PackedContours:
    """Pack all contours.

    Parameters
    ----------
    scene, ordered
        The scene, and its bodies in the order of their kinds.
    dofs
        First velocity of each body.

    Raises
    ------
    InputError
        If a contour is on a body that is not there, has a degree below 3, has no spline and is not on a mesh, or its
        modes are not those of its body, or what is about a curve cannot be.
    """
    by_name = {body.name: body for body in ordered}
    neutrals = [_neutral(contour, by_name) for contour in scene.contours]
    for contour, neutral in zip(scene.contours, neutrals, strict=True):
        check_about_curve(contour, len(neutral.spaces) == 1)
    frames = [_frame(contour, by_name) for contour in scene.contours]
    moved = [
        NeutralContour(one.spaces, (one.control - origin) @ axes, one.modal, one.weights)
        for one, (origin, axes) in zip(neutrals, frames, strict=True)
    ]
    table, knots, weights, net = packed(moved)
    constants = [knots, weights]
    rows = records(ContactContour, len(moved))
    poses = records(ContourPose, len(moved))
    for name in PackedContour.fields_of:
        rows[name] = table[name]
    rows["first_weight"] += np.where(table["first_weight"] >= 0, len(knots), 0)
    start = len(knots) + len(weights)
    modes, normals = [], []
    for i, (contour, one, (_, axes)) in enumerate(zip(scene.contours, moved, frames, strict=True)):
        body = by_name.get(contour.body)
        rows[i].owner = _owner(contour, body)
        data = _control_data(one) if rows[i].owner == OF_MODES else np.zeros(0)
        rows[i].dof = -1 if body is None else dofs[contour.body]
        rows[i].controls = start
        rows[i].dimension = len(one.spaces)
        rows[i].flip = -1 if contour.flip else 1
        rows[i].body = -1 if body is None else list(by_name).index(contour.body)
        constants.append(data)
        start += len(data)
        poses[i].rotation[:] = np.eye(3).ravel()
        if rows[i].owner == OF_MESH and body is not None:
            poses[i].rotation[:] = rotation_matrix(body.orientation).ravel()
            poses[i].origin[:] = body.position
        poses[i].reach = np.linalg.norm(one.control, axis=1).max()
        poses[i].director[:] = np.asarray(contour.director, dtype=np.float64) @ axes
        poses[i].radius, poses[i].width = contour.radius, contour.width
        modes.append(len(one.modal))
        normals.append(_across(contour, neutrals[i], body))
    constants_of_all = np.concatenate([np.zeros(0), *constants])
    net = np.ascontiguousarray(net)
    deforming = [row.owner not in {OF_RIGID, OF_GROUND} for row in rows]
    return PackedContours(
        rows=rows,
        poses=poses,
        constants=constants_of_all,
        net=net,
        samples=pack_samples([one.spaces for one in moved], rows, constants_of_all, net, deforming),
        sizes=[float(np.ptp(one.control, axis=0).max()) for one in moved],
        is_curve=[len(one.spaces) == 1 for one in moved],
        mode_counts=modes,
        start_normals=normals,
    )


def _owner(contour: Contour, body: AnyBody | None) -> int:
    if body is None:
        return OF_GROUND
    if body.CONTOURS not in OWNERS:
        raise InputError(
            f"{contour.body!r} carries no contours",
            source=contour.name,
            key="body",
            expected="a rigid or flexible body, a frame, a shell, or the ground",
        )
    return OWNERS[body.CONTOURS]


def _neutral(contour: Contour, by_name: Mapping[str, AnyBody]) -> NeutralContour:
    """The spline of a contour; of a mesh its own shape."""
    if contour.body != GROUND and contour.body not in by_name:
        raise InputError(
            f"there is no body {contour.body!r}",
            source=contour.name,
            key="body",
            expected=f"{GROUND} or one of {', '.join(sorted(by_name))}",
        )
    body: Any = by_name.get(contour.body)
    if body is not None and body.SHAPE:
        if contour.neutral is not None:
            raise InputError(
                f"a spline of its own on {contour.body!r}",
                source=contour.name,
                key="neutral",
                expected="none: the contour of a frame or shell is its own shape",
            )
        from heavylift.solver.bodies.ancf.mesh_contour import mesh_contour, start_control

        made = mesh_contour(body)
        control = start_control(body, made)
        return NeutralContour(made.spaces, control, np.zeros((0, *control.shape)), np.zeros(0))
    if contour.neutral is None:
        raise InputError(
            "no points",
            source=contour.name,
            key="points",
            expected="points, nodes or a spline of the contour",
        )
    for space in contour.neutral.spaces:
        if space.degree < 3:
            raise InputError(
                f"degree {space.degree}",
                source=contour.name,
                key="degree",
                expected="3 or more: the curvature of a contour must not jump",
            )
    wanted = 0 if body is None else body.mode_count
    if len(contour.neutral.modal) != wanted:
        raise InputError(
            f"{len(contour.neutral.modal)} modes",
            source=contour.name,
            key="nodes",
            expected=f"the {wanted} of {contour.body!r}",
        )
    return contour.neutral


def _frame(
    contour: Contour, by_name: Mapping[str, AnyBody]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Origin and axes, as columns, of what the solver measures the contour in, in the frame of the body."""
    body = by_name.get(contour.body)
    return (np.zeros(3), np.eye(3)) if body is None else body.contour_frame()


def _control_data(one: NeutralContour) -> NDArray[np.float64]:
    """What control points of a body with modes are made of: position and mode shapes, then the largest of each."""
    largest = np.linalg.norm(one.modal, axis=2).max(axis=1, initial=0.0)
    return np.concatenate([modal_data(one), largest])


def _across(contour: Contour, one: NeutralContour, body: AnyBody | None) -> NDArray[np.float64]:
    """Two directions perpendicular to the first chord of a curve, in the world at the start."""
    if len(one.spaces) == 2:
        return np.eye(3)[:2]
    chord = one.control[1] - one.control[0]
    chord = chord / np.linalg.norm(chord)
    given = np.asarray(contour.director, dtype=np.float64)
    if not np.linalg.norm(np.cross(given, chord)) > 1e-9 * max(1.0, float(np.linalg.norm(given))):
        given = np.eye(3)[np.argmin(np.abs(chord))]
    first = given - (given @ chord) * chord
    first /= np.linalg.norm(first)
    R = np.eye(3) if body is None else rotation_matrix(body.orientation)
    return np.stack([R @ first, R @ np.cross(chord, first)])
