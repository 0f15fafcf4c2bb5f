"""Computes barge.nc and dock.nc: boxes of 97.5 x 36 x 4.5 m and 438 x 84 x 6.2 m under water, deep water.

Each floats by itself, as if the other was not there (needs `heavylift[hydro]`).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from heavylift.preprocess.hydrodynamics.bem import BemInputs, compute_database, database_digest
from heavylift.preprocess.hydrodynamics.hull_panels import box_panels
from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

HULLS = {"barge": (97.5, 36.0, 4.5, 3.0), "dock": (438.0, 84.0, 6.2, 6.0)}
"""Length, breadth, draft and panels [m]."""


def database_inputs(name: str) -> BemInputs:
    """Panels of a hull and a lid; 40 frequencies to 1.6 rad/s; 19 headings, the other side by symmetry."""
    return BemInputs(
        hulls=(box_panels(*HULLS[name], name=name),),
        omega=0.04 * np.arange(1, 41),
        headings=np.deg2rad(np.arange(0.0, 181.0, 10.0)),
        reference_points=np.zeros((1, 3)),
        symmetric=True,
    )


if __name__ == "__main__":
    for hull in HULLS:
        inputs = database_inputs(hull)
        sys.stdout.write(f"{hull}: {sum(len(panels.panels) for panels in inputs.hulls)} panels\n")
        database = compute_database(inputs, warn=lambda text: sys.stderr.write(f"{text}\n"))
        write_netcdf(Path(__file__).parent / f"{hull}.nc", database, digest=database_digest(inputs))
