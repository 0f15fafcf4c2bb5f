"""Reader and writer of the four-file interface between finite element programs and the multibody solver.

The files are those of *Deformable bodies ... sliding contacts* (2014), section 4.2:

* ``u0.dat``: node positions, one node a line;
* ``mij.dat``: one lumped mass a node;
* ``stiffnessMatrix.dat``: lines ``i,a, j,b, value`` with one-based node and direction, one triangle;
* ``modeShapeMatrix.dat``: one line a degree of freedom (node-major x, y, z), one column a mode.

No file says its units, and programs write the boundary condition into the data in several ways: penalties, zero rows,
omitted rows. The reader undoes all that are known and says in `FourFileData.notes` what it found.
"""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.model import DENSITY_LIMIT, WAVE_SPEEDS, FEModel

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

__all__ = [
    "EntryTable",
    "FourFileData",
    "NumberTable",
    "describe_model",
    "expand_omitted_rows",
    "longitudinal_wave_speed",
    "penalised_nodes",
    "read_entries",
    "read_four_files",
    "read_table",
    "symmetric_matrix",
    "write_entries",
    "write_four_files",
    "write_table",
    "zero_row_nodes",
]


# ---- text: every fault is named by file and line ----


class NumberTable(NamedTuple):
    """Rows of numbers and the line each stands on."""

    values: NDArray[np.float64]  # (rows, columns)
    lines: NDArray[np.int64]  # (rows,), one-based


class EntryTable(NamedTuple):
    """Entries of a sparse matrix, one a line."""

    rows: NDArray[np.int64]  # zero-based degree of freedom
    columns: NDArray[np.int64]
    values: NDArray[np.float64]
    lines: NDArray[np.int64]


def read_table(path: Path, columns: int | None = None) -> NumberTable:
    """Read white-space or comma separated numbers, the same count on every line.

    Parameters
    ----------
    path
        The file; blank lines are skipped.
    columns
        Numbers a line; None takes the count of the first line.

    Raises
    ------
    InputError
        A missing, empty or binary file, a line with another count, a word that is not a finite number.
    """
    try:
        text = path.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError) as error:
        problem = "cannot be read as text" if isinstance(error, UnicodeDecodeError) else _reason(error)
        raise InputError(problem, source=path, expected="a text file of numbers") from error
    rows = [line.split() for line in text.replace(",", " ").splitlines()]
    lines = np.array([number for number, row in enumerate(rows, start=1) if row], dtype=np.int64)
    rows = [row for row in rows if row]
    if not rows:
        raise InputError("is empty", source=path, expected="rows of numbers")
    width = columns or len(rows[0])
    for row, line in zip(rows, lines, strict=True):
        if len(row) != width:
            raise InputError(
                f"{len(row)} numbers: {' '.join(row[:8])!r}",
                source=path,
                key=f"line {line}",
                expected=f"{width} numbers on every line",
            )
    try:
        flat = np.fromiter(map(float, chain.from_iterable(rows)), dtype=np.float64, count=len(rows) * width)
    except ValueError:
        _refuse_word(path, rows, lines)
        raise
    if not np.isfinite(flat).all():
        _refuse_word(path, rows, lines)
    return NumberTable(flat.reshape(-1, width), lines)


def _reason(error: OSError) -> str:
    return "does not exist" if isinstance(error, FileNotFoundError) else f"cannot be read: {error.strerror}"


def _refuse_word(path: Path, rows: Sequence[Sequence[str]], lines: NDArray[np.int64]) -> None:
    """Raise for the first word that is not a finite number."""
    for row, line in zip(rows, lines, strict=True):
        for word in row:
            try:
                good = bool(np.isfinite(float(word)))
            except ValueError:
                good = False
            if not good:
                raise InputError(f"{word!r}", source=path, key=f"line {line}", expected="a finite number")


def read_entries(path: Path, node_count: int) -> EntryTable:
    """Read lines ``i,a, j,b, value``: the entry between direction a of node i and direction b of node j.

    Raises
    ------
    InputError
        Besides the errors of `read_table`: a node that is not a whole number from 1 to `node_count`, a
        direction other than 1, 2, 3, an entry given twice.
    """
    table = read_table(path, 5)
    labels = table.values[:, :4]
    for column, what, highest in ((0, "node", node_count), (1, "direction", 3)):
        for k in (column, column + 2):
            wrong = np.flatnonzero((labels[:, k] < 1) | (labels[:, k] > highest) | (labels[:, k] % 1 != 0))
            if wrong.size:
                raise InputError(
                    f"{what} {labels[wrong[0], k]:g}",
                    source=path,
                    key=f"line {table.lines[wrong[0]]}",
                    expected=f"a whole number from 1 to {highest}"
                    + (" (the rows of the node file)" if what == "node" else ""),
                )
    index = labels.astype(np.int64) - 1
    rows, columns = 3 * index[:, 0] + index[:, 1], 3 * index[:, 2] + index[:, 3]
    keys = rows * (3 * node_count) + columns
    order = np.argsort(keys, kind="stable")
    twice = np.flatnonzero(np.diff(keys[order]) == 0)
    if twice.size:
        first, second = table.lines[order[twice[0]]], table.lines[order[twice[0] + 1]]
        raise InputError(
            f"repeats the entry of line {first}",
            source=path,
            key=f"line {second}",
            expected="every entry once",
        )
    return EntryTable(rows, columns, table.values[:, 4], table.lines)


def write_table(path: Path, values: NDArray[np.float64]) -> None:
    """Write rows of numbers with 17 digits, so that reading gives bitwise identical numbers."""
    template = " ".join(["%24.16e"] * values.shape[1])
    path.write_text("".join(template % tuple(row) + "\n" for row in values.tolist()), encoding="ascii")


def write_entries(
    path: Path, rows: NDArray[np.int64], columns: NDArray[np.int64], values: NDArray[np.float64]
) -> None:
    """Write entries by zero-based degrees of freedom as lines ``i,a, j,b, value``, with 17 digits."""
    row_node, row_direction = np.divmod(rows, 3)
    column_node, column_direction = np.divmod(columns, 3)
    entries = zip(
        (row_node + 1).tolist(),
        (row_direction + 1).tolist(),
        (column_node + 1).tolist(),
        (column_direction + 1).tolist(),
        values.tolist(),
        strict=True,
    )
    text = "".join(f"{i},{a}, {j},{b}, {value:24.16e}\n" for i, a, j, b, value in entries)
    path.write_text(text, encoding="ascii")


# ---- clamped nodes ----


_PENALTY = 1e10  # a diagonal entry so many times the median is a boundary condition, not steel
_ZERO = 1e-12  # of the largest entry of the modes
_TESTED_MODES = 8  # enough to tell the clamped nodes, whatever the count of modes
_ORTHOGONAL = 1e-3  # cosine between modes that a file of five digits can reach
_CLEARLY = 3.0  # the right candidate is so many times better than the next


def penalised_nodes(path: Path, stiffness: csr_array) -> NDArray[np.int64]:
    """Nodes with a boundary penalty (1e36, say) on the diagonal of all three directions.

    Raises
    ------
    InputError
        A node with a penalty in one or two directions: only whole nodes can be clamped.
    """
    diagonal = stiffness.diagonal()
    positive = diagonal[diagonal > 0.0]
    if not positive.size:
        return np.empty(0, dtype=np.int64)
    # the smallest entries set the scale: in a small model most of the nodes may be clamped
    penalty = (diagonal > _PENALTY * np.quantile(positive, 0.05)).reshape(-1, 3)
    partly = np.flatnonzero(penalty.any(axis=1) & ~penalty.all(axis=1))
    if partly.size:
        directions = ", ".join("xyz"[k] for k in np.flatnonzero(penalty[partly[0]]))
        raise InputError(
            f"node {partly[0] + 1} has a boundary penalty in direction {directions} only",
            source=path,
            expected="nodes clamped in all directions, or a stiffness matrix without boundary conditions",
        )
    return np.flatnonzero(penalty.all(axis=1))


def zero_row_nodes(modes: NDArray[np.float64]) -> NDArray[np.int64]:
    """Nodes that move in no mode; `modes` has shape (3n, nf)."""
    largest = np.abs(modes).reshape(len(modes) // 3, -1).max(axis=1)
    return np.flatnonzero(largest <= _ZERO * largest.max())


def expand_omitted_rows(
    path: Path,
    stored: NDArray[np.float64],
    nodes: NDArray[np.float64],
    masses: NDArray[np.float64],
    stiffness: csr_array,
    clamped: NDArray[np.int64],
    given: Sequence[int] | None,
    notes: list[str],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Give the mode shapes a row for every degree of freedom.

    A file with fewer than 3n rows omits its clamped nodes. These are `given`, or those that the stiffness
    clamps, or are found: modes of the right nodes are orthogonal in the masses, and in K, to the accuracy
    of the file, modes shifted onto wrong nodes are not. Candidates are runs of consecutive nodes and plane
    sections.

    Returns
    -------
    tuple
        Modes (3n, nf) with zeros in the omitted rows, and the omitted nodes.

    Raises
    ------
    InputError
        More rows than 3n, a count that is no multiple of 3, no mode that moves, given nodes of another
        count, or ambiguous candidates.
    """
    n, rows = len(nodes), len(stored)
    if rows > 3 * n or rows % 3 or rows == 0:
        raise InputError(
            f"{rows} rows",
            source=path,
            expected=f"{3 * n}, three for each of {n} nodes, or three less for every clamped node",
        )
    if not np.any(stored):
        raise InputError("all mode shapes are zero", source=path, expected="modes that move")
    count = n - rows // 3
    if count == 0:
        if given is not None and len(given):
            raise InputError(
                f"{len(given)} nodes",
                source=path,
                key="clamped_nodes",
                expected="none, because no row is missing from the file",
            )
        return stored, np.empty(0, dtype=np.int64)
    if given is not None:
        omitted = np.unique(np.asarray(given, dtype=np.int64))
        if omitted.size != count or omitted[0] < 0 or omitted[-1] >= n:
            raise InputError(
                f"{omitted.size} nodes",
                source=path,
                key="clamped_nodes",
                expected=f"the {count} zero-based nodes, below {n}, whose rows are missing",
            )
        notes.append(f"{path.name} omits {count} clamped nodes, named by the caller")
    elif clamped.size == count:
        omitted = clamped
        notes.append(f"{path.name} omits {count} nodes, those that the stiffness matrix clamps")
    else:
        omitted, cosine = _best_candidate(path, stored, nodes, masses, stiffness, count)
        notes.append(
            f"{path.name} omits {count} clamped nodes, {_words(omitted)}; with these the modes are "
            f"orthogonal in the masses to {cosine:.1g}"
        )
    modes = np.zeros((n, 3, stored.shape[1]))
    modes[np.setdiff1d(np.arange(n), omitted)] = stored.reshape(-1, 3, stored.shape[1])
    return modes.reshape(3 * n, -1), omitted


def _sections(nodes: NDArray[np.float64], count: int) -> Iterator[NDArray[np.int64]]:
    """Yield the plane sections, across x, y or z, that contain `count` nodes."""
    tolerance = 1e-6 * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    for axis in range(3):
        order = np.argsort(nodes[:, axis], kind="stable")
        steps = np.flatnonzero(np.diff(nodes[order, axis]) > tolerance) + 1
        for members in np.split(order, steps):
            if members.size == count:
                yield np.sort(members)


def _run_cosines(shapes: NDArray[np.float64], masses: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Largest cosine between modes if nodes s ... s + count - 1 are the omitted ones, for every s.

    Rows before s belong to the nodes of the same number, rows after it to nodes `count` further on: with
    sums from both ends all candidates together cost one pass.
    """
    products = np.einsum("nka,nkb->nab", shapes, shapes)
    zero = np.zeros((1, *products.shape[1:]))
    before = np.cumsum(masses[: len(shapes), None, None] * products, axis=0)
    after = np.cumsum((masses[count:, None, None] * products)[::-1], axis=0)[::-1]
    return _largest_cosine(np.concatenate([zero, before]) + np.concatenate([after, zero]))


def _best_candidate(
    path: Path,
    stored: NDArray[np.float64],
    nodes: NDArray[np.float64],
    masses: NDArray[np.float64],
    stiffness: csr_array,
    count: int,
) -> tuple[NDArray[np.int64], float]:
    nf = min(stored.shape[1], _TESTED_MODES)
    remedy = f"the {count} omitted nodes in 'clamped_nodes'"
    if nf < 2:
        raise InputError(
            f"omits {count} nodes, and one mode does not determine which", source=path, expected=remedy
        )
    shapes = stored.reshape(-1, 3, stored.shape[1])[:, :, :nf]
    cosines = _run_cosines(shapes, masses, count)
    results = [(float(c), np.arange(s, s + count)) for s, c in enumerate(cosines)]
    for candidate in _sections(nodes, count):
        if candidate[-1] - candidate[0] >= count:  # not a run
            free = np.delete(masses, candidate)
            gram = np.einsum("n,nka,nkb->ab", free, shapes, shapes)
            results.append((float(_largest_cosine(gram)), candidate))
    results.sort(key=lambda result: result[0])
    # equal masses at both ends of a run can tie in the masses; the stiffness then decides
    ties = [r for r in results if r[0] <= _CLEARLY * results[0][0]]
    if len(ties) > 1:
        scored = []
        for cosine, candidate in ties:
            full = np.zeros((len(nodes), 3, nf))
            full[np.delete(np.arange(len(nodes)), candidate)] = shapes
            full = full.reshape(-1, nf)
            in_stiffness = float(_largest_cosine(full.T @ (stiffness @ full)))
            scored.append((in_stiffness, cosine, candidate))
        scored.sort(key=lambda result: result[:2])
        if scored[1][0] <= _CLEARLY * scored[0][0]:
            raise InputError(
                f"omits {count} nodes: {_words(scored[0][2])} or {_words(scored[1][2])}",
                source=path,
                expected=remedy,
            )
        _, best, omitted = scored[0]
    else:
        best, omitted = results[0]
    if best > _ORTHOGONAL:
        raise InputError(
            f"omits {count} nodes, and no section makes the modes orthogonal (best {best:.2g})",
            source=path,
            expected=remedy,
        )
    return omitted, best


def _largest_cosine(gram: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest off-diagonal cosine of Gram matrices (..., nf, nf)."""
    norms = np.sqrt(np.abs(np.diagonal(gram, axis1=-2, axis2=-1)))
    cosines = np.abs(gram) / np.maximum(norms[..., :, None] * norms[..., None, :], np.finfo(float).tiny)
    return (cosines * (1.0 - np.eye(gram.shape[-1]))).max(axis=(-2, -1))


def _words(nodes: NDArray[np.int64]) -> str:
    if (np.diff(nodes) == 1).all() and nodes.size > 1:
        return f"{nodes[0] + 1} to {nodes[-1] + 1}"
    return ", ".join(str(node + 1) for node in nodes[:12]) + (" ..." if nodes.size > 12 else "")


# ---- the interface ----


NODE_FILE = "u0.dat"
MASS_FILE = "mij.dat"
MODE_FILE = "modeShapeMatrix.dat"
STIFFNESS_FILE = "stiffnessMatrix.dat"


@dataclass(frozen=True)
class FourFileData:
    """What the four files contain, in SI.

    Parameters
    ----------
    model
        Nodes [m], K [N/m], lumped scalar mass [kg], clamped nodes. Rows of K at nodes clamped by a penalty
        are zero, because the file overwrote them.
    modes
        Stored mode shapes [-], scaled as in the file, shape (3n, nf), zero at clamped nodes.
    notes
        What the reader found and did, one sentence each.
    """

    model: FEModel
    modes: NDArray[np.float64]
    notes: tuple[str, ...] = ()

    @property
    def fixed_nodes(self) -> NDArray[np.int64]:
        """Sorted indices of the clamped nodes."""
        return self.model.fixed_nodes


def read_four_files(
    folder: str | Path,
    *,
    length_unit: float = 1.0,
    mass_factor: float = 1.0,
    stiffness_factor: float = 1.0,
    clamped_nodes: Sequence[int] | None = None,
    check_units: bool = True,
) -> FourFileData:
    """Read a body from the four files of a folder.

    Parameters
    ----------
    folder
        Where ``u0.dat``, ``mij.dat``, ``modeShapeMatrix.dat`` and ``stiffnessMatrix.dat`` lie.
    length_unit
        Metres per unit of ``u0.dat``.
    mass_factor
        Kilograms per unit of ``mij.dat``. A density in kg/m3 on lengths in mm gives 1e-9, tonnes give 1e3.
    stiffness_factor
        N/m per unit of ``stiffnessMatrix.dat``. A Young's modulus in Pa on lengths in mm gives 1e-3, N/mm
        gives 1e3.
    clamped_nodes
        Zero-based nodes whose rows the mode file omits, when the reader cannot find them itself. None at all,
        ``[]``, is a free body: then nodes whose rows are zero are not clamped either.
    check_units
        Refuse a body of impossible density or wave speed, the sign of factors that do not fit together.

    Returns
    -------
    FourFileData
        The body, its stored modes and what was found.

    Raises
    ------
    InputError
        A missing file; a fault of the text (file and line are named); a factor or a mass that is not
        positive; row counts that do not fit the nodes; a matrix given partly as a triangle and partly in
        full, or unsymmetric; a node clamped in some directions only; a mode that moves a clamped node;
        unknown omitted nodes; an impossible body.
    """
    folder = Path(folder)
    for key, factor in (
        ("length_unit", length_unit),
        ("mass_factor", mass_factor),
        ("stiffness_factor", stiffness_factor),
    ):
        if not (np.isfinite(factor) and factor > 0.0):
            raise InputError(f"{factor!r}", source=folder, key=key, expected="a positive number")
    notes: list[str] = []

    nodes = read_table(folder / NODE_FILE, 3).values
    n = len(nodes)
    masses = _masses(folder / MASS_FILE, n)
    entries = read_entries(folder / STIFFNESS_FILE, n)
    stiffness = symmetric_matrix(folder / STIFFNESS_FILE, entries, n, notes)

    clamped = penalised_nodes(folder / STIFFNESS_FILE, stiffness)
    if clamped.size:
        stiffness = _without(stiffness, clamped)
        notes.append(
            f"{clamped.size} nodes are clamped by a penalty on the diagonal of {STIFFNESS_FILE}; "
            "their rows and columns are dropped"
        )

    table = read_table(folder / MODE_FILE)
    modes, omitted = expand_omitted_rows(
        folder / MODE_FILE, table.values, nodes, masses, stiffness, clamped, clamped_nodes, notes
    )
    if clamped_nodes is not None and not len(clamped_nodes) and clamped.size:
        raise InputError(
            f"none, and {STIFFNESS_FILE} clamps {clamped.size}, {_words(clamped)}",
            source=folder,
            key="clamped_nodes",
            expected="a stiffness matrix without boundary conditions, or no 'clamped_nodes'",
        )
    free = clamped_nodes is not None and not len(clamped_nodes)
    still = np.empty(0, dtype=np.int64) if free else zero_row_nodes(modes)
    moving = np.setdiff1d(clamped, still)
    if moving.size:
        raise InputError(
            f"moves node {moving[0] + 1}, which {STIFFNESS_FILE} clamps",
            source=folder / MODE_FILE,
            expected="zero rows at clamped nodes, or the same boundary condition in both files",
        )
    extra = np.setdiff1d(still, np.union1d(clamped, omitted))
    if extra.size:
        notes.append(f"{extra.size} nodes are clamped because their rows in {MODE_FILE} are zero")
    fixed = np.union1d(clamped, still)

    from scipy.sparse import csr_array, diags_array

    model = FEModel(
        nodes=length_unit * nodes,
        stiffness=csr_array(stiffness * stiffness_factor),
        mass=csr_array(diags_array(mass_factor * masses, format="csr")),
        fixed_nodes=fixed,
        name=str(folder),
    )
    notes.append(describe_model(model, check_units))
    return FourFileData(model, modes, tuple(notes))


def write_four_files(
    folder: str | Path,
    model: FEModel,
    modes: NDArray[np.float64],
    *,
    length_unit: float = 1.0,
    mass_factor: float = 1.0,
    stiffness_factor: float = 1.0,
) -> None:
    """Write a body as four files; with all factors 1, reading gives back every bit.

    Parameters
    ----------
    folder
        Made if missing; files of the same names are replaced.
    model
        Its mass must be lumped. Clamped nodes are written as zero rows of the modes.
    modes
        Mode shapes, shape (3n, nf).
    length_unit, mass_factor, stiffness_factor
        SI per unit of the files, as in `read_four_files`.

    Raises
    ------
    InputError
        A consistent mass matrix, modes of the wrong shape, modes that move a clamped node or, when nodes are
        clamped, no mode at all.
    """
    folder = Path(folder)
    if model.points is not None or model.rotating.size:
        raise InputError(
            "its nodes have rotations, or masses beside them",
            source=model.name,
            key="mass",
            expected="a body of solids, whose nodes have displacements only",
        )
    if not model.is_lumped:
        raise InputError(
            "the mass matrix is not diagonal", source=model.name, key="mass", expected="a lumped mass matrix"
        )
    modes = np.asarray(modes, dtype=np.float64)
    if modes.ndim != 2 or len(modes) != 3 * model.node_count or modes.shape[1] == 0:
        raise InputError(
            f"array of shape {modes.shape}",
            source=model.name,
            key="modes",
            expected=f"({3 * model.node_count}, nf) with nf > 0",
        )
    if np.any(modes.reshape(model.node_count, -1)[model.fixed_nodes]):
        raise InputError(
            "a clamped node moves", source=model.name, key="modes", expected="zero rows at clamped nodes"
        )
    from scipy.sparse import tril

    folder.mkdir(parents=True, exist_ok=True)
    write_table(folder / NODE_FILE, model.nodes / length_unit)
    write_table(folder / MASS_FILE, model.mass.diagonal()[:, None] / mass_factor)
    write_table(folder / MODE_FILE, modes)
    lower = tril(model.stiffness, format="coo")
    lower.sum_duplicates()
    order = np.lexsort((lower.col, lower.row))
    write_entries(
        folder / STIFFNESS_FILE, lower.row[order], lower.col[order], lower.data[order] / stiffness_factor
    )


def longitudinal_wave_speed(model: FEModel) -> float:
    """Speed of longitudinal waves that K, the mass and the positions imply together [m/s].

    Uniform stretching u = x e_x of a homogeneous body has u^T K u = (lambda + 2 mu) V, so that
    sqrt(u^T K u / m) = sqrt((lambda + 2 mu) / rho): a property of the material alone, for steel 5950 m/s. The
    direction is taken in which the clamped nodes lie closest to a plane, so that they need not move.
    """
    direction = 0
    origin = 0.0
    if model.fixed_nodes.size:
        clamped = model.nodes[model.fixed_nodes]
        direction = int(np.argmin(np.ptp(clamped, axis=0)))
        origin = float(clamped[:, direction].mean())
    u = np.zeros((model.node_count, 3))
    u[:, direction] = model.nodes[:, direction] - origin
    u[model.fixed_nodes] = 0.0
    energy = float(u.ravel() @ (model.stiffness @ u.ravel()))
    return float(np.sqrt(max(energy, 0.0) / model.total_mass))


def _masses(path: Path, node_count: int) -> NDArray[np.float64]:
    table = read_table(path, 1)
    if len(table.values) != node_count:
        raise InputError(
            f"{len(table.values)} masses",
            source=path,
            key=f"line {table.lines[-1]}",
            expected=f"{node_count}, one for each node of {NODE_FILE}",
        )
    masses = table.values[:, 0]
    wrong = np.flatnonzero(masses <= 0.0)
    if wrong.size:
        raise InputError(
            f"{masses[wrong[0]]:g}",
            source=path,
            key=f"line {table.lines[wrong[0]]}",
            expected="a positive mass",
        )
    return masses


def symmetric_matrix(path: Path, entries: EntryTable, node_count: int, notes: list[str]) -> csr_array:
    """Return the whole matrix (3n, 3n) from one triangle, or from both.

    Raises
    ------
    InputError
        Some entries with a partner across the diagonal and some without, or an unsymmetric matrix.
    """
    from scipy.sparse import coo_array, csr_array

    size = 3 * node_count
    off = entries.rows != entries.columns
    high = np.maximum(entries.rows, entries.columns)
    low = np.minimum(entries.rows, entries.columns)
    keys, first, count = np.unique(high[off] * size + low[off], return_index=True, return_counts=True)
    shape = (size, size)
    given = csr_array(coo_array((entries.values, (entries.rows, entries.columns)), shape=shape))
    if (count == 1).all():
        mirrored = coo_array(
            (
                np.concatenate([entries.values, entries.values[off]]),
                (
                    np.concatenate([entries.rows, entries.columns[off]]),
                    np.concatenate([entries.columns, entries.rows[off]]),
                ),
            ),
            shape=shape,
        )
        return csr_array(mirrored)
    if (count == 1).any():
        line = entries.lines[off][first[np.argmax(count == 1)]]
        raise InputError(
            "has no partner across the diagonal, other entries have one",
            source=path,
            key=f"line {line}",
            expected="one triangle, or the whole matrix",
        )
    difference = abs(given - given.T).tocoo()
    worst = int(np.argmax(difference.data)) if difference.nnz else 0
    if difference.nnz and difference.data[worst] > 1e-6 * abs(given.data).max():
        i, j = int(difference.row[worst]), int(difference.col[worst])
        raise InputError(
            f"unsymmetric between {i // 3 + 1},{i % 3 + 1} and {j // 3 + 1},{j % 3 + 1}",
            source=path,
            expected="a symmetric matrix",
        )
    notes.append(f"{path.name} holds both triangles ({keys.size} pairs)")
    return csr_array(0.5 * (given + given.T))


def _without(stiffness: csr_array, nodes: NDArray[np.int64]) -> csr_array:
    """Drop the entries of all rows and columns of the nodes."""
    from scipy.sparse import coo_array, csr_array

    coo = coo_array(stiffness)
    keep = ~(np.isin(coo.row // 3, nodes) | np.isin(coo.col // 3, nodes))
    return csr_array(coo_array((coo.data[keep], (coo.row[keep], coo.col[keep])), shape=coo.shape))


def describe_model(model: FEModel, check: bool) -> str:
    """Size, mass and wave speed of a body in words.

    Raises
    ------
    InputError
        If `check` is set, for a wave speed or density that no material has.
    """
    extent = np.ptp(model.nodes, axis=0)
    speed = longitudinal_wave_speed(model)
    volume = float(np.prod(extent))
    words = (
        "the body is {:.4g} x {:.4g} x {:.4g} m, {:.4g} kg".format(*extent, model.total_mass)
        + f", longitudinal waves {speed:.4g} m/s"
    )
    if check:
        remedy = "factors length_unit, mass_factor, stiffness_factor that give SI together"
        low, high = WAVE_SPEEDS
        if not low <= speed <= high:
            raise InputError(f"{words}: no material is like that", source=model.name, expected=remedy)
        if volume > 0.0 and model.total_mass > DENSITY_LIMIT * volume:
            density = model.total_mass / volume
            raise InputError(
                f"{words}: {density:.3g} kg/m3 or more, no material is that dense",
                source=model.name,
                expected=remedy,
            )
    return words
