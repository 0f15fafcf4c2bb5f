"""Times of mooring lines: the force on the end of a catenary from its place, and with MoorPy where it is installed.

    python benchmarks/catenary.py

Medians of CPU time a solution in a compiled loop over many lines. *Cold* begins from a guess, *warm* follows ends that
move with an amplitude of one thousandth of the span in 200 steps; 3,000 random lines are slack, taut or in between.
MoorPy's catenary function is called one line at a time from Python, as it is meant to be, on the first hundred that are
longer than the distance of their ends; those that are shorter it takes as free of the seabed.
"""

from __future__ import annotations

import time

import numpy as np

from heavylift.numerics.records import filled_rows, records
from heavylift.solver.water.lines.catenary import (
    FAILED,
    LineData,
    LineEnds,
    LineState,
    SectionData,
    solve_lines,
)

COUNT, STEPS = 3000, 200
CHAIN = (401.1437, 187.371, 1 / 215.893e6, 0.0), (400.0, 12.0)
HANGING = (118.0, 2000.0, 1 / 2e8, 0.0), (100.0, 60.0)


def random_lines(seabed, sections=1, seed=3):
    """Sections, lines and places of taut, ordinary and slack lines."""
    rng = np.random.default_rng(seed)
    x, z = 10 ** rng.uniform(0, 3.3, COUNT), rng.uniform(2, 500, COUNT)
    chord, most = np.hypot(x, z), x + z
    taut = chord * (1 - 10 ** rng.uniform(-6, -1.2, COUNT))
    usual = chord + (most - chord) * rng.random(COUNT)
    slack = most * rng.uniform(1, 2, COUNT)
    length = np.choose(rng.integers(0, 3, COUNT), [taut, usual, slack])
    rows = np.zeros((COUNT, sections, 4))
    rows[:, :, 0] = length[:, None] * rng.dirichlet(np.ones(sections), COUNT)
    rows[:, :, 1] = (10 ** rng.uniform(1, 4, COUNT))[:, None] * rng.uniform(0.3, 1.7, (COUNT, sections))
    rows[:, :, 2] = 10 ** -rng.uniform(6, 10, COUNT)[:, None]
    return pack(rows, np.column_stack([x, z]), seabed)


def same_lines(line, place, seabed):
    """One line many times."""
    return pack(np.tile(np.array(line), (COUNT, 1, 1)), np.tile(place, (COUNT, 1)), seabed)


def pack(rows, places, seabed):
    count, sections, _ = rows.shape
    lines = records(LineData, count)
    lines["first"] = np.arange(count) * sections
    lines["count"] = sections
    lines["tail"] = 0 if seabed else sections
    lines["length"] = rows[:, :, 0].sum(1)
    lines["weight"] = (rows[:, :, 0] * rows[:, :, 1]).sum(1)
    lines["stretch"] = (rows[:, :, 0] * rows[:, :, 2]).sum(1)
    return (
        filled_rows(
            SectionData,
            **dict(zip(("length", "weight", "flexibility", "clump"), rows.reshape(-1, 4).T, strict=True)),
        ),
        lines,
        places.astype(float),
    )


def measure(name, problem):
    sections, lines, places = problem
    state, ends = records(LineState, COUNT), records(LineEnds, COUNT)
    solve_lines(sections, lines, places, state, ends)
    cold = []
    for _ in range(31):
        state.view(float)[:] = 0.0
        begin = time.thread_time()
        solve_lines(sections, lines, places, state, ends)
        cold.append(time.thread_time() - begin)
    failed = np.count_nonzero(state["branch"] == FAILED)
    warm = []
    for step in range(STEPS):
        moved = places * (1 + 1e-3 * np.sin(2 * np.pi * step / STEPS))
        begin = time.thread_time()
        solve_lines(sections, lines, moved, state, ends)
        warm.append(time.thread_time() - begin)
    failed += np.count_nonzero(state["branch"] == FAILED)
    print(f"{name:44s}{1e6 * np.median(cold) / COUNT:10.2f}{1e6 * np.median(warm) / COUNT:10.2f}{failed:8d}")


def compare(problem, count=100):
    try:
        from moorpy.Catenary import CatenaryError, catenary
    except ImportError:
        print("MoorPy is not installed: pip install moorpy")
        return
    sections, lines, places = problem
    state, ends = records(LineState, COUNT), records(LineEnds, COUNT)
    solve_lines(sections, lines, places, state, ends)
    took, differences, refused = [], [], 0
    longer = np.flatnonzero(
        sections["length"] > np.hypot(*places.T)
    )  # others it lets hang through the seabed
    for i in longer[:count]:
        length, w, flexibility, _ = tuple(sections[i])
        begin = time.thread_time()
        try:
            _, _, h, v, _ = catenary(*places[i], length, 1 / flexibility, w, CB=0.0, Tol=1e-9)
        except CatenaryError:
            refused += 1
            continue
        took.append(time.thread_time() - begin)
        force = np.array([state[i].horizontal, state[i].vertical])
        differences.append(np.hypot(h + force[0], v + force[1]) / np.hypot(*force))
    print(
        f"MoorPy: {1e6 * np.median(took):.0f} us a line, {refused} of {count} without solution; force differs by"
        f" {np.median(differences):.1e} (median), {np.max(differences):.1e} (largest)"
    )


def main():
    print(f"{'us a line':44s}{'cold':>10s}{'warm':>10s}{'failed':>8s}")
    measure("chain on the seabed (12 m, 400 m)", same_lines(*CHAIN, True))
    measure("hanging line", same_lines(*HANGING, False))
    measure("random, seabed", random_lines(True))
    measure("random, in air", random_lines(False))
    measure("random of three sections, seabed", random_lines(True, 3))
    measure("random of three sections, in air", random_lines(False, 3))
    compare(random_lines(True))


if __name__ == "__main__":
    main()
