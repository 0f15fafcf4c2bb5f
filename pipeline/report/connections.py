"""Joints, ropes, forces and vehicles of a case in words and numbers for the report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from heavylift.numerics.quantity import WorldDirection
from heavylift.pipeline.case.channel_kinds import lies_along_edge
from heavylift.pipeline.report.described import described_table, thing_words
from heavylift.pipeline.report.document import short_table
from heavylift.pipeline.results.words import number_words, numbers_words
from heavylift.solver.scene.descriptions import described_fields

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.report.document import Table

__all__ = ["connection_tables"]


def connection_tables(case: Case) -> list[Table]:
    """Tables of the joints, ropes, forces, decks and transporters of a case; none of what it has not."""
    tables = []
    if case.joints:
        columns = ("joint", "type", "between", "place", "axis", "besides")
        tables.append(short_table(columns, [_joint(joint) for joint in case.joints]))
    kinds: dict[str, str] = {joint.name: joint.type for joint in case.joints}
    tables += [*described_table("rope", case.ropes), *described_table("force", case.forces, kinds)]
    tables += described_table("input", case.inputs, kinds)
    return [*tables, *described_table("deck", case.decks), *described_table("transporter", case.transporters)]


def _joint(joint: Any) -> tuple[str, ...]:
    at = getattr(joint, "at", None)
    if lies_along_edge(joint.type):
        place = _edges(joint)
    elif at is not None:
        place = numbers_words(at, "m")
    else:
        place = " and ".join(numbers_words(point, "m") for point in joint.points)
    axes = getattr(joint, "axis", None), getattr(joint, "axes", None)
    axis = numbers_words(axes[0], "") if axes[0] is not None else ""
    if axes[1] is not None:
        axis = " and ".join(numbers_words(entry, "") for entry in axes[1])
    own = described_fields(joint.DESCRIBED)
    directions = [field.name for field in own if isinstance(field.quantity, WorldDirection)]
    for key in ("second_axis", *directions):
        if getattr(joint, key, None) is not None:
            axis += f", {key.replace('_', ' ')} {numbers_words(getattr(joint, key), '')}"
    return (joint.name, joint.type.replace("_", "-"), " – ".join(joint.between), place, axis, _besides(joint))


def _edges(joint: Any) -> str:
    """Edges of a joint along them."""
    if joint.edge or joint.edges:
        return " and ".join(joint.edges or (joint.edge,))
    return " and ".join(f"nodes {numbers_words(nodes, '')}" for nodes in joint.node_lists)


def _besides(joint: Any) -> str:
    """Drive, limits, friction, length and whatever else a joint has, compliance."""
    words = thing_words(joint)
    if joint.compliance:
        words.append(f"compliance {joint.compliance:g} m/N")
    if joint.relaxation:
        words.append(f"relaxation {number_words(joint.relaxation, 's')}")
    return "; ".join(words)
