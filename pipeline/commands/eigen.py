"""``heavylift eigen``: modes of a scene about its start, at rest, or at a time of its run."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.pipeline.results.storage import StopError, replacing, write_json

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.log import Log
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.pipeline.stages.prepared import PreparedRun
    from heavylift.solver.linearise.result import Linearisation
    from heavylift.solver.simulation import Simulation

__all__ = ["eigen_command"]

WHOLE = 1e-9
"""Of a step, by which a time may miss the end of one."""

SHOWN = 0.08
"""Largest displacement of a drawn mode, relative to the distances of bodies, or rotation [rad]."""

PERIODS, FRAMES, SHOWN_PERIOD = 2, 60, 10.0
"""Of a drawn mode: periods, records in each, and the period [s] of what has none."""

AT_REST = 'simulate.start="equilibrium"'


def eigen_command(
    path: Path,
    *,
    out: Path | None = None,
    overrides: Sequence[str] = (),
    at: str = "start",
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] = (),
    count: int | None = None,
    drawn: Sequence[int] = (),
    log: Log,
) -> tuple[dict[str, Any], list[str]]:
    """Linearise a case and write ``eigen/``.

    Parameters
    ----------
    path, out, overrides, log
        As of other commands.
    at
        ``"start"`` of the run; ``"rest"``, where the scene is in static equilibrium; or a time of the run [s].
    inputs, outputs
        Names of inputs, all if None, and of outputs.
    count
        Modes in the table; all if None.
    drawn
        Numbers of modes that get a page in which the scene swings.

    Returns
    -------
    tuple
        Document, and a table for a person.

    Raises
    ------
    InputError
        If the case is wrong, the time is none of its run, or something in it has no linear motion.
    StopError
        If a stage, or the run before that time, stops by itself.
    """
    from heavylift.pipeline.case.places import in_case
    from heavylift.pipeline.results.mesh_results import save_meshes
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.pipeline.stages.lock import locked
    from heavylift.pipeline.stages.prepared import compile_parts, prepare_run
    from heavylift.pipeline.stages.stages import load_changed_case, make_parts
    from heavylift.solver.linearise.linearise import linearise, output_columns
    from heavylift.solver.linearise.served import check_served

    if count is not None and count < 1:
        raise InputError(f"{count}", source="eigen", key="--count", expected="1 or more modes")
    changes = (*overrides, AT_REST) if at == "rest" else tuple(overrides)
    case = load_changed_case(path, changes)
    if case.simulate is None:
        raise InputError(
            "no [simulate] section", source=case.file, expected="step or tolerance, output_interval, duration"
        )
    time = _time(case, at)
    folder = OutputFolder(case.output_folder if out is None else out)
    make_parts(case, folder)
    run = prepare_run(case, folder, log)
    simulation = run.simulation
    if case.fmus:
        log.say("eigen: NOTE: what FMUs write stays as it is: these are the motions without their answers")
    with in_case(case):
        check_served(simulation)
    compile_parts(simulation, log)
    with in_case(case):
        simulation.warm_up()
        if simulation.start_text:
            log.say(f"eigen: {simulation.start_text}")
        _advance(simulation, time)
        columns = output_columns(simulation, outputs)
        whole = linearise(simulation, inputs, every=True)
        found = replace(
            whole,
            C=whole.C[columns.places],
            D=whole.D[columns.places],
            outputs=columns.names,
            output_units=columns.units,
        )
        row = simulation.record()
    for number in drawn:
        if not 1 <= number <= len(found.eigenvalues):
            raise InputError(
                f"{number}",
                source="eigen",
                key="--draw",
                expected=f"a mode from 1 to {len(found.eigenvalues)}",
            )
    for warning in found.warnings:
        log.say(f"eigen: WARNING: {warning}")
    place = folder.stage("eigen")
    with locked(folder.root):
        files = _write(place, case, found)
        if drawn:
            save_meshes(place / "meshes.h5", run.meshes)
        for number in drawn:
            files.append(place / f"mode_{number}.html")
            with in_case(case):
                text = _page(case, folder, run, whole, row, number, place / "meshes.h5")
            with replacing(files[-1]) as temporary:
                temporary.write_text(text, encoding="utf-8")
    document = {**_document(case, found), "files": [str(file) for file in files]}
    words = [
        f"{case.name}: small motions about the state at t = {found.time:.9g} s",
        *found.table(count).split("\n"),
    ]
    return document, [*words, "", *(f"  written: {file}" for file in files)]


def _time(case: Case, at: str) -> float:
    """Time at which to linearise [s].

    Raises
    ------
    InputError
        If it is none of the run.
    """
    if at in ("start", "rest"):
        return 0.0
    assert case.simulate is not None
    end = float(case.simulate.duration)
    try:
        time = float(at)
    except ValueError:
        time = math.nan
    if not 0.0 <= time <= end:
        raise InputError(
            repr(at), source="eigen", key="--at", expected=f"start, rest, or a time from 0 to {end:.9g} s"
        )
    return time


def _advance(simulation: Simulation, time: float) -> None:
    """Run to a time.

    Raises
    ------
    InputError
        If it is within a step.
    StopError
        If the run stops before.
    """
    from heavylift.pipeline.stages.advance import stop_requests

    count = round(time / simulation.step)
    if abs(count * simulation.step - time) > WHOLE * simulation.step * max(1.0, count):
        raise InputError(
            f"{time:.9g} s",
            source="eigen",
            key="--at",
            expected=f"a multiple of {simulation.step:.9g} s, as {count * simulation.step:.9g} s",
        )
    with stop_requests() as stop:
        simulation.stop_asked = lambda: bool(stop)
        simulation.advance(count)
        if stop:
            raise StopError(Outcome.INTERRUPTED, f"interrupted at t = {simulation.time:.9g} s")
    if simulation.outcome is not Outcome.COMPLETED:
        raise StopError(simulation.outcome, simulation.message)
    if simulation.step_index < count:
        raise InputError(
            f"{time:.9g} s, and the scenario ends at t = {simulation.time:.9g} s",
            source="eigen",
            key="--at",
            expected="a time before its end",
        )


def _modes(found: Linearisation) -> list[dict[str, Any]]:
    """One entry a mode."""
    rows = []
    of_bodies = set(found.of_bodies.tolist())
    for mode, s in enumerate(found.eigenvalues):
        frequency = float(found.frequencies[mode])
        rows.append(
            {
                "mode": mode + 1,
                "eigenvalue": [float(s.real), float(s.imag)],
                "frequency": frequency,
                "period": 1.0 / frequency if frequency > 0.0 else None,
                "damping_ratio": float(found.damping[mode]),
                "free": bool(s == 0.0),
                "grows": bool(mode in found.unstable),
                "of_bodies": mode in of_bodies,
                "energy": {
                    name: dict(
                        zip(("translation", "rotation", "bending"), map(float, parts[mode]), strict=True)
                    )
                    for name, parts in found.participation.items()
                },
            }
        )
    return rows


def _document(case: Case, found: Linearisation) -> dict[str, Any]:
    return {
        "case": case.name,
        "time": found.time,
        "residual_acceleration": found.residual,
        "speed": found.speed,
        "zero_eigenvalues": found.zeros,
        "warnings": list(found.warnings),
        "units": {"eigenvalue": "1/s", "frequency": "Hz", "period": "s", "time": "s"},
        "modes": _modes(found),
    }


def _write(place: Path, case: Case, found: Linearisation) -> list[Path]:
    """Document, table, and matrices with shapes."""
    files = [place / "modes.json", place / "modes.csv", place / "matrices.npz"]
    document = _document(case, found)
    document |= {
        "states": _named(found.states, found.state_units),
        "inputs": _named(found.inputs, found.input_units),
        "outputs": _named(found.outputs, found.output_units),
    }
    write_json(files[0], document)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["mode", "real_1_s", "imaginary_1_s", "frequency_Hz", "period_s", "damping_ratio"])
    for row in document["modes"]:
        period = "" if row["period"] is None else f"{row['period']:.12g}"
        numbers = (f"{value:.12g}" for value in (*row["eigenvalue"], row["frequency"]))
        table.writerow([row["mode"], *numbers, period, f"{row['damping_ratio']:.6g}"])
    with replacing(files[1]) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8")
    bodies = list(found.shapes)
    arrays = {
        "A": found.A,
        "B": found.B,
        "C": found.C,
        "D": found.D,
        "states": np.array(found.states),
        "state_units": np.array(found.state_units),
        "inputs": np.array(found.inputs),
        "input_units": np.array(found.input_units),
        "outputs": np.array(found.outputs),
        "output_units": np.array(found.output_units),
        "eigenvalues": found.eigenvalues,
        "vectors": found.vectors,
        "bodies": np.array(bodies),
        "displacements": np.array([found.shapes[name].displacement for name in bodies]),
        "rotations": np.array([found.shapes[name].rotation for name in bodies]),
    }
    with replacing(files[2]) as temporary, temporary.open("wb") as stream:
        np.savez(stream, **arrays)  # type: ignore[arg-type]
    return files


def _page(
    case: Case,
    folder: OutputFolder,
    run: PreparedRun,
    whole: Linearisation,
    row: NDArray[np.float64],
    number: int,
    meshes: Path,
) -> str:
    """A page with the scene as it swings in a mode, larger than life; `whole` has all columns as outputs.

    Raises
    ------
    InputError
        If k3d is not installed.
    """
    from heavylift.pipeline.drawn.build import case_scene
    from heavylift.pipeline.page.packing import LibraryMissingError
    from heavylift.pipeline.page.page import page_content, page_html
    from heavylift.pipeline.results.histories import ChannelInfo, Results

    simulation, mode = run.simulation, number - 1
    frequency = float(whole.frequencies[mode])
    period = 1.0 / frequency if frequency > 0.0 else SHOWN_PERIOD
    times = np.linspace(0.0, PERIODS * period, PERIODS * FRAMES + 1)
    swing = whole.C @ whole.vectors[:, mode]
    moved = [np.abs(shape.displacement[mode]).max(initial=0.0) for shape in whole.shapes.values()]
    turned = [np.abs(shape.rotation[mode]).max(initial=0.0) for shape in whole.shapes.values()]
    places = np.array(
        [row[c.column : c.column + 3] for c in simulation.channels if c.name.endswith(".position")]
    )
    size = float(np.ptp(places, axis=0).max(initial=0.0)) or 1.0
    largest = max(max(moved, default=0.0) / (SHOWN * size), max(turned, default=0.0) / SHOWN, 1e-300)
    rows = row + np.real(np.exp(2j * np.pi * times / period)[:, None] * swing) / largest
    for channel in simulation.channels:
        if channel.name.endswith(".orientation"):
            q = rows[:, channel.column : channel.column + 4]
            q /= np.linalg.norm(q, axis=1)[:, None]
    channels = {
        c.name: ChannelInfo(c.name, c.unit, tuple(c.components), c.column) for c in simulation.channels
    }
    columns = {c.name: rows[:, c.column : c.column + len(c.components)] for c in simulation.channels}
    results = Results(case.file, times, channels, columns, {"title": case.title}, meshes)
    content = page_content(
        case,
        case_scene(case, folder, run.scene, results),
        results,
        verdict=(f"Mode {number}: {whole.words(mode)}", None),
    )
    try:
        return page_html(content)
    except LibraryMissingError as error:
        raise InputError(str(error), source="eigen", key="--draw", expected="the package k3d") from None


def _named(names: Sequence[str], units: Sequence[str]) -> list[dict[str, str]]:
    return [{"name": name, "unit": unit} for name, unit in zip(names, units, strict=True)]
