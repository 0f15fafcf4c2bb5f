"""Beams: exact deflections, offsets, principal axes, shear centres, releases, masses, sections."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.material import Material
from heavylift.preprocess.structures.assemble import assemble_structure
from heavylift.preprocess.structures.sections import BeamSection, profile, rectangles_section
from heavylift.preprocess.structures.structure import Beams, RigidLink, Structure

STEEL = Material(2.1e11, 0.3, 7850.0)
E, G = STEEL.young_modulus, STEEL.shear_modulus
ANGLE = replace(
    profile("angle", height=0.2, thickness=0.01, width=0.09, flange_thickness=0.014).section,
    shear_centre=(0.0, 0.0),
)
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)
UP = np.array([0.0, 1.0, 0.0])  # plane 1 is x y, axis 3 is z


def straight(section, length=2.0, *, count=1, **options):
    """Cantilever along x, axis 2 along y; all turned in space."""
    nodes = np.column_stack([np.linspace(0.0, length, count + 1), np.zeros((count + 1, 2))])
    elements = np.column_stack([np.arange(count), np.arange(1, count + 1)])
    for key in ("offset_a", "offset_b"):
        if key in options:
            options[key] = options[key] @ TURN
    beams = Beams("b", elements, STEEL, section, UP @ TURN, **options)
    return Structure(nodes @ TURN, beams=(beams,))


def tip(structure, force=(0, 0, 0), moment=(0, 0, 0)):
    """Displacement and rotation of the last node in axes of the beam, the first being held."""
    model = assemble_structure(structure)
    n = model.node_count
    load = np.zeros(model.dof_count)
    load[3 * n - 3 : 3 * n] = np.array(force) @ TURN
    load[-3:] = np.array(moment) @ TURN
    free = np.setdiff1d(np.arange(model.dof_count), [0, 1, 2, 3 * n, 3 * n + 1, 3 * n + 2])
    T = np.eye(model.dof_count) if model.constraint is None else model.constraint.toarray()
    held = np.abs(T[[0, 1, 2, 3 * n, 3 * n + 1, 3 * n + 2]]).sum(axis=0) == 0.0
    assert model.constraint is not None or held.sum() == len(free)
    T = T[:, held]
    u = T @ np.linalg.solve(T.T @ model.stiffness.toarray() @ T, T.T @ load)
    return u[3 * n - 3 : 3 * n] @ TURN.T, u[-3:] @ TURN.T


def test_one_element_is_exact_for_loads_at_its_end():
    section = profile("h", height=0.3, thickness=0.01, width=0.2, flange_thickness=0.015).section
    L, F = 2.0, 1000.0
    I1, I2 = section.second_moment_1, section.second_moment_2
    u, theta = tip(straight(section), (F, F, F), (F, 0, 0))
    shear_1, shear_2 = (F * L / (G * A) for A in (section.shear_area_1, section.shear_area_2))
    np.testing.assert_allclose(
        u,
        [F * L / (E * section.area), F * L**3 / (3 * E * I1) + shear_1, F * L**3 / (3 * E * I2) + shear_2],
        rtol=1e-9,
    )
    np.testing.assert_allclose(
        theta, [F * L / (G * section.torsion), -F * L**2 / (2 * E * I2), F * L**2 / (2 * E * I1)], rtol=1e-9
    )


def test_a_free_angle_moves_sideways_by_its_product_of_inertia():
    """E (I1 v'' + I12 w'') = M, E (I12 v'' + I2 w'') = 0 without shear."""
    section = replace(ANGLE, shear_area_1=np.inf, shear_area_2=np.inf)
    I1, I2, I12 = section.second_moment_1, section.second_moment_2, section.product
    assert abs(I12) > 0.1 * I2
    u, _ = tip(straight(section), (0, 100.0, 0))
    scale = 100.0 * 2.0**3 / (3.0 * E * (I1 * I2 - I12**2))
    np.testing.assert_allclose(u[1:], [scale * I2, -scale * I12], rtol=1e-9)


def test_sections_may_be_turned_with_their_axes():
    """An angle described in axes turned by 30 degrees is the same angle."""
    a = np.radians(30.0)
    c, s = np.cos(a), np.sin(a)
    I1, I2, I12 = ANGLE.second_moment_1, ANGLE.second_moment_2, ANGLE.product
    free = replace(ANGLE, shear_area_1=np.inf, shear_area_2=np.inf)
    turned = replace(
        free,
        second_moment_1=c * c * I1 + s * s * I2 + 2 * c * s * I12,
        second_moment_2=s * s * I1 + c * c * I2 - 2 * c * s * I12,
        product=(c * c - s * s) * I12 + c * s * (I2 - I1),
    )
    structure = straight(free)
    other = replace(
        structure,
        beams=(replace(structure.beams[0], section=turned, orientation=np.array([0, c, s]) @ TURN),),
    )
    for a, b in zip(tip(structure, (1, 2, 3), (4, 5, 6)), tip(other, (1, 2, 3), (4, 5, 6)), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9)


def test_offsets_are_rigid_links():
    """A beam beside its nodes is one between nodes of its own that rigid links hold."""
    a, b = np.array([0.1, 0.2, -0.05]), np.array([-0.1, 0.25, 0.1])
    beside = straight(ANGLE, offset_a=a, offset_b=b)
    nodes = np.array([[0, 0, 0], a, [2 + b[0], b[1], b[2]], [2, 0, 0]]) @ TURN
    linked = Structure(
        nodes,
        beams=(Beams("b", np.array([[1, 2]]), STEEL, ANGLE, UP @ TURN),),
        links=(RigidLink(0, np.array([1])), RigidLink(3, np.array([2]))),
    )
    for found, expected in zip(
        tip(beside, (1, 2, 3), (4, 5, 6)), tip(linked, (1, 2, 3), (4, 5, 6)), strict=True
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-7)
    masses = [assemble_structure(s, mass="consistent") for s in (beside, linked)]
    T = masses[1].constraint
    free = T.T @ masses[1].mass @ T
    order = [0, 3]  # nodes of the other structure that are free
    dofs = np.concatenate(
        [3 * node + np.arange(3) for node in order] + [12 + 3 * node + np.arange(3) for node in order]
    )
    own = [int(np.flatnonzero(T[[dof]].toarray()[0])[0]) for dof in dofs]
    np.testing.assert_allclose(
        masses[0].mass.toarray(), free.toarray()[np.ix_(own, own)], atol=1e-9 * np.abs(free).max()
    )


def test_a_force_beside_the_shear_centre_twists_by_its_arm():
    made = profile("channel", height=0.2, thickness=0.008, width=0.08, flange_thickness=0.012)
    arm = made.section.shear_centre[1]
    assert -0.1 < arm < -0.04  # behind the web, which is 0.02 before the centroid
    _, theta = tip(straight(made.section), (0, 100.0, 0))
    # force along 2 at the centroid, at -arm along 3 from the shear centre: moment about 1 is arm F
    assert theta[0] == pytest.approx(100.0 * arm * 2.0 / (G * made.section.torsion), rel=1e-9)
    _, still = tip(straight(made.section), (0, 100.0, 0), (-100.0 * arm, 0, 0))
    assert abs(still[0]) < 1e-12 * abs(theta[0]) + 1e-15


def test_a_hinge_in_the_middle_carries_force_and_no_moment():
    """Two cantilevers that meet in a hinge, each with half of the force."""
    section = profile("flat", height=0.2, thickness=0.02).section
    structure = straight(section, 2.0, count=2)
    released = np.zeros((2, 12), dtype=bool)
    released[0, 11] = True  # rotation about axis 3 at the end of the first
    structure = replace(structure, beams=(replace(structure.beams[0], released=released),))
    model = assemble_structure(structure)
    F = 1000.0
    load = np.zeros(18)
    load[3:6] = np.array([0, F, 0]) @ TURN
    free = np.array([3, 4, 5, 12, 13, 14])
    u = np.zeros(18)
    u[free] = np.linalg.solve(model.stiffness.toarray()[np.ix_(free, free)], load[free])
    expected = 0.5 * F * (1.0 / (3.0 * E * section.second_moment_1) + 1.0 / (G * section.shear_area_1))
    assert u[3:6] @ TURN[1] == pytest.approx(expected, rel=1e-9)


def test_consistent_mass_is_that_of_przemieniecki():
    """Theory of Matrix Structural Analysis (1968), section 11.3, with shear and rotary inertia."""
    section = BeamSection(0.01, 8e-5, 3e-5, 5e-5, shear_area_1=0.004, shear_area_2=0.006)
    L = 1.5
    structure = Structure(
        np.array([[0, 0, 0], [L, 0, 0]], float), beams=(Beams("b", np.array([[0, 1]]), STEEL, section, UP),)
    )
    M = assemble_structure(structure, mass="consistent").mass.toarray()
    m = 7850.0 * 0.01 * L
    for I, A, columns, sign in ((8e-5, 0.004, [1, 8, 4, 11], 1.0), (3e-5, 0.006, [2, 7, 5, 10], -1.0)):
        f = 12.0 * E * I / (G * A * L**2)
        r = I / 0.01 / L**2
        a = 13 / 35 + 7 * f / 10 + f**2 / 3 + 6 / 5 * r
        b = (11 / 210 + 11 * f / 120 + f**2 / 24 + (1 / 10 - f / 2) * r) * L
        c = 9 / 70 + 3 * f / 10 + f**2 / 6 - 6 / 5 * r
        d = -(13 / 420 + 3 * f / 40 + f**2 / 24 - (1 / 10 - f / 2) * r) * L
        e = (1 / 105 + f / 60 + f**2 / 120 + (2 / 15 + f / 6 + f**2 / 3) * r) * L**2
        g = -(1 / 140 + f / 60 + f**2 / 120 + (1 / 30 + f / 6 - f**2 / 6) * r) * L**2
        b, d = sign * b, sign * d
        expected = m / (1 + f) ** 2 * np.array([[a, b, c, d], [b, e, -d, g], [c, -d, a, -b], [d, g, -b, e]])
        np.testing.assert_allclose(M[np.ix_(columns, columns)], expected, rtol=1e-9)
    axial = m / 6 * np.array([[2, 1], [1, 2]])
    np.testing.assert_allclose(M[np.ix_([0, 3], [0, 3])], axial, rtol=1e-9)
    np.testing.assert_allclose(M[np.ix_([6, 9], [6, 9])], axial * (8e-5 + 3e-5) / 0.01, rtol=1e-9)


@pytest.mark.parametrize("mass", ["lumped", "consistent"])
def test_totals_of_the_mass_of_an_angle(mass):
    """Mass, static moment and inertia about the axis of the nodes, of an offset angle with non-structural mass."""
    section = replace(ANGLE, nonstructural_mass=12.0)
    offset = np.array([0.0, 0.3, -0.1])
    nodes = np.array([[0, 0, 0], [2, 0, 0]], float)
    beams = Beams("b", np.array([[0, 1]]), STEEL, section, UP, offset_a=offset, offset_b=offset)
    model = assemble_structure(Structure(nodes, beams=(beams,)), mass=mass)
    line = 7850.0 * section.area + 12.0
    R = np.zeros((12, 6))
    R[:6, :3] = np.tile(np.eye(3), (2, 1))
    R[6:, 3:] = np.tile(np.eye(3), (2, 1))
    R[:6, 3:] = np.cross(np.eye(3)[None], nodes[:, None]).transpose(0, 2, 1).reshape(6, 3)
    found = R.T @ model.mass @ R
    assert model.total_mass == pytest.approx(2.0 * line, rel=1e-12)
    assert found[0, 0] == pytest.approx(2.0 * line, rel=1e-12)
    polar = 7850.0 * (section.second_moment_1 + section.second_moment_2) + line * (0.3**2 + 0.1**2)
    assert found[3, 3] == pytest.approx(2.0 * polar, rel=1e-12)
    static = np.array([[0, -0.1, -0.3], [0.1, 0, 1.0], [0.3, -1.0, 0]])
    np.testing.assert_allclose(found[:3, 3:], 2.0 * line * static, rtol=1e-9, atol=1e-9)
    points = model.points
    second = np.einsum(
        "p,pi,pj->ij", points.masses, points.positions - [0, 0.3, -0.1], points.positions - [0, 0.3, -0.1]
    )
    np.testing.assert_allclose(second[1, 2], 2.0 * 7850.0 * section.product, rtol=1e-9)


def test_cantilever_frequencies_converge_with_the_fourth_order():
    """Bernoulli: (1.8751 / L)^2 sqrt(E I / m), rotary inertia taken out by a slender beam."""
    section = replace(
        profile("flat", height=0.01, thickness=0.01).section, shear_area_1=np.inf, shear_area_2=np.inf
    )
    errors = []
    for count in (4, 8):
        model = assemble_structure(straight(section, 4.0, count=count), mass="consistent")
        free = np.concatenate([np.arange(3, 3 * count + 3), np.arange(3 * count + 6, model.dof_count)])
        K, M = (matrix.toarray()[np.ix_(free, free)] for matrix in (model.stiffness, model.mass))
        value = np.sort(np.linalg.eigvals(np.linalg.solve(K, M)).real)[-3]
        exact = 4.694091132974174**4 * E * section.second_moment_1 / (7850.0 * section.area * 4.0**4)
        errors.append(1.0 / (value * exact) - 1.0)
    assert 10.0 < errors[0] / errors[1] < 20.0
    assert errors[1] < 2e-4


def test_mechanisms_and_unknown_planes_are_refused():
    both = np.zeros(12, dtype=bool)
    both[[3, 9]] = True
    with pytest.raises(InputError, match=r"beam 1 of b .*moves freely"):
        assemble_structure(straight(ANGLE, released=both))
    structure = straight(ANGLE)
    along = replace(structure.beams[0], orientation=np.array([1.0, 1e-5, 0.0]) @ TURN)
    with pytest.raises(InputError, match="orientation along its axis"):
        assemble_structure(replace(structure, beams=(along,)))
    with pytest.raises(InputError, match="has no length"):
        assemble_structure(straight(ANGLE, 0.0))


@pytest.mark.parametrize(
    ("shape", "measures", "area", "second"),
    [
        ("flat", {"height": 0.2, "thickness": 0.012}, 24e-4, 0.012 * 0.2**3 / 12),
        ("round", {"diameter": 0.1}, np.pi * 0.0025, np.pi * 0.1**4 / 64),
        ("tube", {"diameter": 0.1, "thickness": 0.01}, np.pi * 0.0009, np.pi * (0.1**4 - 0.08**4) / 64),
        (
            "box",
            {"height": 0.3, "thickness": 0.01, "width": 0.2, "flange_thickness": 0.02},
            0.2 * 0.3 - 0.18 * 0.26,
            (0.2 * 0.3**3 - 0.18 * 0.26**3) / 12,
        ),
        (
            "h",
            {"height": 0.3, "thickness": 0.01, "width": 0.2, "flange_thickness": 0.02},
            0.2 * 0.3 - 0.19 * 0.26,
            (0.2 * 0.3**3 - 0.19 * 0.26**3) / 12,
        ),
        (
            "channel",
            {"height": 0.3, "thickness": 0.01, "width": 0.2, "flange_thickness": 0.02},
            0.2 * 0.3 - 0.19 * 0.26,
            (0.2 * 0.3**3 - 0.19 * 0.26**3) / 12,
        ),
    ],
)
def test_shapes_have_their_area_and_second_moment(shape, measures, area, second):
    section, foot = profile(shape, **measures)
    assert section.area == pytest.approx(area, rel=1e-12)
    assert section.second_moment_1 == pytest.approx(second, rel=1e-12)
    assert foot[0] == pytest.approx(0.5 * measures.get("height", measures.get("diameter")), rel=1e-12)
    # the outline reaches as far as the shape
    assert np.ptp(section.corners[:, 0]) == pytest.approx(2.0 * foot[0], rel=1e-12)


def test_a_bulb_flat_is_its_angle():
    """HP 300 x 13: an angle of 269.4 x 13 and 55.8 x 30.6 mm; tables of profiles give 52.8 cm2 within 2 %."""
    section, foot = profile("bulb", height=0.3, thickness=0.013)
    same = rectangles_section([(0, 0.26939130, -0.0065, 0.0065), (0.26939130, 0.3, -0.0065, 0.04927612)])
    for key in ("area", "second_moment_1", "second_moment_2", "torsion", "product"):
        assert getattr(section, key) == pytest.approx(getattr(same, key), rel=1e-6)
    assert section.area == pytest.approx(52.8e-4, rel=0.02)
    assert foot == pytest.approx((0.1839, 0.0070), abs=1e-4)


def test_shapes_without_sense_are_refused():
    with pytest.raises(InputError, match="one of 'flat'"):
        profile("zed", height=1.0)
    with pytest.raises(InputError, match="positive height, thickness, and no other"):
        profile("flat", height=0.2, thickness=0.0)
    with pytest.raises(InputError, match="walls thinner"):
        profile("box", height=0.2, thickness=0.06, width=0.1, flange_thickness=0.01)
