"""Models and reduced bodies survive the disk bit for bit."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from heavylift.modal.bases import eigenmode_basis
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.reduction import reduce_body
from heavylift.numerics.outcome import InputError
from heavylift.pipeline.results.model_io import (
    read_header,
    read_model,
    read_reduced,
    write_model,
    write_reduced,
)
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import Material


@pytest.fixture(scope="module")
def model():
    mesh = mesh_blocks(
        [Box("bar", (0, 0, 0), (0.2, 0.02, 0.01))],
        element_type="hex8",
        divisions={"x": [4], "y": [1], "z": [1]},
        groups=[OnPlane("root", "x", 0.0)],
        name="bar",
    )
    return assemble(mesh, Material(210e9, 0.3, 7800.0))


def test_a_model_comes_back(tmp_path, model):
    path = tmp_path / "bar.h5"
    write_model(path, model, {"digest": "abc", "versions": {"numpy": "2"}})
    found = read_model(path)
    for key in ("stiffness", "mass"):
        assert (getattr(found, key) != getattr(model, key)).nnz == 0
    assert np.array_equal(found.nodes, model.nodes)
    assert np.array_equal(found.mesh.elements, model.mesh.elements)
    assert found.mesh.element_type == "hex8"
    assert found.material == model.material
    assert np.array_equal(found.node_groups["root"], model.node_groups["root"])
    assert found.name == "bar"
    assert read_header(path)["digest"] == "abc"


def test_a_reduced_body_comes_back(tmp_path, model):
    modes = eigenmodes(model, 3, fixed_nodes=model.node_groups["root"])
    basis = eigenmode_basis(modes)
    body = reduce_body(
        model, basis.vectors, basis.labels, fixed_nodes=model.node_groups["root"], mean_axis=False
    )
    path = tmp_path / "bar.h5"
    write_reduced(path, body, {"frame_origin": [0.0, 0.0, 0.0]})
    found = read_reduced(path)
    for field in fields(body):
        if field.name == "integrals":
            for mine, theirs in zip(body.integrals, found.integrals, strict=True):
                assert np.array_equal(mine, theirs)
        elif field.name == "mesh":
            assert body.mesh is not None
            assert found.mesh is not None
            assert found.mesh.element_type == body.mesh.element_type
            assert np.array_equal(found.mesh.nodes, body.nodes)
            assert np.array_equal(found.mesh.elements, body.mesh.elements)
        elif isinstance(getattr(body, field.name), np.ndarray):
            assert np.array_equal(getattr(found, field.name), getattr(body, field.name))
        else:
            assert getattr(found, field.name) == getattr(body, field.name)


def test_the_wrong_kind_of_file_is_said(tmp_path, model):
    path = tmp_path / "bar.h5"
    write_model(path, model, {})
    with pytest.raises(InputError, match="finite-element model"):
        read_reduced(path)


def test_damaged_and_missing_files_name_the_remedy(tmp_path, model):
    path = tmp_path / "bar.h5"
    with pytest.raises(InputError, match="heavylift mesh"):
        read_model(path)
    write_model(path, model, {})
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(InputError, match=r"damaged.*heavylift mesh"):
        read_model(path)
