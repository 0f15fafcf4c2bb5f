"""Computes two_barges.nc: two barges of 60 x 20 m, 3 m draft, end to end, 6 m apart (needs `heavylift[hydro]`).

The water in the gap resonates at 1.3 rad/s, a wave across the gap between its open sides; the next resonance, with half
a wave along the gap too, is near sqrt(g k) = 2.32 rad/s, k = pi sqrt(1/6^2 + 1/20^2), beyond the table. A gap of 8 m
would have it at 2.05 rad/s, with a peak too narrow for steps of 0.05 rad/s; one of 4 m makes the first peak narrow.
Potential flow has no losses at edges: forces near 1.3 rad/s are larger than in nature.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from heavylift.preprocess.hydrodynamics.bem import BemInputs, compute_database, database_digest
from heavylift.preprocess.hydrodynamics.hull_panels import box_panels
from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

CENTRES = (-33.0, 33.0)  # of the hulls along x [m]: half a length and half the gap from the origin


def database_inputs() -> BemInputs:
    """2 x 320 panels of 2.5 m and lids; 44 frequencies; 19 headings, the other side by symmetry."""
    hull = box_panels(60.0, 20.0, 3.0, 2.5)
    return BemInputs(
        hulls=tuple(
            hull.translated(x, 0.0, name=name) for x, name in zip(CENTRES, ("aft", "fore"), strict=True)
        ),
        omega=0.05 * np.arange(1, 45),
        headings=np.deg2rad(np.arange(0.0, 181.0, 10.0)),
        reference_points=np.array([[x, 0.0, 0.0] for x in CENTRES]),
        symmetric=True,
    )


if __name__ == "__main__":
    inputs = database_inputs()
    database = compute_database(inputs, warn=lambda text: sys.stderr.write(f"{text}\n"))
    write_netcdf(Path(__file__).parent / "two_barges.nc", database, digest=database_digest(inputs))
