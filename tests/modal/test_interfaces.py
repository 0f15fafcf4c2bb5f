"""Interfaces of nodes: loads, motions, attachment modes and rigid Craig-Bampton against independent numbers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from heavylift.modal import interfaces
from heavylift.modal.bases import craig_bampton, eigenmode_basis, static_vectors
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility, rigid_motions
from heavylift.modal.reduction import reduce_body
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.structure import Shells, Structure

EI = 2.1e11 * 0.02**4 / 12.0


@pytest.fixture(scope="module")
def bar():
    """A steel bar of 1 m, 20 mm square, of 40 x 2 x 2 bricks."""

    def make(poisson_ratio, formulation, mass):
        mesh = mesh_blocks(
            [Box("bar", (0, -0.01, -0.01), (1.0, 0.01, 0.01))],
            element_type="hex8",
            divisions={"x": [40], "y": [2], "z": [2]},
            groups=[OnPlane("left", "x", 0.0), OnPlane("right", "x", 1.0)],
        )
        return assemble(mesh, Material(2.1e11, poisson_ratio, 7850.0), formulation=formulation, mass=mass)

    return make


def end_fit(model, group, x):
    nodes = model.node_groups[group]
    return interfaces.fit(model, (x, 0.0, 0.0), nodes, interfaces.group_weights(model, nodes))


def test_fit_reads_rigid_motions_and_spreads_their_loads(bar):
    model = bar(0.3, "incompatible", "lumped")
    found = interfaces.fit(model, (1.2, 0.3, -0.1), np.array([1, 40, 150, 300]), [0.1, 0.5, 0.2, 0.2])
    loads = interfaces.attachment_loads(model, found, "LUG")
    motions = rigid_motions(model.nodes)
    arm = found.point - model.nodes.mean(axis=0)
    size = np.sqrt(np.mean(np.sum((model.nodes - model.nodes.mean(axis=0)) ** 2, axis=1)))
    expected = np.zeros((6, 6))
    expected[:3, :3] = np.eye(3)
    expected[:3, 3:] = np.cross(np.eye(3), arm).T / size
    expected[3:, 3:] = np.eye(3) / size
    np.testing.assert_allclose(loads.forces.T @ motions, expected, atol=1e-12)
    assert loads.labels[3] == "LUG moment x"


def test_weights_of_a_face_are_its_tributary_areas(bar):
    model = bar(0.3, "incompatible", "lumped")
    nodes = model.node_groups["right"]
    weights = interfaces.group_weights(model, nodes)
    inner = np.abs(model.nodes[nodes][:, 1:]) < 1e-9
    np.testing.assert_allclose(weights, 2.0 ** (inner.sum(axis=1) - 4.0))


def test_weights_of_a_line_of_plates_are_its_lengths():
    nodes = np.array([[0, 0, 0], [1, 0, 0], [3, 0, 0], [0, 1, 0], [1, 1, 0], [3, 1, 0.0]])
    plates = Shells("p", np.array([[0, 1, 4, 3], [1, 2, 5, 4]]), Material(2e11, 0.3, 7850.0), 0.01)

    model = SimpleNamespace(
        mesh=None, structure=Structure(nodes, shells=(plates,)), node_count=6, nodes=nodes
    )
    np.testing.assert_allclose(interfaces.group_weights(model, np.array([0, 1, 2])), [1 / 6, 1 / 2, 1 / 3])
    np.testing.assert_allclose(interfaces.group_weights(model, np.array([0, 5])), [0.5, 0.5])


def test_weights_of_a_ragged_patch_are_the_areas_around_its_nodes():
    """A graded grid of plates: a cross of nodes with one whole plate in it."""
    x, y = np.array([0.0, 1.0, 2.0, 4.0]), np.array([0.0, 1.0, 3.0, 4.0])
    nodes = np.array([(a, b, 0.0) for a in x for b in y])
    quads = np.array(
        [[4 * i + j, 4 * i + 4 + j, 4 * i + 5 + j, 4 * i + 1 + j] for i in range(3) for j in range(3)]
    )
    plates = Shells("p", quads, Material(2e11, 0.3, 7850.0), 0.01)
    model = SimpleNamespace(
        mesh=None, structure=Structure(nodes, shells=(plates,)), node_count=16, nodes=nodes
    )
    group = np.array([5, 6, 9, 10, 1])  # the plate in the middle, and a node beside it on the border
    width, height = np.array([0.5, 1.0, 1.5, 1.0]), np.array([0.5, 1.5, 1.5, 0.5])
    area = (width[:, None] * height).ravel()[group]
    np.testing.assert_allclose(interfaces.group_weights(model, group), area / area.sum())
    np.testing.assert_allclose(interfaces.group_weights(model, group[:4]), 0.25)


def test_end_moment_turns_the_end_face_as_the_closed_form_says(bar):
    """The fit over the face, where the gradient of the last layer is short by h / (2 L)."""
    model = bar(0.0, "incompatible", "lumped")
    found = end_fit(model, "right", 1.0)
    loads = interfaces.attachment_loads(model, found, "tip")
    body = Flexibility(model, model.node_groups["left"])
    compliance = loads.forces.T @ body.solve(loads.forces)
    assert compliance[4, 4] == pytest.approx(1.0 / EI, rel=1e-6)
    shear = 1.2 / (1.05e11 * 0.02**2)
    assert compliance[2, 2] == pytest.approx(1.0 / (3.0 * EI) + shear, rel=1e-3)
    assert compliance[2, 4] == pytest.approx(-1.0 / (2.0 * EI), rel=1e-5)


@pytest.mark.parametrize("kind", ["average", "rigid"])
def test_cantilever_by_its_free_body_and_six_attachment_modes(bar, kind):
    """A free beam whose end is held, under its weight: attachment modes alone are the full model."""
    model = bar(0.0, "incompatible", "lumped")
    found = end_fit(model, "left", 0.0)
    loads = interfaces.attachment_loads(model, found, "root")
    if kind == "rigid":
        model, _ = interfaces.stiffened(model, {"root": found})
    basis = static_vectors(Flexibility(model), loads)
    body = reduce_body(model, basis.vectors, basis.labels, mean_axis=True)
    root = interfaces.interface_of(body, found, np.zeros(3), np.ones(6))
    # equilibrium of frame and modes: lambda holds U = Theta = 0 at the root
    motion = np.hstack([root.displacement, root.rotation])
    mass = body.integrals.mass
    hold = np.zeros(6)
    hold[2] = mass * 9.81
    centre = body.integrals.first_moment / mass
    hold[3:] = np.cross(centre, [0.0, 0.0, hold[2]])
    q = motion @ hold / body.eigenvalues
    tip = np.argmin(np.linalg.norm(model.nodes - [1.0, 0.0, 0.0], axis=1))
    placed = motion.T @ q
    moved = q @ body.mode_shapes[:, tip] - placed[:3] - np.cross(placed[3:], model.nodes[tip])
    assert 1e3 * moved[2] == pytest.approx(-1.37552, abs=2e-5)


def test_rigid_craig_bampton_meets_the_independent_prototype(bar):
    model = bar(0.3, "incompatible", "lumped")
    fits = {"left": end_fit(model, "left", 0.0), "right": end_fit(model, "right", 1.0)}
    model, masters = interfaces.stiffened(model, fits)
    basis = interfaces.rigid_craig_bampton(model, fits, masters, 6)
    body = reduce_body(model, basis.vectors, basis.labels, mean_axis=True)
    assert body.mode_count == 12 + 6 - 6
    expected = [106.025, 106.025, 292.4019, 292.4019, 570.8807, 570.8807, 1443.0521, 1652.2395]
    np.testing.assert_allclose(body.frequencies[:8], expected, rtol=5e-6)
    faces = [np.flatnonzero(np.isclose(model.nodes[:, 0], x)) for x in (0.0, 1.0)]
    for nodes in faces:  # they do not deform
        length = np.linalg.norm(model.nodes[nodes][0] - model.nodes[nodes][-1])
        apart = body.mode_shapes[:, nodes[0]] - body.mode_shapes[:, nodes[-1]]
        along = (model.nodes[nodes][0] - model.nodes[nodes][-1]) / length
        assert np.abs(apart @ along).max() < 1e-9 * np.abs(body.mode_shapes).max()


def test_nodal_craig_bampton_meets_an_independent_one(bar):
    model = bar(0.3, "full", "consistent")
    both = np.concatenate([model.node_groups["left"], model.node_groups["right"]])
    basis = craig_bampton(model, both, 6)
    body = reduce_body(model, basis.vectors, basis.labels, mean_axis=True)
    expected = [136.12752, 136.12752, 376.55504, 376.55504, 737.76178, 737.76178]
    expected += [1768.4749, 2199.58968, 2199.58968, 2845.66386, 3474.3791, 3474.3791]
    np.testing.assert_allclose(body.frequencies[:12], expected, rtol=1e-6)


def test_six_vectors_at_a_tip_capture_all_of_its_compliance(bar):
    model = bar(0.0, "incompatible", "lumped")
    clamp = model.node_groups["left"]
    found = end_fit(model, "right", 1.0)
    body = Flexibility(model, clamp)
    loads = interfaces.attachment_loads(model, found, "tip")
    exact = np.sum(loads.forces * body.solve(loads.forces), axis=0)
    modes = eigenmode_basis(eigenmodes(model, 10, flexibility=body))
    shares = []
    for basis in (modes, modes + static_vectors(body, loads)):
        reduced = reduce_body(model, basis.vectors, basis.labels, fixed_nodes=clamp, mean_axis=False)
        shares.append(interfaces.interface_of(reduced, found, np.zeros(3), exact).captured)
    assert shares[0] < 0.95
    assert shares[1] == pytest.approx(1.0, abs=1e-9)


def test_line_of_nodes_with_rotations_turns_about_itself(beam_chain):
    model = beam_chain(6, rotary=True)
    found = interfaces.fit(model, (0.2, 0.0, 0.0), np.array([0, 1]), [0.5, 0.5])
    loads = interfaces.attachment_loads(model, found, "edge")
    motions = rigid_motions(model.nodes, model.rotating)
    size = np.sqrt(np.mean((model.nodes[:, 0] - 1.0) ** 2))
    turned = loads.forces.T @ motions[:, 3] * size
    np.testing.assert_allclose(turned, [0, 0, 0, 1, 0, 0], atol=1e-12)
    arm = np.array([0.0, 0.0, 0.1])
    single = interfaces.fit(model, model.nodes[3] + arm, np.array([3]), [1.0])
    np.testing.assert_allclose(
        single.moments[0], np.hstack([np.cross(arm, np.eye(3)).T, np.eye(3)]), atol=1e-15
    )


@pytest.mark.parametrize(
    ("nodes", "words"),
    [([5], "one node without rotations"), ([0, 1, 2], "3 nodes without rotations on one line")],
)
def test_groups_of_solids_that_do_not_turn_are_refused(bar, nodes, words):
    model = bar(0.3, "incompatible", "lumped")
    line = np.flatnonzero(np.all(np.isclose(model.nodes[:, :2], [0.0, -0.01]), axis=1))
    nodes = line if len(nodes) > 1 else nodes
    with pytest.raises(InputError, match=words):
        interfaces.fit(model, (0, 0, 0), nodes, np.ones(len(nodes)))


def test_coincident_and_overlapping_interfaces_are_refused(bar):
    model = bar(0.3, "incompatible", "lumped")
    one = end_fit(model, "left", 0.0)
    with pytest.raises(InputError, match="its reference point in common with interface 'A'"):
        interfaces.refuse_coincident({"A": one, "B": end_fit(model, "right", 0.0)}, 1.0)
    with pytest.raises(InputError, match="its nodes in common"):
        interfaces.refuse_coincident({"A": one, "B": end_fit(model, "left", 0.5)}, 1.0)
    with pytest.raises(InputError, match="belongs to interface 'A' too"):
        interfaces.stiffened(model, {"A": one, "B": end_fit(model, "left", 0.5)})
    with pytest.raises(InputError, match="is held or follows others"):
        interfaces.stiffened(replace(model, fixed_nodes=one.nodes[:1]), {"A": one})


def test_modes_up_to_a_frequency(bar):
    model = bar(0.3, "incompatible", "lumped")
    all_of_them = eigenmodes(model, 12).frequencies
    limit = 0.5 * (all_of_them[6] + all_of_them[7])
    found = eigenmodes(model, 0, up_to=limit)
    np.testing.assert_allclose(found.frequencies, all_of_them[:7], rtol=1e-8)
    assert len(eigenmodes(model, 4, up_to=limit).eigenvalues) == 4
    with pytest.raises(InputError, match="no mode up to 20 Hz; expected at least the first frequency, 105"):
        eigenmodes(model, 0, up_to=20.0)
