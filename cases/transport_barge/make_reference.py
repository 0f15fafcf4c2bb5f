"""Transport barge in waves: its steady motion from the frequency domain, with the data of barge.nc.

    python make_reference.py        writes head.csv, ..., rao.csv and prints the scales of the checks

With exp(-i w t), w the frequency of a wave, b its heading and all matrices about the middle of the water plane,

    xi(w) = (-w^2 (M + A(w)) - i w (B(w) + D) + C + K)^-1 X(w, b)

M: mass; A, B, X: added mass, damping and excitation of the database; C: water plane and weight; K, D: springs and
linear damping. A and B are symmetric in exact arithmetic, those of the panels nearly so: their symmetric parts count
here, as they do in the time domain. Headings between those of the database by cubic splines of real and imaginary part.
The motion is then the sum over the waves of Re a xi exp(-i (w t + eps)).
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np
from scipy.interpolate import CubicSpline

HERE = Path(__file__).resolve().parent
LENGTH, BREADTH, DRAFT, HEIGHT_OF_MASS = 97.5, 36.0, 4.5, 1.5  # m, the last above the water
DENSITY, GRAVITY = 1025.0, 9.81
GYRADII = (0.35 * BREADTH, 0.25 * LENGTH, 0.25 * LENGTH)  # m, about the centre of mass
SURGE_SPRINGS, SWAY_SPRINGS, ARM = 2 * 25e3, 2 * 40e3, 40.0  # N/m, N/m, m
DAMPING = np.diag([1.2e6, 2.3e6, 0.0, 0.0, 0.0, 2.2e9])
HEADINGS = {"head": 0.0, "quartering": 45.0, "beam": 90.0}  # degrees; barges turn to the other side
PLACES = {"head": 0.0, "quartering": 3000.0, "beam": -3000.0}  # y of the barges [m]
TIMES = np.arange(700.0, 827.0)  # s, one period of all waves together, 2 pi / 0.05 s
COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")


def waves():
    """Frequencies [rad/s], amplitudes [m] and phases [rad] from the case."""
    trains = tomllib.loads((HERE / "case.toml").read_text(encoding="utf-8"))["sea"]["waves"]
    assert all(train["height"] == "2 mm" and train.get("direction", 0.0) == 0.0 for train in trains)
    omega = np.array([2.0 * np.pi / train["period"] for train in trains])
    return omega, np.full(len(omega), 0.001), np.array([train["phase"] for train in trains])


def database(omega):
    """Added mass and damping (nw, 6, 6), excitation (nw, nh, 6) at frequencies of barge.nc, and its headings [deg]."""
    with h5py.File(HERE / "barge.nc") as file:
        rows = [int(np.argmin(np.abs(file["omega"][:] - w))) for w in omega]
        assert np.allclose(file["omega"][:][rows], omega, rtol=1e-9)
        assert np.allclose([file["rho"][()], file["g"][()]], [DENSITY, GRAVITY])
        assert not np.any(file["rotation_center"][:])
        assert file.attrs["time_convention"].decode() == "exp(-i omega t)"
        added, damping = file["added_mass"][:][rows], file["radiation_damping"][:][rows]
        real, imaginary = file["excitation_force"][:]
        symmetric = [0.5 * (a + a.transpose(0, 2, 1)) for a in (added, damping)]
        return *symmetric, (real + 1j * imaginary)[rows], np.rad2deg(file["wave_direction"][:])


def operators(omega, heading):
    """xi(w) per metre of amplitude, shape (nw, 6)."""
    added, damping, excitation, headings = database(omega)
    mass = DENSITY * LENGTH * BREADTH * DRAFT
    h = HEIGHT_OF_MASS
    S = np.array([[0.0, -h, 0.0], [h, 0.0, 0.0], [0.0, 0.0, 0.0]])  # S v = c x v
    M = np.zeros((6, 6))
    M[:3, :3] = mass * np.eye(3)
    M[:3, 3:], M[3:, :3] = -mass * S, mass * S
    M[3:, 3:] = mass * (np.diag(np.square(GYRADII)) + S.T @ S)
    weight = mass * GRAVITY
    below = -0.5 * DRAFT - h  # centre of buoyancy less centre of mass
    C = np.zeros((6, 6))
    C[2, 2] = DENSITY * GRAVITY * LENGTH * BREADTH
    C[3, 3] = DENSITY * GRAVITY * LENGTH * BREADTH**3 / 12.0 + weight * below
    C[4, 4] = DENSITY * GRAVITY * BREADTH * LENGTH**3 / 12.0 + weight * below
    K = np.diag([SURGE_SPRINGS, SWAY_SPRINGS, 0.0, 0.0, 0.0, SWAY_SPRINGS * ARM**2])
    X = CubicSpline(headings, excitation, axis=1)(heading)
    w = omega[:, None, None]
    Z = -(w**2) * (M + added) - 1j * w * (damping + DAMPING) + C + K
    return np.linalg.solve(Z, X[:, :, None])[:, :, 0]


def references():
    """All tables: histories of the barges, and rao.csv; printed, the scales of the checks."""
    omega, amplitude, phase = waves()
    tables, columns = {}, [omega]
    for name, heading in HEADINGS.items():
        xi = operators(omega, heading)
        for j in range(6):
            columns += [np.abs(xi[:, j]), np.degrees(np.angle(xi[:, j]))]
        parts = amplitude * np.exp(-1j * (np.outer(TIMES, omega) + phase))
        motion = np.real(parts @ xi)
        rate = np.real(parts @ (-1j * omega[:, None] * xi))
        yaw = -np.deg2rad(heading)
        turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        place = motion[:, :2] @ turn.T + [0.0, PLACES[name]]
        histories = {
            "horizontal": place,
            "heave": motion[:, 2:3],
            "roll": rate[:, 3:4],
            "pitch": rate[:, 4:5],
            "yaw": rate[:, 5:6],
        }
        for what, values in histories.items():
            if np.ptp(values) > 1e-9:
                tables[f"{name}_{what}.csv"] = np.column_stack([TIMES, values])
    moves = np.abs(columns) > 1e-9  # angles of what does not move mean nothing
    for j in range(1, len(columns), 2):
        columns[j], columns[j + 1] = columns[j] * moves[j], columns[j + 1] * moves[j]
    tables["rao.csv"] = np.column_stack(columns)
    return tables


def main() -> None:
    """Write the tables and print the scales."""
    headers = {
        "horizontal": "time,x,y",
        "heave": "time,z",
        "roll": "time,x",
        "pitch": "time,y",
        "yaw": "time,z",
    }
    names = [f"{name}_{c}{what}" for name in HEADINGS for c in COORDINATES for what in ("", "_deg")]
    for file, table in references().items():
        header = headers.get(file[:-4].partition("_")[2], "omega," + ",".join(names))
        np.savetxt(HERE / file, table, "%.12g", ",", header=header, comments="")
    omega, amplitude, _ = waves()
    for name, heading in HEADINGS.items():
        sys.stdout.write(f"{name}: amplitude x largest operator\n")
        size = amplitude[0] * np.abs(operators(omega, heading))
        for coordinate, motion, rate in zip(
            COORDINATES, size.max(axis=0), (omega[:, None] * size).max(axis=0), strict=True
        ):
            sys.stdout.write(f"    {coordinate:6s} {motion:.4e}    rate {rate:.4e}\n")


if __name__ == "__main__":
    main()
