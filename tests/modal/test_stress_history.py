"""Envelope and largest stresses of groups: those of all records at once, however they are streamed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from heavylift.modal import stress_history
from heavylift.modal.stress import stress_modes, von_mises
from heavylift.modal.stress_history import PointGroup, recover_stress, stress_at_records
from heavylift.modal.stress_points import StressPoints, equivalent_stress, solid_points
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.model import Material

STEEL = Material(2.1e11, 0.3, 7850.0)
RNG = np.random.default_rng(35)


@dataclass(frozen=True, eq=False)
class Plate(StressPoints):
    """Given membrane and bending stresses by modal coordinate."""

    given: np.ndarray = field(default_factory=lambda: np.empty(0))
    components = 3

    def columns(self, shapes, part):
        return self.given[part] @ shapes


@pytest.fixture
def plate():
    m = 40
    return Plate(
        name="deck",
        positions=np.zeros((m, 3)),
        nodes=np.arange(m),
        thickness=np.full(m, 0.02),
        sides=("top", "bottom", "membrane", "bending"),
        from_layers=np.array([[1.0, 1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]),
        given=RNG.standard_normal((m, 2, 3, 5)),
    )


@pytest.mark.parametrize(("points", "values"), [(256, 1_000_000), (7, 300)])
def test_blocks_do_not_change_what_is_found(plate, monkeypatch, points, values):
    monkeypatch.setattr(stress_history, "_POINTS", points)
    monkeypatch.setattr(stress_history, "_VALUES", values)
    q = RNG.standard_normal((30, 5))
    group = PointGroup("half", np.arange(5, 33, 2), np.linspace(1.0, 3.0, 14))
    told = []
    (history,), envelope = recover_stress(plate, np.eye(5), q, [group], progress=told.append)
    assert told[-1] == 1.0
    layers = np.einsum("tk,mlck->tmlc", q, plate.given)
    membrane, bending = layers[:, :, 0], layers[:, :, 1]
    for side, stress in enumerate((membrane + bending, membrane - bending, membrane, bending)):
        xx, yy, xy = np.moveaxis(stress, -1, 0)
        mises = np.sqrt(xx**2 - xx * yy + yy**2 + 3.0 * xy**2)
        np.testing.assert_allclose(envelope.largest[:, side], mises.max(axis=0), rtol=1e-5)
        np.testing.assert_array_equal(envelope.record[:, side], mises.argmax(axis=0))
        own = mises[:, group.points]
        np.testing.assert_allclose(history.largest[:, side], own.max(axis=1), rtol=1e-5)
        np.testing.assert_array_equal(history.point[:, side], group.points[own.argmax(axis=1)])
        used = own / group.strength
        np.testing.assert_allclose(history.utilisation[:, side], used.max(axis=1), rtol=1e-5)
        np.testing.assert_array_equal(history.used_point[:, side], group.points[used.argmax(axis=1)])
    np.testing.assert_allclose(envelope.highest, layers.max(axis=0), rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(envelope.lowest, layers.min(axis=0), rtol=1e-4, atol=1e-5)
    _, at = stress_at_records(plate, np.eye(5), q)
    np.testing.assert_allclose(at.max(axis=0), envelope.largest, rtol=1e-6)


def test_points_of_a_solid_have_the_stress_of_its_nodes():
    mesh = mesh_blocks([Box("b", (0, 0, 0), (1.0, 0.8, 0.6))], element_type="hex8", size=0.25)
    shapes = RNG.standard_normal((3, mesh.node_count, 3))
    nodes = np.array([2, 7, 11, 30])
    found = solid_points(mesh, STEEL, nodes).columns(shapes.reshape(3, -1).T, slice(None))
    expected = stress_modes(mesh, STEEL, shapes)[:, nodes]
    np.testing.assert_allclose(found[:, 0].transpose(2, 0, 1), expected, rtol=1e-12, atol=1e-3)


def test_equivalent_stress_of_a_plate_and_of_a_beam_is_that_of_the_whole_tensor():
    plane = RNG.standard_normal((3, 8))
    whole = np.zeros((8, 6))
    whole[:, [0, 1, 3]] = plane.T
    np.testing.assert_allclose(equivalent_stress(plane), von_mises(whole), rtol=1e-12)
    beam = np.zeros((8, 6))
    beam[:, 0] = plane[0]
    np.testing.assert_allclose(equivalent_stress(plane[:1]), von_mises(beam), rtol=1e-12)
    np.testing.assert_allclose(equivalent_stress(whole.T), von_mises(whole), rtol=1e-12)
