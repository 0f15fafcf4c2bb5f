"""Time of the reduction of a plated block of 107 754 unknowns: factorisation, eigenmodes, attachment modes, integrals.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONPATH=. python benchmarks/block_modes.py
    PYTHONPATH=. python benchmarks/block_modes.py --fineness 2 --modes 26

Times are CPU seconds; fineness is the number of elements in half a metre.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from heavylift.modal import interfaces
from heavylift.modal.bases import eigenmode_basis, static_vectors
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduction import reduce_body
from heavylift.preprocess.structures.assemble import assemble_structure
from tests.verification.double_bottom import double_bottom

LIFTED = ((2.0, -3.0), (10.0, -3.0), (10.0, 3.0), (2.0, 3.0))


def measure(fineness: int, count: int) -> None:
    """Print a line a part of the reduction."""
    eigenmodes(assemble_structure(double_bottom(1)), 8)  # loads kernels and libraries
    begin = start = time.process_time()

    def lap(words: str) -> None:
        nonlocal start
        now = time.process_time()
        print(f"{words:55} {now - start:6.2f} s")
        start = now

    model = assemble_structure(double_bottom(fineness))
    lap(f"stiffness and mass of {model.dof_count} unknowns")
    body = Flexibility(model)
    lap(f"factor of {body.factor.entries / 1e6:.1f} million entries")
    modes = eigenmodes(model, count, flexibility=body)
    lap(f"{count} modes, {modes.frequencies[0]:.3f} to {modes.frequencies[-1]:.3f} Hz")
    basis = eigenmode_basis(modes)
    for x, y in LIFTED:
        near = np.linalg.norm(model.nodes - [x, y, 2.0], axis=1) < 0.5 + 1e-9
        nodes = np.flatnonzero(near & (np.abs(model.nodes[:, 2] - 2.0) < 1e-9))
        found = interfaces.fit(model, (x, y, 2.0), nodes, interfaces.group_weights(model, nodes))
        basis += static_vectors(body, interfaces.attachment_loads(model, found, f"({x}, {y})"))
    lap(f"{6 * len(LIFTED)} attachment modes")
    reduced = reduce_body(model, basis.vectors, basis.labels, mean_axis=True)
    lap(f"reduction to {reduced.mode_count} vectors")
    print(f"{'all':55} {start - begin:6.2f} s")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--fineness", type=int, default=3, help="elements in half a metre")
    parser.add_argument("--modes", type=int, default=40, help="number of eigenmodes")
    options = parser.parse_args()
    measure(options.fineness, options.modes)
