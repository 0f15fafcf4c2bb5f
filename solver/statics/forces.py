"""Forces of a scene at rest, and how they change when bodies move."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.records import numbers_in
from heavylift.solver.bodies.frames.base import FrameBodies
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


@dataclass(frozen=True)
class _Direction:
    """Bodies that are displaced together.

    Attributes
    ----------
    increment, step
        Of the velocities, shape (dof_count,); its entries that are not zero [m] or [rad].
    moves
        Of each kind of bodies, whether some of it are displaced.
    entries
        Of the Jacobian, that change.
    heights
        Velocities whose loads change; several times if several bodies change them.
    columns
        Velocity that is displaced, of all entries, then of all heights.
    """

    increment: NDArray[np.float64]
    step: float
    moves: list[bool]
    entries: NDArray[np.int64]
    heights: NDArray[np.int64]
    columns: NDArray[np.int64]


class _MarkerLoads:
    """``J^T f`` of the markers of a kind of bodies with frames that forces act on.

    Parameters
    ----------
    kind
        The bodies.
    work
        With the markers.

    Attributes
    ----------
    alone
        Whether the kind has no other load that changes with its position.
    """

    def __init__(self, kind: Any, work: Any) -> None:
        loaded = kind.markers[kind.markers["level"] == FORCES]
        self._number = np.array(loaded["number"])
        self._width = work.jacobian.shape[2]
        windows = kind._windows()  # noqa: SLF001  of a class of this package
        self._places = windows[loaded["body"]][:, None] + np.arange(self._width)
        self.alone = type(kind).collect_load is FrameBodies.collect_load

    @staticmethod
    def of(kind: Any, work: Any) -> _MarkerLoads | None:
        """None of kinds whose loads of markers are not apart from others."""
        if isinstance(kind, FrameBodies) and (
            kind.FLOATS or type(kind).collect_load is FrameBodies.collect_load
        ):
            return _MarkerLoads(kind, work)
        return None

    def add(self, work: Any, load: NDArray[np.float64]) -> None:
        """To loads (dof_count)."""
        force = work.markers["force"][self._number]
        acts = np.flatnonzero(force.any(axis=1))
        if acts.size:
            pull = (force[acts, None, :] @ work.jacobian[self._number[acts]])[:, 0]
            wide = np.bincount(
                self._places[acts].ravel(), weights=pull.ravel(), minlength=len(load) + self._width
            )
            load += wide[: len(load)]


class StaticForces:
    """Generalised forces at the present positions, at rest.

    Parameters
    ----------
    rows
        The scene; velocities are taken as zero.
    dense
        Whether matrices of small scenes are dense; else all are sparse.

    Attributes
    ----------
    size
        Extent of the scene [m].
    """

    def __init__(self, rows: StartRows, *, dense: bool = False) -> None:
        self.rows, self._dense = rows, dense and rows.small
        layout = rows.layout
        self._fill = fill_at_rest.with_first(
            layout.bodies, layout.forces, layout.joints, layout.systems, layout.work
        )
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
        self._loaded = [_MarkerLoads.of(kind, layout.work) for kind in layout.bodies]
        self._ways: list[_Direction] | None = None

    def norm(self, force: NDArray[np.float64]) -> float:
        """Norm of generalised forces [N]: moments by the radius of gyration."""
        free = self.rows.free
        return float(np.sqrt(np.sum(self._mass[free] * force[free] ** 2 / self.rows.inertia[free])))

    def evaluate(self) -> tuple[NDArray[np.float64], Any, NDArray[np.float64]]:
        """Loads of everything but the rigid joints (dof_count), Jacobian, and reactions of the other rows (rows)."""
        rows = self.rows
        load, reaction = self._at_rest()
        load[rows.inertia == 0.0] = 0.0
        G = self.matrix()
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
        reaction = self._fill_rows()
        load = np.zeros(len(self.rows.inertia))
        for kind in self.rows.layout.bodies:
            kind.collect_load(self.rows.layout.work, load)
        return load, reaction

    def _fill_rows(self) -> NDArray[np.float64]:
        """Fill markers, forces and rows; reactions of the rows that are not rigid (rows)."""
        rows = self.rows
        rows.layout.work.velocity[:] = 0.0
        self._fill(rows.time, STEP)
        reaction = np.zeros(len(rows.block))
        soft = np.flatnonzero(~rows.rigid)
        if soft.size:
            reaction[soft] = 2.0 * rows.column("target")[soft] / (STEP * rows.column("softness")[soft])
        return reaction

    def matrix(self) -> Any:
        """Jacobian of the rows, as the matrices of this problem are: dense or sparse."""
        return self.rows.matrix() if self._dense else self.rows.jacobian()

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
        """Minus the derivative of all forces by the positions, of the free velocities.

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
        rows, size = self.rows, len(self.rows.free)
        kept = rows.rigid
        kept[given if given is not None else []] = True
        line = rows.entry_rows
        if self._ways is None:
            self._ways, self._carried = [*self._directions()], self._moved_arrays()
            self._pattern = self._places()
        before = rows.snapshot()
        here = [[(array, array.copy()) for array in arrays] for arrays in self._carried]
        values: list[NDArray[np.float64]] = []
        for way in self._ways:
            found = []
            for sign in (1.0, -1.0):
                for kind, moves in zip(rows.layout.bodies, way.moves, strict=True):
                    if moves:
                        kind.move(sign * way.increment)
                load, soft = self._changing(way)
                found.append((rows.entries() * np.where(kept, reaction, soft)[line], load))
                for place, moves in zip(here, way.moves, strict=True):
                    if moves:
                        rows.restore(place)
            pull, load = (0.5 / way.step * (second - first) for first, second in zip(*found, strict=True))
            values += pull[way.entries], load[way.heights]
        rows.restore(before)
        row, column, used = self._pattern
        found_values = np.concatenate(values)[used] if values else np.zeros(0)
        if self._dense:
            return np.bincount(row * size + column, weights=found_values, minlength=size * size).reshape(
                size, size
            )
        from scipy.sparse import csc_array

        return csc_array((found_values, (row, column)), shape=(size, size))

    def _directions(self) -> Iterator[_Direction]:
        """What is displaced together, one after the other."""
        rows = self.rows
        line, count = rows.entry_rows, len(rows.inertia)
        for colour in range(int(self._colour.max(initial=-1)) + 1):
            bodies = np.flatnonzero(self._colour == colour)
            displaced = np.append(np.full(len(rows.block_owner), -1), -1)
            for body in bodies:
                displaced[self._blocks[body]] = body
            by = displaced[rows.block[line]]
            for k in range(int(self._widths[bodies].max())):
                wide = bodies[self._widths[bodies] > k]
                columns = self._firsts[wide] + k
                columns = columns[rows.inertia[columns] > 0.0]
                if not columns.size:
                    continue
                entries = np.flatnonzero(by >= 0)
                entries = entries[k < self._widths[by[entries]]]
                heights = [self._partners[body] for body in wide]
                step = DIFFERENCE * (self.size if k < 3 else 1.0)
                increment = np.zeros(count)
                increment[columns] = step
                moved = set(wide.tolist())
                moves = [bool(moved & set(kind.table["number"].tolist())) for kind in rows.layout.bodies]
                yield _Direction(
                    increment,
                    step,
                    moves,
                    entries,
                    np.concatenate(heights),
                    np.concatenate(
                        [
                            self._firsts[by[entries]] + k,
                            *(
                                np.full(len(h), self._firsts[b] + k)
                                for h, b in zip(heights, wide, strict=True)
                            ),
                        ]
                    ),
                )

    def _moved_arrays(self) -> list[list[NDArray[np.float64]]]:
        """Arrays of each kind of bodies that a displacement changes."""
        found = []
        for kind in self.rows.layout.bodies:
            before = [(array, array.copy()) for array in numbers_in(kind)]
            kind.move(np.full(len(self.rows.inertia), DIFFERENCE))
            found.append([array for array, content in before if array.tobytes() != content.tobytes()])
            self.rows.restore(before)
        return found

    def _places(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Row and column of what the directions find, over free velocities; which of it has one."""
        assert self._ways is not None
        rows, nothing = self.rows, np.zeros(0, dtype=np.int64)
        place = np.full(len(rows.inertia), -1)
        place[rows.free] = np.arange(len(rows.free))
        height = [part for way in self._ways for part in (rows.entry_columns[way.entries], way.heights)]
        row = place[np.concatenate([*height, nothing])]
        column = place[np.concatenate([*(way.columns for way in self._ways), nothing])]
        used = np.flatnonzero((row >= 0) & (column >= 0))
        return row[used], column[used], used

    def _changing(self, way: _Direction) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of `_at_rest` what changes with a displacement: of bodies that stay, forces on their markers."""
        load = np.zeros(len(self.rows.inertia))
        reaction = self._fill_rows()
        work = self.rows.layout.work
        for kind, loaded, moves in zip(self.rows.layout.bodies, self._loaded, way.moves, strict=True):
            if loaded is None or (moves and not loaded.alone):
                kind.collect_load(work, load)
            else:
                loaded.add(work, load)
        return load, reaction

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
