"""Computes barge.nc: a barge of 182 x 70 m, 5.5 m draft, in 15 m of water (needs `heavylift[hydro]`)."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from heavylift.preprocess.hydrodynamics.bem import BemInputs, compute_database, database_digest
from heavylift.preprocess.hydrodynamics.hull_panels import box_panels
from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf


def database_inputs() -> BemInputs:
    """404 panels of 7 m and a lid; 28 frequencies; 19 headings, the other side by symmetry."""
    return BemInputs(
        hulls=(box_panels(182.0, 70.0, 5.5, 7.0, name="barge"),),
        omega=np.linspace(0.15, 1.5, 28),
        headings=np.deg2rad(np.arange(0.0, 181.0, 10.0)),
        reference_points=np.zeros((1, 3)),
        gravity=9.80665,
        depth=15.0,
        symmetric=True,
    )


if __name__ == "__main__":
    inputs = database_inputs()
    database = compute_database(inputs, warn=lambda text: sys.stderr.write(f"{text}\n"))
    write_netcdf(Path(__file__).parent / "barge.nc", database, digest=database_digest(inputs))
