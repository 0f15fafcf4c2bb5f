"""Records of joints of trees: reactions, angles and travels are known without rows, and nothing can open."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import add_scaled, cross, scaled
from heavylift.solver.integrate.trees.forest import BALL, FLOATING, SLIDER, Forest
from heavylift.solver.integrate.trees.sweeps import ZERO, joint_wrench, put
from heavylift.solver.interface import Bodies, Joints, Workspace, record_joints, record_rows
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.channels import MonitorOutputs
from heavylift.solver.scene.connections import AngleOutputs, ReactionOutputs, TravelOutputs

__all__ = ["note_joints"]

reaction_outputs, angle_outputs = outputs_at(ReactionOutputs), outputs_at(AngleOutputs)
travel_outputs, monitor_outputs = outputs_at(TravelOutputs), outputs_at(MonitorOutputs)


@kernel(internal=True)
def note_joints(forest: Forest, values: Floats1, at: int) -> None:
    """Keep what the joints record of the state vector at `at`, the last one that was evaluated."""
    for i in range(forest.bodies.shape[0]):
        one, out = forest.bodies[i], forest.recorded[i]
        joint = one.joint
        if joint == FLOATING:
            continue
        n, f = joint_wrench(one)
        if joint >= BALL:
            n = ZERO
        place, speed = at + forest.velocities + one.place, at + one.speed
        if one.sign < 0.0:
            if joint == SLIDER:
                n = add_scaled(n, values[place], cross(one.along, f))
            n, f = scaled(-1.0, n), scaled(-1.0, f)
        put(out.force, f)
        put(out.moment, n)
        if joint <= SLIDER:
            out.coordinate = one.sign * (values[place] - out.offset)
            out.rate = one.sign * values[speed]


@implement(record_rows, Forest)
@kernel(internal=True)
def record_forest(
    forest: Forest, bodies: Bodies, joints: Joints, work: Workspace, time: float, row: Floats1
) -> None:
    """Joints of trees into their columns, and what records beside joints; with rows these do it."""
    if forest.recorded.shape[0] == 0:
        return
    record_joints(joints, time, work, forest.rows, row)
    for i in range(forest.recorded.shape[0]):
        one = forest.recorded[i]
        if one.reaction >= 0:
            reaction = reaction_outputs(row, one.reaction)
            put(reaction.reaction_force, one.force)
            put(reaction.reaction_moment, one.moment)
        if one.turn >= 0:
            turn = angle_outputs(row, one.turn)
            turn.angle, turn.angular_rate = one.coordinate, one.rate
        if one.slide >= 0:
            slide = travel_outputs(row, one.slide)
            slide.travel, slide.travel_rate = one.coordinate, one.rate
    if forest.violation >= 0:
        out = monitor_outputs(row, forest.violation)
        out.violation, out.pivot, out.carried_drift = 0.0, 1.0, work.sums.drift
