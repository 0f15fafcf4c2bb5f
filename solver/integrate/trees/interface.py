"""What the accurate integrator asks of trees; systems without trees answer nothing."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.solver.integrate.integration import Integration
from heavylift.solver.interface import Bodies, Forces, Joints, Systems, Workspace
from heavylift.solver.kinds import optional

__all__ = [
    "close_trees",
    "evaluate_trees",
    "find_tree_spin",
    "measure_tree_error",
    "store_trees",
    "write_second_tree_rates",
    "write_tree_velocities",
]


@optional("accurate")
def evaluate_trees(
    kinds: Systems,
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    integration: Integration,
    at: int,
    out: int,
    time: float,
    with_reactions: bool,
    factored: bool,
) -> None:
    """Trees: rates of the state vector at `at` into that at `out`, or reactions, which are kept; without loops both.

    The factor of this position may be there, from closing the loops in it.
    """


@optional("accurate")
def write_second_tree_rates(kinds: Systems, values: Floats1, at: int, rate: int, second: int) -> None:
    """Trees: second rates of all coordinates, from state, rates and accelerations."""


@optional("accurate")
def write_tree_velocities(kinds: Systems, values: Floats1, at: int, rate: int) -> None:
    """Trees: velocities from the rates of the coordinates; quaternions get unit length."""


@optional("accurate")
def close_trees(
    kinds: Systems, bodies: Bodies, integration: Integration, at: int, work: Workspace, time: float
) -> None:
    """Trees: loops of the state vector at `at` are closed, then velocities; quaternions get unit length."""


@optional("accurate")
def find_tree_spin(kinds: Systems, integration: Integration, at: int) -> None:
    """Trees: raise `progress.spin` to the largest spin that a joint gives a body, or of what floats [rad/s]."""


@optional("accurate")
def measure_tree_error(kinds: Systems, values: Floats1, fifth: int, third: int, work: Workspace) -> None:
    """Trees: raise `work.control.error` and `pose_error` as `measure_error` does, in the last pose evaluated."""


@optional("accurate")
def store_trees(
    kinds: Systems, bodies: Bodies, time: float, values: Floats1, at: int, work: Workspace
) -> None:
    """Trees: carried state of the bodies from the state vector at `at`, the last one that was evaluated."""
