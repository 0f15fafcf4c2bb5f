"""What the joints of a scene leave free, and where they hold more than once, in sentences with names.

A bridge is a pair of bodies whose joints, taken away, would leave one of them and all beyond it apart: its
joints act on the relative motion of two rigid groups and on nothing else, whatever happens inside these. What
is left when all bridges are cut are the *cores*, in which joints close loops.

Ranks are dense where that is cheap, and found body by body where it is not.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.sparse_rows import SparseRows
from heavylift.solver.start.consistent_start import close_positions
from heavylift.solver.start.motion_words import motion_words, move_words
from heavylift.solver.start.rows import StartRows, plural, quoted

__all__ = [
    "BodyGraph",
    "Core",
    "Diagnosis",
    "Pair",
    "ScaledRows",
    "block_rank",
    "body_graph",
    "core_part",
    "diagnose",
    "joint_graph",
    "move_nearby",
    "null_spaces",
    "rank_of",
    "scale_rows",
]

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
class ScaledRows:
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
    scaled, lengths = scale_rows(rows)
    if rows.mesh_bodies:
        return _count_with_meshes(rows, scaled)
    graph, moving = joint_graph(rows, scaled)
    places = rows.survey()[0]
    ranks = [rank_of(*core_part(scaled, core), scaled.tolerance) for core in graph.cores]
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
    near = move_nearby(rows, scaled, lengths, graph, ranks, DENSE)
    redundant = [
        f"{_joints(rows, bridge.blocks)} hold {names[bridge.bodies[1]]!r} with"
        f" {plural(more, 'row')} too many: the distribution of their forces is not unique"
        for bridge, more in texts
    ]
    for core, core_rank in zip(graph.cores, ranks, strict=True):
        redundant += _core_redundancy(rows, scaled, near, core, core_rank)
        motions += _core_motions(rows, scaled, lengths, core, core_rank)
    for bodies in graph.floating:
        loose_bodies = [names[body] for body in bodies if body in moving]
        if len(loose_bodies) == 1:
            motions.append(f"no joint holds {loose_bodies[0]!r}")
        elif loose_bodies:
            motions.append(f"{quoted(loose_bodies)} hang together, and no joint holds them to anything else")
    singular = None if near is None else near.ranks != ranks or near.stuck
    if near is not None and near.stuck:
        motions.append("in this position only: to second order the joints allow less motion than that")
    return Diagnosis(
        degrees_of_freedom=len(rows.free) - rank,
        row_count=scaled.matrix.shape[0],
        rank=rank,
        redundant=tuple(redundant),
        free_motions=tuple(motions),
        singular=singular,
    )


def joint_graph(rows: StartRows, scaled: ScaledRows) -> tuple[BodyGraph, set[int]]:
    """Bridges and cores of the rigid joints, and the bodies that have free velocities."""
    rigid_blocks = np.unique(scaled.block)
    sides = np.where(np.isin(np.arange(len(rows.sides)), rigid_blocks)[:, None], rows.sides, -1)
    count = len(rows.layout.body_names)
    free = np.bincount(rows.owner[rows.free], minlength=count)
    width = np.bincount(rows.owner, minlength=count)
    sides, more = _touched(scaled, sides)
    graph = body_graph(count, sides, (width != 6) | ((free != 6) & (free != 0)), more)
    moving = set(np.flatnonzero(free).tolist())
    return _tied(graph, _held_frames(rows, rows.survey()[0], moving)), moving


def _held_frames(rows: StartRows, places: NDArray[np.float64], moving: set[int]) -> set[int]:
    """Bodies that can only deform: their frames are fixed or driven."""
    free = set(rows.free.tolist())
    return {body for body in moving if int(places[body, 0]) not in free}


def _tied(graph: BodyGraph, held: set[int]) -> BodyGraph:
    """The same graph, with bodies whose frames are fixed or driven as part of the ground."""
    cores = tuple(
        replace(core, grounded=core.grounded or bool(held & set(core.bodies))) for core in graph.cores
    )
    floating = tuple(bodies for bodies in graph.floating if not held & set(bodies))
    return replace(graph, cores=cores, floating=floating)


def _count_with_meshes(rows: StartRows, scaled: ScaledRows) -> Diagnosis:
    """Degrees of freedom only: what a mesh that deforms at will leaves free has no name."""
    rank = rank_of(scaled.matrix, scaled.owner, scaled.tolerance)
    coordinates = sum(kind.hidden_coordinates for kind in rows.layout.bodies)
    return Diagnosis(
        degrees_of_freedom=len(rows.free) + coordinates - rank,
        row_count=scaled.matrix.shape[0],
        rank=rank,
        redundant=(),
        free_motions=(),
        singular=None,
    )


def scale_rows(rows: StartRows) -> tuple[ScaledRows, NDArray[np.float64]]:
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
        return ScaledRows(nothing, rows.block[rows.rigid], owner[rows.free], EXACT), lengths
    G = SparseRows(rows.entries(), rows.entry_rows, rows.entry_columns, (len(rows.rigid), len(inertia)))
    G = G.part(np.flatnonzero(rows.rigid), rows.free)
    G.data *= lengths[G.indices]
    violation = float(np.abs(rows.residual[rows.rigid]).max(initial=0.0))
    tolerance = EXACT + 30.0 * violation / min(1.0, float(lengths.min(initial=1.0)))
    return ScaledRows(G.unit_rows(), rows.block[rows.rigid], owner[rows.free], tolerance), lengths


def _touched(
    scaled: ScaledRows, sides: NDArray[np.int64]
) -> tuple[NDArray[np.int64], list[tuple[int, int, int]]]:
    """Bodies of each block on which its rows act in this position, and of those on more than two the other pairs.

    A block may name bodies that its rows do not touch, as decks on which a vehicle does not stand yet.
    """
    sides, more = sides.copy(), []
    for block in np.unique(scaled.block):
        rows = scaled.rows([block])
        entries = scaled.matrix.indices[scaled.matrix.indptr[rows[0]] : scaled.matrix.indptr[rows[-1] + 1]]
        found = np.unique(scaled.owner[entries]).tolist()
        if set(found) == {int(side) for side in sides[block]} - {-1}:
            continue
        sides[block] = (*found[:2], -1, -1)[:2]
        if len(found) > 2:
            more += [(a, b, int(block)) for a, b in pairwise((*found[1:], found[0]))]
    return sides, more


def core_part(scaled: ScaledRows, core: Core) -> tuple[Any, NDArray[np.int64]]:
    """Rows of a core and the body of each of its columns."""
    blocks = [block for pair in core.pairs for block in pair.blocks]
    columns = scaled.columns(core.bodies)
    return scaled.matrix.part(scaled.rows(blocks), columns), scaled.owner[columns]


@dataclass(frozen=True)
class NearbyRows:
    """The same rows in a nearby position, ranks of the cores; whether they close, and only where they were."""

    scaled: ScaledRows
    ranks: list[int]
    closed: bool
    stuck: bool


def move_nearby(
    rows: StartRows,
    scaled: ScaledRows,
    lengths: NDArray[np.float64],
    graph: BodyGraph,
    ranks: list[int],
    largest: int,
) -> NearbyRows | None:
    """Move a little along what is free inside the cores, close the joints again, and compare.

    None without a core, or without a motion inside of one, or with more columns than a number.
    """
    if not graph.cores or scaled.matrix.shape[1] > largest:
        return None
    random = np.random.default_rng(1)
    step = np.zeros(len(rows.free))
    for core in graph.cores:
        own = scaled.columns(core.bodies)
        null = null_spaces(core_part(scaled, core)[0].toarray(), scaled.tolerance)[1]
        if null.shape[1]:
            direction = null @ random.normal(size=null.shape[1])
            step[own] = direction / np.abs(direction).max()
    if not step.any():
        return None
    increment = np.zeros(len(rows.inertia))
    increment[rows.free] = NEARBY * step * lengths
    before = rows.snapshot()
    places = [kind.poses() for kind in rows.layout.bodies]
    rows.move(increment)
    closed = close_positions(rows)
    moved = np.zeros(len(rows.inertia))
    for kind, place in zip(rows.layout.bodies, places, strict=True):
        kind.put_increment(place, kind.poses(), moved)
    there = scale_rows(rows)[0]
    near = [rank_of(*core_part(there, core), there.tolerance) for core in graph.cores]
    went = np.abs(moved[rows.free] / lengths).max()  # frames and modes, in lengths of a body
    rows.restore(before)
    rows.start()
    rows.fill()
    return NearbyRows(there, near if closed else ranks, closed, closed and bool(went < 0.05 * NEARBY))


def _core_redundancy(
    rows: StartRows, scaled: ScaledRows, near: NearbyRows | None, core: Core, rank: int
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
        action = "hold the same bodies" if len(loop) == 1 else "close a loop"
        where = ""
        if near is not None:
            there = near.scaled.dense(loop_blocks, tuple(bodies))
            always = len(there) - null_spaces(there, near.scaled.tolerance)[0]
            if always < left.shape[1]:
                where = f", {'all' if always == 0 else left.shape[1] - always} of them in this position only"
        texts.append(
            f"{_joints(rows, loop_blocks)} {action} with {plural(more, 'row')} too many{where}:"
            " the distribution of their forces is not unique"
        )
    if missing:
        texts.append(
            f"{_joints(rows, blocks)} together have {plural(missing, 'row')}"
            f"{' more' if texts else ''} too many: the distribution of their forces is not unique"
        )
    return texts


def _core_motions(
    rows: StartRows, scaled: ScaledRows, lengths: NDArray[np.float64], core: Core, rank: int
) -> list[str]:
    """A sentence on what moves inside the loops of a core."""
    names = [rows.layout.body_names[body] for body in core.bodies]
    part, _ = core_part(scaled, core)
    count = part.shape[1] - rank - (0 if core.grounded else 6)
    if count <= 0:
        return []
    inside = " in loops" if core.loops else ""  # bodies with modes are looked at with all that hangs on them
    head = f"{quoted(names)}{inside} have {plural(count, 'motion')} of their own"
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
    words = []
    for body in moving[:4]:
        motion = full[int(places[body, 0]) :][:6, 0]
        still = np.abs(motion).max() <= 1e-6 * np.abs(full).max()
        words.append(
            f"{rows.layout.body_names[body]!r} {'deforms' if still else move_words(places[body], motion)}"
        )
    return [f"{head}: " + ", ".join(words) + (" and so on" if len(moving) > 4 else "")]


def _without_common(
    rows: StartRows,
    places: NDArray[np.float64],
    bodies: Sequence[int],
    motions: NDArray[np.float64],
    count: int,
) -> NDArray[np.float64]:
    """Take the motion of a group as a whole out: the frame of the first body stands still."""
    first = int(places[bodies[0], 0])
    _, sigma, vt = np.linalg.svd(motions[first : first + 6])
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


DENSE = 480
"""Columns up to which a singular value decomposition is taken."""


def null_spaces(
    matrix: NDArray[np.float64], tolerance: float
) -> tuple[int, NDArray[np.float64], NDArray[np.float64]]:
    """Rank, null space (columns, n) and left null space (columns, m) of a dense matrix (m, n) of unit rows."""
    m, n = matrix.shape
    if m == 0 or n == 0:
        return 0, np.eye(n), np.eye(m)
    u, sigma, vt = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(sigma > tolerance))
    return rank, vt[rank:].T, u[:, rank:]


def rank_of(matrix: Any, owner: NDArray[np.int64], tolerance: float) -> int:
    """Rank of a sparse matrix of unit rows, shape (rows, columns), with the body of each column."""
    if matrix.shape[0] == 0:
        return 0
    if matrix.shape[1] <= DENSE:
        return null_spaces(matrix.toarray(), tolerance)[0]
    return block_rank(matrix, owner, tolerance)


def block_rank(matrix: Any, owner: NDArray[np.int64], tolerance: float) -> int:
    """Rank by orthogonal elimination of one body after the other.

    Parameters
    ----------
    matrix
        Sparse by rows, unit rows, shape (rows, columns).
    owner
        Body of each column.
    tolerance
        Size of what counts as zero.

    Notes
    -----
    All rows on a body are rotated so that as few of them as its own rank, found by QR with exchange of
    columns, have anything in its columns; these are put aside and counted, the others continue to its neighbours.
    Rotations keep the rank, so this is a multifrontal QR (T. A. Davis, ACM Trans. Math. Software 38, 2011, on
    SuiteSparseQR) whose fronts are bodies; bodies with few neighbours go first.
    """
    from scipy.linalg import qr

    numbers = {body: np.flatnonzero(owner == body) for body in np.unique(owner)}
    fronts: dict[int, tuple[tuple[int, ...], NDArray[np.float64]]] = {}
    on_body: dict[int, set[int]] = {body: set() for body in numbers}

    def add(bodies: tuple[int, ...], dense: NDArray[np.float64]) -> None:
        key = add.count  # type: ignore[attr-defined]
        add.count += 1  # type: ignore[attr-defined]
        fronts[key] = bodies, dense
        for body in bodies:
            on_body[body].add(key)

    add.count = 0  # type: ignore[attr-defined]
    for row in range(matrix.shape[0]):
        columns = matrix.indices[matrix.indptr[row] : matrix.indptr[row + 1]]
        bodies = tuple(int(body) for body in np.unique(owner[columns]))
        if bodies:
            wide = np.concatenate([numbers[body] for body in bodies])
            dense = np.zeros((1, len(wide)))
            dense[
                0, np.searchsorted(wide, columns) if np.all(np.diff(wide) > 0) else _places(wide, columns)
            ] = matrix.data[matrix.indptr[row] : matrix.indptr[row + 1]]
            add(bodies, dense)
    rank = 0
    left = set(numbers)
    while left:
        body = min(left, key=lambda one: (len({b for key in on_body[one] for b in fronts[key][0]}), one))
        left.remove(body)
        keys = sorted(on_body.pop(body))
        others = sorted({b for key in keys for b in fronts[key][0]} - {body})
        bodies = (body, *others)
        width = [len(numbers[b]) for b in bodies]
        starts = dict(zip(bodies, np.cumsum([0, *width[:-1]]), strict=True))
        stacked = []
        for key in keys:
            own, dense = fronts.pop(key)
            wide = np.zeros((len(dense), sum(width)))
            at = 0
            for b in own:
                count = len(numbers[b])
                wide[:, starts[b] : starts[b] + count] = dense[:, at : at + count]
                at += count
                if b != body:
                    on_body[b].discard(key)
            stacked.append(wide)
        if not stacked:
            continue
        front = np.vstack(stacked)
        Q, R, _ = qr(front[:, : width[0]], pivoting=True)
        own_rank = int(np.count_nonzero(np.abs(np.diag(R)) > tolerance))
        rank += own_rank
        rest = (Q[:, own_rank:].T @ front)[:, width[0] :]
        if len(rest) > rest.shape[1] > 0:
            rest = np.linalg.qr(rest, mode="r")
        rest = rest[np.abs(rest).max(axis=1, initial=0.0) > tolerance]
        if len(rest):
            add(tuple(others), rest)
    return rank


def _places(wide: NDArray[np.int64], columns: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    """Where columns stand in a list of columns that is not sorted."""
    order = np.argsort(wide)
    return order[np.searchsorted(wide[order], columns)]


@dataclass(frozen=True)
class Pair:
    """Two bodies and the blocks between them; the ground has the number of bodies as its number.

    Attributes
    ----------
    bodies
        Of a bridge the one nearer to the root first.
    blocks
        All joints between them.
    beyond
        Of a bridge: the second body and all that hangs on it.
    """

    bodies: tuple[int, int]
    blocks: tuple[int, ...]
    beyond: tuple[int, ...] = ()


@dataclass(frozen=True)
class Core:
    """Bodies in loops, without the ground; whether the ground is one of the group; pairs; loops of pairs."""

    bodies: tuple[int, ...]
    grounded: bool
    pairs: tuple[Pair, ...]
    loops: tuple[tuple[Pair, ...], ...]


@dataclass(frozen=True)
class BodyGraph:
    """Bridges, cores, and groups of connected bodies that nothing ties to the ground."""

    bridges: tuple[Pair, ...]
    cores: tuple[Core, ...]
    floating: tuple[tuple[int, ...], ...]


def body_graph(
    count: int,
    sides: NDArray[np.int64],
    whole: NDArray[np.bool_],
    more: Sequence[tuple[int, int, int]] = (),
) -> BodyGraph:
    """Take a scene apart.

    Parameters
    ----------
    count
        Bodies.
    sides
        Bodies of each block that counts, -1 for the ground; shape (blocks, 2).
    whole
        Bodies that must not be cut off at a bridge, because they are not rigid and free; shape (count,).
    more
        Other pairs of bodies of blocks on more than two, with the number of the block.
    """
    between: dict[tuple[int, int], list[int]] = {}
    pairs = [(a, b, block) for block, (a, b) in enumerate(sides)]
    for a, b, block in (*pairs, *more):
        u, v = sorted((count if a < 0 else int(a), count if b < 0 else int(b)))
        if u != v:
            between.setdefault((u, v), []).append(block)
    neighbours: list[list[int]] = [[] for _ in range(count + 1)]
    for u, v in between:
        neighbours[u].append(v)
        neighbours[v].append(u)

    def pair(u: int, v: int, beyond: tuple[int, ...] = ()) -> Pair:
        return Pair((u, v), tuple(between[min(u, v), max(u, v)]), beyond)

    bridges: list[Pair] = []
    cores: list[Core] = []
    floating: list[tuple[int, ...]] = []
    group = np.full(count + 1, -1)
    for root in (count, *range(count)):
        if group[root] >= 0:
            continue
        order, parent, size, low = _search(root, neighbours, group)
        place = {node: i for i, node in enumerate(order)}
        if root != count:
            floating.append(tuple(sorted(order)))
        cut = [False] * len(order)
        for i in range(1, len(order)):
            beyond = order[i : i + size[i]]
            inside = [node for node in order if node != count]
            if low[i] == i and not whole[inside].any():
                cut[i] = True
                bridges.append(pair(order[parent[i]], order[i], tuple(beyond)))
        head = list(range(len(order)))
        for i in range(1, len(order)):
            head[i] = i if cut[i] else head[parent[i]]
        members: dict[int, list[int]] = {}
        for i, node in enumerate(order):
            members.setdefault(head[i], []).append(node)
        for nodes in members.values():
            if len(nodes) > 1:
                group[nodes] = len(cores) + 1
                cores.append(_core(nodes, count, neighbours, place, head, pair))
    return BodyGraph(tuple(bridges), tuple(cores), tuple(floating))


def _search(
    root: int, neighbours: list[list[int]], group: NDArray[np.int64]
) -> tuple[list[int], list[int], list[int], list[int]]:
    """Depth first: nodes in order, and by place the parent, the size of what follows, the lowest place reached."""
    order, parent, low = [root], [-1], [0]
    place = {root: 0}
    group[root] = 0
    stack = [(0, iter(neighbours[root]))]
    while stack:
        i, rest = stack[-1]
        for node in rest:
            if node not in place:
                place[node] = len(order)
                group[node] = 0
                order.append(node)
                parent.append(i)
                low.append(place[node])
                stack.append((place[node], iter(neighbours[node])))
                break
            if place[node] != parent[i]:
                low[i] = min(low[i], place[node])
        else:
            stack.pop()
            if stack:
                low[parent[i]] = min(low[parent[i]], low[i])
    size = [1] * len(order)
    for i in range(len(order) - 1, 0, -1):
        size[parent[i]] += size[i]
    return order, parent, size, low


def _core(nodes, count, neighbours, place, head, pair) -> Core:  # type: ignore[no-untyped-def]
    """A core with its loops: those that a breadth-first tree closes, which are short ones."""
    first = count if count in nodes else nodes[0]
    top = head[place[nodes[0]]]

    def inside(node: int) -> bool:
        return head[place[node]] == top

    parent, depth, queue = {first: first}, {first: 0}, deque([first])
    closing: list[tuple[int, int]] = []
    pairs = []
    while queue:
        u = queue.popleft()
        for v in neighbours[u]:
            if not inside(v):
                continue
            if v not in parent:
                parent[v], depth[v] = u, depth[u] + 1
                queue.append(v)
                pairs.append(pair(u, v))
            elif v != parent[u] and (depth[v], v) > (depth[u], u):
                closing.append((u, v))
                pairs.append(pair(u, v))
    loops = []
    for u, v in closing:
        a, b, left, right = u, v, [], []
        while a != b:
            if depth[a] >= depth[b]:
                left.append(pair(parent[a], a))
                a = parent[a]
            else:
                right.append(pair(parent[b], b))
                b = parent[b]
        loops.append((*reversed(left), pair(u, v), *right))
    bodies = tuple(node for node in nodes if node != count)
    return Core(bodies, first == count, tuple(pairs), tuple(sorted(loops, key=len)))
