"""Reduced bodies that other programs read: every format read back, by readers that know nothing of the writers."""

from __future__ import annotations

import re

import numpy as np
import pytest

from heavylift.modal.standard_input import standard_input
from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.pipeline.commands.cli import app
from heavylift.pipeline.results.model_io import read_model, read_reduced
from heavylift.pipeline.results.storage import OutputFolder
from heavylift.preprocess.finite_elements.exchange import read_four_files
from heavylift.preprocess.hydrodynamics.netcdf_files import load_variables

CASE = """
title = "A bar for other programs"
[bodies.bar]
type = "flexible"
material = { young_modulus = "210 GPa", poisson_ratio = 0.3, density = "7850 kg/m^3" }
mesh = { element = "hex8", mass = "MASS", divisions = { x = [8], y = [2], z = [2] } }
modes = { count = 4, damping_ratio = 0.01, stiffening = STIFFENING }
frame = { motion = "free", origin = "centre_of_mass" }
[bodies.bar.geometry]
type = "blocks"
add = [{ name = "bar", from = [0, 0, 0], to = ["1 m", "0.1 m", "0.1 m"] }]
groups = { root = { plane = "x", at = 0 }, tip = { plane = "x", at = "1 m" } }
[bodies.bar.interfaces.ROOT]
group = "root"
[bodies.bar.interfaces.TIP]
at = ["1 m", 0, 0]
group = "tip"
"""


@pytest.fixture
def exported(tmp_path):
    def make(text=CASE, mass="lumped", stiffening="false"):
        folder = tmp_path / "case"
        folder.mkdir()
        (folder / "case.toml").write_text(
            text.replace("MASS", mass).replace("STIFFENING", stiffening), encoding="utf-8"
        )
        target = tmp_path / "for others"
        with pytest.raises(SystemExit) as ending:
            app(["modes", str(folder), "--export", str(target)])
        assert ending.value.code == 0
        return OutputFolder(load_case(folder).output_folder), target / "bar"

    return make


def parsed(path):
    """A `.SID_FEM` file as nested dictionaries and entries, by indentation-free rules of the standard alone."""
    lines = [line.strip() for line in path.read_text(encoding="ascii").splitlines()]
    counts = [int(word) for word in lines[0].split()[:2]]
    root = {}
    stack, nodes = [root], []
    for line in lines[1:]:
        if line.startswith("end "):
            stack.pop()
        elif "=" not in line or line.startswith("new node"):
            inner = {}
            if line.startswith("new node"):
                nodes.append(inner)
            stack[-1][line] = inner
            stack.append(inner)
        else:
            key, value = (part.strip() for part in line.split("=", 1))
            entry = re.fullmatch(r"(m[01])\(([\d, ]+)\)", key)
            if entry:
                place = tuple(int(part) - 1 for part in entry[2].split(","))
                stack[-1].setdefault(entry[1], {})[place] = float(value.replace("D", "e"))
            else:
                stack[-1][key] = value
    assert len(stack) == 1
    return counts, root["part"]["new modal"], nodes


def matrices(item):
    """m0 and m1 of a parsed matrix."""
    rows, columns, modes = (int(item[key]) for key in ("nrow", "ncol", "nq"))
    m0, m1 = np.zeros((rows, columns)), np.zeros((rows, modes, columns))
    for array, key in ((m0, "m0"), (m1, "m1")):
        for place, value in item.get(key, {}).items():
            array[place] = value
            if item["structure"] == "2":
                array[place[::-1]] = value
    return m0, m1


@pytest.mark.parametrize("stiffening", ["false", "true"])
def test_standard_input_data_come_back(exported, stiffening):
    folder, place = exported(stiffening=stiffening)
    body = read_reduced(folder.reduced("bar"))
    (node_count, mode_count), modal, nodes = parsed(place / "bar.SID_FEM")
    assert (node_count, mode_count) == (2, body.mode_count)
    expected = standard_input(body, np.full(body.mode_count, 0.01))
    assert float(modal["refmod"]["mass"].replace("D", "e")) == expected.mass
    for key in ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "Ke", "De"):
        m0, m1 = matrices(modal[key])
        series = getattr(expected, key)
        np.testing.assert_array_equal(m0, series.m0, err_msg=key)
        if series.m1 is not None:
            np.testing.assert_allclose(m1, series.m1, rtol=0, atol=1e-12, err_msg=key)
    for node, name in zip(nodes, ("ROOT", "TIP"), strict=True):
        np.testing.assert_array_equal(matrices(node["origin"])[0][:, 0], body.interfaces[name].point)
        np.testing.assert_array_equal(matrices(node["phi"])[0].T, body.interfaces[name].displacement)
        np.testing.assert_array_equal(matrices(node["psi"])[0].T, body.interfaces[name].rotation)
    assert ("Geo_Stiff= yes" in (place / "bar.SID_FEM").read_text(encoding="ascii")) == (stiffening == "true")


def test_four_files_come_back(exported):
    folder, place = exported()
    body, model = read_reduced(folder.reduced("bar")), read_model(folder.model("bar"))
    found = read_four_files(place, clamped_nodes=[])
    np.testing.assert_array_equal(found.model.nodes, body.nodes)
    np.testing.assert_array_equal(found.model.mass.diagonal(), model.mass.diagonal())
    assert abs(found.model.stiffness - model.stiffness).max() == 0.0
    shapes = found.modes.reshape(-1, 3, body.mode_count).transpose(2, 0, 1)
    np.testing.assert_array_equal(shapes, body.mode_shapes)


def test_netcdf_comes_back(exported):
    folder, place = exported(mass="consistent", stiffening="true")
    body = read_reduced(folder.reduced("bar"))
    variables, attributes = load_variables(place / "bar.nc")
    assert attributes["units"] == "SI"
    assert not (place / "mij.dat").exists()  # four files need a lumped mass
    for key, value in (
        ("node_position", body.nodes),
        ("mode_shape", body.mode_shapes),
        ("eigenvalue", body.eigenvalues),
        *body.integrals._asdict().items(),
    ):
        np.testing.assert_array_equal(variables[key].values, value, err_msg=key)
        assert variables[key].attributes["units"], key
    assert variables["mode_shape"].axes == ("vector", "node", "axis")
    assert list(variables["vector"].values) == list(body.labels)
    assert list(variables["interface"].values) == ["ROOT", "TIP"]
    np.testing.assert_array_equal(variables["hex8_nodes"].values, body.mesh.elements)
    for key in ("second_moments", "angular", "linear", "loads"):
        np.testing.assert_array_equal(
            variables[f"stiffening_{key}"].values, getattr(body.stiffening, key), err_msg=key
        )
    assert "TIP moment y" in variables["stiffening_load"].values
    # loads of an interface are the transpose of its motion: read from the file alone
    tip = variables["interface_of_entry"].values == 1
    nodes, forces = variables["interface_node"].values[tip], variables["interface_forces"].values[tip]
    moved = np.einsum("akl,mak->ml", forces, variables["mode_shape"].values[:, nodes])
    np.testing.assert_allclose(moved[:, :3], variables["interface_displacement"].values[1], atol=1e-12)
    np.testing.assert_allclose(moved[:, 3:], variables["interface_rotation"].values[1], atol=1e-12)


def test_case_without_modes_has_nothing_to_export(tmp_path, capsys):
    (tmp_path / "case.toml").write_text(
        'title = "rigid"\n[bodies.box]\ntype = "rigid"\nmass = 1\ninertia = [1, 1, 1]\nframe = { motion = "free" }\n'
        '[simulate]\nstep = "1 ms"\noutput_interval = "1 ms"\nduration = "1 ms"\n',
        encoding="utf-8",
    )
    with pytest.raises(SystemExit) as ending:
        app(["modes", str(tmp_path), "--export", str(tmp_path / "out")])
    assert ending.value.code != 0
    assert "no body with modes" in capsys.readouterr().err


def test_four_files_of_plates_are_refused(beam_chain_model, tmp_path):
    from heavylift.preprocess.finite_elements.exchange import write_four_files

    with pytest.raises(InputError, match="its nodes have rotations, or masses beside them"):
        write_four_files(tmp_path, beam_chain_model, np.ones((6, 1)))


@pytest.fixture
def beam_chain_model():
    """Two nodes with rotations."""
    from scipy.sparse import csr_array, eye_array

    from heavylift.preprocess.finite_elements.model import FEModel, MassPoints

    points = MassPoints(np.eye(3)[:2], np.ones(2), csr_array(np.eye(6, 12)))
    return FEModel(
        np.eye(3)[:2],
        csr_array(eye_array(12)),
        points.matrix(),
        rotating=np.arange(2),
        points=points,
    )
