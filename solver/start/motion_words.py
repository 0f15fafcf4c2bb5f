"""Words for small motions of a rigid body: translations, turns, screws."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.rotation import rotation_matrix

__all__ = ["motion_words", "move_words"]

SMALL = 1e-6
"""Of a part of a motion that is left out of the words."""


def motion_words(place: NDArray[np.float64], motions: NDArray[np.float64]) -> str:
    """What a body can do, as words that follow "can".

    Parameters
    ----------
    place
        Point [m] and quaternion of the body after its first velocity, shape (8,).
    motions
        Independent velocities of that point [m/s] and spins in the axes of the body [rad/s], shape (6, n).
    """
    v, w = motions[:3], rotation_matrix(place[4:]) @ motions[3:]
    length = max(float(np.abs(v).max(initial=0.0)), SMALL)
    _, sigma, vt = np.linalg.svd(np.vstack([w, np.zeros((1, w.shape[1]))]))
    turns = int(np.count_nonzero(sigma[:3] > SMALL * max(1.0, sigma.max(initial=0.0))))
    slides, _ = np.linalg.qr(v @ vt[turns:].T) if w.shape[1] > turns else (np.zeros((3, 0)), None)
    turning = vt[:turns].T
    spin, along = w @ turning, v @ turning
    along = along - slides @ (slides.T @ along)  # what a slide can do is not part of a turn
    words = []
    if slides.shape[1] == 1:
        words.append(f"slide along {_direction(slides[:, 0])}")
    elif slides.shape[1] == 2:
        words.append(f"slide across {_direction(np.cross(slides[:, 0], slides[:, 1]))}")
    elif slides.shape[1]:
        words.append("move in all directions")
    if turns == 1:
        words.append(_turn(place[1:4], along[:, 0], spin[:, 0], slides))
    elif turns:
        axes = "all directions" if turns == 3 else f"{_direction(spin[:, 0])} and {_direction(spin[:, 1])}"
        # the fixed point p of all turns: v + w x (p - x) = 0
        A = np.vstack([_cross_matrix(spin[:, i]) for i in range(turns)])
        arm, *_ = np.linalg.lstsq(A, -along.T.ravel(), rcond=None)
        fixed = np.abs(A @ arm + along.T.ravel()).max() < 1e-4 * length
        words.append(f"turn about {axes}" + (f" through {_point(place[1:4] + arm)}" if fixed else ""))
    return " and ".join(words)


def move_words(place: NDArray[np.float64], motion: NDArray[np.float64]) -> str:
    """What a body does in one motion, shape (6,), as words that follow its name."""
    v, w = motion[:3], rotation_matrix(place[4:]) @ motion[3:6]
    if np.linalg.norm(w) <= SMALL * np.linalg.norm(v):
        return f"moves along {_direction(v)}"
    return "turns" + _turn(place[1:4], v, w, np.zeros((3, 0)))[4:]


def _turn(
    x: NDArray[np.float64], v: NDArray[np.float64], w: NDArray[np.float64], slides: NDArray[np.float64]
) -> str:
    """A turn about an axis, or a screw."""
    spin = float(np.linalg.norm(w))
    axis = w / spin
    pitch = float(v @ axis) / spin
    centre = x + np.cross(axis, v) / spin
    centre -= (centre @ axis) * axis
    where = (
        "" if slides.size and np.linalg.norm(slides.T @ axis) < 1.0 - SMALL else f" through {_point(centre)}"
    )
    advance = f", advancing {abs(pitch):.3g} m a radian" if abs(pitch) > SMALL else ""
    return f"turn about {_direction(axis)}{where}{advance}"


def _direction(vector: NDArray[np.float64]) -> str:
    unit = vector / np.linalg.norm(vector)
    k = int(np.argmax(np.abs(unit)))
    if abs(unit[k]) > 1.0 - SMALL:
        return "xyz"[k]
    unit = unit * np.sign(unit[np.flatnonzero(np.abs(unit) > SMALL)[0]])
    return _numbers(unit)


def _point(point: NDArray[np.float64]) -> str:
    return _numbers(point) + " m"


def _numbers(values: NDArray[np.float64]) -> str:
    return (
        "(" + ", ".join(f"{value + 0.0:.3g}" for value in np.where(np.abs(values) < SMALL, 0.0, values)) + ")"
    )


def _cross_matrix(w: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
