"""CPU time of the ANCF shell element: strains, forces, forces with stiffness, by number of Gauss points.

Run with ``python benchmarks/ancf_shell.py``. Each number is the median of seven measurements of process
time per element, stiffness written into the blocks of a factor; set ``OMP_NUM_THREADS=1`` for comparable ones.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent))

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import records
from heavylift.numerics.small import aligned
from heavylift.solver.bodies.ancf import shell_elements  # noqa: F401  registers the kernels
from heavylift.solver.bodies.ancf.elements import (
    add_follower_load,
    add_stiffness,
    add_strain_rates,
    add_stress_forces,
    find_strains,
)
from heavylift.solver.bodies.ancf.kind import (
    NODAL_VECTORS,
    SHELL_PAIRS,
    STRAIN_VECTORS,
    MeshNumbers,
    ShellMeshElement,
    ShellMeshes,
    ShellPlaces,
)
from heavylift.solver.bodies.ancf.shell_packing import (
    body_constants,
    element_data,
    start_coordinates,
    strain_counts,
)
from heavylift.solver.scene.mesh_shapes import quadrilateral
from heavylift.solver.scene.meshes import ShellBody, ShellSection
from tests.solver.groups import partly

if TYPE_CHECKING:
    from collections.abc import Callable

ROWS, LANES = 12, 16
REPEATS = 7
MESH = (12, 8)


@kernel
def strains(kind: ShellMeshes, times: int) -> None:
    for _ in range(times):
        find_strains((kind,), 0, kind.position, kind.strain)


@kernel
def rates(kind: ShellMeshes, times: int) -> None:
    for _ in range(times):
        add_strain_rates((kind,), 0, kind.position, kind.velocity, kind.strain, 1e-9)


@kernel
def forces(kind: ShellMeshes, times: int) -> None:
    for _ in range(times):
        add_stress_forces((kind,), 0, kind.position, kind.strain, kind.external_force, 1e-9)


@kernel
def stiffness(kind: ShellMeshes, times: int) -> None:
    for _ in range(times):
        add_stiffness((kind,), 0, kind.position, kind.strain, kind.external_force, 1e-9, 1e-9, 1.0)


@kernel
def pressure(kind: ShellMeshes, times: int) -> None:
    for _ in range(times):
        for e in range(kind.elements.shape[0]):
            add_follower_load((kind,), 0, kind.position, e, kind.external_force, 0, 1e-9)


KERNELS = {
    "strains": strains,
    "rates": rates,
    "forces": forces,
    "forces + stiffness": stiffness,
    "pressure": pressure,
}


def measured(function: Callable[[ShellMeshes, int], None], kind: ShellMeshes) -> float:
    """CPU time of an element [us]."""
    function(kind, 1)
    times = 1
    while True:
        begin = time.process_time()
        function(kind, times)
        if time.process_time() - begin > 0.05:
            break
        times *= 2
    found = []
    for _ in range(REPEATS):
        begin = time.process_time()
        function(kind, times)
        found.append((time.process_time() - begin) / times / len(kind.elements))
    return 1e6 * statistics.median(found)


def scene(gauss_points: int, *, equal: bool) -> ShellMeshes:
    """A plate whose elements share the blocks of their nodes; of equal elements, or all different ones."""
    far = [1.0, 0.0, 0.0] if equal else [1.2, 0.1, 0.0]
    mesh = quadrilateral([[0.0, 0.0, 0.0], far, [1.0, 0.7, 0.0], [0.0, 0.7, 0.0]], *MESH)
    body = ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(0.01, 7850.0, 2.1e11, 0.3),),
        gauss_points=gauss_points,
    )
    shared = body_constants(body)
    data = list({id(block): block for block in element_data(body)}.values())
    constants = aligned(len(shared) + sum(map(len, data)))
    constants[:] = np.concatenate([shared, *data])
    first = dict(zip(map(id, data), len(shared) + len(data[0]) * np.arange(len(data)), strict=True))
    elements = records(ShellMeshElement, len(mesh.elements))
    elements["nodes"] = mesh.elements * LANES
    elements["data"] = [first[id(block)] for block in element_data(body)]
    counts = strain_counts(body)
    elements["strain"] = np.cumsum(counts) - counts
    places: dict[tuple[int, int], int] = {}
    for line in elements:
        for p, (i, j) in enumerate(SHELL_PAIRS):
            m, n = int(line.nodes[i]), int(line.nodes[j])
            place = places.setdefault((max(m, n), min(m, n)), len(places) * ROWS * LANES)
            line.blocks[p] = place, int(m < n)
    table = records(ShellPlaces, 1)
    table[0].element_count = len(elements)
    start = start_coordinates(body)
    start += 0.05 * np.random.default_rng(0).normal(size=start.shape)
    nodal = {name: aligned(len(start) * LANES) for name in NODAL_VECTORS}
    for name in ("position", "velocity"):
        nodal[name].reshape(-1, LANES)[:, :ROWS] = start.reshape(-1, ROWS)
    given = {
        "table": table,
        "elements": elements,
        "constants": constants,
        "body": records(MeshNumbers, 1),
        **nodal,
        **{name: aligned(int(counts.sum())) for name in STRAIN_VECTORS},
        "blocks": aligned(len(places) * ROWS * LANES),
    }
    return partly(ShellMeshes, **given)


def main() -> None:
    for equal in (True, False):
        print(f"plate of {MESH[0]} x {MESH[1]} {'equal' if equal else 'different'} elements, us an element")
        for gauss_points in (4, 5, 7):
            kind = scene(gauss_points, equal=equal)
            numbers = "  ".join(f"{name} {measured(f, kind):.3f}" for name, f in KERNELS.items())
            print(f"  {gauss_points} x {gauss_points}: {numbers}")


if __name__ == "__main__":
    main()
