"""States of the water about hulls: memory of the waves that they have made.

Of a database whose memory is a sum of exponentials, ``K(t) = Re sum R_p exp(s_p t)``, each velocity u_j of a hull
drives ``z_jp' = s_p z_jp + u_j`` (`heavylift.solver.water.hulls.memory`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["MemoryStates"]

COORDINATES = ("surge", "sway", "heave", "roll", "pitch", "yaw")


class MemoryStates:
    """Those that do something: of velocities that make forces, and imaginary parts of poles that have them.

    Parameters
    ----------
    layout
        Packed scene.

    Attributes
    ----------
    names
        As ``barge.memory.heave.3.real``.
    """

    def __init__(self, layout: Any) -> None:
        self.names: list[str] = []
        self._parts: list[tuple[Any, Any, NDArray[np.int64], NDArray[np.int64]]] = []
        for kind in layout.bodies:
            if not kind.FLOATS:
                continue
            hulls = [layout.body_names[number] for number in kind.table["number"]]
            for part in kind.radiation:
                memory = part.memory
                count = memory.poles.shape[0] // 2
                drives = np.unique(memory.channels[:, 1])
                has = np.concatenate([np.ones(count, dtype=np.bool_), memory.poles[count:] != 0.0])
                columns = np.flatnonzero(has)
                self._parts.append((kind, part, drives, columns))
                for j in drives.tolist():
                    hull, k = divmod(int(part.first[0]) + j, 6)
                    self.names += [
                        f"{hulls[hull]}.memory.{COORDINATES[k]}.{c % count + 1}.{('real', 'imaginary')[c // count]}"
                        for c in columns.tolist()
                    ]

    @property
    def values(self) -> NDArray[np.float64]:
        """Present ones [m]."""
        each = [
            part.memory.state[np.ix_(drives, columns)].ravel() for _, part, drives, columns in self._parts
        ]
        return np.concatenate([np.zeros(0), *each])

    def put(self, values: NDArray[np.float64]) -> None:
        """Take others."""
        at = 0
        for _, part, drives, columns in self._parts:
            size = len(drives) * len(columns)
            part.memory.state[np.ix_(drives, columns)] = values[at : at + size].reshape(len(drives), -1)
            at += size

    def rates(self) -> NDArray[np.float64]:
        """Their rates at the velocities of the last evaluation."""
        found = [np.zeros(0)]
        for kind, part, drives, columns in self._parts:
            memory, first = part.memory, int(part.first[0])
            count = memory.poles.shape[0] // 2
            z = memory.state[drives, :count] + 1j * memory.state[drives, count:]
            rate = z * (memory.poles[:count] + 1j * memory.poles[count:])
            rate += kind.vectors.start[first + drives][:, None]
            found.append(np.hstack([rate.real, rate.imag])[:, columns].ravel())
        return np.concatenate(found)
