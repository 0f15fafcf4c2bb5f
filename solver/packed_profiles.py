"""Parts of packed profiles, as `heavylift.solver.drive.pack_profile` puts them one behind the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["profile_parts"]


def profile_parts(
    data: NDArray[np.float64], start: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Views of a packed profile.

    Parameters
    ----------
    data, start
        Where it is packed, and where it begins there.

    Returns
    -------
    breaks, cubics, harmonics
        Times [s], shape (n,); coefficients by falling power, shape (n - 1, 4); amplitude, angular frequency [rad/s] and
        phase [rad] of each harmonic, shape (m, 3).
    """
    count, harmonics = int(data[start]), int(data[start + 1])
    pieces = max(0, count - 1)
    cubics = start + 2 + count
    waves = cubics + 4 * pieces
    return (
        data[start + 2 : cubics],
        data[cubics:waves].reshape(pieces, 4),
        data[waves : waves + 3 * harmonics].reshape(harmonics, 3),
    )
