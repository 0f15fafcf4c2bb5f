"""What joints record: the reaction on b at its anchor, and the angle and travel of the two sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel, view
from heavylift.numerics.records import Record
from heavylift.numerics.vectors import cross
from heavylift.solver.interface import Workspace
from heavylift.solver.joints.packing import AngleMarkers, TravelMarkers
from heavylift.solver.joints.row_writing import (
    Vector,
    hinge_angle,
    hinge_rate,
    near_angle,
    travel,
    travel_rate,
    vector,
)
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import AngleOutputs, ReactionOutputs, TravelOutputs

__all__ = [
    "AngleState",
    "add_force",
    "add_moment",
    "add_pull",
    "add_torque",
    "clear_reaction",
    "reaction_outputs",
    "reactions",
    "record_angle",
    "record_travel",
    "write_reaction",
]

reaction_outputs = outputs_at(ReactionOutputs)


class AngleState(Record):
    """What counts whole turns: angle [rad], rate [rad/s] and time [s] of the last record."""

    angle: float
    rate: float
    time: float


@view
def reactions(system: RowArrays, block: int) -> NDArray[np.float64]:
    """Reactions of the rows of a block at the end of the last step [N] or [N m], a view."""
    return system.rows[block].reaction


@kernel(internal=True)
def write_reaction(system: RowArrays, block: int, out: ReactionOutputs) -> None:
    """Force on b of three point rows; the moment, after it, is set to zero.

    Notes
    -----
    A kind that adds to it does so in a second loop: where the compiler sees the zero, a sum of zeros may get either
    sign.
    """
    force = reactions(system, block)
    for k in range(3):
        out.reaction_force[k] = force[k]
        out.reaction_moment[k] = 0.0


@kernel(internal=True)
def clear_reaction(out: ReactionOutputs) -> None:
    """Set force and moment to zero."""
    for k in range(3):
        out.reaction_force[k] = 0.0
        out.reaction_moment[k] = 0.0


@kernel(internal=True)
def add_force(
    system: RowArrays,
    block: int,
    index: int,
    work: Workspace,
    axis: int,
    out: ReactionOutputs,
) -> None:
    """Force on b, at its point, of a row ``e . (p_b - p_a)`` with a direction marker e."""
    force, e = reactions(system, block)[index], vector(work, axis)
    for k in range(3):
        out.reaction_force[k] += force * e[k]


@kernel(internal=True)
def add_moment(
    system: RowArrays,
    block: int,
    index: int,
    work: Workspace,
    marker: int,
    partner: int,
    out: ReactionOutputs,
) -> None:
    """Moment ``e x c`` on b of a row ``c . e``, with `marker` e on b and c on a, times its reaction."""
    e, c = vector(work, marker), vector(work, partner)
    moment = reactions(system, block)[index]
    turn = cross(e, c)
    for k in range(3):
        out.reaction_moment[k] += moment * turn[k]


@kernel(internal=True)
def add_pull(
    system: RowArrays,
    block: int,
    index: int,
    factor: float,
    arm: Vector,
    pull: Vector,
    out: ReactionOutputs,
) -> None:
    """Moment ``factor arm x pull`` on b of a row that pulls at a vector `arm` on b, times its reaction."""
    moment = factor * reactions(system, block)[index]
    turn = cross(arm, pull)
    for k in range(3):
        out.reaction_moment[k] += moment * turn[k]


@kernel(internal=True)
def add_torque(
    system: RowArrays,
    block: int,
    index: int,
    work: Workspace,
    axis: int,
    out: ReactionOutputs,
) -> None:
    """Moment on b of the row of an angle about a direction marker."""
    moment, e = reactions(system, block)[index], vector(work, axis)
    for k in range(3):
        out.reaction_moment[k] += moment * e[k]


@kernel(internal=True)
def record_angle(
    work: Workspace,
    markers: AngleMarkers,
    state: AngleState,
    time: float,
    out: AngleOutputs,
) -> None:
    """Angle, whole turns included, and its rate.

    Notes
    -----
    Of the angles that fit, it is the one nearest to the last recorded one plus the mean of the two rates
    times the time between, so it counts right while that is less than half a turn wrong.
    """
    speed = hinge_rate(work, markers.x_a, markers.x_b, markers.y_b)
    expected = state.angle + 0.5 * (state.rate + speed) * (time - state.time)
    angle = near_angle(hinge_angle(work, markers.x_a, markers.x_b, markers.y_b), expected)
    state.angle, state.rate, state.time = angle, speed, time
    out.angle, out.angular_rate = angle, speed


@kernel(internal=True)
def record_travel(work: Workspace, markers: TravelMarkers, out: TravelOutputs) -> None:
    """Travel and its rate."""
    out.travel = travel(work, markers.point_a, markers.point_b, markers.axis)
    out.travel_rate = travel_rate(work, markers.point_a, markers.point_b, markers.axis)
