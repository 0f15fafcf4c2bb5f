"""What the joints of a scene leave free, and where they hold more than once, in sentences with names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.start.body_graph import BodyGraph, Core, Pair, body_graph
from heavylift.solver.start.consistent_start import close_positions
from heavylift.solver.start.motion_words import motion_words, move_words
from heavylift.solver.start.row_rank import DENSE, null_spaces, rank_of
from heavylift.solver.start.rows import StartRows, plural, quoted

__all__ = ["Diagnosis", "diagnose"]

EXACT = 1e-8
"""Singular values of unit rows below which they count as dependent, in joints that are closed to rounding."""

NEARBY = 0.02
"""Displacement of the nearby position, in lengths of a body or radians."""

SENTENCES = 50
"""Joints outside of loops whose motions are described one by one."""

NAMED = 12
"""Motions of a loop up to which each is looked at."""


@dataclass(frozen=True)
class Diagnosis:
    """Freedom and redundancy of the rigid joints.

    Attributes
    ----------
    degrees_of_freedom
        Velocities that the joints leave free at the start, modes included.
    row_count, rank
        Rigid rows, and how many of them are independent.
    redundant, free_motions
        Sentences that name joints and bodies.
    singular
        Whether this position differs from its neighbours: more rows depend on each other here than nearby, or
        a motion is possible at first sight only. None if there was nothing to compare, or too much.
    """

    degrees_of_freedom: int
    row_count: int
    rank: int
    redundant: tuple[str, ...]
    free_motions: tuple[str, ...]
    singular: bool | None


@dataclass(frozen=True)
class _Scaled:
    """Rigid rows with velocities in lengths: unit rows, so that a rank does not depend on units."""

    matrix: Any
    block: NDArray[np.int64]
    owner: NDArray[np.int64]
    tolerance: float

    def rows(self, blocks: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
        """Rows of some blocks; those of a block follow each other."""
        each = np.unique(blocks)
        first, last = np.searchsorted(self.block, each), np.searchsorted(self.block, each, side="right")
        return np.concatenate([np.arange(a, b) for a, b in zip(first, last, strict=True)])

    def columns(self, bodies: Sequence[int]) -> NDArray[np.int64]:
        """Free velocities of some bodies."""
        return np.flatnonzero(np.isin(self.owner, bodies))

    def dense(self, blocks: Sequence[int], bodies: Sequence[int]) -> NDArray[np.float64]:
        """Rows of some blocks over the free velocities of some bodies."""
        rows, columns = self.rows(blocks), self.columns(bodies)
        found = np.zeros((len(rows), len(columns)))
        if columns.size:
            for i, row in enumerate(rows):
                begin, end = self.matrix.indptr[row], self.matrix.indptr[row + 1]
                place = np.searchsorted(columns, self.matrix.indices[begin:end])
                here = columns[np.minimum(place, len(columns) - 1)] == self.matrix.indices[begin:end]
                found[i, place[here]] = self.matrix.data[begin:end][here]
        return found


def diagnose(rows: StartRows) -> Diagnosis:
    """Look at the joints in the present position, which has to be closed.

    Parameters
    ----------
    rows
        The scene; it is displaced and put back.
    """
    rows.fill()
    scaled, lengths = _scaled(rows)
    if rows.mesh_bodies:
        return _count_with_meshes(rows, scaled)
    rigid_blocks = np.unique(scaled.block)
    sides = np.where(np.isin(np.arange(len(rows.sides)), rigid_blocks)[:, None], rows.sides, -1)
    count = len(rows.layout.body_names)
    free = np.bincount(rows.owner[rows.free], minlength=count)
    width = np.bincount(rows.owner, minlength=count)
    graph = body_graph(count, sides, (width != 6) | ((free != 6) & (free != 0)))
    moving = set(np.flatnonzero(free).tolist())

    places = rows.survey()[0]
    ranks = [rank_of(*_core_part(scaled, core), scaled.tolerance) for core in graph.cores]
    names = rows.layout.body_names
    rank, loose = sum(ranks), 0
    texts: list[tuple[Pair, int]] = []
    motions: list[str] = []
    for bridge in graph.bridges:
        own, null, _ = null_spaces(scaled.dense(bridge.blocks, bridge.bodies[1:]), scaled.tolerance)
        rank += own
        row_count = len(scaled.rows(bridge.blocks))
        if row_count > own:
            texts.append((bridge, row_count - own))
        loose += null.shape[1]
        if null.shape[1] and len(motions) < SENTENCES:
            own_lengths = lengths[scaled.columns(bridge.bodies[1:]), None]
            motions.append(_bridge_motion(rows, places[bridge.bodies[1]], bridge, null * own_lengths))
    if len(motions) == SENTENCES:
        motions.append(f"all joints outside of loops leave {plural(loose, 'motion')} together")
    near = _nearby(rows, scaled, lengths, graph, ranks)
    redundant = [
        f"{_joints(rows, bridge.blocks)} hold {names[bridge.bodies[1]]!r} with"
        f" {plural(more, 'row')} too many: how they share their forces is not unique"
        for bridge, more in texts
    ]
    for core, core_rank in zip(graph.cores, ranks, strict=True):
        redundant += _core_redundancy(rows, scaled, near, core, core_rank)
        motions += _core_motions(rows, scaled, lengths, core, core_rank)
    for bodies in graph.floating:
        held = [names[body] for body in bodies if body in moving]
        if len(held) == 1:
            motions.append(f"no joint holds {held[0]!r}")
        elif held:
            motions.append(f"{quoted(held)} hang together, and no joint holds them to anything else")
    singular = None if near is None else near.ranks != ranks or near.stuck
    if near is not None and near.stuck:
        motions.append("in this position only: at second sight the joints allow less motion than that")
    return Diagnosis(
        degrees_of_freedom=len(rows.free) - rank,
        row_count=scaled.matrix.shape[0],
        rank=rank,
        redundant=tuple(redundant),
        free_motions=tuple(motions),
        singular=singular,
    )


def _count_with_meshes(rows: StartRows, scaled: _Scaled) -> Diagnosis:
    """Degrees of freedom only: what a mesh that deforms at will leaves free has no name."""
    rank = rank_of(scaled.matrix, scaled.owner, scaled.tolerance)
    meshes = [kind for kind in rows.layout.bodies if "strain" in kind._fields]
    coordinates = sum(int(kind.free.sum()) - 3 * int(kind.table["base_count"].sum()) for kind in meshes)
    return Diagnosis(
        degrees_of_freedom=len(rows.free) + coordinates - rank,
        row_count=scaled.matrix.shape[0],
        rank=rank,
        redundant=(),
        free_motions=(),
        singular=None,
    )


def _scaled(rows: StartRows) -> tuple[_Scaled, NDArray[np.float64]]:
    """Unit rows over the free velocities, and the factors that take scaled velocities back."""
    inertia, owner = rows.inertia, rows.owner
    lengths = np.ones(len(rows.free))
    meshes = rows.mesh_bodies
    for body in np.unique(owner[rows.free]):
        own = np.flatnonzero(owner == body)
        if body in meshes:
            continue  # translations of material points only
        mass = inertia[own[:3]].max()
        place = np.flatnonzero(owner[rows.free] == body)
        kind = rows.free[place] - own[0]
        if mass > 0.0:
            gyration = np.sqrt(inertia[own[3:6]].max() / mass)
            lengths[place] = np.where(kind < 3, gyration, np.where(kind < 6, 1.0, gyration * np.sqrt(mass)))
    if not rows.rigid.any():  # a scene without joints need not wait for an import
        nothing = np.zeros((0, len(rows.free)))
        return _Scaled(nothing, rows.block[rows.rigid], owner[rows.free], EXACT), lengths
    from scipy.sparse import diags_array

    G = (rows.jacobian()[rows.rigid][:, rows.free] * lengths[None, :]).tocsr()
    norm = np.sqrt(np.asarray((G * G).sum(axis=1)).ravel())
    norm[norm == 0.0] = 1.0
    violation = float(np.abs(rows.residual[rows.rigid]).max(initial=0.0))
    unit = (diags_array(1.0 / norm) @ G).tocsr() if len(norm) else G
    unit.eliminate_zeros()
    unit.sort_indices()
    tolerance = EXACT + 30.0 * violation / min(1.0, float(lengths.min(initial=1.0)))
    return _Scaled(unit, rows.block[rows.rigid], owner[rows.free], tolerance), lengths


def _core_part(scaled: _Scaled, core: Core) -> tuple[Any, NDArray[np.int64]]:
    """Rows of a core and the body of each of its columns."""
    blocks = [block for pair in core.pairs for block in pair.blocks]
    columns = scaled.columns(core.bodies)
    part = scaled.matrix[scaled.rows(blocks)][:, columns].tocsr()
    part.sort_indices()
    return part, scaled.owner[columns]


@dataclass(frozen=True)
class _Nearby:
    """The same rows in a nearby position, the ranks of the cores there, and whether it could not be reached."""

    scaled: _Scaled
    ranks: list[int]
    stuck: bool


def _nearby(
    rows: StartRows, scaled: _Scaled, lengths: NDArray[np.float64], graph: BodyGraph, ranks: list[int]
) -> _Nearby | None:
    """Move a little along what is free inside the cores, close the joints again, and compare."""
    if not graph.cores or scaled.matrix.shape[1] > DENSE:
        return None
    random = np.random.default_rng(1)
    step = np.zeros(len(rows.free))
    for core in graph.cores:
        own = scaled.columns(core.bodies)
        null = null_spaces(_core_part(scaled, core)[0].toarray(), scaled.tolerance)[1]
        if null.shape[1]:
            direction = null @ random.normal(size=null.shape[1])
            step[own] = direction / np.abs(direction).max()
    if not step.any():
        return None
    increment = np.zeros(len(rows.inertia))
    increment[rows.free] = NEARBY * step * lengths
    before = rows.snapshot()
    place = rows.survey()[0]
    rows.move(increment)
    closed = close_positions(rows)
    moved = rows.survey()[0]
    there = _scaled(rows)[0]
    near = [rank_of(*_core_part(there, core), there.tolerance) for core in graph.cores]
    went = np.abs(moved[:, 1:] - place[:, 1:]).max()
    rows.restore(before)
    rows.start()
    rows.fill()
    wanted = np.abs(increment).max()
    return _Nearby(there, near if closed else ranks, closed and bool(went < 0.05 * wanted))


def _core_redundancy(
    rows: StartRows, scaled: _Scaled, near: _Nearby | None, core: Core, rank: int
) -> list[str]:
    """Sentences on the loops of a core that have rows too many, shortest first."""
    blocks = np.array([block for pair in core.pairs for block in pair.blocks])
    own_rows = scaled.rows(blocks)
    missing = len(own_rows) - rank
    known = np.zeros((len(own_rows), 0))
    texts: list[str] = []
    groups = [(pair,) for pair in core.pairs if len(pair.blocks) > 1] + list(core.loops)
    for loop in groups:
        if missing == 0:
            break
        loop_blocks = tuple(block for pair in loop for block in pair.blocks)
        bodies = {body for pair in loop for body in pair.bodies}
        _, _, left = null_spaces(scaled.dense(loop_blocks, tuple(bodies)), scaled.tolerance)
        if not left.shape[1]:
            continue
        more = left.shape[1]
        if len(own_rows) <= 6 * DENSE:
            vectors = np.zeros((len(own_rows), more))
            vectors[np.isin(scaled.block[own_rows], loop_blocks)] = left
            u, sigma, _ = np.linalg.svd(vectors - known @ (known.T @ vectors), full_matrices=False)
            known = np.hstack([known, u[:, sigma > 1e-4]])
            more = int(np.count_nonzero(sigma > 1e-4))
        more = min(more, missing)
        if not more:
            continue
        missing -= more
        verb = "hold the same bodies" if len(loop) == 1 else "close a loop"
        where = ""
        if near is not None:
            there = near.scaled.dense(loop_blocks, tuple(bodies))
            always = len(there) - null_spaces(there, near.scaled.tolerance)[0]
            if always < left.shape[1]:
                where = f", {'all' if always == 0 else left.shape[1] - always} of them in this position only"
        texts.append(
            f"{_joints(rows, loop_blocks)} {verb} with {plural(more, 'row')} too many{where}:"
            " how they share their forces is not unique"
        )
    if missing:
        texts.append(
            f"{_joints(rows, blocks)} together have {plural(missing, 'row')}"
            f"{' more' if texts else ''} too many: how they share their forces is not unique"
        )
    return texts


def _core_motions(
    rows: StartRows, scaled: _Scaled, lengths: NDArray[np.float64], core: Core, rank: int
) -> list[str]:
    """A sentence on what moves inside the loops of a core."""
    names = [rows.layout.body_names[body] for body in core.bodies]
    part, _ = _core_part(scaled, core)
    count = part.shape[1] - rank - (0 if core.grounded else 6)
    if count <= 0:
        return []
    head = f"{quoted(names)} in loops have {plural(count, 'motion')} of their own"
    if part.shape[1] > DENSE or count > NAMED:
        return [head]
    null = null_spaces(part.toarray(), scaled.tolerance)[1] * lengths[scaled.columns(core.bodies), None]
    places = rows.survey()[0]
    own = rows.free[scaled.columns(core.bodies)]
    full = np.zeros((len(rows.inertia), null.shape[1]))
    full[own] = null
    if not core.grounded:
        full = _without_common(rows, places, core.bodies, full, count)
    moving = [
        body
        for body in core.bodies
        if np.abs(full[rows.owner == body]).max(initial=0.0) > 1e-6 * np.abs(full).max()
    ]
    if count > 1:
        return [f"{head}, in which {quoted([rows.layout.body_names[body] for body in moving])} move"]
    words = [
        f"{rows.layout.body_names[body]!r} {move_words(places[body], full[int(places[body, 0]) :][:6, 0])}"
        for body in moving[:4]
    ]
    return [f"{head}: " + ", ".join(words) + (" and so on" if len(moving) > 4 else "")]


def _without_common(
    rows: StartRows,
    places: NDArray[np.float64],
    bodies: Sequence[int],
    motions: NDArray[np.float64],
    count: int,
) -> NDArray[np.float64]:
    """Take the motion of a group as a whole out: the first body stands still."""
    first = rows.owner == bodies[0]
    u, sigma, vt = np.linalg.svd(motions[first])
    del u
    rank = int(np.count_nonzero(sigma > 1e-9 * sigma.max()))
    return (motions @ vt[rank:].T)[:, :count]


def _bridge_motion(
    rows: StartRows, place: NDArray[np.float64], bridge: Pair, null: NDArray[np.float64]
) -> str:
    """How the group beyond a bridge moves relative to what holds it."""
    names = rows.layout.body_names
    held, moved = bridge.bodies
    base = "" if held == len(names) else f" relative to {names[held]!r}"
    more = len(bridge.beyond) - 1
    hanging = f" (and {plural(more, 'body')} on it)".replace("bodys", "bodies") if more else ""
    words = motion_words(place, null)
    return f"{names[moved]!r}{hanging} can {words}{base}, at {_joints(rows, bridge.blocks)}"


def _joints(rows: StartRows, blocks: Sequence[int] | NDArray[np.int64]) -> str:
    """Names of joints, each once."""
    names = list(dict.fromkeys(rows.names[block] for block in blocks))
    return f"{'joint' if len(names) == 1 else 'joints'} {quoted(names)}"
