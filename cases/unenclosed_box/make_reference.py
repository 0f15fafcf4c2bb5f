"""A box that falls with its flat bottom on the rim of a wall and tips over it, by an ordinary differential equation.

    python make_reference.py        writes the tables and prints the blow and the end

In the plane across the wall, the rim in the origin, no friction and no rebound. With the tilt phi (to the side of the
centre), the place s of the centre along the bottom, and the half height c,

    n = (sin(phi), cos(phi)),   t = (cos(phi), -sin(phi))
    centre = s t + c n,      (m s^2 + I) phi'' = m g s cos(phi) - m c s phi'^2 - 2 m s s' phi'
    s'' + c phi'' = s phi'^2 + g sin(phi)
    force on the rim = m (g cos(phi) - (2 s' + c phi') phi' - s phi'')
    first blow at s = d, v0: phi' = m d v0 / (m d^2 + I), s' = -c phi', P = m (v0 - d phi')

until the inner edge of the bottom comes to the rim or the force is zero.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

HERE = Path(__file__).resolve().parent
GRAVITY = 9.81  # m/s^2
SIDE, MASS = 0.4, 50.0  # m, kg; a cube
OFFSET, DROP = 0.08, 0.5  # m: of the centre from the wall outward, of the bottom over the rim
INERTIA = MASS * SIDE**2 / 6.0
HALF = 0.5 * SIDE
RIM = (1.0, 1.0)  # m, x and z
INTERVAL, RUN = 1e-3, 0.9  # s: of the tables, of the simulation
FALL, SPEED = np.sqrt(2.0 * DROP / GRAVITY), np.sqrt(2.0 * GRAVITY * DROP)


def accelerations(y):
    """Of s and phi for y = (s, phi, s', phi')."""
    s, phi, sliding, turning = y
    turn = (
        MASS
        * s
        * (GRAVITY * np.cos(phi) - HALF * turning**2 - 2.0 * sliding * turning)
        / (MASS * s**2 + INERTIA)
    )
    return s * turning**2 + GRAVITY * np.sin(phi) - HALF * turn, turn


def force(y):
    """On the rim [N]."""
    s, phi, sliding, turning = y
    turn = accelerations(y)[1]
    return MASS * (GRAVITY * np.cos(phi) - (2.0 * sliding + HALF * turning) * turning - s * turn)


def after_blow():
    """State after the first blow, and its impulse [N s]."""
    turning = MASS * OFFSET * SPEED / (MASS * OFFSET**2 + INERTIA)
    return np.array([OFFSET, 0.0, -HALF * turning, turning]), MASS * (SPEED - OFFSET * turning)


def tipping():
    """Solution from the blow on, its end [s] and why it ends."""

    def corner(_, y):
        return HALF - abs(y[0])

    def gone(_, y):
        return force(y)

    corner.terminal = gone.terminal = True
    found = solve_ivp(
        lambda _, y: [y[2], y[3], *accelerations(y)],
        (FALL, FALL + 5.0),
        after_blow()[0],
        "DOP853",
        events=(corner, gone),
        rtol=1e-13,
        atol=1e-14,
        dense_output=True,
    )
    return found.sol, found.t[-1], "the edge is at the rim" if found.t_events[0].size else "no force"


def place(y):
    """Centre over the rim, outward and up [m]."""
    s, phi = y[:2]
    return s * np.cos(phi) + HALF * np.sin(phi), HALF * np.cos(phi) - s * np.sin(phi)


def free_flight(y, duration):
    """Place of the centre over the rim [m] after a time without force."""
    s, phi, sliding, turning = y
    x, z = place(y)
    out = sliding * np.cos(phi) - s * np.sin(phi) * turning + HALF * np.cos(phi) * turning
    up = -HALF * np.sin(phi) * turning - sliding * np.sin(phi) - s * np.cos(phi) * turning
    return x + out * duration, z + up * duration - 0.5 * GRAVITY * duration**2


def energy(y):
    """Kinetic and potential energy [J]."""
    s, _, sliding, turning = y
    speeds = (sliding + HALF * turning) ** 2 + (s * turning) ** 2
    return 0.5 * MASS * speeds + 0.5 * INERTIA * turning**2 + MASS * GRAVITY * place(y)[1]


def references():
    """Table of each file.

    tipping.csv: time from the release [s], centre outward and up from the rim [m], tilt [rad], force on the rim [N];
    place.csv and turn.csv: the same in the world, whose origin is on the floor of the container; first_blow.csv:
    nothing, before and just after the blow.
    """
    path, end, _ = tipping()
    t = np.arange(int(end / INTERVAL) + 1) * INTERVAL
    y = path(np.maximum(t, FALL))
    x, z = place(y)
    falling = t < FALL
    rows = [
        t,
        np.where(falling, OFFSET, x),
        np.where(falling, HALF + DROP - 0.5 * GRAVITY * t**2, z),
        np.where(falling, 0.0, y[1]),
        np.where(falling, 0.0, force(y)),
    ]
    _, out, up, tilt, _ = rows
    return {
        "tipping.csv": np.column_stack(rows),
        "place.csv": np.column_stack([t, RIM[0] + out, RIM[1] + up]),
        "turn.csv": np.column_stack([t, np.cos(0.5 * tilt), np.sin(0.5 * tilt)]),
        "first_blow.csv": np.array([[0.0, 0.0], [0.32, 0.0]]),
    }


HEADS = {
    "tipping.csv": "time,out,up,tilt,rim_force",
    "place.csv": "time,x,z",
    "turn.csv": "time,q0,q2",
    "first_blow.csv": "time,value",
}


def main():
    """Write the tables and print the numbers of the README."""
    for name, table in references().items():
        rows = [HEADS[name], *(",".join(f"{value:.15g}" for value in row) for row in table)]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    start, impulse = after_blow()
    path, end, why = tipping()
    last = path(end)
    levels = energy(path(np.linspace(FALL, end, 101)))
    sys.stdout.write(
        f"touch after {FALL:.9f} s at {SPEED:.9f} m/s; impulse {impulse:.6f} N s, then {start[3]:.9f} rad/s; "
        f"energy lost {1.0 - (energy(start) - MASS * GRAVITY * HALF) / (0.5 * MASS * SPEED**2):.6f}\n"
        f"free after {end:.9f} s ({why}): centre at {place(last)[0]:.9f}, {place(last)[1]:.9f} m, "
        f"tilt {last[1]:.9f} rad, {last[3]:.9f} rad/s, s = {last[0]:.6f} m, force {force(last):.1f} N; "
        f"energy constant to {np.ptp(levels):.1e} J\n"
        f"in free flight {free_flight(last, RUN - end)[0]:.9f} m outside at {RUN} s\n"
    )


if __name__ == "__main__":
    main()
