"""Parametric blocks: exact volumes, counts of the published mesh, groups, bad input."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.groups import InBox, OnFace, OnPlane
from heavylift.preprocess.finite_elements.reference_elements import TET_EDGES

CUBE = Box("cube", (0, 0, 0), (1, 1, 1))


@pytest.mark.parametrize("element_type", ["tet10", "hex8"])
def test_volume_and_extent_are_exact(element_type, complex_beam):
    mesh = mesh_blocks(complex_beam.add, complex_beam.cut, element_type=element_type, size=6e-3)
    assert mesh.volume == pytest.approx(complex_beam.volume, rel=1e-12)
    np.testing.assert_array_equal(mesh.nodes.min(axis=0), [0, 0, 0])
    np.testing.assert_array_equal(mesh.nodes.max(axis=0), [105e-3, 34.22e-3, 20e-3])


def test_published_grid_has_its_element_sizes(thesis_mesh):
    x = np.unique(thesis_mesh.nodes[:, 0])
    expected = [4.63e-3] * 5 + [4.87e-3] * 5 + [4.75e-3] * 10 + [5e-3] * 2
    np.testing.assert_allclose(np.diff(x), expected, rtol=1e-12)
    assert np.isin([0.0, 23.15e-3, 47.5e-3, 95e-3, 105e-3], x).all()


def test_tetrahedra_are_straight_sided_of_about_the_size_asked_for(complex_beam):
    mesh = mesh_blocks(complex_beam.add, complex_beam.cut, size=5e-3)
    corners = mesh.nodes[mesh.elements]
    first, second = corners[:, TET_EDGES[:, 0]], corners[:, TET_EDGES[:, 1]]
    np.testing.assert_allclose(corners[:, 4:], 0.5 * (first + second), atol=1e-15)
    edges = np.linalg.norm(second - first, axis=2)
    assert np.median(edges) == pytest.approx(5e-3, rel=0.25)


def test_mesh_is_the_same_every_time():
    first, second = (mesh_blocks([CUBE], size=0.3) for _ in range(2))
    np.testing.assert_array_equal(first.nodes, second.nodes)
    np.testing.assert_array_equal(first.elements, second.elements)


@pytest.mark.parametrize("scale", [1e-3, 300.0])
def test_size_of_the_body_does_not_matter_to_the_mesher(scale):
    def box(name, lower, upper):
        return Box(name, tuple(scale * v for v in lower), tuple(scale * v for v in upper))

    add = [box("base", (0, 0, 0), (1, 1, 0.3)), box("post", (0.1, 0.1, 0.3), (0.4, 0.4, 1))]
    mesh = mesh_blocks(add, [box("hole", (0.6, 0.6, -1), (0.8, 0.8, 2))], size=0.3 * scale)
    assert mesh.volume == pytest.approx((0.3 + 0.3 * 0.3 * 0.7 - 0.04 * 0.3) * scale**3, rel=1e-12)


def test_default_size_puts_two_elements_through_the_thinnest_wall():
    plate = [Box("plate", (0, 0, 0), (0.2, 0.2, 0.02))]
    assert len(np.unique(mesh_blocks(plate, element_type="hex8").nodes[:, 2])) == 3
    cube = mesh_blocks([CUBE])  # nothing thin: a tenth of the extent
    np.testing.assert_array_equal(cube.nodes, mesh_blocks([CUBE], size=0.1).nodes)


@pytest.mark.parametrize("element_type", ["tet10", "hex8"])
def test_groups_by_plane_box_and_face(element_type):
    add = [CUBE, Box("post", (0.25, 0.25, 1), (0.75, 0.75, 2))]
    groups = [
        OnPlane("foot", "z", 0.0),
        InBox("edge", (0, 0, 0), (0, 0, 1)),
        OnFace("head", "post.z_max"),
        OnFace("deck", "cube.z_max"),
    ]
    mesh = mesh_blocks(add, element_type=element_type, size=0.25, groups=groups)
    select = {name: mesh.nodes[members] for name, members in mesh.node_groups.items()}
    assert (select["foot"][:, 2] == 0).all()
    assert len(select["foot"]) == np.count_nonzero(mesh.nodes[:, 2] == 0)
    assert (select["edge"][:, :2] == 0).all()
    assert select["edge"][:, 2].max() == 1.0
    assert (select["head"][:, 2] == 2).all()
    assert select["head"][:, 0].min() == pytest.approx(0.25)
    # the joint of post and cube is not outside the cube's face, nor inside the post's height
    assert (select["deck"][:, 2] == 1).all()
    assert select["deck"][:, 0].max() == 1.0


def test_bricks_on_given_planes():
    mesh = mesh_blocks(
        [CUBE],
        element_type="hex8",
        breaks={"x": [0, 0.2, 1], "y": [0, 1]},
        divisions={"x": [1, 2], "y": [3], "z": [1]},
    )
    np.testing.assert_allclose(np.unique(mesh.nodes[:, 0]), [0, 0.2, 0.6, 1.0])
    assert mesh.element_count == 9


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"add": []}, "at least one box"),
        ({"add": [CUBE, CUBE]}, "'cube' is given twice"),
        ({"cut": [Box("all", (-1, -1, -1), (2, 2, 2))]}, "nothing is left"),
        ({"cut": [Box("all", (-1, -1, -1), (2, 2, 2))], "element_type": "hex8"}, "nothing is left"),
        ({"size": -0.1}, "size: -0.1"),
        ({"size": float("nan")}, "size: nan"),
        ({"element_type": "tet4"}, "'tet4'"),
        ({"divisions": {"x": [3]}}, "tetrahedra are not structured"),
        ({"element_type": "hex8", "divisions": {"x": [3, 3]}}, "divisions.x: .* 1 positive whole"),
        ({"element_type": "hex8", "divisions": {"x": [0]}}, "divisions.x"),
        ({"element_type": "hex8", "divisions": {"w": [1]}}, "axis 'w'"),
        ({"element_type": "hex8", "breaks": {"x": [0, 0.5]}}, "no grid plane at 1 m"),
        ({"element_type": "hex8", "breaks": {"x": [1, 0]}}, "ascending"),
        ({"groups": [OnPlane("top", "y", 7.0)]}, "'top': no node at y = 7 m; .* y 0 to 1"),
        ({"groups": [OnPlane("top", "u", 1.0)]}, "axis 'u'"),
        ({"groups": [InBox("top", (2, 2, 2), (3, 3, 3))]}, "no node in the box"),
        ({"groups": [InBox("top", (1, 0, 0), (0, 1, 1))]}, "exceeds upper"),
        ({"groups": [OnFace("top", "lid")]}, "face 'lid' is unknown; expected one of .*'cube.z_max'"),
        ({"groups": [OnPlane("a", "x", 0.0), OnPlane("a", "x", 1.0)]}, "given twice"),
        (
            {"add": [CUBE, Box("far", (3, 0, 0), (4, 1, 1))], "element_type": "hex8", "size": 1.0},
            "share no face",
        ),
        ({"add": [CUBE, Box("far", (3, 0, 0), (4, 1, 1))], "size": 1.0}, "share no face"),
    ],
)
def test_bad_blocks_are_refused(keywords, message):
    with pytest.raises(InputError, match=message):
        mesh_blocks(**{"add": [CUBE], "size": 0.5, **keywords})


@pytest.mark.parametrize("upper", [(1, 1, 0), (1, 1, -1), (1, 1, float("inf")), (1, 1)])
def test_box_without_volume_is_refused(upper):
    with pytest.raises(InputError, match="box 'flat'"):
        Box("flat", (0, 0, 0), upper)
