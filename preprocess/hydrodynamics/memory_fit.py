"""The memory of a database as a sum of exponentials: how long it is, what of it matters to motions, and its fit.

A coordinate in which hardly any waves are made has a kernel of nothing but round-off: yaw of a body of revolution,
every coordinate of one that lies deep. Relative to its own largest value such a kernel takes all the poles of a fit
and is fitted by none. So errors are relative to the larger of this value and of a kernel that would not be felt: one
whose damping is a small part of the critical one, 2 m omega, at the frequency where the hulls make most waves.
"""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from heavylift.numerics.threads import one_blas_thread
from heavylift.preprocess.hydrodynamics.database import length_scales, mass_scales
from heavylift.preprocess.hydrodynamics.exponentials import ExponentialKernel, fit_exponentials
from heavylift.preprocess.hydrodynamics.repairs import passive_damping
from heavylift.preprocess.hydrodynamics.retardation import memory_length, retardation_kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.hydrodynamics.database import HydrodynamicDatabase
    from heavylift.preprocess.hydrodynamics.retardation import RetardationKernel

__all__ = ["database_memory", "felt_scales", "fit_memory", "read_memory", "write_memory"]

FIT_STEP, SHORTEST_FIT, SHORTEST_MEMORY = 0.1, 60.0, 40.0
"""Of the samples that exponentials are fitted to [s], how far these reach at least, and direct convolution does [s]."""

FELT = 1e-3
"""Of m omega^2: kernels that are smaller dampen by less than a thousandth of the critical damping."""


def felt_scales(database: HydrodynamicDatabase) -> NDArray[np.float64]:
    """Square roots of the smallest kernels that are felt [sqrt(kg)/s, sqrt(kg) m/s], shape (6N,).

    Notes
    -----
    K(0) = (2/pi) int B is of the size of B omega, and B = 2 zeta m omega: K(0) / (m omega^2) is a damping ratio. The
    mass is that of `mass_scales`.
    """
    radiated = np.diagonal(database.damping, axis1=1, axis2=2) @ length_scales(database) ** 2
    omega = float(database.omega[np.argmax(radiated)])
    return np.asarray(np.sqrt(FELT * mass_scales(database)) * omega)


def database_memory(
    database: HydrodynamicDatabase, length: float | None = None
) -> tuple[RetardationKernel, float]:
    """Kernel of a database, and how far it goes back [s]: as it is asked for, or until it has decayed.

    It is that of the nearest passive damping. Panels couple surge and pitch of a box, which are all but proportional, a
    little more than their damping allows; residues of exponentials would be changed for that at all frequencies.
    """
    damping = 0.5 * (database.damping + np.swapaxes(database.damping, 1, 2))
    at, damping_there = passive_damping(damping)
    damping[at] = damping_there
    kernel = retardation_kernel(database.omega, damping, source=database.source)
    return kernel, length or max(memory_length(kernel, least=felt_scales(database)), SHORTEST_MEMORY)


@one_blas_thread
def fit_memory(
    database: HydrodynamicDatabase, length: float | None = None, *, tolerance: float = 1e-3
) -> ExponentialKernel:
    """Exponentials for the memory of a database.

    Parameters
    ----------
    database
        Its damping is what is used.
    length
        How far it goes back [s]; None: until it has decayed. Samples reach 60 s at least.
    tolerance
        As of `fit_exponentials`.

    Raises
    ------
    InputError
        From `retardation_kernel`.
    """
    kernel, length = database_memory(database, length)
    times = np.arange(0.0, max(length, SHORTEST_FIT), FIT_STEP)
    return fit_exponentials(
        kernel(times), FIT_STEP, tolerance=tolerance, least=felt_scales(database), source=database.source
    )


def write_memory(path: Path | str, fit: ExponentialKernel, key: str) -> None:
    """Write a fit as .npz, with a key of what it was made of."""
    with Path(path).open("wb") as file:
        np.savez_compressed(file, key=key, **{field.name: getattr(fit, field.name) for field in fields(fit)})


def read_memory(path: Path | str, key: str) -> ExponentialKernel | None:
    """Fit of `write_memory`; None if it is of something else, or no whole file."""
    try:
        with Path(path).open("rb") as file, np.load(file, allow_pickle=False) as found:
            if str(found["key"]) != key:
                return None
            values = {field.name: found[field.name] for field in fields(ExponentialKernel)}
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        return None
    plain = {name: value.item() if value.ndim == 0 else value for name, value in values.items()}
    return ExponentialKernel(**plain)
