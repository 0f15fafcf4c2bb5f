"""The four-file interface: the authors' own data, round trips, hidden boundary conditions, faulty files."""

from __future__ import annotations

import dataclasses
import shutil
import time

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csr_array

from heavylift.modal.eigen import eigenmodes
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.exchange import (
    longitudinal_wave_speed,
    read_four_files,
    write_four_files,
)
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import Material

# E in Pa and rho in kg/m3 on lengths in mm; and N, mm, t
COMPLEX_BEAM_UNITS = {"length_unit": 1e-3, "mass_factor": 1e-9, "stiffness_factor": 1e-3}
SLIDING_BEAM_UNITS = {"length_unit": 1e-3, "mass_factor": 1e3, "stiffness_factor": 1e3}


def _frequencies(data, *, projected=False):
    free = np.setdiff1d(np.arange(data.model.node_count), data.fixed_nodes)
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    K = data.model.stiffness.toarray()[np.ix_(dofs, dofs)]
    M = data.model.full_mass().toarray()[np.ix_(dofs, dofs)]
    if projected:
        shapes = data.modes[dofs]
        K, M = shapes.T @ K @ shapes, shapes.T @ M @ shapes
    return np.sqrt(eigh(K, M, eigvals_only=True, subset_by_index=[0, 4])) / (2 * np.pi)


def test_complex_beam_of_the_thesis(mbsim_data):
    data = read_four_files(mbsim_data / "complex_beam", **COMPLEX_BEAM_UNITS)
    np.testing.assert_allclose(np.ptp(data.model.nodes, axis=0), [0.105, 0.03422, 0.02], rtol=1e-7)
    assert data.model.total_mass == pytest.approx(0.1689025516, rel=1e-7)
    np.testing.assert_allclose(data.model.nodes[data.fixed_nodes, 0], 0.0, atol=1e-8)
    assert data.fixed_nodes.size == 15
    assert any("15 nodes are clamped by a penalty" in note for note in data.notes)
    assert data.modes.shape == (1122, 5)
    # values of an independent program on the same files (docs/sources.md)
    full = [534.369031, 1071.686953, 2271.434705, 3099.474017, 6346.224034]
    np.testing.assert_allclose(_frequencies(data), full, rtol=1e-8)
    projected = [534.436976, 1071.74658, 2271.47245, 3099.50419, 6346.24395]
    np.testing.assert_allclose(_frequencies(data, projected=True), projected, rtol=1e-8)


def test_sliding_beam_of_the_thesis(mbsim_data):
    data = read_four_files(mbsim_data / "sliding_beam", **SLIDING_BEAM_UNITS)
    np.testing.assert_array_equal(data.fixed_nodes, np.arange(540, 549))
    np.testing.assert_allclose(data.model.nodes[data.fixed_nodes, 0], -0.75)
    assert any("omits 9 clamped nodes, 541 to 549" in note for note in data.notes)
    assert data.model.total_mass == pytest.approx(920 * 1.5 * 0.05 * 0.05, rel=1e-9)
    assert data.modes.shape == (3 * 549, 100)
    assert _frequencies(data)[0] == pytest.approx(0.726, abs=5e-4)


def test_files_are_read_in_well_under_a_second_a_megabyte(mbsim_data):
    folder = mbsim_data / "sliding_beam"
    megabytes = sum(file.stat().st_size for file in folder.glob("*.dat")) / 1e6
    start = time.process_time()
    read_four_files(folder, **SLIDING_BEAM_UNITS)
    assert time.process_time() - start < 0.5 * megabytes


@pytest.fixture(scope="module")
def bar():
    """A cantilever of bricks with its own eigenmodes: an independent producer of the four files."""
    mesh = mesh_blocks(
        [Box("bar", (0, 0, 0), (1.0, 0.1, 0.12))],
        element_type="hex8",
        divisions={"x": [7], "y": [1], "z": [2]},
        groups=[OnPlane("clamp", "x", 0.0)],
    )
    model = assemble(mesh, Material(7e10, 0.33, 2700.0), mass="lumped")
    clamp = mesh.node_groups["clamp"]
    free = np.setdiff1d(np.arange(mesh.node_count), clamp)
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    K = model.stiffness.toarray()[np.ix_(dofs, dofs)]
    M = np.diag(np.repeat(model.mass.diagonal()[free], 3))
    modes = np.zeros((3 * mesh.node_count, 6))
    modes[dofs] = eigh(K, M, subset_by_index=[0, 5])[1]
    return model, modes, clamp


@pytest.fixture
def files(bar, tmp_path):
    write_four_files(tmp_path / "bar", *bar[:2])
    return tmp_path / "bar"


def test_round_trip_gives_every_bit_back(bar, files):
    model, modes, clamp = bar
    data = read_four_files(files)
    np.testing.assert_array_equal(data.model.nodes, model.nodes)
    assert (data.model.stiffness != model.stiffness).nnz == 0
    assert (data.model.mass != model.mass).nnz == 0
    np.testing.assert_array_equal(data.modes, modes)
    np.testing.assert_array_equal(data.fixed_nodes, clamp)
    assert any(f"{clamp.size} nodes are clamped because their rows" in note for note in data.notes)
    # and once more, now with clamped nodes in the model
    write_four_files(files, data.model, data.modes)
    again = read_four_files(files)
    assert (again.model.stiffness != model.stiffness).nnz == 0
    np.testing.assert_array_equal(again.modes, modes)


@pytest.mark.parametrize("units", [COMPLEX_BEAM_UNITS, SLIDING_BEAM_UNITS], ids=["Pa-kg-mm", "N-mm-t"])
def test_round_trip_through_other_units(bar, tmp_path, units):
    model, modes, _ = bar
    write_four_files(tmp_path, model, modes, **units)
    data = read_four_files(tmp_path, **units)
    np.testing.assert_allclose(data.model.nodes, model.nodes, rtol=1e-15)
    np.testing.assert_allclose(data.model.mass.diagonal(), model.mass.diagonal(), rtol=1e-15)
    difference = abs(data.model.stiffness - model.stiffness).max()
    assert difference <= 1e-15 * abs(model.stiffness).max()


def _edit(path, change):
    lines = path.read_text().splitlines()
    path.write_text("\n".join(change(lines)) + "\n")


def _without_rows(lines, nodes):
    drop = {3 * node + k for node in nodes for k in range(3)}
    return [line for i, line in enumerate(lines) if i not in drop]


def test_omitted_rows_are_found_by_orthogonality(bar, files):
    """Without a word in the files: neither a zero row nor a penalty."""
    _, modes, clamp = bar
    _edit(files / "modeShapeMatrix.dat", lambda lines: _without_rows(lines, clamp))
    data = read_four_files(files)
    np.testing.assert_array_equal(data.fixed_nodes, clamp)
    np.testing.assert_array_equal(data.modes, modes)
    assert any("omits 6 clamped nodes" in note for note in data.notes)
    named = read_four_files(files, clamped_nodes=clamp.tolist())
    np.testing.assert_array_equal(named.fixed_nodes, clamp)


def test_omitted_section_need_not_be_numbered_in_a_row(bar, tmp_path):
    model, modes, clamp = bar
    shuffle = np.random.default_rng(6).permutation(model.node_count)
    dofs = (3 * shuffle[:, None] + np.arange(3)).ravel()
    shuffled = type(model)(
        nodes=model.nodes[shuffle],
        stiffness=model.stiffness[dofs][:, dofs],
        mass=model.mass[shuffle][:, shuffle],
    )
    write_four_files(tmp_path, shuffled, modes[dofs])
    expected = np.flatnonzero(np.isin(shuffle, clamp))
    assert np.ptp(expected) > clamp.size
    _edit(tmp_path / "modeShapeMatrix.dat", lambda lines: _without_rows(lines, expected))
    np.testing.assert_array_equal(read_four_files(tmp_path).fixed_nodes, expected)


def test_penalties_are_dropped_and_rows_omitted_with_them_are_known(bar, files):
    model, modes, clamp = bar

    def penalise(lines):
        for node in clamp + 1:
            for k in (1, 2, 3):
                label = f"{node},{k}, {node},{k},"
                lines = [f"{label} 1.0e36" if line.startswith(label) else line for line in lines]
        return lines

    _edit(files / "stiffnessMatrix.dat", penalise)
    _edit(files / "modeShapeMatrix.dat", lambda lines: _without_rows(lines, clamp))
    data = read_four_files(files)
    np.testing.assert_array_equal(data.fixed_nodes, clamp)
    assert abs(data.model.stiffness).max() < 1e12
    K, free = data.model.stiffness.toarray(), np.repeat(~np.isin(np.arange(model.node_count), clamp), 3)
    assert not K[~free].any()
    np.testing.assert_array_equal(K[np.ix_(free, free)], model.stiffness.toarray()[np.ix_(free, free)])
    np.testing.assert_array_equal(data.modes, modes)


def test_upper_triangle_and_whole_matrix_are_read_alike(bar, files):
    model, *_ = bar

    def swap(line):
        i, j, value = line.replace(", ", " ").split()
        return f"{j}, {i}, {value}"

    path = files / "stiffnessMatrix.dat"
    lower = path.read_text().splitlines()
    _edit(path, lambda lines: [swap(line) for line in lines])
    assert (read_four_files(files).model.stiffness != model.stiffness).nnz == 0
    off_diagonal = [line for line in lower if line.split()[0] != line.split()[1]]
    _edit(path, lambda lines: lines + off_diagonal)
    data = read_four_files(files)
    assert (data.model.stiffness != model.stiffness).nnz == 0
    assert any("both triangles" in note for note in data.notes)


def test_wave_speed_is_a_property_of_the_material(bar, files):
    model, *_ = bar
    lam, mu = model.material.lame_lambda, model.material.shear_modulus
    exact = np.sqrt((lam + 2 * mu) / model.material.density)
    assert longitudinal_wave_speed(model) == pytest.approx(exact, rel=1e-12)
    assert longitudinal_wave_speed(read_four_files(files).model) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize(
    "units", [{"length_unit": 1e-3}, {"mass_factor": 1e-9}, {"stiffness_factor": 1e9}, {"mass_factor": 1e3}]
)
def test_units_that_make_no_material_are_refused(files, units):
    with pytest.raises(InputError, match=r"no material is .*expected factors length_unit"):
        read_four_files(files, **units)
    assert read_four_files(files, check_units=False, **units).model.node_count == 48


def _append(text):
    return lambda lines: [*lines, text]


def _replace(number, text):
    return lambda lines: [*lines[: number - 1], text, *lines[number:]]


FAULTS = [
    ("stiffnessMatrix.dat", _append("49,1, 1,1, 5.0"), r"line \d+: node 49; expected .* from 1 to 48"),
    ("stiffnessMatrix.dat", _append("2,4, 1,1, 5.0"), r"line \d+: direction 4; expected .* 1 to 3"),
    ("stiffnessMatrix.dat", _append("0,1, 1,1, 5.0"), r"line \d+: node 0"),
    ("stiffnessMatrix.dat", _append("1.5,1, 1,1, 5.0"), r"line \d+: node 1.5"),
    ("stiffnessMatrix.dat", _append("1,1, 1,1, 5.0"), "repeats the entry of line 1"),
    ("stiffnessMatrix.dat", _append("1,1, 2,1, 5.0"), "has no partner across the diagonal"),
    ("stiffnessMatrix.dat", _replace(7, "2,1, 1,1,"), "line 7: 4 numbers: '2 1 1 1'; expected 5"),
    ("stiffnessMatrix.dat", _replace(7, "2,1, 1,1, nan"), "line 7: 'nan'; expected a finite number"),
    (
        "stiffnessMatrix.dat",
        _replace(1, "1,1, 1,1, 1e36"),
        "node 1 has a boundary penalty in direction x only",
    ),
    ("u0.dat", _replace(3, "0.1 0.2"), "line 3: 2 numbers"),
    ("u0.dat", _replace(3, "0.1 0.2 east"), "line 3: 'east'; expected a finite number"),
    ("u0.dat", lambda lines: lines[:-1], "mij.dat: line 48: 48 masses; expected 47"),
    ("u0.dat", lambda lines: lines[:0], "u0.dat: is empty"),
    ("mij.dat", _replace(5, "-1.0"), "mij.dat: line 5: -1; expected a positive mass"),
    ("mij.dat", _replace(5, "inf"), "line 5: 'inf'"),
    ("modeShapeMatrix.dat", lambda lines: lines[:-1], "143 rows; expected 144, three for each of 48"),
    ("modeShapeMatrix.dat", _append(" ".join(["0"] * 6)), "145 rows"),
    ("modeShapeMatrix.dat", _replace(9, "1 2 3 4 5"), "line 9: 5 numbers.*; expected 6 numbers"),
    ("modeShapeMatrix.dat", lambda lines: ["0 0 0"] * len(lines), "all mode shapes are zero"),
    ("modeShapeMatrix.dat", lambda lines: lines[60:], "omits 20 nodes"),
]


@pytest.mark.parametrize(("file", "change", "message"), FAULTS)
def test_faulty_files_are_refused_by_name_and_line(files, file, change, message):
    _edit(files / file, change)
    with pytest.raises(InputError, match=message):
        read_four_files(files)


def test_unsymmetric_matrix_is_refused(files):
    path = files / "stiffnessMatrix.dat"
    lower = path.read_text().splitlines()

    def swapped(line, factor):
        i, j, value = line.replace(", ", " ").split()
        return f"{j}, {i}, {float(value) * factor!r}"

    off_diagonal = [line for line in lower if line.split()[0] != line.split()[1]]
    path.write_text("\n".join(lower + [swapped(line, 1.1) for line in off_diagonal]))
    with pytest.raises(InputError, match="unsymmetric between"):
        read_four_files(files)


def test_mode_that_moves_a_clamped_node_is_refused(bar, files):
    tip = f"{bar[0].node_count}"

    def penalise(lines):
        labels = [f"{tip},{k}, {tip},{k}," for k in (1, 2, 3)]
        return [next((f"{a} 1e36" for a in labels if line.startswith(a)), line) for line in lines]

    _edit(files / "stiffnessMatrix.dat", penalise)
    with pytest.raises(InputError, match=rf"moves node {tip}, which stiffnessMatrix.dat clamps"):
        read_four_files(files)


def test_what_one_mode_cannot_tell_must_be_named(bar, files):
    _, modes, clamp = bar
    _edit(
        files / "modeShapeMatrix.dat",
        lambda lines: [line.split()[0] for line in _without_rows(lines, clamp)],
    )
    with pytest.raises(InputError, match="one mode does not determine which; expected the 6 omitted nodes"):
        read_four_files(files)
    data = read_four_files(files, clamped_nodes=clamp.tolist())
    np.testing.assert_array_equal(data.modes[:, 0], modes[:, 0])
    with pytest.raises(InputError, match="clamped_nodes: 5 nodes; expected the 6"):
        read_four_files(files, clamped_nodes=clamp[:5].tolist())


def test_missing_file_and_bad_factor_are_named(files):
    with pytest.raises(InputError, match=r"mass_factor: 0\.0; expected a positive number"):
        read_four_files(files, mass_factor=0.0)
    with pytest.raises(InputError, match="clamped_nodes: 1 nodes; expected none"):
        read_four_files(files, clamped_nodes=[0])
    (files / "mij.dat").unlink()
    with pytest.raises(InputError, match=r"mij.dat: does not exist"):
        read_four_files(files)
    shutil.rmtree(files)
    with pytest.raises(InputError, match=r"u0.dat: does not exist"):
        read_four_files(files)


def test_what_the_files_cannot_hold_is_not_written(bar, tmp_path):
    model, modes, _ = bar
    consistent = assemble(model.mesh, model.material, mass="consistent")
    with pytest.raises(InputError, match="not diagonal; expected a lumped"):
        write_four_files(tmp_path, consistent, modes)
    with pytest.raises(InputError, match=r"modes: array of shape \(5, 6\)"):
        write_four_files(tmp_path, model, modes[:5])
    assert not list(tmp_path.iterdir())


def test_an_empty_list_of_clamped_nodes_is_a_free_body(bar, files):
    """Nodes that rest in every stored shape, as those of a nodal plane, are not clamped then."""
    model, modes, clamp = bar
    assert read_four_files(files).fixed_nodes.size == clamp.size
    data = read_four_files(files, clamped_nodes=[])
    assert data.fixed_nodes.size == 0
    np.testing.assert_array_equal(data.modes, modes)
    assert eigenmodes(data.model, 3).rigid_count == 6
    _edit(files / "modeShapeMatrix.dat", lambda lines: _without_rows(lines, clamp))
    with pytest.raises(InputError, match="clamped_nodes: 0 nodes; expected the 6"):
        read_four_files(files, clamped_nodes=[])
    stiffness = model.stiffness.tolil()
    for row in (3 * clamp[:, None] + np.arange(3)).ravel():
        stiffness[row, row] = 1e36
    write_four_files(files, dataclasses.replace(model, stiffness=csr_array(stiffness)), modes)
    with pytest.raises(InputError, match=r"clamped_nodes: none, and stiffnessMatrix\.dat clamps 6"):
        read_four_files(files, clamped_nodes=[])
