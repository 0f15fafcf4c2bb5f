"""Paths of transporters become one kind: routes, plans of the bodies with decks, drives."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled_rows, records
from heavylift.solver.interface import FORCES
from heavylift.solver.recording import placed
from heavylift.solver.scene.transport import DriveOutputs, PathOutputs, SteeringParts
from heavylift.solver.transport.paths import (
    DriveData,
    PathBogie,
    PathData,
    PathPlan,
    Paths,
    PathState,
    PlanState,
)
from heavylift.solver.transport.routes import make_route, rolling, steering_turns

if TYPE_CHECKING:
    from heavylift.solver.markers import MarkerBook
    from heavylift.solver.scene.outputs import Columns
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.scene.transport import Drive
    from heavylift.solver.transport.places import Places
    from heavylift.solver.transport.routes import Route
    from heavylift.solver.transport.transporters import BogieState, Transporter

__all__ = ["PathPacking", "steering_at_start"]


class PathPacking:
    """Paths of a scene, one after the other."""

    def __init__(self, scene: Scene, book: MarkerBook) -> None:
        self._scene, self._book = scene, book
        self._paths: list[Any] = []
        self._plans: list[Any] = []
        self._weights: list[float] = []
        self._deck_plans: list[list[int]] = []
        self._bogies: list[PathBogie] = []
        self._drives: list[Any] = []
        self._capacity: list[tuple[float, float]] = []
        self._routes: list[Route] = []
        self._turns: list[tuple[int, NDArray[np.float64]]] = []

    def skip(self, bogies: int) -> None:
        """Count the bogies of a transporter without path."""
        self._bogies.extend(records(PathBogie, bogies))

    def add(
        self,
        transporter: Transporter,
        places: Places,
        at: tuple[int, int, Columns],
        side_of: Mapping[str, int],
        first_bogie: int,
        loads: tuple[Sequence[int], NDArray[np.float64], float],
    ) -> None:
        """Add the path of a transporter.

        Parameters
        ----------
        transporter, places
            The transporter, and where it and decks are at the start.
        at
            Block of its rows, attachments of that, and where the outputs of the transporter are.
        side_of
            Side of the rows by body; not of the ground.
        first_bogie
            Of all that are packed.
        loads
            Deck under each of its bogies, force of its cylinder [N]; weight of a bogie [N].

        Raises
        ------
        InputError
            If a leg does not fit the vehicle, its steering or its drive.
        """
        on, share, weight = loads
        middle = places.world.mean(axis=0)
        try:
            route, local = _route(transporter, places)
            turns = steering_turns(route, local, transporter.steering_limit)
            drive, driven = self._drive(transporter.drive, route, local)
        except InputError as error:
            raise InputError(
                error.problem, source=transporter.name, key=error.key, expected=error.expected
            ) from None
        bodies = list(dict.fromkeys(deck.body for deck in self._scene.decks))
        first_plan, row_count = len(self._plans), sum(len(made.nodes) for made in self._routes)
        piece_count = sum(len(made.pieces) for made in self._routes)
        for body in bodies:
            # a plan that coincides with the world at the start, about the middle of the bogies
            frame = places.frame(body, np.zeros(3))
            origin = frame.axes.T @ (middle - frame.point)
            x, y = (self._book.direction(body, frame.axes[k], FORCES, at=origin) for k in range(2))
            plan = PathPlan.one()
            plan.origin, plan.x, plan.y = self._book.point(body, origin, FORCES), x, y
            plan.side = side_of.get(body, -1)
            self._plans.append(plan)
        deck_plans = [bodies.index(deck.body) for deck in self._scene.decks]
        carried = np.bincount([deck_plans[deck] for deck in on], weights=share, minlength=len(bodies))
        self._weights += (
            list(carried / carried.sum()) if carried.sum() > 0.0 else list(carried == carried.max())
        )
        self._deck_plans.append(deck_plans)
        path = PathData.one()
        path.block, path.attachments, outputs = at
        path.column, path.drive_column = outputs.at(PathOutputs), outputs.at(DriveOutputs)
        path.parts = placed(SteeringParts, outputs)
        path.middle = places.pack(self._book, places.points.mean(axis=0))
        path.forward = self._book.direction(
            transporter.body, places.axes[0], FORCES, at=np.zeros(3), turning=False
        )
        path.side = side_of[transporter.body]
        path.first_plan, path.plans = first_plan, len(bodies)
        path.first_node, path.nodes = row_count, len(route.nodes)
        path.first_piece, path.pieces = piece_count, len(route.pieces)
        path.first_bogie, path.bogies = first_bogie, len(local)
        path.delay, path.weight = transporter.handover, weight
        path.drive, path.driven = drive, int(np.count_nonzero(driven))
        path.tells = any(deck.grid is not None for deck in self._scene.decks)
        self._paths.append(path)
        first_leg = sum(len(rows) for _, rows in self._turns)
        route.nodes[:, -1] += first_leg
        self._routes.append(route)
        self._turns.append((first_bogie, turns))
        along, across = local.T
        self._bogies.extend(filled_rows(PathBogie, x=along, y=across, driven=driven))

    def _drive(
        self, drive: Drive | None, route: Route, bogies: NDArray[np.float64]
    ) -> tuple[int, NDArray[np.bool_]]:
        """Number of the drive and which bogies are driven."""
        driven = np.zeros(len(bogies), dtype=np.bool_)
        if drive is None:
            return -1, driven
        numbers = np.array(drive.bogies or range(1, len(bogies) + 1))
        if numbers.max() > len(bogies):
            raise InputError(
                f"bogie {numbers.max()}", key="drive.bogies", expected=f"numbers from 1 to {len(bogies)}"
            )
        driven[numbers - 1] = True
        sizes = np.hypot(*rolling(route.nodes, bogies))[:, driven].max(axis=1)
        if not sizes.max() > 0.0:
            raise InputError("no driven bogie moves", key="drive.bogies", expected="one that the path moves")
        if len(drive.speeds):
            ways = route.nodes[:, 0]
            for begin, way, speed, slope in route.pieces:
                after = route.pieces[route.pieces[:, 0] > begin]
                top = max(speed, speed + slope * ((after[0, 0] - begin) if len(after) else 0.0))
                end = after[0, 1] if len(after) else way
                fastest = top * float(sizes[(ways >= way - 1e-9) & (ways <= end + 1e-9)].max(initial=0.0))
                if fastest > drive.speeds[-1] * (1.0 + 1e-12):
                    raise InputError(
                        f"a driven wheel runs up to {fastest:.6g} m/s, its table ends at {drive.speeds[-1]:g} m/s",
                        key="drive.speeds",
                        expected="a table up to there, or slower legs",
                    )
        table = list(zip(map(float, drive.speeds), map(float, drive.forces), strict=True))
        data = DriveData.one()
        data.resistance, data.friction = drive.rolling_resistance, drive.friction
        data.brake = drive.brake_force
        data.first, data.count = len(self._capacity), len(table)
        self._drives.append(data)
        self._capacity += table
        return len(self._drives) - 1, driven

    def kinds(self, bogie_state: Records[BogieState], steering: NDArray[np.float64]) -> list[Paths]:
        """The kind; none without paths."""
        if not self._paths:
            return []
        turns = np.zeros((sum(len(rows) for _, rows in self._turns), len(self._bogies)))
        leg = 0
        for first, rows in self._turns:
            turns[leg : leg + len(rows), first : first + rows.shape[1]] = rows
            leg += len(rows)
        plans = records(PlanState, len(self._plans))
        plans["weight"] = plans["next_weight"] = plans["used"] = self._weights
        state = records(PathState, len(self._paths))
        state["yaw"] = [route.nodes[0, 3] for route in self._routes]
        return [
            Paths(
                records(PathData, self._paths),
                records(PathPlan, self._plans),
                records(PathBogie, self._bogies),
                records(DriveData, self._drives),
                np.ascontiguousarray(np.vstack([route.nodes for route in self._routes])),
                np.ascontiguousarray(np.vstack([route.pieces for route in self._routes])),
                np.array(self._capacity, dtype=np.float64).reshape(-1, 2),
                np.vstack([np.insert(made.legs, 0, i, axis=1) for i, made in enumerate(self._routes)]),
                turns,
                np.array(self._deck_plans, dtype=np.int64),
                state,
                plans,
                bogie_state,
                steering,
            )
        ]


def _route(transporter: Transporter, places: Places) -> tuple[Route, NDArray[np.float64]]:
    """The route of a transporter, and places of its bogies from their middle, along and to the left [m]."""
    local = (places.world - places.world.mean(axis=0)) @ places.level.T[:, :2]
    yaw = math.atan2(places.level[0, 1], places.level[0, 0])
    return make_route(transporter.legs, local, np.array([0.0, 0.0, yaw])), local


def steering_at_start(transporter: Transporter, places: Places) -> NDArray[np.float64]:
    """Steering angles of the bogies of a transporter at the start, but for half turns [rad], shape (n,)."""
    if not transporter.legs:
        return np.zeros(len(places.points))
    try:
        route, local = _route(transporter, places)
    except InputError as error:
        raise InputError(
            error.problem, source=transporter.name, key=error.key, expected=error.expected
        ) from None
    along, across = rolling(route.nodes[:1], local)
    return np.arctan2(across, along)[0]
