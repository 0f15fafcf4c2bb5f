"""Vehicles on tyres become one kind: their paths, rows on each body with decks, and the row of the drive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled, records
from heavylift.solver.interface import FORCES
from heavylift.solver.recording import placed
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.transport import TyreParts
from heavylift.solver.transport.path_packing import PathPacking
from heavylift.solver.transport.tyres import (
    PlaneRows,
    TyreData,
    TyredVehicles,
    TyreState,
    WheelData,
    WheelState,
)

if TYPE_CHECKING:
    from heavylift.solver.force_elements.system import ElementBlock
    from heavylift.solver.markers import MarkerBook
    from heavylift.solver.rows.structure import Attachment
    from heavylift.solver.scene.outputs import Columns
    from heavylift.solver.scene.scene import Scene
    from heavylift.solver.transport.decks import Deck
    from heavylift.solver.transport.places import Places
    from heavylift.solver.transport.transporters import Transporter, Transporters

__all__ = ["TyrePacking"]

PARALLEL = 1.0 - 1e-12
"""Cosine of the angle between normals of decks that count as parallel: 1.4e-6 rad."""


class TyrePacking:
    """Vehicles on tyres of a scene, one after the other."""

    def __init__(self, scene: Scene, book: MarkerBook) -> None:
        self._scene, self._book, self._paths = scene, book, PathPacking(scene, book)
        self._table: list[Any] = []
        self._rows: list[Any] = []
        self._wheels: list[WheelData] = []
        self._planes: list[Deck] = []
        self._deck_planes = [self._plane(deck) for deck in scene.decks]

    def _plane(self, deck: Deck) -> int:
        """Number of the planes on a body to which a deck belongs."""
        for number, other in enumerate(self._planes):
            if other.body == deck.body and float(deck.axes()[2] @ other.axes()[2]) > PARALLEL:
                return number
        self._planes.append(deck)
        return len(self._planes) - 1

    def skip(self, bogies: int) -> None:
        """Count the bogies of a transporter without tyres that slip."""
        self._paths.skip(bogies)
        self._wheels.extend(records(WheelData, bogies))

    def add(
        self,
        transporter: Transporter,
        places: Places,
        at: tuple[int, Columns],
        bogies: tuple[int, Sequence[int], NDArray[np.float64], float],
        law: ElementBlock,
        attachment: Callable[[str], Attachment],
    ) -> list[ElementBlock]:
        """Add a vehicle.

        Parameters
        ----------
        transporter, places
            The transporter, and where it and decks are at the start.
        at
            First free block, and where the outputs of the transporter are.
        bogies
            The first of all that are packed, the decks under its own, force of their cylinders [N]; weight of a bogie
            [N].
        law
            As of a group: on its body, then on those with decks.
        attachment
            Of a body.

        Returns
        -------
        list of ElementBlock
            Its rows.

        Raises
        ------
        InputError
            As of a path, or if there is not one steering error a bogie.
        """
        block, outputs = at
        first_bogie, on, share, weight = bogies
        spec, count = transporter.tyres, len(places.points)
        assert spec is not None
        errors = np.atleast_1d(np.asarray(spec.steering_errors, dtype=np.float64))
        if len(errors) not in {0, 1, count}:
            raise InputError(
                f"{len(errors)} angles of {count} bogies",
                source=transporter.name,
                key="tyres.steering_errors",
                expected=f"one for all, or {count}",
            )
        for point, stands_on, error in zip(
            places.world, on, np.broadcast_to(errors if len(errors) else 0.0, count), strict=True
        ):
            below = self._planes[self._deck_planes[stands_on]]
            frame = places.frame(below.body, np.asarray(below.origin, dtype=np.float64))
            x, y = below.axes()[:2] @ frame.axes.T @ (point - frame.point)
            self._wheels.append(filled(WheelData, error=error, start_x=x, start_y=y))
        bodies = [deck.body for deck in self._planes]
        carrying = {body for body in bodies if body not in {GROUND, transporter.body}}
        drive_block = block + len(bodies)
        vehicle_side = 2 * drive_block + law.sides.index(attachment(transporter.body))
        side_of = {body: 2 * drive_block + law.sides.index(attachment(body)) for body in carrying}
        first_plane = len(self._rows)
        for number, deck in enumerate(self._planes):
            plane, origin = PlaneRows.one(), np.asarray(deck.origin, dtype=np.float64)
            plane.x, plane.y = (
                self._book.direction(deck.body, axis, FORCES, at=origin) for axis in deck.axes()[:2]
            )
            plane.origin = self._book.point(deck.body, origin, FORCES)
            plane.side = 2 * (block + number) + 1 if deck.body in side_of else -1
            plane.drive_side, plane.vehicle_side = side_of.get(deck.body, -1), vehicle_side
            self._rows.append(plane)
        data = TyreData.one()
        data.path, data.first_plane, data.planes = len(self._table), first_plane, len(self._planes)
        data.block, data.drive_block, data.attachments = block, drive_block, len(law.sides)
        data.parts = placed(TyreParts, outputs)
        data.cornering, data.length, data.delay = spec.cornering, spec.relaxation_length, spec.damping_time
        data.reach = float(np.linalg.norm(places.world - places.world.mean(axis=0), axis=1).max())
        self._table.append(data)
        self._paths.add(
            transporter,
            places,
            (drive_block, len(law.sides), outputs),
            side_of | {transporter.body: vehicle_side},
            first_bogie,
            (on, share, weight),
        )
        vehicle = attachment(transporter.body)
        on_planes = [
            replace(law, sides=(vehicle, attachment(body)) if body in side_of else (vehicle,), rows=3)
            for body in bodies
        ]
        return [*on_planes, law]

    def kinds(self, transporters: Transporters) -> list[TyredVehicles]:
        """The kind, beside that of all transporters; none without vehicles."""
        if not self._table:
            return []
        (paths,) = self._paths.kinds(transporters.bogie_state, transporters.steering)
        state, wheels = records(TyreState, len(self._table)), records(WheelState, len(self._wheels))
        state["fresh"] = True
        wheels["x"] = wheels["held_x"] = 1.0
        wheels["plane"] = -1
        return [
            TyredVehicles(
                records(TyreData, self._table),
                records(PlaneRows, self._rows),
                records(WheelData, self._wheels),
                np.array(self._deck_planes, dtype=np.int64),
                paths,
                transporters.decks,
                state,
                wheels,
                paths.plan_state,
                transporters.bogie_state,
            )
        ]
