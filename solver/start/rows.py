"""The rows of a packed scene as sparse matrices, for the work before time starts.

Compiled operations fill markers, forces and rows, so every kind of joint is served; what is left is
linear algebra that happens once, and is done in Python with sparse matrices.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.records import LaneRecords, lane_records, numbers_in
from heavylift.solver.integrate.loop import start_scene
from heavylift.solver.layout import Layout
from heavylift.solver.rows.structure import (
    Row,
    RowSystem,
)
from heavylift.solver.statics.rows_at_rest import fill_rigid_rows

__all__ = ["StartRows", "listed", "plural", "quoted"]

SOFTNESS = (1e-10, 1e-13)
"""Of unit rows in units of the unit mass, far below what a step uses; the second if the first is not enough."""

REFINEMENTS = 10
"""Most rounds of refinement: redundant rows share, consistent ones are met to rounding."""

MET = 1e-14
"""Relative miss of the wanted rates that ends the refinement."""

SMALL = 450
"""Velocities and rows up to which dense matrices take less time than sparse ones, whose import alone takes longer than
most small scenes."""


class StartRows:
    """A scene with joints at its start; completes the start state of the bodies when made.

    Parameters
    ----------
    layout
        Packed scene.
    time
        [s].

    Attributes
    ----------
    names
        Of the joints, by block.
    block
        Of each row, shape (rows,).
    rigid
        Whether a row is rigid, shape (rows,).
    sides
        Numbers of the bodies of each block, -1 for the ground and for prescribed motion, shape (blocks, 2).
    block_owner
        Block that has the rows of each block, shape (blocks,).
    inertia
        Characteristic mass of each velocity, 0 if it is prescribed, shape (dof_count,).
    free
        Velocities that are not prescribed.
    owner
        Number of the body of each velocity, shape (dof_count,).

    Raises
    ------
    InputError
        If a kind of body cannot be placed before the start.
    """

    def __init__(self, layout: Layout, time: float = 0.0) -> None:
        self.layout, self.names, self.time = layout, layout.block_names, time
        self.start()
        self.inertia = self.survey()[1]
        self.free = np.flatnonzero(self.inertia)
        firsts = self.survey()[0][:, 0].astype(np.int64)
        order = np.argsort(firsts, kind="stable")  # meshes without bases share it with the next body
        widths = np.diff(np.append(firsts[order], len(self.inertia)))
        self.owner = np.repeat(order, widths)
        first = next(iter(layout.systems), None)  # of a scene without rows that of an integrator
        system: RowSystem | None = first if first is not None and "attachments" in first._fields else None
        self._system = system
        if system is None:
            self.block = np.zeros(0, dtype=np.int64)
            self._lane = self.block
            self._table: LaneRecords[Row] = lane_records(Row, 0, 1)
            self.sides, self.block_owner = np.zeros((0, 2), dtype=np.int64), self.block
            self._rows = self._columns = self._sources = self.block
            return
        blocks = len(system.attachments) // 2
        self._table = system.rows
        self.block, self._lane = np.nonzero(system.rows["scale"][:blocks] > 0.0)
        # sides beyond the second are those of blocks without rows, which follow
        with_rows = np.isin(np.arange(blocks), self.block)
        self.block_owner = np.maximum.accumulate(np.where(with_rows, np.arange(blocks), 0))
        self._rows, self._columns, self._sources = self._pattern(system)
        dofs = self._first_velocities(system).reshape(-1, 2)
        held = np.bincount(self.owner[self.free], minlength=len(firsts)) > 0
        number = np.where(dofs >= 0, self.owner[dofs], -1)
        self.sides = np.where(held[number] & (number >= 0), number, -1)

    def _first_velocities(self, system: Any) -> NDArray[np.int64]:
        """Of the body of each attachment; hulls that water couples are one body to joints, with six columns each."""
        dofs = np.array(system.attachments["dof"])
        groups = {int(dof) for kind in self.layout.bodies if kind.FLOATS for dof in kind.groups["dof"]}
        wide = [i for i in np.flatnonzero(system.attachments["width"] > 6) if int(dofs[i]) in groups]
        if wide:
            self.fill()
        lanes = system.lanes
        for i in wide:
            panel, width = system.attachments[i].panel, system.attachments[i].width
            columns = system.panels[panel : panel + width * lanes].reshape(width, lanes)
            dofs[i] += 6 * (int(np.argmax(np.any(columns != 0.0, axis=1))) // 6)
        return dofs

    def _pattern(self, system: Any) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Row, column and place in the panels of each entry of the Jacobian."""
        lanes = system.lanes
        first, last = (np.searchsorted(self.block, self.block_owner, side) for side in ("left", "right"))
        rows_of = np.repeat(last - first, 2)  # of each side
        side = np.repeat(np.arange(len(rows_of)), rows_of)
        row = (
            np.repeat(first, 2)[side]
            + np.arange(len(side))
            - np.repeat(np.cumsum(rows_of) - rows_of, rows_of)
        )
        attachment = system.attachments[side]
        width = attachment["width"]
        entry = np.repeat(np.arange(len(side)), width)
        k = np.arange(len(entry)) - np.repeat(np.cumsum(width) - width, width)
        sources = attachment["panel"][entry] + k * lanes + self._lane[row[entry]]
        return row[entry], attachment["dof"][entry] + k, sources

    def start(self) -> None:
        """Complete the state of the bodies after it was set."""
        start_scene(self.layout.bodies, self.layout.work, self.time)

    def survey(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Places of the bodies, inertia and velocity: see `heavylift.solver.interface.BodyKind`."""
        count = len(self.layout.work.velocity)
        places = np.zeros((len(self.layout.body_names), 8))
        inertia, velocity = np.zeros(count), np.zeros(count)
        for kind in self.layout.bodies:
            kind.survey(places, inertia, velocity)
        return places, inertia, velocity

    def move(self, increment: NDArray[np.float64]) -> None:
        """Displace the bodies."""
        for kind in self.layout.bodies:
            kind.move(increment)

    def put_velocity(self, velocity: NDArray[np.float64]) -> None:
        """Set the velocities."""
        for kind in self.layout.bodies:
            kind.put_velocity(velocity)
        self.start()

    def snapshot(self) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Arrays of bodies and joints with their contents, for `restore`."""
        kinds = (*self.layout.bodies, *self.layout.joints)
        return [(array, array.copy()) for kind in kinds for array in numbers_in(kind)]

    def restore(self, snapshot: list[tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
        """Put everything back."""
        for array, content in snapshot:
            array[...] = content

    def fill(self) -> None:
        """Rows at the present state."""
        layout = self.layout
        if self._system is not None:
            fill_rigid_rows(layout.bodies, layout.joints, self._system, layout.work, self.time)

    @property
    def places(self) -> NDArray[np.int64]:
        """Places of the rows in a table of all blocks and lanes, shape (rows,)."""
        lanes = 1 if self._system is None else self._system.lanes
        return self.block * lanes + self._lane

    def column(self, name: str) -> NDArray[np.float64]:
        """A field of `heavylift.solver.rows.structure.Row`, shape (rows,)."""
        return self._table[name][self.block, self._lane]

    @property
    def rigid(self) -> NDArray[np.bool_]:
        """Whether a row is rigid, shape (rows,)."""
        return self.column("compliance") == 0.0

    @property
    def residual(self) -> NDArray[np.float64]:
        """Violations [m] or [rad], shape (rows,)."""
        return self.column("residual")

    def put_reactions(self, reaction: NDArray[np.float64]) -> None:
        """Set the reactions of the rows [N] or [N m], shape (rows,)."""
        for name in ("reaction", "last_reaction"):
            self._table[name][self.block, self._lane] = reaction

    def jacobian(self) -> Any:
        """G of all rows over all velocities, sparse by rows, shape (rows, dof_count)."""
        from scipy.sparse import csr_array

        shape = (len(self.block), len(self.inertia))
        if self._system is None:
            return csr_array(shape)
        return csr_array((self._system.panels[self._sources], (self._rows, self._columns)), shape=shape)

    @property
    def small(self) -> bool:
        """Whether dense matrices take less time."""
        return len(self.free) + len(self.block) <= SMALL

    def matrix(self) -> Any:
        """`jacobian`, dense where the scene is small."""
        if not self.small:
            return self.jacobian()
        shape = (len(self.block), len(self.inertia))
        places = self._rows * shape[1] + self._columns
        return np.bincount(places, weights=self.entries(), minlength=shape[0] * shape[1]).reshape(shape)

    @property
    def entry_rows(self) -> NDArray[np.int64]:
        """Row of each entry of the Jacobian, in the order of `entries`."""
        return self._rows

    @property
    def entry_columns(self) -> NDArray[np.int64]:
        """Velocity of each entry of the Jacobian."""
        return self._columns

    def entries(self, some: Any = slice(None)) -> NDArray[np.float64]:
        """Entries of the Jacobian, or some of them."""
        return np.zeros(0) if self._system is None else self._system.panels[self._sources[some]]

    def metric(self) -> NDArray[np.float64]:
        """Inverse inertia of each velocity, 0 if it is prescribed."""
        inverse = np.zeros(len(self.inertia))
        inverse[self.free] = 1.0 / self.inertia[self.free]
        return inverse

    def unit(self, row: int, G: Any) -> str:
        """Unit of the residual of a row: a row that no translation changes is an angle."""
        if isinstance(G, np.ndarray):
            columns, values = np.arange(G.shape[1]), G[row]
        else:
            columns = G.indices[G.indptr[row] : G.indptr[row + 1]]
            values = G.data[G.indptr[row] : G.indptr[row + 1]]
        firsts = np.searchsorted(self.owner_starts, columns, side="right") - 1
        return "m" if np.any(values[columns - self.owner_starts[firsts] < 3]) else "rad"

    @property
    def owner_starts(self) -> NDArray[np.int64]:
        """First velocity of each body, increasing."""
        return np.flatnonzero(np.diff(self.owner, prepend=-1))

    @property
    def frame_starts(self) -> NDArray[np.int64]:
        """First velocity of each body that has a frame with a spin: of all but frames and shells."""
        starts = self.owner_starts
        return starts[~np.isin(self.owner[starts], sorted(self.mesh_bodies))]

    @property
    def mesh_bodies(self) -> set[int]:
        """Numbers of frames and shells, whose velocities are those of some of their material points."""
        numbers = (kind.table["number"] for kind in self.layout.bodies if not kind.FRAMES)
        return {int(number) for own in numbers for number in own}

    def unit_rows(
        self, G: Any, rows: NDArray[np.bool_], inertia: NDArray[np.float64]
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.float64]]:
        """Some rows as unit vectors over the free velocities times the root of an inertia; their lengths; the root."""
        root = np.sqrt(inertia[self.free])
        A = G[rows][:, self.free] * (1.0 / root)[None, :]
        norm = np.sqrt(np.asarray((A * A).sum(axis=1)).ravel())
        norm[norm == 0.0] = 1.0
        unit = A * (1.0 / norm)[:, None]
        return (unit if isinstance(G, np.ndarray) else unit.tocsc()), norm, root

    def closing(
        self,
        G: Any,
        rows: NDArray[np.bool_],
        inertia: NDArray[np.float64] | None = None,
        softness: float | None = None,
    ) -> Any:
        """A function that finds the smallest change of the velocities with ``G change = wanted`` on some rows.

        Parameters
        ----------
        G
            Jacobian.
        rows
            Which rows, shape (rows,).
        inertia
            In place of that of the bodies.
        softness
            Of unit rows, which is meant and not refined away.

        Returns
        -------
        callable
            From wanted rates (selected rows) to the change (dof_count) and the multipliers (selected rows).

        Notes
        -----
        Smallest in the metric of the mass: ``M change = G^T z``. With both as unknowns the matrix has the
        condition of G; ``G M^-1 G^T`` would have its square, too much for long chains. Redundant rows share
        by the softness, and what it leaves is asked for again. Dense rows are few, and rounding has no longer way than
        the softness: there the unknowns are z alone.
        """
        A, norm, root = self.unit_rows(G, rows, self.inertia if inertia is None else inertia)
        count = A.shape[1]

        def factor(soft: float) -> Any:
            if isinstance(A, np.ndarray):
                return partial(_solve_by_rows, A, A @ A.T + soft * np.eye(A.shape[0]))
            from scipy.sparse import block_array, eye_array
            from scipy.sparse.linalg import splu

            corner = soft * eye_array(A.shape[0])
            whole = block_array([[eye_array(count), -A.T], [A, corner]], format="csc")
            return splu(whole, permc_spec="MMD_AT_PLUS_A").solve

        solvers = [factor(SOFTNESS[0] if softness is None else softness)]

        def close(wanted: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
            sought = wanted / norm
            goal = MET * np.abs(sought).max(initial=0.0)
            both = solvers[0](np.concatenate([np.zeros(count), sought]))
            if softness is None:
                left = sought - A @ both[:count]
                for place, soft in enumerate(SOFTNESS):
                    for _ in range(REFINEMENTS):
                        if np.abs(left).max(initial=0.0) <= goal:
                            break
                        if place == len(solvers):
                            solvers.append(factor(soft))
                        both += solvers[place](np.concatenate([np.zeros(count), left]))
                        left = sought - A @ both[:count]
            change = np.zeros(len(self.inertia))
            change[self.free] = both[:count] / root
            return change, both[count:] / norm

        return close

    def worst(self, amounts: NDArray[np.float64], rows: NDArray[np.bool_], count: int = 3) -> list[int]:
        """One row a name, of those where an amount is largest; largest first."""
        found: dict[str, int] = {}
        for row in np.argsort(-np.where(rows, np.abs(amounts), -1.0), kind="stable"):
            if rows[row]:
                found.setdefault(self.names[self.block[row]], int(row))
            if len(found) == count:
                break
        return list(found.values())


def _solve_by_rows(
    A: NDArray[np.float64], S: NDArray[np.float64], both: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Change and multipliers with ``S z = wanted``, ``change = A^T z``; of a change that is wanted there is none."""
    z = np.linalg.solve(S, both[A.shape[1] :])
    return np.concatenate([A.T @ z, z])


def listed(words: Sequence[str], most: int = 12) -> str:
    """Words with commas, the last with "and"; long lists are cut."""
    if len(words) > most:
        words = [*words[: most - 1], f"{len(words) - most + 1} more"]
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def quoted(names: Sequence[str], most: int = 8) -> str:
    """Names in quotes, as a list."""
    return listed([f"'{name}'" for name in names], most)


def plural(count: int, word: str) -> str:
    """A count and a word."""
    return f"{count} {word}" + ("" if count == 1 else "s")
