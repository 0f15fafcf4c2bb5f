"""Spectra of irregular waves, of the heave of a barge in them, and of the wind, band by band.

    python make_reference.py        writes bands.csv, spectra.csv and wind_mean.csv and prints the numbers of the checks

JONSWAP, normalised to Hs:  S(w) ~ w^-5 exp(-1.25 (wp/w)^4) g^exp(-(w - wp)^2 / (2 s^2 wp^2)),   s = 0.07, above wp 0.09
Heave:                      S(w) |RAO(w)|^2,   (-w^2 (M + A) - i w (B + D) + C) RAO = X  with the data of barge.nc
Wind, ISO 19901-1 (NPD):    S(f) = 320 (U0/10)^2 (z/10)^0.45 / (1 + F^n)^(5/(3 n)),   n = 0.468, 1/600 to 0.5 Hz,
                            F = 172 f (z/10)^(2/3) (U0/10)^-0.75

The stiffness of the lines is left out: 0.1 % of that of the water plane. A record of the length T of a Gaussian process
has a variance that scatters by sqrt(2 pi int S^2 dw / T), with S in rad/s.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

HERE = Path(__file__).resolve().parent
STATES = ((6.1, 10.47), (1.65, 6.12))  # Hs [m], Tp [s]
GAMMA, HEADING = 3.3, 150.0  # -, degrees
EDGES = np.array([0.6, 0.9, 1.0, 1.1, 1.3, 1.7, 2.5])  # of the peak frequency
SPEED, HEIGHT = 10.0, 10.0  # one-hour mean at 10 m [m/s], m
WIND_EDGES = np.array([1 / 600, 1 / 200, 0.02, 0.08, 0.5])  # Hz
DURATION = 3600.0  # s, of a record, after the ramp of 60 s

LENGTH, BREADTH, DRAFT, HEIGHT_OF_MASS = 97.5, 36.0, 4.5, 1.5  # m, the last above the water
DENSITY, GRAVITY = 1025.0, 9.81
GYRADII = (0.35 * BREADTH, 0.25 * LENGTH, 0.25 * LENGTH)  # m, about the centre of mass
DAMPING = np.diag([1.2e6, 2.3e6, 0.0, 0.0, 0.0, 2.2e9])


def jonswap(height, period):
    """S(w) [m^2 s/rad] with the variance Hs^2 / 16."""
    peak = 2.0 * np.pi / period

    def shape(w):
        width = np.where(w <= peak, 0.07, 0.09) * peak
        return w**-5 * np.exp(-1.25 * (peak / w) ** 4) * GAMMA ** np.exp(-0.5 * ((w - peak) / width) ** 2)

    factor = height**2 / 16.0 / integral(shape, 0.3 * peak, 30.0 * peak, peak)
    return lambda w: factor * shape(w)


def integral(function, low, high, *breaks):
    """Over pieces that end at the breaks."""
    edges = [low, *(b for b in breaks if low < b < high), high]
    return sum(quad(function, a, b, limit=400)[0] for a, b in pairwise(edges))


def heave_operator():
    """|RAO(w)| of heave, by splines of the data over frequency and heading."""
    with h5py.File(HERE / "barge.nc") as file:
        omega, headings = file["omega"][:], np.rad2deg(file["wave_direction"][:])
        added, damping = file["added_mass"][:], file["radiation_damping"][:]
        real, imaginary = file["excitation_force"][:]
        assert np.allclose([file["rho"][()], file["g"][()]], [DENSITY, GRAVITY])
        assert not np.any(file["rotation_center"][:])
        assert file.attrs["time_convention"].decode() == "exp(-i omega t)"
    A, B = (CubicSpline(omega, 0.5 * (a + a.transpose(0, 2, 1))) for a in (added, damping))
    X = CubicSpline(omega, CubicSpline(headings, real + 1j * imaginary, axis=1)(HEADING))
    mass, h = DENSITY * LENGTH * BREADTH * DRAFT, HEIGHT_OF_MASS
    S = np.array([[0.0, -h, 0.0], [h, 0.0, 0.0], [0.0, 0.0, 0.0]])  # S v = c x v
    M = np.zeros((6, 6))
    M[:3, :3] = mass * np.eye(3)
    M[:3, 3:], M[3:, :3] = -mass * S, mass * S
    M[3:, 3:] = mass * (np.diag(np.square(GYRADII)) + S.T @ S)
    below = -0.5 * DRAFT - h
    C = np.zeros((6, 6))
    C[2, 2] = DENSITY * GRAVITY * LENGTH * BREADTH
    C[3, 3] = DENSITY * GRAVITY * LENGTH * BREADTH**3 / 12.0 + mass * GRAVITY * below
    C[4, 4] = DENSITY * GRAVITY * BREADTH * LENGTH**3 / 12.0 + mass * GRAVITY * below
    grid = np.linspace(0.15, 2.9, 2751)
    w = grid[:, None, None]
    Z = -(w**2) * (M + A(grid)) - 1j * w * (B(grid) + DAMPING) + C
    heave = np.linalg.solve(Z, X(grid)[:, :, None])[:, 2, 0]
    return CubicSpline(grid, np.abs(heave))


def npd(f):
    """S(f) [m^2/s^2 per Hz]."""
    n = 0.468
    reduced = 172.0 * f * (HEIGHT / 10.0) ** (2.0 / 3.0) * (SPEED / 10.0) ** -0.75
    return 320.0 * (SPEED / 10.0) ** 2 * (HEIGHT / 10.0) ** 0.45 / (1.0 + reduced**n) ** (5.0 / (3.0 * n))


def spectra():
    """Of each: density, peak, range of integration and edges of its bands [rad/s], and variance."""
    operator, found = heave_operator(), []
    for height, period in STATES:
        peak, wave = 2.0 * np.pi / period, jonswap(height, period)

        def heave(w, wave=wave):
            return wave(w) * operator(w) ** 2

        low, high = 0.45 * peak, min(6.0 * peak, 2.9)
        found.append((wave, peak, low, high, EDGES * peak, height**2 / 16.0))
        found.append((heave, peak, low, high, EDGES * peak, integral(heave, low, high, peak)))
    edges = 2.0 * np.pi * WIND_EDGES

    def wind(w):
        return npd(w / (2.0 * np.pi)) / (2.0 * np.pi)

    total = integral(wind, edges[0], edges[-1], *edges[1:-1])
    return [*found, (wind, edges[1], edges[0], edges[-1], edges, total)]


def squared(spectrum):
    """Its square."""
    return lambda w: spectrum(w) ** 2


def references():
    """bands.csv: number of the spectrum, band and variance, the whole first; spectra.csv; wind_mean.csv."""
    rows = []
    for number, (spectrum, peak, _, _, edges, total) in enumerate(spectra(), start=1):
        rows.append((number, 0.0, 0.0, total))
        rows += [(number, a, b, integral(spectrum, a, b, peak)) for a, b in pairwise(edges)]
    grid = np.linspace(0.3, 2.5, 441)
    times = np.arange(60.0, 3660.1, 5.0)
    return {
        "bands.csv": np.array(rows),
        "spectra.csv": np.column_stack([grid, *(one[0](grid) for one in spectra())]),
        "wind_mean.csv": np.column_stack([times, np.full(len(times), SPEED)]),
    }


def main() -> None:
    """Write the tables and print the numbers of the checks."""
    names = ("elevation_6", "heave_6", "elevation_2", "heave_2", "wind")
    headers = {
        "bands.csv": "spectrum,from_rad_s,to_rad_s,variance",
        "spectra.csv": "omega," + ",".join(names),
        "wind_mean.csv": "time,value",
    }
    for file, table in references().items():
        np.savetxt(HERE / file, table, "%.12g", ",", header=headers[file], comments="")
    for name, (spectrum, peak, low, high, edges, total) in zip(names, spectra(), strict=True):
        inner = (peak,) if name != "wind" else edges[1:-1]
        square = integral(squared(spectrum), low, high, *inner)
        error = np.sqrt(2.0 * np.pi * square / DURATION) / total
        sys.stdout.write(f"{name}: deviation {np.sqrt(total):.6f}, of one record +- {0.5 * error:.2%}\n")


if __name__ == "__main__":
    main()
