"""Forces on faces and equilibrium of solids, against closed forms of linear elasticity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.modal.contact_vectors import outer_faces
from heavylift.modal.flexibility import Flexibility, apply_mass
from heavylift.modal.statics import face_area, face_forces, solve_static
from heavylift.modal.stress import stress_component, stress_modes
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import Material

STEEL = Material(young_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
SIZE = np.array([1.2, 0.7, 0.4])


def block(element_type, size=0.3):
    mesh = mesh_blocks(
        [Box("block", (0, 0, 0), tuple(SIZE))],
        element_type=element_type,
        size=size,
        groups=(OnPlane("end", "x", SIZE[0]), OnPlane("top", "z", SIZE[2])),
    )
    return assemble(mesh, STEEL)


def between_planes(model):
    """Held across the three coordinate planes."""
    dofs = [3 * np.flatnonzero(np.abs(model.nodes[:, axis]) < 1e-9) + axis for axis in range(3)]
    return replace(model, fixed_dofs=np.concatenate(dofs))


@pytest.fixture(params=["tet10", "hex8", "hex20"])
def model(request, with_middle_nodes):
    if request.param != "hex20":
        return block(request.param)
    mesh = with_middle_nodes(block("hex8").mesh)
    ends = {
        name: np.flatnonzero(np.isclose(mesh.nodes[:, k], SIZE[k])) for name, k in (("end", 0), ("top", 2))
    }
    return assemble(mesh.with_groups(ends), STEEL)


def bulged(model):
    """The same body with faces that are not flat; a quadratic map, so that quadratic elements are what they were."""
    x, y, z = model.nodes.T
    nodes = model.nodes + 0.1 * np.column_stack([y * z, x * x, x * y])
    return assemble(replace(model.mesh, nodes=nodes), STEEL)


def test_pressure_on_the_whole_surface_has_no_resultant_and_no_moment(model):
    for body in (model, bulged(model)):
        faces = outer_faces(body, np.arange(body.node_count))
        forces = face_forces(body, faces, pressure=3e6).reshape(-1, 3)
        scale = 3e6 * face_area(body, faces)
        np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-12 * scale)
        np.testing.assert_allclose(np.cross(body.nodes, forces).sum(axis=0), 0.0, atol=1e-12 * scale)


def test_work_of_pressure_in_a_dilation_is_pressure_by_volume(model):
    """Divergence theorem: the integral of x.n dA is three volumes, of flat and of bulged bodies."""
    for body in (model, bulged(model)):
        forces = face_forces(body, outer_faces(body, np.arange(body.node_count)), pressure=-1.0)
        assert forces @ body.nodes.ravel() == pytest.approx(3.0 * body.mesh.volume, rel=1e-12)


def test_traction_has_its_resultant_and_uniform_tension_is_exact(model):
    body = between_planes(model)
    faces = outer_faces(body, body.node_groups["end"])
    area = SIZE[1] * SIZE[2]
    assert face_area(body, faces) == pytest.approx(area, rel=1e-12)
    forces = face_forces(body, faces, traction=(5e6, 0.0, 0.0))
    np.testing.assert_allclose(forces, face_forces(body, faces, pressure=-5e6), atol=1e-9 * forces.max())
    state = solve_static(Flexibility(body), forces, "tension")
    expected = 5e6 / 2.1e11 * body.nodes * [1.0, -0.3, -0.3]
    np.testing.assert_allclose(state.displacements, expected, atol=1e-9 * expected.max())
    np.testing.assert_allclose(state.reaction, [-5e6 * area, 0.0, 0.0], atol=1e-8 * 5e6 * area)
    assert state.residual < 1e-10
    stress = stress_modes(body.mesh, STEEL, state.displacements[np.newaxis])[0]
    np.testing.assert_allclose(stress_component(stress, "xx"), 5e6, rtol=1e-8)
    np.testing.assert_allclose(stress_component(stress, "von_mises"), 5e6, rtol=1e-8)
    np.testing.assert_allclose(stress_component(stress, "yz"), 0.0, atol=1e-2)


def test_pressure_from_all_sides_makes_every_element_smaller_by_the_bulk_modulus(model):
    body = between_planes(model)
    held = np.abs(body.nodes) < 1e-9
    faces = outer_faces(body, np.arange(body.node_count))
    faces = faces[~held[faces].all(axis=1).any(axis=1)]  # of the planes of symmetry the other half bears it
    state = solve_static(Flexibility(body), face_forces(body, faces, pressure=2e6), "water")
    strain = -2e6 * (1.0 - 2.0 * 0.3) / 2.1e11
    np.testing.assert_allclose(state.displacements, strain * body.nodes, atol=1e-9 * abs(strain))


def test_a_hanging_block_bears_its_weight():
    """Held at the top along z and nowhere against contraction: stress rho g z, sag rho g L^2/(2 E) of the axis."""
    body = block("tet10", 0.2)
    top = body.node_groups["top"]
    held = [3 * top + 2, *(3 * np.flatnonzero(np.abs(body.nodes[:, k]) < 1e-9) + k for k in (0, 1))]
    body = replace(body, fixed_dofs=np.concatenate(held))
    weight = apply_mass(body.mass, np.tile([0.0, 0.0, -9.81], body.node_count))
    state = solve_static(Flexibility(body), weight, "weight")
    assert state.reaction[2] == pytest.approx(7850.0 * SIZE.prod() * 9.81, rel=1e-9)
    # the top stays flat, so the exact field is the one-dimensional one but for its contraction below the support
    energy = 0.5 * state.displacements.ravel() @ weight
    slender = (7850.0 * 9.81) ** 2 * SIZE[2] ** 3 / (6.0 * 2.1e11) * SIZE[0] * SIZE[1]
    assert energy == pytest.approx(slender, rel=0.2)
    stress = stress_modes(body.mesh, STEEL, state.displacements[np.newaxis])[0]
    for height in (0.1, 0.2, 0.3):
        level = np.abs(body.nodes[:, 2] - height) < 0.06
        mean = stress_component(stress, "zz")[level].mean()
        assert mean == pytest.approx(7850.0 * 9.81 * body.nodes[level, 2].mean(), rel=0.1)


def test_a_load_along_a_rigid_motion_is_refused_and_a_balanced_one_is_not(model):
    n = model.node_count
    pull = np.zeros((n, 3))
    faces = outer_faces(model, model.node_groups["end"])
    with pytest.raises(InputError, match="leave 6 rigid motion"):
        solve_static(Flexibility(model), face_forces(model, faces, pressure=1e6), "static.0")
    held = replace(model, fixed_dofs=3 * np.flatnonzero(np.abs(model.nodes[:, 0]) < 1e-9))
    state = solve_static(Flexibility(held), face_forces(model, faces, pressure=-1e6), "static.0")
    assert state.reaction[0] == pytest.approx(-1e6 * SIZE[1] * SIZE[2], rel=1e-9)
    pull[:, 1] = 1.0
    with pytest.raises(InputError, match=r"static\.1"):
        solve_static(Flexibility(held), pull.ravel(), "static.1")
