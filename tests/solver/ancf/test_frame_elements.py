"""Elements of frames: against an independent energy, its derivatives, rigid motions and exact deformations."""

from __future__ import annotations

import frame_meshes as fm
import numpy as np
import pytest
from frame_examples import EA, EI, EXAMPLES, MASS, SECTION, Example, arc, line
from frame_meshes import get, matrix, pack, put
from recorded_parts import place_parts
from scipy.linalg import eigh, expm

from heavylift.pipeline.drawn.skins import MeshSkin
from heavylift.solver.bodies.ancf.frame_packing import load_shape
from heavylift.solver.bodies.ancf.kind import FrameMeshes
from heavylift.solver.bodies.ancf.stress import largest_frame_stress


@pytest.fixture(params=EXAMPLES)
def example(request: pytest.FixtureRequest) -> Example:
    return EXAMPLES[request.param]


def deformed(kind: FrameMeshes, amount: float = 0.2) -> np.ndarray:
    """Start shape, moved at random."""
    q = get(kind.position)
    return q + amount * np.random.default_rng(5).normal(size=q.shape)


def energy(kind: FrameMeshes, q: np.ndarray) -> float:
    put(kind.mid_position, q)
    fm.find_strains(kind, 0, kind.mid_position, kind.strain)
    kind.body[0].elastic_energy = 0.0
    fm.measure_strain_energy(kind, 0, kind.strain)
    return kind.body[0].elastic_energy


def forces(kind: FrameMeshes, q: np.ndarray) -> np.ndarray:
    put(kind.mid_position, q)
    fm.find_strains(kind, 0, kind.mid_position, kind.strain)
    kind.external_force[:] = 0.0
    fm.add_stress_forces(kind, 0, kind.mid_position, kind.strain, kind.external_force, 1.0)
    return get(kind.external_force)


def tangent(kind: FrameMeshes, q: np.ndarray, geometric: float = 1.0) -> np.ndarray:
    put(kind.mid_position, q)
    fm.find_strains(kind, 0, kind.mid_position, kind.strain)
    kind.blocks[:] = 0.0
    fm.add_stiffness(kind, 0, kind.mid_position, kind.strain, kind.right_hand_side, 0.0, 1.0, geometric)
    return matrix(kind)


def constant_matrix(kind: FrameMeshes, place: int) -> np.ndarray:
    """The mass (0) or bending matrix (16) of all elements, dense."""
    size = 6 * kind.table[0].node_count
    total = np.zeros((size, size))
    for row in kind.elements:
        data = kind.constants[row.data + place :][:16].reshape(4, 4)
        at = (6 * (row.nodes[:2] // 8)[:, None] + np.arange(6)).ravel()
        total[np.ix_(at, at)] += np.kron(data, np.eye(3))
    return total


def rigid_motions(q: np.ndarray) -> np.ndarray:
    """Velocities of three translations and three rotations, shape (6, coordinates)."""
    vectors = q.reshape(-1, 3)
    found = []
    for axis in np.eye(3):
        shift = np.zeros_like(vectors)
        shift[::2] = axis
        found += [shift.ravel(), np.cross(axis, vectors).ravel()]
    return np.array(found)


def difference(f, q: np.ndarray, v: np.ndarray, h: float = 2e-3):  # type: ignore[no-untyped-def]
    """Derivative along v, sixth order."""
    d = [f(q + k * h * v) - f(q - k * h * v) for k in (1, 2, 3)]
    return (1.5 * d[0] - 0.3 * d[1] + d[2] / 30.0) / (2.0 * h)


@pytest.mark.parametrize(("swap", "geometric"), [(False, 0.0), (True, 0.7)])
def test_kernels_equal_an_independent_element(example: Example, swap: bool, geometric: float) -> None:
    kind = pack(example.body, swap=swap)
    q = deformed(kind)
    put(kind.mid_position, q)
    fm.find_strains(kind, 0, kind.mid_position, kind.strain)
    carried = 0.1 * np.random.default_rng(1).normal(size=kind.strain.shape[0])  # any stress: it need not fit
    kind.shape_strain[:] = carried
    fm.add_stress_forces(kind, 0, kind.mid_position, kind.shape_strain, kind.external_force, 1.7)
    fm.add_stiffness(kind, 0, kind.mid_position, kind.shape_strain, kind.right_hand_side, 1.7, 0.9, geometric)
    strains, force, stiffness, at = [], np.zeros(18), np.zeros((18, 18)), 0
    for e, element in enumerate(example.oracle()):
        own = slice(6 * e, 6 * e + 12)
        strains.append(element.strains(q[own]))
        part = carried[at : at + len(strains[-1])]
        at += len(part)
        force[own] += 1.7 * element.forces(q[own], part)
        stiffness[own, own] += 0.9 * element.stiffness(q[own], part, geometric)
    np.testing.assert_allclose(kind.strain, np.concatenate(strains), atol=1e-13, rtol=1e-12)
    np.testing.assert_allclose(get(kind.external_force), force, atol=1e-12 * abs(force).max())
    np.testing.assert_allclose(get(kind.right_hand_side), force, atol=1e-12 * abs(force).max())
    tolerance = 1e-12 if geometric == 0.0 else 1e-9
    np.testing.assert_allclose(matrix(kind), stiffness, atol=tolerance * abs(stiffness).max())


def test_forces_are_the_gradient_of_the_energy(example: Example) -> None:
    kind = pack(example.body)
    q = deformed(kind)
    force = forces(kind, q)
    found = np.array([difference(lambda x: energy(kind, x), q, v) for v in np.eye(len(q))])
    np.testing.assert_allclose(force, found, atol=1e-7 * abs(force).max())


def test_the_tangent_is_the_derivative_of_the_forces(example: Example) -> None:
    kind = pack(example.body)
    q = deformed(kind)
    stiffness = tangent(kind, q)
    found = np.array([difference(lambda x: forces(kind, x), q, v) for v in np.eye(len(q))])
    np.testing.assert_allclose(stiffness, found, atol=1e-7 * abs(stiffness).max())


def test_strain_rates_are_the_derivative_of_the_strains(example: Example) -> None:
    kind = pack(example.body)
    q, v = deformed(kind), np.random.default_rng(3).normal(size=18)

    def strains(x: np.ndarray) -> np.ndarray:
        put(kind.mid_position, x)
        fm.find_strains(kind, 0, kind.mid_position, kind.strain)
        return kind.strain.copy()

    found = difference(strains, q, v)
    strains(q)
    put(kind.mid_velocity, v)
    kind.shape_strain[:] = 0.5
    fm.add_strain_rates(kind, 0, kind.mid_position, kind.mid_velocity, kind.shape_strain, 3.0)
    np.testing.assert_allclose(kind.shape_strain - 0.5, 3.0 * found, atol=1e-7 * abs(found).max())


def test_forces_do_no_work_in_rigid_motions(example: Example) -> None:
    kind = pack(example.body)
    q = deformed(kind)
    force = forces(kind, q)
    np.testing.assert_allclose(rigid_motions(q) @ force, 0.0, atol=1e-12 * abs(force).max())


def test_a_rigid_motion_leaves_the_strains_of_the_given_shape(example: Example) -> None:
    kind = pack(example.body)
    turn = expm(np.cross(np.eye(3), [0.9, -2.0, 1.4]))
    vectors = get(kind.position).reshape(-1, 2, 3) @ turn.T
    vectors[:, 0] += [3.0, -1.0, 2.0]
    put(kind.mid_position, vectors.ravel())
    fm.find_strains(kind, 0, kind.mid_position, kind.strain)
    at = 0
    given = example.body.axial_strains if len(example.body.axial_strains) else np.zeros(2)
    for strain in given:  # which is the tension that was asked for, and no bending
        np.testing.assert_allclose(kind.strain[at : at + 5], strain, atol=1e-14)
        count = kind.strain.shape[0] // 2
        np.testing.assert_allclose(kind.strain[at + 5 : at + count], 0.0, atol=1e-13)
        at += count


@pytest.mark.parametrize("model", ["green-lagrange", "exact"])
def test_a_homogeneous_stretch_is_a_constant_strain(model: str) -> None:
    kind = pack(line([0.3, 1.1, 0.6], model=model))
    force = forces(kind, 1.3 * get(kind.position))
    strain = 0.3 if model == "exact" else (1.3**2 - 1.0) / 2.0
    np.testing.assert_allclose(kind.strain.reshape(3, -1)[:, :5], strain, rtol=1e-14)
    tension = EA * strain * (1.0 if model == "exact" else 1.3)
    ends = np.zeros((4, 2, 3))  # only the end sections are loaded
    ends[[0, -1], 0, 0] = -tension, tension
    np.testing.assert_allclose(force, ends.ravel(), atol=1e-12 * tension)
    assert energy(kind, 1.3 * get(kind.position)) == pytest.approx(EA / 2 * strain**2 * 2.0, rel=1e-14)


def test_a_stretched_arc_has_the_strain_of_its_scale() -> None:
    kind = pack(arc(2.0, 1.5, 5))
    put(kind.mid_position, 1.01 * get(kind.position))
    fm.find_strains(kind, 0, kind.mid_position, kind.strain)
    strains = kind.strain.reshape(5, 8)
    np.testing.assert_allclose(strains[:, :5], 0.01, rtol=1e-12)
    np.testing.assert_allclose(strains[:, 5:], 0.0, atol=1e-13)  # the angle between its ends is as before


def test_a_constant_second_derivative_is_a_constant_moment() -> None:
    """Green-Lagrange: a parabola lies in the cubics; the bending matrix gives end moments and its energy."""
    kind = pack(line([0.3, 1.1, 0.6]))
    q = get(kind.position).reshape(-1, 2, 3)
    q[:, 0, 1], q[:, 1, 1] = 0.01 * q[:, 0, 0] ** 2 / 2, 0.01 * q[:, 0, 0]
    bending = constant_matrix(kind, 16)
    moments = np.zeros((4, 2, 3))
    moments[[0, -1], 1, 1] = -EI * 0.01, EI * 0.01
    np.testing.assert_allclose(bending @ q.ravel(), moments.ravel(), atol=1e-12 * EI)
    assert 0.5 * q.ravel() @ bending @ q.ravel() == pytest.approx(EI / 2 * 0.01**2 * 2.0, rel=1e-12)


def test_a_straight_rod_bent_to_a_circle_has_its_energy_to_fourth_order() -> None:
    errors = []
    for count in (4, 8):
        kind = pack(line([np.pi / count] * count, model="exact"))
        bent = np.stack((arc(np.pi, 1.0, count).nodes, arc(np.pi, 1.0, count).tangents), axis=1)
        energy(kind, bent.ravel())
        strains = kind.strain.reshape(count, 14)[:, 5:].reshape(count, 3, 3)
        np.testing.assert_allclose(strains[:, :, :2], 0.0, atol=1e-12)
        weights = np.array([5.0, 8.0, 5.0]) / 18.0 / count
        errors.append(abs(np.sum(weights * strains[:, :, 2] ** 2) - 1.0))
    assert errors[1] < 1e-3
    assert 3.7 < np.log2(errors[0] / errors[1]) < 4.6


def zero_modes(stiffness: np.ndarray) -> int:
    values = np.linalg.eigvalsh(stiffness)
    return int(np.sum(abs(values) < 1e-9 * values[-1]))


@pytest.mark.parametrize("lengths", [[0.8], [0.8, 0.5, 0.7]])
@pytest.mark.parametrize("model", ["green-lagrange", "exact"])
def test_a_straight_frame_has_five_free_motions(model: str, lengths: list[float]) -> None:
    """Rotation about its own axis moves none of its coordinates; the other five rigid motions are all there are."""
    kind = pack(line(lengths, [1.0, 2.0, -1.0], model=model))
    q = get(kind.position)
    stiffness = tangent(kind, q) + constant_matrix(kind, 16)
    assert zero_modes(stiffness) == 5
    motions = rigid_motions(q)
    np.testing.assert_allclose(stiffness @ motions.T, 0.0, atol=1e-10 * abs(stiffness).max())
    assert np.linalg.matrix_rank(motions, tol=1e-9) == 5


def test_a_curved_frame_has_six_free_motions_in_its_plane_and_bends_freely_out_of_it() -> None:
    for count in (1, 3):
        kind = pack(arc(1.2, 1.0, count))
        q = get(kind.position)
        stiffness = tangent(kind, q)
        np.testing.assert_allclose(stiffness @ rigid_motions(q).T, 0.0, atol=1e-10 * abs(stiffness).max())
        plane = np.flatnonzero(np.arange(len(q)) % 3 < 2)
        assert zero_modes(stiffness[np.ix_(plane, plane)]) == 3  # all of them rigid
        assert zero_modes(stiffness) == 3 + len(q) // 3  # without torsion: all motions out of the plane


def test_the_tangent_turns_the_forces_with_the_frame(example: Example) -> None:
    """``K (w x q) = w x F`` in any shape: zero for all six rigid motions of a bent frame free of forces."""
    kind = pack(example.body)
    q = deformed(kind)
    motions = rigid_motions(q)
    assert np.linalg.matrix_rank(motions, tol=1e-6) == 6
    bending = constant_matrix(kind, 16)
    force, stiffness = forces(kind, q) + bending @ q, tangent(kind, q) + bending
    for axis, shift, turn in zip(np.eye(3), motions[::2], motions[1::2], strict=True):
        turned = np.cross(axis, force.reshape(-1, 3)).ravel()
        np.testing.assert_allclose(stiffness @ shift, 0.0, atol=1e-11 * abs(stiffness).max())
        np.testing.assert_allclose(stiffness @ turn, turned, atol=1e-11 * abs(stiffness).max())


def test_a_quarter_of_a_ring_yields_by_its_moments_and_forces() -> None:
    """Clamped, loaded at the tip, by Castigliano: ``int M m / EI + N n / EA``; curved elements converge to it."""
    errors = []
    for count in (4, 8):
        kind = pack(arc(np.pi / 2, 1.5, count))
        stiffness = tangent(kind, get(kind.position))
        free = [3, *(i for i in range(6, 6 * count + 6) if i % 3 < 2)]  # the clamp lets the axis stretch
        load = np.zeros((6 * count + 6, 2))
        load[[6 * count, 6 * count + 1], [0, 1]] = 1.0
        found = np.linalg.solve(stiffness[np.ix_(free, free)], load[free])[[-4, -3]]
        bend, stretch = 1.5**3 / EI, 1.5 / EA
        along_x = np.pi / 4 * (bend + stretch)
        along_y = (0.75 * np.pi - 2.0) * bend + np.pi / 4 * stretch
        errors.append(max(abs(found[0, 0] / along_x - 1.0), abs(found[1, 1] / along_y - 1.0)))
        assert found[0, 1] == pytest.approx(found[1, 0], rel=1e-10)
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) > 3.5


@pytest.mark.parametrize("model", ["green-lagrange", "exact"])
def test_natural_frequencies_of_a_pinned_beam(model: str) -> None:
    """``(n pi / L)^2 sqrt(EI / m)``, twice each (two planes); 20 elements: within 1e-3 up to the fifth."""
    count, length = 20, 4.0
    kind = pack(line([length / count] * count, model=model))
    stiffness = tangent(kind, get(kind.position)) + constant_matrix(kind, 16)
    fixed = [0, 1, 2, *range(6 * count, 6 * count + 3)]
    across = [i for i in range(6 * count + 6) if i % 3 and i not in fixed]
    values = eigh(stiffness[np.ix_(across, across)], constant_matrix(kind, 0)[np.ix_(across, across)])[0]
    expected = (np.arange(1, 6) * np.pi / length) ** 2 * np.sqrt(EI / MASS)
    np.testing.assert_allclose(np.sqrt(values[:10]), np.repeat(expected, 2), rtol=1e-3)


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_follower_load_has_the_resultant_of_its_chord(name: str) -> None:
    """Undeformed, ``int (n a x t + p t) ds = n a x chord + p chord``; deformed, against a fine sum of its power."""
    example = EXAMPLES[name]
    kind = pack(example.body)
    axis = np.array([0.3, -0.5, 0.8])
    kind.constants[1:6] = 7.0, -2.0, *axis
    q = get(kind.position)
    put(kind.mid_position, q)
    fm.add_follower_load(kind, 0, kind.mid_position, 1, kind.external_force, 1, 2.0)
    found = get(kind.external_force).reshape(-1, 2, 3)
    chord = example.body.nodes[2] - example.body.nodes[1]
    np.testing.assert_allclose(
        found[:, 0].sum(axis=0), 2.0 * (7.0 * np.cross(axis, chord) - 2.0 * chord), atol=1e-11
    )
    assert not found[0].any()
    q = deformed(kind, 0.05)
    element = example.oracle()[1]

    def load(xi: float) -> np.ndarray:
        d = element.row(xi, 1) @ q[6:].reshape(4, 3)
        t = d / np.linalg.norm(d)
        return np.outer(element.row(xi, 0), 2.0 * (7.0 * np.cross(axis, t) - 2.0 * t))

    put(kind.mid_position, q)
    kind.external_force[:] = 0.0
    fm.add_follower_load(kind, 0, kind.mid_position, 1, kind.external_force, 1, 2.0)
    expected = element.integral(load).ravel()
    np.testing.assert_allclose(get(kind.external_force)[6:], expected, atol=1e-4 * abs(expected).max())


def recorded(kind: FrameMeshes, body: object) -> dict[str, np.ndarray]:
    """Channels by name; nothing beyond them is written."""
    places = place_parts(kind, body, 2)  # type: ignore[arg-type]
    row = np.full(max(place.stop for place in places.values()) + 1, np.nan)
    fm.record_elements(kind, 0, row)
    assert np.isnan(row[[0, 1, -1]]).all()
    assert np.isfinite(row[2:-1]).all()
    return {name: row[place] for name, place in places.items()}


@pytest.mark.parametrize("model", ["green-lagrange", "exact"])
@pytest.mark.parametrize("stretch", [1.2, 0.9])
def test_record_of_a_stretched_bar_is_the_force_that_holds_it(model: str, stretch: float) -> None:
    body = line([0.3, 1.1, 0.6], model=model)
    kind = pack(body)
    end = forces(kind, stretch * get(kind.position))[-6]
    put(kind.position, stretch * get(kind.position))
    found = recorded(kind, body)
    np.testing.assert_allclose(found["axial_force"], end, rtol=1e-12)
    np.testing.assert_allclose(found["axial_stress"], end / SECTION.area, rtol=1e-12)
    np.testing.assert_allclose(found["bending_moment"], 0.0, atol=1e-12)


@pytest.mark.parametrize("model", ["green-lagrange", "exact"])
def test_record_of_a_cantilever_is_force_times_lever(model: str) -> None:
    """A small tip force P: moments P (L - x) at both ends of each element, stress M c / I at the clamp."""
    body = line([0.5, 0.5, 1.0], model=model)
    kind = pack(body)
    q = get(kind.position).reshape(-1, 2, 3)
    P, L = 1e-4, 2.0
    x = body.nodes[:, 0]
    q[:, 0, 2] = P / EI * (L * x**2 / 2 - x**3 / 6)
    q[:, 1, 2] = P / EI * (L * x - x**2 / 2)
    put(kind.position, q.ravel())
    found = recorded(kind, body)
    expected = P * (L - np.column_stack((x[:-1], x[1:]))).ravel()
    np.testing.assert_allclose(found["bending_moment"], expected, atol=1e-8 * P * L)
    assert found["axial_stress"][0] == pytest.approx(P * L * 0.05 / 3e-4, rel=1e-5)


def test_record_of_a_given_shape_is_its_pre_stress() -> None:
    body = arc(1.4, 1.3, 2, rise=0.6, axial_strains=np.array([0.01, -0.02]))
    found = recorded(pack(body), body)
    np.testing.assert_allclose(found["axial_force"], [0.01 * EA, -0.02 * EA], rtol=1e-12)
    np.testing.assert_allclose(found["bending_moment"], 0.0, atol=1e-11)
    np.testing.assert_allclose(found["axial_stress"], found["axial_force"] / SECTION.area, rtol=1e-9)


def test_bending_adds_to_the_stress_with_the_sign_of_the_force() -> None:
    body = line([1.0], axial_strains=np.array([-0.001]))
    kind = pack(body)
    q = get(kind.position).reshape(-1, 2, 3)
    q[1, 0, 1], q[1, 1, 1] = 5e-4, 1e-3
    put(kind.position, q.ravel())
    stress = recorded(kind, body)["axial_stress"][0]
    assert stress == pytest.approx(-2e5 * (0.001 + 1e-3 * 0.05), rel=1e-3)


def test_recorded_stress_is_the_largest_that_a_picture_shows(example: Example) -> None:
    """At any deformation, to rounding; the stresses of pictures are computed without the compiled elements."""
    kind = pack(example.body)
    q = deformed(kind, 1e-3)
    put(kind.position, q)
    found = recorded(kind, example.body)["axial_stress"]
    coordinates = q.reshape(-1, 2, 3)
    np.testing.assert_allclose(found, largest_frame_stress(example.body, coordinates), rtol=1e-7)
    shown = MeshSkin(example.body).skin(coordinates)
    assert shown.largest == pytest.approx(found[np.argmax(np.abs(found))], rel=1e-7)


def test_a_diverged_frame_has_no_stress() -> None:
    body = line([0.5, 0.5])
    kind = pack(body)
    q = get(kind.position)
    q[6] = np.nan
    put(kind.position, q)
    places = place_parts(kind, body, 0)
    row = np.zeros(max(place.stop for place in places.values()))
    fm.record_elements(kind, 0, row)
    assert np.isnan(row[places["axial_stress"]]).all()


def test_drift_is_the_largest_difference_and_names_its_element(example: Example) -> None:
    kind = pack(example.body)
    count = kind.strain.shape[0] // 2
    kind.shape_strain[:] = 0.3
    kind.stage_strain[:] = 0.3
    kind.stage_strain[2] += 1e-5
    kind.stage_strain[count + 4] -= 3e-5
    fm.measure_drift(kind, 0, kind.shape_strain, kind.stage_strain)
    assert kind.body[0].drift == pytest.approx(3e-5)
    assert kind.body[0].drift_element == 1
    if example.body.model == "exact":  # a curvature counts as the strain of the outer fibre
        kind.stage_strain[5] += 1e-2
        fm.measure_drift(kind, 0, kind.shape_strain, kind.stage_strain)
        assert kind.body[0].drift == pytest.approx(1e-2 * 0.05)
        assert kind.body[0].drift_element == 0
    kind.stage_strain[1] = np.nan
    fm.measure_drift(kind, 0, kind.shape_strain, kind.stage_strain)
    assert np.isnan(kind.body[0].drift)


def test_only_elements_of_the_body_are_touched() -> None:
    """A table row for the second element alone."""
    kind = pack(line([0.5, 0.8], model="exact"))
    kind.table[0].first_element, kind.table[0].element_count = 1, 1
    put(kind.mid_position, deformed(kind))
    fm.find_strains(kind, 0, kind.mid_position, kind.strain)
    fm.add_stiffness(kind, 0, kind.mid_position, kind.strain, kind.external_force, 1.0, 1.0, 1.0)
    assert kind.strain[14:].all()
    assert kind.blocks[144:].any()
    for other in (kind.strain[:14], kind.external_force[:8], kind.blocks[:144]):
        assert not other.any()


def test_load_shape_is_what_a_dead_load_does() -> None:
    np.testing.assert_allclose(load_shape(line([0.6]), 0), [0.3, 0.03, 0.3, -0.03], atol=1e-15)
