"""Natural frequencies of the scene at rest in which the plate deforms, from its stiffness and mass there.

    python frequencies.py steel_0.toml thin_0.toml

Eigenvalues of K x = w^2 M x along what the joints allow, without water: K of everything at the place of rest, membrane
forces of the sagging plate and tensions of ropes included. A mode counts if more than half of its kinetic energy is in
the plate and is not that of the plate as a rigid body.

A plate that is 400 times as stiff hardly sags: a twentieth of its frequencies is to be that of a linear flat plate by
scikit-fem, of which each equalizer holds the sum of five deflections. With its sag the plate is that of von Karman by
scikit-fem: displacements in the plane, biquadratic, and the deflection w of Bogner, Fox and Schmit, with the strains::

    e = sym grad u + grad w grad w^T / 2

in the balance that its weight brings about on equal forces of five lines. Hooks do not move there, and the plate is
of as many elements as that: `[12, 8]`.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import eigh, null_space
from scipy.sparse import block_array, csr_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from skfem import Basis, BilinearForm, ElementQuad2, ElementQuadBFS, ElementVector, LinearForm, MeshQuad
from skfem.helpers import dd, ddot, dot, grad, prod, sym_grad, trace, transpose

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
FINE = (12, 8)
GRAVITY = 9.81  # m/s^2
LOADS = np.geomspace(0.01, 1.0, 12)
"""Parts of the weight."""


def grid() -> MeshQuad:
    """Of the plate."""
    sides = zip(SIZE, FINE, strict=True)
    return MeshQuad.init_tensor(*(np.linspace(0.0, side, count + 1) for side, count in sides))


def held(case: Any, basis: Basis) -> np.ndarray:
    """Sum of the five deflections of each equalizer."""
    rows = []
    for loader in case.equalizers:
        points = np.array([line.point[:2] for line in loader.lines]).T
        rows.append(np.asarray(basis.probes(points).sum(axis=0)).ravel())
    return np.array(rows)


def sagging_plate(file: Path) -> list[float]:
    """Of the plate of von Karman as it hangs [Hz]."""
    case = load_case(file)
    section = case.bodies["plate"].section
    t, nu, mass = section.thickness, section.poisson_ratio, section.density * section.thickness
    C = MODULUS * t / (1.0 - nu**2)
    D = C * t**2 / 12.0
    deflection = Basis(grid(), ElementQuadBFS(), intorder=8)
    plane = Basis(grid(), ElementVector(ElementQuad2()), intorder=8)

    def stress(e):
        return C * ((1.0 - nu) * e + nu * trace(e) * np.eye(2)[:, :, None, None])

    def both(slope, v):
        tilted = prod(slope, grad(v))
        return 0.5 * (tilted + transpose(tilted))

    K_b = BilinearForm(
        lambda u, v, _: D * ((1.0 - nu) * ddot(dd(u), dd(v)) + nu * trace(dd(u)) * trace(dd(v)))
    ).assemble(deflection)
    K_uu = BilinearForm(lambda u, v, _: ddot(stress(sym_grad(u)), sym_grad(v))).assemble(plane)
    M_w = BilinearForm(lambda u, v, _: mass * u * v).assemble(deflection)
    M_u = BilinearForm(lambda u, v, _: mass * dot(u, v)).assemble(plane)
    weight = LinearForm(lambda v, _: -mass * GRAVITY * v).assemble(deflection)
    motions = (
        lambda x: np.array([1.0 + 0.0 * x[0], 0.0 * x[0]]),
        lambda x: np.array([0.0 * x[0], 1.0 + 0.0 * x[0]]),
        lambda x: np.array([-x[1], x[0]]),
    )
    R = np.array(
        [M_u @ plane.project(motion) for motion in motions]
    )  # nothing else holds the plate in its plane
    G = held(case, deflection)
    of_u, of_w = plane.N, deflection.N
    rows = np.zeros((len(R) + len(G), of_u + of_w))
    rows[: len(R), :of_u], rows[len(R) :, of_u:] = R / np.abs(R).max(), G
    scale = float(K_uu.diagonal().max())
    fixed = csr_array(scale * rows)

    def balance(x):
        """Inner forces and their derivative."""
        u, w = plane.interpolate(x[:of_u]), deflection.interpolate(x[of_u:])
        slope = grad(w)
        N = stress(sym_grad(u) + 0.5 * prod(slope, slope))
        force = np.concatenate(
            [
                LinearForm(lambda v, _: ddot(N, sym_grad(v))).assemble(plane),
                LinearForm(lambda v, _: ddot(N, both(slope, v))).assemble(deflection) + K_b @ x[of_u:],
            ]
        )
        K_ww = K_b + BilinearForm(
            lambda a, b, _: ddot(stress(both(slope, a)), both(slope, b)) + ddot(N, prod(grad(a), grad(b)))
        ).assemble(deflection)
        K_wu = BilinearForm(lambda a, b, _: ddot(stress(sym_grad(a)), both(slope, b))).assemble(
            plane, deflection
        )
        return force, block_array([[K_uu, K_wu.T], [K_wu, K_ww]])

    def factor(K):
        return splu(block_array([[K, fixed.T], [fixed, None]], format="csc"))

    x, pulls = np.zeros(of_u + of_w), np.zeros(len(rows))
    load = np.concatenate([np.zeros(of_u), weight])
    for part in LOADS:
        change = np.inf
        for _ in range(30):
            force, K = balance(x)
            left = part * load - force - fixed.T @ pulls
            step = factor(K).solve(np.concatenate([left, -(fixed @ x)]))
            x, pulls = x + step[: x.size], pulls + step[x.size :]
            change = np.abs(step[of_u : x.size]).max()
            if change < 1e-9:
                break
        if not change < 1e-9:
            return []
    K, M = balance(x)[1].tocsc(), block_array([[M_u, None], [None, M_w]], format="csc")
    solve, rest = factor(K).solve, np.zeros(len(rows))
    inverse = LinearOperator(K.shape, matvec=lambda b: solve(np.concatenate([np.ravel(b), rest]))[: x.size])
    values = eigsh(K, k=SHOWN, M=M, sigma=0.0, OPinv=inverse, return_eigenvectors=False)
    return [float(f) for f in np.sqrt(np.sort(values)) / (2.0 * np.pi)]


def flat_plate(file: Path) -> list[float]:
    """Of the plate without membrane forces, on equal forces of five lines each, whose sum does not move [Hz]."""
    case = load_case(file)
    section = case.bodies["plate"].section
    t, nu, density = section.thickness, section.poisson_ratio, section.density
    D = MODULUS * t**3 / (12.0 * (1.0 - nu**2))
    basis = Basis(grid(), ElementQuadBFS())

    @BilinearForm
    def stiffness(u, v, _):
        return D * ((1.0 - nu) * ddot(dd(u), dd(v)) + nu * trace(dd(u)) * trace(dd(v)))

    @BilinearForm
    def mass(u, v, _):
        return density * t * u * v

    allowed = null_space(held(case, basis))
    K, M = (allowed.T @ form.assemble(basis).toarray() @ allowed for form in (stiffness, mass))
    return [float(f) for f in np.sqrt(eigh(K, M, eigvals_only=True)[:SHOWN]) / (2.0 * np.pi)]


def frequencies(file: Path, stiffer: float = 1.0, elements: tuple[int, int] | None = None) -> list[float]:
    """Of the modes in which the plate deforms [Hz]."""
    changes = [f"bodies.plate.section.young_modulus={stiffer * MODULUS}"]
    if elements is not None:
        changes.append(f"bodies.plate.geometry.elements={list(elements)}")
    case = load_case(file, changes)
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
            (", of 12 x 8 elements", frequencies(file, elements=FINE)),
            (", of von Karman by scikit-fem", sagging_plate(file)),
        ):
            sys.stdout.write(f"{name}{words}: {', '.join(f'{f:.4f}' for f in found)} Hz\n")


if __name__ == "__main__":
    main()
