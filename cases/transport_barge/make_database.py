"""Computes barge.nc: the transport barge, 97.5 x 36 m, 4.5 m draft, deep water (needs `heavylift[hydro]`)."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from heavylift.preprocess.hydrodynamics.bem import BemInputs, compute_database, database_digest
from heavylift.preprocess.hydrodynamics.hull_panels import box_panels
from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf


def database_inputs() -> BemInputs:
    """648 panels of 3 m and a lid; 60 frequencies; 19 headings, the other side by symmetry."""
    return BemInputs(
        hulls=(box_panels(97.5, 36.0, 4.5, 3.0, name="barge"),),
        omega=0.05 * np.arange(1, 61),
        headings=np.deg2rad(np.arange(0.0, 181.0, 10.0)),
        reference_points=np.zeros((1, 3)),
        symmetric=True,
    )


if __name__ == "__main__":
    inputs = database_inputs()
    database = compute_database(inputs, warn=lambda text: sys.stderr.write(f"{text}\n"))
    write_netcdf(Path(__file__).parent / "barge.nc", database, digest=database_digest(inputs))
