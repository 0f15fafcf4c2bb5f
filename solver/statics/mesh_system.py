"""A scene with meshes as a static problem: coordinates of all meshes and velocities of all other bodies.

What meshes feel of joints, ropes and forces reaches them through their bases ``y = J q``, so with ``T`` made of J
and of unit rows for other bodies::

    G_x = G_y T,    F_x = T^T F_y,    K_x = T^T K_y T + K of the meshes

K_y, of all forces and reactions on bases and other bodies, comes from differences; that of the meshes does not.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.records import numbers_in
from heavylift.solver.bodies.ancf.at_rest import (
    difference_follower,
    fill_promised_stiffness,
    fill_stress_forces,
    fill_weight_and_loads,
    promise_strains,
)
from heavylift.solver.bodies.ancf.frame_data import frame_follower
from heavylift.solver.bodies.ancf.kind import FOLLOWER_ELEMENT, FOLLOWER_NODE
from heavylift.solver.bodies.ancf.sparse_matrices import MeshMatrices, mesh_matrices
from heavylift.solver.bodies.frames.base import FrameBodies
from heavylift.solver.integrate.loop import evaluate_loads
from heavylift.solver.interface import FORCES, Forces
from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.displacing import mover_of
from heavylift.solver.statics.forces import STEP, act_between, only_watches
from heavylift.solver.statics.rows_at_rest import fill_at_rest

__all__ = ["MeshSystem"]

LARGE_MOVE, LARGE_TURN = 0.3, 0.4
"""What counts as a large displacement: of the size of the scene, and in radians or as a change of a slope."""

DIFFERENCE = 1e-6
"""Displacement of the difference quotients, relative to the size of the scene, or in radians and slopes."""

DEPENDENT = 1e-9
"""Movement of a base relative to that of the one which is displaced that counts as none."""

LOADS = frozenset({"UniformGravity", "PointForces"})
"""Kinds of forces that are loads, which grow with the load factor; others are part of the scene."""


class MeshSystem:
    """A static problem, see `heavylift.solver.statics.problem`.

    Parameters
    ----------
    rows
        The scene; velocities are taken as zero.

    Attributes
    ----------
    meshes, others
        Kinds of meshes, of other bodies.
    first
        First unknown of each kind of meshes; those of other bodies come last.
    dofs
        Velocities of the workspace of the unknowns of other bodies.
    T
        Velocities of the workspace by unknowns, sparse by rows.
    """

    def __init__(self, rows: StartRows) -> None:
        from scipy.sparse import block_diag, coo_array, diags_array

        self.rows, self.layout = rows, rows.layout
        layout = rows.layout
        self.meshes = [kind for kind in layout.bodies if kind.NODAL]
        self.others = tuple(kind for kind in layout.bodies if not kind.NODAL)
        self.matrices: list[MeshMatrices] = [mesh_matrices(kind) for kind in self.meshes]
        counts = [len(matrices.places) for matrices in self.matrices]
        self.first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        self.base_dofs = [(m.dofs[:, None] + np.arange(3)).ravel() for m in self.matrices]
        on_mesh = np.zeros(len(rows.inertia), dtype=bool)
        for dofs in self.base_dofs:
            on_mesh[dofs] = True
        self.dofs = np.flatnonzero((rows.inertia > 0.0) & ~on_mesh)
        self._prescribed = (rows.inertia == 0.0) & ~on_mesh
        self.count = int(self.first[-1]) + len(self.dofs)

        parts = [(self.dofs, self.first[-1] + np.arange(len(self.dofs)), np.ones(len(self.dofs)))]
        for matrices, dofs, first in zip(self.matrices, self.base_dofs, self.first[:-1], strict=True):
            J = matrices.bases.tocoo()
            parts.append((dofs[J.coords[0]], first + J.coords[1], J.data))
        row, column, value = (np.concatenate(part) for part in zip(*parts, strict=True))
        self.T = coo_array((value, (row, column)), shape=(len(rows.inertia), self.count)).tocsr()
        masses = [matrices.mass for matrices in self.matrices]
        if len(self.dofs):
            masses.append(diags_array(rows.inertia[self.dofs]))
        self.mass = block_diag(masses, format="csc")

        self.length, self.heaviest = self._extent(), 0.0
        self.positions, self.scale = self._scales()
        # tables that kernels walk are made once: made anew at each call they took a third of the time
        groups = layout.forces.groups
        self._loads = Forces([kind for kind in layout.forces if type(kind).__name__ in LOADS], groups)
        self._inner = Forces([kind for kind in layout.forces if type(kind).__name__ not in LOADS], groups)
        if layout.systems:
            self._joint_rows = layout.systems[:1]
            self._fill = fill_at_rest.with_first(
                layout.bodies, self._inner, layout.joints, self._joint_rows, layout.work
            )
        self._changes = [matrices.base_changes() for matrices in self.matrices]
        self._together: _Together | None = None
        self._promised = False
        bare = all(type(kind).collect_load is FrameBodies.collect_load for kind in self.others)
        self._rows_alone = bare and all(
            type(kind).__name__ == "UniformGravity" or only_watches(kind) for kind in layout.forces
        )
        self._last_between: tuple[bytes, Any] = (b"", None)

    def _extent(self) -> float:
        """Size of the scene [m]."""
        places, inertia = self.rows.survey()[:2]
        sizes = [float(size) for kind in self.meshes for size in kind.body["size"]]
        sizes += [
            2.0 * float(np.sqrt(inertia[first + 3 : first + 6].max() / inertia[first]))
            for first in self.rows.owner_starts[np.isin(self.rows.owner_starts, self.dofs)]
        ]
        largest = max(sizes, default=0.0)
        return max(largest, float(np.linalg.norm(np.ptp(places[:, 1:4], axis=0)))) or 1.0

    def _scales(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Unknowns that are displacements, and what is large of each."""
        owner_first = self.rows.owner_starts
        kind = self.dofs - owner_first[np.searchsorted(owner_first, self.dofs, side="right") - 1]
        vector = np.concatenate(
            [*(matrices.vector for matrices in self.matrices), np.where(kind < 3, 0, kind // 3)]
        )
        sizes = np.concatenate(
            [
                *(mesh.body["size"][m.body] for mesh, m in zip(self.meshes, self.matrices, strict=True)),
                np.full(len(self.dofs), self.length),
            ]
        )
        scale = np.full(self.count, np.inf)
        scale[vector == 0] = LARGE_MOVE * sizes[vector == 0]
        mesh = np.arange(self.count) < self.first[-1]
        scale[(vector == 1) | (mesh & (vector == 2))] = LARGE_TURN
        return np.flatnonzero(vector == 0), scale

    # ---- position ----

    def snapshot(self) -> Any:
        """Coordinates of the meshes; arrays of other bodies and of joints."""
        arrays = [array for kind in (*self.others, *self.layout.joints) for array in numbers_in(kind)]
        arrays += [kind.position for kind in self.meshes]
        return [(array, array.copy()) for array in arrays]

    def restore(self, snapshot: Any) -> None:
        """Go back."""
        self._promised = False
        for array, content in snapshot:
            array[...] = content

    def advance(self, increment: NDArray[np.float64]) -> None:
        """Displace everything by a step of Newton's method.

        Notes
        -----
        The next stiffness has the stress that the step promises, not that of the shape, which a bend has stretched by
        the square of its displacement: D. Magisano, L. Leonetti, G. Garcea, Int. J. Numer. Meth. Eng. 109 (2017).
        """
        for kind, matrices, part in zip(self.meshes, self.matrices, self._split(increment), strict=True):
            kind.velocity_change[:] = 0.0
            kind.velocity_change[matrices.places] = part
            promise_strains(kind)
        self.move(increment)
        self._promised = True

    def move(self, increment: NDArray[np.float64]) -> None:
        """Displace everything."""
        for kind, matrices, part in zip(self.meshes, self.matrices, self._split(increment), strict=True):
            kind.position[matrices.places] += part
        if len(self.dofs):
            full = np.zeros(len(self.rows.inertia))
            full[self.dofs] = increment[self.first[-1] :]
            for kind in self.others:
                kind.move(full)

    def stop(self) -> None:
        """Take all velocities away."""
        for kind in self.meshes:
            kind.velocity[:] = 0.0
        self.rows.put_velocity(np.zeros(len(self.rows.inertia)))

    def _split(self, values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """Parts of a vector by kind of meshes."""
        return [values[a:b] for a, b in zip(self.first[:-1], self.first[1:], strict=True)]

    # ---- forces ----

    def internal_force(self) -> NDArray[np.float64]:
        """Stresses of the meshes; springs, ropes, compliant joints and modes, in balance with nothing."""
        force = np.zeros(self.count)
        for kind, matrices, part in zip(self.meshes, self.matrices, self._split(force), strict=True):
            fill_stress_forces(kind, False)
            part[:] = kind.right_hand_side[matrices.places] + matrices.bending_force(kind.position)
        if self._has_inner():
            pull, _ = self._inner_pull()
            force -= self.T.T @ pull
        return force

    def external_force(self) -> NDArray[np.float64]:
        """Weight, loads of the meshes, point forces."""
        layout = self.layout
        evaluate_loads(layout.bodies, self._loads, layout.work, self.rows.time)
        force = np.zeros(self.count)
        for kind, matrices, part in zip(self.meshes, self.matrices, self._split(force), strict=True):
            fill_weight_and_loads(kind, layout.work, self.rows.time)
            part[:] = (kind.right_hand_side + kind.external_force)[matrices.places]
        if len(self.dofs):
            pull = np.zeros(len(self.rows.inertia))
            for kind in self.others:
                kind.collect_load(layout.work, pull)
            force[self.first[-1] :] = (pull - self._elasticity())[self.dofs]
        return force

    def _has_inner(self) -> bool:
        """Whether there are joints, springs or bodies with modes."""
        return bool(self._inner or self.layout.systems or len(self.dofs))

    def _add_base_loads(self, load: NDArray[np.float64]) -> None:
        """``J^T f`` of the markers on meshes that forces act on."""
        work = self.layout.work
        for kind in self.meshes:
            for marker in kind.markers[kind.markers["level"] == FORCES]:
                number, line = marker.number, kind.table[marker.body]
                width = 3 * line.base_count
                force = work.markers[number].force
                load[line.dof : line.dof + width] += work.jacobian[number, :, :width].T @ force

    def _elasticity(self) -> NDArray[np.float64]:
        """Elasticity of bodies with modes, shape (dof_count,); forces of the markers are lost."""
        work, pull = self.layout.work, np.zeros(len(self.rows.inertia))
        work.markers["force"] = 0.0
        work.sums.gravity[:] = 0.0
        for kind in self.others:
            kind.collect_load(work, pull)
        return pull

    def _inner_pull(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Forces of all but loads, rigid joints and meshes (dof_count); reactions of the compliant rows (rows)."""
        pull, reaction = self._inner_parts()
        if self.layout.systems:
            pull += self.rows.jacobian().T @ reaction
        pull[self._prescribed] = 0.0
        return pull, reaction

    def _inner_parts(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The same, but what the rows do is their reactions only."""
        rows, layout = self.rows, self.layout
        layout.work.velocity[:] = 0.0
        if layout.systems:
            self._fill(rows.time, STEP)
        else:
            evaluate_loads(layout.bodies, self._inner, layout.work, rows.time)
        pull = np.zeros(len(rows.inertia))
        if not self._rows_alone:
            for kind in self.others:
                kind.collect_load(layout.work, pull)
            self._add_base_loads(pull)
        reaction = np.zeros(len(rows.block))
        if layout.systems:
            soft = ~rows.rigid
            reaction[soft] = 2.0 * rows.column("target")[soft] / (STEP * rows.column("softness")[soft])
        return pull, reaction

    def reactions(self, multipliers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of all rows at the present position, shape (rows,)."""
        if not self.layout.systems:
            return np.zeros(0)
        reaction = self._inner_pull()[1]
        reaction[self.rows.rigid] = multipliers
        return reaction

    def joints(self) -> tuple[Any, NDArray[np.float64]]:
        """Rigid rows over the unknowns, and their gaps."""
        from scipy.sparse import csr_array

        if not self.layout.systems:
            return csr_array((0, self.count)), np.zeros(0)
        self.rows.fill()
        rigid = self.rows.rigid
        return (self.rows.jacobian()[rigid] @ self.T).tocsr(), self.rows.residual[rigid]

    def all_rows(self) -> Any:
        """Rows of all joints, compliant ones too, over the unknowns."""
        from scipy.sparse import csr_array

        if not self.layout.systems:
            return csr_array((0, self.count))
        self.rows.fill()
        return (self.rows.jacobian() @ self.T).tocsr()

    # ---- stiffness ----

    def tangent(self, factor: float, multipliers: NDArray[np.float64]) -> Any:
        """Stiffness of everything, sparse by columns."""
        from scipy.sparse import block_diag, csc_array

        parts: list[Any] = []
        for kind, matrices in zip(self.meshes, self.matrices, strict=True):
            if self._promised:
                fill_promised_stiffness(kind)
            else:
                fill_stress_forces(kind, True)
            parts.append(matrices.stiffness(kind.blocks))
            follower = self._follower(kind, matrices)
            if follower is not None:
                parts[-1] = parts[-1] - factor * follower
        if len(self.dofs):
            parts.append(csc_array((len(self.dofs), len(self.dofs))))
        K = parts[0] if len(parts) == 1 else block_diag(parts, format="csc")
        if self._has_inner() or self._turning_loads():
            K = (K + self.T.T @ self.between(factor, multipliers) @ self.T).tocsc()
        return K

    def _turning_loads(self) -> bool:
        """Whether point forces turn with bodies."""
        return any(
            type(kind).__name__ == "PointForces" and np.any(kind.table["axes"] >= 0) for kind in self._loads
        )

    def _follower(self, kind: Any, matrices: MeshMatrices) -> Any:
        """Derivative of follower loads; None if there are none."""
        from scipy.sparse import csc_array

        count = len(matrices.places)
        entries: list[tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]] = []
        body_of = matrices.load_bodies(kind)
        for load, line in enumerate(kind.loads):
            if line.type not in (FOLLOWER_ELEMENT, FOLLOWER_NODE):
                continue
            table = kind.constants[line.table :][: 2 * line.table_length].reshape(2, -1)
            amount = float(np.interp(self.rows.time, table[0], table[1]))
            if line.type == FOLLOWER_ELEMENT:
                nodes = kind.elements[line.place].nodes[: matrices.nodes]
                places = (nodes[:, None] + np.arange(matrices.rows)).ravel()
                out = np.zeros((len(places), len(places)))
                difference_follower(kind, int(body_of[load]), load, amount, DIFFERENCE, places, out)
            else:
                places = line.place + np.arange(matrices.rows)
                given = frame_follower(kind.constants, line.data)
                out = amount * _node_follower(
                    kind.position[places], given.normal * given.axis, given.tangential
                )
            number = matrices.number(places)
            entries.append((np.repeat(number, len(number)), np.tile(number, len(number)), out.ravel()))
        if not entries:
            return None
        row, column, value = (np.concatenate(part) for part in zip(*entries, strict=True))
        kept = (row >= 0) & (column >= 0) & (value != 0.0)
        return csc_array((value[kept], (row[kept], column[kept])), shape=(count, count))

    @property
    def has_springs(self) -> bool:
        """Whether springs, ropes or compliant joints act."""
        return bool(self._inner) or (bool(self.layout.systems) and not bool(np.all(self.rows.rigid)))

    def between(self, factor: float, multipliers: NDArray[np.float64] | None = None) -> Any:
        """Minus the derivative of forces on bases and other bodies by velocities of the workspace; reactions kept.

        Directions that no row, no body and no base has in common are displaced together, see `_Together`. What was
        found last is kept: searches come back to where a step began.
        """
        if multipliers is None:
            multipliers = np.zeros(int(np.count_nonzero(self.rows.rigid)) if self.layout.systems else 0)
        here = [np.array([factor]), multipliers, *(kind.position for kind in self.meshes)]
        for kind in self.others:
            here += kind.poses() if isinstance(kind, FrameBodies) else numbers_in(kind)
        key = b"".join(array.tobytes() for array in here)
        if key != self._last_between[0]:
            self._last_between = key, self._difference(factor, multipliers)
        return self._last_between[1]

    def _difference(self, factor: float, multipliers: NDArray[np.float64]) -> Any:
        """`between` of the present position, by central differences."""
        from scipy.sparse import csc_array

        count = len(self.rows.inertia)
        if self._together is None:
            step = DIFFERENCE * self.length
            self._movers = [mover_of(kind, count, step, DIFFERENCE) for kind in self.others]
            self._together = _Together.of(self)
        together, before = self._together, self.snapshot()
        for mover in self._movers:
            mover.begin()
        here = [np.array(kind.position) for kind in self.meshes]
        values = []
        for group in together.groups:
            sides = []
            for sign in (0, 1):
                for kind, (places, shift), rest in zip(self.meshes, group.meshes, here, strict=True):
                    kind.position[places] = rest[places] + (shift if sign == 0 else -shift)
                for mover, pick in zip(self._movers, group.picks, strict=True):
                    if pick is not None:
                        mover.move(pick, sign)
                sides.append(self._parts(factor, multipliers, together)[group.changed])
                for kind, (places, _), rest in zip(self.meshes, group.meshes, here, strict=True):
                    kind.position[places] = rest[places]
                for mover, pick in zip(self._movers, group.picks, strict=True):
                    if pick is not None:
                        mover.put_back(pick)
            values.append(0.5 * (sides[1] - sides[0]) / group.steps)
        self.restore(before)
        if not values:
            return csc_array((count, count))
        found = np.concatenate(values)
        kept = np.flatnonzero(found)
        return csc_array((found[kept], (together.rows[kept], together.columns[kept])), shape=(count, count))

    def directions(self) -> list[tuple[int, NDArray[np.float64], float]]:
        """Velocity of the workspace, displacement of the unknowns that belongs to it alone, step of the difference."""
        found = []
        for first, changes, dofs, kind in zip(
            self.first[:-1], self._changes, self.base_dofs, self.meshes, strict=True
        ):
            step = DIFFERENCE * float(kind.body["size"].max())
            for column, dof in enumerate(dofs):
                if changes[:, column].any():
                    direction = np.zeros(self.count)
                    direction[first : first + len(changes)] = changes[:, column]
                    found.append((int(dof), direction, step))
        for place, dof in enumerate(self.dofs):
            direction = np.zeros(self.count)
            direction[self.first[-1] + place] = 1.0
            step = DIFFERENCE * (self.length if np.isin(self.first[-1] + place, self.positions) else 1.0)
            found.append((int(dof), direction, step))
        return found

    def displaced(self, increment: NDArray[np.float64]) -> tuple[list[Any], list[Any]]:
        """An increment of the unknowns: places and displacements of each kind of meshes; what each mover needs."""
        meshes = []
        for matrices, part in zip(self.matrices, self._split(increment), strict=True):
            own = np.flatnonzero(part)
            meshes.append((matrices.places[own], part[own]))
        full = np.zeros(len(self.rows.inertia))
        full[self.dofs] = increment[self.first[-1] :]
        return meshes, [mover.pick(full) for mover in self._movers]

    def _parts(
        self, factor: float, multipliers: NDArray[np.float64], together: _Together
    ) -> NDArray[np.float64]:
        """What some entries of the Jacobian do, then forces without rows on bases and other bodies (dof_count)."""
        rows, layout = self.rows, self.layout
        pull, reaction = self._inner_parts()
        rowwise = np.zeros(0)
        if layout.systems:
            reaction[rows.rigid] = multipliers
            rowwise = rows.entries(together.entries) * reaction[together.line]
        if self._rows_alone:
            return np.concatenate([rowwise, pull])
        evaluate_loads(layout.bodies, self._loads, layout.work, rows.time)
        load = np.zeros(len(rows.inertia))
        for kind in self.others:
            kind.collect_load(layout.work, load)
        self._add_base_loads(load)
        pull = pull + factor * (load - self._elasticity())
        pull[self._prescribed] = 0.0
        return np.concatenate([rowwise, pull])

    # ---- words ----

    def body_unknowns(self) -> dict[int, tuple[Any, MeshMatrices, int]]:
        """Kind, matrices and first unknown by number of each mesh."""
        return {
            int(line.number): (kind, matrices, int(first))
            for kind, matrices, first in zip(self.meshes, self.matrices, self.first[:-1], strict=True)
            for line in kind.table
        }


def _node_follower(q: NDArray[np.float64], a: NDArray[np.float64], along: float) -> NDArray[np.float64]:
    """Derivative of ``a x u + along u`` with the unit tangent ``u = t/|t|`` of a node, by its coordinates ``r, t``."""
    size = float(np.linalg.norm(q[3:6]))
    u = q[3:6] / size
    turn = np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
    change = (turn + along * np.eye(3)) @ (np.eye(3) - np.outer(u, u)) / size
    found = np.zeros((len(q), len(q)))
    found[:3, 3:6] = change
    return found


@dataclass(frozen=True)
class _Group:
    """Directions that are displaced together.

    Attributes
    ----------
    meshes
        Of each kind of meshes, coordinates that are displaced and how far.
    picks
        What each mover of other bodies needs to know.
    changed, steps
        Which of the forces change, and the displacement that changes each [m] or [rad].
    """

    meshes: list[tuple[NDArray[np.int64], NDArray[np.float64]]]
    picks: list[Any]
    changed: NDArray[np.int64]
    steps: NDArray[np.float64]


@dataclass(frozen=True)
class _Together:
    """Which directions are displaced together (Curtis, Powell and Reid, J. Inst. Maths. Applics. 13, 1974).

    What changes a force is known by its *edge*: the rows of a block, or the loads on a body or base. No two directions
    of a group touch the same one. Forces between bodies that have no rows make one edge of all loads.

    Attributes
    ----------
    groups
        What is displaced, one after the other.
    entries, line
        Entries of the Jacobian that can be other than zero, and their rows: rows on a mesh are as wide as all of its
        bases.
    rows, columns
        Velocities of the workspace on which what changes acts, and which are displaced; group by group.
    """

    groups: list[_Group]
    entries: NDArray[np.int64]
    line: NDArray[np.int64]
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]

    @staticmethod
    def of(system: MeshSystem) -> _Together:
        """Find them at the present position."""
        rows = system.rows
        count = len(rows.inertia)
        unit = rows.owner.astype(np.int64)
        on_mesh = np.zeros(count, dtype=bool)
        for dofs in system.base_dofs:
            on_mesh[dofs] = True
            unit[dofs] = int(unit.max(initial=-1)) + 1 + np.arange(len(dofs)) // 3
        block_count, unit_count = len(rows.block_owner), int(unit.max(initial=-1)) + 1
        if system.layout.systems:
            rows.fill()
        line, dof = rows.entry_rows, rows.entry_columns
        block = rows.block[line]
        pair = block * unit_count + unit[dof]
        acts = ~on_mesh[dof] | np.isin(pair, pair[rows.entries() != 0.0])
        entries = np.flatnonzero(acts)
        loads = block_count + unit
        if act_between(system.layout.forces):
            loads[:] = block_count  # one edge of all loads
        of_unit: list[set[int]] = [set() for _ in range(unit_count)]
        for number, own in zip(unit[dof[entries]], block[entries], strict=True):
            of_unit[number].add(int(own))
        for number, own in zip(unit, loads, strict=True):
            of_unit[number].add(int(own))
        edges: dict[Any, list[int]] = {}
        groups: list[list[Any]] = []
        taken: list[set[int]] = []
        for one in system.directions():
            moved = np.abs(system.T @ one[1])
            touched: set[int] = set()
            for number in np.unique(unit[moved > DEPENDENT * moved.max(initial=0.0)]):
                touched |= of_unit[number]
            edges[one[0]] = sorted(touched)
            place = next((k for k, others in enumerate(taken) if not touched & others), len(groups))
            if place == len(groups):
                groups.append([])
                taken.append(set())
            groups[place].append(one)
            taken[place] |= touched
        edge = np.concatenate([block[entries], loads])
        height = np.concatenate([dof[entries], np.arange(count)])
        made, heights, columns = [], [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
        for group in groups:
            number = np.full(block_count + unit_count, -1)
            for k, (column, _, _) in enumerate(group):
                number[edges[column]] = k
            by = number[edge]
            changed = np.flatnonzero(by >= 0)
            increment = np.asarray(sum(step * direction for _, direction, step in group))
            steps = np.array([step for _, _, step in group])[by[changed]]
            made.append(_Group(*system.displaced(increment), changed, steps))
            heights.append(height[changed])
            columns.append(np.array([column for column, _, _ in group])[by[changed]])
        return _Together(made, entries, line[entries], np.concatenate(heights), np.concatenate(columns))
