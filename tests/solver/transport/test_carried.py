"""What transporters carry: bodies with modes, bodies that are fixed together, one body on several transporters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from point_masses import Cloud
from vehicles import MASS, OIL, TYRE, G, block, bump, groups_of, histories, scene, vehicle, yard

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.guide import Guide
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.scene import FlexibleBody, RigidBody
from heavylift.solver.simulation import Simulation
from heavylift.solver.transport.packing import vehicle_tipping

STATIONS = np.linspace(-3.5, 3.5, 6)
LOAD = MASS * G / 12


def cloud(frequency: float) -> Cloud:
    """173 t in 24 points, two levels at z = 1.5 and 5.5 m, that bends up and down and twists."""
    nodes = np.array([(x, y, z) for x in STATIONS for y in (-1.2, 1.2) for z in (1.5, 5.5)])
    masses = np.full(len(nodes), MASS / len(nodes))
    x, y = nodes[:, 0], nodes[:, 1]
    shapes = np.zeros((2, len(nodes), 3))
    shapes[0, :, 2] = x**2 - np.mean(x**2)
    shapes[1, :, 2] = x * y
    shapes[1, :, 1] = -x * (nodes[:, 2] - 3.5)  # sections turn
    shapes /= np.sqrt(np.einsum("j,kja,kja->k", masses, shapes, shapes))[:, None, None]
    return Cloud(masses, nodes, shapes, (2.0 * np.pi * frequency * np.array([1.0, 1.3])) ** 2)


def soft(frequency: float = 5.0, **more) -> FlexibleBody:
    """The cloud as a body."""
    return FlexibleBody("block", cloud(frequency).reduced(), **more)


def stiff_twin() -> RigidBody:
    """The cloud without modes."""
    points = cloud(1.0)
    centre = points.masses @ points.nodes / points.masses.sum()
    d = points.nodes - centre
    J = np.eye(3) * (points.masses @ np.sum(d * d, axis=1)) - d.T @ (points.masses[:, None] * d)
    return block(mass=MASS, centre_of_mass=centre, inertia=0.5 * (J + J.T))


@pytest.mark.parametrize(("pipe", "rubber"), [(0.0, 0.0), (2.0e4, 1.5e4)])
def test_a_body_with_stiff_modes_goes_over_a_bump_as_a_rigid_one(pipe, rubber) -> None:
    """Bogies on the road 1.5 m below its nodes, and beside them: levers, loads, energy; dampers with a row a bogie."""
    given = {"travel_speed": 1.0, "line_damping": pipe, "tyre_damping": rubber}
    decks = (yard(), bump(4.5, 2.0, (0.2, 1.5), "smooth", height=0.05))
    found = {}
    for name, body in (("stiff", stiff_twin()), ("modes", soft(60.0, damping_ratio=np.full(2, 0.05)))):
        run, _, found[name] = histories(scene(vehicle(**given), decks, body), 5e-3, 8.0, 20)
        assert run.outcome is Outcome.COMPLETED
    for channel in ("heave", "roll", "pitch", "wheel_load", "stroke_of", "group_force"):
        expected = found["stiff"][f"spmt.{channel}"]
        allowed = 4e-3 * np.ptp(expected)
        np.testing.assert_allclose(found["modes"][f"spmt.{channel}"], expected, atol=allowed, err_msg=channel)
    e = found["modes"]
    total = sum(e[f"energy.{n}"] for n in ("kinetic", "potential", "elastic", "dissipated"))
    total -= e["energy.drive_work"]
    np.testing.assert_allclose(total, total[0], atol=1e-3 * np.ptp(e["energy.potential"]))


@pytest.mark.parametrize("number", [4, 12])
def test_a_soft_body_in_a_sag_bends_on_springs_and_not_on_groups(number) -> None:
    """Slowly through a parabola of 50 mm, in the middle of it: balance of heave and of the mode, in plain NumPy."""
    x = np.array([point[0] for group in groups_of(number) for point in group.bogies])
    stations = np.linspace(-7.0, 7.0, 41)
    middle, heights = 12.0, 0.05 * ((stations / 7.0) ** 2 - 1.0)
    sag = yard(
        stations=np.concatenate([[-30.0], middle + stations, [60.0]]),
        heights=np.concatenate([[0.0], heights, [0.0]]),
    )
    body = soft(5.0, damping_ratio=np.full(2, 0.1))
    carried = vehicle(
        groups=groups_of(number), bogie_mass=0.0, travel_speed=0.1, line_damping=2e4, tyre_damping=1.5e4
    )
    # at rest on the level first: bends by what the bogies carry
    guide = Guide(name="guide", body_a="ground", body_b="block")
    made = scene(carried, (sag,), body, joints=(guide,))
    run = Simulation(made, step=1e-2, integrator="dele2", start="equilibrium", record_every=100)
    times, records = run.advance(round(middle / 0.1 / 1e-2))
    assert times[-1] == pytest.approx(120.0)
    last = {c.name: records[-1, c.column : c.column + len(c.components)] for c in run.channels}
    w2 = body.reduced.eigenvalues[0]
    nodes = [int(np.argmin(np.linalg.norm(body.reduced.nodes - [p, 0.725, 0.0], axis=1))) for p in x]
    shapes = body.reduced.mode_shapes[0, nodes, 2]
    road = np.interp(x, stations, heights)
    # unknown: heave, mode q, force f of each group: f = f0 + kappa sum s, s = road - heave - phi q - (f - f0) / k_t
    of = np.repeat(np.arange(number), 12 // number) == np.arange(number)[:, None]
    n = of.sum(axis=1)
    A = np.zeros((2 + number, 2 + number))
    A[2:, 2:] = np.diag(n / OIL + n / TYRE)
    A[2:, 0], A[2:, 1] = n, of @ shapes
    A[0, 2:], A[1, 2:], A[1, 1] = n, of @ shapes, -w2
    b = np.concatenate([[MASS * G, 0.0], of @ road + LOAD * (n / OIL + n / TYRE)])
    found = np.linalg.solve(A, b)
    np.testing.assert_allclose(last["spmt.wheel_load"], found[2:] @ of, atol=2e-3 * LOAD)
    assert last["block.modal_position"][0] == pytest.approx(found[1], rel=1e-2, abs=1e-6)
    spread = np.ptp(found[2:])
    assert (spread < 1e-6 * LOAD) if number == 4 else (spread > 0.15 * LOAD), spread / LOAD


def test_a_soft_body_without_damping_keeps_its_energy() -> None:
    """Over a bump on its left wheels."""
    decks = (yard(), bump(4.5, 2.0, (0.2, 1.5), "smooth"))
    _, _, found = histories(scene(vehicle(travel_speed=1.0), decks, soft(4.0)), 5e-3, 8.0, 20)
    total = sum(found[f"energy.{name}"] for name in ("kinetic", "potential", "elastic"))
    total -= found["energy.drive_work"]
    np.testing.assert_allclose(total, total[0], atol=1e-6 * np.ptp(found["energy.drive_work"]))


def test_what_is_fixed_to_the_body_weighs_on_its_bogies() -> None:
    """A platform of 23 t and a load of 150 t on it; held by a hinge in its place, its share is not known."""
    platform = block(mass=23e3, centre_of_mass=np.array([0.0, 0.0, 1.0]), inertia=np.eye(3) * 1e5)
    load = RigidBody("load", 150e3, np.diag([8e5, 5e6, 5e6]), position=np.array([0.3, 0.0, 4.0]))
    at = np.array([0.3, 0.0, 2.0])
    frames = {"frame_a": JointFrame(at), "frame_b": JointFrame(at - load.position)}
    fixed = FixedJoint(name="lashing", body_a="block", body_b="load", **frames)
    made = scene(vehicle(bogie_mass=0.0), (yard(),), bodies=(platform, load), joints=(fixed,))
    _, _, found = histories(made, 5e-3, 2.0, 20)
    x = 0.3 * 150.0 / 173.0
    front, rear = LOAD * (1.0 + x / 2.1), LOAD * (1.0 - x / 2.1)
    np.testing.assert_allclose(found["spmt.wheel_load"][:, :6], front, rtol=1e-8)
    np.testing.assert_allclose(found["spmt.wheel_load"][:, 6:], rear, rtol=1e-8)
    height = (23.0 * 1.0 + 150.0 * 4.0) / 173.0
    assert vehicle_tipping(made)["spmt"].static == pytest.approx(np.arctan(0.725 / height), rel=1e-9)
    hinged = replace(made, joints=(Hinge(name="hinge", body_a="block", body_b="load", **frames),))
    with pytest.raises(InputError, match="'load' hangs on it by a joint that is not fixed"):
        Simulation(hinged, step=5e-3)


def test_two_transporters_share_the_weight_of_one_body() -> None:
    """Side by side, two groups each: neither stands alone, together they do; each bogie carries a 24th."""
    shift = np.array([0.0, 3.0, 0.0])
    vehicles = [
        replace(
            vehicle(groups=groups_of(4)[::2] if side > 0 else groups_of(4)[1::2], bogie_mass=0.0),
            name=f"spmt_{side}",
        )
        for side in (1, -1)
    ]
    vehicles = [
        replace(one, groups=tuple(replace(g, bogies=g.bogies + side * shift) for g in one.groups))
        for one, side in zip(vehicles, (1, -1), strict=True)
    ]
    made = replace(scene(vehicles[0]), transporters=tuple(vehicles))
    run, _, found = histories(made, 5e-3, 1.0, 20)
    assert run.outcome is Outcome.COMPLETED
    for name in ("spmt_1", "spmt_-1"):
        np.testing.assert_allclose(found[f"{name}.wheel_load"], LOAD, rtol=1e-9)


def test_places_that_no_body_is_above_and_decks_that_bend_are_refused() -> None:
    """Each with its name."""
    groups = tuple(replace(group, bogies=1e3 * group.bogies) for group in groups_of(4))
    far = yard(stations=np.array([-1e4, 1e4]), sides=np.array([-1e4, 1e4]))
    with pytest.raises(InputError, match=r"of a bogie is \d+ m beside body 'block'.*units right"):
        Simulation(scene(vehicle(groups=groups), (far,), soft()), step=5e-3)
    barge = FlexibleBody("barge", cloud(3.0).reduced())
    with pytest.raises(InputError, match="it is on body 'barge', which deforms"):
        Simulation(scene(vehicle(), (yard(body="barge"),), bodies=(barge, block())), step=5e-3)


def test_places_and_loads_that_cannot_be_meant_are_refused() -> None:
    """Wheels drawn at the body instead of on the road; the load of a group, or of all bogies, as that of a bogie."""
    raised = block(position=np.array([0.0, 0.0, 1.49]))
    with pytest.raises(InputError, match=r"bogie 1 is 1\.49 m above deck 'yard', more than any stroke"):
        Simulation(scene(vehicle(), body=raised), step=5e-3)
    groups = tuple(replace(group, load=3.0 * LOAD) for group in groups_of(4))
    with pytest.raises(
        InputError, match=r"groups push with 5\.09\d+e\+06 N in all on a weight of 1\.69\d+e\+06 N"
    ):
        Simulation(scene(vehicle(groups=groups)), step=5e-3)


def test_a_wheel_that_leaves_the_road_is_told_with_the_deck_on_which_it_stood() -> None:
    """Of two, and the place on it."""
    decks = (
        yard(stations=np.array([-30.0, 4.0])),
        replace(yard(stations=np.array([40.0, 50.0])), name="far", origin=np.array([-3.0, 0.0, 0.0])),
    )
    run = Simulation(scene(vehicle(travel_speed=1.0), decks), step=5e-3)
    run.advance(400)
    assert run.outcome is Outcome.OFF_ROAD
    assert "bogie 1 has no deck below it, at station 4.005 m and offset 0.725 m of deck 'yard'" in run.message
