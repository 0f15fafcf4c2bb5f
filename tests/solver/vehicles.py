"""Transporters of the tests: vehicles R12 and R24 of `tests/reference_data/transport`, on roads of the ground."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.transport import BogieGroup, Bump
from heavylift.solver.simulation import Simulation
from heavylift.solver.transport.decks import Deck
from heavylift.solver.transport.transporters import Transporter

DATA = Path(__file__).resolve().parents[1] / "reference_data" / "transport"
G, T = 9.81, 1000.0
OIL, TYRE = 9.7e6, 3.0e6
FRONT, REAR = (3.5, 2.1, 0.7), (-0.7, -2.1, -3.5)
MASS, HEIGHT, INERTIA = 173.0e3, 3.579190751, (838410.087, 5638150.087, 6.0e6)
BOGIE = 108.0


def yard(**more) -> Deck:
    """Level ground."""
    given = {"stations": np.array([-30.0, 60.0]), "heights": np.zeros(2), "sides": np.array([-10.0, 10.0])}
    return Deck(name="yard", **(given | more))


def bump(
    start: float, length: float, sides: tuple[float, float], shape: str = "cosine", height: float = 0.1
) -> Deck:
    """A bump across part of the road."""
    return Deck(name="bump", sides=np.array(sides), bump=Bump(start, length, height, shape))


def groups_of(number: int, oil: float = OIL) -> tuple[BogieGroup, ...]:
    """Groups of R12: 12 single ones; 4 corners; 3, the front two lines and the rear ones left and right; 2 sides."""
    all_lines = FRONT + REAR
    places = {
        12: [[(x, y)] for x in all_lines for y in (0.725, -0.725)],
        4: [[(x, y) for x in lines] for lines in (FRONT, REAR) for y in (0.725, -0.725)],
        3: [
            [(x, y) for x in all_lines[:2] for y in (0.725, -0.725)],
            *([(x, y) for x in all_lines[2:]] for y in (0.725, -0.725)),
        ],
        2: [[(x, y) for x in all_lines] for y in (0.725, -0.725)],
    }[number]
    return tuple(
        BogieGroup(f"group_{i + 1}", np.array([(x, y, 0.0) for x, y in group]), oil_stiffness=oil)
        for i, group in enumerate(places)
    )


def vehicle(**more) -> Transporter:
    """R12 with four groups."""
    given = {
        "name": "spmt",
        "body": "block",
        "groups": groups_of(4),
        "wheel_radius": 0.0,
        "tyre_stiffness": TYRE,
        "bogie_mass": BOGIE,
    }
    return Transporter(**(given | more))


def block(**more) -> RigidBody:
    """The sprung mass of R12; its frame is on the road."""
    given = {
        "name": "block",
        "mass": MASS,
        "inertia": np.diag(INERTIA),
        "centre_of_mass": np.array([0.0, 0.0, HEIGHT]),
    }
    return RigidBody(**(given | more))


def scene(
    transporter: Transporter, decks: tuple[Deck, ...] = (), body: RigidBody | None = None, **more
) -> Scene:
    """A vehicle on decks."""
    return Scene(
        more.pop("bodies", (body or block(),)),
        forces=(Gravity(np.array([0.0, 0.0, -G])),),
        decks=decks or (yard(),),
        transporters=(transporter,),
        **more,
    )


def histories(made: Scene, step: float, duration: float, every: int = 1):
    """Times and channels by name, each of shape (records, components)."""
    run = Simulation(made, step=step, integrator="dele2", record_every=every)
    times, records = run.advance(round(duration / step))
    named = {c.name: records[:, c.column : c.column + len(c.components)] for c in run.channels}
    return run, times, {name: h[:, 0] if h.shape[1] == 1 else h for name, h in named.items()}
