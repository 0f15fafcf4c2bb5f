"""Loads of meshes as rows of a table: dead loads as nodal vectors, followers element by element."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, records
from heavylift.solver.bodies.ancf.frame_data import FrameFollower
from heavylift.solver.bodies.ancf.kind import DEAD_LOAD, FOLLOWER_ELEMENT, FOLLOWER_NODE, MeshLoad
from heavylift.solver.bodies.ancf.types import type_of
from heavylift.solver.scene.meshes import DistributedLoad, FollowerLoad, FrameBody, MeshBody

__all__ = ["LoadBook"]


@dataclass
class LoadBook:
    """Rows of the loads of all bodies of a kind; `store` appends to its constants."""

    store: Callable[[NDArray[np.float64]], int]
    rows: list[tuple[int, int, int, int, int]] = field(default_factory=list)

    def table(self) -> Records[MeshLoad]:
        """All rows."""
        return records(MeshLoad, self.rows)

    def add(
        self,
        body: MeshBody,
        load: DistributedLoad | FollowerLoad,
        rotation: NDArray[np.float64],
        first_node: int,
        first_element: int,
        lanes: int,
    ) -> None:
        """Append a load.

        Parameters
        ----------
        body, load
            What is loaded.
        rotation
            Axes of the body as columns, shape (3, 3).
        first_node, first_element
            Of the body in the kind.
        lanes
            Places of a node.

        Raises
        ------
        InputError
            If a table, an element, a node or an axis does not fit.
        """
        times = np.atleast_1d(np.asarray(load.times, dtype=np.float64))
        factors = np.atleast_1d(np.asarray(load.factors, dtype=np.float64))
        if times.shape != factors.shape or len(times) == 0 or not np.all(np.diff(times) > 0.0):
            raise InputError(
                f"{len(times)} times and {len(factors)} factors",
                source=body.name,
                key="loads",
                expected="one factor a time, times increasing",
            )
        count = len(body.elements)  # type: ignore[attr-defined]
        chosen = np.arange(count) if load.elements is None else np.atleast_1d(np.asarray(load.elements))
        if not (np.all(chosen >= 0) and np.all(chosen < count)):
            raise InputError(
                f"elements {chosen.tolist()}",
                source=body.name,
                key="loads",
                expected=f"numbers from 0 to {count - 1}",
            )
        table = self.store(np.concatenate([times, factors]))
        if isinstance(load, DistributedLoad):
            data = self.store(_dead_load(body, load, rotation, chosen, lanes))
            self.rows.append((DEAD_LOAD, data, table, len(times), first_node * lanes))
            return
        if not isinstance(body, FrameBody):
            if load.tangential != 0.0 or load.node is not None:
                raise InputError(
                    "a tangential load or a node",
                    source=body.name,
                    key="loads",
                    expected="a pressure: on a shell a follower acts along the normal",
                )
            data = self.store(np.array([load.normal]))
            rows = [(FOLLOWER_ELEMENT, data, table, len(times), first_element + int(e)) for e in chosen]
            self.rows += rows
            return
        axis = rotation.T @ np.asarray(load.axis, dtype=np.float64)
        length = float(np.linalg.norm(axis))
        if load.normal != 0.0 and not 0.0 < length < np.inf:
            raise InputError(
                f"axis {np.asarray(load.axis).tolist()}",
                source=body.name,
                key="loads",
                expected="a direction that is not zero",
            )
        given = FrameFollower.one()
        given.normal, given.tangential, given.axis = load.normal, load.tangential, axis / (length or 1.0)
        data = self.store(given.words.copy())
        if load.node is None:
            self.rows += [(FOLLOWER_ELEMENT, data, table, len(times), first_element + int(e)) for e in chosen]
            return
        if not 0 <= load.node < len(body.nodes):
            raise InputError(
                f"node {load.node}",
                source=body.name,
                key="loads",
                expected=f"a number from 0 to {len(body.nodes) - 1}",
            )
        self.rows.append((FOLLOWER_NODE, data, table, len(times), (first_node + load.node) * lanes))


def _dead_load(
    body: MeshBody,
    load: DistributedLoad,
    rotation: NDArray[np.float64],
    elements: NDArray[np.int64],
    lanes: int,
) -> NDArray[np.float64]:
    """Consistent nodal forces in body axes, flat over the places of the nodes of the body."""
    of_type = type_of(body)
    vectors = len(of_type.vectors)
    force = rotation.T @ np.asarray(load.load, dtype=np.float64)
    nodal = np.zeros((len(body.nodes), lanes))
    for element in elements:
        shape = np.asarray(of_type.load_shape(body, int(element))).reshape(-1, vectors)
        for node, values in zip(body.elements[element], shape, strict=True):  # type: ignore[attr-defined]
            nodal[node, : 3 * vectors] += np.outer(values, force).ravel()
    return nodal.ravel()
