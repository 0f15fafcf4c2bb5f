"""Small finite element models that the tests of `modal` share."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_array

from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import FEModel, MassPoints, Material

LENGTH, HEIGHT, WIDTH = 1.0, 0.1, 0.06


def beam(element_type, size, mass, poisson_ratio=0.3):
    """Steel beam along x, group ``clamp`` at x = 0, group ``tip`` at x = 1 m."""
    mesh = mesh_blocks(
        [Box("beam", (0, 0, 0), (LENGTH, HEIGHT, WIDTH))],
        element_type=element_type,
        size=size,
        groups=(OnPlane("clamp", "x", 0.0), OnPlane("tip", "x", LENGTH)),
    )
    material = Material(young_modulus=2.1e11, poisson_ratio=poisson_ratio, density=7850.0)
    return assemble(mesh, material, mass=mass)


@pytest.fixture(scope="session")
def tet_beam():
    """Quadratic tetrahedra, consistent mass."""
    return beam("tet10", 0.1, "consistent")


@pytest.fixture(scope="session")
def brick_beam():
    """Bricks, lumped mass."""
    return beam("hex8", 0.04, "lumped")


@pytest.fixture(scope="session")
def quadratic_brick_beam(with_middle_nodes):
    """Bricks of 20 nodes, consistent mass."""
    coarse = beam("hex8", 0.1, "consistent")
    mesh = with_middle_nodes(coarse.mesh)
    ends = {
        "clamp": np.flatnonzero(mesh.nodes[:, 0] == 0.0),
        "tip": np.flatnonzero(mesh.nodes[:, 0] == LENGTH),
    }
    return assemble(mesh.with_groups(ends), coarse.material)


@pytest.fixture(params=["tet_beam", "brick_beam", "quadratic_brick_beam"])
def beam_of_any_faces(request):
    """All kinds of elements, whose faces differ, one after the other."""
    return request.getfixturevalue(request.param)


@pytest.fixture(params=["tet_beam", "brick_beam"])
def any_beam(request):
    """Both kinds of mass and element, one after the other."""
    return request.getfixturevalue(request.param)


@pytest.fixture
def dense():
    """Dense reference solutions of a model: full matrices, and those of its free degrees of freedom."""

    def matrices(model, fixed=()):
        keep = np.setdiff1d(np.arange(model.node_count), fixed)
        rows = (3 * keep[:, None] + np.arange(3)).ravel()
        K = model.stiffness.toarray()
        M = np.kron(model.mass.toarray(), np.eye(3))
        return SimpleNamespace(
            K=K, M=M, rows=rows, K_free=K[np.ix_(rows, rows)], M_free=M[np.ix_(rows, rows)]
        )

    return matrices


STEEL_BEAM = SimpleNamespace(length=2.0, side=0.05, young=2.1e11, shear=8.0e10, density=7850.0)


@pytest.fixture(scope="session")
def beam_chain():
    """Slender square steel beam along x: elements of Hermite's cubics, masses at nodes.

    ``rotary`` gives each node the rotary inertia of its piece by pairs of points; without it rotations have no mass.
    """

    def make(count, *, rotary=False, extra=()):
        """``extra``: (node, mass, offset) of points besides."""
        data = STEEL_BEAM
        n, h = count + 1, data.length / count
        area, second = data.side**2, data.side**4 / 12.0
        nodes = np.column_stack([np.linspace(0.0, data.length, n), np.zeros(n), np.zeros(n)])
        bending = np.array(
            [
                [12.0, 6 * h, -12.0, 6 * h],
                [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                [-12.0, -6 * h, 12.0, -6 * h],
                [6 * h, 2 * h * h, -6 * h, 4 * h * h],
            ]
        )
        bending *= data.young * second / h**3
        bar = np.array([[1.0, -1.0], [-1.0, 1.0]]) / h
        K = np.zeros((6 * n, 6 * n))
        for a in range(count):
            u, v, w = (np.array([3 * a, 3 * a + 3]) + k for k in range(3))
            p, q, r = (3 * n + np.array([3 * a, 3 * a + 3]) + k for k in range(3))
            K[np.ix_(u, u)] += data.young * area * bar
            K[np.ix_(p, p)] += data.shear * 2.0 * second * bar
            for deflection, turn, sign in ((v, r, 1.0), (w, q, -1.0)):
                dofs = np.array([deflection[0], turn[0], deflection[1], turn[1]])
                signs = np.array([1.0, sign, 1.0, sign])
                K[np.ix_(dofs, dofs)] += bending * np.outer(signs, signs)
        piece = np.full(n, data.density * area * h)
        piece[[0, -1]] *= 0.5
        places = [(a, piece[a], np.zeros(3)) for a in range(n)]
        if rotary:  # two pairs at +-side/sqrt(12) across: polar inertia m side^2/6, no mass in sum
            arm = data.side / np.sqrt(12.0)
            for a in range(n):
                places[a] = (a, -piece[a], np.zeros(3))
                places += [(a, 0.5 * piece[a], s * arm * np.eye(3)[k]) for k in (1, 2) for s in (-1.0, 1.0)]
        places += [(a, mass, np.asarray(offset)) for a, mass, offset in extra]
        operator = np.zeros((3 * len(places), 6 * n))
        for i, (a, _, offset) in enumerate(places):
            operator[3 * i : 3 * i + 3, 3 * a : 3 * a + 3] = np.eye(3)
            operator[3 * i : 3 * i + 3, 3 * (n + a) : 3 * (n + a) + 3] = np.cross(np.eye(3), offset).T
        points = MassPoints(
            np.array([nodes[a] + offset for a, _, offset in places]),
            np.array([mass for _, mass, _ in places]),
            csr_array(operator),
        )
        return FEModel(
            nodes,
            csr_array(K),
            points.matrix(),
            rotating=np.arange(n),
            points=points,
            node_groups={"root": np.array([0]), "tip": np.array([n - 1])},
            name="beam chain",
        )

    return make
