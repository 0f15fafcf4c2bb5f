"""Jump of the normal force where the ball crosses the seam, and at other places of the ring, from the results of a run.

    heavylift run cases/ball_on_ring && python cases/ball_on_ring/measure_seam.py

Polynomials of degree 4 through the records 15 ms before and after a crossing give two values at the crossing; what they
differ by is the jump.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from heavylift.pipeline import load_results

HERE = Path(__file__).resolve().parent
WINDOW, DEGREE, SETTLED = 15e-3, 4, 0.4  # s, -, s
KNOTS = 96
PLACES = {"seam": (0.0,), "other knots": (-2.0, -1.0, 1.0, 2.0), "between knots": (-1.5, -0.5, 0.5, 1.5)}


def jumps(time, force, place, level):
    """Relative jumps of the force at all crossings of one place after the start has died away."""
    found = []
    for i in np.flatnonzero(np.diff(np.sign(place - level))):
        crossing = time[i] + (level - place[i]) / (place[i + 1] - place[i]) * (time[i + 1] - time[i])
        if crossing < SETTLED or crossing + WINDOW > time[-1]:
            continue
        sides = []
        for sign in (-1.0, 1.0):
            away = sign * (time - crossing)
            chosen = (away > 1e-9) & (away < WINDOW)
            fit = np.polyfit((time[chosen] - crossing) / WINDOW, force[chosen], DEGREE)
            sides.append(fit[-1])
        found.append((sides[1] - sides[0]) / force[i])
    return found


def main():
    """Print the largest jump at each kind of place, for each contact."""
    results = load_results(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "out")
    for contact in ("touch", "touch_seam_up", "touch_stiff"):
        u = results[f"{contact}.coordinate"][:, 0]
        shift = 0.5 if contact == "touch_seam_up" else 0.0  # the bottom is half way round there
        place = KNOTS * ((u - shift + 0.5) % 1.0 - 0.5)
        force = results[f"{contact}.normal_force"]
        for name, levels in PLACES.items():
            largest = max(abs(j) for level in levels for j in jumps(results.time, force, place, level))
            bottom = "bottom" if name == "seam" and shift else name
            sys.stdout.write(f"{contact:14} {bottom:14} {largest:.1e}\n")


if __name__ == "__main__":
    main()
