"""Volume, outer surface and the checks of a mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.reference_elements import REFERENCE_NODES


@pytest.mark.parametrize("name", ["distorted_bricks", "straight_tetrahedra", "curved_tetrahedra"])
def test_volume_of_a_distorted_cube_is_one(name, request):
    assert request.getfixturevalue(name).volume == pytest.approx(1.0, rel=1e-13)


@pytest.mark.parametrize("name", ["distorted_bricks", "curved_tetrahedra", "thesis_mesh"])
def test_surface_is_closed_and_encloses_the_volume(name, request):
    mesh = request.getfixturevalue(name)
    p, q, r = (mesh.nodes[mesh.boundary_triangles()[:, k]] for k in range(3))
    np.testing.assert_allclose(np.cross(q - p, r - p).sum(axis=0), 0.0, atol=1e-12)
    enclosed = np.einsum("ij,ij->", p, np.cross(q, r)) / 6.0
    assert enclosed == pytest.approx(mesh.volume, rel=1e-12)


def test_inverted_element_is_named(distorted_bricks):
    elements = distorted_bricks.elements.copy()
    elements[4] = elements[4, [4, 5, 6, 7, 0, 1, 2, 3]]
    mesh = Mesh(distorted_bricks.nodes, elements, "hex8", name="crate")
    with pytest.raises(InputError, match=r"crate: element 5 at .*: inverted .*\(1 such"):
        mesh.check()


def test_element_folded_at_one_corner_is_found():
    # positive volume, but the corner is pushed through the opposite face
    nodes = REFERENCE_NODES["hex8"].copy()
    nodes[6] = (-0.4, -0.4, -0.4)
    mesh = Mesh(nodes, np.arange(8)[None], "hex8")
    assert mesh.volume > 0
    with pytest.raises(InputError, match="inverted"):
        mesh.check()


def test_loose_element_is_named(distorted_bricks):
    loose = REFERENCE_NODES["hex8"] + 9.0
    mesh = Mesh(
        np.vstack([distorted_bricks.nodes, loose]),
        np.vstack([distorted_bricks.elements, distorted_bricks.node_count + np.arange(8)]),
        "hex8",
    )
    with pytest.raises(InputError, match=r"element 28 at \(9, 9, 9\) m: .* 2 parts"):
        mesh.check()


def test_two_bricks_on_a_common_edge_are_a_mechanism():
    first = REFERENCE_NODES["hex8"]
    nodes = np.vstack([first, first + np.array([2, 2, 0])])
    nodes, index = np.unique(nodes, axis=0, return_inverse=True)
    assert len(nodes) == 14
    with pytest.raises(InputError, match="share no face"):
        Mesh(nodes, index.reshape(2, 8), "hex8").check()


def test_element_given_twice_is_found(distorted_bricks):
    elements = np.vstack([distorted_bricks.elements, distorted_bricks.elements[:1]])
    with pytest.raises(InputError, match="face shared by"):
        Mesh(distorted_bricks.nodes, elements, "hex8").check()


def test_unused_node_is_named(distorted_bricks):
    nodes = np.vstack([distorted_bricks.nodes, [[2.0, 0.0, 0.0]]])
    with pytest.raises(InputError, match="node 65: belongs to no element"):
        Mesh(nodes, distorted_bricks.elements, "hex8").check()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"element_type": "tet4"}, "'tet4' is unknown"),
        ({"nodes": np.zeros((8, 2))}, r"nodes: array of shape \(8, 2\)"),
        ({"nodes": REFERENCE_NODES["hex8"] * np.nan}, "node 1: position"),
        ({"elements": np.arange(8)[None] + 1}, "elements: node index 8"),
        ({"elements": np.arange(8)[None] - 1}, "elements: node index -1"),
        ({"elements": np.empty((0, 8), dtype=int)}, "at least one"),
        ({"node_groups": {"top": np.array([], dtype=int)}}, "'top': contains no node"),
        ({"node_groups": {"top": np.array([9])}}, "'top': node index 9"),
    ],
)
def test_malformed_arrays_are_refused(change, message):
    good = {"nodes": REFERENCE_NODES["hex8"], "elements": np.arange(8)[None], "element_type": "hex8"}
    Mesh(**good).check()
    with pytest.raises(InputError, match=message):
        Mesh(**{**good, **change})


@pytest.mark.parametrize("element_type", ["tet10", "hex8"])
def test_point_of_a_body_is_found_with_its_shape_functions(element_type):
    """Weights of the element at a point reproduce the point and linear fields; nodes have weight one."""
    mesh = mesh_blocks([Box("block", (0, 0, 0), (2.0, 1.0, 0.5))], element_type=element_type, size=0.4)
    bent = replace(mesh, nodes=mesh.nodes + 0.02 * np.sin(3.0 * mesh.nodes[:, [1, 2, 0]]))
    for body in (mesh, bent):
        middles = body.nodes[body.elements].mean(axis=1)
        for point in (*middles[::7], *body.nodes[::11]):
            nodes, weights = body.locate(point)
            np.testing.assert_allclose(weights @ body.nodes[nodes], point, atol=2e-9)
            assert weights.sum() == pytest.approx(1.0, abs=1e-12)
    nodes, weights = mesh.locate(mesh.nodes[5])
    assert weights[nodes == 5] == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize("element_type", ["tet10", "hex8"])
def test_point_beside_a_body_has_a_near_point_of_it_or_is_refused(element_type):
    mesh = mesh_blocks([Box("block", (0, 0, 0), (2.0, 1.0, 0.5))], element_type=element_type, size=0.4)
    nodes, weights = mesh.locate([1.1, 0.3, 0.51])
    found = weights @ mesh.nodes[nodes]
    assert found[2] == pytest.approx(0.5, abs=1e-12)  # on the face
    assert np.linalg.norm(found - [1.1, 0.3, 0.51]) < 0.02
    with pytest.raises(InputError, match=r"not on the body: .* is 1\d\d[.\d]* mm away"):
        mesh.locate([1.1, 0.3, 0.6])
