"""A hydrodynamic database in closed form: no hull has it, but memory, damping and added mass belong to each other.

K(t) = k (1 - a t) exp(-a t)
B(omega) = k 2 a omega^2 / (a^2 + omega^2)^2,    A(omega) = A_inf + k (a^2 - omega^2) / (a^2 + omega^2)^2
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

if TYPE_CHECKING:
    from pathlib import Path

MASS = 1.23e6
"""Displaced [kg]."""
RATE = 0.8
"""a [1/s]."""


def smooth_database(**changes: object) -> HydrodynamicDatabase:
    """Of a barge of 40 x 15 m with 2 m draft in 50 m of water; long-wave excitation, which fades at short waves."""
    omega = np.linspace(0.1, 4.0, 40)
    headings = np.deg2rad(np.arange(0.0, 181.0, 10.0))
    scale = np.array([1.0, 1.0, 1.0, 30.0, 130.0, 150.0]) * MASS
    added = np.diag([0.1, 0.4, 1.5, 0.6, 1.2, 0.5]) @ np.diag(scale)
    bell = 2.0 * RATE * omega**2 / (RATE**2 + omega**2) ** 2
    above = (RATE**2 - omega**2) / (RATE**2 + omega**2) ** 2
    kernel = 0.1 * added
    damping = bell[:, None, None] * kernel
    fade = np.exp(-((omega / 1.5) ** 4))
    push = -1j * omega**2 * fade * MASS
    zero = np.zeros((len(omega), len(headings)))
    lift = np.outer(1025.0 * 9.81 * 600.0 * fade, np.ones(len(headings)))
    excitation = np.stack(
        [
            1.1 * np.outer(push, np.cos(headings)),
            1.4 * np.outer(push, np.sin(headings)),
            lift,
            zero,
            zero,
            zero,
        ],
        axis=2,
    )
    given: dict[str, object] = {
        "bodies": ("hull",),
        "omega": omega,
        "headings": headings,
        "added_mass": added + above[:, None, None] * kernel,
        "damping": damping,
        "added_mass_infinite": added,
        "excitation": excitation.astype(np.complex128),
        "reference_points": np.zeros((1, 3)),
        "density": 1025.0,
        "gravity": 9.81,
        "depth": 50.0,
        "source": "smooth functions",
        "symmetric": True,
    }
    return HydrodynamicDatabase(**{**given, **changes})  # type: ignore[arg-type]


def write_smooth_database(file: Path) -> None:
    """The database as a netCDF file."""
    write_netcdf(file, smooth_database())
