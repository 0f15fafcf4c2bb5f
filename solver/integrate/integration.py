"""What the accurate integrator carries between two calls, and the layout of its vectors.

A state vector holds all velocities, then positions and quaternions, then the works of loads and drives. Meshes have the
velocities of their bases among the first, and coordinates and velocities of all nodes behind the quaternions.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.solver.combination import padded
from heavylift.solver.integrate.accurate_rows import is_tree
from heavylift.solver.integrate.dop853 import STAGES
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Systems,
    Workspace,
    begin_stage,
    record_rows,
)
from heavylift.solver.kinds import Members, implement

__all__ = ["Integration", "carried", "make_integration", "stiffness_seen", "watch_stability"]

STABILITY = 6.1
"""Step times Lipschitz constant at the border of the stability region: Hairer, Norsett, Wanner, section IV.2."""

# rows of `vectors`: state at the start of a step, rates of the stages 1 ... 12, state of a stage, state at the end
# and its rate and second rate, two errors
STATE, STAGE, END, END_RATE, SECOND, FIFTH, THIRD, VECTORS = 0, 13, 14, 15, 16, 17, 18, 19

# head of `state`: ...
(
    STARTED,  # 1 once the start state is taken over
    AT_CORNER,  # 1 if the next step begins behind a corner
    NODE,  # slot of the newest node
    NODES_FILLED,  # nodes since the last corner
    REJECTED,  # 1 if the last attempt was
    STIFF,  # steps in which the step was limited by stability
    EASY,  # steps since in which it was not
    STIFF_SEEN,  # 1 once that was the rule
    LOADED,  # 1 if there are forces on markers
    DRIVEN,  # 1 if something moves as prescribed
    LENGTH,  # of the largest body [m]
    SOLUTIONS,  # of the system of the rows in an evaluation
    SOFTENING,  # of the rows relative to their characteristic inverse mass
    LOOSEST,  # largest error of a step, whatever the tolerance [m]
    REJECTIONS,  # so far
    MEMORY,  # longest of the recent steps [s]
    ERROR_BEFORE,  # of the last accepted step, relative to the tolerance
    BASED,  # 1 if joints hold bodies whose accelerations are not all among those of the workspace
    WORKS,  # of forces, of drives, lost in dampers, at the last record [J]
) = range(19)
TIMES = 21  # of the nodes [s]
HEAD = 32
SLOTS, NEEDED = 6, 4  # nodes that are kept, and that are needed between corners before records
NODE_ROWS = 3  # state, rates, second rates
QUADRATURES = 3  # at the end of a vector


LOOP_SOFTENING, TREE_SOFTENING = 1e-8, 1e-14
"""Softness of the rows relative to their characteristic inverse mass: with loops, and without."""

LOOSEST_LOOP = 1e-6
"""Largest error of a step in scenes with loops, relative to the largest body: with more they leave their branch."""


class Integration(Arrays):
    """What the integrator carries, and its scratch.

    Attributes
    ----------
    state
        Head, then the last four ends of steps: state, rates and second rates each; flat.
    vectors
        State, rates and errors of a step, one after the other; flat.
    """

    state: Floats1
    vectors: Floats1


carried = Members(Systems, Integration)
"""What the integrator carries, among the systems of a scene."""


def make_integration(bodies: Bodies, joints: Joints, systems: Systems, work: Workspace) -> Integration:
    """The last member of the systems of a scene that is integrated accurately.

    Raises
    ------
    InputError
        If there are bodies with modes, or rows with a law or compliance.
    """
    from heavylift.solver.rows import COMPLIANCE, ROW_COLUMNS

    for kind in bodies:
        if not begin_stage.serves(type(kind)):
            raise InputError(
                f"bodies of the kind {type(kind).__name__}",
                source="simulation",
                key="integrator",
                expected="rigid bodies, frames and shells for 'accurate'; or 'dele2'",
            )
    for system in systems:
        table = system.rows.reshape(-1, ROW_COLUMNS, system.lanes)
        if table[:, COMPLIANCE].any():
            raise InputError(
                "ropes, stops, friction or compliant joints",
                source="simulation",
                key="integrator",
                expected="rigid joints and explicit forces for 'accurate'; or 'dele2'",
            )
    from heavylift.solver.bodies.rigid import MOTION, REACH, RigidBodies
    from heavylift.solver.drive import DRIVEN as DRIVEN_MOTION

    rigid = [kind for kind in bodies if isinstance(kind, RigidBodies)]
    meshes = [kind for kind in bodies if not isinstance(kind, RigidBodies)]
    place = padded(work.velocity.shape[0] + 7 * sum(len(kind.table) for kind in rigid))
    for kind in meshes:
        kind.table["state_place"] = place
        place += 2 * kind.nodal.shape[1]
    size = padded(place + QUADRATURES)
    state = np.zeros(HEAD + SLOTS * NODE_ROWS * size)
    state[LENGTH] = max(
        [kind.frame[:, REACH].max() for kind in rigid] + [kind.body["size"].max() for kind in meshes]
    )
    loaded = [(kind.markers[:, 4] > 0).any() for kind in rigid]
    state[LOADED] = any(loaded + [(kind.markers["level"] > 0).any() for kind in meshes])
    driven = any((kind.table[:, MOTION] == DRIVEN_MOTION).any() for kind in rigid)
    state[DRIVEN] = driven or any(hasattr(kind, "profiles") for kind in joints)
    state[BASED] = bool(systems) and any(len(kind.bases) for kind in meshes)
    if all(is_tree(system) for system in systems):
        state[SOLUTIONS], state[SOFTENING], state[LOOSEST] = 1.0, TREE_SOFTENING, math.inf
    else:
        state[SOLUTIONS], state[SOFTENING], state[LOOSEST] = 2.0, LOOP_SOFTENING, LOOSEST_LOOP * state[LENGTH]
    return Integration(state, np.zeros(VECTORS * size))


def stiffness_seen(integration: Integration) -> bool:
    """Whether stability, not accuracy, limited the steps for a while: another integrator would be faster."""
    return bool(integration.state[STIFF_SEEN])


@implement(record_rows, Integration)
@kernel(internal=True)
def record_works(
    integration: Integration, joints: Joints, work: Workspace, time: float, row: NDArray[np.float64]
) -> None:
    """Works that were integrated with the motion, into the totals."""
    work.sums.external_work += integration.state[WORKS]
    work.sums.drive_work += integration.state[WORKS + 1]
    work.sums.dissipated += integration.state[WORKS + 2]


@kernel(internal=True, reassociate=True)
def _limited_by_stability(values: NDArray[np.float64], h: float) -> bool:
    """Two states at the end of the step tell the Lipschitz constant: that of the last stage and the result."""
    size = values.shape[0] // VECTORS
    rates = states = 0.0
    for i in range(size - QUADRATURES):
        rates += (values[END_RATE * size + i] - values[STAGES * size + i]) ** 2
        states += (values[END * size + i] - values[STAGE * size + i]) ** 2
    return h * h * rates > STABILITY * STABILITY * states


@kernel(internal=True)
def watch_stability(integration: Integration, h: float) -> None:
    """Fifteen steps at the border of stability, never six away from it, are a stiff scene."""
    state = integration.state
    if _limited_by_stability(integration.vectors, h):
        state[EASY] = 0.0
        state[STIFF] += 1.0
        if state[STIFF] >= 15.0:
            state[STIFF_SEEN] = 1.0
    else:
        state[EASY] += 1.0
        if state[EASY] >= 6.0:
            state[STIFF] = 0.0
