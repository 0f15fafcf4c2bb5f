"""Round numbers for scale bars and exaggerations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["deformation_scale", "round_down"]


def round_down(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten that does not exceed a positive value."""
    power = 10.0 ** np.floor(np.log10(value) + 1.0e-12)
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1.0e-9)))


def deformation_scale(displacement: NDArray[np.float64], diagonal: float, *, share: float = 0.1) -> float:
    """Round factor that draws the largest displacement as at most `share` of the diagonal; 1 at rest."""
    largest = float(np.linalg.norm(displacement, axis=-1).max(initial=0.0))
    return round_down(share * diagonal / largest) if largest > 1.0e-12 * diagonal else 1.0
