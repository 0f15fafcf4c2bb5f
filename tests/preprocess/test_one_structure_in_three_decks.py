"""One panel as a deck of Nastran, of Abaqus and as an archive of Ansys: signs and axes differ, the body does not."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.preprocess.finite_elements.deck_structure import structure_of
from heavylift.preprocess.finite_elements.geometry import read_deck
from heavylift.preprocess.structures.assemble import assemble_structure
from tests.preprocess.test_ansys_deck import eblock, nblock

# six nodes of two plates in a sloping plane, two masts above
NODES = [
    (0.0, 0.0, 0.0),
    (1.0, 0.0, 0.2),
    (2.0, 0.1, 0.4),
    (0.0, 1.0, 0.0),
    (1.0, 1.1, 0.2),
    (2.1, 1.0, 0.42),
]
NODES += [(1.0, 1.1, 1.2), (0.0, 1.0, 0.8)]
QUADS = [(1, 2, 5, 4), (2, 3, 6, 5)]
T, OFFSET = 0.02, 0.01  # the nodes lie under the plates
# bar from node 4 to 5 to 6 with constants by number; its centroid 0.1 along n1 and 0.03 along n2 from the nodes
A, DEEP, FLAT, PRODUCT, J = 4e-3, 6e-6, 2e-6, 1.2e-6, 1e-6
UP = (0.1, 0.2, 1.0)
ALONG, ACROSS = 0.1, 0.03


def offset(a, b):
    """From the nodes to the centroid: along the direction n1 across the bar, and along n2 = t x n1."""
    t = np.subtract(b, a)
    n2 = np.cross(t, UP)
    n1 = np.cross(n2, t)
    return ALONG * n1 / np.linalg.norm(n1) + ACROSS * n2 / np.linalg.norm(n2)


def nastran():
    text = "".join(f"GRID,{k},,{','.join(map(repr, x))}\n" for k, x in enumerate(NODES, 1))
    text += (
        f"MAT1,1,2.1+11,,0.3,7850.\nPSHELL,1,1,{T},1,,1\nPBAR,2,1,{A},{DEEP},{FLAT},{J}\n,\n,,,{PRODUCT}\n"
    )
    text += "".join(
        f"CQUAD4,{k},1,{','.join(map(str, nodes))},,{OFFSET}\n" for k, nodes in enumerate(QUADS, 11)
    )
    for k, (a, b) in enumerate(((4, 5), (5, 6)), 21):
        w = ",".join(f"{value:.15e}" for value in offset(NODES[a - 1], NODES[b - 1]))
        text += f"CBAR,{k},2,{a},{b},{','.join(map(str, UP))}\n,,,{w},{w}\n"
    text += "RBE2,31,5,123456,7\nCONM2,32,7,,40.\n,2.,0.1,3.,,,4.\nRBE2,33,4,123456,8\nCONM2,34,8,,5.\n"
    return "body.bdf", text


def abaqus():
    text = "*NODE\n" + "".join(f"{k}, {', '.join(map(repr, x))}\n" for k, x in enumerate(NODES, 1))
    text += "*ELEMENT, TYPE=S4, ELSET=Deck\n"
    text += "".join(f"{k}, {', '.join(map(str, nodes))}\n" for k, nodes in enumerate(QUADS, 11))
    text += "*ELEMENT, TYPE=B31, ELSET=Rib\n21, 4, 5\n22, 5, 6\n"
    # the reference surface lies half a thickness below the middle
    text += f"*SHELL SECTION, ELSET=Deck, MATERIAL=Steel, OFFSET=SNEG\n{T}, 5\n"
    text += "*BEAM GENERAL SECTION, SECTION=GENERAL, ELSET=Rib, DENSITY=7850.\n"
    text += f"{A}, {FLAT}, {PRODUCT}, {DEEP}, {J}\n{', '.join(map(str, UP))}\n2.1e11, {2.1e11 / 2.6!r}\n"
    text += f"*CENTROID\n{ALONG}, {ACROSS}\n*SHEAR CENTER\n{ALONG}, {ACROSS}\n"
    text += "*ELEMENT, TYPE=MASS, ELSET=M1\n32, 7\n*MASS, ELSET=M1\n40.\n"
    text += "*ELEMENT, TYPE=ROTARYI, ELSET=R1\n35, 7\n*ROTARY INERTIA, ELSET=R1\n2., 3., 4., -0.1, 0., 0.\n"
    text += "*ELEMENT, TYPE=MASS, ELSET=M2\n34, 8\n*MASS, ELSET=M2\n5.\n"
    text += "*MPC\nBEAM, 7, 5\n*SURFACE, TYPE=NODE, NAME=S\n8\n"
    text += "*COUPLING, CONSTRAINT NAME=C, REF NODE=4, SURFACE=S\n*KINEMATIC\n"
    return "body.inp", text + "*MATERIAL, NAME=Steel\n*DENSITY\n7850.\n*ELASTIC\n2.1e11, 0.3\n"


def ansys():
    # the third node of a bar lies in the plane of its z axis
    thirds = [tuple(np.add(NODES[k - 1], UP)) for k in (4, 5)]
    text = "ET,1,181\nET,2,188\nKEYOP,2,3,3\nET,3,21\nET,4,184\nKEYOP,4,1,1\n" + nblock([*NODES, *thirds])
    elements = [(k, 1, 1, 1, 1, nodes) for k, nodes in enumerate(QUADS, 11)]
    elements += [(21, 2, 1, 1, 2, (4, 5, 9)), (22, 2, 1, 1, 2, (5, 6, 10))]
    elements += [
        (31, 4, 1, 1, 1, (5, 7)),
        (32, 3, 1, 1, 1, (7,)),
        (33, 4, 1, 1, 1, (4, 8)),
        (34, 3, 1, 2, 1, (8,)),
    ]
    text += eblock(*elements)
    text += f"SECTYPE,1,SHELL\nSECDATA,{T},1\nSECOFFSET,BOT\n"
    # its y axis is -n2: the centroid of the section in y and z from the nodes
    text += f"SECTYPE,2,BEAM,ASEC\nSECDATA,{A},{DEEP},{-PRODUCT},{FLAT},0.,{J},{-ACROSS},{ALONG},{-ACROSS},{ALONG}\n"
    text += "SECOFFSET,ORIGIN\nMP,EX,1,2.1E11\nMP,PRXY,1,0.3\nMP,DENS,1,7850.\n"
    return "body.cdb", text + "R,1,40.,40.,40.,2.,3.,4.\nR,2,5.,5.,5.\n"


def model(folder, deck):
    name, text = deck
    (folder / name).write_text(text)
    made = structure_of(read_deck(folder / name), length_unit=1.0, mass_unit=1.0)
    np.testing.assert_allclose(made.nodes, NODES, atol=1e-12)
    return assemble_structure(made)


@pytest.mark.parametrize("other", [abaqus, ansys])
def test_matrices_are_the_same(tmp_path, other):
    first, second = model(tmp_path, nastran()), model(tmp_path, other())
    K, C = first.stiffness, first.constraint
    assert abs(second.stiffness - K).max() < 1e-9 * abs(K).max()
    assert abs(second.constraint - C).max() < 1e-12
    M, N = first.mass.toarray(), second.mass.toarray()
    if other is ansys:  # mass elements there have no products of inertia: 0.1 at node 7
        turns = first.rotation_dofs[6]
        M[turns, turns + 1] += 0.1
        M[turns + 1, turns] += 0.1
    assert np.abs(M - N).max() < 1e-9 * np.abs(M).max()


def test_the_sides_of_offsets_and_axes_matter(tmp_path):
    """What the comparison would not see if signs did not count: plates and bars on the other side are other bodies."""
    first = model(tmp_path, nastran())
    name, text = nastran()
    for old, new in ((f",,{OFFSET}\n", f",,-{OFFSET}\n"), (",".join(map(str, UP)), "0.1,1.0,0.2")):
        assert old in text
        other = model(tmp_path, (name, text.replace(old, new)))
        assert abs(other.stiffness - first.stiffness).max() > 1e-3 * abs(first.stiffness).max()
