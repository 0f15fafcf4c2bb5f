"""Stacks of equal boxes: how far they sink under their weight, and how a stack of soft pads settles, in closed form.

    python make_reference.py        writes the tables and prints the key numbers

Contact i is under box i, counted from the floor, and carries the boxes i to n; with k for all points of one contact,

    depth_i = (n - i + 1) m g / k,      top: sum of all = n (n + 1) / 2 m g / k

Settling: ten boxes that just touch are let go, with k and c = tau k in every contact; as long as all contacts push,

    M x'' + tau K x' + K x = m g,    x = sum_j  v_j q_j(t),    q_j'' + tau w_j^2 q_j' + w_j^2 q_j = v_j . m g

with the frequencies w_j and shapes v_j of a chain of masses and springs. None of the contacts pulls at any time.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

HERE = Path(__file__).resolve().parent
GRAVITY = 9.80665  # m/s^2
MASS, POINT_STIFFNESS, POINTS = 1000.0, 1e9, 4  # kg, N/m, corners of a box
HEIGHTS = (10, 30)  # boxes
# soft pads
SOFT_BOXES, SOFT_STIFFNESS, SOFT_TAU = 10, 4e7, 5e-3  # -, N/m for all four corners, s
TIMES = np.arange(401) / 200  # s
REST_TIMES = np.arange(1.0, 61.0)  # s


def depths(count, stiffness):
    """Depth of each contact at rest [m], from the floor up."""
    return np.arange(count, 0, -1) * MASS * GRAVITY / stiffness


def settling():
    """Way down of each box [m], shape (401, 10), and its rate."""
    n = SOFT_BOXES
    stiffness = SOFT_STIFFNESS * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    stiffness[-1, -1] = SOFT_STIFFNESS
    squares, shapes = eigh(stiffness, MASS * np.eye(n))
    x, v = np.zeros((len(TIMES), n)), np.zeros((len(TIMES), n))
    for square, shape in zip(squares, shapes.T, strict=True):
        rest = shape.sum() * MASS * GRAVITY / square
        # roots of s^2 + tau w^2 s + w^2, complex or real: q = rest (1 + (s2 e^(s1 t) - s1 e^(s2 t)) / (s1 - s2))
        half = 0.5 * SOFT_TAU * square
        root = np.sqrt(complex(half**2 - square))
        s1, s2 = -half + root, -half - root
        e1, e2 = np.exp(s1 * TIMES), np.exp(s2 * TIMES)
        q = rest * (1.0 + ((s2 * e1 - s1 * e2) / (s1 - s2)).real)
        rate = rest * (s1 * s2 * (e1 - e2) / (s1 - s2)).real
        x += q[:, None] * shape
        v += rate[:, None] * shape
    return x, v


def contact_forces():
    """Force in each contact while the soft stack settles [N], shape (401, 10)."""
    x, v = settling()
    squeeze, rate = (np.diff(y, axis=1, prepend=0.0) for y in (x, v))
    return SOFT_STIFFNESS * (squeeze + SOFT_TAU * rate)


def references():
    """Table of each file.

    settling.csv: time [s], way of the lowest and of the highest box down [m], force on the floor [N]; settling_top.csv:
    every 10 ms the height of the centre of the highest box. ten0.csv and so on: boxes at rest on each other.
    """
    x, _ = settling()
    top = SOFT_BOXES - 0.5 - x[::2, -1]
    tables = {
        "settling.csv": np.column_stack([TIMES, x[:, 0], x[:, -1], contact_forces()[:, 0]]),
        "settling_top.csv": np.column_stack([TIMES[::2], top]),
    }
    for name, count, x_stack in (("ten", 10, -10.0), ("thirty", 30, 0.0)):
        for box in (0, count - 1):
            place = np.tile([x_stack, 0.0, box + 0.5], (len(REST_TIMES), 1))
            tables[f"{name}{box}.csv"] = np.column_stack([REST_TIMES, place])
    return tables


HEADS = {"settling.csv": "time,lowest,highest,floor_force", "settling_top.csv": "time,z"}


def main():
    """Write the tables and print the numbers of the README."""
    for name, table in references().items():
        rows = [HEADS.get(name, "time,x,y,z")]
        rows += [",".join(f"{value:.15g}" for value in row) for row in table]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    for count in HEIGHTS:
        sunk = depths(count, POINTS * POINT_STIFFNESS)
        sys.stdout.write(
            f"{count} boxes on {POINTS} x {POINT_STIFFNESS:.0e} N/m: lowest contact {sunk[0]:.9e} m, "
            f"top {sunk.sum():.9e} m, force on the floor {count * MASS * GRAVITY:.3f} N\n"
        )
    forces = contact_forces()
    sys.stdout.write(
        f"soft stack: top at rest {depths(SOFT_BOXES, SOFT_STIFFNESS).sum():.9f} m, "
        f"deepest {settling()[0][:, -1].max():.9f} m; largest force on the floor {forces[:, 0].max():.3f} N; "
        f"least force in any contact after the start {forces[1:].min():.3e} N\n"
    )


if __name__ == "__main__":
    main()
