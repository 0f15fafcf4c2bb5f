"""Reference of a load that falls into its rope and bounces: arcs of parabolas and of sines, in closed form.

With the elongation x of the rope (negative while it is slack), w^2 = k / m and the drop H,

    slack:  x'' = g,              for the time 2 t1, t1 = sqrt(2 H / g), between two ends of contact
    taut:   x'' = g - w^2 x,      x = g / w^2 (1 - cos(w t)) + v0 / w sin(w t),   v0 = sqrt(2 g H)

The rope is taut for the time t2 = 2 (pi - arctan(v0 w / g)) / w, and nothing is lost: the motion repeats
after 2 t1 + t2.

    python make_reference.py        writes the tables and prints the check by DOP853
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

GRAVITY = 9.81
MASS, STIFFNESS = 1e4, 1e6
LENGTH, DROP = 10.0, 2.0
DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100
PLACES = {"wire": 0.0, "spring": 5.0}

Array = NDArray[np.float64]

OMEGA = np.sqrt(STIFFNESS / MASS)
ARRIVAL = np.sqrt(2.0 * GRAVITY * DROP)
FALL = np.sqrt(2.0 * DROP / GRAVITY)
CONTACT = 2.0 * (np.pi - np.arctan(ARRIVAL * OMEGA / GRAVITY)) / OMEGA


def elongation(t: Array) -> Array:
    """Elongation of the rope [m], negative while slack; released at -DROP at rest."""
    phase = np.mod(t + FALL, 2.0 * FALL + CONTACT) - FALL  # zero at the top of the bounce
    taut = phase - FALL
    sag = GRAVITY / OMEGA**2
    pulled = sag * (1.0 - np.cos(OMEGA * taut)) + ARRIVAL / OMEGA * np.sin(OMEGA * taut)
    return np.where(taut < 0.0, 0.5 * GRAVITY * phase**2 - DROP, pulled)


def integrated() -> Array:
    """The same by DOP853, from event to event."""

    def rate(_: float, y: Array) -> list[float]:
        return [y[1], GRAVITY - OMEGA**2 * max(0.0, y[0])]

    def tightens(_: float, y: Array) -> float:
        return y[0]

    tightens.terminal = True  # type: ignore[attr-defined]
    t, y, rows = 0.0, np.array([-DROP, 0.0]), []
    while t < DURATION:
        times = TIMES[(t <= TIMES) & (TIMES <= DURATION)]
        found = solve_ivp(rate, (t, DURATION), y, "DOP853", times, rtol=1e-13, atol=1e-14, events=tightens)
        rows.extend(found.y[0])
        if found.status == 0:
            break
        t, y = found.t_events[0][0], found.y_events[0][0]
        y[0] = np.copysign(1e-15, y[1])
    return np.array(rows)


def references() -> dict[str, Array]:
    """Tables of time [s] and place [m], shape (101, 4), and of the tension [N], shape (101, 2)."""
    x = elongation(TIMES)
    tables = {"tension.csv": np.column_stack([TIMES, STIFFNESS * np.maximum(0.0, x)])}
    for name, y in PLACES.items():
        tables[f"reference_{name}.csv"] = np.column_stack(
            [TIMES, np.zeros(101), np.full(101, y), -LENGTH - x]
        )
    return tables


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        header = "time,x,y,z" if table.shape[1] == 4 else "time,value"
        rows = [header, *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    difference = np.abs(elongation(TIMES) - integrated()).max()
    sys.stdout.write(f"closed form - DOP853: {difference:.1e} m\n")
    sys.stdout.write(f"a bounce every {2.0 * FALL + CONTACT:.6f} s, taut for {CONTACT:.6f} s of it\n")


if __name__ == "__main__":
    main()
