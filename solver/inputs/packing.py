"""Inputs of a scene become a kind, and get the tables that they write."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.records import filled, records
from heavylift.solver.inputs.kind import ACTS, InputEntry, Inputs, InputState
from heavylift.solver.interface import FORCES
from heavylift.solver.joints.coordinate import joint_coordinate, joint_markers

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["pack", "with_tables"]


def pack(inputs: Sequence[Any], context: PackingContext) -> None:
    """Make the kind; what drives tables gets these when they are packed, see `with_tables`.

    Raises
    ------
    InputError
        If the joint of a load has no angle or travel.
    """
    table = [filled(InputEntry, column=context.column(one), **_place(one, context)) for one in inputs]
    state = records(InputState, len(inputs))
    state["value"] = [one.start for one in inputs]
    state["until"] = math.inf
    tables = dict.fromkeys(Inputs.carried_fields[1:], np.zeros(0))
    context.add_forces(Inputs(table=records(InputEntry, table), state=state, **tables))


def _place(one: Any, context: PackingContext) -> dict[str, Any]:
    """Where an input acts: its markers."""
    found: dict[str, Any] = {
        "acts": ACTS.index(one.ACTS),
        "axes": -1,
        "in_body": False,
        "direction": np.zeros(3),
    }
    found |= dict.fromkeys(("coordinate", "a", "b", "c"), 0)
    if one.ACTS == "load":
        joint = context.joint(one.joint)
        coordinate = joint_coordinate(joint, one)
        a, b, c = joint_markers(context.book, joint, coordinate, FORCES)
        return {**found, "coordinate": coordinate, "a": a, "b": b, "c": c}
    if not one.ACTS:
        return found
    direction = np.asarray(one.direction, dtype=np.float64)
    found |= {"direction": direction / np.linalg.norm(direction), "in_body": one.frame == "body"}
    if one.ACTS == "force":
        found["a"] = context.point(one.body, one.point)
    if one.ACTS == "moment" or one.frame == "body":
        axes = [context.direction(one.body, axis, at=one.point) for axis in np.eye(3)]
        found["axes"] = axes[0]
    return found


def with_tables(kind: Inputs, **tables: Any) -> Inputs:
    """The kind with what it is to carry.

    Parameters
    ----------
    kind
        All inputs of a scene.
    **tables
        Arrays of numbers or records, by their field in the kind.
    """

    def numbers(array: Any) -> NDArray[np.float64]:
        found: NDArray[np.float64] = array if array.dtype.names is None else array.view(np.float64)
        return found

    return kind._replace(**{name: numbers(array) for name, array in tables.items()})
