"""Trusses of bars with Green-Lagrange strain, in plain numpy: static problems with closed solutions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Truss:
    """Bars between nodes in a plane; `links` are rigid bars, held by a row each.

    Parameters
    ----------
    nodes
        Shape (n, 2) [m].
    bars
        Pairs of nodes.
    stiffness
        EA [N].
    free
        Coordinates ``2 node + axis`` that move.
    load
        On these [N].
    lengths
        Unloaded lengths of the bars; as placed if None.
    links
        Pairs of nodes at a fixed distance.
    """

    def __init__(
        self,
        nodes: Any,
        bars: Any,
        stiffness: float,
        free: Any,
        load: Any,
        lengths: Any = None,
        links: Any = (),
        mass: float = 1.0,
    ) -> None:
        self.x = np.array(nodes, dtype=float)
        self.bars, self.stiffness, self.free = (
            np.array(bars, dtype=int).reshape(-1, 2),
            stiffness,
            np.array(free),
        )
        self.load = np.array(load, dtype=float)
        placed = np.linalg.norm(np.diff(self.x[self.bars], axis=1).reshape(-1, 2), axis=1)
        self.lengths = placed if lengths is None else np.array(lengths, dtype=float)
        self.links = np.array(links, dtype=int).reshape(-1, 2)
        self.distances = np.linalg.norm(np.diff(self.x[self.links], axis=1).reshape(-1, 2), axis=1)
        self.count = len(self.free)
        self.length, self.heaviest = float(np.ptp(self.x, axis=0).max()), 0.0
        self.mass = diags_array(np.full(self.count, mass)).tocsc()
        every = np.concatenate([self.lengths, self.distances])
        self.scale = np.full(self.count, 0.3 * float(every.max()))
        self.positions = np.arange(self.count)

    def snapshot(self) -> NDArray[np.float64]:
        return self.x.copy()

    def restore(self, snapshot: NDArray[np.float64]) -> None:
        self.x[...] = snapshot

    def move(self, increment: NDArray[np.float64]) -> None:
        self.x.ravel()[self.free] += increment

    advance = move

    def _bar(self, bar: int) -> tuple[NDArray[np.int64], NDArray[np.float64], float]:
        i, j = self.bars[bar]
        d = self.x[j] - self.x[i]
        places = np.array([2 * i, 2 * i + 1, 2 * j, 2 * j + 1])
        return places, np.concatenate([-d, d]), float(d @ d / self.lengths[bar] ** 2 - 1.0) / 2.0

    def internal_force(self) -> NDArray[np.float64]:
        force = np.zeros(self.x.size)
        for bar, length in enumerate(self.lengths):
            places, b, strain = self._bar(bar)
            force[places] += self.stiffness * strain / length * b
        return force[self.free]

    def external_force(self) -> NDArray[np.float64]:
        return self.load

    def energy(self) -> float:
        return sum(
            0.5 * self.stiffness * length * self._bar(bar)[2] ** 2 for bar, length in enumerate(self.lengths)
        )

    def joints(self) -> tuple[Any, NDArray[np.float64]]:
        G, gap = np.zeros((len(self.links), self.x.size)), np.zeros(len(self.links))
        for row, (i, j) in enumerate(self.links):
            d = self.x[j] - self.x[i]
            distance = np.linalg.norm(d)
            gap[row] = distance - self.distances[row]
            G[row, 2 * i : 2 * i + 2], G[row, 2 * j : 2 * j + 2] = -d / distance, d / distance
        return csr_array(G[:, self.free]), gap

    def tangent(self, factor: float, multipliers: NDArray[np.float64]) -> Any:  # noqa: ARG002  loads are dead
        K = np.zeros((self.x.size, self.x.size))
        sign = np.array([[1.0, -1.0], [-1.0, 1.0]])
        for bar, length in enumerate(self.lengths):
            places, b, strain = self._bar(bar)
            K[np.ix_(places, places)] += self.stiffness / length**3 * np.outer(b, b)
            K[np.ix_(places, places)] += self.stiffness * strain / length * np.kron(sign, np.eye(2))
        for row, (i, j) in enumerate(self.links):
            d = self.x[j] - self.x[i]
            distance = np.linalg.norm(d)
            bend = (np.eye(2) - np.outer(d, d) / distance**2) / distance
            places = np.array([2 * i, 2 * i + 1, 2 * j, 2 * j + 1])
            K[np.ix_(places, places)] -= multipliers[row] * np.kron(sign, bend)
        return csc_array(K[np.ix_(self.free, self.free)])


def shallow_truss(load: float, height: float = 0.2, stiffness: float = 1e4) -> Truss:
    """Two bars from supports at x = -1 and 1 m to an apex, which is loaded downwards."""
    return Truss([[-1.0, 0.0], [1.0, 0.0], [0.0, height]], [[0, 2], [1, 2]], stiffness, [4, 5], [0.0, -load])


def apex_load(z: float, height: float = 0.2, stiffness: float = 1e4) -> float:
    """Load in balance with the apex of `shallow_truss` at height z: ``EA (H^2 - z^2) z / L^3``."""
    return stiffness * (height**2 - z**2) * z / (1.0 + height**2) ** 1.5
