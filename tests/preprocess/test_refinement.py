"""Local refinement: sizes where they were asked for, and what they do for frequencies."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.geometry import read_step
from heavylift.preprocess.finite_elements.gmsh_session import gmsh_session
from heavylift.preprocess.finite_elements.groups import InBox, OnFace, OnPlane
from heavylift.preprocess.finite_elements.reference_elements import TET_EDGES
from heavylift.preprocess.finite_elements.refinement import RE_ENTRANT, Refinement

# an L: the only re-entrant edge is x = 1, z = 1
L_SHAPE = [Box("foot", (0, 0, 0), (2, 0.5, 1)), Box("leg", (0, 0, 1), (1, 0.5, 2))]


def _edges(mesh):
    """Middles and lengths of all element edges."""
    corners = mesh.nodes[mesh.elements]
    first, second = corners[:, TET_EDGES[:, 0]], corners[:, TET_EDGES[:, 1]]
    middles = 0.5 * (first + second).reshape(-1, 3)
    return middles, np.linalg.norm(second - first, axis=2).ravel()


def test_elements_grow_linearly_from_the_re_entrant_edge():
    mesh = mesh_blocks(L_SHAPE, size=0.4, refine=[Refinement(RE_ENTRANT, 0.05, growth=0.5)])
    middles, lengths = _edges(mesh)
    distance = np.hypot(middles[:, 0] - 1.0, middles[:, 2] - 1.0)
    for near, far in ((0.0, 0.02), (0.1, 0.3), (0.3, 0.5)):
        inside = (distance >= near) & (distance <= far)
        expected = min(0.05 + 0.5 * 0.5 * (near + far), 0.4)
        assert np.median(lengths[inside]) == pytest.approx(expected, rel=0.35)
    assert mesh.volume == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize(
    "group",
    [OnPlane("end", "x", 2.0), InBox("end", (2, 0, 0), (2, 1, 1)), OnFace("end", "foot.x_max")],
    ids=["plane", "box", "face"],
)
def test_elements_are_small_at_the_border_of_a_group(group):
    mesh = mesh_blocks(L_SHAPE, size=0.4, groups=[group], refine=[Refinement("end", 0.06)])
    even = mesh_blocks(L_SHAPE, size=0.4, groups=[group])
    assert mesh.node_groups["end"].size > 4 * even.node_groups["end"].size
    middles, lengths = _edges(mesh)
    border = (middles[:, 0] > 2 - 1e-9) & (middles[:, 1] < 1e-9)
    assert np.median(lengths[border]) == pytest.approx(0.06, rel=0.2)
    far = middles[:, 2] > 1.5
    assert np.median(lengths[far]) > 0.25


def test_edges_of_a_step_file_are_refined_by_group(tmp_path):
    path = tmp_path / "bar.step"
    with gmsh_session("bar") as gmsh:
        gmsh.model.occ.addBox(0, 0, 0, 100, 10, 10)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    groups = [OnPlane("clamp", "x", 0.0), OnFace("side", "face 1")]
    for at in ("clamp", "side"):
        even = read_step(path, size=5e-3, groups=groups)
        finer = read_step(path, size=5e-3, groups=groups, refine=[Refinement(at, 1e-3)])
        assert finer.node_groups[at].size > 4 * even.node_groups[at].size
    with pytest.raises(InputError, match="re-entrant edges are known for parametric blocks only"):
        read_step(path, refine=[Refinement(RE_ENTRANT, 1e-3)])


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"refine": [Refinement("nose", 0.1)]}, "'nose': is unknown; expected one of 're-entrant edges'"),
        ({"refine": [Refinement("middle", 0.1)]}, "'middle': contains no edge"),
        ({"add": L_SHAPE[:1], "refine": [Refinement(RE_ENTRANT, 0.1)]}, "contains no edge"),
        ({"element_type": "hex8", "refine": [Refinement("end", 0.1)]}, "bricks cannot be refined"),
    ],
)
def test_refinement_of_nothing_is_refused(keywords, message):
    groups = [OnPlane("end", "x", 2.0), OnPlane("middle", "x", 0.5)]
    with pytest.raises(InputError, match=message):
        mesh_blocks(**{"add": L_SHAPE, "size": 0.4, "groups": groups, **keywords})


@pytest.mark.parametrize(("size", "growth"), [(0.0, 0.5), (-1.0, 0.5), (0.1, 0.0), (float("nan"), 0.5)])
def test_refinement_must_be_positive(size, growth):
    with pytest.raises(InputError, match="expected a positive number"):
        Refinement("end", size, growth)
