"""Mooring lines as forces on two bodies: catenaries in the vertical plane of their ends, with stiffness and energy.

"Integrated simulation ... (2018)", section 2.9.5.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.quantity import Least, Positive, Quantity
from heavylift.numerics.records import Records, Vector
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    begin_record,
    record_forces,
    watch_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.connections import GROUND, Between
from heavylift.solver.scene.drawn import Element, Hanging, Text
from heavylift.solver.scene.moorings import MOORINGS, LineSection, SeabedSlope
from heavylift.solver.scene.outputs import Outputs, channel, largest, outputs, smallest
from heavylift.solver.water.lines.bottom import BottomState, read_ends_over_bottom, solve_over_bottom
from heavylift.solver.water.lines.catenary import (
    FAILED,
    LineData,
    LineEnds,
    SectionData,
    read_ends,
    solve_line,
)

__all__ = [
    "LINE_OVERSTRETCHED",
    "MooringData",
    "MooringLine",
    "MooringLines",
    "MooringOutputs",
    "MooringScratch",
    "MooringState",
]


@outputs
class MooringOutputs(Outputs):
    """What a mooring line records."""

    tension: float = channel("force", "tension of the line at its fairlead")
    anchor_tension: float = channel("force", "tension of the line at its anchor")
    horizontal_tension: float = channel("force", "horizontal part of the tension at the fairlead")
    seabed_length: float = channel("length", "unstretched length of the line that lies on the bottom")
    tension_max: float = largest("force", "tension", seen="in the middles of all steps")
    tension_min: float = smallest("force", "tension", seen="in the middles of all steps")


@MOORINGS.describe("lines")
@dataclass(frozen=True, eq=False, kw_only=True)
class MooringLine(Between):
    """A line between an anchor and a fairlead, in equilibrium at every instant.

    A bottom holds the line from the anchor up to the first buoy or floating section; a bight beyond that would hang
    through it. If the anchor is above the bottom, on the ground or on a body, both ends hang and what lies between them
    is held; all of such a line sinks.
    """

    CHANNELS: ClassVar = MooringOutputs.CHANNELS
    SENTENCES: ClassVar = {
        "between": 'Bodies, or ``"ground"``, of its anchor and of its fairlead.',
        "points": "Anchor and fairlead in the coordinates of the geometries; of the ground in the world [m].",
    }

    sections: Annotated[tuple[LineSection, ...], Least(1)]
    """From the anchor to the fairlead."""
    clumps: Annotated[tuple[float, ...], Quantity("force")] = ()
    """Weight [N] of what hangs at each joint of two sections, from the anchor; negative for a buoy."""
    fairlead_tension: Annotated[float | None, Positive("force")] = None
    """Tension at the fairlead at the start [N], from which the length of the one section without it follows."""
    on_seabed: bool = False
    """The anchor lies on the bottom of the sea, at the depth of [sea]."""
    seabed: Annotated[float | None, Quantity("length")] = None
    """In place of `on_seabed`: height of the bottom in the world [m], on which or above which the anchor is."""
    seabed_slope: SeabedSlope | None = None
    """Slope of the bottom; level without it."""
    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.0
    """Coefficient of the bottom along the line."""
    strain_limit: Annotated[float, Quantity("number", minimum=0.0)] = 0.1
    """Mean strain at which a simulation stops."""

    def drawn(self) -> Iterable[Element]:
        """Where it hangs."""
        yield Hanging(
            name=self.name, role="mooring", ends=self.sides, line=self, tension=f"{self.name}.tension"
        )
        yield Text(name=self.name, role="mooring", at=self.sides[1], text=self.name)

    @staticmethod
    def check_sides(between: tuple[str, str]) -> None:
        """Two bodies, or the ground."""
        if between[0] == between[1] != GROUND:
            raise InputError(
                f"both ends are on {between[0]!r}", expected="two bodies, or a body and the ground"
            )

    @staticmethod
    def check(spec: Any) -> None:
        """Lengths or a tension, a weight a joint, one bottom."""
        open_ends = [i for i, section in enumerate(spec.sections) if section.length is None]
        if spec.fairlead_tension is None and open_ends:
            raise InputError(
                "is missing",
                key=f"sections.{open_ends[0]}.length",
                expected="a length [m], or 'fairlead_tension'",
            )
        if spec.fairlead_tension is not None and len(open_ends) != 1:
            raise InputError(
                f"'fairlead_tension' and {len(open_ends)} sections without 'length'",
                key="fairlead_tension",
                expected="one section whose length follows from it",
            )
        if spec.clumps and len(spec.clumps) != len(spec.sections) - 1:
            raise InputError(
                f"{len(spec.clumps)} clumps at {len(spec.sections) - 1} joints of sections",
                key="clumps",
                expected="one weight [N] a joint, 0 for none",
            )
        if spec.on_seabed and spec.seabed is not None:
            raise InputError("both 'on_seabed' and 'seabed'", key="seabed", expected="one of them")
        for key in ("friction", "seabed_slope"):
            if getattr(spec, key) and not spec.on_seabed and spec.seabed is None:
                raise InputError(f"{key!r} without a bottom", key=key, expected="'on_seabed' or 'seabed'")


LINE_OVERSTRETCHED = int(Outcome.LINE_OVERSTRETCHED)
"""Outcome of a step in which a line is stretched beyond its limit, or has no equilibrium."""

LEAST_SPAN = 1e-7
"""Of the length: horizontal distance of the ends below which a line hangs straight down."""


class MooringData(LineData):
    """A mooring line.

    Attributes
    ----------
    anchor, fairlead
        Markers.
    column
        First record column.
    limit
        Distance of the ends that is too much for it [m].
    over_bottom
        Whether the bottom below it is more than a level one with the anchor on it.
    anchored
        Whether the anchor is held on the bottom.
    bottom, rise_x, rise_y
        The bottom, as a `heavylift.solver.water.lines.placed_line.LineBottom`.
    """

    anchor: int
    fairlead: int
    column: int
    limit: float
    over_bottom: bool
    anchored: bool
    bottom: float
    rise_x: float
    rise_y: float


class MooringState(BottomState):
    """Last solution of a mooring line, and what else it carries.

    Attributes
    ----------
    start_energy
        Energy at the start [J].
    started
        Whether that is known.
    extremes
        Of the tension at the fairlead.
    extra
        Force [N] that acts on the fairlead beside that of the catenary, world axes: zero, unless a model of dynamic
        lines writes it.
    """

    start_energy: float
    started: bool
    extremes: Extremes
    extra: Vector


class MooringScratch(LineEnds):
    """Lower end of a mooring line for a record, the solution from which steps continue, and the last tension."""

    solution: BottomState
    tension: float


mooring_outputs = outputs_at(MooringOutputs)


class MooringLines(Arrays):
    """All mooring lines of a scene.

    Attributes
    ----------
    lines, sections
        As in `heavylift.solver.water.lines.catenary.solve_line`.
    state
        Carried, of each line.
    tangents
        Stiffness of the force on the fairlead against its displacement relative to the anchor [N/m], world axes,
        row by row, symmetric and positive semidefinite, at the last evaluation; shape (n, 9).
    scratch
        Of each line, for a record.
    nodes
        Without rows: where sections join is of no use in a run.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    lines: Records[MooringData]
    sections: Records[SectionData]
    state: Records[MooringState]
    tangents: Floats2
    scratch: Records[MooringScratch]
    nodes: Floats2


@kernel(internal=True)
def _hang(kind: MooringLines, i: int, work: Workspace) -> tuple[float, float, float]:
    """Solve a line for its ends; direction of its plane, and its span [m], not less than a hanging one has."""
    line, state = kind.lines[i], kind.state[i]
    a, b = line.anchor, line.fairlead
    x = work.markers[b].point[0] - work.markers[a].point[0]
    y = work.markers[b].point[1] - work.markers[a].point[1]
    z = work.markers[b].point[2] - work.markers[a].point[2]
    span = math.sqrt(x * x + y * y)
    if line.over_bottom:
        slope = (line.rise_x * x + line.rise_y * y) / span if span > LEAST_SPAN * line.length else 0.0
        foot = line.bottom + line.rise_x * work.markers[a].point[0] + line.rise_y * work.markers[a].point[1]
        clearance = work.markers[a].point[2] - foot
        solve_over_bottom(kind.sections, line, span, z, slope, clearance, line.anchored, state)
    else:
        solve_line(kind.sections, line, span, z, state)
    bad = not (span * span + z * z < line.limit * line.limit) or state.branch == FAILED
    if bad and work.status.outcome == 0:
        work.status.outcome, work.status.body = LINE_OVERSTRETCHED, i
    span = max(span, LEAST_SPAN * line.length)
    return x / span, y / span, span


@kernel(inline=True, internal=True)
def _fairlead_tension(state: MooringState, ex: float, ey: float) -> float:
    """Amount of the force at the fairlead [N] of a line in the plane of a horizontal direction."""
    x, y = state.horizontal * ex - state.extra[0], state.horizontal * ey - state.extra[1]
    z = state.vertical - state.extra[2]
    return math.sqrt(x * x + y * y + z * z)


@implement(add_forces, MooringLines)
@kernel(internal=True)
def add_mooring_lines(kind: MooringLines, time: float, work: Workspace) -> None:
    """Forces on both ends, and the stiffness of each line.

    Notes
    -----
    With the horizontal direction e from anchor to fairlead, t across it and z up, the stiffness is

        kxx e e^T + (kxz + kzx)/2 (e z^T + z e^T) + kzz z z^T + (H/x) t t^T.

    Only friction of the seabed makes the 2x2 part unsymmetric, and could make the symmetric part indefinite; then
    the coupling is reduced until that is singular.
    """
    for i in range(kind.lines.shape[0]):
        line, state = kind.lines[i], kind.state[i]
        a, b = line.anchor, line.fairlead
        ex, ey, span = _hang(kind, i, work)
        H, V = state.horizontal, state.vertical
        kind.scratch[i].tension = _fairlead_tension(state, ex, ey)
        work.markers[b].force[0] -= H * ex
        work.markers[b].force[1] -= H * ey
        work.markers[b].force[2] -= V
        for k in range(3):
            work.markers[b].force[k] += state.extra[k]
        if line.over_bottom and not line.anchored:
            work.markers[a].force[0] += state.lower_horizontal * ex
            work.markers[a].force[1] += state.lower_horizontal * ey
            work.markers[a].force[2] += state.lower_vertical
        elif line.tail == line.count:  # the lower end of a line on the seabed is an anchor in the ground
            work.markers[a].force[0] += H * ex
            work.markers[a].force[1] += H * ey
            work.markers[a].force[2] += V - line.weight
        kxx, kzz = state.stiffness[0, 0], state.stiffness[1, 1]
        kxz = 0.5 * (state.stiffness[0, 1] + state.stiffness[1, 0])
        bound = math.sqrt(max(kxx * kzz, 0.0))
        kxz = min(max(kxz, -bound), bound)
        across = H / span
        if ex * ex + ey * ey < 0.5:  # straight down: no direction of its own
            ex, ey, kxx, kxz = 1.0, 0.0, across, 0.0
        kind.tangents[i, 0] = kxx * ex * ex + across * ey * ey
        kind.tangents[i, 1] = kind.tangents[i, 3] = (kxx - across) * ex * ey
        kind.tangents[i, 2] = kind.tangents[i, 6] = kxz * ex
        kind.tangents[i, 4] = kxx * ey * ey + across * ex * ex
        kind.tangents[i, 5] = kind.tangents[i, 7] = kxz * ey
        kind.tangents[i, 8] = kzz


@kernel(internal=True)
def _copy_solution(given: BottomState, out: BottomState) -> None:
    out.horizontal, out.vertical = given.horizontal, given.vertical
    out.span, out.rise = given.span, given.rise
    for i in range(2):
        for j in range(2):
            out.stiffness[i, j] = given.stiffness[i, j]
    out.branch = given.branch
    out.slope, out.clearance = given.slope, given.clearance
    out.lower_horizontal, out.lower_vertical = given.lower_horizontal, given.lower_vertical
    out.lying, out.lifted = given.lying, given.lifted


@implement(watch_forces, MooringLines)
@kernel(internal=True)
def watch_mooring_lines(kind: MooringLines, work: Workspace) -> None:
    """Tensions that were found in the middle of the step."""
    for i in range(kind.lines.shape[0]):
        note_value(kind.state[i].extremes, work.control.interval, kind.scratch[i].tension)


@implement(begin_record, MooringLines)
@kernel(internal=True)
def begin_line_records(kind: MooringLines) -> None:
    """Steps continue from what they found themselves: a record does not change the run, not in its last bits."""
    for i in range(kind.lines.shape[0]):
        _copy_solution(kind.state[i], kind.scratch[i].solution)


@implement(record_forces, MooringLines)
@kernel(internal=True)
def record_mooring_lines(kind: MooringLines, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Tensions, length on the seabed; the energy of the lines moves from the work of outer forces to its own.

    Forces were added at the same state just before. What the held force does, and what friction of the seabed takes,
    stays in that work.
    """
    for i in range(kind.lines.shape[0]):
        line, state, ends = kind.lines[i], kind.state[i], kind.scratch[i]
        a, b, out = line.anchor, line.fairlead, mooring_outputs(row, line.column)
        if line.over_bottom:
            read_ends_over_bottom(kind.sections, line, state, kind.nodes, ends)
        else:
            read_ends(kind.sections, line, state, ends)
        low_h, low_v = ends.anchor_horizontal, ends.anchor_vertical
        x = work.markers[b].point[0] - work.markers[a].point[0]
        y = work.markers[b].point[1] - work.markers[a].point[1]
        span = max(math.sqrt(x * x + y * y), LEAST_SPAN * line.length)
        out.tension = tension = _fairlead_tension(state, x / span, y / span)
        out.anchor_tension = math.sqrt(low_h * low_h + low_v * low_v)
        out.horizontal_tension = state.horizontal
        out.seabed_length = ends.lying
        out.tension_max = largest_of(state.extremes, work.control.interval, tension)
        out.tension_min = smallest_of(state.extremes, work.control.interval, tension)
        energy = ends.energy + line.weight * work.markers[a].point[2]
        if not state.started:
            state.start_energy, state.started = energy, True
        work.sums.elastic += energy - state.start_energy
        work.sums.external_work += energy - state.start_energy
        _copy_solution(ends.solution, state)
