"""Plates, beams, rigid elements and masses of decks as Abaqus/CAE writes them: what each line means, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck_structure import PlateProperty, property_masses, structure_of
from heavylift.preprocess.finite_elements.geometry import read_deck

STEEL = "*Material, name=Steel\n*Density\n 7850.,\n*Elastic\n 2.1e11, 0.3\n"
NODES = "*NODE\n1, 0., 0., 0.\n2, 2., 0., 0.\n3, 2., 1., 0.\n4, 0., 1., 0.\n"
PLATE = NODES + "*ELEMENT, TYPE=S4R, ELSET=Deck\n9, 1, 2, 3, 4\n"
SECTION = "*SHELL SECTION, ELSET=Deck, MATERIAL=Steel\n0.01, 5\n"
BEAM = NODES + "*ELEMENT, TYPE=B31, ELSET=Rib\n9, 1, 2\n"


def read(tmp_path, text, **options):
    path = tmp_path / "body.inp"
    path.write_text(text)
    return structure_of(read_deck(path), **options)


def fails(tmp_path, text, match, **options):
    with pytest.raises(InputError, match=match):
        read(tmp_path, text, **options)


CAE = """\
*Heading
** Job name: Job-1
*Part, name=Panel
*Node
      1,  0.,  0.,  0.
      2,  2.,  0.,  0.
      3,  2.,  1.,  0.
      4,  0.,  1.,  0.
*Element, type=S4R
1, 1, 2, 3, 4
*Element, type=B31
2, 1, 2
*Nset, nset=All, generate
 1,  4,  1
*Elset, elset=Plate
 1,
*Elset, elset=Rib
 2,
** Section: deck
*Shell Section, elset=Plate, material=Steel, offset=SPOS
0.02, 5
*Beam Section, elset=Rib, material=Steel, temperature=GRADIENTS, section=RECT
0.012, 0.15
0.,1.,0.
*End Part
*Assembly, name=Assembly
*Instance, name=Panel-1, part=Panel
*End Instance
*Instance, name=Panel-2, part=Panel
          5.,           0.,           0.
          5.,           0.,           0.,           6.,           0.,           0.,          90.
*End Instance
*Node
      1,           1.,           0.5,           1.
*Element, type=MASS, elset=_Inertia-1_
1, 1
*Mass, elset=_Inertia-1_
500.,
*Element, type=ROTARYI, elset=_Inertia-1_R_
2, 1
*Rotary Inertia, elset=_Inertia-1_R_
1., 2., 2.5, -0.1, 0., 0.
*Nset, nset=Ref
 1,
*Nset, nset=_PickedSet, internal, instance=Panel-1
 1, 2, 3, 4
*Surface, type=NODE, name=_Nodes_CNS_, internal
_PickedSet, 1.
*Coupling, constraint name=Lug, ref node=Ref, surface=_Nodes_CNS_
*Kinematic
*MPC
TIE, Panel-1.3, Panel-2.1
*End Assembly
** MATERIALS
*Material, name=Steel
*Density
 7850.,
*Elastic
 2.1e+11, 0.3
*Step, name=Lift
*End Step
"""


def test_parts_and_instances_as_cae_writes_them(tmp_path):
    made = read(tmp_path, CAE)
    first, second = made.shells
    assert (first.name, second.name) == ("Panel-1.Plate", "Panel-2.Plate")
    # SPOS: the nodes lie on the top
    assert first.offset.tolist() == [-0.01]
    # moved by 5 along x, then turned by 90 degrees about an axis along x
    np.testing.assert_allclose(made.nodes[second.elements[0]][2], [7.0, 0.0, 1.0], atol=1e-14)
    beams = made.beams
    np.testing.assert_allclose([one.orientation[0] for one in beams], [[0, 1, 0], [0, 0, 1]], atol=1e-14)
    masses = {one.name: one.mass for one in property_masses(made)}
    assert masses["Panel-1.Plate"] == pytest.approx(2 * 0.02 * 7850)
    assert masses["Panel-2.Rib"] == pytest.approx(2 * 0.0018 * 7850)
    centre = next(one.centre for one in property_masses(made) if one.name == "Panel-1.Plate")
    assert centre == pytest.approx([1.0, 0.5, -0.01])
    (mass,) = made.masses
    assert mass.mass == 500.0
    # the components of the tensor, as Abaqus defines them
    np.testing.assert_allclose(mass.inertia, [[1.0, -0.1, 0.0], [-0.1, 2.0, 0.0], [0.0, 0.0, 2.5]])
    (link,) = made.links
    assert (link.node, len(link.dependent), link.components.all()) == (mass.node, 4, True)
    assert link.name == "*COUPLING Lug"
    (tie,) = made.ties
    np.testing.assert_allclose(made.nodes[[tie.dependent, tie.node]], [[2, 1, 0], [5, 0, 0]])
    assert any(note.startswith("read: ") and "2 S4R" in note and "1 *COUPLING" in note for note in made.notes)
    assert not any("left out" in note for note in made.notes)


@pytest.mark.parametrize(
    ("word", "offset"), [("SPOS", -0.005), ("SNEG", 0.005), ("0.25", -0.0025), ("-0.5", 0.005)]
)
def test_offset_counts_thicknesses_from_the_mid_surface(tmp_path, word, offset):
    section = SECTION.replace("=Steel", f"=Steel, OFFSET={word}")
    assert read(tmp_path, PLATE + section + STEEL).shells[0].offset[0] == pytest.approx(offset)


def test_keywords_that_are_left_out_are_told(tmp_path):
    more = "*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n*BOUNDARY\n1, 1, 6\n*EQUATION\n2\n1, 1, 1., 2, 1, -1.\n"
    steps = "*STEP\n*STATIC\n*CLOAD\n1, 3, 1.\n*END STEP\n"
    notes = read(tmp_path, PLATE + SECTION + more + STEEL + steps).notes
    assert "read: 1 *SHELL SECTION, 1 S4R" in notes
    assert "left out: 1 *CLOAD, 1 *ORIENTATION, 1 *STATIC" in notes
    assert any(note.endswith("the case has its own: 1 *BOUNDARY, 1 *EQUATION") for note in notes)


@pytest.mark.parametrize("kind", ["S4", "S4R", "S4R5", "S3", "S3R", "STRI3"])
def test_kinds_of_shells(tmp_path, kind):
    nodes = "1, 2, 3, 4" if kind[1] == "4" else "1, 2, 3"
    text = PLATE.replace("S4R,", f"{kind},").replace("9, 1, 2, 3, 4", f"9, {nodes}")
    made = read(tmp_path, text + SECTION + STEEL)
    assert made.shells[0].elements.shape == (1, 4 if kind[1] == "4" else 3)
    assert property_masses(made)[0].mass == pytest.approx(78.5 * (2.0 if kind[1] == "4" else 1.0))


def test_thickness_of_nodes(tmp_path):
    text = PLATE + SECTION.replace("=Steel", "=Steel, NODAL THICKNESS") + STEEL
    text += "*NSET, NSET=Edge\n1, 4\n"
    made = read(tmp_path, text + "*NODAL THICKNESS\nEdge, 0.02\n2, 0.04\n3, 0.04\n")
    assert made.shells[0].thickness[0] == pytest.approx(0.03)
    assert any("1 plates with nodes of different thickness" in note for note in made.notes)
    fails(
        tmp_path,
        text + "*NODAL THICKNESS\nEdge, 0.02\n",
        r"SHELL SECTION: NODAL THICKNESS, and node 2 has none",
    )


# ---- beams ----


def beam(tmp_path, section, text=BEAM):
    return read(tmp_path, text + section + STEEL).beams[0]


def test_a_rectangle_lies_with_a_along_n1(tmp_path):
    made = beam(tmp_path, "*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION=RECT\n0.15, 0.012\n0., 0., 1.\n")
    assert made.orientation[0].tolist() == [0.0, 0.0, 1.0]
    # plane 1 holds n1: 150 mm deep there
    assert made.section.second_moment_1 == pytest.approx(0.012 * 0.15**3 / 12)
    assert made.section.second_moment_2 == pytest.approx(0.15 * 0.012**3 / 12)


def test_default_direction_of_beams(tmp_path):
    section = "*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION=CIRC\n0.1\n"
    assert beam(tmp_path, section).orientation[0].tolist() == [0.0, 0.0, -1.0]
    upright = BEAM.replace("2, 2., 0., 0.", "2, 0., 0., 2.")
    fails(tmp_path, upright + section + STEEL, r"the default n1 \(0, 0, -1\) is along element 9")
    # a third node tells it
    third = upright.replace("9, 1, 2", "9, 1, 2, 4")
    assert beam(tmp_path, section, third).orientation[0].tolist() == [0.0, 1.0, 0.0]


def test_the_node_of_an_i_section_lies_above_its_lower_edge(tmp_path):
    # h 0.2, flanges 0.1 x 0.01 and 0.1 x 0.01, web 0.008; node at the lower edge; n1 = y, so n2 = x cross y = z
    section = "*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION=I\n0., 0.2, 0.1, 0.1, 0.01, 0.01, 0.008\n0., 1., 0.\n"
    made = beam(tmp_path, section)
    np.testing.assert_allclose(made.offset_a, [[0.0, 0.0, 0.1]], atol=1e-15)
    deep = (0.1 * 0.2**3 - 0.092 * 0.18**3) / 12
    assert made.section.second_moment_2 == pytest.approx(deep)
    assert made.section.shear_area_2 == pytest.approx(0.18 * 0.008)


def test_constants_of_a_general_section(tmp_path):
    section = "*BEAM GENERAL SECTION, SECTION=GENERAL, ELSET=Rib, DENSITY=7850.\n"
    section += "0.01, 4e-6, 0., 2e-6, 1e-6\n0., 1., 0.\n2.1e11, 6e10\n*CENTROID\n0.1, 0.2\n*SHEAR CENTER\n0.1, 0.25\n"
    section += "*TRANSVERSE SHEAR STIFFNESS\n3e8, 6e8\n"
    made = beam(tmp_path, section)
    # I11 is about n1: it bends in plane 2
    assert (made.section.second_moment_1, made.section.second_moment_2) == (2e-6, 4e-6)
    G = made.material.shear_modulus
    assert made.section.torsion * G == pytest.approx(6e10 * 1e-6)
    # K23 shears along n2, K13 along n1
    assert (made.section.shear_area_1 * G, made.section.shear_area_2 * G) == pytest.approx((6e8, 3e8))
    np.testing.assert_allclose(made.offset_a, [[0.0, 0.1, 0.2]], atol=1e-15)
    assert made.section.shear_centre == pytest.approx((0.0, 0.05))
    assert (made.material.young_modulus, made.material.density) == (2.1e11, 7850.0)


def test_cubic_beams_have_no_shear(tmp_path):
    section = "*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION=RECT\n0.15, 0.012\n0., 0., 1.\n"
    made = beam(tmp_path, section, BEAM.replace("B31", "B33"))
    assert made.section.shear_area_1 == np.inf


@pytest.mark.parametrize(
    ("shape", "values", "area", "second_1", "second_2"),
    [
        (
            "BOX",
            "0.2, 0.1, 0.01, 0.005, 0.01, 0.005",
            0.02 - 0.18 * 0.09,
            None,
            (0.2 * 0.1**3 - 0.18 * 0.09**3) / 12,
        ),
        (
            "PIPE",
            "0.1, 0.01",
            np.pi * (0.01 - 0.0081),
            np.pi / 4 * (1e-4 - 0.09**4),
            np.pi / 4 * (1e-4 - 0.09**4),
        ),
        ("L", "0.1, 0.2, 0.01, 0.01", 0.001 + 0.0019, None, None),
    ],
)
def test_shapes_of_sections(tmp_path, shape, values, area, second_1, second_2):
    section = f"*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION={shape}\n{values}\n0., 1., 0.\n"
    made = beam(tmp_path, section).section
    assert made.area == pytest.approx(area, rel=1e-12)
    for value, expected in ((made.second_moment_1, second_1), (made.second_moment_2, second_2)):
        if expected is not None:
            assert value == pytest.approx(expected, rel=1e-12)


# ---- masses, rigid elements ----


@pytest.mark.parametrize(
    ("units", "value", "per_area"), [("MASS PER AREA", 60.0, 60.0), ("TOTAL MASS", 120.0, 60.0)]
)
def test_nonstructural_mass_of_plates(tmp_path, units, value, per_area):
    text = PLATE + SECTION + STEEL + f"*NONSTRUCTURAL MASS, ELSET=Deck, UNITS={units}\n{value},\n"
    made = read(tmp_path, text)
    assert made.shells[0].nonstructural_mass == pytest.approx(per_area)
    assert property_masses(made)[0].mass == pytest.approx(157.0 + 120.0)
    assert not any("NONSTRUCTURAL" in note and "left out" in note for note in made.notes)


def test_total_mass_is_shared_by_mass(tmp_path):
    more = "*NODE\n5, 4., 0., 0.\n6, 4., 1., 0.\n*ELEMENT, TYPE=S4, ELSET=Side\n10, 2, 5, 6, 3\n"
    more += "*SHELL SECTION, ELSET=Side, MATERIAL=Steel\n0.03\n*ELSET, ELSET=Both\nDeck, Side\n"
    more += "*NONSTRUCTURAL MASS, ELSET=Both, UNITS=TOTAL MASS\n400.\n"
    made = read(tmp_path, PLATE + SECTION + more + STEEL)
    assert {one.name: one.nonstructural_mass for one in made.shells} == pytest.approx(
        {"Deck": 50.0, "Side": 150.0}
    )


def test_distributing_coupling_has_areas_as_weights(tmp_path):
    more = (
        "*NODE\n5, 5., 0., 0.\n6, 5., 1., 0.\n99, 1., 1., 1.\n*ELEMENT, TYPE=S4, ELSET=Deck\n10, 2, 5, 6, 3\n"
    )
    more += "*SURFACE, TYPE=ELEMENT, NAME=Top\nDeck, SPOS\n*COUPLING, CONSTRAINT NAME=C, REF NODE=99, SURFACE=Top\n"
    made = read(tmp_path, PLATE + SECTION + more + "*DISTRIBUTING\n" + STEEL)
    (average,) = made.averages
    weights = dict(zip(average.nodes.tolist(), average.weights.tolist(), strict=True))
    # 2 m2 and 3 m2, a quarter for each corner
    assert weights == pytest.approx({0: 0.5, 1: 1.25, 2: 1.25, 3: 0.5, 4: 0.75, 5: 0.75})
    kinematic = read(tmp_path, PLATE + SECTION + more + "*KINEMATIC\n1, 3\n" + STEEL)
    assert kinematic.links[0].components.tolist() == [True] * 3 + [False] * 3


def test_multi_point_constraints_and_rigid_bodies(tmp_path):
    more = "*NODE\n5, 5., 0., 0.\n6, 5., 1., 0.\n7, 6., 1., 0.\n*MPC\nBEAM, 5, 1\nPIN, 6, 2\n"
    more += "*NSET, NSET=Pins\n7\n*RIGID BODY, REF NODE=3, PIN NSET=Pins\n"
    made = read(tmp_path, PLATE + SECTION + more + STEEL)
    beam_link, body = made.links
    assert (beam_link.node, beam_link.dependent.tolist()) == (0, [4])  # the first node of the line depends
    assert (body.node, body.dependent.tolist(), body.components.tolist()) == (
        2,
        [6],
        [True] * 3 + [False] * 3,
    )
    (pin,) = made.ties
    assert (pin.node, pin.dependent, pin.components.tolist()) == (1, 5, [True] * 3 + [False] * 3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (PLATE + SECTION.replace("0.01, 5\n", ""), r"line 8: \*SHELL SECTION: no thickness"),
        (PLATE + SECTION.replace("0.01", "-1."), r"line 8: \*SHELL SECTION: thickness -1"),
        (
            PLATE + SECTION.replace("=Steel", "=Steel, COMPOSITE"),
            r"line 8: \*SHELL SECTION: COMPOSITE: layers",
        ),
        (PLATE + SECTION.replace("=Steel", "=Steel, OFFSET=UP"), r"line 8: \*SHELL SECTION: OFFSET=UP"),
        (PLATE, r"S4R: no thickness \(element 9\)"),
        (
            PLATE + SECTION + "*TIE, NAME=T\na, b\n",
            r"contains 1 surfaces that are tied \*TIE \(first: line 10\)",
        ),
        (PLATE + SECTION + "*MPC\nLINK, 1, 2\n", r"line 11: \*MPC: 'LINK, 1, 2'; expected BEAM, TIE or PIN"),
        (PLATE + SECTION + "*KINEMATIC\n1\n", r"line 10: \*KINEMATIC: no \*COUPLING before it"),
        (
            PLATE + SECTION + "*COUPLING, REF NODE=88, SURFACE=S\n*KINEMATIC\n",
            r"line 10: \*COUPLING: no node '88'",
        ),
        (
            PLATE + SECTION + "*COUPLING, REF NODE=1, SURFACE=S\n*KINEMATIC\n",
            r"line 10: \*COUPLING: surface 'S' has no nodes",
        ),
        (
            PLATE + SECTION + "*NONSTRUCTURAL MASS, ELSET=Deck, UNITS=MASS PER LENGTH\n1.\n",
            r"line 10: \*NONSTRUCTURAL MASS: a mass per length of shells",
        ),
        (
            PLATE + SECTION + "*TRANSFORM, NSET=N\n0.,1.,0.,-1.,0.,0.\n*SURFACE, TYPE=NODE, NAME=S\n2\n"
            "*COUPLING, REF NODE=1, SURFACE=S\n*KINEMATIC\n1, 2\n",
            r"line 15: \*KINEMATIC: single directions beside \*TRANSFORM",
        ),
        (
            PLATE + SECTION + "*RIGID BODY, REF NODE=1\n",
            r"line 10: \*RIGID BODY: no set of nodes or elements",
        ),
        (BEAM, r"B31: no section \(element 9\)"),
        (
            BEAM + "*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION=HEX\n1., 1.\n",
            r"SECTION=HEX; expected RECT",
        ),
        (BEAM + "*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION=I\n1., 1.\n", r"SECTION=I: 2 dimensions"),
        (
            BEAM + "*BEAM SECTION, ELSET=Rib, MATERIAL=Steel, SECTION=RECT\n1., 1.\n1., 0., 0.\n",
            r"line 8: \*BEAM SECTION: n1 is along element 9",
        ),
        (PLATE.replace("S4R,", "S8R,").replace("3, 4", "3, 4, 1, 2, 3, 4"), "contains 1 shell elements"),
    ],
)
def test_faults_are_named_by_file_and_line(tmp_path, text, words):
    fails(tmp_path, text + STEEL, words)


def test_plates_of_meshers_are_what_the_case_says(tmp_path):
    """Meshers write surfaces as plane stress and lines as trusses, without sections."""
    text = PLATE.replace("S4R", "CPS4") + "*ELEMENT, TYPE=T3D2, ELSET=Rib\n10, 1, 2\n"
    steel = {"young_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}
    options = {"given": steel, "length_unit": 1.0, "mass_unit": 1.0}
    made = read(tmp_path, text, plates={"Deck": PlateProperty(thickness=0.01)}, **options)
    assert property_masses(made)[0].mass == pytest.approx(157.0)
    assert "left out: 1 lines without a section, which are groups" in made.notes
    fails(tmp_path, text, r"CPS4: no thickness \(element 9\)", **options)
