"""Bead on a soft cantilever: loaded frequencies and histories by an independent program.

The bricks and their solver are those of the case point_mass_on_beam, which use nothing of the package. Here the bead
and the shape coordinates of the beam are integrated without any constraint: the place of the bead along the line of
contact is a coordinate itself.

    python make_reference.py frequencies     # first frequency with the mass of the bead attached to the beam
    python make_reference.py histories       # thesis_mesh.csv, converged.csv
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline
from scipy.sparse.linalg import LinearOperator, eigsh

HERE = Path(__file__).resolve().parent
SPEC = importlib.util.spec_from_file_location(
    "soft_beam", HERE.parent / "point_mass_on_beam" / "make_reference.py"
)
soft_beam = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(soft_beam)

LENGTH, MASS = 1.5, 1.0  # m, kg
START, VELOCITY = 1.35, np.array([0.01, -0.002, 0.0])  # m, m/s
DURATION, OUTPUT = 5.0, 0.02  # s
STATICS = (1.1, 1.2, 1.3, 1.4, 1.5)  # where unit forces along y give static vectors [m]
MESHES = {  # bricks across, reduced integration, z of the line above the lower face [m], eigenmodes, static vectors
    "thesis_mesh": (2, True, 0.0, 20, ()),
    "converged": (4, False, 0.025, 10, STATICS),
}


def eigenmodes(beam, count, mass=None):
    """Eigenvalues and mass-orthonormal shapes (count, ...) of the beam, which is factorised."""
    root = np.sqrt(beam.mass if mass is None else mass)
    operator = LinearOperator(
        (root.size, root.size),
        matvec=lambda x: (root * beam.solve(root * x.reshape(root.shape))).ravel(),
        dtype=float,
    )
    values, vectors = eigsh(operator, count, which="LM", tol=1e-12)
    order = np.argsort(-values)
    return 1.0 / values[order], vectors[:, order].T.reshape(-1, *root.shape) / root


def frequencies(name):
    """First frequency alone, and with the mass of the bead at three places of its way, moving along y [Hz]."""
    across, reduced, z, _, _ = MESHES[name]
    beam = soft_beam.Beam(60, across, across, LENGTH, reduced)
    beam.factorise()
    found = [eigenmodes(beam, 2)[0][0]]
    for x in (1.35, 1.375, 1.4):
        section, number = beam.node(x, 0.5 * soft_beam.SIDE, z)
        mass = beam.mass.copy()
        mass[section, 3 * number + 1] += MASS
        found.append(eigenmodes(beam, 2, mass)[0][0])
    return np.sqrt(found) / (2.0 * np.pi)


def shapes_on_line(name):
    """Eigenvalues of the reduced beam, and its shapes along the line of contact as splines of x."""
    across, reduced, z, count, places = MESHES[name]
    beam = soft_beam.Beam(60, across, across, LENGTH, reduced)
    beam.factorise()
    values, shapes = eigenmodes(beam, count)
    _, number = beam.node(START, 0.5 * soft_beam.SIDE, z)
    loads = np.zeros((len(places), *beam.mass.shape))
    for load, x in zip(loads, places, strict=True):
        load[beam.node(x, 0.5 * soft_beam.SIDE, z)[0], 3 * number + 1] = 1.0
    vectors = [*shapes, *(beam.solve(load) for load in loads)]
    basis = []
    for vector in vectors:
        new = vector
        for _ in range(2):
            for other in basis:
                new = new - other * np.sum(other * beam.mass * new)
        basis.append(new / np.sqrt(np.sum(new * beam.mass * new)))
    V = np.array(basis)
    K = np.array([[np.sum(v * f) for v in V] for f in map(beam.stiffness, V)])
    values, axes = np.linalg.eigh(0.5 * (K + K.T))
    V = np.tensordot(axes.T, V, axes=1)
    line = np.zeros((61, 3, len(V)))
    line[1:] = V[:, :, 3 * number : 3 * number + 3].transpose(1, 2, 0)
    return values, make_interp_spline(np.linspace(0.0, LENGTH, 61), line, k=3)


def history(name):
    """Times [s] and places of the bead [m]; it hits the beam, which is at rest, at t = 0 and does not leave it."""
    values, spline = shapes_on_line(name)
    first, second = spline.derivative(1), spline.derivative(2)
    n = len(values)
    mass = np.diag([*np.ones(n), 0.0])

    def jacobian(q, s):
        along = first(s) @ q
        along[0] += 1.0
        return np.column_stack([spline(s), along])

    def rate(_, y):
        q, s, v = y[:n], y[n], y[n + 1 :]
        J = jacobian(q, s)
        curved = 2.0 * v[n] * (first(s) @ v[:n]) + v[n] ** 2 * (second(s) @ q)
        force = -MASS * J.T @ curved
        force[:n] -= values * q
        return np.concatenate([v, np.linalg.solve(mass + MASS * J.T @ J, force)])

    J = jacobian(np.zeros(n), START)
    start = np.linalg.solve(mass + MASS * J.T @ J, MASS * J.T @ VELOCITY)
    say(f"{name}: velocity along y after the impact {1e3 * (J @ start)[1]:.4f} mm/s")
    y0 = np.concatenate([np.zeros(n), [START], start])
    times = OUTPUT * np.arange(round(DURATION / OUTPUT) + 1)
    found = solve_ivp(rate, (0.0, DURATION), y0, "DOP853", times, rtol=1e-10, atol=1e-13)
    places = np.array([[y[n], 0.0, 0.0] + spline(y[n]) @ y[:n] for y in found.y.T])
    return times, places


def say(text):
    """One line on standard output."""
    sys.stdout.write(text + "\n")


def references():
    """Tables of time [s] and place x, y of the bead [m] by file name, shape (251, 3)."""
    found = {}
    for name in MESHES:
        times, places = history(name)
        found[f"{name}.csv"] = np.column_stack([times, places[:, :2]])
    return found


def main():
    """Command line."""
    for name in MESHES:
        if "frequencies" in sys.argv:
            alone, *loaded = frequencies(name)
            say(f"{name}: {alone:.5f} Hz; with the bead at 1.35, 1.375, 1.4 m: {np.round(loaded, 5)} Hz")
    if "histories" in sys.argv:
        for name, table in references().items():
            low, high = 1e3 * table[:, 2].min(), 1e3 * table[:, 2].max()
            say(f"{name}: y {low:.4f} to {high:.4f} mm, x at the end {1e3 * table[-1, 1]:.4f} mm")
            rows = [f"{t:.6g},{x:.12g},{y:.9g}" for t, x, y in table]
            (HERE / name).write_text("\n".join(["time,x,y", *rows]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
