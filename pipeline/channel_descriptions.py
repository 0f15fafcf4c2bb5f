"""What the recorded channels are, in words, by the last part of their names or by the whole name."""

from __future__ import annotations

__all__ = ["CHANNEL_DESCRIPTIONS"]

CHANNEL_DESCRIPTIONS = {
    "position": "position in the world",
    "orientation": "unit quaternion from body to world axes, scalar first",
    "velocity": "velocity in world axes",
    "angular_velocity": "angular velocity in body axes",
    "modal_position": "coordinates of the mass-normalised mode shapes",
    "modal_velocity": "speeds of the mass-normalised mode shapes",
    "reaction_force": "force that holds or drives a frame; of a joint on its side b, world axes",
    "reaction_moment": "moment that holds or drives a frame; of a joint on its side b at its point, world axes",
    "angle": "angle of side b to side a about the axis of a joint",
    "angular_rate": "rate of that angle",
    "travel": "travel of side b to side a along the axis of a joint",
    "travel_rate": "rate of that travel",
    "tension": "tension of a rope",
    "segment_tension": "tension of each segment of a rope, from its first end on",
    "length": "length of a rope along its path; distance of the ends of a spring",
    "rest_length": "unstretched length of a rope",
    "drift": "length of a rope along its path less the stretched length that its tension belongs to",
    "force": "tension of a spring; negative if it pushes",
    "load": "torque or force along a joint on its side b",
    "momentum.linear": "linear momentum, world axes",
    "momentum.angular": "angular momentum about the world origin, world axes",
    "energy.kinetic": "kinetic energy",
    "energy.elastic": "elastic energy of bodies, springs and ropes",
    "energy.potential": "potential energy of gravity",
    "energy.external_work": "work of applied forces",
    "energy.drive_work": "work of driven frames and joints, winches and motors",
    "energy.dissipated": "energy lost to damping and friction",
    "energy.balance": "kinetic + elastic + potential - works + dissipated; constant in exact arithmetic",
    "monitor.violation": "largest violation of a rigid row of a joint, m or rad",
    "monitor.pivot": "smallest pivot of the joint equations, relative to the characteristic inverse mass",
}
