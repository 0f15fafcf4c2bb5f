"""Reference of a body that slides and turns on an inclined plane: a parabola and a steady turn.

In the plane gravity is g sin(slope) downhill and has no moment about the centre of mass, whatever the
products of inertia are: they only load the plane. With the axes e1 downhill, e2 level, n up from the plane,

    c(t) = c0 + v t + 1/2 g sin(slope) t^2 e1,   angle = w t about n,   normal force m g cos(slope) n.

    python make_reference.py        writes the tables and prints the start
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.81
MASS = 3.0
SLOPE = np.radians(25.0)
CENTRE = np.array([0.1, -0.05, 0.2])
VELOCITY = np.array([0.2, 0.8, 0.0])  # of the centre of mass, in the axes of the plane
SPIN = 3.0
CORNER = np.array([0.3, 0.2, 0.1])
DURATION = 2.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]

# columns e1, e2, n in world axes
PLANE = np.array([[np.cos(SLOPE), 0.0, np.sin(SLOPE)], [0.0, 1.0, 0.0], [-np.sin(SLOPE), 0.0, np.cos(SLOPE)]])


def references() -> dict[str, Array]:
    """Tables of time [s] and place of a corner [m] or force of the plane [N], shape (101, 4)."""
    downhill = 0.5 * GRAVITY * np.sin(SLOPE) * np.outer(TIMES**2, [1.0, 0.0, 0.0])
    centre = CENTRE + np.outer(TIMES, VELOCITY) + downhill
    c, s = np.cos(SPIN * TIMES), np.sin(SPIN * TIMES)
    x, y, z = CORNER - CENTRE
    arm = np.column_stack([c * x - s * y, s * x + c * y, np.full(101, z)])
    force = np.tile(MASS * GRAVITY * np.cos(SLOPE) * PLANE[:, 2], (101, 1))
    return {
        "corner.csv": np.column_stack([TIMES, (centre + arm) @ PLANE.T]),
        "force.csv": np.column_stack([TIMES, force]),
    }


def main() -> None:
    """Write the tables and print the start."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    origin = PLANE @ (VELOCITY - np.cross([0.0, 0.0, SPIN], CENTRE))
    sys.stdout.write(f"velocity of the origin of the body: {origin.tolist()} m/s\n")


if __name__ == "__main__":
    main()
