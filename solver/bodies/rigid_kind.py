"""Everything of the rigid kind: importing this module registers all its kernels."""

from heavylift.solver.bodies import rigid_joints, rigid_record, rigid_stage, rigid_step
from heavylift.solver.bodies.rigid import RigidBodies, pack_rigid_bodies

__all__ = ["RigidBodies", "pack_rigid_bodies", "rigid_joints", "rigid_record", "rigid_stage", "rigid_step"]
