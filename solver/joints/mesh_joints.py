"""Joints on frames and along edges of shells, expressed as rows on points and slopes before a scene is packed.

Shells carry a triad at every point, so all joints work on them as on rigid bodies. Frames have a tangent and nothing
else: fixed joints and hinges keep it, others work where all their directions are along it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.bases import ALONG, frame_tangent, plan_bases
from heavylift.solver.joints.edges import expand_edge
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.mesh_rows import FrameWeld, Square, SquareJoint
from heavylift.solver.joints.packing import JointPlace, start_frames
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.connections import AlongJoint, EdgeJoint, Joint
from heavylift.solver.scene.scene import Scene

__all__ = ["expand_joints"]

BETWEEN = "a small rigid body between, or another joint"


def expand_joints(scene: Scene) -> Scene:
    """The scene with all joints on frames, and all edges of shells, as joints that have rows of their own.

    Raises
    ------
    InputError
        If a joint is not on the mesh, or wants more of a frame than its tangent; names joint and body.
    """
    bodies: dict[str, Any] = {body.name: body for body in scene.bodies}
    joints: list[Joint] = []
    changed = set()
    for joint in scene.joints:
        sides = [bodies.get(name) for name in (joint.body_a, joint.body_b)]
        if isinstance(joint, EdgeJoint):
            parts = expand_edge(joint, scene.bodies)
        elif isinstance(joint, (FixedJoint, Hinge)) and any(map(_is_curve, sides)):
            parts = [_on_frame(joint, bodies)]
        else:
            parts = [joint]
        if parts != [joint]:
            changed.add(joint.name)
        if any(side is not None and side.SEEN_AT_POINTS for side in sides):
            for part in parts:
                _check(part, joint, bodies)
        joints += parts
    for force in scene.forces:
        if isinstance(force, AlongJoint) and force.joint in changed:
            raise InputError(
                f"the joint {force.joint!r} has no angle: one of its sides is a frame or the edge of a shell",
                source=force.name,
                key="joint",
                expected="a hinge on a small rigid body that is fixed to the frame or shell",
            )
    return replace(scene, joints=tuple(joints))


def _is_curve(side: Any) -> bool:
    """Whether a side has a tangent and nothing else."""
    return side is not None and side.SHAPE == "curve" and not side.HAS_AXES


def _check(part: Joint, joint: Joint, bodies: Mapping[str, Any]) -> None:
    """Pack a joint alone: what does not fit its meshes is then known by its name."""
    from heavylift.solver.joints.registry import joint_module

    book = MarkerBook()
    place = JointPlace(
        0, ChannelBook().add(part.name, part.CHANNELS), start_frames(part, list(bodies.values()))
    )
    joint_module(part).pack([part], [place], book)
    for name in (part.body_a, part.body_b):
        body = bodies.get(name)
        if body is None or not body.SEEN_AT_POINTS:
            continue
        try:
            plan_bases(body, book.of([name])[0])
        except InputError as error:
            raise InputError(
                f"{error.problem}, on {name!r}",
                source=joint.name,
                key=error.key,
                expected=f"{error.expected}: {BETWEEN}" if error.key == "axis" else error.expected,
            ) from None


def _on_frame(joint: FixedJoint | Hinge, bodies: Mapping[str, Any]) -> Joint:
    """A fixed joint or hinge with a frame on one side or on both."""
    if isinstance(joint, Hinge):
        for key, used in (
            ("drive", joint.drive),
            ("limits", joint.limits),
            ("friction", joint.friction or None),
        ):
            if used is not None:
                raise InputError(
                    "a hinge on a frame has no angle",
                    source=joint.name,
                    key=key,
                    expected="none, or a small rigid body between",
                )
    tangents = [
        frame.axes.T @ frame_tangent(bodies[name], frame.point, joint.name)
        if _is_curve(bodies.get(name))
        else None
        for name, frame in ((joint.body_a, joint.frame_a), (joint.body_b, joint.frame_b))
    ]
    place = JointPlace(
        0, ChannelBook().add(joint.name, joint.CHANNELS), start_frames(joint, list(bodies.values()))
    )
    common = {
        key: getattr(joint, key)
        for key in ("name", "body_a", "body_b", "frame_a", "frame_b", "compliance", "relaxation")
    }
    z = np.array([0.0, 0.0, 1.0])
    axis = isinstance(joint, Hinge) and not all(
        tangent is None or np.linalg.norm(np.cross(tangent, z)) <= ALONG for tangent in tangents
    )
    a, b = tangents
    tangent = a if a is not None else b
    assert tangent is not None
    if not axis:
        _refuse_opposite(joint, place, tangent)
    if a is not None and b is not None:
        if axis or not np.linalg.norm(np.cross(a, b)) <= ALONG:
            raise InputError(
                f"the frames {joint.body_a!r} and {joint.body_b!r} meet with tangents"
                f" {np.round(a, 6).tolist()} and {np.round(b, 6).tolist()} in axes of the joint",
                source=joint.name,
                key="axes",
                expected="along the axis of a hinge, or parallel tangents of a fixed joint: a frame has no torsion;"
                f" else {BETWEEN}",
            )
        return FrameWeld(**common, normal=place.frames[0].axes @ _across(a)[0])
    if axis:
        if not abs(tangent[2]) <= ALONG:
            raise InputError(
                f"the axis is {np.degrees(np.arccos(min(abs(tangent[2]), 1.0))):.4g} deg from the tangent of the frame",
                source=joint.name,
                key="axis",
                expected=f"an axis along the tangent or perpendicular to it; else {BETWEEN}",
            )
        normals = z[None, :]
    else:
        normals = _across(tangent)
    frame = joint.frame_b if a is not None else joint.frame_a
    squares = tuple(
        Square(1, frame.axes @ normal) if a is not None else Square(frame.axes @ normal, 1)
        for normal in normals
    )
    return SquareJoint(**common, squares=squares)


def _refuse_opposite(joint: Joint, place: JointPlace, tangent: NDArray[np.float64]) -> None:
    """Rows on tangents vanish for opposite ones too; the intended direction follows from its axes."""
    one, other = (frame.axes @ tangent for frame in place.frames)
    if not one @ other > 0.0:
        raise InputError(
            f"the tangent is {np.degrees(np.arccos(np.clip(one @ other, -1.0, 1.0))):.0f} deg from its place at the"
            " start",
            source=joint.name,
            key="axes",
            expected="the same direction on both sides",
        )


def _across(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Two unit directions perpendicular to a unit direction and to each other, as rows."""
    first = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(direction, first)])
