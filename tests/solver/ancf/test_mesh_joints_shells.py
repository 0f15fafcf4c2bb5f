"""Mechanics of shells on joints: plates on hooks, edges that are clamped and hinged; one compiled step for all."""

from __future__ import annotations

import numpy as np
import pytest
from jointed_frames import DOWN, Run, bar, rod, run, scene
from jointed_shells import (
    ANGLES,
    AWAY,
    HALF,
    PANEL,
    TURN,
    WHOLE,
    clamped_plates,
    folding_panels,
    hung_plate,
    sheet,
)
from scipy.integrate import solve_ivp

from heavylift.numerics.outcome import InputError
from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.edges import EdgeClamp, EdgeHinge
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.mesh_shapes import quadrilateral, rectangle
from heavylift.solver.scene.scene import Scene


def all_parts(**more: object) -> Scene:
    """Every kind of joint and body of this file."""
    return scene(hung_plate(**more), clamped_plates(2.1e9, **more), folding_panels(2.1e11, **more))


@pytest.fixture(scope="module")
def falling() -> Run:
    return run(all_parts(), 2.5e-3, 0.5)


@pytest.mark.slow
def test_two_halves_clamped_together_are_one_plate(falling: Run) -> None:
    """Clamped by joints to the ground, bent far; within one per cent of the plate on supports."""
    whole, right = falling.nodes("whole"), falling.nodes("right")
    tip = whole[:, WHOLE.edges["x_max"]]
    moved = np.abs(tip - tip[0]).max()
    assert moved > 0.2
    np.testing.assert_allclose(right[:, HALF.edges["x_max"]], tip, atol=0.01 * moved)


@pytest.mark.slow
def test_clamped_edge_stays_where_it_is(falling: Run) -> None:
    """Its nodes, and the slopes that the clamp keeps, in axes of the plate."""
    left = {
        name: falling[f"left.{name}"].reshape(len(falling.times), -1, 3)[:, HALF.edges["x_min"]]
        @ TURN.as_matrix()
        for name in ("slope_x", "slope_y", "twist")
    }
    places = falling.nodes("left")[:, HALF.edges["x_min"]]
    start = AWAY + TURN.apply(HALF.nodes[HALF.edges["x_min"]])
    np.testing.assert_allclose(places, np.broadcast_to(start, places.shape), atol=1e-9)
    for name, axes in (("slope_x", [2]), ("slope_y", [0, 2]), ("twist", [2])):
        np.testing.assert_allclose(left[name][..., axes], 0.0, atol=1e-7)


@pytest.mark.slow
def test_edges_on_each_other_coincide_between_nodes(falling: Run) -> None:
    """Cubic curves with the same ends and slopes; the clamp keeps both surfaces tangent there as well."""
    for name, first, second, mesh in (("seam", "left", "right", HALF), ("fold", "first", "second", PANEL)):
        curves = []
        for body, edge in ((first, "x_max"), (second, "x_min")):
            at = {
                vector: falling[f"{body}.{vector}"].reshape(len(falling.times), -1, 3)[:, mesh.edges[edge]]
                for vector in ("position", "slope_x", "slope_y", "twist")
            }
            length = mesh.lengths[0, 1]
            middle = [
                (at[value][:, :-1] + at[value][:, 1:]) / 2
                + length * (at[slope][:, :-1] - at[slope][:, 1:]) / 8
                for value, slope in (("position", "slope_y"), ("slope_x", "twist"))
            ]
            curves.append((*middle, at["slope_y"][:, :-1]))
        np.testing.assert_allclose(curves[0][0], curves[1][0], atol=1e-5)
        normal = np.cross(curves[0][1], curves[0][2])
        kink = np.einsum("tnk,tnk->tn", normal / np.linalg.norm(normal, axis=2, keepdims=True), curves[1][1])
        if name == "seam":
            assert np.abs(kink).max() < 0.02
        else:
            assert np.abs(kink).max() > 0.3  # it folds


@pytest.mark.slow
def test_hinged_panels_are_a_double_pendulum(falling: Run) -> None:
    """Two stiff panels against two uniform rods."""
    length, g = 0.5, 9.81

    def slope(_: float, y: np.ndarray) -> list[float]:
        a, b, da, db = y
        cross = 0.5 * length**2 * np.cos(a - b)
        M = np.array([[4 / 3 * length**2, cross], [cross, length**2 / 3]])
        curl = 0.5 * length**2 * np.sin(a - b)
        force = [1.5 * length * g * np.cos(a) - curl * db**2, 0.5 * length * g * np.cos(b) + curl * da**2]
        return [da, db, *np.linalg.solve(M, force)]

    found = solve_ivp(slope, (0.0, 0.5), [*ANGLES, 0.0, 0.0], t_eval=falling.times, rtol=1e-10, atol=1e-12).y
    x = length * (np.cos(found[0]) + np.cos(found[1]))
    z = -length * (np.sin(found[0]) + np.sin(found[1]))
    end = falling.nodes("second")[:, PANEL.edges["x_max"]]
    assert np.ptp(x) > 0.2
    np.testing.assert_allclose(end[..., 0], x[:, None] * np.ones(3), atol=2e-3)
    np.testing.assert_allclose(end[..., 2], z[:, None] * np.ones(3), atol=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("elasticity", ["carried", "auto"])
def test_energy_of_a_plate_on_hooks_stays_bounded(elasticity: str) -> None:
    """Steps fifty times the explicit limit of the steel plate."""
    long = run(all_parts(elasticity=elasticity), 5e-3, 4.0)
    assert long.energy_change() < 2e-3 * long["energy.kinetic"].max()
    assert long["monitor.violation"].max() < 0.01


@pytest.mark.slow
def test_reactions_are_what_changes_momentum() -> None:
    """All that touch the ground, edges node by node, and the weight; impulses over half a second."""
    bodies, joints = clamped_plates(2.1e9)
    parts = run(scene(hung_plate(), (bodies[1:], joints), folding_panels(2.1e11)), 2.5e-3, 0.5, 2.5e-3)
    force = np.zeros((len(parts.times), 3))
    for channel in parts.simulation.channels:
        owner, _, what = channel.name.rpartition(".")
        if what == "reaction_force" and owner.startswith(("top", "base.", "pin.")):
            # of the ground, which is the first side of hooks and the second of edges
            force += (1.0 if owner.startswith("top") else -1.0) * parts[channel.name]
    mass = 3.0 * 2.0 * 5e-3 * 7850.0 + 4 * 20.0 + 4 * 0.5 * 0.6 * 1e-2 * 7850.0
    force[:, 2] -= mass * 9.81
    impulse = np.cumsum((force[1:] + force[:-1]) / 2, axis=0) * 2.5e-3
    momentum = parts["momentum.linear"] - parts["momentum.linear"][0]
    assert np.abs(momentum).max() > 50.0
    np.testing.assert_allclose(momentum[1:], impulse, atol=0.01 * mass * 9.81 * 0.5)


def refused(*joints: object, forces: tuple[object, ...] = ()) -> InputError:
    """The error of a scene with two plates side by side, one of a finer mesh, one bent, a frame and a rod."""
    bent = np.array([[0.0, 0.0, 0.0], [1.0, 0.2, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    curved = quadrilateral(bent, 2, 2)
    nodes = curved.nodes.copy()
    nodes[curved.edges["y_min"][1]] += [0.0, 0.05, 0.0]
    bodies = (
        sheet("a", rectangle(1.0, 0.6, 2, 2), 0.01, 2e9),
        sheet("b", rectangle(1.0, 0.6, 2, 2), 0.01, 2e9, position=np.array([1.0, 0.0, 0.0])),
        sheet("finer", rectangle(1.0, 0.6, 2, 3), 0.01, 2e9, position=np.array([1.0, 0.0, 0.0])),
        sheet("bent", curved._replace(nodes=nodes), 0.01, 2e9),
        bar("frame", np.zeros(3), [1.0, 0.0, 0.0], 2, 2e9),
        rod("rod", np.zeros(3), [1.0, 0.0, 0.0], 1.0),
    )
    with pytest.raises(InputError) as caught:
        pack_scene(Scene(bodies, (DOWN, *forces), joints=joints))  # type: ignore[arg-type]
    return caught.value


EDGE = rectangle(1.0, 0.6, 2, 2).edges


def test_edges_that_are_none_are_refused() -> None:
    """Each names the joint and the key."""
    x_min, x_max, y_min = EDGE["x_min"], EDGE["x_max"], EDGE["y_min"]
    cases = [
        (EdgeHinge(name="e", body_a="rod", body_b="a", nodes_a=x_min), "between"),
        (EdgeHinge(name="e", body_a="a", body_b="frame", nodes_a=x_min), "between"),
        (EdgeHinge(name="e", body_a="a", body_b="rod", nodes_a=x_min, nodes_b=x_min), "nodes_b"),
        (EdgeClamp(name="e", body_a="a", body_b=GROUND, nodes_a=x_min[[0, 2]]), "nodes_a"),
        (EdgeClamp(name="e", body_a="a", body_b=GROUND, nodes_a=x_min[:1]), "nodes_a"),
        (EdgeClamp(name="e", body_a="a", body_b=GROUND, nodes_a=np.array([0, 99])), "nodes_a"),
        (
            EdgeClamp(name="e", body_a="a", body_b=GROUND, nodes_a=np.array([*y_min[::-1], *x_min[1:]])),
            "nodes_a",
        ),
        (EdgeClamp(name="e", body_a="a", body_b="b", nodes_a=x_max, nodes_b=x_min[:2]), "nodes_b"),
        (EdgeHinge(name="e", body_a="bent", body_b=GROUND, nodes_a=y_min), "nodes_a"),
        (
            EdgeClamp(
                name="e",
                body_a="a",
                body_b="finer",
                nodes_a=x_max,
                nodes_b=rectangle(1.0, 0.6, 2, 3).edges["x_min"][:3],
            ),
            "nodes_b",
        ),
    ]
    for joint, key in cases:
        error = refused(joint)
        assert (error.source, error.key) == ("e", key), error


def test_springs_on_edges_are_refused() -> None:
    hinge = EdgeHinge(name="e", body_a="a", body_b=GROUND, nodes_a=EDGE["x_min"])
    assert refused(hinge, forces=(JointSpring(name="coil", joint="e", stiffness=1.0),)).source == "coil"
