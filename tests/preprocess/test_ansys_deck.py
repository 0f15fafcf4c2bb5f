"""Archives of Ansys: blocks of fixed fields, sections, masses, couplings; by hand."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck_structure import property_masses, structure_of
from heavylift.preprocess.finite_elements.geometry import read_deck, read_mesh

HEAD = "/COM,ANSYS RELEASE 2023\n/PREP7\n/UNITS,USER\nET,1,181\nET,2,188\nKEYOP,2,3,3\nET,3,21\nKEYOP,3,3,2\n"
NODES = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 5.0)]
MATERIAL = "MPTEMP,R5.0, 1, 1,  0.00000000\n"
MATERIAL += "MPDATA,R5.0, 1,EX  ,   1, 1, 2.1E+11\nMPDATA,R5.0, 1,PRXY,   1, 1, 0.3\n"
MATERIAL += "MPDATA,R5.0, 1,DENS,   1, 1, 7850.\n"
PLATE_SECTION = "SECTYPE,    1,SHELL,    ,panel\nSECOFFSET,MID\nSECDATA, 1.0E-02, 1, 0.0, 3\n"


def nblock(nodes=NODES):
    text = f"NBLOCK,6,SOLID,{len(nodes):10d},{len(nodes):10d}\n(3i9,6e21.13e3)\n"
    for label, x in enumerate(nodes, 1):
        values = list(x)
        while values and values[-1] == 0.0:  # as the program writes them
            values.pop()
        text += f"{label:9d}{0:9d}{0:9d}" + "".join(f"{value:21.13E}" for value in values) + "\n"
    return text + "N,R5.3,LOC,       -1,\n"


def eblock(*elements):
    """Elements as (label, type, material, real, section, nodes)."""
    text = f"EBLOCK,19,SOLID,{len(elements):10d},{len(elements):10d}\n(19i9)\n"
    for label, type_id, material, real, section, nodes in elements:
        fields = [material, type_id, real, section, 0, 0, 0, 0, len(nodes), 0, label, *nodes]
        for k in (0, 19):
            text += "".join(f"{value:9d}" for value in fields[k : k + 19]) + (
                "\n" if fields[k : k + 19] else ""
            )
    return text + "       -1\n"


QUAD = (9, 1, 1, 1, 1, (1, 2, 3, 4))


def read(tmp_path, text, **options):
    path = tmp_path / "body.cdb"
    path.write_text(text)
    return structure_of(read_deck(path), **options)


def fails(tmp_path, text, match):
    with pytest.raises(InputError, match=match):
        read(tmp_path, text)


def test_a_plate(tmp_path):
    text = HEAD + nblock() + eblock(QUAD, (10, 1, 1, 1, 1, (1, 2, 3, 3))) + PLATE_SECTION + MATERIAL
    text += "CMBLOCK,EDGE    ,NODE,       3\n(8i10)\n         1        -3         4\n"
    text += "CMBLOCK,FAR     ,NODE,       2\n(8i10)\n         4-900000000\n"  # no more than there are
    made = read(tmp_path, text)
    quad, triangle = made.shells
    assert (quad.elements.tolist(), triangle.elements.tolist()) == ([[0, 1, 2, 3]], [[0, 1, 2]])
    assert (quad.thickness[0], quad.offset[0]) == (0.01, 0.0)
    assert sum(one.mass for one in property_masses(made)) == pytest.approx(3 * 78.5)
    assert made.node_groups["EDGE"].tolist() == [0, 1, 2, 3]
    assert made.node_groups["FAR"].tolist() == [3]
    assert any(note.startswith("read: ") and "2 SHELL181" in note for note in made.notes)
    assert "the file says /UNITS,USER" in made.notes


@pytest.mark.parametrize(
    ("words", "offset"), [("TOP", -0.005), ("BOT", 0.005), ("USER, 0.02", -0.02), ("MID", 0.0)]
)
def test_section_offset_says_where_the_nodes_are(tmp_path, words, offset):
    text = HEAD + nblock() + eblock(QUAD) + PLATE_SECTION.replace("SECOFFSET,MID", f"SECOFFSET,{words}")
    assert read(tmp_path, text + MATERIAL).shells[0].offset[0] == offset


def beam(tmp_path, section, nodes=(1, 2)):
    text = HEAD + nblock() + eblock((9, 2, 1, 1, 2, nodes)) + section + MATERIAL
    return read(tmp_path, text).beams[0]


def test_the_third_node_lies_in_the_plane_of_z(tmp_path):
    # RECT: B along y, H along z
    section = "SECTYPE,2,BEAM,RECT,rib\nSECOFFSET,CENT\nSECDATA,0.012,0.15,2,2\n"
    made = beam(tmp_path, section, (1, 2, 4))
    assert made.orientation[0].tolist() == [0.0, 1.0, 0.0]
    assert made.section.second_moment_1 == pytest.approx(0.012 * 0.15**3 / 12)
    # without it z points up
    assert beam(tmp_path, section).orientation[0].tolist() == [0.0, 0.0, 1.0]


def test_offsets_of_beams(tmp_path):
    # nodes 0.1 below the middle along z, 0.02 beside it along y: beam along x, z up, y to port
    section = "SECTYPE,2,BEAM,RECT,rib\nSECOFFSET,USER,0.02,-0.1\nSECDATA,0.012,0.15\n"
    np.testing.assert_allclose(beam(tmp_path, section).offset_a, [[0.0, -0.02, 0.1]], atol=1e-15)


def test_constants_of_a_section(tmp_path):
    # A, Iyy, Iyz, Izz, Iw, J, CGy, CGz, SHy, SHz
    section = (
        "SECTYPE,2,BEAM,ASEC,rib\nSECOFFSET,ORIGIN\nSECDATA,0.01,4e-6,1e-6,2e-6,0.,1e-6,0.02,0.1,0.03,0.15\n"
    )
    made = beam(tmp_path, section)
    assert (made.section.second_moment_1, made.section.second_moment_2) == (4e-6, 2e-6)
    assert (made.section.torsion, made.section.product) == (1e-6, -1e-6)
    np.testing.assert_allclose(made.offset_a, [[0.0, 0.02, 0.1]], atol=1e-15)
    # from the centroid: z + 0.05, y + 0.01, and axis 3 is -y
    assert made.section.shear_centre == pytest.approx((0.05, -0.01))


def test_a_tee_stands_on_its_flange(tmp_path):
    """VM10 of the verification manual: flange 9 x 4, depth 20, stem 1.5 in; 100,000 in lb give 300 and -700 psi."""
    made = beam(tmp_path, "SECTYPE,2,BEAM,T,rib\nSECOFFSET,CENT\nSECDATA,9.,20.,4.,1.5\n").section
    assert made.second_moment_1 == pytest.approx(2000.0)
    low, high = made.corners[:, 0].min(), made.corners[:, 0].max()
    assert (-1e5 * low / 2000.0, -1e5 * high / 2000.0) == pytest.approx((300.0, -700.0))


def test_masses_rigid_beams_and_couplings(tmp_path):
    text = HEAD + "ET,4,184\nKEYOP,4,1,1\n" + nblock()
    text += eblock(QUAD, (11, 3, 1, 7, 1, (5,)), (12, 4, 1, 1, 1, (1, 5))) + PLATE_SECTION + MATERIAL
    text += "RLBLOCK,       1,       7,       1,       7\n(2i8,6g16.9)\n(7g16.9)\n       7       1  500.0\n"
    text += "CP,R5.0,DEFI,       1,       2,UX\nCP,R5.0,NODE,       3,       4\n"
    made = read(tmp_path, text)
    (mass,) = made.masses
    assert (mass.node, mass.mass) == (4, 500.0)
    (link,) = made.links
    assert (link.node, link.dependent.tolist()) == (0, [4])
    (tie,) = made.ties
    assert (tie.node, tie.dependent, tie.components.tolist()) == (
        2,
        3,
        [True, False, False, False, False, False],
    )


def test_solids_are_bodies_as_before(tmp_path):
    cube = [(x, y, z) for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))]
    path = tmp_path / "cube.cdb"
    path.write_text("ET,1,185\n" + nblock(cube) + eblock((1, 1, 1, 1, 1, tuple(range(1, 9)))) + MATERIAL)
    assert read_mesh(path).volume == pytest.approx(1.0)
    assert read_deck(path).body().material.density == 7850.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("SECDATA, 1.0E-02, 1, 0.0, 3", "", r"line \d+: section 1 has 0 layers; expected one SECDATA"),
        ("SECDATA, 1.0E-02", "SECDATA, 0.0", r"line \d+: section 1 has the thickness 0"),
        ("SECTYPE,    1,", "SECTYPE,    3,", r"line 19: element 9: section 1 does not exist"),
        ("ET,1,181", "ET,1,281", r"contains 1 elements of type 281 \(first: element 9\)"),
        ("ET,1,181\n", "", r"element 9 has type 1, which no ET defines"),
        (
            "MPDATA,R5.0, 1,PRXY",
            "CE,R5.0,DEFI, 2, 4, 0.0\nMPDATA,R5.0, 1,PRXY",
            r"contains 1 constraint equations CE",
        ),
        ("MPTEMP", "CP,R5.0,NODE,1,2\nMPTEMP", r"line 24: CP of nodes without its definition"),
        ("(3i9,6e21.13e3)", "(odd)", r"line 10: '\(odd\)'; expected the format of a block"),
        ("       -1\n", "", r"line 20: 'SECTYPE,'; expected a number"),
        ("MPDATA,R5.0, 1,PRXY", "MPDATA,R5.0, 1,EY  ,   1, 1, 1.E+11\nMPDATA,R5.0, 1,PRXY", "orthotropic"),
    ],
)
def test_faults_are_named_by_file_and_line(tmp_path, old, new, words):
    text = HEAD + nblock() + eblock(QUAD) + PLATE_SECTION + MATERIAL
    assert old in text
    fails(tmp_path, text.replace(old, new, 1), words)
