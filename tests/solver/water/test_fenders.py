"""Fenders: one-sided, along a turning normal, in balance, conservative without damping."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    record_forces,
    watch_forces,
)
from heavylift.solver.joints.packing import MarkerBook
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.scene.sea import Sea, Water
from heavylift.solver.simulation import Simulation
from heavylift.solver.water.lines.fenders import Fender, Fenders, fender_markers, pack_fenders

TABLE = np.array([0.0, 0.2, 0.5]), np.array([0.0, 1e5, 1e6])


def evaluate(kinds: tuple[Any, ...], work: Workspace, row: np.ndarray, time: float) -> None:
    """Forces, then a record of them."""
    add_forces(kinds, time, work)
    record_forces(kinds, time, work, row)


def fender(**more: Any) -> Fender:
    given: dict[str, Any] = {"direction": np.array([0.0, 2.0, 0.0])}
    return Fender(
        name="fender",
        body_a="quay",
        point_a=np.zeros(3),
        body_b="barge",
        point_b=np.zeros(3),
        **(given | more),
    )


class Bench:
    """A kind whose markers (tip, normal, point that presses) are put where a test wants them."""

    def __init__(self, one: Fender) -> None:
        markers = fender_markers(MarkerBook(), [one])
        record = ChannelBook()
        self.kind: Fenders = pack_fenders([one], markers, [record.add("fender", one.CHANNELS)])
        self.work = Workspace.empty(0, 3)
        self.row = np.zeros(record.width)

    def at(self, *vectors: np.ndarray, rates: np.ndarray | None = None, time: float = 0.0) -> np.ndarray:
        """Forces [N] on the three markers, shape (3, 3)."""
        self.work.markers.view(float)[:] = 0.0
        self.work.sums.words[:] = 0.0
        self.work.markers["point"] = vectors
        if rates is not None:
            self.work.markers["velocity"] = rates
        evaluate((self.kind,), self.work, self.row, time)
        return self.work.markers["force"].copy()


Y = np.array([0.0, 1.0, 0.0])
TIP = np.array([3.0, 1.0, 2.0])


def test_pushes_only_what_presses() -> None:
    bench = Bench(fender(stiffness=2e5))
    assert np.all(bench.at(TIP, Y, TIP + np.array([5.0, 0.1, 1.0])) == 0.0)
    assert np.all(bench.kind.tangents == 0.0)
    forces = bench.at(TIP, Y, TIP + np.array([5.0, -0.1, 1.0]))
    assert forces[2] == pytest.approx([0.0, 2e4, 0.0])
    assert forces[0] == pytest.approx(-forces[2])
    assert bench.row == pytest.approx([2e4, 0.1, 2e4, 2e4])
    assert bench.kind.tangents.reshape(3, 3) == pytest.approx(2e5 * np.outer(Y, Y))


def test_forces_have_no_resultant_and_no_moment() -> None:
    """Also where b presses beside the tip: the direction carries the moment, which is n x (force on it)."""
    n = np.array([0.6, 0.0, 0.8])
    point = TIP + np.array([1.0, -2.0, -1.5])
    f = Bench(fender(stiffness=1e5, direction=n)).at(TIP, n, point)
    assert f[0] + f[2] == pytest.approx(np.zeros(3))
    moment = np.cross(TIP, f[0]) + np.cross(point, f[2]) + np.cross(n, f[1])
    assert moment == pytest.approx(np.zeros(3), abs=1e-9 * np.abs(f).max())
    assert f[2] == pytest.approx(1e5 * ((TIP - point) @ n) * n)


def test_table() -> None:
    bench = Bench(fender(compressions=TABLE[0], forces=TABLE[1]))
    for depth, force, slope in ((0.1, 5e4, 5e5), (0.35, 5.5e5, 3e6), (0.6, 1.3e6, 3e6)):
        assert bench.at(TIP, Y, TIP - depth * Y)[2, 1] == pytest.approx(force, rel=1e-12)
        assert bench.kind.tangents[0, 4] == pytest.approx(slope, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("law", [{"stiffness": 2e5}, {"compressions": TABLE[0], "forces": TABLE[1]}])
def test_energy_is_the_work_of_the_force(law: dict[str, Any]) -> None:
    """Along a way on which normal, tip and point all move, with its part without touch."""
    bench = Bench(fender(**law))

    def places(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        angle = 0.3 * t
        n = np.array([math.sin(angle), math.cos(angle), 0.0])
        return TIP + t * np.array([0.1, 0.2, 0.0]), n, TIP + np.array([0.5, 0.2 - 0.5 * t, 0.1 * t])

    times = np.linspace(0.0, 1.0, 8_001)
    bench.at(*places(0.0))
    assert bench.work.sums.elastic == 0.0
    work = 0.0
    before = np.array(places(0.0))
    for start, end in pairwise(times):
        after = np.array(places(end))
        work -= float(np.sum(bench.at(*places(0.5 * (start + end))) * (after - before)))
        before = after
    bench.at(*places(1.0))
    assert work > 100.0
    assert bench.work.sums.elastic == pytest.approx(work, rel=3e-5)
    assert bench.work.sums.external_work == pytest.approx(bench.work.sums.elastic, rel=1e-12)


def test_damping_never_pulls() -> None:
    """The damper adds c times the speed of compression, that of a turning normal too."""
    bench = Bench(fender(stiffness=2e5, damping=1e5))
    inwards = np.array([np.zeros(3), np.zeros(3), -0.05 * Y])
    assert bench.at(TIP, Y, TIP - 0.1 * Y, rates=inwards)[2, 1] == pytest.approx(2e4 + 5e3)
    assert bench.kind.rate_tangents[0, 4] == pytest.approx(1e5)
    assert bench.at(TIP, Y, TIP - 0.1 * Y, rates=-inwards)[2, 1] == pytest.approx(2e4 - 5e3)
    assert np.all(bench.at(TIP, Y, TIP - 0.1 * Y, rates=-8 * inwards) == 0.0)
    assert np.all(bench.at(TIP, Y, TIP + 0.1 * Y, rates=8 * inwards) == 0.0)
    turn = np.array([np.zeros(3), [0.1, 0.0, 0.0], np.zeros(3)])  # n leans over, towards a point at x = -0.5
    assert bench.at(TIP, Y, TIP + np.array([-0.5, -0.1, 0.0]), rates=turn)[2, 1] == pytest.approx(
        2e4 + 1e5 * 0.05
    )


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"direction": np.zeros(3), "stiffness": 1.0}, "fender: direction: direction .*outward normal"),
        ({}, "neither stiffness nor table"),
        ({"stiffness": 1.0, "compressions": TABLE[0], "forces": TABLE[1]}, "a stiffness and a table"),
        ({"stiffness": -1.0}, "stiffness is -1"),
        ({"stiffness": 1.0, "damping": -2.0}, "damping is -2"),
        ({"compressions": TABLE[0], "forces": TABLE[1][:2]}, "3 compressions and 2 forces"),
        ({"compressions": TABLE[0], "forces": TABLE[1][::-1]}, "from .0, 0., compressions increasing"),
    ],
)
def test_bad_fenders_are_refused(more: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Bench(fender(**more))


def test_forces_of_steps_between_records_are_kept() -> None:
    """Pressed by 0.1, 0.3 and 0.2 m in the middles of three steps, and by nothing at the record."""
    bench = Bench(fender(stiffness=1e6))
    vectors = np.zeros((3, 3))
    vectors[1] = (0.0, 1.0, 0.0)
    time = 0.0
    for interval, depths in ((1, (0.1, 0.3, 0.2)), (2, (0.05, 0.0))):
        bench.work.control.interval = interval
        for depth in depths:
            vectors[2] = (0.0, -depth, 0.0)
            time += 0.01
            bench.at(*vectors, time=time)
            watch_forces((bench.kind,), bench.work)
        vectors[2] = (0.0, 0.1, 0.0)
        for _ in range(2):  # who looks changes nothing
            bench.at(*vectors)
            np.testing.assert_allclose(bench.row[[0, 2]], [0.0, 1e6 * max(depths)], rtol=1e-14)
            assert bench.row[3] == 0.0


def test_a_damper_records_the_rate_of_its_steps() -> None:
    """Pressed ever faster, 0.02 m/s a step, by a body whose end velocity rings by 0.5 m/s with every step."""
    bench = Bench(fender(stiffness=1e6, damping=1e5))
    place = TIP - 0.2 * Y
    rates, step = np.zeros((3, 3)), 0.01
    for n in range(6):
        middle, ring = 0.4 + 0.02 * n, 0.5 * (-1) ** n
        rates[2] = -middle * Y
        bench.at(TIP, Y, place, rates=rates, time=(n + 0.5) * step)
        watch_forces((bench.kind,), bench.work)
        rates[2] = -(middle + 0.01 + ring) * Y
        bench.work.markers["velocity"] = rates
        record_forces((bench.kind,), (n + 1) * step, bench.work, bench.row)
        if n > 0:  # a velocity that has jumped against its growth counts as that of the middle
            expected = middle + (0.01 if ring > 0.0 else 0.0)
            assert bench.row[0] == pytest.approx(0.2 * 1e6 + 1e5 * expected, rel=1e-12)


@pytest.mark.parametrize(("step", "told"), [(1e-3, False), (0.1, True), (0.25, True)])
def test_a_blow_that_the_step_does_not_resolve_is_told(step: float, told: bool) -> None:
    """10 t at 1 m/s on 2 MN/m: a period of 0.44 s; its work is that of an outer force, so the balance tells nothing."""
    hits = RigidBody(
        "boat", 1e4, 1e4 * np.eye(3), position=np.array([2.13, 0.0, 0.0]), velocity=np.array([-1.0, 0.0, 0.0])
    )
    bumper = Fender(
        name="bumper",
        body_a="ground",
        point_a=np.zeros(3),
        body_b="boat",
        point_b=np.zeros(3),
        direction=np.array([1.0, 0.0, 0.0]),
        stiffness=2e6,
    )
    simulation = Simulation(Scene(bodies=(hits,), sea=Sea(water=Water(), fenders=(bumper,))), step)
    simulation.advance(round(4.0 / step))
    assert ("taken up within a few steps by 'bumper'" in simulation.warning) == told
