"""Everything of the floating-frame kind: importing this module registers all its kernels."""

from heavylift.solver.bodies import (
    floating_frame_advance,
    floating_frame_joints,
    floating_frame_record,
    floating_frame_step,
    floating_frame_thesis,
)
from heavylift.solver.bodies.floating_frame import FloatingFrameBodies
from heavylift.solver.bodies.floating_frame import pack_floating_frames as pack

__all__ = [
    "FloatingFrameBodies",
    "floating_frame_advance",
    "floating_frame_joints",
    "floating_frame_record",
    "floating_frame_step",
    "floating_frame_thesis",
    "pack",
]
