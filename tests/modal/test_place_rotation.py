"""Rotation of places of solids by the nodes around them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.sparse import eye_array

from heavylift.modal.flexibility import Flexibility
from heavylift.modal.invariants import shape_integrals
from heavylift.modal.place_rotation import place_rotation
from heavylift.modal.reduced import Interface, ReducedBody
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.structure import Solids, Structure

LENGTH, SIDE = 1.0, 0.02


def bar(element: str = "hex8", elements: int = 10) -> Mesh:
    half = SIDE / 2.0
    sizes: dict[str, Any] = {"divisions": {"x": [elements], "y": [2], "z": [2]}}
    return mesh_blocks(
        [Box("beam", (0.0, -half, -half), (LENGTH, half, half))],
        element_type=element,
        groups=(OnPlane("root", "x", 0.0), OnPlane("tip", "x", LENGTH)),
        **(sizes if element == "hex8" else {"size": 0.02}),
    )


def fit(mesh: Mesh, place: Any) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = mesh.locate(place)
    at = nodes[np.abs(weights) > 1e-9]
    return place_rotation(mesh.nodes, mesh, at, weights @ mesh.nodes[nodes])


PLACES = [
    (LENGTH, 0.0, 0.0),
    (LENGTH, 0.01, 0.0),
    (LENGTH, 0.01, 0.01),
    (0.5, 0.0, 0.01),
    (0.53, 0.004, 0.01),
    (0.5, 0.0, 0.0),
    (0.513, 0.002, -0.003),
]


@pytest.mark.parametrize("element", ["hex8", "tet10"])
def test_rigid_rotations_are_met_and_moments_have_no_resultant(element: str) -> None:
    """At ends, edges, corners, on faces and inside; with and without a node there."""
    mesh = bar(element)
    turn, shift = np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, -1.0])
    moved = shift + np.cross(turn, mesh.nodes)
    for place in PLACES:
        around, G = fit(mesh, place)
        np.testing.assert_allclose(np.einsum("akl,al->k", G, moved[around]), turn, atol=1e-10)
        forces = np.einsum("akl,k->al", G, turn)
        scale = np.abs(forces).max()
        np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-12 * scale)
        np.testing.assert_allclose(np.cross(mesh.nodes[around], forces).sum(axis=0), turn, atol=1e-10)


def test_nodes_around_are_those_of_one_side() -> None:
    """The end face at its middle; at its edge too, as its elements are wider than thick; those around one inside."""
    mesh = bar()
    for place in ((LENGTH, 0.0, 0.0), (LENGTH, 0.01, 0.0)):
        around, _ = fit(mesh, place)
        np.testing.assert_allclose(mesh.nodes[around, 0], LENGTH)
    around, _ = fit(mesh, (0.5, 0.0, 0.01))
    np.testing.assert_allclose(mesh.nodes[around, 2], 0.01)
    assert len(fit(mesh, (0.5, 0.0, 0.0))[0]) == 27


@pytest.mark.parametrize(("axis", "stiffness"), [(1, 210e9 * SIDE**4 / 12.0), (2, 210e9 * SIDE**4 / 12.0)])
def test_an_end_under_a_moment_turns_as_a_beam_does(axis: int, stiffness: float) -> None:
    """``M L / E I`` to rounding on ten bricks; the gradient of the last layer would be 5 % short."""
    mesh = bar()
    model = assemble(mesh, Material(210e9, 0.0, 7850.0))
    around, G = fit(mesh, (LENGTH, 0.0, 0.0))
    forces = np.zeros((model.node_count, 3))
    forces[around] = G[:, axis]
    deflection = Flexibility(model, model.node_groups["root"]).solve(forces.reshape(-1, 1)).reshape(-1, 3)
    turned = np.einsum("akl,al->k", G, deflection[around])
    expected = LENGTH / stiffness * np.eye(3)[axis]
    np.testing.assert_allclose(turned, expected, rtol=1e-6, atol=1e-6 * expected.max())
    # on the upper face in the middle, half of it
    around, G = fit(mesh, (0.5, 0.0, 0.01))
    np.testing.assert_allclose(
        np.einsum("akl,al->k", G, deflection[around])[axis], 0.5 * expected[axis], rtol=2e-3
    )


def test_nodes_that_turn_have_their_own_rotation() -> None:
    """Of plates and beams, by the weights of the place; a solid of a structure is fitted as one alone."""
    mesh = bar()
    turn = np.array([0.3, -0.2, 0.5])
    shapes = np.cross(turn, mesh.nodes)[None]
    rotations = np.zeros_like(shapes)
    rotations[0, :9] = [2.0, 0.0, 0.0]
    rotations[0, :3] = [4.0, 0.0, 0.0]
    material = Material(210e9, 0.0, 7850.0)
    parts = Structure(mesh.nodes, solids=(Solids("bar", mesh.elements, "hex8", material),))
    body = ReducedBody(
        mesh.nodes,
        np.ones(1),
        shapes,
        shape_integrals(mesh.nodes, shapes, eye_array(mesh.node_count).tocsr()),
        False,
        ("turn",),
        np.zeros(1),
        0.0,
        structure=parts,
        mode_rotations=rotations,
        rotating=np.arange(9),
    )
    np.testing.assert_allclose(body.turn_at(np.array([1, 7]), np.array([0.25, 0.75])), [[2.5, 0.0, 0.0]])
    tip = np.array([np.argmin(np.linalg.norm(mesh.nodes - [LENGTH, 0.0, 0.0], axis=1))])
    np.testing.assert_allclose(body.turn_at(tip, np.ones(1)), [turn], atol=1e-10)


def test_interfaces_answer_to_their_name_and_their_point() -> None:
    mesh = bar()
    shapes = np.cross([0.3, -0.2, 0.5], mesh.nodes)[None]
    integrals = shape_integrals(mesh.nodes, shapes, eye_array(mesh.node_count).tocsr())
    none = np.zeros((0, 3, 6))
    point = np.array([LENGTH + 0.3, 0.0, 0.0])  # beside the body
    lug = Interface(point, np.array([[1.0, 2.0, 3.0]]), np.array([[9.0, 8.0, 7.0]]), np.arange(0), none, none)
    body = ReducedBody(
        mesh.nodes,
        np.ones(1),
        shapes,
        integrals,
        False,
        ("turn",),
        np.zeros(1),
        0.0,
        mesh=mesh,
        interfaces={"LUG": lug},
    )
    for place in ("LUG", point, point + 1e-9):
        found = body.motion_at(place)
        np.testing.assert_array_equal(found.point, point)
        np.testing.assert_array_equal(found.displacement, lug.displacement)
        assert found.rotation is lug.rotation
    with pytest.raises(InputError, match=r"no interface is called 'EYE'.*LUG"):
        body.motion_at("EYE")
    with pytest.raises(InputError, match="not on the body"):
        body.motion_at(point + 1e-3)
