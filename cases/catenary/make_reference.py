"""Reference of the catenary case: lengths of three chains on the seabed, and two lines that hang free.

A chain that lies down, weight w an unstretched length, force (H, V) at the fairlead, length LB on the seabed, friction
mu:

    z = (sqrt(H^2 + V^2) - H) / w + V^2 / (2 EA w),                                   T^2 = H^2 + V^2
    x = LB + (H/w) asinh(V/H) + H (V/w) / EA + int_0^LB max(H - mu w s, 0) ds / EA,   L = LB + V / w

With T, x and z given, the first is solved for H and the second for LB. The hanging lines satisfy

    sinh(u) / u = sqrt(S^2 - h^2) / b,   u = q b / (2 H),   V = (q / 2) (h coth(u) + S).

    python make_reference.py        writes lengths.csv and hanging.csv
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

GRAVITY = 9.81
TENSION = 5.0e3 * GRAVITY
CHAINS = ((19.1, 215_893e3, 12.0, 400.0), (18.0, 213_622e3, 15.0, 300.0), (22.8, 270_375e3, 11.0, 350.0))
"""Weight in water [kgf/m], EA [N], depth [m], span [m]."""
FRICTIONS = (0.0, 0.5, 1.0)
HANGING = ((100.0, 60.0, 118.0, 2000.0), (100.0, 80.0, 129.0, 2000.0))
"""Span b, height h, length S [m], weight q [N/m]."""


def chain(
    w: float, EA: float, depth: float, span: float, friction: float
) -> tuple[float, float, float, float, float]:
    """Length, length on the seabed [m], H, V and tension at the anchor [N]."""

    def height(H: float) -> float:
        V = math.sqrt(TENSION**2 - H**2)
        return (TENSION - H) / w + V**2 / (2 * EA * w) - depth

    H = brentq(height, 1e-6 * TENSION, TENSION * (1 - 1e-12), xtol=1e-9, rtol=1e-15)
    V = math.sqrt(TENSION**2 - H**2)

    def reach(lying: float) -> float:
        pulled = lying if friction == 0.0 else min(lying, H / (friction * w))
        stretch = pulled * (H - 0.5 * friction * w * pulled) / EA
        return lying + H / w * math.asinh(V / H) + H * V / (w * EA) + stretch - span

    lying = brentq(reach, 0.0, span, xtol=1e-12, rtol=1e-15)
    return lying + V / w, lying, H, V, max(H - friction * w * lying, 0.0)


def hanging(span: float, height: float, length: float, weight: float) -> tuple[float, float]:
    """H and V at the upper end of an inextensible line [N]."""
    r = math.sqrt(length**2 - height**2) / span
    u = brentq(lambda u: math.sinh(u) / u - r, 1e-9, 20.0, xtol=1e-15, rtol=1e-15)
    return weight * span / (2 * u), weight / 2 * (height / math.tanh(u) + length)


def references() -> dict[str, np.ndarray]:
    """Both tables by name of their files."""
    chains = [
        (weight * GRAVITY, EA, depth, span, friction, *chain(weight * GRAVITY, EA, depth, span, friction))
        for weight, EA, depth, span in CHAINS
        for friction in FRICTIONS
    ]
    return {
        "lengths.csv": np.array(chains),
        "hanging.csv": np.array([(*line, *hanging(*line)) for line in HANGING]),
    }


def main() -> None:
    """Write both tables."""
    heads = {
        "lengths.csv": (
            "# elastic catenaries on a flat seabed, 49050 N at the fairlead: make_reference.py",
            "weight,axial_stiffness,depth,span,friction,length,seabed_length,horizontal,vertical,anchor_tension",
        ),
        "hanging.csv": (
            "# inextensible lines that hang free, eq. 229: make_reference.py",
            "span,height,length,weight,horizontal,vertical",
        ),
    }
    for name, table in references().items():
        rows = [",".join(f"{value:.12g}" for value in row) for row in table]
        (Path(__file__).resolve().parent / name).write_text("\n".join([*heads[name], *rows]) + "\n")


if __name__ == "__main__":
    main()
