"""Decks of Abaqus and CalculiX: the grammar, on small decks of our own, and what is taken from them."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.abaqus_deck import read_abaqus_deck
from heavylift.preprocess.finite_elements.deck import DeckMaterial, deck_number, material_of
from heavylift.preprocess.finite_elements.geometry import read_deck, read_mesh
from heavylift.preprocess.finite_elements.named_files import mesh_files
from heavylift.preprocess.finite_elements.reference_elements import REFERENCE_NODES

CUBE = """\
*NODE, NSET=All
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
"""
BRICK = "*ELEMENT, TYPE=C3D8, ELSET=Body\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
STEEL = """\
*MATERIAL, NAME=Steel
*ELASTIC
210000., 0.3
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=Body, MATERIAL=Steel
"""
TET = 0.5 * REFERENCE_NODES["tet10"]
TET_NODES = "".join(f"{k + 1}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(TET))


def deck(tmp_path, text, name="body.inp"):
    path = tmp_path / name
    path.write_text(text)
    return path


def second_cube(offset, first=8, label=2):
    """A second cube of eight own nodes, moved along z."""
    nodes = "".join(
        f"{first + k + 1}, {x}, {y}, {z + offset}\n"
        for k, (x, y, z) in enumerate(0.5 * (REFERENCE_NODES["hex8"] + 1.0))
    )
    cells = ", ".join(str(first + k + 1) for k in range(8))
    return f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=Upper\n{label}, {cells}\n"


def same_as_cube(body):
    assert body.mesh.element_type == "hex8"
    assert body.mesh.volume == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize(
    "text",
    [
        CUBE + BRICK,
        (CUBE + BRICK).lower(),
        (CUBE + BRICK).replace("\n", "\r\n"),
        "** a comment\n*HEADING\nwords, of no meaning\n\n" + CUBE + "**\n\n" + BRICK,
        # blanks, commas at the end, keywords over two lines
        CUBE.replace("\n", ",\n").replace("All,", "All")
        + "*ELEMENT,\n type = c3d8 ,\n ELSET = Body\n1,1,2,3,4,5,6,7,8,\n",
        CUBE + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3,\n4, 5,\n\n** a comment\n6, 7, 8\n",
        # a continued line without a comma, and a comma behind the keyword that means nothing
        CUBE + "*ELEMENT, TYPE=C3D8,\n1, 1, 2, 3\n4, 5, 6, 7, 8\n",
        # numbers behind the eighth node
        CUBE + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12,\n",
        # Fortran's exponents, fields that are left out
        CUBE.replace("1., 1., 1.", "1.D0, 10.-1, 0.1E+1").replace("1, 0., 0., 0.", "1") + BRICK,
        CUBE.replace("2, 1., 0., 0.", "2, 1.") + BRICK,
        CUBE.replace("4, 0., 1., 0.", "4, , 1.") + BRICK,
    ],
)
def test_one_cube_in_many_words(tmp_path, text):
    same_as_cube(read_deck(deck(tmp_path, text)).body())


@pytest.mark.parametrize("name", ["C3D8", "C3D8R", "C3D8I", "C3D8H", "C3D8IH", "C3D8T"])
def test_all_sorts_of_bricks_are_bricks(tmp_path, name):
    same_as_cube(read_deck(deck(tmp_path, CUBE + BRICK.replace("C3D8", name))).body())


def test_ten_nodes_over_lines(tmp_path):
    text = f"*NODE\n{TET_NODES}*ELEMENT, TYPE=C3D10M\n7, 1, 2, 3, 4,\n5, 6, 7,\n8, 9, 10\n"
    mesh = read_mesh(deck(tmp_path, text))
    assert mesh.element_type == "tet10"
    assert mesh.volume == pytest.approx(1 / 48, rel=1e-12)


@pytest.mark.parametrize("name", ["C3D20", "C3D20R"])
def test_twenty_nodes_over_two_lines(tmp_path, name):
    places = 0.5 * (REFERENCE_NODES["hex20"] + 1.0)
    nodes = "".join(f"{k + 1}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(places))
    cell = "3, " + ", ".join(map(str, range(1, 16))) + ",\n" + ", ".join(map(str, range(16, 21))) + "\n"
    text = f"*NODE\n{nodes}*ELEMENT, TYPE={name}\n{cell}*SURFACE, NAME=face\n3, S4\n"
    mesh = read_mesh(deck(tmp_path, text))
    assert mesh.element_type == "hex20"
    assert mesh.volume == pytest.approx(1.0, rel=1e-14)
    # S4 of Abaqus lies between the nodes 2, 3, 7, 6
    np.testing.assert_array_equal(mesh.node_groups["face"], np.flatnonzero(np.isclose(places[:, 0], 1.0)))


@pytest.mark.parametrize(
    ("text", "nodes"),
    [
        ("*NSET, NSET=Some\n1, 3, 5\n", [1, 3, 5]),
        ("*NSET, NSET=Some\n1,\n3,\n5,\n", [1, 3, 5]),
        ("*NSET, NSET=Some, GENERATE\n2, 8, 3\n", [2, 5, 8]),
        ("*NSET, NSET=Some, GENERATE\n3, 5\n7, 7, 1\n", [3, 4, 5, 7]),
        ("*NSET, NSET=Some\n1\n*NSET, NSET=SOME\n2\n", [1, 2]),
        # sets of sets, in any order, and ranges with holes
        ("*NSET, NSET=Some\nlater, 8\n*NSET, NSET=Later, GENERATE\n7, 1000000000\n", [7, 8]),
        ("*NSET, NSET=Some, ELSET=Body\n", list(range(1, 9))),
        ("*SURFACE, NAME=Some, TYPE=NODE\n5,\n6,\n", [5, 6]),
        ("*SURFACE, NAME=Some\n1, S2\n", [5, 6, 7, 8]),
        ("*SURFACE, NAME=Some\nBody, S3\nBody, S5\n", [1, 2, 5, 6, 3, 4, 7, 8]),
        ('*NSET, NSET="Some"\n1, 2\n', [1, 2]),
    ],
)
def test_sets_become_groups(tmp_path, text, nodes):
    mesh = read_mesh(deck(tmp_path, CUBE + BRICK + text))
    assert (mesh.node_groups["Some"] + 1).tolist() == sorted(nodes)
    assert len(mesh.node_groups["Body"]) == 8


@pytest.mark.parametrize(
    ("side", "coordinate"), [("S1", (2, 0)), ("S2", (1, 0)), ("S4", (0, 0)), ("S3", (None, 0))]
)
def test_faces_of_a_tetrahedron(tmp_path, side, coordinate):
    text = f"*NODE\n{TET_NODES}*ELEMENT, TYPE=C3D10\n1,1,2,3,4,5,6,7,8,9,10\n*SURFACE, NAME=face\n1, {side}\n"
    mesh = read_mesh(deck(tmp_path, text))
    axis, value = coordinate
    distance = mesh.nodes.sum(axis=1) - 0.5 if axis is None else mesh.nodes[:, axis] - value
    np.testing.assert_array_equal(mesh.node_groups["face"], np.flatnonzero(np.abs(distance) < 1e-12))


def test_cylindrical_nodes_and_local_axes(tmp_path):
    text = "*NODE, SYSTEM=C\n1, 2., 90., 3.\n*SYSTEM\n1., 0., 0., 1., 1., 0.,\n0., 0., 0.\n*NODE\n2, 1., 2., 3.\n"
    points = read_abaqus_deck(deck(tmp_path, text)).points
    # radius 2 at 90 degrees; x' = y, y' = -x about (1, 0, 0)
    np.testing.assert_allclose(points, [[0.0, 2.0, 3.0], [-1.0, 1.0, 3.0]], atol=1e-14)


def test_instances_stand_where_they_are_put(tmp_path):
    part = CUBE.replace("*NODE, NSET=All", "*NODE") + BRICK + "*NSET, NSET=Foot\n1, 2, 3, 4\n"
    text = f"""\
*PART, NAME=Cube
{part}*SOLID SECTION, ELSET=Body, MATERIAL=Steel
*END PART
*ASSEMBLY, NAME=Assembly
*INSTANCE, NAME=Low, PART=Cube
*END INSTANCE
*INSTANCE, NAME=High, PART=cube
2., 0., 0.
2., 0., 0., 2., 0., 1., 90.
*END INSTANCE
*NSET, NSET=Ends, INSTANCE=High
Foot
*NSET, NSET=Ends, INSTANCE=Low
8,
*NSET, NSET=Dotted
High.5, Low.Foot
*ELSET, ELSET=Both, INSTANCE=High
Body
*END ASSEMBLY
{STEEL.rpartition("*SOLID")[0]}"""
    found = read_deck(deck(tmp_path, text))
    with pytest.raises(
        InputError,
        match=r"falls into 2 parts with no node in common: 1 \(1 element C3D8, element set 'Low.Body'",
    ):
        found.body()
    low, high = found.body(elements=["low"]), found.body(elements=["HIGH"])
    same_as_cube(low)
    same_as_cube(high)
    # moved by (2, 0, 0), then turned about the vertical through (2, 0, 0): x becomes y
    np.testing.assert_allclose(high.mesh.nodes.min(axis=0), [1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(high.mesh.nodes.max(axis=0), [2.0, 1.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(high.mesh.nodes[0], [2.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(high.mesh.nodes[1], [2.0, 1.0, 0.0], atol=1e-15)
    assert high.mesh.node_groups["Ends"].tolist() == [0, 1, 2, 3]
    assert high.mesh.node_groups["High.Foot"].tolist() == [0, 1, 2, 3]
    assert high.mesh.node_groups["Dotted"].tolist() == [4]
    assert low.mesh.node_groups["Ends"].tolist() == [7]
    assert low.mesh.node_groups["Dotted"].tolist() == [0, 1, 2, 3]
    assert high.material == DeckMaterial("Steel", 210000.0, 0.3, 7.85e-9)
    assert found.body(elements=["Both"]).mesh.element_count == 1


def test_independent_instances_have_their_own_mesh(tmp_path):
    section = "** Section: one\n*Solid Section, elset=Body, material=Steel\n,\n"
    text = "*Part, name=P\n*End Part\n*Assembly, name=A\n"
    for name, offset in (("P-1", 0), ("P-2", 3)):
        text += f"*Instance, name={name}, part=P\n{offset}., 0., 0.\n{CUBE}{BRICK}{section}*End Instance\n"
    text += "*Node\n1, 9., 9., 9.\n*Nset, nset=Reference\n1,\n"
    text += (
        "*Nset, nset=_PickedSet5, internal, instance=P-2, generate\n1, 4, 1\n*End Assembly\n"
        + STEEL.rpartition("*SOLID")[0]
    )
    body = read_deck(deck(tmp_path, text)).body(elements=["P-2"])
    assert body.mesh.nodes[:, 0].min() == 3.0
    assert body.mesh.volume == pytest.approx(1.0)
    assert body.material.density == 7.85e-9
    assert body.mesh.node_groups["_PickedSet5"].tolist() == [0, 1, 2, 3]
    assert "Reference" not in body.mesh.node_groups


def test_parts_are_chosen_or_joined(tmp_path):
    path = deck(tmp_path, CUBE + BRICK + second_cube(1.0))
    with pytest.raises(
        InputError, match=r"2 parts with no node in common: 1 .*'Body'.*; 2 .*'Upper'.*choose with 'part'"
    ):
        read_mesh(path)
    assert read_mesh(path, part=1).nodes[:, 2].max() == 1.0
    assert read_mesh(path, part=2).nodes[:, 2].min() == 1.0
    assert read_mesh(path, elements=["upper"]).nodes[:, 2].min() == 1.0
    both = read_mesh(path, merge_nodes=1e-3)
    assert (both.node_count, both.element_count, both.volume) == (12, 2, pytest.approx(2.0))
    # nodes that became one of the lower cube are still of the set
    assert len(both.node_groups["Upper"]) == 8
    for choice, words in (
        ({"part": 3}, r"part: 3; expected a number from 1 to 2"),
        ({"elements": ["uper"]}, r"elements: element set 'uper' does not exist; did you mean 'Upper'\?"),
        ({"merge_nodes": 1.1}, r"merge_nodes: 1.1 collapses element 1 \(C3D8\) \(2 of 2"),
    ):
        with pytest.raises(InputError, match=words):
            read_mesh(path, **choice)
    # an edge in common is a hinge, no body
    hinged = CUBE + BRICK + "*NODE\n9,2,0,1\n10,2,1,1\n11,1,0,2\n12,1,1,2\n13,2,0,2\n14,2,1,2\n"
    hinged += "*ELEMENT, TYPE=C3D8\n2, 6, 9, 10, 7, 11, 13, 14, 12\n"
    with pytest.raises(InputError, match="2 parts with no face in common"):
        read_mesh(deck(tmp_path, hinged))


def test_materials_of_sections(tmp_path):
    body = read_deck(deck(tmp_path, CUBE + BRICK + STEEL)).body()
    assert body.material == DeckMaterial("Steel", 210000.0, 0.3, 7.85e-9)
    table = STEEL.replace("210000., 0.3", "210000., 0.3, 20.\n190000., 0.31, 300.")
    body = read_deck(deck(tmp_path, CUBE + BRICK + table)).body()
    assert body.material.young_modulus == 210000.0
    assert body.material.notes == ("material Steel: elasticity is the first row of 2, of temperature 20",)
    plastic = STEEL.replace("*DENSITY", "*PLASTIC\n200., 0.\n*DENSITY")
    body = read_deck(deck(tmp_path, CUBE + BRICK + plastic)).body()
    assert (body.material.density, body.material.notes) == (
        7.85e-9,
        ("material Steel: plasticity is left out",),
    )
    # two materials of the same numbers are one
    two = CUBE + BRICK + second_cube(1.0) + STEEL + STEEL.replace("Steel", "Other").replace("Body", "Upper")
    assert read_deck(deck(tmp_path, two)).body(merge_nodes=1e-6).material.density == 7.85e-9
    softer = two[::-1].replace(".000012", ".00007", 1)[::-1]
    body = read_deck(deck(tmp_path, softer)).body(merge_nodes=1e-6)
    assert [one.young_modulus for one in body.materials] == [210000.0, 70000.0]
    assert body.material_index.tolist() == [0, 1]
    with pytest.raises(InputError, match=r"has 2 materials: 'Steel', 'Other'; expected one material"):
        assert body.material
    assert read_deck(deck(tmp_path, softer)).body(part=2).material.young_modulus == 70000.0
    assert read_deck(deck(tmp_path, softer)).body(merge_nodes=1e-6, materials=False).material is None
    # an element without section is of the only material there is, or of none
    one = CUBE + BRICK + second_cube(1.0) + STEEL
    body = read_deck(deck(tmp_path, one)).body(merge_nodes=1e-6)
    assert "1 elements have no section: taken as of Steel" in body.notes
    three = softer + second_cube(2.0, 16, 3).replace("Upper", "Third")
    with pytest.raises(
        InputError, match=r"element 3 \(C3D8\): has no section, and the others have 2 materials"
    ):
        read_deck(deck(tmp_path, three)).body(merge_nodes=1e-6)


@pytest.mark.parametrize(
    ("elastic", "words"),
    [
        ("*ELASTIC, TYPE=ORTHO\n1.,2.,3.,4.,5.,6.,7.,8.,\n9.", "is orthotropic"),
        ("*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1.,2.,3.,4.,5.,6.,7.,8.,\n9.", "is orthotropic"),
        ("*ELASTIC, TYPE=ANISO\n1.,2.,3.", "is anisotropic"),
        ("*HYPERELASTIC, NEO HOOKE\n1., 2.", r"is hyperelastic \(\*HYPERELASTIC\)"),
        ("*USER MATERIAL, CONSTANTS=1\n1.", "is a user material"),
    ],
)
def test_materials_that_are_not_linear_and_isotropic_are_refused(tmp_path, elastic, words):
    text = CUBE + BRICK + STEEL.replace("*ELASTIC\n210000., 0.3", elastic)
    with pytest.raises(InputError, match=f"material 'Steel' {words}.*expected linear isotropic"):
        material_of(read_deck(deck(tmp_path, text)).body().material, {}, source="body")


def test_a_material_is_in_the_units_of_the_deck():
    steel = DeckMaterial("Steel", 210000.0, 0.3, 7.85e-9)
    material = material_of(steel, {}, source="body", length_unit=1e-3, mass_unit=1e3)
    assert material.young_modulus == pytest.approx(2.1e11, rel=1e-14)
    assert material.density == pytest.approx(7850.0, rel=1e-14)
    with pytest.raises(InputError, match="no material is like that; expected the units"):
        material_of(steel, {}, source="body")
    with pytest.raises(InputError, match="mass_unit: no unit of mass for the young modulus 210000"):
        material_of(steel, {}, source="body", length_unit=1e-3)
    # said to be meant so: a material of any numbers
    odd = material_of(DeckMaterial("X", 1.0, 0.0, 1.0), {}, source="body", length_unit=1.0, mass_unit=1.0)
    assert odd.young_modulus == 1.0


def test_a_case_and_its_deck_must_agree():
    steel = DeckMaterial("Steel", 210000.0, 0.3, 7.85e-9)
    given = {"young_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}
    unit = {"source": "body", "length_unit": 1e-3}
    assert material_of(steel, given, **unit, mass_unit=1e3).density == 7850.0
    # the unit of mass drops out of E / rho
    assert material_of(steel, given, **unit).young_modulus == 2.1e11
    for key, value in (("young_modulus", 2.0e11), ("poisson_ratio", 0.25), ("density", 8000.0)):
        with pytest.raises(InputError, match=rf"material\.{key}: .*of the file has"):
            material_of(steel, {**given, key: value}, **unit, mass_unit=1e3)
    with pytest.raises(InputError, match=r"young_modulus / density: .*of the file has"):
        material_of(steel, {**given, "density": 2700.0}, **unit)
    static = DeckMaterial("Steel", 210000.0, 0.3, None)
    with pytest.raises(
        InputError, match=r"material.density: no 'density': material 'Steel' of the file has none"
    ):
        material_of(static, {}, **unit, mass_unit=1e3)
    assert material_of(static, {"density": 7850.0}, **unit, mass_unit=1e3).density == 7850.0


@pytest.mark.parametrize(
    ("elements", "words"),
    [
        (
            "*ELEMENT, TYPE=S4, ELSET=Skin\n9, 1, 2, 3, 4\n",
            r"contains 1 shell elements S4 \(first: element 9\).*'elements'.*'Body'",
        ),
        (
            "*ELEMENT, TYPE=S8R, ELSET=Skin\n9,1,2,3,4,5,6,\n7,8\n10,1,2,3,4,5,6,\n7,8\n",
            "contains 2 shell elements S8R",
        ),
        ("*ELEMENT, TYPE=B31, ELSET=Skin\n9, 1, 2\n", "1 beam elements B31"),
        ("*ELEMENT, TYPE=T3D2, ELSET=Skin\n9, 1, 2\n", "1 truss elements T3D2"),
        ("*ELEMENT, TYPE=CPE4, ELSET=Skin\n9, 1, 2, 3, 4\n", "1 plane or axisymmetric elements CPE4"),
        ("*ELEMENT, TYPE=C3D6\n9, 1, 2, 3, 5, 6, 7\n", "1 6-node wedges C3D6"),
        (
            "*ELEMENT, TYPE=C3D4\n9, 1, 2, 3, 5\n",
            "1 4-node tetrahedra C3D4 .*expected 10-node tetrahedra .C3D10.: 4-node ones lock",
        ),
        ("*ELEMENT, TYPE=C3D15\n9,1,2,3,5,6,7,1,2,3,4,5,6,7,8,\n1,2\n", "1 15-node wedges C3D15"),
        ("*ELEMENT, TYPE=XYZ, ELSET=Skin\n9, 1\n", "1 elements XYZ"),
    ],
)
def test_other_elements_are_told_and_can_be_left_out(tmp_path, elements, words):
    path = deck(tmp_path, CUBE + BRICK + elements + "*SHELL SECTION, ELSET=Skin, MATERIAL=Steel\n0.1\n")
    with pytest.raises(InputError, match=words):
        read_mesh(path)
    same_as_cube(read_deck(path).body(elements=["Body"]))


def test_shells_and_plane_elements_without_section_carry_groups(tmp_path):
    # as Gmsh writes its surfaces and lines
    text = (
        CUBE
        + "*ELEMENT, type=T3D2, ELSET=Line1\n1, 1, 2\n*ELEMENT, type=CPS4, ELSET=Surface1\n2, 1, 2, 3, 4\n"
    )
    text += "*ELEMENT, type=STRI65, ELSET=Surface2\n4, 1, 2, 3, 4, 5, 6\n" + BRICK.replace("\n1, 1", "\n3, 1")
    body = read_deck(deck(tmp_path, text)).body()
    same_as_cube(body)
    assert body.mesh.node_groups["Surface1"].tolist() == [0, 1, 2, 3]
    assert body.mesh.node_groups["Line1"].tolist() == [0, 1]
    assert "left out: 1 plane or axisymmetric elements without section CPS4" in body.notes


def test_masses_springs_and_constraints_are_left_out_and_said(tmp_path):
    text = (
        CUBE
        + BRICK
        + "*ELEMENT, TYPE=SPRINGA, ELSET=S\n5, 1, 2\n*ELEMENT, TYPE=MASS\n6, 1\n*BOUNDARY\n1, 1, 3\n"
    )
    text += "*RIGID BODY, NSET=All, REF NODE=1\n*STEP\n*STATIC\n*BOUNDARY\n2, 1\n*END STEP\n"
    body = read_deck(deck(tmp_path, text)).body()
    same_as_cube(body)
    assert any("2 *BOUNDARY, 1 *RIGID BODY" in note for note in body.notes)
    assert "left out: 1 springs, dashpots, gaps or couplings SPRINGA" in body.notes
    assert "left out: 1 point masses MASS" in body.notes


def test_collapsed_inverted_and_distorted_elements_are_named(tmp_path):
    for cells, words in (
        ("1, 2, 3, 3, 5, 6, 7, 7", r"element 1 \(C3D8\): has a node twice: a collapsed element \(1 of 1"),
        ("5, 6, 7, 8, 1, 2, 3, 4", r"element 1 \(C3D8\) at \(0.5, 0.5, 0.5\): inverted"),
    ):
        with pytest.raises(InputError, match=words):
            read_mesh(deck(tmp_path, CUBE + f"*ELEMENT, TYPE=C3D8\n1, {cells}\n"))
    dented = CUBE.replace("7, 1., 1., 1.", "7, 0.2, 0.2, 1.")
    with pytest.raises(InputError, match="distorted beyond use: at a node of it"):
        read_mesh(deck(tmp_path, dented + BRICK))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("no deck\n", r"body.inp: contains no keyword"),
        ("*HEADING\n", r"body.inp: contains no solid cell"),
        (
            CUBE.replace("7, 1., 1., 1.", "7, 1., one, 1.") + BRICK,
            r"body.inp: line 8: \*NODE: 'one'; expected a finite number",
        ),
        (CUBE.replace("7, 1., 1., 1.", "7, 1., nan, 1.") + BRICK, r"line 8: \*NODE: 'nan'"),
        (CUBE + BRICK.replace("8\n", "9\n"), r"element 1 \(C3D8\): node 9 does not exist"),
        (
            CUBE + BRICK.replace(" 7, 8\n", "\n"),
            r"line 11: \*ELEMENT: element 1 has 6 nodes; expected 8 nodes of C3D8",
        ),
        (CUBE + BRICK.replace("TYPE=C3D8, ", ""), r"line 10: \*ELEMENT: no TYPE"),
        (
            CUBE + BRICK + BRICK.replace("1, 1, 2", "1, 2, 1"),
            r"line 13: \*ELEMENT: element 1 is defined twice",
        ),
        (CUBE + "*NGEN\n1, 8, 1\n" + BRICK, r"line 10: \*NGEN: nodes are generated"),
        (CUBE + BRICK + "*NSET, NSET=A, GENERATE\n1, 8, 0\n", r"line 13: \*NSET: a step of 0"),
        (CUBE + BRICK + STEEL.replace("210000., 0.3", "210000."), r"line 14: \*ELASTIC: 1 constants"),
        ("*INSTANCE, NAME=A, PART=B\n", r"line 1: \*INSTANCE: part 'B' does not exist"),
    ],
)
def test_faults_are_named_by_file_and_line(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        read_mesh(deck(tmp_path, text))


def test_sets_that_name_themselves_or_nothing(tmp_path):
    text = CUBE + BRICK + "*NSET, NSET=A\nB, 1\n*NSET, NSET=B\nA, 2, Nowhere\n"
    body = read_deck(deck(tmp_path, text)).body()
    assert body.mesh.node_groups["A"].tolist() == body.mesh.node_groups["B"].tolist() == [0, 1]
    assert "sets that do not exist are left out: Nowhere" in body.notes


def test_files_are_included_and_none_from_outside(tmp_path):
    folder = tmp_path / "case" / "deck"
    folder.mkdir(parents=True)
    (folder.parent / "nodes.inc").write_text(CUBE)
    (folder / "cells.inc").write_text("** only lines of data\n1, 1, 2, 3, 4, 5, 6, 7, 8\n")
    text = "*include, input=../nodes.inc\n*ELEMENT, TYPE=C3D8, INPUT=cells.inc\n"
    path = deck(folder, text)
    body = read_deck(path, folder.parent).body()
    same_as_cube(body)
    names = {file.name for file in mesh_files(path, folder.parent)}
    assert names == {"body.inp", "nodes.inc", "cells.inc"}
    with pytest.raises(
        InputError, match=r"body.inp: line 1: includes '../nodes.inc', which leaves the folder"
    ):
        read_deck(path)
    (tmp_path / "secret.inc").write_text(CUBE)
    (folder / "link.inc").symlink_to(tmp_path / "secret.inc")
    for name, words in (
        ("../../secret.inc", "leaves the folder"),
        ("link.inc", "leaves the folder"),
        (str(tmp_path / "secret.inc"), "leaves the folder"),
        ("none.inc", "does not exist"),
        ("body.inp", "includes itself"),
    ):
        with pytest.raises(InputError, match=words):
            read_deck(deck(folder, f"*INCLUDE, INPUT={name}\n"), folder.parent)


@pytest.mark.parametrize(
    ("word", "value"), [("1.5-3", 1.5e-3), ("-.2+4", -2e3), ("3.D2", 300.0), ("7", 7.0), ("1e-2", 0.01)]
)
def test_numbers_as_fortran_writes_them(word, value):
    assert deck_number(word) == pytest.approx(value, rel=1e-15)


def test_sets_given_in_an_instance_are_its_own(tmp_path):
    text = f"*PART, NAME=P\n{CUBE}{BRICK}*END PART\n*ASSEMBLY, NAME=A\n"
    text += "*INSTANCE, NAME=I, PART=P\n*NSET, NSET=Foot\n1, 2\n*ELSET, ELSET=One\n1,\n*END INSTANCE\n"
    text += "*INSTANCE, NAME=J, PART=P\n3., 0., 0.\n*NSET, NSET=Foot\n8,\n*END INSTANCE\n"
    text += "*INSTANCE, NAME=K, PART=P\n6., 0., 0.\n*END INSTANCE\n*END ASSEMBLY\n"
    found = read_deck(deck(tmp_path, text))
    assert found.node_sets["I.Foot"].tolist() == [0, 1]
    assert found.node_sets["J.Foot"].tolist() == [15]
    assert "K.Foot" not in found.node_sets
    assert found.element_sets["I.One"].tolist() == [0]
    assert not {"J.One", "K.One"} & found.element_sets.keys()
    assert found.node_sets["K.All"].tolist() == list(range(16, 24))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            CUBE + BRICK + "*SYMMETRIC MODEL GENERATION, REVOLVE\n",
            r"line 12: .* nodes and elements are generated",
        ),
        (CUBE + BRICK + "*IMPERFECTION, FILE=a, STEP=1\n", r"line 12: \*IMPERFECTION: shifts of nodes are"),
        (CUBE + "8, 0., 1., 2.\n" + BRICK, r"line 10: \*NODE: node 8 is defined twice"),
        (
            CUBE + BRICK + STEEL + "*MATERIAL, NAME=STEEL\n*ELASTIC\n7.E4, 0.3\n",
            r"line 18: \*MATERIAL: material 'STEEL' is defined twice",
        ),
        (CUBE.replace("7, 1.", "--1, 1.") + BRICK, r"line 8: \*NODE: '--1'; expected a node number"),
        (CUBE + BRICK.replace("7, 8", "\u00b2, 8"), r"line 11: \*ELEMENT: '\u00b2'; expected whole numbers"),
    ],
)
def test_generated_redefined_and_odd_numbers_are_refused(tmp_path, text, words):
    path = tmp_path / "body.inp"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_mesh(path)


def test_same_definitions_twice_pass(tmp_path):
    same_as_cube(read_deck(deck(tmp_path, CUBE + CUBE + BRICK + STEEL + STEEL)).body())


def test_nonstructural_mass_and_a_section_of_no_set_are_said(tmp_path):
    text = CUBE + BRICK + "*NONSTRUCTURAL MASS, ELSET=Body, UNITS=TOTAL MASS\n5.\n"
    text += STEEL.replace("ELSET=Body, ", "")
    body = read_deck(deck(tmp_path, text)).body()
    assert "left out: *NONSTRUCTURAL MASS of line 12, set 'Body'" in body.notes
    assert "left out: *SOLID SECTION of line 19, material 'Steel': it has no ELSET" in body.notes
    assert body.material is None
    assert not any("do not exist" in note for note in body.notes)


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("*SURFACE, NAME=S\nBody, S1\n", r"\*SURFACE: in instance 'I', which has no mesh of its own"),
        (
            "*SOLID SECTION, ELSET=Body, MATERIAL=Steel\n",
            r"\*SOLID SECTION: in instance 'I', which has no mesh",
        ),
    ],
)
def test_what_an_instance_without_a_mesh_cannot_have(tmp_path, card, words):
    """It was dropped, so a material or a group of the deck was missing without a word."""
    text = f"*PART, NAME=P\n{CUBE}{BRICK}*END PART\n*ASSEMBLY, NAME=A\n"
    text += f"*INSTANCE, NAME=I, PART=P\n{card}*END INSTANCE\n*END ASSEMBLY\n{STEEL.partition('*SOLID')[0]}"
    with pytest.raises(InputError, match=r"line 16: " + words + r".*expected it in \*PART 'P'"):
        read_deck(deck(tmp_path, text))
    # one with a mesh of its own has them too
    own = text.replace(card, CUBE + BRICK + card)
    assert read_deck(deck(tmp_path, own)).element_sets
