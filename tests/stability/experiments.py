"""What is done to mechanisms to see whether the solver breaks, and what must come out.

Every experiment yields rows: a setting, what was measured, and the largest value that is right. Where a
setting asks for the impossible, a run that stops by itself and names the part is right too; its row says so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from mechanisms import (
    STANDARD_GRAVITY,
    bricard,
    chain,
    chain_tip,
    dropped_load,
    four_bar_tip,
    four_bars,
    hanging_load,
    hanging_load_path,
    hinge,
    moved,
    rod,
)

from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import quaternion_from_rotation_vector, rotation_matrix
from heavylift.solver.scene.connections import Limits
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["EXPERIMENTS", "Row"]


@dataclass(frozen=True)
class Row:
    """One number of an experiment.

    Attributes
    ----------
    setting, measure
        What was set and what was measured.
    value, limit
        Measured, and the largest that is right.
    stopped, may_stop
        Message of a run that stopped by itself, empty otherwise; whether it may.
    """

    setting: str
    measure: str
    value: float
    limit: float
    stopped: str = ""
    may_stop: bool = False

    @property
    def right(self) -> bool:
        """Within the limit, or stopped where that is allowed."""
        return self.value <= self.limit if not self.stopped else self.may_stop


@dataclass(frozen=True, eq=False)
class Run:
    """Histories of a simulation at its records."""

    simulation: Simulation
    times: np.ndarray
    records: np.ndarray

    def __getitem__(self, channel: str) -> np.ndarray:
        found = next(c for c in self.simulation.channels if c.name == channel)
        return self.records[:, found.column : found.column + len(found.components)]

    @property
    def growth(self) -> float:
        """Largest gain of the energy balance relative to the largest kinetic energy."""
        balance = self["energy.balance"][:, 0]
        return float((balance - balance[0]).max() / max(self["energy.kinetic"].max(), 1e-300))

    @property
    def violation(self) -> float:
        """Largest violation of a joint [m, rad]."""
        return float(self["monitor.violation"].max())


def run(scene: Scene, step: float, duration: float, records: int = 100, softness: float = 1.0) -> Run:
    """Simulate with fixed steps; `softness` multiplies the regularisation of rigid rows."""
    count = max(1, round(duration / step))
    simulation = Simulation(scene, step, record_every=max(1, count // records))
    if softness != 1.0:
        system = simulation._layout.systems[0]
        system.rows["hold"] *= softness
    first = simulation.record()
    times, rows = simulation.advance(count)
    return Run(simulation, np.r_[0.0, times], np.vstack([first, rows]))


def deviation(result: Run, expected: np.ndarray) -> float:
    """Largest distance of the tip from where it should be [m]."""
    tip = result["tip.position"][:, : expected.shape[1]]
    return float(np.linalg.norm(tip - expected, axis=1).max())


def completed(result: Run) -> str:
    """Empty, or why the run stopped."""
    return "" if result.simulation.outcome is Outcome.COMPLETED else result.simulation.message


def mass_ratios() -> Iterator[Row]:
    """A rod of 1 kg and one of 1e-6 kg or 1e6 kg in a pendulum, either way round: against a plain ODE."""
    for masses in ((1.0, 1e-6), (1e-6, 1.0), (1.0, 1e6), (1e6, 1.0)):
        result = run(chain(masses), 1e-3, 1.0)
        error = deviation(result, chain_tip(masses, result.times)) if not completed(result) else np.inf
        setting = f"{masses[0]:g} kg above {masses[1]:g} kg, 1 ms"
        yield Row(setting, "position error [m]", error, 1e-3, completed(result))
        yield Row(setting, "energy gain, relative", result.growth, 1e-4)


def singular_positions() -> Iterator[Row]:
    """Four-bar loops through ten singular positions, with steps far too long as well."""
    # second order from 2.5e-2 m at 10 ms, a phase error through the upright position
    limits = {0.02: 0.4, 0.01: 4e-2, 0.005: 6e-3, 0.002: 6e-4, 0.001: 1.2e-4}
    for loops in (1, 2):
        for step, limit in limits.items():
            result = run(four_bars(loops), step, 10.0)
            expected = four_bar_tip(loops, result.times)
            error = deviation(result, expected) if not completed(result) else np.inf
            setting = f"{loops} loop(s), {step * 1e3:g} ms"
            yield Row(setting, "position error [m]", error, limit, completed(result))
            yield Row(setting, "violation [m]", result.violation, max(2e-5 * (step / 0.01) ** 3, 1e-9))
        for step, limit in ((0.1, 0.5), (0.05, 0.1)):  # half a radian a step and more
            result = run(four_bars(loops), step, 10.0)
            setting = f"{loops} loop(s), {step * 1e3:g} ms"
            yield Row(
                setting, "energy gain, relative", result.growth, limit, completed(result), may_stop=True
            )
            yield Row(setting, "violation [m]", result.violation, 2e-5 * (step / 0.01) ** 3)


def overconstrained_loops() -> Iterator[Row]:
    """Bricard's mechanism with the regularisation over six decades: differences from the default."""
    reference = run(bricard(), 1e-3, 10.0)
    for power in range(-3, 4):
        result = run(bricard(), 5e-3, 10.0, softness=10.0**power)
        error = float(np.abs(result["tip.position"] - reference["tip.position"]).max())
        # softer rows share forces, harder ones begin to lock: 4e-4 m and less of the default at 1e-10
        yield Row(
            f"regularisation 1e{power - 7:d}, 5 ms", "position error [m]", error, 2e-3, completed(result)
        )


def duplicate_joints() -> Iterator[Row]:
    """The hinge of a pendulum once, twice and five times: the same motion, and the same total reaction."""
    scene = chain((1.0,))
    single = run(scene, 1e-3, 2.0)
    force = single["hinge 0.reaction_force"]
    for count in (2, 5):
        copies = tuple(replace(scene.joints[0], name=f"hinge {i}") for i in range(count))
        result = run(replace(scene, joints=copies), 1e-3, 2.0)
        total = sum(result[f"hinge {i}.reaction_force"] for i in range(count))
        setting = f"{count} equal hinges"
        error = float(np.abs(result["tip.position"] - single["tip.position"]).max())
        yield Row(setting, "position difference [m]", error, 1e-7, completed(result))
        yield Row(
            setting, "difference of total reaction, relative", float(np.abs(total - force).max()) / 9.81, 1e-5
        )


def gimbal_pose() -> Iterator[Row]:
    """A rotor in two rings whose outer and rotor axes start parallel: the lock of a gimbal, a singular position."""
    outer, inner, rotor = (
        rod(name, (-0.5 * size, 0, 0), (0.5 * size, 0, 0), mass, width=0.5 * size)
        for name, size, mass in (("outer ring", 1.2, 0.2), ("inner ring", 1.0, 0.2), ("rotor", 0.8, 5.0))
    )
    spins = {"outer ring": (0.0, 0.0, 0.3), "inner ring": (0.5, 0.0, 0.3), "rotor": (0.5, 0.0, 8.3)}
    bodies = tuple(
        replace(body, angular_velocity=np.array(spins[body.name])) for body in (outer, inner, rotor)
    )
    outer, inner, rotor = bodies
    at = np.zeros(3)
    joints = (
        hinge("outer", None, outer, at),
        hinge("middle", outer, inner, at, (1, 0, 0)),
        hinge("spin", inner, rotor, at),
    )
    for step, limit in ((2e-3, 4e-4), (1e-3, 1e-4)):
        result = run(Scene(bodies, (), (), joints), step, 5.0)
        about_axis = result["momentum.angular"][:, 2]  # of the frictionless outer hinge
        change = float(np.ptp(about_axis) / abs(about_axis[0]))
        setting = f"{step * 1e3:g} ms"
        yield Row(
            setting, "change of the momentum about the axis, relative", change, limit, completed(result)
        )
        yield Row(setting, "energy gain, relative", result.growth, limit)


def step_sizes() -> Iterator[Row]:
    """A double pendulum for a thousand steps of 1 ns to 1 s, at most one second: later it is chaotic."""
    masses = (1.0, 1.0)
    for power in range(-9, 1):
        step = 10.0**power
        result = run(chain(masses), step, min(1000 * step, max(1.0, step)))
        stopped = completed(result)
        error = np.inf
        if not stopped:
            error = deviation(result, chain_tip(masses, result.times))
        coarse = step > 0.05  # a radian a step
        yield Row(
            f"{step:g} s", "position error [m]", error, max(1e-9, 40.0 * step**2), stopped, may_stop=coarse
        )


def moved_scenes() -> Iterator[Row]:
    """A scene 1 km away and turned by 30 degrees about a skew axis: the same motion."""
    axis = np.array([1.0, 2.0, -0.5])
    quaternion = quaternion_from_rotation_vector(np.deg2rad(30.0) * axis / np.linalg.norm(axis))
    shift = np.array([600.0, -700.0, 400.0])
    for name, scene in (("chain of 5", chain((1.0,) * 5)), ("Bricard", bricard())):
        here, there = run(scene, 2e-3, 2.0), run(moved(scene, shift, quaternion), 2e-3, 2.0)
        back = (there["tip.position"] - shift) @ rotation_matrix(quaternion)
        error = float(np.abs(back - here["tip.position"]).max())
        yield Row(name, "position difference [m]", error, 1e-7, completed(there))


def reordered_scenes() -> Iterator[Row]:
    """Bodies and joints in another order, sides of joints exchanged: the same motion."""
    rng = np.random.default_rng(0)
    for name, scene in (("chain of 5", chain((1.0,) * 5)), ("Bricard", bricard())):
        joints = [scene.joints[i] for i in rng.permutation(len(scene.joints))]
        bodies = [scene.bodies[i] for i in rng.permutation(len(scene.bodies))]
        other = replace(scene, bodies=tuple(bodies), joints=tuple(joints))
        here, there = run(scene, 2e-3, 2.0), run(other, 2e-3, 2.0)
        error = float(np.abs(there["tip.position"] - here["tip.position"]).max())
        yield Row(name, "position difference [m]", error, 1e-9, completed(there))


def rope_stiffness() -> Iterator[Row]:
    """A load of 1 kg swinging on 10 m of rope from 30 degrees, EA over nine decades, 5 ms, 5 s: against an ODE."""
    mass, length = 1.0, 10.0
    for power in range(3, 13):
        stiffness = 10.0**power
        scene, start = hanging_load(mass, length, stiffness, np.deg2rad(30.0))
        result = run(scene, 5e-3, 5.0)
        error = deviation(result, hanging_load_path(mass, length, stiffness, start, result.times))
        tension = result["rope.tension"]
        setting = f"EA = 1e{power} N"
        yield Row(setting, "position error [m]", error, 2e-3, completed(result))
        yield Row(setting, "energy gain, relative", result.growth, 1e-5)
        yield Row(setting, "largest tension / weight", float(tension.max()) / (mass * STANDARD_GRAVITY), 1.35)


def slack_and_taut() -> Iterator[Row]:
    """A load of 10 t dropped 2 m into a rope of 1 MN/m again and again, 100 times taut, 2 ms."""
    drop, stiffness, mass = 2.0, 1e6, 1e4
    scene = dropped_load(mass, stiffness, drop)
    result = run(scene, 2e-3, 190.0, records=19000)
    taut = result["rope.tension"][:, 0] > 0.0
    bounces = int(np.count_nonzero(taut[1:] & ~taut[:-1]))
    height = float(np.abs(result["load.position"][:, 1].max()))
    yield Row("190 s", "times taut, less than 100", max(0, 100 - bounces), 0, completed(result))
    yield Row("190 s", "energy gain, relative", result.growth, 1e-9)
    yield Row("190 s", "rise above the start [m]", height, 1e-6)


def linked_stops() -> Iterator[Row]:
    """A chain of six links whose hinges run into stops: the energy that unresolved impacts make."""
    for step, limit in ((5e-4, 5e-2), (2.5e-4, 1e-2)):
        scene = chain((1.0,) * 6)
        stops = Limits(-0.5, 0.5, stiffness=1e5, damping=200.0)
        joints = (scene.joints[0], *(replace(joint, limits=stops) for joint in scene.joints[1:]))
        result = run(replace(scene, joints=joints), step, 3.0)
        yield Row(f"{step * 1e3:g} ms", "energy gain, relative", result.growth, limit, completed(result))


EXPERIMENTS: dict[str, Callable[[], Iterator[Row]]] = {
    "mass ratios": mass_ratios,
    "singular positions": singular_positions,
    "overconstrained loops": overconstrained_loops,
    "duplicate joints": duplicate_joints,
    "gimbal pose": gimbal_pose,
    "step sizes": step_sizes,
    "moved scenes": moved_scenes,
    "reordered scenes": reordered_scenes,
    "rope stiffness": rope_stiffness,
    "slack and taut": slack_and_taut,
    "linked stops": linked_stops,
}
"""By name, in the order of the report."""
