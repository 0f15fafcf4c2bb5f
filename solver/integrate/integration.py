"""What the accurate integrator carries between two calls, and the layout of its vectors.

A state vector holds all velocities, then the coordinates of all bodies, then the works of loads and drives. Meshes have
the velocities of their bases among the first, and those of all nodes behind their coordinates.
"""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, Records, Vector, records
from heavylift.solver.combination import padded
from heavylift.solver.drive import DRIVEN
from heavylift.solver.integrate.dop853 import STAGES
from heavylift.solver.interface import (
    Bodies,
    Coordinates,
    Joints,
    Systems,
    Workspace,
    begin_stage,
    record_rows,
)
from heavylift.solver.kinds import Members, implement
from heavylift.solver.rows.structure import ABSENT, PRESCRIBED, RowSystem

__all__ = ["Integration", "Progress", "carried", "make_integration", "stiffness_seen", "watch_stability"]

STABILITY = 6.1
"""Step times Lipschitz constant at the border of the stability region: Hairer, Norsett, Wanner, section IV.2."""

# rows of `vectors`: state at the start of a step, rates of the stages 1 ... 12, state of a stage, state at the end
# and its rate and second rate, two errors
STATE, STAGE, END, END_RATE, SECOND, FIFTH, THIRD, VECTORS = 0, 13, 14, 15, 16, 17, 18, 19

SLOTS, NEEDED = 6, 4  # nodes that are kept, and that are needed between corners before records
NODE_ROWS = 3  # state, rates, second rates
QUADRATURES = 3  # at the end of a vector


SHARED_SOFTENING, LOOP_SOFTENING, TREE_SOFTENING = 1e-8, 1e-10, 1e-14
"""Softness of the rows relative to their characteristic inverse mass: of loops in which redundant rows share, of loops
whose rows are independent, and of trees."""

LOOSEST_SHARED, LOOSEST_LOOP = 1e-6, 1e-4
"""Largest error of a step in scenes with loops, relative to the largest body: with more they leave their branch."""

OPENS = 10.0
"""Gap of a row that was left out, in largest errors of a step, from which on it is needed."""

MOST_STEPS = 10_000_000
"""Between two records: minutes of work, after which a run that creeps ends."""

LOOSEST_IN_TREES = 1e-3
"""The same where most joints are coordinates of trees. A four-bar leaves its branch with 1e-2."""


class Progress(Record):
    """How far the integrator is, and what it knows of the scene.

    Attributes
    ----------
    started, at_corner
        Whether the start state is taken over, and whether the next step begins behind a corner.
    newest, filled
        Slot of the newest node, and nodes since the last corner.
    times
        Of the nodes [s].
    rejected, rejections
        Whether the last attempt was rejected, and how many were so far.
    error_before
        Of the last accepted step, relative to the tolerance.
    recent_step
        Longest of the recent steps [s].
    stiff_steps, easy_steps, stiff_seen
        Steps that were limited by stability, steps since that were not, and whether the former was the rule.
    works
        Of forces, of drives, lost in dampers, at the last record [J].
    loaded, driven, based
        Whether there are forces on markers, whether something moves as prescribed, and whether joints hold bodies whose
        accelerations are not all among those of the workspace.
    length
        Of the largest body [m].
    solutions
        Of the system of the rows in an evaluation.
    chosen
        Whether rows that follow from others are left out.
    start_gap
        Of those, at the start [m, rad].
    largest_error
        Of a step, whatever the tolerance [m].
    steps, most_steps
        Since the last record, and how many there may be.
    left_open
        Largest opening of rows that follow from others and were left out, where no choice of rows closes it [m, rad].
    trees, velocities, spin
        Whether bodies are in trees, whose coordinates the state vector has; velocities that it begins with; largest
        spin of a body [rad/s].
    """

    started: bool
    at_corner: bool
    newest: int
    filled: int
    times: Annotated[NDArray[np.float64], (SLOTS,)]
    rejected: bool
    rejections: int
    error_before: float
    recent_step: float
    stiff_steps: int
    easy_steps: int
    stiff_seen: bool
    works: Vector
    loaded: bool
    driven: bool
    based: bool
    length: float
    solutions: int
    chosen: bool
    start_gap: float
    largest_error: float
    steps: int
    most_steps: int
    left_open: float
    trees: bool
    velocities: int
    spin: float


class Integration(Arrays):
    """What the integrator carries, and its scratch.

    Attributes
    ----------
    progress
        How far it is.
    nodes
        The last ends of steps: state, rates and second rates each; flat.
    vectors
        State, rates and errors of a step, one after the other; flat.
    coordinates
        What stands where in each of them.
    softening
        Softness of the rows of the joints relative to their characteristic inverse mass, by block and lane; flat.
    """

    carried_fields: ClassVar[tuple[str, ...]] = (
        "progress",
        "nodes",
        "softening",
    )

    progress: Progress
    nodes: Floats1
    vectors: Floats1
    coordinates: Records[Coordinates]
    softening: Floats1

    def take_start(self, bodies: Bodies, systems: Systems) -> None:
        """The carried state of the bodies becomes the first node: of trees, if they have them all."""
        trees = [system for system in systems if hasattr(system, "write_tree_state")]
        for forest in trees:
            forest.write_tree_state(bodies, self.nodes)
        for kind in () if trees else bodies:
            kind.write_state(self.nodes)

    @property
    def loops(self) -> bool:
        """Whether joints of bodies in no trees close loops, so that rows may follow from others."""
        return not self.progress.trees and self.progress.largest_error < math.inf

    def keep_rows(self, rows: NDArray[np.int64], kept: NDArray[np.bool_]) -> None:
        """Leave rows out that follow from others.

        Parameters
        ----------
        rows
            Places of all rows in the table of softness, shape (rows,).
        kept
            Which of them to keep, shape (rows,).
        """
        self.progress.chosen = not kept.all()
        self.progress.largest_error = LOOSEST_LOOP * self.progress.length
        self.softening[rows] = np.where(kept, LOOP_SOFTENING, ABSENT)


carried = Members(Systems, Integration)
"""What the integrator carries, among the systems of a scene."""


def _is_tree(system: RowSystem) -> bool:
    """Whether the joints form no loop, so that their rows are independent in every position."""
    parent: dict[int, int] = {}

    def root(body: int) -> int:
        while parent.setdefault(body, body) != body:
            body = parent[body]
        return body

    ground = -1
    for first in range(0, len(system.attachments), 2):
        ends = system.attachments[first], system.attachments[first + 1]
        a, b = (ground if end.holder == PRESCRIBED else int(end.dof) for end in ends)
        if root(a) == root(b):
            return False
        parent[root(a)] = root(b)
    return True


def make_integration(
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    trees: tuple[int, int] | None = None,
) -> Integration:
    """The last member of the systems of a scene that is integrated accurately.

    Parameters
    ----------
    bodies, joints, systems, work
        Of the packed scene.
    trees
        Velocities and coordinates of the trees that have all free bodies, if there are any.

    Raises
    ------
    InputError
        If there are bodies with modes, or rows with a law or compliance.
    """
    for kind in bodies:
        if not begin_stage.serves(type(kind)):
            raise InputError(
                f"bodies of the kind {type(kind).__name__}",
                source="simulation",
                key="integrator",
                expected="rigid bodies, frames and shells for 'accurate'; or 'dele2'",
            )
    for system in systems:
        if system.rows["compliance"].any():
            raise InputError(
                "ropes, stops, friction or compliant joints",
                source="simulation",
                key="integrator",
                expected="rigid joints and explicit forces for 'accurate'; or 'dele2'",
            )
    place, described = work.velocity.shape[0], []
    for kind in bodies:
        found, place = kind.place_coordinates(place)
        described.append(found)
    coordinates = records(Coordinates, [one for found in described for one in found])
    progress = Progress.one()
    progress.velocities = work.velocity.shape[0]
    progress.length = coordinates["reach"].max()
    progress.loaded = any((kind.markers["level"] > 0).any() for kind in bodies)
    driven = (coordinates["motion"] == DRIVEN).any()
    progress.driven = driven or any(hasattr(kind, "profiles") for kind in joints)
    progress.based = bool(systems) and any(len(getattr(kind, "bases", ())) for kind in bodies)
    softening, progress.solutions, progress.largest_error = TREE_SOFTENING, 1, math.inf
    if not all(_is_tree(system) for system in systems):
        softening, progress.solutions = SHARED_SOFTENING, 2
        progress.largest_error = (LOOSEST_SHARED if trees is None else LOOSEST_IN_TREES) * progress.length
    progress.most_steps = MOST_STEPS
    if trees is not None:
        progress.trees, progress.velocities, place = True, trees[0], sum(trees)
        coordinates = records(Coordinates, 0)
    size = padded(place + QUADRATURES)
    lanes = sum(len(system.attachments) // 2 * system.lanes for system in systems)
    return Integration(
        progress,
        np.zeros(SLOTS * NODE_ROWS * size),
        np.zeros(VECTORS * size),
        coordinates,
        np.full(lanes, softening),
    )


def stiffness_seen(integration: Integration) -> bool:
    """Whether stability, not accuracy, limited the steps for a while: another integrator would be faster."""
    return bool(integration.progress.stiff_seen)


@implement(record_rows, Integration)
@kernel(internal=True)
def record_works(
    integration: Integration,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    row: NDArray[np.float64],
) -> None:
    """Works that were integrated with the motion, into the totals."""
    work.sums.external_work += integration.progress.works[0]
    work.sums.drive_work += integration.progress.works[1]
    work.sums.dissipated += integration.progress.works[2]


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
    progress = integration.progress
    if _limited_by_stability(integration.vectors, h):
        progress.easy_steps = 0
        progress.stiff_steps += 1
        if progress.stiff_steps >= 15:
            progress.stiff_seen = True
    else:
        progress.easy_steps += 1
        if progress.easy_steps >= 6:
            progress.stiff_steps = 0
