"""Writes held.csv and expected.csv: strokes and loads by linear theory.

    python make_reference.py

Barge, dock, links and block in the plane, with the block at its place, as eight coordinates

    q = surge, heave, pitch of the barge; of the dock; heave, pitch of the block

with the motions exp(-i w t). Links are plates from the hinge to the edge of the dock's deck. The block goes along with
the decks by its shares on them. The height of a bogie's place over its deck is g_i(q), and what its tyre and its group
make of that is a symmetric matrix F(w)::

    [ -w^2 (M + A) - i w (B + D) + C + J^T F J - sum f_i g_i'' ] q = X(w),     J = g',   s = S(w) (-J q)

J and g'' are difference quotients of the geometry; A, B and X are those of the databases. The load of a bogie f_i is
that at rest. Nothing of the program is used.
"""

from __future__ import annotations

import importlib.util
import math
from functools import lru_cache
from pathlib import Path

import h5py
import numpy as np
from scipy.interpolate import CubicSpline

HERE = Path(__file__).resolve().parent

_SPEC = importlib.util.spec_from_file_location("make_case_block_offloading", HERE / "make_case.py")
case = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(case)
"""What the scene is."""

HEIGHT, PERIOD = 0.1, 10.0
TIMES = np.arange(300.0, 400.1, 0.5)
BOGIES = {33: 17, 73: 0}
"""Of the first and the last row: numbers of bogies and rows."""
TYRE, TYRE_DAMPING, PIPE, OIL = 3e6, 15e3, 20e3, 9.7e6
GAP = case.LENGTH
DOCK = case.dock_x(GAP)
PLANE = [0, 2, 4]
PLACES = np.arange(0.3, 75.0, 1.0)


@lru_cache
def splines(name: str) -> tuple[CubicSpline, CubicSpline, CubicSpline]:
    """Added mass, damping and excitation of surge, heave and pitch, in waves along x."""
    with h5py.File(HERE / f"{name}.nc") as file:
        omega, headings = file["omega"][:], file["wave_direction"][:]
        real, imaginary = file["excitation_force"][:]
        at, pick = int(np.argmin(np.abs(headings))), np.ix_(range(len(omega)), PLANE, PLANE)
        A, B = (file[key][:] for key in ("added_mass", "radiation_damping"))
    A, B = (0.5 * (matrix + matrix.transpose(0, 2, 1))[pick] for matrix in (A, B))
    return (
        CubicSpline(omega, A),
        CubicSpline(omega, B),
        CubicSpline(omega, (real + 1j * imaginary)[:, at][:, PLANE]),
    )


def point_mass(m: float, x: float, z: float) -> np.ndarray:
    """Of a mass at a place, for surge, heave and pitch (bow down) of the reference point."""
    G = np.array([[1.0, 0.0, z], [0.0, 1.0, -x]])
    return m * G.T @ G


def hull_matrices(name: str, time: float) -> tuple[np.ndarray, ...]:
    """Mass with tanks, restoring and damping of a hull at a time."""
    length, breadth, draft = case.BARGE if name == "barge" else case.DOCK
    made = case.floating(name)
    m, inertia, (x, _, z) = made["mass"], made["inertia"][1], made["centre"]
    M = point_mass(m, x, z)
    M[2, 2] += inertia
    moment = m * z
    for place, filling in zip(case.TANKS[name], case.fillings(name, np.array([time]), GAP), strict=True):
        M += point_mass(float(filling[0]), place, case.TANK_HEIGHT)
        moment += float(filling[0]) * case.TANK_HEIGHT
    weight = case.DENSITY * case.GRAVITY * length * breadth
    total = case.DENSITY * length * breadth * draft
    C = np.diag(
        [
            0.01 * total * case.GRAVITY,
            weight,
            weight * (length**2 / 12.0 - 0.5 * draft**2) - case.GRAVITY * moment,
        ]
    )
    return M, C, np.diag(case.damping(name)[PLANE])


def heights(q: np.ndarray, x: float) -> np.ndarray:
    """Of the places of the rows over their decks, shape (18,), and by how much that of the middle is along."""
    u, z, a, v, y, b, heave, pitch = q
    deck = case.DECK

    def on(origin: np.ndarray, angle: float, point: np.ndarray) -> np.ndarray:
        """A point of a body in the world."""
        c, s = math.cos(angle), math.sin(angle)
        return origin + np.array([c * point[0] + s * point[1], -s * point[0] + c * point[1]])

    barge, dock = np.array([u, z]), np.array([DOCK + v, y])
    hinge = on(barge, a, np.array([case.END, deck]))
    # where the link touches the dock's deck, to second order
    edge = case.END + case.LENGTH - DOCK
    end = on(dock, b, np.array([edge, deck]))
    link = -math.asin((end[1] - hinge[1]) / case.LENGTH)
    share = np.clip((x + case.ROWS) > case.END + case.LENGTH, 0.0, 1.0).mean()
    along = (1.0 - share) * (u + deck * a) + share * (v + deck * b)
    base = np.array([x + along, deck + heave])
    out = []
    for row in case.ROWS:
        p = on(base, pitch, np.array([row, 0.0]))
        station = x + row
        if station <= case.END:
            origin, angle, level = barge, a, deck
        elif station <= case.END + case.LENGTH:
            origin, angle, level = hinge, link, 0.0
        else:
            origin, angle, level = dock, b, deck
        d = p - origin
        out.append(d[0] * math.sin(angle) + d[1] * math.cos(angle) - level)
    return np.array(out)


@lru_cache
def derivatives(x: float) -> tuple[np.ndarray, np.ndarray]:
    """First and the sum of second derivatives of the heights, shapes (18, 8) and (8, 8)."""
    h, n = 1e-4, 8
    E = h * np.eye(n)
    J = np.array([(heights(e, x) - heights(-e, x)) / (2.0 * h) for e in E]).T
    H = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            parts = (heights(s * E[i] + t * E[j], x).sum() * s * t for s in (1.0, -1.0) for t in (1.0, -1.0))
            H[i, j] = sum(parts) / (4.0 * h * h)
    return J, H


def respond(x: float, w: float) -> tuple[np.ndarray, np.ndarray]:
    """Strokes [m] and loads of a bogie [N] of all rows, complex, per metre of amplitude, at a place of the way."""
    M, C, D = np.zeros((8, 8)), np.zeros((8, 8)), np.zeros((8, 8))
    A, B, X = np.zeros((8, 8)), np.zeros((8, 8)), np.zeros(8, dtype=complex)
    k = w * w / case.GRAVITY
    for name, at, place in (("barge", slice(0, 3), 0.0), ("dock", slice(3, 6), DOCK)):
        M[at, at], C[at, at], D[at, at] = hull_matrices(name, case.arrival(x))
        A[at, at], B[at, at], force = (spline(w) for spline in splines(name))
        X[at] = force * np.exp(1j * k * place)
    # links: with the hinge, and from its height to that of the dock's edge
    hinge = np.array([0.0, 1.0, -case.END, 0, 0, 0, 0, 0])
    edge = np.array([0, 0, 0, 0.0, 1.0, -(case.END + case.LENGTH - DOCK), 0, 0])
    along = np.array([1.0, 0.0, case.DECK, 0, 0, 0, 0, 0])
    m = 2.0 * case.LINK
    for row, mass in (
        (0.5 * (hinge + edge), m),
        ((hinge - edge) / case.LENGTH, m * (case.LENGTH**2 + 0.25) / 12.0),
        (along, m),
    ):
        M += mass * np.outer(row, row)
    mass, height, inertia = case.block_inertia()
    share = np.clip((x + case.ROWS) > case.END + case.LENGTH, 0.0, 1.0).mean()
    goes = np.array([1.0 - share, 0, (1.0 - share) * case.DECK, share, 0, share * case.DECK, 0, height])
    up, turn = np.eye(8)[6], np.eye(8)[7]
    M += mass * (np.outer(goes, goes) + np.outer(up, up)) + inertia[1] * np.outer(turn, turn)
    C[7, 7] -= mass * case.GRAVITY * height
    J, H = derivatives(x)
    load = mass * case.GRAVITY / len(case.ROWS)
    C -= load * H
    # eight bogies a row; two groups a half
    tyre, pipe = TYRE - 1j * w * TYRE_DAMPING, -1j * w * PIPE
    S = np.eye(18) * tyre / (tyre + pipe)
    F = np.zeros((18, 18), dtype=complex)
    stroke = np.zeros((18, 18), dtype=complex)
    for rows in (slice(0, 9), slice(9, 18)):
        ones = np.ones((9, 9)) / 9.0
        # p = OIL mean(s),  s = (tyre r - p)/(tyre + pipe)
        p = OIL * tyre / (tyre + pipe + OIL) * ones
        stroke[rows, rows] = S[rows, rows] - p / (tyre + pipe)
        F[rows, rows] = 8.0 * (p + pipe * stroke[rows, rows])
    Z = -(w**2) * (M + A) - 1j * w * (B + D) + C + J.T @ F @ J
    roads = -J @ np.linalg.solve(Z, X)
    return stroke @ roads, F @ roads / 8.0


def worst(row: dict[str, str], which: int) -> float:
    """Largest stroke (0) or change of a load (1) of any row at any place in a regular wave [m], [N]."""
    w = 2.0 * math.pi / float(row["period_s"])
    return 0.5 * float(row["height_m"]) * max(float(np.abs(respond(x, w)[which]).max()) for x in PLACES)


def extreme(row: dict[str, str], which: int, until: float) -> tuple[float, float, float]:
    """The same of a crossing in a sea: exceeded with 95, 50 and 5 %.

    At each place it is Gaussian, and is above a at the rate ``nu exp(-a^2 / 2 sigma^2)``.
    """
    peak, height = 2.0 * math.pi / float(row["period_s"]), float(row["height_m"])
    omega = np.linspace(0.7 * peak, case.TOP, 60)
    width = np.where(omega <= peak, 0.07, 0.09)
    shape = omega**-5.0 * np.exp(-1.25 * (peak / omega) ** 4)
    shape *= 3.3 ** np.exp(-((omega - peak) ** 2) / (2.0 * (width * peak) ** 2))
    every = np.linspace(0.2 * peak, 12.0 * peak, 20000)
    whole = every**-5.0 * np.exp(-1.25 * (peak / every) ** 4)
    whole *= 3.3 ** np.exp(-((every - peak) ** 2) / (2.0 * (np.where(every <= peak, 0.07, 0.09) * peak) ** 2))
    density = shape * height**2 / 16.0 / np.trapezoid(whole, every)
    places = [x for x in PLACES if case.arrival(x) <= until]
    spread, rate = [], []
    for x in places:
        power = density[:, None] * np.abs([respond(x, float(w))[which] for w in omega]) ** 2
        m0 = np.trapezoid(power, omega, axis=0)
        row_of = int(m0.argmax())
        spread.append(math.sqrt(m0[row_of]))
        rate.append(
            math.sqrt(np.trapezoid(power[:, row_of] * omega**2, omega) / m0[row_of]) / (2.0 * math.pi)
        )
    seconds = (places[1] - places[0]) / case.SPEED
    levels = np.linspace(0.1, 8.0, 4000) * max(spread)
    reached = seconds * np.sum(
        np.array(rate) * np.exp(-0.5 * (levels[:, None] / np.array(spread)) ** 2), axis=1
    )
    return tuple(float(np.interp(p, np.exp(-reached), levels)) for p in (0.05, 0.5, 0.95))


def references() -> dict[str, np.ndarray]:
    """Strokes at the place of `held_2.toml`, and largest values on the way in all seas, by file."""
    w = 2.0 * math.pi / PERIOD
    strokes = respond(case.HELD, w)[0][list(BOGIES.values())]
    held = 0.5 * HEIGHT * (strokes * np.exp(-1j * w * TIMES[:, None])).real
    expected = []
    for row in case.seas():
        values: list[float] = [float(row["case"])]
        for which in (0, 1):
            if row["type"] == "regular":
                values += [worst(row, which)] * 3
            else:
                values += extreme(row, which, case.SHORT if row["case"] == "6" else case.DURATION)
        expected.append(values)
    return {"held.csv": np.column_stack([TIMES, held]), "expected.csv": np.array(expected)}


HEADERS = {
    "held.csv": "time," + ",".join(str(bogie) for bogie in BOGIES),
    "expected.csv": "case,stroke_low,stroke,stroke_high,load_low,load,load_high",
}


def main() -> None:
    """Write all."""
    for name, table in references().items():
        lines = [HEADERS[name], *(",".join(f"{value:.12g}" for value in row) for row in table)]
        (HERE / name).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
