"""Makes sphere.nc: a sphere of 5 m radius, half of it in deep water, from Hulme's table of a heaving hemisphere.

`hulme.csv` has the damping of heave from ka = 0.05 to 10. A spline goes through it; below and above are

    B / (rho V omega) = 3 pi / 4 ka + O(ka^2),    B / (rho V omega) = O(1 / (ka)^4)

(A. Hulme, "The wave forces acting on a floating hemisphere undergoing forced periodic oscillations", J. Fluid Mech.
121, 1982). The added mass at infinite frequency is that of the reference; at others it follows from the damping,

    A(omega) = A_inf + 2/pi int_0^inf (B(x) - B(omega)) / (x^2 - omega^2) dx

(Ogilvie's relation), which is Hulme's added mass within 0.0003 rho V. Surge and sway get the added mass of a sphere in
unbounded water and no damping, roll, pitch and yaw nothing, and there is no excitation: nothing but heave is used.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import simpson
from scipy.interpolate import CubicSpline

from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
from heavylift.preprocess.hydrodynamics.netcdf_files import write_netcdf

HERE = Path(__file__).parent
RADIUS, DENSITY, GRAVITY = 5.0, 1000.0, 9.81
DISPLACED = DENSITY * 2.0 / 3.0 * np.pi * RADIUS**3
ADDED_MASS_INFINITE = 130876.8
HEAVE = 2


def table() -> np.ndarray:
    """ka, A / (rho V), B / (rho V omega)."""
    return np.loadtxt(HERE / "hulme.csv", delimiter=",", skiprows=2)[:, :3]


def heave_damping(omega: np.ndarray) -> np.ndarray:
    """[kg/s]."""
    ka, _, damping = table().T
    curve = CubicSpline(
        np.append(0.0, ka), np.append(0.0, damping), bc_type=((1, 0.75 * np.pi), "not-a-knot")
    )
    x = omega**2 * RADIUS / GRAVITY
    inside = np.minimum(x, ka[-1])
    return DISPLACED * omega * curve(inside) * (inside / np.maximum(x, inside)) ** 4


def heave_added_mass(omega: np.ndarray) -> np.ndarray:
    """[kg]."""
    highest = 100.0
    x = np.linspace(0.0, highest, 40001) + 1e-9  # none of them is one of the frequencies
    B, found = heave_damping(x), []
    for w, damping in zip(omega, heave_damping(omega), strict=True):
        beyond = -damping / (2.0 * w) * np.log((highest + w) / (highest - w))
        found.append(simpson((B - damping) / (x * x - w * w), x=x) + beyond)
    return ADDED_MASS_INFINITE + 2.0 / np.pi * np.array(found)


def sphere() -> HydrodynamicDatabase:
    """800 frequencies to ka = 40, 19 headings."""
    ka = 40.0 * np.linspace(0.0, 1.0, 801)[1:] ** 2
    omega = np.sqrt(GRAVITY * ka / RADIUS)
    headings = np.deg2rad(np.arange(0.0, 181.0, 10.0))
    A, B, A_inf = np.zeros((len(ka), 6, 6)), np.zeros((len(ka), 6, 6)), np.zeros((6, 6))
    A[:, :HEAVE, :HEAVE] = A_inf[:HEAVE, :HEAVE] = 0.5 * DISPLACED * np.eye(HEAVE)
    A[:, HEAVE, HEAVE] = heave_added_mass(omega)
    A_inf[HEAVE, HEAVE] = ADDED_MASS_INFINITE
    B[:, HEAVE, HEAVE] = heave_damping(omega)
    return HydrodynamicDatabase(
        bodies=("sphere",),
        omega=omega,
        headings=headings,
        added_mass=A,
        damping=B,
        added_mass_infinite=A_inf,
        excitation=np.zeros((len(ka), len(headings), 6), dtype=np.complex128),
        reference_points=np.zeros((1, 3)),
        density=DENSITY,
        gravity=GRAVITY,
        depth=np.inf,
        source="Hulme (1982), heave of a hemisphere",
        symmetric=True,
        volumes=np.array([DISPLACED / DENSITY]),
        centres_of_buoyancy=np.array([[0.0, 0.0, -0.375 * RADIUS]]),
    )


if __name__ == "__main__":
    ka, added, _ = table().T
    difference = np.abs(heave_added_mass(np.sqrt(GRAVITY * ka / RADIUS)) / DISPLACED - added)
    place = ka[np.argmax(difference)]
    sys.stdout.write(f"added mass: {difference.max():.4f} rho V from Hulme's at ka = {place:g}\n")
    write_netcdf(HERE / "sphere.nc", sphere())
