"""Reference of springs, dampers and motors on joints and between points, in closed form.

torsion         hinge, joint spring c and damper d, at rest at -0.5 rad: damped oscillation of the angle
soft_stop       slider, joint spring as a table: no force within +-b, k (|x| - b) outside: half sines, as at a stop
ramp            slider, motor as a table, force P t / T: x = P t^3 / (6 m T), after T: constant force
shock           slider, spring k with damper d to a point on its line: damped oscillation about its length
two_stage       slider, spring as a table, k1 pushing in and k2 pulling out: half sines of two frequencies

    python make_reference.py        writes the tables and prints the check by DOP853
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

DURATION = 3.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]


def damped(start: float, stiffness: float, damping: float, mass: float) -> Array:
    """Damped oscillation from rest."""
    rate = 0.5 * damping / mass
    omega = np.sqrt(stiffness / mass - rate**2)
    return start * np.exp(-rate * TIMES) * (np.cos(omega * TIMES) + rate / omega * np.sin(omega * TIMES))


def between_stops(speed: float, stop: float, omega: float) -> Array:
    """To and fro between two elastic stops, from the middle."""
    way, contact = 2.0 * stop / speed, np.pi / omega
    half = np.mod(TIMES + 0.5 * way, way + contact)
    side = 1.0 - 2.0 * np.mod(np.floor((TIMES + 0.5 * way) / (way + contact)), 2.0)
    pressed = stop + speed / omega * np.sin(omega * np.clip(half - way, 0.0, contact))
    return side * np.where(half < way, speed * (half - 0.5 * way), pressed)


def ramped(peak: float, until: float, mass: float) -> Array:
    """Travel under a force that rises to `peak` and stays there."""
    t, after = np.minimum(TIMES, until), np.maximum(TIMES - until, 0.0)
    ramp = peak * t**3 / (6.0 * mass * until)
    return ramp + 0.5 * peak * until / mass * after + 0.5 * peak / mass * after**2


def two_stage(speed: float, inward: float, outward: float) -> Array:
    """Half sines of two frequencies in turn, outward first."""
    out, back = np.pi / outward, np.pi / inward
    phase = np.mod(TIMES, out + back)
    returning = -speed / inward * np.sin(inward * (phase - out))
    return np.where(phase < out, speed / outward * np.sin(outward * phase), returning)


def table_force(x: float, places: Array, forces: Array) -> float:
    """Force of a table, linear beyond its ends."""
    k = int(np.clip(np.searchsorted(places, x) - 1, 0, len(places) - 2))
    return forces[k] + (forces[k + 1] - forces[k]) * (x - places[k]) / (places[k + 1] - places[k])


SOFT = (np.array([-1.2, -0.2, 0.2, 1.2]), np.array([-500.0, 0.0, 0.0, 500.0]))
STAGES = (np.array([-1.0, 0.0, 1.0]), np.array([-800.0, 0.0, 200.0]))

CLOSED = {
    "torsion": damped(0.5, 20.0, 0.4, 0.5) - 0.5,
    "soft_stop": between_stops(1.0, 0.2, np.sqrt(500.0 / 5.0)),
    "ramp": ramped(10.0, 2.0, 5.0),
    "shock": damped(0.2, 500.0, 10.0, 5.0),
    "two_stage": two_stage(1.0, np.sqrt(800.0 / 5.0), np.sqrt(200.0 / 5.0)),
}
# start and start speed
STARTS = {"torsion": (0.0, 0.0), "soft_stop": (0.0, 1.0), "ramp": (0.0, 0.0), "shock": (0.2, 0.0)}
STARTS |= {"two_stage": (0.0, 1.0)}


def acceleration(name: str, t: float, x: float, v: float) -> float:
    """Second derivative of travel or angle."""
    match name:
        case "torsion":
            return -(20.0 * (x + 0.5) + 0.4 * v) / 0.5
        case "soft_stop":
            return -table_force(x, *SOFT) / 5.0
        case "ramp":
            return 10.0 * min(1.0, t / 2.0) / 5.0
        case "shock":
            return -(500.0 * x + 10.0 * v) / 5.0
        case _:
            return -table_force(x, *STAGES) / 5.0


def integrated(name: str) -> Array:
    """Travel or angle from the differential equation."""

    def rate(t: float, y: Array) -> list[float]:
        return [y[1], acceleration(name, t, *y)]

    small = {"rtol": 1e-12, "atol": 1e-13, "max_step": 1e-3}
    return solve_ivp(rate, (0.0, DURATION), STARTS[name], "DOP853", TIMES, **small).y[0]


def references() -> dict[str, Array]:
    """Tables of time [s] and travel [m] or angle [rad] by file name, shape (101, 2)."""
    return {f"{name}.csv": np.column_stack([TIMES, values]) for name, values in CLOSED.items()}


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        rows = ["time,value", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    for name, values in CLOSED.items():
        difference = np.abs(values - integrated(name)).max()
        sys.stdout.write(f"{name}: closed form - DOP853 {difference:.1e}\n")


if __name__ == "__main__":
    main()
