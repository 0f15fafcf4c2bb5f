"""Boxes dropped on a plate: bounces between rigid bodies, and one touch of a spring with a damper, in closed form.

    python make_reference.py        writes all tables and prints the key numbers

**Bounces.** Released at the height H, the underside falls for t1 = sqrt(2 H / g); the n-th bounce begins with the
velocity e^n g t1 and lasts 2 e^n t1, its apex is e^(2n) H; for e < 1 the box is at rest from t1 (1 + e) / (1 - e) on.

**Soft touch.** With the depth d below first touch, w^2 = k / m, s = sqrt(1 - zeta^2),

    m d'' = m g - F,   F = k d + c d',   c = 2 zeta sqrt(k m),   d(0) = 0,   d'(0) = v0
    d = g / w^2 + exp(-zeta w t) (A cos(s w t) + B sin(s w t)),   A = -g / w^2,   B = (v0 + zeta w A) / (s w)

until F = 0, which is before the box has come up again: nothing pulls. zeta is the one that leaves the published
velocity at that time.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

HERE = Path(__file__).resolve().parent
GRAVITY = 9.81  # m/s^2
DROP, RESTITUTIONS = 1.0, (0.0, 0.5, 1.0)  # m, -
BOUNCE_TIMES = np.arange(201) / 100  # s
AFTER_FIRST = BOUNCE_TIMES[46:]  # the first impact is at 0.4515 s

# Integrated simulation ... (2018), Table 2-6
MASS, ARRIVAL, DEPARTURE = 10.0, 8.2, 6.5  # kg, m/s, m/s
SOFTNESS = (1, 10, 50)
STIFFNESS_OF_ONE = 5e4  # N/m for a softness of 1; it divides by the softness
PUBLISHED = {1: (0.06, 0.11, 4917.0), 10: (0.17, 0.35, 1722.0), 50: (0.34, 0.84, 842.0)}  # s, m, N


def height(times, restitution):
    """Height of the underside over the plate [m]."""
    fall = np.sqrt(2.0 * DROP / GRAVITY)
    z = np.where(times < fall, DROP - 0.5 * GRAVITY * times**2, 0.0)
    start, speed = fall, restitution * GRAVITY * fall
    while speed > 1e-9 and start < times[-1]:
        t = times - start
        flying = (t >= 0.0) & (t < 2.0 * speed / GRAVITY)
        z = np.where(flying, speed * t - 0.5 * GRAVITY * t**2, z)
        start, speed = start + 2.0 * speed / GRAVITY, restitution * speed
    return z


class Touch(NamedTuple):
    """One touch of a soft plate."""

    stiffness: float  # N/m
    zeta: float
    duration: float  # s, until the force is zero

    @property
    def damping(self):
        """Of the damper [N s/m]."""
        return 2.0 * self.zeta * np.sqrt(self.stiffness * MASS)

    def depth(self, t):
        """Depth [m] and its rate [m/s]."""
        w = np.sqrt(self.stiffness / MASS)
        ws = w * np.sqrt(1.0 - self.zeta**2)
        a = -GRAVITY / w**2
        b = (ARRIVAL + self.zeta * w * a) / ws
        decay, cos, sin = np.exp(-self.zeta * w * t), np.cos(ws * t), np.sin(ws * t)
        swing = a * cos + b * sin
        return decay * swing - a, decay * (ws * (b * cos - a * sin) - self.zeta * w * swing)

    def force(self, t):
        """Force on the box [N]."""
        d, rate = self.depth(t)
        return self.stiffness * d + self.damping * rate

    def peak(self, of):
        """Largest value of a function of time during the touch."""
        t = np.linspace(0.0, self.duration, 2001)
        for _ in range(3):
            i = np.argmax(of(t))
            t = np.linspace(t[max(i - 1, 0)], t[min(i + 1, len(t) - 1)], 2001)
        return float(of(t).max())


def touch(softness, zeta):
    """Touch of a given damping ratio, from first touch to no force."""
    free = Touch(STIFFNESS_OF_ONE / softness, zeta, 0.0)
    half = np.pi / np.sqrt(free.stiffness / MASS)
    t = np.linspace(0.5 * half, 1.5 * half, 400)
    gone = int(np.argmax(free.force(t) < 0.0))
    return free._replace(duration=brentq(free.force, t[gone - 1], t[gone], xtol=1e-15))


def soft_touch(softness):
    """Touch that leaves the published velocity."""

    def miss(zeta):
        trial = touch(softness, zeta)
        return -trial.depth(trial.duration)[1] - DEPARTURE

    return touch(softness, brentq(miss, 0.05, 0.1, xtol=1e-14))


def references():
    """Table of each file.

    bounces_e0.csv and so on: time [s] and height of the underside [m]; soft1.csv and so on: time since the touch,
    depth, velocity down, force (SI), shape (201, 4). plate.csv and touch1.csv and so on: times after the first impact,
    and of a soft touch, with the height of the plate, from which apexes and depths are told.
    """
    tables = {"plate.csv": np.column_stack([AFTER_FIRST, np.zeros_like(AFTER_FIRST)])}
    for name, e in zip(("e0", "e05", "e1"), RESTITUTIONS, strict=True):
        tables[f"bounces_{name}.csv"] = np.column_stack([BOUNCE_TIMES, height(BOUNCE_TIMES, e)])
    for softness in SOFTNESS:
        one = soft_touch(softness)
        t = one.duration * np.arange(201) / 200
        tables[f"soft{softness}.csv"] = np.column_stack([t, *one.depth(t), one.force(t)])
        begin = ARRIVAL / GRAVITY
        steps = np.arange(np.ceil(1e3 * begin), np.floor(1e3 * (begin + one.duration)) + 1.0)
        tables[f"touch{softness}.csv"] = np.column_stack([1e-3 * steps, np.zeros_like(steps)])
    return tables


SOFT_HEAD = "time,depth,velocity,force"


def main():
    """Write the tables and print the numbers of the README."""
    for name, table in references().items():
        rows = [SOFT_HEAD if name.startswith("soft") else "time,z"]
        rows += [",".join(f"{value:.15g}" for value in row) for row in table]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    sys.stdout.write(f"height of fall of the soft boxes {0.5 * ARRIVAL**2 / GRAVITY:.6f} m\n")
    sys.stdout.write(
        "softness   k [N/m]  c [N s/m]       zeta  tau = c/k [s]  duration [s]  depth [m]   peak [N]   mean [N]"
        "  (printed: s, m, N)\n"
    )
    for softness in SOFTNESS:
        one = soft_touch(softness)
        momentum = MASS * (ARRIVAL + DEPARTURE + GRAVITY * one.duration)
        depth, peak = one.peak(lambda t, one=one: one.depth(t)[0]), one.peak(one.force)
        sys.stdout.write(
            f"{softness:8}  {one.stiffness:8.0f}  {one.damping:9.5f}  {one.zeta:.7f}"
            f"  {one.damping / one.stiffness:13.8f}"
            f"  {one.duration:12.6f}  {depth:9.6f}  {peak:9.3f}  {momentum / one.duration:9.3f}"
            f"  {PUBLISHED[softness]}\n"
        )


if __name__ == "__main__":
    main()
