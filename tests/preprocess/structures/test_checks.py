"""What is refused before a structure is assembled, and what is told of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.checks import check_structure
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.structure import Beams, RigidLink, Shells, Solids, Structure, Tie

STEEL = Material(2.1e11, 0.3, 7850.0)


def plate(nx, ny, *, corner=(0, 0, 0), size=1.0):
    x, y = (a.ravel() for a in np.meshgrid(np.arange(nx + 1) * size, np.arange(ny + 1) * size, indexing="ij"))
    i = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    quads = np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], -1).reshape(-1, 4)
    return np.column_stack([x, y, 0 * x]) + np.array(corner), quads


def shells(elements, thickness=0.01, name="p"):
    return Shells(name, elements, STEEL, thickness)


def two_plates(gap=0.0, **parts):
    """Two plates of 3 x 2 side by side, each with nodes of its own."""
    a, quads = plate(3, 2)
    b, _ = plate(3, 2, corner=(3 + gap, 0, 0))
    return Structure(np.concatenate([a, b]), shells=(shells(np.concatenate([quads, quads + 12])),), **parts)


def test_a_sound_plate_is_told_nothing_of():
    nodes, quads = plate(4, 3)
    assert check_structure(Structure(nodes, shells=(shells(quads),))) == ()


def test_parts_that_nothing_joins_are_refused_with_the_place():
    with pytest.raises(
        InputError, match=r"2 parts .* touches the others with 3 nodes .* at \(3, 0, 0\), \(3, 1, 0\)"
    ):
        check_structure(two_plates())
    with pytest.raises(InputError, match=r"2 parts .* is 0.05 m away from the others, nearest at \(3"):
        check_structure(two_plates(0.05))


def test_a_seam_that_is_open_is_refused_and_a_tied_one_is_not():
    """Joined at one node, or by a link elsewhere, the rest of the edge is still open."""
    ties = tuple(Tie(9 + k, 12 + k) for k in range(3))
    assert check_structure(two_plates(ties=ties)) == ()
    link = (RigidLink(9, np.array([12, 13, 14, 10, 11])),)
    assert check_structure(two_plates(links=link)) == ()
    with pytest.raises(
        InputError, match=r"free edges are not joined to 2 nodes .* at \(3, 1, 0\), \(3, 2, 0\)"
    ):
        check_structure(two_plates(ties=ties[:1]))


def test_an_edge_on_a_plate_without_nodes_there_is_told_with_places():
    """A bracket whose foot lies on a plate between its nodes, joined at one corner only."""
    nodes, quads = plate(4, 4)
    bracket = np.array([[1.5, 1.0, 0], [1.0, 1.0, 1], [1.5, 1.0, 1]])
    foot = int(np.flatnonzero((nodes == [1.0, 1.0, 0.0]).all(axis=1))[0])
    structure = Structure(
        np.concatenate([nodes, bracket]),
        shells=(shells(quads), shells(np.array([[foot, 25, 27, 26]]), name="bracket")),
    )
    (note,) = check_structure(structure)
    assert note.startswith("1 nodes of free edges lie on plates that have no node there")
    assert "(1.5, 1, 0)" in note


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([0, 1, 5, 5], "has a node twice"),
        ([0, 5, 1, 4], "Jacobian determinant that is not positive"),
        ([0, 1, 2, 4], "Jacobian determinant that is not positive"),
    ],
)
def test_plates_that_are_none_are_refused(corners, message):
    nodes, quads = plate(2, 2)
    wrong = np.concatenate([quads, [corners]]) if len(set(corners)) < 4 else np.array([corners])
    with pytest.raises(InputError, match=message):
        check_structure(Structure(nodes, shells=(shells(wrong),)))


def test_duplicates_loose_nodes_units_and_nothing_are_refused():
    nodes, quads = plate(2, 2)
    with pytest.raises(
        InputError, match=r"plate 5 of p at .* is there 2 times|plate 1 of p at .* is there 2 times"
    ):
        check_structure(Structure(nodes, shells=(shells(np.concatenate([quads, quads[:1]])),)))
    bar = Beams(
        "b", np.array([[0, 1], [1, 0]]), STEEL, profile("round", diameter=0.1).section, np.array([0, 0, 1.0])
    )
    with pytest.raises(InputError, match=r"beam 1 of b .* is there 2 times"):
        check_structure(Structure(nodes, shells=(shells(quads),), beams=(bar,)))
    with pytest.raises(InputError, match=r"node 10 at \(9, 9, 9\) m: is in no element"):
        check_structure(Structure(np.concatenate([nodes, [[9, 9, 9]]]), shells=(shells(quads),)))
    with pytest.raises(InputError, match="12 m thick, the structure 2 m long"):
        check_structure(Structure(nodes, shells=(shells(quads, 12.0),)))
    with pytest.raises(InputError, match="has no plates, beams or solids"):
        check_structure(Structure(nodes))


def test_shapes_and_normals_are_told():
    nodes, quads = plate(4, 1)
    turned = quads.copy()
    turned[2] = turned[2][::-1]
    (note,) = check_structure(Structure(nodes, shells=(shells(turned),)))
    assert note.startswith("normals of 2 pairs of neighbours in p")
    flat = nodes * [1.0, 0.05, 1.0]
    (note,) = check_structure(Structure(flat, shells=(shells(quads),)))
    assert note.startswith("4 plates of p have edges longer than 10 times others, at (0.5, 0.025, 0)")
    warped = nodes.copy()
    warped[0, 2] = 0.3
    (note,) = check_structure(Structure(warped, shells=(shells(quads),)))
    assert note.startswith("1 plates of p are warped by more than 5%")
    sheared = nodes + np.column_stack([2.0 * nodes[:, 1], np.zeros((10, 2))])
    (note,) = check_structure(Structure(sheared, shells=(shells(quads),)))
    assert note.startswith("4 plates of p have corners sharper than 30 degrees")
    cut = np.concatenate([quads[:1, :3], quads[:1, [0, 2, 3]]])
    structure = Structure(nodes, shells=(shells(quads[1:]), shells(cut, name="t")))
    assert any(note.startswith("40% of the plates are triangles") for note in check_structure(structure))
    assert any("triangles" in note for note in assemble_structure(structure).notes)
    assert assemble_structure(replace(structure, shells=(shells(quads),))).notes == ()


def test_hinges_at_solids_are_told():
    """A plate along an edge of a brick passes no moment on."""
    brick = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
    )
    nodes = np.concatenate([brick, [[2, 0, 1], [2, 1, 1]]])
    structure = Structure(
        nodes,
        shells=(shells(np.array([[5, 8, 9, 6]])),),
        solids=(Solids("s", np.arange(8)[None], "hex8", STEEL),),
    )
    (note,) = check_structure(structure)
    assert note.startswith("2 nodes of plates or beams are nodes of solids, which have no rotations")
    assert "at (1, 0, 1), (1, 1, 1) m" in note
