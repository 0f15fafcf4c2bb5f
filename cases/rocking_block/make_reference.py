"""Free rocking of a rigid block on a rigid floor (Housner, Bull. Seismol. Soc. Am. 53, 1963, 403-417).

    python make_reference.py        writes the tables and prints times, ratios and the friction that it takes

A block of 2b x 2h stands on an edge, tilted by theta > 0 over its right edge or theta < 0 over its left one, and
neither slips nor leaves it. With R = sqrt(b^2 + h^2), tan(alpha) = b / h, I = 4/3 m R^2 about an edge, p^2 = m g R / I,

    theta'' = -p^2 sign(theta) sin(alpha - |theta|)
    1/2 theta'^2 + p^2 cos(alpha - |theta|) = const           between impacts
    theta'(after) = r theta'(before),  r = 1 - 3/2 sin(alpha)^2        as theta passes 0

r is what the conservation of angular momentum about the new edge gives if nothing pushes on the old one. For small
angles theta'' = -p^2 (alpha - theta), and with phi = theta / alpha a swing from rest at phi_0 returns to 0 in

    T/4 = arcosh(1 / (1 - phi_0)) / p,        phi_n = 1 - sqrt(1 - r^(2n) (1 - (1 - phi_0)^2)) after n impacts

Here the arcs are integrated without that approximation, by DOP853 from impact to impact.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

HERE = Path(__file__).resolve().parent
GRAVITY = 9.81  # m/s^2
HALF_WIDTH, HALF_HEIGHT = 0.25, 1.0  # b, h, m
START = 0.6  # phi_0
DURATION = 6.0
TIMES = np.arange(301) / 50

RADIUS = np.hypot(HALF_WIDTH, HALF_HEIGHT)
ALPHA = np.arctan2(HALF_WIDTH, HALF_HEIGHT)
RATE = np.sqrt(0.75 * GRAVITY / RADIUS)  # p, 1/s
RATIO = 1.0 - 1.5 * np.sin(ALPHA) ** 2  # r


def swing(rate, t0):
    """Arc over the right edge that leaves 0 with a rate > 0, or begins at the start: solution, end, rate there."""
    y0 = [START * ALPHA, 0.0] if rate == 0.0 else [0.0, rate]

    def right(_, y):
        return [y[1], -(RATE**2) * np.sin(ALPHA - y[0])]

    def down(_, y):
        return y[0] if y[1] < 0.0 else 1.0

    down.terminal = True
    found = solve_ivp(
        right, (t0, t0 + 20.0), y0, "DOP853", events=down, rtol=1e-13, atol=1e-15, dense_output=True
    )
    return found.sol, found.t[-1], found.y[1, -1]


def motion():
    """Angle [rad] at `TIMES`, and for each impact its time [s] and the rate before it [rad/s]."""
    theta, impacts = np.zeros_like(TIMES), []
    t, rate, side = 0.0, 0.0, 1.0
    while t < DURATION:
        arc, end, last = swing(rate, t)
        here = (t <= TIMES) & (end > TIMES)
        theta[here] = side * arc(TIMES[here])[0]
        impacts.append((end, side * last))
        t, rate, side = end, RATIO * abs(last), -side
    return theta, [impact for impact in impacts if impact[0] < DURATION]


def centre(theta):
    """Centre of the block [m] (x to the right, z up), 0 where it stands between its edges."""
    side = np.sign(theta)
    tilt = ALPHA - np.abs(theta)  # of the line from the edge to the centre, from the vertical
    x = side * (HALF_WIDTH - RADIUS * np.sin(tilt))
    z = RADIUS * np.cos(tilt)
    return x, z


def references():
    """Table of each file.

    rocking.csv: time [s], angle over the right edge [rad], x and z of the centre [m]; turn.csv and place.csv the same
    as components of the orientation and the position; first_loss.csv: nothing, at times between the first two impacts.
    """
    theta = motion()[0]
    between = TIMES[(TIMES > 0.6) & (TIMES < 1.48)]
    return {
        "rocking.csv": np.column_stack([TIMES, theta, *centre(theta)]),
        "turn.csv": np.column_stack([TIMES, np.cos(0.5 * theta), np.sin(0.5 * theta)]),
        "place.csv": np.column_stack([TIMES, *centre(theta)]),
        "first_loss.csv": np.column_stack([between, np.zeros_like(between)]),
    }


def quarter_period(phi):
    """Time from rest at phi alpha to the first impact [s], without approximation, by the integral of energy."""
    theta0 = phi * ALPHA
    # theta = theta0 (1 - u^2) takes the singularity at rest away
    level = np.cos(ALPHA - theta0)

    def integrand(u):
        theta = theta0 * (1.0 - u * u)
        fall = np.cos(ALPHA - theta0 + (theta0 - theta)) - level
        return 2.0 * theta0 * u / (RATE * np.sqrt(-2.0 * fall)) if u > 0.0 else 0.0

    return quad(integrand, 1e-9, 1.0, epsabs=1e-12)[0]


def apexes(count):
    """Largest |theta| / alpha after n impacts, n = 0 .. count, without approximation."""
    phi = [START]
    for _ in range(count):
        # half the square of the rate at 0 over p^2, times r^2
        drop = RATIO**2 * (np.cos(ALPHA - phi[-1] * ALPHA) - np.cos(ALPHA))
        phi.append(brentq(lambda q, drop=drop: np.cos(ALPHA - q * ALPHA) - np.cos(ALPHA) - drop, 0.0, START))
    return np.array(phi)


def friction_needed():
    """Largest ratio of horizontal to vertical force on the edge, while rocking and at the impacts."""
    theta = np.linspace(0.0, START * ALPHA, 2001)
    tilt = ALPHA - theta
    square = 2.0 * RATE**2 * (np.cos(ALPHA - START * ALPHA) - np.cos(tilt))  # of the rate
    turn = -(RATE**2) * np.sin(tilt)
    # of the centre seen from the edge: x = -R sin(tilt), z = R cos(tilt), tilt' = -theta'
    ax = RADIUS * (np.cos(tilt) * turn + np.sin(tilt) * square)
    az = RADIUS * (np.sin(tilt) * turn - np.cos(tilt) * square)
    rocking = np.abs(ax / (GRAVITY + az)).max()
    return rocking, HALF_HEIGHT / HALF_WIDTH * (1.0 - RATIO) / (1.0 + RATIO), (GRAVITY + az).min() / GRAVITY


HEADS = {
    "rocking.csv": "time,angle,x,z",
    "turn.csv": "time,q0,q2",
    "place.csv": "time,x,z",
    "first_loss.csv": "time,value",
}


def main():
    """Write the tables and print the numbers of the README."""
    for name, table in references().items():
        rows = [HEADS[name], *(",".join(f"{value:.15g}" for value in row) for row in table)]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    _, impacts = motion()
    first = np.arccosh(1.0 / (1.0 - START)) / RATE
    sys.stdout.write(f"alpha {ALPHA:.9f} rad, R {RADIUS:.9f} m, p {RATE:.9f} 1/s, r {RATIO:.9f}\n")
    sys.stdout.write(
        f"start {START * ALPHA:.12f} rad, centre {centre(np.array(START * ALPHA))}; first impact: small angles "
        f"{first:.6f} s, quadrature {quarter_period(START):.9f} s, DOP853 {impacts[0][0]:.9f} s\n"
    )
    n = np.arange(len(impacts) + 1)
    housner = 1.0 - np.sqrt(1.0 - RATIO ** (2 * n) * (1.0 - (1.0 - START) ** 2))
    for k, (time, rate) in enumerate(impacts):
        sys.stdout.write(
            f"impact {k + 1} at {time:.6f} s, rate before {rate:+.9f} rad/s; "
            f"apex {apexes(len(n))[k + 1]:.6f} alpha, small angles {housner[k + 1]:.6f}\n"
        )
    rocking, impact, lightest = friction_needed()
    sys.stdout.write(
        f"friction needed: {rocking:.4f} while rocking, {impact:.4f} at impacts; "
        f"least normal force {lightest:.4f} m g\n"
    )


if __name__ == "__main__":
    main()
