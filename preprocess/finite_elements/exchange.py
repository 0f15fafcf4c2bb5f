"""Reader and writer of the four-file interface between finite element programs and the multibody solver.

The files are those of *Deformable bodies ... sliding contacts* (2014), section 4.2:

* ``u0.dat``: node positions, one node a line;
* ``mij.dat``: one lumped mass a node;
* ``stiffnessMatrix.dat``: lines ``i,a, j,b, value`` with one-based node and direction, one triangle;
* ``modeShapeMatrix.dat``: one line a degree of freedom (node-major x, y, z), one column a mode.

No file says its units, and programs write the boundary condition into the data in several ways. The reader
undoes all that are known and says in `FourFileData.notes` what it found.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.clamped_nodes import (
    expand_omitted_rows,
    penalised_nodes,
    zero_row_nodes,
)
from heavylift.preprocess.finite_elements.four_file_text import (
    EntryTable,
    read_entries,
    read_table,
    write_entries,
    write_table,
)
from heavylift.preprocess.finite_elements.model import FEModel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

__all__ = ["FourFileData", "longitudinal_wave_speed", "read_four_files", "write_four_files"]

NODE_FILE = "u0.dat"
MASS_FILE = "mij.dat"
MODE_FILE = "modeShapeMatrix.dat"
STIFFNESS_FILE = "stiffnessMatrix.dat"

_WAVE_SPEEDS = (10.0, 30e3)  # m/s: soft rubber to beyond diamond
_DENSITY_LIMIT = 25e3  # kg/m3, above osmium


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
        Zero-based nodes whose rows the mode file omits, when the reader cannot find them itself.
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
        omitted nodes that cannot be told; an impossible body.
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
    stiffness = _symmetric(folder / STIFFNESS_FILE, entries, n, notes)

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
    still = zero_row_nodes(modes)
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
    notes.append(_describe(model, check_units))
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


def _symmetric(path: Path, entries: EntryTable, node_count: int, notes: list[str]) -> csr_array:
    """Return the whole matrix from one triangle, or from both."""
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


def _describe(model: FEModel, check: bool) -> str:
    """Size, mass and wave speed in words; refuses an impossible body."""
    extent = np.ptp(model.nodes, axis=0)
    speed = longitudinal_wave_speed(model)
    volume = float(np.prod(extent))
    words = (
        "the body is {:.4g} x {:.4g} x {:.4g} m, {:.4g} kg".format(*extent, model.total_mass)
        + f", longitudinal waves {speed:.4g} m/s"
    )
    if check:
        remedy = "factors length_unit, mass_factor, stiffness_factor that give SI together"
        low, high = _WAVE_SPEEDS
        if not low <= speed <= high:
            raise InputError(f"{words}: no material is like that", source=model.name, expected=remedy)
        if volume > 0.0 and model.total_mass > _DENSITY_LIMIT * volume:
            density = model.total_mass / volume
            raise InputError(
                f"{words}: {density:.3g} kg/m3 or more, no material is that dense",
                source=model.name,
                expected=remedy,
            )
    return words
