"""From the joints of a case to what the solver integrates.

Points and directions of a case stand in coordinates of geometries or in the world at the start; the solver
takes them in the frames of the bodies.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity, WorldDirection
from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.case.fields import Section
from heavylift.pipeline.case.joints import AngleLimitsSection, TravelLimitsSection
from heavylift.pipeline.case.places import located
from heavylift.solver.scene import connections as c
from heavylift.solver.scene.connections import Place
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from heavylift.pipeline.assemble.sides import Side
    from heavylift.pipeline.case.case_file import Case

__all__ = ["assemble_joint", "assemble_joints"]

COINCIDENT = 1e-9
"""Distance [m] below which two points are one."""


def assemble_joints(case: Case, sides: Mapping[str, Side]) -> tuple[c.Joint, ...]:
    """Joints of a case."""
    found: list[c.Joint] = []
    for index, joint in enumerate(case.joints):
        with located(case, f"joints.{index}"):
            found.append(assemble_joint(case, joint, sides))
    return tuple(found)


def assemble_joint(case: Case, joint: Any, sides: Mapping[str, Side]) -> c.Joint:
    """One of them, from its section."""
    if joint.DESCRIBED.PLACE is Place.EDGE:
        from heavylift.pipeline.assemble.meshes import assemble_edge

        return assemble_edge(case, joint, sides)
    return _joint(joint, sides)


def _joint(joint: Any, sides: Mapping[str, Side]) -> c.Joint:
    """What the solver takes, from where a joint is and the keys of its description."""
    described = joint.DESCRIBED
    a, b = (sides[name] for name in joint.between)
    if described.PLACE in {Place.POINT, Place.APART}:
        axes_a, axes_b = np.eye(3), np.eye(3)  # both joint frames are upright in the world at the start
    else:
        axes_a, axes_b = _axes(joint, a, b)
    if getattr(joint, "at", None) is not None:
        points = a.from_world(joint.at), b.from_world(joint.at)
    else:
        points = a.local(joint.points[0]), b.local(joint.points[1])
    if described.PLACE is Place.APART:
        ends = a.to_world(points[0]) - b.to_world(points[1])
        if np.linalg.norm(ends) <= COINCIDENT:
            raise InputError("the two points coincide", key="points", expected="two places, or a ball joint")
    own = {
        field.name: _value(getattr(joint, field.name), field.quantity, axes_a)
        for field in described_fields(described)
    }
    return described(
        name=joint.name,
        body_a=joint.between[0],
        body_b=joint.between[1],
        frame_a=c.JointFrame(points[0], a.rotation.T @ axes_a),
        frame_b=c.JointFrame(points[1], b.rotation.T @ axes_b),
        compliance=joint.compliance,
        relaxation=joint.relaxation,
        **own,
    )


def _axes(joint: Any, a: Side, b: Side) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """World axes of both joint frames at the start, columns: where both sides fit, angle and travel are zero.

    The x axes of both frames are as near to the reference direction, or to that of a, as they can be.
    """
    if joint.axes is not None:
        z_a, z_b = a.rotation @ np.array(joint.axes[0]), b.rotation @ np.array(joint.axes[1])
    else:
        z_a = np.array(joint.axis)
        second = getattr(joint, "second_axis", None)
        z_b = z_a if second is None else np.array(second)
    reference = None if joint.reference is None else np.array(joint.reference)
    axes_a = c.axes_about(z_a, reference, source=joint.name)
    if joint.DESCRIBED.PLACE is Place.CROSS:
        if np.linalg.norm(np.cross(z_a, z_b)) <= 1e-9 * np.linalg.norm(z_a) * np.linalg.norm(z_b):
            raise InputError(
                "the axes of its two sides are parallel",
                key="axes",
                expected="axes perpendicular to each other",
            )
        return axes_a, c.axes_about(z_b, source=joint.name)
    try:
        return axes_a, c.axes_about(z_b, axes_a[:, 0], source=joint.name)
    except InputError:
        raise InputError(
            "the axes of its two sides are perpendicular to each other",
            key="axes",
            expected="axes that agree",
        ) from None


def _value(value: Any, quantity: Quantity | WorldDirection, axes_a: NDArray[np.float64]) -> Any:
    """What a description keeps of the value of a key."""
    if isinstance(quantity, WorldDirection):
        return axes_a.T @ np.array(value)
    if isinstance(value, (AngleLimitsSection, TravelLimitsSection)):
        return c.Limits(
            lower=-np.inf if value.lower is None else value.lower,
            upper=np.inf if value.upper is None else value.upper,
            stiffness=value.stiffness,
            damping=value.damping,
        )
    return assemble(value, {}, Path()) if isinstance(value, Section) else value
