"""A case whose body stands in a deck: its material, parts and includes, and what a user reads if they do not fit."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.case_file import load_case
from heavylift.pipeline.drawn.outer_surface import surface_from_mesh
from heavylift.pipeline.results.storage import read_json
from heavylift.pipeline.stages.stages import run_case

LENGTH, HEIGHT, WIDTH = 200.0, 20.0, 10.0  # mm
COUNTS = (16, 2, 2)

BODY = """\
title = "Beam of a deck"
sources = ["made for tests"]
[bodies.beam]
type = "flexible"
frame = { motion = "fixed" }
[bodies.beam.geometry]
type = "mesh"
file = "beam.inp"
length_unit = "1 mm"
mass_unit = "1 t"
[bodies.beam.modes]
count = 2
clamp = ["Root"]
"""
STEEL = """\
*MATERIAL, NAME=Steel
*ELASTIC
210000., 0.3
*PLASTIC
200., 0.
*DENSITY
7.8E-9
*SOLID SECTION, ELSET=Beam, MATERIAL=Steel
*BOUNDARY
Root, 1, 3
"""


def beam_deck():
    """Nodes and bricks of a bar along x, in mm."""
    nx, ny, nz = COUNTS
    grid = [
        (LENGTH * i / nx, HEIGHT * j / ny, WIDTH * k / nz)
        for k in range(nz + 1)
        for j in range(ny + 1)
        for i in range(nx + 1)
    ]

    def number(i, j, k):
        return 1 + i + (nx + 1) * (j + (ny + 1) * k)

    nodes = "".join(f"{label}, {x:.6f}, {y:.6f}, {z:.6f}\n" for label, (x, y, z) in enumerate(grid, 1))
    ring = ((0, 0), (1, 0), (1, 1), (0, 1))
    cells, label = "", 0
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                label += 1
                corners = [number(i + a, j + b, k + c) for c in (0, 1) for a, b in ring]
                cells += f"{label}, " + ", ".join(map(str, corners)) + "\n"
    root = "".join(f"{label},\n" for label, (x, _, _) in enumerate(grid, 1) if x == 0.0)
    return f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8I, ELSET=Beam\n{cells}*NSET, NSET=Root\n{root}"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "case.toml").write_text(BODY)
    (tmp_path / "beam.inp").write_text("*INCLUDE, INPUT=mesh.inc\n" + STEEL)
    (tmp_path / "mesh.inc").write_text(beam_deck())
    return tmp_path


def modes_of(folder):
    report = run_case(load_case(folder), stages=("mesh", "modes"))
    assert not report.message
    return read_json(report.folder.manifest("mesh"))["items"]["beam"]["properties"], report


def euler_bernoulli():
    """First frequencies of the cantilever in its two directions [Hz]: (1.8751 / L)^2 sqrt(E I / rho A) / 2 pi."""
    speed = np.sqrt(2.1e11 / 7800.0)
    return 1.8751041**2 / (2 * np.pi * 0.2**2) * speed * np.array([0.01, 0.02]) / np.sqrt(12)


def test_mass_and_frequencies_of_a_beam_with_the_material_of_its_deck(folder):
    properties, report = modes_of(folder)
    assert properties["mass"] == pytest.approx(0.2 * 0.02 * 0.01 * 7800.0, rel=1e-9)
    found = read_json(report.folder.manifest("modes"))["items"]["beam"]["properties"]["frequencies_hz"]
    # shear and the clamped cross section are worth 2 % at a slenderness of 10
    np.testing.assert_allclose(found, euler_bernoulli(), rtol=0.02)
    notes = properties["notes"]
    assert "material Steel: plasticity is left out" in notes
    assert any("1 *BOUNDARY" in note for note in notes)


def test_an_edit_of_an_included_file_is_seen(folder):
    modes_of(folder)
    assert run_case(load_case(folder), stages=("mesh",)).stage("mesh").skipped
    mesh = folder / "mesh.inc"
    mesh.write_text(mesh.read_text().replace("200.000000,", "210.000000,"))
    assert not run_case(load_case(folder), stages=("mesh",)).stage("mesh").skipped


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            'mass_unit = "1 t"\n',
            "",
            r"case.toml: bodies.beam.geometry.mass_unit: no unit of mass for the young",
        ),
        (
            "[bodies.beam.modes]",
            "[bodies.beam.material]\ndensity = 7850\n[bodies.beam.modes]",
            r"case.toml: bodies.beam.material.density: 7850 kg/m\^3, and material 'Steel' of the file has 7800",
        ),
        (
            '"1 t"',
            '"1 t"\npart = 2',
            r"case.toml: bodies.beam.geometry.part: 2; expected no part: there is one only",
        ),
        (
            '"1 t"',
            '"1 t"\nelements = ["beams"]',
            r"bodies.beam.geometry.elements: element set 'beams' does not exist; did you mean 'Beam'",
        ),
        (
            '"1 t"',
            '"1 t"\nmerge_nodes = "11 mm"',
            r"bodies.beam.geometry.merge_nodes: .*collapses element 1 \(C3D8I\)",
        ),
        ('"1 t"', '"1 t"\nignore_material = true', r"case.toml: bodies.beam: no 'material'"),
    ],
)
def test_what_does_not_fit_is_one_line(folder, old, new, words):
    case = folder / "case.toml"
    case.write_text(case.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=words) as caught:
        modes_of(folder)
    assert "\n" not in str(caught.value)


def test_a_body_of_two_materials_has_the_mass_of_both(folder):
    deck = folder / "beam.inp"
    half = COUNTS[0] * COUNTS[1]  # elements of the lower layer
    two = f"*ELSET, ELSET=Low, GENERATE\n1, {half}\n*MATERIAL, NAME=Aluminium\n"
    two += "*ELASTIC\n70000., 0.3\n*DENSITY\n2.7E-9\n"
    deck.write_text(deck.read_text() + two + "*SOLID SECTION, ELSET=Low, MATERIAL=Aluminium\n")
    properties, _ = modes_of(folder)
    assert properties["mass"] == pytest.approx(0.2 * 0.02 * 0.01 * (7800.0 + 2700.0) / 2, rel=1e-9)
    assert "2 materials: Steel, Aluminium; such a body has no stress" in properties["notes"]
    case = folder / "case.toml"
    case.write_text(case.read_text() + "[bodies.beam.material]\npoisson_ratio = 0.3\ndensity = 7800\n")
    with pytest.raises(InputError, match=r"7800 kg/m\^3, and material 'Aluminium' of the file has 2700"):
        modes_of(folder)


def test_a_density_that_the_deck_lacks_comes_from_the_case(folder):
    deck = folder / "beam.inp"
    deck.write_text(deck.read_text().replace("*DENSITY\n7.8E-9\n", ""))
    with pytest.raises(
        InputError, match=r"bodies.beam.material.density: no 'density': material 'Steel' of the file"
    ):
        modes_of(folder)
    case = folder / "case.toml"
    case.write_text(case.read_text() + '[bodies.beam.material]\ndensity = "7800 kg/m^3"\n')
    assert modes_of(folder)[0]["mass"] == pytest.approx(0.312, rel=1e-9)


def test_the_file_as_a_mesh_only(folder):
    deck = folder / "beam.inp"
    deck.write_text(deck.read_text().replace("*ELASTIC\n210000., 0.3", "*HYPERELASTIC, NEO HOOKE\n80., 0.1"))
    with pytest.raises(InputError, match="material 'Steel' is hyperelastic"):
        modes_of(folder)
    case = folder / "case.toml"
    text = case.read_text().replace('"1 t"', '"1 t"\nignore_material = true')
    case.write_text(
        text + '[bodies.beam.material]\nyoung_modulus = "70 GPa"\npoisson_ratio = 0.3\ndensity = 2700\n'
    )
    assert modes_of(folder)[0]["mass"] == pytest.approx(0.2 * 0.02 * 0.01 * 2700.0, rel=1e-9)


def test_a_material_is_whole_where_no_file_brings_it(folder):
    case = folder / "case.toml"
    blocks = 'type = "blocks"\nadd = [{ name = "bar", from = [0, 0, 0], to = [1, 1, 1] }]\n'
    head, _, tail = case.read_text().partition('type = "mesh"')
    tail = tail[tail.index("[bodies.beam.modes]") :]
    case.write_text(head + blocks + "[bodies.beam.material]\nyoung_modulus = 2e11\ndensity = 7800\n" + tail)
    with pytest.raises(
        InputError, match=r"case.toml: bodies.beam.material.poisson_ratio: no 'poisson_ratio'"
    ):
        load_case(folder)


def test_a_body_of_matrices_has_the_frequencies_of_its_deck(folder):
    expected, report = modes_of(folder)
    from heavylift.pipeline.results.model_io import read_model

    model = read_model(report.folder.model("beam"))
    # what CalculiX writes, from our own matrices: this is about the way through a case
    for suffix, matrix in ((".sti", 1e-3 * model.stiffness), (".mas", 1e-3 * model.full_mass())):
        upper = matrix.tocoo()
        keep = upper.row <= upper.col
        rows = zip(upper.row[keep] + 1, upper.col[keep] + 1, upper.data[keep], strict=True)
        (folder / f"beam{suffix}").write_text("".join(f"{i} {j} {value:20.13e}\n" for i, j, value in rows))
    (folder / "beam.dof").write_text(
        "".join(f"{1 + k // 3}.{1 + k % 3}\n" for k in range(3 * model.node_count))
    )
    before = read_json(report.folder.manifest("modes"))["items"]["beam"]["properties"]["frequencies_hz"]
    case = folder / "case.toml"
    text = case.read_text().replace('type = "mesh"', 'type = "matrices"\nstiffness_unit = "1 N/mm"')
    case.write_text(text)
    properties, report = modes_of(folder)
    assert properties["mass"] == pytest.approx(expected["mass"], rel=1e-10)
    after = read_json(report.folder.manifest("modes"))["items"]["beam"]["properties"]["frequencies_hz"]
    # 14 digits in the files, of which bending of a slender bar costs some
    np.testing.assert_allclose(after, before, rtol=1e-8)
    (folder / "beam.mas").unlink()
    with pytest.raises(InputError, match=r"beam.mas: does not exist"):
        modes_of(folder)


@pytest.mark.parametrize(("formulation", "across"), [("full", 1), ("reduced", 2)])
def test_a_deck_of_bricks_of_20_nodes(folder, with_middle_nodes, formulation, across):
    from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks

    bar = Box("bar", (0, 0, 0), (LENGTH, HEIGHT, WIDTH))
    divisions = {"x": [12], "y": [across], "z": [across]}
    mesh = with_middle_nodes(mesh_blocks([bar], element_type="hex8", divisions=divisions))
    text = "*NODE\n" + "".join(
        f"{k}, {x:.9g}, {y:.9g}, {z:.9g}\n" for k, (x, y, z) in enumerate(mesh.nodes, 1)
    )
    text += "*ELEMENT, TYPE=C3D20R, ELSET=Beam\n"
    for number, cell in enumerate(mesh.elements + 1, 1):
        text += f"{number}, {', '.join(map(str, cell[:15]))},\n{', '.join(map(str, cell[15:]))}\n"
    root = np.flatnonzero(mesh.nodes[:, 0] == 0.0) + 1
    (folder / "mesh.inc").write_text(text + "*NSET, NSET=Root\n" + ",\n".join(map(str, root)) + "\n")
    case = folder / "case.toml"
    case.write_text(f'{BODY}[bodies.beam.mesh]\nformulation = "{formulation}"\n')
    _, report = modes_of(folder)
    found = read_json(report.folder.manifest("modes"))["items"]["beam"]["properties"]["frequencies_hz"]
    np.testing.assert_allclose(found, euler_bernoulli(), rtol=0.02)
    # a closed surface of F faces has F + 2 corners and 2 F edges with a middle node each; pictures draw their halves
    drawn = surface_from_mesh(mesh)
    assert len(drawn.element_edges) == 2 * 2 * (drawn.nodes.shape[0] - 2) // 3
    case.write_text(case.read_text().replace(formulation, "incompatible"))
    with pytest.raises(
        InputError, match="'incompatible' is not a formulation of hex20; expected one of 'full'"
    ):
        modes_of(folder)
