"""Static vectors of contact: compliance of a patch, integrals over a footprint, errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.modal.bases import eigenmode_basis, static_vectors
from heavylift.modal.contact_vectors import (
    contact_loads,
    footprint_loads,
    footprint_weights,
    outer_faces,
    patch_nodes,
    surface_normals,
)
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduction import ritz_vectors
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import Material

LENGTH, HEIGHT, WIDTH = 1.0, 0.1, 0.06  # of the beam of the fixtures
PATCH = ((0.7, HEIGHT, 0.0), (LENGTH, HEIGHT, WIDTH))


def top_nodes(model):
    return np.flatnonzero(np.abs(model.nodes[:, 1] - HEIGHT) < 1e-9)


def normal_patch_loads(model, fixed=()):
    top = top_nodes(model)
    normals = surface_normals(model, outer_faces(model, top))
    return contact_loads(model, patch_nodes(model, top, box=PATCH), normals=normals, fixed_nodes=fixed)


def compliance(ritz, forces):
    participation = ritz.shapes.T @ forces
    return participation.T @ (participation / ritz.eigenvalues[:, None])


def test_a_patch_has_the_compliance_of_the_full_model(beam_of_any_faces, dense):
    clamp = beam_of_any_faces.node_groups["clamp"]
    loads = normal_patch_loads(beam_of_any_faces, clamp)
    assert loads.forces.shape[1] >= 12
    flexibility = Flexibility(beam_of_any_faces, clamp)
    modes = eigenmodes(beam_of_any_faces, 10, flexibility=flexibility)
    alone = eigenmode_basis(modes)
    with_statics = alone + static_vectors(flexibility, loads)
    matrices = dense(beam_of_any_faces, clamp)
    b = loads.forces[matrices.rows]
    full = b.T @ np.linalg.solve(matrices.K_free, b)
    errors = []
    for basis in (alone, with_statics):
        ritz = ritz_vectors(
            beam_of_any_faces, basis.vectors, basis.labels, fixed_nodes=clamp, mean_axis=False
        )
        assert not ritz.dropped
        errors.append(np.abs(np.diag(compliance(ritz, loads.forces) - full) / np.diag(full)).max())
    assert errors[0] > 0.004  # local indentation, which more eigenmodes hardly catch
    assert errors[1] < 1e-10
    np.testing.assert_allclose(compliance(ritz, loads.forces), full, rtol=1e-10)


@pytest.mark.slow
def test_soft_beam_of_the_thesis_needs_the_static_vector_of_its_contact():
    # 250 x 50 x 50 mm, 5 mm bricks, unit force at (235, 50, 25) mm; numbers of an independent program
    # (cases/point_mass_on_beam/make_reference.py statics)
    mesh = mesh_blocks(
        [Box("beam", (0, 0, 0), (0.25, 0.05, 0.05))],
        element_type="hex8",
        divisions={"x": (50,), "y": (10,), "z": (10,)},
        groups=(OnPlane("root", "x", 0.0), OnPlane("top", "y", 0.05)),
    )
    model = assemble(mesh, Material(young_modulus=5e7, poisson_ratio=0.3, density=920.0), mass="lumped")
    root, top = model.node_groups["root"], model.node_groups["top"]
    flexibility = Flexibility(model, root)
    modes = eigenmodes(model, 100, flexibility=flexibility)
    node = patch_nodes(model, top, disc=((0.235, 0.05, 0.025), 1e-3))
    loads = contact_loads(model, node, normals=surface_normals(model, outer_faces(model, top)))
    ten = eigenmode_basis(modes, range(1, 11))
    for basis, share, error in (
        (ten, 0.9625, 2e-4),
        (eigenmode_basis(modes), 0.9642, 2e-4),
        (ten + static_vectors(flexibility, loads), 1.0, 5e-6),
    ):
        ritz = ritz_vectors(model, basis.vectors, basis.labels, fixed_nodes=root, mean_axis=False)
        assert compliance(ritz, loads.forces)[0, 0] == pytest.approx(0.175725e-3 * share, rel=error)


def test_a_pressure_between_the_nodes_of_a_patch_deflects_them_as_in_the_full_model(beam_of_any_faces):
    # consistent nodal forces of a footprint whose faces lie in the patch: in the span of the unit loads
    clamp = beam_of_any_faces.node_groups["clamp"]
    flexibility = Flexibility(beam_of_any_faces, clamp)
    basis = static_vectors(flexibility, normal_patch_loads(beam_of_any_faces, clamp))
    ritz = ritz_vectors(beam_of_any_faces, basis.vectors, basis.labels, fixed_nodes=clamp, mean_axis=False)
    faces = outer_faces(beam_of_any_faces, top_nodes(beam_of_any_faces))
    b = footprint_loads(beam_of_any_faces, faces, (0.87, HEIGHT, 0.031), 0.028).forces
    assert compliance(ritz, b) == pytest.approx(b.T @ flexibility.solve(b), rel=1e-10)


def test_a_free_body_has_the_compliance_of_inertia_relief(beam_of_any_faces):
    flexibility = Flexibility(beam_of_any_faces)
    loads = normal_patch_loads(beam_of_any_faces)
    basis = static_vectors(flexibility, loads)
    ritz = ritz_vectors(beam_of_any_faces, basis.vectors, basis.labels, mean_axis=True)
    full = loads.forces.T @ flexibility.solve(loads.forces)
    np.testing.assert_allclose(compliance(ritz, loads.forces), full, atol=1e-10 * np.abs(full).max())


def test_three_directions_and_clamped_nodes(brick_beam):
    clamp = brick_beam.node_groups["clamp"]
    top = top_nodes(brick_beam)
    nodes = patch_nodes(brick_beam, top, box=((0.0, HEIGHT, 0.0), (0.1, HEIGHT, WIDTH)))
    loads = contact_loads(brick_beam, nodes, "xyz", fixed_nodes=clamp, name="pad")
    free = np.setdiff1d(nodes, clamp)
    assert 0 < len(free) < len(nodes)
    assert loads.forces.shape[1] == 3 * len(free)
    assert loads.labels[:2] == (f"pad node {free[0]} x", f"pad node {free[0]} y")
    assert np.array_equal(loads.forces.sum(axis=0), np.ones(3 * len(free)))


def test_a_footprint_has_the_moments_of_its_weight(beam_of_any_faces):
    # means over the disc with (1 - r^2/R^2)^2: of x - x0 zero, of (x - x0)^2 R^2/8; quadratic elements know both
    centre, radius = np.array([0.63, HEIGHT, 0.03]), 0.029
    faces = outer_faces(beam_of_any_faces, top_nodes(beam_of_any_faces))
    shares, normals = footprint_weights(beam_of_any_faces, faces, centre, radius)
    assert shares.sum() == pytest.approx(1.0, rel=1e-14)
    np.testing.assert_allclose(normals, np.outer(shares, [0.0, 1.0, 0.0]), atol=1e-15)
    r = beam_of_any_faces.nodes - centre
    np.testing.assert_allclose(shares @ r, 0.0, atol=1e-5 * radius)
    if beam_of_any_faces.mesh.element_type == "tet10":
        second = shares @ (r[:, [0, 2, 0]] * r[:, [0, 2, 2]]) / radius**2
        np.testing.assert_allclose(second, [0.125, 0.125, 0.0], atol=1e-5)
    along_x = footprint_loads(beam_of_any_faces, faces, centre, radius, "x").forces
    np.testing.assert_allclose(along_x[0::3, 0], shares, atol=1e-16)


def test_normals_point_outwards_also_at_edges(beam_of_any_faces):
    surface = np.arange(beam_of_any_faces.node_count)
    normals = surface_normals(beam_of_any_faces, outer_faces(beam_of_any_faces, surface))
    middle = np.array([LENGTH, HEIGHT, WIDTH]) / 2
    on_surface = np.linalg.norm(normals, axis=1) > 0.5
    assert np.all(np.einsum("ij,ij->i", normals, beam_of_any_faces.nodes - middle)[on_surface] > 0.0)
    top = top_nodes(beam_of_any_faces)
    np.testing.assert_allclose(
        surface_normals(beam_of_any_faces, outer_faces(beam_of_any_faces, top))[top],
        [[0.0, 1.0, 0.0]] * len(top),
        atol=1e-14,
    )


def test_bad_patches_are_named(brick_beam):
    top = top_nodes(brick_beam)
    clamp = brick_beam.node_groups["clamp"]
    faces = outer_faces(brick_beam, top)
    with pytest.raises(InputError, match=r"patch: none of \d+ nodes of the face is in the box .* x 0 to 1"):
        patch_nodes(brick_beam, top, box=((2.0, 0.0, 0.0), (3.0, 1.0, 1.0)))
    with pytest.raises(InputError, match=r"within 0.001 m of \[0.5, 0.3, 0.0\] m"):
        patch_nodes(brick_beam, top, disc=((0.5, 0.3, 0.0), 1e-3))
    with pytest.raises(InputError, match=r"3 node\(s\) that make up no outer face"):
        outer_faces(brick_beam, top[:3])
    with pytest.raises(InputError, match="has no surface"):
        outer_faces(replace(brick_beam, mesh=None), top)
    with pytest.raises(InputError, match=r"all of them clamped; expected at least one free node"):
        contact_loads(brick_beam, clamp, "xyz", fixed_nodes=clamp)
    with pytest.raises(InputError, match="patch: no node"):
        contact_loads(brick_beam, [], "xyz")
    with pytest.raises(InputError, match=r"has no normal; expected nodes of outer faces, or directions"):
        contact_loads(brick_beam, clamp, normals=surface_normals(brick_beam, faces))
    with pytest.raises(InputError, match="directions 'xq'"):
        contact_loads(brick_beam, top, "xq")
    with pytest.raises(InputError, match=r"radius -1.0; expected a positive"):
        footprint_loads(brick_beam, faces, (0.5, HEIGHT, 0.03), -1.0)
    with pytest.raises(InputError, match=r"5\d(\.\d)? % of the disc of radius 0.02 m .* x 0 to 1"):
        footprint_loads(brick_beam, faces, (0.5, HEIGHT, 0.0), 0.02)
    with pytest.raises(InputError, match=r"footprint: 0 % of the disc"):
        footprint_loads(brick_beam, faces, (0.5, 0.0, 0.03), 0.02)


def test_faces_of_plates_are_their_own_side():
    """Pressure on a quadrilateral and a triangle beside it: consistent forces against their normals."""
    from heavylift.modal.statics import face_area, face_forces
    from heavylift.preprocess.structures.assemble import assemble_structure
    from heavylift.preprocess.structures.structure import Shells, Structure

    nodes = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [3, 0, 0.0]])
    steel = Material(2.1e11, 0.3, 7850.0)
    plates = (
        Shells("deck", np.array([[0, 1, 2, 3]]), steel, 0.01),
        Shells("end", np.array([[1, 4, 2]]), steel, 0.01),
    )
    model = assemble_structure(Structure(nodes, shells=plates))
    faces = outer_faces(model, np.arange(5))
    assert face_area(model, faces) == pytest.approx(2.5)
    forces = face_forces(model, faces, pressure=12.0).reshape(-1, 3)
    np.testing.assert_allclose(forces[5:], 0.0)  # no moments
    np.testing.assert_allclose(forces[:5, 2], [-6, -6 - 2, -6 - 2, -6, -2])
    np.testing.assert_allclose(surface_normals(model, faces), np.tile([0, 0, 1.0], (5, 1)), atol=1e-15)
