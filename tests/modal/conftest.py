"""Small finite element models that the tests of `modal` share."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import Material

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
