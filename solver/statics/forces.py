"""Forces of a scene at rest, and how they change when bodies move."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.interface import FORCES
from heavylift.solver.scene.connections import MEASURES
from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.rows_at_rest import fill_at_rest

__all__ = ["STEP", "OneSided", "StaticForces", "act_between", "only_watches"]

STEP = 1e-9
"""Of time [s], for which laws write targets and softness: winches and dampers do nothing in it."""

DIFFERENCE = 1e-5
"""Displacement of the difference quotients, relative to the size of the scene, or in radians."""

ON_ONE_BODY = frozenset({"UniformGravity", "PointForces", "FluidLoads", "Sequencer"})
"""Kinds of forces that do not act between bodies, or do not act, beside what only watches."""

AS_SAID = 1e-6
"""Relative difference up to which the force of a row is that of its one-sided spring."""


def only_watches(kind: Any) -> bool:
    """Whether a kind of forces is none: measures, as loads of hooks, only watch."""
    return type(kind).__module__.startswith(MEASURES.package)


def act_between(forces: Iterable[Any]) -> bool:
    """Whether some kinds of forces act between bodies."""
    return any(type(kind).__name__ not in ON_ONE_BODY and not only_watches(kind) for kind in forces)


@dataclass(frozen=True)
class OneSided:
    """What pulls, or pushes, and never does the other: ropes, lines and stops.

    Attributes
    ----------
    row, sense
        Its row, and s = 1 or -1 with ``de = s G dx``, shape (n,).
    elongation, stiffness
        e [m] or [rad] and k of ``F = k max(0, e)``, shape (n,).
    """

    row: NDArray[np.int64]
    sense: NDArray[np.float64]
    elongation: NDArray[np.float64]
    stiffness: NDArray[np.float64]

    @property
    def tension(self) -> NDArray[np.float64]:
        """F, shape (n,)."""
        found: NDArray[np.float64] = self.stiffness * np.maximum(0.0, self.elongation)
        return found

    def put(self, tension: NDArray[np.float64], reaction: NDArray[np.float64]) -> NDArray[np.float64]:
        """Reactions with those of its rows from other tensions, shape (rows,)."""
        found = reaction.copy()
        found[self.row] = 0.0
        np.subtract.at(found, self.row, self.sense * tension)
        return found


class StaticForces:
    """Generalised forces at the present positions, at rest.

    Parameters
    ----------
    rows
        The scene; velocities are taken as zero.

    Attributes
    ----------
    size
        Extent of the scene [m].
    """

    def __init__(self, rows: StartRows) -> None:
        self.rows = rows
        self._now = self._load = self._kept = 0.0
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
        self._heavy = float(np.linalg.norm(mass))
        self._firsts = firsts
        self._widths = np.bincount(owner, minlength=len(firsts))
        self._partners = self._coupled()
        self._colour = self._coloured()

    def norm(self, force: NDArray[np.float64]) -> float:
        """Norm of generalised forces [N]: moments by the radius of gyration."""
        free = self.rows.free
        return float(np.sqrt(np.sum(self._mass[free] * force[free] ** 2 / self.rows.inertia[free])))

    def evaluate(self) -> tuple[NDArray[np.float64], Any, NDArray[np.float64]]:
        """Loads of everything but the rigid joints (dof_count), Jacobian, and reactions of the other rows (rows)."""
        rows = self.rows
        load, reaction = self._at_rest()
        load[rows.inertia == 0.0] = 0.0
        G = rows.jacobian()
        pull = G.T @ reaction
        pull[rows.inertia == 0.0] = 0.0
        gravity = float(np.linalg.norm(rows.layout.work.sums.gravity))
        pulls = abs(G).T @ np.abs(reaction)
        self._load = self.norm(load)
        self._now = max(self._load, self.norm(pulls), gravity * self._heavy)
        return load + pull, G, reaction

    @property
    def weight(self) -> float:
        """Norm of what acts [N], in balance or not, which a residual is compared with.

        Of the position of the last evaluation; of what is in no row also the largest of those that were kept, since
        springs without a row cancel each other. Positions that were only tried do not count, however far ropes stretch.
        """
        return max(self._now, self._kept)

    def keep(self) -> None:
        """Let the position of the last evaluation count."""
        self._kept = max(self._kept, self._load)

    def _at_rest(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Loads of the bodies (dof_count), and reactions of the rows that are not rigid (rows)."""
        rows, layout = self.rows, self.rows.layout
        layout.work.velocity[:] = 0.0
        fill_at_rest(
            layout.bodies, layout.forces, layout.joints, layout.systems, layout.work, rows.time, STEP
        )
        load = np.zeros(len(rows.inertia))
        for kind in layout.bodies:
            kind.collect_load(layout.work, load)
        soft = ~rows.rigid
        reaction = np.zeros(len(rows.block))
        reaction[soft] = 2.0 * rows.column("target")[soft] / (STEP * rows.column("softness")[soft])
        return load, reaction

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

    def one_sided(self, reaction: NDArray[np.float64]) -> OneSided:
        """What pulls only, at the position of the last evaluation, with the reactions of all rows there (rows).

        A row with another force than its stiffness says, as that of a winch which pays out, is none of them.
        """
        rows = self.rows
        spec = [kind.one_sided() for kind in rows.layout.joints if hasattr(kind, "one_sided")]
        spec.append((np.zeros(0, dtype=np.int64), *3 * [np.zeros(0)]))
        block, sense, elongation, stiffness = (np.concatenate(part) for part in zip(*spec, strict=True))
        found = OneSided(np.searchsorted(rows.block, block), sense, elongation, stiffness)
        force = found.put(found.tension, reaction)[found.row]
        kept = np.abs(force - reaction[found.row]) <= AS_SAID * np.abs(force)
        return OneSided(found.row[kept], sense[kept], elongation[kept], stiffness[kept])

    def stiffness(self, reaction: NDArray[np.float64], given: NDArray[np.int64] | None = None) -> Any:
        """Minus the derivative of all forces by the positions; sparse, free velocities.

        Parameters
        ----------
        reaction
            Of the rigid rows, which are kept, and of the given ones (rows).
        given
            Other rows whose forces are kept; those of all that are left change with their laws.

        Notes
        -----
        Central differences. Bodies that no row and no force has in common are displaced together (A. R. Curtis,
        M. J. D. Powell and J. K. Reid, IMA J. Applied Mathematics 13, 1974): the sides of a row say which of them it is
        that changes it.
        """
        from scipy.sparse import csc_array

        rows = self.rows
        count = len(rows.inertia)
        kept = rows.rigid
        kept[given if given is not None else []] = True
        line, dof = rows.entry_rows, rows.entry_columns
        parts: list[tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]] = []
        before = rows.snapshot()
        for colour in range(int(self._colour.max(initial=-1)) + 1):
            bodies = np.flatnonzero(self._colour == colour)
            displaced = np.append(np.full(len(rows.block_owner), -1), -1)
            for body in bodies:
                displaced[self._blocks[body]] = body
            by = displaced[rows.block[line]]
            touched = np.flatnonzero(by >= 0)
            for k in range(int(self._widths[bodies].max())):
                wide = bodies[self._widths[bodies] > k]
                columns = self._firsts[wide] + k
                columns = columns[rows.inertia[columns] > 0.0]
                if not columns.size:
                    continue
                step = DIFFERENCE * (self.size if k < 3 else 1.0)
                increment = np.zeros(count)
                increment[columns] = step
                found = []
                for way in (1.0, -2.0):
                    rows.move(way * increment)
                    load, soft = self._at_rest()
                    found.append((rows.entries() * np.where(kept, reaction, soft)[line], load))
                rows.move(increment)
                pull, load = ((there - here) / (2.0 * step) for here, there in zip(*found, strict=True))
                owner = by[touched]
                parts.append(
                    (
                        dof[touched],
                        self._firsts[owner] + k,
                        np.where(k < self._widths[owner], pull[touched], 0.0),
                    )
                )
                for body in wide:
                    height = self._partners[body]
                    parts.append((height, np.full(len(height), self._firsts[body] + k), load[height]))
        rows.restore(before)
        place = np.full(count, -1)
        place[rows.free] = np.arange(len(rows.free))
        shape = (len(rows.free), len(rows.free))
        if not parts:
            return csc_array(shape)
        row, column, value = (np.concatenate(part) for part in zip(*parts, strict=True))
        row, column = place[row], place[np.minimum(column, count - 1)]
        good = (row >= 0) & (column >= 0)
        return csc_array((value[good], (row[good], column[good])), shape=shape)

    def _coupled(self) -> list[NDArray[np.int64]]:
        """Velocities whose loads change with each body: its own, and those of all between which forces act."""
        rows = self.rows
        own = [first + np.arange(width) for first, width in zip(self._firsts, self._widths, strict=True)]
        self._joined: set[int] = set()
        if act_between(rows.layout.forces):
            for kind in rows.layout.bodies:
                loaded = kind.markers["body"][kind.markers["level"] == FORCES]
                self._joined |= {int(kind.table["number"][body]) for body in loaded}
            if self._joined:
                together = np.concatenate([own[body] for body in sorted(self._joined)])
                for body in self._joined:
                    own[body] = together
        return own

    def _coloured(self) -> NDArray[np.int64]:
        """Groups of bodies that are displaced together: no row and no force has two of a group."""
        rows, count = self.rows, len(self._firsts)
        members: dict[int, set[int]] = {}
        for owner, sides in zip(rows.block_owner, rows.sides, strict=True):
            members.setdefault(int(owner), set()).update(int(body) for body in sides if body >= 0)
        near: list[set[int]] = [set() for _ in range(count)]
        blocks: list[list[int]] = [[] for _ in range(count)]
        for block, group in (*members.items(), (-1, self._joined)):
            for body in group:
                near[body] |= group
                if block >= 0:
                    blocks[body].append(block)
        self._blocks = [np.array(own, dtype=np.int64) for own in blocks]
        colour = np.full(count, -1)
        for body in np.flatnonzero(self._widths).tolist():
            taken = {colour[other] for other in near[body]}
            colour[body] = next(c for c in range(count + 1) if c not in taken)
        return colour
