"""Maxwell ropes: a spring and a damper one behind the other, which pull and never push.

The elastic stretch e and the creep p add up to what the path s is longer than the rope was at first, l. Both parts have
the same tension::

    T = k max(0, e),      e = s - l - p,      dp/dt = T/c

(J. C. Maxwell, Phil. Trans. R. Soc. 157, 1867). At a fixed length a tension fades as ``exp(-k t/c)``; under a constant
one the rope creeps at T/c for ever, and what it has crept stays. So a rope of fibre gives way to slow motions and is
stiff against fast ones.

It is a rope whose unstretched length grows in each step by what the damper gives way, ``dp = h T/c``, with T the
discrete gradient of ``k/2 max(0, e)^2`` as in any rope (`heavylift.solver.force_elements.forces.pull`): at both ends of
a step taut that is the trapezoidal rule. With ``a = e0 + h u``, the stretch without creep, and ``b = k h/(2 c)`` the
stretch at the end of the step is ::

    e1 = ((1 - b) e0 + h u)/(1 + b)                        if it stays taut,
    (1 + b) e1^2 - (a + e0) e1 + a e0 = 0                  if it becomes taut,
    e1 = e0 - (d + sqrt(d^2 + 4 b e0^2))/2,  d = -h u      if it becomes slack,

and no less than ``a - max(e0, a)``: in steps much longer than c/k it creeps no more than it was stretched. The damper
takes ``T dp``, so energies are exact through slack and taut at any step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Least, Positive
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.force_elements.rows import fit_law, put_law
from heavylift.solver.force_elements.wire_rope import (
    Ropes,
    midpoint_rate,
    midpoint_tension,
    record_ropes,
    update_ropes,
)
from heavylift.solver.interface import Workspace, record_joints, relinearise, set_targets, update_rows
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import (
    ROPES,
    AlongPath,
    ForceElement,
    RopeOutputs,
    RopeParts,
    RopePoint,
    check_path,
)
from heavylift.solver.scene.outputs import Outputs, channel, outputs

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["Creep", "MaxwellRope", "MaxwellRopes", "pack"]


@outputs
class CreepOutputs(Outputs):
    """What a Maxwell rope records beside what all ropes do."""

    creep: float = channel("length", "elongation of the damper so far, which is permanent")


@ROPES.describe("maxwell")
@dataclass(frozen=True, eq=False, kw_only=True)
class MaxwellRope(AlongPath, ForceElement):
    """A rope that creeps: a spring and a damper one behind the other, from end to end; it pulls and never pushes."""

    CHANNELS: ClassVar = (*RopeOutputs.CHANNELS, *RopeParts.CHANNELS, *CreepOutputs.CHANNELS)
    """What it records, in the order of its columns."""
    NOT_LINEAR: ClassVar = "creeps: its stiffness depends on the frequency"

    name: str
    path: Annotated[tuple[RopePoint, ...], Least(2)]
    """Two and more places, from end to end; it runs over those between without friction."""
    stiffness: Annotated[float, Positive("stiffness")]
    """Of the spring [N/m]."""
    viscosity: Annotated[float, Positive("damping")]
    """Of the damper [N s/m]: a tension of a stretch that is held fades in the time viscosity over stiffness."""
    length: Annotated[float | None, Positive("length")] = None
    """Unstretched length at the start [m]; as drawn if absent."""

    @property
    def damping(self) -> float:
        """No damper stands beside its spring."""
        return 0.0

    @staticmethod
    def check(spec: Any) -> None:
        """Its ends are no pulleys, and it runs without friction."""
        for place, stop in enumerate(spec.path):
            if stop.radius > 0.0 and place in {0, len(spec.path) - 1}:
                raise InputError(
                    "a pulley at an end", key=f"path.{place}.radius", expected="ends without 'radius'"
                )
            for key, rubs in (("efficiency", stop.efficiency < 1.0), ("friction", stop.friction > 0.0)):
                if rubs:
                    raise InputError(
                        f"{key!r} in a rope of type 'maxwell'",
                        key=f"path.{place}.{key}",
                        expected="type 'wire'",
                    )
        check_path(spec.path)

    def obstacle(self, integrator: str) -> str:
        """Its creep is carried from step to step."""
        return "" if integrator == "dele2" else "creeps, which its rows carry from step to step"


class Creep(Record):
    """What a rope creeps.

    Attributes
    ----------
    viscosity
        [N s/m].
    column
        Of its `CreepOutputs`.
    """

    viscosity: float
    column: int


creep_outputs = outputs_at(CreepOutputs)


class MaxwellRopes(Ropes):
    """All Maxwell ropes of a scene.

    Attributes
    ----------
    creep
        Of each rope.
    """

    COMMANDED: ClassVar[bool] = False

    creep: Records[Creep]


def pack(ropes: Sequence[MaxwellRope], context: PackingContext) -> None:
    """Make the kind and its rows."""
    from heavylift.solver.force_elements.rope_packing import make_ropes

    plain = make_ropes(ropes, context)
    creep = [
        filled(Creep, viscosity=rope.viscosity, column=context.column(rope).at(CreepOutputs))
        for rope in ropes
    ]
    context.add_rows(
        MaxwellRopes(**{name: getattr(plain, name) for name in plain._fields}, creep=records(Creep, creep))
    )


@kernel(internal=True)
def stretch_at_end(e0: float, way: float, b: float) -> tuple[float, float]:
    """Elastic stretch at the end of a step [m], and its derivative by the way.

    Parameters
    ----------
    e0
        That at its start [m].
    way
        By how much the path grows in it [m].
    b
        ``k h/(2 c)``.
    """
    a = e0 + way
    if e0 > 0.0:
        if (1.0 - b) * e0 + way > 0.0:
            return ((1.0 - b) * e0 + way) / (1.0 + b), 1.0 / (1.0 + b)
        root = math.sqrt(way * way + 4.0 * b * e0 * e0)
        e1, least = e0 - 0.5 * (root - way), a - max(e0, a)
        if e1 > least:
            return e1, 0.5 * (1.0 - way / root)
        return least, (0.0 if a > e0 else 1.0)
    if a <= 0.0:
        return a, 1.0
    half = 0.5 * (a + e0)
    root = math.sqrt(half * half - (1.0 + b) * a * e0)
    e1 = (half + root) / (1.0 + b) if half > 0.0 else a * e0 / (half - root)
    return e1, 0.5 * (e1 - e0) / ((1.0 + b) * e1 - half)


@kernel(internal=True)
def _answer(kind: MaxwellRopes, i: int, u: float, h: float) -> tuple[float, float]:
    """Tension of a step and its slope by the rate u; the unstretched length at its end."""
    rope = kind.state[i]
    e0 = rope.stretched - rope.rest
    e1, share = stretch_at_end(e0, h * u, 0.5 * kind.table[i].stiffness * h / kind.creep[i].viscosity)
    rope.next_rest = rope.rest + (e0 + h * u - e1)
    _, tension, slope, _, _ = midpoint_tension(kind, i, u, h)
    return tension, slope * share


@implement(set_targets, MaxwellRopes)
@kernel(internal=True)
def set_maxwell_targets(
    kind: MaxwellRopes, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: the rate of the last step."""
    if not at_midpoint:
        return
    for i in range(kind.table.shape[0]):
        tension, slope = _answer(kind, i, kind.state[i].rate, step)
        put_law(system, kind.table[i].block, step, kind.state[i].rate, tension, slope)


@implement(relinearise, MaxwellRopes)
@kernel(internal=True)
def relinearise_maxwell_ropes(
    kind: MaxwellRopes, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the tensions to the rates found."""
    for i in range(kind.table.shape[0]):
        u = midpoint_rate(kind, i, work, system)
        tension, slope = _answer(kind, i, u, step)
        fit_law(system, kind.table[i].block, step, u, tension, slope, work)


@implement(update_rows, MaxwellRopes)
@kernel(internal=True)
def update_maxwell_ropes(
    kind: MaxwellRopes, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """As a rope whose length grows; it is no winch that takes the work of that, but the damper."""
    for i in range(kind.table.shape[0]):
        _answer(kind, i, midpoint_rate(kind, i, work, system), step)
    update_ropes(kind, time, step, work, system)
    for i in range(kind.table.shape[0]):
        state = kind.state[i]
        state.loss -= state.winch_work
        state.winch_work = 0.0


@implement(record_joints, MaxwellRopes)
@kernel(internal=True)
def record_maxwell_ropes(
    kind: MaxwellRopes, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a rope, with its creep."""
    record_ropes(kind, time, work, system, row)
    for i in range(kind.table.shape[0]):
        creep_outputs(row, kind.creep[i].column).creep = kind.state[i].rest - kind.table[i].start_length
