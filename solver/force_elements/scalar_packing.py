"""Springs by a table, stops and dry friction on a distance, angle or travel become one kind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled, records
from heavylift.solver.force_elements.scalar_laws import (
    FRICTION,
    SPRING,
    STOP,
    ScalarLaw,
    ScalarLaws,
    ScalarLawState,
)
from heavylift.solver.forces.spring import first_turn, spring_fields, spring_side, spring_table
from heavylift.solver.interface import ROWS
from heavylift.solver.joints.coordinate import ANGLE, TRAVEL, joint_markers
from heavylift.solver.joints.registry import largest_opening
from heavylift.solver.scene.connections import Limits
from heavylift.solver.scene.sliding_joints import JointFriction, JointStop

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["STOP_RATE", "pack"]

STOP_RATE = 400.0
"""Frequency [rad/s] on the characteristic mass of the joint that a stop gets if no stiffness is given."""


def pack(things: Sequence[Any], context: PackingContext) -> None:
    """Make the kind and its rows.

    Raises
    ------
    InputError
        If a table falls, a spring has no direction, or a stop or friction is none.
    """
    rows: list[ScalarLaw] = []
    curves: list[NDArray[np.float64]] = [np.zeros((0, 2))]
    expected: list[float] = []
    for thing in things:
        if isinstance(thing, JointStop):
            rows.append(_pack_stop(thing, context))
            # turns of an angle count from zero, where bodies are drawn, or from the stop that is nearest to it
            expected.append(min(max(0.0, thing.limits.lower), thing.limits.upper))
        elif isinstance(thing, JointFriction):
            rows.append(_pack_friction(thing, context))
            expected.append(0.0)
        else:
            curve = spring_table(thing, context)
            fields = spring_fields(thing, context, sum(map(len, curves)), len(curve), as_row=True)
            coordinate, joint = spring_side(thing, context)
            drift = largest_opening(joint, context.scales, turns=coordinate == ANGLE)
            rows.append(
                filled(
                    ScalarLaw, **fields, law=SPRING, lower=0.0, upper=0.0, largest=0.0, largest_drift=drift
                )
            )
            curves.append(curve)
            expected.append(first_turn(thing))
    state = records(ScalarLawState, len(rows))
    state["fresh"], state["value"] = True, expected
    context.add_rows(ScalarLaws(records(ScalarLaw, rows), np.vstack(curves), state))


def _pack_stop(stop: JointStop, context: PackingContext) -> ScalarLaw:
    """Its entry."""
    joint, limits = stop.joint, stop.limits
    entry = _joint_row(stop, context)
    _check_limits(joint, stop.key, limits)
    return filled(
        ScalarLaw,
        **entry,
        stiffness=limits.stiffness or STOP_RATE**2 / context.blocks[-1].scale,
        damping=limits.damping,
        law=STOP,
        lower=limits.lower,
        upper=limits.upper,
        largest=0.0,
        largest_drift=largest_opening(joint, context.scales, turns=stop.coordinate == "angle"),
    )


def _pack_friction(friction: JointFriction, context: PackingContext) -> ScalarLaw:
    """Its entry."""
    if not 0.0 < friction.largest < np.inf:
        raise InputError(
            f"{friction.largest}", source=friction.joint.name, key=friction.key, expected="0 or more"
        )
    return filled(
        ScalarLaw,
        **_joint_row(friction, context),
        stiffness=0.0,
        damping=0.0,
        law=FRICTION,
        lower=0.0,
        upper=0.0,
        largest=friction.largest,
        largest_drift=np.inf,
    )


def _joint_row(thing: JointStop | JointFriction, context: PackingContext) -> dict[str, Any]:
    """Fields of a row on the angle or travel of a joint: it records nothing and has no table."""
    joint, turns = thing.joint, thing.coordinate == "angle"
    coordinate = ANGLE if turns else TRAVEL
    a, b, c = joint_markers(context.book, joint, coordinate, ROWS)
    block = context.block(joint.name, (joint.body_a, joint.body_b), turns=turns)
    return {
        "coordinate": coordinate,
        "a": a,
        "b": b,
        "c": c,
        "column": -1,
        "block": block,
        "rest": 0.0,
        "first": 0,
        "count": 0,
    }


def _check_limits(joint: Any, place: str, limits: Limits) -> None:
    """Refuse stops of a joint that are none."""
    if not limits.lower < limits.upper:
        raise InputError(
            f"lower {limits.lower}, upper {limits.upper}",
            source=joint.name,
            key=place,
            expected="lower below upper",
        )
    for key in ("stiffness", "damping"):
        value = getattr(limits, key)
        if not 0.0 <= value < np.inf:
            raise InputError(f"{value}", source=joint.name, key=f"{place}.{key}", expected="0 or more")
