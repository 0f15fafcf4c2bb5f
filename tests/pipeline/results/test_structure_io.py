"""Models and reduced bodies of plates, beams and masses survive the disk."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.sparse import csr_array, eye_array, issparse

from heavylift.modal.invariants import shape_integrals
from heavylift.modal.reduced import Interface, ReducedBody
from heavylift.pipeline.results.model_io import read_model, read_reduced, write_model, write_reduced
from heavylift.preprocess.finite_elements.model import FEModel, MassPoints, Material
from heavylift.preprocess.structures.sections import BeamSection
from heavylift.preprocess.structures.structure import (
    Average,
    Beams,
    PointMass,
    RigidLink,
    Shells,
    Solids,
    Structure,
    Tie,
)

STEEL = Material(2.06e11, 0.3, 7850.0)
NODES = np.random.default_rng(3).random((12, 3))


@pytest.fixture
def structure():
    """One of everything, with values that are no defaults."""
    section = BeamSection(
        1e-3, 2e-6, 3e-6, 4e-7, 1e-7, 5e-4, shear_centre=(0.1, 0.2), corners=np.eye(2), name="HP"
    )
    return Structure(
        NODES,
        shells=(
            Shells("deck", np.array([[0, 1, 2, 3]]), STEEL, np.array([0.02]), 0.01, 60.0, bends=False),
            Shells("web", np.array([[0, 1, 4]]), STEEL, 0.012, numbers=np.array([77])),
        ),
        beams=(
            Beams("hp", np.array([[0, 1]]), STEEL, section, np.array([0, 0, 1.0]), np.array([0, 0, 0.1])),
        ),
        solids=(Solids("lug", np.array([[0, 1, 2, 3, 4, 5, 6, 7]]), "hex8", STEEL),),
        masses=(PointMass(2, 300.0, np.array([0.0, 0.1, 0.2]), np.diag([1.0, 2.0, 3.0]), "engine"),),
        links=(RigidLink(8, np.array([0, 1]), np.array([1, 1, 1, 0, 0, 0], dtype=bool), "rbe2"),),
        averages=(Average(9, np.array([2, 3]), np.array([0.3, 0.7]), name="rbe3"),),
        ties=(Tie(10, 11),),
        node_groups={"edge": np.array([0, 1])},
        numbers=np.arange(12) + 100,
        name="block.bdf",
        notes=("2 CELAS2 left out",),
    )


def assert_same(found, expected, where=""):
    """Equal values in all fields, one after the other."""
    if dataclasses.is_dataclass(expected):
        assert type(found) is type(expected)
        for one in dataclasses.fields(expected):
            assert_same(getattr(found, one.name), getattr(expected, one.name), f"{where}.{one.name}")
    elif isinstance(expected, dict):
        assert list(found) == list(expected), where
        for key, value in expected.items():
            assert_same(found[key], value, f"{where}.{key}")
    elif isinstance(expected, tuple):
        assert len(found) == len(expected), where
        for index, (one, other) in enumerate(zip(found, expected, strict=True)):
            assert_same(one, other, f"{where}.{index}")
    elif issparse(expected):
        assert (found != expected).nnz == 0, where
    elif isinstance(expected, np.ndarray):
        np.testing.assert_array_equal(found, expected, err_msg=where, strict=True)
    else:
        assert found == expected, where
        assert type(found) is type(expected), where


def test_a_model_with_structure_comes_back(tmp_path, structure):
    operator = csr_array(np.random.default_rng(1).random((6, 42)))
    points = MassPoints(NODES[:2], np.array([1.0, -0.5]), operator)
    constraint = csr_array(eye_array(42).tocsr()[:, :40])
    model = FEModel(
        NODES,
        csr_array(eye_array(42)),
        points.matrix(),
        fixed_dofs=np.array([7]),
        rotating=np.array([1, 4]),
        points=points,
        constraint=constraint,
        structure=structure,
        name="block",
    )
    write_model(tmp_path / "model.h5", model, {})
    assert_same(read_model(tmp_path / "model.h5"), model)


def test_a_body_with_structure_comes_back(tmp_path, structure):
    rng = np.random.default_rng(2)
    shapes, turns = rng.random((2, 12, 3)), rng.random((2, 12, 3))
    lug = Interface(
        np.array([1.0, 2, 3]),
        rng.random((2, 3)),
        rng.random((2, 3)),
        np.array([3, 4]),
        rng.random((2, 3, 6)),
        np.zeros((2, 3, 6)),
        0.97,
    )
    body = ReducedBody(
        NODES,
        np.array([1.0, 2.0]),
        shapes,
        shape_integrals(NODES, shapes, csr_array(eye_array(12))),
        True,
        ("a", "b"),
        np.array([0.0, 1e-9]),
        1e-15,
        structure=structure,
        mode_rotations=turns,
        rotating=np.array([1, 4]),
        interfaces={"LUG": lug},
    )
    write_reduced(tmp_path / "reduced.h5", body, {})
    assert_same(read_reduced(tmp_path / "reduced.h5"), body)
