"""Frames as numbers: element matrices, reference curves, material points, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from frame_examples import EI, EXAMPLES, MASS, SECTION, Example, arc, line, through
from frame_oracle import hermite_polynomials

from heavylift.numerics.outcome import InputError
from heavylift.solver.bodies.ancf.frame_packing import (
    body_constants,
    check_frame,
    element_data,
    load_shape,
    locate,
    reference_element,
    result_columns,
    shape_values,
    start_coordinates,
    strain_counts,
)
from heavylift.solver.scene.meshes import DistributedLoad, FollowerLoad, FrameBody, FrameSection, Support


@pytest.fixture(params=EXAMPLES)
def example(request: pytest.FixtureRequest) -> Example:
    return EXAMPLES[request.param]


def mass_matrix(data: np.ndarray) -> np.ndarray:
    return data[:16].reshape(4, 4)


def test_element_matrices_equal_those_of_an_independent_element(example: Example) -> None:
    for data, element in zip(element_data(example.body), example.oracle(), strict=True):
        np.testing.assert_allclose(mass_matrix(data), element.mass_matrix(), rtol=1e-11, atol=1e-13)
        bending = data[16:32].reshape(4, 4)
        expected = np.zeros((4, 4)) if example.body.model == "exact" else element.bending_matrix()
        np.testing.assert_allclose(bending, expected, rtol=1e-11, atol=1e-11)


def test_straight_element_matrices_are_those_of_the_beam() -> None:
    l = 0.6
    data = element_data(line([l]))[0]
    mass = np.array(
        [
            [156, 22 * l, 54, -13 * l],
            [22 * l, 4 * l**2, 13 * l, -3 * l**2],
            [54, 13 * l, 156, -22 * l],
            [-13 * l, -3 * l**2, -22 * l, 4 * l**2],
        ]
    )
    bending = np.array(
        [
            [12, 6 * l, -12, 6 * l],
            [6 * l, 4 * l**2, -6 * l, 2 * l**2],
            [-12, -6 * l, 12, -6 * l],
            [6 * l, 2 * l**2, -6 * l, 4 * l**2],
        ]
    )
    np.testing.assert_allclose(mass_matrix(data), MASS * l / 420 * mass, rtol=1e-12)
    np.testing.assert_allclose(data[16:32].reshape(4, 4), EI / l**3 * bending, rtol=1e-12, atol=1e-10)


def test_the_mass_turns_like_that_of_the_curve() -> None:
    """Mass ``m L``, and the kinetic energy of rotations of a quarter of a ring: ``m R^3 pi / 2`` about its axis."""
    body = arc(np.pi / 2, 2.0, 8)
    nodes = body.nodes - [0.0, 2.0, 0.0]  # the centre of the circle
    vectors = np.stack((nodes, body.tangents), axis=1)
    total, spin, tilt = 0.0, 0.0, 0.0
    for ends, data in zip(body.elements, element_data(body), strict=True):
        M, q = mass_matrix(data), vectors[ends].reshape(4, 3)
        total += np.array([1, 0, 1, 0]) @ M @ np.array([1, 0, 1, 0])
        for axis, what in (([0, 0, 1.0], "spin"), ([1.0, 0, 0], "tilt")):
            v = np.cross(axis, q)
            energy = np.sum(v * (M @ v))
            spin, tilt = (spin + energy, tilt) if what == "spin" else (spin, tilt + energy)
    assert total == pytest.approx(MASS * np.pi, rel=1e-5)
    assert spin == pytest.approx(MASS * np.pi * 4.0, rel=1e-5)
    assert tilt == pytest.approx(MASS * np.pi * 2.0, rel=1e-5)


def test_the_length_of_a_curved_element_is_that_of_its_curve() -> None:
    """A fine polygon through it agrees; slopes by arc length are those of the nodes."""
    body = arc(1.0, 1.3, 1, rise=0.5)
    element = reference_element(np.stack((body.nodes, body.tangents), axis=1).reshape(4, 3))
    assert element is not None
    assert not element.straight
    fine = element.points(np.linspace(0.0, 1.0, 20001))
    assert element.length == pytest.approx(np.linalg.norm(np.diff(fine, axis=0), axis=1).sum(), rel=1e-8)
    np.testing.assert_allclose(element.slopes(np.array([0.0, 1.0])), [[0, 1, 0, 0], [0, 0, 0, 1]], atol=1e-13)
    np.testing.assert_allclose(element.metric(np.array([0.0, 1.0])), element.length, rtol=1e-13)
    assert element.length == pytest.approx(np.hypot(1.3, 0.5), rel=2e-3)
    np.testing.assert_allclose(element.curvature(0.5), 1.3 / (1.3**2 + 0.5**2), rtol=0.05)


def test_second_derivatives_are_those_of_the_slopes(example: Example) -> None:
    body = example.body
    element = reference_element(start_coordinates(body)[body.elements[0]].reshape(4, 3))
    assert element is not None
    h, xi = 1e-4, 0.3
    rate = (element.slopes(xi + h) - element.slopes(xi - h)) / (2 * h) / element.metric(xi)
    np.testing.assert_allclose(element.second(xi), rate, rtol=1e-6, atol=1e-6)


def test_a_material_point_is_found_again(example: Example) -> None:
    body = example.body
    q = start_coordinates(body)
    for e, xi in ((0, 0.0), (0, 0.37), (1, 0.8), (1, 1.0)):
        row = shape_values(body, e, (xi,), 0)
        polynomials = hermite_polynomials(example.oracle()[e].length)
        np.testing.assert_allclose(row, [p(xi) for p in polynomials], atol=1e-12)
        point = row @ q[body.elements[e]].reshape(4, 3)
        found, local = locate(body, point, "case", "joints[0]")
        assert found == e
        np.testing.assert_allclose(local, (xi,), atol=1e-9)
        tangent = shape_values(body, e, (xi,), 1) @ q[body.elements[e]].reshape(4, 3)
        assert np.linalg.norm(tangent) == pytest.approx(1.0, abs=1e-12)  # by arc length


def test_a_shared_node_belongs_to_the_first_element() -> None:
    assert locate(line([0.7, 1.2]), np.array([0.7, 0.0, 0.0]), "case", "point") == (0, (1.0,))


def test_the_point_of_an_arc_is_found_in_the_right_element() -> None:
    body = arc(5.5, 1.0, 40)  # almost closed: its ends are near each other
    for e in (0, 13, 39):
        point = shape_values(body, e, (0.5,), 0) @ start_coordinates(body)[body.elements[e]].reshape(4, 3)
        assert locate(body, point, "case", "point")[0] == e


def test_a_point_off_the_axis_is_refused(example: Example) -> None:
    with pytest.raises(InputError, match=r"case: joints\[0\]: the point .* is .* m from the axis"):
        locate(example.body, np.array([0.4, 0.3, 0.2]), "case", "joints[0]")


def test_load_shape_is_the_integral_of_the_shape_functions(example: Example) -> None:
    for e, element in enumerate(example.oracle()):
        expected = element.integral(lambda xi, element=element: element.row(xi, 0))  # type: ignore[misc]
        np.testing.assert_allclose(load_shape(example.body, e), expected, atol=1e-10)


def test_equal_elements_share_their_data() -> None:
    body = line([0.1] * 50, [1.0, 2.0, 3.0])  # nodes are rounded
    data = element_data(body)
    assert len({id(block) for block in data}) == 1
    other = replace(body, sections=(SECTION, SECTION), element_sections=np.arange(50) % 2)
    assert len({id(block) for block in element_data(other)}) == 2


def test_counts_and_channels() -> None:
    assert strain_counts(line([1.0, 2.0])).tolist() == [5, 5]
    assert strain_counts(line([1.0, 2.0], model="exact")).tolist() == [14, 14]
    assert strain_counts(arc(1.0, 1.0, 2)).tolist() == [8, 8]
    assert body_constants(line([1.0])).tolist() == [0.0]
    assert body_constants(line([1.0], model="exact")).tolist() == [1.0]
    assert result_columns(line([1.0, 2.0])) == {
        "axial_force": ("0", "1"),
        "bending_moment": ("0.first", "0.second", "1.first", "1.second"),
        "axial_stress": ("0", "1"),
    }


def test_good_frames_pass(example: Example) -> None:
    loads = (
        DistributedLoad(np.array([0.0, 0.0, -1.0])),
        FollowerLoad(normal=1.0, node=1, times=np.array([0.0, 1.0]), factors=np.array([0.0, 1.0])),
    )
    supports = (Support(np.array([0]), {"position": "xyz", "tangent": "yz"}),)
    check_frame(replace(example.body, loads=loads, supports=supports))


GOOD = line([0.7, 1.2])
X = np.tile([1.0, 0.0, 0.0], (3, 1))


def held(nodes: list[int], **fixed: str) -> FrameBody:
    return replace(GOOD, supports=(Support(np.array(nodes), fixed),))


def loaded(load: DistributedLoad | FollowerLoad) -> FrameBody:
    return replace(GOOD, loads=(load,))


def made_of(**changes: float) -> FrameBody:
    return replace(GOOD, sections=(replace(SECTION, **changes),))


DOWN = np.array([0.0, 0.0, -1.0])
BAD = {
    "shape of nodes": (replace(GOOD, nodes=np.zeros((3, 2))), r"nodes: shape \(3, 2\)"),
    "nan": (replace(GOOD, nodes=GOOD.nodes * np.nan), r"nodes: nan at \[0, 0\]"),
    "tangents": (replace(GOOD, tangents=X[:2]), r"tangents: shape \(2, 3\)"),
    "not unit": (replace(GOOD, tangents=2.0 * X), r"tangents\[0\]: .* has the length 2"),
    "no element": (replace(GOOD, elements=np.zeros((0, 2), dtype=int)), "elements: shape"),
    "no such node": (replace(GOOD, elements=np.array([[0, 1], [1, 7]])), "elements: there is no node 7"),
    "unused node": (replace(GOOD, elements=np.array([[0, 1]])), r"nodes\[2\]: node 2 belongs to no element"),
    "zero length": (
        through(np.zeros((2, 3)), X[:2]),
        r"elements\[0\]: the length between nodes \[0, 1\] is zero",
    ),
    "kink": (
        replace(GOOD, tangents=np.array([[1.0, 0, 0], [0.6, 0.8, 0], [1, 0, 0]])),
        r"elements\[0\]: .* is not straight; .* model 'exact'",
    ),
    "backwards": (replace(GOOD, tangents=-X), r"elements\[0\]: .* turned back"),
    "backwards, exact": (replace(GOOD, tangents=-X, model="exact"), r"elements\[0\]: .* turned back"),
    "model": (replace(GOOD, model="linear"), "model: 'linear'; expected 'green-lagrange' or 'exact'"),
    "no section": (replace(GOOD, sections=()), "sections: none"),
    "section": (replace(GOOD, element_sections=np.array([0, 1])), "element_sections: there is no section 1"),
    "strains": (replace(GOOD, axial_strains=np.zeros(3)), r"axial_strains: shape \(3,\)"),
    "density": (made_of(density=0.0), r"sections\[0\].density: 0.0; expected a positive number"),
    "modulus": (made_of(youngs_modulus=-1.0), r"sections\[0\].youngs_modulus: -1.0"),
    "area": (made_of(area=float("inf")), r"sections\[0\].area: inf"),
    "second moment": (made_of(second_moment=-1e-9), r"sections\[0\].second_moment: -1e-09"),
    "support node": (held([3], position="xyz"), r"supports\[0\].nodes: there is no node 3"),
    "support vector": (
        held([0], slope_x="x"),
        r"supports\[0\].fixed: 'slope_x'; expected .* position, tangent",
    ),
    "support axes": (held([0], position="xw"), r"supports\[0\].fixed.position: 'xw'"),
    "load": (loaded(DistributedLoad(DOWN[:2])), r"loads\[0\].load: shape \(2,\)"),
    "load elements": (
        loaded(DistributedLoad(DOWN, np.array([2]))),
        r"loads\[0\].elements: there is no element 2",
    ),
    "load times": (
        loaded(DistributedLoad(DOWN, times=np.array([1.0, 0.0]), factors=np.ones(2))),
        r"loads\[0\].times: \[1.0, 0.0\]; expected increasing",
    ),
    "load factors": (loaded(DistributedLoad(DOWN, factors=np.ones(2))), r"loads\[0\].factors: shape \(2,\)"),
    "load node": (loaded(FollowerLoad(normal=1.0, node=-1)), r"loads\[0\].node: there is no node -1"),
    "load axis": (loaded(FollowerLoad(normal=1.0, axis=np.zeros(3))), r"loads\[0\].axis: length zero"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_frames_are_refused(name: str) -> None:
    body, message = BAD[name]
    with pytest.raises(InputError, match=f"^frame: {message}"):
        check_frame(body)


def test_a_cable_needs_no_bending_stiffness() -> None:
    body = replace(GOOD, sections=(FrameSection(7800.0, 2e11, 1e-4, 0.0),))
    check_frame(body)
    data = element_data(body)[0]
    assert np.isfinite(data).all()
    assert not data[16:32].any()
