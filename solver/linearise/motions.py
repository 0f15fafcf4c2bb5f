"""What can move in a scene: velocities of bodies, and coordinates of the nodes of frames, rods and shells.

Rows see meshes through their bases, vectors at material points, ``y = T x``
(`heavylift.solver.statics.mesh_system`); here all nodes count.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.mesh_system import MeshSystem

__all__ = ["Motions"]


class Motions:
    """Unknowns of a scene: coordinates of meshes first, then velocities that are not prescribed.

    Parameters
    ----------
    rows
        The scene.

    Attributes
    ----------
    count
        Unknowns.
    inertia
        A mass of each, shape (count,).
    owner
        Number of the body of each.
    within
        Which of its body each is: of frames 0 to 2 are displacements, 3 to 5 rotations; -1 of meshes and cables.
    names
        Of each, within its body, as ``x``, ``rotation.1``, ``modal_position.2`` or ``node.3.slope.1.x``.
    firsts
        First unknown of each frame whose motion is free.
    """

    def __init__(self, rows: StartRows) -> None:
        self._rows = rows
        self._system = MeshSystem(rows) if any(kind.NODAL for kind in rows.layout.bodies) else None
        self._dofs = rows.free if self._system is None else self._system.dofs
        starts = rows.owner_starts
        first = starts[np.searchsorted(starts, self._dofs, side="right") - 1]
        framed = np.isin(first, rows.frame_starts)
        self._name_bodies(self._dofs - first, framed)
        self.inertia, self.owner = rows.inertia[self._dofs], rows.owner[self._dofs]
        self.within = np.where(framed, self._dofs - first, -1)
        offset = 0
        if self._system is not None:
            offset = int(self._system.first[-1])
            self._add_meshes(self._system)
        self.count = len(self.inertia)
        self.firsts = offset + np.flatnonzero(self.within[offset:] == 0)
        self._offset = offset

    def _name_bodies(self, k: NDArray[np.int64], framed: NDArray[np.bool_]) -> None:
        self.names: list[str] = []
        for number, frame in zip(k.tolist(), framed.tolist(), strict=True):
            if not frame:
                self.names.append(f"node.{number // 3 + 1}.{'xyz'[number % 3]}")
            elif number < 6:
                self.names.append(f"{'rotation.' if number > 2 else ''}{'xyz123'[number]}")
            else:
                self.names.append(f"modal_position.{number - 5}")

    def _add_meshes(self, system: MeshSystem) -> None:
        """Coordinates of nodes before velocities of bodies."""
        names, owner = [], []
        for kind, matrices in zip(system.meshes, system.matrices, strict=True):
            table = kind.table
            nodes = matrices.places // matrices.lanes - table["first_node"][matrices.body] + 1
            owner.append(table["number"][matrices.body])
            for node, vector, axis in zip(nodes, matrices.vector, matrices.axis, strict=True):
                what = f"slope.{vector}." if vector else ""
                names.append(f"node.{node}.{what}{'xyz'[axis]}")
        self.names = [*names, *self.names]
        self.inertia = np.asarray(system.mass.diagonal())
        self.owner = np.concatenate([*owner, self.owner]).astype(np.int64)
        self.within = np.concatenate([np.full(len(names), -1), self.within])

    def rigid_rows(self) -> NDArray[np.float64]:
        """Rigid rows over the unknowns, dense, of the present state."""
        rows = self._rows
        rows.fill()
        G = rows.matrix()
        if self._system is None:
            G = G if isinstance(G, np.ndarray) else G.toarray()
            return np.asarray(G[rows.rigid][:, self._dofs])
        G = rows.jacobian()
        return np.asarray((G[rows.rigid] @ self._system.T).toarray())

    def gaps(self) -> NDArray[np.float64]:
        """Of these rows, as they were filled [m] or [rad]."""
        return self._rows.residual[self._rows.rigid]

    def missing_rates(self) -> NDArray[np.float64]:
        """By how much the present velocities miss what the rigid rows want, as they were filled [m/s] or [rad/s]."""
        rows = self._rows
        found: NDArray[np.float64] = rows.column("target") - rows.jacobian() @ rows.survey()[2]
        return found[rows.rigid]

    def worst(self) -> list[str]:
        """Names of what is open most."""
        rows = self._rows
        return [rows.names[rows.block[row]] for row in rows.worst(rows.residual, rows.rigid)]

    @property
    def velocity(self) -> NDArray[np.float64]:
        """Present velocities of the unknowns, shape (count,)."""
        own = self._rows.survey()[2][self._dofs]
        if self._system is None:
            return own
        pairs = zip(self._system.meshes, self._system.matrices, strict=True)
        return np.concatenate([*(kind.velocity[matrices.places] for kind, matrices in pairs), own])

    def put_velocity(self, U: NDArray[np.float64]) -> None:
        """Take velocities, and complete the state."""
        rows = self._rows
        full = rows.survey()[2]
        if self._system is not None:
            for kind, matrices, part in self._parts(U):
                kind.velocity[matrices.places] = part
                kind.mean_velocity[:] = kind.velocity
                kind.deviation[:] = kind.ringing[:] = 0.0
                kind.body["last_step"] = 0.0
            full = rows.survey()[2]  # bases follow
        full[self._dofs] = U[self._offset :]
        rows.put_velocity(full)

    def move(self, increment: NDArray[np.float64]) -> None:
        """Displace along the exponential map, or nodes."""
        rows = self._rows
        if self._system is not None:
            self._system.move(increment)
            return
        full = np.zeros(len(rows.inertia))
        full[self._dofs] = increment
        rows.move(full)

    def middle(self) -> NDArray[np.float64]:
        """Velocities of the middle of the last step, shape (count,)."""
        own = self._rows.layout.work.velocity[self._dofs]
        if self._system is None:
            return own.copy()
        pairs = zip(self._system.meshes, self._system.matrices, strict=True)
        return np.concatenate([*(kind.mid_velocity[matrices.places] for kind, matrices in pairs), own])

    def _parts(self, values: NDArray[np.float64]) -> Any:
        system = self._system
        assert system is not None
        ends = zip(system.meshes, system.matrices, system.first[:-1], system.first[1:], strict=True)
        return [(kind, matrices, values[a:b]) for kind, matrices, a, b in ends]
