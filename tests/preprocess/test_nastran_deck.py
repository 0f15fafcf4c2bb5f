"""Bulk data of Nastran: its three kinds of fields, continuations, and what is taken from a deck."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.deck import DeckMaterial
from heavylift.preprocess.finite_elements.geometry import read_deck, read_mesh
from heavylift.preprocess.finite_elements.named_files import mesh_files
from heavylift.preprocess.finite_elements.reference_elements import REFERENCE_NODES

TET = 0.5 * REFERENCE_NODES["tet10"]
HEX = 0.5 * (REFERENCE_NODES["hex8"] + 1.0)


def small(name, *fields, mark=""):
    """A card of small fields, with continuation lines as they are needed."""
    text, rest = "", [str(field) for field in fields]
    while True:
        text += f"{name:8}" + "".join(f"{word:8}" for word in rest[:8])
        rest = rest[8:]
        if not rest:
            return text.rstrip() + "\n"
        text = f"{text:<72}{mark:8}".rstrip() + "\n"
        name = mark


def large(name, *fields, mark="*"):
    text, rest = "", [str(field) for field in fields]
    name = f"{name}*"
    while True:
        text += f"{name:8}" + "".join(f"{word:16}" for word in rest[:4])
        rest = rest[4:]
        if not rest:
            return text.rstrip() + "\n"
        text = f"{text:<72}{mark:8}".rstrip() + "\n"
        name = mark


def free(name, *fields, mark=""):
    text, rest = "", [str(field) for field in fields]
    while True:
        text += ",".join([name, *rest[:8]])
        rest = rest[8:]
        if not rest:
            return text + "\n"
        text += f",{mark}\n"
        name = mark


def grids(write, nodes):
    return "".join(write("GRID", k, "", *x) for k, x in enumerate(nodes, 1))


def deck(tmp_path, text, name="body.bdf"):
    path = tmp_path / name
    path.write_text(text)
    return path


PROPERTY = "PSOLID,3,7\nMAT1,7,2.1+5,,0.3,7.85-9\n"


@pytest.mark.parametrize("suffix", [".bdf", ".nas", ".dat", ".fem"])
@pytest.mark.parametrize("mark", ["", "+A"])
@pytest.mark.parametrize("write", [small, large, free])
def test_ten_nodes_over_continuation_lines(tmp_path, write, mark, suffix):
    mark = {large: "*" + mark.strip("+")}.get(write, mark)
    text = "SOL 103\nCEND\nTITLE = a, b\nBEGIN BULK\n$ a comment\n" + grids(write, TET)
    text += write("CTETRA", 5, 3, *range(1, 11), mark=mark) + PROPERTY + "ENDDATA\nGRID,1,,9.,9.,9.\n"
    path = deck(tmp_path, text, f"body{suffix}")
    mesh = read_mesh(path)
    assert mesh.element_type == "tet10"
    np.testing.assert_allclose(mesh.nodes, TET, atol=1e-15)
    assert mesh.volume == pytest.approx(1 / 48, rel=1e-12)
    assert read_deck(path).body().material == DeckMaterial("MAT1 7", 210000.0, 0.3, 7.85e-9)


@pytest.mark.parametrize("write", [small, large, free])
def test_bricks(tmp_path, write):
    text = grids(write, HEX) + write("CHEXA", 1, 3, *range(1, 9), mark="+" if write is not large else "*")
    mesh = read_mesh(deck(tmp_path, text.lower()))
    assert mesh.element_type == "hex8"
    assert mesh.volume == pytest.approx(1.0, rel=1e-14)
    assert len(mesh.node_groups["PSOLID 3"]) == 8


def test_bricks_of_twenty_nodes_have_another_order(tmp_path):
    # middles of the bottom, of the upright edges, of the top
    order = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]
    places = 0.5 * (REFERENCE_NODES["hex20"] + 1.0)
    text = grids(free, places[order]) + free("CHEXA", 1, 3, *range(1, 21), mark="+")
    mesh = read_mesh(deck(tmp_path, text))
    assert mesh.element_type == "hex20"
    np.testing.assert_allclose(mesh.nodes[mesh.elements[0]], places)
    assert mesh.volume == pytest.approx(1.0, rel=1e-14)


def test_fields_of_one_card_may_differ_from_line_to_line(tmp_path):
    # first line of small fields, continuation in free ones
    cell = small("CHEXA", 1, 3, 1, 2, 3, 4, 5, 6) + "+,7,8\n"
    assert read_mesh(deck(tmp_path, grids(small, HEX) + cell)).volume == pytest.approx(1.0)


def test_numbers_without_the_letter_of_the_exponent(tmp_path):
    nodes = grids(free, 1000 * HEX).replace("1000.0", "1.0+3")
    mesh = read_mesh(deck(tmp_path, nodes + free("CHEXA", 1, 3, *range(1, 9), mark="+")), length_unit=1e-3)
    assert mesh.volume == pytest.approx(1.0, rel=1e-12)


def test_properties_are_chosen_and_supports_are_groups(tmp_path):
    upper = [(x, y, z + 2.0) for x, y, z in HEX]
    text = (
        grids(free, [*HEX, *upper]) + free("CHEXA", 1, 3, *range(1, 9)) + free("CHEXA", 2, 4, *range(9, 17))
    )
    text += "PSOLID,3,7\nPSOLID,4,8\nMAT1,7,2.1+5,,0.3,7.85-9\nMAT1,8,,26923.076923,0.3,2.7-9\n"
    text += "SPC1,1,123,1,THRU,4\nSPC,1,9,3,0.0,12,1\nSET1,6,5,6,7,\nPARAM,WTMASS,2.\nRBE2,9,1,123,2\n"
    found = read_deck(deck(tmp_path, text))
    with pytest.raises(InputError, match=r"2 parts with no node in common: 1 .*'PSOLID 3'.*; 2 .*'PSOLID 4'"):
        found.body()
    lower, second = found.body(elements=["PSOLID 3"]), found.body(elements=["psolid 4"])
    assert lower.mesh.node_groups["SPC 1"].tolist() == [0, 1, 2, 3]
    assert lower.mesh.node_groups["SET1 6"].tolist() == [4, 5, 6]
    assert second.mesh.node_groups["SPC 1"].tolist() == [0, 3]
    assert lower.material.density == pytest.approx(2 * 7.85e-9)
    assert second.material.young_modulus == pytest.approx(70000.0, rel=1e-9)
    assert "densities are multiplied by WTMASS = 2" in lower.notes
    assert any("1 SPC1, 1 SPC, 1 RBE2" in note for note in lower.notes)


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("PSHELL,1,7,0.1\nCQUAD4,9,1,1,2,3,4\n", r"contains 1 shell elements CQUAD4 \(first: element 9\)"),
        ("PBARL,1,7,,ROD\n+,0.1\nCBAR,9,1,1,2,,,1.\n", "1 beam elements CBAR"),
        ("PROD,1,7,0.1\nCROD,9,1,1,2\n", "1 truss elements CROD"),
        ("CPENTA,9,3,1,2,3,5,6,7\n", "1 6-node wedges CPENTA"),
        ("CTETRA,9,3,1,2,3,5\n", "1 4-node tetrahedra CTETRA .*expected 10-node tetrahedra .*lock"),
        ("CHEXA,9,3,1,2,3,4,5,6\n+,7,8,1,2,3,4,5,6\n", "1 14-node bricks CHEXA"),
        ("CTETRA,9,3,1,2,3,5,6,7\n", "1 6-node tetrahedra CTETRA"),
    ],
)
def test_other_elements_are_told(tmp_path, cards, words):
    text = grids(free, HEX) + free("CHEXA", 1, 3, *range(1, 9)) + cards
    with pytest.raises(InputError, match=words):
        read_mesh(deck(tmp_path, text))


def test_shells_without_property_carry_groups(tmp_path):
    text = grids(free, HEX) + free("CHEXA", 1, 3, *range(1, 9)) + "CQUAD4,9,5,1,2,3,4\nCBAR,8,6,1,2\n"
    body = read_deck(deck(tmp_path, text)).body()
    assert body.mesh.volume == pytest.approx(1.0)
    assert body.mesh.node_groups["PSHELL 5"].tolist() == [0, 1, 2, 3]
    assert body.mesh.node_groups["PBAR 6"].tolist() == [0, 1]
    assert "left out: 1 shell elements without property CQUAD4" in body.notes


def test_masses_and_springs_are_left_out_and_said(tmp_path):
    text = grids(free, HEX) + free("CHEXA", 1, 3, *range(1, 9)) + "CONM2,9,1,,2.5\nCELAS1,8,1,1,1\n"
    notes = read_deck(deck(tmp_path, text)).body().notes
    assert "left out: 1 point masses CONM2" in notes
    assert "left out: 1 springs, dashpots, gaps or couplings CELAS1" in notes


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            "GRID,7,,",
            "GRID,7,2,",
            r"line 7: GRID: coordinate system 2 does not exist; expected 0 or the number of a CORD",
        ),
        ("GRID,7,,1.0,1.0,1.0", "GRID,7,,1.0,1.0,1.0,2", r"line 7: GRID: coordinate system 2 does not exist"),
        ("GRID,1,", "GRDSET,,4\nGRID,1,", r"line 2: GRID: coordinate system 4 does not exist"),
        ("GRID,7,,1.0", "GRID,7,,one", r"line 7: GRID: 'one'; expected a number"),
        ("GRID,7,", "GRID,77,", r"element 1 \(CHEXA\): node 7 does not exist"),
        ("1,3,1,2,3", "1,3,1,2,x", r"line 9: CHEXA: 'x'; expected a whole number"),
        ("1,3,1,2,3,4,5,6,", "1,3,1,2,3,4,5", r"line 9: CHEXA: element 1 has 7 nodes"),
    ],
)
def test_faults_are_named_by_file_and_line(tmp_path, old, new, words):
    text = grids(free, HEX) + free("CHEXA", 1, 3, *range(1, 9))
    assert old in text
    with pytest.raises(InputError, match=words):
        read_mesh(deck(tmp_path, text.replace(old, new, 1)))


def test_anisotropic_and_nonlinear_materials(tmp_path):
    text = grids(free, HEX) + free("CHEXA", 1, 3, *range(1, 9))
    found = read_deck(deck(tmp_path, text + "PSOLID,3,7\nMAT9,7,1.,2.\n")).body()
    assert found.material.refused == "anisotropic (MAT9)"
    found = read_deck(deck(tmp_path, text + PROPERTY + "MATS1,7,,PLASTIC\n")).body()
    assert found.material.notes == ("MAT1 7: its MATS1 is left out: nonlinear",)


def test_files_are_included_and_none_from_outside(tmp_path):
    folder = tmp_path / "case"
    folder.mkdir()
    (folder / "nodes.inc").write_text(grids(free, HEX))
    path = deck(folder, "include 'nodes.inc'\n" + free("CHEXA", 1, 3, *range(1, 9)))
    assert read_mesh(path).volume == pytest.approx(1.0)
    assert [file.name for file in mesh_files(path, folder)] == ["body.bdf", "nodes.inc"]
    (tmp_path / "secret.inc").write_text(grids(free, HEX))
    with pytest.raises(InputError, match=r"line 1: includes '../secret.inc', which leaves the folder"):
        read_mesh(deck(folder, "INCLUDE '../secret.inc'\n"))
    with pytest.raises(InputError, match="includes itself"):
        read_mesh(deck(folder, "INCLUDE 'body.bdf'\n"))


def test_what_is_no_deck_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"body.bdf: contains no GRID; expected bulk data of Nastran"):
        read_mesh(deck(tmp_path, "not a body\n"))
    path = tmp_path / "body.nas"
    path.write_bytes(b"\0\1\2")
    with pytest.raises(InputError, match="is not a text file"):
        read_mesh(path)


BLOCK = grids(free, HEX) + free("CHEXA", 1, 3, *range(1, 9)) + PROPERTY


@pytest.mark.parametrize("line", ["PARAM,WTMASS,1.-3", "  param, wtmass, 0.001", "PARAM   WTMASS  1.0-3"])
def test_factor_on_masses_of_case_control(tmp_path, line):
    body = read_deck(deck(tmp_path, f"SOL 103\nCEND\n{line}\nBEGIN BULK\n{BLOCK}ENDDATA\n")).body()
    assert body.material.density == pytest.approx(7.85e-12, rel=1e-14)
    assert "densities are multiplied by WTMASS = 0.001" in body.notes


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("=,*(1),=,*(2.),==\n", r"line 14: '=' replicates the entry before"),
        ("=(3)\n", r"line 14: '=\(3\)' replicates"),
        ("*(1),=\n", r"line 14: '\*\(1\)' replicates"),
        ("GRID,8,,9.,9.,9.\n", r"line 14: GRID: node 8 is defined twice"),
        ("GRID,8,2,0.,1.,1.\n", r"line 14: GRID: node 8 is defined twice"),
        ("GRID,8,0,0.,1.,1.\nGRID,8,,0.,1.,1.,5\n", r"line 15: GRID: node 8 is defined twice"),
        ("MAT1,7,7.+4,,0.3,7.85-9\n", r"line 14: MAT1: material 7 is defined twice"),
        ("PSOLID,3,7\nPSOLID,3,8\n", r"line 15: PSOLID: property 3 is defined twice, of material 7 and 8"),
        ("BEGIN SUPER=2\n", r"line 14: BEGIN SUPER=2: a superelement"),
        ("BEGIN BULK SUPER = 2\n", r"line 14: BEGIN BULK SUPER = 2: a superelement"),
        ("PARAM,WTMASS,2.\nPARAM,WTMASS,3.\n", r"line 15: PARAM: WTMASS is 2 and 3"),
        ("GRID,--1,,1.,1.,1.\n", r"line 14: GRID: '--1'; expected a whole number"),
        ("GRID,\u00b2,,1.,1.,1.\n", r"line 14: GRID: '\u00b2'; expected a whole number"),
    ],
)
def test_replicated_redefined_and_odd_numbers_are_refused(tmp_path, more, words):
    path = tmp_path / "body.bdf"
    path.write_text("BEGIN BULK\n" + BLOCK + more, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_mesh(path)


def test_same_definitions_twice_pass_and_nonstructural_masses_are_said(tmp_path):
    body = read_deck(deck(tmp_path, BLOCK + BLOCK + "NSM1,4,PSHELL,2.,3\nNSML,5,PSHELL,3,1.\n")).body()
    assert body.mesh.volume == pytest.approx(1.0)
    assert "left out: 1 nonstructural masses NSM1" in body.notes
    assert "left out: 1 nonstructural masses NSML" in body.notes
