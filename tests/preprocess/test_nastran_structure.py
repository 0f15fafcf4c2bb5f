"""Plates, bars, rigid elements and masses of bulk data of Nastran: what each field means, by hand."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck_structure import (
    BeamProperty,
    PlateProperty,
    has_structure,
    property_masses,
    structure_of,
)
from heavylift.preprocess.finite_elements.geometry import read_deck
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.bar_shapes import shape_section
from tests.preprocess.test_nastran_deck import free, large, small

GRID = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,1.,0.\nGRID,4,,0.,1.,0.\n"
STEEL = "MAT1,7,2.1+11,,0.3,7850.\n"
PLATE = GRID + STEEL + "PSHELL,3,7,0.01,7,,7\nCQUAD4,9,3,1,2,3,4\n"
BAR = "PBAR,5,7,0.01,4.-6,2.-6,1.-6,3.\n"


def read(tmp_path, text, **options):
    path = tmp_path / "body.bdf"
    path.write_text(text)
    return structure_of(read_deck(path), **options)


def fails(tmp_path, text, match, **options):
    with pytest.raises(InputError, match=match):
        read(tmp_path, text, **options)


# ---- plates ----


@pytest.mark.parametrize("write", [small, large, free])
def test_a_plate_in_all_fields(tmp_path, write):
    nodes = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0), (0.0, 1.0, 0.0)]
    text = "".join(write("GRID", k, "", *x) for k, x in enumerate(nodes, 1))
    text += write("MAT1", 7, "2.1+11", "", 0.3, 7850.0)
    text += write("PSHELL", 3, 7, 0.01, 7, 2.0, 7, 0.9, 60.0)
    text += write("CQUAD4", 9, 3, 1, 2, 3, 4, 30, 0.25) + write("CTRIA3", 10, 3, 1, 2, 3, "30.", -0.25)
    made = read(tmp_path, text)
    quad, triangle = made.shells
    assert quad.elements.tolist() == [[0, 1, 2, 3]]
    assert triangle.elements.tolist() == [[0, 1, 2]]
    assert (quad.thickness[0], quad.offset[0], triangle.offset[0]) == (0.01, 0.25, -0.25)
    assert (quad.bending_factor, quad.shear_factor, quad.nonstructural_mass) == (2.0, 0.9, 60.0)
    assert (quad.material.young_modulus, quad.material.poisson_ratio) == (2.1e11, 0.3)
    assert quad.numbers.tolist() == [9]
    # 2 m2 of 78.5 + 60 kg/m2, and the triangle 1 m2; offsets along +z and -z
    masses = property_masses(made)
    assert [one.mass for one in masses] == pytest.approx([277.0, 138.5], rel=1e-12)
    assert masses[0].centre == pytest.approx([1.0, 0.5, 0.25])


def test_blank_materials_of_a_plate(tmp_path):
    whole = read(tmp_path, PLATE).shells[0]
    assert (whole.bends, whole.stretches, whole.shear_factor) == (True, True, 5.0 / 6.0)
    membrane = read(tmp_path, PLATE.replace("0.01,7,,7", "0.01"))
    assert (membrane.shells[0].bends, membrane.shells[0].stretches) == (False, True)
    assert any("PSHELL without MID2: membranes, no bending" in note for note in membrane.notes)
    assert read(tmp_path, PLATE.replace("0.01,7,,7", "0.01,7")).shells[0].shear_factor == 0.0
    bending = read(tmp_path, PLATE.replace("3,7,0.01,7,,7", "3,,0.01,7,,7")).shells[0]
    assert (bending.bends, bending.stretches) == (True, False)


@pytest.mark.parametrize(
    ("fields", "thickness"),
    [
        (",,,,,0.02,0.04,0.02,0.04", 0.03),
        (",,,,1,2.,2.,4.,4.", 0.03),  # fractions of 0.01
        (",,,,,0.02", 0.0125),  # blank corners: as PSHELL
    ],
)
def test_thickness_of_corners(tmp_path, fields, thickness):
    text = PLATE.replace("CQUAD4,9,3,1,2,3,4", f"CQUAD4,9,3,1,2,3,4{fields[:2]}\n{fields[2:]}")
    made = read(tmp_path, text)
    assert made.shells[0].thickness[0] == pytest.approx(thickness, rel=1e-12)
    assert any("1 plates with corners of different thickness have the mean" in note for note in made.notes)


def test_a_quadrilateral_with_one_node_twice_is_a_triangle(tmp_path):
    made = read(tmp_path, PLATE.replace("1,2,3,4\n", "1,2,3,3\n"))
    assert made.shells[0].elements.tolist() == [[0, 1, 2]]
    fails(tmp_path, PLATE.replace("1,2,3,4\n", "1,2,2,4\n"), r"line 6: PSHELL 3: has a node twice.*element 9")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "PSHELL,3,7,0.01",
            "PSHELL,3,7,",
            r"line 7: CQUAD4: element 9 has no thickness: neither PSHELL 3 nor",
        ),
        ("PSHELL,3,7,0.01", "PSHELL,3,7,-.01", r"line 7: CQUAD4: element 9 has the thickness -0.01"),
        ("CQUAD4,9,3", "CQUAD4,9,4", r"line 7: PSHELL 4: no thickness \(element 9\)"),
        ("PSHELL,3,7,0.01,7,,7", "PSHELL,3,8,0.01,8", r"line 6: PSHELL: material 8 does not exist"),
        ("PSHELL,3,7,0.01,7,,7", "PSHELL,3,,0.01", r"line 6: PSHELL: MID1 and MID2 are blank"),
        (
            "PSHELL,3,7,0.01,7,,7",
            "PCOMP,3\n,7,0.01",
            r"contains 1 composite properties PCOMP \(first: line 6",
        ),
        ("CQUAD4,9", "CQUAD4,9,3,1,2,4,3\nCQUAD4,9", r"line 8: CQUAD4: element 9 is defined twice"),
        ("1,2,3,4\n", "1,2,3,44\n", r"element 9 \(CQUAD4\): node 44 does not exist"),
        ("1,2,3,4\n", "1,2,3,4\nCQUAD8,11,3,1,2,3,4,1,2\n,3,4\n", r"contains 1 shell elements CQUAD8"),
        ("1,2,3,4\n", "1,2,3,4\nRROD,11,1,2,1\n", r"contains 1 rigid elements that are not read RROD"),
    ],
)
def test_faults_of_plates(tmp_path, old, new, words):
    assert old in PLATE
    fails(tmp_path, PLATE.replace(old, new, 1), words)


# ---- bars ----


def bars(tmp_path, cards, nodes=GRID):
    return read(tmp_path, nodes + STEEL + cards).beams[0]


def test_a_bar(tmp_path):
    card = free("CBAR", 9, 5, 1, 2, 0.0, 0.0, 1.0, "", 45, 6, 0.0, 0.1, 0.2, 0.0, 0.3, 0.4)
    beam = bars(tmp_path, card + BAR.strip() + "\n")
    section = beam.section
    assert (section.area, section.second_moment_1, section.second_moment_2) == (0.01, 4e-6, 2e-6)
    assert (section.torsion, section.nonstructural_mass, section.product) == (1e-6, 3.0, 0.0)
    assert section.shear_area_1 == section.shear_area_2 == np.inf  # K1, K2 blank
    assert beam.orientation.tolist() == [[0.0, 0.0, 1.0]]
    assert beam.offset_a.tolist() == [[0.0, 0.1, 0.2]]
    assert beam.offset_b.tolist() == [[0.0, 0.3, 0.4]]
    assert np.flatnonzero(beam.released[0]).tolist() == [3, 4, 11]


def test_shear_factors_stress_points_and_product_of_a_bar(tmp_path):
    fields = (
        5,
        7,
        0.01,
        4e-6,
        2e-6,
        1e-6,
        0.0,
        "",
        0.1,
        0.05,
        0.1,
        -0.05,
        -0.1,
        -0.05,
        -0.1,
        0.05,
        0.5,
        0.25,
        1e-6,
    )
    section = bars(tmp_path, free("CBAR", 9, 5, 1, 2, 0.0, 0.0, 1.0) + free("PBAR", *fields)).section
    assert (section.shear_area_1, section.shear_area_2, section.product) == (0.005, 0.0025, 1e-6)
    assert sorted(map(tuple, section.corners)) == [(-0.1, -0.05), (-0.1, 0.05), (0.1, -0.05), (0.1, 0.05)]


def test_orientation_by_a_node_counts_from_the_node_of_end_a(tmp_path):
    # the vector goes from GA to G0 and is carried to the end with the offset
    card = free("CBAR", 9, 5, 1, 2, 4, "", "", "", "", "", 0.0, 5.0, 0.0, 0.0, 5.0, 0.0)
    assert bars(tmp_path, card + BAR).orientation.tolist() == [[0.0, 1.0, 0.0]]


# a cylindrical displacement system about z at (1, -1, 0): outwards is (-1, 1)/sqrt(2) at node 1, (1, 1)/sqrt(2) at 2
ROUND = "CORD2C,6,,1.,-1.,0.,1.,-1.,1.,\n,2.,-1.,0.\n" + GRID.replace(
    "0.,0.,0.\n", "0.,0.,0.,6\n", 1
).replace("2.,0.,0.\n", "2.,0.,0.,6\n", 1)
R1, R2 = np.array([-1.0, 1.0, 0.0]) / np.sqrt(2), np.array([1.0, 1.0, 0.0]) / np.sqrt(2)


@pytest.mark.parametrize(
    ("flags", "v", "a", "b"),
    [
        ("", R1, 0.1 * R1, 0.2 * R2),  # GGG
        ("BGG", (1.0, 0.2, 0.0), 0.1 * R1, 0.2 * R2),
        ("BOG", (1.0, 0.2, 0.0), (0.1, 0.0, 0.0), 0.2 * R2),
        ("GGO", R1, 0.1 * R1, (0.2, 0.0, 0.0)),
    ],
)
def test_vectors_are_in_the_displacement_systems_of_their_nodes(tmp_path, flags, v, a, b):
    given = (1.0, 0.2, 0.0) if flags.startswith("B") else (1.0, 0.0, 0.0)
    card = free("CBAR", 9, 5, 1, 2, *given, flags, "", "", 0.1, 0.0, 0.0, 0.2, 0.0, 0.0)
    beam = bars(tmp_path, card + BAR, ROUND)
    np.testing.assert_allclose(beam.orientation[0], v, atol=1e-14)
    np.testing.assert_allclose(beam.offset_a[0], a, atol=1e-14)
    np.testing.assert_allclose(beam.offset_b[0], b, atol=1e-14)


def test_offsets_in_axes_of_the_element(tmp_path):
    # beam along x, plane 1 holds z: axes 1, 2, 3 are x, z, -y
    card = free("CBAR", 9, 5, 1, 2, 0.0, 0.0, 1.0, "GOO", "", "", 0.0, 0.1, 0.2, 0.0, 0.1, 0.2)
    np.testing.assert_allclose(bars(tmp_path, card + BAR).offset_a, [[0.0, -0.2, 0.1]], atol=1e-15)


def test_defaults_of_bars(tmp_path):
    beam = bars(tmp_path, "BAROR,,5,,,0.,1.,0.\nCBAR,9,,1,2\n" + BAR)
    assert beam.orientation.tolist() == [[0.0, 1.0, 0.0]]
    assert beam.section.area == 0.01


def test_a_beam_ends_at_its_shear_centre(tmp_path):
    # PBEAM: K blank is 1, the neutral axis is 0.02, 0.03 from the shear centre in axes 2 (z) and 3 (-y)
    station = ("YES", 1.0, "", "", "", "", "", "", *[""] * 8)
    fields = (5, 7, 0.01, 4e-6, 2e-6, "", 1e-6, 3.0, 0.1, 0.0, *[0.0] * 6, *station)
    tail = (*[""] * 8, *[""] * 4, 0.02, 0.03)
    card = free("CBEAM", 9, 5, 1, 2, 0.0, 0.0, 1.0, "", "", "", 0.0, 0.0, 0.5, 0.0, 0.0, 0.5)
    beam = bars(tmp_path, card + free("PBEAM", *fields, *tail))
    assert (beam.section.shear_area_1, beam.section.nonstructural_mass) == (0.01, 3.0)
    assert beam.section.shear_centre == pytest.approx((-0.02, -0.03))
    np.testing.assert_allclose(beam.offset_a, [[0.0, -0.03, 0.52]], atol=1e-15)
    # stress points are given from the shear centre
    assert [0.08, -0.03] in beam.section.corners.round(12).tolist()


def test_tees_by_name(tmp_path):
    card = free("CBAR", 9, 5, 1, 2, 0.0, 0.0, 1.0)
    bar = bars(tmp_path, card + "PBARL,5,7,,T\n,0.1,0.2,0.01,0.008,4.\n")
    by_hand = shape_section("T", (0.1, 0.2, 0.01, 0.008))
    assert bar.section.second_moment_1 == pytest.approx(by_hand.second_moment_1)
    assert (bar.section.nonstructural_mass, bar.section.shear_centre) == (4.0, (0.0, 0.0))
    beam = bars(tmp_path, card.replace("CBAR", "CBEAM") + "PBEAML,5,7,,T\n,0.1,0.2,0.01,0.008,4.\n")
    # the node is at the shear centre, in the flange: the centroid lies below
    assert beam.offset_a[0] == pytest.approx([0.0, 0.0, -by_hand.shear_centre[0]])
    assert beam.section.shear_centre == pytest.approx(by_hand.shear_centre)


def test_rods(tmp_path):
    beam = bars(tmp_path, "PROD,5,7,0.01,2.-6,,3.\nCROD,9,5,1,2\n")
    assert (beam.section.area, beam.section.torsion, beam.section.nonstructural_mass) == (0.01, 2e-6, 3.0)
    assert beam.section.second_moment_1 == beam.section.second_moment_2 == 0.0
    assert bars(tmp_path, "CONROD,9,1,2,7,0.02,3.-6\n").section.area == 0.02


def test_a_shear_modulus_beside_the_others_is_that_of_beams(tmp_path):
    steel = "MAT1,7,2.1+11,6.+10,0.3,7850.\n"  # E / 2.6 is 8.077e10
    card = free("CBAR", 9, 5, 1, 2, 0.0, 0.0, 1.0)
    made = read(tmp_path, GRID + steel + card + BAR)
    (beam,) = made.beams
    assert beam.material.shear_modulus * beam.section.torsion == pytest.approx(6e10 * 1e-6, rel=1e-12)
    assert any("G = 6e+10 is 0.7429 times" in note for note in made.notes)


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("CBAR,9,5,1,2\n", r"line 6: CBAR: element 9 has no orientation"),
        ("CBAR,9,5,1,2,1.,0.,0.\n", r"line 6: CBAR: element 9 has an orientation along the beam"),
        ("CBAR,9,5,1,2,0.,0.,1.,XXX\n", r"line 6: CBAR: OFFT = XXX"),
        (
            "CQUAD4,9,1,1,2,3,4,,,,+\n,,0.02\n",
            r"line 6: 'CQUAD4' has 11 fields, and the last names a continuation",
        ),
        ("CBAR,9,5,1,2,0.,0.,1.\n,7\n", r"line 6: CBAR: pin flag '7'"),
        ("CBAR,9,8,1,2,0.,0.,1.\n", r"PBAR 8: no section \(element 9\)"),
        (
            "CBAR,9,6,1,2,0.,0.,1.\nPBARL,6,7,,TREE\n,1.\n",
            r"line 7: PBARL: shape 'TREE'; expected one of BAR",
        ),
        ("CBAR,9,6,1,2,0.,0.,1.\nPBARL,6,7,,BAR\n,1.\n", r"line 7: PBARL: BAR with 1 dimensions; expected 2"),
        (
            "CBAR,9,6,1,2,0.,0.,1.\nPBARL,6,7,,BOX\n,1.,1.,.6,.6\n",
            r"line 7: PBARL: BOX: dimensions that leave no",
        ),
        (
            "CBEAM,9,6,1,2,0.,0.,1.\nPBEAML,6,7,,BAR\n,1.,2.,,YES,1.,1.,1.\n",
            r"line 7: PBEAML: its section changes",
        ),
        (
            "CBAR,9,6,1,2,0.,0.,1.\nPBAR,6,7,.01,-1.-6\n",
            r"PBAR 6: second moment 1 -1e-06; expected none below 0",
        ),
        (
            "CBEAM,9,6,1,2,0.,0.,1.\nPBEAM,6,7,.01,1.-6,1.-6\n,\n,-1.,0.\n",
            r"PBAR 6: shear area -0.01 m2",
        ),
        ("CBAR,9,5,1,1,0.,0.,1.\n", r"line 6: CBAR: element 9 has no length"),
        ("CBAR,9,5,1,2,0.,0.,1.\nCROD,10,5,1,2\n", r"line 7: CROD: has the property PBAR 5; expected PROD"),
    ],
)
def test_faults_of_bars(tmp_path, cards, words):
    fails(tmp_path, GRID + STEEL + cards + BAR, words)


# ---- nodes, masses, rigid elements ----


def test_nodes_in_round_systems(tmp_path):
    systems = "CORD2C,6,,1.,2.,3.,1.,2.,4.,\n,2.,2.,3.\nCORD2S,8,6,0.,0.,0.,0.,0.,1.,\n,1.,0.,0.\n"
    nodes = "GRID,1,6,2.,90.,1.\nGRID,2,8,2.,90.,0.\nGRID,3,,0.,0.,0.\nGRID,4,8,2.,0.,0.\n"
    made = read(tmp_path, systems + nodes + PLATE[len(GRID) :])
    np.testing.assert_allclose(made.nodes, [[1, 4, 4], [3, 2, 3], [0, 0, 0], [1, 2, 5]], atol=1e-14)
    # of three nodes: origin, a point of z, a point of the plane x, z
    rest = GRID + "CORD1R,6,1,4,2\nGRID,11,6,1.,2.,3.\n"
    made = read(tmp_path, rest + PLATE[len(GRID) :].replace("1,2,3,4\n", "1,2,3,11\n"))
    np.testing.assert_allclose(made.nodes[3], [1.0, 3.0, -2.0], atol=1e-15)  # x, z, -y


def test_systems_in_a_circle(tmp_path):
    systems = "CORD2R,6,8,0.,0.,0.,0.,0.,1.,\n,1.,0.,0.\nCORD2R,8,6,0.,0.,0.,0.,0.,1.,\n,1.,0.,0.\n"
    fails(
        tmp_path, systems + PLATE + "GRID,5,6,1.,1.,1.\n", r"CORD2R: coordinate system 6 is defined by itself"
    )


def test_a_mass_beside_its_node(tmp_path):
    inertia = "\n,3.,0.1,4.,0.2,0.3,5.\n"
    (mass,) = read(tmp_path, PLATE + "CONM2,20,3,,2.5,0.1,0.2,0.3," + inertia).masses
    assert (mass.node, mass.mass, mass.name) == (2, 2.5, "CONM2 20")
    assert mass.offset == pytest.approx([0.1, 0.2, 0.3])
    # products of inertia enter the tensor with a minus
    np.testing.assert_allclose(mass.inertia, [[3, -0.1, -0.2], [-0.1, 4, -0.3], [-0.2, -0.3, 5]])
    # CID -1: X is the place itself
    (mass,) = read(tmp_path, PLATE + "CONM2,20,3,-1,2.5,0.1,0.2,0.3," + inertia).masses
    assert mass.offset == pytest.approx([-1.9, -0.8, 0.3])
    # a system turned by 90 degrees about z: its x is y
    turned = "CORD2R,6,,0.,0.,0.,0.,0.,1.,\n,0.,1.,0.\n"
    (mass,) = read(tmp_path, PLATE + turned + "CONM2,20,3,6,2.5,0.1,0.2,0.3,\n,3.,,4.,,,5.\n").masses
    assert mass.offset == pytest.approx([-0.2, 0.1, 0.3])
    assert not any("left out" in note for note in read(tmp_path, PLATE + "CONM2,20,3,,2.5\n").notes)
    np.testing.assert_allclose(mass.inertia, np.diag([4.0, 3.0, 5.0]), atol=1e-15)


def test_weight_factor_acts_on_every_mass(tmp_path):
    text = PLATE.replace("7,,7", "7,,7,,60.") + "CONM2,20,3,,1000.\nCBAR,11,5,1,2,0.,0.,1.\n" + BAR
    text = text.replace("7850.", "0.2836").replace("2.1+11", "3.+7").replace("0.01,7", "1.,7")
    weighed = read(tmp_path, "PARAM,WTMASS,.002588\n" + text)
    assert any("units of the file: in, lbf s2/in" in note for note in weighed.notes)
    kilograms = 175.126835
    assert weighed.masses[0].mass == pytest.approx(2.588 * kilograms)
    assert weighed.shells[0].nonstructural_mass == pytest.approx(60 * 0.002588 * kilograms / 0.0254**2)
    assert weighed.beams[0].section.nonstructural_mass == pytest.approx(3 * 0.002588 * kilograms / 0.0254)
    assert weighed.shells[0].material.density == pytest.approx(0.2836 * 0.45359237 / 0.0254**3, rel=1e-3)


def test_rigid_elements(tmp_path):
    nodes = GRID + "GRID,5,,1.,0.5,1.\nGRID,6,,1.,0.5,2.\nGRID,7,,1.,0.5,-1.\n"
    cards = "RBE2,30,5,123456,1,2,3\nRBE3,31,,6,123456,1.,123,1,2,\n,2.,123,3,THRU,4,UM,1,123\n"
    cards += "RBAR,32,3,7,,123456,123\n"
    cards += "CONM2,40,6,,7.\nCONM2,41,5,,8.\nCONM2,42,7,,9.\n"
    made = read(tmp_path, nodes + PLATE[len(GRID) :] + cards)
    link, bar = made.links
    assert (link.node, link.dependent.tolist(), link.components.all()) == (4, [0, 1, 2], True)
    assert (bar.node, bar.dependent.tolist(), bar.components.tolist()) == (6, [2], [True] * 3 + [False] * 3)
    (average,) = made.averages
    assert (average.node, average.nodes.tolist(), average.weights.tolist()) == (5, [0, 1, 2, 3], [1, 1, 2, 2])
    assert any("1 RBE3 with UM" in note for note in made.notes)


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("RBE2,30,1,123,1,2\n", r"line 8: RBE2: node 1 depends on itself"),
        ("RBE2,30,1,12x,2\n", r"line 8: RBE2: components '12x'"),
        ("RBE3,31,,1,123,1.,12,2,3\n", r"line 8: RBE3: components '12' of the averaged nodes"),
        ("RBE3,31,,1,123,1.,123,THRU,3\n", r"line 8: RBE3: THRU without a node before it"),
        ("RBE2,30,77,13,2\n", r"line 8: RBE2: node 77 does not exist"),
        ("PSHELL,4,7,1.+308,7\nCTRIA3,10,4,1,2,3\n", r"PSHELL 4: thickness is beyond all bounds"),
        ("RBAR,32,1,2,123,456\n", r"line 8: RBAR: CNA = 123, CNB = 456; expected all six"),
        ("CONM2,20,8,,2.5\nGRID,8,,9.,9.,9.\n", r"CONM2 20 of 2.5 hangs on a node of no element"),
        ("GRID,8,,9.,9.,9.\nGRID,10,,8.,9.,9.\nRBE2,30,8,123456,10\n", r"RBE2 30 joins nodes of no element"),
        ("CONM2,20,3,,1.,,,,\n,-1.,,4.,,,5.\n", r"line 8: CONM2: mass 1 with principal moments -1"),
        (
            "RBE2,30,1,13,2\nCORD2R,6,,0.,0.,0.,0.,0.,1.,\n,1.,0.,0.\nGRDSET,,,,,,6\n",
            "components 13 in the displ",
        ),
    ],
)
def test_faults_of_masses_and_rigid_elements(tmp_path, cards, words):
    fails(tmp_path, PLATE + cards, words)


# ---- all of it ----


def test_what_is_read_and_what_is_not_is_told_with_counts(tmp_path):
    more = "SPC1,1,123,1,THRU,2\nPLOTEL,50,1,2\nCELAS2,51,1.,1,1\nFORCE,1,1,,1.,1.\nNSM1,4,PSHELL,2.,3\n"
    more += "PARAM,K6ROT,1.\n"
    notes = read(tmp_path, PLATE + more).notes
    assert "read: 1 CQUAD4, 4 GRID, 1 MAT1, 1 PARAM, 1 PSHELL, 1 SPC1" in notes
    assert "left out: 1 CELAS2, 1 FORCE, 1 NSM1, 1 PLOTEL" in notes
    assert any("PARAM,K6ROT,1. is left out" in note for note in notes)
    assert "case control selects no NSM: entries of nonstructural mass do not count" in notes
    assert any("1 SPC1" in note and "the case has its own" in note for note in notes)
    assert any(note.startswith("mass 157 kg, centre (1.000000, 0.500000, 0.000000) m") for note in notes)


@pytest.mark.parametrize(
    ("card", "mass"),
    [
        ("NSM1,4,PSHELL,2.,3", 4.0),  # per area: 2 m2
        ("NSM,4,PSHELL,3,2.,5,1.", 4.0 + 1.0),
        ("NSML1,4,PSHELL,6.,3,5", 6.0),  # in all
        ("NSML,4,PBARL,7,10.", 10.0),
        ("NSM1,4,PBAR,5.,ALL", 10.0),  # per length: 2 m
        ("NSM1,4,ELEMENT,3.,9,THRU,11", 3.0 * (2.0 + 1.0 + 2.0)),
        ("NSMADD,4,8,9\nNSM1,8,PSHELL,2.,3\nNSM1,9,PSHELL,1.,3\nNSM1,7,PSHELL,50.,3", 6.0),
    ],
)
def test_nonstructural_mass_that_case_control_selects(tmp_path, card, mass):
    text = (
        PLATE
        + "PSHELL,5,7,0.01,7\nCTRIA3,10,5,1,2,3\nCBAR,11,7,1,2,0.,0.,1.\n"
        + BAR.replace("PBAR,5,", "PBAR,7,")
    )
    text = text.replace("1.-6,3.", "1.-6,0.") + card + "\n"
    alone = sum(one.mass for one in property_masses(read(tmp_path, text)))
    made = read(tmp_path, "SOL 103\nCEND\nSUBCASE 1\nNSM = 4\nBEGIN BULK\n" + text)
    assert sum(one.mass for one in property_masses(made)) == pytest.approx(alone + mass, rel=1e-12)
    assert not any("left out" in note or "do not count" in note for note in made.notes)


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("NSM1,4,PSHEAR,2.,3", r"NSM1: of PSHEAR; expected PSHELL"),
        ("NSM1,4,PSHELL,2.,8", r"NSM1: no elements of PSHELL 8"),
        ("NSM1,4,PSHELL,2.,THRU,8", r"NSM1: THRU without numbers"),
    ],
)
def test_faults_of_nonstructural_mass(tmp_path, card, words):
    fails(tmp_path, "SOL 103\nCEND\nNSM = 4\nBEGIN BULK\n" + PLATE + card + "\n", words)


@pytest.mark.parametrize(
    ("scale", "young", "density", "name"),
    [
        (1.0, "2.1+11", "7850.", "m, kg, s, N"),
        (1e3, "2.1+5", "7.85-9", "mm, t, s, N"),
        (1e3, "210.", "7.85-6", "mm, kg, ms, kN"),
        (1e3, "2.1+8", "7.85-6", "mm, kg, s, mN"),
        (1.0, "7.+7", "2.7", "m, t, s, kN"),
    ],
)
def test_materials_tell_the_units(tmp_path, scale, young, density, name):
    text = PLATE.replace("2.1+11", young).replace("7850.", density).replace("0.01,7", f"{0.01 * scale},7")
    if scale != 1.0:
        text = text.replace("2.,", f"{2 * scale},").replace("1.,0", f"{scale},0")
    made = read(tmp_path, text)
    assert f"units of the file: {name}; box x 0 to 2, y 0 to 1, z 0 to 0 m" in made.notes
    rho, E = (2700.0, 7e10) if name.startswith("m, t") else (7850.0, 2.1e11)
    (shell,) = made.shells
    assert shell.material.density == pytest.approx(rho, rel=1e-12)
    assert shell.material.young_modulus == pytest.approx(E, rel=1e-12)
    assert property_masses(made)[0].mass == pytest.approx(rho * 0.02, rel=1e-12)


def test_units_that_nobody_tells(tmp_path):
    odd = PLATE.replace("7850.", "7.85")
    fails(tmp_path, odd, r"length_unit: material 'MAT1 7' has .*like no metal in any usual system")
    made = read(tmp_path, odd, length_unit=1.0, mass_unit=1e3)
    assert property_masses(made)[0].mass == pytest.approx(157.0)
    mixed = PLATE + "PSHELL,4,8,0.01,8\nMAT1,8,2.1+5,,0.3,7.85-9\nCTRIA3,10,4,1,2,3\n"
    fails(
        tmp_path, mixed, r"material 'MAT1 7' is in m, kg, s, N, material 'MAT1 8' in mm, t, s, N: mixed units"
    )
    massless = PLATE.replace(",7850.", "")
    fails(tmp_path, massless, "no material with a density tells the units")
    made = read(tmp_path, massless + "CONM2,20,3,,5.\n", length_unit=1.0, mass_unit=1.0)
    assert sum(one.mass for one in property_masses(made)) == 5.0
    assert any("material 'MAT1 7' has no density" in note for note in made.notes)


def test_groups_that_the_case_gives(tmp_path):
    text = (
        GRID + "GRID,5,,0.,0.,1.\nGRID,6,,2.,0.,1.\nCQUAD4,9,3,1,2,3,4\nCQUAD4,10,4,1,2,6,5\nCBAR,11,8,1,2\n"
    )
    steel = {"young_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}
    section = shape_section("BAR", (0.012, 0.15))
    aluminium = Material(7e10, 0.3, 2700.0)
    plates = {
        "PSHELL 3": PlateProperty(thickness=0.01, offset=0.02, nonstructural_mass=5.0),
        "pshell 4": PlateProperty(thickness=0.02, material=aluminium),
    }
    beams = {"PBAR 8": BeamProperty(section=section, orientation=(0.0, 0.0, 1.0), offset=(0.08, 0.0))}
    made = read(tmp_path, text, given=steel, plates=plates, beams=beams)
    masses = {one.name: one.mass for one in property_masses(made)}
    assert masses == pytest.approx(
        {"PSHELL 3": 2 * (78.5 + 5), "pshell 4": 2 * 54.0, "PBAR 8": 7850 * 2 * 0.0018}
    )
    assert made.beams[0].offset_b.tolist() == [[0.0, 0.0, 0.08]]
    fails(tmp_path, text, "PSHELL 4: no thickness", given=steel, plates={"PSHELL 3": plates["PSHELL 3"]})
    fails(
        tmp_path,
        text,
        r"plates.deck: element set 'deck' does not exist",
        given=steel,
        plates={"deck": plates["pshell 4"]},
    )
    alone = read(tmp_path, text, given=steel, plates=plates)  # a mesh without any property: lines are groups
    assert (alone.beams, "left out: 1 lines without a section, which are groups" in alone.notes) == ((), True)
    fails(tmp_path, text + "PSHELL,3,7,0.01\n" + STEEL, "PBAR 8: no section", plates=plates)
    no_direction = {"PBAR 8": BeamProperty(section=section)}
    fails(tmp_path, text, "PBAR 8: no orientation", given=steel, plates=plates, beams=no_direction)


def test_parts_are_chosen_and_joined(tmp_path):
    second = "GRID,11,,2.,0.,1.-4\nGRID,12,,4.,0.,0.\nGRID,13,,4.,1.,0.\nGRID,14,,2.,1.,0.\nCQUAD4,19,3,11,12,13,14\n"
    text = PLATE + second + "CONM2,20,13,,5.\n"
    whole = read(tmp_path, text)
    assert (whole.node_count, whole.element_count) == (8, 2)
    first = read(tmp_path, text, part=1)
    assert (first.node_count, first.masses) == (4, ())
    assert "left out: 1 point masses of other parts of the file" in first.notes
    assert read(tmp_path, text, part=2).masses[0].node == 2
    assert read(tmp_path, text, merge_nodes=0.001).node_count == 6
    fails(tmp_path, text, "expected a number from 1 to 2", part=3)
    assert read(tmp_path, text, elements=["PSHELL 3"]).element_count == 2


def test_solids_alone_are_no_structure(tmp_path):
    cube = [(x, y, z) for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))]
    text = "".join(free("GRID", k, "", *x) for k, x in enumerate(cube, 1)) + free("CHEXA", 1, 3, *range(1, 9))
    text += "PSOLID,3,7\n" + STEEL
    path = tmp_path / "body.bdf"

    def answer(more, **options):
        path.write_text(text + more)
        return has_structure(read_deck(path), (), **options)

    assert not answer("")
    assert not answer("CQUAD4,9,5,1,2,3,4\n")  # a group of a mesher
    assert not answer("GRID,99,,5.,5.,5.\nCONM2,9,99,,1.\n")
    assert answer("CQUAD4,9,5,1,2,3,4\n", named=["PSHELL 5"])
    assert answer("PSHELL,5,7,0.01,7\nCQUAD4,9,5,1,2,3,4\n")
    assert answer("CONM2,9,1,,1.\n")
    both = read(tmp_path, text + "PSHELL,5,7,0.01,7\nCQUAD4,9,5,5,6,7,8\n")
    assert [one.mass for one in property_masses(both)] == pytest.approx([78.5, 7850.0])


def test_the_reference_block():
    folder = os.environ.get("HEAVYLIFT_BLOCK_MODELS", "")
    path = Path(folder) / "block.bdf"
    if not path.is_file():
        pytest.skip("no reference block here")
    made = structure_of(read_deck(path))
    masses = property_masses(made)
    total = sum(one.mass for one in masses)
    assert total == pytest.approx(119544.1218, abs=1e-4)
    centre = sum(one.mass * one.centre for one in masses) / total
    assert centre == pytest.approx([6.002085, 0.003008, 0.976453], abs=1e-6)


def test_a_structure_has_the_mass_and_the_rigid_motions_of_its_deck(tmp_path):
    """Plates, bars with offset, a rod without mass, a rigid link and a mass: assembled, it has six rigid motions."""
    grid = [(float(i), float(j), 0.0) for j in range(3) for i in range(4)]
    text = (
        "".join(free("GRID", k, "", *x) for k, x in enumerate(grid, 1))
        + "GRID,20,,1.,1.,1.\nGRID,21,,0.,0.,1.\n"
    )
    quads = [(1 + i + 4 * j, 2 + i + 4 * j, 6 + i + 4 * j, 5 + i + 4 * j) for j in range(2) for i in range(3)]
    text += "".join(free("CQUAD4", k, 3, *nodes) for k, nodes in enumerate(quads, 100))
    text += (
        "PSHELL,3,7,0.01,7,,7,,10.\n" + STEEL + "MAT1,8,2.1+11,,0.3\n" + BAR.replace("PBAR,5,7", "PBAR,5,7")
    )
    text += "".join(
        free("CBAR", 200 + i, 5, 5 + i, 6 + i, 0.0, 0.0, 1.0, "", "", "", 0.0, 0.0, 0.1, 0.0, 0.0, 0.1)
        for i in range(3)
    )
    text += "CROD,300,6,1,12\nPROD,6,8,0.001\nRBE2,400,20,123456,5,6,7\nCONM2,401,20,,500.,0.,0.,0.5\n"
    text += "RBE3,402,,21,123456,1.,123,1,2,5\nCONM2,403,21,,20.\n"
    made = read(tmp_path, text)
    model = assemble_structure(made)
    masses = property_masses(made)
    assert model.total_mass == pytest.approx(sum(one.mass for one in masses), rel=1e-12)
    by_hand = 6.0 * 88.5 + 3 * (78.5 + 3.0) + 520.0
    assert model.total_mass == pytest.approx(by_hand, rel=1e-12)
    C, K = model.constraint, model.stiffness
    reduced = (C.T @ (K @ C)).toarray()
    values = np.linalg.eigvalsh(reduced)
    size = np.abs(values).max()
    assert np.abs(values[:6]).max() < 1e-9 * size
