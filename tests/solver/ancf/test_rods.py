"""Rods: frames with torsion and rotary inertia, against closed forms, published bends, and conservation."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.bodies.ancf.rod_data import ROD_STRAINS, STRAIN_LENGTH, STRAINS, rod_data, strain_at
from heavylift.solver.bodies.ancf.rod_packing import element_data, start_coordinates
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.scene.bodies import RigidBody
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.meshes import DistributedLoad, FollowerLoad, FrameSection, RodBody, Support
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

CLAMPED = {"position": "xyz", "tangent": "xyz", "normal": "xyz", "binormal": "xyz"}
LENGTH, DIAMETER = 1.0, 0.02
YOUNG, SHEAR, DENSITY = 210e9, 80e9, 7850.0
AREA, SECOND = np.pi * DIAMETER**2 / 4.0, np.pi * DIAMETER**4 / 64.0
STEEL = FrameSection(DENSITY, YOUNG, AREA, SECOND, 0.5 * DIAMETER, 2.0 * SHEAR * SECOND)
SPEED = np.sqrt(SHEAR / DENSITY)
"""Of waves of torsion [m/s]."""


def rod(
    n: int = 8, *, twist: float = 0.0, clamped: bool = True, section: FrameSection = STEEL, **more
) -> RodBody:
    """One metre of a round bar along x, its first director along y, twisted by an angle in the given shape."""
    x = np.linspace(0.0, LENGTH, n + 1)
    zero = np.zeros(n + 1)
    return RodBody(
        name="rod",
        nodes=np.column_stack([x, zero, zero]),
        tangents=np.tile([1.0, 0.0, 0.0], (n + 1, 1)),
        normals=np.column_stack([zero, np.cos(twist * x), np.sin(twist * x)]),
        elements=np.column_stack([np.arange(n), np.arange(1, n + 1)]),
        sections=(section,),
        supports=(Support(np.array([0]), CLAMPED),) if clamped else (),
        **more,
    )


def arc(n: int, radius: float, angle: float, section: FrameSection) -> RodBody:
    """In the plane z = 0 from the origin along x, clamped there."""
    a = np.linspace(0.0, angle, n + 1)
    zero = np.zeros(n + 1)
    return RodBody(
        name="rod",
        nodes=radius * np.column_stack([np.sin(a), 1.0 - np.cos(a), zero]),
        tangents=np.column_stack([np.cos(a), np.sin(a), zero]),
        normals=np.tile([0.0, 0.0, 1.0], (n + 1, 1)),
        elements=np.column_stack([np.arange(n), np.arange(1, n + 1)]),
        sections=(section,),
        supports=(Support(np.array([0]), CLAMPED),),
    )


def column(run: Simulation, name: str) -> int:
    """First column of a channel."""
    return next(channel.column for channel in run.channels if channel.name == name)


def tip_at_rest(body: RodBody, force: list[float]) -> np.ndarray:
    """Displacement of the last node under a force there [m]."""
    load = PointForce("load", "rod", body.nodes[-1], np.zeros(1), np.array([force]))
    run = Simulation(Scene((body,), (load,)), 1e-3, start="equilibrium")
    at = column(run, "rod.position") + 3 * (len(body.nodes) - 1)
    return run.record()[at : at + 3] - body.nodes[-1]


def test_a_quarter_of_a_ring_bends_out_of_its_plane() -> None:
    """Castigliano: ``P R^3 (pi/4 / E I + (3 pi/4 - 2) / G J)``; errors fall with the square of the element."""
    side, E, G = 0.02, 1e7, 5e6
    section = FrameSection(1000.0, E, side**2, side**4 / 12.0, 0.5 * side, G * 0.1406 * side**4)
    load = 1e-6
    exact = load * (
        0.25 * np.pi / (E * section.second_moment) + (0.75 * np.pi - 2.0) / section.torsional_stiffness
    )
    errors = [
        tip_at_rest(arc(n, 1.0, 0.5 * np.pi, section), [0, 0, load])[2] / exact - 1.0 for n in (4, 8, 16)
    ]
    assert abs(errors[2]) < 3e-3
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(4.0, rel=0.05)


def test_an_eighth_of_a_ring_bends_far_out_of_its_plane() -> None:
    """Bathe and Bolourchi's bend: Simo and Vu-Quoc (1986) move the tip by (-23.48, -13.50, 53.37)."""
    section = FrameSection(1000.0, 1e7, 1.0, 1.0 / 12.0, 0.5, 5e6 / 6.0)
    coarse, fine = (tip_at_rest(arc(n, 100.0, 0.25 * np.pi, section), [0, 0, 600.0]) for n in (8, 16))
    moved = (4.0 * fine - coarse) / 3.0
    np.testing.assert_allclose(moved, [-23.48, -13.50, 53.37], atol=0.15)


def torsional_frequencies(n: int, **options) -> np.ndarray:
    """Of small turns about its axis [Hz], from the matrices of its elements: nothing else moves."""
    body = rod(n, **options)
    start = start_coordinates(body)
    K, M = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    turn = np.zeros_like(start)  # e_x x d, e_x x e
    turn[:, 2:] = np.cross([1.0, 0.0, 0.0], start[:, 2:])
    for data, (i, j) in zip(element_data(body), body.elements, strict=True):
        x, mass = start[[i, j]].reshape(8, 3), rod_data(data, 0).mass
        unit = np.zeros((2, 8, 3))
        unit[0, :4], unit[1, 4:] = turn[i], turn[j]
        M[np.ix_([i, j], [i, j])] += np.einsum("pak,ab,qbk->pq", unit, mass, unit)
        for number in range(ROD_STRAINS):
            one = strain_at(data, STRAINS + number * STRAIN_LENGTH)
            g = np.einsum("pak,ab,bk->p", unit, one.products, x)
            K[np.ix_([i, j], [i, j])] += one.stiffness * np.outer(g, g)
    held = slice(1, None) if body.supports else slice(None)
    values = eigh(K[held, held], M[held, held], eigvals_only=True)
    return np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi)


@pytest.mark.parametrize("twist", [0.0, 2.0])
def test_torsional_frequencies_of_a_clamped_bar(twist: float) -> None:
    """``(2 k - 1) c / 4 L``, whatever its twist in the given shape; linear elements, second order."""
    exact = 0.25 * SPEED / LENGTH * np.array([1.0, 3.0, 5.0])
    errors = [torsional_frequencies(n, twist=twist)[:3] / exact - 1.0 for n in (16, 32)]
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)
    assert abs(errors[1][0]) < 1e-3
    free = torsional_frequencies(32, clamped=False)
    assert free[0] < 1e-3 * free[1]
    assert free[1] == pytest.approx(0.5 * SPEED / LENGTH, rel=1e-3)


def lowest_rate(n: int, torque: float) -> float:
    """Lowest eigenvalue of the tangent stiffness, with a unit diagonal, of a straight rod twisted between clamps.

    The second clamp slides along the axis.
    """
    body = rod(n)
    angle = torque * LENGTH / STEEL.torsional_stiffness
    angles = np.linspace(0.0, angle, n + 1)
    start, q = start_coordinates(body), start_coordinates(body)
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    q[:, 2], q[:, 3] = c * start[:, 2] + s * start[:, 3], c * start[:, 3] - s * start[:, 2]
    last = 12 * n + np.arange(12)
    free = np.setdiff1d(np.arange(q.size), [*range(12), *last[1:3], *last[3:]])
    for _ in range(3):  # sections shrink by what the twist pulls at them
        force, K = tangent(body, q)
        q.ravel()[free] -= np.linalg.solve(K[np.ix_(free, free)], force[free])
    _, K = tangent(body, q)
    scale = 1.0 / np.sqrt(np.diag(K)[free])
    return float(np.linalg.eigvalsh(K[np.ix_(free, free)] * np.outer(scale, scale))[0])


def tangent(body: RodBody, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces and stiffness of a rod at some coordinates (n, 4, 3), from the constants of its elements."""
    force, K = np.zeros(q.size), np.zeros((q.size, q.size))
    for data, (i, j) in zip(element_data(body), body.elements, strict=True):
        own = np.concatenate([12 * i + np.arange(12), 12 * j + np.arange(12)])
        v = q[[i, j]].reshape(8, 3)
        for number in range(ROD_STRAINS):
            one = strain_at(data, STRAINS + number * STRAIN_LENGTH)
            g = (one.products @ v).ravel()
            strain = sum((u @ v) @ (w @ v) for u, w in zip(one.left, one.right, strict=True)) - one.rest
            force[own] += one.stiffness * strain * g
            K[np.ix_(own, own)] += one.stiffness * (
                np.outer(g, g) + strain * np.kron(one.products, np.eye(3))
            )
    return force, K


def test_a_twisted_shaft_buckles() -> None:
    """Greenhill (1883): between clamps at ``T L / E I = 2 x 4.4934``, where ``tan x = x``; second order."""
    exact = 2.0 * brentq(lambda x: np.tan(x) - x, 4.4, 4.6) * YOUNG * SECOND / LENGTH
    errors = []
    for n in (20, 40):
        critical = brentq(lambda torque, n=n: lowest_rate(n, torque), 0.9 * exact, 1.1 * exact, rtol=1e-6)
        errors.append(critical / exact - 1.0)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)
    assert abs(4.0 * errors[1] - errors[0]) / 3.0 < 5e-3


@cache
def disc(torque: float, *, start: str = "check", inertia: float = 1e-3, step: float = 2e-5) -> Simulation:
    """A rod that is clamped at one end and welded to a disc at the other, with a couple on the disc."""
    body = rod(10)
    end = np.array([LENGTH, 0.0, 0.0])
    wheel = RigidBody("disc", mass=1.0, inertia=inertia * np.eye(3), position=end)
    weld = FixedJoint(
        name="weld",
        body_a="rod",
        body_b="disc",
        frame_a=JointFrame(end, np.eye(3)),
        frame_b=JointFrame(np.zeros(3), np.eye(3)),
    )
    arms = [
        PointForce(
            f"f{k}",
            "disc",
            np.array([0.0, s * 0.1, 0.0]),
            np.zeros(1),
            np.array([[0.0, 0.0, 5.0 * s * torque]]),
        )
        for k, s in enumerate((1.0, -1.0))
    ]
    return Simulation(Scene((body, wheel), tuple(arms), joints=(weld,)), step, record_every=10, start=start)


def test_a_joint_passes_a_torque() -> None:
    """``T L / G J`` at rest, torque T in all elements; forces that turn with nothing lose the cosine of the angle."""
    torque = 20.0
    run = disc(torque, start="equilibrium")
    record = run.record()
    at = column(run, "rod.twisting_moment")
    angle = torque * LENGTH / STEEL.torsional_stiffness
    first = column(run, "disc.orientation")
    turned = 2.0 * np.arctan2(record[first + 1], record[first])
    assert turned == pytest.approx(angle, rel=5e-4)
    np.testing.assert_allclose(record[at : at + 10], torque * np.cos(turned), rtol=1e-5)


def test_a_disc_on_a_rod_swings() -> None:
    """``b tan b = rho J L / Theta``, ``f = b c / 2 pi L``; the wheel is fixed to the rod, not to its axis."""
    inertia = 1e-3
    own = DENSITY * 2.0 * SECOND * LENGTH
    b = brentq(lambda b: b * np.tan(b) - own / inertia, 0.0, 1.5)
    run = disc(5.0, inertia=inertia)
    _, records = run.advance(4000)
    first = column(run, "disc.orientation")
    angle = 2.0 * np.arctan2(records[:, first + 1], records[:, first])
    centred = angle - 0.5 * (angle.max() + angle.min())
    ups = np.flatnonzero((centred[:-1] < 0.0) & (centred[1:] >= 0.0))
    crossings = 2e-4 * (ups - centred[ups] / (centred[ups + 1] - centred[ups]))
    found = (len(crossings) - 1) / (crossings[-1] - crossings[0])
    assert found == pytest.approx(b * SPEED / (2.0 * np.pi * LENGTH), rel=2e-3)
    assert run.outcome is Outcome.COMPLETED


@pytest.mark.parametrize("elasticity", ["energy-momentum", "carried"])
def test_a_free_rod_keeps_momenta_and_energy(elasticity: str) -> None:
    """Bent, twisted by what spins, and turning: both momenta to rounding where it iterates."""
    soft = FrameSection(1000.0, 1e8, 1e-3, 1e-7, 0.02, 6e0)
    body = rod(
        6,
        clamped=False,
        section=soft,
        elasticity=elasticity,
        angular_velocity=np.array([40.0, 3.0, 8.0]),
        velocity=np.array([1.0, 0.0, 2.0]),
        twist=0.5,
    )
    kick = PointForce(
        "kick",
        "rod",
        body.nodes[-1],
        np.array([0.0, 0.02, 0.0201]),
        np.array([[0, 30.0, 20.0], [0, 30.0, 20.0], [0, 0, 0]]),
    )
    run = Simulation(Scene((body,), (kick,)), 5e-4, record_every=4)
    run.advance(44)  # the force has ended
    first = run.record()
    _, records = run.advance(1000)
    for name in ("momentum.linear", "momentum.angular"):
        at = column(run, name)
        drift = np.abs(records[:, at : at + 3] - first[at : at + 3]).max()
        limit = 1e-9 if elasticity == "energy-momentum" else 2e-3
        assert drift < limit * np.linalg.norm(first[at : at + 3])
    at, kinetic = column(run, "energy.balance"), column(run, "energy.elastic")
    drift = np.ptp(records[:, at])
    assert drift < (1e-7 if elasticity == "energy-momentum" else 1e-6) * abs(first[at])
    assert np.ptp(records[:, kinetic]) > 1e-3 * abs(first[at])


def test_what_a_rod_is_not_given() -> None:
    """Normals, torsional stiffness, models, loads and twists, each with its key."""
    good = rod(2)
    wrong = {
        "normals[1]": {"normals": good.normals * np.array([[1.0], [2.0], [1.0]])},
        "normals[0]": {"normals": good.tangents},
        "sections[0].torsional_stiffness": {"sections": (FrameSection(DENSITY, YOUNG, AREA, SECOND),)},
        "model": {"model": "exact"},
        "elasticity": {"elasticity": "explicit"},
        "loads[0]": {"loads": (FollowerLoad(normal=1.0),)},
    }
    for key, change in wrong.items():
        with pytest.raises(InputError) as caught:
            Simulation(Scene((replace(good, **change),), ()), 1e-3)
        assert caught.value.key == key
    with pytest.raises(InputError, match=r"twisted by 57\.3 deg"):
        Simulation(Scene((rod(2, twist=2.0),), ()), 1e-3)
    Simulation(Scene((replace(good, loads=(DistributedLoad(np.array([0.0, 0.0, -1.0])),)),), ()), 1e-3)


def test_a_run_goes_on_from_its_state_bit_by_bit() -> None:
    """Carried strains, those of torsion too."""
    runs = [Simulation(_swinging(), 2e-5) for _ in range(3)]
    runs[0].advance(20)
    runs[1].advance(10)
    runs[2].restore(runs[1].state())
    runs[2].advance(10)
    np.testing.assert_array_equal(runs[2].record(), runs[0].record())


def _swinging() -> Scene:
    """A clamped rod that begins to turn."""
    return Scene((rod(4, angular_velocity=np.array([10.0, 0.0, 0.0])),), ())
