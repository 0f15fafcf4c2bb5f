"""Coefficients of WAMIT made a database: units, time convention, restoring without weight.

WAMIT's conventions, and what is done about them:

* numbers are made non-dimensional with density, gravity and a length L (``ULEN``): added mass A / (rho L^k),
  damping B / (rho omega L^k), excitation X / (rho g L^m), restoring C / (rho g L^k'), with k = 3, 4, 5 and
  k' = 2, 3, 4 for no, one, two rotations, and m = 2, 3 for forces and moments;
* time runs as exp(+i omega t): excitation is conjugated. The phase is relative to a crest at the global
  origin, and headings are directions of propagation: both are ours;
* forces and motions are about the origin of each body, which `XBODY` places: these are the reference points;
* period -1 (or any below 0) stands for zero frequency and 0 for infinite frequency;
* coefficients that are zero by symmetry are left out;
* restoring coefficients of a free body contain its weight, m = rho V: the terms of weight are taken out.

Source: WAMIT User Manual, versions 7.2 and 7.4, chapters 3 (definitions) and 5 (output files).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = [
    "INFINITE_FREQUENCY",
    "ZERO_FREQUENCY",
    "WamitRows",
    "restoring_scale",
    "text_lines",
    "wamit_database",
    "without_weight",
]

INFINITE_FREQUENCY, ZERO_FREQUENCY = np.inf, 0.0


@dataclass
class WamitRows:
    """Non-dimensional coefficients as they are found: first by frequency, then by place."""

    added_mass: dict[float, dict[tuple[int, int], float]] = field(default_factory=dict)
    damping: dict[float, dict[tuple[int, int], float]] = field(default_factory=dict)
    excitation: dict[tuple[float, float], dict[int, complex]] = field(default_factory=dict)


def text_lines(path: Path) -> list[str]:
    """Lines of a text file."""
    if not path.is_file():
        raise InputError("no such file", source=path, expected="an output file of WAMIT")
    return path.read_text(encoding="utf-8", errors="replace").splitlines()


def restoring_scale(length: float) -> NDArray[np.float64]:
    """(6, 6) powers of the length that belong to rho g."""
    rotation = np.array([0, 0, 0, 1, 1, 1])
    return np.asarray(length ** (2.0 + rotation[:, None] + rotation[None, :]))


def without_weight(
    whole: NDArray[np.float64], weight: float, centre_of_gravity: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Restoring less the terms of weight: C44 and C55 have - m g z_G, C46 m g x_G, C56 m g y_G."""
    x, y, z = centre_of_gravity
    matrix = whole.copy()
    matrix[3, 3] += weight * z
    matrix[4, 4] += weight * z
    matrix[3, 5] -= weight * x
    matrix[4, 5] -= weight * y
    return matrix


def wamit_database(
    rows: WamitRows,
    *,
    source: str,
    references: NDArray[np.float64],
    names: tuple[str, ...],
    scales: tuple[float, float, float, float],
    symmetric: bool,
) -> HydrodynamicDatabase:
    """Arrays in SI units, frequencies and headings in increasing order, excitation conjugated."""
    length, density, gravity, depth = scales
    count = len(references)
    n = 6 * count
    omega = np.array(sorted(w for w in rows.added_mass if 0.0 < w < np.inf))
    if INFINITE_FREQUENCY not in rows.added_mass:
        raise InputError(
            "no added mass of infinite frequency",
            source=source,
            expected="rows of period 0 (add it to the run)",
        )
    degrees = sorted({heading for _, heading in rows.excitation})
    waves = np.array(sorted({w for w, _ in rows.excitation if 0.0 < w < np.inf}))
    if len(waves) != len(omega) or not np.allclose(waves, omega, rtol=1e-4):
        raise InputError(
            f"{len(omega)} frequencies of radiation, {len(waves)} of excitation",
            source=source,
            expected="the same",
        )
    kinds = (np.arange(n) % 6 >= 3).astype(int)
    mass_scale = density * length ** (3.0 + kinds[:, None] + kinds[None, :])
    force_scale = density * gravity * length ** (2.0 + kinds)
    mass, damping = np.zeros((len(omega), n, n)), np.zeros((len(omega), n, n))
    for index, w in enumerate(omega):
        mass[index] = _matrix(rows.added_mass[float(w)], n, source) * mass_scale
        damping[index] = _matrix(rows.damping[float(w)], n, source) * mass_scale * w
    excitation = np.zeros((len(omega), len(degrees), n), dtype=np.complex128)
    for index, w in enumerate(waves):
        for h, heading in enumerate(degrees):
            values = rows.excitation.get((float(w), heading))
            if values is None:
                raise InputError(
                    f"no excitation at {2.0 * np.pi / w:.4g} s, {heading:g} deg",
                    source=source,
                    expected="every period with every heading",
                )
            for i, value in values.items():
                if i >= n:
                    raise InputError(f"mode {i + 1}", source=source, expected=f"1 .. {n} for {count} bodies")
                excitation[index, h, i] = value.conjugate() * force_scale[i]
    infinite = _matrix(rows.added_mass[INFINITE_FREQUENCY], n, source) * mass_scale
    if names and len(names) != count:
        raise InputError(f"{len(names)} names", source=source, key="bodies", expected=f"{count}")
    return HydrodynamicDatabase(
        bodies=names or tuple(f"body{i + 1}" for i in range(count)),
        omega=omega,
        headings=np.deg2rad(degrees),
        added_mass=mass,
        damping=damping,
        added_mass_infinite=infinite,
        excitation=excitation,
        reference_points=references,
        density=density,
        gravity=gravity,
        depth=depth,
        source=source,
        symmetric=symmetric,
    )


def _matrix(entries: dict[tuple[int, int], float], n: int, source: str) -> NDArray[np.float64]:
    """A full matrix of the entries that are not zero by symmetry."""
    matrix = np.zeros((n, n))
    for (i, j), value in entries.items():
        if not (0 <= i < n and 0 <= j < n):
            raise InputError(f"coefficient ({i + 1}, {j + 1})", source=source, expected=f"1 .. {n}")
        matrix[i, j] = value
    return matrix
