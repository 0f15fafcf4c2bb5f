"""The rows of a scene: what joints, springs and ropes write, and the symmetric system that couples them.

A *block* holds the rows of one joint on two *sides*; each side is attached to a body, or to the ground.
With the panels ``G`` of all sides, the step matrices ``A`` of the bodies and the softness ``Z``::

    ( G A^-1 G^T + Z ) P = target - G U,    U += A^-1 G^T P

Bodies are eliminated first, which costs nothing for rigid ones, so the unknowns are the impulses P alone
and the pattern is that of the joint graph. A body with many joints would make a clique of all of them:
such *hubs* stay in the system as nodes of their own, with ``-A`` as their pivot. The system is then
quasi-definite, and can be factored in any order without exchanging pivots (R. J. Vanderbei, SIAM J.
Optimization 5, 1995). Only rigid bodies become hubs: many joints on one flexible body still make a clique.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, combinations_with_replacement
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Ints1
from heavylift.numerics.block_pattern import FactorColumn, LowerBlock, pack_blocks
from heavylift.numerics.classes import dataclass
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.records import (
    LaneRecords,
    Lanes,
    Record,
    Records,
    filled,
    known_lanes,
    lane_records,
    records,
)

__all__ = [
    "ABSENT",
    "MOVES",
    "REGULARISATION",
    "SHAPES",
    "TURNS",
    "Attachment",
    "RowArrays",
    "RowSystem",
    "classify_rows",
    "pack_rows",
]

REGULARISATION = 1e-7
"""Softness of rigid rows relative to their characteristic inverse mass: lets redundant rows share."""

ABSENT = 1e20
"""Softness relative to the characteristic inverse mass that takes a row out of the system."""

MOVES, TURNS = 1, 2
"""Vectors of a block: its force and its moment, whose components the rows of a joint are."""

HUB_ATTACHMENTS = 12
"""Joints on one rigid body from which on it stays in the system as a node."""

# how a body is held by its attachment: not at all (ground, prescribed motion), by its inverse masses, by its own
# factor, or as a node of the system
PRESCRIBED, DIAGONAL, FACTORED, HUB = range(4)


class Row(Record):
    """Rows of one block, or the unknowns of a hub: vectors with a lane for each.

    Attributes
    ----------
    residual, target, softness
        Violation of the position, wanted rate, and Z of the system in the docstring of this module.
    scale
        Characteristic inverse mass; 0 where there is no row.
    compliance, relaxation
        Physical compliance and relaxation time [s].
    stiffness, loss
        Of a joint with compliance [N/m, N m/rad], 0 of other rows; what its relaxation and its release have taken [J].
    impulse, half_impulse, reaction, last_reaction
        Of the solution; of the midpoint; force at the end of the step and in its middle.
    slope, slope_before
        Of the force from the middle of one step to that of the next [N/s, N m/s], the last two.
    solution
        Right-hand side, then change of the impulse; of a hub its velocities.
    rigid
        What makes the violation of a rigid row 1 where a run has failed, 0 for others.
    vector
        `MOVES` or `TURNS` of rows that are components of these vectors, along whatever axes; 0 of a row alone.
    hold
        Softness in the projection.
    """

    residual: Lanes
    target: Lanes
    softness: Lanes
    scale: Lanes
    compliance: Lanes
    relaxation: Lanes
    stiffness: Lanes
    loss: Lanes
    impulse: Lanes
    half_impulse: Lanes
    reaction: Lanes
    last_reaction: Lanes
    slope: Lanes
    slope_before: Lanes
    solution: Lanes
    rigid: Lanes
    vector: Lanes
    hold: Lanes


ROW_VECTORS = len(Row.fields_of)
"""Vectors of lanes of a block."""


class Side(Record):
    """One side of a block.

    Attributes
    ----------
    dof, width
        First velocity of the body, -1 on the ground, and how many it has.
    panel
        Place of G in the panels.
    holder
        `PRESCRIBED`, `DIAGONAL`, `FACTORED` or `HUB`.
    owner
        Block that has the rows.
    first, count
        Velocities of the body from which to where G may be other than zero: all of them, unless its kind knows better
        (`apply_inverse`), since rows touch few of the coordinates of a mesh.
    """

    dof: int
    width: int
    panel: int
    holder: int
    owner: int
    first: int
    count: int


class Product(Record):
    """``G A^-1 G^T`` of two sides, an addend of the assembly.

    Attributes
    ----------
    place
        In the blocks.
    left, right
        Places of the panel of the earlier (of X, for bodies with a factor of their own) and of the later side.
    early, late
        Nodes of the sides.
    side, dof
        The later side, which knows the velocities to sum over; first velocity of a rigid body, or -1.
    first
        Whether it is the first of its block.
    """

    place: int
    left: int
    right: int
    early: int
    late: int
    side: int
    dof: int
    first: bool


class Hub(Record):
    """A body that stays in the system as a node, or an attachment on one.

    Attributes
    ----------
    node
        Of the hub, or of the block on it.
    place
        Of its pivot, or of the coupling.
    first
        First velocity, or place of the panel.
    later
        -1 of a hub itself; of an attachment 1 if the hub comes later in the order, else 0.
    """

    node: int
    place: int
    first: int
    later: int


class RowArrays(Arrays):
    """Rows of joints or of contacts, as those see them who write and read them.

    Attributes
    ----------
    lanes
        Length of a vector of lanes.
    attachments
        Two sides of each block.
    panels
        G of all attachments, then ``X = A^-1 G^T``, flat.
    rows
        Of each block, then of each hub.
    inverse_mass
        Of each velocity of a free rigid body [1/kg, 1/(kg m2)]; 0 where motion is prescribed.
    shape
        Block shape for `heavylift.numerics.lanes`: subclasses have one, which kernels know when they are compiled.
    """

    shape: ClassVar[Any]

    carried_fields: ClassVar[tuple[str, ...]] = ("rows",)

    lanes: int
    attachments: Records[Side]
    panels: Floats1
    rows: LaneRecords[Row]
    inverse_mass: Floats1


class RowSystem(RowArrays):
    """Rows of all joints and the factor of their system; kernels are compiled for one of the `SHAPES`.

    Attributes
    ----------
    columns, lower, updates, scratch
        The factor: tables of `heavylift.numerics.block_pattern`.
    pairs
        The assembly.
    fill
        Places of blocks that no such entry starts.
    hubs
        Each with the attachments on it behind it.
    blocks
        Blocks of the factor and of its scratch, flat.
    present
        1 of each node that the last factor has, 0 of those whose rows were all absent in it.
    monitor
        Record column of the largest violation; smallest pivot and largest drift of a law follow it.
    laws
        Whether some rows (ropes, stops, friction) are fitted to the velocities by iteration.
    """

    kernel_modules: ClassVar[tuple[str, ...]] = (
        "heavylift.solver.rows.stage",
        "heavylift.solver.rows.thesis",
        "heavylift.solver.rows.accurate",
    )

    columns: Records[FactorColumn]
    lower: Records[LowerBlock]
    updates: Ints1
    scratch: int
    pairs: Records[Product]
    fill: Ints1
    hubs: Records[Hub]
    blocks: Floats1
    present: Ints1
    monitor: int
    laws: bool = False


def _of_shape(rows: int) -> type[RowSystem]:
    """The kind of systems whose blocks have some rows: its kernels know them when they are compiled."""
    shape = block_shape(rows)
    known = {"rows": known_lanes(Row, len(shape[1]))}
    own = {"shape": shape, "__annotations__": known, "__module__": __name__}
    return type(f"RowSystem{rows}", (RowSystem,), own)


SHAPES = {rows: _of_shape(rows) for rows in (1, 3, 4, 5, 6, 8)}
"""Kinds of systems by rows of a block; blocks with fewer rows are filled up with rows that are not there."""
# other processes find them by their names
globals().update({kind.__name__: kind for kind in SHAPES.values()})


@dataclass(frozen=True)
class Attachment:
    """One side of a block.

    Attributes
    ----------
    body
        Number of the body, -1 for the ground.
    dof, width
        First velocity of the body and how many it has; -1 and 0 for the ground.
    holder
        `PRESCRIBED`, `DIAGONAL` or `FACTORED`.
    """

    body: int
    dof: int
    width: int
    holder: int


def pack_rows(
    row_counts: Sequence[int],
    sides: Sequence[tuple[Attachment, Attachment]],
    scales: Sequence[NDArray[np.float64]],
    inverse_mass: NDArray[np.float64],
    monitor: int,
    owners: Sequence[int] | None = None,
) -> RowSystem:
    """Order the blocks and lay out the system.

    Parameters
    ----------
    row_counts
        Rows of each block.
    sides
        Of each block.
    scales
        Characteristic inverse mass of each row, ``1/m_a + 1/m_b`` or ``1/I_a + 1/I_b``; shape (rows,).
    inverse_mass
        As in `RowSystem`.
    monitor
        As in `RowSystem`.
    owners
        Block whose rows the two sides of each block belong to: a row on more than two bodies continues in blocks
        without rows of their own. Each block its own if None.
    """
    count = len(row_counts)
    owner_of = np.arange(count) if owners is None else np.array(owners, dtype=np.int64)
    block_of = [int(owner) for owner in np.repeat(owner_of, 2)]
    on_body: dict[int, list[int]] = {}
    for block, pair in enumerate(sides):
        for side, end in enumerate(pair):
            if end.holder != PRESCRIBED:
                on_body.setdefault(end.body, []).append(2 * block + side)
    ends = [end for pair in sides for end in pair]
    hub_bodies = [
        body
        for body, held in on_body.items()
        if len(held) >= HUB_ATTACHMENTS and ends[held[0]].holder == DIAGONAL
    ]
    hub_node = {body: count + i for i, body in enumerate(hub_bodies)}
    needed = max([6 if hub_bodies else 1, *row_counts])
    rows = min(shape for shape in SHAPES if shape >= needed)
    shape = block_shape(rows)
    lanes = len(shape[1])
    window = max([6, *(end.width for end in ends)])

    attachments = records(Side, 2 * count)
    for i, end in enumerate(ends):
        holder = HUB if end.body in hub_node else end.holder
        attachments[i] = filled(
            Side,
            dof=end.dof,
            width=end.width,
            panel=i * window * lanes,
            holder=holder,
            owner=block_of[i],
            first=0,
            count=end.width,
        )

    edges: list[tuple[int, int]] = []
    for body, held in on_body.items():
        blocks = sorted({block_of[i] for i in held})
        if body in hub_node:
            edges += [(block, hub_node[body]) for block in blocks]
        else:
            edges += combinations(blocks, 2)
    node_count = count + len(hub_bodies)
    pattern = pack_blocks(
        node_count, np.array(edges, dtype=np.int64), rows, groups=np.zeros(node_count, dtype=np.int64)
    )

    rank = pattern.rank.tolist()
    half = len(ends) * window * lanes
    pairs, hubs = [], []
    for body, held in on_body.items():
        if body in hub_node:
            node = hub_node[body]
            place = pattern.place(node, node)[0]
            hubs.append(filled(Hub, node=node, place=place, first=ends[held[0]].dof, later=-1))
            for i in held:
                place, later = pattern.place(block_of[i], node)
                panel = attachments[i].panel
                hubs.append(filled(Hub, node=block_of[i], place=place, first=panel, later=later))
            continue
        for p, q in combinations_with_replacement(held, 2):
            early, late = sorted((p, q), key=lambda i: rank[block_of[i]])
            pairs.append((early, late))
            if p != q and block_of[p] == block_of[q]:  # two sides on one body: its block needs both orders
                pairs.append((late, early))
    sides_of_pairs = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    places, _ = pattern.places(*np.array(block_of, dtype=np.int64)[sides_of_pairs].T)

    table = _assembly(np.column_stack([places, sides_of_pairs]).tolist(), attachments, half)
    row_data = lane_records(Row, node_count, lanes)
    row_data["softness"] = 1.0  # of padding lanes, whose rows are empty
    for block, (used, scale) in enumerate(zip(row_counts, scales, strict=True)):
        row_data[block].scale[:used] = scale
    return SHAPES[rows](
        lanes=lanes,
        attachments=attachments,
        columns=pattern.columns,
        lower=pattern.lower,
        updates=pattern.updates,
        scratch=pattern.scratch,
        pairs=table,
        fill=np.setdiff1d(pattern.key_places, table["place"][table["first"]]),
        hubs=records(Hub, hubs),
        panels=np.zeros(2 * half),
        blocks=np.zeros(pattern.size),
        present=np.ones(node_count, dtype=np.int64),
        rows=row_data,
        inverse_mass=np.ascontiguousarray(inverse_mass, dtype=np.float64),
        monitor=monitor,
    )


def _assembly(
    pairs: Sequence[tuple[int, int, int]], attachments: Records[Side], half: int
) -> Records[Product]:
    """Addends of `RowSystem.pairs`; those of one block stand together, rigid ones first, because they can start it."""
    rows = []
    started: set[int] = set()
    diagonal = attachments["holder"] == DIAGONAL
    for place, early, late in sorted(pairs, key=lambda pair: (pair[0], not diagonal[pair[1]])):
        rigid = bool(diagonal[early])
        rows.append(
            filled(
                Product,
                place=place,
                left=attachments[early].panel + (0 if rigid else half),
                right=attachments[late].panel,
                early=attachments[early].owner,
                late=attachments[late].owner,
                side=late,
                dof=attachments[early].dof if rigid else -1,
                first=rigid and place not in started,
            )
        )
        if rigid:
            started.add(place)
    return records(Product, rows)


def classify_rows(system: RowArrays) -> None:
    """Tell rigid rows from those with compliance or a law, once both are known.

    Notes
    -----
    The step then needs no branches: lanes of rigid rows, of others and of none differ in two numbers.
    """
    rows = system.rows
    used = rows["scale"] > 0.0
    rigid = used & (rows["compliance"] == 0.0)
    rows["rigid"] = np.where(rigid, np.where(rows["rigid"] > 0.0, rows["rigid"], 1.0), 0.0)
    hold = np.where(rigid, REGULARISATION, ABSENT) * rows["scale"]
    rows["hold"] = np.where(used, hold, 1.0)
    rows["softness"] = rows["hold"]
