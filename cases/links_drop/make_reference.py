"""Links joined by ball joints that drop on a plate: first blow, and the motion of two links of a roof, by mechanics.

    python make_reference.py        writes the tables and prints the blows

Links are bars of 10 m, 0.5 m x 0.5 m, 1 t, with their joints on the axis at their ends; no friction, no rebound.

**Blow on a chain.** A straight chain falls without turning, tilted by theta, and the lower edge of its lower end meets
the plate. With the velocities v of all links, the joints J and the edge n,

    M (v+ - v-) = J' L + n' P,   J v+ = 0,   n v+ = 0,   v- = (0, -v0, 0) for each link

**Roof.** Two links lean on each other under the same tilt and fall on both ends at once; the joint stays over the
middle. One coordinate is left, the tilt theta: with s = L / 2, half the thickness b, and the edge on the plate,

    x = s cos(theta),   z = s sin(theta) + b cos(theta)        of the centre of a link
    A theta'' + 1/2 A' theta'^2 = -m g z',   A(theta) = m (x'^2 + z'^2) + I,   ' by theta
    theta'(after) = -m v0 z' / A             of the first blow; P = m (z' theta'(after) + v0) at each end

until the links lie flat.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import quad, solve_ivp

HERE = Path(__file__).resolve().parent
GRAVITY = 9.81  # m/s^2
LENGTH, THICKNESS, MASS = 10.0, 0.5, 1000.0  # m, m, kg
INERTIA = MASS * (LENGTH**2 + THICKNESS**2) / 12.0  # about an axis across
DROP = 1.0  # m, of the lowest edge
TILTS, CHAINS = (10, 30), (2, 5)  # degrees, links
INTERVAL = 5e-3  # s, of the tables
FALL, SPEED = np.sqrt(2.0 * DROP / GRAVITY), np.sqrt(2.0 * GRAVITY * DROP)
HALF, LIFT = 0.5 * LENGTH, 0.5 * THICKNESS  # s, b


def blow(count, tilt):
    """Impulse of the plate [N s] and rates after it (x, z, anticlockwise), shape (count, 3), of a falling chain."""
    u = np.array([np.cos(tilt), np.sin(tilt)])  # up along the chain
    down = np.array([u[1], -u[0]])
    n = 3 * count
    mass = np.tile([MASS, MASS, INERTIA], count)
    rows = np.zeros((2 * count - 1, n))

    def velocity_of(link, r):
        """Rows of the velocity of a point of a link, r from its centre."""
        block = np.zeros((2, n))
        block[:, 3 * link : 3 * link + 3] = [[1.0, 0.0, -r[1]], [0.0, 1.0, r[0]]]
        return block

    for i in range(count - 1):
        rows[2 * i : 2 * i + 2] = velocity_of(i, HALF * u) - velocity_of(i + 1, -HALF * u)
    rows[-1] = velocity_of(0, -HALF * u + LIFT * down)[1]
    before = np.tile([0.0, -SPEED, 0.0], count)
    system = rows / mass @ rows.T
    impulses = np.linalg.solve(system, -rows @ before)
    after = before + (rows.T @ impulses) / mass
    return impulses[-1], after.reshape(-1, 3)


def partials(theta):
    """First and second derivatives of the place of the centre by the tilt."""
    c, s = np.cos(theta), np.sin(theta)
    return (-HALF * s, HALF * c - LIFT * s), (-HALF * c, -HALF * s - LIFT * c)


def roof_rate(theta):
    """Rate of the tilt after the first blow [rad/s], and the impulse at each end [N s]."""
    (x1, z1), _ = partials(theta)
    rate = -MASS * SPEED * z1 / (MASS * (x1**2 + z1**2) + INERTIA)
    return rate, MASS * (z1 * rate + SPEED)


def roof(tilt):
    """Solution, time from the release until the links lie flat [s], rate then [rad/s] and least force at an end [N]."""

    def right(_, y):
        (x1, z1), (x2, z2) = partials(y[0])
        inertia = MASS * (x1**2 + z1**2) + INERTIA
        return [y[1], -MASS * (GRAVITY * z1 + (x1 * x2 + z1 * z2) * y[1] ** 2) / inertia]

    def flat(_, y):
        return y[0]

    flat.terminal = True
    found = solve_ivp(
        right,
        (FALL, FALL + 10.0),
        [tilt, roof_rate(tilt)[0]],
        "DOP853",
        events=flat,
        rtol=1e-13,
        atol=1e-14,
        dense_output=True,
    )
    forces = []
    for y in found.sol(np.linspace(FALL, found.t[-1], 2001)).T:
        (_, z1), (_, z2) = partials(y[0])
        forces.append(MASS * (GRAVITY + z1 * right(0.0, y)[1] + z2 * y[1] ** 2))
    return found.sol, found.t[-1], found.y[1, -1], min(forces)


def flat_by_energy(tilt):
    """The same time by an integral of the energy [s]."""

    def parts(theta):
        (x1, z1), _ = partials(theta)
        return MASS * (x1**2 + z1**2) + INERTIA, MASS * GRAVITY * (
            HALF * np.sin(theta) + LIFT * np.cos(theta)
        )

    inertia, potential = parts(tilt)
    energy = 0.5 * inertia * roof_rate(tilt)[0] ** 2 + potential

    def slowness(theta):
        a, v = parts(theta)
        return np.sqrt(a / (2.0 * (energy - v)))

    return FALL + quad(slowness, 0.0, tilt, epsabs=1e-13)[0]


def joint_height(theta):
    """Of the joint over the plate while the ends are on it [m]."""
    return LENGTH * np.sin(theta) + LIFT * np.cos(theta)


def references():
    """Table of each file.

    roof10.csv and roof30.csv: time from the release [s], tilt [rad] and height of the joint [m] until the links lie
    flat; ridge10.csv and ridge30.csv: the height alone; first_blow.csv: nothing, before and just after the first blow.
    """
    tables = {"first_blow.csv": np.array([[0.0, 0.0], [0.455, 0.0]])}
    for degrees in TILTS:
        tilt = np.radians(degrees)
        path, end, _, _ = roof(tilt)
        t = np.arange(int(end / INTERVAL) + 1) * INTERVAL
        falling = t < FALL
        theta = np.where(falling, tilt, path(np.maximum(t, FALL))[0])
        height = np.where(falling, joint_height(tilt) + DROP - 0.5 * GRAVITY * t**2, joint_height(theta))
        tables[f"roof{degrees}.csv"] = np.column_stack([t, theta, height])
        tables[f"ridge{degrees}.csv"] = np.column_stack([t, height])
    return tables


def main():
    """Write the tables and print the numbers of the README."""
    for name, table in references().items():
        head = {2: "time,value" if name == "first_blow.csv" else "time,z", 3: "time,tilt,joint_height"}
        rows = [head[table.shape[1]], *(",".join(f"{value:.15g}" for value in row) for row in table)]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    sys.stdout.write(f"first touch after {FALL:.9f} s at {SPEED:.9f} m/s\n")
    for count in CHAINS:
        for degrees in TILTS:
            impulse, after = blow(count, np.radians(degrees))
            speed = np.array([MASS, MASS, INERTIA]) * after**2
            lost = 1.0 - speed.sum() / (count * MASS * SPEED**2)
            sys.stdout.write(
                f"chain of {count}, {degrees} deg: impulse {impulse:.6f} N s, energy lost {lost:.6f}, "
                f"rate of the lowest link {after[0, 2]:.9f} rad/s\n"
            )
    for degrees in TILTS:
        tilt = np.radians(degrees)
        rate, impulse = roof_rate(tilt)
        _, end, last, least = roof(tilt)
        sys.stdout.write(
            f"roof, {degrees} deg: impulse {impulse:.6f} N s at each end, rate {rate:.9f} rad/s; flat after "
            f"{end:.9f} s (by energy {flat_by_energy(tilt):.9f} s) at {last:.9f} rad/s; least force {least:.1f} N\n"
        )


if __name__ == "__main__":
    main()
