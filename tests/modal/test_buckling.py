"""Buckling factors of columns and plates: closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.modal.bases import patch_loads
from heavylift.modal.buckling import buckling
from heavylift.modal.flexibility import Flexibility, apply_mass
from heavylift.modal.statics import face_forces, solve_static
from heavylift.modal.stress_stiffness import stress_stiffness
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import FEModel, Material

SIDE, YOUNG = 0.01, 210e9
BENDING = YOUNG * SIDE**4 / 12.0


def column(element: str = "hex8") -> FEModel:
    """One metre of square steel bar along x; groups ``root`` and ``tip``."""
    half = 0.5 * SIDE
    mesh = mesh_blocks(
        [Box("column", (0.0, -half, -half), (1.0, half, half))],
        element_type=element,
        **({"size": 0.02} if element == "tet10" else {"divisions": {"x": [40], "y": [2], "z": [2]}}),
        groups=(OnPlane("root", "x", 0.0), OnPlane("tip", "x", 1.0)),
    )
    return assemble(mesh, Material(YOUNG, 0.0, 7850.0))


def factor_of(model: FEModel, flexibility: Flexibility, forces: np.ndarray) -> float:
    """Of a load."""
    state = solve_static(flexibility, forces, "load")
    return buckling(flexibility, stress_stiffness(model)(state.displacements.ravel())).factor


@pytest.mark.parametrize("element", ["hex8", "tet10"])
def test_a_column_with_a_load_on_top(element: str) -> None:
    """``pi^2 E I / 4 L^2``; the same with a load twice as large, and never under tension."""
    model = column(element)
    flexibility = Flexibility(model, model.node_groups["root"])
    push = -patch_loads(model, model.node_groups["tip"], "x").forces[:, 0]
    expected = np.pi**2 * BENDING / 4.0
    assert expected == pytest.approx(431.795, rel=1e-5)
    assert factor_of(model, flexibility, push) == pytest.approx(expected, rel=2e-3)
    assert factor_of(model, flexibility, 2.0 * push) == pytest.approx(0.5 * expected, rel=2e-3)
    if element == "hex8":
        assert factor_of(model, flexibility, -push) > 1e3 * expected


def test_a_free_bar_pressed_at_both_ends() -> None:
    """Pinned at both ends as far as it bends: ``pi^2 E I / L^2``, by inertia relief without supports."""
    model = column()
    flexibility = Flexibility(model)
    push = patch_loads(model, model.node_groups["root"], "x").forces[:, 0]
    push = push - patch_loads(model, model.node_groups["tip"], "x").forces[:, 0]
    assert factor_of(model, flexibility, push) == pytest.approx(np.pi**2 * BENDING, rel=2e-3)


def test_a_column_under_its_own_weight() -> None:
    """Greenhill's 7.8373 E I / L^3 over the weight by length."""
    model = column()
    flexibility = Flexibility(model, model.node_groups["root"])
    weight = apply_mass(model.mass, np.tile([-9.81, 0.0, 0.0], model.node_count))
    line = 7850.0 * SIDE**2 * 9.81
    assert factor_of(model, flexibility, weight) == pytest.approx(7.8373 * BENDING / line, rel=2e-3)


def plate_factor(ratio: float, n: int) -> float:
    """Of a plate of bricks between hinges under a pressure of 1 Pa on two sides."""
    b, t = 1.0, 0.01
    a = ratio * b
    mesh = mesh_blocks(
        [Box("plate", (0.0, 0.0, -0.5 * t), (a, b, 0.5 * t))],
        element_type="hex8",
        divisions={"x": [round(n * ratio)], "y": [n], "z": [2]},
    )
    x, y, z = mesh.nodes.T
    middle = np.abs(z) < 1e-9
    on_edge = middle & ((x < 1e-9) | (x > a - 1e-9) | (y < 1e-9) | (y > b - 1e-9))
    corner = np.flatnonzero(middle & (x < 1e-9) & (y < 1e-9))
    other = np.flatnonzero(middle & (x > a - 1e-9) & (y < 1e-9))
    held = [3 * np.flatnonzero(on_edge) + 2, 3 * corner, 3 * corner + 1, 3 * other + 1]
    free = assemble(mesh, Material(YOUNG, 0.3, 7850.0))
    model = replace(free, fixed_dofs=np.concatenate(held))
    faces = mesh.boundary_faces()
    ends = [faces[(np.abs(x[faces] - end) < 1e-9).all(axis=1)] for end in (0.0, a)]
    push = sum(face_forces(model, end, pressure=1.0) for end in ends)
    return factor_of(model, Flexibility(model), push)


@pytest.mark.parametrize(("ratio", "coefficient"), [(1.0, 4.0), (2.0, 4.0), (1.4, 4.470)])
def test_a_plate_of_bricks_between_hinges(ratio: float, coefficient: float) -> None:
    """``k pi^2 E t^2 / 12 (1 - nu^2) b^2`` with ``k = (m b/a + a/(m b))^2`` of m half waves.

    30 elements across; ten are 11 to 16 % too stiff, and shear makes a plate of t/b = 0.01 softer by 0.2 %.
    """
    m = 1 if ratio < np.sqrt(2.0) else 2
    assert (m / ratio + ratio / m) ** 2 == pytest.approx(coefficient, abs=2e-3)
    expected = coefficient * np.pi**2 * YOUNG * 0.01**2 / (12.0 * (1.0 - 0.3**2))
    assert plate_factor(ratio, 30) / expected == pytest.approx(1.0, abs=5e-3)
    assert plate_factor(ratio, 10) / expected > 1.1
