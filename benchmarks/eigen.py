"""Time and memory of the factorisations and of the eigenproblem on the complex beam.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1 python benchmarks/eigen.py
    python benchmarks/eigen.py --size 1.75 --modes 30 --backend cholmod --mass lumped --free

Each backend runs in a process of its own, so that the peak memory is its own. Times are CPU seconds.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time

import numpy as np

from heavylift.modal.eigen import eigenmodes
from heavylift.modal.factor import available_backends
from heavylift.modal.flexibility import Flexibility
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import FEModel, Material

SIZES = (4.1, 1.72)  # edge lengths [mm]: about 13 000 and 110 000 degrees of freedom


def complex_beam(size: float, mass: str) -> FEModel:
    """Beam of "Deformable bodies ... sliding contacts" (2014), section 5.1; edge length in mm."""

    def box(name: str, lower: tuple[float, float, float], upper: tuple[float, float, float]) -> Box:
        return Box(name, *(tuple(1e-3 * value for value in corner) for corner in (lower, upper)))

    mesh = mesh_blocks(
        [box("plate", (0, 0, 0), (95, 10, 20)), box("tower", (95, 0, 5.13), (105, 34.22, 14.87))],
        [box("pocket", (23.15, 5, 5.13), (47.5, 10, 14.87))],
        element_type="tet10",
        size=1e-3 * size,
        groups=(OnPlane("clamp", "x", 0.0),),
    )
    return assemble(mesh, Material(2.1e11, 0.3, 7987.0), mass=mass)


def peak_gigabytes() -> float:
    """Largest resident memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def warm_up(backend: str) -> None:
    """Compile or load kernels and libraries outside the measurement."""
    mesh = mesh_blocks([Box("cube", (0, 0, 0), (1, 1, 1))], element_type="hex8", size=0.2)
    eigenmodes(assemble(mesh, Material(2.1e11, 0.3, 7987.0)), 8, backend=backend)


def measure(size: float, modes: int, backend: str, mass: str, free: bool) -> dict[str, object]:
    """One row of the table."""
    warm_up(backend)
    start = time.process_time()
    model = complex_beam(size, mass)
    mesh_and_assembly = time.process_time() - start
    before = peak_gigabytes()
    clamp = () if free else model.node_groups["clamp"]
    start = time.process_time()
    flexibility = Flexibility(model, clamp, backend=backend)
    factor = time.process_time() - start
    solves = {}
    for columns in (1, 8, 16):
        rhs = np.ones((flexibility.factor.size, columns))
        times = []
        for _ in range(3):
            start = time.process_time()
            flexibility.factor.solve(rhs)
            times.append(time.process_time() - start)
        solves[columns] = float(np.median(times))
    start = time.process_time()
    found = eigenmodes(model, modes, flexibility=flexibility)
    lanczos = time.process_time() - start
    return {
        "unknowns": flexibility.factor.size,
        "backend": found.backend,
        "entries_of_L_million": flexibility.factor.entries / 1e6,
        "mesh_and_assembly_s": mesh_and_assembly,
        "factor_s": factor,
        **{f"solve_{columns}_s": value for columns, value in solves.items()},
        "modes": modes,
        "lanczos_s": lanczos,
        "total_s": factor + lanczos,
        "peak_before_GB": before,
        "peak_GB": peak_gigabytes(),
        "largest_residual": float(found.residuals.max()),
        "f1_Hz": float(found.frequencies[0]),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=float, nargs="*", default=SIZES, help="edge lengths [mm]")
    parser.add_argument("--modes", type=int, default=30)
    parser.add_argument("--backend", nargs="*", default=available_backends())
    parser.add_argument("--mass", choices=("consistent", "lumped"), default="consistent")
    parser.add_argument("--free", action="store_true", help="no clamped face")
    parser.add_argument("--one", action="store_true", help="measure in this process")
    options = parser.parse_args()
    for size in options.size:
        for backend in options.backend:
            if options.one:
                row = measure(size, options.modes, backend, options.mass, options.free)
                print(json.dumps(row), flush=True)
                continue
            command = [sys.executable, __file__, "--one", "--size", str(size), "--backend", backend]
            command += [
                "--modes",
                str(options.modes),
                "--mass",
                options.mass,
                *(["--free"] if options.free else []),
            ]
            subprocess.run(command, check=True)


if __name__ == "__main__":
    main()
