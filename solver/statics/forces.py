"""Forces of a scene at rest, and how they change when bodies move."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.rows_at_rest import fill_at_rest

__all__ = ["StaticForces"]

STEP = 1e-9
"""Of time [s], for which laws write targets and softness: winches and dampers do nothing in it."""

DIFFERENCE = 1e-5
"""Displacement of the difference quotients, relative to the size of the scene, or in radians."""

ON_ONE_BODY = frozenset({"UniformGravity", "PointForces", "FluidLoads"})
"""Kinds of forces that do not act between bodies. With others each body is displaced by itself."""


class StaticForces:
    """Generalised forces at the present positions, at rest.

    Parameters
    ----------
    rows
        The scene; velocities are taken as zero.

    Attributes
    ----------
    weight
        Largest norm of the loads seen so far [N]: what a residual is compared with.
    size
        Extent of the scene [m].
    """

    def __init__(self, rows: StartRows) -> None:
        self.rows, self.weight = rows, 0.0
        inertia, owner = rows.inertia, rows.owner
        places = rows.survey()[0]
        firsts = places[:, 0].astype(np.int64)
        mass = inertia[firsts]
        free = rows.free
        self.root = np.sqrt(inertia[free])
        self._mass = np.where(mass > 0.0, mass, 1.0)[owner]
        largest = inertia[firsts[:, None] + np.arange(3, 6)].max(axis=1)
        gyration = np.sqrt(largest / np.where(mass > 0.0, mass, np.inf))
        extent = float(np.ptp(places[:, 1:4], axis=0).max()) + 2.0 * float(gyration.max())
        self.size = extent if extent > 0.0 else 1.0
        self._groups = self._coloured(firsts)

    def norm(self, force: NDArray[np.float64]) -> float:
        """Norm of generalised forces [N]: moments by the radius of gyration."""
        free = self.rows.free
        return float(np.sqrt(np.sum(self._mass[free] * force[free] ** 2 / self.rows.inertia[free])))

    def evaluate(self) -> tuple[NDArray[np.float64], Any, NDArray[np.float64]]:
        """Loads of everything but the rigid joints (dof_count), Jacobian, and reactions of the other rows (rows)."""
        rows, layout = self.rows, self.rows.layout
        layout.work.velocity[:] = 0.0
        fill_at_rest(
            layout.bodies, layout.forces, layout.joints, layout.systems, layout.work, rows.time, STEP
        )
        load = np.zeros(len(rows.inertia))
        for kind in layout.bodies:
            kind.collect_load(layout.work, load)
        load[rows.inertia == 0.0] = 0.0
        G = rows.jacobian()
        soft = ~rows.rigid
        reaction = np.zeros(len(rows.block))
        reaction[soft] = 2.0 * rows.column("target")[soft] / (STEP * rows.column("softness")[soft])
        pull = G.T @ reaction
        pull[rows.inertia == 0.0] = 0.0
        gravity = float(np.linalg.norm(layout.work.sums.gravity))
        mass = rows.inertia[rows.survey()[0][:, 0].astype(np.int64)]
        self.weight = max(
            self.weight, self.norm(load), self.norm(pull), gravity * float(np.linalg.norm(mass))
        )
        return load + pull, G, reaction

    def balance(self, load: NDArray[np.float64], G: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Reactions of the rigid joints (rows) that leave the smallest force, and that force (dof_count)."""
        rows = self.rows
        rigid = rows.rigid
        reaction = np.zeros(len(rows.block))
        if not rigid.any():
            return reaction, load
        free = rows.metric() * load
        change, reaction[rigid] = rows.closing(G, rigid)(-(G @ free)[rigid])
        return reaction, rows.inertia * (free + change)

    def stiffness(self, reaction: NDArray[np.float64]) -> Any:
        """Minus the derivative of all forces by the positions, with rigid reactions kept; sparse, free velocities.

        Notes
        -----
        Central differences. Bodies without a common neighbour are displaced together, as in A. R. Curtis,
        M. J. D. Powell and J. K. Reid, IMA J. Applied Mathematics 13, 1974.
        """
        from scipy.sparse import csc_array

        rows = self.rows
        count = len(rows.inertia)
        entries: list[tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]] = []
        before = rows.snapshot()
        for bodies, heights, owners in self._groups:
            firsts, widths = bodies.T
            for k in range(int(widths.max())):
                columns = (firsts + k)[(widths > k)]
                columns = columns[rows.inertia[columns] > 0.0]
                if not columns.size:
                    continue
                step = DIFFERENCE * (self.size if k < 3 else 1.0)
                increment = np.zeros(count)
                forces = []
                for sign in (1.0, -1.0):
                    increment[columns] = sign * step
                    rows.move(increment)
                    load, G, _ = self.evaluate()
                    forces.append(load + G.T @ reaction)
                    rows.restore(before)
                slope = (forces[1] - forces[0]) / (2.0 * step)
                entries.append((heights, owners + k, slope[heights]))
        place = np.full(count, -1)
        place[rows.free] = np.arange(len(rows.free))
        row, column, value = (np.concatenate(parts) for parts in zip(*entries, strict=True))
        kept = (place[row] >= 0) & (rows.inertia[np.minimum(column, count - 1)] > 0.0)
        shape = (len(rows.free), len(rows.free))
        return csc_array((value[kept], (place[row[kept]], place[column[kept]])), shape=shape)

    def _coloured(
        self, firsts: NDArray[np.int64]
    ) -> list[tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]]:
        """Groups of bodies that are displaced together.

        Returns
        -------
        list
            First velocity and width of each body; velocities whose forces change, and the first velocity of
            the body that changes them.
        """
        rows = self.rows
        count = len(firsts)
        width = np.bincount(rows.owner, minlength=count)
        near: list[set[int]] = [{body} for body in range(count)]
        if not ON_ONE_BODY.issuperset(type(kind).__name__ for kind in rows.layout.forces):
            near = [set(range(count))] * count
        else:
            members: dict[int, set[int]] = {}
            for block, sides in zip(rows.block_owner, rows.sides, strict=True):
                members.setdefault(int(block), set()).update(int(body) for body in sides if body >= 0)
            for group in members.values():
                for body in group:
                    near[body] |= group
        colour = np.full(count, -1)
        for body in range(count):
            taken = {colour[third] for other in near[body] for third in near[other]}
            colour[body] = next(c for c in range(count + 1) if c not in taken)
        groups = []
        for c in range(int(colour.max()) + 1):
            bodies = np.flatnonzero(colour == c)
            pairs = [(other, body) for body in bodies for other in near[body]]
            heights = np.concatenate([firsts[other] + np.arange(width[other]) for other, _ in pairs])
            owners = np.concatenate([np.full(width[other], firsts[body]) for other, body in pairs])
            groups.append((np.column_stack([firsts[bodies], width[bodies]]), heights, owners))
        return groups
