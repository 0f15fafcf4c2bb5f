"""Computes crane.nc: a hull of 182 x 70 m, 4 m draft, deep water (needs `heavylift[hydro]`)."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from heavylift.preprocess.hydrodynamics.bem import BemInputs, compute_database, database_digest
from heavylift.preprocess.hydrodynamics.hull_panels import box_panels
from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf


def database_inputs() -> BemInputs:
    """Panels of 4 m and a lid; 52 frequencies to 2.6 rad/s; 19 headings, the other side by symmetry."""
    return BemInputs(
        hulls=(box_panels(182.0, 70.0, 4.0, 4.0, name="crane"),),
        omega=0.05 * np.arange(1, 53),
        headings=np.deg2rad(np.arange(0.0, 181.0, 10.0)),
        reference_points=np.zeros((1, 3)),
        symmetric=True,
    )


if __name__ == "__main__":
    inputs = database_inputs()
    database = compute_database(inputs, warn=lambda text: sys.stderr.write(f"{text}\n"))
    write_netcdf(Path(__file__).parent / "crane.nc", database, digest=database_digest(inputs))
