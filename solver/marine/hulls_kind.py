"""Everything of the kind of hulls: importing this module registers all its kernels."""

from heavylift.solver.marine import hull_joints, hull_record, hull_stage, hull_step
from heavylift.solver.marine.hull_packing import pack_hulls
from heavylift.solver.marine.hulls import Hulls

__all__ = [
    "Hulls",
    "hull_joints",
    "hull_record",
    "hull_stage",
    "hull_step",
    "pack_hulls",
]
