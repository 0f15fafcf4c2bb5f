"""CPU time and peak memory of the assembly of a box of stiffened plates.

Run with one thread, e.g. `OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/structures.py 54`; the number is
that of elements along an edge of the box (54: 105 thousand degrees of freedom).
"""

from __future__ import annotations

import resource
import statistics
import sys
import time

import numpy as np

from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.checks import check_structure
from heavylift.preprocess.structures.geometric import geometric_stiffness
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.stress import shell_stress
from heavylift.preprocess.structures.structure import Beams, Shells, Structure

REPEATS = 3


def box(n):
    """Six walls of n x n quadrilaterals between common nodes, a stiffener along every second line of the floor."""
    at = np.arange(n + 1)
    walls = []
    for axis in range(3):
        for end in (0, n):
            a, b = np.meshgrid(at, at, indexing="ij")
            grid = np.empty((n + 1, n + 1, 3), dtype=np.int64)
            grid[..., axis], grid[..., (axis + 1) % 3], grid[..., (axis + 2) % 3] = end, a, b
            walls.append(grid)
    places, index = np.unique(
        np.concatenate([wall.reshape(-1, 3) for wall in walls]), axis=0, return_inverse=True
    )
    index = index.reshape(6, n + 1, n + 1)
    steel = Material(2.1e11, 0.3, 7850.0)
    quads = np.stack([index[:, :-1, :-1], index[:, 1:, :-1], index[:, 1:, 1:], index[:, :-1, 1:]], axis=-1)
    lines = index[4][:, 1:-1:2]
    bars = np.stack([lines[:-1], lines[1:]], axis=-1).reshape(-1, 2)
    offset = np.array([0.0, 0.0, 0.1])
    section = profile("bulb", height=0.2, thickness=0.01).section
    return Structure(
        places * (4.0 / n),
        shells=(Shells("walls", quads.reshape(-1, 4), steel, 0.012),),
        beams=(Beams("bars", bars, steel, section, offset, offset_a=offset, offset_b=offset),),
    )


def timed(function, *args, **kwargs):
    """Result of a call and the median of its CPU seconds."""
    seconds = []
    for _ in range(REPEATS):
        start = time.process_time()
        result = function(*args, **kwargs)
        seconds.append(time.process_time() - start)
    return result, statistics.median(seconds)


def main(n):
    structure = box(n)
    _, check_seconds = timed(check_structure, structure)
    model, seconds = timed(assemble_structure, structure)
    _, consistent_seconds = timed(assemble_structure, structure, mass="consistent")
    u = np.zeros(model.dof_count)
    u[: 3 * model.node_count] = 1e-4 * model.nodes.ravel()
    _, geometric_seconds = timed(geometric_stiffness, structure, model, u)
    _, stress_seconds = timed(shell_stress, structure, structure.shells[0], model)
    print(f"{model.dof_count} degrees of freedom, {structure.element_count} elements")
    print(f"checks                    {check_seconds:6.2f} s")
    print(f"assembly, lumped mass     {seconds:6.2f} s with checks, {model.stiffness.nnz} entries")
    print(f"assembly, consistent mass {consistent_seconds:6.2f} s")
    print(f"geometric stiffness       {geometric_seconds:6.2f} s")
    print(f"stress operators          {stress_seconds:6.2f} s")
    print(f"peak {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 54)
