"""Write the reference histories of this case: forces of the hinges from a solution in the frequency domain.

    python cases/two_barges/make_reference.py

NumPy and h5py alone. Motions of the two barges and the two beams, 24 coordinates, and the 15 reactions of the joints
are the unknowns of one linear system for each wave; what it gives is summed over the waves. Every body has as
coordinates the displacement of a reference point and a small rotation, both in world axes. A force F0 at the point s
that acts at rest turns with the body it acts on, if only in its lever: a rotation theta gives the moment
(theta x s) x F0, for weight, buoyancy and the weight of the beams in the joints.
"""

from __future__ import annotations

import math
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
GRAVITY, DENSITY = 9.81, 1025.0
LENGTH, BREADTH, DRAFT = 60.0, 20.0, 3.0
CENTRES = {"aft": -33.0, "fore": 33.0}
BEAM_MASS, BEAM_INERTIA = 30.0e3, (5.0e3, 250.0e3, 250.0e3)
HINGE_X, HINGE_Y, HINGE_Z = 5.0, {"port": 6.0, "starboard": -6.0}, 2.5
RISE, GYRATION = 1.0, (7.0, 15.0, 15.0)  # of the centre of mass over the water [m]; radii about it [m]
SPRING, REACH = 300.0e3, 30.0  # stiffness [N/m]; of the mooring springs along x and y [m]
DAMPING = (6.0e5, 6.0e5, 0.0, 0.0, 0.0, 4.0e8)
AMPLITUDE = 0.001
WAVES = (  # omega [rad/s], direction [deg], phase [rad]
    (0.4, 0, 0.3), (0.6, 0, 1.7), (0.8, 0, 3.1), (1.0, 0, 4.4), (1.2, 0, 5.9),
    (0.5, 30, 1.0), (0.7, 30, 2.3), (0.9, 30, 3.9), (1.1, 30, 5.2),
)  # fmt: skip
TIMES = 440.0 + 0.25 * np.arange(252)
"""62.75 s: all frequencies are multiples of 0.1 rad/s."""
BODIES = ("aft", "fore", "port", "starboard")
JOINTS = ("port_aft", "port_fore", "starboard_aft", "starboard_fore")


def cross_matrix(v):
    """Matrix of the cross product with v."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def barge_mass():
    """Mass [kg] and centre of mass [m] of a barge, its hinges at +x: with half of each beam it is on even keel."""
    mass = DENSITY * LENGTH * BREADTH * DRAFT - BEAM_MASS
    lever = CENTRES["fore"] - HINGE_X
    return mass, -BEAM_MASS * lever / mass


def mass_matrix(mass, inertia, centre):
    """About a point from which the centre of mass is at `centre`."""
    S = cross_matrix(centre)
    M = np.zeros((6, 6))
    M[:3, :3] = mass * np.eye(3)
    M[:3, 3:], M[3:, :3] = -mass * S, mass * S
    M[3:, 3:] = np.diag(inertia) + mass * S.T @ S
    return M


def turned_force(force, point):
    """Stiffness of a force at rest that acts at a point of a body."""
    C = np.zeros((6, 6))
    C[3:, 3:] = -cross_matrix(force) @ cross_matrix(point)
    return C


def block(name):
    """Coordinates of a body."""
    first = 6 * BODIES.index(name)
    return slice(first, first + 6)


def structure():
    """Mass, damping and stiffness matrices without the water that is moved, and the rows of the joints."""
    M, B, C = np.zeros((24, 24)), np.zeros((24, 24)), np.zeros((24, 24))
    up = np.array([0.0, 0.0, 1.0])
    mass, shift = barge_mass()
    volume = LENGTH * BREADTH * DRAFT
    for name in CENTRES:
        side = 1.0 if name == "aft" else -1.0
        centre = np.array([side * shift, 0.0, RISE])
        at = block(name)
        M[at, at] = mass_matrix(mass, [mass * r * r for r in GYRATION], centre)
        B[at, at] = np.diag(DAMPING)
        C[at, at] = turned_force(-mass * GRAVITY * up, centre)
        C[at, at] += turned_force(DENSITY * GRAVITY * volume * up, np.array([0.0, 0.0, -0.5 * DRAFT]))
        plane = [LENGTH * BREADTH, LENGTH * BREADTH**3 / 12.0, BREADTH * LENGTH**3 / 12.0]
        C[at, at] += DENSITY * GRAVITY * np.diag([0.0, 0.0, *plane, 0.0])
        for y in (-1.0, 1.0):
            point = np.array([-side * LENGTH / 2.0, y * BREADTH / 2.0, 0.0])
            along = np.array([-side, y, 0.0]) / math.sqrt(2.0)
            row = np.concatenate([along, np.cross(point, along)])
            C[at, at] += SPRING * np.outer(row, row)
    rows = []
    for name, y in HINGE_Y.items():
        at = block(name)
        M[at, at] = mass_matrix(BEAM_MASS, BEAM_INERTIA, np.zeros(3))
        weight = 0.5 * BEAM_MASS * GRAVITY
        for barge, place in CENTRES.items():
            x = -HINGE_X if barge == "aft" else HINGE_X
            on_beam, on_barge = np.array([x, 0.0, 0.0]), np.array([x - place, y, HINGE_Z])
            C[at, at] += turned_force(weight * up, on_beam)
            C[block(barge), block(barge)] += turned_force(-weight * up, on_barge)
            # side b is the beam at the aft barge, and the fore barge at the other end
            toward = 1.0 if barge == "aft" else -1.0
            for k in range(3):
                row = np.zeros(24)
                row[at][k], row[block(barge)][k] = toward, -toward
                row[at][3:] = -toward * cross_matrix(on_beam)[k]
                row[block(barge)][3:] = toward * cross_matrix(on_barge)[k]
                rows.append(row)
            locked = {("port", "aft"): (0, 2), ("starboard", "aft"): (0,)}.get((name, barge), ())
            for k in locked:
                row = np.zeros(24)
                row[at][3 + k], row[block(barge)][3 + k] = 1.0, -1.0
                rows.append(row)
    return M, B, C, np.array(rows)


def reactions():
    """Complex force on b of every joint and moment of the first, for each wave and metre of amplitude."""
    M, B, C, G = structure()
    with h5py.File(HERE / "two_barges.nc") as file:
        table = file["omega"][:]
        headings = np.rad2deg(file["wave_direction"][:])
        added, damping = file["added_mass"][:], file["radiation_damping"][:]
        force = file["excitation_force"][0] + 1j * file["excitation_force"][1]
    found = []
    for omega, direction, _ in WAVES:
        i = int(np.argmin(abs(table - omega)))
        h = int(np.argmin(abs(headings - direction)))
        assert abs(table[i] - omega) < 1e-9
        assert abs(headings[h] - direction) < 1e-9
        water = np.zeros((24, 24), dtype=complex)
        A, D = 0.5 * (added[i] + added[i].T), 0.5 * (damping[i] + damping[i].T)
        water[:12, :12] = -(omega**2) * A - 1j * omega * D
        system = np.zeros((24 + len(G), 24 + len(G)), dtype=complex)
        system[:24, :24] = -(omega**2) * M - 1j * omega * B + C + water
        system[:24, 24:], system[24:, :24] = -G.T, G
        load = np.zeros(24 + len(G), dtype=complex)
        load[:12] = force[i, h]
        found.append(np.linalg.solve(system, load)[24:])
    return np.array(found)


def histories():
    """Force of each joint, and moment of the hinge, over the times: shape (n, 3)."""
    waves = np.array(WAVES)
    turning = np.exp(-1j * (waves[:, 0] * TIMES[:, None] + waves[:, 2]))
    value = AMPLITUDE * (turning @ reactions()).real
    weight = np.array([0.0, 0.0, 0.5 * BEAM_MASS * GRAVITY])
    # rows: port aft force, its moment about x and z, port fore, starboard aft force, its moment about x, starboard fore
    moment = np.column_stack([value[:, 3], 0.0 * TIMES, value[:, 4]])
    return {
        "port_aft": value[:, 0:3] + weight,
        "port_fore": value[:, 5:8] - weight,
        "starboard_aft": value[:, 8:11] + weight,
        "starboard_fore": value[:, 12:15] - weight,
        "port_moment": moment,
    }


def references():
    """Tables by name of their files."""
    return {f"{name}.csv": np.column_stack([TIMES, table]) for name, table in histories().items()}


def main():
    """Write the tables, and print by what their errors are divided."""
    for name, table in references().items():
        np.savetxt(HERE / name, table, delimiter=",", header="time,x,y,z", comments="", fmt="%.12g")
        dynamic = table[:, 1:] - table[:, 1:].mean(axis=0)
        largest = np.linalg.norm(dynamic, axis=1).max()
        print(f"{name}: largest {largest:.6g}")  # noqa: T201
    mass, shift = barge_mass()
    print(f"mass {mass} kg, centre of mass {shift:.12g} m towards the hinges")  # noqa: T201


if __name__ == "__main__":
    main()
