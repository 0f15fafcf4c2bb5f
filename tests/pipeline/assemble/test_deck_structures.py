"""A case whose body is a deck of plates, bars, masses and rigid elements; what a user reads if it does not fit."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.assemble.finite_elements import assemble_model, model_properties, write_vtu
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.results.provenance import mesh_digest

CASE = """\
title = "Panel of a deck"
sources = ["made for tests"]
[bodies.panel]
type = "flexible"
frame = { motion = "free" }
[bodies.panel.geometry]
type = "mesh"
file = "panel.bdf"
[bodies.panel.modes]
count = 3
"""


def panel(across=3, along=4, *, properties=True):
    """A plate of 4 x 3 m with bars along y = 1, in mm, t and s; a mass above its middle on a rigid element."""
    grid = [(1000.0 * i, 1000.0 * j, 0.0) for j in range(across + 1) for i in range(along + 1)]
    wide = along + 1
    cells = [(1 + i + wide * j, 2 + i + wide * j, 2 + wide + i + wide * j, 1 + wide + i + wide * j)
             for j in range(across) for i in range(along)]  # fmt: skip
    text = "".join(f"GRID,{k},,{x},{y},{z}\n" for k, (x, y, z) in enumerate(grid, 1))
    text += "".join(f"CQUAD4,{k},1,{','.join(map(str, nodes))}\n" for k, nodes in enumerate(cells, 101))
    offset = "\n,,,0.,0.,80.,0.,0.,80." if properties else ""
    text += "".join(
        f"CBAR,{201 + i},2,{1 + i + wide},{2 + i + wide},0.,0.,1.{offset}\n" for i in range(along)
    )
    if properties:
        text += "PSHELL,1,1,10.,1,,1\nPBARL,2,1,,BAR\n,12.,150.\nMAT1,1,2.06+5,,.3,7.85-9\n"
    return text + "GRID,99,,2000.,1500.,500.\nRBE2,300,99,123456,7,8,12,13\nCONM2,301,99,,0.5\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "panel.bdf").write_text(panel())
    return tmp_path


def model_of(folder, name="panel"):
    case = load_case(folder)
    return assemble_model(case, name, case.bodies[name])


BY_HAND = 12 * 0.01 * 7850.0 + 4 * 0.0018 * 7850.0 + 500.0


def test_a_deck_of_plates_and_bars(folder, tmp_path):
    model = model_of(folder)
    assert model.total_mass == pytest.approx(BY_HAND, rel=1e-9)
    assert any("units of the file: mm, t, s, N" in note for note in model.notes)
    assert model.structure is not None
    properties = model_properties(model)
    assert (properties["node_count"], properties["element_count"]) == (21, 16)
    assert properties["dof_count"] == 6 * 21 - 6 * 4  # four nodes follow the rigid element
    write_vtu(tmp_path / "panel.vtu", model)
    import meshio

    drawn = meshio.read(tmp_path / "panel.vtu")
    assert {block.type: len(block.data) for block in drawn.cells} == {"quad": 12, "line": 4}


def test_what_the_file_lacks_stands_in_the_case(folder):
    (folder / "panel.bdf").write_text(panel(properties=False))
    case = CASE.replace('file = "panel.bdf"', 'file = "panel.bdf"\nlength_unit = "1 mm"\nmass_unit = "1 t"')
    case += """\
[bodies.panel.material]
young_modulus = "206 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[bodies.panel.plates."PSHELL 1"]
thickness = "10 mm"
[bodies.panel.stiffeners."PBAR 2"]
section = { shape = "flat", height = "150 mm", thickness = "12 mm" }
web = [0, 0, 1]
foot = "5 mm"
"""
    (folder / "case.toml").write_text(case)
    model = model_of(folder)
    assert model.total_mass == pytest.approx(BY_HAND, rel=1e-9)
    (beams,) = model.structure.beams
    np.testing.assert_allclose(beams.offset_a, np.tile([0.0, 0.0, 0.08], (4, 1)), atol=1e-15)
    # what the case gives is part of what the mesh depends on
    digests = set()
    for old, new in (("", ""), ('"10 mm"', '"20 mm"'), ('"150 mm"', '"140 mm"'), ('"5 mm"', '"6 mm"')):
        (folder / "case.toml").write_text(case.replace(old, new) if old else case)
        changed = load_case(folder)
        digests.add(mesh_digest(changed, changed.bodies["panel"]))
    assert len(digests) == 4


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("PSHELL,1,1,10.", "PSHELL,1,1,", r"panel\.bdf: line \d+: CQUAD4: element 101 has no thickness"),
        (
            "1,,1\nPBARL",
            "1,,1\nMAT1,9,2.1+11,,.3,7850.\nPSHELL,9,9,1.,9\nCTRIA3,999,9,1,2,7\nPBARL",
            "mixed units",
        ),
        (",0.,0.,1.\n", ",0.,0.,0.\n", "element 201 has an orientation along the beam"),
        ("7.85-9", "7.85-3", r"case\.toml: bodies\.panel\.geometry\.length_unit: material 'MAT1 1' has"),
    ],
)
def test_faults_of_the_file_are_named(folder, old, new, words):
    text = (folder / "panel.bdf").read_text()
    assert old in text
    (folder / "panel.bdf").write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=words):
        model_of(folder)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (
            '[bodies.panel.plates."PSHELL 7"]\nthickness = 0.1\n',
            r"case\.toml: bodies\.panel\.plates\.PSHELL 7: .*exist",
        ),
        (
            '[bodies.panel.plates."PBAR 2"]\nthickness = 0.1\n',
            r"plates\.PBAR 2: group 'PBAR 2' has no plates",
        ),
        (
            '[bodies.panel.mesh]\nformulation = "full"\n',
            r"bodies\.panel\.mesh\.formulation: 'full' with plates",
        ),
        ('[bodies.panel.stiffeners."PBAR 2"]\nfoot = 0.1\n', r"'foot' without 'section'"),
        (
            '[bodies.panel.plates."PSHELL 1".material]\ndensity = 1.0\n',
            r"PSHELL 1\.material: no 'young_modulus'",
        ),
    ],
)
def test_faults_of_the_case_are_named(folder, more, words):
    with (folder / "case.toml").open("a") as stream:
        stream.write(more)
    with pytest.raises(InputError, match=words):
        model_of(folder)


def test_groups_of_elements_belong_to_mesh_files(folder):
    text = CASE.replace('type = "mesh"\nfile = "panel.bdf"', 'type = "four_files"\nfolder = "."')
    (folder / "case.toml").write_text(text + "[bodies.panel.plates.deck]\nthickness = 0.1\n")
    with pytest.raises(InputError, match="'plates' with geometry 'four_files'"):
        load_case(folder)


def test_solids_have_no_tables_of_plates(folder):
    cube = [(x, y, z) for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))]
    text = "".join(f"GRID,{k},,{x},{y},{z}\n" for k, (x, y, z) in enumerate(cube, 1))
    text += "CHEXA,1,3,1,2,3,4,5,6\n,7,8\nPSOLID,3,7\nMAT1,7,2.1+11,,.3,7850.\n"
    (folder / "panel.bdf").write_text(text)
    with (folder / "case.toml").open("a") as stream:
        stream.write("[bodies.panel.plates.deck]\nthickness = 0.1\n")
    with pytest.raises(InputError, match="has no plates and no beams, and the case has 'deck'"):
        model_of(folder)
