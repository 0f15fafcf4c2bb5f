"""Point mass on a soft beam: independent solutions, full model and regularised contact.

Uses nothing of the package: own bricks (Taylor, Beresford and Wilson 1976), own block factorisation, central
differences of the full model, and a Krylov model with an exact propagator for the regularised variant.

    python make_reference.py full --write    # full_A.csv, full_B.csv: hard contact on a spline, 50 x 10 x 10 bricks
    python make_reference.py node            # the same at one node and along y, as it is mostly modelled
    python make_reference.py regularised 100 --write   # regularised_A.csv, regularised_B.csv (2 GB, a minute)
    python make_reference.py statics         # part of the contact compliance that eigenmodes catch
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.linalg import cho_factor, cho_solve, eigh, expm
from scipy.sparse import coo_array
from scipy.sparse.linalg import LinearOperator, eigsh

HERE = Path(__file__).resolve().parent
LENGTH, SIDE = 0.25, 0.05  # m
YOUNG, POISSON, DENSITY = 50e6, 0.3, 920.0  # Pa, -, kg/m^3
KAPPA = 5.8925e-4
MASS, SPEED, GAP = 0.5, -0.2, 2e-3  # kg, m/s, m
DURATION, OUTPUT = 0.1, 1e-4  # s
CONTACT = {"A": 25e-3, "B": 40e-3}  # z of the point [m]
FOOTPRINT = {"A": 25e-3, "B": 38e-3}  # z of the middle of the disc [m]
BOX = {"A": ((0.22, 0.01), (0.25, 0.04)), "B": ((0.22, 0.02), (0.25, 0.05))}  # corners x, z of the spline [m]
CONTACT_X, RADIUS, BETA = 0.235, 10e-3, 1e-4  # m, m, s
SIGNS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
)


def strains(gradients):
    """Strain operator (6, 3 n) from gradients of n shape functions (n, 3), engineering shear."""
    B = np.zeros((6, 3 * len(gradients)))
    for n, (x, y, z) in enumerate(gradients):
        B[:, 3 * n : 3 * n + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
    return B


def brick(edges, reduced=False):
    """Stiffness of a rectangular brick, (24, 24) [N/m].

    With incompatible modes, condensed; or with one point and the hourglass stiffness of the published matrices,
    kappa G V / h_d^2 for each of the four hourglass vectors and each direction d.
    """
    lam = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    mu = YOUNG / (2 * (1 + POISSON))
    D = np.zeros((6, 6))
    D[:3, :3] = lam
    D += np.diag([2 * mu] * 3 + [mu] * 3)
    volume = np.prod(edges)
    if reduced:
        B = strains(SIGNS / 8 * 2 / edges)
        x, y, z = SIGNS.T
        gamma = np.array([y * z, z * x, x * y, x * y * z])
        return volume * (B.T @ D @ B + KAPPA * mu * np.kron(gamma.T @ gamma, np.diag(1 / edges**2)))
    K = np.zeros((33, 33))
    for xi in SIGNS / np.sqrt(3):
        gradients = np.empty((11, 3))
        for k in range(3):
            others = [j for j in range(3) if j != k]
            gradients[:8, k] = SIGNS[:, k] * np.prod(1 + SIGNS[:, others] * xi[others], axis=1) / 8
        gradients[8:] = np.diag(-2 * xi)
        B = strains(gradients * 2 / edges)
        K += B.T @ D @ B * volume / 8
    return K[:24, :24] - K[:24, 24:] @ np.linalg.solve(K[24:, 24:], K[24:, :24])


class Beam:
    """A prism of bricks, clamped at x = 0: every layer of bricks has the same matrix of its two cross-sections.

    Displacements have shape (sections, 3 ny nz) without the clamped section.
    """

    def __init__(self, nx, ny, nz, length=LENGTH, reduced=False):
        self.counts, self.edges = (nx, ny, nz), np.array([length / nx, SIDE / ny, SIDE / nz])
        self.size = 3 * (ny + 1) * (nz + 1)
        j, k = (grid.ravel() for grid in np.meshgrid(np.arange(ny), np.arange(nz), indexing="ij"))
        corner = (SIGNS + 1) // 2
        nodes = (
            corner[:, 0] * (ny + 1) * (nz + 1)
            + (j[:, None] + corner[:, 1]) * (nz + 1)
            + k[:, None]
            + corner[:, 2]
        )
        dofs = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), 24)
        rows, columns = np.repeat(dofs, 24, axis=1), np.tile(dofs, (1, 24))
        values = np.tile(brick(self.edges, reduced).ravel(), len(nodes))
        s = self.size
        layer = coo_array((values, (rows.ravel(), columns.ravel())), shape=(2 * s, 2 * s)).tocsr()
        self.first, self.between, self.second = (
            layer[:s, :s].tocsr(),
            layer[:s, s:].tocsr(),
            layer[s:, s:].tocsr(),
        )
        self.between_t = self.between.T.tocsr()
        weight = np.zeros(2 * (ny + 1) * (nz + 1))
        np.add.at(weight, nodes.ravel(), DENSITY * np.prod(self.edges) / 8)
        half = np.repeat(weight[: s // 3], 3)
        self.mass = np.tile(2 * half, (nx, 1))
        self.mass[-1] = half

    def node(self, x, y, z):
        """Section and cross-section number of the node at a point; None unless there is one."""
        place = np.array([x, y, z]) / self.edges
        i, j, k = np.rint(place).astype(int)
        assert np.allclose(place, (i, j, k))
        return i - 1, j * (self.counts[2] + 1) + k

    def stiffness(self, u):
        """K u."""
        U = u.T
        f = self.second @ U
        f[:, :-1] += self.first @ U[:, :-1] + self.between @ U[:, 1:]
        f[:, 1:] += self.between_t @ U[:, :-1]
        return f.T

    def factorise(self):
        """Block elimination from the clamped section on; one dense Cholesky factor a section."""
        full = (self.first + self.second).toarray()
        self.factors, schur = [], full
        for i in range(self.counts[0]):
            self.factors.append(cho_factor(schur, lower=True, check_finite=False))
            if i + 1 < self.counts[0]:
                block = self.second.toarray() if i + 2 == self.counts[0] else full
                solved = cho_solve(self.factors[-1], self.between.toarray(), check_finite=False)
                schur = block - self.between_t @ solved

    def solve(self, f):
        """K^-1 f."""
        x = f.copy()
        for i in range(1, len(x)):
            x[i] -= self.between_t @ cho_solve(self.factors[i - 1], x[i - 1], check_finite=False)
        x[-1] = cho_solve(self.factors[-1], x[-1], check_finite=False)
        for i in range(len(x) - 2, -1, -1):
            x[i] = cho_solve(self.factors[i], x[i] - self.between @ x[i + 1], check_finite=False)
        return x

    def footprint(self, z0):
        """Consistent load of the disc with the weight (1 - r^2/R^2)^2, resultant 1 along y."""
        nx, ny, nz = self.counts
        cells = int(np.ceil(24 * self.edges[0] / RADIUS))
        gauss, weight = np.polynomial.legendre.leggauss(4)
        line = ((np.arange(cells)[:, None] + 0.5 * (gauss + 1)) / cells).ravel()
        weight = np.tile(weight / cells / 2, cells)
        b = np.zeros((nx, self.size))
        shape = np.array([1 - line, line])
        for i in range(nx):
            for k in range(nz):
                x, z = (i + line) * self.edges[0] - CONTACT_X, (k + line) * self.edges[2] - z0
                w = np.maximum(1 - (x[:, None] ** 2 + z**2) / RADIUS**2, 0) ** 2 * weight[:, None] * weight
                if not w.any():
                    continue
                share = shape @ w @ shape.T
                for p in range(2):
                    for q in range(2):
                        if i + p:
                            b[i + p - 1, 3 * (ny * (nz + 1) + k + q) + 1] += share[p, q]
        return b / b.sum()


def run_node(setup, factor):
    """Central differences with the lumped masses of all nodes, hard contact on the positions of each new step.

    Returns the times [s] and height of the mass over the undeformed face [m], its velocity [m/s], the displacement of
    node 19 at (250, 50, 25) mm [m], and the impulse so far [N s].
    """
    beam = Beam(50, 10, 10)
    section, number = beam.node(CONTACT_X, SIDE, CONTACT[setup])
    row = 3 * number + 1
    tip, other = beam.node(LENGTH, SIDE, 0.5 * SIDE)
    h = OUTPUT / factor
    count = factor * round(DURATION / OUTPUT)
    rate = h**2 / beam.mass
    u = old = np.zeros_like(beam.mass)
    y, y_old, impulse = GAP, GAP - h * SPEED, 0.0
    soft = rate[section, row] + h**2 / MASS
    rows = [(0.0, GAP, SPEED, 0.0, 0.0)]
    for step in range(1, count + 1):
        new = 2 * u - old - rate * beam.stiffness(u)
        y_new = 2 * y - y_old
        force = max(0.0, (new[section, row] - y_new) / soft)
        new[section, row] -= rate[section, row] * force
        y_new += h**2 / MASS * force
        impulse += h * force
        u, old, y, y_old = new, u, y_new, y
        if step % factor == 0:
            # velocity at the time of the row: at the end of the step, without half of its own force
            velocity = (y - y_old) / h - 0.5 * h * force / MASS
            rows.append((step * h, y, velocity, u[tip, 3 * other + 1], impulse))
    return np.array(rows)


class Contour:
    """Bicubic spline through the displaced nodes of the upper face in a box: cardinal functions of the nodes."""

    def __init__(self, beam, low, high):
        _, ny, nz = beam.counts
        i = np.arange(round(low[0] / beam.edges[0]), round(high[0] / beam.edges[0]) + 1)
        k = np.arange(round(low[1] / beam.edges[2]), round(high[1] / beam.edges[2]) + 1)
        self.shape = (len(i), len(k))
        self.rows = np.repeat(i - 1, len(k)), np.tile(ny * (nz + 1) + k, len(i))
        self.start = np.stack(
            [
                np.repeat(i * beam.edges[0], len(k)),
                np.full(len(i) * len(k), SIDE),
                np.tile(k * beam.edges[2], len(i)),
            ],
            1,
        )
        self.splines = [make_interp_spline(np.linspace(0, 1, n), np.eye(n), k=3) for n in self.shape]
        self.derived = [[spline.derivative(d) for d in (1, 2)] for spline in self.splines]
        self.at = np.array([0.5, 0.5])

    def values(self, order, uv):
        """Derivatives of the cardinal functions, shape (number of nodes,)."""
        parts = [
            (spline if d == 0 else more[d - 1])(x)
            for spline, more, d, x in zip(self.splines, self.derived, order, uv, strict=True)
        ]
        return np.outer(*parts).ravel()

    def touch(self, u, point):
        """Signed distance of a point, outward normal and weights of the nodes; u are all displacements."""
        nodes = self.start + u.reshape(len(u), -1, 3)[self.rows]
        for _ in range(20):
            w = self.values((0, 0), self.at)
            away = point - w @ nodes
            along = np.array([self.values(o, self.at) @ nodes for o in ((1, 0), (0, 1))])
            second = [self.values(o, self.at) @ nodes for o in ((2, 0), (1, 1), (0, 2))]
            bend = np.array([[away @ second[0], away @ second[1]], [away @ second[1], away @ second[2]]])
            change = np.linalg.solve(along @ along.T - bend, along @ away)
            self.at = np.clip(self.at + change, 0.0, 1.0)
            if np.abs(change).max() < 1e-12:
                break
        normal = np.cross(along[1], along[0])
        normal /= np.linalg.norm(normal)
        return normal @ away, normal, w


def run_contour(setup, factor):
    """As `run_node`, but the mass moves in space and touches a spline through the nodes of the upper face."""
    beam = Beam(50, 10, 10)
    contour = Contour(beam, *BOX[setup])
    h = OUTPUT / factor
    rate = h**2 / beam.mass
    at_nodes = rate.reshape(len(rate), -1, 3)[contour.rows]
    u = old = np.zeros_like(beam.mass)
    speed = np.array([0.0, SPEED, 0.0])
    point = np.array([CONTACT_X, SIDE + GAP, CONTACT[setup]])
    before = point - h * speed
    rows = [(0.0, GAP, SPEED, 0.0, 0.0)]
    for step in range(1, factor * round(DURATION / OUTPUT) + 1):
        new = 2 * u - old - rate * beam.stiffness(u)
        ahead = 2 * point - before
        total = np.zeros(3)
        gap, normal, w = contour.touch(new, ahead) if ahead[1] < SIDE + 0.5e-3 else (1.0, None, None)
        while gap < -1e-13:
            push = normal * (-gap / (h**2 / MASS + (w**2) @ (at_nodes @ normal**2)))
            new.reshape(len(new), -1, 3)[contour.rows] -= at_nodes * np.outer(w, push)
            ahead = ahead + h**2 / MASS * push
            total += push
            gap, normal, w = contour.touch(new, ahead)
        u, old, point, before = new, u, ahead, point
        if step % factor == 0:
            velocity = (point - before) / h - 0.5 * h * total / MASS
            rows.append((step * h, point[1] - SIDE, velocity[1], 0.0, 0.0))
    return np.array(rows)


def krylov(beam, b, order):
    """Mass-orthonormal vectors K^-1 b, K^-1 M K^-1 b, ... as eigenvalues and their shapes, (order, ...)."""
    vectors = []
    load = b
    for _ in range(order):
        v = beam.solve(load)
        for _ in range(2):
            for w in vectors:
                v = v - w * np.sum(w * beam.mass * v)
        v = v / np.sqrt(np.sum(v * beam.mass * v))
        vectors.append(v)
        load = beam.mass * v
    V = np.array(vectors)
    K = np.array([[np.sum(v * f) for v in V] for f in map(beam.stiffness, V)])
    values, axes = eigh(0.5 * (K + K.T))
    return values, np.tensordot(axes.T, V, axes=1)


def propagator(value, beta, h):
    """Exact step of q'' + beta w^2 q' + w^2 q = f with a constant f: (2, 2) and (2,)."""
    A = np.zeros((3, 3))
    A[0, 1] = 1.0
    A[1] = [-value, -beta * value, 1.0]
    E = expm(h * A)
    return E[:2, :2], E[:2, 2]


def run_modes(values, at_contact, at_tip, beta, h):
    """Hard contact on the positions of each new step; modes move exactly under the constant force of a step."""
    steps = [propagator(value, beta, h) for value in values]
    P = np.array([E for E, _ in steps])
    F = np.array([f for _, f in steps])
    q, v = np.zeros(len(values)), np.zeros(len(values))
    y, speed, impulse = GAP, SPEED, 0.0
    soft = np.sum(at_contact**2 * F[:, 0]) + 0.5 * h**2 / MASS
    every, count = round(OUTPUT / h), round(DURATION / h)
    rows = [(0.0, y, speed, 0.0, 0.0)]
    pull_q, pull_v = F[:, 0] * at_contact, F[:, 1] * at_contact
    for step in range(1, count + 1):
        q, v = P[:, 0, 0] * q + P[:, 0, 1] * v, P[:, 1, 0] * q + P[:, 1, 1] * v
        y += h * speed
        depth = at_contact @ q - y
        if depth > 0.0:
            force = depth / soft
            q -= pull_q * force
            v -= pull_v * force
            y += 0.5 * h**2 / MASS * force
            speed += h * force / MASS
            impulse += h * force
        if step % every == 0:
            rows.append((step * h, y, speed, at_tip @ q, impulse))
    return np.array(rows)


def run_regularised(beam, setup, h=2e-6, order=30):
    """Disc of 10 mm, stiffness-proportional damping; the beam is factorised."""
    cross = beam.counts[1]
    b = beam.footprint(FOOTPRINT[setup])
    values, shapes = krylov(beam, b, order)
    section = shapes[:, -1].reshape(order, cross + 1, cross + 1, 3)[:, -1, :, 1]
    middle = 0.5 * (section[:, cross // 2] + section[:, (cross + 1) // 2])
    return run_modes(values, np.tensordot(shapes, b, axes=2), middle, BETA, h)


def statics(count=50, modes=(10, 100)):
    """Part of b^T K^-1 b at a node that the first eigenmodes catch."""
    beam = Beam(count, count // 5, count // 5)
    beam.factorise()
    b = np.zeros_like(beam.mass)
    section, number = beam.node(CONTACT_X, SIDE, CONTACT["A"])
    b[section, 3 * number + 1] = 1.0
    exact = np.sum(b * beam.solve(b))
    say(f"compliance {exact * 1e6:.6g} mm/kN")
    root = np.sqrt(beam.mass)
    operator = LinearOperator(
        (b.size, b.size), matvec=lambda x: (root * beam.solve(root * x.reshape(b.shape))).ravel(), dtype=float
    )
    values, vectors = eigsh(operator, max(modes), which="LM")
    order = np.argsort(-values)
    shapes = vectors[:, order].T.reshape(-1, *b.shape) / root
    share = np.cumsum(shapes[:, section, 3 * number + 1] ** 2 * values[order]) / exact
    for n in modes:
        say(
            f"{n} eigenmodes: {100 * share[n - 1]:.2f} %; f1 = {1 / np.sqrt(values.max()) / 2 / np.pi:.4f} Hz"
        )


def say(text):
    """One line on standard output."""
    sys.stdout.write(text + "\n")


def references():
    """Tables of time [s] and velocity of the mass along y [m/s] by file name, shape (1001, 2)."""
    beam = Beam(100, 20, 20)
    beam.factorise()
    found = {}
    for setup in "AB":
        found[f"regularised_{setup}.csv"] = run_regularised(beam, setup)[:, [0, 2]]
        found[f"full_{setup}.csv"] = run_contour(setup, 32)[:, [0, 2]]
    return found


def write(name, rows):
    """Velocity of the mass along y [m/s] over time [s]."""
    text = ["time,y", *(f"{row[0]:.6g},{row[2]:.11g}" for row in rows)]
    (HERE / name).write_text("\n".join(text) + "\n", encoding="utf-8")


def main():
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=["full", "node", "regularised", "statics"])
    parser.add_argument("bricks", type=int, nargs="?", default=50)
    parser.add_argument(
        "--factor", type=int, default=32, help="steps of central differences an output interval"
    )
    parser.add_argument("--step", type=float, default=2e-6)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if options.what == "statics":
        statics(options.bricks)
        return
    if options.what == "regularised":
        beam = Beam(options.bricks, options.bricks // 5, options.bricks // 5)
        beam.factorise()
    for setup in "AB":
        if options.what in {"full", "node"}:
            runner = {"full": run_contour, "node": run_node}[options.what]
            rows = runner(setup, options.factor)
            step = 1e6 * OUTPUT / options.factor
            words = f"setup {setup}: {options.what}, 50 x 10 x 10 bricks, central differences, steps of {step:g} us"
        else:
            rows = run_regularised(beam, setup, options.step)
            words = f"setup {setup}: disc of 10 mm, damping 1e-4 s x K, {options.bricks} bricks, 30 Krylov vectors"
        say(f"{words}: end velocity {1e3 * rows[-1, 2]:.3f} mm/s")
        if options.write:
            write(f"{options.what}_{setup}.csv", rows)


if __name__ == "__main__":
    main()
