"""Constant matrices of shells against closed forms and plate theory; material points; what is refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from shell_oracle import Element
from shell_scenes import STEEL, distorted_element, shell

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.shell_packing import (
    check_shell,
    element_data,
    load_shape,
    locate,
    result_columns,
    shape_values,
    start_coordinates,
    strain_counts,
)
from heavylift.solver.scene.mesh_shapes import ShellMesh, grid, quadrilateral, rectangle
from heavylift.solver.scene.meshes import DistributedLoad, ShellBody, ShellSection, Support

# Square plate L = 10 m, h = 0.1 m, E = 1 GPa, q = 981 N/m2: centre deflection in mm, n x n bicubic Hermite elements
# for n = 2, 4, 6, 8, 10. Bicubic Hermite plate, Kirchhoff exact: simply supported 478.220 (nu 0), 435.180 (nu 0.3),
# clamped 148.953 and 135.548. By support: w and the slope along the edge; w at nodes only ("Integrated simulation
# ... (2018)", table 3-7, with its integrals corrected); all of w; all but the twist (table 3-9, likewise).
DEFLECTIONS = {
    ("straight edges", 0.0): (485.325, 478.570, 478.286, 478.240, 478.228),
    ("nodes only", 0.0): (534.757, 480.011, 478.475, 478.285, 478.243),
    ("clamped", 0.0): (155.955, 148.900, 148.925, 148.942, 148.948),
    ("clamped, twist free", 0.0): (187.112, 155.602, 150.913, 149.765, 149.366),
    ("straight edges", 0.3): (441.645, 435.499, 435.240, 435.199, 435.188),
    ("nodes only", 0.3): (480.938, 436.726, 435.405, 435.238, 435.201),
    ("clamped", 0.3): (141.919, 135.499, 135.522, 135.537, 135.543),
    ("clamped, twist free", 0.3): (170.272, 141.598, 137.331, 136.286, 135.923),
}


def deflection(mesh: ShellMesh, nu: float, support: str) -> float:
    """Centre deflection [mm] of a plate of linear bending."""
    body = shell(mesh, ShellSection(0.1, 1000.0, 1e9, nu))
    check_shell(body)
    count = 4 * len(mesh.nodes)
    K, f = np.zeros((count, count)), np.zeros(count)
    for e, (data, own) in enumerate(zip(element_data(body), mesh.elements, strict=True)):
        places = (4 * own[:, np.newaxis] + np.arange(4)).ravel()
        K[np.ix_(places, places)] += data[256:512].reshape(16, 16)
        f[places] += 981.0 * load_shape(body, e)
    fixed = np.zeros((len(mesh.nodes), 4), dtype=bool)
    for edge, along in (("x_min", 2), ("x_max", 2), ("y_min", 1), ("y_max", 1)):
        vectors = {
            "straight edges": [0, along],
            "nodes only": [0],
            "clamped": [0, 1, 2, 3],
            "clamped, twist free": [0, 1, 2],
        }[support]
        fixed[np.ix_(mesh.edges[edge], vectors)] = True
    free = ~fixed.ravel()
    w = np.zeros(count)
    w[free] = np.linalg.solve(K[np.ix_(free, free)], f[free])
    element, local = locate(body, np.array([5.0, 5.0, 0.0]), "test", "centre")
    places = (4 * mesh.elements[element][:, np.newaxis] + np.arange(4)).ravel()
    return float(1e3 * shape_values(body, element, local, 0) @ w[places])


@pytest.mark.parametrize(("support", "nu"), list(DEFLECTIONS))
def test_plates_bend_as_theory_says(support: str, nu: float) -> None:
    got = [deflection(rectangle(10.0, 10.0, n, n), nu, support) for n in (2, 4, 6, 8, 10)]
    np.testing.assert_allclose(got, DEFLECTIONS[support, nu], rtol=1e-5)


def test_a_plate_of_distorted_elements_bends_like_one_of_squares() -> None:
    # inner nodes of a square moved along smooth lines: the same plate, Kirchhoff exact 135.548 mm
    u = np.linspace(0.0, 10.0, 11)
    x, y = np.meshgrid(u, u, indexing="ij")
    bump = np.sin(np.pi * x / 10.0) * np.sin(np.pi * y / 10.0)
    mesh = grid(np.stack([x + 0.8 * bump, y - 0.6 * bump, 0.0 * x], axis=-1))
    assert deflection(mesh, 0.3, "clamped") == pytest.approx(135.548, rel=5e-3)


@pytest.mark.parametrize(
    "body", [shell(rectangle(1.3, 0.8, 1, 1)), distorted_element()], ids=["rectangle", "distorted"]
)
def test_matrices_agree_with_the_oracle(body: ShellBody) -> None:
    oracle = Element(body, 0, 12)
    data = element_data(body)[0]
    for got, expected in ((data[:256], oracle.mass()), (data[256:512], oracle.bending())):
        np.testing.assert_array_equal(got.reshape(16, 16), got.reshape(16, 16).T)
        np.testing.assert_allclose(got.reshape(16, 16), expected, atol=1e-6 * np.abs(expected).max())


def test_mass_and_moment_of_inertia_of_a_quadrilateral() -> None:
    corners = np.array([[0.0, 0.0], [1.4, 0.1], [1.2, 0.9], [-0.2, 0.7]])
    mesh = quadrilateral(np.column_stack([corners, np.zeros(4)]), 3, 2)
    body = shell(mesh)
    unit, mass, second = np.tile([1.0, 0.0, 0.0, 0.0], 4), 0.0, np.zeros((3, 3))
    start = start_coordinates(body)
    for data, own in zip(element_data(body), body.elements, strict=True):
        M, x = data[:256].reshape(16, 16), start[own].reshape(16, 3)
        mass += unit @ M @ unit
        second += x.T @ M @ x
    # two triangles; the second moment of one is its area over 12 times sums over its corners
    area, integral = 0.0, np.zeros((2, 2))
    for triangle in (corners[[0, 1, 2]], corners[[0, 2, 3]]):
        A = 0.5 * np.linalg.det(triangle[1:] - triangle[0])
        total = triangle.sum(axis=0)
        area += A
        integral += A / 12.0 * (triangle.T @ triangle + np.outer(total, total))
    assert mass == pytest.approx(78.5 * area, rel=1e-13)
    np.testing.assert_allclose(second[:2, :2], 78.5 * integral, rtol=1e-12)
    assert np.abs(second[2]).max() < 1e-15


def test_integral_of_shape_functions_gives_area_and_centroid() -> None:
    body = distorted_element()
    M = element_data(body)[0][:256].reshape(16, 16) / 78.5
    unit = np.tile([1.0, 0.0, 0.0, 0.0], 4)
    np.testing.assert_allclose(load_shape(body, 0), M @ unit, rtol=1e-11, atol=1e-15)


def test_equal_elements_share_their_numbers() -> None:
    mesh = rectangle(3.0, 2.0, 3, 2)
    assert len({id(data) for data in element_data(shell(mesh))}) == 1
    sections = (STEEL, ShellSection(0.02, 7850.0, 2.1e11, 0.3))
    two = replace(shell(mesh), sections=sections, element_sections=np.array([0, 1, 0, 1, 0, 1]))
    data = element_data(two)
    assert len({id(block) for block in data}) == 2
    np.testing.assert_allclose(data[1][:256], 2.0 * data[0][:256], rtol=1e-14)
    np.testing.assert_allclose(data[1][256:512], 8.0 * data[0][256:512], rtol=1e-13)
    assert strain_counts(two).tolist() == [120] * 6


@pytest.mark.parametrize(
    "mesh", [rectangle(3.0, 2.0, 4, 3), distorted_element()], ids=["rectangle", "distorted"]
)
def test_material_points_are_found_again(mesh: Any) -> None:
    body = shell(mesh) if isinstance(mesh, ShellMesh) else mesh
    rng = np.random.default_rng(0)
    for _ in range(40):
        element, local = int(rng.integers(len(body.elements))), tuple(rng.random(2))
        own = start_coordinates(body)[body.elements[element]].reshape(16, 3)
        point = shape_values(body, element, local, 0) @ own
        found, at = locate(body, point, "case", "point")
        own = start_coordinates(body)[body.elements[found]].reshape(16, 3)
        np.testing.assert_allclose(shape_values(body, found, at, 0) @ own, point, atol=1e-9)
    for node, place in enumerate(body.nodes):
        found, at = locate(body, place, "case", "point")
        assert node in body.elements[found]
        values = shape_values(body, found, at, 0)
        assert values[4 * list(body.elements[found]).index(node)] == pytest.approx(1.0, abs=1e-9)


def test_points_off_the_shell_are_refused() -> None:
    body = shell(rectangle(3.0, 2.0, 4, 3))
    for point in ([1.0, 1.0, 1e-3], [3.001, 1.0, 0.0], [-5.0, 0.0, 0.0], [np.nan, 0.0, 0.0]):
        with pytest.raises(InputError, match=r"case\.toml: sensor"):
            locate(body, np.array(point), "case.toml", "sensor")
    assert locate(body, np.array([3.0 + 1e-7, 1.0, 0.0]), "", "")[1][0] == 1.0


@pytest.mark.parametrize("vector", [1, 2, 3])
def test_shape_values_of_slopes_are_derivatives_by_lengths(vector: int) -> None:
    body = distorted_element()
    a, b = body.lengths[0]
    h = 1e-4
    x, y = 0.3, 0.6

    def value(i: float, j: float) -> np.ndarray:
        return shape_values(body, 0, (x + i * h, y + j * h), 0)

    expected = {
        1: (value(1, 0) - value(-1, 0)) / (2 * h * a),
        2: (value(0, 1) - value(0, -1)) / (2 * h * b),
        3: (value(1, 1) - value(-1, 1) - value(1, -1) + value(-1, -1)) / (4 * h * h * a * b),
    }[vector]
    np.testing.assert_allclose(shape_values(body, 0, (x, y), vector), expected, atol=1e-6)


def test_nodes_of_an_element_have_their_own_vectors() -> None:
    body = distorted_element()
    for node, place in enumerate(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))):
        for vector in range(4):
            expected = np.zeros(16)
            expected[4 * node + vector] = 1.0
            np.testing.assert_allclose(shape_values(body, 0, place, vector), expected, atol=1e-14)


def test_channels_name_all_elements() -> None:
    columns = result_columns(shell(rectangle(2.0, 1.0, 2, 1)))
    assert columns["membrane_force"] == ("0.xx", "0.yy", "0.xy", "1.xx", "1.yy", "1.xy")
    assert columns["bending_moment"] == columns["membrane_force"]
    assert columns["von_mises"] == ("0.top", "0.middle", "0.bottom", "1.top", "1.middle", "1.bottom")


def changed(field: str, place: Any, value: Any) -> ShellBody:
    body = shell(rectangle(2.0, 1.0, 2, 1))
    array = getattr(body, field).copy()
    array[place] = value
    return replace(body, **{field: array})


def sectioned(**numbers: float) -> ShellBody:
    return shell(rectangle(2.0, 1.0, 2, 1), replace(STEEL, **numbers))


PLAIN = shell(rectangle(2.0, 1.0, 2, 1))
REFUSED = {
    "a node off the plane": (changed("nodes", (1, 2), 0.01), r"elements\[0\]: it is not flat"),
    "a slope off the plane": (changed("slopes", (5, 0, 2), 0.1), r"elements\[1\]: it is not flat"),
    "nodes the wrong way round": (
        replace(PLAIN, elements=PLAIN.elements[:, [0, 3, 2, 1]], lengths=PLAIN.lengths[:, ::-1]),
        r"elements\[0\]: it is inverted",
    ),
    "a corner pushed in": (changed("nodes", (5, slice(0, 2)), [1.1, 0.0]), r"elements\[1\]: it is inverted"),
    "no slope at a node": (changed("slopes", (0, 0), 0.0), r"elements\[0\]: it is inverted"),
    "another length beside": (changed("lengths", (1, 1), 1.1), r"lengths\[1\]: 1.1 m on the edge"),
    "a length of zero": (changed("lengths", (1, 0), 0.0), r"lengths\[1\]: .*positive"),
    "an unknown node": (changed("elements", (1, 2), 17), r"elements\[1\]: nodes .*0 to 5"),
    "broken nodes": (
        replace(PLAIN, elements=PLAIN.elements.astype(float)),
        "elements: numbers of type float64",
    ),
    "a node twice": (changed("elements", (1, 2), 4), r"elements\[1\]: nodes .*four different"),
    "a loose node": (
        replace(PLAIN, elements=PLAIN.elements[:1], lengths=PLAIN.lengths[:1]),
        r"nodes\[4\]: it belongs",
    ),
    "a number that is none": (changed("nodes", (3, 1), np.nan), r"nodes\[3\]: nan"),
    "an element turned by a quarter": (
        replace(PLAIN, elements=np.array([PLAIN.elements[0], np.roll(PLAIN.elements[1], 1)])),
        r"elements\[1\]: its edge of nodes \d and \d runs otherwise in element 0",
    ),
    "rubber that keeps its volume": (
        sectioned(poissons_ratio=0.5),
        r"poissons_ratio: 0.5; expected more than -1",
    ),
    "nu of -1": (sectioned(poissons_ratio=-1.0), r"sections\[0\]\.poissons_ratio: -1.0"),
    "no thickness": (sectioned(thickness=0.0), r"sections\[0\]\.thickness: 0.0; expected a positive number"),
    "negative density": (sectioned(density=-1.0), r"density: -1.0"),
    "infinite modulus": (sectioned(youngs_modulus=np.inf), r"youngs_modulus: inf"),
    "no section": (replace(PLAIN, sections=()), "sections: there are none"),
    "an unknown section": (
        replace(PLAIN, element_sections=np.array([0, 1])),
        "element_sections: there is no section 1",
    ),
    "sections of some": (replace(PLAIN, element_sections=np.array([0])), "element_sections: 1 numbers"),
    "too few Gauss points": (
        replace(PLAIN, gauss_points=2),
        "gauss_points: 2; expected a whole number from 3 to 7",
    ),
    "a wrong shape": (replace(PLAIN, slopes=PLAIN.slopes[:5]), "slopes: shape"),
    "a support of no node": (replace(PLAIN, supports=(Support(np.array([6]), {"position": "z"}),)), "node 6"),
    "a support of no vector": (
        replace(PLAIN, supports=(Support(np.array([0]), {"tangent": "z"}),)),
        "'tangent'; expected one of position, slope_x",
    ),
    "a load that is no number": (
        replace(PLAIN, loads=(DistributedLoad(np.array([0.0, np.nan, 0.0])),)),
        r"loads\[0\].load: nan",
    ),
    "a load on part of an element": (
        replace(PLAIN, loads=(DistributedLoad(np.ones(3), elements=np.array([0.9])),)),
        r"loads\[0\].elements: there is no element float64",
    ),
    "Gauss points that are no whole number": (replace(PLAIN, gauss_points=5.0), "gauss_points: 5.0"),
    "a support of no axis": (replace(PLAIN, supports=(Support(np.array([0]), {"twist": "w"}),)), "'w'"),
}


@pytest.mark.parametrize("case", list(REFUSED))
def test_shells_that_cannot_be_are_refused(case: str) -> None:
    body, message = REFUSED[case]
    with pytest.raises(InputError, match=message) as error:
        check_shell(body)
    assert error.value.source == "plate"
    assert error.value.expected


def test_good_shells_pass() -> None:
    check_shell(PLAIN)
    check_shell(distorted_element())
