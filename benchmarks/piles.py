"""Piles of boxes in rigid contact: what a step costs and how far off it is, beside MuJoCo where that is installed.

    python benchmarks/piles.py [--awake] [scene ...]

CPU time of a step: mean, median of the last fifth, largest mean of 20 ms. With `--awake` islands at rest do not sleep.
MuJoCo has the same boxes, friction and steps, with `implicitfast`, elliptic cones and its own softness of contacts.
What is at rest must stay where it is: *moved* is the largest distance from the start at the end, *strayed* that at any
time, *creeps* that from where it was after half of the time. MuJoCo's stack of thirty is pressed together at first and
thrown up again, by 0.17 or 1.03 m for accelerations of gravity of 9.80665 or 9.81 m/s2, so it rests later. Dominoes:
when the tenth has sunk to 0.9 of its height. What falls: the centre of all boxes at the end. *gain*: the largest growth
of the energy balance over the energy turned over.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.rotation import rotation_matrix
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.collisions import Collision, CollisionSurface
from heavylift.solver.scene.contacts import RigidLaw
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

G = 9.81
INTERVAL = 0.02
"""Between records [s]."""


@dataclass(frozen=True)
class Box:
    """A box, free unless it has no mass."""

    mass: float
    size: tuple[float, float, float]
    position: Sequence[float]
    orientation: Sequence[float] = (1.0, 0.0, 0.0, 0.0)
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    spin: Sequence[float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Pile:
    """Boxes on a plane; pairs by number, -1 is the plane; None: all pairs."""

    boxes: Sequence[Box]
    step: float
    duration: float
    friction: float
    pair_friction: float | None = None
    fixed: Sequence[Box] = ()
    pairs: Sequence[tuple[int, int]] | None = None
    events: bool = True
    most: int = 512
    at_rest: bool = True


@dataclass(frozen=True)
class Found:
    """Of a run: times of records [s], positions [m], CPU time of a step from record to record [ms], how it went."""

    times: NDArray[np.float64]
    positions: NDArray[np.float64]
    cpu: NDArray[np.float64]
    word: str


def stacks(*heights: int) -> Pile:
    """Cubes of a metre and a ton upon each other."""
    boxes: list[Box] = []
    pairs = []
    for k, height in enumerate(heights):
        for i in range(height):
            pairs.append((-1 if i == 0 else len(boxes) - 1, len(boxes)))
            boxes.append(Box(1000.0, (1.0, 1.0, 1.0), (3.0 * k, 0.0, i + 0.5)))
    return Pile(boxes, 0.01, 5.0, 0.5, pairs=pairs)


def wall(rows: Sequence[int], *, stands: bool) -> Pile:
    """Bricks of 10 kg in rows, 8 mm apart; of rows of six and five in turn the upper ends overhang by 4 mm and fall."""
    places = [((k - (n - 1) / 2) * 0.408, 0.0, 0.2 * (r + 0.5)) for r, n in enumerate(rows) for k in range(n)]
    boxes = [Box(10.0, (0.4, 0.2, 0.2), place) for place in places]
    return Pile(boxes, 0.005, 2.0, 0.6, most=32, at_rest=stands)


def dominoes(count: int = 10) -> Pile:
    """Ten of 50 x 25 x 10 mm, 30 mm apart; the first one turns about its lower edge with 5 rad/s."""
    size = (0.01, 0.025, 0.05)
    boxes = [Box(0.01, size, (-0.005 + 0.03 * i, 0.0, 0.025)) for i in range(count)]
    boxes[0] = Box(0.01, size, (-0.005, 0.0, 0.025), velocity=(0.125, 0.0, 0.025), spin=(0.0, 5.0, 0.0))
    pairs = [(-1, i) for i in range(count)] + [(i, i + 1) for i in range(count - 1)]
    return Pile(boxes, 2e-4, 1.0, 1.5, pair_friction=0.0, pairs=pairs)


def chute(count: int = 50) -> Pile:
    """Cubes of 0.2 m and 8 kg, turned at random, slide down 12 m at 35 degrees between two walls."""
    angle = np.radians(35.0)
    turned = (np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0)
    middle = np.array([-6.0 * np.cos(angle), 0.0, 6.0 * np.sin(angle) + 0.3])
    sides = [((12.0, 2.2, 0.2), (0.0, 0.0, -0.1))]
    sides += [((12.0, 0.2, 2.0), (0.0, y, 0.9)) for y in (1.2, -1.2)]
    turn = rotation_matrix(np.array(turned))
    fixed = [Box(0.0, size, tuple(middle + turn @ at), turned) for size, at in sides]
    random, boxes = np.random.default_rng(3), []
    for k in range(count):
        axis = random.normal(size=3)
        half = 0.5 * random.uniform(0.0, 3.0)
        i, j, level = k % 5, (k // 5) % 5, k // 25
        x = -6.0 * np.cos(angle) - 3.0 + 0.45 * i
        z = 6.0 * np.sin(angle) + 0.9 + (3.0 - 0.45 * i) * np.tan(angle) + 0.45 * level + 0.2 * i
        orientation = (np.cos(half), *(np.sin(half) * axis / np.linalg.norm(axis)))
        boxes.append(Box(8.0, (0.2, 0.2, 0.2), (x, (j - 2) * 0.4, z), orientation))
    return Pile(boxes, 0.005, 4.0, 0.3, fixed=fixed, events=False, most=64, at_rest=False)


PILES: dict[str, Callable[[], Pile]] = {
    "stacks of 10, 10, 30": lambda: stacks(10, 10, 30),
    "five stacks of ten": lambda: stacks(*[10] * 5),
    "wall of 60 stands": lambda: wall([11 - r for r in range(8)], stands=True),
    "ten dominoes": dominoes,
    "chute": chute,
    "wall of 61 falls": lambda: wall([6 - r % 2 for r in range(11)], stands=False),
}


def _scene(pile: Pile) -> Scene:
    bodies, surfaces = [], [_skin("plane", "ground", plane_surface((100.0, 100.0)))]
    for i, box in enumerate(pile.fixed):
        placed = box_surface(box.size)
        turn = rotation_matrix(np.array(box.orientation))
        points = placed.points @ turn.T + np.array(box.position)
        surfaces.append(_skin(f"fixed{i}", "ground", TriangleSurface(points, placed.triangles, 0.0, "fixed")))
    for i, box in enumerate(pile.boxes):
        bodies.append(
            RigidBody(
                name=f"box{i}",
                mass=box.mass,
                inertia=np.diag(_moments(box)),
                position=np.array(box.position, dtype=float),
                velocity=np.array(box.velocity, dtype=float),
                orientation=np.array(box.orientation, dtype=float),
                angular_velocity=np.array(box.spin, dtype=float),
            )
        )
        surfaces.append(_skin(f"box{i}", f"box{i}", box_surface(box.size)))
    names = [surface.name for surface in surfaces]
    if pile.pairs is None:
        pairs = [
            (a, b)
            for a, b in combinations(names, 2)
            if not (a.startswith(("plane", "fixed")) and b.startswith("fixed"))
        ]
    else:
        pairs = [("plane" if a < 0 else f"box{a}", f"box{b}") for a, b in pile.pairs]
    between = pile.friction if pile.pair_friction is None else pile.pair_friction
    collisions = [
        Collision(
            name=f"{a}-{b}",
            surfaces=(a, b),
            law=RigidLaw(events=pile.events),
            friction=between if a.startswith("box") else pile.friction,
            most_contacts=pile.most,
            recorded=0,
        )
        for a, b in pairs
    ]
    return Scene(
        bodies=tuple(bodies),
        forces=(Gravity(np.array([0.0, 0.0, -G])),),
        surfaces=tuple(surfaces),
        collisions=tuple(collisions),
    )


def _skin(name: str, body: str, surface: TriangleSurface) -> CollisionSurface:
    return CollisionSurface(name=name, body=body, surface=surface)


def _moments(box: Box) -> list[float]:
    x, y, z = (side * side for side in box.size)
    return [box.mass * (y + z) / 12.0, box.mass * (x + z) / 12.0, box.mass * (x + y) / 12.0]


def run_heavylift(pile: Pile, *, awake: bool = False) -> Found:
    """With the default integrator; islands may be kept awake."""
    every = round(INTERVAL / pile.step)
    simulation = Simulation(_scene(pile), pile.step, record_every=every)
    simulation.warm_up()
    if awake:
        for system in simulation._layout.systems:  # noqa: SLF001
            if hasattr(system, "sleepers"):
                system.sleepers["allowed"] = False
    column = {channel.name: channel.column for channel in simulation.channels}
    places = [column[f"box{i}.position"] for i in range(len(pile.boxes))]
    rows, times, cpu = [simulation.record()], [0.0], []
    while times[-1] < pile.duration - 0.5 * INTERVAL and not simulation.outcome:
        begin = time.process_time()
        at, found = simulation.advance(every)
        cpu.append(1e3 * (time.process_time() - begin) / every)
        times += [float(value) for value in at]
        rows += list(found)
    records = np.array(rows)
    balance, turned = records[:, column["energy.balance"]], records[:, column["energy.potential"]]
    gain = (balance.max() - balance[0]) / max(float(np.abs(turned - turned[0]).max()), 1e-300)
    word = f"gain {gain:.1e}" if pile.at_rest is False else ""
    if simulation.outcome:
        word = f"STOPS at {simulation.time:.3f} s"
    positions = np.array([[row[c : c + 3] for c in places] for row in records])
    return Found(np.array(times), positions, np.array(cpu), word)


def run_mujoco(pile: Pile) -> Found:
    """With the integrator that it recommends, and its default softness."""
    import mujoco

    def numbers(values: Any) -> str:
        return " ".join(repr(float(value)) for value in values)

    def geometry(box: Box, friction: float) -> str:
        half = numbers(0.5 * side for side in box.size)
        return f'<geom type="box" size="{half}" friction="{max(friction, 1e-5)} 0 0"'

    def place(box: Box) -> str:
        return f'pos="{numbers(box.position)}" quat="{numbers(box.orientation)}"'

    between = pile.friction if pile.pair_friction is None else pile.pair_friction
    text = (
        f'<mujoco><option timestep="{pile.step}" gravity="0 0 {-G}" integrator="implicitfast" cone="elliptic"/>'
        f'<size memory="200M"/><worldbody><geom type="plane" size="50 50 1" friction="{pile.friction} 0 0"'
        ' priority="1"/>'
    )
    text += "".join(f"{geometry(box, pile.friction)} {place(box)}/>" for box in pile.fixed)
    for box in pile.boxes:
        inertia = f'<inertial pos="0 0 0" mass="{box.mass}" diaginertia="{numbers(_moments(box))}"/>'
        text += f"<body {place(box)}><freejoint/>{inertia}{geometry(box, between)}/></body>"
    model = mujoco.MjModel.from_xml_string(f"{text}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    for i, box in enumerate(pile.boxes):
        data.qvel[6 * i : 6 * i + 3], data.qvel[6 * i + 3 : 6 * i + 6] = box.velocity, box.spin
    every = round(INTERVAL / pile.step)
    positions, times, cpu = [data.qpos.reshape(-1, 7)[:, :3].copy()], [0.0], []
    while data.time < pile.duration - 0.5 * INTERVAL:
        begin = time.process_time()
        mujoco.mj_step(model, data, every)
        cpu.append(1e3 * (time.process_time() - begin) / every)
        positions.append(data.qpos.reshape(-1, 7)[:, :3].copy())
        times.append(data.time)
    return Found(np.array(times), np.array(positions), np.array(cpu), "")


def _error(name: str, pile: Pile, found: Found) -> str:
    """How far off it is, in words."""
    x = found.positions
    if name == "ten dominoes":
        z = x[:, -1, 2]
        after = int(np.argmax(z < 0.9 * z[0]))
        if after == 0:
            return "the last one stands"
        share = (0.9 * z[0] - z[after - 1]) / (z[after] - z[after - 1])
        tips = found.times[after - 1] + share * (found.times[after] - found.times[after - 1])
        rest = np.abs(x[-1] - x[-5]).max()
        return f"tenth tips at {tips:.5f} s, ends at {x[-1, -1, 0]:.5f} m, then moves {rest:.0e} m"
    if pile.at_rest:
        moved, strayed = np.abs(x[-1] - x[0]).max(), np.abs(x - x[0]).max()
        creeps = np.abs(x[-1] - x[len(x) // 2]).max()
        return f"moved {moved:.1e} m, strayed {strayed:.1e} m, creeps {creeps:.1e} m"
    centre = ", ".join(f"{value:.3f}" for value in x[-1].mean(axis=0))
    return f"centre ({centre}) m, lowest {x[:, :, 2].min():.4f} m"


def main(wanted: Sequence[str]) -> None:
    """Print the table; names of scenes by their beginnings."""
    awake, wanted = "--awake" in wanted, [word for word in wanted if word != "--awake"]
    programs: dict[str, Callable[[Pile], Found]] = {"heavylift": partial(run_heavylift, awake=awake)}
    try:
        import mujoco  # noqa: F401

        programs["MuJoCo"] = run_mujoco
    except ImportError:
        pass
    print(f"{'scene':22s} {'program':10s} {'ms a step':>9s} {'last':>8s} {'largest':>8s}  errors")
    for name, make in PILES.items():
        if wanted and not any(name.startswith(word) for word in wanted):
            continue
        pile = make()
        for program, run in programs.items():
            found = run(pile)
            last = np.median(found.cpu[-max(1, len(found.cpu) // 5) :])
            times = f"{found.cpu.mean():9.3f} {last:8.3f} {found.cpu.max():8.2f}"
            print(f"{name:22s} {program:10s} {times}  {_error(name, pile, found)} {found.word}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
