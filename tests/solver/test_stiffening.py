"""Bodies with modes that stiffen: frequencies in time, momenta, energy, bodies at rest, what ends a run."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from point_masses import channels_of
from solid_beams import BENDING, DENSITY, LENGTH, SIDE, beam, cantilever

from heavylift.modal.bases import eigenmode_basis
from heavylift.modal.eigen import eigenmodes
from heavylift.modal.flexibility import Flexibility
from heavylift.modal.reduced import ReducedBody
from heavylift.modal.reduction import reduce_body
from heavylift.modal.stress_stiffness import inertia_stiffening, stress_stiffness
from heavylift.numerics.outcome import InputError, Outcome
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.model import Material
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.ball import Ball
from heavylift.solver.scene.bodies import Driven, Fixed, Free, Profile, RigidBody
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

LINE = DENSITY * SIDE**2
FIRST = 1.8751040687119611**2 * np.sqrt(BENDING / LINE)
"""Lowest rate of a cantilever [rad/s]."""


def turning(spin: float) -> Driven:
    """A frame that turns about z for ever."""
    return Driven(axis=np.array([0.0, 0.0, 1.0]), angle=Profile((0.0, 10.0), speeds=(spin, spin)))


def rate(values: np.ndarray, step: float) -> float:
    """Of a vibration about a mean [rad/s], from its crossings."""
    values = values - values.mean()
    at = np.flatnonzero(np.diff(np.sign(values)) != 0)
    crossings = at + values[at] / (values[at] - values[at + 1])
    return float(np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0]) / step)


def lowest(reduced: ReducedBody, spin: float) -> tuple[float, float]:
    """Rates in the plane and across it [rad/s] that K, E and S say; a straight bar has no Coriolis forces."""
    assert reduced.stiffening is not None
    S = reduced.integrals.mode_mode
    K = np.diag(reduced.eigenvalues) + reduced.stiffening.of_spin(np.array([0.0, 0.0, spin]))
    within, across = np.sqrt(np.linalg.eigvalsh(K - spin**2 * (S[0, 0] + S[1, 1]))[:2])
    return float(within), float(across)


@pytest.mark.parametrize("integrator", ["dele2", "thesis"])
def test_a_blade_vibrates_in_time_as_its_matrices_say(integrator: str) -> None:
    """At half its first frequency, in the plane and across it."""
    reduced, step = cantilever(modes=6, stiffening=True), 1e-4
    spin = 0.5 * FIRST
    start = np.zeros(6)
    start[:2] = 1e-3
    body = beam(reduced, motion=turning(spin), modal_position=start)
    run = Simulation(Scene((body,), ()), step, record_every=4, integrator=integrator)
    _, records = run.advance(8000)
    first = next(c.column for c in run.channels if c.name == "beam.modal_position")
    q = records[:, first : first + 6]
    tip = reduced.shapes_at(*reduced.locate(np.array([LENGTH, 0.0, 0.0])))
    found = [rate(q @ tip[:, axis], 4 * step) for axis in (1, 2)]
    np.testing.assert_allclose(found, lowest(reduced, spin), rtol=1e-3)
    assert found[0] > FIRST * np.sqrt(1.0 + 0.19 * 0.25) * 0.995


@cache
def plate(*, stiffening: bool) -> ReducedBody:
    """A free square metre of soft sheet, 40 mm thick, of which six modes are kept."""
    mesh = mesh_blocks(
        [Box("plate", (-0.5, -0.5, -0.02), (0.5, 0.5, 0.02))],
        element_type="hex8",
        divisions={"x": [6], "y": [6], "z": [1]},
    )
    model = assemble(mesh, Material(2e9, 0.3, 1000.0))
    flexibility = Flexibility(model)
    basis = eigenmode_basis(eigenmodes(model, 6, flexibility=flexibility))
    reduced = reduce_body(model, basis.vectors, basis.labels, mean_axis=True)
    if stiffening:
        reduced = replace(
            reduced, stiffening=inertia_stiffening(flexibility, reduced, stress_stiffness(model))
        )
    return reduced


def tumbled(step: float, *, stiffening: bool) -> list[dict[str, np.ndarray]]:
    """Records of a plate that tumbles and vibrates for half a second."""
    body = beam(
        plate(stiffening=stiffening),
        motion=Free(),
        modal_position=0.1 * np.array([1.0, -0.7, 0.4, 0.3, 0.2, 0.1]),
        angular_velocity=np.array([20.0, 35.0, 25.0]),
        velocity=np.array([1.0, 2.0, 3.0]),
    )
    run = Simulation(Scene((body,), ()), step, record_every=10)
    first = run.record()
    _, records = run.advance(int(0.5 / step))
    return [channels_of(run, row) for row in (first, *records)]


def test_a_free_body_that_stiffens_keeps_momenta_and_energy() -> None:
    """Momenta to rounding, energy to the error of the step, which falls with its square."""
    drifts = []
    for step in (4e-4, 2e-4):
        rows = tumbled(step, stiffening=True)
        for name in ("momentum.linear", "momentum.angular"):
            drift = max(np.linalg.norm(row[name] - rows[0][name]) for row in rows)
            assert drift < 1e-10 * np.linalg.norm(rows[0][name])
        energy = np.array([row["energy.balance"][0] for row in rows])
        elastic = max(row["energy.elastic"][0] for row in rows)
        drifts.append(np.abs(energy - energy[0]).max() / elastic)
    assert drifts[1] < 1e-2
    assert drifts[1] < 0.35 * drifts[0]
    plain = tumbled(2e-4, stiffening=False)[-1]["beam.modal_position"]
    assert (
        np.abs(rows[-1]["beam.modal_position"] - plain).max() > 0.1 * np.abs(plain).max()
    )  # it does something


@pytest.mark.parametrize("motion", [Fixed(), Driven()])
def test_a_column_is_softer_under_its_weight_and_keeps_its_energy(motion: Fixed | Driven) -> None:
    """Greenhill's column at a third of its height: 7.8373 E I / rho A g L^3 = 3; the work of the weight is booked."""
    reduced = cantilever(modes=6, stiffening=True)
    gravity = 7.8373 * BENDING / (LINE * LENGTH**3) / 3.0
    start = np.zeros(6)
    start[:2] = 1e-3
    body = beam(reduced, motion=motion, modal_position=start)
    run = Simulation(Scene((body,), (Gravity(np.array([-gravity, 0.0, 0.0])),)), 1e-4, record_every=4)
    rows = [channels_of(run, run.record())]
    _, records = run.advance(8000)
    rows += [channels_of(run, row) for row in records]
    q = np.array([row["beam.modal_position"] for row in rows])
    # the load that buckles it takes all stiffness, and a third of it nearly a third of the square of the rate
    assert rate(q[:, 0], 4e-4) == pytest.approx(FIRST * np.sqrt(1.0 - 1.0 / 3.0), rel=5e-3)
    balance = np.array([row["energy.balance"][0] for row in rows])
    elastic = np.array([row["energy.elastic"][0] for row in rows])
    assert np.ptp(balance) < 1e-3 * np.ptp(elastic)


def test_equilibrium_knows_of_the_weight() -> None:
    """A column with a load across: its deflection grows by about 1 / (1 - g / g_c)."""
    critical = 7.8373 * BENDING / (LINE * LENGTH**3)
    found = []
    for stiffening in (False, True):
        reduced = cantilever(modes=6, stiffening=stiffening)
        down = np.array([-0.5 * critical, 0.0, -1e-3 * critical])
        run = Simulation(Scene((beam(reduced),), (Gravity(down),)), 1e-3, start="equilibrium")
        q = channels_of(run, run.record())["beam.modal_position"]
        found.append(q @ reduced.shapes_at(*reduced.locate(np.array([LENGTH, 0.0, 0.0])))[:, 2])
    assert found[1] / found[0] == pytest.approx(2.0, rel=0.02)


def test_only_modes_without_stiffening_are_ended_by_their_spin() -> None:
    """At three quarters of the first frequency; the message names the key."""
    for stiffening, outcome in ((False, Outcome.MODES_LEFT), (True, Outcome.COMPLETED)):
        body = beam(cantilever(modes=6, stiffening=stiffening), motion=turning(0.75 * FIRST))
        run = Simulation(Scene((body,), ()), 1e-4, record_every=10)
        run.advance(10)
        assert run.outcome is outcome
        assert ("'modes.stiffening'" in run.verdict[1]) == (outcome is Outcome.MODES_LEFT)


TIP = (LENGTH, 0.0, 0.0)
CRITICAL = np.pi**2 * BENDING / (4.0 * LENGTH**2)
"""Load along a cantilever that buckles it [N]."""


def pulled(force: float, way: str, step: float = 1e-4, **options: object) -> Simulation:
    """A cantilever with a force across its tip, and one along it that acts there itself or on a block in a joint."""
    reduced = cantilever(modes=6, points=(TIP,), stiffening=True)
    body = beam(reduced, damping_ratio=np.zeros(reduced.mode_count))
    tip, times = np.array(TIP), np.zeros(1)
    across = PointForce("across", "beam", tip, times, np.array([[0.0, 0.0, 0.1]]))
    gravity = Gravity(np.zeros(3))
    along = np.array([[force, 0.0, 0.0]])
    if way == "force":
        return Simulation(
            Scene((body,), (gravity, across, PointForce("p", "beam", tip, times, along))), step, **options
        )
    mass = 1e-3  # a light block at the tip, which the force acts on
    block = RigidBody("block", mass=mass, inertia=1e-6 * np.eye(3), position=tip)
    force_on = PointForce("p", "block", np.zeros(3), times, along)
    ball = Ball(
        name="ball",
        body_a="beam",
        body_b="block",
        frame_a=JointFrame(tip, np.eye(3)),
        frame_b=JointFrame(np.zeros(3), np.eye(3)),
    )
    return Simulation(Scene((body, block), (gravity, across, force_on), joints=(ball,)), step, **options)


@pytest.mark.parametrize("way", ["force", "joint"])
@pytest.mark.parametrize("share", [-0.5, 0.5])
def test_a_force_along_a_cantilever(way: str, share: float) -> None:
    """Euler: the stiffness against a load across is ``k (1 +- P/P_c)`` to a per cent, of pull and of thrust; in motion
    and at rest, for forces and for reactions of joints."""
    run = pulled(share * CRITICAL, way, start="equilibrium", record_every=4)
    first = next(c.column for c in run.channels if c.name == "beam.modal_position")
    reduced = cantilever(modes=6, points=(TIP,), stiffening=True)
    tip = reduced.shapes_at(*reduced.locate(np.array(TIP)))[:, 2]
    at_rest = run.record()[first : first + reduced.mode_count] @ tip
    kl = np.sqrt(abs(share)) * np.pi / 2.0
    slender = (np.tan(kl) - kl) / kl**3 if share < 0.0 else (kl - np.tanh(kl)) / kl**3
    assert at_rest == pytest.approx(0.1 * LENGTH**3 / BENDING * slender, rel=5e-3)
    _, records = run.advance(400)
    q = records[:, first : first + reduced.mode_count] @ tip
    assert np.abs(q - at_rest).max() < 2e-3 * abs(at_rest)


def test_a_force_at_another_place_is_refused() -> None:
    """With the point and the ways out; where the body is held it may act."""
    body = beam(cantilever(modes=6, points=(TIP,), stiffening=True))
    for x, word in ((0.5, r"\(500, 0, 0\) mm"), (0.0, "")):
        scene = Scene(
            (body,), (PointForce("p", "beam", np.array([x, 0.0, 0.0]), np.zeros(1), np.ones((1, 3))),)
        )
        if word:
            with pytest.raises(InputError, match=word) as caught:
                Simulation(scene, 1e-4)
            assert "static_points" in caught.value.expected
        else:
            Simulation(scene, 1e-4)


def test_loads_that_modes_do_not_tell_apart_are_refused() -> None:
    """Forces along a bar at two of its points, with modes that only bend."""
    reduced = cantilever(modes=4, points=(TIP,), stiffening=True)
    bare = replace(cantilever(modes=4), stiffening=None)
    assert reduced.stiffening is not None
    part = replace(
        reduced.stiffening,
        second_moments=reduced.stiffening.second_moments[:, :4, :4],
        angular=reduced.stiffening.angular[:, :4, :4],
        linear=reduced.stiffening.linear[:, :4, :4],
        loads=reduced.stiffening.loads[:, :4, :4],
        generalised=reduced.stiffening.generalised[:, :10],
    )
    with pytest.raises(InputError, match="tell apart"):
        Simulation(Scene((beam(replace(bare, stiffening=part)),), ()), 1e-4)


def test_a_step_too_long_for_the_stiffening_is_halved_and_no_step_ends_with_a_word() -> None:
    """``h^2 g < 4``: the change g is largest for the static vector of the load, whose shape is sharpest."""
    reduced = cantilever(modes=6, points=(TIP,), stiffening=True)
    assert reduced.stiffening is not None
    g = 0.5 * CRITICAL * np.linalg.norm(reduced.stiffening.loads[0], 2)
    step = 1.5 * 2.0 / np.sqrt(g)
    counts = []
    for factor in (0.5, 1.0):
        run = pulled(0.5 * CRITICAL, "force", factor * step)
        run.advance(20)
        assert run.outcome is Outcome.COMPLETED
        counts.append(run.solver_steps)
    assert counts == [20, 40]
    far = pulled(1e16, "force")
    far.advance(1)
    assert far.outcome is Outcome.NOT_CONVERGED
    assert "body 'beam': its stiffening by loads takes a shorter step" in far.message


def test_a_run_goes_on_from_its_state_bit_by_bit() -> None:
    """With what joints have pulled in the last steps."""
    whole, first = pulled(0.5 * CRITICAL, "joint"), pulled(0.5 * CRITICAL, "joint")
    whole.advance(40)
    first.advance(20)
    again = pulled(0.5 * CRITICAL, "joint")
    again.restore(first.state())
    again.advance(20)
    np.testing.assert_array_equal(again.record(), whole.record())
