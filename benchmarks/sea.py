"""CPU time of an hour of a moored barge in an irregular sea, and what others take for its parts.

    python benchmarks/sea.py

The barge of cases/irregular_sea with four chains and gusty wind: 200 components, 72,000 steps of 0.05 s. Medians of CPU
time on one thread, without compilation; to prepare is to tabulate, fit and pack before the first step. In the same run,
where they are installed, MoorPy finds the tensions of the same four chains, one call a line and step, and MoorDyn steps
the first chain along the same motion with its mass and drag, in ten segments. A loop in plain NumPy integrates linear
equations of motion without lines and wind: direct convolution over 40 s with a kernel of the same data, the midpoint
rule, excitation from a table.
"""

from __future__ import annotations

import os
import statistics
import tempfile
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.log import Log
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.pipeline.stages.stages import load_changed_case, run_case
from heavylift.solver.simulation import Simulation

CASE = Path(__file__).resolve().parents[1] / "cases" / "irregular_sea"
STEP, STEPS, REPEATS = 0.05, 72_000, 5
WAVES = ("sea.waves.count=200", "sea.waves.amplitudes=deterministic")
VARIANTS = {
    f"{excitation} excitation, {restoring} restoring": (
        f"sea.excitation={excitation}",
        f"hulls.barge.restoring={restoring}",
    )
    for excitation in ("series", "summed")
    for restoring in ("linear", "clipped")
}
PEER_STEPS = 2000


def hour(case, folder):
    """CPU seconds of packing and of the steps, the reason of its end, and the last records of a run."""
    begin = time.process_time()
    scene = assemble_scene(case, folder)
    simulation = Simulation(scene, STEP, "dele2", record_every=10)
    packed = time.process_time() - begin
    simulation.warm_up()
    begin = time.process_time()
    _, records = simulation.advance(STEPS)
    return packed, time.process_time() - begin, simulation, records


def measure(name, changes, out):
    """Print the median of some runs; return the last one."""
    case = load_changed_case(CASE, (*WAVES, *changes))
    assert run_case(case, out=out, stages=("mesh",), log=Log(quiet=True)).message == ""
    packed, took = [], []
    for _ in range(REPEATS):
        one, two, simulation, records = hour(case, OutputFolder(out))
        packed.append(one)
        took.append(two)
    median = statistics.median(took)
    print(
        f"{name:42s}{statistics.median(packed):10.2f}{median:10.2f}{min(took):10.2f}{1e6 * median / STEPS:12.2f}"
        f"   {simulation.outcome.name.lower()}",
        flush=True,
    )
    return case, simulation, records


def told(name, took):
    """Print the CPU time [s] of a step, and of all."""
    print(f"{name:42s}{'':10s}{took * STEPS:10.2f}{'':10s}{1e6 * took:12.2f}")


def fairleads(case, simulation, records):
    """Places of anchor and fairleads over time [m], shapes (4, 3) and (nt, 4, 3)."""
    from scipy.spatial.transform import Rotation

    channels = {channel.name: channel.column for channel in simulation.channels}
    place = records[:, channels["barge.position"] :][:, :3]
    q = records[:, channels["barge.orientation"] :][:, :4]
    turn = Rotation.from_quat(q[:, [1, 2, 3, 0]])
    ends = [place + turn.apply(np.array(line.points[1])) for line in case.lines]
    return np.array([line.points[0] for line in case.lines]), np.stack(ends, axis=1)


def moorpy(case, anchors, ends, lengths):
    """CPU time of four lines [s], by the function that finds the tension of one line."""
    try:
        from moorpy.Catenary import catenary
    except ImportError:
        print("MoorPy is not installed: pip install moorpy")
        return
    rows = ends[:: max(1, len(ends) // PEER_STEPS)][:PEER_STEPS]
    begin = time.process_time()
    for row in rows:
        for line, anchor, end, length in zip(case.lines, anchors, row, lengths, strict=True):
            section = line.sections[0]
            span, height = np.hypot(*(end - anchor)[:2]), end[2] - anchor[2]
            catenary(span, height, length, section.axial_stiffness, section.weight, CB=0.0)
    took = (time.process_time() - begin) / len(rows)
    told("MoorPy, tensions of the four chains", took)


def moordyn(scene_lines, anchors, ends, interval):
    """CPU time of one dynamic line [s] along the motion of its fairlead."""
    from heavylift.numerics.outcome import InputError
    from heavylift.pipeline.moordyn.input_file import LineDynamics
    from heavylift.pipeline.moordyn.lines import MoorDynLine

    weight = scene_lines[0].sections[0].weight
    dynamics = LineDynamics(masses=(weight / 9.81 / 0.87,), segment=40.0)
    times = np.arange(len(ends)) * interval
    path = np.column_stack(
        [np.interp(STEP * np.arange(PEER_STEPS + 1), times, ends[:, 0, axis]) for axis in range(3)]
    )
    with tempfile.TemporaryDirectory() as folder:
        try:
            line = MoorDynLine(scene_lines[0], dynamics, anchors[0], path[0], Path(folder), gravity=9.81)
        except InputError as error:
            print(f"MoorDyn: {error.problem}; {error.expected}")
            return
        begin = time.process_time()
        for one, two in pairwise(path):
            line.lead(one, two, STEP)
        took = (time.process_time() - begin) / PEER_STEPS
        line.close()
    told("MoorDyn, one chain with mass and drag", took)


def plain_loop(simulation, records):
    """CPU time of the equations of motion in NumPy [s]."""
    from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf
    from heavylift.preprocess.hydrodynamics.retardation import retardation_kernel

    database = read_netcdf(CASE / "barge.nc")
    taps = round(40.0 / STEP)
    weights = STEP * retardation_kernel(database.omega, database.damping)(STEP * np.arange(taps))
    weights[0] *= 0.5
    table = np.ascontiguousarray(weights.transpose(1, 0, 2).reshape(6, -1))
    mass = np.diag([1.6e7, 1.6e7, 1.6e7, 2.6e9, 9.6e9, 9.6e9]) + database.added_mass_infinite
    stiffness = np.diag([5e4, 5e4, 3.5e7, 3.2e9, 2.7e10, 1e8])
    solve = np.linalg.inv(mass + 0.25 * STEP**2 * stiffness)
    names = {channel.name: channel.column for channel in simulation.channels}
    waves = records[:, names["barge.wave_force"] :][:, :6]
    force = np.column_stack(
        [np.interp(STEP * np.arange(STEPS), 10 * STEP * np.arange(len(waves)), waves[:, j]) for j in range(6)]
    )
    past, q, v = np.zeros((taps, 6)), np.zeros(6), np.zeros(6)
    begin = time.process_time()
    for n in range(PEER_STEPS):
        past[1:] = past[:-1]
        past[0] = v
        a = solve @ (force[n] - table @ past.ravel() - stiffness @ (q + 0.5 * STEP * v))
        q += STEP * (v + 0.5 * STEP * a)
        v = v + STEP * a
    took = (time.process_time() - begin) / PEER_STEPS
    assert np.isfinite(q).all()
    told("plain NumPy, no lines, direct convolution", took)


def main() -> None:
    print(f"load of the machine {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    print(
        f"{'CPU time of 72,000 steps':42s}{'prepare s':>10s}{'median s':>10s}{'least s':>10s}{'us a step':>12s}"
    )
    last = None
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, changes) in enumerate(VARIANTS.items()):
            out = Path(folder) / str(number)
            found = measure(name, changes, out)
            last = last or (*found, assemble_scene(found[0], OutputFolder(out)).sea.lines)
    case, simulation, records, lines = last
    anchors, ends = fairleads(case, simulation, records)
    lengths = [sum(section.length for section in line.sections) for line in lines]
    moorpy(case, anchors, ends, lengths)
    moordyn(lines, anchors, ends, 10 * STEP)
    plain_loop(simulation, records)
    print(f"load of the machine {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
