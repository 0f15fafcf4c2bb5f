"""Places of a transporter: its bogies and the decks in the world at the start, and what is fixed to its body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled
from heavylift.solver.interface import FORCES
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.packing import start_frames
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.transport.decks import NO_ROAD, grid_heights, wheel_heights
from heavylift.solver.transport.lever_arms import PlaceData

if TYPE_CHECKING:
    from heavylift.solver.markers import MarkerBook
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.transport.decks import Deck
    from heavylift.solver.transport.transporters import Transporter

__all__ = ["Places"]


NEAR, AROUND = 0.02, 8
"""Part of the extent of a mesh within which a place counts as below it; or the distance of that neighbour of a node."""

LONGEST = 1.0
"""Stroke that no bogie has [m]: those of transporters are 0.6 to 0.7 m from stop to stop."""


class Places:
    """Where the bogies of a transporter and the decks are in the world at the start, and what is fixed to its body."""

    def __init__(self, transporter: Transporter, scene: Scene) -> None:
        self.transporter, self.scene = transporter, scene
        self.body = next(body for body in scene.bodies if body.name == transporter.body)
        self.points = np.vstack([group.bogies for group in transporter.groups])
        self.world = np.array([self.frame(transporter.body, point).point for point in self.points])
        along = np.asarray(transporter.direction, dtype=np.float64)
        # along, left and up in the axes of the body, as level as it stands at the start
        turn = self.frame(transporter.body, np.zeros(3)).axes
        forward = turn @ (along / np.linalg.norm(along))
        level = forward - np.array([0.0, 0.0, forward[2]])
        if not np.linalg.norm(level) > 0.1:
            raise InputError(
                f"{along.tolist()} points up or down at the start",
                source=transporter.name,
                key="direction",
                expected="its horizontal direction",
            )
        level /= np.linalg.norm(level)
        up = np.array([0.0, 0.0, 1.0])
        self.level = np.array([level, np.cross(up, level), up])
        self.axes = self.level @ turn
        self.turn = turn
        self.carried = frozenset({self.body.name})
        self._arms: tuple[int, int, int] | None = None

    def frame(self, body: str, point: NDArray[np.float64]) -> JointFrame:
        """A point of a body [m] and its axes in the world at the start."""
        stands = FixedJoint(
            name=self.transporter.name,
            body_a=GROUND,
            body_b=body,
            frame_b=JointFrame(np.asarray(point, dtype=np.float64)),
        )
        return start_frames(stands, self.scene.bodies)[1]

    def pack(self, book: MarkerBook, point: NDArray[np.float64]) -> PlaceData:
        """Markers of a place of the body [m]: itself, or that of a mesh on which it hangs, and the axes of its arm.

        Raises
        ------
        InputError
            If there is no body over it.
        """
        name, none = self.transporter.body, (-1, -1, -1)
        nodes = self.body.mesh_nodes
        if nodes is None:
            return _place(book.point(name, point, FORCES), none, np.zeros(3))
        place = self.body.nearest(point, source=self.transporter.name, key="groups")
        arm = np.asarray(point, dtype=np.float64) - place
        near = np.sort(np.linalg.norm(nodes - place, axis=1))[: AROUND + 1][-1]
        if np.linalg.norm(self.axes[:2] @ arm) > max(near, NEAR * float(np.ptp(nodes, axis=0).max())):
            raise InputError(
                f"place {np.round(point, 6).tolist()} m of a bogie is {np.linalg.norm(self.axes[:2] @ arm):.4g} m "
                f"beside body {name!r}",
                source=self.transporter.name,
                key="groups",
                expected="places below the body, in the coordinates of its geometry (are the units right?)",
            )
        if self._arms is None and np.any(arm):
            x, y, z = (book.direction(name, axis, FORCES, at=place, turning=False) for axis in np.eye(3))
            self._arms = x, y, z
        return _place(book.point(name, place, FORCES), self._arms or none, arm)

    def on_decks(self, number: int, decks: Sequence[Deck], steering: float) -> tuple[int, float, list[float]]:
        """Deck under a bogie, what it lifts its wheel [m], and its station and offset on every deck [m]."""
        found, lift, radius = -1, 0.0, self.transporter.wheel_radius
        places: list[float] = []
        heading = np.cos(steering) * self.axes[0] + np.sin(steering) * self.axes[1]
        for d, deck in enumerate(decks):
            frame = self.frame(deck.body, deck.origin)
            axes = deck.axes() @ frame.axes.T
            x, y, z = axes @ (self.world[number] - frame.point)
            places += [float(x), float(y)]
            height = NO_ROAD
            if deck.grid is not None:
                ahead = axes @ self.turn @ heading if self.transporter.travel_speed is None else (1.0, 0.0)
                height = grid_heights(deck.grid, radius, x, y, np.arctan2(ahead[1], ahead[0]))[0]
            elif deck.borders[2] <= y <= deck.borders[3]:
                corners = np.column_stack(deck.profile)
                height = wheel_heights(corners, 0, len(corners), radius, [x])[0]
            if height > NO_ROAD and (found < 0 or height - z > lift):
                found, lift = d, float(height - z)
        if found < 0:
            x, y, z = self.world[number]
            raise InputError(
                f"no deck is below bogie {number + 1}, at ({x:.6g}, {y:.6g}, {z:.6g}) m in the world at the start",
                source=self.transporter.name,
                key="groups",
                expected="decks below all wheels, or another start",
            )
        low, high = np.clip(self.transporter.stops, -LONGEST, LONGEST)
        if not low <= lift <= high:
            raise InputError(
                f"bogie {number + 1} is {abs(lift):.4g} m {'below' if lift > 0.0 else 'above'} deck "
                f"{decks[found].name!r}, more than {'any' if self.transporter.stroke_limits is None else 'its'} stroke",
                source=self.transporter.name,
                key="groups",
                expected="places of the wheels on the road at the start",
            )
        return found, lift, places


def _place(marker: int, axes: tuple[int, int, int], arm: NDArray[np.float64]) -> PlaceData:
    """A place by its marker, those of the axes of its arm, and that arm [m]."""
    x, y, z = axes
    return filled(PlaceData, marker=marker, x=x, y=y, z=z, arm=arm)
