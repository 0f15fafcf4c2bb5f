"""A simulation whose mooring lines, or some of them, are computed by MoorDyn.

The simulation keeps its catenaries, with their stiffness inside the step. After each exchange interval MoorDyn
moves its lines along with the fairleads, and what its force differs from that of the catenary there acts on the
fairlead, constant, over the next interval. So only that difference lags, by half an interval in the mean.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.moordyn.lines import MoorDynLine, moordyn_package, quasi_static_force, work_folder
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.lines.mooring_lines import MooringState

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.moordyn.input_file import LineDynamics
    from heavylift.solver.scene.channels import Channel
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.water.lines.mooring_lines import MooringLine

__all__ = ["CoupledRun", "couple_moordyn"]

STATE = "MooringLines.state"
"""Array in the state of a simulation that holds the forces beside the catenaries."""


@dataclass(frozen=True, eq=False)
class CoupledRun:
    """A simulation with dynamic lines.

    Attributes
    ----------
    times
        [s], shape (nt,), the start included.
    records
        Columns of the simulation, shape (nt, columns).
    channels
        Their meaning.
    tension, quasi_static
        At the fairlead of each dynamic line [N], by MoorDyn and of the catenary at the same place, shape (nt,).
    simulation
        At its end: with its outcome and message.
    """

    times: NDArray[np.float64]
    records: NDArray[np.float64]
    channels: tuple[Channel, ...]
    tension: dict[str, NDArray[np.float64]]
    quasi_static: dict[str, NDArray[np.float64]]
    simulation: Simulation


def couple_moordyn(
    scene: Scene,
    dynamics: Mapping[str, LineDynamics],
    step: float,
    duration: float,
    *,
    interval: float = 0.05,
    folder: Path | None = None,
) -> CoupledRun:
    """Simulate a moored scene with some of its lines computed by MoorDyn.

    Parameters
    ----------
    scene
        With a sea that has the lines.
    dynamics
        What MoorDyn needs to know, by name of the line.
    step
        Of the simulation [s], with the default integrator.
    duration
        [s].
    interval
        Between two exchanges, and two records [s]; a whole number of steps. A fifth of it times the largest natural
        frequency of what is moored should be small.
    folder
        For input and messages of MoorDyn; None: nowhere.

    Returns
    -------
    CoupledRun
        Until the duration, or where the simulation stopped.

    Raises
    ------
    InputError
        If the package is not installed, a line is not in the scene or its anchor not on the ground, the interval is
        no whole number of steps, or MoorDyn stops. A coupled run cannot be continued from a checkpoint: the state of
        MoorDyn is not in it.
    """
    sea = scene.sea
    names = [line.name for line in sea.lines] if sea is not None else []
    for name in dynamics:
        if name not in names:
            raise InputError(
                f"there is no line {name!r}",
                source="mooring",
                key="dynamics",
                expected=f"one of {', '.join(names)}" if names else "lines in the scene",
            )
    steps = round(interval / step)
    if steps < 1 or abs(steps * step - interval) > 1e-9 * interval:
        raise InputError(
            f"{interval:g} s between exchanges",
            source="mooring",
            key="interval",
            expected=f"a whole number of steps of {step:g} s",
        )
    assert sea is not None or not dynamics
    lines = [
        (names.index(name), line)
        for name in dynamics
        for line in (sea.lines if sea else ())
        if line.name == name
    ]
    for _, line in lines:
        if line.body_a != GROUND:
            raise InputError(
                f"the anchor is on {line.body_a!r}",
                source=line.name,
                key="body_a",
                expected="an anchor on the ground, for a line that is coupled with MoorDyn",
            )
    moordyn_package()
    simulation = Simulation(scene, step, record_every=steps)
    records = [simulation.record()]
    ends = [np.asarray(line.point_a, dtype=np.float64) for _, line in lines]
    at = [_fairlead(simulation, records[0], line) for _, line in lines]
    with work_folder(folder) as place:
        models: list[MoorDynLine] = []
        try:
            for (_, line), anchor, fairlead in zip(lines, ends, at, strict=True):
                models.append(
                    MoorDynLine(
                        line,
                        dynamics[line.name],
                        anchor,
                        fairlead,
                        place,
                        level=sea.water.level if sea else 0.0,
                        density=sea.water.density if sea else 0.0,
                        gravity=sea.water.gravity if sea else 0.0,
                    )
                )
            tension, static = [], []
            for _ in range(math.ceil(duration / interval - 1e-9)):
                forces = [
                    quasi_static_force(line, a[None], b[None])[0]
                    for (_, line), a, b in zip(lines, ends, at, strict=True)
                ]
                tension.append([np.linalg.norm(model.force) for model in models])
                static.append([np.linalg.norm(force) for force in forces])
                _hold(
                    simulation,
                    [row for row, _ in lines],
                    [m.force - f for m, f in zip(models, forces, strict=True)],
                )
                _, found = simulation.advance(steps)
                if simulation.outcome is not Outcome.COMPLETED:
                    break
                records.append(found[-1])
                before, at = at, [_fairlead(simulation, records[-1], line) for _, line in lines]
                for model, start, end in zip(models, before, at, strict=True):
                    model.lead(start, end, interval)
            else:
                tension.append([np.linalg.norm(model.force) for model in models])
                static.append(
                    [
                        np.linalg.norm(quasi_static_force(line, a[None], b[None]))
                        for (_, line), a, b in zip(lines, ends, at, strict=True)
                    ]
                )
        finally:
            for model in models:
                model.close()
    count = len(records)
    by_line = {line.name: number for number, (_, line) in enumerate(lines)}
    return CoupledRun(
        np.asarray(interval * np.arange(count), dtype=np.float64),
        np.array(records),
        tuple(simulation.channels),
        {name: np.array([row[number] for row in tension[:count]]) for name, number in by_line.items()},
        {name: np.array([row[number] for row in static[:count]]) for name, number in by_line.items()},
        simulation,
    )


def _fairlead(simulation: Simulation, row: NDArray[np.float64], line: MooringLine) -> NDArray[np.float64]:
    """Fairlead of a line in a record, world [m]."""
    if line.body_b == GROUND:
        return np.asarray(line.point_b, dtype=np.float64)
    found = {channel.name: channel.column for channel in simulation.channels}
    position, turn = found[f"{line.body_b}.position"], found[f"{line.body_b}.orientation"]
    rotation = rotation_matrix(row[turn : turn + 4])
    return np.asarray(row[position : position + 3] + rotation @ np.asarray(line.point_b, dtype=np.float64))


def _hold(simulation: Simulation, rows: list[int], forces: list[NDArray[np.float64]]) -> None:
    """Let forces act on fairleads beside the catenaries until they are changed again."""
    state = simulation.state()
    for row, force in zip(rows, forces, strict=True):
        state[STATE].view(MooringState.layout)["extra"][row] = force
    simulation.restore(state)
