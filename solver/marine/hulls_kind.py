"""Everything of the kind of hulls: importing this module registers all its kernels."""

from heavylift.solver.marine import hull_joints, hull_record, hull_stage, hull_step
from heavylift.solver.marine.hulls import Hulls, pack_hulls

__all__ = [
    "Hulls",
    "hull_joints",
    "hull_record",
    "hull_stage",
    "hull_step",
    "pack_hulls",
]
