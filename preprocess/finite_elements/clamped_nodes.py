"""Finding the clamped nodes in finite element data that hide them: penalties, zero rows, omitted rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

__all__ = ["expand_omitted_rows", "penalised_nodes", "zero_row_nodes"]

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
        count, or candidates that cannot be told apart.
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
        if given is not None:
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
        raise InputError(f"omits {count} nodes, and one mode cannot tell which", source=path, expected=remedy)
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
