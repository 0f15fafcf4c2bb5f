"""Static vectors of contact patches and stiffness-proportional damping, from the case file to the reduced body."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline import load_case, load_results, run_case
from heavylift.pipeline.assemble.scene import assemble_scene
from heavylift.pipeline.results.model_io import read_model, read_reduced
from heavylift.pipeline.results.provenance import modes_digest

TOP = "bodies.beam.geometry.groups={root={plane='x', at=0}, top={face='bar.y_max'}, free={plane='x', at='200 mm'}}"
FINE = "bodies.beam.mesh.divisions={x=[16], y=[2], z=[2]}"
ATTACH = "bodies.beam.modes.attach=contour"


def patches(text):
    return f"bodies.beam.modes.patches={text}"


def reduce(folder, *overrides):
    case = load_case(folder, [TOP, FINE, ATTACH, *overrides])
    out = run_case(case, stages=("mesh", "modes")).folder
    return read_reduced(out.reduced("beam")), read_model(out.model("beam"))


def compliance(reduced, forces):
    shapes = reduced.mode_shapes.reshape(reduced.mode_count, -1)
    return forces.T @ shapes.T @ ((shapes @ forces) / reduced.eigenvalues[:, None])


def full_compliance(model, forces):
    free = np.setdiff1d(np.arange(model.node_count), model.node_groups["root"])
    rows = (3 * free[:, None] + np.arange(3)).ravel()
    K = model.stiffness.toarray()[np.ix_(rows, rows)]
    return forces[rows].T @ np.linalg.solve(K, forces[rows])


def unit_loads(model, nodes, axes):
    forces = np.zeros((3 * model.node_count, len(nodes) * len(axes)))
    for column, row in enumerate(3 * node + axis for node in nodes for axis in axes):
        forces[row, column] = 1.0
    return forces


@pytest.mark.parametrize(("directions", "axes"), [("normal", (1,)), ("xyz", (0, 1, 2))])
def test_one_key_gives_the_compliance_of_the_full_model_at_the_nodes_of_a_patch(small_case, directions, axes):
    reduced, model = reduce(
        small_case,
        patches(
            f"[{{on='top', from=['150 mm', 0, 0], to=['200 mm', '20 mm', '10 mm'], directions='{directions}'}}]"
        ),
    )
    position = model.nodes
    nodes = np.flatnonzero((position[:, 0] > 0.1499) & (np.abs(position[:, 1] - 0.02) < 1e-9))
    assert len(nodes) == 5 * 3
    assert reduced.mode_count == 3 + 15 * len(axes)
    assert sum(label.startswith("eigenmode") for label in reduced.labels) >= 1
    loads = unit_loads(model, nodes, axes)
    expected = full_compliance(model, loads)
    np.testing.assert_allclose(compliance(reduced, loads), expected, rtol=0, atol=1e-10 * expected.max())


@pytest.mark.parametrize(
    ("contour", "directions", "axes", "count"),
    [
        ("{type='surface', body='beam', face={on='top', from=['150 mm', 0, 0], to=[1, 1, 1]}}", "", (1,), 15),
        ("{type='curve', body='beam', line={from=[0, 0, 0], to=['200 mm', 0, 0]}}", "", (0, 1, 2), 16),
        ("{type='curve', body='beam', line={from=[0, 0, 0], to=['200 mm', 0, 0]}}", "yz", (1, 2), 16),
    ],
)
def test_without_patches_the_nodes_of_contours_are_taken(small_case, contour, directions, axes, count):
    choice = (f"bodies.beam.modes.attach_directions={directions}",) if directions else ()
    reduced, model = reduce(small_case, f"contours={{touch={contour}}}", *choice)
    position = model.nodes
    if "surface" in contour:
        nodes = np.flatnonzero((position[:, 0] > 0.1499) & (np.abs(position[:, 1] - 0.02) < 1e-9))
    else:
        nodes = np.flatnonzero((position[:, 0] > 1e-9) & (np.linalg.norm(position[:, 1:], axis=1) < 1e-9))
    assert len(nodes) == count
    loads = unit_loads(model, nodes, axes)
    expected = full_compliance(model, loads)
    np.testing.assert_allclose(compliance(reduced, loads), expected, rtol=0, atol=1e-10 * expected.max())
    # another contour makes other modes
    case = load_case(small_case, [TOP, FINE, ATTACH, f"contours={{touch={contour}}}", *choice])
    moved = contour.replace("200", "100").replace("150", "100")
    other = load_case(small_case, [TOP, FINE, ATTACH, f"contours={{touch={moved}}}", *choice])
    body = case.bodies["beam"]
    assert modes_digest(case, body) != modes_digest(other, other.bodies["beam"])


def test_attach_without_contours_or_patches_is_told(small_case):
    with pytest.raises(InputError, match=r"bodies.beam.modes.attach: no contour is of the body 'beam'"):
        reduce(small_case)


@pytest.mark.slow
def test_a_disc_takes_its_nodes_and_a_footprint_is_one_vector(small_case):
    disc = "{on='top', centre=['175 mm', '20 mm', '5 mm'], radius='5 mm'%s}"
    reduced, _ = reduce(small_case, patches(f"[{disc % ''}]"))
    assert reduced.mode_count == 3 + 3  # three nodes across the beam at x = 175 mm
    reduced, model = reduce(small_case, patches(f"[{disc % ', footprint=true'}]"))
    assert reduced.mode_count == 3 + 1
    # the mean over the disc, integrated here by summing over a fine raster of bilinear faces
    a, b = np.meshgrid(*(np.linspace(-1, 1, 801),) * 2, indexing="ij")
    w = np.maximum(1 - a**2 - b**2, 0.0) ** 2
    forces = np.zeros((3 * model.node_count, 1))
    for node, (x, y, z) in enumerate(model.nodes):
        if abs(y - 0.02) < 1e-9:
            hat = np.maximum(1 - np.abs(0.175 + 0.005 * a - x) / 0.0125, 0) * np.maximum(
                1 - np.abs(0.005 + 0.005 * b - z) / 0.005, 0
            )
            forces[3 * node + 1] = (w * hat).sum() / w.sum()
    assert compliance(reduced, forces) == pytest.approx(full_compliance(model, forces), rel=1e-6)


def test_contact_loads_can_span_a_krylov_basis(small_case):
    reduced, _ = reduce(
        small_case,
        patches("[{on='top', centre=['175 mm', '20 mm', '5 mm'], radius='5 mm', footprint=true}]"),
        "bodies.beam.modes.basis=krylov",
        "bodies.beam.modes.count=0",
        "bodies.beam.modes.order=6",
        "bodies.beam.initial={}",
    )
    assert reduced.mode_count == 6


def test_stiffness_damping_is_half_beta_omega_of_critical(small_case):
    beta = 2e-6
    overrides = (f"bodies.beam.modes.stiffness_damping='{beta} s'", "bodies.beam.modes.damping_ratio=0.01")
    case = load_case(small_case, overrides)
    out = run_case(case, stages=("mesh", "modes", "simulate")).folder
    scene = assemble_scene(case, out)
    omega = np.sqrt(scene.bodies[0].reduced.eigenvalues)
    ratio = scene.bodies[0].damping_ratio
    np.testing.assert_allclose(ratio, 0.01 + 0.5 * beta * omega, rtol=1e-14)
    # free decay of every mode, closed form
    history = load_results(case)
    q = history["beam.modal_position"].reshape(len(history.time), -1)
    damped = omega * np.sqrt(1 - ratio**2)
    v = scene.bodies[0].modal_velocity
    t = history.time[:, None]
    exact = v / damped * np.exp(-ratio * omega * t) * np.sin(damped * t)
    np.testing.assert_allclose(q[:, :2], exact[:, :2], atol=2e-4 * np.abs(exact).max())


@pytest.mark.parametrize(
    ("override", "key", "words"),
    [
        (("bodies.beam.modes.attach_directions=xyz",), "attach", "'attach_directions' without 'attach'"),
        (
            (TOP, ATTACH, patches("[{on='top'}]"), "bodies.beam.modes.attach_directions=xyz"),
            "attach_directions",
            "'directions' of each patch",
        ),
        ((TOP, patches("[{on='top'}]")), "attach", "'patches' without 'attach'"),
        ((ATTACH, patches("[{on='top', from=[0,0,0]}]")), "patches.0.to", "'from' without 'to'"),
        ((ATTACH, patches("[{on='top', centre=[0,0,0]}]")), "patches.0.radius", "'centre' without 'radius'"),
        ((ATTACH, patches("[{on='top', footprint=true}]")), "patches.0.footprint", "without a disc"),
        ((ATTACH, patches("[{on='top', from=[0,0,1], to=[1,1,0]}]")), "patches.0.to", "no smaller than"),
        ((ATTACH, patches("[{on='top', directions='zx'}]")), "patches.0.directions", ""),
        (("bodies.beam.modes.stiffness_damping=-1e-5",), "stiffness_damping", "too small"),
    ],
)
def test_contradictions_in_the_case_are_told_at_their_key(small_case, override, key, words):
    with pytest.raises(InputErrors) as caught:
        load_case(small_case, override)
    text = str(caught.value)
    assert f"bodies.beam.modes.{key}" in text
    assert words in text


@pytest.mark.parametrize(
    ("patch", "key", "words"),
    [
        ("{on='side'}", "patches.0.on", "group 'side' does not exist"),
        ("{on='top', from=[1,1,1], to=[2,2,2]}", "patches.0", "none of 51 nodes of the face is in the box"),
        ("{on='edge'}", "patches.0.on", "that make up no outer face"),
        ("{on='root', directions='xyz'}", "patches.0", "all of them clamped"),
        (
            "{on='top', centre=[0.1, 0.02, 0], radius='5 mm', footprint=true}",
            "patches.0",
            "50 % of the disc",
        ),
    ],
)
def test_patches_that_do_not_exist_on_the_mesh_are_told_at_their_key(small_case, patch, key, words):
    edge = TOP.replace(
        "free={plane='x', at='200 mm'}", "edge={from=[0, '20 mm', 0], to=['200 mm', '20 mm', 0]}"
    )
    with pytest.raises(InputError) as caught:
        reduce(small_case, edge, patches(f"[{patch}]"))
    text = str(caught.value)
    assert f"bodies.beam.modes.{key}: " in text
    assert words in text
