"""What is done to frames and shells to see whether they break, and what must come out: see `experiments`.

The stated accuracy of a run that was neither stopped nor warned of: its energy balance stays within `SILENT` of the
largest kinetic and elastic energy, whatever the step. A warning or a stop names the body.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from experiments import Row, Run, completed, run
from random_meshes import random_frame, random_linkage, random_shell

from heavylift.numerics.outcome import Outcome
from heavylift.solver.scene.mesh_shapes import line, rectangle
from heavylift.solver.scene.meshes import FrameBody, FrameSection, MeshBody, ShellBody, ShellSection, Support
from heavylift.solver.scene.scene import Gravity, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from random_meshes import Trial

__all__ = ["MESH_EXPERIMENTS", "random_scenes"]

SILENT = 0.02
"""Change of the energy balance, relative to the energy in motion, that may pass without a word."""

QUADRATIC = 1e-6
"""The same where strains are quadratic in the coordinates, or carried: nothing but rounding, in 1e5 steps."""

SCHEMES = ("carried", "energy-momentum", "auto", "explicit")


def with_scheme(scene: Scene, elasticity: str) -> Scene:
    """The same scene with all meshes stepped in one way."""
    bodies = (
        replace(body, elasticity=elasticity) if isinstance(body, MeshBody) else body for body in scene.bodies
    )
    return replace(scene, bodies=tuple(bodies))


def simulated(scene: Scene, step: float, steps: int) -> tuple[Simulation, np.ndarray, np.ndarray]:
    """A simulation after its steps, its first record and 200 more."""
    simulation = Simulation(scene, step, record_every=max(1, steps // 200))
    first = simulation.record()
    return simulation, first, simulation.advance(steps)[1]


def meshes(scene: Scene) -> list[MeshBody]:
    """Frames and shells of a scene."""
    return [body for body in scene.bodies if isinstance(body, MeshBody)]


@dataclass
class Tally:
    """What became of a number of random scenes.

    Attributes
    ----------
    count, stopped, warned
        Scenes, those that stopped by themselves, those that completed with a warning.
    worst
        Largest relative change of the energy balance of those that did neither.
    wrong
        What is wrong beyond that, as words.
    """

    count: int = 0
    stopped: int = 0
    warned: int = 0
    worst: float = 0.0
    wrong: list[str] = field(default_factory=list)

    def add(self, trial: Trial, scheme: str, steps: int, name: str) -> None:
        """Run a scene and look at all that it says."""
        scene = with_scheme(trial.scene, scheme)
        simulation, first, rows = simulated(scene, trial.step, steps)
        advised = re.search(r"try a step below (\S+) s", simulation.message)
        if (
            advised and simulation.step_index == 0
        ):  # explicit forces: what is advised must be good for all steps
            trial = replace(trial, step=0.95 * float(advised[1]))
            simulation, first, rows = simulated(scene, trial.step, steps)
        result = Run(simulation, np.zeros(len(rows) + 1), np.vstack([first, rows]))
        self.count += 1
        if not np.all(np.isfinite(result.records)):
            self.wrong.append(f"{name}: a record is not finite")
        if simulation.outcome is not Outcome.COMPLETED:
            self.stopped += 1
            named = any(f"body '{body.name}'" in simulation.message for body in trial.scene.bodies)
            of_mesh = any(f"body '{body.name}'" in simulation.message for body in meshes(trial.scene))
            if not (named or "joint '" in simulation.message) or "at t = " not in simulation.message:
                self.wrong.append(f"{name}: {simulation.message}")
            elif of_mesh and ", element " not in simulation.message:
                self.wrong.append(f"{name} names no element: {simulation.message}")
        elif simulation.warning:
            self.warned += 1
        else:
            change = balance_change(result)
            self.worst = max(self.worst, change)
            self.wrong += broken_laws(trial, result, name)


def balance_change(result: Run) -> float:
    """Largest change of the energy balance relative to the largest energy in motion, given up or taken in."""
    balance = result["energy.balance"][:, 0]
    moving = result["energy.kinetic"] + result["energy.elastic"]
    scale = moving.max() + np.abs(result["energy.external_work"]).max() + np.ptp(result["energy.potential"])
    return float(np.abs(balance - balance[0]).max() / scale)


def broken_laws(trial: Trial, result: Run, name: str) -> list[str]:
    """A free body falls as a point does, whatever its parts do: ``p = m (v + g t)`` without loads and damping."""
    body = trial.scene.bodies[0]
    if len(trial.scene.bodies) > 1 or body.supports or body.loads or body.viscous_damping > 0.0:
        return []
    momentum = result["momentum.linear"]
    gravity = trial.scene.forces[0].acceleration
    every = result.simulation.record_every * trial.step
    moved = momentum - momentum[0]
    weight = moved[-1] @ gravity / max(gravity @ gravity, 1e-300) / (every * (len(moved) - 1))  # mass
    expected = weight * np.arange(len(moved))[:, np.newaxis] * every * gravity
    error = np.abs(moved - expected).max() / np.abs(momentum).max()
    return [] if error < 1e-8 else [f"{name}: linear momentum off by {error:.1e} of the largest"]


MAKERS = {"frames": random_frame, "shells": random_shell, "linkages": random_linkage}


def random_scenes(what: str, scheme: str, seeds: range, steps: int) -> Iterator[Row]:
    """Rows of a number of random scenes of one sort and scheme."""
    tally = Tally()
    for seed in seeds:
        tally.add(MAKERS[what](seed), scheme, steps, f"{what} {seed}, {scheme}")
    if tally.stopped == tally.count > 3:
        tally.wrong.append("not one of them runs to its end")
    setting = (
        f"{tally.count} {what} of {steps} steps, {scheme}: {tally.stopped} stopped, {tally.warned} warned of"
    )
    exact = what == "frames" and scheme in {"energy-momentum", "auto"}
    limit = SILENT if exact or what == "linkages" or scheme == "explicit" else QUADRATIC
    yield Row(setting, "silent change of the energy balance, relative", tally.worst, limit)
    yield Row(
        setting, "broken laws" + "".join(f"; {text}" for text in tally.wrong), float(len(tally.wrong)), 0.0
    )


PLAN = {
    ("frames", "carried"): (60, 100_000),
    ("frames", "energy-momentum"): (20, 10_000),
    ("frames", "auto"): (20, 10_000),
    ("frames", "explicit"): (40, 100_000),
    ("shells", "carried"): (8, 100_000),
    ("shells", "energy-momentum"): (12, 3_000),
    ("shells", "auto"): (12, 5_000),
    ("shells", "explicit"): (8, 100_000),
    ("linkages", "carried"): (12, 10_000),
    ("linkages", "energy-momentum"): (8, 2_000),
    ("linkages", "auto"): (6, 2_000),
}
"""How many scenes of which sort, and how many steps each."""


def random_meshes(share: float = 1.0) -> Iterator[Row]:
    """Frames, shells and linkages of random shape (straight, curved, distorted, with a hole), size 0.1 to 100 m,
    thickness 1e-4 to 0.05 of that and up to 100 times less in a part, E 1e3 to 1e12 Pa, supports, loads, damping, with
    steps of a tenth to ten times the usual: a run is right, or stops, or is warned of."""
    for (what, scheme), (count, steps) in PLAN.items():
        yield from random_scenes(what, scheme, range(max(1, round(share * count))), steps)


def bar(modulus: float, count: int, **more: object) -> FrameBody:
    """A bar of 1.2 m, 20 kg/m and a section of 200 x 9 mm, along x from the origin."""
    mesh = line(np.zeros(3), (1.2, 0.0, 0.0), count)
    section = FrameSection(5540.0, modulus, 0.0018, 1.215e-8, 0.0045)
    return FrameBody(
        name="tip",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(section,),
        **more,
    )


def pendulum(modulus: float, count: int, elasticity: str) -> Scene:
    """The bar on a pin, from horizontal."""
    pin = (Support(np.array([0]), {"position": "xyz"}),)
    body = bar(modulus, count, supports=pin, elasticity=elasticity)
    return Scene((body,), (Gravity(np.array([0.0, -9.81, 0.0])),))


def end_of(result: Run) -> np.ndarray:
    """Place of the last node [m], shape (records, 3)."""
    return result["tip.position"][:, -3:]


def steel_pendulum() -> Iterator[Row]:
    """A bar of steel that swings with steps of 10 ms, a thousand times the explicit limit; 10 elements."""
    fine = end_of(run(pendulum(2.1e11, 10, "energy-momentum"), 1e-4, 1.0))
    for scheme in ("carried", "energy-momentum"):
        result = run(pendulum(2.1e11, 10, scheme), 1e-2, 1.0)
        error = float(np.linalg.norm(end_of(result) - fine, axis=1).max())
        yield Row(f"{scheme}, 1 s", "position error [m]", error, 1.5e-3, completed(result))
        result = run(pendulum(2.1e11, 10, scheme), 1e-2, 30.0, records=3000)
        # the strains of a shape are rounded to 1e-16, and their stress is 4e8 N times that
        limit = 1e-10 if scheme == "carried" else 1e-9
        yield Row(f"{scheme}, 30 s", "change of energy, relative", balance_change(result), limit)


def change_over() -> Iterator[Row]:
    """Carried strains that drift until the other scheme takes over: without a jolt."""
    for modulus, step in ((2.1e11, 2e-2), (0.7e9, 1e-2)):
        result = run(pendulum(modulus, 10, "auto"), step, 10.0, records=1000)
        plain = run(pendulum(modulus, 10, "energy-momentum"), step, 10.0, records=1000)
        setting = f"E = {modulus:g} Pa, {step * 1e3:g} ms"
        changed = 0.0 if "changed over" in result.simulation.warning else 1.0
        yield Row(setting, "no word of it", changed, 0.0, completed(result))
        yield Row(setting, "change of energy, relative", balance_change(result), 2e-3)
        gain = result["energy.kinetic"].max() / plain["energy.kinetic"].max() - 1.0
        yield Row(setting, "more kinetic energy than without, relative", float(gain), 2e-3)


def free_flight() -> Iterator[Row]:
    """A bar and a plate that fly, turn and bend without any force, 100 000 steps."""
    spin = {"velocity": np.array([1.0, -2.0, 0.5]), "angular_velocity": np.array([2.0, 1.0, 3.0])}
    mesh = rectangle(1.0, 0.8, 2, 2)
    sheet = ShellBody(
        name="sheet",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(0.01, 1000.0, 1e7, 0.3),),
        **spin,
    )
    for name, body in (("bar", bar(1e8, 2, **spin)), ("plate", sheet)):
        for scheme in ("carried", "energy-momentum", "explicit"):
            scene = with_scheme(Scene((body,)), scheme)
            step = 1e-4 if scheme == "explicit" else 1e-3
            result = run(scene, step, 1e5 * step)
            setting = f"{name}, {scheme}, {step * 1e3:g} ms"
            for channel in ("linear", "angular"):
                momentum = result[f"momentum.{channel}"]
                change = np.abs(momentum - momentum[0]).max() / np.linalg.norm(momentum[0])
                yield Row(setting, f"change of {channel} momentum, relative", float(change), 2e-9)
            bounded = QUADRATIC if scheme != "explicit" else 1e-3
            yield Row(
                setting, "change of energy, relative", balance_change(result), bounded, completed(result)
            )


MESH_EXPERIMENTS: dict[str, Callable[[], Iterator[Row]]] = {
    "steel pendulum": steel_pendulum,
    "change of scheme": change_over,
    "free flight": free_flight,
    "random meshes": random_meshes,
}
"""By name, in the order of the report, after those of `experiments`."""
