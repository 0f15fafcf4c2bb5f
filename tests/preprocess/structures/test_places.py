"""Places of structures: the nearest point by direct search, and triangles of the surface."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.finite_elements.mesh import find_place
from heavylift.preprocess.structures.sections import profile
from heavylift.preprocess.structures.structure import Beams, Shells, Solids, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)
NODES = np.array(
    [
        [0, 0, 0],
        [2, 0, 0],
        [2, 1, 0],
        [0, 1, 0],
        [3, 0, 0.5],
        [3, 1, 0.5],
        [0, 0, 2],
        [5, 0, 0],
        [6, 0, 0],
        [6, 1, 0],
        [5, 1, 0],
        [5, 0, 1],
        [6, 0, 1],
        [6, 1, 1],
        [5, 1, 1],
    ],
    float,
)


@pytest.fixture(scope="module")
def structure():
    return Structure(
        NODES,
        shells=(
            Shells("t", np.array([[1, 4, 2]]), STEEL, 0.01),
            Shells("q", np.array([[0, 1, 2, 3]]), STEEL, 0.01),
            Shells("s", np.array([[4, 5, 2]]), STEEL, 0.01),
        ),
        beams=(
            Beams(
                "b", np.array([[0, 6]]), STEEL, profile("round", diameter=0.1).section, np.array([1.0, 0, 0])
            ),
        ),
        solids=(Solids("v", np.arange(7, 15)[None], "hex8", STEEL),),
    )


def _sampled(structure, point):
    """Distance of the nearest of many points of all elements."""
    s = np.linspace(0, 1, 41)
    a, b = (x.ravel() for x in np.meshgrid(s, s))
    parts = []
    for shells in structure.shells:
        for corners in structure.nodes[shells.elements]:
            if len(corners) == 4:
                w = np.column_stack([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])
            else:
                low = a + b <= 1
                w = np.column_stack([1 - a - b, a, b])[low]
            parts.append(w @ corners)
    parts.append(np.outer(1 - s, NODES[0]) + np.outer(s, NODES[6]))
    grid = np.stack(np.meshgrid(s, s, s), -1).reshape(-1, 3)
    parts.append(NODES[7] + grid)
    return np.linalg.norm(np.concatenate(parts) - point, axis=1).min()


def test_nearest_place_is_the_nearest_of_all_points(structure):
    for point in np.random.default_rng(2).uniform([-1, -1, -1], [7, 2, 3], (15, 3)):
        nodes, weights, distance = structure.nearest_place(point)
        assert weights.sum() == pytest.approx(1.0)
        assert np.linalg.norm(weights @ NODES[nodes] - point) == pytest.approx(distance)
        assert distance <= _sampled(structure, point) + 1e-9
        assert distance >= _sampled(structure, point) - 0.05


def test_places_on_a_plate_have_its_bilinear_shape_functions(structure):
    nodes, weights = find_place(NODES, structure, [0.5, 0.25, 0.0], source="case")
    found = dict(zip(nodes.tolist(), weights.tolist(), strict=True))
    assert found == pytest.approx({0: 0.5625, 1: 0.1875, 2: 0.0625, 3: 0.1875})
    assert [x.tolist() for x in find_place(NODES, structure, [2, 1, 0], source="case")] == [[2], [1.0]]
    with pytest.raises(InputError, match="is not on the body"):
        find_place(NODES, structure, [1.0, 0.5, 0.5], source="case")


def test_triangles_of_the_surface_are_there_once(structure):
    triangles = structure.boundary_triangles()
    assert len(triangles) == 2 + 2 + 12
    corners = NODES[triangles]
    normal = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    slope = np.sqrt(1.25)
    assert area.sum() == pytest.approx(2.0 + slope + 6.0)
    solid = triangles.min(axis=1) >= 7
    # outwards: the integral of x . n / 3 is the volume
    assert np.einsum("ti,ti->", corners.mean(axis=1)[solid], normal[solid]) / 3.0 == pytest.approx(1.0)
