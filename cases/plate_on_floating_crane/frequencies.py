"""Natural frequencies of the scene at rest in which the plate deforms, from its stiffness and mass there.

    python frequencies.py steel_0.toml thin_0.toml

Eigenvalues of K x = w^2 M x along what the joints allow, without water: K of everything at the place of rest, membrane
forces of the sagging plate and tensions of ropes included. A mode counts if more than half of its kinetic energy is in
the plate and is not that of the plate as a rigid body.

A plate that is 400 times as stiff hardly sags: a twentieth of its frequencies is to be that of a linear flat plate by
scikit-fem, of which each equalizer holds the sum of five deflections.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.linalg import eigh, null_space
from skfem import Basis, BilinearForm, ElementQuadBFS, MeshQuad
from skfem.helpers import dd, ddot, trace

from heavylift.pipeline import load_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.solver.integrate.loop import start_scene
from heavylift.solver.layout import pack_scene
from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.equilibrium import find_equilibrium
from heavylift.solver.statics.mesh_system import MeshSystem

HERE = Path(__file__).resolve().parent
SHOWN = 4
STIFFER = 400.0
MODULUS = 210e9  # Pa
SIZE = (30.0, 20.0)  # m


def flat_plate(file: Path) -> list[float]:
    """Of the plate without membrane forces, on equal forces of five lines each, whose sum does not move [Hz]."""
    case = load_case(file)
    section = case.bodies["plate"].section
    t, nu, density = section.thickness, section.poisson_ratio, section.density
    D = MODULUS * t**3 / (12.0 * (1.0 - nu**2))
    basis = Basis(
        MeshQuad.init_tensor(
            *(np.linspace(0.0, side, count + 1) for side, count in zip(SIZE, (12, 8), strict=True))
        ),
        ElementQuadBFS(),
    )

    @BilinearForm
    def stiffness(u, v, _):
        return D * ((1.0 - nu) * ddot(dd(u), dd(v)) + nu * trace(dd(u)) * trace(dd(v)))

    @BilinearForm
    def mass(u, v, _):
        return density * t * u * v

    held = []
    for loader in case.equalizers:
        points = np.array([line.point[:2] for line in loader.lines]).T
        held.append(np.asarray(basis.probes(points).sum(axis=0)).ravel())
    allowed = null_space(np.array(held))
    K, M = (allowed.T @ form.assemble(basis).toarray() @ allowed for form in (stiffness, mass))
    return [float(f) for f in np.sqrt(eigh(K, M, eigvals_only=True)[:SHOWN]) / (2.0 * np.pi)]


def frequencies(file: Path, stiffer: float = 1.0) -> list[float]:
    """Of the modes in which the plate deforms [Hz]."""
    case = load_case(file, [f"bodies.plate.section.young_modulus={stiffer * MODULUS}"])
    layout = pack_scene(assemble_scene(case, OutputFolder(case.output_folder)))
    start_scene(layout.bodies, layout.work, 0.0)
    rows = StartRows(layout)
    find_equilibrium(rows)
    system = MeshSystem(rows)
    reactions = rows.column("reaction")
    K = system.tangent(1.0, reactions[rows.rigid]).toarray()
    M = system.mass.toarray()
    allowed = null_space(system.joints()[0].toarray())
    values, modes = eigh(allowed.T @ (0.5 * (K + K.T)) @ allowed, allowed.T @ M @ allowed)
    modes = allowed @ modes
    count = int(system.first[-1])
    plate, matrices = system.meshes[0], system.matrices[0]
    # rigid motions of the plate by its nodal vectors: shifts, and turns of positions and slopes alike
    place, vector, axis = matrices.places, matrices.vector, matrices.axis
    node = place // matrices.lanes
    rigid = np.zeros((count, 6))
    q = np.array(plate.position).reshape(-1, matrices.lanes)
    for k in range(3):
        rigid[(vector == 0) & (axis == k), k] = 1.0
        turned = np.cross(np.eye(3)[k], q[node[:, None], 3 * vector[:, None] + np.arange(3)])
        rigid[:, 3 + k] = turned[np.arange(count), axis]
    Mp = M[:count, :count]
    found = []
    for value, mode in zip(values, modes.T, strict=True):
        x = mode[:count]
        x = x - rigid @ np.linalg.solve(rigid.T @ Mp @ rigid, rigid.T @ Mp @ x)
        if value > 0.0 and x @ Mp @ x > 0.5:
            found.append(float(np.sqrt(value) / (2.0 * np.pi)))
        if len(found) == SHOWN:
            break
    return found


def main() -> None:
    """Print those of some cases."""
    for name in sys.argv[1:]:
        file = HERE / name
        stiff = [f / np.sqrt(STIFFER) for f in frequencies(file, STIFFER)]
        for words, found in (
            ("", frequencies(file)),
            (", as stiff as if it were flat", stiff),
            (", flat by scikit-fem", flat_plate(file)),
        ):
            sys.stdout.write(f"{name}{words}: {', '.join(f'{f:.4f}' for f in found)} Hz\n")


if __name__ == "__main__":
    main()
