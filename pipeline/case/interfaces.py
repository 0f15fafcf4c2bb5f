"""The table of a case file for an interface of a flexible body: where others are attached, by a force and a moment."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import model_validator

from heavylift.pipeline.case.fields import LengthVector, Positive, Section, reject
from heavylift.solver.scene.connections import Place

__all__ = ["InterfaceSection", "holding_joints", "pulled_points", "pulling_joints"]


class InterfaceSection(Section):
    """A place where others are attached: its motion is that of a group of nodes, or of a point of an element."""

    at: LengthVector | None = None
    """Reference point [m], in coordinates of the geometry; by default the middle of the group, by its weights."""
    group: str | None = None
    """Group of nodes; without it and `radius` the place is a point of an element."""
    radius: Annotated[float, Positive("length")] | None = None
    """In place of `group`: nodes of the surface within this distance of `at` [m]."""
    kind: Literal["average", "rigid"] = "average"
    """``average``: weighted mean motion of the group, which stays as soft as it is (RBE3), weights are tributary areas
    or lengths; ``rigid``: the group does not deform (RBE2)."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.group is not None and self.radius is not None:
            reject("'group' and 'radius'", "one of them", key="radius")
        if self.at is None and self.group is None:
            reject("neither 'at' nor 'group'", "a point, the nodes around it, or both", key="at")
        if self.kind == "rigid" and self.group is None and self.radius is None:
            reject("kind 'rigid' of a point", "'group' or 'radius': nodes that do not deform", key="kind")
        return self


def holding_joints(joints: Sequence[Any], body: str) -> list[tuple[int, Any]]:
    """Joints that hold directions of a body at a point, with their numbers: moments go through them."""
    return [
        (index, joint)
        for index, joint in enumerate(joints)
        if body in joint.between
        and joint.DESCRIBED.PLACE is not Place.EDGE
        and any(joint.DESCRIBED.ROTATIONAL)
    ]


def pulling_joints(joints: Sequence[Any], body: str) -> list[tuple[int, Any]]:
    """Joints that hold a point of a body and no direction, with their numbers: forces go through them."""
    holding = {index for index, _ in holding_joints(joints, body)}
    return [
        (index, joint)
        for index, joint in enumerate(joints)
        if body in joint.between and joint.DESCRIBED.PLACE is not Place.EDGE and index not in holding
    ]


def pulled_points(
    ropes: Sequence[Any], forces: Sequence[Any], body: str, inputs: Sequence[Any] = ()
) -> list[tuple[str, tuple[float, float, float]]]:
    """Points of a body at which ropes, forces and inputs pull, with their keys, in coordinates of its geometry [m]."""
    found = [
        (f"ropes.{i}.path.{k}.point", stop.point)
        for i, rope in enumerate(ropes)
        for k, stop in enumerate(rope.path)
        if stop.body == body
    ]
    loads = [(f"forces.{i}", force) for i, force in enumerate(forces)]
    loads += [(f"inputs.{i}", one) for i, one in enumerate(inputs)]
    for key, force in loads:
        if hasattr(force, "point") and force.body == body:
            found.append((f"{key}.point", force.point))
        elif hasattr(force, "points"):
            found += [
                (f"{key}.points.{k}", point)
                for k, (side, point) in enumerate(zip(force.between, force.points, strict=True))
                if side == body
            ]
    return found
