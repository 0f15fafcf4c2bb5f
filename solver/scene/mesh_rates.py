"""How fast frames and shells vibrate at most, from lengths and material alone, before anything is packed.

The highest frequency of a mesh is below that of its stiffest element with free ends (B. M. Irons and G. Treharne, "A
bound theorem in eigenvalues and its practical applications", 1971). Of a cubic element of length l with wave speed c
it is ``c k1/l`` in stretching and ``sqrt(E I / (rho A)) k2/l^2`` in bending; of a rectangle of two such directions
squares of the first and values of the second add up.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["highest_frame_frequency", "highest_shell_frequency"]


@functools.cache
def _element_numbers() -> tuple[float, float]:
    """``k1`` and ``k2``: highest frequencies of a cubic of unit length and mass, in stretching and in bending."""
    x, weights = np.polynomial.legendre.leggauss(4)
    x, weights = 0.5 * (x + 1.0), 0.5 * weights
    shape = np.array([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])
    slope = np.array([6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x])
    bend = np.array([12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2])
    mass, stretching, bending = ((values * weights) @ values.T for values in (shape, slope, bend))
    found = (np.linalg.eigvals(np.linalg.solve(mass, matrix)).real.max() for matrix in (stretching, bending))
    first, second = (math.sqrt(value) for value in found)
    return first, second


def highest_frame_frequency(
    nodes: NDArray[np.float64],
    elements: NDArray[np.int64],
    sections: Sequence[Any],
    element_sections: NDArray[np.int64],
) -> float:
    """Bound of the circular frequencies of a frame [1/s]: its nodes [m], elements and sections."""
    frequency = 0.0
    k1, k2 = _element_numbers()
    chords = nodes[elements[:, 1]] - nodes[elements[:, 0]]
    lengths = np.linalg.norm(chords, axis=1)
    for number, length in enumerate(lengths):
        section = sections[element_sections[number] if len(element_sections) else 0]
        modulus = section.youngs_modulus / section.density
        stretching = math.sqrt(modulus) * k1 / length
        bending = math.sqrt(modulus * section.second_moment / section.area) * k2 / length**2
        frequency = max(frequency, stretching, bending)
    return frequency


def highest_shell_frequency(
    lengths: NDArray[np.float64], sections: Sequence[Any], element_sections: NDArray[np.int64]
) -> float:
    """Bound of the circular frequencies of a shell [1/s]: lengths of its elements along both sides [m], sections."""
    frequency = 0.0
    k1, k2 = _element_numbers()
    for number, (a, b) in enumerate(np.asarray(lengths, dtype=np.float64)):
        plate = sections[element_sections[number] if len(element_sections) else 0]
        modulus = plate.youngs_modulus / (plate.density * (1.0 - plate.poissons_ratio**2))
        stretching = math.sqrt(modulus) * k1 * math.hypot(1.0 / a, 1.0 / b)
        bending = math.sqrt(modulus / 12.0) * plate.thickness * k2 * (1.0 / a**2 + 1.0 / b**2)
        frequency = max(frequency, stretching, bending)
    return frequency
