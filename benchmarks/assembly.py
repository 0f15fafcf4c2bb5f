"""CPU time and peak memory of meshing and assembling the complex beam with quadratic tetrahedra.

Run with one thread, e.g. `OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/assembly.py 1.7`; the
number is the target edge length in mm (4: 13.7 thousand degrees of freedom, 1.7: 112 thousand).
"""

from __future__ import annotations

import resource
import statistics
import sys
import time

from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import NodePattern, mass_matrix, stiffness_matrix
from heavylift.preprocess.finite_elements.model import Material

REPEATS = 3
MM = 1e-3


def box(name, lower, upper):
    return Box(name, tuple(MM * v for v in lower), tuple(MM * v for v in upper))


def timed(function, *args, **kwargs):
    """Result of a call and the median of its CPU seconds."""
    seconds = []
    for _ in range(REPEATS):
        start = time.process_time()
        result = function(*args, **kwargs)
        seconds.append(time.process_time() - start)
    return result, statistics.median(seconds)


def peak_gigabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def main(size):
    add = [box("plate", (0, 0, 0), (95, 10, 20)), box("tower", (95, 0, 5.13), (105, 34.22, 14.87))]
    cut = [box("pocket", (23.15, 5, 5.13), (47.5, 10, 14.87))]
    steel = Material(young_modulus=2.1e11, poisson_ratio=0.3, density=7987.0)
    mesh, seconds = timed(mesh_blocks, add, cut, size=size)
    print(f"{3 * mesh.node_count} degrees of freedom, {mesh.element_count} elements")
    print(f"mesh (gmsh, checks)  {seconds:6.2f} s CPU, peak {peak_gigabytes():.2f} GB")
    stiffness_matrix(mesh, steel)  # imports of scikit-fem are not assembly
    pattern, pattern_seconds = timed(NodePattern, mesh.elements, mesh.node_count)
    K, K_seconds = timed(stiffness_matrix, mesh, steel, pattern=pattern)
    M, M_seconds = timed(mass_matrix, mesh, steel.density, pattern=pattern)
    print(f"pattern              {pattern_seconds:6.2f} s")
    print(f"stiffness            {K_seconds:6.2f} s, {K.nnz} entries")
    print(f"consistent mass      {M_seconds:6.2f} s, {M.nnz} entries")
    total = pattern_seconds + K_seconds + M_seconds
    print(f"assembly             {total:6.2f} s CPU, peak {peak_gigabytes():.2f} GB")


if __name__ == "__main__":
    main(MM * float(sys.argv[1]) if len(sys.argv) > 1 else 1.7 * MM)
