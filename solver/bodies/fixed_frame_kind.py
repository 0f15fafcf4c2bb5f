"""Everything of the fixed-frame kind: importing this module registers all its kernels."""

from heavylift.solver.bodies import fixed_frame_joints
from heavylift.solver.bodies.fixed_frame import FixedFrameBodies, pack_fixed_frames

__all__ = ["FixedFrameBodies", "fixed_frame_joints", "pack_fixed_frames"]
