"""Angles of a rope against where it should point: off and side lead of falls, in and out of the plane of a lug.

On body a the rope should point along an axis t, in a plane with the normal n, both of length 1 and perpendicular to
each other, ``u = t x n``. With r from the point on a to the point on b::

    off_lead = atan2(r . u, r . t)       side_lead = asin(r . n / |r|)       angle = acos(r . t / |r|)

The force F of the rope has the part ``F sin(side_lead)`` out of the plane.

It acts on nothing and costs nothing in a step: its markers are filled for records only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyDirection
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.numerics.vectors import cross, dot, subtract, vector
from heavylift.solver.interface import RECORD, Workspace, add_forces, record_forces
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.connections import MEASURES, Between, PackedForce
from heavylift.solver.scene.outputs import Outputs, channel, outputs

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["FleetAngle", "FleetAngleEntry", "FleetAngles", "pack"]

SQUARE = 1e-6
"""Cosine of axis and normal that counts as square."""


def _down() -> NDArray[np.float64]:
    return np.array([0.0, 0.0, -1.0])


def _across() -> NDArray[np.float64]:
    return np.array([0.0, 1.0, 0.0])


@outputs
class LeadOutputs(Outputs):
    """What a lead records."""

    off_lead: float = channel(
        "angle", "angle of the line to the axis in the plane, positive on the side of axis x normal"
    )
    side_lead: float = channel("angle", "angle of the line to the plane, positive on the side of its normal")
    lead_angle: float = channel("angle", "angle of the line between the points to the axis, 0 to 180 deg")


@MEASURES.describe("leads")
@dataclass(frozen=True, eq=False, kw_only=True)
class FleetAngle(Between, PackedForce):
    """Angles of the line from the point of side a to that of side b against an axis and a plane of side a."""

    CHANNELS: ClassVar = LeadOutputs.CHANNELS
    """What it records, in the order of its columns."""

    axis: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=_down)
    """Where the rope should point, down from a crown and up from a lug, in the coordinates of the geometry of side a;
    of the ground in the world; any length."""
    normal: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=_across)
    """Normal of the plane of the sheaves or of the eye plate, perpendicular to `axis`, same coordinates; any length."""

    @staticmethod
    def check(spec: Any) -> None:
        """The axis lies in the plane."""
        axis, normal = np.array(spec.axis), np.array(spec.normal)
        if abs(axis @ normal) > SQUARE * float(np.linalg.norm(axis) * np.linalg.norm(normal)):
            raise InputError(
                f"{normal.tolist()} is not perpendicular to axis = {axis.tolist()}",
                key="normal",
                expected="a direction perpendicular to 'axis'",
            )


class FleetAngleEntry(Record):
    """Markers of both points, of axis and normal, first record column."""

    a: int
    b: int
    axis: int
    normal: int
    column: int


lead_outputs = outputs_at(LeadOutputs)


class FleetAngles(Arrays):
    """All leads of a scene."""

    table: Records[FleetAngleEntry]


def pack(leads: Sequence[FleetAngle], context: PackingContext) -> None:
    """Make the kind."""
    rows = []
    for lead in leads:
        a = context.point(lead.body_a, lead.point_a, RECORD)
        b = context.point(lead.body_b, lead.point_b, RECORD)
        directions = (np.asarray(given, dtype=np.float64) for given in (lead.axis, lead.normal))
        units = [given / np.linalg.norm(given) for given in directions]
        axis, normal = (context.direction(lead.body_a, unit, RECORD, at=lead.point_a) for unit in units)
        column = context.column(lead)
        rows.append(filled(FleetAngleEntry, a=a, b=b, axis=axis, normal=normal, column=column))
    context.add_forces(FleetAngles(records(FleetAngleEntry, rows)))


@implement(add_forces, FleetAngles)
@kernel(internal=True)
def add_no_forces(kind: FleetAngles, time: float, work: Workspace) -> None:
    """It only watches."""


@implement(record_forces, FleetAngles)
@kernel(internal=True)
def record_leads(kind: FleetAngles, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """The three angles; zero where both points coincide."""
    for i in range(kind.table.shape[0]):
        entry = kind.table[i]
        r = subtract(work.markers[entry.b].point, work.markers[entry.a].point)
        t, n = vector(work.markers[entry.axis].point), vector(work.markers[entry.normal].point)
        along, aside, out = dot(r, t), dot(r, cross(t, n)), dot(r, n)
        lead = lead_outputs(row, entry.column)
        lead.off_lead = math.atan2(aside, along)
        lead.side_lead = math.atan2(out, math.hypot(along, aside))
        lead.lead_angle = math.atan2(math.hypot(aside, out), along)
