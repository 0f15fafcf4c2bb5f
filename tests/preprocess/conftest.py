"""The complex beam of *Deformable bodies ... sliding contacts* (2014), section 5.1, and small test meshes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import Material


def _box(name, lower, upper):
    return Box(name, tuple(1e-3 * v for v in lower), tuple(1e-3 * v for v in upper))


@pytest.fixture(scope="session")
def steel():
    return Material(young_modulus=2.1e11, poisson_ratio=0.3, density=7987.0)


@pytest.fixture(scope="session")
def complex_beam():
    """Boxes of the beam: plate with an open pocket, and an end block."""
    return SimpleNamespace(
        add=(_box("plate", (0, 0, 0), (95, 10, 20)), _box("tower", (95, 0, 5.13), (105, 34.22, 14.87))),
        cut=(_box("pocket", (23.15, 5, 5.13), (47.5, 10, 14.87)),),
        divisions={"x": (5, 5, 10, 2), "y": (1, 1, 5), "z": (1, 2, 1)},
        groups=(OnPlane("clamp", "x", 0.0),),
        volume=(95 * 10 * 20 - 24.35 * 5 * 9.74 + 10 * 34.22 * 9.74) * 1e-9,
    )


@pytest.fixture(scope="session")
def thesis_mesh(complex_beam):
    """The published mesh of 374 nodes and 178 bricks."""
    return mesh_blocks(
        complex_beam.add,
        complex_beam.cut,
        element_type="hex8",
        divisions=complex_beam.divisions,
        groups=complex_beam.groups,
    )


def _boundary(nodes):
    return ((nodes < 1e-9) | (nodes > 1 - 1e-9)).any(axis=1)


@pytest.fixture(scope="session")
def distorted_bricks():
    """Unit cube of 3 x 3 x 3 bricks, interior nodes moved at random."""
    mesh = mesh_blocks([Box("cube", (0, 0, 0), (1, 1, 1))], element_type="hex8", size=1 / 3)
    shift = np.random.default_rng(1).uniform(-0.09, 0.09, mesh.nodes.shape)
    inside = ~_boundary(mesh.nodes)
    return Mesh(mesh.nodes + shift * inside[:, None], mesh.elements, "hex8").check()


@pytest.fixture(scope="session")
def quadratic_bricks(distorted_bricks, with_middle_nodes):
    """The same with 20 nodes, those inside the cube moved, so that edges are bent."""
    mesh = with_middle_nodes(distorted_bricks)
    shift = np.random.default_rng(4).uniform(-0.01, 0.01, mesh.nodes.shape)
    return Mesh(mesh.nodes + shift * ~_boundary(mesh.nodes)[:, None], mesh.elements, "hex20").check()


@pytest.fixture(scope="session")
def straight_tetrahedra():
    """Unit cube of irregular straight-sided quadratic tetrahedra."""
    return mesh_blocks([Box("cube", (0, 0, 0), (1, 1, 1))], element_type="tet10", size=0.45)


@pytest.fixture(scope="session")
def curved_tetrahedra(straight_tetrahedra):
    """The same with middle nodes inside the cube moved off the middles of their edges."""
    mesh = straight_tetrahedra
    middle = np.zeros(mesh.node_count, dtype=bool)
    middle[mesh.elements[:, 4:]] = True
    shift = np.random.default_rng(2).uniform(-0.02, 0.02, mesh.nodes.shape)
    moved = middle & ~_boundary(mesh.nodes)
    assert moved.sum() > 20
    return Mesh(mesh.nodes + shift * moved[:, None], mesh.elements, "tet10").check()
