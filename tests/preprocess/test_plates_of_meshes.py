"""Plates and stiffeners of meshes without thickness (universal files, gmsh, MED): a case gives it by group."""

from __future__ import annotations

import meshio
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
from heavylift.preprocess.finite_elements.geometry import read_deck, read_mesh
from heavylift.preprocess.finite_elements.reference_elements import REFERENCE_NODES
from heavylift.preprocess.structures.bar_shapes import shape_section

STEEL = {"young_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}
POINTS = np.array([(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0), (0.0, 1.0, 0.0), (3.0, 0.0, 0.0)])
QUADS, TRIANGLES, LINES = np.array([[0, 1, 2, 3]]), np.array([[1, 4, 2]]), np.array([[0, 1]])


def dataset(number, *lines):
    return "\n".join(["    -1", f"{number:6d}", *lines, "    -1"]) + "\n"


def unv(nodes, elements, groups=()):
    """Nodes, elements as (label, descriptor, property, nodes), groups as (name, entity, labels)."""
    rows = []
    for label, x in enumerate(nodes, 1):
        rows += [
            f"{label:10d}{1:10d}{1:10d}{11:10d}",
            "".join(f"{value:25.16E}" for value in x).replace("E", "D"),
        ]
    cells = []
    for label, kind, property_id, members in elements:
        cells.append("".join(f"{k:10d}" for k in (label, kind, property_id, 1, 7, len(members))))
        if kind in {11, 21, 22}:
            cells.append(f"{0:10d}{1:10d}{1:10d}")
        cells += ["".join(f"{k:10d}" for k in members[j : j + 8]) for j in range(0, len(members), 8)]
    lists = []
    for number, (name, entity, labels) in enumerate(groups, 1):
        lists += ["".join(f"{k:10d}" for k in (number, 0, 0, 0, 0, 0, 0, len(labels))), name]
        pairs = [f"{entity:10d}{label:10d}{0:10d}{0:10d}" for label in labels]
        lists += ["".join(pairs[k : k + 2]) for k in range(0, len(pairs), 2)]
    units = dataset(164, f"{1:10d}SI: Meter (newton)         2")
    return units + dataset(2411, *rows) + dataset(2412, *cells) + dataset(2467, *lists)


def mesh():
    return meshio.Mesh(
        POINTS,
        [("quad", QUADS), ("triangle", TRIANGLES), ("line", LINES)],
        cell_data={
            "gmsh:physical": [np.array([1]), np.array([1]), np.array([2])],
            "gmsh:geometrical": [np.array([1])] * 3,
        },
        field_data={"deck": np.array([1, 2]), "rib": np.array([2, 1])},
    )


@pytest.fixture(params=["unv", "msh", "med"])
def path(request, tmp_path):
    file = tmp_path / f"body.{request.param}"
    if request.param == "unv":
        elements = [(7, 94, 1, [1, 2, 3, 4]), (8, 91, 1, [2, 5, 3]), (9, 21, 2, [1, 2])]
        file.write_text(unv(POINTS, elements, [("deck", 8, [7, 8]), ("rib", 8, [9]), ("ends", 7, [1, 5])]))
    elif request.param == "msh":
        meshio.write(file, mesh(), file_format="gmsh22", binary=False)
    else:
        made = meshio.Mesh(
            POINTS,
            [("quad", QUADS), ("triangle", TRIANGLES), ("line", LINES)],
            cell_data={"cell_tags": [np.array([-1]), np.array([-1]), np.array([-2])]},
        )
        made.cell_tags = {-1: ["deck"], -2: ["rib"]}
        made.point_tags = {}
        made.write(file)
    return file


RIB = BeamProperty(shape_section("BAR", (0.012, 0.15)), (0.0, 0.0, 1.0), offset=(0.08, 0.0))


def test_a_case_gives_what_a_mesh_lacks(path):
    deck = read_deck(path)
    assert has_structure(deck, ())
    options = {"given": STEEL, "length_unit": 1.0, "mass_unit": 1.0}
    plates = {"deck": PlateProperty(thickness=0.01, nonstructural_mass=10.0)}
    made = structure_of(deck, plates=plates, beams={"rib": RIB}, **options)
    masses = {one.name: 0.0 for one in property_masses(made)}
    for one in property_masses(made):
        masses[one.name] += one.mass
    assert masses == pytest.approx({"deck": 2.5 * (78.5 + 10.0), "rib": 2 * 0.0018 * 7850})
    assert made.beams[0].offset_a.tolist() == [[0.0, 0.0, 0.08]]
    assert sorted(made.node_groups["rib"]) == [0, 1]
    with pytest.raises(InputError, match="no thickness"):
        structure_of(deck, beams={"rib": RIB}, **options)
    alone = structure_of(deck, plates=plates, **options)
    assert alone.beams == ()
    assert "left out: 1 lines without a section, which are groups" in alone.notes


def test_solids_of_a_universal_file(tmp_path):
    """Middle nodes stand between the corners there: the volume of a straight element tells the order."""
    file = tmp_path / "body.unv"
    tet = 0.5 * REFERENCE_NODES["tet10"]
    order = [0, 4, 1, 5, 2, 6, 7, 8, 9, 3]
    nodes = [tet[k] for k in order]
    file.write_text(unv(nodes, [(1, 118, 1, list(range(1, 11)))]))
    assert read_mesh(file).volume == pytest.approx(1 / 48, rel=1e-12)
    brick = 0.5 * (REFERENCE_NODES["hex20"] + 1.0)
    order = [0, 8, 1, 9, 2, 10, 3, 11, 16, 17, 18, 19, 4, 12, 5, 13, 6, 14, 7, 15]
    file.write_text(unv([brick[k] for k in order], [(1, 116, 1, list(range(1, 21)))]))
    assert read_mesh(file).volume == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (f"{4:10d}\n    -1", f"{44:10d}\n    -1", r"line 20: element 7: node 44 does not exist"),
        (f"{7:10d}{94:10d}", f"{7:10d}{95:10d}", r"group 'property 1' has no plates"),
        (f"{5:10d}{1:10d}{1:10d}{11:10d}", f"{4:10d}{1:10d}{1:10d}{11:10d}", r"node 4 is defined twice"),
        ("0.0000000000000000D+00", "zero", r"line 8: .*expected three coordinates"),
    ],
)
def test_faults_of_universal_files(tmp_path, old, new, words):
    file = tmp_path / "body.unv"
    text = unv(POINTS, [(7, 94, 1, [1, 2, 3, 4])])
    assert old in text
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=words):
        structure_of(read_deck(file), plates={"property 1": PlateProperty(thickness=0.01)}, given=STEEL)


def test_plates_with_middle_nodes_are_refused(tmp_path):
    middle = 0.5 * (POINTS[[0, 1, 2, 3]] + POINTS[[1, 2, 3, 0]])
    made = meshio.Mesh(
        np.vstack([POINTS, middle]),
        [("quad8", np.array([[0, 1, 2, 3, 5, 6, 7, 8]])), ("triangle", TRIANGLES)],
    )
    made.write(tmp_path / "body.vtu")
    with pytest.raises(InputError, match="contains 1 cells 'quad8'"):
        structure_of(read_deck(tmp_path / "body.vtu"), given=STEEL, length_unit=1.0, mass_unit=1.0)
