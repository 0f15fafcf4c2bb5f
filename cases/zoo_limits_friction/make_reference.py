"""Reference of dry friction and of elastic stops, in closed form.

Dry friction F slows a body of mass m (torque, moment of inertia) by F / m until it rests, where it stays if F
exceeds the other forces; on the incline gravity slows it as well:

    x = v t - 1/2 a t^2,   a = F / m + g sin(slope),   t <= v / a

Between two stops of stiffness k at +-b a body goes to and fro with the speed v, and each contact is half a sine:

    x = b + v / w sin(w (t - tc)),   w = sqrt(k / m),   for pi / w

    python make_reference.py        writes the tables and prints the check by DOP853
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

GRAVITY = 9.81
DURATION = 3.0
TIMES = DURATION * np.arange(101) / 100

# name: speed, deceleration
SLOWED = {
    "rough_block": (2.0, 20.0 / 10.0),
    "rough_wheel": (4.0, 1.0 / 0.5),
    "held_block": (2.181, 60.0 / 10.0 + GRAVITY * np.sin(np.radians(30.0))),
}
# name: speed, stop, frequency of the contact
BOUNCING = {
    "stopped_block": (1.0, 0.5, np.sqrt(1e4 / 10.0)),
    "stopped_wheel": (2.0, np.pi / 6, np.sqrt(400.0 / 0.5)),
}

Array = NDArray[np.float64]


def slowed(speed: float, deceleration: float) -> Array:
    """Travel or angle at the sample times; at rest after a while."""
    t = np.minimum(TIMES, speed / deceleration)
    return speed * t - 0.5 * deceleration * t**2


def bouncing(speed: float, stop: float, omega: float) -> Array:
    """Travel or angle at the sample times, from the middle."""
    way, contact = 2.0 * stop / speed, np.pi / omega
    half = np.mod(TIMES + 0.5 * way, way + contact)
    side = 1.0 - 2.0 * np.mod(np.floor((TIMES + 0.5 * way) / (way + contact)), 2.0)
    free = speed * (half - 0.5 * way)
    pressed = stop + speed / omega * np.sin(omega * np.clip(half - way, 0.0, contact))
    return side * np.where(half < way, free, pressed)


def integrated(speed: float, stop: float, omega: float) -> Array:
    """The same by DOP853 with small steps."""

    def rate(_: float, y: Array) -> list[float]:
        return [y[1], -(omega**2) * (y[0] - np.clip(y[0], -stop, stop))]

    start, small = [0.0, speed], {"rtol": 1e-12, "atol": 1e-13, "max_step": 1e-3}
    return solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, **small).y[0]


def references() -> dict[str, Array]:
    """Tables of time [s] and travel [m] or angle [rad] by file name, shape (101, 2)."""
    found = {name: slowed(*numbers) for name, numbers in SLOWED.items()}
    found |= {name: bouncing(*numbers) for name, numbers in BOUNCING.items()}
    return {f"{name}.csv": np.column_stack([TIMES, values]) for name, values in found.items()}


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        rows = ["time,value", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    for name, numbers in BOUNCING.items():
        difference = np.abs(bouncing(*numbers) - integrated(*numbers)).max()
        sys.stdout.write(f"{name}: closed form - DOP853 {difference:.1e}\n")


if __name__ == "__main__":
    main()
