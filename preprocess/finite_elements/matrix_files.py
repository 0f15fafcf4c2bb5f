"""Stiffness and mass that CalculiX or Abaqus has written, with the nodes of its deck.

* CalculiX, ``*FREQUENCY, SOLVER=MATRIXSTORAGE``: ``job.sti`` and ``job.mas`` with lines ``row column value`` of one
  triangle, and ``job.dof``, whose lines ``node.direction`` say what a row is. Held degrees of freedom have no row.
* Abaqus, ``*MATRIX OUTPUT, FORMAT=MATRIX INPUT``: two files of lines ``node, direction, node, direction, value``;
* Abaqus, ``FORMAT=COORDINATE`` (``.mtx``): lines ``row column value``, of free bodies. The files do not say what a row
  is: rows are taken as directions 1, 2, 3 of the nodes in the order of their numbers, and the six rigid motions must
  then be free.

Sources: G. Dhondt, *CalculiX CrunchiX User's Manual*, version 2.21, ``*FREQUENCY``; Abaqus Analysis User's Guide,
*Generating structural matrices*.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.exchange import (
    EntryTable,
    describe_model,
    read_table,
    symmetric_matrix,
)
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import FEModel

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.deck import Deck

__all__ = ["read_matrices"]

_RIGID = 1e-6  # of the largest stiffness: forces of rigid motions
_SAME = 1e-6  # of the largest mass: masses of a node in its three directions


def read_matrices(
    deck: Deck,
    stiffness: Path,
    mass: Path,
    degrees: Path | None = None,
    *,
    length_unit: float = 1.0,
    mass_factor: float = 1.0,
    stiffness_factor: float = 1.0,
) -> FEModel:
    """Model of a body from the matrices of another program.

    Parameters
    ----------
    deck
        Its nodes, and the elements between them; all of them are the body.
    stiffness, mass
        Files of the matrices.
    degrees
        File that names the rows; without it rows of a coordinate format (``.mtx``) are those of the nodes in order.
    length_unit, mass_factor, stiffness_factor
        Metres, kilograms and N/m per unit of the files.

    Returns
    -------
    FEModel
        Its nodes are those of elements and rows, in the order of the deck; nodes without rows are clamped. With a mesh
        if all elements are of one kind that `Mesh` has; without a material.

    Raises
    ------
    InputError
        A fault of the text, by file and line; a row of a node that the deck lacks; nodes held in some directions only;
        rows that are missing though the deck does not hold them (eliminated by an equation or a rigid body); a mass
        that is not the same in all directions; an impossible body.
    """
    notes = list(deck.notes)
    label_row, twice = _node_rows(deck)
    names = None if degrees is None else _degrees(degrees, label_row, twice)
    by_order = (
        names is None and stiffness.suffix.lower() == ".mtx" and read_table(stiffness).values.shape[1] == 3
    )
    if by_order:
        names = _ordered_degrees(deck, label_row, twice, stiffness)
    tables = [_entries(path, names, label_row, twice) for path in (stiffness, mass)]
    present = np.unique(np.concatenate([np.concatenate([t.rows, t.columns]) for t in tables]))
    of_elements = [block.nodes.ravel() for block in deck.blocks]
    used = np.unique(np.concatenate([present // 3, *of_elements]))
    fixed = _clamped(deck, stiffness, present, used)

    new_row = np.full(len(deck.points), -1, dtype=np.int64)
    new_row[used] = np.arange(used.size)
    K, M = (
        symmetric_matrix(path, _renumbered(table, new_row), used.size, notes)
        for path, table in zip((stiffness, mass), tables, strict=True)
    )
    if by_order:
        _check_rigid(K, deck.points[used], stiffness)
        notes.append(
            "rows of the matrices are taken as directions 1, 2, 3 of the nodes in the order of their numbers"
        )
    if fixed.size:
        notes.append(f"{fixed.size} nodes have no row: clamped in the file, and their mass is not in it")
    model = FEModel(
        nodes=length_unit * deck.points[used],
        stiffness=stiffness_factor * K,
        mass=mass_factor * _scalar_mass(mass, M),
        mesh=_mesh(deck, length_unit * deck.points[used], new_row),
        node_groups={
            name: new_row[members][new_row[members] >= 0]
            for name, members in deck.node_sets.items()
            if (new_row[members] >= 0).any()
        },
        fixed_nodes=new_row[fixed],
        name=str(stiffness),
    )
    notes.append(describe_model(model, check=True))
    return replace(model, notes=tuple(notes))


_ONE_INSTANCE = "one instance a node number: matrices and a deck written without parts and instances"


def _node_rows(deck: Deck) -> tuple[dict[int, int], dict[int, tuple[str, ...]]]:
    """Rows of `Deck.points` by the number of a node, and the instances of numbers that several nodes have.

    Matrices know numbers alone: those of an instance are called without it. A node of elements goes before one of none,
    as reference points of an assembly are.
    """
    used = np.zeros(len(deck.points), dtype=bool)
    for block in deck.blocks:
        used[block.nodes.ravel()] = True
    found: dict[int, list[int]] = {}
    for row, label in enumerate(deck.node_labels):
        own = str(label).rpartition(".")[2]
        if own.isdecimal():
            found.setdefault(int(own), []).append(row)
    rows: dict[int, int] = {}
    twice: dict[int, tuple[str, ...]] = {}
    for number, candidates in found.items():
        chosen = [row for row in candidates if used[row]] if len(candidates) > 1 else candidates
        if len(chosen) == 1:
            rows[number] = chosen[0]
        else:
            twice[number] = tuple(str(deck.node_labels[row]) for row in chosen or candidates)
    return rows, twice


def _refuse_twice(path: Path, line: int, number: int, twice: Mapping[int, tuple[str, ...]]) -> None:
    """Refuse a node number that is that of several nodes."""
    if number in twice:
        nodes = ", ".join(twice[number][:4]) + (", ..." if len(twice[number]) > 4 else "")
        raise InputError(
            f"node {number} is one of several: {nodes}",
            source=path,
            key=f"line {line}",
            expected=_ONE_INSTANCE,
        )


def _degrees(
    path: Path, label_row: Mapping[int, int], twice: Mapping[int, tuple[str, ...]]
) -> NDArray[np.int64]:
    """Degree of freedom of every row: three times the node of the deck, plus the direction."""
    found = []
    try:
        lines = path.read_text(encoding="ascii").split()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            "cannot be read", source=path, expected="lines like 12.3: node and direction"
        ) from error
    for number, line in enumerate(lines, start=1):
        node, _, direction = line.partition(".")
        if direction not in {"1", "2", "3"}:
            raise InputError(
                f"{line!r}",
                source=path,
                key=f"line {number}",
                expected="a node and a direction 1, 2 or 3, e.g. 12.3: matrices of displacements",
            )
        label = int(node) if node.isdigit() and len(node) < 19 else -1
        _refuse_twice(path, number, label, twice)
        if label not in label_row:
            raise InputError(
                f"node {node} is not in the deck",
                source=path,
                key=f"line {number}",
                expected="the deck that the matrices are of (of solids: shells and beams get nodes of their own)",
            )
        found.append(3 * label_row[label] + int(direction) - 1)
    return np.array(found, dtype=np.int64)


def _ordered_degrees(
    deck: Deck, label_row: Mapping[int, int], twice: Mapping[int, tuple[str, ...]], path: Path
) -> NDArray[np.int64]:
    """Degrees of freedom of rows that follow the nodes of elements in the order of their numbers."""
    used = np.zeros(len(deck.points), dtype=bool)
    for block in deck.blocks:
        used[block.nodes.ravel()] = True
    if twice:
        _refuse_twice(path, 1, min(twice), twice)
    rows = np.array(
        [label_row[label] for label in sorted(label_row) if used[label_row[label]]], dtype=np.int64
    )
    if rows.size < used.sum():
        raise InputError(
            f"has three numbers a line, and {used.sum() - rows.size} nodes of the deck have no number of their own",
            source=path,
            expected=_ONE_INSTANCE,
        )
    return (3 * rows[:, None] + np.arange(3)).ravel()


def _check_rigid(K: csr_array, nodes: NDArray[np.float64], path: Path) -> None:
    """Refuse a stiffness that resists rigid motions: rows in another order, or supports."""
    x = nodes - nodes.mean(axis=0)
    R = np.zeros((len(x), 3, 6))
    R[:, range(3), range(3)] = 1.0
    for k in range(3):
        R[:, :, 3 + k] = np.cross(np.eye(3)[k], x) / max(float(np.abs(x).max()), 1e-300)
    largest = float(np.abs(K @ R.reshape(-1, 6)).max())
    if largest > _RIGID * float(np.abs(K.data).max()):
        raise InputError(
            "resists rigid motions if its rows are directions 1, 2, 3 of the nodes in the order of their numbers",
            source=path,
            expected="matrices of a free body, with rows in that order; or FORMAT=MATRIX INPUT, which names nodes",
        )


def _entries(
    path: Path,
    names: NDArray[np.int64] | None,
    label_row: Mapping[int, int],
    twice: Mapping[int, tuple[str, ...]],
) -> EntryTable:
    """Entries with degrees of freedom of the deck."""
    table = read_table(path)
    width = table.values.shape[1]
    if width not in {3, 5} or (width == 3 and names is None):
        raise InputError(
            f"{width} numbers a line",
            source=path,
            expected="row, column and value, with a file of degrees of freedom; or node, direction, node, direction, "
            "value",
        )
    labels = table.values[:, : width - 1]
    wrong = np.flatnonzero((labels % 1 != 0).any(axis=1) | (labels < 1).any(axis=1))
    if width == 3:
        assert names is not None
        wrong = np.union1d(wrong, np.flatnonzero((labels > len(names)).any(axis=1)))
        expected = f"whole numbers from 1 to {len(names)}, the rows"
    else:
        wrong = np.union1d(wrong, np.flatnonzero((labels[:, [1, 3]] > 3).any(axis=1)))
        known = np.array(sorted(label_row), dtype=np.int64)
        double = np.isin(labels[:, [0, 2]], np.array(list(twice), dtype=np.float64))
        if double.any():
            at, side = (int(k) for k in np.argwhere(double)[0])
            _refuse_twice(path, int(table.lines[at]), int(labels[at, 2 * side]), twice)
        wrong = np.union1d(
            wrong, np.flatnonzero(~np.isin(labels[:, [0, 2]], known.astype(float)).all(axis=1))
        )
        expected = "nodes of the deck, and directions 1, 2 or 3"
    if wrong.size:
        at = int(wrong[0])
        words = " ".join(f"{value:g}" for value in labels[at])
        raise InputError(f"{words!r}", source=path, key=f"line {table.lines[at]}", expected=expected)
    index = labels.astype(np.int64)
    if width == 3:
        assert names is not None
        rows, columns = names[index[:, 0] - 1], names[index[:, 1] - 1]
    else:
        row = np.array([label_row[label] for label in known.tolist()], dtype=np.int64)
        first, second = (row[np.searchsorted(known, index[:, k])] for k in (0, 2))
        rows, columns = 3 * first + index[:, 1] - 1, 3 * second + index[:, 3] - 1
    return EntryTable(rows, columns, table.values[:, -1], table.lines)


def _clamped(
    deck: Deck, path: Path, present: NDArray[np.int64], used: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Nodes that are used and have no row; all other ones must have three."""
    count = np.zeros(len(deck.points), dtype=np.int64)
    np.add.at(count, present // 3, 1)
    partly = used[(count[used] > 0) & (count[used] < 3)]
    if partly.size:
        raise InputError(
            f"node {deck.node_labels[partly[0]]} has rows in {count[partly[0]]} directions ({partly.size} such nodes)",
            source=path,
            expected="nodes held in all directions or in none: matrices written without the supports of the case",
        )
    fixed = used[count[used] == 0]
    lost = np.setdiff1d((3 * fixed[:, None] + np.arange(3)).ravel(), deck.held)
    if lost.size:
        raise InputError(
            f"node {deck.node_labels[lost[0] // 3]} has no row, and no *BOUNDARY holds it",
            source=path,
            expected="matrices without equations, ties and rigid bodies, which eliminate rows",
        )
    return fixed


def _renumbered(table: EntryTable, new_row: NDArray[np.int64]) -> EntryTable:
    rows, columns = (3 * new_row[dofs // 3] + dofs % 3 for dofs in (table.rows, table.columns))
    return EntryTable(rows, columns, table.values, table.lines)


def _scalar_mass(path: Path, M: csr_array) -> csr_array:
    """Mass of the nodes (n, n) from that of the degrees of freedom (3n, 3n)."""
    from scipy.sparse import csr_array, identity, kron

    scalar = csr_array(M[0::3, 0::3])
    difference = abs(csr_array(kron(scalar, identity(3, format="csr"))) - M)
    if difference.nnz and difference.max() > _SAME * abs(M.data).max():
        raise InputError(
            "the mass of a node is not the same in all directions",
            source=path,
            expected="a mass matrix of solid elements in global axes",
        )
    return scalar


def _mesh(deck: Deck, nodes: NDArray[np.float64], new_row: NDArray[np.int64]) -> Mesh | None:
    """Elements between the nodes, if there is one kind of them and no node besides."""
    kinds = {block.kind for block in deck.blocks if block.nodes.size}
    if len(kinds) != 1 or "" in kinds:
        return None
    cells = new_row[np.vstack([block.nodes for block in deck.blocks if block.kind])]
    if np.unique(cells).size < len(nodes):
        return None
    return Mesh(nodes, cells, kinds.pop(), name=str(deck.source))
