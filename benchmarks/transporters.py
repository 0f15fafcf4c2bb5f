"""Time of a step with transporters on three decks: 12 and 144 bogies in four groups.

They travel by themselves, with and without dampers; or are driven along a path; or roll along it on tyres that slip.

python benchmarks/transporters.py
"""

from __future__ import annotations

import time

import numpy as np

from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.transport import BogieGroup, Drive, PathLeg, Tyres
from heavylift.solver.simulation import Simulation
from heavylift.solver.transport.decks import Deck
from heavylift.solver.transport.transporters import Transporter

STEP, STEPS = 2e-2, 4000


def vehicle(rows: int, offsets: tuple[float, ...], load: float, height: float, way: str) -> Scene:
    """Front and rear rows, left and right, on a quay, a link and a barge that all stand still."""
    x = 1.4 * (np.arange(rows) - 0.5 * (rows - 1))
    groups = tuple(
        BogieGroup(
            f"group_{front}{left}",
            np.array([(a, b, 0.0) for a in x for b in offsets if (a > 0) == front and (b > 0) == left]),
            oil_stiffness=9.7e6,
        )
        for front in (True, False)
        for left in (True, False)
    )
    sides = np.array([-30.0, 30.0])
    decks = tuple(
        Deck(name=name, sides=sides, stations=np.array(ends), heights=np.zeros(2))
        for name, ends in (("quay", (-40.0, 15.0)), ("link", (15.0, 25.0)), ("barge", (25.0, 120.0)))
    )
    transporter = Transporter(
        name="spmt",
        body="block",
        groups=groups,
        wheel_radius=0.37,
        tyre_stiffness=3.0e6,
        tyre_damping=1.5e4 * (way != "no dampers"),
        line_damping=2.0e4 * (way != "no dampers"),
        travel_speed=None if way in {"path", "tyres"} else 0.0694,
        legs=(PathLeg(points=np.array([[10.0, 0.0]]), speed=0.0694),) if way in {"path", "tyres"} else (),
        drive=Drive() if way in {"path", "tyres"} else None,
        tyres=Tyres(cornering=8.0) if way == "tyres" else None,
    )
    mass = load * rows * len(offsets)
    inertia = mass * np.array([9.0, 16.0, 20.0]) * (offsets[-1] / 6.0 + 0.5)
    block = RigidBody("block", mass, np.diag(inertia), centre_of_mass=np.array([0.0, 0.0, height]))
    gravity = Gravity(np.array([0.0, 0.0, -9.81]))
    return Scene((block,), forces=(gravity,), decks=decks, transporters=(transporter,))


def main() -> None:
    """Microseconds of CPU a step."""
    trains = tuple(middle + side for middle in (-14.0, -6.0, 6.0, 14.0) for side in (-0.725, 0.725))
    for words, rows, offsets, height in (
        ("12 bogies", 6, (-0.725, 0.725), 3.58),
        ("144 bogies", 18, trains, 9.93),
    ):
        for way in ("no dampers", "damped", "path", "tyres"):
            scene = vehicle(rows, offsets, 13.1e3, height, way)
            run = Simulation(scene, step=STEP, integrator="dele2", record_every=50)
            run.advance(50)
            begin = time.process_time()
            run.advance(STEPS)
            spent = 1e6 * (time.process_time() - begin) / STEPS
            print(f"{words}, {way}: {spent:.1f} us a step")


if __name__ == "__main__":
    main()
