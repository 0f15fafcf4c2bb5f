"""Whether bodies with modes stay where linear modes hold: how far they deform, and how fast they spin.

Modes add up displacements that are small beside the body, in a frame whose turning only softens them. Left out are the
shortening of what bends, of the square of the deflection, and the stiffness that loads along the body give or take,
as centrifugal forces do. Three numbers tell how far that counts:

    deformation / size    largest displacement of a node relative to the frame, over the largest extent
    turn                  largest rotation of a place relative to the frame, but for the twist of a slender body
    spin / frequency      sqrt(w . J w / J_max) / omega_1

with the angular velocity w of the frame, the inertia J about the centre of mass and the lowest frequency of the modes:
the root is the whole spin across a slender body, and next to nothing about its axis, along which it pulls at nothing. A
cantilever that bends by a tenth of its length under a load at its tip turns there by 0.15 rad and is 0.6 % shorter; in
a frame that follows its mean motion a parabola is a sixth of its displacement, and half of its turn. A blade that turns
at a third of its frequency has its lowest mode in the plane of rotation at 94 % of its frequency in place of 101 %
(Southwell: w^2 + 0.19 Omega^2). Of modes with their geometric stiffening (`heavylift.modal.stiffening`) the spin is not
looked at.

Places that joints turn with are looked at, and of the others those that one of the lowest modes moves most. The lowest
frequency is that of the modes, and of a free frame the one that its joints leave, with their points and the axes that
they hold at rest; a run only ends by the first, since what a joint ties may be light.

Records are looked at, at the ends of intervals.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.modal.reduced import LARGE_DEFLECTION
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import Outcome
from heavylift.solver.bodies.floating_frame.packing import frame_inertia
from heavylift.solver.bodies.frames.base import SLENDER
from heavylift.solver.scene.bodies import Fixed, FlexibleBody, Free
from heavylift.solver.scene.channels import Channel
from heavylift.solver.scene.connections import Joint, JointFrame

__all__ = ["ModalRange"]

TOLD = (LARGE_DEFLECTION, 1.5 * LARGE_DEFLECTION, 1.0 / 3.0)
"""Share of the size, angle [rad] and share of the lowest frequency that are worth a warning."""
LARGEST = (2.0 * TOLD[0], 2.0 * TOLD[1], 2.0 * TOLD[2])
"""The same beyond which a run stops."""

LOWEST = 20
"""Modes by which a body bends as a whole: turns are looked at where they move it most."""

MECHANISM = 1e-4
"""Of the square of the lowest frequency of the free body: joints leave a motion without stiffness."""

SHARES = 3
"""Numbers of a body."""


@dataclass(frozen=True, eq=False)
class _Watched:
    """One body: where its modal coordinates and its spin are recorded, and what makes shares of them.

    Attributes
    ----------
    name
        Its name.
    size
        Largest extent [m].
    modes, spin
        First columns; the second is -1 for a fixed frame.
    bounds
        Largest displacement of each mode over the size, and largest rotation, shape (2, nf).
    shapes
        Displacements over the size, of the nodes that some mode moves most, and rotations, of those that one of the
        lowest does and of the places of joints that hold directions; each of shape (nf, 3 m).
    inertia
        About the centre of mass over its largest value and the square of the lowest frequency, shape (3, 3).
    largest
        Limits beyond which a run ends, shape (3,).
    """

    name: str
    size: float
    modes: int
    spin: int
    bounds: NDArray[np.float64]
    shapes: tuple[NDArray[np.float64], NDArray[np.float64]]
    inertia: NDArray[np.float64]
    largest: NDArray[np.float64]

    def shares(self, records: NDArray[np.float64]) -> NDArray[np.float64]:
        """Deformation, turn and spin of records, shape (rows, 3)."""
        q = records[:, self.modes : self.modes + self.bounds.shape[1]]
        found = np.zeros((len(records), SHARES))
        for k in range(2):
            found[:, k] = np.abs(q) @ self.bounds[k]  # more than it can be: most records need no second look
            large = np.flatnonzero(found[:, k] > TOLD[k])
            if large.size:
                moved = (q[large] @ self.shapes[k]).reshape(len(large), self.shapes[k].shape[1] // 3, 3)
                found[large, k] = np.linalg.norm(moved, axis=2).max(axis=1, initial=0.0)
        if self.spin >= 0:
            w = records[:, self.spin : self.spin + 3]
            found[:, 2] = np.sqrt(np.einsum("rk,kl,rl->r", w, self.inertia, w).clip(0.0))
        return found


class ModalRange:
    """Largest deformations and spins of the bodies with modes of a scene.

    Parameters
    ----------
    bodies
        Of the scene. Bodies of loose points have no size that modes must be small beside, and are left out.
    channels
        Of the records.
    joints
        Of the scene.

    Attributes
    ----------
    state
        Largest deformation, turn and spin of each body so far, shape (bodies, 3): what a continuation needs.
    """

    def __init__(
        self, bodies: Sequence[Any], channels: Sequence[Channel], joints: Sequence[Joint] = ()
    ) -> None:
        columns = {channel.name: channel.column for channel in channels}
        self._bodies = [_watched(body, columns, joints) for body in bodies if body.reduced.continuum]
        self.state = np.zeros((len(self._bodies), SHARES))
        self._largest = np.array([body.largest for body in self._bodies]).reshape(-1, SHARES)

    def add(self, records: NDArray[np.float64]) -> int:
        """Look at more records, shape (rows, columns); the number of the first that is out of range, or -1."""
        end = len(records)
        with np.errstate(over="ignore", invalid="ignore"):
            shares = [body.shares(records) for body in self._bodies]
        for found, largest in zip(shares, self._largest, strict=True):
            beyond = np.flatnonzero((found > largest).any(axis=1))
            end = min(end, int(beyond[0])) if beyond.size else end
        for i, found in enumerate(shares):
            if len(found):
                self.state[i] = np.maximum(self.state[i], np.nanmax(found[: end + 1], axis=0, initial=0.0))
        return end if end < len(records) else -1

    @property
    def left(self) -> bool:
        """Whether a body has left the range."""
        return bool(np.any(self.state > self._largest))

    def message(self, when: str) -> str:
        """Sentence on the bodies that have left their range, at a time as words."""
        words = [
            f"body {body.name!r} {' and '.join(self._parts(i, body.largest))}"
            for i, body in enumerate(self._bodies)
            if np.any(self.state[i] > body.largest)
        ]
        return f"{Outcome.MODES_LEFT.text} at {when}: {'; '.join(words)}; try {_remedy(self.state, self._largest)}"

    @property
    def warning(self) -> str:
        """A sentence if a body comes near the end of its range, else empty."""
        words = [
            f"{body.name!r} {' and '.join(self._parts(i, np.array(TOLD)))}"
            for i, body in enumerate(self._bodies)
            if np.any(self.state[i] > TOLD)
        ]
        return f"{'; '.join(words)}: take {_remedy(self.state, np.array([TOLD]))}" if words else ""

    def _parts(self, i: int, limits: NDArray[np.float64]) -> list[str]:
        body, (deformed, turned, spun) = self._bodies[i], self.state[i]
        parts = []
        if deformed > limits[0]:
            parts.append(
                f"deforms by {deformed:.3g} of its size of {body.size:.3g} m, and linear modes hold for deflections "
                f"that are small beside it ({TOLD[0]:.0%}; a run ends at {LARGEST[0]:.0%})"
            )
        if turned > limits[1] and not parts:
            parts.append(
                f"bends until a place turns by {turned:.3g} rad, and linear modes hold for small angles "
                f"({TOLD[1]:.2f} rad; a run ends at {LARGEST[1]:.1f})"
            )
        if spun > limits[2]:
            parts.append(
                f"turns with {spun:.3g} of its lowest frequency, and modes lack the stiffness that centrifugal forces "
                f"give (they hold to {TOLD[2]:.2f}; a run ends at {body.largest[2]:.2f})"
            )
        return parts


def _remedy(state: NDArray[np.float64], limits: NDArray[np.float64]) -> str:
    softer = "a body of type 'frame' or 'shell', which bends and turns as far as it likes"
    if np.any(state[:, :2] > limits[:, :2]):
        return f"{softer}, or smaller loads"
    return f"{softer}, 'modes.stiffening' of the body, or a slower drive"


def _joint_sides(body: FlexibleBody, joints: Sequence[Joint]) -> list[tuple[Joint, JointFrame]]:
    """Joints on a body, with their frames on it."""
    return [
        (joint, frame)
        for joint in joints
        for name, frame in ((joint.body_a, joint.frame_a), (joint.body_b, joint.frame_b))
        if name == body.name
    ]


def _held_axes(joint: Joint, frame: JointFrame) -> NDArray[np.float64]:
    """Axes in the body frame about which rows of directions hold a place, shape (m, 3)."""
    held = {
        axis
        for word, *axes in joint.ROWS
        if word == "parallel" or (word == "square" and len(set(axes)) == 2)
        for axis in "xyz"
        if axis not in axes
    }
    return frame.axes[:, ["xyz".index(axis) for axis in sorted(held)]].T


def _held_frequency(body: FlexibleBody, joints: Sequence[Joint]) -> float:
    """Square of the lowest frequency [rad^2/s^2] of a free body with its points in joints at rest, mechanisms apart."""
    reduced = body.reduced
    lowest = float(reduced.eigenvalues.min())
    sides = _joint_sides(body, joints)
    if not sides or not isinstance(body.motion, Free) or lowest <= 0.0:
        return lowest
    frame, coupling = frame_inertia(reduced.integrals)
    n = 6 + reduced.mode_count
    M, K, rows = np.eye(n), np.diag([*np.zeros(6), *reduced.eigenvalues]), []
    M[:6, :6], M[:6, 6:], M[6:, :6] = frame, coupling, coupling.T
    for joint, place in sides:
        (u1, u2, u3), displacement, rotation = reduced.motion_at(place.point, source=body.name)
        cross = np.array([[0.0, u3, -u2], [-u3, 0.0, u1], [u2, -u1, 0.0]])
        rows.append(np.hstack([np.eye(3), cross, displacement.T]))
        axes = _held_axes(joint, place)
        turned = np.zeros((3, reduced.mode_count)) if rotation is None else rotation.T
        rows.append(np.hstack([np.zeros_like(axes), axes, axes @ turned]))
    L = np.linalg.cholesky(M)
    J = np.linalg.solve(L, np.vstack(rows).T).T  # columns of unit mass
    _, sigma, vt = np.linalg.svd(J)
    Z = np.linalg.solve(L.T, vt[int(np.count_nonzero(sigma > 1e-9 * sigma[0])) :].T)
    values = np.linalg.eigvalsh(Z.T @ K @ Z)
    values = values[values > MECHANISM * lowest]
    return min(lowest, float(values[0])) if values.size else lowest


def _watched(body: FlexibleBody, columns: dict[str, int], joints: Sequence[Joint]) -> _Watched:
    reduced, integrals = body.reduced, body.reduced.integrals
    lengths = np.linalg.norm(reduced.mode_shapes, axis=2)
    # the largest of each mode, and in each direction: of any sum of modes some node is near its largest
    most = np.unique([lengths.argmax(axis=1), *np.abs(reduced.mode_shapes).argmax(axis=1).T])
    moved = reduced.mode_shapes[:, most].reshape(reduced.mode_count, -1) / reduced.size
    few = np.unique(lengths[:LOWEST].argmax(axis=1))
    places = [
        reduced.motion_at(frame.point, source=body.name).rotation
        for joint, frame in _joint_sides(body, joints)
        if any(joint.rotational)
    ]
    turned = np.stack(
        [
            *(reduced.turn_at(np.array([node]), np.ones(1)) for node in few),
            *(rotation for rotation in places if rotation is not None),
        ],
        axis=1,
    )
    c = integrals.first_moment / integrals.mass
    second = integrals.inertia_kl - integrals.mass * np.outer(c, c)
    J = np.trace(second) * np.eye(3) - second
    moments, axes = np.linalg.eigh(J)
    if moments[0] < SLENDER * moments[1]:  # twist about the axis of a slender body shortens nothing
        turned = turned - (turned @ axes[:, 0])[..., None] * axes[:, 0]
    lowest, held = float(reduced.eigenvalues.min()), _held_frequency(body, joints)
    # modes that know of their stiffening by inertia hold for any spin
    turns = not isinstance(body.motion, Fixed) and lowest > 0.0 and reduced.stiffening is None
    return _Watched(
        body.name,
        reduced.size,
        columns[f"{body.name}.modal_position"],
        columns[f"{body.name}.angular_velocity"] if turns else -1,
        np.array([lengths.max(axis=1) / reduced.size, np.linalg.norm(turned, axis=2).max(axis=1)]),
        (moved, turned.reshape(reduced.mode_count, -1)),
        J / (moments[-1] * held) if turns else np.zeros((3, 3)),
        np.array([*LARGEST[:2], LARGEST[2] * (np.sqrt(lowest / held) if turns else 1.0)]),
    )
